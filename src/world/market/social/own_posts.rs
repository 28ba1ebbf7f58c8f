//! The player's posts and their effect on leads (docs/mechanics/market/social/own.md).

use crate::canonical::canonical;
use crate::identifiers::{ByGroup, Group};
use crate::params::CeoPosts;

/// A post of the player.
#[derive(Debug, Clone, PartialEq)]
pub struct OwnPost {
    /// Day on which the player published the post.
    pub day: u32,
    /// Text of the post: at most 280 code points, not blank.
    pub content: String,
    /// Number of the post to which the player replies; `None` if the post is not a reply.
    pub reply_to: Option<u32>,
    /// Reaction of each group, -1..=1, or 0 for unknown groups. `None` before the post is judged.
    pub effects: Option<ByGroup<f64>>,
    /// Number of views of the post; 0 before the post is judged.
    pub views: u64,
    /// Numbers of the comments on the post; empty before the post is judged.
    pub comments: Vec<u32>,
}

canonical! { OwnPost { day, content, reply_to, effects, views, comments } }

impl OwnPost {
    /// Creates a post that has not been judged.
    pub fn new(day: u32, content: impl Into<String>, reply_to: Option<u32>) -> OwnPost {
        OwnPost { day, content: content.into(), reply_to, effects: None, views: 0, comments: Vec::new() }
    }
}

/// Returns the change in the lead factor from one reaction to a post of the given age in days. Reactions below 0.6
/// have no effect.
pub fn post_effect(effect: f64, age_days: u32, posts: &CeoPosts) -> f64 {
    let (size, threshold) = (effect.abs(), posts.multiplier_viral_threshold);
    if size < threshold {
        return 0.0;
    }
    let strength = (size - threshold) / (1.0 - threshold) * posts.multiplier_max_boost_per_post;
    effect.signum() * strength * libm::exp2(-f64::from(age_days) / posts.multiplier_half_life_days)
}

/// Returns the lead factor of a group from the player's posts: 1 plus the effects of all posts, within 0.75..=1.25.
pub fn social_multiplier(group: Group, day: u32, posts: &[OwnPost], ceo_posts: &CeoPosts) -> f64 {
    let judged = posts.iter().filter(|post| post.day <= day);
    let sum: f64 = judged
        .filter_map(|post| {
            post.effects.as_ref().map(|effects| post_effect(effects[group], day - post.day, ceo_posts))
        })
        .sum();
    (ceo_posts.multiplier_neutral + sum).clamp(ceo_posts.multiplier_min, ceo_posts.multiplier_max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    fn multiplier(posts: &[(u32, f64)], day: u32) -> f64 {
        let group = Group::at(0).expect("S1");
        let posts: Vec<OwnPost> = posts
            .iter()
            .map(|&(day, effect)| OwnPost {
                effects: Some(ByGroup::from_fn(|_| effect)),
                ..OwnPost::new(day, "a post", None)
            })
            .collect();
        social_multiplier(group, day, &posts, &Params::bundled().ceo_posts)
    }

    #[test]
    fn strong_reactions_change_leads_and_decay() {
        for (posts, day, expected) in [
            (&[(7, 1.0)][..], 8, 1.198425131496),
            (&[(7, 1.0)], 9, 1.157490131237),
            (&[(7, 1.0)], 14, 1.049606282874),
            (&[(7, 0.8)], 9, 1.078745065618),
            (&[(7, 0.75)], 9, 1.059058799214),
            (&[(7, 0.6)], 9, 1.0),
            (&[(7, 0.59)], 9, 1.0),
            (&[(7, -0.9)], 9, 0.881882401572),
            (&[(0, -1.0), (7, -1.0)], 7, 0.75),
            (&[(0, 1.0), (7, 1.0)], 9, 1.188740131237),
        ] {
            let value = multiplier(posts, day);
            assert!((value - expected).abs() < 1e-11, "{posts:?} on {day}: got {value}, expected {expected}");
        }
    }

    #[test]
    fn post_effect_halves_after_three_days() {
        for (effect, day, expected) in
            [(0.9, 10, 1.1875), (-1.0, 11, 0.8015748685), (0.9, 13, 1.09375), (-1.0, 20, 0.9751968586)]
        {
            assert!((multiplier(&[(10, effect)], day) - expected).abs() < 1e-10);
        }
    }
}
