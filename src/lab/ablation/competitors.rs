//! Competitor settings of the copying axis and of the draining axis.

use crate::experiment::Arm;
use crate::policy::Policy;
use novamind_record::error::RunError;
use novamind_record::folder::configuration::{Configuration, DEFAULT_SCENARIO};

/// The behavior of competitors in one arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CompetitorSetting {
    /// Name under which tables list the setting.
    pub name: &'static str,
    /// Name of the scenario that configures the competitors.
    pub scenario: &'static str,
    /// Minimum and maximum share of a group's quality bank that a competitor event drains; `None` for the
    /// values of the scenario.
    drain_range: Option<(&'static str, &'static str)>,
}

const fn scenario_setting(name: &'static str, scenario: &'static str) -> CompetitorSetting {
    CompetitorSetting { name, scenario, drain_range: None }
}

const fn drain_setting(name: &'static str, least: &'static str, most: &'static str) -> CompetitorSetting {
    CompetitorSetting { name, scenario: "default", drain_range: Some((least, most)) }
}

/// Settings of the copying axis, from no competitors to hard competitors.
pub const COPY_SETTINGS: [CompetitorSetting; 7] = [
    scenario_setting("off", "competitor-off"),
    scenario_setting("stationary", "competitor-stationary"),
    scenario_setting("u = 0.1", "competitor-u10"),
    scenario_setting("u = 0.2", "competitor-u20"),
    scenario_setting("u = 0.3", "competitor-u30"),
    scenario_setting("default", "default"),
    scenario_setting("hard", "competitor-hard"),
];

/// Settings of the draining axis: drained shares from none to 0.2, and named scenarios for comparison.
pub const DRAIN_SETTINGS: [CompetitorSetting; 6] = [
    scenario_setting("off", "competitor-off"),
    drain_setting("no drain", "0.0", "0.0"),
    drain_setting("drain 0.05", "0.05", "0.05"),
    scenario_setting("default", "default"),
    scenario_setting("hard", "competitor-hard"),
    drain_setting("drain to 0.2", "0.0", "0.2"),
];

/// Returns the index of the arm with which the other arms are compared.
pub fn reference_arm(settings: &[CompetitorSetting]) -> usize {
    settings.iter().position(|competitor_setting| competitor_setting.name == "default").unwrap_or(0)
}

/// Returns one arm per competitor setting. `policy` plays in every arm.
pub fn competitor_arms(policy: &Policy, settings: &[CompetitorSetting], days: u32) -> Vec<Arm> {
    let arm = |competitor_setting: &CompetitorSetting| {
        let mut arm = Arm::new(competitor_setting.name, policy.clone());
        arm.spec.scenario = Some(competitor_setting.scenario.to_owned());
        arm.spec.days = Some(days);
        if let Some((least, most)) = competitor_setting.drain_range {
            let key = |end: &str| format!("competitor.competitor_segment_drain_u_{end}");
            arm.spec.overrides = vec![(key("min"), least.to_owned()), (key("max"), most.to_owned())];
        }
        arm
    };
    settings.iter().map(arm).collect()
}

/// Changes the scenario of arms but keeps their competitors: the differences between an arm's scenario and `default`
/// become overrides.
///
/// # Errors
/// Fails if a scenario is unknown or a parameter is invalid.
pub fn rebase_arms(
    arms: Vec<Arm>,
    scenario: &str,
    configuration: &Configuration,
) -> Result<Vec<Arm>, RunError> {
    let load = |name: &str| configuration.load_parameters(&configuration.load_scenario(name)?, &[], true);
    let default = load(DEFAULT_SCENARIO)?;
    let rebase = |mut arm: Arm| {
        let own = arm.spec.scenario.replace(scenario.to_owned());
        let changes = default.differences(&load(own.as_deref().unwrap_or(DEFAULT_SCENARIO))?);
        let overrides = changes.into_iter().filter_map(|change| Some((change.key, change.new?.to_string())));
        arm.spec.overrides.splice(0..0, overrides);
        Ok(arm)
    };
    arms.into_iter().map(rebase).collect()
}
