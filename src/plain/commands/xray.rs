//! `xray …`: hidden state of debug runs and finished runs, as text (docs/debugging.md).

mod data;
mod view_data;
mod views;

use serde_json::Value;

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem, statement_of_xray};
use super::super::signals::Phase;
use super::{Interpreter, problem, usage};
use data::{company_as_data, customer_as_data, leads_as_data};
use novamind_base::nearest;
use novamind_database::text::table;
use novamind_insight::{Inspect, LeadFactor, Lens};
use novamind_report::xray::{company_in_words, customer_in_words, leads_in_words};
use novamind_session::identifiers::Group;
use novamind_session::rows_as_json;
use novamind_tools::Refusal;

const VIEWS: [&str; 9] =
    ["leads", "quality", "satisfaction", "reputation", "spillover", "rivals", "drift", "streams", "sql"];

/// `help xray`
pub(super) const IN_FULL: &str = "\
xray leads GROUP [DAY] [R=1 …]   the equation of a group's leads; R=1 fixes a factor
xray quality GROUP [DAY]         the quality that each plan delivers to a group: base, shared and own improvements, model tier
xray satisfaction GROUP [DAY]    the terms that changed the mean satisfaction of a group
xray reputation GROUP [DAY]      the terms that changed the reputation of a group: churn, its subscribers, other groups, bounds
xray spillover [DAY]             the spillover of reputation between groups, and the part that was dropped
xray rivals [DAY]                what competitors could copy, what they did, and their next decision
xray drift [DAY]                 the drift of expectations and budgets so far, and its next day
xray streams PART [N]            the first N draws of a part on the next day, and their results
xray sql [DAY] SELECT …          queries the database and the tables hidden.groups, hidden.customers, hidden.threads,
                                 hidden.competitors, hidden.drift, hidden.pmi and hidden.factors, for example
                                 xray sql SELECT day, reputation FROM hidden.groups WHERE group_id = 'S1'
                                 hidden.customers shows DAY; all other tables have every day
For debug runs and finished runs. Each inspection is recorded. DAY is any simulated day, by default the last one.";

impl Interpreter {
    pub(super) fn xray(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        // Check the permission before parsing anything.
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused("xray", refusal));
        }
        let (view, rest) = view_of(arguments)?;
        let shown = match view {
            "leads" => self.lead_equation(rest)?,
            "quality" => self.quality(rest)?,
            "satisfaction" => self.satisfaction(rest)?,
            "reputation" => self.reputation(rest)?,
            "spillover" => self.spillover(rest)?,
            "rivals" => self.rivals(rest)?,
            "drift" => self.drift(rest)?,
            "streams" => self.streams(rest)?,
            _ => return Err(unknown_view(view, &arguments[0])),
        };
        Ok(shown.unwrap_or_else(|refusal| Answer::refused("xray", refusal)))
    }

    /// `xray sql [DAY] STATEMENT`
    pub(super) fn hidden_tables(&mut self, rest: &str, column: usize) -> Answer {
        let interrupt = self.session.inspect().xray_interrupt();
        let asked = interrupt.and_then(|interrupt| {
            let (day, sql) = match day_and_statement(rest) {
                Ok(asked) => asked,
                Err(text) => return Ok(Err(Problem { text: text.to_owned(), column })),
            };
            // From here on a signal stops this query, even though it has not started.
            let ticket = interrupt.ticket();
            self.watch.enter_query(interrupt);
            self.session.inspect().xray_query_as(ticket, sql, day).map(Ok)
        });
        self.watch.enter(Phase::Working);
        match asked {
            Ok(Ok(rows)) => Answer::done("xray", table(&rows), Value::Object(rows_as_json(&rows))),
            Ok(Err(problem)) => usage(problem),
            Err(refusal) => Answer::refused("xray", refusal),
        }
    }

    fn lead_equation(&mut self, arguments: &[Argument]) -> Result<Result<Answer, Refusal>, Problem> {
        let held = arguments.iter().filter(|own| own.key.is_some()).map(held_factor);
        let held: Vec<(LeadFactor, f64)> = held.collect::<Result<_, _>>()?;
        let plain: Vec<&Argument> = arguments.iter().filter(|own| own.key.is_none()).collect();
        let (group, day) = group_and_day("leads", &plain)?;
        Ok(self.session.inspect().lead_equations(group, day).map(|days| {
            let data = days.last().map_or(Value::Null, |own| leads_as_data(own, &held));
            Answer::done("xray", leads_in_words(&days, &held).join("\n"), data)
        }))
    }

    /// `lens CUSTOMER [DAY]`
    pub(super) fn lens(&mut self, arguments: &[Argument]) -> Result<Answer, Problem> {
        if let Err(refusal) = self.session.refuse_to_look_inside() {
            return Ok(Answer::refused("lens", refusal));
        }
        let numbers: Vec<u32> = arguments.iter().map(whole_number).collect::<Result<_, _>>()?;
        let shown = match numbers[..] {
            [customer] => self.session.inspect().lens(customer, None),
            [customer, day] => self.session.inspect().lens(customer, Some(day)),
            _ => return Err(problem(arguments, "give a customer and optionally a day: lens 4711 151")),
        };
        Ok(match shown {
            Ok(Lens::Individual(lens)) => {
                let lines = customer_in_words(&lens);
                let data = customer_as_data(&lens, &lines[1]);
                Answer::done("lens", lines.join("\n"), data)
            }
            Ok(Lens::Company(lens)) => {
                Answer::done("lens", company_in_words(&lens).join("\n"), company_as_data(&lens))
            }
            Err(refusal) => Answer::refused("lens", refusal),
        })
    }
}

