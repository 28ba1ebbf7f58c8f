//! Texts for the inspection of competitors and drift.

use super::{clean_up_numbers, indented_table};
use novamind_insight::{CompetitorState, DriftState, GroupDriftState, NextCompetitorMove};

const MAX_LISTED_MOVES: usize = 10;

/// Describes the improvements that competitors have not copied yet, the past moves of competitors, and their next move.
pub fn describe_competitors(competitor_state: &CompetitorState) -> Vec<String> {
    let CompetitorState { day, shared_bonus, shared_bank, common_expectation: everyone, .. } =
        competitor_state;
    let mut lines = vec![
        format!("competitors at the end of day {day}"),
        format!("  shared improvements {shared_bonus:.4}, not copied {shared_bank:.4}"),
    ];
    let banks = competitor_state
        .group_banks
        .iter()
        .map(|(group, bonus, bank)| vec![group.to_string(), format!("{bonus:.4}"), format!("{bank:.4}")]);
    let banks: Vec<Vec<String>> = banks.collect();
    if !banks.is_empty() {
        lines.extend(indented_table(&["group", "own improvements", "not copied"], &banks));
    }
    lines
        .push(format!("  competitors and drift have added {everyone:+.4} to the expectations of all groups"));
    lines.extend(move_lines(competitor_state));
    lines.extend(match &competitor_state.next_move {
        Some(next) => next_move_lines(next, competitor_state),
        None => vec!["  no further move before the end of the run".to_owned()],
    });
    clean_up_numbers(lines)
}

fn move_lines(competitor_state: &CompetitorState) -> Vec<String> {
    let count = competitor_state.moves.len();
    let mut lines = vec![match count {
        0 => "  no move yet".to_owned(),
        1 => "  1 move".to_owned(),
        count if count > MAX_LISTED_MOVES => format!("  {count} moves, the last {MAX_LISTED_MOVES}:"),
        count => format!("  {count} moves:"),
    }];
    let rows: Vec<Vec<String>> = competitor_state.moves[count.saturating_sub(MAX_LISTED_MOVES)..]
        .iter()
        .map(|(event, severity)| {
            vec![
                format!("day {}", event.day),
                severity.id().to_owned(),
                format!("{:+.4}", event.boost),
                format!("{:.4}", event.sampled),
                format!("{:.1} %", event.u * 100.0),
                if event.by_feedback { "copied".to_owned() } else { "drawn".to_owned() },
            ]
        })
        .collect();
    if !rows.is_empty() {
        lines.extend(indented_table(
            &["", "size", "raised by", "drawn size", "share of the bank", "applied"],
            &rows,
        ));
    }
    lines
}

fn next_move_lines(next: &NextCompetitorMove, competitor_state: &CompetitorState) -> Vec<String> {
    let NextCompetitorMove { day, sampled_size: sampled, copied_share: u, outcome: made, .. } = next;
    let mut lines = vec![format!(
        "  next move on day {day}: drawn size {sampled:.4}, or {:.1} % of the shared bank if larger: {:.4} of today's bank",
        u * 100.0,
        next.copied_quality(competitor_state.shared_bank)
    )];
    lines.push(match made {
        Some(made) if made.by_feedback => {
            format!("  the move copied quality and raised expectations by {:.4}", made.boost)
        }
        Some(made) => format!("  the move had its drawn size and raised expectations by {:.4}", made.boost),
        None => format!("  competitors copy if the bank is above {:.4} on that day", next.copy_threshold()),
    });
    if !next.group_shares.is_empty() {
        let shares = next.group_shares.iter().map(|(group, share)| format!("{group} {:.1} %", share * 100.0));
        lines.push(format!(
            "  copied share of targeted banks, if no further group has one: {}",
            shares.collect::<Vec<String>>().join(", ")
        ));
    }
    lines
}

/// Describes how much competitors and drift have added to expectations and budgets, and how much the next drift will
/// add.
pub fn describe_drift(drift_state: &DriftState) -> Vec<String> {
    let DriftState { day, common_expectation: everyone, next_common_step: step, next_day, groups } =
        drift_state;
    let mut lines = vec![
        format!("expectations and budgets at the end of day {day}"),
        match next_day {
            Some(next) => {
                format!("  next drift on day {next}: it adds {step:+.6} to the expectations of all groups")
            }
            None => "  no further drift before the end of the run".to_owned(),
        },
    ];
    let mut head = vec!["group", "all groups", "own", "expectation", "budget, $"];
    if next_day.is_some() {
        head.extend(["next drift: expectation", "next drift: budget, $"]);
    }
    let row = |state: &GroupDriftState| {
        let mut row = vec![
            format!("{}{}", state.group, if state.is_known { "" } else { " (unknown)" }),
            format!("{everyone:+.4}"),
            format!("{:+.4}", state.group_expectation),
            format!("{:+.4}", state.expectation.quality),
            format!("{:+.4}", state.expectation.c_max),
        ];
        if next_day.is_some() {
            row.extend([
                format!("{:+.6}", state.next_step.quality + step),
                format!("{:+.4}", state.next_step.c_max),
            ]);
        }
        row
    };
    lines.extend(indented_table(&head, &groups.iter().map(row).collect::<Vec<_>>()));
    clean_up_numbers(lines)
}
