use super::*;
use crate::context::ScreenId;
use crate::effect::Effect;
use crate::screens::Screen;
use crate::test_kit::{act, asked, courted, drawn, on_screen, played, shown};
use news::NewsKind;
use novamind_database::Cell as Value;
use novamind_report::needs::{Place, Problem};
use novamind_session::Session;
use novamind_worker::questions::CallCheck;

fn sum_of(session: &mut Session, sql: &str, column: &str) -> f64 {
    let rows = session.query(&format!("SELECT {column} FROM ({sql})")).expect("an answer");
    match rows.rows[0][0] {
        Value::Integer(number) => number as f64,
        Value::Real(number) => number,
        _ => 0.0,
    }
}

#[test]
fn every_figure_of_the_week_is_made_of_its_rows() {
    let mut session = played(7);
    let company = Company::of(&session);
    let week = company.seen.last_week.expect("a week");
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
            let (shown, made) = ((metric.read)(figures), sum_of(&mut session, &sql, column));
            assert!(
                (shown - made).abs() < 0.02,
                "{name} in column {place}: {shown}, rows make {made}: {sql}"
            );
        }
    }
}

#[test]
fn the_selected_figure_names_figure_and_weeks() {
    let (mut session, company, mut screen) = on_screen::<Overview>(6);
    let keys = crate::keys::Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 5 };
    screen.focus_on(OverviewPane::Week);
    let title = |screen: &Overview| screen.figure(&look).expect("a figure").title;
    assert_eq!(title(&screen), "cash at week's end, week 6");
    for _ in 0..4 {
        act(&mut screen, Action::Right, &company);
    }
    act(&mut screen, Action::Down, &company);
    assert_eq!(title(&screen), "recurring revenue, weeks 3 to 6");
    screen.focus_on(OverviewPane::Quality);
    assert_eq!(title(&screen), "delivered quality of E1 on plan A");
    screen.focus_on(OverviewPane::Cash);
    assert_eq!(title(&screen), "cash at week's end, week 6");
    for pane in 0..Screen::panes(&screen) {
        screen.set_focus(pane);
        for _ in 0..METRICS.len() {
            if let Some(sql) = screen.figure(&look).and_then(|figure| figure.sql) {
                session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
            }
            act(&mut screen, Action::Down, &company);
        }
    }
}

#[test]
fn every_need_leads_to_its_object_and_names_its_rows() {
    let mut session = courted();
    let company = Company::of(&session);
    let mut screen: Overview = shown(&mut session, &company);
    assert!(company.needs.iter().any(|need| need.problem == Problem::Threads), "{:#?}", company.needs);
    for need in &company.needs {
        let effects = act(&mut screen, Action::Open, &company);
        match (&need.place, &effects[..]) {
            (Place::Call(tool, _), [Effect::Prefill { tool: shown, .. }]) => assert_eq!(tool, shown),
            (Place::Thread(number), [Effect::ShowThread(shown)]) => assert_eq!(number, shown),
            (Place::Group(group), [Effect::ShowGroup(ScreenId::Customers, shown)]) => {
                assert_eq!(group, shown)
            }
            (Place::Books, [Effect::Show(ScreenId::Cash)]) => {}
            other => panic!("{other:?}"),
        }
        if let Some(sql) = needs::figure_of(need, company.seen.day).sql {
            session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
        }
        act(&mut screen, Action::Down, &company);
    }
}

#[test]
fn what_is_selected_is_explained_by_a_term_or_a_tool() {
    let company = Company::of(&played(7));
    let day = company.seen.day;
    let needs = company.needs.iter().map(|need| needs::figure_of(need, day).term);
    let metrics = METRICS.iter().map(|metric| metric.term);
    let kinds = [NewsKind::Research, NewsKind::Study, NewsKind::Economy, NewsKind::Posts, NewsKind::Press];
    let news = kinds.map(|kind| news::NewsItem { kind, text: String::new() }.figure(day).term);
    for term in needs.chain(metrics).chain(news) {
        let kind = novamind_glossary::subject(term).map(|subject| subject.kind());
        assert!(matches!(kind, Some("term" | "tool")), "{term}: {kind:?}");
    }
}

