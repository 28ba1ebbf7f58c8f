//! Diagnoses of the service: capacity, outages and support.

use serde_json::{Value, json};

use super::{ActionItem, ActionTarget, DiagnosisContext, Problem, RISK_DAYS, round_up_to_two_digits};
use crate::formatting::{format_money, format_whole, pluralize};
use crate::peak::PeakProjection;
use novamind_base::formatting::{json_number, percent};
use novamind_record::figures::WeekFigures;
use novamind_session::{CapacityTier, SettingId};
use novamind_tools::ToolId;

/// Number of coming weeks for which capacity must be sufficient, unless the run ends earlier.
const CAPACITY_HORIZON_WEEKS: f64 = 2.0;
/// Outages are reported if they occur on more than this share of days.
const MAX_OUTAGE_SHARE: f64 = 0.01;
/// A backlog is reported if more than this share of subscribers waits for support.
const MAX_BACKLOG_SHARE: f64 = 0.02;
/// Number of days in which the proposed operations budget clears the backlog.
const BACKLOG_CLEARANCE_DAYS: f64 = 7.0;

/// Reports a problem if usage exceeds capacity or will soon do so.
pub(super) fn diagnose_capacity(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let week = situation.last_week()?;
    let tiers = &situation.terms.capacities;
    let now = tiers.iter().find(|tier| tier.tier == situation.settings.capacity_tier)?;
    let busiest = week.busiest_day as f64;
    if busiest > now.units {
        return Some(diagnose_overload(situation, week, now));
    }
    // Usage has not been measured yet with a capacity tier that was chosen today.
    if situation.observation.changes.iter().any(|change| change.setting == SettingId::CapacityTier) {
        return None;
    }
    // The week is computed from the rounded growth in the sentence, so that readers can verify it.
    let growth = (PeakProjection::from_weeks(situation.weeks)?.growth * 1_000.0).round() / 1_000.0;
    if growth <= 1.0 {
        return None;
    }
    let weeks = libm::log(now.units / busiest) / libm::log(growth);
    let next = tiers.iter().find(|tier| tier.tier == now.tier + 1)?;
    let when = if weeks <= 1.0 { "of next week" } else { "of the week after next" };
    (weeks < capacity_horizon(situation.observation.days_left())).then(|| ActionItem {
        problem: Problem::Capacity,
        text: format!(
            "The busiest day of the week used {} units, {} of the {} units of capacity tier {}, and {} more than the busiest day of the week before. At that growth, the busiest day {when} exceeds the tier.",
            format_whole(busiest),
            percent(busiest / now.units, 0),
            format_whole(now.units),
            now.tier,
            percent(growth - 1.0, 1)
        ),
        proposal: Some(describe_tier_cost(next, now)),
        target: ActionTarget::Call(ToolId::SetCapacityTier, json!({ "tier": next.tier })),
        at_risk: situation.upcoming_revenue(),
        is_urgent: false,
    })
}

/// Returns the number of coming weeks whose busiest day is projected. A shorter last week of the run is not projected,
/// because it may not contain the busiest day.
fn capacity_horizon(days_left: u32) -> f64 {
    CAPACITY_HORIZON_WEEKS.min(f64::from(days_left / 7))
}

fn diagnose_overload(situation: &DiagnosisContext<'_>, week: &WeekFigures, now: &CapacityTier) -> ActionItem {
    let busiest = week.busiest_day as f64;
    let tiers = &situation.terms.capacities;
    let tier_target =
        |tier: &CapacityTier| ActionTarget::Call(ToolId::SetCapacityTier, json!({ "tier": tier.tier }));
    let (proposal, target) = match (tiers.iter().find(|tier| tier.units >= busiest), tiers.last()) {
        (Some(enough), _) => (describe_tier_cost(enough, now), tier_target(enough)),
        (None, Some(largest)) if largest.tier > now.tier => {
            let text = format!(
                "{} It is the largest tier. Only lower quotas or fewer subscribers reduce the rest of the overload.",
                describe_tier_cost(largest, now)
            );
            (text, tier_target(largest))
        }
        (None, _) => (
            format!(
                "Tier {} is the largest tier. Only lower quotas or fewer subscribers reduce usage.",
                now.tier
            ),
            ActionTarget::Call(ToolId::SetUsageQuotas, Value::Null),
        ),
    };
    ActionItem {
        problem: Problem::Overload,
        text: format!(
            "The busiest day used {} units, {} above the {} units of capacity tier {}.",
            format_whole(busiest),
            percent(busiest / now.units - 1.0, 1),
            format_whole(now.units),
            now.tier
        ),
        proposal: Some(proposal),
        target,
        at_risk: situation.upcoming_revenue(),
        is_urgent: true,
    }
}

