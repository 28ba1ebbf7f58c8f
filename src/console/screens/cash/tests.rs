use super::model::*;
use super::*;
use crate::console::test_kit::{act, drawn, played, shown, sweep};
use crate::session::Cell as Value;

#[test]
fn the_books_agree_with_the_ledger() {
    let mut session = played(5);
    let company = Company::of(&session);
    let screen: Cash = shown(&mut session, &company);
    let books = screen.books.as_ref().expect("books");
    let sql = "SELECT (day + 6) / 7, category, sum(amount) FROM ledger GROUP BY 1, 2";
    let mut entries = 0;
    for row in session.query(sql).expect("an answer").rows {
        let (Value::Integer(week), Value::Text(category), Value::Real(amount)) = (&row[0], &row[1], &row[2])
        else {
            panic!("{row:?}");
        };
        let at = CATEGORIES.iter().position(|own| own.id == category).expect("a category");
        let booked = books.week(*week as u32)[at];
        assert!((booked - amount).abs() < 0.02, "week {week}, {category}: {booked} and {amount}");
        entries += 1;
    }
    assert!(entries > 20);
    let cash: f64 = books.total().iter().sum();
    assert!((cash - company.seen.cash).abs() < 0.1);
}

#[test]
fn a_waterfall_arrives_whatever_the_room() {
    let mut session = played(3);
    let company = Company::of(&session);
    let screen: Cash = shown(&mut session, &company);
    let books = screen.books.as_ref().expect("books");
    for room in 0..20 {
        let steps = waterfall(books, &company, 2, room);
        assert!(steps.len() <= room.max(3), "{room}: {}", steps.len());
        let (before, after) = cash_around(&company, 2).expect("two weeks");
        assert_eq!((steps[0].to, steps[steps.len() - 1].to), (before, after));
        let last = &steps[steps.len() - 2];
        assert!((last.to - after).abs() < 0.02, "{room}: {last:?}");
    }
    assert!(waterfall(books, &company, 0, 9).is_empty());
}

#[test]
fn a_category_leads_to_its_ledger_rows() {
    let mut session = played(3);
    let company = Company::of(&session);
    let mut screen: Cash = shown(&mut session, &company);
    for _ in 0..20 {
        let Some(Effect::EditSql(sql)) = act(&mut screen, Action::Open, &company).pop() else {
            panic!("no statement");
        };
        assert!(sql.contains("BETWEEN 15 AND 21"), "{sql}");
        session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
        act(&mut screen, Action::Down, &company);
    }
    screen.set_focus(WEEKS);
    act(&mut screen, Action::Left, &company);
    assert_eq!((screen.week(), screen.week), (2, Some(2)));
    act(&mut screen, Action::First, &company);
    assert_eq!(screen.week(), 1);
    act(&mut screen, Action::Close, &company);
    assert_eq!((screen.week(), screen.week), (3, None));
}

#[test]
fn forecasts_are_compared_once_their_day_has_come() {
    let forecast = Filed { day: 7, horizon: 7, point: 1.0, lower: 0.0, upper: 2.0, outcome: None };
    for (outcome, verdict) in
        [(None, None), (Some(1.0), Some(0)), (Some(-1.0), Some(-1)), (Some(3.0), Some(1))]
    {
        assert_eq!(Filed { outcome, ..forecast }.verdict(), verdict);
    }
    let company = Company::of(&played(2));
    let all = filed(&company);
    assert_eq!((all.len(), all.iter().filter(|one| one.outcome.is_some()).count()), (8, 2));
}

#[test]
fn it_is_drawn_in_every_window_with_and_without_data() {
    for weeks in [0, 1, 9] {
        let mut session = played(weeks);
        let company = Company::of(&session);
        sweep(&mut Cash::default(), &company);
        sweep(&mut shown::<Cash>(&mut session, &company), &company);
    }
}

#[test]
fn the_small_window_shows_books_and_way() {
    let mut session = played(4);
    let company = Company::of(&session);
    let screen: Cash = shown(&mut session, &company);
    let text = drawn(&screen, &company, 80, 21);
    for words in ["payments", "compute", "net", "week 4", "From week 3 to 4", "day 28"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}
