//! A grammar for sentences: rules with alternatives, which are expanded with the values and tags of a context
//! (docs/mechanics/market/social/texts.md#grammar).
//!
//! A grammar is a TOML file. `given` lists the values that every context has, `maybe` lists optional values, and `tags`
//! lists possible conditions. `[rules]` contains the rules; nested tables create dotted names. In an alternative:
//!
//! | notation | meaning |
//! |---|---|
//! | `(new, !company) text` | only if the tag `new` is set and the tag `company` is not set |
//! | `{praise}` | the rule or the value with this name |
//! | `{work:group}` | the rule `work.S1` if the value `group` is `S1` and the rule exists, otherwise the rule `work` |
//! | `[one\|two\|]` | one of the alternatives, here possibly nothing; `[one]` is short for `[one\|]` |
//! | `a/an` | the correct article for the next word |
//! An alternative with a missing value is skipped. Parsing checks that every symbol is known, that no rule
//! contains itself, and that every rule can be expanded without optional values.

#[cfg(test)]
mod count;
mod parse;
mod polish;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

pub use polish::polish;

/// The values and tags that are available to the expansion of a rule.
#[derive(Debug, Clone, Default)]
pub struct Context {
    values: BTreeMap<&'static str, String>,
    tags: BTreeSet<&'static str>,
}

impl Context {
    /// Adds a named value.
    pub fn with(mut self, name: &'static str, value: impl Into<String>) -> Context {
        self.values.insert(name, value.into());
        self
    }

    /// Adds a named value if `value` is `Some`.
    pub fn with_optional(self, name: &'static str, value: Option<impl Into<String>>) -> Context {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// Adds a tag if `is_set` is true.
    pub fn with_tag(mut self, name: &'static str, is_set: bool) -> Context {
        if is_set {
            self.tags.insert(name);
        }
        self
    }

    /// Returns the value with this name, or `None` if the context has no such value.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.values.get(name).map(String::as_str)
    }

    /// Returns the names of all values and tags.
    #[cfg(test)]
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        self.values.keys().chain(&self.tags).copied()
    }

    /// Returns whether a tag is set.
    pub fn has_tag(&self, tag: &str) -> bool {
        self.tags.contains(tag)
    }
}

/// A parsed and validated grammar.
#[derive(Debug, Clone)]
pub struct Grammar {
    rules: BTreeMap<String, Vec<Alternative>>,
    /// Names of all declared values and tags. Tests compare them with the names of a context.
    #[cfg(test)]
    known: BTreeSet<String>,
}

/// The reason why a grammar is invalid.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct GrammarError(String);

impl fmt::Display for GrammarError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for GrammarError {}

#[derive(Debug, Clone, PartialEq, Eq)]
struct Alternative {
    /// Tags, each with `true` if the tag must be set and `false` if it must not be set.
    required_tags: Vec<(String, bool)>,
    parts: Vec<Part>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Text(String),
    /// Name of a rule.
    Rule(String),
    /// Name of a value of the context.
    Value(String),
    /// The rule `rule.VALUE`, where `VALUE` is the value named `by`; the rule `rule` if that rule does not exist.
    ByValue {
        rule: String,
        by: String,
    },
    Choice(Vec<Vec<Part>>),
}

/// A function that chooses an alternative: receives the number of alternatives, at least 1, and returns the index of
/// one alternative.
pub type Chooser<'a> = &'a mut dyn FnMut(usize) -> usize;

impl Grammar {
    /// Parses a grammar.
    ///
    /// # Errors
    /// Returns an error if the text is not a TOML grammar, a symbol is unknown, a rule contains itself, or a rule
    /// cannot always be expanded.
    pub fn parse(source: &str) -> Result<Grammar, GrammarError> {
        parse::parse(&[source])
    }

    /// Parses a grammar from several files that share names and rules.
    ///
    /// # Errors
    /// Returns an error for the same reasons as [`Grammar::parse`], or if two files define the same rule.
    pub fn parse_all(sources: &[&str]) -> Result<Grammar, GrammarError> {
        parse::parse(sources)
    }

    /// Returns whether the grammar has a rule with this name.
    pub fn has_rule(&self, rule: &str) -> bool {
        self.rules.contains_key(rule)
    }

    /// Returns whether a value or tag with this name is declared.
    #[cfg(test)]
    pub fn declares(&self, name: &str) -> bool {
        self.known.contains(name)
    }

    /// Returns the number of different expansions of a rule in a context.
    #[cfg(test)]
    pub fn count_phrasings(&self, rule: &str, context: &Context) -> u64 {
        count::count_phrasings(self, rule, context)
    }

    /// Expands a rule. Within one text, an alternative is repeated only after all other alternatives of its rule have
    /// been used. An unknown rule expands to an empty text.
    pub fn expand(&self, rule: &str, context: &Context, choose: Chooser<'_>) -> String {
        let mut writer =
            Expansion { grammar: self, context, choose, used: BTreeSet::new(), text: String::new() };
        writer.expand_rule(rule);
        polish(&writer.text)
    }

    fn resolve_rule_by_value<'a>(
        &self,
        rule: &'a str,
        by: &str,
        context: &Context,
    ) -> std::borrow::Cow<'a, str> {
        let special = context.value(by).map(|value| format!("{rule}.{value}"));
        match special.filter(|name| self.has_rule(name)) {
            Some(name) => name.into(),
            None => rule.into(),
        }
    }
}

