//! Days of usage and ad revenue as compact blocks: in memory for queries, as blobs in the file.

use std::sync::{Arc, RwLock};

use super::by_customer::Indexes;
use super::by_text::TextIndexes;
use super::issues::IssueRun;
use super::ledger::LedgerDay;
use super::notices::Inbox;
use crate::world::events::{AdsRevenueRow, UsageRows};
use crate::world::identifiers::Group;

/// What the runs of one of the tables are: rows of ascending customer numbers.
pub(super) trait Run: Sized {
    /// What a row holds besides day and customer.
    type Row: Copy + Default + Send + Sync;

    fn customers(&self) -> &[u32];
    fn row(&self, at: usize) -> Self::Row;
    fn pack(&self, packer: &mut Packer);
    /// None when the bytes are not those of a run.
    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<Self>;
}

/// A day of one of the tables, packed as it is in the file: rows would take a multiple of the memory.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PackedDay {
    pub day: u32,
    bytes: Vec<u8>,
    runs: Vec<RunPlace>,
}

/// Where a run is among the bytes of its day, and whom it may hold.
#[derive(Debug, Clone, Copy, PartialEq)]
struct RunPlace {
    begin: usize,
    /// Rows of the day that stand before it.
    rows_before: usize,
    rows: usize,
    first_customer: u32,
    last_customer: u32,
}

impl RunPlace {
    /// Place of a run that begins at a byte, after these.
    fn after(before: &[RunPlace], run: &impl Run, begin: usize) -> RunPlace {
        let customers = run.customers();
        RunPlace {
            begin,
            rows_before: before.last().map_or(0, |last| last.rows_before + last.rows),
            rows: customers.len(),
            first_customer: customers.first().copied().unwrap_or(u32::MAX),
            last_customer: customers.last().copied().unwrap_or(0),
        }
    }
}

impl PackedDay {
    pub fn pack<R: Run>(day: u32, rows: &[R]) -> PackedDay {
        let mut packer = Packer::default();
        packer.number(rows.len() as u64);
        let mut runs = Vec::with_capacity(rows.len());
        for run in rows {
            runs.push(RunPlace::after(&runs, run, packer.0.len()));
            run.pack(&mut packer);
        }
        packer.0.shrink_to_fit();
        PackedDay { day, bytes: packer.0, runs }
    }

    /// A day as it was packed; none when the bytes are not those of a day.
    pub fn read<R: Run>(day: u32, bytes: Vec<u8>) -> Option<PackedDay> {
        let mut unpacker = Unpacker(&bytes);
        let mut runs = Vec::new();
        for _ in 0..unpacker.number()? {
            let begin = bytes.len() - unpacker.0.len();
            runs.push(RunPlace::after(&runs, &R::unpack(&mut unpacker)?, begin));
        }
        unpacker.0.is_empty().then_some(PackedDay { day, bytes, runs })
    }

    /// As it stands in the file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Number of runs.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.runs.last().map_or(0, |last| last.rows_before + last.rows)
    }

    /// Number of a row of a run: rows are numbered in the order in which they stand.
    pub fn row_number(&self, run: usize, at: usize) -> i64 {
        let before = self.runs.get(run).map_or(0, |place| place.rows_before);
        i64::from(self.day) << 32 | (before + at + 1) as i64
    }

    /// First and last customer of a run; the first is greater where it is empty.
    pub fn customers(&self, run: usize) -> (u32, u32) {
        let place = &self.runs[run];
        (place.first_customer, place.last_customer)
    }

    /// Whether a run may hold a customer with this number.
    pub fn may_hold(&self, run: usize, customer: f64) -> bool {
        let (first, last) = self.customers(run);
        (f64::from(first)..=f64::from(last)).contains(&customer)
    }

    /// The rows of a run.
    pub fn open<R: Run>(&self, run: usize) -> Option<R> {
        let place = self.runs.get(run)?;
        R::unpack(&mut Unpacker(&self.bytes[place.begin..]))
    }
}

/// Ad revenue of customers of one group, in ascending order of their numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AdsRun {
    pub group: Group,
    pub customers: Vec<u32>,
    pub strengths: Vec<f64>,
    pub revenues: Vec<f64>,
}

/// What a row of ad revenue holds besides day and customer.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct AdsRow {
    pub group: Option<Group>,
    pub strength: f64,
    pub revenue: f64,
}

