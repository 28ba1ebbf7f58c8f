//! Stacked bars by week: income above the zero line, costs below the zero line.

use ratatui::layout::Rect;
use ratatui::style::{Modifier, Style};
use ratatui::symbols::Marker;

use super::model::{CategoryAmounts, WeeklyLedger, CATEGORIES, CATEGORY_COUNT, format_money, income_or_cost_total};
use super::{Cash, ledger_rows, week_keys};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tui::canvas::{Align, Canvas, Click, truncate_to_width};
use novamind_tui::theme::Role;
use novamind_tui::widgets::AxisUnit;
use novamind_tui::widgets::scale::ticks;

/// Minimum width of the bar of a week including the gap, in columns.
const MIN_WEEK_WIDTH: u16 = 3;
const MAX_WEEK_WIDTH: u16 = 9;
const AXIS_WIDTH: u16 = 8;

pub struct BarsPane;

impl Pane<Cash> for BarsPane {
    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Left, Action::Right, Action::Open]
    }

    fn figure(&self, cash: &Cash, _: &ScreenContext<'_>) -> Option<Figure> {
        cash.subject_figure(cash.selected_subject_in_week())
    }

    fn handle_action(&self, cash: &mut Cash, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        match action {
            Action::Open => return ledger_rows(cash.selected_subject_in_week()),
            // The up and down keys select the category to compare.
            action if !cash.handle_week_action(action) => {
                cash.table.handle_action(action, context.page_rows);
            }
            _ => {}
        }
        Vec::new()
    }

    fn handle_click(&self, cash: &mut Cash, week: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        cash.move_week(week as i64 - i64::from(cash.week()));
        Vec::new()
    }

    fn border(&self, cash: &Cash, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let week = cash.week();
        let note = cash.subject().map_or(String::new(), |subject| {
            let amount = subject.amount(&cash.ledger.week(week));
            format!("week {week}: {} {}", subject.name(), format_money(amount))
        });
        PaneBorder {
            title: "Income and costs by week".to_owned(),
            note,
            keys: week_keys(context),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        draw(canvas, placement.area, &cash.ledger, cash.week(), placement.index);
    }
}

/// Draws the bars of all weeks. Clicks are registered for the pane with index `pane`, with the week as the row.
fn draw(canvas: &mut Canvas<'_>, area: Rect, ledger: &WeeklyLedger, selected: u32, pane: usize) {
    if area.width < AXIS_WIDTH + 2 * MIN_WEEK_WIDTH || area.height < 5 {
        return;
    }
    let room = area.width - AXIS_WIDTH;
    let weeks = ledger.last_weeks((room / MIN_WEEK_WIDTH) as usize);
    if weeks.is_empty() {
        canvas.draw_text(area, canvas.empty_chart_text, Role::Dim);
        return;
    }
    let width = (room / weeks.len() as u16).clamp(MIN_WEEK_WIDTH, MAX_WEEK_WIDTH);
    let coloured = has_category_colors(canvas);
    let sign =
        |category: usize| if coloured { "█".to_owned() } else { CATEGORIES[category].glyph.to_string() };
    let legend = legend_lines(ledger, area.width as usize);
    let legend_rows = (legend.len() as u16).min(area.height.saturating_sub(6) / 2);
    let nets = u16::from(width >= 7);
    let height = area.height - legend_rows - 1 - nets;
    let scale = BarScale::for_weeks(&weeks, height);
    let line = area.y + scale.above;
    draw_axis(canvas, area, &scale);
    for (at, (week, amounts)) in weeks.iter().enumerate() {
        let x = area.x + AXIS_WIDTH + at as u16 * width;
        let column = Rect { x, width: width - 1, ..area };
        draw_week(canvas, column, line, amounts, &scale);
        let role = if *week == selected { Role::Selection } else { Role::Dim };
        let foot = Rect { y: area.y + height, height: 1, ..column };
        canvas.draw_aligned(foot, &week.to_string(), role, Align::Right);
        if nets > 0 {
            draw_net_label(canvas, Rect { y: foot.y + 1, ..foot }, amounts);
        }
        canvas.register_click(Rect { height: height + 1, ..column }, Click::Row(pane, *week as usize));
    }
    canvas.draw_text(Rect { y: area.y + height, height: 1, width: AXIS_WIDTH, ..area }, "week", Role::Dim);
    for (row, pieces) in legend.iter().take(legend_rows as usize).enumerate() {
        let mut x = area.x;
        let y = area.bottom() - legend_rows + row as u16;
        for (category, text) in pieces {
            let piece = Rect { x, y, width: area.right().saturating_sub(x), height: 1 };
            canvas.draw_text(piece, text, Role::Text);
            canvas.draw_text(
                Rect { width: 1, ..piece }.intersection(piece),
                &sign(*category),
                Role::Series(*category),
            );
            x += text.chars().count() as u16 + 2;
        }
    }
}

