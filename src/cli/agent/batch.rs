//! `novamind agent batch`: runs an agent command on several new runs, one after the other, and compares the results.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use clap::Args;

use super::documents::write_run_documents;
use super::python::set_environment;
use super::server::{AgentRun, Authentication};
use super::{exit, send_request};
use crate::cli::lab::{OutputOptions, stop_flag_on_signals};
use crate::cli::new_run::NewRunOptions;
use crate::cli::{Context, Failure};
use crate::lab::results::{AttemptResult, FinishedRun, attempts_report};
use crate::record::files::write_atomically;
use crate::record::trajectory::Trajectory;
use crate::server::write_client;
use crate::session::Session;

#[derive(Debug, Args)]
pub struct Options {
    /// Command of the agent; a shell executes the command in the folder of each try
    #[arg(long, value_name = "COMMAND")]
    command: String,
    /// Number of new runs
    #[arg(long = "runs", default_value_t = 3, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    tries: u32,
    /// Maximum number of restarts if the command ends before the run ends
    #[arg(long = "continue", default_value_t = 0, value_name = "N")]
    continued: u32,
    /// Folder for the results, with a subfolder for each try; must be new or empty
    #[arg(long, default_value = "batch", value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    made_of: NewRunOptions,
    #[command(flatten)]
    output: OutputOptions,
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let out = std::path::absolute(&options.out).map_err(|error| write_failure(&options.out, &error))?;
    let was_there = out.is_dir();
    std::fs::create_dir_all(&out).map_err(|error| write_failure(&out, &error))?;
    if std::fs::read_dir(&out).map_err(|error| write_failure(&out, &error))?.next().is_some() {
        return Err(Failure::usage(format!("{} is not empty: give a new folder with --out", out.display())));
    }
    let stop = stop_flag_on_signals();
    let mut tries = Vec::new();
    for number in 1..=options.tries {
        let work = out.join(format!("try-{number}"));
        let agent_run = AgentRun::create(&options.made_of, context).inspect_err(|_| {
            // The output folder is removed if no try has started.
            if !was_there {
                let _ = std::fs::remove_dir(&out);
            }
        })?;
        write_run_documents(&agent_run, Some(&work))?;
        write_client(&work.join("client"))?;
        eprintln!("try {number} of {}: run {} in {}", options.tries, agent_run.id, work.display());
        let played = run_command_until_run_ends(options, number, &agent_run, &work, &stop);
        // Stop the server even if the command failed.
        agent_run.stop_server()?;
        let (attempts, exit_code) = played?;
        tries.push(read_outcome(number, &agent_run, attempts, exit_code)?);
        let exhibit = attempts_report(format!("{} runs of: {}", options.tries, options.command), &tries);
        write_atomically(&out.join("results.json"), format!("{:#}\n", exhibit.to_json()).as_bytes())?;
        if number == options.tries {
            return options.output.show(&exhibit);
        }
    }
    Ok(())
}

fn write_failure(path: &Path, error: &std::io::Error) -> Failure {
    Failure::failed(format!("{}: {error}", path.display()))
}

/// Starts the command, and restarts it until the run has ended or no restarts are left. Returns the number of
/// starts and the last exit code.
fn run_command_until_run_ends(
    options: &Options,
    number: u32,
    agent_run: &AgentRun,
    work: &Path,
    stop: &AtomicBool,
) -> Result<(u32, Option<i32>), Failure> {
    let mut attempts = 0;
    loop {
        let remote = agent_run.connect_or_start(Authentication::Unauthenticated)?;
        attempts += 1;
        let mut command = shell_command(&options.command);
        set_environment(&mut command, agent_run, &remote, &work.join("client"))?;
        command.env("NOVAMIND_TRY", number.to_string()).env("NOVAMIND_ATTEMPT", attempts.to_string());
        command.current_dir(work).stdin(Stdio::null());
        let log = work.join("output.txt");
        let file = File::options()
            .create(true)
            .append(true)
            .open(&log)
            .map_err(|error| write_failure(&log, &error))?;
        command.stderr(file.try_clone().map_err(|error| write_failure(&log, &error))?).stdout(file);
        let child =
            command.spawn().map_err(|error| Failure::failed(format!("cannot start a shell: {error}")))?;
        let status = wait_for_exit(child, stop)?;
        // If the command stopped the server, a new server continues the run.
        let reply = send_request(
            &agent_run.connect_or_start(Authentication::Unauthenticated)?,
            "/game-status",
            None,
        )?;
        exit::check_response(&reply)?;
        if !reply.body["ended"].is_null() || attempts > options.continued {
            return Ok((attempts, status.code()));
        }
        eprintln!("try {number}: the command ended on day {} and is restarted", reply.body["day"]);
    }
}

fn wait_for_exit(mut child: Child, stop: &AtomicBool) -> Result<ExitStatus, Failure> {
    let failed = |error: std::io::Error| Failure::failed(format!("cannot wait for the command: {error}"));
    loop {
        if let Some(status) = child.try_wait().map_err(failed)? {
            return if stop.load(Ordering::Relaxed) { Err(Failure::signal(2)) } else { Ok(status) };
        }
        if stop.load(Ordering::Relaxed) {
            child.kill().and_then(|()| child.wait()).map_err(failed)?;
            return Err(Failure::signal(2));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

fn shell_command(command: &str) -> Command {
    let (program, option) = if cfg!(windows) { ("cmd", "/C") } else { ("sh", "-c") };
    let mut shell = Command::new(program);
    shell.arg(option).arg(command);
    shell
}

fn read_outcome(
    number: u32,
    agent_run: &AgentRun,
    attempts: u32,
    exit_code: Option<i32>,
) -> Result<AttemptResult, Failure> {
    let session = Session::open_to_read(&agent_run.folder, false)?;
    let trajectory = Trajectory::read(&agent_run.folder.join("trajectory.jsonl"))?;
    let result = session.ended().and_then(|_| FinishedRun::from_session(&session, &trajectory.lines));
    Ok(AttemptResult {
        number,
        run: agent_run.id.clone(),
        starts: attempts,
        exit_code,
        day: session.day(),
        result,
    })
}
