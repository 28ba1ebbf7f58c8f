//! Limits that the documentation of the tools states: prices, delays, errors.

use super::CompanyView;
use novamind_world::identifiers::Group;
use novamind_world::product::development::targeted_development_gain;
use novamind_world::product::service::outage_probability;

/// A study level of a group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StudyLevel {
    /// Level, 1..=5; level 1 is reached by discovery.
    pub level: u8,
    /// Cost in dollars, paid at once.
    pub cost: f64,
    /// Days until completion.
    pub days: u32,
    /// Maximum relative error of an estimate.
    pub noise: f64,
}

/// A capacity tier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapacityTier {
    /// Capacity, units a day.
    pub tier: u8,
    /// Units a day.
    pub units: f64,
    /// Cost, dollars a day.
    pub cost: f64,
}

/// A model tier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelTier {
    /// Tier, 1..=5.
    pub tier: u8,
    /// Cost, dollars a unit.
    pub unit_cost: f64,
    /// Factor of the product quality.
    pub multiplier: f64,
}

/// Limits of the tools.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolLimits {
    /// Maximum length of a post, characters.
    pub post_characters: usize,
    /// Cost of an attempt at market research, dollars.
    pub attempt_cost: f64,
    /// Probability that an attempt finds a group.
    pub attempt_chance: f64,
    /// Study levels, lowest first.
    pub levels: Vec<StudyLevel>,
    /// Lowest and highest level that a study can have as target.
    pub targets: (u8, u8),
    /// Days between two measurements of the economy; the first is on day 1.
    pub economy_every_days: u32,
    /// Days from a measurement to its publication.
    pub economy_lag_days: u32,
    /// Capacity tiers, lowest first.
    pub capacities: Vec<CapacityTier>,
    /// Model tiers, lowest first.
    pub models: Vec<ModelTier>,
    /// Issues of individuals that operations resolve per day: without spending, and per dollar.
    pub issues_solved: (f64, f64),
    /// Names of competitors in the news.
    pub competitors: Vec<String>,
}

impl ToolLimits {
    /// Returns the data of a study level.
    pub fn study_level(&self, level: u8) -> Option<&StudyLevel> {
        self.levels.iter().find(|study_level| study_level.level == level)
    }

    /// Returns each model tier with its cost, dollars a unit.
    pub fn unit_costs(&self) -> Vec<(u8, f64)> {
        self.models.iter().map(|model| (model.tier, model.unit_cost)).collect()
    }
}

/// A running study.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunningStudy {
    /// Group.
    pub group: Group,
    /// Target level.
    pub target: u8,
    /// Day of completion, as returned when it was ordered.
    pub due_day: u32,
}

impl CompanyView<'_> {
    /// Returns the limits of the tools in this run.
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
            competitors: params.competitor.competitor_names.clone(),
        }
    }

    /// Returns the share of days with an outage while demand is within capacity, at a spend on operations in dollars
    /// a day.
    pub fn outage_share(&self, operations: f64) -> f64 {
        outage_probability(operations, 0.0, &self.simulation.params.operations)
    }

    /// Returns the quality that a day of targeted development adds for a group before the model's multiplier, at a
    /// spend in dollars a day.
    pub fn targeted_development_gain(&self, dollars: f64) -> f64 {
        targeted_development_gain(dollars, &self.simulation.params.development)
    }

    /// Returns the running studies, in order of purchase.
    pub fn running_studies(&self) -> Vec<RunningStudy> {
        let of = |study: &novamind_world::events::Study| RunningStudy {
            group: study.group,
            target: study.target,
            due_day: study.due_day,
        };
        self.simulation.world.market.studies.iter().map(of).collect()
    }
}
