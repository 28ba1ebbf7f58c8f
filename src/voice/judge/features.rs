//! Features of a post, the same for every reader (docs/mechanics/market/social/judge.md#features).

use super::lexicon::{Features as Law, Lexicon};
use super::text::{Entry, Reading, is_emoji};

/// Features of a post.
#[derive(Debug, Clone)]
pub struct Features {
    /// The tokenized text.
    pub reading: Reading,
    /// Strength of every topic, 0..=1, in the order of the lexicon.
    pub topics: Vec<f64>,
    /// Number of numbers and amounts of money.
    pub numbers: u32,
    /// Specificity, 0..=1.
    pub specific: f64,
    /// Promises without measure, 0..=1.
    pub absolutes: f64,
    /// Advertising words, 0..=1.
    pub buzzwords: f64,
    /// Casual style, 0..=1.
    pub casual: f64,
    /// Technical style, 0..=1.
    pub technical: f64,
    /// Whether it apologizes.
    pub apology: bool,
    /// Whether it names a cause.
    pub cause: bool,
    /// Whether it names a remedy.
    pub remedy: bool,
    /// Whether it names a time or a number.
    pub when: bool,
    /// Sales pressure, 0..=3.
    pub sell: f64,
    /// Whether it blames the reader.
    pub defensive: bool,
    /// Whether it contains misconduct, such as insults.
    pub conduct: bool,
    /// Whether it disparages competitors.
    pub bash: bool,
    /// Whether it addresses the reader.
    pub you: bool,
    /// Keyword stuffing.
    pub stuffing: f64,
    /// Whether the text is too short to judge.
    pub empty: bool,
}

impl Features {
    /// Extracts the features of a post.
    pub fn of(content: &str, lexicon: &Lexicon) -> Features {
        let (law, words) = (&lexicon.features, &lexicon.words);
        let reading = Reading::of(content);
        let strength = |list: &Vec<Entry>| match reading.count(list) {
            0 => 0.0,
            count => (law.topic_first + law.topic_more * f64::from(count - 1)).min(1.0),
        };
        let topics: Vec<f64> = lexicon.topics.values().map(strength).collect();
        let hit = topics.iter().filter(|strength| **strength > 0.0).count() as u32;
        let numbers = reading.numbers();
        let (action, time) = (reading.any(&words.actions), reading.any(&words.times));
        let specific = law.number * f64::from(numbers.min(law.numbers_counted))
            + law.action * flag(action)
            + law.time * flag(time)
            + law.topic_hit * f64::from(hit.min(law.topics_counted));
        let share = |each: f64, list| (each * f64::from(reading.count(list))).min(1.0);
        Features {
            specific: specific.min(1.0),
            absolutes: share(law.absolute, &words.absolutes),
            buzzwords: share(law.buzzword, &words.buzzwords),
            casual: casual(content, reading.count(&words.slang), law),
            technical: (law.tech_term * f64::from(reading.count(&words.tech))
                + law.tech_unit * flag(has_unit(reading.normal(), &law.units)))
            .min(1.0),
            apology: reading.any(&words.apology),
            cause: reading.any(&words.cause),
            remedy: reading.any(&words.remedy),
            when: time || numbers > 0,
            sell: f64::from(reading.count(&words.hard_sell).min(law.sell_counted)),
            defensive: reading.any(&words.defensive),
            conduct: reading.any(&words.conduct),
            bash: reading.any(&words.rivals) && reading.any(&words.negative),
            you: reading.any(&words.you),
            stuffing: stuffing(&reading, lexicon),
            empty: hit == 0 && numbers == 0 && reading.tokens().len() < law.least_tokens,
            numbers,
            topics,
            reading,
        }
    }

    /// Returns whether the post mentions a topic.
    pub fn hits(&self, topic: usize) -> bool {
        self.topics[topic] > 0.0
    }
}

