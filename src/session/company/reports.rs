//! Reports on simulated days and weeks.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::hidden_state::HiddenState;
use novamind_base::formatting::json_number;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::RunEndReason;
use novamind_world::events::DayFigures;

/// A report on a simulated day.
pub struct DayReport<'a> {
    /// Figures of the day.
    pub figures: &'a DayFigures,
    /// Next decision day, unless the company goes bankrupt before that day.
    pub week_end: u32,
    /// Hidden state after the day; debug runs only.
    pub xray: Option<HiddenState<'a>>,
}

/// A report on a simulated week, or on single days of a week.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WeekResult {
    /// Figures of the week.
    pub figures: WeekFigures,
    /// Dashboard after the last simulated day.
    pub dashboard: String,
    /// Notices of the simulated days, each with its day and text.
    pub notices: Vec<(u32, String)>,
    /// Reason for the end of the run, if the run ended with this week.
    pub ended: Option<RunEndReason>,
    /// Message about a problem with the closing line, the lead limit of the next day, the database or the language
    /// model.
    pub remark: Option<String>,
}

impl WeekResult {
    /// Returns the report as JSON, for programs.
    pub fn to_json(&self) -> Value {
        let notices: Vec<Value> =
            self.notices.iter().map(|(day, text)| json!({ "day": day, "text": text })).collect();
        let mut data = Map::from_iter([
            ("day".to_owned(), self.figures.day.into()),
            ("days_run".to_owned(), self.figures.days_run.into()),
            ("cash".to_owned(), json_number(self.figures.cash)),
            ("figures".to_owned(), Value::Object(self.figures.to_json())),
            ("dashboard".to_owned(), self.dashboard.clone().into()),
            ("notifications".to_owned(), notices.into()),
            ("ended".to_owned(), json!(self.ended)),
        ]);
        if let Some(remark) = &self.remark {
            data.insert("remark".to_owned(), remark.clone().into());
        }
        Value::Object(data)
    }
}
