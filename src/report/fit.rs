//! Fit: the plans compared with the estimated requirements of a group. An estimate is a range around the value from a
//! market study, so the figure of a plan is below, in or above this range. A deficit is reported only if it exists for
//! every value in the range.

use serde::Serialize;

use super::formatting::{format_range, format_whole};
use super::measured_conversion::{MEASURED_WEEKS, MeasuredConversion};
use novamind_base::formatting::{QUALITY_DECIMALS, dollars, dollars_and_cents, percent, price_to_cents};
use novamind_session::identifiers::{ByGroup, ByPlan, Group, Plan};
use novamind_session::{DeliveredQuality, Estimates, GroupWeek, Session, Settings, true_value_range};

/// The true values that are consistent with an estimate, from smallest to largest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrueValueRange {
    /// Smallest possible true value.
    pub least: f64,
    /// Largest possible true value.
    pub most: f64,
}

/// Position of a plan's figure relative to a range of true values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RangePosition {
    /// The figure is below the range.
    Below,
    /// The figure is in the range, so the true value can be above or below it.
    InRange,
    /// The figure is above the range.
    Above,
}

impl TrueValueRange {
    /// Returns the true values that are possible if the relative error of the estimate is at most `share`.
    pub fn from_estimate(estimate: f64, share: f64) -> TrueValueRange {
        true_value_range(estimate, share).into()
    }

    /// Compares a figure with the range, which includes both endpoints.
    pub fn position_of(&self, figure: f64) -> RangePosition {
        match figure {
            figure if figure < self.least => RangePosition::Below,
            figure if figure > self.most => RangePosition::Above,
            _ => RangePosition::InRange,
        }
    }

    /// Formats a range of qualities: `0.181 to 0.858`.
    pub fn format_quality(&self) -> String {
        format_range(self.least, self.most, QUALITY_DECIMALS)
    }

    /// Formats a range of dollars: `$18 to $87`.
    pub fn format_money(&self) -> String {
        format!("${}", format_range(self.least, self.most, 0).replace(" to ", " to $"))
    }

    /// Formats the range as whole numbers without a unit, for labels that already contain the unit: `180 to 841`.
    pub fn format_units(&self) -> String {
        format_range(self.least, self.most, 0)
    }
}

impl From<(f64, f64)> for TrueValueRange {
    fn from((least, most): (f64, f64)) -> TrueValueRange {
        TrueValueRange { least, most }
    }
}

/// A criterion by which a plan is compared with the requirements of a group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitCriterion {
    /// List price compared with the budget.
    Price,
    /// Delivered quality compared with the required quality.
    Quality,
    /// Quota compared with usage.
    Quota,
}

impl FitCriterion {
    /// All criteria, in the order of display.
    pub const ALL: [FitCriterion; 3] = [FitCriterion::Price, FitCriterion::Quality, FitCriterion::Quota];

    /// Returns the name of the criterion.
    pub fn name(self) -> &'static str {
        match self {
            FitCriterion::Price => "price",
            FitCriterion::Quality => "quality",
            FitCriterion::Quota => "quota",
        }
    }
}

/// Prices, quality and quota of a plan for one group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanFit {
    /// Plan that the other fields describe.
    pub plan: Plan,
    /// List price, dollars per month; 0 if the plan is not on sale.
    pub list_price: f64,
    /// List price less the discount for leads from all channels. Leads compare this price with their budget. For
    /// enterprises, it equals the list price, because they negotiate.
    pub lead_price: f64,
    /// List price less the current discount. Subscribers are billed this price.
    pub billed_price: f64,
    /// Quality that the plan delivers to the group.
    pub quality: f64,
    /// Quota of the plan, units per customer per day.
    pub quota: f64,
}

/// Number of leads and signups of a group over one or more weeks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LeadFlow {
    /// Total number of leads.
    pub leads: u32,
    /// Number of leads whom channels brought.
    pub channel_leads: u32,
    /// Number of leads whom word of mouth brought.
    pub word_of_mouth: u32,
    /// Number of enterprises that requested an offer.
    pub requests: u32,
    /// Number of individuals who signed up, or of enterprises that accepted their first deal.
    pub signups: u32,
}

