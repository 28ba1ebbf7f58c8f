//! Parser for the arguments of a line: `name=value` or values alone, with or without commas and brackets
//! (docs/interfaces/plain-mode.md#grammar).

use serde_json::Value;

/// One argument.
#[derive(Debug, Clone, PartialEq)]
pub struct Argument {
    /// Name, if the argument has one.
    pub key: Option<String>,
    /// Value.
    pub value: Value,
    /// Column of its first character, from 1.
    pub column: usize,
}

/// A problem of a line and its column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Description.
    pub text: String,
    /// Column in characters, from 1.
    pub column: usize,
}

impl Argument {
    /// Returns the value as a whole number.
    ///
    /// # Errors
    /// Returns a problem if the value is not a whole number, or if the argument has a name.
    pub fn whole_number(&self) -> Result<u32, Problem> {
        let number = self.value.as_u64().filter(|_| self.key.is_none());
        let number = number.and_then(|number| u32::try_from(number).ok());
        number.ok_or_else(|| Problem { text: "a whole number is expected".to_owned(), column: self.column })
    }
}

impl Problem {
    /// Returns a problem of all arguments together, at the first one.
    pub fn of(arguments: &[Argument], text: &str) -> Problem {
        Problem { text: text.to_owned(), column: arguments.first().map_or(1, |argument| argument.column) }
    }
}

/// A reader of a line from left to right.
pub struct Reader<'a> {
    line: &'a str,
    at: usize,
}

impl<'a> Reader<'a> {
    /// Returns a reader at the start of a line.
    pub fn of(line: &'a str) -> Reader<'a> {
        Reader { line, at: 0 }
    }

    /// Returns the unread part of the line.
    pub fn rest(&self) -> &'a str {
        &self.line[self.at..]
    }

    /// Returns the column of the next character, from 1.
    pub fn column(&self) -> usize {
        self.line[..self.at].chars().count() + 1
    }

    /// Returns a problem in the current column.
    pub fn problem(&self, text: impl Into<String>) -> Problem {
        Problem { text: text.into(), column: self.column() }
    }

    /// Skips blanks.
    pub fn skip_blanks(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    /// Reads a word of letters, digits, dots, dashes and underscores; empty if there is none.
    pub fn word(&mut self) -> String {
        let is_word = |letter: char| letter.is_alphanumeric() || ['_', '.', '-'].contains(&letter);
        let end = self.rest().find(|letter| !is_word(letter)).unwrap_or(self.rest().len());
        let word = self.rest()[..end].to_owned();
        self.at += end;
        word
    }

    /// Reads the arguments up to the end of the line.
    ///
    /// # Errors
    /// Returns the first problem and its column.
    pub fn arguments(&mut self) -> Result<Vec<Argument>, Problem> {
        self.skip_blanks();
        let opened = self.rest().starts_with('(');
        self.at += usize::from(opened);
        let mut arguments: Vec<Argument> = Vec::new();
        let mut after_comma = false;
        loop {
            let before = self.at;
            self.skip_blanks();
            let rest = self.rest();
            let comment = rest.starts_with('#') && (self.at > before || arguments.is_empty());
            if rest.is_empty() || comment {
                return if opened { Err(self.problem("the bracket is not closed")) } else { Ok(arguments) };
            }
            if opened && rest.starts_with(')') {
                self.at += 1;
                return self.nothing_more(arguments);
            }
            if rest.starts_with(',') {
                if arguments.is_empty() || after_comma {
                    return Err(self.problem("put a comma between two arguments"));
                }
                self.at += 1;
                after_comma = true;
                continue;
            }
            let argument = self.argument()?;
            if let Some(key) = &argument.key
                && arguments.iter().any(|other| other.key.as_ref() == Some(key))
            {
                return Err(Problem { text: format!("{key} is given twice"), column: argument.column });
            }
            arguments.push(argument);
            after_comma = false;
        }
    }

    fn nothing_more(&mut self, arguments: Vec<Argument>) -> Result<Vec<Argument>, Problem> {
        self.skip_blanks();
        if self.rest().is_empty() || self.rest().starts_with('#') {
            Ok(arguments)
        } else {
            Err(self.problem("only a comment can follow the closing bracket"))
        }
    }

    fn argument(&mut self) -> Result<Argument, Problem> {
        let (column, start) = (self.column(), self.at);
        let word = self.word();
        self.skip_blanks();
        if !word.is_empty() && self.rest().starts_with('=') {
            self.at += 1;
            self.skip_blanks();
            return Ok(Argument { key: Some(word), value: self.value()?, column });
        }
        self.at = start;
        Ok(Argument { key: None, value: self.value()?, column })
    }

    fn value(&mut self) -> Result<Value, Problem> {
        match self.rest().chars().next() {
            Some('{' | '[' | '"') => self.json(),
            _ => self.bare(),
        }
    }

    fn json(&mut self) -> Result<Value, Problem> {
        let mut values = serde_json::Deserializer::from_str(self.rest()).into_iter::<Value>();
        match values.next() {
            Some(Ok(value)) => {
                self.at += values.byte_offset();
                Ok(value)
            }
            Some(Err(error)) => {
                self.at += offset_of(self.rest(), error.line(), error.column());
                while !self.line.is_char_boundary(self.at) {
                    self.at -= 1;
                }
                let message = error.to_string();
                let message = message.split(" at line ").next().unwrap_or_default();
                Err(self.problem(format!("the value is not JSON: {message}")))
            }
            None => Err(self.problem("a value is missing")),
        }
    }

    fn bare(&mut self) -> Result<Value, Problem> {
        let ends = |letter: char| letter.is_whitespace() || ",=#\"()[]{}".contains(letter);
        let end = self.rest().find(ends).unwrap_or(self.rest().len());
        if end == 0 {
            return Err(match self.rest().chars().next() {
                Some(letter) => self.problem(format!("a value is expected, not {letter}")),
                None => self.problem("a value is missing"),
            });
        }
        let text = &self.rest()[..end];
        self.at += end;
        Ok(plain_value(text))
    }
}

/// Returns the value of an unquoted word: null, true, false, a number (such as 1_000_000), otherwise a string.
fn plain_value(text: &str) -> Value {
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

/// Returns the byte offset of serde_json's line and column.
fn offset_of(text: &str, line: usize, column: usize) -> usize {
    let before: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    (before + column.saturating_sub(1)).min(text.len())
}
