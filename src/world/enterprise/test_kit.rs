//! A negotiation day with simple values for tests. A test can change each value.

use super::evaluation::tests::K;
use super::{Enterprise, EnterpriseCustomer, EnterpriseDayResult, EnterpriseStatus, NegotiationContext};
use crate::context::tests::with_day_context;
use crate::customers::Customers;
use crate::customers::columns::Subscriber;
use crate::customers::drift::DriftTotals;
use crate::customers::traits::Negotiator;
use crate::events::{Facts, ServiceDay};
use crate::identifiers::{ByPlan, Group};
use crate::morning::Morning;
use crate::morning::tests::morning;
use crate::params::Params;
use crate::product::Product;
use crate::random::Streams;
use crate::reputation::Reputations;
use crate::settings::Settings;
use crate::test_kit::{plain_enterprise, subscriber};

/// A state with model tiers 3, 4 and 5, large quotas, product quality 0.8 for all groups, and no other customers.
pub(super) struct NegotiationKit {
    pub params: Params,
    pub streams: Streams,
    pub morning: Morning,
    pub settings: Settings,
    pub product: Product,
    pub drift: DriftTotals,
    pub group: Group,
    pub customers: Customers,
    pub reputation: Reputations,
    pub enterprise: Enterprise,
    pub facts: Facts,
}

impl NegotiationKit {
    pub fn new(day: u32) -> NegotiationKit {
        let params = Params::bundled();
        let mut product = Product::initial(&params);
        product.shared_bonus = 0.6;
        let mut kit = NegotiationKit {
            streams: Streams::new(1),
            morning: morning(day),
            settings: Settings::initial(&params),
            product,
            drift: DriftTotals::default(),
            group: Group::parse("E1").expect("a group"),
            customers: Customers::default(),
            reputation: Reputations::initial(&params),
            enterprise: Enterprise::default(),
            facts: Facts::default(),
            params,
        };
        kit.start_day(day);
        kit
    }

    /// Starts a day with the current quality of the product.
    pub fn start_day(&mut self, day: u32) {
        let quality = self.product.quality(self.group, &self.params);
        let prices = ByPlan([1e6; 3]);
        self.morning = Morning {
            multipliers: ByPlan([0.9, 1.0, 1.1]),
            quotas: ByPlan([1e9; 3]),
            shared_quality: self.params.quality.base_product_quality + self.product.shared_bonus,
            ..morning(day)
        };
        self.morning.core.prices = prices;
        self.morning.product.0.iter_mut().for_each(|product| *product = quality);
        self.facts.start_day(day);
    }

    /// Returns the row of the reference enterprise K: customer 2, the first customer of its group, with 100 seats.
    pub fn reference_row(&self) -> Subscriber {
        Subscriber {
            customer: 2,
            steepness_left: K.steepness_left,
            steepness_right: K.steepness_right,
            c_max: K.c_max,
            q_min: K.q_min,
            q_max: K.q_max,
            usage_demand: 50.0,
            usage_rate: 0.0,
            ads_quality_sensitivity: 0.08,
            seats: 100.0,
            billing_day: 0,
            billed_once: false,
            listed_price: 0.0,
            effective_price: 0.0,
            ..subscriber(1)
        }
    }

    /// Returns the reference enterprise K, which replies after `delay` days.
    pub fn reference_enterprise(&self, delay: f64, max_turns: u32) -> EnterpriseCustomer {
        let negotiator = Negotiator {
            reply_delay_mean: delay,
            max_negotiation_turns: max_turns,
            ..plain_enterprise(self.group, 1, 2, EnterpriseStatus::Subscriber).negotiator
        };
        EnterpriseCustomer {
            negotiator,
            ..plain_enterprise(self.group, 1, 2, EnterpriseStatus::Lead(self.reference_row()))
        }
    }

    /// Makes enterprise K a subscriber from day 3 with a contract until day 33, and edits the subscriber's row with
    /// `change`.
    pub fn subscribe(&mut self, max_turns: u32, change: impl Fn(&mut Subscriber)) {
        let mut row = Subscriber {
            start_day: 3,
            billed_once: true,
            listed_price: 35.0,
            effective_price: 35.0,
            plan: crate::identifiers::Plan::B,
            ..self.reference_row()
        };
        change(&mut row);
        self.customers.groups[self.group].activate(row);
        let company = EnterpriseCustomer {
            status: EnterpriseStatus::Subscriber,
            contract_end_day: 33,
            ..self.reference_enterprise(3.0, max_turns)
        };
        self.enterprise.companies.push(company);
    }

    /// Runs `check` with the negotiation context of the day.
    pub fn with_negotiation<R>(&self, check: impl FnOnce(&NegotiationContext<'_>) -> R) -> R {
        let params_and_streams = (&self.params, &self.streams);
        with_day_context(
            &self.morning,
            &self.settings,
            &ServiceDay::without_load(),
            params_and_streams,
            |day| check(&NegotiationContext { day, product: &self.product, drift: &self.drift }),
        )
    }

    /// Runs the enterprise step of a day. Afterwards, the facts contain only that day.
    pub fn run_day(&mut self, day: u32) -> EnterpriseDayResult {
        self.start_day(day);
        let mut enterprise = std::mem::take(&mut self.enterprise);
        let mut customers = std::mem::take(&mut self.customers);
        let mut reputation = self.reputation.clone();
        let mut facts = std::mem::take(&mut self.facts);
        let result = self.with_negotiation(|day| {
            enterprise.step(&mut customers, &mut reputation, day, &mut facts, &mut |_| {})
        });
        (self.enterprise, self.customers, self.facts) = (enterprise, customers, facts);
        self.reputation = reputation;
        result
    }

    /// Sends an offer to enterprise K on the current day.
    pub fn send_offer(
        &mut self,
        offerings: &[(crate::identifiers::Plan, f64)],
    ) -> Vec<super::messages::OfferMessage> {
        let day = self.morning.day;
        let offerings =
            offerings.iter().map(|&(plan, price)| crate::events::Offering { plan, price }).collect();
        let proposals = [super::messages::OfferDraft { customer: 2, offerings }];
        let offer_messages =
            self.enterprise.resolve_offers(&proposals, day, &self.customers, &self.params, &self.streams);
        self.facts.start_day(day);
        self.enterprise.send_offers(&offer_messages, day, &mut self.customers, &mut self.facts);
        offer_messages
    }
}
