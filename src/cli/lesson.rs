//! `novamind lesson`: list, show, copy, play and check lessons.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, Subcommand};

use super::output_file::write_text;
use super::{Context, Failure, print};
use crate::course::{FinishedPart, Lesson, MEASURED_SEEDS};
use crate::formatting::compact_number;
use crate::lab::{LessonCheck, PlayResult, check_lesson};
use crate::record::folder::configuration::Configuration;
use crate::record::folder::runs::find_run_to_read;
use crate::report::debrief::debrief_paragraphs;
use crate::report::{debrief_to_html, debrief_to_markdown};
use crate::rules::calls_for_waiting_threads;
use crate::session::Session;

#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: LessonCommand,
}

#[derive(Debug, Subcommand)]
enum LessonCommand {
    /// List all lessons
    List,
    /// Show the task of a lesson and the notes for its instructor
    Show {
        /// Name of the lesson, or path of its file
        lesson: String,
    },
    /// Copy the two files of a lesson under another name, as the start of a new lesson
    Copy {
        /// Name of the lesson, or path of its file
        lesson: String,
        /// Name of the new lesson, or path of its file, which must end in .toml
        to: String,
    },
    /// Play a lesson
    Play {
        /// Name of the lesson, or path of its file
        #[arg(id = "name", value_name = "LESSON")]
        name: String,
        #[command(flatten)]
        play: Box<super::play::Options>,
    },
    /// Compare a finished part of a lesson with the reference play and the play that triggers the pitfall
    Debrief {
        /// ID of the run, or `latest` for the newest run
        run: String,
        /// Write the debrief to this file as a web page
        #[arg(long, value_name = "FILE", conflicts_with = "markdown")]
        html: Option<PathBuf>,
        /// Write the debrief to this file as Markdown
        #[arg(long, value_name = "FILE")]
        markdown: Option<PathBuf>,
    },
    /// Play the reference plays of lessons on six seeds: check goals, pitfalls, and the figures that the texts name
    Check {
        /// Name of a lesson, or path of its file [default: all lessons]
        lesson: Option<String>,
    },
}

pub fn run(options: Options, context: &Context) -> Result<(), Failure> {
    let configuration = &context.configuration;
    match options.command {
        LessonCommand::Play { name, play } => {
            super::play::run(super::play::Options::for_lesson(name, *play), context)
        }
        LessonCommand::Debrief { run, html, markdown } => write_debrief(&run, html, markdown, context),
        LessonCommand::List => list_lessons(configuration),
        LessonCommand::Show { lesson } => print(&describe_lesson(&find_lesson(&lesson, configuration)?)),
        LessonCommand::Copy { lesson, to } => copy_lesson(&lesson, &to, configuration),
        LessonCommand::Check { lesson: Some(lesson) } => check_lessons(&[lesson], configuration),
        LessonCommand::Check { lesson: None } => check_lessons(&configuration.lesson_names(), configuration),
    }
}

fn copy_lesson(lesson: &str, to: &str, configuration: &Configuration) -> Result<(), Failure> {
    let from = find_lesson(lesson, configuration)?;
    let path = match is_file_path(to) {
        true => PathBuf::from(to),
        false if configuration.lesson_names().iter().any(|known| known == to) => {
            return Err(Failure::usage(format!("lesson {to} already exists: choose another name")));
        }
        false
            if to.is_empty() || !to.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_')) =>
        {
            return Err(Failure::usage(format!(
                "{to:?}: a lesson name may contain letters, digits, - and _"
            )));
        }
        false => configuration.user_lesson_file(to).ok_or_else(|| {
            Failure::usage("this system has no configuration folder: give the path of a file")
        })?,
    };
    if path.extension().is_none_or(|ending| ending != "toml") {
        return Err(Failure::usage(format!("{to}: the name of a lesson file must end in .toml")));
    }
    from.copy_to(&path)?;
    let name = if is_file_path(to) { path.display().to_string() } else { to.to_owned() };
    print(&format!(
        "wrote {} and {}\nedit them, then run: novamind lesson check {name}\n",
        path.display(),
        path.with_extension("md").display()
    ))
}

/// Returns whether a word is the path of a file rather than a name.
fn is_file_path(name: &str) -> bool {
    Path::new(name).components().count() > 1 || name.ends_with(".toml")
}

/// Finds a lesson by its name or by the path of its file.
pub(super) fn find_lesson(name: &str, configuration: &Configuration) -> Result<Lesson, Failure> {
    Ok(if is_file_path(name) {
        Lesson::from_file(Path::new(name))?
    } else {
        Lesson::load(name, configuration)?
    })
}

