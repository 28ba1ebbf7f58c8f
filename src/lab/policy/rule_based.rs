//! Settings of the paper's weekly routine in a policy file (docs/interfaces/policies.md).

use serde::Deserialize;

use novamind_world::identifiers::Plan;

/// Value of the cash floor with which spending is never stopped.
const NO_CASH_FLOOR: f64 = -1.0;

/// Settings of the weekly routine. The defaults are the paper's best configuration.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RuleBased {
    /// Prices, model tiers and quotas.
    pub price_book: PriceBook,
    /// Groups that receive targeted development and ads.
    pub target: Target,
    /// Budgets of the target groups.
    pub spend: Spend,
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
            price_book: PriceBook::Named(BookName::Mid),
            target: Target::S1Only,
            spend: Spend::Named(SpendName::Heavy),
            cash_floor: 100_000.0,
            global_development: 200.0,
            operations: OperationsRule::Named(OperationsName::Subscribers),
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
        let amounts = |spend: &Spend| {
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
            Some((key, dollars)) => Err(format!("`{key}` must be dollars a day, not {dollars}")),
            None => Ok(self),
        }
    }
}

/// The prices, model tiers and quotas of the three plans.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged, expecting = "price_book must be cheap, mid or a table of prices, tiers and quotas by plan")]
pub enum PriceBook {
    /// A price book of the paper.
    Named(BookName),
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
pub enum BookName {
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
            PriceBook::Named(BookName::Cheap) => (
                PerPlan { a: 8.0, b: 18.0, c: 40.0 },
                PerPlan { a: 1, b: 2, c: 3 },
                PerPlan { a: 50_000, b: 200_000, c: 1_000_000 },
            ),
            PriceBook::Named(BookName::Mid) => (
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
pub enum Target {
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
pub enum Spend {
    /// A budget package of the paper.
    Named(SpendName),
    /// Custom budgets per group.
    Own {
        /// Budgets of group S1.
        #[serde(rename = "S1")]
        s1: Budget,
        /// Budgets of group S3.
        #[serde(rename = "S3")]
        s3: Budget,
    },
}

/// The paper's budget packages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SpendName {
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
pub struct Budget {
    /// Targeted development budget of the group.
    pub development: f64,
    /// Advertising budget of the group.
    pub ads: f64,
}

impl Spend {
    /// Returns the budgets of groups S1 and S3.
    pub fn budgets(&self) -> (Budget, Budget) {
        let package = |s1: (f64, f64), s3: (f64, f64)| {
            (Budget { development: s1.0, ads: s1.1 }, Budget { development: s3.0, ads: s3.1 })
        };
        match self {
            Spend::Named(SpendName::Light) => package((2000.0, 250.0), (1500.0, 600.0)),
            Spend::Named(SpendName::Medium) => package((4000.0, 500.0), (3000.0, 1200.0)),
            Spend::Named(SpendName::Heavy) => package((6000.0, 750.0), (4500.0, 1800.0)),
            Spend::Own { s1, s3 } => (*s1, *s3),
        }
    }
}

/// The rule for the operations budget.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(untagged, expecting = "operations must be subscribers or an amount of dollars a day")]
pub enum OperationsRule {
    /// A rule by name: max(100, 0.05 * active subscriptions), $ per day.
    Named(OperationsName),
    /// A fixed budget, $ per day.
    Fixed(f64),
}

/// The name of a rule for the operations budget.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OperationsName {
    /// A budget proportional to the number of subscribers.
    Subscribers,
}

/// The rule for the capacity tier.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CapacityRule {
    /// Changes capacity by one tier per week, towards the smallest tier that serves the week's usage at 80 % utilization.
    Utilisation,
    /// Never changes the capacity tier.
    Fixed,
}
