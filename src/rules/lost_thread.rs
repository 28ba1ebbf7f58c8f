//! What the record shows about a thread that ended without a deal.
//!
//! An enterprise that declines sends no message (docs/mechanics/enterprise/outcomes.md#silence-of-the-account). The
//! facts follow from the turns of the thread and from the subscription, which every player can query.

use super::thread::{first_plan_in, other_plan_in};
use super::turn::{Turn, format_offer_lines};
use novamind_base::formatting::{dollars_and_cents, percent};
use novamind_session::identifiers::Plan;

/// Name of the parameter for the lowest patience of an enterprise, in turns.
pub const MIN_TURNS_PARAMETER: &str = "customer_generation.max_negotiation_turns_min";

/// Phrases that identify a sentence about alternatives, a budget or a deadline.
const REASON_PHRASES: [&str; 12] = [
    "alternative",
    "vendor",
    "competitor",
    "other options",
    "somebody else",
    "asked others",
    "a switch",
    "compare",
    "budget",
    "beyond our frame",
    "afford",
    "deadline",
];
const MAX_QUOTED_REASONS: usize = 2;

/// The subscription of an enterprise when its thread ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Subscription {
    /// Status of the subscription: `lead`, `subscribed`, `cancelled` or `lost`.
    pub status: String,
    /// Plan of the subscription; `None` if the enterprise never subscribed.
    pub plan: Option<Plan>,
    /// Price of the subscription, in dollars per seat per month.
    pub price: f64,
    /// Day on which the subscription ended or the lead was lost.
    pub end_day: Option<u32>,
}

/// The side that let the thread end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LossCause {
    /// The enterprise did not answer the last offer.
    Declined,
    /// The player did not answer the last message before the deadline.
    Unanswered,
}

/// A thread that ended without a deal, and what the record shows about the reason.
#[derive(Debug, Clone, PartialEq)]
pub struct LostThread {
    /// The side that let the thread end.
    pub cause: LossCause,
    /// What happened, as a sentence without its subject.
    summary: String,
    /// Recorded facts, one sentence each.
    pub facts: Vec<String>,
}

impl LostThread {
    /// Returns how a thread of type `kind` was lost. Returns `None` if the thread ended with a deal or a rejection by
    /// the player, or if the enterprise can still answer. The thread must not be waiting for the player.
    ///
    /// `min_turns` is the lowest patience of an enterprise, in turns. It is `None` in runs whose player may know only
    /// what the tool texts state.
    pub fn from_turns(
        turns: &[Turn],
        kind: &str,
        subscription: &Subscription,
        min_turns: Option<u32>,
    ) -> Option<LostThread> {
        let last = turns.last().filter(|last| last.closing_reason.is_empty())?;
        let is_open = matches!(subscription.status.as_str(), "lead" | "subscribed");
        match last.sender.as_str() {
            "agent" if is_open => None,
            "agent" => Some(declined(turns, last, kind, subscription, min_turns)),
            _ => Some(unanswered(turns, last, kind, subscription)),
        }
    }

    /// Describes the end of the thread in one sentence.
    pub fn describe(&self, enterprise: &str) -> String {
        format!("{enterprise} {}", self.summary)
    }
}

fn unanswered(turns: &[Turn], last: &Turn, kind: &str, subscription: &Subscription) -> LostThread {
    let what = if last.sender == "system" { "its request" } else { "its message" };
    // The recorded end of a subscription can be later than the end of the thread.
    let end = subscription.end_day.filter(|_| kind == "new_lead");
    let end = end.map_or(String::new(), |day| format!(": the thread ended on day {day}"));
    let mut facts: Vec<String> = asked_price(turns)
        .map(|(day, plan, price)| {
            format!("It asked for a price of {} on day {day}.", price_text(plan, price))
        })
        .into_iter()
        .collect();
    facts.extend(quoted_reasons(turns));
    let summary = format!("received no answer from you to {what} of day {}{end}.", last.day);
    LostThread { cause: LossCause::Unanswered, summary, facts }
}

