//! Preferences for the appearance of the console and for table columns, which the user sets by pressing keys. They are
//! saved as `console.toml` in the configuration folder.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::widgets::ColumnLayout;

const PREFERENCES_FILE: &str = "console.toml";

/// Preferences for the appearance of the console.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// Name of the chosen theme; `None` for the default theme.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub theme: Option<String>,
    /// Character set for drawing charts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub marker: Option<Glyphs>,
    /// Layouts of tables whose columns the user has changed, by table name.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub tables: BTreeMap<String, ColumnLayout>,
}

impl Preferences {
    /// Loads the saved preferences. Ignores an unreadable file, which is replaced when preferences are saved.
    pub fn load(configuration: &Configuration) -> Preferences {
        let file = configuration.read_file(PREFERENCES_FILE).ok().flatten();
        file.and_then(|source| toml::from_str(&source.text).ok()).unwrap_or_default()
    }

    /// Saves the preferences that are set, and keeps the saved values of all others.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn save(self, configuration: &Configuration) -> Result<(), RunError> {
        let Some(folder) = &configuration.folder else { return Ok(()) };
        let before = Preferences::load(configuration);
        let mut tables = before.tables;
        tables.extend(self.tables);
        tables.retain(|_, layout| !layout.is_default());
        let all =
            Preferences { theme: self.theme.or(before.theme), marker: self.marker.or(before.marker), tables };
        std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
        let (path, draft) = (folder.join(PREFERENCES_FILE), folder.join("console.draft"));
        let text = toml::to_string(&all).expect("preferences are plain values");
        std::fs::write(&draft, text).map_err(RunError::io(&draft))?;
        std::fs::rename(&draft, &path).map_err(RunError::io(&path))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn save_keeps_preferences_that_are_not_set() {
        let folder = tempfile::tempdir().expect("a folder");
        let configuration = Configuration { folder: Some(folder.path().join("not-yet")), voice: None };
        assert_eq!(Preferences::load(&configuration), Preferences::default());
        let light = Preferences { theme: Some("light".to_owned()), ..Preferences::default() };
        light.save(&configuration).expect("kept");
        let ascii = Preferences { marker: Some(Glyphs::Ascii), ..Preferences::default() };
        ascii.save(&configuration).expect("kept");
        let both = Preferences {
            theme: Some("light".to_owned()),
            marker: Some(Glyphs::Ascii),
            ..Preferences::default()
        };
        assert_eq!(Preferences::load(&configuration), both);
        std::fs::write(folder.path().join("not-yet/console.toml"), "marker = 3").expect("written");
        assert_eq!(Preferences::load(&configuration), Preferences::default());
    }

    #[test]
    fn save_replaces_the_layout_of_one_table() {
        let folder = tempfile::tempdir().expect("a folder");
        let configuration = Configuration { folder: Some(folder.path().to_owned()), voice: None };
        let save = |table: &str, layout: ColumnLayout| {
            let tables = [(table.to_owned(), layout)].into();
            Preferences { tables, ..Preferences::default() }.save(&configuration).expect("saved");
        };
        let hidden = ColumnLayout { hidden: ["kind".to_owned()].into(), ..ColumnLayout::default() };
        let wide = ColumnLayout { widths: [("billed/mo".to_owned(), 12)].into(), ..ColumnLayout::default() };
        save("customers.groups", hidden);
        save("cash.ledger", wide.clone());
        save("customers.groups", ColumnLayout::default());
        let saved = Preferences::load(&configuration).tables;
        assert_eq!(saved, [("cash.ledger".to_owned(), wide)].into(), "a default layout is not saved");
    }
}
