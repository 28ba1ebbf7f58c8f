//! `novamind play`: plays in the console or line by line.

use std::io::{ErrorKind, IsTerminal};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;

use super::new_run::NewRunOptions;
use super::{Context, Failure};
use crate::console::app::Settings;
use crate::console::effect::Effect;
use crate::console::keys::KeyBindings;
use crate::console::themes;
use crate::lab::play_opponents;
use crate::plain::Entrance;
use crate::record::clock::monotonic_time;
use crate::record::consent::{ConsentDetails, ConsentMeans};
use crate::record::error::RunError;
use crate::record::folder::configuration::Configuration;
use crate::record::folder::query_library::QueryLibrary;
use crate::record::folder::runs::find_run;
use crate::record::mode::Mode;
use crate::session::{Access, LessonOptions, NewRun, SeekTarget, Session};
use crate::tui::glyphs::Glyphs;
use crate::tui::theme::Theme;
use crate::worker::preferences::Preferences;
use crate::worker::request::{RecordSource, Request};
use novamind_course::Handout;
use novamind_study::Study;

#[derive(Debug, Args, Clone, Default, PartialEq)]
pub struct Options {
    /// Open a run; `latest` is the newest unfinished run
    #[arg(long, value_name = "ID", conflicts_with_all = ["new", "seed", "days", "cash", "scenario", "mode", "participant", "set", "planted", "lesson"])]
    run: Option<String>,
    /// Follow a run read-only while someone else plays it
    #[arg(long, requires = "run")]
    watch: bool,
    /// With --watch: show four figures, the cash curve and the decisions, readable from a distance
    #[arg(long, requires = "watch")]
    big: bool,
    /// Start a new run
    #[arg(long)]
    new: bool,
    #[command(flatten)]
    made_of: NewRunOptions,
    /// Play a lesson
    #[arg(long, value_name = "NAME", conflicts_with_all = ["seed", "days", "cash", "scenario", "mode", "set", "planted"])]
    lesson: Option<String>,
    /// Start or continue a handout of a class, in the folder of its student
    #[arg(long, value_name = "FILE", conflicts_with_all = ["run", "new", "seed", "days", "cash", "scenario", "mode", "participant", "set", "planted", "lesson", "watch"])]
    handout: Option<PathBuf>,
    /// Use the language model of this settings file as the voice of the run
    #[arg(long, value_name = "FILE", conflicts_with_all = ["watch", "lesson", "handout"])]
    voice: Option<PathBuf>,
    /// Theme of the console
    #[arg(long, value_name = "NAME")]
    theme: Option<String>,
    /// Draw without box and braille characters
    #[arg(long)]
    ascii: bool,
    /// Play line by line
    #[arg(long)]
    plain: bool,
    /// With --plain: print the output as one JSON object per line
    #[arg(long)]
    json: bool,
    /// With --plain: print each input line before its output
    #[arg(long)]
    echo: bool,
    /// With --plain: stop at the first rejected or invalid line
    #[arg(long)]
    strict: bool,
}

impl Options {
    fn requests_new_run(&self) -> bool {
        self.new || self.made_of.is_specified() || self.lesson.is_some() || self.handout.is_some()
    }

    fn new_run(&self, context: &Context) -> Result<NewRun, Failure> {
        let mode = if self.lesson.is_some() { Mode::Lesson } else { Mode::Sandbox };
        let lesson = self.lesson_options(context)?;
        Ok(NewRun { lesson, ..self.made_of.new_run(mode, context)? })
    }
}

impl Options {
    /// Returns the options that start a lesson.
    pub fn for_lesson(name: String, options: Options) -> Options {
        Options { lesson: Some(name), ..options }
    }

    fn lesson_options(&self, context: &Context) -> Result<Option<LessonOptions>, Failure> {
        let Some(name) = &self.lesson else { return Ok(None) };
        let lesson = super::lesson::find_lesson(name, &context.configuration)?;
        Ok(Some(LessonOptions { lesson: Arc::new(lesson), part: 0, is_judged: true }))
    }
}

