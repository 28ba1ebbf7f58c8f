//! Explanations of glossary subjects, divided into sections that every interface can show.

use std::fmt::Write;

use super::{Subject, Term, subject_by_name, term};
use novamind_database::{Column, Interface, Table};
use novamind_tools::{Argument, ParameterNumbers, ToolSpec};

/// A labelled section of an explanation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Section {
    /// Label of the section. The first section, which defines the subject, has an empty label.
    pub name: &'static str,
    /// Text of the section, in one or more lines.
    pub text: String,
}

/// An explanation of a glossary subject.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// Display name of the explained subject.
    pub title: String,
    /// Category of the subject, for example `argument of set_prices`.
    pub note: String,
    /// Non-empty sections, in display order.
    pub sections: Vec<Section>,
    /// Related subjects, listed after the sections.
    pub related: Vec<Subject>,
    /// Action names of the screens and dialogs that show the subject.
    pub places: &'static [String],
}

impl Explanation {
    /// Creates the explanation of a subject, with the parameters of the run.
    pub fn new(subject: Subject, numbers: &ParameterNumbers) -> Explanation {
        let (note, sections, related, places) = match subject {
            Subject::Term(term) => term_parts(term),
            Subject::Tool(spec) => tool_parts(spec),
            Subject::Argument(spec, argument) => argument_parts(spec, argument),
            Subject::Table(table) => table_parts(table_of_release(table, numbers)),
            Subject::Column(table, column) => column_parts(table_of_release(table, numbers), column),
        };
        let filled = |section: Section| Section { text: numbers.substitute(&section.text), ..section };
        let sections = sections.into_iter().filter(|section| !section.text.is_empty()).map(filled).collect();
        Explanation { title: subject.title(), note, sections, related, places }
    }

    /// Returns the explanation as lines of text.
    pub fn to_text(&self) -> String {
        let mut text = format!("{} ({})\n", self.title, self.note);
        for section in &self.sections {
            let label = if section.name.is_empty() { String::new() } else { format!("{}: ", section.name) };
            let lines = section.text.replace('\n', "\n  ");
            let _ = writeln!(text, "{label}{lines}");
        }
        let names: Vec<String> = self.related.iter().map(Subject::name).collect();
        if !names.is_empty() {
            let _ = writeln!(text, "see: {}", names.join(", "));
        }
        text
    }
}

