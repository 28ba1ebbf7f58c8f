//! `novamind class`: hand out a lesson or a run to students, collect their submissions, and show the results.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, Subcommand};

use super::lesson::find_lesson;
use super::output_file::write_text;
use super::play::show_console;
use super::run::progress_bar;
use super::runs::{remove_partial_files_on_signals, to_csv};
use super::{Context, Failure, print};
use crate::console::effect::Effect;
use crate::lab::calls_for_waiting_threads;
use crate::record::files::write_atomically;
use crate::record::folder::runs::find_run_to_read;
use crate::report::class::{
    ClassDisplayOptions, ClassView, class_to_html, class_to_text, column_descriptions, describe_collection,
    rows,
};
use crate::report::pluralize;
use crate::worker::request::Request;
use novamind_course::{Class, ClassCollection, CollectedClass, CollectionInput, HandoutSource};

#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: ClassCommand,
}

#[derive(Debug, Subcommand)]
enum ClassCommand {
    /// Create a handout for each student, with a lesson or with a run up to the end of its last week
    New {
        /// Name of the lesson, or path of its file
        #[arg(required_unless_present = "from", conflicts_with = "from")]
        lesson: Option<String>,
        /// Run to hand out instead of a lesson, or `latest` for the newest run; each student continues a branch of this run
        #[arg(long, value_name = "RUN")]
        from: Option<String>,
        /// Number of students, from 1 to 999
        #[arg(long, value_name = "N")]
        students: u32,
        /// Folder of the class
        #[arg(long, value_name = "DIR")]
        out: PathBuf,
    },
    /// Collect and check the submissions; write class.csv and class-columns.csv to the folder of the class
    Collect {
        /// Folder of the class
        folder: PathBuf,
        /// Folders of runs and archives, which are searched with their subfolders [default: the folder of the class]
        #[arg(value_name = "PLACE")]
        places: Vec<PathBuf>,
    },
    /// Show the collected results: ranking, curves, decisions, guesses, pitfalls
    Show {
        /// Folder of the class
        folder: PathBuf,
        /// Student whose curve is highlighted [default: the student ranked first]
        #[arg(long, value_name = "LABEL")]
        student: Option<String>,
        /// Decision in the scatter plot, for example "price A" [default: the decision in which students differ most]
        #[arg(long, value_name = "NAME")]
        decision: Option<String>,
        /// Figure in the scatter plot, for example subscribers [default: cash]
        #[arg(long, value_name = "NAME")]
        figure: Option<String>,
        /// Show ranks instead of labels, so that no student can be identified
        #[arg(long)]
        hide_names: bool,
        /// Write the results to this file as a web page without scripts, for a projector
        #[arg(long, value_name = "FILE")]
        html: Option<PathBuf>,
        /// Print text instead of opening the screen
        #[arg(long, conflicts_with = "html")]
        text: bool,
    },
}

pub fn run(options: Options, context: &Context) -> Result<(), Failure> {
    match options.command {
        ClassCommand::New { lesson, from, students, out } => {
            let what = match (lesson, from) {
                (Some(lesson), _) => {
                    HandoutSource::Lesson(Arc::new(find_lesson(&lesson, &context.configuration)?))
                }
                (None, Some(run)) => {
                    let folder = find_run_to_read(&context.runs_folder()?, &run)?;
                    context.authorize_view(&folder, "class", "hand out")?;
                    HandoutSource::Run(folder)
                }
                (None, None) => return Err(Failure::usage("name a lesson, or a run with --from RUN")),
            };
            create_class(&what, students, &out)
        }
        ClassCommand::Collect { folder, places } => collect_class(&folder, &places),
        ClassCommand::Show { folder, student, decision, figure, hide_names, html, text } => {
            let display_options = ClassDisplayOptions {
                hides_names: hide_names,
                highlighted_student: student,
                decision,
                figure,
            };
            let is_interactive = std::io::stdout().is_terminal() && std::io::stdin().is_terminal();
            let on_screen = is_interactive && !text && html.is_none();
            show_class(&folder, display_options, html.as_deref(), on_screen.then_some(context))
        }
    }
}

fn create_class(what: &HandoutSource, students: u32, out: &Path) -> Result<(), Failure> {
    remove_partial_files_on_signals();
    let class = Class::create(out, what, students)?;
    let (first, last) = (class.students.first(), class.students.last());
    let names = first.zip(last).map(|(first, last)| format!("{}.nm to {}.nm", first.label, last.label));
    print(&format!(
        "class {}: {} for {} in {}\nTo play, a student runs: novamind play --handout {}.nm\nTo collect the submissions, run: \
         novamind class collect {} PLACES\n",
        class.class,
        names.unwrap_or_default(),
        pluralize(students, "student"),
        out.display(),
        first.map_or("S01", |first| &first.label),
        out.display()
    ))
}

fn collect_class(folder: &Path, places: &[PathBuf]) -> Result<(), Failure> {
    remove_partial_files_on_signals();
    let class = Class::read(folder)?;
    let paths = [folder.to_owned()];
    let sources =
        CollectionInput { class: &class, folder, places: if places.is_empty() { &paths } else { places } };
    let mut bar = None;
    let collection = ClassCollection::collect(&sources, calls_for_waiting_threads, &mut |done, all| {
        bar.get_or_insert_with(|| progress_bar(all as u64, "runs")).set_position(done as u64);
    })?;
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let lesson = class.stored_lesson(folder)?;
    let view = ClassView {
        class: &class,
        lesson: lesson.as_ref(),
        collection: &collection,
        display: ClassDisplayOptions::default(),
    };
    for (file, table) in [("class.csv", rows(&view)), ("class-columns.csv", column_descriptions(&view))] {
        write_atomically(&folder.join(file), to_csv(&table)?.as_bytes())?;
    }
    print(&format!(
        "{}class.csv and class-columns.csv are in {}; `novamind class show {}` shows the results\n",
        describe_collection(&view),
        folder.display(),
        folder.display()
    ))?;
    match collection.findings.len() as u32 {
        0 => Ok(()),
        findings => Err(Failure::failed(format!("{} to check", pluralize(findings, "finding")))),
    }
}

fn show_class(
    folder: &Path,
    display_options: ClassDisplayOptions,
    html: Option<&Path>,
    screen: Option<&Context>,
) -> Result<(), Failure> {
    let class = CollectedClass::read(folder)?;
    let view = ClassView::new(&class, display_options);
    view.check().map_err(Failure::usage)?;
    if let Some(context) = screen {
        let start = Effect::Request(Request::ReadClass(folder.to_owned(), view.display));
        return show_console(&super::play::Options::default(), Some(start), context);
    }
    let Some(path) = html else { return print(&class_to_text(&view)) };
    write_text(path, &class_to_html(&view))?;
    print(&format!("written: {}\n", path.display()))
}
