//! Recorder of the changes in a figure on one day.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::target::WriteTarget;
use super::{FigureWrite, FigureWrites, WriteSource};
use novamind_world::day::observer::DayObserver;
use novamind_world::events::{
    Category, DayFigures, Facts, LedgerEntry, Source, SubscriptionEnded, SubscriptionStatus,
};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::reputation::ReputationWrite;
use novamind_world::state::World;

/// A recorder of the changes in a figure on one day.
pub(super) struct WriteRecorder {
    target: WriteTarget,
    day: u32,
    recorded: Mutex<RecordedWrites>,
}

struct RecordedWrites {
    /// Value of the figure at the end of the previous day.
    opening_value: f64,
    /// Changes since the end of the previous day.
    writes: Vec<FigureWrite>,
    /// Company figures of the day.
    figures: DayFigures,
    /// Changes on the requested day; `None` until the day is simulated.
    result: Option<FigureWrites>,
}

impl RecordedWrites {
    /// Returns the value of the figure after all recorded changes.
    fn current_value(&self) -> f64 {
        self.writes.last().map_or(self.opening_value, |write| write.after)
    }

    /// Adds an amount with the same floating-point operations as the simulator.
    fn add_amount(&mut self, by: WriteSource, amount: f64) {
        let before = self.current_value();
        self.push_write(by, &[amount], before, before + amount);
    }

    /// Appends changes. Merges them with the previous changes if the same mechanism made both.
    fn push_write(&mut self, by: WriteSource, changes: &[f64], before: f64, after: f64) {
        match self.writes.last_mut().filter(|write| write.source == by) {
            Some(write) => {
                write.changes.extend_from_slice(changes);
                write.after = after;
            }
            None => self.writes.push(FigureWrite { source: by, changes: changes.to_vec(), before, after }),
        }
    }

    fn add_ledger_entries(&mut self, entries: &[LedgerEntry]) {
        entries
            .iter()
            .for_each(|entry| self.add_amount(WriteSource::LedgerEntries(entry.category), entry.amount));
    }
}

impl WriteRecorder {
    /// Creates a recorder for a figure on a day. `opening` is the figure's value before day 1.
    pub(super) fn new(target: WriteTarget, day: u32, opening: f64) -> WriteRecorder {
        let pages = RecordedWrites {
            opening_value: opening,
            writes: Vec::new(),
            figures: DayFigures::default(),
            result: None,
        };
        WriteRecorder { target, day, recorded: Mutex::new(pages) }
    }

    /// Removes and returns the changes of the day, or `None` if the day was not simulated.
    pub(super) fn take_result(&self) -> Option<FigureWrites> {
        self.lock().result.take()
    }

    fn lock(&self) -> MutexGuard<'_, RecordedWrites> {
        self.recorded.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn figure_in(&self, world: &World) -> f64 {
        match self.target {
            WriteTarget::Reputation(group) => world.market.reputation.get(group),
            WriteTarget::Cash => world.finance.cash,
            WriteTarget::Subscribers(group) => world.customers.groups[group].active_count().into(),
        }
    }
}

impl DayObserver for WriteRecorder {
    fn on_call_applied(&self, facts: &Facts) {
        if self.target == WriteTarget::Cash {
            self.lock().add_ledger_entries(&facts.ledger);
        }
    }

    fn on_reputation_change(&self, write: &ReputationWrite<'_>) {
        if self.target != WriteTarget::Reputation(write.group) {
            return;
        }
        let &ReputationWrite { cause, changes, before, after, .. } = write;
        self.lock().push_write(WriteSource::Reputation(cause), changes, before, after);
    }

    fn on_day_figures(&self, figures: &DayFigures) {
        self.lock().figures = *figures;
    }

    fn on_day_end(&self, world: &World, params: &Params, facts: &Facts) {
        let mut pages = self.lock();
        let last = self.figure_in(world);
        if world.day == self.day {
            match self.target {
                WriteTarget::Reputation(_) => {}
                WriteTarget::Cash => add_cash_writes(&mut pages, params, facts),
                WriteTarget::Subscribers(group) => add_subscriber_writes(&mut pages, group, world, facts),
            }
            let (first, writes) = (pages.opening_value, std::mem::take(&mut pages.writes));
            pages.result = Some(FigureWrites {
                target: self.target,
                day: self.day,
                opening_value: first,
                closing_value: last,
                writes,
            });
        }
        pages.writes.clear();
        pages.opening_value = last;
    }
}

/// Adds the changes in cash on a day, in this order: lead costs, payments of subscribers, other ledger entries.
fn add_cash_writes(pages: &mut RecordedWrites, params: &Params, facts: &Facts) {
    let DayFigures { new_leads, payments_received, .. } = pages.figures;
    let leads = f64::from(new_leads) * params.leads.lead_acquisition_cost;
    pages.add_amount(WriteSource::LedgerEntries(Category::LeadAcquisitionCost), -leads);
    pages.add_amount(WriteSource::LedgerEntries(Category::SubscriptionPayment), payments_received);
    pages.add_ledger_entries(&facts.ledger);
}

/// Adds the changes in a group's subscriptions: cancellations by reason and new subscribers by source.
fn add_subscriber_writes(pages: &mut RecordedWrites, group: Group, world: &World, facts: &Facts) {
    let has_left = |subscription_ended: &&SubscriptionEnded| {
        subscription_ended.group == group && subscription_ended.status == SubscriptionStatus::Cancelled
    };
    let mut left: Vec<_> = facts.endings.iter().filter(has_left).collect();
    left.sort_by_key(|ended| ended.cause as u8);
    left.into_iter().for_each(|ended| pages.add_amount(WriteSource::Cancellations(ended.cause), -1.0));
    for source in Source::ALL {
        let arrivals =
            facts.arrivals.iter().filter(|arrival| arrival.group == group && arrival.source == source);
        let signed = |customer: u32| {
            let mut openings = facts.openings.iter().filter(|opening| opening.customer == customer);
            openings.any(|opening| opening.status == SubscriptionStatus::Subscribed)
        };
        let count = arrivals.filter(|arrival| signed(arrival.customer)).count();
        (0..count).for_each(|_| pages.add_amount(WriteSource::Signups(source), 1.0));
    }
    let of_group = |customer: u32| {
        world.enterprise.enterprise_customer(customer).is_some_and(|company| company.group == group)
    };
    let deals = facts.deals.iter().filter(|deal| deal.activated && of_group(deal.customer));
    deals.for_each(|_| pages.add_amount(WriteSource::FirstDeals, 1.0));
}