/// Rows above and below the zero line, and dollars per row.
#[derive(Debug, PartialEq)]
struct BarScale {
    above: u16,
    below: u16,
    dollars: f64,
}

impl BarScale {
    fn for_weeks(weeks: &[(u32, CategoryAmounts)], height: u16) -> BarScale {
        let max =
            |income: bool| weeks.iter().map(|(_, amounts)| income_or_cost_total(amounts, income).abs()).fold(0.0, f64::max);
        let (income, costs) = (max(true), max(false));
        let rows = height.saturating_sub(1);
        let whole = income + costs;
        if whole <= 0.0 || !whole.is_finite() || rows == 0 {
            return BarScale { above: 0, below: rows, dollars: 1.0 };
        }
        let above = ((f64::from(rows) * income / whole).round() as u16)
            .clamp(u16::from(income > 0.0), rows - u16::from(costs > 0.0 && rows > 1));
        let below = rows - above;
        let per_row = |max: f64, rows: u16| if rows == 0 { 0.0 } else { max / f64::from(rows) };
        BarScale { above, below, dollars: per_row(income, above).max(per_row(costs, below)) }
    }

    /// Returns the row in which a value ends, counted from the top.
    fn row(&self, value: f64) -> u16 {
        let rows = (value.abs() / self.dollars).ceil() as u16;
        if value < 0.0 { self.above + rows.min(self.below) } else { self.above - rows.min(self.above) }
    }
}

/// Draws the zero line and labels rows with round values.
fn draw_axis(canvas: &mut Canvas<'_>, area: Rect, scale: &BarScale) {
    let line = Rect { y: area.y + scale.above, height: 1, ..area };
    canvas.draw_text(line, &"─".repeat(area.width as usize), Role::Border);
    let bounds = [-f64::from(scale.below) * scale.dollars, f64::from(scale.above) * scale.dollars];
    let marks = ticks(bounds, usize::from((scale.above + scale.below) / 2).clamp(2, 7));
    let mut taken = vec![scale.above];
    for (value, label) in marks.iter().zip(AxisUnit::Dollars.labels(&marks)) {
        let row = scale.row(*value);
        if *value != 0.0 && taken.contains(&row) {
            continue;
        }
        taken.push(row);
        let place = Rect { y: area.y + row, height: 1, width: AXIS_WIDTH - 1, ..area };
        canvas.draw_aligned(place, &label, Role::Dim, Align::Right);
    }
}

/// A category and the end of its segment in a bar, in eighths of a row from the zero line.
type BarSegmentEnd = (usize, u32);

/// Returns the segments on one side of a bar, starting at the zero line.
fn bar_segments(amounts: &CategoryAmounts, income: bool, scale: &BarScale, rows: u16) -> Vec<BarSegmentEnd> {
    let mut sum = 0.0;
    let side_categories = CATEGORIES.iter().enumerate().filter(|(_, category)| category.is_income == income);
    let end = side_categories.map(|(at, _)| {
        sum += amounts[at].abs();
        (at, ((sum / scale.dollars * 8.0).round() as u32).min(u32::from(rows) * 8))
    });
    end.collect()
}

