use serde_json::json;

use super::model::*;
use super::*;
use crate::action::Action;
use crate::effect::Effect;
use crate::screens::Screen;
use crate::test_kit::{handle_action, screen_text, played_screen, played_session, loaded_screen};
use novamind_report::plan_margins::PlanUsage;
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

#[test]
fn plan_margin_is_revenue_minus_compute() {
    let plan = PlanFacts {
        unit_cost: 0.002,
        usage: PlanUsage {
            customers: 10.0,
            seats: 20.0,
            monthly_revenue: 240.0,
            measured_units: 1000.0,
            measured_seats: 20.0,
            measured_revenue: 240.0,
            ..PlanUsage::default()
        },
        ..PlanFacts::default()
    };
    assert_eq!((plan.usage.units_per_seat(), plan.usage.revenue_per_seat(), plan.compute_cost_per_seat()), (Some(50.0), Some(12.0), Some(3.0)));
    assert_eq!(plan.margin(), Some(0.75));
    let nobody = PlanFacts::default();
    assert_eq!((nobody.usage.units_per_seat(), nobody.usage.revenue_per_seat(), nobody.margin()), (None, None, None));
}

#[test]
fn screen_queries_agree_with_the_company() {
    let (_, company, screen) = played_screen::<Product>(6);
    let week = company.observation.last_week.expect("a week");
    assert_eq!(screen.days.len(), 42);
    let usage: f64 = screen.days[35..].iter().map(|day| day.usage).sum();
    assert_eq!(usage, week.usage as f64);
    let customers: f64 = screen.plans.iter().map(|plan| plan.usage.customers).sum();
    assert_eq!(customers, f64::from(week.individual_subscribers + company.observation.companies));
    assert!(screen.plans.iter().any(|plan| plan.margin().is_some_and(|margin| margin > 0.0 && margin < 1.0)));
    assert_eq!((screen.capacity_tiers.len(), screen.selected_rows[ProductPane::Capacity as usize]), (8, 2));
    assert_eq!((screen.projects.len(), screen.projects[0].started_day), (1, 0));
    assert_eq!(screen.offers.iter().map(|offer| offer.running_and_done.0 + offer.running_and_done.1).sum::<usize>(), 1);
    assert_eq!(screen.spending.operations.last(), Some(&1400.0));
    assert_eq!(last_week(&[]), None);
}

#[test]
fn opening_a_capacity_tier_prefills_the_form() {
    let (_, company, mut screen) = played_screen::<Product>(2);
    screen.set_focused_pane(ProductPane::Capacity);
    screen.selected_rows[ProductPane::Capacity as usize] = 5;
    let effects = handle_action(&mut screen, Action::Open, &company);
    let [Effect::Prefill { tool: ToolId::SetCapacityTier, arguments }] = &effects[..] else {
        panic!("{effects:?}")
    };
    assert_eq!(arguments, &json!({"tier": 5}));
    let text = screen_text(&screen, &company, 120, 37);
    assert!(!text.contains(" 12 days"), "no project takes less than 30 days:\n{text}");
    assert!(screen.offers.iter().all(|offer| offer.means.days > 30.0));
}

#[test]
fn opening_a_row_of_every_pane_has_an_effect() {
    let (mut session, company, mut screen) = played_screen::<Product>(2);
    for pane in ProductPane::VARIANTS {
        screen.set_focused_pane(*pane);
        for _ in 0..12 {
            match handle_action(&mut screen, Action::Open, &company).pop() {
                Some(Effect::ShowTool(_)) => {}
                Some(Effect::ShowCell(tool, of)) => {
                    let mut tools = crate::screens::tools::Tools::default();
                    tools.show_cell(tool, &of, &company);
                    assert!(
                        tools.focused_path().is_some_and(|path| path.split('.').any(|name| name == of)),
                        "{tool} {of}"
                    );
                }
                Some(Effect::Prefill { tool, arguments }) => {
                    let mut tools = crate::screens::tools::Tools::default();
                    tools.prefill(tool, &arguments, &company);
                    assert_eq!(tools.typed_arguments(), Some(arguments));
                }
                Some(Effect::EditSql(sql)) => {
                    session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
                }
                other => panic!("{other:?}"),
            }
            handle_action(&mut screen, Action::Down, &company);
        }
    }
    handle_action(&mut screen, Action::Right, &company);
    assert_eq!(screen.focus, ProductPane::Quality);
}

