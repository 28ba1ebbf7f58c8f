//! What the console is begun with.

use std::path::PathBuf;

use crate::keys::Keys;
use novamind_record::folder::configuration::Configuration;
use novamind_report::opponents::PlayOpponents;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;

/// How the console looks and where it keeps things.
pub struct Settings {
    /// Colours.
    pub theme: Theme,
    /// Keys.
    pub keys: Keys,
    /// What is drawn with.
    pub glyphs: Glyphs,
    /// Configuration of this person.
    pub configuration: Configuration,
    /// Folder of the runs.
    pub runs: PathBuf,
    /// The command that goes on with the newest run.
    pub again: String,
    /// The start menu lists the runs of all participants.
    pub lists_everybody: bool,
    /// What plays the opponents of a run.
    pub opponents: PlayOpponents,
}
