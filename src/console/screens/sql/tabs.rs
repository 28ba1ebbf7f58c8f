//! Tabs of recent results. Each statement has its own tab, running it again updates the tab, and pinned tabs
//! stay.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::picker::in_a_line;
use super::results::Results;
use novamind_database::{Rows, table};
use novamind_record::folder::library::{Head, body};
use novamind_tools::Refusal;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::sql::tokens;
use novamind_tui::theme::Role;
use std::time::Duration;

const MOST: usize = 9;
/// Maximum number of pinned tabs; one is left for the next statement.
const MOST_PINNED: usize = MOST - 1;
/// Total bytes of all tabs; beyond that the oldest are closed.
const MOST_BYTES: usize = 128 << 20;
/// Maximum characters of a title.
const TITLE: usize = 18;
/// Indexes of clicks on tabs follow those of all rows.
const FIRST_CLICK: usize = usize::MAX - MOST;
/// Below this height only the border identifies the tab.
const ROOM: u16 = 6;

struct Tab {
    sql: String,
    title: String,
    pinned: bool,
    results: Results,
}

/// The tabs, newest last.
#[derive(Default)]
pub struct Tabs {
    tabs: Vec<Tab>,
    at: usize,
    /// Shown before the first statement.
    nothing: Results,
}

impl Tabs {
    pub fn shown(&self) -> &Results {
        self.tabs.get(self.at).map_or(&self.nothing, |tab| &tab.results)
    }

    pub fn shown_mut(&mut self) -> &mut Results {
        match self.tabs.get_mut(self.at) {
            Some(tab) => &mut tab.results,
            None => &mut self.nothing,
        }
    }

    /// Returns the statement of the shown result.
    pub fn statement(&self) -> Option<&str> {
        self.tabs.get(self.at).map(|tab| tab.sql.as_str())
    }

    /// Stores the answer to a statement and shows it. After an error the statement keeps its previous rows.
    pub fn take(&mut self, sql: &str, answer: Result<Rows, Refusal>, took: Duration) {
        let renewed = |tab: &Tab| !tab.pinned && answer.is_ok() && tab.sql == sql;
        let known = self.tabs.iter().position(renewed);
        let refused = self.tabs.iter().position(|tab| tab.results.is_refused());
        let at = known.or(refused).unwrap_or_else(|| {
            let results = Results::default();
            self.tabs.push(Tab { sql: String::new(), title: String::new(), pinned: false, results });
            self.tabs.len() - 1
        });
        let tab = &mut self.tabs[at];
        (tab.sql, tab.title) = (sql.to_owned(), title(sql));
        tab.results.take(sql, answer, took);
        self.at = at;
        // Failed statements are dropped once another result is shown.
        if let Some(other) = refused.filter(|other| *other != at) {
            self.remove(other);
        }
        self.stay_in_bounds();
    }

    fn bytes(&self) -> usize {
        self.tabs.iter().map(|tab| tab.results.bytes()).sum()
    }

    fn stay_in_bounds(&mut self) {
        while self.tabs.len() > MOST || self.bytes() > MOST_BYTES {
            let oldest = (0..self.tabs.len()).find(|at| *at != self.at && !self.tabs[*at].pinned);
            let Some(oldest) = oldest else { return };
            self.remove(oldest);
        }
    }

    fn remove(&mut self, at: usize) {
        self.tabs.remove(at);
        if self.at > at || self.at == self.tabs.len() {
            self.at = self.at.saturating_sub(1);
        }
    }

    /// Shows the next or previous tab, cyclically.
    pub fn walk(&mut self, on: bool) {
        let count = self.tabs.len().max(1);
        self.at = (self.at + if on { 1 } else { count - 1 }) % count;
    }

    /// Closes the shown tab; returns whether there was one.
    pub fn close(&mut self) -> bool {
        let is_there = self.at < self.tabs.len();
        if is_there {
            self.remove(self.at);
        }
        is_there
    }

