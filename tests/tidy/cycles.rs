//! Modules of a crate that import each other in a cycle. A module is a folder or a file directly below the folder of its crate.
//! The root file of a crate (`lib.rs`, `mod.rs`) is not a module. Its exports belong to the modules that define them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

use super::{files, root};

/// Largest number of modules in an allowed cycle.
const MAX_MODULES: usize = 3;

#[test]
fn no_cycle_has_more_than_three_modules() {
    let mut found = Vec::new();
    let mut imports = 0;
    for unit in units() {
        let edges = unit.imports();
        imports += edges.values().map(BTreeSet::len).sum::<usize>();
        let large = find_cycles(&edges).into_iter().filter(|cycle| cycle.len() > MAX_MODULES);
        found.extend(large.map(|cycle| format!("{}: {}", unit.name, cycle.join(" "))));
    }
    assert!(imports > 100, "imports are found");
    assert!(found.is_empty(), "split or move a module of each cycle:\n{}", found.join("\n"));
}

/// A crate, or a module of the root crate with a folder in `src`.
struct Unit {
    name: String,
    folder: PathBuf,
    /// The names after `crate::` in the paths of the unit's modules.
    prefix: Vec<String>,
}

/// Returns each folder of `src`, and the root crate without these folders.
fn units() -> Vec<Unit> {
    let sources = root().join("src");
    let entries = fs::read_dir(&sources).expect("the sources").map(|entry| entry.expect("an entry").path());
    let mut units: Vec<Unit> = entries
        .filter(|path| path.is_dir())
        .map(|folder| {
            let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
            let prefix = if folder.join("Cargo.toml").exists() { vec![] } else { vec![name.clone()] };
            Unit { name, folder, prefix }
        })
        .collect();
    units.sort_by(|one, other| one.name.cmp(&other.name));
    units.push(Unit { name: "src".to_owned(), folder: sources, prefix: Vec::new() });
    units
}

/// A source file: its module path within the crate, and its text without tests and comments.
struct SourceFile {
    module: Vec<String>,
    text: String,
}

impl Unit {
    /// Returns the modules that each module imports.
    fn imports(&self) -> BTreeMap<String, BTreeSet<String>> {
        let files = self.source_files();
        let modules: BTreeSet<&str> =
            files.iter().filter_map(|file| file.module.first()).map(String::as_str).collect();
        let of_crate = files.iter().filter(|file| file.module.is_empty());
        let exported = of_crate.flat_map(|file| paths(&file.text)).filter(|path| path.is_export);
        let exports: BTreeMap<String, String> = exported
            .filter_map(|path| {
                let module = path.names.into_iter().find(|name| modules.contains(name.as_str()))?;
                Some((path.exported, module))
            })
            .collect();
        let mut imports: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for file in &files {
            let Some(text) = file.module.first() else { continue };
            let edges = imports.entry(text.clone()).or_default();
            for path in paths(&file.text) {
                let name = self.imported_module(&file.module, &path.names);
                let module = name.filter(|name| modules.contains(name.as_str()));
                let module = module.or_else(|| exports.get(name?));
                edges.extend(module.filter(|module| *module != text).cloned());
            }
        }
        imports
    }

    fn source_files(&self) -> Vec<SourceFile> {
        let is_root_crate = self.folder.join("lib.rs").exists() && self.prefix.is_empty();
        let elsewhere = |path: &PathBuf| {
            let folders = path.ancestors().skip(1).take_while(|folder| **folder != self.folder);
            is_root_crate && folders.into_iter().any(|folder| folder.join("Cargo.toml").exists())
        };
        let mut all = Vec::new();
        let mut for_tests = BTreeSet::new();
        for path in files(&self.folder, "rs").into_iter().filter(|path| !elsewhere(path)) {
            let below = path.strip_prefix(&self.folder).expect("below the crate");
            let mut module: Vec<String> =
                below.iter().map(|name| name.to_string_lossy().replace(".rs", "")).collect();
            if ["mod", "lib", "main"].contains(&module.last().expect("a name").as_str()) {
                module.pop();
            }
            let (text, tests) = without_tests(&fs::read_to_string(&path).expect("a source"));
            for_tests.extend(tests.into_iter().map(|name| [module.as_slice(), &[name]].concat()));
            all.push(SourceFile { module, text });
        }
        let is_test = |file: &SourceFile| for_tests.iter().any(|test| file.module.starts_with(test));
        all.retain(|file| !is_test(file));
        all
    }

    /// Returns the top-level module that a path in module `from` refers to, or `None` if the path refers to something
    /// outside the crate.
    fn imported_module<'a>(&self, from: &[String], path: &'a [String]) -> Option<&'a String> {
        let up = path.iter().take_while(|name| *name == "super").count();
        let rest = if path.first()? == "crate" {
            path[1..].strip_prefix(self.prefix.as_slice())?
        } else {
            &path[up..]
        };
        (path[0] == "crate" || up == from.len()).then(|| rest.first())?
    }
}

/// Removes comments and items with `#[cfg(test)]` from a text. Also returns the removed modules.
fn without_tests(text: &str) -> (String, Vec<String>) {
    let (mut kept, mut modules) = (String::new(), Vec::new());
    let mut lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    while let Some(line) = lines.next() {
        if line.trim() != "#[cfg(test)]" {
            kept += line;
            kept += "\n";
            continue;
        }
        let indent = line.len() - line.trim_start().len();
        for line in lines.by_ref() {
            let declared = line.trim().split_once("mod ").and_then(|(_, rest)| rest.strip_suffix(';'));
            modules.extend(declared.map(str::to_owned));
            if line.len() - line.trim_start().len() == indent && line.ends_with([';', '}']) {
                break;
            }
        }
    }
    (kept, modules)
}

