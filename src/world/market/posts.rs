//! Who is heard on social media: weights, sentiment and engagement of customers' posts (chapter 30 §5.3-§5.5).

use crate::world::params::{Params, SentimentChances, Social};

/// What weighs in a subscriber's chance to be heard today.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Voice {
    /// Satisfaction after today's update.
    pub satisfaction: f64,
    /// Its change today.
    pub change: f64,
    /// Whether the group is an influencer group.
    pub influencer: bool,
    /// Days subscribed.
    pub days_subscribed: u32,
    /// Events felt today: overload, outage, issue, quota.
    pub events: u32,
    /// Whether an unhappy company is bound by a contract.
    pub contract_locked: bool,
    /// Whole seats.
    pub seats: f64,
}

/// Weight of a subscriber.
pub fn post_weight(voice: &Voice, law: &Social) -> f64 {
    let s = voice.satisfaction;
    let mut weight = 1.0 + law.weight_abs_satisfaction_coef * s.abs();
    if s < 0.0 {
        weight *= 1.0 + law.weight_negative_satisfaction_sq_coef * s * s;
    }
    if voice.influencer {
        weight *= law.weight_influencer_multiplier;
    }
    if voice.days_subscribed <= law.weight_new_customer_max_days {
        weight *= law.weight_new_customer_multiplier;
    }
    if voice.change.abs() >= law.satisfaction_change_threshold {
        weight *= 1.0 + law.weight_satisfaction_change_coef * voice.change.abs();
    }
    if voice.events > 0 {
        weight *= 1.0 + law.weight_active_event_coef * f64::from(voice.events);
    }
    if voice.contract_locked {
        weight *= law.contract_dissatisfaction_reputation_multiplier;
    }
    finite(weight * voice.seats.max(1.0), law)
}

/// Weight of an individual who cancelled today.
pub fn cancelled_weight(satisfaction: f64, seats: f64, law: &Social) -> f64 {
    let bad = satisfaction.min(0.0).abs();
    finite(law.churn_weight_base * seats * (1.0 + law.churn_weight_negative_satisfaction_coef * bad), law)
}

/// Weight of a company that was lost today.
pub fn lost_company_weight(seats: f64, law: &Social) -> f64 {
    finite(law.enterprise_churn_weight_base * seats.max(1.0), law)
}

fn finite(weight: f64, law: &Social) -> f64 {
    if weight.is_finite() { weight } else { law.weight_nonfinite_replacement }
}

/// Tone of a post.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Sentiment {
    /// Praise.
    Positive,
    /// Neither.
    Neutral,
    /// Complaint.
    Negative,
}

/// Chances of a sentiment at a satisfaction.
pub fn sentiment_chances(satisfaction: f64, law: &Social) -> &SentimentChances {
    match satisfaction {
        s if s >= law.sentiment_band_very_positive_min => &law.sentiment.very_positive,
        s if s >= law.sentiment_band_positive_min => &law.sentiment.positive,
        s if s >= law.sentiment_band_neutral_min => &law.sentiment.neutral,
        s if s >= law.sentiment_band_negative_min => &law.sentiment.negative,
        _ => &law.sentiment.very_negative,
    }
}

/// Sentiment of a post from a uniform draw.
pub fn sentiment(satisfaction: f64, u: f64, law: &Social) -> Sentiment {
    let chances = sentiment_chances(satisfaction, law);
    if u < chances.positive {
        Sentiment::Positive
    } else if u < chances.positive + chances.neutral {
        Sentiment::Neutral
    } else {
        Sentiment::Negative
    }
}

/// How far a post carries; hidden, and without effect on the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engagement {
    /// Likes.
    pub likes: u32,
    /// Shares.
    pub shares: u32,
    /// 0..=1.
    pub virality: f64,
}

/// Draws behind a post's engagement: base likes and shares, then uniform numbers in order.
#[derive(Debug, Clone, Copy)]
pub struct EngagementDraws {
    /// Base likes.
    pub likes: u32,
    /// Base shares.
    pub shares: u32,
    /// Uniform part of the factor.
    pub factor: f64,
    /// Decides whether the post explodes.
    pub spike: f64,
    /// Uniform parts of an explosion: score, likes, shares.
    pub explosion: [f64; 3],
}

/// Engagement of a customer's post.
pub fn engagement(sentiment: Sentiment, draws: &EngagementDraws, law: &Social) -> Engagement {
    let factor = match sentiment {
        Sentiment::Negative => law.virality_negative_base + draws.factor,
        Sentiment::Positive => law.virality_positive_base + law.virality_positive_range * draws.factor,
        Sentiment::Neutral => law.virality_neutral_base + law.virality_neutral_range * draws.factor,
    };
    let mut likes = (f64::from(draws.likes) * factor).trunc();
    let mut shares = (f64::from(draws.shares) * factor).trunc();
    let reach = (likes + law.virality_share_weight * shares) / law.virality_score_divisor * factor;
    let mut virality = reach.min(law.virality_score_max);
    if draws.spike < law.viral_spike_probability {
        let [score, more_likes, more_shares] = draws.explosion;
        virality = (virality * (law.viral_spike_score_base + law.viral_spike_score_range * score))
            .min(law.virality_score_max);
        likes *= (law.viral_spike_likes_base + law.viral_spike_likes_range * more_likes).trunc();
        shares *= (law.viral_spike_shares_base + law.viral_spike_shares_range * more_shares).trunc();
    }
    Engagement { likes: likes as u32, shares: shares as u32, virality }
}

