//! Expected duration and gain of an R&D project before its purchase. The values are derived from the parameters in
//! force, not from random draws of the run.

use serde::Serialize;

use super::CompanyView;
use novamind_record::mode::Mode;
use novamind_world::params::ResearchTier;
use novamind_world::product::research_distribution::{
    duration_quantile, gain_quantile, mean_days, mean_gain, share_at_minimum_gain, share_done_within,
};

/// The expected duration and gain of an R&D project that is started now.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ResearchOutlook {
    /// First possible day of completion.
    pub earliest: u32,
    /// Last day of the run.
    pub last_day: u32,
    /// Mean duration and gain of projects of the tier.
    pub means: ResearchMeans,
    /// Distribution of duration and gain; `None` in baseline runs, because agents do not receive the distribution.
    pub spread: Option<ResearchSpread>,
}

/// Mean duration and gain of R&D projects of a tier, with the minimum duration and gain applied.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ResearchMeans {
    /// Mean duration, days.
    pub days: f64,
    /// Mean quality gain.
    pub gain: f64,
    /// Whether both means are lower bounds, as in baseline runs, because agents receive only means without the spread.
    pub are_lower_bounds: bool,
}

/// Distribution of duration and gain of R&D projects of a tier that are started now.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ResearchSpread {
    /// Share of projects that finish on the first possible day, 0 to 1.
    pub at_earliest: f64,
    /// Days by which 25 %, 50 % and 75 % of projects finish.
    pub quartile_days: [u32; 3],
    /// Share of projects that finish by the last day of the run, 0 to 1.
    pub by_last_day: f64,
    /// Quality gains that 25 %, 50 % and 75 % of projects do not exceed.
    pub quartile_gains: [f64; 3],
    /// Minimum quality gain.
    pub least_gain: f64,
    /// Share of projects with the minimum gain, 0 to 1.
    pub at_least_gain: f64,
}

/// An R&D project that will not finish by the last day.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct LateProject {
    /// ID of the project.
    pub id: String,
    /// Day on which the project will finish.
    pub due_day: u32,
    /// Whether the project was started since the last week.
    pub is_new: bool,
}

const QUARTILES: [f64; 3] = [0.25, 0.5, 0.75];

impl CompanyView<'_> {
    /// Returns the expected duration and gain of a project that is started now. R&D tiers are 1 to 20.
    pub fn research_outlook(&self, tier: u8) -> ResearchOutlook {
        let (today, last_day) = (self.simulation.world.day, self.manifest.days);
        let (research_tier, development) =
            (self.simulation.params.research_tier(tier), &self.simulation.params.development);
        let spread = || {
            let left = last_day.saturating_sub(today);
            ResearchSpread {
                at_earliest: share_done_within(development.rd_min_duration_days, research_tier, development),
                quartile_days: QUARTILES
                    .map(|share| today + duration_quantile(share, research_tier, development)),
                by_last_day: share_done_within(left, research_tier, development),
                quartile_gains: QUARTILES.map(|share| gain_quantile(share, research_tier, development)),
                least_gain: development.rd_min_quality_boost,
                at_least_gain: share_at_minimum_gain(research_tier, development),
            }
        };
        ResearchOutlook {
            earliest: today + development.rd_min_duration_days,
            last_day,
            means: self.tier_means(research_tier),
            spread: (self.manifest.mode != Mode::Baseline).then(spread),
        }
    }

    /// Returns the mean duration and gain of every R&D tier, lowest tier first.
    pub fn research_means(&self) -> Vec<ResearchMeans> {
        self.simulation.params.research_tier.iter().map(|tier| self.tier_means(tier)).collect()
    }

    fn tier_means(&self, tier: &ResearchTier) -> ResearchMeans {
        let development = &self.simulation.params.development;
        match self.manifest.mode {
            Mode::Baseline => ResearchMeans {
                days: tier.mean_days.max(f64::from(development.rd_min_duration_days)),
                gain: tier.mean_quality_boost.max(development.rd_min_quality_boost),
                are_lower_bounds: true,
            },
            _ => ResearchMeans {
                days: mean_days(tier, development),
                gain: mean_gain(tier, development),
                are_lower_bounds: false,
            },
        }
    }

    /// Returns the projects that will finish after the last day. The completion days are not hidden: the tool call
    /// that started a project returned the completion day.
    pub(crate) fn late_projects(&self) -> Vec<LateProject> {
        let (today, last_day) = (self.simulation.world.day, self.manifest.days);
        let projects = self.simulation.world.product.research.iter();
        let late = projects.filter(|project| project.completed_day.is_none() && project.due_day > last_day);
        let late_project = |project: &novamind_world::events::Project| LateProject {
            id: project.id(),
            due_day: project.due_day,
            is_new: project.started_day == today,
        };
        late.map(late_project).collect()
    }
}
