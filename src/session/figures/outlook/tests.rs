use super::*;
use novamind_record::figures::CategoryTotals;

const HORIZONS: [u32; 4] = [7, 28, 84, 182];
const PERIOD: usize = 30;

/// Returns weeks with these payments and the number of subscribers who pay them.
fn weeks_with_payments(payments: &[f64]) -> Vec<WeekFigures> {
    let week = |(at, paid): (usize, &f64)| {
        let mut booked = CategoryTotals::default();
        booked.add(Category::SubscriptionPayment, *paid);
        WeekFigures {
            day: 7 * (at as u32 + 1),
            days_run: 7,
            booked,
            individual_subscribers: (*paid / 10.0) as u32,
            recurring_revenue: *paid * PERIOD as f64 / 7.0,
            ..WeekFigures::default()
        }
    };
    payments.iter().enumerate().map(week).collect()
}

fn costs(total: f64) -> CommittedCosts {
    CommittedCosts { total, advertising: 0.0 }
}

/// Returns the outlook of a company that is paid the same amount every day.
fn steady_outlook(cash: f64, daily_bill: f64, committed: f64) -> Outlook {
    let calendar =
        BillingCalendar { individuals: vec![daily_bill; PERIOD], ..BillingCalendar::new(PERIOD as u32) };
    let weeks = weeks_with_payments(&[7.0 * daily_bill; 12]);
    Outlook::new(cash, costs(committed), &calendar, &weeks, &HORIZONS)
}

#[test]
fn large_change_of_advertising_is_stated() {
    let change = |spent: f64, now: f64| {
        let mut week = weeks_with_payments(&[500.0]).remove(0);
        week.booked.add(Category::Advertising, -7.0 * spent);
        AdvertisingChange::since(&[week], now).map(AdvertisingChange::added)
    };
    assert_eq!(change(0.0, 0.0), None);
    assert_eq!(change(1_000.0, 1_200.0), None);
    assert_eq!(change(1_000.0, 1_300.0), Some(300.0));
    assert_eq!(change(1_000.0, 0.0), Some(-1_000.0));
    assert_eq!(change(0.0, 50.0), Some(50.0));
    assert_eq!(AdvertisingChange::since(&[], 50.0), None);
}

#[test]
fn stage_follows_age_income_and_advertising() {
    for (payments, advertises, stage) in [
        (&[][..], false, GrowthStage::Start),
        (&[][..], true, GrowthStage::Launching),
        (&[0.0; 4], true, GrowthStage::Launching),
        (&[0.0; 4], false, GrowthStage::Idle),
        (&[0.0; 9], true, GrowthStage::Idle),
        (&[5.0; 4], true, GrowthStage::Young),
        (&[0.0, 0.0, 0.0, 0.0, 5.0, 5.0], false, GrowthStage::Surging),
        (&[5.0, 5.0, 6.0, 6.0, 12.0, 12.0], false, GrowthStage::Surging),
        (&[5.0, 5.0, 6.0, 6.0, 8.0, 8.0], false, GrowthStage::Growing),
        (&[5.0; 6], false, GrowthStage::Steady),
        (&[8.0, 8.0, 6.0, 6.0, 5.0, 5.0], false, GrowthStage::Shrinking),
    ] {
        assert_eq!(
            GrowthStage::from_weeks(&weeks_with_payments(payments), advertises),
            stage,
            "{payments:?}"
        );
    }
}

#[test]
fn subscribers_pay_on_their_billing_dates() {
    let mut calendar = BillingCalendar::new(PERIOD as u32);
    calendar.individuals[9] = 1_000.0;
    let weeks = weeks_with_payments(&[100.0; 6]);
    let outlook = Outlook::new(50_000.0, costs(10.0), &calendar, &weeks, &HORIZONS);
    let gain = |day: u32| outlook.expected_cash(day) - outlook.expected_cash(day - 1);
    assert!((1..10).chain(11..40).all(|day| (gain(day) + 10.0).abs() < 1e-9));
    assert!(gain(10) > 600.0 && gain(10) < 990.0, "some cancel instead of paying: {}", gain(10));
    assert!(gain(40) > 0.0 && gain(40) < gain(10), "the others pay again after 30 days: {}", gain(40));
}