pub fn run(options: Options, context: &Context) -> Result<(), Failure> {
    if let Some(path) = &options.handout {
        let handout = Handout::read(path)?;
        let student_context = context.for_student(&handout.label)?;
        let run = Some(handout.ensure_run(&context.runs_root()?)?);
        return self::run(Options { run, handout: None, ..options }, &student_context);
    }
    let context = &context.with_voice(options.voice.as_deref())?;
    if let Some(id) = &options.run {
        context.check_play_allowed(&find_run(&context.runs_folder()?, id)?)?;
    }
    if uses_plain_mode(&options) { play_plain(&options, context) } else { play_console(&options, context) }
}

/// Returns whether the game is played line by line.
fn uses_plain_mode(options: &Options) -> bool {
    options.plain || !std::io::stdout().is_terminal() || !std::io::stdin().is_terminal()
}

/// Guides a participant through a study. The protocol determines the runs, so options of a run are rejected.
pub fn guide_participant(folder: &Path, options: &Options, context: &Context) -> Result<(), Failure> {
    if options.run.is_some() || options.voice.is_some() || options.requests_new_run() {
        return Err(Failure::usage(
            "the protocol of the study determines the runs: leave out --run, --voice and the options of a new run",
        ));
    }
    if let Some(label) = &context.participant {
        return Err(Failure::usage(format!(
            "participants of a study enter their label on the first page: leave out --as {label}"
        )));
    }
    let study = Study::load(folder)?;
    let again = context.study_command(folder);
    if !uses_plain_mode(options) {
        return show_console_with_resume_command(
            options,
            Some(Effect::StartStudy(Box::new(study))),
            context,
            again,
        );
    }
    let style = crate::plain::OutputStyle { json: options.json, echo: options.echo, strict: options.strict };
    let base = context.runs_folder()?;
    let again = if options.plain { format!("{again} --plain") } else { again };
    let entrance = Entrance::Label(&again);
    exit_with(crate::plain::run_participant_session(study, &base, &context.configuration, style, entrance)?)
}

/// Runs the hosted session of a participant in this terminal, from the participant's next step to the end or until the
/// participant leaves. `folder` is the folder of the session, which contains `study` and `runs`.
///
/// Makes `folder` the working folder of the process and uses only relative paths, so that no message contains a path
/// of the server. Reads no configuration of the user.
///
/// # Errors
/// The folder or the study cannot be read, or the terminal fails. The failure contains the exit code of a session that
/// did not end normally.
#[cfg(all(feature = "server", unix))]
pub fn run_hosted_session(folder: &Path, label: &str, plain: bool) -> Result<(), Failure> {
    std::env::set_current_dir(folder)
        .map_err(|error| Failure::failed(format!("the folder of the session cannot be opened: {error}")))?;
    let study = Study::load(Path::new("study"))?;
    let (runs, configuration) = (PathBuf::from("runs"), Configuration::bundled());
    if plain {
        let style = crate::plain::OutputStyle::default();
        let entrance = Entrance::Hosted(label);
        return exit_with(crate::plain::run_participant_session(
            study,
            &runs,
            &configuration,
            style,
            entrance,
        )?);
    }
    let settings = Settings {
        theme: themes::find_theme("dark", &configuration).map_err(Failure::usage)?,
        keys: KeyBindings::bundled(),
        glyphs: Glyphs::Braille,
        configuration,
        runs,
        resume_command: String::new(),
        lists_all_participants: false,
        hosted: true,
        opponents: play_opponents,
    };
    open_console(settings, Some(Effect::StartHostedSession(Box::new(study), label.to_owned())))
}

/// Converts the exit code of a session to a result.
fn exit_with(code: u8) -> Result<(), Failure> {
    if code == 0 { Ok(()) } else { Err(Failure::code_only(code)) }
}

fn open_run(options: &Options, context: &Context) -> Result<Session, Failure> {
    match &options.run {
        Some(id) => {
            let folder = find_run(&context.runs_folder()?, id)?;
            Ok(match options.watch {
                true => Session::open_to_read(&folder, true)?,
                false => Session::open_to_play(&folder, &context.configuration)?,
            })
        }
        None => create_run(options.new_run(context)?, context),
    }
}

