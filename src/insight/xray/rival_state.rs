//! The hidden state of competitors: what they can copy, their moves, and the next move.

use super::hidden_day::Banks;
use super::inspector::Inspector;
use novamind_session::{Look, Xray};
use novamind_tools::Refusal;
use novamind_world::events::Severity;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::competitors::{Event, next_move, severity};

/// The next competitor move after a day.
#[derive(Debug, Clone, PartialEq)]
pub struct NextRivalMove {
    /// Day of the move.
    pub day: u32,
    /// Drawn size, after the growth over the run.
    pub sampled: f64,
    /// Share of the shared bank that can be copied.
    pub u: f64,
    /// Share of each targeted bank at the end of the day that is copied; empty after the move.
    pub shares: Vec<(Group, f64)>,
    /// Outcome, if the day has been simulated.
    pub made: Option<Event>,
}

impl NextRivalMove {
    /// Returns the quality that can be copied from a shared bank. It applies if it exceeds the drawn size.
    pub fn copied(&self, bank: f64) -> f64 {
        self.u * bank
    }

    /// Returns the shared bank above which competitors copy.
    pub fn copies_above(&self) -> f64 {
        self.sampled / self.u
    }
}

/// Competitors at the end of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct RivalState {
    /// The day, from 1.
    pub day: u32,
    /// Shared quality gain.
    pub shared_bonus: f64,
    /// Part of it that is not copied.
    pub shared_bank: f64,
    /// Targeted quality gain and the part of it that is not copied, for groups that have any.
    pub own: Vec<(Group, f64, f64)>,
    /// Common addition to expectations by competitors and drift.
    pub everyone: f64,
    /// Past moves with their names.
    pub moves: Vec<(Event, Severity)>,
    /// Next move; `None` if there is none before the end of the run.
    pub next: Option<NextRivalMove>,
}

impl Inspector<'_> {
    /// Returns the competitors at the end of a day, by default the last one. Records the inspection.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`.
    pub fn rival_state(&mut self, day: Option<u32>) -> Result<RivalState, Refusal> {
        let look = Look::begin(self.run, "rivals", "", day)?;
        let day = look.day();
        let seen = self.hidden_day(&look, day)?;
        let Banks { shared_bonus, shared, group_bonus, own } = seen.banks;
        let inside = look.inside(self.run);
        let law = &inside.params().competitor;
        let events = inside.world().market.competitors.iter().copied();
        let moves = events.take_while(|event| event.day <= day);
        let improved = Group::all().filter(|group| group_bonus[*group] != 0.0 || own[*group] != 0.0);
        Ok(RivalState {
            day,
            shared_bonus,
            shared_bank: shared,
            own: improved.map(|group| (group, group_bonus[group], own[group])).collect(),
            everyone: seen.market.drift.global_quality,
            moves: moves.map(|event| (event, severity(event.boost, law))).collect(),
            next: rival_move_after(inside, day, &own),
        })
    }
}

/// Returns the next move after a day: the simulated one, or the one that follows from the current parameters.
pub(super) fn rival_move_after(inside: Xray<'_>, day: u32, banks: &ByGroup<f64>) -> Option<NextRivalMove> {
    let (world, params) = (inside.world(), inside.params());
    let events = &world.market.competitors;
    if let Some(made) = events.iter().copied().find(|event| event.day > day) {
        let Event { day, sampled, u, .. } = made;
        return Some(NextRivalMove { day, sampled, u, shares: Vec::new(), made: Some(made) });
    }
    let last_event = events.last().map(|event| event.day);
    let next = next_move(world.day, world.total_days, last_event, params, inside.streams())?;
    let shares = next.shares(banks, &params.competitor);
    Some(NextRivalMove { day: next.day, sampled: next.sampled, u: next.u, shares, made: None })
}
