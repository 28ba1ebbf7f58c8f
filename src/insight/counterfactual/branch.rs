//! Re-simulation of days with edits.

use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

use serde_json::{Value, json};

use super::companies::{CallHere, in_other_numbers};
use super::edits::{AddedCall, AddedSetting, Edits, FollowedUsage, Redrawn};
use super::kept_state::KeptState;
use super::script::{Move, PastCall, PastDays, has_replies};
use novamind_record::figures::{MeasuredGroup, WeekFigures};
use novamind_session::GroupWeek;
use novamind_session::engine::{
    ParameterChange, RunDatabase, Simulation, StateHash, Taken, count_groups, measured_group, not_allowed,
    value_of_json,
};
use novamind_tools::{Arguments, Numbers, Refusal, ToolId, View, bounds};
use novamind_world::command::Command;
use novamind_world::events::{DayFigures, LedgerEntry};
use novamind_world::identifiers::ByGroup;
use novamind_world::market::surges::week_end;
use novamind_world::state::World;

/// The results of a re-simulation.
pub(crate) struct BranchOutcome {
    /// Figures of the completed weeks.
    pub weeks: Vec<WeekFigures>,
    /// Figures of every day.
    pub days: Vec<DayFigures>,
    /// Mean satisfaction of individual subscribers at the end of each of these weeks; NaN without subscribers.
    pub satisfaction: Vec<f64>,
    /// Figures of every group in each of these weeks.
    pub groups: Vec<ByGroup<MeasuredGroup>>,
    /// Day and hash of every state that the recorded steps name, if hashes are requested.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare states"))]
    pub states: Vec<(u32, StateHash)>,
    /// Calls that the branch rejects.
    pub refused: Vec<RefusedCall>,
    /// Parameter changes that are invalid in the branch and therefore omitted: day, key, reason.
    pub unfit: Vec<(u32, String, Refusal)>,
    /// Calls that the run rejected and the branch would accept; they are not made.
    pub possible: Vec<PastCall>,
    /// Calls that adjusted the capacity to usage.
    pub followed: Vec<AddedCall>,
    /// The reason if the simulation ended early because a day had too many leads.
    pub crowded: Option<Refusal>,
    /// Final state.
    pub end: KeptState,
}

/// A call that is rejected in a re-simulation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RefusedCall {
    /// Line in the run; `None` for an added call.
    pub seq: Option<u64>,
    /// Decision day.
    pub day: u32,
    /// Tool.
    pub tool: ToolId,
    /// Reason.
    pub refusal: Refusal,
}

