//! The process of a script: started in a clean environment, served while it runs, terminated with its child
//! processes.

use std::ffi::OsString;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::ScriptRequest;
use super::captured::Captured;
use super::channel::{Channel, Heard};
use super::empty_folder::EmptyFolder;
use super::interpreter::Interpreter;

/// Python code that runs before the script.
const BOOTSTRAP: &str = include_str!("../../../assets/scripts/python.py");
const MOST_MEMORY: u64 = 1 << 30;
/// Time between two checks of clock and process.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);
/// Time between two checks of a process that has closed its socket.
const BETWEEN_LAST_LOOKS: Duration = Duration::from_millis(2);
/// Time that an ended process may take to close its pipes.
const LEAVING: Duration = Duration::from_millis(500);
/// Number of the signal SIGXCPU (processor time limit), on every system with python3.
const TIME_IS_OVER: i32 = 24;

#[derive(Debug)]
pub(super) enum ScriptEnd {
    /// It exited, or was ended by a signal.
    Ended(ExitStatus),
    /// It reached its time limit.
    TimedOut,
    /// The player stopped it.
    Stopped,
}

#[derive(Debug)]
pub(super) struct ScriptProcess {
    process: Child,
    channel: Channel,
    pub stdout: Captured,
    pub stderr: Captured,
    deadline: Instant,
    /// The first message to the process: code and limits.
    given: Value,
    _folder: EmptyFolder,
}

impl ScriptProcess {
    /// Starts Python with this code and time limit.
    ///
    /// # Errors
    /// python3 does not exist, or the system cannot create a process, socket or folder.
    pub fn start(code: &str, interpreter: Interpreter, time: Duration) -> std::io::Result<ScriptProcess> {
        let deadline = Instant::now() + time;
        let folder = EmptyFolder::create()?;
        let (channel, other) = Channel::pair()?;
        let path = std::env::var_os("PATH").unwrap_or_else(|| OsString::from("/usr/local/bin:/usr/bin:/bin"));
        let (program, path) = interpreter.program(path)?;
        let mut command = Command::new(program);
        command.args(["-I", "-B", "-X", "utf8", "-c", BOOTSTRAP]).current_dir(folder.path());
        // The process cannot start threads, so numerical libraries must not use them.
        command.env_clear().env("PATH", path).envs([("OPENBLAS_NUM_THREADS", "1"), ("OMP_NUM_THREADS", "1")]);
        command.stdin(other).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
        let mut process = command.spawn()?;
        // Closes the child's end of the socket here, so that its exit can be detected.
        drop(command);
        let pipes = (process.stdout.take(), process.stderr.take());
        let (Some(stdout), Some(stderr)) = pipes else { unreachable!("both pipes were requested") };
        let captured = Captured::of(stdout).and_then(|stdout| Ok((stdout, Captured::of(stderr)?)));
        let (stdout, stderr) = match captured {
            Ok(both) => both,
            Err(error) => {
                let _ = process.kill().and_then(|()| process.wait());
                return Err(error);
            }
        };
        let given = json!({ "code": code, "seconds": time.as_secs_f64(), "memory": MOST_MEMORY });
        Ok(ScriptProcess { process, channel, stdout, stderr, deadline, given, _folder: folder })
    }

    /// Returns the remaining time.
    pub fn left(&self) -> Duration {
        self.deadline.saturating_duration_since(Instant::now())
    }

    /// Answers requests until the script ends, reaches its time limit or is stopped.
    pub fn serve(
        &mut self,
        is_stopped: &dyn Fn() -> bool,
        answer: &mut dyn FnMut(Option<ScriptRequest>, Duration) -> Value,
    ) -> ScriptEnd {
        // If the process does not read its code, its own error is reported.
        let given = self.given.take();
        let _ = self.say(&given, is_stopped);
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
                    is_heard = self.say(&told, is_stopped).is_ok();
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

    /// Sends a line until the time is over, the script is stopped or its process has ended.
    fn say(&mut self, message: &Value, is_stopped: &dyn Fn() -> bool) -> std::io::Result<()> {
        let Self { process, channel, deadline, .. } = self;
        channel.say(message, &mut || {
            is_stopped() || Instant::now() >= *deadline || !matches!(process.try_wait(), Ok(None))
        })
    }

    /// Handles the exit of the process. Kills its group if a child process keeps the pipes open.
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

    /// Kills the process group, whose number is the process id.
    fn kill_group(&self) {
        let command = format!("kill -s KILL -- -{}", self.process.id());
        let mut shell = Command::new("/bin/sh");
        shell.args(["-c", &command]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        // The group may have ended already.
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

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Finds the socket to the program and sends one request.
    const ASK: &str = r#"
import os, stat, time
def is_socket(number):
    try:
        return stat.S_ISSOCK(os.fstat(number).st_mode)
    except OSError:
        return False
socket = next(number for number in range(3, 64) if is_socket(number))
os.write(socket, b'{"ask":"vars"}\n')
"#;

    /// Serves a script that sends one request, with an answer larger than the socket buffer.
    fn served(code: &str, time: Duration, stop_after_asking: bool) -> (ScriptEnd, ScriptProcess) {
        let mut process =
            ScriptProcess::start(&format!("{ASK}{code}"), Interpreter::OfPath, time).expect("python3");
        let has_asked = Cell::new(false);
        let end = process.serve(&|| stop_after_asking && has_asked.get(), &mut |_, _| {
            has_asked.set(true);
            Value::from("x".repeat(8 << 20))
        });
        assert!(has_asked.get(), "{}", process.stderr.first());
        (end, process)
    }

    #[test]
    fn a_reader_that_takes_a_little_at_a_time_is_ended_at_its_deadline() {
        // Reading everything would take 8 MiB / 64 KiB * 0.2 s = 25 s.
        let code =
            "while True:\n    os.read(socket, 1 << 16)\n    print('x', flush=True)\n    time.sleep(0.2)";
        let (end, process) = served(code, Duration::from_secs(3), false);
        assert!(matches!(end, ScriptEnd::TimedOut), "{end:?}");
        let reads = process.stdout.first().lines().count();
        assert!(reads < 60, "it read {reads} times");
    }

    #[test]
    fn a_script_that_never_reads_is_ended_at_its_deadline() {
        let (end, _) = served("time.sleep(600)", Duration::from_secs(3), false);
        assert!(matches!(end, ScriptEnd::TimedOut), "{end:?}");
    }

    #[test]
    fn a_script_is_cancelled_while_a_write_to_it_waits() {
        let (end, _) = served("time.sleep(600)", Duration::from_secs(600), true);
        assert!(matches!(end, ScriptEnd::Stopped), "{end:?}");
    }

    #[test]
    fn a_script_that_ends_while_a_write_to_it_waits_has_ended() {
        let (end, _) = served("time.sleep(0.1)", Duration::from_secs(600), false);
        assert!(matches!(end, ScriptEnd::Ended(status) if status.success()), "{end:?}");
    }
}
