//! Hidden state of a run, where it may be shown: the views of plain mode in the same words, day by day, and breakpoints.
//!
//! The session's thread simulates days again for a look. One question is asked at a time; of those that come up meanwhile
//! only the newest is asked next. What was confirmed, or is done with breakpoints, waits its turn.

mod asking;
mod heat;
mod lines;
mod panes;
#[cfg(test)]
mod tests;
mod typing;
mod view;

use std::collections::VecDeque;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use self::typing::{Expected, Typed, TypedLine};
use self::view::{Choices, View};
use super::panes::{Pane, Paned, draw_pane};
use crate::context::Look;
use super::ScreenState;
use crate::action::Action;
use crate::effect::Effect;
use novamind_report::xray::AskedWords;
use novamind_session::identifiers::Group;
use novamind_insight::{Breakpoint, DrawnPart, LeadFactor};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::scroll::Scroll;
use novamind_tui::widgets::{Cell, Column, Field, Table};
use novamind_worker::asking::Pending;
use novamind_worker::company::Company;
use novamind_worker::look_inside::{BreakpointWork, LookFound, LookQuestion};
use novamind_worker::message::DaysRan;
use novamind_worker::request::Request;

/// Its panes, in the order of the tab key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum XrayPane {
    /// What can be looked at.
    #[default]
    Views,
    /// The groups, the parts or the breakpoints of the view.
    Choices,
    /// What was seen.
    Seen,
}

/// Narrowest window in which the lists stay beside what was seen while that has the focus.
const WIDE: u16 = 90;
/// Columns of the lists.
const LISTS: u16 = 16;
/// Lowest window in which both lists stand below each other.
const HIGH: u16 = 20;

/// What a look has brought.
struct Seen {
    question: LookQuestion,
    found: Result<LookFound, String>,
}

/// The screen.
#[derive(Default)]
pub struct Xray {
    focus: XrayPane,
    /// Hidden state may be shown.
    is_open: bool,
    views: Table,
    groups: Table,
    parts: Table,
    set: Table,
    breakpoints: Vec<Breakpoint>,
    /// The last day that has run.
    last_day: u32,
    /// The day that is looked at; none for the last one.
    day: Option<u32>,
    customer: Option<u32>,
    /// Factors of the leads that are held, and at what.
    held: Vec<(LeadFactor, f64)>,
    /// The factor under the cursor.
    factor: usize,
    typing: Option<TypedLine>,
    /// What is wrong with what was typed.
    problem: Option<String>,
    /// The question that is being answered.
    asked: Pending<LookQuestion>,
    /// What was typed or done meanwhile, in the order in which it is asked next.
    waiting: VecDeque<LookQuestion>,
    seen: Option<Seen>,
    /// What was answered to words.
    said: Option<Seen>,
    scroll: Scroll,
}

impl Xray {
    fn view(&self) -> View {
        self.views.selected().and_then(|row| View::VARIANTS.get(row)).copied().unwrap_or_default()
    }

    fn day(&self) -> u32 {
        self.day.unwrap_or(self.last_day).min(self.last_day)
    }

    fn group(&self) -> Option<Group> {
        self.groups.selected().and_then(|row| Group::all().nth(row))
    }

    fn part(&self) -> Option<DrawnPart> {
        self.parts.selected().and_then(|row| DrawnPart::ALL.get(row)).copied()
    }

    fn choices(&self) -> Option<&Table> {
        match self.view().choices() {
            Choices::Groups => Some(&self.groups),
            Choices::Parts => Some(&self.parts),
            Choices::Breakpoints => Some(&self.set),
            Choices::Nothing => None,
        }
    }

    fn choices_mut(&mut self) -> Option<&mut Table> {
        match self.view().choices() {
            Choices::Groups => Some(&mut self.groups),
            Choices::Parts => Some(&mut self.parts),
            Choices::Breakpoints => Some(&mut self.set),
            Choices::Nothing => None,
        }
    }

