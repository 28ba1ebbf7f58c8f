//! The market: groups and studies, market research, the economy, and press reports about competitors.

mod attempts;
mod economy;
mod groups;
mod true_values;
pub mod model;
mod news;
pub mod report;
#[cfg(test)]
mod tests;

use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::{Value, json};
use strum::VariantArray;

use self::model::{MarketFacts, study_level, group_name, target_level, undiscovered_count};
use self::news::CompetitorNews;
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane, draw_stack};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use novamind_base::formatting::{dollars, grouped_number};
use novamind_database::QueryResult;
use novamind_session::Preview;
use novamind_session::identifiers::Group;
use novamind_tools::{Answer, DiscoveryAttempt, ToolId};
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::{ScrollState, Table};
use novamind_worker::question::Pending;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::message::Response;
use novamind_worker::posts::Posts;
use novamind_worker::page_questions::PreviewCallQuestion;
use novamind_worker::screen_queries::Reading;

/// Panes of the market screen in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum MarketPane {
    /// Table of all groups.
    #[default]
    Groups,
    /// Estimates of the selected group's study.
    Report,
    /// List of market research attempts.
    Attempts,
    /// Press reports about competitors and the economy.
    News,
    /// Chart of the PMI.
    Economy,
}

const FIND_TOOL: ToolId = ToolId::ResearchMarket;
const STUDY_TOOL: ToolId = ToolId::ResearchGroup;

/// Actions shown in the footer while a group is selected.
const GROUP_HINTS: [Action; 5] =
    [Action::Open, Action::GroupCurve, Action::StudyGroup, Action::FindGroup, Action::Filter];

/// The market screen.
#[derive(Default)]
pub struct Market {
    focus: MarketPane,
    facts: MarketFacts,
    /// Groups in table order, known groups first.
    groups: Vec<Group>,
    table: Table,
    attempts: Table,
    news: Vec<CompetitorNews>,
    posts: Posts,
    headlines: Table,
    /// Index of the selected PMI measurement, or `None` for the last measurement.
    selected_measurement: Option<usize>,
    /// Level of the next market study that the user chose.
    target_level: Option<u8>,
    report_scroll: ScrollState,
    /// Check of the tool call before the user confirms the call.
    pending_call: Pending<PreviewCallQuestion>,
}

impl Market {
    /// Selects a group and shows its insight report.
    pub fn show_group(&mut self, group: Group) {
        self.focus = MarketPane::Groups;
        // The filter is cleared, because the filter could hide the group.
        self.table.handle_action(Action::Close, 1);
        if let Some(row) = self.groups.iter().position(|shown_group| *shown_group == group) {
            self.table.select(row);
        }
        self.reset_report();
    }

    fn handle_answer(&mut self, answer: &Answer, company: &DisplayedCompany) -> Vec<Effect> {
        match answer {
            Answer::ResearchMarket(DiscoveryAttempt::Found { discovered_group_id: group }) => {
                self.show_group(*group);
                vec![Effect::ShowStatus(format!("Found {group}: {}", group_name(company, *group)))]
            }
            Answer::ResearchMarket(DiscoveryAttempt::Nothing { .. }) => {
                vec![Effect::ShowStatus("No group found this time".to_owned())]
            }
            Answer::ResearchGroup(study) => {
                self.target_level = None;
                vec![Effect::ShowStatus(format!("The study is due on day {}", study.expected_completion_day))]
            }
            _ => Vec::new(),
        }
    }

    /// Resets the insight report after the selected group has changed.
    fn reset_report(&mut self) {
        (self.target_level, self.report_scroll) = (None, ScrollState::default());
    }

    /// Resets the insight report if the selected group is not `before`.
    fn reset_report_if_changed(&mut self, before: Option<Group>) {
        if before != self.group() {
            self.reset_report();
        }
    }

    /// Opens the customers screen with the selected group.
    fn show_customers_effect(&self, company: &DisplayedCompany) -> Vec<Effect> {
        let effect = self.group().map(|group| match study_level(company, group) {
            0 => Effect::ShowError(format!("{group} has not been found yet")),
            _ => Effect::ShowGroup(ScreenId::Customers, group),
        });
        effect.into_iter().collect()
    }

    /// Opens the participation curve of the selected group.
    fn show_curve_effect(&self, company: &DisplayedCompany) -> Vec<Effect> {
        let effect = self.group().map(|group| match study_level(company, group) {
            0 => Effect::ShowError(format!("{group} has not been found yet")),
            _ => Effect::ShowCurve(Some(group)),
        });
        effect.into_iter().collect()
    }

