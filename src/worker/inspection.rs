//! Inspections of hidden state for the x-ray screen, with the same descriptions as in plain mode. The session thread
//! simulates days again for an inspection.

use std::sync::PoisonError;
use std::time::{Duration, Instant};

use super::{ActiveRun, SessionThread};
use crate::message::Response;
use crate::question::{Question, Reply};
use novamind_database::QueryResult;
use novamind_insight::{Breakpoint, Condition, CustomerView, Inspect, LeadEquation, LeadFactor, RandomPart};
use novamind_report::inspection::{
    InspectionCommand, RECENT_DAYS_PREFIX, SATISFACTION_PREFIX, SpilloverMap, describe_breakpoints,
    describe_competitors, describe_condition_history, describe_drift, describe_enterprise,
    describe_individual, describe_lead_equation, describe_next_draws, describe_quality, describe_reputation,
    describe_satisfaction, describe_spillover, factor_line_index,
};
use novamind_session::identifiers::Group;
use novamind_session::{Access, INSPECTION_REJECTED, Session};
use novamind_tools::Rejection;

/// A question about hidden state. A day in a question stands for the state at the end of that day.
#[derive(Debug, Clone, PartialEq)]
pub enum InspectionQuestion {
    /// The lead equation of a group on a day. Each listed factor is fixed at the given value instead of its true value.
    Leads(Group, u32, Vec<(LeadFactor, f64)>),
    /// The delivered quality of a group on a day.
    Quality(Group, u32),
    /// The change of a group's satisfaction on a day.
    Satisfaction(Group, u32),
    /// The change of reputation in a group on a day.
    Reputation(Group, u32),
    /// The spillover of reputation changes on a day.
    Spillover(u32),
    /// The state and the actions of competitors on a day.
    Competitors(u32),
    /// The drift of required quality and budgets up to a day.
    Drift(u32),
    /// The random draws that a part of the model will use on the day after the given day.
    Draws(RandomPart, u32),
    /// The state of a customer, identified by number, on a day.
    Customer(u32, u32),
    /// The result of listing or changing breakpoints.
    Breakpoints(BreakpointCommand),
    /// The result of a plain-mode command: its text and the parsed command.
    Command(String, InspectionCommand),
}

/// A command that lists or changes breakpoints.
#[derive(Debug, Clone, PartialEq)]
pub enum BreakpointCommand {
    /// Lists all breakpoints.
    List,
    /// Sets a breakpoint.
    Set(Condition),
    /// Removes a breakpoint by number.
    Remove(u32),
    /// Shows for each condition whether it is true, and since which day.
    History,
}

/// The result of an inspection, for the x-ray screen.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct InspectionAnswer {
    /// Description of the hidden state, as lines of text.
    pub lines: Vec<String>,
    /// Daily figures that are drawn next to some of the lines.
    pub curves: Vec<InspectionCurve>,
    /// The spillover map, which is shown instead of the lines.
    pub map: Option<SpilloverMap>,
    /// The displayed day, if it differs from the requested day. For a cancelled customer, this is the last day of the
    /// subscription.
    pub day: Option<u32>,
    /// All breakpoints after a breakpoint command; empty after other questions.
    pub breakpoints: Vec<Breakpoint>,
}

/// A daily figure up to the displayed day, for the chart next to a line.
#[derive(Debug, Clone, PartialEq)]
pub struct InspectionCurve {
    /// Index of the line to which the curve belongs.
    pub line_index: usize,
    /// Values by day; NaN for days without a value.
    pub values_by_day: Vec<f64>,
}

impl Question for InspectionQuestion {
    type Answer = InspectionAnswer;
    type Progress = ();

    /// Answers the question. If the inspection changed the run, sends the changed company before the answer.
    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let changes_run = matches!(&self, InspectionQuestion::Command(_, inspection_command) if inspection_command.changes_run());
        let found = match thread.read_only_rejection().filter(|_| changes_run) {
            Some(rejection) => Err(rejection),
            None => thread.inspection_session(false).and_then(|session| run_inspection(session, &self)),
        };
        match changes_run && found.is_ok() {
            true => thread.respond_with(|run| Response::RunChanged(run.company())),
            false => thread.report_record_loss(),
        }
        reply.answer(found);
    }
}

