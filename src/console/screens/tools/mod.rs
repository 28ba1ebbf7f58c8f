//! Forms of all tools, made from the catalogue.

mod draw;
mod earlier;
mod figure;
mod form;
mod grid;
mod outcome;
mod reference;
mod sheet;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use serde_json::Value;

use super::{Figure, Look, Screen, ScreenId};
use crate::console::action::{Action, Scope};
use crate::console::canvas::Canvas;
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::message::News;
use crate::console::readings::Reading;
use crate::console::widgets::Field;
use crate::session::{JournalEntry, Rows};
use crate::tools::{CATALOGUE, Spec, ToolId};
use form::{Form, spaced};
use outcome::Leads;

/// The screen.
#[derive(Default)]
pub struct Tools {
    /// 0 the list, 1 the form.
    focus: usize,
    /// Place among the tools that are shown.
    selected: usize,
    filter: String,
    typing: Option<Field>,
    /// Forms that were opened, with their drafts.
    forms: BTreeMap<ToolId, Form>,
    leads: Leads,
}

impl Tools {
    /// Tools that the filter leaves, in the order of the catalogue.
    fn shown(&self) -> Vec<&'static Spec> {
        let wanted = self.filter.to_lowercase();
        let fits = |spec: &&'static Spec| {
            spec.name().contains(&wanted)
                || spec.code.to_lowercase().starts_with(&wanted)
                || spec.summary.to_lowercase().contains(&wanted)
        };
        CATALOGUE.iter().map(|tool| tool.spec()).filter(fits).collect()
    }

    /// The tool that is selected.
    fn here(&self) -> Option<&'static Spec> {
        self.shown().get(self.selected).copied()
    }

    fn form(&mut self, company: &Company) -> Option<&mut Form> {
        let spec = self.here()?;
        Some(self.forms.entry(spec.id).or_insert_with(|| Form::of(spec, company)))
    }

    fn seen_form(&self) -> Option<&Form> {
        self.forms.get(&self.here()?.id)
    }

    /// Shows the form of a tool.
    pub fn show(&mut self, tool: ToolId, company: &Company) {
        self.filter.clear();
        self.typing = None;
        if let Some(place) = self.shown().iter().position(|spec| spec.id == tool) {
            self.selected = place;
            self.focus = 1;
            if let Some(form) = self.form(company) {
                form.at = sheet::Place::default();
            }
        }
    }

    /// Shows the form of a tool at the first cell that is for a group, a plan or the like.
    pub fn show_cell(&mut self, tool: ToolId, of: &str, company: &Company) {
        self.show(tool, company);
        if let Some(form) = self.form(company)
            && let Some(place) = form.sheet.place_for(of)
        {
            form.at = place;
        }
    }

    /// Path of the cell that has the focus.
    #[cfg(test)]
    pub fn place_path(&self) -> Option<String> {
        let form = self.seen_form()?;
        let block = form.sheet.blocks.get(form.at.block)?;
        Some(block.path(form.at.row, form.at.column))
    }

    /// Arguments that the form on screen would send.
    #[cfg(test)]
    pub fn typed_arguments(&self) -> Option<Value> {
        self.seen_form()?.sheet.arguments().ok()
    }

    /// Shows the form of a tool with arguments typed into it.
    pub fn prefill(&mut self, tool: ToolId, arguments: &Value, company: &Company) -> Vec<Effect> {
        self.show(tool, company);
        self.form(company).map_or(Vec::new(), |form| {
            form.sheet.fill(arguments);
            form.check()
        })
    }

    /// Tools whose forms hold values that were not sent.
    pub fn unsent(&self) -> Vec<ToolId> {
        let unsent = self.forms.values().filter(|form| form.spec.kind.acts() && form.sheet.is_changed());
        unsent.map(|form| form.spec.id).collect()
    }

    /// Tools that have a screen or a dialog of their own lead there.
    fn elsewhere(&self) -> Option<Effect> {
        match self.here()?.id {
            ToolId::NextWeek => Some(Effect::Do(Action::NextWeek)),
            ToolId::Query => Some(Effect::Show(ScreenId::Sql)),
            _ => None,
        }
    }

    /// The calls of this week and of drafts, one in a line, as they are copied.
    fn calls(&self, company: &Company) -> String {
        let day = company.seen.day;
        let done = company.journal.iter().filter_map(|entry| match entry {
            JournalEntry::Call { day: own, tool, args, .. } if *own == day => {
                let module = tool.spec().module.id();
                Some(format!("{module}.{tool}({})", spaced(args)))
            }
            _ => None,
        });
        let mut lines = vec![format!("# day {day}, run {}", company.seen.run)];
        lines.extend(done);
        let drafts = self.forms.values().filter(|form| form.spec.kind.acts() && form.sheet.is_changed());
        let drafts: Vec<String> = drafts.map(Form::call).collect();
        if !drafts.is_empty() {
            lines.push("# not sent yet".to_owned());
            lines.extend(drafts);
        }
        lines.push(String::new());
        lines.join("\n")
    }

    fn act_in_list(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let last = self.shown().len().saturating_sub(1);
        match action {
            Action::Up => self.selected = self.selected.saturating_sub(1),
            Action::Down => self.selected = (self.selected + 1).min(last),
            Action::PageUp => self.selected = self.selected.saturating_sub(look.page as usize),
            Action::PageDown => self.selected = (self.selected + look.page as usize).min(last),
            Action::First => self.selected = 0,
            Action::Last => self.selected = last,
            Action::Filter => self.typing = Some(Field::of(self.filter.clone())),
            Action::Close | Action::Discard => {
                self.typing = None;
                self.filter.clear();
                self.selected = 0;
            }
            Action::Commit | Action::CommitDown | Action::CommitNext => self.typing = None,
            Action::Open | Action::Right => {
                if let Some(effect) = self.elsewhere() {
                    return if action == Action::Open { vec![effect] } else { Vec::new() };
                }
                self.focus = 1;
            }
            _ => {}
        }
        self.form(look.company);
        Vec::new()
    }

    fn is_typing(&self) -> bool {
        self.focus == 1 && self.seen_form().is_some_and(Form::is_typing)
    }
}

