//! The command line: one module per subcommand.

#[cfg(feature = "server")]
mod agent;
mod bench;
mod class;
mod completions;
mod doctor;
mod failure;
#[cfg(all(feature = "server", unix))]
mod host;
mod keys;
mod lab;
mod lesson;
mod machine_checks;
mod man;
#[cfg(feature = "server")]
mod mcp;
mod new_run;
mod output_file;
mod pictures;
mod play;
mod query;
mod replay;
mod report;
mod run;
#[cfg(feature = "server")]
mod run_selection;
mod runs;
mod scenario;
#[cfg(feature = "server")]
mod serve;
mod study;
mod tables;
mod tools;

use std::path::{Path, PathBuf};

use clap::{Parser, Subcommand};

pub use failure::Failure;

use crate::record::error::RunError;
use crate::record::folder::configuration::Configuration;
use crate::record::folder::manifest::Manifest;
use crate::record::folder::manifest_check::read_manifest;
use crate::record::folder::runs::participant_folder;
use crate::record::trajectory::Trajectory;
use crate::session::{LabKey, ModelSettings, SealKey, record_external_read};
use novamind_study::{CodeOutcome, STUDY_FILE, Study, load_lab_key, load_seal_key};

/// Run a simulated AI subscription company for 500 days
///
/// Without a command, the console opens. Every run is recorded completely and can be replayed to the same state.
#[derive(Debug, Parser)]
#[command(name = "novamind", version, max_term_width = 110)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    play: play::Options,
    /// Folder of the runs [default: the platform's data folder]
    #[arg(long, global = true, env = "NOVAMIND_RUNS", value_name = "DIR")]
    runs_dir: Option<PathBuf>,
    /// Label of the player: the player's runs are recorded under this label in a separate folder, and no other runs are shown
    #[arg(long = "as", global = true, env = "NOVAMIND_PARTICIPANT", value_name = "LABEL")]
    whose: Option<String>,
    /// Folder of a study: participants play by its protocol; all other commands need the experimenter's code
    #[arg(long, global = true, env = "NOVAMIND_STUDY", value_name = "DIR")]
    study: Option<PathBuf>,
    /// The experimenter's code of the study
    #[arg(long, global = true, env = "NOVAMIND_CODE", value_name = "CODE", hide_env_values = true)]
    code: Option<String>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Open the console, or play line by line with --plain
    Play(play::Options),
    /// Run a policy without a player
    Run(run::Options),
    /// List, show, end, delete, export and import runs
    Runs(runs::Options),
    /// Replay a recorded run, or simulate it again and compare every state
    Replay(replay::Options),
    /// Report on a run: result, curves, decisions, and how it was played
    Report(report::Options),
    /// Query the database of a run
    Query(query::Options),
    /// Show the catalog of tools
    Tools(tools::Options),
    /// Show the tables that you can query
    Tables(tables::Options),
    /// Show every key of the console
    Keys(keys::Options),
    /// Draw the screens of a run as text or SVG
    Pictures(pictures::Options),
    /// Show the scenarios and their parameters
    Scenario(scenario::Options),
    /// List, show, play and check lessons
    Lesson(lesson::Options),
    /// Hand out lessons and runs to students, collect their submissions, and show the results
    Class(class::Options),
    /// Set up studies with people: protocol, participants, checks
    Study(study::Options),
    /// Run experiments with policies, and compare runs with each other and with published figures
    Lab(lab::Options),
    /// Play a run with single shell commands, or run an agent on several runs with `batch`
    #[cfg(feature = "server")]
    Agent(agent::Options),
    /// Serve a run to programs over HTTP
    #[cfg(feature = "server")]
    Serve(serve::Options),
    /// Serve a run to a client of the Model Context Protocol on standard input and output
    #[cfg(feature = "server")]
    Mcp(mcp::Options),
    /// Host sessions of a study on this machine: participants play in a browser or over ssh
    #[cfg(all(feature = "server", unix))]
    Host(host::Options),
    /// Measure how fast this machine simulates
    Bench(bench::Options),
    /// Check this machine and print what a bug report needs
    Doctor(doctor::Options),
    /// Print a completion script for a shell
    Completions(completions::Options),
    /// Print a manual page, or write all manual pages to a folder
    Man(man::Options),
}

