//! Cash by day with the selected week, and the change by week.

use ratatui::layout::{Constraint, Layout, Rect};

use super::model::{Subject, cash_around, days_of};
use super::{Cash, Selected, ledger_rows, week_keys};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{dollars, short_dollars};
use novamind_tui::canvas::{Align, Canvas};
use novamind_tui::text::arrow;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{note_room, summary, zero_if_near};
use novamind_tui::widgets::{Axis, Line, Plot, Side, Unit};
use novamind_worker::company::Company;

const SIDE: u16 = 8;

pub struct CurvePane;

impl Pane<Cash> for CurvePane {
    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Left, Action::Right, Action::Open]
    }

    fn figure(&self, cash: &Cash, _: &Look<'_>) -> Option<Figure> {
        cash.figure_of(net(cash))
    }

    fn act(&self, cash: &mut Cash, action: Action, _: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return ledger_rows(net(cash));
        }
        cash.walk_weeks(action);
        Vec::new()
    }

    fn border(&self, cash: &Cash, area: Rect, look: &Look<'_>) -> Border {
        let (title, company, week) = ("Cash", look.company, cash.week());
        let note = match cash_around(company, week) {
            Some((before, after)) => {
                let change = after - before;
                format!("week {week}: {} {}", dollars(after), arrow(change, &dollars(change.abs())))
            }
            None => summary(&company.cash_by_day, &short_dollars, note_room(area, title)),
        };
        Border { title: title.to_owned(), note, keys: week_keys(look), ..Border::default() }
    }

    /// Draws the curve, and the change of every week below it if it fits.
    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let (company, week) = (look.company, cash.week());
        let changes = if seat.area.height >= 11 { seat.area.height / 3 } else { 0 };
        let [above, below] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(changes)]).areas(seat.area);
        let cash = &company.cash_by_day;
        let plot = Plot {
            lines: &[Line::of(cash, Role::Series(0))],
            band: None,
            mark: seat.focused.then(|| f64::from(days_of(week).1)),
            x: &Axis { write: &|day| format!("day {day:.0}"), holds: &[] },
            y: &Side { unit: Unit::Dollars, holds: zero_if_near(cash.iter().copied()) },
        };
        plot.draw(canvas, above);
        draw_changes(canvas, below, company, week);
    }
}

/// Returns the net result of the selected week.
fn net(cash: &Cash) -> Option<Selected> {
    Some((Subject::Net, (cash.week(), cash.week())))
}

/// Draws the weekly changes as bars, newest at the right: gains above the line, losses below.
fn draw_changes(canvas: &mut Canvas<'_>, area: Rect, company: &Company, selected: u32) {
    if area.height < 3 || area.width < SIDE + 8 {
        return;
    }
    let room = ((area.width - SIDE) / 2) as usize;
    let weeks = &company.weeks[company.weeks.len().saturating_sub(room)..];
    let gain = weeks.iter().map(|week| week.cash_change).fold(0.0, f64::max);
    let loss = -weeks.iter().map(|week| week.cash_change).fold(0.0, f64::min);
    if gain + loss <= 0.0 {
        return;
    }
    let rows = f64::from(area.height);
    let above = ((rows * gain / (gain + loss)).round() as u16)
        .clamp(u16::from(gain > 0.0), area.height - u16::from(loss > 0.0));
    let label = |canvas: &mut Canvas<'_>, y: u16, value: f64| {
        let place = Rect { y, height: 1, width: SIDE - 1, ..area };
        canvas.aligned(place, &short_dollars(value), Role::Dim, Align::Right);
    };
    if gain > 0.0 {
        label(canvas, area.y, gain);
    }
    if loss > 0.0 && above < area.height {
        label(canvas, area.bottom() - 1, -loss);
    }
    for (at, week) in weeks.iter().enumerate() {
        let x = area.x + SIDE + 2 * at as u16;
        let (rows, most, role) = match week.cash_change {
            change if change < 0.0 => (area.height - above, loss, Role::Bad),
            _ => (above, gain, Role::Good),
        };
        let filled = (week.cash_change.abs() / most.max(1e-9) * f64::from(rows)).round() as u16;
        let here = week.day.div_ceil(7) == selected;
        for step in 0..filled.max(1).min(rows) {
            let y = if week.cash_change < 0.0 { area.y + above + step } else { area.y + above - 1 - step };
            let glyph = if here { "█" } else { "▒" };
            canvas.text(Rect { x, y, width: 1, height: 1 }, glyph, role);
        }
    }
}
