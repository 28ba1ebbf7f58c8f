//! The user's own commands in `commands.toml` of the configuration folder: a key or an entry of the palette for a
//! query, a rule, a sequence of calls, or an external program that receives rows
//! (docs/guide/console.md#your-own-commands).

mod program;
mod rows;

use std::time::Duration;

use serde::Deserialize;
use serde_json::Value;
use toml::Spanned;

#[cfg(test)]
use super::action::ACTIONS;
use super::action::Scope;
use super::keys::{KeyBindings, KeyMeaning};
use novamind_base::similar_names;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::query_library::{QueryHeader, QueryLibrary};
use novamind_tools::ToolId;
use novamind_tui::chord::{Chord, format_sequence, parse_sequence};
use novamind_worker::company::DisplayedCompany;

pub use rows::ListRows;

pub use program::{ProgramCall, run_in_background};

/// Name of the file in the configuration folder.
pub const COMMANDS_FILE: &str = "commands.toml";

const DEFAULT_TIMEOUT_SECONDS: u64 = 30;
const MAX_TIMEOUT_SECONDS: u64 = 3_600;

/// What an own command does.
#[derive(Debug, Clone, PartialEq)]
pub enum OwnAction {
    /// Runs an SQL statement on the SQL screen.
    Query(String),
    /// Opens rules in the inbox, with their preview.
    Rules(String),
    /// Executes tool calls in order, after a confirmation. Each call is stored with the text of its line.
    Lines(Vec<(String, ToolId, Value)>),
    /// Runs an external program.
    Program(ExternalProgram),
}

/// An external program that receives rows on its standard input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExternalProgram {
    /// Program and arguments. No shell interprets the arguments.
    pub command: Vec<String>,
    /// Whether the program receives all displayed rows instead of the selected rows.
    pub gets_all_rows: bool,
    /// Whether the rows are JSON instead of CSV.
    pub gets_json: bool,
    /// Time after which the program is killed.
    pub timeout: Duration,
}

/// A command of the user.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnCommand {
    /// Name of the command in the palette.
    pub name: String,
    /// Keys of the command. Empty if the command has no keys.
    pub keys: Vec<Chord>,
    /// What the command does.
    pub action: OwnAction,
}

/// All valid own commands, and the problems of the invalid ones.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct OwnCommands {
    /// Valid commands in the order of the file.
    pub commands: Vec<OwnCommand>,
    /// Problems in the file, each with its line number and a correction.
    pub problems: Vec<String>,
}

/// Meaning of pressed keys for own commands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OwnKeyMeaning {
    /// The keys run the command with this index.
    Command(usize),
    /// The keys are the start of a sequence.
    Prefix,
}

