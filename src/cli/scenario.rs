//! `novamind scenario`: the scenarios and their parameters.

use clap::{Args, Subcommand};

use super::{Context, Failure, print};
use crate::database::text::align_columns;
use crate::formatting::dollars;
use crate::record::folder::configuration::Configuration;
use crate::report::pluralize;
use crate::world::params::parameter_comment;

#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: ScenarioCommand,
}

#[derive(Debug, Subcommand)]
enum ScenarioCommand {
    /// List all scenarios
    List,
    /// Show the effective parameters of a scenario as TOML
    Show {
        /// Name of the scenario
        name: String,
    },
    /// Show what differs between two scenarios: parameters with their meaning, days and starting cash
    Diff {
        /// Name of the first scenario
        #[arg(value_name = "NAME_A")]
        one: String,
        /// Name of the second scenario
        #[arg(value_name = "NAME_B")]
        other: String,
    },
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let configuration = &context.configuration;
    match &options.command {
        ScenarioCommand::List => {
            let (mut text, mut unreadable) = (String::new(), Vec::new());
            for name in configuration.scenario_names() {
                match configuration.load_scenario(&name) {
                    Ok(scenario) => text += &format!("{name:<24}  {}\n", scenario.description),
                    // An invalid file is reported after the list of the other scenarios.
                    Err(error) => unreadable.push(error.to_string()),
                }
            }
            print(&text)?;
            if unreadable.is_empty() { Ok(()) } else { Err(Failure::unreadable(unreadable.join("\n"))) }
        }
        ScenarioCommand::Show { name } => {
            let scenario = configuration.load_scenario(name)?;
            let params = configuration.load_parameters(&scenario, &[], true)?;
            let table = toml::to_string(&params)
                .map_err(|error| Failure::failed(format!("cannot write the parameters: {error}")))?;
            let (days, cash) = scenario.days_and_cash_with(&params);
            print(&format!(
                "# {}: {}\n# {} days, {} at the start; digest {}\n\n{table}",
                scenario.title,
                scenario.description,
                params.run.horizon(days).last_day,
                dollars(cash),
                params.digest()
            ))
        }
        ScenarioCommand::Diff { one, other } => print(&describe_difference([one, other], configuration)?),
    }
}

/// Formats the values that differ between two scenarios, each followed by a line with its meaning.
fn describe_difference(names: [&str; 2], configuration: &Configuration) -> Result<String, Failure> {
    let [one, other] = [configuration.load_scenario(names[0])?, configuration.load_scenario(names[1])?];
    let params =
        [configuration.load_parameters(&one, &[], true)?, configuration.load_parameters(&other, &[], true)?];
    let terms = [one.days_and_cash_with(&params[0]), other.days_and_cash_with(&params[1])];
    let days = terms.map(|(days, _)| days.to_string());
    let cash = terms.map(|(_, cash)| dollars(cash));
    let mut rows = vec![
        ("days", days, Some("last day of a run".to_owned())),
        ("cash", cash, Some("cash on day 0".to_owned())),
    ];
    rows.retain(|(_, [one, other], _)| one != other);
    let differences = params[0].differences(&params[1]);
    rows.extend(differences.iter().map(|difference| {
        let values = [&difference.old, &difference.new];
        let values = values.map(|value| value.as_ref().map_or("none".to_owned(), ToString::to_string));
        (difference.key.as_str(), values, parameter_comment(&difference.key))
    }));
    let [one, other] = names;
    if rows.is_empty() {
        return Ok(format!("{one} and {other} are equal: the same parameters, days and starting cash\n"));
    }
    let count = pluralize(rows.len() as u32, "difference");
    let cells = rows.iter().map(|(key, [one, other], _)| vec![(*key).to_owned(), one.clone(), other.clone()]);
    let table = align_columns(&["", one, other].map(str::to_owned), &cells.collect::<Vec<_>>());
    let mut lines = table.lines();
    let mut text = format!("{count} between {one} and {other}\n\n{}\n", lines.next().unwrap_or_default());
    for (line, (.., meaning)) in lines.zip(&rows) {
        text += &format!("{line}\n");
        if let Some(meaning) = meaning {
            text += &format!("    {}\n", meaning.strip_prefix("or ").unwrap_or(meaning));
        }
    }
    Ok(text)
}
