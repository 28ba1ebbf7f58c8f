//! The company at a glance: cash with the fan of the last forecasts, what needs the person, the week, quality.

pub mod alerts;
mod figures;
mod news;
#[cfg(test)]
mod tests;
mod trends;

use crossterm::event::KeyEvent;
use ratatui::layout::{Constraint, Layout, Rect};
use unicode_width::UnicodeWidthStr;

pub use self::alerts::{Alert, alerts};
use self::figures::METRICS;
use super::product::model::{Day, projects, service};
use super::{Figure, Look, Screen, ScreenId};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Align, Canvas, Click};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::readings::Reading;
use crate::console::text::{arrow, number, short_dollars, wrapped};
use crate::console::theme::Role;
use crate::console::widgets::chart::note_room;
use crate::console::widgets::{Axis, Cell, Column, Line, Table, chart, fan};
use crate::notation::dollars;
use crate::session::Rows;
use crate::world::identifiers::Plan;

/// Panes.
const NEEDS: usize = 0;
const WEEK: usize = 1;
const QUALITY: usize = 2;
const CASH: usize = 3;

/// The screen.
#[derive(Default)]
pub struct Overview {
    focus: usize,
    /// What needs the person, the most urgent first.
    alerts: Vec<Alert>,
    alert: usize,
    week: Table,
    quality: Table,
    days: Vec<Day>,
    /// What the readings say of the last week.
    notices: Vec<Alert>,
    research: Vec<Alert>,
}

impl Overview {
    /// Puts together what needs the person.
    fn rank(&mut self, company: &Company) {
        self.alerts = alerts(company);
        if company.is_running() {
            self.alerts.extend(self.notices.iter().chain(&self.research).cloned());
            self.alerts.extend(news::of_posts(company));
            alerts::sort(&mut self.alerts);
        }
        self.alert = self.alert.min(self.alerts.len().saturating_sub(1));
    }

    fn list(&mut self) -> Option<&mut Table> {
        match self.focus {
            WEEK => Some(&mut self.week),
            QUALITY => Some(&mut self.quality),
            _ => None,
        }
    }

    fn act_on_alerts(&mut self, action: Action) -> Vec<Effect> {
        let last = self.alerts.len().saturating_sub(1);
        match action {
            Action::Up => self.alert = self.alert.saturating_sub(1),
            Action::Down => self.alert = (self.alert + 1).min(last),
            Action::First => self.alert = 0,
            Action::Last => self.alert = last,
            Action::Open => return self.alerts.get(self.alert).map(Alert::way).into_iter().collect(),
            _ => {}
        }
        Vec::new()
    }
}

