//! The satisfaction equation of a group on a day: the terms of the mechanism, each as a mean over the subscribers.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use novamind_world::context::DayContext;
use novamind_world::customers::columns::Block;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::retention::satisfaction::{FeltDay, felt};

/// A term of instant satisfaction (docs/mechanics/retention/satisfaction.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MoodTerm {
    /// Delivered quality, before the service of the day.
    Delivered,
    /// Overload and outages.
    Service,
    /// Relationship, positive or negative.
    Relationship,
    /// Tenure.
    Tenure,
    /// A quota below the demand.
    Quota,
    /// Open issues.
    Issues,
    /// In-app ads.
    Ads,
    /// Required quality at the price.
    Required,
    /// The market's addition to required quality.
    Expectations,
}

impl MoodTerm {
    /// All terms in display order.
    pub const ALL: [MoodTerm; 9] = [
        MoodTerm::Delivered,
        MoodTerm::Service,
        MoodTerm::Relationship,
        MoodTerm::Tenure,
        MoodTerm::Quota,
        MoodTerm::Issues,
        MoodTerm::Ads,
        MoodTerm::Required,
        MoodTerm::Expectations,
    ];

    /// Returns the name.
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

    /// Returns the value of the term for each subscriber. The sum of the terms is instant satisfaction.
    fn of(self, felt: &FeltDay) -> f64 {
        let own = &felt.experience;
        match self {
            MoodTerm::Delivered => own.delivered + felt.service_penalty,
            MoodTerm::Service => 0.0 - felt.service_penalty,
            MoodTerm::Relationship => own.relationship,
            MoodTerm::Tenure => own.tenure,
            // The remainder to the sum of all other terms, because the quota is a factor of several terms.
            MoodTerm::Quota => {
                felt.perceived - (own.delivered + own.relationship + own.tenure - own.issues - own.ads)
            }
            MoodTerm::Issues => 0.0 - own.issues,
            MoodTerm::Ads => 0.0 - own.ads,
            MoodTerm::Required => 0.0 - felt.required,
            MoodTerm::Expectations => 0.0 - felt.expectation,
        }
    }
}

/// Sums over subscribers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct MoodSums {
    count: u32,
    before: f64,
    terms: [f64; MoodTerm::ALL.len()],
    instant: f64,
    after: f64,
}

impl MoodSums {
    /// Sums a block before its satisfaction changes.
    pub(crate) fn of(group: Group, block: &Block, day: &DayContext<'_>) -> MoodSums {
        let mut sums = MoodSums { count: block.len() as u32, ..MoodSums::default() };
        for at in 0..block.len() {
            let own = felt(group, block, at, day);
            sums.before += own.before;
            sums.instant += own.instant;
            sums.after += own.after;
            for (sum, term) in sums.terms.iter_mut().zip(MoodTerm::ALL) {
                *sum += term.of(&own);
            }
        }
        sums
    }
}

impl AddAssign for MoodSums {
    fn add_assign(&mut self, other: MoodSums) {
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
    sums: MoodSums,
    left: u32,
    weight: f64,
}

/// Sums of a day's blocks, in any order.
pub(crate) type MoodsByBlock = BTreeMap<(Group, u32), MoodSums>;

impl SatisfactionDay {
    /// Combines the blocks of all groups with their cancellations. `weight` is the weight of a day.
    pub(crate) fn by_group(
        blocks: &MoodsByBlock,
        left: &ByGroup<u32>,
        weight: f64,
    ) -> ByGroup<SatisfactionDay> {
        let day = |group| SatisfactionDay { sums: MoodSums::default(), left: left[group], weight };
        let mut days = ByGroup::from_fn(day);
        for ((group, _), sums) in blocks {
            days[*group].sums += *sums;
        }
        days
    }
}

/// The mean satisfaction of a group on a day: after = (1 - weight) before + weight (sum of the terms).
#[derive(Debug, Clone, PartialEq)]
pub struct SatisfactionEquation {
    /// The group.
    pub group: Group,
    /// The day, from 1.
    pub day: u32,
    /// Weight of a day, 0..=1.
    pub weight: f64,
    /// Number of individuals and enterprises that cancelled on the day.
    pub left: u32,
    /// Number of new subscribers of the day, who are not in the mean.
    pub came: u32,
    /// Number of subscribers at the end of the day.
    pub subscribers: u32,
    /// Their mean satisfaction; `None` without subscribers.
    pub evening: Option<f64>,
    /// Mean satisfaction at the end of up to 28 days, in ascending order; this day is last. `None` without subscribers.
    pub evenings: Vec<Option<f64>>,
    seen: SatisfactionDay,
    yesterday: Option<SatisfactionDay>,
}

impl SatisfactionEquation {
    /// Creates the equation of a group on a day from its subscribers at the end of the day with their mean satisfaction, the
    /// day before, and the mean satisfaction of recent days.
    pub(crate) fn of(
        group: Group,
        day: u32,
        own: SatisfactionDay,
        (subscribers, evening): (u32, Option<f64>),
        yesterday: Option<SatisfactionDay>,
        evenings: Vec<Option<f64>>,
    ) -> SatisfactionEquation {
        SatisfactionEquation {
            group,
            day,
            weight: own.weight,
            left: own.left,
            came: (subscribers + own.left).saturating_sub(own.sums.count),
            subscribers,
            evening,
            evenings,
            seen: own,
            yesterday,
        }
    }

    /// Returns the number of subscribers in the mean.
    pub fn felt_by(&self) -> u32 {
        self.seen.sums.count
    }

    /// Returns their mean satisfaction before the day; `None` without subscribers.
    pub fn before(&self) -> Option<f64> {
        mean(self.seen.sums.before, self.seen.sums.count)
    }

    /// Returns their mean satisfaction after the day.
    pub fn after(&self) -> Option<f64> {
        mean(self.seen.sums.after, self.seen.sums.count)
    }

    /// Returns their mean instant satisfaction, the sum of the terms.
    pub fn instant(&self) -> Option<f64> {
        mean(self.seen.sums.instant, self.seen.sums.count)
    }

    /// Returns the mean of a term.
    pub fn term(&self, term: MoodTerm) -> Option<f64> {
        mean(self.seen.sums.terms[term as usize], self.seen.sums.count)
    }

    /// Returns the mean of a term on the day before, over the subscribers of that day.
    pub fn term_yesterday(&self, term: MoodTerm) -> Option<f64> {
        let sums = self.yesterday?.sums;
        mean(sums.terms[term as usize], sums.count)
    }
}

fn mean(sum: f64, count: u32) -> Option<f64> {
    (count > 0).then(|| sum / f64::from(count))
}
