//! Step 3 of the next-week dialog: cash forecasts, an interval per horizon.

use ratatui::layout::Rect;

use super::{FilingDialog, HORIZONS};
use crate::action::Action;
use crate::context::Look;
use crate::fan::draw_fan;
use novamind_base::notation::{dollars, percent};
use novamind_session::Bands;
use novamind_tui::canvas::{Align, Canvas, Click, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_worker::company::Company;

impl FilingDialog {
    pub(super) fn draw_forecasts(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let (company, roomy) = (look.company, area.height >= 12);
        let question = format!(
            "Cash now: {}. Forecast it with ranges that contain the actual value 95 times in 100.",
            dollars(company.seen.cash)
        );
        let asked = wrapped(&question, area.width as usize);
        let below = self.said_of_naive(look, area.width as usize, roomy);
        let used = (asked.len() + 1 + HORIZONS.len() + below.len()) as u16;
        let mut rows = rows_of(area);
        for (line, row) in asked.iter().zip(rows.by_ref()) {
            canvas.text(row, line, Role::Text);
        }
        if let Some(row) = rows.next() {
            for (at, title) in ["low", "point", "high"].into_iter().enumerate() {
                canvas.aligned(cell_area(row, at), title, Role::Header, Align::Right);
            }
            let record = Rect { x: row.x + 60, width: row.width.saturating_sub(60), ..row };
            let title = if record.width < 18 { "so far" } else { "your record so far" };
            if company.shows_calibration() {
                canvas.text(record, title, Role::Header);
            }
        }
        for (at, row) in rows.by_ref().take(HORIZONS.len()).enumerate() {
            self.draw_horizon(canvas, row, at, company);
        }
        for ((line, role), row) in below.iter().zip(rows) {
            canvas.text(row, line, *role);
        }
        let used = used + u16::from(roomy);
        let left = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
        if let Ok(forecasts) = self.forecasts(company) {
            draw_fan(canvas, left, company, company.seen.day, &forecasts.all);
        }
    }

    /// Describes the projection, and its past coverage if the rules permit.
    fn said_of_naive(&self, look: &Look<'_>, width: usize, roomy: bool) -> Vec<(String, Role)> {
        let filled = self.filled.as_flattened().contains(&true);
        let fills = match (filled, look.keys.label(Action::FillNaively)) {
            (false, Some(key)) => format!("{key} fills empty cells"),
            _ => "marked as projection".to_owned(),
        };
        let said = format!("{fills}: the last four weeks continue at current costs");
        let mut lines: Vec<(String, Role)> =
            wrapped(&said, width).into_iter().map(|line| (line, Role::Dim)).collect();
        if filled && roomy && !look.company.is_baseline() {
            let coverage = wrapped(&Bands::shipped().coverage_in_words(), width);
            lines.extend(coverage.into_iter().map(|line| (line, Role::Dim)));
        }
        lines
    }

    fn draw_horizon(&self, canvas: &mut Canvas<'_>, row: Rect, at: usize, company: &Company) {
        canvas.text(Rect { width: 9.min(row.width), ..row }, HORIZONS[at], Role::Text);
        for (column, field) in self.cells[at].iter().enumerate() {
            let place = cell_area(row, column).intersection(row);
            let here = self.at == (at, column);
            if here && self.typing {
                field.draw(canvas, place);
                continue;
            }
            let role = if here { Role::Selection } else { Role::Field };
            canvas.clear(place, role);
            let text = if field.is_empty() { "–" } else { field.text() };
            canvas.aligned(place, text, role, Align::Right);
            canvas.click(place, Click::Row(0, at * 3 + column));
        }
        if !company.shows_calibration() {
            return;
        }
        let record = Rect { x: row.x + 60, width: row.width.saturating_sub(60), ..row };
        let text = match company.scores.get(at) {
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
        canvas.text(record, &text, Role::Dim);
    }
}

fn cell_area(row: Rect, column: usize) -> Rect {
    Rect { x: row.x + 10 + column as u16 * 16, width: 14, ..row }
}
