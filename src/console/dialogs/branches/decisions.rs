//! The decisions of a week, and the changes of each alternative.

use super::changes::{
    Change, ListedChange, Problem, Treatment, describe_decision, describe_treatment, describe_week,
};
use super::picker::NewDecision;
use crate::action::Scope;
use crate::screens::tools::decision_form::DecisionForm;
use novamind_insight::{BranchComparison, DecisionEdit, DecisionHistory, RecordedDecision};
use novamind_session::EnterpriseNames;
use novamind_tools::Rejection;
use novamind_tui::widgets::TextField;

/// Maximum number of weeks with decisions that are offered if the displayed week has none.
const MAX_OFFERED_WEEKS: usize = 4;

/// A row of the list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Row {
    /// The recorded decision in a line of the trajectory.
    Decision(u64),
    /// The change with this index in the current alternative, unless the row of its recorded decision is displayed.
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
    pub(super) week: u32,
    pub(super) last_week: u32,
    /// The recorded decisions, or `None` until they are loaded.
    pub(super) history: Option<Box<DecisionHistory>>,
    pub(super) alternatives: Vec<Vec<ListedChange>>,
    pub(super) current: usize,
    pub(super) selected: usize,
    pub(super) input: Option<Input>,
    /// A message for the selected row.
    pub(super) notice: Option<String>,
    /// Whether the changes were edited since the last check.
    pub(super) is_unchecked: bool,
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

    /// Returns whether a decision is selected, or the decisions are not loaded yet.
    pub(super) fn is_decision_selected(&self) -> bool {
        self.history.is_none() || matches!(self.rows().get(self.selected), Some(Row::Decision(_)))
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

    /// Returns whether an alternative has changes.
    pub(super) fn has_changes(&self) -> bool {
        self.alternatives.iter().any(|changes| !changes.is_empty())
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
        let has_own_row =
            |listed: &ListedChange| !matches!(listed.change, Change::Recorded { .. }) || !is_here(listed);
        let mut others: Vec<usize> =
            (0..self.changes().len()).filter(|at| has_own_row(&self.changes()[*at])).collect();
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
        match self.position_of(wanted).map(|at| &self.changes()[at].change) {
            Some(Change::Recorded { treatment, .. }) => treatment.clone(),
            _ => Treatment::Keep,
        }
    }

    /// Returns the index of the change of the recorded decision in a line.
    fn position_of(&self, wanted: u64) -> Option<usize> {
        let is_it =
            |listed: &ListedChange| matches!(listed.change, Change::Recorded { line, .. } if line == wanted);
        self.changes().iter().position(is_it)
    }

    /// Returns the problem with the change in a row, if there is one.
    pub(super) fn problem(&self, row: Row) -> Option<&Problem> {
        let listed = match row {
            Row::Decision(wanted) => self.position_of(wanted).map(|at| &self.changes()[at]),
            Row::Change(at) => self.changes().get(at),
            Row::Week(_) | Row::Add => None,
        };
        listed?.problem.as_ref()
    }

    pub(super) fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows().len().saturating_sub(1));
    }

    pub(super) fn select_row(&mut self, wanted: Row) {
        let row = self.rows().iter().position(|row| *row == wanted);
        self.select(row.unwrap_or(self.selected));
    }

    pub(super) fn set_treatment(&mut self, wanted: u64, treatment: Treatment) {
        let place = self.position_of(wanted);
        let changes = &mut self.alternatives[self.current];
        let change = ListedChange::from(Change::Recorded { line: wanted, treatment: treatment.clone() });
        match (place, treatment) {
            (Some(at), Treatment::Keep) => drop(changes.remove(at)),
            (Some(at), _) => changes[at] = change,
            (None, Treatment::Keep) => {}
            (None, _) => changes.push(change),
        }
        self.is_unchecked = true;
    }

    pub(super) fn put_change(&mut self, target: Target, change: Change) {
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

    pub(super) fn remove_change(&mut self, at: usize) {
        self.alternatives[self.current].remove(at);
        self.is_unchecked = true;
        self.select(self.selected);
    }

    /// Shows the week of a change and selects its row.
    pub(super) fn go_to_change(&mut self, at: usize) {
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
            Input::Picker(_) => vec![Scope::Decisions, Scope::List],
            Input::Factor { .. } | Input::Parameter { .. } => vec![Scope::Field],
            Input::Form { form, .. } => form.scopes(),
        })
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
