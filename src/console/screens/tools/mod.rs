//! Forms of all tools, generated from the catalog.

mod earlier;
mod figure;
mod form;
mod form_pane;
mod grid;
mod list_pane;
mod margins;
mod outcome;
mod reference;
mod sheet;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::Value;
use strum::VariantArray;

use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::Action;
use crate::context::{Look, ScreenId};
use crate::effect::Effect;
use form::{Form, spaced};
use novamind_base::notation::plain_numbers;
use novamind_database::Rows;
use novamind_report::insights::{insights_as_ranges, overview_with_ages};
use novamind_report::plan_margins::Sales;
use novamind_report::research::projects_with_means;
use novamind_session::JournalEntry;
use novamind_tools::{Answer, CATALOGUE, Spec, ToolId};
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Field;
use novamind_worker::company::Company;
use novamind_worker::message::News;
use novamind_worker::readings::Reading;
use outcome::Leads;

/// Panes of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum ToolsPane {
    /// List of all tools.
    #[default]
    List,
    /// Form of the selected tool.
    Form,
}

/// The tools screen.
#[derive(Default)]
pub struct Tools {
    focus: ToolsPane,
    /// Index among the shown tools.
    selected: usize,
    filter: String,
    typing: Option<Field>,
    /// Opened forms with their drafts.
    forms: BTreeMap<ToolId, Form>,
    leads: Leads,
    sales: Sales,
}

impl Tools {
    /// Returns the tools that pass the filter, in catalog order.
    fn shown(&self) -> Vec<&'static Spec> {
        let wanted = self.filter.to_lowercase();
        let fits = |spec: &&'static Spec| {
            spec.name().contains(&wanted)
                || spec.code.to_lowercase().starts_with(&wanted)
                || spec.summary.to_lowercase().contains(&wanted)
        };
        CATALOGUE.iter().map(|tool| tool.spec()).filter(fits).collect()
    }

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
            self.focus = ToolsPane::Form;
            if let Some(form) = self.form(company) {
                form.at = sheet::CellPlace::default();
            }
        }
    }

    /// Shows the form of a tool and focuses the first cell of a group, plan or similar.
    pub fn show_cell(&mut self, tool: ToolId, of: &str, company: &Company) {
        self.show(tool, company);
        if let Some(form) = self.form(company)
            && let Some(place) = form.sheet.place_for(of)
        {
            form.at = place;
        }
    }

    /// Returns the path of the focused cell.
    #[cfg(test)]
    pub fn place_path(&self) -> Option<String> {
        let form = self.seen_form()?;
        let block = form.sheet.blocks.get(form.at.block)?;
        Some(block.path(form.at.row, form.at.column))
    }

    /// Returns the arguments that the shown form would send.
    #[cfg(test)]
    pub fn typed_arguments(&self) -> Option<Value> {
        self.seen_form()?.sheet.arguments().ok()
    }

    /// Shows the form of a tool with arguments filled in.
    pub fn prefill(&mut self, tool: ToolId, arguments: &Value, company: &Company) -> Vec<Effect> {
        self.show(tool, company);
        self.form(company).map_or(Vec::new(), |form| {
            form.sheet.fill(arguments);
            form.check()
        })
    }

    fn drafts(&self) -> impl Iterator<Item = &Form> {
        self.forms.values().filter(|form| form.is_draft())
    }

    /// Returns the tools whose forms have unsent values.
    pub fn unsent(&self) -> Vec<ToolId> {
        self.drafts().map(|form| form.spec.id).collect()
    }

    /// Returns the name of the tool whose form is shown.
    pub fn form_name(&self) -> Option<&'static str> {
        self.here().map(Spec::name)
    }

    /// Returns the unsent values by tool and path.
    pub fn typed_values(&self) -> BTreeMap<ToolId, BTreeMap<String, String>> {
        let unsent = self.unsent().into_iter();
        unsent.filter_map(|tool| Some((tool, self.forms.get(&tool)?.sheet.typed()))).collect()
    }

    /// Restores unsent values.
    pub fn restore(&mut self, tool: ToolId, values: &BTreeMap<String, String>, company: &Company) {
        let Some(spec) = CATALOGUE.iter().map(|own| own.spec()).find(|spec| spec.id == tool) else { return };
        let form = self.forms.entry(tool).or_insert_with(|| Form::of(spec, company));
        form.sheet.retype(values);
    }

    /// Opens the separate screen or dialog of a tool, if it has one.
    fn elsewhere(&self) -> Option<Effect> {
        match self.here()?.id {
            ToolId::NextWeek => Some(Effect::Do(Action::NextWeek)),
            ToolId::Query => Some(Effect::Show(ScreenId::Sql)),
            _ => None,
        }
    }

    /// Returns this week's calls and drafts, one per line, for copying.
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
        let drafts: Vec<String> = self.drafts().map(Form::call).collect();
        if !drafts.is_empty() {
            lines.push("# not sent yet".to_owned());
            lines.extend(drafts);
        }
        lines.push(String::new());
        lines.join("\n")
    }
}

