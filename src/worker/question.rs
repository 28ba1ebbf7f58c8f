//! Questions of pages and their answers. The page keeps a [`Pending`], and the worker keeps the matching [`Reply`]. An
//! answer reaches only the page that asked, and only if the page has not asked again.
//!
//! Answers are sent as a [`Message`], in order with all other messages.

use std::any::Any;
use std::fmt::Debug;
use std::ops::ControlFlow;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use super::background::catch_panic;
use super::{Job, SessionThread, Workers};
use crate::message::{Delivery, Message};
use novamind_database::QueryTicket;
use novamind_tools::Rejection;

/// A question that a page sends to the worker.
pub trait Question: Clone + Debug + Send + Sync + 'static {
    /// Type of the answer.
    type Answer: Send + 'static;
    /// Type of progress reports; `()` if progress is not reported.
    type Progress: Copy + Send + 'static;

    /// Answers the question on the session thread, or passes the reply to another thread.
    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>);

    /// Answers the question while the session thread is simulating a week. By default, waits for the session thread.
    fn answer_while_busy(self, reply: Reply<Self>, workers: &Workers) {
        workers.ask_session_thread(self, reply);
    }
}

/// The page's side of a question. If the page drops this value or asks again, the answer is discarded and the work is
/// cancelled if possible.
pub struct Pending<Q: Question>(Option<(Q, Arc<Slot<Q>>)>);

type Slot<Q> = Mutex<ReplyState<Q>>;

struct ReplyState<Q: Question> {
    progress: Option<Q::Progress>,
    answer: Option<Result<Q::Answer, Rejection>>,
}

impl<Q: Question> Default for ReplyState<Q> {
    fn default() -> Self {
        ReplyState { progress: None, answer: None }
    }
}

/// Locks a slot. Ignores poisoning, because no code panics between dependent changes.
fn lock_slot<Q: Question>(slot: &Slot<Q>) -> MutexGuard<'_, ReplyState<Q>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<Q: Question> Default for Pending<Q> {
    fn default() -> Self {
        Pending(None)
    }
}

impl<Q: Question> Pending<Q> {
    /// Returns a pending question, and the outgoing question to send to the worker.
    pub fn with_question(question: Q) -> (Pending<Q>, OutgoingQuestion) {
        let mut pending = Pending::default();
        let ask = pending.ask(question);
        (pending, ask)
    }

    /// Asks a question and cancels the previous question. The caller must send the returned question to the worker.
    pub fn ask(&mut self, question: Q) -> OutgoingQuestion {
        let slot = Arc::default();
        let typed_question = TypedQuestion { question: question.clone(), slot: Arc::downgrade(&slot) };
        self.0 = Some((question, slot));
        OutgoingQuestion(Arc::new(typed_question))
    }

    /// Returns the unanswered question, if any.
    pub fn question(&self) -> Option<&Q> {
        self.0.as_ref().map(|(question, _)| question)
    }

    /// Returns whether a question is unanswered.
    pub fn is_waiting(&self) -> bool {
        self.0.is_some()
    }

    /// Returns the last reported progress of the unanswered question.
    pub fn progress(&self) -> Option<Q::Progress> {
        lock_slot(&self.0.as_ref()?.1).progress
    }

    /// Takes the question and its answer, if the answer has been received.
    pub fn try_take(&mut self) -> Option<(Q, Result<Q::Answer, Rejection>)> {
        let answer = lock_slot(&self.0.as_ref()?.1).answer.take()?;
        let (question, _) = self.0.take()?;
        Some((question, answer))
    }

    /// Cancels the unanswered question.
    pub fn cancel(&mut self) {
        self.0 = None;
    }
}

/// A question to send to the worker.
#[derive(Debug, Clone)]
pub struct OutgoingQuestion(Arc<dyn ErasedQuestion>);

#[derive(Debug)]
struct TypedQuestion<Q: Question> {
    question: Q,
    slot: Weak<Slot<Q>>,
}

trait ErasedQuestion: Any + Debug + Send + Sync {
    fn send_to(&self, workers: &Workers, is_busy: bool);
}

impl<Q: Question> ErasedQuestion for TypedQuestion<Q> {
    fn send_to(&self, workers: &Workers, is_busy: bool) {
        let news = workers.messages.clone();
        // Take the ticket now, because the user may stop the query before the query starts.
        let ticket = workers.queries.ticket();
        let reply = Reply { slot: self.slot.clone(), messages: news, ticket, is_answered: false };
        let question = self.question.clone();
        match is_busy {
            true => question.answer_while_busy(reply, workers),
            false => workers.ask_session_thread(question, reply),
        }
    }
}

