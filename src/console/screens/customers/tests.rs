use super::model::*;
use super::*;
use crate::screens::Screen;
use crate::test_kit::{handle_action, screen_text, zoomed_text, played_screen, draw_at_all_sizes};
use novamind_database::Cell as Value;
use novamind_session::Session;
use novamind_session::identifiers::Channel;
use novamind_tools::ToolId;

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

#[test]
fn group_sums_equal_the_week_figures() {
    let (_, company, screen) = played_screen::<Customers>(6);
    let sum = |figure: &dyn Fn(&GroupFacts) -> f64, enterprise: bool| {
        let groups = company.observation.known_groups.iter().filter(|group| group.is_enterprise() == enterprise);
        groups.map(|group| figure(&screen.data.facts_of_group(*group))).sum::<f64>()
    };
    let week = company.observation.last_week.expect("a week");
    let now = |figure: fn(&WeekFlow) -> f64| move |facts: &GroupFacts| figure(&facts.week(6));
    assert_eq!(sum(&|facts| facts.sum(|plan_subscribers| plan_subscribers.customers), false), f64::from(week.individual_subscribers));
    assert_eq!(sum(&now(|flow| flow.leads), false), f64::from(week.new_individual_leads));
    assert_eq!(sum(&now(|flow| flow.signups), false), f64::from(week.new_individual_subscribers));
    assert_eq!(sum(&now(|flow| flow.cancellations), false), f64::from(week.cancellations));
    let monthly: f64 =
        [false, true].map(|kind| sum(&|facts| facts.sum(|subscribers| subscribers.monthly_revenue), kind)).iter().sum();
    assert!((monthly - week.recurring_revenue).abs() < 0.01);
    let stock = screen.data.facts_of_group(group("S1")).subscriptions_by_week(6);
    let held = screen.data.facts_of_group(group("S1")).sum(|held| held.customers);
    assert_eq!((stock.len(), stock[5].1), (6, held));
    let measured = screen.data.channel_measurement(Channel::ContentMarketing, group("S1"));
    assert_eq!(measured.spend, 750.0 * 28.0);
    assert!(measured.leads_per_thousand().is_some_and(|leads| leads > 1.0));
    assert_eq!(screen.data.channel_measurement(Channel::SearchAds, group("S1")).leads_per_thousand(), None);
}

#[test]
fn applying_rows_replaces_earlier_rows() {
    let row = |cells: &[Value]| QueryResult { rows: vec![cells.to_vec()], ..QueryResult::default() };
    let text = |text: &str| Value::Text(text.to_owned());
    let mut market = CustomerData::default();
    let query_result = row(&[
        text("S1"),
        text("B"),
        Value::Integer(10),
        Value::Integer(10),
        Value::Real(250.0),
        Value::Integer(8),
    ]);
    let left = row(&[Value::Integer(3), text("S1"), Value::Integer(2), Value::Integer(2)]);
    for _ in 0..2 {
        market.apply_rows(Reading::Subscribers, &query_result);
        market.apply_rows(Reading::Departures, &left);
    }
    let facts = market.facts_of_group(group("S1"));
    assert_eq!(facts.week(3).cancellations, 2.0);
    assert_eq!((facts.churn(), facts.revenue_per_seat(), facts.usage()), (Some(0.2), Some(25.0), None));
    market.apply_rows(Reading::Departures, &QueryResult::default());
    assert_eq!(market.facts_of_group(group("S1")).churn(), Some(0.0));
    market.apply_rows(Reading::Subscribers, &row(&[text("S1"), Value::Null]));
    assert_eq!(market.facts_of_group(group("S1")).churn(), None);
}

