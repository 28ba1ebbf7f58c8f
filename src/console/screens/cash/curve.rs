//! A chart of cash by day with the selected week marked, and bars of the change in cash by week.

use ratatui::layout::{Constraint, Layout, Rect};
use unicode_width::UnicodeWidthStr;

use super::model::{LedgerSubject, cash_before_and_after, days_of_week};
use super::{Cash, SelectedSubject, ledger_rows, week_keys};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{dollars, short_dollars};
use novamind_report::cash_before_purchases;
use novamind_session::week_of_day;
use novamind_tui::canvas::{Align, Canvas};
use novamind_tui::text::format_change;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{note_width, summary, zero_if_near};
use novamind_tui::widgets::{XAxis, Curve, Plot, YAxis, AxisUnit};
use novamind_worker::company::DisplayedCompany;

const AXIS_WIDTH: u16 = 8;

pub struct CurvePane;

impl Pane<Cash> for CurvePane {
    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Left, Action::Right, Action::Open]
    }

    fn figure(&self, cash: &Cash, _: &ScreenContext<'_>) -> Option<Figure> {
        cash.subject_figure(selected_week_net(cash))
    }

    fn handle_action(&self, cash: &mut Cash, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return ledger_rows(selected_week_net(cash));
        }
        cash.handle_week_action(action);
        Vec::new()
    }

    fn border(&self, cash: &Cash, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let (title, company, week) = ("Cash", context.company, cash.week());
        let note = match cash_before_and_after(company, week) {
            Some((before, after)) => {
                let change = after - before;
                let ended = format!("end of week {week}: {} {}", dollars(after), format_change(change, &dollars(change.abs())));
                let now = cash_before_purchases(&company.observation).filter(|_| week == week_of_day(company.observation.day));
                let full = match now {
                    Some(_) => format!("{ended} · now {}", dollars(company.observation.cash)),
                    None => ended.clone(),
                };
                if full.width() <= note_width(area, title) { full } else { ended }
            }
            None => summary(&company.cash_by_day, &short_dollars, note_width(area, title)),
        };
        PaneBorder { title: title.to_owned(), note, keys: week_keys(context), ..PaneBorder::default() }
    }

    /// Draws the cash curve, and the weekly changes below the curve if they fit.
    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let (company, week) = (context.company, cash.week());
        let changes = if placement.area.height >= 11 { placement.area.height / 3 } else { 0 };
        let [above, below] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(changes)]).areas(placement.area);
        let cash = &company.cash_by_day;
        let plot = Plot {
            curves: &[Curve::from_values(cash, Role::Series(0))],
            band: None,
            marked_x: placement.focused.then(|| f64::from(days_of_week(week).1)),
            x: &XAxis { format: &|day| format!("day {day:.0}"), required_values: &[] },
            y: &YAxis { unit: AxisUnit::Dollars, required_values: zero_if_near(cash.iter().copied()) },
        };
        plot.draw(canvas, above);
        draw_changes(canvas, below, company, week);
    }
}

/// Returns the net result of the selected week.
fn selected_week_net(cash: &Cash) -> Option<SelectedSubject> {
    Some((LedgerSubject::Net, (cash.week(), cash.week())))
}

/// Draws the weekly changes as bars, newest at the right: gains above the line, losses below.
fn draw_changes(canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany, selected: u32) {
    if area.height < 3 || area.width < AXIS_WIDTH + 8 {
        return;
    }
    let room = ((area.width - AXIS_WIDTH) / 2) as usize;
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
        let place = Rect { y, height: 1, width: AXIS_WIDTH - 1, ..area };
        canvas.draw_aligned(place, &short_dollars(value), Role::Dim, Align::Right);
    };
    if gain > 0.0 {
        label(canvas, area.y, gain);
    }
    if loss > 0.0 && above < area.height {
        label(canvas, area.bottom() - 1, -loss);
    }
    for (at, week) in weeks.iter().enumerate() {
        let x = area.x + AXIS_WIDTH + 2 * at as u16;
        let (rows, most, role) = match week.cash_change {
            change if change < 0.0 => (area.height - above, loss, Role::Bad),
            _ => (above, gain, Role::Good),
        };
        let filled = (week.cash_change.abs() / most.max(1e-9) * f64::from(rows)).round() as u16;
        let here = week.day.div_ceil(7) == selected;
        for step in 0..filled.max(1).min(rows) {
            let y = if week.cash_change < 0.0 { area.y + above + step } else { area.y + above - 1 - step };
            let glyph = if here { "█" } else { "▒" };
            canvas.draw_text(Rect { x, y, width: 1, height: 1 }, glyph, role);
        }
    }
}
