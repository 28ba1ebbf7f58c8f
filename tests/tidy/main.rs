//! Rules for the sources. Crates import only the crates that the architecture lists, import cycles have at most three
//! modules, and no code is marked as unfinished. The simulator uses no clock and no random iteration order, and
//! bundled configuration files are valid.

mod cycles;
mod documents;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The path of a source file, and its lines without the test module.
struct Source {
    path: PathBuf,
    lines: Vec<String>,
}

impl Source {
    fn read(path: PathBuf) -> Source {
        let text = fs::read_to_string(&path).expect("a source file");
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let tests = lines.windows(2).position(|pair| pair[0] == "#[cfg(test)]" && pair[1] == "mod tests {");
        Source { lines: lines[..tests.unwrap_or(lines.len())].to_vec(), path }
    }

    /// Returns the lines that are not comments, with their numbers.
    fn code(&self) -> impl Iterator<Item = (usize, &str)> {
        let numbered = self.lines.iter().enumerate().map(|(at, line)| (at + 1, line.as_str()));
        numbered.filter(|(_, line)| !line.trim_start().starts_with("//"))
    }

    /// Returns the name of the first folder or file below `src` in the path.
    fn unit_name(&self) -> String {
        let below = self.path.strip_prefix(root().join("src")).expect("below src");
        let first = below.components().next().expect("a name").as_os_str().to_string_lossy();
        first.trim_end_matches(".rs").to_owned()
    }

    fn is_tests(&self) -> bool {
        self.path.file_name().is_some_and(|name| name == "tests.rs" || name == "test_kit.rs")
    }

    /// Returns a message for every line of code that a rule forbids.
    fn rule_violations(&self, forbidden: impl Fn(&str) -> Option<String>) -> Vec<String> {
        let complaint = |(number, line): (usize, &str)| {
            forbidden(line).map(|why| format!("{}:{number}: {why}", self.path.display()))
        };
        self.code().filter_map(complaint).collect()
    }
}

/// Returns the folder of the workspace, which is two levels above the package `base`. Cargo sets the folder of the
/// package when the test is built and run.
fn root() -> PathBuf {
    let package =
        std::env::var_os("CARGO_MANIFEST_DIR").map_or(env!("CARGO_MANIFEST_DIR").into(), PathBuf::from);
    package.ancestors().nth(2).expect("the folder of the workspace").to_owned()
}

fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|it| it == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn sources() -> Vec<Source> {
    files(&root().join("src"), "rs").into_iter().map(Source::read).filter(|file| !file.is_tests()).collect()
}

fn test_sources() -> Vec<Source> {
    files(&root().join("tests"), "rs").into_iter().map(Source::read).collect()
}

