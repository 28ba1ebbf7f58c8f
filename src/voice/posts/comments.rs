//! Comments on the player's posts: one or two sentences in the style of a group that give the judge's reason.

use std::borrow::Cow;
use std::sync::LazyLock;

use super::wording::SpeechRegister;
use crate::grammar::{Chooser, Context, Grammar};
use crate::judge::Judgement;
use novamind_world::identifiers::Group;

static GRAMMAR: LazyLock<Grammar> = LazyLock::new(|| {
    Grammar::parse(include_str!("../../../assets/voice/comments.toml"))
        .expect("the bundled grammars are valid")
});

/// Writes a comment by a group. `judgement` supplies the reason for the reaction, if the reason is known.
pub(super) fn write_comment(
    group: Group,
    effect: f64,
    judgement: Option<&Judgement>,
    choose: Chooser<'_>,
) -> String {
    GRAMMAR.expand("comment", &context(group, effect, judgement), choose)
}

fn context(group: Group, effect: f64, judgement: Option<&Judgement>) -> Context {
    let side = if effect > 0.0 { "for" } else { "against" };
    let person = |individual: &'static str, company: &'static str| {
        if group.is_enterprise() { company } else { individual }
    };
    let (reason, subject) = reason(effect, judgement);
    Context::default()
        .with("side", side)
        .with("reason", format!("{side}_{reason}"))
        .with("subject", subject)
        .with("register", SpeechRegister::for_group(Some(group)).id())
        .with("I", person("I", "we"))
        .with("me", person("me", "us"))
        .with("my", person("my", "our"))
}

/// Returns the name of the largest term that has the same sign as the reaction, and the topic of the post.
fn reason(effect: f64, judgement: Option<&Judgement>) -> (Cow<'static, str>, String) {
    let leading = judgement.map(Judgement::terms_by_size).unwrap_or_default();
    let term_named = |name: &str| leading.iter().find(|term| term.name == name);
    let topic = term_named("topics").and_then(|term| term.because.first()).cloned();
    let pulls = leading.iter().find(|term| term.value * effect > 0.0 && term.name != "receptive");
    let Some(term) = pulls else { return ("topics".into(), topic.unwrap_or_default()) };
    let subject = match term.name.as_ref() {
        "claims_true" | "claims_false" => term.because.first().cloned(),
        _ => topic,
    };
    (term.name.clone(), subject.unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::judge::{Lexicon, ScoreTerm};

    #[test]
    fn every_reason_has_a_comment() {
        let good = ["topics", "specific", "tone", "timing", "accountable", "claims_true", "reply"];
        let bad = [
            "topics",
            "tone",
            "timing",
            "accountable",
            "claims_false",
            "hype",
            "hard_sell",
            "conduct",
            "bashing",
            "stuffing",
            "repetition",
            "reply_misses",
            "defensive",
        ];
        for (side, sign, names) in [("for", 1.0, &good[..]), ("against", -1.0, &bad[..])] {
            for name in names {
                assert!(GRAMMAR.has_rule(&format!("opinion.{side}_{name}")), "{side} {name}");
                for group in Group::all() {
                    let term = ScoreTerm {
                        name: (*name).into(),
                        value: 0.4 * sign,
                        because: vec!["api".to_owned()],
                    };
                    let judgement =
                        Judgement { group, effect: 0.7 * sign, terms: vec![term], model_reason: None };
                    let context = context(group, 0.7 * sign, Some(&judgement));
                    let phrasings = GRAMMAR.count_phrasings("comment", &context);
                    assert!(phrasings >= 30, "{side} {name} {group}: {phrasings}");
                }
            }
        }
    }

    #[test]
    fn every_topic_and_claim_has_a_name() {
        let lexicon = Lexicon::bundled();
        for name in lexicon.topics.keys().chain(lexicon.claims.keys()) {
            assert!(GRAMMAR.has_rule(&format!("about.{name}")), "{name}");
        }
        assert!(GRAMMAR.has_rule("about.scale"));
    }

    #[test]
    fn comments_name_the_topic_of_the_post() {
        let group = Group::parse("S3").expect("a group");
        let term = |name: &'static str, value, because: &str| ScoreTerm {
            name: name.into(),
            value,
            because: vec![because.to_owned()],
        };
        let judgement = Judgement {
            group,
            effect: -0.7,
            terms: vec![term("topics", 0.1, "limits"), term("claims_false", -0.55, "speed")],
            model_reason: None,
        };
        assert_eq!(reason(-0.7, Some(&judgement)), ("claims_false".into(), "speed".to_owned()));
        assert_eq!(reason(0.7, Some(&judgement)), ("topics".into(), "limits".to_owned()));
        assert_eq!(reason(0.7, None), ("topics".into(), String::new()));
        let text = write_comment(group, 0.7, Some(&judgement), &mut |_| 0);
        assert!(text.contains("quotas"), "{text}");
    }
}
