//! Parameters of social media: `configs/world/social.toml`.

use super::check::parameters;

parameters! {
    /// Posts of customers.
    pub struct SocialParams {
        /// Maximum customer posts per posting day.
        pub max_posts_per_day: u32 where 0.0..=1_000.0,
        /// Growth of the weight with the absolute satisfaction.
        pub weight_abs_satisfaction_coef: f64,
        /// Additional growth with squared negative satisfaction.
        pub weight_negative_satisfaction_sq_coef: f64,
        /// Factor of influencer groups.
        pub weight_influencer_multiplier: f64,
        /// Days for which a customer counts as new.
        pub weight_new_customer_max_days: u32 where 0.0..=100_000.0,
        /// Factor of new customers.
        pub weight_new_customer_multiplier: f64,
        /// Minimum change of satisfaction that counts.
        pub satisfaction_change_threshold: f64,
        /// Growth of the weight with that change.
        pub weight_satisfaction_change_coef: f64,
        /// Growth of the weight per event of today.
        pub weight_active_event_coef: f64,
        /// Factor of unhappy enterprises locked in by a contract.
        pub contract_dissatisfaction_reputation_multiplier: f64,
        /// Replacement for a weight that is not finite.
        pub weight_nonfinite_replacement: f64,
        /// Base weight of a cancelled individual.
        pub churn_weight_base: f64,
        /// Growth of that weight with negative satisfaction.
        pub churn_weight_negative_satisfaction_coef: f64,
        /// Weight per seat of a lost enterprise.
        pub enterprise_churn_weight_base: f64,
        /// Satisfaction recorded for a lost enterprise.
        pub enterprise_churn_event_satisfaction: f64,
        /// Days subscribed of a lost enterprise if they are unknown.
        pub enterprise_churn_event_fallback_days: u32 where 0.0..=100_000.0,
        /// Lower edge of the best band.
        pub sentiment_band_very_positive_min: f64,
        /// Lower edge of the second band.
        pub sentiment_band_positive_min: f64,
        /// Lower edge of the middle band.
        pub sentiment_band_neutral_min: f64,
        /// Lower edge of the fourth band.
        pub sentiment_band_negative_min: f64,
        /// Minimum likes of an enterprise's post.
        pub enterprise_likes_low: u32,
        /// One above the maximum.
        pub enterprise_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum shares of an enterprise's post.
        pub enterprise_shares_low: u32,
        /// One above the maximum.
        pub enterprise_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum likes of an individual's post.
        pub individual_likes_low: u32,
        /// One above the maximum.
        pub individual_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum shares of an individual's post.
        pub individual_shares_low: u32,
        /// One above the maximum.
        pub individual_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Factor of negative posts, plus U.
        pub virality_negative_base: f64,
        /// Base factor of positive posts.
        pub virality_positive_base: f64,
        /// Width of its uniform part.
        pub virality_positive_range: f64,
        /// Base factor of neutral posts.
        pub virality_neutral_base: f64,
        /// Width of its uniform part.
        pub virality_neutral_range: f64,
        /// Upper clamp of the score.
        pub virality_score_max: f64,
        /// Likes that one share is worth.
        pub virality_share_weight: f64,
        /// Scales the score.
        pub virality_score_divisor: f64,
        /// Probability of a viral spike.
        pub viral_spike_probability: f64,
        /// Factor on the score in a viral spike,
        pub viral_spike_score_base: f64,
        /// plus a uniform part of this width.
        pub viral_spike_score_range: f64,
        /// Factor on the likes in a viral spike,
        pub viral_spike_likes_base: f64,
        /// plus a uniform part of this width.
        pub viral_spike_likes_range: f64,
        /// Factor on the shares in a viral spike,
        pub viral_spike_shares_base: f64,
        /// plus a uniform part of this width.
        pub viral_spike_shares_range: f64,
        /// Probabilities of a sentiment by band of satisfaction.
        pub sentiment: SentimentByBand,
    }

    /// Reach and effect of the player's posts.
    pub struct CeoPosts {
        /// Reactions of at least this size cause comments.
        pub viral_threshold: f64 where POSITIVE..=0.999,
        /// Views of a post in a group without subscribers,
        pub views_base_min: f64,
        /// or this share of the subscribers.
        pub views_base_per_subscriber: f64,
        /// Factor of the views at the threshold.
        pub views_threshold_multiplier: f64,
        /// Factor of the views at a reaction of 1.
        pub views_max_multiplier: f64,
        /// Mean of the logarithm of the noise of views.
        pub views_noise_lognormal_mu: f64,
        /// Its standard deviation.
        pub views_noise_lognormal_sigma: f64,
        /// Characters of the post that the inbox shows.
        pub notification_preview_chars: u32 where 0.0..=10_000.0,
        /// Mean reactions beyond this are described as positive or negative.
        pub notification_sentiment_threshold: f64,
        /// Number of groups named in the inbox, at most 3.
        pub notification_top_groups: u32 where 0.0..=3.0,
        /// Minimum likes of a comment.
        pub reply_likes_low: u32,
        /// One above the maximum.
        pub reply_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum shares of a comment.
        pub reply_shares_low: u32,
        /// One above the maximum.
        pub reply_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Reactions below this do not change leads.
        pub multiplier_viral_threshold: f64,
        /// Maximum effect of one post on leads.
        pub multiplier_max_boost_per_post: f64,
        /// Days after which the effect is halved.
        pub multiplier_half_life_days: f64 where POSITIVE..=1e6,
        /// Minimum factor.
        pub multiplier_min: f64,
        /// Maximum factor of all posts together.
        pub multiplier_max: f64,
        /// Factor without posts.
        pub multiplier_neutral: f64,
    }

    /// Probabilities of a post's sentiment.
    #[derive(Copy)]
    pub struct SentimentChances {
        /// Probability of a positive post.
        pub positive: f64 where 0.0..=1.0,
        /// Probability of a neutral post.
        pub neutral: f64 where 0.0..=1.0,
        /// Probability of a negative post.
        pub negative: f64 where 0.0..=1.0,
    }

    /// Probabilities of a post's sentiment by band of the author's satisfaction, best band first.
    pub struct SentimentByBand {
        /// Satisfaction of at least `sentiment_band_very_positive_min`.
        pub very_positive: SentimentChances,
        /// At least `sentiment_band_positive_min`.
        pub positive: SentimentChances,
        /// At least `sentiment_band_neutral_min`.
        pub neutral: SentimentChances,
        /// At least `sentiment_band_negative_min`.
        pub negative: SentimentChances,
        /// Below.
        pub very_negative: SentimentChances,
    }
}
