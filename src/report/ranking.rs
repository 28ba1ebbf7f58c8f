//! Ranking of a run's result among the published results.

use std::cmp::Ordering;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::formatting::format_dollar_tick;
use super::ranking_eligibility::{PUBLISHED_SEED, RankingCriteria, RankingObstacle, describe_obstacles};
use novamind_session::{Generation, Observation};

/// The published results, from a bundled file.
#[derive(Debug, Deserialize)]
pub struct PublishedResults {
    /// Cash of the published runs on day 0, dollars.
    pub start_cash: f64,
    /// Final cash of the published rule-based policy, dollars.
    pub rule_based_baseline: f64,
    /// Estimated cash of a perfect player, dollars.
    pub estimated_upper_bound: f64,
    /// Share of advertising spending that goes to the best channel if spending is random.
    pub best_channel_random_share: f64,
    /// Tables of results. The first table is the paper's table.
    pub table: Vec<PublishedTable>,
}

/// A published table of results.
#[derive(Debug, Deserialize)]
pub struct PublishedTable {
    /// Short name of the table: `paper` or `site`.
    pub name: String,
    /// Publication that contains the results.
    pub source: String,
    /// Date on which the table was published or, for a table that changes with time, copied.
    pub date: String,
    /// Generation of the simulator that the agents played.
    pub generation: PublishedGeneration,
    /// What is known about the generation, and on what evidence.
    pub basis: String,
    /// Published results of each agent.
    pub agent: Vec<PublishedAgent>,
}

/// Generation of the released simulator to which a published result belongs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
pub enum PublishedGeneration {
    /// Rules of release 1.
    #[serde(rename = "release 1")]
    Release1,
    /// Rules of release 2.
    #[serde(rename = "release 2")]
    Release2,
    /// The source does not state the generation, and its date is not sufficient to determine it.
    #[default]
    #[serde(rename = "not stated")]
    NotStated,
}

impl From<Generation> for PublishedGeneration {
    fn from(generation: Generation) -> PublishedGeneration {
        match generation {
            Generation::Release1 => PublishedGeneration::Release1,
            Generation::Release2 => PublishedGeneration::Release2,
        }
    }
}

impl PublishedGeneration {
    /// Returns the name that texts and tables use for the generation.
    pub fn name(self) -> &'static str {
        match self {
            PublishedGeneration::Release1 => Generation::Release1.name(),
            PublishedGeneration::Release2 => Generation::Release2.name(),
            PublishedGeneration::NotStated => "not stated",
        }
    }
}

/// Published results of one agent.
#[derive(Debug, Deserialize, Serialize)]
pub struct PublishedAgent {
    /// Name of the agent's model.
    pub name: String,
    /// Number of the agent's runs that ended with cash below zero.
    pub bankruptcies: u32,
    /// Number of runs that the agent played.
    pub runs: u32,
    /// Final cash of the agent's best run, dollars.
    pub best_cash: f64,
    /// Survival of the agent's longest run, days.
    pub max_survival_days: f64,
    /// Mean survival over the agent's runs, days.
    pub mean_survival_days: f64,
    /// Population standard deviation of survival over all runs, days.
    pub std_survival_days: f64,
    /// Number of turns that the agent takes per week.
    pub turns_per_week: f64,
    /// Share of development spending that is targeted; `None` if it is not published.
    #[serde(default)]
    pub targeted_development_share: Option<f64>,
    /// Last day of the agent's best run or, if all runs went bankrupt, of all runs; `None` if it is not published. The
    /// published cash is the cash of day 500.
    #[serde(default)]
    pub horizon_days: Option<u32>,
    /// Generation of the simulator that the agent played.
    #[serde(default)]
    pub generation: PublishedGeneration,
    /// Source of the result.
    #[serde(default)]
    pub source: String,
    /// Date of publication.
    #[serde(default)]
    pub date: String,
}

impl PublishedResults {
    /// Returns the results table of the paper.
    pub fn paper(&self) -> &PublishedTable {
        &self.table[0]
    }

    /// Returns the table that runs of a generation are compared with, or `None` if no results of the generation are
    /// published.
    pub fn table_of(&self, generation: Generation) -> Option<&PublishedTable> {
        self.table.iter().find(|table| table.generation == generation.into())
    }

    /// Returns the results whose generation is not stated and that no other table contains. No run is ranked among
    /// them.
    pub fn unranked_agents(&self) -> impl Iterator<Item = &PublishedAgent> {
        let agents = || self.table.iter().flat_map(|table| &table.agent);
        let is_unranked = |agent: &PublishedAgent| agent.generation == PublishedGeneration::NotStated;
        agents().filter(move |agent| {
            is_unranked(agent) && !agents().any(|other| other.name == agent.name && !is_unranked(other))
        })
    }

