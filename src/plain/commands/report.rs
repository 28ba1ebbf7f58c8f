//! `report [week|run]`: a report on a week or the whole run.

use serde_json::{Value, json};

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{Interpreter, problem};
use novamind_base::notation::signed_dollars;
use novamind_report::{Story, WeekReport, as_markdown};
use novamind_session::Verdict;
use novamind_tools::Refusal;

/// Maximum number of changed figures in the text.
const TOLD: usize = 6;

impl Interpreter {
    pub(super) fn report(&self, what: Option<&str>, arguments: &[Argument]) -> Result<Answer, Problem> {
        match what {
            None | Some("week") => Ok(self.week_report()),
            Some("run") => Ok(self.run_report()),
            Some(_) => Err(problem(arguments, "report takes week or run: report week, report run")),
        }
    }

    fn week_report(&self) -> Answer {
        match WeekReport::of_session(&self.session) {
            Some(report) => Answer::done("report", in_words(&report), as_data(&report)),
            None => {
                Answer::refused("report", Refusal::new("no_week_yet", "no week has run yet; next runs one"))
            }
        }
    }

    fn run_report(&self) -> Answer {
        let story = Story::of(&self.session);
        let measures = &story.measures;
        let data = json!({
            "headline": story.headline(),
            "rank": story.standing.rank,
            "survival_days": measures.survival_days,
            "cash": measures.cash,
            "best_tried_channel_share": measures.channels.as_ref().and_then(|skill| skill.share),
            "truly_best_channel_share": measures.truly_best.as_ref().map(|best| best.share),
            "targeted_development_share": measures.targeted_development,
            "forecasts": story.shows_calibration().then_some(&measures.forecasts),
            "calls_per_week": measures.tools.per_week,
            "planning_words_per_rationale": measures.planning.planning_each,
            "report": as_markdown(&story),
        });
        Answer::done("report", as_markdown(&story), data)
    }
}

/// Formats the report on a week, one sentence per line.
fn in_words(report: &WeekReport) -> String {
    let week = &report.week;
    let parts: Vec<String> =
        report.parts.iter().map(|(name, dollars)| format!("{name} {}", signed_dollars(*dollars))).collect();
    let change = signed_dollars(week.cash_change);
    let mut lines =
        vec![format!("week to day {}: cash change {change}, of which {}", week.day, parts.join(", "))];
    lines.extend(report.short.iter().map(|short| format!("this is a week {short}")));
    if report.was_filed_at_limit() {
        lines.push(
            "the time limit for this week was reached: it was submitted with the naive projection".to_owned(),
        );
    }
    if !report.decided.is_empty() {
        lines.push(format!("decisions before it: {}", report.decided.join("; ")));
    }
    for moved in report.moves.iter().take(TOLD) {
        let mut line = format!("{} {} → {}", moved.name, moved.old, moved.new);
        let standing = moved.movement.standing();
        if !standing.is_empty() {
            line += &format!(", {standing}");
        }
        if !moved.split.is_empty() {
            let split =
                moved.split.iter().map(|(name, dollars)| format!("{name} {}", signed_dollars(*dollars)));
            line += &format!("; {}", split.collect::<Vec<_>>().join(", "));
        }
        lines.push(line);
    }
    for due in &report.due {
        let ago = counted(due.forecast.horizon_days / 7, "week", "weeks");
        let miss = due.miss_in_words().map_or(String::new(), |miss| format!(", point {miss}"));
        let verdict = due.verdict().map_or("open", Verdict::word);
        let filed = if report.is_of_limit(due) { ", submitted by the program at the time limit" } else { "" };
        lines.push(format!("forecast from {ago} ago{filed}: {verdict} the interval{miss}"));
    }
    lines.push(format!(
        "new: {}, {}, {}, {}, {}, {}",
        counted(week.threads_opened, "thread", "threads"),
        counted(week.replies, "reply", "replies"),
        counted(report.customer_posts, "post", "posts"),
        counted(report.comments, "comment on your posts", "comments on your posts"),
        counted(report.news_items, "news item", "news items"),
        counted(week.research_finished, "finished R&D project or study", "finished R&D projects and studies")
    ));
    lines.join("\n").replace("from 1 weeks ago", "from 1 week ago")
}

fn counted(count: u32, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

fn parts(parts: &[(&'static str, f64)]) -> Value {
    parts.iter().map(|(name, dollars)| json!({ "part": name, "dollars": dollars })).collect()
}

fn as_data(report: &WeekReport) -> Value {
    let moved = |moved: &novamind_report::week::Move| {
        json!({
            "figure": moved.name,
            "old": moved.movement.old,
            "new": moved.movement.new,
            "unusual": moved.movement.unusual,
            "standing": moved.movement.standing(),
            "split": parts(&moved.split),
        })
    };
    let due = |due: &novamind_session::ScoredForecast| {
        json!({
            "horizon_days": due.forecast.horizon_days,
            "point": due.forecast.point,
            "lower": due.forecast.lower,
            "upper": due.forecast.upper,
            "outcome": due.outcome,
            "inside": due.is_inside(),
        })
    };
    json!({
        "day": report.week.day,
        "cash_change": report.week.cash_change,
        "parts": parts(&report.parts),
        "decided": report.decided,
        "filed_at_limit": report.was_filed_at_limit(),
        "moves": report.moves.iter().map(moved).collect::<Vec<_>>(),
        "forecasts": report.due.iter().map(due).collect::<Vec<_>>(),
    })
}
