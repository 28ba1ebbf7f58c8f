//! Benchmarks of the HTTP server, measured by a client.

use std::sync::mpsc::channel;
use std::time::Instant;

use serde_json::{Value, json};

use crate::lab::benchmark::{
    BenchCase, BenchContext, BenchError, BenchFigure, BenchUnit, Samples, save_large_company,
};
use crate::record::folder::runs::run_folder;
use crate::server::{BoundPort, HttpOptions, RemoteServer, serve_http};
use crate::session::{Access, Session};

/// Number of requests of each kind per repetition.
const REQUESTS: usize = 40;

pub const CASES: &[BenchCase] = &[BenchCase {
    name: "http",
    figures: &[
        BenchFigure::without_target("HTTP with 165,000 subscribers: tool call", BenchUnit::Milliseconds),
        BenchFigure::with_target(
            "HTTP with 165,000 subscribers: small query, 99th percentile",
            BenchUnit::Milliseconds,
            50.0,
            None,
        ),
        BenchFigure::without_target("HTTP with 165,000 subscribers: week", BenchUnit::Milliseconds),
    ],
    needs_new_process: false,
    is_slow: false,
    measure: measure_http,
}];

fn measure_http(bench: &BenchContext) -> Result<Samples, BenchError> {
    let run = save_large_company(bench)?;
    let folder = run_folder(&bench.scratch_folder, &run);
    let session = Session::open(&folder, Access::Write, true)?;
    let (ready, waits) = channel();
    let bound_port = BoundPort::bind(None)?;
    let server = std::thread::spawn(move || {
        let announce = |_: &_| {
            let _ = ready.send(());
        };
        serve_http(session, bound_port, &HttpOptions::default(), announce, |words| eprintln!("{words}"))
    });
    let there = waits.recv().ok().and_then(|()| RemoteServer::find(&folder, &run));
    let samples = there
        .as_ref()
        .ok_or_else(|| to_bench_error("the server does not respond"))
        .and_then(|remote| measure_requests(remote, bench));
    if let Some(remote) = there {
        remote.shut_down().map_err(to_bench_error)?;
    }
    server.join().map_err(|_| to_bench_error("the server has failed"))??;
    samples
}

fn measure_requests(remote: &RemoteServer, bench: &BenchContext) -> Result<Samples, BenchError> {
    let operations = |at: usize| json!({ "tool": "set_daily_spend", "args": { "operations": 400 + at % 2 } });
    let calls = time_requests(remote, "/call", REQUESTS * bench.repetitions, operations)?;
    let mut queries = time_requests(
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
    let weeks = time_requests(remote, "/next-week", bench.repetitions, |_| week.clone())?;
    Ok(vec![calls, queries.get(slowest.saturating_sub(1)).copied().into_iter().collect(), weeks])
}

/// Returns the duration of each request in milliseconds.
fn time_requests(
    remote: &RemoteServer,
    route: &str,
    count: usize,
    body: impl Fn(usize) -> Value,
) -> Result<Vec<f64>, BenchError> {
    let once = |at: usize| {
        let body = body(at);
        let started = Instant::now();
        let reply = remote.post(route, &body).map_err(to_bench_error)?;
        let took = started.elapsed().as_secs_f64() * 1e3;
        match reply.body["success"] == true {
            true => Ok(took),
            false => Err(to_bench_error(format!("{route}: {}", reply.body))),
        }
    };
    (0..count).map(once).collect()
}

fn to_bench_error(why: impl std::fmt::Display) -> BenchError {
    BenchError::new(why.to_string())
}
