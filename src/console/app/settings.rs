//! Settings that the console starts with.

use std::path::PathBuf;

use crate::keys::Keys;
use novamind_record::folder::configuration::Configuration;
use novamind_report::opponents::PlayOpponents;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;

/// Appearance and locations of the console.
pub struct Settings {
    /// Colors.
    pub theme: Theme,
    /// Keys.
    pub keys: Keys,
    /// Characters that charts are drawn with.
    pub glyphs: Glyphs,
    /// Configuration of the user.
    pub configuration: Configuration,
    /// Folder of the runs.
    pub runs: PathBuf,
    /// The command that resumes the latest run.
    pub again: String,
    /// Whether the start menu lists the runs of all participants.
    pub lists_everybody: bool,
    /// Plays the opponents of a run.
    pub opponents: PlayOpponents,
}
