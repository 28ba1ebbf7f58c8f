use serde_json::json;

use super::model::*;
use super::*;
use crate::action::Action;
use crate::effect::Effect;
use crate::screens::Screen;
use crate::test_kit::{act, drawn, on_screen, played, shown};
use novamind_report::plan_margins::PlanUse;
use novamind_tools::ToolId;
use novamind_worker::company::Company;

#[test]
fn plans_earn_what_is_paid_less_what_is_used() {
    let plan = PlanFacts {
        unit_cost: 0.002,
        sold: PlanUse {
            customers: 10.0,
            seats: 20.0,
            monthly: 240.0,
            units: 1000.0,
            users: 20.0,
            paid_by_users: 240.0,
            ..PlanUse::default()
        },
        ..PlanFacts::default()
    };
    assert_eq!((plan.sold.usage(), plan.sold.revenue(), plan.compute()), (Some(50.0), Some(12.0), Some(3.0)));
    assert_eq!(plan.margin(), Some(0.75));
    let nobody = PlanFacts::default();
    assert_eq!((nobody.sold.usage(), nobody.sold.revenue(), nobody.margin()), (None, None, None));
}

#[test]
fn the_readings_agree_with_the_company() {
    let (_, company, screen) = on_screen::<Product>(6);
    let week = company.seen.last_week.expect("a week");
    assert_eq!(screen.days.len(), 42);
    let usage: f64 = screen.days[35..].iter().map(|day| day.usage).sum();
    assert_eq!(usage, week.usage as f64);
    let customers: f64 = screen.plans.iter().map(|plan| plan.sold.customers).sum();
    assert_eq!(customers, f64::from(week.individual_subscribers + company.seen.companies));
    assert!(screen.plans.iter().any(|plan| plan.margin().is_some_and(|margin| margin > 0.0 && margin < 1.0)));
    assert_eq!((screen.rungs.len(), screen.places[ProductPane::Capacity as usize]), (8, 2));
    assert_eq!((screen.projects.len(), screen.projects[0].started), (1, 0));
    assert_eq!(screen.offers.iter().map(|offer| offer.counts.0 + offer.counts.1).sum::<usize>(), 1);
    assert_eq!(screen.spent.operations.last(), Some(&1400.0));
    assert_eq!(last_week(&[]), None);
}

#[test]
fn a_rung_of_the_ladder_leads_to_the_form_with_that_tier() {
    let (_, company, mut screen) = on_screen::<Product>(2);
    screen.focus_on(ProductPane::Capacity);
    screen.places[ProductPane::Capacity as usize] = 5;
    let effects = act(&mut screen, Action::Open, &company);
    let [Effect::Prefill { tool: ToolId::SetCapacityTier, arguments }] = &effects[..] else {
        panic!("{effects:?}")
    };
    assert_eq!(arguments, &json!({"tier": 5}));
    let text = drawn(&screen, &company, 120, 37);
    assert!(!text.contains(" 12 days"), "no project takes less than 30 days:\n{text}");
    assert!(screen.offers.iter().all(|offer| offer.means.days > 30.0));
}

#[test]
fn every_pane_leads_somewhere() {
    let (mut session, company, mut screen) = on_screen::<Product>(2);
    for pane in ProductPane::VARIANTS {
        screen.focus_on(*pane);
        for _ in 0..12 {
            match act(&mut screen, Action::Open, &company).pop() {
                Some(Effect::ShowTool(_)) => {}
                Some(Effect::ShowCell(tool, of)) => {
                    let mut tools = crate::screens::tools::Tools::default();
                    tools.show_cell(tool, &of, &company);
                    assert!(
                        tools.place_path().is_some_and(|path| path.split('.').any(|name| name == of)),
                        "{tool} {of}"
                    );
                }
                Some(Effect::Prefill { tool, arguments }) => {
                    let mut tools = crate::screens::tools::Tools::default();
                    tools.prefill(tool, &arguments, &company);
                    assert_eq!(tools.typed_arguments(), Some(arguments));
                }
                Some(Effect::EditSql(sql)) => {
                    session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
                }
                other => panic!("{other:?}"),
            }
            act(&mut screen, Action::Down, &company);
        }
    }
    act(&mut screen, Action::Right, &company);
    assert_eq!(screen.focus, ProductPane::Quality);
}

