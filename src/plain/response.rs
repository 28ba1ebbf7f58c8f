//! Responses to commands, as text and as JSON (docs/interfaces/plain-mode.md#answers).

use serde_json::{Map, Value, json};

use novamind_base::formatting::normalize_json_numbers;
use novamind_database::text::align_columns;
use novamind_tools::Rejection;

/// The response to an input line.
#[derive(Debug, Clone, PartialEq)]
pub enum CommandResponse {
    /// The command succeeded.
    Success {
        /// Name of the executed command.
        command: String,
        /// Complete text of the response.
        text: String,
        /// Data of the response for JSON output.
        data: Value,
    },
    /// The command was rejected. The run is unchanged.
    Rejected {
        /// Name of the rejected command.
        command: String,
        /// Code and reason of the rejection.
        rejection: Rejection,
    },
    /// The line has a syntax error.
    SyntaxError {
        /// Description of the error, with suggestions of similar names.
        problem: String,
        /// Column of the error, counted from 1.
        column: usize,
        /// The word at this column; `None` if the description already contains the word.
        word: Option<String>,
    },
    /// The player entered `quit` or `exit`.
    Quit,
}

impl CommandResponse {
    /// Returns the response of a successful command.
    pub fn success(command: &str, text: String, data: Value) -> CommandResponse {
        CommandResponse::Success { command: command.to_owned(), text, data }
    }

    /// Returns the response of an accepted tool call. The text lists the fields of `shown`, or the fields of
    /// `data` if `shown` is `None`.
    pub fn tool_result(command: &str, data: Value, shown: Option<Value>) -> CommandResponse {
        let mut text = format!("ok {command}\n");
        match normalize_json_numbers(shown.unwrap_or_else(|| data.clone())) {
            Value::Object(fields) => {
                fields.iter().for_each(|(name, value)| text += &format_field(name, value))
            }
            Value::Null => {}
            other => text += &format!("  {other}\n"),
        }
        CommandResponse::success(command, text, data)
    }

    /// Appends notes to the text of the response. The data does not change.
    pub fn with_notes(mut self, notes: &[String]) -> CommandResponse {
        if let CommandResponse::Success { text, .. } = &mut self {
            notes.iter().for_each(|note| *text += &format!("note: {note}\n"));
        }
        self
    }

    /// Returns a response with both texts and the command and data of the second response. A response that is not a
    /// success replaces the first response.
    pub fn followed_by(self, next: CommandResponse) -> CommandResponse {
        match (self, next) {
            (
                CommandResponse::Success { text: first, .. },
                CommandResponse::Success { command, text, data },
            ) => {
                let text = format!("{}\n{text}", first.trim_end());
                CommandResponse::Success { command, text, data }
            }
            (_, next) => next,
        }
    }

    /// Returns the response of a rejected command.
    pub fn rejected(command: &str, refusal: Rejection) -> CommandResponse {
        CommandResponse::Rejected { command: command.to_owned(), rejection: refusal }
    }

    /// Returns the response to a line with a syntax error.
    pub fn syntax_error(problem: impl Into<String>, column: usize) -> CommandResponse {
        CommandResponse::SyntaxError { problem: shorten_long_words(&problem.into()), column, word: None }
    }

    /// Adds the word at the column of a syntax error.
    pub fn with_word_from(self, line: &str) -> CommandResponse {
        let CommandResponse::SyntaxError { problem, column, .. } = self else { return self };
        let bare = |word: &str| word.trim_matches([',', ';', ':', '?', '.']).to_owned();
        let place = word_at(line, column);
        let is_named = problem.split_whitespace().any(|word| bare(word) == bare(&place));
        let place = Some(shorten_long_words(&place)).filter(|_| !is_named);
        CommandResponse::SyntaxError { problem, column, word: place }
    }

    /// Returns whether the command succeeded.
    pub fn is_success(&self) -> bool {
        matches!(self, CommandResponse::Success { .. })
    }

    /// Returns whether the command was rejected because its line could not be written to the record.
    pub fn is_not_saved(&self) -> bool {
        matches!(self, CommandResponse::Rejected { rejection, .. } if rejection.code == "not_saved")
    }

    /// Returns whether the command ends the session.
    pub fn is_quit(&self) -> bool {
        matches!(self, CommandResponse::Quit)
    }

    /// Formats the response as text.
    pub fn to_text(&self) -> String {
        match self {
            CommandResponse::Success { text, .. } => text.clone(),
            CommandResponse::Rejected { rejection: refusal, .. } => {
                let results = match refusal.results.as_slice() {
                    [] | [_] => String::new(),
                    several => format!("\n{}", format_field("results", &json!(several)).trim_end()),
                };
                format!("refused {refusal}{results}")
            }
            CommandResponse::SyntaxError { problem, word: None, .. } => format!("error usage: {problem}"),
            CommandResponse::SyntaxError { problem, word: Some(place), .. } => {
                format!("error usage: at {place}: {problem}")
            }
            CommandResponse::Quit => String::new(),
        }
    }

    /// Converts the response to one JSON object. `line` is the line number, and `day` is the day of the run when the
    /// line was read.
    pub fn to_json(&self, line: u32, day: u32) -> Value {
        match self {
            CommandResponse::Success { command, data, .. } => {
                json!({ "line": line, "command": command, "ok": true, "day": day, "data": data })
            }
            CommandResponse::Rejected { command, rejection: refusal } => {
                let mut object = json!({
                    "line": line,
                    "command": command,
                    "ok": false,
                    "day": day,
                    "code": refusal.code,
                    "field": refusal.field,
                    "error": refusal.message,
                });
                if !refusal.results.is_empty() {
                    object["results"] = json!(refusal.results);
                }
                object
            }
            CommandResponse::SyntaxError { problem, column, .. } => json!({
                "line": line,
                "command": null,
                "ok": false,
                "day": day,
                "code": "usage",
                "column": column,
                "error": problem,
            }),
            CommandResponse::Quit => Value::Null,
        }
    }
}

