//! Calling tools: check, call, undo.

use std::time::Instant;

use serde::Serialize;
use serde_json::{Map, Value, json};

use super::changes::{Change, changes, daily_cost};
use super::error::RunError;
use super::record::to_fill;
use super::trajectory::Durability;
use super::{JournalEntry, Session, UndoStep};
use crate::notation::cents;
use crate::tools::{Arguments, Kind, Refusal, Task, Tool, View, find};
use crate::world::effect::{Deed, Effect};
use crate::world::enterprise::letters::Letter;
use crate::world::events::Offering;
use crate::world::settings::Settings;
use crate::world::state::World;

/// Where an action came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Via {
    /// A form of the console.
    Form,
    /// The palette of the console.
    Palette,
    /// A line of plain mode.
    Plain,
    /// The HTTP interface.
    Http,
    /// A policy.
    Policy,
    /// A stored script.
    Script,
}

/// What a call would do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Preview {
    /// Tool.
    pub tool: &'static str,
    /// Paid at once, dollars.
    pub cost_now: f64,
    /// Change of the running costs, dollars a day.
    pub cost_per_day: f64,
    /// First day on which it acts; none when it changes nothing.
    pub effect_day: Option<u32>,
    /// Settings that change.
    pub changes: Vec<Change>,
}

impl Session {
    /// What a call would do; nothing happens, nothing is recorded, nothing is drawn.
    ///
    /// # Errors
    /// The same refusals as the call.
    pub fn check(&self, tool: &str, arguments: &Value) -> Result<Preview, Refusal> {
        let tool = self.tool(tool)?;
        self.refuse_if_over(tool.spec().kind)?;
        let (_, effect) = self.plan(tool, arguments)?;
        let mut preview = Preview {
            tool: tool.spec().name,
            cost_now: 0.0,
            cost_per_day: 0.0,
            effect_day: None,
            changes: Vec::new(),
        };
        match effect {
            Effect::None | Effect::ReadInsights(_) => {}
            Effect::Set(change) => {
                let now = &self.world.settings;
                let mut after = now.clone();
                after.set(change);
                preview.cost_per_day = self.daily_cost(&after) - self.daily_cost(now);
                preview.effect_day = Some(self.world.day + 1);
                preview.changes = changes(now, &after);
            }
            Effect::Post(_) => preview.effect_day = Some(self.world.day + 1),
            Effect::StartResearch(tier) => {
                preview.cost_now = f64::from(self.params.research(tier).cost);
                preview.effect_day = Some(self.world.day + self.params.development.rd_min_duration_days);
            }
            Effect::ResearchMarket => {
                preview.cost_now = self.params.market_research.discovery_cost_level_1;
                preview.effect_day = Some(self.world.day);
            }
            Effect::ResearchGroup(_, target) => {
                let level = self.params.level(target);
                preview.cost_now = level.cost;
                preview.effect_day = Some(self.world.day + level.delay_days);
            }
            Effect::SendDeals(_) => {
                preview.effect_day = Some(self.world.day + self.params.enterprise.reply_delay_min_days);
            }
            Effect::RejectDeals(_) => preview.effect_day = Some(self.world.day),
        }
        Ok(preview)
    }

    /// Answers a reading tool without recording that it was asked, for screens that always show what it says.
    ///
    /// # Errors
    /// `unknown_tool`, `not_a_reading`, the refusals of the tool.
    pub fn look_up(&self, tool: &str, arguments: &Value) -> Result<Value, Refusal> {
        let tool = self.tool(tool)?;
        if tool.spec().kind != Kind::Read {
            return Err(Refusal::new("not_a_reading", format!("{} does more than read", tool.spec().name)));
        }
        let (arguments, effect) = self.plan(tool, arguments)?;
        let deed = self.world.resolve(effect, &self.params, &self.streams);
        Ok(tool.answer(&self.view(), &arguments, &deed))
    }

    /// Calls a tool; `next_week` and `query` have functions of their own.
    ///
    /// # Errors
    /// The refusals of chapter 50; `unknown_tool`; `run_over`; `not_saved` when the disk refuses. Nothing has
    /// changed then.
    pub fn call(&mut self, tool: &str, arguments: &Value, via: Via) -> Result<Value, Refusal> {
        self.call_recorded(tool, arguments, via, None)
    }

