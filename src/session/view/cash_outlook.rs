//! The outlook of the company, and the bills of its current subscribers.

use std::collections::BTreeSet;

use super::CompanyView;
use crate::figures::outlook::{BillingCalendar, CommittedCosts, Outlook};
use novamind_world::customers::columns::Block;
use novamind_world::events::ThreadKind;
use novamind_world::identifiers::Group;

impl CompanyView<'_> {
    /// Returns the outlook of the company with its current settings.
    pub fn outlook(&self) -> Outlook {
        let (world, limits) = (&self.simulation.world, &self.simulation.params.limits);
        Outlook::new(
            world.finance.cash,
            CommittedCosts {
                total: self.daily_cost(&world.settings),
                advertising: world.settings.targeted_ads.total(),
            },
            &self.billing_calendar(),
            &self.history.weeks,
            &limits.prediction_horizons_days,
        )
    }

    /// Returns the bills that current subscribers receive if they stay. All of its values follow from the tables
    /// `subscriptions` and `enterprise_turns`.
    fn billing_calendar(&self) -> BillingCalendar {
        let mut calendar = BillingCalendar::new(self.simulation.params.billing.billing_period_days);
        let suspended = self.suspended_enterprises();
        for (group, block) in self.simulation.world.customers.blocks() {
            self.add_block(&mut calendar, group, block, &suspended);
        }
        calendar
    }

    fn add_block(
        &self,
        calendar: &mut BillingCalendar,
        group: Group,
        block: &Block,
        suspended: &BTreeSet<u32>,
    ) {
        let (world, params) = (&self.simulation.world, &self.simulation.params);
        let (period, week) = (params.billing.billing_period_days, params.run.days_per_week);
        let tomorrow = (world.day + 1) % period;
        for at in 0..block.len() {
            let days = ((u32::from(block.billing_day[at]) + period - tomorrow) % period) as usize;
            let price = block.effective_price[at];
            if group.is_enterprise() {
                // An enterprise that threatens to cancel pays nothing until its thread ends.
                let pays_nothing = days < week as usize && suspended.contains(&block.customer[at]);
                calendar.enterprises[days] +=
                    if pays_nothing { 0.0 } else { price * block.seats[at].trunc() };
            } else {
                // A price cut applies to existing subscribers, and a price increase does not.
                calendar.individuals[days] += price.min(world.settings.core.prices[block.plan[at]]);
                let age = world.day.saturating_sub(block.start_day[at]) / week.max(1);
                if let Some(signed_up) = calendar.signed_up.get_mut(age as usize) {
                    *signed_up += price;
                }
            }
        }
    }

    /// Returns the customer numbers of the enterprises that threaten to cancel.
    fn suspended_enterprises(&self) -> BTreeSet<u32> {
        let threads = self.simulation.world.enterprise.threads.iter();
        let open = threads.filter(|thread| thread.kind == ThreadKind::ChurnPrevention && thread.is_open());
        open.map(|thread| thread.customer).collect()
    }
}
