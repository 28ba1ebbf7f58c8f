//! Ranking of a run's result among the published results.

use std::cmp::Ordering;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::formatting::format_dollar_tick;
use super::ranking_eligibility::{
    PUBLISHED_DAYS, PUBLISHED_SEED, RankingCriteria, RankingObstacle, describe_obstacles,
};
use novamind_session::Observation;

/// The published results, read from a bundled file.
#[derive(Debug, Deserialize)]
pub struct PublishedResults {
    /// Source of the published results.
    pub source: String,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Cash of the rule-based policy, dollars.
    pub rule_based_baseline: f64,
    /// Estimated cash of a perfect player, dollars.
    pub estimated_upper_bound: f64,
    /// Share of advertising spending on the best channel if spending is random.
    pub best_channel_random_share: f64,
    /// Published results of each agent.
    pub agent: Vec<PublishedAgent>,
}

/// Published results of one agent.
#[derive(Debug, Deserialize, Serialize)]
pub struct PublishedAgent {
    /// Name of the agent's model.
    pub name: String,
    /// Number of the agent's runs that ended with cash below zero.
    pub bankruptcies: u32,
    /// Number of the agent's runs.
    pub runs: u32,
    /// Final cash of the agent's best run, dollars.
    pub best_cash: f64,
    /// Longest survival of a run, days.
    pub max_survival_days: f64,
    /// Mean survival of a run, days.
    pub mean_survival_days: f64,
    /// Population standard deviation of survival over all runs, days.
    pub std_survival_days: f64,
    /// Turns of the agent per week.
    pub turns_per_week: f64,
    /// Targeted share of development spending, if published.
    #[serde(default)]
    pub targeted_development_share: Option<f64>,
}

/// Returns the published results.
pub fn published_results() -> &'static PublishedResults {
    static PUBLISHED_RESULTS: OnceLock<PublishedResults> = OnceLock::new();
    PUBLISHED_RESULTS.get_or_init(|| {
        toml::from_str(include_str!("../../assets/paper-results.toml"))
            .expect("the bundled results are valid")
    })
}

/// Origin of a ranked result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResultOrigin {
    /// Best of three runs of a published agent.
    Agent,
    /// The published rule-based baseline.
    Baseline,
    /// The run that is ranked.
    ThisRun,
}

/// A ranked result with its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedResult {
    /// Name of the player or agent.
    pub name: String,
    /// Cash at the end, dollars.
    pub cash: f64,
    /// Origin of the result.
    pub owner: ResultOrigin,
}

/// Ranking of a run among the published results.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// Results, best first. Includes the run's result if its score is comparable.
    pub entries: Vec<RankedResult>,
    /// Rank of the run, counted from 1; `None` if the run is not ranked.
    pub rank: Option<usize>,
    /// Reasons why the run is not ranked. Empty if the run is ranked, or will be ranked as soon as the run has a score.
    pub obstacles: Vec<RankingObstacle>,
    /// Seed and length of the published runs, if the run has a different seed.
    pub caveat: Option<String>,
    /// Source of the published results.
    pub source: String,
}

impl Ranking {
    /// Returns the best results, and the results directly above and below the run.
    pub fn top_and_neighbors(&self, best: usize, neighbors: usize) -> Vec<&RankedResult> {
        let number = self.entries.iter().position(|place| place.owner == ResultOrigin::ThisRun);
        let wanted =
            |at: usize| at < best || number.is_some_and(|position| position.abs_diff(at) <= neighbors);
        self.entries.iter().enumerate().filter(|(at, _)| wanted(*at)).map(|(_, place)| place).collect()
    }

    /// Describes the rank of the run, or the reasons why it is not ranked.
    pub fn describe(&self) -> String {
        match self.rank {
            Some(rank) => format!("rank {rank} of {} among the published results", self.entries.len()),
            None if !self.obstacles.is_empty() => {
                format!("not ranked: {}", describe_obstacles(&self.obstacles))
            }
            None => "the published results".to_owned(),
        }
    }
}

