use std::sync::Arc;

use super::*;
use crate::keys::Keys;
use crate::screens::Screen;
use crate::test_kit::{act, asked, drawn, on_screen, played, shown};
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use novamind_worker::posts::PostKind;

fn with_look<T>(company: &Company, work: impl FnOnce(&Look<'_>) -> T) -> T {
    let keys = Keys::shipped();
    work(&Look { company, keys: &keys, page: 5 })
}

/// Confirms an order: check, confirmation, tool call, message.
fn order(screen: &mut Market, session: &mut Session, action: Action) -> (String, Vec<Effect>) {
    let company = Company::of(session);
    let effects = act(screen, action, &company);
    let CallCheck { tool, arguments } = asked(&effects);
    screen.asking.put(session.check(*tool, arguments));
    let effects = with_look(&company, |look| screen.take_answers(look));
    let [Effect::ConfirmCall { tool, arguments, text }] = &effects[..] else { panic!("{effects:?}") };
    let answer = session.call(tool, arguments, Via::Form);
    let company = Company::of(session);
    let called = News::Called(*tool, answer.map(Box::new), Arc::new(company.clone()));
    let said = with_look(&company, |look| {
        screen.renew(look);
        screen.hear(&called, look)
    });
    (text.clone(), said)
}

fn week(session: &mut Session) {
    let forecasts = session.company().naive_forecasts();
    session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
}

#[test]
fn a_study_is_chosen_asked_for_and_shown_until_it_is_done() {
    let (mut session, company, mut screen) = on_screen::<Market>(1);
    act(&mut screen, Action::LevelUp, &company);
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("to level 3: $175,000, 5 days, then ±25%"), "{text}");
    act(&mut screen, Action::LevelDown, &company);
    act(&mut screen, Action::LevelDown, &company);
    let (question, said) = order(&mut screen, &mut session, Action::StudyGroup);
    for part in ["A study of S1 to level 2.", "$60,000", "day 10", "cannot be undone"] {
        assert!(question.contains(part), "{part} in {question}");
    }
    assert!(matches!(&said[..], [Effect::Say(text)] if text.contains("day 10")), "{said:?}");
    let company = Company::of(&session);
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("→2 due day 10") && text.contains("study to level 2 due on day 10"), "{text}");
    week(&mut session);
    let company = Company::of(&session);
    let screen: Market = shown(&mut session, &company);
    let text = drawn(&screen, &company, 200, 57);
    assert!(text.contains("level 2 · ±40%") && text.contains("day 10"), "{text}");
}

#[test]
fn attempts_find_groups_and_are_listed() {
    let (mut session, company, mut screen) = on_screen::<Market>(0);
    assert!(drawn(&screen, &company, 120, 37).contains("No attempts yet. Pay for one with m."));
    let mut found = None;
    for _ in 0..25 {
        let (question, said) = order(&mut screen, &mut session, Action::FindGroup);
        assert!(
            question.contains("30 % chance to find") && question.contains("$25,000 at once"),
            "{question}"
        );
        let [Effect::Say(text)] = &said[..] else { panic!("{said:?}") };
        if text.contains("Found ") {
            found = screen.group();
            break;
        }
    }
    let group = found.expect("a group within 25 attempts");
    let company = Company::of(&session);
    assert!(company.seen.known_groups.contains(&group));
    let mut screen: Market = shown(&mut session, &company);
    assert_eq!(screen.facts.found(), 1);
    screen.show(group);
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("7 known · 19 to find") && text.contains(&format!("{group} · ")), "{text}");
    screen.focus_on(MarketPane::Attempts);
    assert!(drawn(&screen, &company, 80, 21).contains("1 of "));
}

#[test]
fn the_report_tells_estimates_and_what_the_truth_can_be() {
    let session = played(1);
    let company = Company::of(&session);
    for group in &company.seen.known_groups {
        let lines = report::lines(&company, *group);
        let text = format!("{lines:?}");
        for words in ["budget", "usage", "required quality", "market", "lock-in aversion", "word of mouth"] {
            assert!(text.contains(words), "{group} {words}: {text}");
        }
        assert_eq!(text.contains("smallest enterprise"), group.is_enterprise());
        // The budget range agrees with other screens, including rounding.
        let budget = company.fit(*group).expect("a known group").budget.money().replace('$', "");
        assert!(text.contains(&budget), "{group} {budget}: {text}");
    }
}

