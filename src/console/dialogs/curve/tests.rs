//! Tests of the curve explorer: keys drag plans, the responses change, and no setting changes.

use super::*;
use crate::test_kit::{dialog_action, dialog_text, only_question, played_session};
use novamind_insight::CurveExplorer;
use novamind_worker::company::DisplayedCompany;

fn explored_page(group: &str) -> (CurveDialog, DisplayedCompany) {
    let mut session = played_session(1);
    let group = Group::parse(group).expect("a group");
    let (mut page, _) = CurveDialog::new(group);
    page.asked.set_answer(CurveExplorer::open(&mut session, group));
    page.take_answers();
    (page, DisplayedCompany::from_session(&session))
}

#[test]
fn adjusting_a_plan_updates_the_outcome() {
    let (mut page, company) = explored_page("S1");
    let before = page.successful_exploration().expect("a curve").outcome;
    let list = page.successful_exploration().expect("a curve").plans[Plan::A].list_price;
    dialog_action(&mut page, Action::Right, &company);
    dialog_action(&mut page, Action::Right, &company);
    dialog_action(&mut page, Action::PageUp, &company);
    let opened = page.successful_exploration().expect("a curve");
    assert_eq!(opened.plans[Plan::A].list_price, list.floor() + 2.0);
    assert_eq!(opened.plans[Plan::B], opened.explorer.plans[Plan::B]);
    assert_ne!(opened.outcome, before);
    // All plans are dragged together, and then reset.
    for _ in 0..3 {
        dialog_action(&mut page, Action::NextPlan, &company);
    }
    assert_eq!(page.selected_plan, None);
    dialog_action(&mut page, Action::Down, &company);
    let opened = page.successful_exploration().expect("a curve");
    assert!(Plan::ALL.iter().all(|plan| opened.plans[*plan].quality != opened.explorer.plans[*plan].quality));
    dialog_action(&mut page, Action::ResetCurve, &company);
    assert_eq!(page.successful_exploration().expect("a curve").outcome, before);
    for _ in 0..400 {
        dialog_action(&mut page, Action::Left, &company);
        dialog_action(&mut page, Action::Down, &company);
    }
    let lowest = page.successful_exploration().expect("a curve").plans[Plan::C];
    assert_eq!((lowest.list_price, lowest.quality), (0.0, 0.0));
}

#[test]
fn adjusted_prices_fill_the_form_without_a_call() {
    let (mut page, company) = explored_page("S1");
    let dialog_response = dialog_action(&mut page, Action::Open, &company);
    assert!(matches!(
        dialog_response.effects[..],
        [Effect::CloseDialogs, Effect::ShowTool(ToolId::SetPrices)]
    ));
    dialog_action(&mut page, Action::Right, &company);
    let response = dialog_action(&mut page, Action::Open, &company);
    assert!(
        matches!(&response.effects[..], [Effect::CloseDialogs, Effect::Prefill { tool: ToolId::SetPrices, arguments }]
            if arguments.as_object().is_some_and(|prices| prices.len() == 1 && prices.contains_key("A")))
    );
    let next = dialog_action(&mut page, Action::NextCurve, &company);
    assert_eq!(only_question::<CurveQuestion>(&next.effects).0.id(), "S2");
    assert!(dialog_text(&page, &company, 80, 21).contains("asking 2000 leads"));
    let back = dialog_action(&mut page, Action::PreviousCurve, &company);
    assert_eq!(only_question::<CurveQuestion>(&back.effects).0.id(), "S1");
    assert!(dialog_action(&mut page, Action::Close, &company).closes);
}

#[test]
fn page_is_drawn_at_every_size() {
    for group in ["S1", "E1"] {
        let (page, company) = explored_page(group);
        for (width, height) in [(0, 0), (2, 2), (20, 5), (60, 13), (60, 16), (80, 24), (120, 40), (200, 60)] {
            let picture = dialog_text(&page, &company, width, height);
            if width >= 60 {
                for words in ["urve of", "estimates of day 0", "half", "left right price"] {
                    assert!(picture.contains(words), "{words} in {picture}");
                }
            }
        }
    }
    let (mut page, _) = CurveDialog::new(Group::parse("D_S05").expect("a group"));
    let refused = Rejection::new("group_not_discovered", "group D_S05 is not known yet");
    page.asked.set_answer(Err(refused));
    page.take_answers();
    let company = explored_page("S1").1;
    assert!(dialog_text(&page, &company, 60, 16).contains("not known yet"));
}

#[test]
fn steps_reach_round_values() {
    assert_eq!(
        (
            step_to_multiple(12.5, 1.0, 1.0),
            step_to_multiple(12.5, -1.0, 1.0),
            step_to_multiple(12.0, 1.0, 1.0)
        ),
        (13.0, 12.0, 13.0)
    );
    assert!((step_to_multiple(0.1234, 1.0, 0.01) - 0.13).abs() < 1e-12);
    assert_eq!((price_step(90.0), price_step(300.0), price_step(900.0)), (1.0, 2.0, 5.0));
}
