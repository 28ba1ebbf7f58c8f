//! What arrives at the screen: input, and news of the threads behind it.

use std::sync::Arc;
use std::time::Duration;

use crossterm::event::Event;
use serde_json::Value;

use super::company::Company;
use super::readings::Reading;
use crate::report::Story;
use crate::session::{Change, Interrupt, Library, Preview, Refusal, Rows, Week};

/// Something that arrives.
pub enum Message {
    /// A key, a click, pasted text, another window size.
    Input(Event),
    /// From the threads behind the screen.
    News(News),
    /// A signal asks the program to end.
    Signal(i32),
}

/// What a thread behind the screen reports.
pub enum News {
    /// The runs of the folder.
    Runs(Result<Vec<crate::session::RunSummary>, String>),
    /// How a run went; with its id.
    Course(String, Result<crate::session::RunCourse, String>),
    /// A run was given up or deleted: a sentence, or what went wrong; and the runs of the folder now.
    Kept(Result<String, String>, Result<Vec<crate::session::RunSummary>, String>),
    /// A run is open; with a handle that stops the person's queries.
    Opened(Arc<Company>, Option<Interrupt>),
    /// A run could not be opened or created.
    NotOpened(String),
    /// What a call would do; the number says which question this answers.
    Checked(u64, Result<Preview, Refusal>),
    /// A tool was called.
    Called(&'static str, Result<Value, Refusal>, Arc<Company>),
    /// A setting was taken back.
    Undone(Result<Vec<Change>, Refusal>, Arc<Company>),
    /// A day was simulated: the day, the day on which the week ends.
    Day(u32, u32),
    /// A week has passed, or was refused.
    Advanced(Result<Box<Week>, Refusal>, Arc<Company>),
    /// The person's query was answered; the number says which.
    Answered(u64, Result<Rows, Refusal>, Duration),
    /// A screen's question was answered; the number counts the changes of the run before it was asked.
    Read(Reading, u64, Result<Rows, Refusal>),
    /// The notes were kept.
    MemoKept(Result<(), Refusal>, Arc<Company>),
    /// A query was saved: a sentence and all queries, or what went wrong.
    QuerySaved(Result<(String, Library), String>),
    /// The story of the run.
    Told(Arc<Story>),
    /// The report of the run: names of files and what they hold.
    Reported(Vec<(&'static str, String)>),
    /// Files were written: a sentence, or what went wrong.
    Written(Result<String, String>),
    /// The run was saved and closed; what went wrong, if something did.
    Closed(Option<String>),
    /// A thread behind the screen has failed for a reason that should not exist.
    Crashed(String),
}
