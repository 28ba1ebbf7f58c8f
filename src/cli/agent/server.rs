//! Finds an agent's run, and finds or starts the server that plays the run.
//!
//! Concurrent commands lock `server.lock` in the run folder while they find or start a server. A server is alive if
//! its process has locked the run.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::cli::new_run::NewRunOptions;
use crate::cli::run_selection::create_run;
use crate::cli::{Context, Failure};
use crate::record::files::write_atomically;
use crate::record::folder::lock::is_locked;
use crate::record::folder::runs::{find_run_to_read, run_folder};
use crate::server::{RemoteServer, write_client};

/// File in the folder of runs that names the last run that `agent new` created.
const LATEST_RUN_FILE: &str = "agent-run.txt";
/// Time limit for stopping a server. The server first finishes a running week.
const STOP_DEADLINE: Duration = Duration::from_secs(120);

/// Authentication of requests to the server.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Authentication {
    /// Requests need the token, which commands read from the run folder.
    Token,
    /// Requests need no token, for clients that do not support tokens.
    Unauthenticated,
}

/// A run that an agent plays.
#[derive(Debug, Clone)]
pub struct AgentRun {
    /// ID of the agent's run.
    pub id: String,
    /// Absolute path of the run folder.
    pub folder: PathBuf,
}

impl AgentRun {
    /// Creates a run for an agent.
    ///
    /// # Errors
    /// Same as `serve --new`.
    pub fn create(new: &NewRunOptions, context: &Context) -> Result<AgentRun, Failure> {
        let mut session = create_run(new, context)?;
        session.save()?;
        let folder = session.folder().map(Path::to_path_buf);
        AgentRun::from_folder(&folder.ok_or_else(|| Failure::failed("the new run has no folder"))?)
    }

    /// Finds the named run, or the run that `agent new` last created in this folder of runs.
    ///
    /// # Errors
    /// The run does not exist or belongs to a study.
    pub fn find(named: Option<&str>, context: &Context) -> Result<AgentRun, Failure> {
        let runs = context.runs_folder()?;
        let last_created =
            || std::fs::read_to_string(runs.join(LATEST_RUN_FILE)).ok().map(|id| id.trim().to_owned());
        let id = named.map(str::to_owned).or_else(last_created).ok_or_else(|| {
            Failure::usage("there is no agent run here: create a run with `novamind agent new`, or name a run with --run or NOVAMIND_RUN")
        })?;
        // If a folder has the run id as its name, the other runs need not be read.
        let path = run_folder(&runs, &id);
        let is_name = !id.is_empty() && id.chars().all(|letter| letter.is_ascii_alphanumeric());
        let folder = match is_name && path.join("run.toml").is_file() {
            true => path,
            false => find_run_to_read(&runs, &id)?,
        };
        context.check_play_allowed(&folder)?;
        AgentRun::from_folder(&folder)
    }

    fn from_folder(folder: &Path) -> Result<AgentRun, Failure> {
        let folder = std::path::absolute(folder)
            .map_err(|error| Failure::failed(format!("cannot read the working directory: {error}")))?;
        let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(AgentRun { id, folder })
    }

    /// Makes this run the default of later commands.
    ///
    /// # Errors
    /// The folder of runs cannot be written.
    pub fn set_latest(&self, context: &Context) -> Result<(), Failure> {
        Ok(write_atomically(
            &context.runs_folder()?.join(LATEST_RUN_FILE),
            format!("{}\n", self.id).as_bytes(),
        )?)
    }

    /// Connects to the server that plays the run, and starts it if necessary.
    ///
    /// # Errors
    /// The server cannot be started: the run is in use elsewhere or damaged.
    pub fn connect_or_start(&self, secrecy: Authentication) -> Result<RemoteServer, Failure> {
        let _gate = self.lock()?;
        match RemoteServer::find(&self.folder, &self.id) {
            Some(remote) => Ok(remote),
            None => self.start_server(secrecy),
        }
    }

    /// Stops the server of the run. Returns whether a server was running.
    ///
    /// # Errors
    /// The server does not stop in time.
    pub fn stop_server(&self) -> Result<bool, Failure> {
        let _gate = self.lock()?;
        let Some(remote) = RemoteServer::find(&self.folder, &self.id) else { return Ok(false) };
        let reply = remote.shut_down().map_err(|error| super::exit::unreachable_failure(&error))?;
        super::exit::check_response(&reply)?;
        let asked = Instant::now();
        while is_locked(&self.folder) {
            if asked.elapsed() > STOP_DEADLINE {
                return Err(Failure::failed(format!(
                    "process {} did not stop in time",
                    remote.announcement.pid
                )));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        Ok(true)
    }

    /// Writes the Python client to the run folder and returns its path.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn write_client(&self) -> Result<PathBuf, Failure> {
        let _gate = self.lock()?;
        let client = self.folder.join("client");
        write_client(&client)?;
        Ok(client)
    }

    /// Locks `server.lock`. The lock is required for finding, starting or stopping a server.
    fn lock(&self) -> Result<File, Failure> {
        let path = self.folder.join("server.lock");
        let open = File::options().create(true).truncate(false).write(true).open(&path);
        open.and_then(|file| file.lock().map(|()| file))
            .map_err(|error| Failure::failed(format!("cannot lock {}: {error}", path.display())))
    }

    fn start_server(&self, secrecy: Authentication) -> Result<RemoteServer, Failure> {
        let failed = |error: std::io::Error| Failure::failed(format!("cannot start a server: {error}"));
        let log = self.folder.join("server.log");
        let runs = self.folder.parent().unwrap_or(&self.folder);
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command.arg("--runs-dir").arg(runs).args(["serve", "--run", &self.id]);
        // `--runs-dir` is already the participant's folder.
        command.env_remove("NOVAMIND_PARTICIPANT").env_remove("NOVAMIND_RUNS");
        if secrecy == Authentication::Token {
            let token = self.folder.join("server.token");
            // A killed process may have left the token file empty.
            if std::fs::metadata(&token).is_ok_and(|file| file.len() == 0) {
                std::fs::remove_file(&token).map_err(failed)?;
            }
            command.arg("--token").arg(token);
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped());
        command.stderr(File::create(&log).map_err(failed)?);
        // Ctrl-c in the agent's terminal must not stop the server.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(failed)?;
        let mut line = String::new();
        if let Some(out) = child.stdout.take() {
            BufReader::new(out).read_line(&mut line).map_err(failed)?;
        }
        if line.is_empty() {
            let status = child.wait().map_err(failed)?;
            let text = std::fs::read_to_string(&log).unwrap_or_default();
            let message = text.trim().strip_prefix("novamind: ").unwrap_or(text.trim()).to_owned();
            let code = status.code().and_then(|code| u8::try_from(code).ok()).filter(|code| *code > 0);
            return Err(Failure::with_code(code.unwrap_or(1), message));
        }
        RemoteServer::find(&self.folder, &self.id).ok_or_else(|| {
            Failure::failed(format!(
                "the server does not respond; for the server's output, see {}",
                log.display()
            ))
        })
    }
}
