use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::super::arguments::{Arguments, json_f64};
use super::super::limits::{MAX_FORECAST_DOLLARS, check_number};
use super::super::{
    Argument, ArgumentKind, EffectTiming, PlannedCall, Rejection, ResultField, Tool, ToolContext, ToolId,
    ToolKind, ToolModule, ToolSpec,
};

/// The tool `next_week`, which simulates a week. The session implements the tool; `NextWeek` documents the tool and
/// checks the rationale and the forecasts.
pub struct NextWeek;

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::NextWeek,
    code: "NEXT",
    module: ToolModule::Time,
    kind: ToolKind::Time,
    summary: "Submit a rationale and four forecasts of cash, then simulate seven days",
    arguments: &[
        Argument {
            name: "rationale",
            alias: None,
            kind: ArgumentKind::Text,
            required: false,
            unit: "",
            description: "reasons for the decisions of this week; not empty",
        },
        Argument {
            name: "predictions",
            alias: None,
            kind: ArgumentKind::Structure(
                "cash_1wk, cash_4wk, cash_12wk, cash_26wk: each {point, lower, upper}, at most 1,000,000,000,000,000",
            ),
            required: false,
            unit: "$",
            description: "cash in {limits.prediction_horizons_days.0}, {limits.prediction_horizons_days.1}, \
                  {limits.prediction_horizons_days.2} and {limits.prediction_horizons_days.3} days with the interval that should contain it 95 times out of 100",
        },
    ],
    has_own_unknown_code: false,
    unnamed_argument: None,
    effect_timing: EffectTiming::Now,
    effect: "Seven days are simulated, or fewer if the run reaches its last day or cash falls below zero.",
    cost: "the daily costs of every day",
    written_tables: &["predictions", "all tables of the simulated days"],
    rejection_codes: &[
        "rationale_missing",
        "predictions_missing",
        "prediction_missing",
        "prediction_not_object",
        "prediction_field_missing",
        "prediction_not_number",
        "amount_too_large",
        "prediction_interval_inverted",
        "prediction_point_outside",
        "run_over",
    ],
    result_fields: &[
        ResultField { name: "day", kind: "integer", description: "the last simulated day" },
        ResultField { name: "dashboard", kind: "text", description: "the weekly dashboard" },
    ],
    example: r#"{"rationale": "hold", "predictions": {"cash_1wk": {"point": 990000, "lower": 980000, "upper": 995000}, "cash_4wk": {"point": 960000, "lower": 930000, "upper": 985000}, "cash_12wk": {"point": 900000, "lower": 800000, "upper": 1000000}, "cash_26wk": {"point": 850000, "lower": 600000, "upper": 1200000}}}"#,
};

/// Rationale and forecasts that are submitted before a week.
pub struct WeekArguments {
    /// The player's reasons for the week; never blank.
    pub rationale: String,
    /// Forecasts of cash in 7, 28, 84 and 182 days.
    pub forecasts: [Forecast; 4],
}

impl Tool for NextWeek {
    type Args = WeekArguments;
    type Answer = ();

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<WeekArguments, Rejection> {
        let given = |name| arguments.get(name).unwrap_or(&Value::Null);
        Ok(WeekArguments {
            rationale: parse_rationale(given("rationale"))?,
            forecasts: parse_forecasts(given("predictions"), &view.params().limits.prediction_horizons_days)?,
        })
    }

    fn plan(&self, _: &ToolContext<'_>, _: WeekArguments) -> Result<PlannedCall<()>, Rejection> {
        Ok(PlannedCall::read_only(()))
    }
}

/// Keys of the four forecasts, shortest horizon first.
pub const FORECAST_KEYS: [&str; 4] = ["cash_1wk", "cash_4wk", "cash_12wk", "cash_26wk"];

/// A forecast of cash at one horizon.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Forecast {
    /// Horizon of the forecast: 7, 28, 84 or 182 days.
    pub horizon_days: u32,
    /// Predicted cash in dollars.
    pub point: f64,
    /// Lower end of the 95 % interval, in dollars.
    pub lower: f64,
    /// Upper end of the 95 % interval, in dollars.
    pub upper: f64,
}

/// Parses the rationale of a week, which must be a text that is not blank.
pub fn parse_rationale(given: &Value) -> Result<String, Rejection> {
    match given.as_str() {
        Some(text) if !text.trim().is_empty() => Ok(text.to_owned()),
        _ => Err(Rejection::for_field(
            "rationale",
            "rationale_missing",
            "a rationale is required: say why in a sentence or two",
        )),
    }
}

/// Parses the four forecasts of a week, shortest horizon first.
pub fn parse_forecasts(given: &Value, horizons: &[u32]) -> Result<[Forecast; 4], Rejection> {
    let Some(map) = given.as_object() else {
        let message = format!("the forecasts are required: {}", FORECAST_KEYS.join(", "));
        return Err(Rejection::for_field("predictions", "predictions_missing", message));
    };
    let mut all = [Forecast { horizon_days: 0, point: 0.0, lower: 0.0, upper: 0.0 }; 4];
    for ((key, forecast), horizon) in FORECAST_KEYS.into_iter().zip(&mut all).zip(horizons) {
        *forecast = parse_forecast(key, map.get(key), *horizon)?;
    }
    Ok(all)
}