/// Returns the word at a column of a line, or "the end of the line".
fn word_at(line: &str, column: usize) -> String {
    let from = line.char_indices().nth(column.saturating_sub(1)).map_or(line.len(), |(at, _)| at);
    let word: String = line[from..].split_whitespace().next().unwrap_or_default().chars().take(40).collect();
    if word.is_empty() { "the end of the line".to_owned() } else { word }
}

/// Formats a field of the data as text. A list of objects becomes a table.
fn format_field(name: &str, value: &Value) -> String {
    match value.as_array() {
        Some(list) if !list.is_empty() && list.iter().all(Value::is_object) => {
            let table: String = format_table(list).lines().map(|line| format!("    {line}\n")).collect();
            format!("  {name}:\n{table}")
        }
        _ => format!("  {name}: {value}\n"),
    }
}

fn format_table(list: &[Value]) -> String {
    let objects: Vec<&Map<String, Value>> = list.iter().filter_map(Value::as_object).collect();
    let mut columns: Vec<String> = Vec::new();
    for key in objects.iter().flat_map(|object| object.keys()) {
        if !columns.contains(key) {
            columns.push(key.clone());
        }
    }
    let cell = |object: &Map<String, Value>, column: &String| match object.get(column) {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
    };
    let row = |object: &&Map<String, Value>| columns.iter().map(|column| cell(object, column)).collect();
    let rows: Vec<Vec<String>> = objects.iter().map(row).collect();
    align_columns(&columns, &rows)
}

/// Shortens long words, because an error message quotes the input, which may be a pasted file.
fn shorten_long_words(text: &str) -> String {
    const MAX_WORD_CHARACTERS: usize = 80;
    let cut = |word: &str| match word.char_indices().nth(MAX_WORD_CHARACTERS) {
        Some((end, _)) => format!("{}…", &word[..end]),
        None => word.to_owned(),
    };
    text.split(' ').map(cut).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_database::text::format_result;
    use novamind_database::{Cell, QueryResult};
    use novamind_tools::DealResult;

    #[test]
    fn responses_render_as_text_and_json() {
        let data = json!({"updated": {"A": 12, "B": 25}, "total_per_day": 120});
        let answer = CommandResponse::tool_result("set_prices", data, None);
        assert_eq!(answer.to_text(), "ok set_prices\n  updated: {\"A\":12,\"B\":25}\n  total_per_day: 120\n");
        let refusal = Rejection::for_field("A", "price_not_positive", "price of plan A must be above zero");
        let refused = CommandResponse::rejected("set_prices", refusal);
        assert_eq!(refused.to_text(), "refused price_not_positive (A): price of plan A must be above zero");
        assert_eq!(refused.to_json(4, 0)["field"], "A");
        let wrong = |customer, error: &str| DealResult::Failed {
            customer_id: Some(customer),
            error: error.to_owned(),
        };
        let results = vec![wrong(99, "not found"), wrong(5, "not enterprise")];
        let refusal =
            Rejection { results, ..Rejection::new("customer_not_found", "there is no customer 99") };
        let refused = CommandResponse::rejected("send_enterprise_deal", refusal);
        assert_eq!(
            refused.to_text(),
            "refused customer_not_found: there is no customer 99\n  results:\n    customer_id  error\n    \
             99           not found\n    5            not enterprise"
        );
        let value =
            json!([{"customer_id": 99, "error": "not found"}, {"customer_id": 5, "error": "not enterprise"}]);
        assert_eq!(refused.to_json(4, 0)["results"], value);
        let rows = QueryResult {
            columns: vec!["category".to_owned(), "total".to_owned()],
            rows: vec![vec![Cell::Text("initial_funding".to_owned()), Cell::Real(1_000_000.0)]],
            ..QueryResult::default()
        };
        assert_eq!(format_result(&rows), "category         total\ninitial_funding  1000000.0\n(1 row)\n");
    }

    #[test]
    fn syntax_error_text_names_the_word() {
        let format_error = |problem: &str, column, line: &str| {
            CommandResponse::syntax_error(problem, column).with_word_from(line).to_text()
        };
        assert_eq!(
            format_error("a value is expected", 14, "set_prices A=) B=3"),
            "error usage: at ): a value is expected"
        );
        assert_eq!(
            format_error("a value is missing", 14, "set_prices A="),
            "error usage: at the end of the line: a value is missing"
        );
        assert_eq!(format_error("foo is not a command", 1, "foo 3"), "error usage: foo is not a command");
        assert_eq!(format_error("größe", 9, "größe x ö"), "error usage: at ö: größe");
        assert_eq!(CommandResponse::syntax_error("x", 7).with_word_from("a b").to_json(1, 0)["column"], 7);
    }

    #[test]
    fn lists_of_objects_render_as_tables() {
        let data = json!({"tiers": [{"tier": 1, "name": "a"}, {"tier": 20, "name": "b c"}]});
        let text = CommandResponse::tool_result("list", data, None).to_text();
        assert_eq!(text, "ok list\n  tiers:\n    tier  name\n    1     a\n    20    b c\n");
    }
}
