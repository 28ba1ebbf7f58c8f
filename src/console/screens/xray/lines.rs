//! Draws results: wrapped text, sparklines of daily figures, and spillover as a heat map.

use unicode_width::UnicodeWidthStr;

use super::view::View;
use super::{Xray, heat};
use crate::action::Action;
use crate::context::Look;
use crate::screens::panes::Seat;
use novamind_base::notation::capital;
use novamind_insight::LeadFactor;
use novamind_report::xray::line_of_factor;
use novamind_session::REFUSED_LOOK;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::spark;
use novamind_worker::look_inside::{LookCurve, LookFound};
use ratatui::layout::Rect;

pub type Row = Vec<(String, Role)>;

const DAYS: usize = 28;

/// Draws the wrapped result, with the cursor on a factor of the leads.
pub fn draw(xray: &Xray, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
    let width = usize::from(seat.area.width);
    let rows = match shown(xray, look) {
        Content::Sentence(text, role) => {
            wrapped(&text, width).into_iter().map(|part| vec![(part, role)]).collect()
        }
        Content::Found(LookFound { map: Some(map), .. }) => heat::rows(map, width),
        Content::Found(found) => {
            let marked = (xray.view() == View::Leads && !found.curves.is_empty())
                .then(|| line_of_factor(LeadFactor::ALL[xray.factor]));
            rows_of_words(found, marked, seat.focused, width)
        }
    };
    let height = usize::from(seat.area.height);
    let from = xray.scroll.within(rows.len().saturating_sub(height));
    if seat.focused {
        canvas.page = seat.area.height.max(1);
    }
    for (row, pieces) in rows_of(seat.area).zip(rows.iter().skip(from)) {
        let mut x = row.x;
        for (text, role) in pieces {
            let room = row.right().saturating_sub(x);
            canvas.text(Rect { x, width: room, ..row }, text, *role);
            x = x.saturating_add(text.width() as u16).min(row.right());
        }
    }
}

/// Returns the wrapped rows, with sparklines after their lines, or below them if they do not fit.
fn rows_of_words(found: &LookFound, marked: Option<usize>, focused: bool, width: usize) -> Vec<Row> {
    let mut rows = Vec::new();
    for (at, line) in found.lines.iter().enumerate() {
        let role = match at {
            at if marked == Some(at) && focused => Role::Selection,
            at if marked == Some(at) => Role::SelectionIdle,
            0 => Role::Header,
            _ => Role::Text,
        };
        let first = rows.len();
        rows.extend(broken_into(line, width).into_iter().map(|part| vec![(part, role)]));
        let Some(curve) = found.curves.iter().find(|curve| curve.line == at) else { continue };
        let (days, fits) = (spark_of(curve), rows.len() == first + 1);
        match fits && line.width() + 2 + days.width() <= width {
            true => rows[first].extend([("  ".to_owned(), Role::Text), (days, Role::Series(0))]),
            false => {
                let days = if days.width() + SET_BACK > width { String::new() } else { days };
                rows.push(vec![(" ".repeat(SET_BACK), Role::Text), (days, Role::Series(0))]);
            }
        }
    }
    rows
}

/// Rounds values to the precision of the text, so that equal texts have equal bars.
fn spark_of(curve: &LookCurve) -> String {
    let shown: Vec<f64> = curve.days.iter().map(|value| (value * 1e4).round() / 1e4).collect();
    spark(&shown, DAYS)
}

enum Content<'a> {
    Sentence(String, Role),
    Found(&'a LookFound),
}

