//! What the truth behind an estimate can be.

use crate::play::simulation::Simulation;
use novamind_world::command::{Command, ResolvedCommand};
use novamind_world::identifiers::Group;

/// Least and greatest truth behind an estimate that is off by at most a share: it is the truth times 1 ± share.
pub fn truth_behind(estimate: f64, share: f64) -> (f64, f64) {
    let from = estimate / (1.0 + share);
    let to = if share < 1.0 { estimate / (1.0 - share) } else { f64::INFINITY };
    (from.min(to), from.max(to))
}

/// Least and greatest mean floor of a group behind its estimate; none while it is unknown.
pub(super) fn floor_of(group: Group, simulation: &Simulation) -> Option<(f64, f64)> {
    match simulation.resolve(Command::ReadInsights(group)) {
        ResolvedCommand::ReadInsights(Some(insights)) => {
            Some(truth_behind(insights.quality_floor, insights.noise))
        }
        _ => None,
    }
}
