//! Counts the expansions of a rule.

use super::{Context, Grammar, Part, values_given};

/// Returns the number of expansions of a rule in a context, at most `u64::MAX`.
pub(super) fn phrasings(grammar: &Grammar, rule: &str, context: &Context) -> u64 {
    let Some(alternatives) = grammar.rules.get(rule) else { return 0 };
    let fitting = alternatives.iter().filter(|alternative| alternative.fits(context));
    fitting.map(|alternative| of_parts(grammar, &alternative.parts, context)).fold(0, u64::saturating_add)
}

fn of_parts(grammar: &Grammar, parts: &[Part], context: &Context) -> u64 {
    let one = |part: &Part| match part {
        Part::Text(_) | Part::Value(_) => 1,
        Part::Rule(name) => phrasings(grammar, name, context),
        Part::Split { rule, by } => phrasings(grammar, &grammar.split(rule, by, context), context),
        Part::Choice(branches) => {
            let fitting = branches.iter().filter(|branch| values_given(branch, context));
            fitting.map(|branch| of_parts(grammar, branch, context)).fold(0, u64::saturating_add)
        }
    };
    parts.iter().map(one).fold(1, u64::saturating_mul)
}
