//! Tool calls: preview and execution.

use std::time::Instant;

use serde::Serialize;
use serde_json::Value;

use super::Session;
use crate::company::irrevocable::IrrevocableAction;
use crate::company::week_actions::UndoStep;
use crate::figures::changes::{SettingChange, setting_changes};
use crate::figures::journal::JournalEntry;
use crate::view::research_outlook::ResearchOutlook;
use novamind_base::formatting::normalize_json_numbers;
use novamind_record::error::RunError;
use novamind_record::trajectory::record::{Call, CalledTool, Outcome, RequestId, Reversal, Via};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{
    Answer, AnyTool, Arguments, NotebookChange, PlannedCall, REMARK_TYPE, Rejection, ToolId, ToolKind,
    ToolSpec, find, limits, with_release_2_text,
};
use novamind_world::command::{Command, ResolvedCommand};

/// The expected effects of a call that is not executed yet.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Preview {
    /// Tool of the call.
    pub tool: ToolId,
    /// Immediate cost of the call, dollars.
    pub cost_now: f64,
    /// Change in running costs, dollars per day.
    pub cost_per_day: f64,
    /// First day on which the call has an effect; `None` if the call changes nothing.
    pub effect_day: Option<u32>,
    /// Settings that the call would change.
    pub changes: Vec<SettingChange>,
    /// Expected duration and gain, if the call starts an R&D project.
    pub research: Option<ResearchOutlook>,
}

/// Additional fields of the line that records a call.
#[derive(Debug, Default)]
pub(crate) struct CallMetadata {
    /// Earlier call that this call undoes or redoes, if any.
    pub(crate) reversal: Option<Reversal>,
    pub(crate) request: Option<RequestId>,
}

struct AcceptedCall {
    resolved: ResolvedCommand,
    change: Option<NotebookChange>,
    row: Option<Value>,
}

impl Session {
    /// Returns the expected effects of a call. Does not execute or record the call and makes no random draws.
    ///
    /// # Errors
    /// The rejections of the call.
    pub fn preview_call(&self, tool: impl AsRef<str>, arguments: &Value) -> Result<Preview, Rejection> {
        let tool = self.find_tool(tool.as_ref())?;
        self.check_can_act(tool.spec().kind)?;
        let (_, planned) = self.plan_call(tool, arguments)?;
        let company = self.company();
        let mut preview = Preview {
            tool: tool.spec().id,
            cost_now: 0.0,
            cost_per_day: 0.0,
            effect_day: None,
            changes: Vec::new(),
            research: None,
        };
        match planned.command {
            Command::None | Command::ReadInsights(_) => {}
            Command::Set(change) => {
                let now = &self.simulation.world.settings;
                let mut after = now.clone();
                after.apply(change);
                preview.cost_per_day = company.daily_cost(&after) - company.daily_cost(now);
                preview.effect_day = Some(self.simulation.world.day + 1);
                preview.changes = setting_changes(now, &after);
            }
            Command::Post(_) => preview.effect_day = Some(self.simulation.world.day + 1),
            Command::StartResearch(tier) => {
                preview.cost_now = f64::from(self.simulation.params.research_tier(tier).cost);
                preview.effect_day =
                    Some(self.simulation.world.day + self.simulation.params.development.rd_min_duration_days);
                preview.research = Some(company.research_outlook(tier));
            }
            Command::ResearchMarket => {
                preview.cost_now = self.simulation.params.market_research.discovery_cost_level_1;
                preview.effect_day = Some(self.simulation.world.day);
            }
            Command::ResearchGroup(_, target) => {
                let level = self.simulation.params.study_level(target);
                preview.cost_now = level.cost;
                preview.effect_day = Some(self.simulation.world.day + level.delay_days);
            }
            Command::SendDeals(_) => {
                preview.effect_day =
                    Some(self.simulation.world.day + self.simulation.params.enterprise.reply_delay_min_days);
            }
            Command::RejectDeals(_) => preview.effect_day = Some(self.simulation.world.day),
        }
        Ok(preview)
    }

