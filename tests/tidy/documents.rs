//! Documents: link targets exist, values equal the parameters, and every named parameter, test and file exists.
//!
//! `NOVAMIND_WRITE_DOCUMENTS=1 cargo test documents` writes the values and tables.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::{files, root};

/// Parameter tables with one entry per group, pair of groups or persona. Pages show columns of these tables.
const TABLES_BY_GROUP: [&str; 3] = ["referral_leads_per_subscriber_day", "reputation_influence", "personas"];

/// A Markdown file.
struct Page {
    path: PathBuf,
    text: String,
}

impl Page {
    fn read(path: PathBuf) -> Page {
        let text = fs::read_to_string(&path).expect("a page");
        Page { path, text }
    }

    /// Returns the lines outside of code blocks, with their numbers.
    fn lines_outside_code_blocks(&self) -> impl Iterator<Item = (usize, &str)> {
        let mut is_code = false;
        self.text.lines().enumerate().filter_map(move |(at, line)| {
            let fence = line.trim_start().starts_with("```");
            is_code ^= fence;
            (!is_code && !fence).then_some((at + 1, line))
        })
    }

    fn problem_at(&self, line: usize, what: &str) -> String {
        let path = self.path.strip_prefix(root()).unwrap_or(&self.path);
        format!("{}:{line}: {what}", path.display())
    }

    /// Returns the anchors of all headings of the page.
    fn anchors(&self) -> BTreeSet<String> {
        let headings = self.lines_outside_code_blocks().filter_map(|(_, line)| line.strip_prefix('#'));
        headings.map(|heading| slug(heading.trim_start_matches('#').trim())).collect()
    }
}

/// Returns the anchor that GitHub generates for a heading.
fn slug(heading: &str) -> String {
    let kept = heading.to_lowercase();
    let kept = kept.chars().filter(|sign| sign.is_alphanumeric() || " -_".contains(*sign));
    kept.map(|sign| if sign == ' ' { '-' } else { sign }).collect()
}

fn pages() -> Vec<Page> {
    let root_pages = fs::read_dir(root()).expect("a folder").map(|entry| entry.expect("an entry").path());
    let root_pages = root_pages.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    let mut paths: Vec<PathBuf> = root_pages.chain(files(&root().join("docs"), "md")).collect();
    paths.sort();
    paths.into_iter().map(Page::read).collect()
}

/// Returns each text between two markers.
fn texts_between<'a>(line: &'a str, from: &'a str, to: &'a str) -> impl Iterator<Item = &'a str> {
    let parts = line.split(from).skip(1);
    parts.filter_map(move |part| part.split_once(to).map(|(inner, _)| inner))
}

/// Returns the texts between backticks in a line.
fn code_spans(line: &str) -> impl Iterator<Item = &str> {
    line.split('`').skip(1).step_by(2)
}

/// Returns the cells of a table row; `None` for other lines.
fn cells(line: &str) -> Option<Vec<&str>> {
    let inner = line.trim().strip_prefix('|')?.strip_suffix('|')?;
    Some(inner.split('|').map(str::trim).collect())
}

fn is_table_separator(cells: &[&str]) -> bool {
    cells.iter().all(|cell| !cell.is_empty() && cell.chars().all(|sign| "-: ".contains(sign)))
}

/// Returns the parameters of the base configuration files.
fn parameters() -> Table {
    let texts = files(&root().join("configs/world"), "toml");
    let tables = texts
        .iter()
        .map(|path| fs::read_to_string(path).expect("a file").parse::<Table>().expect("parameters in TOML"));
    tables.flatten().collect()
}

/// Formats the value of a parameter as it is written in documents.
fn format_value(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(values) => values.iter().map(format_value).collect::<Vec<_>>().join(", "),
        Value::Table(table) => table
            .iter()
            .map(|(key, value)| format!("{key} {}", format_value(value)))
            .collect::<Vec<_>>()
            .join(", "),
        Value::Integer(number) => number.to_string(),
        other => other.to_string(),
    }
}

