//! Diagnoses of sales: plans on offer, leads, and their conversion.

use serde_json::{Map, Value, json};

use super::{AHEAD, MONTH, Need, Place, Problem, Situation, rounded_up};
use crate::fit::TruthRange;
use crate::words::{count, money, whole};
use novamind_base::notation::{cents, json_number, percent};
use novamind_session::identifiers::{Channel, Group, Plan};
use novamind_session::{DeliveredQuality, Estimates, GroupWeek};
use novamind_tools::ToolId;

const ENOUGH_LEADS: u32 = 20;
const FEW: f64 = 0.1;
/// Share of the estimated usage that a quota must cover.
const COVERED: f64 = 0.8;
/// Age in days at which an estimate is old.
const OLD: u32 = 28;
/// Dollars a day for a first test of a channel.
const FIRST_TRY: f64 = 50.0;

/// Finds that no plan has a price, or that priced plans have a quota of 0.
pub(super) fn nothing_on_sale(situation: &Situation<'_>) -> Option<Need> {
    let core = &situation.settings;
    let priced: Vec<Plan> = Plan::ALL.into_iter().filter(|plan| core.prices[*plan] > 0.0).collect();
    if priced.is_empty() {
        return Some(no_price(situation));
    }
    let empty: Vec<&str> =
        priced.iter().filter(|plan| core.quotas[**plan].units() == 0.0).map(|plan| plan.id()).collect();
    if empty.is_empty() {
        return None;
    }
    let all = empty.len() == priced.len();
    let most = situation.individuals().map(|own| (own.account_range().1, own.group));
    let (use_a_day, group) = most.max_by(|left, right| left.0.total_cmp(&right.0))?;
    let quota = rounded_up(use_a_day);
    let arguments: Map<String, Value> = Plan::ALL
        .into_iter()
        .map(|plan| {
            let kept = core.quotas[plan].units();
            (plan.id().to_owned(), json_number(if empty.contains(&plan.id()) { quota } else { kept }))
        })
        .collect();
    let (plans, verb) = match empty.as_slice() {
        [one] => (format!("plan {one}"), "has"),
        more => (format!("plans {}", more.join(", ")), "have"),
    };
    let consequence =
        if all { "subscribers get nothing for their money" } else { "subscribers get nothing on it" };
    Some(Need {
        problem: Problem::NoQuota,
        text: format!("{plans} {verb} a price and a quota of 0 units a day: {consequence}"),
        proposal: Some(format!(
            "{} units a day cover {group}, which uses about {} (at most {})",
            whole(quota),
            whole(situation.estimate(group)?.usage),
            whole(use_a_day)
        )),
        place: Place::Call(ToolId::SetUsageQuotas, Value::Object(arguments)),
        at_risk: situation.commitments_ahead() + situation.revenue_ahead(),
        urgent: all,
    })
}

fn no_price(situation: &Situation<'_>) -> Need {
    let mut budgets: Vec<&Estimates> = situation.individuals().collect();
    budgets.sort_by(|left, right| left.budget.total_cmp(&right.budget));
    let half = |at: usize| budgets.get(at).map(|own| (own.budget.round() / 2.0).round().max(1.0));
    let prices: Map<String, Value> = Plan::ALL
        .into_iter()
        .enumerate()
        .filter_map(|(at, plan)| Some((plan.id().to_owned(), json_number(half(at)?))))
        .collect();
    // The form contains half of the displayed estimate, not of the middle of its range.
    let told: Vec<String> = budgets
        .iter()
        .map(|own| {
            let range = TruthRange::behind(own.budget, own.noise).money();
            format!("{} {range} (estimate {})", own.group, money(own.budget.round()))
        })
        .collect();
    Need {
        problem: Problem::NoPrice,
        text: "no plan has a price: no one can subscribe".to_owned(),
        proposal: Some(format!(
            "mean budgets a month: {}; the form proposes half of each estimate",
            told.join(", ")
        )),
        place: Place::Call(ToolId::SetPrices, Value::Object(prices)),
        at_risk: situation.commitments_ahead() + situation.revenue_ahead(),
        urgent: true,
    }
}

