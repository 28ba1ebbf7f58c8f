//! Parses input lines of plain mode (docs/interfaces/plain-mode.md#grammar).

use serde_json::{Map, Value};

use novamind_base::formatting::arguments::LineParser;
pub use novamind_base::formatting::arguments::{Argument, ParseError};

/// A parsed input line.
#[derive(Debug, Clone, PartialEq)]
pub enum ParsedLine {
    /// An empty line or a comment.
    Empty,
    /// A command whose argument is the rest of the line as text.
    TextCommand {
        /// Name of the command, the first word of the line.
        word: String,
        /// Trimmed text after the first word.
        rest: String,
    },
    /// A command or tool with parsed arguments.
    Call {
        /// Name of the command or tool, as written.
        word: String,
        /// Column of the first word, counted from 1.
        column: usize,
        /// Arguments in the order in which they were written.
        arguments: Vec<Argument>,
    },
}

/// Former names of commands, which still work, and their current names.
pub const FORMER_NAMES: [(&str, &str); 2] = [("again", "retry"), ("back", "since")];

/// Returns the current name of a command that may be given by a former name.
pub fn current_name(word: &str) -> &str {
    FORMER_NAMES.iter().find(|(former, _)| *former == word).map_or(word, |(_, current)| current)
}

/// Commands whose argument is the rest of the line as text.
const TEXT_COMMANDS: [&str; 17] = [
    "sql", "query", "memo", "explain", "what", "glossary", "check", "rules", "why", "whatif", "pause",
    "resume", "break", "run", "since", "find", "who",
];

/// Parses an input line.
pub fn parse_line(line: &str) -> Result<ParsedLine, ParseError> {
    let mut reader = LineParser::new(line);
    reader.skip_whitespace();
    if reader.remaining().is_empty() || reader.remaining().starts_with('#') {
        return Ok(ParsedLine::Empty);
    }
    let column = reader.column();
    let word = reader.parse_word();
    if word.is_empty() {
        return Err(reader.error_here("a line begins with the name of a command or tool"));
    }
    let is_text = match word.as_str() {
        "inbox" => is_inbox_condition(reader.remaining()),
        "xray" => xray_statement(reader.remaining()).is_some(),
        word => TEXT_COMMANDS.contains(&current_name(word)),
    };
    if is_text {
        return Ok(ParsedLine::TextCommand { word, rest: reader.remaining().trim().to_owned() });
    }
    Ok(ParsedLine::Call { word, column, arguments: reader.parse_arguments()? })
}

/// Returns whether the text after `inbox` is a condition: `where …` or `all where …`.
fn is_inbox_condition(rest: &str) -> bool {
    rest.split_whitespace().find(|word| *word != "all") == Some("where")
}

/// Returns the statement of `xray sql …`, preceded by the optional day. Returns `None` for other views.
pub fn xray_statement(rest: &str) -> Option<&str> {
    let rest = rest.trim_start().strip_prefix("sql")?;
    (rest.is_empty() || rest.starts_with(char::is_whitespace)).then(|| rest.trim())
}

/// Returns the statement after `sql` or `query`. If the text is a single tool argument, returns the value of the argument.
pub fn sql_statement(rest: &str) -> String {
    let is_call = rest.starts_with(['{', '(']) || rest.starts_with("sql=");
    if let Some(Ok(ParsedLine::Call { arguments, .. })) = is_call.then(|| parse_line(&format!("call {rest}")))
        && let Ok(call) = arguments_to_object(&arguments, Some("sql"))
        && let Some(sql) = call.get("sql").and_then(Value::as_str)
    {
        return sql.to_owned();
    }
    rest.to_owned()
}

