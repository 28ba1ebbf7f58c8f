//! The paper's behavior measures for one or more runs (docs/laboratory/behaviour.md).
//!
//! The figures come from `report::measures` and have the same names as in `lab compare`.

mod drawn;

use super::ranks::rank_correlation;
use crate::comparison::{ComparedFigure, figure_of, measure_of};
use crate::exhibit::{Column, Datum, Exhibit, Measure, Tabulation, column_name};
use novamind_base::statistics::Sample;
use novamind_record::trajectory::{Line, Record};
use novamind_report::Logbook;
use novamind_report::books::{Books, GroupBook};
use novamind_report::measures::{Wording, planning_sentences};
use novamind_report::plot::level;
use novamind_report::ranking::published;
use novamind_session::Session;

/// A run and the data of its behavior tables.
pub struct ObservedRun {
    /// Report on the run.
    pub book: Logbook,
    /// Groups by week.
    pub groups: Vec<GroupBook>,
    /// Cash at the end of each day, day 0 first.
    pub cash_by_day: Vec<f64>,
    /// Every saved version of the notes.
    pub notes: Vec<KeptNote>,
}

/// One saved version of the notes.
#[derive(Debug, Clone, PartialEq)]
pub struct KeptNote {
    /// Decision day.
    pub day: u32,
    /// Number of words.
    pub wording: Wording,
    /// Sentences that contain a planning word.
    pub plans: Vec<String>,
}

impl ObservedRun {
    /// Reads a run's behavior from its record and its database.
    pub fn of(session: &Session, lines: &[Line]) -> ObservedRun {
        ObservedRun {
            book: Logbook::of(session, lines, &[]),
            groups: Books::of(session).groups,
            cash_by_day: session.cash_by_day().to_vec(),
            notes: notes_of(lines),
        }
    }
}

/// Returns every version of the notes whose text is recorded.
fn notes_of(lines: &[Line]) -> Vec<KeptNote> {
    let kept = lines.iter().filter_map(|line| match &line.record {
        Record::Note(note) => Some((line.day, note.text.as_deref()?)),
        _ => None,
    });
    kept.map(|(day, text)| KeptNote { day, wording: Wording::of(text), plans: planning_sentences(text) })
        .collect()
}

/// Figures of a run (named as in `lab compare`) and their column headings.
const FIGURES: [(&str, &str, &str); 10] = [
    ("survival", "", "life, days"),
    ("ad spend on the truly best channel", "", "ads on best channel"),
    ("ad spend on the best channel, as measured", "", "on best tried"),
    ("targeted share of development", "", "targeted dev."),
    ("forecast error of the first four weeks", "28", "4-week error, first weeks"),
    ("calls that act, a week", "", "calls a week"),
    ("evenness of tools", "", "evenness of tools"),
    ("words of planning in 100", "", "planning in 100 words"),
    ("\"if\" in rationales", "", "\"if\", rationales"),
    ("\"if\" in notes", "", "\"if\", notes"),
];

const MOST_TOOLS: usize = 10;

/// Returns the behavior tables and graphs of some runs.
pub fn exhibit_of(runs: &[ObservedRun]) -> Exhibit {
    let mut exhibit = Exhibit::of("Player behavior", figures(runs));
    exhibit.tables.extend([tools(runs), customers(runs), cash_range(runs), notes(runs), cash(runs)]);
    exhibit.tables.retain(|table| !table.rows.is_empty());
    exhibit.graphs = drawn::graphs(runs);
    if runs.len() > drawn::MOST_WITH_CUSTOMERS {
        exhibit.notes.push(format!(
            "Graphs of customers by group are drawn for up to {} runs.",
            drawn::MOST_WITH_CUSTOMERS
        ));
    }
    exhibit.notes.push(format!(
        "Random allocation puts {:.0}% of ads on the best of the five channels. The truly best channel is shown for runs that are \
         over; best tried compares those that were paid for.",
        published().best_channel_random_share * 100.0
    ));
    exhibit.notes.push(correlation_in_words(runs));
    exhibit
}

