//! What the public remembers of the company: a short record of every day, which a judge of its posts may consult
//! (docs/mechanics/market/social/chronicle.md).

use crate::canonical::canonical;
use crate::events::ServiceDay;
use crate::identifiers::{ByGroup, ByPlan, Group};
use crate::product::Product;
use crate::quota::Quota;
use crate::settings::Settings;

/// Days that are remembered besides today.
pub const MEMORY_DAYS: usize = 28;

/// The last days, oldest first; today is the last one.
#[derive(Debug, Clone, PartialEq)]
pub struct Chronicle {
    days: Vec<Page>,
}

/// One day.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Day.
    pub day: u32,
    /// Quality gained so far, shared and for the group.
    pub bonus: ByGroup<f64>,
    /// Shared quality gained so far.
    pub shared_bonus: f64,
    /// List prices, dollars a month.
    pub prices: ByPlan<f64>,
    /// Quotas, units a day.
    pub quotas: ByPlan<Quota>,
    /// The largest discount anybody could have, dollars a month.
    pub discount: f64,
    /// Whether there was an outage.
    pub outage: bool,
    /// Usage above capacity.
    pub overload: f64,
    /// Latency, ms; none on day 0.
    pub p95_ms: Option<f64>,
}

canonical! {
    Chronicle { days }
    Page { day, bonus, shared_bonus, prices, quotas, discount, outage, overload, p95_ms }
}

impl Chronicle {
    /// The record of day 0.
    pub fn opening(settings: &Settings) -> Chronicle {
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

    /// Writes a page at the end of a day and forgets what is too old.
    pub fn write(&mut self, day: u32, service: &ServiceDay, settings: &Settings, product: &Product) {
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

    /// The newest page.
    pub fn today(&self) -> &Page {
        self.days.last().expect("a chronicle is never empty")
    }

    /// The page of 28 days ago, or of day 0 while the company is younger.
    pub fn oldest(&self) -> &Page {
        self.days.first().expect("a chronicle is never empty")
    }

    /// The newest pages, newest first.
    pub fn last(&self, days: usize) -> impl Iterator<Item = &Page> {
        self.days.iter().rev().take(days)
    }

    /// All pages with the one before, newest first.
    pub fn steps(&self) -> impl Iterator<Item = (&Page, &Page)> {
        self.days.windows(2).rev().map(|pair| (&pair[0], &pair[1]))
    }

    /// Change of the quality of a group over the memory.
    pub fn progress(&self, group: Group) -> f64 {
        self.today().bonus[group] - self.oldest().bonus[group]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    #[test]
    fn four_weeks_are_remembered() {
        let params = Params::shipped();
        let (mut settings, mut product) = (Settings::opening(&params), Product::opening(&params));
        let mut chronicle = Chronicle::opening(&settings);
        let group = Group::at(0).expect("S1");
        for day in 1..=40 {
            settings.core.prices.0[0] = f64::from(day);
            product.group_bonus[group] += 0.5;
            chronicle.write(day, &ServiceDay::quiet(), &settings, &product);
        }
        assert_eq!((chronicle.oldest().day, chronicle.today().day), (12, 40));
        assert_eq!(chronicle.progress(group), 14.0);
        assert_eq!(chronicle.last(14).last().map(|page| page.day), Some(27));
        assert_eq!(chronicle.steps().next().map(|(before, after)| (before.day, after.day)), Some((39, 40)));
    }
}
