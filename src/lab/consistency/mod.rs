//! Plays two policies and tests, claim by claim, whether both policies receive the same random draws
//! (docs/laboratory/consistency.md).
//!
//! Each claim is tested on two plays with the same seed. A control play with another seed shows that the claim could
//! have failed. If the control play has the same values, equal values are not evidence.

mod random_draws;
mod report;

use super::policy::{Policy, PolicyError};
use super::runner::{RunError, RunSpec};
use novamind_record::folder::configuration::Configuration;
use novamind_world::identifiers::{Channel, Group};
use novamind_world::params::ParameterSource;
use random_draws::{DrawKey, DrawMap, PlayDraws, play_recording_draws};
use rayon::prelude::*;

pub use random_draws::PlayEnd;

/// Difference between the control seed and the tested seed.
const CONTROL_SEED_OFFSET: u64 = 1_000_003;

/// The rule that selects the values of two plays to compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ComparedKeys {
    /// Values that both plays have. The plays can have different numbers of values, for example of attempts.
    Common,
    /// All values up to the end of the play that ended first. A value that only one play has counts as a
    /// difference.
    UntilFirstEnd,
}

/// A claim about common random draws.
struct Claim {
    /// Text of the claim.
    statement: &'static str,
    /// Noun for the compared values, in singular and plural.
    unit_names: (&'static str, &'static str),
    /// Function that returns the compared values of a play.
    draws: fn(&PlayDraws) -> &DrawMap,
    compared_keys: ComparedKeys,
    /// Whether the claim compares two plays with the same decisions.
    same_decisions: bool,
    /// Function that formats the key of a compared value.
    format_key: fn(DrawKey) -> String,
}

const CLAIMS: &[Claim] = &[
    Claim {
        statement: "the n-th attempt of market research has the same result",
        unit_names: ("attempt", "attempts"),
        draws: |luck| &luck.attempts,
        compared_keys: ComparedKeys::Common,
        same_decisions: false,
        format_key: |[attempt, _]| format!("attempt {attempt}"),
    },
    Claim {
        statement: "the n-th customer of a group has the same demand, seats and profile",
        unit_names: ("customer", "customers"),
        draws: |luck| &luck.customers,
        compared_keys: ComparedKeys::Common,
        same_decisions: false,
        format_key: |[group, n]| format!("customer {n} of {}", group_key_name(group)),
    },
    Claim {
        statement: "the index of the economy does not depend on decisions",
        unit_names: ("day", "days"),
        draws: |luck| &luck.economy,
        compared_keys: ComparedKeys::UntilFirstEnd,
        same_decisions: false,
        format_key: day_key_name,
    },
    Claim {
        statement: "competitor events have the same days and sizes before copying",
        unit_names: ("move", "moves"),
        draws: |luck| &luck.competitor_events,
        compared_keys: ComparedKeys::UntilFirstEnd,
        same_decisions: false,
        format_key: day_key_name,
    },
    Claim {
        statement: "demand surges have the same days, lengths and strengths",
        unit_names: ("surge", "surges"),
        draws: |luck| &luck.surges,
        compared_keys: ComparedKeys::UntilFirstEnd,
        same_decisions: false,
        format_key: day_key_name,
    },
    Claim {
        statement: "the yield of each channel for each group changes equally",
        unit_names: ("yield", "yields"),
        draws: |luck| &luck.yields,
        compared_keys: ComparedKeys::UntilFirstEnd,
        same_decisions: false,
        format_key: |[day, pair]| {
            let (group, channel) = (pair / Channel::ALL.len() as u32, pair as usize % Channel::ALL.len());
            format!("{} for {} on day {day}", Channel::ALL[channel].id(), group_key_name(group))
        },
    },
    Claim {
        statement: "in each group and month, the same share of payments fails in all runs",
        unit_names: ("rate", "rates"),
        draws: |luck| &luck.failed_payments,
        compared_keys: ComparedKeys::Common,
        same_decisions: false,
        format_key: |[group, day]| format!("{} after day {day}", group_key_name(group)),
    },
    Claim {
        statement: "the n-th project of an R&D tier has the same duration and gain",
        unit_names: ("project", "projects"),
        draws: |luck| &luck.projects,
        compared_keys: ComparedKeys::Common,
        same_decisions: false,
        format_key: |[tier, number]| format!("project {number} of tier {tier}"),
    },
    Claim {
        statement: "the daily noise of quality is the same",
        unit_names: ("day", "days"),
        draws: |luck| &luck.noise,
        compared_keys: ComparedKeys::Common,
        same_decisions: false,
        format_key: day_key_name,
    },
    Claim {
        statement: "on each day, outages occur at the same outage probability in all runs",
        unit_names: ("day", "days"),
        draws: |luck| &luck.outages,
        compared_keys: ComparedKeys::Common,
        same_decisions: false,
        format_key: day_key_name,
    },
    Claim {
        statement: "the same decisions lead to the same company on one thread and on all threads",
        unit_names: ("state", "states"),
        draws: |luck| &luck.state,
        compared_keys: ComparedKeys::Common,
        same_decisions: true,
        format_key: day_key_name,
    },
];

