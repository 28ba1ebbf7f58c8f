//! Text for the inspection of competitors and drift.

use super::{settled, table};
use novamind_insight::{DriftState, GroupDrifted, NextRivalMove, RivalState};

const LISTED_MOVES: usize = 10;

/// Describes what competitors could copy, their moves so far, and the next move.
pub fn rivals_in_words(own: &RivalState) -> Vec<String> {
    let RivalState { day, shared_bonus, shared_bank, everyone, .. } = own;
    let mut lines = vec![
        format!("competitors at the end of day {day}"),
        format!("  shared improvements {shared_bonus:.4}, not copied {shared_bank:.4}"),
    ];
    let banks = own
        .own
        .iter()
        .map(|(group, bonus, bank)| vec![group.to_string(), format!("{bonus:.4}"), format!("{bank:.4}")]);
    let banks: Vec<Vec<String>> = banks.collect();
    if !banks.is_empty() {
        lines.extend(table(&["group", "own improvements", "not copied"], &banks));
    }
    lines
        .push(format!("  competitors and drift have added {everyone:+.4} to the expectations of all groups"));
    lines.extend(moves(own));
    lines.extend(match &own.next {
        Some(next) => next_move(next, own),
        None => vec!["  no further move before the end of the run".to_owned()],
    });
    settled(lines)
}

fn moves(own: &RivalState) -> Vec<String> {
    let count = own.moves.len();
    let mut lines = vec![match count {
        0 => "  no move so far".to_owned(),
        1 => "  1 move so far".to_owned(),
        count if count > LISTED_MOVES => format!("  {count} moves so far, the last {LISTED_MOVES}:"),
        count => format!("  {count} moves so far:"),
    }];
    let rows: Vec<Vec<String>> = own.moves[count.saturating_sub(LISTED_MOVES)..]
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
        lines.extend(table(&["", "size", "raised by", "drawn size", "share of the bank", "applied"], &rows));
    }
    lines
}

fn next_move(next: &NextRivalMove, own: &RivalState) -> Vec<String> {
    let NextRivalMove { day, sampled, u, made, .. } = next;
    let mut lines = vec![format!(
        "  next move on day {day}: drawn size {sampled:.4}, or {:.1} % of the shared bank if larger: {:.4} of today's bank",
        u * 100.0,
        next.copied(own.shared_bank)
    )];
    lines.push(match made {
        Some(made) if made.by_feedback => {
            format!("  it copied and raised expectations by {:.4}", made.boost)
        }
        Some(made) => format!("  the drawn size applied: expectations rose by {:.4}", made.boost),
        None => format!("  they copy if the bank is above {:.4} on that day", next.copies_above()),
    });
    if !next.shares.is_empty() {
        let shares = next.shares.iter().map(|(group, share)| format!("{group} {:.1} %", share * 100.0));
        lines.push(format!(
            "  of the targeted banks, if no other group has one by then: {}",
            shares.collect::<Vec<String>>().join(", ")
        ));
    }
    lines
}

/// Describes what the market has added to expectations and budgets, and what the next drift adds.
pub fn drift_in_words(own: &DriftState) -> Vec<String> {
    let DriftState { day, everyone, step, next_day, groups } = own;
    let mut lines = vec![
        format!("expectations and budgets at the end of day {day}"),
        match next_day {
            Some(next) => {
                format!("  next drift on day {next}: it adds {step:+.6} to the expectations of all groups")
            }
            None => "  no further drift before the end of the run".to_owned(),
        },
    ];
    let mut head = vec!["group", "all groups", "own", "expects more", "pays more, $"];
    if next_day.is_some() {
        head.extend(["next drift: expects", "pays, $"]);
    }
    let row = |own: &GroupDrifted| {
        let mut row = vec![
            format!("{}{}", own.group, if own.is_known { "" } else { " (unknown)" }),
            format!("{everyone:+.4}"),
            format!("{:+.4}", own.own),
            format!("{:+.4}", own.expectation.quality),
            format!("{:+.4}", own.expectation.c_max),
        ];
        if next_day.is_some() {
            row.extend([format!("{:+.6}", own.step.quality + step), format!("{:+.4}", own.step.c_max)]);
        }
        row
    };
    lines.extend(table(&head, &groups.iter().map(row).collect::<Vec<_>>()));
    settled(lines)
}
