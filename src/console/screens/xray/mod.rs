//! The x-ray screen of a run that permits inspections: the inspections of plain mode by day, and breakpoints.
//!
//! The session's worker thread re-simulates days for an inspection. The worker answers one question at a time. Only
//! the newest read-only question waits. Confirmed changes and breakpoint commands are queued.

mod questions;
mod spillover_map;
mod inspection_text;
mod panes;
#[cfg(test)]
mod tests;
mod input;
mod view;

use std::collections::VecDeque;

use ratatui::layout::{Constraint, Layout, Rect};
use strum::VariantArray;

use self::input::{InputKind, ParsedInput, InputLine};
use self::view::{ViewChoices, XrayView};
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane};
use crate::action::Action;
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_insight::{Breakpoint, RandomPart, LeadFactor};
use novamind_report::inspection::InspectionCommand;
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::scroll::ScrollState;
use novamind_tui::widgets::{TableCell, TableColumn, TextField, Table};
use novamind_worker::question::Pending;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::inspection::{BreakpointCommand, InspectionAnswer, InspectionQuestion};
use novamind_worker::message::DebugRunResult;
use novamind_worker::request::Request;

/// Panes of the x-ray screen in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum XrayPane {
    /// List of views.
    #[default]
    Views,
    /// List of groups, components or breakpoints that the view can show.
    Choices,
    /// Result of the inspection.
    Inspection,
}

/// Minimum width at which the lists stay visible next to the focused result.
const MIN_WIDE_WIDTH: u16 = 90;
const LIST_WIDTH: u16 = 16;
/// Minimum height at which both lists are drawn below each other.
const MIN_STACKED_HEIGHT: u16 = 20;

struct InspectionResult {
    question: InspectionQuestion,
    found: Result<InspectionAnswer, String>,
}

/// The x-ray screen.
#[derive(Default)]
pub struct Xray {
    focus: XrayPane,
    /// Whether the run permits inspections.
    can_inspect: bool,
    views: Table,
    groups: Table,
    parts: Table,
    breakpoint_table: Table,
    breakpoints: Vec<Breakpoint>,
    last_day: u32,
    /// The selected day, or `None` for the last day.
    day: Option<u32>,
    customer: Option<u32>,
    /// Factors in the equation of leads with their fixed values.
    held_factors: Vec<(LeadFactor, f64)>,
    /// Index of the factor at the cursor.
    selected_factor: usize,
    input: Option<InputLine>,
    problem: Option<String>,
    pending_question: Pending<InspectionQuestion>,
    /// Questions that wait for the worker, in the order of input.
    queued: VecDeque<InspectionQuestion>,
    inspection: Option<InspectionResult>,
    /// The result of the last command.
    command_output: Option<InspectionResult>,
    scroll: ScrollState,
}

impl Xray {
    fn view(&self) -> XrayView {
        self.views.selected().and_then(|row| XrayView::VARIANTS.get(row)).copied().unwrap_or_default()
    }

    fn day(&self) -> u32 {
        self.day.unwrap_or(self.last_day).min(self.last_day)
    }

    fn group(&self) -> Option<Group> {
        self.groups.selected().and_then(|row| Group::all().nth(row))
    }

    fn selected_part(&self) -> Option<RandomPart> {
        self.parts.selected().and_then(|row| RandomPart::ALL.get(row)).copied()
    }

    fn choice_table(&self) -> Option<&Table> {
        match self.view().choices() {
            ViewChoices::Groups => Some(&self.groups),
            ViewChoices::Components => Some(&self.parts),
            ViewChoices::Breakpoints => Some(&self.breakpoint_table),
            ViewChoices::Nothing => None,
        }
    }

    fn choice_table_mut(&mut self) -> Option<&mut Table> {
        match self.view().choices() {
            ViewChoices::Groups => Some(&mut self.groups),
            ViewChoices::Components => Some(&mut self.parts),
            ViewChoices::Breakpoints => Some(&mut self.breakpoint_table),
            ViewChoices::Nothing => None,
        }
    }

