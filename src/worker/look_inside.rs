//! Inspections of hidden state for the X-ray screen, described as in plain mode. The session thread simulates days
//! again for them.

use std::sync::PoisonError;
use std::time::{Duration, Instant};

use super::{Open, SessionThread};
use crate::asking::{Question, Reply};
use crate::message::News;
use novamind_database::Rows;
use novamind_insight::{Breakpoint, Condition, DrawnPart, Inspect, LeadEquation, LeadFactor, Lens};
use novamind_report::xray::{
    AskedWords, EVENINGS, SATISFACTION, SpillMap, breakpoints_in_words, company_in_words, customer_in_words,
    drift_in_words, leads_in_words, line_of_factor, look_back_in_words, quality_in_words,
    reputation_in_words, rivals_in_words, satisfaction_in_words, spillover_in_words, streams_in_words,
};
use novamind_session::identifiers::Group;
use novamind_session::{Access, REFUSED_LOOK, Session};
use novamind_tools::Refusal;

/// An inspection of hidden state. Days are completed days.
#[derive(Debug, Clone, PartialEq)]
pub enum LookQuestion {
    /// The lead equation of a group on a day, with factors fixed at values.
    Leads(Group, u32, Vec<(LeadFactor, f64)>),
    /// The delivered quality of a group on a day.
    Quality(Group, u32),
    /// The change of a group's satisfaction on a day.
    Satisfaction(Group, u32),
    /// The change of the reputation in a group on a day.
    Reputation(Group, u32),
    /// The spillover of reputation changes on a day.
    Spillover(u32),
    /// The information and actions of competitors on a day.
    Rivals(u32),
    /// The drift of expectations and budgets up to a day.
    Drift(u32),
    /// The random draws of a part on the day after a day.
    Draws(DrawnPart, u32),
    /// A customer (number) on a day.
    Customer(u32, u32),
    /// A breakpoint command.
    Breakpoints(BreakpointWork),
    /// A plain-mode command: its text, and parsed.
    Words(String, AskedWords),
}

/// A command on breakpoints, other than running to them.
#[derive(Debug, Clone, PartialEq)]
pub enum BreakpointWork {
    /// Lists the breakpoints.
    List,
    /// Sets a breakpoint.
    Set(Condition),
    /// Removes a breakpoint by number.
    Remove(u32),
    /// Returns since when each condition has been true or false.
    LookBack,
}

/// The result of an inspection.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LookFound {
    /// Lines of text.
    pub lines: Vec<String>,
    /// Daily figures for some of the lines.
    pub curves: Vec<LookCurve>,
    /// Spillover map, shown in place of the lines.
    pub map: Option<SpillMap>,
    /// The displayed day if it differs from the requested one: for a customer who has left, its last day.
    pub day: Option<u32>,
    /// The breakpoints, after a breakpoint command.
    pub breakpoints: Vec<Breakpoint>,
}

/// A daily figure up to the displayed day.
#[derive(Debug, Clone, PartialEq)]
pub struct LookCurve {
    /// Index of the line that it belongs to.
    pub line: usize,
    /// Daily values; NaN if there is no value.
    pub days: Vec<f64>,
}

impl Question for LookQuestion {
    type Answer = LookFound;
    type Progress = ();

    /// If the inspection changed the run, the changed company is sent before the answer.
    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let changes_run = matches!(&self, LookQuestion::Words(_, asked) if asked.changes_run());
        let found = match thread.refuse_to_change().filter(|_| changes_run) {
            Some(refusal) => Err(refusal),
            None => thread.session_to_look_into(false).and_then(|session| answer(session, &self)),
        };
        match changes_run && found.is_ok() {
            true => thread.report(|run| News::Changed(run.company())),
            false => thread.notice_losses(),
        }
        reply.answer(found);
    }
}

impl SessionThread {
    /// Queries the database and the hidden tables. In a playback, the table of one day shows the current day.
    pub(super) fn ask_inside(&mut self, sql: &str) -> Result<(Rows, Duration), Refusal> {
        let started = Instant::now();
        let stop = self.running_stop.clone();
        let hold = |own| *stop.lock().unwrap_or_else(PoisonError::into_inner) = own;
        let day = match &self.open {
            Some(Open::Replayed(playback)) => Some(playback.session().day()).filter(|day| *day > 0),
            _ => None,
        };
        let rows = self.session_to_look_into(true).and_then(|session| {
            let interrupt = session.inspect().xray_interrupt()?;
            // A stop now affects this query.
            let ticket = interrupt.ticket();
            hold(Some(interrupt));
            session.inspect().xray_query_as(ticket, sql, day)
        });
        hold(None);
        self.notice_losses();
        Ok((rows?, started.elapsed()))
    }

    fn refuse_to_change(&self) -> Option<Refusal> {
        match &self.open {
            Some(Open::Replayed(_)) => Some(Refusal::new("read_only", "a replay is read-only")),
            Some(Open::Played(session)) if !session.log().is_written() && session.folder().is_some() => {
                Some(Refusal::new("read_only", "this run is open read-only"))
            }
            _ => None,
        }
    }

