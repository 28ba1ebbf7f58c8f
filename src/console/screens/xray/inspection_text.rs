//! Draws the results of inspections: wrapped text, sparklines of daily figures, and spillover as a heat map.

use unicode_width::UnicodeWidthStr;

use super::view::XrayView;
use super::{Xray, spillover_map};
use crate::action::Action;
use crate::context::ScreenContext;
use crate::screens::panes::PanePlacement;
use novamind_base::formatting::capitalize;
use novamind_insight::LeadFactor;
use novamind_report::inspection::factor_line_index;
use novamind_session::INSPECTION_REJECTED;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline;
use novamind_worker::inspection::{InspectionCurve, InspectionAnswer};
use ratatui::layout::Rect;

pub type StyledRow = Vec<(String, Role)>;

const MAX_CURVE_DAYS: usize = 28;

/// Draws the wrapped result. In the leads view, the selected factor is marked.
pub fn draw(xray: &Xray, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
    let width = usize::from(placement.area.width);
    let rows = match shown_content(xray, context) {
        InspectionContent::Sentence(text, role) => {
            wrap(&text, width).into_iter().map(|part| vec![(part, role)]).collect()
        }
        InspectionContent::Found(InspectionAnswer { map: Some(map), .. }) => spillover_map::rows(map, width),
        InspectionContent::Found(found) => {
            let marked = (xray.view() == XrayView::Leads && !found.curves.is_empty())
                .then(|| factor_line_index(LeadFactor::ALL[xray.selected_factor]));
            text_rows(found, marked, placement.focused, width)
        }
    };
    let from = xray.scroll.scroll_rows(canvas, placement.area, rows.len());
    if placement.focused {
        canvas.page_rows = placement.area.height.max(1);
    }
    for (row, pieces) in row_rects(placement.area).zip(rows.iter().skip(from)) {
        let mut x = row.x;
        for (text, role) in pieces {
            let room = row.right().saturating_sub(x);
            canvas.draw_text(Rect { x, width: room, ..row }, text, *role);
            x = x.saturating_add(text.width() as u16).min(row.right());
        }
    }
}

/// Returns the wrapped rows. A sparkline is at the end of its line, or below the line if it does not fit.
fn text_rows(found: &InspectionAnswer, marked: Option<usize>, focused: bool, width: usize) -> Vec<StyledRow> {
    let mut rows = Vec::new();
    for (at, line) in found.lines.iter().enumerate() {
        let role = match at {
            at if marked == Some(at) && focused => Role::Selection,
            at if marked == Some(at) => Role::InactiveSelection,
            0 => Role::Header,
            _ => Role::Text,
        };
        let first = rows.len();
        rows.extend(wrap_table_row(line, width).into_iter().map(|part| vec![(part, role)]));
        let Some(curve) = found.curves.iter().find(|curve| curve.line_index == at) else { continue };
        let (days, fits) = (curve_sparkline(curve), rows.len() == first + 1);
        match fits && line.width() + 2 + days.width() <= width {
            true => rows[first].extend([("  ".to_owned(), Role::Text), (days, Role::Series(0))]),
            false => {
                let days = if days.width() + CONTINUATION_INDENT > width { String::new() } else { days };
                rows.push(vec![(" ".repeat(CONTINUATION_INDENT), Role::Text), (days, Role::Series(0))]);
            }
        }
    }
    rows
}

/// Formats the curve of an inspection as a sparkline. Values are rounded to the precision of the text, so that values
/// with equal texts have equal bars.
fn curve_sparkline(curve: &InspectionCurve) -> String {
    let shown: Vec<f64> = curve.values_by_day.iter().map(|value| (value * 1e4).round() / 1e4).collect();
    sparkline(&shown, MAX_CURVE_DAYS)
}

enum InspectionContent<'a> {
    Sentence(String, Role),
    Found(&'a InspectionAnswer),
}

