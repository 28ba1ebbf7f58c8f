//! Options that select parameters, for commands that do not play a run.

use clap::Args;

use crate::cli::run::parse_override;
use crate::cli::{Context, Failure};
use crate::lab::Params;
use crate::record::folder::configuration::DEFAULT_SCENARIO;

/// Options that select parameters.
#[derive(Debug, Args)]
pub struct WorldOptions {
    /// Scenario whose parameters are used
    #[arg(long, default_value = DEFAULT_SCENARIO, value_name = "NAME")]
    scenario: String,
    /// Set a parameter; can be repeated
    #[arg(long, value_name = "TABLE.KEY=VALUE", value_parser = parse_override)]
    set: Vec<(String, String)>,
}

impl WorldOptions {
    /// Returns the parameters of the scenario with the given overrides.
    ///
    /// # Errors
    /// The scenario does not exist, or a parameter is invalid.
    pub fn params(&self, context: &Context) -> Result<Params, Failure> {
        self.days_and_params(context).map(|(_, params)| params)
    }

    /// Returns the last day of a run and the parameters.
    ///
    /// # Errors
    /// As [`WorldOptions::params`].
    pub fn days_and_params(&self, context: &Context) -> Result<(u32, Params), Failure> {
        let scenario = context.configuration.load_scenario(&self.scenario)?;
        let params = context.configuration.load_parameters(&scenario, &self.set, true)?;
        let (days, _) = scenario.days_and_cash_with(&params);
        Ok((params.run.horizon(days).last_day, params))
    }
}
