//! The paper's measures of player behavior for one or more runs (docs/laboratory/behaviour.md).
//!
//! The figures are computed by `report::measures` and have the same names as in `lab compare`.

mod graphs;

use super::ranks::rank_correlation;
use crate::comparison::{ComparedFigure, find_figure, measure_for_unit};
use crate::lab_report::{CellValue, Column, LabReport, LabTable, Measure, column_name};
use novamind_base::statistics::SampleStatistics;
use novamind_record::trajectory::{Line, Record};
use novamind_report::Logbook;
use novamind_report::database_figures::{DatabaseFigures, GroupHistory};
use novamind_report::measures::{WordCounts, planning_sentences};
use novamind_report::plot::sparkline_char;
use novamind_report::ranking::published_results;
use novamind_session::Session;

/// A run, with the data for its behavior tables.
pub struct BehaviorRun {
    /// Logbook of the run, with its figures and decisions.
    pub logbook: Logbook,
    /// History of each group by week.
    pub groups: Vec<GroupHistory>,
    /// Cash at the end of each day, starting with day 0.
    pub cash_by_day: Vec<f64>,
    /// Saved versions of the notes, in order.
    pub notes: Vec<NoteVersion>,
}

/// One saved version of the notes.
#[derive(Debug, Clone, PartialEq)]
pub struct NoteVersion {
    /// Decision day on which the version was saved.
    pub day: u32,
    /// Word counts of the version.
    pub wording: WordCounts,
    /// Sentences that contain a planning word.
    pub planning_sentences: Vec<String>,
}

impl BehaviorRun {
    /// Reads a run's behavior from its record and its database.
    pub fn from_session(session: &Session, lines: &[Line]) -> BehaviorRun {
        BehaviorRun {
            logbook: Logbook::new(session, lines, &[]),
            groups: DatabaseFigures::load(session).groups,
            cash_by_day: session.cash_by_day().to_vec(),
            notes: note_versions(lines),
        }
    }
}

/// Returns every version of the notes whose text is recorded.
fn note_versions(lines: &[Line]) -> Vec<NoteVersion> {
    let kept = lines.iter().filter_map(|line| match &line.record {
        Record::Note(note) => Some((line.day, note.text.as_deref()?)),
        _ => None,
    });
    kept.map(|(day, text)| NoteVersion {
        day,
        wording: WordCounts::from_text(text),
        planning_sentences: planning_sentences(text),
    })
    .collect()
}

/// The figures of the table: name and horizon in `lab compare`, and column heading.
const FIGURE_COLUMNS: [(&str, &str, &str); 10] = [
    ("survival", "", "survival, days"),
    ("ad spend on the truly best channel", "", "ads on best channel"),
    ("ad spend on the best channel, as measured", "", "ads on best tried"),
    ("targeted share of development", "", "targeted dev."),
    ("forecast error of the first four weeks", "28", "4-week error, first weeks"),
    ("calls that act, a week", "", "calls a week"),
    ("evenness of tools", "", "evenness of tool use"),
    ("words of planning in 100", "", "planning words per 100"),
    ("\"if\" in rationales", "", "\"if\", rationales"),
    ("\"if\" in notes", "", "\"if\", notes"),
];

const MAX_TOOLS: usize = 10;

/// Returns the report on player behavior in the given runs.
pub fn behavior_report(runs: &[BehaviorRun]) -> LabReport {
    let mut exhibit = LabReport::with_table("Player behavior", figure_table(runs));
    exhibit.tables.extend([
        tool_table(runs),
        customer_table(runs),
        cash_range_table(runs),
        note_table(runs),
        cash_table(runs),
    ]);
    exhibit.tables.retain(|table| !table.rows.is_empty());
    exhibit.graphs = graphs::behavior_graphs(runs);
    if runs.len() > graphs::MAX_CUSTOMER_GRAPHS {
        exhibit.notes.push(format!(
            "Graphs of customers by group are drawn for up to {} runs.",
            graphs::MAX_CUSTOMER_GRAPHS
        ));
    }
    exhibit.notes.push(format!(
        "Random allocation spends {:.0}% of the ad budget on the best of the five channels. The truly best channel is shown only for finished runs. \"Best tried\" compares only the channels on which the run spent money.",
        published_results().best_channel_random_share * 100.0
    ));
    exhibit.notes.push(describe_correlation(runs));
    exhibit
}

