//! Decisions by week: settings as old → new, purchases and messages, and the first line of the rationale.

use serde_json::Value;

use super::words::number;
use novamind_record::figures::WeekFigures;
use novamind_session::{Change, Decisions, JournalEntry, week_of};
use novamind_tools::ToolId;

/// Consecutive weeks under one decision: the first week made it, the others changed nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Chapter {
    /// First week.
    pub week: u32,
    /// Last week.
    pub last_week: u32,
    /// Decision day.
    pub day: u32,
    /// Last simulated day.
    pub until: u32,
    /// First line of the rationale.
    pub why: String,
    /// Settings, old → new.
    pub changes: Vec<String>,
    /// Purchases, posts and offers.
    pub deeds: Vec<String>,
    /// Cash at the end, dollars.
    pub cash: f64,
    /// Change of cash, dollars.
    pub cash_change: f64,
}

/// Describes a change: `price A: 0 → 14 $/month`.
pub fn change_in_words(change: &Change) -> String {
    let told = format!("{}: {} → {}", change.setting, number(change.old), number(change.new));
    change.setting.unit().map_or(told.clone(), |unit| format!("{told} {unit}"))
}

/// Describes changes, one line per family of settings: `price: A 0 → 14, B 0 → 49 $/month`.
pub fn changes_in_words(changes: &[Change]) -> Vec<String> {
    let mut families: Vec<(String, Vec<&Change>)> = Vec::new();
    for change in changes {
        let (family, _) = change.setting.parts();
        match families.iter_mut().find(|(known, _)| *known == family) {
            Some((_, members)) => members.push(change),
            None => families.push((family, vec![change])),
        }
    }
    let member = |change: &&Change| {
        let (_, member) = change.setting.parts();
        let name = if member.is_empty() { "in general" } else { &member };
        format!("{name} {} → {}", number(change.old), number(change.new))
    };
    let line = |(family, members): (String, Vec<&Change>)| match members[..] {
        [only] => change_in_words(only),
        _ => {
            let told: Vec<String> = members.iter().map(member).collect();
            let unit = members[0].setting.unit().map_or(String::new(), |unit| format!(" {unit}"));
            format!("{family}: {}{unit}", told.join(", "))
        }
    };
    families.into_iter().map(line).collect()
}

/// Returns the chapters of a run. Weeks without a new decision join the chapter before them.
pub fn chapters(decisions: &[Decisions], journal: &[JournalEntry], start_cash: f64) -> Vec<Chapter> {
    let mut told: Vec<Chapter> = Vec::new();
    let mut parts = journal.split_inclusive(|entry| matches!(entry, JournalEntry::Week { .. }));
    let mut cash = start_cash;
    for decided in decisions {
        let entries = parts.next().unwrap_or_default();
        let figures = entries.iter().rev().find_map(figures_of);
        let after = figures.map_or(cash, |figures| figures.cash);
        let chapter = Chapter {
            week: week_of(decided.day + 1),
            last_week: week_of(decided.until),
            day: decided.day,
            until: decided.until,
            why: entries.iter().find_map(rationale_of).unwrap_or_default(),
            changes: changes_in_words(&decided.changes),
            deeds: deeds(decided, entries),
            cash: after,
            cash_change: after - cash,
        };
        cash = after;
        match told.last_mut() {
            Some(before) if before.is_continued_by(&chapter) => {
                before.last_week = chapter.last_week;
                before.until = chapter.until;
                before.cash = chapter.cash;
                before.cash_change += chapter.cash_change;
            }
            _ => told.push(chapter),
        }
    }
    told
}

impl Chapter {
    fn is_continued_by(&self, next: &Chapter) -> bool {
        next.changes.is_empty() && next.deeds.is_empty() && (next.why == self.why || next.why.is_empty())
    }
}

fn figures_of(entry: &JournalEntry) -> Option<&WeekFigures> {
    match entry {
        JournalEntry::Week { figures } => Some(figures),
        _ => None,
    }
}

fn rationale_of(entry: &JournalEntry) -> Option<String> {
    match entry {
        JournalEntry::Advance { rationale, .. } => {
            rationale.lines().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
        }
        _ => None,
    }
}

/// Lists purchases and offers, with repeated ones counted, and posts with their texts.
fn deeds(decided: &Decisions, entries: &[JournalEntry]) -> Vec<String> {
    let posts = entries.iter().filter_map(|entry| match entry {
        JournalEntry::Call { tool, args, .. } if *tool == ToolId::PostSocialMedia => {
            args.get("content").and_then(Value::as_str).map(|content| format!("post: “{content}”"))
        }
        _ => None,
    });
    let mut deeds: Vec<(String, u32)> = Vec::new();
    // The text of a post replaces the sentence that it was published.
    for deed in decided.purchases.iter().filter(|deed| !deed.starts_with("post ")).cloned().chain(posts) {
        match deeds.iter_mut().find(|(known, _)| *known == deed) {
            Some((_, times)) => *times += 1,
            None => deeds.push((deed, 1)),
        }
    }
    let in_words =
        |(deed, times): (String, u32)| if times > 1 { format!("{deed} ({times} times)") } else { deed };
    deeds.into_iter().map(in_words).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;

    #[test]
    fn weeks_without_a_decision_join_the_one_before() {
        let session = test_kit::played(5);
        let told = chapters(session.company().decisions(), session.journal(), 1_000_000.0);
        let weeks: Vec<(u32, u32)> = told.iter().map(|chapter| (chapter.week, chapter.last_week)).collect();
        assert_eq!(weeks, [(1, 2), (3, 3), (4, 5)], "the third week has its own rationale");
        let prices = "price: A 0 → 12, B 0 → 25, C 0 → 55 $/month";
        assert!(told[0].changes.contains(&prices.to_owned()), "{:?}", told[0].changes);
        let post = "post: “NovaMind <opens> today | with *three* plans & fair prices.”";
        assert_eq!(told[0].deeds, [post]);
        assert_eq!(told[1].changes, ["price B: 25 → 22 $/month"]);
        assert_eq!(told[1].why, "If B is cheaper, more will take it; otherwise we go back | <b>B</b>");
        let total: f64 = told.iter().map(|chapter| chapter.cash_change).sum();
        assert!((total - (session.company().observe().cash - 1_000_000.0)).abs() < 0.01);
        assert_eq!(
            told.last().map(|chapter| (chapter.until, chapter.cash)),
            Some((35, session.company().observe().cash))
        );
    }
}