#[test]
fn a_group_leads_to_its_customers_and_unknown_ones_are_explained() {
    let (_, company, mut screen) = on_screen::<Market>(1);
    let group = company.seen.known_groups[2];
    screen.focus_on(MarketPane::News);
    screen.show(group);
    let effects = act(&mut screen, Action::Open, &company);
    assert!(
        matches!(effects[..], [Effect::ShowGroup(ScreenId::Customers, own)] if own == group),
        "{effects:?}"
    );
    act(&mut screen, Action::Last, &company);
    let effects = act(&mut screen, Action::Open, &company);
    assert!(
        matches!(&effects[..], [Effect::Complain(text)] if text.contains("not been found yet")),
        "{effects:?}"
    );
    let effects = act(&mut screen, Action::StudyGroup, &company);
    assert!(matches!(&effects[..], [Effect::Complain(_)]), "{effects:?}");
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("30 % of attempts"), "{text}");
}

#[test]
fn the_economy_is_shown_with_its_lag() {
    let (_, company, screen) = on_screen::<Market>(0);
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("published on day 31, 30"), "{text}");
    let (_, company, mut screen) = on_screen::<Market>(10);
    assert_eq!(screen.facts.economy.len(), 2);
    for (width, height) in [(120, 37), (200, 57)] {
        let text = drawn(&screen, &company, width, height);
        for words in ["PMI ", "measured on day 31, published on day 61; next on day 91", "day 70"] {
            assert!(text.contains(words), "{width}×{height} {words} in\n{text}");
        }
    }
    screen.focus_on(MarketPane::Attempts);
    assert!(drawn(&screen, &company, 80, 21).contains("PMI "));
    assert!(!screen.news.is_empty() && screen.news.iter().all(|item| item.post.kind == PostKind::Press));
    screen.focus_on(MarketPane::News);
    let effects = act(&mut screen, Action::Open, &company);
    assert!(matches!(&effects[..], [Effect::ShowText(title, _)] if title.contains("press")), "{effects:?}");
}

#[test]
fn the_small_window_shows_groups_and_report() {
    let (_, company, mut screen) = on_screen::<Market>(2);
    let text = drawn(&screen, &company, 80, 21);
    for words in
        ["6 known · 20 to find", "next study", "→2 $60.0k 3d ±40%", "level 1 · ±65%", "budget", "r study"]
    {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    screen.focus_on(MarketPane::Report);
    act(&mut screen, Action::Last, &company);
    assert!(screen.from > 0);
    act(&mut screen, Action::Close, &company);
    assert_eq!((screen.focus, screen.from), (MarketPane::Groups, 0));
}

#[test]
fn what_is_not_told_yet_is_shaded_and_rivals_are_marked_by_day() {
    let (mut session, company, mut screen) = on_screen::<Market>(12);
    let rivals = screen.news.iter().filter(|item| item.rival.is_some()).count();
    assert!(rivals > 0 && rivals < screen.news.len(), "{rivals} of {}", screen.news.len());
    screen.focus_on(MarketPane::Economy);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = drawn(&screen, &company, width, height);
        for words in [
            "░░",
            "publ",
            "◆",
            "news",
            "◆ published",
            "measured on day 31, published on day 61; next on day 91",
        ] {
            assert!(text.contains(words), "{width}×{height} {words} in\n{text}");
        }
        let lane = text.lines().find(|line| line.contains("┃news")).expect("a lane").to_owned();
        assert!(lane.contains('█'), "{lane}");
    }
    act(&mut screen, Action::Left, &company);
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("measured on day 1, published on day 31"), "{text}");
    let keys = Keys::shipped();
    let look = Look { company: &company, keys: &keys, page: 5 };
    let figure = screen.figure(&look).expect("a figure");
    assert_eq!(figure.title, "PMI of day 1");
    let rows = session.query(&figure.sql.expect("rows")).expect("rows").rows;
    assert_eq!(novamind_database::number_at(&rows[0], 1), screen.facts.economy[0].value);
    for focus in 0..Screen::panes(&screen) {
        screen.set_focus(focus);
        if let Some(figure) = screen.figure(&look) {
            session
                .query(&figure.sql.expect("rows"))
                .unwrap_or_else(|refusal| panic!("{}: {refusal}", figure.title));
        }
    }
}
