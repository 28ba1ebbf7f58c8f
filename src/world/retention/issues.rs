//! Support issues: opening, resolution, and the effect of waiting on the relationship
//! (`docs/mechanics/retention/issues.md`).
//!
//! All decisions depend on the values at the start of the day. The first sweep of [`crate::day`] finds issues before
//! the satisfaction update. The second sweep resolves, ages and opens issues after the update. Between the two sweeps,
//! the operations budget is allocated.

use super::support_pools::ResolutionRound;
use crate::canonical::canonical;
use crate::context::DayContext;
use crate::customers::Customers;
use crate::customers::columns::{Block, CUSTOMERS_PER_BLOCK, word_position_in_block};
use crate::events::{Facts, IssueOpened};
use crate::identifiers::Group;
use crate::params::{Issues, Params, Quality};
use crate::quality::relationship_as_read;
use crate::random::{Part, bernoulli_from_word};
use crate::settings::Settings;

/// Returns today's probability of a new issue, from the satisfaction at the start of the day and the number of whole
/// seats.
#[inline]
pub fn issue_probability(satisfaction: f64, outage: bool, seats: f64, issues: &Issues) -> f64 {
    let rate = issues.base_issue_rate
        + issues.issue_quality_factor * (issues.issue_satisfaction_reference - satisfaction)
        + if outage { issues.issue_outage_factor } else { 0.0 };
    (rate * seats).clamp(issues.issue_probability_min, issues.issue_probability_max)
}

/// Returns the mean number of a group's issues that a support pool resolves today: (b + lambda x) k_g / k.
pub fn mean_resolved(
    base: f64,
    spend: f64,
    group: Group,
    group_issues: u32,
    pool_issues: u32,
    issues: &Issues,
) -> f64 {
    let per_dollar =
        if group.is_enterprise() { issues.enterprise_ops_scale } else { issues.individual_ops_scale };
    (base + per_dollar * spend) * f64::from(group_issues) / f64::from(pool_issues)
}

/// Returns the relationship after the resolution of an issue that was open for `open_days` days.
pub fn relationship_after_resolution(
    relationship: f64,
    open_days: u32,
    outage: bool,
    params: &Params,
) -> f64 {
    let issues = &params.issues;
    if open_days > issues.quick_resolution_threshold_days || outage {
        return relationship;
    }
    let boost = if open_days <= issues.quick_boost_first_day {
        issues.quick_resolution_boost_1day
    } else {
        issues.quick_resolution_boost_2day
    };
    (relationship_as_read(relationship, &params.quality) + boost).min(issues.relationship_max)
}

/// Returns the relationship after another day with an open issue.
pub fn relationship_after_waiting(relationship: f64, issues: &Issues, quality: &Quality) -> f64 {
    (relationship_as_read(relationship, quality) - issues.relationship_decay_per_unresolved_day)
        .max(issues.relationship_min)
}

/// The counter that numbers issues.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct IssueCounter {
    /// Number that the next issue receives, from 1.
    pub next_issue: u32,
}

canonical! { IssueCounter { next_issue } }

impl Default for IssueCounter {
    fn default() -> Self {
        IssueCounter { next_issue: 1 }
    }
}

/// Issues of one block at the start of the day, as row positions.
pub struct IssueBatch {
    pub(super) group: Group,
    pub(super) block: u32,
    /// Positions of rows with an open issue.
    pub(super) open: Vec<u16>,
    /// Positions of rows whose customer opens an issue today.
    pub(super) new: Vec<u16>,
    /// Whether each issue of `open` is resolved today.
    pub(super) solved: Vec<bool>,
    /// Number of the block's first new issue.
    pub(super) first_issue: u32,
}

/// Number of rows whose flags fit into one 64-bit word.
const ROWS_PER_WORD: usize = u64::BITS as usize;

