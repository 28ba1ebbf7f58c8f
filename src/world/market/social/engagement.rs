//! Engagement of customers' posts (docs/mechanics/market/social/engagement.md).

use crate::events::{Engagement, Sentiment};
use crate::params::{Params, SocialParams};
use crate::random::Stream;

/// Random draws for the engagement of a post: base likes, base shares and uniform draws, in draw order.
#[derive(Debug, Clone, Copy)]
pub struct EngagementDraws {
    /// Number of likes before the engagement factor is applied.
    pub likes: u32,
    /// Number of shares before the engagement factor is applied.
    pub shares: u32,
    /// Uniform draw of the engagement factor.
    pub factor: f64,
    /// Uniform draw that decides whether the post goes viral.
    pub spike: f64,
    /// Uniform draws of a viral spike: score, likes and shares.
    pub spike_draws: [f64; 3],
}

/// Returns the engagement of a customer's post.
pub fn engagement(sentiment: Sentiment, draws: &EngagementDraws, params: &SocialParams) -> Engagement {
    let factor = match sentiment {
        Sentiment::Negative => params.virality_negative_base + draws.factor,
        Sentiment::Positive => params.virality_positive_base + params.virality_positive_range * draws.factor,
        Sentiment::Neutral => params.virality_neutral_base + params.virality_neutral_range * draws.factor,
    };
    let mut likes = (f64::from(draws.likes) * factor).trunc();
    let mut shares = (f64::from(draws.shares) * factor).trunc();
    let reach = (likes + params.virality_share_weight * shares) / params.virality_score_divisor * factor;
    let mut virality = reach.min(params.virality_score_max);
    if draws.spike < params.viral_spike_probability {
        let [score, more_likes, more_shares] = draws.spike_draws;
        virality = (virality * (params.viral_spike_score_base + params.viral_spike_score_range * score))
            .min(params.virality_score_max);
        likes *= (params.viral_spike_likes_base + params.viral_spike_likes_range * more_likes).trunc();
        shares *= (params.viral_spike_shares_base + params.viral_spike_shares_range * more_shares).trunc();
    }
    Engagement { likes: likes as u32, shares: shares as u32, virality }
}

/// Returns the ranges of base likes and shares, both ends included. As in the released simulator, only groups whose
/// name starts with E count as enterprises; discoverable groups do not.
pub fn engagement_ranges(group_id: &str, params: &Params) -> [(u32, u32); 2] {
    let social_params = &params.social;
    if group_id.starts_with('E') {
        [
            (social_params.enterprise_likes_low, social_params.enterprise_likes_high_exclusive - 1),
            (social_params.enterprise_shares_low, social_params.enterprise_shares_high_exclusive - 1),
        ]
    } else {
        [
            (social_params.individual_likes_low, social_params.individual_likes_high_exclusive - 1),
            (social_params.individual_shares_low, social_params.individual_shares_high_exclusive - 1),
        ]
    }
}

/// Draws the engagement of a post by a customer of a group.
pub fn draw_engagement(
    sentiment: Sentiment,
    group_id: &str,
    params: &Params,
    stream: &mut Stream,
) -> Engagement {
    let [likes, shares] = engagement_ranges(group_id, params);
    let (likes, shares) = (stream.integer(likes.0, likes.1), stream.integer(shares.0, shares.1));
    let (factor, spike) = (stream.uniform(), stream.uniform());
    let spike_draws = [stream.uniform(), stream.uniform(), stream.uniform()];
    let draws = EngagementDraws { likes, shares, factor, spike, spike_draws };
    engagement(sentiment, &draws, &params.social)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn engagement_matches_its_draws() {
        let params = Params::bundled().social;
        for (tone, likes, shares, [factor, spike, a, b, c], expected) in [
            (Sentiment::Negative, 40, 10, [0.4, 0.5, 0.0, 0.0, 0.0], (76, 19, 1.0)),
            (Sentiment::Positive, 40, 9, [0.4, 0.5, 0.0, 0.0, 0.0], (48, 10, 0.468)),
            (Sentiment::Negative, 99, 29, [0.9, 0.5, 0.0, 0.0, 0.0], (237, 69, 1.0)),
            (Sentiment::Neutral, 80, 20, [0.5, 0.005, 0.5, 0.5, 0.5], (420, 60, 1.0)),
            (Sentiment::Negative, 80, 20, [0.5, 0.005, 0.99, 0.2, 0.2], (960, 120, 1.0)),
        ] {
            let draws = EngagementDraws { likes, shares, factor, spike, spike_draws: [a, b, c] };
            let reactions = engagement(tone, &draws, &params);
            assert_eq!(
                (reactions.likes, reactions.shares),
                (expected.0, expected.1),
                "{tone:?} {likes} {shares}"
            );
            assert!((reactions.virality - expected.2).abs() < 1e-12);
        }
    }

    #[test]
    fn discoverable_enterprises_use_individual_ranges() {
        let params = Params::bundled();
        assert_eq!(engagement_ranges("E1", &params), [(5, 49), (0, 9)]);
        assert_eq!(engagement_ranges("D_E01", &params), [(1, 99), (0, 29)]);
    }

    #[test]
    fn mean_engagement_matches_the_release() {
        let params = Params::bundled();
        let mut stream = crate::random::Streams::new(5).open(crate::random::Part::CustomerPosts, [1]);
        for (sentiment, id, likes, shares) in [
            (Sentiment::Positive, "S1", 65.9, Some(18.2)),
            (Sentiment::Neutral, "S1", 39.3, Some(10.7)),
            (Sentiment::Negative, "S1", 105.7, Some(29.4)),
            (Sentiment::Positive, "E1", 35.3, None),
            (Sentiment::Negative, "E1", 56.8, None),
        ] {
            let draws = 20_000;
            let (mut sum, mut shared) = (0.0, 0.0);
            for _ in 0..draws {
                let engagement = draw_engagement(sentiment, id, &params, &mut stream);
                (sum, shared) = (sum + f64::from(engagement.likes), shared + f64::from(engagement.shares));
            }
            let (mean, mean_shares) = (sum / f64::from(draws), shared / f64::from(draws));
            assert!((mean / likes - 1.0).abs() < 0.03, "{id} {sentiment:?}: {mean} likes");
            assert!(
                shares.is_none_or(|shares| (mean_shares / shares - 1.0).abs() < 0.04),
                "{mean_shares} shares"
            );
        }
    }
}
