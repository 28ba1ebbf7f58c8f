//! Parses a grammar and checks that every rule can be expanded in every context.

use std::collections::{BTreeMap, BTreeSet};

use toml::{Table, Value};

use super::{Alternative, Grammar, GrammarError, Part};

#[derive(Default)]
struct DeclaredNames {
    given: BTreeSet<String>,
    maybe: BTreeSet<String>,
    tags: BTreeSet<String>,
    rules: BTreeSet<String>,
}

pub(super) fn parse(sources: &[&str]) -> Result<Grammar, GrammarError> {
    let mut texts = BTreeMap::new();
    let mut names = DeclaredNames::default();
    for source in sources {
        let table: Table =
            source.parse().map_err(|error: toml::de::Error| GrammarError(error.to_string()))?;
        if let Some(Value::Table(rules)) = table.get("rules") {
            flatten_rules("", rules, &mut texts)?;
        }
        names.given.append(&mut name_set(&table, "given")?);
        names.maybe.append(&mut name_set(&table, "maybe")?);
        names.tags.append(&mut name_set(&table, "tags")?);
    }
    names.rules = texts.keys().cloned().collect();
    let mut rules = BTreeMap::new();
    for (name, texts) in &texts {
        let alternatives: Result<Vec<Alternative>, GrammarError> =
            texts.iter().map(|text| parse_alternative(name, text, &names)).collect();
        rules.insert(name.clone(), alternatives?);
    }
    check_always_expandable(&rules, &names)?;
    Ok(Grammar {
        rules,
        #[cfg(test)]
        known: names.given.union(&names.maybe).chain(&names.tags).cloned().collect(),
    })
}

fn name_set(table: &Table, key: &str) -> Result<BTreeSet<String>, GrammarError> {
    let Some(value) = table.get(key) else { return Ok(BTreeSet::new()) };
    let texts = value.as_array().and_then(|texts| {
        texts.iter().map(|text| text.as_str().map(str::to_owned)).collect::<Option<BTreeSet<String>>>()
    });
    texts.ok_or_else(|| GrammarError(format!("{key} is not a list of names")))
}

/// Converts nested TOML tables to rules with dotted names.
fn flatten_rules(
    before: &str,
    table: &Table,
    rules: &mut BTreeMap<String, Vec<String>>,
) -> Result<(), GrammarError> {
    for (key, value) in table {
        let name = if before.is_empty() { key.clone() } else { format!("{before}.{key}") };
        match value {
            Value::Table(inner) => flatten_rules(&name, inner, rules)?,
            Value::Array(texts) if !texts.is_empty() => {
                let texts: Option<Vec<String>> =
                    texts.iter().map(|text| text.as_str().map(str::to_owned)).collect();
                let texts =
                    texts.ok_or_else(|| GrammarError(format!("rule {name}: not all elements are texts")))?;
                if rules.insert(name.clone(), texts).is_some() {
                    return Err(GrammarError(format!("rule {name} is defined twice")));
                }
            }
            _ => return Err(GrammarError(format!("rule {name} is not a list of texts"))),
        }
    }
    Ok(())
}

fn parse_alternative(rule: &str, text: &str, names: &DeclaredNames) -> Result<Alternative, GrammarError> {
    let wrong = |problem: String| GrammarError(format!("rule {rule}, \"{text}\": {problem}"));
    let (conditions, rest) = match text.strip_prefix('(').and_then(|rest| rest.split_once(") ")) {
        Some((conditions, rest)) => (parse_conditions(conditions, names).map_err(wrong)?, rest),
        None => (Vec::new(), text),
    };
    let mut reader = PartParser { rest, names };
    let parts = reader.parse_parts(false).map_err(wrong)?;
    Ok(Alternative { required_tags: conditions, parts })
}

fn parse_conditions(text: &str, names: &DeclaredNames) -> Result<Vec<(String, bool)>, String> {
    let one = |need: &str| {
        let (tag, wanted) = match need.trim().strip_prefix('!') {
            Some(tag) => (tag, false),
            None => (need.trim(), true),
        };
        if names.tags.contains(tag) {
            Ok((tag.to_owned(), wanted))
        } else {
            Err(format!("tag {tag} is not declared"))
        }
    };
    text.split(',').map(one).collect()
}

struct PartParser<'a> {
    rest: &'a str,
    names: &'a DeclaredNames,
}

