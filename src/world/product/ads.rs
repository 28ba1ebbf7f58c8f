//! Revenue from in-app advertising (`docs/mechanics/product/ads.md`). Module `quality` computes the quality loss from
//! advertising.

use crate::customers::Customers;
use crate::customers::columns::Block;
use crate::events::{AdsRevenueRow, Facts};
use crate::identifiers::{ByGroup, Group};
use crate::params::Params;
use crate::quality::ads_effect;
use crate::settings::AdsStrength;

/// Effective strengths of in-app advertising by group, and for customers with an individual setting.
#[derive(Debug, Clone)]
pub struct AdLoad<'a> {
    setting: &'a AdsStrength,
    by_group: ByGroup<f64>,
    has_customer_settings: bool,
    params: &'a Params,
}

impl<'a> AdLoad<'a> {
    /// Computes the effective strengths from the settings of in-app advertising.
    pub fn new(setting: &'a AdsStrength, params: &'a Params) -> AdLoad<'a> {
        AdLoad {
            setting,
            by_group: ByGroup::from_fn(|group| ads_effect(setting.for_group(group), &params.ads)),
            has_customer_settings: !setting.by_customer.is_empty(),
            params,
        }
    }

    /// Returns the effective strength in decisions and negotiations: global + group.
    #[inline]
    pub fn for_group(&self, group: Group) -> f64 {
        self.by_group[group]
    }

    /// Returns the effective strength for satisfaction and revenue: global + group + customer.
    #[inline]
    pub fn for_customer(&self, group: Group, customer: u32) -> f64 {
        if self.has_customer_settings {
            self.for_single_customer(group, customer)
        } else {
            self.by_group[group]
        }
    }

    /// Returns the strength for a customer with an individual setting. A separate function keeps the common case fast.
    #[cold]
    fn for_single_customer(&self, group: Group, customer: u32) -> f64 {
        let value = self.setting.for_customer(customer);
        if value == 0.0 {
            self.by_group[group]
        } else {
            ads_effect(self.setting.for_group(group) + value, &self.params.ads)
        }
    }

    /// Returns whether any customer can see ads.
    pub fn is_used(&self) -> bool {
        self.setting.is_used()
    }
}

/// Returns today's ad revenue in dollars: the sum over all subscribers of sensitivity times effective strength times
/// whole seats. Records one row per subscriber with revenue.
pub fn record_ad_revenue(customers: &Customers, load: &AdLoad<'_>, facts: &mut Facts) -> f64 {
    if !load.is_used() {
        return 0.0;
    }
    let by_block = customers.map_blocks(|group, block| block_ad_revenue(group, block, load));
    let mut revenue = 0.0;
    for (sum, rows) in by_block {
        revenue += sum;
        facts.ads_revenue.extend(rows);
    }
    revenue
}

fn block_ad_revenue(group: Group, block: &Block, load: &AdLoad<'_>) -> (f64, Vec<AdsRevenueRow>) {
    let (mut sum, mut rows) = (0.0, Vec::new());
    for at in 0..block.len() {
        let customer = block.customer[at];
        let strength = load.for_customer(group, customer);
        if strength > 0.0 {
            let revenue = block.ads_return_sensitivity[at] * strength * block.seats[at].trunc();
            sum += revenue;
            rows.push(AdsRevenueRow { customer, group, strength, revenue });
        }
    }
    (sum, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::customers::columns::Subscriber;
    use crate::settings::{PerCustomer, PerGroup};
    use crate::test_kit::subscriber;

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-9, "got {actual}, expected {expected}");
    }

    #[test]
    fn ad_strengths_add_up_before_the_curve() {
        let params = Params::bundled();
        let (s1, e1) = (Group::at(0).expect("S1"), Group::at(3).expect("E1"));
        let setting = AdsStrength {
            global: 0.2,
            by_group: PerGroup::from([(s1, 0.1)]),
            by_customer: PerCustomer::from([(5, 0.3)]),
        };
        let load = AdLoad::new(&setting, &params);
        assert_near(load.for_customer(e1, 1), 0.447158031);
        assert_near(load.for_customer(s1, 1), 0.568201724);
        assert_near(load.for_customer(s1, 5), 0.806179974);
        assert_near(load.for_customer(e1, 5), 0.740362689);
        assert_near(load.for_group(s1), 0.568201724);
        let full =
            AdsStrength { global: 0.8, by_group: PerGroup::from([(s1, 0.7)]), ..AdsStrength::default() };
        assert_near(AdLoad::new(&full, &params).for_customer(s1, 1), 1.0);
    }

    #[test]
    fn ad_revenue_depends_on_sensitivity_and_strength() {
        let params = Params::bundled();
        let setting = AdsStrength { global: 0.1, ..AdsStrength::default() };
        let mut customers = Customers::default();
        let mut facts = Facts::default();
        (1..=5).for_each(|n| customers.groups[Group::at(0).expect("S1")].activate(subscriber(n)));
        assert_near(record_ad_revenue(&customers, &AdLoad::new(&setting, &params), &mut facts), 0.111501440);
        assert_eq!(facts.ads_revenue.len(), 5);
    }

    #[test]
    fn only_whole_seats_earn_ad_revenue() {
        let params = Params::bundled();
        let setting = AdsStrength { global: 0.1, ..AdsStrength::default() };
        let load = AdLoad::new(&setting, &params);
        let earned = |seats: f64| {
            let mut customers = Customers::default();
            let e1 = Group::at(3).expect("E1");
            customers.groups[e1].activate(Subscriber { seats, ..subscriber(1) });
            record_ad_revenue(&customers, &load, &mut Facts::default())
        };
        assert_eq!(earned(2.9), earned(2.0));
        assert_near(earned(3.0), 1.5 * earned(2.9));
    }
}
