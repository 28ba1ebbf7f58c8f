//! Billing of subscribers (`docs/mechanics/retention/billing.md`).
//!
//! No step between an individual's decision and the bill affects the decision or the bill. Individuals who stay are
//! therefore billed in the sweep that computes their decision. New customers and enterprises are billed after the day's
//! deals.

use std::collections::BTreeSet;

use super::renewal::{ongoing_discount, row_terms};
use super::{due_today, refresh_required, remembered_budget};
use crate::context::DayContext;
use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::events::{Facts, Payment, TermsChanged};
use crate::identifiers::Group;
use crate::params::Params;
use crate::product::usage::usage_rate;
use crate::random::{Part, Word};

/// Returns the price before discounts on which a bill is based. A price cut applies to existing subscribers, and a
/// price increase does not. Negotiated prices do not change.
pub fn billed_list_price(stored: f64, list: f64, negotiated: bool) -> f64 {
    if negotiated { stored } else { stored.min(list) }
}

/// Bills of several subscribers of one block.
pub struct BlockBills {
    group: Group,
    number: u32,
    payments: Vec<Payment>,
    changes: Vec<TermsChanged>,
}

/// Bills the individuals of a block who are due today, except new subscribers.
pub fn bill_block(group: Group, number: u32, block: &mut Block, day: &DayContext<'_>) -> BlockBills {
    let due = if group.is_enterprise() { Vec::new() } else { due_today(block, day.day(), day.params) };
    bill_rows(group, number, block, due, day, &BTreeSet::new())
}

/// Bills new customers and enterprises, and records all bills of the day. Enterprises in `suspended` pay nothing while
/// their threat to cancel is open. Returns the sum of the day's payments in dollars.
pub fn collect_payments(
    customers: &mut Customers,
    billed: Vec<BlockBills>,
    day: &DayContext<'_>,
    suspended: &BTreeSet<u32>,
    facts: &mut Facts,
) -> f64 {
    let today = day.day();
    let late = customers.sweep(|group, number, block| {
        let mut due = due_today(block, today, day.params);
        due.retain(|at| group.is_enterprise() || block.start_day[*at] == today);
        bill_rows(group, number, block, due, day, suspended)
    });
    let mut received = 0.0;
    let mut billed = billed.into_iter().filter(|early| !early.payments.is_empty()).peekable();
    for block_bills in late {
        let early =
            billed.next_if(|early| (early.group, early.number) == (block_bills.group, block_bills.number));
        let bills_of_block = || early.iter().chain([&block_bills]);
        received +=
            bills_of_block().flat_map(|bills| &bills.payments).map(|payment| payment.amount).sum::<f64>();
        for bills in bills_of_block() {
            facts.payments.extend_from_slice(&bills.payments);
            facts.changes.extend_from_slice(&bills.changes);
        }
    }
    debug_assert!(billed.next().is_none(), "billed customers are still active");
    received
}

fn bill_rows(
    group: Group,
    number: u32,
    block: &mut Block,
    due: Vec<usize>,
    day: &DayContext<'_>,
    suspended: &BTreeSet<u32>,
) -> BlockBills {
    let (mut payments, mut changes) = (Vec::with_capacity(due.len()), Vec::new());
    let keys: Vec<[u64; 3]> =
        due.iter().map(|at| [group.index() as u64, u64::from(block.n[*at]), u64::from(day.day())]).collect();
    let rates = day.streams.first_words(Part::UsageRate, &keys);
    for (at, rate) in due.into_iter().zip(rates) {
        if !suspended.contains(&block.customer[at]) {
            let before = row_terms(block, at);
            payments.push(take_payment(group, block, at, day));
            let after = row_terms(block, at);
            // The seats of enterprises drift between two bills, so each bill records the terms.
            if after != before || group.is_enterprise() {
                changes.push(after);
            }
        }
        start_period(block, at, rate, day.params);
    }
    BlockBills { group, number, payments, changes }
}

/// Computes the payment of a subscriber, and sets the terms of the next billing period.
fn take_payment(group: Group, block: &mut Block, at: usize, day: &DayContext<'_>) -> Payment {
    let &DayContext { morning, settings, params, .. } = day;
    let floor = params.billing.effective_price_min;
    let (customer, plan) = (block.customer[at], block.plan[at]);
    let negotiated = group.is_enterprise();
    let listed = billed_list_price(block.listed_price[at], morning.core.prices[plan], negotiated);
    let ongoing = ongoing_discount(customer, group, plan, settings, params);
    let price = match (block.billed_once[at], negotiated) {
        (true, _) => (listed - ongoing).max(floor),
        (false, false) => (listed - block.promotion[at]).max(floor),
        (false, true) => block.effective_price[at],
    };
    block.listed_price[at] = listed;
    block.promotion[at] = ongoing;
    block.effective_price[at] = (listed - ongoing).max(floor);
    block.effective_c_max[at] = remembered_budget(block.c_max[at], morning.expectations[group].c_max, params);
    block.billed_once[at] = true;
    refresh_required(block, at, morning.expectations[group].c_max, params);
    Payment { customer, amount: price * block.seats[at].trunc() }
}

