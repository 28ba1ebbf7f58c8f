//! A scripted participant at the console. The script controls the clock, so every time is known to the millisecond.

use std::ops::{Deref, DerefMut};
use std::time::Duration;

use crossterm::event::Event;
use novamind::record::clock::ScriptedClock;
use novamind::worker::message::Message;

use crate::diary::{Diary, ExpectedLine, StudyQuestion, TimeCategory, WEEKS};
use crate::harness::Console;
use crate::lab::StudyLab;

/// A machine with a console in study mode.
pub struct ConsoleParticipant<'a> {
    console: Console,
    clock: &'a ScriptedClock,
    pub diary: Diary,
    began: i64,
    /// Current screen, previous screen, and time at which the current screen was opened.
    current_view: (&'static str, &'static str, i64),
    /// Category to which the passing time is assigned.
    spends: TimeCategory,
}

impl Deref for ConsoleParticipant<'_> {
    type Target = Console;

    fn deref(&self) -> &Console {
        &self.console
    }
}

impl DerefMut for ConsoleParticipant<'_> {
    fn deref_mut(&mut self) -> &mut Console {
        &mut self.console
    }
}

impl<'a> ConsoleParticipant<'a> {
    /// Opens the console on the page that asks for the label.
    pub fn arrive(
        lab: &StudyLab,
        machine: &str,
        label: &'static str,
        clock: &'a ScriptedClock,
    ) -> ConsoleParticipant<'a> {
        let diary = Diary { label, ..Diary::default() };
        ConsoleParticipant::arrive_again(lab, machine, diary, clock)
    }

    fn arrive_again(
        lab: &StudyLab,
        machine: &str,
        diary: Diary,
        clock: &'a ScriptedClock,
    ) -> ConsoleParticipant<'a> {
        let runs = lab.machine(machine);
        let mut console = Console::start(&runs, (100, 30));
        console.start_study(lab.read_study()).expect("the label page is shown");
        let view = ("overview", "", clock.time_ns());
        ConsoleParticipant { console, clock, diary, began: 0, current_view: view, spends: TimeCategory::Away }
    }

    /// Advances the clock in steps. Before each step, all messages to the worker are processed.
    pub fn wait(&mut self, seconds: u64) {
        let mut left = Duration::from_secs(seconds);
        while !left.is_zero() {
            self.console.wait_for_jobs();
            let step = self.console.app.time_until_wake().map_or(left, |due| due.min(left));
            self.clock.advance(step);
            self.console.app.handle_message(Message::RedrawDue);
            self.console.wait_until_idle().expect("the console settles");
            left -= step;
        }
        self.process_pending_events();
        if self.began != 0 {
            *self.diary.time.entry((self.diary.week(), self.spends)).or_default() += seconds * 1000;
        }
    }

    /// Types keys without adding an entry to the diary.
    pub fn press_unrecorded(&mut self, keys: &str) {
        self.console.press(keys);
        self.process_pending_events();
    }

    /// Processes all pending messages, including due questions and time limits.
    fn process_pending_events(&mut self) {
        self.console.wait_for_jobs();
        while let Some(message) = self.console.try_receive() {
            self.console.app.handle_message(message);
            self.console.wait_until_idle().expect("the console settles");
        }
    }

    fn milliseconds_since(&self, moment: i64) -> u64 {
        ((self.clock.time_ns() - moment) / 1_000_000).unsigned_abs()
    }

    fn add_expected_line(&mut self, kind: &'static str, what: &str, which: &str, for_ms: Option<u64>) {
        let line = ExpectedLine {
            at: self.milliseconds_since(self.began),
            week: self.diary.week(),
            kind,
            what: what.to_owned(),
            which: which.to_owned(),
            for_ms,
        };
        self.diary.lines.push(line);
    }

    /// Enters wrong labels and then the correct label, reads the consent text, and agrees.
    pub fn agree(&mut self, wrong: &[&str], reads: u64) {
        for label in wrong {
            self.press_unrecorded(&format!("'{label}' enter"));
            self.diary.refused_labels += 1;
        }
        self.press_unrecorded(&format!("'{}' enter", self.diary.label));
        self.wait(reads);
        self.press_unrecorded("end y");
    }

    pub fn start_run(&mut self) {
        self.began = self.clock.time_ns();
        self.add_expected_line("start", "baseline", "short", None);
        self.attach();
    }

    fn attach(&mut self) {
        self.press_unrecorded("enter");
        self.diary.sittings += 1;
        self.add_expected_line("session", "opened", "console", None);
        (self.spends, self.current_view) = (TimeCategory::Active, ("overview", "", self.clock.time_ns()));
    }

    /// Answers the only question of a page after some seconds.
    pub fn answer(&mut self, study_question: StudyQuestion, keys: &str, value: &str, seconds: u64) {
        self.add_expected_line("question", study_question.questionnaire, study_question.question, None);
        let before = std::mem::replace(&mut self.spends, TimeCategory::Answering);
        self.wait(seconds);
        self.spends = before;
        self.press_unrecorded(keys);
        let for_ms = seconds * 1000;
        self.add_expected_line("dialog", "questions", "confirmed", Some(for_ms));
        self.add_expected_line("answer", study_question.questionnaire, study_question.question, Some(for_ms));
        self.diary.add_answer(study_question, value, for_ms);
    }

    pub fn show_screen(&mut self, key: &str, screen: &'static str) {
        self.press_unrecorded(key);
        self.close_view();
        self.current_view = (screen, self.current_view.0, self.clock.time_ns());
    }

    /// Opens an object on the screen.
    pub fn select(&mut self, keys: &str, what: &str, which: &str) {
        self.press_unrecorded(keys);
        self.add_expected_line("select", what, which, None);
    }

    fn close_view(&mut self) {
        let (screen, from, since) = self.current_view;
        let looked = self.milliseconds_since(since);
        self.add_expected_line("view", screen, from, Some(looked));
        self.current_view.2 = self.clock.time_ns();
    }

    /// Opens a dialog, reads it, and closes it.
    pub fn read_dialog(&mut self, keys: &str, what: &str, seconds: u64) {
        self.press_unrecorded(keys);
        self.wait(seconds);
        self.press_unrecorded("esc");
        self.add_expected_line("dialog", what, "cancelled", Some(seconds * 1000));
    }

    /// Looks up a term on a screen and reads the explanation.
    pub fn look_up(&mut self, keys: &str, term: &str, seconds: u64) {
        let place = self.current_view.0;
        self.add_expected_line("help", term, place, None);
        self.read_dialog(keys, "explanation", seconds);
    }

    pub fn query(&mut self, sql: &str, error: &str) {
        self.press_unrecorded(&format!("i '{}' f5 esc", sql.replace(' ', "' _ '")));
        self.add_expected_line("draft", "sql", "sent", Some(0));
        self.add_expected_line("query", "typed", error, None);
        self.diary.queries.push(sql.to_owned());
    }

    pub fn keep_notes(&mut self, text: &str, seconds: u64) {
        self.press_unrecorded("tab e");
        self.press_unrecorded(&format!("'{}'", text.replace(' ', "' _ '")));
        self.wait(seconds);
        self.press_unrecorded("ctrl-s");
        self.add_expected_line("draft", "notes", "sent", Some(0));
        self.add_expected_line("note", "", "", None);
        self.diary.notes.push(text.to_owned());
    }

    /// Reviews the changes, enters a rationale, fills in the naive forecasts, and runs the week.
    pub fn play_week(&mut self, why: &'static str, reviews: u64, thinks: u64) {
        self.press_unrecorded("n");
        self.wait(reviews);
        self.press_unrecorded(&format!("enter '{why}'"));
        self.wait(thinks);
        self.press_unrecorded("enter f enter");
        self.add_expected_line("dialog", "next week", "confirmed", Some((reviews + thinks) * 1000));
        self.add_expected_line("draft", "rationale", "sent", Some(0));
        self.record_week(why, "form");
    }

    /// Records that a week was simulated.
    fn record_week(&mut self, why: &str, via: &str) {
        self.close_view();
        self.add_expected_line("advance", via, "", None);
        self.add_expected_line("week", "", "", None);
        self.diary.weeks.push((why.to_owned(), true));
        if self.diary.weeks.len() as u32 == WEEKS {
            self.add_expected_line("end", "horizon", "", None);
            (self.spends, self.diary.over) = (TimeCategory::After, true);
        }
    }

    /// Reads the weekly report for a number of seconds.
    pub fn report(&mut self, seconds: u64) {
        self.wait(seconds);
        self.press_unrecorded("enter");
        self.add_expected_line("dialog", "week report", "cancelled", Some(seconds * 1000));
    }

    /// Sets the price of plan A on the Tools screen.
    pub fn set_price(&mut self, price: &str) {
        self.select("enter", "tool", "set_prices");
        self.type_price(price);
    }

    pub fn set_price_again(&mut self, price: &str) {
        self.select("enter", "tool", "set_prices");
        self.press_unrecorded("up");
        self.type_price(price);
    }

    fn type_price(&mut self, price: &str) {
        self.press_unrecorded(&format!("enter '{price}' enter ctrl-s"));
        self.add_expected_line("draft", "form set_prices", "sent", Some(0));
        self.add_expected_line("call", "set_prices", "form", None);
    }

    /// Reads the final page for a number of seconds and closes it, which closes the run.
    pub fn read_final_page(&mut self, seconds: u64) {
        self.wait(seconds);
        self.press_unrecorded("enter");
        self.add_expected_line("dialog", "final page", "cancelled", Some(seconds * 1000));
    }

    /// Closes the last page. The console then asks the next participant for a label.
    pub fn finish(mut self) -> Diary {
        self.close_view();
        self.record_leaving("quit");
        self.press_unrecorded("enter");
        self.console.assert_shows("Type the label");
        self.diary.clone()
    }

    /// Stops and restarts the clock, and answers the question about the break.
    pub fn pause(&mut self, reason: &'static str, seconds: u64) {
        self.press_unrecorded("; p");
        self.wait(2);
        self.press_unrecorded(&format!("'{reason}' enter"));
        self.add_expected_line("dialog", "reason for stopping the clock", "confirmed", Some(2000));
        self.close_view();
        self.add_expected_line("clock", "stopped", "", None);
        self.spends = TimeCategory::Paused;
        self.wait(seconds);
        self.press_unrecorded("enter");
        self.spends = TimeCategory::Active;
        self.current_view.2 = self.clock.time_ns();
        self.add_expected_line("clock", "started", "", Some(seconds * 1000));
    }

    /// Presses no key for more than a minute.
    pub fn idle(&mut self, seconds: u64) {
        self.press_unrecorded("down");
        self.spends = TimeCategory::Idle;
        self.wait(60);
        self.add_expected_line("session", "idle", "", Some(60_000));
        self.wait(seconds - 60);
        self.press_unrecorded("up");
        self.spends = TimeCategory::Active;
        self.add_expected_line("session", "active", "", Some(seconds * 1000));
    }

    /// Focuses another window for some seconds.
    pub fn lose_focus(&mut self, seconds: u64) {
        self.console.send(Event::FocusLost);
        self.add_expected_line("session", "focus_lost", "", None);
        self.spends = TimeCategory::Away;
        self.wait(seconds);
        self.console.send(Event::FocusGained);
        self.spends = TimeCategory::Active;
        self.add_expected_line("session", "focus_gained", "", None);
    }

    /// Suspends the program for some seconds.
    pub fn suspend(&mut self, seconds: u64) {
        self.console.app.suspend();
        self.console.wait_until_idle().expect("nothing to wait for");
        self.close_view();
        self.add_expected_line("session", "suspended", "", None);
        self.spends = TimeCategory::Away;
        self.wait(seconds);
        self.console.app.resume();
        self.console.wait_until_idle().expect("nothing to wait for");
        self.spends = TimeCategory::Active;
        self.current_view.2 = self.clock.time_ns();
        self.add_expected_line("session", "resumed", "", None);
    }

    /// Exceeds the time limit of a week: receives the warning and types a rationale. The week is filed without the rationale.
    pub fn exceed_week_limit(&mut self) {
        let spent =
            self.diary.time.get(&(self.diary.week(), TimeCategory::Active)).copied().unwrap_or_default()
                / 1000;
        self.stay_active(WEEK_SECONDS - WARNING_SECONDS - spent);
        self.await_limit("1 of 10 min left for this week; then the week is submitted with naive forecasts");
        self.add_expected_line("limit", "week", "warned", Some((WEEK_SECONDS - WARNING_SECONDS) * 1000));
        self.press_unrecorded("n enter 'half'");
        self.assert_shows("half");
        self.assert_shows("1 of 10 min left for this week");
        self.stay_active(WARNING_SECONDS);
        self.await_limit(&format!("Week {} ·", self.diary.week()));
        self.add_expected_line("limit", "week", "filed_naively", Some(WEEK_SECONDS * 1000));
        self.add_expected_line("dialog", "next week", "cancelled", Some(WARNING_SECONDS * 1000));
        self.add_expected_line("draft", "rationale", "left", Some(0));
        self.assert_shows("The time for this week ran out: the week was submitted with naive forecasts.");
        self.assert_shows("a week ago the program, at the time limit, forecast");
        self.assert_shows("Your draft was not submitted; the text was recorded as a draft.");
        self.record_week("time limit", "form");
    }

    fn stay_active(&mut self, seconds: u64) {
        for at in 0..seconds.div_ceil(50) {
            self.press_unrecorded("down");
            self.wait(50.min(seconds - at * 50));
        }
    }

    /// Waits for the limit. The program checks the limit every second of real time, while the script's clock is stopped.
    fn await_limit(&mut self, shown: &str) {
        while !self.console.screen().contains(shown) {
            let message = self.console.receive().expect("the limit is reported");
            self.console.app.handle_message(message);
            self.console.wait_until_idle().expect("the console settles");
        }
    }

    /// Withdraws from the study and confirms twice.
    pub fn withdraw(mut self) -> Diary {
        self.press_unrecorded(": 'withdraw' enter y 'withdraw' enter");
        self.console.assert_shows("You have withdrawn");
        let mut diary = self.diary.clone();
        diary.erased = true;
        diary
    }

    /// Reads the consent text and declines.
    pub fn decline(mut self, reads: u64) -> Diary {
        self.press_unrecorded(&format!("'{}' enter", self.diary.label));
        self.wait(reads);
        self.press_unrecorded("n");
        self.console.assert_shows("You did not agree");
        let mut diary = self.diary.clone();
        diary.erased = true;
        diary
    }

    /// Undoes the previous call.
    pub fn undo(&mut self) {
        self.press_unrecorded("u");
        self.add_expected_line("call", "set_prices", "palette", None);
    }

    /// Types half a rationale, loses the terminal, returns, and restores the text.
    pub fn hang_up_with_text(
        mut self,
        lab: &StudyLab,
        machine: &str,
        text: &'static str,
        seconds: u64,
    ) -> ConsoleParticipant<'a> {
        self.press_unrecorded(&format!("n enter '{text}'"));
        self.wait(4);
        let mut back = self.hang_up_for(lab, machine, seconds);
        back.console.assert_shows(text);
        back.wait(2);
        back.press_unrecorded("enter");
        back.add_expected_line("dialog", "restore texts", "confirmed", Some(2000));
        back.add_expected_line("draft", "rationale", "restored", Some(0));
        back
    }

    /// Leaves the run, returns later, and answers the question about the break.
    pub fn leave_for(&mut self, seconds: u64) {
        self.press_unrecorded("; q");
        self.close_view();
        self.record_leaving("quit");
        self.press_unrecorded("enter");
        self.wait(seconds);
        self.press_unrecorded(&format!("'{}' enter", self.diary.label));
        self.attach();
    }

    fn record_leaving(&mut self, cause: &str) {
        self.add_expected_line("session", "closed", cause, None);
        self.spends = TimeCategory::Away;
    }

    /// Loses the terminal and returns later in a new console.
    fn hang_up_for(mut self, lab: &StudyLab, machine: &str, seconds: u64) -> ConsoleParticipant<'a> {
        self.console.app.handle_message(Message::Signal(1));
        self.console.wait_until_idle().expect("the console exits");
        self.console.wait_for_jobs();
        self.add_expected_line("dialog", "next week", "cancelled", Some(4000));
        self.add_expected_line("draft", "rationale", "left", Some(0));
        self.close_view();
        self.record_leaving("hangup");
        self.wait(seconds);
        let ConsoleParticipant { console, clock, diary, began, spends, .. } = self;
        drop(console);
        let mut back = ConsoleParticipant::arrive_again(lab, machine, diary, clock);
        (back.began, back.spends) = (began, spends);
        back.press_unrecorded(&format!("'{}' enter", back.diary.label));
        back.attach();
        back
    }
}

/// Limit of active time per week, and time of the warning before the limit, in seconds.
const WEEK_SECONDS: u64 = 600;
const WARNING_SECONDS: u64 = 60;
