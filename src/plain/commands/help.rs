//! `help`: lists the commands, and shows help on a command.

use serde_json::json;

use super::super::grammar::{Argument, ParseError, current_name};
use super::super::response::CommandResponse;
use super::{
    COMMANDS, NEXT_WEEK_COMMANDS, argument_error, explanations, find_tool, inbox, is_hosted_command,
    overview, parameters, rules, xray,
};
use novamind_base::similar_names;
use novamind_tools::{ParameterNumbers, ToolKind};

const NEEDS_HELP: &str = "\
needs                     list problems that cost money or soon will, each with the amount and a call that addresses it
Urgent problems come first and are marked with !. Within each kind, the order is by money at risk in the next four weeks.
You can type the call below a problem as it is. Type check before it to preview its effect, for example
                          check set_capacity_tier 2";

const FIT_HELP: &str = "\
fit                       show every known group
fit GROUP                 show one group, for example fit S1
For each plan: price, quality and quota next to the budget, required quality and usage of the group. The estimates are
ranges with their dates; research_group narrows them. Mismatches that are certain despite the ranges are named.";

const LEADS_HELP: &str = "\
leads                     show leads by group in the last week and the last four weeks, paid and by word of mouth, with
                          conversions
leads GROUP               show one group, for example leads S1
The costs per lead and per first bill in the last four weeks follow, by channel and group, compared with the four
consecutive earlier weeks in which leads were cheapest.";

const CURVE_HELP: &str = "\
curve GROUP               show the quality that 10, 50 and 90 % of the leads of a group require at a price, the
                          plans, and their conversion and revenue per lead; for example curve S1
curve GROUP PRICE QUALITY show the expected result of a single product, without quota and discount, for
                          example curve S1 30 0.4
The curve evaluates 2,000 sampled leads with the functions of the simulator. In debug and finished runs, the leads are drawn
from the true parameters of the group, and the inspection is recorded. In all other runs, they are drawn from the results
of market studies, so that each figure is a range that covers the error of the study.";

const CHECK_HELP: &str = "\
check CALL                preview the effect and cost of a tool call; nothing is changed, drawn or recorded. For example
                          check set_prices B=30
                          check set_capacity_tier 2
                          check research_group S2
Prices, model tiers and quotas are shown with the resulting gross margins, capacity with the busiest day of the last week, a
study with the level it reaches, an R&D project with the range of its effect.";

const PAUSE_HELP: &str = "\
pause                     stop the clock for a break; until resume, only resume, help and quit work
pause REASON              stop the clock and record a reason, for example pause lunch
Time with the clock stopped does not count as playing time.";

const BREAK_HELP: &str = "\
break                     list the breakpoints with their numbers
break CONDITION           set a breakpoint; run DAYS stops on the first day on which the condition becomes true. For example
                          break churn(S1) > 5% over 7
                          break reputation(S3) falls
                          break leads(S1) rises over 7
                          break event rival
break clear N             remove a breakpoint; break clear all removes all breakpoints
A condition is FIGURE > NUMBER, with >, >=, < or <=, FIGURE rises, FIGURE falls, or event rival, drift, surge or outage.
over DAYS sums counts over that many days and computes shares of the sums. Figures of a group, as in subscribers(S1): subscribers,
leads, new_subscribers, conversion, cancellations, churn, usage, open_issues, reputation, satisfaction, relationship.
Figures of the company: cash, recurring_revenue, payments, running_costs, subscribers, seats, leads, individual_leads,
new_subscribers, new_seats, conversion, cancellations, churn, upgrades, downgrades, usage, overload, downtime_minutes,
open_issues.";

/// Returns the full help of a command, or `None` if the command has only a help line.
fn command_help(name: &str, led: bool) -> Option<String> {
    let text = match name {
        "inbox" | "thread" => inbox::HELP,
        "rules" => rules::HELP,
        "needs" => NEEDS_HELP,
        "fit" => FIT_HELP,
        "leads" => LEADS_HELP,
        "curve" => CURVE_HELP,
        "check" => CHECK_HELP,
        "xray" if !led => xray::HELP,
        "pause" => PAUSE_HELP,
        "break" => BREAK_HELP,
        "set" => parameters::HELP,
        _ if NEXT_WEEK_COMMANDS.contains(&name) => return Some(NEXT_HELP.to_owned()),
        _ => return None,
    };
    Some(text.to_owned())
}

/// A command that only participants of a study have, with its help line.
const WITHDRAW: (&str, &str) =
    ("withdraw", "withdraw                 erase everything you did in this study, after a confirmation");
/// Commands that are rejected in runs of participants of a study.
const NOT_FOR_PARTICIPANTS: [&str; 11] =
    ["branch", "step", "xray", "lens", "diff", "set", "break", "run", "since", "find", "who"];

/// The player who reads the help.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Audience {
    /// Whether the player is a participant of a study.
    pub led: bool,
    /// Whether the session is hosted.
    pub hosted: bool,
}

impl Audience {
    fn has_command(self, name: &str) -> bool {
        (!self.led || !NOT_FOR_PARTICIPANTS.contains(&name)) && (!self.hosted || is_hosted_command(name))
    }
}

