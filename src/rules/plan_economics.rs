//! Prices and costs of the plans: what an offer earns compared with the list price and the compute cost.

use std::collections::BTreeMap;

use super::seat_usage::SeatUsage;
use novamind_base::formatting::{dollars, dollars_and_cents, grouped_number, percent};
use novamind_session::Session;
use novamind_session::identifiers::{Group, Plan};

/// Number of days that estimates count as one month.
const DAYS_PER_MONTH: f64 = 30.0;

/// Lowest mean number of days since signing at which measured usage is preferred to a market study. The usage rate of
/// an enterprise is drawn at the deal and again at every bill, so newer seats show a single draw.
const MIN_MEASURED_DAYS: f64 = 30.0;

/// Prices, quotas and costs of the plans, and the usage per seat of each group.
#[derive(Debug, Clone, Default)]
pub struct PlanEconomics {
    /// List price of each plan, in dollars per seat per month.
    pub list_prices: [f64; 3],
    /// Quota of each plan, in units per customer per day.
    pub quotas: [f64; 3],
    /// Compute cost of each plan, in dollars per unit; 0 if the cost is unknown.
    pub unit_costs: [f64; 3],
    /// Usage per seat measured on the last day, by group.
    pub usage: SeatUsage,
    /// Study level of each group, and the usage that the last study estimated, in units per seat per day.
    pub estimated_usage: BTreeMap<Group, (u8, f64)>,
}

impl PlanEconomics {
    /// Returns the plans and the usage on the current day of a run.
    pub fn from_session(session: &Session, usage: SeatUsage) -> PlanEconomics {
        let (core, terms) = (&session.settings().core, session.company().tool_limits());
        let unit_cost = |plan: Plan| {
            let model = terms.models.iter().find(|model| model.tier == core.tiers[plan]);
            model.map_or(0.0, |model| model.unit_cost)
        };
        let estimates = session.company().estimates().into_iter();
        PlanEconomics {
            list_prices: Plan::ALL.map(|plan| core.prices[plan]),
            quotas: Plan::ALL.map(|plan| core.quotas[plan].units()),
            unit_costs: Plan::ALL.map(unit_cost),
            usage,
            estimated_usage: estimates.map(|study| (study.group, (study.level, study.usage))).collect(),
        }
    }

    /// Returns the usage of a group in units per seat per day, and the source of this figure. The source is the last
    /// day, or the market study if no enterprise of the group used the product or if the group's seats are new.
    pub fn usage_per_seat(&self, group: &str) -> Option<(f64, String)> {
        let study = Group::parse(group).and_then(|group| self.estimated_usage.get(&group).copied());
        let Some(measured) = self.usage.measured_usage(group) else {
            return study.map(|(level, units)| (units, format!("market study of {group}, level {level}")));
        };
        let days = measured.mean_days_since_signing();
        let is_new = days < MIN_MEASURED_DAYS;
        let age = format!("signed {} days ago on average", grouped_number(days, 0));
        // Without a study, the estimate of a group has a larger error than a single draw.
        if let Some((level, units)) = study.filter(|(level, _)| is_new && *level > 0) {
            return Some((units, format!("market study of {group}, level {level}; its seats {age}")));
        }
        let note = if is_new { format!(", new seats: {age}") } else { String::new() };
        Some((measured.units_per_seat(), format!("{group} on the last day{note}")))
    }

    /// Returns the expected usage of all seats of an enterprise, in units per day.
    pub fn required_usage(&self, group: &str, seats: u32) -> Option<f64> {
        self.usage_per_seat(group).map(|(units, _)| units * f64::from(seats))
    }

    /// Returns the revenue and the costs of one line of an offer to an enterprise. All seats share one quota.
    pub fn offer_line(&self, group: &str, seats: u32, (plan, price): (Plan, f64)) -> OfferLineEconomics {
        let at = plan as usize;
        let (list, quota, unit_cost) = (self.list_prices[at], self.quotas[at], self.unit_costs[at]);
        let usage = self.required_usage(group, seats);
        let compute = |units: f64| units.min(quota) * DAYS_PER_MONTH * unit_cost;
        OfferLineEconomics {
            plan,
            price,
            list_price: (list > 0.0).then_some(list),
            monthly_revenue: price * f64::from(seats),
            compute_cost: usage.filter(|_| unit_cost > 0.0).map(compute),
            quota_shortfall: usage.filter(|units| *units > quota).map(|units| (quota, units)),
        }
    }
}

/// Revenue and costs of one line of an offer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OfferLineEconomics {
    /// Offered plan.
    pub plan: Plan,
    /// Offered price, in dollars per seat per month.
    pub price: f64,
    /// List price of the plan, in dollars per seat per month; `None` if the plan has no price.
    pub list_price: Option<f64>,
    /// Payment of the enterprise, in dollars per month.
    pub monthly_revenue: f64,
    /// Estimated compute cost, in dollars per month; `None` if the usage of the group is unknown.
    pub compute_cost: Option<f64>,
    /// Quota of the plan and estimated usage in units per day, if the quota is lower than the usage.
    pub quota_shortfall: Option<(f64, f64)>,
}

