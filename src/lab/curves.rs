//! Participation curves: required quality by price (docs/laboratory/laws-and-curves.md).

use super::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation,
};
use novamind_insight::true_curve_of;
use novamind_world::customers::curve::{Curve, required_quality};
use novamind_world::identifiers::Group;
use novamind_world::params::{GroupParams, Params};

/// Number of price steps from 0 to the budget.
const STEPS: u32 = 100;
/// Sampled prices per table row.
const ROW_EVERY: usize = 5;

/// Returns a customer with the mean traits of a group.
fn mean_customer(own: &GroupParams, params: &Params) -> Curve {
    let bounds = &params.customer_generation;
    Curve {
        steepness_left: bounds.steepness_left_exp_scale + bounds.steepness_left_offset,
        steepness_right: bounds.steepness_right_exp_scale + bounds.steepness_right_offset,
        c_max: own.c_max_mean,
        q_min: own.q_min_mean,
        q_max: own.q_min_mean + own.q_range_mean,
    }
}

/// Returns the curves of the groups' mean customers, with prices as shares of the budget.
pub fn all_curves(params: &Params) -> Exhibit {
    let columns = vec![
        Column::words("group", "group"),
        Column::words("name", "name"),
        Column::numbers("budget", "budget", Measure::Dollars),
        Column::numbers("at_nothing", "at $0", Measure::Number(3)),
        Column::numbers("at_quarter", "at 1/4", Measure::Number(3)),
        Column::numbers("at_half", "at 1/2", Measure::Number(3)),
        Column::numbers("at_three_quarters", "at 3/4", Measure::Number(3)),
        Column::numbers("at_budget", "at budget", Measure::Number(3)),
    ];
    let mut table = Tabulation::new(
        "curves",
        "Required quality of each group's mean customer at shares of its budget",
        columns,
    );
    for group in Group::all() {
        let own = params.group(group);
        let curve = mean_customer(own, params);
        let at = |share: f64| Datum::number(required_quality(share * curve.c_max, &curve, params));
        table.rows.push(vec![
            Datum::words(group.id()),
            Datum::words(&own.name),
            Datum::number(curve.c_max),
            at(0.0),
            at(0.25),
            at(0.5),
            at(0.75),
            at(1.0),
        ]);
    }
    let mut exhibit = Exhibit::of("Participation curves", table);
    let shown = |is_enterprise: bool| {
        Group::all().filter(move |own| own.initially_known() && own.is_enterprise() == is_enterprise)
    };
    for (of, is_enterprise) in [("individuals", false), ("enterprises", true)] {
        exhibit.graphs.push(mean_graph(of, shown(is_enterprise), params));
    }
    exhibit
        .with_note("The curve jumps at half the budget. Above the budget no quality is enough. Customers accept a plan whose quality is on or above their curve.")
        .with_note("`lab curves GROUP` shows differences within a group.")
}

fn mean_graph(of: &str, groups: impl Iterator<Item = Group>, params: &Params) -> Graph {
    let series = groups.map(|group| {
        let curve = mean_customer(params.group(group), params);
        let share = |step: u32| f64::from(step) / f64::from(STEPS);
        let point = |step| (share(step), required_quality(share(step) * curve.c_max, &curve, params));
        Series { name: group.id().to_owned(), points: (0..=STEPS).map(point).collect() }
    });
    Graph {
        title: format!("Mean customers of {of} in the groups known on day 0"),
        summary: "Required quality rises with price, with a jump at half the budget".to_owned(),
        across: GraphAxis { label: "price / budget", scale: AxisScale::Linear },
        up: GraphAxis { label: "required quality", scale: AxisScale::Linear },
        series: series.collect(),
        form: GraphForm::Lines,
    }
}

/// Returns the curve of a group's mean customer and the quality that satisfies 10 %, 50 % and 90 % of its customers.
pub fn curve_of(group: Group, params: &Params) -> Exhibit {
    let own = params.group(group);
    let curve = mean_customer(own, params);
    let sample = true_curve_of(group, params);
    let columns = vec![
        Column::numbers("price", "price", Measure::Dollars),
        Column::numbers("mean_customer", "mean customer", Measure::Number(3)),
        Column::numbers("tenth", "1 in 10", Measure::Number(3)),
        Column::numbers("median", "half", Measure::Number(3)),
        Column::numbers("ninetieth", "9 in 10", Measure::Number(3)),
    ];
    let caption = "Quality required by the mean customer, and quality that satisfies shares of customers";
    let mut table = Tabulation::new("curve", caption, columns);
    for point in sample.iter().step_by(ROW_EVERY) {
        let of_mean = (point.price <= curve.c_max).then(|| required_quality(point.price, &curve, params));
        table.rows.push(vec![
            Datum::number(point.price),
            Datum::number(of_mean),
            Datum::number(point.tenth),
            Datum::number(point.median),
            Datum::number(point.ninetieth),
        ]);
    }
    let mut exhibit = Exhibit::of(format!("Participation curve of {}: {}", group.id(), own.name), table);
    let drawn = |name: &str, of: &dyn Fn(&novamind_insight::CurvePoint) -> f64| Series {
        name: name.to_owned(),
        points: sample.iter().map(|point| (point.price, of(point))).filter(|(_, y)| y.is_finite()).collect(),
    };
    let fine = (0..=STEPS).map(|step| curve.c_max * f64::from(step) / f64::from(STEPS));
    let mean = fine.map(|price| (price, required_quality(price, &curve, params))).collect();
    exhibit.graphs.push(Graph {
        title: format!("{}: quality required by price", group.id()),
        summary: "Mean customer, and quality that satisfies shares of customers".to_owned(),
        across: GraphAxis { label: "dollars a month", scale: AxisScale::Linear },
        up: GraphAxis { label: "required quality", scale: AxisScale::Linear },
        series: vec![
            Series { name: "mean customer".to_owned(), points: mean },
            drawn("1 in 10", &|point| point.tenth),
            drawn("half", &|point| point.median),
            drawn("9 in 10", &|point| point.ninetieth),
        ],
        form: GraphForm::Lines,
    });
    exhibit.with_note("– the price is above the budget of too many customers.")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_are_the_curve_of_the_world() {
        let params = Params::shipped();
        let exhibit = all_curves(&params);
        let table = exhibit.table("curves").expect("a table");
        assert_eq!(table.rows.len(), 26);
        let s1 = mean_customer(params.group(Group::parse("S1").expect("a group")), &params);
        // Reference customer X of docs/mechanics/customers/participation.md.
        assert_eq!((s1.steepness_left, s1.steepness_right, s1.c_max), (1.2, 2.8, 50.0));
        assert!((required_quality(20.0, &s1, &params) - 0.293083510).abs() < 1e-9);
        assert_eq!(exhibit.graphs.len(), 2);
    }

    #[test]
    fn shares_of_customers_are_ordered_and_end_at_budgets() {
        let params = Params::shipped();
        let sample = true_curve_of(Group::parse("E2").expect("a group"), &params);
        assert!(sample.iter().all(|point| point.tenth <= point.median && point.median <= point.ninetieth));
        assert!(sample.last().is_some_and(|point| point.ninetieth.is_infinite()));
        let text = curve_of(Group::parse("E2").expect("a group"), &params).as_text(100);
        assert!(text.contains("Quality-First") && text.contains('–'), "{text}");
    }
}
