//! What-if analysis on its own thread, while the run continues.

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

/// A question about the recorded decisions of the run.
#[derive(Debug, Clone, PartialEq)]
pub enum BranchesQuestion {
    /// List the decisions that can be changed.
    Decisions,
    /// Compare alternatives from a week on; with futures, also for new random draws.
    Compare {
        /// The first week that the alternatives change.
        week: u32,
        /// The edits of each alternative.
        alternatives: Vec<Vec<DecisionEdit>>,
        /// Number of futures per branch.
        futures: Option<u32>,
    },
}

/// The answer.
#[derive(Debug, Clone)]
pub enum BranchesFound {
    /// The decisions of the run, and its days per week.
    Decisions(Vec<PastDecision>, u32),
    /// The compared branches, and the futures.
    Compared(Box<BranchComparison>, Option<Box<Futures>>),
}

impl Question for BranchesQuestion {
    type Answer = BranchesFound;
    /// Simulated days, and all days to simulate.
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
    /// Creates a branch that keeps the recorded decisions with some edits, and opens it.
    pub(super) fn adopt_branch(&mut self, week: u32, edits: &[DecisionEdit]) {
        let Some(open) = &mut self.open else { return };
        let mode = open.session().manifest().mode.of_branch();
        let mut on = |_| ControlFlow::Continue(());
        let adopted = match open {
            Open::Played(session) => branch_with_decisions(session, week, edits, mode, &mut on),
            // A playback has not read the record to its end.
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
                    some => format!("; {some} calls were rejected, see the Journal"),
                };
                let (id, day) = (adopted.session.manifest().id.clone(), adopted.session.day());
                let remark = format!(
                    "now playing run {id}, simulated to day {day}; run {parent} is unchanged{refused}"
                );
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
        // Every thread reports every day, which is more often than the screen needs.
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
