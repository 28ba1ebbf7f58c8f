//! Rivals from within: what they could copy, what they did, and the move that is decided next.

use super::hidden_day::Banks;
use super::inspector::Inspector;
use novamind_session::{Look, Xray};
use novamind_tools::Refusal;
use novamind_world::events::Severity;
use novamind_world::identifiers::{ByGroup, Group};
use novamind_world::market::competitors::{Event, next_move, severity};

/// The next move of rivals after a day.
#[derive(Debug, Clone, PartialEq)]
pub struct NextRivalMove {
    /// Its day.
    pub day: u32,
    /// Size that is drawn, after the growth over the run.
    pub sampled: f64,
    /// Share of the shared bank that they can copy.
    pub u: f64,
    /// Share of each targeted bank of the evening that they copy; empty once the move was made.
    pub shares: Vec<(Group, f64)>,
    /// What came of it, if the day has been simulated.
    pub made: Option<Event>,
}

impl NextRivalMove {
    /// What they could copy of a shared bank: it applies if it is larger than the size that is drawn.
    pub fn copied(&self, bank: f64) -> f64 {
        self.u * bank
    }

    /// The shared bank above which they copy.
    pub fn copies_above(&self) -> f64 {
        self.sampled / self.u
    }
}

/// Rivals on the evening of a day.
#[derive(Debug, Clone, PartialEq)]
pub struct RivalState {
    /// The day, from 1.
    pub day: u32,
    /// Quality gained for everybody.
    pub shared_bonus: f64,
    /// What no rival has copied of it.
    pub shared_bank: f64,
    /// Quality gained for single groups, and what no rival has copied of it; those that have any.
    pub own: Vec<(Group, f64, f64)>,
    /// What rivals and drift have added to everyone's expectations.
    pub everyone: f64,
    /// Moves so far, each with what it is called.
    pub moves: Vec<(Event, Severity)>,
    /// The next one; none before the end of the run.
    pub next: Option<NextRivalMove>,
}

impl Inspector<'_> {
    /// Rivals on the evening of a day, the last one if none is named. The look is recorded.
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

/// The move after a day: the one that was made, or the one that is decided under the parameters in force.
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
