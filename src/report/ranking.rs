//! A result beside those that were published.

use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::words::{dollar_tick, whole};
use crate::session::Observation;

/// Published results (read once).
#[derive(Debug, Deserialize)]
pub struct Published {
    /// Where they come from.
    pub source: String,
    start_cash: f64,
    /// Cash of the rule-based policy, dollars.
    pub rule_based_baseline: f64,
    /// What a perfect player might reach, dollars.
    pub estimated_upper_bound: f64,
    /// Share of ad spend that falls on the best channel by chance.
    pub best_channel_random_share: f64,
    /// Results of agents.
    pub agent: Vec<Agent>,
}

/// Results of one agent.
#[derive(Debug, Deserialize, Serialize)]
pub struct Agent {
    /// Model.
    pub name: String,
    /// Runs that ended with cash below zero.
    pub bankruptcies: u32,
    /// Runs.
    pub runs: u32,
    /// Cash of the best run, dollars.
    pub best_cash: f64,
    /// Longest life of a run, days.
    pub max_survival_days: f64,
    /// Mean life of a run, days.
    pub mean_survival_days: f64,
    /// Turns of the agent in a week.
    pub turns_per_week: f64,
    /// Targeted share of development spend, where it was published.
    #[serde(default)]
    pub targeted_development_share: Option<f64>,
}

/// The run that the published results were made with: seed and days.
const PUBLISHED_RUN: (u64, u32) = (42, 500);

/// The published results.
pub fn published() -> &'static Published {
    static READ: OnceLock<Published> = OnceLock::new();
    READ.get_or_init(|| {
        toml::from_str(include_str!("../../assets/paper-results.toml"))
            .expect("a test reads the shipped results")
    })
}

/// Whose result it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Whose {
    /// A published agent's best of three runs.
    Agent,
    /// The published rule-based company.
    Baseline,
    /// This run's.
    Own,
}

/// A result.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedRun {
    /// Name.
    pub name: String,
    /// Cash at the end, dollars.
    pub cash: f64,
    /// Whose.
    pub whose: Whose,
}

/// All results, the best first.
#[derive(Debug, Clone, PartialEq)]
pub struct Standing {
    /// Results; this run's is among them once it has a score that can be compared.
    pub places: Vec<RankedRun>,
    /// Place of this run, from 1.
    pub rank: Option<usize>,
    /// The run has a score, whether it can be compared or not.
    pub has_score: bool,
    /// What differs between this run and the published ones.
    pub caveat: Option<String>,
    /// Where the published results come from.
    pub source: String,
}

impl Standing {
    /// The best places and those around this run's: enough to see where it stands.
    pub fn around(&self, best: usize, beside: usize) -> Vec<&RankedRun> {
        let own = self.places.iter().position(|place| place.whose == Whose::Own);
        let wanted = |at: usize| at < best || own.is_some_and(|own| own.abs_diff(at) <= beside);
        self.places.iter().enumerate().filter(|(at, _)| wanted(*at)).map(|(_, place)| place).collect()
    }

    /// The rank in words.
    pub fn in_words(&self) -> String {
        match self.rank {
            Some(rank) => format!("rank {rank} of {} beside the published results", self.places.len()),
            None if self.has_score => "not ranked: other length, start, scenario or parameters".to_owned(),
            None => "the published results".to_owned(),
        }
    }
}

/// Where a score stands; of equal results the published ones come first.
pub fn standing(score: Option<f64>, seen: &Observation, start_cash: f64) -> Standing {
    let place = |name: &str, cash: f64, whose: Whose| RankedRun { name: name.to_owned(), cash, whose };
    let mut places: Vec<RankedRun> =
        published().agent.iter().map(|agent| place(&agent.name, agent.best_cash, Whose::Agent)).collect();
    places.push(place("Rule-based baseline", published().rule_based_baseline, Whose::Baseline));
    let is_comparable = is_comparable((seen.last_day, start_cash), &seen.scenario, seen.has_own_parameters);
    let ranked = score.filter(|_| is_comparable);
    places.extend(ranked.map(|score| place("You", score, Whose::Own)));
    places.sort_by(|left, right| right.cash.total_cmp(&left.cash));
    let rank = ranked.map(|score| 1 + places.iter().filter(|place| place.cash > score).count());
    let has_score = score.is_some();
    Standing { places, rank, has_score, caveat: caveat(seen, start_cash), source: published().source.clone() }
}

/// Scenarios with the rules by which the published results were made.
const COMPARABLE: [&str; 2] = ["default", "paper"];

/// Whether a run is as long, begins as rich and plays by the same rules as the published ones: then it can be ranked
/// among them, of another seed too.
pub fn is_comparable((days, start_cash): (u32, f64), scenario: &str, has_own_parameters: bool) -> bool {
    let terms = days == PUBLISHED_RUN.1 && start_cash == published().start_cash;
    terms && COMPARABLE.contains(&scenario) && !has_own_parameters
}

