//! Lessons: validation of the files, playing a lesson, its record, and the checks of the bundled lessons.

use std::path::Path;
use std::sync::Arc;

use novamind::course::{Lesson, LessonStatus, retry_step, submit_guess, take_hint};
use novamind::insight::{DecisionEdit, RecordAnalysis, WhatIf, create_branch_with_decisions};
use novamind::lab::check_plays;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::{RunEndReason, Via};
use novamind::session::{Access, Session, lesson_step, verify};
use serde_json::json;

use crate::support::lessons::{self, advance_lesson_week, rejection_code, write_lesson};

/// A lesson with two steps of two weeks, one with a numeric guess and one with a choice.
const PLAN: &str = r#"
title = "Two steps"
minutes = 5
learning_goal = "You find out how a lesson goes."

[access]
tools = ["set_prices", "set_daily_spend"]

[[part]]
scenario = "competitor-off"
seed = 7
capacity = "follows usage"
start_weeks = 1

[[part.start]]
week = 0
calls = [
  'set_prices {"A": 12, "B": 25, "C": 55}',
  'set_model_tiers {"A": 1, "B": 2, "C": 4}',
  'set_usage_quotas {"A": 60000, "B": 250000, "C": 1200000}',
  'set_targeted_ad_spend {"targeted_spend": {"content_marketing": {"S1": 750}}}',
]

[[part.step]]
title = "First"
text = "Spend on operations."
weeks = 2
hints = ["Try.", "Try more."]
guess = { question = "How much cash?", figure = "cash", unit = "$" }

[[part.step.goal]]
text = "Cash of $900,000"
figure = "cash"
at_least = 900_000

[[part.step]]
title = "Second"
text = "Better quality; {after} of cash with the good play."
weeks = 2
hints = ["Wait."]
parameters = { "quality.base_product_quality" = 0.4 }
guess = { question = "More leads that buy?", choices = ["no", "yes"], answer = 2 }

[[part.step.goal]]
text = "As much cash as the reference"
figure = "cash"
relative = 0.999

[[part.step.goal]]
text = "Subscribers by statement"
sql = "SELECT count(*) FROM subscriptions WHERE status = 'subscribed'"
at_least = 1

[[pitfall]]
name = "costly"
figure = "running costs"
above = 60_000
say = "That is a lot."

[good]
text = "Nothing."

[bad]
text = "Much too much."
pitfall = "costly"
[[bad.play]]
week = 1
calls = ['set_daily_spend {"operations": 30000, "development": 0}']

[[measured]]
name = "after"
text = "cash after five weeks"
figure = "cash"
value = 960_000
"#;

fn begin_lesson(folder: &Path) -> Session {
    lessons::begin_lesson(folder, "two", PLAN)
}

#[test]
fn invalid_lesson_files_are_reported_with_line_and_key() {
    let folder = tempfile::tempdir().expect("a folder");
    for (old, new, part) in [
        ("minutes = 5", "minutes = 5\nlevel = 3", "line 4"),
        ("set_prices {\"A\": 12", "set_price {\"A\": 12", "there is no tool set_price"),
        ("figure = \"running costs\"", "figure = \"luck\"", "there is no figure luck"),
        ("figure = \"running costs\"", "figure = \"satisfaction\"", "not available in lessons"),
        ("pitfall = \"costly\"", "pitfall = \"cheap\"", "bad.pitfall"),
        ("{after}", "{before}", "line 38, measured"),
        ("hints = [\"Wait.\"]", "hints = []", "one to three hints"),
        ("weeks = 2\nhints = [\"Wait", "weeks = 0\nhints = [\"Wait", "at least one week"),
        ("[[bad.play]]\nweek = 1", "[[bad.play]]\nweek = 0", "no week 0 in which a student decides"),
        ("answer = 2", "answer = 3", "the number of a choice"),
        ("at_least = 1\n", "at_least = 1\nat_most = 2\n", "one of `at_least`, `at_most` and `relative`"),
        ("calls = ['set_daily", "calls = ['rules: reject rest', 'set_daily", "accepted"),
        (
            "[good]\ntext = \"Nothing.\"",
            "[good]\ntext = \"x\"\n[[good.play]]\nweek = 2\ncalls = ['rules: reject rest']",
            "accepted",
        ),
    ] {
        assert!(PLAN.contains(old), "{old}");
        let problem = write_lesson(folder.path(), "two", &PLAN.replacen(old, new, 1)).err();
        let problem = problem.unwrap_or_else(|| "accepted".to_owned());
        assert!(problem.contains(part), "{new}: {problem}");
    }
}

