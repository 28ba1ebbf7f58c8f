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
    let mut session = begin_company(runs, mode, seed);
    for week in 0..=WEEKS_BEFORE_CHANGE {
        if let (true, Some((tool, arguments))) = (week == WEEKS_BEFORE_CHANGE, &change) {
            change_setting(&mut session, tool, arguments);
        }
        play_week(&mut session);
    }
    session
}

/// Creates a run with prices, quotas, advertising and running costs.
pub(crate) fn begin_company(runs: &Path, mode: Mode, seed: u64) -> Session {
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
        change_setting(&mut session, tool, &arguments);
    }
    session
}

pub(crate) fn change_setting(session: &mut Session, tool: &str, arguments: &Value) {
    session.call(tool, arguments, Via::Script).unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
}

pub(crate) fn play_week(session: &mut Session) {
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week");
}

/// Plays a debug run in which every enterprise with an open thread receives an offer each week.
pub(crate) fn play_weeks_with_offers(runs: &Path) -> Session {
    let ads = json!({"E1": 4000, "E2": 4000, "E3": 4000});
    let mut session = play_weeks(runs, Mode::Debug, 3, None);
    let development = json!({"E1": 4000, "E2": 5000, "E3": 5000});
    change_setting(&mut session, "set_targeted_dev_spend", &development);
    change_setting(&mut session, "set_targeted_ad_spend", &json!({"social_media": ads, "linkedin": ads}));
    for _ in 0..8 {
        let threads = &session.debug_hidden_state().expect("a debug run").world().enterprise.threads;
        let open = threads.iter().filter(|thread| thread.is_open()).map(|thread| thread.customer);
        let deals: Vec<_> = open.map(|customer| json!([customer, [["B", 20], ["C", 50]]])).collect();
        if !deals.is_empty() {
            change_setting(&mut session, "send_enterprise_deal", &json!({ "deals": deals }));
        }
        play_week(&mut session);
    }
    session
}