fn list_lessons(configuration: &Configuration) -> Result<(), Failure> {
    let (mut text, mut unreadable) = (String::new(), Vec::new());
    for name in configuration.lesson_names() {
        match Lesson::load(&name, configuration) {
            Ok(lesson) => {
                let plan = &lesson.plan;
                text += &format!("{name:<24}  {:>3} min  {}\n", plan.minutes, plan.title);
            }
            // An invalid file is reported after the list of the other lessons.
            Err(error) => unreadable.push(error.to_string()),
        }
    }
    print(&text)?;
    if unreadable.is_empty() { Ok(()) } else { Err(Failure::unreadable(unreadable.join("\n"))) }
}

/// Prints the debrief of a run, or writes it to a file. Does not modify the run.
fn write_debrief(
    run: &str,
    html: Option<PathBuf>,
    markdown: Option<PathBuf>,
    context: &Context,
) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs_folder()?, run)?;
    context.authorize_view(&folder, "lesson", "debrief")?;
    let session = Session::open_to_read(&folder, true)?;
    let played =
        FinishedPart::from_session(&session).map_err(|rejection| Failure::failed(rejection.message))?;
    let debrief = played.debrief(calls_for_waiting_threads);
    let (path, text) = match (html, markdown) {
        (Some(path), _) => (path, debrief_to_html(&debrief)),
        (None, Some(path)) => (path, debrief_to_markdown(&debrief)),
        (None, None) => return print(&(debrief_paragraphs(&debrief).join("\n") + "\n")),
    };
    write_text(&path, &text)?;
    print(&format!("written: {}\n", path.display()))
}

/// Formats the task, goals and hints of a lesson, its debrief, and the notes for the instructor.
fn describe_lesson(lesson: &Lesson) -> String {
    let plan = &lesson.plan;
    let mut text = format!("{}\n{} minutes. {}\n", plan.title, plan.minutes, plan.learning_goal);
    for part in &plan.parts {
        for step in &part.steps {
            let weeks = crate::report::pluralize(step.weeks, "week");
            text += &format!("\n{} ({weeks})\n{}\n", step.title, lesson.fill_figures(&step.text));
            for goal in &step.goals {
                text += &format!("  goal: {}\n", lesson.fill_figures(&goal.text));
            }
            for hint in &step.hints {
                text += &format!("  hint: {}\n", lesson.fill_figures(hint));
            }
        }
    }
    text += &format!("\nReference play: {}\nPitfall play: {}\n", plan.good.text, plan.bad.text);
    for (heading, section) in [("Debrief", &lesson.debrief), ("For the instructor", &lesson.instructor_notes)]
    {
        text += &format!("\n{heading}\n\n{}\n", lesson.fill_figures(section));
    }
    text
}

fn check_lessons(names: &[String], configuration: &Configuration) -> Result<(), Failure> {
    let mut failed = 0;
    for name in names {
        let lesson = Arc::new(find_lesson(name, configuration)?);
        let check = check_lesson(&lesson)
            .map_err(|error| Failure::from(error).with_subject(&format!("lesson {name}")))?;
        let problems = check.describe_problems();
        failed += usize::from(!problems.is_empty());
        print(&describe_check(&lesson, &check, &problems))?;
    }
    match failed {
        0 => Ok(()),
        failed => Err(Failure::failed(format!("{failed} of {} lessons failed the check", names.len()))),
    }
}

fn describe_check(lesson: &Lesson, check: &LessonCheck, problems: &[String]) -> String {
    let verdict = if problems.is_empty() { "passed" } else { "FAILED" };
    let mut text = format!(
        "{}: {verdict} on seeds {} to {}\n",
        lesson.name,
        MEASURED_SEEDS.start(),
        MEASURED_SEEDS.end()
    );
    for (name, plays) in [("good", &check.reference_results), ("bad", &check.pitfall_results)] {
        for (at, goal) in plays.iter().take(1).flat_map(|play| play.goals.iter().enumerate()) {
            text += &format!("  {name:<4}  {:<44}  {}\n", goal.text, goal_values(plays, at));
        }
    }
    let plays = check.reference_results.iter().chain(&check.pitfall_results);
    if plays.flat_map(|play| &play.goals).any(|goal| !goal.is_met) {
        text += "  (in parentheses: not reached)\n";
    }
    for figure in &check.figures {
        let stated = &figure.stated;
        text += &format!(
            "  {}: {} (stated {})\n",
            stated.text,
            stated.format_value(figure.mean),
            stated.formatted_value()
        );
    }
    for problem in problems {
        text += &format!("  ! {problem}\n");
    }
    text
}

/// Formats the value that each play reaches for a goal, in the order of the plays. Values that do not reach the goal
/// are in parentheses.
fn goal_values(plays: &[PlayResult], at: usize) -> String {
    let written = plays.iter().filter_map(|play| play.goals.get(at)).map(|goal| {
        let value = goal.value.map_or_else(|| "-".to_owned(), compact_number);
        if goal.is_met { value } else { format!("({value})") }
    });
    written.collect::<Vec<String>>().join(" ")
}