    /// Executes and records a tool call. The tools `next_week` and `query` have separate functions.
    ///
    /// # Errors
    /// The rejections of the tool; `unknown_tool`; `run_over`; `not_saved` if the line cannot be written. After an
    /// error, nothing has changed.
    pub fn call(&mut self, tool: impl AsRef<str>, arguments: &Value, via: Via) -> Result<Answer, Rejection> {
        self.call_with_metadata(tool.as_ref(), arguments, via, CallMetadata::default())
    }

    pub(crate) fn call_with_metadata(
        &mut self,
        name: &str,
        arguments: &Value,
        via: Via,
        CallMetadata { reversal, request }: CallMetadata,
    ) -> Result<Answer, Rejection> {
        let started = Instant::now();
        let tool = match self.find_tool(name) {
            Ok(tool) => tool,
            Err(refusal) => {
                self.record_rejection(name, arguments, via, &refusal, request);
                return Err(refusal);
            }
        };
        let allowed = self.check_can_act(tool.spec().kind);
        let allowed = allowed.and_then(|()| self.check_lesson_tool(tool.spec().id, via));
        let planned = allowed.and_then(|()| self.plan_call(tool, arguments)).and_then(|(given, planned)| {
            let PlannedCall { command, notebook_change: change, settings_row: row, reply } = planned;
            let resolved = self.simulation.resolve(command);
            if change.is_some() {
                self.check_writable()?;
            }
            let answer = reply.into_answer(&resolved, |script| self.run_script(script, via))?;
            Ok((given, AcceptedCall { resolved, change, row }, answer))
        });
        let took_ms = started.elapsed().as_secs_f64() * 1e3;
        let called = |args: Value, outcome| {
            Record::Call(Call {
                tool: tool.spec().id.into(),
                args,
                outcome,
                via,
                took_ms: round_milliseconds(took_ms),
                reversal,
                request: request.clone(),
            })
        };
        match planned {
            Err(refusal) => {
                let record = called(arguments.clone(), Outcome::Rejected(refusal.clone().into()));
                self.append_rejection(record);
                Err(refusal)
            }
            Ok((given, accepted, answer)) => {
                let durability = self.log.call_durability();
                let record =
                    called(Value::Object(given.as_map().clone()), Outcome::Accepted(answer.to_json()));
                self.append(&record, durability).map_err(not_saved_rejection)?;
                self.remember_response(&record);
                self.apply_call(tool.spec(), &given, reversal, accepted);
                Ok(answer)
            }
        }
    }

    fn apply_call(
        &mut self,
        spec: &ToolSpec,
        arguments: &Arguments,
        reversal: Option<Reversal>,
        accepted: AcceptedCall,
    ) {
        let (AcceptedCall { resolved, change, row }, seq) = (accepted, self.log.position().seq);
        change.iter().for_each(|change| self.apply_notebook_change(change));
        if !resolved.is_read_only() {
            let args = Value::Object(arguments.as_map().clone());
            let (day, tool) = (self.simulation.world.day, spec.id);
            self.history.journal.push(JournalEntry::Call { seq, day, tool, args, reversal });
        }
        IrrevocableAction::merge_all(
            &mut self.history.week_actions.irrevocable_actions,
            self.simulation.irrevocable_actions(&resolved),
        );
        if matches!(resolved, ResolvedCommand::None | ResolvedCommand::ReadInsights(_)) {
            return;
        }
        let settings = match &resolved {
            ResolvedCommand::Set(change) => row.or_else(|| change.family_json()),
            _ => None,
        };
        let before =
            matches!(resolved, ResolvedCommand::Set(_)).then(|| self.simulation.world.settings.clone());
        self.simulation.apply_command(resolved, self.database.entry_writer());
        if let Some(restores) = before {
            let changed = restores != self.simulation.world.settings;
            self.history.week_actions.record(
                UndoStep { seq, tool: spec.id, restored_settings: restores },
                changed,
                reversal,
            );
        }
        self.history.call_ledger.extend_from_slice(&self.simulation.facts.ledger);
        self.finish_call(settings);
    }

