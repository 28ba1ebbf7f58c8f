//! Tests of the curve explorer: keys drag plans, the responses change, and nothing is set.

use super::*;
use crate::test_kit::{asked, dialog_picture, in_dialog, played};
use novamind_insight::CurveExplorer;
use novamind_worker::company::Company;

fn explored(group: &str) -> (CurvePage, Company) {
    let mut session = played(1);
    let group = Group::parse(group).expect("a group");
    let (mut page, _) = CurvePage::new(group);
    page.asked.put(CurveExplorer::of(&mut session, group));
    page.take_answers();
    (page, Company::of(&session))
}

#[test]
fn prices_and_qualities_are_dragged_and_the_leads_asked_again() {
    let (mut page, company) = explored("S1");
    let before = page.opened().expect("a curve").outcome;
    let list = page.opened().expect("a curve").plans[Plan::A].list;
    in_dialog(&mut page, Action::Right, &company);
    in_dialog(&mut page, Action::Right, &company);
    in_dialog(&mut page, Action::PageUp, &company);
    let opened = page.opened().expect("a curve");
    assert_eq!(opened.plans[Plan::A].list, list.floor() + 2.0);
    assert_eq!(opened.plans[Plan::B], opened.explorer.plans[Plan::B]);
    assert_ne!(opened.outcome, before);
    // Drags all plans together, then resets them.
    for _ in 0..3 {
        in_dialog(&mut page, Action::NextPlan, &company);
    }
    assert_eq!(page.chosen, None);
    in_dialog(&mut page, Action::Down, &company);
    let opened = page.opened().expect("a curve");
    assert!(Plan::ALL.iter().all(|plan| opened.plans[*plan].quality != opened.explorer.plans[*plan].quality));
    in_dialog(&mut page, Action::ResetCurve, &company);
    assert_eq!(page.opened().expect("a curve").outcome, before);
    for _ in 0..400 {
        in_dialog(&mut page, Action::Left, &company);
        in_dialog(&mut page, Action::Down, &company);
    }
    let lowest = page.opened().expect("a curve").plans[Plan::C];
    assert_eq!((lowest.list, lowest.quality), (0.0, 0.0));
}

#[test]
fn what_was_dragged_is_typed_into_the_form_and_nothing_is_set() {
    let (mut page, company) = explored("S1");
    let shown = in_dialog(&mut page, Action::Open, &company);
    assert!(matches!(shown.effects[..], [Effect::CloseDialogs, Effect::ShowTool(ToolId::SetPrices)]));
    in_dialog(&mut page, Action::Right, &company);
    let shown = in_dialog(&mut page, Action::Open, &company);
    assert!(
        matches!(&shown.effects[..], [Effect::CloseDialogs, Effect::Prefill { tool: ToolId::SetPrices, arguments }]
            if arguments.as_object().is_some_and(|own| own.len() == 1 && own.contains_key("A")))
    );
    let next = in_dialog(&mut page, Action::NextCurve, &company);
    assert_eq!(asked::<CurveQuestion>(&next.effects).0.id(), "S2");
    assert!(dialog_picture(&page, &company, 80, 21).contains("asking 2000 leads"));
    let back = in_dialog(&mut page, Action::PreviousCurve, &company);
    assert_eq!(asked::<CurveQuestion>(&back.effects).0.id(), "S1");
    assert!(in_dialog(&mut page, Action::Close, &company).close);
}

#[test]
fn every_window_has_its_page() {
    for group in ["S1", "E1"] {
        let (page, company) = explored(group);
        for (width, height) in [(0, 0), (2, 2), (20, 5), (60, 13), (60, 16), (80, 24), (120, 40), (200, 60)] {
            let picture = dialog_picture(&page, &company, width, height);
            if width >= 60 {
                for words in ["urve of", "estimates of day 0, ±65%", "half", "left right price"] {
                    assert!(picture.contains(words), "{words} in {picture}");
                }
            }
        }
    }
    let (mut page, _) = CurvePage::new(Group::parse("D_S05").expect("a group"));
    let refused = Refusal::new("group_not_discovered", "group D_S05 is not known yet");
    page.asked.put(Err(refused));
    page.take_answers();
    let company = explored("S1").1;
    assert!(dialog_picture(&page, &company, 60, 16).contains("not known yet"));
}

#[test]
fn steps_lead_to_round_values() {
    assert_eq!(
        (stepped(12.5, 1.0, 1.0), stepped(12.5, -1.0, 1.0), stepped(12.0, 1.0, 1.0)),
        (13.0, 12.0, 13.0)
    );
    assert!((stepped(0.1234, 1.0, 0.01) - 0.13).abs() < 1e-12);
    assert_eq!((price_step(90.0), price_step(300.0), price_step(900.0)), (1.0, 2.0, 5.0));
}
