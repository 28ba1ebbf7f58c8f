//! The page of the opponents over what is shown.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::{App, Order};
use crate::dialogs::opponents::OpponentsPage;
use novamind_worker::Job;

impl App {
    /// The strong policies beside the run that is over.
    pub(super) fn show_opponents(&mut self) {
        let page = OpponentsPage::default();
        let asks = page.opening_question();
        self.open(page);
        self.follow(vec![asks]);
    }

    pub(super) fn ask_opponents(&mut self, stop: Arc<AtomicBool>) {
        self.opponents_question += 1;
        let job = Job::PlayOpponents(self.opponents_question, self.opponents, stop);
        self.orders.push(Order::Job(job));
    }
}
