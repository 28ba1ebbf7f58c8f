//! The inbox: one line per notice (chapter 60 §6).

use crate::notation::grouped;
use crate::world::events::{Notice, Reaction};
use crate::world::params::CeoPosts;

/// Text of a notice.
pub fn notice(notice: &Notice) -> String {
    match notice {
        Notice::EnterpriseLead => {
            "A company asks for an offer. It waits seven days for an answer.".to_owned()
        }
        Notice::LeadLostByTimeout { days } => {
            format!("A company that asked for an offer got no answer for {days} days and has turned away.")
        }
        Notice::ResearchComplete { tier, number } => format!("R&D complete: t{tier}_{number}"),
        Notice::EconomyUpdate(reading) => {
            let arrow = match reading.change {
                change if change > 0.0 => '\u{2191}',
                change if change < 0.0 => '\u{2193}',
                _ => '\u{2192}',
            };
            let trend = reading.trend.id().replace('_', " ");
            format!("Purchasing managers' index {:.1} {arrow} ({trend})", reading.value)
        }
        // Whoever knows the text of the post uses `reaction_to` instead.
        Notice::OwnPostSeen(reaction) => format!("Your post was seen {} times", reaction.views),
    }
}

/// Text of the notice about a post of the player: views, its beginning, tone, strongest reactions.
pub fn reaction_to(content: &str, reaction: &Reaction, law: &CeoPosts) -> String {
    let shown = law.notification_preview_chars as usize;
    let mut preview: String = content.chars().take(shown).collect();
    if content.chars().count() > shown {
        preview.push_str("...");
    }
    let tone = match reaction.mean {
        mean if mean > law.notification_sentiment_threshold => "positive",
        mean if mean < -law.notification_sentiment_threshold => "negative",
        _ => "neutral",
    };
    let strongest: Vec<String> = reaction
        .strongest
        .iter()
        .flatten()
        .map(|(group, effect)| {
            // A reaction that rounds to nothing carries no sign.
            let effect = if effect.abs() < 0.05 { 0.0 } else { *effect };
            format!("{group} {effect:+.1}")
        })
        .collect();
    let views = grouped(reaction.views as f64, 0);
    format!(
        "Your post was seen {views} times: \"{preview}\". Reaction {tone}; strongest {}",
        strongest.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::market::economy::{Phase, Reading, Trend};

    #[test]
    fn readings_show_value_direction_and_band() {
        let reading = Reading {
            measured_day: 1,
            value: 48.3,
            change: -0.6,
            trend: Trend::Neutral,
            phase: Phase::Declining,
        };
        assert_eq!(
            notice(&Notice::EconomyUpdate(reading)),
            "Purchasing managers' index 48.3 \u{2193} (neutral)"
        );
    }

    #[test]
    fn a_reaction_names_views_beginning_tone_and_groups() {
        let law = crate::world::params::Params::shipped().ceo_posts;
        let group = |id| crate::world::identifiers::Group::parse(id).expect("a group");
        let strongest = [Some((group("S3"), 0.87)), Some((group("S1"), -0.45)), Some((group("E1"), 0.02))];
        let mut reaction = Reaction { post: 1, views: 1840, mean: 0.2, strongest };
        assert_eq!(
            reaction_to("Quotas doubled.", &reaction, &law),
            "Your post was seen 1,840 times: \"Quotas doubled.\". Reaction positive; strongest S3 +0.9, S1 -0.5, E1 +0.0"
        );
        reaction.mean = -0.11;
        let long = reaction_to(&"ü".repeat(81), &reaction, &law);
        assert!(long.contains(&format!("\"{}...\"", "ü".repeat(80))) && long.contains("negative"), "{long}");
    }
}