/// Returns a table with one row per run. For several runs, adds the mean and the standard deviation.
fn figure_table(runs: &[BehaviorRun]) -> LabTable {
    let figures: Vec<(&ComparedFigure, &str)> = FIGURE_COLUMNS
        .iter()
        .filter_map(|(name, of, heading)| Some((find_figure(name, of)?, *heading)))
        .collect();
    let column = |(figure, heading): &(&ComparedFigure, &str)| {
        // The mean of counts or days is not a whole number, so the column needs decimals.
        let measure = match measure_for_unit(figure.unit()) {
            Measure::Count | Measure::Days => Measure::Number(1),
            other => other,
        };
        Column::number(&column_name(&figure.title()), heading, measure)
    };
    let mut columns = vec![Column::text("run", "run"), Column::text("participant", "who")];
    columns.extend(figures.iter().map(column));
    let values =
        |run: &BehaviorRun| figures.iter().map(|(figure, _)| figure.value(&run.logbook)).collect::<Vec<_>>();
    let by_run: Vec<Vec<Option<f64>>> = runs.iter().map(values).collect();
    let row = |(run, run_values): (&BehaviorRun, &Vec<Option<f64>>)| {
        let mut cells = vec![
            CellValue::text(&*run.logbook.run),
            participant_label(run).map_or(CellValue::Missing, CellValue::Text),
        ];
        cells.extend(run_values.iter().map(|value| CellValue::number(*value)));
        cells
    };
    let rows: Vec<Vec<CellValue>> = runs.iter().zip(&by_run).map(row).collect();
    let mut summary = Vec::new();
    if runs.len() > 1 {
        let samples: Vec<SampleStatistics> = (0..figures.len())
            .map(|at| {
                SampleStatistics::from_values(
                    &by_run.iter().filter_map(|run_values| run_values[at]).collect::<Vec<_>>(),
                )
            })
            .collect();
        let summary_row = |name: &str, least: usize, of: fn(&SampleStatistics) -> f64| {
            let cells = samples.iter().map(|sample_statistics| {
                CellValue::number((sample_statistics.count >= least).then(|| of(sample_statistics)))
            });
            [CellValue::text(name), CellValue::text("")].into_iter().chain(cells).collect()
        };
        summary.push(summary_row("mean", 1, |statistics| statistics.mean));
        summary.push(summary_row("± sd (n − 1)", 2, |statistics| statistics.std));
    }
    LabTable { rows, summary, ..LabTable::new("measures", "", columns) }
}

fn participant_label(run: &BehaviorRun) -> Option<String> {
    run.logbook.player_name()
}

