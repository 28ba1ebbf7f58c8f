//! A recorded line with the outcomes of its forecasts.

use crate::figures::scored_forecast::ScoredForecast;
use novamind_record::trajectory::{Line, Record};
use novamind_tools::Forecast;

/// A recorded line with the outcomes of its forecasts.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordView {
    /// Number of the line.
    pub seq: u64,
    /// Day on which the line was written.
    pub day: u32,
    /// Time at which the line was written, RFC 3339.
    pub at: String,
    /// Event that the line records.
    pub record: Record,
    /// Forecasts in the line, with outcomes from the complete record, including outcomes after the current day.
    pub forecasts: Vec<ScoredForecast>,
    /// Current day of the playback. Outcomes after this day were not known to the player.
    pub today: u32,
}

impl RecordView {
    pub(crate) fn new(line: &Line, today: u32, outcome: &dyn Fn(u32) -> Option<f64>) -> RecordView {
        let scored = |forecast: Forecast| {
            let open = ScoredForecast { forecast, day: line.day, outcome: None };
            ScoredForecast { outcome: outcome(open.due_day()), ..open }
        };
        let forecasts = match &line.record {
            Record::Advance(filed) => filed.forecasts.iter().map(|one| scored(one.to_forecast())).collect(),
            _ => Vec::new(),
        };
        let Line { seq, day, at, record, .. } = line.clone();
        RecordView { seq, day, at, record, forecasts, today }
    }

    /// Returns whether the outcome of a forecast was unknown on the current day.
    pub fn is_future(&self, forecast: &ScoredForecast) -> bool {
        forecast.due_day() > self.today
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::scored_forecast::IntervalPosition;
    use novamind_record::trajectory::record::{Advance, SubmittedForecast, Via};

    #[test]
    fn record_view_marks_future_forecasts() {
        let one = |horizon_days| SubmittedForecast {
            horizon_days,
            point: 100.0,
            lower: 80.0,
            upper: 95.0,
            filled_naively: false,
        };
        let advance = Advance {
            rationale: "if".to_owned(),
            forecasts: vec![one(7), one(28)],
            via: Via::Form,
            calculations: Vec::new(),
            request: None,
        };
        let line = Line::detached(5, 14, "", Record::Advance(advance));
        let view = RecordView::new(&line, 21, &|due| (due == 21).then_some(90.0));
        let [first, second] = view.forecasts[..] else { panic!("{view:?}") };
        assert_eq!(
            (first.due_day(), first.interval_position(), view.is_future(&first)),
            (21, Some(IntervalPosition::Inside), false)
        );
        assert_eq!((second.due_day(), second.interval_position(), view.is_future(&second)), (42, None, true));
    }
}
