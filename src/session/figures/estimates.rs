//! Numeric estimates of a group from market studies: the values of `get_group_insights` without its texts.

use novamind_world::identifiers::Group;

/// Estimates of a group. Each true value at the time of the study is within `max_relative_error` of its estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimates {
    /// Estimated group.
    pub group: Group,
    /// Study level of the estimates, 1 to 5.
    pub level: u8,
    /// Day to which the estimates of budget, required quality and market size refer: the day of the last study, or of
    /// the group's discovery.
    pub as_of: u32,
    /// Largest relative error of an estimate, 0 to 1.
    pub max_relative_error: f64,
    /// Mean budget, dollars per month; per seat for enterprises.
    pub budget: f64,
    /// Mean usage, units per day; per seat for enterprises.
    pub usage: f64,
    /// Mean required quality.
    pub required_quality: f64,
    /// Seats of the smallest and the largest enterprise; 1 for individuals.
    pub seats: (f64, f64),
}

impl Estimates {
    /// Returns the usage of the smallest account, in units per day. All seats of an enterprise share one quota.
    pub fn account_usage(&self) -> f64 {
        self.usage * self.seats.0
    }

    /// Returns the range of the true value behind an estimate.
    pub fn true_range(&self, value: f64) -> (f64, f64) {
        true_value_range(value, self.max_relative_error)
    }

    /// Returns the range of the true usage of the smallest account, in units per day.
    pub fn account_usage_range(&self) -> (f64, f64) {
        let ((least, most), (fewest, seats)) = (self.true_range(self.usage), self.true_range(self.seats.0));
        // Individuals have exactly one seat.
        if self.group.is_enterprise() { (least * fewest, most * seats) } else { (least, most) }
    }
}

/// Returns the range of the true value behind an estimate. The relative error of the estimate is at most `share`.
pub fn true_value_range(estimate: f64, share: f64) -> (f64, f64) {
    let from = estimate / (1.0 + share);
    let to = if share < 1.0 { estimate / (1.0 - share) } else { f64::INFINITY };
    (from.min(to), from.max(to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn true_value_is_within_range_for_every_error() {
        for share in [0.65, 0.4, 0.05] {
            for draw in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let truth = 20.0;
                let (from, to) = true_value_range(truth * (1.0 + share * draw), share);
                assert!(from <= truth + 1e-9 && truth <= to + 1e-9, "{share} {draw}: {from} {to}");
            }
        }
        assert_eq!(true_value_range(0.0, 0.4), (0.0, 0.0));
        assert_eq!(true_value_range(14.0, 0.4), (10.0, 14.0 / 0.6));
    }
}
