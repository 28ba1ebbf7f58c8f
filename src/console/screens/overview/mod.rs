//! The company at a glance: cash with the fan of the last forecasts, what needs the person, the week, quality, news.

mod figures;
pub mod needs;
mod news;
#[cfg(test)]
mod tests;
mod trends;

use crossterm::event::KeyEvent;
use ratatui::layout::{Constraint, Layout, Rect};
use unicode_width::UnicodeWidthStr;

use self::figures::METRICS;
use self::news::Item;
use super::product::model::{Day, projects, service};
use super::{Figure, Look, Screen, ScreenId, ScreenState};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Align, Canvas, Click, fit};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::readings::Reading;
use crate::console::text::{arrow, number, short_dollars, wrapped};
use crate::console::theme::Role;
use crate::console::widgets::chart::note_room;
use crate::console::widgets::{Axis, Cell, Column, Line, Side, Table, Unit, chart, fan};
use crate::notation::dollars;
use crate::report::needs::Need;
use crate::session::Rows;
use crate::tools::ToolId;
use crate::world::identifiers::Plan;

/// Panes.
const NEEDS: usize = 0;
const WEEK: usize = 1;
const QUALITY: usize = 2;
const CASH: usize = 3;
const NEWS: usize = 4;

/// The screen.
#[derive(Default)]
pub struct Overview {
    focus: usize,
    /// The need that is selected.
    need: usize,
    week: Table,
    quality: Table,
    days: Vec<Day>,
    /// What is new: the readings tell a part of it.
    notices: Vec<Item>,
    research: Vec<Item>,
    news: Vec<Item>,
    /// The item that is selected.
    item: usize,
}

impl Overview {
    /// Puts together what is new.
    fn gather(&mut self, company: &Company) {
        self.news = self.research.iter().chain(&self.notices).cloned().collect();
        self.news.extend(news::of_posts(company));
        self.news.sort_by_key(|item| item.kind);
        self.item = self.item.min(self.news.len().saturating_sub(1));
    }

    fn list(&mut self) -> Option<&mut Table> {
        match self.focus {
            WEEK => Some(&mut self.week),
            QUALITY => Some(&mut self.quality),
            _ => None,
        }
    }

    fn act_on_needs(&mut self, action: Action, company: &Company) -> Vec<Effect> {
        if action == Action::Open {
            return company.needs.get(self.need).map(needs::way_of).into_iter().collect();
        }
        walk(&mut self.need, company.needs.len(), action);
        Vec::new()
    }

    fn act_on_news(&mut self, action: Action) -> Vec<Effect> {
        if action == Action::Open {
            return self.news.get(self.item).map(Item::way).into_iter().collect();
        }
        walk(&mut self.item, self.news.len(), action);
        Vec::new()
    }
}

/// Moves a selection among rows.
fn walk(selected: &mut usize, rows: usize, action: Action) {
    let last = rows.saturating_sub(1);
    *selected = match action {
        Action::Up => selected.saturating_sub(1),
        Action::Down => (*selected + 1).min(last),
        Action::First => 0,
        Action::Last => last,
        _ => *selected,
    };
}

/// Delivered quality by group and plan.
fn quality_rows(company: &Company) -> (Vec<Column>, Vec<Vec<Cell>>) {
    let tier = |plan: &Plan| number(company.setting(ToolId::SetModelTiers, plan.id()));
    let plans = Plan::ALL.iter().map(|plan| Column::numbers(format!("{plan} tier {}", tier(plan))));
    let columns = [Column::words("group")].into_iter().chain(plans).chain([Column::numbers("group's own")]);
    let row = |quality: &crate::session::DeliveredQuality| {
        let bonus = match quality.group_bonus {
            bonus if bonus > 0.0 => Cell::number(bonus, format!("+{bonus:.4}")),
            _ => Cell::number(0.0, "–").role(Role::Dim),
        };
        let plans = quality.by_plan.0.map(|value| Cell::number(value, format!("{value:.4}")));
        [Cell::words(quality.group.id()).role(Role::Strong)].into_iter().chain(plans).chain([bonus]).collect()
    };
    (columns.collect(), company.quality.iter().map(row).collect())
}