/// Finds that no channel is paid and no subscribers bring word of mouth.
pub(super) fn no_leads(situation: &Situation<'_>) -> Option<Need> {
    let came = situation.week().map_or(0, |week| week.new_individual_leads + week.new_enterprise_leads);
    let silent = situation.seen.subscribers + situation.seen.seats == 0;
    if situation.ads > 0.0 || came > 0 || !silent {
        return None;
    }
    // Groups are ranked by their fit with the current plans, then with the best model tier, then by budget.
    let group = situation.individuals().min_by(|left, right| {
        let now = |own: &Estimates| (own.floor - delivered_now(situation, own.group)).max(0.0);
        let missing = |own: &Estimates| (own.floor - within_reach(situation, own.group)).max(0.0);
        let reach = || missing(left).total_cmp(&missing(right));
        now(left).total_cmp(&now(right)).then_with(reach).then_with(|| right.budget.total_cmp(&left.budget))
    })?;
    let group = group.group;
    let each: Map<String, Value> = Channel::ALL
        .into_iter()
        .map(|channel| (channel.id().to_owned(), json!({ group.id(): FIRST_TRY })))
        .collect();
    let total = FIRST_TRY * Channel::ALL.len() as f64;
    Some(Need {
        problem: Problem::NoLeads,
        text: "no leads: no ads are running and there are no subscribers to spread the word".to_owned(),
        proposal: Some(format!(
            "{} a day per channel on {group} shows within a week which ones bring leads, for {} in ads",
            money(FIRST_TRY),
            money(7.0 * total)
        )),
        place: Place::Call(ToolId::SetTargetedAdSpend, json!({ "targeted_spend": each })),
        at_risk: situation.commitments_ahead(),
        urgent: true,
    })
}

/// Returns the highest quality that any plan delivers to a group today.
fn delivered_now(situation: &Situation<'_>, group: Group) -> f64 {
    let delivered = |quality: &DeliveredQuality| Plan::ALL.map(|plan| quality.by_plan[plan]);
    situation.quality(group).map_or(0.0, |quality| delivered(quality).into_iter().fold(0.0, f64::max))
}

/// Returns the quality that the best model tier would deliver to a group today.
fn within_reach(situation: &Situation<'_>, group: Group) -> f64 {
    let models = &situation.terms.models;
    let best = models.iter().map(|model| model.multiplier).fold(0.0, f64::max);
    let now = models.iter().find(|model| model.tier == situation.settings.tiers[Plan::A]);
    let delivered = situation.quality(group).map(|quality| quality.by_plan[Plan::A]);
    delivered.zip(now).map_or(0.0, |(delivered, now)| delivered / now.multiplier * best)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Missing {
    Price,
    Quota,
    Quality,
    /// Price, quota and quality each meet the estimates, but customers require more quality at this price.
    Balance,
}

/// Finds groups of individuals with leads that do not sign up.
pub(super) fn no_sales(situation: &Situation<'_>) -> Vec<Need> {
    let on_sale = Plan::ALL
        .into_iter()
        .any(|plan| situation.settings.prices[plan] > 0.0 && situation.settings.quotas[plan].units() != 0.0);
    let Some(week) = situation.group_week().filter(|_| on_sale) else { return Vec::new() };
    let few = |own: &&Estimates| {
        let figures = &week[own.group];
        figures.leads >= ENOUGH_LEADS && figures.conversion().is_some_and(|share| share < FEW)
    };
    situation.individuals().filter(few).filter_map(|own| no_sale(situation, own, &week[own.group])).collect()
}

fn no_sale(situation: &Situation<'_>, own: &Estimates, week: &GroupWeek) -> Option<Need> {
    let offers = Offers::to(situation, own)?;
    let missing = offers.missing();
    let signed = if week.signed == 0 { "none".to_owned() } else { whole(f64::from(week.signed)) };
    let share = percent(week.conversion()?, 1);
    let price = offers.lowest_price().min(own.budget);
    let at_risk = f64::from(week.leads - week.signed) * AHEAD / 7.0 * price;
    let (told, proposal, place) = offers.remedy(missing, at_risk)?;
    Some(Need {
        problem: Problem::NoSales(own.group),
        text: format!(
            "{}: {} last week, {signed} signed ({share}); {told}",
            own.group,
            count(week.leads, "lead")
        ),
        proposal: Some(proposal),
        place,
        at_risk,
        urgent: true,
    })
}

pub(super) struct Offers<'a> {
    situation: &'a Situation<'a>,
    own: &'a Estimates,
    quality: &'a DeliveredQuality,
}

