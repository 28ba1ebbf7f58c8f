//! Options of a new run, shared by all commands that create a run.

use clap::Args;

use super::run::parse_override;
use super::{Context, Failure};
use crate::record::consent::ConsentDetails;
use crate::record::mode::Mode;
#[cfg(feature = "server")]
use crate::session::baseline_terms;
use crate::session::{Fault, NewRun, Storage};

#[derive(Debug, Args, Clone, Default, PartialEq)]
pub struct NewRunOptions {
    /// Seed of the new run
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Days of the new run, at least 7; baseline runs have 500
    #[arg(long, value_name = "N")]
    days: Option<u32>,
    /// Starting cash of the new run, in dollars; baseline runs start with 1000000
    #[arg(long, value_name = "X")]
    cash: Option<f64>,
    /// Scenario of the new run; baseline runs use `default` or `release-2`
    #[arg(long, value_name = "NAME")]
    scenario: Option<String>,
    /// Mode of the new run [default: sandbox; for programs, baseline if days, cash and scenario match a baseline run]
    #[arg(long, value_name = "baseline|sandbox|debug", value_parser = parse_mode)]
    mode: Option<Mode>,
    /// Label of the player
    #[arg(long, value_name = "LABEL")]
    participant: Option<String>,
    /// Confirm that the participant agreed to the text in consent.md of the configuration folder
    #[arg(long)]
    consent: bool,
    /// Set a parameter of a debug run; can be repeated
    #[arg(long, value_name = "TABLE.KEY=VALUE", value_parser = parse_override)]
    set: Vec<(String, String)>,
    /// Seed one of the numbered faults into a debug run; the number is not shown during the run
    #[arg(id = "planted", long = "fault", alias = "planted", value_name = "N", value_parser = parse_fault)]
    planted: Option<Fault>,
}

fn parse_mode(text: &str) -> Result<Mode, String> {
    let mode = Mode::parse(text).filter(|mode| Mode::SELECTABLE.contains(mode));
    mode.ok_or_else(|| {
        let offered = Mode::SELECTABLE.map(Mode::id).join(", ");
        format!("{text} is not a mode; the modes are {offered}")
    })
}

fn parse_fault(text: &str) -> Result<Fault, String> {
    let number = text.parse::<u32>().unwrap_or(0);
    Fault::try_from(number).map_err(|_| {
        format!("{text} is not the number of a fault; choose a number from 1 to {}", Fault::ALL.len())
    })
}

impl NewRunOptions {
    /// Returns whether any option of a new run was given.
    pub fn is_specified(&self) -> bool {
        NewRunOptions { consent: false, ..self.clone() } != NewRunOptions::default()
    }

    /// Returns whether a scenario is given.
    #[cfg(feature = "server")]
    pub fn has_scenario(&self) -> bool {
        self.scenario.is_some()
    }

    /// Returns the options, with `label` as the player's label unless a label was given.
    #[cfg(feature = "server")]
    pub fn with_participant(&self, label: &str) -> NewRunOptions {
        NewRunOptions {
            participant: Some(self.participant.clone().unwrap_or_else(|| label.to_owned())),
            ..self.clone()
        }
    }

    /// Returns the settings of a run that a program plays. Also returns a remark if days, cash or scenario
    /// make the run a sandbox run.
    ///
    /// # Errors
    /// [`NewRunOptions::new_run`] fails, or the terms of a baseline run cannot be read.
    #[cfg(feature = "server")]
    pub fn program_run(&self, context: &Context) -> Result<(NewRun, Option<String>), Failure> {
        let sandbox = self.new_run(Mode::Sandbox, context)?;
        if self.mode.is_some() {
            return Ok((sandbox, None));
        }
        let other = sandbox.deviating_terms(&context.configuration)?;
        if other.is_empty() {
            return Ok((self.new_run(Mode::Baseline, context)?, None));
        }
        let terms = baseline_terms(&context.configuration)?;
        let remark = format!("this is a sandbox run with {}; a baseline run has {terms}", other.join(", "));
        Ok((sandbox, Some(remark)))
    }

    /// Returns the settings of the new run. `mode` is used if no mode was given.
    ///
    /// # Errors
    /// The labels differ, the options contradict the terms of a baseline run, or there is no folder of runs.
    pub fn new_run(&self, mode: Mode, context: &Context) -> Result<NewRun, Failure> {
        let standard = NewRun::default();
        context.check_participant(self.participant.as_deref())?;
        let new = NewRun {
            seed: self.seed,
            days: self.days,
            cash: self.cash,
            scenario: self.scenario.clone().unwrap_or(standard.scenario),
            overrides: self.set.clone(),
            fault: self.planted,
            lesson: None,
            handout: None,
            mode: self.mode.unwrap_or(mode),
            participant: self.participant.clone(),
            agreed: self.consent.then(|| ConsentDetails::on_paper().agree_now()),
            study: None,
            storage: Storage::Runs(context.runs_folder()?),
            projection: true,
            sync_calls: true,
            seal_key: standard.seal_key,
        };
        new.check_baseline(&context.configuration)?;
        Ok(new)
    }
}
