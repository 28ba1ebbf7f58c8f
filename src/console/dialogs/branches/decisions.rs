//! The decisions of a week, and the changes of each alternative.

use crossterm::event::KeyEvent;
use serde_json::Value;

use super::changes::{
    Change, ListedChange, NextTreatment, Problem, Treatment, describe_decision, describe_treatment,
    describe_week, format_factor,
};
use super::picker::{NewDecision, new_decisions};
use crate::action::{Action, Scope};
use crate::screens::tools::decision_form::DecisionForm;
use novamind_base::formatting::parse_number;
use novamind_insight::{
    BranchComparison, DecisionEdit, DecisionHistory, MAX_ALTERNATIVES, MAX_FACTOR, RecordedDecision,
};
use novamind_session::EnterpriseNames;
use novamind_tools::{Rejection, ToolId};
use novamind_tui::widgets::TextField;
use novamind_tui::widgets::field::NUMBER_HINT;
use novamind_worker::company::DisplayedCompany;

/// Factor that the field suggests.
const SUGGESTED_FACTOR: &str = "0.9";
/// Maximum number of weeks with decisions that an empty week offers.
const MAX_OFFERED_WEEKS: usize = 4;

/// A row of the list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Row {
    /// The recorded decision in a line of the trajectory.
    Decision(u64),
    /// The change with an index in the current alternative, if it has no recorded decision in the displayed week.
    Change(usize),
    /// Another week with decisions, offered if the displayed week has none.
    Week(u32),
    /// Opens the list of decisions that can be added.
    Add,
}

/// The target of a factor or a form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Target {
    /// The recorded decision in a line.
    Decision(u64),
    /// The change with an index.
    Change(usize),
    /// A decision that is added.
    New(NewDecision),
}

/// Input that the user has opened.
pub(super) enum Input {
    /// The list of decisions that can be added, with the selected row.
    Picker(usize),
    /// A field for a factor. `cancelled` is the treatment of the decision if the user cancels.
    Factor { target: Target, field: TextField, cancelled: Treatment },
    /// The form of a tool. `cancelled` is the treatment of the decision if the user cancels.
    Form { target: Target, form: Box<DecisionForm>, cancelled: Treatment },
    /// A field for a parameter and its value.
    Parameter { target: Target, field: TextField },
}

/// The page part that lists and changes decisions.
pub(super) struct DecisionList {
    week: u32,
    last_week: u32,
    /// The recorded decisions, or `None` until they are loaded.
    history: Option<Box<DecisionHistory>>,
    alternatives: Vec<Vec<ListedChange>>,
    current: usize,
    selected: usize,
    pub(super) input: Option<Input>,
    /// A message for the selected row.
    pub(super) notice: Option<String>,
    /// Whether the changes were edited since the last check.
    is_unchecked: bool,
}

impl DecisionList {
    pub(super) fn new(week: u32, last_week: u32) -> DecisionList {
        DecisionList {
            week,
            last_week,
            history: None,
            alternatives: vec![Vec::new()],
            current: 0,
            selected: 0,
            input: None,
            notice: None,
            is_unchecked: false,
        }
    }

    /// Returns the displayed week.
    pub(super) fn week(&self) -> u32 {
        self.week
    }

    pub(super) fn days_per_week(&self) -> u32 {
        self.history.as_ref().map_or(1, |history| history.days_per_week())
    }

    pub(super) fn set_history(&mut self, history: Box<DecisionHistory>) {
        self.history = Some(history);
        self.select(self.selected);
    }

    pub(super) fn history(&self) -> Option<&DecisionHistory> {
        self.history.as_deref()
    }

    pub(super) fn selected(&self) -> usize {
        self.selected
    }

    pub(super) fn position_label(&self) -> String {
        format!("alternative {} of {} · ‹ › week", self.current + 1, self.alternatives.len())
    }

    /// Returns the changes of the current alternative.
    pub(super) fn changes(&self) -> &[ListedChange] {
        &self.alternatives[self.current]
    }

    /// Returns the first changed week of all alternatives, at which the branches start.
    pub(super) fn start_week(&self) -> u32 {
        let weeks = self
            .history()
            .into_iter()
            .flat_map(|history| self.alternatives.iter().flatten().map(|listed| listed.change.week(history)));
        weeks.min().unwrap_or(self.week)
    }

