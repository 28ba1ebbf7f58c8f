//! What would have been: found on its own thread, while the run goes on.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::Instant;

use super::answering::lock_kept;
use super::causes::folder_of;
use super::{BETWEEN_DAYS, Open, SessionThread};
use crate::asking::{Question, Reply};
use crate::message::News;
use novamind_insight::{
    BranchComparison, DecisionEdit, Futures, PastDecision, WhatIf, branch_with_decisions, look_at_what_if,
};
use novamind_record::trajectory::record::LeavingCause;
use novamind_session::{Access, Session};
use novamind_tools::Refusal;

/// What is asked of the run's record.
#[derive(Debug, Clone, PartialEq)]
pub enum BranchesQuestion {
    /// Which calls can be decided otherwise.
    Decisions,
    /// What comes of alternatives from a week on; with futures, also under luck drawn anew.
    Compare {
        /// The week.
        week: u32,
        /// What each alternative decides otherwise.
        alternatives: Vec<Vec<DecisionEdit>>,
        /// How many futures.
        futures: Option<u32>,
    },
}

/// What was found.
#[derive(Debug, Clone)]
pub enum BranchesFound {
    /// The calls of the run, and of how many days its weeks are.
    Decisions(Vec<PastDecision>, u32),
    /// Branches side by side.
    Compared(Box<BranchComparison>, Option<Box<Futures>>),
}

impl Question for BranchesQuestion {
    type Answer = BranchesFound;
    /// How many days were simulated, and of how many.
    type Progress = (usize, usize);

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let Some(open) = &mut thread.open else { return };
        let folder = folder_of(open);
        let is_recorded = match &self {
            BranchesQuestion::Compare { week, .. } => {
                let week = *week;
                thread.session_to_look_into(false).is_ok_and(|session| look_at_what_if(session, week))
            }
            BranchesQuestion::Decisions => false,
        };
        let kept = thread.branches.clone();
        reply.answer_on_thread(move |reply| {
            let mut kept = lock_kept(&kept);
            let own = kept.of(folder?)?;
            own.tell_hidden(is_recorded);
            answer(&self, own, reply)
        });
    }
}

impl SessionThread {
    /// Makes a branch that keeps the decisions of the run, some of them edited, and opens it.
    pub(super) fn adopt_branch(&mut self, week: u32, edits: &[DecisionEdit]) {
        let Some(open) = &mut self.open else { return };
        let mode = open.session().manifest().mode.of_branch();
        let mut on = |_| ControlFlow::Continue(());
        let adopted = match open {
            Open::Played(session) => branch_with_decisions(session, week, edits, mode, &mut on),
            // The moment that is shown is not the end of the record.
            Open::Replayed(_) => folder_of(open).and_then(|folder| {
                let whole = Session::open(&folder, Access::Read, false);
                let whole = whole.map_err(|error| Refusal::new("not_readable", error.to_string()))?;
                branch_with_decisions(&whole, week, edits, mode, &mut on)
            }),
        };
        match adopted {
            Ok(adopted) => {
                let parent = open.session().manifest().id.clone();
                let refused = match adopted.refused.len() {
                    0 => String::new(),
                    some => format!("; {some} calls were refused in it, the Journal shows them"),
                };
                let (id, day) = (adopted.session.manifest().id.clone(), adopted.session.day());
                let remark =
                    format!("this is run {id} now, played to day {day}; run {parent} is unchanged{refused}");
                let _ = self.put_down(LeavingCause::Quit);
                self.take(Ok(adopted.session), "", Some(remark));
            }
            Err(refusal) => self.say(News::NotOpened(refusal.to_string(), None)),
        }
    }
}

fn answer(
    question: &BranchesQuestion,
    own: &mut WhatIf,
    reply: &Reply<BranchesQuestion>,
) -> Result<Option<BranchesFound>, Refusal> {
    let told = Mutex::new(Instant::now());
    let progress = |done, all| {
        // Every processor tells of every day; the screen needs no more than it can show.
        if let Ok(mut told) = told.try_lock()
            && told.elapsed() >= BETWEEN_DAYS
        {
            *told = Instant::now();
            reply.report((done, all));
        }
        reply.go_on()
    };
    let (week, alternatives, futures) = match question {
        BranchesQuestion::Decisions => {
            return Ok(Some(BranchesFound::Decisions(own.decisions(1)?, own.days_per_week())));
        }
        BranchesQuestion::Compare { week, alternatives, futures } => (*week, alternatives, *futures),
    };
    let found = own.answer((week, None), alternatives, futures, &progress)?;
    Ok(found.map(|(compared, drawn)| BranchesFound::Compared(Box::new(compared), drawn.map(Box::new))))
}