#[track_caller]
fn assert_none(complaints: &[String]) {
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

#[test]
fn build_script_watches_every_embedded_folder() {
    let script = fs::read_to_string(root().join("src/assets/build.rs")).expect("a build script");
    let sources = sources();
    let macros: Vec<&str> = sources
        .iter()
        .flat_map(Source::code)
        .filter_map(|(_, line)| Some(line.split_once("include_dir!(\"$CARGO_MANIFEST_DIR/../../")?.1))
        .collect();
    assert!(macros.len() > 5, "macros are found");
    let folders = macros.iter().filter_map(|path| path.split('/').next());
    let unwatched = folders.filter(|folder| !script.contains(&format!("\"{folder}\"")));
    assert_none(
        &unwatched.map(|folder| format!("build.rs does not watch {folder}")).collect::<Vec<String>>(),
    );
}

/// The compiler reports unused private items, but not public items that no other package uses.
#[test]
fn public_items_are_used() {
    let files = sources();
    let test_files = test_sources();
    let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
    let lines = files.iter().chain(&test_files).flat_map(Source::code);
    for word in
        lines.flat_map(|(_, line)| line.split(|letter: char| !letter.is_alphanumeric() && letter != '_'))
    {
        *uses.entry(word).or_default() += 1;
    }
    let kinds = ["fn ", "struct ", "enum ", "const ", "static ", "trait ", "type "];
    let mut complaints = Vec::new();
    for file in &files {
        for (number, line) in file.code() {
            let for_tests = number > 1
                && file.lines[number - 2].trim().starts_with("#[cfg(")
                && file.lines[number - 2].contains("test");
            let item = line.trim_start().strip_prefix("pub ").filter(|_| !for_tests);
            let name = item.and_then(|item| kinds.iter().find_map(|kind| item.strip_prefix(kind)));
            let name = name.and_then(|name| name.split(|it: char| !it.is_alphanumeric() && it != '_').next());
            if name.is_some_and(|name| uses.get(name) == Some(&1)) {
                complaints.push(format!("{}:{number}: {line}", file.path.display()));
            }
        }
    }
    assert_none(&complaints);
}

#[test]
fn no_code_is_marked_as_unfinished() {
    let words = ["todo!", "unimplemented!", "dbg!", "#[ignore", "FIXME", "XXX"];
    let complaint =
        |line: &str| words.iter().find(|word| line.contains(**word)).map(|word| (*word).to_owned());
    let complaints: Vec<String> = sources().iter().flat_map(|file| file.rule_violations(complaint)).collect();
    assert_none(&complaints);
}

/// Returns the dependencies of each crate of the workspace, from the manifests.
fn dependencies() -> BTreeMap<String, Vec<String>> {
    let folders =
        fs::read_dir(root().join("src")).expect("the sources").map(|entry| entry.expect("an entry").path());
    let crates = folders.filter(|folder| folder.join("Cargo.toml").exists()).map(|folder| {
        let text = fs::read_to_string(folder.join("Cargo.toml")).expect("a manifest");
        let manifest: toml::Table = text.parse().expect("a manifest in TOML");
        let named = manifest["dependencies"].as_table().expect("dependencies").keys();
        let texts = named.filter_map(|name| Some(name.strip_prefix("novamind-")?.to_owned())).collect();
        (folder.file_name().expect("a name").to_string_lossy().into_owned(), texts)
    });
    crates.collect()
}

#[test]
fn architecture_document_lists_the_dependencies_of_each_crate() {
    let page = fs::read_to_string(root().join("docs/architecture.md")).expect("the page");
    let rows = page.lines().filter_map(|line| {
        let cells: Vec<&str> = line.strip_prefix("| `")?.split('|').map(str::trim).collect();
        let name = cells[0].strip_suffix('`').filter(|name| !name.contains('/'))?;
        let named = cells[1].split(", ").filter(|word| *word != "–").map(str::to_owned).collect();
        Some((name.to_owned(), named))
    });
    assert_eq!(
        rows.collect::<BTreeMap<String, Vec<String>>>(),
        dependencies(),
        "left: the page, right: the manifests"
    );
}

#[test]
fn simulator_uses_no_clock_files_or_unordered_maps() {
    let words = [
        "HashMap",
        "HashSet",
        "RandomState",
        "Instant",
        "SystemTime",
        "std::fs",
        "std::env",
        "std::net",
        "println!",
        "eprintln!",
        "thread_rng",
        "rusqlite",
    ];
    let complaint =
        |line: &str| words.iter().find(|word| line.contains(**word)).map(|word| (*word).to_owned());
    let restricted_sources =
        sources().into_iter().filter(|file| matches!(file.unit_name().as_str(), "world" | "voice" | "tools"));
    let complaints: Vec<String> =
        restricted_sources.flat_map(|file| file.rule_violations(complaint)).collect();
    assert_none(&complaints);
}

/// Re-simulation shows hidden state, so only the crate that checks the permission may import the engine.
#[test]
fn only_insight_imports_the_session_engine() {
    // The session crate itself, and the crates that the session crate imports.
    const CRATES_WITHOUT_SESSION: [&str; 8] =
        ["assets", "base", "database", "record", "session", "tools", "voice", "world"];
    let complaint = |line: &str| {
        let listed = ["session::engine", "{engine", ", engine"].iter().any(|path| line.contains(path));
        let imports =
            listed || ["engine::", "engine,"].iter().any(|path| line.trim_start().starts_with(path));
        imports.then(|| "it imports the engine of sessions".to_owned())
    };
    let (insight, others): (Vec<Source>, Vec<Source>) = sources()
        .into_iter()
        .filter(|file| !CRATES_WITHOUT_SESSION.contains(&file.unit_name().as_str()))
        .partition(|file| file.unit_name() == "insight");
    assert!(insight.iter().any(|file| !file.rule_violations(complaint).is_empty()), "imports are found");
    assert_none(&others.iter().flat_map(|file| file.rule_violations(complaint)).collect::<Vec<String>>());
}

#[test]
fn only_the_command_line_prints() {
    let complaint = |line: &str| {
        let prints = ["println!", "print!("].iter().any(|word| line.contains(word));
        prints.then(|| "it prints".to_owned())
    };
    let quiet = sources().into_iter().filter(|file| {
        !matches!(file.unit_name().as_str(), "cli" | "plain" | "main")
            && !file.path.ends_with("build.rs")
            && !file.path.ends_with("tui/terminal.rs")
    });
    let complaints: Vec<String> = quiet.flat_map(|file| file.rule_violations(complaint)).collect();
    assert_none(&complaints);
}

#[test]
fn bundled_toml_files_parse() {
    for folder in ["configs", "assets"] {
        for path in files(&root().join(folder), "toml") {
            let text = fs::read_to_string(&path).expect("a file");
            if let Err(problem) = text.parse::<toml::Table>() {
                panic!("{}: {problem}", path.display());
            }
        }
    }
}
