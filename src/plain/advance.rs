//! `next`: submits a rationale and forecasts, and simulates a week (docs/interfaces/plain-mode.md#next).

use std::io;

use serde_json::{Value, json};

use super::grammar::{Argument, ParseError};
use super::input::InputLine;
use super::line_source::LineSource;
use super::response::CommandResponse;
use super::show_prompt;
use novamind_base::formatting::{dollars, grouped_number, signed_dollars};
use novamind_course::{LessonAccess, LessonProgress};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_report::cost_review::identical_plan_lines;
use novamind_report::research::late_project_lines;
use novamind_session::{Forecasts, Observation, Session, TIME_LIMIT_RATIONALE, WeekResult};
use novamind_tools::{FORECAST_KEYS, Forecast, Rejection};

/// Source of the rationale and the forecasts that are submitted before a week.
#[derive(Debug, Clone, PartialEq)]
pub enum NextWeekInput {
    /// The rationale and the predictions are known: the command line contained them, or the lesson fills them
    /// in.
    Given {
        /// Rationale as an argument of the tool `next_week`.
        rationale: Value,
        /// Forecasts as an argument of the tool `next_week`.
        predictions: Value,
        /// Whether the forecast for each horizon is the naive forecast.
        naive: [bool; 4],
    },
    /// The program must ask the player for the rationale and the forecasts.
    Ask,
}

impl NextWeekInput {
    /// Returns the submission that is used when a time limit is reached.
    pub fn for_time_limit(session: &Session) -> NextWeekInput {
        let predictions = session.company().naive_forecasts().to_predictions();
        NextWeekInput::Given { rationale: json!(TIME_LIMIT_RATIONALE), predictions, naive: [true; 4] }
    }
}

/// Parses the arguments of the command `next`.
pub fn parse_next_week_input(
    arguments: &[Argument],
    session: &Session,
    prompts: bool,
) -> Result<NextWeekInput, ParseError> {
    let naive = session.company().naive_forecasts();
    let given =
        |rationale: Value, predictions: Value, naive| NextWeekInput::Given { rationale, predictions, naive };
    let is_naive = |argument: &Argument| argument.key.is_none() && argument.value == "naive";
    // The lesson can fill in naive forecasts, so that the player need not type them.
    let access = session.lesson().map(LessonProgress::access);
    let fills = access.is_some_and(LessonAccess::uses_naive_forecasts);
    let left_out = || if fills { (naive.to_predictions(), [true; 4]) } else { (Value::Null, [false; 4]) };
    let asks_nothing = fills && access.is_some_and(LessonAccess::is_rationale_off);
    match arguments {
        [] if prompts && !asks_nothing => Ok(NextWeekInput::Ask),
        [] => {
            let (predictions, filled) = left_out();
            Ok(given(Value::Null, predictions, filled))
        }
        [Argument { key: None, value: Value::Object(body), column }] => {
            body.keys().try_for_each(|name| check_argument_name(name, *column))?;
            let field = |name: &str| body.get(name).cloned().unwrap_or(Value::Null);
            Ok(fill_predictions(field("rationale"), field("predictions"), left_out))
        }
        named if named.iter().all(|argument| argument.key.is_some()) => {
            let field = |name: &str| {
                let found = named.iter().find(|argument| argument.key.as_deref() == Some(name));
                found.map_or(Value::Null, |argument| argument.value.clone())
            };
            named.iter().try_for_each(|argument| {
                check_argument_name(argument.key.as_deref().unwrap_or_default(), argument.column)
            })?;
            Ok(fill_predictions(field("rationale"), field("predictions"), left_out))
        }
        [only] if is_naive(only) && session.manifest().mode == Mode::Baseline => {
            Ok(given(Value::Null, naive.to_predictions(), [true; 4]))
        }
        [only] if is_naive(only) => Ok(given(json!("(none given)"), naive.to_predictions(), [true; 4])),
        [why, only] if why.key.is_none() && is_naive(only) => {
            Ok(given(why.value.clone(), naive.to_predictions(), [true; 4]))
        }
        [why] if fills && why.key.is_none() => {
            Ok(given(why.value.clone(), naive.to_predictions(), [true; 4]))
        }
        [why, numbers @ ..] => {
            let asked = session.company().horizons_in_run();
            let (predictions, filled) = parse_predictions(why, numbers, &naive, asked)?;
            Ok(given(why.value.clone(), predictions, filled))
        }
    }
}

/// Returns a submission with the predictions `given`. If `given` is null, `left_out` supplies the
/// predictions.
fn fill_predictions(
    rationale: Value,
    given: Value,
    left_out: impl Fn() -> (Value, [bool; 4]),
) -> NextWeekInput {
    let (predictions, naive) = if given.is_null() { left_out() } else { (given, [false; 4]) };
    NextWeekInput::Given { rationale, predictions, naive }
}

