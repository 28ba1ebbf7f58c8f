//! Forged records, in which every checksum that can be recomputed was recomputed.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use novamind::session::Seal;
use serde_json::{Map, Value};

use crate::support::home::{Home, ProgramOutput, run_id};

/// The lines of a trajectory as objects.
type TrajectoryLines = Vec<Map<String, Value>>;

fn read_lines(text: &str) -> TrajectoryLines {
    text.lines().map(|line| serde_json::from_str(line).expect("a line")).collect()
}

fn line_digest(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex().to_string()
}

/// Returns the text of a line with a matching checksum.
fn line_with_checksum(mut line: Map<String, Value>) -> String {
    line.shift_remove("sum");
    let sum = line_digest(&Value::Object(line.clone()).to_string())[..16].to_owned();
    line.insert("sum".to_owned(), sum.into());
    Value::Object(line).to_string()
}

/// Returns the text of a trajectory with recomputed checksums and, if `chained` is set, with a recomputed hash chain.
fn trajectory_text(lines: TrajectoryLines, chained: bool) -> String {
    let mut text = String::new();
    let mut before = line_digest("");
    for mut line in lines {
        if chained {
            line.insert("prev".to_owned(), before.into());
        }
        let line = line_with_checksum(line);
        before = line_digest(&line);
        text += &(line + "\n");
    }
    text
}

/// Changes the price of the second week. Returns the index of the changed line.
fn change_price(lines: &mut TrajectoryLines) -> usize {
    let is_it = |line: &Map<String, Value>| line.get("args").is_some_and(|args| args["C"] == 50);
    let at = lines.iter().position(is_it).expect("the call of the second week");
    lines[at]["args"]["C"] = 49.into();
    at
}

/// An unpacked archive: its files, and a seal that can be recomputed.
struct OpenedArchive {
    files: BTreeMap<String, Vec<u8>>,
    seal: Seal,
}

impl OpenedArchive {
    fn export(home: &Home, run: &Path) -> OpenedArchive {
        let archive = home.0.path().join("run.tar");
        let program_output = home.run(&["runs", "export", &run_id(run), "--out", &archive.to_string_lossy()]);
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
        let mut files = BTreeMap::new();
        for entry in tar::Archive::new(fs::File::open(&archive).expect("a file")).entries().expect("entries")
        {
            let mut entry = entry.expect("an entry");
            let name =
                entry.path().expect("a path").file_name().expect("a name").to_string_lossy().into_owned();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).expect("bytes");
            files.insert(name, bytes);
        }
        let seal = files.remove("seal.toml").expect("a seal");
        let seal = toml::from_str(&String::from_utf8(seal).expect("text")).expect("a seal");
        OpenedArchive { files, seal }
    }

    fn file_text(&self, file: &str) -> String {
        String::from_utf8(self.files[file].clone()).expect("text")
    }

    /// Replaces a file and recomputes the seal.
    fn replace_file(&mut self, file: &str, text: String) {
        if file == "trajectory.jsonl" {
            self.seal.last_hash = line_digest(text.lines().last().expect("lines"));
        }
        let sealed_file = self.seal.file.iter_mut().find(|entry| entry.name == file).expect("it is sealed");
        (sealed_file.bytes, sealed_file.blake3) = (text.len() as u64, line_digest(&text));
        self.files.insert(file.to_owned(), text.into_bytes());
        self.seal = self.seal.clone().with_checksum();
    }

    fn import(&self, home: &Home) -> ProgramOutput {
        let archive = home.0.path().join("forged.tar");
        let mut builder = tar::Builder::new(fs::File::create(&archive).expect("a file"));
        let seal = ("seal.toml".to_owned(), self.seal.to_toml().into_bytes());
        for (name, bytes) in self.files.clone().into_iter().chain([seal]) {
            let mut header = tar::Header::new_ustar();
            header.set_size(bytes.len() as u64);
            header.set_mode(0o644);
            builder
                .append_data(&mut header, format!("{}/{name}", self.seal.run), &bytes[..])
                .expect("an entry");
        }
        builder.finish().expect("an archive");
        home.run(&["runs", "import", &archive.to_string_lossy()])
    }
}

fn two_weeks() -> (Home, PathBuf) {
    let home = Home::new();
    let run = home.play_two_weeks();
    (home, run)
}

#[test]
fn edited_line_breaks_the_hash_chain() {
    let (home, run) = two_weeks();
    let path = run.join("trajectory.jsonl");
    let mut lines = read_lines(&fs::read_to_string(&path).expect("text"));
    let at = change_price(&mut lines);
    fs::write(&path, trajectory_text(lines, false)).expect("written");
    let next = format!("line {}", at + 2);
    home.run(&["replay", &run_id(&run), "--verify"])
        .assert_fails(3, &[&next, "does not have the hash of the previous line"]);
}

#[test]
fn rechained_trajectory_does_not_verify() {
    let (home, run) = two_weeks();
    let path = run.join("trajectory.jsonl");
    let mut lines = read_lines(&fs::read_to_string(&path).expect("text"));
    change_price(&mut lines);
    fs::write(&path, trajectory_text(lines, true)).expect("written");
    // The database would reveal the change. Without the database, the re-simulated states must reveal it.
    fs::remove_file(run.join("world.db")).expect("it is there");
    fs::remove_file(run.join("snapshot.bin")).unwrap_or_default();
    let program_output = home.run(&["replay", &run_id(&run), "--verify"]);
    program_output.assert_fails(3, &["different"]);
}

#[test]
fn resealed_archive_is_still_verified() {
    let (home, run) = two_weeks();
    let other = Home::new();
    let opened_archive = OpenedArchive::export(&home, &run);
    let opened = || OpenedArchive { files: opened_archive.files.clone(), seal: opened_archive.seal.clone() };
    assert_eq!(opened_archive.import(&other).exit_code, 0, "a fitting seal is accepted");
    fs::remove_dir_all(other.runs().join(run_id(&run))).expect("it was there");

    let mut forged = opened();
    let mut lines = read_lines(&forged.file_text("trajectory.jsonl"));
    change_price(&mut lines);
    forged.replace_file("trajectory.jsonl", trajectory_text(lines, false));
    forged
        .import(&other)
        .assert_fails(3, &["trajectory.jsonl", "does not have the hash of the previous line"]);

    let mut forged = opened();
    let seed = forged
        .file_text("run.toml")
        .lines()
        .find(|line| line.starts_with("seed"))
        .expect("a seed")
        .to_owned();
    let manifest = forged.file_text("run.toml").replace(&seed, "seed = 8");
    forged.replace_file("run.toml", manifest);
    let program_output = forged.import(&other);
    assert_eq!(
        program_output.exit_code, 3,
        "another seed than the first line names: {}{}",
        program_output.stdout, program_output.stderr
    );

    // If every hash is recomputed, only the recorded states reveal the change.
    let mut forged = opened();
    let mut lines = read_lines(&forged.file_text("trajectory.jsonl"));
    change_price(&mut lines);
    forged.replace_file("trajectory.jsonl", trajectory_text(lines, true));
    assert_eq!(forged.import(&other).exit_code, 0);
    other.run(&["replay", &run_id(&run), "--verify"]).assert_fails(3, &["different"]);
}
