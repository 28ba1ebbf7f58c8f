//! Settings of the paper's weekly routine in a policy file (docs/interfaces/policies.md).

use serde::Deserialize;

use novamind_world::identifiers::Plan;

/// Value of the cash floor at which spending is never stopped.
const NO_CASH_FLOOR: f64 = -1.0;

/// Settings of the weekly routine. The defaults are the paper's best configuration.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RuleBased {
    /// Prices, model tiers and quotas.
    pub price_book: PriceBook,
    /// Groups that receive targeted development and ads.
    pub target: TargetGroups,
    /// Budgets of the target groups.
    pub spend: TargetBudgets,
    /// Cash above which spending is on, dollars; -1 for always.
    pub cash_floor: f64,
    /// General development while spending is on, $ per day.
    pub global_development: f64,
    /// Rule for the operations budget.
    pub operations: OperationsRule,
    /// Rule for the capacity tier.
    pub capacity: CapacityRule,
}

impl Default for RuleBased {
    fn default() -> Self {
        RuleBased {
            price_book: PriceBook::Named(PriceBookName::Mid),
            target: TargetGroups::S1Only,
            spend: TargetBudgets::Named(BudgetPackage::Heavy),
            cash_floor: 100_000.0,
            global_development: 200.0,
            operations: OperationsRule::Named(OperationsRuleName::Subscribers),
            capacity: CapacityRule::Utilisation,
        }
    }
}

impl RuleBased {
    /// Returns the routine if all its amounts are valid.
    ///
    /// # Errors
    /// Returns a message that names the key with an invalid amount.
    pub(super) fn validated(self) -> Result<RuleBased, String> {
        let amounts = |spend: &TargetBudgets| {
            let (s1, s3) = spend.budgets();
            [s1.development, s1.ads, s3.development, s3.ads]
        };
        let fixed = match self.operations {
            OperationsRule::Fixed(dollars) => dollars,
            OperationsRule::Named(_) => 0.0,
        };
        let is_amount = |dollars: &f64| dollars.is_finite() && *dollars >= 0.0;
        if self.cash_floor != NO_CASH_FLOOR && !is_amount(&self.cash_floor) {
            return Err(format!("`cash_floor` must be dollars, or -1 for always, not {}", self.cash_floor));
        }
        let wrong = [("global_development", self.global_development), ("operations", fixed)]
            .into_iter()
            .chain(amounts(&self.spend).map(|dollars| ("spend", dollars)))
            .find(|(_, dollars)| !is_amount(dollars));
        match wrong {
            Some((key, dollars)) => {
                Err(format!("`{key}` must be an amount of 0 or more dollars a day, not {dollars}"))
            }
            None => Ok(self),
        }
    }
}

/// The prices, model tiers and quotas of the three plans.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "price_book must be cheap, mid or a table of prices, tiers and quotas by plan")]
pub enum PriceBook {
    /// A price book of the paper.
    Named(PriceBookName),
    /// A custom price book.
    Own {
        /// List prices, $ per month.
        prices: PerPlan<f64>,
        /// Model tiers of the plans.
        tiers: PerPlan<u8>,
        /// Quotas, units per day.
        quotas: PerPlan<u64>,
    },
}

/// The paper's price books.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PriceBookName {
    /// Plan A $8 / T1 / 50K, B $18 / T2 / 200K, C $40 / T3 / 1M: price, model tier and quota.
    Cheap,
    /// Plan A $12 / T1 / 60K, B $25 / T2 / 250K, C $55 / T4 / 1.2M: price, model tier and quota.
    Mid,
}

/// A value for each plan.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PerPlan<T> {
    /// Value for plan A.
    #[serde(rename = "A")]
    pub a: T,
    /// Value for plan B.
    #[serde(rename = "B")]
    pub b: T,
    /// Value for plan C.
    #[serde(rename = "C")]
    pub c: T,
}

