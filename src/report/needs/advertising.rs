//! Diagnoses of advertising: whether it brings enough for its cost.

use serde_json::{Map, Value, json};

use super::selling::{Missing, Offers};
use super::{AHEAD, Need, Place, Problem, Situation};
use crate::lead_costs::{AdSpell, PairCost, pair_costs};
use crate::words::{count, money};
use novamind_base::notation::{cents, json_number};
use novamind_session::identifiers::{Channel, Group};
use novamind_tools::ToolId;

/// Minimum number of enterprises in four weeks for a missing request to matter.
const ENOUGH_COMPANIES: u32 = 3;

/// Finds enterprise groups that are advertised to but request no offer.
pub(super) fn unwanted(situation: &Situation<'_>) -> Vec<Need> {
    let recent = &situation.groups[situation.groups.len().saturating_sub(4)..];
    let enterprises = situation.estimates.iter().filter(|own| own.group.is_enterprise());
    let paid = enterprises.filter(|own| situation.ads_by_group[own.group] > 0.0);
    let unwanted = paid.filter_map(|own| {
        let came: u32 = recent.iter().map(|week| week[own.group].leads).sum();
        let asked: u32 = recent.iter().map(|week| week[own.group].asked).sum();
        if came < ENOUGH_COMPANIES || asked > 0 {
            return None;
        }
        let offers = Offers::to(situation, own)?;
        let ads = situation.ads_by_group[own.group];
        let text = format!(
            "{}: {} arrived in {} and none requested an offer; ads for them cost {} a day",
            own.group,
            count(came, "enterprise"),
            count(recent.len() as u32, "week"),
            money(ads)
        );
        // The current offers are not known to be insufficient, so only the cost of advertising can be named.
        let (told, proposal, place) = match offers.missing() {
            missing @ (Missing::Quota | Missing::Quality) => {
                let (told, proposal, place) = offers.remedy(missing, ads * AHEAD)?;
                (format!("{text}; {told}"), Some(proposal), place)
            }
            Missing::Price | Missing::Balance => {
                let saved = format!("removing these ads saves {} a day", money(ads));
                (text, Some(saved), without_ads(situation, own.group, |_| true))
            }
        };
        Some(Need {
            problem: Problem::Unwanted(own.group),
            text: told,
            proposal,
            place,
            at_risk: ads * AHEAD,
            urgent: false,
        })
    });
    unwanted.collect()
}

/// Finds advertised pairs of channel and group whose cost per lead has risen strongly.
pub(super) fn lead_costs(situation: &Situation<'_>) -> Vec<Need> {
    pair_costs(situation.groups).iter().filter_map(|pair| dear_leads(situation, pair)).collect()
}

fn dear_leads(situation: &Situation<'_>, pair: &PairCost) -> Option<Need> {
    let (rise, before) = (pair.rise()?, pair.cheapest?);
    let (channel, group) = (pair.channel, pair.group);
    let ads = situation.session.settings().targeted_ads.spend(channel, group);
    if ads <= 0.0 {
        return None;
    }
    let (first, last) = before.weeks;
    let text = format!(
        "{} × {group}: in the last {} {}, in weeks {first} to {last} {}",
        channel.id(),
        count(pair.recent.weeks.1 + 1 - pair.recent.weeks.0, "week"),
        spell_in_words(&pair.recent),
        spell_in_words(&before)
    );
    Some(Need {
        problem: Problem::LeadCost(channel, group),
        text,
        proposal: Some(format!("removing these ads saves {} a day", money(ads))),
        place: without_ads(situation, group, |own| own == channel),
        // The additional cost of the same leads.
        at_risk: ads * AHEAD * (1.0 - 1.0 / rise),
        urgent: false,
    })
}

/// Describes costs per lead and first bill: `$372 a lead, $410 a first bill`.
fn spell_in_words(spell: &AdSpell) -> String {
    let dollars = |value: f64| if value < 100.0 { cents(value) } else { money(value) };
    let lead = match spell.per_lead() {
        Some(each) => format!("{} a lead", dollars(each)),
        None => format!("no lead for {}", money(spell.spend)),
    };
    match (spell.per_bill(), spell.billed) {
        (Some(each), _) => format!("{lead}, {} a first bill", dollars(each)),
        (None, Some(_)) => format!("{lead}, no first bill"),
        (None, None) => lead,
    }
}

/// Returns the advertising form without the budgets of a group in some channels.
fn without_ads(situation: &Situation<'_>, group: Group, of: impl Fn(Channel) -> bool) -> Place {
    let mut spend = situation.session.settings().targeted_ads.targeted_spend.clone();
    for (_, groups) in spend.iter_mut().filter(|(channel, _)| of(**channel)) {
        groups.entry(group).and_modify(|dollars| *dollars = 0.0);
    }
    let spend: Map<String, Value> = spend
        .iter()
        .map(|(channel, groups)| {
            let groups = groups.iter().map(|(group, dollars)| (group.id().to_owned(), json_number(*dollars)));
            (channel.id().to_owned(), Value::Object(groups.collect()))
        })
        .collect();
    Place::Call(ToolId::SetTargetedAdSpend, json!({ "targeted_spend": spend }))
}
