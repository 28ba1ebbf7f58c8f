//! Parameters of the world, which are loaded from `configs/world/*.toml`, checked once, and then immutable.
//!
//! The pages of `docs/mechanics/README.md` explain every key. A scenario is a small file that overrides some
//! parameters. Every run records a digest of the merged parameters.

mod change;
mod check;
mod customers;
mod discovery;
mod enterprise;
mod load;
mod market;
mod names;
mod product;
mod retention;
mod run;
mod social;

use std::collections::BTreeMap;

use serde_json::Value as Json;

pub use change::ParameterDifference;
pub use customers::*;
pub use discovery::*;
pub use enterprise::*;
pub use load::{
    ParameterError, ParameterSource, apply_override, bundled_sources, line_of_key, parameter_comment,
};
pub use market::*;
#[cfg(test)]
pub(crate) use names::keys;
pub use product::*;
pub use retention::*;
pub use run::*;
pub use social::*;

use self::check::parameters;
use super::fault::Fault;
use super::identifiers::{ByChannel, ByGroup, Channel, Group};

/// Keys that were added after runs had been recorded. Each element consists of the table, the key, and the default
/// value as JSON. The default value preserves the earlier behavior.
const ADDED_KEYS: [(&str, &str, &str); 5] = [
    ("run", "horizon_rule", "\"exact\""),
    ("fidelity", "insight_noise", "\"independent\""),
    ("fidelity", "renewal_price", "\"list\""),
    ("fidelity", "enterprise_quality_cap", "\"one\""),
    ("fidelity", "interface", "\"release_1\""),
];

parameters! {
    /// All parameters, one field per table of the files in `configs/world`.
    pub struct Params {
        /// Length and end of a run.
        pub run: Run,
        /// Company and market on day 0.
        pub initial: Initial,
        /// Limits of tools, queries and texts.
        pub limits: Limits,
        /// Alternative forms of some mechanics.
        pub fidelity: Fidelity,
        /// Recorded series that is replayed, if any.
        pub series: SeriesChoice,
        /// Shape of the participation curve.
        pub participation: Participation,
        /// Bounds of the traits of new customers.
        pub customer_generation: CustomerGeneration,
        /// Delivered and perceived quality.
        pub quality: Quality,
        /// Development and R&D.
        pub development: Development,
        /// Service health.
        pub operations: Operations,
        /// In-app advertising.
        pub ads: Ads,
        /// Model tiers, numbered 1..=5.
        pub model_tier: Vec<ModelTier>,
        /// Capacity tiers, numbered 0..=7.
        pub capacity_tier: Vec<CapacityTier>,
        /// R&D tiers, numbered 1..=20.
        pub research_tier: Vec<ResearchTier>,
        /// Daily update of satisfaction.
        pub satisfaction: Satisfaction,
        /// Support issues.
        pub issues: Issues,
        /// Billing of subscribers.
        pub billing: Billing,
        /// Minimum sums of discounts.
        pub promotions: Promotions,
        /// Cancellations after failed payments.
        pub involuntary_churn: InvoluntaryChurn,
        /// Calendar factors of weekdays and days of the month.
        pub calendar: Calendar,
        /// Demand surges.
        pub demand_surge: DemandSurge,
        /// Leads and channel yields.
        pub leads: Leads,
        /// Reputation of the company.
        pub reputation: Reputation,
        /// Competitor events.
        pub competitor: Competitor,
        /// Preference drift.
        pub drift: Drift,
        /// The hidden PMI, its publication and its effects.
        pub economy as "macro": MacroEconomy,
        /// Posts that customers write.
        pub social: SocialParams,
        /// Posts of the player.
        pub ceo_posts: CeoPosts,
        /// Negotiations with enterprises.
        pub enterprise: EnterpriseParams,
        /// Discovery of groups.
        pub market_research: MarketResearch,
        /// Study levels, numbered 1..=5.
        pub info_level: Vec<InfoLevel>,
        /// Market studies of groups.
        pub group_research: GroupResearch,
        /// The 26 groups, in their fixed order.
        pub group: Vec<GroupParams>,
        /// The five channels, in their fixed order.
        pub channel: Vec<ChannelParams>,
        /// Word of mouth: leads per day in each group per active subscription of the source group.
        pub referral_leads_per_subscriber_day: BTreeMap<String, Vec<f64>> where 0.0..=1e6,
        /// Weight of the source group's reputation changes for each group.
        pub reputation_influence: BTreeMap<String, Vec<f64>> where 0.0..=f64::INFINITY,
        /// Words of customer profiles.
        pub personas: Personas,
        /// The seeded fault of a debug run. No parameter table contains the fault, so it can be set only at the start
        /// of a run.
        #[serde(skip)]
        pub fault: Option<Fault>,
    }

    /// Parameters of one advertising channel.
    pub struct ChannelParams {
        /// Identifier of the channel.
        pub id: String,
        /// Display name of the channel.
        pub name: String,
        /// Leads per 1,000 dollars of advertising at the start of a run, by group.
        pub leads_per_1000_dollars: BTreeMap<String, f64> where 0.0..=1e9,
    }
}