/// Creates a run to play. At a terminal, asks the participant for consent if the configuration requires consent.
fn create_run(new: NewRun, context: &Context) -> Result<Session, Failure> {
    match Session::create(new.clone(), &context.configuration) {
        Err(RunError::ConsentNeeded(text)) if std::io::stdin().is_terminal() => {
            let shown = monotonic_time();
            eprint!("{}\n\nType yes to agree: ", text.text.trim_end());
            let mut answer = String::new();
            let read = std::io::stdin().read_line(&mut answer);
            if read.is_err() || !answer.trim().eq_ignore_ascii_case("yes") {
                return Err(Failure::failed(
                    "you did not agree; no run was created and nothing was recorded".to_owned(),
                ));
            }
            let consent_given = ConsentDetails {
                means: ConsentMeans::Prompt,
                scrolled_to_end: true,
                read_ms: monotonic_time().saturating_sub(shown).as_millis() as u64,
            };
            Ok(Session::create(
                NewRun { agreed: Some(consent_given.agree_now()), ..new },
                &context.configuration,
            )?)
        }
        created => Ok(created?),
    }
}

fn play_plain(options: &Options, context: &Context) -> Result<(), Failure> {
    let style = crate::plain::OutputStyle { json: options.json, echo: options.echo, strict: options.strict };
    let code =
        crate::plain::play(open_run(options, context)?, QueryLibrary::load(&context.configuration), style)
            .map_err(|error| match error.kind() {
                // The reader of the output, for example `head`, closed the pipe.
                ErrorKind::BrokenPipe => Failure::code_only(1),
                _ => Failure::failed(error.to_string()),
            })?;
    exit_with(code)
}

fn play_console(options: &Options, context: &Context) -> Result<(), Failure> {
    let start = match &options.run {
        Some(id) if options.watch => {
            let recorded = RecordSource::Run(id.clone());
            Some(if options.big {
                Effect::OpenProjector(recorded)
            } else {
                Effect::Request(Request::Replay { recorded, goal: SeekTarget::Last, follow: true })
            })
        }
        Some(id) => Some(Effect::Request(Request::Open(id.clone(), Access::Write))),
        None if options.requests_new_run() => {
            Some(Effect::Request(Request::Create(Box::new(options.new_run(context)?))))
        }
        None => None,
    };
    show_console(options, start, context)
}

/// Returns the given theme. If no theme was given, returns `mono` if the terminal disables color, otherwise the last
/// chosen theme.
fn select_theme(
    options: &Options,
    no_colour: bool,
    chosen: &Preferences,
    configuration: &Configuration,
) -> Result<Theme, Failure> {
    let asked = options.theme.as_deref().or(no_colour.then_some("mono"));
    let remembered = chosen.theme.as_deref().filter(|_| asked.is_none());
    // If the last chosen theme no longer exists, the console opens with another theme.
    if let Some(theme) = remembered.and_then(|name| themes::find_theme(name, configuration).ok()) {
        return Ok(theme);
    }
    themes::find_theme(asked.unwrap_or("dark"), configuration).map_err(Failure::usage)
}

/// Opens the console with an initial effect.
pub fn show_console(options: &Options, start: Option<Effect>, context: &Context) -> Result<(), Failure> {
    show_console_with_resume_command(options, start, context, context.resume_command())
}

/// Opens the console. After the console closes, prints `again`, the command that continues the run.
fn show_console_with_resume_command(
    options: &Options,
    start: Option<Effect>,
    context: &Context,
    again: String,
) -> Result<(), Failure> {
    let no_colour = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let chosen = Preferences::load(&context.configuration);
    let theme = select_theme(options, no_colour, &chosen, &context.configuration)?;
    let keys = KeyBindings::with_user_file(&context.configuration).map_err(Failure::unreadable)?;
    let settings = Settings {
        theme,
        keys,
        glyphs: if options.ascii { Glyphs::Ascii } else { chosen.marker.unwrap_or(Glyphs::Braille) },
        configuration: context.configuration.clone(),
        runs: context.runs_folder()?,
        resume_command: again,
        lists_all_participants: context.is_experimenter,
        hosted: false,
        opponents: play_opponents,
    };
    open_console(settings, start)
}

/// Opens the console and prints its farewell.
fn open_console(settings: Settings, start: Option<Effect>) -> Result<(), Failure> {
    let (code, farewell) = crate::console::run_console(settings, start)
        .map_err(|error| Failure::failed(format!("cannot use the terminal: {error}")))?;
    if let Some(text) = farewell {
        println!("{text}");
    }
    exit_with(code)
}
