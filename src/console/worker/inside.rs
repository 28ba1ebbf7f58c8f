//! Looks at hidden state: the session's thread simulates days again and says what was seen.

use super::{Open, SessionThread};
use crate::console::look_inside::{BreakpointWork, LookFound, LookQuestion};
use crate::console::message::News;
use crate::report::xray::{
    breakpoints_in_words, company_in_words, customer_in_words, drift_in_words, leads_in_words,
    look_back_in_words, quality_in_words, reputation_in_words, rivals_in_words, satisfaction_in_words,
    spillover_in_words, streams_in_words,
};
use crate::session::{Access, LeadFactor, Lens, REFUSED_LOOK, Refusal, Session};

impl SessionThread {
    /// Looks at hidden state, and says what was seen or why nothing is shown.
    pub(super) fn look_inside(&mut self, number: u64, question: &LookQuestion) {
        let found = self.session_to_look_into().and_then(|session| answer(session, question));
        self.say(News::LookedInside(number, Box::new(found)));
        // A line that the disk refuses is noticed as after any other work.
        self.with_run(|_| None);
    }

    /// The run that is open; where it keeps no lines, because it is only read or played again, the same run opened as for
    /// play: each look is a line of it.
    pub(super) fn session_to_look_into(&mut self) -> Result<&mut Session, Refusal> {
        let (is_allowed, folder) = match &self.open {
            None => return Err(Refusal::new("not_possible", "no run is open")),
            Some(Open::Played(session)) => {
                (session.may_look_inside(), session.folder().filter(|_| !session.records_looks()))
            }
            Some(Open::Replayed(playback)) => (playback.may_look_inside(), playback.session().folder()),
        };
        if !is_allowed {
            return Err(Refusal::new("not_in_this_mode", REFUSED_LOOK));
        }
        let folder = folder.map(std::path::Path::to_owned);
        match (folder, &mut self.open, &mut self.inside) {
            (Some(folder), _, inside) => {
                let session = match inside.take() {
                    Some(session) => session,
                    None => {
                        let opened = Session::open(&folder, Access::Write, false);
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
        LookQuestion::Leads(group, day, held) => {
            let held: Vec<(LeadFactor, f64)> = held.iter().map(|factor| (*factor, 1.0)).collect();
            leads_in_words(&session.lead_equations(*group, Some(*day))?, &held)
        }
        LookQuestion::Quality(group, day) => quality_in_words(&session.quality_equation(*group, Some(*day))?),
        LookQuestion::Satisfaction(group, day) => {
            satisfaction_in_words(&session.satisfaction_equation(*group, Some(*day))?)
        }
        LookQuestion::Reputation(group, day) => {
            reputation_in_words(&session.reputation_equation(*group, Some(*day))?)
        }
        LookQuestion::Spillover(day) => spillover_in_words(&session.spillover(Some(*day))?),
        LookQuestion::Rivals(day) => rivals_in_words(&session.rival_state(Some(*day))?),
        LookQuestion::Drift(day) => drift_in_words(&session.drift_state(Some(*day))?),
        LookQuestion::Draws(part, _) => streams_in_words(&session.next_draws(*part, None)?),
        LookQuestion::Customer(customer, day) => match session.lens(*customer, Some(*day))? {
            Lens::Individual(lens) => customer_in_words(&lens),
            Lens::Company(lens) => company_in_words(&lens),
        },
        LookQuestion::Breakpoints(work) => return of_breakpoints(session, work),
    };
    Ok(LookFound { lines, breakpoints: Vec::new() })
}

fn of_breakpoints(session: &mut Session, work: &BreakpointWork) -> Result<LookFound, Refusal> {
    match work {
        BreakpointWork::List => {}
        BreakpointWork::Set(condition) => drop(session.set_breakpoint(*condition)?),
        BreakpointWork::Remove(number) => drop(session.clear_breakpoints(Some(*number))?),
        BreakpointWork::LookBack => {
            let found = session.look_back_from(None)?;
            let lines = found.iter().flat_map(look_back_in_words).collect();
            return Ok(LookFound { lines, breakpoints: session.breakpoints()?.to_vec() });
        }
    }
    let set = session.breakpoints()?;
    Ok(LookFound { lines: breakpoints_in_words(set), breakpoints: set.to_vec() })
}
