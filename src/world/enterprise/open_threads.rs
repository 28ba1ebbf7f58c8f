//! An index of open threads by enterprise, for tool calls that name many enterprises. The index is small, because few
//! threads are open at a time.

use std::collections::BTreeMap;

use super::Thread;

/// Index of the open threads of all enterprises.
pub struct OpenThreads<'a> {
    /// Open threads of each enterprise, sorted by newest turn.
    by_customer: BTreeMap<u32, Vec<&'a Thread>>,
}

impl<'a> OpenThreads<'a> {
    /// Creates an index of the open threads in a list.
    pub(super) fn from_threads(threads: &'a [Thread]) -> OpenThreads<'a> {
        let mut by_customer: BTreeMap<u32, Vec<&Thread>> = BTreeMap::new();
        for thread in threads.iter().filter(|thread| thread.is_open()) {
            by_customer.entry(thread.customer).or_default().push(thread);
        }
        for customer_threads in by_customer.values_mut() {
            customer_threads.sort_by_key(|thread| thread.last().message);
        }
        OpenThreads { by_customer }
    }

    /// Returns the enterprise's open thread with the newest turn.
    pub fn newest(&self, customer: u32) -> Option<&'a Thread> {
        self.by_customer.get(&customer)?.last().copied()
    }

    /// Removes the enterprise's open thread with the newest turn from the index and returns it.
    pub fn pop_newest(&mut self, customer: u32) -> Option<&'a Thread> {
        self.by_customer.get_mut(&customer)?.pop()
    }
}
