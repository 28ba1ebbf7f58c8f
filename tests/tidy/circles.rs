//! No circle of imports holds more than three files: whoever opens one can read it without the rest of its house.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::{files, root};

/// A module by its path below `src`.
type Module = Vec<String>;

/// Files of a circle at most.
const LARGEST: usize = 3;

#[test]
fn no_circle_of_imports_holds_more_than_three_files() {
    let imports = imports(&root().join("src"));
    assert!(imports.values().map(BTreeSet::len).sum::<usize>() > 500, "imports are read");
    let large: Vec<String> = circles(&imports)
        .into_iter()
        .filter(|circle| circle.len() > LARGEST)
        .map(|circle| circle.iter().map(|module| module.join("::")).collect::<Vec<_>>().join(", "))
        .collect();
    assert!(large.is_empty(), "these import each other in a circle:\n{}", large.join("\n"));
}

/// What each module imports of the others.
fn imports(sources: &Path) -> BTreeMap<Module, BTreeSet<Module>> {
    let is_test = |name: &str| name.ends_with("tests") || name == "test_kit" || name == "stories";
    let read = |path: &Path| {
        let module = module_of(path.strip_prefix(sources).ok()?);
        let text = fs::read_to_string(path).expect("a source");
        (!module.iter().any(|name| is_test(name))).then_some((module, text))
    };
    let texts: BTreeMap<Module, String> = files(sources, "rs").iter().filter_map(|path| read(path)).collect();
    let known: BTreeSet<&Module> = texts.keys().collect();
    let of = |(module, text): (&Module, &String)| {
        let used = paths(text).into_iter().filter_map(|path| target(module, &path, &known));
        (module.clone(), used.filter(|used| used != module).collect())
    };
    texts.iter().map(of).collect()
}

/// `console/app/news.rs` is `console::app::news`, `console/mod.rs` is `console`.
fn module_of(path: &Path) -> Module {
    let mut names: Module = path.iter().map(|name| name.to_string_lossy().replace(".rs", "")).collect();
    if names.last().is_some_and(|name| ["mod", "lib"].contains(&name.as_str())) {
        names.pop();
    }
    names
}

/// The paths that a file imports, outside its tests.
fn paths(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap_or_default();
    let mut all = Vec::new();
    for statement in text.split(';') {
        let Some(at) = statement.rfind("use ").filter(|at| is_import(&statement[..*at])) else { continue };
        flatten("", &statement[at + 4..].replace(char::is_whitespace, ""), &mut all);
    }
    all
}

/// Whether a `use` begins here. A façade that hands on what its rooms hold (`pub use`) imports nothing.
fn is_import(before: &str) -> bool {
    let line = before.rsplit('\n').next().unwrap_or_default().trim();
    line.is_empty() || line.starts_with("pub(")
}

/// `a::{b, c::d}` is `a::b` and `a::c::d`.
fn flatten(prefix: &str, tree: &str, all: &mut Vec<String>) {
    let Some((head, rest)) = tree.split_once('{') else {
        all.push(format!("{prefix}{tree}"));
        return;
    };
    let inner = rest.strip_suffix('}').unwrap_or(rest);
    let (mut depth, mut begin) = (0, 0);
    for (at, sign) in inner.char_indices().chain([(inner.len(), ',')]) {
        match sign {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                flatten(&format!("{prefix}{head}"), &inner[begin..at], all);
                begin = at + 1;
            }
            _ => {}
        }
    }
}

/// The module that a path leads to; none outside the project.
fn target(from: &Module, path: &str, known: &BTreeSet<&Module>) -> Option<Module> {
    let mut names = path.split("::").peekable();
    let mut base = match names.peek().copied()? {
        // The simulator is a package of its own.
        "crate" => from.first().filter(|house| *house == "world").into_iter().cloned().collect(),
        "self" | "super" => from.clone(),
        child if known.contains(&[from.as_slice(), &[child.to_owned()]].concat()) => from.clone(),
        _ => return None,
    };
    for name in names {
        match name {
            "crate" | "self" => {}
            "super" => drop(base.pop()),
            name => {
                base.push(name.to_owned());
                if !known.contains(&base) {
                    base.pop();
                    break;
                }
            }
        }
    }
    known.contains(&base).then_some(base)
}

/// Modules that reach each other, by their strongly connected components.
fn circles(imports: &BTreeMap<Module, BTreeSet<Module>>) -> Vec<Vec<&Module>> {
    let reached = |from: &Module| -> BTreeSet<Module> {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = next.pop() {
            for used in &imports[&module] {
                if imports.contains_key(used) && seen.insert(used.clone()) {
                    next.push(used.clone());
                }
            }
        }
        seen
    };
    let reach: BTreeMap<&Module, BTreeSet<Module>> =
        imports.keys().map(|module| (module, reached(module))).collect();
    let mut found: Vec<Vec<&Module>> = Vec::new();
    for module in imports.keys().filter(|module| reach[module].contains(*module)) {
        if !found.iter().any(|circle| circle.contains(&module)) {
            let mutual = |other: &&Module| reach[module].contains(*other) && reach[other].contains(module);
            found.push(imports.keys().filter(mutual).collect());
        }
    }
    found
}

#[test]
fn circles_are_found_where_they_are() {
    let module = |name: &str| vec![name.to_owned()];
    let edges = [("a", vec!["b"]), ("b", vec!["c"]), ("c", vec!["a", "d"]), ("d", vec![])];
    let imports: BTreeMap<Module, BTreeSet<Module>> =
        edges.iter().map(|(from, to)| (module(from), to.iter().map(|to| module(to)).collect())).collect();
    assert_eq!(circles(&imports), [[&module("a"), &module("b"), &module("c")]]);
    let mut all = Vec::new();
    flatten("", "super::{a::{B,c::D},E}", &mut all);
    assert_eq!(all, ["super::a::B", "super::a::c::D", "super::E"]);
    assert_eq!(
        paths("pub(super) use self::x::Y;\npub use self::z::W;\nfn f() { let used = 1; }\nuse crate::z;\n"),
        ["self::x::Y", "crate::z"]
    );
}
