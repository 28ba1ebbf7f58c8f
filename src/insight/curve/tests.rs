//! The explorer agrees with the simulator and shows true traits only if inspections are permitted.

use serde_json::json;

use super::explorer::{CurveBasis, CurveExplorer};
use crate::curve::access::CurveInspection;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Session, Storage};
use novamind_world::identifiers::{ByPlan, Group};

fn create_run(mode: Mode, overrides: &[(&str, &str)]) -> Session {
    let new = NewRun {
        seed: Some(7),
        mode,
        participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
        overrides: overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect(),
        storage: Storage::Memory,
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    for (tool, arguments) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_usage_quotas", json!({"A": 60, "B": 300, "C": 1200})),
    ] {
        session.call(tool, &arguments, Via::Script).expect("a setting");
    }
    session
}

fn group_s1() -> Group {
    Group::parse("S1").expect("a group")
}

fn explorer(session: &mut Session, group: &str) -> CurveExplorer {
    CurveExplorer::open(session, Group::parse(group).expect("a group")).expect("an explorer")
}

/// Formats all values that a curve explorer shows.
fn format_explorer(curve_explorer: &CurveExplorer) -> String {
    let curve_outcomes: Vec<_> = [(12.0, 0.2), (30.0, 0.4), (90.0, 0.9)]
        .iter()
        .map(|(price, quality)| curve_explorer.outcome_at(*price, *quality))
        .collect();
    format!(
        "{:?} {:?} {:?} {curve_outcomes:?}",
        curve_explorer.basis,
        curve_explorer.points,
        curve_explorer.outcome_for_plans(&curve_explorer.plans)
    )
}

/// Conversions of the first week in the simulator, with one price on all plans
/// (configs/lessons/price-follows-quality.toml).
#[test]
fn true_curve_matches_simulated_conversion_within_two_points() {
    let mut session = create_run(Mode::Debug, &[]);
    let curve_explorer = explorer(&mut session, "S1");
    assert_eq!(curve_explorer.basis, CurveBasis::Truth { day: 0 });
    for (price, simulated) in [
        (12.0, [0.37, 0.83, 0.96]),
        (20.0, [0.18, 0.69, 0.80]),
        (30.0, [0.06, 0.51, 0.69]),
        (40.0, [0.02, 0.35, 0.56]),
    ] {
        for (quality, conversion) in [0.2, 0.4, 0.6].into_iter().zip(simulated) {
            let curve_outcome = curve_explorer.outcome_at(price, quality);
            let off = curve_outcome.conversion.likely - conversion;
            assert!(off.abs() <= 0.02, "${price} at {quality}: {off}");
            assert_eq!(curve_outcome.conversion.least, curve_outcome.conversion.most);
            let revenue = curve_outcome.revenue_per_lead.expect("individuals").likely;
            assert!((revenue - price * curve_outcome.conversion.likely).abs() < 1e-9);
        }
    }
}

#[test]
fn explorer_of_an_unfinished_run_depends_only_on_estimates() {
    let hidden = [
        ("group.S1.c_max_std", "1"),
        ("group.S1.q_min_std", "0.3"),
        ("group.S1.q_range_mean", "0.95"),
        ("group.S1.q_range_std", "0.001"),
        ("group.S1.usage_demand_std", "1"),
        ("participation.curve_gain", "2"),
        ("customer_generation.steepness_left_offset", "3"),
        ("customer_generation.c_max_min", "1"),
        ("quality.initial_decision_noise_min", "0.2"),
    ];
    for (key, value) in hidden {
        let curve_explorer = explorer(&mut create_run(Mode::Lesson, &[(key, value)]), "S1");
        assert_eq!(
            format_explorer(&curve_explorer),
            format_explorer(&explorer(&mut create_run(Mode::Lesson, &[]), "S1")),
            "{key}"
        );
        // In a debug run the parameter changes the curve. The test would therefore detect a curve that depends on the
        // parameter.
        let truth = explorer(&mut create_run(Mode::Debug, &[(key, value)]), "S1");
        let usual = explorer(&mut create_run(Mode::Debug, &[]), "S1");
        let alike = key == "group.S1.usage_demand_std";
        assert!(alike || format_explorer(&truth) != format_explorer(&usual), "{key}");
    }
}

#[test]
fn unfinished_runs_show_ranges_and_finished_runs_true_values() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = create_run(mode, &[]);
        let curve_explorer = explorer(&mut session, "S1");
        assert_eq!(curve_explorer.basis, CurveBasis::Estimates { level: 1, noise: 0.65, as_of: 0 });
        let curve_outcome = curve_explorer.outcome_for_plans(&curve_explorer.plans);
        assert!(
            curve_outcome.conversion.least <= curve_outcome.conversion.likely
                && curve_outcome.conversion.likely <= curve_outcome.conversion.most
        );
        assert!(curve_outcome.conversion.least < curve_outcome.conversion.most);
        let wide = curve_explorer.points.iter().all(|point| {
            let (least, most) = point.median_range;
            least <= point.median && point.median <= most && point.p10 <= point.median
        });
        assert!(wide);
        let unknown = Group::parse("D_S05").expect("a group");
        let refused = CurveExplorer::open(&mut session, unknown).expect_err("not discovered");
        assert_eq!(refused.code, "group_not_discovered");
        assert_eq!(
            CurveInspection::record(&mut session, group_s1(), 0).expect_err("hidden").code,
            "not_in_this_mode"
        );
    }
}

#[test]
fn outcome_is_computed_for_current_and_changed_plans() {
    let mut session = create_run(Mode::Debug, &[]);
    let curve_explorer = explorer(&mut session, "S1");
    let now = curve_explorer.outcome_for_plans(&curve_explorer.plans);
    let takers: f64 = now.plan_shares.expect("individuals").iter().sum();
    assert!((takers - now.conversion.likely).abs() < 1e-12);
    let dearer = ByPlan(
        curve_explorer
            .plans
            .0
            .map(|plan| super::explorer::PlanPoint { list_price: 3.0 * plan.list_price, ..plan }),
    );
    assert!(curve_explorer.outcome_for_plans(&dearer).conversion.likely < now.conversion.likely);
    let better = ByPlan(
        curve_explorer.plans.0.map(|plan| super::explorer::PlanPoint { quality: plan.quality + 0.3, ..plan }),
    );
    assert!(curve_explorer.outcome_for_plans(&better).conversion.likely > now.conversion.likely);
    let companies = explorer(&mut session, "E1");
    let curve_outcome = companies.outcome_for_plans(&companies.plans);
    assert_eq!((curve_outcome.revenue_per_lead, curve_outcome.plan_shares), (None, None));
}

#[test]
fn price_axis_covers_plans_and_curve_rises() {
    let curve_explorer = explorer(&mut create_run(Mode::Debug, &[]), "S1");
    let last = curve_explorer.points.last().expect("points");
    assert!(last.price >= 1.2 * 55.0 && last.price % 10.0 == 0.0, "{}", last.price);
    assert!(curve_explorer.points.windows(2).all(|pair| pair[0].median <= pair[1].median));
    assert!(last.p90.is_infinite(), "a tenth of the budgets is below the last price");
    assert_eq!(super::example::example_curve().len(), 51);
}