impl Params {
    /// Returns the parameters of a group.
    pub fn group(&self, group: Group) -> &GroupParams {
        &self.group[group.index()]
    }

    /// Returns the channel yields at the start of a run, in leads per 1,000 dollars.
    pub fn starting_yields(&self) -> ByChannel<ByGroup<f64>> {
        ByChannel::from_fn(|channel: Channel| {
            let yields = &self.channel[channel.index()].leads_per_1000_dollars;
            ByGroup::from_fn(|group| yields.get(group.id()).copied().unwrap_or(0.0))
        })
    }

    /// Returns the word-of-mouth rate from a source group to a target group, in leads per subscription per day.
    pub fn referral_rate(&self, source: Group, target: Group) -> f64 {
        self.referral_leads_per_subscriber_day[source.id()][target.index()]
    }

    /// Returns the weight of the source group's reputation changes for the target group.
    pub fn reputation_weight(&self, source: Group, target: Group) -> f64 {
        self.reputation_influence[source.id()][target.index()]
    }

    /// Returns the capacity tier with this number, 0..=7.
    pub fn capacity_tier(&self, tier: u8) -> &CapacityTier {
        &self.capacity_tier[usize::from(tier)]
    }

    /// Returns the model tier with this number, 1..=5.
    pub fn model_tier(&self, tier: u8) -> &ModelTier {
        &self.model_tier[usize::from(tier) - 1]
    }

    /// Returns the study level with this number, 1..=5.
    pub fn study_level(&self, level: u8) -> &InfoLevel {
        &self.info_level[usize::from(level) - 1]
    }

    /// Returns the R&D tier with this number, 1..=20.
    pub fn research_tier(&self, tier: u8) -> &ResearchTier {
        &self.research_tier[usize::from(tier) - 1]
    }

    /// Returns the digest of the parameters: 16 hexadecimal digits of a BLAKE3 hash over the canonical JSON and the
    /// number of the fault, if any. Keys of `ADDED_KEYS` with the earlier behavior are left out.
    ///
    /// Every run records this digest, so that a run is never continued with different parameters by mistake.
    pub fn digest(&self) -> String {
        self.digest_without(|value, earlier| value == earlier)
    }

    /// Returns the digest that earlier versions, which did not have the keys of `ADDED_KEYS`, computed for the same
    /// parameters.
    pub fn earlier_digest(&self) -> String {
        self.digest_without(|_, _| true)
    }

    /// Returns the digest without some keys of `ADDED_KEYS`. `is_left_out` receives the value of a key and the value
    /// with the earlier behavior.
    fn digest_without(&self, is_left_out: impl Fn(&Json, &Json) -> bool) -> String {
        let tables = serde_json::to_value(self).expect("parameters hold only strings and finite numbers");
        digest_tables(tables, self.fault, &ADDED_KEYS, is_left_out)
    }
}

