//! Editing of the decisions of a week: keys, forms and fields.

use crossterm::event::KeyEvent;
use serde_json::{Map, Value};

use super::changes::{Change, NextTreatment, Treatment, format_factor};
use super::decisions::{DecisionList, Input, Row, Target};
use super::picker::{NewDecision, new_decisions};
use crate::action::Action;
use crate::screens::tools::decision_form::DecisionForm;
use novamind_base::formatting::parse_number;
use novamind_insight::{DecisionEdit, MAX_ALTERNATIVES, MAX_FACTOR, RecordedDecision};
use novamind_tools::ToolId;
use novamind_tui::widgets::TextField;
use novamind_tui::widgets::field::NUMBER_HINT;
use novamind_worker::company::DisplayedCompany;

/// Factor that the field suggests.
const SUGGESTED_FACTOR: &str = "0.9";

impl DecisionList {
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
                    NextTreatment::Replace => {
                        self.open_decision_form(line, &Treatment::Keep, Treatment::Keep, company)
                    }
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

    /// Opens the form of a recorded decision with the values after a treatment.
    fn open_decision_form(
        &mut self,
        line: u64,
        treatment: &Treatment,
        cancelled: Treatment,
        company: &DisplayedCompany,
    ) {
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
                self.open_decision_form(line, &before.clone(), before, company);
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
                self.add(target, Change::Added { week, tool, args: Value::Object(Map::new()) });
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
            Some(Input::Factor { field, .. }) => self.notice = field.paste_number(text).err(),
            Some(Input::Parameter { field, .. }) => field.insert(text.trim()),
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
}
