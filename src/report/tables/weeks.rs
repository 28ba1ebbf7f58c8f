//! The columns of `weeks.csv`.

use super::{Column, WeekColumn, flag, heading, in_console, maybe, number, screens, seen, tools};
use crate::logbook::{Logbook, WeekLog};
use novamind_session::ScoredForecast;

/// Something of the forecast this many days ahead; empty if there is none.
fn said(week: &WeekLog, horizon_days: u32, part: impl Fn(&ScoredForecast) -> Option<f64>) -> String {
    maybe(week.forecasts.iter().find(|scored| scored.forecast.horizon_days == horizon_days).and_then(part))
}

fn point<const DAYS: u32>(_: &Logbook, week: &WeekLog) -> String {
    said(week, DAYS, |scored| Some(scored.forecast.point))
}

fn lower<const DAYS: u32>(_: &Logbook, week: &WeekLog) -> String {
    said(week, DAYS, |scored| Some(scored.forecast.lower))
}

fn upper<const DAYS: u32>(_: &Logbook, week: &WeekLog) -> String {
    said(week, DAYS, |scored| Some(scored.forecast.upper))
}

fn outcome<const DAYS: u32>(_: &Logbook, week: &WeekLog) -> String {
    said(week, DAYS, |scored| scored.outcome)
}

const LOWER: &str = "lower end of its interval";
const UPPER: &str = "upper end of its interval";
const OUTCOME: &str = "outcome; empty before its day, or if the run ended earlier";

fn figure(week: &WeekLog, name: &str) -> String {
    week.figures.get(name).filter(|value| value.is_number()).map(ToString::to_string).unwrap_or_default()
}

const fn column(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    cell: fn(&Logbook, &WeekLog) -> String,
) -> WeekColumn {
    Column { heading: heading(name, unit, meaning), cell }
}

