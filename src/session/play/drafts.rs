//! Texts that were typed and not sent, kept beside a run for the case that the program is stopped: `drafts.json`.
//!
//! The file is written whole and takes the place of the old one. It is no part of the record, and is not exported.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Session;
use novamind_record::files::write_whole;
use novamind_tools::ToolId;

/// Name of the file in the folder of the run.
const FILE: &str = "drafts.json";

/// Texts that were typed and not sent.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct UnsentTexts {
    /// Why the next week is as it is.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub rationale: String,
    /// Low, point, high of every horizon, as far as they were typed.
    #[serde(skip_serializing_if = "is_unset")]
    pub forecasts: [[String; 3]; 4],
    /// Notes that differ from those that are kept.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub notes: Option<String>,
    /// A statement that was not asked.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub sql: String,
    /// A post.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub post: String,
    /// The post that it answers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answers: Option<u32>,
    /// Values in forms of tools, by their paths.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub forms: BTreeMap<ToolId, BTreeMap<String, String>>,
}

fn is_unset(forecasts: &[[String; 3]; 4]) -> bool {
    forecasts.as_flattened().iter().all(String::is_empty)
}

impl UnsentTexts {
    /// Whether there is nothing.
    pub fn is_empty(&self) -> bool {
        *self == UnsentTexts::default()
    }

    /// Each text with its place, as the record names it.
    pub fn places(&self) -> Vec<(String, String)> {
        let mut all = vec![("rationale".to_owned(), self.rationale.clone())];
        let forecasts = self.forecasts.as_flattened().iter().filter(|text| !text.is_empty()).cloned();
        all.push(("forecasts".to_owned(), forecasts.collect::<Vec<_>>().join(" ")));
        all.push(("notes".to_owned(), self.notes.clone().unwrap_or_default()));
        all.push(("sql".to_owned(), self.sql.clone()));
        all.push(("post".to_owned(), self.post.clone()));
        for (tool, cells) in &self.forms {
            let cells = cells.iter().map(|(path, text)| format!("{path} {text}"));
            all.push((format!("form {tool}"), cells.collect::<Vec<_>>().join(", ")));
        }
        all.retain(|(_, text)| !text.is_empty());
        all
    }
}

/// The file of texts that were typed and not sent in a run that is played; a run in memory, or one that is only read, keeps
/// none.
pub struct Drafts(Option<PathBuf>);

impl Drafts {
    /// Keeps texts beside the run; no file where there are none. A disk that refuses them is no reason to stop: they are in the
    /// window.
    pub fn keep(&self, drafts: &UnsentTexts) {
        let Some(file) = &self.0 else { return };
        if drafts.is_empty() {
            let _ = std::fs::remove_file(file);
            return;
        }
        let Ok(text) = serde_json::to_vec(drafts) else { return };
        let _ = write_whole(file, &text);
    }

    /// Texts that were kept when the program was stopped; none that cannot be read.
    pub fn kept(&self) -> UnsentTexts {
        let text = self.0.as_ref().and_then(|file| std::fs::read(file).ok()).unwrap_or_default();
        serde_json::from_slice(&text).unwrap_or_default()
    }
}

impl Session {
    /// Texts that were typed and not sent.
    pub fn drafts(&self) -> Drafts {
        let folder = self.folder.as_ref().filter(|_| self.log.is_written());
        Drafts(folder.map(|folder| folder.join(FILE)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;

    #[test]
    fn texts_are_kept_whole_and_leave_no_file_when_there_are_none() {
        let runs = tempfile::tempdir().expect("a folder");
        let storage = Storage::Runs(runs.path().to_owned());
        let new = NewRun { storage, projection: false, days: Some(28), ..NewRun::default() };
        let session = Session::create(new, &Configuration::shipped()).expect("a run");
        let mut drafts = UnsentTexts { rationale: "wait\nand see".to_owned(), ..UnsentTexts::default() };
        drafts.forecasts[1][2] = "1,2".to_owned();
        drafts.forms.entry(ToolId::SetPrices).or_default().insert("A".to_owned(), "12.".to_owned());
        session.drafts().keep(&drafts);
        assert_eq!(session.drafts().kept(), drafts);
        let places: Vec<String> = drafts.places().into_iter().map(|(place, _)| place).collect();
        assert_eq!(places, ["rationale", "forecasts", "form set_prices"]);
        let file = session.folder().expect("a folder").join(FILE);
        std::fs::write(&file, b"{\"rationale\":").expect("written");
        assert!(session.drafts().kept().is_empty(), "half a file is none");
        session.drafts().keep(&UnsentTexts::default());
        assert!(!file.exists());
    }
}
