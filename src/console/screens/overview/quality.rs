//! Delivered quality by group and plan.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::Overview;
use crate::action::Action;
use crate::context::{Figure, Look, ScreenId};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_report::fit::Beside;
use novamind_session::DeliveredQuality;
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_tui::canvas::Canvas;
use novamind_tui::text::number;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_room;
use novamind_tui::widgets::{Cell, Column, Table};
use novamind_worker::company::Company;

/// Columns of the required quality and of the bonus from targeted development.
const FLOOR: usize = 4;
const BONUS: usize = 6;

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
            None if (FLOOR..BONUS).contains(&column) => {
                let title = format!("required quality of {group}");
                let sql = format!("SELECT * FROM group_info_levels WHERE group_id = '{group}'");
                return Some(Figure { title, term: "fit", sql: Some(sql), why: None });
            }
            None => "from targeted development".to_owned(),
        };
        let title = format!("delivered quality of {group} {of}");
        Some(Figure { title, term: "delivered-quality", sql: None, why: None })
    }

    fn act(&self, overview: &mut Overview, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            let row = overview.quality.selected().and_then(|row| look.company.quality.get(row));
            return row.map(|own| Effect::ShowGroup(ScreenId::Customers, own.group)).into_iter().collect();
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

pub fn table_of(company: &Company) -> (Vec<Column>, Vec<Vec<Cell>>) {
    let tier = |plan: &Plan| number(company.setting(ToolId::SetModelTiers, plan.id()));
    let plans = Plan::ALL.iter().map(|plan| Column::numbers(format!("{plan} tier {}", tier(plan))));
    let known = ["required", "as of"].map(Column::numbers);
    let columns = [Column::words("group")].into_iter().chain(plans).chain(known);
    let columns = columns.chain([Column::numbers("targeted")]);
    let row = |quality: &DeliveredQuality| {
        let bonus = match quality.group_bonus {
            bonus if bonus > 0.0 => Cell::number(bonus, format!("+{bonus:.4}")),
            _ => Cell::number(0.0, "–").role(Role::Dim),
        };
        let fit = company.fit(quality.group);
        let plans = quality.by_plan.0.map(|value| {
            let role = match fit.map(|fit| fit.floor.beside(value)) {
                Some(Beside::Below) => Role::Bad,
                Some(Beside::Above) => Role::Good,
                _ => Role::Text,
            };
            Cell::number(value, format!("{value:.4}")).role(role)
        });
        let none = || Cell::words("–").role(Role::Dim);
        let floor = fit.map_or_else(none, |fit| Cell::number(fit.floor.least, fit.floor.quality()));
        let as_of =
            fit.map_or_else(none, |fit| Cell::number(f64::from(fit.as_of), format!("day {}", fit.as_of)));
        let name = [Cell::words(quality.group.id()).role(Role::Strong)];
        name.into_iter().chain(plans).chain([floor, as_of, bonus]).collect()
    };
    (columns.collect(), company.quality.iter().map(row).collect())
}
