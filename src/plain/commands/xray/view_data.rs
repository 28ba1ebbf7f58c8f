//! X-ray views of groups, of the market and of draws, as data.

use serde_json::{Map, Value, json};

use novamind_insight::{
    CompetitorState, DeliveredPlanQuality, DrawEffect, DriftState, GroupDriftState, KeyedDraws,
    NextCompetitorMove, NextDraws, QualityEquation, ReputationEquation, SatisfactionEquation,
    SatisfactionTerm, Spillover, SubscriberContribution,
};
use novamind_session::RivalEvent;
use novamind_session::identifiers::{Group, Plan};

pub(super) fn quality_to_json(own: &QualityEquation) -> Value {
    let plan = |plan: Plan| {
        let DeliveredPlanQuality { tier, multiplier, delivered } = own.plans[plan];
        json!({
            "plan": plan.id(), "tier": tier, "multiplier": multiplier, "delivered": delivered,
            "felt": delivered - own.service_penalty,
        })
    };
    json!({
        "group": own.group.id(),
        "day": own.day,
        "base": own.base,
        "shared": own.shared,
        "own": own.group_gain,
        "plans": Plan::ALL.map(plan),
        "service_penalty": own.service_penalty,
        "gains": own.gains,
        "banks": {"shared": own.shared_bank, "own": own.group_bank},
        "expectation": {
            "everyone": own.common_expectation, "quality": own.expectation.quality, "budget": own.expectation.c_max,
        },
    })
}

pub(super) fn satisfaction_to_json(own: &SatisfactionEquation) -> Value {
    let terms = |of: &dyn Fn(SatisfactionTerm) -> Option<f64>| {
        let named = SatisfactionTerm::ALL.map(|term| (term.id().to_owned(), json!(of(term))));
        Value::Object(named.into_iter().collect())
    };
    json!({
        "group": own.group.id(),
        "day": own.day,
        "weight": own.weight,
        "felt_by": own.included_subscribers(),
        "before": own.before(),
        "terms": terms(&|term| own.term(term)),
        "terms_yesterday": terms(&|term| own.term_yesterday(term)),
        "felt": own.instant(),
        "after": own.after(),
        "left": own.departed,
        "came": own.joined,
        "subscribers": own.subscribers,
        "evening": own.end_of_day,
    })
}

fn contribution_to_json(own: &SubscriberContribution) -> Value {
    json!({"subscribers": own.subscribers, "called": own.requested_change, "counts": own.is_applied, "change": own.applied_change()})
}

pub(super) fn reputation_to_json(own: &ReputationEquation) -> Value {
    json!({
        "group": own.group.id(),
        "day": own.day,
        "before": own.before,
        "cancellations": own.individual_departures,
        "lost_companies": own.enterprise_departures,
        "own": contribution_to_json(&own.contribution),
        "spills": own.spillovers,
        "bounds": own.bounds,
        "after": own.after,
        "least_own_change": own.thresholds.subscriber_contribution,
        "least_spill": own.thresholds.spillover,
    })
}

pub(super) fn spillover_to_json(own: &Spillover) -> Value {
    let of = |group: &Group| (group.id().to_owned(), contribution_to_json(&own.contributions[*group]));
    json!({
        "day": own.day,
        "own": Value::Object(own.known_groups.iter().map(of).collect()),
        "spills": own.spillovers,
        "least_own_change": own.thresholds.subscriber_contribution,
        "least_spill": own.thresholds.spillover,
    })
}

fn competitor_event_to_json(own: &RivalEvent) -> Value {
    let RivalEvent { day, boost, sampled, u, by_feedback } = own;
    json!({"day": day, "raised_by": boost, "drawn_size": sampled, "share": u, "copied": by_feedback})
}

pub(super) fn competitors_to_json(own: &CompetitorState) -> Value {
    let bank = |(group, bonus, bank): &(Group, f64, f64)| {
        (group.id().to_owned(), json!({"improvements": bonus, "bank": bank}))
    };
    let next = |next: &NextCompetitorMove| {
        let shares = next.group_shares.iter().map(|(group, share)| (group.id().to_owned(), json!(share)));
        json!({
            "day": next.day, "drawn_size": next.sampled_size, "share": next.copied_share, "copied": next.copied_quality(own.shared_bank),
            "copies_above": next.copy_threshold(), "shares": Value::Object(shares.collect()),
            "made": next.outcome.as_ref().map(competitor_event_to_json),
        })
    };
    json!({
        "day": own.day,
        "shared_improvements": own.shared_bonus,
        "shared_bank": own.shared_bank,
        "own": Value::Object(own.group_banks.iter().map(bank).collect()),
        "everyone": own.common_expectation,
        "moves": own.moves.iter().map(|(event, _)| competitor_event_to_json(event)).collect::<Vec<_>>(),
        "next": own.next_move.as_ref().map(next),
    })
}

pub(super) fn drift_to_json(own: &DriftState) -> Value {
    let group = |own: &GroupDriftState| {
        json!({
            "group": own.group.id(), "known": own.is_known, "own": own.group_expectation,
            "quality": own.expectation.quality, "budget": own.expectation.c_max,
            "next_own": own.next_step.quality, "next_budget": own.next_step.c_max,
        })
    };
    json!({
        "day": own.day,
        "everyone": own.common_expectation,
        "next_day": own.next_day,
        "next_everyone": own.next_common_step,
        "groups": own.groups.iter().map(group).collect::<Vec<_>>(),
    })
}

pub(super) fn streams_to_json(own: &NextDraws) -> Value {
    let stream = |own: &KeyedDraws| {
        let key: Map<String, Value> =
            own.key.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
        json!({
            "stream": own.stream,
            "key": key,
            "group": own.group.map(Group::id),
            "uniform": own.draws.iter().map(|draw| draw.uniform).collect::<Vec<_>>(),
            "normal": own.draws.iter().map(|draw| draw.normal).collect::<Vec<_>>(),
            "follows": follows_to_json(&own.effect),
        })
    };
    json!({
        "part": own.part.id(),
        "day": own.day,
        "run_is_over": own.is_over,
        "replayed": own.is_replayed,
        "streams": own.streams.iter().map(stream).collect::<Vec<_>>(),
    })
}

fn follows_to_json(own: &DrawEffect) -> Value {
    match own {
        DrawEffect::Leads { expected, number } => json!({"expected": expected, "leads": number}),
        DrawEffect::FailedPayments { rate, customers } => json!({"rate": rate, "customers": customers}),
        DrawEffect::OutageAbove(chance) => json!({"outage_above": chance}),
        DrawEffect::Noise(noise) => json!({"noise": noise}),
        DrawEffect::Project { tier, days, gain } => json!({"tier": tier, "days": days, "gain": gain}),
        DrawEffect::Found(group) => json!({"found": group.map(Group::id)}),
        DrawEffect::Surge(surge) => json!({
            "surge": surge.map(|own| json!({"until": own.end_day - 1, "multiplier": own.multiplier})),
        }),
        DrawEffect::Index { before, after } => json!({"before": before, "after": after}),
        DrawEffect::CompetitorMove(made) => json!({
            "move": made.map(|(sampled, u)| json!({"drawn_size": sampled, "share": u})),
        }),
    }
}