impl Workers {
    /// Sends a question to the worker. `is_busy` is true while the session thread is simulating a week.
    pub fn ask(&self, ask: &OutgoingQuestion, is_busy: bool) {
        ask.0.send_to(self, is_busy);
    }

    /// Sends a question to the session thread, which answers after all earlier jobs.
    pub(super) fn ask_session_thread<Q: Question>(&self, question: Q, reply: Reply<Q>) {
        self.send(Job::AnswerQuestion(Box::new(move |thread| question.answer(thread, reply))));
    }
}

/// The worker's side of a question. If the reply is dropped without an answer, because the work panicked or was
/// impossible, the page receives an error.
pub struct Reply<Q: Question> {
    slot: Weak<Slot<Q>>,
    messages: Sender<Message>,
    /// Ticket that lets the user stop the query.
    pub(super) ticket: Option<QueryTicket>,
    is_answered: bool,
}

impl<Q: Question> Reply<Q> {
    /// Sends the answer to the page.
    pub fn answer(mut self, answer: Result<Q::Answer, Rejection>) {
        self.send_answer(answer);
    }

    fn send_answer(&mut self, answer: Result<Q::Answer, Rejection>) {
        self.is_answered = true;
        self.deliver(true, |arrived| arrived.answer = Some(answer));
    }

    /// Reports the progress of the work to the page.
    pub fn report_progress(&self, progress: Q::Progress) {
        self.deliver(false, move |arrived| arrived.progress = Some(progress));
    }

    /// Returns `Break` if the page no longer waits.
    pub fn check_still_awaited(&self) -> ControlFlow<()> {
        match self.slot.strong_count() {
            0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }

    /// Runs `work` on a new thread and answers with its result, or with a rejection if `work` panics. `work` returns
    /// `None` if the page no longer waits.
    pub fn answer_on_thread(
        self,
        work: impl FnOnce(&Reply<Q>) -> Result<Option<Q::Answer>, Rejection> + Send + 'static,
    ) {
        std::thread::spawn(move || {
            let found = catch_panic(|| work(&self)).unwrap_or_else(Err);
            if let Some(answer) = found.transpose() {
                self.answer(answer);
            }
        });
    }

    fn deliver(&self, is_answer: bool, put: impl FnOnce(&mut ReplyState<Q>) + Send + 'static) {
        let slot = self.slot.clone();
        let put = Box::new(move || {
            if let Some(slot) = slot.upgrade() {
                put(&mut lock_slot(&slot));
            }
        });
        // Ignore the error: the receiver may already have been dropped because the program is ending.
        let _ = self.messages.send(Message::Delivered(Delivery { store: put, is_answer }));
    }
}

impl<Q: Question> Drop for Reply<Q> {
    fn drop(&mut self) {
        if !self.is_answered {
            let message = "no answer because of an internal error; nothing was changed, try again";
            self.send_answer(Err(Rejection::new("internal_error", message)));
        }
    }
}

/// Functions that replace the worker in tests of pages.
#[cfg(any(test, feature = "test-kit"))]
mod test_support {
    use super::*;

    impl<Q: Question> Pending<Q> {
        /// Sets the answer to the pending question.
        pub fn set_answer(&self, answer: Result<Q::Answer, Rejection>) {
            if let Some((_, slot)) = &self.0 {
                lock_slot(slot).answer = Some(answer);
            }
        }

        /// Sets the progress of the pending question.
        #[cfg(any(test, feature = "test-kit"))]
        pub fn set_progress(&self, progress: Q::Progress) {
            if let Some((_, slot)) = &self.0 {
                lock_slot(slot).progress = Some(progress);
            }
        }
    }

    impl OutgoingQuestion {
        /// Returns the question if its type is `Q`.
        pub fn question<Q: Question>(&self) -> Option<&Q> {
            self.as_typed().map(|typed_question| &typed_question.question)
        }

        /// Returns a reply to the page if the type of the question is `Q`.
        pub fn reply<Q: Question>(&self, news: Sender<Message>) -> Option<Reply<Q>> {
            let slot = self.as_typed::<Q>()?.slot.clone();
            Some(Reply { slot, messages: news, ticket: None, is_answered: false })
        }

        fn as_typed<Q: Question>(&self) -> Option<&TypedQuestion<Q>> {
            let asked: &dyn Any = self.0.as_ref();
            asked.downcast_ref()
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};
    use std::time::Duration;

    use super::*;
    use crate::message::Response;
    use novamind_record::folder::configuration::Configuration;

    /// A test question that is answered with its number, or fails.
    #[derive(Debug, Clone, PartialEq)]
    enum TestQuestion {
        Number(u32),
        Crash,
        CrashOnThread,
        Forget,
    }

    impl Question for TestQuestion {
        type Answer = u32;
        type Progress = u32;

