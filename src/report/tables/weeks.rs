//! Columns of `weeks.csv`: a row for each week of a run.

use super::column::{Column, columns};
use super::{console_only, format_screen_seconds, format_tool_counts, screen_views_only_if_recorded};
use crate::logbook::{Logbook, WeekRecord};
use novamind_session::ScoredForecast;

pub(super) struct WeekRow<'a> {
    pub run: &'a Logbook,
    pub week: &'a WeekRecord,
}

impl WeekRow<'_> {
    fn forecast(&self, horizon_days: u32) -> Option<&ScoredForecast> {
        self.week.forecasts.iter().find(|scored| scored.forecast.horizon_days == horizon_days)
    }
}

const LOWER_MEANING: &str = "lower end of the forecast's 95 % interval";
const UPPER_MEANING: &str = "upper end of the forecast's 95 % interval";
const OUTCOME_MEANING: &str = "actual cash; empty before the target day or if the run ended earlier";

/// Name, unit and meaning of the figures in the closing line of a week. The columns have the same names.
const FIGURES: [(&str, &str, &str); 19] = [
    ("cash", "dollars", "cash at the end of the week"),
    ("individual_subscribers", "count", "active subscriptions of individuals"),
    ("enterprise_seats", "count", "seats of active enterprises"),
    ("open_issues", "count", "active subscribers with an open issue"),
    ("usage", "units", "units used in the week"),
    ("new_individual_leads", "count", "leads of individuals"),
    ("new_enterprise_leads", "count", "leads of enterprises that opened a thread"),
    ("new_individual_subscribers", "count", "individuals who signed up"),
    ("new_enterprise_seats", "count", "seats of enterprises that signed"),
    ("cancellations", "count", "cancellations of individuals"),
    ("upgrades", "count", "switches to higher-priced plans"),
    ("downgrades", "count", "switches to lower-priced plans"),
    ("overload_peak", "share", "largest overload of a day"),
    ("downtime_minutes", "minutes", "minutes of outages"),
    ("p95_ms_peak", "milliseconds", "highest latency of a day (95th percentile)"),
    ("error_rate_peak", "share", "highest error rate of a day"),
    ("payments", "dollars", "payments of subscribers"),
    ("costs", "dollars", "running costs"),
    ("recurring_revenue", "dollars a month", "monthly recurring revenue at the end of the week"),
];

