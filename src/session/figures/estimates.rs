//! What studies say of a group, as numbers: what get_group_insights answers, without its words.

use super::truth::truth_behind;
use crate::state::Session;
use novamind_tools::GetGroupInsights;
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

impl Session {
    /// Estimates of every known group, in their fixed order; not recorded.
    pub fn estimates(&self) -> Vec<Estimates> {
        let terms = self.terms();
        let of = |group: Group| {
            let insights = self.look_up(&GetGroupInsights, group)?;
            let (level, estimates) = (insights.info_level, insights.estimates);
            let [least, most] = estimates.seat_range.unwrap_or([1, 1]);
            Some(Estimates {
                group,
                level,
                as_of: self.simulation.world.market.knowledge[group].snapshot?.day,
                noise: terms.level(level)?.noise,
                budget: estimates.willingness_to_pay,
                usage: estimates.usage_volume,
                floor: estimates.quality_floor_q_min,
                seats: (least as f64, most as f64),
            })
        };
        Group::all().filter(|group| self.simulation.world.market.is_known(*group)).filter_map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;

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

    #[test]
    fn estimates_are_those_of_the_tool_and_their_range_holds_the_mean() {
        let new = NewRun { storage: Storage::Memory, ..NewRun::default() };
        let session = Session::create(new, &Configuration::shipped()).expect("a run");
        let all = session.estimates();
        assert_eq!(all.len(), 6);
        let s1 = all[0];
        let answer = session.look_up(&GetGroupInsights, all[0].group).expect("an answer");
        assert_eq!((s1.group.id(), s1.level, s1.noise), ("S1", 1, 0.65));
        assert_eq!(s1.budget, answer.estimates.willingness_to_pay);
        let mean = session.params().group(s1.group).c_max_mean;
        let (least, most) = s1.range(s1.budget);
        assert!(least <= mean + 0.01 && mean <= most + 0.01, "{least} {mean} {most}");
    }
}
