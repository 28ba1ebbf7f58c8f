//! The list of all key bindings, as text for the terminal and as Markdown for the documentation.

use super::action::{ACTIONS, ActionEntry, Scope};
use super::keys::KeyBindings;
use novamind_tui::chord::format_sequence;

fn actions_by_scope(
    keys: &KeyBindings,
) -> impl Iterator<Item = (Scope, Vec<(&'static ActionEntry, Vec<String>)>)> + '_ {
    Scope::ALL.into_iter().filter_map(move |scope| {
        let entries = ACTIONS.iter().filter(|entry| entry.scope == scope);
        let with_keys =
            |entry: &'static ActionEntry| (entry, keys.chords(entry.action).map(format_sequence).collect());
        let rows: Vec<(&ActionEntry, Vec<String>)> = entries.map(with_keys).collect();
        (!rows.is_empty()).then_some((scope, rows))
    })
}

/// Formats all key bindings as text in aligned columns.
pub fn to_text(keys: &KeyBindings) -> String {
    let mut text = String::new();
    for (scope, rows) in actions_by_scope(keys) {
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

/// Formats all key bindings as Markdown, with one table per scope.
pub fn to_markdown(keys: &KeyBindings) -> String {
    let mut text = String::new();
    for (scope, rows) in actions_by_scope(keys) {
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
    fn manual_lists_every_action_once() {
        let keys = KeyBindings::bundled();
        for manual in [to_text(&keys), to_markdown(&keys)] {
            for entry in ACTIONS {
                assert!(manual.contains(entry.doc), "{}", entry.name);
            }
        }
        assert!(to_text(&keys).contains("  n "), "{}", to_text(&keys));
        assert!(to_markdown(&keys).contains("| `n` | Review the changes"), "{}", to_markdown(&keys));
    }

    #[test]
    fn documentation_matches_the_key_bindings() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/interfaces/keys.md");
        let page = std::fs::read_to_string(path).expect("the page of keys");
        let bundled = format!("{}\n", to_markdown(&KeyBindings::bundled()).trim_end());
        if page.ends_with(&bundled) {
            return;
        }
        assert!(
            std::env::var_os("NOVAMIND_WRITE_DOCUMENTS").is_some(),
            "docs/interfaces/keys.md is out of date; run this test with NOVAMIND_WRITE_DOCUMENTS=1 to update it"
        );
        let first = format!("**{}**", Scope::Global.title());
        let words = page.split_once(&first).map_or(page.as_str(), |(words, _)| words);
        std::fs::write(path, format!("{words}{bundled}")).expect("the page is written");
    }
}
