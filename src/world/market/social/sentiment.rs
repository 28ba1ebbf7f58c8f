//! The tone of a customer's post (docs/mechanics/market/social/sentiment.md).

use crate::events::Sentiment;
use crate::params::{SentimentChances, SocialParams};

/// Returns the probability of each sentiment for an author with the given satisfaction.
pub fn sentiment_chances(satisfaction: f64, params: &SocialParams) -> &SentimentChances {
    match satisfaction {
        s if s >= params.sentiment_band_very_positive_min => &params.sentiment.very_positive,
        s if s >= params.sentiment_band_positive_min => &params.sentiment.positive,
        s if s >= params.sentiment_band_neutral_min => &params.sentiment.neutral,
        s if s >= params.sentiment_band_negative_min => &params.sentiment.negative,
        _ => &params.sentiment.very_negative,
    }
}

/// Returns the sentiment of a post for a uniform draw `u`.
pub fn sentiment(satisfaction: f64, u: f64, params: &SocialParams) -> Sentiment {
    let chances = sentiment_chances(satisfaction, params);
    if u < chances.positive {
        Sentiment::Positive
    } else if u < chances.positive + chances.neutral {
        Sentiment::Neutral
    } else {
        Sentiment::Negative
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    #[test]
    fn sentiment_matches_its_band() {
        let params = Params::bundled().social;
        for (satisfaction, u, expected) in [
            (0.2, 0.69, Sentiment::Positive),
            (0.2, 0.71, Sentiment::Neutral),
            (0.19, 0.69, Sentiment::Neutral),
            (0.0, 0.71, Sentiment::Negative),
            (-0.05, 0.14, Sentiment::Positive),
            (-0.2, 0.41, Sentiment::Negative),
            (-0.21, 0.19, Sentiment::Neutral),
        ] {
            assert_eq!(sentiment(satisfaction, u, &params), expected, "{satisfaction} {u}");
        }
    }
}
