//! Measuring: the value of a figure or a statement over weeks of a run.

use super::measurement::{Measurement, NumberSource, Over};
use crate::figures::week::WeekFigures;
use crate::play::Session;
use novamind_database::Cell;

impl Measurement {
    /// Its value over all weeks that a student could decide of, up to the present one.
    ///
    /// # Errors
    /// The statement is refused, or answers with something else than one number.
    pub fn over_part(&self, session: &mut Session) -> Result<Option<f64>, String> {
        let weeks = session.lesson().map_or(0, |standing| standing.own_part().start_weeks);
        self.of(session, weeks * session.params().run.days_per_week)
    }

    /// Its value over the weeks that ended on days after `from_day`; none where there is none.
    ///
    /// # Errors
    /// The statement is refused, or answers with something else than one number.
    pub fn of(&self, session: &mut Session, from_day: u32) -> Result<Option<f64>, String> {
        let weeks: Vec<WeekFigures> =
            session.weeks().iter().copied().filter(|week| week.day > from_day).collect();
        let value: Box<dyn Fn(&WeekFigures) -> f64> = match &self.source {
            NumberSource::Cash => Box::new(|week| week.cash),
            NumberSource::Figure(figure) => Box::new(|week| figure.of_week(week).unwrap_or(f64::NAN)),
            NumberSource::Sql(sql) => {
                return answer(session, &filled(sql, from_day + 1, session.day()));
            }
        };
        let values: Vec<f64> = weeks.iter().map(value).filter(|value| value.is_finite()).collect();
        let sum: f64 = values.iter().sum();
        Ok(match self.over {
            Over::End => values.last().copied(),
            Over::Sum => Some(sum),
            Over::Mean => (!values.is_empty()).then(|| sum / values.len() as f64),
        })
    }
}

fn filled(sql: &str, from_day: u32, to_day: u32) -> String {
    sql.replace("{from_day}", &from_day.to_string()).replace("{to_day}", &to_day.to_string())
}

fn answer(session: &mut Session, sql: &str) -> Result<Option<f64>, String> {
    let rows = session.look_into_database(sql).map_err(|refusal| refusal.message)?;
    match rows.rows.as_slice() {
        [row] if row.len() == 1 => Ok(match &row[0] {
            Cell::Integer(number) => Some(*number as f64),
            Cell::Real(number) => Some(*number),
            _ => None,
        }),
        rows => Err(format!("the statement answers with {} rows, not with one number", rows.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_stand_in_for_their_names() {
        assert_eq!(filled("x > {from_day} and x <= {to_day}", 8, 14), "x > 8 and x <= 14");
    }
}