/// Returns one row per run, plus mean and standard deviation for several runs.
fn figures(runs: &[ObservedRun]) -> Tabulation {
    let figures: Vec<(&ComparedFigure, &str)> =
        FIGURES.iter().filter_map(|(name, of, heading)| Some((figure_of(name, of)?, *heading))).collect();
    let column = |(figure, heading): &(&ComparedFigure, &str)| {
        // A mean of counts or days is not a whole number.
        let measure = match measure_of(figure.unit()) {
            Measure::Count | Measure::Days => Measure::Number(1),
            other => other,
        };
        Column::numbers(&column_name(&figure.title()), heading, measure)
    };
    let mut columns = vec![Column::words("run", "run"), Column::words("participant", "who")];
    columns.extend(figures.iter().map(column));
    let values =
        |run: &ObservedRun| figures.iter().map(|(figure, _)| figure.value(&run.book)).collect::<Vec<_>>();
    let by_run: Vec<Vec<Option<f64>>> = runs.iter().map(values).collect();
    let row = |(run, own): (&ObservedRun, &Vec<Option<f64>>)| {
        let mut cells = vec![Datum::words(&*run.book.run), who(run).map_or(Datum::Missing, Datum::Words)];
        cells.extend(own.iter().map(|value| Datum::number(*value)));
        cells
    };
    let rows: Vec<Vec<Datum>> = runs.iter().zip(&by_run).map(row).collect();
    let mut summary = Vec::new();
    if runs.len() > 1 {
        let samples: Vec<Sample> = (0..figures.len())
            .map(|at| Sample::of(&by_run.iter().filter_map(|own| own[at]).collect::<Vec<_>>()))
            .collect();
        let told = |name: &str, least: usize, of: fn(&Sample) -> f64| {
            let cells = samples.iter().map(|own| Datum::number((own.count >= least).then(|| of(own))));
            [Datum::words(name), Datum::words("")].into_iter().chain(cells).collect()
        };
        summary.push(told("mean", 1, |own| own.mean));
        summary.push(told("± sd (n − 1)", 2, |own| own.std));
    }
    Tabulation { rows, summary, ..Tabulation::new("measures", "", columns) }
}

fn who(run: &ObservedRun) -> Option<String> {
    run.book.player()
}

fn tools(runs: &[ObservedRun]) -> Tabulation {
    let mut names: Vec<&str> = runs
        .iter()
        .flat_map(|run| run.book.measures.tools.tools.iter().map(|(name, _)| name.as_str()))
        .collect();
    names.sort_unstable();
    names.dedup();
    let calls_of = |run: &ObservedRun, name: &str| {
        let mut tools = run.book.measures.tools.tools.iter();
        tools.find(|(own, _)| own == name).map_or(0, |(_, calls)| *calls)
    };
    let weeks = |run: &ObservedRun| run.book.weeks.len().max(1) as f64;
    let all: u32 = runs.iter().map(|run| run.book.measures.tools.calls).sum();
    let mut told: Vec<(&str, u32, Sample)> = names
        .into_iter()
        .map(|name| {
            let a_week: Vec<f64> =
                runs.iter().map(|run| f64::from(calls_of(run, name)) / weeks(run)).collect();
            (name, runs.iter().map(|run| calls_of(run, name)).sum(), Sample::of(&a_week))
        })
        .collect();
    told.sort_by(|one, other| other.1.cmp(&one.1).then_with(|| one.0.cmp(other.0)));
    let row = |(name, calls, a_week): &(&str, u32, Sample)| {
        vec![
            Datum::words(*name),
            Datum::Number(f64::from(*calls)),
            Datum::Number(f64::from(*calls) / f64::from(all.max(1))),
            Datum::Number(a_week.mean),
            Datum::number((a_week.count > 1).then_some(a_week.std)),
        ]
    };
    let columns = vec![
        Column::words("tool", "tool"),
        Column::numbers("calls", "calls", Measure::Count),
        Column::numbers("share", "of all calls", Measure::Share),
        Column::numbers("calls_a_week", "calls a week", Measure::Number(2)),
        Column::numbers("sd_a_week", "± sd", Measure::Number(2)),
    ];
    let rows = told.iter().take(MOST_TOOLS).map(row).collect();
    Tabulation { rows, ..Tabulation::new("tools", "Most-used tools", columns) }
}

/// Shares of a run at which customers are listed.
const MOMENTS: [f64; 5] = [0.2, 0.4, 0.6, 0.8, 1.0];