/// A path in a source text, split into its names: `crate::figures::WeekResult`.
struct ImportedPath {
    names: Vec<String>,
    /// The name under which the path is exported.
    exported: String,
    /// Whether the path is in a `pub use`.
    is_export: bool,
}

/// Returns every path in a source text. The paths of `use a::{b, c}` are returned separately.
fn paths(text: &str) -> impl Iterator<Item = ImportedPath> {
    let mut all = Vec::new();
    let mut end = 0;
    for (at, _) in text.match_indices("::") {
        let begin = text[..at].rfind(|sign: char| !is_name_character(sign)).map_or(0, |before| before + 1);
        let line = text[..begin].rsplit('\n').next().unwrap_or_default().trim_start();
        if begin < end || begin == at || line.ends_with("(in ") {
            continue;
        }
        let is_export = line.starts_with("pub") && line.ends_with("use ");
        end = begin + parse_use_tree(&text[begin..], &[], is_export, &mut all);
    }
    all.into_iter()
}

fn is_name_character(sign: char) -> bool {
    sign.is_alphanumeric() || sign == '_'
}

/// Parses a `use` tree, adds its paths to `all`, and returns the length of the tree.
fn parse_use_tree(text: &str, prefix: &[String], is_export: bool, all: &mut Vec<ImportedPath>) -> usize {
    let mut names = prefix.to_vec();
    let mut at = 0;
    loop {
        at += text[at..].len() - text[at..].trim_start().len();
        let rest = &text[at..];
        if rest.starts_with('{') {
            at += 1;
            while !text[at..].trim_start().starts_with('}') && at < text.len() {
                at += parse_use_tree(&text[at..], &names, is_export, all).max(1);
                at += text[at..].find([',', '}']).unwrap_or(0);
                at += usize::from(text[at..].starts_with(','));
            }
            return at + text[at..].find('}').map_or(0, |end| end + 1);
        }
        let length = rest.find(|sign: char| !is_name_character(sign)).unwrap_or(rest.len());
        names.push(rest[..length].to_owned());
        at += length;
        if length == 0 || !text[at..].starts_with("::") {
            break;
        }
        at += 2;
    }
    let alias = text[at..]
        .trim_start()
        .strip_prefix("as ")
        .and_then(|rest| Some(rest.split(|sign: char| !is_name_character(sign)).next()?.to_owned()));
    names.retain(|name| !name.is_empty());
    let last = names.iter().rfind(|name| *name != "self").cloned();
    all.push(ImportedPath { exported: alias.or(last).unwrap_or_default(), names, is_export });
    at
}

/// Returns the groups of modules that import each other directly or indirectly.
fn find_cycles(imports: &BTreeMap<String, BTreeSet<String>>) -> Vec<Vec<String>> {
    let mut reach = imports.clone();
    loop {
        let further = |reached: &BTreeSet<String>| -> BTreeSet<String> {
            let next = reached.iter().filter_map(|module| reach.get(module)).flatten();
            next.chain(reached).cloned().collect()
        };
        let more: BTreeMap<String, BTreeSet<String>> =
            reach.iter().map(|(module, reached)| (module.clone(), further(reached))).collect();
        if more == reach {
            break;
        }
        reach = more;
    }
    let in_cycles = reach.iter().filter(|(module, reached)| reached.contains(*module));
    let cycle = |(module, reached): (&String, &BTreeSet<String>)| -> Vec<String> {
        reached
            .iter()
            .filter(|other| reach.get(*other).is_some_and(|back| back.contains(module)))
            .cloned()
            .collect()
    };
    in_cycles.map(cycle).collect::<BTreeSet<_>>().into_iter().collect()
}

#[test]
fn paths_include_nested_imports() {
    let text = "pub(in crate::a) fn f() {}\npub use b::{C, d::{self, E as F}};\nuse super::g::H;\nlet i = crate::j::k(l::<m>);";
    let read: Vec<(String, String, bool)> =
        paths(text).map(|path| (path.names.join("::"), path.exported, path.is_export)).collect();
    let path = |names: &str, exported: &str, is_export| (names.to_owned(), exported.to_owned(), is_export);
    assert_eq!(
        read,
        [
            path("b::C", "C", true),
            path("b::d::self", "d", true),
            path("b::d::E", "F", true),
            path("super::g::H", "H", false),
            path("crate::j::k", "k", false),
            path("l", "l", false),
        ]
    );
    let (kept, modules) = without_tests(
        "use a::B;\n#[cfg(test)]\nmod c;\nfn d() {}\n#[cfg(test)]\nmod tests {\n    use e::F;\n}\nfn g() {}\n",
    );
    assert_eq!((kept.as_str(), modules), ("use a::B;\nfn d() {}\nfn g() {}\n", vec!["c".to_owned()]));
}

#[test]
fn find_cycles_finds_strongly_connected_modules() {
    let edges = [("a", vec!["b"]), ("b", vec!["c"]), ("c", vec!["a", "d"]), ("d", vec![])];
    let of = |(from, to): (&str, Vec<&str>)| (from.to_owned(), to.into_iter().map(str::to_owned).collect());
    assert_eq!(find_cycles(&edges.into_iter().map(of).collect()), [["a", "b", "c"]]);
}
