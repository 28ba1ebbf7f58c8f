//! Summary of a session as a page for the experimenter.

use std::collections::BTreeMap;

use super::{Logbook, PlayerEffort, WeekRecord};
use crate::formatting::{format_money, format_whole, pluralize};
use crate::page::{Block, NamedValue, Page, Table};
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::{MIN_BREAK_SECONDS, RecordedModelSettings, TimeSpent};

/// Returns the summary of a session as a page.
pub fn session_page(book: &Logbook) -> Page {
    let mut blocks = vec![Block::Facts(summary_facts(book))];
    if book.clock_set_back > 0 {
        blocks.push(Block::Warning(format!(
            "The system clock was set back {} during the run; the time around it is not counted.",
            pluralize(book.clock_set_back, "time")
        )));
    }
    blocks.push(Block::Heading("Weeks"));
    blocks.push(weeks_block(book));
    blocks.push(Block::Note(format!(
        "Time is the active time before each week was run. A break is more than {:.0} minutes \
         without play.",
        MIN_BREAK_SECONDS / 60.0
    )));
    blocks.push(Block::Heading("Breaks"));
    blocks.push(breaks_block(book));
    blocks.push(Block::Heading("Screens"));
    blocks.push(screens_block(&book.total));
    blocks.push(Block::Heading("Tools"));
    blocks.push(tools_block(&book.total.tools));
    blocks.push(Block::Heading("Decisions"));
    blocks.extend(decision_blocks(book));
    let mut tags = vec![
        format!("run {}", book.run),
        format!("{} mode", book.mode),
        format!("scenario {}", book.scenario),
        format!("seed {}", book.seed),
    ];
    tags.extend(book.voice.iter().map(RecordedModelSettings::describe));
    tags.extend(book.parent.iter().map(|parent| format!("branch of {parent}")));
    Page {
        title: format!("NovaMind · session {}", book.run),
        headline: headline(book),
        tags,
        blocks,
        footer: format!(
            "Recorded by NovaMind console {}. Line {} of the trajectory has the hash {}.",
            book.version, book.last_seq, book.last_hash
        ),
    }
}

fn headline(book: &Logbook) -> String {
    let who = book.participant.as_deref().unwrap_or("An unnamed participant");
    let weeks = pluralize(book.weeks.iter().filter(|week| !week.inherited).count() as u32, "week");
    let minutes = pluralize((book.total.time.active_seconds() / 60.0).round() as u32, "minute");
    let how = match book.ended {
        Some(RunEndReason::Horizon) => "to the last day",
        Some(RunEndReason::Bankruptcy) => "into bankruptcy",
        Some(RunEndReason::Abandoned) => "and abandoned the run",
        Some(RunEndReason::Lesson) => "to the end of the lesson",
        None => "and has not finished",
    };
    format!("{who} played {weeks} in {minutes}, {how}; cash is {}.", format_money(book.cash))
}

fn summary_facts(book: &Logbook) -> Vec<NamedValue> {
    let total = &book.total;
    let failed = |number: u32, how: &str| if number == 0 { String::new() } else { format!("{number} {how}") };
    let (consent, text) = match &book.consent {
        Some(consent) => {
            (format_minute(&consent.at), format!("text {}", consent.digest.get(..16).unwrap_or_default()))
        }
        None => ("not required".to_owned(), String::new()),
    };
    let ended = book.ended.map_or(String::new(), |ended| ended.id().to_owned());
    vec![
        NamedValue::new("Participant", book.participant.as_deref().unwrap_or("no label"), ""),
        NamedValue::new("Consent", consent, text),
        NamedValue::new("Started", format_minute(&book.created), ""),
        NamedValue::new("Ended", book.ended_at.as_deref().map_or("not yet".to_owned(), format_minute), ended),
        NamedValue::new("Last line", format_minute(&book.last_at), ""),
        NamedValue::new(
            "Playing time",
            format_duration(total.time.active_seconds()),
            format!(
                "idle {}, away {}; {}",
                format_duration(total.time.idle_seconds()),
                format_duration(total.time.away_seconds()),
                pluralize(book.breaks.len() as u32, "break")
            ),
        ),
        NamedValue::new(
            "Time per week",
            book.median_week_seconds.map_or("none".to_owned(), format_duration),
            "median",
        ),
        NamedValue::new("Calls", format_whole(f64::from(total.calls)), failed(total.refused, "rejected")),
        NamedValue::new(
            "Queries",
            format_whole(f64::from(total.queries)),
            failed(total.queries_failed, "failed"),
        ),
        NamedValue::new(
            "Words in rationales",
            format_whole(book.wording.words as f64),
            failed(book.wording.ifs as u32, "if"),
        ),
        NamedValue::new(
            "Earlier runs with this seed",
            book.earlier_runs.to_string(),
            "in the same runs folder",
        ),
    ]
}

fn weeks_block(book: &Logbook) -> Block {
    if book.weeks.is_empty() {
        return Block::Text("No week has run yet.".to_owned());
    }
    Block::Table(Table {
        columns: vec![
            ("week", true),
            ("decided", false),
            ("time", true),
            ("breaks", true),
            ("calls", true),
            ("rejected", true),
            ("queries", true),
            ("screens", false),
            ("words", true),
            ("cash", true),
        ],
        rows: book.weeks.iter().map(week_row).collect(),
    })
}

