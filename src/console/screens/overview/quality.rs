//! Delivered quality by group and plan.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::Overview;
use crate::console::action::Action;
use crate::console::canvas::Canvas;
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::screens::panes::{Border, Pane, Seat};
use crate::console::screens::{Figure, Look, ScreenId};
use crate::console::text::number;
use crate::console::theme::Role;
use crate::console::widgets::chart::note_room;
use crate::console::widgets::{Cell, Column, Table};
use crate::session::DeliveredQuality;
use crate::tools::ToolId;
use crate::world::identifiers::Plan;

/// The table of the groups.
pub struct QualityPane;

impl Pane<Overview> for QualityPane {
    fn table<'a>(&self, overview: &'a Overview) -> Option<&'a Table> {
        Some(&overview.quality)
    }

    fn table_mut<'a>(&self, overview: &'a mut Overview) -> Option<&'a mut Table> {
        Some(&mut overview.quality)
    }

    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Rows, Action::Sort, Action::Open]
    }

    fn figure(&self, overview: &Overview, look: &Look<'_>) -> Option<Figure> {
        let group = look.company.quality.get(overview.quality.selected()?)?.group;
        let column = overview.quality.selected_column();
        let of = match column.checked_sub(1).and_then(|at| Plan::ALL.get(at)) {
            Some(plan) => format!("on plan {plan}"),
            None => "from targeted development".to_owned(),
        };
        let title = format!("delivered quality of {group} {of}");
        Some(Figure { title, term: "delivered-quality", sql: None })
    }

    fn act(&self, overview: &mut Overview, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return vec![Effect::Show(ScreenId::Product)];
        }
        overview.quality.act(action, look.page);
        Vec::new()
    }

    fn border(&self, _: &Overview, area: Rect, look: &Look<'_>) -> Border {
        let (base, shared) = look.company.quality_base;
        let title = "Delivered quality";
        let full = format!("base {base:.2} · general {shared:+.4}");
        let note = if full.width() <= note_room(area, title) { full } else { String::new() };
        Border { title: title.to_owned(), note, ..Border::default() }
    }

    fn draw(&self, overview: &Overview, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        overview.quality.draw(canvas, seat.area, seat.focused, seat.number);
    }
}

/// The table: columns and rows.
pub fn table_of(company: &Company) -> (Vec<Column>, Vec<Vec<Cell>>) {
    let tier = |plan: &Plan| number(company.setting(ToolId::SetModelTiers, plan.id()));
    let plans = Plan::ALL.iter().map(|plan| Column::numbers(format!("{plan} tier {}", tier(plan))));
    let columns = [Column::words("group")].into_iter().chain(plans).chain([Column::numbers("group's own")]);
    let row = |quality: &DeliveredQuality| {
        let bonus = match quality.group_bonus {
            bonus if bonus > 0.0 => Cell::number(bonus, format!("+{bonus:.4}")),
            _ => Cell::number(0.0, "–").role(Role::Dim),
        };
        let plans = quality.by_plan.0.map(|value| Cell::number(value, format!("{value:.4}")));
        [Cell::words(quality.group.id()).role(Role::Strong)].into_iter().chain(plans).chain([bonus]).collect()
    };
    (columns.collect(), company.quality.iter().map(row).collect())
}
