//! A scripted participant at the console. The script controls the clock and therefore knows every time to the millisecond.

use std::ops::{Deref, DerefMut};
use std::time::Duration;

use crossterm::event::Event;
use novamind::record::clock::ScriptedClock;
use novamind::worker::message::Message;

use crate::diary::{Asked, Deed, Diary, Spent, WEEKS};
use crate::harness::Console;
use crate::lab::Lab;

/// A machine with a console in study mode.
pub struct Player<'a> {
    console: Console,
    clock: &'a ScriptedClock,
    pub diary: Diary,
    began: i64,
    /// Current screen, previous screen, and the time of the change.
    view: (&'static str, &'static str, i64),
    /// Class of the time that is being spent.
    spends: Spent,
}

impl Deref for Player<'_> {
    type Target = Console;

    fn deref(&self) -> &Console {
        &self.console
    }
}

impl DerefMut for Player<'_> {
    fn deref_mut(&mut self) -> &mut Console {
        &mut self.console
    }
}

impl<'a> Player<'a> {
    /// Starts at the page that asks for the label.
    pub fn arrive(lab: &Lab, machine: &str, label: &'static str, clock: &'a ScriptedClock) -> Player<'a> {
        let diary = Diary { label, ..Diary::default() };
        Player::arrive_again(lab, machine, diary, clock)
    }

    fn arrive_again(lab: &Lab, machine: &str, diary: Diary, clock: &'a ScriptedClock) -> Player<'a> {
        let runs = lab.machine(machine);
        let mut console = Console::start(&runs, (100, 30));
        console.lead(lab.read_study()).expect("the label page is shown");
        let view = ("overview", "", clock.moment());
        Player { console, clock, diary, began: 0, view, spends: Spent::Away }
    }

    /// Lets time pass after everything sent to the worker is written.
    pub fn wait(&mut self, seconds: u64) {
        let mut left = Duration::from_secs(seconds);
        while !left.is_zero() {
            self.console.finish_notes();
            let step = self.console.app.wakes_after().map_or(left, |due| due.min(left));
            self.clock.pass(step);
            self.console.app.update(Message::Time);
            self.console.settle().expect("the console settles");
            left -= step;
        }
        self.take_news();
        if self.began != 0 {
            *self.diary.time.entry((self.diary.week(), self.spends)).or_default() += seconds * 1000;
        }
    }

    /// Types keys without adding to the diary.
    pub fn does(&mut self, keys: &str) {
        self.console.press(keys);
        self.take_news();
    }

    /// Also waits for messages without a request: due questions, limits.
    fn take_news(&mut self) {
        self.console.finish_notes();
        while let Some(message) = self.console.received() {
            self.console.app.update(message);
            self.console.settle().expect("the console settles");
        }
    }

    fn since(&self, moment: i64) -> u64 {
        ((self.clock.moment() - moment) / 1_000_000).unsigned_abs()
    }

    fn note(&mut self, kind: &'static str, what: &str, which: &str, for_ms: Option<u64>) {
        let deed = Deed {
            at: self.since(self.began),
            week: self.diary.week(),
            kind,
            what: what.to_owned(),
            which: which.to_owned(),
            for_ms,
        };
        self.diary.deeds.push(deed);
    }

    /// Enters unknown labels, then the correct one; reads the consent text and agrees.
    pub fn agree(&mut self, wrong: &[&str], reads: u64) {
        for label in wrong {
            self.does(&format!("'{label}' enter"));
            self.diary.refused_labels += 1;
        }
        self.does(&format!("'{}' enter", self.diary.label));
        self.wait(reads);
        self.does("end y");
    }

    pub fn begin(&mut self) {
        self.began = self.clock.moment();
        self.note("start", "baseline", "short", None);
        self.take_up();
    }

    fn take_up(&mut self) {
        self.does("enter");
        self.diary.sittings += 1;
        self.note("session", "opened", "console", None);
        (self.spends, self.view) = (Spent::Active, ("overview", "", self.clock.moment()));
    }

    /// Answers the only question of a page after some seconds.
    pub fn answer(&mut self, asked: Asked, keys: &str, value: &str, seconds: u64) {
        self.note("question", asked.questionnaire, asked.question, None);
        let before = std::mem::replace(&mut self.spends, Spent::Answering);
        self.wait(seconds);
        self.spends = before;
        self.does(keys);
        let for_ms = seconds * 1000;
        self.note("dialog", "questions", "confirmed", Some(for_ms));
        self.note("answer", asked.questionnaire, asked.question, Some(for_ms));
        self.diary.answered(asked, value, for_ms);
    }

    pub fn go(&mut self, key: &str, screen: &'static str) {
        self.does(key);
        self.close_view();
        self.view = (screen, self.view.0, self.clock.moment());
    }

    /// Opens an object of the screen.
    pub fn select(&mut self, keys: &str, what: &str, which: &str) {
        self.does(keys);
        self.note("select", what, which, None);
    }

    fn close_view(&mut self) {
        let (screen, from, since) = self.view;
        let looked = self.since(since);
        self.note("view", screen, from, Some(looked));
        self.view.2 = self.clock.moment();
    }

    /// Opens a dialog, reads it, and closes it.
    pub fn read_dialog(&mut self, keys: &str, what: &str, seconds: u64) {
        self.does(keys);
        self.wait(seconds);
        self.does("esc");
        self.note("dialog", what, "cancelled", Some(seconds * 1000));
    }

    /// Looks up a term on a screen and reads the explanation.
    pub fn look_up(&mut self, keys: &str, term: &str, seconds: u64) {
        let place = self.view.0;
        self.note("help", term, place, None);
        self.read_dialog(keys, "explanation", seconds);
    }

    pub fn query(&mut self, sql: &str, error: &str) {
        self.does(&format!("'{}' f5 esc", sql.replace(' ', "' _ '")));
        self.note("draft", "sql", "sent", Some(0));
        self.note("query", "typed", error, None);
        self.diary.queries.push(sql.to_owned());
    }

    pub fn keep_notes(&mut self, text: &str, seconds: u64) {
        self.does("tab e");
        self.does(&format!("'{}'", text.replace(' ', "' _ '")));
        self.wait(seconds);
        self.does("ctrl-s");
        self.note("draft", "notes", "sent", Some(0));
        self.note("note", "", "", None);
        self.diary.notes.push(text.to_owned());
    }

    /// Reviews the changes, enters a reason, fills the forecasts with the projection, and simulates the week.
    pub fn week(&mut self, why: &'static str, reviews: u64, thinks: u64) {
        self.does("n");
        self.wait(reviews);
        self.does(&format!("enter '{why}'"));
        self.wait(thinks);
        self.does("enter f enter");
        self.note("dialog", "next week", "confirmed", Some((reviews + thinks) * 1000));
        self.note("draft", "rationale", "sent", Some(0));
        self.passes(why, "form");
    }

    /// Records that a week was simulated.
    fn passes(&mut self, why: &str, via: &str) {
        self.close_view();
        self.note("advance", via, "", None);
        self.note("week", "", "", None);
        self.diary.weeks.push((why.to_owned(), true));
        if self.diary.weeks.len() as u32 == WEEKS {
            self.note("end", "horizon", "", None);
            (self.spends, self.diary.over) = (Spent::After, true);
        }
    }

    /// Reads the report of the week.
    pub fn report(&mut self, seconds: u64) {
        self.wait(seconds);
        self.does("enter");
        self.note("dialog", "week report", "cancelled", Some(seconds * 1000));
    }

    /// Sets the price of plan A on the screen of tools.
    pub fn set_price(&mut self, price: &str) {
        self.select("enter", "tool", "set_prices");
        self.type_price(price);
    }

    pub fn set_price_again(&mut self, price: &str) {
        self.select("enter", "tool", "set_prices");
        self.does("up");
        self.type_price(price);
    }

    fn type_price(&mut self, price: &str) {
        self.does(&format!("enter '{price}' enter ctrl-s"));
        self.note("draft", "form set_prices", "sent", Some(0));
        self.note("call", "set_prices", "form", None);
    }

    /// Reads the page at the end.
    pub fn read_the_end(&mut self, seconds: u64) {
        self.wait(seconds);
        self.does("enter");
        self.note("dialog", "final page", "cancelled", Some(seconds * 1000));
    }

    /// Leaves the final page to the next participant.
    pub fn goes_home(mut self) -> Diary {
        self.close_view();
        self.leaves("quit");
        self.does("enter");
        self.console.shows("Type the label");
        self.diary.clone()
    }

    /// Stops and restarts the clock, and gets the question about the break.
    pub fn pause(&mut self, reason: &'static str, seconds: u64) {
        self.does("; p");
        self.wait(2);
        self.does(&format!("'{reason}' enter"));
        self.note("dialog", "reason for stopping the clock", "confirmed", Some(2000));
        self.close_view();
        self.note("clock", "stopped", "", None);
        self.spends = Spent::Paused;
        self.wait(seconds);
        self.does("enter");
        self.spends = Spent::Active;
        self.view.2 = self.clock.moment();
        self.note("clock", "started", "", Some(seconds * 1000));
    }

    /// Presses no key for more than a minute.
    pub fn idle(&mut self, seconds: u64) {
        self.does("down");
        self.spends = Spent::Idle;
        self.wait(60);
        self.note("session", "idle", "", Some(60_000));
        self.wait(seconds - 60);
        self.does("up");
        self.spends = Spent::Active;
        self.note("session", "active", "", Some(seconds * 1000));
    }

    /// Focuses another window for some seconds.
    pub fn look_elsewhere(&mut self, seconds: u64) {
        self.console.send(Event::FocusLost);
        self.note("session", "focus_lost", "", None);
        self.spends = Spent::Away;
        self.wait(seconds);
        self.console.send(Event::FocusGained);
        self.spends = Spent::Active;
        self.note("session", "focus_gained", "", None);
    }

    /// Suspends the program for some seconds.
    pub fn suspend(&mut self, seconds: u64) {
        self.console.app.suspend();
        self.console.settle().expect("nothing to wait for");
        self.close_view();
        self.note("session", "suspended", "", None);
        self.spends = Spent::Away;
        self.wait(seconds);
        self.console.app.resume();
        self.console.settle().expect("nothing to wait for");
        self.spends = Spent::Active;
        self.view.2 = self.clock.moment();
        self.note("session", "resumed", "", None);
    }

    /// Exceeds the time limit of a week: gets the warning, types a reason, and the week is filed without it.
    pub fn runs_out_of_time(&mut self) {
        let spent =
            self.diary.time.get(&(self.diary.week(), Spent::Active)).copied().unwrap_or_default() / 1000;
        self.stays_active(WEEK_SECONDS - WARNING_SECONDS - spent);
        self.await_limit(
            "1 of 10 min left for this week; then the week is submitted with the naive projection",
        );
        self.note("limit", "week", "warned", Some((WEEK_SECONDS - WARNING_SECONDS) * 1000));
        self.does("n enter 'half'");
        self.shows("half");
        self.shows("1 of 10 min left for this week");
        self.stays_active(WARNING_SECONDS);
        self.await_limit(&format!("Week {} ·", self.diary.week()));
        self.note("limit", "week", "filed_naively", Some(WEEK_SECONDS * 1000));
        self.note("dialog", "next week", "cancelled", Some(WARNING_SECONDS * 1000));
        self.note("draft", "rationale", "left", Some(0));
        self.shows("The time for this week ran out: it was submitted with the projection.");
        self.shows("a week ago the projection submitted at the limit forecast");
        self.shows("Your draft was not submitted; the record keeps it as a draft.");
        self.passes("time limit", "form");
    }

    fn stays_active(&mut self, seconds: u64) {
        for at in 0..seconds.div_ceil(50) {
            self.does("down");
            self.wait(50.min(seconds - at * 50));
        }
    }

    /// Waits for the limit. The program checks it every second of real time, while the script's clock is stopped.
    fn await_limit(&mut self, shown: &str) {
        while !self.console.screen().contains(shown) {
            let message = self.console.receive().expect("the limit is reported");
            self.console.app.update(message);
            self.console.settle().expect("the console settles");
        }
    }

    /// Withdraws and confirms twice.
    pub fn withdraws(mut self) -> Diary {
        self.does(": 'withdraw' enter y 'withdraw' enter");
        self.console.shows("You have withdrawn");
        let mut diary = self.diary.clone();
        diary.erased = true;
        diary
    }

    /// Reads the consent text and declines.
    pub fn declines(mut self, reads: u64) -> Diary {
        self.does(&format!("'{}' enter", self.diary.label));
        self.wait(reads);
        self.does("n");
        self.console.shows("You did not agree");
        let mut diary = self.diary.clone();
        diary.erased = true;
        diary
    }

    /// Undoes the previous call.
    pub fn undo(&mut self) {
        self.does("u");
        self.note("call", "set_prices", "palette", None);
    }

    /// Types half a reason, loses the terminal, returns, and restores the text.
    pub fn hang_up_with_text(
        mut self,
        lab: &Lab,
        machine: &str,
        text: &'static str,
        seconds: u64,
    ) -> Player<'a> {
        self.does(&format!("n enter '{text}'"));
        self.wait(4);
        let mut back = self.hang_up_for(lab, machine, seconds);
        back.console.shows(text);
        back.wait(2);
        back.does("enter");
        back.note("dialog", "restore texts", "confirmed", Some(2000));
        back.note("draft", "rationale", "restored", Some(0));
        back
    }

    /// Leaves the run, returns later, and gets the question about the break.
    pub fn leave_for(&mut self, seconds: u64) {
        self.does("; q");
        self.close_view();
        self.leaves("quit");
        self.does("enter");
        self.wait(seconds);
        self.does(&format!("'{}' enter", self.diary.label));
        self.take_up();
    }

    fn leaves(&mut self, cause: &str) {
        self.note("session", "closed", cause, None);
        self.spends = Spent::Away;
    }

    /// Loses the terminal and returns later on another console.
    fn hang_up_for(mut self, lab: &Lab, machine: &str, seconds: u64) -> Player<'a> {
        self.console.app.update(Message::Signal(1));
        self.console.settle().expect("the console exits");
        self.console.finish_notes();
        self.note("dialog", "next week", "cancelled", Some(4000));
        self.note("draft", "rationale", "left", Some(0));
        self.close_view();
        self.leaves("hangup");
        self.wait(seconds);
        let Player { console, clock, diary, began, spends, .. } = self;
        drop(console);
        let mut back = Player::arrive_again(lab, machine, diary, clock);
        (back.began, back.spends) = (began, spends);
        back.does(&format!("'{}' enter", back.diary.label));
        back.take_up();
        back
    }
}

/// Limit of active seconds per week, and the time of the warning before it.
const WEEK_SECONDS: u64 = 600;
const WARNING_SECONDS: u64 = 60;
