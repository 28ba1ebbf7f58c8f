//! Automatic answers to enterprises: the section `[enterprise]` of a policy
//! (docs/interfaces/policies.md#answers-to-enterprises).

use serde::Deserialize;
use serde_json::{Value, json};

use novamind_session::WaitingThread;
use novamind_tools::ToolId;
use novamind_world::events::ThreadKind;
use novamind_world::identifiers::Plan;

/// A rule that answers every waiting thread on every decision day.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnterpriseRule {
    /// One to three offers, in order.
    pub offerings: Vec<OfferRule>,
    /// Price factor, which depends on the number of the policy's turns in the thread.
    #[serde(default)]
    pub factor: PriceFactor,
    /// Number of the policy's turns in a thread after which the policy rejects the thread; `None` to never
    /// reject a thread.
    pub give_up_after: Option<u32>,
    /// Types of the threads that are answered.
    #[serde(default)]
    pub types: ThreadTypes,
}

/// An offered plan and its price before the factor.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OfferRule {
    /// Plan that is offered.
    pub plan: Plan,
    /// Price before the factor, $ per seat per month.
    pub price: f64,
}

/// A price factor that changes with the policy's turns: max(floor, start + step * turns).
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PriceFactor {
    /// Price factor of the first offer.
    pub start: f64,
    /// Change in the factor with each further offer.
    pub step: f64,
    /// Minimum price factor.
    pub floor: f64,
}

impl Default for PriceFactor {
    fn default() -> Self {
        PriceFactor { start: 1.0, step: 0.0, floor: 1.0 }
    }
}

impl PriceFactor {
    /// Returns the factor after the policy has taken `own_turns` turns.
    pub fn factor_after(&self, own_turns: u32) -> f64 {
        (self.start + self.step * f64::from(own_turns)).max(self.floor)
    }
}

/// The selected thread types: `"all"` or a list.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(untagged, expecting = "types must be \"all\" or a list of thread types")]
pub enum ThreadTypes {
    /// All thread types.
    #[default]
    #[serde(skip)]
    All,
    /// A single word: `all`, or an invalid word.
    Word(String),
    /// A list of thread types.
    List(Vec<String>),
}

impl ThreadTypes {
    fn contains(&self, kind: &str) -> bool {
        match self {
            ThreadTypes::All | ThreadTypes::Word(_) => true,
            ThreadTypes::List(list) => list.iter().any(|text| text == kind),
        }
    }
}

impl EnterpriseRule {
    /// Returns the rule if it is valid.
    ///
    /// # Errors
    /// Returns a description of the first invalid value.
    pub(super) fn validated(self) -> Result<EnterpriseRule, String> {
        if !(1..=3).contains(&self.offerings.len()) {
            return Err(format!("the number of offerings must be 1 to 3, not {}", self.offerings.len()));
        }
        let bad = |price: &f64| !price.is_finite() || *price < 0.0;
        if let Some(price) = self.offerings.iter().map(|offering| offering.price).find(bad) {
            return Err(format!("the price of an offering must be at least 0, not {price}"));
        }
        let wrong = |word: &&String| ThreadKind::parse(word).is_none();
        let known = ThreadKind::ALL.map(ThreadKind::id).join(", ");
        match &self.types {
            ThreadTypes::Word(word) if word != "all" => {
                Err(format!("types must be \"all\" or a list of {known}, not {word}"))
            }
            ThreadTypes::List(list) if list.iter().any(|word| wrong(&word)) => {
                Err(format!("types must be a list of {known}"))
            }
            _ => Ok(self),
        }
    }

