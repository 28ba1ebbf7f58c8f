//! Limits that the documentation of the tools states: prices, delays and errors.

use super::CompanyView;
use novamind_world::identifiers::Group;
use novamind_world::product::development::targeted_development_gain;
use novamind_world::product::service::outage_probability;

/// A study level and the cost of reaching it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StudyLevel {
    /// Study level, 1 to 5; level 1 is reached by discovery.
    pub level: u8,
    /// Cost of a study to this level, dollars, paid at once.
    pub cost: f64,
    /// Days from the order to the completion of the study.
    pub days: u32,
    /// Maximum relative error of an estimate at this level.
    pub noise: f64,
}

/// A capacity tier with its capacity and cost.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapacityTier {
    /// Number of the capacity tier.
    pub tier: u8,
    /// Capacity, units per day.
    pub units: f64,
    /// Cost, dollars per day.
    pub cost: f64,
}

/// A model tier with its cost and quality.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelTier {
    /// Number of the model tier, 1 to 5.
    pub tier: u8,
    /// Compute cost, dollars per unit.
    pub unit_cost: f64,
    /// Factor by which the product quality is multiplied.
    pub multiplier: f64,
}

/// Limits and prices that apply to the tools of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolLimits {
    /// Maximum length of a post, in characters.
    pub post_characters: usize,
    /// Cost of an attempt at market research, dollars.
    pub attempt_cost: f64,
    /// Probability that one attempt discovers a group.
    pub attempt_chance: f64,
    /// Study levels, lowest level first.
    pub levels: Vec<StudyLevel>,
    /// Lowest and highest target level of a study.
    pub targets: (u8, u8),
    /// Days between two measurements of the economy; the first measurement is on day 1.
    pub economy_every_days: u32,
    /// Days from a measurement to its publication.
    pub economy_lag_days: u32,
    /// Capacity tiers, lowest tier first.
    pub capacities: Vec<CapacityTier>,
    /// Model tiers, lowest tier first.
    pub models: Vec<ModelTier>,
    /// Issues of individuals that are resolved per day: without operations spending, and per dollar of spending.
    pub issues_solved: (f64, f64),
    /// Names of competitors that appear in the news.
    pub competitors: Vec<String>,
}

impl ToolLimits {
    /// Returns a study level with its cost, duration and error, or `None` if the level does not exist.
    pub fn study_level(&self, level: u8) -> Option<&StudyLevel> {
        self.levels.iter().find(|study_level| study_level.level == level)
    }

    /// Returns each model tier with its compute cost, dollars per unit.
    pub fn unit_costs(&self) -> Vec<(u8, f64)> {
        self.models.iter().map(|model| (model.tier, model.unit_cost)).collect()
    }
}

/// A market study that is not completed yet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RunningStudy {
    /// Group that is studied.
    pub group: Group,
    /// Study level after completion.
    pub target: u8,
    /// Day of completion, as returned when the study was ordered.
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

    /// Returns the share of days with an outage while demand is within capacity. `operations` is the operations
    /// spending in dollars per day.
    pub fn outage_share(&self, operations: f64) -> f64 {
        outage_probability(operations, 0.0, &self.simulation.params.operations)
    }

    /// Returns the quality that one day of targeted development adds for a group, before the quality factor of the
    /// model. `dollars` is the spending per day.
    pub fn targeted_development_gain(&self, dollars: f64) -> f64 {
        targeted_development_gain(dollars, &self.simulation.params.development)
    }

    /// Returns the running market studies, in order of purchase.
    pub fn running_studies(&self) -> Vec<RunningStudy> {
        let of = |study: &novamind_world::events::Study| RunningStudy {
            group: study.group,
            target: study.target,
            due_day: study.due_day,
        };
        self.simulation.world.market.studies.iter().map(of).collect()
    }
}
