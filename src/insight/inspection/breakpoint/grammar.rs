//! The syntax of conditions (docs/debugging.md#breakpoints).

use std::str::FromStr;

use super::condition::{ComparisonOperator, Condition, Direction, WorldEvent};
use super::measure::{Measure, MeasureKind, Quantity, QuantityError};
use novamind_base::similar_names;
use novamind_world::identifiers::Group;

/// A syntax error in a condition, with its position.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConditionParseError {
    /// Error message, which names the expected syntax.
    pub message: String,
    /// Column of the error in the text, in characters from 1.
    pub column: usize,
}

/// A word or an operator of a condition.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Token<'a> {
    text: &'a str,
    column: usize,
}

/// A cursor over the tokens of a condition. `#` starts a comment.
pub(crate) struct TokenReader<'a> {
    tokens: Vec<Token<'a>>,
    at: usize,
    end: usize,
}

impl<'a> TokenReader<'a> {
    pub(crate) fn new(text: &'a str) -> TokenReader<'a> {
        let text = text.split('#').next().unwrap_or_default().trim_end();
        let (mut tokens, mut rest, mut column) = (Vec::new(), text, 1);
        while let Some(first) = rest.chars().next() {
            let length = token_length(rest, first);
            let (token, behind) = rest.split_at(length);
            if !first.is_whitespace() {
                tokens.push(Token { text: token, column });
            }
            column += token.chars().count();
            rest = behind;
        }
        TokenReader { tokens, at: 0, end: column }
    }

    fn next(&mut self) -> Option<Token<'a>> {
        let token = self.tokens.get(self.at).copied();
        self.at += usize::from(token.is_some());
        token
    }

    fn next_if(&mut self, text: &str) -> bool {
        let fits = self.tokens.get(self.at).is_some_and(|token| token.text.eq_ignore_ascii_case(text));
        self.at += usize::from(fits);
        fits
    }

    fn error_at(&self, token: Option<Token<'_>>, message: impl Into<String>) -> ConditionParseError {
        ConditionParseError { message: message.into(), column: token.map_or(self.end, |token| token.column) }
    }

    /// Reads the next word, which must be one of the listed names. The error message suggests similar names.
    fn expect_one_of<T: Copy>(
        &mut self,
        known: &[T],
        id: impl Fn(T) -> &'static str,
        what: &str,
    ) -> Result<(T, Token<'a>), ConditionParseError> {
        let token = self.next();
        let Some(word) = token else {
            let ids: Vec<&str> = known.iter().map(|choice| id(*choice)).collect();
            return Err(self.error_at(None, format!("{what} is missing: {}", ids.join(", "))));
        };
        let name = word.text.to_lowercase().replace('-', "_");
        let found = known.iter().find(|choice| id(**choice).eq_ignore_ascii_case(&name));
        found.map(|found| (*found, word)).ok_or_else(|| {
            let ids: Vec<&str> = known.iter().map(|choice| id(*choice)).collect();
            let near = similar_names(&name, ids.iter().copied());
            let help = match near.is_empty() {
                true => format!("choose one of {}", ids.join(", ")),
                false => format!("did you mean {}?", near.join(" or ")),
            };
            self.error_at(token, format!("{} is not {what}; {help}", word.text))
        })
    }

    /// Reads a group in parentheses, for example `(S1)`, if the next token is an opening parenthesis.
    pub(crate) fn parse_group(&mut self) -> Result<Option<Group>, ConditionParseError> {
        if !self.next_if("(") {
            return Ok(None);
        }
        if let Some(bracket) = self.tokens.get(self.at).copied().filter(|token| token.text == ")") {
            return Err(
                self.error_at(Some(bracket), "a group is missing between the brackets, for example (S1)")
            );
        }
        let groups: Vec<Group> = Group::all().collect();
        let (group, _) = self.expect_one_of(&groups, Group::id, "a group")?;
        match self.next_if(")") {
            true => Ok(Some(group)),
            false => Err(self.error_at(self.tokens.get(self.at).copied(), "a closing bracket is missing")),
        }
    }

    /// Reads a name that must be in a list. Returns the name with its column.
    pub(crate) fn parse_name<T: Copy>(
        &mut self,
        known: &[T],
        id: impl Fn(T) -> &'static str,
        what: &str,
    ) -> Result<(T, usize), ConditionParseError> {
        self.expect_one_of(known, id, what).map(|(found, token)| (found, token.column))
    }

    /// Reads a whole number. Returns `None` if no token is left.
    pub(crate) fn parse_whole_number(&mut self) -> Result<Option<u32>, ConditionParseError> {
        let Some(token) = self.next() else { return Ok(None) };
        let number = token.text.parse().map(Some);
        number.map_err(|_| {
            self.error_at(Some(token), format!("a whole number is expected, not {}", token.text))
        })
    }

    /// Checks that no token is left.
    pub(crate) fn expect_end(&mut self) -> Result<(), ConditionParseError> {
        match self.next() {
            None => Ok(()),
            Some(token) => Err(self.error_at(Some(token), format!("unexpected {} at the end", token.text))),
        }
    }

    /// Reads the optional number of days, for example ` over 7`.
    fn parse_day_count(&mut self) -> Result<Option<(u32, usize)>, ConditionParseError> {
        let column = self.tokens.get(self.at).map_or(self.end, |token| token.column);
        if !self.next_if("over") {
            return Ok(None);
        }
        let days = self.parse_whole_number()?;
        let days =
            days.ok_or_else(|| self.error_at(None, "\"over\" needs a number of days, for example: over 7"))?;
        let _ = self.next_if("days") || self.next_if("day");
        Ok(Some((days, column)))
    }

