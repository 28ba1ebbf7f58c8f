//! The hidden state of competitors: the improvements that they can copy, their past moves, and their next move.

use super::hidden_day::QualityBanks;
use super::inspector::Inspector;
use novamind_session::{HiddenState, InspectionPermit};
use novamind_tools::Rejection;
use novamind_world::events::Severity;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::competitors::{CompetitorEvent, next_move, severity};

/// The first competitor move after a given day.
#[derive(Debug, Clone, PartialEq)]
pub struct NextCompetitorMove {
    /// Day of the next move.
    pub day: u32,
    /// Random size of the move, scaled by the growth of moves over the run.
    pub sampled_size: f64,
    /// Share of the shared quality bank that can be copied.
    pub copied_share: f64,
    /// Share of each group's quality bank that will be copied, by group; empty after the move.
    pub group_shares: Vec<(Group, f64)>,
    /// Outcome of the move, if its day has been simulated.
    pub outcome: Option<CompetitorEvent>,
}

impl NextCompetitorMove {
    /// Returns the quality that competitors can copy from a shared bank. Competitors copy this quality only if it
    /// exceeds the sampled size.
    pub fn copied_quality(&self, bank: f64) -> f64 {
        self.copied_share * bank
    }

    /// Returns the size of the shared bank above which competitors copy.
    pub fn copy_threshold(&self) -> f64 {
        self.sampled_size / self.copied_share
    }
}

/// The state of the competitors at the end of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct CompetitorState {
    /// Day of the state, from 1.
    pub day: u32,
    /// Quality that improvements added for all groups.
    pub shared_bonus: f64,
    /// Part of [`CompetitorState::shared_bonus`] that competitors have not copied.
    pub shared_bank: f64,
    /// For each group with targeted improvements: the group, the quality gain, and the part that competitors have not
    /// copied.
    pub group_banks: Vec<(Group, f64, f64)>,
    /// Increase in the expectations of all groups due to competitors and drift.
    pub common_expectation: f64,
    /// Moves up to the day, each with its severity, in ascending order of day.
    pub moves: Vec<(CompetitorEvent, Severity)>,
    /// Next move; `None` if no move follows before the end of the run.
    pub next_move: Option<NextCompetitorMove>,
}

impl Inspector<'_> {
    /// Returns the state of the competitors at the end of a day, by default the last day. Records the inspection in
    /// the trajectory.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn competitor_state(&mut self, day: Option<u32>) -> Result<CompetitorState, Rejection> {
        let permit = InspectionPermit::start(self.run, "rivals", "", day)?;
        let day = permit.day();
        let seen = self.hidden_day(&permit, day)?;
        let QualityBanks { shared_bonus, shared, group_bonus, group_banks: values } = seen.banks;
        let inside = permit.hidden_state(self.run);
        let competitor = &inside.params().competitor;
        let events = inside.world().market.competitors.iter().copied();
        let moves = events.take_while(|event| event.day <= day);
        let improved = Group::all().filter(|group| group_bonus[*group] != 0.0 || values[*group] != 0.0);
        Ok(CompetitorState {
            day,
            shared_bonus,
            shared_bank: shared,
            group_banks: improved.map(|group| (group, group_bonus[group], values[group])).collect(),
            common_expectation: seen.market.drift.global_quality,
            moves: moves.map(|event| (event, severity(event.boost, competitor))).collect(),
            next_move: next_competitor_move(inside, day, &values),
        })
    }
}

/// Returns the next competitor move after a day. A move that is not simulated yet is predicted from the current
/// parameters.
pub(super) fn next_competitor_move(
    inside: HiddenState<'_>,
    day: u32,
    banks: &ByGroup<f64>,
) -> Option<NextCompetitorMove> {
    let (world, params) = (inside.world(), inside.params());
    let events = &world.market.competitors;
    if let Some(made) = events.iter().copied().find(|event| event.day > day) {
        let CompetitorEvent { day, sampled, u, .. } = made;
        return Some(NextCompetitorMove {
            day,
            sampled_size: sampled,
            copied_share: u,
            group_shares: Vec::new(),
            outcome: Some(made),
        });
    }
    let last_event = events.last().map(|event| event.day);
    let next = next_move(world.day, world.total_days, last_event, params, inside.streams())?;
    let shares = next.copied_group_shares(banks, &params.competitor);
    Some(NextCompetitorMove {
        day: next.day,
        sampled_size: next.sampled,
        copied_share: next.u,
        group_shares: shares,
        outcome: None,
    })
}