    /// Completes an applied call, whether live or replayed. `settings` contains the settings after the call, if the
    /// call changed a setting.
    fn finish_call(&mut self, settings: Option<Value>) {
        if let Some(last) = self.history.cash_by_day.last_mut() {
            *last = self.simulation.world.finance.cash;
        }
        let notices = self.simulation.notice_texts();
        self.simulation.process_call(self.database.entry_writer(), notices, settings);
        // The database must not be ahead of the synced trajectory.
        if self.log.call_durability() == Durability::Synced {
            self.commit_projection();
        }
    }

    pub(crate) fn find_tool(&self, name: &str) -> Result<&'static dyn AnyTool, Rejection> {
        find(name).ok_or_else(|| {
            let message = match name {
                "" => "the call names no tool; to list the tools, run novamind tools".to_owned(),
                name => {
                    let near = novamind_tools::catalogue::similar_tools(name);
                    let help = match near.is_empty() {
                        true => String::new(),
                        false => format!("; did you mean {}?", near.join(" or ")),
                    };
                    format!("tool {} does not exist{help}", CalledTool::from_unknown_name(name))
                }
            };
            Rejection::for_field("tool", "unknown_tool", message)
        })
    }

    fn plan_call(
        &self,
        tool: &'static dyn AnyTool,
        arguments: &Value,
    ) -> Result<(Arguments, PlannedCall<Answer>), Rejection> {
        let (given, planned) = self.plan_recorded_call(tool, arguments)?;
        limits::check_arguments(tool.spec(), &given)?;
        let beyond = |change| self.notebook().check_quota(change);
        planned.notebook_change.as_ref().map_or(Ok(()), beyond)?;
        Ok((given, planned))
    }

    /// Plans a recorded call. Does not apply limits that earlier versions did not have.
    fn plan_recorded_call(
        &self,
        tool: &'static dyn AnyTool,
        arguments: &Value,
    ) -> Result<(Arguments, PlannedCall<Answer>), Rejection> {
        let planned = Arguments::parse(tool.spec(), arguments, || self.numbers()).and_then(|given| {
            let planned = tool.plan(&self.company().tool_context(), &given)?;
            Ok((given, planned))
        });
        planned.map_err(|refusal| match self.has_release_2_interface() {
            true => with_release_2_text(tool.spec().id, refusal, arguments),
            false => refusal,
        })
    }

    /// Rejects tools that change the company if the run has ended or is open read-only.
    pub(crate) fn check_can_act(&self, kind: ToolKind) -> Result<(), Rejection> {
        if !kind.changes_company() {
            return Ok(());
        }
        if let Some(ended) = self.history.ended {
            let day = self.simulation.world.day;
            let how = match ended {
                novamind_record::trajectory::record::RunEndReason::Horizon => {
                    format!("the last day, {day}, was reached")
                }
                novamind_record::trajectory::record::RunEndReason::Bankruptcy => {
                    format!("the company went bankrupt on day {day}")
                }
                novamind_record::trajectory::record::RunEndReason::Abandoned => {
                    format!("the run was abandoned on day {day}")
                }
                novamind_record::trajectory::record::RunEndReason::Lesson => {
                    format!("the lesson ended on day {day}")
                }
            };
            return Err(Rejection::new(
                "run_over",
                format!("the run is over: {how}; you can still read and query the run"),
            ));
        }
        self.check_writable()
    }

    fn check_writable(&self) -> Result<(), Rejection> {
        match self.log.is_written() {
            true => Ok(()),
            false => Err(Rejection::new("read_only", "this run is open read-only")),
        }
    }

    /// Records a call that was rejected before a tool received it, for example a rejected week.
    pub(crate) fn record_rejection(
        &mut self,
        tool: &str,
        arguments: &Value,
        via: Via,
        refusal: &Rejection,
        request: Option<RequestId>,
    ) {
        let tool =
            find(tool).map_or_else(|| CalledTool::from_unknown_name(tool), |tool| tool.spec().id.into());
        let (args, outcome) = (arguments.clone(), Outcome::Rejected(refusal.clone().into()));
        let call = Call { tool, args, outcome, via, took_ms: 0.0, reversal: None, request };
        self.append_rejection(Record::Call(call));
    }

    /// Records a call that was rejected before it reached the session. Returns the rejection, or `run_over` if the run
    /// has ended and the tool changes the company.
    pub fn record_early_rejection(
        &mut self,
        tool: &str,
        arguments: &Value,
        via: Via,
        refusal: Rejection,
    ) -> Rejection {
        let over = find(tool).and_then(|tool| self.check_can_act(tool.spec().kind).err());
        let refusal = over.unwrap_or(refusal);
        self.record_rejection(tool, arguments, via, &refusal, None);
        refusal
    }

    /// Appends a rejected call. Ignores disk errors, because a rejection changes nothing.
    fn append_rejection(&mut self, record: Record) {
        self.remember_response(&record);
        self.record_event(record);
    }

    fn remember_response(&mut self, record: &Record) {
        if let Record::Call(call) = record {
            self.history.idempotent_responses.record_call(call);
        }
    }
}

