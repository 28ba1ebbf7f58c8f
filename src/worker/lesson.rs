//! Lessons on the session thread: guesses, hints, retries, parts and the debrief.

use std::sync::Arc;

use super::background::answer_on_thread;
use super::{ActiveRun, SessionThread};
use crate::message::Response;
use crate::request::LessonRequest;
use novamind_course::{FinishedPart, retry_step, start_part, submit_guess, take_hint};
use novamind_record::trajectory::record::DetachCause;
use novamind_rules::calls_for_waiting_threads;
use novamind_session::Session;
use novamind_tools::Rejection;

impl SessionThread {
    pub(super) fn handle_lesson_request(&mut self, lesson_request: LessonRequest) {
        match lesson_request {
            LessonRequest::Guess(value) => self.respond_with(|run| {
                let refused = submit_guess(run.session, value).err();
                Response::LessonUpdated(refused, run.company())
            }),
            LessonRequest::Hint => self.respond_with(|run| {
                let refused = take_hint(run.session).err();
                Response::LessonUpdated(refused, run.company())
            }),
            LessonRequest::RetryStep(step) => self.switch_run(
                |session| retry_step(session, step),
                &format!("retrying step {}; the previous run is unchanged", step + 1),
            ),
            LessonRequest::StartPart(part) => {
                self.switch_run(
                    |session| start_part(session, part),
                    &format!("now playing part {}", part + 1),
                );
            }
            LessonRequest::Debrief => self.compute_debrief(),
        }
    }

    fn switch_run(&mut self, begin: impl FnOnce(&Session) -> Result<Session, Rejection>, remark: &str) {
        let Some(ActiveRun::Live(session)) = &self.active_run else { return };
        match begin(session) {
            Ok(begun) => {
                let _ = self.detach(DetachCause::Quit);
                self.show_opened_run(Ok(begun), "", Some(remark.to_owned()));
            }
            Err(rejection) => self.send_response(Response::NotOpened(rejection.to_string(), None)),
        }
    }

    /// Computes the debrief on a background thread, because the computation simulates the reference play.
    fn compute_debrief(&mut self) {
        let Some(open) = &mut self.active_run else { return };
        let (played, news) = (FinishedPart::from_session(open.session()), self.messages.clone());
        let work = move || played.map(|played| Some(played.debrief(calls_for_waiting_threads)));
        answer_on_thread(news, work, |debrief| Response::DebriefReady(Arc::new(debrief)));
    }
}
