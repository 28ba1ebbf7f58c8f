use super::*;
use crate::context::ScreenId;
use crate::effect::Effect;
use crate::screens::Screen;
use crate::test_kit::{handle_action, only_question, session_with_negotiations, screen_text, played_screen, played_session, loaded_screen};
use news::NewsKind;
use novamind_base::formatting::{dollars, short_dollars};
use novamind_database::Cell as Value;
use novamind_record::trajectory::record::Via;
use novamind_report::action_items::{ActionTarget, Problem};
use novamind_session::Session;
use novamind_worker::page_questions::PreviewCallQuestion;

fn sum_column(session: &mut Session, sql: &str, column: &str) -> f64 {
    let rows = session.query(&format!("SELECT {column} FROM ({sql})")).expect("an answer");
    match rows.rows[0][0] {
        Value::Integer(number) => number as f64,
        Value::Real(number) => number,
        _ => 0.0,
    }
}

#[test]
fn week_figures_equal_their_rows() {
    let mut session = played_session(7);
    let company = DisplayedCompany::from_session(&session);
    let week = company.observation.last_week.expect("a week");
    let before = company.weeks[company.weeks.len() - 2];
    for (name, column) in [
        ("cash at week's end", "sum(amount)"),
        ("recurring revenue", "sum(amount)"),
        ("payments", "sum(amount)"),
        ("running costs", "-sum(amount)"),
        ("subscribers", "count(*)"),
        ("individual leads", "count(*)"),
        ("new subscribers", "count(*)"),
        ("cancellations", "count(*)"),
        ("seats", "coalesce(sum(seat_count), 0)"),
        ("enterprise leads", "count(*)"),
        ("new seats", "coalesce(sum(seat_count), 0)"),
        ("usage, units", "sum(total_usage_units)"),
        ("overload, peak", "max(overload)"),
        ("outage, minutes", "sum(downtime_minutes)"),
        ("latency, peak ms", "max(p95_ms)"),
        ("error rate, peak", "max(error_rate)"),
    ] {
        let metric = METRICS.iter().find(|metric| metric.name == name).expect("a figure");
        for (place, figures) in [(1, &week), (4, &before)] {
            let Some(sql) = figures::figure(metric, place, &company).sql else {
                assert!(place == 4, "{name}");
                continue;
            };
            let (shown, made) = ((metric.read)(figures), sum_column(&mut session, &sql, column));
            assert!(
                (shown - made).abs() < 0.02,
                "{name} in column {place}: {shown}, rows make {made}: {sql}"
            );
        }
    }
}

#[test]
fn selected_figure_title_has_name_and_weeks() {
    let (mut session, company, mut screen) = played_screen::<Overview>(6);
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    screen.set_focused_pane(OverviewPane::Week);
    let title = |screen: &Overview| screen.figure(&context).expect("a figure").title;
    assert_eq!(title(&screen), "cash at week's end, week 6");
    for _ in 0..4 {
        handle_action(&mut screen, Action::Right, &company);
    }
    handle_action(&mut screen, Action::Down, &company);
    assert_eq!(title(&screen), "recurring revenue, weeks 3 to 6");
    screen.set_focused_pane(OverviewPane::Quality);
    assert_eq!(title(&screen), "delivered quality of E1 on plan A");
    screen.set_focused_pane(OverviewPane::Cash);
    assert_eq!(title(&screen), "cash at week's end, week 6");
    for pane in 0..Screen::pane_count(&screen) {
        screen.set_focus(pane);
        for _ in 0..METRICS.len() {
            if let Some(sql) = screen.figure(&context).and_then(|figure| figure.sql) {
                session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
            }
            handle_action(&mut screen, Action::Down, &company);
        }
    }
}

#[test]
fn figures_state_what_they_include() {
    let (_, company, mut screen) = played_screen::<Overview>(6);
    let title = |name: &str| {
        let metric = METRICS.iter().find(|metric| metric.name == name).expect("a figure");
        figures::figure(metric, 1, &company).title
    };
    assert_eq!(title("running costs"), "running costs (no lead costs or purchases), week 6");
    assert_eq!(title("enterprise leads"), "offer requests (by ads and word of mouth), week 6");
    let note = "week 6 · no lead costs or purchases";
    assert!(!screen_text(&screen, &company, 120, 37).contains(note));
    screen.set_focused_pane(OverviewPane::Week);
    let row = METRICS.iter().position(|metric| metric.name == "running costs").expect("a row");
    (0..row).for_each(|_| drop(handle_action(&mut screen, Action::Down, &company)));
    // Narrower panes have no room for the note. There, the title of the figure states what it includes.
    for (width, height) in [(120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        assert!(text.contains(note), "{text}");
    }
    assert!(screen_text(&screen, &company, 120, 37).contains("offer requests"));
}

#[test]
fn cash_after_a_purchase_is_shown_next_to_the_cash_of_the_week() {
    let mut session = played_session(3);
    let ended = session.company().observe().cash;
    let study = serde_json::json!({"group_id": "S1", "target_level": 2});
    session.call("research_group", &study, Via::Form).expect("a study");
    let company = DisplayedCompany::from_session(&session);
    let now = company.observation.cash;
    assert_eq!(novamind_report::cash_before_purchases(&company.observation), Some(ended));
    let screen: Overview = loaded_screen(&mut session, &company);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        assert!(text.contains(&format!("{} now", dollars(now))), "{text}");
    }
    let text = screen_text(&screen, &company, 200, 57);
    assert!(text.contains(&format!("now · {} ", short_dollars(ended))) && text.contains("at week's end"), "{text}");
}

