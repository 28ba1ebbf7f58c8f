//! The grammar of rules (docs/interfaces/rules.md#grammar).

use super::condition::{Comparison, Condition, FIELDS, Field, Value};
use super::thread::AskingThread;
use novamind_base::nearest;
use novamind_session::identifiers::Plan;

const MOST_LINES: usize = 3;
/// Enterprise groups that every run knows. Discovered ones start with `D_E`.
const FIRST_GROUPS: [&str; 3] = ["E1", "E2", "E3"];
/// Kinds of threads that can wait for an answer.
const KINDS: [&str; 4] = ["new_lead", "churn_prevention", "plan_change", "renegotiation"];

/// A rule: conditions and an action.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Source text.
    pub text: String,
    pub(super) conditions: Vec<Condition>,
    pub(super) action: Action,
}

impl Rule {
    pub(super) fn means(&self, thread: &AskingThread) -> bool {
        self.conditions.iter().all(|condition| condition.holds(thread))
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
    /// `None` for the plan that the enterprise asked for.
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

/// A problem of rules and its column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Description, with similar names.
    pub text: String,
    /// Column in characters, from 1.
    pub column: usize,
}

/// Parses rules, which are separated by semicolons or line ends.
///
/// # Errors
/// Returns the first problem and its column.
pub fn parse(text: &str) -> Result<Vec<Rule>, Problem> {
    let tokens = tokens(text)?;
    let mut reader = Reader { text, tokens: &tokens, at: 0 };
    let mut rules = Vec::new();
    loop {
        while reader.take(";") {}
        if reader.is_at_end() {
            break;
        }
        rules.push(reader.rule()?);
        if !reader.is_at_end() && !reader.take(";") {
            return Err(reader.problem("the rule ends here: separate rules with ;"));
        }
    }
    match rules.is_empty() {
        true => Err(reader.problem("a rule is expected, for example offer where asked is null: B 85")),
        false => Ok(rules),
    }
}

/// Parses conditions without a rule, as they occur after `where`.
pub(super) fn conditions(text: &str) -> Result<Vec<Condition>, Problem> {
    let tokens = tokens(text)?;
    let mut reader = Reader { text, tokens: &tokens, at: 0 };
    if reader.is_at_end() {
        return Err(reader.problem("a condition is missing, example: seats >= 500"));
    }
    let conditions = reader.joined()?;
    match reader.is_at_end() {
        true => Ok(conditions),
        false => Err(reader.problem("the conditions end here: join conditions with and")),
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Token {
    text: String,
    from: usize,
    to: usize,
}

fn column(text: &str, at: usize) -> usize {
    text[..at].chars().count() + 1
}

fn tokens(text: &str) -> Result<Vec<Token>, Problem> {
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
                    let text_of = "the quotation mark is not closed".to_owned();
                    return Err(Problem { text: text_of, column: column(text, at) });
                }
            },
            _ if is_word(letter) => rest.find(|next| !is_word(next)).unwrap_or(rest.len()),
            _ => {
                let two = ["<=", ">=", "!=", "<>", "=="].into_iter().find(|two| rest.starts_with(two));
                match two {
                    Some(two) => two.len(),
                    None if "<>=:,*()-".contains(letter) => 1,
                    None => {
                        let text_of = format!("unexpected character {letter}");
                        return Err(Problem { text: text_of, column: column(text, at) });
                    }
                }
            }
        };
        let own = &rest[..length];
        let said = if own == "\n" { ";" } else { own.trim_matches(['"', '\'']) };
        tokens.push(Token { text: said.to_owned(), from: at, to: at + length });
        at += length;
    }
    Ok(tokens)
}

