//! Comparison of the tables with the diaries.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::diary::{Diary, ExpectedAnswer, ExpectedLine, TimeCategory, WEEKS};
use crate::lab::StudyLab;

/// A row of a table by column.
type Row = BTreeMap<String, String>;

fn read_table(folder: &Path, table: &str) -> Vec<Row> {
    let text = fs::read_to_string(folder.join(table)).unwrap_or_else(|error| panic!("{table}: {error}"));
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let headings = reader.headers().expect("headings").clone();
    let row = |record: csv::StringRecord| {
        headings.iter().zip(&record).map(|(name, cell)| (name.to_owned(), cell.to_owned())).collect()
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

fn rows_with_label<'a>(rows: &'a [Row], label: &str) -> Vec<&'a Row> {
    rows.iter().filter(|row| row["participant"] == label).collect()
}

/// Compares every table with the actions of the scripts.
pub fn compare_tables(lab: &StudyLab, diaries: &[Diary]) {
    let [runs, weeks, events, queries, answers, notes, forecasts] =
        ["runs", "weeks", "events", "queries", "answers", "notes", "forecasts"]
            .map(|table| read_table(&lab.tables_folder(), &format!("{table}.csv")));
    assert_eq!(diaries.len(), 12);
    for diary in diaries {
        let tables = [&runs, &weeks, &events, &queries, &answers, &notes, &forecasts];
        let [run, weeks, events, queries, answers, notes, forecasts] =
            tables.map(|rows| rows_with_label(rows, diary.label));
        if diary.erased {
            assert!(run.is_empty() && events.is_empty() && answers.is_empty(), "{}", diary.label);
            continue;
        }
        compare_events(diary, &events);
        let [run] = run[..] else { panic!("{} has {} runs", diary.label, run.len()) };
        compare_run_row(diary, run);
        compare_weeks(diary, &weeks);
        compare_column(diary, &queries, "sql", &diary.queries);
        compare_column(diary, &notes, "text", &diary.notes);
        compare_answers(diary, &answers);
        assert_eq!(forecasts.len(), 4 * diary.weeks.len(), "{}", diary.label);
        assert!(forecasts.iter().all(|row| row["filled_naively"] == "1"), "{}", diary.label);
    }
}

fn compare_events(diary: &Diary, rows: &[&Row]) {
    let texts: Vec<String> = rows.iter().map(|row| event_text(row, diary.is_real_time)).collect();
    let done: Vec<String> =
        diary.lines.iter().map(|line| expected_event_text(line, diary.is_real_time)).collect();
    let different = texts.iter().zip(&done).find(|(text, done)| text != done);
    assert_eq!(different, None, "{}: the table differs from the diary", diary.label);
    assert_eq!(texts.len(), done.len(), "{}", diary.label);
}

