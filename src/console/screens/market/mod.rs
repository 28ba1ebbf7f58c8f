//! The market: groups and studies, finding others, the economy, and what the press tells of rivals.

mod draw;
mod economy;
mod figure;
pub mod model;
mod news;
pub mod report;
#[cfg(test)]
mod tests;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;
use serde_json::{Value, json};

use self::model::{Facts, Known, level_of, name_of, study_of, target_of, undiscovered};
use self::news::Item;
use super::{Figure, Look, Screen, ScreenId, ScreenState};
use crate::console::action::{Action, Scope};
use crate::console::canvas::Canvas;
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::message::News;
use crate::console::posts::Posts;
use crate::console::readings::Reading;
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Field, Table};
use crate::notation::{compact, dollars, grouped, percent};
use crate::session::{Preview, Rows};
use crate::tools::ToolId;
use crate::world::identifiers::Group;

/// Panes.
const GROUPS: usize = 0;
const REPORT: usize = 1;
const ATTEMPTS: usize = 2;
const NEWS: usize = 3;
const ECONOMY: usize = 4;
const FIND: ToolId = ToolId::ResearchMarket;
const STUDY: ToolId = ToolId::ResearchGroup;

/// The screen.
#[derive(Default)]
pub struct Market {
    focus: usize,
    facts: Facts,
    /// Groups in the order of the table: the known ones first.
    groups: Vec<Group>,
    table: Table,
    attempts: Table,
    news: Vec<Item>,
    /// Posts from which the news were picked.
    posts: Posts,
    headlines: Table,
    /// Measurement of the economy that is selected; the last one if none.
    point: Option<usize>,
    /// Level that was chosen for the next study.
    target: Option<u8>,
    /// First line of the report that is shown.
    from: usize,
    /// Call that is being looked at before the question.
    asking: Option<(ToolId, Value)>,
}

fn columns() -> Vec<Column> {
    let mut columns = vec![Column::words("group"), Column::words("name").at_most(20)];
    columns.extend(["level", "error"].map(Column::numbers));
    columns.push(Column::words("next study"));
    columns.extend(["found", "studied"].map(Column::numbers));
    columns
}

fn row_of(group: Group, known: Known, company: &Company) -> Vec<Cell> {
    let level = level_of(company, group);
    let none = || Cell::words("–").role(Role::Dim);
    if level == 0 {
        let not_found = Cell::words("not found yet").role(Role::Dim);
        let id = Cell::words(group.id()).role(Role::Dim);
        return vec![id, not_found, none(), none(), none(), none(), none()];
    }
    let day = |day: Option<u32>| match day {
        Some(day) => Cell::number(f64::from(day), format!("day {day}")),
        None => none(),
    };
    let found = match known.found {
        Some(0) if known.studied.is_none() => Cell::number(0.0, "start").role(Role::Dim),
        found => day(found),
    };
    // The table gives the day on which a group was found as that of its last study, too.
    let studied = known.studied.filter(|day| level > 1 || known.found != Some(*day));
    let noise = company.terms.level(level).map_or(0.0, |level| level.noise);
    let next = match study_of(company, group) {
        Some(study) => {
            Cell::words(format!("→{} due day {}", study.target, study.due_day)).role(Role::Warning)
        }
        None => {
            let target = target_of(company, group, None);
            let terms = company.terms.level(target).map_or(String::new(), |level| {
                format!(" ${} {}d ±{}", compact(level.cost), level.days, percent(level.noise, 0))
            });
            Cell::words(format!("→{target}{terms}")).role(Role::Dim)
        }
    };
    vec![
        Cell::words(group.id()).role(Role::Strong),
        Cell::words(name_of(company, group)),
        Cell::number(f64::from(level), level.to_string()),
        Cell::number(noise, format!("±{}", percent(noise, 0))),
        next,
        found,
        day(studied),
    ]
}

impl Market {
    /// Selects a group and shows its report.
    pub fn show(&mut self, group: Group) {
        self.focus = GROUPS;
        // A filter may hide the group.
        self.table.act(Action::Close, 1);
        if let Some(row) = self.groups.iter().position(|own| *own == group) {
            self.table.select(row);
        }
        self.turn();
    }

    /// Another group is selected: its report begins at the top.
    fn turn(&mut self) {
        (self.target, self.from) = (None, 0);
    }

    fn group(&self) -> Option<Group> {
        self.table.selected().and_then(|row| self.groups.get(row)).copied()
    }

