//! The run that a program plays: one that is there, or a new one.

use std::path::PathBuf;

use clap::Args;

use super::new_run::NewRunOptions;
use super::{Context, Failure};
use crate::record::error::RunError;
use crate::record::folder::runs::find_run;
use crate::session::Session;

/// The run that a program plays: one that is there, or a new one.
#[derive(Debug, Args, Clone)]
pub struct WhichRun {
    /// Go on with a run; `latest` is the newest unfinished one. Without it a new run begins.
    #[arg(long, value_name = "ID", conflicts_with_all = ["new", "seed", "days", "cash", "scenario", "mode", "participant", "set", "planted"])]
    run: Option<String>,
    /// Let the language model that a file names lend its voice to the run.
    #[arg(long, value_name = "FILE")]
    voice: Option<PathBuf>,
    /// Begin a new run.
    #[arg(long)]
    new: bool,
    #[command(flatten)]
    made_of: NewRunOptions,
}

impl WhichRun {
    /// Whether any option says which.
    pub fn names_one(&self) -> bool {
        self.run.is_some() || self.new || self.made_of.ask_for_one()
    }

    /// Opens or begins the run.
    ///
    /// # Errors
    /// It is missing, in use, or belongs to a study; the new run cannot begin.
    pub fn open(&self, context: &Context) -> Result<Session, Failure> {
        let context = &context.with_voice(self.voice.as_deref())?;
        if let Some(id) = &self.run {
            let folder = find_run(&context.runs()?, id)?;
            context.check_play(&folder)?;
            return Ok(Session::open_to_play(&folder, &context.configuration)?);
        }
        begin(&self.made_of, context)
    }
}

/// Begins a run that a program plays.
///
/// # Errors
/// The run cannot begin.
pub fn begin(made_of: &NewRunOptions, context: &Context) -> Result<Session, Failure> {
    // A baseline run says who played it.
    let label = context.participant.as_deref().unwrap_or("program");
    let (new, remark) = made_of.played_by(label).new_run_of_program(context)?;
    if let Some(remark) = remark {
        eprintln!("{remark}");
    }
    match Session::create(new, &context.configuration) {
        Err(RunError::ConsentNeeded(_)) => Err(Failure::usage(
            "this folder of configuration asks participants to agree to a text first, which no program can do: \
             add --consent if the person has agreed",
        )),
        created => Ok(created?),
    }
}