impl OfferLineEconomics {
    /// Returns the estimated share of the payment that remains after compute.
    pub fn margin(&self) -> Option<f64> {
        self.compute_cost
            .filter(|_| self.monthly_revenue > 0.0)
            .map(|compute| 1.0 - compute / self.monthly_revenue)
    }

    /// Returns the price as a share of the list price.
    pub fn list_share(&self) -> Option<f64> {
        self.list_price.map(|list| self.price / list)
    }

    /// Describes the price compared with the list price and with the compute cost.
    pub fn describe(&self) -> String {
        let mut parts = vec![match (self.list_share(), self.list_price) {
            (Some(share), Some(list)) => {
                format!("{} of the list price {}", percent(share, 0), dollars_and_cents(list))
            }
            _ => "the plan has no list price".to_owned(),
        }];
        parts.push(format!("{} a month", dollars(self.monthly_revenue)));
        parts.push(match self.margin() {
            Some(margin) if margin < 0.0 => {
                format!("estimated margin after compute {}: a loss", percent(margin, 0))
            }
            Some(margin) => format!("estimated margin after compute {}", percent(margin, 0)),
            None => "margin unknown, because the usage of the group is unknown".to_owned(),
        });
        if let Some((quota, usage)) = self.quota_shortfall {
            let (units, covered) = (grouped_number(usage, 0), percent(quota / usage, 0));
            parts.push(format!("the quota covers {covered} of the estimated {units} units a day"));
        }
        format!("plan {} at {} per seat: {}", self.plan, dollars_and_cents(self.price), parts.join(", "))
    }
}

/// Totals over the offers and rejections that a user is about to send.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OfferTotals {
    /// Number of threads that receive a reply.
    pub thread_count: u32,
    /// Number of seats in the threads that receive a reply.
    pub seats: u32,
    /// Largest possible revenue from the offers, in dollars per month.
    pub monthly_revenue: f64,
    /// Revenue from the enterprises whose compute cost is known, and that compute cost, in dollars per month.
    revenue_and_compute: (f64, f64),
    /// Lowest and highest offered price as a share of the list price; `None` before the first offer with a list price.
    list_shares: Option<(f64, f64)>,
    /// Number of offers that include a plan whose quota does not cover the enterprise's usage.
    pub above_quota: u32,
    /// Number of offers that include a plan whose estimated compute cost exceeds the payment.
    pub at_loss: u32,
    /// Number of threads that receive no reply.
    pub skipped: u32,
}

impl OfferTotals {
    /// Returns the share of revenue that remains after compute cost, or `None` if no compute cost is known.
    pub fn margin(&self) -> Option<f64> {
        (self.revenue_and_compute.0 > 0.0)
            .then(|| 1.0 - self.revenue_and_compute.1 / self.revenue_and_compute.0)
    }

    /// Adds an enterprise that receives a reply.
    pub fn add_reply(&mut self, seats: u32) {
        self.thread_count += 1;
        self.seats += seats;
    }

    /// Adds an enterprise that receives an offer.
    pub fn add_offer(&mut self, lines: &[OfferLineEconomics], seats: u32) {
        self.add_reply(seats);
        let highest = lines.iter().max_by(|left, right| left.price.total_cmp(&right.price));
        let Some(highest) = highest else { return };
        self.monthly_revenue += highest.monthly_revenue;
        if let Some(compute) = highest.compute_cost {
            self.revenue_and_compute =
                (self.revenue_and_compute.0 + highest.monthly_revenue, self.revenue_and_compute.1 + compute);
        }
        let is_loss = |line: &OfferLineEconomics| line.margin().is_some_and(|margin| margin < 0.0);
        self.at_loss += u32::from(lines.iter().any(is_loss));
        self.above_quota += u32::from(lines.iter().any(|line| line.quota_shortfall.is_some()));
        for share in lines.iter().filter_map(OfferLineEconomics::list_share) {
            let (low, high) = self.list_shares.unwrap_or((share, share));
            self.list_shares = Some((low.min(share), high.max(share)));
        }
    }

