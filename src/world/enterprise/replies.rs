//! Replies of enterprises that are due today.

use super::evaluation::{OfferEvaluator, OfferResponse};
use super::{ActiveThread, Enterprise, NegotiationContext, NegotiationStep, Thread};
use crate::customers::Customers;
use crate::customers::columns::Subscriber;
use crate::events::{Notice, Offering, Sender, ThreadKind, TurnContent};

/// A reply that an enterprise has decided on but not sent.
struct DueReply {
    thread: usize,
    answer: OfferResponse,
    offerings: Vec<Offering>,
}

impl Enterprise {
    /// Returns today's evaluator for the enterprise of a thread, or `None` if the enterprise is no longer tracked.
    pub fn offer_evaluator(
        &self,
        thread: &Thread,
        customers: &Customers,
        context: &NegotiationContext<'_>,
    ) -> Option<OfferEvaluator> {
        let row = self.enterprise_customer(thread.customer)?.row(customers)?;
        self.offer_evaluator_for_row(thread, &row, context)
    }

    /// Returns the evaluator like [`Enterprise::offer_evaluator`], but for a given row of the enterprise.
    pub fn offer_evaluator_for_row(
        &self,
        thread: &Thread,
        row: &Subscriber,
        context: &NegotiationContext<'_>,
    ) -> Option<OfferEvaluator> {
        let company = self.enterprise_customer(thread.customer)?;
        let mut quality = context.negotiation_quality(thread.group, row, company.is_subscriber());
        if thread.kind == ThreadKind::NewLead {
            let impression = company.first_impression_factor(context.day.params, context.day.streams);
            quality.0.iter_mut().for_each(|quality| *quality *= impression);
        }
        Some(OfferEvaluator {
            curve: context.negotiation_curve(thread.group, row),
            quality,
            initial_offer_factor: company.negotiator.initial_offer_factor,
            max_turns: company.negotiator.max_negotiation_turns,
        })
    }
}

impl NegotiationStep<'_> {
    /// Sends the due replies. All replies are decided from the state before the first reply.
    pub(super) fn receive_replies(&mut self, view: &[ActiveThread]) {
        let today = self.today();
        let due = view.iter().filter(|live| live.sender == Sender::Agent && live.reply_day == Some(today));
        let answers: Vec<DueReply> = due.filter_map(|live| self.decide_reply(live.thread)).collect();
        for DueReply { thread, answer, offerings } in answers {
            match answer {
                OfferResponse::Accept(at) => self.accept_offering(thread, offerings[at]),
                OfferResponse::Counter(at, price) => self.send_counter_offer(thread, offerings[at], price),
                OfferResponse::Silence => self.end_by_silence(thread),
            }
        }
    }

    fn decide_reply(&self, thread: usize) -> Option<DueReply> {
        let thread_state = &self.enterprise.threads[thread];
        let evaluator = self.enterprise.offer_evaluator(thread_state, self.customers, self.context)?;
        let offerings = thread_state.last_offerings().to_vec();
        let answer = evaluator.respond(&offerings, thread_state.last().number, self.day.params);
        Some(DueReply { thread, answer, offerings })
    }

    fn send_counter_offer(&mut self, thread: usize, offering: Offering, price: f64) {
        let seats = self.thread_seats(thread);
        let asked = Offering { plan: offering.plan, price };
        self.append_turn_today(
            thread,
            Sender::Customer,
            seats,
            TurnContent::Counter { asked, offered: offering.price },
        );
        let customer = self.enterprise.threads[thread].customer;
        self.facts.notices.push(Notice::CounterOffer { customer });
    }
}
