//! The debrief of a lesson. The student's curve equals the record, and the reference plays equal the plays of the
//! lesson check. The effect of the first different decision equals a re-simulation with this decision.

use std::path::Path;
use std::sync::Arc;

use novamind::course::{
    Debrief, DecisionComparison, FinishedPart, Lesson, ReferencePlay, retry_step, submit_guess, take_hint,
};
use novamind::record::figures::WeekFigure;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::report::{debrief_to_html, debrief_to_markdown};
use novamind::rules::calls_for_waiting_threads;
use novamind::session::{Access, LessonOptions, NewRun, PartPlay, Session, Storage, play_part};
use serde_json::json;

use crate::support::company::{advance_week, call_tool};

fn lesson() -> Arc<Lesson> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lessons/two-weeks.toml");
    Arc::new(Lesson::from_file(&path).expect("a lesson"))
}

fn lesson_judged_by_revenue(folder: &Path) -> Arc<Lesson> {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/lessons");
    let plan = std::fs::read_to_string(from.join("two-weeks.toml")).expect("a plan");
    let (old, new) = ("bank\"\nfigure = \"cash\"", "bank\"\nfigure = \"recurring revenue\"");
    assert!(plan.contains(old), "{plan}");
    std::fs::write(folder.join("two-weeks.toml"), plan.replace(old, new)).expect("a plan");
    std::fs::copy(from.join("two-weeks.md"), folder.join("two-weeks.md")).expect("texts");
    Arc::new(Lesson::from_file(&folder.join("two-weeks.toml")).expect("a lesson"))
}

/// Starts the lesson for a student, with a seed that differs from the seed of the lesson.
fn start_student_lesson(folder: &Path) -> Session {
    start_lesson_from_plan(lesson(), folder)
}

fn start_lesson_from_plan(lesson: Arc<Lesson>, folder: &Path) -> Session {
    let entry = LessonOptions { lesson, part: 0, is_judged: true };
    let storage = Storage::Runs(folder.to_owned());
    let new = NewRun { mode: Mode::Lesson, seed: Some(3), lesson: Some(entry), storage, ..NewRun::default() };
    Session::create(new, &Configuration::bundled()).expect("the lesson begins")
}

/// Plays the lesson to its end, with a price that is set in week `from`.
fn play_lesson(folder: &Path, price: u32, from: u32) -> Session {
    finish_lesson(start_student_lesson(folder), price, from)
}

fn finish_lesson(mut session: Session, price: u32, from: u32) -> Session {
    for at in 0..2 {
        submit_guess(&mut session, 1.0).expect("a guess");
        if at == from {
            call_tool(&mut session, "set_prices", json!({"A": price, "B": price, "C": price}));
        }
        advance_week(&mut session);
    }
    session
}

fn debrief(session: &Session) -> Debrief {
    FinishedPart::from_session(session).expect("it is over").debrief(calls_for_waiting_threads)
}

fn reference(play: &ReferencePlay) -> Vec<f64> {
    let lesson = lesson();
    let part_play = PartPlay {
        lesson: &lesson,
        part: 0,
        seed: Some(3),
        scheduled_calls: &play.plays,
        weeks: None,
        is_judged: true,
        needs_database: lesson.needs_database(),
    };
    let session = play_part(&part_play, calls_for_waiting_threads).expect("a play");
    session.cash_by_day().to_vec()
}

#[test]
fn debrief_curves_match_the_record_and_reference_plays() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = play_lesson(folder.path(), 30, 0);
    let found = debrief(&session);
    assert_eq!(found.cash_by_day, session.cash_by_day());
    let plan = &lesson().plan;
    assert_eq!(found.reference.as_ref().expect("a reference play").cash_by_day, reference(&plan.good));
    assert_eq!(found.bad_play.as_ref().expect("a bad play").cash_by_day, reference(&plan.bad));
    assert_eq!(found.steps.len(), 2);
    assert_eq!(found.pitfalls, [(7, "Somebody bought.".to_owned())]);
    // The debrief is the same after the run is read from disk.
    let run = session.folder().expect("a folder").to_owned();
    drop(session);
    assert_eq!(debrief(&Session::open(&run, Access::Read, true).expect("it opens")), found);
}

