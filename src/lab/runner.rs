//! Plays policies: creates their runs, executes their calls and simulates the weeks.

use std::fmt;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::metrics::MetricsCollector;
use super::policy::Policy;
use super::symbols::SymbolTable;
use super::weekly_routine;
use novamind_record::error::RunError as SessionError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::policy_rationale;
use novamind_record::trajectory::record::{RunEndReason, Via};
use novamind_session::{DayReport, NewRun, Session, Storage};
use novamind_tools::{Answer, Rejection, ToolId};

/// The settings of a policy's run.
#[derive(Debug, Clone)]
pub struct RunSpec {
    /// Seed of all random draws.
    pub seed: u64,
    /// Last day of the run, which affects the mechanics; `None` to use the value of the policy or scenario.
    pub days: Option<u32>,
    /// Day after which the run is stopped; `None` to play the run to its end.
    pub stop_after_day: Option<u32>,
    /// Whether demand surges occur; `None` to use the value of the policy or scenario.
    pub surges: Option<bool>,
    /// Cash on day 0, dollars; `None` to use the value of the policy or scenario.
    pub cash: Option<f64>,
    /// Name of the scenario; `None` to use the scenario of the policy or the default scenario.
    pub scenario: Option<String>,
    /// Overrides of single parameters, as `(table.key, value)`.
    pub overrides: Vec<(String, String)>,
    /// Folder in which the run is saved; `None` if the run is not saved.
    pub save_folder: Option<PathBuf>,
    /// Whether a saved run includes its database.
    pub saves_database: bool,
}

impl RunSpec {
    /// Returns run settings that define only the seed. All other settings come from the policy or the scenario.
    pub fn for_seed(seed: u64) -> RunSpec {
        RunSpec {
            seed,
            days: None,
            stop_after_day: None,
            surges: None,
            cash: None,
            scenario: None,
            overrides: Vec::new(),
            save_folder: None,
            saves_database: false,
        }
    }
}

/// The reason why a policy's run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RunEnd {
    /// The run reached its last day.
    Horizon,
    /// The run reached the requested stop day.
    Until,
    /// The company went bankrupt.
    Bankruptcy,
}

/// The outcome of a policy's run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PolicyRunOutcome {
    /// Seed of the run.
    pub seed: u64,
    /// Name of the policy.
    pub policy: String,
    /// Last possible day of the run.
    pub days: u32,
    /// Last simulated day of the run.
    pub day: u32,
    /// Cash at the end, dollars.
    pub cash: f64,
    /// Active subscriptions of individuals at the end.
    pub subscribers: u32,
    /// Seats of active enterprises at the end.
    pub seats: u32,
    /// Reason for the end of the run.
    pub ended: RunEnd,
    /// Hash of the state after the last day.
    pub state_hash: String,
    /// Whether demand surges are possible.
    pub surges: bool,
    /// Name of the saved run; `None` if the run was not saved.
    pub run: Option<String>,
    /// Time that it took to play the run, seconds.
    pub seconds: f64,
}

impl fmt::Display for PolicyRunOutcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            formatter,
            "seed {}  day {}  cash {}  subscribers {}  seats {}  ",
            self.seed,
            self.day,
            novamind_base::formatting::dollars(self.cash),
            novamind_base::formatting::grouped_number(f64::from(self.subscribers), 0),
            novamind_base::formatting::grouped_number(f64::from(self.seats), 0),
        )?;
        match self.ended {
            RunEnd::Bankruptcy => write!(formatter, "bankrupt on day {}", self.day),
            RunEnd::Horizon | RunEnd::Until => formatter.write_str("alive"),
        }?;
        if !self.surges {
            formatter.write_str("  no demand surges")?;
        }
        match &self.run {
            Some(run) => write!(formatter, "  saved as run {run}"),
            None => Ok(()),
        }
    }
}

/// The reason why a policy's run failed.
#[derive(Debug)]
pub enum RunError {
    /// The run could not start.
    Start(Box<SessionError>),
    /// A tool rejected a call.
    Refused {
        /// Seed of the run.
        seed: u64,
        /// Decision day of the rejected call.
        day: u32,
        /// Name of the tool that rejected the call.
        tool: String,
        /// Reason for the rejection.
        rejection: Box<Rejection>,
    },
}

impl fmt::Display for RunError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RunError::Start(error) => error.fmt(formatter),
            RunError::Refused { seed, day, tool, rejection } => {
                write!(formatter, "seed {seed}, day {day}: {tool} was rejected: {rejection}")
            }
        }
    }
}

impl std::error::Error for RunError {}

impl From<SessionError> for RunError {
    fn from(error: SessionError) -> Self {
        RunError::Start(Box::new(error))
    }
}

/// Plays a policy to the end of its run. `collector` observes every day.
///
/// # Errors
/// Fails if the run cannot start or a tool rejects a call that must succeed.
pub fn play_policy(
    policy: &Policy,
    spec: &RunSpec,
    configuration: &Configuration,
    collector: &mut MetricsCollector,
) -> Result<PolicyRunOutcome, RunError> {
    let started = Instant::now();
    let session = play_session(policy, spec, configuration, collector)?;
    Ok(policy_outcome(policy, spec.seed, &session, started.elapsed()))
}

/// Plays a policy to the end of its run and returns the session.
pub(super) fn play_session(
    policy: &Policy,
    spec: &RunSpec,
    configuration: &Configuration,
    collector: &mut MetricsCollector,
) -> Result<Session, RunError> {
    let mut watch = |report: &DayReport<'_>| collector.add_day(report);
    let mut session = play_while(&|| true, policy, spec, configuration, &mut watch)?;
    session.save()?;
    Ok(session)
}

