//! `xray …`: shows the hidden state of debug runs and finished runs (docs/debugging.md).

mod data;
mod view_data;
mod views;

use serde_json::Value;

use super::super::grammar::{Argument, ParseError, xray_statement};
use super::super::response::CommandResponse;
use super::super::signals::Phase;
use super::{Interpreter, argument_error, syntax_error};
use data::{customer_to_json, enterprise_to_json, leads_to_json};
use novamind_base::similar_names;
use novamind_database::text::format_result;
use novamind_insight::{CustomerView, Inspect, LeadFactor};
use novamind_report::inspection::{describe_enterprise, describe_individual, describe_lead_equation};
use novamind_session::identifiers::Group;
use novamind_session::rows_to_json;
use novamind_tools::Rejection;

const VIEWS: [&str; 9] =
    ["leads", "quality", "satisfaction", "reputation", "spillover", "rivals", "drift", "streams", "sql"];

/// Help text of `xray`.
pub(super) const HELP: &str = "\
xray leads GROUP [DAY] [R=1 …]   the equation of a group's leads; R=1 fixes a factor
xray quality GROUP [DAY]         the quality that each plan delivers to a group: base, shared and own improvements, model tier
xray satisfaction GROUP [DAY]    the terms that changed the mean satisfaction of a group
xray reputation GROUP [DAY]      the terms that changed the reputation of a group: churn, its subscribers, other groups, bounds
xray spillover [DAY]             the spillover of reputation between groups, and the part that was dropped
xray rivals [DAY]                what competitors could copy, what they did, and their next decision
xray drift [DAY]                 the past drift of expectations and budgets, and the drift of the next day
xray streams PART [N]            the first N draws of a part on the next day, and their results
xray sql [DAY] SELECT …          queries the database and the tables hidden.groups, hidden.customers, hidden.threads,
                                 hidden.competitors, hidden.drift, hidden.pmi and hidden.factors, for example
                                 xray sql SELECT day, reputation FROM hidden.groups WHERE group_id = 'S1'
                                 hidden.customers contains only DAY; all other tables contain every day
For debug runs and finished runs. Each inspection is recorded. DAY is any simulated day, by default the last one.";

impl Interpreter {
    pub(super) fn xray_command(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        // Check the permission before parsing the arguments.
        if let Err(refusal) = self.session.check_inspection() {
            return Ok(CommandResponse::rejected("xray", refusal));
        }
        let (view, rest) = parse_view(arguments)?;
        let shown = match view {
            "leads" => self.show_lead_equation(rest)?,
            "quality" => self.show_quality(rest)?,
            "satisfaction" => self.show_satisfaction(rest)?,
            "reputation" => self.show_reputation(rest)?,
            "spillover" => self.show_spillover(rest)?,
            "rivals" => self.show_competitors(rest)?,
            "drift" => self.show_drift(rest)?,
            "streams" => self.show_streams(rest)?,
            _ => return Err(unknown_view(view, &arguments[0])),
        };
        Ok(shown.unwrap_or_else(|refusal| CommandResponse::rejected("xray", refusal)))
    }

    /// Executes `xray sql [DAY] STATEMENT`.
    pub(super) fn query_hidden_tables(&mut self, rest: &str, column: usize) -> CommandResponse {
        let interrupt = self.session.inspect().hidden_query_interrupt();
        let asked = interrupt.and_then(|interrupt| {
            let (day, sql) = match parse_day_and_statement(rest) {
                Ok(asked) => asked,
                Err(text) => return Ok(Err(ParseError { text: text.to_owned(), column })),
            };
            // After the ticket is issued, a signal stops the query even if the query has not started.
            let ticket = interrupt.issue_ticket();
            self.watch.enter_query(interrupt);
            self.session.inspect().query_hidden_tables_with_ticket(ticket, sql, day).map(Ok)
        });
        self.watch.set_phase(Phase::Working);
        match asked {
            Ok(Ok(rows)) => {
                CommandResponse::success("xray", format_result(&rows), Value::Object(rows_to_json(&rows)))
            }
            Ok(Err(problem)) => syntax_error(problem),
            Err(refusal) => CommandResponse::rejected("xray", refusal),
        }
    }