    fn edits_of(&self, changes: &[ListedChange]) -> Vec<DecisionEdit> {
        let Some(history) = self.history() else { return Vec::new() };
        changes.iter().filter_map(|listed| listed.change.edit(history)).collect()
    }

    /// Returns the edits of the alternatives that have changes.
    pub(super) fn alternatives(&self) -> Vec<Vec<DecisionEdit>> {
        self.changed_alternatives().map(|changes| self.edits_of(changes)).collect()
    }

    fn changed_alternatives(&self) -> impl Iterator<Item = &Vec<ListedChange>> {
        self.alternatives.iter().filter(|changes| !changes.is_empty())
    }

    /// Describes each alternative that has changes.
    pub(super) fn alternative_names(&self, names: &EnterpriseNames) -> Vec<String> {
        let (start, Some(history)) = (self.start_week(), self.history()) else { return Vec::new() };
        let describe = |listed: &ListedChange| {
            let text = listed.change.describe(history, names, start);
            match listed.change {
                Change::AllWeeks { .. } => text,
                _ => format!("week {}: {text}", listed.change.week(history)),
            }
        };
        self.changed_alternatives()
            .map(|changes| changes.iter().map(describe).collect::<Vec<_>>().join("; "))
            .collect()
    }

    /// Returns the first week and the edits of the current alternative, if they were changed since the last check.
    pub(super) fn take_unchecked_edits(&mut self) -> Option<(u32, Vec<DecisionEdit>)> {
        let is_unchecked = std::mem::take(&mut self.is_unchecked) && !self.changes().is_empty();
        is_unchecked.then(|| (self.start_week(), self.edits_of(self.changes())))
    }

    /// Stores the result of a check of the current alternative.
    pub(super) fn set_checked(&mut self, edits: &[DecisionEdit], refused: Vec<Option<Rejection>>) {
        if self.edits_of(self.changes()) != edits {
            return;
        }
        for (listed, refusal) in self.alternatives[self.current].iter_mut().zip(refused) {
            listed.problem = refusal.map(|refusal| Problem::Invalid(refusal.message));
        }
    }

    /// Marks the changes that the simulated company rejected.
    pub(super) fn set_compared(&mut self, comparison: &BranchComparison) {
        let Some(history) = self.history.as_deref() else { return };
        let days = history.days_per_week();
        let changed = self.alternatives.iter_mut().filter(|changes| !changes.is_empty());
        for (changes, branch) in changed.zip(comparison.branches.iter().skip(1)) {
            for listed in changes {
                let rejected = branch.rejected.iter().find(|rejected| match &listed.change {
                    Change::Recorded { line, .. } => rejected.seq == Some(*line),
                    Change::Added { week, tool, .. } => {
                        let day = (week - 1) * days;
                        (rejected.seq, rejected.day, rejected.name.as_str()) == (None, day, tool.name())
                    }
                    Change::Parameter { key, .. } => rejected.name == *key,
                    Change::AllWeeks { .. } => false,
                });
                listed.problem =
                    rejected.map(|rejected| Problem::Rejected(rejected.rejection.message.clone()));
            }
        }
    }

    /// Selects the first change that cannot be simulated. Returns whether there is one.
    pub(super) fn select_invalid_change(&mut self) -> bool {
        let is_invalid = |listed: &ListedChange| matches!(listed.problem, Some(Problem::Invalid(_)));
        let place = self.alternatives.iter().enumerate().find_map(|(alternative, changes)| {
            changes.iter().position(is_invalid).map(|change| (alternative, change))
        });
        let Some((alternative, change)) = place else { return false };
        self.current = alternative;
        self.go_to_change(change);
        true
    }

    /// Returns the rows of the displayed week, followed by the changes of other weeks.
    pub(super) fn rows(&self) -> Vec<Row> {
        let Some(history) = self.history() else { return Vec::new() };
        let mut rows: Vec<Row> =
            history.decisions_of_week(self.week).map(|decision| Row::Decision(decision.seq())).collect();
        if rows.is_empty() {
            rows.extend(self.weeks_with_decisions(history).map(Row::Week));
        }
        let is_here = |listed: &ListedChange| listed.change.week(history) == self.week;
        let free =
            |listed: &ListedChange| !matches!(listed.change, Change::Recorded { .. }) || !is_here(listed);
        let mut others: Vec<usize> =
            (0..self.changes().len()).filter(|at| free(&self.changes()[*at])).collect();
        others.sort_by_key(|at| !is_here(&self.changes()[*at]));
        rows.extend(others.into_iter().map(Row::Change));
        rows.push(Row::Add);
        rows
    }

