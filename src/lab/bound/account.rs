//! The account of the upper bound: every line, computed from the plan and the parameters.

use super::account_line::AccountLine;
use super::assumptions::BoundAssumptions;
use super::required_quality::overload_penalty;
use super::shared_quality::{SharedQualityPath, shared_quality_path};
use super::{
    acquisition_costs, attainable_market, improvement_costs, operating_costs, renewals, research_costs,
    targeted_development,
};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// A customer group in the account.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundGroup {
    /// ID of the group.
    pub group: &'static str,
    /// Number of customers, or number of seats in a group of enterprises.
    pub customers: f64,
    /// Price per customer or seat, $ per month.
    pub price: f64,
    /// Largest quality gap that targeted development must close.
    pub quality_gap: f64,
    /// Spending that closes the gap exactly, without slack, $ per day.
    pub min_spending: f64,
    /// Spending with slack, $ per day.
    pub spending: f64,
    /// Share of customers who renew, by renewal day.
    pub renewal_shares: Vec<f64>,
    /// Revenue from all renewals, dollars.
    pub revenue: f64,
}

/// A line of the account with its computed and published figure.
#[derive(Debug, Clone, PartialEq)]
pub struct AccountRow {
    /// Account line to which the figures belong.
    pub line: AccountLine,
    /// Computed figure of the line, dollars.
    pub computed: f64,
    /// Published figure of the line, dollars.
    pub published: f64,
    /// Explanation of the difference between the two figures.
    pub explanation: String,
}

/// The account of the upper bound.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundAccount {
    /// Assumptions of the account.
    pub assumptions: BoundAssumptions,
    /// Whether competitors are active under the parameters.
    pub has_competitors: bool,
    /// Usage of all customers, units per day.
    pub daily_usage: f64,
    /// Quality that all customers lose to overload.
    pub overload_penalty: f64,
    /// Account figures of each customer group.
    pub groups: Vec<BoundGroup>,
    /// Lines of the account, in order.
    pub lines: Vec<AccountRow>,
}

/// A row of the sensitivity table, which varies the slack.
#[derive(Debug, Clone, PartialEq)]
pub struct SensitivityRow {
    /// Slack for which the row is computed.
    pub slack: f64,
    /// Cost of targeted development, dollars.
    pub targeted: f64,
    /// Number of group renewals at which more than 99 % of the group's customers are satisfied.
    pub satisfied: usize,
    /// Total number of group renewals: number of groups times number of renewal days.
    pub renewals: usize,
    /// Mean renewal share over groups and renewal days.
    pub mean_share: f64,
    /// Reported estimate, dollars.
    pub estimate: f64,
}

/// Share of satisfied customers above which a group renewal counts as nearly full.
pub const SATISFIED_SHARE: f64 = 0.99;

impl BoundAccount {
    /// Computes the account from the assumptions and the parameters.
    pub fn new(premises: BoundAssumptions, params: &Params) -> BoundAccount {
        let quality_path = shared_quality_path(&premises, params);
        BoundAccount::with_shared_quality(premises, &quality_path, params)
    }

    /// Computes the account with a given path of shared quality and competitor effects.
    fn with_shared_quality(
        premises: BoundAssumptions,
        quality_path: &SharedQualityPath,
        params: &Params,
    ) -> BoundAccount {
        let daily_usage = attainable_market::daily_usage(params);
        let overload = overload_penalty(daily_usage, premises.capacity_tier, params);
        let groups: Vec<BoundGroup> = Group::all()
            .map(|group| group_account(group, overload, quality_path, &premises, params))
            .collect();
        let has_rivals = !params.competitor.competitor_events_disabled;
        let mut account = BoundAccount {
            assumptions: premises,
            has_competitors: has_rivals,
            daily_usage,
            overload_penalty: overload,
            groups,
            lines: Vec::new(),
        };
        account.lines = account.compute_rows(params);
        account
    }

    fn compute_rows(&self, params: &Params) -> Vec<AccountRow> {
        let line = |line: AccountLine| {
            let value = self.compute_line(line, params);
            AccountRow {
                line,
                computed: value,
                published: 1e6 * line.published_millions(),
                explanation: self.explain_difference(line, value, params),
            }
        };
        AccountLine::ALL.into_iter().map(line).collect()
    }

    fn compute_line(&self, line: AccountLine, params: &Params) -> f64 {
        let premises = &self.assumptions;
        match line {
            AccountLine::Individuals => self.customer_revenue(false),
            AccountLine::Enterprises => self.customer_revenue(true),
            AccountLine::Revenue => self.customer_revenue(false) + self.customer_revenue(true),
            AccountLine::Compute => operating_costs::compute_cost(self.daily_usage, premises, params),
            AccountLine::Capacity => operating_costs::capacity_cost(premises, params),
            AccountLine::GlobalDevelopment => improvement_costs::global_development_cost(premises),
            AccountLine::TargetedDevelopment => self.targeted_development(),
            AccountLine::Research => improvement_costs::research_cost(premises, params),
            AccountLine::Advertising => {
                Group::all().map(|group| acquisition_costs::advertising_cost(group, premises, params)).sum()
            }
            AccountLine::LeadCosts => acquisition_costs::lead_costs(params),
            AccountLine::Operations => operating_costs::operations_cost(self.customers(), premises),
            AccountLine::MarketResearch => research_costs::market_research_cost(params),
            AccountLine::GroupResearch => research_costs::group_research_cost(premises, params),
            AccountLine::Costs => {
                AccountLine::COSTS.into_iter().map(|cost| self.compute_line(cost, params)).sum()
            }
            AccountLine::Subtotal => {
                params.initial.initial_cash + self.compute_line(AccountLine::Revenue, params)
                    - self.compute_line(AccountLine::Costs, params)
            }
            AccountLine::Estimate => {
                premises.reported_share * self.compute_line(AccountLine::Subtotal, params)
            }
        }
    }

