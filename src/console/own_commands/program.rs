//! Runs an external program with rows on its standard input. The program has no access to the run: it gets the rows and
//! the run's id, and its output is shown.

use std::io::{self, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use super::ExternalProgram;
use novamind_worker::answer_on_thread;
use novamind_worker::message::{Message, Response};

/// Maximum size of the output and of the error output, in bytes. The rest is read and discarded.
const MAX_OUTPUT_BYTES: usize = 1 << 20;
/// Time between two checks of the program.
const POLL_INTERVAL: Duration = Duration::from_millis(20);
/// Time that an ended program may take to close its output.
const PIPE_CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

/// A program with its input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramCall {
    /// Name of the command.
    pub name: String,
    /// The program to run.
    pub program: ExternalProgram,
    /// Rows that the program reads.
    pub input: String,
    /// Identifier of the run, in the environment variable `NOVAMIND_RUN`.
    pub run: String,
}

/// Runs a program in the background and reports its output.
pub fn run_in_background(call: ProgramCall, news: Sender<Message>) {
    let work = move || Ok(Some(run_program(call)));
    answer_on_thread(news, work, |end| {
        Response::ProgramEnded(end.unwrap_or_else(|refusal| Err(refusal.message)))
    });
}

/// Runs a program until it ends or reaches its time limit. Returns a title and the output.
///
/// # Errors
/// The program does not start, or reaches its time limit. The message says what to do.
fn run_program(call: ProgramCall) -> Result<(String, String), String> {
    let ProgramCall { name, program, input, run } = call;
    let mut command = Command::new(&program.command[0]);
    command.args(&program.command[1..]).env("NOVAMIND_RUN", run);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    // A separate process group cannot read from the terminal, and is killed together with its child processes.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut process = command.spawn().map_err(|error| {
        format!("{name}: {} did not start: {error}. Check program in commands.toml.", program.command[0])
    })?;
    if let Some(mut stdin) = process.stdin.take() {
        // The program may end without reading its input.
        std::thread::spawn(move || stdin.write_all(input.as_bytes()));
    }
    let (stdout, stderr) = (read_pipe(process.stdout.take()), read_pipe(process.stderr.take()));
    let status = wait_until(&mut process, Instant::now() + program.timeout);
    let seconds = program.timeout.as_secs();
    match status {
        Ok(Some(status)) => {
            let (output, errors) = (collect(&process, &stdout), collect(&process, &stderr));
            Ok((format!("{name}{}", describe_status(status)), describe_output(&output, &errors)))
        }
        Ok(None) => Err(format!(
            "{name} was stopped after {seconds} s; the run has not changed. To allow more time, set timeout in commands.toml."
        )),
        Err(error) => Err(format!("{name}: {error}")),
    }
}

/// Waits for the end of a program. Kills the program at the deadline and returns `None`.
fn wait_until(process: &mut Child, deadline: Instant) -> io::Result<Option<ExitStatus>> {
    loop {
        if let Some(status) = process.try_wait()? {
            return Ok(Some(status));
        }
        if Instant::now() >= deadline {
            kill_group(process);
            let _ = process.kill().and_then(|()| process.wait());
            return Ok(None);
        }
        std::thread::sleep(POLL_INTERVAL);
    }
}

/// Kills the process group of a program, whose id equals the process id.
fn kill_group(process: &Child) {
    if cfg!(unix) {
        let command = format!("kill -s KILL -- -{}", process.id());
        let mut shell = Command::new("/bin/sh");
        shell.args(["-c", &command]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        // Ignore the error: all processes of the group may have ended already.
        let _ = shell.status();
    }
}

/// Reads a pipe to its end on a separate thread. Keeps at most [`MAX_OUTPUT_BYTES`].
fn read_pipe(pipe: Option<impl Read + Send + 'static>) -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        let (mut kept, mut part) = (Vec::new(), [0; 1 << 14]);
        let mut is_cut = false;
        if let Some(mut pipe) = pipe {
            while let Ok(count @ 1..) = pipe.read(&mut part) {
                let room = MAX_OUTPUT_BYTES - kept.len();
                is_cut |= count > room;
                kept.extend_from_slice(&part[..count.min(room)]);
            }
        }
        let mut text = String::from_utf8_lossy(&kept).into_owned();
        if is_cut {
            text += &format!("\n… only the first {} MB are shown", MAX_OUTPUT_BYTES >> 20);
        }
        let _ = sender.send(text);
    });
    receiver
}