    fn show_lead_equation(
        &mut self,
        arguments: &[Argument],
    ) -> Result<Result<CommandResponse, Rejection>, ParseError> {
        let held = arguments.iter().filter(|argument| argument.key.is_some()).map(parse_fixed_factor);
        let held: Vec<(LeadFactor, f64)> = held.collect::<Result<_, _>>()?;
        let plain: Vec<&Argument> = arguments.iter().filter(|argument| argument.key.is_none()).collect();
        let (group, day) = parse_group_and_day("leads", &plain)?;
        Ok(self.session.inspect().lead_equations(group, day).map(|days| {
            let data = days.last().map_or(Value::Null, |equation| leads_to_json(equation, &held));
            CommandResponse::success("xray", describe_lead_equation(&days, &held).join("\n"), data)
        }))
    }

    /// Executes `lens CUSTOMER [DAY]`.
    pub(super) fn show_customer(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        if let Err(refusal) = self.session.check_inspection() {
            return Ok(CommandResponse::rejected("lens", refusal));
        }
        let numbers: Vec<u32> = arguments.iter().map(parse_whole_number).collect::<Result<_, _>>()?;
        let shown = match numbers[..] {
            [customer] => self.session.inspect().customer_view(customer, None),
            [customer, day] => self.session.inspect().customer_view(customer, Some(day)),
            _ => {
                return Err(argument_error(arguments, "give a customer and optionally a day: lens 4711 151"));
            }
        };
        Ok(match shown {
            Ok(CustomerView::Individual(view)) => {
                let lines = describe_individual(&view);
                let data = customer_to_json(&view, &lines[1]);
                CommandResponse::success("lens", lines.join("\n"), data)
            }
            Ok(CustomerView::Enterprise(enterprise_view)) => CommandResponse::success(
                "lens",
                describe_enterprise(&enterprise_view).join("\n"),
                enterprise_to_json(&enterprise_view),
            ),
            Err(refusal) => CommandResponse::rejected("lens", refusal),
        })
    }
}

/// Splits the arguments of `xray sql` into an optional day and a statement.
fn parse_day_and_statement(rest: &str) -> Result<(Option<u32>, &str), &'static str> {
    let rest = xray_statement(rest).unwrap_or_default();
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

fn view_names() -> String {
    format!("xray shows {}", VIEWS.join(", "))
}

/// Returns the name of the requested view and its arguments.
fn parse_view(arguments: &[Argument]) -> Result<(&str, &[Argument]), ParseError> {
    match arguments.split_first() {
        Some((Argument { key: None, value: Value::String(view), .. }, rest)) => Ok((view, rest)),
        _ => Err(argument_error(arguments, &view_names())),
    }
}

fn unknown_view(view: &str, argument: &Argument) -> ParseError {
    let text = match similar_names(view, VIEWS.into_iter())[..] {
        [] => view_names(),
        ref near => format!("xray has no view {view}; did you mean {}?", near.join(" or ")),
    };
    ParseError { text, column: argument.column }
}

/// Parses the arguments of a view that needs a group and an optional day.
fn parse_group_and_day(view: &str, arguments: &[&Argument]) -> Result<(Group, Option<u32>), ParseError> {
    let at = |argument: &Argument, text: String| ParseError { text, column: argument.column };
    let column = arguments.get(2).map_or(1, |argument| argument.column);
    let usage =
        || ParseError { text: format!("give a group and optionally a day: xray {view} S2 84"), column };
    let (first, day) = match arguments {
        [first] => (first, None),
        [first, day] => (first, Some(day)),
        _ => return Err(usage()),
    };
    let id = first.value.as_str().filter(|_| first.key.is_none()).ok_or_else(usage)?;
    let group = Group::all().find(|group| group.id().eq_ignore_ascii_case(id)).ok_or_else(|| {
        let near = similar_names(id, Group::all().map(Group::id));
        let help =
            if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(" or ")) };
        at(first, format!("there is no group {id}{help}"))
    })?;
    let day = day.map(|day| parse_whole_number(day)).transpose()?;
    Ok((group, day))
}

fn parse_whole_number(argument: &Argument) -> Result<u32, ParseError> {
    argument.as_u32()
}

/// Parses a factor with a fixed value, for example `R=1`.
fn parse_fixed_factor(argument: &Argument) -> Result<(LeadFactor, f64), ParseError> {
    let name = argument.key.as_deref().unwrap_or_default();
    let wrong = |text: String| ParseError { text, column: argument.column };
    let factor = LeadFactor::parse(name).ok_or_else(|| {
        let letters =
            LeadFactor::ALL.map(|lead_factor| format!("{lead_factor} {}", lead_factor.name())).join(", ");
        wrong(format!("{name} is not a factor; the factors are {letters}"))
    })?;
    let value = argument.value.as_f64().filter(|value| *value >= 0.0);
    value
        .map(|value| (factor, value))
        .ok_or_else(|| wrong(format!("the value of {factor} must be a number from 0")))
}
