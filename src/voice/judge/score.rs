//! The reaction score of one group (docs/mechanics/market/social/judge.md#terms).

use super::claims::{Claim, evaluate_claims};
use super::context::LiveEvent;
use super::features::{Features, indicator};
use super::lexicon::Profile;
use super::{Judgement, ScoreTerm, SharedPostData};
use novamind_world::identifiers::Group;

/// A post with the data that one group needs to judge it.
struct GroupJudge<'a> {
    group: Group,
    case: &'a SharedPostData<'a>,
    profile: &'a Profile,
    claims: Vec<Claim>,
}

pub(super) fn judge_group(group: Group, case: &SharedPostData<'_>) -> Judgement {
    let lexicon = case.lexicon;
    if case.features.is_empty {
        return Judgement { group, effect: 0.0, terms: Vec::new(), model_reason: None };
    }
    let readers = &case.context.groups[group];
    let claims = evaluate_claims(&case.features, readers, case.context, lexicon);
    let group_judge = GroupJudge { group, case, profile: lexicon.profile(group), claims };
    let terms = group_judge.terms();
    let mut raw = group_judge.profile.k * terms.iter().map(|term| term.value).sum::<f64>();
    if let Some((_, original)) = &case.original
        && original.group != Some(group)
    {
        raw *= lexicon.terms.elsewhere;
    }
    Judgement { group, effect: compress(raw, lexicon.terms.knee), terms, model_reason: None }
}

/// Compresses a score into -1..=1 and rounds it to hundredths. Absolute values above `knee` approach 1.
fn compress(raw: f64, knee: f64) -> f64 {
    let size = raw.abs();
    let rest = 1.0 - knee;
    let bent = if size > knee { knee + rest * libm::tanh((size - knee) / rest) } else { size };
    let rounded = (100.0 * bent + 0.5).floor() / 100.0;
    if rounded == 0.0 { 0.0 } else { rounded.copysign(raw) }
}

