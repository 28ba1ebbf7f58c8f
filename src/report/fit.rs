//! Fit: a group's estimated requirements compared with the plans. Estimates are ranges around a study's figure, so a
//! plan's figure lies below, in or above the range. Deficits are stated only where the whole range shows them.

use serde::Serialize;

use super::words::{range, whole};
use novamind_base::notation::{cents, dollars, percent, price_to_cents};
use novamind_session::identifiers::{ByGroup, ByPlan, Group, Plan};
use novamind_session::{DeliveredQuality, Estimates, GroupWeek, Session, Settings, truth_behind};

/// Number of weeks in `recent`.
const RECENT: usize = 4;

/// Smallest and largest true value that an estimate allows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TruthRange {
    /// Smallest.
    pub least: f64,
    /// Largest.
    pub most: f64,
}

/// Position of a figure relative to the range of a true value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beside {
    /// Below the range.
    Below,
    /// In the range: the true value can be on either side.
    Inside,
    /// Above the range.
    Above,
}

impl TruthRange {
    /// Returns the range behind an estimate with a relative error of at most `share`.
    pub fn behind(estimate: f64, share: f64) -> TruthRange {
        truth_behind(estimate, share).into()
    }

    /// Compares a figure with the range; both ends count as inside.
    pub fn beside(&self, figure: f64) -> Beside {
        match figure {
            figure if figure < self.least => Beside::Below,
            figure if figure > self.most => Beside::Above,
            _ => Beside::Inside,
        }
    }

    /// Formats a range of qualities: `0.181 to 0.858`.
    pub fn quality(&self) -> String {
        range(self.least, self.most, 3)
    }

    /// Formats a range of dollars: `$18 to $87`.
    pub fn money(&self) -> String {
        format!("${}", range(self.least, self.most, 0).replace(" to ", " to $"))
    }

    /// Formats whole units, or dollars if the label has the unit: `180 to 841`.
    pub fn units(&self) -> String {
        range(self.least, self.most, 0)
    }
}

impl From<(f64, f64)> for TruthRange {
    fn from((least, most): (f64, f64)) -> TruthRange {
        TruthRange { least, most }
    }
}

/// An aspect in which a group compares a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Concern {
    /// List price compared with the budget.
    Price,
    /// Delivered quality compared with the required quality.
    Quality,
    /// Quota compared with usage.
    Quota,
}

impl Concern {
    /// All aspects, in the order of display.
    pub const ALL: [Concern; 3] = [Concern::Price, Concern::Quality, Concern::Quota];

    /// Returns the word for the aspect.
    pub fn id(self) -> &'static str {
        match self {
            Concern::Price => "price",
            Concern::Quality => "quality",
            Concern::Quota => "quota",
        }
    }
}

/// A plan as a group sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanFit {
    /// Plan.
    pub plan: Plan,
    /// List price, dollars a month; 0 if it is not on sale.
    pub list: f64,
    /// List price less the promotion for leads of all channels, which a lead compares with its budget.
    /// Enterprises negotiate their price.
    pub price: f64,
    /// List price less the promotion in force, which a subscriber is billed.
    pub billed: f64,
    /// Delivered quality.
    pub quality: f64,
    /// Quota, units a day and account.
    pub quota: f64,
}

/// Leads of a group and their outcome over some weeks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LeadFlow {
    /// All leads.
    pub leads: u32,
    /// Leads through channels.
    pub paid: u32,
    /// Leads by word of mouth.
    pub word_of_mouth: u32,
    /// Individuals who signed up, and enterprises that accepted their first deal.
    pub signed: u32,
}

/// Estimates of a group compared with the plans.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Group.
    pub group: Group,
    /// Study level.
    pub level: u8,
    /// Largest relative error of its estimates.
    pub noise: f64,
    /// Day of the estimates of required quality and budget.
    pub as_of: u32,
    /// Days since `as_of`.
    pub age: u32,
    /// Mean required quality of the group, before it rises with the price.
    pub floor: TruthRange,
    /// Mean budget, dollars a month; for enterprises, per seat.
    pub budget: TruthRange,
    /// Mean usage of a customer, units a day; for enterprises, of the smallest.
    pub usage: TruthRange,
    /// The plans.
    pub plans: ByPlan<PlanFit>,
    /// The last week; `None` before the first.
    pub last_week: Option<LeadFlow>,
    /// The last four weeks.
    pub recent: LeadFlow,
}

