use serde_json::Value;

use super::super::arguments::Arguments;
use super::super::{Argument, ArgumentKind, Kind, Module, Refusal, Spec, Tool, ToolId, View, When};
use super::reading::{Unreadable, customer, elements, malformed};
use super::{Failure, Fate, RESULTS, results, unless_all_failed};
use crate::world::command::{Command, ResolvedCommand};

/// Ends talks with companies.
pub struct RejectEnterpriseDeal;

static SPEC: Spec = Spec {
    id: ToolId::RejectEnterpriseDeal,
    code: "REJ",
    module: Module::Enterprise,
    kind: Kind::OneShot,
    summary: "End open company threads without making a deal",
    arguments: &[Argument {
        name: "deals",
        alias: None,
        kind: ArgumentKind::Structure("list of customer numbers, [customer_id] or {customer_id}"),
        required: false,
        unit: "",
        doc: "the companies whose open threads are ended",
    }],
    own_unknown: false,
    whole: Some("deals"),
    when: When::Now,
    effect: "A new lead is lost for good. The thread of a subscriber only closes: the company keeps its \
             terms, and can open another thread from the next day.",
    cost: "nothing",
    writes: &["enterprise_turns", "subscriptions"],
    refusals: &["deals_missing", "deal_malformed", "customer_missing", "no_active_thread"],
    returns: RESULTS,
    example: r#"{"deals": [{"customer_id": 207}]}"#,
};

impl Tool for RejectEnterpriseDeal {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn plan(&self, view: &View<'_>, arguments: &Arguments) -> Result<Command, Refusal> {
        let (fates, threads) = read(view, arguments)?;
        unless_all_failed(&fates)?;
        Ok(Command::RejectDeals(threads))
    }

    fn answer(&self, view: &View<'_>, arguments: &Arguments, _: &ResolvedCommand) -> Value {
        read(view, arguments).map_or(Value::Null, |(fates, _)| results(&fates))
    }
}

/// What becomes of each element, and the threads that are ended.
fn read(view: &View<'_>, arguments: &Arguments) -> Result<(Vec<Fate>, Vec<u32>), Refusal> {
    let (mut fates, mut threads) = (Vec::new(), Vec::new());
    for (at, element) in elements(arguments.get("deals"), "[{\"customer_id\": 207}]")?.iter().enumerate() {
        let path = format!("deals.{at}");
        let given = match named(element, &path) {
            Err(unreadable) => {
                fates.push(Fate::Failed(unreadable.of_element()));
                continue;
            }
            Ok(given) => given,
        };
        let number = u32::try_from(given).ok();
        let thread = number.and_then(|customer| view.world().enterprise.rejectable(customer, &threads));
        fates.push(match (number, thread) {
            (Some(customer), Some(thread)) => {
                threads.push(thread.number);
                Fate::Done(customer)
            }
            _ => {
                let message = format!("customer {given} has no open thread to end");
                let refusal = Refusal::at(format!("{path}.customer_id"), "no_active_thread", message);
                Fate::Failed(Failure::of(given, "no active thread", refusal))
            }
        });
    }
    Ok((fates, threads))
}

/// The customer that an element names.
fn named(element: &Value, path: &str) -> Result<i64, Unreadable> {
    match element {
        Value::Object(map) => customer(map.get("customer_id"), path),
        Value::Array(single) if single.len() == 1 => customer(single.first(), path),
        Value::Number(_) | Value::String(_) => customer(Some(element), path),
        _ => Err(malformed(path, "write it as {\"customer_id\": 207}, [207] or 207")),
    }
}