pub(super) fn flag(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

fn casual(content: &str, slang: u32, law: &Law) -> f64 {
    let count = |of: &dyn Fn(char) -> bool| content.chars().filter(|c| of(*c)).count() as u32;
    let signs = |each: f64, count: u32| each * f64::from(count.min(law.signs_counted));
    let shouted = content.split(|c: char| !c.is_alphanumeric()).filter(|word| {
        word.chars().count() >= law.capitals_letters && word.chars().all(|c| c.is_uppercase())
    });
    let total = signs(law.emoji, count(&is_emoji))
        + signs(law.hash, count(&|c| c == '#'))
        + signs(law.exclamation, count(&|c| c == '!'))
        + law.slang * f64::from(slang)
        + law.capitals * f64::from((shouted.count() as u32).min(law.capitals_counted));
    total.min(1.0)
}

/// Returns whether a digit is followed by one of these units.
fn has_unit(normal: &str, units: &[String]) -> bool {
    normal.char_indices().any(|(at, character)| {
        let rest = normal[at + character.len_utf8()..].trim_start_matches(' ');
        character.is_ascii_digit() && units.iter().any(|unit| rest.starts_with(unit.as_str()))
    })
}

/// Returns the share of topic words beyond one half, plus the lack of function words.
fn stuffing(reading: &Reading, lexicon: &Lexicon) -> f64 {
    let law = &lexicon.features;
    let tokens = reading.tokens().len();
    if tokens == 0 {
        return 0.0;
    }
    let mut covered = vec![false; tokens];
    for list in lexicon.topics.values() {
        for (own, more) in covered.iter_mut().zip(reading.covered(list)) {
            *own |= more;
        }
    }
    let functions = reading.covered(&lexicon.words.function);
    let plain = functions.iter().zip(&covered).filter(|(function, covered)| **function && !**covered);
    let density = covered.iter().filter(|covered| **covered).count() as f64 / tokens as f64;
    let function_share = plain.count() as f64 / tokens as f64;
    let piled = law.stuffing * ((density - law.stuffing_from) / (1.0 - law.stuffing_from)).max(0.0);
    let no_sentence = function_share < law.function_share && tokens >= law.sentence_tokens;
    piled + law.stuffing_no_sentence * flag(no_sentence)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn features(content: &str) -> Features {
        Features::of(content, Lexicon::shipped())
    }

    #[test]
    fn a_technical_announcement_is_specific_and_technical() {
        let own = features(
            "API update: quotas doubled to 200k tokens/day on plan B, batch endpoint p95 at 190 ms.",
        );
        assert_eq!((own.specific, own.technical, own.casual), (1.0, 1.0, 0.0));
        let plain = features("Quotas doubled.");
        assert!((plain.specific - 0.275).abs() < 1e-12, "{}", plain.specific);
        let lexicon = Lexicon::shipped();
        assert!(own.hits(lexicon.topic("api")) && own.hits(lexicon.topic("limits")));
        assert!(!own.hits(lexicon.topic("deal")) && !own.empty);
    }

    #[test]
    fn shouting_signs_and_emoji_are_casual() {
        let own = features("The BEST AI tool ever!!! \u{1F680}\u{1F680}");
        assert!((own.casual - (0.5 + 0.45 + 0.2f64).min(1.0)).abs() < 1e-12);
        assert!((own.absolutes - 0.35).abs() < 1e-12);
    }

    #[test]
    fn piles_of_words_are_seen() {
        let pile = features(
            "API SDK webhooks limits quota latency p95 tokens batch docs benchmarks 200k tokens today shipped",
        );
        assert!(
            (pile.stuffing - (0.5 * (13.0 / 15.0 - 0.5) / 0.5 + 0.25)).abs() < 1e-12,
            "{}",
            pile.stuffing
        );
        assert_eq!(features("We are glad that you are here with us today.").stuffing, 0.0);
        assert!(features("Good morning!").empty && !features("Good morning, 3 days left").empty);
        assert_eq!(features("").stuffing, 0.0);
    }
}
