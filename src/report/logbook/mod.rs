//! How a run was played, for researchers: the time it took, what was looked at, asked and called, week by week.
//!
//! Everything is derived from the lines of the trajectory and from the run simulated again; nothing is hidden state.
//! [`columns`] lists every figure of the two tables that are exported, with its unit and meaning.

pub mod columns;
mod summary;
mod timeline;

use std::collections::BTreeMap;

use serde::Serialize;
use serde_json::{Map, Value};

pub use summary::page_of;
pub use timeline::{BREAK_SECONDS, Pause};

use super::books::{Books, ChannelRow};
use super::chapters::change_in_words;
use super::measures::{Measures, Wording};
use crate::session::record::FiledForecast;
use crate::session::{Consent, Ended, Line, Mode, Record, ScoredForecast, Session};
use timeline::{Span, Timeline};

/// How a run was played.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Logbook {
    /// Run.
    pub run: String,
    /// Who played, as the experimenter named them.
    pub participant: Option<String>,
    /// Which text was agreed to before the first day, and when; none if none was asked for.
    pub consent: Option<Consent>,
    /// Mode.
    pub mode: Mode,
    /// Scenario.
    pub scenario: String,
    /// Seed.
    pub seed: u64,
    /// Last day of the run.
    pub days: u32,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Version that recorded it.
    pub version: String,
    /// Digest of the effective parameters.
    pub parameters_digest: String,
    /// Earlier runs of the seed and scenario on the machine.
    pub earlier_runs: u32,
    /// Run it branched from.
    pub parent: Option<String>,
    /// When it was created, RFC 3339.
    pub created: String,
    /// When its last line was written, RFC 3339.
    pub last_at: String,
    /// When it ended, RFC 3339.
    pub ended_at: Option<String>,
    /// How it ended.
    pub ended: Option<Ended>,
    /// Last simulated day.
    pub day: u32,
    /// Cash after it, dollars.
    pub cash: f64,
    /// Score.
    pub score: Option<f64>,
    /// The weeks that ran.
    pub weeks: Vec<WeekLog>,
    /// What was done after the last of them.
    pub open_week: Effort,
    /// Breaks: times without a line that are longer than ten minutes.
    pub breaks: Vec<Pause>,
    /// How often the clock of the machine was set back while the run was played.
    pub clock_set_back: u32,
    /// Sums over the whole run.
    pub total: Effort,
    /// Seconds that a week took to decide, breaks left out: the median; none before the first week.
    pub median_week_seconds: Option<f64>,
    /// Words of all rationales.
    pub wording: Wording,
    /// Behaviour measures.
    pub measures: Measures,
    /// Ads by group and channel.
    pub ads: Vec<ChannelRow>,
    /// State after the last week.
    pub state_hash: Option<String>,
    /// Number of the last line.
    pub last_seq: u64,
    /// Hash of the last line: names the whole trajectory.
    pub last_hash: String,
}

/// What was done between two weeks.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Effort {
    /// Seconds from the first moment to the last, breaks included.
    pub elapsed_seconds: f64,
    /// Seconds without the breaks.
    pub active_seconds: f64,
    /// Breaks.
    pub breaks: u32,
    /// Calls that were accepted.
    pub calls: u32,
    /// Calls that were refused.
    pub refused: u32,
    /// Calls that took back another.
    pub undone: u32,
    /// Accepted calls by tool.
    pub tools: BTreeMap<String, u32>,
    /// SQL queries.
    pub queries: u32,
    /// Queries that were refused or failed.
    pub queries_failed: u32,
    /// Views of screens.
    pub views: u32,
    /// Seconds on each screen, breaks left out.
    pub screens: BTreeMap<String, f64>,
    /// Changes of the notes.
    pub memos: u32,
}