    /// Returns the nearest earlier weeks with decisions, or the first later weeks if there are none.
    fn weeks_with_decisions<'a>(&self, history: &'a DecisionHistory) -> impl Iterator<Item = u32> + use<'a> {
        let has_decisions = |week: &u32| history.decisions_of_week(*week).next().is_some();
        let earlier: Vec<u32> = (1..self.week).rev().filter(has_decisions).take(MAX_OFFERED_WEEKS).collect();
        let later = (self.week + 1..=self.last_week).filter(has_decisions).take(MAX_OFFERED_WEEKS);
        let weeks = if earlier.is_empty() { later.collect() } else { earlier };
        weeks.into_iter()
    }

    /// Returns the treatment of a recorded decision in the current alternative.
    pub(super) fn treatment(&self, wanted: u64) -> Treatment {
        let found = self.changes().iter().find_map(|listed| match &listed.change {
            Change::Recorded { line, treatment } if *line == wanted => Some(treatment.clone()),
            _ => None,
        });
        found.unwrap_or(Treatment::Keep)
    }

    /// Returns the refused change of a row, if there is one.
    pub(super) fn problem(&self, row: Row) -> Option<&Problem> {
        let listed = match row {
            Row::Decision(wanted) => self
                .changes()
                .iter()
                .find(|listed| matches!(listed.change, Change::Recorded { line, .. } if line == wanted)),
            Row::Change(at) => self.changes().get(at),
            Row::Week(_) | Row::Add => None,
        };
        listed?.problem.as_ref()
    }

    pub(super) fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows().len().saturating_sub(1));
    }

    fn select_row(&mut self, wanted: Row) {
        let row = self.rows().iter().position(|row| *row == wanted);
        self.select(row.unwrap_or(self.selected));
    }

    fn set_treatment(&mut self, wanted: u64, treatment: Treatment) {
        let changes = &mut self.alternatives[self.current];
        let is_it =
            |listed: &ListedChange| matches!(listed.change, Change::Recorded { line, .. } if line == wanted);
        let place = changes.iter().position(is_it);
        let change = ListedChange::from(Change::Recorded { line: wanted, treatment: treatment.clone() });
        match (place, treatment) {
            (Some(at), Treatment::Keep) => drop(changes.remove(at)),
            (Some(at), _) => changes[at] = change,
            (None, Treatment::Keep) => {}
            (None, _) => changes.push(change),
        }
        self.is_unchecked = true;
    }

    fn put_change(&mut self, target: Target, change: Change) {
        let changes = &mut self.alternatives[self.current];
        let at = match target {
            Target::Change(at) if at < changes.len() => {
                changes[at] = change.into();
                at
            }
            _ => {
                changes.push(change.into());
                changes.len() - 1
            }
        };
        self.is_unchecked = true;
        self.select_row(Row::Change(at));
    }

    fn remove_change(&mut self, at: usize) {
        self.alternatives[self.current].remove(at);
        self.is_unchecked = true;
        self.select(self.selected);
    }

    /// Shows the week of a change and selects its row.
    fn go_to_change(&mut self, at: usize) {
        let (Some(history), Some(listed)) = (self.history.as_deref(), self.changes().get(at)) else { return };
        let row = match listed.change {
            Change::Recorded { line, .. } => Row::Decision(line),
            _ => Row::Change(at),
        };
        self.week = listed.change.week(history);
        self.select_row(row);
    }

    /// Returns the scopes of the open input, or `None` if the list has the focus.
    pub(super) fn input_scopes(&self) -> Option<Vec<Scope>> {
        Some(match self.input.as_ref()? {
            Input::Picker(_) => vec![Scope::Decisions, Scope::List, Scope::Dialog],
            Input::Factor { .. } | Input::Parameter { .. } => vec![Scope::Field],
            Input::Form { form, .. } if form.is_typing() => form.scopes(),
            Input::Form { form, .. } => [form.scopes(), vec![Scope::Dialog]].concat(),
        })
    }

    /// Handles an action in the list or in the open input.
    pub(super) fn handle_action(&mut self, action: Action, company: &DisplayedCompany) {
        self.notice = None;
        if self.history.is_none() {
            return;
        }
        let result = match self.input.take() {
            None => self.handle_list_action(action, company),
            Some(Input::Picker(selected)) => self.handle_picker_action(action, selected, company),
            Some(Input::Factor { target, field, cancelled }) => match action {
                Action::Commit | Action::CommitDown | Action::CommitNext => {
                    self.commit_factor(target, field, cancelled)
                }
                action => {
                    self.cancel_input(action, Input::Factor { target, field, cancelled });
                    Ok(())
                }
            },
            Some(Input::Parameter { target, field }) => match action {
                Action::Commit | Action::CommitDown | Action::CommitNext => {
                    self.commit_parameter(target, field)
                }
                action => {
                    self.cancel_input(action, Input::Parameter { target, field });
                    Ok(())
                }
            },
            Some(Input::Form { target, form, cancelled }) => {
                self.handle_form_action(action, target, form, cancelled, company)
            }
        };
        if let Err(reason) = result {
            self.notice = Some(reason);
        }
    }

    /// Closes an input and restores the treatment of its decision if the action cancels the input.
    fn cancel_input(&mut self, action: Action, input: Input) {
        if !matches!(action, Action::Discard | Action::Close | Action::Cancel) {
            self.input = Some(input);
            return;
        }
        match input {
            Input::Factor { target: Target::Decision(line), cancelled, .. }
            | Input::Form { target: Target::Decision(line), cancelled, .. }
                if self.treatment(line) != cancelled =>
            {
                self.set_treatment(line, cancelled);
            }
            _ => {}
        }
    }

    fn handle_list_action(&mut self, action: Action, company: &DisplayedCompany) -> Result<(), String> {
        let row = self.rows().get(self.selected).copied();
        match action {
            Action::Up | Action::ScrollUp => self.select(self.selected.saturating_sub(1)),
            Action::Down | Action::ScrollDown => self.select(self.selected + 1),
            Action::PageUp => self.select(self.selected.saturating_sub(10)),
            Action::PageDown => self.select(self.selected + 10),
            Action::First => self.select(0),
            Action::Last => self.select(usize::MAX),
            Action::Left => self.show_week(self.week.saturating_sub(1)),
            Action::Right => self.show_week(self.week + 1),
            Action::NextAlternative => return self.next_alternative(),
            Action::AddDecision => self.input = Some(Input::Picker(0)),
            Action::CycleDecision => return self.open_row(row, company),
            Action::OmitDecision => return self.leave_out_row(row),
            Action::ScaleDecision => return self.scale_row(row),
            Action::ReplaceDecision => return self.replace_row(row, company),
            _ => {}
        }
        Ok(())
    }

    fn show_week(&mut self, week: u32) {
        self.week = week.clamp(1, self.last_week.max(1));
        self.select(0);
    }

    fn next_alternative(&mut self) -> Result<(), String> {
        let is_last = self.current + 1 == self.alternatives.len();
        let is_empty = self.changes().is_empty();
        if is_last && is_empty && self.current == 0 {
            return Err("Change a decision before you add another alternative.".to_owned());
        }
        if is_last && !is_empty && self.alternatives.len() < MAX_ALTERNATIVES {
            self.alternatives.push(Vec::new());
        }
        self.current = (self.current + 1) % self.alternatives.len();
        self.is_unchecked = true;
        self.select(0);
        Ok(())
    }

    /// Cycles the treatment of a decision, or opens another row.
    fn open_row(&mut self, row: Option<Row>, company: &DisplayedCompany) -> Result<(), String> {
        match row {
            Some(Row::Decision(line)) => {
                let treatment = self.treatment(line);
                let Some(decision) = self.recorded(line) else { return Ok(()) };
                match treatment.next(decision) {
                    NextTreatment::Keep => self.set_treatment(line, Treatment::Keep),
                    NextTreatment::LeaveOut => self.set_treatment(line, Treatment::LeaveOut),
                    // Cancelling the input completes the cycle.
                    NextTreatment::Scale => {
                        self.open_factor(Target::Decision(line), SUGGESTED_FACTOR, Treatment::Keep)
                    }
                    NextTreatment::Replace => self.open_decision_form(line, Treatment::Keep, company),
                }
            }
            Some(Row::Change(at)) => return self.open_change(at, company),
            Some(Row::Week(week)) => self.show_week(week),
            Some(Row::Add) => self.input = Some(Input::Picker(0)),
            None => {}
        }
        Ok(())
    }

    fn recorded(&self, line: u64) -> Option<&RecordedDecision> {
        self.history().and_then(|history| history.decision(line))
    }

    fn open_factor(&mut self, target: Target, suggestion: &str, cancelled: Treatment) {
        let field = TextField::with_selected_text(suggestion);
        self.input = Some(Input::Factor { target, field, cancelled });
    }

    /// Opens the form of a recorded decision with the values of the current alternative.
    fn open_decision_form(&mut self, line: u64, cancelled: Treatment, company: &DisplayedCompany) {
        let treatment = self.treatment(line);
        let (Some(history), Some(call)) =
            (self.history(), self.recorded(line).and_then(RecordedDecision::call))
        else {
            return;
        };
        let (values, args) = (history.values_before(call), treatment.arguments(call));
        let form = DecisionForm::new(call.tool, values, Some(&args), company).into();
        self.input = Some(Input::Form { target: Target::Decision(line), form, cancelled });
    }

    fn open_change(&mut self, at: usize, company: &DisplayedCompany) -> Result<(), String> {
        let (Some(history), Some(listed)) = (self.history(), self.changes().get(at)) else { return Ok(()) };
        match &listed.change {
            Change::Added { week, tool, args } if *week == self.week && !tool.spec().arguments.is_empty() => {
                let values = history.values_in_week(*tool, *week);
                let form = DecisionForm::new(*tool, values, Some(args), company).into();
                let (target, cancelled) = (Target::Change(at), Treatment::Keep);
                self.input = Some(Input::Form { target, form, cancelled });
            }
            Change::Parameter { week, key, value } if *week == self.week => {
                let field = TextField::with_text(format!("{key} {value}"));
                self.input = Some(Input::Parameter { target: Target::Change(at), field });
            }
            Change::AllWeeks { edit: DecisionEdit::Scale { factor, .. }, .. } => {
                let factor = format_factor(*factor);
                self.open_factor(Target::Change(at), &factor, Treatment::Keep);
            }
            change if change.week(history) == self.week => {
                return Err("This change has no values. To remove it, leave it out.".to_owned());
            }
            _ => self.go_to_change(at),
        }
        Ok(())
    }

    /// Leaves out a decision, restores a changed decision, or removes another change.
    fn leave_out_row(&mut self, row: Option<Row>) -> Result<(), String> {
        match row {
            Some(Row::Decision(line)) if self.treatment(line) != Treatment::Keep => {
                self.set_treatment(line, Treatment::Keep);
            }
            Some(Row::Decision(line)) => {
                self.check_possible(line, NextTreatment::LeaveOut)?;
                self.set_treatment(line, Treatment::LeaveOut);
            }
            Some(Row::Change(at)) => self.remove_change(at),
            Some(Row::Week(_) | Row::Add) | None => {}
        }
        Ok(())
    }

    fn check_possible(&self, line: u64, next: NextTreatment) -> Result<(), String> {
        self.recorded(line).and_then(|decision| next.refusal(decision)).map_or(Ok(()), Err)
    }

    fn scale_row(&mut self, row: Option<Row>) -> Result<(), String> {
        match row {
            Some(Row::Decision(line)) => {
                self.check_possible(line, NextTreatment::Scale)?;
                let before = self.treatment(line);
                let suggestion = match &before {
                    Treatment::Scale(factor) => format_factor(*factor),
                    _ => SUGGESTED_FACTOR.to_owned(),
                };
                self.open_factor(Target::Decision(line), &suggestion, before);
                Ok(())
            }
            Some(Row::Change(at)) => match &self.changes()[at].change {
                Change::AllWeeks { edit: DecisionEdit::Scale { factor, .. }, .. } => {
                    let factor = format_factor(*factor);
                    self.open_factor(Target::Change(at), &factor, Treatment::Keep);
                    Ok(())
                }
                _ => Err("This change has its own values. Replace them instead.".to_owned()),
            },
            _ => Err("Select a decision of this week to scale its amounts.".to_owned()),
        }
    }

    fn replace_row(&mut self, row: Option<Row>, company: &DisplayedCompany) -> Result<(), String> {
        match row {
            Some(Row::Decision(line)) => {
                self.check_possible(line, NextTreatment::Replace)?;
                let before = self.treatment(line);
                self.open_decision_form(line, before, company);
                Ok(())
            }
            Some(Row::Change(at)) => self.open_change(at, company),
            _ => Err("Select a decision of this week to replace its values.".to_owned()),
        }
    }

    fn handle_picker_action(
        &mut self,
        action: Action,
        selected: usize,
        company: &DisplayedCompany,
    ) -> Result<(), String> {
        let decisions = new_decisions(company);
        let last = decisions.len().saturating_sub(1);
        let moved = match action {
            Action::Up | Action::ScrollUp => selected.saturating_sub(1),
            Action::Down | Action::ScrollDown => selected + 1,
            Action::PageUp => selected.saturating_sub(10),
            Action::PageDown => selected + 10,
            Action::First => 0,
            Action::Last => last,
            Action::Close | Action::Cancel => return Ok(()),
            _ => selected,
        };
        self.input = Some(Input::Picker(moved.min(last)));
        let Some(new) = decisions.get(selected).copied() else { return Ok(()) };
        let is_chosen = matches!(
            action,
            Action::CycleDecision
                | Action::Open
                | Action::ReplaceDecision
                | Action::ScaleDecision
                | Action::OmitDecision
        );
        if !is_chosen {
            return Ok(());
        }
        new.refusal(company).map_or(Ok(()), Err)?;
        match action {
            Action::ScaleDecision => {
                new.scaled(1.0)?;
                self.open_factor(Target::New(new), SUGGESTED_FACTOR, Treatment::Keep);
            }
            Action::OmitDecision => {
                let edit = new.left_out()?;
                self.add(Target::New(new), Change::AllWeeks { week: self.week, edit });
            }
            _ => self.open_new_decision(new, company),
        }
        Ok(())
    }

    fn add(&mut self, target: Target, change: Change) {
        self.input = None;
        self.put_change(target, change);
    }

    fn open_new_decision(&mut self, new: NewDecision, company: &DisplayedCompany) {
        let (target, week) = (Target::New(new), self.week);
        match new {
            NewDecision::Call(tool) if tool.spec().arguments.is_empty() => {
                self.add(target, Change::Added { week, tool, args: Value::Object(Default::default()) });
            }
            NewDecision::Call(tool) => {
                let values = self
                    .history()
                    .map_or_else(Default::default, |history| history.values_in_week(tool, week));
                let form = DecisionForm::new(tool, values, None, company).into();
                self.input = Some(Input::Form { target, form, cancelled: Treatment::Keep });
            }
            NewDecision::CapacityByUsage => {
                self.add(target, Change::AllWeeks { week, edit: DecisionEdit::CapacityFollowsUsage });
            }
            NewDecision::Parameter => {
                self.input = Some(Input::Parameter { target, field: TextField::default() });
            }
        }
    }

    fn commit_factor(
        &mut self,
        target: Target,
        field: TextField,
        cancelled: Treatment,
    ) -> Result<(), String> {
        let factor = parse_number(field.text()).filter(|factor| (0.0..=MAX_FACTOR).contains(factor));
        let Some(factor) = factor else {
            self.input = Some(Input::Factor { target, field, cancelled });
            return Err(format!("Enter a factor from 0 to {MAX_FACTOR}, for example {SUGGESTED_FACTOR}."));
        };
        match target {
            Target::Decision(line) => self.set_treatment(line, Treatment::Scale(factor)),
            Target::New(new) => {
                let edit = new.scaled(factor)?;
                self.put_change(target, Change::AllWeeks { week: self.week, edit });
            }
            Target::Change(at) => {
                if let Some(Change::AllWeeks { week, edit: DecisionEdit::Scale { tool, .. } }) =
                    self.changes().get(at).map(|listed| &listed.change)
                {
                    let edit = DecisionEdit::Scale { tool: *tool, factor };
                    let change = Change::AllWeeks { week: *week, edit };
                    self.put_change(target, change);
                }
            }
        }
        Ok(())
    }

    fn commit_parameter(&mut self, target: Target, field: TextField) -> Result<(), String> {
        let edit = format!("set {}", field.text().trim().replacen('=', " ", 1)).parse();
        match edit {
            Ok(DecisionEdit::Set { key, value, .. }) => {
                self.put_change(target, Change::Parameter { week: self.week, key, value });
                Ok(())
            }
            _ => {
                self.input = Some(Input::Parameter { target, field });
                Err("Enter the name of a parameter and its value, for example group.S1.c_max_mean 60."
                    .to_owned())
            }
        }
    }

    fn handle_form_action(
        &mut self,
        action: Action,
        target: Target,
        mut form: Box<DecisionForm>,
        cancelled: Treatment,
        company: &DisplayedCompany,
    ) -> Result<(), String> {
        match action {
            Action::Apply => {
                let arguments = form.arguments();
                let tool = form.tool();
                match arguments {
                    Ok(args) => self.use_arguments(target, tool, args),
                    Err(reason) => {
                        self.input = Some(Input::Form { target, form, cancelled });
                        return Err(reason);
                    }
                }
            }
            Action::Close | Action::Cancel => {
                self.cancel_input(action, Input::Form { target, form, cancelled });
            }
            action => {
                let message = form.handle_action(action, company);
                self.input = Some(Input::Form { target, form, cancelled });
                return message.map_or(Ok(()), Err);
            }
        }
        Ok(())
    }

    fn use_arguments(&mut self, target: Target, tool: ToolId, args: Value) {
        match target {
            Target::Decision(line) => self.set_treatment(line, Treatment::Replace(args)),
            Target::Change(_) | Target::New(_) => {
                self.put_change(target, Change::Added { week: self.week, tool, args });
            }
        }
    }

    pub(super) fn handle_key(&mut self, key: &KeyEvent) {
        self.notice = match &mut self.input {
            Some(Input::Factor { field, .. }) => {
                (!field.handle_number_key(key)).then(|| NUMBER_HINT.to_owned())
            }
            Some(Input::Parameter { field, .. }) => {
                field.handle_key(key);
                None
            }
            Some(Input::Form { form, .. }) => form.handle_key(key),
            Some(Input::Picker(_)) | None => None,
        };
    }

    pub(super) fn paste(&mut self, text: &str) {
        match &mut self.input {
            Some(Input::Factor { field, .. } | Input::Parameter { field, .. }) => field.insert(text.trim()),
            Some(Input::Form { form, .. }) => self.notice = form.paste(text),
            Some(Input::Picker(_)) | None => {}
        }
    }

    /// Selects the clicked row, or the clicked cell of a form.
    pub(super) fn handle_click(&mut self, row: usize, company: &DisplayedCompany) {
        match &mut self.input {
            Some(Input::Form { form, .. }) => form.handle_click(row, company),
            Some(Input::Picker(selected)) => {
                *selected = row.min(new_decisions(company).len().saturating_sub(1))
            }
            Some(Input::Factor { .. } | Input::Parameter { .. }) => {}
            None => self.select(row),
        }
    }

    /// Describes a row: its status and its text.
    pub(super) fn row_texts(&self, row: Row, names: &EnterpriseNames) -> (String, String) {
        let Some(history) = self.history() else { return Default::default() };
        match row {
            Row::Decision(line) => {
                let Some(decision) = history.decision(line) else { return Default::default() };
                let treatment = self.treatment(line);
                let text = match &treatment {
                    Treatment::Scale(_) | Treatment::Replace(_) => {
                        describe_treatment(decision, &treatment, history, names)
                    }
                    Treatment::Keep | Treatment::LeaveOut => describe_decision(decision, history, names),
                };
                let is_rejected = decision.call().is_some_and(|call| !call.accepted);
                let note = match decision {
                    RecordedDecision::Parameter { from_day: Some(day), .. } => format!(" from day {day}"),
                    _ if is_rejected && treatment == Treatment::Keep => " (rejected in your run)".to_owned(),
                    _ => String::new(),
                };
                (treatment.label(), format!("{text}{note}"))
            }
            Row::Change(at) => {
                let change = &self.changes()[at].change;
                let text = change.describe(history, names, self.start_week());
                match (change, change.week(history)) {
                    (Change::AllWeeks { .. }, _) => ("from then".to_owned(), text),
                    (Change::Added { .. }, week) if week == self.week => {
                        ("add".to_owned(), text.strip_prefix("add ").unwrap_or(&text).to_owned())
                    }
                    (_, week) if week == self.week => ("set".to_owned(), text),
                    (_, week) => (format!("week {week}"), text),
                }
            }
            Row::Week(week) => (format!("week {week}"), describe_week(week, history)),
            Row::Add => ("+".to_owned(), "add a decision".to_owned()),
        }
    }
}
