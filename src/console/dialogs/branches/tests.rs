//! Tests of the what-if page: changing decisions, refusals, simulating, viewing and adopting a branch.

use crossterm::event::KeyCode;
use serde_json::{Value, json};

use super::*;
use crate::keys::KeyBindings;
use crate::test_kit::{dialog_action, dialog_text, new_company, new_session, only_question};
use novamind_insight::{DecisionEdit, DecisionHistory, RecordedCall, RecordedDecision};
use novamind_record::mode::Mode;
use novamind_tools::ToolId;

const SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (120, 40), (200, 60)];

fn call(seq: u64, day: u32, tool: ToolId, args: Value, accepted: bool) -> RecordedDecision {
    RecordedDecision::Call(RecordedCall { seq, day, tool, args, accepted, reversal: None })
}

/// Returns the page at a week of a run with decisions in weeks 1 and 5.
fn page_at(week: u32) -> BranchesPage {
    let decisions = vec![
        call(4, 0, ToolId::SetPrices, json!({"B": 25}), true),
        call(9, 28, ToolId::SetPrices, json!({"B": 30}), true),
        call(10, 28, ToolId::SetCapacityTier, json!({"tier": 2}), true),
        call(12, 28, ToolId::StartResearchProject, json!({"tier": 1}), false),
    ];
    let history = DecisionHistory::new(decisions, new_session().settings(), 7);
    let (mut page, _) = BranchesPage::new(week, 8);
    page.set_result(Ok(BranchesAnswer::Decisions(history.into())));
    page
}

fn page() -> BranchesPage {
    page_at(5)
}

fn act(page: &mut BranchesPage, actions: &[Action]) -> DialogResponse {
    let company = new_company();
    let mut last = DialogResponse::stay();
    for action in actions {
        last = dialog_action(page, *action, &company);
    }
    last
}

fn type_text(page: &mut BranchesPage, text: &str) {
    let (company, keys) = (new_company(), KeyBindings::bundled());
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    for letter in text.chars() {
        page.handle_key(&KeyEvent::from(KeyCode::Char(letter)), &context);
    }
}

fn text(page: &BranchesPage) -> String {
    dialog_text(page, &new_company(), 80, 24)
}

fn edits(page: &BranchesPage) -> Vec<DecisionEdit> {
    page.decisions.alternatives().concat()
}

#[test]
fn decisions_are_listed_in_words_at_every_size() {
    for (width, height) in SIZES {
        let picture = dialog_text(&page(), &new_company(), width, height);
        for words in ["decisions of week 5", "price B 25 → 30", "capacity", "rejected in", "add a decision"]
        {
            assert!(picture.contains(words), "{words} in {picture}");
        }
        assert!(!picture.contains('{') && !picture.contains("line "), "{picture}");
    }
}

#[test]
fn enter_cycles_keep_leave_out_scale_and_replace() {
    let mut page = page();
    act(&mut page, &[Action::CycleDecision]);
    assert_eq!(edits(&page), [DecisionEdit::Drop(9)]);
    assert!(text(&page).contains("leave out  price B 25 → 30"), "{}", text(&page));
    // The field suggests a factor. An accepted factor scales only this decision.
    act(&mut page, &[Action::CycleDecision]);
    assert_eq!(page.scopes(), [Scope::Field]);
    type_text(&mut page, "0.5");
    act(&mut page, &[Action::Commit]);
    assert_eq!(edits(&page), [DecisionEdit::Change { seq: 9, args: json!({"B": 15}) }]);
    assert!(text(&page).contains("price B 25 → 15 instead of B 25 → 30"), "{}", text(&page));
    // The form of the tool shows the recorded values.
    act(&mut page, &[Action::CycleDecision]);
    assert!(page.scopes().contains(&Scope::Form) && text(&page).contains("What if, price"));
    act(&mut page, &[Action::Down, Action::EditCell]);
    type_text(&mut page, "28");
    act(&mut page, &[Action::Apply]);
    assert_eq!(edits(&page), [DecisionEdit::Change { seq: 9, args: json!({"B": 28}) }]);
    act(&mut page, &[Action::CycleDecision]);
    assert!(edits(&page).is_empty());
}

