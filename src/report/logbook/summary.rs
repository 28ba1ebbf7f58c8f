//! Summary of a session as a page, for its experimenter.

use std::collections::BTreeMap;

use super::{Effort, Logbook, WeekLog};
use crate::page::{Block, Fact, Page, Table};
use crate::words::{count, money, whole};
use novamind_record::trajectory::record::Ended;
use novamind_session::{BREAK_SECONDS, ModelStamp, TimeSpent};

/// Returns the page about a session.
pub fn page_of(book: &Logbook) -> Page {
    let mut blocks = vec![Block::Facts(facts(book))];
    if book.clock_set_back > 0 {
        blocks.push(Block::Warning(format!(
            "The system clock was set back {} during the run; the time around it is not counted.",
            count(book.clock_set_back, "time")
        )));
    }
    blocks.push(Block::Heading("Weeks"));
    blocks.push(weeks(book));
    blocks.push(Block::Note(format!(
        "Time is the active time before each week was run. A break is more than {:.0} minutes \
         without play.",
        BREAK_SECONDS / 60.0
    )));
    blocks.push(Block::Heading("Breaks"));
    blocks.push(breaks(book));
    blocks.push(Block::Heading("Screens"));
    blocks.push(screens(&book.total));
    blocks.push(Block::Heading("Tools"));
    blocks.push(tools(&book.total.tools));
    blocks.push(Block::Heading("Decisions"));
    blocks.extend(decisions(book));
    let mut tags = vec![
        format!("run {}", book.run),
        format!("{} mode", book.mode),
        format!("scenario {}", book.scenario),
        format!("seed {}", book.seed),
    ];
    tags.extend(book.voice.iter().map(ModelStamp::in_words));
    tags.extend(book.parent.iter().map(|parent| format!("branch of {parent}")));
    Page {
        title: format!("NovaMind · session {}", book.run),
        headline: headline(book),
        tags,
        blocks,
        foot: format!(
            "Recorded by NovaMind console {}. Line {} of the trajectory has the hash {}.",
            book.version, book.last_seq, book.last_hash
        ),
    }
}

fn headline(book: &Logbook) -> String {
    let who = book.participant.as_deref().unwrap_or("An unnamed participant");
    let weeks = count(book.weeks.iter().filter(|week| !week.inherited).count() as u32, "week");
    let minutes = whole(book.total.time.active_seconds() / 60.0);
    let how = match book.ended {
        Some(Ended::Horizon) => "to the last day",
        Some(Ended::Bankruptcy) => "into bankruptcy",
        Some(Ended::Abandoned) => "and abandoned the run",
        Some(Ended::Lesson) => "to the end of the lesson",
        None => "and has not finished",
    };
    format!("{who} played {weeks} in {minutes} minutes, {how}; cash is {}.", money(book.cash))
}

fn facts(book: &Logbook) -> Vec<Fact> {
    let total = &book.total;
    let failed = |number: u32, how: &str| if number == 0 { String::new() } else { format!("{number} {how}") };
    let (consent, text) = match &book.consent {
        Some(consent) => {
            (minute(&consent.at), format!("text {}", consent.digest.get(..16).unwrap_or_default()))
        }
        None => ("not required".to_owned(), String::new()),
    };
    let ended = book.ended.map_or(String::new(), |ended| ended.id().to_owned());
    vec![
        Fact::new("Participant", book.participant.as_deref().unwrap_or("no label"), ""),
        Fact::new("Consent", consent, text),
        Fact::new("Started", minute(&book.created), ""),
        Fact::new("Ended", book.ended_at.as_deref().map_or("not yet".to_owned(), minute), ended),
        Fact::new("Last line", minute(&book.last_at), ""),
        Fact::new(
            "Time played",
            time(total.time.active_seconds()),
            format!(
                "idle {}, away {}; {}",
                time(total.time.idle_seconds()),
                time(total.time.away_seconds()),
                count(book.breaks.len() as u32, "break")
            ),
        ),
        Fact::new("Time per week", book.median_week_seconds.map_or("none".to_owned(), time), "median"),
        Fact::new("Calls", whole(f64::from(total.calls)), failed(total.refused, "rejected")),
        Fact::new("Queries", whole(f64::from(total.queries)), failed(total.queries_failed, "failed")),
        Fact::new(
            "Words in rationales",
            whole(book.wording.words as f64),
            failed(book.wording.ifs as u32, "if"),
        ),
        Fact::new("Earlier runs with this seed", book.earlier_runs.to_string(), "in the same runs folder"),
    ]
}