/// Returns the categories to draw in a row: the category nearer to the zero line, its size in eighths, and the next
/// category, if any.
fn segments_in_row(parts: &[BarSegmentEnd], row: u16) -> Option<(usize, u32, Option<usize>)> {
    let (from, to) = (u32::from(row) * 8, u32::from(row) * 8 + 8);
    let mut start = 0;
    let mut shares: Vec<(usize, u32)> = Vec::new();
    for (category, end) in parts {
        let share = (*end).min(to).saturating_sub(start.max(from));
        if share > 0 {
            shares.push((*category, share));
        }
        start = *end;
    }
    let filled: u32 = shares.iter().map(|(_, share)| share).sum();
    // A cell can show only two colors. While there are more segments, the smallest is merged into its neighbor.
    while shares.len() > 2 || (shares.len() == 2 && filled < 8) {
        let (least, _) = shares.iter().enumerate().min_by_key(|(_, (_, share))| *share)?;
        let (_, share) = shares.remove(least);
        shares[least.saturating_sub(1)].1 += share;
    }
    let (near, share) = *shares.first()?;
    Some((near, share, shares.get(1).map(|(beyond, _)| *beyond)))
}

/// Draws the bar of a week in eighths of rows with one color per category. Without colors, each row shows the glyph of
/// a category.
fn draw_week(canvas: &mut Canvas<'_>, column: Rect, line: u16, amounts: &CategoryAmounts, scale: &BarScale) {
    let coloured = has_category_colors(canvas);
    for income in [true, false] {
        let rows = if income { scale.above } else { scale.below };
        let parts = bar_segments(amounts, income, scale, rows);
        for step in 0..rows {
            let Some((near, eighths, beyond)) = segments_in_row(&parts, step) else { continue };
            let y = if income { line - 1 - step } else { line + 1 + step };
            let cell = Rect { y, height: 1, ..column };
            if coloured {
                draw_eighths(canvas, cell, income, (near, eighths), beyond);
            } else if eighths >= 4 || beyond.is_some() {
                let number = if eighths >= 4 { near } else { beyond.unwrap_or(near) };
                let text: String =
                    std::iter::repeat_n(CATEGORIES[number].glyph, column.width as usize).collect();
                canvas.draw_text(cell, &text, Role::Series(number));
            }
        }
    }
}

fn has_category_colors(canvas: &Canvas<'_>) -> bool {
    canvas.marker != Marker::Dot && canvas.theme.has_distinct_series_colors(CATEGORY_COUNT)
}

/// Draws a cell with eighths of one category next to the zero line. The rest of the cell shows the next category or
/// stays empty.
fn draw_eighths(
    canvas: &mut Canvas<'_>,
    cell: Rect,
    up: bool,
    (near, eighths): (usize, u32),
    beyond: Option<usize>,
) {
    const BLOCKS: [&str; 9] = [" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"];
    let colour = |category: usize| canvas.style(Role::Series(category)).fg;
    // Block glyphs are filled from the bottom. Below the zero line, the glyph draws the eighths that the nearer
    // category does not use.
    let lower = if up { eighths } else { 8 - eighths };
    let style = match (up, beyond) {
        _ if eighths >= 8 => Style { fg: colour(near), ..Style::new() },
        (true, beyond) => Style { fg: colour(near), bg: beyond.and_then(colour), ..Style::new() },
        (false, Some(beyond)) => Style { fg: colour(beyond), bg: colour(near), ..Style::new() },
        (false, None) => Style { fg: colour(near), ..Style::new() }.add_modifier(Modifier::REVERSED),
    };
    let block = BLOCKS[if eighths >= 8 { 8 } else { lower as usize }];
    let cell = cell.intersection(canvas.buffer.area);
    canvas.draw_text(cell, &block.repeat(cell.width as usize), Role::Text);
    canvas.buffer.set_style(cell, style);
}

fn draw_net_label(canvas: &mut Canvas<'_>, place: Rect, amounts: &CategoryAmounts) {
    let net: f64 = amounts.iter().sum();
    let (sign, role) = if net < 0.0 { ('-', Role::Bad) } else { ('+', Role::Good) };
    let text = format!("{sign}{}", novamind_base::formatting::compact_number(net.abs()));
    canvas.draw_aligned(place, &truncate_to_width(&text, place.width as usize), role, Align::Right);
}