/// The plans compared with the estimated requirements of a group.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Customer group whose requirements are compared with the plans.
    pub group: Group,
    /// Study level of the group, which determines the precision of the estimates.
    pub level: u8,
    /// Largest relative error of the estimates at this study level.
    pub max_relative_error: f64,
    /// Day for which required quality and budget are estimated.
    pub study_day: u32,
    /// Number of days since `study_day`.
    pub age_days: u32,
    /// Mean required quality of the group at low prices. Required quality rises with the price.
    pub floor: TrueValueRange,
    /// Mean budget, dollars per month; for enterprises, per seat.
    pub budget: TrueValueRange,
    /// Mean usage of an individual, or usage of the smallest enterprise; units per day.
    pub usage: TrueValueRange,
    /// Prices, quality and quota of every plan.
    pub plans: ByPlan<PlanFit>,
    /// Leads of the last week; `None` before the first week.
    pub last_week: Option<LeadFlow>,
    /// Leads of the last four weeks.
    pub recent: LeadFlow,
    /// Measured conversion of the last four weeks.
    pub measured: MeasuredConversion,
}

/// Returns the fit of every known group, in the fixed order of groups.
pub fn fits(session: &Session) -> Vec<Fit> {
    let (quality, weeks) = (session.company().delivered_quality(), session.company().group_weeks());
    let delivered = |group: Group| quality.iter().find(|delivered_quality| delivered_quality.group == group);
    let of = |estimates: &Estimates| Some(group_fit(session, estimates, delivered(estimates.group)?, weeks));
    session.company().estimates().iter().filter_map(of).collect()
}

fn group_fit(
    session: &Session,
    estimates: &Estimates,
    quality: &DeliveredQuality,
    weeks: &[ByGroup<GroupWeek>],
) -> Fit {
    let recent = &weeks[weeks.len().saturating_sub(MEASURED_WEEKS)..];
    let (settings, day) = (session.settings(), session.day());
    Fit {
        group: estimates.group,
        level: estimates.level,
        max_relative_error: estimates.max_relative_error,
        study_day: estimates.as_of,
        age_days: day.saturating_sub(estimates.as_of),
        floor: TrueValueRange::from_estimate(estimates.required_quality, estimates.max_relative_error),
        budget: TrueValueRange::from_estimate(estimates.budget, estimates.max_relative_error),
        usage: estimates.account_usage_range().into(),
        plans: ByPlan::from_fn(|plan| plan_fit(estimates.group, plan, quality.by_plan[plan], settings)),
        last_week: weeks.last().map(|week| LeadFlow::from_week(&week[estimates.group])),
        recent: LeadFlow::sum(recent.iter().map(|week| &week[estimates.group])),
        measured: MeasuredConversion::of_group(session, estimates.group),
    }
}

fn plan_fit(group: Group, plan: Plan, quality: f64, settings: &Settings) -> PlanFit {
    let list = settings.core.prices[plan];
    let less = |promotion: f64| (list - promotion.max(0.0)).max(0.0);
    let leads = if group.is_enterprise() { 0.0 } else { settings.lead_promotion.sum(group, None) };
    PlanFit {
        plan,
        list_price: list,
        lead_price: less(leads),
        // No customer has the number 0, so this sum excludes discounts for single customers.
        billed_price: less(settings.promotion.sum(0, group, plan)),
        quality,
        quota: settings.core.quotas[plan].units(),
    }
}

impl LeadFlow {
    /// Returns the leads and signups of a week.
    pub fn from_week(week: &GroupWeek) -> LeadFlow {
        LeadFlow {
            leads: week.leads,
            channel_leads: week.paid_leads(),
            word_of_mouth: week.word_of_mouth,
            requests: week.asked,
            signups: week.signed,
        }
    }

    /// Returns the leads and signups of several weeks.
    pub fn sum<'a>(weeks: impl IntoIterator<Item = &'a GroupWeek>) -> LeadFlow {
        weeks.into_iter().map(LeadFlow::from_week).fold(LeadFlow::default(), LeadFlow::add)
    }

    fn add(self, other: LeadFlow) -> LeadFlow {
        LeadFlow {
            leads: self.leads + other.leads,
            channel_leads: self.channel_leads + other.channel_leads,
            word_of_mouth: self.word_of_mouth + other.word_of_mouth,
            requests: self.requests + other.requests,
            signups: self.signups + other.signups,
        }
    }

    /// Returns signups divided by leads, or `None` if there are no leads.
    pub fn conversion(&self) -> Option<f64> {
        (self.leads > 0).then(|| f64::from(self.signups) / f64::from(self.leads))
    }

    /// Describes the leads and signups: `120 leads (80 paid, 40 by word of mouth), 12 signed (10.0%)`.
    pub fn describe(&self) -> String {
        if self.leads == 0 {
            let signed = if self.signups == 0 { String::new() } else { format!(", {} signed", self.signups) };
            return format!("no leads{signed}");
        }
        let share = self.conversion().map_or(String::new(), |share| format!(" ({})", percent(share, 1)));
        let number = |count: u32| format_whole(f64::from(count));
        format!(
            "{} ({} paid, {} by word of mouth), {} signed{share}",
            super::formatting::pluralize(self.leads, "lead"),
            number(self.channel_leads),
            number(self.word_of_mouth),
            number(self.signups)
        )
    }
}

