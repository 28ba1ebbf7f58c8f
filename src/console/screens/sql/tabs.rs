//! Tabs of recent results. Each statement has a separate tab, which is updated when the statement runs again. Pinned
//! tabs are not closed.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::picker::single_line;
use super::results::ResultView;
use novamind_database::{Interface, QueryResult, table};
use novamind_record::folder::query_library::{QueryHeader, strip_header};
use novamind_tools::Rejection;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::sql::tokenize;
use novamind_tui::theme::Role;
use std::time::Duration;

const MAX_TABS: usize = 9;
/// Maximum number of pinned tabs. One tab is reserved for the next statement.
const MAX_PINNED_TABS: usize = MAX_TABS - 1;
/// Maximum size of all tabs in bytes. The oldest tabs are closed if the size is exceeded.
const MAX_TOTAL_BYTES: usize = 128 << 20;
/// Maximum length of a tab title in characters.
const MAX_TITLE_CHARS: usize = 18;
/// Row index of a click on the first tab. It is larger than the index of any row.
const FIRST_TAB_CLICK: usize = usize::MAX - MAX_TABS;
/// Minimum height for a row with the titles of the tabs.
const MIN_HEIGHT_FOR_TABS: u16 = 6;

struct ResultTab {
    sql: String,
    title: String,
    pinned: bool,
    results: ResultView,
    /// Day of the company when the statement was run.
    day: u32,
}

/// The tabs of results, the newest last.
#[derive(Default)]
pub struct ResultTabs {
    tabs: Vec<ResultTab>,
    current_index: usize,
    /// View that is shown before the first statement.
    placeholder: ResultView,
}

impl ResultTabs {
    pub fn current(&self) -> &ResultView {
        self.tabs.get(self.current_index).map_or(&self.placeholder, |tab| &tab.results)
    }

    pub fn current_mut(&mut self) -> &mut ResultView {
        match self.tabs.get_mut(self.current_index) {
            Some(tab) => &mut tab.results,
            None => &mut self.placeholder,
        }
    }

    /// Returns the statement of the displayed result.
    pub fn statement(&self) -> Option<&str> {
        self.tabs.get(self.current_index).map(|tab| tab.sql.as_str())
    }

    /// Returns the day of the displayed result if the company has another day now.
    pub fn outdated_day(&self, today: u32) -> Option<u32> {
        let tab = self.tabs.get(self.current_index).filter(|tab| !tab.results.is_rejected())?;
        (tab.day != today).then_some(tab.day)
    }

    /// Returns the title of the only result, if the statement of the result is not the statement in the editor.
    pub fn title_of_other_statement(&self, in_editor: Option<&str>) -> Option<&str> {
        match self.tabs.as_slice() {
            [tab] if in_editor != Some(tab.sql.as_str()) => Some(&tab.title),
            _ => None,
        }
    }

    /// Stores the answer to a statement that was run on a day, and shows the answer. If the answer is an error, the tab with earlier rows of
    /// the statement is kept.
    pub fn add_answer(&mut self, sql: &str, answer: Result<QueryResult, Rejection>, took: Duration, day: u32) {
        let renewed = |tab: &ResultTab| !tab.pinned && answer.is_ok() && tab.sql == sql;
        let known = self.tabs.iter().position(renewed);
        let refused = self.tabs.iter().position(|tab| tab.results.is_rejected());
        let at = known.or(refused).unwrap_or_else(|| {
            let results = ResultView::default();
            self.tabs.push(ResultTab { sql: String::new(), title: String::new(), pinned: false, results, day });
            self.tabs.len() - 1
        });
        let tab = &mut self.tabs[at];
        (tab.sql, tab.title, tab.day) = (sql.to_owned(), tab_title(sql), day);
        tab.results.set_answer(sql, answer, took);
        self.current_index = at;
        // The tab of a failed statement is removed when another result is shown.
        if let Some(other) = refused.filter(|other| *other != at) {
            self.remove(other);
        }
        self.evict_old_tabs();
    }

    fn total_bytes(&self) -> usize {
        self.tabs.iter().map(|tab| tab.results.size_in_bytes()).sum()
    }

    fn evict_old_tabs(&mut self) {
        while self.tabs.len() > MAX_TABS || self.total_bytes() > MAX_TOTAL_BYTES {
            let oldest = (0..self.tabs.len()).find(|at| *at != self.current_index && !self.tabs[*at].pinned);
            let Some(oldest) = oldest else { return };
            self.remove(oldest);
        }
    }

    fn remove(&mut self, at: usize) {
        self.tabs.remove(at);
        if self.current_index > at || self.current_index == self.tabs.len() {
            self.current_index = self.current_index.saturating_sub(1);
        }
    }

    /// Shows the next or previous tab, cyclically.
    pub fn select_adjacent(&mut self, on: bool) {
        let count = self.tabs.len().max(1);
        self.current_index = (self.current_index + if on { 1 } else { count - 1 }) % count;
    }