/// Range of the published targeted shares of development spend: the lowest, the highest.
pub fn published_targeted_shares() -> (f64, f64) {
    let shares = published().agent.iter().filter_map(|agent| agent.targeted_development_share);
    shares.fold((1.0, 0.0), |(least, most), share| (f64::min(least, share), f64::max(most, share)))
}

fn caveat(seen: &Observation, start_cash: f64) -> Option<String> {
    let (seed, days) = PUBLISHED_RUN;
    let mut other = Vec::new();
    if seen.seed != Some(seed) {
        other.push(seen.seed.map_or("a seed that is not shown".to_owned(), |own| format!("seed {own}")));
    }
    if seen.last_day != days {
        other.push(format!("{} days", whole(f64::from(seen.last_day))));
    }
    if start_cash != published().start_cash {
        other.push(format!("{} at the start", dollar_tick(start_cash)));
    }
    if !COMPARABLE.contains(&seen.scenario.as_str()) {
        other.push(format!("scenario {}", seen.scenario));
    }
    if seen.has_own_parameters {
        other.push("changed parameters".to_owned());
    }
    let start = dollar_tick(published().start_cash);
    (!other.is_empty()).then(|| {
        format!("Published: seed {seed}, {days} days, {start} at the start; this run: {}.", other.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::test_kit;
    use crate::session::{Configuration, Mode, NewRun, Session};

    #[test]
    fn a_score_stands_among_the_published_ones() {
        let mut seen = test_kit::played(0).observe();
        (seen.seed, seen.last_day) = (Some(42), 500);
        assert_eq!(seen.scenario, "default");
        let good = standing(Some(14_208_331.0), &seen, 1_000_000.0);
        assert_eq!((good.rank, good.caveat.clone()), (Some(2), None));
        assert_eq!(good.in_words(), "rank 2 of 18 beside the published results");
        let names: Vec<&str> = good.around(1, 1).iter().map(|place| place.name.as_str()).collect();
        assert_eq!(names, ["Rule-based baseline", "You", "Claude Fable 5"]);
        let ruined = standing(Some(0.0), &seen, 1_000_000.0);
        assert_eq!(ruined.rank, Some(14), "four published agents have nothing either");
        assert_eq!(ruined.places.last().map(|place| place.whose), Some(Whose::Own));
        assert_eq!(standing(None, &seen, 1_000_000.0).rank, None);
        seen.seed = Some(7);
        assert_eq!(standing(Some(0.0), &seen, 1_000_000.0).rank, Some(14), "other luck is no other game");
        assert!(published_targeted_shares().0 < published_targeted_shares().1);
    }

    #[test]
    fn a_run_of_other_terms_is_not_ranked() {
        let mut seen = test_kit::played(0).observe();
        seen.last_day = 500;
        for (days, cash, scenario, changed, ranked) in [
            (500, 1_000_000.0, "paper", false, true),
            (28, 1_000_000.0, "default", false, false),
            (500, 2_000_000.0, "default", false, false),
            (500, 1_000_000.0, "competitor-off", false, false),
            (500, 1_000_000.0, "default", true, false),
        ] {
            (seen.last_day, seen.scenario) = (days, scenario.to_owned());
            seen.has_own_parameters = changed;
            let standing = standing(Some(2e6), &seen, cash);
            assert_eq!(standing.rank.is_some(), ranked, "{days} {cash} {scenario}");
            assert_eq!(standing.places.iter().any(|place| place.whose == Whose::Own), ranked);
            assert_eq!(standing.in_words().starts_with("not ranked"), !ranked);
        }
    }

    #[test]
    fn changed_parameters_are_no_shipped_scenario() {
        let own = |scenario: &str, overrides: &[(&str, &str)]| {
            let overrides =
                overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
            let new =
                NewRun { scenario: scenario.to_owned(), mode: Mode::Debug, overrides, ..NewRun::default() };
            Session::create(new, &Configuration::shipped()).expect("a run").observe().has_own_parameters
        };
        for scenario in ["default", "paper", "competitor-off"] {
            assert!(!own(scenario, &[]), "{scenario}");
            assert!(own(scenario, &[("quality.base_product_quality", "1.0")]), "{scenario}");
        }
    }

    #[test]
    fn other_terms_are_named() {
        let seen = test_kit::played(0).observe();
        let caveat = standing(None, &seen, 2e6).caveat.expect("another seed");
        assert_eq!(
            caveat,
            "Published: seed 42, 500 days, $1M at the start; this run: seed 7, 200 days, $2M at the start."
        );
    }
}
