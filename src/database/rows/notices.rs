//! Writes notices to the packed days of the inbox, and records repeated losses.

use std::collections::BTreeMap;
use std::sync::Arc;

use rusqlite::{Transaction, params};

use super::ProjectionEntry;
use crate::notices::{Inbox, LEAD_LOST_INDEX, NoticeDay, RepeatedLoss, type_index};
use crate::packing::PackedRows;
use novamind_world::events::{Facts, LossCause};

/// Collects notices until the next commit.
pub(super) struct NoticeWriter {
    /// Inbox including all committed notices.
    inbox: Inbox,
    /// Whether the loss of a customer is reported every day, by customer number.
    is_loss_repeated: Vec<bool>,
    /// Days of the inbox that changed since the last commit.
    days: BTreeMap<u32, NoticeDay>,
    /// Number of the next notice.
    next: u64,
    new_losses: Vec<RepeatedLoss>,
}

impl NoticeWriter {
    /// Returns a writer that continues an inbox.
    pub fn from_inbox(inbox: Inbox) -> NoticeWriter {
        let next = inbox.days.last().map_or(1, |day| day.first + day.len());
        let mut writer = NoticeWriter {
            inbox,
            is_loss_repeated: Vec::new(),
            days: BTreeMap::new(),
            next,
            new_losses: Vec::new(),
        };
        for loss in writer.inbox.losses.clone().iter() {
            writer.mark_loss_repeated(loss.customer);
        }
        writer
    }

    /// Adds the notices of an entry.
    pub fn write(&mut self, entry: &ProjectionEntry) {
        let facts = &entry.facts;
        let is_day = facts.service.is_some();
        if facts.notices.is_empty() && !is_day {
            return;
        }
        let repeats = self.count_repeats(facts);
        let day = self.notice_day(facts.day);
        let before = day.len();
        for (notice, words) in facts.notices.iter().zip(&entry.notices) {
            match (RepeatedLoss::from_notice(notice), repeats) {
                (None, _) => day.push(type_index(notice), words),
                (Some(_), Some(_)) => {}
                (Some(loss), None) => day.push(LEAD_LOST_INDEX, &loss.text()),
            }
        }
        if is_day {
            day.set_repeats(repeats.unwrap_or(0));
        }
        let added = day.len() - before;
        self.next += added;
    }

    /// Stores new repeated losses. Returns the number of losses that are repeated on the day, or `None` if not all
    /// losses are repeated.
    fn count_repeats(&mut self, facts: &Facts) -> Option<u32> {
        let mut today = 0;
        for loss in facts.notices.iter().filter_map(RepeatedLoss::from_notice) {
            today += 1;
            if self.mark_loss_repeated(loss.customer) {
                self.new_losses.push(loss);
            }
        }
        let known = self.inbox.losses.len() + self.new_losses.len();
        (today == known).then_some(today as u32)
    }

    /// Marks the loss of a customer as repeated. Returns true if the loss was not marked before.
    fn mark_loss_repeated(&mut self, customer: u32) -> bool {
        let at = customer as usize;
        if self.is_loss_repeated.len() <= at {
            self.is_loss_repeated.resize(at + 1, false);
        }
        !std::mem::replace(&mut self.is_loss_repeated[at], true)
    }

    /// Returns the inbox day with this number. If the inbox already contains the day, the day is the newest one.
    fn notice_day(&mut self, day: u32) -> &mut NoticeDay {
        let started = self.inbox.days.last().filter(|last| last.day == day);
        let new_day =
            || started.map_or_else(|| NoticeDay::new(day, self.next), |last| NoticeDay::clone(last));
        self.days.entry(day).or_insert_with(new_day)
    }

    /// Writes the changed days and the new repeated losses to the database.
    pub fn flush(&self, transaction: &Transaction<'_>) -> rusqlite::Result<()> {
        let mut write = transaction.prepare_cached("INSERT OR REPLACE INTO notice_blocks VALUES (?1, ?2)")?;
        for day in self.days.values().filter(|day| day.len() > 0) {
            write.execute(params![day.day, day.to_bytes()])?;
        }
        let mut write = transaction.prepare_cached(
            "INSERT INTO repeated_losses (customer_id, message_day, cause) VALUES (?1, ?2, ?3)",
        )?;
        for loss in &self.new_losses {
            write.execute(params![loss.customer, loss.message_day, loss.cause == LossCause::Unanswered])?;
        }
        Ok(())
    }

    /// Adds the written days to the inbox. Returns the inbox if it changed.
    pub fn publish(&mut self) -> Option<Inbox> {
        if self.days.is_empty() && self.new_losses.is_empty() {
            return None;
        }
        let days = std::mem::take(&mut self.days);
        let first = days.keys().next().copied().unwrap_or(u32::MAX);
        let mut all: Vec<Arc<NoticeDay>> =
            self.inbox.days.iter().filter(|day| day.day < first).cloned().collect();
        all.extend(days.into_values().filter(|day| day.len() > 0).map(Arc::new));
        self.inbox.days = Arc::new(all);
        if !self.new_losses.is_empty() {
            Arc::make_mut(&mut self.inbox.losses).append(&mut self.new_losses);
        }
        Some(self.inbox.clone())
    }
}
