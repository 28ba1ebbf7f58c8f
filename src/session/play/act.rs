//! Tool calls: preview and execution.

use std::time::Instant;

use serde::Serialize;
use serde_json::Value;

use super::Session;
use crate::company::irrevocable::Irrevocable;
use crate::company::this_week::Step;
use crate::figures::changes::{Change, changes};
use crate::figures::journal::JournalEntry;
use crate::view::research_outlook::ResearchOutlook;
use novamind_base::notation::plain_numbers;
use novamind_record::error::RunError;
use novamind_record::trajectory::record::{Call, CalledTool, Outcome, RequestId, Reversal, Via};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::{
    Answer, AnyTool, Arguments, Kind, NotebookChange, Planned, REMARK, Refusal, Spec, ToolId, bounds, find,
};
use novamind_world::command::{Command, ResolvedCommand};

/// The effects of a call before it is made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Preview {
    /// Tool.
    pub tool: ToolId,
    /// Immediate cost, dollars.
    pub cost_now: f64,
    /// Change of the running costs, dollars a day.
    pub cost_per_day: f64,
    /// First day with an effect; `None` if the call changes nothing.
    pub effect_day: Option<u32>,
    /// Changed settings.
    pub changes: Vec<Change>,
    /// For an R&D project: its expected duration and gain.
    pub research: Option<ResearchOutlook>,
}

/// Additional fields of a call's line.
#[derive(Debug, Default)]
pub(crate) struct Marks {
    /// The earlier call that it undoes or redoes.
    pub(crate) reversal: Option<Reversal>,
    pub(crate) request: Option<RequestId>,
}

struct Accepted {
    resolved: ResolvedCommand,
    change: Option<NotebookChange>,
    row: Option<Value>,
}

