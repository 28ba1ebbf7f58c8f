//! The threads that ask the database, each over a connection of its own.

use std::sync::mpsc::{Sender, channel};
use std::time::Instant;

use super::Job;
use super::answering::catch_defect;
use crate::message::{Message, News};
use crate::readings::Reading;
use novamind_database::query::Limits;
use novamind_session::{
    Interrupt, QueryConnection, QuerySource, Refusal, Rows, Session, Ticket, query_refusal,
};

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

type Connection = (Box<QueryConnection>, Limits);

/// Answers a question over a connection.
type AskDatabase = fn(&Connection, &Question) -> Result<Rows, Refusal>;

enum QueryJob {
    Connect(Box<QueryConnection>, Limits),
    Ask(Question),
    Disconnect,
}

impl QueryThreads {
    /// Starts the threads; what they report goes into the channel of news, what is recorded into that of jobs.
    pub(super) fn start(news: &Sender<Message>, jobs: &Sender<Job>) -> QueryThreads {
        let start = || start_thread(news.clone(), jobs.clone(), ask);
        QueryThreads { person: start(), screens: start() }
    }

    /// Gives each thread a connection to a run's database; returns what stops the person's queries.
    pub(super) fn connect(&self, session: &Session) -> Option<Interrupt> {
        let limits = session.company().query_limits();
        let mut interrupt = None;
        if let Ok(own) = session.database().open_connection() {
            interrupt = Some(own.interrupt());
            let _ = self.person.send(QueryJob::Connect(Box::new(own), limits));
        }
        if let Ok(own) = session.database().open_connection() {
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

fn start_thread(news: Sender<Message>, jobs: Sender<Job>, ask: AskDatabase) -> Sender<QueryJob> {
    let (asked, questions) = channel();
    std::thread::spawn(move || {
        let mut connection: Option<Connection> = None;
        while let Ok(job) = questions.recv() {
            match job {
                QueryJob::Connect(own, limits) => connection = Some((own, limits)),
                QueryJob::Disconnect => connection = None,
                QueryJob::Ask(question) => answer(question, &mut connection, ask, &news, &jobs),
            }
        }
    });
    asked
}

fn answer(
    question: Question,
    connection: &mut Option<Connection>,
    ask: AskDatabase,
    news: &Sender<Message>,
    jobs: &Sender<Job>,
) {
    let started = Instant::now();
    let rows = match connection.as_ref().map(|own| catch_defect(|| ask(own, &question))) {
        None => Err(Refusal::new("sql_error", "no run is open")),
        Some(Ok(rows)) => rows,
        Some(Err(defect)) => {
            // What guards the connection may be half done: it is never used again.
            *connection = None;
            let _ = jobs.send(Job::Reconnect);
            Err(defect)
        }
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

fn ask((connection, limits): &Connection, question: &Question) -> Result<Rows, Refusal> {
    let rows = match question.by {
        AskedBy::Person(_, Some(ticket), _) => connection.ask_as(ticket, &question.sql, *limits),
        AskedBy::Person(..) | AskedBy::Screen(..) => connection.ask(&question.sql, *limits),
    };
    rows.map_err(query_refusal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::played;

    /// Panics on one statement.
    fn ask_or_panic(connection: &Connection, question: &Question) -> Result<Rows, Refusal> {
        assert_ne!(question.sql, "SELECT 'defect'", "a defect");
        ask(connection, question)
    }

    #[test]
    fn query_thread_answers_after_a_panic_and_asks_for_a_new_connection() {
        let session = played(0);
        let (news, answers) = channel();
        let (jobs, asked) = channel();
        let thread = start_thread(news, jobs, ask_or_panic);
        let connect = || {
            let connection = session.database().open_connection().expect("a connection");
            let _ = thread.send(QueryJob::Connect(Box::new(connection), session.company().query_limits()));
        };
        let answer = |sql: &str, number| {
            let question = Question::of_person(sql.to_owned(), number, None, QuerySource::Typed);
            let _ = thread.send(QueryJob::Ask(question));
            match answers.recv().expect("an answer") {
                Message::News(News::Answered(of, rows, _)) if of == number => rows,
                _ => panic!("other news"),
            }
        };
        connect();
        assert!(answer("SELECT 1", 1).is_ok());
        let refused = answer("SELECT 'defect'", 2).expect_err("a panic");
        assert_eq!(refused.code, "internal_error");
        // The connection that met the panic is never used again.
        assert_eq!(answer("SELECT 1", 3).expect_err("no connection").code, "sql_error");
        let noted = |job| matches!(job, Job::NoteQuery(..));
        assert!(noted(asked.recv().expect("a job")));
        assert!(matches!(asked.recv().expect("a job"), Job::Reconnect));
        assert!(noted(asked.recv().expect("a job")));
        connect();
        assert!(answer("SELECT 1", 4).is_ok());
    }
}