fn declined(
    turns: &[Turn],
    last: &Turn,
    kind: &str,
    subscription: &Subscription,
    min_turns: Option<u32>,
) -> LostThread {
    let end = subscription.end_day.map_or(String::new(), |day| format!(" on day {day}"));
    let offers = format_offer_lines(&last.offers);
    let summary = format!("declined your offer {offers} of day {}{end}, without a message.", last.day);
    let mut facts = vec![price_fact(turns, last)];
    facts.extend(terms_fact(turns, last, kind, subscription));
    facts.extend(quoted_reasons(turns));
    facts.extend(lateness_fact(turns, last));
    let count = turns.iter().filter(|turn| !turn.offers.is_empty()).count();
    let offers =
        if count == 1 { "your only offer".to_owned() } else { format!("the last of your {count} offers") };
    let reason = match (min_turns.filter(|min| last.number < *min), last.offers.as_slice()) {
        (Some(min), [(plan, _)]) => format!(
            "An enterprise has at least {min} turns, so its turns were not used up: no price of plan {plan} was \
             acceptable to it, because it requires more quality."
        ),
        _ => "An enterprise falls silent when its turns are used up, or if no price is acceptable to it. The record does \
              not show which."
            .to_owned(),
    };
    facts.push(format!("It was {offers}, in turn {} of the thread. {reason}", last.number));
    LostThread { cause: LossCause::Declined, summary, facts }
}

/// Returns the last price that the enterprise asked for: day, plan, and dollars per seat per month.
fn asked_price(turns: &[Turn]) -> Option<(u32, Option<Plan>, f64)> {
    let at = turns.iter().rposition(|turn| turn.price.is_some())?;
    let offered = turns[..at].iter().rev().find(|turn| !turn.offers.is_empty());
    let only = offered.and_then(|turn| match turn.offers.as_slice() {
        [(plan, _)] => Some(*plan),
        _ => None,
    });
    Some((turns[at].day, first_plan_in(&turns[at].text).or(only), turns[at].price?))
}

fn price_text(plan: Option<Plan>, price: f64) -> String {
    let plan = plan.map_or(String::new(), |plan| format!(" for plan {plan}"));
    format!("{}{plan}", dollars_and_cents(price))
}

/// Compares the last offer with the price that the enterprise asked for.
fn price_fact(turns: &[Turn], last: &Turn) -> String {
    let Some((day, plan, asked)) = asked_price(turns) else {
        return "It named no price in this thread.".to_owned();
    };
    let lines = last.offers.iter().filter(|(offered, _)| plan.is_none_or(|plan| plan == *offered));
    let lowest = lines.map(|(_, price)| *price).fold(f64::INFINITY, f64::min);
    let compared = match plan {
        Some(plan) if lowest.is_infinite() => format!("Your offer had no plan {plan}."),
        _ if lowest.is_infinite() => String::new(),
        _ if lowest > asked => {
            let more = format!("{} ({})", dollars_and_cents(lowest - asked), percent(lowest / asked - 1.0, 0));
            format!("Your offer was {more} higher.")
        }
        _ => "Your offer was not higher. An enterprise declines the price that it asked for only if its turns are \
              used up, or if it sees less quality than before."
            .to_owned(),
    };
    format!("It asked for a price of {} on day {day}. {compared}", price_text(plan, asked))
        .trim_end()
        .to_owned()
}

/// Compares the last offer with what the enterprise wanted to change about its subscription.
fn terms_fact(turns: &[Turn], last: &Turn, kind: &str, subscription: &Subscription) -> Option<String> {
    let opening = turns.iter().find(|turn| turn.sender == "customer")?;
    match kind {
        "churn_prevention" if subscription.price > 0.0 => {
            let lowest = last.offers.iter().map(|(_, price)| *price).fold(f64::INFINITY, f64::min);
            let paid = price_text(subscription.plan, subscription.price);
            let compared = match subscription.price - lowest {
                less if less > 0.0 => format!("Your lowest price was {} lower.", dollars_and_cents(less)),
                _ => "Your offer was not lower.".to_owned(),
            };
            Some(format!(
                "It threatened on day {} to cancel, because the price was too high for the quality. It paid \
                 {paid}. {compared}",
                opening.day
            ))
        }
        "plan_change" => {
            let wanted = other_plan_in(&opening.text, subscription.plan)?;
            let is_offered = last.offers.iter().any(|(plan, _)| *plan == wanted);
            (!is_offered).then(|| {
                format!("It asked for plan {wanted} on day {}. Your offer had no plan {wanted}.", opening.day)
            })
        }
        _ => None,
    }
}

