//! A scripted participant in plain mode: the built program with a real clock. The script knows lower and upper bounds of all
//! times.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout};
use std::time::Instant;

use crate::diary::{Asked, Deed, Diary, Spent, WEEKS};
use crate::lab::Lab;

/// The program and its participant.
pub struct Plain<'a> {
    lab: &'a Lab,
    machine: &'static str,
    child: Child,
    lines: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// Time of the previous line.
    said: Instant,
    pub diary: Diary,
}

impl<'a> Plain<'a> {
    /// Enters a label and agrees.
    pub fn arrive(lab: &'a Lab, machine: &'static str, label: &'static str) -> Plain<'a> {
        let diary = Diary { label, real: true, ..Diary::default() };
        let mut plain = Plain::start(lab, machine, diary);
        plain.say("yes");
        plain.note("start", "baseline", "short");
        plain.opens();
        plain
    }

    fn start(lab: &'a Lab, machine: &'static str, diary: Diary) -> Plain<'a> {
        let mut child = lab.program(machine).arg("--plain").spawn().expect("the program starts");
        let lines = child.stdin.take().expect("a pipe");
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        let mut plain = Plain { lab, machine, child, lines, answers, said: Instant::now(), diary };
        let label = plain.diary.label;
        plain.say(label);
        plain
    }

    fn opens(&mut self) {
        self.wait_for(" of 28 · baseline");
        self.diary.sittings += 1;
        self.note("session", "opened", "plain");
    }

    fn say(&mut self, line: &str) {
        self.said = Instant::now();
        writeln!(self.lines, "{line}").expect("the program reads input");
    }

    /// Reads the output until a line contains a text.
    fn wait_for(&mut self, text: &str) {
        let mut said = String::new();
        while !said.lines().last().is_some_and(|line| line.contains(text)) {
            let read = self.answers.read_line(&mut said).expect("the program responds");
            assert!(read > 0, "{text:?} is missing in the output:\n{said}");
        }
    }

    fn note(&mut self, kind: &'static str, what: &str, which: &str) {
        let (what, which) = (what.to_owned(), which.to_owned());
        self.diary.deeds.push(Deed { at: 0, week: self.diary.week(), kind, what, which, for_ms: None });
    }

    pub fn answer(&mut self, asked: Asked, typed: &str, value: &str) {
        self.say(typed);
        self.note("question", asked.questionnaire, asked.question);
        self.note("answer", asked.questionnaire, asked.question);
        self.diary.answered(asked, value, 0);
    }

    pub fn call(&mut self, tool: &str, arguments: &str) {
        self.say(&format!("{tool} {arguments}"));
        self.wait_for(&format!("ok {tool}"));
        self.note("call", tool, "plain");
    }

    pub fn query(&mut self, sql: &str) {
        self.say(&format!("sql {sql}"));
        self.note("query", "typed", "");
        self.diary.queries.push(sql.to_owned());
    }

    /// Adds a line to the notes.
    pub fn memo(&mut self, text: &str) {
        self.say(&format!("memo {text}"));
        self.note("note", "", "");
        self.diary.notes.push(format!("{text}\n"));
    }

    /// Looks up a term and views the inbox.
    pub fn look_around(&mut self, word: &str, term: &str) {
        self.say(&format!("explain {word}"));
        self.note("help", term, "plain");
        self.say("inbox");
        self.note("select", "command", "inbox");
    }

    pub fn pause(&mut self, reason: &str) {
        let before = Instant::now();
        self.say(&format!("pause {reason}"));
        self.wait_for("the clock is stopped");
        let inner = Instant::now();
        std::thread::sleep(std::time::Duration::from_millis(300));
        let least = u64::try_from(inner.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.say("resume");
        self.wait_for("the clock is running");
        self.note("clock", "stopped", "");
        self.note("clock", "started", "");
        self.diary.between(Spent::Paused, least, ms(before));
    }

    pub fn week(&mut self, why: &str) {
        self.say(&format!("next \"{why}\" naive"));
        let week = self.diary.weeks.len() + 1;
        self.wait_for(&format!("week {week} done"));
        self.note("advance", "plain", "");
        self.note("week", "", "");
        self.diary.weeks.push((why.to_owned(), true));
        if self.diary.weeks.len() as u32 == WEEKS {
            self.note("end", "horizon", "");
            self.diary.over = true;
        }
    }

    /// Quits and returns.
    pub fn leaves_and_returns(mut self) -> Plain<'a> {
        let before = Instant::now();
        self.say("quit");
        self.note("session", "closed", "quit");
        let code = self.child.wait().expect("the program ends");
        assert_eq!(code.code(), Some(0));
        self.returns(before)
    }

    /// Kills the program, then returns.
    pub fn killed_and_returns(mut self) -> Plain<'a> {
        // The record does not show when a killed program ended, so its time counts only up to the last line.
        let before = self.said;
        self.child.kill().expect("killed");
        self.child.wait().expect("the program ends");
        self.diary.sittings_not_closed += 1;
        self.returns(before)
    }

    /// Closes the terminal, then returns.
    pub fn hung_up_and_returns(mut self) -> Plain<'a> {
        let before = Instant::now();
        let sent = std::process::Command::new("kill").args(["-HUP", &self.child.id().to_string()]).status();
        assert!(sent.expect("sent").success());
        self.child.wait().expect("the program ends");
        self.note("session", "closed", "hangup");
        self.returns(before)
    }

    fn returns(self, before: Instant) -> Plain<'a> {
        let Plain { lab, machine, diary, .. } = self;
        let inner = Instant::now();
        std::thread::sleep(std::time::Duration::from_millis(300));
        let least = u64::try_from(inner.elapsed().as_millis()).unwrap_or(u64::MAX);
        let mut back = Plain::start(lab, machine, diary);
        back.opens();
        back.diary.between(Spent::Away, least, ms(before));
        back
    }

    /// Completes the study.
    pub fn goes_home(mut self) -> Diary {
        self.wait_for("Thank you");
        self.note("session", "closed", "quit");
        assert_eq!(self.child.wait().expect("the program ends").code(), Some(0));
        self.diary
    }
}

/// Returns the milliseconds since a time, rounded up, as an upper bound: the record subtracts times that are truncated to
/// milliseconds, so its difference can be the next larger number.
fn ms(since: Instant) -> u64 {
    u64::try_from(since.elapsed().as_micros().div_ceil(1000)).unwrap_or(u64::MAX)
}