/// Plays a policy without saving its run. The callback `watch` observes each day, and the callback `goes_on`
/// decides after each week whether to continue.
pub(super) fn play_while(
    goes_on: &dyn Fn() -> bool,
    policy: &Policy,
    spec: &RunSpec,
    configuration: &Configuration,
    watch: &mut dyn FnMut(&DayReport<'_>),
) -> Result<Session, RunError> {
    let mut session = Session::create(new_run(policy, spec), configuration)?;
    while !is_over(&session, spec) && goes_on() {
        make_decisions(policy, spec.seed, &mut session)?;
        advance_week(policy, spec.seed, spec.stop_after_day.unwrap_or(u32::MAX), &mut session, watch)?;
    }
    Ok(session)
}

/// Returns whether a run reached its stop day or its end.
pub(super) fn is_over(session: &Session, spec: &RunSpec) -> bool {
    session.ended().is_some() || spec.stop_after_day.is_some_and(|until| session.day() >= until)
}

/// Returns the definition of a policy's run with the given settings.
pub(super) fn new_run(policy: &Policy, spec: &RunSpec) -> NewRun {
    // Explicit overrides come after the policy's settings, so they take precedence.
    let mut overrides = Vec::new();
    if spec.surges.or(policy.start.surges) == Some(false) {
        overrides.push(("demand_surge.probability".to_owned(), "0.0".to_owned()));
    }
    overrides.extend(spec.overrides.iter().cloned());
    let standard = NewRun::default();
    NewRun {
        lesson: None,
        handout: None,
        seed: Some(spec.seed),
        days: spec.days.or(policy.start.days),
        cash: spec.cash.or(policy.start.cash),
        scenario: spec.scenario.clone().or(policy.start.scenario.clone()).unwrap_or(standard.scenario),
        overrides,
        fault: None,
        mode: Mode::Debug,
        participant: None,
        agreed: None,
        study: None,
        storage: spec.save_folder.clone().map_or(Storage::Memory, Storage::Runs),
        projection: spec.saves_database,
        sync_calls: false,
        seal_key: standard.seal_key,
    }
}

/// Executes the calls of a policy on the current decision day.
pub(super) fn make_decisions(policy: &Policy, seed: u64, session: &mut Session) -> Result<(), RunError> {
    decide_with_answers(policy, seed, session, &mut |_| ())
}

/// Executes the calls of a policy on the current decision day and passes every response to a callback.
pub(super) fn decide_with_answers(
    policy: &Policy,
    seed: u64,
    session: &mut Session,
    tell: &mut dyn FnMut(&Answer),
) -> Result<(), RunError> {
    let day = session.day();
    let mut call = |session: &mut Session, tool: &str, arguments: &Value, may_fail: bool| match session.call(
        tool,
        arguments,
        Via::Policy,
    ) {
        Err(rejection) if !may_fail => Err(RunError::Refused {
            seed,
            day: session.day(),
            tool: tool.to_owned(),
            rejection: Box::new(rejection),
        }),
        answer => {
            answer.iter().for_each(&mut *tell);
            Ok(())
        }
    };
    if let Some(rules) = &policy.rule_based {
        for (tool, arguments) in weekly_routine::routine_calls(rules, session) {
            call(session, tool.as_ref(), &arguments, false)?;
        }
    }
    for scheduled in policy.calls.iter().filter(|call| call.is_due(day)) {
        for _ in 0..scheduled.repeat {
            let symbols = SymbolTable::new(session.company().observe().known_groups);
            for arguments in symbols.resolve(&scheduled.arguments) {
                call(session, &scheduled.tool, &arguments, scheduled.may_fail)?;
            }
        }
    }
    if let Some(rule) = &policy.enterprise {
        for (tool, arguments) in rule.answer_calls(&session.company().observe().waiting) {
            call(session, tool.as_ref(), &arguments, false)?;
        }
    }
    Ok(())
}

/// Simulates a week, or the days up to the stop day. Calls `watch` after each simulated day.
pub(super) fn advance_week(
    policy: &Policy,
    seed: u64,
    until: u32,
    session: &mut Session,
    watch: &mut dyn FnMut(&DayReport<'_>),
) -> Result<(), RunError> {
    let day = session.day();
    let ran = if until < session.company().next_decision_day() {
        session.step(until - day, watch)
    } else {
        let forecasts = session.company().naive_forecasts();
        session.advance(&policy_rationale(&policy.name), &forecasts, Via::Policy, watch)
    };
    ran.map(|_| ()).map_err(|rejection| RunError::Refused {
        seed,
        day,
        tool: ToolId::NextWeek.to_string(),
        rejection: Box::new(rejection),
    })
}

/// Returns the outcome of a policy's session.
pub(super) fn policy_outcome(
    policy: &Policy,
    seed: u64,
    session: &Session,
    took: Duration,
) -> PolicyRunOutcome {
    let seen = session.company().observe();
    PolicyRunOutcome {
        seed,
        policy: policy.name.clone(),
        days: seen.last_day,
        day: seen.day,
        cash: seen.cash,
        subscribers: seen.subscribers,
        seats: seen.seats,
        ended: match session.ended() {
            Some(RunEndReason::Bankruptcy) => RunEnd::Bankruptcy,
            Some(_) => RunEnd::Horizon,
            None => RunEnd::Until,
        },
        state_hash: session.state_hash().0,
        surges: session.params().demand_surge.probability > 0.0,
        run: session.folder().map(|_| session.manifest().id.clone()),
        seconds: took.as_secs_f64(),
    }
}
