//! Diagnoses of advertising that costs too much for its results.

use serde_json::{Map, Value, json};

use super::selling::{GroupOffers, OfferDeficit};
use super::{ActionItem, ActionTarget, DiagnosisContext, Problem, RISK_DAYS};
use crate::formatting::{format_money, pluralize};
use crate::lead_costs::{AdResults, LeadCost, WINDOW_WEEKS, lead_costs_by_pair};
use novamind_base::formatting::{dollars_and_cents, json_number};
use novamind_session::identifiers::{ByGroup, Channel, Group};
use novamind_session::{Estimates, GroupWeek};
use novamind_tools::ToolId;

/// Minimum number of enterprises of a group that must arrive in four weeks before missing requests are reported.
const MIN_ENTERPRISES: u32 = 3;
/// Upper bound of the mean of a Poisson distribution of which 0 was observed, at a confidence of 95 %: −ln 0.05,
/// rounded up.
const MAX_EXPECTED_WITHOUT_ANY: u32 = 3;

/// Finds enterprise groups that receive advertising but request no offers.
pub(super) fn groups_without_requests(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    let recent = &situation.groups[situation.groups.len().saturating_sub(4)..];
    let enterprises = situation.estimates.iter().filter(|estimates| estimates.group.is_enterprise());
    let paid = enterprises.filter(|estimates| situation.ads_by_group[estimates.group] > 0.0);
    let unwanted = paid.filter_map(|estimates| {
        let lead_count: u32 = recent.iter().map(|week| week[estimates.group].leads).sum();
        let asked: u32 = recent.iter().map(|week| week[estimates.group].asked).sum();
        if lead_count < MIN_ENTERPRISES || asked > 0 {
            return None;
        }
        let offers = GroupOffers::new(situation, estimates)?;
        let ads = situation.ads_by_group[estimates.group];
        let text = format!(
            "{}: {} arrived in {} and none requested an offer. Ads for the group cost {} a day.",
            estimates.group,
            pluralize(lead_count, "enterprise"),
            pluralize(recent.len() as u32, "week"),
            format_money(ads)
        );
        // If the cause is unknown, only the cost of advertising can be reported.
        let (text, proposal, place) = match offers.main_deficit() {
            missing @ (OfferDeficit::Quota | OfferDeficit::Quality) => {
                let (remedy, proposal, place) = offers.propose_remedy(missing, ads * RISK_DAYS)?;
                (format!("{text} {remedy}"), Some(proposal), place)
            }
            OfferDeficit::Price | OfferDeficit::Balance => {
                let place = target_without_ads(situation, estimates.group, |_| true);
                (text, Some(propose_removal(ads)), place)
            }
        };
        Some(ActionItem {
            problem: Problem::NoRequests(estimates.group),
            text,
            proposal,
            target: place,
            at_risk: ads * RISK_DAYS,
            is_urgent: false,
        })
    });
    unwanted.collect()
}

/// Finds groups whose ads have brought no signup, or no request for an offer, for at least four weeks.
pub(super) fn ads_without_results(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    let of_group = |estimates| group_ads_without_results(situation, estimates);
    situation.estimates.iter().filter_map(of_group).collect()
}

fn group_ads_without_results(situation: &DiagnosisContext<'_>, estimates: &Estimates) -> Option<ActionItem> {
    let (group, ads) = (estimates.group, situation.ads_by_group[estimates.group]);
    let fruitless = FruitlessAds::of_group(situation.groups, group);
    // The smallest enterprises and all individuals have `seats.0` seats.
    let first_bills = f64::from(MAX_EXPECTED_WITHOUT_ANY) * estimates.budget * estimates.seats.0;
    if ads <= 0.0 || (fruitless.weeks as usize) < WINDOW_WEEKS || fruitless.spend <= first_bills {
        return None;
    }
    let (lead, result, no_result, customers) = match group.is_enterprise() {
        true => ("enterprise", "request", "none requested an offer", "of the smallest enterprises"),
        false => ("lead", "signup", "none signed up", "customers"),
    };
    let (brought, result) = match fruitless.leads {
        0 => (" and brought no lead.".to_owned(), "lead"),
        leads => (format!(" and brought {}, but {no_result}.", pluralize(leads, lead)), result),
    };
    let weeks = pluralize(fruitless.weeks, "week");
    Some(ActionItem {
        problem: Problem::NoAdResults(group),
        text: format!(
            "{group}: ads for the group cost {} in the last {weeks}{brought} After {weeks} without a {result}, fewer \
             than {MAX_EXPECTED_WITHOUT_ANY} can be expected in as many weeks, with 95% confidence. \
             {MAX_EXPECTED_WITHOUT_ANY} {customers} with the mean budget pay {} a month.",
            format_money(fruitless.spend),
            format_money(first_bills)
        ),
        proposal: Some(propose_removal(ads)),
        target: target_without_ads(situation, group, |_| true),
        at_risk: ads * RISK_DAYS,
        is_urgent: false,
    })
}

