//! Converts x-ray views to JSON.

use serde::Serialize;
use serde_json::{Value, json};

use novamind_insight::{
    EnterpriseThreadDay, EnterpriseView, IndividualDay, IndividualView, LeadEquation, LeadFactor,
};
use novamind_session::identifiers::{ByPlan, Plan};

/// Values of a plan together with the plan's name.
#[derive(Serialize)]
struct PlanEntry<'a, T> {
    plan: Plan,
    #[serde(flatten)]
    values: &'a T,
}

fn by_plan<T>(plans: &ByPlan<T>) -> [PlanEntry<'_, T>; 3] {
    Plan::ALL.map(|plan| PlanEntry { plan, values: &plans[plan] })
}

pub(super) fn leads_to_json(lead_equation: &LeadEquation, held: &[(LeadFactor, f64)]) -> Value {
    let factors =
        LeadFactor::ALL.map(|factor| (factor.letter().to_owned(), json!(lead_equation.factor(factor))));
    let channels = lead_equation.channels().map(|(channel, leads)| (channel.id().to_owned(), json!(leads)));
    let word_of_mouth =
        lead_equation.word_of_mouth.iter().map(|(group, leads)| (group.id().to_owned(), json!(leads)));
    json!({
        "group": lead_equation.group.id(),
        "day": lead_equation.day,
        "known": lead_equation.is_known,
        "factors": Value::Object(factors.into_iter().collect()),
        "channels": Value::Object(channels.collect()),
        "word_of_mouth": Value::Object(word_of_mouth.collect()),
        "expected": lead_equation.expected_leads(),
        "came": lead_equation.actual_leads,
        "p": lead_equation.p_value(),
        "held": (!held.is_empty()).then(|| lead_equation.expected_leads_with(held)),
    })
}

pub(super) fn customer_to_json(view: &IndividualView, headline: &str) -> Value {
    let day = |individual_day: &IndividualDay| {
        json!({
            "day": individual_day.day,
            "plan": individual_day.plan.id(),
            "price": individual_day.price,
            "billing_day": individual_day.is_due,
            "satisfaction": individual_day.satisfaction,
            "relationship": individual_day.relationship,
            "open_issue_days": individual_day.open_issue_days,
            "choice": individual_day.weighed_decision.choice.map(Plan::id),
            "plans": by_plan(&individual_day.weighed_decision.plans),
        })
    };
    json!({
        "customer_id": view.customer,
        "group": view.group.id(),
        "headline": headline,
        "came": view.signup.day,
        "signed_up": view.signup.signed_up,
        "shown": view.shown_state().map(day),
        "last_bill": view.last_bill().map(day),
    })
}

pub(super) fn enterprise_to_json(view: &EnterpriseView) -> Value {
    let thread = |thread_day: &EnterpriseThreadDay| {
        json!({
            "thread": thread_day.thread,
            "kind": thread_day.kind.id(),
            "budget": thread_day.budget,
            "turns_left": thread_day.remaining_turns,
            "relationship": thread_day.relationship,
            "late_penalty": thread_day.late_penalty,
            "reply_day": thread_day.reply_day,
            "plans": by_plan(&thread_day.plans),
        })
    };
    json!({
        "customer_id": view.customer,
        "group": view.group.id(),
        "day": view.day,
        "threads": view.threads_on_shown_day().map(thread).collect::<Vec<Value>>(),
    })
}
