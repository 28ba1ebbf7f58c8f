//! The x-ray of a run, if it is permitted: the views of plain mode by day, and breakpoints.
//!
//! The session's worker thread re-simulates days for an inspection. One question is answered at a time. Of
//! read-only questions only the newest waits; confirmed changes and breakpoint commands are queued.

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
use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::Action;
use crate::context::Look;
use crate::effect::Effect;
use novamind_insight::{Breakpoint, DrawnPart, LeadFactor};
use novamind_report::xray::AskedWords;
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::scroll::Scroll;
use novamind_tui::widgets::{Cell, Column, Field, Table};
use novamind_worker::asking::Pending;
use novamind_worker::company::Company;
use novamind_worker::look_inside::{BreakpointWork, LookFound, LookQuestion};
use novamind_worker::message::DaysRan;
use novamind_worker::request::Request;

/// Panes in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum XrayPane {
    /// List of views.
    #[default]
    Views,
    /// Groups, components or breakpoints of the view.
    Choices,
    /// The result.
    Seen,
}

/// Minimum width at which the lists stay visible next to the focused result.
const WIDE: u16 = 90;
const LISTS: u16 = 16;
/// Minimum height at which both lists are stacked.
const HIGH: u16 = 20;

struct Seen {
    question: LookQuestion,
    found: Result<LookFound, String>,
}

/// The x-ray screen.
#[derive(Default)]
pub struct Xray {
    focus: XrayPane,
    /// Whether the run permits the x-ray.
    is_open: bool,
    views: Table,
    groups: Table,
    parts: Table,
    set: Table,
    breakpoints: Vec<Breakpoint>,
    last_day: u32,
    /// The selected day; `None` for the last one.
    day: Option<u32>,
    customer: Option<u32>,
    /// Factors of the leads with fixed values.
    held: Vec<(LeadFactor, f64)>,
    /// Index of the factor at the cursor.
    factor: usize,
    typing: Option<TypedLine>,
    problem: Option<String>,
    asked: Pending<LookQuestion>,
    /// Typed questions that wait, in order.
    waiting: VecDeque<LookQuestion>,
    seen: Option<Seen>,
    /// The answer to the last command.
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

    /// Returns the question for the current view; `None` if a selection is missing or no day has been
    /// simulated.
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
            // Commands are sent once, because they may change the run.
            View::Words => return None,
        })
    }

    /// Returns the day of the result. For a former customer it is at most the last day as a subscriber.
    fn day_seen(&self) -> u32 {
        let seen = self.seen.as_ref().filter(|seen| self.wanted().as_ref() == Some(&seen.question));
        seen.and_then(|seen| seen.found.as_ref().ok()?.day).unwrap_or_else(|| self.day())
    }

    /// Sends the question for the current view if its answer is missing and no other is being answered.
    fn ask(&mut self) -> Vec<Effect> {
        let wanted = self.wanted();
        let is_known = wanted.as_ref() == self.seen.as_ref().map(|seen| &seen.question);
        match wanted.filter(|_| !is_known && !self.asked.is_waiting()) {
            Some(question) => self.send(question),
            None => Vec::new(),
        }
    }

    /// Shows why a run of days stopped.
    pub fn tell(&mut self, ran: &DaysRan) {
        let question = LookQuestion::Breakpoints(BreakpointWork::List);
        let lines = ran.lines.clone();
        self.seen = Some(Seen { question, found: Ok(LookFound { lines, ..LookFound::default() }) });
    }

    /// Opens the breakpoints view.
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

    fn begin_view(&mut self) {
        (self.scroll, self.typing, self.problem) = (Scroll::default(), None, None);
    }

    fn list_views(&mut self) {
        if self.views.rows().is_empty() {
            self.views = Table::new(vec![Column::words("view")]);
            self.views.set_rows(View::VARIANTS.iter().map(|view| vec![Cell::words(view.title())]).collect());
            self.parts = Table::new(vec![Column::words("component")]);
            self.parts.set_rows(DrawnPart::ALL.iter().map(|part| vec![Cell::words(part.id())]).collect());
            self.set = Table::new(vec![Column::words("stop when")]);
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

    /// Selects a day; the last day follows the run.
    fn turn_to(&mut self, day: Option<u32>) {
        self.day = day.filter(|day| *day != self.last_day);
    }

    fn seek(&mut self) -> Vec<Effect> {
        match self.view().has_day() {
            true => self.type_in(Some(Expected::Day)),
            false => vec![Effect::Complain("This view does not depend on the day".to_owned())],
        }
    }

    fn hold(&mut self) -> Vec<Effect> {
        if self.view() != View::Leads {
            return vec![Effect::Complain("Only factors of the leads can be fixed".to_owned())];
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
            return vec![Effect::Complain("This view has nothing to choose".to_owned())];
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

    /// Sends a command; commands that change the run need confirmation.
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

    /// Sends a confirmed command.
    pub fn send_words(&mut self, words: &str) -> Vec<Effect> {
        match AskedWords::read(words) {
            Ok(asked) if self.is_open => self.send_asked(words.to_owned(), asked),
            _ => Vec::new(),
        }
    }

    fn act_on_breakpoints(&mut self, action: Action) -> Vec<Effect> {
        if self.view() != View::Breakpoints {
            self.show(View::Breakpoints);
        }
        match action {
            Action::RunDays => self.type_in(Some(Expected::Days)),
            Action::LookBack if self.breakpoints.is_empty() => {
                vec![Effect::Complain("No breakpoint is set".to_owned())]
            }
            Action::LookBack => self.work(BreakpointWork::LookBack),
            _ => match self.set.selected().and_then(|row| self.breakpoints.get(row)) {
                Some(own) => self.work(BreakpointWork::Remove(own.number)),
                None => vec![Effect::Complain("No breakpoint is set".to_owned())],
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
        // If both do not fit, only the focused list is drawn.
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
