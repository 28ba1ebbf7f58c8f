//! `novamind report`: a run told, as Markdown or as a page for a browser.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Context, Failure, print};
use crate::report::{Story, as_html, as_markdown};
use crate::session::{Access, Session, find_run_to_read};

/// Options of `report`.
#[derive(Debug, Args)]
pub struct Options {
    /// Run, or `latest`: the newest.
    run: String,
    /// Format of the report.
    #[arg(long, value_enum, default_value = "markdown")]
    format: Format,
    /// Write it into this file instead of standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Format of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Text with headings and tables.
    Markdown,
    /// One page with charts, without scripts and other files.
    Html,
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs()?, &options.run)?;
    let text = report_of(&folder, options.format)?;
    let Some(path) = &options.out else {
        return print(&text);
    };
    std::fs::write(path, text).map_err(|error| Failure::failed(format!("{}: {error}", path.display())))?;
    print(&format!("written: {}\n", path.display()))
}

/// The report of the run in a folder; nothing of the run is changed.
fn report_of(folder: &Path, format: Format) -> Result<String, Failure> {
    let story = Story::of(&Session::open(folder, Access::Read, true)?);
    Ok(match format {
        Format::Markdown => as_markdown(&story),
        Format::Html => as_html(&story),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Configuration, NewRun, Storage, Via};

    #[test]
    fn a_run_on_the_disk_is_told_in_both_formats() {
        let runs = tempfile::tempdir().expect("a folder");
        let new =
            NewRun { days: Some(21), storage: Storage::Runs(runs.path().to_owned()), ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
        let forecasts = session.naive_forecasts();
        session.advance("wait and see", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        let id = session.manifest().id.clone();
        drop(session);
        let context = Context {
            configuration: Configuration::shipped(),
            runs: Some(runs.path().to_owned()),
            participant: None,
        };
        let written = |format: Format, name: &str| {
            let path = runs.path().join(name);
            let options = Options { run: "latest".to_owned(), format, out: Some(path.clone()) };
            run(&options, &context).expect("a report");
            std::fs::read_to_string(path).expect("a file")
        };
        let markdown = written(Format::Markdown, "report.md");
        assert!(
            markdown.starts_with(&format!("# NovaMind · run {id}\n\n**Day 7 of 21. Cash is $")),
            "{markdown}"
        );
        assert!(markdown.contains("“wait and see”"), "{markdown}");
        assert!(written(Format::Html, "report.html").contains("<svg "));
        let nowhere = Options { run: id, format: Format::Html, out: Some("/nowhere/at/all.html".into()) };
        assert_eq!(run(&nowhere, &context).expect_err("no such folder").code, 1);
        let unknown = Options { run: "zzzz".to_owned(), format: Format::Html, out: None };
        assert_eq!(run(&unknown, &context).expect_err("no such run").code, 3);
    }
}
