//! Questions of pages and their answers. A page keeps a [`Pending`], the worker the matching [`Reply`]: an answer
//! reaches only the page that asked, and only for its latest question.
//!
//! An answer arrives as a [`Message`], in order with all other messages.

use std::any::Any;
use std::fmt::Debug;
use std::ops::ControlFlow;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use super::answering::catch_defect;
use super::{Job, SessionThread, Workers};
use crate::message::{Delivery, Message};
use novamind_database::Ticket;
use novamind_tools::Refusal;

/// A question that a page sends to the worker.
pub trait Question: Clone + Debug + Send + Sync + 'static {
    /// The answer.
    type Answer: Send + 'static;
    /// Progress of the work; `()` if it is not reported.
    type Progress: Copy + Send + 'static;

    /// Answers on the session thread, or passes the reply to another thread.
    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>);

    /// Answers without the session thread, which is busy with a week, if possible.
    fn answer_at_once(self, reply: Reply<Self>, workers: &Workers) {
        workers.ask_in_turn(self, reply);
    }
}

/// The page's side of a question. If it is dropped or asks again, the answer is dropped and the work is cancelled if
/// possible.
pub struct Pending<Q: Question>(Option<(Q, Arc<Slot<Q>>)>);

type Slot<Q> = Mutex<Arrived<Q>>;

struct Arrived<Q: Question> {
    progress: Option<Q::Progress>,
    answer: Option<Result<Q::Answer, Refusal>>,
}

impl<Q: Question> Default for Arrived<Q> {
    fn default() -> Self {
        Arrived { progress: None, answer: None }
    }
}

/// Ignores poisoning: no code panics between dependent changes.
fn lock<Q: Question>(slot: &Slot<Q>) -> MutexGuard<'_, Arrived<Q>> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<Q: Question> Default for Pending<Q> {
    fn default() -> Self {
        Pending(None)
    }
}

impl<Q: Question> Pending<Q> {
    /// Returns the pending question, and the question to send.
    pub fn asking(question: Q) -> (Pending<Q>, Ask) {
        let mut pending = Pending::default();
        let ask = pending.ask(question);
        (pending, ask)
    }

    /// Asks a question, and cancels the previous one.
    pub fn ask(&mut self, question: Q) -> Ask {
        let slot = Arc::default();
        let asked = Asked { question: question.clone(), slot: Arc::downgrade(&slot) };
        self.0 = Some((question, slot));
        Ask(Arc::new(asked))
    }

    /// Returns the unanswered question.
    pub fn question(&self) -> Option<&Q> {
        self.0.as_ref().map(|(question, _)| question)
    }

    /// Returns whether a question is unanswered.
    pub fn is_waiting(&self) -> bool {
        self.0.is_some()
    }

    /// Returns the last reported progress.
    pub fn progress(&self) -> Option<Q::Progress> {
        lock(&self.0.as_ref()?.1).progress
    }

    /// Takes the question and its answer if it has arrived.
    pub fn try_take(&mut self) -> Option<(Q, Result<Q::Answer, Refusal>)> {
        let answer = lock(&self.0.as_ref()?.1).answer.take()?;
        let (question, _) = self.0.take()?;
        Some((question, answer))
    }

    /// Cancels the question.
    pub fn cancel(&mut self) {
        self.0 = None;
    }
}

/// A question to send to the worker.
#[derive(Debug, Clone)]
pub struct Ask(Arc<dyn AnyAsked>);

#[derive(Debug)]
struct Asked<Q: Question> {
    question: Q,
    slot: Weak<Slot<Q>>,
}

trait AnyAsked: Any + Debug + Send + Sync {
    fn hand_over(&self, workers: &Workers, is_busy: bool);
}

impl<Q: Question> AnyAsked for Asked<Q> {
    fn hand_over(&self, workers: &Workers, is_busy: bool) {
        let news = workers.news.clone();
        // The ticket is taken now, because a stop may arrive before the query starts.
        let ticket = workers.queries.ticket();
        let reply = Reply { slot: self.slot.clone(), news, ticket, is_answered: false };
        let question = self.question.clone();
        match is_busy {
            true => question.answer_at_once(reply, workers),
            false => workers.ask_in_turn(question, reply),
        }
    }
}

impl Workers {
    /// Sends a question. With `is_busy`, the session thread is busy with a week.
    pub fn ask(&self, ask: &Ask, is_busy: bool) {
        ask.0.hand_over(self, is_busy);
    }

