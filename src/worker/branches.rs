//! What-if analysis on a background thread, while the run continues.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::time::Instant;

use super::background::lock_cache;
use super::causes::recorded_folder;
use super::{ActiveRun, DAY_REPORT_INTERVAL, SessionThread};
use crate::message::Response;
use crate::question::{Question, Reply};
use novamind_insight::{
    BranchComparison, DecisionEdit, DecisionHistory, Futures, WhatIf, create_branch_with_decisions,
    record_what_if_inspection,
};
use novamind_record::trajectory::record::DetachCause;
use novamind_session::{Access, Session};
use novamind_tools::Rejection;

/// A question about alternatives to the recorded decisions of the open run.
#[derive(Debug, Clone, PartialEq)]
pub enum BranchesQuestion {
    /// List the decisions that an alternative can change, each with the settings before it.
    Decisions,
    /// Check whether the edits of an alternative can be simulated. Does not simulate them.
    Check {
        /// First week in which the alternative differs from the recorded decisions.
        week: u32,
        /// Changes of the recorded decisions in this alternative.
        edits: Vec<DecisionEdit>,
    },
    /// Compare alternatives that differ from the recorded decisions from `week` on. If `futures` is set, also simulate
    /// each branch with new random draws.
    Compare {
        /// First week in which the alternatives differ from the recorded decisions.
        week: u32,
        /// The decision edits, one list per alternative.
        alternatives: Vec<Vec<DecisionEdit>>,
        /// Number of futures per branch; `None` if futures are not simulated.
        futures: Option<u32>,
    },
}

/// The answer to a [`BranchesQuestion`].
#[derive(Debug, Clone)]
pub enum BranchesAnswer {
    /// The recorded decisions, which alternatives modify.
    Decisions(Box<DecisionHistory>),
    /// For each checked edit, its rejection, or `None` if the edit can be simulated.
    Checked(Vec<Option<Rejection>>),
    /// The compared branches, and the futures if they were requested.
    Compared(Box<BranchComparison>, Option<Box<Futures>>),
}

impl Question for BranchesQuestion {
    type Answer = BranchesAnswer;
    /// Days simulated so far, and total days to simulate, over all branches.
    type Progress = (usize, usize);

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        let Some(open) = &mut thread.active_run else { return };
        let folder = recorded_folder(open);
        let is_recorded = match &self {
            BranchesQuestion::Compare { week, .. } => {
                let week = *week;
                thread.inspection_session(false).is_ok_and(|session| record_what_if_inspection(session, week))
            }
            BranchesQuestion::Decisions | BranchesQuestion::Check { .. } => false,
        };
        let kept = thread.what_if_cache.clone();
        reply.answer_on_thread(move |reply| {
            let mut kept = lock_cache(&kept);
            let what_if = kept.get_or_open(folder?)?;
            what_if.set_shows_hidden(is_recorded);
            answer_question(&self, what_if, reply)
        });
    }
}

impl SessionThread {
    /// Creates a branch with the recorded decisions as changed by `edits`, and opens the branch.
    pub(super) fn adopt_branch(&mut self, week: u32, edits: &[DecisionEdit]) {
        let Some(open) = &mut self.active_run else { return };
        let mode = open.session().manifest().mode.branch_mode();
        let mut on = |_| ControlFlow::Continue(());
        let adopted = match open {
            ActiveRun::Live(session) => create_branch_with_decisions(session, week, edits, mode, &mut on),
            // The session of a playback ends at the current position, so open the complete run.
            ActiveRun::Playback(_) => recorded_folder(open).and_then(|folder| {
                let whole = Session::open(&folder, Access::Read, false);
                let whole = whole.map_err(|error| Rejection::new("not_readable", error.to_string()))?;
                create_branch_with_decisions(&whole, week, edits, mode, &mut on)
            }),
        };
        match adopted {
            Ok(adopted) => {
                let parent = open.session().manifest().id.clone();
                let refused = match adopted.rejected.len() {
                    0 => String::new(),
                    1 => "; 1 call was rejected, see the Journal".to_owned(),
                    some => format!("; {some} calls were rejected, see the Journal"),
                };
                let (id, day) = (adopted.session.manifest().id.clone(), adopted.session.day());
                let remark = format!(
                    "now playing run {id}, simulated to day {day}; run {parent} is unchanged{refused}"
                );
                let _ = self.detach(DetachCause::Quit);
                self.show_opened_run(Ok(adopted.session), "", Some(remark));
            }
            Err(rejection) => self.send_response(Response::NotOpened(rejection.to_string(), None)),
        }
    }
}

fn answer_question(
    question: &BranchesQuestion,
    what_if: &mut WhatIf,
    reply: &Reply<BranchesQuestion>,
) -> Result<Option<BranchesAnswer>, Rejection> {
    let instant = Mutex::new(Instant::now());
    let progress = |done, all| {
        // Every thread reports every day, which is more often than necessary.
        if let Ok(mut last_report) = instant.try_lock()
            && last_report.elapsed() >= DAY_REPORT_INTERVAL
        {
            *last_report = Instant::now();
            reply.report_progress((done, all));
        }
        reply.check_still_awaited()
    };
    let (week, alternatives, futures) = match question {
        BranchesQuestion::Decisions => {
            return Ok(Some(BranchesAnswer::Decisions(what_if.history()?.into())));
        }
        BranchesQuestion::Check { week, edits } => {
            return Ok(what_if.check(*week, edits, &progress)?.map(BranchesAnswer::Checked));
        }
        BranchesQuestion::Compare { week, alternatives, futures } => (*week, alternatives, *futures),
    };
    let found = what_if.compare_with_futures((week, None), alternatives, futures, &progress)?;
    Ok(found.map(|(compared, drawn)| BranchesAnswer::Compared(Box::new(compared), drawn.map(Box::new))))
}
