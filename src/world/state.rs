//! The complete hidden state of a company and its market.

use super::canonical::{Canonical, CanonicalHasher, canonical, canonical_hash};
use super::customers::Customers;
use super::enterprise::Enterprise;
use super::events::{Category, Facts, LedgerEntry, LedgerNote};
use super::finance::Finance;
use super::market::Market;
use super::params::Params;
use super::product::Product;
use super::retention::issues::IssueCounter;
use super::settings::Settings;
use super::settings::SettingsChange;

/// The hidden state of a run after its last simulated day.
#[derive(Debug, Clone)]
pub struct World {
    /// Last simulated day, or 0 before the first day.
    pub day: u32,
    /// Length of the run that scales competitor events ([`Horizon::total_days`](super::params::Horizon)).
    pub total_days: u32,
    /// Current settings of the player.
    pub settings: Settings,
    /// Cash, which is the sum of the ledger.
    pub finance: Finance,
    /// The product and its development.
    pub product: Product,
    /// All customers, and the columns of the active subscribers.
    pub customers: Customers,
    /// Counter that numbers support issues.
    pub issue_counter: IssueCounter,
    /// State of the market.
    pub market: Market,
    /// Negotiations with enterprises.
    pub enterprise: Enterprise,
}

canonical! {
    World { day, total_days, settings, finance, product, customers, issue_counter, market, enterprise }
}

/// The hash of one part of the state. A comparison of these hashes locates differences between runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartHash {
    /// Name of the part, for instance `customers`.
    pub part: &'static str,
    /// Hash of the part's canonical bytes.
    pub hash: blake3::Hash,
}

impl World {
    /// Creates the world on day 0 and records the initial facts.
    pub fn new(total_days: u32, cash: f64, params: &Params, facts: &mut Facts) -> World {
        facts.start_day(0);
        let settings = Settings::initial(params);
        let mut world = World {
            day: 0,
            total_days,
            finance: Finance { cash: 0.0 },
            product: Product::initial(params),
            customers: Customers::default(),
            issue_counter: IssueCounter::default(),
            market: Market::initial(params),
            enterprise: Enterprise::default(),
            settings,
        };
        let funding =
            LedgerEntry { category: Category::InitialFunding, amount: cash, note: LedgerNote::General };
        world.finance.book(funding, facts);
        facts.settings.push(SettingsChange::Core(world.settings.core));
        facts.knowledge.extend(world.market.knowledge.pairs().map(|(group, knowledge)| (group, *knowledge)));
        world
    }

    /// Returns the last day of the run.
    pub fn last_day(&self, params: &Params) -> u32 {
        params.run.horizon(self.total_days).last_day
    }

    /// Returns whether the run is over, because the last day has been simulated or the company is bankrupt.
    pub fn is_over(&self, params: &Params) -> bool {
        self.day >= self.last_day(params) || self.finance.is_bankrupt(params)
    }

    /// Returns the hash of each part of the state, in declaration order.
    pub fn part_hashes(&self) -> Vec<PartHash> {
        let World {
            day,
            total_days,
            settings,
            finance,
            product,
            customers,
            issue_counter,
            market,
            enterprise,
        } = self;
        let part = |part, hash| PartHash { part, hash };
        vec![
            part("calendar", canonical_hash(&(*day, *total_days))),
            part("settings", canonical_hash(settings)),
            part("money", canonical_hash(finance)),
            part("product", canonical_hash(product)),
            part("customers", customers.hash()),
            part("issues", canonical_hash(issue_counter)),
            part("market", canonical_hash(market)),
            part("threads", canonical_hash(enterprise)),
        ]
    }
}