    /// Reads a number: `0.05`, `5%` or `1_000_000`.
    fn parse_number(&mut self) -> Result<f64, ConditionParseError> {
        let token = self.next();
        let Some(word) = token else { return Err(self.error_at(None, "a number is missing")) };
        let is_grouped =
            word.text.split('_').all(|digits| digits.starts_with(|digit: char| digit.is_ascii_digit()));
        let plain = if is_grouped { word.text.replace('_', "") } else { word.text.to_owned() };
        let (digits, unit) = plain.strip_suffix('%').map_or((plain.as_str(), 1.0), |digits| (digits, 100.0));
        let number = digits.parse::<f64>().ok().filter(|number| number.is_finite());
        number
            .map(|number| number / unit)
            .ok_or_else(|| self.error_at(token, format!("a number is expected, not {}", word.text)))
    }
}

/// Returns the length of the first token of `text`, in bytes.
fn token_length(text: &str, first: char) -> usize {
    let is_word = |letter: char| letter.is_alphanumeric() || "_.-+%".contains(letter);
    let is_sign = |letter: char| "<>=".contains(letter);
    let length_while =
        |belongs: &dyn Fn(char) -> bool| text.find(|letter| !belongs(letter)).unwrap_or(text.len());
    match first {
        _ if first.is_whitespace() => length_while(&char::is_whitespace),
        _ if is_word(first) => length_while(&is_word),
        _ if is_sign(first) => length_while(&is_sign),
        _ => first.len_utf8(),
    }
}

impl FromStr for Condition {
    type Err = ConditionParseError;

    /// Parses a condition: `churn(S1) > 0.05 over 7`, `reputation(S3) falls` or `event rival`.
    fn from_str(text: &str) -> Result<Condition, ConditionParseError> {
        let mut words = TokenReader::new(text);
        let condition = match words.next_if("event") {
            true => Condition::Event(words.parse_name(&WorldEvent::ALL, WorldEvent::id, "an event")?.0),
            false => parse_figure_condition(&mut words)?,
        };
        words.expect_end()?;
        Ok(condition)
    }
}

enum FigurePredicate {
    Compared(ComparisonOperator, f64),
    Changed(Direction),
}

/// Parses a condition on a figure. The number of days can follow the figure or the comparison.
fn parse_figure_condition(words: &mut TokenReader<'_>) -> Result<Condition, ConditionParseError> {
    let (measure, column) = words.parse_name(Measure::ALL, Measure::id, "a figure")?;
    let group = words.parse_group()?;
    let early = words.parse_day_count()?;
    let predicate = parse_predicate(words)?;
    check_share_threshold(measure, &predicate, column)?;
    let days = match early {
        Some(days) => Some(days),
        None => words.parse_day_count()?,
    };
    let quantity = Quantity::new(measure, group, days.map(|(days, _)| days)).map_err(|no| {
        let column = match no {
            QuantityError::CompanyOnly | QuantityError::GroupOnly => column,
            QuantityError::NotSummable | QuantityError::DaysOutOfRange => {
                days.map_or(column, |(_, column)| column)
            }
        };
        ConditionParseError { message: describe_quantity_error(measure.id(), no), column }
    })?;
    Ok(match predicate {
        FigurePredicate::Compared(relation, threshold) => Condition::Compared(quantity, relation, threshold),
        FigurePredicate::Changed(direction) => Condition::Changed(quantity, direction),
    })
}

/// Describes why a figure is invalid, and how to write a valid figure.
pub(crate) fn describe_quantity_error(id: &str, no: QuantityError) -> String {
    match no {
        QuantityError::CompanyOnly => {
            format!("{id} is a figure of the whole company; write {id} without a group")
        }
        QuantityError::GroupOnly => format!("{id} is a figure of a group; write, for example, {id}(S1)"),
        QuantityError::NotSummable => {
            format!("{id} is a value of one day; \"over\" applies only to sums and shares")
        }
        QuantityError::DaysOutOfRange => format!("\"over\" needs 1 to {} days", Quantity::MAX_DAYS),
    }
}

fn parse_predicate(words: &mut TokenReader<'_>) -> Result<FigurePredicate, ConditionParseError> {
    let token = words.next();
    let relation = match token.map(|token| token.text) {
        Some(">") => ComparisonOperator::Above,
        Some(">=") => ComparisonOperator::AtLeast,
        Some("<") => ComparisonOperator::Below,
        Some("<=") => ComparisonOperator::AtMost,
        Some(word) if word.eq_ignore_ascii_case("rises") => {
            return Ok(FigurePredicate::Changed(Direction::Rises));
        }
        Some(word) if word.eq_ignore_ascii_case("falls") => {
            return Ok(FigurePredicate::Changed(Direction::Falls));
        }
        other => {
            let not = other.map_or(String::new(), |word| format!(", not {word}"));
            let message = format!("one of > >= < <= rises falls is expected{not}");
            return Err(words.error_at(token, message));
        }
    };
    words.parse_number().map(|threshold| FigurePredicate::Compared(relation, threshold))
}

/// Rejects a threshold above 1 for a share. The user probably meant a percentage.
fn check_share_threshold(
    measure: Measure,
    predicate: &FigurePredicate,
    column: usize,
) -> Result<(), ConditionParseError> {
    match (measure.kind(), predicate) {
        (MeasureKind::Share(_), FigurePredicate::Compared(_, threshold)) if threshold.abs() > 1.0 => {
            let message = format!("{} is a share from 0 to 1; write {threshold}%", measure.id());
            Err(ConditionParseError { message, column })
        }
        _ => Ok(()),
    }
}
