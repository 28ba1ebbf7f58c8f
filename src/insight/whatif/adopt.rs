//! Creation of a separate run from a branch with edited decisions.

use std::ops::ControlFlow;

use serde_json::json;

use super::decision_edit::{DecisionEdit, Opening, edits, let_capacity_follow};
use super::lesson_limits::refuse_locked;
use crate::counterfactual::companies::{CallHere, in_other_numbers};
use crate::counterfactual::edits::{Edits, FollowedUsage};
use crate::counterfactual::script::{Move, PastCall, moves};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::{JudgedPost, Via, VoiceAnswer};
use novamind_record::trajectory::{Line, Record, Trajectory};
use novamind_session::engine::UsageRule;
use novamind_session::{Session, UnnamedBranch, not_readable, not_saved};
use novamind_tools::{Refusal, ToolId};
use novamind_world::customers::numbers::CustomerNumbers;

/// A branch that was played up to the current day of its run.
pub struct Adopted {
    /// The branch.
    pub session: Session,
    /// Rejected calls and parameter changes: day, tool or key, reason.
    pub refused: Vec<(u32, String, Refusal)>,
}

/// Creates a branch at the start of a week, counted from 1, and repeats the decisions of the run with some edits. Calls are made
/// again, rationales are copied, and forecasts are naive. `progress` is called once per simulated day and can stop the simulation
/// at the end of a week.
///
/// # Errors
/// As for [`Session::branch`], and `line_unknown`, `week_unknown` for an edit. No branch exists after an error, or if the program
/// ends during the simulation.
pub fn branch_with_decisions(
    run: &Session,
    week: u32,
    decided: &[DecisionEdit],
    mode: Mode,
    progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Result<Adopted, Refusal> {
    let days = run.params().run.days_per_week;
    let (from, until) = (week.saturating_sub(1).saturating_mul(days), run.day());
    let path = run.folder().map(|folder| folder.join("trajectory.jsonl"));
    let path = path.ok_or_else(|| Refusal::new("not_saved", "a run in memory cannot be branched"))?;
    let trajectory = Trajectory::read(&path).map_err(|error| not_readable(&error))?;
    let follows = |line: &&Line| line.day > from || (line.day == from && !line.closes_days());
    let later: Vec<Line> = trajectory.lines.iter().filter(follows).cloned().collect();
    // Edits are validated before the branch is created.
    let known = moves(&later);
    let (settings, params) = (run.settings(), run.params());
    let check = Opening { day: from, settings, params, mode };
    edits(decided, &check, &known, until.max(from + 1))?;
    if let Some(lesson) = run.lesson().filter(|_| run.ended().is_none()) {
        refuse_locked(lesson, decided, &known)?;
    }
    let no_room = |refusal: Refusal| if refusal.code == "not_saved" { no_branch(refusal) } else { refusal };
    let branch = UnnamedBranch::begin(run, week, mode).map_err(no_room)?;
    let mut session = branch.open().map_err(|error| no_branch(not_saved(error)))?;
    // Repeated posts keep their recorded scores.
    session.inherit_scores(later.iter().filter_map(scores_of).collect());
    let (settings, params) = (session.settings(), session.params());
    let opening = Opening { day: from, settings, params, mode };
    let mut edits = edits(decided, &opening, &known, until.max(from + 1))?;
    let is_moved = run.lesson().is_some_and(|own| own.own_part().moves_capacity());
    if is_moved && !decided.is_empty() && edits.capacity.is_none() {
        // The branch is not a lesson, so the automatic capacity changes of the lesson are applied here.
        let followed = FollowedUsage { rule: UsageRule::StepByStep, from };
        let_capacity_follow(followed, &mut edits, &known);
    }
    let mut adopted = Adopting { session, refused: Vec::new(), meant: run.company().customer_numbers() };
    adopted.play(&later, &edits, progress);
    let Adopting { mut session, refused, .. } = adopted;
    // Disk or memory is insufficient: an incomplete branch is not kept.
    let ends_it = |refusal: &&Refusal| ["not_saved", "too_many_leads"].contains(&refusal.code);
    if let Some(refusal) = refused.iter().map(|(_, _, refusal)| refusal).find(ends_it) {
        return Err(no_branch(refusal.clone()));
    }
    session.save().map_err(|error| no_branch(not_saved(error)))?;
    drop(session);
    Ok(Adopted { session: branch.name().map_err(|error| no_branch(not_saved(error)))?, refused })
}

/// Returns the language model's scores of a post, if an event contains them.
fn scores_of(line: &Line) -> Option<JudgedPost> {
    match &line.record {
        Record::Voice(VoiceAnswer::Scores(judged)) => Some(judged.clone()),
        _ => None,
    }
}

fn no_branch(refusal: Refusal) -> Refusal {
    let message = format!("{}; no branch was created, and this run is unchanged", refusal.message);
    Refusal { message, ..refusal }
}

/// A branch during its simulation.
struct Adopting<'a> {
    session: Session,
    refused: Vec<(u32, String, Refusal)>,
    /// Maps customer numbers of the run.
    meant: &'a CustomerNumbers,
}

