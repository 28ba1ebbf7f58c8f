//! The tools screen with forms for all tools, which are generated from the catalog.

pub mod decision_form;
mod earlier_calls;
mod figure;
mod form;
mod form_pane;
mod grid;
mod list_pane;
mod margins;
mod outcome;
mod price_curve;
mod reference;
mod sheet;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::Value;
use strum::VariantArray;

use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane};
use crate::action::Action;
use crate::context::{ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::tour::FormFacts;
use form::{ToolForm, format_json};
use novamind_base::formatting::normalize_json_numbers;
use novamind_database::QueryResult;
use novamind_report::insights::{insights_as_ranges, overview_with_ages};
use novamind_report::plan_margins::PlanSales;
use novamind_report::research::projects_with_means;
use novamind_session::JournalEntry;
use novamind_tools::{Answer, CATALOGUE, ToolSpec, ToolId};
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::TextField;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::message::Response;
use novamind_worker::screen_queries::Reading;
use outcome::ChannelLeads;
use price_curve::PriceCurve;
use sheet::CellPosition;

/// Panes of the tools screen.
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
    /// Index of the selected tool among the displayed tools.
    selected: usize,
    filter: String,
    filter_field: Option<TextField>,
    /// Opened forms with their drafts.
    forms: BTreeMap<ToolId, ToolForm>,
    leads: ChannelLeads,
    sales: PlanSales,
    price_curve: PriceCurve,
}