impl Session {
    /// Returns the effects of a call without executing, recording or drawing anything.
    ///
    /// # Errors
    /// The rejections of the call.
    pub fn check(&self, tool: impl AsRef<str>, arguments: &Value) -> Result<Preview, Refusal> {
        let tool = self.tool(tool.as_ref())?;
        self.refuse_if_over(tool.spec().kind)?;
        let (_, planned) = self.plan(tool, arguments)?;
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
                after.set(change);
                preview.cost_per_day = company.daily_cost(&after) - company.daily_cost(now);
                preview.effect_day = Some(self.simulation.world.day + 1);
                preview.changes = changes(now, &after);
            }
            Command::Post(_) => preview.effect_day = Some(self.simulation.world.day + 1),
            Command::StartResearch(tier) => {
                preview.cost_now = f64::from(self.simulation.params.research(tier).cost);
                preview.effect_day =
                    Some(self.simulation.world.day + self.simulation.params.development.rd_min_duration_days);
                preview.research = Some(company.research_outlook(tier));
            }
            Command::ResearchMarket => {
                preview.cost_now = self.simulation.params.market_research.discovery_cost_level_1;
                preview.effect_day = Some(self.simulation.world.day);
            }
            Command::ResearchGroup(_, target) => {
                let level = self.simulation.params.level(target);
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

    /// Calls a tool. `next_week` and `query` have their own functions.
    ///
    /// # Errors
    /// The rejections of the tool; `unknown_tool`; `run_over`; `not_saved` if the disk fails. Nothing has changed
    /// then.
    pub fn call(&mut self, tool: impl AsRef<str>, arguments: &Value, via: Via) -> Result<Answer, Refusal> {
        self.call_recorded(tool.as_ref(), arguments, via, Marks::default())
    }

    pub(crate) fn call_recorded(
        &mut self,
        name: &str,
        arguments: &Value,
        via: Via,
        Marks { reversal, request }: Marks,
    ) -> Result<Answer, Refusal> {
        let started = Instant::now();
        let tool = match self.tool(name) {
            Ok(tool) => tool,
            Err(refusal) => {
                self.record_refusal(name, arguments, via, &refusal, request);
                return Err(refusal);
            }
        };
        let allowed = self.refuse_if_over(tool.spec().kind);
        let allowed = allowed.and_then(|()| self.refuse_outside_lesson(tool.spec().id, via));
        let planned = allowed.and_then(|()| self.plan(tool, arguments)).and_then(|(given, planned)| {
            let Planned { command, change, row, reply } = planned;
            let resolved = self.simulation.resolve(command);
            if change.is_some() {
                self.refuse_if_only_read()?;
            }
            let answer = reply.tell(&resolved, |script| self.run_script(script, via))?;
            Ok((given, Accepted { resolved, change, row }, answer))
        });
        let took_ms = started.elapsed().as_secs_f64() * 1e3;
        let called = |args: Value, outcome| {
            Record::Call(Call {
                tool: tool.spec().id.into(),
                args,
                outcome,
                via,
                took_ms: rounded(took_ms),
                reversal,
                request: request.clone(),
            })
        };
        match planned {
            Err(refusal) => {
                let record = called(arguments.clone(), Outcome::Refused(refusal.clone().into()));
                self.note_refused(record);
                Err(refusal)
            }
            Ok((given, accepted, answer)) => {
                let durability = self.log.durability_of_calls();
                let record =
                    called(Value::Object(given.as_map().clone()), Outcome::Accepted(answer.to_json()));
                self.append(&record, durability).map_err(not_saved)?;
                self.note_answer(&record);
                self.apply(tool.spec(), &given, reversal, accepted);
                Ok(answer)
            }
        }
    }

    fn apply(&mut self, spec: &Spec, given: &Arguments, reversal: Option<Reversal>, accepted: Accepted) {
        let (Accepted { resolved, change, row }, seq) = (accepted, self.log.position().seq);
        change.iter().for_each(|change| self.keep(change));
        if !resolved.only_reads() {
            let args = Value::Object(given.as_map().clone());
            let (day, tool) = (self.simulation.world.day, spec.id);
            self.history.journal.push(JournalEntry::Call { seq, day, tool, args, reversal });
        }
        Irrevocable::add(&mut self.history.this_week.done, self.simulation.irrevocable(&resolved));
        if matches!(resolved, ResolvedCommand::None | ResolvedCommand::ReadInsights(_)) {
            return;
        }
        let settings = match &resolved {
            ResolvedCommand::Set(change) => row.or_else(|| change.family()),
            _ => None,
        };
        let before =
            matches!(resolved, ResolvedCommand::Set(_)).then(|| self.simulation.world.settings.clone());
        self.simulation.apply(resolved, self.database.entries());
        if let Some(restores) = before {
            let changed = restores != self.simulation.world.settings;
            self.history.this_week.keep(Step { seq, tool: spec.id, restores }, changed, reversal);
        }
        self.history.called.extend_from_slice(&self.simulation.facts.ledger);
        self.after_call(settings);
    }

    /// Completes an applied command, live or replayed. `settings` is the settings family after the call.
    fn after_call(&mut self, settings: Option<Value>) {
        if let Some(last) = self.history.cash_by_day.last_mut() {
            *last = self.simulation.world.finance.cash;
        }
        let notices = self.simulation.notice_texts();
        self.simulation.follow_call(self.database.entries(), notices, settings);
        // The database must not be ahead of the disk.
        if self.log.durability_of_calls() == Durability::Synced {
            self.commit_projection();
        }
    }

    pub(crate) fn tool(&self, name: &str) -> Result<&'static dyn AnyTool, Refusal> {
        find(name).ok_or_else(|| {
            let message = match name {
                "" => "the call names no tool; to list the tools, run novamind tools".to_owned(),
                name => {
                    let near = novamind_tools::catalogue::nearest(name);
                    let help = match near.is_empty() {
                        true => String::new(),
                        false => format!("; did you mean {}?", near.join(" or ")),
                    };
                    format!("tool {} does not exist{help}", CalledTool::unknown(name))
                }
            };
            Refusal::at("tool", "unknown_tool", message)
        })
    }

    fn plan(
        &self,
        tool: &'static dyn AnyTool,
        arguments: &Value,
    ) -> Result<(Arguments, Planned<Answer>), Refusal> {
        let (given, planned) = self.plan_again(tool, arguments)?;
        bounds::hold(tool.spec(), &given)?;
        let beyond = |change| self.notebook().refuse_beyond_quota(change);
        planned.change.as_ref().map_or(Ok(()), beyond)?;
        Ok((given, planned))
    }

    /// Plans a recorded call, without limits that earlier versions did not have.
    fn plan_again(
        &self,
        tool: &'static dyn AnyTool,
        arguments: &Value,
    ) -> Result<(Arguments, Planned<Answer>), Refusal> {
        let given = Arguments::of(tool.spec(), arguments, || self.numbers())?;
        let planned = tool.plan(&self.company().for_tools(), &given)?;
        Ok((given, planned))
    }