impl ScreenState for Overview {
    fn readings(&self) -> &'static [Reading] {
        &[Reading::Service, Reading::WeekNotices, Reading::Research]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        match reading {
            Reading::Service => self.days = service(rows),
            Reading::WeekNotices => self.notices = news::of_notices(rows),
            _ => self.research = news::of_research(&projects(rows), look.company.seen.day),
        }
        self.gather(look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        let company = look.company;
        self.gather(company);
        self.need = self.need.min(company.needs.len().saturating_sub(1));
        let rows = METRICS.iter().map(|metric| figures::row_of(metric, company)).collect();
        let first = self.week.rows().is_empty();
        if first {
            self.week = Table::default().by_cell();
            self.quality = Table::default().by_cell();
        }
        self.week.set(figures::columns(), rows);
        let (columns, rows) = quality_rows(company);
        self.quality.set(columns, rows);
        if first {
            self.week.act(Action::Right, 1);
            self.quality.act(Action::Right, 1);
        }
    }
}

impl Screen for Overview {
    fn scopes(&self) -> Vec<Scope> {
        let typing = match self.focus {
            WEEK => self.week.is_typing(),
            QUALITY => self.quality.is_typing(),
            _ => false,
        };
        if typing { vec![Scope::Field, Scope::List] } else { vec![Scope::List] }
    }

    fn hints(&self) -> Vec<Action> {
        match self.focus {
            WEEK | QUALITY => vec![Action::Rows, Action::Sort, Action::Open],
            _ => vec![Action::Open],
        }
    }