fn tool_table(runs: &[BehaviorRun]) -> LabTable {
    let mut names: Vec<&str> = runs
        .iter()
        .flat_map(|run| run.logbook.measures.tools.tools.iter().map(|(name, _)| name.as_str()))
        .collect();
    names.sort_unstable();
    names.dedup();
    let calls_of = |run: &BehaviorRun, name: &str| {
        let mut tools = run.logbook.measures.tools.tools.iter();
        tools.find(|(tool, _)| tool == name).map_or(0, |(_, calls)| *calls)
    };
    let weeks = |run: &BehaviorRun| run.logbook.weeks.len().max(1) as f64;
    let all: u32 = runs.iter().map(|run| run.logbook.measures.tools.calls).sum();
    let mut by_tool: Vec<(&str, u32, SampleStatistics)> = names
        .into_iter()
        .map(|name| {
            let calls_per_week: Vec<f64> =
                runs.iter().map(|run| f64::from(calls_of(run, name)) / weeks(run)).collect();
            (
                name,
                runs.iter().map(|run| calls_of(run, name)).sum(),
                SampleStatistics::from_values(&calls_per_week),
            )
        })
        .collect();
    by_tool.sort_by(|one, other| other.1.cmp(&one.1).then_with(|| one.0.cmp(other.0)));
    let row = |(name, calls, calls_per_week): &(&str, u32, SampleStatistics)| {
        vec![
            CellValue::text(*name),
            CellValue::Number(f64::from(*calls)),
            CellValue::Number(f64::from(*calls) / f64::from(all.max(1))),
            CellValue::Number(calls_per_week.mean),
            CellValue::number((calls_per_week.count > 1).then_some(calls_per_week.std)),
        ]
    };
    let columns = vec![
        Column::text("tool", "tool"),
        Column::number("calls", "calls", Measure::Count),
        Column::number("share", "share of all calls", Measure::Share),
        Column::number("calls_a_week", "calls a week", Measure::Number(2)),
        Column::number("sd_a_week", "± sd", Measure::Number(2)),
    ];
    let rows = by_tool.iter().take(MAX_TOOLS).map(row).collect();
    LabTable { rows, ..LabTable::new("tools", "Most-used tools", columns) }
}

/// Points of a run at which customers are listed, as shares of the run's weeks.
const SAMPLED_RUN_SHARES: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];

fn customer_table(runs: &[BehaviorRun]) -> LabTable {
    let mut columns = vec![Column::text("run", "run"), Column::text("group", "group")];
    columns.extend(SAMPLED_RUN_SHARES.map(|share| {
        let percent = format!("{:.0}", share * 100.0);
        Column::number(&format!("after_{percent}"), &format!("after {percent}%"), Measure::Count)
    }));
    columns.push(Column::number("leads", "all leads", Measure::Count));
    let row = |run: &BehaviorRun, group: &GroupHistory| {
        let last = group.active.len().saturating_sub(1) as f64;
        let then = |share: f64| group.active.get((share * last).round() as usize).copied();
        let mut cells = vec![CellValue::text(&*run.logbook.run), CellValue::text(group.group.id())];
        cells.extend(SAMPLED_RUN_SHARES.map(|share| CellValue::number(then(share))));
        cells.push(CellValue::Number(group.leads));
        cells
    };
    let rows = runs.iter().flat_map(|run| run.groups.iter().map(move |group| row(run, group))).collect();
    let caption = "Active subscriptions by group, at points of the run in percent of the run's weeks";
    LabTable { rows, ..LabTable::new("customers", caption, columns) }
}

/// Number of points in a sparkline.
const SPARKLINE_POINTS: usize = 36;

/// Returns the lowest, highest and final cash of each run, with sparklines on one scale.
fn cash_range_table(runs: &[BehaviorRun]) -> LabTable {
    let all = || runs.iter().flat_map(|run| run.cash_by_day.iter().copied());
    let (least, most) = (all().fold(0.0, f64::min), all().fold(1.0, f64::max));
    let height = |value: f64| sparkline_char((value - least) / (most - least));
    // A run that ended early has a shorter sparkline.
    let longest = runs.iter().map(|run| run.cash_by_day.len()).max().unwrap_or(1).max(2);
    let curve = |run: &BehaviorRun| {
        let day = |point: usize| point * (longest - 1) / (SPARKLINE_POINTS - 1);
        (0..SPARKLINE_POINTS)
            .map_while(|point| run.cash_by_day.get(day(point)))
            .map(|cash| height(*cash))
            .collect::<String>()
    };
    let columns = vec![
        Column::text("run", "run"),
        Column::text("participant", "who"),
        Column::sparkline("curve", "cash by day"),
        Column::number("lowest", "lowest", Measure::Dollars),
        Column::number("highest", "highest", Measure::Dollars),
        Column::number("last", "final", Measure::Dollars),
    ];
    let row = |run: &BehaviorRun| {
        let of = |fold: fn(f64, f64) -> f64| run.cash_by_day.iter().copied().reduce(fold);
        vec![
            CellValue::text(&*run.logbook.run),
            participant_label(run).map_or(CellValue::Missing, CellValue::Text),
            CellValue::text(curve(run)),
            CellValue::number(of(f64::min)),
            CellValue::number(of(f64::max)),
            CellValue::number(run.cash_by_day.last().copied()),
        ]
    };
    let rows = sorted_by_participant(runs).into_iter().map(row).collect();
    LabTable { rows, ..LabTable::new("cash_range", "Cash, all curves on one scale", columns) }
}

