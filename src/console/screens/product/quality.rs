//! The pane with delivered quality by group and the components of delivered quality.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::panel::{ProductPanel, show_cell_effect};
use super::{Product, ProductPane};
use crate::context::Figure;
use crate::effect::Effect;
use crate::screens::panes::PanePlacement;
use novamind_tools::ToolId;
use novamind_base::formatting::{quality as format_quality, quality_change};
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::format_number;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

pub struct QualityComponentsPane;

impl ProductPanel for QualityComponentsPane {
    fn id(&self) -> ProductPane {
        ProductPane::Quality
    }

    fn row_count(&self, _: &Product, company: &DisplayedCompany) -> usize {
        company.quality.len()
    }

    fn summary(&self, _: &Product, company: &DisplayedCompany, width: usize) -> String {
        let (base, shared) = company.quality_base;
        let bonuses = company.quality.iter().map(|quality| (quality.group.id(), quality.group_bonus));
        let bonuses = bonuses.filter(|(_, bonus)| *bonus > 0.0).collect();
        summary(format!("base {} · general {}", format_quality(base), quality_change(shared)), bonuses, width)
    }

    fn destination(&self, _: &Product) -> &'static str {
        ToolId::SetTargetedDevSpend.name()
    }

    fn open_effect(&self, product: &Product, company: &DisplayedCompany) -> Effect {
        let group = company.quality.get(product.selected_row(self.id())).map(|quality| quality.group.to_string());
        show_cell_effect(ToolId::SetTargetedDevSpend, group)
    }

    fn selected_figure(&self, product: &Product, company: &DisplayedCompany) -> Option<Figure> {
        let group = company.quality.get(product.selected_row(self.id()))?.group;
        let sql = "SELECT day, amount, note FROM ledger WHERE category = 'development' ORDER BY day DESC";
        let title = format!("delivered quality in {group}");
        Some(Figure { title, term: "delivered-quality", sql: Some(sql.to_owned()), week_quantity: None })
    }

    fn draw_content(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, company: &DisplayedCompany) {
        let (area, selected) = (placement.area, product.selected_row(self.id()));
        let (base, shared) = company.quality_base;
        let tier = |plan: &str| format!("{plan} T{}", format_number(company.current_setting(ToolId::SetModelTiers, plan)));
        let wide = area.width >= 62;
        let parts = if wide { format!(" {:>7} {:>8}", "base", "general") } else { String::new() };
        let head =
            format!("group {parts} {:>8} {:>9} {:>8} {:>8}", "targeted", tier("A"), tier("B"), tier("C"));
        canvas.draw_text(area, &head, Role::Header);
        let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        if placement.focused {
            canvas.page_rows = below.height.max(1);
        }
        let from = canvas.scroll_to_row(below, selected, company.quality.len());
        for (row, (at, quality)) in row_rects(below).zip(company.quality.iter().enumerate().skip(from)) {
            let parts = if wide { format!(" {:>7} {:>8}", format_quality(base), quality_change(shared)) } else { String::new() };
            let bonus_text = match quality.group_bonus {
                bonus if bonus > 0.0 => quality_change(bonus),
                _ => "–".to_owned(),
            };
            let [a, b, c] = quality.by_plan.0.map(format_quality);
            let text = format!("{:<6}{parts} {bonus_text:>8} {a:>9} {b:>8} {c:>8}", quality.group.id());
            let role = match (placement.focused && at == selected, quality.group_bonus > 0.0) {
                (true, _) => Role::Selection,
                (false, true) => Role::Text,
                (false, false) => Role::Dim,
            };
            canvas.clear(row, role);
            canvas.draw_text(row, &text, role);
            canvas.register_click(row, Click::Row(placement.index, at));
        }
    }
}

/// Appends the bonuses of groups to a text, the largest first. If they do not all fit, the text ends with the number of
/// omitted groups.
fn summary(text: String, mut bonuses: Vec<(&str, f64)>, width: usize) -> String {
    bonuses.sort_by(|left, right| right.1.total_cmp(&left.1));
    let with_first = |count: usize| {
        let shown = bonuses[..count].iter().map(|(group, bonus)| format!(" · {group} {}", quality_change(*bonus)));
        let more = match bonuses.len() - count {
            0 => String::new(),
            omitted => format!(" · {omitted} more"),
        };
        format!("{text}{}{more}", shown.collect::<String>())
    };
    let fitting = (0..=bonuses.len()).rev().map(with_first).find(|text| text.width() <= width);
    fitting.unwrap_or_else(|| with_first(0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn summary_counts_the_omitted_groups() {
        let bonuses = || vec![("S1", 0.2), ("S2", 1.354), ("E1", 0.1)];
        let text = |width| summary("base 0.200".to_owned(), bonuses(), width);
        let all = text(80);
        assert!(all.contains("S2") && all.contains("S1") && all.contains("E1") && !all.contains("more"), "{all}");
        let some = text(all.width() - 1);
        assert!(some.contains(" · S2 ") && some.ends_with(" more"), "{some}");
        assert!(text(5).ends_with("3 more"));
    }
}