    /// Returns the open session, or a writable session of the same run if the open one is read-only, because each
    /// inspection is recorded. With `with_rows`, it has a database.
    pub(super) fn session_to_look_into(&mut self, with_rows: bool) -> Result<&mut Session, Refusal> {
        let (is_allowed, folder) = match &self.open {
            None => return Err(Refusal::new("not_possible", "no run is open")),
            Some(Open::Played(session)) => {
                (session.may_look_inside(), session.folder().filter(|_| !session.log().is_written()))
            }
            Some(Open::Replayed(playback)) => (playback.may_look_inside(), playback.session().folder()),
        };
        if !is_allowed {
            return Err(Refusal::new("not_in_this_mode", REFUSED_LOOK));
        }
        let folder = folder.map(std::path::Path::to_owned);
        if with_rows && !self.inside_has_rows {
            self.inside = None;
        }
        match (folder, &mut self.open, &mut self.inside) {
            (Some(folder), _, inside) => {
                let session = match inside.take() {
                    Some(session) => session,
                    None => {
                        let opened = Session::open(&folder, Access::Write, with_rows);
                        self.inside_has_rows = with_rows;
                        Box::new(opened.map_err(|error| Refusal::new("not_possible", error.to_string()))?)
                    }
                };
                Ok(inside.insert(session))
            }
            (None, Some(open), _) => Ok(open.session()),
            (None, None, _) => Err(Refusal::new("not_possible", "no run is open")),
        }
    }
}

fn answer(session: &mut Session, question: &LookQuestion) -> Result<LookFound, Refusal> {
    let lines = match question {
        LookQuestion::Leads(group, day, held) => return of_leads(session, *group, *day, held),
        LookQuestion::Quality(group, day) => {
            quality_in_words(&session.inspect().quality_equation(*group, Some(*day))?)
        }
        LookQuestion::Satisfaction(group, day) => {
            let own = session.inspect().satisfaction_equation(*group, Some(*day))?;
            let days = own.evenings.iter().map(|value| value.unwrap_or(f64::NAN)).collect();
            return Ok(with_curve(satisfaction_in_words(&own), EVENINGS, days));
        }
        LookQuestion::Reputation(group, day) => {
            let own = session.inspect().reputation_equation(*group, Some(*day))?;
            let lines = reputation_in_words(&own);
            return Ok(with_curve(lines, EVENINGS, own.evenings));
        }
        LookQuestion::Spillover(day) => {
            let own = session.inspect().spillover(Some(*day))?;
            let map = Some(SpillMap::of(&own));
            return Ok(LookFound { lines: spillover_in_words(&own), map, ..LookFound::default() });
        }
        LookQuestion::Rivals(day) => rivals_in_words(&session.inspect().rival_state(Some(*day))?),
        LookQuestion::Drift(day) => drift_in_words(&session.inspect().drift_state(Some(*day))?),
        LookQuestion::Draws(part, _) => streams_in_words(&session.inspect().next_draws(*part, None)?),
        LookQuestion::Customer(customer, day) => match session.inspect().lens(*customer, Some(*day))? {
            Lens::Individual(lens) => {
                let days = lens.days.iter().map(|own| own.satisfaction).collect();
                let day = lens.shown().map_or(lens.first.day, |own| own.day);
                let found = with_curve(customer_in_words(&lens), SATISFACTION, days);
                return Ok(LookFound { day: Some(day), ..found });
            }
            Lens::Company(lens) => company_in_words(&lens),
        },
        LookQuestion::Breakpoints(work) => return of_breakpoints(session, work),
        LookQuestion::Words(_, asked) => asked.answer(session)?.in_words(),
    };
    Ok(LookFound { lines, ..LookFound::default() })
}

fn of_leads(
    session: &mut Session,
    group: Group,
    day: u32,
    held: &[(LeadFactor, f64)],
) -> Result<LookFound, Refusal> {
    let days = session.inspect().lead_equations(group, Some(day))?;
    let lines = leads_in_words(&days, held);
    let value = |own: &LeadEquation, factor| if own.is_known { own.factor(factor) } else { f64::NAN };
    let curve = |factor| LookCurve {
        line: line_of_factor(factor),
        days: days.iter().map(|own| value(own, factor)).collect(),
    };
    let is_known = days.last().is_some_and(|own| own.is_known);
    let curves = if is_known { LeadFactor::ALL.map(curve).to_vec() } else { Vec::new() };
    Ok(LookFound { lines, curves, ..LookFound::default() })
}

/// Attaches daily values to the line with this prefix, if there is one.
fn with_curve(lines: Vec<String>, begins: &str, days: Vec<f64>) -> LookFound {
    let line = lines.iter().position(|line| line.starts_with(begins));
    let curves = line.map(|line| LookCurve { line, days }).into_iter().collect();
    LookFound { lines, curves, ..LookFound::default() }
}

fn of_breakpoints(session: &mut Session, work: &BreakpointWork) -> Result<LookFound, Refusal> {
    let found = |lines, session: &mut Session| {
        let breakpoints = session.inspect().breakpoints()?;
        Ok(LookFound { lines, breakpoints, ..LookFound::default() })
    };
    match work {
        BreakpointWork::List => {}
        BreakpointWork::Set(condition) => drop(session.inspect().set_breakpoint(*condition)?),
        BreakpointWork::Remove(number) => drop(session.inspect().clear_breakpoints(Some(*number))?),
        BreakpointWork::LookBack => {
            let told = session.inspect().look_back_from(None)?;
            return found(told.iter().flat_map(look_back_in_words).collect(), session);
        }
    }
    let set = session.inspect().breakpoints()?;
    found(breakpoints_in_words(&set), session)
}
