//! Customers: their traits, their decisions, and the columns of active subscribers.

pub mod choice;
pub mod columns;
pub mod curve;
pub mod customer_numbers;
pub mod drift;
pub mod persona;
pub mod traits;

use rayon::prelude::*;

use super::canonical::{Canonical, CanonicalHasher, HashSegment, canonical, hash_segments};
use super::identifiers::{ByGroup, Group};
use columns::{Block, CUSTOMERS_PER_BLOCK, Subscriber};
use customer_numbers::{ArrivalRun, CustomerNumbers};

/// Number of the first real customer. Number 1 is the market observer, the author of posts that no customer wrote.
pub const FIRST_CUSTOMER: u32 = 2;

/// How blocks are distributed among threads. Waking a thread costs as much time as processing several thousand
/// customers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum WorkSplit {
    /// A few blocks per task, because a few adjacent blocks account for most of the work of a day: customers who
    /// arrived on the same day are billed on the same day.
    Small,
    /// Many blocks per task, for work that takes little time per customer.
    Large,
}

/// Minimum number of blocks that are processed on several threads.
const MIN_PARALLEL_BLOCKS: usize = 8;
/// Maximum number of blocks per task with [`WorkSplit::Small`].
const MAX_SMALL_SPLIT_BLOCKS: usize = 2;
/// Minimum number of blocks per task with [`WorkSplit::Large`].
const MIN_LARGE_SPLIT_BLOCKS: usize = 24;

/// All customers of a run. Active customers are stored in columns. For other customers, only the numbers are stored.
#[derive(Debug, Clone)]
pub struct Customers {
    /// Active customers of each group, and the number of its customers so far.
    pub groups: ByGroup<GroupCustomers>,
    /// Customer number that the next lead receives, from [`FIRST_CUSTOMER`].
    pub next_customer: u32,
    /// Number that the next subscription row receives, from 1.
    pub next_subscription: u32,
    /// Mapping between customer numbers, groups and days of arrival.
    pub numbers: CustomerNumbers,
}

/// The customers of one group.
#[derive(Debug, Clone, Default)]
pub struct GroupCustomers {
    /// Number of customers generated since day 0.
    pub created: u32,
    /// Blocks of active customers. Block k contains the sequence numbers k * n + 1 ..= (k + 1) * n, where n is
    /// [`CUSTOMERS_PER_BLOCK`].
    pub blocks: Vec<Block>,
}

canonical! {
    Customers { groups, next_customer, next_subscription, numbers }
    GroupCustomers { created, blocks }
}

impl Default for Customers {
    fn default() -> Self {
        Customers {
            groups: ByGroup::default(),
            next_customer: FIRST_CUSTOMER,
            next_subscription: 1,
            numbers: CustomerNumbers::default(),
        }
    }
}

impl GroupCustomers {
    /// Returns the number of active subscriptions in the group.
    pub fn active_count(&self) -> u32 {
        self.blocks.iter().map(|block| block.len() as u32).sum()
    }

    /// Returns the block for a sequence number. Creates the block if necessary.
    fn block_for(&mut self, n: u32) -> &mut Block {
        let block = block_number(n);
        if self.blocks.len() <= block {
            self.blocks.resize_with(block + 1, Block::default);
        }
        let block = &mut self.blocks[block];
        if block.n.capacity() == 0 {
            // Most blocks fill up within days, so allocating full capacity is cheaper than growing 27 columns
            // repeatedly.
            *block = Block::with_capacity(CUSTOMERS_PER_BLOCK as usize);
        }
        block
    }

    /// Appends active subscribers. The sequence numbers of `rows` must be ascending and larger than all existing
    /// sequence numbers.
    pub fn append_subscribers(&mut self, rows: &[Subscriber]) {
        for rows in rows.chunk_by(|one, next| block_number(one.n) == block_number(next.n)) {
            let block = self.block_for(rows[0].n);
            debug_assert!(block.n.last().is_none_or(|last| *last < rows[0].n), "numbers ascend");
            block.extend(rows);
        }
    }

    /// Inserts an active subscriber in the order of sequence numbers.
    pub fn activate(&mut self, row: Subscriber) {
        let block = self.block_for(row.n);
        match block.n.binary_search(&row.n) {
            Err(at) if at == block.len() => block.push(row),
            Err(at) => block.insert(at, row),
            Ok(_) => debug_assert!(false, "customer {} is active already", row.customer),
        }
    }

