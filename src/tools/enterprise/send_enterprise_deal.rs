use serde_json::Value;

use super::super::arguments::Arguments;
use super::super::rejection::DealResults;
use super::super::{
    Argument, ArgumentKind, EffectTiming, PlannedCall, Rejection, Tool, ToolContext, ToolId, ToolKind,
    ToolModule, ToolSpec,
};
use super::parsing::{ElementError, malformed_element, parse_deal_customer, parse_elements, parse_offerings};
use super::{ElementFailure, ElementOutcome, RESULT_FIELDS, reject_if_all_failed};
use novamind_world::command::Command;
use novamind_world::customers::FIRST_CUSTOMER;
use novamind_world::enterprise::OpenThreads;
use novamind_world::enterprise::messages::OfferDraft;
use novamind_world::events::Offering;

/// The tool `send_enterprise_deal`, which sends offers to enterprises.
pub struct SendEnterpriseDeal;

const EXAMPLE: &str = r#"[[207, [["B", 31.5], ["C", 54]]]]"#;

/// An offer that the call sends to an enterprise.
pub struct Deal {
    customer: i64,
    offerings: Vec<Offering>,
    /// Path of the customer number in the arguments.
    field: String,
}

static SPEC: ToolSpec = ToolSpec {
    id: ToolId::SendEnterpriseDeal,
    code: "DEAL",
    module: ToolModule::Enterprise,
    kind: ToolKind::OneShot,
    summary: "Offer enterprises plans at a price per seat; replies in the open thread, or opens one",
    arguments: &[Argument {
        name: "deals",
        alias: None,
        kind: ArgumentKind::Deals(
            "list of [customer_id, [[plan, price_per_seat], …]] or {customer_id, offerings: [{plan, price_per_seat}, …]}",
        ),
        required: false,
        unit: "$/seat and month",
        description: "one to {enterprise.enterprise_max_offerings_per_turn:word} offerings per enterprise, of which it accepts at most one; contracts last a month and renew at the agreed price",
    }],
    has_own_unknown_code: false,
    unnamed_argument: Some("deals"),
    effect_timing: EffectTiming::CustomerReply,
    effect: "The enterprise replies at least a day later, at its own pace: it accepts the best offering, names its \
             own price, or stops replying once its turns are used up or no price \
             is acceptable. Every offer uses up a turn, and only the latest one gets a reply. Each day beyond \
             {enterprise.late_reply_free_days} on which an enterprise's message waits costs \
             {enterprise.late_reply_relationship_delta_per_day:-} of the relationship; after \
             {enterprise.agent_response_timeout_days} days without a reply the thread ends. A subscriber \
             without an open thread gets an offer of new terms: if it declines, it cancels. As in the release, a \
             thread that ended without a reply keeps acting: a lead's repeats its notice every day, a subscriber's \
             damages the reputation of its group every day. Rejecting in time prevents this.",
    cost: "nothing",
    written_tables: &["enterprise_turns"],
    rejection_codes: &[
        "deals_missing",
        "deal_malformed",
        "customer_missing",
        "offerings_missing",
        "offering_short",
        "offering_no_price",
        "offering_malformed",
        "customer_not_found",
        "not_enterprise",
        "no_subscription",
        "amount_too_large",
    ],
    result_fields: RESULT_FIELDS,
    example: r#"{"deals": [[207, [["B", 31.5], ["C", 54]]], [9, [["A", 8]]]]}"#,
};

impl Tool for SendEnterpriseDeal {
    type Args = Vec<Result<Deal, ElementFailure>>;
    type Answer = DealResults;

    fn spec(&self) -> &'static ToolSpec {
        &SPEC
    }

    fn parse_arguments(
        &self,
        view: &ToolContext<'_>,
        arguments: &Arguments,
    ) -> Result<Self::Args, Rejection> {
        let elements = parse_elements(arguments.get("deals"), EXAMPLE)?;
        let read = |(at, element): (usize, &Value)| match parse_deal(element, &format!("deals.{at}"), view) {
            Err(ElementError::Call(refusal)) => Err(refusal),
            Err(ElementError::Element(failure)) => Ok(Err(failure)),
            Ok(deal) => Ok(Ok(deal)),
        };
        elements.iter().enumerate().map(read).collect()
    }

    fn plan(&self, view: &ToolContext<'_>, given: Self::Args) -> Result<PlannedCall<DealResults>, Rejection> {
        let mut proposals = Vec::new();
        let open = view.world().enterprise.open_threads();
        let mut send = |deal: Deal| {
            let proposal = to_offer_draft(deal, view, &open)?;
            let customer = proposal.customer;
            proposals.push(proposal);
            Ok(customer)
        };
        let outcomes: Vec<ElementOutcome> =
            given.into_iter().map(|given| ElementOutcome::from_result(given.and_then(&mut send))).collect();
        let results = reject_if_all_failed(outcomes)?;
        Ok(PlannedCall::with_command(Command::SendDeals(proposals), results))
    }
}

fn parse_deal(element: &Value, path: &str, view: &ToolContext<'_>) -> Result<Deal, ElementError> {
    let (who, what) = match element {
        Value::Array(pair) if pair.len() >= 2 => (pair.first(), pair.get(1)),
        Value::Object(map) => (map.get("customer_id"), map.get("offerings")),
        _ => return Err(malformed_element(path, "write it as [customer_id, [[plan, price_per_seat], …]]")),
    };
    let most = view.params().enterprise.enterprise_max_offerings_per_turn as usize;
    let customer = parse_deal_customer(who, path)?;
    Ok(Deal {
        customer,
        offerings: parse_offerings(what, customer, most, path)?,
        field: format!("{path}.customer_id"),
    })
}

/// Converts a deal to an offer of the simulator. The customer must be an enterprise with an open thread or a
/// subscription.
fn to_offer_draft(
    deal: Deal,
    view: &ToolContext<'_>,
    open: &OpenThreads<'_>,
) -> Result<OfferDraft, ElementFailure> {
    let Deal { customer: given, offerings, field } = deal;
    let world = view.world();
    let failed = |code: &'static str, error: &str, message: String| {
        ElementFailure::new(given, error, Rejection::for_field(field.clone(), code, message))
    };
    let number = u32::try_from(given).ok();
    if let Some(customer) = number.filter(|customer| open.newest(*customer).is_some()) {
        return Ok(OfferDraft { customer, offerings });
    }
    // The table of customers also contains the market observer.
    let is_observer = number.is_some_and(|customer| customer > 0 && customer < FIRST_CUSTOMER);
    match number.and_then(|customer| world.customers.find(customer).map(|(group, _)| (customer, group))) {
        None if !is_observer => {
            let message = format!("there is no customer {given}; enterprise_turns and customers list them");
            Err(failed("customer_not_found", "not found", message))
        }
        Some((customer, group)) if group.is_enterprise() => {
            if world.enterprise.enterprise_customer(customer).is_some_and(|company| company.is_subscriber()) {
                return Ok(OfferDraft { customer, offerings });
            }
            let message = format!(
                "customer {given} has neither an open thread nor a subscription: it was lost, or never asked \
                 for an offer"
            );
            Err(failed("no_subscription", "no subscription", message))
        }
        _ => {
            let message =
                format!("customer {given} is an individual; offers can be sent only to enterprises");
            Err(failed("not_enterprise", "not enterprise", message))
        }
    }
}
