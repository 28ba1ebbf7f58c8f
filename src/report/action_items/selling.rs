//! Diagnoses of sales: plans on offer, leads, and their conversion.

use std::cmp::Reverse;

use serde_json::{Map, Value, json};

use super::{
    ActionItem, ActionTarget, DAYS_PER_MONTH, DiagnosisContext, Problem, RISK_DAYS, round_up_to_two_digits,
};
use crate::fit::TrueValueRange;
use crate::formatting::{format_money, format_whole, pluralize};
use novamind_base::formatting::{dollars_and_cents, json_number, percent, quality as format_quality};
use novamind_session::identifiers::{Channel, Group, Plan};
use novamind_session::{DeliveredQuality, Estimates, GroupWeek};
use novamind_tools::ToolId;

const MIN_WEEKLY_LEADS: u32 = 20;
/// A group counts as a group without sales if its conversion is below this share.
pub(super) const MIN_CONVERSION: f64 = 0.1;
/// A quota is sufficient if it covers at least this share of the estimated usage.
const MIN_QUOTA_COVERAGE: f64 = 0.8;
/// An estimate is outdated if it is older than this number of days.
const OUTDATED_STUDY_DAYS: u32 = 28;
/// Proposed budget for testing a channel, dollars per day.
const TRIAL_AD_SPEND: f64 = 50.0;

/// Reports a problem if no plan has a price, or if plans with a price have a quota of 0.
pub(super) fn missing_offers(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let core = &situation.settings;
    let priced: Vec<Plan> = Plan::ALL.into_iter().filter(|plan| core.prices[*plan] > 0.0).collect();
    if priced.is_empty() {
        return Some(missing_price(situation));
    }
    let empty: Vec<&str> =
        priced.iter().filter(|plan| core.quotas[**plan].units() == 0.0).map(|plan| plan.id()).collect();
    if empty.is_empty() {
        return None;
    }
    let all = empty.len() == priced.len();
    let most = situation.individuals().map(|estimates| (estimates.account_usage_range().1, estimates.group));
    let (use_a_day, group) = most.max_by(|left, right| left.0.total_cmp(&right.0))?;
    let quota = round_up_to_two_digits(use_a_day);
    let arguments: Map<String, Value> = Plan::ALL
        .into_iter()
        .map(|plan| {
            let kept = core.quotas[plan].units();
            (plan.id().to_owned(), json_number(if empty.contains(&plan.id()) { quota } else { kept }))
        })
        .collect();
    let (plans, verb) = match empty.as_slice() {
        [one] => (format!("Plan {one}"), "has"),
        more => (format!("Plans {}", more.join(", ")), "have"),
    };
    let consequence = match (all, empty.len()) {
        (true, _) => "Subscribers get nothing for their money",
        (false, 1) => "Subscribers of this plan get nothing",
        (false, _) => "Subscribers of these plans get nothing",
    };
    Some(ActionItem {
        problem: Problem::NoQuota,
        text: format!("{plans} {verb} a price and a quota of 0 units a day. {consequence}."),
        proposal: Some(format!(
            "{} units a day cover {group}, which uses about {} (at most {}).",
            format_whole(quota),
            format_whole(situation.group_estimates(group)?.usage),
            format_whole(use_a_day)
        )),
        target: ActionTarget::Call(ToolId::SetUsageQuotas, Value::Object(arguments)),
        at_risk: situation.upcoming_costs() + situation.upcoming_revenue(),
        is_urgent: all,
    })
}

fn missing_price(situation: &DiagnosisContext<'_>) -> ActionItem {
    let mut budgets: Vec<&Estimates> = situation.individuals().collect();
    budgets.sort_by(|left, right| left.budget.total_cmp(&right.budget));
    let half = |at: usize| budgets.get(at).map(|estimates| (estimates.budget.round() / 2.0).round().max(1.0));
    let prices: Map<String, Value> = Plan::ALL
        .into_iter()
        .enumerate()
        .filter_map(|(at, plan)| Some((plan.id().to_owned(), json_number(half(at)?))))
        .collect();
    let halves: Vec<String> = prices.iter().map(|(plan, price)| format!("{plan} ${price}")).collect();
    // The form contains half of the estimate. The sentence states the estimate, because it differs from the middle of
    // the displayed range.
    let texts: Vec<String> = budgets
        .iter()
        .map(|estimates| {
            let range =
                TrueValueRange::from_estimate(estimates.budget, estimates.max_relative_error).format_money();
            format!("{} {range} (estimate {})", estimates.group, format_money(estimates.budget.round()))
        })
        .collect();
    ActionItem {
        problem: Problem::NoPrice,
        text: "No plan has a price. A plan without a price is free, so no one pays.".to_owned(),
        proposal: Some(format!(
            "Mean monthly budgets: {}. Half of each estimate: {}.",
            texts.join(", "),
            halves.join(", ")
        )),
        target: ActionTarget::Call(ToolId::SetPrices, Value::Object(prices)),
        at_risk: situation.upcoming_costs() + situation.upcoming_revenue(),
        is_urgent: true,
    }
}

