//! `inbox`: shows the totals of the waiting threads by group, then lists the threads with the earliest
//! deadlines.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::{Interpreter, argument_error};
use novamind_base::formatting::{dollars_and_cents, grouped_number};
use novamind_report::funnel::{Funnel, funnels};
use novamind_report::pluralize;
use novamind_rules::{Filter, ThreadContext};
use novamind_session::EnterpriseNames;
use novamind_session::identifiers::Plan;

/// Maximum number of threads in the text response. The JSON data contains all threads.
const MAX_LISTED_THREADS: usize = 20;
/// A thread is urgent if at most this number of days is left.
const URGENT_DAYS: u32 = 2;

pub(super) const HELP: &str = "\
inbox                     show the number of waiting threads in each group, and list the 20 with the earliest deadlines,
                          larger enterprises first
inbox all                 list every waiting thread
inbox where CONDITION     list threads that meet a condition in the grammar of rules, for example
                          inbox where group = E2 and seats >= 500
inbox all where CONDITION list all threads that meet a condition, even more than 20
inbox NUMBER              show the newest thread of an enterprise, turn by turn, for example inbox 5641
thread NUMBER             show the thread with that number, waiting or ended
Conditions use: group, type, seats, asked, asked_plan, last_offer, offers_so_far, turn, days_left, needed_quota, customer.
Use send_enterprise_deal or reject_enterprise_deal to answer a thread, and rules to answer many threads.";

/// The threads that an `inbox` command lists.
#[derive(Default)]
struct ThreadSelection {
    all: bool,
    filter: Option<Filter>,
}

impl Interpreter {
    /// Executes `inbox`, `inbox all` and `inbox NUMBER`.
    pub(super) fn run_inbox(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        match arguments {
            [] => Ok(self.list_threads(&ThreadSelection::default())),
            [Argument { key: None, value: Value::String(word), .. }] if word == "all" => {
                Ok(self.list_threads(&ThreadSelection { all: true, filter: None }))
            }
            [Argument { key: None, value, .. }] if value.is_u64() => {
                Ok(self.show_newest_thread(value.as_u64().unwrap_or_default()))
            }
            _ => Err(argument_error(
                arguments,
                "inbox takes all, the number of an enterprise, or where and a condition, for example: inbox where \
                 seats >= 500. For help, type: help inbox",
            )),
        }
    }

    /// Executes `inbox [all] where CONDITION`. `text` is the text after the command and begins at `column`.
    pub(super) fn run_inbox_query(&mut self, text: &str, column: usize) -> CommandResponse {
        let before = text.find("where").map_or(0, |at| at + "where".len());
        let (head, condition) = text.split_at(before);
        match Filter::parse(condition) {
            Ok(filter) => {
                self.record_view(&format!("inbox {text}"), &[]);
                self.list_threads(&ThreadSelection { all: head.starts_with("all"), filter: Some(filter) })
            }
            Err(wrong) => {
                CommandResponse::syntax_error(wrong.text, column + head.chars().count() + wrong.column - 1)
            }
        }
    }

    fn list_threads(&mut self, wanted: &ThreadSelection) -> CommandResponse {
        let mut waiting = match ThreadContext::read_all(&mut self.session) {
            Ok((waiting, _)) => waiting,
            Err(refusal) => return CommandResponse::rejected("inbox", refusal),
        };
        let everyone = waiting.len();
        if let Some(filter) = &wanted.filter {
            waiting.retain(|thread| filter.matches(thread));
        }
        let names = self.session.company().enterprise_names();
        let funnels = funnels(&self.session);
        let data = json!({
            "threads": waiting.iter().map(|thread| thread.to_json(names)).collect::<Vec<Value>>(),
            "funnels": funnels.iter().map(funnel_to_json).collect::<Vec<Value>>(),
        });
        let mut lines = match (&wanted.filter, waiting.len()) {
            (None, 0) => vec!["no threads waiting".to_owned()],
            (None, many) => vec![format!("{} waiting", describe_thread_count(many))],
            (Some(_), many) => {
                vec![format!(
                    "{} of {} waiting match",
                    grouped_number(many as f64, 0),
                    describe_thread_count(everyone)
                )]
            }
        };
        lines.extend(group_lines(&waiting));
        if wanted.filter.is_none() {
            lines.extend(funnels.iter().map(Funnel::describe));
        }
        lines.extend(thread_lines(&waiting, wanted, names));
        CommandResponse::success("inbox", lines.join("\n"), data)
    }
}

fn describe_thread_count(many: usize) -> String {
    pluralize(many as u32, "thread")
}

fn funnel_to_json(funnel: &Funnel) -> Value {
    json!({
        "group": funnel.group.id(),
        "came": funnel.enterprises,
        "no_plan_good_enough": funnel.lost_before_request(),
        "asked": funnel.requests,
        "signed": funnel.deals,
    })
}

/// Returns one sentence for each group with waiting threads.
fn group_lines(waiting: &[ThreadContext]) -> Vec<String> {
    let mut groups: BTreeMap<&str, Vec<&ThreadContext>> = BTreeMap::new();
    for thread in waiting {
        groups.entry(thread.waiting.group).or_default().push(thread);
    }
    groups.into_iter().map(|(group, threads)| group_line(group, &threads)).collect()
}

