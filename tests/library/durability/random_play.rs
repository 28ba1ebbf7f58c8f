//! Random actions, which are drawn from a seed. Some actions are invalid and must be rejected.

use novamind::record::trajectory::record::Via;
use novamind::session::Session;
use serde_json::{Value, json};

use crate::support::company;
use crate::support::dice::Dice;

const GROUPS: [&str; 8] = ["S1", "S2", "S3", "E1", "E2", "E3", "D_S01", "D_E01"];
const CHANNELS: [&str; 5] =
    ["social_media", "search_ads", "linkedin", "content_marketing", "referral_program"];
const SCREENS: [&str; 4] = ["overview", "cash", "inbox", "sql"];
const QUERIES: [&str; 3] =
    ["SELECT COUNT(*) FROM customers", "SELECT nothing FROM ledger", "SELECT * FROM service_day"];
const PLANS: [&str; 3] = ["A", "B", "C"];

/// A random action of the player.
#[derive(Debug, Clone)]
pub enum RandomAction {
    /// A tool call.
    Call(&'static str, Value),
    /// Undo of the last setting.
    Undo,
    /// An SQL query.
    Query(&'static str),
    /// A change to the notes.
    Memo(String),
    /// A view of a screen.
    View(&'static str),
}

impl RandomAction {
    /// Returns a random action. `waiting` contains the numbers of the enterprises that wait for an answer.
    pub fn random(dice: &mut Dice, waiting: &[u32]) -> RandomAction {
        match dice.roll(24) {
            0 => RandomAction::Undo,
            1 => RandomAction::Query(QUERIES[dice.roll(QUERIES.len())]),
            2 => RandomAction::Memo(format!("plan {}: größer, if cash allows", dice.roll(1000))),
            3 => RandomAction::View(SCREENS[dice.roll(SCREENS.len())]),
            _ => {
                let (tool, args) = random_call(dice, waiting);
                RandomAction::Call(tool, args)
            }
        }
    }

    /// Performs the action. A rejection is a valid result.
    pub fn apply(&self, session: &mut Session) {
        match self {
            RandomAction::Call(tool, args) => drop(session.call(tool, args, Via::Form)),
            RandomAction::Undo => drop(session.undo(Via::Form)),
            RandomAction::Query(sql) => drop(session.query(sql)),
            RandomAction::Memo(text) => drop(session.set_notes(text)),
            RandomAction::View(screen) => session.activity().record_view(screen, "overview", 1500),
        }
    }
}

fn random_amount(dice: &mut Dice, most: usize) -> f64 {
    dice.roll(most * 2) as f64 / 2.0
}

fn random_amounts_by_group(dice: &mut Dice, most: usize) -> Value {
    let count = dice.roll(4);
    (0..count).map(|_| ((*dice.pick(&GROUPS)).to_owned(), json!(random_amount(dice, most)))).collect()
}

fn random_call(dice: &mut Dice, waiting: &[u32]) -> (&'static str, Value) {
    let plan = *dice.pick(&PLANS);
    let group = *dice.pick(&GROUPS[..7]);
    let name = *dice.pick(&["weekly", "churn", "leads"]);
    match dice.roll(21) {
        0..=2 => (
            "set_prices",
            json!({ "A": random_amount(dice, 30), "B": 10.0 + random_amount(dice, 40), plan: random_amount(dice, 90) }),
        ),
        3 => ("set_model_tiers", json!({ plan: dice.roll(7) })),
        4 => ("set_usage_quotas", json!({ "A": 1000 * dice.roll(90), "B": 250_000, "C": 1_200_000 })),
        5..=6 => (
            "set_daily_spend",
            json!({ "operations": random_amount(dice, 900), "development": random_amount(dice, 600) }),
        ),
        7..=9 => {
            let spend: Value = (0..2)
                .map(|_| ((*dice.pick(&CHANNELS)).to_owned(), random_amounts_by_group(dice, 3000)))
                .collect();
            ("set_targeted_ad_spend", json!({ "targeted_spend": spend }))
        }
        10 => ("set_targeted_dev_spend", json!({ "targeted_spend": random_amounts_by_group(dice, 6000) })),
        11 => (
            "set_targeted_ops_spend",
            json!({ "by_group": random_amounts_by_group(dice, 500), "by_plan": { plan: random_amount(dice, 90) } }),
        ),
        12 => (
            "set_promotion",
            json!({ "global_discount": random_amount(dice, 4), "by_group": random_amounts_by_group(dice, 5) }),
        ),
        13 => ("set_ads_strength", json!({ "global_strength": random_amount(dice, 1) })),
        14 => ("set_capacity_tier", json!({ "tier": dice.roll(8) })),
        15 => ("research_market", json!({})),
        16 => ("research_group", json!({ "group_id": group })),
        17 => ("start_research_project", json!({ "tier": 1 + dice.roll(3) })),
        18 => {
            let posts = [
                "We answer every issue within a day.",
                "New: a larger quota for plan B at the same price.",
                "",
            ];
            ("post_social_media", json!({ "content": dice.pick(&posts) }))
        }
        19 => {
            ("register_daily_calculation", json!({ "name": name, "code": "SELECT COUNT(*) AS n FROM leads" }))
        }
        _ => random_deal(dice, waiting),
    }
}

fn random_deal(dice: &mut Dice, waiting: &[u32]) -> (&'static str, Value) {
    let Some(customer) = waiting.first().map(|_| *dice.pick(waiting)) else {
        return ("reject_enterprise_deal", json!({ "deals": [{ "customer_id": 3 }] }));
    };
    if dice.roll(4) == 0 {
        return ("reject_enterprise_deal", json!({ "deals": [{ "customer_id": customer }] }));
    }
    let offerings = json!([["B", 20.0 + random_amount(dice, 40)], ["C", 40.0 + random_amount(dice, 60)]]);
    ("send_enterprise_deal", json!({ "deals": [{ "customer_id": customer, "offerings": offerings }] }))
}

/// Performs up to five random actions on a decision day.
pub fn apply_random_actions(session: &mut Session, dice: &mut Dice) {
    for _ in 0..dice.roll(6) {
        apply_random_action(session, dice);
    }
}

/// Performs a random action.
pub fn apply_random_action(session: &mut Session, dice: &mut Dice) {
    let waiting: Vec<u32> =
        session.company().observe().waiting.iter().map(|thread| thread.customer).collect();
    RandomAction::random(dice, &waiting).apply(session);
}

/// Simulates a week with naive forecasts, if the run is unfinished.
pub fn advance_week(session: &mut Session) {
    if session.ended().is_none() {
        company::advance_week(session);
    }
}
