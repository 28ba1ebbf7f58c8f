//! Replies that are due today.

use super::evaluation::{Answer, Judge};
use super::{Enterprise, Live, Negotiation, Step, Thread};
use crate::customers::Customers;
use crate::customers::columns::Subscriber;
use crate::events::{Notice, Offering, Sender, ThreadKind, TurnContent};

/// A decided reply that has not been sent.
struct Due {
    thread: usize,
    answer: Answer,
    offerings: Vec<Offering>,
}

impl Enterprise {
    /// Returns the evaluator for a thread as of today, or `None` if the enterprise is no longer tracked.
    pub fn judge(&self, thread: &Thread, customers: &Customers, talks: &Negotiation<'_>) -> Option<Judge> {
        let row = self.company(thread.customer)?.row(customers)?;
        self.judge_of(thread, &row, talks)
    }

    /// Like [`Enterprise::judge`], with a given row of the enterprise.
    pub fn judge_of(&self, thread: &Thread, row: &Subscriber, talks: &Negotiation<'_>) -> Option<Judge> {
        let company = self.company(thread.customer)?;
        let mut quality = talks.offered_quality(thread.group, row, company.is_subscriber());
        if thread.kind == ThreadKind::NewLead {
            let impression = company.first_impression(talks.day.params, talks.day.streams);
            quality.0.iter_mut().for_each(|quality| *quality *= impression);
        }
        Some(Judge {
            curve: talks.offered_curve(thread.group, row),
            quality,
            initial_offer_factor: company.negotiator.initial_offer_factor,
            max_turns: company.negotiator.max_negotiation_turns,
        })
    }
}

impl Step<'_> {
    /// Sends due replies. All are decided from the state before the first one.
    pub(super) fn receive_replies(&mut self, view: &[Live]) {
        let today = self.today();
        let due = view.iter().filter(|live| live.sender == Sender::Agent && live.reply_day == Some(today));
        let answers: Vec<Due> = due.filter_map(|live| self.decide(live.thread)).collect();
        for Due { thread, answer, offerings } in answers {
            match answer {
                Answer::Accept(at) => self.accept(thread, offerings[at]),
                Answer::Counter(at, price) => self.counter(thread, offerings[at], price),
                Answer::Silence => self.fall_silent(thread),
            }
        }
    }

    fn decide(&self, thread: usize) -> Option<Due> {
        let own = &self.enterprise.threads[thread];
        let judge = self.enterprise.judge(own, self.customers, self.talks)?;
        let offerings = own.offerings().to_vec();
        let answer = judge.answer(&offerings, own.last().number, self.day.params);
        Some(Due { thread, answer, offerings })
    }

    fn counter(&mut self, thread: usize, offering: Offering, price: f64) {
        let seats = self.seats_of(thread);
        let asked = Offering { plan: offering.plan, price };
        self.say(thread, Sender::Customer, seats, TurnContent::Counter { asked, offered: offering.price });
        let customer = self.enterprise.threads[thread].customer;
        self.facts.notices.push(Notice::CounterOffer { customer });
    }
}