fn group_key_name(index: u32) -> String {
    Group::at(index as usize).map_or(index.to_string(), |group| group.to_string())
}

fn day_key_name([day, _]: DrawKey) -> String {
    format!("day {day}")
}

/// The outcome of testing a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClaimOutcome {
    /// All compared values are equal, and they differ under another seed.
    Holds,
    /// At least one compared value differs.
    Fails,
    /// The plays have no common values for the claim.
    NotTested,
    /// The values are also equal under another seed, because recorded draws are replayed or nothing is random.
    SameUnderEverySeed,
}

impl ClaimOutcome {
    /// Returns the label that tables show for the outcome.
    pub fn label(self) -> &'static str {
        match self {
            ClaimOutcome::Holds => "holds",
            ClaimOutcome::Fails => "FAILS",
            ClaimOutcome::NotTested => "not tried",
            ClaimOutcome::SameUnderEverySeed => "not random",
        }
    }
}

/// The result of testing a claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClaimResult {
    /// Text of the claim.
    pub claim: &'static str,
    /// Number of compared values over all seeds.
    pub compared: usize,
    /// Noun for the compared values, in singular or plural according to their number.
    pub of: &'static str,
    /// Number of compared values that differ.
    pub different: usize,
    /// Number of values that were compared with values from the play with the control seed.
    pub compared_with_other_seed: usize,
    /// Number of values that differ under the control seed.
    pub different_under_other_seed: usize,
    /// Key and seed of the first difference; `None` if no value differs.
    pub first_difference: Option<String>,
    /// Outcome of the test.
    pub outcome: ClaimOutcome,
}

/// A check of common random draws: two policies and the results of all claims.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsistencyCheck {
    /// Names of the two policies.
    pub policies: [String; 2],
    /// Results of both policies on the first seed.
    pub ends: [PlayEnd; 2],
    /// Whether both policies ended in the same state on every seed. If so, nothing was tested.
    pub ends_in_same_state: bool,
    /// Whether one policy switches demand surges off but was played with demand surges.
    pub equalizes_surges: bool,
    /// Results of all claims.
    pub claims: Vec<ClaimResult>,
}

impl ConsistencyCheck {
    /// Returns the claims that fail.
    pub fn failures(&self) -> impl Iterator<Item = &ClaimResult> {
        self.claims.iter().filter(|claim| claim.outcome == ClaimOutcome::Fails)
    }
}

/// Returns the two default policies, which differ so much that every claim is tested.
///
/// # Errors
/// Fails if a bundled policy is invalid. A test checks that both policies are valid.
pub fn contrasting_policies() -> Result<[Policy; 2], PolicyError> {
    let read = |name: &str, text: &str| {
        Policy::parse(&ParameterSource {
            name: format!("assets/consistency/{name}.toml"),
            text: text.to_owned(),
        })
    };
    Ok([
        read("early", include_str!("../../../assets/consistency/early.toml"))?,
        read("late", include_str!("../../../assets/consistency/late.toml"))?,
    ])
}

/// Options of the consistency check.
#[derive(Debug, Clone)]
pub struct ConsistencySpec {
    /// Seeds on which both policies are played.
    pub seeds: Vec<u64>,
    /// Name of the scenario; `None` for the scenario of the policies.
    pub scenario: Option<String>,
    /// Last simulated day; `None` for the last day of the run. The nominal length of the run does not change.
    pub until: Option<u32>,
}

impl ConsistencySpec {
    /// Returns `Some(true)` if only one policy switches demand surges off. Both policies are then played with surges,
    /// because their worlds would otherwise differ.
    fn forced_surges(policies: &[Policy; 2]) -> Option<bool> {
        let [one, other] = policies;
        (one.start.surges != other.start.surges).then_some(true)
    }

