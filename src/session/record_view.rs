//! A line of a trajectory as somebody looks back at it: what it says, and what came of its forecasts.

use super::trajectory::{Line, Record};
use crate::tools::Forecast;

/// A line, and what is known by now of what it foresaw.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordView {
    /// Number of the line.
    pub seq: u64,
    /// Day of the run.
    pub day: u32,
    /// When it was written, RFC 3339.
    pub at: String,
    /// What it says.
    pub record: Record,
    /// What came of its forecasts, one for each.
    pub forecasts: Vec<Foreseen>,
}

/// A forecast, and what came of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foreseen {
    /// What was said.
    pub forecast: Forecast,
    /// The day it speaks of.
    pub due: u32,
    /// Cash on that day, dollars; none where nobody recorded it.
    pub outcome: Option<f64>,
    /// The day had not come yet at the moment that is looked at: the outcome is taken from the rest of the record.
    pub later: bool,
}

impl Foreseen {
    /// Whether the interval held what came; none where that is not known.
    pub fn is_inside(&self) -> Option<bool> {
        self.outcome.map(|cash| self.forecast.lower <= cash && cash <= self.forecast.upper)
    }
}

impl RecordView {
    /// A line. `outcome` knows cash on a day, and whether that day had not come yet.
    pub(super) fn of(line: &Line, outcome: &dyn Fn(u32) -> (Option<f64>, bool)) -> RecordView {
        let foreseen = |forecast: Forecast| {
            let due = line.day.saturating_add(forecast.horizon_days);
            let (outcome, later) = outcome(due);
            Foreseen { forecast, due, outcome, later }
        };
        let forecasts = match &line.record {
            Record::Advance(filed) => filed.forecasts.iter().map(|one| foreseen(one.said())).collect(),
            _ => Vec::new(),
        };
        let Line { seq, day, at, record, .. } = line.clone();
        RecordView { seq, day, at, record, forecasts }
    }
}

#[cfg(test)]
mod tests {
    use super::super::trajectory::record::{Advance, FiledForecast};
    use super::*;
    use crate::session::Via;

    #[test]
    fn a_forecast_says_what_came_and_what_is_still_to_come() {
        let one = |horizon_days| FiledForecast {
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
        };
        let line = Line::alone(5, 14, "", Record::Advance(advance));
        let view = RecordView::of(&line, &|due| if due == 21 { (Some(90.0), false) } else { (None, true) });
        let [first, second] = view.forecasts[..] else { panic!("{view:?}") };
        assert_eq!((first.due, first.is_inside(), first.later), (21, Some(true), false));
        assert_eq!((second.due, second.is_inside(), second.later), (42, None, true));
    }
}
