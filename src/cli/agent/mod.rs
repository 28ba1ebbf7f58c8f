//! `novamind agent`: a run for programs that have nothing but a shell (docs/interfaces/agents.md).

mod batch;
mod documents;
mod exit;
mod python;
mod server;
mod words;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use super::new_run::NewRunOptions;
use super::{Context, Failure, print};
use crate::server::{Remote, Reply};
use server::{AgentRun, Secrecy};
use words::{called_with, next_week_of, text_of};

/// Options of `agent`.
#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: AgentCommand,
    /// Run [default: the one that `agent new` began last].
    #[arg(id = "agent_run", long = "run", global = true, env = "NOVAMIND_RUN", value_name = "ID")]
    run: Option<String>,
    /// Id of the request, for `call` and `next-week`: the command can be repeated with it, and the request runs once.
    #[arg(long, global = true, value_name = "ID")]
    request_id: Option<String>,
}

#[derive(Debug, Subcommand)]
enum AgentCommand {
    /// Begin a run, and start its server.
    New(NewRunOptions),
    /// Day, cash, subscribers, last day, and how the run ended.
    Status,
    /// The dashboard of the last week.
    Dashboard,
    /// File rationale and forecasts, and let a week pass.
    #[command(allow_negative_numbers = true)]
    NextWeek {
        /// One JSON object, - for one on standard input, or: RATIONALE and POINT LOWER UPPER of 1, 4, 12 and 26 weeks.
        #[arg(required = true, value_name = "WORD")]
        words: Vec<String>,
        /// Refuse the week unless the run is on this day.
        #[arg(long, value_name = "DAY")]
        expected_day: Option<u32>,
    },
    /// Ask the database one statement.
    Query {
        /// Statement, or - for one on standard input.
        sql: String,
    },
    /// Call a tool.
    Call {
        /// Name of the tool; `novamind tools` lists them.
        tool: String,
        /// One JSON object, - for one on standard input, or --KEY VALUE for each argument.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "JSON|--KEY VALUE")]
        arguments: Vec<String>,
    },
    /// Run a Python program against the run, with the package `novamind` on its path.
    Python {
        /// What python3 is given: a file and its arguments, or -c CODE.
        #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true, value_name = "FILE")]
        words: Vec<String>,
    },
    /// Print the page that can be handed to an agent, or write it with the documentation of tools and tables.
    Docs {
        /// Folder for AGENT.md, tools.md, tools.json, tables.md and tables.json.
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
    },
    /// Stop the server of the run; what was confirmed is kept, and the next command starts another one.
    Stop,
    /// Let a command play several fresh runs, and collect what came of them.
    Batch(batch::Options),
}

impl Options {
    /// Gives `--code` to the tool that is called: without a study there is no code of one.
    pub fn take_code(&mut self, code: String) {
        if let AgentCommand::Call { arguments, .. } = &mut self.command {
            arguments.splice(0..0, ["--code".to_owned(), code]);
        }
    }

    /// Adds the id of the request to its body.
    fn with_id(&self, mut body: Value) -> Value {
        if let Some(id) = &self.request_id {
            body["request_id"] = json!(id);
        }
        body
    }
}

/// Runs the command.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let named = options.run.as_deref();
    match &options.command {
        AgentCommand::New(new) => begin(new, context),
        AgentCommand::Status => answer(&connect(named, context)?.1, "/game-status", None),
        AgentCommand::Dashboard => answer(&connect(named, context)?.1, "/dashboard", None),
        AgentCommand::NextWeek { words, expected_day } => {
            let mut filed = options.with_id(next_week_of(words)?);
            if let Some(day) = expected_day {
                filed["expected_day"] = json!(day);
            }
            answer(&connect(named, context)?.1, "/next-week", Some(&filed))
        }
        AgentCommand::Query { sql } => {
            let asked = json!({ "sql": text_of(sql)? });
            answer(&connect(named, context)?.1, "/query", Some(&asked))
        }
        AgentCommand::Call { tool, arguments } => {
            let asked = options.with_id(json!({ "tool": tool, "args": called_with(tool, arguments)? }));
            answer(&connect(named, context)?.1, "/call", Some(&asked))
        }
        AgentCommand::Python { words } => {
            let (own, remote) = connect(named, context)?;
            python::run(words, &own, &remote)
        }
        AgentCommand::Docs { out } => documents::write(named, out.as_deref(), context),
        AgentCommand::Stop => {
            let own = AgentRun::find(named, context)?;
            let stopped = own.stop()?;
            print(&format!("{}\n", json!({ "run": own.id, "stopped": stopped })))
        }
        AgentCommand::Batch(batch) => batch::run(batch, context),
    }
}

fn begin(new: &NewRunOptions, context: &Context) -> Result<(), Failure> {
    let own = AgentRun::begin(new, context)?;
    own.remember(context)?;
    let remote = own.serve(Secrecy::Token)?;
    let mut told = json!(remote.announcement);
    told["folder"] = json!(own.folder);
    let status = asked(&remote, "/game-status", None)?.body;
    for field in ["day", "total_days", "cash"] {
        told[field] = status[field].clone();
    }
    print(&format!("{told}\n"))
}

/// The run, and a server that plays it.
fn connect(named: Option<&str>, context: &Context) -> Result<(AgentRun, Remote), Failure> {
    let own = AgentRun::find(named, context)?;
    let remote = own.serve(Secrecy::Token)?;
    Ok((own, remote))
}

/// Asks, and prints what is answered.
fn answer(remote: &Remote, path: &str, body: Option<&Value>) -> Result<(), Failure> {
    let reply = asked(remote, path, body)?;
    exit::check(&reply)?;
    print(&format!("{}\n", reply.body))
}

fn asked(remote: &Remote, path: &str, body: Option<&Value>) -> Result<Reply, Failure> {
    let reply = match body {
        None => remote.get(path),
        Some(body) => remote.post(path, body),
    };
    reply.map_err(|error| exit::unreachable(&error))
}
