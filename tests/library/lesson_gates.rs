//! Conditions of lessons: goals relative to a reference play with rules, hidden state of a part before the next one, starts that
//! were interrupted by a kill, and figures that are measured in another world.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use novamind::course::{Lesson, begin_part, try_step_again};
use novamind::insight::{Inspect, WeekQuestion, look_at_figure, open_to_look_inside};
use novamind::rules::answers_to_companies;
use novamind::session::{Access, PartPlay, Playback, SealKey, Session, may_look_inside, play_part};
use novamind::world::identifiers::Group;

use crate::support::lessons::{begin, code, lesson_of, week};

fn folder_of(session: &Session) -> PathBuf {
    session.folder().expect("a folder").to_owned()
}

/// Two parts with one seed, each of two weeks after an initial week.
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
fn hidden_state_of_a_part_is_shown_once_the_last_part_is_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut first = begin(folder.path(), "gates", PARTS);
    week(&mut first).expect("a week");
    week(&mut first).expect("a week");
    assert!(first.ended().is_some());
    let own = folder_of(&first);
    let hidden = |session: &mut Session| {
        assert!(!session.may_look_inside());
        let refused = session.refuse_to_look_inside().expect_err("it is refused");
        assert!(refused.message.contains("after its last part"), "{refused}");
        // The causes are those of an unfinished run: without hidden figures and inspections.
        let asked: WeekQuestion = "satisfaction 3".parse().expect("a question");
        assert_eq!(code(look_at_figure(session, &asked)), "not_in_this_mode");
        assert!(!may_look_inside(session.manifest(), session.ended(), session.folder()));
    };
    hidden(&mut first);
    let mut second = begin_part(&first, 1).expect("the second part");
    hidden(&mut first);
    drop(first);
    let playback = Playback::open(&own).expect("a replay");
    assert!(!playback.may_look_inside());
    assert!(open_to_look_inside(&own, SealKey::default()).is_err());
    week(&mut second).expect("a week");
    assert!(second.ended().is_some() && second.may_look_inside());
    drop(second);
    let mut first = Session::open(&own, Access::Write, true).expect("it opens");
    assert!(first.may_look_inside() && Playback::open(&own).expect("a replay").may_look_inside());
    first.inspect().quality_equation(Group::parse("S1").expect("a group"), None).expect("a look");
}

#[test]
fn a_beginning_that_was_cut_anywhere_goes_on_when_the_run_is_opened() {
    let folder = tempfile::tempdir().expect("a folder");
    let session = begin(folder.path(), "gates", PARTS);
    let (own, hash) = (folder_of(&session), session.state_hash());
    let standing = session.lesson().expect("a lesson").clone();
    let parameters = session.params().ads.log_curve_k;
    drop(session);
    let path = own.join("trajectory.jsonl");
    let whole = std::fs::read_to_string(&path).expect("lines");
    let lines: Vec<&str> = whole.lines().collect();
    assert!(lines.len() >= 9, "start, calls, a week, parameters, the step");
    for kept in 1..=lines.len() {
        cut(&own, &lines[..kept]);
        let mut again =
            Session::open(&own, Access::Write, true).unwrap_or_else(|error| panic!("{kept}: {error}"));
        assert_eq!(again.lesson(), Some(&standing), "{kept} lines were left");
        assert_eq!(again.params().ads.log_curve_k, parameters, "{kept}");
        assert_eq!(again.state_hash(), hash, "{kept} lines were left");
        week(&mut again).unwrap_or_else(|refusal| panic!("{kept}: {refusal}"));
    }
}

#[test]
fn a_try_that_was_cut_before_its_step_began_is_counted_when_it_is_opened() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin(folder.path(), "gates", PARTS);
    week(&mut session).expect("a week");
    let again = try_step_again(&session, 0).expect("another try");
    let own = folder_of(&again);
    let standing = again.lesson().expect("a lesson").clone();
    assert_eq!(standing.tries(0), 2);
    drop((again, session));
    let whole = std::fs::read_to_string(own.join("trajectory.jsonl")).expect("lines");
    let lines: Vec<&str> = whole.lines().collect();
    let branch = lines.iter().position(|line| line.contains("\"kind\":\"branch\"")).expect("a branch");
    for kept in branch + 1..=lines.len() {
        cut(&own, &lines[..kept]);
        let again = Session::open(&own, Access::Write, true).expect("it opens");
        assert_eq!(again.lesson().map(|own| own.tries(0)), Some(2), "{kept} lines were left");
    }
}

