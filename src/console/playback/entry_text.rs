//! Descriptions of the decisions of a week: short descriptions for the pane, and complete descriptions as a text.

use super::activities;
use crate::screens::journal::entries::format_arguments;
use novamind_base::formatting::{dollars, grouped_number, short_dollars};
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{
    Advance, Branch, Call, ClosedDays, Memo, Note, Outcome, Query, Reversal, VoiceAnswer,
};
use novamind_report::deals::describe_deals;
use novamind_report::pluralize;
use novamind_session::{
    Chapter, EnterpriseNames, PlaybackPosition, RecordView, ScoredForecast, describe_naive_share,
};
use novamind_tui::theme::Role;

/// Maximum length of JSON that is shown in one line, in bytes.
const MAX_INLINE_JSON_BYTES: usize = 90;

/// Returns the title of a chapter: the decisions before one week.
pub fn chapter_title(chapter: &Chapter) -> String {
    format!("Decisions before week {}", chapter.week)
}

/// Returns a short description of an entry of the record, as styled lines.
pub fn entry_summary(entry: &RecordView, names: &EnterpriseNames) -> Vec<(String, Role)> {
    let one = |text: String, role: Role| vec![(text, role)];
    match &entry.record {
        Record::Call(call) => call_summary(call, names),
        Record::Query(query) => {
            let sql = query.sql.split_whitespace().collect::<Vec<_>>().join(" ");
            let answer = match query_result(query) {
                Ok(rows) => format!("{}, {:.0} ms", pluralize(rows as u32, "row"), query.took_ms),
                Err(code) => format!("rejected: {code}"),
            };
            vec![(sql, Role::Keyword), (answer, Role::Dim)]
        }
        Record::Activity(activity) => vec![activities::activity_summary(activity)],
        Record::Memo(Memo { length, .. }) | Record::Note(Note { length, .. }) => {
            one(format!("notes saved ({} bytes)", grouped_number(*length as f64, 0)), Role::Text)
        }
        Record::Advance(filed) => {
            let mut lines = vec![(format!("“{}”", filed.rationale.trim()), Role::Strong)];
            let how = naive_note(filed).map_or(String::new(), |naively| format!(", filled {naively}"));
            lines.push((format!("forecasts{how}:"), Role::Header));
            lines.extend(entry.forecasts.iter().map(|one| forecast_summary(one, entry.is_future(one))));
            lines
        }
        Record::Week(closing) | Record::Step(closing) => {
            let ClosedDays { days_run, cash, .. } = closing;
            one(format!("{} simulated, cash {}", pluralize(*days_run, "day"), dollars(*cash)), Role::Header)
        }
        Record::Voice(voice_answer) => one(voice_summary(voice_answer), Role::Dim),
        Record::End(end) => one(format!("the run ended: {}", end.reason.id()), Role::Warning),
        Record::Branch(Branch { from: Some(parent) }) => {
            one(format!("branch of run {} starts here", parent.run), Role::Warning)
        }
        other => one(other.kind().to_owned(), Role::Dim),
    }
}

fn voice_summary(voice_answer: &VoiceAnswer) -> String {
    match voice_answer {
        VoiceAnswer::Scores(judged) => {
            let scores: Vec<String> = judged
                .scores
                .iter()
                .map(|model_score| format!("{} {:+.2}", model_score.group, model_score.score))
                .collect();
            format!("a language model judged post {}: {}", judged.post, scores.join(", "))
        }
        VoiceAnswer::Words(worded) => {
            format!("a language model worded {}", pluralize(worded.posts.len() as u32, "post"))
        }
        VoiceAnswer::Failed(failed) => format!("the language model failed: {}", failed.problem),
    }
}

fn call_summary(call: &Call, names: &EnterpriseNames) -> Vec<(String, Role)> {
    let Call { tool, args, .. } = call;
    let deals = tool.tool_id().and_then(|tool| describe_deals(tool, args, names));
    let words = deals.unwrap_or_else(|| format_arguments(args));
    let named = format!("{tool} {words}").trim_end().to_owned();
    match &call.outcome {
        Outcome::Accepted(_) => {
            let sign = match call.reversal {
                Some(Reversal::Undoes(_)) => "undo: ",
                Some(Reversal::Redoes(_)) => "redo: ",
                None => "",
            };
            vec![(format!("{sign}{named}"), Role::Text)]
        }
        Outcome::Rejected(rejection) => {
            vec![(named, Role::Text), (format!("rejected: {}", rejection.message), Role::Bad)]
        }
    }
}