/// A week, or single days, and what was done before it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WeekLog {
    /// Number of the week, from 1.
    pub week: u32,
    /// Day on which it was decided.
    pub decision_day: u32,
    /// Last day that ran.
    pub day: u32,
    /// Days that ran.
    pub days_run: u32,
    /// It was taken over from the run that this one branched from: nobody played it here.
    pub inherited: bool,
    /// When deciding began, RFC 3339.
    pub began_at: String,
    /// When it was decided, RFC 3339.
    pub decided_at: String,
    /// What was done.
    #[serde(flatten)]
    pub effort: Effort,
    /// Words of the rationale.
    pub wording: Wording,
    /// What was decided, in words.
    pub decisions: Vec<String>,
    /// Forecasts.
    pub forecasts: Vec<ScoredForecast>,
    /// They were filled by the naive projection.
    pub filled_naively: Option<bool>,
    /// Figures of the week as its line has them.
    pub figures: Map<String, Value>,
    /// Hash of the state after it.
    pub state_hash: String,
}

impl Logbook {
    /// The logbook of a run from its lines and the run as they make it. Asks the database what ads brought.
    pub fn of(session: &Session, lines: &[Line]) -> Logbook {
        let timeline = Timeline::of(lines);
        let weeks: Vec<WeekLog> =
            timeline.spans.iter().enumerate().map(|(at, span)| week_of_span(session, span, at)).collect();
        let mut total = timeline.open.effort.clone();
        let mut wording = Wording::default();
        for week in &weeks {
            total.add(&week.effort);
            wording += week.wording;
        }
        let own = weeks.iter().filter(|week| !week.inherited).map(|week| week.effort.active_seconds);
        let ads = Books::channels_of(session);
        let (manifest, last) = (session.manifest(), lines.last());
        let end = lines.iter().rev().find(|line| matches!(line.record, Record::End(_)));
        Logbook {
            run: manifest.id.clone(),
            participant: manifest.participant.clone(),
            consent: manifest.consent.clone(),
            mode: manifest.mode,
            scenario: manifest.scenario.clone(),
            seed: manifest.seed,
            days: manifest.days,
            start_cash: manifest.cash,
            version: manifest.version.clone(),
            parameters_digest: manifest.parameters_digest.clone(),
            earlier_runs: manifest.earlier_runs,
            parent: manifest.parent.as_ref().map(|parent| parent.run.clone()),
            created: lines.first().map_or_else(|| manifest.created.clone(), |line| line.at.clone()),
            last_at: last.map(|line| line.at.clone()).unwrap_or_default(),
            ended_at: end.map(|line| line.at.clone()),
            ended: session.ended(),
            day: session.day(),
            cash: session.cash_by_day().last().copied().unwrap_or(manifest.cash),
            score: session.score(),
            median_week_seconds: median(own.collect()),
            open_week: timeline.open.effort,
            breaks: timeline.breaks,
            clock_set_back: timeline.clock_set_back,
            total,
            wording,
            measures: Measures::of(session, &ads),
            ads,
            state_hash: weeks.last().map(|week| week.state_hash.clone()),
            weeks,
            last_seq: last.map_or(0, |line| line.seq),
            last_hash: last.map(|line| line.hash.clone()).unwrap_or_default(),
        }
    }
}

fn week_of_span(session: &Session, span: &Span, at: usize) -> WeekLog {
    let decided = session.decisions().get(at);
    let mut decisions: Vec<String> =
        decided.iter().flat_map(|own| own.changes.iter().map(change_in_words)).collect();
    decisions.extend(decided.iter().flat_map(|own| own.purchases.iter().cloned()));
    let cash = session.cash_by_day();
    let scored = |filed: &FiledForecast| ScoredForecast::of(span.decision_day, &filed.said(), cash);
    WeekLog {
        week: crate::session::week_of(span.day),
        decision_day: span.decision_day,
        day: span.day,
        days_run: span.days_run,
        inherited: span.inherited,
        began_at: span.began_at.clone(),
        decided_at: span.decided_at.clone(),
        effort: span.effort.clone(),
        wording: span.rationale.as_deref().map(Wording::of).unwrap_or_default(),
        decisions,
        forecasts: span.forecasts.iter().map(scored).collect(),
        filled_naively: (!span.forecasts.is_empty())
            .then(|| span.forecasts.iter().any(|forecast| forecast.filled_naively)),
        figures: span.figures.clone(),
        state_hash: span.state_hash.clone(),
    }
}

