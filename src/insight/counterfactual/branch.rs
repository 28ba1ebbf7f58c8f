//! Re-simulation of recorded days with edits.

use std::ops::ControlFlow;
use std::sync::{Arc, OnceLock};

use serde_json::{Value, json};

use super::customer_renumbering::{RenumberedCall, add_branch_number_note};
use super::due_bills::{DueByIssue, DueToday};
use super::edits::{AddedCall, AddedSetting, Edits, Redraw, UsageBasedCapacity};
use super::memory_snapshot::MemorySnapshot;
use super::recorded_steps::{RecordedCall, RecordedDays, RecordedStep, contains_post_replies};
use novamind_record::figures::{GroupFigures, WeekFigures};
use novamind_session::GroupWeek;
use novamind_session::engine::{
    ParameterChange, RunDatabase, Simulation, StateHash, UpdatedParams, add_day_to_week, json_to_value,
    measure_group, parameter_not_allowed_rejection,
};
use novamind_tools::{Arguments, ParameterNumbers, Rejection, ToolContext, ToolId, limits};
use novamind_world::command::Command;
use novamind_world::events::{DayFigures, LedgerEntry};
use novamind_world::identifiers::ByGroup;
use novamind_world::market::surges::week_end;
use novamind_world::settings::Settings;
use novamind_world::state::World;

/// The results of a re-simulation.
pub(crate) struct BranchOutcome {
    /// Company figures of each completed week.
    pub weeks: Vec<WeekFigures>,
    /// Figures of every simulated day.
    pub days: Vec<DayFigures>,
    /// Mean satisfaction of individual subscribers at the end of each completed week; NaN if there are no subscribers.
    pub satisfaction: Vec<f64>,
    /// Figures of every group in each completed week.
    pub groups: Vec<ByGroup<GroupFigures>>,
    /// Bills that fell due in each completed week, by group; empty unless the bills are counted.
    pub due_bills: Vec<ByGroup<DueByIssue>>,
    /// Day and hash of each state whose hash is in the recorded steps; empty unless hashes are requested.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests compare states"))]
    pub states: Vec<(u32, StateHash)>,
    /// Recorded or added calls that the branch rejects.
    pub rejected: Vec<RejectedCall>,
    /// Parameter changes that are invalid in the branch and therefore omitted: day, key, reason.
    pub rejected_parameters: Vec<(u32, String, Rejection)>,
    /// Calls that the run rejected and the branch would accept. The branch does not execute these calls.
    pub newly_accepted: Vec<RecordedCall>,
    /// Added calls that adjust the capacity to usage.
    pub capacity_calls: Vec<AddedCall>,
    /// Why the simulation ended early, if a day had too many leads.
    pub lead_overflow: Option<Rejection>,
    /// State of the company after the last simulated day.
    pub final_state: MemorySnapshot,
}

/// A call that a re-simulation rejects.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RejectedCall {
    /// Line of the call in the trajectory of the recorded run; `None` for an added call.
    pub seq: Option<u64>,
    /// Decision day of the call.
    pub day: u32,
    /// Tool that rejects the call.
    pub tool: ToolId,
    /// Reason for the rejection.
    pub rejection: Rejection,
}

