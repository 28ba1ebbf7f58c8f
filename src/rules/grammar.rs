//! Parses rules (docs/interfaces/rules.md#grammar).

use super::condition::{Comparison, Condition, FIELDS, Field, Value};
use super::thread::ThreadContext;
use novamind_base::similar_names;
use novamind_session::identifiers::Plan;

const MAX_OFFER_LINES: usize = 3;
/// Enterprise groups that are known in every run. The ids of discovered enterprise groups start with `D_E`.
const INITIAL_GROUPS: [&str; 3] = ["E1", "E2", "E3"];
/// Types of threads that can wait for a reply.
const THREAD_TYPES: [&str; 4] = ["new_lead", "churn_prevention", "plan_change", "renegotiation"];

/// A rule: conditions and the action for threads that meet all conditions.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Source text of the rule.
    pub text: String,
    pub(super) conditions: Vec<Condition>,
    pub(super) action: Action,
}

impl Rule {
    pub(super) fn matches(&self, thread: &ThreadContext) -> bool {
        self.conditions.iter().all(|condition| condition.is_satisfied(thread))
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Action {
    Offer(Vec<OfferLine>),
    Accept,
    Reject,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OfferLine {
    /// Offered plan; `None` if the line offers the plan that the enterprise asked for.
    pub(super) plan: Option<Plan>,
    pub(super) price: Price,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Price {
    Dollars(f64),
    Asked(f64),
    List(f64),
    Last(f64),
}

/// A syntax error in rules.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RuleError {
    /// Description of the error, with suggestions of similar names.
    pub text: String,
    /// Column of the error in characters, counted from 1.
    pub column: usize,
}

/// Parses rules, which are separated by semicolons or line ends.
///
/// # Errors
/// Returns the first problem and its column.
pub fn parse(text: &str) -> Result<Vec<Rule>, RuleError> {
    let tokens = tokenize(text)?;
    let mut reader = RuleParser { text, tokens: &tokens, at: 0 };
    let mut rules = Vec::new();
    loop {
        while reader.accept(";") {}
        if reader.is_at_end() {
            break;
        }
        rules.push(reader.parse_rule()?);
        if !reader.is_at_end() && !reader.accept(";") {
            return Err(reader.error_at_current_token("the rule ends here: separate rules with `;`"));
        }
    }
    match rules.is_empty() {
        true => Err(reader
            .error_at_current_token("a rule is expected, for example `offer where asked is null: B 85`")),
        false => Ok(rules),
    }
}

/// Parses conditions that are not part of a rule, in the form that follows `where` in a rule.
pub(super) fn parse_conditions(text: &str) -> Result<Vec<Condition>, RuleError> {
    let tokens = tokenize(text)?;
    let mut reader = RuleParser { text, tokens: &tokens, at: 0 };
    if reader.is_at_end() {
        return Err(reader.error_at_current_token("a condition is expected, for example `seats >= 500`"));
    }
    let conditions = reader.parse_joined_conditions()?;
    match reader.is_at_end() {
        true => Ok(conditions),
        false => Err(reader.error_at_current_token("the condition ends here: join conditions with `and`")),
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Token {
    text: String,
    start: usize,
    end: usize,
}

fn column(text: &str, at: usize) -> usize {
    text[..at].chars().count() + 1
}

fn tokenize(text: &str) -> Result<Vec<Token>, RuleError> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(letter) = text[at..].chars().next() {
        let rest = &text[at..];
        let is_word = |letter: char| letter.is_alphanumeric() || ['_', '.'].contains(&letter);
        let length = match letter {
            '\n' | ';' => 1,
            _ if letter.is_whitespace() || letter == '$' => {
                at += letter.len_utf8();
                continue;
            }
            '"' | '\'' => match rest[1..].find(letter) {
                Some(end) => end + 2,
                None => {
                    let message = "the quotation mark is not closed".to_owned();
                    return Err(RuleError { text: message, column: column(text, at) });
                }
            },
            _ if is_word(letter) => rest.find(|next| !is_word(next)).unwrap_or(rest.len()),
            _ => {
                let two = ["<=", ">=", "!=", "<>", "=="].into_iter().find(|two| rest.starts_with(two));
                match two {
                    Some(two) => two.len(),
                    None if "<>=:,*()-".contains(letter) => 1,
                    None => {
                        let message = format!("unexpected character {letter}");
                        return Err(RuleError { text: message, column: column(text, at) });
                    }
                }
            }
        };
        let word = &rest[..length];
        let token_text = if word == "\n" { ";" } else { word.trim_matches(['"', '\'']) };
        tokens.push(Token { text: token_text.to_owned(), start: at, end: at + length });
        at += length;
    }
    Ok(tokens)
}

struct RuleParser<'a> {
    text: &'a str,
    tokens: &'a [Token],
    at: usize,
}

impl RuleParser<'_> {
    fn peek(&self) -> Option<&str> {
        self.tokens.get(self.at).map(|token| token.text.as_str())
    }

    fn is_at_end(&self) -> bool {
        self.at == self.tokens.len()
    }

    fn accept(&mut self, word: &str) -> bool {
        let found = self.peek().is_some_and(|text| text.eq_ignore_ascii_case(word));
        self.at += usize::from(found);
        found
    }

    fn next_word(&mut self) -> Option<String> {
        let text = self.peek()?.to_owned();
        self.at += 1;
        Some(text)
    }

    fn error_at_current_token(&self, text: impl Into<String>) -> RuleError {
        let at = self.tokens.get(self.at).map_or(self.text.len(), |token| token.start);
        RuleError { text: text.into(), column: column(self.text, at) }
    }

    /// Steps back by one token and returns an error there.
    fn error_at_previous(&mut self, text: impl Into<String>) -> RuleError {
        self.at -= 1;
        self.error_at_current_token(text)
    }

    fn parse_rule(&mut self) -> Result<Rule, RuleError> {
        let from = self.at;
        let action = self.next_word().unwrap_or_default().to_lowercase();
        let known = ["offer", "accept", "reject"];
        if !known.contains(&action.as_str()) {
            let near = suggestion(similar_names(&action, known.into_iter()), &known);
            return Err(self.error_at_previous(format!("unknown action {action}; {near}")));
        }
        let conditions = self.parse_where(&action)?;
        let action = match action.as_str() {
            "offer" => Action::Offer(self.parse_offer_lines()?),
            "accept" => Action::Accept,
            _ => Action::Reject,
        };
        let (first, last) = (&self.tokens[from], &self.tokens[self.at - 1]);
        Ok(Rule { text: self.text[first.start..last.end].to_owned(), conditions, action })
    }

    fn parse_where(&mut self, action: &str) -> Result<Vec<Condition>, RuleError> {
        if self.accept("rest") || self.accept("all") {
            return Ok(Vec::new());
        }
        let named = self.accept("where");
        match self.peek() {
            None | Some(";") => {
                return Err(self.error_at_current_token(format!(
                    "`{action}` needs a condition, or `rest` for all other threads"
                )));
            }
            Some(":") if !named => {
                return Err(self.error_at_current_token(
                    "a condition is missing: use `where …`, or `rest` for all other threads",
                ));
            }
            _ => {}
        }
        self.parse_joined_conditions()
    }

    fn parse_joined_conditions(&mut self) -> Result<Vec<Condition>, RuleError> {
        let mut conditions = vec![self.parse_condition()?];
        while self.accept("and") {
            conditions.push(self.parse_condition()?);
        }
        match self.peek() {
            Some(word) if word.eq_ignore_ascii_case("or") => Err(self.error_at_current_token(
                "`or` is not supported: conditions are joined with `and`; use `in (…)` for one of several \
                 values, or write a separate rule",
            )),
            _ => Ok(conditions),
        }
    }

    fn parse_condition(&mut self) -> Result<Condition, RuleError> {
        let Some(name) = self.next_word() else {
            return Err(self.error_at_current_token("a condition is missing"));
        };
        let lower = name.to_lowercase();
        let Some((_, field)) = FIELDS.into_iter().find(|(known, _)| *known == lower) else {
            let names: Vec<&str> = FIELDS.iter().map(|(name, _)| *name).collect();
            let near = suggestion(similar_names(&lower, names.iter().copied()), &names);
            return Err(self.error_at_previous(format!("unknown field {name}; {near}")));
        };
        if self.accept("is") {
            let is_negated = self.accept("not");
            if !self.accept("null") {
                return Err(
                    self.error_at_current_token("`null` is expected: write `is null` or `is not null`")
                );
            }
            return Ok(if is_negated { Condition::IsPresent(field) } else { Condition::IsNull(field) });
        }
        if self.accept("in") {
            return self.parse_list_condition(field);
        }
        let comparison = self.parse_comparison(field)?;
        if self.accept("null") {
            let is = if comparison == Comparison::NotEqual { "is not" } else { "is" };
            return Err(
                self.error_at_previous(format!("`null` cannot be compared: write `{lower} {is} null`"))
            );
        }
        let value = self.parse_value(field)?;
        self.reject_comma_in_number()?;
        Ok(Condition::Compared(field, comparison, value))
    }

    /// Rejects a number such as `1,000`, whose comma would be read as a separator.
    fn reject_comma_in_number(&mut self) -> Result<(), RuleError> {
        let [number, comma, more, ..] = &self.tokens[self.at.saturating_sub(1)..] else { return Ok(()) };
        let is_digits = |token: &Token| token.text.chars().all(|letter| letter.is_ascii_digit());
        let adjacent = number.end == comma.start && comma.end == more.start;
        if comma.text != "," || !adjacent || !is_digits(number) || !is_digits(more) {
            return Ok(());
        }
        let written = format!("{},{}", number.text, more.text);
        let plain = format!("{}{}", number.text, more.text);
        Err(self.error_at_previous(format!(
            "{written} has a comma: write {plain} or {}_{}",
            number.text, more.text
        )))
    }

    fn parse_comparison(&mut self, field: Field) -> Result<Comparison, RuleError> {
        use Comparison::{AtLeast, AtMost, Equal, Less, More, NotEqual};
        let comparison = match self.peek() {
            Some("=" | "==") => Equal,
            Some("!=" | "<>") => NotEqual,
            Some("<") => Less,
            Some("<=") => AtMost,
            Some(">") => More,
            Some(">=") => AtLeast,
            _ => {
                return Err(self.error_at_current_token(
                    "a comparison is expected: `=`, `!=`, `<`, `<=`, `>`, `>=`, `in` or `is null`",
                ));
            }
        };
        if field.is_word() && !matches!(comparison, Equal | NotEqual) {
            return Err(self.error_at_current_token("words can only be compared with `=` or `!=`"));
        }
        self.at += 1;
        Ok(comparison)
    }

    fn parse_list_condition(&mut self, field: Field) -> Result<Condition, RuleError> {
        if !self.accept("(") {
            return Err(self.error_at_current_token("a list is expected, for example `in (E1, E2)`"));
        }
        let mut values = vec![self.parse_value(field)?];
        while self.accept(",") {
            values.push(self.parse_value(field)?);
        }
        if !self.accept(")") {
            return Err(self.error_at_current_token("the parenthesis of the list is not closed"));
        }
        Ok(Condition::OneOf(field, values))
    }

    fn parse_value(&mut self, field: Field) -> Result<Value, RuleError> {
        if !field.is_word() {
            return Ok(Value::Number(self.parse_number()?));
        }
        let Some(word) = self.next_word() else {
            return Err(self.error_at_current_token("a value is missing"));
        };
        // Any group that begins with `D_E` is accepted, so that errors do not reveal which undiscovered groups exist.
        let word = if field == Field::Group { word.to_uppercase() } else { word };
        if word.starts_with("D_E") {
            return Ok(Value::Word(word));
        }
        let known: Vec<&str> = match field {
            Field::Group => INITIAL_GROUPS.to_vec(),
            Field::AskedPlan => Plan::ALL.map(Plan::id).to_vec(),
            _ => THREAD_TYPES.to_vec(),
        };
        match known.iter().find(|known| known.eq_ignore_ascii_case(&word)) {
            Some(known) => Ok(Value::Word((*known).to_owned())),
            None => {
                let near = suggestion(similar_names(&word, known.iter().copied()), &known);
                Err(self.error_at_previous(format!("unknown value {word}; {near}")))
            }
        }
    }

    fn parse_number(&mut self) -> Result<f64, RuleError> {
        let Some(word) = self.next_word() else {
            return Err(self.error_at_current_token("a number is missing"));
        };
        match word.replace('_', "").parse::<f64>().ok().filter(|number| number.is_finite()) {
            Some(number) => Ok(number),
            None => Err(self.error_at_previous(format!("a number is expected, not {word}"))),
        }
    }

    fn parse_offer_lines(&mut self) -> Result<Vec<OfferLine>, RuleError> {
        if !self.accept(":") {
            return Err(self.error_at_current_token("a colon and an offer are missing, for example `: B 85`"));
        }
        let mut lines = vec![self.parse_offer_line()?];
        while self.accept(",") {
            if lines.len() == MAX_OFFER_LINES {
                return Err(
                    self.error_at_current_token(format!("an offer has at most {MAX_OFFER_LINES} plans"))
                );
            }
            lines.push(self.parse_offer_line()?);
        }
        Ok(lines)
    }

    fn parse_offer_line(&mut self) -> Result<OfferLine, RuleError> {
        let Some(word) = self.next_word() else {
            return Err(self.error_at_current_token("a plan and a price are missing"));
        };
        let plan = match Plan::parse(&word.to_uppercase()) {
            Some(plan) => Some(plan),
            None if word.eq_ignore_ascii_case("asked_plan") => None,
            None => {
                return Err(
                    self.error_at_previous(format!("unknown plan {word}: use `A`, `B`, `C` or `asked_plan`"))
                );
            }
        };
        let price = self.parse_price()?;
        self.reject_comma_in_number()?;
        Ok(OfferLine { plan, price })
    }

    fn parse_price(&mut self) -> Result<Price, RuleError> {
        const NAMES: [&str; 3] = ["asked", "list", "last_offer"];
        let Some(word) = self.peek().map(str::to_lowercase) else {
            return Err(self.error_at_current_token("a price is missing"));
        };
        if !word.starts_with(char::is_alphabetic) {
            let price = self.parse_number()?;
            return if price > 0.0 {
                Ok(Price::Dollars(price))
            } else {
                Err(self.error_at_previous("the price must be above 0"))
            };
        }
        if !NAMES.contains(&word.as_str()) {
            let near = suggestion(similar_names(&word, NAMES.into_iter()), &NAMES);
            return Err(self.error_at_current_token(format!("unknown price {word}: use dollars, or {near}")));
        }
        self.at += 1;
        let factor = if self.accept("*") { self.parse_number()? } else { 1.0 };
        if factor <= 0.0 {
            return Err(self.error_at_previous("the factor must be above 0"));
        }
        Ok(match word.as_str() {
            "asked" => Price::Asked(factor),
            "list" => Price::List(factor),
            _ => Price::Last(factor),
        })
    }
}

/// Returns a suggestion of similar names, or a list of the known names if none is similar.
fn suggestion(near: Vec<&str>, known: &[&str]) -> String {
    match near.is_empty() {
        true => format!("known: {}", known.join(", ")),
        false => format!("did you mean {}?", near.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn parse_accepts_all_rule_forms() {
        let text = "offer where group = E2 and asked is null: b $85, asked_plan asked*0.95, C list * 0.9;\n\
                    accept asked >= 18\nreject rest";
        let rules = parse(text).expect("rules");
        let words: Vec<&str> = rules.iter().map(|rule| rule.text.as_str()).collect();
        assert_eq!(words[1..], ["accept asked >= 18", "reject rest"]);
        assert!(words[0].starts_with("offer where") && words[0].ends_with("0.9"));
        let line = |plan, price| OfferLine { plan, price };
        let lines = vec![
            line(Some(Plan::B), Price::Dollars(85.0)),
            line(None, Price::Asked(0.95)),
            line(Some(Plan::C), Price::List(0.9)),
        ];
        assert_eq!(rules[0].action, Action::Offer(lines));
        assert_eq!(rules[0].conditions.len(), 2);
        assert!(rules[2].conditions.is_empty() && rules[2].action == Action::Reject);
        assert_eq!(parse("accept rest;;").expect("one").len(), 1);
    }

    #[test]
    fn errors_name_column_and_similar_words() {
        for (text, column, part) in [
            ("", 1, "a rule is expected"),
            ("ofer rest: B 3", 1, "did you mean offer"),
            ("offer where grup = E2: B 3", 13, "did you mean group"),
            ("offer where group = E9: B 3", 21, "did you mean"),
            ("offer where type = new: B 3", 20, "new_lead"),
            ("offer where group > E1: B 3", 19, "`=` or `!=`"),
            ("offer rest", 11, "colon"),
            ("offer: B 3", 6, "`rest` for all other threads"),
            ("offer rest: D 3", 13, "unknown plan"),
            ("offer rest: B -3", 15, "number is expected"),
            ("offer rest: B 0", 15, "above 0"),
            ("offer rest: B aked*2", 15, "did you mean asked"),
            ("offer rest: A 1, B 2, C 3, A 4", 28, "at most 3"),
            ("accept", 7, "needs a condition"),
            ("accept asked 18", 14, "comparison"),
            ("accept asked >= x", 17, "number is expected"),
            ("accept asked is 3", 17, "null"),
            ("accept seats in 3", 17, "list"),
            ("reject rest reject rest", 13, "separate rules with `;`"),
            ("reject where größe > 3", 14, "unknown field"),
            ("reject where seats ? 3", 20, "unexpected character"),
            ("reject where seats < 1,000", 22, "write 1000 or 1_000"),
            ("offer rest: B 1,000", 15, "write 1000 or 1_000"),
            ("offer where asked = null: B 3", 21, "write `asked is null`"),
            ("offer where asked != null: B 3", 22, "write `asked is not null`"),
            ("reject where seats < 3 or group = E1", 24, "joined with `and`"),
        ] {
            let problem = parse(text).expect_err(text);
            assert_eq!(problem.column, column, "{text}: {problem:?}");
            assert!(problem.text.contains(part), "{text}: {problem:?}");
        }
    }

    #[test]
    fn suggestions_omit_undiscovered_groups() {
        let problem = parse("accept group = D_S0").expect_err("not an enterprise group");
        assert!(problem.text.ends_with("known: E1, E2, E3"), "{problem:?}");
        for group in ["D_E01", "d_e99"] {
            assert!(parse(&format!("accept group = {group}")).is_ok(), "{group}");
        }
    }

    proptest! {
        #[test]
        fn parse_never_panics_on_any_text(text in "\\PC{0,60}") {
            let _ = parse(&text);
        }

        #[test]
        fn parse_never_panics_on_any_words(words in proptest::collection::vec(
            prop::sample::select(vec!["offer", "where", "asked", "is", "null", "in", "(", ")", ":", ",", "B", "3", "*",
                ";", "rest", "and", "=", "group", "E1", "not", "accept", "\n", "$"]), 0..12)) {
            let _ = parse(&words.join(" "));
        }
    }
}
