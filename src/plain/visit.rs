//! A participant's session in a study, line by line: label, consent, practice, session, questions, thanks.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use serde_json::json;

use super::input::Read;
use super::lines::Lines;
use super::{End, Style, dialogue, prompt, withdraws};
use novamind_base::notation::printable;
use novamind_record::clock::steady;
use novamind_record::consent::{Agreed, ConsentGiven, ConsentMeans};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::library::Library;
use novamind_report::prose::as_plain;
use novamind_session::Session;
use novamind_study::{DECLINED, NextStep, Study, Visit};

/// The reason why a visit ends early.
enum Stop {
    /// The participant or the input left, with the exit code.
    Left(u8),
    /// A run or a file cannot be read.
    Run(RunError),
    /// Standard input or output fails.
    Io(io::Error),
}

impl From<RunError> for Stop {
    fn from(error: RunError) -> Stop {
        Stop::Run(error)
    }
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Stop {
        Stop::Io(error)
    }
}

/// Guides a participant through a study. Returns the exit code. `again` is the command that continues the study.
///
/// # Errors
/// A run or a file of the study cannot be read; standard input or output fails.
pub fn visit(
    study: Study,
    runs: &Path,
    configuration: &Configuration,
    style: Style,
    again: &str,
) -> Result<u8, RunError> {
    let lines = Lines::of_standard_input();
    let mut host = Host { lines, configuration, style, consent: None, again };
    match host.lead(study, runs) {
        Ok(code) | Err(Stop::Left(code)) => Ok(code),
        Err(Stop::Run(error)) => Err(error),
        Err(Stop::Io(error)) => Err(RunError::NotPossible(error.to_string())),
    }
}

/// Columns of wrapped text.
const WIDEST: usize = 78;

/// How to leave a run of a study.
const WAYS_OUT: &str = "quit leaves the run; everything confirmed is saved.\n\
                        withdraw erases everything you did in this study. Both also work at questions.\n\
                        pause stops the clock for a break, resume restarts it.";

struct Host<'a> {
    lines: Lines,
    configuration: &'a Configuration,
    style: Style,
    consent: Option<Agreed>,
    again: &'a str,
}