fn cash_table(runs: &[BehaviorRun]) -> LabTable {
    let columns = vec![
        Column::text("run", "run"),
        Column::text("participant", "who"),
        Column::number("day", "day", Measure::Count),
        Column::number("cash", "cash", Measure::Dollars),
    ];
    let days = |run: &BehaviorRun| {
        let (name, who) = (run.logbook.run.clone(), participant_label(run));
        let row = move |(day, cash): (u32, f64)| {
            vec![
                CellValue::text(name.clone()),
                who.clone().map_or(CellValue::Missing, CellValue::Text),
                CellValue::Number(f64::from(day)),
                CellValue::Number(cash),
            ]
        };
        (0..).zip(run.cash_by_day.clone()).map(row).collect::<Vec<_>>()
    };
    let rows = sorted_by_participant(runs).into_iter().flat_map(days).collect();
    LabTable { rows, is_machine_readable_only: true, ..LabTable::new("cash", "Cash by day", columns) }
}

fn sorted_by_participant(runs: &[BehaviorRun]) -> Vec<&BehaviorRun> {
    let mut ordered: Vec<&BehaviorRun> = runs.iter().collect();
    ordered.sort_by_key(|run| participant_label(run));
    ordered
}

fn note_table(runs: &[BehaviorRun]) -> LabTable {
    let columns = vec![
        Column::text("run", "run"),
        Column::number("day", "day", Measure::Count),
        Column::number("words", "words", Measure::Count),
        Column::number("ifs", "\"if\"", Measure::Count),
        Column::text("plans", "planning sentences"),
    ];
    let row = |run: &BehaviorRun, note: &NoteVersion| {
        vec![
            CellValue::text(&*run.logbook.run),
            CellValue::Number(f64::from(note.day)),
            CellValue::Number(note.wording.words as f64),
            CellValue::Number(note.wording.ifs as f64),
            CellValue::text(note.planning_sentences.join(" · ")),
        ]
    };
    let rows = runs.iter().flat_map(|run| run.notes.iter().map(move |note| row(run, note))).collect();
    LabTable { rows, ..LabTable::new("notes", "Versions of the notes", columns) }
}

/// Returns the forecast error of the first weeks and the survival of each run that has both figures.
fn forecast_error_survival_pairs(runs: &[BehaviorRun]) -> Vec<(f64, f64)> {
    let of = |name, horizon, run: &BehaviorRun| find_figure(name, horizon)?.value(&run.logbook);
    runs.iter()
        .filter_map(|run| {
            Some((of("forecast error of the first four weeks", "28", run)?, of("survival", "", run)?))
        })
        .collect()
}