    fn call_recorded(
        &mut self,
        name: &str,
        arguments: &Value,
        via: Via,
        undoes: Option<u64>,
    ) -> Result<Value, Refusal> {
        let started = Instant::now();
        let tool = self.tool(name)?;
        let allowed = self.refuse_if_over(tool.spec().kind);
        let planned = allowed.and_then(|()| self.plan(tool, arguments)).and_then(|(arguments, effect)| {
            let deed = self.world.resolve(effect, &self.params, &self.streams);
            let task = tool.task(&self.view(), &arguments);
            if task.as_ref().is_some_and(Task::leaves_something) {
                self.refuse_if_only_read()?;
            }
            let answer = match &task {
                Some(Task::Run { code, seconds }) => self.run_statements(code, *seconds)?,
                _ => tool.answer(&self.view(), &arguments, &deed),
            };
            Ok((arguments, deed, task, answer))
        });
        let took_ms = started.elapsed().as_secs_f64() * 1e3;
        let mut fields = CallFields { tool: tool.spec().name, arguments, via, took_ms, undoes };
        match planned {
            Err(refusal) => {
                // A refusal changes nothing, so a disk that refuses its line takes nothing away.
                let _ = self.record_call(fields.refused(&refusal), Durability::Written);
                Err(refusal)
            }
            Ok((given, deed, task, answer)) => {
                let given = Value::Object(given.as_map().clone());
                fields.arguments = &given;
                let durability = if self.sync_calls { Durability::Synced } else { Durability::Written };
                let accepted = fields.accepted(&answer);
                // Statements can be kept even when the run is over, and then their line comes after its end.
                let recorded = match &task {
                    Some(task) if task.leaves_something() => {
                        self.append("call", self.world.day, accepted, durability).map(|_| ())
                    }
                    _ => self.record_call(accepted, durability),
                };
                recorded.map_err(not_saved)?;
                task.iter().for_each(|task| self.apply_task(task));
                self.apply(tool, given, undoes, deed);
                Ok(answer)
            }
        }
    }

    fn apply(&mut self, tool: &'static dyn Tool, args: Value, undoes: Option<u64>, deed: Deed) {
        let spec = tool.spec();
        if !deed.only_reads() {
            let (day, tool) = (self.world.day, spec.name.to_owned());
            self.journal.push(JournalEntry::Call { day, tool, args, undoes });
        }
        self.this_week.done.extend(self.in_words(&deed));
        match &deed {
            Deed::None | Deed::ReadInsights(_) => return,
            Deed::Set(_) => {
                let seq = self.position.seq;
                let before = self.world.settings.clone();
                self.this_week.undo.push(UndoStep { seq, tool: spec.name, before });
            }
            Deed::StartResearch(..)
            | Deed::ResearchMarket(_)
            | Deed::ResearchGroup(..)
            | Deed::SendDeals(_)
            | Deed::RejectDeals(_)
            | Deed::Post(_) => {}
        }
        self.world.apply(deed, &self.params, to_fill(&mut self.facts, self.projector.as_ref()));
        self.called.extend_from_slice(&self.facts.ledger);
        self.after_call();
    }

    /// What cannot be taken back of a deed, in words.
    fn in_words(&self, deed: &Deed) -> Vec<String> {
        match deed {
            Deed::None | Deed::Set(_) | Deed::ReadInsights(_) => Vec::new(),
            Deed::Post(_) => vec!["post published, read tomorrow".to_owned()],
            Deed::StartResearch(project, _) => {
                vec![format!("R&D project {} started, done on day {}", project.id(), project.due_day)]
            }
            Deed::ResearchMarket(attempt) => vec![match attempt.found {
                Some(group) => format!("market research found group {group}"),
                None => "market research found nothing".to_owned(),
            }],
            Deed::ResearchGroup(study, _) => {
                let (group, level, day) = (study.group, study.target, study.due_day);
                vec![format!("study of {group} to level {level} ordered, done on day {day}")]
            }
            Deed::SendDeals(letters) => letters.iter().map(letter_in_words).collect(),
            Deed::RejectDeals(threads) => {
                let ended = self.world.enterprise.threads.iter();
                let ended = ended.filter(|thread| threads.contains(&thread.number));
                ended.map(|thread| format!("talks with customer {} ended", thread.customer)).collect()
            }
        }
    }

