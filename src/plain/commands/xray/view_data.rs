//! Converts the x-ray views of groups, the market and random draws to JSON.

use serde_json::{Map, Value, json};

use novamind_insight::{
    CompetitorState, DeliveredPlanQuality, DrawEffect, DriftState, GroupDriftState, KeyedDraws,
    NextCompetitorMove, NextDraws, QualityEquation, ReputationEquation, SatisfactionEquation,
    SatisfactionTerm, Spillover, SubscriberContribution,
};
use novamind_session::CompetitorEvent;
use novamind_session::identifiers::{Group, Plan};

pub(super) fn quality_to_json(quality_equation: &QualityEquation) -> Value {
    let plan = |plan: Plan| {
        let DeliveredPlanQuality { tier, multiplier, delivered } = quality_equation.plans[plan];
        json!({
            "plan": plan.id(), "tier": tier, "multiplier": multiplier, "delivered": delivered,
            "felt": delivered - quality_equation.service_penalty,
        })
    };
    json!({
        "group": quality_equation.group.id(),
        "day": quality_equation.day,
        "base": quality_equation.base,
        "shared": quality_equation.shared,
        "own": quality_equation.group_gain,
        "plans": Plan::ALL.map(plan),
        "service_penalty": quality_equation.service_penalty,
        "gains": quality_equation.gains,
        "banks": {"shared": quality_equation.shared_bank, "own": quality_equation.group_bank},
        "expectation": {
            "everyone": quality_equation.common_expectation, "quality": quality_equation.expectation.quality, "budget": quality_equation.expectation.c_max,
        },
    })
}

pub(super) fn satisfaction_to_json(satisfaction_equation: &SatisfactionEquation) -> Value {
    let terms = |of: &dyn Fn(SatisfactionTerm) -> Option<f64>| {
        let named = SatisfactionTerm::ALL.map(|term| (term.id().to_owned(), json!(of(term))));
        Value::Object(named.into_iter().collect())
    };
    json!({
        "group": satisfaction_equation.group.id(),
        "day": satisfaction_equation.day,
        "weight": satisfaction_equation.weight,
        "felt_by": satisfaction_equation.included_subscribers(),
        "before": satisfaction_equation.before(),
        "terms": terms(&|term| satisfaction_equation.term(term)),
        "terms_yesterday": terms(&|term| satisfaction_equation.term_yesterday(term)),
        "felt": satisfaction_equation.instant_satisfaction(),
        "after": satisfaction_equation.after(),
        "left": satisfaction_equation.departed,
        "came": satisfaction_equation.joined,
        "subscribers": satisfaction_equation.subscribers,
        "evening": satisfaction_equation.end_of_day,
    })
}

fn contribution_to_json(subscriber_contribution: &SubscriberContribution) -> Value {
    json!({"subscribers": subscriber_contribution.subscribers, "called": subscriber_contribution.requested_change, "counts": subscriber_contribution.is_applied, "change": subscriber_contribution.applied_change()})
}

pub(super) fn reputation_to_json(reputation_equation: &ReputationEquation) -> Value {
    json!({
        "group": reputation_equation.group.id(),
        "day": reputation_equation.day,
        "before": reputation_equation.before,
        "cancellations": reputation_equation.individual_departures,
        "lost_companies": reputation_equation.enterprise_departures,
        "own": contribution_to_json(&reputation_equation.contribution),
        "spills": reputation_equation.spillovers,
        "bounds": reputation_equation.bounds,
        "after": reputation_equation.after,
        "least_own_change": reputation_equation.thresholds.subscriber_contribution,
        "least_spill": reputation_equation.thresholds.spillover,
    })
}

pub(super) fn spillover_to_json(spillover: &Spillover) -> Value {
    let of = |group: &Group| (group.id().to_owned(), contribution_to_json(&spillover.contributions[*group]));
    json!({
        "day": spillover.day,
        "own": Value::Object(spillover.known_groups.iter().map(of).collect()),
        "spills": spillover.spillovers,
        "least_own_change": spillover.thresholds.subscriber_contribution,
        "least_spill": spillover.thresholds.spillover,
    })
}