    /// Returns the question for the current view, or `None` if a selection is missing or no day has been simulated.
    fn current_question(&self) -> Option<InspectionQuestion> {
        let day = self.day();
        let needs_day = !matches!(self.view(), XrayView::Breakpoints | XrayView::Commands);
        if !self.can_inspect || (day == 0 && needs_day) {
            return None;
        }
        Some(match self.view() {
            XrayView::Leads => InspectionQuestion::Leads(self.group()?, day, self.held_factors.clone()),
            XrayView::Quality => InspectionQuestion::Quality(self.group()?, day),
            XrayView::Satisfaction => InspectionQuestion::Satisfaction(self.group()?, day),
            XrayView::Reputation => InspectionQuestion::Reputation(self.group()?, day),
            XrayView::Spillover => InspectionQuestion::Spillover(day),
            XrayView::Competitors => InspectionQuestion::Competitors(day),
            XrayView::Drift => InspectionQuestion::Drift(day),
            XrayView::Draws => InspectionQuestion::Draws(self.selected_part()?, self.last_day),
            XrayView::Customer => InspectionQuestion::Customer(self.customer?, day),
            XrayView::Breakpoints => InspectionQuestion::Breakpoints(BreakpointCommand::List),
            // A command is sent only when the user enters it, because it may change the run.
            XrayView::Commands => return None,
        })
    }

    /// Returns the day of the displayed result. For a former customer, the day is at most the last day as a subscriber.
    fn shown_day(&self) -> u32 {
        let seen = self.inspection.as_ref().filter(|seen| self.current_question().as_ref() == Some(&seen.question));
        seen.and_then(|seen| seen.found.as_ref().ok()?.day).unwrap_or_else(|| self.day())
    }

    /// Sends the question for the current view if its answer is missing and the worker is not busy with another
    /// question.
    fn request_inspection(&mut self) -> Vec<Effect> {
        let wanted = self.current_question();
        let is_known = wanted.as_ref() == self.inspection.as_ref().map(|seen| &seen.question);
        match wanted.filter(|_| !is_known && !self.pending_question.is_waiting()) {
            Some(question) => self.send_question(question),
            None => Vec::new(),
        }
    }

    /// Shows why a simulation of several days stopped.
    pub fn show_run_result(&mut self, ran: &DebugRunResult) {
        let question = InspectionQuestion::Breakpoints(BreakpointCommand::List);
        let lines = ran.lines.clone();
        self.inspection = Some(InspectionResult { question, found: Ok(InspectionAnswer { lines, ..InspectionAnswer::default() }) });
    }

    /// Opens the breakpoints view.
    pub fn show_breakpoints(&mut self) {
        self.show_view(XrayView::Breakpoints);
        if self.can_inspect {
            self.focus = XrayPane::Inspection;
        }
    }

    fn show_view(&mut self, view: XrayView) {
        self.fill_tables();
        self.views.select(view as usize);
        self.reset_view();
    }

    fn reset_view(&mut self) {
        (self.scroll, self.input, self.problem) = (ScrollState::default(), None, None);
    }

    fn fill_tables(&mut self) {
        if self.views.rows().is_empty() {
            self.views = Table::new(vec![TableColumn::text("view")]);
            self.views.set_rows(XrayView::VARIANTS.iter().map(|view| vec![TableCell::from_text(view.title())]).collect());
            self.parts = Table::new(vec![TableColumn::text("component")]);
            self.parts.set_rows(RandomPart::ALL.iter().map(|part| vec![TableCell::from_text(part.id())]).collect());
            self.breakpoint_table = Table::new(vec![TableColumn::text("stop when")]);
            self.groups = Table::new(vec![TableColumn::text("id"), TableColumn::text("")]);
        }
    }

    fn fill_groups(&mut self, company: &DisplayedCompany) {
        let known = &company.observation.known_groups;
        let row = |group: Group| match known.contains(&group) {
            true => vec![TableCell::from_text(group.id()), TableCell::from_text("found")],
            false => vec![TableCell::from_text(group.id()).with_role(Role::Dim)],
        };
        self.groups.set_rows(Group::all().map(row).collect());
    }

    fn fill_breakpoints(&mut self) {
        let row = |breakpoint: &Breakpoint| vec![TableCell::from_text(format!("{} {}", breakpoint.number, breakpoint.condition))];
        self.breakpoint_table.set_rows(self.breakpoints.iter().map(row).collect());
    }

