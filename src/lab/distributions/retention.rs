//! Random draws of retention: support, failed payments, reputation loss and negotiations.

use super::distribution::{DrawDistribution, RoundingMode};
use super::world_draw::{DrawFamily, WorldDraw, group_at};
use novamind_world::customers::columns::CUSTOMERS_PER_BLOCK;
use novamind_world::enterprise::messages::reply_delay;
use novamind_world::params::Params;
use novamind_world::random::{Part, bernoulli_from_word};
use novamind_world::reputation::cancel_damage;
use novamind_world::retention::issues::issue_probability;
use novamind_world::retention::renewal::{involuntary_rate, payment_failure_words};

const RENEWAL_FILE: &str = "retention/renewal.rs";
const SUPPORT_FILE: &str = "retention/support_pools.rs";

/// Mean number of issues that the support pool of the example resolves per day.
const EXAMPLE_SOLVED_ISSUES: f64 = 3.0;
const EXAMPLE_OPEN_ISSUES: usize = 8;
/// Satisfaction of the example customer who opens an issue.
const EXAMPLE_SATISFACTION: f64 = 0.5;

fn example_issue_probability(params: &Params) -> f64 {
    issue_probability(EXAMPLE_SATISFACTION, false, 1.0, &params.issues)
}

/// Random draws of retention.
pub const RETENTION_DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "issues_solved",
        description: "issues that a support pool can resolve on a day; the example's mean is 3",
        part: Part::IssueResolution,
        family: DrawFamily::Single,
        parameters: &["issues.issue_resolution_base_rate"],
        source_files: &[(SUPPORT_FILE, 1)],
        distribution: |_, _| DrawDistribution::Poisson(EXAMPLE_SOLVED_ISSUES),
        draw: |context, member, n| {
            context
                .streams
                .open(Part::IssueResolution, [n, 0, 0, member as u64])
                .poisson(EXAMPLE_SOLVED_ISSUES) as f64
        },
    },
    WorldDraw {
        name: "issue_picked",
        description: "open issue that is resolved next, by index; the example's backlog is 8",
        part: Part::IssueResolution,
        family: DrawFamily::Single,
        parameters: &[],
        source_files: &[(SUPPORT_FILE, 1)],
        distribution: |_, _| DrawDistribution::UniformInteger {
            low: 0,
            high: EXAMPLE_OPEN_ISSUES as u32 - 1,
        },
        draw: |context, member, n| {
            context.streams.open(Part::IssueResolution, [n, 1, 0, member as u64]).index(EXAMPLE_OPEN_ISSUES)
                as f64
        },
    },
    WorldDraw {
        name: "issue_opened",
        description: "a new issue on a day; the example has satisfaction 0.5 and no outage",
        part: Part::IssueOpening,
        family: DrawFamily::Single,
        parameters: &[
            "issues.base_issue_rate",
            "issues.issue_quality_factor",
            "issues.issue_satisfaction_reference",
            "issues.issue_probability_min",
            "issues.issue_probability_max",
        ],
        source_files: &[("retention/issues.rs", 2)],
        distribution: |params, _| DrawDistribution::Bernoulli(example_issue_probability(params)),
        draw: |context, member, n| {
            let mut word = [0];
            context.streams.open(Part::IssueOpening, [n, member as u64, 0]).fill(&mut word);
            f64::from(u8::from(bernoulli_from_word(word[0], example_issue_probability(&context.params))))
        },
    },
    WorldDraw {
        name: "involuntary_rate",
        description: "share of a group's payments that fail permanently in a month",
        part: Part::InvoluntaryMu,
        family: DrawFamily::Individuals,
        parameters: &[
            "group.involuntary_churn_mean",
            "group.involuntary_churn_std",
            "involuntary_churn.mu_min",
            "involuntary_churn.mu_max",
        ],
        source_files: &[(RENEWAL_FILE, 1)],
        distribution: |params, member| {
            let (group_params, law) = (params.group(group_at(member)), &params.involuntary_churn);
            DrawDistribution::Normal {
                mean: group_params.involuntary_churn_mean,
                std: group_params.involuntary_churn_std,
                min: law.mu_min,
                max: law.mu_max,
            }
        },
        draw: |context, member, n| {
            let z = context.streams.open(Part::InvoluntaryMu, [member as u64, n]).standard_normal();
            let group_params = context.params.group(group_at(member));
            let (mean, std) = (group_params.involuntary_churn_mean, group_params.involuntary_churn_std);
            involuntary_rate(mean, std, z, &context.params.involuntary_churn)
        },
    },
    WorldDraw {
        name: "payment_fails",
        description: "a payment that fails permanently, at the group's mean rate",
        part: Part::InvoluntaryRoll,
        family: DrawFamily::Individuals,
        parameters: &["group.involuntary_churn_mean"],
        source_files: &[(RENEWAL_FILE, 2)],
        distribution: |params, member| {
            DrawDistribution::Bernoulli(params.group(group_at(member)).involuntary_churn_mean)
        },
        draw: |context, member, n| {
            // Draws for the customer at the same position of the block, on consecutive days.
            let group = group_at(member);
            let (number, day) = ((n % 97) as u32, (n / 97) as u32);
            let word = payment_failure_words(group, number, day, &context.streams)
                [n as usize % CUSTOMERS_PER_BLOCK as usize];
            f64::from(u8::from(bernoulli_from_word(word, context.params.group(group).involuntary_churn_mean)))
        },
    },
    WorldDraw {
        name: "reputation_damage",
        description: "reputation loss when a satisfied customer leaves a group of two",
        part: Part::ReputationEvent,
        family: DrawFamily::Single,
        parameters: &["reputation.reputation_quality_cancel_damage", "reputation.cancel_damage_noise_offset"],
        source_files: &[(RENEWAL_FILE, 1), ("enterprise/churn.rs", 1)],
        distribution: |params, _| DrawDistribution::Uniform {
            low: cancel_damage(0.0, 2, 0.0, &params.reputation),
            high: cancel_damage(0.0, 2, 1.0, &params.reputation),
        },
        draw: |context, member, n| {
            let u = context.streams.open(Part::ReputationEvent, [n, member as u64, 1, 0]).uniform();
            cancel_damage(0.0, 2, u, &context.params.reputation)
        },
    },
    WorldDraw {
        name: "negotiation_noise",
        description: "factor by which an enterprise misjudges quality in its first negotiation",
        part: Part::NegotiationNoise,
        family: DrawFamily::Single,
        parameters: &["quality.initial_decision_noise_min", "quality.initial_decision_noise_max"],
        source_files: &[("enterprise/enterprise_customer.rs", 1)],
        distribution: |params, _| DrawDistribution::Uniform {
            low: params.quality.initial_decision_noise_min,
            high: params.quality.initial_decision_noise_max,
        },
        draw: |context, member, n| {
            let quality = &context.params.quality;
            context
                .streams
                .open_for_day(0, Part::NegotiationNoise, [member as u64, n])
                .between(quality.initial_decision_noise_min, quality.initial_decision_noise_max)
        },
    },
    WorldDraw {
        name: "reply_delay",
        description: "days until an enterprise with its group's mean response time answers an offer",
        part: Part::ReplyDelay,
        family: DrawFamily::Enterprises,
        parameters: &["group.reply_delay_mean", "group.reply_delay_std", "enterprise.reply_delay_min_days"],
        source_files: &[("enterprise/messages.rs", 1)],
        distribution: |params, member| {
            let group_params = params.group(group_at(member));
            DrawDistribution::RoundedNormal {
                mean: group_params.reply_delay_mean.unwrap_or(0.0),
                std: group_params.reply_delay_std.unwrap_or(0.0),
                rounding: RoundingMode::Nearest,
                min: f64::from(params.enterprise.reply_delay_min_days),
            }
        },
        draw: |context, member, n| {
            let z = context.streams.open(Part::ReplyDelay, [n, 1]).standard_normal();
            let group_params = context.params.group(group_at(member));
            let (mean, std) =
                (group_params.reply_delay_mean.unwrap_or(0.0), group_params.reply_delay_std.unwrap_or(0.0));
            f64::from(reply_delay(mean, std, z, &context.params.enterprise))
        },
    },
    WorldDraw {
        name: "plan_change",
        description: "an enterprise asks for a better plan on a day on which a better plan exists",
        part: Part::PlanChange,
        family: DrawFamily::Single,
        parameters: &["enterprise.plan_change_probability"],
        source_files: &[("enterprise/triggers.rs", 1)],
        distribution: |params, _| DrawDistribution::Bernoulli(params.enterprise.plan_change_probability),
        draw: |context, member, n| {
            let mut stream = context.streams.open(Part::PlanChange, [n, member as u64, 1]);
            f64::from(u8::from(stream.bernoulli(context.params.enterprise.plan_change_probability)))
        },
    },
];
