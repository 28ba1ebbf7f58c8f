//! The market: groups and studies, market research, the economy, and press reports about competitors.

mod attempts;
mod economy;
mod groups;
mod hidden;
pub mod model;
mod news;
pub mod report;
#[cfg(test)]
mod tests;

use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::{Value, json};
use strum::VariantArray;

use self::model::{MarketFacts, level_of, name_of, target_of, undiscovered};
use self::news::RivalNews;
use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look, ScreenId};
use crate::effect::Effect;
use novamind_base::notation::{dollars, grouped};
use novamind_database::Rows;
use novamind_session::Preview;
use novamind_session::identifiers::Group;
use novamind_tools::{Answer, DiscoveryAttempt, ToolId};
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Table;
use novamind_worker::asking::Pending;
use novamind_worker::company::Company;
use novamind_worker::message::News;
use novamind_worker::posts::Posts;
use novamind_worker::questions::CallCheck;
use novamind_worker::readings::Reading;

/// Panes in tab order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, VariantArray)]
pub enum MarketPane {
    /// Table of the groups.
    #[default]
    Groups,
    /// Estimates of the selected group's study.
    Report,
    /// Market research attempts.
    Attempts,
    /// News of the press.
    News,
    /// The index of the economy.
    Economy,
}

const FIND: ToolId = ToolId::ResearchMarket;
const STUDY: ToolId = ToolId::ResearchGroup;

/// Footer actions for a selected group.
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
    news: Vec<RivalNews>,
    posts: Posts,
    headlines: Table,
    /// Index of the selected measurement of the economy; `None` for the last one.
    point: Option<usize>,
    /// Chosen level of the next study.
    target: Option<u8>,
    from: usize,
    /// Check of the tool call before the user confirms it.
    asking: Pending<CallCheck>,
}

impl Market {
    /// Selects a group and shows its report.
    pub fn show(&mut self, group: Group) {
        self.focus = MarketPane::Groups;
        // A filter could hide the group.
        self.table.act(Action::Close, 1);
        if let Some(row) = self.groups.iter().position(|own| *own == group) {
            self.table.select(row);
        }
        self.turn();
    }

    fn answered(&mut self, answer: &Answer, company: &Company) -> Vec<Effect> {
        match answer {
            Answer::ResearchMarket(DiscoveryAttempt::Found { discovered_group_id: group }) => {
                self.show(*group);
                vec![Effect::Say(format!("Found {group}: {}", name_of(company, *group)))]
            }
            Answer::ResearchMarket(DiscoveryAttempt::Nothing { .. }) => {
                vec![Effect::Say("No group found this time".to_owned())]
            }
            Answer::ResearchGroup(study) => {
                self.target = None;
                vec![Effect::Say(format!("The study is due on day {}", study.expected_completion_day))]
            }
            _ => Vec::new(),
        }
    }

    /// Resets the report after a change of the selected group.
    fn turn(&mut self) {
        (self.target, self.from) = (None, 0);
    }

    /// Resets the report if the selected group has changed.
    fn turn_from(&mut self, before: Option<Group>) {
        if before != self.group() {
            self.turn();
        }
    }

    /// Opens the customers screen with the selected group.
    fn show_customers(&self, company: &Company) -> Vec<Effect> {
        let effect = self.group().map(|group| match level_of(company, group) {
            0 => Effect::Complain(format!("{group} has not been found yet")),
            _ => Effect::ShowGroup(ScreenId::Customers, group),
        });
        effect.into_iter().collect()
    }

    /// Opens the participation curve of the selected group.
    fn show_curve(&self, company: &Company) -> Vec<Effect> {
        let effect = self.group().map(|group| match level_of(company, group) {
            0 => Effect::Complain(format!("{group} has not been found yet")),
            _ => Effect::ShowCurve(Some(group)),
        });
        effect.into_iter().collect()
    }

    fn group(&self) -> Option<Group> {
        self.table.selected().and_then(|row| self.groups.get(row)).copied()
    }

    fn refresh(&mut self, company: &Company) {
        let kept = self.group();
        let known = |group: &Group| level_of(company, *group) > 0;
        self.groups = company.seen.known_groups.clone();
        self.groups.extend(Group::all().filter(|group| !known(group)));
        let known = |group: &Group| self.facts.known.get(group).copied().unwrap_or_default();
        let rows = self.groups.iter().map(|group| groups::row_of(*group, known(group), company)).collect();
        self.table.set(groups::columns(), rows);
        if let Some(row) = self.groups.iter().position(|own| Some(*own) == kept) {
            self.table.select(row);
        }
        let tried = self.facts.attempts.iter().map(|attempt| attempts::row_of(attempt, company)).collect();
        self.attempts.set(attempts::columns(), tried);
        if std::sync::Arc::ptr_eq(&self.posts, &company.posts) {
            return;
        }
        self.posts = company.posts.clone();
        self.news = news::of(company);
        self.headlines.set(news::columns(), self.news.iter().map(news::row_of).collect());
    }

    fn check(&mut self, tool: ToolId, arguments: Value) -> Vec<Effect> {
        vec![Effect::Ask(self.asking.ask(CallCheck { tool, arguments }))]
    }

    fn study(&mut self, company: &Company) -> Vec<Effect> {
        match self.group().filter(|group| level_of(company, *group) > 0) {
            Some(group) => {
                let level = target_of(company, group, self.target);
                self.check(STUDY, json!({ "group_id": group.id(), "target_level": level }))
            }
            None => vec![Effect::Complain("Only known groups can be studied".to_owned())],
        }
    }