/// Returns the number of rows, or the error code.
fn query_result(query: &Query) -> Result<u64, &str> {
    query.rows.ok_or(query.error.as_deref().unwrap_or_default())
}

fn naive_note(filed: &Advance) -> Option<String> {
    describe_naive_share(&filed.forecasts.iter().map(|forecast| forecast.filled_naively).collect::<Vec<_>>())
}

fn forecast_summary(scored: &ScoredForecast, later: bool) -> (String, Role) {
    let forecast = &scored.forecast;
    let text = format!("{:>2} wk {}", forecast.horizon_days / 7, short_dollars(forecast.point));
    let Some(cash) = scored.outcome else {
        return (format!("{text}, day {} not recorded", scored.due_day()), Role::Dim);
    };
    let role = match (later, scored.is_covered()) {
        (true, _) => Role::Dim,
        (false, true) => Role::Good,
        (false, false) => Role::Bad,
    };
    (format!("{text}, {} {} {}", outcome_verb(later), short_dollars(cash), forecast_verdict(scored)), role)
}

fn outcome_verb(later: bool) -> &'static str {
    if later { "later" } else { "actual" }
}

fn forecast_verdict(scored: &ScoredForecast) -> &'static str {
    if scored.is_covered() { "inside" } else { "OUTSIDE" }
}

/// Describes all decisions with arguments, statements and results.
pub fn decisions_text(place: &PlaybackPosition, names: &EnterpriseNames) -> String {
    let chapter = &place.chapter;
    let mut parts = vec![format!(
        "Day {}, before week {}. Outcomes marked “later” were recorded later and were unknown on this day.",
        chapter.day, chapter.week
    )];
    for (at, entry) in chapter.entries.iter().enumerate() {
        let mark = if at < chapter.applied_entries { "✓" } else { "–" };
        let moment = entry.at.get(11..19).unwrap_or("");
        parts.push(format!("{mark} {moment}  {}", entry_text(entry, names)));
    }
    parts.join("\n\n")
}

fn entry_text(entry: &RecordView, names: &EnterpriseNames) -> String {
    let pretty = |value: &serde_json::Value| {
        let short = value.to_string();
        if short.len() <= MAX_INLINE_JSON_BYTES {
            return format!("    {short}");
        }
        let text = serde_json::to_string_pretty(value).unwrap_or_default();
        text.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n")
    };
    match &entry.record {
        Record::Call(Call { tool, args, outcome, reversal, .. }) => {
            let remark = match reversal {
                Some(Reversal::Undoes(_)) => " (undid an earlier call)",
                Some(Reversal::Redoes(_)) => " (redid an undone call)",
                None => "",
            };
            match outcome {
                Outcome::Accepted(answer) => {
                    format!("{tool}{remark}\n{}\n  result\n{}", pretty(args), pretty(answer))
                }
                Outcome::Rejected(rejection) => {
                    format!("{tool}\n{}\n  rejected: {}", pretty(args), rejection.message)
                }
            }
        }
        Record::Query(query) => {
            let sql = query.sql.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n");
            match query_result(query) {
                Ok(rows) => {
                    format!("query\n{sql}\n  {} in {:.1} ms", pluralize(rows as u32, "row"), query.took_ms)
                }
                Err(code) => format!("query\n{sql}\n  rejected: {code}"),
            }
        }
        Record::Advance(filed) => {
            let naively = naive_note(filed).map_or(String::new(), |naively| format!(", filled {naively}"));
            let format_forecast = |one: &ScoredForecast| forecast_text(one, entry.is_future(one));
            let lines: Vec<String> = entry.forecasts.iter().map(format_forecast).collect();
            let rationale = filed.rationale.trim();
            format!("next_week\n  “{rationale}”\n  forecasts of cash{naively}:\n{}", lines.join("\n"))
        }
        _ => entry_summary(entry, names).into_iter().map(|(text, _)| text).collect::<Vec<_>>().join("\n  "),
    }
}

fn forecast_text(scored: &ScoredForecast, later: bool) -> String {
    let forecast = &scored.forecast;
    let outcome = match scored.outcome {
        Some(cash) => format!("{} {} {}", outcome_verb(later), dollars(cash), forecast_verdict(scored)),
        None => "not recorded".to_owned(),
    };
    format!(
        "    {:>2} wk, day {:>3}: {:>14} {:>14} {:>14}   {outcome}",
        forecast.horizon_days / 7,
        scored.due_day(),
        dollars(forecast.lower),
        dollars(forecast.point),
        dollars(forecast.upper)
    )
}