/// Quotes sentences of the enterprise about alternatives, its budget or a deadline, from the latest message first.
fn quoted_reasons(turns: &[Turn]) -> Vec<String> {
    let messages =
        turns.iter().rev().filter(|turn| turn.sender == "customer" && turn.closing_reason.is_empty());
    let quoted = messages.flat_map(|turn| {
        let gives_reason = |sentence: &&str| {
            let lower = sentence.to_lowercase();
            REASON_PHRASES.iter().any(|word| lower.contains(word))
        };
        let found: Vec<&str> = sentences(&turn.text).into_iter().filter(gives_reason).collect();
        found
            .into_iter()
            .map(|sentence| format!("It wrote on day {}: “{sentence}”", turn.day))
            .collect::<Vec<_>>()
    });
    quoted.take(MAX_QUOTED_REASONS).collect()
}

/// Splits a text after each punctuation mark that is followed by a space, so that a decimal point does not end a
/// sentence.
fn sentences(text: &str) -> Vec<&str> {
    let (mut found, mut start) = (Vec::new(), 0);
    let marks = text.match_indices(['.', '?', '!']).map(|(at, _)| at + 1);
    let marks = marks.filter(|end| text[*end..].starts_with(' '));
    for end in marks.chain([text.len()]) {
        found.push(text[start..end].trim());
        start = end;
    }
    found.retain(|sentence| !sentence.is_empty());
    found
}

