//! Days that are simulated again.

use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

use serde_json::Value;

use super::edits::{AddedCall, Edits};
use super::kept_state::KeptState;
use super::script::{Move, PastDays, has_replies};
use crate::session::figures::week::WeekFigures;
use crate::session::play::facts_chain::StateHash;
use crate::session::play::overrides::{ParameterChange, Taken};
use crate::session::play::projection::Projection;
use crate::session::play::simulation::Simulation;
use crate::tools::bounds;
use crate::tools::{Arguments, Numbers, Refusal, ToolId, View};
use crate::world::events::{DayFigures, LedgerEntry};
use crate::world::held::Held;
use crate::world::market::surges::week_end;

/// What came of days that were simulated again.
pub(in crate::session) struct BranchOutcome {
    /// Figures of the weeks that ended.
    pub weeks: Vec<WeekFigures>,
    /// Figures of every day.
    pub days: Vec<DayFigures>,
    /// Day and hash of every state that the moves of the run named, where hashes were asked for.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare states"))]
    pub states: Vec<(u32, StateHash)>,
    /// Calls that are refused now: their line, none for one that was added; tool, refusal.
    #[cfg_attr(not(test), expect(dead_code, reason = "causes take what is still possible"))]
    pub refused: Vec<(Option<u64>, ToolId, Refusal)>,
    /// Where it ended.
    pub end: KeptState,
}

