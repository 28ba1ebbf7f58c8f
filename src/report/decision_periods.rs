//! Decisions by week: settings with old and new values, purchases, posts and offers, and the first line of the
//! rationale.

use serde_json::Value;

use super::formatting::format_number;
use novamind_record::figures::WeekFigures;
use novamind_session::{Decisions, JournalEntry, SettingChange, week_of_day};
use novamind_tools::ToolId;

/// Consecutive weeks with the same decisions: the player decided before the first of these weeks and changed nothing
/// before the others.
#[derive(Debug, Clone, PartialEq)]
pub struct DecisionPeriod {
    /// First week of the period, counted from 1.
    pub week: u32,
    /// Last week of the period, counted from 1.
    pub last_week: u32,
    /// Day on which the player decided, before the first week.
    pub day: u32,
    /// Last simulated day of the period.
    pub end_day: u32,
    /// First line of the player's rationale.
    pub rationale: String,
    /// Descriptions of the changed settings, with old and new values.
    pub changes: Vec<String>,
    /// Descriptions of the purchases, posts and offers.
    pub actions: Vec<String>,
    /// Cash at the end of the period, dollars.
    pub cash: f64,
    /// Change in cash over the period, dollars.
    pub cash_change: f64,
}

/// Describes the change of a setting: `price A: 0 → 14 $/month`.
pub fn describe_change(change: &SettingChange) -> String {
    let text = format!("{}: {} → {}", change.setting, format_number(change.old), format_number(change.new));
    change.setting.unit().map_or(text.clone(), |unit| format!("{text} {unit}"))
}

/// Sorts changed settings by the size of the change in dollars, largest first. Settings whose unit is not dollars
/// follow in their original order.
pub fn by_amount(changes: &[SettingChange]) -> Vec<&SettingChange> {
    let amount = |change: &SettingChange| match change.setting.unit() {
        Some(unit) if unit.starts_with('$') => (change.new - change.old).abs(),
        _ => -1.0,
    };
    let mut sorted: Vec<&SettingChange> = changes.iter().collect();
    sorted.sort_by(|left, right| amount(right).total_cmp(&amount(left)));
    sorted
}

/// Describes changed settings, one line per family of settings: `price: A 0 → 14, B 0 → 49 $/month`.
pub fn describe_changes(changes: &[SettingChange]) -> Vec<String> {
    let mut families: Vec<(String, Vec<&SettingChange>)> = Vec::new();
    for change in changes {
        let (family, _) = change.setting.name_parts();
        match families.iter_mut().find(|(known, _)| *known == family) {
            Some((_, members)) => members.push(change),
            None => families.push((family, vec![change])),
        }
    }
    let member = |change: &&SettingChange| {
        let (_, member) = change.setting.name_parts();
        let name = if member.is_empty() { "in general" } else { &member };
        format!("{name} {} → {}", format_number(change.old), format_number(change.new))
    };
    let line = |(family, members): (String, Vec<&SettingChange>)| match members[..] {
        [only] => describe_change(only),
        _ => {
            let texts: Vec<String> = members.iter().map(member).collect();
            let unit = members[0].setting.unit().map_or(String::new(), |unit| format!(" {unit}"));
            format!("{family}: {}{unit}", texts.join(", "))
        }
    };
    families.into_iter().map(line).collect()
}

/// Returns the decision periods of a run. A week without a new decision extends the previous period.
pub fn decision_periods(
    decisions: &[Decisions],
    journal: &[JournalEntry],
    start_cash: f64,
) -> Vec<DecisionPeriod> {
    let mut periods: Vec<DecisionPeriod> = Vec::new();
    let mut parts = journal.split_inclusive(|entry| matches!(entry, JournalEntry::Week { .. }));
    let mut cash = start_cash;
    for decided in decisions {
        let entries = parts.next().unwrap_or_default();
        let figures = entries.iter().rev().find_map(week_figures);
        let after = figures.map_or(cash, |figures| figures.cash);
        let decision_period = DecisionPeriod {
            week: week_of_day(decided.day + 1),
            last_week: week_of_day(decided.until),
            day: decided.day,
            end_day: decided.until,
            rationale: entries.iter().find_map(rationale_first_line).unwrap_or_default(),
            changes: describe_changes(&decided.changes),
            actions: describe_actions(decided, entries),
            cash: after,
            cash_change: after - cash,
        };
        cash = after;
        match periods.last_mut() {
            Some(before) if before.is_continued_by(&decision_period) => {
                before.last_week = decision_period.last_week;
                before.end_day = decision_period.end_day;
                before.cash = decision_period.cash;
                before.cash_change += decision_period.cash_change;
            }
            _ => periods.push(decision_period),
        }
    }
    periods
}

