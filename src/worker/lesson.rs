//! Lessons on the session thread: guesses, hints, retries, parts and the debrief.

use std::sync::Arc;

use super::answering::answer_on_thread;
use super::{Open, SessionThread};
use crate::message::News;
use crate::request::LessonRequest;
use novamind_course::{PlayedPart, begin_part, guess_in_lesson, take_hint, try_step_again};
use novamind_record::trajectory::record::LeavingCause;
use novamind_rules::answers_to_companies;
use novamind_session::Session;
use novamind_tools::Refusal;

impl SessionThread {
    pub(super) fn in_lesson(&mut self, asked: LessonRequest) {
        match asked {
            LessonRequest::Guess(value) => self.report(|run| {
                let refused = guess_in_lesson(run.session, value).err();
                News::InLesson(refused, run.company())
            }),
            LessonRequest::Hint => self.report(|run| {
                let refused = take_hint(run.session).err();
                News::InLesson(refused, run.company())
            }),
            LessonRequest::TryAgain(step) => self.go_to(
                |session| try_step_again(session, step),
                &format!("retrying step {}; the previous run is unchanged", step + 1),
            ),
            LessonRequest::BeginPart(part) => {
                self.go_to(|session| begin_part(session, part), &format!("part {} starts", part + 1));
            }
            LessonRequest::Debrief => self.find_debrief(),
        }
    }

    fn go_to(&mut self, begin: impl FnOnce(&Session) -> Result<Session, Refusal>, remark: &str) {
        let Some(Open::Played(session)) = &self.open else { return };
        match begin(session) {
            Ok(begun) => {
                let _ = self.put_down(LeavingCause::Quit);
                self.take(Ok(begun), "", Some(remark.to_owned()));
            }
            Err(refusal) => self.say(News::NotOpened(refusal.to_string(), None)),
        }
    }

    /// Computes the debrief on its own thread, because it simulates the reference play.
    fn find_debrief(&mut self) {
        let Some(open) = &mut self.open else { return };
        let (played, news) = (PlayedPart::of(open.session()), self.news.clone());
        let work = move || played.map(|played| Some(played.debrief(answers_to_companies)));
        answer_on_thread(news, work, |debrief| News::Debriefed(Arc::new(debrief)));
    }
}