/// Returns the commands of an audience with their help lines.
fn commands(audience: Audience) -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = COMMANDS.iter().copied().filter(|(_, line)| !line.is_empty());
    all.filter(move |(name, _)| audience.has_command(name)).chain(audience.led.then_some(WITHDRAW))
}

/// Executes `help [NAME]` for an audience.
pub(super) fn help(
    name: Option<&str>,
    arguments: &[Argument],
    numbers: &ParameterNumbers,
    audience: Audience,
) -> Result<CommandResponse, ParseError> {
    let Some(name) = name else {
        let lines: Vec<&str> = commands(audience).map(|(_, line)| line).collect();
        let tools: Vec<&str> = callable_names().collect();
        let text = format!(
            "{}\n\nEvery tool is also a command: {}\nFor example: set_prices A=16 B=34 C=70\n\
             To simulate a week with the tool call of agents, type: next_week {{\"rationale\": \"WHY\", \
             \"predictions\": {{\"cash_1wk\": \
             {{\"point\": 950000, \"lower\": 900000, \"upper\": 990000}}, …}}}} (for the full form, type: help next)\n\
             Type help NAME for help on a command or tool, and explain TERM for the meaning of a term.",
            lines.join("\n"),
            tools.join(", ")
        );
        return Ok(CommandResponse::success("help", text, json!({ "commands": lines, "tools": tools })));
    };
    let name = current_name(name);
    if let Some(text) = command_help(name, audience.led).filter(|_| audience.has_command(name)) {
        return Ok(CommandResponse::success("help", text.clone(), json!({ "command": text })));
    }
    if let Some((_, line)) = commands(audience).find(|(command, _)| *command == name) {
        return Ok(CommandResponse::success("help", line.to_owned(), json!({ "command": line })));
    }
    if novamind_tools::find(name).is_some() || find_tool(name).is_some() {
        return overview::tools_command(Some(name), arguments, numbers);
    }
    if novamind_database::table(numbers.interface(), name).is_some() {
        return overview::tables_command(Some(name), arguments, numbers.interface());
    }
    if let Ok(found) = novamind_glossary::find_subject(name) {
        return Ok(explanations::explain_subject("help", found, numbers));
    }
    let names = commands(audience).map(|(name, _)| name).chain(callable_names());
    let names =
        names.chain(novamind_database::tables(numbers.interface()).iter().map(|table| table.name.as_str()));
    let where_to_look = "type help to list the commands, or glossary to list the terms";
    Err(argument_error(
        arguments,
        &not_found_message("nothing", name, similar_names(name, names), where_to_look),
    ))
}

const NEXT_HELP: &str = "\
next \"WHY\" naive                         naive forecasts
next \"WHY\" P L U  P L U  P L U  P L U    point, lower, upper of cash in 1, 4, 12 and 26 weeks
next_week {\"rationale\": \"WHY\", \"predictions\": {\"cash_1wk\": {\"point\": 950000, \"lower\": 900000, \"upper\": 990000}, \
\"cash_4wk\": …, \"cash_12wk\": …, \"cash_26wk\": …}}
next                                     asks at a terminal; simulates the week in a lesson that needs neither rationale nor
                                         forecasts
Only forecasts that end within the run are required: 9 numbers instead of 12 if the run ends in 12 to 25 weeks.
Naive forecasts: current subscribers pay on their billing dates and renew or cancel at recent rates, signups continue
their trend, and costs stay as they are set now.";

fn callable_names() -> impl Iterator<Item = &'static str> {
    novamind_tools::CATALOGUE
        .iter()
        .map(|tool| tool.spec())
        .filter(|spec| spec.kind != ToolKind::Time)
        .map(|spec| spec.name())
}

/// Returns an error message with similar names. `list` explains how to list all names.
pub(super) fn not_found_message(what: &str, name: &str, near: Vec<&str>, list: &str) -> String {
    match near.is_empty() {
        true => format!("there is {what} called {name}; {list}"),
        false => format!("there is {what} called {name}; did you mean {}? {list}", near.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_explained_with_an_example() {
        for name in ["inbox", "thread", "needs", "fit", "leads", "curve", "check", "pause", "rules", "next"] {
            let help_text = help(Some(name), &[], &ParameterNumbers::bundled(), Audience::default())
                .expect("help")
                .to_text();
            assert!(help_text.lines().count() > 1, "{name}: {help_text}");
        }
        let help_text = help(Some("needs"), &[], &ParameterNumbers::bundled(), Audience::default())
            .expect("help")
            .to_text();
        assert!(help_text.contains("Urgent problems come first"), "{help_text}");
    }

    #[test]
    fn unknown_names_point_to_the_list() {
        let numbers = ParameterNumbers::bundled();
        for (outcome, list) in [
            (help(Some("zzzzzzz"), &[], &numbers, Audience::default()), "type help to list the commands"),
            (overview::tools_command(Some("foo"), &[], &numbers), "type tools to list all tools"),
            (
                overview::tables_command(Some("leger"), &[], numbers.interface()),
                "did you mean ledger? type tables to list all tables",
            ),
        ] {
            let problem = outcome.expect_err(list);
            assert!(problem.text.ends_with(list) || problem.text.contains(list), "{problem:?}");
        }
    }
}