fn shown<'a>(xray: &'a Xray, look: &Look<'_>) -> Content<'a> {
    let sentence = |text: &str, role| Content::Sentence(text.to_owned(), role);
    let key = |action| look.keys.label(action).unwrap_or_default();
    if !xray.is_open {
        return Content::Sentence(capital(REFUSED_LOOK) + ".", Role::Dim);
    }
    let is_of_words = xray.view() == View::Words;
    let wanted = xray.wanted();
    let seen = match is_of_words {
        true => xray.said.as_ref().filter(|_| xray.words_asked().is_none()),
        false => xray.seen.as_ref().filter(|seen| Some(&seen.question) == wanted.as_ref()),
    };
    match seen.map(|seen| &seen.found) {
        Some(Ok(found)) => Content::Found(found),
        Some(Err(problem)) => sentence(problem, Role::Bad),
        None if wanted.is_some() => sentence("re-simulating …", Role::Dim),
        None if is_of_words && xray.words_asked().is_some() => sentence("re-simulating …", Role::Dim),
        None if is_of_words => {
            let text = format!(
                "Press {} and type a plain-mode command, for example find churn(S1) > 5% over 7, who cash 84, diff 83 84, \
                 or set group.S1.c_max_mean 300 from 30 in a debug run",
                key(Action::AskWords)
            );
            Content::Sentence(text, Role::Dim)
        }
        None if xray.last_day == 0 => sentence("No day has been simulated yet.", Role::Dim),
        None if xray.view() == View::Customer => {
            let text = format!(
                "Press {} and type a customer number, optionally with a day. The default is the last day, or the day of cancellation.",
                key(Action::TypeChoice)
            );
            Content::Sentence(text, Role::Dim)
        }
        None => sentence("Nothing is selected.", Role::Dim),
    }
}

/// Indentation of continued rows.
const SET_BACK: usize = 6;

const GAP: &str = "  ";

/// Wraps a line. Table rows keep the spaces that align their columns; cells that do not fit continue in the
/// next row.
fn broken_into(line: &str, width: usize) -> Vec<String> {
    if line.width() <= width || !line.trim_start().contains(GAP) {
        return wrapped(line, width);
    }
    let mut rows = Vec::new();
    let mut rest = line.to_owned();
    while rest.width() > width && width > 2 * SET_BACK {
        let gaps = rest.match_indices(GAP).map(|(at, _)| at);
        let fits = |at: &usize| rest[..*at].width() <= width && !rest[..*at].trim().is_empty();
        let Some(cut) = gaps.filter(fits).last() else { break };
        rows.push(rest[..cut].trim_end().to_owned());
        rest = format!("{}{}", " ".repeat(SET_BACK), rest[cut..].trim_start());
        if rest.trim().is_empty() {
            return rows;
        }
    }
    rows.extend(wrapped(&rest, width));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_tables_keep_their_columns_as_far_as_they_fit() {
        let rows = |line: &str| broken_into(line, 26);
        assert_eq!(rows("  plan  price  quality  required"), ["  plan  price  quality", "      required"]);
        assert_eq!(rows("  A     12.00  0.21     0.26"), ["  A     12.00  0.21", "      0.26"]);
        assert_eq!(rows("  words that are no row of a table"), ["  words that are no row of", "  a table"]);
        assert_eq!(rows("short  line"), ["short  line"]);
        for width in 0..40 {
            broken_into("  plan  price  averyveryverylongwordthatfitsnowhere  required", width);
        }
    }

    #[test]
    fn days_stand_behind_their_line_or_below_it_and_are_level_where_the_words_are() {
        let curve = LookCurve { line: 1, days: vec![0.10001, 0.10002, f64::NAN, 0.10004] };
        let lines = vec!["head".to_owned(), "R reputation".to_owned()];
        let found = LookFound { lines, curves: vec![curve], ..LookFound::default() };
        let text = |width| -> Vec<String> {
            let rows = rows_of_words(&found, Some(1), true, width);
            rows.iter().map(|row| row.iter().map(|(text, _)| text.as_str()).collect()).collect()
        };
        assert_eq!(text(30), ["head", "R reputation  ▄▄ ▄"]);
        assert_eq!(text(14), ["head", "R reputation", "      ▄▄ ▄"]);
        for width in 0..40 {
            text(width);
        }
        let marked = &rows_of_words(&found, Some(1), true, 30)[1][0];
        assert_eq!(marked.1, Role::Selection);
    }
}
