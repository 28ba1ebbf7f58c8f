//! `help`: the list of commands, and each of them with an example.

use serde_json::json;

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{COMMANDS, NEXT, inbox, parameters, problem, readings, rules, tool_called, words, xray};
use novamind_base::nearest;
use novamind_session::Bands;
use novamind_tools::{Kind, Numbers};

const NEEDS: &str = "\
needs                     what costs money or is about to: each with the object, the amount and the call that addresses it
Urgent ones come first and begin with !; within both, more money at risk in the next four weeks comes first.
The call below a line can be typed as it stands; check before it says what it would do, for instance
                          check set_capacity_tier 2";

const FIT: &str = "\
fit                       every known group
fit GROUP                 one group, for instance fit S1
For each plan: the price, quality and quota that the group is offered beside the budget, floor and use it has. The
estimates are ranges with the day they are of; research_group narrows them. What is missing for certain is named.";

const LEADS: &str = "\
leads                     leads by group in the last week and the last four, paid and by word of mouth, and how many signed
leads GROUP               one group, for instance leads S1
Below it, by channel and group, what a lead and a first bill cost in the last four weeks, beside the cheapest four weeks
before.";

const CURVE: &str = "\
curve GROUP               the quality that a tenth, half and nine tenths of the leads of a group require at a price, the
                          plans beside it, and the conversion and revenue per lead they bring; for instance curve S1
curve GROUP PRICE QUALITY what one product of a price and a quality would bring, without quota and promotion, for
                          instance curve S1 30 0.4
It asks 2,000 sampled leads with the functions that decide for leads who come. In debug runs and runs that are over they
are drawn from the traits of the group, and the look is recorded; in all others from what studies have told, so that each
figure has ends within the error of the study.";

const CHECK: &str = "\
check CALL                what a call would do and cost; nothing is done, drawn or recorded. For instance
                          check set_prices B=30
                          check set_capacity_tier 2
                          check research_group S2
Prices, model tiers and quotas come with the gross margins that would follow, capacity with the busiest day of the last
week, a study with the level it reaches, an R&D project with its spread.";

const PAUSE: &str = "\
pause                     stops the clock for a break; until resume, only resume, help and quit work
pause REASON              the same with a reason, which is recorded, for instance pause lunch
Time that the clock stands counts as no playing time.";

const BREAK: &str = "\
break                     the breakpoints with their numbers
break CONDITION           sets one; run DAYS stops on the first day on which it becomes true. For instance
                          break churn(S1) > 5% over 7
                          break reputation(S3) falls
                          break leads(S1) rises over 7
                          break event rival
break clear N             removes one; break clear all removes all of them
A condition is FIGURE > NUMBER, with >, >=, < or <=, FIGURE rises, FIGURE falls, or event rival, drift, surge or outage.
over DAYS sums what adds up, and takes shares over so many days. Figures of a group, as in subscribers(S1): subscribers,
leads, new_subscribers, conversion, cancellations, churn, usage, open_issues, reputation, satisfaction, relationship.
Figures of the company: cash, recurring_revenue, payments, running_costs, subscribers, seats, leads, individual_leads,
new_subscribers, new_seats, conversion, cancellations, churn, upgrades, downgrades, usage, overload, downtime_minutes,
open_issues.";

/// The explanation of a command that has one of its own.
fn in_full(name: &str, led: bool) -> Option<String> {
    let text = match name {
        "inbox" | "thread" => inbox::IN_FULL,
        "rules" => rules::IN_FULL,
        "needs" => NEEDS,
        "fit" => FIT,
        "leads" => LEADS,
        "curve" => CURVE,
        "check" => CHECK,
        "xray" if !led => xray::IN_FULL,
        "pause" => PAUSE,
        "break" => BREAK,
        "set" => parameters::IN_FULL,
        _ if NEXT.contains(&name) => return Some(next_in_full(led)),
        _ => return None,
    };
    Some(text.to_owned())
}

/// Only participants of a study have it.
const WITHDRAW: (&str, &str) =
    ("withdraw", "withdraw                 erase everything you did in this study; asks once more");
/// Not for participants of a study: refused in their runs.
const NOT_LED: [&str; 11] =
    ["branch", "step", "xray", "lens", "diff", "set", "break", "run", "back", "find", "who"];

/// The commands, for participants of a study or others.
fn commands(led: bool) -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = COMMANDS.iter().copied().filter(|(_, line)| !line.is_empty());
    all.filter(move |(name, _)| !led || !NOT_LED.contains(name)).chain(led.then_some(WITHDRAW))
}