    fn group(&self) -> Option<Group> {
        self.table.selected().and_then(|row| self.groups.get(row)).copied()
    }

    fn rebuild_tables(&mut self, company: &DisplayedCompany) {
        let kept = self.group();
        let known = |group: &Group| study_level(company, *group) > 0;
        self.groups = company.observation.known_groups.clone();
        self.groups.extend(Group::all().filter(|group| !known(group)));
        let known = |group: &Group| self.facts.known.get(group).copied().unwrap_or_default();
        let rows = self.groups.iter().map(|group| groups::group_row(*group, known(group), company)).collect();
        self.table.set_columns_and_rows(groups::columns(), rows);
        if let Some(row) = self.groups.iter().position(|shown_group| Some(*shown_group) == kept) {
            self.table.select(row);
        }
        let tried = self.facts.attempts.iter().map(|attempt| attempts::attempt_row(attempt, company)).collect();
        self.attempts.set_columns_and_rows(attempts::columns(), tried);
        if std::sync::Arc::ptr_eq(&self.posts, &company.posts) {
            return;
        }
        self.posts = company.posts.clone();
        self.news = news::competitor_news(company);
        self.headlines.set_columns_and_rows(news::columns(), self.news.iter().map(news::news_row).collect());
    }

    fn check_call(&mut self, tool: ToolId, arguments: Value) -> Vec<Effect> {
        vec![Effect::Ask(self.pending_call.ask(PreviewCallQuestion { tool, arguments }))]
    }

    fn order_study(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        match self.group().filter(|group| study_level(company, *group) > 0) {
            Some(group) => {
                let level = target_level(company, group, self.target_level);
                self.check_call(STUDY_TOOL, json!({ "group_id": group.id(), "target_level": level }))
            }
            None => vec![Effect::ShowError("Only known groups can be studied".to_owned())],
        }
    }

    /// Returns the effect that asks for confirmation of a tool call that costs money.
    fn confirm_effect(&self, tool: ToolId, arguments: Value, preview: &Preview, company: &DisplayedCompany) -> Effect {
        let rest = company.observation.cash - preview.cost_now;
        let what = match tool {
            FIND_TOOL => format!(
                "A market research attempt has a {} % chance to find one of the {} groups not found yet.",
                grouped_number(company.tool_limits.attempt_chance * 100.0, 0),
                undiscovered_count(company)
            ),
            _ => {
                let text = |name: &str| arguments.get(name).map_or(String::new(), Value::to_string);
                let group = text("group_id").replace('"', "");
                let level = text("target_level");
                format!("A study of {group} to level {level}.")
            }
        };
        let when = preview.effect_day.map_or(String::new(), |day| format!(" It is done on day {day}."));
        let text = format!(
            "{what}{when} It costs {} at once, leaves {}, and cannot be undone.",
            dollars(preview.cost_now),
            dollars(rest)
        );
        Effect::ConfirmCall { tool, arguments, text }
    }

    fn economy_view(&self) -> economy::EconomyView<'_> {
        economy::EconomyView { economy: &self.facts.economy, selected_index: self.selected_measurement, news: &self.news }
    }

    fn choose_level(&mut self, company: &DisplayedCompany, up: bool) {
        let Some(group) = self.group() else { return };
        let now = target_level(company, group, self.target_level);
        let chosen = if up { now.saturating_add(1) } else { now.saturating_sub(1) };
        self.target_level = Some(target_level(company, group, Some(chosen)));
    }
}

impl ScreenState for Market {
    fn selected_group(&self, _: &ScreenContext<'_>) -> Option<Group> {
        self.group()
    }

    fn screen_escape_depth(&self) -> usize {
        usize::from(self.focus == MarketPane::Report)
    }

    fn screen_queries(&self) -> &'static [Reading] {
        &[Reading::Knowledge, Reading::Attempts, Reading::Economy]
    }

    fn apply_rows(&mut self, reading: Reading, rows: &QueryResult, context: &ScreenContext<'_>) {
        self.facts.apply_rows(reading, rows);
        self.rebuild_tables(context.company);
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.rebuild_tables(context.company);
    }

    fn open_object(&self, context: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        let group = self.group().filter(|group| study_level(context.company, *group) > 0)?;
        Some(("study", group.id().to_owned()))
    }

    fn take_answers(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        match self.pending_call.try_take() {
            Some((call, Ok(preview))) => vec![self.confirm_effect(call.tool, call.arguments, &preview, context.company)],
            Some((_, Err(refusal))) => vec![Effect::ShowError(refusal.to_string())],
            None => Vec::new(),
        }
    }

    fn handle_response(&mut self, news: &Response, context: &ScreenContext<'_>) -> Vec<Effect> {
        match news {
            Response::ToolCalled(_, Ok(answer), _) => self.handle_answer(answer, context.company),
            _ => Vec::new(),
        }
    }
}

