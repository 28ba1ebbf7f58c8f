//! The curve explorer over the screen.

use super::{App, Order};
use crate::dialogs::curve::CurvePage;
use novamind_session::identifiers::Group;
use novamind_worker::Job;

impl App {
    /// The curve of a group beside the plans; of the first known one if none is named.
    pub(super) fn show_curve(&mut self, group: Option<Group>) {
        let known = self.run().and_then(|run| run.company.seen.known_groups.first().copied());
        let Some(group) = group.or(known) else { return };
        self.open(CurvePage::new(group));
        self.ask_curve(group);
    }

    pub(super) fn ask_curve(&mut self, group: Group) {
        self.curve_question += 1;
        self.orders.push(Order::Job(Job::FindCurve(self.curve_question, group)));
    }
}