impl Fit {
    /// Compares a plan with the group's requirements by one criterion. Returns `None` for the price of an enterprise
    /// group, because enterprises negotiate prices.
    pub fn position(&self, plan: Plan, criterion: FitCriterion) -> Option<RangePosition> {
        let plan_fit = &self.plans[plan];
        match criterion {
            FitCriterion::Price if self.group.is_enterprise() => None,
            FitCriterion::Price => Some(self.budget.position_of(plan_fit.lead_price)),
            FitCriterion::Quality => Some(self.floor.position_of(plan_fit.quality)),
            FitCriterion::Quota => Some(self.usage.position_of(plan_fit.quota)),
        }
    }

    /// Returns the smallest deficit that is consistent with the estimate, or `None` if there may be no deficit.
    pub fn certain_gap(&self, plan: Plan, criterion: FitCriterion) -> Option<f64> {
        let plan_fit = &self.plans[plan];
        match (criterion, self.position(plan, criterion)?) {
            (FitCriterion::Price, RangePosition::Above) => Some(plan_fit.lead_price - self.budget.most),
            (FitCriterion::Quality, RangePosition::Below) => Some(self.floor.least - plan_fit.quality),
            (FitCriterion::Quota, RangePosition::Below) => Some(self.usage.least - plan_fit.quota),
            _ => None,
        }
    }

    /// Returns the cheapest plan on sale that can suit an enterprise of the group: no deficit in quality is certain,
    /// and the quota covers `usage`, the estimated usage of all seats in units per day. If `usage` is `None`, the quota
    /// must cover the usage of the smallest enterprise.
    pub fn cheapest_suitable_plan(&self, usage: Option<f64>) -> Option<Plan> {
        let suits = |plan: &Plan| {
            let covers_usage = match usage {
                Some(usage) => self.plans[*plan].quota >= usage,
                None => self.certain_gap(*plan, FitCriterion::Quota).is_none(),
            };
            let is_on_sale = self.plans[*plan].list_price > 0.0;
            is_on_sale && covers_usage && self.certain_gap(*plan, FitCriterion::Quality).is_none()
        };
        let price = |plan: &Plan| self.plans[*plan].list_price;
        Plan::ALL.into_iter().filter(suits).min_by(|left, right| price(left).total_cmp(&price(right)))
    }

    /// Describes the deficits of a plan that are certain, and the criteria for which a deficit is possible.
    pub fn describe_gaps(&self, plan: Plan) -> String {
        let plan_fit = &self.plans[plan];
        if plan_fit.list_price <= 0.0 {
            return "has no price".to_owned();
        }
        let certain = |criterion: &FitCriterion| Some((*criterion, self.certain_gap(plan, *criterion)?));
        let missing: Vec<(FitCriterion, f64)> = FitCriterion::ALL.iter().filter_map(certain).collect();
        let is_uncertain =
            |criterion: &&FitCriterion| self.position(plan, **criterion) == Some(RangePosition::InRange);
        let open: Vec<&str> =
            FitCriterion::ALL.iter().filter(is_uncertain).map(|criterion| criterion.name()).collect();
        let open = if open.is_empty() {
            String::new()
        } else {
            format!("may not suit all customers: {}", open.join(", "))
        };
        match (missing.is_empty(), open.is_empty()) {
            (true, true) => "price, quality and quota suit the estimated mean customer".to_owned(),
            (true, false) => open,
            (false, true) => describe_certain_gaps(&missing),
            (false, false) => format!("{}; {open}", describe_certain_gaps(&missing)),
        }
    }

    /// Describes the day of the estimates and their age: `day 94 (12 days ago)`.
    pub fn describe_study_day(&self) -> String {
        let age = match self.age_days {
            0 => "today".to_owned(),
            1 => "1 day ago".to_owned(),
            days => format!("{days} days ago"),
        };
        format!("day {} ({age})", self.study_day)
    }