#[test]
fn first_difference_is_valued_by_resimulation() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = debrief(&play_lesson(folder.path(), 30, 0));
    let DecisionComparison::Different(first_difference) = &found.comparison else {
        panic!("{:?}", found.comparison)
    };
    assert_eq!((first_difference.week, first_difference.day, first_difference.decisions.len()), (1, 0, 1));
    // This single decision makes the run equal to the reference play.
    let effect = first_difference.effect.as_simulated().expect("an effect");
    let good = found.reference.as_ref().expect("a reference play").cash_by_day.clone();
    assert_eq!(Some(&effect.with), good.last());
    assert_eq!(Some(&effect.own), found.cash_by_day.last());
    // The higher price of the second week is kept, so the decision of the first week alone does not reproduce the
    // reference play.
    let later = debrief(&play_lesson(folder.path(), 40, 1));
    let DecisionComparison::Different(first_difference) = &later.comparison else {
        panic!("{:?}", later.comparison)
    };
    assert_eq!(first_difference.week, 1);
    assert_ne!(first_difference.effect.as_simulated().map(|effect| effect.with), good.last().copied());
}

#[test]
fn debrief_recognizes_the_reference_play() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = debrief(&play_lesson(folder.path(), 12, 0));
    assert_eq!(found.comparison, DecisionComparison::Same);
    assert_eq!(Some(&found.cash_by_day), found.reference.as_ref().map(|good| &good.cash_by_day));
}

#[test]
fn debrief_uses_the_figure_of_the_goal() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = finish_lesson(
        start_lesson_from_plan(lesson_judged_by_revenue(folder.path()), &folder.path().join("runs")),
        30,
        0,
    );
    let found = debrief(&session);
    let judged = found.judged_by.as_ref().expect("a figure");
    let actual: Vec<(u32, f64)> =
        session.weeks().iter().map(|week| (week.day, week.recurring_revenue)).collect();
    assert_eq!((judged.figure, &judged.actual), (WeekFigure::RecurringRevenue, &actual));
    let good = judged.reference.as_ref().expect("the reference play");
    assert!(good.len() == 2 && good != &actual, "{good:?}");
    let DecisionComparison::Different(first_difference) = &found.comparison else {
        panic!("{:?}", found.comparison)
    };
    let (before, with) =
        first_difference.effect.as_simulated().and_then(|effect| effect.judged).expect("an effect");
    assert_eq!(
        (Some(before), Some(with)),
        (actual.last().map(|week| week.1), good.last().map(|good| good.1))
    );
    let markdown = debrief_to_markdown(&found);
    for text in
        ["Recurring revenue on day 14: yours $", "the reference play's $", "Recurring revenue by week"]
    {
        assert!(markdown.contains(text), "{text}:\n{markdown}");
    }
    let cash_debrief = debrief(&play_lesson(&folder.path().join("other"), 30, 0));
    assert_eq!(cash_debrief.judged_by, None);
}

#[test]
fn retry_starts_at_the_same_day() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = play_lesson(folder.path(), 30, 0);
    let mut session = retry_step(&first, 0).expect("another try");
    let begun = start_student_lesson(&folder.path().join("other"));
    assert_eq!(session.settings(), begun.settings());
    assert_eq!(
        session.lesson().map(|lesson_progress| (lesson_progress.attempt(0), lesson_progress.guess(0))),
        Some((2, Some(1.0)))
    );
    assert_eq!(submit_guess(&mut session, 2.0).err().map(|refusal| refusal.code), Some("no_question"));
    for _ in 0..2 {
        if session.day() == 0 {
            call_tool(&mut session, "set_prices", json!({"A": 30, "B": 30, "C": 30}));
        } else {
            submit_guess(&mut session, 1.0).expect("the step after it asks");
        }
        advance_week(&mut session);
    }
    assert_eq!(session.cash_by_day(), first.cash_by_day());
    let (one, other) = (debrief(&first), debrief(&session));
    assert_eq!(one.comparison, other.comparison);
    assert_eq!(other.steps[0].tries, 2);
}

#[test]
fn reference_play_is_hidden_until_the_part_is_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = start_student_lesson(folder.path());
    submit_guess(&mut session, 0.5).expect("a guess");
    advance_week(&mut session);
    assert_eq!(FinishedPart::from_session(&session).expect_err("it continues").code, "lesson_not_over");
    let mut other = Session::create(NewRun::default(), &Configuration::bundled()).expect("a run");
    assert_eq!(FinishedPart::from_session(&other).expect_err("no lesson").code, "not_in_a_lesson");
    assert_eq!(take_hint(&mut other).expect_err("no lesson").code, "not_in_a_lesson");
}

#[test]
fn debrief_pages_are_complete_and_self_contained() {
    let folder = tempfile::tempdir().expect("a folder");
    let found = debrief(&play_lesson(folder.path(), 30, 0));
    let (markdown, html) = (debrief_to_markdown(&found), debrief_to_html(&found));
    for text in [
        "reference play",
        "set_prices",
        "Open the shop",
        "A billion in the bank",
        "Somebody bought",
        "Conversion",
    ] {
        assert!(markdown.contains(text), "{text}:\n{markdown}");
        assert!(html.contains(text), "{text}");
    }
    assert!(!html.contains("<script") && !html.contains("http"));
}