#[test]
fn lesson_asks_questions_judges_goals_and_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_lesson(folder.path());
    assert_eq!(session.day(), 7);
    assert_eq!(rejection_code(advance_lesson_week(&mut session)), "guess_first");
    let refused = session.call("set_model_tiers", &json!({"A": 2}), Via::Plain);
    assert_eq!(rejection_code(refused), "not_in_this_lesson");
    let refused = session.call("set_capacity_tier", &json!({"tier": 3}), Via::Plain);
    assert_eq!(rejection_code(refused), "not_in_this_lesson");
    assert_eq!(rejection_code(submit_guess(&mut session, f64::NAN)), "guess_not_possible");
    submit_guess(&mut session, 950_000.0).expect("a guess");
    assert_eq!(rejection_code(submit_guess(&mut session, 1.0)), "no_question");
    assert_eq!(take_hint(&mut session).expect("a hint"), "Try.");
    advance_lesson_week(&mut session).expect("a week");
    advance_lesson_week(&mut session).expect("a week");
    let progress = session.lesson().expect("a lesson");
    let cash = session.weeks().last().expect("a week").cash;
    assert_eq!(progress.outcome(0).expect("an outcome").value, Some(cash));
    assert_eq!(progress.goal_results(0)[0].met, Some(cash >= 900_000.0));
    assert_eq!(lesson_step(&session), Some(1));
    assert_eq!(session.params().quality.base_product_quality, 0.4);
    assert_eq!(rejection_code(submit_guess(&mut session, 3.0)), "guess_not_possible");
    submit_guess(&mut session, 2.0).expect("a guess");
    advance_lesson_week(&mut session).expect("a week");
    advance_lesson_week(&mut session).expect("a week");
    assert_eq!(session.ended(), Some(RunEndReason::Lesson));
    assert!(session.lesson().expect("a lesson").has_reached_all_goals());
    assert_eq!(session.lesson().expect("a lesson").outcome(1).expect("an outcome").met, Some(true));
    assert_eq!(rejection_code(advance_lesson_week(&mut session)), "lesson_over");
}

#[test]
fn what_if_and_branch_respect_lesson_locks() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_lesson(folder.path());
    let place = session.folder().expect("a folder").to_owned();
    let what_if = || WhatIf::open(&place).expect("it is read");
    let on = &|_, _| std::ops::ControlFlow::Continue(());
    assert_eq!(rejection_code(what_if().decisions(1)), "guess_first");
    assert_eq!(rejection_code(what_if().compare(1, None, &[], on)), "guess_first");
    assert_eq!(rejection_code(session.branch(1, Mode::Sandbox)), "guess_first");
    submit_guess(&mut session, 950_000.0).expect("a guess");
    advance_lesson_week(&mut session).expect("a week");
    let decided = |text: &str| vec![vec![text.parse::<DecisionEdit>().expect(text)]];
    for text in [
        "set_model_tiers {\"A\": 2}",
        "set_model_tiers {\"A\": 3}",
        "keep set_usage_quotas",
        "capacity follows usage",
    ] {
        let refused = what_if().compare(2, None, &decided(text), on);
        assert_eq!(rejection_code(refused), "not_in_this_lesson", "{text}");
        let mut go_on = |_| std::ops::ControlFlow::Continue(());
        let adopted = create_branch_with_decisions(&session, 2, &decided(text)[0], Mode::Sandbox, &mut go_on);
        assert_eq!(rejection_code(adopted.map(drop)), "not_in_this_lesson", "{text}");
    }
    let found = what_if().compare(2, None, &decided("set_prices {\"A\": 10}"), on);
    assert!(found.expect("branches").is_some());
    drop(session.branch(2, Mode::Sandbox).expect("a branch"));
}

