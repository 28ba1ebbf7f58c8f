//! Descriptions of the decisions of a week: brief for the pane, complete for reading.

use super::activities;
use crate::screens::journal::entries::in_words;
use novamind_base::notation::{dollars, grouped, short_dollars};
use novamind_record::trajectory::Record;
use novamind_record::trajectory::record::{
    Advance, Branch, Call, Closing, Memo, Note, Outcome, Query, Reversal, VoiceAnswer,
};
use novamind_report::count;
use novamind_report::deals::deals_in_words;
use novamind_session::{Chapter, CompanyNames, PlaybackPosition, RecordView, ScoredForecast, naively};
use novamind_tui::theme::Role;

/// Maximum length of JSON in one line, in bytes.
const ONE_LINE: usize = 90;

/// Returns the title of a chapter.
pub fn title(chapter: &Chapter) -> String {
    format!("Decided before week {}", chapter.week)
}

/// Describes a line of the record briefly, in styled lines.
pub fn brief(entry: &RecordView, names: &CompanyNames) -> Vec<(String, Role)> {
    let one = |text: String, role: Role| vec![(text, role)];
    match &entry.record {
        Record::Call(call) => call_in_brief(call, names),
        Record::Query(query) => {
            let sql = query.sql.split_whitespace().collect::<Vec<_>>().join(" ");
            let answer = match answered(query) {
                Ok(rows) => format!("{}, {:.0} ms", count(rows as u32, "row"), query.took_ms),
                Err(code) => format!("rejected: {code}"),
            };
            vec![(sql, Role::Keyword), (answer, Role::Dim)]
        }
        Record::Activity(activity) => vec![activities::brief(activity)],
        Record::Memo(Memo { length, .. }) | Record::Note(Note { length, .. }) => {
            one(format!("saved notes ({} bytes)", grouped(*length as f64, 0)), Role::Text)
        }
        Record::Advance(filed) => {
            let mut lines = vec![(format!("“{}”", filed.rationale.trim()), Role::Strong)];
            let how = filled(filed).map_or(String::new(), |naively| format!(", filled {naively}"));
            lines.push((format!("forecasts{how}:"), Role::Header));
            lines.extend(entry.forecasts.iter().map(|one| forecast_in_brief(one, entry.is_later(one))));
            lines
        }
        Record::Week(closing) | Record::Step(closing) => {
            let Closing { days_run, cash, .. } = closing;
            one(format!("{days_run} days passed, cash {}", dollars(*cash)), Role::Header)
        }
        Record::Voice(said) => one(voice_in_brief(said), Role::Dim),
        Record::End(end) => one(format!("the run ended: {}", end.reason.id()), Role::Warning),
        Record::Branch(Branch { from: Some(parent) }) => {
            one(format!("branched off run {} here", parent.run), Role::Warning)
        }
        other => one(other.kind().to_owned(), Role::Dim),
    }
}

fn voice_in_brief(said: &VoiceAnswer) -> String {
    match said {
        VoiceAnswer::Scores(judged) => {
            let scores: Vec<String> =
                judged.scores.iter().map(|own| format!("{} {:+.2}", own.group, own.score)).collect();
            format!("a language model judged post {}: {}", judged.post, scores.join(", "))
        }
        VoiceAnswer::Words(worded) => format!("a language model worded {} posts", worded.posts.len()),
        VoiceAnswer::Failed(failed) => format!("the language model failed: {}", failed.problem),
    }
}

fn call_in_brief(call: &Call, names: &CompanyNames) -> Vec<(String, Role)> {
    let Call { tool, args, .. } = call;
    let deals = tool.known().and_then(|tool| deals_in_words(tool, args, names));
    let words = deals.unwrap_or_else(|| in_words(args));
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
        Outcome::Refused(refusal) => {
            vec![(named, Role::Text), (format!("rejected: {}", refusal.message), Role::Bad)]
        }
    }
}

/// Returns the number of rows, or the error code.
fn answered(query: &Query) -> Result<u64, &str> {
    query.rows.ok_or(query.error.as_deref().unwrap_or_default())
}

fn filled(filed: &Advance) -> Option<String> {
    naively(&filed.forecasts.iter().map(|forecast| forecast.filled_naively).collect::<Vec<_>>())
}

fn forecast_in_brief(scored: &ScoredForecast, later: bool) -> (String, Role) {
    let forecast = &scored.forecast;
    let said = format!("{:>2} wk {}", forecast.horizon_days / 7, short_dollars(forecast.point));
    let Some(cash) = scored.outcome else {
        return (format!("{said}, day {} not recorded", scored.due()), Role::Dim);
    };
    let role = match (later, scored.is_inside()) {
        (true, _) => Role::Dim,
        (false, true) => Role::Good,
        (false, false) => Role::Bad,
    };
    (format!("{said}, {} {} {}", came(later), short_dollars(cash), verdict(scored)), role)
}

fn came(later: bool) -> &'static str {
    if later { "later" } else { "came" }
}

fn verdict(scored: &ScoredForecast) -> &'static str {
    if scored.is_inside() { "inside" } else { "OUTSIDE" }
}

/// Describes all decisions with arguments, statements and results.
pub fn whole(place: &PlaybackPosition, names: &CompanyNames) -> String {
    let chapter = &place.chapter;
    let mut parts = vec![format!(
        "Day {}, before week {}. Outcomes marked “later” come from later in the record and were unknown then.",
        chapter.day, chapter.week
    )];
    for (at, entry) in chapter.entries.iter().enumerate() {
        let mark = if at < chapter.done { "✓" } else { "–" };
        let moment = entry.at.get(11..19).unwrap_or("");
        parts.push(format!("{mark} {moment}  {}", in_full(entry, names)));
    }
    parts.join("\n\n")
}

