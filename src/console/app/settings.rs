//! Settings that the console starts with.

use std::path::PathBuf;

use crate::keys::KeyBindings;
use novamind_record::folder::configuration::Configuration;
use novamind_report::opponents::PlayOpponentsFn;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;

/// Appearance and locations of the console.
pub struct Settings {
    /// Colors of the console.
    pub theme: Theme,
    /// Key bindings.
    pub keys: KeyBindings,
    /// Characters that are used to draw charts.
    pub glyphs: Glyphs,
    /// The user's configuration.
    pub configuration: Configuration,
    /// The folder that contains the runs.
    pub runs: PathBuf,
    /// The command that resumes the latest run.
    pub resume_command: String,
    /// Whether the start menu lists the runs of all participants.
    pub lists_all_participants: bool,
    /// Whether the session runs on a server, for a participant who uses only the screen.
    pub hosted: bool,
    /// Function that plays the opponents of a run.
    pub opponents: PlayOpponentsFn,
}