struct Reader<'a> {
    text: &'a str,
    tokens: &'a [Token],
    at: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&str> {
        self.tokens.get(self.at).map(|token| token.text.as_str())
    }

    fn is_at_end(&self) -> bool {
        self.at == self.tokens.len()
    }

    fn take(&mut self, word: &str) -> bool {
        let found = self.peek().is_some_and(|own| own.eq_ignore_ascii_case(word));
        self.at += usize::from(found);
        found
    }

    fn word(&mut self) -> Option<String> {
        let own = self.peek()?.to_owned();
        self.at += 1;
        Some(own)
    }

    fn problem(&self, text: impl Into<String>) -> Problem {
        let at = self.tokens.get(self.at).map_or(self.text.len(), |token| token.from);
        Problem { text: text.into(), column: column(self.text, at) }
    }

    /// Returns a problem with the previous word.
    fn wrong(&mut self, text: impl Into<String>) -> Problem {
        self.at -= 1;
        self.problem(text)
    }

    fn rule(&mut self) -> Result<Rule, Problem> {
        let from = self.at;
        let action = self.word().unwrap_or_default().to_lowercase();
        let known = ["offer", "accept", "reject"];
        if !known.contains(&action.as_str()) {
            let near = or_known(nearest(&action, known.into_iter()), &known);
            return Err(self.wrong(format!("unknown action {action}; {near}")));
        }
        let conditions = self.conditions(&action)?;
        let action = match action.as_str() {
            "offer" => Action::Offer(self.lines()?),
            "accept" => Action::Accept,
            _ => Action::Reject,
        };
        let (first, last) = (&self.tokens[from], &self.tokens[self.at - 1]);
        Ok(Rule { text: self.text[first.from..last.to].to_owned(), conditions, action })
    }

    fn conditions(&mut self, action: &str) -> Result<Vec<Condition>, Problem> {
        if self.take("rest") || self.take("all") {
            return Ok(Vec::new());
        }
        let named = self.take("where");
        match self.peek() {
            None | Some(";") => {
                return Err(self.problem(format!("{action} needs a condition, or rest for all others")));
            }
            Some(":") if !named => {
                return Err(self.problem("the condition is missing: use where …, or rest for all others"));
            }
            _ => {}
        }
        self.joined()
    }

    fn joined(&mut self) -> Result<Vec<Condition>, Problem> {
        let mut conditions = vec![self.condition()?];
        while self.take("and") {
            conditions.push(self.condition()?);
        }
        match self.peek() {
            Some(word) if word.eq_ignore_ascii_case("or") => Err(self.problem(
                "or is not supported: conditions are joined with and; use in (…) for one of several values, and another \
                 rule for other threads",
            )),
            _ => Ok(conditions),
        }
    }

    fn condition(&mut self) -> Result<Condition, Problem> {
        let Some(name) = self.word() else { return Err(self.problem("a condition is missing")) };
        let lower = name.to_lowercase();
        let Some((_, field)) = FIELDS.into_iter().find(|(known, _)| *known == lower) else {
            let names: Vec<&str> = FIELDS.iter().map(|(name, _)| *name).collect();
            let near = or_known(nearest(&lower, names.iter().copied()), &names);
            return Err(self.wrong(format!("unknown field {name}; {near}")));
        };
        if self.take("is") {
            let there = self.take("not");
            if !self.take("null") {
                return Err(self.problem("null is expected: is null or is not null"));
            }
            return Ok(if there { Condition::IsThere(field) } else { Condition::IsNull(field) });
        }
        if self.take("in") {
            return self.one_of(field);
        }
        let comparison = self.comparison(field)?;
        if self.take("null") {
            let is = if comparison == Comparison::NotEqual { "is not" } else { "is" };
            return Err(self.wrong(format!("null cannot be compared: write {lower} {is} null")));
        }
        let value = self.value(field)?;
        self.refuse_comma_in_number()?;
        Ok(Condition::Compared(field, comparison, value))
    }

    /// Rejects `1,000`, because the comma would separate two numbers.
    fn refuse_comma_in_number(&mut self) -> Result<(), Problem> {
        let [number, comma, more, ..] = &self.tokens[self.at.saturating_sub(1)..] else { return Ok(()) };
        let digits = |token: &Token| token.text.chars().all(|letter| letter.is_ascii_digit());
        let adjacent = number.to == comma.from && comma.to == more.from;
        if comma.text != "," || !adjacent || !digits(number) || !digits(more) {
            return Ok(());
        }
        let written = format!("{},{}", number.text, more.text);
        let plain = format!("{}{}", number.text, more.text);
        Err(self.wrong(format!("{written} has a comma: write {plain} or {}_{}", number.text, more.text)))
    }

    fn comparison(&mut self, field: Field) -> Result<Comparison, Problem> {
        use Comparison::{AtLeast, AtMost, Equal, Less, More, NotEqual};
        let comparison = match self.peek() {
            Some("=" | "==") => Equal,
            Some("!=" | "<>") => NotEqual,
            Some("<") => Less,
            Some("<=") => AtMost,
            Some(">") => More,
            Some(">=") => AtLeast,
            _ => return Err(self.problem("a comparison is expected: = != < <= > >=, in, is null")),
        };
        if field.is_word() && !matches!(comparison, Equal | NotEqual) {
            return Err(self.problem("words can only be compared with = or !="));
        }
        self.at += 1;
        Ok(comparison)
    }

    fn one_of(&mut self, field: Field) -> Result<Condition, Problem> {
        if !self.take("(") {
            return Err(self.problem("a list is expected, for example in (E1, E2)"));
        }
        let mut values = vec![self.value(field)?];
        while self.take(",") {
            values.push(self.value(field)?);
        }
        if !self.take(")") {
            return Err(self.problem("the bracket of the list is not closed"));
        }
        Ok(Condition::OneOf(field, values))
    }

    fn value(&mut self, field: Field) -> Result<Value, Problem> {
        if !field.is_word() {
            return Ok(Value::Number(self.number()?));
        }
        let Some(word) = self.word() else { return Err(self.problem("a value is missing")) };
        // Does not reveal whether an undiscovered group exists.
        let word = if field == Field::Group { word.to_uppercase() } else { word };
        if word.starts_with("D_E") {
            return Ok(Value::Word(word));
        }
        let known: Vec<&str> = match field {
            Field::Group => FIRST_GROUPS.to_vec(),
            Field::AskedPlan => Plan::ALL.map(Plan::id).to_vec(),
            _ => KINDS.to_vec(),
        };
        match known.iter().find(|known| known.eq_ignore_ascii_case(&word)) {
            Some(known) => Ok(Value::Word((*known).to_owned())),
            None => {
                let near = or_known(nearest(&word, known.iter().copied()), &known);
                Err(self.wrong(format!("unknown value {word}; {near}")))
            }
        }
    }

    fn number(&mut self) -> Result<f64, Problem> {
        let Some(word) = self.word() else { return Err(self.problem("a number is missing")) };
        match word.replace('_', "").parse::<f64>().ok().filter(|number| number.is_finite()) {
            Some(number) => Ok(number),
            None => Err(self.wrong(format!("a number is expected, not {word}"))),
        }
    }

    fn lines(&mut self) -> Result<Vec<OfferLine>, Problem> {
        if !self.take(":") {
            return Err(self.problem("a colon and the offer are missing, for example : B 85"));
        }
        let mut lines = vec![self.line()?];
        while self.take(",") {
            if lines.len() == MOST_LINES {
                return Err(self.problem(format!("an offer has at most {MOST_LINES} plans")));
            }
            lines.push(self.line()?);
        }
        Ok(lines)
    }

    fn line(&mut self) -> Result<OfferLine, Problem> {
        let Some(word) = self.word() else { return Err(self.problem("a plan and a price are missing")) };
        let plan = match Plan::parse(&word.to_uppercase()) {
            Some(plan) => Some(plan),
            None if word.eq_ignore_ascii_case("asked_plan") => None,
            None => return Err(self.wrong(format!("unknown plan {word}: use A, B, C or asked_plan"))),
        };
        let price = self.price()?;
        self.refuse_comma_in_number()?;
        Ok(OfferLine { plan, price })
    }

    fn price(&mut self) -> Result<Price, Problem> {
        const NAMES: [&str; 3] = ["asked", "list", "last_offer"];
        let Some(word) = self.peek().map(str::to_lowercase) else {
            return Err(self.problem("a price is missing"));
        };
        if !word.starts_with(char::is_alphabetic) {
            let price = self.number()?;
            return if price > 0.0 {
                Ok(Price::Dollars(price))
            } else {
                Err(self.wrong("the price must be above 0"))
            };
        }
        if !NAMES.contains(&word.as_str()) {
            let near = or_known(nearest(&word, NAMES.into_iter()), &NAMES);
            return Err(self.problem(format!("unknown price {word}: use dollars, or {near}")));
        }
        self.at += 1;
        let factor = if self.take("*") { self.number()? } else { 1.0 };
        if factor <= 0.0 {
            return Err(self.wrong("the factor must be above 0"));
        }
        Ok(match word.as_str() {
            "asked" => Price::Asked(factor),
            "list" => Price::List(factor),
            _ => Price::Last(factor),
        })
    }
}

