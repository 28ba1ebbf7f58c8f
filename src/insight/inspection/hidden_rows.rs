//! The rows of the hidden tables, in the column order of `assets/hidden_tables.toml`.

use super::enterprise_thread_day::EnterpriseThreadDay;
use super::hidden_day::{GroupDayEnd, HiddenDay};
use novamind_database::HiddenValue;
use novamind_world::customers::columns::Subscriber;
use novamind_world::customers::traits::Negotiator;
use novamind_world::enterprise::{EnterpriseStatus, OfferResponse};
use novamind_world::identifiers::{Channel, Group, Plan};
use novamind_world::state::World;

use HiddenValue::{Integer, Null};

pub(crate) fn group_rows(day: u32, seen: &HiddenDay) -> Vec<[HiddenValue; 15]> {
    let rows = Group::all().map(|group| {
        let day_end: GroupDayEnd = seen.groups[group];
        let expectation = seen.market.drift.expectation(group);
        [
            day.into(),
            group.id().into(),
            day_end.info_level.into(),
            day_end.active.into(),
            day_end.reputation.into(),
            day_end.mean_satisfaction_and_relationship.map(|contribution| contribution.0).into(),
            day_end.mean_satisfaction_and_relationship.map(|contribution| contribution.1).into(),
            day_end.open_issues.into(),
            expectation.quality.into(),
            expectation.c_max.into(),
            day_end.product_quality.into(),
            seen.banks.group_banks[group].into(),
            day_end.willingness_to_pay.into(),
            day_end.deal_velocity.into(),
            day_end.seat_count.into(),
        ]
    });
    rows.collect()
}

pub(crate) fn drift_rows(day: u32, seen: &HiddenDay) -> Vec<[HiddenValue; 5]> {
    let drift = &seen.market.drift;
    let rows = Group::all().map(|group| {
        [
            day.into(),
            group.id().into(),
            drift.global_quality.into(),
            drift.quality[group].into(),
            drift.c_max[group].into(),
        ]
    });
    rows.collect()
}

/// Returns the rows of `hidden.factors` for a day, one for each discovered group.
pub(crate) fn factor_rows(day: u32, seen: &HiddenDay) -> Vec<[HiddenValue; 16]> {
    let rows = Group::all().filter(|group| seen.known_groups[*group]).map(|group| {
        let lead_factors = &seen.lead_factors[group];
        let paid = |channel: Channel| lead_factors.paid[channel].into();
        [
            day.into(),
            group.id().into(),
            lead_factors.reputation.into(),
            lead_factors.saturation.into(),
            lead_factors.calendar.into(),
            lead_factors.economy.into(),
            lead_factors.social.into(),
            lead_factors.surge.into(),
            paid(Channel::SocialMedia),
            paid(Channel::SearchAds),
            paid(Channel::Linkedin),
            paid(Channel::ContentMarketing),
            paid(Channel::ReferralProgram),
            lead_factors.network.into(),
            lead_factors.expected().into(),
            seen.arrived_leads[group].into(),
        ]
    });
    rows.collect()
}

pub(crate) fn competitor_row(day: u32, seen: &HiddenDay) -> [HiddenValue; 8] {
    let event = seen.market.event.as_ref().map(|(event, _)| event);
    [
        day.into(),
        seen.banks.shared.into(),
        seen.banks.group_banks.iter().sum::<f64>().into(),
        event.map(|event| event.boost).into(),
        event.map(|event| event.sampled).into(),
        event.map(|event| event.u).into(),
        event.map(|event| event.by_feedback).into(),
        seen.market.event.as_ref().map(|(_, severity)| *severity).into(),
    ]
}

pub(crate) fn pmi_row(day: u32, seen: &HiddenDay) -> [HiddenValue; 8] {
    let reading = seen.market.measured.as_ref().map(|(reading, _)| reading);
    [
        day.into(),
        seen.market.pmi.into(),
        reading.map(|reading| reading.measured_day).into(),
        reading.map(|reading| reading.value).into(),
        reading.map(|reading| reading.change).into(),
        reading.map(|reading| reading.trend.id()).into(),
        reading.map(|reading| reading.phase.id()).into(),
        seen.market.measured.as_ref().map(|(_, published)| *published).into(),
    ]
}