/// Finds the rows with an open issue and the rows whose customer opens an issue today.
///
/// The processor cannot predict the conditions. The loop therefore collects bits without branches and converts the
/// bits to lists afterwards.
pub fn find_issues(group: Group, number: u32, block: &Block, day: &DayContext<'_>) -> IssueBatch {
    let &DayContext { service, params, streams, .. } = day;
    let (day, outage) = (day.day(), service.outage);
    let keys = [u64::from(day), group.index() as u64, u64::from(number)];
    let mut words = [0u32; CUSTOMERS_PER_BLOCK as usize];
    streams.open(Part::IssueOpening, keys).fill(&mut words);
    // A local copy, so that the compiler knows that the parameters are constant.
    let issues = &params.issues.clone();
    let mut waiting = [0u64; CUSTOMERS_PER_BLOCK as usize / ROWS_PER_WORD];
    let mut calling = waiting;
    let (mut seats, mut probabilities) = ([1.0; ROWS_PER_WORD], [0.0; ROWS_PER_WORD]);
    for (part, first) in (0..block.len()).step_by(ROWS_PER_WORD).enumerate() {
        let rows = (block.len() - first).min(ROWS_PER_WORD);
        let range = first..first + rows;
        if group.is_enterprise() {
            seats
                .iter_mut()
                .zip(&block.seats[range.clone()])
                .for_each(|(whole, value)| *whole = value.trunc());
        }
        let satisfaction = &block.satisfaction[range.clone()];
        for at in 0..rows {
            probabilities[at] = issue_probability(satisfaction[at], outage, seats[at], issues);
        }
        let (open_days, n) = (&block.open_issue_days[range.clone()], &block.n[range]);
        for at in 0..rows {
            let waits = open_days[at] > 0;
            let calls = !waits & bernoulli_from_word(words[word_position_in_block(n[at])], probabilities[at]);
            waiting[part] |= u64::from(waits) << at;
            calling[part] |= u64::from(calls) << at;
        }
    }
    let (open, new) = (set_bit_positions(&waiting), set_bit_positions(&calling));
    let solved = vec![false; open.len()];
    IssueBatch { group, block: number, open, new, solved, first_issue: 0 }
}

fn set_bit_positions(bits: &[u64]) -> Vec<u16> {
    let mut positions = Vec::with_capacity(bits.iter().map(|word| word.count_ones() as usize).sum());
    for (word, first) in bits.iter().zip((0u16..).step_by(ROWS_PER_WORD)) {
        let mut left = *word;
        while left != 0 {
            positions.push(first + left.trailing_zeros() as u16);
            left &= left - 1;
        }
    }
    positions
}

/// Allocates today's operations budget among the open issues, and numbers the new issues in block order.
pub fn allocate_resolutions(
    calls: &mut [IssueBatch],
    settings: &Settings,
    customers: &Customers,
    issue_counter: &mut IssueCounter,
    day: &DayContext<'_>,
) {
    let &DayContext { params, streams, .. } = day;
    let day = day.day();
    ResolutionRound { day, calls, customers, params, streams }.resolve_all(settings);
    for issue_batch in calls {
        issue_batch.first_issue = issue_counter.next_issue;
        issue_counter.next_issue += issue_batch.new.len() as u32;
    }
}

/// Results of updating the issues of one block for a day.
#[derive(Debug, PartialEq, Eq)]
pub struct IssueUpdates {
    /// Whether any issue was open at the start of the day.
    pub any_open: bool,
    /// Numbers of the resolved issues.
    pub resolved: Vec<u32>,
    /// Issues that were opened today.
    pub opened: Vec<IssueOpened>,
}

/// Resolves, ages and opens issues of a block. No row may have been removed since `issue_batch` was created.
pub fn update_issues(block: &mut Block, issue_batch: &IssueBatch, day: &DayContext<'_>) -> IssueUpdates {
    let &DayContext { service, params, .. } = day;
    let outage = service.outage;
    IssueUpdates {
        any_open: !issue_batch.open.is_empty(),
        resolved: update_open_issues(block, issue_batch, outage, params),
        opened: open_new_issues(block, issue_batch, params),
    }
}