/// Truncates a run to a number of lines, as a kill does, and removes the files that store later positions.
fn cut(folder: &Path, lines: &[&str]) {
    std::fs::write(folder.join("trajectory.jsonl"), lines.join("\n") + "\n").expect("written");
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if name.starts_with("world.db") || name.starts_with("snapshot") {
            std::fs::remove_file(entry.path()).expect("removed");
        }
    }
}

/// A lesson with waiting enterprises, whose reference play replies by rules.
const RULED: &str = include_str!("../data/lessons/answers-by-rules.toml");

#[test]
fn a_goal_is_held_against_a_good_play_that_answers_by_rules() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin(folder.path(), "gates", RULED);
    let own = folder_of(&session);
    for _ in 0..3 {
        week(&mut session).expect("a week");
    }
    // Without an implementation of the rules, the step stays unjudged instead of being judged wrongly.
    week(&mut session).expect("a week");
    assert!(session.lesson().expect("a lesson").goals(0).is_empty());
    assert_eq!(code(week(&mut session)), "step_not_begun");
    drop(session);
    let mut session = Session::open(&own, Access::Write, true).expect("it opens");
    session.answer_companies_by(answers_to_companies);
    let standing = session.lesson().expect("a lesson").clone();
    let goal = standing.goals(0)[0].clone();
    assert!(goal.bound.is_some_and(|bound| bound > 0.0), "{goal:?}");
    assert!(goal.value.zip(goal.bound).is_some_and(|(value, bound)| value < bound), "{goal:?}");
    assert_eq!(goal.met, Some(false));
    assert!(standing.has_begun(1));
    week(&mut session).expect("a week");
    // With the decisions of the reference play, the goal is reached.
    let lesson = Arc::new(lesson_of(folder.path(), "gates", RULED).expect("a lesson"));
    let plays = lesson.plan.good.plays.clone();
    let play = PartPlay {
        lesson: &lesson,
        part: 0,
        seed: None,
        plays: &plays,
        weeks: None,
        is_judged: true,
        asks_database: false,
    };
    let good = play_part(&play, answers_to_companies).expect("the good play");
    let reached = good.lesson().expect("a lesson").goals(0)[0].clone();
    assert_eq!(reached.met, Some(true));
    assert_eq!(reached.bound, goal.bound);
    assert_eq!(reached.bound, reached.value.map(|value| value * 0.9));
}

#[test]
fn a_figure_is_measured_in_a_world_of_its_own() {
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
        Arc::new(lesson_of(folder.path(), "gates", &(PARTS.to_owned() + measured)).expect("a lesson"));
    let [elsewhere, here] = [0, 1].map(|at| lesson.in_world_of(&lesson.plan.measured[at]));
    assert!(Arc::ptr_eq(&here, &lesson));
    let play = |lesson: &Arc<Lesson>| {
        let play = PartPlay {
            lesson,
            part: 0,
            seed: Some(1),
            plays: &[],
            weeks: Some(1),
            is_judged: false,
            asks_database: false,
        };
        play_part(&play, answers_to_companies).expect("a play")
    };
    let [played, own] = [play(&elsewhere), play(&here)];
    assert_eq!(
        (played.manifest().scenario.as_str(), own.manifest().scenario.as_str()),
        ("competitor-off", "default")
    );
    assert!(
        played.params().competitor.competitor_events_disabled
            && !own.params().competitor.competitor_events_disabled
    );
    let wrong = measured.replace("competitor-off", "no-such-world");
    let said = lesson_of(folder.path(), "gates", &(PARTS.to_owned() + &wrong)).expect_err("it is refused");
    assert!(said.contains("no-such-world") && said.contains("line "), "{said}");
    let wrong = measured.replace("quality.base_product_quality", "quality.luck");
    let said = lesson_of(folder.path(), "gates", &(PARTS.to_owned() + &wrong)).expect_err("it is refused");
    assert!(said.contains("quality.luck"), "{said}");
}