#[test]
fn escape_leaves_an_input_without_an_effect() {
    let mut page = page();
    act(&mut page, &[Action::ScaleDecision, Action::Discard]);
    assert!(edits(&page).is_empty());
    act(&mut page, &[Action::ScaleDecision, Action::Commit, Action::ReplaceDecision, Action::Close]);
    assert_eq!(edits(&page), [DecisionEdit::Change { seq: 9, args: json!({"B": 27}) }]);
    // In the cycle, escape keeps the decision as recorded.
    act(&mut page, &[Action::CycleDecision, Action::Close]);
    assert!(edits(&page).is_empty());
    // Changes are discarded only after a warning.
    act(&mut page, &[Action::OmitDecision]);
    assert!(!act(&mut page, &[Action::Close]).closes && text(&page).contains("discards your changes"));
    assert!(!act(&mut page, &[Action::Down, Action::Close]).closes);
    assert!(act(&mut page, &[Action::Close]).closes);
}

#[test]
fn refusals_state_the_reason_next_to_their_row() {
    let mut page = page();
    act(&mut page, &[Action::Down, Action::ScaleDecision]);
    assert!(
        text(&page).contains("! capacity is not an amount. Only amounts can be scaled: price"),
        "{}",
        text(&page)
    );
    act(&mut page, &[Action::Down, Action::OmitDecision]);
    assert!(text(&page).contains("! This decision was rejected in your run"), "{}", text(&page));
    act(&mut page, &[Action::First, Action::ScaleDecision]);
    type_text(&mut page, "2000");
    act(&mut page, &[Action::Commit]);
    assert!(text(&page).contains("! Enter a factor from 0 to 1000"), "{}", text(&page));
    type_text(&mut page, "x");
    assert_eq!(page.scopes(), [Scope::Field]);
    act(&mut page, &[Action::Discard]);
    assert!(edits(&page).is_empty());
}

#[test]
fn rejected_check_blocks_the_simulation_until_the_change_is_removed() {
    let mut page = page();
    let effects = act(&mut page, &[Action::OmitDecision]).effects;
    let BranchesQuestion::Check { week: 5, edits: asked } = only_question(&effects) else {
        panic!("{effects:?}")
    };
    assert_eq!(asked, &edits(&page));
    let refusal = Rejection::new("line_unknown", "the reason of the refusal");
    page.decisions.set_checked(&asked.clone(), vec![Some(refusal)]);
    page.decisions.select(2);
    assert!(act(&mut page, &[Action::SimulateBranches]).effects.is_empty());
    for (width, height) in SIZES {
        let picture = dialog_text(&page, &new_company(), width, height);
        assert!(picture.contains("! the reason of the refusal"), "{picture}");
        assert!(picture.contains("A change cannot be simulated"), "{picture}");
    }
    act(&mut page, &[Action::OmitDecision, Action::ScaleDecision, Action::Commit]);
    let effects = act(&mut page, &[Action::SimulateBranches]).effects;
    assert!(matches!(only_question(&effects), BranchesQuestion::Compare { week: 5, .. }));
}

#[test]
fn week_without_decisions_offers_weeks_with_decisions_and_a_new_decision() {
    let mut page = page_at(7);
    let picture = text(&page);
    assert!(picture.contains("You made no decisions in week 7."), "{picture}");
    assert!(picture.contains("week 5     3 decisions: price, capacity, R&D projects"), "{picture}");
    assert!(picture.contains("week 1     1 decision: price"), "{picture}");
    act(&mut page, &[Action::CycleDecision]);
    assert_eq!(page.decisions.week(), 5);
    act(&mut page, &[Action::Right, Action::Right, Action::AddDecision, Action::CycleDecision]);
    act(&mut page, &[Action::EditCell]);
    type_text(&mut page, "11");
    act(&mut page, &[Action::Apply]);
    let added = DecisionEdit::Add { week: Some(7), tool: ToolId::SetPrices, args: json!({"A": 11}) };
    assert_eq!(edits(&page), [added]);
    assert!(text(&page).contains("add        price A 0 → 11"), "{}", text(&page));
    act(&mut page, &[Action::OmitDecision]);
    assert!(edits(&page).is_empty());
}