/// Reports a problem if no ads are running and no subscribers spread the word.
pub(super) fn missing_leads(situation: &DiagnosisContext<'_>) -> Option<ActionItem> {
    let lead_count =
        situation.last_week().map_or(0, |week| week.new_individual_leads + week.new_enterprise_leads);
    let has_no_subscribers = situation.observation.subscribers + situation.observation.seats == 0;
    if situation.daily_ad_spend > 0.0 || lead_count > 0 || !has_no_subscribers {
        return None;
    }
    // Select the group with the smallest quality deficit on the current plans, then on the best model tier, then the
    // group with the highest budget.
    let group = situation.individuals().min_by(|left, right| {
        let now = |estimates: &Estimates| {
            (estimates.required_quality - best_delivered_quality(situation, estimates.group)).max(0.0)
        };
        let missing = |estimates: &Estimates| {
            (estimates.required_quality - best_possible_quality(situation, estimates.group)).max(0.0)
        };
        let reach = || missing(left).total_cmp(&missing(right));
        now(left).total_cmp(&now(right)).then_with(reach).then_with(|| right.budget.total_cmp(&left.budget))
    })?;
    let group = group.group;
    let each: Map<String, Value> = Channel::ALL
        .into_iter()
        .map(|channel| (channel.id().to_owned(), json!({ group.id(): TRIAL_AD_SPEND })))
        .collect();
    let total = TRIAL_AD_SPEND * Channel::ALL.len() as f64;
    Some(ActionItem {
        problem: Problem::NoLeads,
        text: "No leads arrive. No ads are running, and there are no subscribers to spread the word."
            .to_owned(),
        proposal: Some(format!(
            "{} a day per channel on {group} shows within a week which channels bring leads, for {} in ads.",
            format_money(TRIAL_AD_SPEND),
            format_money(7.0 * total)
        )),
        target: ActionTarget::Call(ToolId::SetTargetedAdSpend, json!({ "targeted_spend": each })),
        at_risk: situation.upcoming_costs(),
        is_urgent: true,
    })
}

/// Returns the highest quality that a plan delivers to a group today.
fn best_delivered_quality(situation: &DiagnosisContext<'_>, group: Group) -> f64 {
    let delivered = |quality: &DeliveredQuality| Plan::ALL.map(|plan| quality.by_plan[plan]);
    situation.group_quality(group).map_or(0.0, |quality| delivered(quality).into_iter().fold(0.0, f64::max))
}