fn in_full(entry: &RecordView, names: &CompanyNames) -> String {
    let pretty = |value: &serde_json::Value| {
        let short = value.to_string();
        if short.len() <= ONE_LINE {
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
                Outcome::Refused(refusal) => {
                    format!("{tool}\n{}\n  rejected: {}", pretty(args), refusal.message)
                }
            }
        }
        Record::Query(query) => {
            let sql = query.sql.lines().map(|line| format!("    {line}")).collect::<Vec<_>>().join("\n");
            match answered(query) {
                Ok(rows) => {
                    format!("query\n{sql}\n  {} in {:.1} ms", count(rows as u32, "row"), query.took_ms)
                }
                Err(code) => format!("query\n{sql}\n  rejected: {code}"),
            }
        }
        Record::Advance(filed) => {
            let naively = filled(filed).map_or(String::new(), |naively| format!(", filled {naively}"));
            let told = |one: &ScoredForecast| forecast_in_full(one, entry.is_later(one));
            let lines: Vec<String> = entry.forecasts.iter().map(told).collect();
            let rationale = filed.rationale.trim();
            format!("next_week\n  “{rationale}”\n  forecasts of cash{naively}:\n{}", lines.join("\n"))
        }
        _ => brief(entry, names).into_iter().map(|(text, _)| text).collect::<Vec<_>>().join("\n  "),
    }
}

fn forecast_in_full(scored: &ScoredForecast, later: bool) -> String {
    let forecast = &scored.forecast;
    let outcome = match scored.outcome {
        Some(cash) => format!("{} {} {}", came(later), dollars(cash), verdict(scored)),
        None => "not recorded".to_owned(),
    };
    format!(
        "    {:>2} wk, day {:>3}: {:>14} {:>14} {:>14}   {outcome}",
        forecast.horizon_days / 7,
        scored.due(),
        dollars(forecast.lower),
        dollars(forecast.point),
        dollars(forecast.upper)
    )
}

pub(super) fn time(milliseconds: u64) -> String {
    match milliseconds / 1000 {
        0 => "a moment".to_owned(),
        seconds @ 1..60 => format!("{seconds} s"),
        seconds => format!("{} min {} s", seconds / 60, seconds % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::{Activity, End, Ended, Parent, RefusalRecord, Via, View};
    use novamind_tools::Forecast;
    use serde_json::json;

    fn said(record: Record) -> Vec<String> {
        let at = "2026-11-21T10:42:07Z".to_owned();
        let entry = RecordView { seq: 1, day: 14, at, record, forecasts: Vec::new(), today: 14 };
        let names = CompanyNames::new(1, &novamind_world::params::Params::shipped().personas.email);
        brief(&entry, &names).into_iter().map(|(text, _)| text).collect()
    }

    fn scored(outcome: Option<f64>) -> ScoredForecast {
        let forecast = Forecast { horizon_days: 28, point: 1.5e6, lower: 1.4e6, upper: 1.6e6 };
        ScoredForecast { forecast, day: 14, outcome }
    }

    #[test]
    fn lines_are_told_in_few_words() {
        let call = |args, outcome, reversal| {
            let tool = novamind_tools::ToolId::SetPrices.into();
            Record::Call(Call { tool, args, outcome, via: Via::Form, took_ms: 0.1, reversal, request: None })
        };
        let accepted = |reversal| call(json!({"A": 12}), Outcome::Accepted(json!({})), reversal);
        assert_eq!(said(accepted(None)), ["set_prices A 12"]);
        assert_eq!(said(accepted(Some(Reversal::Undoes(3)))), ["undo: set_prices A 12"]);
        assert_eq!(said(accepted(Some(Reversal::Redoes(4)))), ["redo: set_prices A 12"]);
        let (code, message) = ("price_not_positive".to_owned(), "too low".to_owned());
        let refused = Outcome::Refused(RefusalRecord { code, message, ..RefusalRecord::default() });
        assert_eq!(said(call(json!({"A": -1}), refused, None)), ["set_prices A -1", "rejected: too low"]);
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
        assert_eq!(said(query(Some(1200), None)), ["SELECT 1 FROM x", "1,200 rows, 3 ms"]);
        assert_eq!(said(query(None, Some("sql_error"))), ["SELECT 1 FROM x", "rejected: sql_error"]);
        for (for_ms, words) in [(400, "a moment"), (1_500, "1 s"), (83_000, "1 min 23 s")] {
            let view = View { screen: "cash".to_owned(), from: String::new(), for_ms };
            assert_eq!(said(Record::Activity(Activity::View(view))), [format!("viewed cash for {words}")]);
        }
        let from = Some(Parent { run: "aa".to_owned(), seq: 3 });
        assert_eq!(said(Record::Branch(Branch { from })), ["branched off run aa here"]);
        let end = End { reason: Ended::Horizon, cash: 4.0, score: Some(4.0) };
        assert_eq!(said(Record::End(end)), ["the run ended: horizon"]);
    }

    #[test]
    fn what_was_still_to_come_is_marked() {
        for (outcome, later, words) in [
            (Some(1.55e6), false, "came $1.55M inside"),
            (Some(1.75e6), false, "came $1.75M OUTSIDE"),
            (Some(1.55e6), true, "later $1.55M inside"),
            (None, true, "day 42 not recorded"),
        ] {
            let (text, _) = forecast_in_brief(&scored(outcome), later);
            assert!(text.ends_with(words), "{text}");
            let full = forecast_in_full(&scored(outcome), later);
            assert!(full.contains("day  42"), "{full}");
        }
    }
}
