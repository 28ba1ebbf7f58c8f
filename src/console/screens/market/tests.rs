use std::sync::Arc;

use super::*;
use crate::keys::KeyBindings;
use crate::screens::Screen;
use crate::test_kit::{handle_action, only_question, screen_text, zoomed_text, played_screen, played_session, loaded_screen};
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use novamind_worker::posts::PostKind;

fn with_context<T>(company: &DisplayedCompany, work: impl FnOnce(&ScreenContext<'_>) -> T) -> T {
    let keys = KeyBindings::bundled();
    work(&ScreenContext { company, keys: &keys, page_rows: 5 })
}

/// Orders a purchase: handles the action, the check, the confirmation and the tool call.
fn confirm_and_call(screen: &mut Market, session: &mut Session, action: Action) -> (String, Vec<Effect>) {
    let company = DisplayedCompany::from_session(session);
    let effects = handle_action(screen, action, &company);
    let PreviewCallQuestion { tool, arguments } = only_question(&effects);
    screen.pending_call.set_answer(session.preview_call(*tool, arguments));
    let effects = with_context(&company, |context| screen.take_answers(context));
    let [Effect::ConfirmCall { tool, arguments, text }] = &effects[..] else { panic!("{effects:?}") };
    let answer = session.call(tool, arguments, Via::Form);
    let company = DisplayedCompany::from_session(session);
    let called = Response::ToolCalled(*tool, answer.map(Box::new), Arc::new(company.clone()));
    let effects = with_context(&company, |screen_context| {
        screen.on_company_change(screen_context);
        screen.handle_response(&called, screen_context)
    });
    (text.clone(), effects)
}

fn advance_week(session: &mut Session) {
    let forecasts = session.company().naive_forecasts();
    session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
}

#[test]
fn study_is_confirmed_ordered_and_shown_while_running() {
    let (mut session, company, mut screen) = played_screen::<Market>(1);
    handle_action(&mut screen, Action::LevelUp, &company);
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("to level 3: $175,000, 5 days, then noise ±25%"), "{text}");
    handle_action(&mut screen, Action::LevelDown, &company);
    handle_action(&mut screen, Action::LevelDown, &company);
    let (question, effects) = confirm_and_call(&mut screen, &mut session, Action::StudyGroup);
    for part in ["A study of S1 to level 2.", "$60,000", "day 10", "cannot be undone"] {
        assert!(question.contains(part), "{part} in {question}");
    }
    assert!(matches!(&effects[..], [Effect::ShowStatus(text)] if text.contains("day 10")), "{effects:?}");
    let company = DisplayedCompany::from_session(&session);
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("→2 due day 10") && text.contains("study to level 2 due on day 10"), "{text}");
    advance_week(&mut session);
    let company = DisplayedCompany::from_session(&session);
    let screen: Market = loaded_screen(&mut session, &company);
    let text = screen_text(&screen, &company, 200, 57);
    assert!(text.contains("level 2 · noise ±40%") && text.contains("day 10"), "{text}");
}

#[test]
fn research_attempts_are_listed() {
    let (mut session, company, mut screen) = played_screen::<Market>(0);
    assert!(screen_text(&screen, &company, 120, 37).contains("No attempts yet. Pay for one with m."));
    let mut found = None;
    for _ in 0..25 {
        let (question, effects) = confirm_and_call(&mut screen, &mut session, Action::FindGroup);
        assert!(
            question.contains("30 % chance to find") && question.contains("$25,000 at once"),
            "{question}"
        );
        let [Effect::ShowStatus(text)] = &effects[..] else { panic!("{effects:?}") };
        if text.contains("Found ") {
            found = screen.group();
            break;
        }
    }
    let group = found.expect("a group within 25 attempts");
    let company = DisplayedCompany::from_session(&session);
    assert!(company.observation.known_groups.contains(&group));
    let mut screen: Market = loaded_screen(&mut session, &company);
    assert_eq!(screen.facts.found_count(), 1);
    screen.show_group(group);
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("7 known · 19 to find") && text.contains(&format!("{group} · ")), "{text}");
    screen.set_focused_pane(MarketPane::Attempts);
    assert!(screen_text(&screen, &company, 80, 21).contains("1 of "));
}

