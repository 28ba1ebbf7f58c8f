//! The chart of a participation curve with the plans, for the curve explorer, the Fit pane and the price form.

use ratatui::layout::Rect;

use novamind_base::formatting::dollars;
use novamind_insight::{CurveExplorer, CurvePoint, PlanPoint};
use novamind_session::identifiers::{ByPlan, Plan};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::chart::{Band, Curve, Plot, PointLabel, XAxis, YAxis};
use novamind_tui::widgets::scale::AxisUnit;

/// Minimum height of a readable chart, in rows.
pub const MIN_CHART_ROWS: u16 = 5;

/// Draws the curve of a group with `plans`. `is_selected` returns whether a plan is highlighted.
pub fn draw_curve_chart(
    canvas: &mut Canvas<'_>,
    area: Rect,
    explorer: &CurveExplorer,
    plans: &ByPlan<PlanPoint>,
    is_selected: impl Fn(Plan) -> bool,
) {
    let all = || plans.iter().chain(explorer.plans.iter());
    let top = all().map(|plan_point| plan_point.quality).fold(1.0, f64::max);
    let most = explorer.points.last().map_or(1.0, |point| point.price);
    // A drafted price can be higher than the highest price of the curve.
    let most = all().map(|plan_point| plan_point.list_price).fold(most, f64::max);
    // Points above the chart are omitted, so that lines end at its upper edge. The band is clipped at the upper edge.
    let line = |of: fn(&CurvePoint) -> f64, role| {
        let inside = explorer.points.iter().filter(|point| of(point) <= top);
        Curve::from_points(inside.map(|point| (point.price, of(point))).collect(), role)
    };
    let mut lines = Vec::new();
    if !explorer.shows_true_values() {
        lines.push(line(|point| point.median_range.0, Role::Dim));
        lines.push(line(|point| point.median_range.1, Role::Dim));
    }
    lines.push(line(|point| point.median, Role::Series(0)).with_name("half"));
    let covered = explorer.points.iter().filter(|point| point.p10 <= top);
    let ends = covered.map(|point| (point.price, point.p10, point.p90.min(top))).collect();
    let band = Band { bounds: ends, name: "" };
    let x = XAxis { format: &|value| dollars(value), required_values: &[0.0, most] };
    let y = YAxis { unit: AxisUnit::Number, required_values: &[0.0, top] };
    let sign = |plan: Plan| {
        let point: &PlanPoint = &plans[plan];
        let role = if is_selected(plan) { Role::Selection } else { Role::Series(1) };
        let price = (point.list_price - explorer.discount).max(0.0);
        PointLabel { x: price, y: point.quality, text: plan.id(), role }
    };
    // The selected plan is drawn on top.
    let mut order = Plan::ALL;
    order.sort_by_key(|plan| is_selected(*plan));
    let signs: Vec<PointLabel> = order.into_iter().map(sign).collect();
    Plot { curves: &lines, band: Some(&band), marked_x: None, x: &x, y: &y }
        .draw_with_labels(canvas, area, &signs);
}
