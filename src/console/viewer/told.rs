//! Decisions of a week in words: in few for the pane, in full to read.

use crate::console::screens::journal::entries::in_words;
use crate::console::text::short_dollars;
use crate::console::theme::Role;
use crate::notation::{dollars, grouped};
use crate::session::{Act, Chapter, Decided, Foreseen, Place, Reversal};

/// Longest JSON that is written in one line, in bytes.
const ONE_LINE: usize = 90;

/// What the decisions are of.
pub fn title(chapter: &Chapter) -> String {
    format!("Decided before week {}", chapter.week)
}

/// A line of the record in few words, with its meaning.
pub fn brief(entry: &Decided) -> Vec<(String, Role)> {
    let one = |text: String, role: Role| vec![(text, role)];
    match &entry.act {
        Act::Call { tool, args, reversal, .. } => {
            let sign = match reversal {
                Some(Reversal::Undoes(_)) => "undo: ",
                Some(Reversal::Redoes(_)) => "redo: ",
                None => "",
            };
            one(format!("{sign}{tool} {}", in_words(args)).trim_end().to_owned(), Role::Text)
        }
        Act::Refused { tool, args, message } => vec![
            (format!("{tool} {}", in_words(args)).trim_end().to_owned(), Role::Text),
            (format!("refused: {message}"), Role::Bad),
        ],
        Act::Query { sql, rows, took_ms } => {
            let sql = sql.split_whitespace().collect::<Vec<_>>().join(" ");
            let answer = match rows {
                Ok(rows) => format!("{} rows, {took_ms:.0} ms", grouped(*rows as f64, 0)),
                Err(code) => format!("refused: {code}"),
            };
            vec![(sql, Role::Keyword), (answer, Role::Dim)]
        }
        Act::View { screen, for_ms } => one(format!("viewed {screen} for {}", time(*for_ms)), Role::Dim),
        Act::Memo { length, .. } => {
            one(format!("saved notes ({} bytes)", grouped(*length as f64, 0)), Role::Text)
        }
        Act::Advance { rationale, forecasts, filled_naively } => {
            let mut lines = vec![(format!("“{}”", rationale.trim()), Role::Strong)];
            let how = if *filled_naively { "forecasts, filled naively:" } else { "forecasts:" };
            lines.push((how.to_owned(), Role::Header));
            lines.extend(forecasts.iter().map(foreseen_in_brief));
            lines
        }
        Act::Closing { days_run, cash } => {
            one(format!("{days_run} days passed, cash {}", dollars(*cash)), Role::Header)
        }
        Act::End { reason } => one(format!("the run was over: {reason}"), Role::Warning),
        Act::Branch { run } => one(format!("branched off run {run} here"), Role::Warning),
        Act::Other(kind) => one(kind.clone(), Role::Dim),
    }
}

fn foreseen_in_brief(foreseen: &Foreseen) -> (String, Role) {
    let Foreseen { forecast, outcome, later, .. } = foreseen;
    let said = format!("{:>2} wk {}", forecast.horizon_days / 7, short_dollars(forecast.point));
    match (outcome, foreseen.is_inside()) {
        (Some(cash), Some(inside)) => {
            let verdict = if inside { "inside" } else { "OUTSIDE" };
            let came = if *later { "later" } else { "came" };
            let role = match (*later, inside) {
                (true, _) => Role::Dim,
                (false, true) => Role::Good,
                (false, false) => Role::Bad,
            };
            (format!("{said}, {came} {} {verdict}", short_dollars(*cash)), role)
        }
        _ => (format!("{said}, day {} not recorded", foreseen.due), Role::Dim),
    }
}

/// Everything that was decided, with arguments, statements and answers.
pub fn whole(place: &Place) -> String {
    let chapter = &place.chapter;
    let mut parts = vec![format!(
        "Day {}, before week {}. Outcomes marked “later” come from later in the record; nobody knew them then.",
        chapter.day, chapter.week
    )];
    for (at, entry) in chapter.entries.iter().enumerate() {
        let mark = if at < chapter.done { "✓" } else { "–" };
        let moment = entry.at.get(11..19).unwrap_or("");
        parts.push(format!("{mark} {moment}  {}", in_full(&entry.act)));
    }
    parts.join("\n\n")
}