        fn answer(self, _: &mut SessionThread, reply: Reply<Self>) {
            match self {
                TestQuestion::Number(number) => {
                    reply.report_progress(number * 10);
                    reply.answer(Ok(number));
                }
                TestQuestion::Crash => panic!("a defect"),
                TestQuestion::CrashOnThread => reply.answer_on_thread(|_| panic!("a defect")),
                TestQuestion::Forget => {}
            }
        }
    }

    const RESPONSE_TIMEOUT: Duration = Duration::from_secs(60);

    fn start_workers() -> (Workers, Receiver<Message>) {
        let (sender, messages) = channel();
        (Workers::start(sender, Configuration::bundled(), "nowhere".into(), false), messages)
    }

    /// Delivers all messages up to and including the next answer.
    fn deliver_until_answer(messages: &Receiver<Message>) {
        loop {
            if let Message::Delivered(delivery) = messages.recv_timeout(RESPONSE_TIMEOUT).expect("a message")
            {
                let is_answer = delivery.is_answer;
                delivery.deliver();
                if is_answer {
                    return;
                }
            }
        }
    }

    #[test]
    fn answer_is_taken_once_with_its_question() {
        let (workers, messages) = start_workers();
        let mut pending = Pending::default();
        workers.ask(&pending.ask(TestQuestion::Number(3)), false);
        assert_eq!((pending.question(), pending.progress()), (Some(&TestQuestion::Number(3)), None));
        deliver_until_answer(&messages);
        assert_eq!(pending.progress(), Some(30));
        let (question, answer) = pending.try_take().expect("an answer");
        assert_eq!((question, answer.ok()), (TestQuestion::Number(3), Some(3)));
        assert!(!pending.is_waiting() && pending.try_take().is_none());
        workers.shut_down();
    }

    #[test]
    fn answers_to_earlier_questions_are_dropped() {
        let (workers, messages) = start_workers();
        let mut pending = Pending::default();
        let asks = [1, 2].map(|number| pending.ask(TestQuestion::Number(number)));
        asks.iter().for_each(|ask| workers.ask(ask, false));
        deliver_until_answer(&messages);
        assert!(pending.try_take().is_none() && pending.progress().is_none(), "the first answer");
        deliver_until_answer(&messages);
        assert_eq!(pending.try_take().and_then(|(_, answer)| answer.ok()), Some(2));
        // An earlier answer is also dropped if the later question is asked after the answer was sent.
        workers.ask(&pending.ask(TestQuestion::Number(3)), false);
        let first = messages.iter().find_map(|message| match message {
            Message::Delivered(delivery) if delivery.is_answer => Some(delivery),
            _ => None,
        });
        workers.ask(&pending.ask(TestQuestion::Number(4)), false);
        first.expect("an answer").deliver();
        assert!(pending.try_take().is_none());
        workers.shut_down();
    }

    #[test]
    fn dropped_page_cancels_its_question() {
        let (sender, messages) = channel();
        let mut pending = Pending::default();
        let reply = pending.ask(TestQuestion::Number(1)).reply::<TestQuestion>(sender).expect("of this type");
        assert!(reply.check_still_awaited().is_continue());
        drop(pending);
        assert!(reply.check_still_awaited().is_break());
        reply.report_progress(1);
        reply.answer(Ok(1));
        assert_eq!(messages.iter().count(), 2, "both messages arrive and are dropped");
    }

    #[test]
    fn failed_questions_are_answered_with_an_error() {
        for (question, words) in
            [(TestQuestion::CrashOnThread, "internal error (a defect)"), (TestQuestion::Forget, "no answer")]
        {
            let (workers, messages) = start_workers();
            let mut pending = Pending::default();
            workers.ask(&pending.ask(question), false);
            deliver_until_answer(&messages);
            let (_, answer) = pending.try_take().expect("an answer");
            let rejection = answer.expect_err("a rejection");
            assert!(rejection.code == "internal_error" && rejection.message.contains(words), "{rejection}");
            workers.shut_down();
        }
        // A panic on the session thread ends the program, but later questions are answered with an error.
        let (workers, messages) = start_workers();
        let mut pages = [Pending::default(), Pending::default()];
        for (page, question) in pages.iter_mut().zip([TestQuestion::Crash, TestQuestion::Number(1)]) {
            workers.ask(&page.ask(question), false);
        }
        deliver_until_answer(&messages);
        assert!(pages[0].try_take().is_some_and(|(_, answer)| answer.is_err()));
        let crashed = messages.recv_timeout(RESPONSE_TIMEOUT);
        assert!(matches!(crashed, Ok(Message::Response(Response::Crashed(words))) if words == "a defect"));
        deliver_until_answer(&messages);
        assert!(pages[1].try_take().is_some_and(|(_, answer)| answer.is_err()));
        workers.shut_down();
    }
}