/// The most recent consecutive weeks in which ads for a group cost money and had no result. Results are signups of
/// individuals, and requests of enterprises for an offer.
#[derive(Debug, Default, PartialEq)]
struct FruitlessAds {
    weeks: u32,
    /// Leads that the ads brought.
    leads: u32,
    /// Cost of the ads, dollars.
    spend: f64,
}

impl FruitlessAds {
    fn of_group(weeks: &[ByGroup<GroupWeek>], group: Group) -> FruitlessAds {
        let mut sum = FruitlessAds::default();
        for week in weeks.iter().rev().map(|groups| &groups[group]) {
            let spend: f64 = week.paid.iter().map(|paid| paid.spend).sum();
            let leads: u32 = week.paid.iter().map(|paid| paid.leads).sum();
            let signups: u32 = week.paid.iter().map(|paid| paid.billed).sum();
            // Requests are not counted by source.
            let results = if group.is_enterprise() { week.asked.min(leads) } else { signups };
            if spend <= 0.0 || results > 0 {
                break;
            }
            sum = FruitlessAds { weeks: sum.weeks + 1, leads: sum.leads + leads, spend: sum.spend + spend };
        }
        sum
    }
}

fn propose_removal(ads: f64) -> String {
    format!("Removing these ads saves {} a day.", format_money(ads))
}

/// Finds pairs of channel and group whose cost per lead has risen strongly.
pub(super) fn rising_lead_costs(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    lead_costs_by_pair(situation.groups).iter().filter_map(|pair| expensive_leads(situation, pair)).collect()
}

fn expensive_leads(situation: &DiagnosisContext<'_>, pair: &LeadCost) -> Option<ActionItem> {
    let (rise, before) = (pair.cost_rise()?, pair.cheapest?);
    let (channel, group) = (pair.channel, pair.group);
    let ads = situation.session.settings().targeted_ads.spend(channel, group);
    if ads <= 0.0 {
        return None;
    }
    // Ads are not too expensive if the first bills of the customers that they bring exceed their cost.
    let bill = situation.last_group_week().map_or(0.0, |groups| groups[group].revenue_per_subscriber());
    if pair.recent.cost_per_bill().is_some_and(|cost| cost < bill) {
        return None;
    }
    let (first, last) = before.weeks;
    let text = format!(
        "{} × {group}: in the last {} {}. In weeks {first} to {last} {}.",
        channel.id(),
        pluralize(pair.recent.weeks.1 + 1 - pair.recent.weeks.0, "week"),
        describe_lead_costs(&pair.recent),
        describe_lead_costs(&before)
    );
    Some(ActionItem {
        problem: Problem::LeadCost(channel, group),
        text,
        proposal: Some(propose_removal(ads)),
        target: target_without_ads(situation, group, |other| other == channel),
        // Money at risk: the part of the cost that exceeds the cost at the earlier price per lead.
        at_risk: ads * RISK_DAYS * (1.0 - 1.0 / rise),
        is_urgent: false,
    })
}

/// Formats the cost per lead and the cost per first bill: `$372 a lead, $410 a first bill`.
fn describe_lead_costs(results: &AdResults) -> String {
    let dollars = |value: f64| if value < 100.0 { dollars_and_cents(value) } else { format_money(value) };
    let lead = match results.cost_per_lead() {
        Some(each) => format!("{} a lead", dollars(each)),
        None => format!("no lead for {}", format_money(results.spend)),
    };
    match (results.cost_per_bill(), results.first_bills) {
        (Some(each), _) => format!("{lead}, {} a first bill", dollars(each)),
        (None, Some(_)) => format!("{lead}, no first bill"),
        (None, None) => lead,
    }
}

/// Returns the advertising form with the current budgets. Removes the budgets of a group in those channels for which
/// `is_removed` returns true.
fn target_without_ads(
    situation: &DiagnosisContext<'_>,
    group: Group,
    is_removed: impl Fn(Channel) -> bool,
) -> ActionTarget {
    let mut spend = situation.session.settings().targeted_ads.targeted_spend.clone();
    for (_, groups) in spend.iter_mut().filter(|(channel, _)| is_removed(**channel)) {
        groups.entry(group).and_modify(|dollars| *dollars = 0.0);
    }
    let spend: Map<String, Value> = spend
        .iter()
        .map(|(channel, groups)| {
            let groups = groups.iter().map(|(group, dollars)| (group.id().to_owned(), json_number(*dollars)));
            (channel.id().to_owned(), Value::Object(groups.collect()))
        })
        .collect();
    ActionTarget::Call(ToolId::SetTargetedAdSpend, json!({ "targeted_spend": spend }))
}
