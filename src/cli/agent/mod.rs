//! `novamind agent`: plays a run with one shell command per action (docs/interfaces/agents.md).

mod arguments;
mod batch;
mod documents;
mod exit;
mod python;
mod server;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use serde_json::{Value, json};

use super::new_run::NewRunOptions;
use super::{Context, Failure, print};
use crate::record::folder::configuration::DEFAULT_SCENARIO;
use crate::server::{RemoteServer, ServerResponse};
use arguments::{parse_next_week, parse_tool_arguments, read_text};
use server::{AgentRun, Authentication};

#[derive(Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    command: AgentCommand,
    /// Run [default: the run that `agent new` last created]
    #[arg(id = "agent_run", long = "run", global = true, env = "NOVAMIND_RUN", value_name = "ID")]
    run: Option<String>,
    /// Request id for `call` and `next-week`: if the command is repeated with the same id, the request runs only once
    #[arg(long, global = true, value_name = "ID")]
    request_id: Option<String>,
}

#[derive(Debug, Subcommand)]
enum AgentCommand {
    /// Create a run and start its server
    New(NewRunOptions),
    /// Show day, cash, subscribers, last day, and how the run ended
    Status,
    /// Show the dashboard of the last week
    Dashboard,
    /// Submit a rationale and forecasts, and simulate a week
    #[command(allow_negative_numbers = true)]
    NextWeek {
        /// One JSON object, - to read the object from standard input, or: RATIONALE and POINT LOWER UPPER for 1, 4, 12
        /// and 26 weeks
        #[arg(required = true, value_name = "WORD")]
        words: Vec<String>,
        /// Reject the week unless the run is on this day
        #[arg(long, value_name = "DAY")]
        expected_day: Option<u32>,
    },
    /// Run one SQL statement
    Query {
        /// SQL statement, or - to read the statement from standard input
        sql: String,
    },
    /// Call a tool
    Call {
        /// Name of the tool; `novamind tools` lists all tools
        tool: String,
        /// One JSON object, - to read the object from standard input, or --KEY VALUE for each argument
        #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "JSON|--KEY VALUE")]
        arguments: Vec<String>,
    },
    /// Run a Python program with access to the run and with the package `novamind`
    Python {
        /// Arguments for python3: a file and its arguments, or -c CODE
        #[arg(required = true, trailing_var_arg = true, allow_hyphen_values = true, value_name = "FILE")]
        words: Vec<String>,
    },
    /// Print the instructions for an agent, or write them with the documentation of tools and tables
    Docs {
        /// Folder for AGENT.md, tools.md, tools.json, tables.md and tables.json
        #[arg(long, value_name = "DIR")]
        out: Option<PathBuf>,
        /// Without a run: scenario whose parameters, tools and tables are documented
        #[arg(long, default_value = DEFAULT_SCENARIO, value_name = "NAME")]
        scenario: String,
    },
    /// Stop the server of the run; all confirmed actions are saved, and the next command starts a new server
    Stop,
    /// Run an agent command on several new runs and collect the results
    Batch(batch::Options),
}

impl Options {
    /// Adds `--code` to the arguments of the called tool, because `--code` cannot be an experimenter's code
    /// if there is no study.
    pub fn restore_code_argument(&mut self, code: String) {
        if let AgentCommand::Call { arguments, .. } = &mut self.command {
            arguments.splice(0..0, ["--code".to_owned(), code]);
        }
    }

    /// Sends a call of a tool with its request id, and prints the response. If the call needs an id and the
    /// command contains none, generates an id and prints it to standard error, so that the user can retry the
    /// call.
    fn print_call(
        &self,
        remote: &RemoteServer,
        path: &str,
        tool: &str,
        mut body: Value,
    ) -> Result<(), Failure> {
        let id = match &self.request_id {
            Some(id) => Some(id.clone()),
            None => remote.new_request_id(tool)?.inspect(|id| eprintln!("{}", json!({ "request_id": id }))),
        };
        if let Some(id) = id {
            body["request_id"] = json!(id);
        }
        print_response(remote, path, Some(&body))
    }
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let named = options.run.as_deref();
    match &options.command {
        AgentCommand::New(new) => create_run(new, context),
        AgentCommand::Status => print_response(&connect(named, context)?.1, "/game-status", None),
        AgentCommand::Dashboard => print_response(&connect(named, context)?.1, "/dashboard", None),
        AgentCommand::NextWeek { words, expected_day } => {
            let mut filed = parse_next_week(words)?;
            if let Some(day) = expected_day {
                filed["expected_day"] = json!(day);
            }
            options.print_call(&connect(named, context)?.1, "/next-week", "next_week", filed)
        }
        AgentCommand::Query { sql } => {
            let asked = json!({ "sql": read_text(sql)? });
            print_response(&connect(named, context)?.1, "/query", Some(&asked))
        }
        AgentCommand::Call { tool, arguments } => {
            let asked = json!({ "tool": tool, "args": parse_tool_arguments(tool, arguments)? });
            options.print_call(&connect(named, context)?.1, "/call", tool, asked)
        }
        AgentCommand::Python { words } => {
            let (agent_run, remote) = connect(named, context)?;
            python::run(words, &agent_run, &remote)
        }
        AgentCommand::Docs { out, scenario } => {
            documents::print_or_write(named, scenario, out.as_deref(), context)
        }
        AgentCommand::Stop => {
            let run = AgentRun::find(named, context)?;
            let stopped = run.stop_server()?;
            print(&format!("{}\n", json!({ "run": run.id, "stopped": stopped })))
        }
        AgentCommand::Batch(batch) => batch::run(batch, context),
    }
}

fn create_run(new: &NewRunOptions, context: &Context) -> Result<(), Failure> {
    let agent_run = AgentRun::create(new, context)?;
    agent_run.set_latest(context)?;
    let remote = agent_run.connect_or_start(Authentication::Token)?;
    let mut value = json!(remote.announcement);
    value["folder"] = json!(agent_run.folder);
    let status = send_request(&remote, "/game-status", None)?.body;
    for field in ["day", "total_days", "cash"] {
        value[field] = status[field].clone();
    }
    print(&format!("{value}\n"))
}

/// Returns the run and a connection to its server. Starts the server if necessary.
fn connect(named: Option<&str>, context: &Context) -> Result<(AgentRun, RemoteServer), Failure> {
    let agent_run = AgentRun::find(named, context)?;
    let remote = agent_run.connect_or_start(Authentication::Token)?;
    Ok((agent_run, remote))
}

/// Sends a request and prints the response.
fn print_response(remote: &RemoteServer, path: &str, body: Option<&Value>) -> Result<(), Failure> {
    let reply = send_request(remote, path, body)?;
    exit::check_response(&reply)?;
    print(&format!("{}\n", reply.body))
}

fn send_request(remote: &RemoteServer, path: &str, body: Option<&Value>) -> Result<ServerResponse, Failure> {
    let reply = match body {
        None => remote.get(path),
        Some(body) => remote.post(path, body),
    };
    reply.map_err(|error| exit::unreachable_failure(&error))
}