/// Returns the fit of every known group, in their fixed order.
pub fn fits(session: &Session) -> Vec<Fit> {
    let (quality, weeks) = (session.company().delivered_quality(), session.company().group_weeks());
    let delivered = |group: Group| quality.iter().find(|own| own.group == group);
    let of =
        |own: &Estimates| Some(fit(own, delivered(own.group)?, session.settings(), weeks, session.day()));
    session.company().estimates().iter().filter_map(of).collect()
}

fn fit(
    own: &Estimates,
    quality: &DeliveredQuality,
    settings: &Settings,
    weeks: &[ByGroup<GroupWeek>],
    day: u32,
) -> Fit {
    let recent = &weeks[weeks.len().saturating_sub(RECENT)..];
    Fit {
        group: own.group,
        level: own.level,
        noise: own.noise,
        as_of: own.as_of,
        age: day.saturating_sub(own.as_of),
        floor: TruthRange::behind(own.floor, own.noise),
        budget: TruthRange::behind(own.budget, own.noise),
        usage: own.account_range().into(),
        plans: ByPlan::from_fn(|plan| plan_fit(own.group, plan, quality.by_plan[plan], settings)),
        last_week: weeks.last().map(|week| LeadFlow::of(&week[own.group])),
        recent: recent
            .iter()
            .map(|week| LeadFlow::of(&week[own.group]))
            .fold(LeadFlow::default(), LeadFlow::plus),
    }
}

fn plan_fit(group: Group, plan: Plan, quality: f64, settings: &Settings) -> PlanFit {
    let list = settings.core.prices[plan];
    let less = |promotion: f64| (list - promotion.max(0.0)).max(0.0);
    let leads = if group.is_enterprise() { 0.0 } else { settings.lead_promotion.sum(group, None) };
    PlanFit {
        plan,
        list,
        price: less(leads),
        // No customer has the number 0, so settings of individual customers do not apply.
        billed: less(settings.promotion.sum(0, group, plan)),
        quality,
        quota: settings.core.quotas[plan].units(),
    }
}

impl LeadFlow {
    fn of(week: &GroupWeek) -> LeadFlow {
        LeadFlow {
            leads: week.leads,
            paid: week.paid_leads(),
            word_of_mouth: week.word_of_mouth,
            signed: week.signed,
        }
    }

    fn plus(self, other: LeadFlow) -> LeadFlow {
        LeadFlow {
            leads: self.leads + other.leads,
            paid: self.paid + other.paid,
            word_of_mouth: self.word_of_mouth + other.word_of_mouth,
            signed: self.signed + other.signed,
        }
    }

    /// Returns signups divided by leads; `None` without leads.
    pub fn conversion(&self) -> Option<f64> {
        (self.leads > 0).then(|| f64::from(self.signed) / f64::from(self.leads))
    }

    /// Describes the leads: `120 leads (80 paid, 40 by word of mouth), 12 signed (10.0%)`.
    pub fn in_words(&self) -> String {
        if self.leads == 0 {
            let signed = if self.signed == 0 { String::new() } else { format!(", {} signed", self.signed) };
            return format!("no leads{signed}");
        }
        let share = self.conversion().map_or(String::new(), |share| format!(" ({})", percent(share, 1)));
        let number = |count: u32| whole(f64::from(count));
        format!(
            "{} ({} paid, {} by word of mouth), {} signed{share}",
            super::words::count(self.leads, "lead"),
            number(self.paid),
            number(self.word_of_mouth),
            number(self.signed)
        )
    }
}

impl Fit {
    /// Compares a plan in one aspect. Returns `None` for the price of enterprises, which negotiate it.
    pub fn beside(&self, plan: Plan, concern: Concern) -> Option<Beside> {
        let own = &self.plans[plan];
        match concern {
            Concern::Price if self.group.is_enterprise() => None,
            Concern::Price => Some(self.budget.beside(own.price)),
            Concern::Quality => Some(self.floor.beside(own.quality)),
            Concern::Quota => Some(self.usage.beside(own.quota)),
        }
    }

    /// Returns the smallest deficit that the whole range allows; `None` if no deficit is certain.
    pub fn missing(&self, plan: Plan, concern: Concern) -> Option<f64> {
        let own = &self.plans[plan];
        match (concern, self.beside(plan, concern)?) {
            (Concern::Price, Beside::Above) => Some(own.price - self.budget.most),
            (Concern::Quality, Beside::Below) => Some(self.floor.least - own.quality),
            (Concern::Quota, Beside::Below) => Some(self.usage.least - own.quota),
            _ => None,
        }
    }