#[test]
fn company_without_history_only_has_committed_costs() {
    let outlook = Outlook::new(1e6, costs(5_585.0), &BillingCalendar::new(PERIOD as u32), &[], &HORIZONS);
    assert_eq!(outlook.stage, GrowthStage::Start);
    assert_eq!(outlook.expected_cash(28), 1e6 - 28.0 * 5_585.0);
    let expected = outlook.runway(500).expected.expect("cash shrinks");
    assert!((expected - 1e6 / 5_585.0 / 7.0).abs() < 1e-9, "{expected}");
    assert_eq!(outlook.runway(100).expected, None, "the run ends earlier");
}

#[test]
fn cash_is_zero_after_bankruptcy() {
    let outlook = Outlook::new(1_000.0, costs(1_000.0), &BillingCalendar::new(PERIOD as u32), &[], &HORIZONS);
    let late = outlook.forecast(182);
    assert_eq!((late.lower, late.point), (0.0, 0.0));
    assert!(late.upper >= 0.0);
}

#[test]
fn ranges_are_coherent_across_horizons() {
    let calendar = BillingCalendar::new(PERIOD as u32);
    let growing = BillingCalendar {
        individuals: vec![900.0; PERIOD],
        signed_up: [20_000.0, 16_000.0, 12_000.0, 9_000.0],
        ..calendar.clone()
    };
    let start = Outlook::new(1e6, costs(4_000.0), &calendar, &[], &HORIZONS);
    let fast = Outlook::new(
        1e6,
        costs(4_000.0),
        &growing,
        &weeks_with_payments(&[100.0, 500.0, 900.0, 2_000.0, 4_000.0, 7_000.0]),
        &HORIZONS,
    );
    for outlook in [start, fast, steady_outlook(2e5, 900.0, 1_500.0), steady_outlook(2e5, 0.0, 1_500.0)] {
        let stage = outlook.stage;
        for day in 1..=182 {
            let (low, high) = outlook.range(day, Level::Central95);
            let (inner_low, inner_high) = outlook.range(day, Level::Central80);
            assert!(low <= inner_low && inner_low <= outlook.expected_cash(day), "{stage:?} {day}");
            assert!(high >= inner_high && inner_high >= outlook.expected_cash(day), "{stage:?} {day}");
            let ([below, above], [earlier_below, earlier_above]) =
                (outlook.width(day, Level::Central95), outlook.width(day - 1, Level::Central95));
            assert!(below >= earlier_below && above >= earlier_above, "{stage:?}: day {day} is narrower");
        }
        // The low end can rise only as much as the expected cash.
        for (short, long) in [(7, 28), (28, 84), (84, 182)] {
            let rise = outlook.range(long, Level::Central95).0 - outlook.range(short, Level::Central95).0;
            let expected = outlook.expected_cash(long) - outlook.expected_cash(short);
            assert!(rise <= expected.max(0.0) + 1e-6, "{stage:?}: {short} to {long} days: {rise} {expected}");
        }
    }
}

#[test]
fn ranges_scale_with_the_company() {
    let width = |scale: f64| {
        let outlook = steady_outlook(2e5 * scale, 900.0 * scale, 500.0 * scale);
        outlook.range(28, Level::Central95).1 - outlook.expected_cash(28)
    };
    assert!((width(100.0) / width(1.0) - 100.0).abs() < 5.0, "{} {}", width(100.0), width(1.0));
}

