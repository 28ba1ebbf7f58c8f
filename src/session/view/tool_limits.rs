//! ToolLimits that the documentation of the tools tells everybody: prices, delays, errors and limits.

use super::CompanyView;
use novamind_world::identifiers::Group;
use novamind_world::product::development::targeted_development_gain;
use novamind_world::product::service::outage_probability;

/// A level that a study of a group can reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StudyLevel {
    /// Level, 1..=5; level 1 comes with the discovery.
    pub level: u8,
    /// Dollars, paid at once.
    pub cost: f64,
    /// Days until it is finished.
    pub days: u32,
    /// Largest relative error of an estimate.
    pub noise: f64,
}

/// A capacity tier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapacityTier {
    /// Tier, 0..=7.
    pub tier: u8,
    /// Units a day.
    pub units: f64,
    /// Dollars a day.
    pub cost: f64,
}

/// A model tier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelTier {
    /// Tier, 1..=5.
    pub tier: u8,
    /// Dollars a unit.
    pub unit_cost: f64,
    /// What it multiplies product quality by.
    pub multiplier: f64,
}

/// ToolLimits of the tools.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolLimits {
    /// Longest post, in characters.
    pub post_characters: usize,
    /// Dollars of an attempt at market research.
    pub attempt_cost: f64,
    /// Chance that an attempt finds a group.
    pub attempt_chance: f64,
    /// Levels of knowledge, the lowest first.
    pub levels: Vec<StudyLevel>,
    /// Levels a study may aim at, the least and the highest.
    pub targets: (u8, u8),
    /// Days between two measurements of the economy; the first is that of day 1.
    pub economy_every_days: u32,
    /// Days from a measurement to its publication.
    pub economy_lag_days: u32,
    /// Capacity tiers, the lowest first.
    pub capacities: Vec<CapacityTier>,
    /// Model tiers, the lowest first.
    pub models: Vec<ModelTier>,
    /// Issues of individuals that a day of operations solves: without spending, and for each dollar.
    pub issues_solved: (f64, f64),
    /// Names under which rivals appear in the news.
    pub rivals: Vec<String>,
}

impl ToolLimits {
    /// ToolLimits of a level.
    pub fn level(&self, level: u8) -> Option<&StudyLevel> {
        self.levels.iter().find(|own| own.level == level)
    }

    /// Returns each model tier with its cost, dollars a unit.
    pub fn unit_costs(&self) -> Vec<(u8, f64)> {
        self.models.iter().map(|model| (model.tier, model.unit_cost)).collect()
    }
}

/// A study that was ordered and is not finished.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunningStudy {
    /// Group.
    pub group: Group,
    /// Level it aims at.
    pub target: u8,
    /// Day on which it is finished, as the answer to the order said.
    pub due_day: u32,
}

impl CompanyView<'_> {
    /// Limits of the tools in this run.
    pub fn tool_limits(&self) -> ToolLimits {
        let params = &self.simulation.params;
        let level = |level: &novamind_world::params::InfoLevel| StudyLevel {
            level: level.level,
            cost: level.cost,
            days: level.delay_days,
            noise: level.noise,
        };
        ToolLimits {
            post_characters: params.limits.post_max_chars as usize,
            attempt_cost: params.market_research.discovery_cost_level_1,
            attempt_chance: params.market_research.market_research_discover_prob,
            levels: params.info_level.iter().map(level).collect(),
            targets: (params.group_research.min_target_level, params.group_research.max_target_level),
            economy_every_days: params.economy.macro_pmi_update_interval_days,
            economy_lag_days: params.economy.macro_pmi_publication_delay_days,
            capacities: params
                .capacity_tier
                .iter()
                .map(|tier| CapacityTier {
                    tier: tier.tier,
                    units: f64::from(tier.capacity_units),
                    cost: f64::from(tier.cost_per_day),
                })
                .collect(),
            models: params
                .model_tier
                .iter()
                .map(|tier| ModelTier {
                    tier: tier.tier,
                    unit_cost: tier.unit_cost,
                    multiplier: tier.quality_multiplier,
                })
                .collect(),
            issues_solved: (params.issues.issue_resolution_base_rate, params.issues.individual_ops_scale),
            rivals: params.competitor.competitor_names.clone(),
        }
    }

    /// Share of days with an outage while usage stays within capacity, at a spend on operations of dollars a day.
    pub fn outage_share(&self, operations: f64) -> f64 {
        outage_probability(operations, 0.0, &self.simulation.params.operations)
    }

    /// Quality that a day of targeted development adds for a group before the model's multiplier, at dollars a day.
    pub fn targeted_gain(&self, dollars: f64) -> f64 {
        targeted_development_gain(dollars, &self.simulation.params.development)
    }

    /// Studies that run, in the order they were ordered.
    pub fn running_studies(&self) -> Vec<RunningStudy> {
        let of = |study: &novamind_world::events::Study| RunningStudy {
            group: study.group,
            target: study.target,
            due_day: study.due_day,
        };
        self.simulation.world.market.studies.iter().map(of).collect()
    }
}
