//! X-ray views of groups, of the market and of draws, as data.

use serde_json::{Map, Value, json};

use novamind_insight::{
    DriftState, Follows, GroupDrifted, KeyedDraws, MoodTerm, NextDraws, NextRivalMove, OwnChange,
    PlanDelivered, QualityEquation, ReputationEquation, RivalState, SatisfactionEquation, Spillover,
};
use novamind_session::RivalEvent;
use novamind_session::identifiers::{Group, Plan};

pub(super) fn quality_as_data(own: &QualityEquation) -> Value {
    let plan = |plan: Plan| {
        let PlanDelivered { tier, multiplier, delivered } = own.plans[plan];
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
        "own": own.own,
        "plans": Plan::ALL.map(plan),
        "service_penalty": own.service_penalty,
        "gains": own.gains,
        "banks": {"shared": own.shared_bank, "own": own.own_bank},
        "expectation": {
            "everyone": own.everyone, "quality": own.expectation.quality, "budget": own.expectation.c_max,
        },
    })
}

pub(super) fn satisfaction_as_data(own: &SatisfactionEquation) -> Value {
    let terms = |of: &dyn Fn(MoodTerm) -> Option<f64>| {
        let named = MoodTerm::ALL.map(|term| (term.id().to_owned(), json!(of(term))));
        Value::Object(named.into_iter().collect())
    };
    json!({
        "group": own.group.id(),
        "day": own.day,
        "weight": own.weight,
        "felt_by": own.felt_by(),
        "before": own.before(),
        "terms": terms(&|term| own.term(term)),
        "terms_yesterday": terms(&|term| own.term_yesterday(term)),
        "felt": own.instant(),
        "after": own.after(),
        "left": own.left,
        "came": own.came,
        "subscribers": own.subscribers,
        "evening": own.evening,
    })
}

fn contribution(own: &OwnChange) -> Value {
    json!({"subscribers": own.subscribers, "called": own.called, "counts": own.counts, "change": own.made()})
}

pub(super) fn reputation_as_data(own: &ReputationEquation) -> Value {
    json!({
        "group": own.group.id(),
        "day": own.day,
        "before": own.before,
        "cancellations": own.gave_up,
        "lost_companies": own.lost,
        "own": contribution(&own.own),
        "spills": own.spills,
        "bounds": own.bounds,
        "after": own.after,
        "least_own_change": own.least.own,
        "least_spill": own.least.spill,
    })
}

pub(super) fn spillover_as_data(own: &Spillover) -> Value {
    let of = |group: &Group| (group.id().to_owned(), contribution(&own.own[*group]));
    json!({
        "day": own.day,
        "own": Value::Object(own.known.iter().map(of).collect()),
        "spills": own.spills,
        "least_own_change": own.least.own,
        "least_spill": own.least.spill,
    })
}

fn rival_event(own: &RivalEvent) -> Value {
    let RivalEvent { day, boost, sampled, u, by_feedback } = own;
    json!({"day": day, "raised_by": boost, "drawn_size": sampled, "share": u, "copied": by_feedback})
}

pub(super) fn rivals_as_data(own: &RivalState) -> Value {
    let bank = |(group, bonus, bank): &(Group, f64, f64)| {
        (group.id().to_owned(), json!({"improvements": bonus, "bank": bank}))
    };
    let next = |next: &NextRivalMove| {
        let shares = next.shares.iter().map(|(group, share)| (group.id().to_owned(), json!(share)));
        json!({
            "day": next.day, "drawn_size": next.sampled, "share": next.u, "copied": next.copied(own.shared_bank),
            "copies_above": next.copies_above(), "shares": Value::Object(shares.collect()),
            "made": next.made.as_ref().map(rival_event),
        })
    };
    json!({
        "day": own.day,
        "shared_improvements": own.shared_bonus,
        "shared_bank": own.shared_bank,
        "own": Value::Object(own.own.iter().map(bank).collect()),
        "everyone": own.everyone,
        "moves": own.moves.iter().map(|(event, _)| rival_event(event)).collect::<Vec<_>>(),
        "next": own.next.as_ref().map(next),
    })
}

pub(super) fn drift_as_data(own: &DriftState) -> Value {
    let group = |own: &GroupDrifted| {
        json!({
            "group": own.group.id(), "known": own.is_known, "own": own.own,
            "quality": own.expectation.quality, "budget": own.expectation.c_max,
            "next_own": own.step.quality, "next_budget": own.step.c_max,
        })
    };
    json!({
        "day": own.day,
        "everyone": own.everyone,
        "next_day": own.next_day,
        "next_everyone": own.step,
        "groups": own.groups.iter().map(group).collect::<Vec<_>>(),
    })
}

pub(super) fn streams_as_data(own: &NextDraws) -> Value {
    let stream = |own: &KeyedDraws| {
        let key: Map<String, Value> =
            own.key.iter().map(|(name, value)| ((*name).to_owned(), json!(value))).collect();
        json!({
            "stream": own.stream,
            "key": key,
            "group": own.group.map(Group::id),
            "uniform": own.draws.iter().map(|draw| draw.uniform).collect::<Vec<_>>(),
            "normal": own.draws.iter().map(|draw| draw.normal).collect::<Vec<_>>(),
            "follows": follows(&own.follows),
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

fn follows(own: &Follows) -> Value {
    match own {
        Follows::Leads { expected, number } => json!({"expected": expected, "leads": number}),
        Follows::FailedPayments { rate, customers } => json!({"rate": rate, "customers": customers}),
        Follows::OutageAbove(chance) => json!({"outage_above": chance}),
        Follows::Noise(noise) => json!({"noise": noise}),
        Follows::Project { tier, days, gain } => json!({"tier": tier, "days": days, "gain": gain}),
        Follows::Found(group) => json!({"found": group.map(Group::id)}),
        Follows::Surge(surge) => json!({
            "surge": surge.map(|own| json!({"until": own.end_day - 1, "multiplier": own.multiplier})),
        }),
        Follows::Index { before, after } => json!({"before": before, "after": after}),
        Follows::RivalMove(made) => json!({
            "move": made.map(|(sampled, u)| json!({"drawn_size": sampled, "share": u})),
        }),
    }
}