/// Sets the usage rate of the new billing period from a random draw and today's seats.
fn start_period(block: &mut Block, at: usize, rate: Word, params: &Params) {
    let (z, seats) = (rate.standard_normal(), block.seats[at].trunc());
    block.usage_rate[at] = usage_rate(block.usage_demand[at], seats, z, &params.customer_generation);
    block.period_usage[at] = 0;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::tests::with_day_context;
    use crate::customers::columns::Subscriber;
    use crate::events::ServiceDay;
    use crate::identifiers::{ByPlan, Plan};
    use crate::morning::tests::morning;
    use crate::random::Streams;
    use crate::settings::Settings;
    use crate::test_kit::subscriber;

    fn bill_subscriber(id: &str, row: Subscriber, list: f64, ongoing: f64) -> (f64, Subscriber) {
        let (params, streams) = (Params::bundled(), Streams::new(1));
        let group = Group::parse(id).expect("a group");
        let mut day = morning(31);
        day.core.prices = ByPlan([list; 3]);
        let mut settings = Settings::initial(&params);
        settings.promotion.global = ongoing;
        let mut block = Block::default();
        block.push(row);
        let quiet = ServiceDay::without_load();
        let payment = with_day_context(&day, &settings, &quiet, (&params, &streams), |day| {
            take_payment(group, &mut block, 0, day)
        });
        (payment.amount, block.row(0))
    }

    fn subscriber_with_list_price(listed_price: f64) -> Subscriber {
        Subscriber { listed_price, effective_price: listed_price, ..subscriber(1) }
    }

    #[test]
    fn individual_pays_the_lower_price_minus_promotions() {
        let (paid, row) = bill_subscriber("S1", subscriber_with_list_price(20.0), 15.0, 0.0);
        assert_eq!((paid, row.listed_price), (15.0, 15.0));
        assert_eq!(bill_subscriber("S1", subscriber_with_list_price(20.0), 15.0, 4.0).0, 11.0);
        assert_eq!(bill_subscriber("S1", subscriber_with_list_price(20.0), 15.0, 40.0).0, 0.0);
        let first = Subscriber { billed_once: false, promotion: 7.0, ..subscriber_with_list_price(20.0) };
        let (paid, row) = bill_subscriber("S1", first, 20.0, 4.0);
        assert_eq!((paid, row.promotion, row.effective_price), (13.0, 4.0, 16.0));
        let (paid, row) = bill_subscriber("S1", first, 15.0, 4.0);
        assert_eq!((paid, row.listed_price, row.effective_price), (8.0, 15.0, 11.0));
        assert!(row.billed_once);
    }

    #[test]
    fn enterprise_pays_its_deal_for_whole_seats() {
        let deal = Subscriber {
            seats: 100.9,
            billed_once: false,
            listed_price: 40.0,
            promotion: 5.0,
            effective_price: 35.0,
            ..subscriber(1)
        };
        let (paid, row) = bill_subscriber("E1", deal, 15.0, 4.0);
        assert_eq!((paid, row.listed_price, row.effective_price), (3500.0, 40.0, 36.0));
        assert_eq!(bill_subscriber("E1", row, 15.0, 4.0).0, 3600.0);
    }

    #[test]
    fn price_increase_does_not_change_stored_prices() {
        for (list, promotion, paid) in [(20.0, 0.0, 20.0), (30.0, 0.0, 20.0), (45.0, 8.0, 12.0)] {
            let (amount, row) = bill_subscriber(
                "S1",
                Subscriber { plan: Plan::B, ..subscriber_with_list_price(20.0) },
                list,
                promotion,
            );
            assert_eq!((amount, row.listed_price), (paid, 20.0), "list price {list}");
        }
    }

    #[test]
    fn suspended_enterprise_pays_nothing_and_starts_a_period() {
        let (params, streams) = (Params::bundled(), Streams::new(1));
        let (day, settings) = (morning(31), Settings::initial(&params));
        let group = Group::parse("E2").expect("a group");
        let mut customers = Customers::default();
        let row = Subscriber { period_usage: 77, seats: 10.0, ..subscriber(1) };
        customers.groups[group].activate(row);
        let suspended = BTreeSet::from([row.customer]);
        let mut facts = Facts::default();
        let received =
            with_day_context(&day, &settings, &ServiceDay::without_load(), (&params, &streams), |day| {
                let billed = customers.sweep(|group, number, block| bill_block(group, number, block, day));
                collect_payments(&mut customers, billed, day, &suspended, &mut facts)
            });
        assert_eq!(received, 0.0);
        let after = customers.groups[group].blocks[0].row(0);
        assert!(facts.payments.is_empty() && facts.changes.is_empty());
        assert_eq!((after.period_usage, after.listed_price), (0, row.listed_price));
        assert_ne!(after.usage_rate, row.usage_rate);
    }
}
