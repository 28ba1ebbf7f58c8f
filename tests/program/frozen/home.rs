//! The home in which cases run, with the recorded runs of format 2.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::Command;

use super::case::Case;
use super::masks::Masks;
use super::{root, stored_form};
use crate::support::home::{Home, ProgramOutput, run_with_input};

/// A home with the recorded runs of format 2, their study and classes, and a damaged copy.
pub struct FrozenHome {
    pub home: Home,
    /// IDs of the recorded runs by the name of their folder, without `format2-`.
    ids: BTreeMap<String, String>,
    pub masks: Masks,
}

impl FrozenHome {
    pub fn new() -> FrozenHome {
        let home = Home::new();
        let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/recorded");
        let mut masks = Masks::new(home.0.path());
        let mut ids = BTreeMap::new();
        for folder in sorted_paths(&recorded) {
            let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
            let Some(name) = name.strip_prefix("format2-") else { continue };
            let manifest: toml::Table = text(&folder.join("run.toml")).parse().expect("a manifest");
            let id = manifest["id"].as_str().expect("an id").to_owned();
            let belongs = ["study", "handout"].iter().any(|key| manifest.contains_key(*key));
            let parent = match manifest.get("participant").and_then(toml::Value::as_str) {
                Some(label) if belongs => home.runs().join("participants").join(label),
                _ => home.runs(),
            };
            copy_masked(&folder, &parent.join(&id), &mut masks);
            masks.exclude_id(&id);
            ids.insert(name.to_owned(), id);
        }
        let damaged = home.0.path().join("damaged").join(&ids["debug"]);
        copy_masked(&recorded.join("format2-debug"), &damaged, &mut masks);
        damage_last_week(&damaged.join("trajectory.jsonl"));
        let input = root().join("input");
        copy_masked(&input, home.0.path(), &mut masks);
        fs::rename(home.0.path().join("visits.jsonl"), home.runs().join("visits.jsonl")).expect("moved");
        FrozenHome { home, ids, masks }
    }

    /// Returns the ID of the recorded run `format2-NAME`.
    pub fn id(&self, name: &str) -> &str {
        &self.ids[name]
    }

    /// Runs a case and returns its output and the files that it wrote, with masks.
    pub fn case_output(&mut self, case: &Case) -> String {
        let place = self.home.0.path().to_owned();
        let fill = |argument: String| {
            let filled =
                self.ids.iter().fold(argument, |text, (name, id)| text.replace(&format!("{{{name}}}"), id));
            filled.replace("{home}", &place.display().to_string())
        };
        let arguments: Vec<String> = case.arguments().into_iter().map(fill).collect();
        let mut command = self.home.program();
        command.current_dir(&place).args(arguments).env("TZ", "UTC");
        for variable in
            ["COLUMNS", "LINES", "NO_COLOR", "NOVAMIND_PARTICIPANT", "NOVAMIND_STUDY", "NOVAMIND_CODE"]
        {
            command.env_remove(variable);
        }
        let program_output = if case.in_turn {
            run_line_by_line(&mut command, &case.input)
        } else {
            run_with_input(&mut command, &case.input)
        };
        self.masks.keys = case.mask.clone();
        self.masks.mask_new_ids(&self.home.runs());
        for file in &case.files {
            self.masks.mask_class_ids(&place.join(file).join("class.toml"));
            self.masks.mask_new_ids(&place.join(file));
        }
        let mut output = stored_form(self.masks.apply(&program_output.stdout));
        if !program_output.stderr.is_empty() {
            write!(output, "--- standard error\n{}", self.masks.apply(&program_output.stderr))
                .expect("a text");
        }
        if program_output.exit_code != 0 {
            writeln!(output, "--- exit code {}", program_output.exit_code).expect("a text");
        }
        for file in &case.files {
            self.write_file(&place.join(file), &mut output);
        }
        output
    }

    /// Appends the contents of a file, a folder or an archive to `output`.
    fn write_file(&mut self, path: &Path, output: &mut String) {
        if path.is_dir() {
            // New runs have random IDs, so files are sorted by their masked names.
            let mut inner = sorted_paths(path);
            inner.sort_by_key(|path| self.masks.apply(&path.display().to_string()));
            for path in inner {
                self.write_file(&path, output);
            }
            return;
        }
        let name = path.strip_prefix(self.home.0.path()).unwrap_or(path).display().to_string();
        let Ok(bytes) = fs::read(path) else {
            writeln!(output, "--- {}: missing", self.masks.apply(&name)).expect("a text");
            return;
        };
        match name.ends_with(".tar") {
            true => {
                for entry in tar::Archive::new(&bytes[..]).entries().expect("members") {
                    let mut entry = entry.expect("a member");
                    let member = entry.path().expect("a name").display().to_string();
                    let mut bytes = Vec::new();
                    entry.read_to_end(&mut bytes).expect("bytes");
                    self.write_bytes(&format!("{name}: {member}"), &bytes, output);
                }
            }
            false => self.write_bytes(&name, &bytes, output),
        }
    }

    fn write_bytes(&mut self, name: &str, bytes: &[u8], output: &mut String) {
        let name = self.masks.apply(name);
        let text = match (is_content_ignored(&name), String::from_utf8(bytes.to_vec())) {
            (false, Ok(text)) => stored_form(self.masks.apply(&text)),
            _ => "(bytes)\n".to_owned(),
        };
        let end = if text.ends_with('\n') || text.is_empty() { "" } else { "\n(no line end)\n" };
        write!(output, "--- {name}\n{text}{end}").expect("a text");
    }
}

/// Sends each line after the answer to the previous line, and returns the output of the program. Notifications have no answer.
fn run_line_by_line(command: &mut Command, lines: &str) -> ProgramOutput {
    let mut child = command.spawn().expect("the program starts");
    let mut input = child.stdin.take().expect("a pipe");
    let mut output = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut out = String::new();
    for line in lines.lines() {
        writeln!(input, "{line}").expect("sent");
        if !line.contains("\"method\": \"notifications/") {
            output.read_line(&mut out).expect("an answer");
        }
    }
    drop(input);
    output.read_to_string(&mut out).expect("text");
    let ended = child.wait_with_output().expect("the program ends");
    let err = String::from_utf8(ended.stderr).expect("UTF-8");
    ProgramOutput { stdout: out, stderr: err, exit_code: ended.status.code().expect("it ends on its own") }
}

/// Returns whether the contents of a file are not compared: the database, the snapshot, and the lock with a process ID.
fn is_content_ignored(name: &str) -> bool {
    ["world.db", "snapshot.bin", "lock"].iter().any(|end| name.ends_with(end))
}

/// Returns the paths in a folder, sorted by name.
fn sorted_paths(folder: &Path) -> Vec<PathBuf> {
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).expect("a text")
}

/// Changes a figure in the last week of a record.
fn damage_last_week(trajectory: &Path) {
    let whole = text(trajectory);
    let at = whole.rfind("\"cash\":").expect("a figure") + "\"cash\":".len();
    fs::write(trajectory, format!("{}1{}", &whole[..at], &whole[at..])).expect("written");
}

/// Copies a folder. Times in its files are excluded from masking.
fn copy_masked(from: &Path, to: &Path, masks: &mut Masks) {
    fs::create_dir_all(to).expect("a folder");
    for path in sorted_paths(from) {
        let target = to.join(path.file_name().expect("a name"));
        if path.is_dir() {
            copy_masked(&path, &target, masks);
            continue;
        }
        masks.exclude_times(&text(&path));
        fs::copy(&path, target).expect("copied");
    }
}
