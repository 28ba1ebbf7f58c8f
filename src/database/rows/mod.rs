//! Converts facts to database rows in the writer thread.

mod bulk_insert;
mod inserts;
mod issues;
mod ledger;
mod notices;
mod posts;
mod profile_words;
mod schema;
mod threads;

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::{Transaction, params};

pub(super) use schema::{LAYOUT_VERSION, create_tables};

use super::blocks::{AdsRun, SharedStore};
use super::packing::PackedDay;
use bulk_insert::value_or_null;
pub(super) use bulk_insert::{NULL, Value, insert_rows, integer, real, text};
use issues::IssueWriter;
use ledger::LedgerWriter;
use notices::NoticeWriter;
use novamind_world::customers::persona::PersonaPicks;
use novamind_world::events::{
    Arrival, Facts, SubscriptionEnded, SubscriptionOpened, SubscriptionStatus, TermsChanged,
};
use novamind_world::identifiers::Plan;
use novamind_world::params::Params;
use profile_words::ProfileWordWriter;

/// The facts of a simulated day or a tool call, with the texts that belong to them.
#[derive(Debug, Clone, Default)]
pub struct ProjectionEntry {
    /// Facts of the day or tool call.
    pub facts: Arc<Facts>,
    /// Text of each notice in the facts.
    pub notices: Vec<String>,
    /// Description of each PMI reading that is published in the facts.
    pub readings: Vec<String>,
    /// Text of each negotiation turn in the facts; empty for turns without text.
    pub turns: Vec<String>,
    /// Text of each post in the facts whose author is not the player.
    pub posts: Vec<String>,
    /// Number and new text of each reworded post.
    pub rewordings: Vec<(u32, String)>,
    /// E-mail address of each enterprise that is new or has sent a message, by customer number.
    pub addresses: BTreeMap<u32, String>,
    /// Settings of the new row of `config_history`, if settings changed.
    pub settings: Option<serde_json::Value>,
    /// Forecasts that the player submitted.
    pub forecasts: Vec<ForecastRow>,
    /// New parameters for later rows, if the parameters change.
    pub params: Option<Arc<Params>>,
}

/// A row of the table `predictions`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForecastRow {
    /// Day on which the forecast was submitted.
    pub submit_day: u32,
    /// Days between the submission and the target day.
    pub horizon_days: u32,
    /// Predicted cash in dollars.
    pub point: f64,
    /// Lower end of the interval, in dollars.
    pub lower: f64,
    /// Upper end of the interval, in dollars.
    pub upper: f64,
    /// Time of submission, in seconds since the Unix epoch.
    pub submitted_at: f64,
}

#[derive(Debug, Clone)]
struct SubscriptionRow {
    subscription: u32,
    plan: &'static str,
    listed_price: f64,
    promotion: f64,
    opened_day: u32,
    start_day: u32,
    end_day: Option<u32>,
    status: SubscriptionStatus,
    seats: u32,
    contract_end_day: Option<u32>,
    billed_once: bool,
}

/// Changes that a deal makes to a subscription, except the terms.
#[derive(Debug, Clone, Copy)]
struct DealRow {
    /// Day on which the lead became a subscriber.
    activated: Option<u32>,
    contract_end_day: u32,
}

/// Collects changes until the next commit, so that several changes to a row need only one write.
pub(super) struct RowWriter {
    params: Arc<Params>,
    store: SharedStore,
    new_subscriptions: BTreeMap<u32, SubscriptionRow>,
    deals: BTreeMap<u32, DealRow>,
    changed_terms: BTreeMap<u32, TermsChanged>,
    ended_subscriptions: BTreeMap<u32, SubscriptionEnded>,
    new_usage: Vec<Arc<PackedDay>>,
    new_ads: Vec<Arc<PackedDay>>,
    keep_usage_from: Option<u32>,
    notices: NoticeWriter,
    issues: IssueWriter,
    ledger: LedgerWriter,
    words: ProfileWordWriter,
}

impl RowWriter {
    /// Returns a writer for an existing database whose packed days are loaded into the store.
    pub fn new(params: Arc<Params>, store: SharedStore) -> RowWriter {
        let kept = store.read().unwrap_or_else(|poisoned| poisoned.into_inner()).clone();
        RowWriter {
            store,
            new_subscriptions: BTreeMap::new(),
            deals: BTreeMap::new(),
            changed_terms: BTreeMap::new(),
            ended_subscriptions: BTreeMap::new(),
            new_usage: Vec::new(),
            new_ads: Vec::new(),
            keep_usage_from: None,
            notices: NoticeWriter::from_inbox(kept.inbox.clone()),
            issues: IssueWriter::from_store(&kept),
            ledger: LedgerWriter::from_days(params.clone(), kept.ledger.clone()),
            words: ProfileWordWriter::default(),
            params,
        }
    }

