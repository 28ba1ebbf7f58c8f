//! Chords: keys with modifiers, in the notation of key files, for example `n`, `ctrl-s` and `shift-tab`.

use std::fmt;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

const MAX_SEQUENCE_CHORDS: usize = 3;

/// A key with its modifiers, such as ctrl and shift.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd)]
pub struct Chord {
    code: KeyCode,
    ctrl: bool,
    alt: bool,
    shift: bool,
}

/// Names of keys that are not characters.
const NAMED_KEYS: [(&str, KeyCode); 15] = [
    ("enter", KeyCode::Enter),
    ("esc", KeyCode::Esc),
    ("tab", KeyCode::Tab),
    ("space", KeyCode::Char(' ')),
    ("backspace", KeyCode::Backspace),
    ("delete", KeyCode::Delete),
    ("insert", KeyCode::Insert),
    ("up", KeyCode::Up),
    ("down", KeyCode::Down),
    ("left", KeyCode::Left),
    ("right", KeyCode::Right),
    ("home", KeyCode::Home),
    ("end", KeyCode::End),
    ("pageup", KeyCode::PageUp),
    ("pagedown", KeyCode::PageDown),
];

impl Chord {
    /// Returns the chord of a key event.
    pub fn from_event(event: &KeyEvent) -> Chord {
        let has = |modifier| event.modifiers.contains(modifier);
        let (mut code, mut shift) = (event.code, has(KeyModifiers::SHIFT));
        if code == KeyCode::BackTab {
            (code, shift) = (KeyCode::Tab, true);
        }
        // The character already depends on the shift key.
        if matches!(code, KeyCode::Char(_)) {
            shift = false;
        }
        Chord { code, ctrl: has(KeyModifiers::CONTROL), alt: has(KeyModifiers::ALT), shift }
    }

    /// Parses a chord in the notation of key files.
    ///
    /// # Errors
    /// The text is not a chord. The message contains the reason.
    pub fn parse(text: &str) -> Result<Chord, String> {
        let mut chord = Chord { code: KeyCode::Null, ctrl: false, alt: false, shift: false };
        let mut rest = text;
        loop {
            rest = match rest {
                _ if rest.starts_with("ctrl-") => {
                    chord.ctrl = true;
                    &rest[5..]
                }
                _ if rest.starts_with("alt-") => {
                    chord.alt = true;
                    &rest[4..]
                }
                _ if rest.starts_with("shift-") => {
                    chord.shift = true;
                    &rest[6..]
                }
                _ => break,
            };
        }
        let mut letters = rest.chars();
        chord.code = match (letters.next(), letters.next()) {
            (Some(letter), None) if !letter.is_control() => KeyCode::Char(letter),
            _ => match NAMED_KEYS.iter().find(|(name, _)| *name == rest) {
                Some((_, code)) => *code,
                None => rest
                    .strip_prefix('f')
                    .and_then(|number| number.parse::<u8>().ok())
                    .filter(|number| (1..=12).contains(number))
                    .map(KeyCode::F)
                    .ok_or_else(|| format!("{text:?} is not a key"))?,
            },
        };
        Ok(chord)
    }

    /// Returns the key event that a terminal would send for the chord.
    pub fn to_event(&self) -> KeyEvent {
        let mut modifiers = KeyModifiers::NONE;
        for (is_held, modifier) in [
            (self.ctrl, KeyModifiers::CONTROL),
            (self.alt, KeyModifiers::ALT),
            (self.shift, KeyModifiers::SHIFT),
        ] {
            modifiers.set(modifier, is_held);
        }
        KeyEvent::new(self.code, modifiers)
    }

    /// Returns whether the chord is the escape key.
    pub fn is_escape(&self) -> bool {
        self.code == KeyCode::Esc
    }

    /// Returns whether the chord is a printable character.
    pub fn is_printable(&self) -> bool {
        matches!(self.code, KeyCode::Char(_)) && !self.ctrl && !self.alt
    }

    /// Returns whether the chord can be the first key of a number.
    pub fn starts_number(&self) -> bool {
        matches!(self.code, KeyCode::Char(letter) if letter.is_ascii_digit() || matches!(letter, '$' | '.' | '-'))
            && !self.ctrl
            && !self.alt
    }

    /// Returns whether the chord deletes a character of a text.
    pub fn is_deletion(&self) -> bool {
        matches!(self.code, KeyCode::Backspace | KeyCode::Delete)
    }

    /// Returns whether the chord moves the cursor of a text.
    pub fn is_movement(&self) -> bool {
        matches!(
            self.code,
            KeyCode::Left
                | KeyCode::Right
                | KeyCode::Up
                | KeyCode::Down
                | KeyCode::Home
                | KeyCode::End
                | KeyCode::PageUp
                | KeyCode::PageDown
        )
    }

    /// Returns whether text fields and editors handle the chord.
    pub fn is_text_input(&self) -> bool {
        match self.code {
            KeyCode::Char(_) => !self.ctrl && !self.alt,
            KeyCode::Enter => true,
            KeyCode::Tab => !self.shift,
            _ => self.is_deletion() || self.is_movement(),
        }
    }
}

impl fmt::Display for Chord {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (is_held, name) in [(self.ctrl, "ctrl-"), (self.alt, "alt-"), (self.shift, "shift-")] {
            if is_held {
                formatter.write_str(name)?;
            }
        }
        match self.code {
            KeyCode::Char(letter) if letter != ' ' => write!(formatter, "{letter}"),
            KeyCode::F(number) => write!(formatter, "f{number}"),
            code => {
                let name = NAMED_KEYS.iter().find(|(_, named)| *named == code).map_or("?", |(name, _)| name);
                formatter.write_str(name)
            }
        }
    }
}

/// Parses a sequence of chords.
///
/// # Errors
/// A chord cannot be parsed, or the sequence has too many chords.
pub fn parse_sequence(text: &str) -> Result<Vec<Chord>, String> {
    let chords: Result<Vec<Chord>, String> = text.split(' ').map(Chord::parse).collect();
    let chords = chords?;
    if chords.len() > MAX_SEQUENCE_CHORDS {
        return Err(format!("{text:?} has more than {MAX_SEQUENCE_CHORDS} keys"));
    }
    Ok(chords)
}

/// Formats chords in the notation of key files.
pub fn format_sequence(chords: &[Chord]) -> String {
    chords.iter().map(Chord::to_string).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formatted_chords_parse_to_the_same_chords() {
        for text in
            ["n", "N", ":", "ctrl-s", "shift-tab", "f5", "space", "pageup", "ctrl-enter", "-", "ctrl--"]
        {
            assert_eq!(Chord::parse(text).expect(text).to_string(), text);
        }
        for text in ["", "ctrl-", "f0", "f13", "entr", "ab"] {
            assert!(Chord::parse(text).is_err(), "{text}");
        }
    }
}
