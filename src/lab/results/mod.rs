//! The paper's results table for the user's runs, next to the published rows: bankruptcies, best run, survival, and
//! calls per week (docs/laboratory/results-table.md).

#[cfg(feature = "server")]
mod attempts;
mod report;

use std::collections::{BTreeMap, BTreeSet};

use super::metrics::MetricsCollector;
use super::policy::Policy;
use super::runner::{RunEnd, RunError, RunSpec, play_policy};
use novamind_base::statistics::SampleStatistics;
use novamind_record::folder::configuration::{Configuration, DEFAULT_SCENARIO};
use novamind_record::trajectory::record::RunEndReason;
use novamind_record::trajectory::{Line, find_policy};
use novamind_report::measures::{survival_days, tool_use};
use novamind_report::ranking::{
    PublishedAgent, PublishedGeneration, PublishedTable, compare_results, count_published_below,
    published_results,
};
use novamind_report::ranking_eligibility::{
    PUBLISHED_DAYS, PUBLISHED_SEED, PUBLISHED_WHOLE_WEEKS, RankingObstacle, explain_unranked_runs,
};
use novamind_session::Session;
use novamind_world::params::Interface;

#[cfg(feature = "server")]
pub use attempts::{AttemptResult, attempts_report};

/// The result of a finished run with a score.
#[derive(Debug, Clone, PartialEq)]
pub struct FinishedRun {
    /// Name of the run; empty for the idle company.
    pub run: String,
    /// Label of the participant; `None` if the run has no label.
    pub participant: Option<String>,
    /// Name of the policy that played the run; `None` if no policy played.
    pub policy: Option<String>,
    /// Seed of the run.
    pub seed: u64,
    /// Generation of the released simulator whose rules the run uses.
    pub generation: Interface,
    /// Last day of the run.
    pub days: u32,
    /// Cash after the last day, dollars; 0 after a bankruptcy.
    pub score: f64,
    /// Whether the run went bankrupt.
    pub is_bankrupt: bool,
    /// Number of days that the company survived.
    pub survival_days: u32,
    /// Accepted state-changing calls per simulated week.
    pub calls_per_week: f64,
}

impl FinishedRun {
    /// Returns the result of a run, or `None` if the run has no score.
    pub fn from_session(session: &Session, lines: &[Line]) -> Option<FinishedRun> {
        let manifest = session.manifest();
        Some(FinishedRun {
            run: manifest.id.clone(),
            participant: manifest.participant.clone(),
            policy: find_policy(lines).map(str::to_owned),
            seed: manifest.seed,
            generation: manifest.generation(),
            days: manifest.days,
            score: session.score()?,
            is_bankrupt: session.ended() == Some(RunEndReason::Bankruptcy),
            survival_days: survival_days(session.ended(), session.day(), manifest.days),
            calls_per_week: tool_use(session.journal()).per_week,
        })
    }
}

/// The grouping of runs into rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResultsGrouping {
    /// One row per player. A player is a participant or a policy.
    Participant,
    /// One row per policy. Runs that people played are excluded.
    Policy,
}

/// The kind of player in a row. The kind is part of the row's key, because a participant's label can be the
/// same as another player's name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PlayerKind {
    /// A participant with a label.
    Participant,
    /// A participant without a label.
    Unnamed,
    /// A policy that played runs.
    Policy,
    /// The idle company, which is played for the table.
    IdleCompany,
    /// An agent of the paper with its published name.
    PublishedAgent,
    /// The rule-based company of the paper.
    PublishedBaseline,
}

impl PlayerKind {
    /// Returns the source of the row as text.
    pub fn describe(self) -> &'static str {
        match self {
            PlayerKind::Participant => "own",
            PlayerKind::Unnamed => "own, unnamed",
            PlayerKind::Policy => "own policy",
            PlayerKind::IdleCompany => "reference",
            PlayerKind::PublishedAgent | PlayerKind::PublishedBaseline => "published",
        }
    }
}

impl ResultsGrouping {
    fn row_source(self, run: &FinishedRun) -> Option<(PlayerKind, String)> {
        let policy = run.policy.clone().map(|name| (PlayerKind::Policy, name));
        let participant = run.participant.clone().map(|label| (PlayerKind::Participant, label));
        match self {
            ResultsGrouping::Participant => {
                Some(participant.or(policy).unwrap_or((PlayerKind::Unnamed, UNNAMED_ROW.to_owned())))
            }
            ResultsGrouping::Policy => policy,
        }
    }
}