    /// The question whose answer is to be shown; none where something has to be chosen first, or no day has run.
    fn wanted(&self) -> Option<LookQuestion> {
        let day = self.day();
        let needs_day = !matches!(self.view(), View::Breakpoints | View::Words);
        if !self.is_open || (day == 0 && needs_day) {
            return None;
        }
        Some(match self.view() {
            View::Leads => LookQuestion::Leads(self.group()?, day, self.held.clone()),
            View::Quality => LookQuestion::Quality(self.group()?, day),
            View::Satisfaction => LookQuestion::Satisfaction(self.group()?, day),
            View::Reputation => LookQuestion::Reputation(self.group()?, day),
            View::Spillover => LookQuestion::Spillover(day),
            View::Rivals => LookQuestion::Rivals(day),
            View::Drift => LookQuestion::Drift(day),
            View::Streams => LookQuestion::Draws(self.part()?, self.last_day),
            View::Customer => LookQuestion::Customer(self.customer?, day),
            View::Breakpoints => LookQuestion::Breakpoints(BreakpointWork::List),
            // What was asked is asked once: words may set something.
            View::Words => return None,
        })
    }

    /// The day of what is seen: that of a customer who left ends with its last day as a subscriber.
    fn day_seen(&self) -> u32 {
        let seen = self.seen.as_ref().filter(|seen| self.wanted().as_ref() == Some(&seen.question));
        seen.and_then(|seen| seen.found.as_ref().ok()?.day).unwrap_or_else(|| self.day())
    }

    /// Asks for what is to be shown and is not yet, unless a question is being answered.
    fn ask(&mut self) -> Vec<Effect> {
        let wanted = self.wanted();
        let is_known = wanted.as_ref() == self.seen.as_ref().map(|seen| &seen.question);
        match wanted.filter(|_| !is_known && !self.asked.is_waiting()) {
            Some(question) => self.send(question),
            None => Vec::new(),
        }
    }

    /// Shows why days stopped that were run from here.
    pub fn tell(&mut self, ran: &DaysRan) {
        let question = LookQuestion::Breakpoints(BreakpointWork::List);
        let lines = ran.lines.clone();
        self.seen = Some(Seen { question, found: Ok(LookFound { lines, ..LookFound::default() }) });
    }

    /// Turns to the breakpoints.
    pub fn show_breakpoints(&mut self) {
        self.show(View::Breakpoints);
        if self.is_open {
            self.focus = XrayPane::Seen;
        }
    }

    fn show(&mut self, view: View) {
        self.list_views();
        self.views.select(view as usize);
        self.begin_view();
    }

    /// What belonged to the view before goes with it.
    fn begin_view(&mut self) {
        (self.scroll, self.typing, self.problem) = (Scroll::default(), None, None);
    }

    fn list_views(&mut self) {
        if self.views.rows().is_empty() {
            self.views = Table::new(vec![Column::words("look at")]);
            self.views.set_rows(View::VARIANTS.iter().map(|view| vec![Cell::words(view.title())]).collect());
            self.parts = Table::new(vec![Column::words("draws")]);
            self.parts.set_rows(DrawnPart::ALL.iter().map(|part| vec![Cell::words(part.id())]).collect());
            self.set = Table::new(vec![Column::words("stops when")]);
            self.groups = Table::new(vec![Column::words("id"), Column::words("")]);
        }
    }

    fn list_groups(&mut self, company: &Company) {
        let known = &company.seen.known_groups;
        let row = |group: Group| match known.contains(&group) {
            true => vec![Cell::words(group.id()), Cell::words("found")],
            false => vec![Cell::words(group.id()).role(Role::Dim)],
        };
        self.groups.set_rows(Group::all().map(row).collect());
    }

    fn list_breakpoints(&mut self) {
        let row = |own: &Breakpoint| vec![Cell::words(format!("{} {}", own.number, own.condition))];
        self.set.set_rows(self.breakpoints.iter().map(row).collect());
    }

