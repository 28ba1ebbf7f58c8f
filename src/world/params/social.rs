//! Parameters of social media: `configs/world/social.toml`.

use super::check::parameters;

parameters! {
    /// Parameters of customers' posts.
    pub struct SocialParams {
        /// Maximum number of customer posts per posting day.
        pub max_posts_per_day: u32 where 0.0..=1_000.0,
        /// Coefficient of absolute satisfaction in the post weight.
        pub weight_abs_satisfaction_coef: f64,
        /// Coefficient of squared satisfaction in the post weight of dissatisfied subscribers.
        pub weight_negative_satisfaction_sq_coef: f64,
        /// Factor of the post weight in influencer groups.
        pub weight_influencer_multiplier: f64,
        /// Number of days for which a customer counts as a new customer.
        pub weight_new_customer_max_days: u32 where 0.0..=100_000.0,
        /// Factor of the post weight of new customers.
        pub weight_new_customer_multiplier: f64,
        /// Minimum absolute change in satisfaction that affects the post weight.
        pub satisfaction_change_threshold: f64,
        /// Coefficient of the absolute change in satisfaction in the post weight.
        pub weight_satisfaction_change_coef: f64,
        /// Relative increase of the post weight per problem that the customer has today.
        pub weight_active_event_coef: f64,
        /// Factor of the post weight of dissatisfied enterprises that are locked in by a contract.
        pub contract_dissatisfaction_reputation_multiplier: f64,
        /// Replacement for a post weight that is not finite.
        pub weight_nonfinite_replacement: f64,
        /// Base post weight of an individual who cancelled.
        pub churn_weight_base: f64,
        /// Coefficient of negative satisfaction in the post weight of an individual who cancelled.
        pub churn_weight_negative_satisfaction_coef: f64,
        /// Post weight per seat of a lost enterprise.
        pub enterprise_churn_weight_base: f64,
        /// Satisfaction that is recorded for a lost enterprise.
        pub enterprise_churn_event_satisfaction: f64,
        /// Number of days for which a lost enterprise is assumed to have been a subscriber, if the actual number is
        /// unknown.
        pub enterprise_churn_event_fallback_days: u32 where 0.0..=100_000.0,
        /// Lower bound of the best satisfaction band.
        pub sentiment_band_very_positive_min: f64,
        /// Lower bound of the second satisfaction band.
        pub sentiment_band_positive_min: f64,
        /// Lower bound of the middle satisfaction band.
        pub sentiment_band_neutral_min: f64,
        /// Lower bound of the fourth satisfaction band.
        pub sentiment_band_negative_min: f64,
        /// Minimum number of likes of an enterprise's post.
        pub enterprise_likes_low: u32,
        /// One more than the maximum number of likes of an enterprise's post.
        pub enterprise_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum number of shares of an enterprise's post.
        pub enterprise_shares_low: u32,
        /// One more than the maximum number of shares of an enterprise's post.
        pub enterprise_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum number of likes of an individual's post.
        pub individual_likes_low: u32,
        /// One more than the maximum number of likes of an individual's post.
        pub individual_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum number of shares of an individual's post.
        pub individual_shares_low: u32,
        /// One more than the maximum number of shares of an individual's post.
        pub individual_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Base engagement factor of negative posts. A uniform draw from 0 to 1 is added to the factor.
        pub virality_negative_base: f64,
        /// Base engagement factor of positive posts.
        pub virality_positive_base: f64,
        /// Upper limit of the uniform draw from 0 that is added to the engagement factor of positive posts.
        pub virality_positive_range: f64,
        /// Base engagement factor of neutral posts.
        pub virality_neutral_base: f64,
        /// Upper limit of the uniform draw from 0 that is added to the engagement factor of neutral posts.
        pub virality_neutral_range: f64,
        /// Upper bound of the virality score.
        pub virality_score_max: f64,
        /// Number of likes that count as much as one share in the virality score.
        pub virality_share_weight: f64,
        /// Divisor of the virality score.
        pub virality_score_divisor: f64,
        /// Probability of a viral spike.
        pub viral_spike_probability: f64,
        /// Minimum factor of the virality score in a viral spike.
        pub viral_spike_score_base: f64,
        /// Upper limit of the uniform draw from 0 that is added to the minimum factor of the virality score.
        pub viral_spike_score_range: f64,
        /// Minimum factor of the likes in a viral spike.
        pub viral_spike_likes_base: f64,
        /// Upper limit of the uniform draw from 0 that is added to the minimum factor of the likes.
        pub viral_spike_likes_range: f64,
        /// Minimum factor of the shares in a viral spike.
        pub viral_spike_shares_base: f64,
        /// Upper limit of the uniform draw from 0 that is added to the minimum factor of the shares.
        pub viral_spike_shares_range: f64,
        /// Probabilities of each sentiment by satisfaction band.
        pub sentiment: SentimentByBand,
    }

    /// Parameters of the reach and effect of the player's posts.
    pub struct CeoPosts {
        /// Smallest absolute reaction that causes comments.
        pub viral_threshold: f64 where POSITIVE..=0.999,
        /// Minimum base views of a post in a group.
        pub views_base_min: f64,
        /// Base views of a post per subscriber of a group.
        pub views_base_per_subscriber: f64,
        /// Factor of the views for a reaction at the threshold.
        pub views_threshold_multiplier: f64,
        /// Factor of the views for a reaction of 1.
        pub views_max_multiplier: f64,
        /// Mean of the logarithm of the views' noise factor.
        pub views_noise_lognormal_mu: f64,
        /// Standard deviation of the logarithm of the views' noise factor.
        pub views_noise_lognormal_sigma: f64,
        /// Number of characters of the post that the inbox shows.
        pub notification_preview_chars: u32 where 0.0..=10_000.0,
        /// Absolute mean reaction above which the inbox describes the reaction as positive or negative.
        pub notification_sentiment_threshold: f64,
        /// Number of groups that the inbox names, at most 3.
        pub notification_top_groups: u32 where 0.0..=3.0,
        /// Minimum number of likes of a comment.
        pub reply_likes_low: u32,
        /// One more than the maximum number of likes of a comment.
        pub reply_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Minimum number of shares of a comment.
        pub reply_shares_low: u32,
        /// One more than the maximum number of shares of a comment.
        pub reply_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Smallest absolute reaction that changes leads.
        pub multiplier_viral_threshold: f64,
        /// Maximum effect of one post on leads.
        pub multiplier_max_boost_per_post: f64,
        /// Half-life of the effect on leads, in days.
        pub multiplier_half_life_days: f64 where POSITIVE..=1e6,
        /// Minimum lead factor of all posts together.
        pub multiplier_min: f64,
        /// Maximum lead factor of all posts together.
        pub multiplier_max: f64,
        /// Lead factor if there are no posts.
        pub multiplier_neutral: f64,
    }

    /// Probability of each sentiment of a post.
    #[derive(Copy)]
    pub struct SentimentChances {
        /// Probability of a positive post.
        pub positive: f64 where 0.0..=1.0,
        /// Probability of a neutral post.
        pub neutral: f64 where 0.0..=1.0,
        /// Probability of a negative post.
        pub negative: f64 where 0.0..=1.0,
    }

    /// Probability of each sentiment of a post by the author's satisfaction band, best band first.
    pub struct SentimentByBand {
        /// Probabilities for authors with a satisfaction of at least `sentiment_band_very_positive_min`.
        pub very_positive: SentimentChances,
        /// Probabilities for authors with a satisfaction of at least `sentiment_band_positive_min`.
        pub positive: SentimentChances,
        /// Probabilities for authors with a satisfaction of at least `sentiment_band_neutral_min`.
        pub neutral: SentimentChances,
        /// Probabilities for authors with a satisfaction of at least `sentiment_band_negative_min`.
        pub negative: SentimentChances,
        /// Probabilities for authors with a satisfaction below `sentiment_band_negative_min`.
        pub very_negative: SentimentChances,
    }
}
