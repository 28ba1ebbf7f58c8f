//! The built program in a pseudoterminal, with access to its screen, its output and its exit code.

use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};

fn screen_cells(count: u16) -> NonZeroU16 {
    NonZeroU16::new(count).expect("a size")
}

/// The program in a pseudoterminal.
pub struct Terminal {
    child: Box<dyn Child + Send + Sync>,
    master: Box<dyn MasterPty + Send>,
    writer: Box<dyn Write + Send>,
    bytes: Receiver<Vec<u8>>,
    screen: vt100::Parser,
    /// All bytes that the program has written.
    written: Vec<u8>,
}

impl Terminal {
    /// Starts the program in a pseudoterminal with a folder of runs.
    pub fn start(runs: &Path, arguments: &[&str], size: (u16, u16)) -> Terminal {
        Terminal::start_with(runs, arguments, size, &[])
    }

    /// Starts the program in a pseudoterminal with environment variables.
    pub fn start_with(
        runs: &Path,
        arguments: &[&str],
        (columns, rows): (u16, u16),
        variables: &[(&str, &str)],
    ) -> Terminal {
        let size = PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 };
        let pair = native_pty_system().openpty(size).expect("a terminal");
        // The file size limit must cause an error in the program, as a full disk does, instead of a signal.
        let mut command = CommandBuilder::new("sh");
        command.args(["-c", "trap '' XFSZ; exec \"$0\" \"$@\"", env!("CARGO_BIN_EXE_novamind")]);
        command.args(arguments);
        command.env("NOVAMIND_RUNS", runs);
        command.env("NOVAMIND_CONFIG", runs.join("no-configuration"));
        command.env("TERM", "xterm-256color");
        command.env_remove("NO_COLOR");
        for (name, value) in variables {
            command.env(name, value);
        }
        let child = pair.slave.spawn_command(command).expect("the program starts");
        drop(pair.slave);
        let mut reader = pair.master.try_clone_reader().expect("a reader");
        let (sender, bytes) = channel();
        std::thread::spawn(move || {
            let mut buffer = [0; 8192];
            while let Ok(count) = reader.read(&mut buffer) {
                if count == 0 || sender.send(buffer[..count].to_vec()).is_err() {
                    return;
                }
            }
        });
        let writer = pair.master.take_writer().expect("a writer");
        Terminal {
            child,
            master: pair.master,
            writer,
            bytes,
            screen: vt100::Parser::new(screen_cells(rows), screen_cells(columns), 0),
            written: Vec::new(),
        }
    }

    /// Clears the emulated screen, as if another program had overwritten it.
    pub fn clear_screen(&mut self) {
        self.screen.process(b"\x1b[2J");
    }

    /// Sends the bytes of keys to the program.
    pub fn type_keys(&mut self, keys: &str) {
        self.writer.write_all(keys.as_bytes()).expect("written");
        self.writer.flush().expect("flushed");
    }

    /// Waits until the screen shows a text. A failure prints the screen.
    pub fn wait_for(&mut self, text: &str) {
        self.wait_until(text, |screen, _| screen.contains(text));
    }

    /// Waits until the screen no longer shows a text.
    pub fn wait_until_gone(&mut self, text: &str) {
        self.wait_until(text, |screen, _| !screen.contains(text));
    }

    /// Waits until the program has written certain bytes, which can be invisible.
    pub fn wait_for_bytes(&mut self, bytes: &[u8]) {
        let name = String::from_utf8_lossy(bytes).into_owned();
        self.wait_until(&name, |_, written| written.windows(bytes.len()).any(|window| window == bytes));
    }

    fn wait_until(&mut self, what: &str, done: impl Fn(&str, &[u8]) -> bool) {
        let deadline = Instant::now() + Duration::from_secs(60);
        while !done(&self.screen.screen().contents(), &self.written) {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.bytes.recv_timeout(left) {
                Ok(bytes) => self.process_output(&bytes),
                Err(_) => panic!("waiting for {what:?} in vain:\n{}", self.screen.screen().contents()),
            }
        }
    }

    /// Waits until a condition outside the screen is true.
    pub fn wait_until_true(&mut self, what: &str, holds: impl Fn() -> bool) {
        let deadline = Instant::now() + Duration::from_secs(60);
        while !holds() {
            while let Ok(bytes) = self.bytes.try_recv() {
                self.process_output(&bytes);
            }
            assert!(Instant::now() < deadline, "waiting for {what:?} in vain:\n{}", self.contents());
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Returns whether the terminal is in raw mode.
    pub fn is_raw(&self) -> bool {
        !self.read_terminal_settings().split_whitespace().any(|word| word == "icanon")
    }

    /// Waits until the program has set raw mode.
    pub fn wait_until_raw(&mut self) {
        let path = self.path();
        let is_raw = || !terminal_settings(&path, &["-a"]).split_whitespace().any(|word| word == "icanon");
        self.wait_until_true("raw mode", is_raw);
    }

    /// Waits until the process has been stopped by a signal.
    pub fn wait_until_stopped(&mut self) {
        let process = self.process();
        let state = || {
            let asked = std::process::Command::new("ps").args(["-o", "stat=", "-p", &process]).output();
            asked.is_ok_and(|answer| answer.stdout.trim_ascii().starts_with(b"T"))
        };
        self.wait_until_true("a stopped process", state);
    }

    /// Sets line mode, as a shell does.
    pub fn set_canonical_mode(&self) {
        terminal_settings(&self.path(), &["icanon", "echo"]);
    }

    fn read_terminal_settings(&self) -> String {
        terminal_settings(&self.path(), &["-a"])
    }

    fn path(&self) -> std::path::PathBuf {
        self.master.tty_name().expect("a terminal has a name")
    }

    /// Returns the exit code. If the program does not end in time, the test fails and prints the screen.
    fn exit_code(&mut self) -> u32 {
        let deadline = Instant::now() + Duration::from_secs(60);
        loop {
            if let Some(status) = self.child.try_wait().expect("a process") {
                return status.exit_code();
            }
            while let Ok(bytes) = self.bytes.try_recv() {
                self.process_output(&bytes);
            }
            if Instant::now() > deadline {
                let _ = self.child.kill();
                panic!("it did not end:\n{}", self.contents());
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    fn process_output(&mut self, bytes: &[u8]) {
        self.screen.process(bytes);
        self.written.extend_from_slice(bytes);
    }

    /// Returns the contents of the screen.
    pub fn contents(&self) -> String {
        self.screen.screen().contents()
    }

    /// Returns all bytes that the program has written.
    pub fn written(&self) -> &[u8] {
        &self.written
    }

    /// Returns the process ID.
    pub fn process(&self) -> String {
        self.child.process_id().expect("a process").to_string()
    }

    /// Limits the size of files that the process writes, which simulates a full disk. `unlimited` removes the limit.
    #[cfg(target_os = "linux")]
    pub fn limit_file_size(&self, bytes: &str) {
        let arguments = ["--pid", &self.process(), &format!("--fsize={bytes}:")].map(str::to_owned);
        assert!(
            std::process::Command::new("prlimit").args(arguments).status().expect("prlimit runs").success()
        );
    }

    /// Sends a signal to the process, for example `-TERM`.
    pub fn signal(&self, signal: &str) {
        let sent = std::process::Command::new("kill").args([signal, &self.process()]).status();
        assert!(sent.expect("kill runs").success());
    }

    /// Changes the size of the window.
    pub fn resize(&mut self, columns: u16, rows: u16) {
        let size = PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 };
        self.master.resize(size).expect("resized");
        self.screen.screen_mut().set_size(screen_cells(rows), screen_cells(columns));
    }

    /// Waits for the end of a process that was killed.
    pub fn wait_for_killed(mut self) {
        self.exit_code();
    }

    /// Waits for the end of the process, and returns its exit code and the last screen.
    pub fn wait_for_end(mut self) -> (u32, String) {
        let code = self.exit_code();
        while let Ok(bytes) = self.bytes.recv_timeout(Duration::from_secs(5)) {
            self.process_output(&bytes);
        }
        assert!(!self.screen.screen().alternate_screen(), "the terminal is not restored");
        (code, self.screen.screen().contents())
    }
}

fn terminal_settings(terminal: &Path, arguments: &[&str]) -> String {
    let device = std::fs::File::open(terminal).expect("the terminal opens");
    let answer = std::process::Command::new("stty").args(arguments).stdin(device).output();
    String::from_utf8(answer.expect("stty runs").stdout).expect("text")
}

/// Plays a run with a policy and saves the run in a folder of runs.
pub fn play_policy(runs: &Path, arguments: &[&str]) {
    let played = std::process::Command::new(env!("CARGO_BIN_EXE_novamind"))
        .arg("run")
        .args(arguments)
        .arg("--save")
        .env("NOVAMIND_RUNS", runs)
        .env("NOVAMIND_CONFIG", runs.join("no-configuration"))
        .output()
        .expect("the program runs");
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
}
