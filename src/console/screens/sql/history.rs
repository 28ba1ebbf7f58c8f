//! History of executed statements and replaced editor texts, newest first.

use super::picker::{ListedQuery, Picker, in_a_line};
use novamind_record::folder::library::{Head, body};

#[derive(Default)]
pub struct History {
    /// Newest last.
    kept: Vec<Kept>,
}

struct Kept {
    sql: String,
    /// Whether it was replaced in the editor without being run.
    draft: bool,
}

impl History {
    /// Adds an executed statement.
    pub fn remember(&mut self, sql: &str) {
        self.keep(sql, false);
    }

    /// Adds a replaced text, unless it was run unchanged.
    pub fn remember_draft(&mut self, sql: &str) {
        let sql = sql.trim();
        if !sql.is_empty() && !self.kept.iter().any(|known| known.sql == sql && !known.draft) {
            self.keep(sql, true);
        }
    }

    fn keep(&mut self, sql: &str, draft: bool) {
        self.kept.retain(|known| known.sql != sql);
        self.kept.push(Kept { sql: sql.to_owned(), draft });
    }

    /// Returns a picker for the history; `earlier` are statements of previous sessions, newest last. Returns
    /// `None` if both are empty.
    pub fn picker(&self, earlier: &[String]) -> Option<Picker> {
        let mut items: Vec<ListedQuery> = Vec::new();
        let own = self.kept.iter().rev().map(|kept| (kept.sql.as_str(), kept.draft));
        for (sql, draft) in own.chain(earlier.iter().rev().map(|sql| (sql.as_str(), false))) {
            if items.iter().all(|item| item.sql != sql) {
                items.push(ListedQuery {
                    tag: if draft { "draft" } else { "" },
                    title: title(sql),
                    what: String::new(),
                    preview: sql.to_owned(),
                    sql: sql.to_owned(),
                });
            }
        }
        (!items.is_empty()).then(|| Picker::new("History", "insert", items))
    }
}

/// Returns a statement in one line, with its title first.
fn title(sql: &str) -> String {
    match Head::of(sql).title {
        Some(title) => format!("{title}: {}", in_a_line(body(sql))),
        None => in_a_line(sql),
    }
}

#[cfg(test)]
mod tests {
    use super::super::picker::PickedQuery;
    use super::*;
    use crate::action::Action;

    fn listed(history: &History, earlier: &[String]) -> Vec<String> {
        let Some(mut picker) = history.picker(earlier) else { return Vec::new() };
        let mut all = Vec::new();
        loop {
            let PickedQuery::Statement(sql) = picker.act(Action::Commit) else { return all };
            if all.contains(&sql) {
                return all;
            }
            all.push(sql);
            picker.next();
        }
    }

    #[test]
    fn statements_stand_once_the_newest_first() {
        let mut history = History::default();
        assert!(history.picker(&[]).is_none());
        for sql in ["SELECT 1", "SELECT 2", "SELECT 1"] {
            history.remember(sql);
        }
        let earlier = ["SELECT 2".to_owned(), "SELECT 0".to_owned()];
        assert_eq!(listed(&history, &earlier), ["SELECT 1", "SELECT 2", "SELECT 0"]);
    }

    #[test]
    fn what_was_replaced_is_kept_as_a_draft_until_it_is_asked() {
        let mut history = History::default();
        history.remember("SELECT 1");
        for text in ["SELECT 1", "  ", "SELECT half\n"] {
            history.remember_draft(text);
        }
        assert_eq!(listed(&history, &[]), ["SELECT half", "SELECT 1"]);
        assert!(history.kept.iter().any(|kept| kept.draft));
        history.remember("SELECT half");
        assert!(!history.kept.iter().any(|kept| kept.draft));
    }
}
