//! Records the changes of a figure on one day.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::target::WriteTarget;
use super::{WhoWrites, Write, WrittenBy};
use novamind_world::day::watch::DayWatch;
use novamind_world::events::{
    Category, DayFigures, Facts, LedgerEntry, Source, SubscriptionEnded, SubscriptionStatus,
};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::reputation::ReputationWrite;
use novamind_world::state::World;

/// Records the changes of a figure on one day.
pub(super) struct WriteDiary {
    target: WriteTarget,
    day: u32,
    pages: Mutex<WritePages>,
}

struct WritePages {
    /// Value at the end of the day before.
    first: f64,
    /// Changes since then.
    writes: Vec<Write>,
    /// The result after the day.
    figures: DayFigures,
    /// Requested day.
    kept: Option<WhoWrites>,
}

impl WritePages {
    /// Returns the value after all changes.
    fn now(&self) -> f64 {
        self.writes.last().map_or(self.first, |write| write.after)
    }

    /// Adds an amount in the same way as the simulator.
    fn add(&mut self, by: WrittenBy, amount: f64) {
        let before = self.now();
        self.write(by, &[amount], before, before + amount);
    }

    /// Merges consecutive changes of one mechanism.
    fn write(&mut self, by: WrittenBy, changes: &[f64], before: f64, after: f64) {
        match self.writes.last_mut().filter(|write| write.by == by) {
            Some(write) => {
                write.changes.extend_from_slice(changes);
                write.after = after;
            }
            None => self.writes.push(Write { by, changes: changes.to_vec(), before, after }),
        }
    }

    fn book(&mut self, entries: &[LedgerEntry]) {
        entries.iter().for_each(|entry| self.add(WrittenBy::Booked(entry.category), entry.amount));
    }
}

impl WriteDiary {
    /// Creates a recorder of a figure on a day, with its value before day 1.
    pub(super) fn of(target: WriteTarget, day: u32, opening: f64) -> WriteDiary {
        let pages =
            WritePages { first: opening, writes: Vec::new(), figures: DayFigures::default(), kept: None };
        WriteDiary { target, day, pages: Mutex::new(pages) }
    }

    /// Takes the changes of the day; `None` if the day was not simulated.
    pub(super) fn take(&self) -> Option<WhoWrites> {
        self.pages().kept.take()
    }

    fn pages(&self) -> MutexGuard<'_, WritePages> {
        self.pages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn read(&self, world: &World) -> f64 {
        match self.target {
            WriteTarget::Reputation(group) => world.market.reputation.of(group),
            WriteTarget::Cash => world.finance.cash,
            WriteTarget::Subscribers(group) => world.customers.groups[group].active().into(),
        }
    }
}

impl DayWatch for WriteDiary {
    fn called(&self, facts: &Facts) {
        if self.target == WriteTarget::Cash {
            self.pages().book(&facts.ledger);
        }
    }

    fn reputation_moved(&self, write: &ReputationWrite<'_>) {
        if self.target != WriteTarget::Reputation(write.group) {
            return;
        }
        let &ReputationWrite { cause, changes, before, after, .. } = write;
        self.pages().write(WrittenBy::Reputation(cause), changes, before, after);
    }

    fn day_counted(&self, figures: &DayFigures) {
        self.pages().figures = *figures;
    }

    fn day_over(&self, world: &World, params: &Params, facts: &Facts) {
        let mut pages = self.pages();
        let last = self.read(world);
        if world.day == self.day {
            match self.target {
                WriteTarget::Reputation(_) => {}
                WriteTarget::Cash => book_day(&mut pages, params, facts),
                WriteTarget::Subscribers(group) => count_day(&mut pages, group, world, facts),
            }
            let (first, writes) = (pages.first, std::mem::take(&mut pages.writes));
            pages.kept = Some(WhoWrites { target: self.target, day: self.day, first, last, writes });
        }
        pages.writes.clear();
        pages.first = last;
    }
}

/// Adds changes of cash in the order of the day: lead costs, payments of subscribers, other ledger entries.
fn book_day(pages: &mut WritePages, params: &Params, facts: &Facts) {
    let DayFigures { new_leads, payments_received, .. } = pages.figures;
    let leads = f64::from(new_leads) * params.leads.lead_acquisition_cost;
    pages.add(WrittenBy::Booked(Category::LeadAcquisitionCost), -leads);
    pages.add(WrittenBy::Booked(Category::SubscriptionPayment), payments_received);
    pages.book(&facts.ledger);
}

/// Adds cancellations by reason and new subscribers by source.
fn count_day(pages: &mut WritePages, group: Group, world: &World, facts: &Facts) {
    let has_left =
        |own: &&SubscriptionEnded| own.group == group && own.status == SubscriptionStatus::Cancelled;
    let mut left: Vec<_> = facts.endings.iter().filter(has_left).collect();
    left.sort_by_key(|own| own.cause as u8);
    left.into_iter().for_each(|own| pages.add(WrittenBy::Left(own.cause), -1.0));
    for source in Source::ALL {
        let came = facts.arrivals.iter().filter(|own| own.group == group && own.source == source);
        let signed = |customer: u32| {
            let mut own = facts.openings.iter().filter(|opening| opening.customer == customer);
            own.any(|opening| opening.status == SubscriptionStatus::Subscribed)
        };
        let count = came.filter(|own| signed(own.customer)).count();
        (0..count).for_each(|_| pages.add(WrittenBy::SignedUp(source), 1.0));
    }
    let of_group = |customer: u32| world.enterprise.company(customer).is_some_and(|own| own.group == group);
    let deals = facts.deals.iter().filter(|deal| deal.activated && of_group(deal.customer));
    deals.for_each(|_| pages.add(WrittenBy::FirstDeals, 1.0));
}
