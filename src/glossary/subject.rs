//! Subjects that the glossary can explain, and their lookup by name.

use super::{Term, term, terms};
use novamind_base::similar_names;
use novamind_database::{Column, Interface, Table};
use novamind_tools::{Argument, ToolSpec};

/// A subject that the glossary can explain.
#[derive(Debug, Clone, Copy)]
pub enum Subject {
    /// A term of the glossary.
    Term(&'static Term),
    /// A tool of the benchmark.
    Tool(&'static ToolSpec),
    /// An argument of a tool.
    Argument(&'static ToolSpec, &'static Argument),
    /// A public SQL table.
    Table(&'static Table),
    /// A column of a public SQL table.
    Column(&'static Table, &'static Column),
}

impl Subject {
    /// Returns the name by which [`subject_by_name`] finds the subject.
    pub fn name(&self) -> String {
        match self {
            Subject::Term(term) => term.id.clone(),
            Subject::Tool(spec) => spec.name().to_owned(),
            Subject::Argument(spec, argument) => format!("{}.{}", spec.name(), argument.name),
            Subject::Table(table) => table.name.clone(),
            Subject::Column(table, column) => format!("{}.{}", table.name, column.name),
        }
    }

    /// Returns the display name of the subject.
    pub fn title(&self) -> String {
        match self {
            Subject::Term(term) => term.title.clone(),
            other => other.name(),
        }
    }

    /// Returns the kind of the subject, for example `term` or `tool`.
    pub fn kind(&self) -> &'static str {
        match self {
            Subject::Term(_) => "term",
            Subject::Tool(_) => "tool",
            Subject::Argument(..) => "argument",
            Subject::Table(_) => "table",
            Subject::Column(..) => "column",
        }
    }
}

/// Looks up an exact name: a term (`churn`), a tool or argument (`set_prices`, `set_prices.A`), a table or column
/// (`ledger`, `ledger.amount`). A name such as `set_prices.x`, where `x` is not an argument, returns the tool.
pub fn subject_by_name(name: &str) -> Option<Subject> {
    if let Some(term) = term(name) {
        return Some(Subject::Term(term));
    }
    if let Some(tool) = novamind_tools::find(name) {
        return Some(Subject::Tool(tool.spec()));
    }
    if let Some(table) = novamind_database::table(Interface::Release1, name) {
        return Some(Subject::Table(table));
    }
    let (whole, part) = name.rsplit_once('.')?;
    if let Some(table) = novamind_database::table(Interface::Release1, whole) {
        let column = table.columns.iter().find(|column| column.name.eq_ignore_ascii_case(part))?;
        return Some(Subject::Column(table, column));
    }
    let spec = novamind_tools::find(whole)?.spec();
    let argument =
        spec.arguments.iter().find(|argument| argument.name == part || argument.alias == Some(part));
    Some(argument.map_or(Subject::Tool(spec), |argument| Subject::Argument(spec, argument)))
}

/// Finds the subject that a user typed. Ignores case and dashes, and accepts synonyms.
///
/// # Errors
/// Returns similar names if no subject matches.
pub fn find_subject(words: &str) -> Result<Subject, Vec<&'static str>> {
    let typed = normalize(words);
    let has_typed_name = |term: &&Term| {
        let names = std::iter::once(&term.id).chain(std::iter::once(&term.title)).chain(&term.aka);
        names.into_iter().any(|name| normalize(name) == typed)
    };
    let joined = words.trim().to_lowercase().replace([' ', '-'], "_");
    terms()
        .iter()
        .find(has_typed_name)
        .map(Subject::Term)
        .or_else(|| subject_by_name(words.trim()))
        .or_else(|| subject_by_name(&joined))
        .or_else(|| tool_with_result_field(&joined))
        .or_else(|| strip_parentheses(words).and_then(|words| find_subject(words).ok()))
        .ok_or_else(|| similar_terms(&typed))
}

/// Returns the tool whose result contains a field with this name. The manual of the tool describes the field.
fn tool_with_result_field(field: &str) -> Option<Subject> {
    // A name without an underscore is more likely to be a type than a field.
    if !field.contains('_') && field != "description" {
        return None;
    }
    let names = |kind: &'static str| kind.split(|letter: char| !letter.is_alphanumeric() && letter != '_');
    let returns_field = |spec: &&'static ToolSpec| {
        let fields = |output: &novamind_tools::ResultField| {
            output.name == field || names(output.kind).any(|name| name == field)
        };
        spec.result_fields.iter().any(fields)
    };
    novamind_tools::CATALOGUE.iter().map(|tool| tool.spec()).find(returns_field).map(Subject::Tool)
}

