use super::model::*;
use super::*;
use crate::console::test_kit::{act, drawn, played, shown, sweep};
use crate::session::Cell as Value;
use crate::world::identifiers::Channel;

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

#[test]
fn the_groups_agree_with_the_figures_of_the_week() {
    let mut session = played(6);
    let company = Company::of(&session);
    let screen: Customers = shown(&mut session, &company);
    let sum = |figure: &dyn Fn(&Facts) -> f64, enterprise: bool| {
        let groups = company.seen.known_groups.iter().filter(|group| group.is_enterprise() == enterprise);
        groups.map(|group| figure(&screen.market.of(*group))).sum::<f64>()
    };
    let week = company.seen.last_week.expect("a week");
    let now = |figure: fn(&Flow) -> f64| move |facts: &Facts| figure(&facts.week(6));
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
    let mut market = Market::default();
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
    let mut session = played(2);
    let company = Company::of(&session);
    let mut screen: Customers = shown(&mut session, &company);
    act(&mut screen, Action::Down, &company);
    act(&mut screen, Action::Open, &company);
    assert_eq!((screen.open, screen.panes()), (Some(1), 1));
    let text = drawn(&screen, &company, 80, 21);
    assert!(text.contains("S2 · individual") && text.contains("set_targeted_dev_spend"), "{text}");
    act(&mut screen, Action::Down, &company);
    let effects = act(&mut screen, Action::Open, &company);
    assert!(matches!(effects[..], [Effect::ShowTool("set_targeted_dev_spend")]), "{effects:?}");
    act(&mut screen, Action::Last, &company);
    let Some(Effect::EditSql(sql)) = act(&mut screen, Action::Open, &company).pop() else {
        panic!("no query")
    };
    session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
    act(&mut screen, Action::Up, &company);
    let effects = act(&mut screen, Action::Open, &company);
    assert!(
        matches!(effects[..], [Effect::ShowGroup(crate::console::screens::ScreenId::Market, group)]
        if group.id() == "S2"),
        "{effects:?}"
    );
    screen.show(group("E1"), &company);
    assert_eq!(screen.open.map(|open| company.seen.known_groups[open].id()), Some("E1"));
    screen.show(group("S2"), &company);
    for tool in group::TOOLS {
        assert!(crate::tools::CATALOGUE.iter().any(|own| own.spec().name == tool.0), "{}", tool.0);
    }
    for _ in 0..40 {
        act(&mut screen, Action::Right, &company);
    }
    assert_eq!(screen.open, Some(company.seen.known_groups.len() - 1));
    sweep(&mut screen, &company);
    act(&mut screen, Action::Close, &company);
    assert_eq!(screen.open, None);
}

#[test]
fn it_is_drawn_in_every_window_with_and_without_data() {
    for weeks in [0, 1, 5] {
        let mut session = played(weeks);
        let company = Company::of(&session);
        sweep(&mut Customers::default(), &company);
        sweep(&mut shown::<Customers>(&mut session, &company), &company);
    }
}

#[test]
fn the_small_window_shows_groups_and_channels() {
    let mut session = played(3);
    let company = Company::of(&session);
    let screen: Customers = shown(&mut session, &company);
    let text = drawn(&screen, &company, 80, 21);
    for words in ["group", "E3", "referral_program", "Leads per $1,000", "content_marketing"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}
