//! Step 1 of the next-week dialog: costs, changes, and open issues.

use ratatui::layout::Rect;
use ratatui::text::Line as TextLine;

use crate::action::Action;
use novamind_report::action_items::describe_no_items;
use novamind_report::cost_review::{identical_plan_lines, income_and_cost_lines};
use novamind_report::decision_periods::by_amount;
use novamind_report::research::late_project_lines;
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_tui::text::{format_number, wrap};
use novamind_tui::theme::Role;
use novamind_tui::widgets::ScrollState;
use novamind_worker::company::DisplayedCompany;

/// Scroll position of the review.
#[derive(Default)]
pub struct ChangeReview {
    scroll: ScrollState,
}

impl ChangeReview {
    /// Scrolls the review if it does not fit into the window.
    pub fn handle_scroll(&mut self, action: Action, page: usize) {
        self.scroll.handle_action(action, page);
    }

    /// Draws the visible lines of the review.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany, unsent: &[ToolId]) {
        let lines = review_lines(canvas, area.width as usize, company, unsent);
        let room = area.height as usize;
        let fits = lines.len() <= room;
        // The last row shows the number of hidden lines.
        let shown = if fits { room } else { room.saturating_sub(1) };
        let from = self.scroll.clamped_first_row(lines.len().saturating_sub(shown));
        canvas.page_rows = (shown as u16).max(1);
        canvas.draw_lines(area, &lines[from..(from + shown).min(lines.len())]);
        if !fits && area.height > 0 {
            let (above, below) = (from, lines.len() - from - shown);
            let row = Rect { y: area.bottom() - 1, height: 1, ..area };
            let text = match (above, below) {
                (0, below) => format!("  ↓ {below} more"),
                (above, 0) => format!("  ↑ {above} more"),
                (above, below) => format!("  ↑ {above} more · ↓ {below} more"),
            };
            canvas.draw_text(row, &text, Role::Dim);
        }
    }
}

fn review_lines(
    canvas: &Canvas<'_>,
    width: usize,
    company: &DisplayedCompany,
    unsent: &[ToolId],
) -> Vec<TextLine<'static>> {
    let seen = &company.observation;
    let mut lines: Vec<TextLine<'static>> = Vec::new();
    let head = |text: &str, canvas: &Canvas<'_>| TextLine::from(canvas.span(text.to_owned(), Role::Header));
    lines.push(head("Money", canvas));
    let money = income_and_cost_lines(seen).into_iter().map(|line| format!("  {line}"));
    let money = money.flat_map(|line| wrap(&line, width));
    lines.extend(money.map(|line| TextLine::from(canvas.span(line, Role::Text))));
    lines.push(TextLine::default());
    lines.push(head("Settings changed since last week", canvas));
    for change in by_amount(&seen.changes) {
        lines.push(TextLine::from(vec![
            canvas.span(format!("  {:<32} ", change.setting.to_string()), Role::Text),
            canvas.span(format!("{:>12} → ", format_number(change.old)), Role::Dim),
            canvas.span(format!("{:<12} ", format_number(change.new)), Role::Changed),
            canvas.span(change.setting.unit().unwrap_or_default().to_owned(), Role::Dim),
        ]));
    }
    lines.extend(
        seen.purchases.iter().map(|done| TextLine::from(canvas.span(format!("  {done}"), Role::Changed))),
    );
    if seen.changes.is_empty() && seen.purchases.is_empty() {
        lines.push(TextLine::from(canvas.span("  none", Role::Dim)));
    }
    let warnings = identical_plan_lines(seen).into_iter().chain(late_project_lines(seen));
    for text in warnings.flat_map(|line| wrap(&line, width.saturating_sub(2))) {
        lines.push(TextLine::from(canvas.span(format!("  {text}"), Role::Warning)));
    }
    lines.push(TextLine::default());
    lines.push(head("Before you continue", canvas));
    for tool in unsent {
        let text = format!("  ! the {tool} form has unsubmitted values");
        lines.push(TextLine::from(canvas.span(text, Role::Warning)));
    }
    for need in &company.action_items {
        let words = wrap(&need.describe(), width.saturating_sub(4));
        for (at, text) in words.into_iter().enumerate() {
            let mark = if at > 0 {
                "    "
            } else if need.is_urgent {
                "  ! "
            } else {
                "  · "
            };
            let role = if need.is_urgent { Role::Warning } else { Role::Text };
            lines.push(TextLine::from(canvas.span(format!("{mark}{text}"), role)));
        }
    }
    if company.action_items.is_empty() && unsent.is_empty() {
        let text = describe_no_items(company.weeks.last(), seen.runway_weeks);
        let rows = wrap(&text, width.saturating_sub(2)).into_iter();
        lines.extend(rows.map(|text| TextLine::from(canvas.span(format!("  {text}"), Role::Dim))));
    }
    lines
}
