//! Sample runs that several tests share.

use serde_json::{Value, json};

use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::Via;
use novamind_record::trajectory::{Line, Trajectory};
use novamind_session::{NewRun, Session, Storage};

/// Plays a run in memory for the given number of weeks, with reasonable opening decisions and one change in the third
/// week.
pub fn play_weeks(weeks: usize) -> Session {
    play_run(200, 1_000_000.0, weeks, &opening_calls())
}

/// Simulates weeks with naive forecasts.
pub fn advance_weeks(session: &mut Session, weeks: usize) {
    for _ in 0..weeks {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
}

/// Returns a run in memory that has reached its last day.
pub fn finished_run() -> Session {
    play_run(35, 1_000_000.0, 5, &opening_calls())
}

/// Returns a run in memory that goes bankrupt because of high spending.
pub fn bankrupt_run() -> Session {
    let mut calls = opening_calls();
    calls.push(("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 16000}})));
    play_run(200, 250_000.0, 8, &calls)
}

fn opening_calls() -> Vec<(&'static str, Value)> {
    vec![
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60000, "B": 250000, "C": 1200000})),
        ("set_daily_spend", json!({"operations": 200, "development": 200})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 6000}})),
        (
            "set_targeted_ad_spend",
            json!({"targeted_spend": {"content_marketing": {"S1": 750}, "linkedin": {"S1": 250}}}),
        ),
        (
            "post_social_media",
            json!({"content": "NovaMind <opens> today | with *three* plans & fair prices."}),
        ),
    ]
}

fn play_run(days: u32, cash: f64, weeks: usize, calls: &[(&str, Value)]) -> Session {
    let new = NewRun {
        seed: Some(7),
        days: Some(days),
        cash: Some(cash),
        storage: Storage::Memory,
        participant: Some("Ada <ada@example.org>".to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    for week in 0..weeks {
        let call = |session: &mut Session, tool: &str, arguments: &Value| {
            session
                .call(tool, arguments, Via::Script)
                .unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
        };
        match week {
            0 => calls.iter().for_each(|(tool, arguments)| call(&mut session, tool, arguments)),
            2 => call(&mut session, "set_prices", &json!({"B": 22})),
            _ => {}
        }
        let rationale = if week == 2 {
            "If B is cheaper, more will take it; otherwise we go back | <b>B</b>\nand wait"
        } else {
            "as planned"
        };
        let forecasts = session.company().naive_forecasts();
        let week = session.advance(rationale, &forecasts, Via::Script, &mut |_| {}).expect("a week");
        if week.ended.is_some() {
            break;
        }
    }
    session
}

/// Records a short run with a variety of events on disk, and returns its session and its lines.
pub fn recorded_run() -> (Session, Vec<Line>) {
    let runs = tempfile::tempdir().expect("a folder");
    let new = NewRun {
        days: Some(21),
        participant: Some("P 07".to_owned()),
        storage: Storage::Runs(runs.path().to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    session.call("set_prices", &json!({"A": 12, "B": 25, "C": 55}), Via::Form).expect("prices");
    session.call("set_prices", &json!({"A": -1}), Via::Form).expect_err("no price");
    session.query("SELECT count(*) FROM ledger").expect("a count");
    session.query("SELECT c_max FROM nowhere").expect_err("no table");
    session.activity().record_view("cash", "overview", 1500);
    session.activity().record_view("cash", "overview", 500);
    for rationale in ["If it goes well, we wait", "as planned"] {
        let forecasts = session.company().naive_forecasts();
        session.advance(rationale, &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    session.set_notes("watch costs").expect("a memo");
    let path = session.folder().expect("a folder").join("trajectory.jsonl");
    let lines = Trajectory::read(&path).expect("it reads").lines;
    (session, lines)
}
