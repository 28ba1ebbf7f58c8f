//! Delivered quality of the open group by week, with the range of required quality that was estimated in that week.

use ratatui::layout::Rect;

use super::Customers;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_session::identifiers::{Group, Plan};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::Band;
use novamind_tui::widgets::{XAxis, Curve, Plot, YAxis, AxisUnit};
use novamind_worker::company::DisplayedCompany;

pub struct QualityByWeekPane;

impl Pane<Customers> for QualityByWeekPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        let title = format!("quality delivered to {} by week", customers.group(context.company)?);
        Some(Figure { title, term: "delivered-quality", sql: None, week_quantity: None })
    }

    fn border(&self, customers: &Customers, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let fit = customers.group(context.company).and_then(|group| context.company.fit(group));
        fit.map_or_else(PaneBorder::default, |fit| PaneBorder {
            title: "Delivered and required quality".to_owned(),
            note: format!("░ required, now {}", fit.floor.format_quality()),
            ..PaneBorder::default()
        })
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let Some(group) = customers.group(context.company) else { return };
        let names = ["A", "B", "C"];
        let line = |plan: Plan| {
            let points = quality_by_week(context.company, group, plan);
            Curve::from_points(points, Role::Series(plan.index())).with_name(names[plan.index()])
        };
        let lines = Plan::ALL.map(line);
        let band = Band { bounds: required_quality_by_week(context.company, group), name: "required" };
        let x = XAxis { format: &|week| format!("wk {week:.0}"), required_values: &[] };
        let y = YAxis { unit: AxisUnit::Number, required_values: &[0.0] };
        Plot { curves: &lines, band: Some(&band), marked_x: None, x: &x, y: &y }.draw(canvas, placement.area);
    }
}

/// Returns the delivered quality at the end of each week since the group was found.
pub fn quality_by_week(company: &DisplayedCompany, group: Group, plan: Plan) -> Vec<(f64, f64)> {
    let weeks = company.group_weeks.iter().enumerate();
    weeks.filter_map(|(at, week)| Some(((at + 1) as f64, week[group].quality?[plan]))).collect()
}

/// Returns each week since the group was found, with the lowest and highest required quality estimated at the end of
/// that week.
pub fn required_quality_by_week(company: &DisplayedCompany, group: Group) -> Vec<(f64, f64, f64)> {
    let weeks = company.group_weeks.iter().enumerate();
    let end = |(at, week): (usize, &novamind_session::identifiers::ByGroup<novamind_session::GroupWeek>)| {
        let (least, most) = week[group].floor?;
        Some(((at + 1) as f64, least, most))
    };
    weeks.filter_map(end).collect()
}