    /// Pins or unpins the shown tab; returns whether it is pinned.
    ///
    /// # Errors
    /// The reason why it cannot be pinned.
    pub fn pin(&mut self) -> Result<bool, String> {
        let pinned = self.tabs.iter().filter(|tab| tab.pinned);
        let (count, bytes) =
            pinned.fold((0, 0), |(count, bytes), tab| (count + 1, bytes + tab.results.bytes()));
        let Some(tab) = self.tabs.get_mut(self.at).filter(|tab| !tab.results.is_refused()) else {
            return Err("No result to pin. Run a statement first.".to_owned());
        };
        if !tab.pinned && count == MOST_PINNED {
            return Err(format!("{MOST_PINNED} results are pinned. Unpin or close one first."));
        }
        if !tab.pinned && bytes + tab.results.bytes() > MOST_BYTES {
            return Err("The pinned results are too large. Unpin or close one first.".to_owned());
        }
        tab.pinned = !tab.pinned;
        Ok(tab.pinned)
    }

    /// Returns ` 2/3` if there are several tabs.
    pub fn number(&self) -> String {
        if self.tabs.len() > 1 { format!(" {}/{}", self.at + 1, self.tabs.len()) } else { String::new() }
    }

    /// Shows the clicked tab; returns false for clicks on rows.
    pub fn click(&mut self, place: usize) -> bool {
        let tab = place.checked_sub(FIRST_CLICK).filter(|at| *at < self.tabs.len());
        if let Some(at) = tab {
            self.at = at;
        }
        tab.is_some()
    }

    /// Draws the titles if they fit; returns the area for the result.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, pane: usize) -> Rect {
        if self.tabs.len() < 2 || area.height < ROOM {
            return area;
        }
        let label = |(at, tab): (usize, &Tab)| {
            format!(" {}{} {} ", at + 1, if tab.pinned { "*" } else { "" }, tab.title)
        };
        let labels: Vec<String> = self.tabs.iter().enumerate().map(label).collect();
        let width = |from: usize| labels[from..=self.at].iter().map(|label| label.width() + 1).sum::<usize>();
        // Keep the shown tab visible.
        let first = (0..self.at).find(|from| width(*from) <= area.width as usize).unwrap_or(self.at);
        let mut x = area.x;
        for (at, label) in labels.iter().enumerate().skip(first) {
            let room = area.right().saturating_sub(x);
            let own = Rect { x, y: area.y, width: (label.width() as u16).min(room), height: 1 };
            if own.width < 4 {
                break;
            }
            canvas.text(own, label, if at == self.at { Role::Selection } else { Role::Dim });
            canvas.click(own, Click::Row(pane, FIRST_CLICK + at));
            x += own.width + 1;
        }
        Rect { y: area.y + 1, height: area.height - 1, ..area }
    }
}

