//! The pane with delivered quality by group and the components of delivered quality.

use ratatui::layout::Rect;

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

    fn summary(&self, _: &Product, company: &DisplayedCompany, _: usize) -> String {
        let (base, shared) = company.quality_base;
        let best =
            company.quality.iter().max_by(|left, right| left.group_bonus.total_cmp(&right.group_bonus));
        let best = best.filter(|best| best.group_bonus > 0.0);
        let best =
            best.map_or(String::new(), |best| format!(" · {} {}", best.group.id(), quality_change(best.group_bonus)));
        format!("base {} · general {}{best}", format_quality(base), quality_change(shared))
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
