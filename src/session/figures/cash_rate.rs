//! The rate at which cash changes: costs to which the settings commit the company, and income and variable costs of
//! recent weeks. Naive forecasts and the runway are computed from this rate.

use serde::Serialize;

use novamind_record::figures::WeekFigures;
use novamind_world::events::Category;

const RECENT_WEEKS: usize = 4;

/// Components of the cash rate, in dollars per day.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct CashRate {
    /// Costs to which the settings commit the company: capacity, operations, development, advertising.
    pub committed: f64,
    /// Payments and ad revenue, mean of the last four weeks.
    pub income: f64,
    /// Compute and lead costs, mean of the last four weeks.
    pub variable: f64,
}

impl CashRate {
    /// Computes the rate from the committed costs per day and the figures of past weeks.
    pub fn from_weeks(committed: f64, weeks: &[WeekFigures]) -> CashRate {
        let recent = &weeks[weeks.len().saturating_sub(RECENT_WEEKS)..];
        let days: u32 = recent.iter().map(|week| week.days_run).sum();
        if days == 0 {
            return CashRate { committed, ..CashRate::default() };
        }
        let (income, variable): (Vec<f64>, Vec<f64>) = recent.iter().map(weekly_flows).unzip();
        CashRate {
            committed,
            income: income.iter().sum::<f64>() / f64::from(days),
            variable: variable.iter().sum::<f64>() / f64::from(days),
        }
    }

    /// Returns the cash change per day, in dollars.
    pub fn net_per_day(&self) -> f64 {
        self.income - self.committed - self.variable
    }

    /// Returns the number of weeks until cash is 0, or `None` if cash does not decrease.
    pub fn runway_weeks(&self, cash: f64) -> Option<f64> {
        (self.net_per_day() < 0.0).then(|| cash.max(0.0) / -self.net_per_day() / 7.0)
    }
}

/// Returns the income and the variable costs of a week as positive amounts.
fn weekly_flows(week: &WeekFigures) -> (f64, f64) {
    let of = |category| week.booked.category_total(category);
    (
        of(Category::SubscriptionPayment) + of(Category::AdRevenue),
        -(of(Category::Compute) + of(Category::LeadAcquisitionCost)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::figures::CategoryTotals;

    fn week(income: f64, compute: f64) -> WeekFigures {
        let mut booked = CategoryTotals::default();
        booked.add(Category::SubscriptionPayment, income);
        booked.add(Category::Compute, -compute);
        booked.add(Category::ResearchProject, -500_000.0);
        WeekFigures { days_run: 7, booked, ..WeekFigures::default() }
    }

    #[test]
    fn runway_follows_from_commitments() {
        let pace = CashRate::from_weeks(5_585.0, &[]);
        assert!((pace.runway_weeks(1_000_000.0).expect("cash shrinks") - 25.578_72).abs() < 1e-4);
        assert_eq!(CashRate::default().runway_weeks(1.0), None);
    }

    #[test]
    fn rate_ignores_purchases_and_older_weeks() {
        let weeks =
            [week(1e9, 0.0), week(700.0, 70.0), week(1400.0, 70.0), week(700.0, 70.0), week(1400.0, 70.0)];
        let pace = CashRate::from_weeks(100.0, &weeks);
        assert_eq!((pace.income, pace.variable, pace.net_per_day()), (150.0, 10.0, 40.0));
    }
}
