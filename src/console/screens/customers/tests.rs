use super::model::*;
use super::*;
use crate::screens::Screen;
use crate::test_kit::{act, drawn, on_screen, sweep};
use novamind_database::Cell as Value;
use novamind_session::Session;
use novamind_session::identifiers::Channel;
use novamind_tools::ToolId;

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

#[test]
fn the_groups_agree_with_the_figures_of_the_week() {
    let (_, company, screen) = on_screen::<Customers>(6);
    let sum = |figure: &dyn Fn(&CustomerFacts) -> f64, enterprise: bool| {
        let groups = company.seen.known_groups.iter().filter(|group| group.is_enterprise() == enterprise);
        groups.map(|group| figure(&screen.market.of(*group))).sum::<f64>()
    };
    let week = company.seen.last_week.expect("a week");
    let now = |figure: fn(&Flow) -> f64| move |facts: &CustomerFacts| figure(&facts.week(6));
    assert_eq!(sum(&|facts| facts.sum(|held| held.customers), false), f64::from(week.individual_subscribers));
    assert_eq!(sum(&now(|flow| flow.leads), false), f64::from(week.new_individual_leads));
    assert_eq!(sum(&now(|flow| flow.signed), false), f64::from(week.new_individual_subscribers));
    assert_eq!(sum(&now(|flow| flow.cancelled), false), f64::from(week.cancellations));
    let monthly: f64 =
        [false, true].map(|kind| sum(&|facts| facts.sum(|held| held.monthly), kind)).iter().sum();
    assert!((monthly - week.recurring_revenue).abs() < 0.01);
    let stock = screen.market.of(group("S1")).stock(6);
    let held = screen.market.of(group("S1")).sum(|held| held.customers);
    assert_eq!((stock.len(), stock[5].1), (6, held));
    let measured = screen.market.measured(Channel::ContentMarketing, group("S1"));
    assert_eq!(measured.spend, 750.0 * 28.0);
    assert!(measured.per_thousand().is_some_and(|leads| leads > 1.0));
    assert_eq!(screen.market.measured(Channel::SearchAds, group("S1")).per_thousand(), None);
}

#[test]
fn a_reading_replaces_what_it_said_before() {
    let row = |cells: &[Value]| Rows { rows: vec![cells.to_vec()], ..Rows::default() };
    let text = |text: &str| Value::Text(text.to_owned());
    let mut market = MarketRows::default();
    let held = row(&[
        text("S1"),
        text("B"),
        Value::Integer(10),
        Value::Integer(10),
        Value::Real(250.0),
        Value::Integer(8),
    ]);
    let left = row(&[Value::Integer(3), text("S1"), Value::Integer(2), Value::Integer(2)]);
    for _ in 0..2 {
        market.take(Reading::Subscribers, &held);
        market.take(Reading::Departures, &left);
    }
    let facts = market.of(group("S1"));
    assert_eq!(facts.week(3).cancelled, 2.0);
    assert_eq!((facts.churn(), facts.revenue_per_seat(), facts.usage()), (Some(0.2), Some(25.0), None));
    market.take(Reading::Departures, &Rows::default());
    assert_eq!(market.of(group("S1")).churn(), Some(0.0));
    market.take(Reading::Subscribers, &row(&[text("S1"), Value::Null]));
    assert_eq!(market.of(group("S1")).churn(), None);
}

#[test]
fn a_group_opens_and_leads_to_its_tools() {
    let (mut session, company, mut screen) = on_screen::<Customers>(2);
    act(&mut screen, Action::Down, &company);
    act(&mut screen, Action::Open, &company);
    assert_eq!((screen.open, Screen::panes(&screen)), (Some(1), OPENED.len()));
    let text = drawn(&screen, &company, 80, 21);
    assert!(text.contains("S2 · individual") && text.contains("set_targeted_dev_spend"), "{text}");
    act(&mut screen, Action::Down, &company);
    let effects = act(&mut screen, Action::Open, &company);
    assert!(
        matches!(&effects[..], [Effect::ShowCell(ToolId::SetTargetedDevSpend, of)] if of == "S2"),
        "{effects:?}"
    );
    act(&mut screen, Action::Last, &company);
    let Some(Effect::EditSql(sql)) = act(&mut screen, Action::Open, &company).pop() else {
        panic!("no query")
    };
    session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
    act(&mut screen, Action::Up, &company);
    let effects = act(&mut screen, Action::Open, &company);
    assert!(
        matches!(effects[..], [Effect::ShowGroup(crate::context::ScreenId::Market, group)]
        if group.id() == "S2"),
        "{effects:?}"
    );
    screen.show(group("E1"), &company);
    assert_eq!(screen.open.map(|open| company.seen.known_groups[open].id()), Some("E1"));
    screen.show(group("S2"), &company);
    for _ in 0..40 {
        act(&mut screen, Action::Right, &company);
    }
    assert_eq!(screen.open, Some(company.seen.known_groups.len() - 1));
    sweep(&mut screen, &company);
    act(&mut screen, Action::Close, &company);
    assert_eq!(screen.open, None);
}

