//! Guides a participant through a study in plain mode: label, consent, practice, session, questions and thanks.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use serde_json::json;

use super::input::InputLine;
use super::line_source::LineSource;
use super::{EndReason, OutputStyle, Participant, confirm_withdrawal, run_dialogue, show_prompt};
use novamind_base::formatting::escape_control_characters;
use novamind_record::clock::monotonic_time;
use novamind_record::consent::{ConsentAgreement, ConsentDetails, ConsentMeans};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::query_library::QueryLibrary;
use novamind_report::prose::to_plain_text;
use novamind_session::Session;
use novamind_study::{
    CLOSE_WINDOW_NOTICE, DECLINED_NOTICE, NextStep, ParticipantSession, RETURN_LATER_NOTICE, Study,
};

/// The reason why a visit ends early.
enum SessionStop {
    /// The participant left or the input ended. The value is the exit code.
    Left(u8),
    /// A run or a file cannot be read.
    Run(RunError),
    /// Standard input or output fails.
    Io(io::Error),
}

impl From<RunError> for SessionStop {
    fn from(error: RunError) -> SessionStop {
        SessionStop::Run(error)
    }
}

impl From<io::Error> for SessionStop {
    fn from(error: io::Error) -> SessionStop {
        SessionStop::Io(error)
    }
}

/// How a participant reaches the session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Entrance<'a> {
    /// The participant enters a label on this computer. The text is the command that continues the study.
    Label(&'a str),
    /// The participant with this label has a hosted session.
    Hosted(&'a str),
}

impl Entrance<'_> {
    fn is_hosted(self) -> bool {
        matches!(self, Entrance::Hosted(_))
    }

    /// Explains how to continue the session.
    fn describe_return(self) -> String {
        match self {
            Entrance::Label(command) => format!("To continue, run `{command}` and give the same label."),
            Entrance::Hosted(_) => format!("{CLOSE_WINDOW_NOTICE} {RETURN_LATER_NOTICE}"),
        }
    }

    /// Asks the participant to report to the experimenter, or says that the window can be closed.
    fn describe_end(self, report: &str) -> String {
        match self {
            Entrance::Label(_) => report.to_owned(),
            Entrance::Hosted(_) => CLOSE_WINDOW_NOTICE.to_owned(),
        }
    }
}

/// Guides a participant through a study. Returns the exit code.
///
/// # Errors
/// A run or a file of the study cannot be read; standard input or output fails.
pub fn run_participant_session(
    study: Study,
    runs: &Path,
    configuration: &Configuration,
    style: OutputStyle,
    entrance: Entrance<'_>,
) -> Result<u8, RunError> {
    let lines = LineSource::from_stdin();
    let mut host =
        SessionHost { lines, configuration, style, consent: None, entrance, runs: runs.to_owned() };
    match host.run_steps(study, runs) {
        Ok(code) | Err(SessionStop::Left(code)) => Ok(code),
        Err(SessionStop::Run(error)) => Err(error),
        Err(SessionStop::Io(error)) => Err(RunError::InvalidRequest(error.to_string())),
    }
}

/// Line width of wrapped text in columns.
const TEXT_COLUMNS: usize = 78;

/// Explanation of how to leave or interrupt a run of a study.
const LEAVE_HELP: &str = "quit: leave the run; all confirmed actions are saved.\n\
                        withdraw: erase everything you did in this study.\n\
                        quit and withdraw also work at questions.\n\
                        pause: stop the clock for a break. resume: restart the clock.";

struct SessionHost<'a> {
    lines: LineSource,
    configuration: &'a Configuration,
    style: OutputStyle,
    consent: Option<ConsentAgreement>,
    entrance: Entrance<'a>,
    /// The machine's folder of runs.
    runs: PathBuf,
}