#[test]
fn changes_of_other_weeks_stay_listed_and_the_simulation_starts_at_the_first() {
    let mut page = page();
    act(&mut page, &[Action::OmitDecision, Action::Left, Action::Left, Action::Left, Action::Left]);
    act(&mut page, &[Action::ScaleDecision, Action::Commit]);
    let picture = text(&page);
    assert!(picture.contains("week 5     leave out price B 25 → 30"), "{picture}");
    assert!(picture.contains("2 changes · the simulation starts with week 1"), "{picture}");
    let effects = act(&mut page, &[Action::SimulateBranches]).effects;
    let BranchesQuestion::Compare { week: 1, alternatives, futures: None } = only_question(&effects) else {
        panic!("{effects:?}")
    };
    let scaled = DecisionEdit::Change { seq: 4, args: json!({"B": 22.5}) };
    assert_eq!(alternatives, &[vec![DecisionEdit::Drop(9), scaled]]);
    // The first escape stops the simulation. The change of the other week can be removed in its row.
    assert!(!act(&mut page, &[Action::Cancel]).closes && !page.asked.is_waiting());
    act(&mut page, &[Action::Down, Action::OmitDecision]);
    assert_eq!(edits(&page).len(), 1);
}

#[test]
fn tools_can_be_scaled_or_left_out_from_a_week_on() {
    let mut page = page();
    act(&mut page, &[Action::AddDecision, Action::ScaleDecision, Action::Commit]);
    act(&mut page, &[Action::AddDecision, Action::OmitDecision]);
    assert!(text(&page).contains("price × 0.9 from week 5 on"), "{}", text(&page));
    assert!(text(&page).contains("leave out all price decisions from week 5 on"), "{}", text(&page));
    assert_eq!(
        edits(&page),
        [DecisionEdit::Scale { tool: ToolId::SetPrices, factor: 0.9 }, DecisionEdit::Keep(ToolId::SetPrices)]
    );
    act(&mut page, &[Action::NextAlternative]);
    assert!(text(&page).contains("alternative 2 of 2") && text(&page).contains("Nothing is changed yet."));
    act(&mut page, &[Action::OmitDecision]);
    assert_eq!(page.decisions.alternatives().len(), 2);
    let names = page.decisions.alternative_names(&new_company().enterprise_names);
    assert_eq!(names[1], "week 5: leave out price B 25 → 30");
}

#[test]
fn every_addable_decision_opens_or_states_a_reason_without_json() {
    let mut company = new_company();
    company.observation.mode = Mode::Debug;
    let count = picker::new_decisions(&company).len();
    for at in 0..count {
        let mut page = page();
        dialog_action(&mut page, Action::AddDecision, &company);
        (0..at).for_each(|_| drop(dialog_action(&mut page, Action::Down, &company)));
        dialog_action(&mut page, Action::CycleDecision, &company);
        let new = picker::new_decisions(&company)[at];
        assert_eq!(page.decisions.notice.is_some(), new.refusal(&company).is_some(), "{new:?}");
        for (width, height) in SIZES {
            let picture = dialog_text(&page, &company, width, height);
            assert!(!picture.contains("JSON") && !picture.contains('{'), "{new:?}\n{picture}");
        }
    }
    let mut page = page();
    dialog_action(&mut page, Action::AddDecision, &company);
    dialog_action(&mut page, Action::Last, &company);
    dialog_action(&mut page, Action::CycleDecision, &company);
    type_text(&mut page, "nothing");
    dialog_action(&mut page, Action::Commit, &company);
    assert!(
        page.decisions
            .notice
            .as_ref()
            .is_some_and(|reason| reason.starts_with("Enter the name of a parameter"))
    );
    type_text(&mut page, " 5");
    dialog_action(&mut page, Action::Commit, &company);
    assert_eq!(
        edits(&page),
        [DecisionEdit::Set { week: Some(5), key: "nothing".to_owned(), value: json!(5) }]
    );
}

#[test]
fn simulation_needs_a_change() {
    let mut page = page();
    assert!(act(&mut page, &[Action::SimulateBranches]).effects.is_empty());
    assert!(text(&page).contains("No decision is changed yet"));
}

#[test]
fn rejection_returns_to_the_decisions() {
    let company = new_company();
    let (mut page, _) = BranchesPage::new(5, 8);
    page.set_result(Err(Rejection::new("not_in_this_mode", "not in an unfinished baseline run")));
    act(&mut page, &[Action::AddDecision, Action::CycleDecision]);
    page.set_result(Err(Rejection::new("not_in_this_mode", "not in an unfinished baseline run")));
    let picture = dialog_text(&page, &company, 60, 16);
    assert!(
        picture.contains("not in an unfinished baseline run") && !picture.contains("add a decision"),
        "{picture}"
    );
}
