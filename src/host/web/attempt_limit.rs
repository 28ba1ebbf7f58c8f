//! Limits for wrong tokens and codes: after each failure, an address has to wait longer.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Number of addresses that are remembered. If more addresses fail, the one whose failure is oldest is forgotten.
const MAX_ADDRESSES: usize = 10_000;
/// Time after which failures are forgotten.
const FORGET_AFTER: Duration = Duration::from_secs(15 * 60);
/// The longest time that an address has to wait.
const MAX_DELAY: Duration = Duration::from_secs(60);

/// Counts failures by address. The first failures are free; after that, the waiting time doubles with each failure.
#[derive(Debug)]
pub(super) struct AttemptLimit {
    free_failures: u32,
    failures: Mutex<HashMap<IpAddr, Failures>>,
}

#[derive(Debug, Clone, Copy)]
struct Failures {
    count: u32,
    last: Instant,
}

impl AttemptLimit {
    /// Creates a limit that allows this number of failures without a waiting time.
    pub fn new(free_failures: u32) -> AttemptLimit {
        AttemptLimit { free_failures, failures: Mutex::default() }
    }

    /// Returns the time that an address has to wait before its next attempt, or `None` if it may try now.
    pub fn delay(&self, address: IpAddr, now: Instant) -> Option<Duration> {
        let failures =
            *self.failures.lock().unwrap_or_else(PoisonError::into_inner).get(&network(address))?;
        let doublings = failures.count.checked_sub(self.free_failures + 1)?;
        let delay = MAX_DELAY.min(Duration::from_secs(1 << doublings.min(6)));
        delay.checked_sub(now.duration_since(failures.last)).filter(|left| !left.is_zero())
    }

    /// Counts a failure of an address. Returns the number of its failures.
    pub fn record_failure(&self, address: IpAddr, now: Instant) -> u32 {
        let mut failures = self.failures.lock().unwrap_or_else(PoisonError::into_inner);
        if failures.len() >= MAX_ADDRESSES {
            failures.retain(|_, failures| now.duration_since(failures.last) < FORGET_AFTER);
        }
        if failures.len() >= MAX_ADDRESSES {
            let oldest =
                failures.iter().min_by_key(|(_, failures)| failures.last).map(|(address, _)| *address);
            oldest.map(|address| failures.remove(&address));
        }
        let failures = failures.entry(network(address)).or_insert(Failures { count: 0, last: now });
        if now.duration_since(failures.last) >= FORGET_AFTER {
            failures.count = 0;
        }
        failures.count = failures.count.saturating_add(1);
        failures.last = now;
        failures.count
    }

    /// Forgets the failures of an address.
    pub fn record_success(&self, address: IpAddr) {
        self.failures.lock().unwrap_or_else(PoisonError::into_inner).remove(&network(address));
    }
}

/// Returns the address, or the first 64 bits of an IPv6 address, because one client usually has all addresses of such a network.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => IpAddr::V6((u128::from(address) >> 64 << 64).into()),
        address => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> IpAddr {
        text.parse().expect("an address")
    }

    #[test]
    fn waiting_time_doubles_after_the_free_failures() {
        let (limit, start) = (AttemptLimit::new(2), Instant::now());
        let client = address("192.0.2.7");
        let delays = (0..12)
            .map(|_| {
                limit.record_failure(client, start);
                limit.delay(client, start).map_or(0, |delay| delay.as_secs())
            })
            .collect::<Vec<_>>();
        assert_eq!(delays, [0, 0, 1, 2, 4, 8, 16, 32, 60, 60, 60, 60]);
        assert_eq!(limit.delay(client, start + MAX_DELAY), None);
        assert_eq!(limit.delay(address("192.0.2.8"), start), None);
        limit.record_success(client);
        assert_eq!(limit.delay(client, start), None);
    }

    #[test]
    fn failures_are_forgotten_and_their_number_is_bounded() {
        let (limit, start) = (AttemptLimit::new(0), Instant::now());
        for number in 0..MAX_ADDRESSES as u32 + 10 {
            limit.record_failure(IpAddr::V4(number.into()), start + Duration::from_millis(u64::from(number)));
        }
        assert_eq!(limit.failures.lock().expect("failures").len(), MAX_ADDRESSES);
        let later = start + FORGET_AFTER * 2;
        assert_eq!(limit.record_failure(address("192.0.2.7"), later), 1);
        assert_eq!(limit.failures.lock().expect("failures").len(), 1);
        assert_eq!(limit.record_failure(address("192.0.2.7"), later + FORGET_AFTER), 1);
    }

    #[test]
    fn addresses_of_an_ipv6_network_count_together() {
        let (limit, start) = (AttemptLimit::new(0), Instant::now());
        limit.record_failure(address("2001:db8:1:2::1"), start);
        assert!(limit.delay(address("2001:db8:1:2:ffff::9"), start).is_some());
        assert!(limit.delay(address("2001:db8:1:3::1"), start).is_none());
    }
}
