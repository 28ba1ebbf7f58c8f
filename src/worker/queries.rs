//! The threads that query the database, each with a separate connection.

use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use super::background::catch_panic;
use super::{Job, SessionThread, Workers};
use crate::question::{Question, Reply};
use crate::screen_queries::Reading;
use novamind_database::query::QueryLimits;
use novamind_database::{Interrupt, QueryConnection, QueryResult, QueryTicket};
use novamind_record::trajectory::record::QuerySource;
use novamind_session::{Session, query_rejection};
use novamind_tools::Rejection;

/// An SQL query that the user entered or selected.
#[derive(Debug, Clone, PartialEq)]
pub struct Query {
    /// Statement as the user entered or selected it, before the permission check.
    pub sql: String,
    /// Tables that the statement is permitted to read.
    pub tables: QueriedTables,
}

/// The tables that a query of the user is permitted to read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QueriedTables {
    /// The public tables. The query is recorded with this source.
    Visible(QuerySource),
    /// The public tables and the hidden tables.
    Hidden,
}

impl Question for Query {
    /// Rows of the result, and the duration of the query.
    type Answer = (QueryResult, Duration);
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        match self.tables {
            QueriedTables::Visible(via) => thread.ask_database(DatabaseQuestion::Query(self.sql, via, reply)),
            QueriedTables::Hidden => reply.answer(thread.query_hidden_tables(&self.sql)),
        }
    }

    fn answer_while_busy(self, reply: Reply<Self>, workers: &Workers) {
        match self.tables {
            QueriedTables::Visible(via) => {
                workers.queries.ask(DatabaseQuestion::Query(self.sql, via, reply));
            }
            QueriedTables::Hidden => workers.ask_session_thread(self, reply),
        }
    }
}

impl Question for Reading {
    type Answer = QueryResult;
    type Progress = ();

    fn answer(self, thread: &mut SessionThread, reply: Reply<Self>) {
        thread.ask_database(DatabaseQuestion::Reading(self, reply));
    }

    fn answer_while_busy(self, reply: Reply<Self>, workers: &Workers) {
        workers.queries.ask(DatabaseQuestion::Reading(self, reply));
    }
}

impl SessionThread {
    /// Forwards a question to a query thread once the database contains all confirmed actions.
    fn ask_database(&mut self, question: DatabaseQuestion) {
        self.with_run(|run| {
            // After a failed write, the query returns the existing rows, and the screen shows a warning.
            let _ = run.session.wait_for_database();
            run.queries.ask(question);
        });
    }
}

enum DatabaseQuestion {
    Query(String, QuerySource, Reply<Query>),
    Reading(Reading, Reply<Reading>),
}

impl DatabaseQuestion {
    fn sql(&self) -> &str {
        match self {
            DatabaseQuestion::Query(sql, ..) => sql,
            DatabaseQuestion::Reading(reading, _) => reading.sql(),
        }
    }

    fn ticket(&self) -> Option<QueryTicket> {
        match self {
            DatabaseQuestion::Query(.., reply) => reply.ticket,
            DatabaseQuestion::Reading(..) => None,
        }
    }
}

/// Senders to the two query threads. There are two threads so that the user's queries and the queries of screens do not
/// wait for each other.
#[derive(Clone)]
pub(super) struct QueryThreads {
    user: Sender<QueryJob>,
    screens: Sender<QueryJob>,
    interrupt: Arc<Mutex<Option<Interrupt>>>,
}

type Connection = (Box<QueryConnection>, QueryLimits);

type AskDatabase = fn(&Connection, &DatabaseQuestion) -> Result<QueryResult, Rejection>;

enum QueryJob {
    Connect(Box<QueryConnection>, QueryLimits),
    Ask(DatabaseQuestion),
    Disconnect,
}

impl QueryThreads {
    /// Starts the query threads. They send a job to `jobs` for each query that must be recorded.
    pub(super) fn start(jobs: &Sender<Job>) -> QueryThreads {
        let start = || start_thread(jobs.clone(), ask);
        QueryThreads { user: start(), screens: start(), interrupt: Arc::default() }
    }

    /// Opens a separate connection to the database of a run for each query thread.
    pub(super) fn connect(&self, session: &Session) {
        let limits = session.company().query_limits();
        let database = session.database();
        let user = database.open_connection().ok();
        self.set_interrupt(user.as_ref().map(QueryConnection::interrupt));
        for (thread, query_connection) in
            [(&self.user, user), (&self.screens, database.open_connection().ok())]
        {
            if let Some(connection) = query_connection {
                let _ = thread.send(QueryJob::Connect(Box::new(connection), limits));
            }
        }
    }

    fn set_interrupt(&self, interrupt: Option<Interrupt>) {
        *self.interrupt.lock().unwrap_or_else(PoisonError::into_inner) = interrupt;
    }

