//! Measurements for goals, guesses and pitfalls: a figure over weeks, or the result of an SQL statement.

use serde::Deserialize;

use crate::figures::{FigureUnit, WeekFigure, WeekFigures};

/// The definition of a measurement over some weeks of a company.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementSpec {
    /// Source of the weekly numbers.
    pub source: NumberSource,
    /// Aggregation of the numbers over the weeks.
    pub aggregation: WeekAggregation,
}

/// Source of the numbers that a measurement aggregates.
#[derive(Debug, Clone, PartialEq)]
pub enum NumberSource {
    /// Cash at the end of each week, dollars.
    Cash,
    /// A figure of each week.
    Figure(WeekFigure),
    /// An SQL statement that returns one number; `{from_day}` and `{to_day}` are replaced with the first and last day.
    Sql(String),
}

/// Aggregation of a figure over weeks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum WeekAggregation {
    /// Value of the last week.
    #[default]
    Last,
    /// Sum over the weeks.
    Sum,
    /// Mean over the weeks.
    Mean,
}

#[derive(Debug, Deserialize)]
pub(super) struct RawMeasurement {
    pub figure: Option<String>,
    pub sql: Option<String>,
    pub over: Option<String>,
}

impl TryFrom<RawMeasurement> for MeasurementSpec {
    type Error = String;

    fn try_from(file: RawMeasurement) -> Result<MeasurementSpec, String> {
        let source = match (file.figure.as_deref(), file.sql) {
            (Some("cash"), None) => NumberSource::Cash,
            (Some(name), None) => {
                let figure =
                    WeekFigure::parse_label(name).ok_or_else(|| format!("there is no figure {name}"))?;
                if figure.company_value(&WeekFigures::default()).is_none() {
                    return Err(format!("figure {name} is not available in lessons; use `sql`"));
                }
                NumberSource::Figure(figure)
            }
            (None, Some(sql)) => NumberSource::Sql(sql),
            _ => return Err("a measurement needs either `figure` or `sql`".to_owned()),
        };
        let over = match file.over.as_deref() {
            None | Some("end") => WeekAggregation::Last,
            Some("sum") => WeekAggregation::Sum,
            Some("mean") => WeekAggregation::Mean,
            Some(other) => return Err(format!("`over` must be `end`, `sum` or `mean`, not {other}")),
        };
        if over != WeekAggregation::Last && matches!(source, NumberSource::Sql(_)) {
            return Err("remove `over`: an SQL statement has to select the days itself".to_owned());
        }
        Ok(MeasurementSpec { source, aggregation: over })
    }
}

impl MeasurementSpec {
    /// Returns whether the measurement is a figure in dollars.
    pub fn is_in_dollars(&self) -> bool {
        match &self.source {
            NumberSource::Cash => true,
            NumberSource::Figure(figure) => figure.unit() == FigureUnit::Dollars,
            NumberSource::Sql(_) => false,
        }
    }

    /// Describes the figure, for example `cash` or `sum of payments`. Returns `None` for a statement.
    pub fn describe(&self) -> Option<String> {
        let name = match &self.source {
            NumberSource::Cash => "cash",
            NumberSource::Figure(figure) => figure.name(),
            NumberSource::Sql(_) => return None,
        };
        Some(match self.aggregation {
            WeekAggregation::Last => name.to_owned(),
            WeekAggregation::Sum => format!("sum of {name}"),
            WeekAggregation::Mean => format!("mean {name}"),
        })
    }

    /// Returns the SQL statement for the days from `from_day` to `to_day`, or `None` if the source is a figure.
    pub fn statement(&self, from_day: u32, to_day: u32) -> Option<String> {
        match &self.source {
            NumberSource::Sql(sql) => Some(substitute_days(sql, from_day, to_day)),
            NumberSource::Cash | NumberSource::Figure(_) => None,
        }
    }

    /// Returns the aggregate of a figure over weeks. Returns `None` if the source is an SQL statement. Also returns
    /// `None` if no week has a value, unless the aggregation is a sum.
    pub fn aggregate<'a>(&self, weeks: impl Iterator<Item = &'a WeekFigures>) -> Option<f64> {
        let value = |week: &WeekFigures| match &self.source {
            NumberSource::Cash => Some(week.cash),
            NumberSource::Figure(figure) => figure.company_value(week),
            NumberSource::Sql(_) => None,
        };
        let values: Vec<f64> = weeks.filter_map(value).filter(|value| value.is_finite()).collect();
        let sum: f64 = values.iter().sum();
        match self.aggregation {
            WeekAggregation::Last => values.last().copied(),
            WeekAggregation::Sum => Some(sum),
            WeekAggregation::Mean => (!values.is_empty()).then(|| sum / values.len() as f64),
        }
    }

    /// Returns whether the source is an SQL statement, which needs the database.
    pub fn needs_database(&self) -> bool {
        matches!(self.source, NumberSource::Sql(_))
    }
}

fn substitute_days(sql: &str, from_day: u32, to_day: u32) -> String {
    sql.replace("{from_day}", &from_day.to_string()).replace("{to_day}", &to_day.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn substitute_days_replaces_both_placeholders() {
        assert_eq!(substitute_days("x > {from_day} and x <= {to_day}", 8, 14), "x > 8 and x <= 14");
    }

    fn parse(figure: Option<&str>, sql: Option<&str>, over: Option<&str>) -> Result<MeasurementSpec, String> {
        let owned = |text: Option<&str>| text.map(str::to_owned);
        MeasurementSpec::try_from(RawMeasurement {
            figure: owned(figure),
            sql: owned(sql),
            over: owned(over),
        })
    }

    #[test]
    fn measurement_requires_a_figure_or_a_statement() {
        assert_eq!(parse(Some("cash"), None, None).expect("cash").source, NumberSource::Cash);
        let sum = parse(Some("payments"), None, Some("sum")).expect("payments");
        assert_eq!(
            (sum.source, sum.aggregation),
            (NumberSource::Figure(WeekFigure::Payments), WeekAggregation::Sum)
        );
        for (figure, sql, over) in [
            (None, None, None),
            (Some("cash"), Some("SELECT 1"), None),
            (Some("luck"), None, None),
            (Some("cash"), None, Some("top")),
            (None, Some("SELECT 1"), Some("sum")),
        ] {
            assert!(parse(figure, sql, over).is_err(), "{figure:?} {sql:?} {over:?}");
        }
    }
}
