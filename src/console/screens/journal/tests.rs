use super::*;
use crate::action::Scope;
use crate::keys::Keys;
use crate::screens::Screen;
use crate::test_kit::{company, picture, session, sweep};
use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use novamind_record::trajectory::record::Via;
use novamind_worker::company::Company;
use serde_json::json;

fn with_look<T>(company: &Company, work: impl FnOnce(&Look<'_>) -> T) -> T {
    let keys = Keys::shipped();
    work(&Look { company, keys: &keys, page: 5 })
}

fn act(screen: &mut Journal, company: &Company, action: Action) -> Vec<Effect> {
    with_look(company, |look| screen.act(action, look))
}

fn write(screen: &mut Journal, company: &Company, text: &str) {
    for letter in text.chars() {
        let key = KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE);
        with_look(company, |look| screen.key(&key, look));
    }
}

fn played() -> Company {
    let mut session = session();
    let prices = json!({"A": 12, "B": 25, "C": 55});
    session.call("set_prices", &prices, Via::Form).expect("prices");
    let forecasts = session.company().naive_forecasts();
    session
        .advance("Cheaper than the others.\nSee who comes.", &forecasts, Via::Form, &mut |_| {})
        .expect("a week");
    session.call("set_prices", &json!({"A": 13}), Via::Form).expect("prices");
    session.undo(Via::Form).expect("undone");
    Company::of(&session)
}

fn renewed(company: &Company) -> Journal {
    let mut screen = Journal::default();
    with_look(company, |look| screen.renew(look));
    screen
}

fn holds(lines: &[String], part: &str) -> bool {
    lines.iter().any(|line| line.contains(part))
}

#[test]
fn weeks_stand_with_the_newest_first() {
    let company = played();
    let screen = renewed(&company);
    let texts: Vec<String> = screen.table.rows().iter().map(|row| row[1].text.clone()).collect();
    assert_eq!(texts[0], "week 2 · now · 2 actions");
    assert_eq!(texts[1], "  undone: set_prices A 12 → 13");
    assert_eq!(texts[2], "  undo: set_prices A 13 → 12");
    assert!(texts[3].starts_with("week 1 · day 7 · cash $"), "{texts:#?}");
    assert_eq!(texts[4], "  why  Cheaper than the others. See who comes.");
    assert!(texts[5].starts_with("  filed ") && texts[5].contains(": 1 wk $"), "{texts:#?}");
    assert_eq!(texts[6], "  set_prices A 12 B 25 C 55");
}

#[test]
fn every_row_names_what_it_is_about_and_its_rows() {
    let mut session = crate::test_kit::played(2);
    let company = Company::of(&session);
    let mut screen = renewed(&company);
    let mut terms = Vec::new();
    for _ in 0..screen.table.rows().len() {
        let figure = with_look(&company, |look| screen.figure(look)).expect("a figure");
        if let Some(sql) = &figure.sql {
            let rows = session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows;
            if figure.term == "cash-change" {
                let sum: f64 = rows.iter().map(|row| novamind_database::number_at(row, 1)).sum();
                let week = company.weeks.iter().find(|week| (week.cash_change - sum).abs() < 0.01);
                assert!(week.is_some(), "{sql}: {sum}");
            }
        }
        terms.push(figure.term);
        act(&mut screen, &company, Action::Down);
    }
    for term in ["cash-change", "rationale", "forecast", "set_prices", "set_targeted_ad_spend"] {
        assert!(terms.contains(&term), "{term} in {terms:?}");
    }
    screen.focus_on(JournalPane::Scores);
    act(&mut screen, &company, Action::Down);
    let figure = with_look(&company, |look| screen.figure(look)).expect("a figure");
    assert!(figure.title.contains("4 weeks"), "{figure:?}");
}

#[test]
fn an_entry_opens_as_text() {
    let company = played();
    let mut screen = renewed(&company);
    for _ in 0..4 {
        act(&mut screen, &company, Action::Down);
    }
    let effects = act(&mut screen, &company, Action::Open);
    let [Effect::ShowText(title, text)] = &effects[..] else { panic!("{effects:?}") };
    assert!(title.starts_with("week 1"), "{title}");
    for part in ["See who comes.", "Forecasts of cash, filled", "set_prices A 12", "Result:"] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
fn the_screen_shows_list_scores_and_notes() {
    let company = played();
    let screen = renewed(&company);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let lines = picture(&screen, &company, width, height);
        for part in ["Journal", "week 1 · day 7", " of 1 ", "26 weeks", "Notes"] {
            assert!(holds(&lines, part), "{width}×{height} {part}: {lines:#?}");
        }
    }
}

#[test]
fn a_draft_of_the_notes_survives_until_it_is_kept() {
    let mut company = company();
    let mut screen = renewed(&company);
    act(&mut screen, &company, Action::EditMemo);
    assert_eq!(screen.scopes(), [Scope::Editor, Scope::Memo]);
    write(&mut screen, &company, "watch S3");
    act(&mut screen, &company, Action::LeaveEditor);
    with_look(&company, |look| screen.renew(look));
    assert!(screen.holds_unsent_text() && screen.notes.text() == "watch S3");
    assert!(holds(&picture(&screen, &company, 80, 21), "draft, unsaved"));
    let effects = act(&mut screen, &company, Action::SaveMemo);
    assert!(matches!(&effects[..], [Effect::Request(Request::SetMemo(text))] if text == "watch S3"));
    company.memo = "watch S3\n".to_owned();
    with_look(&company, |look| screen.renew(look));
    assert!(!screen.holds_unsent_text());
    company.memo = "from elsewhere".to_owned();
    with_look(&company, |look| screen.renew(look));
    assert_eq!(screen.notes.text(), "from elsewhere", "without typed text the saved notes are shown");
}

#[test]
fn no_size_is_too_small() {
    for company in [company(), played()] {
        let mut screen = renewed(&company);
        sweep(&mut screen, &company);
        act(&mut screen, &company, Action::Filter);
        sweep(&mut screen, &company);
        act(&mut screen, &company, Action::Discard);
        act(&mut screen, &company, Action::EditMemo);
        write(&mut screen, &company, "a long note with words");
        sweep(&mut screen, &company);
    }
}
