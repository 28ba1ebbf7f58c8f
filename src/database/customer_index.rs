//! Indexes of packed days by customer, for statements that look up many customers. Without an index, a lookup scans
//! the packed rows run by run.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard};

use super::packing::{PackedDay, RowRun};

/// Maximum total size in bytes of the indexes of a table that are built for one statement.
const MAX_INDEX_BYTES: usize = 256 << 20;

/// Rows of a range of days, grouped by customer. The rows of a customer are in table order.
pub(super) struct CustomerIndex<R: RowRun> {
    first_customer: u32,
    /// Start of each customer's rows, and the end of the last customer's rows.
    row_starts: Vec<u32>,
    /// Row number of each row.
    pub numbers: Vec<i64>,
    /// Columns of each row except day and customer.
    pub rows: Vec<R::Row>,
}

impl<R: RowRun> CustomerIndex<R> {
    /// Builds the index of a range of days. Returns `None` if the days cannot be unpacked.
    fn from_days(days: &[Arc<PackedDay>]) -> Option<CustomerIndex<R>> {
        let customers = customer_range(days);
        let mut begins = vec![0u32; customers.len() + 1];
        let place = |customer: u32| (customer - customers.start) as usize;
        for_each_run::<R>(days, |_, run| {
            run.customers().iter().for_each(|customer| begins[place(*customer) + 1] += 1);
        })?;
        for at in 1..begins.len() {
            begins[at] += begins[at - 1];
        }
        let mut next = begins.clone();
        let count = begins.last().map_or(0, |end| *end as usize);
        let mut numbers = vec![0; count];
        let mut rows = vec![R::Row::default(); count];
        for_each_run::<R>(days, |first_number, run| {
            for (at, customer) in run.customers().iter().enumerate() {
                let number = &mut next[place(*customer)];
                numbers[*number as usize] = first_number + at as i64;
                rows[*number as usize] = run.row(at);
                *number += 1;
            }
        })?;
        Some(CustomerIndex { first_customer: customers.start, row_starts: begins, numbers, rows })
    }

    /// Returns the positions in `numbers` and `rows` that belong to a customer.
    pub fn row_range(&self, customer: f64) -> Range<usize> {
        let at = customer - f64::from(self.first_customer);
        if at.fract() != 0.0 || !(0.0..(self.row_starts.len() - 1) as f64).contains(&at) {
            return 0..0;
        }
        self.row_starts[at as usize] as usize..self.row_starts[at as usize + 1] as usize
    }
}

/// Returns the range from the lowest to the highest customer number with rows.
fn customer_range(days: &[Arc<PackedDay>]) -> Range<u32> {
    let run_ranges = days.iter().flat_map(|day| (0..day.run_count()).map(|run| day.customer_range(run)));
    let run_ranges = run_ranges.filter(|(first, last)| first <= last);
    let (first, last) =
        run_ranges.fold((u32::MAX, 0), |all, run_range| (all.0.min(run_range.0), all.1.max(run_range.1)));
    if first <= last { first..last + 1 } else { 0..0 }
}

/// Calls `work` with each run and the number of its first row. Returns `None` if a run cannot be unpacked.
fn for_each_run<R: RowRun>(days: &[Arc<PackedDay>], mut work: impl FnMut(i64, &R)) -> Option<()> {
    for day in days {
        for run in 0..day.run_count() {
            work(day.row_number(run, 0), &day.unpack_run::<R>(run)?);
        }
    }
    Some(())
}

/// The indexes of one table, built for the running statement.
pub(super) struct CustomerIndexes<R: RowRun>(Mutex<IndexCache<R>>);

struct IndexCache<R: RowRun> {
    by_days: BTreeMap<(usize, usize), LookupStatistics<R>>,
    bytes: usize,
}

struct LookupStatistics<R: RowRun> {
    /// Number of rows that lookups have scanned.
    rows: usize,
    index: Option<Arc<CustomerIndex<R>>>,
}

impl<R: RowRun> Default for CustomerIndexes<R> {
    fn default() -> Self {
        CustomerIndexes(Mutex::new(IndexCache { by_days: BTreeMap::new(), bytes: 0 }))
    }
}

impl<R: RowRun> CustomerIndexes<R> {
    /// Returns the index of a range of days. Returns `None` until the scans of this range have cost as much as building
    /// the index, and if the index would need too much memory.
    pub fn get(&self, days: &[Arc<PackedDay>], range: &Range<usize>) -> Option<Arc<CustomerIndex<R>>> {
        let mut cache = self.lock();
        let lookups = cache.by_days.get(&(range.start, range.end))?;
        if lookups.index.is_some() {
            return lookups.index.clone();
        }
        let days = days.get(range.clone())?;
        let rows: usize = days.iter().map(|day| day.row_count()).sum();
        let bytes =
            rows * (size_of::<i64>() + size_of::<R::Row>()) + customer_range(days).len() * size_of::<u32>();
        if lookups.rows < 2 * rows || cache.bytes + bytes > MAX_INDEX_BYTES {
            return None;
        }
        let index = Arc::new(CustomerIndex::from_days(days)?);
        cache.bytes += bytes;
        cache.by_days.insert((range.start, range.end), LookupStatistics { rows, index: Some(index.clone()) });
        Some(index)
    }

    /// Adds the number of rows that a lookup of one customer scanned.
    pub fn record_scanned_rows(&self, range: &Range<usize>, rows: usize) {
        let mut cache = self.lock();
        let none = LookupStatistics { rows: 0, index: None };
        cache.by_days.entry((range.start, range.end)).or_insert(none).rows += rows;
    }

    /// Returns the number of rows that the running statement has scanned for single customers.
    #[cfg(test)]
    pub fn scanned_rows(&self) -> usize {
        self.lock().by_days.values().map(|lookups| lookups.rows).sum()
    }

    /// Removes all indexes and lookup statistics.
    pub fn clear(&self) {
        *self.lock() = IndexCache { by_days: BTreeMap::new(), bytes: 0 };
    }

    fn lock(&self) -> MutexGuard<'_, IndexCache<R>> {
        self.0.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }
}