    fn walk(&mut self, days: i64) -> Vec<Effect> {
        if self.last_day == 0 || !self.view().has_day() {
            return Vec::new();
        }
        let day = (i64::from(self.day_seen()) + days).clamp(1, i64::from(self.last_day)) as u32;
        self.turn_to(Some(day));
        self.ask()
    }

    /// Turns to a day; the last one is followed.
    fn turn_to(&mut self, day: Option<u32>) {
        self.day = day.filter(|day| *day != self.last_day);
    }

    fn seek(&mut self) -> Vec<Effect> {
        match self.view().has_day() {
            true => self.type_in(Some(Expected::Day)),
            false => vec![Effect::Complain("this view does not show a day that is chosen".to_owned())],
        }
    }

    fn hold(&mut self) -> Vec<Effect> {
        if self.view() != View::Leads {
            return vec![Effect::Complain("only factors of the leads are held".to_owned())];
        }
        let factor = LeadFactor::ALL[self.factor.min(LeadFactor::ALL.len() - 1)];
        match self.held.iter().position(|(own, _)| *own == factor) {
            Some(at) => drop(self.held.remove(at)),
            None => return self.type_in(Some(Expected::Held(factor))),
        }
        self.ask()
    }

    fn type_in(&mut self, expected: Option<Expected>) -> Vec<Effect> {
        let Some(expected) = expected else {
            return vec![Effect::Complain("nothing is chosen in this view".to_owned())];
        };
        (self.focus, self.problem) = (XrayPane::Seen, None);
        self.typing = Some(TypedLine { expected, field: Field::default() });
        Vec::new()
    }

    fn commit(&mut self) -> Vec<Effect> {
        let Some(typing) = self.typing.take() else { return Vec::new() };
        let read = typing.expected.read(typing.field.text()).and_then(|typed| typed.within(self.last_day));
        let typed = match read {
            Ok(typed) => typed,
            Err(problem) => {
                (self.typing, self.problem) = (Some(typing), Some(problem));
                return Vec::new();
            }
        };
        self.problem = None;
        match typed {
            Typed::Group(group, day) => {
                select(&mut self.groups, Group::all().position(|own| own == group));
                if day.is_some() {
                    self.turn_to(day);
                }
            }
            Typed::Day(day) => self.turn_to(Some(day)),
            Typed::Part(part) => {
                select(&mut self.parts, DrawnPart::ALL.iter().position(|own| *own == part));
            }
            Typed::Customer(customer, day) => {
                self.customer = Some(customer);
                self.turn_to(day);
            }
            Typed::Condition(condition) => return self.work(BreakpointWork::Set(condition)),
            Typed::Held(factor, value) => self.held.push((factor, value)),
            Typed::Words(words, asked) => return self.say_words(words, asked),
            Typed::Days(days) => return vec![Effect::Request(Request::RunDays(days))],
        }
        self.ask()
    }

    /// Asks with words; those that set something are confirmed first.
    fn say_words(&mut self, words: String, asked: AskedWords) -> Vec<Effect> {
        match asked.changes_run() {
            true => vec![Effect::ConfirmWords(words)],
            false => self.send_asked(words, asked),
        }
    }

    fn send_asked(&mut self, words: String, asked: AskedWords) -> Vec<Effect> {
        self.scroll = Scroll::default();
        self.send_in_turn(LookQuestion::Words(words, asked))
    }

    /// Sends words that were confirmed.
    pub fn send_words(&mut self, words: &str) -> Vec<Effect> {
        match AskedWords::read(words) {
            Ok(asked) if self.is_open => self.send_asked(words.to_owned(), asked),
            _ => Vec::new(),
        }
    }

