//! Random draws of the social feed: authors, tone, reach, press coverage.

use super::law::Law;
use super::world_draw::{Family, Luck, WorldDraw};
use novamind_world::events::Sentiment;
use novamind_world::identifiers::Group;
use novamind_world::market::social::engagement::engagement_ranges;
use novamind_world::market::social::press::estimated_boost;
use novamind_world::market::social::sentiment::{sentiment, sentiment_chances};
use novamind_world::random::Part;

const CROWD: &str = "market/social/crowd.rs";
const ENGAGEMENT: &str = "market/social/engagement.rs";
const PRESS: &str = "market/social/press.rs";
const REACH: &str = "market/social/reach.rs";

/// Satisfaction of the example author.
const MOOD: f64 = 0.1;
/// Number of subscribers in the example.
const SUBSCRIBERS: usize = 100;

fn post(luck: &Luck, n: u64) -> novamind_world::random::Stream {
    luck.streams.open(Part::CustomerPosts, [n])
}

fn whole(luck: &Luck, part: Part, n: u64, (low, high): (u32, u32)) -> f64 {
    f64::from(luck.streams.open(part, [n]).integer(low, high))
}

/// Returns the draws.
pub const DRAWS: &[WorldDraw] = &[
    WorldDraw {
        name: "post_clock",
        what: "time to the next post of a crowd with a total weight of 1; the earliest posts appear",
        part: Part::CustomerPosts,
        family: Family::One,
        keys: &[],
        sites: &[(CROWD, 2)],
        law: |_, _| Law::Exponential { mean: 1.0, offset: 0.0, least: 0.0, most: f64::INFINITY },
        draw: |luck, _, n| post(luck, n).exponential(1.0),
    },
    WorldDraw {
        name: "post_author",
        what: "position of the author in the crowd's weights, and of the cause in the weights of complaints",
        part: Part::CustomerPosts,
        family: Family::One,
        keys: &[],
        sites: &[(CROWD, 2)],
        law: |_, _| Law::Uniform { low: 0.0, high: 1.0 },
        draw: |luck, _, n| post(luck, n).uniform(),
    },
    WorldDraw {
        name: "post_tone",
        what: "tone of a post (1 positive, 0 neutral, -1 negative) of an author with satisfaction 0.1",
        part: Part::CustomerPosts,
        family: Family::One,
        keys: &["social.sentiment"],
        sites: &[(CROWD, 1)],
        law: |params, _| {
            let own = sentiment_chances(MOOD, &params.social);
            let negative = 1.0 - own.positive - own.neutral;
            Law::Among(vec![(1.0, own.positive), (0.0, own.neutral), (-1.0, negative)])
        },
        draw: |luck, _, n| match sentiment(MOOD, post(luck, n).uniform(), &luck.params.social) {
            Sentiment::Positive => 1.0,
            Sentiment::Neutral => 0.0,
            Sentiment::Negative => -1.0,
        },
    },
    WorldDraw {
        name: "post_likes",
        what: "likes of a customer's post before the effect of tone",
        part: Part::CustomerPosts,
        family: Family::Groups,
        keys: &["social.individual_likes_low", "social.individual_likes_high_exclusive"],
        sites: &[(ENGAGEMENT, 1)],
        law: |params, member| {
            let id = Group::at(member).map_or("", Group::id);
            let [(low, high), _] = engagement_ranges(id, params);
            Law::Whole { low, high }
        },
        draw: |luck, member, n| {
            let [likes, _] = engagement_ranges(Group::at(member).map_or("", Group::id), &luck.params);
            whole(luck, Part::CustomerPosts, n, likes)
        },
    },
    WorldDraw {
        name: "post_shares",
        what: "shares of a customer's post before the effect of tone",
        part: Part::CustomerPosts,
        family: Family::Groups,
        keys: &["social.individual_shares_low", "social.individual_shares_high_exclusive"],
        sites: &[(ENGAGEMENT, 1)],
        law: |params, member| {
            let id = Group::at(member).map_or("", Group::id);
            let [_, (low, high)] = engagement_ranges(id, params);
            Law::Whole { low, high }
        },
        draw: |luck, member, n| {
            let [_, shares] = engagement_ranges(Group::at(member).map_or("", Group::id), &luck.params);
            whole(luck, Part::CustomerPosts, n, shares)
        },
    },
    WorldDraw {
        name: "post_factor",
        what: "uniform part of the reach of a customer's post, and the three of a viral post",
        part: Part::CustomerPosts,
        family: Family::One,
        keys: &["social.virality_positive_range", "social.virality_neutral_range"],
        sites: &[(ENGAGEMENT, 4)],
        law: |_, _| Law::Uniform { low: 0.0, high: 1.0 },
        draw: |luck, _, n| post(luck, n).uniform(),
    },
    WorldDraw {
        name: "post_explodes",
        what: "a customer's post goes viral",
        part: Part::CustomerPosts,
        family: Family::One,
        keys: &["social.viral_spike_probability"],
        sites: &[(ENGAGEMENT, 1)],
        law: |params, _| Law::Chance(params.social.viral_spike_probability),
        draw: |luck, _, n| {
            let spike = post(luck, n).uniform();
            f64::from(u8::from(spike < luck.params.social.viral_spike_probability))
        },
    },
    WorldDraw {
        name: "press_error",
        what: "size that the press reports for an event of size 1",
        part: Part::CompetitorPosts,
        family: Family::One,
        keys: &["competitor.competitor_post_boost_noise_min", "competitor.competitor_post_boost_noise_max"],
        sites: &[(PRESS, 1)],
        law: |params, _| Law::Uniform {
            low: 1.0 + params.competitor.competitor_post_boost_noise_min,
            high: 1.0 + params.competitor.competitor_post_boost_noise_max,
        },
        draw: |luck, _, n| {
            let law = &luck.params.competitor;
            let u = luck
                .streams
                .open(Part::CompetitorPosts, [n])
                .between(law.competitor_post_boost_noise_min, law.competitor_post_boost_noise_max);
            estimated_boost(1.0, u)
        },
    },
    WorldDraw {
        name: "rival_name",
        what: "competitor that the press writes about, by index",
        part: Part::CompetitorPosts,
        family: Family::One,
        keys: &["competitor.competitor_names"],
        sites: &[(PRESS, 1)],
        law: |params, _| Law::Whole { low: 0, high: params.competitor.competitor_names.len() as u32 - 1 },
        draw: |luck, _, n| {
            let names = luck.params.competitor.competitor_names.len();
            luck.streams.open(Part::CompetitorPosts, [n]).index(names) as f64
        },
    },
    WorldDraw {
        name: "rival_perspective",
        what: "point of view of a post on a competitor",
        part: Part::CompetitorPosts,
        family: Family::One,
        keys: &["competitor.post_perspective_count"],
        sites: &[(PRESS, 1)],
        law: |params, _| Law::Whole { low: 0, high: params.competitor.post_perspective_count - 1 },
        draw: |luck, _, n| {
            let count = luck.params.competitor.post_perspective_count as usize;
            luck.streams.open(Part::CompetitorPosts, [n]).index(count) as f64
        },
    },
    WorldDraw {
        name: "press_reach",
        what: "uniform parts of views, likes and shares of a press post",
        part: Part::CompetitorPosts,
        family: Family::One,
        keys: &[],
        sites: &[(PRESS, 6)],
        law: |_, _| Law::Uniform { low: 0.0, high: 1.0 },
        draw: |luck, _, n| luck.streams.open(Part::CompetitorPosts, [n]).uniform(),
    },
    WorldDraw {
        name: "economy_pause",
        what: "days until the next round of posts on the economy",
        part: Part::MacroPosts,
        family: Family::One,
        keys: &["macro.macro_social_post_interval_min", "macro.macro_social_post_interval_max"],
        sites: &[(PRESS, 2)],
        law: |params, _| Law::Whole {
            low: params.economy.macro_social_post_interval_min,
            high: params.economy.macro_social_post_interval_max,
        },
        draw: |luck, _, n| {
            let law = &luck.params.economy;
            let ends = (law.macro_social_post_interval_min, law.macro_social_post_interval_max);
            whole(luck, Part::MacroPosts, n, ends)
        },
    },
    WorldDraw {
        name: "economy_posts",
        what: "posts of a round on the economy",
        part: Part::MacroPosts,
        family: Family::One,
        keys: &["macro.macro_social_post_count_min", "macro.macro_social_post_count_max"],
        sites: &[(PRESS, 1)],
        law: |params, _| Law::Whole {
            low: params.economy.macro_social_post_count_min,
            high: params.economy.macro_social_post_count_max,
        },
        draw: |luck, _, n| {
            let law = &luck.params.economy;
            let ends = (law.macro_social_post_count_min, law.macro_social_post_count_max);
            whole(luck, Part::MacroPosts, n, ends)
        },
    },
    WorldDraw {
        name: "economy_perspective",
        what: "point of view of a post on the economy",
        part: Part::MacroPosts,
        family: Family::One,
        keys: &["macro.post_perspective_count"],
        sites: &[(PRESS, 1)],
        law: |params, _| Law::Whole { low: 0, high: params.economy.post_perspective_count - 1 },
        draw: |luck, _, n| {
            let count = luck.params.economy.post_perspective_count as usize;
            luck.streams.open(Part::MacroPosts, [n]).index(count) as f64
        },
    },
    WorldDraw {
        name: "own_post_views",
        what: "random factor on the expected views of a player's post",
        part: Part::CeoViews,
        family: Family::One,
        keys: &["ceo_posts.views_noise_lognormal_mu", "ceo_posts.views_noise_lognormal_sigma"],
        sites: &[(REACH, 1)],
        law: |params, _| Law::LogNormal {
            mu: params.ceo_posts.views_noise_lognormal_mu,
            sigma: params.ceo_posts.views_noise_lognormal_sigma,
            least: 0.0,
            most: f64::INFINITY,
            factor: 1.0,
        },
        draw: |luck, member, n| {
            let law = &luck.params.ceo_posts;
            luck.streams
                .open(Part::CeoViews, [n, member as u64])
                .log_normal(law.views_noise_lognormal_mu, law.views_noise_lognormal_sigma)
        },
    },
    WorldDraw {
        name: "comment_likes",
        what: "likes of a comment on a player's post",
        part: Part::CeoReply,
        family: Family::One,
        keys: &["ceo_posts.reply_likes_low", "ceo_posts.reply_likes_high_exclusive"],
        sites: &[(REACH, 1)],
        law: |params, _| Law::Whole {
            low: params.ceo_posts.reply_likes_low,
            high: params.ceo_posts.reply_likes_high_exclusive - 1,
        },
        draw: |luck, _, n| {
            let law = &luck.params.ceo_posts;
            whole(luck, Part::CeoReply, n, (law.reply_likes_low, law.reply_likes_high_exclusive - 1))
        },
    },
    WorldDraw {
        name: "comment_shares",
        what: "shares of a comment on a player's post",
        part: Part::CeoReply,
        family: Family::One,
        keys: &["ceo_posts.reply_shares_low", "ceo_posts.reply_shares_high_exclusive"],
        sites: &[(REACH, 1)],
        law: |params, _| Law::Whole {
            low: params.ceo_posts.reply_shares_low,
            high: params.ceo_posts.reply_shares_high_exclusive - 1,
        },
        draw: |luck, _, n| {
            let law = &luck.params.ceo_posts;
            whole(luck, Part::CeoReply, n, (law.reply_shares_low, law.reply_shares_high_exclusive - 1))
        },
    },
    WorldDraw {
        name: "comment_author",
        what: "subscriber of a group who comments on a player's post, by index; the example has 100",
        part: Part::CeoReply,
        family: Family::One,
        keys: &[],
        sites: &[(REACH, 1)],
        law: |_, _| Law::Whole { low: 0, high: SUBSCRIBERS as u32 - 1 },
        draw: |luck, member, n| {
            luck.streams.open(Part::CeoReply, [n, member as u64]).index(SUBSCRIBERS) as f64
        },
    },
];
