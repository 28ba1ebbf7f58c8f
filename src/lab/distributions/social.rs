//! Random draws of the social feed: authors, tone, reach and press coverage.

use super::distribution::DrawDistribution;
use super::world_draw::{DrawContext, DrawFamily, WorldDraw};
use novamind_world::events::Sentiment;
use novamind_world::identifiers::Group;
use novamind_world::market::social::engagement::engagement_ranges;
use novamind_world::market::social::press::estimated_boost;
use novamind_world::market::social::sentiment::{sentiment, sentiment_chances};
use novamind_world::random::Part;

const CROWD_FILE: &str = "market/social/author_selection.rs";
const ENGAGEMENT_FILE: &str = "market/social/engagement.rs";
const PRESS_FILE: &str = "market/social/press.rs";
const REACH_FILE: &str = "market/social/reach.rs";

/// Satisfaction of the example author.
const EXAMPLE_AUTHOR_SATISFACTION: f64 = 0.1;
/// Number of subscribers in the example.
const EXAMPLE_SUBSCRIBERS: usize = 100;

fn post_stream(context: &DrawContext, n: u64) -> novamind_world::random::Stream {
    context.streams.open(Part::CustomerPosts, [n])
}

fn draw_integer(context: &DrawContext, part: Part, n: u64, (low, high): (u32, u32)) -> f64 {
    f64::from(context.streams.open(part, [n]).integer(low, high))
}