fn compare_run_row(diary: &Diary, row: &Row) {
    let deeds =
        |part: fn(&ExpectedLine) -> bool| diary.lines.iter().filter(|line| part(line)).count().to_string();
    let number = diary.label[1..].parse::<u64>().expect("a number");
    let text = |text: &str| text.to_owned();
    let expected = [
        ("study", text("twelve")),
        ("condition", text(if number % 2 == 1 { "odd" } else { "even" })),
        ("assigned_order", number.to_string()),
        ("seed", (40 + number % 3).to_string()),
        ("refused_labels", diary.refused_labels.to_string()),
        ("practice", text("0")),
        ("mode", text("baseline")),
        ("ended", text("horizon")),
        ("weeks", diary.weeks.len().to_string()),
        ("weeks_filled_naively", diary.weeks.iter().filter(|(_, naive)| *naive).count().to_string()),
        (
            "weeks_filed_at_limit",
            deeds(|expected_line| expected_line.kind == "limit" && expected_line.which == "filed_naively"),
        ),
        ("calls", deeds(|deed| deed.kind == "call")),
        ("undone", deeds(|deed| deed.kind == "call" && deed.which == "palette")),
        ("queries", deeds(|deed| deed.kind == "query")),
        ("queries_failed", deeds(|deed| deed.kind == "query" && !deed.which.is_empty())),
        ("note_versions", deeds(|deed| deed.kind == "note")),
        ("sittings", diary.sittings.to_string()),
        ("sittings_not_closed", diary.sittings_not_closed.to_string()),
        ("machines", text("1")),
        ("clock_stopped", deeds(|deed| deed.kind == "clock" && deed.what == "stopped")),
        ("clock_set_back", text("0")),
    ];
    for (column, expected) in expected {
        assert_eq!(row[column], expected, "{}: {column}", diary.label);
    }
    // Actions after the end of the run are not counted.
    let before_the_end = diary.lines.iter().position(|deed| deed.kind == "end").expect("it ended");
    let played = Diary { lines: diary.lines[..before_the_end].to_vec(), ..diary.clone() };
    for (column, kind) in [("views", "view"), ("selects", "select"), ("helps", "help")] {
        if diary.is_real_time && kind == "view" {
            // Plain mode has no screens.
            assert_eq!(row[column], "", "{}", diary.label);
            continue;
        }
        assert_eq!(row[column], played.count(kind).to_string(), "{}: {column}", diary.label);
    }
    for outcome in ["confirmed", "cancelled"] {
        let dialogs = played.lines.iter().filter(|deed| deed.kind == "dialog" && deed.which == outcome);
        let dialogs = if diary.is_real_time { String::new() } else { dialogs.count().to_string() };
        assert_eq!(row[&format!("dialogs_{outcome}")], dialogs, "{}: {outcome}", diary.label);
    }
    compare_times(diary, row);
}

fn cell_ms(row: &Row, column: &str) -> u64 {
    (row[column].parse::<f64>().expect("seconds") * 1e3).round() as u64
}

/// Compares the sums of times over the whole run.
fn compare_times(diary: &Diary, row: &Row) {
    let recorded = |column: &str| cell_ms(row, column);
    let from_diary = |spent| diary.total_ms(spent);
    if diary.is_real_time {
        let within = |column: &str, spent: TimeCategory| {
            let (least, most) = diary.bounds.get(&spent).copied().unwrap_or_default();
            let recorded = recorded(column);
            assert!(
                (least..=most).contains(&recorded),
                "{}: {column} {recorded}: {least} to {most}",
                diary.label
            );
        };
        within("paused_seconds", TimeCategory::Paused);
        if !diary.bounds.contains_key(&TimeCategory::Paused) {
            within("away_seconds", TimeCategory::Away);
        }
        assert_eq!(row["idle_seconds"], "0", "{}", diary.label);
        return;
    }
    assert_eq!(recorded("active_seconds"), from_diary(TimeCategory::Active), "{}", diary.label);
    let after_the_end = diary.answers.last().map_or(0, |answer| answer.for_ms);
    assert_eq!(
        recorded("answering_seconds"),
        from_diary(TimeCategory::Answering) - after_the_end,
        "{}",
        diary.label
    );
    assert_eq!(recorded("idle_seconds"), from_diary(TimeCategory::Idle), "{}", diary.label);
    assert_eq!(
        recorded("away_seconds"),
        from_diary(TimeCategory::Away) + from_diary(TimeCategory::Paused),
        "{}",
        diary.label
    );
    assert_eq!(recorded("paused_seconds"), from_diary(TimeCategory::Paused), "{}", diary.label);
    assert_eq!(recorded("active_seconds_after_end"), from_diary(TimeCategory::After), "{}", diary.label);
}

