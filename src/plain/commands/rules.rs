//! `rules`: previews or sends the replies of rules to waiting threads.

use serde_json::{Value, json};

use super::super::response::CommandResponse;
use super::Interpreter;
use novamind_base::formatting::{dollars_and_cents, grouped_number};
use novamind_database::text::align_columns;
use novamind_record::trajectory::record::Via;
use novamind_rules::{RuleBatch, RuleOutcome, ThreadContext};
use novamind_session::EnterpriseNames;
use novamind_tools::{Rejection, ToolId};

/// Maximum number of threads in the text of a preview. The JSON data contains all threads.
const MAX_LISTED_THREADS: usize = 20;

pub const HELP: &str = "\
rules RULES         preview the answer to each waiting thread; nothing is sent
rules send RULES    send the answers with one call to send_enterprise_deal and one call to reject_enterprise_deal
A rule is an action with conditions. Semicolons separate rules; the first rule that matches a thread answers it.
  offer where group = E2 and asked is null: B 85
  offer where asked_plan = B and seats >= 500: B asked*1.05, C list*0.9
  accept asked >= 18
  reject rest
accept offers what the enterprise asked for. A price is in dollars, or asked, list or last_offer, optionally with a factor.
Conditions use: group, type, seats, asked, asked_plan, last_offer, offers_so_far, turn, days_left, needed_quota, customer.
Operators: = != < <= > >=, in (…), is null, is not null; and joins conditions. rest matches all other threads.";

impl Interpreter {
    pub(super) fn rules_command(&mut self, text: &str, column: usize) -> CommandResponse {
        let (send, text, before) = match text.split_once(char::is_whitespace) {
            Some(("send", rest)) => (true, rest.trim_start(), text.len() - rest.trim_start().len()),
            _ => (false, text, 0),
        };
        let rules = match novamind_rules::parse(text) {
            Ok(rules) => rules,
            Err(problem) => {
                return CommandResponse::syntax_error(problem.text, column + before + problem.column - 1);
            }
        };
        let (threads, market) = match ThreadContext::read_all(&mut self.session) {
            Ok(all) => all,
            Err(refusal) => return CommandResponse::rejected("rules", refusal),
        };
        let batch = RuleBatch::new(rules, threads, &market);
        if send {
            self.send_batch(&batch)
        } else {
            preview_response(&batch, self.session.company().enterprise_names())
        }
    }

    fn send_batch(&mut self, batch: &RuleBatch) -> CommandResponse {
        let calls = batch.tool_calls();
        if calls.is_empty() {
            let text = format!(
                "no waiting thread would get an offer or a rejection\n{}",
                batch.summary().join("\n")
            );
            return CommandResponse::rejected("rules", Rejection::new("nothing_to_send", text));
        }
        let (mut lines, mut data) = (batch.summary(), Vec::new());
        for (tool, arguments) in calls {
            let what = if tool == ToolId::SendEnterpriseDeal { "offers sent" } else { "threads ended" };
            match self.session.call(tool.name(), &arguments, Via::Plain) {
                Ok(answer) => {
                    let answer = answer.to_json();
                    let results = answer.get("results").and_then(Value::as_array);
                    let failed = |result: &&Value| result.get("error").is_some();
                    let (all, failed) =
                        results.map_or((0, 0), |all| (all.len(), all.iter().filter(failed).count()));
                    let refused = if failed > 0 { format!(", {failed} rejected") } else { String::new() };
                    lines.push(format!("{} {what}{refused}", grouped_number((all - failed) as f64, 0)));
                    data.push(json!({ "tool": tool, "answer": answer }));
                }
                Err(refusal) if data.is_empty() => return CommandResponse::rejected("rules", refusal),
                // Tool calls that succeeded earlier are not reverted.
                Err(refusal) => {
                    lines.push(format!("{tool} rejected {}: {}", refusal.code, refusal.message));
                    data.push(json!({ "tool": tool, "code": refusal.code, "error": refusal.message }));
                }
            }
        }
        CommandResponse::success(
            "rules",
            lines.join("\n"),
            json!({ "rules": batch.totals_to_json(), "calls": data }),
        )
    }
}

fn preview_response(batch: &RuleBatch, names: &EnterpriseNames) -> CommandResponse {
    let mut lines = batch.summary();
    let meant: Vec<&RuleOutcome> = batch.threads.iter().filter(|ruled| ruled.rule_index.is_some()).collect();
    if !meant.is_empty() {
        let head = ["rule", "enterprise", "group", "seats", "asked", "last offer", "left", "sends"];
        let rows: Vec<Vec<String>> =
            meant.iter().take(MAX_LISTED_THREADS).map(|ruled| preview_row(ruled, names)).collect();
        lines.push(align_columns(&head.map(str::to_owned), &rows).trim_end().to_owned());
    }
    if meant.len() > MAX_LISTED_THREADS {
        lines.push(format!("and {} more", grouped_number((meant.len() - MAX_LISTED_THREADS) as f64, 0)));
    }
    lines.push("nothing was sent. To send the replies, type: rules send …".to_owned());
    let threads: Vec<Value> = batch.threads.iter().map(|ruled| ruled.to_json(names)).collect();
    let data = json!({ "rules": batch.totals_to_json(), "threads": threads });
    CommandResponse::success("rules", lines.join("\n"), data)
}

fn preview_row(ruled: &RuleOutcome, names: &EnterpriseNames) -> Vec<String> {
    let thread = &ruled.thread;
    let waiting_thread = &thread.waiting;
    let plan = thread.asked_plan.map_or(String::new(), |plan| format!("{plan} "));
    let last: Vec<String> = waiting_thread
        .last_offer
        .iter()
        .map(|(plan, price)| format!("{plan} {}", dollars_and_cents(*price)))
        .collect();
    vec![
        ruled.rule_index.map_or(String::new(), |at| (at + 1).to_string()),
        names.name_with_number(waiting_thread.customer),
        waiting_thread.group.to_owned(),
        waiting_thread.seats.to_string(),
        waiting_thread.asked.map_or(String::new(), |asked| format!("{plan}{}", dollars_and_cents(asked))),
        last.join(" or "),
        waiting_thread.days_left.to_string(),
        ruled.describe_reply(),
    ]
}
