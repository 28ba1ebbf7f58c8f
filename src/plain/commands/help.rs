//! `help`: the list of commands, and help on each of them.

use serde_json::json;

use super::super::answers::Answer;
use super::super::grammar::{Argument, Problem};
use super::{COMMANDS, NEXT, inbox, parameters, problem, readings, rules, tool_called, words, xray};
use novamind_base::nearest;
use novamind_session::Bands;
use novamind_tools::{Kind, Numbers};

const NEEDS: &str = "\
needs                     list problems that cost money or soon will, each with the amount and a call that addresses it
Urgent ones come first and are marked with !. Within each kind, the order is by money at risk in the next four weeks.
You can type the call below a problem as it is. Type check before it to preview its effect, for example
                          check set_capacity_tier 2";

const FIT: &str = "\
fit                       show every known group
fit GROUP                 show one group, for example fit S1
For each plan: price, quality and quota next to the budget, required quality and usage of the group. The estimates are
ranges with their dates; research_group narrows them. Certain mismatches are named.";

const LEADS: &str = "\
leads                     show leads by group in the last week and the last four, paid and by word of mouth, and conversions
leads GROUP               show one group, for example leads S1
Then, by channel and group, the cost per lead and per first bill in the last four weeks, compared with the cheapest four
weeks before.";

const CURVE: &str = "\
curve GROUP               show the quality that 10, 50 and 90 % of the leads of a group require at a price, the
                          plans, and their conversion and revenue per lead; for example curve S1
curve GROUP PRICE QUALITY show the expected result of a single product, without quota and discount, for
                          example curve S1 30 0.4
The curve evaluates 2,000 sampled leads with the functions of the simulator. In debug and finished runs they are drawn from
the true parameters of the group, and the inspection is recorded. In all other runs they are drawn from the results of
market studies, so that each figure is a range that covers the error of the study.";

const CHECK: &str = "\
check CALL                preview the effect and cost of a call; nothing is done, drawn or recorded. For example
                          check set_prices B=30
                          check set_capacity_tier 2
                          check research_group S2
Prices, model tiers and quotas are shown with the resulting gross margins, capacity with the busiest day of the last week, a
study with the level it reaches, an R&D project with the range of its effect.";

const PAUSE: &str = "\
pause                     stop the clock for a break; until resume, only resume, help and quit work
pause REASON              the same with a reason, which is recorded, for example pause lunch
Time with the clock stopped does not count as playing time.";

const BREAK: &str = "\
break                     list the breakpoints with their numbers
break CONDITION           set one; run DAYS stops on the first day on which it becomes true. For example
                          break churn(S1) > 5% over 7
                          break reputation(S3) falls
                          break leads(S1) rises over 7
                          break event rival
break clear N             remove one; break clear all removes all of them
A condition is FIGURE > NUMBER, with >, >=, < or <=, FIGURE rises, FIGURE falls, or event rival, drift, surge or outage.
over DAYS sums counts over that many days and computes shares of the sums. Figures of a group, as in subscribers(S1): subscribers,
leads, new_subscribers, conversion, cancellations, churn, usage, open_issues, reputation, satisfaction, relationship.
Figures of the company: cash, recurring_revenue, payments, running_costs, subscribers, seats, leads, individual_leads,
new_subscribers, new_seats, conversion, cancellations, churn, upgrades, downgrades, usage, overload, downtime_minutes,
open_issues.";

/// Returns the full help of a command, if it has one.
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

/// Listed only for participants of a study.
const WITHDRAW: (&str, &str) =
    ("withdraw", "withdraw                 erase everything you did in this study; asks once more");
/// Commands that are rejected in runs of participants of a study.
const NOT_LED: [&str; 11] =
    ["branch", "step", "xray", "lens", "diff", "set", "break", "run", "since", "find", "who"];

/// Returns the commands for participants of a study or for others.
fn commands(led: bool) -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = COMMANDS.iter().copied().filter(|(_, line)| !line.is_empty());
    all.filter(move |(name, _)| !led || !NOT_LED.contains(name)).chain(led.then_some(WITHDRAW))
}

/// `help [NAME]`, for participants of a study or for others.
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
            "{}\n\nEvery tool is also a command: {}\nFor example: set_prices A=16 B=34 C=70\n\
             The call of agents for a week: next_week {{\"rationale\": \"WHY\", \"predictions\": {{\"cash_1wk\": \
             {{\"point\": 950000, \"lower\": 900000, \"upper\": 990000}}, …}}}} (help next shows the full form)\n\
             Type help NAME for one of them, and explain TERM for the meaning of a word.",
            lines.join("\n"),
            tools.join(", ")
        );
        return Ok(Answer::done("help", text, json!({ "commands": lines, "tools": tools })));
    };
    let name = match name {
        "again" => "retry",
        "back" => "since",
        name => name,
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

/// Returns the forms of `next` and the coverage of naive forecasts. Participants of a study do not get the coverage, because it
/// comes from other companies.
fn next_in_full(led: bool) -> String {
    let forms = "\
next \"WHY\" naive                         naive forecasts
next \"WHY\" P L U  P L U  P L U  P L U    point, lower, upper of cash in 1, 4, 12 and 26 weeks
next_week {\"rationale\": \"WHY\", \"predictions\": {\"cash_1wk\": {\"point\": 950000, \"lower\": 900000, \"upper\": 990000}, \
\"cash_4wk\": …, \"cash_12wk\": …, \"cash_26wk\": …}}
next                                     asks at a terminal; simulates the week in a lesson that needs neither rationale nor
                                         forecasts
Naive forecasts: income, compute and lead costs continue as in the last four weeks, at the costs set now.";
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

/// Returns an error message with similar names and the command that lists all names.
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
