//! The satisfaction equation of a group on a day: the terms of the mechanism, each term as a mean over the subscribers.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use novamind_world::context::DayContext;
use novamind_world::customers::columns::Block;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::retention::satisfaction::{SatisfactionTerms, satisfaction_terms};

/// A term of instant satisfaction (docs/mechanics/retention/satisfaction.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SatisfactionTerm {
    /// Delivered quality before outages and overload.
    Delivered,
    /// Loss due to overload and outages.
    Service,
    /// Relationship to the company; the term can be negative.
    Relationship,
    /// Effect of the tenure of the subscription.
    Tenure,
    /// Loss due to a quota below the demand.
    Quota,
    /// Loss due to open issues.
    Issues,
    /// Loss due to in-app advertising.
    Ads,
    /// Required quality at the subscriber's price.
    Required,
    /// Increase in required quality due to drift and competitors.
    Expectations,
}

impl SatisfactionTerm {
    /// All terms, in display order.
    pub const ALL: [SatisfactionTerm; 9] = [
        SatisfactionTerm::Delivered,
        SatisfactionTerm::Service,
        SatisfactionTerm::Relationship,
        SatisfactionTerm::Tenure,
        SatisfactionTerm::Quota,
        SatisfactionTerm::Issues,
        SatisfactionTerm::Ads,
        SatisfactionTerm::Required,
        SatisfactionTerm::Expectations,
    ];

    /// Returns the identifier of the term.
    pub fn id(self) -> &'static str {
        [
            "delivered",
            "service",
            "relationship",
            "tenure",
            "quota",
            "issues",
            "ads",
            "required",
            "expectations",
        ][self as usize]
    }

    /// Returns the term's value for a subscriber. The sum of all terms is the subscriber's instant satisfaction.
    fn contribution(self, terms: &SatisfactionTerms) -> f64 {
        let experience = &terms.experience;
        match self {
            SatisfactionTerm::Delivered => experience.delivered + terms.service_penalty,
            SatisfactionTerm::Service => 0.0 - terms.service_penalty,
            SatisfactionTerm::Relationship => experience.relationship,
            SatisfactionTerm::Tenure => experience.tenure,
            // Instant satisfaction minus all other terms, because the quota is a factor of several terms.
            SatisfactionTerm::Quota => {
                terms.perceived
                    - (experience.delivered + experience.relationship + experience.tenure
                        - experience.issues
                        - experience.ads)
            }
            SatisfactionTerm::Issues => 0.0 - experience.issues,
            SatisfactionTerm::Ads => 0.0 - experience.ads,
            SatisfactionTerm::Required => 0.0 - terms.required,
            SatisfactionTerm::Expectations => 0.0 - terms.expectation,
        }
    }
}

/// Sums of satisfaction values over subscribers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct SatisfactionSums {
    count: u32,
    before: f64,
    terms: [f64; SatisfactionTerm::ALL.len()],
    instant: f64,
    after: f64,
}

impl SatisfactionSums {
    /// Computes the sums of a block before its satisfaction changes.
    pub(crate) fn from_block(group: Group, block: &Block, day: &DayContext<'_>) -> SatisfactionSums {
        let mut sums = SatisfactionSums { count: block.len() as u32, ..SatisfactionSums::default() };
        for at in 0..block.len() {
            let terms = satisfaction_terms(group, block, at, day);
            sums.before += terms.before;
            sums.instant += terms.instant;
            sums.after += terms.after;
            for (sum, term) in sums.terms.iter_mut().zip(SatisfactionTerm::ALL) {
                *sum += term.contribution(&terms);
            }
        }
        sums
    }
}