/// Returns the quality that the best model tier would deliver to a group today.
fn best_possible_quality(situation: &DiagnosisContext<'_>, group: Group) -> f64 {
    let models = &situation.terms.models;
    let best = models.iter().map(|model| model.multiplier).fold(0.0, f64::max);
    let now = models.iter().find(|model| model.tier == situation.settings.tiers[Plan::A]);
    let delivered = situation.group_quality(group).map(|quality| quality.by_plan[Plan::A]);
    delivered.zip(now).map_or(0.0, |(delivered, now)| delivered / now.multiplier * best)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OfferDeficit {
    Price,
    Quota,
    Quality,
    /// Price, quota and quality each meet the estimates, but customers require a higher quality at this price.
    Balance,
}

/// Finds groups of individuals whose leads do not sign up.
pub(super) fn groups_without_sales(situation: &DiagnosisContext<'_>) -> Vec<ActionItem> {
    let on_sale = Plan::ALL
        .into_iter()
        .any(|plan| situation.settings.prices[plan] > 0.0 && situation.settings.quotas[plan].units() != 0.0);
    let Some(week) = situation.last_group_week().filter(|_| on_sale) else { return Vec::new() };
    let few = |estimates: &&Estimates| {
        let figures = &week[estimates.group];
        figures.leads >= MIN_WEEKLY_LEADS && figures.conversion().is_some_and(|share| share < MIN_CONVERSION)
    };
    situation
        .individuals()
        .filter(few)
        .filter_map(|estimates| group_without_sales(situation, estimates, &week[estimates.group]))
        .collect()
}

fn group_without_sales(
    situation: &DiagnosisContext<'_>,
    estimates: &Estimates,
    week: &GroupWeek,
) -> Option<ActionItem> {
    let offers = GroupOffers::new(situation, estimates)?;
    let missing = offers.main_deficit();
    let signed = if week.signed == 0 { "none".to_owned() } else { format_whole(f64::from(week.signed)) };
    let share = percent(week.conversion()?, 1);
    let price = offers.lowest_price().min(estimates.budget);
    let at_risk = f64::from(week.leads - week.signed) * RISK_DAYS / 7.0 * price;
    let (remedy, proposal, place) = offers.propose_remedy(missing, at_risk)?;
    Some(ActionItem {
        problem: Problem::NoSales(estimates.group),
        text: format!(
            "{}: {} last week, {signed} signed ({share}). {remedy}",
            estimates.group,
            pluralize(week.leads, "lead")
        ),
        proposal: Some(proposal),
        target: place,
        at_risk,
        is_urgent: true,
    })
}

pub(super) struct GroupOffers<'a> {
    situation: &'a DiagnosisContext<'a>,
    estimates: &'a Estimates,
    quality: &'a DeliveredQuality,
}

