//! Writes ledger entries to packed days. The entries of a day are numbered in this order: lead costs, payments, other
//! entries.

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::{Transaction, params};

use crate::ledger::{LeadsAndPayments, LedgerDay};
use crate::packing::PackedRows;
use novamind_world::events::{Category, Facts, LedgerNote};
use novamind_world::params::Params;

/// Collects ledger entries until the next commit.
pub(super) struct LedgerWriter {
    params: Arc<Params>,
    /// Packed days of the ledger, including all committed entries.
    days: Arc<Vec<Arc<LedgerDay>>>,
    touched: BTreeMap<u32, LedgerDay>,
    /// Number of the next row.
    next: u64,
}

impl LedgerWriter {
    /// Returns a writer that continues a ledger.
    pub fn from_days(params: Arc<Params>, days: Arc<Vec<Arc<LedgerDay>>>) -> LedgerWriter {
        let next = days.last().map_or(1, |day| day.first() + day.len());
        LedgerWriter { params, days, touched: BTreeMap::new(), next }
    }

    /// Replaces the parameters for later entries.
    pub fn set_params(&mut self, params: Arc<Params>) {
        self.params = params;
    }

    /// Adds the ledger entries of a simulated day or a tool call.
    pub fn write(&mut self, facts: &Facts) {
        if facts.arrivals.is_empty() && facts.payments.is_empty() && facts.ledger.is_empty() {
            return;
        }
        let (next, lead_cost) = (self.next, -self.params.leads.lead_acquisition_cost);
        // If the ledger already contains this day, the day is the newest one.
        let started = self.days.last().filter(|last| last.day() == facts.day);
        let new_day = || {
            started.map_or_else(|| LedgerDay::new(facts.day, next, lead_cost), |last| LedgerDay::clone(last))
        };
        let day = self.touched.entry(facts.day).or_insert_with(new_day);
        let before = day.len();
        if !facts.arrivals.is_empty() || !facts.payments.is_empty() {
            let leads = facts.arrivals.iter().map(|arrival| arrival.customer).collect();
            let payments = facts.payments.iter().map(|payment| (payment.customer, payment.amount)).collect();
            day.set_leads_and_payments(&LeadsAndPayments { leads, payments });
        }
        for entry in &facts.ledger {
            day.push(entry.category, entry.amount, entry_note(&self.params, entry.category, entry.note));
        }
        self.next += day.len() - before;
    }

    /// Writes the changed days of the ledger to the database.
    pub fn flush(&self, transaction: &Transaction<'_>) -> rusqlite::Result<()> {
        let mut write = transaction.prepare_cached("INSERT OR REPLACE INTO ledger_blocks VALUES (?1, ?2)")?;
        for day in self.touched.values() {
            write.execute(params![day.day(), day.to_bytes()])?;
        }
        Ok(())
    }

    /// Adds the written days to the ledger. Returns the ledger if it changed.
    pub fn publish(&mut self) -> Option<Arc<Vec<Arc<LedgerDay>>>> {
        let touched = std::mem::take(&mut self.touched);
        let first = *touched.keys().next()?;
        let mut days: Vec<Arc<LedgerDay>> =
            self.days.iter().filter(|day| day.day() < first).cloned().collect();
        days.extend(touched.into_values().map(Arc::new));
        self.days = Arc::new(days);
        Some(self.days.clone())
    }
}

fn entry_note(params: &Params, category: Category, note: LedgerNote) -> String {
    match (category, note) {
        (_, LedgerNote::Subscribers(count)) => format!("In-app ad revenue ({count} subscribers)"),
        (_, LedgerNote::Project(tier, number)) => {
            format!("R&D Tier {tier}: {} (t{tier}_{number})", params.research_tier(tier).name)
        }
        (_, LedgerNote::Study(study)) if study.is_refresh() => {
            format!("Group research: {}, refresh at level {}", study.group, study.target)
        }
        (_, LedgerNote::Study(study)) => {
            format!("Group research: {}, level {} to {}", study.group, study.before, study.target)
        }
        (Category::InitialFunding, _) => "Initial seed funding".to_owned(),
        (Category::MarketResearch, _) => "Market research: search for an unknown group".to_owned(),
        (Category::Capacity, _) => "Daily capacity cost".to_owned(),
        (Category::Compute, _) => "Compute costs".to_owned(),
        (Category::Operations, LedgerNote::Targeted) => "Targeted ops spend".to_owned(),
        (Category::Operations, _) => "Daily operations spend".to_owned(),
        (Category::Development, LedgerNote::Targeted) => "Targeted dev spend".to_owned(),
        (Category::Development, _) => "Daily development spend".to_owned(),
        (Category::Advertising, _) => "Targeted ad spend".to_owned(),
        (other, _) => other.id().replace('_', " "),
    }
}