    /// Closes the displayed tab. Returns whether there was a tab.
    pub fn close(&mut self) -> bool {
        let is_there = self.current_index < self.tabs.len();
        if is_there {
            self.remove(self.current_index);
        }
        is_there
    }

    /// Pins or unpins the displayed tab. Returns whether the tab is now pinned.
    ///
    /// # Errors
    /// The tab cannot be pinned. The error is the reason.
    pub fn toggle_pin(&mut self) -> Result<bool, String> {
        let pinned = self.tabs.iter().filter(|tab| tab.pinned);
        let (count, bytes) =
            pinned.fold((0, 0), |(count, bytes), tab| (count + 1, bytes + tab.results.size_in_bytes()));
        let Some(tab) = self.tabs.get_mut(self.current_index).filter(|tab| !tab.results.is_rejected()) else {
            return Err("No result to pin. Run a statement first.".to_owned());
        };
        if !tab.pinned && count == MAX_PINNED_TABS {
            return Err(format!("{MAX_PINNED_TABS} results are pinned. Unpin or close one first."));
        }
        if !tab.pinned && bytes + tab.results.size_in_bytes() > MAX_TOTAL_BYTES {
            return Err("The pinned results are too large. Unpin or close one first.".to_owned());
        }
        tab.pinned = !tab.pinned;
        Ok(tab.pinned)
    }

    /// Returns the position of the displayed tab, for example ` 2/3`, if there are several tabs.
    pub fn position_label(&self) -> String {
        if self.tabs.len() > 1 { format!(" {}/{}", self.current_index + 1, self.tabs.len()) } else { String::new() }
    }

    /// Shows the clicked tab. Returns false for clicks on rows.
    pub fn handle_click(&mut self, place: usize) -> bool {
        let tab = place.checked_sub(FIRST_TAB_CLICK).filter(|at| *at < self.tabs.len());
        if let Some(at) = tab {
            self.current_index = at;
        }
        tab.is_some()
    }

    /// Draws the titles of the tabs if they fit. Returns the area for the result.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize) -> Rect {
        if self.tabs.len() < 2 || area.height < MIN_HEIGHT_FOR_TABS {
            return area;
        }
        let label = |(at, tab): (usize, &ResultTab)| {
            format!(" {}{} {} ", at + 1, if tab.pinned { "*" } else { "" }, tab.title)
        };
        let labels: Vec<String> = self.tabs.iter().enumerate().map(label).collect();
        let width = |from: usize| labels[from..=self.current_index].iter().map(|label| label.width() + 1).sum::<usize>();
        // The title of the displayed tab must be visible.
        let first = (0..self.current_index).find(|from| width(*from) <= area.width as usize).unwrap_or(self.current_index);
        let mut x = area.x;
        for (at, label) in labels.iter().enumerate().skip(first) {
            let room = area.right().saturating_sub(x);
            let tab_area = Rect { x, y: area.y, width: (label.width() as u16).min(room), height: 1 };
            if tab_area.width < 4 {
                break;
            }
            canvas.draw_text(tab_area, label, if at == self.current_index { Role::Selection } else { Role::Dim });
            canvas.register_click(tab_area, Click::Row(pane, FIRST_TAB_CLICK + at));
            x += tab_area.width + 1;
        }
        Rect { y: area.y + 1, height: area.height - 1, ..area }
    }
}

