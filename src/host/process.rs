//! The process of a session in a pseudo terminal.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, Read, Write};
use std::os::fd::OwnedFd;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use rustix::fs::{Mode, OFlags};
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{Winsize, tcsetwinsize};
use tokio::io::unix::AsyncFd;
use tokio::process::{Child, Command};

use crate::attachment::WindowSize;

/// The program that plays a session: the program of the host itself, except in tests.
#[derive(Debug, Clone)]
pub struct SessionProgram {
    /// Path of the program.
    pub program: PathBuf,
    /// Arguments before the label and the folder of the session.
    pub arguments: Vec<OsString>,
    /// Time after which a session without a client ends its process.
    pub absence_limit: Duration,
}

/// The terminal side of a running session.
#[derive(Debug, Clone)]
pub(crate) struct Terminal(Arc<AsyncFd<File>>);

/// A started process and its terminal.
pub(crate) struct StartedProcess {
    pub child: Child,
    pub terminal: Terminal,
}

impl SessionProgram {
    /// Time after which a session without a client ends its process, for participants who reload a page or change networks.
    pub const ABSENCE_LIMIT: Duration = Duration::from_secs(20);

    /// Starts the process of a session. Its environment contains only the given variables.
    ///
    /// The started program has to make the terminal, its standard input, its controlling terminal. Then the kernel sends
    /// SIGHUP to the process when the host closes the terminal or is killed.
    pub(crate) fn start(
        &self,
        last_arguments: &[OsString],
        environment: &[(OsString, OsString)],
        size: WindowSize,
    ) -> io::Result<StartedProcess> {
        let controller = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY | OpenptFlags::CLOEXEC)?;
        grantpt(&controller)?;
        unlockpt(&controller)?;
        let name = ptsname(&controller, Vec::new())?;
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC;
        let terminal: OwnedFd = rustix::fs::open(name.as_c_str(), flags, Mode::empty())?;
        set_window_size(&controller, size)?;
        rustix::io::ioctl_fionbio(&controller, true)?;
        let mut command = Command::new(&self.program);
        command.args(&self.arguments).args(last_arguments).env_clear();
        command.envs(environment.iter().map(|(name, value)| (name, value))).current_dir("/");
        command.stdin(Stdio::from(terminal.try_clone()?)).stdout(Stdio::from(terminal.try_clone()?));
        command.stderr(Stdio::from(terminal));
        let child = command.spawn()?;
        #[expect(deprecated, reason = "the alternative is unsafe, and a `File` keeps its descriptor open")]
        let terminal = AsyncFd::new(File::from(controller))?;
        Ok(StartedProcess { child, terminal: Terminal(Arc::new(terminal)) })
    }
}

impl Terminal {
    /// Reads output. Returns 0 if the process has closed the terminal.
    pub async fn read(&self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.0.async_io(tokio::io::Interest::READABLE, |mut file| file.read(buffer)).await;
        match read {
            // The kernel reports this error if no process has the other side open.
            Err(error) if error.raw_os_error() == Some(rustix::io::Errno::IO.raw_os_error()) => Ok(0),
            read => read,
        }
    }

    /// Writes input completely.
    pub async fn write_all(&self, mut bytes: &[u8]) -> io::Result<()> {
        while !bytes.is_empty() {
            let written =
                self.0.async_io(tokio::io::Interest::WRITABLE, |mut file| file.write(bytes)).await?;
            bytes = &bytes[written..];
        }
        Ok(())
    }

    pub fn resize(&self, size: WindowSize) -> io::Result<()> {
        set_window_size(self.0.get_ref(), size)
    }
}

fn set_window_size(controller: impl std::os::fd::AsFd, size: WindowSize) -> io::Result<()> {
    let size = Winsize { ws_row: size.rows, ws_col: size.columns, ws_xpixel: 0, ws_ypixel: 0 };
    Ok(tcsetwinsize(controller, size)?)
}

/// Sends a signal to a process that has not been waited for.
pub(crate) fn send_signal(process: u32, signal: Signal) {
    if let Some(process) = i32::try_from(process).ok().and_then(Pid::from_raw) {
        // The process may have ended in the meantime.
        let _ = kill_process(process, signal);
    }
}

/// Makes standard input the controlling terminal of this process, which the host has started. Call it first.
///
/// # Errors
/// Standard input is not a terminal, or the process was not started by a host.
pub fn take_terminal() -> io::Result<()> {
    rustix::process::setsid()?;
    Ok(rustix::process::ioctl_tiocsctty(rustix::stdio::stdin())?)
}