/// Simulates the days after a moment again, up to one of them: the moves of the run under some edits; days that the moves do
/// not reach pass under the settings in force. None if it was stopped: `progress` is told each day.
pub(in crate::session) fn counterfactual(
    start: &KeptState,
    moves: &[Move],
    edits: &Edits,
    until: u32,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Option<BranchOutcome> {
    play(OpenBranch::of(start, moves, edits, false), moves, edits, until, progress)
}

/// The same, with the hash of every state that the moves name.
#[cfg(test)]
pub(in crate::session) fn counterfactual_with_hashes(
    start: &KeptState,
    moves: &[Move],
    edits: &Edits,
    until: u32,
) -> Option<BranchOutcome> {
    play(OpenBranch::of(start, moves, edits, true), moves, edits, until, &mut |_| ControlFlow::Continue(()))
}

fn play(
    mut branch: OpenBranch,
    moves: &[Move],
    edits: &Edits,
    until: u32,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Option<BranchOutcome> {
    for step in moves {
        match step {
            Move::Call(call) if !call.accepted || edits.dropped.contains(&call.seq) => {}
            Move::Call(call) => {
                let args = edits.changed.get(&call.seq).unwrap_or(&call.args);
                let changed = edits.changed.contains_key(&call.seq);
                if let Err(refusal) = branch.call(call.tool, args, changed) {
                    branch.refused.push((Some(call.seq), call.tool, refusal));
                }
            }
            Move::Parameter(setting) if edits.dropped.contains(&setting.change.seq) => {}
            Move::Parameter(setting) => branch.set(&setting.change),
            Move::Days(days) => {
                branch.run_days(days.until.min(until), edits, progress)?;
                branch.close(days);
            }
        }
    }
    branch.run_days(until, edits, progress)?;
    Some(branch.outcome())
}

/// Days on the way.
struct OpenBranch {
    simulation: Simulation,
    /// Nothing is written.
    projection: Projection,
    /// The week that runs.
    week: WeekFigures,
    /// Cash before it.
    cash_before: f64,
    /// Money that calls moved since the last day.
    called: Vec<LedgerEntry>,
    /// Whether posts are put into words and facts are hashed.
    told: bool,
    /// Whether that is left to be done of the last day.
    left_to_tell: bool,
    numbers: OnceLock<Arc<Numbers>>,
    weeks: Vec<WeekFigures>,
    days: Vec<DayFigures>,
    states: Vec<(u32, StateHash)>,
    refused: Vec<(Option<u64>, ToolId, Refusal)>,
}

impl OpenBranch {
    fn of(start: &KeptState, moves: &[Move], edits: &Edits, hashed: bool) -> OpenBranch {
        let told = hashed || has_replies(moves);
        let params = edits.params.as_ref().unwrap_or(&start.params).clone();
        let feed = if told { start.feed.clone() } else { Default::default() };
        let overrides = start.overrides.over(&params, &edits.dropped);
        let given = (start.streams.clone(), start.names.clone());
        let simulation = Simulation::at((params, overrides), given, start.world.clone(), feed);
        OpenBranch {
            cash_before: simulation.world.finance.cash,
            simulation,
            projection: Projection::default(),
            week: WeekFigures::default(),
            called: Vec::new(),
            told,
            left_to_tell: false,
            numbers: OnceLock::new(),
            weeks: Vec::new(),
            days: Vec::new(),
            states: Vec::new(),
            refused: Vec::new(),
        }
    }

    /// Makes a call; a new one keeps the bounds of arguments, one of the run was accepted once.
    fn call(&mut self, tool: ToolId, args: &Value, is_new: bool) -> Result<(), Refusal> {
        let Simulation { world, params, feed, .. } = &self.simulation;
        let numbers = || self.numbers.get_or_init(|| Numbers::of(params).into()).clone();
        let tool = tool.tool();
        let given = Arguments::of(tool.spec(), args, numbers)?;
        if is_new {
            bounds::hold(tool.spec(), &given)?;
        }
        let planned = tool.plan(&View::new(world, params).with_posts(&feed.posts), &given)?;
        let resolved = self.simulation.resolve(planned.command);
        if resolved.only_reads() {
            return Ok(());
        }
        self.simulation.apply(resolved, self.projection.entries());
        self.called.extend_from_slice(&self.simulation.facts.ledger);
        if self.told {
            self.simulation.follow_call(self.projection.entries(), Vec::new(), None);
        }
        Ok(())
    }

    /// Sets a parameter. A value that does not fit the parameters of the branch is left out, as one that waits is.
    fn set(&mut self, change: &ParameterChange) {
        let taken = self.simulation.overrides.take(&self.simulation.params, change.clone());
        if let Ok(Taken { now, .. }) = taken {
            self.simulation.use_params(now, self.projection.entries());
            self.numbers = OnceLock::new();
        }
    }

    fn run_days(
        &mut self,
        until: u32,
        edits: &Edits,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Option<()> {
        while self.simulation.world.day < until && !self.simulation.world.is_over(&self.simulation.params) {
            self.add_calls(edits);
            self.run_day(&edits.held);
            if progress(self.simulation.world.day).is_break() {
                return None;
            }
        }
        Some(())
    }

    /// Makes the calls that are added on this day; they keep the bounds of new calls.
    fn add_calls(&mut self, edits: &Edits) {
        let day = self.simulation.world.day;
        for AddedCall { tool, args, .. } in edits.added.iter().filter(|added| added.day == day) {
            if let Err(refusal) = self.call(*tool, args, true) {
                self.refused.push((None, *tool, refusal));
            }
        }
    }

    fn run_day(&mut self, held: &Held) {
        let day_before = self.left_to_tell.then(Vec::new);
        let params = self.simulation.params.clone();
        let figures = self.simulation.simulate_day(held, self.projection.entries(), day_before);
        if !Arc::ptr_eq(&params, &self.simulation.params) {
            self.numbers = OnceLock::new();
        }
        self.left_to_tell = self.told;
        self.simulation.judge_own_posts(self.projection.entries());
        let Simulation { facts, params, world, .. } = &self.simulation;
        self.week.count(&figures, facts, &self.called, params);
        self.called.clear();
        self.days.push(figures);
        let days_per_week = params.run.days_per_week;
        if world.day == week_end(world.day, days_per_week, world.total_days) || world.is_over(params) {
            self.settle();
        }
    }

    /// Ends a week.
    fn settle(&mut self) {
        let cash = self.simulation.world.finance.cash;
        self.week.cash_change = cash - self.cash_before;
        self.week.open_issues = self.simulation.open_issues();
        self.weeks.push(std::mem::take(&mut self.week));
        self.cash_before = cash;
    }

    /// Ends days as a line of the run did.
    fn close(&mut self, days: &PastDays) {
        if !self.told {
            return;
        }
        let left = std::mem::take(&mut self.left_to_tell).then(Vec::new);
        let state = self.simulation.end_days(self.projection.entries(), left);
        self.states.push((days.until, state));
        self.simulation.facts_chain.close();
    }

    fn outcome(self) -> BranchOutcome {
        let OpenBranch { simulation, weeks, days, states, refused, .. } = self;
        BranchOutcome { weeks, days, states, refused, end: KeptState::of(simulation) }
    }
}