    /// Explains why some published results are not ranked: `Not ranked: Kimi K3 …`.
    pub fn explain_unranked_agents(&self) -> String {
        let names: Vec<String> = self
            .unranked_agents()
            .map(|agent| format!("{} {}", agent.name, format_dollar_tick(agent.best_cash)))
            .collect();
        let site = self.table.iter().find(|table| table.generation == PublishedGeneration::NotStated);
        let date = site.map_or("", |table| table.date.as_str());
        format!(
            "Not ranked, because the site's table of {date} does not state their generation: {}",
            names.join(", ")
        )
    }
}

impl PublishedTable {
    /// Lists the different last days of the runs in the table: `497 or 504`.
    pub fn describe_horizons(&self) -> String {
        let mut horizons: Vec<u32> = self.agent.iter().filter_map(|agent| agent.horizon_days).collect();
        horizons.sort_unstable();
        horizons.dedup();
        horizons.iter().map(u32::to_string).collect::<Vec<_>>().join(" or ")
    }
}

/// Formats the last day of a published run: `504`, or `not stated`.
pub fn format_horizon(days: Option<u32>) -> String {
    days.map_or_else(|| PublishedGeneration::NotStated.name().to_owned(), |days| days.to_string())
}

/// Returns the published results.
pub fn published_results() -> &'static PublishedResults {
    static PUBLISHED_RESULTS: OnceLock<PublishedResults> = OnceLock::new();
    PUBLISHED_RESULTS.get_or_init(|| {
        let mut results: PublishedResults = toml::from_str(include_str!("../../assets/paper-results.toml"))
            .expect("the bundled results are valid");
        for table in &mut results.table {
            for agent in &mut table.agent {
                agent.generation = table.generation;
                for (own, of_table) in [(&mut agent.source, &table.source), (&mut agent.date, &table.date)] {
                    if own.is_empty() {
                        own.clone_from(of_table);
                    }
                }
            }
        }
        results
    })
}

/// Origin of a ranked result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResultOrigin {
    /// The best of a published agent's three runs.
    Agent,
    /// The published rule-based baseline.
    Baseline,
    /// The run for which the ranking is computed.
    ThisRun,
}

/// A ranked result with its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedResult {
    /// Name that the ranking shows.
    pub name: String,
    /// Final cash, dollars.
    pub cash: f64,
    /// Where the result comes from.
    pub origin: ResultOrigin,
    /// Last day of the run; `None` if it is not published.
    pub horizon_days: Option<u32>,
}

/// Ranking of a run among the published results.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// Generation of the run and of all results.
    pub generation: Generation,
    /// Results, best first; empty if no results of the generation are published. Includes the result of the run if its
    /// score is comparable.
    pub entries: Vec<RankedResult>,
    /// Rank of the run, counted from 1; `None` if the run is not ranked.
    pub rank: Option<usize>,
    /// Reasons why the run is not ranked. Empty if the run is ranked, or will be ranked as soon as it has a score.
    pub obstacles: Vec<RankingObstacle>,
    /// States the seed and length of the published runs if the run has a different seed; otherwise `None`.
    pub caveat: Option<String>,
    /// Source of the published results; `None` if no results of the generation are published.
    pub source: Option<String>,
}

impl Ranking {
    /// Returns the `best` first results, and the `neighbors` results above and below the run.
    pub fn top_and_neighbors(&self, best: usize, neighbors: usize) -> Vec<&RankedResult> {
        let number = self.entries.iter().position(|place| place.origin == ResultOrigin::ThisRun);
        let wanted =
            |at: usize| at < best || number.is_some_and(|position| position.abs_diff(at) <= neighbors);
        self.entries.iter().enumerate().filter(|(at, _)| wanted(*at)).map(|(_, place)| place).collect()
    }

    /// Describes the rank of the run, or the reasons why it is not ranked.
    pub fn describe(&self) -> String {
        match self.rank {
            Some(rank) => {
                let generation = self.generation.name();
                format!("rank {rank} of {} among the published results of {generation}", self.entries.len())
            }
            None if !self.obstacles.is_empty() => {
                format!("not ranked: {}", describe_obstacles(&self.obstacles))
            }
            None => format!("the published results of {}", self.generation.name()),
        }
    }
}

