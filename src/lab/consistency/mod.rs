//! Tests by playing whether two policies get the same random draws, claim by claim (docs/laboratory/consistency.md).
//!
//! Each claim is tested on two plays with the same seed. A play with another seed shows that the claim could have
//! failed: if it gives the same values too, equality is not evidence.

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

/// Offset of the control seed from the tested seed.
const CONTROL_SEED_OFFSET: u64 = 1_000_003;

/// The values of two plays that are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ComparedKeys {
    /// Values that both plays have; a play with fewer attempts has fewer.
    Common,
    /// All values until the earlier end of the two plays; a value that only one has is a difference.
    UntilFirstEnd,
}

/// A claim on common random draws.
struct Claim {
    /// Text of the claim.
    statement: &'static str,
    /// Noun for the compared values, singular and plural.
    unit_names: (&'static str, &'static str),
    /// Returns the values of a play.
    draws: fn(&PlayDraws) -> &DrawMap,
    compared_keys: ComparedKeys,
    /// Whether it compares two plays of the same decisions.
    same_decisions: bool,
    /// Describes a key.
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
        statement: "the index of the economy does not depend on play",
        unit_names: ("day", "days"),
        draws: |luck| &luck.economy,
        compared_keys: ComparedKeys::UntilFirstEnd,
        same_decisions: false,
        format_key: day_key_name,
    },
    Claim {
        statement: "competitor events have the same days and sizes before copying",
        unit_names: ("move", "moves"),
        draws: |luck| &luck.rivals,
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
        statement: "the same share of payments fails in each group and month",
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
        statement: "outages occur on a day at the same outage probability",
        unit_names: ("day", "days"),
        draws: |luck| &luck.outages,
        compared_keys: ComparedKeys::Common,
        same_decisions: false,
        format_key: day_key_name,
    },
    Claim {
        statement: "the same decisions give the same company on one thread and on all",
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

/// The result of a claim.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ClaimOutcome {
    /// All compared values are equal, and differ under another seed.
    Holds,
    /// At least one value differs.
    Fails,
    /// The plays have no common values for it.
    NotTested,
    /// Values are equal under another seed too: recorded draws are replayed, or nothing is random.
    SameUnderEverySeed,
}

impl ClaimOutcome {
    /// Returns the verdict as text.
    pub fn label(self) -> &'static str {
        match self {
            ClaimOutcome::Holds => "holds",
            ClaimOutcome::Fails => "FAILS",
            ClaimOutcome::NotTested => "not tried",
            ClaimOutcome::SameUnderEverySeed => "not random",
        }
    }
}

/// A tested claim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ClaimResult {
    /// Text of the claim.
    pub claim: &'static str,
    /// Number of compared values over all seeds.
    pub compared: usize,
    /// Noun for the values.
    pub of: &'static str,
    /// Number of different values.
    pub different: usize,
    /// Number of values compared with those of another seed.
    pub compared_with_other_seed: usize,
    /// Number of those that differ.
    pub different_under_other_seed: usize,
    /// Description of the first difference.
    pub first_difference: Option<String>,
    /// Verdict.
    pub outcome: ClaimOutcome,
}

/// Two plays and the results of all claims.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsistencyCheck {
    /// Names of the two policies.
    pub policies: [String; 2],
    /// Results of both policies on the first seed.
    pub ends: [PlayEnd; 2],
    /// Whether both plays ended in the same state, so that nothing was tested.
    pub plays_alike: bool,
    /// Whether one policy switches demand surges off and was played with them anyway.
    pub equalises_surges: bool,
    /// Tested claims.
    pub claims: Vec<ClaimResult>,
}

impl ConsistencyCheck {
    /// Returns the claims that fail.
    pub fn failures(&self) -> impl Iterator<Item = &ClaimResult> {
        self.claims.iter().filter(|claim| claim.outcome == ClaimOutcome::Fails)
    }
}

/// Returns the two default policies. They differ so much that every claim is tested.
///
/// # Errors
/// Fails if they are invalid; a test reads them.
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

/// Options of the test.
#[derive(Debug, Clone)]
pub struct ConsistencySpec {
    /// Seeds.
    pub seeds: Vec<u64>,
    /// Scenario; `None`: that of the policies.
    pub scenario: Option<String>,
    /// Last day that is played; the last day of the run does not change.
    pub until: Option<u32>,
}

impl ConsistencySpec {
    /// Returns `Some(true)` if only one policy switches demand surges off; otherwise the two would play different worlds.
    fn surges(policies: &[Policy; 2]) -> Option<bool> {
        let [one, other] = policies;
        (one.start.surges != other.start.surges).then_some(true)
    }

    /// Returns the reason why two policies cannot play the same world, if there is one.
    pub fn precondition_problem(&self, policies: &[Policy; 2]) -> Option<&'static str> {
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
        plays_alike: plays.iter().all(|play| play.one.state == play.other.state),
        equalises_surges: ConsistencySpec::surges(policies).is_some(),
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
    /// First policy repeated on one thread.
    again: PlayDraws,
    /// First policy with another seed.
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
                surges: ConsistencySpec::surges(policies),
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

/// Counts the compared values of two plays and the differences.
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

    fn spec(until: u32) -> ConsistencySpec {
        ConsistencySpec { seeds: vec![42], scenario: None, until: Some(until) }
    }

    fn check(spec: &ConsistencySpec) -> ConsistencyCheck {
        let policies = contrasting_policies().expect("the bundled policies");
        check_consistency(&policies, spec, &Configuration::bundled(), &|| ()).expect("it plays")
    }

    #[test]
    fn every_claim_is_tested_and_holds() {
        let found = check(&spec(280));
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
        let replayed = ConsistencySpec { scenario: Some("reference-seed42".to_owned()), ..spec(119) };
        let found = check(&replayed);
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