fn parameter_value<'a>(parameters: &'a Table, key: &str) -> Option<&'a Value> {
    let mut parts = key.split('.');
    let mut value = parameters.get(parts.next()?)?;
    for part in parts {
        value = value.get(part)?;
    }
    (!value.is_table() || key.contains('.')).then_some(value)
}

/// Returns the text of a page with current values. Values are the second cell of each row that begins with a
/// parameter, and the tables after `<!-- table: list column … -->`.
fn fill_parameters(page: &Page, parameters: &Table) -> Result<String, String> {
    let mut text = String::new();
    let mut lines = page.text.lines().enumerate().peekable();
    let mut in_table = false;
    while let Some((at, line)) = lines.next() {
        let row = cells(line);
        let starts = row.as_ref().is_some_and(|row| row.first() == Some(&"Parameter"));
        in_table = row.is_some() && (in_table || starts);
        match row {
            Some(row) if in_table && !starts && !is_table_separator(&row) => {
                let key = row[0].trim_matches('`');
                let value = parameter_value(parameters, key)
                    .ok_or_else(|| page.problem_at(at + 1, &format!("there is no parameter {key}")))?;
                let value = format_value(value);
                let mut row: Vec<&str> = row;
                row[1] = &value;
                text += &format!("| {} |\n", row.join(" | "));
            }
            _ => text += &format!("{line}\n"),
        }
        if let Some(wanted) = line.strip_prefix("<!-- table: ").and_then(|rest| rest.strip_suffix(" -->")) {
            while lines.next_if(|(_, line)| line.starts_with('|')).is_some() {}
            text +=
                &parameter_table(parameters, wanted).map_err(|problem| page.problem_at(at + 1, &problem))?;
        }
    }
    Ok(text)
}