fn in_full(act: &Act) -> String {
    let pretty = |value: &serde_json::Value| {
        let short = value.to_string();
        if short.len() <= ONE_LINE {
            return format!("    {short}");
        }
        let text = serde_json::to_string_pretty(value).unwrap_or_default();
        text.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n")
    };
    match act {
        Act::Call { tool, args, answer, reversal } => {
            let remark = match reversal {
                Some(Reversal::Undoes(_)) => " (undid an earlier call)",
                Some(Reversal::Redoes(_)) => " (redid an undone call)",
                None => "",
            };
            format!("{tool}{remark}\n{}\n  answered\n{}", pretty(args), pretty(answer))
        }
        Act::Refused { tool, args, message } => {
            format!("{tool}\n{}\n  refused: {message}", pretty(args))
        }
        Act::Query { sql, rows, took_ms } => {
            let sql = sql.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n");
            match rows {
                Ok(rows) => format!("asked\n{sql}\n  {} rows in {took_ms:.1} ms", grouped(*rows as f64, 0)),
                Err(code) => format!("asked\n{sql}\n  refused: {code}"),
            }
        }
        Act::Advance { rationale, forecasts, filled_naively } => {
            let naively = if *filled_naively { ", filled with the naive projection" } else { "" };
            let lines: Vec<String> = forecasts.iter().map(foreseen_in_full).collect();
            format!(
                "next_week\n  “{}”\n  forecasts of cash{naively}:\n{}",
                rationale.trim(),
                lines.join("\n")
            )
        }
        _ => {
            let entry = Decided { seq: 0, day: 0, at: String::new(), act: act.clone() };
            brief(&entry).into_iter().map(|(text, _)| text).collect::<Vec<_>>().join("\n  ")
        }
    }
}

fn foreseen_in_full(foreseen: &Foreseen) -> String {
    let Foreseen { forecast, due, outcome, later } = foreseen;
    let came = match (outcome, foreseen.is_inside()) {
        (Some(cash), Some(inside)) => format!(
            "{} {} {}",
            if *later { "later" } else { "came" },
            dollars(*cash),
            if inside { "inside" } else { "OUTSIDE" }
        ),
        _ => "not recorded".to_owned(),
    };
    format!(
        "    {:>2} wk, day {due:>3}: {:>14} {:>14} {:>14}   {came}",
        forecast.horizon_days / 7,
        dollars(forecast.lower),
        dollars(forecast.point),
        dollars(forecast.upper)
    )
}

/// A time somebody looked at something.
fn time(milliseconds: u64) -> String {
    match milliseconds / 1000 {
        0 => "a moment".to_owned(),
        seconds @ 1..60 => format!("{seconds} s"),
        seconds => format!("{} min {} s", seconds / 60, seconds % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tools::Forecast;
    use serde_json::json;

    fn said(act: Act) -> Vec<String> {
        let entry = Decided { seq: 1, day: 14, at: "2026-11-21T10:42:07Z".to_owned(), act };
        brief(&entry).into_iter().map(|(text, _)| text).collect()
    }

    fn foreseen(outcome: Option<f64>, later: bool) -> Foreseen {
        let forecast = Forecast { horizon_days: 28, point: 1.5e6, lower: 1.4e6, upper: 1.6e6 };
        Foreseen { forecast, due: 42, outcome, later }
    }

    #[test]
    fn lines_are_told_in_few_words() {
        let call = |reversal| Act::Call {
            tool: "set_prices".to_owned(),
            args: json!({"A": 12}),
            answer: json!({}),
            reversal,
        };
        assert_eq!(said(call(None)), ["set_prices A 12"]);
        assert_eq!(said(call(Some(Reversal::Undoes(3)))), ["undo: set_prices A 12"]);
        assert_eq!(said(call(Some(Reversal::Redoes(4)))), ["redo: set_prices A 12"]);
        let refused = Act::Refused {
            tool: "set_prices".to_owned(),
            args: json!({"A": -1}),
            message: "too low".to_owned(),
        };
        assert_eq!(said(refused), ["set_prices A -1", "refused: too low"]);
        let query = Act::Query { sql: "SELECT 1\n FROM x".to_owned(), rows: Ok(1200), took_ms: 3.4 };
        assert_eq!(said(query), ["SELECT 1 FROM x", "1,200 rows, 3 ms"]);
        for (for_ms, words) in [(400, "a moment"), (1_500, "1 s"), (83_000, "1 min 23 s")] {
            let view = Act::View { screen: "cash".to_owned(), for_ms };
            assert_eq!(said(view), [format!("viewed cash for {words}")]);
        }
    }

    #[test]
    fn what_was_still_to_come_is_marked() {
        for (outcome, later, words) in [
            (Some(1.55e6), false, "came $1.55M inside"),
            (Some(1.75e6), false, "came $1.75M OUTSIDE"),
            (Some(1.55e6), true, "later $1.55M inside"),
            (None, true, "day 42 not recorded"),
        ] {
            let (text, _) = foreseen_in_brief(&foreseen(outcome, later));
            assert!(text.ends_with(words), "{text}");
            let full = foreseen_in_full(&foreseen(outcome, later));
            assert!(full.contains("day  42"), "{full}");
        }
    }
}