    /// Asks the session thread, after all earlier jobs.
    pub(super) fn ask_in_turn<Q: Question>(&self, question: Q, reply: Reply<Q>) {
        self.send(Job::Ask(Box::new(move |thread| question.answer(thread, reply))));
    }
}

/// The worker's side of a question. If it is dropped without an answer, because the work panicked or was impossible,
/// the page receives an error.
pub struct Reply<Q: Question> {
    slot: Weak<Slot<Q>>,
    news: Sender<Message>,
    /// Stops a query of the user.
    pub(super) ticket: Option<Ticket>,
    is_answered: bool,
}

impl<Q: Question> Reply<Q> {
    /// Sends the answer.
    pub fn answer(mut self, answer: Result<Q::Answer, Refusal>) {
        self.send_answer(answer);
    }

    fn send_answer(&mut self, answer: Result<Q::Answer, Refusal>) {
        self.is_answered = true;
        self.deliver(true, |arrived| arrived.answer = Some(answer));
    }

    /// Reports the progress of the work.
    pub fn report(&self, progress: Q::Progress) {
        self.deliver(false, move |arrived| arrived.progress = Some(progress));
    }

    /// Returns `Break` if the page no longer waits.
    pub fn go_on(&self) -> ControlFlow<()> {
        match self.slot.strong_count() {
            0 => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        }
    }

    /// Runs `work` on its own thread and answers with its result. A panic is answered with a rejection. `work`
    /// returns `None` if the page no longer waits.
    pub fn answer_on_thread(
        self,
        work: impl FnOnce(&Reply<Q>) -> Result<Option<Q::Answer>, Refusal> + Send + 'static,
    ) {
        std::thread::spawn(move || {
            let found = catch_defect(|| work(&self)).unwrap_or_else(Err);
            if let Some(answer) = found.transpose() {
                self.answer(answer);
            }
        });
    }

    fn deliver(&self, is_answer: bool, put: impl FnOnce(&mut Arrived<Q>) + Send + 'static) {
        let slot = self.slot.clone();
        let put = Box::new(move || {
            if let Some(slot) = slot.upgrade() {
                put(&mut lock(&slot));
            }
        });
        // The receiver is gone when the program ends.
        let _ = self.news.send(Message::Arrived(Delivery { put, is_answer }));
    }
}

impl<Q: Question> Drop for Reply<Q> {
    fn drop(&mut self) {
        if !self.is_answered {
            let message = "not answered because of an internal error; nothing was changed, try again";
            self.send_answer(Err(Refusal::new("internal_error", message)));
        }
    }
}

/// Replaces the worker in tests of pages.
#[cfg(any(test, feature = "test-kit"))]
mod in_tests {
    use super::*;

    impl<Q: Question> Pending<Q> {
        /// Sets the answer to the pending question.
        pub fn put(&self, answer: Result<Q::Answer, Refusal>) {
            if let Some((_, slot)) = &self.0 {
                lock(slot).answer = Some(answer);
            }
        }

        /// Sets the progress of the pending question.
        #[cfg(any(test, feature = "test-kit"))]
        pub fn put_progress(&self, progress: Q::Progress) {
            if let Some((_, slot)) = &self.0 {
                lock(slot).progress = Some(progress);
            }
        }
    }

    impl Ask {
        /// Returns the question if it has this type.
        pub fn question<Q: Question>(&self) -> Option<&Q> {
            self.asked().map(|asked| &asked.question)
        }

        /// Returns a reply to the page if the question has this type.
        pub fn reply<Q: Question>(&self, news: Sender<Message>) -> Option<Reply<Q>> {
            let slot = self.asked::<Q>()?.slot.clone();
            Some(Reply { slot, news, ticket: None, is_answered: false })
        }