    /// Returns the block and position of the active subscriber with this sequence number.
    pub fn subscriber_position(&self, n: u32) -> Option<(usize, usize)> {
        let block = block_number(n);
        let at = self.blocks.get(block)?.position(n)?;
        Some((block, at))
    }

    /// Returns the active subscriber with this sequence number.
    pub fn subscriber(&self, n: u32) -> Option<Subscriber> {
        self.subscriber_position(n).map(|(block, at)| self.blocks[block].row(at))
    }

    /// Removes the active subscriber with this sequence number and returns its row.
    pub fn deactivate(&mut self, n: u32) -> Option<Subscriber> {
        let (block, at) = self.subscriber_position(n)?;
        let row = self.blocks[block].row(at);
        self.blocks[block].remove(&[at]);
        Some(row)
    }
}

impl Customers {
    /// Returns the number of active subscriptions of each group. An enterprise counts once, regardless of its number of
    /// seats.
    pub fn active_by_group(&self) -> ByGroup<u32> {
        ByGroup::from_fn(|group| self.groups[group].active_count())
    }

    /// Records the arrival of `count` customers with consecutive numbers.
    pub fn record_arrival(&mut self, day: u32, group: Group, count: u32) -> ArrivalRun {
        let group_customers = &mut self.groups[group];
        let run = ArrivalRun {
            day,
            group,
            first_customer: self.next_customer,
            first_n: group_customers.created + 1,
            count,
        };
        group_customers.created += count;
        self.next_customer += count;
        self.numbers.add(run);
        run
    }

    /// Returns the group and the sequence number of a customer, or `None` if the number was never assigned.
    pub fn find(&self, customer: u32) -> Option<(Group, u32)> {
        self.numbers.find(customer)
    }

    /// Processes all non-empty blocks, on several threads if there are many blocks. Results are in group and block
    /// order for any number of threads.
    pub fn sweep<R: Send>(&mut self, work: impl Fn(Group, u32, &mut Block) -> R + Sync) -> Vec<R> {
        run_in_parallel(self.nonempty_blocks_mut(), WorkSplit::Small, |(group, at, block)| {
            work(group, at, block)
        })
    }

    /// Processes all non-empty blocks like [`Customers::sweep`]. `work` also receives the block's result from an
    /// earlier sweep.
    pub fn sweep_with<T: Send, R: Send>(
        &mut self,
        block_results: Vec<T>,
        work: impl Fn(Group, u32, &mut Block, T) -> R + Sync,
    ) -> Vec<R> {
        let jobs = self.nonempty_blocks_mut();
        debug_assert_eq!(
            jobs.len(),
            block_results.len(),
            "no customer may arrive or leave between the sweeps"
        );
        let jobs = jobs.into_iter().zip(block_results).collect();
        run_in_parallel(jobs, WorkSplit::Small, |((group, at, block), item)| work(group, at, block, item))
    }

    /// Processes all non-empty blocks like [`Customers::sweep`], for work that takes little time per block.
    pub fn sweep_light<R: Send>(&mut self, work: impl Fn(Group, &mut Block) -> R + Sync) -> Vec<R> {
        run_in_parallel(self.nonempty_blocks_mut(), WorkSplit::Large, |(group, _, block)| work(group, block))
    }

    fn nonempty_blocks_mut(&mut self) -> Vec<(Group, u32, &mut Block)> {
        let mut jobs = Vec::new();
        for (group, group_customers) in Group::all().zip(&mut self.groups.0) {
            let blocks = group_customers.blocks.iter_mut().enumerate();
            jobs.extend(
                blocks.filter(|(_, block)| !block.is_empty()).map(|(at, block)| (group, at as u32, block)),
            );
        }
        jobs
    }

    /// Calls `apply` for all non-empty blocks, on several threads if there are many blocks. Returns the results in
    /// group and block order.
    pub fn map_blocks<R: Send>(&self, apply: impl Fn(Group, &Block) -> R + Sync) -> Vec<R> {
        run_in_parallel(self.blocks().collect(), WorkSplit::Large, |(group, block)| apply(group, block))
    }