/// Ranks a score among the published results. A published result is ranked above an equal score.
pub fn rank_score(score: Option<f64>, seen: &Observation) -> Ranking {
    let place = |name: &str, cash: f64, whose: ResultOrigin| RankedResult {
        name: name.to_owned(),
        cash,
        owner: whose,
    };
    let mut places: Vec<RankedResult> = published_results()
        .agent
        .iter()
        .map(|agent| place(&agent.name, agent.best_cash, ResultOrigin::Agent))
        .collect();
    places.push(place(
        "Rule-based baseline",
        published_results().rule_based_baseline,
        ResultOrigin::Baseline,
    ));
    let obstacles = RankingCriteria::from_observation(seen).obstacles();
    let ranked = score.filter(|_| obstacles.is_empty());
    places.extend(ranked.map(|score| place("You", score, ResultOrigin::ThisRun)));
    places.sort_by(|left, right| right.cash.total_cmp(&left.cash));
    let rank = ranked.map(|score| 1 + places.iter().filter(|place| place.cash > score).count());
    Ranking {
        entries: places,
        rank,
        obstacles,
        caveat: caveat(seen),
        source: published_results().source.clone(),
    }
}

/// Compares two results, given as cash and days survived: by cash, then by survival. The published tables select an
/// agent's best run in the same way. The cash of a bankrupt company is 0.
pub fn compare_results(one: (f64, u32), other: (f64, u32)) -> Ordering {
    one.0.total_cmp(&other.0).then(one.1.cmp(&other.1))
}

/// Returns the number of published best runs that ended with less cash, and the number of all published best runs.
pub fn count_published_below(cash: f64) -> (usize, usize) {
    let agents = &published_results().agent;
    (agents.iter().filter(|agent| agent.best_cash < cash).count(), agents.len())
}

/// Returns the lowest and the highest published targeted share of development spending.
pub fn published_targeted_shares() -> (f64, f64) {
    let shares = published_results().agent.iter().filter_map(|agent| agent.targeted_development_share);
    shares.fold((1.0, 0.0), |(least, most), share| (f64::min(least, share), f64::max(most, share)))
}

fn caveat(seen: &Observation) -> Option<String> {
    let text = match seen.seed {
        Some(PUBLISHED_SEED) => return None,
        Some(seed) => format!("seed {seed}"),
        None => "a seed that is not shown".to_owned(),
    };
    Some(format!("{}; this run: {text}.", describe_published_conditions()))
}

/// Describes seed, length and starting cash of the published runs, without a full stop.
pub fn describe_published_conditions() -> String {
    let start = format_dollar_tick(published_results().start_cash);
    format!("Published: seed {PUBLISHED_SEED}, {PUBLISHED_DAYS} days, {start} at the start")
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
        assert_eq!(good.describe(), "rank 2 of 18 among the published results");
        let names: Vec<&str> = good.top_and_neighbors(1, 1).iter().map(|place| place.name.as_str()).collect();
        assert_eq!(names, ["Rule-based baseline", "You", "Claude Fable 5"]);
        let ruined = rank_score(Some(0.0), &seen);
        assert_eq!(ruined.rank, Some(14), "four published agents also have no cash");
        assert_eq!(ruined.entries.last().map(|place| place.owner), Some(ResultOrigin::ThisRun));
        assert_eq!(rank_score(None, &seen).rank, None);
        seen.seed = Some(7);
        assert_eq!(rank_score(Some(0.0), &seen).rank, Some(14), "a different seed stays comparable");
        assert!(published_targeted_shares().0 < published_targeted_shares().1);
    }

    #[test]
    fn incomparable_run_is_not_ranked() {
        let mut seen = test_kit::play_weeks(0).company().observe();
        for (days, ranked) in [(500, true), (28, false)] {
            seen.last_day = days;
            let standing = rank_score(Some(2e6), &seen);
            assert_eq!(standing.rank.is_some(), ranked, "{days}");
            assert_eq!(standing.entries.iter().any(|place| place.owner == ResultOrigin::ThisRun), ranked);
            assert_eq!(standing.describe() == "not ranked: 28 days instead of 500", !ranked);
        }
    }

    #[test]
    fn compare_results_orders_by_cash_then_survival() {
        assert_eq!(compare_results((5.0, 500), (4.0, 500)), Ordering::Greater);
        assert_eq!(compare_results((0.0, 90), (0.0, 131)), Ordering::Less);
        assert_eq!(
            (count_published_below(0.0), count_published_below(1.0), count_published_below(1e9)),
            ((0, 16), (4, 16), (16, 16))
        );
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
            Some("Published: seed 42, 500 days, $1M at the start; this run: seed 7.")
        );
        seen.seed = Some(42);
        assert_eq!(caveat(&seen), None);
    }
}
