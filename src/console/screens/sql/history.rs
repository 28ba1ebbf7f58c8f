//! History of executed statements and of editor texts that were replaced.

use super::picker::{PickerItem, Picker, single_line};
use novamind_record::folder::query_library::{QueryHeader, strip_header};

#[derive(Default)]
pub struct StatementHistory {
    /// Entries of this session, the newest last.
    entries: Vec<HistoryEntry>,
}

struct HistoryEntry {
    sql: String,
    /// Whether the text was replaced in the editor without being run.
    is_draft: bool,
}

impl StatementHistory {
    /// Adds an executed statement.
    pub fn add(&mut self, sql: &str) {
        self.push(sql, false);
    }

    /// Adds a replaced editor text, unless the text was run unchanged.
    pub fn add_draft(&mut self, sql: &str) {
        let sql = sql.trim();
        if !sql.is_empty() && !self.entries.iter().any(|known| known.sql == sql && !known.is_draft) {
            self.push(sql, true);
        }
    }

    fn push(&mut self, sql: &str, draft: bool) {
        self.entries.retain(|known| known.sql != sql);
        self.entries.push(HistoryEntry { sql: sql.to_owned(), is_draft: draft });
    }

    /// Returns a picker for the history and for `earlier`, the statements of previous sessions, the newest last.
    /// Returns `None` if there are no statements.
    pub fn picker(&self, earlier: &[String]) -> Option<Picker> {
        let mut items: Vec<PickerItem> = Vec::new();
        let entries = self.entries.iter().rev().map(|kept| (kept.sql.as_str(), kept.is_draft));
        for (sql, draft) in entries.chain(earlier.iter().rev().map(|sql| (sql.as_str(), false))) {
            if items.iter().all(|item| item.sql != sql) {
                items.push(PickerItem {
                    tag: if draft { "draft" } else { "" },
                    title: statement_title(sql),
                    description: String::new(),
                    preview: sql.to_owned(),
                    sql: sql.to_owned(),
                });
            }
        }
        (!items.is_empty()).then(|| Picker::new("History", "insert", items))
    }
}

/// Formats a statement in one line that starts with its title.
fn statement_title(sql: &str) -> String {
    match QueryHeader::parse(sql).title {
        Some(title) => format!("{title}: {}", single_line(strip_header(sql))),
        None => single_line(sql),
    }
}

#[cfg(test)]
mod tests {
    use super::super::picker::PickerResult;
    use super::*;
    use crate::action::Action;

    fn listed_titles(history: &StatementHistory, earlier: &[String]) -> Vec<String> {
        let Some(mut picker) = history.picker(earlier) else { return Vec::new() };
        let mut all = Vec::new();
        loop {
            let PickerResult::Statement(sql) = picker.handle_action(Action::Commit) else { return all };
            if all.contains(&sql) {
                return all;
            }
            all.push(sql);
            picker.select_next();
        }
    }

    #[test]
    fn history_lists_each_statement_once_newest_first() {
        let mut history = StatementHistory::default();
        assert!(history.picker(&[]).is_none());
        for sql in ["SELECT 1", "SELECT 2", "SELECT 1"] {
            history.add(sql);
        }
        let earlier = ["SELECT 2".to_owned(), "SELECT 0".to_owned()];
        assert_eq!(listed_titles(&history, &earlier), ["SELECT 1", "SELECT 2", "SELECT 0"]);
    }

    #[test]
    fn replaced_text_is_a_draft_until_it_is_run() {
        let mut history = StatementHistory::default();
        history.add("SELECT 1");
        for text in ["SELECT 1", "  ", "SELECT half\n"] {
            history.add_draft(text);
        }
        assert_eq!(listed_titles(&history, &[]), ["SELECT half", "SELECT 1"]);
        assert!(history.entries.iter().any(|kept| kept.is_draft));
        history.add("SELECT half");
        assert!(!history.entries.iter().any(|kept| kept.is_draft));
    }
}