/// The columns, in their order.
pub const WEEKS: &[WeekColumn] = &[
    column("run", "name", "name of the run", |run, _| run.run.clone()),
    column("participant", "label", "who played", |run, _| run.participant.clone().unwrap_or_default()),
    column("week", "number", "number of the week, from 1", |_, week| week.week.to_string()),
    column("decision_day", "day", "day on which it was decided", |_, week| week.decision_day.to_string()),
    column("day", "day", "last day of the week", |_, week| week.day.to_string()),
    column(
        "days_run",
        "days",
        "days that ran: 7 but in a shortened last week, a bankruptcy, or steps of a debug run",
        |_, week| week.days_run.to_string(),
    ),
    column(
        "inherited",
        "0 or 1",
        "1: taken over from the run that this one branched from; nobody played it here",
        |_, week| flag(week.inherited),
    ),
    column(
        "began_at",
        "RFC 3339",
        "when deciding began: the end of the week before, or the start of the run",
        |_, week| week.began_at.clone(),
    ),
    column("decided_at", "RFC 3339", "when rationale and forecasts were filed", |_, week| {
        week.decided_at.clone()
    }),
    column(
        "elapsed_seconds",
        "seconds",
        "active, answering, idle and away together, of the time before the week",
        |_, week| number(week.effort.time.elapsed_seconds()),
    ),
    column("active_seconds", "seconds", "time played", |_, week| number(week.effort.time.active_seconds())),
    column("answering_seconds", "seconds", "time with questions of the study", |_, week| {
        number(week.effort.time.answering_seconds())
    }),
    column("idle_seconds", "seconds", "time without a key, the program in front", |_, week| {
        number(week.effort.time.idle_seconds())
    }),
    column(
        "away_seconds",
        "seconds",
        "time in which the run was closed, suspended, in the background, or its clock stopped",
        |_, week| number(week.effort.time.away_seconds()),
    ),
    column("paused_seconds", "seconds", "of it, time with the clock stopped", |_, week| {
        number(week.effort.time.paused_seconds())
    }),
    column("breaks", "count", "times of more than ten minutes in which nobody played", |_, week| {
        week.effort.breaks.to_string()
    }),
    column("implausibly_fast", "0 or 1", "1: decided in less than ten active seconds", |_, week| {
        flag(week.implausibly_fast)
    }),
    column("calls", "count", "calls of tools that were accepted", |_, week| week.effort.calls.to_string()),
    column("refused", "count", "calls of tools that were refused", |_, week| week.effort.refused.to_string()),
    column("undone", "count", "accepted calls that took back another", |_, week| {
        week.effort.undone.to_string()
    }),
    column("tools", "tool=count", "accepted calls by tool", |_, week| tools(&week.effort)),
    column("queries", "count", "SQL queries", |_, week| week.effort.queries.to_string()),
    column("queries_failed", "count", "queries that were refused or failed", |_, week| {
        week.effort.queries_failed.to_string()
    }),
    column("views", "count", "views of screens (console only)", |run, week| seen(run, week.effort.views)),
    column("screens", "screen=seconds", "active time on each screen (console only)", |_, week| {
        screens(&week.effort)
    }),
    column(
        "selects",
        "count",
        "objects that were opened: groups, threads, tools, posts, studies",
        |_, week| week.effort.selects.to_string(),
    ),
    column(
        "dialogs_confirmed",
        "count",
        "dialogs whose question was confirmed (console only)",
        |run, week| in_console(run, week.effort.dialogs_confirmed),
    ),
    column("dialogs_cancelled", "count", "dialogs that were left (console only)", |run, week| {
        in_console(run, week.effort.dialogs_cancelled)
    }),
    column("helps", "count", "terms that were explained", |_, week| week.effort.helps.to_string()),
    column("drafts_left", "count", "texts that were edited and left behind (console only)", |run, week| {
        in_console(run, week.effort.drafts_left)
    }),
    column("typed_characters", "count", "characters typed into texts (console only)", |run, week| {
        in_console(run, week.effort.typed)
    }),
    column("deleted_characters", "count", "characters deleted from them (console only)", |run, week| {
        in_console(run, week.effort.deleted)
    }),
    column(
        "pasted_characters",
        "count",
        "characters of them that came from the clipboard (console only)",
        |run, week| in_console(run, week.effort.pasted),
    ),
    column("memos", "count", "changes of the notes", |_, week| week.effort.memos.to_string()),
    column(
        "decisions",
        "count",
        "settings that differ from the week before, purchases, offers and posts",
        |_, week| week.decisions.len().to_string(),
    ),
    column("rationale_words", "count", "words of the rationale", |_, week| week.wording.words.to_string()),
    column("planning_words", "count", "words of planning among them (as in runs.csv)", |_, week| {
        week.wording.planning.to_string()
    }),
    column("if_words", "count", "how often it says \"if\"", |_, week| week.wording.ifs.to_string()),
    column(
        "filled_naively",
        "0 or 1",
        "1: at least one forecast was filled by the naive projection",
        |_, week| week.filled_naively.map(flag).unwrap_or_default(),
    ),
    column("filed_at_limit", "0 or 1", "1: a time limit filed the week", |_, week| flag(week.filed_at_limit)),
    column("forecast_7_point", "dollars", "cash expected 7 days ahead", point::<7>),
    column("forecast_7_lower", "dollars", LOWER, lower::<7>),
    column("forecast_7_upper", "dollars", UPPER, upper::<7>),
    column("forecast_7_outcome", "dollars", OUTCOME, outcome::<7>),
    column("forecast_28_point", "dollars", "cash expected 28 days ahead", point::<28>),
    column("forecast_28_lower", "dollars", LOWER, lower::<28>),
    column("forecast_28_upper", "dollars", UPPER, upper::<28>),
    column("forecast_28_outcome", "dollars", OUTCOME, outcome::<28>),
    column("forecast_84_point", "dollars", "cash expected 84 days ahead", point::<84>),
    column("forecast_84_lower", "dollars", LOWER, lower::<84>),
    column("forecast_84_upper", "dollars", UPPER, upper::<84>),
    column("forecast_84_outcome", "dollars", OUTCOME, outcome::<84>),
    column("forecast_182_point", "dollars", "cash expected 182 days ahead", point::<182>),
    column("forecast_182_lower", "dollars", LOWER, lower::<182>),
    column("forecast_182_upper", "dollars", UPPER, upper::<182>),
    column("forecast_182_outcome", "dollars", OUTCOME, outcome::<182>),
    column("cash", "dollars", "cash at the end of the week", |_, week| figure(week, "cash")),
    column("individual_subscribers", "count", "active subscriptions of individuals", |_, week| {
        figure(week, "individual_subscribers")
    }),
    column("enterprise_seats", "count", "seats of active companies", |_, week| {
        figure(week, "enterprise_seats")
    }),
    column("open_issues", "count", "active subscribers with an open issue", |_, week| {
        figure(week, "open_issues")
    }),
    column("usage", "units", "units used in the week", |_, week| figure(week, "usage")),
    column("new_individual_leads", "count", "leads of individuals", |_, week| {
        figure(week, "new_individual_leads")
    }),
    column("new_enterprise_leads", "count", "leads of companies that opened a thread", |_, week| {
        figure(week, "new_enterprise_leads")
    }),
    column("new_individual_subscribers", "count", "individuals who signed up", |_, week| {
        figure(week, "new_individual_subscribers")
    }),
    column("new_enterprise_seats", "count", "seats of companies that signed", |_, week| {
        figure(week, "new_enterprise_seats")
    }),
    column("cancellations", "count", "cancellations of individuals", |_, week| figure(week, "cancellations")),
    column("upgrades", "count", "switches to higher-priced plans", |_, week| figure(week, "upgrades")),
    column("downgrades", "count", "switches to lower-priced plans", |_, week| figure(week, "downgrades")),
    column("overload_peak", "share", "largest overload of a day", |_, week| figure(week, "overload_peak")),
    column("downtime_minutes", "minutes", "minutes of outages", |_, week| figure(week, "downtime_minutes")),
    column("p95_ms_peak", "milliseconds", "highest latency of a day (95th percentile)", |_, week| {
        figure(week, "p95_ms_peak")
    }),
    column("error_rate_peak", "share", "highest error rate of a day", |_, week| {
        figure(week, "error_rate_peak")
    }),
    column("payments", "dollars", "payments of subscribers", |_, week| figure(week, "payments")),
    column("costs", "dollars", "running costs", |_, week| figure(week, "costs")),
    column("recurring_revenue", "dollars a month", "monthly recurring revenue at the end", |_, week| {
        figure(week, "recurring_revenue")
    }),
    column("state_hash", "hash", "state after the week", |_, week| week.state_hash.clone()),
];
