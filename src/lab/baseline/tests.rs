use super::*;
use crate::experiment::{Arm, ExperimentResults, test_kit};

/// Plays all configurations for a few days and returns the results.
fn play_configurations(points: &[GridPoint], seeds: &[u64], days: u32) -> ExperimentResults {
    let arms = points.iter().map(|grid_point| {
        let mut arm = Arm::new(grid_point.label(), grid_point.policy.clone());
        arm.spec.stop_after_day = Some(days);
        arm
    });
    test_kit::play_arms(arms.collect(), seeds.iter().copied())
}

#[test]
fn shared_runs_are_equal_unless_cash_is_between_floors() {
    let grid = PolicyGrid::find(PAPER_GRID).expect("a grid");
    let points = &grid.configurations;
    let representatives = representative_configurations(points);
    let expected: Vec<usize> = (0..24).map(|at| at / 2 * 2).collect();
    assert_eq!(representatives, expected);
    // With the configuration mid / S1 / light, cash falls below $300,000 within 350 days. With mid / S1 / heavy, cash
    // stays above $300,000 for 50 days.
    let (light, heavy) = (&points[12..14], &points[16..18]);
    for (pair, days, shared) in [(light, 350, false), (heavy, 49, true)] {
        let results = play_configurations(pair, &[1], days);
        let (low, high) = (&results.by_arm[0][0], &results.by_arm[1][0]);
        assert_eq!(is_shared_run(&pair[0].policy, &pair[1].policy, 1e6, low), shared, "{}", pair[0].label());
        assert_eq!(low.state_hash == high.state_hash, shared, "{}", pair[0].label());
    }
}

#[test]
fn baseline_report_shows_paper_columns_for_one_seed_and_spread_for_many() {
    let grid = PolicyGrid::find(PAPER_GRID).expect("a grid");
    let few: Vec<GridPoint> = [0, 12].map(|at: usize| grid.configurations[at].clone()).into();
    let few = PolicyGrid { configurations: few, ..grid };
    let one = baseline_report(&few, true, &play_configurations(&few.configurations, &[1], 28));
    let text = one.to_text(100);
    assert!(text.contains("survival") && text.contains("peak") && text.contains("15,756,408"), "{text}");
    assert!(!text.contains("Kendall"), "{text}");
    let two = baseline_report(&few, false, &play_configurations(&few.configurations, &[1, 2], 28));
    let text = two.to_text(100);
    assert!(text.contains("quartile") && text.contains("Kendall") && !text.contains("15,756"), "{text}");
    let rows = |name: &str| two.table(name).expect(name).to_csv_rows();
    const AXES: [&str; 4] = ["price_book", "target", "spend", "floor"];
    for name in ["configurations", "stability", "runs"] {
        assert_eq!(rows(name)[0][..4], AXES, "{name}");
        assert_eq!(rows(name)[1][..4].iter().filter(|level| level.contains('/')).count(), 0, "{name}");
    }
    let seeds = rows("seeds");
    assert_eq!(
        (seeds.len(), &seeds[0][1..5], seeds[0][5].as_str()),
        (1 + 2, &AXES.map(str::to_owned)[..], "equal")
    );
}