/// A row of the results table: the runs of a player.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultsRow {
    /// Display name of the player.
    pub name: String,
    /// Kind of the player.
    pub source: PlayerKind,
    /// Generation of the runs. Rows are ranked only within a generation.
    pub generation: PublishedGeneration,
    /// Last days of the runs; empty if they are not published.
    pub horizon_days: Vec<u32>,
    /// Number of runs of the player.
    pub runs: u32,
    /// Number of bankruptcies; `None` if the number is not published.
    pub bankruptcies: Option<u32>,
    /// Final cash of the best run, dollars.
    pub best_cash: f64,
    /// Name of the best run; `None` for published rows and the idle company.
    pub best_run: Option<String>,
    /// Longest survival of a run, days; `None` if the survival is not published.
    pub max_survival_days: Option<f64>,
    /// Mean survival of the runs, days; `None` if the survival is not published.
    pub mean_survival_days: Option<f64>,
    /// Standard deviation of survival over all runs, days; `None` for a single run.
    pub std_survival_days: Option<f64>,
    /// Calls per week: state-changing calls of own runs, or turns of published agents.
    pub calls_per_week: Option<f64>,
    /// Number of published best runs of the same generation with less final cash; `None` if no best runs of
    /// the generation are published.
    pub beaten_count: Option<usize>,
}

/// The results table: own runs, the idle company and the published results.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultsTable {
    /// Rows of the table by generation. The best result of each generation comes first.
    pub rows: Vec<ResultsRow>,
    /// Notes below the table.
    pub notes: Vec<String>,
}

/// Name of the policy that makes no calls.
pub const IDLE_POLICY: &str = "P0";

/// Name of the row for participants without a label.
const UNNAMED_ROW: &str = "(no label)";

const IDLE_ROW: &str = "idle company";

/// Plays the idle company of a generation on the seed of the published runs.
///
/// # Errors
/// Fails if the run cannot start.
pub fn play_idle_company(
    policy: &Policy,
    generation: Interface,
    configuration: &Configuration,
) -> Result<FinishedRun, RunError> {
    let scenario = match generation {
        Interface::Release1 => DEFAULT_SCENARIO,
        Interface::Release2 => "release-2",
    };
    let scenario = Some(scenario.to_owned());
    let spec = RunSpec { scenario, surges: Some(true), ..RunSpec::for_seed(PUBLISHED_SEED) };
    let outcome = play_policy(policy, &spec, configuration, &mut MetricsCollector::disabled())?;
    Ok(FinishedRun {
        run: String::new(),
        participant: None,
        policy: Some(outcome.policy),
        seed: outcome.seed,
        generation,
        days: outcome.days,
        score: outcome.cash.max(0.0),
        is_bankrupt: outcome.ended == RunEnd::Bankruptcy,
        survival_days: outcome.day,
        calls_per_week: 0.0,
    })
}

