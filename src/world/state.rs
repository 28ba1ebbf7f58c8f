//! The whole hidden truth of a company and its market.

use super::canonical::{Canonical, CanonicalHasher, canonical, hash_of};
use super::customers::Customers;
use super::enterprise::Enterprise;
use super::events::{Category, Facts, LedgerEntry, LedgerNote, SettingsChange};
use super::finance::Finance;
use super::market::Market;
use super::params::Params;
use super::product::Product;
use super::retention::issues::IssueDesk;
use super::settings::Settings;

/// The state of a run after its last simulated day.
#[derive(Debug, Clone)]
pub struct World {
    /// Last simulated day, 0 before the first.
    pub day: u32,
    /// Last day of the run; the competitors grow towards it.
    pub total_days: u32,
    /// What the player has set.
    pub settings: Settings,
    /// Money.
    pub finance: Finance,
    /// What development has achieved.
    pub product: Product,
    /// Who the customers are.
    pub customers: Customers,
    /// Support issues.
    pub issue_desk: IssueDesk,
    /// The market.
    pub market: Market,
    /// Negotiations.
    pub enterprise: Enterprise,
}

canonical! {
    World { day, total_days, settings, finance, product, customers, issue_desk, market, enterprise }
}

/// Hash of one part of the state, so that a difference between two runs can be named.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PartHash {
    /// Name of the part.
    pub part: &'static str,
    /// Its hash.
    pub hash: blake3::Hash,
}

impl World {
    /// The world of day 0, and the facts of its set-up.
    pub fn open(total_days: u32, cash: f64, params: &Params, facts: &mut Facts) -> World {
        facts.begin(0);
        let settings = Settings::opening(params);
        let mut world = World {
            day: 0,
            total_days,
            finance: Finance { cash: 0.0 },
            product: Product::opening(params),
            customers: Customers::default(),
            issue_desk: IssueDesk::default(),
            market: Market::opening(params),
            enterprise: Enterprise::default(),
            settings,
        };
        let funding =
            LedgerEntry { category: Category::InitialFunding, amount: cash, note: LedgerNote::General };
        world.finance.book(funding, facts);
        facts.settings.push(SettingsChange::Core(world.settings.core));
        facts.knowledge.extend(world.market.knowledge.pairs().map(|(group, own)| (group, *own)));
        world
    }

    /// Whether nothing more can be simulated: the last day has passed, or cash is below zero.
    pub fn is_over(&self, params: &Params) -> bool {
        self.day >= self.total_days || self.finance.is_bankrupt(params)
    }

    /// Hashes of the parts of the state, in declaration order.
    pub fn part_hashes(&self) -> Vec<PartHash> {
        let World { day, total_days, settings, finance, product, customers, issue_desk, market, enterprise } =
            self;
        let part = |part, hash| PartHash { part, hash };
        vec![
            part("calendar", hash_of(&(*day, *total_days))),
            part("settings", hash_of(settings)),
            part("money", hash_of(finance)),
            part("product", hash_of(product)),
            part("customers", customers.hash()),
            part("issues", hash_of(issue_desk)),
            part("market", hash_of(market)),
            part("threads", hash_of(enterprise)),
        ]
    }
}

/// Hash of the parts together.
pub fn combined_hash(parts: &[PartHash]) -> blake3::Hash {
    let mut hasher = CanonicalHasher::default();
    for part in parts {
        part.part.feed(&mut hasher);
        hasher.bytes(part.hash.as_bytes());
    }
    hasher.finish()
}