#[test]
fn report_shows_estimates_with_ranges() {
    let session = played_session(1);
    let company = DisplayedCompany::from_session(&session);
    for group in &company.observation.known_groups {
        let lines = report::report_lines(&company, *group);
        let text = format!("{lines:?}");
        for words in ["budget", "usage", "required quality", "market", "lock-in aversion", "word of mouth"] {
            assert!(text.contains(words), "{group} {words}: {text}");
        }
        assert_eq!(text.contains("smallest enterprise"), group.is_enterprise());
        // The budget range is the same as on other screens, including rounding.
        let budget = company.fit(*group).expect("a known group").budget.format_money().replace('$', "");
        assert!(text.contains(&budget), "{group} {budget}: {text}");
    }
}

#[test]
fn only_known_groups_open_the_customers_screen() {
    let (_, company, mut screen) = played_screen::<Market>(1);
    let group = company.observation.known_groups[2];
    screen.set_focused_pane(MarketPane::News);
    screen.show_group(group);
    let effects = handle_action(&mut screen, Action::Open, &company);
    assert!(
        matches!(effects[..], [Effect::ShowGroup(ScreenId::Customers, shown_group)] if shown_group == group),
        "{effects:?}"
    );
    handle_action(&mut screen, Action::Last, &company);
    let effects = handle_action(&mut screen, Action::Open, &company);
    assert!(
        matches!(&effects[..], [Effect::ShowError(text)] if text.contains("not been found yet")),
        "{effects:?}"
    );
    let effects = handle_action(&mut screen, Action::StudyGroup, &company);
    assert!(matches!(&effects[..], [Effect::ShowError(_)]), "{effects:?}");
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("30 % of attempts"), "{text}");
}

#[test]
fn economy_is_shown_with_its_publication_lag() {
    let (_, company, screen) = played_screen::<Market>(0);
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("published on day 31, 30"), "{text}");
    let (_, company, mut screen) = played_screen::<Market>(10);
    assert_eq!(screen.facts.economy.len(), 2);
    for (width, height) in [(120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        for words in ["PMI ", "measured on day 31, published on day 61; next on day 91", "day 70"] {
            assert!(text.contains(words), "{width}×{height} {words} in\n{text}");
        }
    }
    screen.set_focused_pane(MarketPane::Economy);
    assert!(screen_text(&screen, &company, 80, 21).contains("PMI "));
    assert!(!screen.news.is_empty() && screen.news.iter().all(|item| item.post.kind == PostKind::Press));
    screen.set_focused_pane(MarketPane::News);
    let effects = handle_action(&mut screen, Action::Open, &company);
    assert!(matches!(&effects[..], [Effect::ShowText(title, _)] if title.contains("press")), "{effects:?}");
}

#[test]
fn small_window_shows_groups_and_report() {
    let (_, company, mut screen) = played_screen::<Market>(2);
    let text = screen_text(&screen, &company, 80, 21);
    for words in
        ["6 known · 20 to find", "next study", "→2 $60.0k 3d ±40%", "level 1 · noise ±65%", "budget", "r study"]
    {
        assert!(text.contains(words), "{words} in\n{text}");
    }
    screen.set_focused_pane(MarketPane::Report);
    let text = screen_text(&screen, &company, 80, 21);
    handle_action(&mut screen, Action::Last, &company);
    assert_ne!(screen_text(&screen, &company, 80, 21), text);
    handle_action(&mut screen, Action::Close, &company);
    assert_eq!((screen.focus, &screen.report_scroll), (MarketPane::Groups, &ScrollState::default()));
}

#[test]
fn economy_chart_marks_unpublished_days_and_competitor_news() {
    let (mut session, company, mut screen) = played_screen::<Market>(12);
    let rivals = screen.news.iter().filter(|item| item.competitor.is_some()).count();
    assert!(rivals > 0 && rivals < screen.news.len(), "{rivals} of {}", screen.news.len());
    screen.set_focused_pane(MarketPane::Economy);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        // In a small window, the pane has space for news only when it is enlarged.
        let text = match height {
            21 => zoomed_text(&screen, &company, width, height),
            _ => screen_text(&screen, &company, width, height),
        };
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
    handle_action(&mut screen, Action::Left, &company);
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("measured on day 1, published on day 31"), "{text}");
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    let figure = screen.figure(&context).expect("a figure");
    assert_eq!(figure.title, "PMI of day 1");
    let rows = session.query(&figure.sql.expect("rows")).expect("rows").rows;
    assert_eq!(novamind_database::number_at(&rows[0], 1), screen.facts.economy[0].value);
    for focus in 0..Screen::pane_count(&screen) {
        screen.set_focus(focus);
        if let Some(figure) = screen.figure(&context) {
            session
                .query(&figure.sql.expect("rows"))
                .unwrap_or_else(|rejection| panic!("{}: {rejection}", figure.title));
        }
    }
}
