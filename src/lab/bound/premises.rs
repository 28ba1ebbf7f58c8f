//! What the account takes for granted: the plan it prices, in the numbers of the paper.

/// The plan that the account prices.
#[derive(Debug, Clone, PartialEq)]
pub struct Premises {
    /// Targeted development is paid so many times over.
    pub slack: f64,
    /// Days that are paid for.
    pub days: u32,
    /// Days of a run; the calendar of rivals follows them.
    pub run_days: u32,
    /// Days on which everybody renews.
    pub renewals: Vec<u32>,
    /// Model tier of every plan.
    pub model_tier: u8,
    /// Capacity tier.
    pub capacity_tier: u8,
    /// General development, dollars a day.
    pub global_development: f64,
    /// R&D tiers that are started, from 1 to this one.
    pub research_tiers: u8,
    /// Day on which they are started.
    pub research_day: u32,
    /// Operations, dollars a day.
    pub operations: f64,
    /// Operations for each customer or seat, dollars a day.
    pub operations_each: f64,
    /// Share of a day's targeted gain that counts when the spending is chosen: the rest is left to rivals.
    pub counted_gain: f64,
    /// Level that every group is studied to.
    pub study_level: u8,
    /// Share of what is left over that is reported.
    pub reported_share: f64,
}

/// The slack of the published account.
pub const PUBLISHED_SLACK: f64 = 3.0;

impl Premises {
    /// Those of the paper, with its or another slack.
    pub fn of_the_paper(slack: f64) -> Premises {
        Premises {
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

    /// Days that a dollar of targeted development has acted for at the end, in the mean of the days it is spent on.
    pub fn mean_age(&self) -> f64 {
        f64::from(self.days) / 2.0
    }

    /// Everything the account supposes: what, and why it matters. Rivals are in it where the parameters in force have them.
    pub fn assumptions(&self, has_rivals: bool) -> Vec<(&'static str, String)> {
        let rivals = match has_rivals {
            true => format!(
                "mean of {} lucks of the world's own rivals, copying and draining what this plan develops",
                super::climate::LUCKS
            ),
            false => "no rivals: the parameters in force have none".to_owned(),
        };
        let (first, last) = (self.renewals.first().unwrap_or(&0), self.renewals.last().unwrap_or(&0));
        vec![
            (
                "everybody stays",
                format!(
                    "all {} groups are known and full by day {first}, and all who are satisfied renew on {} days, the last of them day {last}; nobody is lost to failed payments",
                    novamind_world::identifiers::Group::all().len(),
                    self.renewals.len()
                ),
            ),
            (
                "N: largest attainable market",
                "individuals: the market of day 0; companies: the accounts of day 0, each with the most seats of its group; markets do not grow"
                    .to_owned(),
            ),
            (
                "p: highest price a group supports",
                "the mean budget; that half of the customers have less, and that budgets drift, is left out"
                    .to_owned(),
            ),
            (
                "r: share that renews",
                "a normal distribution of required quality at the budget: mean and spread of floor and range of the group".to_owned(),
            ),
            (
                "d: rivals and taste",
                format!("{rivals}, and the drift of the group; the drift of single customers is left out"),
            ),
            (
                "overload",
                "usage above the largest capacity costs quality at every renewal; in the released mechanics it costs satisfaction only"
                    .to_owned(),
            ),
            (
                "targeted development",
                format!(
                    "slack {} times the spending whose gain over {} days, counted at {}, closes the widest gap of the mean customer",
                    self.slack,
                    self.mean_age(),
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
                "no limits of cash",
                "nothing is checked against the cash in hand: the plan is spent from day 1".to_owned(),
            ),
            (
                "what is reported",
                format!("{} of what is left, the share that was published", self.reported_share),
            ),
        ]
    }
}
