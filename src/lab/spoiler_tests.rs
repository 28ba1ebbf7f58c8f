//! Tests that texts for new players do not reveal settings that work well. The tour, the README, documents,
//! pictures and examples must not contain the numbers of a bundled policy.

use std::fs;
use std::path::{Path, PathBuf};

use super::policy::{Policy, PriceBook};
use novamind_record::folder::configuration::Configuration;
use novamind_session::best_starting_channel;
use novamind_tools::CATALOGUE;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// The page that documents the policies, which may contain their numbers.
const POLICY_PAGE: &str = "docs/interfaces/policies.md";

/// Maximum number of characters between two numbers of one list.
const MAX_DISTANCE: usize = 24;

/// Settings of the bundled policies that texts must not reveal.
struct PolicyNumbers {
    /// Sets of prices or quotas for the plans A, B and C.
    sets: Vec<[f64; 3]>,
    /// Budgets for development and ads by group, $ per day.
    development: Vec<(&'static str, f64)>,
    ads: Vec<(&'static str, f64)>,
    /// Each advertised group, with the first channel that the routine uses for the group.
    channels: Vec<(&'static str, &'static str)>,
}

fn bundled_policy_numbers() -> PolicyNumbers {
    let params = Params::bundled();
    let best = |group| best_starting_channel(Group::parse(group).expect("a group"), &params).id();
    let channels = ["S1", "S3"].map(|group| (group, best(group))).to_vec();
    let mut found = PolicyNumbers { sets: Vec::new(), development: Vec::new(), ads: Vec::new(), channels };
    let mut price_books = vec![];
    for (name, _) in novamind_assets::policies() {
        let policy = Policy::find(name, &Configuration::bundled()).expect(name);
        let Some(routine) = policy.rule_based else { continue };
        price_books.push(routine.price_book.clone());
        let (s1, s3) = routine.spend.budgets();
        for (group, budget) in [("S1", s1), ("S3", s3)] {
            found.development.push((group, budget.development));
            found.ads.push((group, budget.ads));
        }
    }
    for book in price_books.iter().map(PriceBook::prices_tiers_and_quotas) {
        let (prices, _, quotas) = book;
        found.sets.push([prices.a, prices.b, prices.c]);
        found.sets.push([quotas.a, quotas.b, quotas.c].map(|quota| quota as f64));
    }
    found
}

/// A number in a text.
#[derive(Debug, Clone, Copy)]
struct NumberInText {
    start: usize,
    end: usize,
    value: f64,
    /// Plan that the text names before the number.
    plan: Option<char>,
}

/// Returns the numbers in a text, in any of these formats: `12`, `$12.00`, `60k`, `250_000`, `1.2M`.
fn parse_numbers(text: &str) -> Vec<NumberInText> {
    let bytes = text.as_bytes();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let begins = bytes[at].is_ascii_digit() && (at == 0 || !bytes[at - 1].is_ascii_alphanumeric());
        if !begins {
            at += 1;
            continue;
        }
        let is_part = |at: usize| {
            bytes[at].is_ascii_digit()
                || matches!(bytes[at], b',' | b'_' | b'.')
                    && bytes.get(at + 1).is_some_and(u8::is_ascii_digit)
        };
        let to = (at..bytes.len()).find(|at| !is_part(*at)).unwrap_or(bytes.len());
        let digits: String = text[at..to].chars().filter(|letter| !matches!(letter, ',' | '_')).collect();
        let factor = match bytes.get(to) {
            Some(b'k' | b'K') => 1e3,
            Some(b'M') => 1e6,
            _ => 1.0,
        };
        let before = text[..at].trim_end_matches(['"', '=', ':', ' ', '$', '(', '{']);
        let mut letters = before.chars().rev();
        let plan = letters.next().filter(|letter| matches!(letter, 'A'..='C'));
        let plan = plan.filter(|_| letters.next().is_none_or(|letter| !letter.is_alphanumeric()));
        found.extend(digits.parse().ok().map(|value: f64| NumberInText {
            start: at,
            end: to,
            value: value * factor,
            plan,
        }));
        at = to;
    }
    found
}

/// Returns the policy settings that a text reveals.
fn find_leaked_numbers(text: &str, answers: &PolicyNumbers) -> Vec<String> {
    let numbers = parse_numbers(text);
    let near = |pair: &[NumberInText]| pair[1].start.saturating_sub(pair[0].end) <= MAX_DISTANCE;
    let mut found = Vec::new();
    for three in numbers.windows(3).filter(|three| near(three) && near(&three[1..])) {
        let values = [three[0].value, three[1].value, three[2].value];
        if answers.sets.contains(&values) {
            found.push(format!("{values:?} at {:?}", &text[three[0].start..three[2].end]));
        }
    }
    for pair in numbers.windows(2).filter(|pair| near(pair)) {
        let at = match (pair[0].plan, pair[1].plan) {
            (Some('A'), Some('B')) => 0,
            (Some('B'), Some('C')) => 1,
            _ => continue,
        };
        if answers.sets.iter().any(|set| set[at..at + 2] == [pair[0].value, pair[1].value]) {
            found.push(format!("two plans of a policy: {:?}", &text[pair[0].start..pair[1].end]));
        }
    }
    for line in text.lines() {
        let lower = line.to_lowercase();
        let names = |word: &str| line.contains(word) || line.contains(&word.replace('_', " "));
        let holds = |group: &str, amounts: &[(&str, f64)]| {
            let values = self::parse_numbers(line);
            let matches_value =
                |amount: &(&str, f64)| amount.0 == group && values.iter().any(|one| one.value == amount.1);
            line.contains(group) && amounts.iter().any(matches_value)
        };
        for (group, channel) in answers.channels.iter().copied() {
            let is_near = |first: &str, second: &str| {
                line.match_indices(first).any(|(at, _)| {
                    line.get(at + first.len()..)
                        .is_some_and(|rest| rest.find(second).is_some_and(|gap| gap <= MAX_DISTANCE))
                })
            };
            if names(channel) && (is_near(channel, group) || is_near(group, channel)) {
                found.push(format!("{channel} for {group}: {line}"));
            }
            if lower.contains("dev") && holds(group, &answers.development) {
                found.push(format!("development of a policy: {line}"));
            }
            if names(channel) && holds(group, &answers.ads) {
                found.push(format!("ads of a policy: {line}"));
            }
        }
    }
    found
}

/// Collects the files in a folder, recursively.
fn collect_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { collect_files(&path, found) } else { found.push(path) }
    }
}