/// `help [NAME]`, for participants of a study or others.
pub(super) fn help(
    name: Option<&str>,
    arguments: &[Argument],
    numbers: &Numbers,
    led: bool,
) -> Result<Answer, Problem> {
    let Some(name) = name else {
        let lines: Vec<&str> = commands(led).map(|(_, line)| line).collect();
        let tools: Vec<&str> = callable().collect();
        let text = format!(
            "{}\n\nEvery tool is a command too: {}\nFor instance: set_prices A=16 B=34 C=70\n\
             A week as agents call it: next_week {{\"rationale\": \"WHY\", \"predictions\": {{\"cash_1wk\": \
             {{\"point\": 950000, \"lower\": 900000, \"upper\": 990000}}, …}}}} (help next shows all of it)\n\
             help NAME explains one of them, and explain TERM says what a word means.",
            lines.join("\n"),
            tools.join(", ")
        );
        return Ok(Answer::done("help", text, json!({ "commands": lines, "tools": tools })));
    };
    let is_theirs = !led || !NOT_LED.contains(&name);
    if let Some(text) = in_full(name, led).filter(|_| is_theirs) {
        return Ok(Answer::done("help", text.clone(), json!({ "command": text })));
    }
    if let Some((_, line)) = commands(led).find(|(command, _)| *command == name) {
        return Ok(Answer::done("help", line.to_owned(), json!({ "command": line })));
    }
    if novamind_tools::find(name).is_some() || tool_called(name).is_some() {
        return readings::tools(Some(name), arguments, numbers);
    }
    if novamind_database::table(name).is_some() {
        return readings::tables(Some(name), arguments);
    }
    if let Ok(found) = novamind_glossary::find(name) {
        return Ok(words::answer("help", found, numbers));
    }
    let names = commands(led).map(|(name, _)| name).chain(callable());
    let names = names.chain(novamind_database::tables().iter().map(|table| table.name.as_str()));
    let where_to_look = "help lists the commands, glossary the terms";
    Err(problem(arguments, &not_there("nothing", name, nearest(name, names), where_to_look)))
}

/// The forms of the command that runs a week, and what its naive forecasts are worth; participants of a study are not
/// told how other companies did.
fn next_in_full(led: bool) -> String {
    let forms = "\
next \"WHY\" naive                         naive forecasts
next \"WHY\" P L U  P L U  P L U  P L U    point, lower, upper of cash in 1, 4, 12 and 26 weeks
next_week {\"rationale\": \"WHY\", \"predictions\": {\"cash_1wk\": {\"point\": 950000, \"lower\": 900000, \"upper\": 990000}, \
\"cash_4wk\": …, \"cash_12wk\": …, \"cash_26wk\": …}}
next                                     asks, at a terminal; in a lesson that asks for neither rationale nor forecasts it runs
                                         the week
Naive forecasts: income, compute and lead costs go on as in the last four weeks, at the costs set now.";
    match led {
        true => forms.to_owned(),
        false => format!("{forms} {}.", Bands::shipped().coverage_in_words()),
    }
}

fn callable() -> impl Iterator<Item = &'static str> {
    novamind_tools::CATALOGUE
        .iter()
        .map(|tool| tool.spec())
        .filter(|spec| spec.kind != Kind::Time)
        .map(|spec| spec.name())
}

/// That there is nothing of a name, what is near, and where the list is.
pub(super) fn not_there(what: &str, name: &str, near: Vec<&str>, list: &str) -> String {
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
            let told = help(Some(name), &[], &Numbers::shipped(), false).expect("help").as_text();
            assert!(told.lines().count() > 1, "{name}: {told}");
        }
        let told = help(Some("needs"), &[], &Numbers::shipped(), false).expect("help").as_text();
        assert!(told.contains("Urgent ones come first"), "{told}");
    }

    #[test]
    fn what_is_unknown_is_answered_with_where_the_list_is() {
        let numbers = Numbers::shipped();
        for (told, list) in [
            (help(Some("zzzzzzz"), &[], &numbers, false), "help lists the commands"),
            (readings::tools(Some("foo"), &[], &numbers), "tools lists them"),
            (readings::tables(Some("leger"), &[]), "did you mean ledger? tables lists them"),
        ] {
            let problem = told.expect_err(list);
            assert!(problem.text.ends_with(list) || problem.text.contains(list), "{problem:?}");
        }
    }
}