    /// Describes the totals in one line. Rejections have no revenue.
    pub fn describe(&self, rejects: bool) -> String {
        let noun = if self.thread_count == 1 { "enterprise" } else { "enterprises" };
        let seats = if self.seats == 1 { "seat" } else { "seats" };
        let count = |value: u32| grouped_number(f64::from(value), 0);
        let mut words = format!("{} {noun}, {} {seats}", count(self.thread_count), count(self.seats));
        if self.thread_count > 0 && !rejects {
            words += &format!(", at most {} a month", dollars(self.monthly_revenue));
            if let Some((low, high)) = self.list_shares.map(|(low, high)| (percent(low, 0), percent(high, 0)))
            {
                let range = if low == high { low } else { format!("{low} to {high}") };
                words += &format!(", prices {range} of list");
            }
            words += &self
                .margin()
                .map_or(String::new(), |margin| format!(", margin after compute {}", percent(margin, 0)));
        }
        if self.at_loss > 0 {
            words += &format!(", {} at an estimated loss", count(self.at_loss));
        }
        if self.above_quota > 0 {
            words += &format!(", {} above the quota of an offered plan", count(self.above_quota));
        }
        if self.skipped > 0 {
            words += &format!(", {} skipped", count(self.skipped));
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::{Cell, QueryResult};

    fn economics() -> PlanEconomics {
        let row = |group: &str, seats: i64, units: i64| {
            let text = |text: &str| Cell::Text(text.to_owned());
            let cells = [1, seats, units, 0, 30 * seats].map(Cell::Integer);
            [text(group), text("B")].into_iter().chain(cells).collect::<Vec<_>>()
        };
        let rows = vec![row("E1", 50, 1000), row("S1", 10, 900), row("E1", 50, 3000)];
        let studied = Group::parse("E2").map(|group| (group, (1, 25.0)));
        PlanEconomics {
            list_prices: [14.0, 40.0, 0.0],
            quotas: [1e6, 1e6, 1_000.0],
            unit_costs: [0.001, 0.01, 0.1],
            usage: SeatUsage::from_rows(&QueryResult { rows, ..QueryResult::default() }),
            estimated_usage: studied.into_iter().collect(),
        }
    }

    #[test]
    fn usage_is_measured_otherwise_estimated() {
        let economics = economics();
        assert_eq!(economics.usage_per_seat("E1"), Some((40.0, "E1 on the last day".to_owned())));
        assert_eq!(economics.usage_per_seat("E2"), Some((25.0, "market study of E2, level 1".to_owned())));
        assert_eq!(economics.usage_per_seat("D_E01"), None);
    }

    #[test]
    fn study_is_preferred_while_measured_seats_are_new() {
        let mut economics = economics();
        let row = vec![Cell::Text("E1".to_owned()), Cell::Text("B".to_owned())];
        let cells = [1, 100, 3000, 0, 200].map(Cell::Integer);
        let rows = vec![row.into_iter().chain(cells).collect()];
        economics.usage = SeatUsage::from_rows(&QueryResult { rows, ..QueryResult::default() });
        let group = Group::parse("E1").expect("a group");
        let measured = "E1 on the last day, new seats: signed 2 days ago on average";
        for (study, units, source) in [
            (None, 30.0, measured),
            (Some((0, 90.0)), 30.0, measured),
            (Some((2, 65.0)), 65.0, "market study of E1, level 2; its seats signed 2 days ago on average"),
        ] {
            economics.estimated_usage = study.map(|study| (group, study)).into_iter().collect();
            assert_eq!(economics.usage_per_seat("E1"), Some((units, source.to_owned())));
        }
    }

    #[test]
    fn offer_line_compares_price_with_list_and_compute() {
        let economics = economics();
        let line = economics.offer_line("E1", 100, (Plan::B, 10.0));
        // 4,000 units a day, 30 days, $0.01.
        assert_eq!((line.monthly_revenue, line.compute_cost), (1_000.0, Some(1_200.0)));
        assert_eq!((line.list_share(), line.quota_shortfall), (Some(0.25), None));
        let text = line.describe();
        assert!(
            text.starts_with("plan B at $10.00 per seat: 25% of the list price $40.00, $1,000 a month"),
            "{text}"
        );
        assert!(text.ends_with("estimated margin after compute -20%: a loss"), "{text}");
        let capped = economics.offer_line("E1", 100, (Plan::C, 60.0));
        assert_eq!(capped.compute_cost, Some(1_000.0 * 30.0 * 0.1), "all seats share one quota");
        assert_eq!(capped.quota_shortfall, Some((1_000.0, 4_000.0)));
        assert!(capped.describe().contains("no list price"), "{}", capped.describe());
        let unknown = economics.offer_line("D_E01", 100, (Plan::B, 60.0));
        assert_eq!((unknown.margin(), unknown.quota_shortfall), (None, None));
        assert!(unknown.describe().contains("margin unknown"), "{}", unknown.describe());
    }

    #[test]
    fn totals_name_the_range_of_prices() {
        let (economics, mut totals) = (economics(), OfferTotals::default());
        for price in [10.0, 36.0] {
            totals.add_offer(&[economics.offer_line("E1", 100, (Plan::B, price))], 100);
        }
        let text = totals.describe(false);
        assert!(
            text.contains("at most $4,600 a month, prices 25% to 90% of list, margin after compute 48%, 1 at an estimated loss"),
            "{text}"
        );
        assert!(!totals.describe(true).contains("a month"));
    }
}