fn group_line(group: &str, threads: &[&ThreadContext]) -> String {
    let seats: u32 = threads.iter().map(|thread| thread.waiting.seats).sum();
    let mut line = format!("{group}: {}, {}", describe_thread_count(threads.len()), pluralize(seats, "seat"));
    let urgent = threads.iter().filter(|thread| thread.waiting.days_left <= URGENT_DAYS).count();
    if urgent > 0 {
        line += &format!(", {} with {URGENT_DAYS} days or less", grouped_number(urgent as f64, 0));
    }
    let asked: Vec<f64> = threads.iter().filter_map(|thread| thread.waiting.asked).collect();
    let least = asked.iter().copied().fold(f64::INFINITY, f64::min);
    let most = asked.iter().copied().fold(0.0, f64::max);
    match asked.len() {
        0 => line + ", none names a price",
        1 => line + &format!(", 1 names a price, {}", dollars_and_cents(most)),
        many => {
            line + &format!(
                ", {} name a price, {} to {}",
                grouped_number(many as f64, 0),
                dollars_and_cents(least),
                dollars_and_cents(most)
            )
        }
    }
}

/// Describes the listed threads, one sentence each, and the command that lists the remaining threads.
fn thread_lines(waiting: &[ThreadContext], wanted: &ThreadSelection, names: &EnterpriseNames) -> Vec<String> {
    let number = if wanted.all { waiting.len() } else { waiting.len().min(MAX_LISTED_THREADS) };
    if number == 0 {
        return Vec::new();
    }
    let mut lines = vec![match number < waiting.len() {
        true => format!("the {number} threads with the earliest deadlines, larger enterprises first:"),
        false => "threads by deadline, earliest first:".to_owned(),
    }];
    lines.extend(waiting.iter().take(number).map(|thread| describe_thread(thread, names)));
    if number < waiting.len() {
        let more = grouped_number((waiting.len() - number) as f64, 0);
        lines.push(match wanted.filter {
            Some(_) => format!("{more} more; to list all matching threads, type: inbox all where …"),
            None => format!(
                "{more} more; to list all, type: inbox all; to select some, type: inbox where CONDITION, for \
                 example inbox where seats >= 500"
            ),
        });
    }
    lines.push("to show the thread of one enterprise, type: inbox NUMBER".to_owned());
    lines
}

/// Formats a thread as one sentence.
fn describe_thread(thread: &ThreadContext, names: &EnterpriseNames) -> String {
    let waiting_thread = &thread.waiting;
    let mut parts = vec![
        names.name_with_number(waiting_thread.customer),
        waiting_thread.group.to_owned(),
        pluralize(waiting_thread.seats, "seat"),
        waiting_thread.kind.replace('_', " "),
        format!("{} left", pluralize(waiting_thread.days_left, "day")),
    ];
    parts.extend(describe_request(thread));
    parts.push(match waiting_thread.last_offer.as_slice() {
        [] => "no offer yet".to_owned(),
        offered => format!("last offer {}", describe_offer(offered)),
    });
    if let Some(units) = thread.required_quota {
        parts.push(format!("needs a quota of {} units a day", grouped_number(units.round(), 0)));
    }
    parts.join(", ")
}

/// Describes what the enterprise asked for: a price, a plan, or both.
pub(super) fn describe_request(thread: &ThreadContext) -> Option<String> {
    match (thread.waiting.asked, thread.asked_plan) {
        (Some(price), Some(plan)) => Some(format!("asks {} for plan {plan}", dollars_and_cents(price))),
        (Some(price), None) => Some(format!("asks {}", dollars_and_cents(price))),
        (None, Some(plan)) => Some(format!("asks the price of plan {plan}")),
        (None, None) => None,
    }
}

/// Formats an offer, for example `plan B at $30.00 or plan C at $55.00`.
pub(super) fn describe_offer(offered: &[(Plan, f64)]) -> String {
    let line = |(plan, price): &(Plan, f64)| format!("plan {plan} at {}", dollars_and_cents(*price));
    offered.iter().map(line).collect::<Vec<_>>().join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_session::WaitingThread;
    use novamind_world::params::Params;

    fn thread(customer: u32, asked: Option<f64>, asked_plan: Option<Plan>) -> ThreadContext {
        let waiting = WaitingThread {
            thread: customer + 1_000,
            customer,
            group: if customer.is_multiple_of(2) { "E2" } else { "E1" },
            seats: 50,
            kind: "plan_change",
            turn: 1,
            offers_so_far: 0,
            last_offer: Vec::new(),
            asked,
            days_left: customer % 7 + 1,
        };
        ThreadContext { waiting, asked_plan, required_quota: Some(5_000.0) }
    }

    #[test]
    fn full_inbox_lists_groups_and_twenty_threads() {
        let names = EnterpriseNames::new(3, &Params::bundled().personas.email);
        let mut waiting: Vec<ThreadContext> = (1..=682).map(|at| thread(at, None, None)).collect();
        waiting[0] = thread(1, Some(20.0), Some(Plan::B));
        waiting[1] = thread(2, None, Some(Plan::A));
        let groups = group_lines(&waiting);
        assert!(groups[0].starts_with("E1: 341 threads, 17,050 seats, "), "{groups:?}");
        assert!(
            groups[0].ends_with(", 1 names a price, $20.00") && groups[1].ends_with("none names a price")
        );
        let lines = thread_lines(&waiting, &ThreadSelection::default(), &names);
        assert_eq!(lines.len(), 1 + MAX_LISTED_THREADS + 2);
        assert!(
            lines[1].contains("50 seats, plan change, 2 days left, asks $20.00 for plan B, no offer yet")
        );
        assert!(
            lines[2].contains("asks the price of plan A, no offer yet, needs a quota of 5,000 units a day")
        );
        assert!(
            lines[21].starts_with("662 more; to list all, type: inbox all")
                && lines[22].ends_with("type: inbox NUMBER")
        );
        let all = thread_lines(&waiting, &ThreadSelection { all: true, filter: None }, &names);
        assert_eq!(all.len(), 1 + 682 + 1);
        assert!(thread_lines(&[], &ThreadSelection::default(), &names).is_empty());
    }
}