impl<T: Copy> PerPlan<T> {
    /// Returns the value for a plan.
    pub fn get(&self, plan: Plan) -> T {
        match plan {
            Plan::A => self.a,
            Plan::B => self.b,
            Plan::C => self.c,
        }
    }
}

impl PriceBook {
    /// Returns the prices, model tiers and quotas of the plans.
    pub fn prices_tiers_and_quotas(&self) -> (PerPlan<f64>, PerPlan<u8>, PerPlan<u64>) {
        match self {
            PriceBook::Named(PriceBookName::Cheap) => (
                PerPlan { a: 8.0, b: 18.0, c: 40.0 },
                PerPlan { a: 1, b: 2, c: 3 },
                PerPlan { a: 50_000, b: 200_000, c: 1_000_000 },
            ),
            PriceBook::Named(PriceBookName::Mid) => (
                PerPlan { a: 12.0, b: 25.0, c: 55.0 },
                PerPlan { a: 1, b: 2, c: 4 },
                PerPlan { a: 60_000, b: 250_000, c: 1_200_000 },
            ),
            PriceBook::Own { prices, tiers, quotas } => (*prices, *tiers, *quotas),
        }
    }
}

/// The groups that receive targeted development and ads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TargetGroups {
    /// Only group S1.
    S1Only,
    /// Group S1, and group S3 from day 30 on.
    S1ThenS3,
    /// No target groups.
    None,
}

/// The budgets of the target groups.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "spend must be light, medium, heavy or a table with the budgets of S1 and S3")]
pub enum TargetBudgets {
    /// A budget package of the paper.
    Named(BudgetPackage),
    /// Custom budgets per group.
    Own {
        /// Budgets of group S1.
        #[serde(rename = "S1")]
        s1: GroupBudget,
        /// Budgets of group S3.
        #[serde(rename = "S3")]
        s3: GroupBudget,
    },
}

/// The paper's budget packages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BudgetPackage {
    /// Development and ads per day: $2,000 and $250 for S1, $1,500 and $600 for S3.
    Light,
    /// Development and ads per day: $4,000 and $500 for S1, $3,000 and $1,200 for S3.
    Medium,
    /// Development and ads per day: $6,000 and $750 for S1, $4,500 and $1,800 for S3.
    Heavy,
}

/// The budgets of one group, $ per day.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroupBudget {
    /// Targeted development budget of the group.
    pub development: f64,
    /// Advertising budget of the group.
    pub ads: f64,
}

impl TargetBudgets {
    /// Returns the budgets of groups S1 and S3.
    pub fn budgets(&self) -> (GroupBudget, GroupBudget) {
        let package = |s1: (f64, f64), s3: (f64, f64)| {
            (GroupBudget { development: s1.0, ads: s1.1 }, GroupBudget { development: s3.0, ads: s3.1 })
        };
        match self {
            TargetBudgets::Named(BudgetPackage::Light) => package((2000.0, 250.0), (1500.0, 600.0)),
            TargetBudgets::Named(BudgetPackage::Medium) => package((4000.0, 500.0), (3000.0, 1200.0)),
            TargetBudgets::Named(BudgetPackage::Heavy) => package((6000.0, 750.0), (4500.0, 1800.0)),
            TargetBudgets::Own { s1, s3 } => (*s1, *s3),
        }
    }
}

/// The rule for the operations budget.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "operations must be subscribers or an amount of dollars a day")]
pub enum OperationsRule {
    /// The rule `subscribers`: max(100, 0.05 * active subscriptions), $ per day.
    Named(OperationsRuleName),
    /// A fixed budget, $ per day.
    Fixed(f64),
}

/// The name of a rule for the operations budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OperationsRuleName {
    /// A budget proportional to the number of subscribers.
    Subscribers,
}

/// The rule for the capacity tier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CapacityRule {
    /// Steps of one capacity tier per week, towards the smallest tier that serves the week's usage at 80 % utilization.
    Utilisation,
    /// A capacity tier that never changes.
    Fixed,
}