#[test]
fn the_waiting_threads_are_the_rows_of_their_need() {
    let mut session = courted();
    let company = Company::of(&session);
    let need = company.needs.iter().find(|need| need.problem == Problem::Threads).expect("threads wait");
    let sql = needs::figure_of(need, company.seen.day).sql.expect("rows");
    let open = sum_of(&mut session, &sql, "count(*)");
    assert_eq!(open, company.seen.waiting.len() as f64);
}

#[test]
fn a_proposed_call_is_typed_into_its_form_and_can_be_sent() {
    let mut session = played(0);
    let company = Company::of(&session);
    let need = &company.needs[0];
    assert_eq!(need.problem, Problem::NoPrice);
    let Effect::Prefill { tool, arguments } = needs::way_of(need) else { panic!("{need:?}") };
    let mut tools = crate::screens::tools::Tools::default();
    let effects = tools.prefill(tool, &arguments, &company);
    let checked = asked::<CallCheck>(&effects);
    assert_eq!((checked.tool, &checked.arguments), (tool, &arguments));
    session
        .call(tool, &arguments, novamind_record::trajectory::record::Via::Form)
        .expect("the proposal is accepted");
}

#[test]
fn no_word_of_a_need_is_cut_while_there_is_room() {
    let (_, company, screen) = on_screen::<Overview>(0);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = drawn(&screen, &company, width, height);
        let last = company.needs[0].text.split_whitespace().next_back().expect("a word");
        assert!(text.contains(last), "{last} in\n{text}");
        for words in ["This week", "Action needed", "Cash", "individual leads", "→ Tools"] {
            assert!(text.contains(words), "{words} in\n{text}");
        }
    }
    let (_, company, screen) = on_screen::<Overview>(9);
    let large = drawn(&screen, &company, 200, 57);
    for words in
        ["Usage against capacity", "4-wk mean", "Delivered quality", "expected", "95 %", "New this week"]
    {
        assert!(large.contains(words), "{words} in\n{large}");
    }
}

#[test]
fn cash_changes_in_the_first_week_as_the_header_says() {
    let company = Company::of(&played(1));
    let row = figures::row_of(&METRICS[0], &company);
    assert_eq!(METRICS[0].name, "cash at week's end");
    let change = row[2].number.expect("a change");
    assert!((change - company.seen.cash_change).abs() < 0.01, "{row:?}");
    assert_eq!(row[4].number, Some(company.seen.starting_cash), "{row:?}");
}

#[test]
fn posts_are_compared_with_the_weeks_there_were() {
    for (weeks, words) in
        [(1, ""), (2, "the week before"), (3, "on average in the 2 weeks before"), (6, "four-week average")]
    {
        let company = Company::of(&played(weeks));
        let by_people = |post: &&std::sync::Arc<novamind_worker::posts::Post>| {
            post.kind != novamind_worker::posts::PostKind::Press
        };
        let of = |week: u32| {
            company.posts.iter().filter(by_people).filter(|post| post.day.div_ceil(7) == week).count()
        };
        let last = weeks as u32;
        let before: Vec<f64> = (last.saturating_sub(4).max(1)..last).map(|week| of(week) as f64).collect();
        let usual =
            novamind_base::notation::grouped(before.iter().sum::<f64>() / before.len().max(1) as f64, 0);
        let told =
            news::of_posts(&company).into_iter().find(|item| item.kind == NewsKind::Posts).expect("posts");
        assert!(told.text.starts_with(&format!("{} new post", of(last))), "{}", told.text);
        let compared = told.text.split_once('(').map_or("", |(_, compared)| compared);
        assert!(
            compared.contains(words) && (before.is_empty() || compared.contains(&usual)),
            "{}: {usual}",
            told.text
        );
    }
}
