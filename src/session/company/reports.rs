//! A day and a week that were simulated, as they are reported.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::xray::Xray;
use novamind_base::notation::json_number;
use novamind_record::figures::WeekFigures;
use novamind_record::trajectory::record::Ended;
use novamind_world::events::DayFigures;

/// A day that was just simulated.
pub struct DayReport<'a> {
    /// Its figures.
    pub figures: &'a DayFigures,
    /// Day on which the week will end, unless cash runs out.
    pub week_end: u32,
    /// The hidden state, in debug runs.
    pub xray: Option<Xray<'a>>,
}

/// A week, or the rest of one, that was simulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Week {
    /// Its figures.
    pub figures: WeekFigures,
    /// The dashboard.
    pub dashboard: String,
    /// What was put into the inbox: day and text.
    pub notices: Vec<(u32, String)>,
    /// How the run ended with it, if it did.
    pub ended: Option<Ended>,
    /// What the player should know: the disk did not take the closing line, the next day has no room for its leads, the database
    /// could not be written, or the
    /// language model did not answer.
    pub remark: Option<String>,
}

impl Week {
    /// The week as programs get it.
    pub fn as_json(&self) -> Value {
        let notices: Vec<Value> =
            self.notices.iter().map(|(day, text)| json!({ "day": day, "text": text })).collect();
        let mut data = Map::from_iter([
            ("day".to_owned(), self.figures.day.into()),
            ("days_run".to_owned(), self.figures.days_run.into()),
            ("cash".to_owned(), json_number(self.figures.cash)),
            ("figures".to_owned(), Value::Object(self.figures.as_json())),
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
