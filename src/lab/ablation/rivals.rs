//! Competitor settings of the two axes: copying and draining.

use crate::experiment::Arm;
use crate::policy::Policy;

/// The competitor behavior of an arm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RivalSetting {
    /// Name in tables.
    pub name: &'static str,
    /// Scenario.
    pub scenario: &'static str,
    /// Minimum and maximum share of a targeted bank that an event drains; `None`: from the scenario.
    drain: Option<(&'static str, &'static str)>,
}

const fn scenario(name: &'static str, scenario: &'static str) -> RivalSetting {
    RivalSetting { name, scenario, drain: None }
}

const fn drain(name: &'static str, least: &'static str, most: &'static str) -> RivalSetting {
    RivalSetting { name, scenario: "default", drain: Some((least, most)) }
}

/// Settings of the copying axis, from no competitors to hard ones.
pub const COPY: [RivalSetting; 7] = [
    scenario("off", "competitor-off"),
    scenario("stationary", "competitor-stationary"),
    scenario("u = 0.1", "competitor-u10"),
    scenario("u = 0.2", "competitor-u20"),
    scenario("u = 0.3", "competitor-u30"),
    scenario("default", "default"),
    scenario("hard", "competitor-hard"),
];

/// Settings of the draining axis, plus hard competitors for comparison.
pub const DRAIN: [RivalSetting; 6] = [
    scenario("off", "competitor-off"),
    drain("no drain", "0.0", "0.0"),
    drain("drain 0.05", "0.05", "0.05"),
    scenario("default", "default"),
    scenario("hard", "competitor-hard"),
    drain("drain to 0.2", "0.0", "0.2"),
];

/// Name of the arm that the others are compared with.
pub fn reference(settings: &[RivalSetting]) -> usize {
    settings.iter().position(|own| own.name == "default").unwrap_or(0)
}

/// Returns the arms in which a policy plays each competitor setting.
pub fn arms(policy: &Policy, settings: &[RivalSetting], days: u32) -> Vec<Arm> {
    let arm = |own: &RivalSetting| {
        let mut arm = Arm::new(own.name, policy.clone());
        arm.spec.scenario = Some(own.scenario.to_owned());
        arm.spec.days = Some(days);
        if let Some((least, most)) = own.drain {
            let key = |end: &str| format!("competitor.competitor_segment_drain_u_{end}");
            arm.spec.overrides = vec![(key("min"), least.to_owned()), (key("max"), most.to_owned())];
        }
        arm
    };
    settings.iter().map(arm).collect()
}
