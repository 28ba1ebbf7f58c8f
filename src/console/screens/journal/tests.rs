use super::*;
use crate::action::Scope;
use crate::keys::KeyBindings;
use crate::screens::Screen;
use crate::test_kit::{new_company, screen_rows, new_session, draw_at_all_sizes};
use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use novamind_record::trajectory::record::Via;
use novamind_worker::company::DisplayedCompany;
use serde_json::json;

fn with_context<T>(company: &DisplayedCompany, work: impl FnOnce(&ScreenContext<'_>) -> T) -> T {
    let keys = KeyBindings::bundled();
    work(&ScreenContext { company, keys: &keys, page_rows: 5 })
}

fn handle_action(screen: &mut Journal, company: &DisplayedCompany, action: Action) -> Vec<Effect> {
    with_context(company, |context| screen.handle_action(action, context))
}

fn type_notes(screen: &mut Journal, company: &DisplayedCompany, text: &str) {
    for letter in text.chars() {
        let key = KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE);
        with_context(company, |context| screen.handle_key(&key, context));
    }
}

fn played_company() -> DisplayedCompany {
    let mut session = new_session();
    let prices = json!({"A": 12, "B": 25, "C": 55});
    session.call("set_prices", &prices, Via::Form).expect("prices");
    let forecasts = session.company().naive_forecasts();
    session
        .advance("Cheaper than the others.\nSee who comes.", &forecasts, Via::Form, &mut |_| {})
        .expect("a week");
    session.call("set_prices", &json!({"A": 13}), Via::Form).expect("prices");
    session.undo(Via::Form).expect("undone");
    DisplayedCompany::from_session(&session)
}

fn journal_with_company(company: &DisplayedCompany) -> Journal {
    let mut screen = Journal::default();
    with_context(company, |context| screen.on_company_change(context));
    screen
}

fn contains(lines: &[String], part: &str) -> bool {
    lines.iter().any(|line| line.contains(part))
}

#[test]
fn newest_week_is_first() {
    let company = played_company();
    let screen = journal_with_company(&company);
    let texts: Vec<String> = screen.table.rows().iter().map(|row| row[1].text.clone()).collect();
    assert_eq!(texts[0], "week 2 · now · 2 actions");
    assert_eq!(texts[1], "  undone: set_prices A 12 → 13");
    assert_eq!(texts[2], "  undo: set_prices A 13 → 12");
    assert!(texts[3].starts_with("week 1 · day 7 · cash $"), "{texts:#?}");
    assert_eq!(texts[4], "  why  Cheaper than the others. See who comes.");
    assert!(texts[5].starts_with("  forecasts") && texts[5].contains(": 1 wk $"), "{texts:#?}");
    assert_eq!(texts[6], "  set_prices A 12 B 25 C 55");
}

#[test]
fn every_row_has_a_term_and_source_rows() {
    let mut session = crate::test_kit::played_session(2);
    let company = DisplayedCompany::from_session(&session);
    let mut screen = journal_with_company(&company);
    let mut terms = Vec::new();
    for _ in 0..screen.table.rows().len() {
        let figure = with_context(&company, |context| screen.figure(context)).expect("a figure");
        if let Some(sql) = &figure.sql {
            let rows = session.query(sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}")).rows;
            if figure.term == "cash-change" {
                let sum: f64 = rows.iter().map(|row| novamind_database::number_at(row, 1)).sum();
                let week = company.weeks.iter().find(|week| (week.cash_change - sum).abs() < 0.01);
                assert!(week.is_some(), "{sql}: {sum}");
            }
        }
        terms.push(figure.term);
        handle_action(&mut screen, &company, Action::Down);
    }
    for term in ["cash-change", "rationale", "forecast", "set_prices", "set_targeted_ad_spend"] {
        assert!(terms.contains(&term), "{term} in {terms:?}");
    }
    screen.set_focused_pane(JournalPane::Scores);
    handle_action(&mut screen, &company, Action::Down);
    let figure = with_context(&company, |screen_context| screen.figure(screen_context)).expect("a figure");
    assert!(figure.title.contains("4 weeks"), "{figure:?}");
}

#[test]
fn opening_an_entry_shows_its_text() {
    let company = played_company();
    let mut screen = journal_with_company(&company);
    for _ in 0..4 {
        handle_action(&mut screen, &company, Action::Down);
    }
    let effects = handle_action(&mut screen, &company, Action::Open);
    let [Effect::ShowText(title, text)] = &effects[..] else { panic!("{effects:?}") };
    assert!(title.starts_with("week 1"), "{title}");
    for part in ["See who comes.", "Forecasts of cash, filled", "set_prices A 12", "Result:"] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn the_screen_shows_list_scores_and_notes() {
    let company = played_company();
    let screen = journal_with_company(&company);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let lines = screen_rows(&screen, &company, width, height);
        for part in ["Journal", "week 1 · day 7", " of 1 ", "26 weeks", "Notes"] {
            assert!(contains(&lines, part), "{width}×{height} {part}: {lines:#?}");
        }
    }
}

#[test]
fn unsaved_notes_survive_until_they_are_saved() {
    let mut company = new_company();
    let mut screen = journal_with_company(&company);
    handle_action(&mut screen, &company, Action::EditNotes);
    assert_eq!(screen.scopes(), [Scope::Editor, Scope::Notes]);
    type_notes(&mut screen, &company, "watch S3");
    handle_action(&mut screen, &company, Action::LeaveEditor);
    with_context(&company, |context| screen.on_company_change(context));
    assert!(screen.has_unsent_text() && screen.notes.text() == "watch S3");
    assert!(contains(&screen_rows(&screen, &company, 80, 21), "draft, unsaved"));
    let effects = handle_action(&mut screen, &company, Action::SaveNotes);
    assert!(matches!(&effects[..], [Effect::Request(Request::SetNotes(text))] if text == "watch S3"));
    company.notes = "watch S3\n".to_owned();
    with_context(&company, |screen_context| screen.on_company_change(screen_context));
    assert!(!screen.has_unsent_text());
    company.notes = "from elsewhere".to_owned();
    with_context(&company, |look| screen.on_company_change(look));
    assert_eq!(screen.notes.text(), "from elsewhere", "without typed text the saved notes are shown");
}

#[test]
fn screen_is_drawn_at_every_size() {
    for company in [new_company(), played_company()] {
        let mut screen = journal_with_company(&company);
        draw_at_all_sizes(&mut screen, &company);
        handle_action(&mut screen, &company, Action::Filter);
        draw_at_all_sizes(&mut screen, &company);
        handle_action(&mut screen, &company, Action::Discard);
        handle_action(&mut screen, &company, Action::EditNotes);
        type_notes(&mut screen, &company, "a long note with words");
        draw_at_all_sizes(&mut screen, &company);
    }
}