fn shown_content<'a>(xray: &'a Xray, context: &ScreenContext<'_>) -> InspectionContent<'a> {
    let sentence = |text: &str, role| InspectionContent::Sentence(text.to_owned(), role);
    let key = |action| context.keys.label(action).unwrap_or_default();
    if !xray.can_inspect {
        return InspectionContent::Sentence(capitalize(INSPECTION_REJECTED) + ".", Role::Dim);
    }
    let is_command_view = xray.view() == XrayView::Commands;
    let wanted = xray.current_question();
    let seen = match is_command_view {
        true => xray.command_output.as_ref().filter(|_| xray.pending_command().is_none()),
        false => xray.inspection.as_ref().filter(|seen| Some(&seen.question) == wanted.as_ref()),
    };
    match seen.map(|seen| &seen.found) {
        Some(Ok(found)) => InspectionContent::Found(found),
        Some(Err(problem)) => sentence(problem, Role::Bad),
        None if wanted.is_some() => sentence("re-simulating …", Role::Dim),
        None if is_command_view && xray.pending_command().is_some() => sentence("re-simulating …", Role::Dim),
        None if is_command_view => {
            let text = format!(
                "Press {} and type a plain-mode command, for example find churn(S1) > 5% over 7, who cash 84, diff 83 84, \
                 or set group.S1.c_max_mean 300 from 30 in a debug run",
                key(Action::TypeCommand)
            );
            InspectionContent::Sentence(text, Role::Dim)
        }
        None if xray.last_day == 0 => sentence("No day has been simulated yet.", Role::Dim),
        None if xray.view() == XrayView::Customer => {
            let text = format!(
                "Press {} and type a customer number, optionally with a day. The default is the last day, or the day of cancellation.",
                key(Action::TypeTarget)
            );
            InspectionContent::Sentence(text, Role::Dim)
        }
        None => sentence("Nothing is selected.", Role::Dim),
    }
}

/// Indentation of continuation rows, in columns.
const CONTINUATION_INDENT: usize = 6;

const COLUMN_GAP: &str = "  ";

/// Wraps a line of an inspection. Table rows keep the spaces that align their columns, and cells that do not fit are
/// moved to the next row.
fn wrap_table_row(line: &str, width: usize) -> Vec<String> {
    if line.width() <= width || !line.trim_start().contains(COLUMN_GAP) {
        return wrap(line, width);
    }
    let mut rows = Vec::new();
    let mut rest = line.to_owned();
    while rest.width() > width && width > 2 * CONTINUATION_INDENT {
        let gaps = rest.match_indices(COLUMN_GAP).map(|(at, _)| at);
        let fits = |at: &usize| rest[..*at].width() <= width && !rest[..*at].trim().is_empty();
        let Some(cut) = gaps.filter(fits).last() else { break };
        rows.push(rest[..cut].trim_end().to_owned());
        rest = format!("{}{}", " ".repeat(CONTINUATION_INDENT), rest[cut..].trim_start());
        if rest.trim().is_empty() {
            return rows;
        }
    }
    rows.extend(wrap(&rest, width));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrapped_table_rows_keep_their_columns() {
        let rows = |line: &str| wrap_table_row(line, 26);
        assert_eq!(rows("  plan  price  quality  required"), ["  plan  price  quality", "      required"]);
        assert_eq!(rows("  A     12.00  0.21     0.26"), ["  A     12.00  0.21", "      0.26"]);
        assert_eq!(rows("  words that are no row of a table"), ["  words that are no row of", "  a table"]);
        assert_eq!(rows("short  line"), ["short  line"]);
        for width in 0..40 {
            wrap_table_row("  plan  price  averyveryverylongwordthatfitsnowhere  required", width);
        }
    }

    #[test]
    fn sparkline_is_drawn_after_its_line() {
        let curve = InspectionCurve { line_index: 1, values_by_day: vec![0.10001, 0.10002, f64::NAN, 0.10004] };
        let lines = vec!["head".to_owned(), "R reputation".to_owned()];
        let found = InspectionAnswer { lines, curves: vec![curve], ..InspectionAnswer::default() };
        let text = |width| -> Vec<String> {
            let rows = text_rows(&found, Some(1), true, width);
            rows.iter().map(|row| row.iter().map(|(text, _)| text.as_str()).collect()).collect()
        };
        assert_eq!(text(30), ["head", "R reputation  ▄▄ ▄"]);
        assert_eq!(text(14), ["head", "R reputation", "      ▄▄ ▄"]);
        for width in 0..40 {
            text(width);
        }
        let marked = &text_rows(&found, Some(1), true, 30)[1][0];
        assert_eq!(marked.1, Role::Selection);
    }
}
