//! What the X-ray screen asks of the hidden state of a run, answered in the words of plain mode: the session's thread simulates
//! days again.

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

/// A look at hidden state. Days are those that are over.
#[derive(Debug, Clone, PartialEq)]
pub enum LookQuestion {
    /// The equation of a group's leads on a day, with factors held at values.
    Leads(Group, u32, Vec<(LeadFactor, f64)>),
    /// What was delivered to a group on a day.
    Quality(Group, u32),
    /// What moved the satisfaction of a group on a day.
    Satisfaction(Group, u32),
    /// What moved the reputation of a group on a day.
    Reputation(Group, u32),
    /// How changes of reputation spilled over on a day.
    Spillover(u32),
    /// What rivals could copy and did on a day.
    Rivals(u32),
    /// What the market has added to expectations and budgets up to a day.
    Drift(u32),
    /// The draws of a part on the day after a day.
    Draws(DrawnPart, u32),
    /// A customer on a day.
    Customer(u32, u32),
    /// Of breakpoints.
    Breakpoints(BreakpointWork),
    /// Words as plain mode takes them; as they were typed, and read.
    Words(String, AskedWords),
}

/// What is done with breakpoints, besides running to them.
#[derive(Debug, Clone, PartialEq)]
pub enum BreakpointWork {
    /// List them.
    List,
    /// Set one.
    Set(Condition),
    /// Remove one, by its number.
    Remove(u32),
    /// Say since when each is true or false.
    LookBack,
}

/// What a look has found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LookFound {
    /// Words.
    pub lines: Vec<String>,
    /// Figures of days beside some of them.
    pub curves: Vec<LookCurve>,
    /// Spills as a map, which is shown in place of the words.
    pub map: Option<SpillMap>,
    /// The day that is shown, where it can be another one than was asked for: a customer who has left shows its last one.
    pub day: Option<u32>,
    /// The breakpoints that are set; only told where breakpoints are asked for.
    pub breakpoints: Vec<Breakpoint>,
}

/// A figure of days that end with the one that is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct LookCurve {
    /// Place of the line that tells of it.
    pub line: usize,
    /// The figure day by day; not a number where it has no value.
    pub days: Vec<f64>,
}

impl Question for LookQuestion {
    type Answer = LookFound;
    type Progress = ();

    /// A look that has changed the run is answered after the news of it.
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
    /// Asks the database and the tables of the x-ray. In a replay the table that shows one day shows that of the moment.
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
            // What is stopped from here on is this question.
            let ticket = interrupt.ticket();
            hold(Some(interrupt));
            session.inspect().xray_query_as(ticket, sql, day)
        });
        hold(None);
        self.notice_losses();
        Ok((rows?, started.elapsed()))
    }

    /// Why nothing can be changed in the run that is open: it is only read, or played again.
    fn refuse_to_change(&self) -> Option<Refusal> {
        match &self.open {
            Some(Open::Replayed(_)) => {
                Some(Refusal::new("read_only", "this is a replay: nothing is changed"))
            }
            Some(Open::Played(session)) if !session.log().is_written() && session.folder().is_some() => {
                Some(Refusal::new("read_only", "this run is only read: nothing is changed"))
            }
            _ => None,
        }
    }

    /// The run that is open; where it keeps no lines, because it is only read or played again, the same run opened as for
    /// play: each look is a line of it. It has a database where one is needed.
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

/// The equation of the leads, each factor with its days.
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

/// Words with the days of a figure beside the line that begins so, if there is one.
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