fn week_row(week: &WeekRecord) -> Vec<String> {
    let effort = &week.effort;
    let cash = week.figures.get("cash").and_then(serde_json::Value::as_f64).unwrap_or(0.0);
    let played = |text: String| if week.inherited { String::new() } else { text };
    vec![
        week.week.to_string(),
        if week.inherited { "in the parent run".to_owned() } else { format_minute(&week.decided_at) },
        played(format_duration(effort.time.active_seconds())),
        played(effort.breaks.to_string()),
        effort.calls.to_string(),
        played(effort.refused.to_string()),
        played(effort.queries.to_string()),
        longest_screens(&effort.screens, 3),
        week.wording.words.to_string(),
        format_money(cash),
    ]
}

fn breaks_block(book: &Logbook) -> Block {
    if book.breaks.is_empty() {
        return Block::Text("None.".to_owned());
    }
    let row = |pause: &super::PlayBreak| {
        vec![
            format_minute(&pause.from),
            format_minute(&pause.to),
            format_duration(pause.seconds),
            pause.day.to_string(),
        ]
    };
    Block::Table(Table {
        columns: vec![("from", false), ("to", false), ("duration", true), ("day of the run", true)],
        rows: book.breaks.iter().map(row).collect(),
    })
}

fn screens_block(total: &PlayerEffort) -> Block {
    if total.screens.is_empty() {
        return Block::Text("None recorded. Only the console has screens.".to_owned());
    }
    let sorted = screens_by_time(&total.screens);
    let all: f64 = sorted.iter().map(|(_, seconds)| seconds).sum();
    let row = |(name, seconds): (&str, f64)| {
        let share = novamind_base::formatting::percent(seconds / all.max(f64::MIN_POSITIVE), 0);
        vec![name.to_owned(), format_duration(seconds), share]
    };
    Block::Table(Table {
        columns: vec![("screen", false), ("time", true), ("share", true)],
        rows: sorted.into_iter().map(row).collect(),
    })
}

fn tools_block(tools: &BTreeMap<String, u32>) -> Block {
    if tools.is_empty() {
        return Block::Text("No tool calls.".to_owned());
    }
    let mut sorted: Vec<(&String, &u32)> = tools.iter().collect();
    sorted.sort_by(|left, right| right.1.cmp(left.1).then(left.0.cmp(right.0)));
    Block::Table(Table {
        columns: vec![("tool", false), ("accepted calls", true)],
        rows: sorted.into_iter().map(|(tool, calls)| vec![tool.clone(), calls.to_string()]).collect(),
    })
}

fn decision_blocks(book: &Logbook) -> Vec<Block> {
    let decision_weeks = book.weeks.iter().filter(|week| !week.decisions.is_empty());
    let blocks: Vec<Block> = decision_weeks
        .map(|week| Block::Collapsible {
            title: format!("Week {}", week.week),
            note: pluralize(week.decisions.len() as u32, "decision"),
            lines: Vec::new(),
            points: week.decisions.clone(),
        })
        .collect();
    if blocks.is_empty() { vec![Block::Text("No decisions.".to_owned())] } else { blocks }
}

fn longest_screens(screens: &BTreeMap<String, TimeSpent>, most: usize) -> String {
    let sorted = screens_by_time(screens);
    let texts =
        sorted.iter().take(most).map(|(name, seconds)| format!("{name} {}", format_duration(*seconds)));
    texts.collect::<Vec<_>>().join(", ")
}

fn screens_by_time(screens: &BTreeMap<String, TimeSpent>) -> Vec<(&str, f64)> {
    let mut sorted: Vec<(&str, f64)> =
        screens.iter().map(|(name, spent)| (name.as_str(), spent.active_seconds())).collect();
    sorted.sort_by(|left, right| right.1.total_cmp(&left.1).then(left.0.cmp(right.0)));
    sorted
}

/// Formats a duration: `45 s`, `12:05`, `1:02:05`.
fn format_duration(seconds: f64) -> String {
    let all = seconds.max(0.0).round() as u64;
    let (hours, minutes, seconds) = (all / 3600, all / 60 % 60, all % 60);
    match (hours, minutes) {
        (0, 0) => format!("{seconds} s"),
        (0, _) => format!("{minutes}:{seconds:02}"),
        _ => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

fn format_minute(at: &str) -> String {
    at.get(..16).unwrap_or(at).replace('T', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn session_page_has_all_sections() {
        let (session, lines) = crate::test_kit::recorded_run();
        let book = Logbook::new(&session, &lines, &[]);
        let text = crate::markdown::to_markdown(&session_page(&book));
        for part in
            ["P 07 played 2 weeks", "not required", "cash 0 s", "set\\_prices", "None.", "price A: 0 → 12"]
        {
            assert!(
                text.contains(part) || text.contains(&part.replace('\\', "")),
                "{part} is missing in\n{text}"
            );
        }
    }

    #[test]
    fn durations_are_formatted() {
        assert_eq!(
            [format_duration(45.2), format_duration(725.0), format_duration(3725.0)],
            ["45 s", "12:05", "1:02:05"]
        );
        assert_eq!(format_minute("2026-11-21T10:00:07.5Z"), "2026-11-21 10:00");
    }
}