#[test]
fn every_action_item_opens_its_object_and_has_source_rows() {
    let mut session = session_with_negotiations();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Overview = loaded_screen(&mut session, &company);
    assert!(company.action_items.iter().any(|need| need.problem == Problem::Threads), "{:#?}", company.action_items);
    for need in &company.action_items {
        let effects = handle_action(&mut screen, Action::Open, &company);
        match (&need.target, &effects[..]) {
            (ActionTarget::Call(tool, _), [Effect::Prefill { tool: tool_id, .. }]) => assert_eq!(tool, tool_id),
            (ActionTarget::Thread(number), [Effect::ShowThread(shown)]) => assert_eq!(number, shown),
            (ActionTarget::Group(group), [Effect::ShowGroup(ScreenId::Customers, shown)]) => {
                assert_eq!(group, shown)
            }
            (ActionTarget::Ledger, [Effect::Show(ScreenId::Cash)]) => {}
            other => panic!("{other:?}"),
        }
        if let Some(sql) = action_items::item_figure(need, company.observation.day).sql {
            session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
        }
        handle_action(&mut screen, Action::Down, &company);
    }
}

#[test]
fn every_selection_has_a_term_or_tool() {
    let company = DisplayedCompany::from_session(&played_session(7));
    let day = company.observation.day;
    let needs = company.action_items.iter().map(|need| action_items::item_figure(need, day).term);
    let metrics = METRICS.iter().map(|metric| metric.term);
    let kinds = [NewsKind::Research, NewsKind::Study, NewsKind::Economy, NewsKind::Posts, NewsKind::Press];
    let news = kinds.map(|kind| news::NewsItem { kind, text: String::new() }.figure(day).term);
    for term in needs.chain(metrics).chain(news) {
        let kind = novamind_glossary::subject_by_name(term).map(|subject| subject.kind());
        assert!(matches!(kind, Some("term" | "tool")), "{term}: {kind:?}");
    }
}

#[test]
fn waiting_threads_item_queries_the_waiting_threads() {
    let mut session = session_with_negotiations();
    let company = DisplayedCompany::from_session(&session);
    let need = company.action_items.iter().find(|need| need.problem == Problem::Threads).expect("threads wait");
    let sql = action_items::item_figure(need, company.observation.day).sql.expect("rows");
    let open = sum_column(&mut session, &sql, "count(*)");
    assert_eq!(open, company.observation.waiting.len() as f64);
}

#[test]
fn proposed_call_fills_the_form() {
    let mut session = played_session(0);
    let company = DisplayedCompany::from_session(&session);
    let need = &company.action_items[0];
    assert_eq!(need.problem, Problem::NoPrice);
    let Effect::Prefill { tool, arguments } = action_items::item_effect(need) else { panic!("{need:?}") };
    let mut tools = crate::screens::tools::Tools::default();
    let effects = tools.prefill(tool, &arguments, &company);
    let checked = only_question::<PreviewCallQuestion>(&effects);
    assert_eq!((checked.tool, &checked.arguments), (tool, &arguments));
    session
        .call(tool, &arguments, novamind_record::trajectory::record::Via::Form)
        .expect("the proposal is accepted");
}

#[test]
fn action_items_are_not_truncated_if_they_fit() {
    let (_, company, screen) = played_screen::<Overview>(0);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        let last = company.action_items[0].text.split_whitespace().next_back().expect("a word");
        assert!(text.contains(last), "{last} in\n{text}");
        for words in ["This week", "Action needed", "Cash", "individual leads", "→ Tools"] {
            assert!(text.contains(words), "{words} in\n{text}");
        }
    }
    let (_, company, screen) = played_screen::<Overview>(9);
    let large = screen_text(&screen, &company, 200, 57);
    for words in
        ["Usage and capacity", "4-wk mean", "Delivered quality", "expected", "95 %", "New this week"]
    {
        assert!(large.contains(words), "{words} in\n{large}");
    }
}

#[test]
fn first_week_cash_change_matches_the_header() {
    let company = DisplayedCompany::from_session(&played_session(1));
    let row = figures::metric_row(&METRICS[0], &company);
    assert_eq!(METRICS[0].name, "cash at week's end");
    let change = row[2].number.expect("a change");
    assert!((change - company.observation.cash_change).abs() < 0.01, "{row:?}");
    assert_eq!(row[4].number, Some(company.observation.starting_cash), "{row:?}");
}

#[test]
fn post_counts_are_compared_with_existing_weeks() {
    for (weeks, words) in
        [(1, ""), (2, "the week before"), (3, "two-week average"), (6, "four-week average")]
    {
        let company = DisplayedCompany::from_session(&played_session(weeks));
        let by_people = |post: &&std::sync::Arc<novamind_worker::posts::Post>| {
            post.kind != novamind_worker::posts::PostKind::Press
        };
        let of = |week: u32| {
            company.posts.iter().filter(by_people).filter(|post| post.day.div_ceil(7) == week).count()
        };
        let last = weeks as u32;
        let before: Vec<f64> = (last.saturating_sub(4).max(1)..last).map(|week| of(week) as f64).collect();
        let usual =
            novamind_base::formatting::grouped_number(before.iter().sum::<f64>() / before.len().max(1) as f64, 0);
        let news_item =
            news::post_items(&company).into_iter().find(|item| item.kind == NewsKind::Posts).expect("posts");
        assert!(news_item.text.starts_with(&format!("{} new post", of(last))), "{}", news_item.text);
        let compared = news_item.text.split_once('(').map_or("", |(_, compared)| compared);
        assert!(
            compared.contains(words) && (before.is_empty() || compared.contains(&usual)),
            "{}: {usual}",
            news_item.text
        );
    }
}