/// Range of base likes and shares, both ends included; every group whose name begins with E is a company here,
/// discoverable ones are not (chapter 30 §5.5).
pub fn engagement_ranges(group_id: &str, params: &Params) -> [(u32, u32); 2] {
    let law = &params.social;
    if group_id.starts_with('E') {
        [
            (law.enterprise_likes_low, law.enterprise_likes_high_exclusive - 1),
            (law.enterprise_shares_low, law.enterprise_shares_high_exclusive - 1),
        ]
    } else {
        [
            (law.individual_likes_low, law.individual_likes_high_exclusive - 1),
            (law.individual_shares_low, law.individual_shares_high_exclusive - 1),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: Voice = Voice {
        satisfaction: 0.0,
        change: 0.0,
        influencer: false,
        days_subscribed: 100,
        events: 0,
        contract_locked: false,
        seats: 1.0,
    };

    #[test]
    fn check_b_of_chapter_30() {
        let law = Params::shipped().social;
        for (voice, expected) in [
            (PLAIN, 1.0),
            (Voice { satisfaction: 0.3, ..PLAIN }, 4.0),
            (Voice { satisfaction: -0.3, ..PLAIN }, 11.2),
            (Voice { satisfaction: -0.3, influencer: true, days_subscribed: 10, ..PLAIN }, 33.6),
            (Voice { satisfaction: 0.1, change: 0.02, ..PLAIN }, 2.8),
            (Voice { satisfaction: 0.1, change: -0.05, events: 2, ..PLAIN }, 44.0),
            (Voice { satisfaction: -0.25, events: 1, contract_locked: true, seats: 80.0, ..PLAIN }, 5670.0),
            (
                Voice { satisfaction: 0.2, influencer: true, days_subscribed: 30, seats: 500.0, ..PLAIN },
                4500.0,
            ),
            (Voice { satisfaction: -40.0, ..PLAIN }, 12_832_401.0),
        ] {
            let weight = post_weight(&voice, &law);
            assert!((weight / expected - 1.0).abs() < 1e-12, "{voice:?}: {weight} instead of {expected}");
        }
        assert_eq!(cancelled_weight(-0.2, 1.0, &law), 15.0);
        assert_eq!(cancelled_weight(0.3, 1.0, &law), 5.0);
        assert_eq!(lost_company_weight(120.0, &law), 960.0);
        assert_eq!(lost_company_weight(0.0, &law), 8.0);
        assert_eq!(post_weight(&Voice { satisfaction: f64::INFINITY, ..PLAIN }, &law), 1e6);
    }

    #[test]
    fn check_14_of_chapter_30() {
        let law = Params::shipped().social;
        for (tone, likes, shares, [factor, spike, a, b, c], expected) in [
            (Sentiment::Negative, 40, 10, [0.4, 0.5, 0.0, 0.0, 0.0], (76, 19, 1.0)),
            (Sentiment::Positive, 40, 9, [0.4, 0.5, 0.0, 0.0, 0.0], (48, 10, 0.468)),
            (Sentiment::Negative, 99, 29, [0.9, 0.5, 0.0, 0.0, 0.0], (237, 69, 1.0)),
            (Sentiment::Neutral, 80, 20, [0.5, 0.005, 0.5, 0.5, 0.5], (420, 60, 1.0)),
            (Sentiment::Negative, 80, 20, [0.5, 0.005, 0.99, 0.2, 0.2], (960, 120, 1.0)),
        ] {
            let draws = EngagementDraws { likes, shares, factor, spike, explosion: [a, b, c] };
            let own = engagement(tone, &draws, &law);
            assert_eq!((own.likes, own.shares), (expected.0, expected.1), "{tone:?} {likes} {shares}");
            assert!((own.virality - expected.2).abs() < 1e-12);
        }
    }

    #[test]
    fn sentiment_follows_the_bands_of_chapter_30() {
        let law = Params::shipped().social;
        for (satisfaction, u, expected) in [
            (0.2, 0.69, Sentiment::Positive),
            (0.2, 0.71, Sentiment::Neutral),
            (0.19, 0.69, Sentiment::Neutral),
            (0.0, 0.71, Sentiment::Negative),
            (-0.05, 0.14, Sentiment::Positive),
            (-0.2, 0.41, Sentiment::Negative),
            (-0.21, 0.19, Sentiment::Neutral),
        ] {
            assert_eq!(sentiment(satisfaction, u, &law), expected, "{satisfaction} {u}");
        }
    }

    #[test]
    fn discoverable_companies_count_as_individuals() {
        let params = Params::shipped();
        assert_eq!(engagement_ranges("E1", &params), [(5, 49), (0, 9)]);
        assert_eq!(engagement_ranges("D_E01", &params), [(1, 99), (0, 29)]);
    }
}
