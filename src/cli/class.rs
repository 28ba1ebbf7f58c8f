//! `novamind class`: hand out a lesson or a run to students, collect their submissions, and show the results.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, Subcommand};

use super::lesson::lesson_of;
use super::output_file::write_text;
use super::play::show_console;
use super::run::progress_bar;
use super::runs::{as_csv, tidy_up_on_signals};
use super::{Context, Failure, print};
use crate::console::effect::Effect;
use crate::lab::answers_to_companies;
use crate::record::files::write_whole;
use crate::record::folder::runs::find_run_to_read;
use crate::report::class::{
    ClassView, Shown, as_html, collected_in_words, columns_table, rows, shown_in_words,
};
use crate::report::count;
use crate::worker::request::Request;
use novamind_course::{Class, ClassCollection, ClassSources, CollectedClass, ToHandOut};

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
        /// Hand out a run instead, or `latest` for the newest; each student continues a branch of it
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
        /// Folders of runs and archives; subfolders are searched, too [default: the folder of the class]
        #[arg(value_name = "PLACE")]
        places: Vec<PathBuf>,
    },
    /// Show the collected results: ranking, curves, decisions, guesses, pitfalls
    Show {
        /// Folder of the class
        folder: PathBuf,
        /// Student whose curve is highlighted [default: the first in the ranking]
        #[arg(long, value_name = "LABEL")]
        student: Option<String>,
        /// Decision in the scatter plot, for example "price A" [default: the one in which students differ most]
        #[arg(long, value_name = "NAME")]
        decision: Option<String>,
        /// Figure in the scatter plot, for example subscribers [default: cash]
        #[arg(long, value_name = "NAME")]
        figure: Option<String>,
        /// Show ranks instead of labels, and nothing that identifies a student
        #[arg(long)]
        hide_names: bool,
        /// Write a page for a projector to this file, without scripts
        #[arg(long, value_name = "FILE")]
        html: Option<PathBuf>,
        /// Print text at a terminal instead of opening the screen
        #[arg(long, conflicts_with = "html")]
        text: bool,
    },
}

pub fn run(options: Options, context: &Context) -> Result<(), Failure> {
    match options.command {
        ClassCommand::New { lesson, from, students, out } => {
            let what = match (lesson, from) {
                (Some(lesson), _) => ToHandOut::Lesson(Arc::new(lesson_of(&lesson, &context.configuration)?)),
                (None, Some(run)) => {
                    let folder = find_run_to_read(&context.runs()?, &run)?;
                    context.look(&folder, "class", "hand out")?;
                    ToHandOut::Run(folder)
                }
                (None, None) => return Err(Failure::usage("name a lesson, or a run with --from RUN")),
            };
            new(&what, students, &out)
        }
        ClassCommand::Collect { folder, places } => collect(&folder, &places),
        ClassCommand::Show { folder, student, decision, figure, hide_names, html, text } => {
            let shown = Shown { hides_names: hide_names, lit: student, decision, figure };
            let is_seen = std::io::stdout().is_terminal() && std::io::stdin().is_terminal();
            let on_screen = is_seen && !text && html.is_none();
            show(&folder, shown, html.as_deref(), on_screen.then_some(context))
        }
    }
}

fn new(what: &ToHandOut, students: u32, out: &Path) -> Result<(), Failure> {
    tidy_up_on_signals();
    let class = Class::create(out, what, students)?;
    let (first, last) = (class.students.first(), class.students.last());
    let names = first.zip(last).map(|(first, last)| format!("{}.nm to {}.nm", first.label, last.label));
    print(&format!(
        "class {}: {} for {} in {}\nTo play, a student runs: novamind play --handout {}.nm\nTo collect the submissions, run: \
         novamind class collect {} PLACES\n",
        class.class,
        names.unwrap_or_default(),
        count(students, "student"),
        out.display(),
        first.map_or("S01", |first| &first.label),
        out.display()
    ))
}

fn collect(folder: &Path, places: &[PathBuf]) -> Result<(), Failure> {
    tidy_up_on_signals();
    let class = Class::read(folder)?;
    let own = [folder.to_owned()];
    let sources =
        ClassSources { class: &class, folder, places: if places.is_empty() { &own } else { places } };
    let mut bar = None;
    let collection = ClassCollection::collect(&sources, answers_to_companies, &mut |done, all| {
        bar.get_or_insert_with(|| progress_bar(all as u64, "runs")).set_position(done as u64);
    })?;
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    let lesson = class.lesson_kept(folder)?;
    let view = ClassView {
        class: &class,
        lesson: lesson.as_ref(),
        collection: &collection,
        shown: Shown::default(),
    };
    for (file, table) in [("class.csv", rows(&view)), ("class-columns.csv", columns_table(&view))] {
        write_whole(&folder.join(file), as_csv(&table)?.as_bytes())?;
    }
    print(&format!(
        "{}class.csv and class-columns.csv are in {}; `novamind class show {}` shows the results\n",
        collected_in_words(&view),
        folder.display(),
        folder.display()
    ))?;
    match collection.findings.len() as u32 {
        0 => Ok(()),
        findings => Err(Failure::failed(format!("{} to check", count(findings, "finding")))),
    }
}

fn show(folder: &Path, shown: Shown, html: Option<&Path>, screen: Option<&Context>) -> Result<(), Failure> {
    let class = CollectedClass::read(folder)?;
    let view = ClassView::of(&class, shown);
    view.check().map_err(Failure::usage)?;
    if let Some(context) = screen {
        let start = Effect::Request(Request::ReadClass(folder.to_owned(), view.shown));
        return show_console(&super::play::Options::default(), Some(start), context);
    }
    let Some(path) = html else { return print(&shown_in_words(&view)) };
    write_text(path, &as_html(&view))?;
    print(&format!("written: {}\n", path.display()))
}