    fn panes(&self) -> usize {
        5
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(NEWS);
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        let company = look.company;
        match self.focus {
            NEEDS => company.needs.get(self.need).map(|need| needs::figure_of(need, company.seen.day)),
            NEWS => self.news.get(self.item).map(|item| item.figure(company.seen.day)),
            WEEK => {
                let metric = METRICS.get(self.week.selected()?)?;
                Some(figures::figure(metric, self.week.selected_column(), company))
            }
            QUALITY => {
                let group = company.quality.get(self.quality.selected()?)?.group;
                let column = self.quality.selected_column();
                let of = match column.checked_sub(1).and_then(|at| Plan::ALL.get(at)) {
                    Some(plan) => format!("on plan {plan}"),
                    None => "from targeted development".to_owned(),
                };
                let title = format!("delivered quality of {group} {of}");
                Some(Figure { title, term: "delivered-quality", sql: None })
            }
            _ => Some(figures::figure(&METRICS[0], 0, company)),
        }
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match (self.focus, action) {
            (NEEDS, action) => return self.act_on_needs(action, look.company),
            (NEWS, action) => return self.act_on_news(action),
            (WEEK, Action::Open) => return self.follow_metric(),
            (QUALITY, Action::Open) => return vec![Effect::Show(ScreenId::Product)],
            (CASH, Action::Open) => return vec![Effect::Show(ScreenId::Cash)],
            (_, action) => {
                if let Some(table) = self.list() {
                    table.act(action, look.page);
                }
            }
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        if let Some(table) = self.list() {
            table.edit_filter(|field| {
                field.key(key);
            });
        }
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if let Some(table) = self.list() {
            table.edit_filter(|field| field.insert(text));
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        self.set_focus(pane);
        let rows = match pane {
            NEEDS => Some((&mut self.need, look.company.needs.len())),
            NEWS => Some((&mut self.item, self.news.len())),
            _ => None,
        };
        if let Some((selected, count)) = rows {
            let again = *selected == row;
            *selected = row.min(count.saturating_sub(1));
            return if again { self.act(Action::Open, look) } else { Vec::new() };
        }
        let Some(table) = self.list() else { return Vec::new() };
        let before = table.selected();
        table.select_place(row);
        if before == table.selected() { self.act(Action::Open, look) } else { Vec::new() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if canvas.zoomed {
            return self.draw_pane(canvas, area, look, self.focus);
        }
        if area.width >= 104 {
            self.draw_wide(canvas, area, look);
        } else {
            self.draw_small(canvas, area, look);
        }
    }
}

impl Overview {
    /// The screen that shows more of a figure.
    fn follow_metric(&self) -> Vec<Effect> {
        let metric = self.week.selected().and_then(|row| METRICS.get(row));
        let screen = metric.map(|metric| match metric.term {
            "cash" | "payments" | "running-costs" => ScreenId::Cash,
            "thread" | "seats" => ScreenId::Inbox,
            "usage" | "overload" | "outage" | "latency" | "error-rate" | "issue" => ScreenId::Product,
            _ => ScreenId::Customers,
        });
        screen.map(Effect::Show).into_iter().collect()
    }

    fn draw_pane(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, pane: usize) {
        match pane {
            NEEDS => self.draw_needs(canvas, area, look.company),
            NEWS => self.draw_news(canvas, area),
            WEEK => self.draw_week(canvas, area, look),
            QUALITY => self.draw_quality(canvas, area, look),
            _ => self.draw_cash(canvas, area, look.company),
        }
    }

    fn draw_wide(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let [left, right] = Layout::horizontal([Constraint::Percentage(50), Constraint::Min(0)]).areas(area);
        let quality = (self.quality.rows().len() as u16 + 3).min(left.height / 2);
        // Usage has a chart of its own where cash keeps a good one.
        let usage = if left.height >= quality + 26 { (left.height - quality) * 2 / 5 } else { 0 };
        let [cash, used, below] =
            Layout::vertical([Constraint::Min(8), Constraint::Length(usage), Constraint::Length(quality)])
                .areas(left);
        self.draw_cash(canvas, cash, look.company);
        if usage > 0 {
            trends::draw_usage(canvas, used, &self.days);
        }
        self.draw_quality(canvas, below, look);
        let needs = needs_height(look.company, right.width, right.height / 3);
        let table = (METRICS.len() as u16 + 3).min(right.height.saturating_sub(needs));
        let left = right.height.saturating_sub(needs + table);
        let news = if left >= 3 { (self.news.len().max(1) as u16 + 2).min(left) } else { 0 };
        let charts = trends::height(left - news);
        let [above, new, week, small] = Layout::vertical([
            Constraint::Length(needs),
            Constraint::Length(news),
            Constraint::Min(6),
            Constraint::Length(charts),
        ])
        .areas(right);
        self.draw_needs(canvas, above, look.company);
        if news > 0 {
            self.draw_news(canvas, new);
        }
        self.draw_week(canvas, week, look);
        trends::draw(canvas, small, look.company);
    }

    fn draw_small(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let needs = needs_height(look.company, area.width, area.height * 2 / 5);
        let [above, below] = Layout::vertical([Constraint::Length(needs), Constraint::Min(0)]).areas(area);
        self.draw_needs(canvas, above, look.company);
        // Name, figure and change of the week, with what the names need.
        let left = 48.min(area.width * 3 / 5);
        let [week, side] = Layout::horizontal([Constraint::Length(left), Constraint::Min(0)]).areas(below);
        self.draw_week(canvas, week, look);
        match self.focus {
            QUALITY => self.draw_quality(canvas, side, look),
            NEWS => self.draw_news(canvas, side),
            _ => self.draw_cash(canvas, side, look.company),
        }
    }

    fn draw_needs(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        let focused = self.focus == NEEDS;
        canvas.click(area, Click::Pane(NEEDS));
        let needs = &company.needs;
        let urgent = needs.iter().filter(|need| need.urgent).count();
        let note = if urgent > 0 { format!("{urgent} now · {} in all", needs.len()) } else { String::new() };
        let inside = canvas.pane(area, "Needs you", &note, focused);
        if needs.is_empty() {
            let text = match company.seen.ended {
                Some(_) => "the run is over; you can still read and query",
                None => "nothing: n starts the next week",
            };
            canvas.text(inside, text, Role::Dim);
        }
        let rows: Vec<Row> = needs.iter().map(Row::of_need).collect();
        draw_rows(canvas, inside, &rows, self.need, focused, NEEDS);
    }

    fn draw_news(&self, canvas: &mut Canvas<'_>, area: Rect) {
        canvas.click(area, Click::Pane(NEWS));
        let focused = self.focus == NEWS;
        let inside = canvas.pane(area, "New this week", "", focused);
        if self.news.is_empty() {
            canvas.text(inside, "nothing", Role::Dim);
        }
        let rows: Vec<Row> = self.news.iter().map(Row::of_item).collect();
        draw_rows(canvas, inside, &rows, self.item, focused, NEWS);
    }

    fn draw_week(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(WEEK));
        let focused = self.focus == WEEK;
        let note = match self.week.note() {
            note if note.is_empty() => match &look.company.seen.last_week {
                Some(week) => format!("week {} · to day {}", look.company.seen.week, week.day),
                None => "no week yet".to_owned(),
            },
            note => note,
        };
        let inside = canvas.pane(area, "This week", &note, focused);
        self.week.draw(canvas, inside, focused, WEEK);
    }

    fn draw_quality(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let (base, shared) = look.company.quality_base;
        let title = "Delivered quality";
        let full = format!("base {base:.2} · general {shared:+.4}");
        let note = if full.width() <= note_room(area, title) { full } else { String::new() };
        canvas.click(area, Click::Pane(QUALITY));
        let focused = self.focus == QUALITY;
        let inside = canvas.pane(area, title, &note, focused);
        self.quality.draw(canvas, inside, focused, QUALITY);
    }

    fn draw_cash(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        canvas.click(area, Click::Pane(CASH));
        let change = company.seen.cash_change;
        let moved = format!("{} {}", dollars(company.seen.cash), arrow(change, &short_dollars(change.abs())));
        let forecasts = company.last_forecasts();
        let full = match forecasts {
            Some((day, _)) => format!("{moved} in a week · forecast of day {day}"),
            None => moved.clone(),
        };
        let room = note_room(area, "Cash");
        let note = if full.width() <= room { full } else { moved };
        let inside = canvas.pane(area, "Cash", &note, self.focus == CASH);
        match forecasts {
            Some((filed, forecasts)) => {
                fan::draw_fan(canvas, inside, company, filed, &fan::near(company, forecasts));
            }
            None => {
                let lines = [Line::of(&company.cash_by_day, Role::Series(0))];
                let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[] };
                chart(canvas, inside, &lines, &x, &Side { unit: Unit::Dollars, holds: &[] });
            }
        }
    }
}

/// A row of words that leads to a screen.
struct Row {
    text: String,
    urgent: bool,
    way: String,
}

impl Row {
    fn of_need(need: &Need) -> Row {
        Row { text: need.in_words(), urgent: need.urgent, way: Row::way(needs::screen_of(need)) }
    }

