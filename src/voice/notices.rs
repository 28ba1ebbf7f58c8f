//! One-line texts of inbox notices.

use novamind_base::formatting::grouped_number;
use novamind_world::events::{Notice, Reaction};
use novamind_world::identifiers::Group;
use novamind_world::params::CeoPosts;

/// The enterprise that a notice concerns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoticeCustomer {
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Group of the enterprise.
    pub group: Group,
    /// Number of seats of the enterprise, in whole seats.
    pub seats: u32,
}

impl NoticeCustomer {
    fn describe(&self) -> String {
        let noun = if self.seats == 1 { "seat" } else { "seats" };
        format!(
            "Customer {} ({}, {} {noun})",
            self.customer,
            self.group,
            grouped_number(f64::from(self.seats), 0)
        )
    }
}

/// Returns the text of a notice. The text names the enterprise if `party` is `Some`.
pub fn notice_text(notice: &Notice, party: Option<NoticeCustomer>) -> String {
    let who = party.map_or("A company".to_owned(), |party| party.describe());
    match notice {
        Notice::EnterpriseLead => format!("{who} asks for an offer. It waits seven days for an answer."),
        Notice::LeadLostByTimeout { days } => {
            format!("{who} got no answer for {days} days. The lead is lost.")
        }
        // The database writes this text, because one notice covers several days.
        Notice::LeadLossRepeated { .. } => String::new(),
        Notice::LeadSilent => format!("{who} declines and answers no more. The lead is lost."),
        Notice::CounterOffer { customer } => format!("Customer {customer} answers with a price of its own."),
        Notice::ChurnThreat { customer } => format!(
            "Customer {customer} threatens to leave and pays nothing until this is settled. It waits seven days for an answer."
        ),
        Notice::PlanChangeRequest { customer, upgrade } => {
            let direction = if *upgrade { "higher" } else { "lower" };
            format!(
                "Customer {customer} asks for the price of a {direction} plan. It waits seven days for an answer."
            )
        }
        Notice::DealWon { price } => format!("{who} accepts: a deal at ${price:.2} a seat and month."),
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
        Notice::GroupFound { group, attempt } => {
            format!("Market research found group {group} (attempt {attempt}). It is known at level 1.")
        }
        Notice::StudyComplete { study, noise } => {
            let (group, level, day) = (study.group, study.target, study.due_day);
            let what = if study.is_refresh() { "refreshed" } else { "raised" };
            let accuracy = noise * 100.0;
            format!(
                "Study of group {group} complete: level {level}, \u{b1}{accuracy:.0}% (day {day}, {what})"
            )
        }
        // Callers that have the text of the post call `reaction_text` or `views_text` instead.
        Notice::OwnPostSeen(reaction) => {
            format!("Your post was seen {} {}", reaction.views, times_noun(reaction.views))
        }
    }
}

/// Returns the start of a post, with an ellipsis if the post is longer.
fn preview(content: &str, posts: &CeoPosts) -> String {
    let shown = posts.notification_preview_chars as usize;
    let mut preview: String = content.chars().take(shown).collect();
    if content.chars().count() > shown {
        preview.push_str("...");
    }
    preview
}

/// Returns the release 2 text of the notice about a post of the player: views and start of the post.
pub fn views_text(content: &str, views: u64, posts: &CeoPosts) -> String {
    let (views, preview) = (grouped_number(views as f64, 0), preview(content, posts));
    format!(
        "Your post received {views} views: \"{preview}\". The comments of customers show the public reaction."
    )
}

/// Returns the text of the notice about a post of the player: views, start of the post, tone of the reaction, and
/// strongest reactions by group.
pub fn reaction_text(content: &str, reaction: &Reaction, posts: &CeoPosts) -> String {
    let preview = preview(content, posts);
    let tone = match reaction.mean {
        mean if mean > posts.notification_sentiment_threshold => "positive",
        mean if mean < -posts.notification_sentiment_threshold => "negative",
        _ => "neutral",
    };
    let strongest: Vec<String> = reaction
        .strongest
        .iter()
        .flatten()
        .map(|(group, effect)| {
            // An effect that rounds to zero has no sign.
            let effect = if effect.abs() < 0.05 { 0.0 } else { *effect };
            format!("{group} {effect:+.1}")
        })
        .collect();
    let views = grouped_number(reaction.views as f64, 0);
    format!(
        "Your post was seen {views} {}: \"{preview}\". Reaction {tone}; strongest {}",
        times_noun(reaction.views),
        strongest.join(", ")
    )
}

