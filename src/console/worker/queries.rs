//! The threads that ask the database, each over a connection of its own.

use std::sync::mpsc::{Sender, channel};
use std::time::Instant;

use super::Job;
use crate::console::message::{Message, News};
use crate::console::readings::Reading;
use crate::database::query::Limits;
use crate::session::{Interrupt, QueryConnection, QuerySource, Refusal, Session, Ticket};

/// A question for the database.
pub struct Question {
    sql: String,
    by: AskedBy,
}

/// Who asked, with what tells the answer from others.
enum AskedBy {
    Person(u64, Option<Ticket>, QuerySource),
    Screen(Reading, u64),
}

impl Question {
    /// A question of the person: its number, the ticket by which it can be stopped, and where it came from.
    pub fn of_person(sql: String, number: u64, ticket: Option<Ticket>, via: QuerySource) -> Question {
        Question { sql, by: AskedBy::Person(number, ticket, via) }
    }

    /// A question of a screen, with the number of changes of the run before it.
    pub fn of_screen(reading: Reading, changes: u64) -> Question {
        Question { sql: reading.sql().to_owned(), by: AskedBy::Screen(reading, changes) }
    }
}

/// The way to the threads that ask: the person's questions and those of screens do not wait for each other.
#[derive(Clone)]
pub(super) struct QueryThreads {
    person: Sender<QueryJob>,
    screens: Sender<QueryJob>,
}

enum QueryJob {
    Connect(Box<QueryConnection>, Limits),
    Ask(Question),
    Disconnect,
}

impl QueryThreads {
    /// Starts the threads; what they report goes into the channel of news, what is recorded into that of jobs.
    pub(super) fn start(news: &Sender<Message>, jobs: &Sender<Job>) -> QueryThreads {
        let start = || start_thread(news.clone(), jobs.clone());
        QueryThreads { person: start(), screens: start() }
    }

    /// Gives each thread a connection to a run's database; returns what stops the person's queries.
    pub(super) fn connect(&self, session: &Session) -> Option<Interrupt> {
        let limits = session.query_limits();
        let mut interrupt = None;
        if let Ok(own) = session.open_connection() {
            interrupt = Some(own.interrupt());
            let _ = self.person.send(QueryJob::Connect(Box::new(own), limits));
        }
        if let Ok(own) = session.open_connection() {
            let _ = self.screens.send(QueryJob::Connect(Box::new(own), limits));
        }
        interrupt
    }

    /// Ends the connections, so that the database can be closed.
    pub(super) fn disconnect(&self) {
        for thread in [&self.person, &self.screens] {
            let _ = thread.send(QueryJob::Disconnect);
        }
    }

    /// Asks on the thread that it is for.
    pub(super) fn ask(&self, question: Question) {
        let thread = match question.by {
            AskedBy::Person(..) => &self.person,
            AskedBy::Screen(..) => &self.screens,
        };
        // The threads end with the program.
        let _ = thread.send(QueryJob::Ask(question));
    }
}

fn start_thread(news: Sender<Message>, jobs: Sender<Job>) -> Sender<QueryJob> {
    let (asked, questions) = channel();
    std::thread::spawn(move || {
        let mut connection: Option<(Box<QueryConnection>, Limits)> = None;
        while let Ok(job) = questions.recv() {
            match job {
                QueryJob::Connect(own, limits) => connection = Some((own, limits)),
                QueryJob::Disconnect => connection = None,
                QueryJob::Ask(question) => answer(question, connection.as_ref(), &news, &jobs),
            }
        }
    });
    asked
}

fn answer(
    question: Question,
    connection: Option<&(Box<QueryConnection>, Limits)>,
    news: &Sender<Message>,
    jobs: &Sender<Job>,
) {
    let started = Instant::now();
    let rows = match (connection, &question.by) {
        (Some((connection, limits)), AskedBy::Person(_, Some(ticket), _)) => {
            connection.ask_as(*ticket, &question.sql, *limits).map_err(Refusal::from)
        }
        (Some((connection, limits)), _) => connection.ask(&question.sql, *limits).map_err(Refusal::from),
        (None, _) => Err(Refusal::new("sql_error", "no run is open")),
    };
    let took = started.elapsed();
    let report = match question.by {
        AskedBy::Person(number, _, via) => {
            let noted = rows.clone();
            let _ = jobs.send(Job::NoteQuery(question.sql, noted, took, via));
            News::Answered(number, rows, took)
        }
        AskedBy::Screen(reading, changes) => News::Read(reading, changes, rows),
    };
    let _ = news.send(Message::News(report));
}
