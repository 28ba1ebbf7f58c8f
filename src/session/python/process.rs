//! The process of a script: started with nothing of its surroundings, served while it runs, ended with all that it started.

use std::ffi::OsString;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::captured::Captured;
use super::channel::{Channel, Heard, ScriptRequest};
use super::empty_folder::EmptyFolder;
use super::interpreter::Interpreter;

/// What runs before the script, within the process.
const BOOTSTRAP: &str = include_str!("../../../assets/scripts/python.py");
/// Memory of a script, bytes.
const MOST_MEMORY: u64 = 1 << 30;
/// Time between two looks at clock and process.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);
/// Time between two looks at a process that has nothing more to ask.
const BETWEEN_LAST_LOOKS: Duration = Duration::from_millis(2);
/// A process that has ended may take this long to leave its pipes.
const LEAVING: Duration = Duration::from_millis(500);
/// The signal by which the kernel tells that processor time is over, on every system that has python3.
const TIME_IS_OVER: i32 = 24;

/// How a script ended.
#[derive(Debug)]
pub(super) enum ScriptEnd {
    /// By itself, or by a signal.
    Ended(ExitStatus),
    /// Its time was over.
    TimedOut,
    /// Somebody stopped it.
    Stopped,
}

/// A running script.
#[derive(Debug)]
pub(super) struct ScriptProcess {
    process: Child,
    channel: Channel,
    pub stdout: Captured,
    pub stderr: Captured,
    deadline: Instant,
    _folder: EmptyFolder,
}

impl ScriptProcess {
    /// Starts Python with this code; it has to end in this time.
    ///
    /// # Errors
    /// There is no python3, or the system has no process, socket or folder for it.
    pub fn start(code: &str, interpreter: Interpreter, time: Duration) -> std::io::Result<ScriptProcess> {
        let deadline = Instant::now() + time;
        let folder = EmptyFolder::create()?;
        let (mut channel, other) = Channel::pair()?;
        let path = std::env::var_os("PATH").unwrap_or_else(|| OsString::from("/usr/local/bin:/usr/bin:/bin"));
        let (program, path) = interpreter.program(path)?;
        let mut command = Command::new(program);
        command.args(["-I", "-B", "-X", "utf8", "-c", BOOTSTRAP]).current_dir(folder.path());
        // A library that splits its work over threads would find none.
        command.env_clear().env("PATH", path).envs([("OPENBLAS_NUM_THREADS", "1"), ("OMP_NUM_THREADS", "1")]);
        command.stdin(other).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
        let mut process = command.spawn()?;
        // Its end of the socket is closed here, so that its death is heard.
        drop(command);
        let pipes = (process.stdout.take(), process.stderr.take());
        let (Some(stdout), Some(stderr)) = pipes else { unreachable!("both were asked for") };
        let captured = Captured::of(stdout).and_then(|stdout| Ok((stdout, Captured::of(stderr)?)));
        let (stdout, stderr) = match captured {
            Ok(both) => both,
            Err(error) => {
                let _ = process.kill().and_then(|()| process.wait());
                return Err(error);
            }
        };
        let given = json!({ "code": code, "seconds": time.as_secs_f64(), "memory": MOST_MEMORY });
        // A process that does not take its code has something to say of itself.
        let _ = channel.say(&given, time);
        Ok(ScriptProcess { process, channel, stdout, stderr, deadline, _folder: folder })
    }

    /// Time that is left.
    pub fn left(&self) -> Duration {
        self.deadline.saturating_duration_since(Instant::now())
    }

    /// Answers what it asks until it ends, its time is over, or somebody stops it.
    pub fn serve(
        &mut self,
        is_stopped: &dyn Fn() -> bool,
        answer: &mut dyn FnMut(Option<ScriptRequest>, Duration) -> Value,
    ) -> ScriptEnd {
        let mut is_heard = true;
        loop {
            if is_stopped() {
                return self.end(ScriptEnd::Stopped);
            }
            if self.left().is_zero() {
                return self.end(ScriptEnd::TimedOut);
            }
            let heard = match is_heard {
                true => self.channel.hear(BETWEEN_LOOKS.min(self.left())),
                false => {
                    self.channel.close();
                    sleep(BETWEEN_LAST_LOOKS);
                    Heard::Nothing
                }
            };
            match heard {
                Heard::Request(request) => {
                    let told = answer(request, self.left());
                    is_heard = self.channel.say(&told, self.left()).is_ok();
                }
                Heard::End => is_heard = false,
                Heard::Nothing => {
                    if let Ok(Some(status)) = self.process.try_wait() {
                        return self.ended(status);
                    }
                }
            }
        }
    }

    /// A process that has ended leaves its pipes, unless it left others behind.
    fn ended(&mut self, status: ExitStatus) -> ScriptEnd {
        if !self.has_left_pipes() {
            self.kill_group();
            self.has_left_pipes();
        }
        match status.signal() {
            Some(TIME_IS_OVER) => ScriptEnd::TimedOut,
            _ => ScriptEnd::Ended(status),
        }
    }

    fn end(&mut self, how: ScriptEnd) -> ScriptEnd {
        self.kill_group();
        let _ = self.process.kill().and_then(|()| self.process.wait());
        self.has_left_pipes();
        how
    }

    fn has_left_pipes(&self) -> bool {
        let until = Instant::now() + LEAVING;
        let left = || until.saturating_duration_since(Instant::now());
        self.stdout.ends_within(left()) && self.stderr.ends_within(left())
    }

    /// Ends what the process started; its own number is that of their group.
    fn kill_group(&self) {
        let command = format!("kill -s KILL -- -{}", self.process.id());
        let mut shell = Command::new("/bin/sh");
        shell.args(["-c", &command]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        // A group that is gone is what was wanted.
        let _ = shell.status();
    }
}

impl Drop for ScriptProcess {
    fn drop(&mut self) {
        if matches!(self.process.try_wait(), Ok(None)) {
            let _ = self.process.kill().and_then(|()| self.process.wait());
        }
    }
}
