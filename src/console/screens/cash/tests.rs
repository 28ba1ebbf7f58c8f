use super::model::*;
use super::*;
use crate::screens::Screen;
use crate::test_kit::{handle_action, screen_text, played_screen, played_session};
use novamind_database::Cell as Value;
use novamind_session::{LEDGER_WEEK_SQL, submitted_forecasts};

#[test]
fn weekly_ledger_agrees_with_the_database() {
    let (mut session, company, screen) = played_screen::<Cash>(5);
    let weekly_ledger = &screen.ledger;
    let sql = format!("SELECT {LEDGER_WEEK_SQL}, category, sum(amount) FROM ledger GROUP BY 1, 2");
    let mut entries = 0;
    for row in session.query(&sql).expect("an answer").rows {
        let (Value::Integer(week), Value::Text(category), Value::Real(amount)) = (&row[0], &row[1], &row[2])
        else {
            panic!("{row:?}");
        };
        let at = CATEGORIES.iter().position(|category_display| category_display.category.id() == category).expect("a category");
        if *week == 0 {
            assert_eq!((category.as_str(), *amount), ("initial_funding", company.observation.starting_cash));
            continue;
        }
        let booked = weekly_ledger.week(*week as u32)[at];
        assert!((booked - amount).abs() < 0.02, "week {week}, {category}: {booked} and {amount}");
        entries += 1;
    }
    assert!(entries > 20);
    let earned: f64 = weekly_ledger.total().iter().sum();
    let change = company.observation.cash - company.observation.starting_cash;
    assert!((earned - change).abs() < 0.1, "the opening cash is not income: {earned}, {change}");
}

#[test]
fn cash_steps_end_at_the_cash_for_any_row_count() {
    let (_, company, screen) = played_screen::<Cash>(3);
    let ledger = &screen.ledger;
    for room in 0..20 {
        let steps = cash_steps(ledger, &company, 2, room);
        assert!(steps.len() <= room.max(3), "{room}: {}", steps.len());
        let (before, after) = cash_before_and_after(&company, 2).expect("two weeks");
        assert_eq!((steps[0].to, steps[steps.len() - 1].to), (before, after));
        let last = &steps[steps.len() - 2];
        assert!((last.to - after).abs() < 0.02, "{room}: {last:?}");
    }
    assert!(cash_steps(ledger, &company, 0, 9).is_empty());
}

#[test]
fn opening_a_category_queries_its_ledger_rows() {
    let (mut session, company, mut screen) = played_screen::<Cash>(3);
    for _ in 0..20 {
        let Some(Effect::RunSql(sql)) = handle_action(&mut screen, Action::Open, &company).pop() else {
            panic!("no statement");
        };
        assert!(sql.contains("day BETWEEN 14 AND 21") && sql.contains("BETWEEN 3 AND 3"), "{sql}");
        session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
        handle_action(&mut screen, Action::Down, &company);
    }
    screen.set_focused_pane(CashPane::Weeks);
    handle_action(&mut screen, Action::Left, &company);
    assert_eq!((screen.week(), screen.selected_week), (2, Some(2)));
    handle_action(&mut screen, Action::First, &company);
    assert_eq!(screen.week(), 1);
    handle_action(&mut screen, Action::Close, &company);
    assert_eq!((screen.week(), screen.selected_week), (3, None));
}

#[test]
fn ledger_figures_equal_the_sum_of_their_rows() {
    let (mut session, company, mut screen) = played_screen::<Cash>(6);
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    let ledger = screen.ledger.clone();
    for row in 0..screen.subjects.len() {
        let subject = screen.subjects[row];
        for (column, amounts) in [(1, ledger.week(6)), (3, ledger.week(5)), (5, ledger.total())] {
            assert_eq!((screen.table.selected(), screen.table.selected_column()), (Some(row), 1));
            for _ in 1..column {
                handle_action(&mut screen, Action::Right, &company);
            }
            let figure = screen.figure(&context).expect("a figure");
            let sql = format!("SELECT coalesce(sum(amount), 0.0) FROM ({})", figure.sql.expect("rows"));
            let rows = session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}"));
            let made = novamind_database::number_at(&rows.rows[0], 0);
            let shown = subject.amount(&amounts);
            assert!((made - shown).abs() < 0.2, "{}: {shown}, rows make {made}", figure.title);
            for _ in 1..column {
                handle_action(&mut screen, Action::Left, &company);
            }
        }
        handle_action(&mut screen, Action::Down, &company);
    }
}

#[test]
fn every_pane_returns_its_selected_figure() {
    let (mut session, company, mut screen) = played_screen::<Cash>(5);
    let keys = crate::keys::KeyBindings::bundled();
    let context = ScreenContext { company: &company, keys: &keys, page_rows: 5 };
    let title = |screen: &Cash| screen.figure(&context).expect("a figure").title;
    screen.set_focused_pane(CashPane::Waterfall);
    assert_eq!(title(&screen), "net of week 5");
    handle_action(&mut screen, Action::Down, &company);
    assert_eq!(title(&screen), "payments of week 5");
    handle_action(&mut screen, Action::Left, &company);
    assert_eq!(title(&screen), "payments of week 4");
    handle_action(&mut screen, Action::Last, &company);
    assert_eq!(title(&screen), "net of week 4");
    screen.set_focused_pane(CashPane::Curve);
    assert_eq!(title(&screen), "net of week 4");
    screen.set_focused_pane(CashPane::Weeks);
    handle_action(&mut screen, Action::Down, &company);
    assert_eq!(title(&screen), "income of week 4");
    screen.set_focused_pane(CashPane::Forecasts);
    assert_eq!(title(&screen), "forecast of day 28 for day 35");
    let sql = screen.figure(&context).and_then(|figure| figure.sql).expect("rows");
    assert_eq!(session.query(&sql).expect("an answer").rows.len(), 1);
}

#[test]
fn forecasts_are_scored_once_due() {
    let company = DisplayedCompany::from_session(&played_session(2));
    let all = submitted_forecasts(&company.journal, &company.weeks);
    assert_eq!((all.len(), all.iter().filter(|one| one.outcome.is_some()).count()), (8, 2));
}

#[test]
fn four_week_mean_covers_at_most_four_weeks() {
    let ledger = WeeklyLedger::from_company(&DisplayedCompany::from_session(&played_session(6)));
    for (week, weeks) in [(6, vec![3, 4, 5, 6]), (4, vec![1, 2, 3, 4]), (2, vec![1, 2]), (1, vec![1])] {
        let mean = ledger.four_week_mean(week);
        for (category, mean) in mean.iter().enumerate() {
            let sum: f64 = weeks.iter().map(|week| ledger.week(*week)[category]).sum();
            assert!((mean - sum / weeks.len() as f64).abs() < 1e-9, "category {category} of week {week}");
        }
    }
}

#[test]
fn small_window_shows_ledger_and_waterfall() {
    let (_, company, screen) = played_screen::<Cash>(4);
    let text = screen_text(&screen, &company, 80, 21);
    for words in ["payments", "compute", "net", "week 4", "From week 3 to 4", "day 28"] {
        assert!(text.contains(words), "{words} in\n{text}");
    }
}