/// Returns a Markdown table with columns of a list of parameters, one row per entry.
fn parameter_table(parameters: &Table, wanted: &str) -> Result<String, String> {
    let mut words = wanted.split_whitespace();
    let list = words.next().unwrap_or_default();
    let entries = parameters.get(list).and_then(Value::as_array);
    let entries = entries.ok_or_else(|| format!("there is no list {list}"))?;
    let columns: Vec<&str> = words.collect();
    let mut text = format!("| {} |\n|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
    for entry in entries {
        let cell = |column: &&str| match entry.get(column) {
            Some(value) => format_value(value),
            None => "–".to_owned(),
        };
        text += &format!("| {} |\n", columns.iter().map(cell).collect::<Vec<_>>().join(" | "));
    }
    for column in &columns {
        if !entries.iter().any(|entry| entry.get(column).is_some()) {
            return Err(format!("no {list} has {column}"));
        }
    }
    Ok(text)
}

#[test]
fn documented_values_match_the_parameters() {
    let parameters = parameters();
    let mut problems = Vec::new();
    for page in pages() {
        let filled = match fill_parameters(&page, &parameters) {
            Ok(filled) => filled,
            Err(problem) => {
                problems.push(problem);
                continue;
            }
        };
        if filled == page.text {
            continue;
        }
        if std::env::var_os("NOVAMIND_WRITE_DOCUMENTS").is_some() {
            fs::write(&page.path, filled).expect("the page is written");
            continue;
        }
        let changed = page.text.lines().zip(filled.lines()).position(|(is, must)| is != must).unwrap_or(0);
        let must = filled.lines().nth(changed).unwrap_or_default();
        problems.push(page.problem_at(changed + 1, &format!("must be: {must}")));
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_parameter_is_explained_on_one_page() {
    let parameters = parameters();
    let mut keys: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (table, values) in &parameters {
        if let (Value::Table(values), false) = (values, TABLES_BY_GROUP.contains(&table.as_str())) {
            keys.extend(values.keys().map(|key| (format!("{table}.{key}"), Vec::new())));
        }
    }
    for page in pages() {
        for (at, line) in page.lines_outside_code_blocks() {
            let Some(row) = cells(line) else { continue };
            let key = row[0].trim_matches('`');
            let key = key.split('.').take(2).collect::<Vec<_>>().join(".");
            if let Some(places) = keys.get_mut(&key) {
                places.push(page.problem_at(at, ""));
            }
        }
    }
    let nested = |key: &str| parameter_value(&parameters, key).is_some_and(Value::is_table);
    let wrong = keys.iter().filter(|(key, places)| places.is_empty() || places.len() > 1 && !nested(key));
    let wrong: Vec<String> = wrong.map(|(key, places)| format!("{key}: {places:?}")).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Two documents state the length of lessons.
#[test]
fn documented_lesson_minutes_match_the_lessons() {
    let minutes: Vec<i64> = files(&root().join("configs/lessons"), "toml")
        .iter()
        .filter_map(|path| {
            let lesson: Table = fs::read_to_string(path).expect("a lesson").parse().expect("TOML");
            lesson.get("minutes").and_then(Value::as_integer)
        })
        .collect();
    let (least, most) = (minutes.iter().min().expect("a lesson"), minutes.iter().max().expect("a lesson"));
    let span = format!("{least} to {most} minutes");
    for path in ["README.md", "docs/lessons/README.md"] {
        let text = fs::read_to_string(root().join(path)).expect("a document");
        assert!(text.contains(&span), "{path} does not state {span}");
    }
}

#[test]
fn links_resolve() {
    let pages = pages();
    let mut problems = Vec::new();
    for page in &pages {
        let folder = page.path.parent().expect("a folder");
        for (at, line) in page.lines_outside_code_blocks() {
            for target in texts_between(line, "](", ")").filter(|target| !target.contains("://")) {
                let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
                let path = if file.is_empty() { page.path.clone() } else { folder.join(file) };
                let Ok(path) = path.canonicalize() else {
                    problems.push(page.problem_at(at, &format!("{target} is missing")));
                    continue;
                };
                let other = pages
                    .iter()
                    .find(|other| other.path.canonicalize().is_ok_and(|canonical| canonical == path));
                if !anchor.is_empty() && !other.is_some_and(|other| other.anchors().contains(anchor)) {
                    problems.push(page.problem_at(at, &format!("{target} has no such heading")));
                }
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Returns whether a word is a path in the repository. Words in capitals are placeholders.
fn is_path(word: &str) -> bool {
    let tops = ["src/", "tests/", "configs/", "assets/", "docs/"];
    if ["NAME", "MODULE", "PART"].iter().any(|stands_for| word.contains(stands_for)) {
        return false;
    }
    let plain = |sign: char| sign.is_ascii_alphanumeric() || "/._-".contains(sign);
    tops.iter().any(|top| word.starts_with(top)) && word.chars().all(plain)
}

#[test]
fn named_files_exist() {
    let mut problems = Vec::new();
    for page in pages() {
        for (at, line) in page.lines_outside_code_blocks() {
            let missing = code_spans(line).filter(|word| is_path(word) && !root().join(word).exists());
            problems.extend(missing.map(|word| page.problem_at(at, &format!("{word} is missing"))));
        }
    }
    for folder in ["src", "tests"] {
        for path in files(&root().join(folder), "rs") {
            let page = Page::read(path);
            for (at, line) in
                page.text.lines().enumerate().filter(|(_, line)| line.trim_start().starts_with("//"))
            {
                let words = line.split(|sign: char| sign.is_whitespace() || "`()[],;".contains(sign));
                let words = words.map(|word| word.trim_end_matches(['.', ':', '\'']));
                let missing = words.filter(|word| word.starts_with("docs/"));
                let missing = missing.filter(|word| !is_existing_page_or_heading(word));
                problems.extend(missing.map(|word| page.problem_at(at + 1, &format!("{word} is missing"))));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Returns whether a link to a documentation page resolves, including its heading if the link names one.
fn is_existing_page_or_heading(word: &str) -> bool {
    let (file, anchor) = word.split_once('#').unwrap_or((word, ""));
    let path = root().join(file);
    path.exists() && (anchor.is_empty() || Page::read(path).anchors().contains(anchor))
}

#[test]
fn check_values_match_the_tests() {
    let sources: Vec<String> = ["src", "tests"]
        .iter()
        .flat_map(|folder| files(&root().join(folder), "rs"))
        .map(|path| fs::read_to_string(path).expect("a source file"))
        .collect();
    let mut problems = Vec::new();
    for page in pages() {
        let mut result_column = None;
        for (at, line) in page.lines_outside_code_blocks() {
            let Some(row) = cells(line) else {
                result_column = None;
                continue;
            };
            if row.last() == Some(&"Test") {
                result_column = row.iter().position(|cell| *cell == "Result");
                continue;
            }
            if is_table_separator(&row) {
                continue;
            }
            let Some(result) = result_column else { continue };
            let name = row[row.len() - 1].trim_matches('`');
            let bodies: Vec<&str> = sources.iter().filter_map(|source| function_body(source, name)).collect();
            if bodies.is_empty() {
                problems.push(page.problem_at(at, &format!("there is no test {name}")));
            }
            for number in code_spans(row[result]) {
                if !bodies.iter().any(|body| body.contains(number)) {
                    problems.push(page.problem_at(at, &format!("{number} does not stand in {name}")));
                }
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Returns the text of a function, from its name to the end of its block.
fn function_body<'a>(source: &'a str, name: &str) -> Option<&'a str> {
    let from = source.find(&format!("fn {name}("))?;
    let indent = source[..from].rfind('\n').map_or(0, |line| from - line - 1);
    let end = format!("\n{}}}", " ".repeat(indent - indent % 4));
    let rest = &source[from..];
    Some(&rest[..rest.find(&end).unwrap_or(rest.len())])
}

/// Every page about a mechanism must link to its code.
#[test]
fn every_mechanism_names_its_code() {
    let folder: &Path = &root().join("docs/mechanics");
    let pages_without_code: Vec<PathBuf> = files(folder, "md")
        .into_iter()
        .filter(|path| !path.ends_with("README.md"))
        .filter(|path| !Page::read(path.clone()).text.contains("\nCode: "))
        .collect();
    assert!(pages_without_code.is_empty(), "{pages_without_code:?}");
}

/// Documents and comments must not refer to numbered chapters of texts outside the repository.
#[test]
fn no_file_refers_to_numbered_chapters() {
    let numbered = |line: &str| {
        let after =
            |(_, rest): (&str, &str)| rest.trim_start().starts_with(|sign: char| sign.is_ascii_digit());
        line.to_lowercase().split_once("chapter ").is_some_and(after) || line.contains('\u{a7}')
    };
    let folders = [("src", "rs"), ("tests", "rs"), ("configs", "toml"), ("assets", "toml"), ("docs", "md")];
    let all = folders.iter().flat_map(|(folder, kind)| files(&root().join(folder), kind));
    let mut problems = Vec::new();
    for page in all.map(Page::read) {
        let lines = page.text.lines().enumerate().filter(|(_, line)| numbered(line));
        problems.extend(lines.map(|(at, line)| page.problem_at(at + 1, line)));
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Returns a lowercase term without the plural ending.
fn singular(term: &str) -> String {
    let term = term.to_lowercase();
    term.strip_suffix('s').filter(|stem| !stem.ends_with('s')).unwrap_or(&term).to_owned()
}

#[test]
fn glossary_titles_are_vocabulary_terms() {
    let page = Page::read(root().join("docs/vocabulary.md"));
    let terms =
        page.lines_outside_code_blocks().filter_map(|(_, line)| cells(line).map(|cells| cells[0].to_owned()));
    let terms: BTreeSet<String> =
        terms.flat_map(|cell| cell.split(", ").map(singular).collect::<Vec<_>>()).collect();
    let glossary = fs::read_to_string(root().join("assets/glossary.toml")).expect("the glossary");
    let glossary: Table = glossary.parse().expect("TOML");
    let titles = glossary["term"].as_array().expect("terms").iter().filter_map(|term| term["title"].as_str());
    let missing: Vec<&str> = titles.filter(|title| !terms.contains(&singular(title))).collect();
    assert!(missing.is_empty(), "add these terms to docs/vocabulary.md or change their titles: {missing:?}");
}
