//! Texts for the inspection of an individual: decisions, and the terms that determine them.

use super::{clean_up_numbers, indented_table};
use novamind_insight::{
    DecisionTerm, DecisiveTerm, IndividualView, SignupDecision, SubscriberOutcome, WeighedDecision,
};
use novamind_session::EndCause;
use novamind_session::identifiers::Plan;

/// Prefix of the line that lists satisfaction values.
pub const SATISFACTION_PREFIX: &str = "satisfaction:";

/// Number of days between successive satisfaction values in the list.
const SATISFACTION_STEP_DAYS: usize = 7;

/// Describes an individual: the last decision, the participation curve, the plans today and at the last bill,
/// satisfaction and events.
pub fn describe_individual(view: &IndividualView) -> Vec<String> {
    let first = &view.signup;
    let arrival = format!("arrived on day {} through {}", first.day, first.source.id());
    let mut lines = vec![format!("customer {} · {} · {arrival}", view.customer, view.group), headline(view)];
    let Some(individual_day) = view.shown_state() else {
        lines.extend(describe_signup(first));
        return clean_up_numbers(lines);
    };
    let curve = individual_day.weighed_decision.curve;
    lines.push(format!(
        "curve on day {}: budget {:.2}, quality {:.4} to {:.4}, steepness {:.2} and {:.2}",
        individual_day.day,
        curve.c_max,
        curve.q_min,
        curve.q_max,
        curve.steepness_left,
        curve.steepness_right
    ));
    lines.push(format!("plans on day {}, * current:", individual_day.day));
    lines.extend(plan_rows(&individual_day.weighed_decision, individual_day.plan));
    if let Some(bill) = view.last_bill() {
        lines.push(format!("plans at the last bill, day {}:", bill.day));
        lines.extend(plan_rows(&bill.weighed_decision, bill.plan));
    }
    lines.push(satisfaction_line(view));
    lines.extend(event_lines(view));
    clean_up_numbers(lines)
}

/// Describes the individual's decision on the inspected day, and the terms that were decisive for it.
fn headline(view: &IndividualView) -> String {
    let Some(individual_day) = view.shown_state() else { return signup_headline(view) };
    let WeighedDecision { choice, plans, decisive_terms: turning, .. } = &individual_day.weighed_decision;
    let day = individual_day.day;
    match (individual_day.outcome, choice) {
        (SubscriberOutcome::Cancels(EndCause::Involuntary), _) => format!(
            "cancelled on day {day}: the payment failed (probability on that day: {:.2} %)",
            individual_day.payment_failure * 100.0
        ),
        (SubscriberOutcome::Cancels(_), _) => {
            format!(
                "cancelled on day {day}: no plan is acceptable; {}",
                describe_retaining_terms(turning, view)
            )
        }
        (_, None) => {
            format!(
                "day {day} is not a billing day; no plan would be acceptable: {}",
                describe_retaining_terms(turning, view)
            )
        }
        (outcome, Some(best)) => {
            let what = match outcome {
                SubscriberOutcome::Switches(plan) => format!("switched to plan {plan} on day {day}"),
                _ if individual_day.is_due => format!("stayed on plan {} on day {day}", individual_day.plan),
                _ => format!("on plan {} on day {day}, not a billing day", individual_day.plan),
            };
            format!(
                "{what}: plan {best} has the largest surplus, {:.4}; {}",
                plans[*best].surplus,
                describe_cancelling_terms(turning, view)
            )
        }
    }
}

fn describe_retaining_terms(turning: &[DecisiveTerm], view: &IndividualView) -> String {
    let without_term_text = |without: &DecisiveTerm| {
        let (plan, surplus) = without.plan?;
        Some(format!(
            "without {}, plan {plan} would be acceptable (surplus {surplus:.4})",
            describe_term(without.term, view)
        ))
    };
    match turning.iter().find_map(without_term_text) {
        Some(text) => text,
        None => "no single term is decisive".to_owned(),
    }
}

fn describe_cancelling_terms(turning: &[DecisiveTerm], view: &IndividualView) -> String {
    let terms: Vec<String> = turning.iter().map(|without| describe_term(without.term, view)).collect();
    match terms.is_empty() {
        true => "no single term is decisive".to_owned(),
        false => format!("no plan would be acceptable without {}", terms.join(", or without ")),
    }
}

fn describe_term(term: DecisionTerm, view: &IndividualView) -> String {
    match term {
        DecisionTerm::Issue => match view.issue_opened_on() {
            Some(since) => format!("the issue open since day {since}"),
            None => "an issue".to_owned(),
        },
        DecisionTerm::Ads => "ads".to_owned(),
        DecisionTerm::Quota => "the quota limit".to_owned(),
        DecisionTerm::Relationship => "the relationship".to_owned(),
        DecisionTerm::Tenure => "tenure".to_owned(),
        DecisionTerm::Service => "today's service".to_owned(),
        DecisionTerm::Expectations => "the market's expectations".to_owned(),
        DecisionTerm::Budgets => "budget drift".to_owned(),
        DecisionTerm::Economy => "the economy".to_owned(),
        DecisionTerm::Prices => "price changes since the last bill".to_owned(),
    }
}

