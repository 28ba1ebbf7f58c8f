//! Delivered quality by group and plan.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::Overview;
use crate::action::Action;
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_report::fit::RangePosition;
use novamind_session::DeliveredQuality;
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_base::formatting::{quality as format_quality, quality_change};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::format_number;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::note_width;
use novamind_tui::widgets::{TableCell, TableColumn, Table};
use novamind_worker::company::DisplayedCompany;

/// Index of the column with the required quality.
const REQUIRED_QUALITY_COLUMN: usize = 4;
const BONUS_COLUMN: usize = 6;

pub struct QualityPane;

impl Pane<Overview> for QualityPane {
    fn table<'a>(&self, overview: &'a Overview) -> Option<&'a Table> {
        Some(&overview.quality)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("overview.quality")
    }

    fn table_mut<'a>(&self, overview: &'a mut Overview) -> Option<&'a mut Table> {
        Some(&mut overview.quality)
    }

    fn hints(&self, _: &Overview) -> Vec<Action> {
        vec![Action::Rows, Action::Sort, Action::Open]
    }

    fn figure(&self, overview: &Overview, context: &ScreenContext<'_>) -> Option<Figure> {
        let group = context.company.quality.get(overview.quality.selected()?)?.group;
        let column = overview.quality.selected_column();
        let of = match column.checked_sub(1).and_then(|at| Plan::ALL.get(at)) {
            Some(plan) => format!("on plan {plan}"),
            None if (REQUIRED_QUALITY_COLUMN..BONUS_COLUMN).contains(&column) => {
                let title = format!("required quality of {group}");
                let sql = format!("SELECT * FROM group_info_levels WHERE group_id = '{group}'");
                return Some(Figure { title, term: "fit", sql: Some(sql), week_quantity: None });
            }
            None => "from targeted development".to_owned(),
        };
        let title = format!("delivered quality of {group} {of}");
        Some(Figure { title, term: "delivered-quality", sql: None, week_quantity: None })
    }

    fn handle_action(&self, overview: &mut Overview, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            let row = overview.quality.selected().and_then(|row| context.company.quality.get(row));
            return row.map(|delivered_quality| Effect::ShowGroup(ScreenId::Customers, delivered_quality.group)).into_iter().collect();
        }
        overview.quality.handle_action(action, context.page_rows);
        Vec::new()
    }

    fn border(&self, _: &Overview, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let (base, shared) = context.company.quality_base;
        let title = "Delivered quality";
        let full = format!("base {} · general {}", format_quality(base), quality_change(shared));
        let note = if full.width() <= note_width(area, title) { full } else { String::new() };
        PaneBorder { title: title.to_owned(), note, ..PaneBorder::default() }
    }

    fn draw(&self, overview: &Overview, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        overview.quality.draw(canvas, placement.area, placement.focused, placement.index);
    }
}

pub fn quality_table(company: &DisplayedCompany) -> (Vec<TableColumn>, Vec<Vec<TableCell>>) {
    let tier = |plan: &Plan| format_number(company.current_setting(ToolId::SetModelTiers, plan.id()));
    let plans = Plan::ALL.iter().map(|plan| TableColumn::numeric(format!("{plan} tier {}", tier(plan))));
    let known = ["required", "as of"].map(TableColumn::numeric);
    let columns = [TableColumn::text("group")].into_iter().chain(plans).chain(known);
    let columns = columns.chain([TableColumn::numeric("targeted")]);
    let row = |quality: &DeliveredQuality| {
        let bonus = match quality.group_bonus {
            bonus if bonus > 0.0 => TableCell::from_number(bonus, quality_change(bonus)),
            _ => TableCell::from_number(0.0, "–").with_role(Role::Dim),
        };
        let fit = company.fit(quality.group);
        let plans = quality.by_plan.0.map(|value| {
            let role = match fit.map(|fit| fit.floor.position_of(value)) {
                Some(RangePosition::Below) => Role::Bad,
                Some(RangePosition::Above) => Role::Good,
                _ => Role::Text,
            };
            TableCell::from_number(value, format_quality(value)).with_role(role)
        });
        let none = || TableCell::from_text("–").with_role(Role::Dim);
        let floor = fit.map_or_else(none, |fit| TableCell::from_number(fit.floor.least, fit.floor.format_quality()));
        let as_of =
            fit.map_or_else(none, |fit| TableCell::from_number(f64::from(fit.study_day), format!("day {}", fit.study_day)));
        let name = [TableCell::from_text(quality.group.id()).with_role(Role::Strong)];
        name.into_iter().chain(plans).chain([floor, as_of, bonus]).collect()
    };
    (columns.collect(), company.quality.iter().map(row).collect())
}
