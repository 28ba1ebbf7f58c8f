//! Issues of entries: days on which they were opened, changed as they are solved.

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::{Transaction, params};

use crate::database::blocks::{BlockStore, PackedDay};
use crate::database::issues::{IssueRun, day_of};
use crate::world::events::Facts;

/// Collects issues until the next commit.
pub(super) struct IssueWriter {
    /// What was committed.
    days: Arc<Vec<Arc<PackedDay>>>,
    /// What the clock of ageing showed after each day.
    clock: Vec<u32>,
    /// The first day whose clock is not written yet.
    clock_from: usize,
    /// First issue and runs of days that were touched.
    touched: BTreeMap<u32, (u32, Vec<IssueRun>)>,
}

impl IssueWriter {
    /// A writer that continues what a store holds.
    pub fn continuing(store: &BlockStore) -> IssueWriter {
        let clock = store.issue_clock.to_vec();
        IssueWriter { days: store.issues.clone(), clock_from: clock.len(), clock, touched: BTreeMap::new() }
    }

    /// Adds a day. Solutions come before the clock ticks, new issues after it.
    pub fn write(&mut self, facts: &Facts) {
        let worked_on = facts.issues_aged || !facts.issues_opened.is_empty() || !facts.issues_resolved.is_empty();
        if facts.service.is_none() && !worked_on {
            return;
        }
        for &issue in &facts.issues_resolved {
            self.solve(issue, facts.day);
        }
        let before = self.clock.last().copied().unwrap_or(0);
        self.clock.resize(facts.day as usize, before);
        self.clock.push(before + u32::from(facts.issues_aged));
        if let Some(first) = facts.issues_opened.first() {
            let runs = IssueRun::runs_of(&facts.issues_opened);
            self.touched.insert(facts.day, (first.issue, runs));
        }
    }

    fn solve(&mut self, issue: u32, day: u32) {
        let among_touched =
            self.touched.iter().rev().find(|(_, (first, _))| *first <= issue).map(|(day, _)| *day);
        let committed = day_of(&self.days, issue).map(|at| &self.days[at]);
        // The later of both is the day of the issue: an earlier one ends before it.
        let opened = among_touched.max(committed.map(|day| day.day));
        let Some(opened) = opened else { return };
        let runs = self.touched.entry(opened).or_insert_with(|| unpacked(committed.map(|day| &**day)));
        let runs = &mut runs.1;
        let Some(run) = runs.partition_point(|run| run.first <= issue).checked_sub(1) else { return };
        let first = runs[run].first;
        if let Some(solved) = runs[run].solved.get_mut((issue - first) as usize) {
            *solved = day;
        }
    }

    /// Writes the days that were touched, and the clock.
    pub fn flush(&self, transaction: &Transaction<'_>) -> rusqlite::Result<()> {
        let mut write = transaction.prepare_cached("INSERT OR REPLACE INTO issue_blocks VALUES (?1, ?2)")?;
        for (day, (_, runs)) in &self.touched {
            write.execute(params![day, PackedDay::pack(*day, runs).bytes()])?;
        }
        let mut write = transaction.prepare_cached("INSERT OR REPLACE INTO issue_clock VALUES (?1, ?2)")?;
        for (day, aged) in (0u32..).zip(&self.clock).skip(self.clock_from) {
            write.execute(params![day, aged])?;
        }
        Ok(())
    }

    /// Everything written is part of the store now.
    pub fn publish(&mut self, store: &mut BlockStore) {
        if self.clock_from < self.clock.len() {
            self.clock_from = self.clock.len();
            store.issue_clock = Arc::new(self.clock.clone());
        }
        if self.touched.is_empty() {
            return;
        }
        let mut days = self.days.to_vec();
        for (day, (_, runs)) in std::mem::take(&mut self.touched) {
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

fn unpacked(day: Option<&PackedDay>) -> (u32, Vec<IssueRun>) {
    let runs: Vec<IssueRun> =
        day.map_or_else(Vec::new, |day| (0..day.len()).filter_map(|run| day.open(run)).collect());
    (runs.first().map_or(u32::MAX, |run| run.first), runs)
}