    /// Returns the calls that answer the waiting threads: one call with all offers, and one call with all
    /// rejections. Omits a call that would be empty.
    pub fn answer_calls(&self, waiting: &[WaitingThread]) -> Vec<(ToolId, Value)> {
        let mut threads: Vec<&WaitingThread> =
            waiting.iter().filter(|thread| self.types.contains(thread.kind)).collect();
        threads.sort_by_key(|thread| thread.thread);
        let given_up =
            |thread: &&&WaitingThread| self.give_up_after.is_some_and(|turns| thread.offers_so_far >= turns);
        let offers: Vec<Value> =
            threads.iter().filter(|thread| !given_up(thread)).map(|thread| self.offer(thread)).collect();
        let rejections: Vec<Value> =
            threads.iter().filter(given_up).map(|thread| json!({ "customer_id": thread.customer })).collect();
        let mut calls = Vec::new();
        for (tool, deals) in
            [(ToolId::SendEnterpriseDeal, offers), (ToolId::RejectEnterpriseDeal, rejections)]
        {
            if !deals.is_empty() {
                calls.push((tool, json!({ "deals": deals })));
            }
        }
        calls
    }

    fn offer(&self, thread: &WaitingThread) -> Value {
        let factor = self.factor.factor_after(thread.offers_so_far);
        let cents = |price: f64| (price * factor * 100.0).round() / 100.0;
        let offerings: Vec<Value> = self
            .offerings
            .iter()
            .map(|offering_rule| json!([offering_rule.plan.id(), cents(offering_rule.price)]))
            .collect();
        json!([thread.customer, offerings])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_rule(text: &str) -> Result<EnterpriseRule, String> {
        toml::from_str::<EnterpriseRule>(text)
            .map_err(|error| error.message().to_owned())
            .and_then(EnterpriseRule::validated)
    }

    fn waiting_thread(number: u32, kind: &'static str, own_turns: u32) -> WaitingThread {
        WaitingThread {
            thread: number,
            customer: 100 + number,
            group: "E1",
            seats: 60,
            kind,
            turn: 2 * own_turns,
            offers_so_far: own_turns,
            last_offer: Vec::new(),
            asked: None,
            days_left: 3,
        }
    }

    const P10_TOML: &str = "offerings = [{ plan = \"C\", price = 48 }, { plan = \"A\", price = 12.0 }]\n\
                       factor = { start = 1.0, step = -0.08, floor = 0.6 }\ngive_up_after = 4\n";

    #[test]
    fn offer_prices_fall_by_turn_in_thread_order() {
        let rule = parse_rule(P10_TOML).expect("a rule");
        let waiting = [
            waiting_thread(9, "churn_prevention", 1),
            waiting_thread(3, "new_lead", 0),
            waiting_thread(5, "new_lead", 4),
            waiting_thread(7, "plan_change", 3),
        ];
        let calls = rule.answer_calls(&waiting);
        let expected = json!({"deals": [
            [103, [["C", 48.0], ["A", 12.0]]],
            [107, [["C", 36.48], ["A", 9.12]]],
            [109, [["C", 44.16], ["A", 11.04]]],
        ]});
        assert_eq!(calls[0], (ToolId::SendEnterpriseDeal, expected));
        assert_eq!(calls[1], (ToolId::RejectEnterpriseDeal, json!({"deals": [{"customer_id": 105}]})));
        assert!(rule.answer_calls(&[]).is_empty());
        assert!((rule.factor.factor_after(9) - 0.6).abs() < 1e-12);
    }

    #[test]
    fn thread_types_can_be_selected() {
        let enterprise_rule = parse_rule(&format!("{P10_TOML}types = [\"new_lead\"]\n")).expect("a rule");
        assert!(enterprise_rule.answer_calls(&[waiting_thread(1, "plan_change", 0)]).is_empty());
        assert_eq!(enterprise_rule.answer_calls(&[waiting_thread(1, "new_lead", 0)]).len(), 1);
        assert!(parse_rule(&format!("{P10_TOML}types = \"all\"\n")).is_ok());
        for wrong in ["types = \"some\"\n", "types = [\"renewed\"]\n", "types = 3\n"] {
            let problem = parse_rule(&format!("{P10_TOML}{wrong}")).expect_err(wrong);
            assert!(problem.contains("types"), "{problem}");
        }
        let plain = parse_rule("offerings = [{ plan = \"B\", price = 30 }]\n").expect("a rule");
        assert_eq!((plain.factor.factor_after(7), plain.give_up_after), (1.0, None));
        assert!(parse_rule("offerings = [{ plan = \"B\", price = -1 }]\n").is_err());
    }
}