impl DecisionPeriod {
    fn is_continued_by(&self, next: &DecisionPeriod) -> bool {
        next.changes.is_empty()
            && next.actions.is_empty()
            && (next.rationale == self.rationale || next.rationale.is_empty())
    }
}

fn week_figures(entry: &JournalEntry) -> Option<&WeekFigures> {
    match entry {
        JournalEntry::Week { figures } => Some(figures),
        _ => None,
    }
}

fn rationale_first_line(entry: &JournalEntry) -> Option<String> {
    match entry {
        JournalEntry::Advance { rationale, .. } => {
            rationale.lines().map(str::trim).find(|line| !line.is_empty()).map(str::to_owned)
        }
        _ => None,
    }
}

/// Lists purchases and offers, and posts with their texts. An action that was repeated is listed once, with a count.
fn describe_actions(decided: &Decisions, entries: &[JournalEntry]) -> Vec<String> {
    let posts = entries.iter().filter_map(|entry| match entry {
        JournalEntry::Call { tool, args, .. } if *tool == ToolId::PostSocialMedia => {
            args.get("content").and_then(Value::as_str).map(|content| format!("post: “{content}”"))
        }
        _ => None,
    });
    let mut counted_actions: Vec<(String, u32)> = Vec::new();
    // The journal entry with the text of a post replaces the purchase that only mentions the post.
    for deed in decided.purchases.iter().filter(|deed| !deed.starts_with("post ")).cloned().chain(posts) {
        match counted_actions.iter_mut().find(|(known, _)| *known == deed) {
            Some((_, times)) => *times += 1,
            None => counted_actions.push((deed, 1)),
        }
    }
    let in_words =
        |(deed, times): (String, u32)| if times > 1 { format!("{deed} ({times} times)") } else { deed };
    counted_actions.into_iter().map(in_words).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;
    use novamind_session::SettingId;
    use novamind_session::identifiers::{Channel, Group, Plan};

    #[test]
    fn changes_are_sorted_by_their_amount_of_money() {
        let change = |setting, old, new| SettingChange { setting, old, new };
        let [s1, e1] = ["S1", "E1"].map(|id| Group::parse(id).expect("a group"));
        let changes = [
            change(SettingId::CapacityTier, 0.0, 4.0),
            change(SettingId::Advertising(Channel::Linkedin, s1), 0.0, 50.0),
            change(SettingId::Quota(Plan::A), 0.0, 400_000.0),
            change(SettingId::TargetedDevelopment(e1), 9000.0, 0.0),
        ];
        let sorted: Vec<f64> =
            by_amount(&changes).into_iter().map(|change| change.new.max(change.old)).collect();
        assert_eq!(sorted, [9000.0, 50.0, 4.0, 400_000.0]);
    }

    #[test]
    fn weeks_without_decisions_extend_the_previous_period() {
        let session = test_kit::play_weeks(5);
        let periods = decision_periods(session.company().decisions(), session.journal(), 1_000_000.0);
        let weeks: Vec<(u32, u32)> =
            periods.iter().map(|decision_period| (decision_period.week, decision_period.last_week)).collect();
        assert_eq!(weeks, [(1, 2), (3, 3), (4, 5)], "the third week has its own rationale");
        let prices = "price: A 0 → 12, B 0 → 25, C 0 → 55 $/month";
        assert!(periods[0].changes.contains(&prices.to_owned()), "{:?}", periods[0].changes);
        let post = "post: “NovaMind <opens> today | with *three* plans & fair prices.”";
        assert_eq!(periods[0].actions, [post]);
        assert_eq!(periods[1].changes, ["price B: 25 → 22 $/month"]);
        assert_eq!(
            periods[1].rationale,
            "If B is cheaper, more will take it; otherwise we go back | <b>B</b>"
        );
        let total: f64 = periods.iter().map(|decision_period| decision_period.cash_change).sum();
        assert!((total - (session.company().observe().cash - 1_000_000.0)).abs() < 0.01);
        assert_eq!(
            periods.last().map(|decision_period| (decision_period.end_day, decision_period.cash)),
            Some((35, session.company().observe().cash))
        );
    }
}
