//! Benchmarks of the kernels that simulate a day: `cargo bench`. The command `novamind bench` measures whole days.
//!
//! All kernels run on the same simulated company, so its customer blocks, issues and bills are as in a real run.

use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use novamind::database::{DatabaseLocation, ProjectionEntry, ProjectionPosition, Projector};
use novamind::world::context::DayContext;
use novamind::world::customers::Customers;
use novamind::world::customers::traits::draw_traits;
use novamind::world::day::{compute_morning, step_day};
use novamind::world::events::{Facts, ServiceDay};
use novamind::world::identifiers::{ByPlan, Channel, Group};
use novamind::world::morning::Morning;
use novamind::world::params::Params;
use novamind::world::product::ads::AdLoad;
use novamind::world::product::usage;
use novamind::world::quality::TenureTable;
use novamind::world::random::Streams;
use novamind::world::retention::billing;
use novamind::world::retention::issues;
use novamind::world::retention::satisfaction;
use novamind::world::state::World;

/// Number of simulated days, after which the company has about 30,000 subscribers.
const DAYS: u32 = 125;

fn main() {
    divan::main();
}

/// The simulated company and the facts of its last day.
struct Company {
    params: Arc<Params>,
    streams: Streams,
    world: World,
    facts: Arc<Facts>,
}

static COMPANY: LazyLock<Company> = LazyLock::new(|| {
    let (params, streams) = (Arc::new(Params::bundled()), Streams::new(42));
    let mut facts = Facts::default();
    let mut world = World::new(500, 1e9, &params, &mut facts);
    let s1 = Group::at(0).expect("S1");
    let settings = &mut world.settings;
    settings.core.prices = ByPlan([12.0, 25.0, 55.0]);
    settings.core.tiers = ByPlan([1, 2, 4]);
    settings.core.quotas = ByPlan([60_000, 250_000, 1_200_000].map(Into::into));
    settings.core.operations = 1_000.0;
    settings.core.capacity_tier = 5;
    settings.targeted_development.targeted_spend.insert(s1, 6_000.0);
    let ads = [(s1, 750.0)].into_iter().collect();
    settings.targeted_ads.targeted_spend.insert(Channel::ContentMarketing, ads);
    for _ in 0..DAYS {
        step_day(&mut world, &params, &streams, &mut facts);
    }
    Company { params, streams, world, facts: Arc::new(facts) }
});

impl Company {
    fn morning(&self) -> Morning {
        compute_morning(&self.world, &self.params)
    }

    /// Runs a kernel on a day without an outage.
    fn on_day(&self, kernel: impl FnOnce(&DayContext<'_>)) {
        let settings = &self.world.settings;
        kernel(&DayContext {
            morning: &self.morning(),
            settings,
            service: &ServiceDay::without_load(),
            service_penalty: 0.0,
            ads: &AdLoad::new(&settings.ads_strength, &self.params),
            tenure: &TenureTable::up_to(DAYS, &self.params),
            params: &self.params,
            streams: &self.streams,
        });
    }

    fn subscribers(&self) -> ItemsCount {
        ItemsCount::new(self.world.customers.active_by_group().iter().sum::<u32>())
    }
}

/// Runs a kernel once on each copy of the company's customers.
fn bench_on_customers<R>(
    bencher: Bencher<'_, '_>,
    items: ItemsCount,
    kernel: impl Fn(&mut Customers) -> R + Sync,
) {
    bencher.counter(items).with_inputs(|| COMPANY.world.customers.clone()).bench_local_refs(kernel);
}

#[divan::bench]
fn quality_and_satisfaction_sweep(bencher: Bencher<'_, '_>) {
    let company = &*COMPANY;
    company.on_day(|day| {
        bench_on_customers(bencher, company.subscribers(), |customers| {
            customers.sweep(|group, _, block| satisfaction::update_block(group, block, day)).len()
        });
    });
}

#[divan::bench]
fn usage_metering(bencher: Bencher<'_, '_>) {
    let company = &*COMPANY;
    let morning = company.morning();
    bench_on_customers(bencher, company.subscribers(), |customers| {
        usage::measure_usage(customers, &morning, &company.params, &mut Facts::default())
    });
}

#[divan::bench]
fn issue_pass(bencher: Bencher<'_, '_>) {
    let company = &*COMPANY;
    company.on_day(|day| {
        bench_on_customers(bencher, company.subscribers(), |customers| {
            let (mut issue_desk_copy, mut facts) = (company.world.issue_counter.clone(), Facts::default());
            let mut calls =
                customers.sweep(|group, number, block| issues::find_issues(group, number, block, day));
            issues::allocate_resolutions(&mut calls, day.settings, customers, &mut issue_desk_copy, day);
            let settled = customers.sweep_with(calls, |_, _, block, issue_batch| {
                issues::update_issues(block, &issue_batch, day)
            });
            issues::record_issues(settled, &mut facts);
            facts.issues_opened.len()
        });
    });
}

#[divan::bench]
fn customer_generation(bencher: Bencher<'_, '_>) {
    const GENERATED_CUSTOMERS: u32 = 1_000;
    let (params, streams) = (Params::bundled(), Streams::new(42));
    let s1 = Group::at(0).expect("S1");
    bencher.counter(ItemsCount::new(GENERATED_CUSTOMERS)).bench_local(|| {
        (1..=GENERATED_CUSTOMERS)
            .map(|n| draw_traits(s1, black_box(n), 1.0, &params, &streams).curve.c_max)
            .sum::<f64>()
    });
}

#[divan::bench]
fn daily_billing(bencher: Bencher<'_, '_>) {
    let company = &*COMPANY;
    let suspended = BTreeSet::new();
    let bills = ItemsCount::new(company.facts.payments.len());
    company.on_day(|day| {
        bench_on_customers(bencher, bills, |customers| {
            let regulars =
                customers.sweep(|group, number, block| billing::bill_block(group, number, block, day));
            billing::collect_payments(customers, regulars, day, &suspended, &mut Facts::default())
        });
    });
}

#[divan::bench]
fn daily_row_writing(bencher: Bencher<'_, '_>) {
    let company = &*COMPANY;
    let rows = company.facts.arrivals.len() + company.facts.payments.len() + company.facts.openings.len();
    let empty = || {
        let (projector, _) =
            Projector::start(DatabaseLocation::new_in_memory(), 0, company.params.clone(), |_| false)
                .expect("a database");
        (projector, ProjectionEntry { facts: company.facts.clone(), ..ProjectionEntry::default() })
    };
    bencher.counter(ItemsCount::new(rows)).with_inputs(empty).bench_local_values(|(projector, entry)| {
        projector.enqueue(entry);
        projector.commit(ProjectionPosition { seq: 1, line_hash: String::new() });
        projector.flush().expect("the rows are written");
    });
}