    /// Returns the reason why two policies cannot be compared, or `None` if they can be compared.
    pub fn incomparability_reason(&self, policies: &[Policy; 2]) -> Option<&'static str> {
        let [one, other] = policies.each_ref().map(|policy| &policy.start);
        match self.scenario {
            _ if policies[0] == policies[1] => {
                Some("both policies are the same: choose two that decide differently")
            }
            None if one.scenario != other.scenario => {
                Some("the policies use different scenarios: choose one with --scenario")
            }
            _ if one.days != other.days => Some(
                "the policies play runs of different lengths, and the competitors' calendar depends on the length",
            ),
            _ => None,
        }
    }
}

/// Plays two policies and tests every claim.
///
/// # Errors
/// Fails if a run cannot start or a tool rejects a call that must succeed.
pub fn check_consistency(
    policies: &[Policy; 2],
    spec: &ConsistencySpec,
    configuration: &Configuration,
    on_played: &(dyn Fn() + Sync),
) -> Result<ConsistencyCheck, RunError> {
    let plays: Result<Vec<SeedPlays>, RunError> = spec
        .seeds
        .iter()
        .map(|seed| SeedPlays::play(policies, *seed, spec, configuration, on_played))
        .collect();
    let plays = plays?;
    let ends = plays.first().map(|first| [first.one.end, first.other.end]).unwrap_or_default();
    Ok(ConsistencyCheck {
        policies: policies.clone().map(|policy| policy.name),
        ends_in_same_state: plays.iter().all(|play| play.one.state == play.other.state),
        equalizes_surges: ConsistencySpec::forced_surges(policies).is_some(),
        ends,
        claims: CLAIMS.iter().map(|claim| claim.evaluate(&plays)).collect(),
    })
}

/// Number of plays per seed.
pub const PLAYS_PER_SEED: u64 = 4;

struct SeedPlays {
    seed: u64,
    one: PlayDraws,
    other: PlayDraws,
    /// The first policy, played again on one thread.
    again: PlayDraws,
    /// The first policy, played with the control seed.
    control: PlayDraws,
}

impl SeedPlays {
    fn play(
        policies: &[Policy; 2],
        seed: u64,
        spec: &ConsistencySpec,
        configuration: &Configuration,
        on_played: &(dyn Fn() + Sync),
    ) -> Result<SeedPlays, RunError> {
        let play = |policy: &Policy, seed: u64| {
            let run = RunSpec {
                scenario: spec.scenario.clone(),
                stop_after_day: spec.until,
                surges: ConsistencySpec::forced_surges(policies),
                ..RunSpec::for_seed(seed)
            };
            let luck = play_recording_draws(policy, &run, configuration);
            on_played();
            luck
        };
        let [first, second] = policies;
        let games = [(first, seed), (second, seed), (first, seed.wrapping_add(CONTROL_SEED_OFFSET))];
        let played: Result<Vec<PlayDraws>, RunError> =
            games.par_iter().with_max_len(1).map(|(policy, seed)| play(policy, *seed)).collect();
        // If a single-threaded pool cannot be built, the repetition uses all threads.
        let play_draws = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
            Ok(pool) => pool.install(|| play(first, seed)),
            Err(_) => play(first, seed),
        }?;
        let [one, other, control] = <[PlayDraws; 3]>::try_from(played?).unwrap_or_default();
        Ok(SeedPlays { seed, one, other, again: play_draws, control })
    }
}

/// Numbers of compared values and of different values in two plays.
#[derive(Debug, Default)]
struct Differences {
    compared: usize,
    different: usize,
    first: Option<DrawKey>,
}

impl Differences {
    fn compare(one: &PlayDraws, other: &PlayDraws, claim: &Claim) -> Differences {
        let (draws, others) = ((claim.draws)(one), (claim.draws)(other));
        let last = one.end.day.min(other.end.day);
        let mut found = Differences::default();
        let mut note = |key: &DrawKey, differs: bool| {
            found.compared += 1;
            found.different += usize::from(differs);
            if differs && found.first.is_none_or(|first| *key < first) {
                found.first = Some(*key);
            }
        };
        let is_dated = claim.compared_keys == ComparedKeys::UntilFirstEnd;
        for (key, value) in draws {
            match others.get(key) {
                Some(other) => note(key, value != other),
                None if is_dated && key[0] <= last => note(key, true),
                None => {}
            }
        }
        if is_dated {
            others
                .keys()
                .filter(|key| key[0] <= last && !draws.contains_key(*key))
                .for_each(|key| note(key, true));
        }
        found
    }
}