impl ResultsTable {
    /// Creates the table of own runs, the idle company of each generation and the published rows. The notes
    /// list the reasons why runs are not comparable.
    pub fn new(
        runs: &[FinishedRun],
        left_out: &[Vec<RankingObstacle>],
        idle: &[FinishedRun],
        by: ResultsGrouping,
    ) -> ResultsTable {
        let mut groups: BTreeMap<(PublishedGeneration, PlayerKind, String), Vec<&FinishedRun>> =
            BTreeMap::new();
        let mut played_by_people = 0;
        for run in runs {
            match by.row_source(run) {
                Some((kind, name)) => {
                    groups.entry((run.generation.into(), kind, name)).or_default().push(run);
                }
                None => played_by_people += 1,
            }
        }
        let has_one_twice = |finished_runs: &Vec<&FinishedRun>| {
            let seeds: BTreeSet<u64> = finished_runs.iter().map(|run| run.seed).collect();
            seeds.len() < finished_runs.len()
        };
        let again: Vec<&str> = groups
            .iter()
            .filter(|(_, finished_runs)| has_one_twice(finished_runs))
            .map(|((_, _, name), _)| name.as_str())
            .collect();
        let again = (!again.is_empty()).then(|| {
            format!("Several runs of one seed: {}. A person who repeats a seed knows its future; a policy repeats its play.", again.join(", "))
        });
        let mut rows: Vec<ResultsRow> = groups
            .into_iter()
            .filter_map(|((_, kind, name), finished_runs)| results_row((kind, name), &finished_runs))
            .collect();
        rows.extend(idle.iter().filter_map(|idle| {
            let row = results_row((PlayerKind::IdleCompany, IDLE_ROW.to_owned()), &[idle])?;
            Some(ResultsRow { best_run: None, ..row })
        }));
        rows.extend(published_rows());
        rows.sort_by(|one, other| {
            let result = |row: &ResultsRow| (row.best_cash, row.max_survival_days.unwrap_or(0.0) as u32);
            let by_result = compare_results(result(other), result(one));
            one.generation.cmp(&other.generation).then(by_result).then_with(|| one.name.cmp(&other.name))
        });
        let mut notes = table_notes();
        if runs.iter().any(|run| published_results().table_of(run.generation).is_none()) {
            notes.push(
                "The published tables have no results of release 2, so its runs are compared only with each other."
                    .to_owned(),
            );
        }
        notes.extend(explain_unranked_runs(left_out));
        if rows.iter().any(|row| row.source == PlayerKind::Policy) {
            notes.push("Policies are distinguished only by the names in their files.".to_owned());
        }
        notes.extend(again);
        if played_by_people > 0 {
            notes.push(format!("Excluded runs played by people: {played_by_people}."));
        }
        if runs.iter().any(|run| run.seed != PUBLISHED_SEED) {
            notes.push(format!(
                "Own runs with seeds other than {PUBLISHED_SEED} had other random draws than published runs."
            ));
        }
        notes.push(format!("Published: {}.", published_results().paper().source));
        notes.push(format!("{}.", published_results().explain_unranked_agents()));
        ResultsTable { rows, notes }
    }
}

fn best_run<'a>(runs: &[&'a FinishedRun]) -> Option<&'a FinishedRun> {
    let result = |run: &FinishedRun| (run.score, run.survival_days);
    // Ties are broken by name.
    let order = |one: &&FinishedRun, other: &&FinishedRun| {
        compare_results(result(one), result(other)).then_with(|| other.run.cmp(&one.run))
    };
    runs.iter().copied().max_by(|one, other| order(one, other))
}

fn results_row((player, name): (PlayerKind, String), runs: &[&FinishedRun]) -> Option<ResultsRow> {
    let best = best_run(runs)?;
    let survival_times: Vec<f64> = runs.iter().map(|run| published_survival(run)).collect();
    let calls: Vec<f64> = runs.iter().map(|run| run.calls_per_week).collect();
    Some(ResultsRow {
        name,
        source: player,
        generation: best.generation.into(),
        horizon_days: runs.iter().map(|run| run.days).collect::<BTreeSet<u32>>().into_iter().collect(),
        runs: runs.len() as u32,
        bankruptcies: Some(runs.iter().filter(|run| run.is_bankrupt).count() as u32),
        best_cash: best.score,
        best_run: Some(best.run.clone()),
        max_survival_days: survival_times.iter().copied().reduce(f64::max),
        mean_survival_days: Some(SampleStatistics::from_values(&survival_times).mean),
        std_survival_days: (survival_times.len() > 1).then(|| population_std(&survival_times)),
        calls_per_week: Some(SampleStatistics::from_values(&calls).mean),
        beaten_count: count_published_below(best.score, best.generation).map(|(below, _)| below),
    })
}

/// Returns the survival of a run in days. As in the published tables, a run of [`PUBLISHED_WHOLE_WEEKS`] days
/// that did not go bankrupt counts as a run that survived to [`PUBLISHED_DAYS`].
fn published_survival(run: &FinishedRun) -> f64 {
    let is_whole = !run.is_bankrupt && run.days == PUBLISHED_WHOLE_WEEKS;
    f64::from(if is_whole { PUBLISHED_DAYS } else { run.survival_days })
}

/// Returns the population standard deviation, as in the published tables.
fn population_std(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    SampleStatistics::from_values(values).std * ((count - 1.0) / count).sqrt()
}