fn compare_weeks(diary: &Diary, rows: &[&Row]) {
    assert_eq!(rows.len(), diary.weeks.len(), "{}", diary.label);
    for (week, row) in (1..).zip(rows) {
        let recorded = |column: &str| cell_ms(row, column);
        let from_diary = |spent| diary.time.get(&(week, spent)).copied().unwrap_or_default();
        let count = |kind: &str| {
            diary.lines.iter().filter(|line| line.week == week && line.kind == kind).count().to_string()
        };
        assert_eq!(row["week"], week.to_string());
        assert_eq!((&row["calls"], &row["queries"]), (&count("call"), &count("query")), "{}", diary.label);
        if diary.is_real_time {
            continue;
        }
        let expected = [TimeCategory::Active, TimeCategory::Idle, TimeCategory::Paused].map(from_diary);
        let numbers = ["active_seconds", "idle_seconds", "paused_seconds"].map(recorded);
        if week < WEEKS {
            assert_eq!(
                cell_ms(row, "answering_seconds"),
                from_diary(TimeCategory::Answering),
                "{}",
                diary.label
            );
        }
        assert_eq!(numbers, expected, "{} in week {week}", diary.label);
        let fast = if from_diary(TimeCategory::Active) < 10_000 { "1" } else { "0" };
        assert_eq!(row["implausibly_fast"], fast, "{} in week {week}", diary.label);
    }
}

fn compare_column(diary: &Diary, rows: &[&Row], column: &str, expected: &[String]) {
    let texts: Vec<&String> = rows.iter().map(|row| &row[column]).collect();
    assert_eq!(texts, expected.iter().collect::<Vec<_>>(), "{}: {column}", diary.label);
}

fn compare_answers(diary: &Diary, rows: &[&Row]) {
    let exported_answers: Vec<ExpectedAnswer> = rows
        .iter()
        .map(|row| ExpectedAnswer {
            occasion: row["occasion"].clone(),
            question: QUESTIONS.into_iter().find(|name| *name == row["question"]).expect("a question"),
            value: row["value"].clone(),
            for_ms: if diary.is_real_time { 0 } else { row["for_ms"].parse().expect("milliseconds") },
        })
        .collect();
    assert_eq!(exported_answers, diary.answers, "{}", diary.label);
    for row in rows.iter().filter(|row| row["question"] == "check") {
        assert_eq!(row["as_expected"], if row["value"] == "second" { "1" } else { "0" }, "{}", diary.label);
    }
}

const QUESTIONS: [&str; 4] = ["experience", "check", "spoke", "strategy"];

/// Kinds of lines whose duration depends on the machine and not on the participant.
const MACHINE_TIMED_KINDS: [&str; 2] = ["query", "call"];

/// Describes a row of `events.csv`. Times of a real clock are omitted, because [`compare_times`] compares them.
fn event_text(row: &Row, real: bool) -> String {
    let cell = |name: &str| row[name].as_str();
    let which = if cell("kind") == "note" { "" } else { cell("which") };
    let is_measured = !real && !MACHINE_TIMED_KINDS.contains(&cell("kind"));
    let for_ms = if is_measured { cell("for_ms") } else { "" };
    let at = if real { "" } else { cell("t") };
    format!("{at} week {}: {} {} {which} {for_ms}", cell("week"), cell("kind"), cell("what"))
}

/// Describes an action of the script in the format of [`event_text`].
fn expected_event_text(line: &ExpectedLine, real: bool) -> String {
    let for_ms = line.for_ms.map(|ms| ms.to_string()).unwrap_or_default();
    let at = if real { String::new() } else { (line.at as f64 / 1e3).to_string() };
    format!("{at} week {}: {} {} {} {for_ms}", line.week, line.kind, line.what, line.which)
}

/// Checks that the anonymized tables contain the same runs as the original tables.
pub fn compare_anonymized_tables(lab: &StudyLab, diaries: &[Diary]) {
    let public = lab.anonymise();
    for entry in fs::read_dir(&public).expect("a folder").flatten() {
        let text = fs::read_to_string(entry.path()).expect("a text");
        for diary in diaries {
            assert!(!text.contains(diary.label), "{} occurs in {}", diary.label, entry.path().display());
        }
        for text_of_a_person in ["ads for S1", "guessed"] {
            assert!(!text.contains(text_of_a_person), "{text_of_a_person}: {}", entry.path().display());
        }
    }
    let times = |folder: &Path| {
        let rows = read_table(folder, "runs.csv");
        let mut times: Vec<[String; 3]> = rows
            .iter()
            .map(|row| ["active_seconds", "away_seconds", "seed"].map(|column| row[column].clone()))
            .collect();
        times.sort();
        times
    };
    assert_eq!(times(&public), times(&lab.tables_folder()));
}