fn customers(runs: &[ObservedRun]) -> Tabulation {
    let mut columns = vec![Column::words("run", "run"), Column::words("group", "group")];
    columns.extend(MOMENTS.map(|share| {
        let percent = format!("{:.0}", share * 100.0);
        Column::numbers(&format!("after_{percent}"), &format!("after {percent}%"), Measure::Count)
    }));
    columns.push(Column::numbers("leads", "leads, all", Measure::Count));
    let row = |run: &ObservedRun, group: &GroupBook| {
        let last = group.active.len().saturating_sub(1) as f64;
        let then = |share: f64| group.active.get((share * last).round() as usize).copied();
        let mut cells = vec![Datum::words(&*run.book.run), Datum::words(group.group.id())];
        cells.extend(MOMENTS.map(|share| Datum::number(then(share))));
        cells.push(Datum::Number(group.leads));
        cells
    };
    let rows = runs.iter().flat_map(|run| run.groups.iter().map(move |group| row(run, group))).collect();
    let caption = "Active subscriptions by group, after percentages of the run's weeks";
    Tabulation { rows, ..Tabulation::new("customers", caption, columns) }
}

/// Number of points in a small curve.
const POINTS: usize = 36;

/// Returns the lowest, highest and final cash of each run, with curves on one scale.
fn cash_range(runs: &[ObservedRun]) -> Tabulation {
    let all = || runs.iter().flat_map(|run| run.cash_by_day.iter().copied());
    let (least, most) = (all().fold(0.0, f64::min), all().fold(1.0, f64::max));
    let height = |value: f64| level((value - least) / (most - least));
    // A run that ended early has a shorter curve.
    let longest = runs.iter().map(|run| run.cash_by_day.len()).max().unwrap_or(1).max(2);
    let curve = |run: &ObservedRun| {
        let day = |point: usize| point * (longest - 1) / (POINTS - 1);
        (0..POINTS)
            .map_while(|point| run.cash_by_day.get(day(point)))
            .map(|cash| height(*cash))
            .collect::<String>()
    };
    let columns = vec![
        Column::words("run", "run"),
        Column::words("participant", "who"),
        Column::drawings("curve", "cash by day"),
        Column::numbers("lowest", "lowest", Measure::Dollars),
        Column::numbers("highest", "highest", Measure::Dollars),
        Column::numbers("last", "at the end", Measure::Dollars),
    ];
    let row = |run: &ObservedRun| {
        let of = |fold: fn(f64, f64) -> f64| run.cash_by_day.iter().copied().reduce(fold);
        vec![
            Datum::words(&*run.book.run),
            who(run).map_or(Datum::Missing, Datum::Words),
            Datum::words(curve(run)),
            Datum::number(of(f64::min)),
            Datum::number(of(f64::max)),
            Datum::number(run.cash_by_day.last().copied()),
        ]
    };
    let rows = by_participant(runs).into_iter().map(row).collect();
    Tabulation { rows, ..Tabulation::new("cash_range", "Cash, all curves on one scale", columns) }
}

fn cash(runs: &[ObservedRun]) -> Tabulation {
    let columns = vec![
        Column::words("run", "run"),
        Column::words("participant", "who"),
        Column::numbers("day", "day", Measure::Count),
        Column::numbers("cash", "cash", Measure::Dollars),
    ];
    let days = |run: &ObservedRun| {
        let (name, who) = (run.book.run.clone(), who(run));
        let row = move |(day, cash): (u32, f64)| {
            vec![
                Datum::words(name.clone()),
                who.clone().map_or(Datum::Missing, Datum::Words),
                Datum::Number(f64::from(day)),
                Datum::Number(cash),
            ]
        };
        (0..).zip(run.cash_by_day.clone()).map(row).collect::<Vec<_>>()
    };
    let rows = by_participant(runs).into_iter().flat_map(days).collect();
    Tabulation { rows, is_for_programs: true, ..Tabulation::new("cash", "Cash by day", columns) }
}

fn by_participant(runs: &[ObservedRun]) -> Vec<&ObservedRun> {
    let mut ordered: Vec<&ObservedRun> = runs.iter().collect();
    ordered.sort_by_key(|run| who(run));
    ordered
}

