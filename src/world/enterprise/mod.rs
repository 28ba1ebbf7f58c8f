//! Enterprises: leads that request an offer, subscribers that threaten to leave or request another plan, and
//! their threads (`docs/mechanics/enterprise/README.md`).
//!
//! [`Enterprise::step`] simulates the enterprises on one day. Module [`messages`] sends the messages of the player on
//! a decision day.

pub mod churn;
mod enterprise_customer;
mod evaluation;
pub mod messages;
mod open_threads;
mod outcomes;
mod quality;
mod replies;
mod thread;
mod triggers;

#[cfg(test)]
mod scenario_tests;
#[cfg(test)]
pub(crate) mod test_kit;

use std::collections::BTreeSet;

pub use churn::LostEnterprise;
pub use enterprise_customer::{EnterpriseCustomer, EnterpriseStatus, adjust_relationship};
pub use evaluation::{OfferEvaluator, OfferResponse, counter_price, highest_price};
pub use open_threads::OpenThreads;
pub use thread::{Thread, Turn};

use super::canonical::canonical;
use super::context::DayContext;
use super::customers::Customers;
use super::events::{Facts, Notice, Sender, ThreadKind, ThreadTurn, TurnContent};
use super::product::Product;
use crate::customers::drift::DriftTotals;
use crate::reputation::{OnReputationWrite, Reputations};

/// State of the negotiations with enterprises.
#[derive(Debug, Clone, PartialEq)]
pub struct Enterprise {
    /// Number that the next thread receives, from 1.
    pub next_thread: u32,
    /// Number that the next turn receives, from 1. Turns of all threads are numbered together.
    pub next_message: u32,
    /// Threads that are open or can still trigger, in ascending order of thread number.
    pub threads: Vec<Thread>,
    /// Leads, subscribers, and lost enterprises with a thread that can still trigger, in ascending order of
    /// customer number.
    pub companies: Vec<EnterpriseCustomer>,
}

canonical! { Enterprise { next_thread, next_message, threads, companies } }

impl Default for Enterprise {
    fn default() -> Self {
        Enterprise { next_thread: 1, next_message: 1, threads: Vec::new(), companies: Vec::new() }
    }
}

/// Inputs that all negotiations of a day share.
pub struct NegotiationContext<'a> {
    /// Values that all customer mechanisms of the day share.
    pub day: &'a DayContext<'a>,
    /// The product, including today's improvements.
    pub product: &'a Product,
    /// Market drift, including today's changes.
    pub drift: &'a DriftTotals,
}

/// Results of the negotiations that later steps of the day need.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct EnterpriseDayResult {
    /// Customer numbers of enterprises that pay nothing today, because their threat to cancel was open this morning.
    pub suspended: BTreeSet<u32>,
    /// Subscribers whose threads died today, as candidates for posts.
    pub lost: Vec<LostEnterprise>,
    /// Seats of enterprises that became subscribers today.
    pub new_seats: u32,
}

impl Enterprise {
    /// Opens the thread of a new lead with one turn by the system. Adds a notification that does not name the
    /// enterprise.
    pub fn open_lead_thread(&mut self, day: u32, company: EnterpriseCustomer, facts: &mut Facts) {
        let seats = match &company.status {
            EnterpriseStatus::Lead(row) | EnterpriseStatus::Lost(row) => row.seats as u32,
            EnterpriseStatus::Subscriber => 1,
        };
        self.companies.push(company);
        let at = self.companies.len() - 1;
        self.open_thread(day, at, ThreadKind::NewLead, seats, Sender::System, TurnContent::Opening, facts);
        facts.notices.push(Notice::EnterpriseLead);
    }

    /// Runs the negotiations of a day, based on the threads of this morning: timeouts, due replies, then new threads
    /// of subscribers without a thread.
    pub fn step(
        &mut self,
        customers: &mut Customers,
        reputation: &mut Reputations,
        context: &NegotiationContext<'_>,
        facts: &mut Facts,
        on_write: &mut OnReputationWrite<'_>,
    ) -> EnterpriseDayResult {
        let day = context.day;
        let view = self.active_threads(day.params.fidelity.reappearing_threads);
        let busy: BTreeSet<u32> = view.iter().map(|live| self.threads[live.thread].customer).collect();
        let mut step = NegotiationStep {
            enterprise: self,
            customers,
            reputation,
            on_reputation_write: on_write,
            day,
            context,
            facts,
            result: EnterpriseDayResult::default(),
        };
        step.result.suspended = step.threatening_customers(&view);
        step.expire_threads(&view);
        step.receive_replies(&view);
        step.open_subscriber_threads(&busy);
        let result = step.result;
        let reappearing = day.params.fidelity.reappearing_threads;
        self.remove_finished(|thread| thread.is_finished(day.day(), reappearing));
        result
    }

    /// Returns the enterprise with this customer number, or `None` if it is not tracked.
    pub fn enterprise_customer(&self, customer: u32) -> Option<&EnterpriseCustomer> {
        self.enterprise_position(customer).map(|at| &self.companies[at])
    }