impl SessionHost<'_> {
    fn run_steps(&mut self, study: Study, runs: &Path) -> Result<u8, SessionStop> {
        self.show_text("study", &study.protocol.title)?;
        let visit = match self.entrance {
            Entrance::Label(_) => self.ask_label(study, runs)?,
            Entrance::Hosted(label) => ParticipantSession::start(study, runs, label, 0)?,
        };
        loop {
            let step = match visit.next_step()? {
                // The participant has agreed. Consent is recorded in the first run, which does not exist yet.
                NextStep::Consent(_) if self.consent.is_some() => visit.next_step_after_consent()?,
                step => step,
            };
            match step {
                NextStep::Consent(text) => self.ask_for_consent(&visit, &text.text)?,
                NextStep::Practice { unfinished, may_skip: may_pass } => {
                    self.run_practice(&visit, unfinished, may_pass)?
                }
                NextStep::Session(unfinished) => {
                    let session = self.open_or_create_run(&visit, false, unfinished.as_deref())?;
                    let first = match (unfinished, session.company().observe().week) {
                        (None, _) => "The session begins.".to_owned(),
                        (Some(_), 0) => "The session continues before its first week.".to_owned(),
                        (Some(_), week) => format!("The session continues after week {week}."),
                    };
                    self.show_text("session", &format!("{first}\n{LEAVE_HELP}"))?;
                    self.play_run(&visit, session)?;
                }
                NextStep::Questions(folder) => self.play_run(&visit, visit.open_run(&folder)?)?,
                NextStep::Withdrawn(kept) => {
                    let end = self.entrance.describe_end("");
                    let text = format!("You have withdrawn from this study. {kept} {end}");
                    self.show_text("withdrawn", text.trim_end())?;
                    return Ok(0);
                }
                NextStep::Thanks => {
                    visit.record_finished();
                    let end = "Everything is recorded. Please tell the experimenter that you have finished.";
                    let text = format!("Thank you. {}", self.entrance.describe_end(end));
                    self.show_text("thanks", &text)?;
                    if !self.asks_to_withdraw_at_end(&visit)? {
                        return Ok(0);
                    }
                }
            }
        }
    }

    /// Asks for the participant's label until the label is valid. The participant can withdraw here too.
    fn ask_label(&mut self, study: Study, runs: &Path) -> Result<ParticipantSession, SessionStop> {
        let (mut refused, mut withdraws) = (0, false);
        loop {
            let question = match withdraws {
                false => "Your label (or type quit to leave, withdraw to erase your runs of this study):",
                true => "The label whose runs of this study are to be erased (or quit to leave):",
            };
            let label = self.ask_line("label", question)?;
            if is_quit(&label) {
                return Err(SessionStop::Left(0));
            }
            if label.trim() == "withdraw" {
                withdraws = true;
                continue;
            }
            match ParticipantSession::start(study.clone(), runs, &label, refused) {
                Ok(visit) => {
                    if withdraws && confirm_withdrawal(self.style, &mut self.lines)? {
                        visit.withdraw()?;
                    }
                    return Ok(visit);
                }
                Err(RunError::InvalidRequest(problem)) => {
                    refused += 1;
                    self.show_text("label_refused", &problem)?;
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Asks after the end of the study whether the participant withdraws. Returns whether the runs were erased.
    fn asks_to_withdraw_at_end(&mut self, visit: &ParticipantSession) -> Result<bool, SessionStop> {
        let question = "Press enter to end, or type withdraw to erase your runs of this study:";
        loop {
            match self.ask_line("end", question)?.trim() {
                "withdraw" if confirm_withdrawal(self.style, &mut self.lines)? => {
                    visit.withdraw()?;
                    return Ok(true);
                }
                "withdraw" => {}
                _ => return Ok(false),
            }
        }
    }

    fn ask_for_consent(&mut self, visit: &ParticipantSession, text: &str) -> Result<(), SessionStop> {
        // Programs receive the text without wrapping.
        let shown = if self.style.json { text.trim().to_owned() } else { to_plain_text(text, TEXT_COLUMNS) };
        self.show_text("consent", &shown)?;
        let shown = monotonic_time();
        let question = "Type yes if you agree, no if you do not";
        match self.ask_choice(visit, "consent", question, ["yes", "no"])? {
            None => Ok(()),
            Some("yes") => {
                let read_ms = monotonic_time().saturating_sub(shown).as_millis() as u64;
                let means = ConsentMeans::Prompt;
                self.consent = Some(ConsentDetails { means, scrolled_to_end: true, read_ms }.agree_now());
                Ok(())
            }
            Some(_) => {
                visit.record_declined();
                let end = self.entrance.describe_end("Please tell the experimenter.");
                self.show_text("declined", &format!("{DECLINED_NOTICE} {end}"))?;
                Err(SessionStop::Left(0))
            }
        }
    }

    fn run_practice(
        &mut self,
        visit: &ParticipantSession,
        unfinished: Option<PathBuf>,
        may_pass: bool,
    ) -> Result<(), SessionStop> {
        if may_pass {
            let question = "Type practice to practice first, or skip to start the session";
            match self.ask_choice(visit, "practice", question, ["practice", "skip"])? {
                None => return Ok(()),
                Some("practice") => {}
                Some(_) => {
                    visit.skip_practice();
                    return Ok(());
                }
            }
        }
        let first = if unfinished.is_some() { "The practice continues" } else { "The practice starts" };
        let text = format!(
            "{first}. The practice uses a separate company and does not count. It ends after the last day.\n{LEAVE_HELP}"
        );
        self.show_text("practice", &text)?;
        let session = self.open_or_create_run(visit, true, unfinished.as_deref())?;
        self.play_run(visit, session)
    }

    /// Repeats a question until the participant types one of two words. Returns `None` if the participant withdrew.
    fn ask_choice(
        &mut self,
        visit: &ParticipantSession,
        event: &str,
        question: &str,
        words: [&'static str; 2],
    ) -> Result<Option<&'static str>, SessionStop> {
        let question =
            format!("{question} (or type quit to leave, withdraw to erase your runs of this study):");
        loop {
            let typed = self.ask_line(event, &question)?.trim().to_lowercase();
            if let Some(word) = words.into_iter().find(|word| *word == typed) {
                return Ok(Some(word));
            }
            match typed.as_str() {
                typed if is_quit(typed) => {
                    let text = format!("You have left. {}", self.entrance.describe_return());
                    self.show_text("later", &text)?;
                    return Err(SessionStop::Left(0));
                }
                "withdraw" if confirm_withdrawal(self.style, &mut self.lines)? => {
                    visit.withdraw()?;
                    return Ok(None);
                }
                "withdraw" => {}
                other => {
                    let [one, two] = words;
                    self.show_text("not_understood", &format!("{other:?} is neither {one} nor {two}"))?;
                }
            }
        }
    }

    fn open_or_create_run(
        &self,
        visit: &ParticipantSession,
        practice: bool,
        unfinished: Option<&Path>,
    ) -> Result<Session, SessionStop> {
        Ok(match unfinished {
            Some(folder) => visit.open_run(folder)?,
            None => visit.create_run(practice, self.consent.clone(), self.configuration)?,
        })
    }

    /// Plays a run until the run is over and all questions are answered, or the participant leaves.
    fn play_run(&mut self, visit: &ParticipantSession, session: Session) -> Result<(), SessionStop> {
        let library = QueryLibrary::load(self.configuration);
        let participant =
            Participant { study: visit.study(), runs: &self.runs, is_hosted: self.entrance.is_hosted() };
        let (end, session) = run_dialogue(session, library, self.style, Some(participant), &mut self.lines)?;
        let is_finished = session.ended().is_some() && visit.study().due_questions(&session).is_empty();
        // Close the run, because an open run cannot be erased.
        drop(session);
        match end {
            EndReason::Withdrawn => Ok(visit.withdraw()?),
            EndReason::Quit | EndReason::RunOver if is_finished => Ok(()),
            EndReason::RecordLost => Err(SessionStop::Left(end.exit_code())),
            end => {
                let saved = if self.entrance.is_hosted() { "" } else { "All confirmed actions are saved. " };
                let text = format!("{saved}{}", self.entrance.describe_return());
                self.show_text("later", &text)?;
                Err(SessionStop::Left(end.exit_code()))
            }
        }
    }

    fn ask_line(&mut self, event: &str, question: &str) -> Result<String, SessionStop> {
        if self.style.json {
            println!("{}", json!({ "event": "ask", "what": event, "text": question }));
            io::stdout().flush()?;
        } else if io::stdin().is_terminal() {
            show_prompt(&format!("{question} "))?;
        } else {
            println!("{question}");
            io::stdout().flush()?;
        }
        loop {
            match self.lines.read_line()? {
                InputLine::Line(line) => return Ok(line),
                InputLine::Unreadable(problem) => self.show_text("not_understood", &problem)?,
                InputLine::End => return Err(SessionStop::Left(self.lines.end_reason().exit_code())),
            }
        }
    }

    fn show_text(&self, event: &str, text: &str) -> Result<(), SessionStop> {
        if self.style.json {
            println!("{}", json!({ "event": event, "text": text }));
        } else {
            println!("{}\n", escape_control_characters(text));
        }
        io::stdout().flush()?;
        Ok(())
    }
}

/// Returns whether a line is `quit` or `exit`.
fn is_quit(line: &str) -> bool {
    matches!(line.trim(), "quit" | "exit")
}