    /// Describes what a plan lacks, and the aspects that are uncertain.
    pub fn lacks(&self, plan: Plan) -> String {
        let own = &self.plans[plan];
        if own.list <= 0.0 {
            return "has no price".to_owned();
        }
        let certain = |concern: &Concern| Some((*concern, self.missing(plan, *concern)?));
        let missing: Vec<(Concern, f64)> = Concern::ALL.iter().filter_map(certain).collect();
        let inside = |concern: &&Concern| self.beside(plan, **concern) == Some(Beside::Inside);
        let open: Vec<&str> = Concern::ALL.iter().filter(inside).map(|concern| concern.id()).collect();
        let open = if open.is_empty() {
            String::new()
        } else {
            format!("may not suit all customers: {}", open.join(", "))
        };
        match (missing.is_empty(), open.is_empty()) {
            (true, true) => "meets the estimated needs".to_owned(),
            (true, false) => open,
            (false, true) => lacks_in_words(&missing),
            (false, false) => format!("{}; {open}", lacks_in_words(&missing)),
        }
    }

    /// Describes the day of the estimates and their age: `day 94 (12 days ago)`.
    pub fn studied(&self) -> String {
        let age = match self.age {
            0 => "today".to_owned(),
            1 => "1 day ago".to_owned(),
            days => format!("{days} days ago"),
        };
        format!("day {} ({age})", self.as_of)
    }

    /// Returns the full comparison as lines of text.
    pub fn lines(&self) -> Vec<String> {
        let company = self.group.is_enterprise();
        let error = percent(self.noise, 0);
        let mut lines = vec![
            format!(
                "{}: study level {} (±{error}), required quality and budget as of {}",
                self.group,
                self.level,
                self.studied()
            ),
            format!(
                "  quality  required {}; {}",
                self.floor.quality(),
                self.each(|own| format!("{:.4}", own.quality))
            ),
            format!(
                "  price    budget {}{}; {}",
                self.budget.money(),
                if company { " a seat" } else { "" },
                self.each(price_in_words)
            ),
            format!(
                "  quota    usage {} units a day{}; {}",
                self.usage.units(),
                if company { " of the smallest enterprise" } else { "" },
                self.each(|own| whole(own.quota))
            ),
        ];
        match self.last_week {
            Some(week) => {
                lines.push(format!("  leads    last week {}", week.in_words()));
                lines.push(format!("           last 4 weeks {}", self.recent.in_words()));
            }
            None => lines.push("  leads    no week has run".to_owned()),
        }
        lines.extend(Plan::ALL.map(|plan| format!("  {plan}        {}", self.lacks(plan))));
        lines
    }

    fn each(&self, write: impl Fn(&PlanFit) -> String) -> String {
        let plans: Vec<String> =
            self.plans.iter().map(|own| format!("{} {}", own.plan, write(own))).collect();
        plans.join(", ")
    }
}

fn lacks_in_words(missing: &[(Concern, f64)]) -> String {
    let (price, lacks): (Vec<_>, Vec<_>) =
        missing.iter().copied().partition(|(concern, _)| *concern == Concern::Price);
    let mut parts: Vec<String> = price.into_iter().map(lack_in_words).collect();
    if !lacks.is_empty() {
        let lacks: Vec<String> = lacks.into_iter().map(lack_in_words).collect();
        parts.push(format!("lacks {}", lacks.join(", ")));
    }
    parts.join("; ")
}

fn lack_in_words((concern, amount): (Concern, f64)) -> String {
    match concern {
        Concern::Price => format!(
            "price too high (by at least {})",
            if amount < 1.0 { cents(amount) } else { dollars(amount) }
        ),
        Concern::Quality => format!("quality (at least {amount:.4})"),
        Concern::Quota => format!("quota (at least {} units a day)", whole(amount.ceil())),
    }
}

