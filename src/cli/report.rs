//! `novamind report`: reports on the result of a run or on how the run was played, or draws a card.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::output_file::write_text;
use super::{Context, Failure, print};
use crate::record::folder::runs::find_run_to_read;
use crate::record::trajectory::Trajectory;
use crate::report::{
    Logbook, RunReport, card_to_svg, card_to_text, report_to_html, report_to_markdown, session_to_html,
    session_to_markdown,
};
use crate::session::{Session, read_afterwards};

#[derive(Debug, Args)]
pub struct Options {
    /// ID of the run, or `latest` for the newest run
    run: String,
    /// Report on how the run was played: time, breaks, screens, queries and tools by week
    #[arg(long)]
    session: bool,
    /// Write a card to share: cash curve, turning points, three figures, seed, scenario and version
    #[arg(long, conflicts_with = "session")]
    card: bool,
    /// Format [default: markdown; with --card: text]
    #[arg(long, value_enum)]
    format: Option<ReportFormat>,
    /// Write to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Output format of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ReportFormat {
    /// Text with headings and tables
    Markdown,
    /// One self-contained web page with charts and without scripts
    Html,
    /// One JSON object; only with --session
    Json,
    /// Text of 80 columns; only with --card
    Text,
    /// A drawing of 1200 by 630 pixels; only with --card
    Svg,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let folder = find_run_to_read(&context.runs_folder()?, &options.run)?;
    let usual = if options.card { ReportFormat::Text } else { ReportFormat::Markdown };
    let format = options.format.unwrap_or(usual);
    context.authorize_view(&folder, "report", if options.session { "session" } else { "run" })?;
    let text = match options.session {
        _ if options.card => render_card(&folder, format)?,
        true => render_session(&folder, format)?,
        false => render_report(&folder, format)?,
    };
    let Some(path) = &options.out else {
        return print(&text);
    };
    write_text(path, &text)?;
    print(&format!("written: {}\n", path.display()))
}

/// Returns the report on the run in a folder. Does not modify the run.
fn render_report(folder: &Path, format: ReportFormat) -> Result<String, Failure> {
    let render = |write: fn(&RunReport) -> String| -> Result<String, Failure> {
        Ok(write(&RunReport::from_session(&Session::open_to_read(folder, true)?)))
    };
    match format {
        ReportFormat::Markdown => render(report_to_markdown),
        ReportFormat::Html => render(report_to_html),
        ReportFormat::Json => Err(Failure::usage(
            "a report is markdown or html; json needs --session. For figures, use `novamind query`",
        )),
        ReportFormat::Text | ReportFormat::Svg => Err(card_format_failure()),
    }
}

/// Returns the card of the run in a folder. Does not modify the run.
fn render_card(folder: &Path, format: ReportFormat) -> Result<String, Failure> {
    let write = match format {
        ReportFormat::Text => card_to_text,
        ReportFormat::Svg => card_to_svg,
        _ => return Err(Failure::usage("a card is text or svg")),
    };
    Ok(write(&RunReport::from_session(&Session::open_to_read(folder, true)?)))
}

fn card_format_failure() -> Failure {
    Failure::usage("text and svg need --card")
}

/// Returns the report on how the run in a folder was played. Does not modify the run.
fn render_session(folder: &Path, format: ReportFormat) -> Result<String, Failure> {
    let logbook = read_logbook(folder)?;
    Ok(match format {
        ReportFormat::Markdown => session_to_markdown(&logbook),
        ReportFormat::Html => session_to_html(&logbook),
        ReportFormat::Json => serde_json::to_string_pretty(&logbook).unwrap_or_default() + "\n",
        ReportFormat::Text | ReportFormat::Svg => return Err(card_format_failure()),
    })
}

/// Reads the logbook of the run in a folder.
pub fn read_logbook(folder: &Path) -> Result<Logbook, Failure> {
    let session = Session::open_to_read(folder, true)?;
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl"))?;
    let afterwards = read_afterwards(folder, &trajectory)?;
    Ok(Logbook::new(&session, &trajectory.lines, &afterwards.lines))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::folder::configuration::Configuration;
    use crate::record::trajectory::record::Via;
    use crate::session::{NewRun, Storage};

    #[test]
    fn report_renders_markdown_and_html() {
        let runs = tempfile::tempdir().expect("a folder");
        let new =
            NewRun { days: Some(21), storage: Storage::Runs(runs.path().to_owned()), ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        let forecasts = session.company().naive_forecasts();
        session.advance("wait and see", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        let id = session.manifest().id.clone();
        drop(session);
        let context = Context {
            configuration: Configuration::bundled(),
            runs: Some(runs.path().to_owned()),
            participant: None,
            has_explicit_runs_folder: true,
            study_folder: None,
            is_experimenter: false,
        };
        let written = |format: ReportFormat, name: &str| {
            let path = runs.path().join(name);
            let options = Options {
                run: "latest".to_owned(),
                session: false,
                card: false,
                format: Some(format),
                out: Some(path.clone()),
            };
            run(&options, &context).expect("a report");
            std::fs::read_to_string(path).expect("a file")
        };
        let markdown = written(ReportFormat::Markdown, "report.md");
        assert!(
            markdown.starts_with(&format!("# NovaMind · run {id}\n\n**Day 7 of 21. Cash is $")),
            "{markdown}"
        );
        assert!(markdown.contains("“wait and see”"), "{markdown}");
        assert!(written(ReportFormat::Html, "report.html").contains("<svg "));
        let card = |format: Option<ReportFormat>| {
            let path = runs.path().join(format!("card-{format:?}"));
            let options = Options {
                run: "latest".to_owned(),
                session: false,
                card: true,
                format,
                out: Some(path.clone()),
            };
            run(&options, &context).map(|()| std::fs::read_to_string(path).expect("a file"))
        };
        let text = card(None).expect("a card");
        assert!(text.starts_with("NovaMind · scenario default · seed "), "{text}");
        assert!(card(Some(ReportFormat::Svg)).expect("a card").starts_with("<svg "));
        assert_eq!(card(Some(ReportFormat::Html)).expect_err("no page").code, 2);
        let nowhere = Options {
            run: id,
            session: true,
            card: false,
            format: Some(ReportFormat::Html),
            out: Some("/nowhere/at/all.html".into()),
        };
        assert_eq!(run(&nowhere, &context).expect_err("no such folder").code, 1);
        let unknown =
            Options { run: "zzzz".to_owned(), session: false, card: false, format: None, out: None };
        assert_eq!(run(&unknown, &context).expect_err("no such run").code, 3);
    }
}
