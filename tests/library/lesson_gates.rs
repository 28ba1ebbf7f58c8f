//! Special cases of lessons: reference plays with rules, hidden state before the last part ends, interrupted starts,
//! and figures measured in a separate simulation.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use novamind::course::{Lesson, retry_step, start_part};
use novamind::insight::{Inspect, WeekQuestion, open_for_inspection, record_figure_inspection};
use novamind::rules::calls_for_waiting_threads;
use novamind::session::{Access, PartPlay, Playback, SealKey, Session, can_inspect, play_part};
use novamind::world::identifiers::Group;

use crate::support::lessons::{advance_lesson_week, begin_lesson, rejection_code, write_lesson};

fn run_folder(session: &Session) -> PathBuf {
    session.folder().expect("a folder").to_owned()
}

/// A lesson with two parts on the same seed. Each part has two weeks after an initial week.
const PARTS: &str = r#"
title = "Two parts"
minutes = 5
learning_goal = "You find out that luck comes twice."

[[part]]
title = "First"
seed = 7
start_weeks = 1

[[part.start]]
week = 0
calls = [
  'set_prices {"A": 12, "B": 25, "C": 55}',
  'set_model_tiers {"A": 1, "B": 2, "C": 4}',
]

[[part.start]]
week = 1
calls = ['set_daily_spend {"operations": 100, "development": 0}']

[[part.step]]
title = "Once"
text = "Wait."
weeks = 2
hints = ["Wait."]
parameters = { "quality.base_product_quality" = 0.4, "ads.log_curve_k" = 8.0 }

[[part]]
title = "Second"
seed = 7

[[part.step]]
title = "Again"
text = "Wait once more."
weeks = 1
hints = ["Wait."]

[[pitfall]]
name = "none"
figure = "cash"
below = 0.5
say = "Nothing is left."

[good]
text = "Nothing."

[bad]
text = "Nothing either."
pitfall = "none"
"#;

#[test]
fn hidden_state_requires_the_last_part_to_be_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut first = begin_lesson(folder.path(), "gates", PARTS);
    advance_lesson_week(&mut first).expect("a week");
    advance_lesson_week(&mut first).expect("a week");
    assert!(first.ended().is_some());
    let path = run_folder(&first);
    let hidden = |session: &mut Session| {
        assert!(session.check_inspection().is_err());
        let refused = session.check_inspection().expect_err("it is refused");
        assert!(refused.message.contains("after its last part"), "{refused}");
        // Causes are computed as for an unfinished run, without hidden figures and inspections.
        let week_question: WeekQuestion = "satisfaction 3".parse().expect("a question");
        assert_eq!(rejection_code(record_figure_inspection(session, &week_question)), "not_in_this_mode");
        assert!(!can_inspect(session.manifest(), session.ended(), session.folder()));
    };
    hidden(&mut first);
    let mut second = start_part(&first, 1).expect("the second part");
    hidden(&mut first);
    drop(first);
    let playback = Playback::open(&path).expect("a replay");
    assert!(!playback.can_inspect());
    assert!(open_for_inspection(&path, SealKey::default()).is_err());
    advance_lesson_week(&mut second).expect("a week");
    assert!(second.ended().is_some() && second.check_inspection().is_ok());
    drop(second);
    let mut first = Session::open(&path, Access::Write, true).expect("it opens");
    assert!(first.check_inspection().is_ok() && Playback::open(&path).expect("a replay").can_inspect());
    first.inspect().quality_equation(Group::parse("S1").expect("a group"), None).expect("a result");
}

#[test]
fn interrupted_lesson_start_is_completed_on_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = begin_lesson(folder.path(), "gates", PARTS);
    let (run_path, hash) = (run_folder(&session), session.state_hash());
    let progress = session.lesson().expect("a lesson").clone();
    let parameters = session.params().ads.log_curve_k;
    drop(session);
    let path = run_path.join("trajectory.jsonl");
    let whole = std::fs::read_to_string(&path).expect("lines");
    let lines: Vec<&str> = whole.lines().collect();
    assert!(lines.len() >= 9, "start, calls, a week, parameters, the step");
    for kept in 1..=lines.len() {
        truncate_run(&run_path, &lines[..kept]);
        let mut again =
            Session::open(&run_path, Access::Write, true).unwrap_or_else(|error| panic!("{kept}: {error}"));
        assert_eq!(again.lesson(), Some(&progress), "{kept} lines were left");
        assert_eq!(again.params().ads.log_curve_k, parameters, "{kept}");
        assert_eq!(again.state_hash(), hash, "{kept} lines were left");
        advance_lesson_week(&mut again).unwrap_or_else(|refusal| panic!("{kept}: {refusal}"));
    }
}