        fn asked<Q: Question>(&self) -> Option<&Asked<Q>> {
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
    use crate::message::News;
    use novamind_record::folder::configuration::Configuration;

    /// Answers with its number, or fails.
    #[derive(Debug, Clone, PartialEq)]
    enum Test {
        Number(u32),
        Crash,
        CrashOnThread,
        Forget,
    }

    impl Question for Test {
        type Answer = u32;
        type Progress = u32;

        fn answer(self, _: &mut SessionThread, reply: Reply<Self>) {
            match self {
                Test::Number(number) => {
                    reply.report(number * 10);
                    reply.answer(Ok(number));
                }
                Test::Crash => panic!("a defect"),
                Test::CrashOnThread => reply.answer_on_thread(|_| panic!("a defect")),
                Test::Forget => {}
            }
        }
    }

    const PATIENCE: Duration = Duration::from_secs(60);

    fn workers() -> (Workers, Receiver<Message>) {
        let (sender, messages) = channel();
        (Workers::start(sender, Configuration::shipped(), "nowhere".into(), false), messages)
    }

    /// Delivers messages up to the next answer.
    fn until_answer(messages: &Receiver<Message>) {
        loop {
            if let Message::Arrived(delivery) = messages.recv_timeout(PATIENCE).expect("a message") {
                let is_answer = delivery.is_answer;
                delivery.deliver();
                if is_answer {
                    return;
                }
            }
        }
    }

    #[test]
    fn an_answer_is_taken_once_with_its_question_after_its_progress() {
        let (workers, messages) = workers();
        let mut pending = Pending::default();
        workers.ask(&pending.ask(Test::Number(3)), false);
        assert_eq!((pending.question(), pending.progress()), (Some(&Test::Number(3)), None));
        until_answer(&messages);
        assert_eq!(pending.progress(), Some(30));
        let (question, answer) = pending.try_take().expect("an answer");
        assert_eq!((question, answer.ok()), (Test::Number(3), Some(3)));
        assert!(!pending.is_waiting() && pending.try_take().is_none());
        workers.finish();
    }

    #[test]
    fn an_answer_to_an_earlier_question_is_not_that_of_a_later_one() {
        let (workers, messages) = workers();
        let mut pending = Pending::default();
        let asks = [1, 2].map(|number| pending.ask(Test::Number(number)));
        asks.iter().for_each(|ask| workers.ask(ask, false));
        until_answer(&messages);
        assert!(pending.try_take().is_none() && pending.progress().is_none(), "the first answer");
        until_answer(&messages);
        assert_eq!(pending.try_take().and_then(|(_, answer)| answer.ok()), Some(2));
        // The same if the later question is asked while the earlier answer is in transit.
        workers.ask(&pending.ask(Test::Number(3)), false);
        let first = messages.iter().find_map(|message| match message {
            Message::Arrived(delivery) if delivery.is_answer => Some(delivery),
            _ => None,
        });
        workers.ask(&pending.ask(Test::Number(4)), false);
        first.expect("an answer").deliver();
        assert!(pending.try_take().is_none());
        workers.finish();
    }

    #[test]
    fn an_answer_for_a_page_that_is_gone_is_dropped_and_its_work_ends() {
        let (sender, messages) = channel();
        let mut pending = Pending::default();
        let reply = pending.ask(Test::Number(1)).reply::<Test>(sender).expect("of this type");
        assert!(reply.go_on().is_continue());
        drop(pending);
        assert!(reply.go_on().is_break());
        reply.report(1);
        reply.answer(Ok(1));
        assert_eq!(messages.iter().count(), 2, "both messages arrive and are dropped");
    }

    #[test]
    fn a_question_that_crashes_or_is_forgotten_ends_the_waiting_of_its_page() {
        for (question, words) in
            [(Test::CrashOnThread, "internal error (a defect)"), (Test::Forget, "not answered")]
        {
            let (workers, messages) = workers();
            let mut pending = Pending::default();
            workers.ask(&pending.ask(question), false);
            until_answer(&messages);
            let (_, answer) = pending.try_take().expect("an answer");
            let refusal = answer.expect_err("a refusal");
            assert!(refusal.code == "internal_error" && refusal.message.contains(words), "{refusal}");
            workers.finish();
        }
        // A panic on the session thread ends the program; later questions are answered too.
        let (workers, messages) = workers();
        let mut pages = [Pending::default(), Pending::default()];
        for (page, question) in pages.iter_mut().zip([Test::Crash, Test::Number(1)]) {
            workers.ask(&page.ask(question), false);
        }
        until_answer(&messages);
        assert!(pages[0].try_take().is_some_and(|(_, answer)| answer.is_err()));
        let crashed = messages.recv_timeout(PATIENCE);
        assert!(matches!(crashed, Ok(Message::News(News::Crashed(words))) if words == "a defect"));
        until_answer(&messages);
        assert!(pages[1].try_take().is_some_and(|(_, answer)| answer.is_err()));
        workers.finish();
    }
}
