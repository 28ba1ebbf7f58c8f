//! Creation of a run from a what-if branch with edited decisions.

use std::ops::ControlFlow;

use serde_json::{Value, json};

use super::decision_edit::{BranchStart, DecisionEdit, add_usage_based_capacity, build_edits};
use super::lesson_restrictions::check_tools_unlocked;
use crate::counterfactual::customer_renumbering::{RenumberedCall, add_branch_number_note};
use crate::counterfactual::edits::{Edits, UsageBasedCapacity};
use crate::counterfactual::recorded_steps::{RecordedCall, RecordedStep, steps_from_lines};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::{JudgedPost, Via, VoiceAnswer};
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_session::engine::UsageCapacityRule;
use novamind_session::{Session, StagedBranch, branch_not_saved_rejection, unreadable_record_rejection};
use novamind_tools::{Arguments, Rejection, ToolId};
use novamind_world::customers::customer_numbers::CustomerNumbers;

/// A branch that was simulated up to the current day of its parent run.
pub struct AdoptedBranch {
    /// The session of the branch.
    pub session: Session,
    /// Rejected calls and parameter changes: day, tool or key, reason.
    pub rejected: Vec<(u32, String, Rejection)>,
}

/// Creates a branch at the start of a week and repeats the later decisions of the run with edits. `week` is counted
/// from 1. Calls are executed again, rationales are copied, and forecasts are naive. `progress` is called once per
/// simulated day and can stop the simulation at the end of a week.
///
/// # Errors
/// Same errors as [`Session::branch`], and the rejections of [`WhatIf::compare`](super::WhatIf::compare) for an edit.
/// After an error, or if the program ends during the simulation, no branch is created.
pub fn create_branch_with_decisions(
    run: &Session,
    week: u32,
    decided: &[DecisionEdit],
    mode: Mode,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Result<AdoptedBranch, Rejection> {
    let days = run.params().run.days_per_week;
    let (from, until) = (week.saturating_sub(1).saturating_mul(days), run.day());
    let path = run.folder().map(|folder| folder.join("trajectory.jsonl"));
    let path = path.ok_or_else(|| Rejection::new("not_saved", "a run in memory cannot be branched"))?;
    let trajectory = Trajectory::read(&path).map_err(|error| unreadable_record_rejection(&error))?;
    let follows = |line: &&Line| line.day > from || (line.day == from && !line.closes_days());
    let later: Vec<Line> = trajectory.lines.iter().filter(follows).cloned().collect();
    // Edits are validated before the branch is created.
    let known = steps_from_lines(&later);
    let (settings, params) = (run.settings(), run.params());
    // The arguments of settings are checked in the branch, which has the state at the start of the week.
    let check = BranchStart { day: from, settings, params, mode, check_setting: &|_, _| Ok(()) };
    build_edits(decided, &check, &known, until.max(from + 1))?;
    if let Some(lesson) = run.lesson().filter(|_| run.ended().is_none()) {
        check_tools_unlocked(lesson, decided, &known)?;
    }
    let no_room =
        |refusal: Rejection| if refusal.code == "not_saved" { branch_rejection(refusal) } else { refusal };
    let branch = StagedBranch::stage(run, week, mode).map_err(no_room)?;
    let mut session = branch.open().map_err(|error| branch_rejection(branch_not_saved_rejection(error)))?;
    // Posts that are repeated keep their recorded scores.
    session.set_inherited_scores(later.iter().filter_map(recorded_post_scores).collect());
    let (settings, params) = (session.settings(), session.params());
    let check_setting = |tool: ToolId, arguments: &Arguments| {
        session.preview_call(tool, &Value::Object(arguments.as_map().clone())).map(drop)
    };
    let opening = BranchStart { day: from, settings, params, mode, check_setting: &check_setting };
    let mut edits = build_edits(decided, &opening, &known, until.max(from + 1))?;
    let has_automatic_capacity =
        run.lesson().is_some_and(|lesson_progress| lesson_progress.current_part().has_automatic_capacity());
    if has_automatic_capacity && !decided.is_empty() && edits.capacity_rule.is_none() {
        // The branch is not a lesson, so this rule replaces the automatic capacity changes of the lesson.
        let followed = UsageBasedCapacity { rule: UsageCapacityRule::StepByStep, from_day: from };
        add_usage_based_capacity(followed, &mut edits, &known);
    }
    let mut adopted =
        BranchAdoption { session, rejected: Vec::new(), recorded_numbers: run.company().customer_numbers() };
    adopted.replay_lines(&later, &edits, progress);
    let BranchAdoption { mut session, rejected: refused, .. } = adopted;
    // If disk space or memory is insufficient, the incomplete branch is deleted.
    let ends_it = |refusal: &&Rejection| ["not_saved", "too_many_leads"].contains(&refusal.code);
    if let Some(refusal) = refused.iter().map(|(_, _, refusal)| refusal).find(ends_it) {
        return Err(branch_rejection(refusal.clone()));
    }
    session.save().map_err(|error| branch_rejection(branch_not_saved_rejection(error)))?;
    drop(session);
    Ok(AdoptedBranch {
        session: branch.publish().map_err(|error| branch_rejection(branch_not_saved_rejection(error)))?,
        rejected: refused,
    })
}

/// Returns the language model's scores of a post, if the event contains scores.
fn recorded_post_scores(line: &Line) -> Option<JudgedPost> {
    match &line.record {
        Record::Voice(VoiceAnswer::Scores(judged)) => Some(judged.clone()),
        _ => None,
    }
}

fn branch_rejection(refusal: Rejection) -> Rejection {
    let message = format!("{}; no branch was created, and this run is unchanged", refusal.message);
    Rejection { message, ..refusal }
}

/// A branch into which the recorded events of the run are replayed with edits.
struct BranchAdoption<'a> {
    session: Session,
    rejected: Vec<(u32, String, Rejection)>,
    /// Customer numbers of the run.
    recorded_numbers: &'a CustomerNumbers,
}