/// Checks that the tool has an argument of this name.
fn check_argument_name(name: &str, column: usize) -> Result<(), ParseError> {
    if ["rationale", "predictions"].contains(&name) {
        return Ok(());
    }
    Err(ParseError {
        text: format!("next_week has no argument {name}; it takes rationale and predictions"),
        column,
    })
}

/// Parses point, lower and upper for each of four horizons, or only for the first `asked` horizons, which end
/// within the run. The other forecasts are naive.
fn parse_predictions(
    why: &Argument,
    numbers: &[Argument],
    naive: &Forecasts,
    asked: usize,
) -> Result<(Value, [bool; 4]), ParseError> {
    let wrong = |column, text: String| ParseError { text, column };
    if let Some(named) = std::iter::once(why).chain(numbers).find(|argument| argument.key.is_some()) {
        return Err(wrong(
            named.column,
            "next takes no named arguments. Type: next \"WHY\" and twelve numbers".to_owned(),
        ));
    }
    if numbers.len() != 12 && numbers.len() != 3 * asked {
        let column = numbers.last().unwrap_or(why).column;
        let (count, horizons) = match asked {
            0 => {
                return Err(wrong(column, "the run ends within a week; type: next \"WHY\" naive".to_owned()));
            }
            1 => ("three", "1 week"),
            2 => ("six", "1 and 4 weeks"),
            3 => ("nine", "1, 4 and 12 weeks"),
            _ => ("twelve", "1, 4, 12 and 26 weeks"),
        };
        let text = format!(
            "after the rationale, give exactly {count} numbers (point lower upper for {horizons}) or naive; you gave {}",
            numbers.len()
        );
        return Err(wrong(column, text));
    }
    let one = |(key, three): (&str, &[Argument])| {
        let fields = json!({ "point": three[0].value, "lower": three[1].value, "upper": three[2].value });
        (key.to_owned(), fields)
    };
    let mut predictions = naive.to_predictions();
    if let Value::Object(all) = &mut predictions {
        all.extend(FORECAST_KEYS.into_iter().zip(numbers.chunks(3)).map(one));
    }
    Ok((predictions, std::array::from_fn(|at| 3 * at >= numbers.len())))
}

/// Submits rationale and forecasts, and simulates a week.
pub fn advance_week(session: &mut Session, filing: NextWeekInput) -> CommandResponse {
    let NextWeekInput::Given { rationale, predictions, naive } = filing else {
        return CommandResponse::success("next", String::new(), Value::Null);
    };
    match session.advance_with_json(&rationale, &predictions, naive, Via::Plain, &mut |_| {}) {
        Ok(week) => week_response("next", session, &week),
        Err(refusal) if refusal.code == "rationale_missing" => {
            let fills = session
                .lesson()
                .is_some_and(|lesson_progress| lesson_progress.access().uses_naive_forecasts());
            let form = if fills { "next \"WHY\"" } else { "next \"WHY\" naive" };
            let message = format!("{}. Type: {form}. For help, type: help next", refusal.message);
            CommandResponse::rejected("next", Rejection { message, ..refusal })
        }
        Err(refusal) => CommandResponse::rejected("next", refusal),
    }
}

/// Returns the response to a command that simulated a week or single days.
pub fn week_response(command: &str, session: &Session, week: &WeekResult) -> CommandResponse {
    let figures = &week.figures;
    let done = if command == "next" {
        format!("week {} done", figures.day.div_ceil(7))
    } else {
        "stepped".to_owned()
    };
    if session.rules().hides_result(week.ended.is_some()) {
        return end_response(command, session, week);
    }
    let mut text = week.dashboard.trim_end().to_owned();
    text += &format!(
        "\n{done} · day {} · cash {} ({})\n",
        figures.day,
        dollars(figures.cash),
        signed_dollars(figures.cash_change)
    );
    if let Some(ended) = week.ended {
        // A lesson has no score.
        let score = session.score().map_or(String::new(), |score| format!(" · score {}", dollars(score)));
        text += &format!("run ended: {} · day {}{score}\n", ended.id(), figures.day);
    }
    if let Some(remark) = &week.remark {
        text += &format!("note: {remark}\n");
    }
    CommandResponse::success(command, text, week.to_json())
}