    /// Closes the connections, so that the database can be closed.
    pub(super) fn disconnect(&self) {
        self.set_interrupt(None);
        for thread in [&self.user, &self.screens] {
            let _ = thread.send(QueryJob::Disconnect);
        }
    }

    pub(super) fn ticket(&self) -> Option<QueryTicket> {
        let interrupt = self.interrupt.lock().unwrap_or_else(PoisonError::into_inner);
        interrupt.as_ref().map(Interrupt::issue_ticket)
    }

    pub(super) fn stop(&self) {
        self.interrupt.lock().unwrap_or_else(PoisonError::into_inner).iter().for_each(Interrupt::stop);
    }

    fn ask(&self, question: DatabaseQuestion) {
        let thread = match question {
            DatabaseQuestion::Query(..) => &self.user,
            DatabaseQuestion::Reading(..) => &self.screens,
        };
        // Ignore the error: the thread may already have ended because the program is ending.
        let _ = thread.send(QueryJob::Ask(question));
    }
}

fn start_thread(jobs: Sender<Job>, ask: AskDatabase) -> Sender<QueryJob> {
    let (sender, questions) = channel();
    std::thread::spawn(move || {
        let mut connection: Option<Connection> = None;
        while let Ok(job) = questions.recv() {
            match job {
                QueryJob::Connect(query_connection, limits) => connection = Some((query_connection, limits)),
                QueryJob::Disconnect => connection = None,
                QueryJob::Ask(question) => answer(question, &mut connection, ask, &jobs),
            }
        }
    });
    sender
}

fn answer(
    question: DatabaseQuestion,
    connection: &mut Option<Connection>,
    ask: AskDatabase,
    jobs: &Sender<Job>,
) {
    let started = Instant::now();
    let rows = match connection.as_ref().map(|reader| catch_panic(|| ask(reader, &question))) {
        None => Err(Rejection::new("sql_error", "no run is open")),
        Some(Ok(rows)) => rows,
        Some(Err(defect)) => {
            // The guard of the connection may be inconsistent, so drop the connection.
            *connection = None;
            let _ = jobs.send(Job::Reconnect);
            Err(defect)
        }
    };
    let took = started.elapsed();
    match question {
        DatabaseQuestion::Query(sql, via, reply) => {
            let _ = jobs.send(Job::RecordQuery(sql, rows.clone(), took, via));
            reply.answer(rows.map(|rows| (rows, took)));
        }
        DatabaseQuestion::Reading(_, reply) => reply.answer(rows),
    }
}

fn ask((connection, limits): &Connection, question: &DatabaseQuestion) -> Result<QueryResult, Rejection> {
    let rows = match question.ticket() {
        Some(ticket) => connection.query_with_ticket(ticket, question.sql(), *limits),
        None => connection.query(question.sql(), *limits),
    };
    rows.map_err(query_rejection)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::Message;
    use crate::question::Pending;
    use crate::test_kit::played_session;

    /// Answers a question like `ask`, but panics for one statement.
    fn ask_or_panic(connection: &Connection, question: &DatabaseQuestion) -> Result<QueryResult, Rejection> {
        assert_ne!(question.sql(), "SELECT 'defect'", "a defect");
        ask(connection, question)
    }

    #[test]
    fn query_thread_answers_after_a_panic_and_asks_for_a_new_connection() {
        let session = played_session(0);
        let (news, answers) = channel();
        let (jobs, receiver) = channel();
        let thread = start_thread(jobs, ask_or_panic);
        let connect = || {
            let connection = session.database().open_connection().expect("a connection");
            let _ = thread.send(QueryJob::Connect(Box::new(connection), session.company().query_limits()));
        };
        let answer = |sql: &str| {
            let via = QuerySource::Typed;
            let query = Query { sql: sql.to_owned(), tables: QueriedTables::Visible(via) };
            let mut pending = Pending::default();
            let reply = pending.ask(query).reply::<Query>(news.clone()).expect("a query");
            let _ = thread.send(QueryJob::Ask(DatabaseQuestion::Query(sql.to_owned(), via, reply)));
            let Ok(Message::Delivered(delivery)) = answers.recv() else { panic!("an unexpected message") };
            delivery.deliver();
            pending.try_take().expect("an answer").1
        };
        connect();
        assert!(answer("SELECT 1").is_ok());
        let refused = answer("SELECT 'defect'").expect_err("a panic");
        assert_eq!(refused.code, "internal_error");
        // The connection was dropped after the panic.
        assert_eq!(answer("SELECT 1").expect_err("no connection").code, "sql_error");
        let noted = |job| matches!(job, Job::RecordQuery(..));
        assert!(noted(receiver.recv().expect("a job")));
        assert!(matches!(receiver.recv().expect("a job"), Job::Reconnect));
        assert!(noted(receiver.recv().expect("a job")));
        connect();
        assert!(answer("SELECT 1").is_ok());
    }
}
