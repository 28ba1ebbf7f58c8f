//! Writes issues to the packed day on which they were opened, and updates them when they are resolved.

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::{Transaction, params};

use crate::blocks::BlockStore;
use crate::issues::IssueRun;
use crate::packing::PackedDay;
use novamind_world::events::Facts;

/// Collects issues until the next commit.
pub(super) struct IssueWriter {
    /// Packed days with issues, including all committed changes.
    days: Arc<Vec<Arc<PackedDay>>>,
    /// Value of the issue clock after each day.
    clock: Vec<u32>,
    /// First day for which the database does not contain the issue clock.
    clock_from: usize,
    /// For each day with new issues: number of the first issue, and the day.
    first_issues: Vec<(u32, u32)>,
    /// Runs of the days that changed since the last commit.
    touched: BTreeMap<u32, Vec<IssueRun>>,
}

impl IssueWriter {
    /// Returns a writer that continues the issues of a store.
    pub fn from_store(store: &BlockStore) -> IssueWriter {
        let clock = store.issue_clock.to_vec();
        let first = |day: &Arc<PackedDay>| Some((day.unpack_run::<IssueRun>(0)?.first, day.day));
        IssueWriter {
            days: store.issues.clone(),
            clock_from: clock.len(),
            clock,
            first_issues: store.issues.iter().filter_map(first).collect(),
            touched: BTreeMap::new(),
        }
    }

    /// Adds the issues of a day. Issues are resolved before the issue clock advances, and new issues are opened
    /// afterwards.
    pub fn write(&mut self, facts: &Facts) {
        let worked_on =
            facts.issues_aged || !facts.issues_opened.is_empty() || !facts.issues_resolved.is_empty();
        if facts.service.is_none() && !worked_on {
            return;
        }
        for &issue in &facts.issues_resolved {
            self.mark_resolved(issue, facts.day);
        }
        let before = self.clock.last().copied().unwrap_or(0);
        self.clock.resize(facts.day as usize, before);
        self.clock.push(before + u32::from(facts.issues_aged));
        if let Some(first) = facts.issues_opened.first() {
            self.first_issues.push((first.issue, facts.day));
            self.touched.insert(facts.day, IssueRun::runs_from_opened(&facts.issues_opened));
        }
    }

    fn mark_resolved(&mut self, issue: u32, day: u32) {
        let opened = self.first_issues.partition_point(|(first, _)| *first <= issue).checked_sub(1);
        let Some((_, opened)) = opened.map(|at| self.first_issues[at]) else { return };
        let days = &self.days;
        let runs = self.touched.entry(opened).or_insert_with(|| unpack_day(days, opened));
        let Some(run) = runs.partition_point(|run| run.first <= issue).checked_sub(1) else { return };
        let first = runs[run].first;
        if let Some(solved) = runs[run].solved.get_mut((issue - first) as usize) {
            *solved = day;
        }
    }

    /// Writes the changed days and the issue clock to the database.
    pub fn flush(&self, transaction: &Transaction<'_>) -> rusqlite::Result<()> {
        let mut write = transaction.prepare_cached("INSERT OR REPLACE INTO issue_blocks VALUES (?1, ?2)")?;
        for (day, runs) in &self.touched {
            write.execute(params![day, PackedDay::pack(*day, runs).as_bytes()])?;
        }
        let mut write = transaction.prepare_cached("INSERT OR REPLACE INTO issue_clock VALUES (?1, ?2)")?;
        for (day, aged) in (0u32..).zip(&self.clock).skip(self.clock_from) {
            write.execute(params![day, aged])?;
        }
        Ok(())
    }

    /// Adds the written days to the store that queries read.
    pub fn publish(&mut self, store: &mut BlockStore) {
        if self.clock_from < self.clock.len() {
            self.clock_from = self.clock.len();
            store.issue_clock = Arc::new(self.clock.clone());
        }
        if self.touched.is_empty() {
            return;
        }
        let mut days = self.days.to_vec();
        for (day, runs) in std::mem::take(&mut self.touched) {
            let packed = Arc::new(PackedDay::pack(day, &runs));
            match days.binary_search_by_key(&day, |day| day.day) {
                Ok(at) => days[at] = packed,
                Err(at) => days.insert(at, packed),
            }
        }
        self.days = Arc::new(days);
        store.issues = self.days.clone();
    }
}

fn unpack_day(days: &[Arc<PackedDay>], day: u32) -> Vec<IssueRun> {
    let Ok(at) = days.binary_search_by_key(&day, |packed_day| packed_day.day) else { return Vec::new() };
    (0..days[at].run_count()).filter_map(|run| days[at].unpack_run(run)).collect()
}