#[test]
fn open_group_links_to_its_tools() {
    let (mut session, company, mut screen) = played_screen::<Customers>(2);
    handle_action(&mut screen, Action::Down, &company);
    handle_action(&mut screen, Action::Open, &company);
    assert_eq!((screen.open_group, Screen::pane_count(&screen)), (Some(1), GROUP_PANES.len()));
    let text = screen_text(&screen, &company, 80, 21);
    assert!(text.contains("S2 · Quality-Focused Individuals") && text.contains("set_targeted_dev_spend"), "{text}");
    handle_action(&mut screen, Action::Down, &company);
    let effects = handle_action(&mut screen, Action::Open, &company);
    assert!(
        matches!(&effects[..], [Effect::ShowCell(ToolId::SetTargetedDevSpend, of)] if of == "S2"),
        "{effects:?}"
    );
    handle_action(&mut screen, Action::Last, &company);
    let Some(Effect::EditSql(sql)) = handle_action(&mut screen, Action::Open, &company).pop() else {
        panic!("no query")
    };
    session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
    handle_action(&mut screen, Action::Up, &company);
    let effects = handle_action(&mut screen, Action::Open, &company);
    assert!(
        matches!(effects[..], [Effect::ShowGroup(crate::context::ScreenId::Market, group)]
        if group.id() == "S2"),
        "{effects:?}"
    );
    screen.show_group(group("E1"), &company);
    assert_eq!(screen.open_group.map(|open| company.observation.known_groups[open].id()), Some("E1"));
    screen.show_group(group("S2"), &company);
    for _ in 0..40 {
        handle_action(&mut screen, Action::Right, &company);
    }
    assert_eq!(screen.open_group, Some(company.observation.known_groups.len() - 1));
    draw_at_all_sizes(&mut screen, &company);
    handle_action(&mut screen, Action::Close, &company);
    assert_eq!(screen.open_group, None);
}

fn query_figure(session: &mut Session, sql: &str, what: &str) -> f64 {
    let sql = format!("SELECT coalesce({what}, 0) FROM ({sql})");
    let rows = session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
    novamind_database::number_at(&rows.rows[0], 0)
}

#[test]
fn table_figures_equal_their_rows() {
    let (mut session, company, screen) = played_screen::<Customers>(7);
    for group in &company.observation.known_groups {
        let facts = screen.data.facts_of_group(*group);
        let flow = facts.week(7);
        for (head, shown, what) in [
            ("subs", facts.sum(|plan_subscribers| plan_subscribers.customers), "count(*)"),
            ("billed seats", facts.sum(|subscribers| subscribers.seats), "sum(seat_count)"),
            ("billed/mo", facts.sum(|held| held.monthly_revenue), "sum(amount)"),
            ("leads", flow.leads, "count(*)"),
            ("new", flow.signups, "count(*)"),
            ("cancelled", flow.cancellations, "count(*)"),
            ("ads/day", screen.data.ad_spend(*group), "sum(spend)"),
            ("churn 30d", facts.sum(|held| held.active_30_days_ago) + facts.lost_in_30_days, "count(*)"),
            ("use/day", facts.sum(|held| held.units), "sum(usage_units)"),
        ] {
            let sql =
                columns::figure_with_heading(head, *group, &company).and_then(|figure| figure.sql).expect(head);
            let made = query_figure(&mut session, &sql, what);
            assert!((made - shown).abs() < 0.02, "{group}, {head}: {shown}, sum of the rows {made}: {sql}");
        }
    }
}

