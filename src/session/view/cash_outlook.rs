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

    /// Returns the bills that current subscribers receive if they stay. All values of the calendar follow from the
    /// tables `subscriptions` and `enterprise_turns`.
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
                // A price cut applies to existing subscribers, but a price increase does not.
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use crate::create::{NewRun, Storage};
    use crate::play::Session;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;

    /// Plays eight weeks with signups.
    fn played_session() -> Session {
        let new = NewRun { seed: Some(7), storage: Storage::Memory, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        for (tool, arguments) in [
            ("set_prices", json!({ "A": 12, "B": 25, "C": 55 })),
            ("set_usage_quotas", json!({ "A": 60_000, "B": 250_000, "C": 1_200_000 })),
            ("set_targeted_dev_spend", json!({ "targeted_spend": { "S1": 6_000 } })),
            ("set_targeted_ad_spend", json!({ "targeted_spend": { "content_marketing": { "S1": 3_000 } } })),
        ] {
            session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
        }
        for _ in 0..8 {
            let forecasts = session.company().naive_forecasts();
            session.advance("test", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        }
        session
    }

    #[test]
    fn billing_calendar_follows_from_the_visible_tables() {
        let mut session = played_session();
        let calendar = session.company().billing_calendar();
        let day = session.day();
        let sql = format!(
            "SELECT (billing_day_mod30 + 59 - {day} % 30) % 30 AS days, total(effective_price) FROM subscriptions \
             JOIN customers USING (customer_id) WHERE status = 'subscribed' AND customer_type = 'small' GROUP BY 1"
        );
        let mut bills = vec![0.0; 30];
        for row in &session.query(&sql).expect("bills").rows {
            bills[novamind_database::number_at(row, 0) as usize] = novamind_database::number_at(row, 1);
        }
        assert!(bills.iter().sum::<f64>() > 1_000.0, "{bills:?}");
        for (due, expected) in calendar.individuals.iter().zip(&bills) {
            assert!((due - expected).abs() < 1e-6, "{:?} {bills:?}", calendar.individuals);
        }
        let sql = format!(
            "SELECT total(effective_price) FROM subscriptions JOIN customers USING (customer_id) \
             WHERE status = 'subscribed' AND customer_type = 'small' AND start_day > {day} - 7"
        );
        let new = novamind_database::number_at(&session.query(&sql).expect("signups").rows[0], 0);
        assert!(new > 0.0 && (calendar.signed_up[0] - new).abs() < 1e-6, "{:?} {new}", calendar.signed_up);
    }

    #[test]
    fn runway_flows_and_forecasts_come_from_one_outlook() {
        let session = played_session();
        let (seen, naive) = (session.company().observe(), session.company().naive_forecasts());
        let month = naive.all[1];
        assert!((month.point - seen.outlook.expected_cash(28)).abs() < 0.01);
        let flows = seen.expected_flows();
        let change = 4.0 * (flows.income - flows.variable - 7.0 * seen.committed);
        assert!((seen.cash + change - month.point).abs() < 0.02, "{change} {month:?}");
        assert_eq!(seen.runway, seen.outlook.runway(seen.days_left()));
        assert_eq!(seen.horizons_in_run, 4);
    }

    #[test]
    fn horizons_beyond_the_last_day_are_not_asked_for() {
        let new = NewRun { days: Some(84), storage: Storage::Memory, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        assert_eq!(session.company().horizons_in_run(), 3);
        let forecasts = session.company().naive_forecasts();
        session.advance("test", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        assert_eq!(session.company().horizons_in_run(), 2);
    }
}