/// Records the results of all blocks as facts.
pub fn record_issues(by_block: Vec<IssueUpdates>, facts: &mut Facts) {
    for settled_issues in by_block {
        facts.issues_aged |= settled_issues.any_open;
        facts.issues_resolved.extend(settled_issues.resolved);
        facts.issues_opened.extend(settled_issues.opened);
    }
}

/// Resolves or ages the open issues of a block. Returns the numbers of the resolved issues.
fn update_open_issues(
    block: &mut Block,
    issue_batch: &IssueBatch,
    outage: bool,
    params: &Params,
) -> Vec<u32> {
    let mut resolved = Vec::with_capacity(issue_batch.solved.iter().filter(|solved| **solved).count());
    for (&at, &solved) in issue_batch.open.iter().zip(&issue_batch.solved) {
        let at = usize::from(at);
        let (relationship, days) = (&mut block.relationship[at], &mut block.open_issue_days[at]);
        if solved {
            *relationship = relationship_after_resolution(*relationship, *days, outage, params);
            *days = 0;
            resolved.push(std::mem::take(&mut block.issue[at]));
        } else {
            *days += 1;
            *relationship = relationship_after_waiting(*relationship, &params.issues, &params.quality);
        }
    }
    resolved
}

fn open_new_issues(block: &mut Block, issue_batch: &IssueBatch, params: &Params) -> Vec<IssueOpened> {
    let open = |(issue, &at): (u32, &u16)| {
        let at = usize::from(at);
        block.open_issue_days[at] = params.issues.new_issue_open_days;
        block.issue[at] = issue;
        IssueOpened { issue, customer: block.customer[at], group: issue_batch.group }
    };
    (issue_batch.first_issue..).zip(&issue_batch.new).map(open).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::tests::with_day_context;
    use crate::events::ServiceDay;
    use crate::morning::tests::morning;
    use crate::params::Params;
    use crate::random::Streams;
    use crate::test_kit::subscriber;

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-12, "got {actual}, expected {expected}");
    }

    #[test]
    fn issue_probability_depends_on_satisfaction_outages_and_seats() {
        let issues = Params::bundled().issues;
        for (satisfaction, seats, quiet, outage) in [
            (0.5, 1.0, 0.085, 0.335),
            (0.0, 1.0, 0.16, 0.4),
            (-0.4, 1.0, 0.22, 0.4),
            (0.5, 3.0, 0.255, 0.4),
            (1.2, 1.0, 0.0, 0.23),
            (0.2, 100.0, 0.4, 0.4),
        ] {
            assert_near(issue_probability(satisfaction, false, seats, &issues), quiet);
            assert_near(issue_probability(satisfaction, true, seats, &issues), outage);
        }
    }

    #[test]
    fn set_bit_positions_are_ascending() {
        assert!(set_bit_positions(&[0, 0]).is_empty());
        assert_eq!(set_bit_positions(&[1 | 1 << 63, 0, 1 << 5 | 1 << 6]), [0, 63, 133, 134]);
        assert_eq!(set_bit_positions(&[u64::MAX; 16]), (0..1024).collect::<Vec<u16>>());
    }

    #[test]
    fn resolution_depends_on_budget_and_speed_affects_relationship() {
        let params = Params::bundled();
        let (s1, e1) = (Group::at(0).expect("S1"), Group::at(3).expect("E1"));
        let mean = |base, spend, group, group_issues, pool_issues| {
            mean_resolved(base, spend, group, group_issues, pool_issues, &params.issues)
        };
        assert_near(mean(2.0, 10.0, e1, 1, 4), 0.75);
        assert_near(mean(2.0, 10.0, s1, 3, 4), 6.0);
        assert_near(mean(0.0, 20.0, s1, 3, 3), 12.0);
        assert_near(mean(0.0, 5.0, e1, 1, 1), 0.5);
        assert_near(mean(0.0, 7.0, e1, 1, 4), 0.175);
        assert_near(mean(0.0, 7.0, s1, 3, 4), 3.15);
        assert_near(mean(0.0, 11.0, s1, 3, 3), 6.6);
        assert_near(mean(0.0, 2.0, s1, 1, 1), 1.2);
        assert_near(relationship_after_resolution(0.5, 1, false, &params), 0.9);
        assert_near(relationship_after_resolution(0.8, 2, false, &params), 1.0);
        assert_near(relationship_after_resolution(0.5, 3, false, &params), 0.5);
        assert_near(relationship_after_resolution(0.5, 1, true, &params), 0.5);
    }

    #[test]
    fn relationship_resets_to_neutral_after_51_days_of_waiting() {
        let params = Params::bundled();
        let mut relationship: f64 = 0.5;
        for _ in 0..50 {
            relationship = relationship_after_waiting(relationship, &params.issues, &params.quality);
        }
        assert!(relationship < 1e-12, "{relationship}");
        relationship = relationship_after_waiting(0.0, &params.issues, &params.quality);
        assert_near(relationship, 0.49);
    }

    fn customers_with_issues(count: u32) -> Customers {
        let mut customers = Customers::default();
        for n in 1..=count {
            let row = crate::customers::columns::Subscriber { open_issue_days: 1, issue: n, ..subscriber(n) };
            customers.groups[Group::at(0).expect("S1")].activate(row);
        }
        customers
    }

    fn run_day(customers: &mut Customers, operations: f64) -> (Facts, IssueCounter) {
        let (params, streams) = (Params::bundled(), Streams::new(4));
        let mut settings = Settings::initial(&params);
        settings.core.operations = operations;
        let (mut facts, mut issue_counter) = (Facts::default(), IssueCounter { next_issue: 10_000 });
        let quiet = ServiceDay::without_load();
        let settled = with_day_context(&morning(3), &settings, &quiet, (&params, &streams), |day| {
            let mut calls = customers.sweep(|group, number, block| find_issues(group, number, block, day));
            allocate_resolutions(&mut calls, &settings, customers, &mut issue_counter, day);
            customers.sweep_with(calls, |_, _, block, issue_batch| update_issues(block, &issue_batch, day))
        });
        record_issues(settled, &mut facts);
        (facts, issue_counter)
    }

    #[test]
    fn resolved_issues_raise_the_relationship_and_open_issues_age() {
        let mut customers = customers_with_issues(3000);
        let (facts, _) = run_day(&mut customers, 2_000.0);
        let solved = facts.issues_resolved.len();
        assert!((1_060..1_340).contains(&solved), "Poisson of 1202: {solved}");
        let s1 = &customers.groups[Group::at(0).expect("S1")];
        let count = |days| s1.blocks.iter().flat_map(|b| &b.open_issue_days).filter(|d| **d == days).count();
        assert_eq!((count(0), count(2)), (solved, 3000 - solved));
        for block in &s1.blocks {
            for at in 0..block.len() {
                let expected = if block.open_issue_days[at] == 0 { 0.9 } else { 0.49 };
                assert_near(block.relationship[at], expected);
                assert_eq!(block.issue[at] == 0, block.open_issue_days[at] == 0);
            }
        }
        assert!(facts.issues_aged && facts.issues_opened.is_empty());
    }

    #[test]
    fn sufficient_budget_resolves_all_issues() {
        let mut customers = customers_with_issues(50);
        assert_eq!(run_day(&mut customers, 1e6).0.issues_resolved.len(), 50);
    }

    #[test]
    fn new_issues_match_their_rate_and_are_numbered() {
        let mut customers = Customers::default();
        (1..=4000).for_each(|n| customers.groups[Group::at(0).expect("S1")].activate(subscriber(n)));
        let (facts, issue_counter) = run_day(&mut customers, 0.0);
        let opened = facts.issues_opened.len() as u32;
        assert!((270..410).contains(&opened), "binomial of 340: {opened}");
        assert!(!facts.issues_aged);
        assert_eq!(issue_counter.next_issue, 10_000 + opened);
    }
}