fn competitor_event_to_json(event: &CompetitorEvent) -> Value {
    let CompetitorEvent { day, boost, sampled, u, by_feedback } = event;
    json!({"day": day, "raised_by": boost, "drawn_size": sampled, "share": u, "copied": by_feedback})
}

pub(super) fn competitors_to_json(competitor_state: &CompetitorState) -> Value {
    let bank = |(group, bonus, bank): &(Group, f64, f64)| {
        (group.id().to_owned(), json!({"improvements": bonus, "bank": bank}))
    };
    let next = |next: &NextCompetitorMove| {
        let shares = next.group_shares.iter().map(|(group, share)| (group.id().to_owned(), json!(share)));
        json!({
            "day": next.day, "drawn_size": next.sampled_size, "share": next.copied_share, "copied": next.copied_quality(competitor_state.shared_bank),
            "copies_above": next.copy_threshold(), "shares": Value::Object(shares.collect()),
            "made": next.outcome.as_ref().map(competitor_event_to_json),
        })
    };
    json!({
        "day": competitor_state.day,
        "shared_improvements": competitor_state.shared_bonus,
        "shared_bank": competitor_state.shared_bank,
        "own": Value::Object(competitor_state.group_banks.iter().map(bank).collect()),
        "everyone": competitor_state.common_expectation,
        "moves": competitor_state.moves.iter().map(|(event, _)| competitor_event_to_json(event)).collect::<Vec<_>>(),
        "next": competitor_state.next_move.as_ref().map(next),
    })
}

pub(super) fn drift_to_json(drift_state: &DriftState) -> Value {
    let group = |state: &GroupDriftState| {
        json!({
            "group": state.group.id(), "known": state.is_known, "own": state.group_expectation,
            "quality": state.expectation.quality, "budget": state.expectation.c_max,
            "next_own": state.next_step.quality, "next_budget": state.next_step.c_max,
        })
    };
    json!({
        "day": drift_state.day,
        "everyone": drift_state.common_expectation,
        "next_day": drift_state.next_day,
        "next_everyone": drift_state.next_common_step,
        "groups": drift_state.groups.iter().map(group).collect::<Vec<_>>(),
    })
}

pub(super) fn streams_to_json(next_draws: &NextDraws) -> Value {
    let stream = |keyed_draws: &KeyedDraws| {
        let key: Map<String, Value> =
            keyed_draws.key.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
        json!({
            "stream": keyed_draws.stream,
            "key": key,
            "group": keyed_draws.group.map(Group::id),
            "uniform": keyed_draws.draws.iter().map(|draw| draw.uniform).collect::<Vec<_>>(),
            "normal": keyed_draws.draws.iter().map(|draw| draw.normal).collect::<Vec<_>>(),
            "follows": follows_to_json(&keyed_draws.effect),
        })
    };
    json!({
        "part": next_draws.part.id(),
        "day": next_draws.day,
        "run_is_over": next_draws.is_over,
        "replayed": next_draws.is_replayed,
        "streams": next_draws.streams.iter().map(stream).collect::<Vec<_>>(),
    })
}

fn follows_to_json(draw_effect: &DrawEffect) -> Value {
    match draw_effect {
        DrawEffect::Leads { expected, number } => json!({"expected": expected, "leads": number}),
        DrawEffect::FailedPayments { rate, customers } => json!({"rate": rate, "customers": customers}),
        DrawEffect::OutageAbove(chance) => json!({"outage_above": chance}),
        DrawEffect::Noise(noise) => json!({"noise": noise}),
        DrawEffect::Project { tier, days, gain } => json!({"tier": tier, "days": days, "gain": gain}),
        DrawEffect::Found(group) => json!({"found": group.map(Group::id)}),
        DrawEffect::Surge(surge) => json!({
            "surge": surge.map(|change| json!({"until": change.end_day - 1, "multiplier": change.multiplier})),
        }),
        DrawEffect::Index { before, after } => json!({"before": before, "after": after}),
        DrawEffect::CompetitorMove(made) => json!({
            "move": made.map(|(sampled, u)| json!({"drawn_size": sampled, "share": u})),
        }),
    }
}
