//! `thread NUMBER`: shows one thread with the profile of the enterprise, all turns, and the deadline.

use serde_json::{Value, json};

use super::super::grammar::{Argument, ParseError};
use super::super::response::CommandResponse;
use super::inbox::{describe_offer, describe_request};
use super::{Interpreter, argument_error, optional_count};
use novamind_base::formatting::{dollars_and_cents, grouped_number};
use novamind_database::{Cell, QueryResult, number_at, text_at};
use novamind_record::mode::Mode;
use novamind_report::pluralize;
use novamind_rules::{LostThread, MIN_TURNS_PARAMETER, Subscription, ThreadContext, Turn};
use novamind_session::identifiers::Plan;
use novamind_tools::Rejection;

/// First part of a query that selects the turns of a thread.
const TURNS_SQL: &str = "SELECT thread_id, customer_id, thread_type, turn_number, sender, message_text, offer_json, day, \
                     seat_count, close_reason FROM enterprise_turns";
/// First part of a query that selects the profile of an enterprise.
const ENTERPRISE_SQL: &str = "SELECT c.group_id, c.persona_industry, c.company_size_descriptor, c.company_culture, \
                       c.company_decision_style, c.company_primary_concern, s.status, s.plan, s.effective_price, \
                       s.end_day \
                       FROM customers c CROSS JOIN subscriptions s WHERE s.customer_id = c.customer_id";

impl Interpreter {
    /// Executes `thread NUMBER`.
    pub(super) fn thread_command(&mut self, arguments: &[Argument]) -> Result<CommandResponse, ParseError> {
        let Some(thread) = optional_count(arguments)? else {
            return Err(argument_error(
                arguments,
                "thread needs the number of a thread, for example thread 12",
            ));
        };
        let command_response =
            self.show_thread(&format!("{TURNS_SQL} WHERE thread_id = {thread} ORDER BY message_id"));
        Ok(command_response.unwrap_or_else(|| {
            let text = format!(
                "there is no thread {thread}. To use the number of an enterprise, type: inbox NUMBER"
            );
            CommandResponse::rejected("thread", Rejection::new("thread_not_found", text))
        }))
    }

    /// Shows the newest thread of an enterprise.
    pub(super) fn show_newest_thread(&mut self, customer: u64) -> CommandResponse {
        let newest = format!(
            "{TURNS_SQL} WHERE thread_id = (SELECT max(thread_id) FROM enterprise_turns WHERE customer_id = {customer}) \
             ORDER BY message_id"
        );
        self.show_thread(&newest).unwrap_or_else(|| {
            let text =
                format!("enterprise {customer} has no thread. To list the waiting threads, type: inbox");
            CommandResponse::rejected("inbox", Rejection::new("thread_not_found", text))
        })
    }

    /// Returns the response for the thread that a statement selects, or `None` if the statement selects no turn.
    fn show_thread(&mut self, statement: &str) -> Option<CommandResponse> {
        let turns = match self.session.query_unrecorded(statement) {
            Ok(turns) => turns,
            Err(refusal) => return Some(CommandResponse::rejected("thread", refusal)),
        };
        let first = turns.rows.first()?;
        let (thread, customer) = (number_at(first, 0) as u32, number_at(first, 1) as u32);
        let company =
            self.session.query_unrecorded(&format!("{ENTERPRISE_SQL} AND c.customer_id = {customer}")).ok();
        let waiting = ThreadContext::read_all(&mut self.session).ok().and_then(|(waiting, _)| {
            waiting.into_iter().find(|thread_context| thread_context.waiting.thread == thread)
        });
        let names = self.session.company().enterprise_names();
        let kind = text_at(first, 2).replace('_', " ");
        // In the rows of the player's turns, the number of seats is always 1, so it is read from the
        // enterprise's turns.
        let customer_rows = turns.rows.iter().filter(|row| text_at(row, 4) != "agent");
        let seats = waiting.as_ref().map_or_else(
            || customer_rows.map(|row| number_at(row, 8) as u32).max().unwrap_or(1),
            |context| context.waiting.seats,
        );
        let mut lines = vec![format!(
            "{}, {}, {kind}, thread {thread}",
            names.name_with_number(customer),
            pluralize(seats, "seat")
        )];
        lines.extend(company.as_ref().and_then(describe_enterprise));
        lines.extend(turns.rows.iter().filter_map(|row| Some(names.insert_names(&describe_turn(row)?))));
        // Agents do not know the number of turns, because the texts of the tools do not state it.
        let is_shown = self.session.manifest().mode != Mode::Baseline || self.session.ended().is_some();
        let min_turns =
            self.session.numbers().value(MIN_TURNS_PARAMETER).filter(|_| is_shown).map(|turns| turns as u32);
        let lost = company.as_ref().filter(|_| waiting.is_none()).and_then(|company| {
            let turns: Vec<Turn> = turns.rows.iter().map(|row| Turn::from_row(row)).collect();
            LostThread::from_turns(&turns, text_at(first, 2), &subscription(company)?, min_turns)
        });
        match lost {
            Some(lost) => {
                lines.push(lost.describe(&names.name_with_number(customer)));
                lines.extend(lost.facts.iter().map(|fact| names.insert_names(fact)));
            }
            None => {
                lines.extend(describe_state(waiting.as_ref(), turns.rows.last().unwrap_or(first), customer));
            }
        }
        let data = json!({
            "thread": thread,
            "customer": customer,
            "company": names.name(customer),
            "waiting": waiting.map(|context| context.to_json(names)),
            "turns": turns.rows.iter().map(|row| turn_to_json(row)).collect::<Vec<Value>>(),
        });
        Some(CommandResponse::success("thread", lines.join("\n"), data))
    }
}