impl Host<'_> {
    fn lead(&mut self, study: Study, runs: &Path) -> Result<u8, Stop> {
        self.say("study", &study.protocol.title)?;
        let visit = self.label(study, runs)?;
        loop {
            let step = match visit.next()? {
                // Consent is recorded in the first run, which does not exist yet.
                NextStep::Consent(_) if self.consent.is_some() => visit.after_consent()?,
                step => step,
            };
            match step {
                NextStep::Consent(text) => self.consent(&visit, &text.text)?,
                NextStep::Practice { unfinished, may_pass } => self.practise(&visit, unfinished, may_pass)?,
                NextStep::Session(unfinished) => {
                    let session = self.begin(&visit, false, unfinished.as_deref())?;
                    let first = match (unfinished, session.company().observe().week) {
                        (None, _) => "The session begins.".to_owned(),
                        (Some(_), 0) => "The session continues before its first week.".to_owned(),
                        (Some(_), week) => format!("The session continues after week {week}."),
                    };
                    self.say("session", &format!("{first}\n{WAYS_OUT}"))?;
                    self.play(&visit, session)?;
                }
                NextStep::Questions(folder) => self.play(&visit, visit.open(&folder)?)?,
                NextStep::Withdrawn(kept) => {
                    self.say("withdrawn", &format!("You have withdrawn from this study. {kept}"))?;
                    return Ok(0);
                }
                NextStep::Thanks => {
                    visit.finish();
                    self.say("thanks", "Thank you. Everything is recorded; please tell the experimenter.")?;
                    return Ok(0);
                }
            }
        }
    }

    /// Asks for the label until it is valid.
    fn label(&mut self, study: Study, runs: &Path) -> Result<Visit, Stop> {
        let mut refused = 0;
        loop {
            let label = self.ask("label", "Your label (quit leaves):")?;
            if is_quit(&label) {
                return Err(Stop::Left(0));
            }
            match Visit::begin(study.clone(), runs, &label, refused) {
                Ok(visit) => return Ok(visit),
                Err(RunError::NotPossible(problem)) => {
                    refused += 1;
                    self.say("label_refused", &problem)?;
                }
                Err(error) => return Err(error.into()),
            }
        }
    }

    fn consent(&mut self, visit: &Visit, text: &str) -> Result<(), Stop> {
        // Programs receive the text without wrapping.
        let shown = if self.style.json { text.trim().to_owned() } else { as_plain(text, WIDEST) };
        self.say("consent", &shown)?;
        let shown = steady();
        let question = "Type yes if you agree, no if you do not";
        match self.choose(visit, "consent", question, ["yes", "no"])? {
            None => Ok(()),
            Some("yes") => {
                let read_ms = steady().saturating_sub(shown).as_millis() as u64;
                let means = ConsentMeans::Prompt;
                self.consent = Some(ConsentGiven { means, scrolled_to_end: true, read_ms }.now());
                Ok(())
            }
            Some(_) => {
                visit.decline();
                self.say("declined", &format!("{DECLINED} Please tell the experimenter."))?;
                Err(Stop::Left(0))
            }
        }
    }

    fn practise(&mut self, visit: &Visit, unfinished: Option<PathBuf>, may_pass: bool) -> Result<(), Stop> {
        if may_pass {
            let question = "Type practice to practice first, skip to start the session";
            match self.choose(visit, "practice", question, ["practice", "skip"])? {
                None => return Ok(()),
                Some("practice") => {}
                Some(_) => {
                    visit.pass_practice();
                    return Ok(());
                }
            }
        }
        let first = if unfinished.is_some() { "The practice continues" } else { "The practice starts" };
        let text = format!(
            "{first}. It uses a separate company and does not count. It ends after its last day.\n{WAYS_OUT}"
        );
        self.say("practice", &text)?;
        let session = self.begin(visit, true, unfinished.as_deref())?;
        self.play(visit, session)
    }

    /// Asks until one of two words is typed. Returns `None` if the participant withdrew.
    fn choose(
        &mut self,
        visit: &Visit,
        event: &str,
        question: &str,
        words: [&'static str; 2],
    ) -> Result<Option<&'static str>, Stop> {
        let question = format!("{question} (quit leaves, withdraw erases what you did):");
        loop {
            let typed = self.ask(event, &question)?.trim().to_lowercase();
            if let Some(word) = words.into_iter().find(|word| *word == typed) {
                return Ok(Some(word));
            }
            match typed.as_str() {
                typed if is_quit(typed) => {
                    let text =
                        format!("You have left. To continue, run `{}` and give the same label.", self.again);
                    self.say("later", &text)?;
                    return Err(Stop::Left(0));
                }
                "withdraw" if withdraws(self.style, &mut self.lines)? => {
                    visit.withdraw()?;
                    return Ok(None);
                }
                "withdraw" => {}
                other => {
                    let [one, two] = words;
                    self.say("not_understood", &format!("{other:?} is neither {one} nor {two}"))?;
                }
            }
        }
    }

    fn begin(&self, visit: &Visit, practice: bool, unfinished: Option<&Path>) -> Result<Session, Stop> {
        Ok(match unfinished {
            Some(folder) => visit.open(folder)?,
            None => visit.begin_run(practice, self.consent.clone(), self.configuration)?,
        })
    }

    /// Plays a run until it is over and its questions are answered, or the participant leaves.
    fn play(&mut self, visit: &Visit, session: Session) -> Result<(), Stop> {
        let library = Library::of(self.configuration);
        let (end, session) = dialogue(session, library, self.style, Some(visit.study()), &mut self.lines)?;
        let goes_on = session.ended().is_some() && visit.study().due(&session).is_empty();
        // The run must be closed before it can be erased.
        drop(session);
        match end {
            End::Withdrawn => Ok(visit.withdraw()?),
            End::Quit | End::Over if goes_on => Ok(()),
            End::RecordLost => Err(Stop::Left(end.code())),
            end => {
                let text = format!(
                    "Everything confirmed is saved. To continue, run `{}` and give the same label.",
                    self.again
                );
                self.say("later", &text)?;
                Err(Stop::Left(end.code()))
            }
        }
    }

    fn ask(&mut self, event: &str, question: &str) -> Result<String, Stop> {
        if self.style.json {
            println!("{}", json!({ "event": "ask", "what": event, "text": question }));
            io::stdout().flush()?;
        } else if io::stdin().is_terminal() {
            prompt(&format!("{question} "))?;
        } else {
            println!("{question}");
            io::stdout().flush()?;
        }
        loop {
            match self.lines.read()? {
                Read::Line(line) => return Ok(line),
                Read::Unreadable(problem) => self.say("not_understood", &problem)?,
                Read::End => return Err(Stop::Left(self.lines.end().code())),
            }
        }
    }

    fn say(&self, event: &str, text: &str) -> Result<(), Stop> {
        if self.style.json {
            println!("{}", json!({ "event": event, "text": text }));
        } else {
            println!("{}\n", printable(text));
        }
        io::stdout().flush()?;
        Ok(())
    }
}

/// Returns whether a line asks to leave.
fn is_quit(line: &str) -> bool {
    matches!(line.trim(), "quit" | "exit")
}
