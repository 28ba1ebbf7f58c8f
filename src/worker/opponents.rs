//! The opponents of a run, played on a thread of their own.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::SessionThread;
use super::answering::answer_on_thread;
use crate::message::News;
use novamind_report::opponents::PlayOpponents;
use novamind_session::Refusal;

impl SessionThread {
    /// Plays the opponents of the run that is open, and reports what became of them.
    pub(super) fn play_opponents(&mut self, number: u64, play: PlayOpponents, stop: Arc<AtomicBool>) {
        let Some(open) = &mut self.open else { return };
        let missing = || Refusal::new("not_possible", "a run in memory has no record to play against");
        let folder = open.session().folder().map(Path::to_owned).ok_or_else(missing);
        let (news, configuration) = (self.news.clone(), self.configuration.clone());
        let work = move || {
            let goes_on = || !stop.load(Ordering::Relaxed);
            folder.and_then(|folder| play(&folder, &configuration, &goes_on))
        };
        answer_on_thread(news, work, move |found| News::Opponents(number, Box::new(found)));
    }
}
