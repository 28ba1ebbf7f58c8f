//! Splits the lines of a trajectory into time spans. Each span contains a week and the actions before it.

use serde::Serialize;
use serde_json::{Map, Value};

use super::PlayerEffort;
use novamind_record::clock::format_timestamp;
use novamind_record::trajectory::record::{
    Activity, ClosedDays, LimitEvent, Outcome, Reversal, ScreenView, SubmittedForecast,
};
use novamind_record::trajectory::{Line, Record};
use novamind_session::{Attendance, AttendedWeek, MIN_BREAK_SECONDS, TimeUse};

/// A gap of more than ten minutes in play.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlayBreak {
    /// Day of the run on which the break occurred.
    pub day: u32,
    /// Start of the break, RFC 3339.
    pub from: String,
    /// End of the break, RFC 3339.
    pub to: String,
    /// Duration of the break in seconds.
    pub seconds: f64,
}

#[derive(Debug, Clone, Default)]
pub(super) struct WeekSpan {
    pub decision_day: u32,
    pub day: u32,
    pub days_run: u32,
    pub began_at: String,
    pub decided_at: String,
    pub effort: PlayerEffort,
    pub rationale: Option<String>,
    pub forecasts: Vec<SubmittedForecast>,
    /// Whether the week was filed automatically because a time limit was reached, so that the rationale is not the
    /// player's.
    pub filed_at_limit: bool,
    pub figures: Map<String, Value>,
    pub state_hash: String,
    /// Start and end of the span on the time axis of the run.
    pub attended: AttendedWeek,
}

#[derive(Debug, Clone, Default)]
pub(super) struct Timeline {
    /// One span for each line that closes one or more days.
    pub spans: Vec<WeekSpan>,
    pub open: WeekSpan,
    pub breaks: Vec<PlayBreak>,
    pub clock_set_back: u32,
}

impl Timeline {
    /// Builds a timeline from the lines of a trajectory in order.
    pub fn from_lines(lines: &[Line]) -> Timeline {
        let mut timeline = Timeline::default();
        let mut before: Option<&Line> = None;
        let mut attendance = Attendance::default();
        let mut places = Vec::with_capacity(lines.len());
        let mut views = Vec::new();
        for line in lines {
            if timeline.open.began_at.is_empty() {
                timeline.open.began_at = before.unwrap_or(line).at.clone();
                timeline.open.decision_day = before.unwrap_or(line).day;
            }
            attendance.add_line(line.at_nanoseconds(), &line.record);
            places.push(attendance.end_ns());
            if let Record::Activity(Activity::View(view)) = &line.record {
                views.push((timeline.spans.len(), attendance.end_ns(), view));
            }
            timeline.add_line(line);
            before = Some(line);
        }
        timeline.clock_set_back = attendance.clock_set_back_count();
        // Only a later line shows when an idle period started, so times are classified after all lines are read.
        let last =
            AttendedWeek { from: attendance.week_start_ns(), to: attendance.end_ns(), is_inherited: false };
        let spans = timeline.spans.iter_mut().chain([&mut timeline.open]);
        for (span, week) in spans.zip(attendance.weeks().iter().chain([&last])) {
            span.attended = *week;
            span.effort.time = attendance.spent_between(week.from, week.to);
        }
        timeline.add_breaks(&attendance, lines, &places);
        for (week, place, view) in views {
            timeline.distribute_view_time(week, place, view, &attendance);
        }
        timeline
    }