/// Returns why own commands cannot be used in a run, if they cannot.
pub fn own_commands_refusal(company: &DisplayedCompany, has_participant: bool) -> Option<&'static str> {
    if has_participant {
        return Some("own commands are closed in a study, because they are outside help");
    }
    (company.is_baseline() && company.is_running()).then_some(
        "own commands are closed in an unfinished baseline run, because they are outside help that agents do not have",
    )
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CommandsFile {
    #[serde(default)]
    commands: Vec<Spanned<toml::Value>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CommandEntry {
    name: String,
    key: Option<String>,
    query: Option<String>,
    sql: Option<String>,
    rules: Option<String>,
    lines: Option<Vec<String>>,
    program: Option<Vec<String>>,
    rows: Option<String>,
    input: Option<String>,
    timeout: Option<u64>,
}

impl OwnCommand {
    /// Describes what the command does, in one line.
    pub fn describe(&self) -> String {
        match &self.action {
            OwnAction::Query(sql) => match QueryHeader::parse(sql).title {
                Some(title) => format!("runs the query {title}"),
                None => format!("runs {}", single_line(sql)),
            },
            OwnAction::Rules(rules) => format!("opens the rules {}", single_line(rules)),
            OwnAction::Lines(lines) => {
                let lines: Vec<&str> = lines.iter().map(|(line, ..)| line.as_str()).collect();
                format!("calls {}", lines.join("; "))
            }
            OwnAction::Program(program) => {
                let rows = if program.gets_all_rows { "all rows" } else { "the selected rows" };
                format!("runs {} with {rows}", program.command.join(" "))
            }
        }
    }

    /// Returns the keys of the command as text, or an empty text if the command has no keys.
    pub fn key_label(&self) -> String {
        format_sequence(&self.keys)
    }
}

impl OwnCommands {
    /// Loads the own commands. Invalid commands are omitted and reported as problems.
    pub fn load(configuration: &Configuration, keys: &KeyBindings, library: &QueryLibrary) -> OwnCommands {
        match configuration.read_file(COMMANDS_FILE) {
            Ok(None) => OwnCommands::default(),
            Ok(Some(source)) => {
                let mut own = OwnCommands::parse(&source.text, keys, library);
                own.problems.iter_mut().for_each(|problem| *problem = format!("{}, {problem}", source.name));
                own
            }
            Err(error) => OwnCommands { problems: vec![error.to_string()], ..OwnCommands::default() },
        }
    }

    fn parse(text: &str, keys: &KeyBindings, library: &QueryLibrary) -> OwnCommands {
        let mut own = OwnCommands::default();
        let file: CommandsFile = match toml::from_str(text) {
            Ok(file) => file,
            Err(error) => {
                let line = line_at(text, error.span().map_or(0, |span| span.start));
                own.problems.push(format!("line {line}: {}. No own command was loaded.", error.message()));
                return own;
            }
        };
        for entry in file.commands {
            let line = line_at(text, entry.span().start);
            match own.read_command(entry.into_inner(), keys, library) {
                Ok(command) => own.commands.push(command),
                Err(problem) => own.problems.push(format!("line {line}: {problem}")),
            }
        }
        own
    }

    fn read_command(
        &self,
        entry: toml::Value,
        keys: &KeyBindings,
        library: &QueryLibrary,
    ) -> Result<OwnCommand, String> {
        let entry: CommandEntry =
            entry.try_into().map_err(|error: toml::de::Error| error.message().to_owned())?;
        if entry.name.trim().is_empty() {
            return Err("the command has no name. Set name to the words that the palette shows.".to_owned());
        }
        let name = entry.name.trim().to_owned();
        if self.commands.iter().any(|other| other.name == name) {
            return Err(format!("there are two commands named {name}. Rename one."));
        }
        let chords = match &entry.key {
            Some(key) => self.free_keys(key, keys).map_err(|problem| format!("{name}: {problem}"))?,
            None => Vec::new(),
        };
        let action = read_action(entry, library).map_err(|problem| format!("{name}: {problem}"))?;
        Ok(OwnCommand { name, keys: chords, action })
    }

    /// Parses the keys of a command. Rejects keys that already have a meaning on a screen.
    fn free_keys(&self, text: &str, keys: &KeyBindings) -> Result<Vec<Chord>, String> {
        let chords = parse_sequence(text).map_err(|problem| format!("key: {problem}"))?;
        let shown = format_sequence(&chords);
        if chords.first().is_none_or(|chord| chord.starts_number() || chord.is_escape()) {
            return Err(format!("key: {shown} cannot start a command. Choose another key."));
        }
        let screens = || Scope::ALL.into_iter().filter(|scope| !scope.is_text());
        for scope in screens() {
            for length in 1..=chords.len() {
                let other = match keys.meaning(&[scope], &chords[..length]) {
                    KeyMeaning::Action(action) => action.entry().title,
                    KeyMeaning::Prefix if length == chords.len() => "the start of other keys",
                    KeyMeaning::Prefix | KeyMeaning::Unbound => continue,
                };
                let place = scope.title();
                return Err(format!("key: {shown} already means {other} ({place}). Choose another key."));
            }
        }
        let clash =
            |bound: &[Chord]| !bound.is_empty() && (bound.starts_with(&chords) || chords.starts_with(bound));
        match self.commands.iter().find(|other| clash(&other.keys)) {
            Some(other) => Err(format!("key: {shown} already means {}. Choose another key.", other.name)),
            None => Ok(chords),
        }
    }

    /// Returns the first problem of the file, and the number of the other problems.
    pub fn problem_summary(&self) -> Option<String> {
        let [first, others @ ..] = self.problems.as_slice() else { return None };
        let rest = match (others.len(), self.commands.is_empty()) {
            (0, true) => "",
            (0, false) => " The other own commands work.",
            _ => " The palette shows the other problems.",
        };
        Some(format!("{first}{rest}"))
    }

    /// Returns the meaning of pressed keys.
    pub fn meaning(&self, pressed: &[Chord]) -> Option<OwnKeyMeaning> {
        let at = self.commands.iter().position(|command| command.keys.starts_with(pressed))?;
        let is_complete = self.commands[at].keys.len() == pressed.len();
        Some(if is_complete { OwnKeyMeaning::Command(at) } else { OwnKeyMeaning::Prefix })
    }

    /// Formats the commands as text in aligned columns. Returns an empty text if there are no commands.
    pub fn to_text(&self) -> String {
        if self.commands.is_empty() {
            return String::new();
        }
        let rows = || self.commands.iter().map(|command| (command.key_label(), command));
        let width = rows().map(|(keys, _)| keys.chars().count()).max().unwrap_or(0).max("palette".len());
        let line = |(keys, command): (String, &OwnCommand)| {
            let keys = if keys.is_empty() { "palette" } else { keys.as_str() };
            format!("  {keys:<width$}  {}: {}\n", command.name, command.describe())
        };
        format!("Own commands ({COMMANDS_FILE})\n{}\n", rows().map(line).collect::<String>())
    }
}

fn read_action(entry: CommandEntry, library: &QueryLibrary) -> Result<OwnAction, String> {
    let is_program = entry.program.is_some();
    if !is_program && (entry.rows.is_some() || entry.input.is_some() || entry.timeout.is_some()) {
        return Err("rows, input and timeout belong to a program. Remove them, or set program.".to_owned());
    }
    match (entry.query, entry.sql, entry.rules, entry.lines, entry.program) {
        (Some(name), None, None, None, None) => {
            let known = library.queries().iter().find(|query| query.name == name);
            let unknown = || {
                let similar = similar_names(&name, library.queries().iter().map(|query| query.name.as_str()));
                let hint =
                    similar.first().map_or(String::new(), |similar| format!(" Did you mean {similar}?"));
                format!("there is no query {name}.{hint} `novamind query --list` lists the queries.")
            };
            Ok(OwnAction::Query(known.ok_or_else(unknown)?.sql.clone()))
        }
        (None, Some(sql), None, None, None) if !sql.trim().is_empty() => Ok(OwnAction::Query(sql)),
        (None, None, Some(rules), None, None) => match novamind_rules::parse(&rules) {
            Ok(_) => Ok(OwnAction::Rules(rules)),
            Err(problem) => Err(format!("rules: {} (column {})", problem.text, problem.column)),
        },
        (None, None, None, Some(lines), None) if !lines.is_empty() => {
            let call = |line: String| match novamind_plain::parse_tool_call(&line) {
                Ok((tool, arguments)) => Ok((line, tool, arguments)),
                Err(problem) => Err(format!("lines: {line}: {problem}")),
            };
            lines.into_iter().map(call).collect::<Result<_, _>>().map(OwnAction::Lines)
        }
        (None, None, None, None, Some(command)) => {
            if command.first().is_none_or(|program| program.trim().is_empty()) {
                return Err("program is empty. Write the program and each argument as one text.".to_owned());
            }
            let is_second_choice =
                |value: Option<String>, key: &str, first: &str, second: &str| match value.as_deref() {
                    None => Ok(false),
                    Some(value) if value == first => Ok(false),
                    Some(value) if value == second => Ok(true),
                    Some(value) => Err(format!("{key} is {value}. Set it to \"{first}\" or \"{second}\".")),
                };
            let seconds = entry.timeout.unwrap_or(DEFAULT_TIMEOUT_SECONDS);
            if !(1..=MAX_TIMEOUT_SECONDS).contains(&seconds) {
                return Err(format!("timeout is {seconds}. Set it to 1 to {MAX_TIMEOUT_SECONDS} seconds."));
            }
            Ok(OwnAction::Program(ExternalProgram {
                command,
                gets_all_rows: is_second_choice(entry.rows, "rows", "selected", "all")?,
                gets_json: is_second_choice(entry.input, "input", "csv", "json")?,
                timeout: Duration::from_secs(seconds),
            }))
        }
        _ => Err("set exactly one of query, sql, rules, lines and program.".to_owned()),
    }
}

/// Returns the number of the line that contains a byte, counted from 1.
fn line_at(text: &str, byte: usize) -> usize {
    text.bytes().take(byte).filter(|byte| *byte == b'\n').count() + 1
}

fn single_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns whether a name is the title of an action of the program, which the palette would show twice.
#[cfg(test)]
fn is_action_title(name: &str) -> bool {
    ACTIONS.iter().any(|entry| entry.title == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> OwnCommands {
        OwnCommands::parse(text, &KeyBindings::bundled(), &QueryLibrary::bundled())
    }

    const VALID: &str = r#"
[[commands]]
name = "Cost of a unit"
key = "; u"
query = "cost-of-a-unit"

[[commands]]
name = "Count rows"
key = "ctrl-g"
program = ["wc", "-l"]
rows = "all"
input = "json"
timeout = 5

[[commands]]
name = "Answer"
rules = "accept asked >= 18; reject rest"

[[commands]]
name = "Usual prices"
lines = ["set_prices A=16 B=34", "set_capacity_tier 1"]
"#;

    #[test]
    fn file_defines_all_kinds_of_commands() {
        let own = parse(VALID);
        assert_eq!(own.problems, [""; 0]);
        let kinds: Vec<&str> = own.commands.iter().map(|command| command.name.as_str()).collect();
        assert_eq!(kinds, ["Cost of a unit", "Count rows", "Answer", "Usual prices"]);
        assert!(matches!(&own.commands[0].action, OwnAction::Query(sql) if sql.contains("SELECT")));
        assert!(matches!(&own.commands[1].action, OwnAction::Program(program)
            if program.gets_all_rows && program.gets_json && program.timeout == Duration::from_secs(5)));
        assert!(matches!(&own.commands[3].action, OwnAction::Lines(lines) if lines.len() == 2));
        let press = |keys: &str| own.meaning(&parse_sequence(keys).expect("keys"));
        assert_eq!(press("; u"), Some(OwnKeyMeaning::Command(0)));
        assert_eq!(press(";"), Some(OwnKeyMeaning::Prefix));
        assert_eq!((press("ctrl-g"), press("; y")), (Some(OwnKeyMeaning::Command(1)), None));
        let text = own.to_text();
        for part in ["; u", "palette", "Answer: opens the rules accept", "runs wc -l with all rows"] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        assert!(!is_action_title("Count rows"));
    }

    #[test]
    fn problems_name_the_line_and_keep_other_commands() {
        for (text, problem) in [
            ("[[commands]]\nname = 3\nsql = \"x\"", "line 1: invalid type"),
            ("\n[[commands]]\nname = \"a\"", "line 2: a: set exactly one of"),
            ("[[commands]]\nname = \"a\"\nsql = \"x\"\nquery = \"y\"", "set exactly one of"),
            ("[[commands]]\nname = \"a\"\nquery = \"cost-of-unit\"", "Did you mean cost-of-a-unit?"),
            ("[[commands]]\nname = \"a\"\nsql = \"x\"\nkey = \"n\"", "already means"),
            ("[[commands]]\nname = \"a\"\nsql = \"x\"\nkey = \";\"", "already means the start of other keys"),
            ("[[commands]]\nname = \"a\"\nsql = \"x\"\nkey = \"n x\"", "already means"),
            ("[[commands]]\nname = \"a\"\nsql = \"x\"\nkey = \"8\"", "cannot start a command"),
            ("[[commands]]\nname = \"a\"\nsql = \"x\"\nkey = \"hyper-x\"", "is not a key"),
            ("[[commands]]\nname = \"a\"\nsql = \"x\"\ntimeout = 3", "belong to a program"),
            ("[[commands]]\nname = \"a\"\nprogram = []", "program is empty"),
            (
                "[[commands]]\nname = \"a\"\nprogram = [\"x\"]\nrows = \"some\"",
                "Set it to \"selected\" or \"all\"",
            ),
            ("[[commands]]\nname = \"a\"\nprogram = [\"x\"]\ntimeout = 0", "Set it to 1 to 3600 seconds"),
            ("[[commands]]\nname = \"a\"\nrules = \"agree rest\"", "rules: "),
            ("[[commands]]\nname = \"a\"\nlines = [\"set_price A=3\"]", "lines: set_price A=3: "),
            ("[[commands]]\nname = \"a\"\nlines = [\"next naive\"]", "lines: next naive: "),
            ("[[commands]]\nname = \"a\"\nkeys = \"x\"\nsql = \"x\"", "unknown field `keys`"),
            ("commands = 3", "line 1: "),
            ("[[commands]\n", "No own command was loaded"),
        ] {
            let own = parse(text);
            assert!(own.commands.is_empty(), "{text}");
            assert!(own.problems[0].contains(problem), "{problem} in {:?}", own.problems);
        }
        let own = parse(&format!("{VALID}\n[[commands]]\nname = \"Answer\"\nsql = \"x\"\n"));
        assert_eq!(own.commands.len(), 4);
        assert!(
            own.problems[0].starts_with("line 23: there are two commands named Answer"),
            "{:?}",
            own.problems
        );
        let own = parse(&format!("{VALID}\n[[commands]]\nname = \"b\"\nkey = \"ctrl-g\"\nsql = \"x\"\n"));
        assert!(own.problems[0].contains("already means Count rows"), "{:?}", own.problems);
        let summary = own.problem_summary().expect("a problem");
        assert!(summary.starts_with(&own.problems[0]) && summary.ends_with("work."), "{summary}");
    }

    #[test]
    fn no_file_means_no_commands() {
        let (keys, library) = (KeyBindings::bundled(), QueryLibrary::bundled());
        assert_eq!(OwnCommands::load(&Configuration::bundled(), &keys, &library), OwnCommands::default());
        assert_eq!(OwnCommands::default().to_text(), "");
    }
}
