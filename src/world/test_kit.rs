//! Simple subscribers, enterprises and settings for tests of this and other crates.

use crate::customers::columns::Subscriber;
use crate::customers::persona::PersonaPicks;
use crate::customers::traits::Negotiator;
use crate::enterprise::{EnterpriseCustomer, EnterpriseStatus};
use crate::identifiers::{ByPlan, Channel, Group, Plan};
use crate::quota::Quota;
use crate::state::World;

/// Returns a subscriber with simple values for tests. A test can change each value.
pub fn subscriber(n: u32) -> Subscriber {
    Subscriber {
        n,
        customer: n + 1,
        subscription: n,
        plan: Plan::A,
        billing_day: 1,
        billed_once: true,
        start_day: 1,
        steepness_left: 1.2,
        steepness_right: 2.8,
        c_max: 50.0,
        q_min: 0.1,
        q_max: 0.55,
        usage_demand: 80.0,
        ads_quality_sensitivity: 0.12,
        ads_return_sensitivity: 0.08,
        seats: 1.0,
        listed_price: 12.0,
        promotion: 0.0,
        effective_price: 12.0,
        effective_c_max: 50.0,
        usage_rate: 80.0,
        period_usage: 0,
        satisfaction: 0.5,
        relationship: 0.5,
        open_issue_days: 0,
        issue: 0,
        required: 0.2,
    }
}

/// Returns an enterprise with simple values.
pub fn plain_enterprise(
    group: Group,
    n: u32,
    customer: u32,
    standing: EnterpriseStatus,
) -> EnterpriseCustomer {
    EnterpriseCustomer {
        customer,
        group,
        n,
        subscription: customer - 1,
        negotiator: Negotiator {
            reply_delay_mean: 3.0,
            reply_delay_std: 0.0,
            initial_offer_factor: 0.75,
            max_negotiation_turns: 6,
        },
        persona: PersonaPicks::default(),
        contract_end_day: 0,
        status: standing,
    }
}

/// Applies the settings of policy P, a cautious policy.
pub fn apply_policy_p(world: &mut World) {
    let s1 = Group::at(0).expect("S1");
    let core = &mut world.settings.core;
    core.prices = ByPlan([9.0, 18.0, 40.0]);
    core.tiers = ByPlan([1, 2, 3]);
    core.quotas = ByPlan([60_000, 250_000, 1_200_000].map(Quota::from));
    core.operations = 300.0;
    core.development = 800.0;
    let channel = Channel::SocialMedia;
    world.settings.targeted_ads.targeted_spend.insert(channel, [(s1, 2000.0)].into_iter().collect());
    world.settings.targeted_development.targeted_spend.insert(s1, 4000.0);
}
