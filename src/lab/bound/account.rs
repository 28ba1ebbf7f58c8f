//! Computes every line of the account from the plan and the parameters.

use super::climate::{Climate, climate};
use super::premises::Premises;
use super::published::AccountLine;
use super::requirement::overload_penalty;
use super::{customers, improving, knowing, renewals, running, targeted, winning};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// A group in the account.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundGroup {
    /// Group.
    pub group: &'static str,
    /// Customers, or seats of enterprises.
    pub customers: f64,
    /// Price, dollars a month.
    pub price: f64,
    /// Widest quality gap that targeted development must close.
    pub gap: f64,
    /// Spending that closes the gap exactly, before slack, dollars a day.
    pub least_spending: f64,
    /// Spending with slack, dollars a day.
    pub spending: f64,
    /// Share of customers who renew, by renewal day.
    pub renewing: Vec<f64>,
    /// Revenue over all renewals, dollars.
    pub revenue: f64,
}

/// A line of the account and its figures.
#[derive(Debug, Clone, PartialEq)]
pub struct Figured {
    /// Line.
    pub line: AccountLine,
    /// Computed figure, dollars.
    pub own: f64,
    /// Published figure, dollars.
    pub published: f64,
    /// Explanation of the difference.
    pub why: String,
}

/// The complete account.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundAccount {
    /// Premises.
    pub premises: Premises,
    /// Whether the parameters have competitors.
    pub has_rivals: bool,
    /// Usage of all customers, units a day.
    pub daily_usage: f64,
    /// Quality lost to overload.
    pub overload: f64,
    /// Groups.
    pub groups: Vec<BoundGroup>,
    /// Lines in order.
    pub lines: Vec<Figured>,
}

/// A row of the sensitivity to slack.
#[derive(Debug, Clone, PartialEq)]
pub struct SlackRow {
    /// Slack.
    pub slack: f64,
    /// Targeted development, dollars.
    pub targeted: f64,
    /// Renewals of groups at which more than 99 % are satisfied.
    pub satisfied: usize,
    /// Renewals of groups.
    pub renewals: usize,
    /// Mean renewal share over groups and days.
    pub mean_share: f64,
    /// Reported estimate, dollars.
    pub estimate: f64,
}

/// Share above which nearly all customers of a group are satisfied.
pub const NEARLY_ALL: f64 = 0.99;

impl BoundAccount {
    /// Returns the account of a plan.
    pub fn of(premises: Premises, params: &Params) -> BoundAccount {
        let climate = climate(&premises, params);
        BoundAccount::under(premises, &climate, params)
    }

    /// Returns the account of a plan under given market conditions.
    fn under(premises: Premises, climate: &Climate, params: &Params) -> BoundAccount {
        let daily_usage = customers::daily_usage(params);
        let overload = overload_penalty(daily_usage, premises.capacity_tier, params);
        let groups: Vec<BoundGroup> =
            Group::all().map(|group| account_of(group, overload, climate, &premises, params)).collect();
        let has_rivals = !params.competitor.competitor_events_disabled;
        let mut account =
            BoundAccount { premises, has_rivals, daily_usage, overload, groups, lines: Vec::new() };
        account.lines = account.figured(params);
        account
    }

    fn figured(&self, params: &Params) -> Vec<Figured> {
        let line = |line: AccountLine| {
            let own = self.dollars(line, params);
            Figured { line, own, published: 1e6 * line.published(), why: self.why(line, own, params) }
        };
        AccountLine::ALL.into_iter().map(line).collect()
    }

    fn dollars(&self, line: AccountLine, params: &Params) -> f64 {
        let premises = &self.premises;
        match line {
            AccountLine::Individuals => self.revenue_of(false),
            AccountLine::Companies => self.revenue_of(true),
            AccountLine::Revenue => self.revenue_of(false) + self.revenue_of(true),
            AccountLine::Compute => running::compute(self.daily_usage, premises, params),
            AccountLine::Capacity => running::capacity(premises, params),
            AccountLine::GlobalDevelopment => improving::global_development(premises),
            AccountLine::TargetedDevelopment => self.targeted(),
            AccountLine::Research => improving::research(premises, params),
            AccountLine::Advertising => {
                Group::all().map(|group| winning::advertising(group, premises, params)).sum()
            }
            AccountLine::LeadCosts => winning::lead_costs(params),
            AccountLine::Operations => running::operations(self.customers(), premises),
            AccountLine::MarketResearch => knowing::market_research(params),
            AccountLine::GroupResearch => knowing::group_research(premises, params),
            AccountLine::Costs => AccountLine::COSTS.into_iter().map(|cost| self.dollars(cost, params)).sum(),
            AccountLine::Subtotal => {
                params.initial.initial_cash + self.dollars(AccountLine::Revenue, params)
                    - self.dollars(AccountLine::Costs, params)
            }
            AccountLine::Estimate => premises.reported_share * self.dollars(AccountLine::Subtotal, params),
        }
    }