    fn move_days(&mut self, days: i64) -> Vec<Effect> {
        if self.last_day == 0 || !self.view().has_day() {
            return Vec::new();
        }
        let day = (i64::from(self.shown_day()) + days).clamp(1, i64::from(self.last_day)) as u32;
        self.set_day(Some(day));
        self.request_inspection()
    }

    /// Selects the day to inspect. If the last day is selected, later last days are selected automatically while the
    /// run continues.
    fn set_day(&mut self, day: Option<u32>) {
        self.day = day.filter(|day| *day != self.last_day);
    }

    fn start_day_input(&mut self) -> Vec<Effect> {
        match self.view().has_day() {
            true => self.start_input(Some(InputKind::Day)),
            false => vec![Effect::ShowError("This view does not depend on the day".to_owned())],
        }
    }

    fn toggle_held_factor(&mut self) -> Vec<Effect> {
        if self.view() != XrayView::Leads {
            return vec![Effect::ShowError("Only factors of the leads can be fixed".to_owned())];
        }
        let factor = LeadFactor::ALL[self.selected_factor.min(LeadFactor::ALL.len() - 1)];
        match self.held_factors.iter().position(|(lead_factor, _)| *lead_factor == factor) {
            Some(at) => drop(self.held_factors.remove(at)),
            None => return self.start_input(Some(InputKind::HeldValue(factor))),
        }
        self.request_inspection()
    }

    fn start_input(&mut self, expected: Option<InputKind>) -> Vec<Effect> {
        let Some(expected) = expected else {
            return vec![Effect::ShowError("This view has nothing to choose".to_owned())];
        };
        (self.focus, self.problem) = (XrayPane::Inspection, None);
        self.input = Some(InputLine { kind: expected, field: TextField::default() });
        Vec::new()
    }

    fn submit_input(&mut self) -> Vec<Effect> {
        let Some(typing) = self.input.take() else { return Vec::new() };
        let read = typing.kind.parse(typing.field.text()).and_then(|typed| typed.check_day(self.last_day));
        let typed = match read {
            Ok(typed) => typed,
            Err(problem) => {
                (self.input, self.problem) = (Some(typing), Some(problem));
                return Vec::new();
            }
        };
        self.problem = None;
        match typed {
            ParsedInput::Group(group, day) => {
                select_row(&mut self.groups, Group::all().position(|known_group| known_group == group));
                if day.is_some() {
                    self.set_day(day);
                }
            }
            ParsedInput::Day(day) => self.set_day(Some(day)),
            ParsedInput::Part(part) => {
                select_row(&mut self.parts, RandomPart::ALL.iter().position(|random_part| *random_part == part));
            }
            ParsedInput::Customer(customer, day) => {
                self.customer = Some(customer);
                self.set_day(day);
            }
            ParsedInput::Condition(condition) => return self.send_breakpoint_work(BreakpointCommand::Set(condition)),
            ParsedInput::HeldValue(factor, value) => self.held_factors.push((factor, value)),
            ParsedInput::Command(words, inspection_command) => return self.submit_command(words, inspection_command),
            ParsedInput::Days(days) => return vec![Effect::Request(Request::RunDays(days))],
        }
        self.request_inspection()
    }

    /// Sends a command to the worker. A command that changes the run requires confirmation.
    fn submit_command(&mut self, words: String, inspection_command: InspectionCommand) -> Vec<Effect> {
        match inspection_command.changes_run() {
            true => vec![Effect::ConfirmCommand(words)],
            false => self.enqueue_command(words, inspection_command),
        }
    }

    fn enqueue_command(&mut self, words: String, inspection_command: InspectionCommand) -> Vec<Effect> {
        self.scroll = ScrollState::default();
        self.enqueue_question(InspectionQuestion::Command(words, inspection_command))
    }

    /// Sends a confirmed command.
    pub fn send_confirmed_command(&mut self, words: &str) -> Vec<Effect> {
        match InspectionCommand::parse(words) {
            Ok(inspection_command) if self.can_inspect => self.enqueue_command(words.to_owned(), inspection_command),
            _ => Vec::new(),
        }
    }