fn describe_tier_cost(tier: &CapacityTier, now: &CapacityTier) -> String {
    format!(
        "Tier {} serves {} units for {} a day, {} more.",
        tier.tier,
        format_whole(tier.units),
        format_money(tier.cost),
        format_money(tier.cost - now.cost)
    )
}

/// Reports outages that higher operations spending would reduce. Outages during overload are excluded.
pub(super) fn diagnose_outages(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let week = situation.last_week().filter(|week| week.outage && week.overload_peak == 0.0)?;
    let operations = situation.settings.operations;
    let share = |dollars: f64| situation.session.company().outage_share(dollars);
    let now = share(operations);
    if now < MAX_OUTAGE_SHARE {
        return None;
    }
    // The smallest round amount that makes outages half as frequent.
    let more = (1..=200)
        .map(|step| operations + 50.0 * f64::from(step))
        .find(|dollars| share(*dollars) <= now / 2.0)?;
    let at_risk = situation.upcoming_revenue() * (now * RISK_DAYS).min(1.0);
    // Do not propose spending that exceeds the possible savings.
    if (more - operations) * RISK_DAYS > at_risk {
        return None;
    }
    Some(ActionItem {
        problem: Problem::Outages,
        text: format!(
            "Outages took {} last week. With operations at {} a day, {} of days have an outage.",
            pluralize(week.downtime_minutes, "minute"),
            format_money(operations),
            percent(now, 1)
        ),
        proposal: Some(format!(
            "{} a day reduce the share to {}.",
            format_money(more),
            percent(share(more), 1)
        )),
        target: ActionTarget::Call(ToolId::SetDailySpend, json!({ "operations": json_number(more) })),
        at_risk,
        is_urgent: true,
    })
}

/// Reports a backlog if many subscribers have waited for support for more than a day.
pub(super) fn diagnose_backlog(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let week = situation.last_week()?;
    let people = f64::from(week.individual_subscribers.max(1));
    let opened = f64::from(week.issues_opened) / f64::from(week.days_run.max(1));
    let waiting = f64::from(week.open_issues) - opened;
    if waiting <= 20.0 || waiting <= MAX_BACKLOG_SHARE * people {
        return None;
    }
    let (base, per_dollar) = situation.terms.issues_solved;
    let operations = situation.settings.operations + situation.session.settings().targeted_operations.total();
    // Subscribers with an open issue do not open another one, so more issues are opened once the backlog is cleared.
    let free = (people - f64::from(week.open_issues)).max(1.0);
    let inflow = opened * people / free;
    let needed = inflow + f64::from(week.open_issues) / BACKLOG_CLEARANCE_DAYS;
    let dollars = round_up_to_two_digits((needed - base) / per_dollar);
    if dollars <= operations {
        return None;
    }
    let general = dollars - (operations - situation.settings.operations);
    let at_risk = situation.upcoming_revenue() * (waiting / people).min(1.0);
    if (dollars - operations) * RISK_DAYS > at_risk {
        return None;
    }
    let solved = (base + per_dollar * dollars).round();
    // The number of days is computed from the rounded numbers in the sentence, so that readers can verify it.
    let days = (f64::from(week.open_issues) / (solved - inflow.round()).max(1.0)).ceil();
    Some(ActionItem {
        problem: Problem::Backlog,
        text: format!(
            "{} {} for support. Each day brings {}, and operations of {} a day resolve about {}.",
            pluralize(week.open_issues, "subscriber"),
            if week.open_issues == 1 { "waits" } else { "wait" },
            pluralize(opened.round() as u32, "new issue"),
            format_money(operations),
            format_whole(base + per_dollar * operations)
        ),
        proposal: Some(format!(
            "{} a day resolve about {}: the {} new issues a day that are expected when no one waits, and the backlog in {}.",
            format_money(dollars),
            format_whole(solved),
            format_whole(inflow),
            pluralize(days as u32, "day")
        )),
        target: ActionTarget::Call(ToolId::SetDailySpend, json!({ "operations": json_number(general) })),
        at_risk,
        is_urgent: true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capacity_is_projected_only_for_complete_weeks_of_the_run() {
        let horizons = [400, 14, 13, 7, 3, 0].map(capacity_horizon);
        assert_eq!(horizons, [2.0, 2.0, 1.0, 1.0, 0.0, 0.0]);
    }
}
