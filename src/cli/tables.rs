//! `novamind tables`: the tables and columns that can be queried.

use clap::Args;

use super::{Context, Failure, print};
use crate::database::{table, tables};
use crate::record::folder::configuration::DEFAULT_SCENARIO;
use crate::world::params::Params;

#[derive(Debug, Args)]
pub struct Options {
    /// Show the columns of this table
    name: Option<String>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// Scenario whose tables are shown
    #[arg(long, default_value = DEFAULT_SCENARIO, value_name = "NAME")]
    scenario: String,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let interface = scenario_params(&options.scenario, context)?.fidelity.interface;
    let tables = tables(interface);
    let as_json = |value: Result<String, serde_json::Error>| value.unwrap_or_default() + "\n";
    let text = match (&options.name, options.json) {
        (None, true) => as_json(serde_json::to_string_pretty(tables)),
        (None, false) => {
            let width = tables.iter().map(|table| table.name.len()).max().unwrap_or(0);
            tables.iter().map(|table| format!("{:<width$}  {}\n", table.name, table.description)).collect()
        }
        (Some(name), json) => {
            let table = table(interface, name).ok_or_else(|| {
                let near = novamind_base::similar_names(name, tables.iter().map(|table| table.name.as_str()));
                let help = if near.is_empty() {
                    "`novamind tables` lists all tables".to_owned()
                } else {
                    format!("did you mean {}?", near.join(" or "))
                };
                Failure::usage(format!("there is no table {name}; {help}"))
            })?;
            if json { as_json(serde_json::to_string_pretty(table)) } else { table.describe() }
        }
    };
    print(&text)
}

/// Returns the parameters of a scenario.
///
/// # Errors
/// The scenario does not exist, or a parameter is invalid.
pub fn scenario_params(name: &str, context: &Context) -> Result<Params, Failure> {
    let scenario = context.configuration.load_scenario(name)?;
    Ok(context.configuration.load_parameters(&scenario, &[], true)?)
}
