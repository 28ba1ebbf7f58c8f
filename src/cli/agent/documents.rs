//! `novamind agent docs`: the page and the documents that an agent receives.

use std::path::Path;

use super::server::AgentRun;
use crate::cli::{Context, Failure, print};
use crate::server::{PageOf, page, write_documents};
use crate::session::{Access, Session};
use crate::tools::Numbers;

/// Prints the page or writes it with the documents, for the named run or for a standard run.
pub fn write(named: Option<&str>, out: Option<&Path>, context: &Context) -> Result<(), Failure> {
    match named {
        Some(_) => of_run(&AgentRun::find(named, context)?, out),
        None => {
            let numbers = Numbers::shipped();
            let value = |key: &str| numbers.value(key).unwrap_or_default();
            let of = PageOf {
                days: value("run.total_days") as u32,
                cash: value("initial.initial_cash"),
                numbers: &numbers,
            };
            write_of(&of, out)
        }
    }
}

/// Writes the documents of a run.
pub fn of_run(own: &AgentRun, out: Option<&Path>) -> Result<(), Failure> {
    let session = Session::open(&own.folder, Access::Read, false)?;
    let manifest = session.manifest();
    write_of(&PageOf { days: manifest.days, cash: manifest.cash, numbers: &session.numbers() }, out)
}

fn write_of(of: &PageOf<'_>, out: Option<&Path>) -> Result<(), Failure> {
    match out {
        None => print(&page(of)),
        Some(folder) => Ok(write_documents(folder, of)?),
    }
}