/// Returns the response at the end of a run whose result is hidden from the participant.
fn end_response(command: &str, session: &Session, week: &WeekResult) -> CommandResponse {
    let mut text = match session.manifest().is_practice() {
        true => "the practice is over; the session comes next\n".to_owned(),
        false => "the run is over; the result is not shown in this study\n".to_owned(),
    };
    let object = json!({ "ended": true });
    if let Some(remark) = &week.remark {
        text += &format!("note: {remark}\n");
    }
    CommandResponse::success(command, text, object)
}

/// Asks the player for rationale and forecasts. Returns `None` if the player cancels.
///
/// # Errors
/// The input cannot be read, or the prompt cannot be written.
pub fn ask_next_week_input(
    session: &mut Session,
    input: &mut LineSource,
) -> io::Result<Option<NextWeekInput>> {
    let seen = session.company().observe();
    let changes = seen.changes.iter().map(super::commands::describe_setting_change);
    let mut lines: Vec<String> = changes.chain(seen.purchases.iter().cloned()).collect();
    if lines.is_empty() {
        lines.push("nothing has changed since the last week".to_owned());
    }
    lines.extend(identical_plan_lines(&seen));
    lines.extend(late_project_lines(&seen));
    show_prompt(&format!("{}\n", lines.join("\n")))?;
    let access = session.lesson().map(LessonProgress::access);
    let (is_rationale_off, uses_naive_forecasts) = (
        access.is_some_and(LessonAccess::is_rationale_off),
        access.is_some_and(LessonAccess::uses_naive_forecasts),
    );
    let rationale = match is_rationale_off {
        true => None,
        false => match ask_rationale(session, input)? {
            None => return Ok(None),
            why => why,
        },
    };
    let mut forecasts = session.company().naive_forecasts();
    if uses_naive_forecasts {
        let predictions = forecasts.to_predictions();
        return Ok(Some(NextWeekInput::Given { rationale: rationale.into(), predictions, naive: [true; 4] }));
    }
    if let Some(coverage) = naive_coverage(session, &seen) {
        show_prompt(&format!("{coverage}\n"))?;
    }
    let fields = forecasts.all.iter_mut().zip(&mut forecasts.filled_naively);
    for ((forecast, filled), weeks) in fields.zip([1, 4, 12, 26]).take(seen.horizons_in_run) {
        match ask_forecast(session, input, weeks, *forecast)? {
            None => return Ok(None),
            Some((given, naive)) => {
                (*forecast, *filled) = (given, naive);
            }
        }
    }
    let (predictions, naive) = (forecasts.to_predictions(), forecasts.filled_naively);
    Ok(Some(NextWeekInput::Given { rationale: rationale.into(), predictions, naive }))
}

/// Describes the measured coverage of naive forecasts. Returns `None` in baseline runs, because agents do not know the
/// coverage.
fn naive_coverage(session: &Session, seen: &Observation) -> Option<String> {
    let is_shown = session.manifest().mode != Mode::Baseline && seen.horizons_in_run > 0;
    is_shown.then(|| seen.describe_ranges()).flatten()
}

/// Asks for the rationale. Returns `None` if the player cancels.
fn ask_rationale(session: &mut Session, input: &mut LineSource) -> io::Result<Option<String>> {
    loop {
        match ask_line(session, input, "why (. cancels)> ")? {
            Some(line) if line.trim().is_empty() => show_prompt("a rationale is required\n")?,
            line => return Ok(line),
        }
    }
}

/// Asks for one forecast. Also returns whether the player accepted the naive forecast.
fn ask_forecast(
    session: &mut Session,
    input: &mut LineSource,
    weeks: u32,
    naive: Forecast,
) -> io::Result<Option<(Forecast, bool)>> {
    let whole = |value: f64| grouped_number(value, 0).replace(',', "");
    let text = format!(
        "{weeks} {}: point lower upper, or enter for the naive {} {} {}> ",
        if weeks == 1 { "week" } else { "weeks" },
        whole(naive.point),
        whole(naive.lower),
        whole(naive.upper)
    );
    loop {
        let Some(line) = ask_line(session, input, &text)? else { return Ok(None) };
        if ["", "naive"].contains(&line.trim()) {
            return Ok(Some((naive, true)));
        }
        match parse_forecast(&line, naive.horizon_days) {
            Ok(forecast) => return Ok(Some((forecast, false))),
            Err(problem) => show_prompt(&format!("{problem}\n"))?,
        }
    }
}

