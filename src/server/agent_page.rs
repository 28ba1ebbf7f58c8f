//! Instructions for an agent: a page that describes the goal, the rules and the requests, and the documentation of
//! tools and tables.
//!
//! The instructions are generated from the catalog and the current parameters. The page contains the same information
//! as the instructions of the benchmark. It contains no hidden state and no advice on how to play well.

use std::path::Path;

use serde_json::json;

use super::client::module_name;
use super::schema::specs;
use novamind_base::formatting::dollars;
use novamind_database::{Table, tables};
use novamind_record::error::RunError;
use novamind_tools::describe::{ToolDocument, document_tool, format_manual};
use novamind_tools::{ParameterNumbers, ToolModule};

const PAGE: &str = include_str!("../../assets/agent/page.md");
const SHELL: &str = include_str!("../../assets/agent/shell.md");
const ERRORS: &str = include_str!("../../assets/agent/errors.md");

/// Heading of the section that follows the goal, the calendar and the rules.
const HOW_TO_CALL: &str = "## How to call";

/// File to which the instructions are written.
const PAGE_FILE: &str = "AGENT.md";

/// Data of the run that a page describes.
#[derive(Debug, Clone)]
pub struct PageContext<'a> {
    /// Planned last day of the run.
    pub days: u32,
    /// Cash on day 0, in dollars.
    pub cash: f64,
    /// Parameter values that are inserted into the texts.
    pub numbers: &'a ParameterNumbers,
}

/// Returns the instructions for an agent as Markdown.
pub fn agent_page(context: &PageContext<'_>) -> String {
    let filled = context.numbers.substitute(PAGE);
    let parts = [
        ("{days}", context.days.to_string()),
        ("{cash}", dollars(context.cash)),
        ("{how}", SHELL.trim_end().to_owned()),
        ("{tools_document}", "tools.md".to_owned()),
        ("{tables_document}", "tables.md".to_owned()),
        ("{tools}", tool_list(context.numbers)),
        ("{tables}", table_list(context.numbers)),
        ("{errors}", ERRORS.trim_end().to_owned()),
    ];
    parts.iter().fold(filled, |text, (name, value)| text.replace(name, value))
}

/// Returns the goal, the calendar and the rules from the page, for clients that receive the descriptions of the tools
/// separately.
pub fn goal_and_rules(context: &PageContext<'_>) -> String {
    let whole = agent_page(context);
    whole.split_once(HOW_TO_CALL).map_or(whole.as_str(), |(before, _)| before).trim_end().to_owned()
}

/// Writes the instructions and the documentation to a folder: `AGENT.md`, `tools.md`, `tools.json`, `tables.md`,
/// `tables.json`.
///
/// # Errors
/// The folder cannot be written.
pub fn write_documents(folder: &Path, context: &PageContext<'_>) -> Result<(), RunError> {
    std::fs::create_dir_all(folder).map_err(RunError::io(folder))?;
    let documents: Vec<ToolDocument> = specs().map(|spec| document_tool(spec, context.numbers)).collect();
    let files = [
        (PAGE_FILE, agent_page(context)),
        ("tools.md", tool_manual(context.numbers)),
        ("tools.json", format!("{:#}\n", json!(documents))),
        ("tables.md", table_manual(context.numbers)),
        ("tables.json", format!("{:#}\n", json!(tables(context.numbers.interface())))),
    ];
    files.iter().try_for_each(|(name, text)| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(RunError::io(&path))
    })
}

fn tool_list(numbers: &ParameterNumbers) -> String {
    let mut text = String::new();
    for module in ToolModule::ALL {
        text += &format!("### {}\n\n", module_name(module));
        for spec in specs().filter(|spec| spec.module == module) {
            text += &format!("- `{}`: {}\n", spec.name(), numbers.substitute(spec.summary));
        }
        text.push('\n');
    }
    text
}

fn table_list(numbers: &ParameterNumbers) -> String {
    let line = |table: &Table| format!("- `{}`: {}\n", table.name, table.description);
    tables(numbers.interface()).iter().map(line).collect::<String>() + "\n"
}

fn tool_manual(numbers: &ParameterNumbers) -> String {
    let one = |spec| {
        let text = format_manual(spec, numbers);
        let (_, rest) = text.split_once('\n').unwrap_or_default();
        format!("## {}\n\n{}.\n\n```text\n{rest}```\n\n", spec.name(), numbers.substitute(spec.summary))
    };
    "# Tools\n\n".to_owned() + specs().map(one).collect::<String>().trim_end() + "\n"
}

fn table_manual(numbers: &ParameterNumbers) -> String {
    let cell = |text: &str| text.replace('|', "\\|");
    let mut text = "# Tables\n\n".to_owned();
    for table in tables(numbers.interface()) {
        text += &format!("## {}\n\n{}. Written {}.\n\n", table.name, table.description, table.written);
        text += "| Column | Type | Holds |\n|---|---|---|\n";
        for column in &table.columns {
            let values = match column.values.as_slice() {
                [] => String::new(),
                values => format!(" [{}]", values.join(", ")),
            };
            text += &format!(
                "| `{}` | {} | {} |\n",
                column.name,
                column.kind,
                cell(&(column.description.clone() + &values))
            );
        }
        text.push('\n');
    }
    text.trim_end().to_owned() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Interface;
    use novamind_record::folder::configuration::Configuration;

    #[test]
    fn agent_page_lists_every_tool_and_current_parameters() {
        let numbers = ParameterNumbers::bundled();
        let text = agent_page(&PageContext { days: 77, cash: 250_000.0, numbers: &numbers });
        for spec in specs() {
            assert!(text.contains(&format!("`{}`", spec.name())), "{}", spec.name());
        }
        let goal = goal_and_rules(&PageContext { days: 77, cash: 250_000.0, numbers: &numbers });
        assert!(text.starts_with(&goal) && goal.contains("## Rules") && !goal.contains("## How"), "{goal}");
        for table in tables(Interface::Release1) {
            assert!(text.contains(&format!("`{}`", table.name)), "{}", table.name);
        }
        assert!(text.contains("for 77 days") && text.contains("$250,000"), "{text}");
        for name in
            ["{run.", "{limits.", "{billing.", "{how}", "{tools", "{tables", "{errors}", "{days}", "{cash}"]
        {
            assert!(!text.contains(name), "{name}");
        }
    }

    #[test]
    fn documents_contain_every_tool_and_column() {
        let manual = tool_manual(&ParameterNumbers::bundled());
        assert_eq!(manual.matches("\n## ").count(), specs().count());
        let columns: usize = tables(Interface::Release1).iter().map(|table| table.columns.len()).sum();
        assert_eq!(
            table_manual(&ParameterNumbers::bundled()).lines().filter(|line| line.starts_with("| `")).count(),
            columns
        );
    }

    #[test]
    fn documents_follow_the_release() {
        let configuration = Configuration::bundled();
        let scenario = configuration.load_scenario("release-2").expect("a scenario");
        let params = configuration.load_parameters(&scenario, &[], true).expect("parameters");
        let numbers = ParameterNumbers::from_params(&params);
        let manual = table_manual(&numbers);
        assert!(!manual.contains("first_billing_done") && manual.contains("reply_to_agent_post_id"));
        assert!(table_manual(&ParameterNumbers::bundled()).contains("first_billing_done"));
        let release_2 = tool_manual(&numbers);
        assert!(!release_2.contains("persona_name") && release_2.contains("replying_to_your_post"));
        assert!(tool_manual(&ParameterNumbers::bundled()).contains("persona_name"));
    }
}