impl<'a> GroupOffers<'a> {
    /// Returns the plans as offers to a group, or `None` if the delivered quality is unknown for this group.
    pub(super) fn new(
        situation: &'a DiagnosisContext<'a>,
        estimates: &'a Estimates,
    ) -> Option<GroupOffers<'a>> {
        Some(GroupOffers { situation, estimates, quality: situation.group_quality(estimates.group)? })
    }

    fn plans(&self) -> impl Iterator<Item = Plan> + '_ {
        Plan::ALL.into_iter().filter(|plan| self.price(*plan) > 0.0)
    }

    fn price(&self, plan: Plan) -> f64 {
        self.situation.settings.prices[plan]
    }

    /// Returns the share of a customer's estimated usage that the quota of a plan covers, from 0 to 1.
    fn quota_coverage(&self, plan: Plan) -> f64 {
        (self.situation.settings.quotas[plan].units() / self.estimates.account_usage().max(1e-9)).min(1.0)
    }

    fn lowest_price(&self) -> f64 {
        self.plans().map(|plan| self.price(plan)).fold(f64::INFINITY, f64::min)
    }

    fn affordable_plans(&self) -> impl Iterator<Item = Plan> + '_ {
        // Enterprises negotiate their price, so they can afford every plan.
        let negotiates = self.estimates.group.is_enterprise();
        self.plans().filter(move |plan| negotiates || self.price(*plan) <= self.estimates.budget)
    }

    /// Returns the affordable plan with the fewest deficits. Among plans with equally few deficits, returns the plan
    /// with the highest delivered quality.
    fn best_plan(&self) -> Option<Plan> {
        let quality = |plan: &Plan| self.quality.by_plan[*plan];
        let lacks = |plan: &Plan| {
            u8::from(self.quota_coverage(*plan) < MIN_QUOTA_COVERAGE)
                + u8::from(quality(plan) < self.estimates.required_quality)
        };
        // Among plans of equal quality, customers choose the cheaper plan.
        let price = |plan: &Plan| self.price(*plan);
        self.affordable_plans().max_by(|left, right| {
            lacks(right)
                .cmp(&lacks(left))
                .then_with(|| quality(left).total_cmp(&quality(right)))
                .then_with(|| price(right).total_cmp(&price(left)))
        })
    }

    /// Returns the plan on sale that most of the group's new customers of the last week took, and how many took it.
    fn most_chosen_plan(&self) -> Option<(Plan, String)> {
        let week = &self.situation.last_group_week()?[self.estimates.group];
        // If two plans were taken equally often, the first plan is named.
        let plan = self.plans().max_by_key(|plan| (week.chosen[*plan], Reverse(plan.index())))?;
        let reason = match (week.chosen[plan], week.signed) {
            (0, _) => return None,
            (1, 1) => "which the new customer took".to_owned(),
            (chosen, signed) if chosen == signed => format!("which all {signed} new customers took"),
            (chosen, signed) => format!("which {chosen} of the {signed} new customers took"),
        };
        Some((plan, reason))
    }

    /// Describes the quality of the best plan. Also names the plan with higher quality whose quota does not cover the
    /// usage, if there is such a plan.
    fn describe_best_plan(&self, plan: Plan, delivered: f64) -> String {
        let quality = |plan: Plan| self.quality.by_plan[plan];
        // Screens show the range of the budget, but this comparison uses the estimate.
        let scope = match self.estimates.group.is_enterprise() {
            true => String::new(),
            false => {
                format!(" within the estimated budget of {}", format_money(self.estimates.budget.round()))
            }
        };
        let more = self.affordable_plans().max_by(|left, right| quality(*left).total_cmp(&quality(*right)));
        match more.filter(|more| quality(*more) > delivered) {
            None => format!("The best quality{scope} is {} on {plan}.", format_quality(delivered)),
            Some(more) => format!(
                "{plan} delivers quality {}. {more} delivers {}{scope}, but its quota is too small.",
                format_quality(delivered),
                format_quality(quality(more))
            ),
        }
    }

    pub(super) fn main_deficit(&self) -> OfferDeficit {
        match self.best_plan() {
            None => OfferDeficit::Price,
            Some(plan) if self.quota_coverage(plan) < MIN_QUOTA_COVERAGE => OfferDeficit::Quota,
            Some(plan) if self.quality.by_plan[plan] < self.estimates.required_quality => {
                OfferDeficit::Quality
            }
            Some(_) => OfferDeficit::Balance,
        }
    }

    fn was_changed_today(&self) -> bool {
        let offer_tools = [ToolId::SetPrices, ToolId::SetUsageQuotas, ToolId::SetModelTiers];
        self.situation.observation.changes.iter().any(|change| offer_tools.contains(&change.setting.tool()))
    }

    /// Returns the description of a deficit, a proposed solution, and the place where the player can apply it. If the
    /// estimate is outdated, proposes a new market study first.
    pub(super) fn propose_remedy(
        &self,
        missing: OfferDeficit,
        at_risk: f64,
    ) -> Option<(String, String, ActionTarget)> {
        let (text, proposal, place) = self.propose_direct_remedy(missing, at_risk)?;
        match self.propose_study(at_risk) {
            Some((study, place)) if matches!(missing, OfferDeficit::Quality | OfferDeficit::Balance) => {
                Some((text, study, place))
            }
            _ => Some((text, proposal, place)),
        }
    }

    /// Proposes a market study that updates estimates older than four weeks, if its cost exceeds neither the money at
    /// risk nor the cash. Returns `None` if a study is already running.
    fn propose_study(&self, at_risk: f64) -> Option<(String, ActionTarget)> {
        let (estimates, day) = (self.estimates, self.situation.observation.day);
        let is_studied = || {
            self.situation
                .session
                .company()
                .running_studies()
                .iter()
                .any(|study| study.group == estimates.group)
        };
        if day < estimates.as_of + OUTDATED_STUDY_DAYS || is_studied() {
            return None;
        }
        let terms = &self.situation.terms;
        let level = terms.study_level(estimates.level.max(terms.targets.0));
        let study = level.filter(|study| study.cost <= at_risk.min(self.situation.observation.cash))?;
        let text = format!(
            "The estimate is {} old, and required quality can have risen since then. A level {} study updates the estimate for {} in {}.",
            pluralize(day - estimates.as_of, "day"),
            study.level,
            format_money(study.cost),
            pluralize(study.days, "day")
        );
        let arguments = json!({ "group_id": estimates.group.id(), "target_level": study.level });
        Some((text, ActionTarget::Call(ToolId::ResearchGroup, arguments)))
    }

    fn propose_direct_remedy(
        &self,
        missing: OfferDeficit,
        at_risk: f64,
    ) -> Option<(String, String, ActionTarget)> {
        let (estimates, group) = (self.estimates, self.estimates.group);
        let floor = TrueValueRange::from_estimate(estimates.required_quality, estimates.max_relative_error)
            .format_quality();
        let as_of = format!("as of day {}", estimates.as_of);
        match missing {
            OfferDeficit::Price => {
                let least = estimates.true_range(estimates.budget).0;
                let price = least.floor().max(1.0);
                let plan =
                    self.plans().min_by(|left, right| self.price(*left).total_cmp(&self.price(*right)))?;
                Some((
                    format!(
                        "The lowest price is {} for {plan}. The mean budget is {} ({as_of}).",
                        format_money(self.price(plan)),
                        TrueValueRange::from_estimate(estimates.budget, estimates.max_relative_error)
                            .format_money()
                    ),
                    format!("A price of {} is below the whole budget range.", format_money(price)),
                    ActionTarget::Call(ToolId::SetPrices, json!({ plan.id(): json_number(price) })),
                ))
            }
            OfferDeficit::Quota => {
                let plan = self.best_plan()?;
                let quota = round_up_to_two_digits(estimates.account_usage_range().1);
                let quotas: Map<String, Value> = Plan::ALL
                    .into_iter()
                    .map(|of| {
                        let held = self.situation.settings.quotas[of].units();
                        (of.id().to_owned(), json_number(if of == plan { quota } else { held }))
                    })
                    .collect();
                Some((
                    format!(
                        "The quota of {plan} is {} units a day. Mean usage{} is {}.",
                        format_whole(self.situation.settings.quotas[plan].units()),
                        if group.is_enterprise() { " of the smallest enterprises" } else { "" },
                        TrueValueRange::from(estimates.account_usage_range()).format_units()
                    ),
                    format!("A quota of {} units a day covers the whole usage range.", format_whole(quota)),
                    ActionTarget::Call(ToolId::SetUsageQuotas, Value::Object(quotas)),
                ))
            }
            OfferDeficit::Quality => {
                let plan = self.best_plan()?;
                let delivered = self.quality.by_plan[plan];
                let text = format!(
                    "{} The mean required quality is {floor} ({as_of}).",
                    self.describe_best_plan(plan, delivered)
                );
                let (proposal, place) = propose_better_quality(
                    self.situation,
                    group,
                    plan,
                    (delivered, estimates.required_quality),
                    at_risk,
                )?;
                Some((text, proposal, place))
            }
            // The leads of the last week did not see an offer that changed today, so their decisions do not judge it.
            OfferDeficit::Balance if self.was_changed_today() => None,
            OfferDeficit::Balance => {
                let (plan, reason) = match self.most_chosen_plan() {
                    Some((plan, reason)) => (plan, reason),
                    None => (self.best_plan()?, "the plan that fits the estimates best".to_owned()),
                };
                let delivered = self.quality.by_plan[plan];
                let problem = format!(
                    "{plan}, {reason}, delivers quality {} for {}. Customers require more at higher prices (mean at low prices: {floor}, {as_of}).",
                    format_quality(delivered),
                    format_money(self.price(plan))
                );
                let remedy = "Only a lower price or higher quality can win these customers.";
                Some(match propose_better_model(self.situation, group, plan, delivered, delivered) {
                    Some((model, place)) => (problem, format!("{remedy} {model}"), place),
                    None => (problem, remedy.to_owned(), ActionTarget::Group(group)),
                })
            }
        }
    }
}