    /// Returns the confirmation of a tool call that costs money.
    fn ask(&self, tool: ToolId, arguments: Value, preview: &Preview, company: &Company) -> Effect {
        let rest = company.seen.cash - preview.cost_now;
        let what = match tool {
            FIND => format!(
                "A market research attempt has a {} % chance to find one of the {} groups not found yet.",
                grouped(company.terms.attempt_chance * 100.0, 0),
                undiscovered(company)
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

    fn economy(&self) -> economy::EconomyView<'_> {
        economy::EconomyView { economy: &self.facts.economy, point: self.point, news: &self.news }
    }

    fn choose_level(&mut self, company: &Company, up: bool) {
        let Some(group) = self.group() else { return };
        let now = target_of(company, group, self.target);
        let chosen = if up { now.saturating_add(1) } else { now.saturating_sub(1) };
        self.target = Some(target_of(company, group, Some(chosen)));
    }
}

impl ScreenState for Market {
    fn opened(&self) -> usize {
        usize::from(self.focus == MarketPane::Report)
    }

    fn readings(&self) -> &'static [Reading] {
        &[Reading::Knowledge, Reading::Attempts, Reading::Economy]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        self.facts.take(reading, rows);
        self.refresh(look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.refresh(look.company);
    }

    fn open_object(&self, look: &Look<'_>) -> Option<(&'static str, String)> {
        let group = self.group().filter(|group| level_of(look.company, *group) > 0)?;
        Some(("study", group.id().to_owned()))
    }

    fn take_answers(&mut self, look: &Look<'_>) -> Vec<Effect> {
        match self.asking.try_take() {
            Some((call, Ok(preview))) => vec![self.ask(call.tool, call.arguments, &preview, look.company)],
            Some((_, Err(refusal))) => vec![Effect::Complain(refusal.to_string())],
            None => Vec::new(),
        }
    }

    fn hear(&mut self, news: &News, look: &Look<'_>) -> Vec<Effect> {
        match news {
            News::Called(_, Ok(answer), _) => self.answered(answer, look.company),
            _ => Vec::new(),
        }
    }
}

impl Paned for Market {
    type Name = MarketPane;

    fn panes(&self) -> &'static [MarketPane] {
        MarketPane::VARIANTS
    }

    fn pane(name: MarketPane) -> &'static dyn Pane<Market> {
        match name {
            MarketPane::Groups => &groups::KnownGroupsPane,
            MarketPane::Report => &report::ReportPane,
            MarketPane::Attempts => &attempts::AttemptsPane,
            MarketPane::News => &news::RivalNewsPane,
            MarketPane::Economy => &economy::EconomyPane,
        }
    }

    fn focused(&self) -> MarketPane {
        self.focus
    }

    fn focus_on(&mut self, name: MarketPane) {
        self.focus = name;
    }

    fn act_anywhere(&mut self, action: Action, look: &Look<'_>) -> Option<Vec<Effect>> {
        match action {
            Action::FindGroup => Some(self.check(FIND, json!({}))),
            // The user must see which group is selected.
            Action::StudyGroup if !matches!(self.focus, MarketPane::Groups | MarketPane::Report) => {
                Some(vec![Effect::Complain("First select the group in the groups pane".to_owned())])
            }
            Action::StudyGroup => Some(self.study(look.company)),
            Action::GroupCurve => Some(self.show_curve(look.company)),
            Action::LevelUp | Action::LevelDown => {
                self.choose_level(look.company, action == Action::LevelUp);
                Some(Vec::new())
            }
            _ => None,
        }
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        use MarketPane::{Attempts, Economy, Groups, Report};
        if area.width >= 104 && area.height >= 24 {
            return self.arrange_all(canvas, area, look);
        }
        // The focused pane takes the window. Groups and report share it, as do attempts and economy.
        let halves = [Constraint::Percentage(50), Constraint::Min(0)];
        let [upper, lower] = Layout::vertical(halves).areas(area);
        let (above, below) = match self.focus {
            Groups if area.height >= 14 => (Groups, Report),
            Attempts => (Attempts, Economy),
            alone => return draw_pane(self, alone, canvas, area, look),
        };
        draw_pane(self, above, canvas, upper, look);
        draw_pane(self, below, canvas, lower, look);
    }
}

impl Market {
    fn arrange_all(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
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
            draw_pane(self, pane, canvas, place, look);
        }
    }
}

fn scopes(table: &Table) -> Vec<Scope> {
    if table.is_typing() { vec![Scope::Field] } else { vec![Scope::Market, Scope::List] }
}

/// Moves in a table; tab ends typing.
fn walk(table: &mut Table, action: Action, look: &Look<'_>) {
    let action = match action {
        Action::CommitNext | Action::CommitPrevious => Action::Commit,
        other => other,
    };
    table.act(action, look.page);
}

/// Returns the figure of a study value of a group.
fn knowledge_of(group: Group, company: &Company, term: &'static str, what: &str) -> Option<Figure> {
    let what = if level_of(company, group) == 0 { "facts about" } else { what };
    Some(Figure {
        title: format!("{what} {group}"),
        term,
        sql: Some(format!("SELECT * FROM group_info_levels WHERE group_id = '{group}'")),
        why: None,
    })
}