impl PaneScreen for Market {
    type PaneId = MarketPane;

    fn panes(&self) -> &'static [MarketPane] {
        MarketPane::VARIANTS
    }

    fn pane(name: MarketPane) -> &'static dyn Pane<Market> {
        match name {
            MarketPane::Groups => &groups::KnownGroupsPane,
            MarketPane::Report => &report::ReportPane,
            MarketPane::Attempts => &attempts::AttemptsPane,
            MarketPane::News => &news::CompetitorNewsPane,
            MarketPane::Economy => &economy::EconomyPane,
        }
    }

    fn focused_pane(&self) -> MarketPane {
        self.focus
    }

    fn set_focused_pane(&mut self, name: MarketPane) {
        self.focus = name;
    }

    fn handle_screen_action(&mut self, action: Action, context: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        match action {
            Action::FindGroup => Some(self.check_call(FIND_TOOL, json!({}))),
            // The user must see the selected group before ordering a study.
            Action::StudyGroup if !matches!(self.focus, MarketPane::Groups | MarketPane::Report) => {
                Some(vec![Effect::ShowError("First select the group in the groups pane".to_owned())])
            }
            Action::StudyGroup => Some(self.order_study(context.company)),
            Action::GroupCurve => Some(self.show_curve_effect(context.company)),
            Action::LevelUp | Action::LevelDown => {
                self.choose_level(context.company, action == Action::LevelUp);
                Some(Vec::new())
            }
            _ => None,
        }
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        use MarketPane::{Attempts, Economy, Groups, News, Report};
        if area.width >= 104 && area.height >= 24 {
            return self.draw_wide_layout(canvas, area, context);
        }
        if area.height < 14 {
            return draw_stack(self, &[Groups, Report, Attempts, Economy, News], canvas, area, context);
        }
        let halves = [Constraint::Percentage(50), Constraint::Min(0)];
        let [upper, lower] = Layout::vertical(halves).areas(area);
        draw_pane(self, Groups, canvas, upper, context);
        draw_stack(self, &[Report, Attempts, Economy, News], canvas, lower, context);
    }
}

impl Market {
    fn draw_wide_layout(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let [left, right] = Layout::horizontal([Constraint::Percentage(52), Constraint::Min(0)]).areas(area);
        let rows = (self.groups.len() as u16 + 3).min(area.height / 20 * 11);
        let [groups, economy] = Layout::vertical([Constraint::Length(rows), Constraint::Min(0)]).areas(left);
        let attempts = (self.facts.attempts.len() as u16 + 4).min(area.height / 5).max(6);
        let [report, found, news] = Layout::vertical([
            Constraint::Length(area.height / 20 * 11),
            Constraint::Length(attempts),
            Constraint::Min(0),
        ])
        .areas(right);
        for (pane, place) in [
            (MarketPane::Groups, groups),
            (MarketPane::Economy, economy),
            (MarketPane::Report, report),
            (MarketPane::Attempts, found),
            (MarketPane::News, news),
        ] {
            draw_pane(self, pane, canvas, place, context);
        }
    }
}

fn table_scopes(table: &Table) -> Vec<Scope> {
    if table.is_filter_open() { vec![Scope::Field] } else { vec![Scope::Market, Scope::List] }
}

/// Handles an action in a table. Tab and shift-tab accept the filter text.
fn move_in_table(table: &mut Table, action: Action, context: &ScreenContext<'_>) {
    let action = match action {
        Action::CommitNext | Action::CommitPrevious => Action::Commit,
        other => other,
    };
    table.handle_action(action, context.page_rows);
}

/// Returns a figure for a fact that the player knows about a group.
fn knowledge_figure(group: Group, company: &DisplayedCompany, term: &'static str, what: &str) -> Option<Figure> {
    let what = if study_level(company, group) == 0 { "facts about" } else { what };
    Some(Figure {
        title: format!("{what} {group}"),
        term,
        sql: Some(format!("SELECT * FROM group_info_levels WHERE group_id = '{group}'")),
        week_quantity: None,
    })
}
