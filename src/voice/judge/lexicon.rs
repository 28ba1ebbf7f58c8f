//! Word lists and weights of the judge: `assets/voice/judge.toml`.

use std::sync::LazyLock;

use indexmap::IndexMap;
use serde::{Deserialize, Deserializer};

use super::text::WordPattern;
use novamind_world::identifiers::Group;

/// A list of word patterns.
pub type PatternList = Vec<WordPattern>;

/// The judge's word lists, weights and group profiles.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lexicon {
    /// Names of the topics in their fixed order. If two topics are equally strong, the first in this order is the
    /// leading topic.
    topic_order: Vec<String>,
    /// Word lists of the topics, in topic order.
    #[serde(deserialize_with = "lists")]
    pub topics: IndexMap<String, PatternList>,
    /// Word lists that do not belong to a topic.
    pub words: Words,
    /// Patterns that detect claims, by claim.
    pub claims: IndexMap<String, ClaimPattern>,
    /// Thresholds that decide whether a claim is true or false.
    pub verdicts: Verdicts,
    /// Thresholds of current events, and the topics that address them.
    pub events: Events,
    /// Importance of each current event to a group.
    pub salience: Salience,
    /// Weights of the words in each feature.
    pub features: Features,
    /// Weights of the features in the score of a group.
    pub terms: Terms,
    /// Preferences of each group.
    profiles: IndexMap<String, Profile>,
}

impl Lexicon {
    /// Returns the bundled lexicon.
    pub fn bundled() -> &'static Lexicon {
        static BUNDLED: LazyLock<Lexicon> = LazyLock::new(|| {
            let text = include_str!("../../../assets/voice/judge.toml");
            let mut read: Lexicon = toml::from_str(text).expect("the bundled word lists are valid");
            let Lexicon { topic_order, topics, .. } = &mut read;
            topics.sort_by_cached_key(|name, _| topic_order.iter().position(|other| other == name));
            read
        });
        &BUNDLED
    }

    /// Returns the preferences of a group.
    pub fn profile(&self, group: Group) -> &Profile {
        &self.profiles[group.id()]
    }

    /// Returns the index of a topic in topic order.
    pub fn topic_index(&self, name: &str) -> usize {
        self.topics.get_index_of(name).expect("the topic is in the bundled lists")
    }

    /// Returns the name of the topic with this index.
    pub fn topic_name(&self, topic: usize) -> &str {
        self.topics.get_index(topic).map_or("", |(name, _)| name)
    }
}

fn lists<'de, D: Deserializer<'de>>(from: D) -> Result<IndexMap<String, PatternList>, D::Error> {
    let texts = IndexMap::<String, Vec<String>>::deserialize(from)?;
    Ok(texts.into_iter().map(|(name, texts)| (name, parse_patterns(&texts))).collect())
}

fn list<'de, D: Deserializer<'de>>(from: D) -> Result<PatternList, D::Error> {
    Ok(parse_patterns(&Vec::<String>::deserialize(from)?))
}

fn anywhere<'de, D: Deserializer<'de>>(from: D) -> Result<PatternList, D::Error> {
    let texts = Vec::<String>::deserialize(from)?;
    // A text with a slash, such as 24/7, is not a token and is searched for in the whole text. Other words match
    // tokens.
    Ok(texts
        .iter()
        .map(|text| if text.contains('/') { WordPattern::phrase(text) } else { WordPattern::parse(text) })
        .collect())
}

fn parse_patterns(texts: &[String]) -> PatternList {
    texts.iter().map(|text| WordPattern::parse(text)).collect()
}