fn notes(runs: &[ObservedRun]) -> Tabulation {
    let columns = vec![
        Column::words("run", "run"),
        Column::numbers("day", "day", Measure::Count),
        Column::numbers("words", "words", Measure::Count),
        Column::numbers("ifs", "\"if\"", Measure::Count),
        Column::words("plans", "planning sentences"),
    ];
    let row = |run: &ObservedRun, note: &KeptNote| {
        vec![
            Datum::words(&*run.book.run),
            Datum::Number(f64::from(note.day)),
            Datum::Number(note.wording.words as f64),
            Datum::Number(note.wording.ifs as f64),
            Datum::words(note.plans.join(" · ")),
        ]
    };
    let rows = runs.iter().flat_map(|run| run.notes.iter().map(move |note| row(run, note))).collect();
    Tabulation { rows, ..Tabulation::new("notes", "Versions of the notes", columns) }
}

/// Returns the forecast error of the first weeks and the survival of each run that has both.
fn errors_and_lives(runs: &[ObservedRun]) -> Vec<(f64, f64)> {
    let of = |name, horizon, run: &ObservedRun| figure_of(name, horizon)?.value(&run.book);
    runs.iter()
        .filter_map(|run| {
            Some((of("forecast error of the first four weeks", "28", run)?, of("survival", "", run)?))
        })
        .collect()
}

fn correlation_in_words(runs: &[ObservedRun]) -> String {
    let pairs = errors_and_lives(runs);
    let told = "Error of 4-week forecasts filed before the first four weeks, against survival";
    match rank_correlation(&pairs) {
        Some(value) => format!("{told}: rank correlation {value:.2} over {} runs.", pairs.len()),
        None => format!("{told}: no correlation. It needs at least three runs that differ in both."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::Ended;
    use novamind_report::test_kit;

    fn observed() -> Vec<ObservedRun> {
        let (session, lines) = test_kit::recorded();
        let first = ObservedRun::of(&session, &lines);
        let (session, lines) = test_kit::recorded();
        let mut second = ObservedRun::of(&session, &lines);
        second.book.measures.survival_days = 7;
        vec![first, second]
    }

    #[test]
    fn every_figure_is_known() {
        for (name, of, _) in FIGURES {
            assert!(figure_of(name, of).is_some(), "{name}");
        }
    }

    #[test]
    fn measures_have_a_mean_and_a_spread() {
        let mut runs = observed();
        let measures = |runs: &[ObservedRun]| exhibit_of(runs).table("measures").expect("measures").clone();
        let of = |table: &Tabulation, row: usize, column: &str| {
            let at = table.columns.iter().position(|own| own.name == column).expect(column);
            table.rows.iter().chain(&table.summary).nth(row).expect("a row")[at].clone()
        };
        let survival = |table: &Tabulation| [0, 1, 2, 3].map(|row| of(table, row, "survival"));
        let open = survival(&measures(&runs));
        assert!(open.iter().all(|own| *own == Datum::Missing), "survival of an open run is unknown");
        runs.iter_mut().for_each(|run| run.book.ended = Some(Ended::Horizon));
        let table = measures(&runs);
        let spread = Sample::of(&[14.0, 7.0]).std;
        assert_eq!(survival(&table), [14.0, 7.0, 10.5, spread].map(Datum::Number));
        assert_eq!(of(&table, 0, "if_in_rationales"), Datum::Number(1.0));
        assert_eq!(of(&table, 0, "if_in_notes"), Datum::Number(0.0));
        assert_eq!(table.as_csv().len(), 1 + 2, "only rows of runs");
        let alone = exhibit_of(&runs[..1]);
        let alone = alone.table("measures").expect("measures");
        assert_eq!((alone.rows.len(), alone.summary.len()), (1, 0));
    }

    #[test]
    fn tools_customers_cash_and_notes_have_tables() {
        let mut runs = observed();
        assert!(exhibit_of(&runs).table("customers").is_none(), "there were no customers");
        runs[0].groups = Books::of(&test_kit::played(5)).groups;
        let exhibit = exhibit_of(&runs);
        let rows = |name: &str| exhibit.table(name).expect(name).as_csv();
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
        let names = exhibit.tables.iter().flat_map(|table| table.as_csv().remove(0));
        let is_plain = |name: &String| {
            name.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'_')
        };
        assert_eq!(names.filter(|name| !is_plain(name)).collect::<Vec<_>>(), Vec::<String>::new());
        let curves = exhibit.as_text(100);
        assert!(
            curves.contains("cash by day") && curves.contains("Cash by day: --csv --table cash"),
            "{curves}"
        );
        assert_eq!(rows("notes")[1][1..], ["14", "2", "0", ""].map(str::to_owned));
    }
}
