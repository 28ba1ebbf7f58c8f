//! A run's result compared with the published results.

use std::cmp::Ordering;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::comparable::{Obstacle, PUBLISHED_DAYS, PUBLISHED_SEED, RunTerms, obstacles_in_words};
use super::words::dollar_tick;
use novamind_session::Observation;

/// The published results, read from a bundled file.
#[derive(Debug, Deserialize)]
pub struct Published {
    /// Source of the results.
    pub source: String,
    /// Cash on day 0, dollars.
    pub start_cash: f64,
    /// Cash of the rule-based policy, dollars.
    pub rule_based_baseline: f64,
    /// Estimated cash of a perfect player, dollars.
    pub estimated_upper_bound: f64,
    /// Share of advertising that reaches the best channel with random spending.
    pub best_channel_random_share: f64,
    /// Results of agents.
    pub agent: Vec<Agent>,
}

/// Results of one agent.
#[derive(Debug, Deserialize, Serialize)]
pub struct Agent {
    /// Model.
    pub name: String,
    /// Number of runs that ended with cash below zero.
    pub bankruptcies: u32,
    /// Number of runs.
    pub runs: u32,
    /// Cash of the best run, dollars.
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
pub fn published() -> &'static Published {
    static READ: OnceLock<Published> = OnceLock::new();
    READ.get_or_init(|| {
        toml::from_str(include_str!("../../assets/paper-results.toml"))
            .expect("the bundled results are valid")
    })
}

/// Origin of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// Best of three runs of a published agent.
    Agent,
    /// The published rule-based baseline.
    Baseline,
    /// This run.
    Own,
}

/// A result with its origin.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedRun {
    /// Name.
    pub name: String,
    /// Cash at the end, dollars.
    pub cash: f64,
    /// Origin.
    pub whose: Whose,
}

/// All results, the best first.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// Results, including this run's if it has a comparable score.
    pub places: Vec<RankedRun>,
    /// Rank of this run, from 1.
    pub rank: Option<usize>,
    /// Reasons not to rank this run; empty if it is ranked, or will be when it has a score.
    pub obstacles: Vec<Obstacle>,
    /// Terms of the published runs, if this run has a different seed.
    pub caveat: Option<String>,
    /// Source of the published results.
    pub source: String,
}

impl Standing {
    /// Returns the best results and those around this run's.
    pub fn around(&self, best: usize, beside: usize) -> Vec<&RankedRun> {
        let own = self.places.iter().position(|place| place.whose == Whose::Own);
        let wanted = |at: usize| at < best || own.is_some_and(|own| own.abs_diff(at) <= beside);
        self.places.iter().enumerate().filter(|(at, _)| wanted(*at)).map(|(_, place)| place).collect()
    }

    /// Describes the rank.
    pub fn in_words(&self) -> String {
        match self.rank {
            Some(rank) => format!("rank {rank} of {} among the published results", self.places.len()),
            None if !self.obstacles.is_empty() => {
                format!("not ranked: {}", obstacles_in_words(&self.obstacles))
            }
            None => "the published results".to_owned(),
        }
    }
}

/// Ranks a score among the published results; in ties, published results come first.
pub fn standing(score: Option<f64>, seen: &Observation) -> Standing {
    let place = |name: &str, cash: f64, whose: Whose| RankedRun { name: name.to_owned(), cash, whose };
    let mut places: Vec<RankedRun> =
        published().agent.iter().map(|agent| place(&agent.name, agent.best_cash, Whose::Agent)).collect();
    places.push(place("Rule-based baseline", published().rule_based_baseline, Whose::Baseline));
    let obstacles = RunTerms::of_observation(seen).obstacles();
    let ranked = score.filter(|_| obstacles.is_empty());
    places.extend(ranked.map(|score| place("You", score, Whose::Own)));
    places.sort_by(|left, right| right.cash.total_cmp(&left.cash));
    let rank = ranked.map(|score| 1 + places.iter().filter(|place| place.cash > score).count());
    Standing { places, rank, obstacles, caveat: caveat(seen), source: published().source.clone() }
}

/// Compares two results of cash and days survived: more cash is greater, then longer survival. The published tables
/// choose an agent's best run this way; a bankrupt company has no cash.
pub fn by_result(one: (f64, u32), other: (f64, u32)) -> Ordering {
    one.0.total_cmp(&other.0).then(one.1.cmp(&other.1))
}