fn published_rows() -> Vec<ResultsRow> {
    let published = published_results();
    let below = |agent: &PublishedAgent, table: Option<&PublishedTable>| {
        let agents = &table?.agent;
        Some(agents.iter().filter(|other| other.best_cash < agent.best_cash).count())
    };
    let paper = published.paper();
    let ranked = paper.agent.iter().map(|agent| (agent, Some(paper)));
    let mut rows: Vec<ResultsRow> = ranked
        .chain(published.unranked_agents().map(|agent| (agent, None)))
        .map(|(agent, table)| ResultsRow {
            name: agent.name.clone(),
            source: PlayerKind::PublishedAgent,
            generation: agent.generation,
            horizon_days: agent.horizon_days.into_iter().collect(),
            runs: agent.runs,
            bankruptcies: Some(agent.bankruptcies),
            best_cash: agent.best_cash,
            best_run: None,
            max_survival_days: Some(agent.max_survival_days),
            mean_survival_days: Some(agent.mean_survival_days),
            std_survival_days: Some(agent.std_survival_days),
            calls_per_week: Some(agent.turns_per_week),
            beaten_count: below(agent, table),
        })
        .collect();
    rows.push(ResultsRow {
        name: "rule-based baseline".to_owned(),
        source: PlayerKind::PublishedBaseline,
        generation: paper.generation,
        horizon_days: Vec::new(),
        runs: 1,
        bankruptcies: None,
        best_cash: published.rule_based_baseline,
        best_run: None,
        max_survival_days: None,
        mean_survival_days: None,
        std_survival_days: None,
        calls_per_week: None,
        beaten_count: Some(
            paper.agent.iter().filter(|agent| agent.best_cash < published.rule_based_baseline).count(),
        ),
    });
    rows
}