/// Returns the lines of the legend. Each item is the index of a used category and its label.
fn legend_lines(ledger: &WeeklyLedger, width: usize) -> Vec<Vec<(usize, String)>> {
    let mut lines: Vec<Vec<(usize, String)>> = Vec::new();
    let mut used = width;
    for (at, category) in CATEGORIES.iter().enumerate() {
        if !ledger.is_used(at) {
            continue;
        }
        // The glyph of the category is drawn over the first space.
        let text = format!("  {}", category.name());
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
    fn income_and_costs_share_a_scale() {
        let mut amounts = [0.0; super::super::model::CATEGORY_COUNT];
        (amounts[0], amounts[3]) = (300.0, -100.0);
        assert_eq!(BarScale::for_weeks(&[(1, amounts)], 9), BarScale { above: 6, below: 2, dollars: 50.0 });
        amounts[3] = 0.0;
        assert_eq!(BarScale::for_weeks(&[(1, amounts)], 5), BarScale { above: 4, below: 0, dollars: 75.0 });
        assert_eq!(BarScale::for_weeks(&[], 0).above, 0);
    }

    #[test]
    fn bar_segments_end_at_eighths_of_a_cell() {
        let scale = BarScale { above: 3, below: 3, dollars: 80.0 };
        let mut amounts = [0.0; CATEGORY_COUNT];
        (amounts[0], amounts[1]) = (90.0, 40.0);
        let income = bar_segments(&amounts, true, &scale, 3);
        assert_eq!(segments_in_row(&income, 0), Some((0, 8, None)));
        assert_eq!(segments_in_row(&income, 1), Some((1, 5, None)), "the empty part leaves one color for the cell");
        assert_eq!(segments_in_row(&income, 2), None);
        (amounts[3], amounts[4], amounts[5], amounts[6]) = (-20.0, -10.0, -45.0, -500.0);
        let costs = bar_segments(&amounts, false, &scale, 3);
        assert_eq!(segments_in_row(&costs, 0), Some((3, 3, Some(5))));
        assert_eq!(segments_in_row(&costs, 1), Some((6, 8, None)));
        assert_eq!(costs.last(), Some(&(11, 24)), "no bar exceeds its area");
    }

    fn draw_bars_to_buffer(theme: &str, marker: Marker) -> ratatui::buffer::Buffer {
        use crate::test_kit::played_session;
        let ledger = WeeklyLedger::from_company(&novamind_worker::company::DisplayedCompany::from_session(&played_session(6)));
        let theme = novamind_tui::theme::Theme::bundled(theme);
        let theme = theme.expect("a theme");
        let area = Rect::new(0, 0, 60, 20);
        let mut buffer = ratatui::buffer::Buffer::empty(area);
        let mut canvas = Canvas::new(&mut buffer, &theme);
        canvas.marker = marker;
        draw(&mut canvas, area, &ledger, 6, 0);
        buffer
    }

    #[test]
    fn net_result_is_drawn_below_its_week() {
        let ledger = WeeklyLedger::from_company(&novamind_worker::company::DisplayedCompany::from_session(&crate::test_kit::played_session(6)));
        let picture: String =
            draw_bars_to_buffer("dark", Marker::Braille).content.iter().map(|cell| cell.symbol().to_owned()).collect();
        for (week, amounts) in ledger.last_weeks(6) {
            let net: f64 = amounts.iter().sum();
            let sign = if net < 0.0 { "-" } else { "+" };
            let text = format!("{sign}{}", novamind_base::formatting::compact_number(net.abs()));
            assert!(picture.contains(&text), "{text} of week {week} in {picture}");
        }
    }

    #[test]
    fn categories_differ_by_color_or_by_symbol() {
        let letters = |buffer: &ratatui::buffer::Buffer| {
            buffer.content.iter().map(|cell| cell.symbol().to_owned()).collect::<String>()
        };
        let coloured = draw_bars_to_buffer("dark", Marker::Braille);
        let signs: Vec<char> = CATEGORIES.iter().skip(1).map(|category_display| category_display.glyph).collect();
        let bars = letters(&coloured);
        assert!(bars.contains('█') && !bars.contains(['≡', '▒']), "{bars}");
        let mut colours: Vec<_> =
            coloured.content.iter().filter(|cell| cell.symbol() == "█").map(|cell| cell.fg).collect();
        colours.dedup();
        assert!(colours.len() > 3, "{colours:?}");
        for buffer in [draw_bars_to_buffer("mono", Marker::Braille), draw_bars_to_buffer("dark", Marker::Dot)] {
            let bars = letters(&buffer);
            assert!(signs.iter().filter(|sign| bars.contains(**sign)).count() > 2, "{bars}");
            assert!(!bars.contains(['▁', '▂', '▃']), "{bars}");
        }
    }
}
