//! Reach of the player's posts: views, comments, and the notification in the inbox
//! (docs/mechanics/market/social/reach.md).

use super::Social;
use super::author_selection::post_author;
use crate::customers::Customers;
use crate::events::{Engagement, Facts, Notice, OwnPostSeen, PostAuthor, PostSubject, Reaction, Sentiment};
use crate::identifiers::{ByGroup, Group};
use crate::params::{CeoPosts, Params};
use crate::random::{Part, Stream, Streams};

/// Reactions of the known groups to a post of the player.
#[derive(Debug, Clone, PartialEq)]
pub struct PostReactions {
    /// Number of the post among the player's posts, from 1.
    pub post: u32,
    /// Reactions of the known groups, -1..=1, in group order.
    pub effects: Vec<(Group, f64)>,
}

/// Returns the views by a group before noise. The base views are multiplied by a factor of 1 to 3 for reactions up to
/// the threshold, and of 3 to 100 above the threshold.
pub fn expected_views(effect: f64, subscribers: u32, posts: &CeoPosts) -> f64 {
    let base = posts.views_base_min.max(posts.views_base_per_subscriber * f64::from(subscribers));
    let (size, threshold) = (effect.abs(), posts.viral_threshold);
    let edge = posts.views_threshold_multiplier;
    let factor = if size <= threshold {
        1.0 + size * (edge - 1.0) / threshold
    } else {
        let slope = libm::log(posts.views_max_multiplier / edge) / (1.0 - threshold);
        edge * libm::exp(slope * (size - threshold))
    };
    base * factor
}

/// Applies reactions to posts, and creates views, comments and notifications.
pub fn apply_reactions(
    social: &mut Social,
    customers: &Customers,
    verdicts: &[PostReactions],
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) {
    for verdict in verdicts {
        let post_exists = |post: u32| post >= 1 && post as usize <= social.own.len();
        if post_exists(verdict.post) {
            apply_post_reactions(social, customers, verdict, params, streams, facts);
        }
    }
}

fn apply_post_reactions(
    social: &mut Social,
    customers: &Customers,
    verdict: &PostReactions,
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) {
    let posts = &params.ceo_posts;
    let subscribers = customers.active_by_group();
    let (mut views, mut comments) = (0, Vec::new());
    let mut effects = ByGroup::from_fn(|_| 0.0);
    for &(group, effect) in &verdict.effects {
        effects[group] = effect;
        let keys = [u64::from(verdict.post), group.index() as u64];
        let noise_factor = streams
            .open(Part::CeoViews, keys)
            .log_normal(posts.views_noise_lognormal_mu, posts.views_noise_lognormal_sigma);
        views += (expected_views(effect, subscribers[group], posts) * noise_factor) as u64;
        if effect.abs() >= posts.viral_threshold {
            let mut stream = streams.open(Part::CeoReply, keys);
            let author = pick_author(group, customers, params, streams, &mut stream);
            let sentiment = if effect > 0.0 { Sentiment::Positive } else { Sentiment::Negative };
            let engagement = Engagement {
                likes: stream.integer(posts.reply_likes_low, posts.reply_likes_high_exclusive - 1),
                shares: stream.integer(posts.reply_shares_low, posts.reply_shares_high_exclusive - 1),
                virality: effect.abs(),
            };
            let matter = PostSubject::Comment { own_post: verdict.post, group, effect };
            comments.push(social.publish(author, sentiment, engagement, matter, facts));
        }
    }
    facts.notices.push(Notice::OwnPostSeen(reaction(verdict, views, posts)));
    facts.own_posts_seen.push(OwnPostSeen { post: verdict.post, views, comments: comments.clone() });
    let own_post = &mut social.own[verdict.post as usize - 1];
    (own_post.effects, own_post.views, own_post.comments) = (Some(effects), views, comments);
}