/// Proposes the lowest model tier above the current one that delivers sufficient quality at a compute cost that the
/// price covers.
fn propose_better_model(
    situation: &DiagnosisContext<'_>,
    group: Group,
    plan: Plan,
    delivered: f64,
    floor: f64,
) -> Option<(String, ActionTarget)> {
    let models = &situation.terms.models;
    let now = models.iter().find(|model| model.tier == situation.settings.tiers[plan])?;
    let product = delivered / now.multiplier;
    // A model tier is not proposed if its compute costs more than the plan earns. Enterprises are exempt, because they
    // negotiate their price.
    let used = situation.group_estimates(group)?.account_usage().min(situation.settings.quotas[plan].units())
        * DAYS_PER_MONTH;
    let pays = |unit_cost: f64| group.is_enterprise() || used * unit_cost <= situation.settings.prices[plan];
    let better = models.iter().filter(|model| model.tier > now.tier && pays(model.unit_cost));
    let enough = better.into_iter().find(|model| product * model.multiplier >= floor)?;
    Some((
        format!(
            "Model tier {} delivers {} on {plan} at {} per 1,000 units rather than {}.",
            enough.tier,
            format_quality(product * enough.multiplier),
            dollars_and_cents(enough.unit_cost * 1_000.0),
            dollars_and_cents(now.unit_cost * 1_000.0)
        ),
        ActionTarget::Call(ToolId::SetModelTiers, json!({ plan.id(): enough.tier })),
    ))
}