/// Ranks a score among the published results of the run's generation. A published result with an equal score ranks
/// higher.
pub fn rank_score(score: Option<f64>, seen: &Observation) -> Ranking {
    let place = |name: &str, cash: f64, whose: ResultOrigin, horizon_days: Option<u32>| RankedResult {
        name: name.to_owned(),
        cash,
        origin: whose,
        horizon_days,
    };
    let table = published_results().table_of(seen.generation);
    let mut places: Vec<RankedResult> = table
        .iter()
        .flat_map(|table| &table.agent)
        .map(|agent| place(&agent.name, agent.best_cash, ResultOrigin::Agent, agent.horizon_days))
        .collect();
    if table.is_some_and(|table| table.name == published_results().paper().name) {
        let cash = published_results().rule_based_baseline;
        places.push(place("Rule-based baseline", cash, ResultOrigin::Baseline, None));
    }
    let obstacles = RankingCriteria::from_observation(seen).obstacles();
    let ranked = score.filter(|_| obstacles.is_empty());
    places.extend(ranked.map(|score| place("You", score, ResultOrigin::ThisRun, Some(seen.last_day))));
    places.sort_by(|left, right| right.cash.total_cmp(&left.cash));
    let rank = ranked.map(|score| 1 + places.iter().filter(|place| place.cash > score).count());
    Ranking {
        generation: seen.generation,
        entries: places,
        rank,
        obstacles,
        caveat: table.and_then(|_| caveat(seen)),
        source: table.map(|table| table.source.clone()),
    }
}

/// Compares two results, given as cash and days survived: first by cash, then by survival. Published tables select an
/// agent's best run in this order. The cash of a bankrupt company is 0.
pub fn compare_results(one: (f64, u32), other: (f64, u32)) -> Ordering {
    one.0.total_cmp(&other.0).then(one.1.cmp(&other.1))
}

/// Returns how many published best runs of a generation ended with less cash, and the number of all its published best
/// runs. Returns `None` if no results of the generation are published.
pub fn count_published_below(cash: f64, generation: Generation) -> Option<(usize, usize)> {
    let agents = &published_results().table_of(generation)?.agent;
    Some((agents.iter().filter(|agent| agent.best_cash < cash).count(), agents.len()))
}

/// Returns the lowest and the highest published share of development spending that is targeted, for a generation.
/// Returns `None` if no results of the generation are published.
pub fn published_targeted_share_range(generation: Generation) -> Option<(f64, f64)> {
    let agents = &published_results().table_of(generation)?.agent;
    let shares = agents.iter().filter_map(|agent| agent.targeted_development_share);
    Some(shares.fold((1.0, 0.0), |(least, most), share| (f64::min(least, share), f64::max(most, share))))
}

fn caveat(seen: &Observation) -> Option<String> {
    let text = match seen.seed {
        Some(PUBLISHED_SEED) => return None,
        Some(seed) => format!("seed {seed}"),
        None => "a seed that is not shown".to_owned(),
    };
    Some(format!("{}; this run: {text}.", describe_published_conditions()))
}