    fn of_item(item: &Item) -> Row {
        Row { text: item.text.clone(), urgent: false, way: Row::way(item.screen()) }
    }

    fn way(screen: ScreenId) -> String {
        format!("→ {}", screen.action().entry().title)
    }

    /// The words in lines: whole, beside the name of the screen in the first one.
    fn lines(&self, width: u16) -> Vec<String> {
        let room = (width as usize).saturating_sub(self.way.width() + 4);
        wrapped(&self.text, room.max(12))
    }
}

/// Height of the needs with their border, at most so much.
fn needs_height(company: &Company, width: u16, most: u16) -> u16 {
    let room = width.saturating_sub(2);
    let lines: usize = company.needs.iter().map(|need| Row::of_need(need).lines(room).len()).sum();
    (lines.max(1) as u16 + 2).min(most.max(4))
}

/// Draws rows from the first on with which the selected one is seen whole.
fn draw_rows(canvas: &mut Canvas<'_>, area: Rect, rows: &[Row], selected: usize, focused: bool, pane: usize) {
    let all: Vec<Vec<String>> = rows.iter().map(|row| row.lines(area.width)).collect();
    let mut from = 0;
    let height = |from: usize| all[from..].iter().take(selected + 1 - from).map(Vec::len).sum::<usize>();
    while from < selected && height(from) > area.height as usize {
        from += 1;
    }
    let mut y = area.y;
    for (at, lines) in all.iter().enumerate().skip(from) {
        if y >= area.bottom() {
            break;
        }
        let place = Rect { y, height: lines.len() as u16, ..area }.intersection(area);
        draw_row(canvas, place, &rows[at], lines, focused && at == selected);
        canvas.click(place, Click::Row(pane, at));
        y += lines.len() as u16;
    }
}

fn draw_row(canvas: &mut Canvas<'_>, area: Rect, row: &Row, lines: &[String], selected: bool) {
    let role = match (selected, row.urgent) {
        (true, _) => Role::Selection,
        (false, true) => Role::Warning,
        (false, false) => Role::Text,
    };
    canvas.clear(area, if selected { role } else { Role::Text });
    for (at, (line, y)) in lines.iter().zip(area.top()..area.bottom()).enumerate() {
        let mark = match (at, row.urgent) {
            (0, true) => "!",
            (0, false) => "·",
            _ => " ",
        };
        let more = lines.get(at + 1).filter(|_| y + 1 == area.bottom());
        let way = if at == 0 { row.way.width() + 1 } else { 0 };
        let room = (area.width as usize).saturating_sub(2 + way);
        let shown = more.map_or_else(|| line.clone(), |more| fit(&format!("{line} {more}"), room));
        canvas.text(Rect { y, height: 1, ..area }, &format!("{mark} {shown}"), role);
    }
    let way = if selected { role } else { Role::Dim };
    canvas.aligned(Rect { height: area.height.min(1), ..area }, &row.way, way, Align::Right);
}
