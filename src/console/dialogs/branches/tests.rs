//! Tests of the what-if page: editing, simulating, viewing and adopting a branch.

use serde_json::json;

use super::*;
use crate::keys::KeyBindings;
use crate::test_kit::{dialog_action, dialog_text, new_company, only_question};
use novamind_insight::{DecisionEdit, RecordedCall, RecordedDecision};
use novamind_tools::ToolId;

const SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (120, 40), (200, 60)];

fn past_call(seq: u64, day: u32, accepted: bool) -> RecordedDecision {
    RecordedDecision::Call(RecordedCall {
        seq,
        day,
        tool: ToolId::SetPrices,
        args: json!({"B": 30}),
        accepted,
        reversal: None,
    })
}

fn page() -> BranchesPage {
    let (mut page, _) = BranchesPage::new(5, 8);
    page.set_result(Ok(BranchesAnswer::Decisions(
        vec![past_call(4, 0, true), past_call(9, 28, true), past_call(12, 35, false)],
        7,
    )));
    page
}

fn type_text(page: &mut BranchesPage, text: &str) {
    let company = new_company();
    let keys = KeyBindings::bundled();
    dialog_action(page, Action::AddDecision, &company);
    page.paste(text, &ScreenContext { company: &company, keys: &keys, page_rows: 5 });
    dialog_action(page, Action::Commit, &company);
}

#[test]
fn later_decisions_are_listed_and_can_be_omitted_or_changed() {
    let company = new_company();
    let mut page = page();
    for (width, height) in SIZES {
        let picture = dialog_text(&page, &company, width, height);
        for words in ["from week 5", "week  5  set_prices", "week  6", "rejected"] {
            assert!(picture.contains(words), "{words} in {picture}");
        }
        assert!(!picture.contains("week  1"), "{picture}");
    }
    dialog_action(&mut page, Action::OmitDecision, &company);
    assert!(dialog_text(&page, &company, 80, 24).contains("omitted"));
    assert_eq!(page.decisions.alternatives(), [vec![DecisionEdit::Drop(9)]]);
    dialog_action(&mut page, Action::OmitDecision, &company);
    assert!(page.decisions.alternatives().is_empty());
    page.decisions.select(1);
    assert!(page.decisions.handle_action(Action::OmitDecision).is_err(), "line 12 was rejected");
    assert!(page.decisions.alternatives().is_empty());
    page.decisions.select(0);
    dialog_action(&mut page, Action::Open, &company);
    assert_eq!(page.scopes(), [Scope::Field]);
    dialog_action(&mut page, Action::Commit, &company);
    let changed = DecisionEdit::Change { seq: 9, args: json!({"B": 30}) };
    assert_eq!(page.decisions.alternatives(), [vec![changed]]);
    // Edits of calls before the start week are dropped.
    dialog_action(&mut page, Action::Right, &company);
    assert!(page.decisions.alternatives().is_empty());
}

#[test]
fn typed_decisions_and_alternatives_are_kept() {
    let company = new_company();
    let mut page = page();
    assert!(dialog_action(&mut page, Action::SimulateBranches, &company).effects.is_empty());
    assert!(dialog_text(&page, &company, 80, 24).contains("change a decision first"));
    type_text(&mut page, "set_price * 2");
    assert!(page.problem.as_ref().is_some_and(|text| text.contains("did you mean set_prices")));
    dialog_action(&mut page, Action::Discard, &company);
    type_text(&mut page, "set_prices * 0.9");
    dialog_action(&mut page, Action::NextAlternative, &company);
    type_text(&mut page, "keep set_prices");
    let effects = dialog_action(&mut page, Action::SimulateBranches, &company).effects;
    let BranchesQuestion::Compare { week: 5, alternatives, futures: None } = only_question(&effects) else {
        panic!("{effects:?}")
    };
    let texts: Vec<String> =
        alternatives.iter().map(|decision_edits| decision_edits[0].to_string()).collect();
    assert_eq!(texts, ["set_prices * 0.9", "keep set_prices"]);
    // The first esc stops the simulation, and the second esc closes the page.
    assert!(!dialog_action(&mut page, Action::Cancel, &company).closes && !page.asked.is_waiting());
    assert!(dialog_action(&mut page, Action::Close, &company).closes);
}

#[test]
fn rejection_returns_to_the_decisions() {
    let company = new_company();
    let mut page = page();
    page.set_result(Err(Rejection::new("not_in_this_mode", "not in an unfinished baseline run")));
    assert!(dialog_text(&page, &company, 60, 16).contains("not in an unfinished baseline run"));
}