pub(crate) fn thread_row(thread_day: &EnterpriseThreadDay) -> [HiddenValue; 22] {
    let accepts = |plan: Plan| {
        let judged = thread_day.plans[plan];
        (!judged.accepts_any_price).then_some(judged.accepts_below).into()
    };
    let (answer, at, price) = match thread_day.answer {
        None => (Null, None, None),
        Some(OfferResponse::Accept(at)) => {
            ("accept".into(), Some(at), thread_day.offerings.get(at).map(|offering| offering.price))
        }
        Some(OfferResponse::Counter(at, price)) => ("counter".into(), Some(at), Some(price)),
        Some(OfferResponse::Silence) => ("silence".into(), None, None),
    };
    let plan = at.and_then(|at| thread_day.offerings.get(at)).map(|offering| offering.plan.id());
    [
        thread_day.day.into(),
        thread_day.thread.into(),
        thread_day.customer.into(),
        thread_day.group.id().into(),
        thread_day.kind.id().into(),
        thread_day.budget.into(),
        thread_day.remaining_turns.into(),
        thread_day.relationship.into(),
        thread_day.late_penalty.into(),
        thread_day.reply_day.into(),
        thread_day.plans[Plan::A].quality.into(),
        thread_day.plans[Plan::B].quality.into(),
        thread_day.plans[Plan::C].quality.into(),
        accepts(Plan::A),
        accepts(Plan::B),
        accepts(Plan::C),
        thread_day.plans[Plan::A].counter.into(),
        thread_day.plans[Plan::B].counter.into(),
        thread_day.plans[Plan::C].counter.into(),
        answer,
        plan.into(),
        price.into(),
    ]
}

/// Returns the rows of `hidden.customers`: subscribers first, then enterprises without a subscription.
pub(crate) fn customer_rows(world: &World) -> impl Iterator<Item = [HiddenValue; 32]> {
    let subscribers = world.customers.blocks().flat_map(move |(group, block)| {
        (0..block.len()).map(move |at| {
            let row = block.row(at);
            let company =
                group.is_enterprise().then(|| world.enterprise.enterprise_customer(row.customer)).flatten();
            customer_row(group, "subscriber", &row, company.map(|company| company.negotiator))
        })
    });
    let others = world.enterprise.companies.iter().filter_map(|company| {
        let (standing, row) = match &company.status {
            EnterpriseStatus::Lead(row) => ("lead", row),
            EnterpriseStatus::Lost(row) => ("gone", row),
            EnterpriseStatus::Subscriber => return None,
        };
        Some(customer_row(company.group, standing, row, Some(company.negotiator)))
    });
    subscribers.chain(others)
}

fn customer_row(
    group: Group,
    standing: &'static str,
    row: &Subscriber,
    negotiator: Option<Negotiator>,
) -> [HiddenValue; 32] {
    // The columns that are computed with `subscribed` are NULL for customers without a subscription.
    let is_subscriber = standing == "subscriber";
    let subscribed = |value: HiddenValue| if is_subscriber { value } else { Null };
    [
        row.customer.into(),
        group.id().into(),
        standing.into(),
        row.n.into(),
        row.subscription.into(),
        subscribed(row.plan.id().into()),
        subscribed(row.start_day.into()),
        subscribed(Integer(row.billing_day.into())),
        row.satisfaction.into(),
        row.relationship.into(),
        row.open_issue_days.into(),
        (row.issue > 0).then_some(row.issue).into(),
        row.steepness_left.into(),
        row.steepness_right.into(),
        row.c_max.into(),
        row.q_min.into(),
        row.q_max.into(),
        subscribed(row.required.into()),
        row.usage_demand.into(),
        row.usage_rate.into(),
        Integer(row.period_usage as i64),
        row.ads_quality_sensitivity.into(),
        row.ads_return_sensitivity.into(),
        row.seats.into(),
        subscribed(row.listed_price.into()),
        subscribed(row.promotion.into()),
        subscribed(row.effective_price.into()),
        subscribed(row.effective_c_max.into()),
        negotiator.map(|negotiator| negotiator.reply_delay_mean).into(),
        negotiator.map(|negotiator| negotiator.reply_delay_std).into(),
        negotiator.map(|negotiator| negotiator.initial_offer_factor).into(),
        negotiator.map(|negotiator| negotiator.max_negotiation_turns).into(),
    ]
}
