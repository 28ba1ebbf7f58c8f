//! The list of all key bindings as text, for the terminal and the documentation.

use super::action::{ACTIONS, ActionEntry, Scope};
use super::keys::Keys;
use novamind_tui::chord::written;

fn places(keys: &Keys) -> impl Iterator<Item = (Scope, Vec<(&'static ActionEntry, Vec<String>)>)> + '_ {
    Scope::ALL.into_iter().filter_map(move |scope| {
        let own = ACTIONS.iter().filter(|entry| entry.scope == scope);
        let with_keys =
            |entry: &'static ActionEntry| (entry, keys.chords(entry.action).map(written).collect());
        let rows: Vec<(&ActionEntry, Vec<String>)> = own.map(with_keys).collect();
        (!rows.is_empty()).then_some((scope, rows))
    })
}

/// Formats the list in aligned columns.
pub fn text(keys: &Keys) -> String {
    let mut text = String::new();
    for (scope, rows) in places(keys) {
        text.push_str(&format!("{}\n", scope.title()));
        let shown: Vec<(String, &ActionEntry)> =
            rows.into_iter().map(|(entry, chords)| (chords.join(", "), entry)).collect();
        let width = shown.iter().map(|(chords, _)| chords.len()).max().unwrap_or(0);
        for (chords, entry) in shown {
            text.push_str(&format!("  {chords:<width$}  {}\n", entry.doc));
        }
        text.push('\n');
    }
    text
}

/// Formats the list as Markdown, a table per scope.
pub fn markdown(keys: &Keys) -> String {
    let mut text = String::new();
    for (scope, rows) in places(keys) {
        text.push_str(&format!("**{}**\n\n| keys | |\n|---|---|\n", scope.title()));
        for (entry, chords) in rows {
            let chords: Vec<String> =
                chords.iter().map(|chord| format!("`{}`", chord.replace('|', "\\|"))).collect();
            let chords = if chords.is_empty() { "palette".to_owned() } else { chords.join(" ") };
            text.push_str(&format!("| {chords} | {} |\n", entry.doc));
        }
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_action_is_in_the_manual_once() {
        let keys = Keys::shipped();
        for manual in [text(&keys), markdown(&keys)] {
            for entry in ACTIONS {
                assert!(manual.contains(entry.doc), "{}", entry.name);
            }
        }
        assert!(text(&keys).contains("  n "), "{}", text(&keys));
        assert!(markdown(&keys).contains("| `n` | Review the changes"), "{}", markdown(&keys));
    }

    #[test]
    fn documents_have_the_keys_that_the_program_has() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/interfaces/keys.md");
        let page = std::fs::read_to_string(path).expect("the page of keys");
        let shipped = format!("{}\n", markdown(&Keys::shipped()).trim_end());
        if page.ends_with(&shipped) {
            return;
        }
        assert!(
            std::env::var_os("NOVAMIND_WRITE_DOCUMENTS").is_some(),
            "docs/interfaces/keys.md is out of date; run this test with NOVAMIND_WRITE_DOCUMENTS=1 to update it"
        );
        let first = format!("**{}**", Scope::Global.title());
        let words = page.split_once(&first).map_or(page.as_str(), |(words, _)| words);
        std::fs::write(path, format!("{words}{shipped}")).expect("the page is written");
    }
}