    /// What the keys of the breakpoints do.
    fn act_on_breakpoints(&mut self, action: Action) -> Vec<Effect> {
        if self.view() != View::Breakpoints {
            self.show(View::Breakpoints);
        }
        match action {
            Action::RunDays => self.type_in(Some(Expected::Days)),
            Action::LookBack if self.breakpoints.is_empty() => {
                vec![Effect::Complain("no breakpoint is set".to_owned())]
            }
            Action::LookBack => self.work(BreakpointWork::LookBack),
            _ => match self.set.selected().and_then(|row| self.breakpoints.get(row)) {
                Some(own) => self.work(BreakpointWork::Remove(own.number)),
                None => vec![Effect::Complain("no breakpoint is set".to_owned())],
            },
        }
    }
}

fn select(table: &mut Table, row: Option<usize>) {
    if let Some(row) = row {
        table.act(Action::Close, 1);
        table.select(row);
    }
}

impl ScreenState for Xray {
    fn renew(&mut self, look: &Look<'_>) {
        self.list_views();
        self.list_groups(look.company);
        (self.last_day, self.is_open) = (look.company.seen.day, look.company.may_look_inside);
        if !self.is_open {
            self.focus = XrayPane::Seen;
        }
    }

    fn ask_run(&mut self, _: &Look<'_>) -> Vec<Effect> {
        self.ask()
    }

    fn take_answers(&mut self, _: &Look<'_>) -> Vec<Effect> {
        self.asked.try_take().map_or_else(Vec::new, |(question, found)| self.take(question, found))
    }

    fn opened(&self) -> usize {
        usize::from(self.is_open && self.focus != XrayPane::Views)
    }
}

impl Paned for Xray {
    type Name = XrayPane;

    fn panes(&self) -> &'static [XrayPane] {
        match (self.is_open, self.view().choices()) {
            (false, _) => &[XrayPane::Seen],
            (true, Choices::Nothing) => &[XrayPane::Views, XrayPane::Seen],
            (true, _) => XrayPane::VARIANTS,
        }
    }

    fn pane(name: XrayPane) -> &'static dyn Pane<Xray> {
        match name {
            XrayPane::Views => &panes::ViewsPane,
            XrayPane::Choices => &panes::ChoicesPane,
            XrayPane::Seen => &panes::SeenPane,
        }
    }

    fn focused(&self) -> XrayPane {
        self.focus
    }

    fn focus_on(&mut self, name: XrayPane) {
        (self.focus, self.typing, self.problem) = (name, None, None);
    }

    fn act_anywhere(&mut self, action: Action, _: &Look<'_>) -> Option<Vec<Effect>> {
        if !self.is_open {
            return Some(Vec::new());
        }
        Some(match action {
            Action::Left => self.walk(-1),
            Action::Right => self.walk(1),
            Action::DayWeekBefore => self.walk(-7),
            Action::DayWeekAfter => self.walk(7),
            Action::SeekDay => self.seek(),
            Action::HoldFactor => self.hold(),
            Action::AskWords => {
                self.show(View::Words);
                self.type_in(Some(Expected::Words))
            }
            Action::TypeChoice => self.type_in(Expected::in_view(self.view())),
            Action::RunDays | Action::LookBack | Action::RemoveBreakpoint => self.act_on_breakpoints(action),
            _ => return None,
        })
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let alone = !self.is_open || (self.focus == XrayPane::Seen && area.width < WIDE);
        let lists = if alone { 0 } else { LISTS.min(area.width / 2) };
        let [left, right] = Layout::horizontal([Constraint::Length(lists), Constraint::Min(0)]).areas(area);
        draw_pane(self, XrayPane::Seen, canvas, right, look);
        if lists == 0 {
            return;
        }
        // Where there is no room for both, the list with the focus stands.
        let views = View::VARIANTS.len() as u16 + 3;
        let upper = match (self.focus, area.height >= HIGH && self.choices().is_some()) {
            (_, true) => views,
            (XrayPane::Choices, false) => 0,
            (_, false) => area.height,
        };
        let [upper, lower] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(left);
        draw_pane(self, XrayPane::Views, canvas, upper, look);
        if self.choices().is_some() {
            draw_pane(self, XrayPane::Choices, canvas, lower, look);
        }
    }
}