pub(crate) fn not_saved_rejection(error: RunError) -> Rejection {
    if matches!(error, RunError::FileReplaced { .. }) {
        return Rejection::new("not_saved", error.to_string());
    }
    let message = format!(
        "{error}; nothing was changed, and all confirmed lines are safe. Free some disk space, then try again"
    );
    Rejection::new("not_saved", message)
}

/// Converts an answer to a form that is comparable across versions. Earlier versions wrote whole floats as integers
/// and had different remarks.
fn comparable_answer(spec: &ToolSpec, answer: &Value) -> Value {
    let mut answer = normalize_json_numbers(answer.clone());
    if let Value::Object(fields) = &mut answer {
        let is_remark = |name: &str| {
            spec.result_fields.iter().any(|output| output.name == name && output.kind == REMARK_TYPE)
        };
        fields.retain(|name, _| !is_remark(name));
    }
    answer
}

fn round_milliseconds(took_ms: f64) -> f64 {
    (took_ms * 1e3).round() / 1e3
}

impl Session {
    /// Applies a recorded, accepted call during a replay.
    ///
    /// # Errors
    /// The reason why the call cannot be replayed: the line was changed, or another version recorded it.
    pub(crate) fn replay_call(&mut self, call: &Call, answer: &Value) -> Result<(), String> {
        let tool = call.tool.tool_id().ok_or("the call names an unknown tool")?.tool();
        let (arguments, planned) =
            self.plan_recorded_call(tool, &call.args).map_err(|refusal| refusal.to_string())?;
        let PlannedCall { command, notebook_change: change, settings_row: row, reply } = planned;
        let resolved = self.simulation.resolve(command);
        // Results of SQL statements are not compared, because the database can be ahead of this line. Documentation
        // texts are not compared, because they can differ between versions.
        let is_answer_compared = tool.spec().kind != ToolKind::Engine || change.is_some();
        let differs = |now: Answer| {
            comparable_answer(tool.spec(), answer) != comparable_answer(tool.spec(), &now.to_json())
        };
        if is_answer_compared && reply.into_answer_without_script(&resolved).is_some_and(differs) {
            return Err("the call now has a different result".to_owned());
        }
        self.apply_call(tool.spec(), &arguments, call.reversal, AcceptedCall { resolved, change, row });
        Ok(())
    }
}
