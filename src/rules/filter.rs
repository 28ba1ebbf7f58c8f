//! A filter of threads that uses the conditions of rules.

use super::condition::Condition;
use super::grammar::{self, RuleError};
use super::thread::ThreadContext;

/// Conditions, all of which a thread must meet.
#[derive(Debug, Clone, PartialEq)]
pub struct Filter(Vec<Condition>);

impl Filter {
    /// Parses conditions joined with `and`, in the grammar of rules.
    ///
    /// # Errors
    /// Returns the first problem and its column.
    pub fn parse(text: &str) -> Result<Filter, RuleError> {
        grammar::parse_conditions(text).map(Filter)
    }

    /// Returns whether a thread meets all conditions.
    pub fn matches(&self, thread: &ThreadContext) -> bool {
        self.0.iter().all(|condition| condition.is_satisfied(thread))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filter_accepts_the_conditions_of_rules() {
        assert!(Filter::parse("group = E2 and asked is null and seats >= 1_000").is_ok());
        for (text, column, part) in [
            ("", 1, "example `seats >= 500`"),
            ("seats", 6, "comparison"),
            ("seats > 3 group = E1", 11, "join conditions with `and`"),
            ("seats > 3 or group = E1", 11, "joined with `and`"),
        ] {
            let problem = Filter::parse(text).expect_err(text);
            assert_eq!(problem.column, column, "{text}: {problem:?}");
            assert!(problem.text.contains(part), "{text}: {problem:?}");
        }
    }
}
