//! Threads that subscribers open: a threat to cancel, or a request for a different plan.

use std::collections::BTreeSet;

use super::evaluation::surplus;
use super::{NegotiationContext, NegotiationStep};
use crate::customers::columns::Subscriber;
use crate::events::{Notice, Sender, ThreadKind, TurnContent};
use crate::identifiers::{Group, Plan};
use crate::params::EnterpriseParams as Sales;
use crate::random::Part;

/// A subscriber's request, which opens a thread.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SubscriberRequest {
    /// A threat to cancel the subscription.
    Leave,
    /// A request for a different plan.
    Switch { from: Plan, to: Plan },
}

/// Returns the gain in surplus from a different plan as a share of the present surplus.
pub fn improvement(best: f64, present: f64, sales: &Sales) -> f64 {
    (best - present) / present.abs().max(sales.plan_change_improvement_denominator_min)
}

impl NegotiationStep<'_> {
    /// Opens threads for subscribers that had no thread this morning.
    pub(super) fn open_subscriber_threads(&mut self, busy: &BTreeSet<u32>) {
        let mut requests: Vec<(u32, u32, SubscriberRequest)> = Vec::new();
        for (group, block) in self.customers.blocks().filter(|(group, _)| group.is_enterprise()) {
            for at in (0..block.len()).filter(|at| !busy.contains(&block.customer[*at])) {
                let row = block.row(at);
                if let Some(subscriber_request) = self.context.subscriber_request(group, &row) {
                    requests.push((row.customer, row.seats as u32, subscriber_request));
                }
            }
        }
        requests.sort_by_key(|(customer, ..)| *customer);
        for (customer, seats, request) in requests {
            self.start_thread(customer, seats, request);
        }
    }

    fn start_thread(&mut self, customer: u32, seats: u32, subscriber_request: SubscriberRequest) {
        let Some(company) = self.enterprise.enterprise_position(customer) else { return };
        let (kind, content, notice) = match subscriber_request {
            SubscriberRequest::Leave => {
                (ThreadKind::ChurnPrevention, TurnContent::Threat, Notice::ChurnThreat { customer })
            }
            SubscriberRequest::Switch { from, to } => {
                let notice = Notice::PlanChangeRequest { customer, upgrade: to > from };
                (ThreadKind::PlanChange, TurnContent::PlanChangeRequest { from, to }, notice)
            }
        };
        let today = self.today();
        let opening = TurnContent::Opening;
        let thread =
            self.enterprise.open_thread(today, company, kind, seats, Sender::System, opening, self.facts);
        self.append_turn_today(thread, Sender::Customer, seats, content);
        self.facts.notices.push(notice);
    }
}

impl NegotiationContext<'_> {
    fn subscriber_request(&self, group: Group, row: &Subscriber) -> Option<SubscriberRequest> {
        let sales = &self.day.params.enterprise;
        let (quality, curve) = (self.subscriber_quality(group, row), self.subscriber_curve(group, row));
        let present = surplus(quality[row.plan], row.listed_price, &curve, self.day.params);
        if present < sales.churn_trigger_satisfaction_below {
            return Some(SubscriberRequest::Leave);
        }
        let mut best: Option<(f64, Plan)> = None;
        for plan in Plan::ALL.into_iter().filter(|plan| *plan != row.plan) {
            let price = self.day.morning.core.prices[plan];
            if price > curve.c_max {
                continue;
            }
            let value = surplus(quality[plan], price, &curve, self.day.params);
            if value > 0.0 && value > best.map_or(present, |(most, _)| most) {
                best = Some((value, plan));
            }
        }
        let (most, to) = best?;
        if improvement(most, present, sales) <= sales.plan_change_min_relative_improvement {
            return None;
        }
        let keys = [u64::from(self.day.day()), group.index() as u64, u64::from(row.n)];
        let asks = self.day.streams.open(Part::PlanChange, keys).bernoulli(sales.plan_change_probability);
        asks.then_some(SubscriberRequest::Switch { from: row.plan, to })
    }
}

#[cfg(test)]
mod tests {
    use super::super::evaluation::tests::K;
    use super::super::test_kit::NegotiationKit;
    use super::*;
    use crate::identifiers::ByPlan;

    /// Returns the quality and the surplus of the subscriber's current plan.
    fn current_quality_and_surplus(kit: &NegotiationKit, row: &Subscriber) -> (f64, f64) {
        kit.with_negotiation(|day| {
            let (quality, curve) =
                (day.subscriber_quality(kit.group, row), day.subscriber_curve(kit.group, row));
            let quality = quality[row.plan];
            (quality, surplus(quality, row.listed_price, &curve, &kit.params))
        })
    }

    fn kit_on_day(day: u32) -> NegotiationKit {
        let mut kit = NegotiationKit::new(day);
        kit.morning.product.0.iter_mut().for_each(|product| *product = 0.8);
        kit.morning.quotas = ByPlan([4000.0, 5000.0, 10_000.0]);
        kit
    }

    fn subscriber(
        kit: &NegotiationKit,
        plan: Plan,
        listed_price: f64,
        relationship: f64,
        usage_rate: f64,
    ) -> Subscriber {
        Subscriber {
            plan,
            listed_price,
            effective_price: listed_price,
            relationship,
            usage_rate,
            start_day: 2,
            ..kit.reference_row()
        }
    }