/// Re-simulates the days after a state, with edits to the recorded steps. The current settings stay in force on days
/// after the last step. `progress` is called once per simulated day. Returns `None` if `progress` stops the simulation.
pub(crate) fn simulate_branch(
    start: &MemorySnapshot,
    moves: &[RecordedStep],
    edits: &Edits,
    until: u32,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Option<BranchOutcome> {
    let mut branch = BranchSimulation::new(start, moves, edits, false);
    branch.advance(until, progress)?;
    Some(branch.into_outcome())
}

/// Re-simulates days like [`simulate_branch`] and computes the hash of every state whose hash is recorded.
#[cfg(test)]
pub(crate) fn simulate_branch_with_hashes(
    start: &MemorySnapshot,
    moves: &[RecordedStep],
    edits: &Edits,
    until: u32,
) -> Option<BranchOutcome> {
    let mut branch = BranchSimulation::new(start, moves, edits, true);
    branch.advance(until, &mut |_| ControlFlow::Continue(()))?;
    Some(branch.into_outcome())
}

/// Returns the first day, at most `until`, at the end of which two edits of the same steps lead to different states.
/// The inner `Option` is `None` if the states are equal on all days. The outer `Option` is `None` if `progress`, which
/// is called once per simulated day, stops the simulation.
pub(crate) fn first_different_day(
    start: &MemorySnapshot,
    moves: &[RecordedStep],
    (one, other): (&Edits, &Edits),
    until: u32,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Option<Option<u32>> {
    let mut both = [one, other].map(|edits| BranchSimulation::new(start, moves, edits, false));
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

/// A running re-simulation of recorded days with edits.
struct BranchSimulation<'a> {
    edits: &'a Edits,
    remaining_steps: &'a [RecordedStep],
    simulation: Simulation,
    /// A database that discards all output.
    projection: RunDatabase,
    week: WeekFigures,
    /// Figures of each group in the current week.
    group_week: ByGroup<GroupWeek>,
    /// Bills that fell due in the current week, by group.
    due_week: ByGroup<DueByIssue>,
    /// Cash at the start of the week.
    cash_before: f64,
    /// Ledger entries of calls since the last simulated day.
    call_entries: Vec<LedgerEntry>,
    /// Whether the text of posts is generated and facts are hashed.
    processes_text: bool,
    /// Whether the text of the last day has not been processed yet.
    has_unprocessed_text: bool,
    numbers: OnceLock<Arc<ParameterNumbers>>,
    weeks: Vec<WeekFigures>,
    days: Vec<DayFigures>,
    satisfaction: Vec<f64>,
    groups: Vec<ByGroup<GroupFigures>>,
    due_bills: Vec<ByGroup<DueByIssue>>,
    states: Vec<(u32, StateHash)>,
    rejected: Vec<RejectedCall>,
    rejected_parameters: Vec<(u32, String, Rejection)>,
    newly_accepted: Vec<RecordedCall>,
    capacity_calls: Vec<AddedCall>,
    /// Why the simulation stopped, if a day had too many leads.
    lead_overflow: Option<Rejection>,
}

impl<'a> BranchSimulation<'a> {
    fn new(
        start: &MemorySnapshot,
        moves: &'a [RecordedStep],
        edits: &'a Edits,
        hashed: bool,
    ) -> BranchSimulation<'a> {
        let processes_text = hashed || contains_post_replies(moves);
        let params = edits.params.as_ref().unwrap_or(&start.params).clone();
        let feed = if processes_text { start.feed.clone() } else { Default::default() };
        let overrides = start.overrides.rebased_on(&params, &edits.dropped_lines);
        let given = (start.streams.clone(), start.names.clone());
        let simulation = Simulation::from_parts((params, overrides), given, start.world.clone(), feed);
        let mut branch = BranchSimulation {
            edits,
            remaining_steps: moves,
            cash_before: simulation.world.finance.cash,
            simulation,
            projection: RunDatabase::default(),
            week: WeekFigures::default(),
            group_week: ByGroup::default(),
            due_week: ByGroup::default(),
            call_entries: Vec::new(),
            processes_text,
            has_unprocessed_text: false,
            numbers: OnceLock::new(),
            weeks: Vec::new(),
            days: Vec::new(),
            satisfaction: Vec::new(),
            groups: Vec::new(),
            due_bills: Vec::new(),
            states: Vec::new(),
            rejected: Vec::new(),
            rejected_parameters: Vec::new(),
            newly_accepted: Vec::new(),
            capacity_calls: Vec::new(),
            lead_overflow: None,
        };
        branch.apply_initial_calls();
        branch
    }

    /// Executes the calls that precede all steps.
    fn apply_initial_calls(&mut self) {
        for (tool, args) in &self.edits.initial_calls {
            self.apply_added_call(*tool, args);
        }
    }

    /// Executes steps and simulates days until the end of day `until`.
    fn advance(&mut self, until: u32, progress: &mut dyn FnMut(u32) -> ControlFlow<()>) -> Option<()> {
        while let [step, rest @ ..] = self.remaining_steps
            && !self.is_over()
        {
            match step {
                // Decisions that are made on day `until` take effect on the next day.
                RecordedStep::Call(call) if call.day >= until => break,
                RecordedStep::Parameter(setting) if setting.day >= until => break,
                RecordedStep::Call(call) => self.replay_call(call),
                RecordedStep::Parameter(setting)
                    if self.edits.dropped_lines.contains(&setting.change.seq) => {}
                RecordedStep::Parameter(setting) => self.apply_parameter_change(setting.change.clone()),
                RecordedStep::Days(days) => {
                    self.simulation.add_scores(&days.scores);
                    self.simulate_days(days.until.min(until), progress)?;
                    if days.until > until {
                        break;
                    }
                    self.record_state_hash(days);
                }
            }
            self.remaining_steps = rest;
        }
        self.simulate_days(until, progress)
    }

    /// Executes a recorded call, with changed arguments if an edit changes them. Skips a dropped call. If the run
    /// rejected the call and no edit changes it, only records whether the branch would accept it.
    fn replay_call(&mut self, call: &RecordedCall) {
        if self.edits.dropped_lines.contains(&call.seq) {
            return;
        }
        let changed = self.edits.changed_arguments.get(&call.seq);
        if !call.accepted && changed.is_none() {
            let here = self.renumber_call(call.tool, &call.args);
            if here.args.is_some_and(|args| self.plan_call(call.tool, &args, true).is_ok()) {
                self.newly_accepted.push(call.clone());
            }
            return;
        }
        self.apply_call(Some(call.seq), call.tool, changed.unwrap_or(&call.args), changed.is_some());
    }

    fn apply_added_call(&mut self, tool: ToolId, args: &Value) {
        self.apply_call(None, tool, args, true);
    }

    /// Translates the customer numbers of a call to the numbers of the branch.
    fn renumber_call(&self, tool: ToolId, args: &Value) -> RenumberedCall {
        match &self.edits.recorded_numbers {
            None => RenumberedCall { args: Some(args.clone()), missing_customers: Vec::new() },
            Some(meant) => RenumberedCall::new(tool, args, meant, &self.simulation.world.customers.numbers),
        }
    }

    /// Plans a call. Argument bounds are checked only for new calls, because the run has already accepted the recorded
    /// calls.
    fn plan_call(&self, tool: ToolId, args: &Value, is_new: bool) -> Result<Command, Rejection> {
        let Simulation { world, params, feed, .. } = &self.simulation;
        let numbers = || self.numbers.get_or_init(|| ParameterNumbers::from_params(params).into()).clone();
        let tool = tool.tool();
        let arguments = Arguments::parse(tool.spec(), args, numbers)?;
        if is_new {
            limits::check_arguments(tool.spec(), &arguments)?;
        }
        let planned = tool.plan(&ToolContext::new(world, params).with_posts(&feed.posts), &arguments)?;
        Ok(planned.command)
    }

    /// Executes a call. If the call is rejected, records the rejection.
    fn apply_call(&mut self, seq: Option<u64>, tool: ToolId, args: &Value, is_new: bool) {
        let RenumberedCall { args: here, missing_customers: absent } = self.renumber_call(tool, args);
        let is_renumbered = here.as_ref().is_some_and(|here| here != args);
        let refusal = here.and_then(|here| self.execute_call(tool, &here, is_new).err());
        let refusal =
            refusal.map(|refusal| if is_renumbered { add_branch_number_note(refusal) } else { refusal });
        let day = self.simulation.world.day;
        let refused = absent.into_iter().chain(refusal);
        self.rejected.extend(refused.map(|refusal| RejectedCall { seq, day, tool, rejection: refusal }));
    }

    fn execute_call(&mut self, tool: ToolId, args: &Value, is_new: bool) -> Result<(), Rejection> {
        let command = self.plan_call(tool, args, is_new)?;
        let resolved = self.simulation.resolve(command);
        if resolved.is_read_only() {
            return Ok(());
        }
        self.simulation.apply_command(resolved, self.projection.entry_writer());
        self.call_entries.extend_from_slice(&self.simulation.facts.ledger);
        if self.processes_text {
            self.simulation.process_call(self.projection.entry_writer(), Vec::new(), None);
        }
        Ok(())
    }

    /// Applies a parameter change. Records a rejection instead if the value is invalid in the branch, now or on a later
    /// day.
    fn apply_parameter_change(&mut self, change: ParameterChange) {
        let (day, key) = (self.simulation.world.day, change.key.clone());
        match self.simulation.overrides.add_change(&self.simulation.params, change) {
            Ok(UpdatedParams { current: now, .. }) => {
                self.simulation.set_params(now, self.projection.entry_writer());
                self.numbers = OnceLock::new();
            }
            Err(unfit) => self.rejected_parameters.push((day, key, parameter_not_allowed_rejection(unfit))),
        }
    }

    /// Sets a parameter that was not set in the run.
    fn apply_added_setting(&mut self, setting: &AddedSetting) {
        let value = json_to_value(&setting.value);
        // The trajectory has no event for this change, so the change gets a line number that no event has.
        let change =
            |value| ParameterChange { seq: u64::MAX, key: setting.key.clone(), value, from_day: None };
        value.map(change).into_iter().for_each(|change| self.apply_parameter_change(change));
    }

    fn simulate_days(&mut self, until: u32, progress: &mut dyn FnMut(u32) -> ControlFlow<()>) -> Option<()> {
        while self.simulation.world.day < until && !self.is_over() {
            self.apply_edits_of_day();
            self.lead_overflow = self.simulation.check_lead_capacity().err();
            if self.lead_overflow.is_some() {
                break;
            }
            self.simulate_day();
            if progress(self.simulation.world.day).is_break() {
                return None;
            }
        }
        Some(())
    }

    fn is_over(&self) -> bool {
        self.lead_overflow.is_some() || self.simulation.world.is_over(&self.simulation.params)
    }

    /// Applies the edits of the current day: parameters, calls, usage-based capacity and new random draws.
    fn apply_edits_of_day(&mut self) {
        let (day, edits) = (self.simulation.world.day, self.edits);
        edits
            .added_settings
            .iter()
            .filter(|setting| setting.day == day)
            .for_each(|setting| self.apply_added_setting(setting));
        for AddedCall { tool, args, .. } in edits.added_calls.iter().filter(|added| added.day == day) {
            self.apply_added_call(*tool, args);
        }
        if let Some(UsageBasedCapacity { rule, from_day: from }) = edits.capacity_rule
            && self.week.days_run == 0
            && day >= from
        {
            let now = self.simulation.world.settings.core.capacity_tier;
            let before = self.weeks.last().or(edits.week_before.as_ref());
            let tier = rule.next_tier(now, before, &self.simulation.params);
            if tier != now {
                let args = json!({ "tier": tier });
                self.apply_added_call(ToolId::SetCapacityTier, &args);
                self.capacity_calls.push(AddedCall { day, tool: ToolId::SetCapacityTier, args });
            }
        }
        if let Some(Redraw { after_day: after, salt }) = edits.redraw
            && day == after
        {
            self.simulation.streams = self.simulation.streams.redrawn_after(salt, after);
        }
    }

    fn simulate_day(&mut self) {
        let day_before = self.has_unprocessed_text.then(Vec::new);
        let params = self.simulation.params.clone();
        let settings = self.suspend_settings();
        let due = self
            .edits
            .counts_due_bills
            .then(|| DueToday::before_day(&self.simulation.world, &params, &mut self.due_week));
        let figures = self.simulation.simulate_day(
            &self.edits.fixed_inputs,
            self.projection.entry_writer(),
            day_before,
        );
        if let Some(settings) = settings {
            self.simulation.world.settings = settings;
        }
        if !Arc::ptr_eq(&params, &self.simulation.params) {
            self.numbers = OnceLock::new();
        }
        self.has_unprocessed_text = self.processes_text;
        self.simulation.judge_own_posts(self.projection.entry_writer());
        let Simulation { facts, params, world, .. } = &self.simulation;
        self.week.add_simulated_day(&figures, facts, &self.call_entries, params);
        add_day_to_week(&mut self.group_week, &figures, facts, world);
        if let Some(due) = due {
            due.after_day(world, params, facts);
        }
        self.call_entries.clear();
        self.days.push(figures);
        let days_per_week = params.run.days_per_week;
        if world.day == week_end(world.day, days_per_week, world.last_day(params)) || world.is_over(params) {
            self.finish_week();
        }
    }

    /// Clears the suspended settings for the next day. Returns the previous settings, or `None` if no setting is
    /// suspended.
    fn suspend_settings(&mut self) -> Option<Settings> {
        let suspended = &self.edits.suspended_settings;
        let settings = (!suspended.is_empty()).then(|| self.simulation.world.settings.clone());
        suspended.iter().for_each(|setting| setting.clear(&mut self.simulation.world.settings));
        settings
    }

    fn finish_week(&mut self) {
        let cash = self.simulation.world.finance.cash;
        self.week.cash_change = cash - self.cash_before;
        self.week.open_issues = self.simulation.open_issues();
        self.weeks.push(std::mem::take(&mut self.week));
        let (world, counted) = (&self.simulation.world, std::mem::take(&mut self.group_week));
        self.satisfaction.push(mean_satisfaction(world));
        self.groups.push(ByGroup::from_fn(|group| measure_group(group, &counted[group], world)));
        if self.edits.counts_due_bills {
            self.due_bills.push(std::mem::take(&mut self.due_week));
        }
        self.cash_before = cash;
    }

    fn record_state_hash(&mut self, days: &RecordedDays) {
        if !self.processes_text {
            return;
        }
        let left = std::mem::take(&mut self.has_unprocessed_text).then(Vec::new);
        let state = self.simulation.finish_days(self.projection.entry_writer(), left);
        self.states.push((days.until, state));
        self.simulation.close_facts_chain();
    }

    fn into_outcome(self) -> BranchOutcome {
        let BranchSimulation {
            simulation,
            weeks,
            days,
            satisfaction,
            groups,
            due_bills,
            states,
            rejected: refused,
            rejected_parameters: unfit,
            newly_accepted: possible,
            capacity_calls: followed,
            lead_overflow: crowded,
            ..
        } = self;
        let end = MemorySnapshot::from_simulation(simulation);
        BranchOutcome {
            weeks,
            days,
            satisfaction,
            groups,
            due_bills,
            states,
            rejected: refused,
            rejected_parameters: unfit,
            newly_accepted: possible,
            capacity_calls: followed,
            lead_overflow: crowded,
            final_state: end,
        }
    }
}

/// Returns the mean satisfaction of individual subscribers; NaN if there are no subscribers.
fn mean_satisfaction(world: &World) -> f64 {
    let individuals = || world.customers.blocks().filter(|(group, _)| !group.is_enterprise());
    let count: usize = individuals().map(|(_, block)| block.len()).sum();
    let sum: f64 = individuals().flat_map(|(_, block)| &block.satisfaction).sum();
    sum / count as f64
}
