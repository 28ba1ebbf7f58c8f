//! A thread as the company sees it on a morning: what it would accept, and what it would answer.

use serde::Serialize;

use novamind_world::customers::Customers;
use novamind_world::customers::columns::Subscriber;
use novamind_world::enterprise::letters::{late_days, late_penalty};
use novamind_world::enterprise::{
    Answer, Enterprise, Judge, Negotiation, Thread, counter_price, highest_price, moved_relationship,
};
use novamind_world::events::{Offering, Sender, ThreadKind};
use novamind_world::identifiers::{ByPlan, Group};

/// A plan, as a company judges it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JudgedPlan {
    /// Quality as it perceives it today.
    pub quality: f64,
    /// The same after what a late answer costs, if the player answered today.
    pub quality_if_answered: f64,
    /// The highest price that this is enough for, dollars a month and seat: it accepts prices below.
    pub accepts_below: f64,
    /// Whether it accepts every price, as the quality is beyond all that it can require.
    pub accepts_any_price: bool,
    /// The price that it would name in its next turn, dollars a month and seat; 0: it would fall silent.
    #[serde(rename = "would_name")]
    pub counter: f64,
}

/// An open thread on a day, before anybody answers.
#[derive(Debug, Clone, PartialEq)]
pub struct CompanyDay {
    /// The day.
    pub day: u32,
    /// Number of the thread.
    pub thread: u32,
    /// The company.
    pub customer: u32,
    /// Its group.
    pub group: Group,
    /// How it began.
    pub kind: ThreadKind,
    /// Budget with what the market has added, dollars a month and seat.
    pub budget: f64,
    /// The plans.
    pub plans: ByPlan<JudgedPlan>,
    /// Turns in which it still answers; at 0 its next answer is silence.
    pub turns_left: u32,
    /// Relationship, 0..=1.
    pub relationship: f64,
    /// What an answer today would add to the relationship, as it is late; not positive.
    pub late_penalty: f64,
    /// Day on which it answers, if it is its turn.
    pub reply_day: Option<u32>,
    /// The newest offerings of the player, if it is to answer to them; empty while the player's turn is awaited.
    pub offerings: Vec<Offering>,
    /// What it would answer to them today; none without offerings.
    pub answer: Option<Answer>,
}

/// A thread this morning; none if it is over.
pub(crate) fn company_day(
    thread: &Thread,
    enterprise: &Enterprise,
    customers: &Customers,
    talks: &Negotiation<'_>,
) -> Option<CompanyDay> {
    let (day, params) = (talks.day.day(), talks.day.params);
    let turn = thread.live(params.fidelity.reappearing_threads)?;
    let row = enterprise.company(thread.customer)?.row(customers)?;
    let judge = enterprise.judge(thread, customers, talks)?;
    let late_penalty = late_days(thread, day).map_or(0.0, |days| late_penalty(days, &params.enterprise));
    let offended = match late_penalty {
        0.0 => judge,
        change => {
            let relationship = moved_relationship(row.relationship, change, &params.enterprise);
            enterprise.judge_of(thread, &Subscriber { relationship, ..row }, talks)?
        }
    };
    // Its answer follows a turn of the player: the newest one, or the one that is awaited.
    let turns = thread.last().number + u32::from(thread.last().sender != Sender::Agent);
    let plans = ByPlan::from_fn(|plan| {
        let Judge { curve, quality, initial_offer_factor, .. } = offended;
        let highest = highest_price(quality[plan], &curve, params);
        let beyond = quality[plan] - curve.q_max > params.enterprise.accept_min_satisfaction_exclusive;
        JudgedPlan {
            quality: judge.quality[plan],
            quality_if_answered: quality[plan],
            accepts_below: highest,
            accepts_any_price: beyond && !params.fidelity.deal_price_ceiling,
            counter: counter_price(highest, initial_offer_factor, turns, params),
        }
    });
    let offerings = match thread.last().sender {
        Sender::Agent => thread.offerings().to_vec(),
        _ => Vec::new(),
    };
    Some(CompanyDay {
        day,
        thread: thread.number,
        customer: thread.customer,
        group: thread.group,
        kind: thread.kind,
        budget: judge.curve.c_max,
        plans,
        turns_left: judge.max_turns.saturating_sub(turns),
        relationship: row.relationship,
        late_penalty,
        reply_day: turn.reply_day,
        answer: (!offerings.is_empty()).then(|| judge.answer(&offerings, turns, params)),
        offerings,
    })
}