#[test]
fn lesson_run_verifies_and_resumes() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_lesson(folder.path());
    submit_guess(&mut session, 1.0).expect("a guess");
    take_hint(&mut session).expect("a hint");
    advance_lesson_week(&mut session).expect("a week");
    let (hash, path) = (session.state_hash(), session.folder().expect("a folder").to_owned());
    let page = LessonStatus::from_session(&mut session).expect("a page");
    drop(session);
    let mut again = Session::open(&path, Access::Write, true).expect("it opens");
    assert_eq!(again.state_hash(), hash);
    assert_eq!(LessonStatus::from_session(&mut again).expect("a page"), page);
    advance_lesson_week(&mut again).expect("a week");
    submit_guess(&mut again, 1.0).expect("a guess");
    advance_lesson_week(&mut again).expect("a week");
    advance_lesson_week(&mut again).expect("a week");
    assert_eq!(again.lesson().expect("a lesson").outcome(1).expect("an outcome").met, Some(false));
    drop(again);
    verify(&path).expect("it verifies");
}

#[test]
fn bankruptcy_in_a_lesson_is_evaluated_once() {
    for (operations, step) in [(100_000, 0), (45_000, 1)] {
        let folder = tempfile::tempdir().expect("a folder");
        let mut session = begin_lesson(folder.path());
        let spend = json!({"operations": operations, "development": 0});
        session.call("set_daily_spend", &spend, Via::Plain).expect("spending");
        for number in 0..=step {
            submit_guess(&mut session, 1.0).expect("a guess");
            for _ in 0..2 {
                if session.ended().is_none() {
                    advance_lesson_week(&mut session).expect("a week");
                }
            }
            assert_eq!(session.ended().is_some(), number == step, "{operations}");
        }
        assert_eq!(session.ended(), Some(RunEndReason::Bankruptcy));
        assert!(!session.day().is_multiple_of(7), "the cash runs out within a week");
        let progress = session.lesson().expect("a lesson").clone();
        let cash = session.weeks().last().expect("a week").cash;
        assert_eq!(progress.outcome(step).expect("an outcome").met, (step == 1).then_some(false));
        assert_eq!(progress.goal_results(step)[0].met, Some(false));
        assert_eq!(progress.goal_results(step)[0].value, Some(cash));
        assert_eq!(progress.triggered_pitfall_names(), ["costly"]);
        let path = session.folder().expect("a folder").to_owned();
        drop(session);
        let again = Session::open(&path, Access::Write, true).expect("it opens");
        assert_eq!(again.lesson(), Some(&progress));
        assert!(!path.join("afterwards.jsonl").exists(), "nothing comes after the end");
    }
}

#[test]
fn missing_evaluation_is_added_on_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_lesson(folder.path());
    submit_guess(&mut session, 1.0).expect("a guess");
    advance_lesson_week(&mut session).expect("a week");
    advance_lesson_week(&mut session).expect("a week");
    let progress = session.lesson().expect("a lesson").clone();
    let run_path = session.folder().expect("a folder").to_owned();
    drop(session);
    let path = run_path.join("trajectory.jsonl");
    let text = std::fs::read_to_string(&path).expect("lines");
    let lines: Vec<&str> = text.lines().collect();
    let last_week = lines.iter().rposition(|line| line.contains("\"kind\":\"week\"")).expect("a week");
    assert!(lines.len() - last_week > 3, "outcome, goal, a parameter and the next step follow");
    for kept in last_week + 1..lines.len() {
        std::fs::write(&path, lines[..kept].join("\n") + "\n").expect("written");
        // The database is removed as well, because it stores the position of the removed lines.
        for entry in std::fs::read_dir(&run_path).expect("a folder").flatten() {
            if entry.file_name().to_string_lossy().starts_with("world.db") {
                std::fs::remove_file(entry.path()).expect("removed");
            }
        }
        let again = Session::open(&run_path, Access::Write, true).expect("it opens");
        assert_eq!(again.lesson(), Some(&progress), "{kept}");
        assert_eq!(again.params().quality.base_product_quality, 0.4, "{kept}");
    }
}