/// Returns the digest of parameters that are given as JSON. Omits the added keys for which `is_left_out` returns true,
/// and tables that contain no other keys.
fn digest_tables(
    mut tables: Json,
    fault: Option<Fault>,
    added: &[(&str, &str, &str)],
    is_left_out: impl Fn(&Json, &Json) -> bool,
) -> String {
    for (name, key, earlier) in added {
        let earlier = serde_json::from_str(earlier).expect("ADDED_KEYS contains valid JSON");
        let table = tables.get_mut(name).and_then(Json::as_object_mut);
        if let Some(table) = table
            && table.get(*key).is_some_and(|value| is_left_out(value, &earlier))
        {
            table.shift_remove(*key);
            // If all keys of a table were added, earlier versions did not have the table.
            if table.is_empty()
                && let Some(tables) = tables.as_object_mut()
            {
                tables.shift_remove(*name);
            }
        }
    }
    let mut canonical = tables.to_string().into_bytes();
    canonical.extend(fault.into_iter().flat_map(|fault| fault.number().to_le_bytes()));
    blake3::hash(&canonical).to_hex()[..16].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn added_keys_preserve_earlier_digests() {
        let bundled = Params::bundled();
        assert_eq!(bundled.digest(), "a9623642a136c0a4", "the digest in recorded runs");
        let mut release = bundled.clone();
        release.fidelity.insight_noise = InsightNoise::Release;
        assert_ne!(release.digest(), bundled.digest());
        assert_eq!(release.earlier_digest(), bundled.digest());
        let tables = serde_json::to_value(&bundled).expect("tables");
        for (table, key, earlier) in ADDED_KEYS {
            assert_eq!(
                tables[table][key].to_string(),
                earlier,
                "{table}.{key}: the default is the earlier behavior"
            );
        }
    }

    #[test]
    fn added_table_at_default_preserves_the_digest() {
        let params = Params::bundled();
        let added =
            [&ADDED_KEYS[..], &[("next_table", "first", "1"), ("next_table", "second", "true")]].concat();
        let digest = |first: u32, second: bool, added: &[(&str, &str, &str)]| {
            let mut tables = serde_json::to_value(&params).expect("tables");
            tables["next_table"] = serde_json::json!({ "first": first, "second": second });
            digest_tables(tables, params.fault, added, |current, earlier| current == earlier)
        };
        assert_eq!(digest(1, true, &added), params.digest(), "the table is left out");
        let others = [digest(2, true, &added), digest(1, false, &added), digest(2, false, &added)];
        let distinct: std::collections::BTreeSet<&String> = others.iter().collect();
        assert!(distinct.len() == 3 && !others.contains(&params.digest()), "other values count");
        assert_ne!(digest(1, true, &ADDED_KEYS), params.digest(), "its keys have to be listed");
    }

    #[test]
    fn added_key_at_default_preserves_the_digest() {
        let bundled = Params::bundled();
        let mut rivals = bundled.clone();
        rivals.competitor.competitor_feedback_u_max = 0.7;
        let mut noisy = bundled.clone();
        noisy.fidelity.insight_noise = InsightNoise::Release;
        let faulty = Params { fault: Fault::from_number(3), ..bundled.clone() };
        let added = [&ADDED_KEYS[..], &[("fidelity", "next_form", "\"release\"")]].concat();
        let mut digests = std::collections::BTreeSet::new();
        for params in [bundled, rivals, faulty, noisy] {
            let with_key = |value: &str| {
                let mut tables = serde_json::to_value(&params).expect("tables");
                tables["fidelity"]["next_form"] = value.into();
                tables
            };
            let digest = |value, added| {
                digest_tables(with_key(value), params.fault, added, |current, earlier| current == earlier)
            };
            assert_eq!(digest("release", &added), params.digest(), "it is left out");
            assert_ne!(digest("paper", &added), params.digest(), "another value counts");
            assert_ne!(digest("release", &ADDED_KEYS), params.digest(), "it has to be listed");
            digests.insert(params.digest());
        }
        assert_eq!(digests.len(), 4);
    }
}
