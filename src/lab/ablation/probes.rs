//! Policies that are played against the competitor settings.

use crate::baseline::{PAPER_GRID, PolicyGrid};
use crate::policy::{Policy, PolicyError, RuleBased};
use novamind_world::params::ParameterSource;

/// Returns the probe policy that buys only general development.
///
/// # Errors
/// Fails if the bundled file is invalid.
pub fn shared_development_probe() -> Result<Policy, PolicyError> {
    parse_bundled("shared", include_str!("../../../configs/probes/shared.toml"))
}

/// Returns the probe policy that buys targeted development for one group.
///
/// # Errors
/// Fails if the bundled file is invalid.
pub fn targeted_development_probe() -> Result<Policy, PolicyError> {
    parse_bundled("targeted", include_str!("../../../configs/probes/targeted.toml"))
}

fn parse_bundled(name: &str, text: &str) -> Result<Policy, PolicyError> {
    Policy::parse(&ParameterSource { name: format!("configs/probes/{name}.toml"), text: text.to_owned() })
}

/// Returns the policies of the short runs: the paper's best configuration, and the configuration that advertises from
/// the first day.
///
/// # Errors
/// Fails if a bundled grid is invalid.
pub fn short_run_policies() -> Result<Vec<(&'static str, Policy)>, PolicyError> {
    let of = |grid: &str, wanted: &dyn Fn(&Policy) -> bool| -> Result<Option<Policy>, PolicyError> {
        let all = PolicyGrid::find(grid)?.configurations;
        Ok(all.into_iter().rev().map(|grid_point| grid_point.policy).find(|policy| wanted(policy)))
    };
    let routine = of(PAPER_GRID, &|policy| policy.rule_based == Some(RuleBased::default()))?;
    let from_the_first_day = of("content-ads", &|_| true)?;
    let named = [("the paper's baseline", routine), ("ads from day 0", from_the_first_day)];
    Ok(named.into_iter().filter_map(|(name, policy)| Some((name, policy?))).collect())
}
