//! Bars of the weeks: income above the line, costs below, made of their categories.

use ratatui::layout::Rect;

use super::model::{Amounts, Books, CATEGORIES, side};
use crate::console::canvas::{Align, Canvas, Click, fit};
use crate::console::text::short_dollars;
use crate::console::theme::Role;
use crate::session::Category;

/// Narrowest column of a week, with the gap.
const NARROWEST: u16 = 3;
/// Widest.
const WIDEST: u16 = 9;
/// Width of the figures at the side.
const SIDE: u16 = 8;

/// Draws the bars. `pane` is the number of the pane for clicks, whose rows are the weeks.
pub fn draw(canvas: &mut Canvas<'_>, area: Rect, books: &Books, selected: u32, pane: usize) {
    if area.width < SIDE + 2 * NARROWEST || area.height < 5 {
        return;
    }
    let room = area.width - SIDE;
    let weeks = books.last_weeks((room / NARROWEST) as usize);
    if weeks.is_empty() {
        canvas.text(area, "nothing to draw yet: let a week pass (n)", Role::Dim);
        return;
    }
    let width = (room / weeks.len() as u16).clamp(NARROWEST, WIDEST);
    let legend = legend(books, area.width as usize);
    let legend_rows = (legend.len() as u16).min(area.height.saturating_sub(6) / 2);
    let nets = u16::from(width >= 7);
    let height = area.height - legend_rows - 1 - nets;
    let scale = Scale::of(&weeks, height);
    let line = area.y + scale.above;
    draw_side(canvas, area, &scale);
    for (at, (week, amounts)) in weeks.iter().enumerate() {
        let x = area.x + SIDE + at as u16 * width;
        let column = Rect { x, width: width - 1, ..area };
        draw_week(canvas, column, line, amounts, &scale);
        let role = if *week == selected { Role::Selection } else { Role::Dim };
        let foot = Rect { y: area.y + height, height: 1, ..column };
        canvas.aligned(foot, &week.to_string(), role, Align::Right);
        if nets > 0 {
            draw_net(canvas, Rect { y: foot.y + 1, ..foot }, amounts);
        }
        canvas.click(Rect { height: height + 1, ..column }, Click::Row(pane, *week as usize));
    }
    canvas.text(Rect { y: area.y + height, height: 1, width: SIDE, ..area }, "week", Role::Dim);
    for (row, pieces) in legend.iter().take(legend_rows as usize).enumerate() {
        let mut x = area.x;
        let y = area.bottom() - legend_rows + row as u16;
        for (category, text) in pieces {
            let piece = Rect { x, y, width: area.right().saturating_sub(x), height: 1 };
            canvas.text(piece, text, Role::Series(*category));
            x += text.chars().count() as u16 + 2;
        }
    }
}

/// Rows above and below the line, and the dollars of a row.
#[derive(Debug, PartialEq)]
struct Scale {
    above: u16,
    below: u16,
    dollars: f64,
}

impl Scale {
    fn of(weeks: &[(u32, Amounts)], height: u16) -> Scale {
        let most =
            |income: bool| weeks.iter().map(|(_, amounts)| side(amounts, income).abs()).fold(0.0, f64::max);
        let (income, costs) = (most(true), most(false));
        let rows = height.saturating_sub(1);
        let whole = income + costs;
        if whole <= 0.0 || !whole.is_finite() || rows == 0 {
            return Scale { above: 0, below: rows, dollars: 1.0 };
        }
        let above = ((f64::from(rows) * income / whole).round() as u16)
            .clamp(u16::from(income > 0.0), rows - u16::from(costs > 0.0 && rows > 1));
        let below = rows - above;
        let per_row = |most: f64, rows: u16| if rows == 0 { 0.0 } else { most / f64::from(rows) };
        Scale { above, below, dollars: per_row(income, above).max(per_row(costs, below)) }
    }
}

fn draw_side(canvas: &mut Canvas<'_>, area: Rect, scale: &Scale) {
    let label = |canvas: &mut Canvas<'_>, y: u16, value: f64| {
        let place = Rect { y, height: 1, width: SIDE - 1, ..area };
        canvas.aligned(place, &short_dollars(value), Role::Dim, Align::Right);
    };
    if scale.above > 0 {
        label(canvas, area.y, f64::from(scale.above) * scale.dollars);
    }
    if scale.below > 1 {
        label(canvas, area.y + scale.above + scale.below, -f64::from(scale.below) * scale.dollars);
    }
    let line = Rect { y: area.y + scale.above, height: 1, ..area };
    canvas.text(line, &"─".repeat(area.width as usize), Role::Border);
    label(canvas, line.y, 0.0);
}

fn draw_week(canvas: &mut Canvas<'_>, column: Rect, line: u16, amounts: &Amounts, scale: &Scale) {
    for income in [true, false] {
        let mut sum = 0.0;
        let most = if income { scale.above } else { scale.below };
        for (at, category) in CATEGORIES.iter().enumerate().filter(|(_, own)| own.income == income) {
            let rows = |dollars: f64| ((dollars / scale.dollars).round() as u16).min(most);
            let from = rows(sum);
            sum += amounts[at].abs();
            for step in from..rows(sum) {
                let y = if income { line - 1 - step } else { line + 1 + step };
                let text: String = std::iter::repeat_n(category.glyph, column.width as usize).collect();
                canvas.text(Rect { y, height: 1, ..column }, &text, Role::Series(at));
            }
        }
    }
}

fn draw_net(canvas: &mut Canvas<'_>, place: Rect, amounts: &Amounts) {
    let net: f64 = amounts.iter().sum();
    let (sign, role) = if net < 0.0 { ('-', Role::Bad) } else { ('+', Role::Good) };
    let text = format!("{sign}{}", crate::notation::compact(net.abs()));
    canvas.aligned(place, &fit(&text, place.width as usize), role, Align::Right);
}

/// Lines of the legend: categories that were booked, with their text.
fn legend(books: &Books, width: usize) -> Vec<Vec<(usize, String)>> {
    let mut lines: Vec<Vec<(usize, String)>> = Vec::new();
    let mut used = width;
    for (at, category) in CATEGORIES.iter().enumerate() {
        if !books.is_used(at) || category.category == Category::InitialFunding {
            continue;
        }
        let text = format!("{} {}", category.glyph, category.name());
        let length = text.chars().count() + 2;
        if used + length > width + 2 || lines.is_empty() {
            lines.push(Vec::new());
            used = 0;
        }
        used += length;
        if let Some(line) = lines.last_mut() {
            line.push((at, text));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_of_the_line_have_the_same_scale() {
        let mut amounts = [0.0; super::super::model::COUNT];
        (amounts[0], amounts[3]) = (300.0, -100.0);
        assert_eq!(Scale::of(&[(1, amounts)], 9), Scale { above: 6, below: 2, dollars: 50.0 });
        amounts[3] = 0.0;
        assert_eq!(Scale::of(&[(1, amounts)], 5), Scale { above: 4, below: 0, dollars: 75.0 });
        assert_eq!(Scale::of(&[], 0).above, 0);
    }
}