type ExplanationParts = (String, Vec<Section>, Vec<Subject>, &'static [String]);

fn section(name: &'static str, text: impl Into<String>) -> Section {
    Section { name, text: text.into() }
}

fn term_parts(glossary_term: &'static Term) -> ExplanationParts {
    let sections = vec![
        section("", glossary_term.text.clone()),
        section("more", glossary_term.more.clone()),
        section("also called", glossary_term.aka.join(", ")),
    ];
    let terms = glossary_term.see.iter().filter_map(|id| term(id)).map(Subject::Term);
    let tools = glossary_term.tools.iter().filter_map(|name| subject_by_name(name));
    let tables = glossary_term
        .tables
        .iter()
        .filter_map(|name| novamind_database::table(Interface::Release1, name))
        .map(Subject::Table);
    (glossary_term.topic.clone(), sections, terms.chain(tools).chain(tables).collect(), &glossary_term.places)
}

fn tool_parts(spec: &'static ToolSpec) -> ExplanationParts {
    let line = |argument: &Argument| format!("{}: {}", argument.name, argument.description);
    let arguments: Vec<String> = spec.arguments.iter().map(line).collect();
    let sections = vec![
        section("", to_sentence(spec.summary)),
        section("effect", spec.effect),
        section("takes effect", spec.effect_timing.id()),
        section("cost", spec.cost),
        section("arguments", arguments.join("\n")),
        section("rejection codes", spec.rejection_codes.join(", ")),
        section("example", format!("{}({})", spec.name(), spec.example)),
    ];
    let terms = super::terms().iter().filter(|term| term.tools.iter().any(|name| name == spec.name()));
    let arguments = spec.arguments.iter().map(|argument| Subject::Argument(spec, argument));
    let tables = spec
        .written_tables
        .iter()
        .filter_map(|name| novamind_database::table(Interface::Release1, name))
        .map(Subject::Table);
    let related = terms.map(Subject::Term).chain(arguments).chain(tables).collect();
    (format!("tool · {}", spec.module.id()), sections, related, &[])
}

fn argument_parts(spec: &'static ToolSpec, argument: &'static Argument) -> ExplanationParts {
    let default = match (argument.required, spec.kind) {
        (true, _) => "required",
        (false, novamind_tools::ToolKind::Setting) => "optional; unchanged if omitted",
        (false, _) => "optional",
    };
    let sections = vec![
        section("", to_sentence(argument.description)),
        section("unit", argument.unit),
        section("range", argument.kind.describe()),
        section("default", default),
        section("effect", spec.effect),
        section("takes effect", spec.effect_timing.id()),
        section("cost", spec.cost),
        section("rejection codes", spec.rejection_codes.join(", ")),
    ];
    let terms = super::terms().iter().filter(|term| term.tools.iter().any(|name| name == spec.name()));
    let related = std::iter::once(Subject::Tool(spec)).chain(terms.map(Subject::Term)).collect();
    (format!("argument of {}", spec.name()), sections, related, &[])
}

fn table_of_release(table: &'static Table, numbers: &ParameterNumbers) -> &'static Table {
    novamind_database::table(numbers.interface(), &table.name).unwrap_or(table)
}

fn table_parts(table: &'static Table) -> ExplanationParts {
    let columns: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    let sections = vec![
        section("", to_sentence(&table.description)),
        section("written", table.written.clone()),
        section("key", table.key.join(", ")),
        section("columns", columns.join(", ")),
    ];
    let terms = super::terms().iter().filter(|term| term.tables.contains(&table.name));
    let columns = table.columns.iter().map(|column| Subject::Column(table, column));
    ("table".to_owned(), sections, terms.map(Subject::Term).chain(columns).collect(), &[])
}

fn column_parts(table: &'static Table, column: &'static Column) -> ExplanationParts {
    let sections = vec![
        section("", to_sentence(&column.description)),
        section("type", column.kind.clone()),
        section("values", column.values.join(", ")),
        section("release", if table.columns.contains(column) { "" } else { "not published by this release" }),
        section("table", format!("{}: {}", table.name, table.description)),
        section("written", table.written.clone()),
    ];
    let terms = super::terms().iter().filter(|term| term.tables.contains(&table.name));
    let related = std::iter::once(Subject::Table(table)).chain(terms.map(Subject::Term)).collect();
    (format!("column of {}", table.name), sections, related, &[])
}

fn to_sentence(text: &str) -> String {
    let mut letters = text.trim_end_matches('.').chars();
    match letters.next() {
        Some(first) => format!("{}{}.", first.to_uppercase(), letters.as_str()),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn explanation_by_name(name: &str) -> Explanation {
        Explanation::new(
            subject_by_name(name).unwrap_or_else(|| panic!("{name} is unknown")),
            &ParameterNumbers::bundled(),
        )
    }

    #[test]
    fn term_explanation_has_definition_and_related_subjects() {
        let runway = explanation_by_name("runway");
        assert_eq!((runway.title.as_str(), runway.note.as_str()), ("Runway", "money"));
        assert!(
            runway.sections[0].name.is_empty() && runway.sections[0].text.starts_with("The number of weeks")
        );
        assert!(runway.related.iter().any(|other| other.name() == "burn"));
        assert_eq!(runway.places, ["overview", "cash"]);
        let ledger = explanation_by_name("ledger");
        assert!(ledger.related.iter().any(|other| other.kind() == "table"), "the table of the same name");
    }

    #[test]
    fn argument_explanation_has_unit_range_default_and_rejections() {
        let text = explanation_by_name("set_prices.A").to_text();
        for part in [
            "set_prices.A (argument of set_prices)",
            "List price of plan A.",
            "unit: $/month",
            "range: number, > 0",
            "default: optional; unchanged if omitted",
            "takes effect: ",
            "rejection codes: ",
            "see: set_prices, plan",
        ] {
            assert!(text.contains(part), "{part} is missing in\n{text}");
        }
    }

    #[test]
    fn every_subject_has_an_explanation() {
        let specs = || novamind_tools::CATALOGUE.iter().map(|tool| tool.spec());
        let tables = || novamind_database::tables(Interface::Release1).iter();
        let subjects = super::super::terms()
            .iter()
            .map(Subject::Term)
            .chain(specs().map(Subject::Tool))
            .chain(specs().flat_map(|spec| {
                spec.arguments.iter().map(move |argument| Subject::Argument(spec, argument))
            }))
            .chain(tables().map(Subject::Table))
            .chain(
                tables()
                    .flat_map(|table| table.columns.iter().map(move |column| Subject::Column(table, column))),
            );
        let numbers = ParameterNumbers::bundled();
        for subject in subjects {
            let explained = Explanation::new(subject, &numbers);
            assert!(!explained.to_text().contains("{operations.") && !explained.to_text().contains(":%}"));
            let first = &explained.sections[0];
            assert!(first.name.is_empty() && first.text.ends_with('.'), "{}: {first:?}", subject.name());
            assert!(!explained.note.is_empty(), "{}", subject.name());
        }
    }
}
