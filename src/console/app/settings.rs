//! Settings that the console starts with.

use std::path::PathBuf;

use crate::keys::KeyBindings;
use novamind_record::folder::configuration::Configuration;
use novamind_report::opponents::PlayOpponentsFn;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;

/// Appearance and locations of the console.
pub struct Settings {
    /// Colors.
    pub theme: Theme,
    /// Keys.
    pub keys: KeyBindings,
    /// Characters that charts are drawn with.
    pub glyphs: Glyphs,
    /// Configuration of the user.
    pub configuration: Configuration,
    /// Folder of the runs.
    pub runs: PathBuf,
    /// The command that resumes the latest run.
    pub resume_command: String,
    /// Whether the start menu lists the runs of all participants.
    pub lists_all_participants: bool,
    /// Plays the opponents of a run.
    pub opponents: PlayOpponentsFn,
}