impl Command {
    fn name(&self) -> &'static str {
        match self {
            Command::Play(_) => "play",
            Command::Run(_) => "run",
            Command::Runs(_) => "runs",
            Command::Replay(_) => "replay",
            Command::Report(_) => "report",
            Command::Query(_) => "query",
            Command::Tools(_) => "tools",
            Command::Tables(_) => "tables",
            Command::Keys(_) => "keys",
            Command::Pictures(_) => "pictures",
            Command::Scenario(_) => "scenario",
            Command::Lesson(_) => "lesson",
            Command::Class(_) => "class",
            Command::Study(_) => "study",
            Command::Lab(_) => "lab",
            #[cfg(feature = "server")]
            Command::Agent(_) => "agent",
            #[cfg(feature = "server")]
            Command::Serve(_) => "serve",
            #[cfg(feature = "server")]
            Command::Mcp(_) => "mcp",
            #[cfg(all(feature = "server", unix))]
            Command::Host(_) => "host",
            Command::Bench(_) => "bench",
            Command::Doctor(_) => "doctor",
            Command::Completions(_) => "completions",
            Command::Man(_) => "man",
        }
    }
}

/// Configuration and global options for all commands.
#[derive(Clone)]
pub struct Context {
    /// The user's configuration folder, scenarios and settings.
    pub configuration: Configuration,
    /// Folder of the runs, from the command line or the platform's default.
    runs: Option<PathBuf>,
    /// Label of the player whose runs are used, from `--as`.
    pub participant: Option<String>,
    /// Whether the folder of runs was given on the command line.
    has_explicit_runs_folder: bool,
    /// Folder of the study whose keys are used: the given folder, or the working directory if it contains a study.
    pub study_folder: Option<PathBuf>,
    /// Whether the command has the experimenter's code of the study.
    pub is_experimenter: bool,
}

impl Context {
    /// Returns the command that continues the newest run of this folder.
    pub fn resume_command(&self) -> String {
        let mut words = self.command_prefix();
        words.extend(self.participant.as_ref().map(|label| format!("--as {label}")));
        words.push("--run latest".to_owned());
        words.join(" ")
    }

    /// Returns the command that continues a study. Participants enter their label again.
    pub fn study_command(&self, study: &Path) -> String {
        let mut words = self.command_prefix();
        words.push(format!("--study {}", shell_quoted(study)));
        words.join(" ")
    }

    fn command_prefix(&self) -> Vec<String> {
        let mut words = vec!["novamind".to_owned()];
        let named = self.runs.as_ref().filter(|_| self.has_explicit_runs_folder);
        words.extend(named.map(|folder| format!("--runs-dir {}", shell_quoted(folder))));
        words
    }

    /// Returns this context for the student of a handout.
    ///
    /// # Errors
    /// `--as` names another student.
    pub fn for_student(&self, label: &str) -> Result<Context, Failure> {
        match &self.participant {
            Some(whose) if whose != label => Err(Failure::usage(format!(
                "this handout belongs to {label}, not to {whose}: leave out --as {whose}"
            ))),
            _ => Ok(Context { participant: Some(label.to_owned()), ..self.clone() }),
        }
    }