    fn refresh(&mut self, company: &Company) {
        let kept = self.group();
        let known = |group: &Group| level_of(company, *group) > 0;
        self.groups = company.seen.known_groups.clone();
        self.groups.extend(Group::all().filter(|group| !known(group)));
        let row =
            |group: &Group| row_of(*group, self.facts.known.get(group).copied().unwrap_or_default(), company);
        self.table.set(columns(), self.groups.iter().map(row).collect());
        if let Some(row) = self.groups.iter().position(|own| Some(*own) == kept) {
            self.table.select(row);
        }
        let attempt = |attempt: &model::Attempt| {
            let found = match attempt.group {
                Some(group) => Cell::words(format!("{group} {}", name_of(company, group))).role(Role::Good),
                None => Cell::words("nothing").role(Role::Dim),
            };
            vec![
                Cell::number(f64::from(attempt.day), attempt.day.to_string()),
                Cell::number(attempt.cost, dollars(attempt.cost)),
                found,
            ]
        };
        let heads = vec![Column::numbers("day"), Column::numbers("cost"), Column::words("found")];
        self.attempts.set(heads, self.facts.attempts.iter().map(attempt).collect());
        if std::sync::Arc::ptr_eq(&self.posts, &company.posts) {
            return;
        }
        self.posts = company.posts.clone();
        self.news = news::of(company);
        let headline = |item: &Item| {
            vec![
                Cell::number(f64::from(item.post.day), item.post.day.to_string()).role(Role::Dim),
                Cell::words(item.rival.as_deref().unwrap_or("economy")).role(match item.rival {
                    Some(_) => Role::Strong,
                    None => Role::Dim,
                }),
                Cell::words(item.post.text.replace('\n', " ")),
            ]
        };
        let heads =
            vec![Column::numbers("day"), Column::words("about"), Column::words("news").at_most(u16::MAX)];
        self.headlines.set(heads, self.news.iter().map(headline).collect());
    }

    fn list(&mut self) -> Option<&mut Table> {
        match self.focus {
            GROUPS => Some(&mut self.table),
            ATTEMPTS => Some(&mut self.attempts),
            NEWS => Some(&mut self.headlines),
            _ => None,
        }
    }

    fn check(&mut self, tool: ToolId, arguments: Value) -> Vec<Effect> {
        self.asking = Some((tool, arguments.clone()));
        vec![Effect::Check { tool, arguments }]
    }

    fn study(&mut self, company: &Company) -> Vec<Effect> {
        match self.group().filter(|group| level_of(company, *group) > 0) {
            Some(group) => {
                let level = target_of(company, group, self.target);
                self.check(STUDY, json!({ "group_id": group.id(), "target_level": level }))
            }
            None => vec![Effect::Complain("only known groups can be studied".to_owned())],
        }
    }

