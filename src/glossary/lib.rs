//! Words that explain: the terms of the company, and what the documentation of tools and tables says of a name.
//!
//! Terms are written in `assets/glossary.toml`; they say no more than screens, tools and tables tell everybody.
//! Screens and plain mode ask for an [`Explanation`] of a [`Subject`] and show it each in its own way.

mod explanation;
mod subject;

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

pub use explanation::Explanation;
pub use subject::{Subject, find, subject};

/// A term.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// Name in kebab-case, for instance `delivered-quality`.
    pub id: String,
    /// What it belongs to: money, customers, product …
    pub topic: String,
    /// As it is written.
    pub title: String,
    /// Other words for it.
    #[serde(default)]
    pub aka: Vec<String>,
    /// What it is, in one sentence.
    pub text: String,
    /// How it is counted and what else there is to know.
    #[serde(default)]
    pub more: String,
    /// Other terms that help to understand it.
    #[serde(default)]
    pub see: Vec<String>,
    /// Screens and dialogs that show it, by the names of their actions.
    #[serde(default)]
    pub places: Vec<String>,
    /// Tools that set or tell it.
    #[serde(default)]
    pub tools: Vec<String>,
    /// Tables that hold it.
    #[serde(default)]
    pub tables: Vec<String>,
}

#[derive(Deserialize)]
struct Book {
    term: Vec<Term>,
}

static TERMS: LazyLock<Vec<Term>> = LazyLock::new(|| {
    let text = include_str!("../../assets/glossary.toml");
    toml::from_str::<Book>(text).expect("a test reads the shipped glossary").term
});

/// All terms, by topic.
pub fn terms() -> &'static [Term] {
    &TERMS
}

/// The term with this id.
pub fn term(id: &str) -> Option<&'static Term> {
    TERMS.iter().find(|term| term.id == id)
}

/// The terms that a screen or dialog shows, by the name of its action.
pub fn terms_of(place: &str) -> impl Iterator<Item = &'static Term> {
    TERMS.iter().filter(move |term| term.places.iter().any(|own| own == place))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn ids_are_unique_words_with_dashes() {
        let mut ids = BTreeSet::new();
        let mut words = BTreeSet::new();
        for term in terms() {
            let plain =
                |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-';
            assert!(!term.id.is_empty() && term.id.chars().all(plain), "{}", term.id);
            assert!(ids.insert(&term.id), "{} stands twice", term.id);
            for word in std::iter::once(&term.title).chain(&term.aka) {
                assert!(words.insert(word.to_lowercase()), "{word} means two terms");
            }
        }
        assert!(ids.len() >= 100, "{}", ids.len());
    }

    #[test]
    fn everything_a_term_points_at_exists() {
        for Term { id, see, tools, tables, places, .. } in terms() {
            see.iter().for_each(|other| assert!(term(other).is_some() && other != id, "{id} sees {other}"));
            tools.iter().for_each(|tool| assert!(novamind_tools::find(tool).is_some(), "{id} names {tool}"));
            tables
                .iter()
                .for_each(|table| assert!(novamind_database::table(table).is_some(), "{id} names {table}"));
            assert!(!places.is_empty() || !tools.is_empty() || !tables.is_empty(), "{id} is nowhere");
            assert!(!see.is_empty(), "{id} leads nowhere");
        }
    }

    #[test]
    fn terms_are_sentences_and_topics_stand_together() {
        let mut topics: Vec<&str> = Vec::new();
        for term in terms() {
            assert!(term.text.ends_with('.') && !term.text.contains(". "), "{}: one sentence", term.id);
            assert!(!term.text.contains('{'), "{}: figures belong into `more`, which is filled in", term.id);
            assert!(term.more.is_empty() || term.more.ends_with('.'), "{}", term.id);
            if topics.last() != Some(&term.topic.as_str()) {
                assert!(!topics.contains(&term.topic.as_str()), "{} is torn apart", term.topic);
                topics.push(&term.topic);
            }
        }
    }

    #[test]
    fn nothing_hidden_is_said() {
        let sealed = include_str!("../../tests/data/sealed.csv");
        let text = include_str!("../../assets/glossary.toml");
        let visible = |name: &str| {
            novamind_database::tables()
                .iter()
                .any(|table| table.name == name || table.columns.iter().any(|column| column.name == name))
        };
        for name in sealed.lines().skip(1).flat_map(|line| line.split(',')) {
            let telling = name.contains('_') && !visible(name);
            assert!(!telling || !text.contains(name), "{name} is sealed");
        }
    }
}