/// Returns how many of the published best runs ended with less cash, and how many there are.
pub fn beaten(cash: f64) -> (usize, usize) {
    let agents = &published().agent;
    (agents.iter().filter(|agent| agent.best_cash < cash).count(), agents.len())
}

/// Returns the lowest and the highest published targeted share of development spending.
pub fn published_targeted_shares() -> (f64, f64) {
    let shares = published().agent.iter().filter_map(|agent| agent.targeted_development_share);
    shares.fold((1.0, 0.0), |(least, most), share| (f64::min(least, share), f64::max(most, share)))
}

fn caveat(seen: &Observation) -> Option<String> {
    let own = match seen.seed {
        Some(PUBLISHED_SEED) => return None,
        Some(seed) => format!("seed {seed}"),
        None => "a seed that is not shown".to_owned(),
    };
    Some(format!("{}; this run: {own}.", published_terms()))
}

/// Describes the terms of the published runs, without a full stop.
pub fn published_terms() -> String {
    let start = dollar_tick(published().start_cash);
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
    fn a_score_stands_among_the_published_ones() {
        let mut seen = test_kit::played(0).company().observe();
        (seen.seed, seen.last_day) = (Some(42), 500);
        assert_eq!(seen.scenario, "default");
        let good = standing(Some(14_208_331.0), &seen);
        assert_eq!((good.rank, good.caveat.clone()), (Some(2), None));
        assert_eq!(good.in_words(), "rank 2 of 18 among the published results");
        let names: Vec<&str> = good.around(1, 1).iter().map(|place| place.name.as_str()).collect();
        assert_eq!(names, ["Rule-based baseline", "You", "Claude Fable 5"]);
        let ruined = standing(Some(0.0), &seen);
        assert_eq!(ruined.rank, Some(14), "four published agents also have no cash");
        assert_eq!(ruined.places.last().map(|place| place.whose), Some(Whose::Own));
        assert_eq!(standing(None, &seen).rank, None);
        seen.seed = Some(7);
        assert_eq!(standing(Some(0.0), &seen).rank, Some(14), "a different seed stays comparable");
        assert!(published_targeted_shares().0 < published_targeted_shares().1);
    }

    #[test]
    fn a_run_of_other_terms_is_not_ranked_and_says_why() {
        let mut seen = test_kit::played(0).company().observe();
        for (days, ranked) in [(500, true), (28, false)] {
            seen.last_day = days;
            let standing = standing(Some(2e6), &seen);
            assert_eq!(standing.rank.is_some(), ranked, "{days}");
            assert_eq!(standing.places.iter().any(|place| place.whose == Whose::Own), ranked);
            assert_eq!(standing.in_words() == "not ranked: 28 days instead of 500", !ranked);
        }
    }

    #[test]
    fn the_better_result_has_more_cash_and_then_the_longer_life() {
        assert_eq!(by_result((5.0, 500), (4.0, 500)), Ordering::Greater);
        assert_eq!(by_result((0.0, 90), (0.0, 131)), Ordering::Less);
        assert_eq!((beaten(0.0), beaten(1.0), beaten(1e9)), ((0, 16), (4, 16), (16, 16)));
    }

    #[test]
    fn changed_parameters_are_no_shipped_scenario() {
        let own = |scenario: &str, overrides: &[(&str, &str)]| {
            let overrides =
                overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
            let new =
                NewRun { scenario: scenario.to_owned(), mode: Mode::Debug, overrides, ..NewRun::default() };
            Session::create(new, &Configuration::shipped())
                .expect("a run")
                .company()
                .observe()
                .has_own_parameters
        };
        for scenario in ["default", "paper", "competitor-off"] {
            assert!(!own(scenario, &[]), "{scenario}");
            assert!(own(scenario, &[("quality.base_product_quality", "1.0")]), "{scenario}");
        }
    }

    #[test]
    fn other_luck_is_named() {
        let mut seen = test_kit::played(0).company().observe();
        let caveat = |seen: &Observation| standing(None, seen).caveat;
        assert_eq!(
            caveat(&seen).as_deref(),
            Some("Published: seed 42, 500 days, $1M at the start; this run: seed 7.")
        );
        seen.seed = Some(42);
        assert_eq!(caveat(&seen), None);
    }
}
