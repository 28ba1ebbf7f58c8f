//! The lines of the account: names, order, and published figures.

/// A line of the upper-bound account.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum AccountLine {
    /// Revenue from individuals.
    Individuals,
    /// Revenue from enterprises.
    Enterprises,
    /// Total revenue.
    Revenue,
    /// Cost of compute.
    Compute,
    /// Cost of capacity.
    Capacity,
    /// Cost of general development.
    GlobalDevelopment,
    /// Cost of targeted development.
    TargetedDevelopment,
    /// Cost of R&D projects.
    Research,
    /// Cost of advertising.
    Advertising,
    /// Lead acquisition cost.
    LeadCosts,
    /// Cost of operations.
    Operations,
    /// Cost of market research, which discovers groups.
    MarketResearch,
    /// Cost of market studies of groups.
    GroupResearch,
    /// Total costs.
    Costs,
    /// Starting cash plus revenue minus costs.
    Subtotal,
    /// Reported estimate: a share of the subtotal.
    Estimate,
}

impl AccountLine {
    /// All lines, in the order of the account.
    pub const ALL: [AccountLine; 16] = [
        AccountLine::Individuals,
        AccountLine::Enterprises,
        AccountLine::Revenue,
        AccountLine::Compute,
        AccountLine::Capacity,
        AccountLine::GlobalDevelopment,
        AccountLine::TargetedDevelopment,
        AccountLine::Research,
        AccountLine::Advertising,
        AccountLine::LeadCosts,
        AccountLine::Operations,
        AccountLine::MarketResearch,
        AccountLine::GroupResearch,
        AccountLine::Costs,
        AccountLine::Subtotal,
        AccountLine::Estimate,
    ];

    /// The cost lines, whose sum is [`AccountLine::Costs`].
    pub const COSTS: [AccountLine; 10] = [
        AccountLine::Compute,
        AccountLine::Capacity,
        AccountLine::GlobalDevelopment,
        AccountLine::TargetedDevelopment,
        AccountLine::Research,
        AccountLine::Advertising,
        AccountLine::LeadCosts,
        AccountLine::Operations,
        AccountLine::MarketResearch,
        AccountLine::GroupResearch,
    ];

    /// Returns the display name of the line.
    pub fn name(self) -> &'static str {
        match self {
            AccountLine::Individuals => "revenue, individuals",
            AccountLine::Enterprises => "revenue, enterprises",
            AccountLine::Revenue => "revenue",
            AccountLine::Compute => "compute",
            AccountLine::Capacity => "capacity",
            AccountLine::GlobalDevelopment => "global development",
            AccountLine::TargetedDevelopment => "targeted development",
            AccountLine::Research => "R&D",
            AccountLine::Advertising => "advertising",
            AccountLine::LeadCosts => "lead cost",
            AccountLine::Operations => "operations",
            AccountLine::MarketResearch => "market research",
            AccountLine::GroupResearch => "group research",
            AccountLine::Costs => "costs",
            AccountLine::Subtotal => "before discount",
            AccountLine::Estimate => "estimate",
        }
    }

    /// Returns the published figure of the line, in millions of dollars.
    pub fn published_millions(self) -> f64 {
        match self {
            AccountLine::Individuals => 1930.0,
            AccountLine::Enterprises => 4760.0,
            AccountLine::Revenue => 6690.0,
            AccountLine::Compute => 1554.0,
            AccountLine::Capacity => 37.3,
            AccountLine::GlobalDevelopment => 19.9,
            AccountLine::TargetedDevelopment => 423.6,
            AccountLine::Research => 9.2,
            AccountLine::Advertising => 114.8,
            AccountLine::LeadCosts => 0.9,
            AccountLine::Operations => 2.5,
            AccountLine::MarketResearch => 1.5,
            AccountLine::GroupResearch => 1.0,
            AccountLine::Costs => 2164.7,
            AccountLine::Subtotal => 4526.3,
            AccountLine::Estimate => 2200.0,
        }
    }

    /// Returns the maximum rounding error of the published figure, in millions of dollars.
    pub fn rounding_error(self) -> f64 {
        match self {
            AccountLine::Individuals | AccountLine::Enterprises => 5.0,
            AccountLine::Compute => 0.5,
            AccountLine::Estimate => 50.0,
            _ => 0.05,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_lines_add_up() {
        let sum: f64 = AccountLine::COSTS.iter().map(|line| line.published_millions()).sum();
        assert!((sum - AccountLine::Costs.published_millions()).abs() < 1e-9, "{sum}");
        let revenue =
            AccountLine::Individuals.published_millions() + AccountLine::Enterprises.published_millions();
        assert_eq!(revenue, AccountLine::Revenue.published_millions());
        let left = 1.0 + revenue - sum;
        assert!((left - AccountLine::Subtotal.published_millions()).abs() < 1e-9, "{left}");
        assert!(
            (0.49 * left - AccountLine::Estimate.published_millions()).abs()
                < AccountLine::Estimate.rounding_error()
        );
    }
}