impl ScreenState for Tools {
    fn readings(&self) -> &'static [Reading] {
        &[Reading::LeadsByChannel, Reading::Subscribers, Reading::Usage]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, _: &Look<'_>) {
        match reading {
            Reading::LeadsByChannel => self.leads = Leads::read(rows),
            Reading::Subscribers => self.sales.take_subscribers(rows),
            Reading::Usage => self.sales.take_usage(rows),
            _ => {}
        }
    }

    fn renew(&mut self, look: &Look<'_>) {
        for form in self.forms.values_mut() {
            form.renew(look.company);
        }
        self.form(look.company);
    }

    fn take_answers(&mut self, _: &Look<'_>) -> Vec<Effect> {
        self.forms.values_mut().for_each(Form::take_preview);
        Vec::new()
    }

    fn hear(&mut self, news: &News, look: &Look<'_>) -> Vec<Effect> {
        match news {
            // The last check and answer are outdated.
            News::Restored(_, Ok(_), _) => {
                self.forms.values_mut().for_each(|form| form.answer = None);
            }
            News::Called(tool, answer, _) => {
                if let Some(form) = self.forms.get_mut(tool) {
                    if answer.is_ok() && tool.runs_code() {
                        // The user can correct the call and send it again.
                        form.stop_typing();
                    } else if answer.is_ok() {
                        form.reset(look.company);
                        // A sent form returns the focus to the list.
                        if form.spec.kind.acts() {
                            self.focus = ToolsPane::List;
                        }
                    } else if let Err(refusal) = answer
                        && let Some(place) =
                            refusal.field.as_ref().and_then(|field| form.sheet.place_of(field))
                    {
                        form.at = place;
                    }
                    form.answer = Some(answer.clone().map(|answer| for_people(&answer, look.company)));
                }
            }
            _ => {}
        }
        Vec::new()
    }

    fn open_here(&self, _: &Look<'_>) -> Option<String> {
        (self.focus == ToolsPane::Form).then(|| self.here().map(|spec| spec.name().to_owned())).flatten()
    }

    fn opened(&self) -> usize {
        usize::from(self.focus == ToolsPane::Form)
            + usize::from(!self.filter.is_empty() || self.typing.is_some())
    }

    fn open_object(&self, _: &Look<'_>) -> Option<(&'static str, String)> {
        let tool = self.here().filter(|_| self.focus == ToolsPane::Form)?;
        Some(("tool", tool.name().to_owned()))
    }

    fn edited(&self) -> Option<(String, String)> {
        let form = self.seen_form().filter(|_| self.focus == ToolsPane::Form)?;
        Some((format!("form {}", form.spec.id), form.typed_text()))
    }

    fn holds_unsent_text(&self) -> bool {
        !self.unsent().is_empty()
    }
}

/// Returns an answer as users see it: estimates as ranges with their day, and the minimum for means of
/// projects.
fn for_people(answer: &Answer, company: &Company) -> Value {
    let told = plain_numbers(answer.to_json());
    match answer {
        Answer::GetGroupInsights(insights) => {
            company.fit(insights.group_id).map_or_else(|| told.clone(), |fit| insights_as_ranges(&told, fit))
        }
        Answer::GetMarketOverview(_) => overview_with_ages(&told, &company.fits),
        Answer::ListResearchProjects(_) => projects_with_means(&told, &company.research_means),
        _ => told,
    }
}

impl Paned for Tools {
    type Name = ToolsPane;

    fn panes(&self) -> &'static [ToolsPane] {
        ToolsPane::VARIANTS
    }

    fn pane(name: ToolsPane) -> &'static dyn Pane<Tools> {
        match name {
            ToolsPane::List => &list_pane::ToolListPane,
            ToolsPane::Form => &form_pane::FormPane,
        }
    }

    fn focused(&self) -> ToolsPane {
        self.focus
    }

    fn focus_on(&mut self, name: ToolsPane) {
        self.focus = name;
        if name == ToolsPane::List {
            // The text stays a draft, but typing does not continue when the focus returns.
            self.forms.values_mut().for_each(Form::stop_typing);
        }
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let narrow = area.width < 100;
        let list = match self.focus {
            ToolsPane::Form if narrow => 0,
            _ if narrow => 34,
            _ if area.width < 112 => 32,
            // The longest name, its code and the gap.
            _ => 37,
        };
        let [left, right] = Layout::horizontal([Constraint::Length(list), Constraint::Min(0)]).areas(area);
        draw_pane(self, ToolsPane::List, canvas, left, look);
        draw_pane(self, ToolsPane::Form, canvas, right, look);
    }
}