    /// Returns the comparison of all plans with the group's requirements as lines of text.
    pub fn describe_lines(&self) -> Vec<String> {
        let company = self.group.is_enterprise();
        let error = percent(self.max_relative_error, 0);
        let mut lines = vec![
            format!(
                "{}: study level {} (each estimate is within {error} of its true value), required quality and budget as of {}",
                self.group,
                self.level,
                self.describe_study_day()
            ),
            format!(
                "  quality  required {}; {}",
                self.floor.format_quality(),
                self.format_plans(|plan_fit| format!("{:.4}", plan_fit.quality))
            ),
            format!(
                "  price    budget {}{}; {}",
                self.budget.format_money(),
                if company { " a seat" } else { "" },
                self.format_plans(format_price)
            ),
            format!(
                "  quota    usage {} units a day{}; {}",
                self.usage.format_units(),
                if company { " of the smallest enterprise" } else { "" },
                self.format_plans(|fit| format_whole(fit.quota))
            ),
        ];
        match self.last_week {
            Some(week) => {
                lines.push(format!("  leads    last week {}", week.describe()));
                lines.push(format!("           last 4 weeks {}", self.recent.describe()));
            }
            None => lines.push("  leads    no week has run".to_owned()),
        }
        lines.extend(Plan::ALL.map(|plan| format!("  {plan}        {}", self.describe_gaps(plan))));
        lines
    }

    fn format_plans(&self, write: impl Fn(&PlanFit) -> String) -> String {
        let plans: Vec<String> =
            self.plans.iter().map(|plan_fit| format!("{} {}", plan_fit.plan, write(plan_fit))).collect();
        plans.join(", ")
    }
}

fn describe_certain_gaps(missing: &[(FitCriterion, f64)]) -> String {
    let (price, other_gaps): (Vec<_>, Vec<_>) =
        missing.iter().copied().partition(|(criterion, _)| *criterion == FitCriterion::Price);
    let mut parts: Vec<String> = price.into_iter().map(describe_gap).collect();
    if !other_gaps.is_empty() {
        let other_gaps: Vec<String> = other_gaps.into_iter().map(describe_gap).collect();
        parts.push(format!("lacks {}", other_gaps.join(", ")));
    }
    parts.join("; ")
}

fn describe_gap((criterion, amount): (FitCriterion, f64)) -> String {
    match criterion {
        FitCriterion::Price => format!(
            "price too high (by at least {})",
            if amount < 1.0 { dollars_and_cents(amount) } else { dollars(amount) }
        ),
        FitCriterion::Quality => format!("quality (at least {amount:.4})"),
        FitCriterion::Quota => format!("quota (at least {} units a day)", format_whole(amount.ceil())),
    }
}