impl<'a> Offers<'a> {
    /// Returns the offers to a group; `None` if no plan delivers to it.
    pub(super) fn to(situation: &'a Situation<'a>, own: &'a Estimates) -> Option<Offers<'a>> {
        Some(Offers { situation, own, quality: situation.quality(own.group)? })
    }

    fn plans(&self) -> impl Iterator<Item = Plan> + '_ {
        Plan::ALL.into_iter().filter(|plan| self.price(*plan) > 0.0)
    }

    fn price(&self, plan: Plan) -> f64 {
        self.situation.settings.prices[plan]
    }

    /// Returns the share of an account's estimated usage that the quota covers.
    fn covered(&self, plan: Plan) -> f64 {
        (self.situation.settings.quotas[plan].units() / self.own.account_usage().max(1e-9)).min(1.0)
    }

    fn lowest_price(&self) -> f64 {
        self.plans().map(|plan| self.price(plan)).fold(f64::INFINITY, f64::min)
    }

    fn affordable(&self) -> impl Iterator<Item = Plan> + '_ {
        // Enterprises negotiate their price.
        let negotiates = self.own.group.is_enterprise();
        self.plans().filter(move |plan| negotiates || self.price(*plan) <= self.own.budget)
    }

    /// Returns the affordable plan with the fewest deficits; among equals the one with the highest quality, ignoring
    /// its quota.
    fn best(&self) -> Option<Plan> {
        let quality = |plan: &Plan| self.quality.by_plan[*plan];
        let lacks =
            |plan: &Plan| u8::from(self.covered(*plan) < COVERED) + u8::from(quality(plan) < self.own.floor);
        // At equal quality, customers choose the cheaper plan.
        let price = |plan: &Plan| self.price(*plan);
        self.affordable().max_by(|left, right| {
            lacks(right)
                .cmp(&lacks(left))
                .then_with(|| quality(left).total_cmp(&quality(right)))
                .then_with(|| price(right).total_cmp(&price(left)))
        })
    }

    /// Describes the quality of the best plan. Also names a plan with higher quality whose quota does not cover the
    /// usage.
    fn best_in_words(&self, plan: Plan, delivered: f64) -> String {
        let quality = |plan: Plan| self.quality.by_plan[plan];
        // Screens show the range of the budget, but plans are compared by the point estimate.
        let scope = match self.own.group.is_enterprise() {
            true => String::new(),
            false => format!(" within their estimated budget of {}", money(self.own.budget.round())),
        };
        let more = self.affordable().max_by(|left, right| quality(*left).total_cmp(&quality(*right)));
        match more.filter(|more| quality(*more) > delivered) {
            None => format!("the best{scope} is {delivered:.4} on {plan}"),
            Some(more) => format!(
                "{delivered:.4} on {plan}; {more} delivers {:.4}{scope}, but its quota is too small for them",
                quality(more)
            ),
        }
    }

    pub(super) fn missing(&self) -> Missing {
        match self.best() {
            None => Missing::Price,
            Some(plan) if self.covered(plan) < COVERED => Missing::Quota,
            Some(plan) if self.quality.by_plan[plan] < self.own.floor => Missing::Quality,
            Some(_) => Missing::Balance,
        }
    }

    fn changed_today(&self) -> bool {
        let of_offers = [ToolId::SetPrices, ToolId::SetUsageQuotas, ToolId::SetModelTiers];
        self.situation.seen.changes.iter().any(|change| of_offers.contains(&change.setting.tool()))
    }

    /// Describes the deficit, a solution and its place. Proposes a new study first if the estimate is old.
    pub(super) fn remedy(&self, missing: Missing, at_risk: f64) -> Option<(String, String, Place)> {
        let (told, proposal, place) = self.remedy_of(missing, at_risk)?;
        match self.renewed(at_risk) {
            Some((study, place)) if matches!(missing, Missing::Quality | Missing::Balance) => {
                Some((told, study, place))
            }
            _ => Some((told, proposal, place)),
        }
    }

    /// Proposes a study that updates estimates older than four weeks, if it costs no more than is at risk. `None` if
    /// a study is already running.
    fn renewed(&self, at_risk: f64) -> Option<(String, Place)> {
        let (own, day) = (self.own, self.situation.seen.day);
        let is_studied = || {
            self.situation.session.company().running_studies().iter().any(|study| study.group == own.group)
        };
        if day < own.as_of + OLD || is_studied() {
            return None;
        }
        let terms = &self.situation.terms;
        let study = terms.level(own.level.max(terms.targets.0)).filter(|study| study.cost <= at_risk)?;
        let text = format!(
            "required quality rises as competitors improve, and the estimate is {} old: a level {} study updates it for {} in {}",
            count(day - own.as_of, "day"),
            study.level,
            money(study.cost),
            count(study.days, "day")
        );
        let arguments = json!({ "group_id": own.group.id(), "target_level": study.level });
        Some((text, Place::Call(ToolId::ResearchGroup, arguments)))
    }

    fn remedy_of(&self, missing: Missing, at_risk: f64) -> Option<(String, String, Place)> {
        let (own, group) = (self.own, self.own.group);
        let floor = TruthRange::behind(own.floor, own.noise).quality();
        let as_of = format!("as of day {}", own.as_of);
        match missing {
            Missing::Price => {
                let least = own.range(own.budget).0;
                let price = least.floor().max(1.0);
                let plan =
                    self.plans().min_by(|left, right| self.price(*left).total_cmp(&self.price(*right)))?;
                Some((
                    format!(
                        "price: the lowest is {} for {plan}, the mean budget {} ({as_of})",
                        money(self.price(plan)),
                        TruthRange::behind(own.budget, own.noise).money()
                    ),
                    format!("{} is below even the low end of that range", money(price)),
                    Place::Call(ToolId::SetPrices, json!({ plan.id(): json_number(price) })),
                ))
            }
            Missing::Quota => {
                let plan = self.best()?;
                let quota = rounded_up(own.account_range().1);
                let quotas: Map<String, Value> = Plan::ALL
                    .into_iter()
                    .map(|of| {
                        let held = self.situation.settings.quotas[of].units();
                        (of.id().to_owned(), json_number(if of == plan { quota } else { held }))
                    })
                    .collect();
                Some((
                    format!(
                        "quota: {} units a day on {plan}; mean usage{} is {}",
                        whole(self.situation.settings.quotas[plan].units()),
                        if group.is_enterprise() { " of the smallest enterprises" } else { "" },
                        TruthRange::from(own.account_range()).units()
                    ),
                    format!("{} units a day cover even the high end of that range", whole(quota)),
                    Place::Call(ToolId::SetUsageQuotas, Value::Object(quotas)),
                ))
            }
            Missing::Quality => {
                let plan = self.best()?;
                let delivered = self.quality.by_plan[plan];
                let told = format!(
                    "quality: {}; required on average: {floor} ({as_of})",
                    self.best_in_words(plan, delivered)
                );
                let (proposal, place) =
                    better_quality(self.situation, group, plan, (delivered, own.floor), at_risk)?;
                Some((told, proposal, place))
            }
            // Customers have not seen an offer that changed today, so last week's leads do not judge it.
            Missing::Balance if self.changed_today() => None,
            Missing::Balance => {
                let plan = self.best()?;
                let delivered = self.quality.by_plan[plan];
                let problem = format!(
                    "{plan} delivers {delivered:.4} for {}; they expect more at higher prices (mean at low prices: {floor}, {as_of})",
                    money(self.price(plan))
                );
                let remedy = "only a lower price or higher quality can win them";
                Some(match better_model(self.situation, group, plan, delivered, delivered) {
                    Some((model, place)) => (problem, format!("{remedy}: {model}"), place),
                    None => (problem, remedy.to_owned(), Place::Group(group)),
                })
            }
        }
    }
}

