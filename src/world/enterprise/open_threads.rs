//! An index of open threads by enterprise, for calls that name many enterprises. Few of their threads are open.

use std::collections::BTreeMap;

use super::Thread;

/// The open threads of a state by enterprise.
pub struct OpenThreads<'a> {
    /// Threads of each enterprise, sorted by newest turn.
    by_customer: BTreeMap<u32, Vec<&'a Thread>>,
}

impl<'a> OpenThreads<'a> {
    /// Indexes the open threads of a list.
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

    /// Returns the enterprise's thread with the newest turn.
    pub fn newest(&self, customer: u32) -> Option<&'a Thread> {
        self.by_customer.get(&customer)?.last().copied()
    }

    /// Removes and returns the enterprise's thread with the newest turn.
    pub fn pop_newest(&mut self, customer: u32) -> Option<&'a Thread> {
        self.by_customer.get_mut(&customer)?.pop()
    }
}
