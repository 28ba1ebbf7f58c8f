//! `novamind agent docs`: prints or writes the instructions and reference documents for an agent.

use std::path::Path;

use super::server::AgentRun;
use crate::cli::{Context, Failure, print};
use crate::server::{PageContext, agent_page, write_documents};
use crate::session::{Access, Session};
use crate::tools::ParameterNumbers;

/// Prints the agent's instructions, or writes them to a folder together with the reference documents. If no
/// run is named, the instructions describe a run with the bundled parameters of a scenario.
pub fn print_or_write(
    named: Option<&str>,
    scenario: &str,
    out: Option<&Path>,
    context: &Context,
) -> Result<(), Failure> {
    match named {
        Some(_) => write_run_documents(&AgentRun::find(named, context)?, out),
        None => {
            let scenario = context.configuration.load_scenario(scenario)?;
            let params = context.configuration.load_parameters(&scenario, &[], true)?;
            let (days, cash) = scenario.days_and_cash_with(&params);
            let of = PageContext { days, cash, numbers: &ParameterNumbers::from_params(&params) };
            write_page(&of, out)
        }
    }
}

/// Writes the instructions and reference documents for a run's agent.
pub fn write_run_documents(agent_run: &AgentRun, out: Option<&Path>) -> Result<(), Failure> {
    let session = Session::open(&agent_run.folder, Access::Read, false)?;
    let manifest = session.manifest();
    write_page(&PageContext { days: manifest.days, cash: manifest.cash, numbers: &session.numbers() }, out)
}

fn write_page(of: &PageContext<'_>, out: Option<&Path>) -> Result<(), Failure> {
    match out {
        None => print(&agent_page(of)),
        Some(folder) => Ok(write_documents(folder, of)?),
    }
}
