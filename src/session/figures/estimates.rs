//! What studies say of a group, as numbers: what get_group_insights answers, without its words.

use novamind_world::identifiers::Group;

/// Estimates of a group. The truth at the time of the study lies within a relative error of each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimates {
    /// Group.
    pub group: Group,
    /// Level of knowledge, 1..=5.
    pub level: u8,
    /// Day that budget, floor and size of the market are of: that of the last study, or on which the group was found.
    pub as_of: u32,
    /// Largest relative error, 0..1.
    pub noise: f64,
    /// Mean budget, dollars a month, of companies per seat.
    pub budget: f64,
    /// Mean use, units a day, of companies per seat.
    pub usage: f64,
    /// Mean of the least quality a customer accepts.
    pub floor: f64,
    /// Seats of the smallest and the largest company; one of individuals.
    pub seats: (f64, f64),
}

impl Estimates {
    /// Units a day that the smallest account uses: all seats of a company share one quota.
    pub fn account_usage(&self) -> f64 {
        self.usage * self.seats.0
    }

    /// Least and greatest truth behind an estimated value.
    pub fn range(&self, value: f64) -> (f64, f64) {
        truth_behind(value, self.noise)
    }

    /// Least and greatest units a day behind the estimates that the smallest account uses.
    pub fn account_range(&self) -> (f64, f64) {
        let ((least, most), (fewest, seats)) = (self.range(self.usage), self.range(self.seats.0));
        // People have one seat, whatever the error.
        if self.group.is_enterprise() { (least * fewest, most * seats) } else { (least, most) }
    }
}

/// Least and greatest truth behind an estimate that is off by at most a share: it is the truth times 1 ± share.
pub fn truth_behind(estimate: f64, share: f64) -> (f64, f64) {
    let from = estimate / (1.0 + share);
    let to = if share < 1.0 { estimate / (1.0 - share) } else { f64::INFINITY };
    (from.min(to), from.max(to))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_lies_inside_the_range_whatever_the_noise_was() {
        for share in [0.65, 0.4, 0.05] {
            for draw in [-1.0, -0.3, 0.0, 0.8, 1.0] {
                let truth = 20.0;
                let (from, to) = truth_behind(truth * (1.0 + share * draw), share);
                assert!(from <= truth + 1e-9 && truth <= to + 1e-9, "{share} {draw}: {from} {to}");
            }
        }
        assert_eq!(truth_behind(0.0, 0.4), (0.0, 0.0));
        assert_eq!(truth_behind(14.0, 0.4), (10.0, 14.0 / 0.6));
    }
}
