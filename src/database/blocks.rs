//! Stores of packed days: in memory for queries, as blobs in the database file.

use std::sync::{Arc, RwLock};

use super::customer_index::CustomerIndexes;
use super::issues::IssueRun;
use super::ledger::LedgerDay;
use super::notices::Inbox;
use super::packing::{MAX_RUN_ROWS, PackedDay, Packer, RowRun, Unpacker};
use super::text_index::TextIndexes;
use novamind_world::events::{AdsRevenueRow, UsageRows};
use novamind_world::identifiers::Group;

/// Ad revenue from customers of one group, in ascending order of customer numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AdsRun {
    pub group: Group,
    pub customers: Vec<u32>,
    pub strengths: Vec<f64>,
    pub revenues: Vec<f64>,
}

/// The values of an `ads_revenue` row except day and customer.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct AdsRow {
    pub group: Option<Group>,
    pub strength: f64,
    pub revenue: f64,
}

/// The days that a query can read. A query clones the store at its start and is independent of later days.
#[derive(Debug, Clone, Default)]
pub(super) struct BlockStore {
    pub usage: Arc<Vec<Arc<PackedDay>>>,
    pub ads: Arc<Vec<Arc<PackedDay>>>,
    pub inbox: Inbox,
    pub issues: Arc<Vec<Arc<PackedDay>>>,
    /// Value of the issue clock after each day, starting with day 0.
    pub issue_clock: Arc<Vec<u32>>,
    pub ledger: Arc<Vec<Arc<LedgerDay>>>,
}

/// The store that the writer fills and that queries read.
pub(super) type SharedStore = Arc<RwLock<BlockStore>>;

/// The block store that the running statement reads, and the indexes built for the statement.
#[derive(Default)]
pub(super) struct QueryView {
    store: RwLock<BlockStore>,
    pub usage: CustomerIndexes<UsageRows>,
    pub ads: CustomerIndexes<AdsRun>,
    pub issues: CustomerIndexes<IssueRun>,
    pub ledger_notes: TextIndexes,
    pub notice_texts: TextIndexes,
}

impl QueryView {
    /// Sets the store for the next statement and removes all indexes.
    pub fn set_store(&self, store: BlockStore) {
        *self.store.write().unwrap_or_else(|poisoned| poisoned.into_inner()) = store;
        self.usage.clear();
        self.ads.clear();
        self.issues.clear();
        self.ledger_notes.clear();
        self.notice_texts.clear();
    }

    /// Returns a clone of the store.
    pub fn store(&self) -> BlockStore {
        self.store.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone()
    }
}

impl AdsRun {
    pub fn runs_from_rows(rows: &[AdsRevenueRow]) -> Vec<AdsRun> {
        let mut runs: Vec<AdsRun> = Vec::new();
        for row in rows {
            let continues = |run: &AdsRun| {
                run.group == row.group
                    && run.customers.len() < MAX_RUN_ROWS
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

impl RowRun for UsageRows {
    type Row = u32;

    fn customers(&self) -> &[u32] {
        &self.customers
    }

    fn row(&self, at: usize) -> u32 {
        self.units[at]
    }

    fn pack(&self, packer: &mut Packer) {
        packer.push_ascending(&self.customers);
        self.units.iter().for_each(|units| packer.push_number(u64::from(*units)));
    }

    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<UsageRows> {
        let customers = unpacker.read_ascending()?;
        let units = customers.iter().map(|_| unpacker.read_u32()).collect::<Option<_>>()?;
        Some(UsageRows { customers, units })
    }
}

impl RowRun for AdsRun {
    type Row = AdsRow;

    fn customers(&self) -> &[u32] {
        &self.customers
    }

    fn row(&self, at: usize) -> AdsRow {
        AdsRow { group: Some(self.group), strength: self.strengths[at], revenue: self.revenues[at] }
    }

    fn pack(&self, packer: &mut Packer) {
        packer.push_number(self.group.index() as u64);
        packer.push_ascending(&self.customers);
        for (length, strength) in run_lengths(&self.strengths) {
            packer.push_number(length);
            packer.push_float(strength);
        }
        self.revenues.iter().for_each(|revenue| packer.push_float(*revenue));
    }

    fn unpack(unpacker: &mut Unpacker<'_>) -> Option<AdsRun> {
        let group = Group::at(unpacker.read_number()? as usize)?;
        let customers = unpacker.read_ascending()?;
        let mut strengths = Vec::with_capacity(customers.len());
        while strengths.len() < customers.len() {
            let (length, strength) = (unpacker.read_number()? as usize, unpacker.read_float()?);
            if length == 0 || length > customers.len() - strengths.len() {
                return None;
            }
            strengths.extend(std::iter::repeat_n(strength, length));
        }
        let revenues = customers.iter().map(|_| unpacker.read_float()).collect::<Option<_>>()?;
        Some(AdsRun { group, customers, strengths, revenues })
    }
}

/// Returns runs of equal values as (count, value).
fn run_lengths(values: &[f64]) -> impl Iterator<Item = (u64, f64)> + '_ {
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
        fn usage_runs_round_trip(runs in proptest::collection::vec(ascending(), 0..5), seed in any::<u32>()) {
            let runs = runs.into_iter().map(|customers| {
                let units = customers.iter().map(|customer| customer.wrapping_mul(seed)).collect();
                UsageRows { customers, units }
            });
            let runs: Vec<UsageRows> = runs.collect();
            let day = PackedDay::pack(9, &runs);
            prop_assert_eq!(PackedDay::from_bytes::<UsageRows>(9, day.as_bytes().to_vec()), Some(day.clone()));
            for (at, run) in runs.into_iter().enumerate() {
                prop_assert!(run.customers.iter().all(|customer| day.may_contain_customer(at, f64::from(*customer))));
                prop_assert_eq!(day.unpack_run(at), Some(run));
            }
        }

        #[test]
        fn damaged_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            let _ = PackedDay::from_bytes::<UsageRows>(1, bytes.clone());
            let _ = PackedDay::from_bytes::<AdsRun>(1, bytes);
        }
    }

    #[test]
    fn ads_runs_round_trip() {
        let row = |customer, group, strength| AdsRevenueRow {
            customer,
            group: Group::at(group).expect("a group"),
            strength,
            revenue: f64::from(customer) / 7.0,
        };
        let rows = [row(2, 0, 0.5), row(9, 0, 0.5), row(11, 0, 0.7), row(3, 1, 0.5), row(4, 1, 0.5)];
        let runs = AdsRun::runs_from_rows(&rows);
        assert_eq!(runs.len(), 2);
        let day = PackedDay::pack(12, &runs);
        assert_eq!(PackedDay::from_bytes::<AdsRun>(12, day.as_bytes().to_vec()), Some(day.clone()));
        assert_eq!(
            (day.unpack_run(0).as_ref(), day.unpack_run(1).as_ref()),
            (Some(&runs[0]), Some(&runs[1]))
        );
        assert_eq!(PackedDay::from_bytes::<AdsRun>(12, day.as_bytes()[1..].to_vec()), None);
        assert_eq!(
            PackedDay::from_bytes::<AdsRun>(12, day.as_bytes()[..day.as_bytes().len() - 1].to_vec()),
            None
        );
    }
}