fn plan_rows(weighed: &WeighedDecision, current_plan: Plan) -> Vec<String> {
    let head = [
        "plan",
        "price",
        "delivered",
        "relationship",
        "tenure",
        "quota",
        "issues",
        "ads",
        "quality",
        "required",
        "surplus",
        "",
    ];
    let row = |plan: Plan| {
        let terms = &weighed.plans[plan];
        let seen = terms.experience;
        let number = |value: f64| format!("{value:.4}");
        vec![
            format!("{plan}{}", if plan == current_plan { "*" } else { "" }),
            format!("{:.2}", terms.price),
            number(seen.delivered),
            number(seen.relationship),
            number(seen.tenure),
            number(seen.quota),
            number(0.0 - seen.issues),
            number(0.0 - seen.ads),
            number(terms.quality),
            number(terms.required),
            number(terms.surplus),
            if terms.within_budget { String::new() } else { "above budget".to_owned() },
        ]
    };
    indented_table(&head, &Plan::ALL.map(row))
}

fn signup_headline(view: &IndividualView) -> String {
    let SignupDecision { day, plan, plans, quality_noise: noise, signed_up, curve, .. } = &view.signup;
    let plan_terms = &plans[*plan];
    let seen = plan_terms.offered.quality * noise;
    if *signed_up {
        return format!(
            "signed up for plan {plan} on day {day}: quality {seen:.4} with noise {noise:.4}, required {:.4}",
            plan_terms.required
        );
    }
    let missing = match plan_terms.offered.price <= curve.c_max {
        true => format!("misses by {:.4} with noise {noise:.4}", plan_terms.required - seen),
        false => format!("costs {:.2}, and the budget is {:.2}", plan_terms.offered.price, curve.c_max),
    };
    format!("did not sign up on day {day}: the considered plan {plan} {missing}")
}

fn describe_signup(first: &SignupDecision) -> Vec<String> {
    let curve = first.curve;
    let row = |plan: Plan| {
        let plan_terms = &first.plans[plan];
        vec![
            plan.to_string(),
            format!("{:.2}", plan_terms.offered.price),
            format!("{:.4}", plan_terms.offered.quality),
            format!("{:.4}", plan_terms.offered.quality * first.quality_noise),
            format!("{:.4}", plan_terms.required),
            if plan_terms.offered.price <= curve.c_max { String::new() } else { "above budget".to_owned() },
        ]
    };
    let mut lines = vec![format!(
        "curve: budget {:.2}, quality {:.4} to {:.4}, steepness {:.2} and {:.2}",
        curve.c_max, curve.q_min, curve.q_max, curve.steepness_left, curve.steepness_right
    )];
    lines.extend(indented_table(
        &["plan", "price", "quality", "with noise", "required", ""],
        &Plan::ALL.map(row),
    ));
    lines
}

/// Lists satisfaction on the inspected day and on every seventh day before it.
fn satisfaction_line(view: &IndividualView) -> String {
    let listed = view.days.iter().rev().step_by(SATISFACTION_STEP_DAYS).take(12);
    let mut listed: Vec<String> = listed
        .map(|individual_day| format!("day {} {:.3}", individual_day.day, individual_day.satisfaction))
        .collect();
    listed.reverse();
    format!("{SATISFACTION_PREFIX} {}", listed.join(", "))
}

fn event_lines(view: &IndividualView) -> Vec<String> {
    let first = &view.signup;
    let mut lines = vec![format!("day {}: signed up for plan {}", first.day, first.plan)];
    let mut waited = 0;
    for individual_day in &view.days {
        let is_new =
            individual_day.open_issue_days > 0 && (waited == 0 || individual_day.open_issue_days <= waited);
        if waited > 0 && (individual_day.open_issue_days == 0 || is_new) {
            lines.push(format!("day {}: the issue was resolved", individual_day.day));
        }
        if is_new {
            lines.push(format!("day {}: an issue was opened", individual_day.day));
        }
        waited = individual_day.open_issue_days;
        match individual_day.outcome {
            SubscriberOutcome::Cancels(EndCause::Involuntary) => {
                lines.push(format!("day {}: the payment failed", individual_day.day))
            }
            SubscriberOutcome::Cancels(_) => lines.push(format!("day {}: cancelled", individual_day.day)),
            SubscriberOutcome::Switches(plan) => {
                lines.push(format!("day {}: switched to plan {plan}", individual_day.day))
            }
            SubscriberOutcome::Stays if individual_day.is_due => {
                lines.push(format!("day {}: stayed", individual_day.day))
            }
            SubscriberOutcome::Stays => {}
        }
    }
    lines
}