fn describe_correlation(runs: &[BehaviorRun]) -> String {
    let pairs = forecast_error_survival_pairs(runs);
    let text = "Error of the 4-week forecasts filed before each of the first four weeks, against survival";
    match rank_correlation(&pairs) {
        Some(value) => format!("{text}: rank correlation {value:.2} over {} runs.", pairs.len()),
        None => {
            format!("{text}: no correlation. At least three runs that differ in both figures are needed.")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::RunEndReason;
    use novamind_report::test_kit;

    fn sample_runs() -> Vec<BehaviorRun> {
        let (session, lines) = test_kit::recorded_run();
        let first = BehaviorRun::from_session(&session, &lines);
        let (session, lines) = test_kit::recorded_run();
        let mut second = BehaviorRun::from_session(&session, &lines);
        second.logbook.measures.survival_days = 7;
        vec![first, second]
    }

    #[test]
    fn behavior_figure_columns_exist() {
        for (name, of, _) in FIGURE_COLUMNS {
            assert!(find_figure(name, of).is_some(), "{name}");
        }
    }

    #[test]
    fn figure_table_has_mean_and_spread() {
        let mut runs = sample_runs();
        let measures =
            |runs: &[BehaviorRun]| behavior_report(runs).table("measures").expect("measures").clone();
        let of = |table: &LabTable, row: usize, column: &str| {
            let at = table.columns.iter().position(|table_column| table_column.name == column).expect(column);
            table.rows.iter().chain(&table.summary).nth(row).expect("a row")[at].clone()
        };
        let survival = |table: &LabTable| [0, 1, 2, 3].map(|row| of(table, row, "survival"));
        let open = survival(&measures(&runs));
        assert!(
            open.iter().all(|cell_value| *cell_value == CellValue::Missing),
            "survival of an open run is unknown"
        );
        runs.iter_mut().for_each(|run| run.logbook.ended = Some(RunEndReason::Horizon));
        let table = measures(&runs);
        let spread = SampleStatistics::from_values(&[14.0, 7.0]).std;
        assert_eq!(survival(&table), [14.0, 7.0, 10.5, spread].map(CellValue::Number));
        assert_eq!(of(&table, 0, "if_in_rationales"), CellValue::Number(1.0));
        assert_eq!(of(&table, 0, "if_in_notes"), CellValue::Number(0.0));
        assert_eq!(table.to_csv_rows().len(), 1 + 2, "only rows of runs");
        let alone = behavior_report(&runs[..1]);
        let alone = alone.table("measures").expect("measures");
        assert_eq!((alone.rows.len(), alone.summary.len()), (1, 0));
    }

    #[test]
    fn behavior_report_has_all_tables() {
        let mut runs = sample_runs();
        assert!(behavior_report(&runs).table("customers").is_none(), "there were no customers");
        runs[0].groups = DatabaseFigures::load(&test_kit::play_weeks(5)).groups;
        let exhibit = behavior_report(&runs);
        let rows = |name: &str| exhibit.table(name).expect(name).to_csv_rows();
        assert_eq!(rows("tools")[1][..3], ["set_prices", "2", "1"]);
        let groups = runs[0].groups.len();
        assert_eq!(rows("customers").len(), 1 + groups);
        assert_eq!(rows("cash_range")[0], ["run", "participant", "lowest", "highest", "last"]);
        assert_eq!(rows("cash_range").len(), 1 + 2);
        let days: usize = runs.iter().map(|run| run.cash_by_day.len()).sum();
        assert_eq!(
            (rows("cash")[0].join(","), rows("cash").len()),
            ("run,participant,day,cash".to_owned(), 1 + days)
        );
        assert_eq!(rows("cash")[1][2..], ["0", "1000000"]);
        let names = exhibit.tables.iter().flat_map(|table| table.to_csv_rows().remove(0));
        let is_plain = |name: &String| {
            name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_')
        };
        assert_eq!(names.filter(|name| !is_plain(name)).collect::<Vec<_>>(), Vec::<String>::new());
        let curves = exhibit.to_text(100);
        assert!(
            curves.contains("cash by day") && curves.contains("Cash by day: --csv --table cash"),
            "{curves}"
        );
        assert_eq!(rows("notes")[1][1..], ["14", "2", "0", ""].map(str::to_owned));
    }
}
