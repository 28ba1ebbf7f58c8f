//! Companies: leads that ask for an offer, and what silence does to them (chapter 40 §4, §11, step 16).

use super::canonical::canonical;
use super::events::{
    EndCause, Facts, Notice, Sender, SubscriptionEnded, SubscriptionStatus, ThreadKind, ThreadTurn,
};
use super::identifiers::Group;
use super::params::Params;

/// Enterprise threads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Enterprise {
    /// Number of the next thread.
    pub next_thread: u32,
    /// Leads that wait for an answer, in the order of their threads.
    pub waiting: Vec<WaitingLead>,
}

/// A company that asked for an offer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WaitingLead {
    /// Number of its thread.
    pub thread: u32,
    /// Customer number.
    pub customer: u32,
    /// Its group.
    pub group: Group,
    /// Subscription number of the lead.
    pub subscription: u32,
    /// Whole seats.
    pub seats: u32,
    /// Day on which it asked.
    pub day: u32,
}

canonical! {
    Enterprise { next_thread, waiting }
    WaitingLead { thread, customer, group, subscription, seats, day }
}

impl Default for Enterprise {
    fn default() -> Self {
        Enterprise { next_thread: 1, waiting: Vec::new() }
    }
}

impl Enterprise {
    /// Opens the thread of a new lead: one turn of the market, and a notification that names nobody.
    pub fn open_lead(
        &mut self,
        day: u32,
        group: Group,
        customer: u32,
        subscription: u32,
        seats: u32,
        facts: &mut Facts,
    ) {
        let thread = self.next_thread;
        self.next_thread += 1;
        self.waiting.push(WaitingLead { thread, customer, group, subscription, seats, day });
        let (kind, sender) = (ThreadKind::NewLead, Sender::System);
        facts.turns.push(ThreadTurn { thread, customer, kind, number: 0, sender, seats });
        facts.notices.push(Notice::EnterpriseLead);
    }

    /// Loses the leads that waited too long.
    pub fn time_out(&mut self, day: u32, params: &Params, facts: &mut Facts) {
        let patience = params.enterprise.agent_response_timeout_days;
        self.waiting.retain(|lead| {
            let days = day - lead.day;
            if days < patience {
                return true;
            }
            facts.endings.push(SubscriptionEnded {
                subscription: lead.subscription,
                customer: lead.customer,
                group: lead.group,
                seats: lead.seats,
                day,
                status: SubscriptionStatus::Lost,
                cause: EndCause::LeadTimeout,
            });
            facts.notices.push(Notice::LeadLostByTimeout { days });
            false
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// First half of check 17 of chapter 40.
    #[test]
    fn an_unanswered_lead_is_lost_on_the_seventh_day() {
        let params = Params::shipped();
        let (mut enterprise, mut facts) = (Enterprise::default(), Facts::default());
        enterprise.open_lead(0, Group::parse("E1").expect("a group"), 9, 3, 120, &mut facts);
        assert_eq!((facts.turns.len(), facts.notices.as_slice()), (1, &[Notice::EnterpriseLead][..]));
        facts.begin(6);
        enterprise.time_out(6, &params, &mut facts);
        assert!(facts.endings.is_empty());
        facts.begin(7);
        enterprise.time_out(7, &params, &mut facts);
        assert_eq!((facts.endings[0].subscription, facts.endings[0].day), (3, 7));
        assert_eq!(facts.notices, [Notice::LeadLostByTimeout { days: 7 }]);
        facts.begin(8);
        enterprise.time_out(8, &params, &mut facts);
        assert!(facts.endings.is_empty() && facts.notices.is_empty());
    }
}