pub(super) fn format_millis(milliseconds: u64) -> String {
    match milliseconds / 1000 {
        0 => "a moment".to_owned(),
        seconds @ 1..60 => format!("{seconds} s"),
        seconds => format!("{} min {} s", seconds / 60, seconds % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::{
        Activity, End, Parent, RejectionRecord, RunEndReason, ScreenView, Via,
    };
    use novamind_tools::Forecast;
    use serde_json::json;

    fn summary_text(record: Record) -> Vec<String> {
        let at = "2026-11-21T10:42:07Z".to_owned();
        let entry = RecordView { seq: 1, day: 14, at, record, forecasts: Vec::new(), today: 14 };
        let names = EnterpriseNames::new(1, &novamind_world::params::Params::bundled().personas.email);
        entry_summary(&entry, &names).into_iter().map(|(text, _)| text).collect()
    }

    fn scored_forecast(outcome: Option<f64>) -> ScoredForecast {
        let forecast = Forecast { horizon_days: 28, point: 1.5e6, lower: 1.4e6, upper: 1.6e6 };
        ScoredForecast { forecast, day: 14, outcome }
    }

    #[test]
    fn entry_summaries_are_short() {
        let call = |args, outcome, reversal| {
            let tool = novamind_tools::ToolId::SetPrices.into();
            Record::Call(Call { tool, args, outcome, via: Via::Form, took_ms: 0.1, reversal, request: None })
        };
        let accepted = |reversal| call(json!({"A": 12}), Outcome::Accepted(json!({})), reversal);
        assert_eq!(summary_text(accepted(None)), ["set_prices A 12"]);
        assert_eq!(summary_text(accepted(Some(Reversal::Undoes(3)))), ["undo: set_prices A 12"]);
        assert_eq!(summary_text(accepted(Some(Reversal::Redoes(4)))), ["redo: set_prices A 12"]);
        let (code, message) = ("price_not_positive".to_owned(), "too low".to_owned());
        let refused = Outcome::Rejected(RejectionRecord { code, message, ..RejectionRecord::default() });
        assert_eq!(
            summary_text(call(json!({"A": -1}), refused, None)),
            ["set_prices A -1", "rejected: too low"]
        );
        let query = |rows, error: Option<&str>| {
            let (sql, error) = ("SELECT 1\n FROM x".to_owned(), error.map(str::to_owned));
            Record::Query(Query {
                sql,
                rows,
                truncated: false,
                error,
                message: None,
                stopped: false,
                via: None,
                took_ms: 3.4,
            })
        };
        assert_eq!(summary_text(query(Some(1200), None)), ["SELECT 1 FROM x", "1,200 rows, 3 ms"]);
        assert_eq!(summary_text(query(None, Some("sql_error"))), ["SELECT 1 FROM x", "rejected: sql_error"]);
        for (for_ms, words) in [(400, "a moment"), (1_500, "1 s"), (83_000, "1 min 23 s")] {
            let view = ScreenView { screen: "cash".to_owned(), from: String::new(), for_ms };
            assert_eq!(
                summary_text(Record::Activity(Activity::View(view))),
                [format!("viewed cash for {words}")]
            );
        }
        let from = Some(Parent { run: "aa".to_owned(), seq: 3 });
        assert_eq!(summary_text(Record::Branch(Branch { from })), ["branch of run aa starts here"]);
        let end = End { reason: RunEndReason::Horizon, cash: 4.0, score: Some(4.0) };
        assert_eq!(summary_text(Record::End(end)), ["the run ended: horizon"]);
    }

    #[test]
    fn later_outcomes_are_marked() {
        for (outcome, later, words) in [
            (Some(1.55e6), false, "actual $1.55M inside"),
            (Some(1.75e6), false, "actual $1.75M OUTSIDE"),
            (Some(1.55e6), true, "later $1.55M inside"),
            (None, true, "day 42 not recorded"),
        ] {
            let (text, _) = forecast_summary(&scored_forecast(outcome), later);
            assert!(text.ends_with(words), "{text}");
            let full = forecast_text(&scored_forecast(outcome), later);
            assert!(full.contains("day  42"), "{full}");
        }
    }
}