    fn handle_breakpoint_action(&mut self, action: Action) -> Vec<Effect> {
        if self.view() != XrayView::Breakpoints {
            self.show_view(XrayView::Breakpoints);
        }
        match action {
            Action::RunDays => self.start_input(Some(InputKind::Days)),
            Action::BreakpointHistory if self.breakpoints.is_empty() => {
                vec![Effect::ShowError("No breakpoint is set".to_owned())]
            }
            Action::BreakpointHistory => self.send_breakpoint_work(BreakpointCommand::History),
            _ => match self.breakpoint_table.selected().and_then(|row| self.breakpoints.get(row)) {
                Some(breakpoint) => self.send_breakpoint_work(BreakpointCommand::Remove(breakpoint.number)),
                None => vec![Effect::ShowError("No breakpoint is set".to_owned())],
            },
        }
    }
}

fn select_row(table: &mut Table, row: Option<usize>) {
    if let Some(row) = row {
        table.handle_action(Action::Close, 1);
        table.select(row);
    }
}

impl ScreenState for Xray {
    fn selected_group(&self, _: &ScreenContext<'_>) -> Option<Group> {
        self.group()
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.fill_tables();
        self.fill_groups(context.company);
        (self.last_day, self.can_inspect) = (context.company.observation.day, context.company.can_inspect);
        if !self.can_inspect {
            self.focus = XrayPane::Inspection;
        }
    }

    fn request_data(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        self.request_inspection()
    }

    fn take_answers(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        self.pending_question.try_take().map_or_else(Vec::new, |(question, found)| self.handle_answer(question, found))
    }

    fn screen_escape_depth(&self) -> usize {
        usize::from(self.can_inspect && self.focus != XrayPane::Views)
    }
}

impl PaneScreen for Xray {
    type PaneId = XrayPane;

    fn panes(&self) -> &'static [XrayPane] {
        match (self.can_inspect, self.view().choices()) {
            (false, _) => &[XrayPane::Inspection],
            (true, ViewChoices::Nothing) => &[XrayPane::Views, XrayPane::Inspection],
            (true, _) => XrayPane::VARIANTS,
        }
    }

    fn pane(name: XrayPane) -> &'static dyn Pane<Xray> {
        match name {
            XrayPane::Views => &panes::ViewsPane,
            XrayPane::Choices => &panes::ChoicesPane,
            XrayPane::Inspection => &panes::InspectionPane,
        }
    }

    fn focused_pane(&self) -> XrayPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: XrayPane) {
        (self.focus, self.input, self.problem) = (name, None, None);
    }

    fn handle_screen_action(&mut self, action: Action, _: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        if !self.can_inspect {
            return Some(Vec::new());
        }
        Some(match action {
            Action::Left => self.move_days(-1),
            Action::Right => self.move_days(1),
            Action::DayWeekBefore => self.move_days(-7),
            Action::DayWeekAfter => self.move_days(7),
            Action::SeekDay => self.start_day_input(),
            Action::HoldFactor => self.toggle_held_factor(),
            Action::TypeCommand => {
                self.show_view(XrayView::Commands);
                self.start_input(Some(InputKind::Command))
            }
            Action::TypeTarget => self.start_input(InputKind::for_view(self.view())),
            Action::RunDays | Action::BreakpointHistory | Action::RemoveBreakpoint => self.handle_breakpoint_action(action),
            _ => return None,
        })
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let alone = !self.can_inspect || (self.focus == XrayPane::Inspection && area.width < MIN_WIDE_WIDTH);
        let lists = if alone { 0 } else { LIST_WIDTH.min(area.width / 2) };
        let [left, right] = Layout::horizontal([Constraint::Length(lists), Constraint::Min(0)]).areas(area);
        draw_pane(self, XrayPane::Inspection, canvas, right, context);
        if lists == 0 {
            return;
        }
        // If both lists do not fit, only the focused list is drawn.
        let views = XrayView::VARIANTS.len() as u16 + 3;
        let upper = match (self.focus, area.height >= MIN_STACKED_HEIGHT && self.choice_table().is_some()) {
            (_, true) => views,
            (XrayPane::Choices, false) => 0,
            (_, false) => area.height,
        };
        let [upper, lower] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(left);
        draw_pane(self, XrayPane::Views, canvas, upper, context);
        if self.choice_table().is_some() {
            draw_pane(self, XrayPane::Choices, canvas, lower, context);
        }
    }
}
