//! Keys: which chords ask for which action where. Read from `configs/keys.toml`; a person's file patches it.
//!
//! A binding is one chord or a few pressed one after the other: `n`, `; c`. Nothing depends on how fast they come.

use std::collections::BTreeMap;
use std::fmt;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use toml::Table;

use super::action::{Action, Scope};

/// A key with its modifiers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd)]
pub struct Chord {
    code: KeyCode,
    ctrl: bool,
    alt: bool,
    shift: bool,
}

/// Names of keys that are no characters.
const NAMED: [(&str, KeyCode); 15] = [
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
    /// The chord of a key event.
    pub fn of(event: &KeyEvent) -> Chord {
        let has = |modifier| event.modifiers.contains(modifier);
        let (mut code, mut shift) = (event.code, has(KeyModifiers::SHIFT));
        if code == KeyCode::BackTab {
            (code, shift) = (KeyCode::Tab, true);
        }
        // A character already says whether shift was held.
        if matches!(code, KeyCode::Char(_)) {
            shift = false;
        }
        Chord { code, ctrl: has(KeyModifiers::CONTROL), alt: has(KeyModifiers::ALT), shift }
    }

    /// Reads a chord as the key file writes it.
    ///
    /// # Errors
    /// What is wrong with it.
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
            _ => match NAMED.iter().find(|(name, _)| *name == rest) {
                Some((_, code)) => *code,
                None => rest
                    .strip_prefix('f')
                    .and_then(|number| number.parse::<u8>().ok())
                    .filter(|number| (1..=12).contains(number))
                    .map(KeyCode::F)
                    .ok_or_else(|| format!("{text:?} is no key"))?,
            },
        };
        Ok(chord)
    }

    /// The event a terminal would send.
    pub fn event(&self) -> KeyEvent {
        let mut modifiers = KeyModifiers::NONE;
        for (held, modifier) in [
            (self.ctrl, KeyModifiers::CONTROL),
            (self.alt, KeyModifiers::ALT),
            (self.shift, KeyModifiers::SHIFT),
        ] {
            modifiers.set(modifier, held);
        }
        KeyEvent::new(self.code, modifiers)
    }

    /// Whether it is the key that cancels.
    pub fn is_escape(&self) -> bool {
        self.code == KeyCode::Esc
    }

    /// Whether it is a character that is typed.
    pub fn is_printable(&self) -> bool {
        matches!(self.code, KeyCode::Char(_)) && !self.ctrl && !self.alt
    }

    /// Whether it begins a number.
    pub fn begins_number(&self) -> bool {
        matches!(self.code, KeyCode::Char(letter) if letter.is_ascii_digit() || matches!(letter, '$' | '.' | '-'))
            && !self.ctrl
            && !self.alt
    }

    /// Whether a text field wants it for itself.
    pub fn is_text(&self) -> bool {
        match self.code {
            KeyCode::Char(_) => !self.ctrl && !self.alt,
            KeyCode::Backspace
            | KeyCode::Delete
            | KeyCode::Left
            | KeyCode::Right
            | KeyCode::Up
            | KeyCode::Down
            | KeyCode::Home
            | KeyCode::End
            | KeyCode::PageUp
            | KeyCode::PageDown
            | KeyCode::Enter => true,
            KeyCode::Tab => !self.shift,
            _ => false,
        }
    }
}

impl fmt::Display for Chord {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (held, name) in [(self.ctrl, "ctrl-"), (self.alt, "alt-"), (self.shift, "shift-")] {
            if held {
                formatter.write_str(name)?;
            }
        }
        match self.code {
            KeyCode::Char(letter) if letter != ' ' => write!(formatter, "{letter}"),
            KeyCode::F(number) => write!(formatter, "f{number}"),
            code => {
                let name = NAMED.iter().find(|(_, named)| *named == code).map_or("?", |(name, _)| name);
                formatter.write_str(name)
            }
        }
    }
}

/// Longest row of chords for one action.
const LONGEST: usize = 3;

/// What chords mean where the focus is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Meaning {
    /// They ask for an action.
    Action(Action),
    /// They begin something: another chord has to follow.
    Begin,
    /// Nothing.
    Nothing,
}

/// What chords mean in every scope.
#[derive(Debug, Clone)]
pub struct Keys(BTreeMap<Scope, Vec<(Vec<Chord>, Action)>>);

const SHIPPED: &str = include_str!("../../configs/keys.toml");