fn parse_forecast(key: &str, given: Option<&Value>, horizon_days: u32) -> Result<Forecast, Rejection> {
    let field = format!("predictions.{key}");
    let refuse = |code, message: String| Rejection::for_field(field.clone(), code, message);
    let Some(given) = given.filter(|value| !value.is_null()) else {
        return Err(refuse("prediction_missing", format!("forecast {key} is missing")));
    };
    let Some(map) = given.as_object() else {
        return Err(refuse(
            "prediction_not_object",
            format!("forecast {key} must contain point, lower and upper"),
        ));
    };
    let read = |name: &str| {
        let field = format!("{field}.{name}");
        let value = map.get(name).filter(|value| !value.is_null()).ok_or_else(|| {
            Rejection::for_field(
                field.clone(),
                "prediction_field_missing",
                format!("forecast {key} lacks {name}"),
            )
        })?;
        json_f64(value).ok_or_else(|| {
            Rejection::for_field(
                field,
                "prediction_not_number",
                format!("forecast {key} must contain numbers"),
            )
        })
    };
    // Check that all three fields exist before any field is parsed as a number.
    for name in ["point", "lower", "upper"] {
        if map.get(name).is_none_or(Value::is_null) {
            read(name)?;
        }
    }
    let forecast =
        Forecast { horizon_days, point: read("point")?, lower: read("lower")?, upper: read("upper")? };
    for (name, value) in [("point", forecast.point), ("lower", forecast.lower), ("upper", forecast.upper)] {
        check_number(value, MAX_FORECAST_DOLLARS, &format!("{field}.{name}"), "$")?;
    }
    if forecast.lower > forecast.upper {
        let message = format!("forecast {key}: lower {} is above upper {}", forecast.lower, forecast.upper);
        return Err(refuse("prediction_interval_inverted", message));
    }
    if forecast.point < forecast.lower || forecast.point > forecast.upper {
        let (point, lower, upper) = (forecast.point, forecast.lower, forecast.upper);
        let message = format!("forecast {key}: the point {point} lies outside {lower} to {upper}");
        return Err(refuse("prediction_point_outside", message));
    }
    Ok(forecast)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn rejection_code(predictions: Value) -> &'static str {
        match parse_forecasts(&predictions, &[7, 28, 84, 182]) {
            Ok(_) => "accepted",
            Err(refusal) => refusal.code,
        }
    }

    fn predictions_with_first(first: Value) -> Value {
        let fine = json!({"point": 1, "lower": 1, "upper": 1});
        json!({"cash_1wk": first, "cash_4wk": fine, "cash_12wk": fine, "cash_26wk": fine})
    }

    #[test]
    fn next_week_requires_rationale_and_four_forecasts() {
        assert_eq!(parse_rationale(&Value::Null).map_err(|refusal| refusal.code), Err("rationale_missing"));
        assert_eq!(parse_rationale(&json!("  ")).map_err(|refusal| refusal.code), Err("rationale_missing"));
        assert_eq!(parse_rationale(&json!(5)).map_err(|refusal| refusal.code), Err("rationale_missing"));
        assert_eq!(rejection_code(Value::Null), "predictions_missing");
        let mut three = predictions_with_first(json!({"point": 1, "lower": 1, "upper": 1}));
        three.as_object_mut().expect("an object").shift_remove("cash_12wk");
        assert_eq!(rejection_code(three), "prediction_missing");
        for (first, expected) in [
            (json!([1, 2, 3]), "prediction_not_object"),
            (json!(5), "prediction_not_object"),
            (json!({"point": 1, "lower": 1}), "prediction_field_missing"),
            (json!({"point": "a", "lower": 1, "upper": 1}), "prediction_not_number"),
            (json!({"point": 1, "lower": 1, "upper": "2"}), "prediction_not_number"),
            (json!({"point": true, "lower": 1, "upper": 2}), "prediction_not_number"),
            (json!({"point": 1, "lower": 3, "upper": 1}), "prediction_interval_inverted"),
            (json!({"point": 5, "lower": 0, "upper": 1}), "prediction_point_outside"),
            (json!({"point": 1, "lower": 1, "upper": 1e308}), "amount_too_large"),
            (json!({"point": 1, "lower": -1.1e15, "upper": 1}), "amount_too_large"),
            (json!({"point": 1, "lower": -1e15, "upper": 1e15}), "accepted"),
            (json!({"point": 1, "lower": 1, "upper": 1, "note": "ignored"}), "accepted"),
        ] {
            assert_eq!(rejection_code(predictions_with_first(first)), expected);
        }
    }
}
