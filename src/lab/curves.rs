//! Reports on participation curves: required quality by price (docs/laboratory/laws-and-curves.md).

use super::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
};
use novamind_insight::true_curve;
use novamind_world::customers::curve::{Curve, required_quality};
use novamind_world::identifiers::Group;
use novamind_world::params::{GroupParams, Params};

/// Number of price steps from 0 to the budget.
const PRICE_STEPS: u32 = 100;
/// Number of sampled prices in a table row.
const PRICES_PER_ROW: usize = 5;

/// Returns the participation curve of a customer who has the mean traits of a group.
fn mean_customer(group_params: &GroupParams, params: &Params) -> Curve {
    let bounds = &params.customer_generation;
    Curve {
        steepness_left: bounds.steepness_left_exp_scale + bounds.steepness_left_offset,
        steepness_right: bounds.steepness_right_exp_scale + bounds.steepness_right_offset,
        c_max: group_params.c_max_mean,
        q_min: group_params.q_min_mean,
        q_max: group_params.q_min_mean + group_params.q_range_mean,
    }
}

/// Returns a report on the curves of all groups' mean customers, with prices as shares of the budget.
pub fn all_curves_report(params: &Params) -> LabReport {
    let columns = vec![
        Column::text("group", "group"),
        Column::text("name", "name"),
        Column::number("budget", "budget", Measure::Dollars),
        Column::number("at_nothing", "at $0", Measure::Number(3)),
        Column::number("at_quarter", "at 1/4", Measure::Number(3)),
        Column::number("at_half", "at 1/2", Measure::Number(3)),
        Column::number("at_three_quarters", "at 3/4", Measure::Number(3)),
        Column::number("at_budget", "at budget", Measure::Number(3)),
    ];
    let mut table = LabTable::new(
        "curves",
        "Required quality of each group's mean customer at shares of its budget",
        columns,
    );
    for group in Group::all() {
        let group_params = params.group(group);
        let curve = mean_customer(group_params, params);
        let at = |share: f64| CellValue::number(required_quality(share * curve.c_max, &curve, params));
        table.rows.push(vec![
            CellValue::text(group.id()),
            CellValue::text(&group_params.name),
            CellValue::number(curve.c_max),
            at(0.0),
            at(0.25),
            at(0.5),
            at(0.75),
            at(1.0),
        ]);
    }
    let mut exhibit = LabReport::with_table("Participation curves", table);
    let shown = |is_enterprise: bool| {
        Group::all().filter(move |group| group.is_initially_known() && group.is_enterprise() == is_enterprise)
    };
    for (of, is_enterprise) in [("individuals", false), ("enterprises", true)] {
        exhibit.graphs.push(mean_curve_graph(of, shown(is_enterprise), params));
    }
    exhibit
        .with_note("The curve jumps at half the budget. Above the budget no quality is enough. Customers accept a plan whose quality is on or above their curve.")
        .with_note("`lab curves GROUP` shows differences within a group.")
}

fn mean_curve_graph(of: &str, groups: impl Iterator<Item = Group>, params: &Params) -> Graph {
    let series = groups.map(|group| {
        let curve = mean_customer(params.group(group), params);
        let share = |step: u32| f64::from(step) / f64::from(PRICE_STEPS);
        let point = |step| (share(step), required_quality(share(step) * curve.c_max, &curve, params));
        Series { name: group.id().to_owned(), points: (0..=PRICE_STEPS).map(point).collect() }
    });
    Graph {
        title: format!("Mean customers of {of} in the groups known on day 0"),
        summary: "Required quality rises with price, with a jump at half the budget".to_owned(),
        x_axis: GraphAxis { label: "price / budget", scale: AxisScale::Linear },
        y_axis: GraphAxis { label: "required quality", scale: AxisScale::Linear },
        series: series.collect(),
        form: GraphForm::Lines,
    }
}

/// Returns a report on the curve of a group's mean customer, and on the quality that satisfies 10 %, 50 % and 90 % of
/// the group's customers.
pub fn group_curve_report(group: Group, params: &Params) -> LabReport {
    let group_params = params.group(group);
    let curve = mean_customer(group_params, params);
    let sample = true_curve(group, params);
    let columns = vec![
        Column::number("price", "price", Measure::Dollars),
        Column::number("mean_customer", "mean customer", Measure::Number(3)),
        Column::number("tenth", "1 in 10", Measure::Number(3)),
        Column::number("median", "half", Measure::Number(3)),
        Column::number("ninetieth", "9 in 10", Measure::Number(3)),
    ];
    let caption =
        "Quality required by the mean customer, and quality at which shares of customers accept the price";
    let mut table = LabTable::new("curve", caption, columns);
    for point in sample.iter().step_by(PRICES_PER_ROW) {
        let mean_required_quality =
            (point.price <= curve.c_max).then(|| required_quality(point.price, &curve, params));
        table.rows.push(vec![
            CellValue::number(point.price),
            CellValue::number(mean_required_quality),
            CellValue::number(point.p10),
            CellValue::number(point.median),
            CellValue::number(point.p90),
        ]);
    }
    let mut exhibit =
        LabReport::with_table(format!("Participation curve of {}: {}", group.id(), group_params.name), table);
    let drawn = |name: &str, of: &dyn Fn(&novamind_insight::CurvePoint) -> f64| Series {
        name: name.to_owned(),
        points: sample.iter().map(|point| (point.price, of(point))).filter(|(_, y)| y.is_finite()).collect(),
    };
    let fine = (0..=PRICE_STEPS).map(|step| curve.c_max * f64::from(step) / f64::from(PRICE_STEPS));
    let mean = fine.map(|price| (price, required_quality(price, &curve, params))).collect();
    exhibit.graphs.push(Graph {
        title: format!("{}: quality required by price", group.id()),
        summary: "Required quality by price: the mean customer, and the quality at which 10 %, 50 % and 90 % of customers accept the price".to_owned(),
        x_axis: GraphAxis { label: "dollars a month", scale: AxisScale::Linear },
        y_axis: GraphAxis { label: "required quality", scale: AxisScale::Linear },
        series: vec![
            Series { name: "mean customer".to_owned(), points: mean },
            drawn("1 in 10", &|point| point.p10),
            drawn("half", &|point| point.median),
            drawn("9 in 10", &|point| point.p90),
        ],
        form: GraphForm::Lines,
    });
    exhibit.with_note("–: the price is above the budget of too many customers.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_match_the_simulator_curve() {
        let params = Params::bundled();
        let exhibit = all_curves_report(&params);
        let table = exhibit.table("curves").expect("a table");
        assert_eq!(table.rows.len(), 26);
        let s1 = mean_customer(params.group(Group::parse("S1").expect("a group")), &params);
        // Compare with reference customer X of docs/mechanics/customers/participation.md.
        assert_eq!((s1.steepness_left, s1.steepness_right, s1.c_max), (1.2, 2.8, 50.0));
        assert!((required_quality(20.0, &s1, &params) - 0.293083510).abs() < 1e-9);
        assert_eq!(exhibit.graphs.len(), 2);
    }

    #[test]
    fn quantile_curves_are_ordered_and_end_at_budgets() {
        let params = Params::bundled();
        let sample = true_curve(Group::parse("E2").expect("a group"), &params);
        assert!(sample.iter().all(|point| point.p10 <= point.median && point.median <= point.p90));
        assert!(sample.last().is_some_and(|point| point.p90.is_infinite()));
        let text = group_curve_report(Group::parse("E2").expect("a group"), &params).to_text(100);
        assert!(text.contains("Quality-First") && text.contains('–'), "{text}");
    }
}