impl Keys {
    /// The shipped keys.
    pub fn shipped() -> Keys {
        let mut keys = Keys(BTreeMap::new());
        keys.patch(SHIPPED).expect("a test reads the shipped keys");
        keys
    }

    /// The shipped keys, patched by a person's file.
    ///
    /// # Errors
    /// What is wrong with the file, with its name.
    pub fn of_user(configuration: &novamind_session::Configuration) -> Result<Keys, String> {
        let mut keys = Keys::shipped();
        if let Some(source) = configuration.file("keys.toml").map_err(|error| error.to_string())? {
            keys.patch(&source.text).map_err(|problem| format!("{}: {problem}", source.name))?;
        }
        Ok(keys)
    }

    /// Replaces the keys of the actions that a file names.
    fn patch(&mut self, text: &str) -> Result<(), String> {
        let file: Table = text.parse().map_err(|error: toml::de::Error| error.to_string())?;
        for (name, actions) in &file {
            let scope = Scope::ALL
                .into_iter()
                .find(|scope| scope.id() == name)
                .ok_or_else(|| format!("there is no place {name}"))?;
            let actions = actions.as_table().ok_or_else(|| format!("[{name}] is no table"))?;
            for (own, chords) in actions {
                let action =
                    Action::named(scope, own).ok_or_else(|| format!("[{name}] has no action {own}"))?;
                self.bind(scope, action, chords).map_err(|problem| format!("[{name}] {own}: {problem}"))?;
            }
        }
        Ok(())
    }

    fn bind(&mut self, scope: Scope, action: Action, chords: &toml::Value) -> Result<(), String> {
        let list = chords.as_array().ok_or("a list of keys is expected, for instance [\"n\"]")?;
        let parsed: Result<Vec<Vec<Chord>>, String> = list
            .iter()
            .map(|chords| sequence(chords.as_str().ok_or("a key is text, for instance \"n\"")?))
            .collect();
        let bindings = self.0.entry(scope).or_default();
        bindings.retain(|(_, own)| *own != action);
        for chords in parsed? {
            let clash = |bound: &[Chord]| bound.starts_with(&chords) || chords.starts_with(bound);
            if let Some((bound, other)) = bindings.iter().find(|(bound, _)| clash(bound)) {
                return Err(format!("{} already means {}", written(bound), other.entry().name));
            }
            bindings.push((chords, action));
        }
        Ok(())
    }

    /// What chords pressed one after the other mean in the first of these scopes that knows them.
    pub fn meaning(&self, scopes: &[Scope], pressed: &[Chord]) -> Meaning {
        let in_scope = |scope: &Scope| {
            let mut begins = self.0.get(scope)?.iter().filter(|(bound, _)| bound.starts_with(pressed));
            let (bound, action) = begins.next()?;
            Some(if bound.len() == pressed.len() { Meaning::Action(*action) } else { Meaning::Begin })
        };
        scopes.iter().find_map(in_scope).unwrap_or(Meaning::Nothing)
    }

    /// What may follow chords: the next ones, and the action at their end.
    pub fn continuations(&self, scopes: &[Scope], pressed: &[Chord]) -> Vec<(String, Action)> {
        let longer = |(bound, action): &(Vec<Chord>, Action)| {
            let rest = bound.strip_prefix(pressed).filter(|rest| !rest.is_empty());
            rest.map(|rest| (written(rest), *action))
        };
        let mut following: Vec<(String, Action)> = Vec::new();
        for found in scopes.iter().filter_map(|scope| self.0.get(scope)).flatten().filter_map(longer) {
            if !following.iter().any(|(chords, _)| *chords == found.0) {
                following.push(found);
            }
        }
        following
    }

    /// What one chord means in the first of these scopes that knows it.
    pub fn action(&self, scopes: &[Scope], chord: Chord) -> Option<Action> {
        match self.meaning(scopes, &[chord]) {
            Meaning::Action(action) => Some(action),
            _ => None,
        }
    }

    /// The first keys of an action, as the footer shows them.
    pub fn label(&self, action: Action) -> Option<String> {
        self.chords(action).next().map(written)
    }