/// Combines arguments into the argument object of a tool. A single unnamed object is returned unchanged. Any other
/// single unnamed value becomes the value of the argument `only_required`.
pub fn arguments_to_object(arguments: &[Argument], only_required: Option<&str>) -> Result<Value, ParseError> {
    if let [Argument { key: None, value: Value::Object(map), .. }] = arguments {
        return Ok(Value::Object(map.clone()));
    }
    let mut map = Map::new();
    for argument in arguments {
        let key = match (&argument.key, only_required) {
            (Some(key), _) => key.clone(),
            (None, Some(required)) if arguments.len() == 1 => required.to_owned(),
            (None, _) => {
                let text = "write each argument as name=value, or all arguments as one {…}".to_owned();
                return Err(ParseError { text, column: argument.column });
            }
        };
        map.insert(key, argument.value.clone());
    }
    Ok(Value::Object(map))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn parsed_call(line: &str) -> (String, Value) {
        match parse_line(line) {
            Ok(ParsedLine::Call { word, arguments, .. }) => (
                word,
                arguments_to_object(&arguments, Some("tier"))
                    .unwrap_or_else(|problem| panic!("{line}: {problem:?}")),
            ),
            other => panic!("{line}: {other:?}"),
        }
    }

    #[test]
    fn parse_line_accepts_all_argument_notations() {
        let prices = json!({"A": 12, "B": 25, "C": 55.5});
        for line in [
            "pricing.set_prices(A=12, B=25, C=55.5)",
            "pricing.set_prices A=12 B=25 C=55.5",
            "pricing.set_prices A = 12, B = 25 C=55.5 # a comment",
            "pricing.set_prices {\"A\": 12, \"B\": 25, \"C\": 55.5}",
            "  pricing.set_prices( A=12 ,B=25, C=55.5 )  # done",
            "pricing.set_prices(\nA=12\nB=25 C=+55.5)",
        ] {
            assert_eq!(parsed_call(line), ("pricing.set_prices".to_owned(), prices.clone()), "{line}");
        }
        assert_eq!(parsed_call("set_capacity_tier 3").1, json!({"tier": 3}));
        let mixed = "x a=1_000_000 b=null c=true d=word e=\"two words # no comment\" f=[1, 2]";
        let expected = json!({"a": 1_000_000, "b": null, "c": true, "d": "word", "e": "two words # no comment", "f": [1, 2]});
        assert_eq!(parsed_call(mixed).1, expected);
        assert_eq!(parsed_call("get_cost_info").1, json!({}));
        assert_eq!(parsed_call("get_cost_info()").1, json!({}));
        assert_eq!(parsed_call("x a=12-3").1, json!({"a": "12-3"}));
    }

    #[test]
    fn text_commands_keep_the_rest_of_the_line() {
        let text = |line: &str| match parse_line(line) {
            Ok(ParsedLine::TextCommand { word, rest }) => (word, rest),
            other => panic!("{other:?}"),
        };
        let sql = "SELECT '# no comment', \"x\" FROM ledger -- (";
        assert_eq!(text(&format!("sql {sql}")), ("sql".to_owned(), sql.to_owned()));
        assert_eq!(
            text("memo  remember: prices = 12 "),
            ("memo".to_owned(), "remember: prices = 12".to_owned())
        );
        assert_eq!(text("sql"), ("sql".to_owned(), String::new()));
        assert_eq!(
            text("inbox all where seats >= 5"),
            ("inbox".to_owned(), "all where seats >= 5".to_owned())
        );
        assert_eq!(parsed_call("inbox(tier=3)").1, json!({"tier": 3}));
    }

    #[test]
    fn statements_may_be_written_as_a_call() {
        for rest in ["SELECT 1", "{\"sql\": \"SELECT 1\"}", "(sql=\"SELECT 1\")", "sql=\"SELECT 1\""] {
            assert_eq!(sql_statement(rest), "SELECT 1", "{rest}");
        }
        for rest in ["(SELECT 1)", "{\"sql\": 3}", ""] {
            assert_eq!(sql_statement(rest), rest);
        }
    }

    #[test]
    fn empty_lines_and_comments_parse_as_empty() {
        for line in ["", "   ", "# comment", "  # comment"] {
            assert_eq!(parse_line(line), Ok(ParsedLine::Empty));
        }
    }

    #[test]
    fn parse_errors_name_their_column() {
        for (line, column, part) in [
            ("set_prices A=12 A=13", 17, "twice"),
            ("set_prices(A=12", 16, "not closed"),
            ("set_prices(A=12) B=3", 18, "closing parenthesis"),
            ("set_prices A=", 14, "missing"),
            ("set_prices A=)", 14, "not )"),
            ("set_prices ,A=3", 12, "comma"),
            ("set_prices A=1,,B=2", 16, "comma"),
            ("set_prices {\"A\": }", 18, "JSON"),
            ("set_prices A={\"größe\": ]}", 24, "JSON"),
            ("(A=3)", 1, "name of a command"),
        ] {
            let problem = parse_line(line).expect_err(line);
            assert_eq!(problem.column, column, "{line}: {problem:?}");
            assert!(problem.text.contains(part), "{line}: {problem:?}");
        }
        let Ok(ParsedLine::Call { arguments, .. }) = parse_line("set_prices 12 13") else { panic!("a call") };
        assert_eq!(arguments_to_object(&arguments, None).expect_err("no names").column, 12);
    }

    proptest! {
        #[test]
        fn parse_line_never_panics(line in "\\PC{0,60}") {
            let _ = parse_line(&line);
        }

        #[test]
        fn json_object_arguments_round_trip(a in any::<i32>(), b in "[a-z ]{0,8}", c in any::<bool>()) {
            let given = json!({"a": a, "b": b, "c": [c, {"d": a}]});
            prop_assert_eq!(parsed_call(&format!("tool {given}")).1, given.clone());
            let keyed = format!("tool a={a} b={} c={}", given["b"], given["c"]);
            prop_assert_eq!(parsed_call(&keyed).1, given);
        }
    }
}