impl Claim {
    fn evaluate(&self, plays: &[SeedPlays]) -> ClaimResult {
        let (mut compared, mut different, mut first_difference) = (0, 0, None);
        let (mut controls, mut different_controls) = (0, 0);
        for seed_plays in plays {
            let other = if self.same_decisions { &seed_plays.again } else { &seed_plays.other };
            let found = Differences::compare(&seed_plays.one, other, self);
            compared += found.compared;
            different += found.different;
            if let (None, Some(key)) = (&first_difference, found.first) {
                first_difference = Some(format!("{}, seed {}", (self.format_key)(key), seed_plays.seed));
            }
            let control = Differences::compare(&seed_plays.one, &seed_plays.control, self);
            controls += control.compared;
            different_controls += control.different;
        }
        let verdict = match (compared, different, different_controls) {
            (0, ..) => ClaimOutcome::NotTested,
            (_, 0, 0) => ClaimOutcome::SameUnderEverySeed,
            (_, 0, _) => ClaimOutcome::Holds,
            _ => ClaimOutcome::Fails,
        };
        ClaimResult {
            claim: self.statement,
            compared,
            of: if compared == 1 { self.unit_names.0 } else { self.unit_names.1 },
            different,
            compared_with_other_seed: controls,
            different_under_other_seed: different_controls,
            first_difference,
            outcome: verdict,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn test_spec(until: u32) -> ConsistencySpec {
        ConsistencySpec { seeds: vec![42], scenario: None, until: Some(until) }
    }

    fn run_check(spec: &ConsistencySpec) -> ConsistencyCheck {
        let policies = contrasting_policies().expect("the bundled policies");
        check_consistency(&policies, spec, &Configuration::bundled(), &|| ()).expect("it plays")
    }

    #[test]
    fn every_claim_is_tested_and_holds() {
        let found = run_check(&test_spec(280));
        for claim in &found.claims {
            assert_eq!(claim.outcome, ClaimOutcome::Holds, "{claim:?}");
        }
        let attempts = found.claims.iter().find(|claim| claim.of == "attempts").map(|claim| claim.compared);
        assert_eq!(attempts, Some(27), "the late policy makes three attempts in each of nine weeks");
        let [early, late] = found.ends;
        assert!(early.cash != late.cash && early.customers != late.customers, "{early:?} {late:?}");
        assert!(early.found > 0 && late.found > 0, "{early:?} {late:?}");
    }

    #[test]
    fn replayed_series_are_not_random() {
        let replayed = ConsistencySpec { scenario: Some("reference-seed42".to_owned()), ..test_spec(119) };
        let found = run_check(&replayed);
        let verdict = |part: &str| {
            found.claims.iter().find(|claim| claim.claim.contains(part)).map(|claim| claim.outcome)
        };
        assert_eq!(verdict("economy"), Some(ClaimOutcome::SameUnderEverySeed));
        assert_eq!(verdict("n-th customer"), Some(ClaimOutcome::Holds));
    }

    #[test]
    fn differences_are_found_and_named() {
        let luck = |economy: &[(u32, u64)]| PlayDraws {
            economy: economy.iter().map(|(day, value)| ([*day, 0], [*value, 0, 0, 0])).collect(),
            end: PlayEnd { day: 9, ..PlayEnd::default() },
            ..PlayDraws::default()
        };
        let plays = |other: &[(u32, u64)]| {
            let [one, other] = [luck(&[(1, 5), (2, 6), (12, 7)]), luck(other)];
            [SeedPlays { seed: 3, again: one.clone(), control: luck(&[(1, 9)]), one, other }]
        };
        let claim = CLAIMS.iter().find(|claim| claim.statement.contains("economy")).expect("a claim");
        let tried = |other: &[(u32, u64)]| claim.evaluate(&plays(other));
        assert_eq!(tried(&[(1, 5), (2, 6)]).outcome, ClaimOutcome::Holds, "day 12 came after the end");
        for (other, day) in
            [(&[(1, 5), (2, 8)][..], "day 2"), (&[(1, 5)], "day 2"), (&[(1, 5), (2, 6), (4, 1)], "day 4")]
        {
            let found = tried(other);
            assert_eq!((found.outcome, found.different), (ClaimOutcome::Fails, 1));
            assert_eq!(found.first_difference, Some(format!("{day}, seed 3")));
        }
    }
}