    /// What follows every applied deed, live or replayed.
    pub(super) fn after_call(&mut self) {
        if let Some(last) = self.cash_by_day.last_mut() {
            *last = self.world.finance.cash;
        }
        self.follow_up();
        // The database must not be ahead of what is on the disk.
        if self.sync_calls {
            self.commit_projection();
        }
    }

    /// Takes back the last setting of this week by sending the call that restores the old value.
    ///
    /// # Errors
    /// `nothing_to_undo`, `cannot_undo` where no call can restore it, and the refusals of the call.
    pub fn undo(&mut self, via: Via) -> Result<Vec<Change>, Refusal> {
        let Some(step) = self.this_week.undo.last().cloned() else {
            let message = "nothing was set since the last week; purchases cannot be taken back";
            return Err(Refusal::new("nothing_to_undo", message));
        };
        let tool = self.tool(step.tool)?;
        let back = changes(&self.world.settings, &step.before);
        let arguments = restoring_arguments(tool, &step.before, &back)?;
        self.call_recorded(step.tool, &Value::Object(arguments), via, Some(step.seq))?;
        // The restoring call has put a step of its own on top; both are done with.
        self.this_week.undo.truncate(self.this_week.undo.len().saturating_sub(2));
        Ok(back)
    }

    /// Settings changed since the last week, old -> new.
    pub fn changes(&self) -> Vec<Change> {
        changes(&self.this_week.settings, &self.world.settings)
    }

    /// The present values of a tool's arguments, as a call would send them.
    pub fn current(&self, tool: &str) -> Map<String, Value> {
        find(tool).map(|tool| tool.current(&self.world.settings)).unwrap_or_default()
    }

    fn daily_cost(&self, settings: &Settings) -> f64 {
        daily_cost(settings, f64::from(self.params.capacity(settings.core.capacity_tier).cost_per_day))
    }

    pub(super) fn tool(&self, name: &str) -> Result<&'static dyn Tool, Refusal> {
        find(name).ok_or_else(|| {
            let near = crate::tools::catalogue::nearest(name);
            let help =
                if near.is_empty() { String::new() } else { format!("; near it: {}", near.join(", ")) };
            Refusal::at("tool", "unknown_tool", format!("tool {name} does not exist{help}"))
        })
    }

    /// What tools may look at.
    fn view(&self) -> View<'_> {
        View::new(&self.world, &self.params).within(&self.office).with_posts(&self.feed.posts)
    }

    fn plan(&self, tool: &'static dyn Tool, arguments: &Value) -> Result<(Arguments, Effect), Refusal> {
        let arguments = Arguments::of(tool.spec(), arguments)?;
        let effect = tool.plan(&self.view(), &arguments)?;
        Ok((arguments, effect))
    }

    /// Refuses what acts once the run is over, and in a run that is only read.
    pub(super) fn refuse_if_over(&self, kind: Kind) -> Result<(), Refusal> {
        if !kind.acts() {
            return Ok(());
        }
        if let Some(ended) = self.ended {
            let day = self.world.day;
            let how = match ended {
                super::Ended::Horizon => format!("it reached its last day, {day}"),
                super::Ended::Bankruptcy => format!("the company went bankrupt on day {day}"),
                super::Ended::Abandoned => format!("it was given up on day {day}"),
            };
            return Err(Refusal::new(
                "run_over",
                format!("the run is over: {how}; readings and queries stay open"),
            ));
        }
        self.refuse_if_only_read()
    }

    fn refuse_if_only_read(&self) -> Result<(), Refusal> {
        match &self.trajectory {
            Some(_) => Ok(()),
            None => Err(Refusal::new("read_only", "this run is open to read only")),
        }
    }

    fn record_call(&mut self, fields: Map<String, Value>, durability: Durability) -> Result<(), RunError> {
        let day = self.world.day;
        if self.ended.is_some() {
            return Ok(());
        }
        self.append("call", day, fields, durability).map(|_| ())
    }

    /// Records a refused call that has no other place, for instance a refused week.
    pub(super) fn record_refusal(
        &mut self,
        tool: &'static str,
        arguments: &Value,
        via: Via,
        refusal: &Refusal,
    ) {
        let fields = CallFields { tool, arguments, via, took_ms: 0.0, undoes: None };
        let _ = self.record_call(fields.refused(refusal), Durability::Written);
    }
}

