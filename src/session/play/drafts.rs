//! Drafts: texts that were typed but not submitted, saved in `drafts.json` in case the program stops.
//!
//! The file is replaced atomically. The drafts are not part of the record and are not exported.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Session;
use novamind_record::error::RunError;
use novamind_record::files::write_atomically;
use novamind_tools::ToolId;

const DRAFTS_FILE: &str = "drafts.json";

/// Texts that were typed but not submitted.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct DraftTexts {
    /// Rationale of the next week.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub rationale: String,
    /// Lower end, predicted value and upper end for each horizon, as typed.
    #[serde(skip_serializing_if = "are_all_empty")]
    pub forecasts: [[String; 3]; 4],
    /// Notes, if they differ from the saved notes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notes: Option<String>,
    /// SQL statement in the query editor.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub sql: String,
    /// Text of a new post.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub post: String,
    /// Number of the post to which the new post replies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answers: Option<u32>,
    /// Offers to enterprises, by thread.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub offers: BTreeMap<u32, String>,
    /// Values in tool forms, by tool and field path.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub forms: BTreeMap<ToolId, BTreeMap<String, String>>,
}

fn are_all_empty(forecasts: &[[String; 3]; 4]) -> bool {
    forecasts.as_flattened().iter().all(String::is_empty)
}

impl DraftTexts {
    /// Returns whether there are no drafts.
    pub fn is_empty(&self) -> bool {
        *self == DraftTexts::default()
    }

    /// Returns each draft text with the name of its field in the record.
    pub fn texts_by_field(&self) -> Vec<(String, String)> {
        let mut all = vec![("rationale".to_owned(), self.rationale.clone())];
        let forecasts = self.forecasts.as_flattened().iter().filter(|text| !text.is_empty()).cloned();
        all.push(("forecasts".to_owned(), forecasts.collect::<Vec<_>>().join(" ")));
        all.push(("notes".to_owned(), self.notes.clone().unwrap_or_default()));
        all.push(("sql".to_owned(), self.sql.clone()));
        all.push(("post".to_owned(), self.post.clone()));
        let offers = self.offers.iter().map(|(thread, offer)| format!("thread {thread}: {offer}"));
        all.push(("offers".to_owned(), offers.collect::<Vec<_>>().join(", ")));
        for (tool, cells) in &self.forms {
            let cells = cells.iter().map(|(path, text)| format!("{path} {text}"));
            all.push((format!("form {tool}"), cells.collect::<Vec<_>>().join(", ")));
        }
        all.retain(|(_, text)| !text.is_empty());
        all
    }
}

/// The drafts file of a run. A run in memory or a run that is open read-only has no drafts file.
pub struct DraftFile(Option<PathBuf>);

impl DraftFile {
    /// Saves the drafts, or removes the file if there are no drafts.
    ///
    /// # Errors
    /// The file cannot be written. The texts are still on the screen.
    pub fn save(&self, drafts: &DraftTexts) -> Result<(), RunError> {
        let Some(file) = &self.0 else { return Ok(()) };
        if drafts.is_empty() {
            let _ = std::fs::remove_file(file);
            return Ok(());
        }
        let Ok(text) = serde_json::to_vec(drafts) else { return Ok(()) };
        write_atomically(file, &text)
    }

    /// Loads the drafts. Returns empty drafts if the file cannot be read.
    pub fn load(&self) -> DraftTexts {
        let text = self.0.as_ref().and_then(|file| std::fs::read(file).ok()).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }
}

impl Session {
    /// Returns the drafts file of the run.
    pub fn draft_file(&self) -> DraftFile {
        let folder = self.folder.as_ref().filter(|_| self.log.is_written());
        DraftFile(folder.map(|folder| folder.join(DRAFTS_FILE)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;

    #[test]
    fn drafts_round_trip_and_empty_drafts_remove_the_file() {
        let runs = tempfile::tempdir().expect("a folder");
        let storage = Storage::Runs(runs.path().to_owned());
        let new = NewRun { storage, projection: false, days: Some(28), ..NewRun::default() };
        let session = Session::create(new, &Configuration::bundled()).expect("a run");
        let mut drafts = DraftTexts { rationale: "wait\nand see".to_owned(), ..DraftTexts::default() };
        drafts.forecasts[1][2] = "1,2".to_owned();
        drafts.forms.entry(ToolId::SetPrices).or_default().insert("A".to_owned(), "12.".to_owned());
        session.draft_file().save(&drafts).expect("saved");
        assert_eq!(session.draft_file().load(), drafts);
        let places: Vec<String> = drafts.texts_by_field().into_iter().map(|(place, _)| place).collect();
        assert_eq!(places, ["rationale", "forecasts", "form set_prices"]);
        let file = session.folder().expect("a folder").join(DRAFTS_FILE);
        std::fs::write(&file, b"{\"rationale\":").expect("written");
        assert!(session.draft_file().load().is_empty(), "a truncated file is ignored");
        session.draft_file().save(&DraftTexts::default()).expect("removed");
        assert!(!file.exists());
        std::fs::create_dir(&file).expect("a folder");
        assert!(session.draft_file().save(&drafts).is_err(), "a folder cannot be replaced by a file");
    }
}
