use serde_json::Value;

use super::super::arguments::Arguments;
use super::super::refusal::DealResults;
use super::super::{Argument, ArgumentKind, Kind, Module, Planned, Refusal, Spec, Tool, ToolId, View, When};
use super::reading::{Unreadable, customer, elements, malformed};
use super::{Failure, Fate, RESULTS, unless_all_failed};
use novamind_world::command::Command;

/// The tool `reject_enterprise_deal`.
pub struct RejectEnterpriseDeal;

/// A thread to end.
pub struct Rejection {
    customer: i64,
    /// Path of the customer number.
    field: String,
}

static SPEC: Spec = Spec {
    id: ToolId::RejectEnterpriseDeal,
    code: "REJ",
    module: Module::Enterprise,
    kind: Kind::OneShot,
    summary: "End open enterprise threads without a deal",
    arguments: &[Argument {
        name: "deals",
        alias: None,
        kind: ArgumentKind::Structure("list of customer numbers, [customer_id] or {customer_id}"),
        required: false,
        unit: "",
        doc: "the enterprises whose open threads end",
    }],
    own_unknown: false,
    whole: Some("deals"),
    when: When::Now,
    effect: "A new lead is lost. For a subscriber, only the thread ends: the enterprise keeps its \
             terms, and can open another thread from the next day.",
    cost: "nothing",
    writes: &["enterprise_turns", "subscriptions"],
    refusals: &["deals_missing", "deal_malformed", "customer_missing", "no_active_thread"],
    returns: RESULTS,
    example: r#"{"deals": [{"customer_id": 207}]}"#,
};

impl Tool for RejectEnterpriseDeal {
    type Args = Vec<Result<Rejection, Failure>>;
    type Answer = DealResults;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, _: &View<'_>, arguments: &Arguments) -> Result<Self::Args, Refusal> {
        let elements = elements(arguments.get("deals"), "[{\"customer_id\": 207}]")?;
        let read = |(at, element): (usize, &Value)| {
            let path = format!("deals.{at}");
            let customer = named(element, &path).map_err(Unreadable::of_element)?;
            Ok(Rejection { customer, field: format!("{path}.customer_id") })
        };
        Ok(elements.iter().enumerate().map(read).collect())
    }

    fn plan(&self, view: &View<'_>, given: Self::Args) -> Result<Planned<DealResults>, Refusal> {
        let mut threads = Vec::new();
        let mut open = view.world().enterprise.open_threads();
        let mut end = |rejection: Rejection| {
            let number = u32::try_from(rejection.customer).ok();
            match (number, number.and_then(|customer| open.take_newest(customer))) {
                (Some(customer), Some(thread)) => {
                    threads.push(thread.number);
                    Ok(customer)
                }
                _ => Err(rejection.without_thread()),
            }
        };
        let fates: Vec<Fate> = given.into_iter().map(|given| Fate::of(given.and_then(&mut end))).collect();
        let results = unless_all_failed(fates)?;
        Ok(Planned::doing(Command::RejectDeals(threads), results))
    }
}

impl Rejection {
    fn without_thread(self) -> Failure {
        let message = format!("customer {} has no open thread to end", self.customer);
        let refusal = Refusal::at(self.field, "no_active_thread", message);
        Failure::of(self.customer, "no active thread", refusal)
    }
}

fn named(element: &Value, path: &str) -> Result<i64, Unreadable> {
    match element {
        Value::Object(map) => customer(map.get("customer_id"), path),
        Value::Array(single) if single.len() == 1 => customer(single.first(), path),
        Value::Number(_) | Value::String(_) => customer(Some(element), path),
        _ => Err(malformed(path, "write it as {\"customer_id\": 207}, [207] or 207")),
    }
}
