//! Lessons: validation of their files, the course of a lesson, its record, and the checks of the bundled lessons.

use std::path::Path;
use std::sync::Arc;

use novamind::course::{Lesson, LessonPage, guess_in_lesson, take_hint, try_step_again};
use novamind::insight::{DecisionEdit, OfRecord, WhatIf, branch_with_decisions};
use novamind::lab::check_plays;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::{Ended, Via};
use novamind::session::{Access, Session, lesson_step, verify};
use serde_json::json;

use crate::support::lessons::{self, code, lesson_of, week};

/// Two steps of two weeks, with a numeric guess and a choice.
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

fn begin(folder: &Path) -> Session {
    lessons::begin(folder, "two", PLAN)
}

#[test]
fn wrong_files_name_line_and_key() {
    let folder = tempfile::tempdir().expect("a folder");
    for (old, new, part) in [
        ("minutes = 5", "minutes = 5\nlevel = 3", "line 4"),
        ("set_prices {\"A\": 12", "set_price {\"A\": 12", "there is no tool set_price"),
        ("figure = \"running costs\"", "figure = \"luck\"", "there is no figure luck"),
        ("figure = \"running costs\"", "figure = \"satisfaction\"", "not measured in lessons"),
        ("pitfall = \"costly\"", "pitfall = \"cheap\"", "bad.pitfall"),
        ("{after}", "{before}", "line 38, measured"),
        ("hints = [\"Wait.\"]", "hints = []", "one to three hints"),
        ("weeks = 2\nhints = [\"Wait", "weeks = 0\nhints = [\"Wait", "at least one week"),
        ("[[bad.play]]\nweek = 1", "[[bad.play]]\nweek = 0", "no week 0 in which a student decides"),
        ("answer = 2", "answer = 3", "the number of one of them"),
        ("at_least = 1\n", "at_least = 1\nat_most = 2\n", "one of at_least, at_most and relative"),
        ("calls = ['set_daily", "calls = ['rules: reject rest', 'set_daily", "accepted"),
        (
            "[good]\ntext = \"Nothing.\"",
            "[good]\ntext = \"x\"\n[[good.play]]\nweek = 2\ncalls = ['rules: reject rest']",
            "accepted",
        ),
    ] {
        assert!(PLAN.contains(old), "{old}");
        let said = lesson_of(folder.path(), "two", &PLAN.replacen(old, new, 1)).err();
        let said = said.unwrap_or_else(|| "accepted".to_owned());
        assert!(said.contains(part), "{new}: {said}");
    }
}

#[test]
fn a_lesson_asks_judges_and_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin(folder.path());
    assert_eq!(session.day(), 7);
    assert_eq!(code(week(&mut session)), "guess_first");
    let refused = session.call("set_model_tiers", &json!({"A": 2}), Via::Plain);
    assert_eq!(code(refused), "not_in_this_lesson");
    let refused = session.call("set_capacity_tier", &json!({"tier": 3}), Via::Plain);
    assert_eq!(code(refused), "not_in_this_lesson");
    assert_eq!(code(guess_in_lesson(&mut session, f64::NAN)), "guess_not_possible");
    guess_in_lesson(&mut session, 950_000.0).expect("a guess");
    assert_eq!(code(guess_in_lesson(&mut session, 1.0)), "no_question");
    assert_eq!(take_hint(&mut session).expect("a hint"), "Try.");
    week(&mut session).expect("a week");
    week(&mut session).expect("a week");
    let standing = session.lesson().expect("a lesson");
    let cash = session.weeks().last().expect("a week").cash;
    assert_eq!(standing.outcome(0).expect("an outcome").value, Some(cash));
    assert_eq!(standing.goals(0)[0].met, Some(cash >= 900_000.0));
    assert_eq!(lesson_step(&session), Some(1));
    assert_eq!(session.params().quality.base_product_quality, 0.4);
    assert_eq!(code(guess_in_lesson(&mut session, 3.0)), "guess_not_possible");
    guess_in_lesson(&mut session, 2.0).expect("a guess");
    week(&mut session).expect("a week");
    week(&mut session).expect("a week");
    assert_eq!(session.ended(), Some(Ended::Lesson));
    assert!(session.lesson().expect("a lesson").has_reached_all());
    assert_eq!(session.lesson().expect("a lesson").outcome(1).expect("an outcome").met, Some(true));
    assert_eq!(code(week(&mut session)), "lesson_over");
}

