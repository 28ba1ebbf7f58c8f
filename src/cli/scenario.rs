//! `novamind scenario`: the scenarios and their parameters.

use clap::{Args, Subcommand};

use super::{Context, Failure, print};

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
                crate::formatting::dollars(cash),
                params.digest()
            ))
        }
    }
}