    /// Writes the rows of an entry. Rows that can change before the commit are held back until [`RowWriter::flush`].
    pub fn write(&mut self, transaction: &Transaction<'_>, entry: &ProjectionEntry) -> rusqlite::Result<()> {
        if let Some(params) = &entry.params {
            self.params = params.clone();
            self.ledger.set_params(params.clone());
        }
        let facts = &entry.facts;
        self.words.write(transaction, facts, &self.params)?;
        self.write_usage(transaction, facts)?;
        inserts::insert_service(transaction, facts)?;
        inserts::insert_research(transaction, facts)?;
        for (reading, words) in facts.readings.iter().zip(&entry.readings) {
            transaction
                .prepare_cached(
                    "INSERT OR REPLACE INTO macroeconomic_conditions VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
                )?
                .execute(params![
                    reading.measured_day,
                    reading.value,
                    reading.trend.id(),
                    reading.change,
                    reading.phase.id(),
                    words
                ])?;
        }
        self.issues.write(facts);
        self.record_cancellations(facts);
        threads::insert_turns(transaction, entry)?;
        self.write_deals(transaction, facts)?;
        inserts::insert_channel_leads(transaction, facts)?;
        self.write_leads(transaction, entry)?;
        self.ledger.write(facts);
        self.write_ads(transaction, facts)?;
        posts::insert_posts(transaction, facts, &entry.posts)?;
        posts::update_post_texts(transaction, &entry.rewordings)?;
        posts::insert_player_posts(transaction, facts)?;
        self.notices.write(entry);
        inserts::insert_settings(transaction, entry)?;
        inserts::insert_forecasts(transaction, &entry.forecasts)?;
        inserts::insert_discovery(transaction, facts)
    }

    fn write_usage(&mut self, transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
        if facts.service.is_none() {
            return Ok(());
        }
        let day = PackedDay::pack(facts.day, &facts.usage);
        transaction
            .prepare_cached("INSERT OR REPLACE INTO usage_blocks VALUES (?1, ?2)")?
            .execute(params![day.day, day.as_bytes()])?;
        self.new_usage.push(Arc::new(day));
        let operations = &self.params.operations;
        if facts.day.is_multiple_of(operations.daily_usage_prune_every_days) {
            let first = facts.day.saturating_sub(operations.daily_usage_keep_days);
            transaction.prepare_cached("DELETE FROM usage_blocks WHERE day < ?1")?.execute([first])?;
            self.keep_usage_from = Some(first);
        }
        Ok(())
    }

    fn write_ads(&mut self, transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
        if facts.ads_revenue.is_empty() {
            return Ok(());
        }
        let day = PackedDay::pack(facts.day, &AdsRun::runs_from_rows(&facts.ads_revenue));
        transaction
            .prepare_cached("INSERT OR REPLACE INTO ads_blocks VALUES (?1, ?2)")?
            .execute(params![day.day, day.as_bytes()])?;
        self.new_ads.push(Arc::new(day));
        Ok(())
    }

    fn record_cancellations(&mut self, facts: &Facts) {
        for ending in &facts.endings {
            match self.new_subscriptions.get_mut(&ending.customer) {
                Some(row) => (row.end_day, row.status) = (Some(ending.day), ending.status),
                None => {
                    self.ended_subscriptions.insert(ending.customer, *ending);
                }
            }
        }
    }

    /// Collects deals until the next commit. The facts list the terms of the deals separately, as changed terms.
    fn write_deals(&mut self, transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
        threads::update_contract_starts(transaction, facts)?;
        for deal in &facts.deals {
            let Some(contract_end_day) = deal.contract_end_day else { continue };
            let activated = deal.activated.then_some(facts.day);
            match self.new_subscriptions.get_mut(&deal.customer) {
                Some(row) => {
                    row.contract_end_day = Some(contract_end_day);
                    if let Some(day) = activated {
                        (row.start_day, row.status) = (day, SubscriptionStatus::Subscribed);
                    }
                }
                None => {
                    let before = self.deals.get(&deal.customer).and_then(|row| row.activated);
                    let row = DealRow { activated: activated.or(before), contract_end_day };
                    self.deals.insert(deal.customer, row);
                }
            }
        }
        Ok(())
    }

    fn write_leads(
        &mut self,
        transaction: &Transaction<'_>,
        entry: &ProjectionEntry,
    ) -> rusqlite::Result<()> {
        let facts = &entry.facts;
        let rows = facts.arrivals.iter().map(|arrival| {
            let company = arrival.group.is_enterprise();
            [
                integer(arrival.customer),
                text(arrival.group.id()),
                integer(facts.day),
                integer(arrival.source as u8),
                integer(pack_persona(company, arrival.persona)),
                integer(self.usage_label(arrival)),
                integer(self.budget_label(arrival)),
                value_or_null(company.then_some(arrival.seats), integer),
                value_or_null(entry.addresses.get(&arrival.customer), |address| text(address)),
                NULL,
            ]
        });
        insert_rows(transaction, "INSERT INTO customer_rows VALUES", rows)?;
        for opened in &facts.openings {
            self.new_subscriptions.insert(opened.customer, subscription_row(opened, facts.day));
        }
        for change in &facts.changes {
            match self.new_subscriptions.get_mut(&change.customer) {
                Some(row) => {
                    row.plan = change.plan.id();
                    row.listed_price = change.listed_price;
                    row.promotion = change.promotion;
                    row.seats = change.seats;
                    row.billed_once = change.billed_once;
                }
                None => {
                    self.changed_terms.insert(change.customer, *change);
                }
            }
        }
        Ok(())
    }

