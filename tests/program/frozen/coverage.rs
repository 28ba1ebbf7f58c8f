//! Checks that every command and every option that selects an output format has a case.

use std::collections::{BTreeMap, BTreeSet};

use super::case::{cases, groups};
use crate::support::home::Home;

/// Options that select an output format or an output file.
const OUTPUT_OPTIONS: [&str; 10] = [
    "--json",
    "--csv",
    "--format",
    "--html",
    "--markdown",
    "--svg",
    "--text",
    "--metrics",
    "--card",
    "--session",
];

/// Commands and options without a case, with the reason.
const EXCEPTIONS: [(&str, &str); 19] = [
    ("bench", "measures time"),
    ("bench --json", "measures time"),
    ("completions", "written by the library that parses the command line"),
    ("man", "written by the library that formats manual pages"),
    ("doctor", "describes the machine"),
    ("doctor --json", "describes the machine"),
    ("study check", "describes the machine"),
    ("serve", "its routes are cases of `served`"),
    ("lesson play", "`play --lesson`"),
    ("lesson play --json", "`play --json`"),
    ("study start --json", "`play --json`"),
    ("agent python", "needs Python"),
    ("study key", "makes random keys"),
    ("study code", "makes a random salt"),
    ("host attach", "needs a terminal and a host"),
    ("host code", "makes a random salt"),
    ("host links", "makes random tokens"),
    ("host links --csv", "makes random tokens"),
    ("lab golden", "plays at least 24 seeds; its text names no figure that others read"),
];

/// The subcommands and options that the help of a command lists.
#[derive(Default)]
struct CommandHelp {
    commands: Vec<String>,
    /// Options of `OUTPUT_OPTIONS` with their possible values.
    forms: BTreeMap<String, Vec<String>>,
}

impl CommandHelp {
    fn parse(text: &str) -> CommandHelp {
        let mut help = CommandHelp::default();
        let (mut section, mut option) = ("", None::<String>);
        for line in text.lines() {
            if !line.starts_with(' ') && line.ends_with(':') {
                section = line;
                continue;
            }
            let words: Vec<&str> = line.split_whitespace().collect();
            match (section, words.first()) {
                // Names of commands are indented by two spaces, and their descriptions by more than two.
                ("Commands:", Some(name)) if line.starts_with("  ") && !line.starts_with("   ") => {
                    help.commands.push((*name).to_owned());
                }
                // Names of options are indented by six spaces, or by two if they have a short form.
                ("Options:", Some(name)) if line.starts_with("      --") => {
                    option = OUTPUT_OPTIONS.contains(name).then(|| (*name).to_owned());
                    help.forms.extend(option.iter().map(|name| (name.clone(), Vec::new())));
                }
                ("Options:", Some(_)) if line.starts_with("  -") => option = None,
                _ => {}
            }
            if let Some(values) = option.as_ref().and_then(|name| help.forms.get_mut(name)) {
                match line.split_once("[possible values: ") {
                    Some((_, listed)) => {
                        values.extend(listed.trim_end_matches(']').split(", ").map(str::to_owned));
                    }
                    None => values.extend(
                        line.trim_start()
                            .strip_prefix("- ")
                            .and_then(|rest| rest.split(':').next())
                            .map(str::to_owned),
                    ),
                }
            }
        }
        help.commands.retain(|name| name != "help");
        help
    }
}

/// Collects every command without subcommands, with its output options and each of their values.
fn collect_expected(home: &Home, path: &[&str], found: &mut BTreeSet<String>) {
    let program_output = home.run(&[path, &["--help"]].concat());
    assert_eq!(program_output.exit_code, 0, "{path:?}: {}", program_output.stderr);
    let help = CommandHelp::parse(&program_output.stdout);
    let name = path.join(" ");
    if help.commands.is_empty() {
        found.insert(name.clone());
    }
    if !path.is_empty() {
        for (form, values) in help.forms {
            match values.is_empty() {
                true => found.extend([format!("{name} {form}")]),
                false => found.extend(values.iter().map(|value| format!("{name} {form} {value}"))),
            }
        }
    }
    for command in &help.commands {
        collect_expected(home, &[path, &[command]].concat(), found);
    }
}

/// Collects the command of a case, with its output options and their values.
fn collect_covered(arguments: &[String], commands: &BTreeSet<String>, found: &mut BTreeSet<String>) {
    let mut name = String::new();
    for word in arguments.iter().take_while(|word| !word.starts_with('-')) {
        let longer = if name.is_empty() { word.clone() } else { format!("{name} {word}") };
        match commands.iter().any(|known| known == &longer || known.starts_with(&format!("{longer} "))) {
            true => name = longer,
            false => break,
        }
    }
    found.insert(name.clone());
    for (word, next) in arguments.iter().zip(arguments[1..].iter().map(Some).chain([None])) {
        if OUTPUT_OPTIONS.contains(&word.as_str()) {
            found.insert(format!("{name} {word}"));
            found.extend(next.map(|value| format!("{name} {word} {value}")));
        }
    }
}

#[test]
fn every_command_and_form_of_output_has_a_case() {
    let (home, mut wanted, mut found) = (Home::new(), BTreeSet::new(), BTreeSet::new());
    collect_expected(&home, &[], &mut wanted);
    assert!(wanted.len() > 100 && wanted.contains("query --format csv"), "{wanted:?}");
    let all = groups().iter().flat_map(|group| cases(group)).collect::<Vec<_>>();
    for case in &all {
        collect_covered(&case.arguments(), &wanted, &mut found);
    }
    let exceptions: BTreeSet<String> = EXCEPTIONS.iter().map(|(name, _)| (*name).to_owned()).collect();
    let missing: Vec<&String> =
        wanted.iter().filter(|name| !found.contains(*name) && !exceptions.contains(*name)).collect();
    assert!(missing.is_empty(), "without a case in tests/data/frozen/cases: {missing:#?}");
    let needless: Vec<&String> =
        exceptions.iter().filter(|name| found.contains(*name) || !wanted.contains(*name)).collect();
    assert!(needless.is_empty(), "exceptions that are not needed: {needless:?}");
}