impl Tools {
    /// Returns the tools that pass the filter, in catalog order.
    fn visible_tools(&self) -> Vec<&'static ToolSpec> {
        let wanted = self.filter.to_lowercase();
        let fits = |spec: &&'static ToolSpec| {
            spec.name().contains(&wanted)
                || spec.code.to_lowercase().starts_with(&wanted)
                || spec.summary.to_lowercase().contains(&wanted)
        };
        CATALOGUE.iter().map(|tool| tool.spec()).filter(fits).collect()
    }

    fn selected_tool(&self) -> Option<&'static ToolSpec> {
        self.visible_tools().get(self.selected).copied()
    }

    fn form(&mut self, company: &DisplayedCompany) -> Option<&mut ToolForm> {
        let spec = self.selected_tool()?;
        Some(self.forms.entry(spec.id).or_insert_with(|| ToolForm::new(spec, company)))
    }

    fn visible_form(&self) -> Option<&ToolForm> {
        self.forms.get(&self.selected_tool()?.id)
    }

    /// Shows the form of a tool.
    pub fn show_tool(&mut self, tool: ToolId, company: &DisplayedCompany) {
        self.filter.clear();
        self.filter_field = None;
        if let Some(place) = self.visible_tools().iter().position(|spec| spec.id == tool) {
            self.selected = place;
            self.focus = ToolsPane::Form;
            if let Some(form) = self.form(company) {
                form.focus = sheet::CellPosition::default();
            }
        }
    }

    /// Shows the form of a tool and focuses the first cell for a key, for example a group or a plan.
    pub fn show_cell(&mut self, tool: ToolId, of: &str, company: &DisplayedCompany) {
        self.show_tool(tool, company);
        if let Some(form) = self.form(company)
            && let Some(place) = form.sheet.position_of_name(of)
        {
            form.focus = place;
        }
    }

    /// Returns the path of the focused cell.
    #[cfg(test)]
    pub fn focused_path(&self) -> Option<String> {
        let form = self.visible_form()?;
        let block = form.sheet.blocks.get(form.focus.block)?;
        Some(block.path(form.focus.row, form.focus.column))
    }

    /// Returns the arguments that the displayed form would send.
    #[cfg(test)]
    pub fn typed_arguments(&self) -> Option<Value> {
        self.visible_form()?.sheet.arguments().ok()
    }

    /// Shows the form of a tool with arguments filled in.
    pub fn prefill(&mut self, tool: ToolId, arguments: &Value, company: &DisplayedCompany) -> Vec<Effect> {
        self.show_tool(tool, company);
        self.form(company).map_or(Vec::new(), |form| form.fill_suggestion(arguments))
    }

    /// Discards the values that another screen filled into the focused form, if the user did not change them.
    pub fn discard_suggestion(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        match self.focus {
            ToolsPane::Form => self.form(company).map_or(Vec::new(), |form| form.discard_suggestion(company)),
            ToolsPane::List => Vec::new(),
        }
    }

    /// Returns the state of the form that has the focus, for the tour.
    pub fn tour_facts(&self) -> Option<FormFacts> {
        let form = self.visible_form().filter(|_| self.focus == ToolsPane::Form)?;
        Some(FormFacts {
            tool: Some(form.spec.id),
            is_at_first_cell: form.focus == CellPosition::default(),
            draft: form.sheet.cell(CellPosition::default()).and_then(|cell| Some(cell.draft.as_ref()?.text().to_owned())),
            typed: form.typed_number(),
        })
    }

    fn forms_with_drafts(&self) -> impl Iterator<Item = &ToolForm> {
        self.forms.values().filter(|form| form.has_draft())
    }

    /// Returns the tools whose forms have unsent values.
    pub fn tools_with_drafts(&self) -> Vec<ToolId> {
        self.forms_with_drafts().map(|form| form.spec.id).collect()
    }

    /// Returns the name of the tool whose form is shown.
    pub fn form_name(&self) -> Option<&'static str> {
        self.selected_tool().map(ToolSpec::name)
    }

    /// Returns the unsent values by tool and path.
    pub fn draft_values(&self) -> BTreeMap<ToolId, BTreeMap<String, String>> {
        let unsent = self.tools_with_drafts().into_iter();
        unsent.filter_map(|tool| Some((tool, self.forms.get(&tool)?.sheet.drafts()))).collect()
    }

    /// Restores unsent values in the form of a tool.
    pub fn restore_drafts(&mut self, tool: ToolId, values: &BTreeMap<String, String>, company: &DisplayedCompany) {
        let Some(spec) = CATALOGUE.iter().map(|definition| definition.spec()).find(|spec| spec.id == tool) else { return };
        let form = self.forms.entry(tool).or_insert_with(|| ToolForm::new(spec, company));
        form.sheet.restore_drafts(values);
    }

    /// Returns the effect that opens the separate screen or dialog of the selected tool, if it has one.
    fn dedicated_screen_effect(&self) -> Option<Effect> {
        match self.selected_tool()?.id {
            ToolId::NextWeek => Some(Effect::Execute(Action::NextWeek)),
            ToolId::Query => Some(Effect::Show(ScreenId::Sql)),
            _ => None,
        }
    }

    /// Returns the calls and drafts of this week as text, one per line.
    fn calls_text(&self, company: &DisplayedCompany) -> String {
        let day = company.observation.day;
        let done = company.journal.iter().filter_map(|entry| match entry {
            JournalEntry::Call { day: number, tool, args, .. } if *number == day => {
                let module = tool.spec().module.id();
                Some(format!("{module}.{tool}({})", format_json(args)))
            }
            _ => None,
        });
        let mut lines = vec![format!("# day {day}, run {}", company.observation.run)];
        lines.extend(done);
        let drafts: Vec<String> = self.forms_with_drafts().map(ToolForm::call_text).collect();
        if !drafts.is_empty() {
            lines.push("# not sent yet".to_owned());
            lines.extend(drafts);
        }
        lines.push(String::new());
        lines.join("\n")
    }
}

