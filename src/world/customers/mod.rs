//! Customers: their traits, their decisions, and the columns of active subscribers.

pub mod choice;
pub mod columns;
pub mod curve;
pub mod drift;
pub mod numbers;
pub mod persona;
pub mod traits;

use rayon::prelude::*;

use super::canonical::{Canonical, CanonicalHasher, Stretch, canonical, hash_of_stretches};
use super::identifiers::{ByGroup, Group};
use columns::{BLOCK, Block, Subscriber};
use numbers::{ArrivalRun, CustomerNumbers};

/// The first real customer. Number 1 is the market observer, the author of posts that no customer wrote.
pub const FIRST_CUSTOMER: u32 = 2;

/// How blocks are distributed among threads. Waking a thread costs as much as processing some thousand customers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shares {
    /// A few blocks per task: customers who arrived on the same day are billed on the same day, so the work
    /// of a day is concentrated in a few adjacent blocks.
    Small,
    /// Many blocks per task, for work that is cheap for every customer.
    Large,
}

/// Fewer blocks than this are processed on one thread.
const PARALLEL_FROM: usize = 8;
/// Maximum blocks of a small task.
const SMALL: usize = 2;
/// Minimum blocks of a large task.
const LARGE: usize = 24;

/// All customers of a run: active ones as columns; of the others, only their numbers.
#[derive(Debug, Clone)]
pub struct Customers {
    /// By group.
    pub groups: ByGroup<GroupCustomers>,
    /// Number of the next customer.
    pub next_customer: u32,
    /// Number of the next subscription.
    pub next_subscription: u32,
    /// Customer numbers by day of arrival.
    pub numbers: CustomerNumbers,
}

/// Customers of one group.
#[derive(Debug, Clone, Default)]
pub struct GroupCustomers {
    /// Number of customers ever generated.
    pub created: u32,
    /// Block k holds the active customers with running numbers k * BLOCK + 1 ..= (k + 1) * BLOCK.
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
    /// Returns the number of active subscriptions.
    pub fn active(&self) -> u32 {
        self.blocks.iter().map(|block| block.len() as u32).sum()
    }

    /// Returns the block of a running number and creates it if necessary.
    fn block_of(&mut self, n: u32) -> &mut Block {
        let block = block_number(n);
        if self.blocks.len() <= block {
            self.blocks.resize_with(block + 1, Block::default);
        }
        let block = &mut self.blocks[block];
        if block.n.capacity() == 0 {
            // Most blocks fill up within days, so allocating full capacity is cheaper than growing 27 columns
            // repeatedly.
            *block = Block::with_room(BLOCK as usize);
        }
        block
    }

    /// Appends active subscribers with ascending running numbers, larger than all existing ones.
    pub fn enrol(&mut self, rows: &[Subscriber]) {
        for rows in rows.chunk_by(|one, next| block_number(one.n) == block_number(next.n)) {
            let block = self.block_of(rows[0].n);
            debug_assert!(block.n.last().is_none_or(|last| *last < rows[0].n), "numbers ascend");
            block.extend(rows);
        }
    }

    /// Inserts an active subscriber at the position of its running number.
    pub fn activate(&mut self, row: Subscriber) {
        let block = self.block_of(row.n);
        match block.n.binary_search(&row.n) {
            Err(at) if at == block.len() => block.push(row),
            Err(at) => block.insert(at, row),
            Ok(_) => debug_assert!(false, "customer {} is active already", row.customer),
        }
    }

    /// Returns the block and position of the active subscriber with this running number.
    pub fn place(&self, n: u32) -> Option<(usize, usize)> {
        let block = block_number(n);
        let at = self.blocks.get(block)?.position(n)?;
        Some((block, at))
    }

    /// Returns the active subscriber with this running number.
    pub fn row(&self, n: u32) -> Option<Subscriber> {
        self.place(n).map(|(block, at)| self.blocks[block].row(at))
    }

    /// Removes an active subscriber and returns it.
    pub fn deactivate(&mut self, n: u32) -> Option<Subscriber> {
        let (block, at) = self.place(n)?;
        let row = self.blocks[block].row(at);
        self.blocks[block].remove(&[at]);
        Some(row)
    }
}

impl Customers {
    /// Returns active subscriptions by group; an enterprise account counts once.
    pub fn active(&self) -> ByGroup<u32> {
        ByGroup::from_fn(|group| self.groups[group].active())
    }

    /// Records the arrival of `count` customers with consecutive numbers.
    pub fn arrive(&mut self, day: u32, group: Group, count: u32) -> ArrivalRun {
        let own = &mut self.groups[group];
        let run =
            ArrivalRun { day, group, first_customer: self.next_customer, first_n: own.created + 1, count };
        own.created += count;
        self.next_customer += count;
        self.numbers.give(run);
        run
    }

    /// Returns group and running number of a customer, or `None` if the number was never assigned.
    pub fn find(&self, customer: u32) -> Option<(Group, u32)> {
        self.numbers.find(customer)
    }

    /// Processes all non-empty blocks, on several threads if there are many. Results are in group and block
    /// order regardless of the number of threads.
    pub fn sweep<R: Send>(&mut self, work: impl Fn(Group, u32, &mut Block) -> R + Sync) -> Vec<R> {
        shared_out(self.jobs(), Shares::Small, |(group, at, block)| work(group, at, block))
    }

    /// Processes all non-empty blocks like [`Customers::sweep`], each with the matching result of an earlier sweep.
    pub fn sweep_with<T: Send, R: Send>(
        &mut self,
        found: Vec<T>,
        work: impl Fn(Group, u32, &mut Block, T) -> R + Sync,
    ) -> Vec<R> {
        let jobs = self.jobs();
        debug_assert_eq!(jobs.len(), found.len(), "no customer may arrive or leave between the sweeps");
        let jobs = jobs.into_iter().zip(found).collect();
        shared_out(jobs, Shares::Small, |((group, at, block), own)| work(group, at, block, own))
    }