fn format_price(plan_fit: &PlanFit) -> String {
    let list = price_to_cents(plan_fit.list_price);
    let mut less = Vec::new();
    if plan_fit.lead_price < plan_fit.list_price {
        less.push(format!("{} for leads", price_to_cents(plan_fit.lead_price)));
    }
    if plan_fit.billed_price < plan_fit.list_price {
        less.push(format!("{} billed", price_to_cents(plan_fit.billed_price)));
    }
    if less.is_empty() { list } else { format!("{list} ({})", less.join(", ")) }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::lead_costs::{WINDOW_WEEKS, lead_costs_by_pair};
    use crate::test_kit::play_weeks;
    use novamind_database::number_at;
    use novamind_record::trajectory::record::Via;

    fn query_number(session: &mut Session, sql: &str) -> f64 {
        number_at(&session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows[0], 0)
    }

    #[test]
    fn lead_flow_matches_the_tables() {
        let mut session = play_weeks(6);
        let (all, costs) = (fits(&session), lead_costs_by_pair(session.company().group_weeks()));
        let mut by_mouth = 0;
        for fit in &all {
            let week = fit.last_week.expect("a week has run");
            let of = |condition: &str| {
                format!(
                    "SELECT count(*) FROM customers WHERE group_id = '{}' AND created_day BETWEEN 36 AND 42 {condition}",
                    fit.group
                )
            };
            assert_eq!(f64::from(week.leads), query_number(&mut session, &of("")), "{}", fit.group);
            let network = query_number(&mut session, &of("AND acquisition_source = 'network'"));
            assert_eq!(f64::from(week.word_of_mouth), network, "{}", fit.group);
            assert_eq!(week.channel_leads + week.word_of_mouth, week.leads);
            by_mouth += week.word_of_mouth;
        }
        assert!(by_mouth > 0 && !costs.is_empty());
        for pair in &costs {
            let (channel, group) = (pair.channel.id(), pair.group);
            let from = 42 - 7 * WINDOW_WEEKS;
            let of = |what: &str| {
                format!(
                    "SELECT {what} FROM ad_channel_leads WHERE channel_id = '{channel}' AND group_id = '{group}' AND day > \
                     {from}"
                )
            };
            assert_eq!(f64::from(pair.recent.leads), query_number(&mut session, &of("sum(leads_generated)")));
            assert_eq!(pair.recent.spend, query_number(&mut session, &of("sum(spend)")));
            let bills = format!(
                "SELECT count(*) FROM customers c JOIN subscriptions s USING (customer_id) WHERE s.first_billing_done = 1 \
                 AND c.group_id = '{group}' AND c.acquisition_source = '{channel}' AND c.created_day > {from}"
            );
            assert_eq!(pair.recent.first_bills.map(f64::from), Some(query_number(&mut session, &bills)));
        }
    }

    #[test]
    fn certain_gap_exists_for_every_true_value_in_range() {
        let mut session = play_weeks(0);
        let quotas = json!({"A": 1, "B": 250_000, "C": 1_200_000});
        for (tool, arguments) in [
            ("set_prices", json!({"A": 12, "B": 25, "C": 900})),
            ("set_usage_quotas", quotas),
            ("set_lead_promotion", json!({"by_group": {"S1": 5}})),
        ] {
            session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
        }
        let all = fits(&session);
        let fit = &all[0];
        let [budget, usage, floor] = {
            let group_params = session.params().group(fit.group);
            [group_params.c_max_mean, group_params.usage_demand_mean, group_params.q_min_mean]
        };
        assert!(
            fit.budget.position_of(budget) == RangePosition::InRange
                && fit.floor.position_of(floor) == RangePosition::InRange
        );
        assert_eq!((fit.study_day, fit.age_days, fit.plans[Plan::A].lead_price), (0, 0, 7.0));
        let over = fit.certain_gap(Plan::C, FitCriterion::Price).expect("above every budget");
        assert!((over - (895.0 - fit.budget.most)).abs() < 1e-9 && over <= 895.0 - budget);
        let short = fit.certain_gap(Plan::A, FitCriterion::Quota).expect("a unit is too little");
        assert!(short <= usage - 1.0 && fit.certain_gap(Plan::B, FitCriterion::Quota).is_none());
        let quality = fit.plans[Plan::A].quality;
        if let Some(short) = fit.certain_gap(Plan::A, FitCriterion::Quality) {
            assert!(short <= floor - quality, "{short}");
        }
        assert!(fit.describe_gaps(Plan::A).contains("quota (at least "), "{}", fit.describe_gaps(Plan::A));
        assert!(
            fit.describe_gaps(Plan::C).contains("price too high (by at least $"),
            "{}",
            fit.describe_gaps(Plan::C)
        );
        let enterprise = all.iter().find(|fit| fit.group.is_enterprise()).expect("E1");
        assert_eq!(enterprise.position(Plan::C, FitCriterion::Price), None, "enterprises negotiate");
        let text = fit.describe_lines().join("\n");
        for words in [
            "required quality and budget as of day 0 (today)",
            "budget $",
            "$12 ($7 for leads)",
            "no week has run",
        ] {
            assert!(text.contains(words), "{words} in\n{text}");
        }
    }

    #[test]
    fn quality_and_required_quality_are_recorded_each_week() {
        let session = play_weeks(5);
        let now = session.company().delivered_quality();
        let (weeks, estimates) = (session.company().group_weeks(), session.company().estimates());
        for group_estimates in &estimates {
            let last = &weeks[weeks.len() - 1][group_estimates.group];
            let quality = now
                .iter()
                .find(|quality| quality.group == group_estimates.group)
                .map(|quality| quality.by_plan);
            assert_eq!(
                (last.quality, last.floor),
                (quality, Some(group_estimates.true_range(group_estimates.required_quality))),
                "{}",
                group_estimates.group
            );
        }
        let s1 = estimates[0].group;
        assert!(weeks[0][s1].quality != weeks[4][s1].quality, "development changes it");
        let unknown = Group::all()
            .find(|group| estimates.iter().all(|group_estimates| group_estimates.group != *group));
        assert_eq!(weeks[4][unknown.expect("unknown groups")].floor, None);
    }
}
