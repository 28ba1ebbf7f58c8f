//! Churn of subscribers over a period.

use super::week::WeekFigures;

/// Returns cancellations as a share of the subscribers before the period, or `None` if there were no subscribers.
pub fn churn(cancellations: f64, subscribers_before: f64) -> Option<f64> {
    (subscribers_before > 0.0).then(|| cancellations / subscribers_before)
}

/// Returns the churn of individuals in the last week, or `None` if there were no subscribers before that week.
pub fn last_week_churn(weeks: &[WeekFigures]) -> Option<f64> {
    let [.., before, last] = weeks else { return None };
    churn(last.cancellations.into(), before.individual_subscribers.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn churn_divides_by_subscribers_before_the_period() {
        assert_eq!(churn(5.0, 200.0), Some(0.025));
        assert_eq!((churn(0.0, 3.0), churn(0.0, 0.0)), (Some(0.0), None));
    }
}