/// Splits an optional day from the statement.
fn day_and_statement(rest: &str) -> Result<(Option<u32>, &str), &'static str> {
    let rest = statement_of_xray(rest).unwrap_or_default();
    let digits = rest.find(|letter: char| !letter.is_ascii_digit()).unwrap_or(rest.len());
    let (day, sql) = rest.split_at(digits);
    let day = match day {
        "" => None,
        day => Some(day.parse().map_err(|_| "the day is too large")?),
    };
    match sql.trim() {
        "" => Err("give a statement: xray sql SELECT day, pmi FROM hidden.pmi"),
        sql => Ok((day, sql)),
    }
}

fn views() -> String {
    format!("xray shows {}", VIEWS.join(", "))
}

/// Returns the view and its arguments.
fn view_of(arguments: &[Argument]) -> Result<(&str, &[Argument]), Problem> {
    match arguments.split_first() {
        Some((Argument { key: None, value: Value::String(view), .. }, rest)) => Ok((view, rest)),
        _ => Err(problem(arguments, &views())),
    }
}

fn unknown_view(view: &str, argument: &Argument) -> Problem {
    let text = match nearest(view, VIEWS.into_iter())[..] {
        [] => views(),
        ref near => format!("xray has no view {view}; did you mean {}?", near.join(" or ")),
    };
    Problem { text, column: argument.column }
}

/// Parses a group and an optional day for a view.
fn group_and_day(view: &str, arguments: &[&Argument]) -> Result<(Group, Option<u32>), Problem> {
    let at = |argument: &Argument, text: String| Problem { text, column: argument.column };
    let column = arguments.get(2).map_or(1, |argument| argument.column);
    let usage = || Problem { text: format!("give a group and optionally a day: xray {view} S2 84"), column };
    let (first, day) = match arguments {
        [first] => (first, None),
        [first, day] => (first, Some(day)),
        _ => return Err(usage()),
    };
    let id = first.value.as_str().filter(|_| first.key.is_none()).ok_or_else(usage)?;
    let group = Group::all().find(|group| group.id().eq_ignore_ascii_case(id)).ok_or_else(|| {
        let near = nearest(id, Group::all().map(Group::id));
        let help =
            if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(" or ")) };
        at(first, format!("there is no group {id}{help}"))
    })?;
    let day = day.map(|day| whole_number(day)).transpose()?;
    Ok((group, day))
}

fn whole_number(argument: &Argument) -> Result<u32, Problem> {
    argument.whole_number()
}

/// Parses a fixed factor, as in `R=1`.
fn held_factor(argument: &Argument) -> Result<(LeadFactor, f64), Problem> {
    let name = argument.key.as_deref().unwrap_or_default();
    let wrong = |text: String| Problem { text, column: argument.column };
    let factor = LeadFactor::parse(name).ok_or_else(|| {
        let letters = LeadFactor::ALL.map(|own| format!("{own} {}", own.in_words())).join(", ");
        wrong(format!("{name} is not a factor; the factors are {letters}"))
    })?;
    let value = argument.value.as_f64().filter(|value| *value >= 0.0);
    value
        .map(|value| (factor, value))
        .ok_or_else(|| wrong(format!("the value of {factor} must be a number from 0")))
}
