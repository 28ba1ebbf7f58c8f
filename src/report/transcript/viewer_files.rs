//! The texts of a player as files (notes, stored code and forecasts), and their changes in each week.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::{TranscriptAction, TranscriptStep, forecasts_as_json};
use novamind_session::week_of_day;
use novamind_tools::ToolId;

/// Number of unchanged lines that a diff shows before and after the changed lines.
const CONTEXT_LINES: usize = 2;

/// The files as they were at the end of the last week, and as they are now.
#[derive(Default)]
pub(super) struct PlayerFiles {
    before: BTreeMap<String, String>,
    now: BTreeMap<String, String>,
}

impl PlayerFiles {
    /// Path under which the viewer shows the notes.
    pub(super) const NOTES: &str = "notes.md";

    /// Applies the effect of an action to the files.
    pub(super) fn add_action(&mut self, step: &TranscriptStep) {
        match &step.action {
            TranscriptAction::Note(Some(text)) => {
                self.now.insert(PlayerFiles::NOTES.to_owned(), text.clone());
            }
            TranscriptAction::Week { forecasts, .. } => {
                let path = format!("forecasts/week_{}.json", week_of_day(step.day + 1));
                let text = serde_json::to_string_pretty(&forecasts_as_json(forecasts)).unwrap_or_default();
                self.now.insert(path, text + "\n");
            }
            TranscriptAction::Call { tool, args, answer: Ok(_), .. } => {
                self.add_call(tool.tool_id(), args, step.seq);
            }
            _ => {}
        }
    }

    fn add_call(&mut self, tool: Option<ToolId>, args: &Value, seq: u64) {
        let text = |key: &str| args[key].as_str().unwrap_or_default();
        let (name, code) = (text("name").trim(), text("code"));
        match tool {
            Some(ToolId::RegisterScript) => self.now.insert(format!("scripts/{name}"), code.to_owned()),
            Some(ToolId::DeleteScript) => self.now.remove(&format!("scripts/{name}")),
            Some(ToolId::RegisterDailyCalculation) => {
                self.now.insert(format!("calculations/{name}"), code.to_owned())
            }
            Some(ToolId::RemoveDailyCalculation) => self.now.remove(&format!("calculations/{name}")),
            Some(ToolId::PythonExec) => {
                // The first line of Python code begins with #; other code is SQL.
                let extension = if code.trim_start().starts_with('#') { "py" } else { "sql" };
                self.now.insert(format!("executed/line_{seq}.{extension}"), code.to_owned())
            }
            _ => None,
        };
    }

    /// Returns the changes since the last call, as entries of the viewer, and their total length in bytes.
    pub(super) fn take_changes(&mut self) -> (Vec<Value>, usize) {
        let paths = self.before.keys().chain(self.now.keys().filter(|path| !self.before.contains_key(*path)));
        let mut size = 0;
        let mut changes = Vec::new();
        for path in paths {
            changes.extend(match (self.before.get(path), self.now.get(path)) {
                (None, Some(new)) => {
                    size += new.len();
                    Some(json!({ "path": path, "status": "A", "content": new }))
                }
                (Some(old), Some(new)) if old != new => {
                    let diff = unified_diff(path, old, new);
                    size += diff.len();
                    Some(json!({ "path": path, "status": "M", "diff": diff }))
                }
                (Some(_), None) => Some(json!({ "path": path, "status": "D" })),
                _ => None,
            });
        }
        changes.sort_by(|one, other| one["path"].as_str().cmp(&other["path"].as_str()));
        self.before = self.now.clone();
        (changes, size)
    }
}

/// Returns a unified diff with one hunk, from the first to the last changed line.
fn unified_diff(path: &str, old: &str, new: &str) -> String {
    let (old, new): (Vec<&str>, Vec<&str>) = (old.lines().collect(), new.lines().collect());
    let shorter = old.len().min(new.len());
    let same_start = old.iter().zip(&new).take_while(|(one, other)| one == other).count();
    let same_end = old.iter().rev().zip(new.iter().rev()).take_while(|(one, other)| one == other).count();
    let same_end = same_end.min(shorter - same_start);
    let first = same_start.saturating_sub(CONTEXT_LINES);
    let context_after = same_end.min(CONTEXT_LINES);
    let (old_end, new_end) = (old.len() - same_end, new.len() - same_end);
    let range = |end: usize| {
        let count = end + context_after - first;
        format!("{},{count}", if count == 0 { first } else { first + 1 })
    };
    let mut diff = format!("--- a/{path}\n+++ b/{path}\n@@ -{} +{} @@\n", range(old_end), range(new_end));
    let unchanged_before = old[first..same_start].iter().map(|line| (' ', line));
    let removed = old[same_start..old_end].iter().map(|line| ('-', line));
    let added = new[same_start..new_end].iter().map(|line| ('+', line));
    let unchanged_after = old[old_end..old_end + context_after].iter().map(|line| (' ', line));
    for (mark, line) in unchanged_before.chain(removed).chain(added).chain(unchanged_after) {
        diff.push(mark);
        diff.push_str(line);
        diff.push('\n');
    }
    diff
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unified_diff_has_one_hunk_with_context() {
        let diff = unified_diff("n", "a\nb\nc\nd\ne\nf\n", "a\nb\nc\nX\nY\ne\nf\n");
        assert_eq!(diff, "--- a/n\n+++ b/n\n@@ -2,5 +2,6 @@\n b\n c\n-d\n+X\n+Y\n e\n f\n");
        assert_eq!(unified_diff("n", "", "a"), "--- a/n\n+++ b/n\n@@ -0,0 +1,1 @@\n+a\n");
        assert_eq!(unified_diff("n", "a\na", "a"), "--- a/n\n+++ b/n\n@@ -1,2 +1,1 @@\n a\n-a\n");
    }

    #[test]
    fn take_changes_reports_added_changed_and_deleted_files() {
        let mut files = PlayerFiles::default();
        let code = |name: &str, code: &str| json!({ "name": name, "code": code });
        files.add_call(Some(ToolId::RegisterScript), &code("one", "SELECT 1"), 1);
        files.add_call(Some(ToolId::PythonExec), &json!({ "code": "# python" }), 2);
        let statuses = |files: &mut PlayerFiles| -> Vec<(String, String)> {
            let (changes, _) = files.take_changes();
            let text = |value: &Value| value.as_str().expect("a text").to_owned();
            changes.iter().map(|change| (text(&change["path"]), text(&change["status"]))).collect()
        };
        let pair = |path: &str, status: &str| (path.to_owned(), status.to_owned());
        assert_eq!(statuses(&mut files), [pair("executed/line_2.py", "A"), pair("scripts/one", "A")]);
        files.add_call(Some(ToolId::RegisterScript), &code("one", "SELECT 2"), 3);
        files.add_call(Some(ToolId::RegisterDailyCalculation), &code("one", "SELECT 3"), 4);
        assert_eq!(statuses(&mut files), [pair("calculations/one", "A"), pair("scripts/one", "M")]);
        files.add_call(Some(ToolId::DeleteScript), &code("one", ""), 5);
        assert_eq!(statuses(&mut files), [pair("scripts/one", "D")]);
        assert_eq!(statuses(&mut files), []);
    }
}
