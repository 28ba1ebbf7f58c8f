//! The rate at which cash changes: commitments of the settings, and income and variable costs of recent weeks. Naive
//! forecasts and the runway follow from it.

use serde::Serialize;

use novamind_record::figures::WeekFigures;
use novamind_world::events::Category;

const RECENT: usize = 4;

/// Rates, dollars a day.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Pace {
    /// Costs that the settings commit to: capacity, operations, development, advertising.
    pub committed: f64,
    /// Payments and ad revenue, mean of the last four weeks.
    pub income: f64,
    /// Compute and lead costs, mean of the last four weeks.
    pub variable: f64,
}

impl Pace {
    /// Computes the rate from daily commitments and the figures of past weeks.
    pub fn of(committed: f64, weeks: &[WeekFigures]) -> Pace {
        let recent = &weeks[weeks.len().saturating_sub(RECENT)..];
        let days: u32 = recent.iter().map(|week| week.days_run).sum();
        if days == 0 {
            return Pace { committed, ..Pace::default() };
        }
        let (income, variable): (Vec<f64>, Vec<f64>) = recent.iter().map(flows).unzip();
        Pace {
            committed,
            income: income.iter().sum::<f64>() / f64::from(days),
            variable: variable.iter().sum::<f64>() / f64::from(days),
        }
    }

    /// Returns the change of cash per day.
    pub fn net(&self) -> f64 {
        self.income - self.committed - self.variable
    }

    /// Returns the weeks until cash is 0; `None` if it does not shrink.
    pub fn runway_weeks(&self, cash: f64) -> Option<f64> {
        (self.net() < 0.0).then(|| cash.max(0.0) / -self.net() / 7.0)
    }
}

/// Returns income and variable costs of a week, both positive.
fn flows(week: &WeekFigures) -> (f64, f64) {
    let of = |category| week.booked.of(category);
    (
        of(Category::SubscriptionPayment) + of(Category::AdRevenue),
        -(of(Category::Compute) + of(Category::LeadAcquisitionCost)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::figures::Booked;

    fn week(income: f64, compute: f64) -> WeekFigures {
        let mut booked = Booked::default();
        booked.add(Category::SubscriptionPayment, income);
        booked.add(Category::Compute, -compute);
        booked.add(Category::ResearchProject, -500_000.0);
        WeekFigures { days_run: 7, booked, ..WeekFigures::default() }
    }

    #[test]
    fn cash_lasts_as_long_as_commitments_let_it() {
        let pace = Pace::of(5_585.0, &[]);
        assert!((pace.runway_weeks(1_000_000.0).expect("cash shrinks") - 25.578_72).abs() < 1e-4);
        assert_eq!(Pace::default().runway_weeks(1.0), None);
    }

    #[test]
    fn purchases_are_no_pace_and_only_four_weeks_are_recent() {
        let weeks =
            [week(1e9, 0.0), week(700.0, 70.0), week(1400.0, 70.0), week(700.0, 70.0), week(1400.0, 70.0)];
        let pace = Pace::of(100.0, &weeks);
        assert_eq!((pace.income, pace.variable, pace.net()), (150.0, 10.0, 40.0));
    }
}