impl SessionThread {
    /// Queries the database, including the hidden tables. In a playback, tables that describe a single day describe the
    /// day of the current position.
    pub(super) fn query_hidden_tables(&mut self, sql: &str) -> Result<(QueryResult, Duration), Rejection> {
        let started = Instant::now();
        let stop = self.interrupt.clone();
        let hold = |handle| *stop.lock().unwrap_or_else(PoisonError::into_inner) = handle;
        let day = match &self.active_run {
            Some(ActiveRun::Playback(playback)) => Some(playback.session().day()).filter(|day| *day > 0),
            _ => None,
        };
        let rows = self.inspection_session(true).and_then(|session| {
            let interrupt = session.inspect().hidden_query_interrupt()?;
            // From here on, the user can stop this query.
            let ticket = interrupt.issue_ticket();
            hold(Some(interrupt));
            session.inspect().query_hidden_tables_with_ticket(ticket, sql, day)
        });
        hold(None);
        self.report_record_loss();
        Ok((rows?, started.elapsed()))
    }

    fn read_only_rejection(&self) -> Option<Rejection> {
        match &self.active_run {
            Some(ActiveRun::Playback(_)) => Some(Rejection::new("read_only", "a playback is read-only")),
            Some(ActiveRun::Live(session)) if !session.log().is_written() && session.folder().is_some() => {
                Some(Rejection::new("read_only", "this run is open read-only"))
            }
            _ => None,
        }
    }

    /// Returns a writable session of the open run, because each inspection is recorded. If the open session is
    /// read-only, returns a second session. The session has a database if `with_rows` is true.
    pub(super) fn inspection_session(&mut self, with_rows: bool) -> Result<&mut Session, Rejection> {
        let (is_allowed, folder) = match &self.active_run {
            None => return Err(Rejection::new("not_possible", "no run is open")),
            Some(ActiveRun::Live(session)) => {
                (session.check_inspection().is_ok(), session.folder().filter(|_| !session.log().is_written()))
            }
            Some(ActiveRun::Playback(playback)) => (playback.can_inspect(), playback.session().folder()),
        };
        if !is_allowed {
            return Err(Rejection::new("not_in_this_mode", INSPECTION_REJECTED));
        }
        let folder = folder.map(std::path::Path::to_owned);
        if with_rows && !self.inspection_run_has_database {
            self.inspection_run = None;
        }
        match (folder, &mut self.active_run, &mut self.inspection_run) {
            (Some(folder), _, second_session) => {
                let session = match second_session.take() {
                    Some(session) => session,
                    None => {
                        let opened = Session::open(&folder, Access::Write, with_rows);
                        self.inspection_run_has_database = with_rows;
                        Box::new(opened.map_err(|error| Rejection::new("not_possible", error.to_string()))?)
                    }
                };
                Ok(second_session.insert(session))
            }
            (None, Some(open), _) => Ok(open.session()),
            (None, None, _) => Err(Rejection::new("not_possible", "no run is open")),
        }
    }
}

