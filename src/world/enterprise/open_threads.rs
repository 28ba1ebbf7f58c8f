//! Open threads by company, for calls that name many companies: of a large company's threads, few are open.

use std::collections::BTreeMap;

use super::Thread;

/// The open threads of a state, by company.
pub struct OpenThreads<'a> {
    /// Each company's, the one with the newest turn last.
    by_customer: BTreeMap<u32, Vec<&'a Thread>>,
}

impl<'a> OpenThreads<'a> {
    /// Those of a list.
    pub(super) fn among(threads: &'a [Thread]) -> OpenThreads<'a> {
        let mut by_customer: BTreeMap<u32, Vec<&Thread>> = BTreeMap::new();
        for thread in threads.iter().filter(|thread| thread.is_open()) {
            by_customer.entry(thread.customer).or_default().push(thread);
        }
        for own in by_customer.values_mut() {
            own.sort_by_key(|thread| thread.last().message);
        }
        OpenThreads { by_customer }
    }

    /// The one of a company with the newest turn.
    pub fn newest(&self, customer: u32) -> Option<&'a Thread> {
        self.by_customer.get(&customer)?.last().copied()
    }

    /// The same, taken out: the next one of the company is another.
    pub fn take_newest(&mut self, customer: u32) -> Option<&'a Thread> {
        self.by_customer.get_mut(&customer)?.pop()
    }
}
