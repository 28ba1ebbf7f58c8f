//! Messages that the player sends to enterprises on a decision day.
//!
//! Messages and their random draws are resolved ([`Enterprise::resolve_offers`]) before the state changes
//! ([`Enterprise::send_offers`], [`Enterprise::reject_threads`]).

use std::collections::BTreeMap;

use super::Enterprise;
use super::enterprise_customer::adjust_relationship;
use super::thread::Thread;
use crate::customers::Customers;
use crate::events::{EndCause, Facts, Offering, Sender, ThreadKind, TurnContent};
use crate::params::{EnterpriseParams as Sales, Params};
use crate::random::{Part, Streams};

/// Offerings that the player sends to one enterprise.
#[derive(Debug, Clone, PartialEq)]
pub struct OfferDraft {
    /// Customer number of the enterprise.
    pub customer: u32,
    /// The offerings of the message, one to three.
    pub offerings: Vec<Offering>,
}

/// An offer with its thread and its reply day.
#[derive(Debug, Clone, PartialEq)]
pub struct OfferMessage {
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Number of the open thread, or of the new thread that the message starts.
    pub thread: u32,
    /// Whether the message starts a new thread.
    pub starts_thread: bool,
    /// Number of the message's turn in the thread.
    pub turn: u32,
    /// One to three offerings, each a plan and a price.
    pub offerings: Vec<Offering>,
    /// Relationship after a late answer; `None` if the relationship does not change.
    pub relationship: Option<f64>,
    /// Day on which the enterprise replies.
    pub reply_day: u32,
}

/// Returns the days until an enterprise replies, from the mean, the standard deviation and a standard normal draw `z`.
/// The result is rounded half to even and is at least 1.
pub fn reply_delay(mean: f64, std: f64, z: f64, sales: &Sales) -> u32 {
    (mean + std * z).round_ties_even().max(f64::from(sales.reply_delay_min_days)) as u32
}

/// Returns the change in the relationship if the player answers after `days` days. The change is never positive.
pub fn late_penalty(days: u32, sales: &Sales) -> f64 {
    sales.late_reply_relationship_delta_per_day * f64::from(days.saturating_sub(sales.late_reply_free_days))
}

impl Enterprise {
    /// Finds the thread of each offer and draws the reply day. Drops offers to enterprises that have no open thread
    /// and no subscription.
    pub fn resolve_offers(
        &self,
        proposals: &[OfferDraft],
        day: u32,
        customers: &Customers,
        params: &Params,
        streams: &Streams,
    ) -> Vec<OfferMessage> {
        let mut next_thread = self.next_thread;
        let mut relationships: BTreeMap<u32, f64> = BTreeMap::new();
        let mut messages = Vec::new();
        let open = self.open_threads();
        for proposal in proposals {
            let Some(company) = self.enterprise_customer(proposal.customer) else { continue };
            let thread = open.newest(proposal.customer);
            let (number, turn) = match thread {
                Some(thread) => (thread.number, thread.last().number + 1),
                None if company.is_subscriber() => {
                    next_thread += 1;
                    (next_thread - 1, 0)
                }
                None => continue,
            };
            let relationship = thread.and_then(|thread| {
                let penalty = late_penalty(late_days(thread, day)?, &params.enterprise);
                let stored = company.row(customers)?.relationship;
                let before = relationships.get(&proposal.customer).copied().unwrap_or(stored);
                (penalty != 0.0).then(|| adjust_relationship(before, penalty, &params.enterprise))
            });
            if let Some(relationship) = relationship {
                relationships.insert(proposal.customer, relationship);
            }
            let z = streams.open(Part::ReplyDelay, [u64::from(number), u64::from(turn)]).standard_normal();
            let manner = &company.negotiator;
            let delay = reply_delay(manner.reply_delay_mean, manner.reply_delay_std, z, &params.enterprise);
            messages.push(OfferMessage {
                customer: proposal.customer,
                thread: number,
                starts_thread: thread.is_none(),
                turn,
                offerings: proposal.offerings.clone(),
                relationship,
                reply_day: day + delay,
            });
        }
        messages
    }

