//! Days of usage and ad revenue as compact blocks: in memory for queries, as blobs in the file.

use std::sync::{Arc, RwLock};

use crate::world::events::{AdsRevenueRow, UsageRows};
use crate::world::identifiers::Group;

/// Usage of one day.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct UsageDay {
    pub day: u32,
    /// Runs of ascending customer numbers.
    pub runs: Vec<Arc<UsageRows>>,
}

/// Ad revenue of one day.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct AdsDay {
    pub day: u32,
    pub runs: Vec<AdsRun>,
}

/// Ad revenue of customers of one group, in ascending order of their numbers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AdsRun {
    pub group: Group,
    pub customers: Vec<u32>,
    pub strengths: Vec<f64>,
    pub revenues: Vec<f64>,
}

/// The days a query can see. A query takes the whole shelf at its start and is not disturbed by later days.
#[derive(Debug, Clone, Default)]
pub(super) struct Shelf {
    pub usage: Arc<Vec<Arc<UsageDay>>>,
    pub ads: Arc<Vec<Arc<AdsDay>>>,
}

/// The shelf that the writer fills and queries read.
pub(super) type SharedShelf = Arc<RwLock<Shelf>>;

impl AdsDay {
    pub fn from_rows(day: u32, rows: &[AdsRevenueRow]) -> AdsDay {
        let mut runs: Vec<AdsRun> = Vec::new();
        for row in rows {
            let continues =
                |run: &AdsRun| run.group == row.group && run.customers.last() < Some(&row.customer);
            if !runs.last().is_some_and(continues) {
                let (customers, strengths, revenues) = (Vec::new(), Vec::new(), Vec::new());
                runs.push(AdsRun { group: row.group, customers, strengths, revenues });
            }
            let run = runs.last_mut().expect("a run was just pushed");
            run.customers.push(row.customer);
            run.strengths.push(row.strength);
            run.revenues.push(row.revenue);
        }
        AdsDay { day, runs }
    }
}

/// Writes numbers of any size in as few bytes as they need.
#[derive(Default)]
struct Packer(Vec<u8>);

impl Packer {
    fn number(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }

    fn float(&mut self, value: f64) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    /// Ascending numbers as their differences.
    fn ascending(&mut self, values: &[u32]) {
        self.number(values.len() as u64);
        let mut before = 0;
        for &value in values {
            self.number(u64::from(value - before));
            before = value;
        }
    }
}

struct Unpacker<'a>(&'a [u8]);

impl Unpacker<'_> {
    fn number(&mut self) -> Option<u64> {
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

    fn small(&mut self) -> Option<u32> {
        u32::try_from(self.number()?).ok()
    }

    fn float(&mut self) -> Option<f64> {
        let (bytes, rest) = self.0.split_first_chunk::<8>()?;
        self.0 = rest;
        Some(f64::from_le_bytes(*bytes))
    }

    fn ascending(&mut self) -> Option<Vec<u32>> {
        let mut before = 0u32;
        (0..self.number()?)
            .map(|_| {
                before = before.checked_add(self.small()?)?;
                Some(before)
            })
            .collect()
    }
}

impl UsageDay {
    pub fn pack(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        packer.number(self.runs.len() as u64);
        for run in &self.runs {
            packer.ascending(&run.customers);
            run.units.iter().for_each(|units| packer.number(u64::from(*units)));
        }
        packer.0
    }

    /// None when the bytes are not those of a day.
    pub fn unpack(day: u32, bytes: &[u8]) -> Option<UsageDay> {
        let mut unpacker = Unpacker(bytes);
        let runs = (0..unpacker.number()?)
            .map(|_| {
                let customers = unpacker.ascending()?;
                let units = customers.iter().map(|_| unpacker.small()).collect::<Option<_>>()?;
                Some(Arc::new(UsageRows { customers, units }))
            })
            .collect::<Option<_>>()?;
        unpacker.0.is_empty().then_some(UsageDay { day, runs })
    }
}

impl AdsDay {
    pub fn pack(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        packer.number(self.runs.len() as u64);
        for run in &self.runs {
            packer.number(run.group.index() as u64);
            packer.ascending(&run.customers);
            for (length, strength) in lengths(&run.strengths) {
                packer.number(length);
                packer.float(strength);
            }
            run.revenues.iter().for_each(|revenue| packer.float(*revenue));
        }
        packer.0
    }

    /// None when the bytes are not those of a day.
    pub fn unpack(day: u32, bytes: &[u8]) -> Option<AdsDay> {
        let mut unpacker = Unpacker(bytes);
        let runs = (0..unpacker.number()?)
            .map(|_| {
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
            })
            .collect::<Option<_>>()?;
        unpacker.0.is_empty().then_some(AdsDay { day, runs })
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
                Arc::new(UsageRows { customers, units })
            });
            let day = UsageDay { day: 9, runs: runs.collect() };
            prop_assert_eq!(UsageDay::unpack(9, &day.pack()), Some(day));
        }

        #[test]
        fn damaged_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            let _ = UsageDay::unpack(1, &bytes);
            let _ = AdsDay::unpack(1, &bytes);
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
        let day = AdsDay::from_rows(12, &rows);
        assert_eq!(day.runs.len(), 2);
        let packed = day.pack();
        assert_eq!(AdsDay::unpack(12, &packed), Some(day));
        assert_eq!(AdsDay::unpack(12, &packed[..packed.len() - 1]), None);
    }
}
