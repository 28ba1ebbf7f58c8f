//! The page of a what-if: where it begins, and what it asks.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::{App, Order};
use crate::dialogs::branches::BranchesPage;
use novamind_session::week_of;
use novamind_worker::Job;
use novamind_worker::resimulation::{BranchesAsked, BranchesQuestion};

/// Weeks before the end of a run that is over at which a what-if begins.
const WEEKS_BEFORE_END: u32 = 12;

impl App {
    /// The page of decisions, from the week that is shown on; in a run that is played, from the last one that ran on, and where
    /// the run is over from so far before its end that figures of twelve weeks follow.
    pub(super) fn show_branches(&mut self) {
        let Some(run) = self.run() else { return };
        let seen = &run.company.seen;
        let last_week = week_of(seen.day.min(seen.last_day.saturating_sub(1)) + 1);
        let back = match (run.company.is_running(), self.is_replay()) {
            (false, _) => WEEKS_BEFORE_END,
            (true, true) => 0,
            (true, false) => 1,
        };
        let week = last_week.saturating_sub(back).max(1);
        let page = BranchesPage::new(week, last_week);
        let asks = page.opening_question();
        self.open(page);
        self.follow(vec![asks]);
    }

    pub(super) fn ask_branches(&mut self, question: BranchesQuestion, stop: Arc<AtomicBool>) {
        self.branches_question += 1;
        let asked = BranchesAsked { number: self.branches_question, question, stop };
        self.orders.push(Order::Job(Job::FindBranches(asked)));
    }
}