#[test]
fn what_if_and_branch_wait_for_the_guess_and_decide_nothing_that_the_lesson_locks() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin(folder.path());
    let place = session.folder().expect("a folder").to_owned();
    let what_if = || WhatIf::read(&place).expect("it is read");
    let on = &|_, _| std::ops::ControlFlow::Continue(());
    assert_eq!(code(what_if().decisions(1)), "guess_first");
    assert_eq!(code(what_if().compare(1, None, &[], on)), "guess_first");
    assert_eq!(code(session.branch(1, Mode::Sandbox)), "guess_first");
    guess_in_lesson(&mut session, 950_000.0).expect("a guess");
    week(&mut session).expect("a week");
    let decided = |text: &str| vec![vec![text.parse::<DecisionEdit>().expect(text)]];
    for text in [
        "set_model_tiers {\"A\": 2}",
        "set_model_tiers {\"A\": 3}",
        "keep set_usage_quotas",
        "capacity follows usage",
    ] {
        let refused = what_if().compare(2, None, &decided(text), on);
        assert_eq!(code(refused), "not_in_this_lesson", "{text}");
        let mut go_on = |_| std::ops::ControlFlow::Continue(());
        let adopted = branch_with_decisions(&session, 2, &decided(text)[0], Mode::Sandbox, &mut go_on);
        assert_eq!(code(adopted.map(drop)), "not_in_this_lesson", "{text}");
    }
    let found = what_if().compare(2, None, &decided("set_prices {\"A\": 10}"), on);
    assert!(found.expect("branches").is_some());
    drop(session.branch(2, Mode::Sandbox).expect("a branch"));
}

#[test]
fn the_record_of_a_lesson_is_replayed_and_taken_up_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin(folder.path());
    guess_in_lesson(&mut session, 1.0).expect("a guess");
    take_hint(&mut session).expect("a hint");
    week(&mut session).expect("a week");
    let (hash, own) = (session.state_hash(), session.folder().expect("a folder").to_owned());
    let page = LessonPage::of(&mut session).expect("a page");
    drop(session);
    let mut again = Session::open(&own, Access::Write, true).expect("it opens");
    assert_eq!(again.state_hash(), hash);
    assert_eq!(LessonPage::of(&mut again).expect("a page"), page);
    week(&mut again).expect("a week");
    guess_in_lesson(&mut again, 1.0).expect("a guess");
    week(&mut again).expect("a week");
    week(&mut again).expect("a week");
    assert_eq!(again.lesson().expect("a lesson").outcome(1).expect("an outcome").met, Some(false));
    drop(again);
    verify(&own).expect("the record is sound");
}

#[test]
fn a_company_that_goes_bankrupt_in_a_lesson_is_judged_before_the_end_and_once() {
    for (operations, step) in [(100_000, 0), (45_000, 1)] {
        let folder = tempfile::tempdir().expect("a folder");
        let mut session = begin(folder.path());
        let spend = json!({"operations": operations, "development": 0});
        session.call("set_daily_spend", &spend, Via::Plain).expect("spending");
        for own in 0..=step {
            guess_in_lesson(&mut session, 1.0).expect("a guess");
            for _ in 0..2 {
                if session.ended().is_none() {
                    week(&mut session).expect("a week");
                }
            }
            assert_eq!(session.ended().is_some(), own == step, "{operations}");
        }
        assert_eq!(session.ended(), Some(Ended::Bankruptcy));
        assert!(!session.day().is_multiple_of(7), "the cash runs out within a week");
        let standing = session.lesson().expect("a lesson").clone();
        let cash = session.weeks().last().expect("a week").cash;
        assert_eq!(standing.outcome(step).expect("an outcome").met, (step == 1).then_some(false));
        assert_eq!(standing.goals(step)[0].met, Some(false));
        assert_eq!(standing.goals(step)[0].value, Some(cash));
        assert_eq!(standing.pitfalls(), ["costly"]);
        let own = session.folder().expect("a folder").to_owned();
        drop(session);
        let again = Session::open(&own, Access::Write, true).expect("it opens");
        assert_eq!(again.lesson(), Some(&standing));
        assert!(!own.join("afterwards.jsonl").exists(), "nothing comes after the end");
    }
}

