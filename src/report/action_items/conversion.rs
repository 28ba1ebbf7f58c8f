//! Diagnosis of a falling conversion.

use super::offer_changes::OfferChange;
use super::selling::MIN_CONVERSION;
use super::{ActionItem, ActionTarget, DiagnosisContext, MAX_CHANCE, Problem, RISK_DAYS};
use crate::fit::LeadFlow;
use crate::formatting::{format_whole, pluralize};
use crate::measured_conversion::SETTINGS_JUDGED_BY_LEADS;
use novamind_base::formatting::percent;
use novamind_session::identifiers::{Group, Plan};

/// Number of earlier weeks that the last week is compared with.
const COMPARED_WEEKS: usize = 4;
/// Minimum number of leads and of signups in each compared period. With fewer, the normal approximation of the
/// difference is not valid.
const MIN_COUNT: u32 = 20;
/// Finds groups of individuals whose conversion fell by more than its sampling error. Groups with a very low conversion
/// are reported as groups without sales.
pub(super) fn conversion_falls(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    situation.individuals().filter_map(|estimates| conversion_fall(situation, estimates.group)).collect()
}

fn conversion_fall(situation: &DiagnosisContext<'_>, group: Group) -> Option<ActionItem> {
    let (last, earlier) = situation.groups.split_last()?;
    let earlier = &earlier[earlier.len().saturating_sub(COMPARED_WEEKS)..];
    let now = LeadFlow::from_week(&last[group]);
    let before = LeadFlow::sum(earlier.iter().map(|week| &week[group]));
    let few = |flow: &LeadFlow| flow.leads < MIN_COUNT;
    if few(&now) || few(&before) || before.signups < MIN_COUNT {
        return None;
    }
    let (share, usual) = (now.conversion()?, before.conversion()?);
    if share < MIN_CONVERSION || usual - share <= MAX_CHANCE * standard_error(&now, &before) {
        return None;
    }
    let fewer = usual * f64::from(now.leads) - f64::from(now.signups);
    // A change before the compared weeks affects all leads in these weeks, so it cannot explain a difference between
    // them.
    let since = situation.observation.day.saturating_sub(7 * (earlier.len() as u32 + 1));
    let change = OfferChange::find_last(situation, &SETTINGS_JUDGED_BY_LEADS, since);
    let change_text = change.as_ref().map_or(String::new(), |change| format!(" {}", change.describe()));
    Some(ActionItem {
        problem: Problem::ConversionFall(group),
        text: format!(
            "{group}: {} of {} leads signed up last week ({}). In the {} before, it was {} of {} ({}). At that \
             conversion, {} more would have signed up.{change_text}",
            format_whole(f64::from(now.signups)),
            format_whole(f64::from(now.leads)),
            percent(share, 1),
            pluralize(earlier.len() as u32, "week"),
            format_whole(f64::from(before.signups)),
            format_whole(f64::from(before.leads)),
            percent(usual, 1),
            format_whole(fewer)
        ),
        proposal: None,
        target: change.map_or(ActionTarget::Group(group), |change| change.restore_target(situation, group)),
        at_risk: fewer * mean_price(situation, group)? * RISK_DAYS / 7.0,
        is_urgent: true,
    })
}

/// Returns the standard error of the difference between two conversions, computed from their pooled conversion.
fn standard_error(left: &LeadFlow, right: &LeadFlow) -> f64 {
    let (leads, others) = (f64::from(left.leads), f64::from(right.leads));
    let pooled = f64::from(left.signups + right.signups) / (leads + others);
    (pooled * (1.0 - pooled) * (1.0 / leads + 1.0 / others)).sqrt()
}

/// Returns the mean list price of the plans for which customers of the group signed up in the last week, dollars per
/// month.
fn mean_price(situation: &DiagnosisContext<'_>, group: Group) -> Option<f64> {
    let chosen = situation.last_group_week()?[group].chosen;
    let signups: u32 = chosen.0.iter().sum();
    let prices = Plan::ALL.map(|plan| f64::from(chosen[plan]) * situation.settings.prices[plan]);
    (signups > 0).then(|| prices.iter().sum::<f64>() / f64::from(signups))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_error_of_a_difference_follows_the_pooled_share() {
        let flow = |leads, signups| LeadFlow { leads, signups, ..LeadFlow::default() };
        let error = standard_error(&flow(100, 40), &flow(400, 160));
        assert!((error - (0.4 * 0.6 * (0.01_f64 + 0.0025)).sqrt()).abs() < 1e-12, "{error}");
    }
}