#[test]
fn the_small_window_has_a_line_on_everything() {
    let (_, company, screen) = on_screen::<Product>(3);
    let text = drawn(&screen, &company, 80, 21);
    let titles = ProductPane::VARIANTS.iter().map(|pane| pane.title());
    for words in titles.chain(["tier 2", "margin", "units/day", "◆ now"]) {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

/// Maximum rows of a query result.
const MOST: f64 = 5000.0;

#[test]
fn figures_are_made_of_their_rows() {
    let (mut session, company, mut screen) = on_screen::<Product>(6);
    let keys = crate::keys::Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 5 };
    for pane in ProductPane::VARIANTS {
        screen.focus_on(*pane);
        for _ in 0..pane.part().rows(&screen, &company) {
            let figure = screen.figure(&look).expect("a figure");
            if let Some(sql) = figure.sql {
                session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
            }
            act(&mut screen, Action::Down, &company);
        }
    }
    let mut rows = |screen: &Product| {
        let sql = screen.figure(&look).and_then(|figure| figure.sql).expect("rows");
        session.query(&sql).expect("rows").rows
    };
    screen.focus_on(ProductPane::Plans);
    (screen.places[ProductPane::Plans as usize], screen.column) = (4, 1);
    assert_eq!(screen.figure(&look).expect("a figure").title, "customers of plan B");
    assert_eq!(rows(&screen).len() as f64, screen.plans[1].sold.customers.min(MOST));
    act(&mut screen, Action::Right, &company);
    assert_eq!(
        (screen.focus, rows(&screen).len() as f64),
        (ProductPane::Plans, screen.plans[2].sold.customers.min(MOST))
    );
    screen.focus_on(ProductPane::Issues);
    screen.places[ProductPane::Issues as usize] = 0;
    let issues = screen.issues.clone().expect("issues");
    let first = issues.values().next().expect("a group with open issues");
    assert_eq!(rows(&screen).len() as f64, first.iter().sum::<f64>().min(MOST));
    screen.focus_on(ProductPane::Research);
    screen.places[ProductPane::Research as usize] = 0;
    assert_eq!(rows(&screen).len(), 1, "the project that was started");
}

#[test]
fn what_was_not_read_yet_is_not_called_nothing() {
    let mut session = played(4);
    let company = Company::of(&session);
    let mut screen = Product::default();
    screen.focus_on(ProductPane::Issues);
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("reading …") && !text.contains("-0 open"), "{text}");
    let screen: Product = shown(&mut session, &company);
    let text = drawn(&screen, &company, 120, 37);
    for words in ["dotted: tier", "usage below capacity", " open, "] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    let mut screen = screen;
    screen.focus_on(ProductPane::Research);
    let text = crate::test_kit::zoomed(&screen, &company, 120, 37);
    assert!(text.contains("▼ now") && text.contains("$/0.01"), "{text}");
}

#[test]
fn load_is_the_share_of_the_capacity_that_is_used() {
    let load = |usage, capacity| Day { usage, capacity, ..Day::default() }.utilisation();
    assert_eq!([load(50.0, 200.0), load(300.0, 200.0), load(5.0, 0.0)], [0.25, 1.5, 0.0]);
}

#[test]
fn minutes_of_outage_add_up_to_the_minutes_in_the_title() {
    let day = |day: u32, downtime: f64| Day { day, downtime, capacity: 1.0, ..Day::default() };
    let days: Vec<Day> = (1..=28).map(|at| day(at, if at % 10 == 0 { 30.0 } else { 0.0 })).collect();
    assert!(service::summary(&days)[0].contains("outage 60 min in 28 days"));
    let text = crate::test_kit::painted(90, 8, |canvas, area| service::draw(canvas, area, &days));
    let line = text.iter().find(|line| line.starts_with("outage, minutes")).expect("a line");
    let figures: Vec<&str> = line.split_whitespace().skip(2).take(3).collect();
    assert_eq!(figures, ["0", "0", "60"], "{line}");
}
