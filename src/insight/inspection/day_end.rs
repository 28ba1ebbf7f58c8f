//! Recorders of the state at the end of each day, for comparisons of days and runs.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use novamind_world::canonical::canonical_hash;
use novamind_world::customers::columns::Subscriber;
use novamind_world::day::closing_figures;
use novamind_world::day::observer::DayObserver;
use novamind_world::events::Facts;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::state::{PartHash, World};

#[derive(Debug, Clone)]
pub(crate) struct DayEnd {
    /// Hashes of the parts of the state and of the facts of the day.
    pub(crate) parts: Vec<PartHash>,
    /// Parameters in force on the day.
    pub(crate) params: Params,
    /// Figures by name in a fixed order, including hidden figures.
    pub(crate) figures: Vec<(String, f64)>,
    pub(crate) customers: BTreeMap<u32, (Group, Subscriber)>,
}

impl DayEnd {
    fn new(world: &World, params: &Params, facts: &Facts) -> DayEnd {
        let rows = world.customers.blocks();
        let rows = rows.flat_map(|(group, block)| (0..block.len()).map(move |at| (group, block.row(at))));
        DayEnd {
            parts: part_hashes(world, facts),
            params: params.clone(),
            figures: named_figures(world, facts),
            customers: rows.map(|(group, row)| (row.customer, (group, row))).collect(),
        }
    }
}

/// Returns the hashes of the parts of a state and of the facts of its day.
fn part_hashes(world: &World, facts: &Facts) -> Vec<PartHash> {
    let mut parts = world.part_hashes();
    parts.push(PartHash { part: "facts", hash: canonical_hash(facts) });
    parts
}

fn named_figures(world: &World, facts: &Facts) -> Vec<(String, f64)> {
    let closing = closing_figures(world);
    let issues: u32 = world.customers.blocks().map(|(_, block)| block.open_issues()).sum();
    let market = &world.market;
    let lead_count = |wanted: bool| {
        facts.arrivals.iter().filter(|arrival| arrival.group.is_enterprise() == wanted).count() as f64
    };
    let mut figures: Vec<(String, f64)> = [
        ("cash", closing.cash),
        ("recurring revenue", closing.mrr),
        ("individual subscribers", f64::from(closing.individual_subscribers)),
        ("enterprise seats", f64::from(closing.enterprise_seats)),
        ("individual leads of the day", lead_count(false)),
        ("enterprise leads of the day", lead_count(true)),
        ("cancellations of the day", facts.endings.len() as f64),
        ("customers so far", f64::from(world.customers.next_customer)),
        ("open issues", f64::from(issues)),
        ("threads so far", f64::from(world.enterprise.next_thread)),
        ("shared quality", world.product.shared_bonus),
        ("index of the economy", market.economy.pmi),
        ("competitor moves so far", market.competitors.len() as f64),
        ("drift of quality", market.drift.global_quality),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    let by_group = |name: &str, group: Group, value: f64| (format!("{name} of {group}"), value);
    for group in Group::all() {
        let active = f64::from(world.customers.groups[group].active_count());
        figures.push(by_group("subscribers", group, active));
        figures.push(by_group("reputation", group, market.reputation.get(group)));
        figures.push(by_group("targeted quality", group, world.product.group_bonus[group]));
        figures.push(by_group("drift of quality", group, market.drift.quality[group]));
        figures.push(by_group("drift of budgets", group, market.drift.c_max[group]));
    }
    figures
}

/// A recorder of the state at the end of selected days.
pub(crate) struct DayEndRecorder {
    wanted: Vec<u32>,
    day_ends: Mutex<BTreeMap<u32, DayEnd>>,
}

impl DayEndRecorder {
    /// Creates a recorder for the days in `wanted`.
    pub(crate) fn for_days(wanted: &[u32]) -> DayEndRecorder {
        DayEndRecorder { wanted: wanted.to_vec(), day_ends: Mutex::default() }
    }

    pub(crate) fn take(&self, day: u32) -> Option<DayEnd> {
        self.day_ends.lock().unwrap_or_else(PoisonError::into_inner).remove(&day)
    }
}

impl DayObserver for DayEndRecorder {
    fn on_day_end(&self, world: &World, params: &Params, facts: &Facts) {
        if self.wanted.contains(&world.day) {
            let moment = DayEnd::new(world, params, facts);
            self.day_ends.lock().unwrap_or_else(PoisonError::into_inner).insert(world.day, moment);
        }
    }
}

/// A recorder of the state hashes of every day from day 1, and of the complete end-of-day data of selected days.
pub(crate) struct StateHashRecorder {
    parts: Mutex<Vec<Vec<PartHash>>>,
    day_ends: DayEndRecorder,
}

impl StateHashRecorder {
    /// Creates a recorder for the hashes of every day and for the end-of-day data of the days in `wanted`.
    pub(crate) fn with_ends(wanted: &[u32]) -> StateHashRecorder {
        StateHashRecorder { parts: Mutex::default(), day_ends: DayEndRecorder::for_days(wanted) }
    }

    pub(crate) fn part_hashes_by_day(&self) -> Vec<Vec<PartHash>> {
        self.parts.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(crate) fn take(&self, day: u32) -> Option<DayEnd> {
        self.day_ends.take(day)
    }
}

impl DayObserver for StateHashRecorder {
    fn on_day_end(&self, world: &World, params: &Params, facts: &Facts) {
        self.day_ends.on_day_end(world, params, facts);
        self.parts.lock().unwrap_or_else(PoisonError::into_inner).push(part_hashes(world, facts));
    }
}
