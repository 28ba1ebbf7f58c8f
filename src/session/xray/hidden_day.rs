//! What is kept of a day that was watched.

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::world::day::watch::DayWatch;
use crate::world::events::Facts;
use crate::world::identifiers::{ByGroup, Group};
use crate::world::market::arrivals::{Arrivals, lead_context};
use crate::world::market::leads::{LeadFactors, word_of_mouth};
use crate::world::params::Params;
use crate::world::state::World;

/// A day, as far as groups and the market go.
#[derive(Debug, Clone, Default)]
pub(in crate::session) struct HiddenDay {
    /// Which groups were known.
    pub(in crate::session) known: ByGroup<bool>,
    /// Factors of the leads.
    pub(in crate::session) leads: ByGroup<LeadFactors>,
    /// Leads by word of mouth before the factors, by the group whose subscribers bring them.
    pub(in crate::session) word_of_mouth: ByGroup<Vec<(Group, f64)>>,
    /// Leads that came.
    pub(in crate::session) came: ByGroup<u32>,
}

/// Keeps every day that is simulated.
#[derive(Debug, Default)]
pub(in crate::session) struct Diary {
    pages: Mutex<Pages>,
}

#[derive(Debug, Default)]
struct Pages {
    /// Days that are over, day 1 first.
    days: Vec<HiddenDay>,
    /// The day that is simulated.
    today: HiddenDay,
}

impl Diary {
    /// A day that is over, from 1.
    pub(in crate::session) fn day(&self, day: u32) -> Option<HiddenDay> {
        self.pages().days.get(day.checked_sub(1)? as usize).cloned()
    }

    fn pages(&self) -> MutexGuard<'_, Pages> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl DayWatch for Diary {
    fn leads_expected(
        &self,
        arrivals: &Arrivals<'_>,
        subscribers: &ByGroup<u32>,
        factors: &ByGroup<LeadFactors>,
    ) {
        let context = lead_context(arrivals, subscribers);
        let known = ByGroup::from_fn(|group| arrivals.market.is_known(group));
        let mut pages = self.pages();
        pages.today.word_of_mouth = ByGroup::from_fn(|group| match known[group] {
            true => word_of_mouth(group, &context).collect(),
            false => Vec::new(),
        });
        (pages.today.known, pages.today.leads) = (known, *factors);
    }

    fn day_over(&self, _: &World, _: &Params, facts: &Facts) {
        let mut pages = self.pages();
        facts.arrivals.iter().for_each(|arrival| pages.today.came[arrival.group] += 1);
        let today = std::mem::take(&mut pages.today);
        pages.days.push(today);
    }
}
