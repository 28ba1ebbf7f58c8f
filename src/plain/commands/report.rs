//! `report [week|run]`: reports on the last week or the whole run.

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::{Interpreter, argument_error};
use novamind_base::formatting::signed_dollars;
use novamind_report::{RunReport, WeekReport, figure_name, report_to_markdown};
use novamind_session::IntervalPosition;
use novamind_tools::Rejection;

/// Maximum number of changed figures in the text.
const MAX_LISTED_CHANGES: usize = 6;

impl Interpreter {
    pub(super) fn report(
        &self,
        what: Option<&str>,
        arguments: &[Argument],
    ) -> Result<CommandResponse, ParseError> {
        match what {
            None | Some("week") => Ok(self.week_report()),
            Some("run") => Ok(self.run_report()),
            Some(_) => Err(argument_error(arguments, "report takes week or run, for example: report week")),
        }
    }

    fn week_report(&self) -> CommandResponse {
        match WeekReport::from_session(&self.session) {
            Some(report) => CommandResponse::success("report", describe_week(&report), week_to_json(&report)),
            None => CommandResponse::rejected(
                "report",
                Rejection::new("no_week_yet", "no week has run yet. To simulate a week, type: next"),
            ),
        }
    }

    fn run_report(&self) -> CommandResponse {
        let run_report = RunReport::from_session(&self.session);
        let measures = &run_report.measures;
        let data = json!({
            "headline": run_report.headline(),
            "rank": run_report.ranking.rank,
            "survival_days": measures.survival_days,
            "cash": measures.cash,
            "best_tried_channel_share": measures.channels.as_ref().and_then(|skill| skill.share),
            "truly_best_channel_share": measures.truly_best.as_ref().map(|best| best.share),
            "targeted_development_share": measures.targeted_development,
            "forecasts": run_report.shows_forecast_scores().then_some(&measures.forecasts),
            "calls_per_week": measures.tools.per_week,
            "planning_words_per_rationale": measures.planning.planning_each,
            "report": report_to_markdown(&run_report),
        });
        CommandResponse::success("report", report_to_markdown(&run_report), data)
    }
}

/// Formats the report on a week, one sentence per line.
fn describe_week(report: &WeekReport) -> String {
    let week = &report.week;
    let parts: Vec<String> = report
        .cash_components
        .iter()
        .map(|(name, dollars)| format!("{name} {}", signed_dollars(*dollars)))
        .collect();
    let change = signed_dollars(week.cash_change);
    let mut lines =
        vec![format!("week to day {}: cash change {change}, of which {}", week.day, parts.join(", "))];
    lines.extend(report.short_week_note.iter().map(|short| format!("this is a week {short}")));
    if report.was_filed_at_limit() {
        lines.push(
            "the time limit for this week was reached: the week was submitted with naive forecasts"
                .to_owned(),
        );
    }
    if !report.decisions.is_empty() {
        lines.push(format!("decisions before the week: {}", report.decisions.join("; ")));
    }
    for moved in report.changed_figures.iter().take(MAX_LISTED_CHANGES) {
        let mut line = format!("{} {} → {}", figure_name(moved.name), moved.old, moved.new);
        let standing = moved.change.describe_rarity();
        if !standing.is_empty() {
            line += &format!(", {standing}");
        }
        if !moved.category_changes.is_empty() {
            let split = moved
                .category_changes
                .iter()
                .map(|(name, dollars)| format!("{name} {}", signed_dollars(*dollars)));
            line += &format!("; {}", split.collect::<Vec<_>>().join(", "));
        }
        lines.push(line);
    }
    for due in &report.due_forecasts {
        let ago = count_noun(due.forecast.horizon_days / 7, "week", "weeks");
        let miss = due.describe_error().map_or(String::new(), |miss| format!(", point {miss}"));
        let verdict = due.interval_position().map_or("open", IntervalPosition::as_str);
        let filed = if report.was_forecast_filed_at_limit(due) {
            ", submitted by the program at the time limit"
        } else {
            ""
        };
        lines.push(format!("forecast from {ago} ago{filed}: {verdict} the interval{miss}"));
    }
    lines.push(format!(
        "new: {}, {}, {}, {}, {}, {}",
        count_noun(week.threads_opened, "thread", "threads"),
        count_noun(week.replies, "reply", "replies"),
        count_noun(report.customer_posts, "post", "posts"),
        count_noun(report.comments, "comment on your posts", "comments on your posts"),
        count_noun(report.news_items, "news item", "news items"),
        count_noun(
            week.research_finished,
            "finished R&D project or study",
            "finished R&D projects and studies"
        )
    ));
    lines.join("\n").replace("from 1 weeks ago", "from 1 week ago")
}

fn count_noun(count: u32, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn parts_to_json(parts: &[(&'static str, f64)]) -> Value {
    parts.iter().map(|(name, dollars)| json!({ "part": name, "dollars": dollars })).collect()
}

fn week_to_json(report: &WeekReport) -> Value {
    let moved = |moved: &novamind_report::week::ChangedFigure| {
        json!({
            "figure": moved.name,
            "old": moved.change.old,
            "new": moved.change.new,
            "unusual": moved.change.unusualness,
            "standing": moved.change.describe_rarity(),
            "split": parts_to_json(&moved.category_changes),
        })
    };
    let due = |due: &novamind_session::ScoredForecast| {
        json!({
            "horizon_days": due.forecast.horizon_days,
            "point": due.forecast.point,
            "lower": due.forecast.lower,
            "upper": due.forecast.upper,
            "outcome": due.outcome,
            "inside": due.is_covered(),
        })
    };
    json!({
        "day": report.week.day,
        "cash_change": report.week.cash_change,
        "parts": parts_to_json(&report.cash_components),
        "decided": report.decisions,
        "filed_at_limit": report.was_filed_at_limit(),
        "moves": report.changed_figures.iter().map(moved).collect::<Vec<_>>(),
        "forecasts": report.due_forecasts.iter().map(due).collect::<Vec<_>>(),
    })
}