/// Returns a random active subscriber of a group, or `None` if the group has no subscribers.
fn pick_author(
    group: Group,
    customers: &Customers,
    params: &Params,
    streams: &Streams,
    stream: &mut Stream,
) -> Option<PostAuthor> {
    let group_customers = &customers.groups[group];
    let active = group_customers.active_count() as usize;
    if active == 0 {
        return None;
    }
    let mut at = stream.index(active);
    for block in &group_customers.blocks {
        if at < block.len() {
            let seats = block.seats[at] as u32;
            return Some(post_author(block.customer[at], group, block.n[at], seats, params, streams));
        }
        at -= block.len();
    }
    None
}

fn reaction(verdict: &PostReactions, views: u64, posts: &CeoPosts) -> Reaction {
    let judged = verdict.effects.len().max(1) as f64;
    let mean = verdict.effects.iter().map(|(_, effect)| effect).sum::<f64>() / judged;
    let mut sorted = verdict.effects.clone();
    sorted.sort_by(|(_, one), (_, other)| other.abs().total_cmp(&one.abs()));
    sorted.truncate(posts.notification_top_groups as usize);
    let strongest = std::array::from_fn(|at| sorted.get(at).copied());
    Reaction { post: verdict.post, views, mean, strongest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::market::social::own_posts::OwnPost;
    use crate::state::World;

    fn group(id: &str) -> Group {
        Group::parse(id).expect("a group")
    }

    #[test]
    fn views_grow_linearly_then_exponentially() {
        let posts = Params::bundled().ceo_posts;
        for (effect, expected) in
            [(0.3, 100.0), (0.6, 150.0), (0.7, 360.421712), (0.8, 866.025404), (1.0, 5000.0), (-0.3, 100.0)]
        {
            let views = expected_views(effect, 0, &posts);
            assert!((views - expected).abs() < 1e-6, "{effect}: got {views}, expected {expected}");
        }
        assert_eq!(expected_views(0.0, 4000, &posts), 400.0);
    }

    #[test]
    fn strong_reactions_cause_comments_and_a_notice() {
        let (params, streams) = (Params::bundled(), Streams::new(4));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        world.market.social.own.push(OwnPost::new(0, "Hello.", None));
        facts.start_day(1);
        let effects = vec![
            (group("S1"), 0.2),
            (group("S2"), -0.7),
            (group("S3"), 0.6),
            (group("E1"), 0.0),
            (group("E2"), -0.2),
        ];
        let verdict = PostReactions { post: 1, effects };
        apply_reactions(
            &mut world.market.social,
            &world.customers,
            std::slice::from_ref(&verdict),
            &params,
            &streams,
            &mut facts,
        );
        let tones: Vec<Sentiment> = facts.posts.iter().map(|post| post.sentiment).collect();
        assert_eq!(tones, [Sentiment::Negative, Sentiment::Positive]);
        assert!(facts.posts.iter().all(|post| post.author.is_none()), "there are no subscribers yet");
        let seen = &facts.own_posts_seen[0];
        assert_eq!((seen.post, seen.comments.as_slice()), (1, &[1, 2][..]));
        let own_post = &world.market.social.own[0];
        assert_eq!((own_post.views, own_post.comments.clone()), (seen.views, seen.comments.clone()));
        assert_eq!(own_post.effects.as_ref().map(|effects| effects[group("S2")]), Some(-0.7));
        let [Notice::OwnPostSeen(reaction)] = facts.notices.as_slice() else { panic!("one notice") };
        let named = reaction.strongest.map(|one| one.map(|(group, effect)| (group.id(), effect)));
        assert_eq!(named, [Some(("S2", -0.7)), Some(("S3", 0.6)), Some(("S1", 0.2))]);
        assert!((reaction.mean + 0.02).abs() < 1e-12);
        let mut again = world.clone();
        again.market.social.next_post = 1;
        let mut other = Facts::default();
        apply_reactions(
            &mut again.market.social,
            &again.customers,
            &[verdict, PostReactions { post: 9, effects: Vec::new() }],
            &params,
            &streams,
            &mut other,
        );
        assert_eq!(other.posts, facts.posts);
    }
}
