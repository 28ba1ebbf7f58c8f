//! Bars from the cash of the previous week to the cash of the selected week.

use ratatui::layout::Rect;

use super::model::{CashStep, cash_before_and_after, format_money, cash_steps};
use super::{Cash, SelectedSubject, ledger_rows, week_keys};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{dollars, short_dollars};
use novamind_tui::canvas::{Align, Canvas, Click, row_rects};
use novamind_tui::text::format_change;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

pub struct WaterfallPane;

impl Pane<Cash> for WaterfallPane {
    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Left, Action::Right, Action::Open]
    }

    fn figure(&self, cash: &Cash, context: &ScreenContext<'_>) -> Option<Figure> {
        cash.subject_figure(selected(cash, context.company))
    }

    fn handle_action(&self, cash: &mut Cash, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let last = cash.steps(context.company).len().saturating_sub(1);
        match action {
            Action::Open => return ledger_rows(selected(cash, context.company)),
            Action::Left | Action::Right => {
                cash.handle_week_action(action);
            }
            Action::Close if cash.selected_week.is_some() => {
                cash.handle_week_action(action);
            }
            Action::Up => cash.selected_step = cash.selected_step.min(last).saturating_sub(1),
            Action::Down => cash.selected_step = (cash.selected_step + 1).min(last),
            Action::First => cash.selected_step = 0,
            Action::Last => cash.selected_step = last,
            action => {
                cash.table.handle_action(action, context.page_rows);
            }
        }
        Vec::new()
    }

    fn handle_click(&self, cash: &mut Cash, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        cash.selected_step = row;
        Vec::new()
    }

    fn border(&self, cash: &Cash, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let week = cash.week();
        let change = cash_before_and_after(context.company, week).map_or(0.0, |(before, after)| after - before);
        PaneBorder {
            title: format!("From week {} to {week}", week.saturating_sub(1)),
            note: format_change(change, &dollars(change.abs())),
            keys: week_keys(context),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        // Without the focus, the pane shows the complete waterfall with small steps combined. With the focus, every
        // step can be selected.
        let max = if placement.focused { usize::MAX } else { placement.area.height.saturating_sub(1) as usize };
        let steps = cash_steps(&cash.ledger, context.company, cash.week(), max);
        let selected = placement.focused.then(|| cash.selected_step.min(steps.len().saturating_sub(1)));
        draw(canvas, placement.area, &steps, selected, placement.index);
    }
}

fn selected(cash: &Cash, company: &DisplayedCompany) -> Option<SelectedSubject> {
    let (steps, week) = (cash.steps(company), cash.week());
    let step = steps.get(cash.selected_step.min(steps.len().saturating_sub(1)))?;
    Some((step.subject, (week, week)))
}

/// Draws one step per row. Bars start at the lowest level unless zero is near, so that changes are visible.
fn draw(canvas: &mut Canvas<'_>, area: Rect, steps: &[CashStep], selected: Option<usize>, pane: usize) {
    if steps.is_empty() {
        canvas.draw_text(area, canvas.empty_chart_text, Role::Dim);
        return;
    }
    let names = 12.min(area.width);
    let figures = 13.min(area.width - names);
    let bars = area.width - names - figures;
    let (min, max) = steps
        .iter()
        .flat_map(|step| [step.from, step.to])
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), level| (min.min(level), max.max(level)));
    let floor = if min > 0.0 && min < (max - min) * 0.5 { 0.0 } else { min };
    // If bars do not start at zero, an additional row shows the value at which the bars start.
    let is_labelled = floor != 0.0 && bars >= 24 && area.height > 1;
    let area = Rect { height: area.height - u16::from(is_labelled), ..area };
    let from = canvas.scroll_to_row(area, selected.unwrap_or(0), steps.len());
    let span = (max - floor).max(1e-9);
    let room = f64::from(bars.saturating_sub(2));
    // The bar of the lowest level keeps a width of at least one cell.
    let place = |level: f64| 1 + ((level - floor) / span * (room - 1.0).max(0.0)).round() as u16;
    for (row, (at, step)) in row_rects(area).zip(steps.iter().enumerate().skip(from)) {
        let here = selected == Some(at);
        canvas.register_click(row, Click::Row(pane, at));
        let (value, sign, role) = match (step.is_level, step.to - step.from) {
            (true, _) => (step.to, "", Role::Strong),
            (false, change) if change < 0.0 => (change, "", Role::Bad),
            (false, change) => (change, "+", Role::Good),
        };
        if here {
            canvas.clear(Rect { width: names + figures, ..row }, Role::Selection);
        }
        let shown = |role: Role| if here { Role::Selection } else { role };
        canvas.draw_text(Rect { width: names, ..row }, &step.name, shown(Role::Text));
        let figure = Rect { x: row.x + names, width: figures, ..row };
        canvas.draw_aligned(figure, &format!("{sign}{}", format_money(value)), shown(role), Align::Right);
        if bars < 4 {
            continue;
        }
        let x = figure.right() + 1;
        let (from, to, glyph, role) = match step.is_level {
            true => (0, place(step.to), "█", Role::Series(0)),
            false if step.to < step.from => (place(step.to), place(step.from), "▒", Role::Bad),
            false => (place(step.from), place(step.to), "▓", Role::Good),
        };
        let width = (to - from).max(1);
        let bar = Rect { x: x + from, width, height: 1, ..row }.intersection(area);
        canvas.draw_text(bar, &glyph.repeat(bar.width as usize), role);
    }
    if is_labelled {
        let below = area.bottom().min(area.y.saturating_add((steps.len() - from) as u16));
        let row = Rect { x: area.x + names + figures + 1, y: below, width: bars - 1, height: 1 };
        canvas.draw_text(row, &format!("bars start at {}", short_dollars(floor)), Role::Dim);
    }
}
