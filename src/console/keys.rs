//! Key bindings: which chords trigger which action in which scope. The bindings are read from `configs/keys.toml` and
//! patched by a file of the user.
//!
//! A binding is one chord or a short sequence: `n`, `; c`. The time between the chords of a sequence does not matter.

use std::collections::{BTreeMap, BTreeSet};

use toml::Table;

use super::action::{ACTIONS, Action, Scope};
use novamind_tui::chord::{Chord, format_sequence, parse_sequence};

/// The meaning of a chord sequence in the focused pane or dialog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KeyMeaning {
    /// The chords trigger an action.
    Action(Action),
    /// The chords are the start of a sequence.
    Prefix,
    /// The chords are not bound.
    Unbound,
}

/// The key bindings, by scope.
#[derive(Debug, Clone)]
pub struct KeyBindings {
    bindings: BTreeMap<Scope, Vec<(Vec<Chord>, Action)>>,
    /// Actions that are not available, so that they have no keys and cannot be chosen otherwise.
    removed: BTreeSet<Action>,
}

const BUNDLED_KEYS: &str = include_str!("../../configs/keys.toml");

impl KeyBindings {
    /// Returns the bundled bindings.
    pub fn bundled() -> KeyBindings {
        let mut keys = KeyBindings { bindings: BTreeMap::new(), removed: BTreeSet::new() };
        keys.patch(BUNDLED_KEYS).expect("a test parses the bundled keys");
        keys
    }

    /// Returns the bundled bindings, patched by a file of the user.
    ///
    /// # Errors
    /// The file is invalid. The error contains the name of the file.
    pub fn with_user_file(
        configuration: &novamind_record::folder::configuration::Configuration,
    ) -> Result<KeyBindings, String> {
        let mut keys = KeyBindings::bundled();
        if let Some(source) = configuration.read_file("keys.toml").map_err(|error| error.to_string())? {
            keys.patch(&source.text).map_err(|problem| format!("{}: {problem}", source.name))?;
        }
        Ok(keys)
    }

    /// Makes all other actions unavailable and removes their bindings.
    pub fn retain_actions(mut self, is_available: impl Fn(Action) -> bool) -> KeyBindings {
        self.bindings.values_mut().for_each(|bound| bound.retain(|(_, action)| is_available(*action)));
        let all = ACTIONS.iter().map(|entry| entry.action);
        self.removed = all.filter(|action| !is_available(*action)).collect();
        self
    }

    /// Returns whether an action is available at all, with or without a key.
    pub fn is_available(&self, action: Action) -> bool {
        !self.removed.contains(&action)
    }

    /// Replaces the bindings of the actions that a key file names.
    fn patch(&mut self, text: &str) -> Result<(), String> {
        let file: Table = text.parse().map_err(|error: toml::de::Error| error.to_string())?;
        for (name, actions) in &file {
            let scope = Scope::ALL
                .into_iter()
                .find(|scope| scope.id() == name)
                .ok_or_else(|| format!("there is no section {name}"))?;
            let actions = actions.as_table().ok_or_else(|| format!("[{name}] is not a table"))?;
            for (action_name, chords) in actions {
                let action = Action::by_name(scope, action_name)
                    .ok_or_else(|| format!("[{name}] has no action {action_name}"))?;
                self.bind(scope, action, chords)
                    .map_err(|problem| format!("[{name}] {action_name}: {problem}"))?;
            }
        }
        Ok(())
    }

    fn bind(&mut self, scope: Scope, action: Action, chords: &toml::Value) -> Result<(), String> {
        let list = chords.as_array().ok_or("expected a list of keys, for example [\"n\"]")?;
        let parsed: Result<Vec<Vec<Chord>>, String> = list
            .iter()
            .map(|chords| parse_sequence(chords.as_str().ok_or("expected a key as text, for example \"n\"")?))
            .collect();
        let bindings = self.bindings.entry(scope).or_default();
        bindings.retain(|(_, bound_action)| *bound_action != action);
        for chords in parsed? {
            let clash = |bound: &[Chord]| bound.starts_with(&chords) || chords.starts_with(bound);
            if let Some((bound, other)) = bindings.iter().find(|(bound, _)| clash(bound)) {
                return Err(format!("{} already means {}", format_sequence(bound), other.entry().name));
            }
            bindings.push((chords, action));
        }
        Ok(())
    }

    /// Returns the meaning of a chord sequence in the innermost scope that binds it.
    pub fn meaning(&self, scopes: &[Scope], pressed: &[Chord]) -> KeyMeaning {
        let in_scope = |scope: &Scope| {
            let mut begins = self.bindings.get(scope)?.iter().filter(|(bound, _)| bound.starts_with(pressed));
            let (bound, action) = begins.next()?;
            Some(if bound.len() == pressed.len() { KeyMeaning::Action(*action) } else { KeyMeaning::Prefix })
        };
        scopes.iter().find_map(in_scope).unwrap_or(KeyMeaning::Unbound)
    }

