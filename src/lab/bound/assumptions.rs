//! Assumptions of the account: the plan with its numbers from the paper.

/// The plan whose result the account computes.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundAssumptions {
    /// Slack: targeted development spending as a multiple of the required spending.
    pub slack: f64,
    /// Number of days on which the company has costs.
    pub days: u32,
    /// Length of the run in days, which affects the times and sizes of competitor events.
    pub run_days: u32,
    /// Days on which all customers renew.
    pub renewals: Vec<u32>,
    /// Model tier of every plan.
    pub model_tier: u8,
    /// Capacity tier on all days.
    pub capacity_tier: u8,
    /// General development, $ per day.
    pub global_development: f64,
    /// Highest R&D tier; all tiers up to this tier are started.
    pub research_tiers: u8,
    /// Day on which the R&D projects start.
    pub research_day: u32,
    /// Fixed spending on operations, $ per day.
    pub operations: f64,
    /// Spending on operations per customer or seat, $ per day.
    pub operations_each: f64,
    /// Share of a day's targeted gain that is assumed to last when spending is computed. Competitors drain
    /// the rest.
    pub counted_gain: f64,
    /// Study level of every group.
    pub study_level: u8,
    /// Share of the subtotal that is reported as the estimate.
    pub reported_share: f64,
}

/// Slack of the published account.
pub const PUBLISHED_SLACK: f64 = 3.0;

impl BoundAssumptions {
    /// Returns the paper's assumptions with the given slack.
    pub fn from_paper(slack: f64) -> BoundAssumptions {
        BoundAssumptions {
            slack,
            days: 497,
            run_days: 500,
            renewals: (1..=16).map(|month| 30 * month).collect(),
            model_tier: 3,
            capacity_tier: 7,
            global_development: 40_000.0,
            research_tiers: 10,
            research_day: 1,
            operations: 500.0,
            operations_each: 0.001,
            counted_gain: 0.7,
            study_level: 2,
            reported_share: 0.49,
        }
    }

    /// Returns the mean age of the targeted development spending at the end of the account, days.
    pub fn mean_spending_age(&self) -> f64 {
        f64::from(self.days) / 2.0
    }

    /// Returns the name and description of each assumption. Competitors are described if `has_rivals` is set.
    pub fn descriptions(&self, has_rivals: bool) -> Vec<(&'static str, String)> {
        let rivals = match has_rivals {
            true => format!(
                "mean over {} seeds of the simulator's competitors, which copy and drain this plan's development",
                super::shared_quality::SEED_COUNT
            ),
            false => "no competitors: the current parameters have none".to_owned(),
        };
        let (first, last) = (self.renewals.first().unwrap_or(&0), self.renewals.last().unwrap_or(&0));
        vec![
            (
                "full retention",
                format!(
                    "all {} groups are known and full by day {first}, and all satisfied customers renew on {} days, the last being day {last}; no payments fail",
                    novamind_world::identifiers::Group::all().len(),
                    self.renewals.len()
                ),
            ),
            (
                "N: largest attainable market",
                "individuals: the market of day 0; enterprises: the accounts of day 0, each with the maximum seats of its group; markets do not grow"
                    .to_owned(),
            ),
            (
                "p: highest price a group supports",
                "the mean budget; lower budgets of half the customers and drift of budgets are ignored"
                    .to_owned(),
            ),
            (
                "r: share that renews",
                "required quality at the budget is normal: mean and spread from floor and range of the group".to_owned(),
            ),
            (
                "d: competitors and drift",
                format!("{rivals}, and the drift of the group; the drift of single customers is ignored"),
            ),
            (
                "overload",
                "usage above the largest capacity costs quality at every renewal; in the released mechanics it costs satisfaction only"
                    .to_owned(),
            ),
            (
                "targeted development",
                format!(
                    "{} times (slack) the spending whose gain over {} days, weighted by {}, closes the widest gap of the mean customer",
                    self.slack,
                    self.mean_spending_age(),
                    self.counted_gain
                ),
            ),
            (
                "usage",
                "mean demand of every customer or seat, over the days of the week".to_owned(),
            ),
            (
                "advertising",
                format!(
                    "through each group's best channel at its starting yield, at the reputation of day 0, to fill its market by day {first}; every lead signs up"
                ),
            ),
            (
                "no cash limit",
                "spending starts on day 1, regardless of the available cash".to_owned(),
            ),
            (
                "reported share",
                format!("{} of the amount before the discount, the published share", self.reported_share),
            ),
        ]
    }
}
