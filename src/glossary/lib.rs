//! The glossary: terms of the company, and the documentation of tools and tables.
//!
//! Terms are defined in `assets/glossary.toml` and contain only information visible to players. Each interface
//! displays the [`Explanation`] of a [`Subject`] in its own layout.

mod explanation;
mod subject;

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

pub use explanation::Explanation;
pub use subject::{Subject, find_subject, subject_by_name};

/// A term of the glossary.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    /// ID of the term in kebab-case, for example `delivered-quality`.
    pub id: String,
    /// Topic of the term, for example money, customers or product.
    pub topic: String,
    /// Display name of the term.
    pub title: String,
    /// Synonyms under which the term can also be found.
    #[serde(default)]
    pub aka: Vec<String>,
    /// Definition of the term in one sentence.
    pub text: String,
    /// How the figure is computed, and other details.
    #[serde(default)]
    pub more: String,
    /// IDs of related terms.
    #[serde(default)]
    pub see: Vec<String>,
    /// Action names of the screens and dialogs that show the term.
    #[serde(default)]
    pub places: Vec<String>,
    /// Tools that set or return the figure.
    #[serde(default)]
    pub tools: Vec<String>,
    /// Tables that contain the figure.
    #[serde(default)]
    pub tables: Vec<String>,
}

#[derive(Deserialize)]
struct GlossaryFile {
    term: Vec<Term>,
}

static TERMS: LazyLock<Vec<Term>> = LazyLock::new(|| {
    let text = include_str!("../../assets/glossary.toml");
    toml::from_str::<GlossaryFile>(text).expect("the bundled glossary is valid").term
});

/// Returns all terms of the glossary, ordered by topic.
pub fn terms() -> &'static [Term] {
    &TERMS
}

/// Returns the glossary term with this ID.
pub fn term(id: &str) -> Option<&'static Term> {
    TERMS.iter().find(|term| term.id == id)
}

/// Returns the terms that the screen or dialog with this action name shows.
pub fn terms_shown_on(place: &str) -> impl Iterator<Item = &'static Term> {
    TERMS.iter().filter(move |term| term.places.iter().any(|text| text == place))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use novamind_database::Interface;

    #[test]
    fn term_ids_are_unique_and_kebab_case() {
        let mut ids = BTreeSet::new();
        let mut words = BTreeSet::new();
        for term in terms() {
            let plain =
                |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-';
            assert!(!term.id.is_empty() && term.id.chars().all(plain), "{}", term.id);
            assert!(ids.insert(&term.id), "{} is defined twice", term.id);
            for word in std::iter::once(&term.title).chain(&term.aka) {
                assert!(words.insert(word.to_lowercase()), "{word} is used by two terms");
            }
        }
        assert!(ids.len() >= 100, "{}", ids.len());
    }

    #[test]
    fn term_references_exist() {
        for Term { id, see, tools, tables, places, .. } in terms() {
            see.iter().for_each(|other| assert!(term(other).is_some() && other != id, "{id} sees {other}"));
            tools.iter().for_each(|tool| assert!(novamind_tools::find(tool).is_some(), "{id} names {tool}"));
            tables.iter().for_each(|table| {
                assert!(novamind_database::table(Interface::Release1, table).is_some(), "{id} names {table}")
            });
            assert!(!places.is_empty() || !tools.is_empty() || !tables.is_empty(), "{id} has no place");
            assert!(!see.is_empty(), "{id} has no related term");
        }
    }

    #[test]
    fn terms_are_sentences_grouped_by_topic() {
        let mut topics: Vec<&str> = Vec::new();
        for term in terms() {
            assert!(term.text.ends_with('.') && !term.text.contains(". "), "{}: one sentence", term.id);
            assert!(!term.text.contains('{'), "{}: figures belong in `more`, which is filled in", term.id);
            assert!(term.more.is_empty() || term.more.ends_with('.'), "{}", term.id);
            if topics.last() != Some(&term.topic.as_str()) {
                assert!(!topics.contains(&term.topic.as_str()), "topic {} is not contiguous", term.topic);
                topics.push(&term.topic);
            }
        }
    }

    #[test]
    fn terms_do_not_mention_hidden_state() {
        let sealed = include_str!("../../tests/data/sealed.csv");
        let text = include_str!("../../assets/glossary.toml");
        let visible = |name: &str| {
            novamind_database::tables(Interface::Release1)
                .iter()
                .any(|table| table.name == name || table.columns.iter().any(|column| column.name == name))
        };
        for name in sealed.lines().skip(1).flat_map(|line| line.split(',')) {
            let may_be_hidden = name.contains('_') && !visible(name);
            assert!(!may_be_hidden || !text.contains(name), "{name} is hidden");
        }
    }
}
