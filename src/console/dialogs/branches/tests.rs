//! Tests of the what-if page: editing, simulating, viewing and adopting a branch.

use serde_json::json;

use super::*;
use crate::keys::Keys;
use crate::test_kit::{asked, company, dialog_picture, in_dialog};
use novamind_insight::{DecisionEdit, PastCall, PastDecision};
use novamind_tools::ToolId;

const SIZES: [(u16, u16); 4] = [(60, 16), (80, 24), (120, 40), (200, 60)];

fn call(seq: u64, day: u32, accepted: bool) -> PastDecision {
    PastDecision::Call(PastCall {
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
    page.take(Ok(BranchesFound::Decisions(
        vec![call(4, 0, true), call(9, 28, true), call(12, 35, false)],
        7,
    )));
    page
}

fn type_in(page: &mut BranchesPage, text: &str) {
    let company = company();
    let keys = Keys::shipped();
    in_dialog(page, Action::AddDecision, &company);
    page.paste(text, &Look { company: &company, keys: &keys, page: 5 });
    in_dialog(page, Action::Commit, &company);
}

#[test]
fn decisions_of_the_week_and_later_are_listed_and_can_be_left_out_or_changed() {
    let company = company();
    let mut page = page();
    for (width, height) in SIZES {
        let picture = dialog_picture(&page, &company, width, height);
        for words in ["from week 5", "week  5  set_prices", "week  6", "rejected"] {
            assert!(picture.contains(words), "{words} in {picture}");
        }
        assert!(!picture.contains("week  1"), "{picture}");
    }
    in_dialog(&mut page, Action::DropDecision, &company);
    assert!(dialog_picture(&page, &company, 80, 24).contains("omitted"));
    assert_eq!(page.decisions.alternatives(), [vec![DecisionEdit::Drop(9)]]);
    in_dialog(&mut page, Action::DropDecision, &company);
    assert!(page.decisions.alternatives().is_empty());
    in_dialog(&mut page, Action::Open, &company);
    assert_eq!(page.scopes(), [Scope::Field]);
    in_dialog(&mut page, Action::Commit, &company);
    let changed = DecisionEdit::Change { seq: 9, args: json!({"B": 30}) };
    assert_eq!(page.decisions.alternatives(), [vec![changed]]);
    // Edits of calls before the start week are dropped.
    in_dialog(&mut page, Action::Right, &company);
    assert!(page.decisions.alternatives().is_empty());
}

#[test]
fn other_decisions_are_typed_and_alternatives_stand_side_by_side() {
    let company = company();
    let mut page = page();
    assert!(in_dialog(&mut page, Action::SimulateBranches, &company).effects.is_empty());
    assert!(dialog_picture(&page, &company, 80, 24).contains("change a decision first"));
    type_in(&mut page, "set_price * 2");
    assert!(page.problem.as_ref().is_some_and(|told| told.contains("did you mean set_prices")));
    in_dialog(&mut page, Action::Discard, &company);
    type_in(&mut page, "set_prices * 0.9");
    in_dialog(&mut page, Action::NextAlternative, &company);
    type_in(&mut page, "keep set_prices");
    let effects = in_dialog(&mut page, Action::SimulateBranches, &company).effects;
    let BranchesQuestion::Compare { week: 5, alternatives, futures: None } = asked(&effects) else {
        panic!("{effects:?}")
    };
    let told: Vec<String> = alternatives.iter().map(|own| own[0].to_string()).collect();
    assert_eq!(told, ["set_prices * 0.9", "keep set_prices"]);
    // The first esc stops the work, the second one closes the page.
    assert!(!in_dialog(&mut page, Action::Cancel, &company).close && !page.asked.is_waiting());
    assert!(in_dialog(&mut page, Action::Close, &company).close);
}

#[test]
fn a_refusal_leads_back_to_the_decisions() {
    let company = company();
    let mut page = page();
    page.take(Err(Refusal::new("not_in_this_mode", "not in an unfinished baseline run")));
    assert!(dialog_picture(&page, &company, 60, 16).contains("not in an unfinished baseline run"));
}
