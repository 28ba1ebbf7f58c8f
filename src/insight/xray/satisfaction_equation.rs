//! What moved the mean satisfaction of a group on a day: the terms of the mechanism, each as a mean over its subscribers.

use std::collections::BTreeMap;
use std::ops::AddAssign;

use novamind_world::context::DayContext;
use novamind_world::customers::columns::Block;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::retention::satisfaction::{FeltDay, felt};

/// A term of what a subscriber feels today (docs/mechanics/retention/satisfaction.md).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MoodTerm {
    /// Quality delivered, before the service of the day.
    Delivered,
    /// Overload and outages.
    Service,
    /// The relationship, good or bad.
    Relationship,
    /// Time subscribed.
    Tenure,
    /// A quota below the demand.
    Quota,
    /// Open issues.
    Issues,
    /// In-app ads.
    Ads,
    /// What the price requires.
    Required,
    /// What the market adds to that.
    Expectations,
}

impl MoodTerm {
    /// All terms, in the order in which they are shown.
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

    /// Its name.
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

    /// What it adds for a subscriber; the terms together are its instant satisfaction.
    fn of(self, felt: &FeltDay) -> f64 {
        let own = &felt.experience;
        match self {
            MoodTerm::Delivered => own.delivered + felt.service_penalty,
            MoodTerm::Service => 0.0 - felt.service_penalty,
            MoodTerm::Relationship => own.relationship,
            MoodTerm::Tenure => own.tenure,
            // What is missing to the sum of the others, whatever the quota multiplies.
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
    /// A block whose satisfaction is about to move.
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

/// The satisfaction of a group on a day.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct SatisfactionDay {
    sums: MoodSums,
    left: u32,
    weight: f64,
}

/// The blocks of a day, which come in any order.
pub(crate) type MoodsByBlock = BTreeMap<(Group, u32), MoodSums>;

impl SatisfactionDay {
    /// All groups, from the sums of their blocks and who left; `weight` is that of a day.
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
    /// Individuals and companies that left in the course of the day.
    pub left: u32,
    /// Subscribers that came on the day; they have not felt it.
    pub came: u32,
    /// Subscribers in the evening.
    pub subscribers: u32,
    /// Their mean satisfaction; none without any.
    pub evening: Option<f64>,
    /// That of the evenings up to this one, at most 28, the first one first; none where there were no subscribers.
    pub evenings: Vec<Option<f64>>,
    seen: SatisfactionDay,
    yesterday: Option<SatisfactionDay>,
}

impl SatisfactionEquation {
    /// The group on a day, its subscribers in the evening with their mean satisfaction, how it was on the day before, and
    /// the mean satisfaction of evenings.
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

    /// Subscribers that felt the day.
    pub fn felt_by(&self) -> u32 {
        self.seen.sums.count
    }

    /// Their mean satisfaction before the day; none without any.
    pub fn before(&self) -> Option<f64> {
        mean(self.seen.sums.before, self.seen.sums.count)
    }

    /// Their mean satisfaction after it.
    pub fn after(&self) -> Option<f64> {
        mean(self.seen.sums.after, self.seen.sums.count)
    }

    /// Mean of what they felt on the day alone: the sum of the terms.
    pub fn instant(&self) -> Option<f64> {
        mean(self.seen.sums.instant, self.seen.sums.count)
    }

    /// Mean of a term.
    pub fn term(&self, term: MoodTerm) -> Option<f64> {
        mean(self.seen.sums.terms[term as usize], self.seen.sums.count)
    }

    /// Mean of a term on the day before, among those who felt that day.
    pub fn term_yesterday(&self, term: MoodTerm) -> Option<f64> {
        let sums = self.yesterday?.sums;
        mean(sums.terms[term as usize], sums.count)
    }
}

fn mean(sum: f64, count: u32) -> Option<f64> {
    (count > 0).then(|| sum / f64::from(count))
}
