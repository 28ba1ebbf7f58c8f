//! Tests of the whole screen: typing, answers, drawing.

use std::time::Duration;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::*;
use crate::action::Scope;
use crate::keys::Keys;
use crate::screens::Screen;
use crate::test_kit::{asked, company, picture, session, sweep};
use novamind_database::{Cell, Rows};
use novamind_tools::Refusal;
use novamind_worker::company::Company;

fn with_look<T>(company: &Company, work: impl FnOnce(&Look<'_>) -> T) -> T {
    let keys = Keys::shipped();
    work(&Look { company, keys: &keys, page: 5 })
}

fn act(screen: &mut Sql, company: &Company, action: Action) -> Vec<Effect> {
    with_look(company, |look| screen.act(action, look))
}

fn key(screen: &mut Sql, company: &Company, code: KeyCode) {
    with_look(company, |look| screen.key(&KeyEvent::new(code, KeyModifiers::NONE), look));
}

fn write(screen: &mut Sql, company: &Company, text: &str) {
    for letter in text.chars() {
        key(screen, company, if letter == '\n' { KeyCode::Enter } else { KeyCode::Char(letter) });
    }
}

fn hear(screen: &mut Sql, company: &Company, answer: Result<Rows, Refusal>) {
    let running = screen.running.as_ref().expect("a query");
    running.answer.put(answer.map(|rows| (rows, Duration::from_micros(12_400))));
    with_look(company, |look| screen.take_answers(look));
}

/// Returns the SQL of the only effect.
fn sql(effects: &[Effect]) -> &str {
    &asked::<Query>(effects).sql
}

fn three_rows() -> Rows {
    let row = |name: &str, count: i64, price: f64| {
        vec![Cell::Text(name.to_owned()), Cell::Integer(count), Cell::Real(price)]
    };
    let mut last = row("search_ads", 9, 12.5);
    last[2] = Cell::Null;
    Rows {
        columns: ["acquisition_source", "subs", "price"].map(str::to_owned).to_vec(),
        rows: vec![row("network", 28_114, 12.0), row("content_marketing", 13_836, 12.25), last],
        ..Rows::default()
    }
}

fn holds(lines: &[String], part: &str) -> bool {
    lines.iter().any(|line| line.contains(part))
}

#[test]
fn a_statement_is_asked_once_and_its_rows_are_shown() {
    let company = company();
    let mut screen = Sql::default();
    assert_eq!(screen.scopes()[0], Scope::Editor);
    let empty = act(&mut screen, &company, Action::RunQuery);
    assert!(matches!(&empty[..], [Effect::Complain(_)]));
    write(&mut screen, &company, "SELECT 1; \nSELECT 2");
    let asked = act(&mut screen, &company, Action::RunQuery);
    assert_eq!(sql(&asked), "SELECT 2");
    assert!(matches!(&act(&mut screen, &company, Action::RunQuery)[..], [Effect::Complain(_)]));
    assert!(holds(&picture(&screen, &company, 120, 37), "running … esc cancels"));
    assert!(matches!(&act(&mut screen, &company, Action::LeaveEditor)[..], [Effect::CancelQuery]));
    hear(&mut screen, &company, Ok(three_rows()));
    let lines = picture(&screen, &company, 120, 37);
    assert!(holds(&lines, "Result · 3 rows · 12 ms"), "{lines:#?}");
    assert!(holds(&lines, "network             28,114  12.00"), "{lines:#?}");
    assert!(holds(&lines, "search_ads               9   NULL"), "{lines:#?}");
    assert!(holds(&lines, "▸ customers") && holds(&lines, "statement 2 of 2"));
    let small = picture(&screen, &company, 80, 21);
    assert!(
        holds(&small, "content_marketing   13,836  12.25") && !holds(&small, "▸ customers"),
        "{small:#?}"
    );
}

#[test]
fn results_are_copied_and_exported_in_full() {
    let company = company();
    let mut screen = Sql::default();
    write(&mut screen, &company, "SELECT 1");
    act(&mut screen, &company, Action::RunQuery);
    hear(&mut screen, &company, Ok(three_rows()));
    act(&mut screen, &company, Action::LeaveEditor);
    assert_eq!(screen.scopes()[0], Scope::Result);
    for action in [Action::Right, Action::Sort, Action::Last] {
        act(&mut screen, &company, action);
    }
    let one = |effects: Vec<Effect>| effects.into_iter().next();
    let copied = one(act(&mut screen, &company, Action::CopyRow));
    assert!(matches!(copied, Some(Effect::Copy(text)) if text == "search_ads\t9\t"));
    act(&mut screen, &company, Action::First);
    let copied = one(act(&mut screen, &company, Action::CopyCell));
    assert!(matches!(copied, Some(Effect::Copy(text)) if text == "28114"));
    let whole = one(act(&mut screen, &company, Action::WholeCell));
    assert!(matches!(whole, Some(Effect::ShowText(title, text)) if title == "subs" && text == "28114"));
    act(&mut screen, &company, Action::Export);
    assert_eq!(screen.scopes(), [Scope::Export, Scope::List]);
    let lines = picture(&screen, &company, 80, 21);
    assert!(holds(&lines, "Export") && holds(&lines, "3 rows"), "{lines:#?}");
    let csv = one(act(&mut screen, &company, Action::ExportCsv));
    assert!(matches!(csv, Some(Effect::Write(name, bytes)) if name == "query-0001.csv" && bytes.len() > 60));
    act(&mut screen, &company, Action::Export);
    let json = one(act(&mut screen, &company, Action::ExportJson));
    assert!(
        matches!(json, Some(Effect::Write(name, bytes)) if name == "query-0001.json" && bytes[0] == b'[')
    );
    act(&mut screen, &company, Action::Filter);
    write(&mut screen, &company, "net");
    act(&mut screen, &company, Action::Commit);
    act(&mut screen, &company, Action::Export);
    assert!(holds(&picture(&screen, &company, 80, 21), "1 of 3 rows, as filtered"));
    let copied = act(&mut screen, &company, Action::CopyMarkdown);
    assert!(matches!(&copied[..], [Effect::Copy(text), Effect::Say(said)]
        if text.ends_with("| network | 28114 | 12.0 |\n") && said.starts_with("Copied 1 row as Markdown")));
    assert_eq!(screen.scopes()[0], Scope::Result, "the list is closed");
}

#[test]
fn errors_are_shown_and_their_place_is_marked() {
    let company = company();
    let mut screen = Sql::default();
    write(&mut screen, &company, "SELECT 1;\nSELECT wrong FROM ledger");
    act(&mut screen, &company, Action::RunQuery);
    let refusal = Refusal::new("sql_error", "there is no column wrong; ledger has more (at character 8)");
    hear(&mut screen, &company, Err(refusal));
    let lines = picture(&screen, &company, 80, 21);
    assert!(holds(&lines, "sql_error") && holds(&lines, "there is no column wrong"), "{lines:#?}");
    write(&mut screen, &company, "X");
    assert_eq!(screen.editor.text(), "SELECT 1;\nSELECT Xwrong FROM ledger", "the cursor is at the error");
}

#[test]
fn a_real_error_names_the_place_that_is_marked() {
    let mut session = session();
    let refusal = session.query("SELECT wrong FROM ledger").expect_err("no such column");
    assert_eq!(results::place_of(&refusal), Some(7), "{refusal}");
    assert_eq!(results::place_of(&Refusal::new("x", "y (at character 0)")), None);
}

#[test]
fn the_lesson_of_an_empty_result_works() {
    let mut session = session();
    for sql in results::examples() {
        session.query(&sql).expect(&sql);
    }
}

#[test]
fn earlier_statements_are_found_by_typing_and_esc_loses_nothing() {
    let mut company = company();
    company.asked = vec!["SELECT 'of yesterday'".to_owned()];
    let mut screen = Sql::default();
    write(&mut screen, &company, "SELECT 1");
    act(&mut screen, &company, Action::RunQuery);
    write(&mut screen, &company, " + half");
    act(&mut screen, &company, Action::History);
    assert_eq!(screen.scopes()[0], Scope::Field);
    write(&mut screen, &company, "yester");
    let lines = picture(&screen, &company, 80, 21);
    assert!(holds(&lines, "SELECT 'of yesterday'") && holds(&lines, "1 of 2"), "{lines:#?}");
    act(&mut screen, &company, Action::Discard);
    assert_eq!((screen.editor.text().as_str(), screen.focus), ("SELECT 1 + half", SqlPane::Editor));
    act(&mut screen, &company, Action::History);
    act(&mut screen, &company, Action::History);
    act(&mut screen, &company, Action::Commit);
    assert_eq!((screen.editor.text().as_str(), screen.focus), ("SELECT 'of yesterday'", SqlPane::Editor));
    act(&mut screen, &company, Action::History);
    let lines = picture(&screen, &company, 80, 21);
    assert!(holds(&lines, "draft SELECT 1 + half"), "replaced text is kept: {lines:#?}");
}

#[test]
fn a_named_query_is_put_in_and_run() {
    let company = company();
    let mut screen = Sql::default();
    act(&mut screen, &company, Action::Library);
    write(&mut screen, &company, "revplan");
    let lines = picture(&screen, &company, 120, 37);
    assert!(holds(&lines, "› revplan") && holds(&lines, "What each plan brings in a month"), "{lines:#?}");
    assert!(holds(&lines, "FROM subscriptions"), "the statement is shown: {lines:#?}");
    let asked = act(&mut screen, &company, Action::Commit);
    assert!(sql(&asked).starts_with("-- title: Revenue by plan"), "{asked:?}");
    assert!(holds(&picture(&screen, &company, 120, 37), "Query · Revenue by plan"));
}

#[test]
fn a_statement_is_saved_under_a_name() {
    let company = company();
    let mut screen = Sql::default();
    let nothing = act(&mut screen, &company, Action::SaveQuery);
    assert!(matches!(&nothing[..], [Effect::Complain(_)]));
    write(&mut screen, &company, "SELECT 1;\nSELECT 2");
    act(&mut screen, &company, Action::SaveQuery);
    write(&mut screen, &company, "My two");
    assert!(holds(&picture(&screen, &company, 80, 21), "queries/my-two.sql"));
    let saved = act(&mut screen, &company, Action::Commit);
    assert!(matches!(&saved[..], [Effect::SaveQuery { name, title, sql }]
        if name == "my-two" && title == "My two" && sql == "SELECT 2"));
    assert_eq!(screen.scopes()[0], Scope::Editor);
}

fn with_result(company: &Company, sql: &str, rows: Rows) -> Sql {
    let mut screen = Sql::default();
    screen.edit(sql);
    act(&mut screen, company, Action::RunQuery);
    hear(&mut screen, company, Ok(rows));
    screen.focus_on(SqlPane::Results);
    screen
}

#[test]
fn a_result_is_drawn_as_bars_with_words_and_zero() {
    let company = company();
    let mut screen = with_result(&company, "SELECT 1", three_rows());
    assert!(act(&mut screen, &company, Action::Chart).is_empty());
    assert_eq!(screen.scopes()[0], Scope::Chart);
    let lines = picture(&screen, &company, 80, 21);
    assert!(holds(&lines, "█ subs by acquisition_source"), "{lines:#?}");
    assert!(holds(&lines, "subs: min 9 (search_ads) · max 28,114 (network) · total 41,959"), "{lines:#?}");
    assert!(holds(&lines, "network           28,114 │████████"), "{lines:#?}");
    assert!(holds(&lines, "search_ads             9 │█ "), "a small bar is visible: {lines:#?}");
    act(&mut screen, &company, Action::MoreSeries);
    let lines = picture(&screen, &company, 80, 21);
    assert!(holds(&lines, "█ subs · ▒ price by acquisition_source"), "{lines:#?}");
    assert!(holds(&lines, "12.25 │▒"), "{lines:#?}");
    let more = act(&mut screen, &company, Action::MoreSeries);
    assert!(matches!(&more[..], [Effect::Complain(_)]));
    act(&mut screen, &company, Action::CloseChart);
    assert_eq!(screen.scopes()[0], Scope::Result);
    act(&mut screen, &company, Action::Chart);
    act(&mut screen, &company, Action::Filter);
    assert_eq!(screen.scopes(), [Scope::Field], "filtering switches to the rows");
}

#[test]
fn a_statement_says_how_its_result_is_drawn() {
    let company = company();
    let rows = Rows {
        columns: ["cash", "week", "cost"].map(str::to_owned).to_vec(),
        rows: (0..20)
            .map(|week| vec![Cell::Integer(1000 + 10 * week), Cell::Integer(week), Cell::Integer(-week)])
            .collect(),
        ..Rows::default()
    };
    let mut screen = with_result(&company, "-- chart: line week cash cost\nSELECT 1", rows.clone());
    act(&mut screen, &company, Action::Chart);
    let lines = picture(&screen, &company, 120, 37);
    assert!(holds(&lines, "⎯ cash · • cost by week"), "{lines:#?}");
    assert!(holds(&lines, "cash: min 1,000 at 0 · max 1,190 at 19"), "{lines:#?}");
    assert!(holds(&lines, "last 1,190 · change ▲ 190"), "{lines:#?}");
    act(&mut screen, &company, Action::ChartKind);
    assert!(holds(&picture(&screen, &company, 120, 37), "1,000 "));
    act(&mut screen, &company, Action::RunQuery);
    hear(&mut screen, &company, Ok(rows));
    assert_eq!(screen.scopes()[0], Scope::Chart, "running it again keeps the chart");
    act(&mut screen, &company, Action::RunQuery);
    hear(&mut screen, &company, Ok(three_rows()));
    assert_eq!(screen.scopes()[0], Scope::Result, "other columns are shown as rows first");
}

#[test]
fn words_alone_cannot_be_drawn() {
    let company = company();
    let rows = Rows {
        columns: vec!["name".to_owned()],
        rows: vec![vec![Cell::Text("x".to_owned())]],
        ..Rows::default()
    };
    let mut screen = with_result(&company, "SELECT 1", rows);
    assert!(matches!(&act(&mut screen, &company, Action::Chart)[..], [Effect::Complain(_)]));
    let mut empty = Sql::default();
    empty.focus_on(SqlPane::Results);
    for action in [Action::Chart, Action::Export] {
        assert!(matches!(&act(&mut empty, &company, action)[..], [Effect::Complain(_)]));
    }
}

#[test]
fn names_come_from_the_browser() {
    let company = company();
    let mut screen = Sql::default();
    screen.focus_on(SqlPane::Tables);
    act(&mut screen, &company, Action::Open);
    assert_eq!(screen.editor.text(), "SELECT * FROM customers LIMIT 100");
    screen.edit("SELECT");
    screen.focus_on(SqlPane::Tables);
    for action in [Action::Right, Action::Down, Action::Open] {
        act(&mut screen, &company, action);
    }
    assert_eq!(screen.editor.text(), "SELECT customer_id");
    assert!(holds(&picture(&screen, &company, 80, 21), "customer_type"), "visible while it has the focus");
}

#[test]
fn keywords_are_coloured_where_the_text_is_scrolled_to() {
    use novamind_tui::theme::{Role, Theme};
    use ratatui::buffer::Buffer;
    let (company, mut screen) = (company(), Sql::default());
    screen.edit(&format!("{}SELECT 'x' -- done", "\n".repeat(40)));
    let theme = Theme::bundled("dark").expect("a theme");
    let area = Rect::new(0, 0, 80, 21);
    let mut buffer = Buffer::empty(area);
    let mut canvas = Canvas::new(&mut buffer, &theme);
    with_look(&company, |look| screen.draw(&mut canvas, area, look));
    let row = (0..21).find(|y| buffer[(1, *y)].symbol() == "S").expect("the line is shown");
    for (x, role) in [(1, Role::Keyword), (6, Role::Keyword), (8, Role::SqlText), (12, Role::Comment)] {
        let colour = buffer[(x, row)].style().fg.filter(|own| *own != ratatui::style::Color::Reset);
        assert_eq!(colour, theme.style(role).fg, "{x}");
    }
}

#[test]
fn no_size_is_too_small() {
    let company = company();
    let mut screen = Sql::default();
    sweep(&mut screen, &company);
    // The loop leaves the focus on the last pane.
    screen.focus_on(SqlPane::Editor);
    write(&mut screen, &company, "SELECT * FROM ledger WHERE am");
    sweep(&mut screen, &company);
    act(&mut screen, &company, Action::RunQuery);
    hear(&mut screen, &company, Ok(three_rows()));
    for focus in [SqlPane::Results, SqlPane::Tables] {
        screen.focus_on(focus);
        act(&mut screen, &company, Action::Right);
        act(&mut screen, &company, Action::Filter);
        assert_eq!(screen.scopes(), [Scope::Field]);
        sweep(&mut screen, &company);
        screen.focus_on(focus);
        act(&mut screen, &company, Action::Discard);
    }
    screen.focus_on(SqlPane::Results);
    act(&mut screen, &company, Action::Chart);
    for change in [Action::MoreSeries, Action::ChartKind] {
        screen.focus_on(SqlPane::Results);
        act(&mut screen, &company, change);
        assert_eq!(screen.scopes()[0], Scope::Chart);
        sweep(&mut screen, &company);
    }
    for over in [Action::Export, Action::History, Action::Library, Action::SaveQuery] {
        screen.over = None;
        act(&mut screen, &company, over);
        assert!(screen.over.is_some(), "{over:?}");
        sweep(&mut screen, &company);
    }
}

#[test]
fn a_long_query_says_how_long_and_a_named_one_leaves_the_keys_to_its_result() {
    let company = company();
    let mut screen = Sql::default();
    screen.edit_and_run("SELECT wrong FROM ledger");
    assert_eq!(screen.scopes()[0], Scope::Result);
    let since = Instant::now().checked_sub(Duration::from_secs(7)).expect("the clock is older");
    screen.running.as_mut().expect("it runs").since = since;
    assert!(holds(&picture(&screen, &company, 120, 37), " s … esc cancels"));
    hear(&mut screen, &company, Err(Refusal::new("sql_error", "no such column: wrong (at character 8)")));
    assert_eq!(screen.scopes()[0], Scope::Editor, "the editor has the focus after an error");
}

#[test]
fn a_column_is_counted_by_a_query_that_can_be_edited() {
    let company = company();
    let mut screen = with_result(&company, "SELECT * FROM ad_channel_leads", three_rows());
    act(&mut screen, &company, Action::Right);
    let asked = act(&mut screen, &company, Action::CountColumn);
    assert!(sql(&asked).contains("SELECT subs, count(*)"), "{asked:?}");
    assert!(screen.editor.text().starts_with("-- title: subs counted"));
    assert!(matches!(&act(&mut screen, &company, Action::Pivot)[..], [Effect::Complain(_)]), "one at a time");
    hear(&mut screen, &company, Ok(three_rows()));
    let lines = picture(&screen, &company, 120, 37);
    assert!(
        holds(&lines, "Result 2/2 · 3 rows")
            && holds(&lines, " 1 ad_channel_leads ")
            && holds(&lines, " 2 subs counted ")
    );
    act(&mut screen, &company, Action::PreviousResult);
    act(&mut screen, &company, Action::RecallQuery);
    assert_eq!(
        (screen.editor.text().as_str(), screen.focus),
        ("SELECT * FROM ad_channel_leads", SqlPane::Editor)
    );
    let mut empty = Sql::default();
    empty.focus_on(SqlPane::Results);
    for action in
        [Action::CountColumn, Action::Pivot, Action::RecallQuery, Action::CloseResult, Action::PinResult]
    {
        assert!(matches!(&act(&mut empty, &company, action)[..], [Effect::Complain(_)]), "{action:?}");
    }
    for action in [Action::CountColumn, Action::Pivot] {
        let mut plan = with_result(&company, "EXPLAIN QUERY PLAN SELECT 1", three_rows());
        assert!(matches!(&act(&mut plan, &company, action)[..], [Effect::Complain(_)]));
        assert!(plan.over.is_none());
    }
}

#[test]
fn a_count_and_a_pivot_are_made_of_the_rows_that_the_filter_shows() {
    let company = company();
    let filtered = |text: &str| {
        let mut screen = with_result(&company, "SELECT * FROM ad_channel_leads", three_rows());
        let table = screen.results.shown_mut().table_mut();
        table.act(Action::Filter, 5);
        table.edit_filter(|field| field.insert(text));
        table.act(Action::Commit, 5);
        screen
    };
    let word = three_rows().rows[0].iter().find_map(|cell| match cell {
        Cell::Text(text) => Some(text.clone()),
        _ => None,
    });
    let word = word.expect("a word").to_lowercase();
    let mut screen = filtered(&word);
    let asked = act(&mut screen, &company, Action::CountColumn);
    let clause = format!("'{word}') > 0");
    assert!(sql(&asked).contains(&clause), "{asked:?}");
    let mut screen = filtered(&word);
    act(&mut screen, &company, Action::Pivot);
    assert!(holds(&picture(&screen, &company, 60, 12), &format!("rows with \"{word}\"")));
    let asked = act(&mut screen, &company, Action::Open);
    assert!(sql(&asked).contains(&clause), "{asked:?}");
    // In SQL no row has the text "null".
    let mut rows = three_rows();
    rows.rows[1][0] = Cell::Null;
    let mut screen = with_result(&company, "SELECT * FROM ad_channel_leads", rows);
    screen.results.shown_mut().table_mut().act(Action::Filter, 5);
    screen.results.shown_mut().table_mut().edit_filter(|field| field.insert("null"));
    screen.results.shown_mut().table_mut().act(Action::Commit, 5);
    let asked = act(&mut screen, &company, Action::CountColumn);
    let Some(Effect::Say(words)) = asked.last() else { panic!("{asked:?}") };
    let sql = sql(&asked);
    assert!(
        sql.contains("counted, all rows") && !sql.contains("WHERE") && words.contains("without the filter"),
        "{asked:?}"
    );
}

#[test]
fn a_pivot_takes_two_keys_and_is_drawn_at_every_size() {
    let company = company();
    let mut screen = with_result(&company, "SELECT * FROM ad_channel_leads", three_rows());
    act(&mut screen, &company, Action::Pivot);
    assert_eq!(screen.scopes(), [Scope::List]);
    sweep(&mut screen, &company);
    let lines = picture(&screen, &company, 60, 12);
    assert!(holds(&lines, "Pivot by acquisition_source") && holds(&lines, "aggregate  sum"), "{lines:#?}");
    act(&mut screen, &company, Action::Close);
    assert!(screen.over.is_none());
    screen.focus_on(SqlPane::Results);
    act(&mut screen, &company, Action::Pivot);
    let asked = act(&mut screen, &company, Action::Open);
    assert!(sql(&asked).contains("sum(subs)"), "{asked:?}");
    hear(&mut screen, &company, Ok(three_rows()));
    sweep(&mut screen, &company);
    screen.focus_on(SqlPane::Results);
    let place = screen.focus();
    with_look(&company, |look| screen.click(place, usize::MAX - 9, look));
    assert!(holds(&picture(&screen, &company, 120, 37), "Result 1/2"), "a click on the first tab");
}
