//! The process of a script. The session starts the process in a clean environment, answers the requests of the script,
//! and terminates the process together with its child processes.

use std::ffi::OsString;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::ScriptRequest;
use super::captured_pipe::CapturedPipe;
use super::channel::{Channel, ChannelEvent};
use super::confinement;
use super::interpreter::Interpreter;
use super::script_folder::ScriptFolder;

/// Python code that runs before the script.
const BOOTSTRAP: &str = include_str!("../../../assets/scripts/python.py");
const MAX_MEMORY_BYTES: u64 = 1 << 30;
/// Time between two checks of the deadline and the process.
const POLL_INTERVAL: Duration = Duration::from_millis(50);
/// Time between two checks of a process that has closed its socket.
const EXIT_POLL_INTERVAL: Duration = Duration::from_millis(2);
/// Time that an ended process may take to close its pipes.
const PIPE_CLOSE_TIMEOUT: Duration = Duration::from_millis(500);
/// Number of the signal SIGXCPU (processor time limit exceeded) on all supported systems.
const SIGXCPU: i32 = 24;

#[derive(Debug)]
pub(super) enum ScriptEnd {
    /// The process exited or was terminated by a signal.
    Ended(ExitStatus),
    /// The process reached its time limit.
    TimedOut,
    /// The player stopped the script.
    Stopped,
}

#[derive(Debug)]
pub(super) struct ScriptProcess {
    process: Child,
    channel: Channel,
    pub stdout: CapturedPipe,
    pub stderr: CapturedPipe,
    deadline: Instant,
    /// The first message to the process: code and limits.
    setup_message: Value,
    folder: ScriptFolder,
}

impl ScriptProcess {
    /// Starts Python with this code and time limit.
    ///
    /// # Errors
    /// python3 does not exist, or the system cannot create a process, socket or folder.
    pub fn start(code: &str, interpreter: Interpreter, time: Duration) -> std::io::Result<ScriptProcess> {
        let deadline = Instant::now() + time;
        let folder = ScriptFolder::create()?;
        let (channel, other) = Channel::pair()?;
        let path = std::env::var_os("PATH").unwrap_or_else(|| OsString::from("/usr/local/bin:/usr/bin:/bin"));
        let (program, path) = interpreter.program(path)?;
        let mut command = Command::new(program);
        command.args(["-I", "-B", "-X", "utf8", "-c", BOOTSTRAP]).current_dir(folder.path());
        // The process cannot start threads, so numerical libraries must use one thread.
        command.env_clear().env("PATH", path).envs([("OPENBLAS_NUM_THREADS", "1"), ("OMP_NUM_THREADS", "1")]);
        command.stdin(other).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
        let mut process = confinement::spawn(&mut command, folder.path())?;
        // Close the child's end of the socket in this process, so that the exit of the child can be detected.
        drop(command);
        let pipes = (process.stdout.take(), process.stderr.take());
        let (Some(stdout), Some(stderr)) = pipes else { unreachable!("both pipes were requested") };
        let captured =
            CapturedPipe::start(stdout).and_then(|stdout| Ok((stdout, CapturedPipe::start(stderr)?)));
        let (stdout, stderr) = match captured {
            Ok(both) => both,
            Err(error) => {
                let _ = process.kill().and_then(|()| process.wait());
                return Err(error);
            }
        };
        let given = json!({ "code": code, "seconds": time.as_secs_f64(), "memory": MAX_MEMORY_BYTES });
        Ok(ScriptProcess { process, channel, stdout, stderr, deadline, setup_message: given, folder })
    }

    /// Replaces the path of the script's folder in a text. In a hosted session, the path is a path of the server.
    pub fn without_folder(&self, text: String) -> String {
        match confinement::is_restricted() {
            true => text.replace(&*self.folder.path().to_string_lossy(), "."),
            false => text,
        }
    }

    /// Returns the time until the deadline of the script.
    pub fn time_left(&self) -> Duration {
        self.deadline.saturating_duration_since(Instant::now())
    }

    /// Answers requests until the script ends, reaches its time limit or is stopped.
    pub fn serve(
        &mut self,
        is_stopped: &dyn Fn() -> bool,
        answer: &mut dyn FnMut(Option<ScriptRequest>, Duration) -> Value,
    ) -> ScriptEnd {
        // Ignore the error: if the process does not read its code, the error of the process is reported.
        let given = self.setup_message.take();
        let _ = self.send_line(&given, is_stopped);
        let mut is_channel_open = true;
        loop {
            if is_stopped() {
                return self.terminate(ScriptEnd::Stopped);
            }
            if self.time_left().is_zero() {
                return self.terminate(ScriptEnd::TimedOut);
            }
            let channel_event = match is_channel_open {
                true => self.channel.receive(POLL_INTERVAL.min(self.time_left())),
                false => {
                    self.channel.close();
                    sleep(EXIT_POLL_INTERVAL);
                    ChannelEvent::Idle
                }
            };
            match channel_event {
                ChannelEvent::Request(request) => {
                    let value = answer(request, self.time_left());
                    is_channel_open = self.send_line(&value, is_stopped).is_ok();
                }
                ChannelEvent::Closed => is_channel_open = false,
                ChannelEvent::Idle => {
                    if let Ok(Some(status)) = self.process.try_wait() {
                        return self.finish(status);
                    }
                }
            }
        }
    }