/// States how many days the enterprise waited for the last offer, if it waited more than one day.
fn lateness_fact(turns: &[Turn], last: &Turn) -> Option<String> {
    let before = turns.len().checked_sub(2).map(|at| &turns[at]).filter(|turn| turn.sender == "customer")?;
    let days = last.day.saturating_sub(before.day);
    (days > 1).then(|| {
        format!(
            "Your offer came {days} days after its message of day {}. Late answers harm the relationship.",
            before.day
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(number: u32, day: u32, sender: &str) -> Turn {
        Turn {
            number,
            sender: sender.to_owned(),
            text: String::new(),
            offers: Vec::new(),
            price: None,
            day,
            closing_reason: String::new(),
        }
    }

    fn offer(number: u32, day: u32, plan: Plan, price: f64) -> Turn {
        Turn { offers: vec![(plan, price)], ..turn(number, day, "agent") }
    }

    fn ask(number: u32, day: u32, text: &str, price: f64) -> Turn {
        Turn { text: text.to_owned(), price: Some(price), ..turn(number, day, "customer") }
    }

    fn lost(end_day: u32) -> Subscription {
        Subscription { status: "lost".to_owned(), end_day: Some(end_day), ..Subscription::default() }
    }

    const COUNTER: &str = "We compared your proposal with our budget. We need $20.00 a seat for plan B.";

    fn facts(turns: &[Turn], kind: &str, subscription: &Subscription) -> (LossCause, String) {
        let lost = LostThread::from_turns(turns, kind, subscription, Some(2)).expect("a lost thread");
        (lost.cause, format!("{}\n{}", lost.describe("Acme #7"), lost.facts.join("\n")))
    }

    #[test]
    fn decline_compares_the_offer_with_the_asked_price() {
        let mut turns = vec![turn(0, 8, "system"), offer(1, 14, Plan::B, 30.0), ask(2, 18, COUNTER, 20.0)];
        turns.push(offer(3, 21, Plan::B, 25.0));
        let (cause, text) = facts(&turns, "new_lead", &lost(26));
        assert_eq!(cause, LossCause::Declined);
        for part in [
            "Acme #7 declined your offer B $25.00 of day 21 on day 26, without a message.",
            "It asked for a price of $20.00 for plan B on day 18. Your offer was $5.00 (25%) higher.",
            "It wrote on day 18: “We compared your proposal with our budget.”",
            "Your offer came 3 days after its message of day 18.",
            "the last of your 2 offers, in turn 3",
        ] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        turns[3] = offer(3, 21, Plan::B, 20.0);
        assert!(facts(&turns, "new_lead", &lost(26)).1.contains("Your offer was not higher."));
        turns[3] = offer(3, 21, Plan::C, 5.0);
        assert!(facts(&turns, "new_lead", &lost(26)).1.contains("Your offer had no plan B."));
        let (_, first) = facts(&turns[..2], "new_lead", &lost(20));
        assert!(
            first.contains("It named no price in this thread.") && first.contains("your only offer"),
            "{first}"
        );
        assert!(first.contains("no price of plan B was acceptable to it"), "{first}");
        let hidden = LostThread::from_turns(&turns[..2], "new_lead", &lost(20), None).expect("a lost thread");
        assert!(hidden.facts.concat().contains("does not show which"), "{hidden:?}");
    }

    #[test]
    fn decline_of_a_subscriber_compares_the_offer_with_its_terms() {
        let text = |words: &str| Turn { text: words.to_owned(), ..turn(1, 40, "customer") };
        let subscriber = Subscription {
            status: "cancelled".to_owned(),
            plan: Some(Plan::B),
            price: 40.0,
            end_day: Some(50),
        };
        let threat = text("A frank word. For this price we have asked others for quotes.");
        let mut turns = vec![turn(0, 40, "system"), threat, offer(2, 42, Plan::B, 40.0)];
        let (_, words) = facts(&turns, "churn_prevention", &subscriber);
        assert!(words.contains("It paid $40.00 for plan B. Your offer was not lower."), "{words}");
        assert!(
            words.contains("It wrote on day 40: “For this price we have asked others for quotes.”"),
            "{words}"
        );
        turns[2] = offer(2, 42, Plan::B, 30.0);
        assert!(
            facts(&turns, "churn_prevention", &subscriber).1.contains("Your lowest price was $10.00 lower.")
        );
        turns[1] = text("Could we bring our 9 seats from plan B to plan A?");
        let (_, words) = facts(&turns, "plan_change", &subscriber);
        assert!(words.contains("It asked for plan A on day 40. Your offer had no plan A."), "{words}");
    }

    #[test]
    fn unanswered_thread_names_the_end_of_a_lead() {
        let turns = [turn(0, 8, "system"), offer(1, 14, Plan::B, 30.0), ask(2, 18, COUNTER, 20.0)];
        let (cause, text) = facts(&turns, "new_lead", &lost(25));
        assert_eq!(cause, LossCause::Unanswered);
        assert!(
            text.contains("no answer from you to its message of day 18: the thread ended on day 25."),
            "{text}"
        );
        assert!(text.contains("It asked for a price of $20.00 for plan B on day 18."), "{text}");
        let cancelled =
            Subscription { status: "cancelled".to_owned(), end_day: Some(90), ..Subscription::default() };
        assert!(
            !facts(&turns, "churn_prevention", &cancelled).1.contains("90"),
            "the recorded end can be later"
        );
    }

    #[test]
    fn open_and_closed_threads_are_not_lost() {
        let lead = Subscription { status: "lead".to_owned(), ..Subscription::default() };
        let turns = [turn(0, 8, "system"), offer(1, 14, Plan::B, 30.0)];
        assert_eq!(LostThread::from_turns(&turns, "new_lead", &lead, Some(2)), None);
        for reason in ["accepted", "agent_rejected"] {
            let end = Turn { closing_reason: reason.to_owned(), ..turn(2, 20, "system") };
            assert_eq!(LostThread::from_turns(&[end], "new_lead", &lost(20), Some(2)), None);
        }
        assert_eq!(LostThread::from_turns(&[], "new_lead", &lost(20), Some(2)), None);
    }
}