    /// Returns the possible completions of a sequence: the remaining chords and the action that they trigger.
    pub fn completions(&self, scopes: &[Scope], pressed: &[Chord]) -> Vec<(String, Action)> {
        let longer = |(bound, action): &(Vec<Chord>, Action)| {
            let rest = bound.strip_prefix(pressed).filter(|rest| !rest.is_empty());
            rest.map(|rest| (format_sequence(rest), *action))
        };
        let mut following: Vec<(String, Action)> = Vec::new();
        for found in scopes.iter().filter_map(|scope| self.bindings.get(scope)).flatten().filter_map(longer) {
            if !following.iter().any(|(chords, _)| *chords == found.0) {
                following.push(found);
            }
        }
        following
    }

    /// Returns the action of a single chord in the innermost scope that binds it.
    pub fn action(&self, scopes: &[Scope], chord: Chord) -> Option<Action> {
        match self.meaning(scopes, &[chord]) {
            KeyMeaning::Action(action) => Some(action),
            _ => None,
        }
    }

    /// Returns the first binding of an action, formatted for labels.
    pub fn label(&self, action: Action) -> Option<String> {
        self.chords(action).next().map(format_sequence)
    }

    /// Returns all bindings of an action.
    pub fn chords(&self, action: Action) -> impl Iterator<Item = &[Chord]> + '_ {
        let bindings = self.bindings.get(&action.entry().scope).into_iter().flatten();
        bindings.filter(move |(_, bound_action)| *bound_action == action).map(|(chords, _)| chords.as_slice())
    }

    /// Returns the bindings of an action that work in these scopes. Bindings that an inner scope overrides are omitted.
    pub fn working_keys(&self, action: Action, scopes: &[Scope]) -> Vec<String> {
        let works = |chords: &&[Chord]| self.meaning(scopes, chords) == KeyMeaning::Action(action);
        self.chords(action).filter(works).map(format_sequence).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::ACTIONS;

    #[test]
    fn every_action_is_in_the_key_file() {
        let file: Table = BUNDLED_KEYS.parse().expect("TOML");
        for entry in ACTIONS {
            let bound = file.get(entry.scope.id()).and_then(|scope| scope.get(entry.name));
            assert!(bound.is_some(), "{}.{} is missing in keys.toml", entry.scope.id(), entry.name);
            let same = ACTIONS.iter().filter(|other| (other.scope, other.name) == (entry.scope, entry.name));
            assert_eq!(same.count(), 1, "{}", entry.name);
        }
    }

    #[test]
    fn user_file_patches_single_actions() {
        let mut keys = KeyBindings::bundled();
        keys.patch("[global]\nquit = [\"ctrl-q\"]").expect("a patch");
        assert_eq!(keys.label(Action::Quit).as_deref(), Some("ctrl-q"));
        assert_eq!(keys.label(Action::NextWeek).as_deref(), Some("n"));
        for (file, part) in [
            ("[globl]\nquit = []", "there is no section globl"),
            ("[global]\nquitt = []", "has no action quitt"),
            ("[global]\nquit = \"q\"", "expected a list of keys"),
            ("[global]\nquit = [\"hyper-q\"]", "is not a key"),
            ("[global]\nquit = [\"n\"]", "already means next-week"),
            ("[global", "expected"),
        ] {
            let problem = KeyBindings::bundled().patch(file).expect_err(file);
            assert!(problem.contains(part), "{problem}");
        }
    }

    #[test]
    fn prefix_keys_list_their_completions() {
        let mut keys = KeyBindings::bundled();
        keys.patch("[global]\nquit = [\", q\", \", x y\"]").expect("a patch");
        let pressed = |text: &str| parse_sequence(text).expect("keys");
        let scopes = [Scope::List, Scope::Global];
        assert_eq!(keys.meaning(&scopes, &pressed(",")), KeyMeaning::Prefix);
        assert_eq!(keys.meaning(&scopes, &pressed(", q")), KeyMeaning::Action(Action::Quit));
        assert_eq!(keys.meaning(&scopes, &pressed(", x")), KeyMeaning::Prefix);
        assert_eq!(keys.meaning(&scopes, &pressed(", n")), KeyMeaning::Unbound);
        let following = [("q".to_owned(), Action::Quit), ("x y".to_owned(), Action::Quit)];
        assert_eq!(keys.completions(&scopes, &pressed(",")), following);
        assert_eq!(keys.label(Action::Quit).as_deref(), Some(", q"));
        let clash = keys.patch("[global]\nundo = [\",\"]").expect_err("a clash");
        assert!(clash.contains("already means quit"), "{clash}");
    }

    #[test]
    fn innermost_scope_takes_precedence() {
        let keys = KeyBindings::bundled();
        let enter = Chord::parse("enter").expect("a key");
        assert_eq!(keys.action(&[Scope::Result, Scope::List], enter), Some(Action::ShowCell));
        assert_eq!(keys.action(&[Scope::List, Scope::Global], enter), Some(Action::Open));
        assert_eq!(keys.action(&[Scope::Global], enter), None);
    }
}