    /// Sends a line. Gives up if the deadline has passed, the script is stopped or its process has ended.
    fn send_line(&mut self, message: &Value, is_stopped: &dyn Fn() -> bool) -> std::io::Result<()> {
        let Self { process, channel, deadline, .. } = self;
        channel.send_line(message, &mut || {
            is_stopped() || Instant::now() >= *deadline || !matches!(process.try_wait(), Ok(None))
        })
    }

    /// Handles the exit of the process. Kills its group if a child process keeps the pipes open.
    fn finish(&mut self, status: ExitStatus) -> ScriptEnd {
        if !self.wait_for_pipes() {
            self.kill_group();
            self.wait_for_pipes();
        }
        match status.signal() {
            Some(SIGXCPU) => ScriptEnd::TimedOut,
            _ => ScriptEnd::Ended(status),
        }
    }

    fn terminate(&mut self, how: ScriptEnd) -> ScriptEnd {
        self.kill_group();
        let _ = self.process.kill().and_then(|()| self.process.wait());
        self.wait_for_pipes();
        how
    }

    fn wait_for_pipes(&self) -> bool {
        let until = Instant::now() + PIPE_CLOSE_TIMEOUT;
        let left = || until.saturating_duration_since(Instant::now());
        self.stdout.closes_within(left()) && self.stderr.closes_within(left())
    }

    /// Kills the process group, whose id equals the process id.
    fn kill_group(&self) {
        let command = format!("kill -s KILL -- -{}", self.process.id());
        let mut shell = Command::new("/bin/sh");
        shell.args(["-c", &command]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        // Ignore the error: all processes of the group may have ended already.
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

    /// Python code that finds the socket to the program and sends one request.
    const ASK_ONCE_CODE: &str = r#"
import os, stat, time
def is_socket(number):
    try:
        return stat.S_ISSOCK(os.fstat(number).st_mode)
    except OSError:
        return False
socket = next(number for number in range(3, 64) if is_socket(number))
os.write(socket, b'{"ask":"vars"}\n')
"#;

    /// Serves a script that sends one request. The answer is larger than the socket buffer.
    fn serve_script(code: &str, time: Duration, stop_after_asking: bool) -> (ScriptEnd, ScriptProcess) {
        let mut process =
            ScriptProcess::start(&format!("{ASK_ONCE_CODE}{code}"), Interpreter::FromPath, time)
                .expect("python3");
        let has_asked = Cell::new(false);
        let end = process.serve(&|| stop_after_asking && has_asked.get(), &mut |_, _| {
            has_asked.set(true);
            Value::from("x".repeat(8 << 20))
        });
        assert!(has_asked.get(), "{}", process.stderr.first_text());
        (end, process)
    }

    #[test]
    fn slow_reader_is_terminated_at_the_deadline() {
        // Reading the whole answer would take 8 MiB / 64 KiB * 0.2 s = 25 s.
        let code =
            "while True:\n    os.read(socket, 1 << 16)\n    print('x', flush=True)\n    time.sleep(0.2)";
        let (end, process) = serve_script(code, Duration::from_secs(3), false);
        assert!(matches!(end, ScriptEnd::TimedOut), "{end:?}");
        let reads = process.stdout.first_text().lines().count();
        assert!(reads < 60, "it read {reads} times");
    }

    #[test]
    fn script_that_never_reads_is_terminated_at_the_deadline() {
        let (end, _) = serve_script("time.sleep(600)", Duration::from_secs(3), false);
        assert!(matches!(end, ScriptEnd::TimedOut), "{end:?}");
    }

    #[test]
    fn script_is_cancelled_during_a_blocked_write() {
        let (end, _) = serve_script("time.sleep(600)", Duration::from_secs(600), true);
        assert!(matches!(end, ScriptEnd::Stopped), "{end:?}");
    }

    #[test]
    fn script_exit_is_detected_during_a_blocked_write() {
        let (end, _) = serve_script("time.sleep(0.1)", Duration::from_secs(600), false);
        assert!(matches!(end, ScriptEnd::Ended(status) if status.success()), "{end:?}");
    }
}
