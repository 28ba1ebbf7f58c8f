//! Counts the expansions of a grammar rule.

use super::{Context, Grammar, Part, has_required_values};

/// Returns the number of expansions of a rule in a context, at most `u64::MAX`.
pub(super) fn count_phrasings(grammar: &Grammar, rule: &str, context: &Context) -> u64 {
    let Some(alternatives) = grammar.rules.get(rule) else { return 0 };
    let fitting = alternatives.iter().filter(|alternative| alternative.matches(context));
    fitting.map(|alternative| count_parts(grammar, &alternative.parts, context)).fold(0, u64::saturating_add)
}

fn count_parts(grammar: &Grammar, parts: &[Part], context: &Context) -> u64 {
    let one = |part: &Part| match part {
        Part::Text(_) | Part::Value(_) => 1,
        Part::Rule(name) => count_phrasings(grammar, name, context),
        Part::ByValue { rule, by } => {
            count_phrasings(grammar, &grammar.resolve_rule_by_value(rule, by, context), context)
        }
        Part::Choice(branches) => {
            let fitting = branches.iter().filter(|branch| has_required_values(branch, context));
            fitting.map(|branch| count_parts(grammar, branch, context)).fold(0, u64::saturating_add)
        }
    };
    parts.iter().map(one).fold(1, u64::saturating_mul)
}