fn times_noun(count: u64) -> &'static str {
    if count == 1 { "time" } else { "times" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_world::events::{Phase, Reading, Trend};

    #[test]
    fn study_and_discovery_notices_name_group_level_and_accuracy() {
        let group = novamind_world::identifiers::Group::parse("D_S06").expect("a group");
        let found = notice_text(&Notice::GroupFound { group, attempt: 4 }, None);
        assert_eq!(found, "Market research found group D_S06 (attempt 4). It is known at level 1.");
        for (before, words) in [(1, "raised"), (2, "refreshed")] {
            let study = novamind_world::events::Study { group, target: 2, before, due_day: 31 };
            let text = notice_text(&Notice::StudyComplete { study, noise: 0.4 }, None);
            assert_eq!(text, format!("Study of group D_S06 complete: level 2, \u{b1}40% (day 31, {words})"));
        }
    }

    #[test]
    fn negotiation_notices_name_the_enterprise_if_it_is_known() {
        let leave = notice_text(&Notice::ChurnThreat { customer: 7 }, None);
        assert!(leave.starts_with("Customer 7 threatens to leave"), "{leave}");
        let up = notice_text(&Notice::PlanChangeRequest { customer: 9, upgrade: true }, None);
        let down = notice_text(&Notice::PlanChangeRequest { customer: 9, upgrade: false }, None);
        assert!(up.contains("Customer 9") && up.contains("higher") && down.contains("lower"));
        assert!(notice_text(&Notice::CounterOffer { customer: 12 }, None).contains("Customer 12"));
        let group = novamind_world::identifiers::Group::parse("E2").expect("a group");
        let party = Some(NoticeCustomer { customer: 4711, group, seats: 1_094 });
        assert_eq!(
            notice_text(&Notice::DealWon { price: 33.5 }, party),
            "Customer 4711 (E2, 1,094 seats) accepts: a deal at $33.50 a seat and month."
        );
        let unanswered = notice_text(&Notice::LeadLostByTimeout { days: 7 }, party);
        assert_eq!(unanswered, "Customer 4711 (E2, 1,094 seats) got no answer for 7 days. The lead is lost.");
        assert!(
            notice_text(&Notice::LeadSilent, party).starts_with("Customer 4711 (E2, 1,094 seats) declines")
        );
        assert!(!notice_text(&Notice::LeadSilent, None).contains(char::is_numeric));
    }

    #[test]
    fn reading_notices_show_value_direction_and_trend() {
        let reading = Reading {
            measured_day: 1,
            value: 48.3,
            change: -0.6,
            trend: Trend::Neutral,
            phase: Phase::Declining,
        };
        assert_eq!(
            notice_text(&Notice::EconomyUpdate(reading), None),
            "Purchasing managers' index 48.3 \u{2193} (neutral)"
        );
    }

    #[test]
    fn reaction_text_contains_views_preview_tone_and_groups() {
        let posts = novamind_world::params::Params::bundled().ceo_posts;
        let group = |id| novamind_world::identifiers::Group::parse(id).expect("a group");
        let strongest = [Some((group("S3"), 0.87)), Some((group("S1"), -0.45)), Some((group("E1"), 0.02))];
        let mut reaction = Reaction { post: 1, views: 1840, mean: 0.2, strongest };
        assert_eq!(
            reaction_text("Quotas doubled.", &reaction, &posts),
            "Your post was seen 1,840 times: \"Quotas doubled.\". Reaction positive; strongest S3 +0.9, S1 -0.5, E1 +0.0"
        );
        (reaction.mean, reaction.views) = (-0.11, 1);
        let long = reaction_text(&"ü".repeat(81), &reaction, &posts);
        assert!(long.starts_with("Your post was seen 1 time: "), "{long}");
        assert!(long.contains(&format!("\"{}...\"", "ü".repeat(80))) && long.contains("negative"), "{long}");
    }

    #[test]
    fn views_text_contains_only_views_and_preview() {
        let posts = novamind_world::params::Params::bundled().ceo_posts;
        assert_eq!(
            views_text("Quotas doubled.", 1840, &posts),
            "Your post received 1,840 views: \"Quotas doubled.\". The comments of customers show the public reaction."
        );
        let long = views_text(&"ü".repeat(81), 1_234_567, &posts);
        let start = format!("Your post received 1,234,567 views: \"{}...\". ", "ü".repeat(80));
        assert!(long.starts_with(&start), "{long}");
        assert!(views_text(&"ü".repeat(80), 1, &posts).contains(&format!("\"{}\"", "ü".repeat(80))));
    }
}