/// Suggests similar names, or lists the known ones.
fn or_known(near: Vec<&str>, known: &[&str]) -> String {
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
    fn rules_are_read_with_their_words() {
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
    fn problems_name_their_column_and_what_is_near() {
        for (text, column, part) in [
            ("", 1, "a rule is expected"),
            ("ofer rest: B 3", 1, "did you mean offer"),
            ("offer where grup = E2: B 3", 13, "did you mean group"),
            ("offer where group = E9: B 3", 21, "did you mean"),
            ("offer where type = new: B 3", 20, "new_lead"),
            ("offer where group > E1: B 3", 19, "= or !="),
            ("offer rest", 11, "colon"),
            ("offer: B 3", 6, "rest for all others"),
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
            ("reject rest reject rest", 13, "separate rules with ;"),
            ("reject where größe > 3", 14, "unknown field"),
            ("reject where seats ? 3", 20, "unexpected character"),
            ("reject where seats < 1,000", 22, "write 1000 or 1_000"),
            ("offer rest: B 1,000", 15, "write 1000 or 1_000"),
            ("offer where asked = null: B 3", 21, "write asked is null"),
            ("offer where asked != null: B 3", 22, "write asked is not null"),
            ("reject where seats < 3 or group = E1", 24, "joined with and"),
        ] {
            let problem = parse(text).expect_err(text);
            assert_eq!(problem.column, column, "{text}: {problem:?}");
            assert!(problem.text.contains(part), "{text}: {problem:?}");
        }
    }

    #[test]
    fn groups_that_nobody_found_are_not_named() {
        let problem = parse("accept group = D_S0").expect_err("not an enterprise group");
        assert!(problem.text.ends_with("known: E1, E2, E3"), "{problem:?}");
        for group in ["D_E01", "d_e99"] {
            assert!(parse(&format!("accept group = {group}")).is_ok(), "{group}");
        }
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "\\PC{0,60}") {
            let _ = parse(&text);
        }

        #[test]
        fn no_words_panic(words in proptest::collection::vec(
            prop::sample::select(vec!["offer", "where", "asked", "is", "null", "in", "(", ")", ":", ",", "B", "3", "*",
                ";", "rest", "and", "=", "group", "E1", "not", "accept", "\n", "$"]), 0..12)) {
            let _ = parse(&words.join(" "));
        }
    }
}
