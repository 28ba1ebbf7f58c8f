//! What would have been, found on a thread of its own: the run goes on meanwhile.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::mpsc::Sender;
use std::time::Instant;

use super::answering::{answer_on_thread, lock_kept};
use super::causes::folder_of;
use super::{BETWEEN_DAYS, Open, SessionThread};
use crate::message::{Message, News};
use crate::resimulation::{BranchesAsked, BranchesFound, BranchesQuestion};
use novamind_insight::{DecisionEdit, WhatIf, branch_with_decisions, look_at_what_if, unless_stopped};
use novamind_session::record::LeavingCause;
use novamind_session::{Access, Refusal, Session};

impl SessionThread {
    /// Finds what would have been, and reports how far that has come.
    pub(super) fn find_branches(&mut self, asked: BranchesAsked) {
        let Some(open) = &mut self.open else { return };
        let folder = folder_of(open);
        let is_recorded = match &asked.question {
            BranchesQuestion::Compare { week, .. } => {
                let week = *week;
                self.session_to_look_into(false).is_ok_and(|session| look_at_what_if(session, week))
            }
            BranchesQuestion::Decisions => false,
        };
        let (news, kept) = (self.news.clone(), self.branches.clone());
        let number = asked.number;
        let progress = news.clone();
        let work = move || {
            let mut kept = lock_kept(&kept);
            let own = kept.of(folder?)?;
            own.tell_hidden(is_recorded);
            answer(&asked, own, &progress)
        };
        answer_on_thread(news, work, move |found| News::Branches(number, Box::new(found)));
    }

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
    asked: &BranchesAsked,
    own: &mut WhatIf,
    news: &Sender<Message>,
) -> Result<Option<BranchesFound>, Refusal> {
    let told = Mutex::new(Instant::now());
    let progress = |done, all| {
        // Every processor tells of every day; the screen needs no more than it can show.
        if let Ok(mut told) = told.try_lock()
            && told.elapsed() >= BETWEEN_DAYS
        {
            *told = Instant::now();
            let _ = news.send(Message::News(News::BranchesProgress(asked.number, done, all)));
        }
        unless_stopped(&asked.stop)
    };
    let (week, alternatives, futures) = match &asked.question {
        BranchesQuestion::Decisions => {
            return Ok(Some(BranchesFound::Decisions(own.decisions(1)?, own.days_per_week())));
        }
        BranchesQuestion::Compare { week, alternatives, futures } => (*week, alternatives, *futures),
    };
    let found = own.answer((week, None), alternatives, futures, &progress)?;
    Ok(found.map(|(compared, drawn)| BranchesFound::Compared(Box::new(compared), drawn.map(Box::new))))
}