    /// Returns an index of the open threads by enterprise.
    pub fn open_threads(&self) -> OpenThreads<'_> {
        OpenThreads::from_threads(&self.threads)
    }

    fn enterprise_position(&self, customer: u32) -> Option<usize> {
        self.companies.binary_search_by_key(&customer, |company| company.customer).ok()
    }

    /// Returns the threads that are not closed, each with its active turn.
    fn active_threads(&self, reappearing: bool) -> Vec<ActiveThread> {
        let live = |(at, thread): (usize, &Thread)| {
            let turn = thread.active_turn(reappearing)?;
            Some(ActiveThread { thread: at, sender: turn.sender, day: turn.day, reply_day: turn.reply_day })
        };
        self.threads.iter().enumerate().filter_map(live).collect()
    }

    #[expect(clippy::too_many_arguments, reason = "the first turn has all values of a thread")]
    fn open_thread(
        &mut self,
        day: u32,
        company: usize,
        kind: ThreadKind,
        seats: u32,
        sender: Sender,
        content: TurnContent,
        facts: &mut Facts,
    ) -> usize {
        let number = self.next_thread;
        self.next_thread += 1;
        let EnterpriseCustomer { customer, group, .. } = self.companies[company];
        self.threads.push(Thread { number, customer, group, kind, turns: Vec::new(), closed: false });
        let thread = self.threads.len() - 1;
        self.append_turn(thread, 0, day, seats, sender, content, facts);
        thread
    }

    #[expect(clippy::too_many_arguments, reason = "a turn has that many values")]
    fn append_turn(
        &mut self,
        thread: usize,
        number: u32,
        day: u32,
        seats: u32,
        sender: Sender,
        content: TurnContent,
        facts: &mut Facts,
    ) {
        let message = self.next_message;
        self.next_message += 1;
        let thread_state = &mut self.threads[thread];
        let (offerings, asked) = match &content {
            TurnContent::Offer(offerings) => (offerings.clone(), None),
            TurnContent::Counter { asked, .. } => (Vec::new(), Some(asked.price)),
            TurnContent::Acceptance(offering) => (Vec::new(), Some(offering.price)),
            _ => (Vec::new(), None),
        };
        thread_state.turns.push(Turn {
            message,
            number,
            sender,
            day,
            offerings,
            asked,
            reply_day: None,
            dead: false,
        });
        let (customer, group, kind, thread) =
            (thread_state.customer, thread_state.group, thread_state.kind, thread_state.number);
        let persona = self.enterprise_customer(customer).map(|company| company.persona).unwrap_or_default();
        facts.turns.push(ThreadTurn {
            message,
            thread,
            customer,
            group,
            persona,
            kind,
            number,
            sender,
            seats,
            content,
        });
    }

    /// Removes finished threads, and lost enterprises that have no thread left.
    fn remove_finished(&mut self, is_over: impl Fn(&Thread) -> bool) {
        self.threads.retain(|thread| !is_over(thread));
        let still: BTreeSet<u32> = self.threads.iter().map(|thread| thread.customer).collect();
        let is_lost = |company: &EnterpriseCustomer| matches!(company.status, EnterpriseStatus::Lost(_));
        self.companies.retain(|company| !is_lost(company) || still.contains(&company.customer));
    }
}

/// A thread that was active this morning, and its active turn.
#[derive(Debug, Clone, Copy)]
struct ActiveThread {
    /// Index of the thread in [`Enterprise::threads`].
    thread: usize,
    sender: Sender,
    day: u32,
    reply_day: Option<u32>,
}

/// State that the negotiations of one day change.
struct NegotiationStep<'a> {
    enterprise: &'a mut Enterprise,
    customers: &'a mut Customers,
    reputation: &'a mut Reputations,
    /// Function that is called after each reputation change.
    on_reputation_write: &'a mut OnReputationWrite<'a>,
    day: &'a DayContext<'a>,
    context: &'a NegotiationContext<'a>,
    facts: &'a mut Facts,
    result: EnterpriseDayResult,
}

impl NegotiationStep<'_> {
    fn today(&self) -> u32 {
        self.day.day()
    }

    fn threatening_customers(&self, view: &[ActiveThread]) -> BTreeSet<u32> {
        let threads = view.iter().map(|live| &self.enterprise.threads[live.thread]);
        threads
            .filter(|thread| thread.kind == ThreadKind::ChurnPrevention)
            .map(|thread| thread.customer)
            .collect()
    }

    fn expire_threads(&mut self, view: &[ActiveThread]) {
        let patience = self.day.params.enterprise.agent_response_timeout_days;
        for live in view.iter().filter(|live| live.sender != Sender::Agent) {
            let days = self.today() - live.day;
            if days >= patience {
                self.end_by_timeout(live.thread, days);
            }
        }
    }

    fn thread_seats(&self, thread: usize) -> u32 {
        let company = self.enterprise.enterprise_customer(self.enterprise.threads[thread].customer);
        company.and_then(|company| company.row(self.customers)).map_or(1, |row| row.seats as u32)
    }

    /// Appends a turn to a thread, with today as its day and the next turn number.
    fn append_turn_today(&mut self, thread: usize, sender: Sender, seats: u32, content: TurnContent) {
        let number = self.enterprise.threads[thread].last().number + 1;
        let today = self.today();
        self.enterprise.append_turn(thread, number, today, seats, sender, content, self.facts);
    }
}
