//! Social media: `configs/world/social.toml`.

use super::check::parameters;

parameters! {
    /// Posts of customers.
    pub struct SocialParams {
        /// Customer posts of a posting day.
        pub max_posts_per_day: u32 where 0.0..=1_000.0,
        /// Growth of the weight with the strength of a mood.
        pub weight_abs_satisfaction_coef: f64,
        /// Extra growth with squared bad mood.
        pub weight_negative_satisfaction_sq_coef: f64,
        /// Factor of influencer groups.
        pub weight_influencer_multiplier: f64,
        /// Days for which a customer counts as new.
        pub weight_new_customer_max_days: u32 where 0.0..=100_000.0,
        /// Factor of new customers.
        pub weight_new_customer_multiplier: f64,
        /// Least change of satisfaction that counts.
        pub satisfaction_change_threshold: f64,
        /// Growth of the weight with that change.
        pub weight_satisfaction_change_coef: f64,
        /// Growth of the weight per event of today.
        pub weight_active_event_coef: f64,
        /// Factor of unhappy accounts bound by a contract.
        pub contract_dissatisfaction_reputation_multiplier: f64,
        /// Stands in for a weight that is not finite.
        pub weight_nonfinite_replacement: f64,
        /// Base weight of a cancelled individual.
        pub churn_weight_base: f64,
        /// Growth of it with bad mood.
        pub churn_weight_negative_satisfaction_coef: f64,
        /// Weight per seat of a lost company.
        pub enterprise_churn_weight_base: f64,
        /// Satisfaction recorded for a lost company.
        pub enterprise_churn_event_satisfaction: f64,
        /// Days subscribed of a lost company where nobody knows.
        pub enterprise_churn_event_fallback_days: u32 where 0.0..=100_000.0,
        /// Lower edge of the best band.
        pub sentiment_band_very_positive_min: f64,
        /// Lower edge of the second band.
        pub sentiment_band_positive_min: f64,
        /// Lower edge of the middle band.
        pub sentiment_band_neutral_min: f64,
        /// Lower edge of the fourth band.
        pub sentiment_band_negative_min: f64,
        /// Fewest likes of a company's post.
        pub enterprise_likes_low: u32,
        /// One above the most.
        pub enterprise_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Fewest shares of a company's post.
        pub enterprise_shares_low: u32,
        /// One above the most.
        pub enterprise_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Fewest likes of an individual's post.
        pub individual_likes_low: u32,
        /// One above the most.
        pub individual_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Fewest shares of an individual's post.
        pub individual_shares_low: u32,
        /// One above the most.
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
        /// Chance that a post explodes.
        pub viral_spike_probability: f64,
        /// Then its score grows by this factor,
        pub viral_spike_score_base: f64,
        /// plus a uniform part of this width.
        pub viral_spike_score_range: f64,
        /// Factor of likes of such a post,
        pub viral_spike_likes_base: f64,
        /// plus a uniform part of this width.
        pub viral_spike_likes_range: f64,
        /// Factor of shares of such a post,
        pub viral_spike_shares_base: f64,
        /// plus a uniform part of this width.
        pub viral_spike_shares_range: f64,
        /// Chances of a sentiment by band of satisfaction.
        pub sentiment: SentimentByBand,
    }

    /// Reach and worth of the company's own posts.
    pub struct CeoPosts {
        /// Reactions of at least this size bring comments.
        pub viral_threshold: f64 where POSITIVE..=0.999,
        /// Views of a post in a group without subscribers,
        pub views_base_min: f64,
        /// or this share of the subscribers.
        pub views_base_per_subscriber: f64,
        /// Factor of the views at the threshold.
        pub views_threshold_multiplier: f64,
        /// Factor of the views at a reaction of 1.
        pub views_max_multiplier: f64,
        /// Location of the log-normal chance in views.
        pub views_noise_lognormal_mu: f64,
        /// Its spread.
        pub views_noise_lognormal_sigma: f64,
        /// Characters of the post that the inbox shows.
        pub notification_preview_chars: u32 where 0.0..=10_000.0,
        /// Mean reactions beyond this are called positive or negative.
        pub notification_sentiment_threshold: f64,
        /// Groups that the inbox names, at most 3.
        pub notification_top_groups: u32 where 0.0..=3.0,
        /// Fewest likes of a comment.
        pub reply_likes_low: u32,
        /// One above the most.
        pub reply_likes_high_exclusive: u32 where 1.0..=1e6,
        /// Fewest shares of a comment.
        pub reply_shares_low: u32,
        /// One above the most.
        pub reply_shares_high_exclusive: u32 where 1.0..=1e6,
        /// Reactions below this bring no leads.
        pub multiplier_viral_threshold: f64,
        /// Largest effect of one post on leads.
        pub multiplier_max_boost_per_post: f64,
        /// Days after which the effect is halved.
        pub multiplier_half_life_days: f64 where POSITIVE..=1e6,
        /// Least factor.
        pub multiplier_min: f64,
        /// Largest factor of all posts together.
        pub multiplier_max: f64,
        /// Factor at the neutral index.
        pub multiplier_neutral: f64,
    }

    /// Chances of a post's sentiment.
    #[derive(Copy)]
    pub struct SentimentChances {
        /// Chance of a positive post.
        pub positive: f64 where 0.0..=1.0,
        /// Chance of a neutral post.
        pub neutral: f64 where 0.0..=1.0,
        /// Chance of a negative post.
        pub negative: f64 where 0.0..=1.0,
    }

    /// Chances of a post's sentiment by band of the author's satisfaction, best band first.
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