/// Returns the title of a tab: the title of its statement, its first table, or its first words.
fn title(sql: &str) -> String {
    let short = |text: String| match text.chars().count() {
        long if long > TITLE => text.chars().take(TITLE - 1).chain(['…']).collect(),
        _ => text,
    };
    if let Some(title) = Head::of(sql).title {
        return short(title);
    }
    let named = tokens(sql).into_iter().find_map(|token| table(&sql[token.place]));
    short(named.map_or_else(|| in_a_line(body(sql)), |table| table.name.clone()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Cell;

    fn rows(number: i64) -> Result<Rows, Refusal> {
        let columns = vec!["n".to_owned()];
        Ok(Rows { columns, rows: vec![vec![Cell::Integer(number)]], ..Rows::default() })
    }

    fn take(tabs: &mut Tabs, number: i64) {
        tabs.take(&format!("SELECT {number}"), rows(number), Duration::ZERO);
    }

    fn titles(tabs: &Tabs) -> Vec<&str> {
        tabs.tabs.iter().map(|tab| tab.title.as_str()).collect()
    }

    #[test]
    fn the_last_nine_are_kept_and_pinned_ones_longer() {
        let mut tabs = Tabs::default();
        assert!(!tabs.close() && tabs.pin().is_err());
        take(&mut tabs, 1);
        assert_eq!((tabs.pin(), tabs.number().as_str()), (Ok(true), ""));
        (2..=12).for_each(|number| take(&mut tabs, number));
        assert_eq!(titles(&tabs)[..2], ["SELECT 1", "SELECT 5"]);
        assert_eq!((tabs.tabs.len(), tabs.number().as_str()), (9, " 9/9"));
        take(&mut tabs, 6);
        assert_eq!(
            (tabs.tabs.len(), tabs.statement()),
            (9, Some("SELECT 6")),
            "running it again updates its tab"
        );
        take(&mut tabs, 1);
        assert_eq!((titles(&tabs)[0], tabs.at), ("SELECT 1", 8), "a pinned tab does not change");
        assert_eq!(tabs.tabs.iter().filter(|tab| tab.sql == "SELECT 1").count(), 2);
        for _ in 0..8 {
            tabs.walk(true);
            if !tabs.tabs[tabs.at].pinned {
                tabs.pin().ok();
            }
        }
        assert_eq!(tabs.tabs.iter().filter(|tab| tab.pinned).count(), MOST_PINNED);
        take(&mut tabs, 99);
        assert_eq!((tabs.tabs.len(), tabs.statement()), (9, Some("SELECT 99")));
    }

    #[test]
    fn a_refusal_takes_no_rows_away_and_goes_with_the_next_answer() {
        let mut tabs = Tabs::default();
        take(&mut tabs, 1);
        tabs.take("SELECT 1", Err(Refusal::new("sql_cancelled", "cancelled")), Duration::ZERO);
        assert_eq!((tabs.tabs.len(), tabs.at), (2, 1));
        tabs.take("SELECT x", Err(Refusal::new("sql_error", "no")), Duration::ZERO);
        assert_eq!(tabs.tabs.len(), 2);
        take(&mut tabs, 1);
        assert_eq!(
            (tabs.tabs.len(), tabs.at),
            (1, 0),
            "the tab is updated and the failed statement is dropped"
        );
    }

    #[test]
    fn walking_and_closing_go_round() {
        let mut tabs = Tabs::default();
        tabs.walk(true);
        (1..=3).for_each(|number| take(&mut tabs, number));
        tabs.walk(true);
        assert_eq!(tabs.statement(), Some("SELECT 1"));
        tabs.walk(false);
        assert!(tabs.close());
        assert_eq!((tabs.statement(), tabs.tabs.len()), (Some("SELECT 2"), 2));
        assert!(tabs.click(FIRST_CLICK) && !tabs.click(FIRST_CLICK + 5) && !tabs.click(1));
        assert_eq!(tabs.statement(), Some("SELECT 1"));
    }

    #[test]
    fn large_results_push_older_ones_out() {
        let mut tabs = Tabs::default();
        let text = Cell::Text("x".repeat(MOST_BYTES / 4));
        for number in 0..4 {
            let large =
                Rows { columns: vec!["n".to_owned()], rows: vec![vec![text.clone()]], ..Rows::default() };
            tabs.take(&format!("SELECT {number}"), Ok(large), Duration::ZERO);
        }
        assert!(tabs.bytes() <= MOST_BYTES && tabs.tabs.len() == 3, "{}", tabs.tabs.len());
    }

    #[test]
    fn titles_say_what_was_asked() {
        assert_eq!(title("-- title: Revenue by plan\nSELECT 1"), "Revenue by plan");
        assert_eq!(title("SELECT count(*) FROM Ledger l"), "ledger");
        assert_eq!(title("SELECT 1 + 2 + 3 + 4 + 5"), "SELECT 1 + 2 + 3 …");
    }
}