    /// Returns this context with the language model of a settings file. Returns the context unchanged if `file` is `None`.
    ///
    /// # Errors
    /// The file cannot be read or is invalid. The error names the line and the key.
    pub fn with_voice(&self, file: Option<&Path>) -> Result<Context, Failure> {
        let Some(file) = file else { return Ok(self.clone()) };
        let text = std::fs::read_to_string(file).map_err(RunError::io(file))?;
        let voice = ModelSettings::parse(&file.display().to_string(), &text).map_err(RunError::from)?;
        let configuration = Configuration { voice: Some(voice), ..self.configuration.clone() };
        Ok(Context { configuration, ..self.clone() })
    }

    /// Checks that `--participant` and `--as` do not name different people.
    ///
    /// # Errors
    /// The labels differ.
    pub fn check_participant(&self, named: Option<&str>) -> Result<(), Failure> {
        match (&self.participant, named) {
            (Some(whose), Some(named)) if whose != named => Err(Failure::usage(format!(
                "--as {whose} and --participant {named} name different people: give one label, with --as"
            ))),
            _ => Ok(()),
        }
    }

    /// Returns the folders of runs in `named`, or this machine's folder of runs if `named` is empty.
    ///
    /// # Errors
    /// A named folder does not exist, or [`Context::runs_folder`] fails.
    fn machine_folders(&self, named: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
        if let Some(missing) = named.iter().find(|folder| !folder.is_dir()) {
            let problem = format!("{} is not a folder; nothing was read", missing.display());
            return Err(Failure::failed(problem));
        }
        if named.is_empty() { Ok(vec![self.runs_folder()?]) } else { Ok(named.to_vec()) }
    }

    /// Returns the key that seals snapshots of the study's runs.
    ///
    /// # Errors
    /// The key exists and cannot be read.
    fn seal_key(&self) -> Result<SealKey, Failure> {
        Ok(self.study_folder.as_deref().map(load_seal_key).transpose()?.unwrap_or_default())
    }

    /// Returns the key that signs archives, from a file or from the study.
    ///
    /// # Errors
    /// The key exists and cannot be read.
    fn lab_key(&self, named: Option<&Path>) -> Result<Option<LabKey>, Failure> {
        match (named, &self.study_folder) {
            (Some(file), _) => Ok(Some(LabKey::read(file)?)),
            (None, Some(folder)) => Ok(load_lab_key(folder)?),
            (None, None) => Ok(None),
        }
    }

    /// Checks that the results of a run may be shown. Some studies show results only to the experimenter.
    ///
    /// # Errors
    /// The study hides the results and no code was given, or the manifest cannot be read.
    pub fn check_view_allowed(&self, folder: &Path) -> Result<(), Failure> {
        self.check_results_allowed(&read_manifest(folder)?)
    }

    fn check_results_allowed(&self, manifest: &Manifest) -> Result<(), Failure> {
        if self.is_experimenter || manifest.study.is_none() || !manifest.session_rules().withholds_results() {
            return Ok(());
        }
        Err(Failure::usage(format!(
            "run {} belongs to a study that hides its results: write `--study DIR --code CODE` before the command",
            manifest.id
        )))
    }

    /// Checks access like [`Context::check_view_allowed`], and records that the run was read.
    ///
    /// # Errors
    /// Same as [`Context::check_view_allowed`] and [`record_external_read`].
    pub fn authorize_view(&self, folder: &Path, command: &str, detail: &str) -> Result<(), Failure> {
        self.check_view_allowed(folder)?;
        Ok(record_external_read(folder, command, detail)?)
    }

    /// Checks that a run is not an unfinished run of a study. Such a run can be played or watched only within its study.
    ///
    /// # Errors
    /// The run is an unfinished run of a study and no code was given, or the manifest cannot be read.
    pub fn check_play_allowed(&self, folder: &Path) -> Result<(), Failure> {
        let manifest = read_manifest(folder)?;
        let Some(study) = manifest.study.as_ref().filter(|_| !self.is_experimenter) else { return Ok(()) };
        if Trajectory::read(&folder.join("trajectory.jsonl"))?.end_line().is_some() {
            return self.check_results_allowed(&manifest);
        }
        Err(Failure::usage(format!(
            "run {} belongs to the study {}: continue it with `novamind --study DIR`",
            manifest.id, study.name
        )))
    }

