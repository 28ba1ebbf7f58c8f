//! Benchmark cases of the HTTP server, as a client experiences it.

use std::sync::mpsc::channel;
use std::time::Instant;

use serde_json::{Value, json};

use crate::lab::bench::{Bench, BenchError, BenchFigure, Case, Samples, Unit, keep_a_large_company};
use crate::record::folder::runs::run_folder;
use crate::server::{HeldPort, HttpOptions, Remote, serve_http};
use crate::session::{Access, Session};

/// Requests of each kind per repetition.
const REQUESTS: usize = 40;

pub const CASES: &[Case] = &[Case {
    name: "http",
    figures: &[
        BenchFigure::shown("over HTTP at 165,000: a call", Unit::Milliseconds),
        BenchFigure::aimed("over HTTP at 165,000: a small query, 99 of 100", Unit::Milliseconds, 50.0, None),
        BenchFigure::shown("over HTTP at 165,000: a week", Unit::Milliseconds),
    ],
    fresh: false,
    long: false,
    measure: http,
}];

fn http(bench: &Bench) -> Result<Samples, BenchError> {
    let run = keep_a_large_company(bench)?;
    let folder = run_folder(&bench.scratch, &run);
    let session = Session::open(&folder, Access::Write, true)?;
    let (ready, waits) = channel();
    let held = HeldPort::take(None)?;
    let server = std::thread::spawn(move || {
        let announce = |_: &_| {
            let _ = ready.send(());
        };
        serve_http(session, held, &HttpOptions::default(), announce, |words| eprintln!("{words}"))
    });
    let there = waits.recv().ok().and_then(|()| Remote::find(&folder, &run));
    let samples = there
        .as_ref()
        .ok_or_else(|| failed("the server does not respond"))
        .and_then(|remote| ask(remote, bench));
    if let Some(remote) = there {
        remote.shut_down().map_err(failed)?;
    }
    server.join().map_err(|_| failed("the server has failed"))??;
    samples
}

fn ask(remote: &Remote, bench: &Bench) -> Result<Samples, BenchError> {
    let operations = |at: usize| json!({ "tool": "set_daily_spend", "args": { "operations": 400 + at % 2 } });
    let calls = timed(remote, "/call", REQUESTS * bench.repetitions, operations)?;
    let mut queries = timed(
        remote,
        "/query",
        REQUESTS * bench.repetitions,
        |at| json!({ "sql": format!("SELECT sum(amount) FROM ledger WHERE day = {}", at + 1) }),
    )?;
    queries.sort_by(f64::total_cmp);
    let slowest = (queries.len() as f64 * 0.99).ceil() as usize;
    let forecast = json!({ "point": 1e6, "lower": 0.0, "upper": 1e9 });
    let week = json!({ "rationale": "on", "predictions": {
        "cash_1wk": forecast, "cash_4wk": forecast, "cash_12wk": forecast, "cash_26wk": forecast,
    } });
    let weeks = timed(remote, "/next-week", bench.repetitions, |_| week.clone())?;
    Ok(vec![calls, queries.get(slowest.saturating_sub(1)).copied().into_iter().collect(), weeks])
}

/// Returns the duration of each request in milliseconds.
fn timed(
    remote: &Remote,
    route: &str,
    count: usize,
    body: impl Fn(usize) -> Value,
) -> Result<Vec<f64>, BenchError> {
    let once = |at: usize| {
        let body = body(at);
        let started = Instant::now();
        let reply = remote.post(route, &body).map_err(failed)?;
        let took = started.elapsed().as_secs_f64() * 1e3;
        match reply.body["success"] == true {
            true => Ok(took),
            false => Err(failed(format!("{route}: {}", reply.body))),
        }
    };
    (0..count).map(once).collect()
}

fn failed(why: impl std::fmt::Display) -> BenchError {
    BenchError::new(why.to_string())
}