/// Returns the lowest higher model tier that delivers sufficient quality and whose compute the price covers.
fn better_model(
    situation: &Situation<'_>,
    group: Group,
    plan: Plan,
    delivered: f64,
    floor: f64,
) -> Option<(String, Place)> {
    let models = &situation.terms.models;
    let now = models.iter().find(|model| model.tier == situation.settings.tiers[plan])?;
    let product = delivered / now.multiplier;
    // Does not propose a model tier whose compute costs more than the plan earns. Enterprises negotiate their price.
    let used =
        situation.estimate(group)?.account_usage().min(situation.settings.quotas[plan].units()) * MONTH;
    let pays = |unit_cost: f64| group.is_enterprise() || used * unit_cost <= situation.settings.prices[plan];
    let better = models.iter().filter(|model| model.tier > now.tier && pays(model.unit_cost));
    let enough = better.into_iter().find(|model| product * model.multiplier >= floor)?;
    Some((
        format!(
            "model tier {} delivers {:.4} on {plan} at {} per 1,000 units rather than {}",
            enough.tier,
            product * enough.multiplier,
            cents(enough.unit_cost * 1_000.0),
            cents(now.unit_cost * 1_000.0)
        ),
        Place::Call(ToolId::SetModelTiers, json!({ plan.id(): enough.tier })),
    ))
}