impl BranchAdoption<'_> {
    fn replay_lines(
        &mut self,
        later: &[Line],
        edits: &Edits,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) {
        for (tool, args) in &edits.initial_calls {
            self.apply_call(*tool, args);
        }
        // The end event of a week covers the days since the start event of the week.
        let mut is_begun = false;
        for line in later {
            if self.session.ended().is_some() {
                return;
            }
            let seq = line.seq;
            match (&line.record, steps_from_lines(std::slice::from_ref(line)).first()) {
                (_, Some(RecordedStep::Call(call))) => self.replay_call(call, edits),
                (Record::Advance(filed), _) => {
                    is_begun = true;
                    self.apply_additions(edits);
                    let forecasts = self.session.company().naive_forecasts();
                    if let Err(refusal) =
                        self.session.advance(&filed.rationale, &forecasts, Via::Branch, &mut |_| {})
                    {
                        return self.record_rejection(ToolId::NextWeek.name(), refusal);
                    }
                    if progress(self.session.day()).is_break() {
                        return;
                    }
                }
                (Record::Step(days), _) if !std::mem::take(&mut is_begun) && days.days_run > 0 => {
                    self.apply_additions(edits);
                    if let Err(refusal) = self.session.step(days.days_run, &mut |_| {}) {
                        return self.record_rejection("step", refusal);
                    }
                    if progress(self.session.day()).is_break() {
                        return;
                    }
                }
                (Record::Week(_), _) => is_begun = false,
                (Record::Override(line), _) if !edits.dropped_lines.contains(&seq) => {
                    if let Err(refusal) = self.session.set_parameter(&line.key, &line.new, line.from_day) {
                        self.record_rejection(&line.key, refusal);
                    }
                }
                _ => {}
            }
        }
        self.apply_additions(edits);
    }

    fn replay_call(&mut self, call: &RecordedCall, edits: &Edits) {
        let changed = edits.changed_arguments.get(&call.seq);
        let is_made = call.accepted || changed.is_some();
        if is_made && !edits.dropped_lines.contains(&call.seq) {
            self.apply_call(call.tool, changed.unwrap_or(&call.args));
        }
    }

    /// Applies the added parameters and calls of the current day, and the usage-based capacity.
    fn apply_additions(&mut self, edits: &Edits) {
        let day = self.session.day();
        for setting in edits.added_settings.iter().filter(|setting| setting.day == day) {
            if let Err(refusal) = self.session.set_parameter(&setting.key, &setting.value, None) {
                self.record_rejection(&setting.key, refusal);
            }
        }
        for added in edits.added_calls.iter().filter(|added| added.day == day) {
            self.apply_call(added.tool, &added.args);
        }
        let is_decision_day = day.is_multiple_of(self.session.params().run.days_per_week);
        if let Some(followed) = edits.capacity_rule.filter(|_| is_decision_day) {
            let tier = self.session.company().capacity_tier_by_rule(followed.rule);
            if tier != self.session.settings().core.capacity_tier {
                self.apply_call(ToolId::SetCapacityTier, &json!({ "tier": tier }));
            }
        }
    }

    fn apply_call(&mut self, tool: ToolId, args: &Value) {
        let here = self.session.company().customer_numbers();
        let RenumberedCall { args: here, missing_customers: absent } =
            RenumberedCall::new(tool, args, self.recorded_numbers, here);
        absent.into_iter().for_each(|refusal| self.record_rejection(tool.name(), refusal));
        let Some(here) = here else { return };
        if let Err(refusal) = self.session.call(tool, &here, Via::Branch) {
            self.record_rejection(
                tool.name(),
                if here == *args { refusal } else { add_branch_number_note(refusal) },
            );
        }
    }

    fn record_rejection(&mut self, what: &str, refusal: Rejection) {
        self.rejected.push((self.session.day(), what.to_owned(), refusal));
    }
}
