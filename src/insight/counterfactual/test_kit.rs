//! A played company for tests of re-simulation.

use std::path::Path;

use serde_json::{Value, json};

use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Session, Storage};

/// Number of weeks that are played before a change.
pub(crate) const WEEKS_BEFORE_CHANGE: u32 = 7;

/// Plays several weeks of a company with customers, makes a change, and plays one more week.
pub(crate) fn play_weeks(runs: &Path, mode: Mode, seed: u64, change: Option<(&str, Value)>) -> Session {
    let new = NewRun {
        seed: Some(seed),
        days: Some(120),
        mode,
        cash: Some(50_000_000.0),
        storage: Storage::Runs(runs.to_owned()),
        projection: false,
        sync_calls: false,
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    for (tool, arguments) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"A": 2, "B": 3, "C": 4})),
        ("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000})),
        ("set_daily_spend", json!({"operations": 400, "development": 2000})),
        ("set_targeted_ad_spend", json!({"search_ads": {"S1": 9000, "S2": 9000}, "linkedin": {"S3": 6000}})),
        ("set_capacity_tier", json!({"capacity_tier": 2})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
    }
    for week in 0..=WEEKS_BEFORE_CHANGE {
        if let (true, Some((tool, arguments))) = (week == WEEKS_BEFORE_CHANGE, &change) {
            session
                .call(tool, arguments, Via::Script)
                .unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
        }
        let forecasts = session.company().naive_forecasts();
        session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
    session
}
