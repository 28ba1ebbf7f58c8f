//! Claims of a post, compared with the experience of its readers (docs/mechanics/market/social/judge.md#claims).

use super::context::{JudgeContext, ReaderGroup};
use super::features::Features;
use super::lexicon::Lexicon;

/// A claim that a post makes, with the verdict of one group of readers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Claim {
    /// Name of the claim, one of `CLAIM_NAMES`.
    pub name: &'static str,
    /// Whether the claim is true, or `None` if the readers do not know.
    pub verdict: Option<bool>,
}

const CLAIM_NAMES: [&str; 6] = ["price_down", "quality_up", "reliability", "speed", "support", "limits"];

/// Returns the claims of a post, each with the verdict of one group of readers.
pub fn evaluate_claims(
    features: &Features,
    readers: &ReaderGroup,
    context: &JudgeContext,
    lexicon: &Lexicon,
) -> Vec<Claim> {
    let reading = &features.text;
    let mut found = Vec::new();
    for name in CLAIM_NAMES {
        let Some(pattern) = lexicon.claims.get(name) else { continue };
        let near = reading.are_near(&pattern.near, &pattern.to, lexicon.verdicts.near_positions);
        if near || reading.contains_any(&pattern.says) {
            let unlimited = name == "limits" && reading.contains_any(&pattern.says);
            let verdict = if unlimited { Some(false) } else { verdict(name, readers, context, lexicon) };
            found.push(Claim { name, verdict });
        }
    }
    if let Some(count) = claimed_audience(reading.normalized()) {
        let max = lexicon.verdicts.scale_slack * f64::from(context.subscribers);
        found.push(Claim { name: "scale", verdict: Some(count <= max) });
    }
    found
}

fn verdict(
    name: &str,
    readers: &ReaderGroup,
    judge_context: &JudgeContext,
    lexicon: &Lexicon,
) -> Option<bool> {
    let verdicts = &lexicon.verdicts;
    match name {
        "price_down" => Some(judge_context.price_cut),
        "quality_up" => {
            let happy = readers.satisfaction >= verdicts.quality_satisfaction;
            if (readers.progress >= verdicts.quality_progress || judge_context.research_done) && happy {
                Some(true)
            } else {
                (readers.progress < 0.0 || !happy).then_some(false)
            }
        }
        "reliability" if judge_context.outage_days >= 1 => Some(false),
        "reliability" => (judge_context.overload < verdicts.reliability_overload).then_some(true),
        "speed" if judge_context.p95_ms <= verdicts.speed_true_ms => Some(true),
        "speed" => (judge_context.p95_ms > verdicts.speed_false_ms).then_some(false),
        "support"
            if judge_context.issue_age <= verdicts.support_true_age
                && judge_context.issue_rate <= verdicts.support_true_rate =>
        {
            Some(true)
        }
        "support" => (judge_context.issue_age > verdicts.support_false_age
            || judge_context.issue_rate > verdicts.support_false_rate)
            .then_some(false),
        "limits" => Some(judge_context.quota_up),
        _ => None,
    }
}

/// Returns the largest number directly before the word customer, user or subscriber. The suffix `k` means a thousand,
/// `m` a million.
fn claimed_audience(normal: &str) -> Option<f64> {
    let words = ["customer", "user", "subscriber"];
    let ends = words.iter().flat_map(|word| normal.match_indices(word)).map(|(at, _)| at);
    ends.filter_map(|end| number_before(&normal[..end])).reduce(f64::max)
}

fn number_before(text: &str) -> Option<f64> {
    let text = text.strip_suffix(' ')?.trim_end_matches([' ', '+']);
    let (text, unit) = match text.as_bytes().last()? {
        b'k' => (&text[..text.len() - 1], 1e3),
        b'm' => (&text[..text.len() - 1], 1e6),
        _ => (text, 1.0),
    };
    let start = text.rfind(|c: char| !(c.is_ascii_digit() || c == ',' || c == '.'));
    let digits = text[start.map_or(0, |at| at + text[at..].chars().next().map_or(1, char::len_utf8))..]
        .replace(',', "");
    digits.parse::<f64>().ok().map(|number| number * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claimed_audience_reads_all_number_forms() {
        for (text, expected) in [
            ("join 12,000 users today", Some(12_000.0)),
            ("over 10k customers", Some(10_000.0)),
            ("1.5m subscribers love us", Some(1.5e6)),
            ("500+ customers and 900 users", Some(900.0)),
            ("our users are great", None),
            ("ü 5 users", Some(5.0)),
            ("users", None),
            ("k users", None),
        ] {
            assert_eq!(claimed_audience(text), expected, "{text}");
        }
    }
}