    /// The question before a call that costs money.
    fn ask(&self, tool: ToolId, arguments: Value, preview: &Preview, company: &Company) -> Effect {
        let rest = company.seen.cash - preview.cost_now;
        let what = match tool {
            FIND => format!(
                "A market research attempt has a {} % chance to find one of the {} groups still unknown.",
                grouped(company.terms.attempt_chance * 100.0, 0),
                undiscovered(company)
            ),
            _ => {
                let text = |name: &str| arguments.get(name).map_or(String::new(), Value::to_string);
                let group = text("group_id").replace('"', "");
                let level = text("target_level");
                format!("A study of {group}, to level {level}.")
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

    fn open(&self, company: &Company) -> Vec<Effect> {
        let effect = match self.focus {
            NEWS => {
                let item = self.headlines.selected().and_then(|row| self.news.get(row));
                item.map(|Item { post, .. }| {
                    Effect::ShowText(format!("day {} · press", post.day), post.text.clone())
                })
            }
            ATTEMPTS => None,
            ECONOMY => self.published().map(|point| {
                Effect::ShowText(format!("PMI of day {} · {}", point.day, point.words), point.text.clone())
            }),
            _ => self.group().map(|group| match level_of(company, group) {
                0 => Effect::Complain(format!("{group} is not found yet; nothing is known of it")),
                _ => Effect::ShowGroup(ScreenId::Customers, group),
            }),
        };
        effect.into_iter().collect()
    }

    /// The measurement of the economy that is selected.
    fn published(&self) -> Option<&model::Published> {
        self.economy().selected()
    }

    fn economy(&self) -> economy::View<'_> {
        economy::View { economy: &self.facts.economy, point: self.point, news: &self.news }
    }

    fn choose_point(&mut self, action: Action) {
        let last = self.facts.economy.len().saturating_sub(1);
        let now = self.point.unwrap_or(last).min(last);
        self.point = match action {
            Action::Left | Action::Down | Action::PageDown => Some(now.saturating_sub(1)),
            Action::Right | Action::Up | Action::PageUp => Some((now + 1).min(last)),
            Action::First => Some(0),
            Action::Last | Action::Close => None,
            _ => self.point,
        };
    }

    fn choose_level(&mut self, company: &Company, up: bool) {
        let Some(group) = self.group() else { return };
        let now = target_of(company, group, self.target);
        let chosen = if up { now.saturating_add(1) } else { now.saturating_sub(1) };
        self.target = Some(target_of(company, group, Some(chosen)));
    }

    fn scroll(&mut self, action: Action, look: &Look<'_>) {
        let page = usize::from(look.page.max(1));
        let lines = self.group().map_or(0, |group| report::lines(look.company, group).len());
        let last = lines.saturating_sub(page);
        self.from = match action {
            Action::Up => self.from.min(last).saturating_sub(1),
            Action::Down => (self.from + 1).min(last),
            Action::PageUp => self.from.saturating_sub(page),
            Action::PageDown => (self.from + page).min(last),
            Action::First => 0,
            Action::Last => last,
            Action::Close => {
                self.focus = GROUPS;
                0
            }
            _ => self.from,
        };
    }
}

impl ScreenState for Market {
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

    fn hear(&mut self, news: &News, look: &Look<'_>) -> Vec<Effect> {
        match news {
            News::Checked(_, preview) => match (preview, self.asking.take()) {
                (Ok(preview), Some((tool, arguments))) => {
                    vec![self.ask(tool, arguments, preview, look.company)]
                }
                (Err(refusal), Some(_)) => vec![Effect::Complain(refusal.to_string())],
                _ => Vec::new(),
            },
            News::Called(FIND, Ok(answer), _) => {
                let found = answer.get("discovered_group_id").and_then(Value::as_str).and_then(Group::parse);
                match found {
                    Some(group) => {
                        self.show(group);
                        vec![Effect::Say(format!("{group} was found: {}", name_of(look.company, group)))]
                    }
                    None => {
                        vec![Effect::Say("nothing was found this time; the next may be luckier".to_owned())]
                    }
                }
            }
            News::Called(STUDY, Ok(answer), _) => {
                self.target = None;
                let day = answer.get("expected_completion_day").and_then(Value::as_u64);
                day.map(|day| Effect::Say(format!("the study is due on day {day}"))).into_iter().collect()
            }
            _ => Vec::new(),
        }
    }
}

impl Screen for Market {
    fn scopes(&self) -> Vec<Scope> {
        let typing = match self.focus {
            GROUPS => self.table.is_typing(),
            ATTEMPTS => self.attempts.is_typing(),
            NEWS => self.headlines.is_typing(),
            _ => false,
        };
        if typing { vec![Scope::Field] } else { vec![Scope::Market, Scope::List] }
    }

    fn hints(&self) -> Vec<Action> {
        match self.focus {
            NEWS => vec![Action::Open, Action::Filter, Action::FindGroup],
            ECONOMY => vec![Action::Left, Action::Right, Action::Open, Action::FindGroup],
            ATTEMPTS => vec![Action::FindGroup, Action::Sort, Action::Filter],
            _ => vec![Action::Open, Action::StudyGroup, Action::LevelUp, Action::FindGroup, Action::Filter],
        }
    }

    fn panes(&self) -> usize {
        5
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(ECONOMY);
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        figure::of(self, look.company)
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let before = self.group();
        match action {
            Action::FindGroup => return self.check(FIND, json!({})),
            Action::StudyGroup => return self.study(look.company),
            Action::LevelUp | Action::LevelDown => {
                self.choose_level(look.company, action == Action::LevelUp);
            }
            Action::Open => return self.open(look.company),
            action if self.focus == REPORT => self.scroll(action, look),
            action if self.focus == ECONOMY => self.choose_point(action),
            action => {
                let action = match action {
                    Action::CommitNext | Action::CommitPrevious => Action::Commit,
                    other => other,
                };
                if let Some(list) = self.list() {
                    list.act(action, look.page);
                }
            }
        }
        if before != self.group() {
            self.turn();
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        self.typed(|field| {
            field.key(key);
        });
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        self.typed(|field| field.insert(text));
        Vec::new()
    }

    fn click(&mut self, _: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let group = self.group();
        let Some(list) = self.list() else { return Vec::new() };
        let before = list.selected();
        list.select_place(row);
        let again = before == list.selected();
        if group != self.group() {
            self.turn();
        }
        if again { self.open(look.company) } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        draw::draw(self, canvas, area, look);
    }
}

impl Market {
    fn typed(&mut self, work: impl FnOnce(&mut Field)) {
        let before = self.group();
        if let Some(list) = self.list() {
            list.edit_filter(work);
        }
        if before != self.group() {
            self.turn();
        }
    }
}