/// Proposes a better model tier if one is sufficient and profitable, otherwise development for the group if it costs
/// no more than is at risk.
fn better_quality(
    situation: &Situation<'_>,
    group: Group,
    plan: Plan,
    (delivered, floor): (f64, f64),
    at_risk: f64,
) -> Option<(String, Place)> {
    if let Some(model) = better_model(situation, group, plan, delivered, floor) {
        return Some(model);
    }
    let now = situation.terms.models.iter().find(|model| model.tier == situation.settings.tiers[plan])?;
    const DOLLARS: f64 = 5_000.0;
    // A running project needs only time.
    let mut spend = situation.session.settings().targeted_development.targeted_spend.clone();
    if spend.get(&group).is_some_and(|spend| *spend >= DOLLARS) {
        return None;
    }
    let gain = situation.session.company().targeted_gain(DOLLARS) * now.multiplier;
    let days = ((floor - delivered) / gain).ceil();
    // Settings stay in force for at least a week.
    let cost = DOLLARS * days.max(7.0);
    let reached = format!(
        "development for {group} at {} a day reaches that quality in {}, for {} in total",
        money(DOLLARS),
        count(days as u32, "day"),
        money(cost)
    );
    let told = match cost > at_risk {
        true => {
            format!("{reached}: more than the {} lost in four weeks, but the effect lasts", money(at_risk))
        }
        false => reached,
    };
    spend.insert(group, DOLLARS);
    let spend: Map<String, Value> =
        spend.iter().map(|(group, dollars)| (group.id().to_owned(), json_number(*dollars))).collect();
    Some((told, Place::Call(ToolId::SetTargetedDevSpend, json!({ "targeted_spend": spend }))))
}
