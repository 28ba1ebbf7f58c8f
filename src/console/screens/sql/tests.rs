//! Tests of the complete SQL screen: typing, answers and drawing.

use std::time::Duration;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::*;
use crate::action::Scope;
use crate::keys::KeyBindings;
use crate::screens::Screen;
use crate::test_kit::{only_question, new_company, screen_rows, new_session, draw_at_all_sizes};
use novamind_database::{Cell, QueryResult};
use novamind_tools::Rejection;
use novamind_worker::company::DisplayedCompany;

fn with_context<T>(company: &DisplayedCompany, work: impl FnOnce(&ScreenContext<'_>) -> T) -> T {
    let keys = KeyBindings::bundled();
    work(&ScreenContext { company, keys: &keys, page_rows: 5 })
}

fn handle_action(screen: &mut Sql, company: &DisplayedCompany, action: Action) -> Vec<Effect> {
    with_context(company, |context| screen.handle_action(action, context))
}

fn press_key(screen: &mut Sql, company: &DisplayedCompany, code: KeyCode) {
    with_context(company, |context| screen.handle_key(&KeyEvent::new(code, KeyModifiers::NONE), context));
}

/// Types into the open field or editor. If none is open, starts editing the statement.
fn type_statement(screen: &mut Sql, company: &DisplayedCompany, text: &str) {
    if !screen.scopes()[0].is_text() {
        handle_action(screen, company, Action::EditQuery);
    }
    for letter in text.chars() {
        press_key(screen, company, if letter == '\n' { KeyCode::Enter } else { KeyCode::Char(letter) });
    }
}

fn receive_answer(screen: &mut Sql, company: &DisplayedCompany, answer: Result<QueryResult, Rejection>) {
    let running = screen.running.as_ref().expect("a query");
    running.answer.set_answer(answer.map(|rows| (rows, Duration::from_micros(12_400))));
    with_context(company, |context| screen.take_answers(context));
}

/// Returns the statement of the only effect.
fn only_statement(effects: &[Effect]) -> &str {
    &only_question::<Query>(effects).sql
}

fn three_rows() -> QueryResult {
    let row = |name: &str, count: i64, price: f64| {
        vec![Cell::Text(name.to_owned()), Cell::Integer(count), Cell::Real(price)]
    };
    let mut last = row("search_ads", 9, 12.5);
    last[2] = Cell::Null;
    QueryResult {
        columns: ["acquisition_source", "subs", "price"].map(str::to_owned).to_vec(),
        rows: vec![row("network", 28_114, 12.0), row("content_marketing", 13_836, 12.25), last],
        ..QueryResult::default()
    }
}

fn contains(lines: &[String], part: &str) -> bool {
    lines.iter().any(|line| line.contains(part))
}

#[test]
fn statement_runs_once_and_rows_are_shown() {
    let company = new_company();
    let mut screen = Sql::default();
    assert_eq!(screen.scopes()[0], Scope::Query);
    let empty = handle_action(&mut screen, &company, Action::RunQuery);
    assert!(matches!(&empty[..], [Effect::ShowError(_)]));
    type_statement(&mut screen, &company, "SELECT 1; \nSELECT 2");
    let effects = handle_action(&mut screen, &company, Action::RunQuery);
    assert_eq!(only_statement(&effects), "SELECT 2");
    assert!(matches!(&handle_action(&mut screen, &company, Action::RunQuery)[..], [Effect::ShowError(_)]));
    assert!(contains(&screen_rows(&screen, &company, 120, 37), "running … esc cancels"));
    assert!(matches!(&handle_action(&mut screen, &company, Action::LeaveEditor)[..], [Effect::CancelQuery]));
    receive_answer(&mut screen, &company, Ok(three_rows()));
    let lines = screen_rows(&screen, &company, 120, 37);
    assert!(contains(&lines, "Result · 3 rows · 12 ms"), "{lines:#?}");
    assert!(contains(&lines, "network             28,114  12.00"), "{lines:#?}");
    assert!(contains(&lines, "search_ads               9   NULL"), "{lines:#?}");
    assert!(contains(&lines, "▸ customers") && contains(&lines, "statement 2 of 2"));
    let small = screen_rows(&screen, &company, 80, 21);
    assert!(
        contains(&small, "content_marketing   13,836  12.25") && !contains(&small, "▸ customers"),
        "{small:#?}"
    );
}

#[test]
fn results_are_copied_and_exported_in_full() {
    let company = new_company();
    let mut screen = Sql::default();
    type_statement(&mut screen, &company, "SELECT 1");
    handle_action(&mut screen, &company, Action::RunQuery);
    receive_answer(&mut screen, &company, Ok(three_rows()));
    handle_action(&mut screen, &company, Action::LeaveEditor);
    assert_eq!(screen.scopes()[0], Scope::Result);
    for action in [Action::Right, Action::Sort, Action::Last] {
        handle_action(&mut screen, &company, action);
    }
    let one = |effects: Vec<Effect>| effects.into_iter().next();
    let copied = one(handle_action(&mut screen, &company, Action::CopyRow));
    assert!(matches!(copied, Some(Effect::Copy(text)) if text == "search_ads\t9\t"));
    handle_action(&mut screen, &company, Action::First);
    let copied = one(handle_action(&mut screen, &company, Action::CopyCell));
    assert!(matches!(copied, Some(Effect::Copy(text)) if text == "28114"));
    let effect = one(handle_action(&mut screen, &company, Action::ShowCell));
    assert!(matches!(effect, Some(Effect::ShowText(title, text)) if title == "subs" && text == "28114"));
    handle_action(&mut screen, &company, Action::Export);
    assert_eq!(screen.scopes(), [Scope::Export, Scope::List]);
    let lines = screen_rows(&screen, &company, 80, 21);
    assert!(contains(&lines, "Export") && contains(&lines, "3 rows"), "{lines:#?}");
    let csv = one(handle_action(&mut screen, &company, Action::ExportCsv));
    assert!(matches!(csv, Some(Effect::Write(name, bytes)) if name == "query-0001.csv" && bytes.len() > 60));
    handle_action(&mut screen, &company, Action::Export);
    let json = one(handle_action(&mut screen, &company, Action::ExportJson));
    assert!(
        matches!(json, Some(Effect::Write(name, bytes)) if name == "query-0001.json" && bytes[0] == b'[')
    );
    handle_action(&mut screen, &company, Action::Filter);
    type_statement(&mut screen, &company, "net");
    handle_action(&mut screen, &company, Action::Commit);
    handle_action(&mut screen, &company, Action::Export);
    assert!(contains(&screen_rows(&screen, &company, 80, 21), "1 of 3 rows, as filtered"));
    let copied = handle_action(&mut screen, &company, Action::CopyMarkdown);
    assert!(matches!(&copied[..], [Effect::Copy(text), Effect::ShowStatus(notice)]
        if text.ends_with("| network | 28114 | 12.0 |\n") && notice.starts_with("Copied 1 row as Markdown")));
    assert_eq!(screen.scopes()[0], Scope::Result, "the list is closed");
}

#[test]
fn errors_are_shown_and_marked_in_the_statement() {
    let company = new_company();
    let mut screen = Sql::default();
    type_statement(&mut screen, &company, "SELECT 1;\nSELECT wrong FROM ledger");
    handle_action(&mut screen, &company, Action::RunQuery);
    let refusal = Rejection::new("sql_error", "there is no column wrong; ledger has more (at character 8)");
    receive_answer(&mut screen, &company, Err(refusal));
    let lines = screen_rows(&screen, &company, 80, 21);
    assert!(contains(&lines, "sql_error") && contains(&lines, "there is no column wrong"), "{lines:#?}");
    type_statement(&mut screen, &company, "X");
    assert_eq!(screen.editor.text(), "SELECT 1;\nSELECT Xwrong FROM ledger", "the cursor is at the error");
}

#[test]
fn database_errors_have_a_marked_offset() {
    let mut session = new_session();
    let refusal = session.query("SELECT wrong FROM ledger").expect_err("no such column");
    assert_eq!(results::error_offset(&refusal), Some(7), "{refusal}");
    assert_eq!(results::error_offset(&Rejection::new("x", "y (at character 0)")), None);
}

#[test]
fn introduction_statements_run() {
    let mut session = new_session();
    for sql in results::example_statements() {
        session.query(&sql).expect(&sql);
    }
}

#[test]
fn history_search_inserts_earlier_statements() {
    let mut company = new_company();
    company.past_queries = vec!["SELECT 'of yesterday'".to_owned()];
    let mut screen = Sql::default();
    type_statement(&mut screen, &company, "SELECT 1");
    handle_action(&mut screen, &company, Action::RunQuery);
    type_statement(&mut screen, &company, " + half");
    handle_action(&mut screen, &company, Action::History);
    assert_eq!(screen.scopes()[0], Scope::Field);
    type_statement(&mut screen, &company, "yester");
    let lines = screen_rows(&screen, &company, 80, 21);
    assert!(contains(&lines, "SELECT 'of yesterday'") && contains(&lines, "1 of 2"), "{lines:#?}");
    handle_action(&mut screen, &company, Action::Discard);
    assert_eq!((screen.editor.text().as_str(), screen.focus), ("SELECT 1 + half", SqlPane::Editor));
    handle_action(&mut screen, &company, Action::History);
    handle_action(&mut screen, &company, Action::History);
    handle_action(&mut screen, &company, Action::Commit);
    assert_eq!((screen.editor.text().as_str(), screen.focus), ("SELECT 'of yesterday'", SqlPane::Editor));
    handle_action(&mut screen, &company, Action::History);
    let lines = screen_rows(&screen, &company, 80, 21);
    assert!(contains(&lines, "draft SELECT 1 + half"), "replaced text is kept: {lines:#?}");
}

#[test]
fn named_query_is_inserted_and_run() {
    let company = new_company();
    let mut screen = Sql::default();
    handle_action(&mut screen, &company, Action::Library);
    type_statement(&mut screen, &company, "revplan");
    let lines = screen_rows(&screen, &company, 120, 37);
    assert!(contains(&lines, "› revplan") && contains(&lines, "Monthly revenue and seats of each plan"), "{lines:#?}");
    assert!(contains(&lines, "FROM subscriptions"), "the statement is shown: {lines:#?}");
    let effects = handle_action(&mut screen, &company, Action::Commit);
    assert!(only_statement(&effects).starts_with("-- title: Revenue by plan"), "{effects:?}");
    assert!(contains(&screen_rows(&screen, &company, 120, 37), "Query · Revenue by plan"));
}

#[test]
fn a_statement_is_saved_under_a_name() {
    let company = new_company();
    let mut screen = Sql::default();
    let nothing = handle_action(&mut screen, &company, Action::SaveQuery);
    assert!(matches!(&nothing[..], [Effect::ShowError(_)]));
    type_statement(&mut screen, &company, "SELECT 1;\nSELECT 2");
    handle_action(&mut screen, &company, Action::SaveQuery);
    type_statement(&mut screen, &company, "My two");
    assert!(contains(&screen_rows(&screen, &company, 80, 21), "queries/my-two.sql"));
    let saved = handle_action(&mut screen, &company, Action::Commit);
    assert!(matches!(&saved[..], [Effect::SaveQuery { name, title, sql }]
        if name == "my-two" && title == "My two" && sql == "SELECT 2"));
    assert_eq!(screen.scopes()[0], Scope::Editor);
}

fn screen_with_result(company: &DisplayedCompany, sql: &str, rows: QueryResult) -> Sql {
    let mut screen = Sql::default();
    screen.set_statement(sql);
    handle_action(&mut screen, company, Action::RunQuery);
    receive_answer(&mut screen, company, Ok(rows));
    screen.set_focused_pane(SqlPane::Results);
    screen
}

#[test]
fn result_is_drawn_as_bars_with_labels_and_zero() {
    let company = new_company();
    let mut screen = screen_with_result(&company, "SELECT 1", three_rows());
    assert!(handle_action(&mut screen, &company, Action::Chart).is_empty());
    assert_eq!(screen.scopes()[0], Scope::Chart);
    let lines = screen_rows(&screen, &company, 80, 21);
    assert!(contains(&lines, "█ subs by acquisition_source"), "{lines:#?}");
    assert!(contains(&lines, "subs: min 9 (search_ads) · max 28,114 (network) · total 41,959"), "{lines:#?}");
    assert!(contains(&lines, "network           28,114 │████████"), "{lines:#?}");
    assert!(contains(&lines, "search_ads             9 │█ "), "a small bar is visible: {lines:#?}");
    handle_action(&mut screen, &company, Action::MoreSeries);
    let lines = screen_rows(&screen, &company, 80, 21);
    assert!(contains(&lines, "█ subs · ▒ price by acquisition_source"), "{lines:#?}");
    assert!(contains(&lines, "12.25 │▒"), "{lines:#?}");
    let more = handle_action(&mut screen, &company, Action::MoreSeries);
    assert!(matches!(&more[..], [Effect::ShowError(_)]));
    handle_action(&mut screen, &company, Action::CloseChart);
    assert_eq!(screen.scopes()[0], Scope::Result);
    handle_action(&mut screen, &company, Action::Chart);
    handle_action(&mut screen, &company, Action::Filter);
    assert_eq!(screen.scopes(), [Scope::Field], "filtering switches to the rows");
}

#[test]
fn chart_header_of_a_statement_defines_the_chart() {
    let company = new_company();
    let rows = QueryResult {
        columns: ["cash", "week", "cost"].map(str::to_owned).to_vec(),
        rows: (0..20)
            .map(|week| vec![Cell::Integer(1000 + 10 * week), Cell::Integer(week), Cell::Integer(-week)])
            .collect(),
        ..QueryResult::default()
    };
    let mut screen = screen_with_result(&company, "-- chart: line week cash cost\nSELECT 1", rows.clone());
    handle_action(&mut screen, &company, Action::Chart);
    let lines = screen_rows(&screen, &company, 120, 37);
    assert!(contains(&lines, "⎯ cash · • cost by week"), "{lines:#?}");
    assert!(contains(&lines, "cash: min 1,000 at 0 · max 1,190 at 19"), "{lines:#?}");
    assert!(contains(&lines, "last 1,190 · change ▲ 190"), "{lines:#?}");
    handle_action(&mut screen, &company, Action::ChartKind);
    assert!(contains(&screen_rows(&screen, &company, 120, 37), "1,000 "));
    handle_action(&mut screen, &company, Action::RunQuery);
    receive_answer(&mut screen, &company, Ok(rows));
    assert_eq!(screen.scopes()[0], Scope::Chart, "running it again keeps the chart");
    handle_action(&mut screen, &company, Action::RunQuery);
    receive_answer(&mut screen, &company, Ok(three_rows()));
    assert_eq!(screen.scopes()[0], Scope::Result, "other columns are shown as rows first");
}

#[test]
fn results_without_numbers_have_no_chart() {
    let company = new_company();
    let rows = QueryResult {
        columns: vec!["name".to_owned()],
        rows: vec![vec![Cell::Text("x".to_owned())]],
        ..QueryResult::default()
    };
    let mut screen = screen_with_result(&company, "SELECT 1", rows);
    assert!(matches!(&handle_action(&mut screen, &company, Action::Chart)[..], [Effect::ShowError(_)]));
    let mut empty = Sql::default();
    empty.set_focused_pane(SqlPane::Results);
    for action in [Action::Chart, Action::Export] {
        assert!(matches!(&handle_action(&mut empty, &company, action)[..], [Effect::ShowError(_)]));
    }
}

#[test]
fn keys_type_only_while_the_editor_is_in_edit_mode() {
    let company = new_company();
    let mut screen = Sql::default();
    for letter in ['n', '3', 'e'] {
        press_key(&mut screen, &company, KeyCode::Char(letter));
    }
    assert!(screen.editor.is_blank(), "a letter outside of an edit is a command");
    assert!(contains(&screen_rows(&screen, &company, 80, 21), "i or click to type a statement"));
    type_statement(&mut screen, &company, "SELECT 3");
    assert_eq!((screen.scopes()[0], screen.editor.text().as_str()), (Scope::Editor, "SELECT 3"));
    // Without a result, the editor keeps the focus; with a result, the rows get it.
    handle_action(&mut screen, &company, Action::LeaveEditor);
    assert_eq!((screen.focus, screen.scopes()[0]), (SqlPane::Editor, Scope::Query));
    handle_action(&mut screen, &company, Action::RunQuery);
    assert_eq!(screen.focus, SqlPane::Results);
    receive_answer(&mut screen, &company, Ok(three_rows()));
    handle_action(&mut screen, &company, Action::RecallQuery);
    assert_eq!(screen.scopes()[0], Scope::Editor, "the key that edits the statement starts the edit");
    handle_action(&mut screen, &company, Action::LeaveEditor);
    assert_eq!(screen.focus, SqlPane::Results);
    // A click and a paste start the edit, moving the focus ends it.
    with_context(&company, |context| screen.handle_click(0, 0, context));
    assert_eq!(screen.scopes()[0], Scope::Editor);
    screen.set_focus(0);
    assert_eq!(screen.scopes()[0], Scope::Query);
    with_context(&company, |context| screen.paste(" + 4", context));
    assert_eq!((screen.scopes()[0], screen.editor.text().as_str()), (Scope::Editor, "SELECT 3 + 4"));
}

#[test]
fn browser_inserts_names() {
    let company = new_company();
    let mut screen = Sql::default();
    screen.set_focused_pane(SqlPane::Tables);
    handle_action(&mut screen, &company, Action::Open);
    assert_eq!(screen.editor.text(), "SELECT * FROM customers LIMIT 100");
    screen.set_statement("SELECT");
    screen.set_focused_pane(SqlPane::Tables);
    for action in [Action::Right, Action::Down, Action::Open] {
        handle_action(&mut screen, &company, action);
    }
    assert_eq!(screen.editor.text(), "SELECT customer_id");
    assert!(contains(&screen_rows(&screen, &company, 80, 21), "customer_type"), "visible while it has the focus");
}

#[test]
fn highlighting_follows_the_scroll_position() {
    use novamind_tui::theme::{Role, Theme};
    use ratatui::buffer::Buffer;
    let (company, mut screen) = (new_company(), Sql::default());
    screen.set_statement(&format!("{}SELECT 'x' -- done", "\n".repeat(40)));
    let theme = Theme::bundled("dark").expect("a theme");
    let area = Rect::new(0, 0, 80, 21);
    let mut buffer = Buffer::empty(area);
    let mut canvas = Canvas::new(&mut buffer, &theme);
    with_context(&company, |context| screen.draw(&mut canvas, area, context));
    let row = (0..21).find(|y| buffer[(1, *y)].symbol() == "S").expect("the line is shown");
    for (x, role) in [(1, Role::Keyword), (6, Role::Keyword), (8, Role::SqlString), (12, Role::Comment)] {
        let colour = buffer[(x, row)].style().fg.filter(|color| *color != ratatui::style::Color::Reset);
        assert_eq!(colour, theme.style(role).fg, "{x}");
    }
}

#[test]
fn screen_is_drawn_at_every_size() {
    let company = new_company();
    let mut screen = Sql::default();
    draw_at_all_sizes(&mut screen, &company);
    // The loop leaves the focus on the last pane.
    screen.set_focused_pane(SqlPane::Editor);
    type_statement(&mut screen, &company, "SELECT * FROM ledger WHERE am");
    draw_at_all_sizes(&mut screen, &company);
    handle_action(&mut screen, &company, Action::RunQuery);
    receive_answer(&mut screen, &company, Ok(three_rows()));
    for focus in [SqlPane::Results, SqlPane::Tables] {
        screen.set_focused_pane(focus);
        handle_action(&mut screen, &company, Action::Right);
        handle_action(&mut screen, &company, Action::Filter);
        assert_eq!(screen.scopes(), [Scope::Field]);
        draw_at_all_sizes(&mut screen, &company);
        screen.set_focused_pane(focus);
        handle_action(&mut screen, &company, Action::Discard);
    }
    screen.set_focused_pane(SqlPane::Results);
    handle_action(&mut screen, &company, Action::Chart);
    for change in [Action::MoreSeries, Action::ChartKind] {
        screen.set_focused_pane(SqlPane::Results);
        handle_action(&mut screen, &company, change);
        assert_eq!(screen.scopes()[0], Scope::Chart);
        draw_at_all_sizes(&mut screen, &company);
    }
    for over in [Action::Export, Action::History, Action::Library, Action::SaveQuery] {
        screen.overlay = None;
        handle_action(&mut screen, &company, over);
        assert!(screen.overlay.is_some(), "{over:?}");
        draw_at_all_sizes(&mut screen, &company);
    }
}

#[test]
fn running_query_shows_its_elapsed_time() {
    let company = new_company();
    let mut screen = Sql::default();
    screen.edit_and_run("SELECT wrong FROM ledger");
    assert_eq!(screen.scopes()[0], Scope::Result);
    let since = Instant::now().checked_sub(Duration::from_secs(7)).expect("the clock is older");
    screen.running.as_mut().expect("a running statement").started_at = since;
    assert!(contains(&screen_rows(&screen, &company, 120, 37), " s … esc cancels"));
    receive_answer(&mut screen, &company, Err(Rejection::new("sql_error", "no such column: wrong (at character 8)")));
    assert_eq!((screen.focus, screen.scopes()[0]), (SqlPane::Editor, Scope::Query), "the error is in the editor");
}

#[test]
fn column_count_uses_an_editable_statement() {
    let company = new_company();
    let mut screen = screen_with_result(&company, "SELECT * FROM ad_channel_leads", three_rows());
    handle_action(&mut screen, &company, Action::Right);
    let effects = handle_action(&mut screen, &company, Action::CountColumn);
    assert!(only_statement(&effects).contains("SELECT subs, count(*)"), "{effects:?}");
    assert!(screen.editor.text().starts_with("-- title: subs counted"));
    assert!(matches!(&handle_action(&mut screen, &company, Action::Pivot)[..], [Effect::ShowError(_)]), "one at a time");
    receive_answer(&mut screen, &company, Ok(three_rows()));
    let lines = screen_rows(&screen, &company, 120, 37);
    assert!(
        contains(&lines, "Result 2/2 · 3 rows")
            && contains(&lines, " 1 ad_channel_leads ")
            && contains(&lines, " 2 subs counted ")
    );
    handle_action(&mut screen, &company, Action::PreviousResult);
    handle_action(&mut screen, &company, Action::RecallQuery);
    assert_eq!(
        (screen.editor.text().as_str(), screen.focus),
        ("SELECT * FROM ad_channel_leads", SqlPane::Editor)
    );
    let mut empty = Sql::default();
    empty.set_focused_pane(SqlPane::Results);
    for action in
        [Action::CountColumn, Action::Pivot, Action::RecallQuery, Action::CloseResult, Action::PinResult]
    {
        assert!(matches!(&handle_action(&mut empty, &company, action)[..], [Effect::ShowError(_)]), "{action:?}");
    }
    for action in [Action::CountColumn, Action::Pivot] {
        let mut plan = screen_with_result(&company, "EXPLAIN QUERY PLAN SELECT 1", three_rows());
        assert!(matches!(&handle_action(&mut plan, &company, action)[..], [Effect::ShowError(_)]));
        assert!(plan.overlay.is_none());
    }
}

#[test]
fn count_and_pivot_use_the_filtered_rows() {
    let company = new_company();
    let filtered = |text: &str| {
        let mut screen = screen_with_result(&company, "SELECT * FROM ad_channel_leads", three_rows());
        let table = screen.results.current_mut().table_mut();
        table.handle_action(Action::Filter, 5);
        table.edit_filter(|field| field.insert(text));
        table.handle_action(Action::Commit, 5);
        screen
    };
    let word = three_rows().rows[0].iter().find_map(|cell| match cell {
        Cell::Text(text) => Some(text.clone()),
        _ => None,
    });
    let word = word.expect("a word").to_lowercase();
    let mut screen = filtered(&word);
    let asked = handle_action(&mut screen, &company, Action::CountColumn);
    let clause = format!("'{word}') > 0");
    assert!(only_statement(&asked).contains(&clause), "{asked:?}");
    let mut screen = filtered(&word);
    handle_action(&mut screen, &company, Action::Pivot);
    assert!(contains(&screen_rows(&screen, &company, 60, 12), &format!("rows with \"{word}\"")));
    let asked = handle_action(&mut screen, &company, Action::Open);
    assert!(only_statement(&asked).contains(&clause), "{asked:?}");
    // In SQL, a NULL does not match the text "null".
    let mut rows = three_rows();
    rows.rows[1][0] = Cell::Null;
    let mut screen = screen_with_result(&company, "SELECT * FROM ad_channel_leads", rows);
    screen.results.current_mut().table_mut().handle_action(Action::Filter, 5);
    screen.results.current_mut().table_mut().edit_filter(|field| field.insert("null"));
    screen.results.current_mut().table_mut().handle_action(Action::Commit, 5);
    let asked = handle_action(&mut screen, &company, Action::CountColumn);
    let Some(Effect::ShowStatus(words)) = asked.last() else { panic!("{asked:?}") };
    let sql = only_statement(&asked);
    assert!(
        sql.contains("counted, all rows") && !sql.contains("WHERE") && words.contains("without the filter"),
        "{asked:?}"
    );
}

#[test]
fn pivot_takes_two_keys_at_every_size() {
    let company = new_company();
    let mut screen = screen_with_result(&company, "SELECT * FROM ad_channel_leads", three_rows());
    handle_action(&mut screen, &company, Action::Pivot);
    assert_eq!(screen.scopes(), [Scope::List]);
    draw_at_all_sizes(&mut screen, &company);
    let lines = screen_rows(&screen, &company, 60, 12);
    assert!(contains(&lines, "Pivot by acquisition_source") && contains(&lines, "aggregate  sum"), "{lines:#?}");
    handle_action(&mut screen, &company, Action::Close);
    assert!(screen.overlay.is_none());
    screen.set_focused_pane(SqlPane::Results);
    handle_action(&mut screen, &company, Action::Pivot);
    let effects = handle_action(&mut screen, &company, Action::Open);
    assert!(only_statement(&effects).contains("sum(subs)"), "{effects:?}");
    receive_answer(&mut screen, &company, Ok(three_rows()));
    draw_at_all_sizes(&mut screen, &company);
    screen.set_focused_pane(SqlPane::Results);
    let place = screen.focused_index();
    with_context(&company, |context| screen.handle_click(place, usize::MAX - 9, context));
    assert!(contains(&screen_rows(&screen, &company, 120, 37), "Result 1/2"), "a click on the first tab");
}