#[test]
fn runway_is_a_range_around_the_expected_week() {
    let shrinking = steady_outlook(60_000.0, 300.0, 1_500.0);
    let runway = shrinking.runway(500);
    let (earliest, expected) = (runway.earliest.expect("low"), runway.expected.expect("expected"));
    assert!(earliest < expected && runway.latest.is_none_or(|latest| latest > expected), "{runway:?}");
    let saving = shrinking.required_saving(84);
    assert!(saving > 0.0);
    let weeks = shrinking.runway_with_saving(saving * 1.001, 500);
    assert!(weeks.is_none_or(|weeks| weeks >= 12.0), "{weeks:?}");
    let rich = steady_outlook(1e9, 300.0, 1_500.0).runway(500);
    assert_eq!((rich.expected, rich.describe_weeks().as_deref()), (None, Some("26+")));
    assert_eq!(steady_outlook(1e9, 300.0, 1_500.0).runway(90).describe_weeks(), None);
    for (earliest, latest, text) in
        [(Some(9.2), Some(19.9), "9–19"), (Some(9.2), Some(9.7), "9"), (Some(5.0), None, "5+")]
    {
        let runway = Runway { earliest, expected: None, latest, is_cut: true };
        assert_eq!(runway.describe_weeks().as_deref(), Some(text));
    }
}

#[test]
fn one_time_costs_do_not_change_the_expected_flows() {
    let [before, after] = [200_000.0, 150_000.0].map(|cash| steady_outlook(cash, 900.0, 500.0));
    assert_eq!(before.expected_flows(28), after.expected_flows(28));
    let fallen = before.expected_cash(7) - after.expected_cash(7);
    assert!((fallen - 50_000.0).abs() < 1e-6, "{fallen}");
}

#[test]
fn from_errors_measures_coverage_on_other_companies() {
    let error = |company: usize, error: f64| ForecastError {
        company,
        stage: GrowthStage::Steady,
        horizon: 7,
        error,
        expected: 10.0,
    };
    let even = |at: usize| error(at, (at / 2) as f64 / 500.0 - 0.4);
    let intervals = ErrorIntervals::from_errors(&(0..1000).map(even).collect::<Vec<_>>(), 1000);
    let steady = intervals.stage_interval(GrowthStage::Steady, 7).expect("an interval");
    assert_eq!((steady.companies, steady.forecasts), (1000, 1000));
    assert!((steady.lower_95 + 0.375).abs() < 0.01 && (steady.upper_80 - 0.5).abs() < 0.01, "{steady:?}");
    assert!((steady.covered_95 - 0.95).abs() < 0.01 && (steady.covered_80 - 0.8).abs() < 0.01, "{steady:?}");
    // The halves differ, so the range of one half does not contain the outcomes of the other half.
    let apart: Vec<ForecastError> =
        (0..1000).map(|at| error(at, if at % 2 == 0 { 1.0 } else { -1.0 })).collect();
    let intervals = ErrorIntervals::from_errors(&apart, 1000);
    assert_eq!(intervals.stage_interval(GrowthStage::Steady, 7).map(|steady| steady.covered_95), Some(0.0));
    assert_eq!(intervals.describe_coverage(GrowthStage::Steady, 500), None, "too few outcomes were covered");
    assert_eq!(intervals.describe_coverage(GrowthStage::Idle, 500), None, "nothing was measured");
}

#[test]
fn bundled_ranges_cover_the_outcomes_of_every_stage() {
    let bundled = ErrorIntervals::bundled();
    assert!(bundled.companies >= 500, "{}", bundled.companies);
    for stage in GrowthStage::ALL {
        let text = bundled.describe_coverage(stage, 500).unwrap_or_else(|| panic!("{stage:?}"));
        assert!(text.contains(stage.describe()) && text.contains('%'), "{text}");
        for horizon in HORIZONS {
            let interval =
                bundled.stage_interval(stage, horizon).unwrap_or_else(|| panic!("{stage:?} {horizon}"));
            assert!((0.9..=1.0).contains(&interval.covered_95), "{interval:?}");
            assert!((0.75..=1.0).contains(&interval.covered_80), "{interval:?}");
            let ends = [interval.lower_95, interval.lower_80, 0.0, interval.upper_80, interval.upper_95];
            assert!(ends.is_sorted(), "{interval:?}");
        }
    }
}