/// The days a query can see. A query takes the whole store at its start and is not disturbed by later days.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockStore {
    pub usage: Arc<Vec<Arc<PackedDay>>>,
    pub ads: Arc<Vec<Arc<PackedDay>>>,
    pub inbox: Inbox,
    pub issues: Arc<Vec<Arc<PackedDay>>>,
    /// What the clock of issues showed after each day, from day 0 on.
    pub issue_clock: Arc<Vec<u32>>,
    pub ledger: Arc<Vec<Arc<LedgerDay>>>,
}

/// The store that the writer fills and queries read.
pub(super) type SharedStore = Arc<RwLock<BlockStore>>;

/// What the running statement sees, and the indexes it has made of it.
#[derive(Default)]
pub(super) struct Seen {
    store: RwLock<BlockStore>,
    pub usage: Indexes<UsageRows>,
    pub ads: Indexes<AdsRun>,
    pub issues: Indexes<IssueRun>,
    pub ledger_notes: TextIndexes,
    pub notice_texts: TextIndexes,
}

impl Seen {
    /// From now on this store is seen.
    pub fn see(&self, store: BlockStore) {
        *self.store.write().unwrap_or_else(|poisoned| poisoned.into_inner()) = store;
        self.usage.clear();
        self.ads.clear();
        self.issues.clear();
        self.ledger_notes.clear();
        self.notice_texts.clear();
    }

    /// The store that is seen.
    pub fn store(&self) -> BlockStore {
        self.store.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }
}

/// Rows of a run at most: whoever looks for one of them unpacks all.
pub(super) const LONGEST_RUN: usize = 1024;

impl AdsRun {
    pub fn runs_of(rows: &[AdsRevenueRow]) -> Vec<AdsRun> {
        let mut runs: Vec<AdsRun> = Vec::new();
        for row in rows {
            let continues = |run: &AdsRun| {
                run.group == row.group
                    && run.customers.len() < LONGEST_RUN
                    && run.customers.last() < Some(&row.customer)
            };
            if !runs.last().is_some_and(continues) {
                let (customers, strengths, revenues) = (Vec::new(), Vec::new(), Vec::new());
                runs.push(AdsRun { group: row.group, customers, strengths, revenues });
            }
            let run = runs.last_mut().expect("a run was just pushed");
            run.customers.push(row.customer);
            run.strengths.push(row.strength);
            run.revenues.push(row.revenue);
        }
        runs
    }
}

/// Writes numbers of any size in as few bytes as they need.
#[derive(Default)]
pub(super) struct Packer(Vec<u8>);