    /// Returns the revenue from enterprises or individuals, dollars.
    pub(super) fn revenue_of(&self, of_companies: bool) -> f64 {
        let own = self
            .groups
            .iter()
            .filter(|own| Group::parse(own.group).is_some_and(|group| group.is_enterprise() == of_companies));
        own.map(|own| own.revenue).sum()
    }

    fn targeted(&self) -> f64 {
        f64::from(self.premises.days) * self.groups.iter().map(|own| own.spending).sum::<f64>()
    }

    /// Returns the number of paying customers and seats.
    pub fn customers(&self) -> f64 {
        self.groups.iter().map(|own| own.customers).sum()
    }

    /// Computes the figure of a line, dollars.
    pub fn of_line(&self, line: AccountLine) -> f64 {
        self.lines.iter().find(|own| own.line == line).map_or(0.0, |own| own.own)
    }

    fn slack_row(&self) -> SlackRow {
        let shares = || self.groups.iter().flat_map(|own| own.renewing.iter().copied());
        let renewals = shares().count();
        SlackRow {
            slack: self.premises.slack,
            targeted: self.targeted(),
            satisfied: shares().filter(|share| *share > NEARLY_ALL).count(),
            renewals,
            mean_share: shares().sum::<f64>() / renewals.max(1) as f64,
            estimate: self.of_line(AccountLine::Estimate),
        }
    }
}

/// Returns a row for each slack.
pub fn sensitivity(slacks: &[f64], params: &Params) -> Vec<SlackRow> {
    let premises = |slack: &f64| Premises::of_the_paper(*slack);
    let Some(first) = slacks.first() else { return Vec::new() };
    // Slack does not change market conditions: competitors copy in proportion to a targeted gain.
    let climate = climate(&premises(first), params);
    slacks.iter().map(|slack| BoundAccount::under(premises(slack), &climate, params).slack_row()).collect()
}

fn account_of(
    group: Group,
    overload: f64,
    climate: &Climate,
    premises: &Premises,
    params: &Params,
) -> BoundGroup {
    let gap = targeted::widest_gap(group, overload, climate, premises, params);
    let least_spending = targeted::least_spending(gap, premises, params);
    let spending = premises.slack * least_spending;
    let renewing = renewals::renewing(group, spending, overload, climate, premises, params);
    BoundGroup {
        group: group.id(),
        customers: customers::attainable(group, params),
        price: customers::highest_price(group, params),
        gap,
        least_spending,
        spending,
        revenue: customers::full_bill(group, params) * renewing.iter().sum::<f64>(),
        renewing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn account(slack: f64) -> BoundAccount {
        BoundAccount::of(Premises::of_the_paper(slack), &Params::shipped())
    }

    #[test]
    fn lines_that_are_products_of_parameters_are_the_published_ones() {
        let own = account(3.0);
        for line in [
            AccountLine::Capacity,
            AccountLine::GlobalDevelopment,
            AccountLine::Research,
            AccountLine::Operations,
        ] {
            let off = own.of_line(line) / 1e6 - line.published();
            assert!(off.abs() <= line.rounding(), "{}: {off}", line.name());
        }
    }

    #[test]
    fn sums_are_within_three_percent_of_the_published_ones() {
        let own = account(3.0);
        for line in [AccountLine::Revenue, AccountLine::Costs, AccountLine::Subtotal, AccountLine::Estimate] {
            let ratio = own.of_line(line) / 1e6 / line.published();
            assert!((ratio - 1.0).abs() < 0.03, "{}: {ratio}", line.name());
        }
        let targeted = AccountLine::TargetedDevelopment;
        let ratio = own.of_line(targeted) / 1e6 / targeted.published();
        assert!((0.85..1.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn three_and_four_times_are_enough_and_one_and_two_are_not() {
        let rows = sensitivity(&[1.0, 2.0, 3.0, 4.0], &Params::shipped());
        assert!(rows.iter().all(|row| row.renewals == 26 * 16));
        for row in &rows[..2] {
            assert!(row.mean_share < 0.9 && row.satisfied < 360, "{row:?}");
        }
        for row in &rows[2..] {
            assert!(row.mean_share > 0.98 && row.satisfied > 395, "{row:?}");
        }
        assert_eq!(rows[2].targeted, 3.0 * rows[0].targeted);
    }

    #[test]
    fn the_account_adds_up() {
        let own = account(2.0);
        let costs: f64 = AccountLine::COSTS.iter().map(|line| own.of_line(*line)).sum();
        assert!((costs - own.of_line(AccountLine::Costs)).abs() < 1e-3);
        let left = 1e6 + own.of_line(AccountLine::Revenue) - costs;
        assert!((left - own.of_line(AccountLine::Subtotal)).abs() < 1e-3);
        assert!((0.49 * left - own.of_line(AccountLine::Estimate)).abs() < 1e-3);
    }
}