    /// Records gaps of more than ten minutes in play. A break belongs to the week in which it ended.
    fn add_breaks(&mut self, attendance: &Attendance, lines: &[Line], places: &[i64]) {
        let mut merged_intervals: Vec<(i64, i64)> = Vec::new();
        for time in attendance.spans() {
            match (time.time_use, merged_intervals.last_mut()) {
                (TimeUse::Active | TimeUse::Answering | TimeUse::Simulating, _) => {}
                (_, Some((_, to))) if *to == time.from => *to = time.to,
                _ => merged_intervals.push((time.from, time.to)),
            }
        }
        for (from, to) in merged_intervals {
            let seconds = attendance.spent_between(from, to).elapsed_seconds();
            let last = places.partition_point(|place| *place < to).min(lines.len() - 1);
            if seconds <= MIN_BREAK_SECONDS {
                continue;
            }
            let began = places.partition_point(|place| *place <= from).saturating_sub(1);
            self.breaks.push(PlayBreak {
                day: lines[last].day,
                from: format_timestamp(lines[began].at_nanoseconds() + from - places[began]),
                to: lines[last].at.clone(),
                seconds,
            });
            let week_span =
                self.spans.iter_mut().find(|span| span.attended.from < to && to <= span.attended.to);
            week_span.unwrap_or(&mut self.open).effort.breaks += 1;
        }
    }

    /// Distributes the active time of a screen view over the weeks that the view overlaps. The line of a view is
    /// written when the view ends.
    fn distribute_view_time(&mut self, week: usize, place: i64, view: &ScreenView, attendance: &Attendance) {
        let length = i64::try_from(view.for_ms).unwrap_or(i64::MAX).saturating_mul(1_000_000);
        let began = place.saturating_sub(length).max(0);
        let spans = self.spans.iter_mut().chain([&mut self.open]).take(week + 1);
        for span in spans.filter(|span| span.attended.to > began && !span.attended.is_inherited) {
            let AttendedWeek { from, to, .. } = span.attended;
            let time = attendance.spent_between(began.max(from), place.min(to));
            *span.effort.screens.entry(view.screen.clone()).or_default() += time;
        }
    }

    fn add_line(&mut self, line: &Line) {
        let effort = &mut self.open.effort;
        match &line.record {
            Record::Call(call) if matches!(call.outcome, Outcome::Accepted(_)) => {
                effort.calls += 1;
                effort.undone += u32::from(matches!(call.reversal, Some(Reversal::Undoes(_))));
                *effort.tools.entry(call.tool.to_string()).or_default() += 1;
            }
            Record::Call(_) => effort.refused += 1,
            Record::Query(query) => {
                effort.queries += 1;
                effort.queries_failed += u32::from(query.error.is_some());
            }
            Record::Activity(activity) => {
                effort.add_activity(activity);
                let limit = if let Activity::Limit(limit) = activity { Some(limit.event) } else { None };
                self.open.filed_at_limit |= limit == Some(LimitEvent::FiledNaively);
            }
            Record::Memo(_) | Record::Note(_) => effort.memos += 1,
            Record::Advance(filed) => {
                self.open.decided_at.clone_from(&line.at);
                self.open.rationale = Some(filed.rationale.clone());
                self.open.forecasts.clone_from(&filed.forecasts);
            }
            Record::Week(closing) | Record::Step(closing) => self.close_week(line, closing),
            Record::Start(_)
            | Record::Branch(_)
            | Record::Override(_)
            | Record::Voice(_)
            | Record::End(_)
            | Record::Unknown(_) => {}
        }
    }