    /// Returns the folder that contains the runs of all participants.
    ///
    /// # Errors
    /// The platform has no data folder and no folder was given.
    fn runs_root(&self) -> Result<PathBuf, Failure> {
        self.runs.clone().ok_or_else(|| {
            Failure::usage(
                "this system has no data folder; give a folder of runs with --runs-dir or NOVAMIND_RUNS",
            )
        })
    }

    /// Returns the folder of cached experiment results, a hidden folder in the folder of runs.
    ///
    /// # Errors
    /// Same as [`Context::runs_folder`].
    pub fn laboratory_folder(&self) -> Result<PathBuf, Failure> {
        Ok(self.runs_root()?.join(".lab"))
    }

    /// Returns the folder of the participant's runs, or of all runs if no participant was given.
    ///
    /// # Errors
    /// The platform has no data folder and no folder was given, or the label is invalid.
    pub fn runs_folder(&self) -> Result<PathBuf, Failure> {
        let base = self.runs_root()?;
        match &self.participant {
            None => Ok(base),
            Some(label) => participant_folder(&base, label).map_err(Failure::usage),
        }
    }
}

/// Quotes a path for a shell.
fn shell_quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let plain = |letter: char| letter.is_alphanumeric() || "/._-".contains(letter);
    if text.chars().all(plain) { text } else { format!("'{}'", text.replace('\'', r"'\''")) }
}

/// Returns the working directory if it is a study.
fn study_in_current_folder() -> Option<PathBuf> {
    Path::new(STUDY_FILE).is_file().then(|| PathBuf::from("."))
}

/// Ignores the signal that is sent if a write exceeds the file size limit. The write then fails with an error
/// instead of ending the program.
fn ignore_file_size_signal() {
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
}

/// Passes `--code` to the tool that an agent calls if no study is given, because some tools have a `code`
/// argument.
#[cfg(feature = "server")]
fn pass_code_to_tool(mut arguments: Arguments) -> Arguments {
    let text = arguments.code.clone().filter(|code| std::env::var("NOVAMIND_CODE").as_ref() != Ok(code));
    if let (None, Some(Command::Agent(options)), Some(code)) =
        (&arguments.study, &mut arguments.command, text)
    {
        options.restore_code_argument(code);
    }
    arguments
}