/// Returns the notes that define the figures of the table.
fn table_notes() -> Vec<String> {
    vec![
        "Rows are ranked within their generation; results of different generations are not comparable. Published cash is that of day 500, also for runs that ended on day 497 or 504.".to_owned(),
        "The best run has the most final cash; if all runs went bankrupt, it has the longest survival. The spread of survival is the population standard deviation."
            .to_owned(),
        "Calls a week: for own runs, accepted state-changing calls, averaged over runs; for published runs, turns of an agent, which can contain several calls."
            .to_owned(),
        format!(
            "{IDLE_ROW}: policy {IDLE_POLICY}, played on seed {PUBLISHED_SEED} for this table. Beats: how many of the {} published best runs ended with less cash.",
            published_results().paper().agent.len()
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finished_run(name: &str, who: Option<&str>, score: f64, days: u32) -> FinishedRun {
        FinishedRun {
            run: name.to_owned(),
            participant: who.map(str::to_owned),
            policy: None,
            seed: 42,
            generation: Interface::Release1,
            days: 500,
            score,
            is_bankrupt: days < 500,
            survival_days: days,
            calls_per_week: 2.0,
        }
    }

    fn find_row<'a>(table: &'a ResultsTable, name: &str) -> &'a ResultsRow {
        table.rows.iter().find(|row| row.name == name).expect(name)
    }

    #[test]
    fn runs_are_grouped_and_the_best_is_chosen_by_cash_then_survival() {
        let idle = finished_run("", None, 900_000.0, 500);
        let runs = [
            finished_run("a1", Some("P01"), 0.0, 385),
            finished_run("a2", Some("P01"), 3e6, 500),
            finished_run("a3", Some("P01"), 2e6, 500),
            finished_run("b1", Some("P02"), 0.0, 120),
            finished_run("b2", Some("P02"), 0.0, 131),
            FinishedRun { policy: Some("mine".to_owned()), ..finished_run("d1", None, 1.0, 500) },
        ];
        let table = ResultsTable::new(
            &runs,
            &[vec![RankingObstacle::Length(28)]],
            std::slice::from_ref(&idle),
            ResultsGrouping::Participant,
        );
        let first = find_row(&table, "P01");
        assert_eq!((first.bankruptcies, first.runs, first.best_run.as_deref()), (Some(1), 3, Some("a2")));
        assert_eq!((first.best_cash, first.beaten_count), (3e6, Some(14)));
        // Published mean survival and standard deviation of an agent with one bankruptcy in three runs.
        assert_eq!(first.mean_survival_days.map(|days| (days * 10.0).round() / 10.0), Some(461.7));
        assert_eq!(first.std_survival_days.map(|days| (days * 10.0).round() / 10.0), Some(54.2));
        let second = find_row(&table, "P02");
        assert_eq!((second.best_run.as_deref(), second.max_survival_days), (Some("b2"), Some(131.0)));
        assert!(table.notes.iter().any(|note| note.contains("28 days instead of 500")), "{:?}", table.notes);
        let is_in_order = |one: &ResultsRow, other: &ResultsRow| {
            one.generation < other.generation || one.best_cash >= other.best_cash
        };
        assert!(table.rows.is_sorted_by(is_in_order));
        let policies = ResultsTable::new(&runs, &[], std::slice::from_ref(&idle), ResultsGrouping::Policy);
        assert_eq!(find_row(&policies, "mine").source, PlayerKind::Policy);
        assert!(policies.rows.iter().all(|row| row.name != "P01"));
        // A participant's runs are never merged with a policy's runs or with published runs that have the same name.
        let namesakes =
            [finished_run("e1", Some("mine"), 9e6, 500), finished_run("e2", Some("idle company"), 8e6, 500)];
        let runs: Vec<FinishedRun> = runs.into_iter().chain(namesakes).collect();
        let table = ResultsTable::new(&runs, &[], std::slice::from_ref(&idle), ResultsGrouping::Participant);
        let of = |name: &str| {
            let rows = table.rows.iter().filter(|row| row.name == name);
            rows.map(|row| (row.source.describe(), row.runs)).collect::<Vec<_>>()
        };
        assert_eq!(of("mine"), [("own", 1), ("own policy", 1)]);
        assert_eq!(of("idle company"), [("own", 1), ("reference", 1)]);
    }

    #[test]
    fn idle_company_beats_13_of_16_published_runs() {
        let configuration = Configuration::bundled();
        let policy = Policy::find(IDLE_POLICY, &configuration).expect("a bundled policy");
        let idle = play_idle_company(&policy, Interface::Release1, &configuration).expect("it plays");
        assert_eq!((idle.survival_days, idle.is_bankrupt, idle.score.round()), (500, false, 957_500.0));
        let table = ResultsTable::new(&[], &[], std::slice::from_ref(&idle), ResultsGrouping::Participant);
        assert_eq!(find_row(&table, IDLE_ROW).beaten_count, Some(13));
        assert_eq!(table.rows.len(), 16 + 2 + 3);
    }

    #[test]
    fn generations_have_separate_rankings() {
        let of_release_2 = |name: &str, score: f64| FinishedRun {
            generation: Interface::Release2,
            ..finished_run(name, Some("P01"), score, 500)
        };
        let runs =
            [finished_run("a1", Some("P01"), 2e6, 500), of_release_2("a2", 9e7), of_release_2("a3", 8e7)];
        let idle = [finished_run("", None, 957_500.0, 500), of_release_2("", 957_500.0)];
        let table = ResultsTable::new(&runs, &[], &idle, ResultsGrouping::Participant);
        let of = |generation: PublishedGeneration| {
            let rows = table.rows.iter().filter(move |row| row.generation == generation);
            rows.map(|row| (row.name.as_str(), row.runs, row.beaten_count)).collect::<Vec<_>>()
        };
        let first = of(PublishedGeneration::Release1);
        assert_eq!((first[0].0, first.len()), ("rule-based baseline", 16 + 3));
        assert!(first.contains(&("P01", 1, Some(13))), "{first:?}");
        assert_eq!(of(PublishedGeneration::Release2), [("P01", 2, None), (IDLE_ROW, 1, None)]);
        let not_stated = ["Kimi K3", "Grok 4.6", "Grok 4.5"].map(|name| (name, 3, None));
        assert_eq!(of(PublishedGeneration::NotStated), not_stated);
        assert_eq!(table.rows[first.len()].name, "P01", "the rows of a generation are together");
        assert!(
            table
                .notes
                .iter()
                .any(|note| note.starts_with("The published tables have no results of release 2"))
        );
        // Published runs that survived to day 497 have a survival of 500 days.
        let weeks =
            FinishedRun { days: 497, is_bankrupt: false, ..finished_run("w1", Some("P02"), 1e6, 497) };
        let table = ResultsTable::new(&[weeks], &[], &idle, ResultsGrouping::Participant);
        let row = find_row(&table, "P02");
        assert_eq!((row.max_survival_days, row.horizon_days.as_slice()), (Some(500.0), &[497][..]));
    }
}
