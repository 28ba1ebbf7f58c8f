//! The built program in a pseudo terminal: start, play, leave, come back; signals, small windows.
#![cfg(unix)]

use std::io::{Read, Write};
use std::num::NonZeroU16;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};

fn cells(count: u16) -> NonZeroU16 {
    NonZeroU16::new(count).expect("a size")
}

/// The program in a terminal.
struct Terminal {
    child: Box<dyn Child + Send + Sync>,
    master: Box<dyn MasterPty + Send>,
    writer: Box<dyn Write + Send>,
    bytes: Receiver<Vec<u8>>,
    screen: vt100::Parser,
}

impl Terminal {
    fn start(runs: &Path, arguments: &[&str], (columns, rows): (u16, u16)) -> Terminal {
        let size = PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 };
        let pair = native_pty_system().openpty(size).expect("a terminal");
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_novamind"));
        command.args(arguments);
        command.env("NOVAMIND_RUNS", runs);
        command.env("NOVAMIND_CONFIG", runs.join("no-configuration"));
        command.env("TERM", "xterm-256color");
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
            screen: vt100::Parser::new(cells(rows), cells(columns), 0),
        }
    }

    fn type_keys(&mut self, keys: &str) {
        self.writer.write_all(keys.as_bytes()).expect("written");
        self.writer.flush().expect("flushed");
    }

    /// Waits until the screen shows some text; fails with the whole screen.
    fn wait_for(&mut self, text: &str) {
        let deadline = Instant::now() + Duration::from_secs(60);
        while !self.screen.screen().contents().contains(text) {
            let left = deadline.saturating_duration_since(Instant::now());
            match self.bytes.recv_timeout(left) {
                Ok(bytes) => self.screen.process(&bytes),
                Err(_) => panic!("{text:?} does not appear:\n{}", self.screen.screen().contents()),
            }
        }
    }

    fn resize(&mut self, columns: u16, rows: u16) {
        let size = PtySize { rows, cols: columns, pixel_width: 0, pixel_height: 0 };
        self.master.resize(size).expect("resized");
        self.screen.screen_mut().set_size(cells(rows), cells(columns));
    }

    /// Waits for the end; returns the exit code and what is on the screen then.
    fn end(mut self) -> (u32, String) {
        let code = self.child.wait().expect("it ends").exit_code();
        while let Ok(bytes) = self.bytes.recv_timeout(Duration::from_secs(5)) {
            self.screen.process(&bytes);
        }
        assert!(!self.screen.screen().alternate_screen(), "the terminal is not restored");
        (code, self.screen.screen().contents())
    }
}

#[test]
fn a_person_starts_plays_two_weeks_leaves_and_continues() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &[], (120, 40));
    terminal.wait_for("New run");
    terminal.type_keys("n");
    terminal.wait_for("enter begins the run");
    terminal.type_keys("\r");
    terminal.wait_for("day 0/500");
    terminal.type_keys("8\r12\r25\r55\r");
    terminal.wait_for("pricing.set_prices");
    terminal.type_keys("\x13");
    terminal.wait_for("set_prices: done");
    for (week, day) in [(1, 7), (2, 14)] {
        terminal.type_keys("n");
        terminal.wait_for("[1 review]");
        terminal.type_keys("\rbecause\r");
        terminal.wait_for("[3 forecasts]");
        terminal.type_keys("f\r");
        terminal.wait_for(&format!("Week {week} · day {day}"));
        terminal.type_keys("\r");
    }
    terminal.wait_for("day 14/500");
    terminal.type_keys("q");
    let (code, screen) = terminal.end();
    assert_eq!(code, 0);
    assert!(screen.contains("is saved at day 14"), "{screen}");
    let mut terminal = Terminal::start(runs.path(), &["--run", "latest"], (80, 24));
    terminal.wait_for("day 14/500");
    terminal.type_keys("\x03");
    assert_eq!(terminal.end().0, 0);
}

#[test]
fn a_small_window_asks_for_a_larger_one_and_growing_brings_the_screen() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new", "--seed", "1"], (40, 5));
    terminal.wait_for("NovaMind needs 60×16");
    terminal.resize(100, 30);
    terminal.wait_for("Needs you");
    terminal.resize(20, 5);
    terminal.wait_for("NovaMind needs 60×");
    terminal.type_keys("q");
    assert_eq!(terminal.end().0, 0);
}

#[test]
fn termination_restores_the_terminal_and_keeps_the_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--new"], (100, 30));
    terminal.wait_for("day 0/500");
    let id = terminal.child.process_id().expect("a process").to_string();
    std::process::Command::new("kill").args(["-TERM", &id]).status().expect("kill runs");
    let (code, screen) = terminal.end();
    assert_eq!(code, 128 + 15);
    assert!(screen.contains("is saved at day 0"), "{screen}");
}

#[test]
fn a_wrong_theme_or_key_file_is_named_before_the_terminal_is_taken() {
    let runs = tempfile::tempdir().expect("a folder");
    let (code, screen) = Terminal::start(runs.path(), &["--theme", "pink"], (100, 30)).end();
    assert_eq!(code, 2);
    assert!(screen.contains("there is no theme pink"), "{screen}");
    let configuration = runs.path().join("no-configuration");
    std::fs::create_dir(&configuration).expect("a folder");
    std::fs::write(configuration.join("keys.toml"), "[global]\nquit = [\"hyper\"]").expect("written");
    let (code, screen) = Terminal::start(runs.path(), &[], (100, 30)).end();
    assert_eq!(code, 3);
    assert!(screen.contains("keys.toml") && screen.contains("is no key"), "{screen}");
}

#[test]
fn ascii_and_no_colour_are_honoured() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut terminal = Terminal::start(runs.path(), &["--ascii", "--theme", "mono", "--new"], (100, 30));
    terminal.wait_for("day 0/500");
    terminal.wait_for("Needs you");
    let contents = terminal.screen.screen().contents();
    assert!(contents.is_ascii(), "{contents}");
    terminal.type_keys("q");
    assert_eq!(terminal.end().0, 0);
}