/// Returns the title of a tab: the title of its statement, its first table, or its first words.
fn tab_title(sql: &str) -> String {
    let short = |text: String| match text.chars().count() {
        long if long > MAX_TITLE_CHARS => text.chars().take(MAX_TITLE_CHARS - 1).chain(['…']).collect(),
        _ => text,
    };
    if let Some(title) = QueryHeader::parse(sql).title {
        return short(title);
    }
    let named = tokenize(sql).into_iter().find_map(|token| table(Interface::Release1, &sql[token.range]));
    short(named.map_or_else(|| single_line(strip_header(sql)), |table| table.name.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Cell;

    fn rows(number: i64) -> Result<QueryResult, Rejection> {
        let columns = vec!["n".to_owned()];
        Ok(QueryResult { columns, rows: vec![vec![Cell::Integer(number)]], ..QueryResult::default() })
    }

    fn add_answer_for(tabs: &mut ResultTabs, number: i64) {
        tabs.add_answer(&format!("SELECT {number}"), rows(number), Duration::ZERO, 7);
    }

    fn titles(tabs: &ResultTabs) -> Vec<&str> {
        tabs.tabs.iter().map(|tab| tab.title.as_str()).collect()
    }

    #[test]
    fn only_result_is_named_if_the_editor_has_another_statement() {
        let mut tabs = ResultTabs::default();
        assert_eq!(tabs.title_of_other_statement(Some("SELECT 2")), None);
        add_answer_for(&mut tabs, 1);
        assert_eq!(tabs.title_of_other_statement(Some("SELECT 1")), None);
        assert_eq!(tabs.title_of_other_statement(Some("SELECT 2")), Some("SELECT 1"));
        assert_eq!(tabs.title_of_other_statement(None), Some("SELECT 1"));
        add_answer_for(&mut tabs, 2);
        assert_eq!(tabs.title_of_other_statement(Some("SELECT 3")), None, "the tabs name them");
    }

    #[test]
    fn tabs_keep_the_last_nine_and_pinned_results() {
        let mut tabs = ResultTabs::default();
        assert!(!tabs.close() && tabs.toggle_pin().is_err());
        add_answer_for(&mut tabs, 1);
        assert_eq!((tabs.toggle_pin(), tabs.position_label().as_str()), (Ok(true), ""));
        (2..=12).for_each(|number| add_answer_for(&mut tabs, number));
        assert_eq!(titles(&tabs)[..2], ["SELECT 1", "SELECT 5"]);
        assert_eq!((tabs.tabs.len(), tabs.position_label().as_str()), (9, " 9/9"));
        add_answer_for(&mut tabs, 6);
        assert_eq!(
            (tabs.tabs.len(), tabs.statement()),
            (9, Some("SELECT 6")),
            "running it again updates its tab"
        );
        add_answer_for(&mut tabs, 1);
        assert_eq!((titles(&tabs)[0], tabs.current_index), ("SELECT 1", 8), "a pinned tab does not change");
        assert_eq!(tabs.tabs.iter().filter(|tab| tab.sql == "SELECT 1").count(), 2);
        for _ in 0..8 {
            tabs.select_adjacent(true);
            if !tabs.tabs[tabs.current_index].pinned {
                tabs.toggle_pin().ok();
            }
        }
        assert_eq!(tabs.tabs.iter().filter(|tab| tab.pinned).count(), MAX_PINNED_TABS);
        add_answer_for(&mut tabs, 99);
        assert_eq!((tabs.tabs.len(), tabs.statement()), (9, Some("SELECT 99")));
    }

    #[test]
    fn result_of_an_earlier_day_is_outdated_until_it_runs_again() {
        let mut tabs = ResultTabs::default();
        assert_eq!(tabs.outdated_day(7), None);
        add_answer_for(&mut tabs, 1);
        assert_eq!((tabs.outdated_day(7), tabs.outdated_day(14)), (None, Some(7)));
        tabs.add_answer("SELECT 1", rows(1), Duration::ZERO, 14);
        assert_eq!((tabs.tabs.len(), tabs.outdated_day(14)), (1, None));
        tabs.add_answer("SELECT x", Err(Rejection::new("sql_error", "no")), Duration::ZERO, 14);
        assert_eq!(tabs.outdated_day(21), None, "an error has no rows");
    }

    #[test]
    fn rejection_keeps_earlier_rows_until_the_next_answer() {
        let mut tabs = ResultTabs::default();
        add_answer_for(&mut tabs, 1);
        tabs.add_answer("SELECT 1", Err(Rejection::new("sql_cancelled", "cancelled")), Duration::ZERO, 7);
        assert_eq!((tabs.tabs.len(), tabs.current_index), (2, 1));
        tabs.add_answer("SELECT x", Err(Rejection::new("sql_error", "no")), Duration::ZERO, 7);
        assert_eq!(tabs.tabs.len(), 2);
        add_answer_for(&mut tabs, 1);
        assert_eq!(
            (tabs.tabs.len(), tabs.current_index),
            (1, 0),
            "the tab is updated and the failed statement is dropped"
        );
    }

    #[test]
    fn selecting_and_closing_tabs_wraps() {
        let mut tabs = ResultTabs::default();
        tabs.select_adjacent(true);
        (1..=3).for_each(|number| add_answer_for(&mut tabs, number));
        tabs.select_adjacent(true);
        assert_eq!(tabs.statement(), Some("SELECT 1"));
        tabs.select_adjacent(false);
        assert!(tabs.close());
        assert_eq!((tabs.statement(), tabs.tabs.len()), (Some("SELECT 2"), 2));
        assert!(tabs.handle_click(FIRST_TAB_CLICK) && !tabs.handle_click(FIRST_TAB_CLICK + 5) && !tabs.handle_click(1));
        assert_eq!(tabs.statement(), Some("SELECT 1"));
    }

    #[test]
    fn large_results_evict_older_ones() {
        let mut tabs = ResultTabs::default();
        let text = Cell::Text("x".repeat(MAX_TOTAL_BYTES / 4));
        for number in 0..4 {
            let large =
                QueryResult { columns: vec!["n".to_owned()], rows: vec![vec![text.clone()]], ..QueryResult::default() };
            tabs.add_answer(&format!("SELECT {number}"), Ok(large), Duration::ZERO, 7);
        }
        assert!(tabs.total_bytes() <= MAX_TOTAL_BYTES && tabs.tabs.len() == 3, "{}", tabs.tabs.len());
    }

    #[test]
    fn titles_describe_the_statement() {
        assert_eq!(tab_title("-- title: Revenue by plan\nSELECT 1"), "Revenue by plan");
        assert_eq!(tab_title("SELECT count(*) FROM Ledger l"), "ledger");
        assert_eq!(tab_title("SELECT 1 + 2 + 3 + 4 + 5"), "SELECT 1 + 2 + 3 …");
    }
}