fn letter_in_words(letter: &Letter) -> String {
    let offer = |offering: &Offering| format!("{} {}", offering.plan, cents(offering.price));
    let offers: Vec<String> = letter.offerings.iter().map(offer).collect();
    format!("customer {} offered {}", letter.customer, offers.join(", "))
}

/// The arguments that restore what a tool had set before.
fn restoring_arguments(
    tool: &'static dyn Tool,
    before: &Settings,
    back: &[Change],
) -> Result<Map<String, Value>, Refusal> {
    let mut arguments = tool.current(before);
    if tool.spec().name == "set_prices" {
        // Only the prices that changed; the zero of the start is no price the tool takes.
        arguments.retain(|plan, _| back.iter().any(|change| change.setting == format!("price {plan}")));
        if let Some((plan, _)) = arguments.iter().find(|(_, price)| price.as_f64() == Some(0.0)) {
            let message = format!("plan {plan} had no price before, and a price of 0 cannot be set");
            return Err(Refusal::at(plan.clone(), "cannot_undo", message));
        }
    }
    if tool.spec().name == "set_prices" && arguments.is_empty() {
        return Err(Refusal::new("nothing_to_undo", "the last call changed nothing"));
    }
    Ok(arguments)
}

/// A refusal that says the disk did not take a line.
pub(super) fn not_saved(error: RunError) -> Refusal {
    let message = format!(
        "{error}; nothing was changed and everything confirmed before is safe: free space, then try again"
    );
    Refusal::new("not_saved", message)
}

struct CallFields<'a> {
    tool: &'static str,
    arguments: &'a Value,
    via: Via,
    took_ms: f64,
    undoes: Option<u64>,
}

impl CallFields<'_> {
    fn accepted(&self, answer: &Value) -> Map<String, Value> {
        self.with(true, "result", answer.clone())
    }

    fn refused(&self, refusal: &Refusal) -> Map<String, Value> {
        self.with(false, "refusal", serde_json::to_value(refusal).unwrap_or(Value::Null))
    }

    fn with(&self, ok: bool, outcome: &str, value: Value) -> Map<String, Value> {
        let mut fields = Map::new();
        fields.insert("tool".to_owned(), self.tool.into());
        fields.insert("args".to_owned(), self.arguments.clone());
        fields.insert("ok".to_owned(), ok.into());
        fields.insert(outcome.to_owned(), value);
        fields.insert("via".to_owned(), json!(self.via));
        fields.insert("took_ms".to_owned(), json!((self.took_ms * 1e3).round() / 1e3));
        if let Some(seq) = self.undoes {
            fields.insert("undoes".to_owned(), seq.into());
        }
        fields
    }
}

impl Session {
    /// Applies an accepted call of a trajectory again.
    ///
    /// # Errors
    /// What speaks against it now: the line was changed, or the program is another.
    pub(super) fn replay_call(&mut self, fields: &Map<String, Value>) -> Result<(), String> {
        let name = fields.get("tool").and_then(Value::as_str).ok_or("the call names no tool")?;
        let arguments = fields.get("args").unwrap_or(&Value::Null);
        let tool = self.tool(name).map_err(|refusal| refusal.message)?;
        let (given, effect) = self.plan(tool, arguments).map_err(|refusal| refusal.to_string())?;
        let deed = self.world.resolve(effect, &self.params, &self.streams);
        let task = tool.task(&self.view(), &given);
        // What statements said is not asked again: the database may be ahead of this line.
        let runs = matches!(task, Some(Task::Run { .. }));
        if !runs && fields.get("result") != Some(&tool.answer(&self.view(), &given, &deed)) {
            return Err("the call answers differently now".to_owned());
        }
        task.iter().for_each(|task| self.apply_task(task));
        let undoes = fields.get("undoes").and_then(Value::as_u64);
        self.apply(tool, Value::Object(given.as_map().clone()), undoes, deed);
        if undoes.is_some() {
            self.this_week.undo.truncate(self.this_week.undo.len().saturating_sub(2));
        }
        Ok(())
    }

    /// The world, for the parts of the session that build readings from it.
    pub(super) fn world(&self) -> &World {
        &self.world
    }
}
