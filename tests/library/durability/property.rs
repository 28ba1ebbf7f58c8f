//! Invariants of runs with random actions: cash is the sum of the ledger, and every subscriber is a customer. The same
//! decisions lead to the same state, with interruptions at any point, on one thread and on two threads.
//!
//! A test run plays 16 random runs, `.ci/full` plays 1,000.

use std::path::Path;

use novamind::database::Cell;
use novamind::record::trajectory::Trajectory;
use novamind::session::{Session, verify};

use super::random_play::{advance_week, apply_random_action, apply_random_actions};
use super::run::{create_run, open_run, temporary_runs_folder};
use crate::support::company::apply_opening_decisions;
use crate::support::dice::Dice;

const WEEKS: usize = 10;

fn query_number(session: &mut Session, sql: &str) -> f64 {
    match session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows[0][0] {
        Cell::Integer(number) => number as f64,
        Cell::Real(number) => number,
        ref other => panic!("{sql}: {other:?}"),
    }
}

fn check_invariants(session: &mut Session, seed: u64) {
    let cash = *session.cash_by_day().last().expect("a day");
    let ledger = query_number(session, "SELECT SUM(amount) FROM ledger");
    let scale = query_number(session, "SELECT SUM(ABS(amount)) FROM ledger");
    assert!((cash - ledger).abs() <= 1e-9 * scale, "run {seed}: cash {cash}, ledger {ledger}");
    let lost =
        "SELECT COUNT(*) FROM subscriptions WHERE customer_id NOT IN (SELECT customer_id FROM customers)";
    assert_eq!(query_number(session, lost), 0.0, "run {seed}");
    let twice = "SELECT COUNT(*) FROM (SELECT customer_id FROM subscriptions WHERE status = 'subscribed' \
                 GROUP BY customer_id HAVING COUNT(*) > 1)";
    assert_eq!(query_number(session, twice), 0.0, "run {seed}");
    let subscribed = query_number(
        session,
        "SELECT COUNT(*) FROM subscriptions JOIN customers USING (customer_id) \
         WHERE status = 'subscribed' AND customer_type = 'small'",
    );
    assert_eq!(subscribed, f64::from(session.company().observe().subscribers), "run {seed}");
    let odd =
        "SELECT COUNT(*) FROM service_day WHERE error_rate < 0 OR error_rate > 1 OR total_usage_units < 0";
    assert_eq!(query_number(session, odd), 0.0, "run {seed}");
    // Noise with a standard deviation of 50 ms can make latency negative, but latency must be within eight standard
    // deviations of its mean.
    let latency = "SELECT COUNT(*) FROM service_day WHERE p95_ms IS NULL OR ABS(p95_ms - 180 \
                   - 800 * MAX(0, 1.0 * total_usage_units / capacity_units - 1)) > 400";
    assert_eq!(query_number(session, latency), 0.0, "run {seed}");
    let issues = "SELECT COUNT(*) FROM issues WHERE days_open < 0";
    assert_eq!(query_number(session, issues), 0.0, "run {seed}");
}

/// Returns the state hash of a run, simulated from its first line on a number of threads.
fn verified_state(folder: &Path, threads: usize) -> String {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| verify(folder)).unwrap_or_else(|error| panic!("{error}")).state_hash
}

fn check_random_run(seed: u64) {
    let place = temporary_runs_folder();
    let mut dice = Dice::new(seed);
    let mut session = create_run(place.path(), 1000 + seed, 365);
    let folder = session.folder().expect("a folder").to_owned();
    if dice.roll(4) > 0 {
        apply_opening_decisions(&mut session);
    }
    for _ in 0..WEEKS {
        apply_random_actions(&mut session, &mut dice);
        if dice.roll(3) == 0 {
            // The session is closed properly, or dropped as at the end of a program.
            if dice.roll(2) == 0 {
                session.save().expect("saved");
            }
            let (before, observed) = (session.state_hash(), session.company().observe());
            drop(session);
            session = open_run(&folder);
            assert_eq!((session.state_hash(), session.company().observe()), (before, observed), "run {seed}");
            apply_random_action(&mut session, &mut dice);
        }
        advance_week(&mut session);
        check_invariants(&mut session, seed);
    }
    let last = session.weeks().last().map(|week| week.day);
    assert!(last >= Some(7), "run {seed}");
    drop(session);
    let recorded = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads");
    let states =
        recorded.lines.iter().rev().find_map(|line| Some(line.record.closed_days()?.state_hash.clone()));
    assert_eq!(Some(verified_state(&folder, 1)), states, "run {seed}");
    assert_eq!(Some(verified_state(&folder, 2)), states, "run {seed}");
}

/// Checks runs with `count` seeds and prints the seeds. `NOVAMIND_TEST_SEED` sets the first seed.
fn check_random_runs(first: u64, count: u64) {
    let offset = std::env::var("NOVAMIND_TEST_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(0);
    println!("seeds {} to {}", offset + first, offset + first + count - 1);
    (first..first + count).for_each(|seed| check_random_run(offset + seed));
}

#[test]
fn random_runs_keep_invariants() {
    check_random_runs(1, 8);
}

#[test]
fn more_random_runs_keep_invariants() {
    check_random_runs(9, 8);
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn thousand_random_runs_keep_invariants() {
    check_random_runs(1, 1000);
}
