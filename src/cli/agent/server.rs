//! The run of an agent, and the server that plays it: found again, or started.
//!
//! Commands that come at once wait for each other only until a server is there: whoever holds `server.lock` in the folder of the
//! run looks for one and starts one. That a server lives is told by the lock of the run, which ends with its process.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::cli::new_run::NewRunOptions;
use crate::cli::which_run::begin;
use crate::cli::{Context, Failure};
use crate::record::files::write_whole;
use crate::record::folder::lock::is_being_played;
use crate::record::folder::runs::{find_run_to_read, run_folder};
use crate::server::{Remote, write_client};

/// File in the folder of runs that names the run which `agent new` began last.
const LATEST: &str = "agent-run.txt";
/// How long a server that was asked to stop may take: a week that is simulated is finished first.
const LAST_WEEK: Duration = Duration::from_secs(120);

/// Whether requests must carry a secret.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Secrecy {
    /// They must: commands find it in the folder of the run.
    Token,
    /// They need none, so that clients that know of none can play.
    Open,
}

/// The run of an agent.
#[derive(Debug, Clone)]
pub struct AgentRun {
    /// Its name.
    pub id: String,
    /// Its folder, from the root on.
    pub folder: PathBuf,
}

impl AgentRun {
    /// Begins a run.
    ///
    /// # Errors
    /// As `serve --new`.
    pub fn begin(new: &NewRunOptions, context: &Context) -> Result<AgentRun, Failure> {
        let mut session = begin(new, context)?;
        session.save()?;
        let folder = session.folder().map(Path::to_path_buf);
        AgentRun::of(&folder.ok_or_else(|| Failure::failed("the run was not kept"))?)
    }

    /// The run that is named, or that `agent new` began last in this folder of runs.
    ///
    /// # Errors
    /// There is none; it belongs to a study.
    pub fn find(named: Option<&str>, context: &Context) -> Result<AgentRun, Failure> {
        let runs = context.runs()?;
        let remembered = || std::fs::read_to_string(runs.join(LATEST)).ok().map(|id| id.trim().to_owned());
        let id = named.map(str::to_owned).or_else(remembered).ok_or_else(|| {
            Failure::usage("`novamind agent new` has begun no run here; name one with --run or NOVAMIND_RUN")
        })?;
        // The usual case is answered without reading every run.
        let own = run_folder(&runs, &id);
        let is_name = !id.is_empty() && id.chars().all(|letter| letter.is_ascii_alphanumeric());
        let folder = match is_name && own.join("run.toml").is_file() {
            true => own,
            false => find_run_to_read(&runs, &id)?,
        };
        context.check_play(&folder)?;
        AgentRun::of(&folder)
    }

    fn of(folder: &Path) -> Result<AgentRun, Failure> {
        let folder = std::path::absolute(folder)
            .map_err(|error| Failure::failed(format!("the folder of work: {error}")))?;
        let id = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Ok(AgentRun { id, folder })
    }

    /// Lets commands that name no run find this one.
    ///
    /// # Errors
    /// The folder of runs cannot be written.
    pub fn remember(&self, context: &Context) -> Result<(), Failure> {
        Ok(write_whole(&context.runs()?.join(LATEST), format!("{}\n", self.id).as_bytes())?)
    }

    /// The server that plays the run; one is started if there is none.
    ///
    /// # Errors
    /// None can be started: the run is in use elsewhere, or damaged.
    pub fn serve(&self, secrecy: Secrecy) -> Result<Remote, Failure> {
        let _gate = self.gate()?;
        match Remote::find(&self.folder, &self.id) {
            Some(remote) => Ok(remote),
            None => self.start(secrecy),
        }
    }

    /// Stops the server; whether there was one.
    ///
    /// # Errors
    /// It does not end.
    pub fn stop(&self) -> Result<bool, Failure> {
        let _gate = self.gate()?;
        let Some(remote) = Remote::find(&self.folder, &self.id) else { return Ok(false) };
        let reply = remote.shut_down().map_err(|error| super::exit::unreachable(&error))?;
        super::exit::check(&reply)?;
        let asked = Instant::now();
        while is_being_played(&self.folder) {
            if asked.elapsed() > LAST_WEEK {
                return Err(Failure::failed(format!(
                    "process {} was asked to stop and goes on",
                    remote.announcement.pid
                )));
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        Ok(true)
    }

    /// The Python client of the run, in its folder.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn client(&self) -> Result<PathBuf, Failure> {
        let _gate = self.gate()?;
        let client = self.folder.join("client");
        write_client(&client)?;
        Ok(client)
    }

    /// Held by whoever looks for a server, starts or stops one.
    fn gate(&self) -> Result<File, Failure> {
        let path = self.folder.join("server.lock");
        let open = File::options().create(true).truncate(false).write(true).open(&path);
        open.and_then(|file| file.lock().map(|()| file))
            .map_err(|error| Failure::failed(format!("{} cannot be locked: {error}", path.display())))
    }

    fn start(&self, secrecy: Secrecy) -> Result<Remote, Failure> {
        let failed = |error: std::io::Error| Failure::failed(format!("no server can be started: {error}"));
        let log = self.folder.join("server.log");
        let runs = self.folder.parent().unwrap_or(&self.folder);
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command.arg("--runs-dir").arg(runs).args(["serve", "--run", &self.id]);
        // The folder of runs already is that of the participant.
        command.env_remove("NOVAMIND_PARTICIPANT").env_remove("NOVAMIND_RUNS");
        if secrecy == Secrecy::Token {
            let token = self.folder.join("server.token");
            // Left empty by a process that was killed while it made it.
            if std::fs::metadata(&token).is_ok_and(|file| file.len() == 0) {
                std::fs::remove_file(&token).map_err(failed)?;
            }
            command.arg("--token").arg(token);
        }
        command.stdin(Stdio::null()).stdout(Stdio::piped());
        command.stderr(File::create(&log).map_err(failed)?);
        // A key that interrupts the agent must not reach the server.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(failed)?;
        let mut line = String::new();
        if let Some(out) = child.stdout.take() {
            BufReader::new(out).read_line(&mut line).map_err(failed)?;
        }
        if line.is_empty() {
            let status = child.wait().map_err(failed)?;
            let said = std::fs::read_to_string(&log).unwrap_or_default();
            let said = said.trim().strip_prefix("novamind: ").unwrap_or(said.trim()).to_owned();
            let code = status.code().and_then(|code| u8::try_from(code).ok()).filter(|code| *code > 0);
            return Err(Failure::with_code(code.unwrap_or(1), said));
        }
        Remote::find(&self.folder, &self.id).ok_or_else(|| {
            Failure::failed(format!(
                "a server was started and does not answer; what it said is in {}",
                log.display()
            ))
        })
    }
}
