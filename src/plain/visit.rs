//! The way of a participant through a study, line by line: label, consent, practice, session, questions, thanks.

use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use serde_json::json;

use super::input::Read;
use super::lines::Lines;
use super::{End, Style, dialogue, prompt};
use crate::notation::printable;
use crate::session::{
    Configuration, ConsentGiven, ConsentMeans, Library, NextStep, RunError, Session, Study, Visit, steady,
};

/// What ends a visit early.
enum Stop {
    /// The person or the input left; the exit code.
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

/// Leads a participant through a study; returns the exit code. `again` is the command that leads them once more.
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

struct Host<'a> {
    lines: Lines,
    configuration: &'a Configuration,
    style: Style,
    consent: Option<ConsentGiven>,
    again: &'a str,
}

impl Host<'_> {
    fn lead(&mut self, study: Study, runs: &Path) -> Result<u8, Stop> {
        self.say("study", &study.protocol.title)?;
        let visit = self.label(study, runs)?;
        loop {
            let step = match visit.next()? {
                // Agreement stands in the first run, which does not exist yet.
                NextStep::Consent(_) if self.consent.is_some() => visit.after_consent()?,
                step => step,
            };
            match step {
                NextStep::Consent(text) => self.consent(&visit, &text.text)?,
                NextStep::Practice { unfinished, may_pass } => self.practise(&visit, unfinished, may_pass)?,
                NextStep::Session(unfinished) => {
                    self.say("session", "The session begins. quit leaves it; everything confirmed is kept.")?;
                    let session = self.begin(&visit, false, unfinished.as_deref())?;
                    self.play(&visit, session)?;
                }
                NextStep::Questions(folder) => self.play(&visit, visit.open(&folder)?)?,
                NextStep::Withdrawn => {
                    self.say("withdrawn", "You have withdrawn from this study. Your data were erased.")?;
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

    /// Asks for the label until it is one of the study's.
    fn label(&mut self, study: Study, runs: &Path) -> Result<Visit, Stop> {
        let mut refused = 0;
        loop {
            let label = self.ask("label", "Your label:")?;
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
        self.say("consent", text.trim())?;
        let shown = steady();
        loop {
            let answer = self.ask("consent", "Type yes if you agree, no if you do not:")?;
            match answer.trim().to_lowercase().as_str() {
                "yes" => {
                    let read_ms = steady().saturating_sub(shown).as_millis() as u64;
                    let means = ConsentMeans::Prompt;
                    self.consent = Some(ConsentGiven { means, scrolled_to_end: true, read_ms });
                    return Ok(());
                }
                "no" => {
                    visit.decline();
                    self.say(
                        "declined",
                        "You did not agree. Nothing of you was recorded; please tell the experimenter.",
                    )?;
                    return Err(Stop::Left(0));
                }
                _ => {}
            }
        }
    }

    fn practise(&mut self, visit: &Visit, unfinished: Option<PathBuf>, may_pass: bool) -> Result<(), Stop> {
        if may_pass && !self.wants_practice()? {
            visit.pass_practice();
            return Ok(());
        }
        self.say(
            "practice",
            "Practice: another company, which does not count. It ends by itself, or with quit.",
        )?;
        let session = self.begin(visit, true, unfinished.as_deref())?;
        self.play(visit, session)
    }

    fn wants_practice(&mut self) -> Result<bool, Stop> {
        loop {
            match self.ask("practice", "Type practice to practise first, or skip:")?.trim() {
                "practice" => return Ok(true),
                "skip" => return Ok(false),
                _ => {}
            }
        }
    }

    fn begin(&self, visit: &Visit, practice: bool, unfinished: Option<&Path>) -> Result<Session, Stop> {
        Ok(match unfinished {
            Some(folder) => visit.open(folder)?,
            None => visit.begin_run(practice, self.consent, self.configuration)?,
        })
    }

    /// Plays a run until it is over and its questions are answered, or the person leaves.
    fn play(&mut self, visit: &Visit, session: Session) -> Result<(), Stop> {
        let library = Library::of(self.configuration);
        let (end, session) = dialogue(session, library, self.style, Some(visit.study()), &mut self.lines)?;
        let goes_on = session.ended().is_some() && visit.study().due(&session).is_empty();
        // The run has to be free before it is erased.
        drop(session);
        match end {
            End::Withdrawn => Ok(visit.withdraw()?),
            End::Quit | End::Over if goes_on => Ok(()),
            End::RecordLost => Err(Stop::Left(end.code())),
            end => {
                let text =
                    format!("Everything confirmed is kept. `{}` continues: give the same label.", self.again);
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
                Read::Unreadable(_) => {}
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