fn made(session: &mut Session, sql: &str, what: &str) -> f64 {
    let sql = format!("SELECT coalesce({what}, 0) FROM ({sql})");
    let rows = session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
    novamind_database::number_at(&rows.rows[0], 0)
}

#[test]
fn every_figure_of_the_table_is_made_of_its_rows() {
    let (mut session, company, screen) = on_screen::<Customers>(7);
    for group in &company.seen.known_groups {
        let facts = screen.market.of(*group);
        let flow = facts.week(7);
        for (head, shown, what) in [
            ("subs", facts.sum(|held| held.customers), "count(*)"),
            ("billed seats", facts.sum(|held| held.seats), "sum(seat_count)"),
            ("billed/mo", facts.sum(|held| held.monthly), "sum(amount)"),
            ("leads", flow.leads, "count(*)"),
            ("new", flow.signed, "count(*)"),
            ("left", flow.cancelled, "count(*)"),
            ("ads/day", screen.market.ad_spend(*group), "sum(spend)"),
            ("churn 30d", facts.sum(|held| held.since_30_days) + facts.lost_in_30_days, "count(*)"),
            ("use/day", facts.sum(|held| held.units), "sum(usage_units)"),
        ] {
            let sql =
                columns::figure_named(head, *group, &company).and_then(|figure| figure.sql).expect(head);
            let made = made(&mut session, &sql, what);
            assert!((made - shown).abs() < 0.02, "{head} of {group}: {shown}, rows make {made}: {sql}");
        }
    }
}

#[test]
fn the_triangle_is_made_of_customers_who_stayed() {
    let (mut session, company, mut screen) = on_screen::<Customers>(9);
    let keys = crate::keys::Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 5 };
    screen.show(group("S1"), &company);
    screen.focus_on(CustomersPane::Cohorts);
    act(&mut screen, Action::Last, &company);
    for _ in 0..9 {
        let figure = screen.figure(&look).expect("a figure");
        let sql = figure.sql.expect("rows");
        let kept = made(&mut session, &sql, "count(*)");
        let size = made(&mut session, sql.split("\n    AND (s.status").next().expect("words"), "count(*)");
        let share = novamind_base::notation::percent(kept / size, 1);
        assert!(
            figure.title.starts_with(&format!("{share} of the S1 customers")),
            "{}: {share}",
            figure.title
        );
        act(&mut screen, Action::Right, &company);
    }
    let text = drawn(&screen, &company, 120, 37);
    for words in ["Retention, %", "signed", "+0", "100█", "all", "after 4 weeks"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}

#[test]
fn every_pane_of_a_group_has_its_figures() {
    let (mut session, company, mut screen) = on_screen::<Customers>(8);
    let keys = crate::keys::Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 5 };
    screen.show(group("S1"), &company);
    let mut rows = 0;
    for pane in 1..Screen::panes(&screen) {
        screen.set_focus(pane);
        act(&mut screen, Action::First, &company);
        for _ in 0..20 {
            if let Some(sql) = screen.figure(&look).and_then(|figure| figure.sql) {
                session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
                rows += 1;
            }
            act(&mut screen, Action::Down, &company);
        }
    }
    assert!(rows > 40, "{rows}");
    screen.focus_on(CustomersPane::Weeks);
    let title = |screen: &Customers| screen.figure(&look).expect("a figure").title;
    act(&mut screen, Action::First, &company);
    act(&mut screen, Action::Left, &company);
    assert_eq!(title(&screen), "leads of S1 in week 7");
    let text = drawn(&screen, &company, 200, 57);
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
fn all_columns_are_there_and_a_mark_says_where() {
    let (_, company, mut screen) = on_screen::<Customers>(3);
    let wide = drawn(&screen, &company, 250, 57);
    for head in ["of market", "level", "ad $/new", "per seat", "churn 30d", "name", "dev/day"] {
        assert!(wide.contains(head), "{head} in\n{wide}");
    }
    let narrow = drawn(&screen, &company, 80, 21);
    assert!(narrow.contains('›') && !narrow.contains("dev/day"), "{narrow}");
    for _ in 0..14 {
        act(&mut screen, Action::Right, &company);
    }
    let moved = drawn(&screen, &company, 80, 21);
    assert!(moved.contains("dev/day") && moved.contains("group") && moved.contains('‹'), "{moved}");
}

#[test]
fn the_small_window_shows_groups_and_channels() {
    let (_, company, screen) = on_screen::<Customers>(3);
    let text = drawn(&screen, &company, 80, 21);
    for words in ["group", "E3", "referral_program", "Leads per $1,000", "content_marketing"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}