/// Returns the state hash: one hash of all parts together.
pub fn combined_hash(parts: &[PartHash]) -> blake3::Hash {
    let mut hasher = CanonicalHasher::default();
    for part in parts {
        part.part.feed(&mut hasher);
        hasher.append_bytes(part.hash.as_bytes());
    }
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canonical::{canonical_bytes, restore_all};
    use crate::day::step_day;
    use crate::identifiers::{Channel, Group, Plan};
    use crate::random::Streams;
    use crate::settings::PerGroup;

    /// Returns the world of a company with individuals, enterprises, threads, issues, R&D projects and a market study.
    fn busy_company() -> World {
        let (params, streams) = (Params::bundled(), Streams::new(5));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        crate::test_kit::apply_policy_p(&mut world);
        world.settings.core.tiers.0 = [3, 4, 5];
        let companies = |spend: f64| PerGroup::from([(Group::parse("E1").expect("a group"), spend)]);
        world.settings.targeted_ads.targeted_spend.insert(Channel::Linkedin, companies(5000.0));
        world.settings.targeted_development.targeted_spend = companies(9000.0);
        for _ in 0..40 {
            step_day(&mut world, &params, &streams, &mut facts);
        }
        assert!(
            world.customers.active_by_group().iter().sum::<u32>() > 50
                && !world.enterprise.threads.is_empty()
        );
        world
    }

    /// A function that changes one field of the world. Some of these functions use the group.
    type WorldChange = fn(&mut World, Group);

    fn changed_parts(world: &World, other: &World) -> Vec<&'static str> {
        let pairs = world.part_hashes().into_iter().zip(other.part_hashes());
        pairs.filter(|(part_hash, other)| part_hash.hash != other.hash).map(|(hash, _)| hash.part).collect()
    }

    #[test]
    fn part_hashes_localize_changes() {
        let world = busy_company();
        let s2 = Group::parse("S2").expect("a group");
        let changes: [(&str, WorldChange); 25] = [
            ("calendar", |world, _| world.day += 1),
            ("calendar", |world, _| world.total_days += 1),
            ("settings", |world, _| world.settings.core.prices[Plan::C] += 0.01),
            ("settings", |world, _| world.settings.core.tiers[Plan::B] += 1),
            ("settings", |world, _| world.settings.core.capacity_tier += 1),
            ("settings", |world, _| world.settings.promotion.global += 1.0),
            ("settings", |world, _| world.settings.lead_promotion.global += 1.0),
            ("settings", |world, _| world.settings.ads_strength.global += 0.1),
            ("settings", |world, _| world.settings.targeted_ads.targeted_spend.clear()),
            ("settings", |world, _| world.settings.targeted_operations.by_plan.extend([(Plan::A, 1.0)])),
            ("settings", |world, s2| {
                world.settings.targeted_development.targeted_spend.extend([(s2, 1.0)]);
            }),
            ("money", |world, _| world.finance.cash += 0.01),
            ("product", |world, _| world.product.shared_bonus += 1e-9),
            ("product", |world, s2| world.product.group_bank[s2] += 1e-9),
            ("customers", |world, _| world.customers.next_customer += 1),
            ("customers", |world, _| world.customers.next_subscription += 1),
            ("customers", |world, _| world.customers.groups.0[0].created += 1),
            ("issues", |world, _| world.issue_counter.next_issue += 1),
            ("market", |world, s2| world.market.reputation.set(s2, 1.25)),
            ("market", |world, s2| world.market.drift.c_max[s2] += 1e-9),
            ("market", |world, s2| world.market.yields[Channel::Linkedin][s2] += 1e-9),
            ("market", |world, _| world.market.economy.pmi += 1e-9),
            ("market", |world, _| world.market.social.next_post += 1),
            ("threads", |world, _| world.enterprise.next_thread += 1),
            ("threads", |world, _| world.enterprise.companies[0].contract_end_day += 1),
        ];
        for (at, (part, change)) in changes.into_iter().enumerate() {
            let mut other = world.clone();
            change(&mut other, s2);
            assert_eq!(changed_parts(&world, &other), [part], "change {at}");
            assert_ne!(combined_hash(&world.part_hashes()), combined_hash(&other.part_hashes()));
        }
    }

    /// Every stored byte is hashed: after changing any canonical byte, restoring either fails or returns a different
    /// state.
    #[test]
    fn part_hashes_cover_every_byte_once() {
        let world = busy_company();
        let bytes = canonical_bytes(&world);
        let parts = world.part_hashes();
        assert_eq!(restore_all::<World>(&bytes).expect("a world").part_hashes(), parts);
        let lengths = [
            canonical_bytes(&(world.day, world.total_days)).len(),
            canonical_bytes(&world.settings).len(),
            canonical_bytes(&world.finance).len(),
            canonical_bytes(&world.product).len(),
            canonical_bytes(&world.customers).len(),
            canonical_bytes(&world.issue_counter).len(),
            canonical_bytes(&world.market).len(),
            canonical_bytes(&world.enterprise).len(),
        ];
        assert_eq!(lengths.iter().sum::<usize>(), bytes.len());
        let mut begin = 0;
        for (part, length) in parts.iter().map(|part_hash| part_hash.part).zip(lengths) {
            let mut tried = 0;
            for at in (begin..begin + length).step_by(length.div_ceil(150)) {
                let mut other = bytes.clone();
                other[at] ^= 1;
                if let Some(other) = restore_all::<World>(&other) {
                    assert_eq!(changed_parts(&world, &other), [part], "byte {at} of {}", bytes.len());
                    tried += 1;
                }
            }
            assert!(tried > 0, "{part}: no byte could be changed");
            begin += length;
        }
    }
}