impl Adopting<'_> {
    fn play(&mut self, later: &[Line], edits: &Edits, progress: &mut dyn FnMut(u32) -> ControlFlow<()>) {
        for (tool, args) in &edits.opening {
            self.call(*tool, args);
        }
        // The closing event of a week includes the days after its starting event.
        let mut is_begun = false;
        for line in later {
            if self.session.ended().is_some() {
                return;
            }
            let seq = line.seq;
            match (&line.record, moves(std::slice::from_ref(line)).first()) {
                (_, Some(Move::Call(call))) => self.make(call, edits),
                (Record::Advance(filed), _) => {
                    is_begun = true;
                    self.decide_besides(edits);
                    let forecasts = self.session.company().naive_forecasts();
                    if let Err(refusal) =
                        self.session.advance(&filed.rationale, &forecasts, Via::Branch, &mut |_| {})
                    {
                        return self.refuse(ToolId::NextWeek.name(), refusal);
                    }
                    if progress(self.session.day()).is_break() {
                        return;
                    }
                }
                (Record::Step(days), _) if !std::mem::take(&mut is_begun) && days.days_run > 0 => {
                    self.decide_besides(edits);
                    if let Err(refusal) = self.session.step(days.days_run, &mut |_| {}) {
                        return self.refuse("step", refusal);
                    }
                    if progress(self.session.day()).is_break() {
                        return;
                    }
                }
                (Record::Week(_), _) => is_begun = false,
                (Record::Override(line), _) if !edits.dropped.contains(&seq) => {
                    if let Err(refusal) = self.session.set_parameter(&line.key, &line.new, line.from_day) {
                        self.refuse(&line.key, refusal);
                    }
                }
                _ => {}
            }
        }
        self.decide_besides(edits);
    }

    fn make(&mut self, call: &PastCall, edits: &Edits) {
        let changed = edits.changed.get(&call.seq);
        let is_made = call.accepted || changed.is_some();
        if is_made && !edits.dropped.contains(&call.seq) {
            self.call(call.tool, changed.unwrap_or(&call.args));
        }
    }

    /// Applies added parameters and calls of this day, and capacity that follows usage.
    fn decide_besides(&mut self, edits: &Edits) {
        let day = self.session.day();
        for setting in edits.set.iter().filter(|setting| setting.day == day) {
            if let Err(refusal) = self.session.set_parameter(&setting.key, &setting.value, None) {
                self.refuse(&setting.key, refusal);
            }
        }
        for added in edits.added.iter().filter(|added| added.day == day) {
            self.call(added.tool, &added.args);
        }
        let is_decision_day = day.is_multiple_of(self.session.params().run.days_per_week);
        if let Some(followed) = edits.capacity.filter(|_| is_decision_day) {
            let tier = self.session.company().tier_by(followed.rule);
            if tier != self.session.settings().core.capacity_tier {
                self.call(ToolId::SetCapacityTier, &json!({ "tier": tier }));
            }
        }
    }

    fn call(&mut self, tool: ToolId, args: &serde_json::Value) {
        let here = self.session.company().customer_numbers();
        let CallHere { args: here, absent } = CallHere::of(tool, args, self.meant, here);
        absent.into_iter().for_each(|refusal| self.refuse(tool.name(), refusal));
        let Some(here) = here else { return };
        if let Err(refusal) = self.session.call(tool, &here, Via::Branch) {
            self.refuse(tool.name(), if here == *args { refusal } else { in_other_numbers(refusal) });
        }
    }

    fn refuse(&mut self, what: &str, refusal: Refusal) {
        self.refused.push((self.session.day(), what.to_owned(), refusal));
    }
}