    #[test]
    fn threat_depends_on_subscriber_quality_and_surplus() {
        let near = |(quality, surplus): (f64, f64), expected: (f64, f64)| {
            assert!((quality - expected.0).abs() < 1e-10, "got {quality}, expected {}", expected.0);
            assert!((surplus - expected.1).abs() < 1e-10, "got {surplus}, expected {}", expected.1);
        };
        let day4 = kit_on_day(4);
        let content = subscriber(&day4, Plan::B, 35.0, 0.6, 4500.0);
        near(current_quality_and_surplus(&day4, &content), (0.8932269261, 0.1604767570));
        let strained = subscriber(&day4, Plan::B, 45.0, 0.6, 5500.0);
        near(current_quality_and_surplus(&day4, &strained), (0.8120244782, -0.0254755218));
        assert_eq!(
            day4.with_negotiation(|day| day.subscriber_request(day4.group, &strained)),
            Some(SubscriberRequest::Leave)
        );

        let mut day32 = kit_on_day(32);
        day32.morning.product[day32.group] = 0.85;
        let waiting = Subscriber { open_issue_days: 3, ..subscriber(&day32, Plan::B, 35.0, 0.5, 5000.0) };
        near(current_quality_and_surplus(&day32, &waiting), (0.7946573590, 0.0619071900));

        let mut day61 = kit_on_day(61);
        day61.settings.ads_strength.global = 0.5;
        near(
            current_quality_and_surplus(&day61, &subscriber(&day61, Plan::C, 35.0, 0.8, 9000.0)),
            (1.1451429342, 0.4123927652),
        );
        let day9 = kit_on_day(9);
        near(
            current_quality_and_surplus(&day9, &subscriber(&day9, Plan::B, 35.0, 0.0, 5000.0)),
            (0.7047704579, -0.0279797112),
        );
    }

    #[test]
    fn threat_depends_on_the_agreed_price() {
        let kit = kit_on_day(4);
        let request_at_prices = |agreed: f64, charged: f64| {
            let row =
                Subscriber { effective_price: charged, ..subscriber(&kit, Plan::B, agreed, 0.6, 5500.0) };
            kit.with_negotiation(|day| day.subscriber_request(kit.group, &row))
        };
        assert_eq!(
            request_at_prices(45.0, 5.0),
            Some(SubscriberRequest::Leave),
            "a discount does not change the surplus of a deal"
        );
        assert_eq!(request_at_prices(30.0, 90.0), None, "the charged price does not count");
    }

    #[test]
    fn plan_change_requires_a_minimum_improvement() {
        let mut kit = kit_on_day(3);
        kit.morning.quotas = ByPlan([1e9; 3]);
        let on_b = |kit: &NegotiationKit, price| subscriber(kit, Plan::B, price, 0.5, 4000.0);
        let surplus_on = |kit: &NegotiationKit, row: &Subscriber, plan: Plan, price: f64| {
            kit.with_negotiation(|day| {
                let (quality, curve) =
                    (day.subscriber_quality(kit.group, row), day.subscriber_curve(kit.group, row));
                surplus(quality[plan], price, &curve, &kit.params)
            })
        };
        let sales = kit.params.enterprise.clone();
        for (deal, list, here, there, gain) in [
            (42.0, 25.0, 0.0161276713, 0.0323850397, 1.0080418971),
            (36.0, 19.0, 0.0659686697, 0.0729693082, 0.1061206559),
        ] {
            let row = on_b(&kit, deal);
            let (own_here, own_there) =
                (current_quality_and_surplus(&kit, &row).1, surplus_on(&kit, &row, Plan::A, list));
            assert!((own_here - here).abs() < 1e-10 && (own_there - there).abs() < 1e-10);
            assert!((improvement(own_there, own_here, &sales) - gain).abs() < 1e-8);
        }
        // No random draw is made if the gain in surplus is too small.
        kit.morning.core.prices = ByPlan([22.0, 500.0, 500.0]);
        let row = on_b(&kit, 36.0);
        assert!((surplus_on(&kit, &row, Plan::A, 22.0) - 0.0500675475).abs() < 1e-10);
        assert_eq!(kit.with_negotiation(|day| day.subscriber_request(kit.group, &row)), None);
    }

    #[test]
    fn plan_change_probability_is_thirty_percent() {
        let mut kit = kit_on_day(3);
        kit.morning.quotas = ByPlan([1e9; 3]);
        kit.morning.core.prices = ByPlan([25.0, 500.0, 500.0]);
        let asks = |n: &u32| {
            let row = Subscriber { n: *n, ..subscriber(&kit, Plan::B, 42.0, 0.5, 4000.0) };
            kit.with_negotiation(|day| day.subscriber_request(kit.group, &row))
                == Some(SubscriberRequest::Switch { from: Plan::B, to: Plan::A })
        };
        let asked = (1..=10_000).filter(asks).count();
        assert!((2_850..3_150).contains(&asked), "{asked}");
        assert_eq!(kit.reference_row().c_max, K.c_max);
    }
}