    /// Returns the revenue from enterprises or from individuals, dollars.
    pub(super) fn customer_revenue(&self, of_companies: bool) -> f64 {
        let bound_groups = self.groups.iter().filter(|bound_group| {
            Group::parse(bound_group.group).is_some_and(|group| group.is_enterprise() == of_companies)
        });
        bound_groups.map(|bound_group| bound_group.revenue).sum()
    }

    fn targeted_development(&self) -> f64 {
        f64::from(self.assumptions.days)
            * self.groups.iter().map(|bound_group| bound_group.spending).sum::<f64>()
    }

    /// Returns the number of paying individuals and seats.
    pub fn customers(&self) -> f64 {
        self.groups.iter().map(|bound_group| bound_group.customers).sum()
    }

    /// Returns the computed figure of a line, dollars.
    pub fn computed(&self, line: AccountLine) -> f64 {
        self.lines.iter().find(|account_entry| account_entry.line == line).map_or(0.0, |entry| entry.computed)
    }

    fn sensitivity_row(&self) -> SensitivityRow {
        let shares = || self.groups.iter().flat_map(|bound_group| bound_group.renewal_shares.iter().copied());
        let renewals = shares().count();
        SensitivityRow {
            slack: self.assumptions.slack,
            targeted: self.targeted_development(),
            satisfied: shares().filter(|share| *share > SATISFIED_SHARE).count(),
            renewals,
            mean_share: shares().sum::<f64>() / renewals.max(1) as f64,
            estimate: self.computed(AccountLine::Estimate),
        }
    }
}

/// Returns the sensitivity of the account to slack, one row per value.
pub fn sensitivity(slacks: &[f64], params: &Params) -> Vec<SensitivityRow> {
    let premises = |slack: &f64| BoundAssumptions::from_paper(*slack);
    let Some(first) = slacks.first() else { return Vec::new() };
    // One path is valid for every slack, because competitors copy in proportion to a targeted gain.
    let quality_path = shared_quality_path(&premises(first), params);
    slacks
        .iter()
        .map(|slack| {
            BoundAccount::with_shared_quality(premises(slack), &quality_path, params).sensitivity_row()
        })
        .collect()
}

fn group_account(
    group: Group,
    overload: f64,
    quality_path: &SharedQualityPath,
    premises: &BoundAssumptions,
    params: &Params,
) -> BoundGroup {
    let gap = targeted_development::widest_gap(group, overload, quality_path, premises, params);
    let least_spending = targeted_development::min_spending(gap, premises, params);
    let spending = premises.slack * least_spending;
    let renewing = renewals::renewal_shares(group, spending, overload, quality_path, premises, params);
    BoundGroup {
        group: group.id(),
        customers: attainable_market::attainable_customers(group, params),
        price: attainable_market::highest_price(group, params),
        quality_gap: gap,
        min_spending: least_spending,
        spending,
        revenue: attainable_market::full_billing_revenue(group, params) * renewing.iter().sum::<f64>(),
        renewal_shares: renewing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn account_with_slack(slack: f64) -> BoundAccount {
        BoundAccount::new(BoundAssumptions::from_paper(slack), &Params::bundled())
    }

    #[test]
    fn account_lines_of_the_product_equal_published_figures() {
        let bound_account = account_with_slack(3.0);
        for line in [
            AccountLine::Capacity,
            AccountLine::GlobalDevelopment,
            AccountLine::Research,
            AccountLine::Operations,
        ] {
            let off = bound_account.computed(line) / 1e6 - line.published_millions();
            assert!(off.abs() <= line.rounding_error(), "{}: {off}", line.name());
        }
    }

    #[test]
    fn account_sums_are_within_3_percent_of_published_figures() {
        let bound_account = account_with_slack(3.0);
        for line in [AccountLine::Revenue, AccountLine::Costs, AccountLine::Subtotal, AccountLine::Estimate] {
            let ratio = bound_account.computed(line) / 1e6 / line.published_millions();
            assert!((ratio - 1.0).abs() < 0.03, "{}: {ratio}", line.name());
        }
        let targeted = AccountLine::TargetedDevelopment;
        let ratio = bound_account.computed(targeted) / 1e6 / targeted.published_millions();
        assert!((0.85..1.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn slack_of_three_retains_customers_and_two_does_not() {
        let rows = sensitivity(&[1.0, 2.0, 3.0, 4.0], &Params::bundled());
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
    fn account_lines_add_up() {
        let bound_account = account_with_slack(2.0);
        let costs: f64 = AccountLine::COSTS.iter().map(|line| bound_account.computed(*line)).sum();
        assert!((costs - bound_account.computed(AccountLine::Costs)).abs() < 1e-3);
        let left = 1e6 + bound_account.computed(AccountLine::Revenue) - costs;
        assert!((left - bound_account.computed(AccountLine::Subtotal)).abs() < 1e-3);
        assert!((0.49 * left - bound_account.computed(AccountLine::Estimate)).abs() < 1e-3);
    }
}
