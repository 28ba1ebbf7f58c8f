//! Texts for the quality that each plan delivers to a group.

use super::{clean_up_numbers, indented_table};
use novamind_insight::{DeliveredPlanQuality, QualityEquation, SharedQualityGains};
use novamind_session::identifiers::Plan;

/// Describes the quality equation of each plan, what has added to shared quality, and the expectations of the market.
pub fn describe_quality(quality_equation: &QualityEquation) -> Vec<String> {
    let QualityEquation { group, day, base, shared, group_gain: targeted, service_penalty, .. } =
        quality_equation;
    let mut lines = vec![
        format!("quality delivered to {group} on day {day}"),
        format!("  product: base {base:.4} + shared {shared:.4} + {group} {targeted:.4}"),
    ];
    let head = ["plan", "product", "× multiplier", "= delivered", "- service", "= perceived"];
    let row = |plan: Plan| {
        let DeliveredPlanQuality { tier, multiplier, delivered } = quality_equation.plans[plan];
        vec![
            plan.to_string(),
            format!("{:.4}", quality_equation.product_quality(1.0)),
            format!("{multiplier:.2} (tier {tier})"),
            format!("{delivered:.4}"),
            format!("{service_penalty:.4}"),
            format!("{:.4}", delivered - service_penalty),
        ]
    };
    lines.extend(indented_table(&head, &Plan::ALL.map(row)));
    let SharedQualityGains { opening, research, development, noise } = quality_equation.gains;
    lines.push(format!(
        "  shared: opening {opening:.4} + research {research:.4} + development {development:.4} \
         + daily noise {noise:.4}"
    ));
    lines.push(format!(
        "  not copied by competitors: {:.4} of the shared improvements, {:.4} of the improvements for {group}",
        quality_equation.shared_bank, quality_equation.group_bank
    ));
    lines.push(format!(
        "  the market expects {:+.4} more ({:+.4} all groups, {:+.4} {group}) and pays {:+.2} dollars a month more",
        quality_equation.expectation.quality,
        quality_equation.common_expectation,
        quality_equation.expectation.quality - quality_equation.common_expectation,
        quality_equation.expectation.c_max
    ));
    clean_up_numbers(lines)
}