/// Describes the group, profile and subscription of an enterprise.
fn describe_enterprise(rows: &QueryResult) -> Option<String> {
    let row = rows.rows.first()?;
    let mut parts = vec![format!("group {}", text_at(row, 0))];
    let trade = format!("{} {}", text_at(row, 2), text_at(row, 1));
    for (name, value) in [
        ("trade", trade.trim()),
        ("culture", text_at(row, 3)),
        ("decides", text_at(row, 4)),
        ("main concern", text_at(row, 5)),
    ] {
        if !value.is_empty() {
            parts.push(format!("{name}: {value}"));
        }
    }
    parts.push(match text_at(row, 6) {
        "subscribed" => {
            format!(
                "subscribes to plan {} at {} per seat",
                text_at(row, 7),
                dollars_and_cents(number_at(row, 8))
            )
        }
        "lead" => "not subscribed yet".to_owned(),
        other => format!("subscription {other}"),
    });
    Some(parts.join("; "))
}

/// Returns the subscription of an enterprise.
fn subscription(rows: &QueryResult) -> Option<Subscription> {
    let row = rows.rows.first()?;
    let end_day = row.get(9).filter(|cell| !matches!(cell, Cell::Null)).map(|_| number_at(row, 9) as u32);
    Some(Subscription {
        status: text_at(row, 6).to_owned(),
        plan: Plan::parse(text_at(row, 7)),
        price: number_at(row, 8),
        end_day,
    })
}

/// Formats a turn as one line. Returns `None` for an opening turn without a message.
fn describe_turn(row: &[Cell]) -> Option<String> {
    let (day, words) = (number_at(row, 7), text_at(row, 5));
    let Turn { offers, price, .. } = Turn::from_row(row);
    let text = match (text_at(row, 4), text_at(row, 9)) {
        ("agent", "agent_rejected") => "you ended the thread".to_owned(),
        ("agent", _) => format!("you offered {}", describe_offer(&offers)),
        ("customer", _) if words.is_empty() => {
            format!("the enterprise asked for {}", dollars_and_cents(price?))
        }
        ("customer", _) => format!("the enterprise wrote: {words}"),
        _ if words.is_empty() => return None,
        _ => words.to_owned(),
    };
    Some(format!("day {day}: {text}"))
}

/// Describes whether the thread waits for the player, and the possible next step.
fn describe_state(waiting: Option<&ThreadContext>, last: &[Cell], customer: u32) -> Vec<String> {
    let Some(thread) = waiting else {
        return vec![match text_at(last, 9) {
            "accepted" => "the thread ended with a deal".to_owned(),
            "agent_rejected" => "you ended the thread".to_owned(),
            _ if text_at(last, 4) == "agent" => "the enterprise has not answered your offer yet".to_owned(),
            _ => "the thread does not wait for you".to_owned(),
        }];
    };
    let mut parts =
        vec![format!("the thread waits for you: {} left", pluralize(thread.waiting.days_left, "day"))];
    parts.extend(describe_request(thread).map(|ask| format!("the enterprise {ask}")));
    parts.extend(thread.required_quota.map(|units| {
        format!("the enterprise needs a quota of {} units a day", grouped_number(units.round(), 0))
    }));
    let plan = thread.asked_plan.map_or("B", |plan| plan.id());
    vec![
        parts.join("; "),
        format!(
            "answer with send_enterprise_deal [[{customer}, [[\"{plan}\", PRICE]]]] or reject_enterprise_deal {customer}"
        ),
    ]
}

fn turn_to_json(row: &[Cell]) -> Value {
    let Turn { offers, price, .. } = Turn::from_row(row);
    json!({
        "turn": number_at(row, 3),
        "sender": text_at(row, 4),
        "day": number_at(row, 7),
        "text": text_at(row, 5),
        "offers": offers,
        "price": price,
        "close_reason": text_at(row, 9),
    })
}