    /// All keys of an action.
    pub fn chords(&self, action: Action) -> impl Iterator<Item = &[Chord]> + '_ {
        let bindings = self.0.get(&action.entry().scope).into_iter().flatten();
        bindings.filter(move |(_, own)| *own == action).map(|(chords, _)| chords.as_slice())
    }

    /// Keys that ask for an action where these scopes hold: not those that an inner scope uses for something else.
    pub fn working(&self, action: Action, scopes: &[Scope]) -> Vec<String> {
        let works = |chords: &&[Chord]| self.meaning(scopes, chords) == Meaning::Action(action);
        self.chords(action).filter(works).map(written).collect()
    }
}

/// Reads chords that are pressed one after the other.
fn sequence(text: &str) -> Result<Vec<Chord>, String> {
    let chords: Result<Vec<Chord>, String> = text.split(' ').map(Chord::parse).collect();
    let chords = chords?;
    if chords.len() > LONGEST {
        return Err(format!("{text:?} is longer than {LONGEST} keys"));
    }
    Ok(chords)
}

/// Chords as the key file writes them.
pub fn written(chords: &[Chord]) -> String {
    chords.iter().map(Chord::to_string).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::ACTIONS;

    #[test]
    fn chords_read_back_as_they_are_written() {
        for text in
            ["n", "N", ":", "ctrl-s", "shift-tab", "f5", "space", "pageup", "ctrl-enter", "-", "ctrl--"]
        {
            assert_eq!(Chord::parse(text).expect(text).to_string(), text);
        }
        for text in ["", "ctrl-", "f0", "f13", "entr", "ab"] {
            assert!(Chord::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn every_action_is_in_the_key_file_and_names_are_unique() {
        let file: Table = SHIPPED.parse().expect("TOML");
        for entry in ACTIONS {
            let bound = file.get(entry.scope.id()).and_then(|scope| scope.get(entry.name));
            assert!(bound.is_some(), "{}.{} is missing in keys.toml", entry.scope.id(), entry.name);
            let same = ACTIONS.iter().filter(|other| (other.scope, other.name) == (entry.scope, entry.name));
            assert_eq!(same.count(), 1, "{}", entry.name);
        }
    }

    #[test]
    fn a_file_patches_single_actions_and_errors_name_the_place() {
        let mut keys = Keys::shipped();
        keys.patch("[global]\nquit = [\"ctrl-q\"]").expect("a patch");
        assert_eq!(keys.label(Action::Quit).as_deref(), Some("ctrl-q"));
        assert_eq!(keys.label(Action::NextWeek).as_deref(), Some("n"));
        for (file, part) in [
            ("[globl]\nquit = []", "there is no place globl"),
            ("[global]\nquitt = []", "has no action quitt"),
            ("[global]\nquit = \"q\"", "a list of keys"),
            ("[global]\nquit = [\"hyper-q\"]", "is no key"),
            ("[global]\nquit = [\"n\"]", "already means next-week"),
            ("[global", "expected"),
        ] {
            let problem = Keys::shipped().patch(file).expect_err(file);
            assert!(problem.contains(part), "{problem}");
        }
    }

    #[test]
    fn keys_that_begin_something_name_what_may_follow() {
        let mut keys = Keys::shipped();
        keys.patch("[global]\nquit = [\", q\", \", x y\"]").expect("a patch");
        let pressed = |text: &str| sequence(text).expect("keys");
        let scopes = [Scope::List, Scope::Global];
        assert_eq!(keys.meaning(&scopes, &pressed(",")), Meaning::Begin);
        assert_eq!(keys.meaning(&scopes, &pressed(", q")), Meaning::Action(Action::Quit));
        assert_eq!(keys.meaning(&scopes, &pressed(", x")), Meaning::Begin);
        assert_eq!(keys.meaning(&scopes, &pressed(", n")), Meaning::Nothing);
        let following = [("q".to_owned(), Action::Quit), ("x y".to_owned(), Action::Quit)];
        assert_eq!(keys.continuations(&scopes, &pressed(",")), following);
        assert_eq!(keys.label(Action::Quit).as_deref(), Some(", q"));
        let clash = keys.patch("[global]\nundo = [\",\"]").expect_err("a clash");
        assert!(clash.contains("already means quit"), "{clash}");
    }

    #[test]
    fn the_innermost_scope_counts() {
        let keys = Keys::shipped();
        let enter = Chord::parse("enter").expect("a key");
        assert_eq!(keys.action(&[Scope::Result, Scope::List], enter), Some(Action::WholeCell));
        assert_eq!(keys.action(&[Scope::List, Scope::Global], enter), Some(Action::Open));
        assert_eq!(keys.action(&[Scope::Global], enter), None);
    }
}