#[test]
fn cohort_cells_count_retained_customers() {
    let (mut session, company, mut screen) = played_screen::<Customers>(9);
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    screen.show_group(group("S1"), &company);
    screen.set_focused_pane(CustomersPane::Cohorts);
    handle_action(&mut screen, Action::Last, &company);
    for _ in 0..9 {
        let figure = screen.figure(&context).expect("a figure");
        let sql = figure.sql.expect("rows");
        let kept = query_figure(&mut session, &sql, "count(*)");
        let size = query_figure(&mut session, sql.split("\n    AND (s.status").next().expect("words"), "count(*)");
        let share = novamind_base::formatting::percent(kept / size, 1);
        assert!(
            figure.title.starts_with(&format!("{share} of the S1 customers")),
            "{}: {share}",
            figure.title
        );
        handle_action(&mut screen, Action::Right, &company);
    }
    let text = screen_text(&screen, &company, 120, 37);
    for words in ["Retention, %", "signed", "+0", "100█", "all", "after 4 weeks"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

#[test]
fn group_panes_return_their_figures() {
    let (mut session, company, mut screen) = played_screen::<Customers>(8);
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    screen.show_group(group("S1"), &company);
    let mut rows = 0;
    for pane in 1..Screen::pane_count(&screen) {
        screen.set_focus(pane);
        handle_action(&mut screen, Action::First, &company);
        for _ in 0..20 {
            if let Some(sql) = screen.figure(&context).and_then(|figure| figure.sql) {
                session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
                rows += 1;
            }
            handle_action(&mut screen, Action::Down, &company);
        }
    }
    assert!(rows > 40, "{rows}");
    screen.set_focused_pane(CustomersPane::Weeks);
    let title = |screen: &Customers| screen.figure(&context).expect("a figure").title;
    handle_action(&mut screen, Action::First, &company);
    handle_action(&mut screen, Action::Left, &company);
    assert_eq!(title(&screen), "leads of S1 in week 7");
    let text = screen_text(&screen, &company, 200, 57);
    for words in [
        "Fit of S1",
        "required",
        "Study of S1",
        "lock-in aversion",
        "Retention, %",
        "Go to",
        "sources, 12 weeks",
        "week 7:",
    ] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

#[test]
fn all_columns_are_reachable_and_marked() {
    let (_, company, mut screen) = played_screen::<Customers>(3);
    let wide = screen_text(&screen, &company, 250, 57);
    for head in ["mkt share", "level", "ad $/new", "per seat", "churn 30d", "name", "dev/day"] {
        assert!(wide.contains(head), "{head} in\n{wide}");
    }
    let narrow = screen_text(&screen, &company, 80, 21);
    assert!(narrow.contains(" →") && !narrow.contains("dev/day"), "{narrow}");
    for _ in 0..15 {
        handle_action(&mut screen, Action::Right, &company);
    }
    let moved = screen_text(&screen, &company, 80, 21);
    assert!(moved.contains("dev/day") && moved.contains("group") && moved.contains('←'), "{moved}");
}

#[test]
fn small_window_shows_groups_and_channels() {
    let (_, company, screen) = played_screen::<Customers>(3);
    let text = screen_text(&screen, &company, 80, 21);
    for words in ["group", "E3", "referral_program", "Leads per $1,000", "content_marketing"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

#[test]
fn fit_shows_the_curve_and_both_conversions_of_the_open_group() {
    use novamind_insight::CurveExplorer;
    use novamind_worker::page_questions::EstimatedCurveQuestion;

    let (session, company, mut screen) = played_screen::<Customers>(4);
    let asked = handle_action(&mut screen, Action::Open, &company);
    let question = crate::test_kit::only_question::<EstimatedCurveQuestion>(&asked);
    assert_eq!(question.0.id(), "S1");
    assert!(screen_text(&screen, &company, 120, 37).contains("asking 2000 sampled leads"));
    screen.curve.set_answer(CurveExplorer::from_estimates(&session, group("S1")));
    screen.set_focused_pane(CustomersPane::Fit);
    for (width, height) in [(60, 12), (80, 20), (120, 37), (200, 57)] {
        let text = match height {
            12 | 20 => zoomed_text(&screen, &company, width, height),
            _ => screen_text(&screen, &company, width, height),
        };
        for words in ["estimated conversion ", "half"] {
            assert!(text.contains(words), "{words} at {width}×{height} in\n{text}");
        }
    }
    let measured = &company.fit(group("S1")).expect("a fit").measured;
    let text = screen_text(&screen, &company, 200, 57);
    for words in [measured.describe().split(" in weeks").next().expect("words"), "The estimate leaves out", "quality required"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    // The curve is requested again only if the company has changed or another group is opened.
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    assert!(screen.request_data(&context).is_empty());
    screen.on_company_change(&context);
    assert_eq!(screen.request_data(&context).len(), 1);
    screen.set_focused_pane(CustomersPane::Actions);
    let next = handle_action(&mut screen, Action::Right, &company);
    assert_eq!(crate::test_kit::only_question::<EstimatedCurveQuestion>(&next).0.id(), "S2");
}

#[test]
fn list_requests_the_curve_of_the_selected_group() {
    use novamind_insight::CurveExplorer;
    use novamind_worker::page_questions::EstimatedCurveQuestion;

    let (session, company, mut screen) = played_screen::<Customers>(4);
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    let asked = |effects: &[Effect]| crate::test_kit::only_question::<EstimatedCurveQuestion>(effects).0.id();
    assert!(!screen_text(&screen, &company, 120, 37).contains("shaded area"));
    assert_eq!(asked(&screen.request_data(&context)), "S1");
    screen.curve.set_answer(CurveExplorer::from_estimates(&session, group("S1")));
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("estimated conversion "), "{text}");
    screen.on_company_change(&context);
    assert_eq!(asked(&screen.request_data(&context)), "S1");
    screen.curve.set_answer(CurveExplorer::from_estimates(&session, group("S1")));
    assert_eq!(asked(&handle_action(&mut screen, Action::Down, &company)), "S2");
    // The answer for S2 must not replace the curve of the group to which the user returned.
    assert!(handle_action(&mut screen, Action::Up, &company).is_empty());
    assert!(!screen.curve.is_requested(group("S2")) && screen.curve.of_group(group("S1")).is_some());
    assert_eq!(asked(&Screen::handle_click(&mut screen, 0, 2, &context)), "S3");
}

#[test]
fn tour_leads_to_the_cancellations_column() {
    let (_, company, mut screen) = played_screen::<Customers>(4);
    let facts = screen.tour_facts(&company);
    for _ in 0..facts.columns_to_cancellations {
        handle_action(&mut screen, Action::Right, &company);
    }
    let column = screen.table.selected_column();
    assert_eq!(screen.table.columns()[column].title, facts.cancellations_heading);
    assert_eq!((facts.cancellations_heading, screen.tour_facts(&company).columns_to_cancellations), ("cancelled", 0));
}

#[test]
fn narrow_study_shows_every_range() {
    let (_, company, mut screen) = played_screen::<Customers>(2);
    screen.show_group(group("S1"), &company);
    screen.set_focused_pane(CustomersPane::Study);
    for (width, height) in [(60, 13), (80, 21)] {
        handle_action(&mut screen, Action::First, &company);
        let mut text = screen_text(&screen, &company, width, height);
        for _ in 0..30 {
            handle_action(&mut screen, Action::PageDown, &company);
            text += &screen_text(&screen, &company, width, height);
        }
        for line in crate::screens::market::report::report_lines(&company, group("S1")) {
            assert!(text.contains(&line.value), "{} at {width}×{height}:\n{text}", line.value);
        }
    }
}

#[test]
fn fit_text_is_read_by_pages() {
    let (_, company, mut screen) = played_screen::<Customers>(4);
    screen.show_group(group("S1"), &company);
    screen.set_focused_pane(CustomersPane::Fit);
    let first = screen_text(&screen, &company, 80, 13);
    handle_action(&mut screen, Action::PageDown, &company);
    assert_ne!(screen_text(&screen, &company, 80, 13), first);
    handle_action(&mut screen, Action::PageUp, &company);
    assert_eq!(screen_text(&screen, &company, 80, 13), first);
}

#[test]
fn every_week_of_the_retention_is_reached() {
    let (_, company, mut screen) = played_screen::<Customers>(8);
    screen.show_group(group("S1"), &company);
    screen.set_focused_pane(CustomersPane::Cohorts);
    let visible = |screen: &Customers| screen_text(screen, &company, 80, 21).contains("+7");
    assert!(!visible(&screen));
    (0..7).for_each(|_| drop(handle_action(&mut screen, Action::Right, &company)));
    assert!(visible(&screen), "{}", screen_text(&screen, &company, 80, 21));
}