/// Random draws of the social feed.
pub const SOCIAL_DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "post_clock",
        description: "time to the next post of a crowd with a total weight of 1; the earliest posts appear",
        part: Part::CustomerPosts,
        family: DrawFamily::Single,
        parameters: &[],
        source_files: &[(CROWD_FILE, 2)],
        distribution: |_, _| DrawDistribution::Exponential {
            mean: 1.0,
            offset: 0.0,
            min: 0.0,
            max: f64::INFINITY,
        },
        draw: |context, _, n| post_stream(context, n).exponential(1.0),
    },
    WorldDraw {
        name: "post_author",
        description: "position of the author in the crowd's weights, and of the cause in the weights of complaints",
        part: Part::CustomerPosts,
        family: DrawFamily::Single,
        parameters: &[],
        source_files: &[(CROWD_FILE, 2)],
        distribution: |_, _| DrawDistribution::Uniform { low: 0.0, high: 1.0 },
        draw: |context, _, n| post_stream(context, n).uniform(),
    },
    WorldDraw {
        name: "post_tone",
        description: "tone of a post (1 positive, 0 neutral, -1 negative) of an author with satisfaction 0.1",
        part: Part::CustomerPosts,
        family: DrawFamily::Single,
        parameters: &["social.sentiment"],
        source_files: &[(CROWD_FILE, 1)],
        distribution: |params, _| {
            let chances = sentiment_chances(EXAMPLE_AUTHOR_SATISFACTION, &params.social);
            let negative = 1.0 - chances.positive - chances.neutral;
            DrawDistribution::Discrete(vec![
                (1.0, chances.positive),
                (0.0, chances.neutral),
                (-1.0, negative),
            ])
        },
        draw: |context, _, n| match sentiment(
            EXAMPLE_AUTHOR_SATISFACTION,
            post_stream(context, n).uniform(),
            &context.params.social,
        ) {
            Sentiment::Positive => 1.0,
            Sentiment::Neutral => 0.0,
            Sentiment::Negative => -1.0,
        },
    },
    WorldDraw {
        name: "post_likes",
        description: "likes of a customer's post before the effect of tone",
        part: Part::CustomerPosts,
        family: DrawFamily::Groups,
        parameters: &["social.individual_likes_low", "social.individual_likes_high_exclusive"],
        source_files: &[(ENGAGEMENT_FILE, 1)],
        distribution: |params, member| {
            let id = Group::at(member).map_or("", Group::id);
            let [(low, high), _] = engagement_ranges(id, params);
            DrawDistribution::UniformInteger { low, high }
        },
        draw: |context, member, n| {
            let [likes, _] = engagement_ranges(Group::at(member).map_or("", Group::id), &context.params);
            draw_integer(context, Part::CustomerPosts, n, likes)
        },
    },
    WorldDraw {
        name: "post_shares",
        description: "shares of a customer's post before the effect of tone",
        part: Part::CustomerPosts,
        family: DrawFamily::Groups,
        parameters: &["social.individual_shares_low", "social.individual_shares_high_exclusive"],
        source_files: &[(ENGAGEMENT_FILE, 1)],
        distribution: |params, member| {
            let id = Group::at(member).map_or("", Group::id);
            let [_, (low, high)] = engagement_ranges(id, params);
            DrawDistribution::UniformInteger { low, high }
        },
        draw: |context, member, n| {
            let [_, shares] = engagement_ranges(Group::at(member).map_or("", Group::id), &context.params);
            draw_integer(context, Part::CustomerPosts, n, shares)
        },
    },
    WorldDraw {
        name: "post_factor",
        description: "uniform part of the reach of a customer's post, and the three uniform parts for a viral post",
        part: Part::CustomerPosts,
        family: DrawFamily::Single,
        parameters: &["social.virality_positive_range", "social.virality_neutral_range"],
        source_files: &[(ENGAGEMENT_FILE, 4)],
        distribution: |_, _| DrawDistribution::Uniform { low: 0.0, high: 1.0 },
        draw: |context, _, n| post_stream(context, n).uniform(),
    },
    WorldDraw {
        name: "post_explodes",
        description: "a customer's post goes viral",
        part: Part::CustomerPosts,
        family: DrawFamily::Single,
        parameters: &["social.viral_spike_probability"],
        source_files: &[(ENGAGEMENT_FILE, 1)],
        distribution: |params, _| DrawDistribution::Bernoulli(params.social.viral_spike_probability),
        draw: |context, _, n| {
            let spike = post_stream(context, n).uniform();
            f64::from(u8::from(spike < context.params.social.viral_spike_probability))
        },
    },
    WorldDraw {
        name: "press_error",
        description: "size that the press reports for an event of size 1",
        part: Part::CompetitorPosts,
        family: DrawFamily::Single,
        parameters: &[
            "competitor.competitor_post_boost_noise_min",
            "competitor.competitor_post_boost_noise_max",
        ],
        source_files: &[(PRESS_FILE, 1)],
        distribution: |params, _| DrawDistribution::Uniform {
            low: 1.0 + params.competitor.competitor_post_boost_noise_min,
            high: 1.0 + params.competitor.competitor_post_boost_noise_max,
        },
        draw: |context, _, n| {
            let law = &context.params.competitor;
            let u = context
                .streams
                .open(Part::CompetitorPosts, [n])
                .between(law.competitor_post_boost_noise_min, law.competitor_post_boost_noise_max);
            estimated_boost(1.0, u)
        },
    },
    WorldDraw {
        name: "rival_name",
        description: "competitor that the press writes about, by index",
        part: Part::CompetitorPosts,
        family: DrawFamily::Single,
        parameters: &["competitor.competitor_names"],
        source_files: &[(PRESS_FILE, 1)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: 0,
            high: params.competitor.competitor_names.len() as u32 - 1,
        },
        draw: |context, _, n| {
            let names = context.params.competitor.competitor_names.len();
            context.streams.open(Part::CompetitorPosts, [n]).index(names) as f64
        },
    },
    WorldDraw {
        name: "rival_perspective",
        description: "point of view of a post on a competitor",
        part: Part::CompetitorPosts,
        family: DrawFamily::Single,
        parameters: &["competitor.post_perspective_count"],
        source_files: &[(PRESS_FILE, 1)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: 0,
            high: params.competitor.post_perspective_count - 1,
        },
        draw: |context, _, n| {
            let count = context.params.competitor.post_perspective_count as usize;
            context.streams.open(Part::CompetitorPosts, [n]).index(count) as f64
        },
    },
    WorldDraw {
        name: "press_reach",
        description: "uniform parts of views, likes and shares of a press post",
        part: Part::CompetitorPosts,
        family: DrawFamily::Single,
        parameters: &[],
        source_files: &[(PRESS_FILE, 6)],
        distribution: |_, _| DrawDistribution::Uniform { low: 0.0, high: 1.0 },
        draw: |context, _, n| context.streams.open(Part::CompetitorPosts, [n]).uniform(),
    },
    WorldDraw {
        name: "economy_pause",
        description: "days until the next round of posts on the economy",
        part: Part::MacroPosts,
        family: DrawFamily::Single,
        parameters: &["macro.macro_social_post_interval_min", "macro.macro_social_post_interval_max"],
        source_files: &[(PRESS_FILE, 2)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: params.economy.macro_social_post_interval_min,
            high: params.economy.macro_social_post_interval_max,
        },
        draw: |context, _, n| {
            let law = &context.params.economy;
            let ends = (law.macro_social_post_interval_min, law.macro_social_post_interval_max);
            draw_integer(context, Part::MacroPosts, n, ends)
        },
    },
    WorldDraw {
        name: "economy_posts",
        description: "posts of a round on the economy",
        part: Part::MacroPosts,
        family: DrawFamily::Single,
        parameters: &["macro.macro_social_post_count_min", "macro.macro_social_post_count_max"],
        source_files: &[(PRESS_FILE, 1)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: params.economy.macro_social_post_count_min,
            high: params.economy.macro_social_post_count_max,
        },
        draw: |context, _, n| {
            let law = &context.params.economy;
            let ends = (law.macro_social_post_count_min, law.macro_social_post_count_max);
            draw_integer(context, Part::MacroPosts, n, ends)
        },
    },
    WorldDraw {
        name: "economy_perspective",
        description: "point of view of a post on the economy",
        part: Part::MacroPosts,
        family: DrawFamily::Single,
        parameters: &["macro.post_perspective_count"],
        source_files: &[(PRESS_FILE, 1)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: 0,
            high: params.economy.post_perspective_count - 1,
        },
        draw: |context, _, n| {
            let count = context.params.economy.post_perspective_count as usize;
            context.streams.open(Part::MacroPosts, [n]).index(count) as f64
        },
    },
    WorldDraw {
        name: "own_post_views",
        description: "random factor on the expected views of a player's post",
        part: Part::CeoViews,
        family: DrawFamily::Single,
        parameters: &["ceo_posts.views_noise_lognormal_mu", "ceo_posts.views_noise_lognormal_sigma"],
        source_files: &[(REACH_FILE, 1)],
        distribution: |params, _| DrawDistribution::LogNormal {
            mu: params.ceo_posts.views_noise_lognormal_mu,
            sigma: params.ceo_posts.views_noise_lognormal_sigma,
            min: 0.0,
            max: f64::INFINITY,
            factor: 1.0,
        },
        draw: |context, member, n| {
            let law = &context.params.ceo_posts;
            context
                .streams
                .open(Part::CeoViews, [n, member as u64])
                .log_normal(law.views_noise_lognormal_mu, law.views_noise_lognormal_sigma)
        },
    },
    WorldDraw {
        name: "comment_likes",
        description: "likes of a comment on a player's post",
        part: Part::CeoReply,
        family: DrawFamily::Single,
        parameters: &["ceo_posts.reply_likes_low", "ceo_posts.reply_likes_high_exclusive"],
        source_files: &[(REACH_FILE, 1)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: params.ceo_posts.reply_likes_low,
            high: params.ceo_posts.reply_likes_high_exclusive - 1,
        },
        draw: |context, _, n| {
            let law = &context.params.ceo_posts;
            draw_integer(
                context,
                Part::CeoReply,
                n,
                (law.reply_likes_low, law.reply_likes_high_exclusive - 1),
            )
        },
    },
    WorldDraw {
        name: "comment_shares",
        description: "shares of a comment on a player's post",
        part: Part::CeoReply,
        family: DrawFamily::Single,
        parameters: &["ceo_posts.reply_shares_low", "ceo_posts.reply_shares_high_exclusive"],
        source_files: &[(REACH_FILE, 1)],
        distribution: |params, _| DrawDistribution::UniformInteger {
            low: params.ceo_posts.reply_shares_low,
            high: params.ceo_posts.reply_shares_high_exclusive - 1,
        },
        draw: |context, _, n| {
            let law = &context.params.ceo_posts;
            draw_integer(
                context,
                Part::CeoReply,
                n,
                (law.reply_shares_low, law.reply_shares_high_exclusive - 1),
            )
        },
    },
    WorldDraw {
        name: "comment_author",
        description: "subscriber of a group who comments on a player's post, by index; the example has 100",
        part: Part::CeoReply,
        family: DrawFamily::Single,
        parameters: &[],
        source_files: &[(REACH_FILE, 1)],
        distribution: |_, _| DrawDistribution::UniformInteger {
            low: 0,
            high: EXAMPLE_SUBSCRIBERS as u32 - 1,
        },
        draw: |context, member, n| {
            context.streams.open(Part::CeoReply, [n, member as u64]).index(EXAMPLE_SUBSCRIBERS) as f64
        },
    },
];
