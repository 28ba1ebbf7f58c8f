//! X-ray views of groups, of the market and of random draws: permissions, recorded lines and rejections.

use std::path::Path;

use novamind::insight::{Inspect, RandomPart};
use novamind::record::mode::Mode;
use novamind::record::trajectory::Trajectory;
use novamind::record::trajectory::record::Via;
use novamind::session::{Session, read_afterwards, verify};
use novamind::tools::Rejection;
use novamind::world::identifiers::Group;
use serde_json::json;

use crate::support::company::{advance_week, advance_weeks, apply_opening_decisions, begin_run};
use crate::support::record::inspections;

fn run_in(folder: &Path, mode: Mode) -> Session {
    let mut session = begin_run(folder, mode, 60);
    apply_opening_decisions(&mut session);
    session
}

/// Returns the success or the rejection of every view for a group and a day.
fn call_every_view(session: &mut Session, group: &str, day: Option<u32>) -> Vec<Result<(), Rejection>> {
    let group = Group::parse(group).expect("a group");
    let mut inspector = session.inspect();
    vec![
        inspector.quality_equation(group, day).map(drop),
        inspector.satisfaction_equation(group, day).map(drop),
        inspector.reputation_equation(group, day).map(drop),
        inspector.spillover(day).map(drop),
        inspector.competitor_state(day).map(drop),
        inspector.drift_state(day).map(drop),
        inspector.hidden_values(day).map(drop),
    ]
}

#[test]
fn views_are_unavailable_in_unfinished_non_debug_runs() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = run_in(folder.path(), mode);
        advance_week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let lines = || Trajectory::read(&place.join("trajectory.jsonl")).expect("lines").lines.len();
        let before = lines();
        // The rejection is the same for existing and missing days and for any number of draws.
        let mut answers = call_every_view(&mut session, "S1", None);
        answers.extend(call_every_view(&mut session, "D_E10", Some(3)));
        answers.extend(call_every_view(&mut session, "S1", Some(9000)));
        for part in RandomPart::ALL {
            answers.extend(
                [None, Some(0), Some(3), Some(usize::MAX)]
                    .map(|count| session.inspect().next_draws(part, count).map(drop)),
            );
        }
        for answer in answers {
            let refusal = answer.expect_err("hidden").to_string();
            assert_eq!(
                refusal,
                "not_in_this_mode: the x-ray is available in debug runs and in runs that have ended"
            );
        }
        assert_eq!(lines(), before, "no inspection happened, so no line is recorded");
        session.abandon().expect("it ends");
        assert!(call_every_view(&mut session, "S1", Some(3)).into_iter().all(|answer| answer.is_ok()));
        session.inspect().next_draws(RandomPart::Service, None).expect("a result");
        drop(session);
        let trajectory = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        assert!(inspections(&trajectory).is_empty(), "the end is the last line");
        let after = read_afterwards(&place, &trajectory).expect("lines");
        let expected = [
            "quality S1 3",
            "satisfaction S1 3",
            "reputation S1 3",
            "spillover  3",
            "rivals  3",
            "drift  3",
            "values  3",
            "streams service 8",
        ];
        assert_eq!(inspections(&after), expected);
    }
}

#[test]
fn views_do_not_change_the_state_hash() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut watched = run_in(folder.path(), Mode::Debug);
    let mut alone = run_in(folder.path(), Mode::Debug);
    for _ in 0..4 {
        for session in [&mut watched, &mut alone] {
            session.step(3, &mut |_| {}).expect("days");
            session.call("set_prices", &json!({"A": 10 + session.day()}), Via::Script).expect("a price");
        }
        let day = watched.day();
        for shown in [None, Some(1), Some(day)] {
            assert!(call_every_view(&mut watched, "S1", shown).into_iter().all(|answer| answer.is_ok()));
        }
        for part in RandomPart::ALL {
            watched.inspect().next_draws(part, Some(5)).expect("a result");
        }
        advance_week(&mut watched);
        advance_week(&mut alone);
        assert_eq!(watched.state_hash(), alone.state_hash());
    }
    for answer in call_every_view(&mut watched, "S2", Some(41)) {
        let refusal = answer.expect_err("not simulated").to_string();
        assert!(refusal.starts_with("day_unknown (day): there is no day 41"), "{refusal}");
    }
    let place = watched.folder().expect("a folder").to_owned();
    drop(watched);
    verify(&place).expect("it verifies");
}

#[test]
fn only_draws_are_available_before_the_first_day() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug);
    for answer in call_every_view(&mut session, "S1", None) {
        assert_eq!(
            answer.expect_err("no day").to_string(),
            "day_unknown (day): no day has been simulated yet"
        );
    }
    for part in RandomPart::ALL {
        assert_eq!(session.inspect().next_draws(part, None).expect("a result").day, 1);
    }
}

#[test]
fn view_of_a_past_day_is_stable() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug);
    advance_weeks(&mut session, 3);
    let group = Group::parse("S1").expect("a group");
    let all = |session: &mut Session| {
        let mut inspector = session.inspect();
        (
            inspector.quality_equation(group, Some(12)).expect("a result"),
            inspector.satisfaction_equation(group, Some(12)).expect("a result"),
            inspector.reputation_equation(group, Some(12)).expect("a result"),
            inspector.spillover(Some(12)).expect("a result"),
            inspector.drift_state(Some(12)).expect("a result"),
        )
    };
    let before = all(&mut session);
    session.call("set_prices", &json!({"A": 90}), Via::Script).expect("a price");
    advance_weeks(&mut session, 2);
    assert_eq!(all(&mut session), before);
}