/// Re-simulates the days after a state with edits of the recorded steps. Days after the last step keep the current settings.
/// `progress` is called once per simulated day. Returns `None` if it stops the simulation.
pub(crate) fn counterfactual(
    start: &KeptState,
    moves: &[Move],
    edits: &Edits,
    until: u32,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Option<BranchOutcome> {
    let mut branch = OpenBranch::of(start, moves, edits, false);
    branch.advance(until, progress)?;
    Some(branch.outcome())
}

/// Re-simulates days like [`counterfactual`] and computes the hash of every state that the recorded steps name.
#[cfg(test)]
pub(crate) fn counterfactual_with_hashes(
    start: &KeptState,
    moves: &[Move],
    edits: &Edits,
    until: u32,
) -> Option<BranchOutcome> {
    let mut branch = OpenBranch::of(start, moves, edits, true);
    branch.advance(until, &mut |_| ControlFlow::Continue(()))?;
    Some(branch.outcome())
}

/// Returns the first day up to `until` at whose end two edits of the same steps have different states, or an inner `None` if there is
/// none. Returns an outer `None` if `progress`, called once per simulated day, stops the simulation.
pub(crate) fn first_difference(
    start: &KeptState,
    moves: &[Move],
    (one, other): (&Edits, &Edits),
    until: u32,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Option<Option<u32>> {
    let mut both = [one, other].map(|edits| OpenBranch::of(start, moves, edits, false));
    for day in start.world.day + 1..=until {
        for branch in &mut both {
            branch.advance(day, progress)?;
        }
        let [left, right] = both.each_ref().map(|branch| branch.simulation.world.part_hashes());
        if left != right {
            return Some(Some(day));
        }
    }
    Some(None)
}

/// A re-simulation in progress.
struct OpenBranch<'a> {
    edits: &'a Edits,
    moves: &'a [Move],
    simulation: Simulation,
    /// Discards all output.
    projection: RunDatabase,
    week: WeekFigures,
    /// Figures of the current week by group.
    group_week: ByGroup<GroupWeek>,
    /// Cash at the start of the week.
    cash_before: f64,
    /// Ledger entries of calls since the last day.
    called: Vec<LedgerEntry>,
    /// Whether posts are worded and facts are hashed.
    told: bool,
    /// Whether this is still to be done for the last day.
    left_to_tell: bool,
    numbers: OnceLock<Arc<Numbers>>,
    weeks: Vec<WeekFigures>,
    days: Vec<DayFigures>,
    satisfaction: Vec<f64>,
    groups: Vec<ByGroup<MeasuredGroup>>,
    states: Vec<(u32, StateHash)>,
    refused: Vec<RefusedCall>,
    unfit: Vec<(u32, String, Refusal)>,
    possible: Vec<PastCall>,
    followed: Vec<AddedCall>,
    /// Reason why no further day is simulated.
    crowded: Option<Refusal>,
}

impl<'a> OpenBranch<'a> {
    fn of(start: &KeptState, moves: &'a [Move], edits: &'a Edits, hashed: bool) -> OpenBranch<'a> {
        let told = hashed || has_replies(moves);
        let params = edits.params.as_ref().unwrap_or(&start.params).clone();
        let feed = if told { start.feed.clone() } else { Default::default() };
        let overrides = start.overrides.over(&params, &edits.dropped);
        let given = (start.streams.clone(), start.names.clone());
        let simulation = Simulation::at((params, overrides), given, start.world.clone(), feed);
        let mut branch = OpenBranch {
            edits,
            moves,
            cash_before: simulation.world.finance.cash,
            simulation,
            projection: RunDatabase::default(),
            week: WeekFigures::default(),
            group_week: ByGroup::default(),
            called: Vec::new(),
            told,
            left_to_tell: false,
            numbers: OnceLock::new(),
            weeks: Vec::new(),
            days: Vec::new(),
            satisfaction: Vec::new(),
            groups: Vec::new(),
            states: Vec::new(),
            refused: Vec::new(),
            unfit: Vec::new(),
            possible: Vec::new(),
            followed: Vec::new(),
            crowded: None,
        };
        branch.open();
        branch
    }

    /// Makes the calls that precede all steps.
    fn open(&mut self) {
        for (tool, args) in &self.edits.opening {
            self.try_new(*tool, args);
        }
    }

    /// Executes steps and simulates days up to the end of a day.
    fn advance(&mut self, until: u32, progress: &mut dyn FnMut(u32) -> ControlFlow<()>) -> Option<()> {
        while let [step, rest @ ..] = self.moves
            && !self.is_over()
        {
            match step {
                // Decisions on the last day belong to the next day.
                Move::Call(call) if call.day >= until => break,
                Move::Parameter(setting) if setting.day >= until => break,
                Move::Call(call) => self.make(call),
                Move::Parameter(setting) if self.edits.dropped.contains(&setting.change.seq) => {}
                Move::Parameter(setting) => self.set(setting.change.clone()),
                Move::Days(days) => {
                    self.simulation.take_scores(&days.scores);
                    self.run_days(days.until.min(until), progress)?;
                    if days.until > until {
                        break;
                    }
                    self.close(days);
                }
            }
            self.moves = rest;
        }
        self.run_days(until, progress)
    }

    /// Makes a recorded call with its edits.
    fn make(&mut self, call: &PastCall) {
        if self.edits.dropped.contains(&call.seq) {
            return;
        }
        let changed = self.edits.changed.get(&call.seq);
        if !call.accepted && changed.is_none() {
            let here = self.here(call.tool, &call.args);
            if here.args.is_some_and(|args| self.plan(call.tool, &args, true).is_ok()) {
                self.possible.push(call.clone());
            }
            return;
        }
        self.call(Some(call.seq), call.tool, changed.unwrap_or(&call.args), changed.is_some());
    }

    fn try_new(&mut self, tool: ToolId, args: &Value) {
        self.call(None, tool, args, true);
    }

    /// Returns a call with the customer numbers of the branch.
    fn here(&self, tool: ToolId, args: &Value) -> CallHere {
        match &self.edits.meant {
            None => CallHere { args: Some(args.clone()), absent: Vec::new() },
            Some(meant) => CallHere::of(tool, args, meant, &self.simulation.world.customers.numbers),
        }
    }

    /// Plans a call. Only added calls are checked against argument bounds, because recorded ones were accepted before.
    fn plan(&self, tool: ToolId, args: &Value, is_new: bool) -> Result<Command, Refusal> {
        let Simulation { world, params, feed, .. } = &self.simulation;
        let numbers = || self.numbers.get_or_init(|| Numbers::of(params).into()).clone();
        let tool = tool.tool();
        let given = Arguments::of(tool.spec(), args, numbers)?;
        if is_new {
            bounds::hold(tool.spec(), &given)?;
        }
        let planned = tool.plan(&View::new(world, params).with_posts(&feed.posts), &given)?;
        Ok(planned.command)
    }

    /// Makes a call and records its rejections.
    fn call(&mut self, seq: Option<u64>, tool: ToolId, args: &Value, is_new: bool) {
        let CallHere { args: here, absent } = self.here(tool, args);
        let is_renumbered = here.as_ref().is_some_and(|here| here != args);
        let refusal = here.and_then(|here| self.carry_out(tool, &here, is_new).err());
        let refusal = refusal.map(|refusal| if is_renumbered { in_other_numbers(refusal) } else { refusal });
        let day = self.simulation.world.day;
        let refused = absent.into_iter().chain(refusal);
        self.refused.extend(refused.map(|refusal| RefusedCall { seq, day, tool, refusal }));
    }

    fn carry_out(&mut self, tool: ToolId, args: &Value, is_new: bool) -> Result<(), Refusal> {
        let command = self.plan(tool, args, is_new)?;
        let resolved = self.simulation.resolve(command);
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

    /// Sets a parameter. Omits a value that is invalid in the branch, including one for a later day.
    fn set(&mut self, change: ParameterChange) {
        let (day, key) = (self.simulation.world.day, change.key.clone());
        match self.simulation.overrides.take(&self.simulation.params, change) {
            Ok(Taken { now, .. }) => {
                self.simulation.use_params(now, self.projection.entries());
                self.numbers = OnceLock::new();
            }
            Err(unfit) => self.unfit.push((day, key, not_allowed(unfit))),
        }
    }

    /// Sets an added parameter.
    fn set_anew(&mut self, setting: &AddedSetting) {
        let value = value_of_json(&setting.value);
        // No event sets it, so it needs a number that no event has.
        let change =
            |value| ParameterChange { seq: u64::MAX, key: setting.key.clone(), value, from_day: None };
        value.map(change).into_iter().for_each(|change| self.set(change));
    }

    fn run_days(&mut self, until: u32, progress: &mut dyn FnMut(u32) -> ControlFlow<()>) -> Option<()> {
        while self.simulation.world.day < until && !self.is_over() {
            self.follow_edits();
            self.crowded = self.simulation.refuse_crowded_day().err();
            if self.crowded.is_some() {
                break;
            }
            self.run_day();
            if progress(self.simulation.world.day).is_break() {
                return None;
            }
        }
        Some(())
    }

    fn is_over(&self) -> bool {
        self.crowded.is_some() || self.simulation.world.is_over(&self.simulation.params)
    }

    /// Applies the edits of this day: parameters, calls, capacity that follows usage, and redrawn random draws.
    fn follow_edits(&mut self) {
        let (day, edits) = (self.simulation.world.day, self.edits);
        edits.set.iter().filter(|setting| setting.day == day).for_each(|setting| self.set_anew(setting));
        for AddedCall { tool, args, .. } in edits.added.iter().filter(|added| added.day == day) {
            self.try_new(*tool, args);
        }
        if let Some(FollowedUsage { rule, from }) = edits.capacity
            && self.week.days_run == 0
            && day >= from
        {
            let now = self.simulation.world.settings.core.capacity_tier;
            let before = self.weeks.last().or(edits.week_before.as_ref());
            let tier = rule.tier(now, before, &self.simulation.params);
            if tier != now {
                let args = json!({ "tier": tier });
                self.try_new(ToolId::SetCapacityTier, &args);
                self.followed.push(AddedCall { day, tool: ToolId::SetCapacityTier, args });
            }
        }
        if let Some(Redrawn { after, salt }) = edits.redrawn
            && day == after
        {
            self.simulation.streams = self.simulation.streams.redrawn(salt, after);
        }
    }

    fn run_day(&mut self) {
        let day_before = self.left_to_tell.then(Vec::new);
        let params = self.simulation.params.clone();
        let figures = self.simulation.simulate_day(&self.edits.held, self.projection.entries(), day_before);
        if !Arc::ptr_eq(&params, &self.simulation.params) {
            self.numbers = OnceLock::new();
        }
        self.left_to_tell = self.told;
        self.simulation.judge_own_posts(self.projection.entries());
        let Simulation { facts, params, world, .. } = &self.simulation;
        self.week.count(&figures, facts, &self.called, params);
        count_groups(&mut self.group_week, &figures, facts, world);
        self.called.clear();
        self.days.push(figures);
        let days_per_week = params.run.days_per_week;
        if world.day == week_end(world.day, days_per_week, world.total_days) || world.is_over(params) {
            self.settle();
        }
    }

    fn settle(&mut self) {
        let cash = self.simulation.world.finance.cash;
        self.week.cash_change = cash - self.cash_before;
        self.week.open_issues = self.simulation.open_issues();
        self.weeks.push(std::mem::take(&mut self.week));
        let (world, counted) = (&self.simulation.world, std::mem::take(&mut self.group_week));
        self.satisfaction.push(mean_satisfaction(world));
        self.groups.push(ByGroup::from_fn(|group| measured_group(group, &counted[group], world)));
        self.cash_before = cash;
    }

    fn close(&mut self, days: &PastDays) {
        if !self.told {
            return;
        }
        let left = std::mem::take(&mut self.left_to_tell).then(Vec::new);
        let state = self.simulation.end_days(self.projection.entries(), left);
        self.states.push((days.until, state));
        self.simulation.close_facts();
    }

    fn outcome(self) -> BranchOutcome {
        let OpenBranch {
            simulation,
            weeks,
            days,
            satisfaction,
            groups,
            states,
            refused,
            unfit,
            possible,
            followed,
            crowded,
            ..
        } = self;
        let end = KeptState::of(simulation);
        BranchOutcome {
            weeks,
            days,
            satisfaction,
            groups,
            states,
            refused,
            unfit,
            possible,
            followed,
            crowded,
            end,
        }
    }
}

/// Returns the mean satisfaction of individual subscribers; NaN without subscribers.
fn mean_satisfaction(world: &World) -> f64 {
    let individuals = || world.customers.blocks().filter(|(group, _)| !group.is_enterprise());
    let count: usize = individuals().map(|(_, block)| block.len()).sum();
    let sum: f64 = individuals().flat_map(|(_, block)| &block.satisfaction).sum();
    sum / count as f64
}