impl Packer {
    pub fn number(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    pub fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// What was written.
    pub fn finish(self) -> Vec<u8> {
        self.0
    }

    pub fn float(&mut self, value: f64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    /// Ascending numbers as their differences.
    pub fn ascending(&mut self, values: &[u32]) {
        self.number(values.len() as u64);
        let mut before = 0;
        for &value in values {
            self.number(u64::from(value - before));
            before = value;
        }
    }
}

/// Reads what a [`Packer`] wrote.
pub(super) struct Unpacker<'a>(&'a [u8]);

impl<'a> Unpacker<'a> {
    pub fn of(bytes: &'a [u8]) -> Unpacker<'a> {
        Unpacker(bytes)
    }

    /// What is left to read.
    pub fn rest(&self) -> &'a [u8] {
        self.0
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (bytes, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(bytes)
    }

    pub fn number(&mut self) -> Option<u64> {
        let (mut value, mut shift) = (0u64, 0u32);
        loop {
            let (&byte, rest) = self.0.split_first()?;
            self.0 = rest;
            value |= u64::from(byte & 0x7f).checked_shl(shift)?;
            if byte < 0x80 {
                return Some(value);
            }
            shift += 7;
        }
    }

    pub fn small(&mut self) -> Option<u32> {
        u32::try_from(self.number()?).ok()
    }

    pub fn float(&mut self) -> Option<f64> {
        let (bytes, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(f64::from_le_bytes(*bytes))
    }

    pub fn ascending(&mut self) -> Option<Vec<u32>> {
        let mut before = 0u32;
        (0..self.number()?)
            .map(|_| {
                before = before.checked_add(self.small()?)?;
                Some(before)
            })
            .collect()
    }
}

impl Run for UsageRows {
    type Row = u32;

    fn customers(&self) -> &[u32] {
        &self.customers
    }

    fn row(&self, at: usize) -> u32 {
        self.units[at]
    }

    fn pack(&self, packer: &mut Packer) {
        packer.ascending(&self.customers);
        self.units.iter().for_each(|units| packer.number(u64::from(*units)));
    }

    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<UsageRows> {
        let customers = unpacker.ascending()?;
        let units = customers.iter().map(|_| unpacker.small()).collect::<Option<_>>()?;
        Some(UsageRows { customers, units })
    }
}

impl Run for AdsRun {
    type Row = AdsRow;

    fn customers(&self) -> &[u32] {
        &self.customers
    }

    fn row(&self, at: usize) -> AdsRow {
        AdsRow { group: Some(self.group), strength: self.strengths[at], revenue: self.revenues[at] }
    }

    fn pack(&self, packer: &mut Packer) {
        packer.number(self.group.index() as u64);
        packer.ascending(&self.customers);
        for (length, strength) in lengths(&self.strengths) {
            packer.number(length);
            packer.float(strength);
        }
        self.revenues.iter().for_each(|revenue| packer.float(*revenue));
    }

    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<AdsRun> {
        let group = Group::at(unpacker.number()? as usize)?;
        let customers = unpacker.ascending()?;
        let mut strengths = Vec::with_capacity(customers.len());
        while strengths.len() < customers.len() {
            let (length, strength) = (unpacker.number()? as usize, unpacker.float()?);
            if length == 0 || length > customers.len() - strengths.len() {
                return None;
            }
            strengths.extend(std::iter::repeat_n(strength, length));
        }
        let revenues = customers.iter().map(|_| unpacker.float()).collect::<Option<_>>()?;
        Some(AdsRun { group, customers, strengths, revenues })
    }
}

/// Equal neighbours as (how many, which).
fn lengths(values: &[f64]) -> impl Iterator<Item = (u64, f64)> + '_ {
    values.chunk_by(|left, right| left.to_bits() == right.to_bits()).map(|run| (run.len() as u64, run[0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ascending() -> impl Strategy<Value = Vec<u32>> {
        proptest::collection::btree_set(1u32.., 0..50).prop_map(|set| set.into_iter().collect())
    }

    proptest! {
        #[test]
        fn usage_comes_back_as_it_went(runs in proptest::collection::vec(ascending(), 0..5), seed in any::<u32>()) {
            let runs = runs.into_iter().map(|customers| {
                let units = customers.iter().map(|customer| customer.wrapping_mul(seed)).collect();
                UsageRows { customers, units }
            });
            let runs: Vec<UsageRows> = runs.collect();
            let day = PackedDay::pack(9, &runs);
            prop_assert_eq!(PackedDay::read::<UsageRows>(9, day.bytes().to_vec()), Some(day.clone()));
            for (at, run) in runs.into_iter().enumerate() {
                prop_assert!(run.customers.iter().all(|customer| day.may_hold(at, f64::from(*customer))));
                prop_assert_eq!(day.open(at), Some(run));
            }
        }

        #[test]
        fn damaged_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            let _ = PackedDay::read::<UsageRows>(1, bytes.clone());
            let _ = PackedDay::read::<AdsRun>(1, bytes);
        }
    }

    #[test]
    fn ad_revenue_comes_back_as_it_went() {
        let row = |customer, group, strength| AdsRevenueRow {
            customer,
            group: Group::at(group).expect("a group"),
            strength,
            revenue: f64::from(customer) / 7.0,
        };
        let rows = [row(2, 0, 0.5), row(9, 0, 0.5), row(11, 0, 0.7), row(3, 1, 0.5), row(4, 1, 0.5)];
        let runs = AdsRun::runs_of(&rows);
        assert_eq!(runs.len(), 2);
        let day = PackedDay::pack(12, &runs);
        assert_eq!(PackedDay::read::<AdsRun>(12, day.bytes().to_vec()), Some(day.clone()));
        assert_eq!((day.open(0).as_ref(), day.open(1).as_ref()), (Some(&runs[0]), Some(&runs[1])));
        assert_eq!(PackedDay::read::<AdsRun>(12, day.bytes()[1..].to_vec()), None);
        assert_eq!(PackedDay::read::<AdsRun>(12, day.bytes()[..day.bytes().len() - 1].to_vec()), None);
    }
}
