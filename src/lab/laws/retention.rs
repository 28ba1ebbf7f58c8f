//! Random draws of retention: support, failed payments, reputation damage, negotiations.

use super::law::{Law, Rounding};
use super::world_draw::{Family, WorldDraw, group_at};
use novamind_world::customers::columns::BLOCK;
use novamind_world::enterprise::letters::reply_delay;
use novamind_world::params::Params;
use novamind_world::random::{Part, word_below};
use novamind_world::reputation::cancel_damage;
use novamind_world::retention::issues::issue_probability;
use novamind_world::retention::renewal::{involuntary_rate, payment_rolls};

const RENEWAL: &str = "retention/renewal.rs";
const SUPPORT: &str = "retention/support_budget.rs";

/// Mean issues that the example pool resolves a day, and its backlog.
const SOLVED: f64 = 3.0;
const WAITING: usize = 8;
/// Satisfaction of the example customer who opens an issue.
const CONTENT: f64 = 0.5;

fn issue_chance(params: &Params) -> f64 {
    issue_probability(CONTENT, false, 1.0, &params.issues)
}

/// Returns the draws.
pub const DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "issues_solved",
        what: "issues that a support pool can resolve on a day; the example's mean is 3",
        part: Part::IssueResolution,
        family: Family::One,
        keys: &["issues.issue_resolution_base_rate"],
        sites: &[(SUPPORT, 1)],
        law: |_, _| Law::Poisson(SOLVED),
        draw: |luck, member, n| {
            luck.streams.open(Part::IssueResolution, [n, 0, 0, member as u64]).poisson(SOLVED) as f64
        },
    },
    WorldDraw {
        name: "issue_picked",
        what: "open issue that is resolved next, by index; the example's backlog is 8",
        part: Part::IssueResolution,
        family: Family::One,
        keys: &[],
        sites: &[(SUPPORT, 1)],
        law: |_, _| Law::Whole { low: 0, high: WAITING as u32 - 1 },
        draw: |luck, member, n| {
            luck.streams.open(Part::IssueResolution, [n, 1, 0, member as u64]).index(WAITING) as f64
        },
    },
    WorldDraw {
        name: "issue_opened",
        what: "a new issue on a day; the example has satisfaction 0.5 and no outage",
        part: Part::IssueOpening,
        family: Family::One,
        keys: &[
            "issues.base_issue_rate",
            "issues.issue_quality_factor",
            "issues.issue_satisfaction_reference",
            "issues.issue_probability_min",
            "issues.issue_probability_max",
        ],
        sites: &[("retention/issues.rs", 2)],
        law: |params, _| Law::Chance(issue_chance(params)),
        draw: |luck, member, n| {
            let mut word = [0];
            luck.streams.open(Part::IssueOpening, [n, member as u64, 0]).fill(&mut word);
            f64::from(u8::from(word_below(word[0], issue_chance(&luck.params))))
        },
    },
    WorldDraw {
        name: "involuntary_rate",
        what: "share of a group's payments that fail permanently in a month",
        part: Part::InvoluntaryMu,
        family: Family::Individuals,
        keys: &[
            "group.involuntary_churn_mean",
            "group.involuntary_churn_std",
            "involuntary_churn.mu_min",
            "involuntary_churn.mu_max",
        ],
        sites: &[(RENEWAL, 1)],
        law: |params, member| {
            let (own, law) = (params.group(group_at(member)), &params.involuntary_churn);
            Law::Normal {
                mean: own.involuntary_churn_mean,
                std: own.involuntary_churn_std,
                least: law.mu_min,
                most: law.mu_max,
            }
        },
        draw: |luck, member, n| {
            let z = luck.streams.open(Part::InvoluntaryMu, [member as u64, n]).standard_normal();
            let own = luck.params.group(group_at(member));
            let (mean, std) = (own.involuntary_churn_mean, own.involuntary_churn_std);
            involuntary_rate(mean, std, z, &luck.params.involuntary_churn)
        },
    },
    WorldDraw {
        name: "payment_fails",
        what: "a payment that fails permanently, at the group's mean rate",
        part: Part::InvoluntaryRoll,
        family: Family::Individuals,
        keys: &["group.involuntary_churn_mean"],
        sites: &[(RENEWAL, 2)],
        law: |params, member| Law::Chance(params.group(group_at(member)).involuntary_churn_mean),
        draw: |luck, member, n| {
            // Customers at one position of their blocks, day after day.
            let group = group_at(member);
            let (number, day) = ((n % 97) as u32, (n / 97) as u32);
            let word = payment_rolls(group, number, day, &luck.streams)[n as usize % BLOCK as usize];
            f64::from(u8::from(word_below(word, luck.params.group(group).involuntary_churn_mean)))
        },
    },
    WorldDraw {
        name: "reputation_damage",
        what: "reputation loss when a satisfied customer leaves a group of two",
        part: Part::ReputationEvent,
        family: Family::One,
        keys: &["reputation.reputation_quality_cancel_damage", "reputation.cancel_damage_noise_offset"],
        sites: &[(RENEWAL, 1), ("enterprise/churn.rs", 1)],
        law: |params, _| Law::Uniform {
            low: cancel_damage(0.0, 2, 0.0, &params.reputation),
            high: cancel_damage(0.0, 2, 1.0, &params.reputation),
        },
        draw: |luck, member, n| {
            let u = luck.streams.open(Part::ReputationEvent, [n, member as u64, 1, 0]).uniform();
            cancel_damage(0.0, 2, u, &luck.params.reputation)
        },
    },
    WorldDraw {
        name: "negotiation_noise",
        what: "factor by which an enterprise misjudges quality in its first negotiation",
        part: Part::NegotiationNoise,
        family: Family::One,
        keys: &["quality.initial_decision_noise_min", "quality.initial_decision_noise_max"],
        sites: &[("enterprise/company.rs", 1)],
        law: |params, _| Law::Uniform {
            low: params.quality.initial_decision_noise_min,
            high: params.quality.initial_decision_noise_max,
        },
        draw: |luck, member, n| {
            let quality = &luck.params.quality;
            luck.streams
                .open_since(0, Part::NegotiationNoise, [member as u64, n])
                .between(quality.initial_decision_noise_min, quality.initial_decision_noise_max)
        },
    },
    WorldDraw {
        name: "reply_delay",
        what: "days until an enterprise with its group's mean response time answers an offer",
        part: Part::ReplyDelay,
        family: Family::Companies,
        keys: &["group.reply_delay_mean", "group.reply_delay_std", "enterprise.reply_delay_min_days"],
        sites: &[("enterprise/letters.rs", 1)],
        law: |params, member| {
            let own = params.group(group_at(member));
            Law::WholeNormal {
                mean: own.reply_delay_mean.unwrap_or(0.0),
                std: own.reply_delay_std.unwrap_or(0.0),
                rounding: Rounding::Nearest,
                least: f64::from(params.enterprise.reply_delay_min_days),
            }
        },
        draw: |luck, member, n| {
            let z = luck.streams.open(Part::ReplyDelay, [n, 1]).standard_normal();
            let own = luck.params.group(group_at(member));
            let (mean, std) = (own.reply_delay_mean.unwrap_or(0.0), own.reply_delay_std.unwrap_or(0.0));
            f64::from(reply_delay(mean, std, z, &luck.params.enterprise))
        },
    },
    WorldDraw {
        name: "plan_change",
        what: "an enterprise asks for a better plan on a day on which there is one",
        part: Part::PlanChange,
        family: Family::One,
        keys: &["enterprise.plan_change_probability"],
        sites: &[("enterprise/triggers.rs", 1)],
        law: |params, _| Law::Chance(params.enterprise.plan_change_probability),
        draw: |luck, member, n| {
            let mut stream = luck.streams.open(Part::PlanChange, [n, member as u64, 1]);
            f64::from(u8::from(stream.bernoulli(luck.params.enterprise.plan_change_probability)))
        },
    },
];
