//! The policies that rivals are shown against.

use crate::baseline::{Grid, PAPER};
use crate::policy::{Policy, PolicyError, RuleBased};
use novamind_world::params::ParameterSource;

/// The probe whose development is shared by all groups.
///
/// # Errors
/// The shipped file is wrong.
pub fn shared_probe() -> Result<Policy, PolicyError> {
    shipped("shared", include_str!("../../../configs/probes/shared.toml"))
}

/// The probe whose development is for one group.
///
/// # Errors
/// The shipped file is wrong.
pub fn targeted_probe() -> Result<Policy, PolicyError> {
    shipped("targeted", include_str!("../../../configs/probes/targeted.toml"))
}

fn shipped(name: &str, text: &str) -> Result<Policy, PolicyError> {
    Policy::parse(&ParameterSource { name: format!("configs/probes/{name}.toml"), text: text.to_owned() })
}

/// Policies that are played over the short horizon beside the probe: the paper's best configuration, and the one that
/// advertises from the first day.
///
/// # Errors
/// The shipped grids are wrong.
pub fn short_run_policies() -> Result<Vec<(&'static str, Policy)>, PolicyError> {
    let of = |grid: &str, wanted: &dyn Fn(&Policy) -> bool| -> Result<Option<Policy>, PolicyError> {
        let all = Grid::find(grid)?.configurations;
        Ok(all.into_iter().rev().map(|own| own.policy).find(|own| wanted(own)))
    };
    let routine = of(PAPER, &|own| own.rule_based == Some(RuleBased::default()))?;
    let from_the_first_day = of("content-ads", &|_| true)?;
    let named = [("the paper's baseline", routine), ("ads from day 0", from_the_first_day)];
    Ok(named.into_iter().filter_map(|(name, policy)| Some((name, policy?))).collect())
}