impl Alternative {
    fn matches(&self, context: &Context) -> bool {
        self.required_tags.iter().all(|(tag, wanted)| context.has_tag(tag) == *wanted)
            && has_required_values(&self.parts, context)
    }
}

/// Returns whether the context has all values that are used outside of choices.
fn has_required_values(parts: &[Part], context: &Context) -> bool {
    parts.iter().all(|part| match part {
        Part::Value(name) => context.value(name).is_some(),
        _ => true,
    })
}

struct Expansion<'a> {
    grammar: &'a Grammar,
    context: &'a Context,
    choose: Chooser<'a>,
    used: BTreeSet<(&'a str, usize)>,
    text: String,
}

impl<'a> Expansion<'a> {
    fn expand_rule(&mut self, name: &str) {
        let Some((name, alternatives)) = self.grammar.rules.get_key_value(name) else { return };
        let fitting =
            || alternatives.iter().enumerate().filter(|(_, alternative)| alternative.matches(self.context));
        let mut open: Vec<usize> =
            fitting().map(|(at, _)| at).filter(|at| !self.used.contains(&(name.as_str(), *at))).collect();
        if open.is_empty() {
            open = fitting().map(|(at, _)| at).collect();
        }
        let Some(at) = self.pick_alternative(&open) else { return };
        self.used.insert((name, at));
        self.expand_parts(&alternatives[at].parts);
    }

    fn pick_alternative(&mut self, open: &[usize]) -> Option<usize> {
        (!open.is_empty()).then(|| open[(self.choose)(open.len()).min(open.len() - 1)])
    }

    fn expand_parts(&mut self, parts: &[Part]) {
        for part in parts {
            match part {
                Part::Text(text) => self.text.push_str(text),
                Part::Rule(name) => self.expand_rule(name),
                Part::Value(name) => self.text.push_str(self.context.value(name).unwrap_or_default()),
                Part::ByValue { rule, by } => {
                    let name = self.grammar.resolve_rule_by_value(rule, by, self.context);
                    self.expand_rule(&name);
                }
                Part::Choice(branches) => {
                    let fits = |branch: &&Vec<Part>| has_required_values(branch, self.context);
                    let open: Vec<&Vec<Part>> = branches.iter().filter(fits).collect();
                    let indices: Vec<usize> = (0..open.len()).collect();
                    if let Some(at) = self.pick_alternative(&indices) {
                        self.expand_parts(open[at]);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAMPLE_GRAMMAR: &str = r#"
        given = ["name", "group"]
        maybe = ["price"]
        tags = ["new"]
        [rules]
        post = ["{greeting} {name} [likes|loves] it.", "(new) {name} is new here.", "{price} is too much."]
        greeting = ["hello,", "well,"]
        job = ["{name} does {work:group}."]
        work = ["reports"]
        pair = ["{greeting} {greeting}"]
        [rules.works]
        work = ["x"]
        "#;

    fn sample() -> Grammar {
        Grammar::parse(SAMPLE_GRAMMAR).expect("a grammar")
    }

    fn all_expansions(rule: &str, context: &Context) -> BTreeSet<String> {
        let mut state = 1u64;
        let mut choose = |count: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % count
        };
        (0..300).map(|_| sample().expand(rule, context, &mut choose)).collect()
    }

    fn sample_context() -> Context {
        Context::default().with("name", "Ada").with("group", "S1")
    }

    #[test]
    fn expansions_match_count_phrasings() {
        let plain = all_expansions("post", &sample_context());
        assert_eq!(plain.len() as u64, sample().count_phrasings("post", &sample_context()));
        assert!(plain.contains("Hello, Ada loves it.") && plain.len() == 4, "{plain:?}");
        let rich = sample_context().with("price", "$9").with_tag("new", true);
        let texts = all_expansions("post", &rich);
        assert!(texts.contains("Ada is new here.") && texts.contains("$9 is too much."), "{texts:?}");
        assert_eq!((texts.len() as u64, sample().count_phrasings("post", &rich)), (6, 6));
    }

    #[test]
    fn specific_rule_precedes_general_rule() {
        let special = SAMPLE_GRAMMAR
            .replace("[rules.works]", "[rules.work_of]")
            .replace("work = [\"reports\"]", "work = [\"reports\"]\n\"work.S1\" = [\"sketches\"]");
        let grammar = Grammar::parse(&special).expect("a grammar");
        let write = |group: &str| {
            let context = Context::default().with("name", "Ada").with("group", group);
            grammar.expand("job", &context, &mut |_| 0)
        };
        assert_eq!((write("S1"), write("E1")), ("Ada does sketches.".into(), "Ada does reports.".into()));
    }

    #[test]
    fn alternatives_do_not_repeat_within_a_text() {
        assert_eq!(all_expansions("pair", &sample_context()).len(), 2);
        assert!(all_expansions("pair", &sample_context()).contains("Hello, well,"));
    }

    #[test]
    fn unknown_rules_expand_to_empty_text() {
        assert_eq!(sample().expand("nowhere", &sample_context(), &mut |_| 0), "");
        assert_eq!(sample().count_phrasings("nowhere", &sample_context()), 0);
    }
}
