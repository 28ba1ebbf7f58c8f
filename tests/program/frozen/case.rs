//! The cases of a group: command lines with their input and their output files.

use std::fs;

use serde::Deserialize;

use super::root;

/// A command line whose output is frozen.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// Name of the file that contains the expected output.
    pub name: String,
    /// Arguments of the program, separated by spaces. `'…'` keeps spaces. `{NAME}` is the ID of the recorded run
    /// `format2-NAME`, and `{home}` is the working directory.
    pub run: String,
    /// Text that the program reads from standard input.
    #[serde(default)]
    pub input: String,
    /// Whether each input line is sent after the answer to the previous one, because a server may answer out of order.
    #[serde(default)]
    pub in_turn: bool,
    /// Files and folders that the command writes, relative to the working directory. Tar archives are listed with
    /// their members.
    #[serde(default)]
    pub files: Vec<String>,
    /// Keys in JSON and TOML whose values differ in every execution.
    #[serde(default)]
    pub mask: Vec<String>,
}

#[derive(Deserialize)]
struct Group {
    case: Vec<Case>,
}

impl Case {
    /// Returns the arguments of the command line.
    pub fn arguments(&self) -> Vec<String> {
        let quoted = self.run.split('\'').enumerate();
        let (mut arguments, mut open) = (Vec::new(), None::<String>);
        for (at, part) in quoted {
            if at % 2 == 1 {
                open.get_or_insert_default().push_str(part);
                continue;
            }
            for (word_at, word) in part.split(' ').enumerate() {
                if word_at > 0 {
                    arguments.extend(open.take());
                }
                if !word.is_empty() {
                    open.get_or_insert_default().push_str(word);
                }
            }
        }
        arguments.extend(open);
        arguments
    }
}

/// Returns the cases of a group.
pub fn cases(group: &str) -> Vec<Case> {
    let path = root().join("cases").join(format!("{group}.toml"));
    let text = fs::read_to_string(&path).expect("cases");
    let group: Group = toml::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    group.case
}

/// Returns the names of all groups.
pub fn groups() -> Vec<String> {
    let files = fs::read_dir(root().join("cases")).expect("a folder").flatten();
    files.map(|file| file.path().file_stem().expect("a name").to_string_lossy().into_owned()).collect()
}