pub(super) fn columns<'a>() -> Vec<Column<WeekRow<'a>>> {
    let mut columns = columns! { row: WeekRow<'a>;
        "run", "name", "name of the run" => row.run.run;
        "participant", "label", "label of the participant" => row.run.participant;
        "week", "number", "number of the week, from 1" => row.week.week;
        "decision_day", "day", "decision day" => row.week.decision_day;
        "day", "day", "last day of the week" => row.week.day;
        "days_run", "days", "simulated days: 7, or fewer in a shortened last week, the week of a bankruptcy or a step of a debug run"
            => row.week.days_run;
        "inherited", "0 or 1", "1: copied from the parent run, not played in this run"
            => row.week.inherited;
        "began_at", "RFC 3339", "time at which the player could start to decide: end of the week before, or start of the run" => row.week.began_at;
        "decided_at", "RFC 3339", "time when rationale and forecasts were filed" => row.week.decided_at;
        "elapsed_seconds", "seconds", "sum of active, answering, idle and away time before the week"
            => row.week.effort.time.elapsed_seconds();
        "active_seconds", "seconds", "active time" => row.week.effort.time.active_seconds();
        "answering_seconds", "seconds", "time with questions of the study" => row.week.effort.time.answering_seconds();
        "idle_seconds", "seconds", "time without a key press while the program is in front" => row.week.effort.time.idle_seconds();
        "away_seconds", "seconds", "time in which the run was closed, suspended or in the background, or its clock was stopped"
            => row.week.effort.time.away_seconds();
        "paused_seconds", "seconds", "part of away_seconds: time with the clock stopped" => row.week.effort.time.paused_seconds();
        "breaks", "count", "breaks: gaps of more than ten minutes in play" => row.week.effort.breaks;
        "implausibly_fast", "0 or 1", "1: decided in less than ten active seconds" => row.week.implausibly_fast;
        "calls", "count", "accepted tool calls" => row.week.effort.calls;
        "refused", "count", "rejected tool calls" => row.week.effort.refused;
        "undone", "count", "accepted calls that undid an earlier call" => row.week.effort.undone;
        "tools", "tool=count", "accepted calls by tool" => format_tool_counts(&row.week.effort);
        "queries", "count", "SQL queries" => row.week.effort.queries;
        "queries_failed", "count", "queries that were rejected or failed" => row.week.effort.queries_failed;
        "views", "count", "views of screens (console only)" => screen_views_only_if_recorded(row.run, row.week.effort.views);
        "screens", "screen=seconds", "active time on each screen (console only)" => format_screen_seconds(&row.week.effort);
        "selects", "count", "objects opened: groups, threads, tools, posts, studies" => row.week.effort.selects;
        "dialogs_confirmed", "count", "dialogs confirmed (console only)"
            => console_only(row.run, row.week.effort.dialogs_confirmed);
        "dialogs_cancelled", "count", "dialogs cancelled (console only)"
            => console_only(row.run, row.week.effort.dialogs_cancelled);
        "helps", "count", "explanations of terms opened" => row.week.effort.helps;
        "drafts_left", "count", "texts edited and not submitted (console only)"
            => console_only(row.run, row.week.effort.drafts_left);
        "typed_characters", "count", "characters typed into texts (console only)" => console_only(row.run, row.week.effort.typed);
        "deleted_characters", "count", "characters deleted from texts (console only)"
            => console_only(row.run, row.week.effort.deleted);
        "pasted_characters", "count", "typed characters that came from the clipboard (console only)"
            => console_only(row.run, row.week.effort.pasted);
        "memos", "count", "changes to the notes" => row.week.effort.memos;
        "decisions", "count", "settings that differ from the week before, purchases, offers and posts"
            => row.week.decisions.len();
        "rationale_words", "count", "words of the rationale" => row.week.wording.words;
        "planning_words", "count", "planning words of the rationale (as in runs.csv)" => row.week.wording.planning;
        "if_words", "count", "occurrences of \"if\" in the rationale" => row.week.wording.ifs;
        "filled_naively", "0 or 1", "1: at least one forecast was naive" => row.week.filled_naively;
        "filed_at_limit", "0 or 1", "1: the week was filed automatically at a time limit" => row.week.filed_at_limit;
        "forecast_7_point", "dollars", "cash predicted for 7 days ahead" => row.forecast(7).map(|scored_forecast| scored_forecast.forecast.point);
        "forecast_7_lower", "dollars", LOWER_MEANING => row.forecast(7).map(|scored_forecast| scored_forecast.forecast.lower);
        "forecast_7_upper", "dollars", UPPER_MEANING => row.forecast(7).map(|scored_forecast| scored_forecast.forecast.upper);
        "forecast_7_outcome", "dollars", OUTCOME_MEANING => row.forecast(7).and_then(|scored_forecast| scored_forecast.outcome);
        "forecast_28_point", "dollars", "cash predicted for 28 days ahead" => row.forecast(28).map(|scored_forecast| scored_forecast.forecast.point);
        "forecast_28_lower", "dollars", LOWER_MEANING => row.forecast(28).map(|scored_forecast| scored_forecast.forecast.lower);
        "forecast_28_upper", "dollars", UPPER_MEANING => row.forecast(28).map(|scored_forecast| scored_forecast.forecast.upper);
        "forecast_28_outcome", "dollars", OUTCOME_MEANING => row.forecast(28).and_then(|scored_forecast| scored_forecast.outcome);
        "forecast_84_point", "dollars", "cash predicted for 84 days ahead" => row.forecast(84).map(|scored_forecast| scored_forecast.forecast.point);
        "forecast_84_lower", "dollars", LOWER_MEANING => row.forecast(84).map(|scored_forecast| scored_forecast.forecast.lower);
        "forecast_84_upper", "dollars", UPPER_MEANING => row.forecast(84).map(|scored_forecast| scored_forecast.forecast.upper);
        "forecast_84_outcome", "dollars", OUTCOME_MEANING => row.forecast(84).and_then(|scored_forecast| scored_forecast.outcome);
        "forecast_182_point", "dollars", "cash predicted for 182 days ahead" => row.forecast(182).map(|scored_forecast| scored_forecast.forecast.point);
        "forecast_182_lower", "dollars", LOWER_MEANING => row.forecast(182).map(|scored_forecast| scored_forecast.forecast.lower);
        "forecast_182_upper", "dollars", UPPER_MEANING => row.forecast(182).map(|scored_forecast| scored_forecast.forecast.upper);
        "forecast_182_outcome", "dollars", OUTCOME_MEANING => row.forecast(182).and_then(|scored_forecast| scored_forecast.outcome);
    };
    columns.extend(FIGURES.map(|(name, unit, meaning)| {
        Column::new(name, unit, meaning, move |row: &WeekRow<'a>| {
            let number = row.week.figures.get(name).filter(|value| value.is_number());
            number.map(ToString::to_string).unwrap_or_default()
        })
    }));
    columns.extend(columns! { row: WeekRow<'a>;
        "state_hash", "hash", "state hash after the week" => row.week.state_hash;
    });
    columns
}
