//! Parser for the arguments of a command line in plain mode: `name=value` or bare values, with or without commas and
//! parentheses (docs/interfaces/plain-mode.md#grammar).

use serde_json::Value;

/// One argument of a command line.
#[derive(Debug, Clone, PartialEq)]
pub struct Argument {
    /// Name of the argument, or `None` for a bare value.
    pub key: Option<String>,
    /// Value as JSON; a bare word is a string.
    pub value: Value,
    /// Column of the argument's first character, counted from 1.
    pub column: usize,
}

/// A syntax error in a command line, with its column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParseError {
    /// Description of the error.
    pub text: String,
    /// Column of the error in characters, counted from 1.
    pub column: usize,
}

impl Argument {
    /// Returns the value as a whole number.
    ///
    /// # Errors
    /// Returns a parse error if the value is not a whole number, or if the argument has a name.
    pub fn as_u32(&self) -> Result<u32, ParseError> {
        let number = self.value.as_u64().filter(|_| self.key.is_none());
        let number = number.and_then(|number| u32::try_from(number).ok());
        number
            .ok_or_else(|| ParseError { text: "a whole number is expected".to_owned(), column: self.column })
    }
}

impl ParseError {
    /// Creates an error that concerns all arguments and points to the first argument.
    pub fn at_first_argument(arguments: &[Argument], text: &str) -> ParseError {
        ParseError { text: text.to_owned(), column: arguments.first().map_or(1, |argument| argument.column) }
    }
}

/// A parser that reads a command line from left to right.
pub struct LineParser<'a> {
    line: &'a str,
    position: usize,
}

impl<'a> LineParser<'a> {
    /// Creates a parser at the start of a line.
    pub fn new(line: &'a str) -> LineParser<'a> {
        LineParser { line, position: 0 }
    }

    /// Returns the unread part of the line.
    pub fn remaining(&self) -> &'a str {
        &self.line[self.position..]
    }

    /// Returns the column of the next character, counted from 1.
    pub fn column(&self) -> usize {
        self.line[..self.position].chars().count() + 1
    }

    /// Creates an error at the current column.
    pub fn error_here(&self, text: impl Into<String>) -> ParseError {
        ParseError { text: text.into(), column: self.column() }
    }

    /// Skips whitespace.
    pub fn skip_whitespace(&mut self) {
        self.position += self.remaining().len() - self.remaining().trim_start().len();
    }

    /// Parses a word of letters, digits, dots, hyphens and underscores. Returns an empty string if the next character
    /// is none of these.
    pub fn parse_word(&mut self) -> String {
        let is_word = |letter: char| letter.is_alphanumeric() || ['_', '.', '-'].contains(&letter);
        let end = self.remaining().find(|letter| !is_word(letter)).unwrap_or(self.remaining().len());
        let word = self.remaining()[..end].to_owned();
        self.position += end;
        word
    }

    /// Parses the arguments up to the end of the line.
    ///
    /// # Errors
    /// Returns the first syntax error and its column.
    pub fn parse_arguments(&mut self) -> Result<Vec<Argument>, ParseError> {
        self.skip_whitespace();
        let has_parenthesis = self.remaining().starts_with('(');
        self.position += usize::from(has_parenthesis);
        let mut arguments: Vec<Argument> = Vec::new();
        let mut after_comma = false;
        loop {
            let before = self.position;
            self.skip_whitespace();
            let rest = self.remaining();
            let comment = rest.starts_with('#') && (self.position > before || arguments.is_empty());
            if rest.is_empty() || comment {
                return if has_parenthesis {
                    Err(self.error_here("the opening parenthesis is not closed"))
                } else {
                    Ok(arguments)
                };
            }
            if has_parenthesis && rest.starts_with(')') {
                self.position += 1;
                return self.expect_end(arguments);
            }
            if rest.starts_with(',') {
                if arguments.is_empty() || after_comma {
                    return Err(self.error_here("put a comma between two arguments"));
                }
                self.position += 1;
                after_comma = true;
                continue;
            }
            let argument = self.parse_argument()?;
            if let Some(key) = &argument.key
                && arguments.iter().any(|other| other.key.as_ref() == Some(key))
            {
                return Err(ParseError { text: format!("{key} is given twice"), column: argument.column });
            }
            arguments.push(argument);
            after_comma = false;
        }
    }

    fn expect_end(&mut self, arguments: Vec<Argument>) -> Result<Vec<Argument>, ParseError> {
        self.skip_whitespace();
        if self.remaining().is_empty() || self.remaining().starts_with('#') {
            Ok(arguments)
        } else {
            Err(self.error_here("only a comment can follow the closing parenthesis"))
        }
    }

    fn parse_argument(&mut self) -> Result<Argument, ParseError> {
        let (column, start) = (self.column(), self.position);
        let word = self.parse_word();
        self.skip_whitespace();
        if !word.is_empty() && self.remaining().starts_with('=') {
            self.position += 1;
            self.skip_whitespace();
            return Ok(Argument { key: Some(word), value: self.parse_value()?, column });
        }
        self.position = start;
        Ok(Argument { key: None, value: self.parse_value()?, column })
    }

    fn parse_value(&mut self) -> Result<Value, ParseError> {
        match self.remaining().chars().next() {
            Some('{' | '[' | '"') => self.parse_json(),
            _ => self.parse_bare_value(),
        }
    }

    fn parse_json(&mut self) -> Result<Value, ParseError> {
        let mut values = serde_json::Deserializer::from_str(self.remaining()).into_iter::<Value>();
        match values.next() {
            Some(Ok(value)) => {
                self.position += values.byte_offset();
                Ok(value)
            }
            Some(Err(error)) => {
                self.position += byte_offset(self.remaining(), error.line(), error.column());
                while !self.line.is_char_boundary(self.position) {
                    self.position -= 1;
                }
                let message = error.to_string();
                let message = message.split(" at line ").next().unwrap_or_default();
                Err(self.error_here(format!("the value is not JSON: {message}")))
            }
            None => Err(self.error_here("a value is missing")),
        }
    }

    fn parse_bare_value(&mut self) -> Result<Value, ParseError> {
        let ends = |letter: char| letter.is_whitespace() || ",=#\"()[]{}".contains(letter);
        let end = self.remaining().find(ends).unwrap_or(self.remaining().len());
        if end == 0 {
            return Err(match self.remaining().chars().next() {
                Some(letter) => self.error_here(format!("a value is expected, not {letter}")),
                None => self.error_here("a value is missing"),
            });
        }
        let text = &self.remaining()[..end];
        self.position += end;
        Ok(scalar_from_text(text))
    }
}

/// Converts an unquoted word to JSON: null, true, false, a number (such as 1_000_000), or otherwise a string.
fn scalar_from_text(text: &str) -> Value {
    let digits = text.replace('_', "");
    let json = digits.strip_prefix('+').unwrap_or(&digits);
    match text {
        "null" => Value::Null,
        "true" => Value::Bool(true),
        "false" => Value::Bool(false),
        _ => match serde_json::from_str::<Value>(json) {
            Ok(number) if number.is_number() => number,
            _ => text.into(),
        },
    }
}

/// Converts the line and column of a serde_json error to a byte offset.
fn byte_offset(text: &str, line: usize, column: usize) -> usize {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    (before + column.saturating_sub(1)).min(text.len())
}