#[test]
fn interrupted_retry_is_counted_on_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_lesson(folder.path(), "gates", PARTS);
    advance_lesson_week(&mut session).expect("a week");
    let again = retry_step(&session, 0).expect("another try");
    let path = run_folder(&again);
    let progress = again.lesson().expect("a lesson").clone();
    assert_eq!(progress.attempt(0), 2);
    drop((again, session));
    let whole = std::fs::read_to_string(path.join("trajectory.jsonl")).expect("lines");
    let lines: Vec<&str> = whole.lines().collect();
    let branch = lines.iter().position(|line| line.contains("\"kind\":\"branch\"")).expect("a branch");
    for kept in branch + 1..=lines.len() {
        truncate_run(&path, &lines[..kept]);
        let again = Session::open(&path, Access::Write, true).expect("it opens");
        assert_eq!(
            again.lesson().map(|lesson_progress| lesson_progress.attempt(0)),
            Some(2),
            "{kept} lines were left"
        );
    }
}

/// Truncates a run to the given lines, as if the program had been killed, and removes the files that store a later position.
fn truncate_run(folder: &Path, lines: &[&str]) {
    std::fs::write(folder.join("trajectory.jsonl"), lines.join("\n") + "\n").expect("written");
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with("world.db") || name.starts_with("snapshot") {
            std::fs::remove_file(entry.path()).expect("removed");
        }
    }
}

/// A lesson with enterprises that wait for an answer. The reference play replies by rules.
const RULE_LESSON: &str = include_str!("../data/lessons/answers-by-rules.toml");

#[test]
fn goal_compares_with_a_reference_play_that_uses_rules() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_lesson(folder.path(), "gates", RULE_LESSON);
    let path = run_folder(&session);
    for _ in 0..3 {
        advance_lesson_week(&mut session).expect("a week");
    }
    // Without an evaluator of the rules, the reference play cannot reply to enterprises, so the step is not judged.
    advance_lesson_week(&mut session).expect("a week");
    assert!(session.lesson().expect("a lesson").goal_results(0).is_empty());
    assert_eq!(rejection_code(advance_lesson_week(&mut session)), "step_not_begun");
    drop(session);
    let mut session = Session::open(&path, Access::Write, true).expect("it opens");
    session.set_rule_evaluator(calls_for_waiting_threads);
    let progress = session.lesson().expect("a lesson").clone();
    let goal = progress.goal_results(0)[0].clone();
    assert!(goal.bound.is_some_and(|bound| bound > 0.0), "{goal:?}");
    assert!(goal.value.zip(goal.bound).is_some_and(|(value, bound)| value < bound), "{goal:?}");
    assert_eq!(goal.met, Some(false));
    assert!(progress.has_started(1));
    advance_lesson_week(&mut session).expect("a week");
    // With the decisions of the reference play, the goal is reached.
    let lesson = Arc::new(write_lesson(folder.path(), "gates", RULE_LESSON).expect("a lesson"));
    let plays = lesson.plan.good.plays.clone();
    let play = PartPlay {
        lesson: &lesson,
        part: 0,
        seed: None,
        scheduled_calls: &plays,
        weeks: None,
        is_judged: true,
        needs_database: false,
    };
    let good = play_part(&play, calls_for_waiting_threads).expect("the reference play");
    let reached = good.lesson().expect("a lesson").goal_results(0)[0].clone();
    assert_eq!(reached.met, Some(true));
    assert_eq!(reached.bound, goal.bound);
    assert_eq!(reached.bound, reached.value.map(|value| value * 0.9));
}

#[test]
fn figure_measurement_uses_a_separate_simulation() {
    let folder = tempfile::tempdir().expect("a folder");
    let measured = r#"
[[measured]]
name = "elsewhere"
text = "cash with rivals"
figure = "cash"
value = 1
scenario = "competitor-off"
parameters = { "quality.base_product_quality" = 0.3 }

[[measured]]
name = "here"
text = "cash"
figure = "cash"
value = 1
"#;
    let lesson =
        Arc::new(write_lesson(folder.path(), "gates", &(PARTS.to_owned() + measured)).expect("a lesson"));
    let [elsewhere, here] = [0, 1].map(|at| lesson.with_figure_parameters(&lesson.plan.measured[at]));
    assert!(Arc::ptr_eq(&here, &lesson));
    let play = |lesson: &Arc<Lesson>| {
        let play = PartPlay {
            lesson,
            part: 0,
            seed: Some(1),
            scheduled_calls: &[],
            weeks: Some(1),
            is_judged: false,
            needs_database: false,
        };
        play_part(&play, calls_for_waiting_threads).expect("a play")
    };
    let [played, session] = [play(&elsewhere), play(&here)];
    assert_eq!(
        (played.manifest().scenario.as_str(), session.manifest().scenario.as_str()),
        ("competitor-off", "default")
    );
    assert!(
        played.params().competitor.competitor_events_disabled
            && !session.params().competitor.competitor_events_disabled
    );
    let wrong = measured.replace("competitor-off", "no-such-world");
    let problem =
        write_lesson(folder.path(), "gates", &(PARTS.to_owned() + &wrong)).expect_err("it is refused");
    assert!(problem.contains("no-such-world") && problem.contains("line "), "{problem}");
    let wrong = measured.replace("quality.base_product_quality", "quality.luck");
    let problem =
        write_lesson(folder.path(), "gates", &(PARTS.to_owned() + &wrong)).expect_err("it is refused");
    assert!(problem.contains("quality.luck"), "{problem}");
}
