//! A record of the company's recent days, which the judge of the player's posts uses
//! (docs/mechanics/market/social/chronicle.md).

use crate::canonical::canonical;
use crate::events::ServiceDay;
use crate::identifiers::{ByGroup, ByPlan, Group};
use crate::product::Product;
use crate::quota::Quota;
use crate::settings::Settings;

/// Number of past days in the record, in addition to today.
pub const MEMORY_DAYS: usize = 28;

/// Record of the company's recent days, oldest first. The last page describes today.
#[derive(Debug, Clone, PartialEq)]
pub struct Chronicle {
    days: Vec<Page>,
}

/// The record of one day of the company.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Day that the page describes.
    pub day: u32,
    /// Sum of general bonus and group bonus, by group.
    pub bonus: ByGroup<f64>,
    /// General bonus, which applies to all groups.
    pub shared_bonus: f64,
    /// List prices, dollars per month.
    pub prices: ByPlan<f64>,
    /// Quotas, units per day.
    pub quotas: ByPlan<Quota>,
    /// The largest discount that a customer could get, dollars per month.
    pub discount: f64,
    /// Whether the service had an outage.
    pub outage: bool,
    /// Usage above capacity as a share of capacity.
    pub overload: f64,
    /// 95th percentile of the latency, in milliseconds; `None` on day 0.
    pub p95_ms: Option<f64>,
}

canonical! {
    Chronicle { days }
    Page { day, bonus, shared_bonus, prices, quotas, discount, outage, overload, p95_ms }
}

impl Chronicle {
    /// Creates a chronicle with the page of day 0.
    pub fn initial(settings: &Settings) -> Chronicle {
        let page = Page {
            day: 0,
            bonus: ByGroup::default(),
            shared_bonus: 0.0,
            prices: settings.core.prices,
            quotas: settings.core.quotas,
            discount: settings.largest_discount(),
            outage: false,
            overload: 0.0,
            p95_ms: None,
        };
        Chronicle { days: vec![page] }
    }

    /// Appends the page of a day at the end of the day. Removes the oldest page if the chronicle is full.
    pub fn append_day(&mut self, day: u32, service: &ServiceDay, settings: &Settings, product: &Product) {
        let surplus = (self.days.len()).saturating_sub(MEMORY_DAYS);
        self.days.drain(..surplus);
        self.days.push(Page {
            day,
            bonus: ByGroup::from_fn(|group| product.shared_bonus + product.group_bonus[group]),
            shared_bonus: product.shared_bonus,
            prices: settings.core.prices,
            quotas: settings.core.quotas,
            discount: settings.largest_discount(),
            outage: service.outage,
            overload: service.overload,
            p95_ms: Some(service.p95_ms),
        });
    }

    /// Returns the newest page.
    pub fn today(&self) -> &Page {
        self.days.last().expect("a chronicle is never empty")
    }

    /// Returns the page of 28 days ago, or of day 0 if the company is younger.
    pub fn oldest(&self) -> &Page {
        self.days.first().expect("a chronicle is never empty")
    }

    /// Returns the pages of the last `days` days, newest first.
    pub fn newest_first(&self, days: usize) -> impl Iterator<Item = &Page> {
        self.days.iter().rev().take(days)
    }

    /// Returns all pairs of consecutive pages (older, newer), newest pair first.
    pub fn consecutive_pages(&self) -> impl Iterator<Item = (&Page, &Page)> {
        self.days.windows(2).rev().map(|pair| (&pair[0], &pair[1]))
    }

    /// Returns the change in a group's quality bonus over the recorded days.
    pub fn quality_change(&self, group: Group) -> f64 {
        self.today().bonus[group] - self.oldest().bonus[group]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    #[test]
    fn chronicle_keeps_four_weeks() {
        let params = Params::bundled();
        let (mut settings, mut product) = (Settings::initial(&params), Product::initial(&params));
        let mut chronicle = Chronicle::initial(&settings);
        let group = Group::at(0).expect("S1");
        for day in 1..=40 {
            settings.core.prices.0[0] = f64::from(day);
            product.group_bonus[group] += 0.5;
            chronicle.append_day(day, &ServiceDay::without_load(), &settings, &product);
        }
        assert_eq!((chronicle.oldest().day, chronicle.today().day), (12, 40));
        assert_eq!(chronicle.quality_change(group), 14.0);
        assert_eq!(chronicle.newest_first(14).last().map(|page| page.day), Some(27));
        assert_eq!(
            chronicle.consecutive_pages().next().map(|(before, after)| (before.day, after.day)),
            Some((39, 40))
        );
    }
}