    /// Processes all non-empty blocks like [`Customers::sweep`], for work that is cheap per block.
    pub fn skim<R: Send>(&mut self, work: impl Fn(Group, &mut Block) -> R + Sync) -> Vec<R> {
        shared_out(self.jobs(), Shares::Large, |(group, _, block)| work(group, block))
    }

    fn jobs(&mut self) -> Vec<(Group, u32, &mut Block)> {
        let mut jobs = Vec::new();
        for (group, own) in Group::all().zip(&mut self.groups.0) {
            let blocks = own.blocks.iter_mut().enumerate();
            jobs.extend(
                blocks.filter(|(_, block)| !block.is_empty()).map(|(at, block)| (group, at as u32, block)),
            );
        }
        jobs
    }

    /// Reads all non-empty blocks, on several threads if there are many. Results are in group and block order.
    pub fn survey<R: Send>(&self, look: impl Fn(Group, &Block) -> R + Sync) -> Vec<R> {
        shared_out(self.blocks().collect(), Shares::Large, |(group, block)| look(group, block))
    }

    /// Returns the hash of the canonical bytes, computed on several threads because customers are most of the state.
    pub fn hash(&self) -> blake3::Hash {
        let Customers { groups, next_customer, next_subscription, numbers } = self;
        let mut stretches = Vec::new();
        for GroupCustomers { created, blocks } in &groups.0 {
            stretches.push(Stretch::new(size_of::<u32>() + size_of::<u64>(), |hasher| {
                created.feed(hasher);
                (blocks.len() as u64).feed(hasher);
            }));
            let block = |block| Stretch::new(Block::canonical_length(block), |hasher| block.feed(hasher));
            stretches.extend(blocks.iter().map(block));
        }
        let mut rest = CanonicalHasher::collector(0);
        (*next_customer, *next_subscription).feed(&mut rest);
        numbers.feed(&mut rest);
        let rest = rest.into_bytes();
        stretches.push(Stretch::new(rest.len(), move |hasher| hasher.bytes(&rest)));
        hash_of_stretches(&stretches)
    }

    /// Returns all non-empty blocks in group and block order.
    pub fn blocks(&self) -> impl Iterator<Item = (Group, &Block)> {
        self.groups
            .pairs()
            .flat_map(|(group, own)| own.blocks.iter().map(move |block| (group, block)))
            .filter(|(_, block)| !block.is_empty())
    }
}

/// Runs one job per block, on several threads if there are many. Results keep the order of the jobs.
fn shared_out<J: Send, R: Send>(jobs: Vec<J>, shares: Shares, work: impl Fn(J) -> R + Sync) -> Vec<R> {
    match shares {
        _ if jobs.len() < PARALLEL_FROM => jobs.into_iter().map(work).collect(),
        Shares::Small => jobs.into_par_iter().with_max_len(SMALL).map(&work).collect(),
        Shares::Large => jobs.into_par_iter().with_min_len(LARGE).map(&work).collect(),
    }
}

fn block_number(n: u32) -> usize {
    ((n - 1) / BLOCK) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canonical::hash_of;
    use crate::test_kit::subscriber;

    #[test]
    fn numbers_are_consecutive_over_groups_and_found_again() {
        let mut customers = Customers::default();
        let (s1, e1) = (Group::at(0).expect("S1"), Group::at(3).expect("E1"));
        customers.arrive(1, s1, 3);
        customers.arrive(1, e1, 1);
        customers.arrive(2, s1, 2);
        assert_eq!(customers.find(1), None);
        assert_eq!(customers.find(4), Some((s1, 3)));
        assert_eq!(customers.find(5), Some((e1, 1)));
        assert_eq!(customers.find(7), Some((s1, 5)));
        assert_eq!(customers.find(8), None);
    }

    #[test]
    fn the_hash_of_threads_is_the_hash_of_all_bytes() {
        let mut customers = Customers::default();
        assert_eq!(customers.hash(), hash_of(&customers));
        for (group, count) in Group::all().zip([20_000, 3, 0, 1_024]) {
            let run = customers.arrive(1, group, count);
            for (n, _) in run.numbers().filter(|(n, _)| n % 5 > 0) {
                customers.groups[group].activate(subscriber(n));
            }
        }
        assert_eq!(customers.hash(), hash_of(&customers));
    }

    #[test]
    fn late_deals_find_their_place_and_sweeps_keep_their_order() {
        let mut group = GroupCustomers::default();
        for n in [5, 2000, 3, 1024, 1025] {
            group.activate(subscriber(n));
        }
        assert_eq!(group.active(), 5);
        assert_eq!((group.place(1025), group.row(4), group.row(9000)), (Some((1, 0)), None, None));
        assert_eq!(group.deactivate(5).map(|row| row.n), Some(5));
        assert_eq!((group.deactivate(5), group.active()), (None, 4));
        group.activate(subscriber(5));
        group.enrol(&[subscriber(2001), subscriber(2048), subscriber(2049)]);
        assert_eq!(group.blocks[2].n, [2049]);
        assert_eq!(group.blocks[0].n, [3, 5, 1024]);
        assert_eq!(group.blocks[1].n, [1025, 2000, 2001, 2048]);
        let mut customers = Customers::default();
        customers.groups[Group::at(1).expect("S2")] = group;
        let seen = customers.sweep(|group, at, block| (group.id(), at, block.len()));
        assert_eq!(seen, [("S2", 0, 3), ("S2", 1, 4), ("S2", 2, 1)]);
    }
}
