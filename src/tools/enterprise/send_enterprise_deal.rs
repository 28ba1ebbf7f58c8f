use serde_json::Value;

use super::super::arguments::Arguments;
use super::super::refusal::DealResults;
use super::super::{Argument, ArgumentKind, Kind, Module, Planned, Refusal, Spec, Tool, ToolId, View, When};
use super::reading::{Unreadable, customer, elements, malformed, offerings};
use super::{Failure, Fate, RESULTS, unless_all_failed};
use novamind_world::command::Command;
use novamind_world::customers::FIRST_CUSTOMER;
use novamind_world::enterprise::OpenThreads;
use novamind_world::enterprise::letters::Proposal;
use novamind_world::events::Offering;

/// The tool `send_enterprise_deal`.
pub struct SendEnterpriseDeal;

const EXAMPLE: &str = r#"[[207, [["B", 31.5], ["C", 54]]]]"#;

/// An offer to an enterprise.
pub struct Deal {
    customer: i64,
    offerings: Vec<Offering>,
    /// Path of the customer number.
    field: String,
}

static SPEC: Spec = Spec {
    id: ToolId::SendEnterpriseDeal,
    code: "DEAL",
    module: Module::Enterprise,
    kind: Kind::OneShot,
    summary: "Offer enterprises plans at a price per seat; replies in the open thread, or opens one",
    arguments: &[Argument {
        name: "deals",
        alias: None,
        kind: ArgumentKind::Deals(
            "list of [customer_id, [[plan, price_per_seat], …]] or {customer_id, offerings: [{plan, price_per_seat}, …]}",
        ),
        required: false,
        unit: "$/seat and month",
        doc: "one to {enterprise.enterprise_max_offerings_per_turn:word} offerings per enterprise, of which it accepts at most one; contracts last a month and renew at the agreed price",
    }],
    own_unknown: false,
    whole: Some("deals"),
    when: When::CustomerReply,
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
    writes: &["enterprise_turns"],
    refusals: &[
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
    returns: RESULTS,
    example: r#"{"deals": [[207, [["B", 31.5], ["C", 54]]], [9, [["A", 8]]]]}"#,
};

impl Tool for SendEnterpriseDeal {
    type Args = Vec<Result<Deal, Failure>>;
    type Answer = DealResults;

    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn read(&self, view: &View<'_>, arguments: &Arguments) -> Result<Self::Args, Refusal> {
        let elements = elements(arguments.get("deals"), EXAMPLE)?;
        let read = |(at, element): (usize, &Value)| match deal(element, &format!("deals.{at}"), view) {
            Err(Unreadable::Call(refusal)) => Err(refusal),
            Err(Unreadable::Element(failure)) => Ok(Err(failure)),
            Ok(deal) => Ok(Ok(deal)),
        };
        elements.iter().enumerate().map(read).collect()
    }

    fn plan(&self, view: &View<'_>, given: Self::Args) -> Result<Planned<DealResults>, Refusal> {
        let mut proposals = Vec::new();
        let open = view.world().enterprise.open_threads();
        let mut send = |deal: Deal| {
            let proposal = reachable(deal, view, &open)?;
            let customer = proposal.customer;
            proposals.push(proposal);
            Ok(customer)
        };
        let fates: Vec<Fate> = given.into_iter().map(|given| Fate::of(given.and_then(&mut send))).collect();
        let results = unless_all_failed(fates)?;
        Ok(Planned::doing(Command::SendDeals(proposals), results))
    }
}

fn deal(element: &Value, path: &str, view: &View<'_>) -> Result<Deal, Unreadable> {
    let (who, what) = match element {
        Value::Array(pair) if pair.len() >= 2 => (pair.first(), pair.get(1)),
        Value::Object(map) => (map.get("customer_id"), map.get("offerings")),
        _ => return Err(malformed(path, "write it as [customer_id, [[plan, price_per_seat], …]]")),
    };
    let most = view.params().enterprise.enterprise_max_offerings_per_turn as usize;
    let customer = customer(who, path)?;
    Ok(Deal {
        customer,
        offerings: offerings(what, customer, most, path)?,
        field: format!("{path}.customer_id"),
    })
}

/// Returns the proposal if the customer is an enterprise with an open thread or a subscription.
fn reachable(deal: Deal, view: &View<'_>, open: &OpenThreads<'_>) -> Result<Proposal, Failure> {
    let Deal { customer: given, offerings, field } = deal;
    let world = view.world();
    let failed = |code: &'static str, error: &str, message: String| {
        Failure::of(given, error, Refusal::at(field.clone(), code, message))
    };
    let number = u32::try_from(given).ok();
    if let Some(customer) = number.filter(|customer| open.newest(*customer).is_some()) {
        return Ok(Proposal { customer, offerings });
    }
    // The market observer is in the table of customers, too.
    let observer = number.is_some_and(|customer| customer > 0 && customer < FIRST_CUSTOMER);
    match number.and_then(|customer| world.customers.find(customer).map(|(group, _)| (customer, group))) {
        None if !observer => {
            let message = format!("there is no customer {given}; enterprise_turns and customers list them");
            Err(failed("customer_not_found", "not found", message))
        }
        Some((customer, group)) if group.is_enterprise() => {
            if world.enterprise.company(customer).is_some_and(|company| company.is_subscriber()) {
                return Ok(Proposal { customer, offerings });
            }
            let message = format!(
                "customer {given} has neither an open thread nor a subscription: it was lost, or never asked \
                 for an offer"
            );
            Err(failed("no_subscription", "no subscription", message))
        }
        _ => {
            let message = format!("customer {given} is an individual; offers go to companies only");
            Err(failed("not_enterprise", "not enterprise", message))
        }
    }
}
