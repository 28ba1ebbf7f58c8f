//! Features of a post that do not depend on the reader (docs/mechanics/market/social/judge.md#features).

use super::lexicon::{Features as FeatureWeights, Lexicon};
use super::text::{TokenizedText, WordPattern, is_emoji};

/// Features of a post that do not depend on the reader.
#[derive(Debug, Clone)]
pub struct Features {
    /// The tokenized text of the post.
    pub text: TokenizedText,
    /// Strength of each topic, 0..=1, in the topic order of the lexicon.
    pub topics: Vec<f64>,
    /// Count of numbers and amounts of money.
    pub numbers: u32,
    /// Specificity of the post, 0..=1.
    pub specificity: f64,
    /// Amount of exaggerated promises, 0..=1.
    pub absolutes: f64,
    /// Amount of advertising language, 0..=1.
    pub buzzwords: f64,
    /// Casualness of the style, 0..=1.
    pub casual: f64,
    /// Amount of technical language, 0..=1.
    pub technical: f64,
    /// Whether the post apologizes.
    pub has_apology: bool,
    /// Whether the post names a cause.
    pub names_cause: bool,
    /// Whether the post names a remedy.
    pub names_remedy: bool,
    /// Whether the post names a time or a number.
    pub names_time: bool,
    /// Number of high-pressure sales phrases, 0..=3.
    pub sales_pressure: f64,
    /// Whether the post blames the reader.
    pub defensive: bool,
    /// Whether the post contains misconduct, such as insults.
    pub has_misconduct: bool,
    /// Whether the post disparages competitors.
    pub attacks_competitors: bool,
    /// Whether the post addresses the reader.
    pub addresses_reader: bool,
    /// Degree of keyword stuffing; 0 is none.
    pub keyword_stuffing: f64,
    /// Whether the post is too short to be judged.
    pub is_empty: bool,
}

impl Features {
    /// Extracts the features of a post.
    pub fn from_post(content: &str, lexicon: &Lexicon) -> Features {
        let (weights, words) = (&lexicon.features, &lexicon.words);
        let reading = TokenizedText::new(content);
        let strength = |list: &Vec<WordPattern>| match reading.count_matches(list) {
            0 => 0.0,
            count => (weights.topic_first + weights.topic_more * f64::from(count - 1)).min(1.0),
        };
        let topics: Vec<f64> = lexicon.topics.values().map(strength).collect();
        let hit = topics.iter().filter(|strength| **strength > 0.0).count() as u32;
        let numbers = reading.count_numbers();
        let (action, time) = (reading.contains_any(&words.actions), reading.contains_any(&words.times));
        let specific = weights.number * f64::from(numbers.min(weights.numbers_counted))
            + weights.action * indicator(action)
            + weights.time * indicator(time)
            + weights.topic_hit * f64::from(hit.min(weights.topics_counted));
        let share = |each: f64, list| (each * f64::from(reading.count_matches(list))).min(1.0);
        Features {
            specificity: specific.min(1.0),
            absolutes: share(weights.absolute, &words.absolutes),
            buzzwords: share(weights.buzzword, &words.buzzwords),
            casual: casualness(content, reading.count_matches(&words.slang), weights),
            technical: (weights.tech_term * f64::from(reading.count_matches(&words.tech))
                + weights.tech_unit * indicator(has_unit(reading.normalized(), &weights.units)))
            .min(1.0),
            has_apology: reading.contains_any(&words.apology),
            names_cause: reading.contains_any(&words.cause),
            names_remedy: reading.contains_any(&words.remedy),
            names_time: time || numbers > 0,
            sales_pressure: f64::from(reading.count_matches(&words.hard_sell).min(weights.sell_counted)),
            defensive: reading.contains_any(&words.defensive),
            has_misconduct: reading.contains_any(&words.conduct),
            attacks_competitors: reading.contains_any(&words.rivals) && reading.contains_any(&words.negative),
            addresses_reader: reading.contains_any(&words.you),
            keyword_stuffing: keyword_stuffing(&reading, lexicon),
            is_empty: hit == 0 && numbers == 0 && reading.tokens().len() < weights.least_tokens,
            numbers,
            topics,
            text: reading,
        }
    }

    /// Returns whether the post mentions the topic with this index.
    pub fn mentions_topic(&self, topic: usize) -> bool {
        self.topics[topic] > 0.0
    }
}

