//! Ends of threads: a deal, an enterprise that stops replying, or a timeout.

use super::churn::ThreadFailure;
use super::enterprise_customer::adjust_relationship;
use super::{EnterpriseStatus, NegotiationStep};
use crate::customers::columns::Subscriber;
use crate::events::{
    DealClosed, EndCause, LossCause, Notice, Offering, Sender, SubscriptionEnded, SubscriptionStatus,
    TermsChanged, ThreadKind, TurnContent,
};
use crate::product::usage::usage_rate;
use crate::random::Part;
use crate::retention::refresh_required;
use crate::retention::renewal::{ongoing_discount, row_terms};

impl NegotiationStep<'_> {
    /// Accepts an offering of the player. The deal takes effect today.
    pub(super) fn accept_offering(&mut self, thread: usize, offering: Offering) {
        let seats = self.thread_seats(thread);
        self.append_turn_today(thread, Sender::Customer, seats, TurnContent::Acceptance(offering));
        self.close_deal(thread, offering, seats);
        self.append_turn_today(thread, Sender::System, seats, TurnContent::Closing(offering));
        self.enterprise.threads[thread].closed = true;
        self.facts.notices.push(Notice::DealWon { price: offering.price });
    }

    /// Applies a deal if the enterprise is still a lead or a subscriber.
    fn close_deal(&mut self, thread: usize, offering: Offering, seats: u32) {
        let thread_state = &self.enterprise.threads[thread];
        let (customer, kind) = (thread_state.customer, thread_state.kind);
        let (agent_turns, days) =
            (thread_state.player_turn_count(), self.today() - thread_state.turns[0].day);
        let status = self.enterprise.enterprise_customer(customer).map(|company| company.status.clone());
        let new_lead = kind == ThreadKind::NewLead;
        let (changed, activated) = match status {
            Some(EnterpriseStatus::Lead(row)) if new_lead => {
                (self.activate_lead(customer, row, offering), true)
            }
            Some(EnterpriseStatus::Subscriber) if !new_lead => (self.change_terms(customer, offering), false),
            _ => (None, false),
        };
        let end = self.today() + self.day.params.enterprise.contract_month_days;
        let contract_end_day = changed.is_some().then_some(end);
        if let (Some(end), Some(at)) = (contract_end_day, self.enterprise.enterprise_position(customer)) {
            self.enterprise.companies[at].contract_end_day = end;
        }
        self.result.new_seats += if activated { seats } else { 0 };
        let (plan, price) = (offering.plan, offering.price);
        self.facts.deals.push(DealClosed {
            customer,
            kind,
            activated,
            plan,
            price,
            agent_turns,
            days,
            seats,
            contract_end_day,
        });
        self.facts.changes.extend(changed);
    }

    /// Turns a lead into a subscriber. The billing day follows from the day of arrival.
    fn activate_lead(&mut self, customer: u32, lead: Subscriber, offering: Offering) -> Option<TermsChanged> {
        let (params, group) = (self.day.params, self.customer_group(customer));
        let promotion = ongoing_discount(customer, group, offering.plan, self.day.settings, params);
        let keys = [group.index() as u64, u64::from(lead.n), u64::from(self.today())];
        let z = self.day.streams.open(Part::UsageRate, keys).standard_normal();
        let sales = &params.enterprise;
        let row = Subscriber {
            plan: offering.plan,
            listed_price: offering.price,
            promotion,
            effective_price: (offering.price - promotion).max(params.billing.effective_price_min),
            effective_c_max: lead.c_max,
            start_day: self.today(),
            usage_rate: usage_rate(lead.usage_demand, lead.seats.trunc(), z, &params.customer_generation),
            relationship: adjust_relationship(lead.relationship, sales.deal_relationship_delta, sales),
            ..lead
        };
        self.customers.groups[group].activate(row);
        if let Some(at) = self.enterprise.enterprise_position(customer) {
            self.enterprise.companies[at].status = EnterpriseStatus::Subscriber;
        }
        self.refresh_terms(customer)
    }

    /// Changes the plan and the price of a subscriber. Budget, tenure and billing day stay the same.
    fn change_terms(&mut self, customer: u32, offering: Offering) -> Option<TermsChanged> {
        let (params, group) = (self.day.params, self.customer_group(customer));
        let promotion = ongoing_discount(customer, group, offering.plan, self.day.settings, params);
        let n = self.enterprise.enterprise_customer(customer)?.n;
        let group_customers = &mut self.customers.groups[group];
        let (block, at) = group_customers.subscriber_position(n)?;
        let block = &mut group_customers.blocks[block];
        block.plan[at] = offering.plan;
        block.listed_price[at] = offering.price;
        block.promotion[at] = promotion;
        block.effective_price[at] = (offering.price - promotion).max(params.billing.effective_price_min);
        self.refresh_terms(customer)
    }

    /// Updates the required quality of a subscriber, and returns the subscriber's terms.
    fn refresh_terms(&mut self, customer: u32) -> Option<TermsChanged> {
        let group = self.customer_group(customer);
        let n = self.enterprise.enterprise_customer(customer)?.n;
        let group_customers = &mut self.customers.groups[group];
        let (block, at) = group_customers.subscriber_position(n)?;
        let block = &mut group_customers.blocks[block];
        refresh_required(block, at, self.day.morning.expectations[group].c_max, self.day.params);
        Some(row_terms(block, at))
    }

    fn customer_group(&self, customer: u32) -> crate::identifiers::Group {
        self.enterprise.enterprise_customer(customer).expect("an enterprise with a thread is kept").group
    }

    /// Ends a thread because the enterprise does not reply. Adds no turn, and marks the newest turn dead.
    pub(super) fn end_by_silence(&mut self, thread: usize) {
        let thread_state = &mut self.enterprise.threads[thread];
        thread_state.last_mut().dead = true;
        let kind = thread_state.kind;
        let sales = &self.day.params.enterprise;
        if kind == ThreadKind::NewLead {
            self.lose_lead(thread, EndCause::LeadSilent);
            self.facts.notices.push(Notice::LeadSilent);
            return;
        }
        let delta = match kind {
            ThreadKind::Renegotiation => sales.renegotiation_ghost_relationship_delta,
            _ => sales.ghost_relationship_delta,
        };
        self.lose_subscriber(thread, ThreadFailure::Silence, delta);
    }

    /// Ends a thread because the player did not answer before the deadline.
    pub(super) fn end_by_timeout(&mut self, thread: usize, days: u32) {
        let thread_state = &mut self.enterprise.threads[thread];
        let (customer, kind) = (thread_state.customer, thread_state.kind);
        let died_before = std::mem::replace(&mut thread_state.last_mut().dead, true);
        if died_before && kind == ThreadKind::NewLead {
            let cause = match thread_state.last().sender {
                Sender::Agent => LossCause::Silence,
                Sender::Customer | Sender::System => LossCause::Unanswered,
            };
            let message_day = thread_state.last().day;
            self.facts.notices.push(Notice::LeadLossRepeated { days, customer, cause, message_day });
        } else if kind == ThreadKind::NewLead {
            self.lose_lead(thread, EndCause::LeadTimeout);
            self.facts.notices.push(Notice::LeadLostByTimeout { days });
        } else {
            let delta = self.day.params.enterprise.timeout_relationship_delta;
            self.lose_subscriber(thread, ThreadFailure::Timeout, delta);
        }
    }

    /// Marks the lead of a thread as lost, unless the lead is already lost.
    fn lose_lead(&mut self, thread: usize, cause: EndCause) {
        let (today, customer) = (self.today(), self.enterprise.threads[thread].customer);
        if let Some(ending) = self.enterprise.mark_lead_lost(customer, today, cause) {
            self.facts.endings.push(ending);
        }
    }
}

impl super::Enterprise {
    /// Marks a lead as lost. Returns `None` if the enterprise is not a lead.
    pub(super) fn mark_lead_lost(
        &mut self,
        customer: u32,
        day: u32,
        cause: EndCause,
    ) -> Option<SubscriptionEnded> {
        let at = self.enterprise_position(customer)?;
        let company = &mut self.companies[at];
        let EnterpriseStatus::Lead(row) = company.status else { return None };
        company.status = EnterpriseStatus::Lost(row);
        Some(SubscriptionEnded {
            subscription: company.subscription,
            customer,
            group: company.group,
            seats: row.seats as u32,
            day,
            status: SubscriptionStatus::Lost,
            cause,
        })
    }
}
