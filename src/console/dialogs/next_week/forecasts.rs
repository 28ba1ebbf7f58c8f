//! Step 3 of the next-week dialog: cash forecasts with an interval for each horizon.

use ratatui::layout::Rect;

use super::{HORIZON_LABELS, NextWeekDialog};
use crate::action::Action;
use crate::context::ScreenContext;
use crate::forecast_fan::draw_fan;
use novamind_base::formatting::{dollars, percent};
use novamind_tui::canvas::{Align, Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

impl NextWeekDialog {
    pub(super) fn draw_forecasts(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let (company, roomy) = (context.company, area.height >= 12);
        let question = format!(
            "Cash now: {}. {}",
            dollars(company.observation.cash),
            match company.observation.horizons_in_run {
                0 => "The run ends within a week, so no forecast is needed.",
                _ => "Forecast cash with ranges that contain the actual value 95 times in 100.",
            }
        );
        let asked = wrap(&question, area.width as usize);
        let below = self.naive_forecast_text(context, area.width as usize, roomy);
        let used = (asked.len() + 1 + HORIZON_LABELS.len() + below.len()) as u16;
        let mut rows = row_rects(area);
        for (line, row) in asked.iter().zip(rows.by_ref()) {
            canvas.draw_text(row, line, Role::Text);
        }
        if let Some(row) = rows.next() {
            for (at, title) in ["low", "point", "high"].into_iter().enumerate() {
                canvas.draw_aligned(cell_area(row, at), title, Role::Header, Align::Right);
            }
            let record = Rect { x: row.x + 60, width: row.width.saturating_sub(60), ..row };
            let title = if record.width < 18 { "past" } else { "your past forecasts" };
            if company.can_show_forecast_scores() {
                canvas.draw_text(record, title, Role::Header);
            }
        }
        for (at, row) in rows.by_ref().take(HORIZON_LABELS.len()).enumerate() {
            self.draw_horizon(canvas, row, at, company);
        }
        for ((line, role), row) in below.iter().zip(rows) {
            canvas.draw_text(row, line, *role);
        }
        let used = used + u16::from(roomy);
        let left = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
        if let Ok(forecasts) = self.parse_forecasts(company) {
            let shown = &forecasts.all[..company.observation.horizons_in_run];
            draw_fan(canvas, left, company, company.observation.day, shown);
        }
    }

    /// Describes the naive forecasts, and their past coverage if the rules permit it.
    fn naive_forecast_text(
        &self,
        context: &ScreenContext<'_>,
        width: usize,
        roomy: bool,
    ) -> Vec<(String, Role)> {
        let filled = self.filled_naively.as_flattened().contains(&true);
        let fills = match (filled, context.keys.label(Action::FillNaiveForecasts)) {
            (false, Some(key)) => format!("{key} fills empty cells"),
            _ => "marked as naive forecasts".to_owned(),
        };
        let text =
            format!("{fills}: billing dates, recent renewals and the trend of signups, at current costs");
        let mut lines: Vec<(String, Role)> =
            wrap(&text, width).into_iter().map(|line| (line, Role::Dim)).collect();
        if filled && roomy && !context.company.is_baseline() {
            let coverage = context.company.observation.describe_ranges().unwrap_or_default();
            lines.extend(wrap(&coverage, width).into_iter().map(|line| (line, Role::Dim)));
        }
        lines
    }

    fn draw_horizon(&self, canvas: &mut Canvas<'_>, row: Rect, at: usize, company: &DisplayedCompany) {
        canvas.draw_text(Rect { width: 9.min(row.width), ..row }, HORIZON_LABELS[at], Role::Text);
        if at >= company.observation.horizons_in_run {
            let place = Rect { x: row.x + 10, width: row.width.saturating_sub(10), ..row };
            canvas.draw_text(
                place,
                &format!("after the last day ({})", company.observation.last_day),
                Role::Dim,
            );
            return;
        }
        for (column, field) in self.cells[at].iter().enumerate() {
            let place = cell_area(row, column).intersection(row);
            let here = self.focus == (at, column);
            if here && self.is_typing {
                field.draw(canvas, place);
                continue;
            }
            let role = if here { Role::Selection } else { Role::Field };
            canvas.clear(place, role);
            let text = if field.is_empty() { "–" } else { field.text() };
            canvas.draw_aligned(place, text, role, Align::Right);
            canvas.register_click(place, Click::Row(0, at * 3 + column));
        }
        if !company.can_show_forecast_scores() {
            return;
        }
        let record = Rect { x: row.x + 60, width: row.width.saturating_sub(60), ..row };
        let text = match company.forecast_scores.get(at) {
            Some(score) if score.scored > 0 && record.width < 36 => {
                format!("{} of {}", score.covered, score.scored)
            }
            Some(score) if score.scored > 0 => format!(
                "in range {} of {} · typical error {}",
                score.covered,
                score.scored,
                percent(score.mean_error, 1)
            ),
            _ => "–".to_owned(),
        };
        canvas.draw_text(record, &text, Role::Dim);
    }
}

fn cell_area(row: Rect, column: usize) -> Rect {
    Rect { x: row.x + 10 + column as u16 * 16, width: 14, ..row }
}