fn run_inspection(
    session: &mut Session,
    question: &InspectionQuestion,
) -> Result<InspectionAnswer, Rejection> {
    let lines = match question {
        InspectionQuestion::Leads(group, day, fixed_factors) => {
            return inspect_leads(session, *group, *day, fixed_factors);
        }
        InspectionQuestion::Quality(group, day) => {
            describe_quality(&session.inspect().quality_equation(*group, Some(*day))?)
        }
        InspectionQuestion::Satisfaction(group, day) => {
            let satisfaction_equation = session.inspect().satisfaction_equation(*group, Some(*day))?;
            let days =
                satisfaction_equation.recent_days.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
            return Ok(result_with_curve(
                describe_satisfaction(&satisfaction_equation),
                RECENT_DAYS_PREFIX,
                days,
            ));
        }
        InspectionQuestion::Reputation(group, day) => {
            let reputation_equation = session.inspect().reputation_equation(*group, Some(*day))?;
            let lines = describe_reputation(&reputation_equation);
            return Ok(result_with_curve(lines, RECENT_DAYS_PREFIX, reputation_equation.recent_days));
        }
        InspectionQuestion::Spillover(day) => {
            let spillover = session.inspect().spillover(Some(*day))?;
            let map = Some(SpilloverMap::new(&spillover));
            return Ok(InspectionAnswer {
                lines: describe_spillover(&spillover),
                map,
                ..InspectionAnswer::default()
            });
        }
        InspectionQuestion::Competitors(day) => {
            describe_competitors(&session.inspect().competitor_state(Some(*day))?)
        }
        InspectionQuestion::Drift(day) => describe_drift(&session.inspect().drift_state(Some(*day))?),
        InspectionQuestion::Draws(part, _) => {
            describe_next_draws(&session.inspect().next_draws(*part, None)?)
        }
        InspectionQuestion::Customer(customer, day) => {
            match session.inspect().customer_view(*customer, Some(*day))? {
                CustomerView::Individual(view) => {
                    let days = view.days.iter().map(|individual_day| individual_day.satisfaction).collect();
                    let day = view.shown_state().map_or(view.signup.day, |day_shown| day_shown.day);
                    let found = result_with_curve(describe_individual(&view), SATISFACTION_PREFIX, days);
                    return Ok(InspectionAnswer { day: Some(day), ..found });
                }
                CustomerView::Enterprise(enterprise_view) => describe_enterprise(&enterprise_view),
            }
        }
        InspectionQuestion::Breakpoints(work) => return run_breakpoint_command(session, work),
        InspectionQuestion::Command(_, inspection_command) => inspection_command.run(session)?.describe(),
    };
    Ok(InspectionAnswer { lines, ..InspectionAnswer::default() })
}

fn inspect_leads(
    session: &mut Session,
    group: Group,
    day: u32,
    fixed_factors: &[(LeadFactor, f64)],
) -> Result<InspectionAnswer, Rejection> {
    let days = session.inspect().lead_equations(group, Some(day))?;
    let lines = describe_lead_equation(&days, fixed_factors);
    let value = |lead_equation: &LeadEquation, factor| {
        if lead_equation.is_known { lead_equation.factor(factor) } else { f64::NAN }
    };
    let curve = |factor| InspectionCurve {
        line_index: factor_line_index(factor),
        values_by_day: days.iter().map(|equation| value(equation, factor)).collect(),
    };
    let is_known = days.last().is_some_and(|known_day| known_day.is_known);
    let curves = if is_known { LeadFactor::ALL.map(curve).to_vec() } else { Vec::new() };
    Ok(InspectionAnswer { lines, curves, ..InspectionAnswer::default() })
}

/// Returns an answer with a curve of daily values for the line that starts with `begins`. Omits the curve if no line
/// does.
fn result_with_curve(lines: Vec<String>, begins: &str, days: Vec<f64>) -> InspectionAnswer {
    let line = lines.iter().position(|line| line.starts_with(begins));
    let curves =
        line.map(|line| InspectionCurve { line_index: line, values_by_day: days }).into_iter().collect();
    InspectionAnswer { lines, curves, ..InspectionAnswer::default() }
}

fn run_breakpoint_command(
    session: &mut Session,
    work: &BreakpointCommand,
) -> Result<InspectionAnswer, Rejection> {
    let found = |lines, session: &mut Session| {
        let breakpoints = session.inspect().breakpoints()?;
        Ok(InspectionAnswer { lines, breakpoints, ..InspectionAnswer::default() })
    };
    match work {
        BreakpointCommand::List => {}
        BreakpointCommand::Set(condition) => drop(session.inspect().set_breakpoint(*condition)?),
        BreakpointCommand::Remove(number) => drop(session.inspect().clear_breakpoints(Some(*number))?),
        BreakpointCommand::History => {
            let condition_histories = session.inspect().breakpoint_histories(None)?;
            return found(condition_histories.iter().flat_map(describe_condition_history).collect(), session);
        }
    }
    let set = session.inspect().breakpoints()?;
    found(describe_breakpoints(&set), session)
}