impl PartParser<'_> {
    /// Parses parts up to the end of the text. Within a choice, stops before `|` or `]`.
    fn parse_parts(&mut self, within_choice: bool) -> Result<Vec<Part>, String> {
        let mut parts = Vec::new();
        loop {
            let end = self.rest.find(['{', '}', '[', ']', '|']).unwrap_or(self.rest.len());
            let (text, rest) = self.rest.split_at(end);
            if !text.is_empty() {
                parts.push(Part::Text(text.to_owned()));
            }
            self.rest = rest;
            match rest.chars().next() {
                Some('{') => parts.push(self.parse_symbol()?),
                Some('[') => parts.push(self.parse_choice()?),
                Some('|' | ']') if within_choice => return Ok(parts),
                None if !within_choice => return Ok(parts),
                None => return Err("a choice is not closed".to_owned()),
                Some(other) => return Err(format!("unexpected {other}")),
            }
        }
    }

    fn parse_symbol(&mut self) -> Result<Part, String> {
        let (symbol, rest) = self.rest[1..].split_once('}').ok_or("a symbol is not closed")?;
        self.rest = rest;
        if let Some((rule, by)) = symbol.split_once(':') {
            if !self.names.rules.contains(rule) {
                return Err(format!("there is no rule {rule} for other values"));
            }
            if !self.names.given.contains(by) && !self.names.maybe.contains(by) {
                return Err(format!("value {by} is not declared"));
            }
            return Ok(Part::ByValue { rule: rule.to_owned(), by: by.to_owned() });
        }
        if self.names.rules.contains(symbol) {
            Ok(Part::Rule(symbol.to_owned()))
        } else if self.names.given.contains(symbol) || self.names.maybe.contains(symbol) {
            Ok(Part::Value(symbol.to_owned()))
        } else {
            Err(format!("{symbol} is neither a rule nor a declared value"))
        }
    }

    fn parse_choice(&mut self) -> Result<Part, String> {
        self.rest = &self.rest[1..];
        let mut branches = vec![self.parse_parts(true)?];
        while self.rest.starts_with('|') {
            self.rest = &self.rest[1..];
            branches.push(self.parse_parts(true)?);
        }
        self.rest = &self.rest[1..];
        if branches.len() == 1 {
            branches.push(Vec::new());
        }
        Ok(Part::Choice(branches))
    }
}

/// Checks that every rule has an alternative without tags or optional values, and that no rule contains itself.
fn check_always_expandable(
    rules: &BTreeMap<String, Vec<Alternative>>,
    names: &DeclaredNames,
) -> Result<(), GrammarError> {
    let always = |alternative: &Alternative| {
        alternative.required_tags.is_empty() && is_always_filled(&alternative.parts, &names.given)
    };
    for (name, alternatives) in rules {
        if !alternatives.iter().any(always) {
            return Err(GrammarError(format!(
                "rule {name}: every alternative needs a tag or an optional value"
            )));
        }
    }
    let mut done = BTreeSet::new();
    for name in rules.keys() {
        check_acyclic(name, rules, &mut Vec::new(), &mut done)?;
    }
    Ok(())
}

fn is_always_filled(parts: &[Part], given: &BTreeSet<String>) -> bool {
    parts.iter().all(|part| match part {
        Part::Value(name) => given.contains(name),
        Part::Choice(branches) => branches.iter().any(|branch| is_always_filled(branch, given)),
        Part::Text(_) | Part::Rule(_) | Part::ByValue { .. } => true,
    })
}

fn check_acyclic(
    name: &str,
    rules: &BTreeMap<String, Vec<Alternative>>,
    path: &mut Vec<String>,
    done: &mut BTreeSet<String>,
) -> Result<(), GrammarError> {
    if done.contains(name) {
        return Ok(());
    }
    if path.iter().any(|above| above == name) {
        return Err(GrammarError(format!("rule {name} contains itself")));
    }
    path.push(name.to_owned());
    for alternative in &rules[name] {
        for inner in referenced_rules(&alternative.parts, rules) {
            check_acyclic(&inner, rules, path, done)?;
        }
    }
    path.pop();
    done.insert(name.to_owned());
    Ok(())
}

fn referenced_rules(parts: &[Part], rules: &BTreeMap<String, Vec<Alternative>>) -> Vec<String> {
    let mut found = Vec::new();
    for part in parts {
        match part {
            Part::Rule(name) => found.push(name.clone()),
            Part::ByValue { rule, .. } => {
                found.push(rule.clone());
                let special = format!("{rule}.");
                found.extend(rules.keys().filter(|name| name.starts_with(&special)).cloned());
            }
            Part::Choice(branches) => {
                found.extend(branches.iter().flat_map(|branch| referenced_rules(branch, rules)))
            }
            Part::Text(_) | Part::Value(_) => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_error(source: &str) -> String {
        parse(&[source]).expect_err("an error").to_string()
    }

    #[test]
    fn errors_name_their_rule() {
        for (source, words) in [
            ("[rules]\na = [\"{b}\"]", "b is neither"),
            ("[rules]\na = [\"(old) x\", \"y\"]", "tag old"),
            ("[rules]\na = [\"x [y\"]", "not closed"),
            ("[rules]\na = [\"x ] y\"]", "unexpected ]"),
            ("[rules]\na = [\"{b}\"]\nb = [\"{a}\"]", "contains itself"),
            ("maybe = [\"p\"]\n[rules]\na = [\"{p}\"]", "an optional value"),
            ("tags = [\"t\"]\n[rules]\na = [\"(t) x\"]", "needs a tag"),
            ("given = [\"g\"]\n[rules]\na = [\"{b:g}\"]", "no rule b"),
            ("[rules]\na = []", "rule a is not a list"),
        ] {
            assert!(parse_error(source).contains(words), "{source}: {}", parse_error(source));
        }
        let twice = parse(&["[rules]\na = [\"x\"]", "[rules]\na = [\"y\"]"]).expect_err("an error");
        assert!(twice.to_string().contains("twice"));
    }
}