impl ScreenState for Tools {
    fn screen_queries(&self) -> &'static [Reading] {
        &[Reading::LeadsByChannel, Reading::Subscribers, Reading::Usage]
    }

    fn apply_rows(&mut self, reading: Reading, rows: &QueryResult, _: &ScreenContext<'_>) {
        match reading {
            Reading::LeadsByChannel => self.leads = ChannelLeads::from_rows(rows),
            Reading::Subscribers => self.sales.set_subscribers(rows),
            Reading::Usage => self.sales.set_usage(rows),
            _ => {}
        }
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.price_curve.set_outdated();
        for form in self.forms.values_mut() {
            form.update(context.company);
        }
        self.form(context.company);
    }

    fn request_data(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        match context.company.has_tool(ToolId::SetPrices) {
            true => self.price_curve.request(context.company),
            false => Vec::new(),
        }
    }

    fn take_answers(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        self.price_curve.take_answer();
        self.forms.values_mut().for_each(ToolForm::take_preview);
        Vec::new()
    }

    fn handle_response(&mut self, news: &Response, context: &ScreenContext<'_>) -> Vec<Effect> {
        match news {
            // Undo and redo change settings, so that earlier answers are outdated.
            Response::SettingRestored(_, Ok(_), _) => {
                self.forms.values_mut().for_each(|form| form.answer = None);
            }
            Response::ToolCalled(tool, answer, _) => {
                if let Some(form) = self.forms.get_mut(tool) {
                    form.text_page.number = 0;
                    if answer.is_ok() && tool.executes_code() {
                        // The form keeps its code, so that the user can change the code and send it again.
                        form.stop_typing();
                    } else if answer.is_ok() {
                        form.reset(context.company);
                        // After a call that changes the company, the list gets the focus.
                        if form.spec.kind.changes_company() {
                            self.focus = ToolsPane::List;
                        }
                    } else if let Err(refusal) = answer
                        && let Some(place) =
                            refusal.field.as_ref().and_then(|field| form.sheet.position_of_path(field))
                    {
                        form.focus = place;
                    }
                    form.answer = Some(answer.clone().map(|answer| display_value(&answer, context.company)));
                }
            }
            _ => {}
        }
        Vec::new()
    }

    /// Shows the list of tools. Forms keep their drafts, and enter opens the last form again.
    fn show_first_view(&mut self) {
        self.set_focused_pane(ToolsPane::List);
    }

    fn open_item_title(&self, _: &ScreenContext<'_>) -> Option<String> {
        (self.focus == ToolsPane::Form).then(|| self.selected_tool().map(|spec| spec.name().to_owned())).flatten()
    }

    fn screen_escape_depth(&self) -> usize {
        usize::from(self.focus == ToolsPane::Form)
            + usize::from(!self.filter.is_empty() || self.filter_field.is_some())
    }

    fn open_object(&self, _: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        let tool = self.selected_tool().filter(|_| self.focus == ToolsPane::Form)?;
        Some(("tool", tool.name().to_owned()))
    }

    fn edited_text(&self) -> Option<(String, String)> {
        let form = self.visible_form().filter(|_| self.focus == ToolsPane::Form)?;
        Some((format!("form {}", form.spec.id), form.typed_text()))
    }

    fn has_unsent_text(&self) -> bool {
        !self.tools_with_drafts().is_empty()
    }
}

/// Returns an answer as shown to users: estimates as ranges with their day, and means of projects with their minimum.
fn display_value(answer: &Answer, company: &DisplayedCompany) -> Value {
    let value = normalize_json_numbers(answer.to_json());
    match answer {
        Answer::GetGroupInsights(insights) => {
            company.fit(insights.group_id).map_or_else(|| value.clone(), |fit| insights_as_ranges(&value, fit))
        }
        Answer::GetMarketOverview(_) => overview_with_ages(&value, &company.fits),
        Answer::ListResearchProjects(_) => projects_with_means(&value, &company.research_means),
        _ => value,
    }
}

impl PaneScreen for Tools {
    type PaneId = ToolsPane;

    fn panes(&self) -> &'static [ToolsPane] {
        ToolsPane::VARIANTS
    }

    fn pane(name: ToolsPane) -> &'static dyn Pane<Tools> {
        match name {
            ToolsPane::List => &list_pane::ToolListPane,
            ToolsPane::Form => &form_pane::FormPane,
        }
    }

    fn focused_pane(&self) -> ToolsPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: ToolsPane) {
        self.focus = name;
        // The typed text remains a draft.
        self.forms.values_mut().for_each(ToolForm::stop_typing);
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let narrow = area.width < 100;
        let list = match self.focus {
            ToolsPane::Form if narrow => 0,
            _ if narrow => 34,
            _ if area.width < 112 => 32,
            // Width of the longest tool name, its code and the gap between them.
            _ => 37,
        };
        let [left, right] = Layout::horizontal([Constraint::Length(list), Constraint::Min(0)]).areas(area);
        draw_pane(self, ToolsPane::List, canvas, left, context);
        draw_pane(self, ToolsPane::Form, canvas, right, context);
    }
}