    fn close_week(&mut self, line: &Line, closing: &ClosedDays) {
        let mut span = std::mem::take(&mut self.open);
        span.day = line.day;
        span.days_run = closing.days_run;
        span.decision_day = line.day.saturating_sub(span.days_run);
        if span.decided_at.is_empty() {
            span.decided_at.clone_from(&line.at);
        }
        span.figures.clone_from(&closing.figures);
        span.state_hash.clone_from(&closing.state_hash);
        self.spans.push(span);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::{Advance, Branch, Call, Memo, Query, Via};
    use serde_json::json;

    fn lines(all: &[(&str, Record)]) -> Vec<Line> {
        let line = |(at, (moment, record)): (usize, &(&str, Record))| {
            Line::detached(at as u64, 0, &format!("2026-11-21T{moment}Z"), record.clone())
        };
        all.iter().enumerate().map(line).collect()
    }

    fn start_line() -> Record {
        Record::Unknown("start".to_owned())
    }

    fn call_line() -> Record {
        let outcome = Outcome::Accepted(json!({}));
        Record::Call(Call {
            tool: novamind_tools::ToolId::SetPrices.into(),
            args: json!({}),
            outcome,
            via: Via::Form,
            took_ms: 0.0,
            reversal: None,
            request: None,
        })
    }

    fn memo_line() -> Record {
        Record::Memo(Memo { digest: String::new(), length: 0 })
    }

    fn advance_line() -> Record {
        let (rationale, forecasts, calculations) = ("wait".to_owned(), Vec::new(), Vec::new());
        Record::Advance(Advance { rationale, forecasts, via: Via::Form, calculations, request: None })
    }

    fn week_line() -> Record {
        let (figures, state_hash, parts) = Default::default();
        Record::Week(ClosedDays { days_run: 7, figures, cash: 0.0, state_hash, parts })
    }

    #[test]
    fn breaks_and_simulation_time_are_not_player_time() {
        let view = ScreenView { screen: "cash".to_owned(), from: String::new(), for_ms: 1_560_000 };
        let sql = "x".to_owned();
        let query = Query {
            sql,
            rows: Some(1),
            truncated: false,
            error: None,
            message: None,
            stopped: false,
            via: None,
            took_ms: 1.0,
        };
        let timeline = Timeline::from_lines(&lines(&[
            ("10:00:00", start_line()),
            ("10:05:00", call_line()),
            ("10:30:00", Record::Activity(Activity::View(view))),
            ("10:31:00", advance_line()),
            ("10:32:00", week_line()),
            ("10:33:00", Record::Query(query)),
        ]));
        let effort = &timeline.spans[0].effort;
        let time = effort.time;
        assert_eq!((time.elapsed_seconds(), time.active_seconds(), effort.breaks), (1860.0, 360.0, 1));
        assert_eq!((time.idle_seconds(), time.away_seconds()), (0.0, 1500.0));
        assert_eq!(timeline.breaks[0].seconds, 1500.0);
        assert_eq!(effort.screens["cash"].active_seconds(), 60.0, "26 minutes minus a break of 25");
        assert_eq!((timeline.open.effort.queries, timeline.open.effort.queries_failed), (1, 0));
        assert_eq!(timeline.open.effort.time.active_seconds(), 60.0);
    }

    #[test]
    fn view_time_is_split_by_week() {
        let view = |for_ms| {
            Record::Activity(Activity::View(ScreenView {
                screen: "cash".to_owned(),
                from: String::new(),
                for_ms,
            }))
        };
        let timeline = Timeline::from_lines(&lines(&[
            ("10:00:00", start_line()),
            ("10:01:00", advance_line()),
            ("10:01:30", week_line()),
            ("10:03:30", view(180_000)),
            ("10:04:00", view(20_000)),
        ]));
        let seconds = |effort: &PlayerEffort| effort.screens["cash"].active_seconds();
        assert_eq!(seconds(&timeline.spans[0].effort), 30.0, "simulation time is not counted");
        assert_eq!(seconds(&timeline.open.effort), 120.0 + 20.0);
    }

    #[test]
    fn clock_set_back_does_not_reduce_time() {
        let timeline = Timeline::from_lines(&lines(&[
            ("10:00:00", start_line()),
            ("10:01:00", memo_line()),
            ("09:00:00", memo_line()),
            ("09:02:00", memo_line()),
        ]));
        assert_eq!((timeline.open.effort.time.active_seconds(), timeline.clock_set_back), (180.0, 1));
    }

    #[test]
    fn inherited_weeks_are_marked_and_have_no_time() {
        let timeline = Timeline::from_lines(&lines(&[
            ("10:00:00", start_line()),
            ("10:00:01", advance_line()),
            ("10:00:02", week_line()),
            ("10:00:03", Record::Branch(Branch { from: None })),
            ("10:01:03", advance_line()),
            ("10:01:04", week_line()),
        ]));
        let seen: Vec<(bool, f64)> = timeline
            .spans
            .iter()
            .map(|span| (span.attended.is_inherited, span.effort.time.active_seconds()))
            .collect();
        assert_eq!(seen, [(true, 0.0), (false, 60.0)]);
    }
}