/// Returns the output of an ended program. Kills its group if a child process keeps the pipe open.
fn collect(process: &Child, output: &Receiver<String>) -> String {
    output.recv_timeout(PIPE_CLOSE_TIMEOUT).unwrap_or_else(|_| {
        kill_group(process);
        output.recv_timeout(PIPE_CLOSE_TIMEOUT).unwrap_or_default()
    })
}

fn describe_status(status: ExitStatus) -> String {
    match status.code() {
        Some(0) => String::new(),
        Some(code) => format!(" (exit code {code})"),
        None => " (ended by a signal)".to_owned(),
    }
}

fn describe_output(output: &str, errors: &str) -> String {
    // Tabs and control characters would shift or hide text in the window.
    let clean = |text: &str| {
        let lines = text.lines().map(|line| line.replace('\t', "    ").replace(char::is_control, "�"));
        lines.collect::<Vec<_>>().join("\n")
    };
    match (output.trim().is_empty(), errors.trim().is_empty()) {
        (true, true) => "The program printed nothing.".to_owned(),
        (false, true) => clean(output),
        (true, false) => format!("Error output:\n{}", clean(errors)),
        (false, false) => format!("{}\n\nError output:\n{}", clean(output), clean(errors)),
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    fn call(script: &str, input: &str, seconds: u64) -> ProgramCall {
        let command = ["/bin/sh", "-c", script].map(str::to_owned).to_vec();
        let timeout = Duration::from_secs(seconds);
        let program = ExternalProgram { command, gets_all_rows: false, gets_json: false, timeout };
        ProgramCall { name: "Mine".to_owned(), program, input: input.to_owned(), run: "cafe".to_owned() }
    }

    #[test]
    fn program_reads_rows_and_its_output_is_returned() {
        let end = run_program(call("cat; echo $NOVAMIND_RUN; echo oops >&2; exit 3", "a,b\n1,2\n", 60));
        let text = "a,b\n1,2\ncafe\n\nError output:\noops".to_owned();
        assert_eq!(end, Ok(("Mine (exit code 3)".to_owned(), text)));
        let silent = run_program(call("exit 0", &"x".repeat(1 << 20), 60));
        assert_eq!(silent, Ok(("Mine".to_owned(), "The program printed nothing.".to_owned())));
    }

    #[test]
    fn program_is_killed_at_its_time_limit() {
        let problem = run_program(call("sleep 600 & wait", "", 1)).expect_err("a time limit");
        assert!(problem.contains("stopped after 1 s; the run has not changed."), "{problem}");
    }

    #[test]
    fn child_process_that_keeps_the_output_open_does_not_block() {
        let (title, _) = run_program(call("sleep 600 & echo done", "", 60)).expect("an end");
        assert_eq!(title, "Mine");
    }

    #[test]
    fn output_is_limited_and_has_no_control_characters() {
        let (_, text) = run_program(call("head -c 3000000 /dev/zero | tr '\\0' x", "", 60)).expect("output");
        assert!(text.ends_with("only the first 1 MB are shown") && text.len() < MAX_OUTPUT_BYTES + 99);
        let (_, text) = run_program(call("printf 'a\\033[2Jb\\tc'", "", 60)).expect("output");
        assert_eq!(text, "a�[2Jb    c");
    }

    #[test]
    fn missing_program_names_the_file_to_correct() {
        let mut missing = call("", "", 1);
        missing.program.command = vec!["/nowhere/at/all".to_owned()];
        let problem = run_program(missing).expect_err("no program");
        assert!(problem.contains("did not start") && problem.contains("commands.toml"), "{problem}");
    }
}