/// Executes the command in the arguments.
///
/// # Errors
/// The command failed. The error contains the exit code.
pub fn run(arguments: Arguments) -> Result<(), Failure> {
    if let Some(command) = &arguments.command
        && arguments.play != play::Options::default()
    {
        return Err(Failure::usage(format!(
            "options of `play` have no effect before a command: write them after it, as in `novamind play \
             --new --seed 1`; before `{}`, only --runs-dir and --as are allowed",
            command.name()
        )));
    }
    #[cfg(feature = "server")]
    let arguments = pass_code_to_tool(arguments);
    ignore_file_size_signal();
    // The host reads the files of the study itself, so it does not need the experimenter's code.
    #[cfg(all(feature = "server", unix))]
    if let Some(Command::Host(options)) = &arguments.command {
        return host::run(options, arguments.study.as_deref());
    }
    let from_environment = std::env::var_os("NOVAMIND_RUNS").map(PathBuf::from);
    let mut context = Context {
        configuration: Configuration::from_environment(),
        has_explicit_runs_folder: arguments.runs_dir.is_some() && arguments.runs_dir != from_environment,
        runs: arguments.runs_dir.or_else(Configuration::default_runs_folder),
        participant: arguments.whose.filter(|label| !label.is_empty()),
        study_folder: arguments.study.clone().or_else(study_in_current_folder),
        is_experimenter: false,
    };
    if let Some(folder) = &arguments.study {
        let is_visit = matches!(arguments.command, None | Some(Command::Play(_)));
        let study = Study::load(folder)?;
        let check = |code: &String| Ok::<_, Failure>(study.check_code(&context.runs_folder()?, code));
        let outcome = arguments.code.as_ref().map(check).transpose()?;
        let has_code = outcome == Some(CodeOutcome::Right);
        if is_visit && !has_code {
            let options = match arguments.command {
                Some(Command::Play(options)) => options,
                _ => arguments.play,
            };
            return play::guide_participant(folder, &options, &context);
        }
        context.is_experimenter = has_code;
        if !has_code {
            return Err(Failure::usage(match outcome {
                Some(CodeOutcome::Wait(seconds)) => {
                    return Err(Failure::usage(CodeOutcome::Wait(seconds).describe()));
                }
                Some(_) => {
                    "the code is wrong; this command needs the experimenter's code: give --code, or set NOVAMIND_CODE"
                }
                None => {
                    "with --study, this command needs the experimenter's code: give --code, or set NOVAMIND_CODE"
                }
            }));
        }
    }
    match arguments.command {
        None => play::run(arguments.play, &context),
        Some(Command::Play(options)) => play::run(options, &context),
        Some(Command::Run(options)) => run::run(&options, &context),
        Some(Command::Runs(options)) => runs::run(&options, &context),
        Some(Command::Replay(options)) => replay::run(&options, &context),
        Some(Command::Report(options)) => report::run(&options, &context),
        Some(Command::Query(options)) => query::run(&options, &context),
        Some(Command::Tools(options)) => tools::run(&options, &context),
        Some(Command::Tables(options)) => tables::run(&options, &context),
        Some(Command::Keys(options)) => keys::run(&options, &context),
        Some(Command::Pictures(options)) => pictures::run(&options, &context),
        Some(Command::Scenario(options)) => scenario::run(&options, &context),
        Some(Command::Lesson(options)) => lesson::run(options, &context),
        Some(Command::Class(options)) => class::run(options, &context),
        Some(Command::Study(options)) => study::run(options, &context),
        Some(Command::Lab(options)) => lab::run(&options, &context),
        #[cfg(feature = "server")]
        Some(Command::Agent(options)) => agent::run(&options, &context),
        #[cfg(feature = "server")]
        Some(Command::Serve(options)) => serve::run(&options, &context),
        #[cfg(feature = "server")]
        Some(Command::Mcp(options)) => mcp::run(&options, &context),
        #[cfg(all(feature = "server", unix))]
        Some(Command::Host(options)) => host::run(&options, arguments.study.as_deref()),
        Some(Command::Bench(options)) => bench::run(&options, &context),
        Some(Command::Doctor(options)) => doctor::run(&options, &context),
        Some(Command::Completions(options)) => completions::run(&options),
        Some(Command::Man(options)) => man::run(&options),
    }
}

/// Writes to standard output. If the reader closed the pipe, the failure has no message.
///
/// # Errors
/// Standard output cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Err(Failure::broken_pipe()),
        Err(error) => Err(Failure::failed(format!("cannot write to standard output: {error}"))),
        Ok(()) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resume_command_is_quoted_for_a_shell() {
        let context = |runs: &str, names_runs| Context {
            configuration: Configuration::bundled(),
            runs: Some(PathBuf::from(runs)),
            participant: None,
            has_explicit_runs_folder: names_runs,
            study_folder: None,
            is_experimenter: false,
        };
        let study = Path::new("pilot");
        assert_eq!(context("/data/runs", false).study_command(study), "novamind --study pilot");
        assert_eq!(
            context("/data/my runs", true).study_command(Path::new("Jo's study")),
            r"novamind --runs-dir '/data/my runs' --study 'Jo'\''s study'"
        );
        assert_eq!(
            context("/data/runs", true).resume_command(),
            "novamind --runs-dir /data/runs --run latest"
        );
    }
}