/// Proposes a better model tier if one is sufficient and profitable. Otherwise proposes development for the group and
/// states whether its cost exceeds the money at risk.
fn propose_better_quality(
    situation: &DiagnosisContext<'_>,
    group: Group,
    plan: Plan,
    (delivered, floor): (f64, f64),
    at_risk: f64,
) -> Option<(String, ActionTarget)> {
    if let Some(model) = propose_better_model(situation, group, plan, delivered, floor) {
        return Some(model);
    }
    let now = situation.terms.models.iter().find(|model| model.tier == situation.settings.tiers[plan])?;
    const PROPOSED_DEVELOPMENT_SPEND: f64 = 5_000.0;
    // If the group already receives this budget, the quality will rise without a change, so nothing is proposed.
    let mut spend = situation.session.settings().targeted_development.targeted_spend.clone();
    if spend.get(&group).is_some_and(|spend| *spend >= PROPOSED_DEVELOPMENT_SPEND) {
        return None;
    }
    let gain =
        situation.session.company().targeted_development_gain(PROPOSED_DEVELOPMENT_SPEND) * now.multiplier;
    let days = ((floor - delivered) / gain).ceil();
    // Settings stay in force for at least a week.
    let cost = PROPOSED_DEVELOPMENT_SPEND * days.max(7.0);
    let duration = pluralize(days as u32, "day");
    let price = match days < 7.0 {
        true => format!("{duration}. A week costs {}.", format_money(cost)),
        false => format!("{duration}, for {} in total.", format_money(cost)),
    };
    let range = TrueValueRange::from_estimate(floor, situation.group_estimates(group)?.max_relative_error);
    let reached = format!(
        "Development for {group} at {} a day would reach {}, the estimate of the mean required quality (true value {}), in {price}",
        format_money(PROPOSED_DEVELOPMENT_SPEND),
        format_quality(floor),
        range.format_quality()
    );
    // Development is proposed only if it costs less than a year of payments by the leads that it can win.
    let revenue = yearly_revenue_of_lost_leads(situation, group)?;
    if cost > revenue {
        let text = format!(
            "{reached} This is more than the {} that the leads of the last four weeks who did not {} would pay in a year, by estimate.",
            format_money(revenue),
            if group.is_enterprise() { "request an offer" } else { "sign up" }
        );
        return Some((text, ActionTarget::Group(group)));
    }
    let text = match cost > at_risk {
        true => format!(
            "{reached} The cost exceeds the {} at risk in four weeks, but the effect lasts.",
            format_money(at_risk)
        ),
        false => reached,
    };
    spend.insert(group, PROPOSED_DEVELOPMENT_SPEND);
    let spend: Map<String, Value> =
        spend.iter().map(|(group, dollars)| (group.id().to_owned(), json_number(*dollars))).collect();
    Some((text, ActionTarget::Call(ToolId::SetTargetedDevSpend, json!({ "targeted_spend": spend }))))
}

/// Returns the estimated payments in a year, dollars, of those leads of the last four weeks who did not sign up or, if
/// the group is an enterprise group, requested no offer. Individuals pay at most the lowest price; enterprises pay the
/// mean budget for the smallest number of seats.
fn yearly_revenue_of_lost_leads(situation: &DiagnosisContext<'_>, group: Group) -> Option<f64> {
    let estimates = situation.group_estimates(group)?;
    let recent = &situation.groups[situation.groups.len().saturating_sub(4)..];
    let lost = recent
        .iter()
        .map(|week| &week[group])
        .map(|week| week.leads.saturating_sub(if group.is_enterprise() { week.asked } else { week.signed }));
    let price = match group.is_enterprise() {
        true => estimates.budget * estimates.seats.0,
        false => GroupOffers::new(situation, estimates)?.lowest_price().min(estimates.budget),
    };
    Some(f64::from(lost.sum::<u32>()) * price * 12.0)
}