/// Returns the readable text of a file. Source code is returned without tests, and a picture as lines of text.
fn readable_text(path: &Path) -> Option<String> {
    let text = fs::read_to_string(path).ok()?;
    let name = path.file_name()?.to_str()?;
    match path.extension()?.to_str()? {
        "rs" if name.ends_with("tests.rs") || name == "test_kit.rs" => None,
        "rs" => Some(text.split("#[cfg(test)]\nmod ").next().unwrap_or_default().to_owned()),
        "svg" => Some(svg_text(&text)),
        "md" | "toml" | "sql" => Some(text),
        _ => None,
    }
}

/// Returns the text of a console picture without SVG tags, one line per row of the console.
fn svg_text(svg: &str) -> String {
    let (mut text, mut row) = (String::new(), "");
    for piece in svg.split("<text").skip(1) {
        let Some((tag, rest)) = piece.split_once('>') else { continue };
        let row_y = tag.split(" y=\"").nth(1).and_then(|rest| rest.split('"').next()).unwrap_or_default();
        text += if row_y == row { " " } else { "\n" };
        row = row_y;
        text += rest.split("</text>").next().unwrap_or_default();
    }
    text
}

#[test]
fn introductory_texts_contain_no_policy_numbers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = vec![root.join("README.md"), root.join("CONTRIBUTING.md"), root.join("src/lib.rs")];
    for folder in ["docs", "assets", "src/console", "src/plain", "src/tools", "src/glossary", "src/cli"] {
        collect_files(&root.join(folder), &mut paths);
    }
    let answers = bundled_policy_numbers();
    let mut found = Vec::new();
    let read_before = paths.iter().filter(|path| !path.ends_with(POLICY_PAGE));
    for (path, text) in read_before.filter_map(|path| Some((path, readable_text(path)?))) {
        let name = path.strip_prefix(root).unwrap_or(path).display();
        found.extend(find_leaked_numbers(&text, &answers).into_iter().map(|what| format!("{name}: {what}")));
    }
    for tool in CATALOGUE {
        let spec = tool.spec();
        let what = find_leaked_numbers(spec.example, &answers);
        found.extend(what.into_iter().map(|what| format!("example of {}: {what}", spec.name())));
    }
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn leaked_numbers_are_found_in_every_notation() {
    let answers = bundled_policy_numbers();
    for text in [
        "A 12, B 25, C 55",
        "$12, $25 and $55 will do",
        "A=8 B=18 C=40",
        r#"{"A":12,"B":25}"#,
        "60k, 250k, 1.2M",
        r#"{"A": 50000, "B": 200000, "C": 900000}"#,
        "750 dollars a day of content_marketing for S1",
        r#"{"content_marketing": {"S1": 80}}"#,
        "set_targeted_dev_spend S1 6000",
    ] {
        assert!(!find_leaked_numbers(text, &answers).is_empty(), "{text}");
    }
    for text in [
        "1, 4, 12 and 26 weeks",
        "A 14, B 29",
        r#"{"social_media": {"S2": 700}}"#,
        "content_marketing, social_media",
        "within 12 of 25 rows, and 1200",
    ] {
        assert!(
            find_leaked_numbers(text, &answers).is_empty(),
            "{text}: {:?}",
            find_leaked_numbers(text, &answers)
        );
    }
}