/// Removes parentheses at the end, as in `Overload (peak)`.
fn strip_parentheses(words: &str) -> Option<&str> {
    words.trim().strip_suffix(')')?.split_once('(').map(|(words, _)| words)
}

/// Returns the IDs of similar terms. Terms that contain the typed words come first.
fn similar_terms(typed: &str) -> Vec<&'static str> {
    let names = || terms().iter().map(|term| term.id.as_str());
    let mut found: Vec<&str> = if typed.len() < 3 {
        Vec::new()
    } else {
        terms()
            .iter()
            .filter(|term| contains_text(term, typed))
            .map(|term| term.id.as_str())
            .take(5)
            .collect()
    };
    if found.is_empty() {
        let tools = novamind_tools::CATALOGUE.iter().map(|tool| tool.spec().name());
        let tables = novamind_database::tables(Interface::Release1).iter().map(|table| table.name.as_str());
        found = similar_names(&typed.replace(' ', "-"), names());
        found.extend(similar_names(&typed.replace(' ', "_"), tools.chain(tables)));
        found.truncate(5);
    }
    found
}

fn contains_text(term: &Term, typed: &str) -> bool {
    std::iter::once(&term.id).chain(&term.aka).any(|name| normalize(name).contains(typed))
}

fn normalize(words: &str) -> String {
    let spaced = words.to_lowercase().replace(['-', '_'], " ");
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subject_by_name_finds_every_kind() {
        for (name, kind) in [
            ("churn", "term"),
            ("set_prices", "tool"),
            ("set_prices.A", "argument"),
            ("pricing.set_prices", "tool"),
            ("set_targeted_ad_spend.content_marketing", "tool"),
            ("issues", "table"),
            ("ledger.amount", "column"),
            ("LEDGER.Amount", "column"),
        ] {
            assert_eq!(subject_by_name(name).map(|found| found.kind()), Some(kind), "{name}");
        }
        for name in ["", ".", "ledger.secret", "no_tool.A", "Churn", "customers.usage_demand"] {
            assert!(subject_by_name(name).is_none(), "{name}");
        }
    }

    #[test]
    fn subject_by_name_finds_every_subject() {
        let tools = novamind_tools::CATALOGUE.iter().map(|tool| tool.spec());
        for spec in tools {
            for argument in spec.arguments {
                let name = Subject::Argument(spec, argument).name();
                assert_eq!(subject_by_name(&name).map(|found| found.name()), Some(name));
            }
        }
        for table in novamind_database::tables(Interface::Release1) {
            for column in &table.columns {
                let name = Subject::Column(table, column).name();
                assert_eq!(subject_by_name(&name).map(|found| found.kind()), Some("column"), "{name}");
            }
        }
    }

    #[test]
    fn find_subject_ignores_case_and_dashes() {
        for (words, name) in [
            ("Delivered Quality", "delivered-quality"),
            ("monthly recurring revenue", "mrr"),
            ("  MRR ", "mrr"),
            ("word of mouth", "network-source"),
            ("network leads", "network-source"),
            ("participation curve", "participation-curve"),
            ("Spill-over", "spill-over"),
            ("quality bank", "quality-bank"),
            ("r&d", "research-project"),
            ("set prices", "set_prices"),
            ("ledger.amount", "ledger.amount"),
            ("Ledger", "ledger"),
            ("95 % band", "band"),
            ("Overload (peak)", "overload"),
            ("willingness_to_pay", "budget"),
            ("avg_response_days", "get_group_insights"),
            ("cycle_phase", "pmi"),
        ] {
            assert_eq!(find_subject(words).map(|found| found.name()), Ok(name.to_owned()), "{words}");
        }
        assert!(find_subject("qualit").is_err_and(|near| near.contains(&"delivered-quality")));
        assert!(find_subject("runwy").is_err_and(|near| near.contains(&"runway")));
        assert!(find_subject("").is_err() && find_subject("\u{301}.\n").is_err());
    }
}