pub(super) fn indicator(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

fn casualness(content: &str, slang: u32, features: &FeatureWeights) -> f64 {
    let count =
        |matches_kind: &dyn Fn(char) -> bool| content.chars().filter(|c| matches_kind(*c)).count() as u32;
    let signs = |each: f64, count: u32| each * f64::from(count.min(features.signs_counted));
    let shouted = content.split(|c: char| !c.is_alphanumeric()).filter(|word| {
        word.chars().count() >= features.capitals_letters && word.chars().all(|c| c.is_uppercase())
    });
    let total = signs(features.emoji, count(&is_emoji))
        + signs(features.hash, count(&|c| c == '#'))
        + signs(features.exclamation, count(&|c| c == '!'))
        + features.slang * f64::from(slang)
        + features.capitals * f64::from((shouted.count() as u32).min(features.capitals_counted));
    total.min(1.0)
}

/// Returns whether the text contains a digit followed by one of the units.
fn has_unit(normal: &str, units: &[String]) -> bool {
    normal.char_indices().any(|(at, character)| {
        let rest = normal[at + character.len_utf8()..].trim_start_matches(' ');
        character.is_ascii_digit() && units.iter().any(|unit| rest.starts_with(unit.as_str()))
    })
}

/// Returns the degree of keyword stuffing: topic words above a threshold share, plus a penalty for too few function
/// words.
fn keyword_stuffing(reading: &TokenizedText, lexicon: &Lexicon) -> f64 {
    let features = &lexicon.features;
    let tokens = reading.tokens().len();
    if tokens == 0 {
        return 0.0;
    }
    let mut covered = vec![false; tokens];
    for list in lexicon.topics.values() {
        for (is_covered, more) in covered.iter_mut().zip(reading.covered_tokens(list)) {
            *is_covered |= more;
        }
    }
    let functions = reading.covered_tokens(&lexicon.words.function);
    let plain = functions.iter().zip(&covered).filter(|(function, covered)| **function && !**covered);
    let density = covered.iter().filter(|covered| **covered).count() as f64 / tokens as f64;
    let function_share = plain.count() as f64 / tokens as f64;
    let piled =
        features.stuffing * ((density - features.stuffing_from) / (1.0 - features.stuffing_from)).max(0.0);
    let no_sentence = function_share < features.function_share && tokens >= features.sentence_tokens;
    piled + features.stuffing_no_sentence * indicator(no_sentence)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn features(content: &str) -> Features {
        Features::from_post(content, Lexicon::bundled())
    }

    #[test]
    fn a_technical_announcement_is_specific_and_technical() {
        let announcement = features(
            "API update: quotas doubled to 200k tokens/day on plan B, batch endpoint p95 at 190 ms.",
        );
        assert_eq!((announcement.specificity, announcement.technical, announcement.casual), (1.0, 1.0, 0.0));
        let plain = features("Quotas doubled.");
        assert!((plain.specificity - 0.275).abs() < 1e-12, "{}", plain.specificity);
        let lexicon = Lexicon::bundled();
        assert!(
            announcement.mentions_topic(lexicon.topic_index("api"))
                && announcement.mentions_topic(lexicon.topic_index("limits"))
        );
        assert!(!announcement.mentions_topic(lexicon.topic_index("deal")) && !announcement.is_empty);
    }

    #[test]
    fn capitals_exclamations_and_emoji_count_as_casual() {
        let capitals = features("The BEST AI tool ever!!! \u{1F680}\u{1F680}");
        assert!((capitals.casual - (0.5 + 0.45 + 0.2f64).min(1.0)).abs() < 1e-12);
        assert!((capitals.absolutes - 0.35).abs() < 1e-12);
    }

    #[test]
    fn keyword_stuffing_is_detected() {
        let pile = features(
            "API SDK webhooks limits quota latency p95 tokens batch docs benchmarks 200k tokens today shipped",
        );
        assert!(
            (pile.keyword_stuffing - (0.5 * (13.0 / 15.0 - 0.5) / 0.5 + 0.25)).abs() < 1e-12,
            "{}",
            pile.keyword_stuffing
        );
        assert_eq!(features("We are glad that you are here with us today.").keyword_stuffing, 0.0);
        assert!(features("Good morning!").is_empty && !features("Good morning, 3 days left").is_empty);
        assert_eq!(features("").keyword_stuffing, 0.0);
    }
}
