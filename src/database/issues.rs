//! Packed days of the table `issues`. A run contains issues of one group that were opened on the same day, in
//! ascending order of customers.

use rusqlite::vtab::Context;
use std::ffi::c_int;
use std::sync::Arc;

use super::packing::{MAX_RUN_ROWS, PackedDay, Packer, RowRun, Unpacker};
use novamind_world::events::IssueOpened;
use novamind_world::identifiers::Group;

/// Issues of one group with consecutive numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct IssueRun {
    /// Number of the first issue in the run.
    pub first: u32,
    pub group: Group,
    pub customers: Vec<u32>,
    /// Day on which each issue was resolved; 0 for open issues.
    pub solved: Vec<u32>,
}

/// The values of an `issues` row except day and customer.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct IssueRow {
    pub issue: u32,
    pub group: Option<Group>,
    pub solved: u32,
}

impl IssueRun {
    /// Returns the runs of the issues that were opened on a day.
    pub fn runs_from_opened(opened: &[IssueOpened]) -> Vec<IssueRun> {
        let mut runs: Vec<IssueRun> = Vec::new();
        for issue in opened {
            let continues = |run: &IssueRun| {
                run.group == issue.group
                    && run.customers.len() < MAX_RUN_ROWS
                    && run.first + run.customers.len() as u32 == issue.issue
                    && run.customers.last() < Some(&issue.customer)
            };
            if !runs.last().is_some_and(continues) {
                let (customers, solved) = (Vec::new(), Vec::new());
                runs.push(IssueRun { first: issue.issue, group: issue.group, customers, solved });
            }
            let run = runs.last_mut().expect("a run was just pushed");
            run.customers.push(issue.customer);
            run.solved.push(0);
        }
        runs
    }
}

impl RowRun for IssueRun {
    type Row = IssueRow;

    fn customers(&self) -> &[u32] {
        &self.customers
    }

    fn row(&self, at: usize) -> IssueRow {
        IssueRow { issue: self.first + at as u32, group: Some(self.group), solved: self.solved[at] }
    }

    fn pack(&self, packer: &mut Packer) {
        packer.push_number(u64::from(self.first));
        packer.push_number(self.group.index() as u64);
        packer.push_ascending(&self.customers);
        self.solved.iter().for_each(|day| packer.push_number(u64::from(*day)));
    }

    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<IssueRun> {
        let first = unpacker.read_u32()?;
        let group = Group::at(unpacker.read_number()? as usize)?;
        let customers = unpacker.read_ascending()?;
        first.checked_add(customers.len() as u32)?;
        let solved = customers.iter().map(|_| unpacker.read_u32()).collect::<Option<_>>()?;
        Some(IssueRun { first, group, customers, solved })
    }
}

/// Indexes of the columns of the table `issues`.
pub(super) mod column {
    use std::ffi::c_int;

    pub const ISSUE: c_int = 0;
    pub const CUSTOMER: c_int = 1;
    pub const GROUP: c_int = 2;
    pub const OPEN_DAY: c_int = 3;
    pub const DAYS_OPEN: c_int = 4;
    pub const STATUS: c_int = 5;
    pub const SOLVED_DAY: c_int = 6;
}

/// Sets the result to the value of a column of an issue. The age is computed with the issue clock.
pub(super) fn write_column(
    (clock, day): (&[u32], u32),
    row: IssueRow,
    column: c_int,
    context: &mut Context,
) -> rusqlite::Result<()> {
    let solved = (row.solved > 0).then_some(row.solved);
    match column {
        column::ISSUE => context.set_result(row.issue),
        column::GROUP => context.set_result(row.group.map(Group::id)),
        column::DAYS_OPEN => context.set_result(days_open(clock, day, solved)),
        column::STATUS => context.set_result(if solved.is_some() { "resolved" } else { "open" }),
        column::SOLVED_DAY => context.set_result(solved),
        _ => context.set_result(solved.map(|_| "ops_resolved")),
    }
}

/// Returns the age of an issue by the issue clock. The clock advances on days on which issues are processed.
/// On each day, issues are resolved before the clock advances, and new issues are opened afterwards. `clock` contains
/// the value of the issue clock at the end of each day.
pub(super) fn days_open(clock: &[u32], opened: u32, solved: Option<u32>) -> u32 {
    let after = |day: u32| clock.get(day as usize).or(clock.last()).copied().unwrap_or(0);
    let until = solved.map_or_else(|| clock.last().copied().unwrap_or(0), |day| after(day.saturating_sub(1)));
    until.saturating_sub(after(opened))
}

/// Returns the index of the day on which an issue was opened.
pub(super) fn day_index_of_issue(days: &[Arc<PackedDay>], issue: u32) -> Option<usize> {
    let first = |day: &PackedDay| day.unpack_run::<IssueRun>(0).map_or(u32::MAX, |run| run.first);
    days.partition_point(|day| first(day) <= issue).checked_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opened(issue: u32, customer: u32, group: usize) -> IssueOpened {
        IssueOpened { issue, customer, group: Group::at(group).expect("a group") }
    }

    #[test]
    fn issue_runs_round_trip() {
        let mut runs = IssueRun::runs_from_opened(&[
            opened(7, 20, 0),
            opened(8, 31, 0),
            opened(9, 4, 0),
            opened(10, 5, 1),
            opened(12, 6, 1),
        ]);
        let shapes: Vec<(u32, usize)> = runs.iter().map(|run| (run.first, run.customers.len())).collect();
        assert_eq!(shapes, [(7, 2), (9, 1), (10, 1), (12, 1)]);
        runs[0].solved[1] = 44;
        let day = PackedDay::pack(40, &runs);
        let read = PackedDay::from_bytes::<IssueRun>(40, day.as_bytes().to_vec());
        assert_eq!(read, Some(day.clone()));
        assert_eq!(day.unpack_run::<IssueRun>(0), Some(runs[0].clone()));
        let next = Arc::new(PackedDay::pack(41, &IssueRun::runs_from_opened(&[opened(13, 1, 0)])));
        let days = [Arc::new(day), next];
        assert_eq!(
            [6, 7, 12, 13, 99].map(|issue| day_index_of_issue(&days, issue)),
            [None, Some(0), Some(0), Some(1), Some(1)]
        );
    }

    #[test]
    fn days_open_follows_the_issue_clock() {
        // The clock does not advance on day 3.
        let clock = [0, 1, 2, 2, 3, 4];
        for (opened, solved, days) in
            [(1, None, 3), (1, Some(5), 2), (2, Some(3), 0), (2, Some(4), 0), (3, Some(5), 1), (5, None, 0)]
        {
            assert_eq!(days_open(&clock, opened, solved), days, "{opened} {solved:?}");
        }
    }
}
