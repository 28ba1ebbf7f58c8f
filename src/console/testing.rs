//! What tests of the console start from.

use serde_json::json;

use super::company::Company;
use crate::session::{Configuration, NewRun, Session, Via};

/// A company on day 0.
pub fn company() -> Company {
    Company::of(&session())
}

/// A run in memory on day 0.
pub fn session() -> Session {
    Session::create(NewRun::default(), &Configuration::shipped()).expect("a run in memory")
}

/// A run in memory with a shop that has been open for some weeks.
pub fn open_shop(weeks: u32) -> Session {
    let mut session = session();
    let calls = [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"A": 1, "B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000})),
        ("set_capacity_tier", json!({"tier": 1})),
        ("set_daily_spend", json!({"operations": 200, "development": 200})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 750}}})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 6000}})),
        ("start_research_project", json!({"tier": 1})),
    ];
    for (tool, arguments) in calls {
        session.call(tool, &arguments, Via::Form).expect(tool);
    }
    for _ in 0..weeks {
        let forecasts = session.naive_forecasts();
        session.advance("a test", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    session
}