    /// Returns the hash of the customers' canonical bytes. The hash is computed on several threads, because customers
    /// make up most of the state.
    pub fn hash(&self) -> blake3::Hash {
        let Customers { groups, next_customer, next_subscription, numbers } = self;
        let mut segments = Vec::new();
        for GroupCustomers { created, blocks } in &groups.0 {
            segments.push(HashSegment::new(size_of::<u32>() + size_of::<u64>(), |hasher| {
                created.feed(hasher);
                (blocks.len() as u64).feed(hasher);
            }));
            let block = |block| HashSegment::new(Block::canonical_length(block), |hasher| block.feed(hasher));
            segments.extend(blocks.iter().map(block));
        }
        let mut rest = CanonicalHasher::collector(0);
        (*next_customer, *next_subscription).feed(&mut rest);
        numbers.feed(&mut rest);
        let rest = rest.into_bytes();
        segments.push(HashSegment::new(rest.len(), move |hasher| hasher.append_bytes(&rest)));
        hash_segments(&segments)
    }

    /// Returns all non-empty blocks in group and block order.
    pub fn blocks(&self) -> impl Iterator<Item = (Group, &Block)> {
        self.groups
            .pairs()
            .flat_map(|(group, group_customers)| {
                group_customers.blocks.iter().map(move |block| (group, block))
            })
            .filter(|(_, block)| !block.is_empty())
    }
}

/// Runs one job per block, on several threads if there are many blocks. Results keep the order of the jobs.
fn run_in_parallel<J: Send, R: Send>(
    jobs: Vec<J>,
    work_split: WorkSplit,
    work: impl Fn(J) -> R + Sync,
) -> Vec<R> {
    match work_split {
        _ if jobs.len() < MIN_PARALLEL_BLOCKS => jobs.into_iter().map(work).collect(),
        WorkSplit::Small => jobs.into_par_iter().with_max_len(MAX_SMALL_SPLIT_BLOCKS).map(&work).collect(),
        WorkSplit::Large => jobs.into_par_iter().with_min_len(MIN_LARGE_SPLIT_BLOCKS).map(&work).collect(),
    }
}

fn block_number(n: u32) -> usize {
    ((n - 1) / CUSTOMERS_PER_BLOCK) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canonical::canonical_hash;
    use crate::test_kit::subscriber;

    #[test]
    fn customer_numbers_are_consecutive_and_searchable() {
        let mut customers = Customers::default();
        let (s1, e1) = (Group::at(0).expect("S1"), Group::at(3).expect("E1"));
        customers.record_arrival(1, s1, 3);
        customers.record_arrival(1, e1, 1);
        customers.record_arrival(2, s1, 2);
        assert_eq!(customers.find(1), None);
        assert_eq!(customers.find(4), Some((s1, 3)));
        assert_eq!(customers.find(5), Some((e1, 1)));
        assert_eq!(customers.find(7), Some((s1, 5)));
        assert_eq!(customers.find(8), None);
    }

    #[test]
    fn parallel_hash_matches_canonical_hash() {
        let mut customers = Customers::default();
        assert_eq!(customers.hash(), canonical_hash(&customers));
        for (group, count) in Group::all().zip([20_000, 3, 0, 1_024]) {
            let run = customers.record_arrival(1, group, count);
            for (n, _) in run.numbers().filter(|(n, _)| n % 5 > 0) {
                customers.groups[group].activate(subscriber(n));
            }
        }
        assert_eq!(customers.hash(), canonical_hash(&customers));
    }

    #[test]
    fn activate_keeps_order_and_sweeps_visit_in_order() {
        let mut group = GroupCustomers::default();
        for n in [5, 2000, 3, 1024, 1025] {
            group.activate(subscriber(n));
        }
        assert_eq!(group.active_count(), 5);
        assert_eq!(
            (group.subscriber_position(1025), group.subscriber(4), group.subscriber(9000)),
            (Some((1, 0)), None, None)
        );
        assert_eq!(group.deactivate(5).map(|row| row.n), Some(5));
        assert_eq!((group.deactivate(5), group.active_count()), (None, 4));
        group.activate(subscriber(5));
        group.append_subscribers(&[subscriber(2001), subscriber(2048), subscriber(2049)]);
        assert_eq!(group.blocks[2].n, [2049]);
        assert_eq!(group.blocks[0].n, [3, 5, 1024]);
        assert_eq!(group.blocks[1].n, [1025, 2000, 2001, 2048]);
        let mut customers = Customers::default();
        customers.groups[Group::at(1).expect("S2")] = group;
        let seen = customers.sweep(|group, at, block| (group.id(), at, block.len()));
        assert_eq!(seen, [("S2", 0, 3), ("S2", 1, 4), ("S2", 2, 1)]);
    }
}