impl AddAssign for SatisfactionSums {
    fn add_assign(&mut self, other: SatisfactionSums) {
        self.count += other.count;
        self.before += other.before;
        self.instant += other.instant;
        self.after += other.after;
        for (sum, term) in self.terms.iter_mut().zip(other.terms) {
            *sum += term;
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct SatisfactionDay {
    sums: SatisfactionSums,
    departed: u32,
    weight: f64,
}

/// Sums over the subscribers of each block on a day, by group and block index.
pub(crate) type SatisfactionSumsByBlock = BTreeMap<(Group, u32), SatisfactionSums>;

impl SatisfactionDay {
    /// Combines the sums of the blocks with the cancellations of each group. `weight` is the weight of one day in the
    /// moving average.
    pub(crate) fn by_group(
        blocks: &SatisfactionSumsByBlock,
        left: &ByGroup<u32>,
        weight: f64,
    ) -> ByGroup<SatisfactionDay> {
        let day =
            |group| SatisfactionDay { sums: SatisfactionSums::default(), departed: left[group], weight };
        let mut days = ByGroup::from_fn(day);
        for ((group, _), sums) in blocks {
            days[*group].sums += *sums;
        }
        days
    }
}

/// The satisfaction equation of a group on a day: after = (1 - weight) before + weight (sum of the terms).
#[derive(Debug, Clone, PartialEq)]
pub struct SatisfactionEquation {
    /// Group whose satisfaction is described.
    pub group: Group,
    /// Day of the equation, from 1.
    pub day: u32,
    /// Weight of one day in the moving average, 0..=1.
    pub weight: f64,
    /// Number of individuals and enterprises that cancelled on the day.
    pub departed: u32,
    /// Number of new subscribers on the day, who are excluded from the mean.
    pub joined: u32,
    /// Number of subscribers at the end of the day.
    pub subscribers: u32,
    /// Mean satisfaction of all subscribers at the end of the day; `None` if there are no subscribers.
    pub end_of_day: Option<f64>,
    /// Mean satisfaction at the end of each of up to 28 days, earliest day first. The last value belongs to the day of
    /// the equation. `None` if there are no subscribers.
    pub recent_days: Vec<Option<f64>>,
    today: SatisfactionDay,
    yesterday: Option<SatisfactionDay>,
}

impl SatisfactionEquation {
    /// Creates the equation of a group on a day. `subscribers` and `mean_satisfaction` are the number and the mean
    /// satisfaction of the subscribers at the end of the day.
    pub(crate) fn new(
        group: Group,
        day: u32,
        satisfaction_day: SatisfactionDay,
        (subscribers, mean_satisfaction): (u32, Option<f64>),
        yesterday: Option<SatisfactionDay>,
        recent_days: Vec<Option<f64>>,
    ) -> SatisfactionEquation {
        SatisfactionEquation {
            group,
            day,
            weight: satisfaction_day.weight,
            departed: satisfaction_day.departed,
            joined: (subscribers + satisfaction_day.departed).saturating_sub(satisfaction_day.sums.count),
            subscribers,
            end_of_day: mean_satisfaction,
            recent_days,
            today: satisfaction_day,
            yesterday,
        }
    }

    /// Returns the number of subscribers that the means include.
    pub fn included_subscribers(&self) -> u32 {
        self.today.sums.count
    }

    /// Returns the mean satisfaction before the day, or `None` if there are no subscribers.
    pub fn before(&self) -> Option<f64> {
        mean(self.today.sums.before, self.today.sums.count)
    }

    /// Returns the mean satisfaction after the day.
    pub fn after(&self) -> Option<f64> {
        mean(self.today.sums.after, self.today.sums.count)
    }

    /// Returns the mean instant satisfaction, which is the sum of the terms.
    pub fn instant_satisfaction(&self) -> Option<f64> {
        mean(self.today.sums.instant, self.today.sums.count)
    }

    /// Returns the mean value of a term on the day.
    pub fn term(&self, term: SatisfactionTerm) -> Option<f64> {
        mean(self.today.sums.terms[term as usize], self.today.sums.count)
    }

    /// Returns the mean of a term on the day before, over the subscribers of that day.
    pub fn term_yesterday(&self, term: SatisfactionTerm) -> Option<f64> {
        let sums = self.yesterday?.sums;
        mean(sums.terms[term as usize], sums.count)
    }
}

fn mean(sum: f64, count: u32) -> Option<f64> {
    (count > 0).then(|| sum / f64::from(count))
}
