//! A what-if in a lesson changes the capacity automatically and stops at the end of the lesson step.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use super::*;
use crate::create_branch_with_decisions;
use novamind_record::folder::configuration::Configuration;
use novamind_record::lesson::Lesson;
use novamind_record::trajectory::record::Via;
use novamind_session::engine::UsageCapacityRule;
use novamind_session::{LessonOptions, NewRun, Storage};

/// A lesson with automatic capacity, in which the company outgrows its servers.
const LESSON_TOML: &str = r#"
title = "More and more"
minutes = 5
learning_goal = "You find out who rents the servers."

[[part]]
title = "Only"
seed = 7
capacity = "follows usage"

[[part.start]]
week = 0
calls = [
  'set_prices {"A": 12, "B": 25, "C": 55}',
  'set_model_tiers {"A": 1, "B": 2, "C": 4}',
  'set_usage_quotas {"A": 60000, "B": 250000, "C": 1200000}',
  'set_targeted_ad_spend {"targeted_spend": {"content_marketing": {"S1": 500}}}',
]

[[part.step]]
title = "Wait"
text = "Wait."
weeks = 10
hints = ["Wait."]

[[part.step]]
title = "Again"
text = "Wait once more."
weeks = 4
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

const MORE_ADVERTISING: &str =
    r#"in 1 set_targeted_ad_spend {"targeted_spend": {"content_marketing": {"S1": 6000}}}"#;

fn start_lesson(folder: &Path, runs: &str) -> Session {
    let path = folder.join("more.toml");
    std::fs::write(&path, LESSON_TOML).expect("a file");
    std::fs::write(folder.join("more.md"), "## Debrief\n\nSo it goes.\n").expect("a file");
    let lesson = Arc::new(Lesson::from_file(&path).expect("a lesson"));
    let new = NewRun {
        mode: Mode::Lesson,
        lesson: Some(LessonOptions { lesson, part: 0, is_judged: true }),
        storage: Storage::Runs(folder.join(runs)),
        ..NewRun::default()
    };
    Session::create(new, &Configuration::bundled()).expect("the lesson begins")
}

fn advance_weeks(session: &mut Session, count: u32) {
    for _ in 0..count {
        let forecasts = session.company().naive_forecasts();
        session.advance("on", &forecasts, Via::Plain, &mut |_| {}).expect("a week");
    }
}

fn compare(session: &Session, until: u32, alternatives: &[&str]) -> Result<BranchComparison, Rejection> {
    let alternatives: Vec<Vec<DecisionEdit>> =
        alternatives.iter().map(|edit| vec![edit.parse().expect(edit)]).collect();
    let mut what_if = WhatIf::open(session.folder().expect("a folder")).expect("a what-if");
    let go_on = |_: usize, _: usize| ControlFlow::Continue(());
    Ok(what_if.compare(1, Some(until), &alternatives, &go_on)?.expect("it is not stopped"))
}

fn weekly_cash(session: &Session) -> Vec<f64> {
    session.weeks().iter().map(|week| week.cash).collect()
}

fn cash_of_branch(branch: &BranchFigures) -> Vec<f64> {
    branch.values_by_week(BranchFigure::Cash).map(|(_, cash)| cash).collect()
}

#[test]
fn lesson_capacity_rule_applies_in_every_branch() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = start_lesson(folder.path(), "waited");
    advance_weeks(&mut session, 4);
    let ahead = compare(&session, 10, &[MORE_ADVERTISING]).expect("an answer");
    advance_weeks(&mut session, 6);
    let mut other = start_lesson(folder.path(), "decided");
    let more = serde_json::json!({"targeted_spend": {"content_marketing": {"S1": 6000}}});
    other.call("set_targeted_ad_spend", &more, Via::Plain).expect("the call is accepted");
    let mut is_distinguished = false;
    for _ in 0..10 {
        advance_weeks(&mut other, 1);
        is_distinguished |= other.company().capacity_tier_by_rule(UsageCapacityRule::BusiestDay)
            != other.company().capacity_tier_by_rule(UsageCapacityRule::StepByStep);
    }
    assert!(is_distinguished, "the capacity rule must affect the result");
    let tier = |session: &Session| session.settings().core.capacity_tier;
    assert!(tier(&other) > tier(&session), "more usage leads to a higher capacity tier");
    let [was, decided] = &ahead.branches[..] else { panic!("{:?}", ahead.branches) };
    assert_eq!(
        cash_of_branch(was),
        weekly_cash(&session),
        "the unchanged branch equals the weeks that were played later"
    );
    assert_eq!(
        cash_of_branch(decided),
        weekly_cash(&other),
        "the edited branch equals the run with this decision"
    );
    let adopted = create_branch_with_decisions(
        &session,
        1,
        &[MORE_ADVERTISING.parse().expect(MORE_ADVERTISING)],
        Mode::Sandbox,
        &mut |_| ControlFlow::Continue(()),
    )
    .expect("a branch");
    assert_eq!(weekly_cash(&adopted.session), weekly_cash(&other));
}

#[test]
fn what_if_stops_at_the_end_of_the_lesson_step() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = start_lesson(folder.path(), "runs");
    advance_weeks(&mut session, 2);
    let refused = compare(&session, 11, &[MORE_ADVERTISING]).expect_err("the week is in another step");
    assert_eq!(refused.code, "week_unknown");
    assert!(refused.message.contains("the step of the lesson, 10"), "{refused}");
    advance_weeks(&mut session, 8);
    compare(&session, 14, &[MORE_ADVERTISING]).expect("the week is in this step");
}
