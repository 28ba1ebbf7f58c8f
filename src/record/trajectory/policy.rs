//! Runs that a policy plays: what their weeks say of it.

use super::{Line, Record};
use crate::trajectory::record::Via;

/// What the rationale of a policy's week says before the policy's name.
const BEFORE_NAME: &str = "policy ";

/// The rationale of a week that the policy of a name decides.
pub fn policy_rationale(name: &str) -> String {
    format!("{BEFORE_NAME}{name}")
}

/// The policy that decided every week among some lines, by their rationales; none where somebody else decided one, and without
/// weeks.
pub fn policy_of(lines: &[Line]) -> Option<&str> {
    let mut weeks = lines.iter().filter_map(|line| match &line.record {
        Record::Advance(week) => Some(week),
        _ => None,
    });
    let first = weeks.next()?;
    let is_one = first.via == Via::Policy
        && weeks.all(|week| week.via == Via::Policy && week.rationale == first.rationale);
    first.rationale.strip_prefix(BEFORE_NAME).filter(|_| is_one)
}
