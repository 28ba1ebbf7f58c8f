//! Retention by sign-up week: a triangle of cohorts and weeks since sign-up.

use std::collections::BTreeMap;

use ratatui::layout::Rect;

use super::Customers;
use super::steps::show_rows;
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{compact, percent};
use novamind_database::{Rows, number_at, text_at};
use novamind_session::identifiers::Group;
use novamind_tui::canvas::{Align, Canvas, Click};
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_room;
use novamind_tui::widgets::table::first_row;

const NAMES: u16 = 14;
const CELL: u16 = 5;

pub struct CohortsPane;

impl Pane<Customers> for CohortsPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, look: &Look<'_>) -> Option<Figure> {
        customers.opened.cohort.figure(&customers.cohorts, customers.group(look.company)?)
    }

    fn act(&self, customers: &mut Customers, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let Some(group) = customers.group(look.company) else { return Vec::new() };
        if action == Action::Open {
            return show_rows(self.figure(customers, look));
        }
        customers.opened.cohort.act(action, &customers.cohorts, group, look.company.seen.week);
        Vec::new()
    }

    fn click(&self, customers: &mut Customers, row: usize, _: &Look<'_>) -> Vec<Effect> {
        customers.opened.cohort = CohortPlace { cohort: row / 1000, since: row % 1000 };
        Vec::new()
    }

    fn border(&self, customers: &Customers, area: Rect, look: &Look<'_>) -> Border {
        let title = "Retention, %";
        let week = look.company.seen.week;
        let note = customers
            .group(look.company)
            .map_or(String::new(), |group| customers.cohorts.summary(group, week, note_room(area, title)));
        Border { title: title.to_owned(), note, ..Border::default() }
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let Some(group) = customers.group(look.company) else { return };
        let place = seat.focused.then_some(customers.opened.cohort);
        draw(canvas, seat.area, &customers.cohorts, (group, look.company.seen.week), place, seat.number);
    }
}

/// Subscribers who signed up in the same week.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cohort {
    pub size: f64,
    left: BTreeMap<u32, f64>,
}

impl Cohort {
    /// Returns the share still subscribed at the end of a week.
    pub fn kept(&self, week: u32) -> f64 {
        let gone: f64 = self.left.range(..=week).map(|(_, left)| left).sum();
        if self.size > 0.0 { 1.0 - gone / self.size } else { 0.0 }
    }
}

/// Cohorts by group and sign-up week.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cohorts(BTreeMap<Group, BTreeMap<u32, Cohort>>);

impl Cohorts {
    pub fn of(rows: &Rows) -> Cohorts {
        let mut all = Cohorts::default();
        for row in &rows.rows {
            let Some(group) = Group::parse(text_at(row, 0)) else { continue };
            let (week, left, count) = (number_at(row, 1) as u32, number_at(row, 2) as u32, number_at(row, 3));
            let cohort = all.0.entry(group).or_default().entry(week).or_default();
            cohort.size += count;
            if left > 0 {
                // A cancellation cannot precede the sign-up.
                *cohort.left.entry(left.max(week)).or_default() += count;
            }
        }
        all
    }

    /// Returns the sign-up weeks of a group, newest first.
    fn weeks(&self, group: Group) -> Vec<(u32, &Cohort)> {
        let own = self.0.get(&group).into_iter().flatten();
        let mut weeks: Vec<(u32, &Cohort)> = own.map(|(week, cohort)| (*week, cohort)).collect();
        weeks.reverse();
        weeks
    }

    /// Returns the mean share kept after `since` weeks, over the cohorts that are at least that old.
    fn mean(&self, group: Group, since: u32, now: u32) -> Option<f64> {
        let old = self.weeks(group).into_iter().filter(|(week, _)| week + since <= now);
        let (kept, size) = old.fold((0.0, 0.0), |(kept, size), (week, cohort)| {
            (kept + cohort.kept(week + since) * cohort.size, size + cohort.size)
        });
        (size > 0.0).then(|| kept / size)
    }

