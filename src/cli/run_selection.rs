//! Options that select the run that a program plays.

use std::path::PathBuf;

use clap::Args;

use super::new_run::NewRunOptions;
use super::{Context, Failure};
use crate::record::error::RunError;
use crate::record::folder::runs::find_run;
use crate::session::Session;

/// Options that select an existing run or create a new run for a program.
#[derive(Debug, Args, Clone)]
pub struct RunSelection {
    /// Continue a run; `latest` is the newest unfinished run [default: start a new run]
    #[arg(long, value_name = "ID", conflicts_with_all = ["new", "seed", "days", "cash", "scenario", "mode", "participant", "set", "planted"])]
    run: Option<String>,
    /// Use the language model of this settings file as the voice of the run
    #[arg(long, value_name = "FILE")]
    voice: Option<PathBuf>,
    /// Start a new run
    #[arg(long)]
    new: bool,
    #[command(flatten)]
    made_of: NewRunOptions,
}

impl RunSelection {
    /// Returns whether any option selects a run.
    pub fn is_specified(&self) -> bool {
        self.run.is_some() || self.new || self.made_of.is_specified()
    }

    /// Opens or creates the run.
    ///
    /// # Errors
    /// The run does not exist, is in use or belongs to a study, or the new run cannot be created.
    pub fn open(&self, context: &Context) -> Result<Session, Failure> {
        let context = &context.with_voice(self.voice.as_deref())?;
        if let Some(id) = &self.run {
            let folder = find_run(&context.runs_folder()?, id)?;
            context.check_play_allowed(&folder)?;
            return Ok(Session::open_to_play(&folder, &context.configuration)?);
        }
        create_run(&self.made_of, context)
    }
}

/// Creates a run that a program plays.
///
/// # Errors
/// The run cannot be created.
pub fn create_run(made_of: &NewRunOptions, context: &Context) -> Result<Session, Failure> {
    // A baseline run needs the label of its player.
    let label = context.participant.as_deref().unwrap_or("program");
    let (new, remark) = made_of.with_participant(label).program_run(context)?;
    if let Some(remark) = remark {
        eprintln!("{remark}");
    }
    match Session::create(new, &context.configuration) {
        Err(RunError::ConsentNeeded(_)) => Err(Failure::usage(
            "the configuration folder asks for consent, which a program cannot give: \
             add --consent if the participant has agreed",
        )),
        created => Ok(created?),
    }
}