fn parse_forecast(line: &str, horizon_days: u32) -> Result<Forecast, String> {
    let plain =
        |word: &str| word.replace(['_', '$'], "").parse::<f64>().ok().filter(|number| number.is_finite());
    let numbers: Option<Vec<f64>> = line
        .split(|letter: char| letter.is_whitespace())
        .filter(|word| !word.is_empty())
        .map(plain)
        .collect();
    match numbers.as_deref() {
        Some([point, lower, upper]) if lower > upper => {
            Err(format!("lower {lower} is above upper {upper}; point is {point}"))
        }
        Some([point, lower, upper]) if point < lower || point > upper => {
            Err(format!("the point {point} is outside {lower} to {upper}"))
        }
        Some([point, lower, upper]) => {
            Ok(Forecast { horizon_days, point: *point, lower: *lower, upper: *upper })
        }
        _ => Err("give three numbers, point lower upper, for example 931000 902000 960000; or press enter for the naive numbers".to_owned()),
    }
}

/// Prompts for a line. Returns `None` for a dot and at the end of input.
fn ask_line(session: &mut Session, input: &mut LineSource, text: &str) -> io::Result<Option<String>> {
    loop {
        show_prompt(text)?;
        match input.wait_for_line(session)? {
            InputLine::End => return Ok(None),
            InputLine::Line(line) if line.trim() == "." => return Ok(None),
            InputLine::Line(line) => return Ok(Some(line)),
            InputLine::Unreadable(problem) => show_prompt(&format!("{problem}\n"))?,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use novamind_course::{Lesson, submit_guess};
    use novamind_record::folder::configuration::Configuration;
    use novamind_session::{LessonOptions, NewRun};

    /// Creates a lesson of two weeks in memory with these `access` settings.
    fn lesson_session(access: &str) -> Session {
        let place = tempfile::tempdir().expect("a folder");
        let file = place.path().join("two-weeks.toml");
        let bundled = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/lessons/two-weeks.toml");
        let plan = std::fs::read_to_string(bundled).expect("a plan");
        std::fs::write(&file, plan.replace("forecasts = \"naive\"\nrationale = \"off\"", access))
            .expect("a file");
        let lesson = Arc::new(Lesson::from_file(&file).expect("a lesson"));
        let entry = LessonOptions { lesson, part: 0, is_judged: true };
        let new = NewRun { mode: Mode::Lesson, lesson: Some(entry), ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        submit_guess(&mut session, 0.5).expect("a guess");
        session
    }

    fn argument(value: &str) -> Argument {
        Argument { key: None, value: value.into(), column: 6 }
    }

    #[test]
    fn lesson_without_rationale_and_forecasts_needs_no_argument() {
        let mut session = lesson_session("forecasts = \"naive\"\nrationale = \"off\"");
        for prompts in [false, true] {
            let filing = parse_next_week_input(&[], &session, prompts).expect("it is filed");
            assert!(
                matches!(&filing, NextWeekInput::Given { naive: [true, true, true, true], .. }),
                "{filing:?}"
            );
        }
        let filing = parse_next_week_input(&[], &session, false).expect("it is filed");
        assert!(advance_week(&mut session, filing).is_success());
        submit_guess(&mut session, 1.0).expect("a guess");
        let filing = parse_next_week_input(&[], &session, true).expect("it is filed");
        let text = advance_week(&mut session, filing).to_text();
        assert!(text.contains("run ended: lesson \u{b7} day 14\n") && !text.contains("score"), "{text}");
    }

    #[test]
    fn lesson_with_rationale_needs_no_forecasts() {
        let mut session = lesson_session("forecasts = \"naive\"\nrationale = \"required\"");
        assert_eq!(parse_next_week_input(&[], &session, true), Ok(NextWeekInput::Ask));
        let nothing = parse_next_week_input(&[], &session, false).expect("it is read");
        let refused = advance_week(&mut session, nothing).to_text();
        assert!(refused.contains("Type: next \"WHY\"."), "{refused}");
        let filing = parse_next_week_input(&[argument("because")], &session, false).expect("it is filed");
        assert!(advance_week(&mut session, filing).is_success());
    }

    #[test]
    fn runs_without_lesson_require_forecasts() {
        let session = lesson_session("forecasts = \"required\"\nrationale = \"off\"");
        assert_eq!(parse_next_week_input(&[], &session, true), Ok(NextWeekInput::Ask));
        assert!(parse_next_week_input(&[argument("because")], &session, false).is_err());
    }

    #[test]
    fn typed_forecasts_are_checked_line_by_line() {
        let good = Forecast { horizon_days: 7, point: 931_000.0, lower: 902_000.0, upper: 960_000.0 };
        assert_eq!(parse_forecast(" 931_000 $902000  960000 ", 7), Ok(good));
        for (line, part) in [
            ("1 2", "three numbers"),
            ("1 2 x", "three numbers"),
            ("1 NaN 3", "three numbers"),
            ("5 9 1", "above upper"),
            ("0 1 2", "outside"),
        ] {
            assert!(parse_forecast(line, 7).expect_err(line).contains(part), "{line}");
        }
    }
}
