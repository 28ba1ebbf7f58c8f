//! Making a branch that keeps the decisions of its run, edited, a run of its own.

use std::ops::ControlFlow;

use serde_json::json;

use super::decision_edit::{DecisionEdit, Opening, edits};
use crate::session::counterfactual::branch::covering_tier;
use crate::session::counterfactual::edits::Edits;
use crate::session::counterfactual::script::{Move, PastCall, moves};
use crate::session::folder::mode::Mode;
use crate::session::state::Session;
use crate::session::trajectory::record::Via;
use crate::session::trajectory::{Line, Record, Trajectory};
use crate::tools::{Refusal, ToolId};

/// A branch that was played up to where its run stands.
pub struct Adopted {
    /// The branch.
    pub session: Session,
    /// Calls that it refused, and parameters that it could not set: day, tool or key, why.
    pub refused: Vec<(u32, String, Refusal)>,
}

impl Session {
    /// Starts a branch at the beginning of a week, counted from 1, and plays it as this run was played, with some decisions
    /// edited: calls are made again, rationales are taken over, forecasts are filled in naively. `progress` is told each day
    /// and can end it early, at the end of a week.
    ///
    /// # Errors
    /// As for [`Session::branch`], and `line_unknown`, `week_unknown` for an edit. Then there is no branch.
    pub fn branch_with_decisions(
        &self,
        week: u32,
        decided: &[DecisionEdit],
        mode: Mode,
        progress: &mut dyn FnMut(u32) -> ControlFlow<()>,
    ) -> Result<Adopted, Refusal> {
        let days = self.simulation.params.run.days_per_week;
        let (from, until) = (week.saturating_sub(1).saturating_mul(days), self.day());
        let path = self.folder.as_ref().map(|folder| folder.join("trajectory.jsonl"));
        let path = path.ok_or_else(|| Refusal::new("not_saved", "a run in memory cannot be branched"))?;
        let trajectory = Trajectory::read(&path).map_err(|error| super::super::why::not_readable(&error))?;
        let follows = |line: &&Line| line.day > from || (line.day == from && !line.closes_days());
        let later: Vec<Line> = trajectory.lines.iter().filter(follows).cloned().collect();
        // What is wrong with an edit is said before there is a branch.
        let known = moves(&later);
        let check = Opening { day: from, settings: self.settings(), days_per_week: days };
        edits(decided, &check, &known, until.max(from + 1))?;
        let session = self.branch(week, mode)?;
        let opening = Opening { day: from, settings: session.settings(), days_per_week: days };
        let edits = edits(decided, &opening, &known, until.max(from + 1))?;
        let mut adopted = Adopted { session, refused: Vec::new() };
        adopted.play(&later, &edits, progress);
        Ok(adopted)
    }
}

impl Adopted {
    fn play(&mut self, later: &[Line], edits: &Edits, progress: &mut dyn FnMut(u32) -> ControlFlow<()>) {
        for (tool, args) in &edits.opening {
            self.call(*tool, args);
        }
        for line in later {
            if self.session.ended().is_some() {
                return;
            }
            let seq = line.seq;
            match (&line.record, moves(std::slice::from_ref(line)).first()) {
                (_, Some(Move::Call(call))) => self.make(call, edits),
                (Record::Advance(filed), _) => {
                    self.decide_besides(edits);
                    let forecasts = self.session.naive_forecasts();
                    if let Err(refusal) =
                        self.session.advance(&filed.rationale, &forecasts, Via::Branch, &mut |_| {})
                    {
                        return self.refuse(ToolId::NextWeek.name(), refusal);
                    }
                    if progress(self.session.day()).is_break() {
                        return;
                    }
                }
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

    /// Calls that are added on this day, and the capacity that follows usage.
    fn decide_besides(&mut self, edits: &Edits) {
        let day = self.session.day();
        for added in edits.added.iter().filter(|added| added.day == day) {
            self.call(added.tool, &added.args);
        }
        if let Some(week) = self.session.weeks().last().filter(|_| edits.capacity_follows_usage) {
            let tier = covering_tier(week.busiest_day, self.session.params());
            if tier != self.session.settings().core.capacity_tier {
                self.call(ToolId::SetCapacityTier, &json!({ "tier": tier }));
            }
        }
    }

    fn call(&mut self, tool: ToolId, args: &serde_json::Value) {
        if let Err(refusal) = self.session.call(tool, args, Via::Branch) {
            self.refuse(tool.name(), refusal);
        }
    }

    fn refuse(&mut self, what: &str, refusal: Refusal) {
        self.refused.push((self.session.day(), what.to_owned(), refusal));
    }
}