fn weeks(book: &Logbook) -> Block {
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

fn week_row(week: &WeekLog) -> Vec<String> {
    let effort = &week.effort;
    let cash = week.figures.get("cash").and_then(serde_json::Value::as_f64).unwrap_or(0.0);
    let played = |text: String| if week.inherited { String::new() } else { text };
    vec![
        week.week.to_string(),
        if week.inherited { "in the parent run".to_owned() } else { minute(&week.decided_at) },
        played(time(effort.time.active_seconds())),
        played(effort.breaks.to_string()),
        effort.calls.to_string(),
        played(effort.refused.to_string()),
        played(effort.queries.to_string()),
        longest(&effort.screens, 3),
        week.wording.words.to_string(),
        money(cash),
    ]
}

fn breaks(book: &Logbook) -> Block {
    if book.breaks.is_empty() {
        return Block::Text("None.".to_owned());
    }
    let row = |pause: &super::Pause| {
        vec![minute(&pause.from), minute(&pause.to), time(pause.seconds), pause.day.to_string()]
    };
    Block::Table(Table {
        columns: vec![("from", false), ("to", false), ("duration", true), ("day of the run", true)],
        rows: book.breaks.iter().map(row).collect(),
    })
}

fn screens(total: &Effort) -> Block {
    if total.screens.is_empty() {
        return Block::Text("None recorded. Only the console has screens.".to_owned());
    }
    let sorted = by_length(&total.screens);
    let all: f64 = sorted.iter().map(|(_, seconds)| seconds).sum();
    let row = |(name, seconds): (&str, f64)| {
        let share = novamind_base::notation::percent(seconds / all.max(f64::MIN_POSITIVE), 0);
        vec![name.to_owned(), time(seconds), share]
    };
    Block::Table(Table {
        columns: vec![("screen", false), ("time", true), ("share", true)],
        rows: sorted.into_iter().map(row).collect(),
    })
}

fn tools(tools: &BTreeMap<String, u32>) -> Block {
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

fn decisions(book: &Logbook) -> Vec<Block> {
    let told = book.weeks.iter().filter(|week| !week.decisions.is_empty());
    let blocks: Vec<Block> = told
        .map(|week| Block::Folded {
            title: format!("Week {}", week.week),
            note: count(week.decisions.len() as u32, "decision"),
            lines: Vec::new(),
            points: week.decisions.clone(),
        })
        .collect();
    if blocks.is_empty() { vec![Block::Text("No decisions.".to_owned())] } else { blocks }
}

fn longest(screens: &BTreeMap<String, TimeSpent>, most: usize) -> String {
    let sorted = by_length(screens);
    let told = sorted.iter().take(most).map(|(name, seconds)| format!("{name} {}", time(*seconds)));
    told.collect::<Vec<_>>().join(", ")
}

fn by_length(screens: &BTreeMap<String, TimeSpent>) -> Vec<(&str, f64)> {
    let mut sorted: Vec<(&str, f64)> =
        screens.iter().map(|(name, spent)| (name.as_str(), spent.active_seconds())).collect();
    sorted.sort_by(|left, right| right.1.total_cmp(&left.1).then(left.0.cmp(right.0)));
    sorted
}

/// Formats a duration: `45 s`, `12:05`, `1:02:05`.
fn time(seconds: f64) -> String {
    let all = seconds.max(0.0).round() as u64;
    let (hours, minutes, seconds) = (all / 3600, all / 60 % 60, all % 60);
    match (hours, minutes) {
        (0, 0) => format!("{seconds} s"),
        (0, _) => format!("{minutes}:{seconds:02}"),
        _ => format!("{hours}:{minutes:02}:{seconds:02}"),
    }
}

fn minute(at: &str) -> String {
    at.get(..16).unwrap_or(at).replace('T', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_is_told_on_a_page() {
        let (session, lines) = crate::test_kit::recorded();
        let book = Logbook::of(&session, &lines, &[]);
        let text = crate::markdown::write(&page_of(&book));
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
    fn times_read_well() {
        assert_eq!([time(45.2), time(725.0), time(3725.0)], ["45 s", "12:05", "1:02:05"]);
        assert_eq!(minute("2026-11-21T10:00:07.5Z"), "2026-11-21 10:00");
    }
}