impl Screen for Tools {
    fn scopes(&self) -> Vec<Scope> {
        match self.focus {
            0 if self.typing.is_some() => vec![Scope::Field],
            0 => vec![Scope::List],
            _ if self.is_typing() => vec![Scope::Field, Scope::Form],
            _ => vec![Scope::Form, Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match self.focus {
            0 if self.typing.is_some() => vec![Action::Commit, Action::Discard],
            0 => vec![Action::Open, Action::Filter],
            _ if self.is_typing() => {
                vec![Action::CommitDown, Action::CommitNext, Action::Apply, Action::Discard]
            }
            _ => vec![
                Action::EditCell,
                Action::Apply,
                Action::SameDown,
                Action::ResetForm,
                Action::CopyCall,
                Action::SaveCalls,
                Action::Close,
                Action::ClearCell,
            ],
        }
    }

    fn panes(&self) -> usize {
        2
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(1);
    }

    fn figure(&self, _: &Look<'_>) -> Option<Figure> {
        figure::of(self)
    }

    fn readings(&self) -> &'static [Reading] {
        &[Reading::LeadsByChannel]
    }

    fn take(&mut self, _: Reading, rows: &Rows, _: &Look<'_>) {
        self.leads = Leads::read(rows);
    }

    fn renew(&mut self, look: &Look<'_>) {
        for form in self.forms.values_mut() {
            form.renew(look.company);
        }
        self.form(look.company);
    }

    fn hear(&mut self, news: &News, look: &Look<'_>) -> Vec<Effect> {
        match news {
            News::Checked(_, preview) => {
                if let Some(form) = self.form(look.company) {
                    form.preview = Some(preview.clone());
                }
            }
            // What a form said of its call holds no longer.
            News::Undone(Ok(_), _) | News::Redone(Ok(_), _) => {
                self.forms.values_mut().for_each(|form| form.answer = None);
            }
            News::Called(tool, answer, _) => {
                if let Some(form) = self.forms.get_mut(tool) {
                    if answer.is_ok() {
                        form.reset(look.company);
                        // What was sent is done with; keys are those of the list again.
                        if form.spec.kind.acts() {
                            self.focus = 0;
                        }
                    } else if let Err(refusal) = answer
                        && let Some(place) =
                            refusal.field.as_ref().and_then(|field| form.sheet.place_of(field))
                    {
                        form.at = place;
                    }
                    form.answer = Some(answer.clone());
                }
            }
            _ => {}
        }
        Vec::new()
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if self.focus == 0 {
            return self.act_in_list(action, look);
        }
        if action == Action::Close || (action == Action::EditCell && self.elsewhere().is_some()) {
            self.focus = 0;
            return match action {
                Action::EditCell => self.elsewhere().into_iter().collect(),
                _ => Vec::new(),
            };
        }
        if action == Action::SaveCalls {
            return vec![Effect::Write("calls.txt".to_owned(), self.calls(look.company).into_bytes())];
        }
        match self.form(look.company) {
            Some(form) => form.act(action, look.company),
            None => Vec::new(),
        }
    }

    fn key(&mut self, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect> {
        if self.focus == 0 {
            if let Some(field) = &mut self.typing {
                field.key(key);
                self.filter = field.text().to_owned();
                self.selected = 0;
                self.form(look.company);
            }
            return Vec::new();
        }
        self.form(look.company).map_or(Vec::new(), |form| form.key(key))
    }

    fn paste(&mut self, text: &str, look: &Look<'_>) -> Vec<Effect> {
        match self.focus {
            0 => Vec::new(),
            _ => self.form(look.company).map_or(Vec::new(), |form| form.paste(text)),
        }
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        if pane == 0 {
            self.selected = row.min(self.shown().len().saturating_sub(1));
            self.form(look.company);
        } else if let Some(form) = self.form(look.company).filter(|form| !form.is_typing()) {
            let place = form.sheet.places().nth(row);
            if place == Some(form.at) {
                return form.act(Action::EditCell, look.company);
            }
            form.at = place.unwrap_or(form.at);
        }
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        draw::draw(self, canvas, area, look);
    }

    fn holds_unsent_text(&self) -> bool {
        !self.unsent().is_empty()
    }
}