impl GroupJudge<'_> {
    fn terms(&self) -> Vec<ScoreTerm> {
        let weights = &self.case.lexicon.terms;
        let features = &self.case.features;
        let profile = self.profile;
        let (fit, topics) = self.topic_fit();
        let (timing, event) = self.timing();
        let technical = self.has_numeric_comparison();
        let contradicted = self.claim_names(Some(false));
        let supported = if contradicted.is_empty() { self.claim_names(Some(true)) } else { Vec::new() };
        let is_spoiled = !contradicted.is_empty()
            || features.defensive
            || features.has_misconduct
            || (features.attacks_competitors && !technical);
        let (unbelieved, hype) =
            (self.false_claim_penalty_share(&contradicted), self.hype_penalty(!supported.is_empty()));
        let bashing = if technical {
            weights.bashing_with_numbers
        } else {
            weights.bashing + weights.bashing_formal * profile.f
        };
        let repeated = (self.case.overlap - weights.repetition_from) / (1.0 - weights.repetition_from);
        let mut terms = vec![
            term("receptive", weights.receptive, Vec::new()),
            reducible_term("topics", weights.topics * fit, is_spoiled, topics, weights.spoil),
            reducible_term(
                "specific",
                weights.specific * features.specificity * fit.max(0.0),
                is_spoiled,
                Vec::new(),
                weights.spoil,
            ),
            reducible_term("tone", weights.tone * self.tone_match(), is_spoiled, Vec::new(), weights.spoil),
            reducible_term("timing", weights.timing * timing, is_spoiled, event, weights.spoil),
            reducible_term(
                "accountable",
                weights.accountable * self.accountability(),
                is_spoiled,
                Vec::new(),
                weights.spoil,
            ),
            term("claims_true", weights.claims_true * indicator(!supported.is_empty()), supported),
            term("claims_false", weights.claims_false * unbelieved, contradicted),
            term("hype", hype, Vec::new()),
            term("hard_sell", self.hard_sell_penalty(), Vec::new()),
            term(
                "conduct",
                (weights.conduct + weights.conduct_formal * profile.f) * indicator(features.has_misconduct),
                Vec::new(),
            ),
            term("bashing", bashing * indicator(features.attacks_competitors), Vec::new()),
            term("stuffing", weights.stuffing * features.keyword_stuffing, Vec::new()),
            term("repetition", weights.repetition * repeated.max(0.0), Vec::new()),
        ];
        terms.extend(self.reply_terms());
        terms.push(term("defensive", weights.defensive * indicator(features.defensive), Vec::new()));
        terms.retain(|term| term.value != 0.0);
        terms
    }

    fn weight(&self, topic: usize) -> f64 {
        self.profile.weight(self.case.lexicon.topic_name(topic))
    }

    /// Returns how well the topics fit the group (-1..=1), and the topics that determine the fit.
    fn topic_fit(&self) -> (f64, Vec<String>) {
        let (lexicon, terms) = (self.case.lexicon, &self.case.lexicon.terms);
        let mut best = self.weighted_topics(&self.case.features);
        best.sort_by(|(_, one), (_, other)| other.abs().total_cmp(&one.abs()));
        best.truncate(terms.ranks.len());
        best.retain(|(_, value)| *value != 0.0);
        let sum: f64 = best.iter().zip(terms.ranks).map(|((_, value), rank)| value * rank).sum();
        let mut fit = sum.clamp(-1.0, 1.0);
        if fit > 0.0 {
            let lead = self.leading_topic(&self.case.features);
            let same = |earlier: &&Features| lead.is_some() && self.leading_topic(earlier) == lead;
            let repeats = self.case.recent.iter().filter(same).count() as u32;
            fit *= 1.0 - terms.repeated_recipe * f64::from(repeats.min(terms.repeated_counted));
        }
        (fit, best.iter().map(|(topic, _)| lexicon.topic_name(*topic).to_owned()).collect())
    }

    /// Returns the product of weight and strength for every topic of a post.
    fn weighted_topics(&self, features: &Features) -> Vec<(usize, f64)> {
        let strengths = features.topics.iter().enumerate();
        strengths.map(|(topic, strength)| (topic, self.weight(topic) * strength)).collect()
    }

    /// Returns the topic with the largest weight times strength, or the first topic on a tie.
    fn leading_topic(&self, features: &Features) -> Option<usize> {
        let mut lead: Option<(usize, f64)> = None;
        for (topic, value) in self.weighted_topics(features) {
            if value != 0.0 && lead.is_none_or(|(_, most)| value.abs() > most) {
                lead = Some((topic, value.abs()));
            }
        }
        lead.map(|(topic, _)| topic)
    }

    /// Returns how well the tone fits the group, -1..=1.
    fn tone_match(&self) -> f64 {
        let (weights, features, profile) = (&self.case.lexicon.terms, &self.case.features, self.profile);
        let casual = weights.casual * (profile.m - weights.casual_neutral) * features.casual;
        let formal = weights.formal * profile.f * (1.0 - features.casual);
        let technical =
            (weights.tech_liked * profile.t - weights.tech_disliked * (1.0 - profile.t)) * features.technical;
        (casual + formal + technical - profile.a * features.buzzwords).clamp(-1.0, 1.0)
    }

    /// Returns how well the post addresses a current event, -0.6..=1, and that event.
    fn timing(&self) -> (f64, Vec<String>) {
        let (features, terms) = (&self.case.features, &self.case.lexicon.terms);
        if let Some(event) = self.ignored_event() {
            let readers = self.case.context.groups[self.group].subscribers;
            let value = if readers > 0 { terms.tone_deaf_customers } else { terms.tone_deaf_others };
            return (value, vec![event.id().to_owned()]);
        }
        let mut best: Option<(LiveEvent, f64)> = None;
        for &(event, age) in &self.case.context.live_events {
            if features.attacks_competitors
                || !self.topics_addressing(event).any(|topic| features.mentions_topic(topic))
            {
                continue;
            }
            let events = &self.case.lexicon.events;
            let share = if age <= events.fresh_days { 1.0 } else { events.stale_share };
            let value = self.salience(event) * share;
            if best.is_none_or(|(_, most)| value > most) {
                best = Some((event, value));
            }
        }
        best.map_or((0.0, Vec::new()), |(event, value)| (value, vec![event.id().to_owned()]))
    }

    /// Returns the recent outage or price increase that a post about a release, deal or price ignores.
    fn ignored_event(&self) -> Option<LiveEvent> {
        let (features, lexicon) = (&self.case.features, self.case.lexicon);
        let is_promotional = ["release", "deal", "price"]
            .iter()
            .any(|topic| features.mentions_topic(lexicon.topic_index(topic)));
        if !is_promotional || features.has_apology {
            return None;
        }
        let answers = [lexicon.topic_index("reliability"), lexicon.topic_index("transparency")];
        let fresh = |event: &LiveEvent| match (event, self.case.context.event_age(*event)) {
            (LiveEvent::Outage, Some(age)) => age <= lexicon.events.fresh_days,
            (_, age) => age.is_some(),
        };
        [LiveEvent::Outage, LiveEvent::PriceUp].into_iter().filter(fresh).find(|event| {
            !self
                .topics_addressing(*event)
                .any(|topic| answers.contains(&topic) && features.mentions_topic(topic))
        })
    }

    fn topics_addressing(&self, event: LiveEvent) -> impl Iterator<Item = usize> {
        let (lexicon, events) = (self.case.lexicon, &self.case.lexicon.events);
        let topics = match event {
            LiveEvent::Outage => &events.outage,
            LiveEvent::PriceUp => &events.price_up,
            LiveEvent::Issues => &events.issues,
            LiveEvent::Quota => &events.quota,
            LiveEvent::Competitor => &events.rival,
            LiveEvent::MacroDown => &events.macro_down,
            LiveEvent::MacroUp => &events.macro_up,
            LiveEvent::Research => &events.research,
        };
        topics.iter().map(|topic| lexicon.topic_index(topic))
    }

    fn salience(&self, event: LiveEvent) -> f64 {
        let weights = &self.case.lexicon.salience;
        let weight = |topic: &str| self.profile.weight(topic);
        match event {
            LiveEvent::Outage if weight("reliability") >= weights.minded => weights.outage_minded,
            LiveEvent::Outage => weights.outage,
            LiveEvent::PriceUp => {
                weights.price_up * weight("price").max(weight("deal")).max(weights.price_up_least)
            }
            LiveEvent::Issues => weights.issues,
            LiveEvent::Quota => weights.quota,
            LiveEvent::Competitor => weights.rival,
            LiveEvent::MacroDown => weights.macro_down,
            LiveEvent::MacroUp => weights.macro_up,
            LiveEvent::Research => weights.research,
        }
    }

    /// Returns to what extent the post takes responsibility for current problems. The value is negative if the post
    /// apologizes although there is no problem.
    fn accountability(&self) -> f64 {
        let (features, terms) = (&self.case.features, &self.case.lexicon.terms);
        let to_answer = [LiveEvent::Outage, LiveEvent::PriceUp, LiveEvent::Issues, LiveEvent::Quota];
        let has_problem = to_answer.into_iter().any(|event| self.case.context.event_age(event).is_some());
        if has_problem && (features.has_apology || features.names_cause) {
            let elements =
                [features.has_apology, features.names_cause, features.names_remedy, features.names_time];
            terms.account_step * elements.into_iter().map(indicator).sum::<f64>()
        } else if features.has_apology && !has_problem {
            terms.needless_apology
        } else {
            0.0
        }
    }

    fn claim_names(&self, verdict: Option<bool>) -> Vec<String> {
        let fitting = self.claims.iter().filter(|claim| claim.verdict == verdict);
        fitting.map(|claim| claim.name.to_owned()).collect()
    }

    /// Returns the share of the penalty for false claims that applies, 0..=1. The share is smaller for a group without
    /// subscribers.
    fn false_claim_penalty_share(&self, contradicted: &[String]) -> f64 {
        let readers = self.case.context.groups[self.group].subscribers;
        match (contradicted.is_empty(), readers > 0) {
            (true, _) => 0.0,
            (false, true) => 1.0,
            (false, false) => self.case.lexicon.terms.false_for_others,
        }
    }

    fn hype_penalty(&self, supported: bool) -> f64 {
        let terms = &self.case.lexicon.terms;
        let share = if supported { terms.hype_if_true } else { 1.0 };
        terms.hype * self.profile.a * self.case.features.absolutes * share
    }

    fn hard_sell_penalty(&self) -> f64 {
        let terms = &self.case.lexicon.terms;
        let welcome = self.profile.weight("deal") >= terms.likes_deals && self.case.context.promotion;
        terms.hard_sell * self.case.features.sales_pressure * if welcome { 0.5 } else { 1.0 }
    }

    /// Returns whether the post contains numbers and the group prefers technical style.
    fn has_numeric_comparison(&self) -> bool {
        self.profile.t >= self.case.lexicon.terms.technical_taste && self.case.features.numbers > 0
    }

    /// Returns the terms for a reply, which depend on the post that the player answers.
    fn reply_terms(&self) -> Vec<ScoreTerm> {
        let (features, terms) = (&self.case.features, &self.case.lexicon.terms);
        let Some((original, original_post)) = &self.case.original else { return Vec::new() };
        let asked: Vec<usize> =
            (0..original.topics.len()).filter(|topic| original.mentions_topic(*topic)).collect();
        let value = asked.iter().filter(|topic| features.mentions_topic(**topic)).count() as f64;
        let share = if asked.is_empty() { 0.0 } else { value / asked.len() as f64 };
        let missed = share == 0.0 && original_post.negative;
        vec![
            term(
                "reply",
                terms.reply_overlap * share + terms.reply_you * indicator(features.addresses_reader),
                Vec::new(),
            ),
            term("reply_misses", terms.reply_misses * indicator(missed), Vec::new()),
        ]
    }
}

fn term(name: &'static str, value: f64, because: Vec<String>) -> ScoreTerm {
    ScoreTerm { name: name.into(), value, because }
}

/// Creates a term. If the post is dishonest or offensive (`is_spoiled`), a positive value is multiplied by `share`.
fn reducible_term(
    name: &'static str,
    value: f64,
    is_spoiled: bool,
    because: Vec<String>,
    share: f64,
) -> ScoreTerm {
    term(name, if is_spoiled && value > 0.0 { value * share } else { value }, because)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_are_compressed_near_the_limits() {
        for (raw, expected) in [
            (0.8992, 0.87),
            (-0.34, -0.34),
            (0.7226, 0.72),
            (5.0, 1.0),
            (-5.0, -1.0),
            (0.004, 0.0),
            (-0.004, 0.0),
        ] {
            assert_eq!(compress(raw, 0.7), expected, "{raw}");
        }
    }
}