macro_rules! words {
    ($($(#[$doc:meta])* $field:ident,)*) => {
        /// Word lists that do not belong to a topic.
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Words { $($(#[$doc])* #[serde(deserialize_with = "list")] pub $field: PatternList,)* }

        impl Words {
            /// Returns all word lists, from which tests draw words.
            #[cfg(test)]
            pub fn all(&self) -> Vec<&PatternList> {
                vec![$(&self.$field),*]
            }
        }
    };
}

words! {
    /// Words of exaggerated promises.
    absolutes,
    /// Advertising words.
    buzzwords,
    /// Casual words, such as slang and abbreviations.
    slang,
    /// Terms from engineering, such as `api` and `latency`.
    tech,
    /// Words for actions, such as `fixed` and `launched`.
    actions,
    /// Words for points and periods in time, such as `today` and `week`.
    times,
    /// Words of an apology.
    apology,
    /// Words that name a cause.
    cause,
    /// Words that name a remedy.
    remedy,
    /// High-pressure sales phrases.
    hard_sell,
    /// Words that blame the reader.
    defensive,
    /// Words of misconduct, such as insults.
    conduct,
    /// Names of competitors.
    rivals,
    /// Disparaging words.
    negative,
    /// Words that address the reader.
    you,
    /// Function words, such as articles and prepositions.
    function,
}

/// A pattern that detects a claim: a phrase of `says`, or a word of `near` close to a word of `to`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ClaimPattern {
    /// Phrases that make the claim by themselves.
    #[serde(deserialize_with = "anywhere")]
    pub says: PatternList,
    /// Words that make the claim if they are close to a word of `to`.
    #[serde(deserialize_with = "list")]
    pub near: PatternList,
    /// Words that make the claim if they are close to a word of `near`.
    #[serde(deserialize_with = "list")]
    pub to: PatternList,
}

/// Preferences of a group of readers.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Profile {
    /// Preference for formal style, 0..=1.
    pub f: f64,
    /// Preference for technical style, 0..=1.
    pub t: f64,
    /// Aversion to hype, 0..=1.
    pub a: f64,
    /// Tolerance of casual style, 0..=1.
    pub m: f64,
    /// Factor by which the sum of the terms is multiplied.
    pub k: f64,
    /// Weights of topics; other topics have weight 0.
    w: IndexMap<String, f64>,
}

impl Profile {
    /// Returns the weight of a topic for the group.
    pub fn weight(&self, topic: &str) -> f64 {
        self.w.get(topic).copied().unwrap_or(0.0)
    }

    /// Returns the topics that have a weight.
    #[cfg(test)]
    pub fn topics(&self) -> impl Iterator<Item = (&str, f64)> {
        self.w.iter().map(|(topic, weight)| (topic.as_str(), *weight))
    }
}

macro_rules! numbers {
    ($(#[$doc:meta])* $Name:ident { $($(#[$field_doc:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields)]
        #[allow(missing_docs, reason = "the bundled file documents its numbers")]
        pub struct $Name { $($(#[$field_doc])* pub $field: $kind,)* }
    };
}

numbers! {
    /// Thresholds that decide whether a claim is true or false.
    Verdicts {
        near_positions: usize,
        quality_progress: f64,
        quality_satisfaction: f64,
        reliability_overload: f64,
        speed_true_ms: f64,
        speed_false_ms: f64,
        support_true_age: f64,
        support_true_rate: f64,
        support_false_age: f64,
        support_false_rate: f64,
        scale_slack: f64,
    }
}

numbers! {
    /// Thresholds of current events, and the topics that address them.
    Events {
        kept_days: u32,
        fresh_days: u32,
        stale_share: f64,
        price_rise: f64,
        issue_rate: f64,
        issue_age: f64,
        quota_share: f64,
        outage: Vec<String>,
        price_up: Vec<String>,
        issues: Vec<String>,
        quota: Vec<String>,
        rival: Vec<String>,
        macro_down: Vec<String>,
        macro_up: Vec<String>,
        research: Vec<String>,
    }
}

numbers! {
    /// Importance of each current event to a group.
    Salience {
        outage_minded: f64,
        outage: f64,
        minded: f64,
        price_up: f64,
        price_up_least: f64,
        issues: f64,
        quota: f64,
        rival: f64,
        macro_down: f64,
        macro_up: f64,
        research: f64,
    }
}

numbers! {
    /// Weights of the words in each feature.
    Features {
        topic_first: f64,
        topic_more: f64,
        number: f64,
        numbers_counted: u32,
        action: f64,
        time: f64,
        topic_hit: f64,
        topics_counted: u32,
        absolute: f64,
        buzzword: f64,
        emoji: f64,
        hash: f64,
        exclamation: f64,
        signs_counted: u32,
        slang: f64,
        capitals: f64,
        capitals_counted: u32,
        capitals_letters: usize,
        tech_term: f64,
        tech_unit: f64,
        units: Vec<String>,
        sell_counted: u32,
        stuffing_from: f64,
        stuffing: f64,
        stuffing_no_sentence: f64,
        function_share: f64,
        sentence_tokens: usize,
        least_tokens: usize,
    }
}

numbers! {
    /// Weights of the features in the score of a group.
    Terms {
        receptive: f64,
        topics: f64,
        ranks: [f64; 3],
        repeated_recipe: f64,
        repeated_counted: u32,
        recipe_days: u32,
        specific: f64,
        tone: f64,
        casual: f64,
        casual_neutral: f64,
        formal: f64,
        tech_liked: f64,
        tech_disliked: f64,
        timing: f64,
        tone_deaf_customers: f64,
        tone_deaf_others: f64,
        accountable: f64,
        account_step: f64,
        needless_apology: f64,
        claims_true: f64,
        claims_false: f64,
        false_for_others: f64,
        hype: f64,
        hype_if_true: f64,
        hard_sell: f64,
        conduct: f64,
        conduct_formal: f64,
        bashing: f64,
        bashing_formal: f64,
        bashing_with_numbers: f64,
        technical_taste: f64,
        likes_deals: f64,
        stuffing: f64,
        repetition: f64,
        repetition_from: f64,
        repetition_days: u32,
        spoil: f64,
        reply_overlap: f64,
        reply_you: f64,
        reply_misses: f64,
        defensive: f64,
        elsewhere: f64,
        knee: f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_group_has_a_profile_of_known_topics() {
        let lexicon = Lexicon::bundled();
        let topics: Vec<&String> = lexicon.topics.keys().collect();
        assert_eq!(topics, lexicon.topic_order.iter().collect::<Vec<_>>());
        assert_eq!((topics.len(), topics[0].as_str(), topics[23].as_str()), (24, "price", "access"));
        for group in Group::all() {
            let profile = lexicon.profile(group);
            assert!(profile.topics().count() >= 4, "{group}");
            for (topic, weight) in profile.topics() {
                assert!(lexicon.topics.contains_key(topic), "{group}: {topic}");
                assert!((-1.0..=1.0).contains(&weight));
            }
            assert!(
                [profile.f, profile.t, profile.a, profile.m].iter().all(|taste| (0.0..=1.0).contains(taste))
            );
        }
        assert_eq!(lexicon.profiles.len(), Group::COUNT);
    }

    #[test]
    fn events_have_known_topics_and_every_claim_has_patterns() {
        let lexicon = Lexicon::bundled();
        let events = &lexicon.events;
        let lists = [
            &events.outage,
            &events.price_up,
            &events.issues,
            &events.quota,
            &events.rival,
            &events.macro_down,
            &events.macro_up,
            &events.research,
        ];
        assert!(lists.into_iter().flatten().all(|topic| lexicon.topics.contains_key(topic)));
        let claims: Vec<&str> = lexicon.claims.keys().map(String::as_str).collect();
        assert_eq!(claims, ["limits", "price_down", "quality_up", "reliability", "speed", "support"]);
    }
}
