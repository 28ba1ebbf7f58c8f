//! `novamind tools`: the catalog of tools.

use clap::Args;
use serde_json::json;

use super::tables::scenario_params;
use super::{Context, Failure, print};
use crate::record::folder::configuration::DEFAULT_SCENARIO;
use crate::tools::describe::{ToolDocument, document_tool};
use crate::tools::{CATALOGUE, ParameterNumbers, catalogue, describe, find};

#[derive(Debug, Args)]
pub struct Options {
    /// Show the manual of this tool
    name: Option<String>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// Scenario whose parameters and results are documented
    #[arg(long, default_value = DEFAULT_SCENARIO, value_name = "NAME")]
    scenario: String,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let numbers = ParameterNumbers::from_params(&scenario_params(&options.scenario, context)?);
    let text = match (&options.name, options.json) {
        (None, false) => catalogue::list_by_module(),
        (None, true) => {
            let all: Vec<ToolDocument> =
                CATALOGUE.iter().map(|tool| document_tool(tool.spec(), &numbers)).collect();
            format!("{:#}\n", json!(all))
        }
        (Some(name), json) => {
            let tool = find(name).or_else(|| catalogue::find_code(name)).ok_or_else(|| {
                Failure::usage(match catalogue::similar_tools(name) {
                    near if near.is_empty() => {
                        format!("there is no tool {name}; `novamind tools` lists all tools")
                    }
                    near => format!("there is no tool {name}; did you mean {}?", near.join(" or ")),
                })
            })?;
            if json {
                format!("{:#}\n", json!(document_tool(tool.spec(), &numbers)))
            } else {
                describe::format_manual(tool.spec(), &numbers)
            }
        }
    };
    print(&text)
}