/// Delivered quality by group and plan.
fn quality_rows(company: &Company) -> (Vec<Column>, Vec<Vec<Cell>>) {
    let tier = |plan: &Plan| number(company.setting("set_model_tiers", plan.id()));
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
        4
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(CASH);
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        let company = look.company;
        match self.focus {
            NEEDS => self.alerts.get(self.alert).map(|alert| alert.figure(company.seen.day)),
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

    fn readings(&self) -> &'static [Reading] {
        &[Reading::Service, Reading::WeekNotices, Reading::Research]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        match reading {
            Reading::Service => self.days = service(rows),
            Reading::WeekNotices => self.notices = news::of_notices(rows),
            _ => self.research = news::of_research(&projects(rows), look.company.seen.day),
        }
        self.rank(look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        let company = look.company;
        self.rank(company);
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

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match (self.focus, action) {
            (NEEDS, action) => return self.act_on_alerts(action),
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
        if pane == NEEDS {
            let again = self.alert == row;
            self.alert = row.min(self.alerts.len().saturating_sub(1));
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
            "usage" | "overload" | "outage" | "latency" | "error-rate" | "issues" => ScreenId::Product,
            _ => ScreenId::Customers,
        });
        screen.map(Effect::Show).into_iter().collect()
    }

    fn draw_pane(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, pane: usize) {
        match pane {
            NEEDS => self.draw_alerts(canvas, area),
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
        let needs = self.needs_height(right.width, right.height / 3);
        let table = (METRICS.len() as u16 + 3).min(right.height.saturating_sub(needs));
        let charts = trends::height(right.height.saturating_sub(needs + table));
        let [above, week, small] =
            Layout::vertical([Constraint::Length(needs), Constraint::Min(6), Constraint::Length(charts)])
                .areas(right);
        self.draw_alerts(canvas, above);
        self.draw_week(canvas, week, look);
        trends::draw(canvas, small, look.company);
    }

    fn draw_small(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let needs = self.needs_height(area.width, area.height * 2 / 5);
        let [above, below] = Layout::vertical([Constraint::Length(needs), Constraint::Min(0)]).areas(area);
        self.draw_alerts(canvas, above);
        // Name, figure and change of the week, with what the names need.
        let left = 48.min(area.width * 3 / 5);
        let [week, side] = Layout::horizontal([Constraint::Length(left), Constraint::Min(0)]).areas(below);
        self.draw_week(canvas, week, look);
        match self.focus {
            QUALITY => self.draw_quality(canvas, side, look),
            _ => self.draw_cash(canvas, side, look.company),
        }
    }

    /// Height of the alerts with their border, at most so much.
    fn needs_height(&self, width: u16, most: u16) -> u16 {
        let room = width.saturating_sub(2);
        let lines: usize = self.alerts.iter().map(|alert| lines_of(alert, room).len()).sum();
        (lines.max(1) as u16 + 2).min(most.max(4))
    }

    fn draw_alerts(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let focused = self.focus == NEEDS;
        canvas.click(area, Click::Pane(NEEDS));
        let urgent = self.alerts.iter().filter(|alert| alert.urgent).count();
        let note =
            if urgent > 0 { format!("{urgent} now · {} in all", self.alerts.len()) } else { String::new() };
        let inside = canvas.pane(area, "Needs you", &note, focused);
        if self.alerts.is_empty() {
            canvas.text(inside, "nothing: n lets the week pass", Role::Dim);
        }
        let all: Vec<Vec<String>> = self.alerts.iter().map(|alert| lines_of(alert, inside.width)).collect();
        // The first alert that is shown, so that the selected one is seen whole.
        let mut from = 0;
        let height = |from: usize| all[from..=self.alert].iter().map(Vec::len).sum::<usize>();
        while from < self.alert && height(from) > inside.height as usize {
            from += 1;
        }
        let mut y = inside.y;
        for (at, lines) in all.iter().enumerate().skip(from) {
            if y >= inside.bottom() {
                break;
            }
            let alert = &self.alerts[at];
            let place = Rect { y, height: lines.len() as u16, ..inside }.intersection(inside);
            draw_alert(canvas, place, alert, lines, focused && at == self.alert);
            canvas.click(place, Click::Row(NEEDS, at));
            y += lines.len() as u16;
        }
    }

    fn draw_week(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(WEEK));
        let focused = self.focus == WEEK;
        let note = match self.week.note() {
            note if note.is_empty() => match &look.company.seen.last_week {
                Some(week) => format!("week {} · to day {}", look.company.seen.week, week.day),
                None => "no week has passed".to_owned(),
            },
            note => note,
        };
        let inside = canvas.pane(area, "This week", &note, focused);
        self.week.draw(canvas, inside, focused, WEEK);
    }

    fn draw_quality(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let (base, shared) = look.company.quality_base;
        let title = "Delivered quality";
        let full = format!("base {base:.2} · for everybody {shared:+.4}");
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
                chart(canvas, inside, &lines, &x, &Axis { write: &short_dollars, holds: &[] });
            }
        }
    }
}

/// Columns that the screen of an alert takes at the right.
fn way_of(alert: &Alert) -> String {
    format!("→ {}", alert.at().action().entry().title)
}

/// The words of an alert in lines: whole, beside the name of its screen in the first one.
fn lines_of(alert: &Alert, width: u16) -> Vec<String> {
    let room = (width as usize).saturating_sub(way_of(alert).width() + 4);
    wrapped(&alert.text, room.max(12))
}

fn draw_alert(canvas: &mut Canvas<'_>, area: Rect, alert: &Alert, lines: &[String], selected: bool) {
    let role = match (selected, alert.urgent) {
        (true, _) => Role::Selection,
        (false, true) => Role::Warning,
        (false, false) => Role::Text,
    };
    canvas.clear(area, if selected { role } else { Role::Text });
    for (at, (line, y)) in lines.iter().zip(area.top()..area.bottom()).enumerate() {
        let mark = match (at, alert.urgent) {
            (0, true) => "!",
            (0, false) => "·",
            _ => " ",
        };
        canvas.text(Rect { y, height: 1, ..area }, &format!("{mark} {line}"), role);
    }
    let way = if selected { role } else { Role::Dim };
    canvas.aligned(Rect { height: area.height.min(1), ..area }, &way_of(alert), way, Align::Right);
}