#[test]
fn retry_restarts_the_step_and_is_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_lesson(folder.path());
    submit_guess(&mut session, 1.0).expect("a guess");
    advance_lesson_week(&mut session).expect("a week");
    advance_lesson_week(&mut session).expect("a week");
    submit_guess(&mut session, 1.0).expect("a guess");
    let begun = session.state_hash();
    advance_lesson_week(&mut session).expect("a week");
    let again = retry_step(&session, 1).expect("another try");
    assert_eq!(again.state_hash(), begun);
    let progress = again.lesson().expect("a lesson");
    assert_eq!((progress.attempt(0), progress.attempt(1)), (1, 2));
    assert_eq!((progress.guess(0), progress.guess(1)), (Some(1.0), Some(1.0)), "the first guess is kept");
    assert!(progress.goal_results(0).len() == 1 && progress.goal_results(1).is_empty());
    let third = retry_step(&again, 1).expect("a third try");
    assert_eq!(third.lesson().expect("a lesson").attempt(1), 3);
    assert_eq!(rejection_code(retry_step(&third, 2)), "step_unknown");
}

#[test]
fn modified_lesson_is_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = begin_lesson(folder.path());
    let run_path = session.folder().expect("a folder").to_owned();
    drop(session);
    let path = run_path.join("lesson.toml");
    let text = std::fs::read_to_string(&path).expect("a plan");
    std::fs::write(&path, text.replace("at_least = 900_000", "at_least = 1")).expect("a file");
    let problem = Session::open(&run_path, Access::Write, true).err().expect("it is refused").to_string();
    assert!(problem.contains("lesson.toml") && problem.contains("not the recorded lesson"), "{problem}");
}

#[test]
fn pitfalls_are_triggered_once_and_reference_plays_differ() {
    let folder = tempfile::tempdir().expect("a folder");
    let lesson = Arc::new(write_lesson(folder.path(), "two", PLAN).expect("a lesson"));
    let check = check_plays(&lesson, &[7, 8]).expect("plays");
    assert!(check.describe_problems().is_empty(), "{:?}", check.describe_problems());
    assert_eq!(check.pitfall_results[0].pitfalls, ["costly"]);
    assert!(check.reference_results[0].pitfalls.is_empty());
}

/// The shortest lessons, which every test run plays.
const SHORT_LESSONS: [&str; 4] = ["ads-in-the-product", "ladder", "list-price", "price-follows-quality"];

fn check_lessons(names: &[&str]) {
    let configuration = Configuration::bundled();
    let bundled = configuration.lesson_names();
    assert_eq!(bundled.len(), 12);
    for name in bundled {
        let lesson =
            Arc::new(Lesson::load(&name, &configuration).unwrap_or_else(|error| panic!("{name}: {error}")));
        assert!(!lesson.debrief.is_empty() && !lesson.instructor_notes.is_empty(), "{name}");
        if names.is_empty() || names.contains(&name.as_str()) {
            let check = check_plays(&lesson, &[2]).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(check.describe_problems().is_empty(), "{name}: {:?}", check.describe_problems());
        }
    }
}

#[test]
fn short_lessons_pass_their_check_on_a_seed() {
    check_lessons(&SHORT_LESSONS);
}

#[test]
fn lesson_passes_its_check_under_release_2() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("ladder.toml");
    let lesson = Lesson::load("ladder", &Configuration::bundled()).expect("a lesson");
    lesson.copy_to(&path).expect("a copy");
    let plan = std::fs::read_to_string(&path).expect("a plan").replace("\"competitor-off\"", "\"release-2\"");
    std::fs::write(&path, plan).expect("a plan");
    let lesson = Lesson::from_file(&path).expect("a lesson");
    assert_eq!(lesson.plan.parts[0].scenario, "release-2");
    let check = check_plays(&Arc::new(lesson), &[2]).expect("it plays");
    assert!(check.describe_problems().is_empty(), "{:?}", check.describe_problems());
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn all_lessons_pass_their_check_on_a_seed() {
    check_lessons(&[]);
}
