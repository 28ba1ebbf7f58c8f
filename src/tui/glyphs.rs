//! Sets of characters for drawing frames.

use ratatui::symbols::Marker;
use serde::{Deserialize, Serialize};

/// A set of characters for drawing frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Glyphs {
    /// Braille dots for curves.
    Braille,
    /// Half blocks for curves, for fonts without braille.
    Blocks,
    /// ASCII characters only.
    Ascii,
}

impl Glyphs {
    /// Returns the next set of characters, and the first set after the last.
    pub fn next(self) -> Glyphs {
        match self {
            Glyphs::Braille => Glyphs::Blocks,
            Glyphs::Blocks => Glyphs::Ascii,
            Glyphs::Ascii => Glyphs::Braille,
        }
    }

    /// Returns the marker for drawing curves.
    pub fn marker(self) -> Marker {
        match self {
            Glyphs::Braille => Marker::Braille,
            Glyphs::Blocks => Marker::HalfBlock,
            Glyphs::Ascii => Marker::Dot,
        }
    }

    /// Returns the name that messages use for the set.
    pub fn label(self) -> &'static str {
        match self {
            Glyphs::Braille => "braille dots",
            Glyphs::Blocks => "blocks",
            Glyphs::Ascii => "ASCII characters",
        }
    }
}