impl Effort {
    fn add(&mut self, other: &Effort) {
        self.elapsed_seconds += other.elapsed_seconds;
        self.active_seconds += other.active_seconds;
        self.breaks += other.breaks;
        self.calls += other.calls;
        self.refused += other.refused;
        self.undone += other.undone;
        self.queries += other.queries;
        self.queries_failed += other.queries_failed;
        self.views += other.views;
        self.memos += other.memos;
        for (tool, count) in &other.tools {
            *self.tools.entry(tool.clone()).or_default() += count;
        }
        for (screen, seconds) in &other.screens {
            *self.screens.entry(screen.clone()).or_default() += seconds;
        }
    }
}

/// The middle of values; none if there are none.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        count if count % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Configuration, NewRun, Storage, Trajectory, Via};
    use serde_json::json;

    /// A short run on the disk with a bit of everything, and its lines.
    pub(super) fn played() -> (Session, Vec<Line>) {
        let runs = tempfile::tempdir().expect("a folder");
        let new = NewRun {
            days: Some(21),
            participant: Some("P 07".to_owned()),
            storage: Storage::Runs(runs.path().to_owned()),
            ..NewRun::default()
        };
        let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
        session.call("set_prices", &json!({"A": 12, "B": 25, "C": 55}), Via::Form).expect("prices");
        session.call("set_prices", &json!({"A": -1}), Via::Form).expect_err("no price");
        session.query("SELECT count(*) FROM ledger").expect("a count");
        session.query("SELECT c_max FROM nowhere").expect_err("no table");
        session.note_view("cash", "overview", 1500);
        session.note_view("cash", "overview", 500);
        for rationale in ["If it goes well, we wait", "as planned"] {
            let forecasts = session.naive_forecasts();
            session.advance(rationale, &forecasts, Via::Form, &mut |_| {}).expect("a week");
        }
        session.set_memo("watch costs").expect("a memo");
        let path = session.folder().expect("a folder").join("trajectory.jsonl");
        let lines = Trajectory::read(&path).expect("it reads").lines;
        (session, lines)
    }

    #[test]
    fn a_logbook_counts_what_was_done() {
        let (session, lines) = played();
        let book = Logbook::of(&session, &lines);
        assert_eq!((book.weeks.len(), book.day, book.participant.as_deref()), (2, 14, Some("P 07")));
        let first = &book.weeks[0];
        let effort = &first.effort;
        assert_eq!((effort.calls, effort.refused, effort.queries, effort.queries_failed), (1, 1, 2, 1));
        assert_eq!((effort.views, effort.screens.get("cash")), (2, Some(&2.0)));
        assert_eq!((first.wording.words, first.wording.ifs, first.wording.planning), (6, 1, 1));
        assert_eq!(first.decisions.len(), 3, "{:?}", first.decisions);
        assert_eq!((first.filled_naively, first.forecasts.len()), (Some(true), 4));
        assert_eq!(first.forecasts[0].outcome, Some(session.cash_by_day()[7]));
        assert_eq!(first.forecasts[3].outcome, None);
        assert_eq!(book.open_week.memos, 1);
        assert_eq!(book.weeks[1].effort.calls, 0);
        assert_eq!(book.total.queries, 2);
        assert_eq!(book.last_hash, lines.last().expect("a line").hash);
        assert_eq!(book.measures.planning.rationales, 2);
        let value = serde_json::to_value(&book).expect("it is JSON");
        assert_eq!(value["weeks"][0]["queries"], 2);
    }

    #[test]
    fn the_middle_is_found() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
    }
}
