//! A scripted participant in plain mode: the built program with a real clock. The script computes lower and upper
//! bounds of all times.

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout};
use std::time::Instant;

use crate::diary::{Diary, ExpectedLine, StudyQuestion, TimeCategory, WEEKS};
use crate::lab::StudyLab;

/// The program in plain mode and the diary of its participant.
pub struct PlainParticipant<'a> {
    lab: &'a StudyLab,
    machine: &'static str,
    child: Child,
    lines: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// Time of the previous line.
    sent_at: Instant,
    pub diary: Diary,
}

impl<'a> PlainParticipant<'a> {
    /// Starts the program, enters a label and agrees to the consent text.
    pub fn arrive(lab: &'a StudyLab, machine: &'static str, label: &'static str) -> PlainParticipant<'a> {
        let diary = Diary { label, is_real_time: true, ..Diary::default() };
        let mut plain = PlainParticipant::start(lab, machine, diary);
        plain.send_line("yes");
        plain.add_expected_line("start", "baseline", "short");
        plain.record_opening();
        plain
    }

    fn start(lab: &'a StudyLab, machine: &'static str, diary: Diary) -> PlainParticipant<'a> {
        let mut child = lab.program(machine).arg("--plain").spawn().expect("the program starts");
        let lines = child.stdin.take().expect("a pipe");
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        let mut plain =
            PlainParticipant { lab, machine, child, lines, answers, sent_at: Instant::now(), diary };
        let label = plain.diary.label;
        plain.send_line(label);
        plain
    }

    fn record_opening(&mut self) {
        self.wait_for(" of 28 · baseline");
        self.diary.sittings += 1;
        self.add_expected_line("session", "opened", "plain");
    }

    fn send_line(&mut self, line: &str) {
        self.sent_at = Instant::now();
        writeln!(self.lines, "{line}").expect("the program reads input");
    }

    /// Reads the output until a line contains a text.
    fn wait_for(&mut self, text: &str) {
        let mut output = String::new();
        while !output.lines().last().is_some_and(|line| line.contains(text)) {
            let read = self.answers.read_line(&mut output).expect("the program responds");
            assert!(read > 0, "{text:?} is missing in the output:\n{output}");
        }
    }

    fn add_expected_line(&mut self, kind: &'static str, what: &str, which: &str) {
        let (what, which) = (what.to_owned(), which.to_owned());
        self.diary.lines.push(ExpectedLine {
            at: 0,
            week: self.diary.week(),
            kind,
            what,
            which,
            for_ms: None,
        });
    }

    pub fn answer(&mut self, study_question: StudyQuestion, typed: &str, value: &str) {
        self.send_line(typed);
        self.add_expected_line("question", study_question.questionnaire, study_question.question);
        self.add_expected_line("answer", study_question.questionnaire, study_question.question);
        self.diary.add_answer(study_question, value, 0);
    }

    pub fn call(&mut self, tool: &str, arguments: &str) {
        self.send_line(&format!("{tool} {arguments}"));
        self.wait_for(&format!("ok {tool}"));
        self.add_expected_line("call", tool, "plain");
    }

    pub fn query(&mut self, sql: &str) {
        self.send_line(&format!("sql {sql}"));
        self.add_expected_line("query", "typed", "");
        self.diary.queries.push(sql.to_owned());
    }

    /// Adds a line to the notes.
    pub fn write_note(&mut self, text: &str) {
        self.send_line(&format!("memo {text}"));
        self.add_expected_line("note", "", "");
        self.diary.notes.push(format!("{text}\n"));
    }

    /// Looks up a term and views the inbox.
    pub fn look_up_and_read_inbox(&mut self, word: &str, term: &str) {
        self.send_line(&format!("explain {word}"));
        self.add_expected_line("help", term, "plain");
        self.send_line("inbox");
        self.add_expected_line("select", "command", "inbox");
    }

    pub fn pause(&mut self, reason: &str) {
        let before = Instant::now();
        self.send_line(&format!("pause {reason}"));
        self.wait_for("the clock is stopped");
        let inner = Instant::now();
        std::thread::sleep(std::time::Duration::from_millis(300));
        let least = u64::try_from(inner.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.send_line("resume");
        self.wait_for("the clock is running");
        self.add_expected_line("clock", "stopped", "");
        self.add_expected_line("clock", "started", "");
        self.diary.add_bounds(TimeCategory::Paused, least, elapsed_ms(before));
    }

    pub fn play_week(&mut self, why: &str) {
        self.send_line(&format!("next \"{why}\" naive"));
        let week = self.diary.weeks.len() + 1;
        // The result of the last week follows the last questions.
        match week as u32 == WEEKS {
            true => self.wait_for("please answer the last questions"),
            false => self.wait_for(&format!("week {week} done")),
        }
        self.add_expected_line("advance", "plain", "");
        self.add_expected_line("week", "", "");
        self.diary.weeks.push((why.to_owned(), true));
        if self.diary.weeks.len() as u32 == WEEKS {
            self.add_expected_line("end", "horizon", "");
            self.diary.over = true;
        }
    }

    /// Quits the program and returns.
    pub fn quit_and_return(mut self) -> PlainParticipant<'a> {
        let before = Instant::now();
        self.send_line("quit");
        self.add_expected_line("session", "closed", "quit");
        let code = self.child.wait().expect("the program ends");
        assert_eq!(code.code(), Some(0));
        self.reopen(before)
    }

    /// Kills the program, then returns.
    pub fn kill_and_return(mut self) -> PlainParticipant<'a> {
        // The record does not show when a killed program ended, so its time counts only up to the last line.
        let before = self.sent_at;
        self.child.kill().expect("killed");
        self.child.wait().expect("the program ends");
        self.diary.sittings_not_closed += 1;
        self.reopen(before)
    }

    /// Closes the terminal, then returns.
    pub fn hang_up_and_return(mut self) -> PlainParticipant<'a> {
        let before = Instant::now();
        let sent = std::process::Command::new("kill").args(["-HUP", &self.child.id().to_string()]).status();
        assert!(sent.expect("sent").success());
        self.child.wait().expect("the program ends");
        self.add_expected_line("session", "closed", "hangup");
        self.reopen(before)
    }

    fn reopen(self, before: Instant) -> PlainParticipant<'a> {
        let PlainParticipant { lab, machine, diary, .. } = self;
        let inner = Instant::now();
        std::thread::sleep(std::time::Duration::from_millis(300));
        let least = u64::try_from(inner.elapsed().as_millis()).unwrap_or(u64::MAX);
        let mut back = PlainParticipant::start(lab, machine, diary);
        back.record_opening();
        back.diary.add_bounds(TimeCategory::Away, least, elapsed_ms(before));
        back
    }

    /// Completes the study.
    pub fn finish(mut self) -> Diary {
        self.wait_for("run ended");
        self.wait_for("Thank you");
        self.add_expected_line("session", "closed", "quit");
        self.send_line("");
        assert_eq!(self.child.wait().expect("the program ends").code(), Some(0));
        self.diary
    }
}

/// Returns an upper bound of the milliseconds since a time. The number is rounded up, because the record subtracts
/// times that are truncated to milliseconds.
fn elapsed_ms(since: Instant) -> u64 {
    u64::try_from(since.elapsed().as_micros().div_ceil(1000)).unwrap_or(u64::MAX)
}