#[test]
fn a_week_whose_judgement_did_not_reach_the_disk_is_judged_when_the_run_is_opened() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin(folder.path());
    guess_in_lesson(&mut session, 1.0).expect("a guess");
    week(&mut session).expect("a week");
    week(&mut session).expect("a week");
    let standing = session.lesson().expect("a lesson").clone();
    let own = session.folder().expect("a folder").to_owned();
    drop(session);
    let path = own.join("trajectory.jsonl");
    let text = std::fs::read_to_string(&path).expect("lines");
    let lines: Vec<&str> = text.lines().collect();
    let last_week = lines.iter().rposition(|line| line.contains("\"kind\":\"week\"")).expect("a week");
    assert!(lines.len() - last_week > 3, "outcome, goal, a parameter and the next step follow");
    for kept in last_week + 1..lines.len() {
        std::fs::write(&path, lines[..kept].join("\n") + "\n").expect("written");
        // The database would store the position of the removed lines.
        for entry in std::fs::read_dir(&own).expect("a folder").flatten() {
            if entry.file_name().to_string_lossy().starts_with("world.db") {
                std::fs::remove_file(entry.path()).expect("removed");
            }
        }
        let again = Session::open(&own, Access::Write, true).expect("it opens");
        assert_eq!(again.lesson(), Some(&standing), "{kept}");
        assert_eq!(again.params().quality.base_product_quality, 0.4, "{kept}");
    }
}

#[test]
fn another_try_begins_where_the_step_began_and_is_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin(folder.path());
    guess_in_lesson(&mut session, 1.0).expect("a guess");
    week(&mut session).expect("a week");
    week(&mut session).expect("a week");
    guess_in_lesson(&mut session, 1.0).expect("a guess");
    let begun = session.state_hash();
    week(&mut session).expect("a week");
    let again = try_step_again(&session, 1).expect("another try");
    assert_eq!(again.state_hash(), begun);
    let standing = again.lesson().expect("a lesson");
    assert_eq!((standing.tries(0), standing.tries(1)), (1, 2));
    assert_eq!((standing.guess(0), standing.guess(1)), (Some(1.0), Some(1.0)), "the first guess stands");
    assert!(standing.goals(0).len() == 1 && standing.goals(1).is_empty());
    let third = try_step_again(&again, 1).expect("a third try");
    assert_eq!(third.lesson().expect("a lesson").tries(1), 3);
    assert_eq!(code(try_step_again(&third, 2)), "step_unknown");
}

#[test]
fn a_lesson_that_was_altered_beside_its_run_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = begin(folder.path());
    let own = session.folder().expect("a folder").to_owned();
    drop(session);
    let path = own.join("lesson.toml");
    let text = std::fs::read_to_string(&path).expect("a plan");
    std::fs::write(&path, text.replace("at_least = 900_000", "at_least = 1")).expect("a file");
    let problem = Session::open(&own, Access::Write, true).err().expect("it is refused").to_string();
    assert!(problem.contains("lesson.toml") && problem.contains("not the recorded lesson"), "{problem}");
}

#[test]
fn pitfalls_are_met_once_and_reference_plays_differ() {
    let folder = tempfile::tempdir().expect("a folder");
    let lesson = Arc::new(lesson_of(folder.path(), "two", PLAN).expect("a lesson"));
    let check = check_plays(&lesson, &[7, 8]).expect("plays");
    assert!(check.problems().is_empty(), "{:?}", check.problems());
    assert_eq!(check.bad[0].pitfalls, ["costly"]);
    assert!(check.good[0].pitfalls.is_empty());
}

/// The shortest lessons, which every test run plays.
const SHORT: [&str; 4] = ["ads-in-the-product", "ladder", "list-price", "price-follows-quality"];

fn keep_their_promises(names: &[&str]) {
    let configuration = Configuration::shipped();
    let shipped = configuration.lessons();
    assert_eq!(shipped.len(), 12);
    for name in shipped {
        let lesson =
            Arc::new(Lesson::named(&name, &configuration).unwrap_or_else(|error| panic!("{name}: {error}")));
        assert!(!lesson.debrief.is_empty() && !lesson.for_teachers.is_empty(), "{name}");
        if names.is_empty() || names.contains(&name.as_str()) {
            let check = check_plays(&lesson, &[2]).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(check.problems().is_empty(), "{name}: {:?}", check.problems());
        }
    }
}

#[test]
fn short_lessons_keep_their_promises_on_a_seed() {
    keep_their_promises(&SHORT);
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn all_lessons_keep_their_promises_on_a_seed() {
    keep_their_promises(&[]);
}
