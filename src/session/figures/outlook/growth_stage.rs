//! Stages of a company, determined by the trend of its income.

use serde::{Deserialize, Serialize};

use novamind_record::figures::WeekFigures;
use novamind_world::events::Category;

/// Number of recent weeks that determine whether a company has income. Also the maximum age of a young company, in
/// weeks.
const RECENT_WEEKS: usize = 4;
/// A company is surging if the ratio of its income in two weeks to its income four weeks earlier is above this value.
const MIN_SURGE_RATIO: f64 = 2.0;
/// A company is growing if this ratio is above this value, and shrinking if the inverse of the ratio is above this
/// value.
const MIN_GROWTH_RATIO: f64 = 1.3;

/// Stage of a company, determined by its age, its income and whether it advertises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum GrowthStage {
    /// The company has not completed a week and does not advertise.
    Start,
    /// The company is at most four weeks old and advertises, but has had no income.
    Launching,
    /// The company has had no income in the last four weeks.
    Idle,
    /// The company has income and is in its first four weeks.
    Young,
    /// The income of two weeks is more than twice the income four weeks earlier.
    Surging,
    /// The income is growing by 30 % or more in four weeks.
    Growing,
    /// The income is steady.
    Steady,
    /// The income is shrinking by 23 % or more in four weeks.
    Shrinking,
}

impl GrowthStage {
    /// All stages of a company.
    pub const ALL: [GrowthStage; 8] = [
        GrowthStage::Start,
        GrowthStage::Launching,
        GrowthStage::Idle,
        GrowthStage::Young,
        GrowthStage::Surging,
        GrowthStage::Growing,
        GrowthStage::Steady,
        GrowthStage::Shrinking,
    ];

    /// Returns the stage of a company after these weeks. Compares the income of the last two weeks with the income four
    /// weeks earlier. `advertises` states whether the current settings include an advertising budget.
    pub fn from_weeks(weeks: &[WeekFigures], advertises: bool) -> GrowthStage {
        let end = weeks.len();
        if daily_income(&weeks[end.saturating_sub(RECENT_WEEKS)..]) <= 0.0 {
            return match end {
                ..=RECENT_WEEKS if advertises => GrowthStage::Launching,
                0 => GrowthStage::Start,
                _ => GrowthStage::Idle,
            };
        }
        if end <= RECENT_WEEKS {
            return GrowthStage::Young;
        }
        let now = daily_income(&weeks[end - 2..]);
        let before = daily_income(&weeks[end.saturating_sub(RECENT_WEEKS + 2)..end - RECENT_WEEKS]);
        match now {
            _ if before <= 0.0 => GrowthStage::Surging,
            now if now > before * MIN_SURGE_RATIO => GrowthStage::Surging,
            now if now > before * MIN_GROWTH_RATIO => GrowthStage::Growing,
            now if now * MIN_GROWTH_RATIO < before => GrowthStage::Shrinking,
            _ => GrowthStage::Steady,
        }
    }

    /// Describes the companies of this stage.
    pub fn describe(self) -> &'static str {
        match self {
            GrowthStage::Start => "companies before their first week",
            GrowthStage::Launching => "companies before their first income",
            GrowthStage::Idle => "companies without income in four weeks",
            GrowthStage::Young => "companies in their first four weeks",
            GrowthStage::Surging => "companies whose income has doubled in four weeks",
            GrowthStage::Growing => "companies whose income is growing",
            GrowthStage::Steady => "companies with steady income",
            GrowthStage::Shrinking => "companies whose income is shrinking",
        }
    }

    /// Returns the name of the stage in files and tables.
    pub fn id(self) -> &'static str {
        ["start", "launching", "idle", "young", "surging", "growing", "steady", "shrinking"][self as usize]
    }
}

/// Returns payments and ad revenue per day, in dollars.
fn daily_income(weeks: &[WeekFigures]) -> f64 {
    let income = |week: &WeekFigures| {
        week.booked.category_total(Category::SubscriptionPayment)
            + week.booked.category_total(Category::AdRevenue)
    };
    let days: u32 = weeks.iter().map(|week| week.days_run).sum();
    weeks.iter().map(income).sum::<f64>() / f64::from(days.max(1))
}
