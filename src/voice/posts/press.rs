//! Posts of the market observer about PMI readings, the economy and competitors.

use std::sync::LazyLock;

use crate::grammar::{Chooser, Context, Grammar};
use novamind_world::events::Severity;
use novamind_world::events::{Reading, Trend};

static GRAMMAR: LazyLock<Grammar> = LazyLock::new(|| {
    Grammar::parse(include_str!("../../../assets/voice/press.toml")).expect("the bundled grammars are valid")
});

/// Rule names of the points of view on the economy, indexed by view number.
const ECONOMY_VIEWS: [&str; 11] = [
    "startup_chief",
    "sales",
    "analyst",
    "shop_owner",
    "buyer",
    "freelancer",
    "finance_chief",
    "marketing",
    "supply",
    "adviser",
    "journalist",
];

/// Rule names of the points of view on competitors, indexed by view number.
const COMPETITOR_VIEWS: [&str; 7] =
    ["analyst", "journalist", "watcher", "insider", "investor", "reviewer", "evaluator"];

/// Returns a context for press posts. All values other than `way` and `view` are empty.
fn context(way: &str, view: &str) -> Context {
    let empty = ["trend", "seen", "pmi", "change", "name", "severity", "estimate"];
    let context = Context::default().with("way", way).with("view", view);
    empty.into_iter().fold(context, |context, name| context.with(name, ""))
}

fn trend_direction(trend: Trend) -> &'static str {
    match trend {
        Trend::StrongExpansion | Trend::Expansion => "up",
        Trend::Neutral => "flat",
        Trend::Contraction | Trend::SevereContraction => "down",
    }
}

/// Writes a post about a published PMI reading. Value and change have one decimal.
pub(super) fn write_reading_post(reading: &Reading, choose: Chooser<'_>) -> String {
    let change = match reading.change {
        up if up > 0.0 => format!("up {up:.1} points"),
        down if down < 0.0 => format!("down {:.1} points", down.abs()),
        _ => "a change of 0.0 points".to_owned(),
    };
    let context = context(trend_direction(reading.trend), "")
        .with("trend", reading.trend.id())
        .with("pmi", format!("{:.1}", reading.value))
        .with("change", change);
    GRAMMAR.expand("reading", &context, choose)
}

/// Writes a post about the economy. On average, every second post names today's PMI.
pub(super) fn write_economy_post(trend: Trend, pmi: f64, view: u8, choose: Chooser<'_>) -> String {
    let view = ECONOMY_VIEWS[usize::from(view) % ECONOMY_VIEWS.len()];
    let with_number = choose(2) == 0;
    let seen = format!("{view}.{}", trend_direction(trend));
    let context = context(trend_direction(trend), view)
        .with("seen", seen)
        .with("pmi", format!("{pmi:.1}"))
        .with_tag("number", with_number)
        .with_tag("no_number", !with_number);
    GRAMMAR.expand("economy", &context, choose)
}

/// Writes a post about a competitor event, with the event's name and the author's estimate to four decimals.
pub(super) fn write_competitor_post(
    name: &str,
    view: u8,
    severity: Severity,
    estimate: f64,
    choose: Chooser<'_>,
) -> String {
    let context = context("", COMPETITOR_VIEWS[usize::from(view) % COMPETITOR_VIEWS.len()])
        .with("name", name)
        .with("severity", severity.id())
        .with("estimate", format!("{estimate:.4}"));
    GRAMMAR.expand("rival", &context, choose)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_and_trend_has_a_post() {
        for view in ECONOMY_VIEWS {
            assert!(GRAMMAR.has_rule(&format!("voice.{view}")));
            for way in ["up", "flat", "down"] {
                assert!(GRAMMAR.has_rule(&format!("scene.{view}.{way}")), "{view} {way}");
                let context = context(way, view).with("seen", format!("{view}.{way}"));
                for number in [true, false] {
                    let context = context.clone().with_tag("number", number).with_tag("no_number", !number);
                    let phrasings = GRAMMAR.count_phrasings("economy", &context);
                    assert!(phrasings >= 30, "{view} {way} {number}: {phrasings}");
                }
            }
        }
        for view in COMPETITOR_VIEWS {
            assert!(GRAMMAR.has_rule(&format!("look.{view}")) && GRAMMAR.has_rule(&format!("number.{view}")));
            for severity in ["minor", "moderate", "major", "transformative"] {
                assert!(
                    GRAMMAR.has_rule(&format!("news.{severity}"))
                        && GRAMMAR.has_rule(&format!("verdict.{severity}"))
                );
                let phrasings =
                    GRAMMAR.count_phrasings("rival", &context("", view).with("severity", severity));
                assert!(phrasings >= 30, "{view} {severity}: {phrasings}");
            }
        }
        for trend in ["strong_expansion", "expansion", "neutral", "contraction", "severe_contraction"] {
            assert!(
                GRAMMAR.has_rule(&format!("headline.{trend}"))
                    && GRAMMAR.has_rule(&format!("comment.{trend}"))
            );
            assert!(
                GRAMMAR.count_phrasings("reading", &context("up", "").with("trend", trend)) >= 30,
                "{trend}"
            );
        }
    }

    #[test]
    fn press_posts_contain_their_figures() {
        let mut state = 3u64;
        let mut choose = |count: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % count
        };
        let economy = novamind_world::params::Params::bundled().economy;
        let mut with_number = 0;
        for round in 0..400u32 {
            let estimate = 0.0131 + f64::from(round) / 3000.0;
            let text =
                write_competitor_post("CloudPeak", (round % 7) as u8, Severity::Major, estimate, &mut choose);
            assert!(text.contains(&format!("{estimate:.4}")) && text.contains("CloudPeak"), "{text}");
            assert!(
                text.contains("estimate")
                    || text.contains("suggest")
                    || text.contains("guess")
                    || text.contains("model")
                    || text.contains("scale"),
                "{text}"
            );
            let pmi = 36.0 + f64::from(round % 28);
            let text =
                write_economy_post(Trend::from_index(pmi, &economy), pmi, (round % 11) as u8, &mut choose);
            with_number += u32::from(text.contains(&format!("{pmi:.1}")));
            let reading = Reading {
                measured_day: 1,
                value: pmi,
                change: f64::from(round % 5) - 2.0,
                trend: Trend::from_index(pmi, &economy),
                phase: novamind_world::events::Phase::Peak,
            };
            let text = write_reading_post(&reading, &mut choose);
            let change = format!("{:.1}", reading.change.abs());
            assert!(text.contains(&format!("{pmi:.1}")) && text.contains(&change), "{text}");
        }
        assert!((150..=250).contains(&with_number), "{with_number}");
    }
}
