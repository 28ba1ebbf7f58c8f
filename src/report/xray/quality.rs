//! What is delivered to a group on each plan, in words.

use super::{settled, table};
use novamind_insight::{PlanDelivered, QualityEquation, SharedGains};
use novamind_session::identifiers::Plan;

/// The equation of each plan, where the shared quality comes from, and what the market expects.
pub fn quality_in_words(own: &QualityEquation) -> Vec<String> {
    let QualityEquation { group, day, base, shared, own: targeted, service_penalty, .. } = own;
    let mut lines = vec![
        format!("quality delivered to {group} on day {day}"),
        format!("  product: base {base:.4} + shared {shared:.4} + {group} {targeted:.4}"),
    ];
    let head = ["plan", "product", "× multiplier", "= delivered", "- service", "= felt"];
    let row = |plan: Plan| {
        let PlanDelivered { tier, multiplier, delivered } = own.plans[plan];
        vec![
            plan.to_string(),
            format!("{:.4}", own.product(1.0)),
            format!("{multiplier:.2} (tier {tier})"),
            format!("{delivered:.4}"),
            format!("{service_penalty:.4}"),
            format!("{:.4}", delivered - service_penalty),
        ]
    };
    lines.extend(table(&head, &Plan::ALL.map(row)));
    let SharedGains { opening, research, development, noise } = own.gains;
    lines.push(format!(
        "  shared: opening {opening:.4} + research {research:.4} + development {development:.4} \
         + daily noise {noise:.4}"
    ));
    lines.push(format!(
        "  not copied by rivals: {:.4} of the shared improvements, {:.4} of those for {group}",
        own.shared_bank, own.own_bank
    ));
    lines.push(format!(
        "  the market expects {:+.4} more ({:+.4} of everyone, {:+.4} of {group}) and pays {:+.2} dollars a month more",
        own.expectation.quality,
        own.everyone,
        own.expectation.quality - own.everyone,
        own.expectation.c_max
    ));
    settled(lines)
}
