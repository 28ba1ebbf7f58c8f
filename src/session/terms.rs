//! Terms that the documentation of the tools tells everybody: prices, delays, errors and limits.

use super::Session;
use crate::world::identifiers::Group;

/// A level that a study of a group can reach (chapter 50 §4.5).
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

/// Terms of the tools.
#[derive(Debug, Clone, PartialEq)]
pub struct Terms {
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
    /// Names under which rivals appear in the news.
    pub rivals: Vec<String>,
}

impl Terms {
    /// Terms of a level.
    pub fn level(&self, level: u8) -> Option<&StudyLevel> {
        self.levels.iter().find(|own| own.level == level)
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

impl Session {
    /// Terms of the tools in this run.
    pub fn terms(&self) -> Terms {
        let params = &self.params;
        let level = |level: &crate::world::params::InfoLevel| StudyLevel {
            level: level.level,
            cost: level.cost,
            days: level.delay_days,
            noise: level.noise,
        };
        Terms {
            post_characters: params.limits.post_max_chars as usize,
            attempt_cost: params.market_research.discovery_cost_level_1,
            attempt_chance: params.market_research.market_research_discover_prob,
            levels: params.info_level.iter().map(level).collect(),
            targets: (params.group_research.min_target_level, params.group_research.max_target_level),
            economy_every_days: params.economy.macro_pmi_update_interval_days,
            economy_lag_days: params.economy.macro_pmi_publication_delay_days,
            rivals: params.competitor.competitor_names.clone(),
        }
    }

    /// Studies that run, in the order they were ordered.
    pub fn running_studies(&self) -> Vec<RunningStudy> {
        let of = |study: &crate::world::market::studies::Study| RunningStudy {
            group: study.group,
            target: study.target,
            due_day: study.due_day,
        };
        self.world.market.studies.iter().map(of).collect()
    }
}