    /// Rejects acting tools if the run has ended or is open read-only.
    pub(crate) fn refuse_if_over(&self, kind: Kind) -> Result<(), Refusal> {
        if !kind.acts() {
            return Ok(());
        }
        if let Some(ended) = self.history.ended {
            let day = self.simulation.world.day;
            let how = match ended {
                novamind_record::trajectory::record::Ended::Horizon => {
                    format!("it reached its last day, {day}")
                }
                novamind_record::trajectory::record::Ended::Bankruptcy => {
                    format!("the company went bankrupt on day {day}")
                }
                novamind_record::trajectory::record::Ended::Abandoned => {
                    format!("it was abandoned on day {day}")
                }
                novamind_record::trajectory::record::Ended::Lesson => {
                    format!("its lesson ended on day {day}")
                }
            };
            return Err(Refusal::new(
                "run_over",
                format!("the run is over: {how}; you can still read and query"),
            ));
        }
        self.refuse_if_only_read()
    }

    fn refuse_if_only_read(&self) -> Result<(), Refusal> {
        match self.log.is_written() {
            true => Ok(()),
            false => Err(Refusal::new("read_only", "this run is open read-only")),
        }
    }

    /// Records a rejected call that no tool received, for example a rejected week.
    pub(crate) fn record_refusal(
        &mut self,
        tool: &str,
        arguments: &Value,
        via: Via,
        refusal: &Refusal,
        request: Option<RequestId>,
    ) {
        let tool = find(tool).map_or_else(|| CalledTool::unknown(tool), |tool| tool.spec().id.into());
        let (args, outcome) = (arguments.clone(), Outcome::Refused(refusal.clone().into()));
        let call = Call { tool, args, outcome, via, took_ms: 0.0, reversal: None, request };
        self.note_refused(Record::Call(call));
    }

    /// Records a call that was rejected before it reached the session. Returns the rejection, or `run_over` if the
    /// run has ended and the tool acts.
    pub fn refuse_call(&mut self, tool: &str, arguments: &Value, via: Via, refusal: Refusal) -> Refusal {
        let over = find(tool).and_then(|tool| self.refuse_if_over(tool.spec().kind).err());
        let refusal = over.unwrap_or(refusal);
        self.record_refusal(tool, arguments, via, &refusal, None);
        refusal
    }

    /// Appends a rejected call. Ignores disk errors, because a rejection changes nothing.
    fn note_refused(&mut self, record: Record) {
        self.note_answer(&record);
        self.note(record);
    }

    fn note_answer(&mut self, record: &Record) {
        if let Record::Call(call) = record {
            self.history.first_answers.note_call(call);
        }
    }
}

pub(crate) fn not_saved(error: RunError) -> Refusal {
    if matches!(error, RunError::Astray { .. }) {
        return Refusal::new("not_saved", error.to_string());
    }
    let message = format!(
        "{error}; nothing was changed and everything confirmed before is safe. Free some disk space, then try again"
    );
    Refusal::new("not_saved", message)
}

/// Makes answers comparable across versions: earlier versions wrote whole floats as integers and had other remarks.
fn comparable(spec: &Spec, answer: &Value) -> Value {
    let mut answer = plain_numbers(answer.clone());
    if let Value::Object(fields) = &mut answer {
        let is_remark =
            |name: &str| spec.returns.iter().any(|output| output.name == name && output.kind == REMARK);
        fields.retain(|name, _| !is_remark(name));
    }
    answer
}

fn rounded(took_ms: f64) -> f64 {
    (took_ms * 1e3).round() / 1e3
}

impl Session {
    /// Applies an accepted call of a trajectory again.
    ///
    /// # Errors
    /// The reason why the call is not possible now: the line was changed, or another version recorded it.
    pub(crate) fn replay_call(&mut self, call: &Call, answer: &Value) -> Result<(), String> {
        let tool = call.tool.known().ok_or("the call names an unknown tool")?.tool();
        let (given, planned) = self.plan_again(tool, &call.args).map_err(|refusal| refusal.to_string())?;
        let Planned { command, change, row, reply } = planned;
        let resolved = self.simulation.resolve(command);
        // Statements are not run again, because the database can be ahead of this line. Documentation texts can
        // differ between versions.
        let is_told_again = tool.spec().kind != Kind::Engine || change.is_some();
        let differs =
            |now: Answer| comparable(tool.spec(), answer) != comparable(tool.spec(), &now.to_json());
        if is_told_again && reply.without_running(&resolved).is_some_and(differs) {
            return Err("the call now has a different result".to_owned());
        }
        self.apply(tool.spec(), &given, call.reversal, Accepted { resolved, change, row });
        Ok(())
    }
}