#[test]
fn small_window_summarizes_every_pane() {
    let (_, company, screen) = played_screen::<Product>(3);
    let text = screen_text(&screen, &company, 80, 21);
    let titles = ProductPane::VARIANTS.iter().map(|pane| pane.title());
    for words in titles.chain(["tier 2", "margin", "units/day", "◆ now"]) {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

/// Maximum number of rows in a query result.
const MAX_ANSWER_ROWS: f64 = 5000.0;

#[test]
fn figures_equal_their_rows() {
    let (mut session, company, mut screen) = played_screen::<Product>(6);
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    for pane in ProductPane::VARIANTS {
        screen.set_focused_pane(*pane);
        for _ in 0..pane.panel().row_count(&screen, &company) {
            let figure = screen.figure(&context).expect("a figure");
            if let Some(sql) = figure.sql {
                session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
            }
            handle_action(&mut screen, Action::Down, &company);
        }
    }
    let mut rows = |screen: &Product| {
        let sql = screen.figure(&context).and_then(|figure| figure.sql).expect("rows");
        session.query(&sql).expect("rows").rows
    };
    screen.set_focused_pane(ProductPane::Plans);
    (screen.selected_rows[ProductPane::Plans as usize], screen.selected_plan) = (4, 1);
    assert_eq!(screen.figure(&context).expect("a figure").title, "customers of plan B");
    assert_eq!(rows(&screen).len() as f64, screen.plans[1].usage.customers.min(MAX_ANSWER_ROWS));
    handle_action(&mut screen, Action::Right, &company);
    assert_eq!(
        (screen.focus, rows(&screen).len() as f64),
        (ProductPane::Plans, screen.plans[2].usage.customers.min(MAX_ANSWER_ROWS))
    );
    screen.set_focused_pane(ProductPane::Issues);
    screen.selected_rows[ProductPane::Issues as usize] = 0;
    let issues = screen.issues.clone().expect("issues");
    let first = issues.values().next().expect("a group with open issues");
    assert_eq!(rows(&screen).len() as f64, first.iter().sum::<f64>().min(MAX_ANSWER_ROWS));
    screen.set_focused_pane(ProductPane::Research);
    screen.selected_rows[ProductPane::Research as usize] = 0;
    assert_eq!(rows(&screen).len(), 1, "the project that was started");
}

#[test]
fn unread_data_is_not_shown_as_zero() {
    let mut session = played_session(4);
    let company = DisplayedCompany::from_session(&session);
    let mut screen = Product::default();
    screen.set_focused_pane(ProductPane::Issues);
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("reading …") && !text.contains("-0 open"), "{text}");
    let screen: Product = loaded_screen(&mut session, &company);
    let text = screen_text(&screen, &company, 120, 37);
    for words in ["dotted: tier", "usage below capacity", " open, "] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    let mut screen = screen;
    screen.set_focused_pane(ProductPane::Research);
    let text = crate::test_kit::zoomed_text(&screen, &company, 120, 37);
    assert!(text.contains("▼ now") && text.contains("$/0.01"), "{text}");
}

#[test]
fn utilization_is_usage_divided_by_capacity() {
    let load = |usage, capacity| ServiceDay { usage, capacity, ..ServiceDay::default() }.utilization();
    assert_eq!([load(50.0, 200.0), load(300.0, 200.0), load(5.0, 0.0)], [0.25, 1.5, 0.0]);
}

#[test]
fn outage_minutes_add_up_to_the_total_in_the_title() {
    let day = |day: u32, downtime: f64| ServiceDay { day, downtime_minutes: downtime, capacity: 1.0, ..ServiceDay::default() };
    let days: Vec<ServiceDay> = (1..=28).map(|at| day(at, if at % 10 == 0 { 30.0 } else { 0.0 })).collect();
    assert!(service::summary(&days)[0].contains("outage 60 min in 28 days"));
    let text = crate::test_kit::render_rows(90, 8, |canvas, area| service::draw(canvas, area, &days));
    let line = text.iter().find(|line| line.starts_with("outage, minutes")).expect("a line");
    let figures: Vec<&str> = line.split_whitespace().skip(2).take(3).collect();
    assert_eq!(figures, ["0", "0", "60"], "{line}");
}