    /// Summarizes the triangle in at most `room` columns.
    pub fn summary(&self, group: Group, now: u32, room: usize) -> String {
        let mean = |since| self.mean(group, since, now).map(|kept| (since, kept));
        let told: Vec<String> = [4, 8, 12]
            .into_iter()
            .filter_map(mean)
            .map(|(since, kept)| format!("{} after {since} weeks", percent(kept, 0)))
            .collect();
        let fitting = |count: usize| {
            let words = told[..count].join(", ");
            (words.len() <= room).then_some(words)
        };
        (1..=told.len()).rev().find_map(fitting).unwrap_or_default()
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CohortPlace {
    /// Index of the cohort, newest first.
    pub cohort: usize,
    pub since: usize,
}

impl CohortPlace {
    pub fn act(&mut self, action: Action, cohorts: &Cohorts, group: Group, now: u32) {
        let weeks = cohorts.weeks(group);
        match action {
            Action::Up => self.cohort = self.cohort.saturating_sub(1),
            Action::Down => self.cohort += 1,
            Action::Left => self.since = self.since.saturating_sub(1),
            Action::Right => self.since += 1,
            Action::First => (self.cohort, self.since) = (0, 0),
            Action::Last => self.cohort = usize::MAX,
            _ => {}
        }
        self.cohort = self.cohort.min(weeks.len().saturating_sub(1));
        let most = weeks.get(self.cohort).map_or(0, |(week, _)| now.saturating_sub(*week));
        self.since = self.since.min(most as usize);
    }

    /// Returns the selected share, with a query for the customers who were still subscribed at the end of the
    /// week.
    pub fn figure(self, cohorts: &Cohorts, group: Group) -> Option<Figure> {
        let (week, cohort) = *cohorts.weeks(group).get(self.cohort)?;
        let until = week + self.since as u32;
        let kept = percent(cohort.kept(until), 1);
        let (first, last) = ((7 * week).saturating_sub(6), 7 * week);
        let sql = format!(
            "-- {group}: signed up in week {week}, subscribed at the end of week {until}\n\
             SELECT s.customer_id, s.plan, s.effective_price, s.start_day, s.end_day, s.status\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n    \
             AND s.start_day BETWEEN {first} AND {last}\n    AND s.status IN ('subscribed', 'cancelled')\n    \
             AND (s.status = 'subscribed' OR min(s.end_day, (SELECT max(day) FROM service_day)) > {})",
            7 * until
        );
        let title = format!(
            "{kept} of the {group} customers of week {week} were subscribed at the end of week {until}"
        );
        Some(Figure { title, term: "cohort", sql: Some(sql), why: None })
    }
}

/// Returns the glyph of a share; fuller glyphs mean higher retention.
fn shade(share: f64) -> &'static str {
    match share {
        share if share >= 0.9 => "█",
        share if share >= 0.7 => "▓",
        share if share >= 0.4 => "▒",
        share if share > 0.0 => "░",
        _ => " ",
    }
}

/// Draws the triangle. For clicks, the row is a thousand times the cohort index plus the week.
fn draw(
    canvas: &mut Canvas<'_>,
    area: Rect,
    cohorts: &Cohorts,
    (group, now): (Group, u32),
    place: Option<CohortPlace>,
    pane: usize,
) {
    let weeks = cohorts.weeks(group);
    if weeks.is_empty() {
        canvas.text(area, "No sign-ups in the last 16 weeks", Role::Dim);
        return;
    }
    if area.width < NAMES + CELL || area.height < 3 {
        return;
    }
    let columns = ((area.width - NAMES) / CELL) as usize;
    let oldest = weeks.last().map_or(now, |(week, _)| *week);
    let all = (now.saturating_sub(oldest) + 1) as usize;
    let left = first_row(place.map_or(0, |place| place.since), columns, all);
    let head = Rect { height: 1, ..area };
    canvas.text(Rect { width: NAMES, ..head }, "week   signed", Role::Header);
    let cell_at =
        |row: Rect, at: usize| Rect { x: row.x + NAMES + (at - left) as u16 * CELL, width: CELL, ..row };
    for since in left..all.min(left + columns) {
        let cell = cell_at(head, since);
        canvas.aligned(Rect { width: CELL - 1, ..cell }, &format!("+{since}"), Role::Header, Align::Right);
    }
    // The last row shows the mean of all cohorts.
    let room = (area.height - 2) as usize;
    let from = first_row(place.map_or(0, |place| place.cohort), room, weeks.len());
    let shown = weeks.iter().enumerate().skip(from).take(room);
    let mut y = area.y + 1;
    for (at, (week, cohort)) in shown {
        let row = Rect { y, height: 1, ..area };
        canvas.text(Rect { width: 5, ..row }, &format!("{week:>4}"), Role::Strong);
        let size = Rect { x: row.x + 5, width: NAMES - 6, ..row };
        canvas.aligned(size, &compact(cohort.size), Role::Dim, Align::Right);
        let most = now.saturating_sub(*week) as usize;
        for since in left..(most + 1).min(left + columns) {
            let share = cohort.kept(week + since as u32);
            let here = place == Some(CohortPlace { cohort: at, since });
            let cell = cell_at(row, since);
            draw_cell(canvas, cell, share, here);
            canvas.click(cell, Click::Row(pane, at * 1000 + since));
        }
        y += 1;
    }
    let row = Rect { y, height: 1, ..area };
    canvas.text(Rect { width: NAMES, ..row }, "all", Role::Header);
    for since in left..all.min(left + columns) {
        if let Some(share) = cohorts.mean(group, since as u32, now) {
            let cell = Rect { width: CELL - 1, ..cell_at(row, since) };
            canvas.aligned(cell, &format!("{:.0}", share * 100.0), Role::Strong, Align::Right);
        }
    }
}

fn draw_cell(canvas: &mut Canvas<'_>, cell: Rect, share: f64, here: bool) {
    let role = match share {
        share if share >= 0.7 => Role::Good,
        share if share >= 0.4 => Role::Text,
        _ => Role::Bad,
    };
    let figures = Rect { width: CELL - 1, ..cell };
    let shown = if here { Role::Selection } else { role };
    canvas.aligned(figures, &format!("{:.0}", share * 100.0), shown, Align::Right);
    canvas.text(Rect { x: cell.x + CELL - 1, width: 1, ..cell }, shade(share), role);
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::Cell;

    #[test]
    fn a_cohort_only_shrinks() {
        let row = |week: i64, left: i64, count: i64| {
            vec![Cell::Text("S1".into()), Cell::Integer(week), Cell::Integer(left), Cell::Integer(count)]
        };
        let rows = Rows {
            rows: vec![row(3, 0, 50), row(3, 5, 30), row(3, 7, 20), row(4, 0, 100)],
            ..Rows::default()
        };
        let cohorts = Cohorts::of(&rows);
        let group = Group::parse("S1").expect("a group");
        let weeks = cohorts.weeks(group);
        assert_eq!(weeks.iter().map(|(week, _)| *week).collect::<Vec<_>>(), [4, 3]);
        let old = weeks[1].1;
        assert_eq!([3, 4, 5, 6, 7, 90].map(|week| old.kept(week)), [1.0, 1.0, 0.7, 0.7, 0.5, 0.5]);
        assert_eq!(cohorts.mean(group, 4, 7), Some(0.5), "only cohorts that are old enough count");
        assert_eq!(cohorts.mean(group, 2, 7), Some(0.85));
        assert_eq!(cohorts.mean(group, 9, 7), None);
        let mut place = CohortPlace::default();
        for _ in 0..9 {
            place.act(Action::Right, &cohorts, group, 7);
        }
        assert_eq!(place, CohortPlace { cohort: 0, since: 3 });
        place.act(Action::Last, &cohorts, group, 7);
        assert_eq!(place.cohort, 1);
    }
}
