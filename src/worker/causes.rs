//! Causes of a change, found on a thread of their own: the run goes on meanwhile.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::mpsc::Sender;

use super::answering::{answer_on_thread, lock_kept};
use super::{Open, SessionThread};
use crate::message::{Message, News};
use crate::resimulation::WhyAsked;
use novamind_insight::{
    Causes, LastRead, WeekQuestion, Why, folder_of_causes, look_at_figure, unless_stopped,
};
use novamind_session::Refusal;

impl SessionThread {
    /// Finds causes, and reports how far that has come and what they are.
    pub(super) fn find_causes(&mut self, asked: WhyAsked) {
        let Some(open) = &self.open else { return };
        let question = WeekQuestion { quantity: asked.quantity, week: Some(asked.week) };
        let mut folder = folder_of(open);
        if question.quantity.is_hidden() {
            // A look, which is recorded before anything is shown.
            let looked =
                self.session_to_look_into(false).and_then(|session| look_at_figure(session, &question));
            folder = looked.and(folder);
        }
        let (news, kept) = (self.news.clone(), self.causes.clone());
        let number = asked.number;
        answer_on_thread(
            news.clone(),
            move || folder.and_then(|folder| answer(&asked, question, folder, &kept, &news)),
            move |answer| News::Why(number, Box::new(answer)),
        );
    }
}

/// The folder from which a run is simulated again.
pub(super) fn folder_of(open: &Open) -> Result<PathBuf, Refusal> {
    match open {
        Open::Played(session) => folder_of_causes(session),
        // What a record allows is read from it: it may be over though this moment of it is not.
        Open::Replayed(playback) => playback.session().folder().map(Path::to_owned).ok_or_else(|| {
            Refusal::new("not_possible", "this trajectory stands alone, without the folder of its run")
        }),
    }
}

fn answer(
    asked: &WhyAsked,
    question: WeekQuestion,
    folder: PathBuf,
    kept: &Mutex<LastRead<Causes>>,
    news: &Sender<Message>,
) -> Result<Option<Why>, Refusal> {
    let mut kept = lock_kept(kept);
    kept.of(folder)?.why(question, &|progress| {
        let _ = news.send(Message::News(News::WhyProgress(asked.number, progress)));
        unless_stopped(&asked.stop)
    })
}
