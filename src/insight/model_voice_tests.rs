//! Re-simulations use the recorded scores of the language model.

use std::path::Path;

use serde_json::json;

use crate::counterfactual::branch::simulate_branch_with_hashes;
use crate::counterfactual::edits::Edits;
use crate::counterfactual::memory_snapshot::MemorySnapshot;
use crate::counterfactual::recorded_steps::{RecordedStep, steps_from_lines};
use crate::create_branch_with_decisions;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::Trajectory;
use novamind_record::trajectory::record::{Record, Via, VoiceAnswer};
use novamind_session::{NewRun, Origin, Session, Storage, StubBehavior, StubModel, read_origin, verify};

/// Plays three weeks of a company with customers, and publishes a post before the second week.
fn play_three_weeks(runs: &Path, configuration: &Configuration) -> Session {
    let new = NewRun {
        seed: Some(7),
        days: Some(60),
        mode: Mode::Sandbox,
        storage: Storage::Runs(runs.to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, configuration).expect("a run");
    let call = |session: &mut Session, tool: &str, arguments| {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
    };
    for (tool, arguments) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000})),
        ("set_daily_spend", json!({"operations": 200, "development": 200})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 2000}}})),
    ] {
        call(&mut session, tool, arguments);
    }
    for week in 0..3 {
        if week == 1 {
            let text = "We doubled the quota of plan B today and cut its price by 20%.";
            call(&mut session, "post_social_media", json!({ "content": text }));
        }
        let forecasts = session.company().naive_forecasts();
        session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
    session
}

#[test]
fn resimulation_without_edits_reproduces_every_state() {
    let runs = tempfile::tempdir().expect("a folder");
    let stub = StubModel::start(StubBehavior::Correct);
    let session = play_three_weeks(runs.path(), &stub.configuration(true, true, 30));
    drop(stub);
    let folder = session.folder().expect("a folder");
    let (Origin { manifest, params, .. }, trajectory) = read_origin(folder).expect("a run");
    let script = steps_from_lines(&trajectory.lines);
    let start = MemorySnapshot::at_day_0(&manifest, params);
    let outcome = simulate_branch_with_hashes(&start, &script, &Edits::default(), 21).expect("not stopped");
    let reached: Vec<String> = outcome.states.into_iter().map(|(_, (hash, _))| hash).collect();
    let recorded = script.iter().filter_map(|step| match step {
        RecordedStep::Days(days) => Some(days.state_hash.clone()),
        RecordedStep::Call(_) | RecordedStep::Parameter(_) => None,
    });
    assert_eq!(reached, recorded.collect::<Vec<_>>());
    assert_eq!(reached.last(), Some(&session.state_hash().0));
}

#[test]
fn branch_with_decisions_copies_voice_scores() {
    let runs = tempfile::tempdir().expect("a folder");
    let stub = StubModel::start(StubBehavior::Correct);
    let session = play_three_weeks(runs.path(), &stub.configuration(true, true, 30));
    drop(stub);
    // The branch publishes the post again.
    let on = &mut |_| std::ops::ControlFlow::Continue(());
    let kept = create_branch_with_decisions(&session, 1, &[], Mode::Sandbox, on).expect("a branch").session;
    assert_eq!(kept.state_hash(), session.state_hash());
    let path = kept.folder().expect("a folder").to_owned();
    let lines = Trajectory::read(&path.join("trajectory.jsonl")).expect("a trajectory").lines;
    assert!(lines.iter().any(|line| matches!(line.record, Record::Voice(VoiceAnswer::Scores(_)))));
    drop(kept);
    verify(&path).expect("it replays");
}
