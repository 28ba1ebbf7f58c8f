//! What frames are drawn with.

use ratatui::symbols::Marker;
use serde::{Deserialize, Serialize};

/// What a frame is drawn with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Glyphs {
    /// Curves of braille dots.
    Braille,
    /// Curves of half blocks, for fonts without braille.
    Blocks,
    /// ASCII alone.
    Ascii,
}

impl Glyphs {
    /// The next ones, the first ones again after the last.
    pub fn next(self) -> Glyphs {
        match self {
            Glyphs::Braille => Glyphs::Blocks,
            Glyphs::Blocks => Glyphs::Ascii,
            Glyphs::Ascii => Glyphs::Braille,
        }
    }

    /// What curves are drawn with.
    pub fn marker(self) -> Marker {
        match self {
            Glyphs::Braille => Marker::Braille,
            Glyphs::Blocks => Marker::HalfBlock,
            Glyphs::Ascii => Marker::Dot,
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Glyphs::Braille => "braille dots",
            Glyphs::Blocks => "blocks",
            Glyphs::Ascii => "ASCII signs",
        }
    }
}