/// Describes generation, seed, length and starting cash of the paper's runs, without a full stop.
pub fn describe_published_conditions() -> String {
    let (results, paper) = (published_results(), published_results().paper());
    format!(
        "Published: {}, seed {PUBLISHED_SEED}, {} days, {} at the start",
        paper.generation.name(),
        paper.describe_horizons(),
        format_dollar_tick(results.start_cash)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::mode::Mode;
    use novamind_session::{NewRun, Session};

    #[test]
    fn score_is_ranked_among_published_results() {
        let mut seen = test_kit::play_weeks(0).company().observe();
        (seen.seed, seen.last_day) = (Some(42), 500);
        assert_eq!(seen.scenario, "default");
        let good = rank_score(Some(14_208_331.0), &seen);
        assert_eq!((good.rank, good.caveat.clone()), (Some(2), None));
        assert_eq!(good.describe(), "rank 2 of 18 among the published results of release 1");
        let names: Vec<&str> = good.top_and_neighbors(1, 1).iter().map(|place| place.name.as_str()).collect();
        assert_eq!(names, ["Rule-based baseline", "You", "Claude Fable 5"]);
        let ruined = rank_score(Some(0.0), &seen);
        assert_eq!(ruined.rank, Some(14), "four published agents also have no cash");
        assert_eq!(ruined.entries.last().map(|place| place.origin), Some(ResultOrigin::ThisRun));
        assert_eq!(rank_score(None, &seen).rank, None);
        seen.seed = Some(7);
        assert_eq!(rank_score(Some(0.0), &seen).rank, Some(14), "a different seed stays comparable");
        assert_eq!(published_targeted_share_range(Generation::Release1), Some((0.11, 0.88)));
        assert_eq!(published_targeted_share_range(Generation::Release2), None);
    }

    #[test]
    fn incomparable_run_is_not_ranked() {
        let mut seen = test_kit::play_weeks(0).company().observe();
        for (days, why) in [
            (500, None),
            (497, None),
            (28, Some("28 days instead of 500")),
            (504, Some("504 days instead of 500")),
        ] {
            seen.last_day = days;
            let standing = rank_score(Some(2e6), &seen);
            assert_eq!(standing.rank.is_some(), why.is_none(), "{days}");
            assert_eq!(
                standing.entries.iter().any(|place| place.origin == ResultOrigin::ThisRun),
                why.is_none()
            );
            if let Some(why) = why {
                assert_eq!(standing.describe(), format!("not ranked: {why}"));
            }
        }
    }

    #[test]
    fn ranking_never_mixes_generations() {
        let mut seen = test_kit::play_weeks(0).company().observe();
        (seen.seed, seen.last_day) = (Some(42), 500);
        let first = rank_score(Some(2e6), &seen);
        let names: Vec<&str> = first.entries.iter().map(|place| place.name.as_str()).collect();
        let paper: Vec<&str> =
            published_results().paper().agent.iter().map(|agent| agent.name.as_str()).collect();
        let own = ["You", "Rule-based baseline"];
        assert!(names.iter().all(|name| paper.contains(name) || own.contains(name)), "{names:?}");
        assert_eq!((first.generation, names.len()), (Generation::Release1, 18));
        (seen.generation, seen.scenario) = (Generation::Release2, "release-2".to_owned());
        let second = rank_score(Some(2e6), &seen);
        assert_eq!((second.entries.len(), second.rank, second.source.clone()), (0, None, None));
        assert_eq!(second.describe(), "not ranked: no results of release 2 in the published tables");
    }

    #[test]
    fn every_published_row_has_source_date_generation_and_horizon() {
        let results = published_results();
        assert_eq!(results.table.iter().map(|table| table.agent.len()).collect::<Vec<_>>(), [16, 19]);
        for table in &results.table {
            assert!(!table.basis.is_empty(), "{}", table.name);
            for agent in &table.agent {
                assert!(!agent.source.is_empty(), "{}", agent.name);
                assert_eq!((agent.date.len(), &agent.date[..5]), (10, "2026-"), "{}", agent.name);
                assert_eq!(agent.generation, table.generation, "{}", agent.name);
                // Published cash is the cash of day 500, so these runs must have ended within a week of this day.
                let is_known = agent.horizon_days.is_some_and(|days| [497, 504].contains(&days));
                assert!(is_known || agent.name == "Grok 4.5", "{}", agent.name);
            }
        }
    }

    #[test]
    fn site_table_repeats_the_results_of_the_paper() {
        let results = published_results();
        let site = &results.table[1];
        for agent in &results.paper().agent {
            let other = site.agent.iter().find(|other| other.name == agent.name).expect("a row of the site");
            let figures = |row: &PublishedAgent| {
                let lives = [row.max_survival_days, row.mean_survival_days, row.std_survival_days];
                (row.bankruptcies, row.runs, row.best_cash, lives, row.turns_per_week, row.horizon_days)
            };
            assert_eq!(figures(other), figures(agent), "{}", agent.name);
        }
        let added: Vec<(&str, f64)> =
            results.unranked_agents().map(|agent| (agent.name.as_str(), agent.best_cash)).collect();
        assert_eq!(added, [("Kimi K3", 22_148_357.0), ("Grok 4.6", 246_419.0), ("Grok 4.5", 15_909.0)]);
        assert!(site.agent.is_sorted_by(|one, other| one.best_cash >= other.best_cash));
    }

    #[test]
    fn compare_results_orders_by_cash_then_survival() {
        assert_eq!(compare_results((5.0, 500), (4.0, 500)), Ordering::Greater);
        assert_eq!(compare_results((0.0, 90), (0.0, 131)), Ordering::Less);
        for (cash, below) in [(0.0, 0), (1.0, 4), (1e9, 16)] {
            assert_eq!(count_published_below(cash, Generation::Release1), Some((below, 16)));
            assert_eq!(count_published_below(cash, Generation::Release2), None);
        }
    }

    #[test]
    fn run_with_changed_parameters_is_not_ranked() {
        let has_own_parameters = |scenario: &str, overrides: &[(&str, &str)]| {
            let overrides =
                overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
            let new =
                NewRun { scenario: scenario.to_owned(), mode: Mode::Debug, overrides, ..NewRun::default() };
            Session::create(new, &Configuration::bundled())
                .expect("a run")
                .company()
                .observe()
                .has_own_parameters
        };
        for scenario in ["default", "paper", "competitor-off"] {
            assert!(!has_own_parameters(scenario, &[]), "{scenario}");
            assert!(has_own_parameters(scenario, &[("quality.base_product_quality", "1.0")]), "{scenario}");
        }
    }

    #[test]
    fn caveat_names_a_different_seed() {
        let mut seen = test_kit::play_weeks(0).company().observe();
        let caveat = |seen: &Observation| rank_score(None, seen).caveat;
        assert_eq!(
            caveat(&seen).as_deref(),
            Some("Published: release 1, seed 42, 497 or 504 days, $1M at the start; this run: seed 7.")
        );
        seen.seed = Some(42);
        assert_eq!(caveat(&seen), None);
    }
}
