//! The folders of a user, and the built program that runs in these folders.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The folders of a user: runs and configuration.
pub struct Home(pub TempDir);

/// The output of a program and its exit code.
pub struct ProgramOutput {
    pub stdout: String,
    pub stderr: String,
    pub exit_code: i32,
}

impl Home {
    pub fn new() -> Home {
        let home = Home(tempfile::tempdir().expect("a folder"));
        fs::create_dir(home.runs()).expect("a folder");
        home
    }

    pub fn runs(&self) -> PathBuf {
        self.0.path().join("runs")
    }

    pub fn write(&self, file: &str, text: impl AsRef<[u8]>) {
        let path = self.0.path().join("configuration").join(file);
        fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
        fs::write(path, text).expect("a file");
    }

    pub fn command(&self, program: &str) -> Command {
        let mut command = Command::new(program);
        command.env("NOVAMIND_RUNS", self.runs());
        command.env("NOVAMIND_CONFIG", self.0.path().join("configuration"));
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub fn program(&self) -> Command {
        self.command(env!("CARGO_BIN_EXE_novamind"))
    }

    pub fn run(&self, arguments: &[&str]) -> ProgramOutput {
        run_with_input(self.program().args(arguments), "")
    }

    pub fn play(&self, options: &[&str], lines: &str) -> ProgramOutput {
        run_with_input(self.program().args(["play", "--plain"]).args(options), lines)
    }

    /// Plays a run of two weeks, closes it, and returns its folder.
    pub fn play_two_weeks(&self) -> PathBuf {
        let lines = "set_prices A=12\nset_prices B=20\nnext naive\nset_prices C=50\nnext naive\n";
        assert_eq!(self.play(&["--days", "28"], lines).exit_code, 0);
        self.only_run()
    }

    pub fn only_run(&self) -> PathBuf {
        let entries = fs::read_dir(self.runs()).expect("a folder").flatten().map(|entry| entry.path());
        let folders: Vec<_> = entries.filter(|path| path.is_dir()).collect();
        assert_eq!(folders.len(), 1);
        folders[0].clone()
    }
}

pub fn run_with_input(command: &mut Command, lines: &str) -> ProgramOutput {
    let mut child = command.spawn().expect("the program starts");
    // Ignores errors, because a program that cannot start does not read its input.
    let _ = child.stdin.take().expect("a pipe").write_all(lines.as_bytes());
    let Output { status, stdout, stderr } = child.wait_with_output().expect("the program ends");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    ProgramOutput {
        stdout: text(stdout),
        stderr: text(stderr),
        exit_code: status.code().expect("it ends by itself"),
    }
}

impl ProgramOutput {
    /// Asserts the exit code, and that standard error is a single line that contains all `parts`.
    #[track_caller]
    pub fn assert_fails(&self, code: i32, parts: &[&str]) {
        assert_eq!(self.exit_code, code, "{}{}", self.stdout, self.stderr);
        assert!(self.stderr.starts_with("novamind: ") && self.stderr.lines().count() == 1, "{}", self.stderr);
        for part in parts {
            assert!(self.stderr.contains(part), "{part} is missing in: {}", self.stderr);
        }
    }

    #[track_caller]
    pub fn json_lines(&self) -> Vec<Value> {
        let parse = |line: &str| serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"));
        self.stdout.lines().map(parse).collect()
    }
}

pub fn run_id(folder: &Path) -> String {
    folder.file_name().expect("a name").to_string_lossy().into_owned()
}

pub fn read_bytes(folder: &Path, file: &str) -> Vec<u8> {
    fs::read(folder.join(file)).expect("bytes")
}

pub fn split_lines(bytes: &[u8]) -> Vec<Vec<u8>> {
    bytes.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect()
}