fn price_in_words(own: &PlanFit) -> String {
    let list = price_to_cents(own.list);
    let mut less = Vec::new();
    if own.price < own.list {
        less.push(format!("{} for leads", price_to_cents(own.price)));
    }
    if own.billed < own.list {
        less.push(format!("{} billed", price_to_cents(own.billed)));
    }
    if less.is_empty() { list } else { format!("{list} ({})", less.join(", ")) }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::lead_costs::{SPELL, pair_costs};
    use crate::test_kit::played;
    use novamind_database::number_at;
    use novamind_record::trajectory::record::Via;

    fn number(session: &mut Session, sql: &str) -> f64 {
        number_at(&session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows[0], 0)
    }

    #[test]
    fn leads_are_split_and_priced_as_the_tables_have_them() {
        let mut session = played(6);
        let (all, costs) = (fits(&session), pair_costs(session.company().group_weeks()));
        let mut by_mouth = 0;
        for fit in &all {
            let week = fit.last_week.expect("a week has run");
            let of = |condition: &str| {
                format!(
                    "SELECT count(*) FROM customers WHERE group_id = '{}' AND created_day BETWEEN 36 AND 42 {condition}",
                    fit.group
                )
            };
            assert_eq!(f64::from(week.leads), number(&mut session, &of("")), "{}", fit.group);
            let network = number(&mut session, &of("AND acquisition_source = 'network'"));
            assert_eq!(f64::from(week.word_of_mouth), network, "{}", fit.group);
            assert_eq!(week.paid + week.word_of_mouth, week.leads);
            by_mouth += week.word_of_mouth;
        }
        assert!(by_mouth > 0 && !costs.is_empty());
        for pair in &costs {
            let (channel, group) = (pair.channel.id(), pair.group);
            let from = 42 - 7 * SPELL;
            let of = |what: &str| {
                format!(
                    "SELECT {what} FROM ad_channel_leads WHERE channel_id = '{channel}' AND group_id = '{group}' AND day > \
                     {from}"
                )
            };
            assert_eq!(f64::from(pair.recent.leads), number(&mut session, &of("sum(leads_generated)")));
            assert_eq!(pair.recent.spend, number(&mut session, &of("sum(spend)")));
            let bills = format!(
                "SELECT count(*) FROM customers c JOIN subscriptions s USING (customer_id) WHERE s.first_billing_done = 1 \
                 AND c.group_id = '{group}' AND c.acquisition_source = '{channel}' AND c.created_day > {from}"
            );
            assert_eq!(pair.recent.billed.map(f64::from), Some(number(&mut session, &bills)));
        }
    }

    #[test]
    fn what_is_missing_holds_for_every_truth_in_the_range() {
        let mut session = played(0);
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
            let own = session.params().group(fit.group);
            [own.c_max_mean, own.usage_demand_mean, own.q_min_mean]
        };
        assert!(fit.budget.beside(budget) == Beside::Inside && fit.floor.beside(floor) == Beside::Inside);
        assert_eq!((fit.as_of, fit.age, fit.plans[Plan::A].price), (0, 0, 7.0));
        let over = fit.missing(Plan::C, Concern::Price).expect("above every budget");
        assert!((over - (895.0 - fit.budget.most)).abs() < 1e-9 && over <= 895.0 - budget);
        let short = fit.missing(Plan::A, Concern::Quota).expect("a unit is too little");
        assert!(short <= usage - 1.0 && fit.missing(Plan::B, Concern::Quota).is_none());
        let quality = fit.plans[Plan::A].quality;
        if let Some(short) = fit.missing(Plan::A, Concern::Quality) {
            assert!(short <= floor - quality, "{short}");
        }
        assert!(fit.lacks(Plan::A).contains("quota (at least "), "{}", fit.lacks(Plan::A));
        assert!(fit.lacks(Plan::C).contains("price too high (by at least $"), "{}", fit.lacks(Plan::C));
        let enterprise = all.iter().find(|fit| fit.group.is_enterprise()).expect("E1");
        assert_eq!(enterprise.beside(Plan::C, Concern::Price), None, "enterprises negotiate");
        let text = fit.lines().join("\n");
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
    fn quality_and_floor_are_kept_week_by_week() {
        let session = played(5);
        let now = session.company().delivered_quality();
        let (weeks, estimates) = (session.company().group_weeks(), session.company().estimates());
        for own in &estimates {
            let last = &weeks[weeks.len() - 1][own.group];
            let quality =
                now.iter().find(|quality| quality.group == own.group).map(|quality| quality.by_plan);
            assert_eq!((last.quality, last.floor), (quality, Some(own.range(own.floor))), "{}", own.group);
        }
        let s1 = estimates[0].group;
        assert!(weeks[0][s1].quality != weeks[4][s1].quality, "development changes it");
        let unknown = Group::all().find(|group| estimates.iter().all(|own| own.group != *group));
        assert_eq!(weeks[4][unknown.expect("unknown groups")].floor, None);
    }
}
