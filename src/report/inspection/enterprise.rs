//! Texts for the inspection of an enterprise.

use super::{clean_up_numbers, indented_table};
use crate::formatting::pluralize;
use novamind_insight::{EnterpriseThreadDay, EnterpriseView};
use novamind_session::OfferResponse;
use novamind_session::identifiers::Plan;

/// Describes the open threads of an enterprise on a day: perceived quality, acceptance limits, and how the enterprise
/// would answer an offer on this day.
pub fn describe_enterprise(view: &EnterpriseView) -> Vec<String> {
    let EnterpriseView { customer, group, day, days } = view;
    let mut lines = vec![format!("enterprise {customer} · {group} · day {day}")];
    let before = lines.len();
    view.threads_on_shown_day().for_each(|thread_day| lines.extend(describe_thread(thread_day)));
    if lines.len() == before {
        lines.push(match days.last() {
            Some(last) => {
                format!("no thread was open on day {day}; the last day with an open thread was {}", last.day)
            }
            None => format!("no thread was open up to day {day}"),
        });
    }
    clean_up_numbers(lines)
}

fn describe_thread(thread_day: &EnterpriseThreadDay) -> Vec<String> {
    let mut lines = vec![format!(
        "thread {} ({}): budget {:.2}, {} left, relationship {:.4}{}",
        thread_day.thread,
        thread_day.kind.id(),
        thread_day.budget,
        pluralize(thread_day.remaining_turns, "turn"),
        thread_day.relationship,
        match thread_day.late_penalty {
            0.0 => String::new(),
            penalty => format!(", {penalty:+.4} if the late answer arrives today"),
        }
    )];
    let head = ["plan", "quality", "if answered today", "accepts", "counteroffer"];
    let row = |plan: Plan| {
        let judged = thread_day.plans[plan];
        vec![
            plan.to_string(),
            format!("{:.4}", judged.quality),
            format!("{:.4}", judged.quality_if_answered),
            match judged.accepts_any_price {
                true => "any price".to_owned(),
                false => format!("below {:.2}", judged.accepts_below),
            },
            if judged.counter > 0.0 { format!("{:.2}", judged.counter) } else { "none".to_owned() },
        ]
    };
    lines.extend(indented_table(&head, &Plan::ALL.map(row)));
    if let Some(answer) = &thread_day.answer {
        let offered: Vec<String> = thread_day
            .offerings
            .iter()
            .map(|offering| format!("{} at {:.2}", offering.plan, offering.price))
            .collect();
        let when = thread_day.reply_day.map_or(String::new(), |day| format!(", due on day {day}"));
        lines.push(format!(
            "  offered {}; today's answer{when}: {}",
            offered.join(", "),
            describe_answer(answer, thread_day)
        ));
    }
    lines
}

fn describe_answer(answer: &OfferResponse, thread_day: &EnterpriseThreadDay) -> String {
    let plan = |at: usize| thread_day.offerings.get(at).map_or("", |offering| offering.plan.id());
    match answer {
        OfferResponse::Accept(at) => format!("accepts plan {}", plan(*at)),
        OfferResponse::Counter(at, price) => format!("counters with {price:.2} for plan {}", plan(*at)),
        OfferResponse::Silence => "no answer".to_owned(),
    }
}