    fn usage_label(&self, arrival: &Arrival) -> u8 {
        let edges = &self.params.personas.individual.usage_thresholds;
        edges.iter().position(|edge| arrival.usage_demand < *edge).unwrap_or(edges.len()) as u8
    }

    fn budget_label(&self, arrival: &Arrival) -> u8 {
        let mean = self.params.group(arrival.group).c_max_mean;
        let factors = &self.params.personas.individual.budget_factors;
        factors.iter().position(|factor| arrival.c_max < factor * mean).unwrap_or(factors.len()) as u8
    }

    /// Writes the held-back rows. After the commit, [`RowWriter::publish`] updates the store.
    pub fn flush(&mut self, transaction: &Transaction<'_>) -> rusqlite::Result<()> {
        self.flush_subscriptions(transaction)?;
        self.notices.flush(transaction)?;
        self.issues.flush(transaction)?;
        self.ledger.flush(transaction)
    }

    fn flush_subscriptions(&mut self, transaction: &Transaction<'_>) -> rusqlite::Result<()> {
        let period = self.params.billing.billing_period_days;
        let rows = std::mem::take(&mut self.new_subscriptions).into_iter().map(|(customer, row)| {
            [
                integer(customer),
                integer(row.subscription),
                text(row.plan),
                real(row.listed_price),
                real(row.promotion),
                integer(row.start_day),
                value_or_null(row.end_day, integer),
                integer(row.status as u8),
                integer(row.opened_day % period),
                integer(row.seats),
                value_or_null(row.contract_end_day, integer),
                integer(row.billed_once),
            ]
        });
        insert_rows(transaction, "INSERT INTO subscription_rows VALUES", rows)?;
        let mut deal = transaction.prepare_cached(
            "UPDATE subscription_rows SET contract_end_day = ?2, start_day = coalesce(?3, start_day), \
             state = coalesce(?4, state) WHERE customer_id = ?1",
        )?;
        for (customer, row) in std::mem::take(&mut self.deals) {
            let status = row.activated.map(|_| SubscriptionStatus::Subscribed as u8);
            deal.execute(params![customer, row.contract_end_day, row.activated, status])?;
        }
        let mut change = transaction.prepare_cached(
            "UPDATE subscription_rows SET plan = ?2, listed_price = ?3, promotion = ?4, seats = ?5, billed_once = ?6 \
             WHERE customer_id = ?1",
        )?;
        for (customer, terms) in std::mem::take(&mut self.changed_terms) {
            change.execute(params![
                customer,
                terms.plan.id(),
                terms.listed_price,
                terms.promotion,
                terms.seats,
                terms.billed_once,
            ])?;
        }
        let mut end = transaction
            .prepare_cached("UPDATE subscription_rows SET end_day = ?2, state = ?3 WHERE customer_id = ?1")?;
        for (customer, ending) in std::mem::take(&mut self.ended_subscriptions) {
            end.execute(params![customer, ending.day, ending.status as u8])?;
        }
        Ok(())
    }

    /// Adds the written days to the store that queries read, and removes expired days.
    pub fn publish(&mut self) {
        let mut store = self.store.write().unwrap_or_else(|poisoned| poisoned.into_inner());
        if !self.new_usage.is_empty() {
            let mut usage = store.usage.to_vec();
            usage.append(&mut self.new_usage);
            if let Some(first) = self.keep_usage_from.take() {
                usage.retain(|day| day.day >= first);
            }
            store.usage = Arc::new(usage);
        }
        if !self.new_ads.is_empty() {
            let mut ads = store.ads.to_vec();
            ads.append(&mut self.new_ads);
            store.ads = Arc::new(ads);
        }
        if let Some(inbox) = self.notices.publish() {
            store.inbox = inbox;
        }
        if let Some(ledger) = self.ledger.publish() {
            store.ledger = ledger;
        }
        self.issues.publish(&mut store);
    }
}

fn subscription_row(opened: &SubscriptionOpened, day: u32) -> SubscriptionRow {
    SubscriptionRow {
        subscription: opened.subscription,
        plan: opened.plan.map_or("pending", Plan::id),
        listed_price: opened.listed_price,
        promotion: opened.promotion,
        opened_day: day,
        start_day: day,
        end_day: None,
        status: opened.status,
        seats: opened.seats,
        contract_end_day: None,
        billed_once: false,
    }
}

/// Packs a persona into an integer, one byte per axis in the order of the `words` table. Enterprises and individuals
/// use different axes.
fn pack_persona(company: bool, picks: PersonaPicks) -> i64 {
    let [a, b, c, d, e, f, g] = picks.0;
    // Axes: industry, role, experience, work style, technical skill, size, decision, concern.
    let axes = if company { [a, b, 0, e, c, d, f, g] } else { [a, b, c, d, e, 0, 0, 0] };
    i64::from_le_bytes(axes)
}
