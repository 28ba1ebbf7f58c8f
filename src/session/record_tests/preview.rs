//! Tests of the preview of a run.

use crate::create::{NewRun, Storage};
use crate::play::Session;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::preview::*;
use novamind_record::trajectory::record::Via;
use serde_json::json;

#[test]
fn preview_matches_the_session() {
    let runs = tempfile::tempdir().expect("a folder");
    let new = NewRun {
        seed: Some(7),
        days: Some(17),
        storage: Storage::Runs(runs.path().to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    let id = session.manifest().id.clone();
    assert_eq!(read_preview(runs.path(), &id).expect("day 0").cash, [(0, 1_000_000.0)]);
    session.call("set_prices", &json!({"A": 12, "B": 25, "C": 55}), Via::Form).expect("prices");
    session.call("set_daily_spend", &json!({"operations": 200}), Via::Form).expect("spend");
    for _ in 0..3 {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    let preview = read_preview(runs.path(), &id).expect("a preview");
    let days: Vec<u32> = preview.cash.iter().map(|point| point.0).collect();
    assert_eq!(days, [0, 7, 14, 17]);
    for (day, cash) in &preview.cash {
        assert!((cash - session.cash_by_day()[*day as usize]).abs() < 1e-6, "day {day}");
    }
    assert_eq!(preview.subscribers, u64::from(session.company().observe().subscribers));
}

#[test]
fn preview_skips_invalid_lines_and_fails_for_missing_runs() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = runs.path().join("0123abcd");
    let new = NewRun { seed: Some(7), storage: Storage::Runs(runs.path().to_owned()), ..NewRun::default() };
    let session = Session::create(new, &Configuration::bundled()).expect("a run");
    std::fs::rename(session.folder().expect("a folder"), &folder).expect("moved");
    let closing = |cash: f64| {
        format!(
            "{{\"kind\":\"week\",\"day\":7,\"days_run\":7,\"figures\":{{}},\"cash\":{cash},\"state_hash\":\"\",\"parts\":{{}}}}"
        )
    };
    let lines = [
        "{}".to_owned(),
        json!({"kind": "week"}).to_string(),
        closing(1.0).replace("7,\"days_run", "-1,\"days_run"),
        closing(1.0).replace("week", "call"),
        closing(5.0),
        json!({"kind": "end", "day": 7, "reason": "horizon", "cash": 4, "score": 4}).to_string(),
    ];
    std::fs::write(folder.join("trajectory.jsonl"), lines.join("\n")).expect("written");
    let preview = read_preview(runs.path(), "0123abcd").expect("a preview");
    assert_eq!(preview.cash, [(0, 1_000_000.0), (7, 4.0)]);
    assert!(read_preview(runs.path(), "nothing").is_err());
}
