//! Runs in memory for tests.

use serde_json::{Value, json};

use novamind_record::folder::configuration::{Configuration, DEFAULT_SCENARIO};
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Session, Storage};

/// Returns the session of a new run in memory.
pub fn new_session() -> Session {
    let new = NewRun { storage: Storage::Memory, ..NewRun::default() };
    Session::create(new, &Configuration::bundled()).expect("a run in memory")
}

/// Returns the session of a run in memory that was played for some weeks with typical settings.
pub fn played_session(weeks: usize) -> Session {
    played_session_of(DEFAULT_SCENARIO, weeks)
}

/// Returns a session like [`played_session`], but in the given scenario.
pub fn played_session_of(scenario: &str, weeks: usize) -> Session {
    let (seed, days, scenario) = (Some(7), Some(200), scenario.to_owned());
    let new = NewRun { seed, days, scenario, storage: Storage::Memory, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    if weeks > 0 {
        apply_initial_settings(&mut session);
    }
    for _ in 0..weeks {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    session
}

fn apply_initial_settings(session: &mut Session) {
    let calls: [(&str, Value); 8] = [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60000, "B": 250000, "C": 1200000})),
        ("set_daily_spend", json!({"operations": 200, "development": 200})),
        ("set_targeted_dev_spend", json!({"S1": 6000})),
        ("set_targeted_ad_spend", json!({"content_marketing": {"S1": 750}, "linkedin": {"E1": 300}})),
        ("set_capacity_tier", json!({"tier": 2})),
        ("start_research_project", json!({"tier": 1})),
    ];
    for (tool, arguments) in calls {
        session.call(tool, &arguments, Via::Form).unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
    }
}

/// Returns the session of a run in memory in which enterprises wait for offers.
pub fn session_with_negotiations() -> Session {
    let new =
        NewRun { seed: Some(11), cash: Some(20_000_000.0), storage: Storage::Memory, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    let ads = json!({"E1": 4000, "E2": 4000, "E3": 4000});
    for (tool, arguments) in [
        ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
        ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
        ("set_usage_quotas", json!({"A": 300, "B": 30_000, "C": 1_000_000})),
        ("set_targeted_dev_spend", json!({"E1": 4000, "E2": 5000, "E3": 5000})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"social_media": ads, "linkedin": ads}})),
        ("set_capacity_tier", json!({"tier": 5})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
    }
    for _ in 0..20 {
        if session.company().observe().waiting.len() >= 3 {
            return session;
        }
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
    panic!("no enterprise asked for an offer in twenty weeks");
}
