use serde_json::Value;

use super::super::arguments::Arguments;
use super::super::rejection::DealResults;
use super::super::{
    Argument, ArgumentKind, EffectTiming, PlannedCall, Rejection, Tool, ToolContext, ToolId, ToolKind,
    ToolModule, ToolSpec,
};
use super::parsing::{ElementError, malformed_element, parse_deal_customer, parse_elements};
use super::{ElementFailure, ElementOutcome, RESULT_FIELDS, reject_if_all_failed};
use novamind_world::command::Command;

/// The tool `reject_enterprise_deal`, which ends open threads with enterprises although no deal was made.
pub struct RejectEnterpriseDeal;

/// A thread that the call ends.
pub struct ThreadToEnd {
    customer: i64,
    /// Path of the customer number in the arguments.
    field: String,
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::RejectEnterpriseDeal,
    code: "REJ",
    module: ToolModule::Enterprise,
    kind: ToolKind::OneShot,
    summary: "End open enterprise threads without a deal",
    arguments: &[Argument {
        name: "deals",
        alias: None,
        kind: ArgumentKind::Structure("list of customer numbers, [customer_id] or {customer_id}"),
        required: false,
        unit: "",
        description: "the enterprises whose open threads end",
    }],
    has_own_unknown_code: false,
    unnamed_argument: Some("deals"),
    effect_timing: EffectTiming::Now,
    effect: "A new lead is lost. For a subscriber, only the thread ends: the enterprise keeps its \
             terms, and can open another thread from the next day.",
    cost: "nothing",
    written_tables: &["enterprise_turns", "subscriptions"],
    rejection_codes: &["deals_missing", "deal_malformed", "customer_missing", "no_active_thread"],
    result_fields: RESULT_FIELDS,
    example: r#"{"deals": [{"customer_id": 207}]}"#,
};

impl Tool for RejectEnterpriseDeal {
    type Args = Vec<Result<ThreadToEnd, ElementFailure>>;
    type Answer = DealResults;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(&self, _: &ToolContext<'_>, arguments: &Arguments) -> Result<Self::Args, Rejection> {
        let elements = parse_elements(arguments.get("deals"), "[{\"customer_id\": 207}]")?;
        let read = |(at, element): (usize, &Value)| {
            let path = format!("deals.{at}");
            let customer =
                parse_element_customer(element, &path).map_err(ElementError::into_element_failure)?;
            Ok(ThreadToEnd { customer, field: format!("{path}.customer_id") })
        };
        Ok(elements.iter().enumerate().map(read).collect())
    }

    fn plan(&self, view: &ToolContext<'_>, given: Self::Args) -> Result<PlannedCall<DealResults>, Rejection> {
        let mut threads = Vec::new();
        let mut open = view.world().enterprise.open_threads();
        let mut end = |rejection: ThreadToEnd| {
            let number = u32::try_from(rejection.customer).ok();
            match (number, number.and_then(|customer| open.pop_newest(customer))) {
                (Some(customer), Some(thread)) => {
                    threads.push(thread.number);
                    Ok(customer)
                }
                _ => Err(rejection.no_thread_failure()),
            }
        };
        let outcomes: Vec<ElementOutcome> =
            given.into_iter().map(|given| ElementOutcome::from_result(given.and_then(&mut end))).collect();
        let results = reject_if_all_failed(outcomes)?;
        Ok(PlannedCall::with_command(Command::RejectDeals(threads), results))
    }
}

impl ThreadToEnd {
    fn no_thread_failure(self) -> ElementFailure {
        let message = format!("customer {} has no open thread to end", self.customer);
        let refusal = Rejection::for_field(self.field, "no_active_thread", message);
        ElementFailure::new(self.customer, "no active thread", refusal)
    }
}

fn parse_element_customer(element: &Value, path: &str) -> Result<i64, ElementError> {
    match element {
        Value::Object(map) => parse_deal_customer(map.get("customer_id"), path),
        Value::Array(single) if single.len() == 1 => parse_deal_customer(single.first(), path),
        Value::Number(_) | Value::String(_) => parse_deal_customer(Some(element), path),
        _ => Err(malformed_element(path, "write it as {\"customer_id\": 207}, [207] or 207")),
    }
}
