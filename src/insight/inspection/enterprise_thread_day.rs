//! The enterprise's evaluation of a thread at the start of a day: acceptable prices and the answer that the enterprise
//! would give.

use serde::Serialize;

use novamind_world::customers::Customers;
use novamind_world::customers::columns::Subscriber;
use novamind_world::enterprise::messages::{late_days, late_penalty};
use novamind_world::enterprise::{
    Enterprise, NegotiationContext, OfferEvaluator, OfferResponse, Thread, adjust_relationship,
    counter_price, highest_price,
};
use novamind_world::events::{Offering, Sender, ThreadKind};
use novamind_world::identifiers::{ByPlan, Group};

/// An enterprise's evaluation of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct EvaluatedPlan {
    /// Perceived quality of the plan on the day.
    pub quality: f64,
    /// Perceived quality if the player answered today, after the penalty for a late answer.
    pub quality_if_answered: f64,
    /// Upper price limit, $ per seat per month. The enterprise accepts prices below the limit.
    pub accepts_below: f64,
    /// Whether the enterprise accepts every price, because the perceived quality exceeds the highest quality that the
    /// enterprise requires.
    pub accepts_any_price: bool,
    /// Price that the enterprise would name in its next turn, $ per seat per month; 0 if the enterprise would not
    /// answer.
    #[serde(rename = "would_name")]
    pub counter: f64,
}

/// An open thread at the start of a day, before any answer.
#[derive(Debug, Clone, PartialEq)]
pub struct EnterpriseThreadDay {
    /// Day of the evaluation.
    pub day: u32,
    /// Number of the open thread.
    pub thread: u32,
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Group of the enterprise.
    pub group: Group,
    /// Type of the open thread.
    pub kind: ThreadKind,
    /// Budget including drift, $ per seat per month.
    pub budget: f64,
    /// Evaluation of each plan.
    pub plans: ByPlan<EvaluatedPlan>,
    /// Number of remaining turns that the enterprise will answer.
    pub remaining_turns: u32,
    /// Relationship of the enterprise to the company, 0..=1.
    pub relationship: f64,
    /// Change in the relationship if the player answers today and the answer is late; never positive.
    pub late_penalty: f64,
    /// Day on which the enterprise will answer; `None` on the player's turn.
    pub reply_day: Option<u32>,
    /// The player's newest offers; empty on the player's turn.
    pub offerings: Vec<Offering>,
    /// The answer that the enterprise would give today; `None` if there are no offers.
    pub answer: Option<OfferResponse>,
}

/// Returns the evaluation of a thread at the start of the day, or `None` if the thread has ended.
pub(crate) fn evaluate_enterprise_thread(
    thread: &Thread,
    enterprise: &Enterprise,
    customers: &Customers,
    negotiation: &NegotiationContext<'_>,
) -> Option<EnterpriseThreadDay> {
    let (day, params) = (negotiation.day.day(), negotiation.day.params);
    let turn = thread.active_turn(params.fidelity.reappearing_threads)?;
    let row = enterprise.enterprise_customer(thread.customer)?.row(customers)?;
    let judge = enterprise.offer_evaluator(thread, customers, negotiation)?;
    let late_penalty = late_days(thread, day).map_or(0.0, |days| late_penalty(days, &params.enterprise));
    let offended = match late_penalty {
        0.0 => judge,
        change => {
            let relationship = adjust_relationship(row.relationship, change, &params.enterprise);
            enterprise.offer_evaluator_for_row(thread, &Subscriber { relationship, ..row }, negotiation)?
        }
    };
    // The enterprise answers the player's newest turn. On the player's turn, the enterprise will answer the turn that
    // the player sends next.
    let turns = thread.last().number + u32::from(thread.last().sender != Sender::Agent);
    let plans = ByPlan::from_fn(|plan| {
        let OfferEvaluator { curve, quality, initial_offer_factor, .. } = offended;
        let highest = highest_price(quality[plan], &curve, params);
        let beyond = quality[plan] - curve.q_max > params.enterprise.accept_min_satisfaction_exclusive;
        EvaluatedPlan {
            quality: judge.quality[plan],
            quality_if_answered: quality[plan],
            accepts_below: highest,
            accepts_any_price: beyond && !params.fidelity.deal_price_ceiling,
            counter: counter_price(highest, initial_offer_factor, turns, params),
        }
    });
    let offerings = match thread.last().sender {
        Sender::Agent => thread.last_offerings().to_vec(),
        _ => Vec::new(),
    };
    Some(EnterpriseThreadDay {
        day,
        thread: thread.number,
        customer: thread.customer,
        group: thread.group,
        kind: thread.kind,
        budget: judge.curve.c_max,
        plans,
        remaining_turns: judge.max_turns.saturating_sub(turns),
        relationship: row.relationship,
        late_penalty,
        reply_day: turn.reply_day,
        answer: (!offerings.is_empty()).then(|| judge.respond(&offerings, turns, params)),
        offerings,
    })
}