    /// Sends messages that were resolved for the current state. Enterprises reply only to the newest turn of a thread.
    pub fn send_offers(
        &mut self,
        messages: &[OfferMessage],
        day: u32,
        customers: &mut Customers,
        facts: &mut Facts,
    ) {
        for message in messages {
            let Some(at) = self.enterprise_position(message.customer) else { continue };
            if let Some(relationship) = message.relationship {
                self.companies[at].set_relationship(relationship, customers);
            }
            let content = TurnContent::Offer(message.offerings.clone());
            if message.starts_thread {
                let seats = self.companies[at].row(customers).map_or(1, |row| row.seats as u32);
                let kind = ThreadKind::Renegotiation;
                self.open_thread(day, at, kind, seats, Sender::Agent, content, facts);
            } else if let Some(thread) = self.thread_position(message.thread) {
                self.append_turn(thread, message.turn, day, 1, Sender::Agent, content, facts);
            }
        }
        for offer_message in messages {
            if let Some(thread) = self.thread_position(offer_message.thread) {
                self.threads[thread].last_mut().reply_day = Some(offer_message.reply_day);
            }
        }
    }

    /// Ends the open threads with these numbers. Leads are lost; subscribers stay.
    pub fn reject_threads(&mut self, threads: &[u32], day: u32, facts: &mut Facts) {
        for number in threads {
            let Some(thread) = self.thread_position(*number).filter(|at| self.threads[*at].is_open()) else {
                continue;
            };
            let turn = self.threads[thread].last().number + 1;
            self.append_turn(thread, turn, day, 1, Sender::Agent, TurnContent::Rejection, facts);
            let thread_state = &mut self.threads[thread];
            thread_state.closed = true;
            let customer = thread_state.customer;
            if thread_state.kind == ThreadKind::NewLead {
                facts.endings.extend(self.mark_lead_lost(customer, day, EndCause::LeadRejected));
            }
        }
        self.remove_finished(|thread| thread.closed);
    }

    fn thread_position(&self, number: u32) -> Option<usize> {
        self.threads.binary_search_by_key(&number, |thread| thread.number).ok()
    }
}

/// Returns the days since the customer's newest turn. Returns `None` if the player wrote last or the customer has not
/// written.
pub fn late_days(thread: &Thread, day: u32) -> Option<u32> {
    if thread.last().sender == Sender::Agent {
        return None;
    }
    thread.last_customer_day().map(|customer| day.saturating_sub(customer))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reply_delay_rounds_half_to_even_with_minimum_one_day() {
        let sales = Params::bundled().enterprise;
        for (mean, std, z, days) in [
            (5.0, 2.0, 0.0, 5),
            (5.0, 2.0, -0.25, 4),
            (5.0, 2.0, 0.25, 6),
            (5.0, 2.0, 0.75, 6),
            (5.0, 2.0, -3.0, 1),
            (10.3, 4.1, 1.2, 15),
            (0.5, 0.1, 0.0, 1),
            (2.5, 1.0, 0.0, 2),
            (3.5, 1.0, 0.0, 4),
        ] {
            assert_eq!(reply_delay(mean, std, z, &sales), days, "{mean} {std} {z}");
        }
    }

    #[test]
    fn late_reply_lowers_relationship_by_two_hundredths_a_day() {
        let sales = Params::bundled().enterprise;
        let after = |days| adjust_relationship(0.5, late_penalty(days, &sales), &sales);
        for (days, relationship) in
            [(0, 0.5), (1, 0.5), (2, 0.48), (3, 0.46), (4, 0.44), (5, 0.42), (6, 0.40)]
        {
            assert!((after(days) - relationship).abs() < 1e-12, "{days} days: {}", after(days));
        }
        assert_eq!(adjust_relationship(0.05, late_penalty(6, &sales), &sales), 0.0);
    }
}
