//! Applies rules to all waiting threads. The first matching rule answers a thread.

use serde_json::{Value, json};

use super::grammar::{Action, OfferLine, Price, Rule};
use super::plan_economics::{OfferTotals, PlanEconomics};
use super::thread::{RULE_TOOLS, ThreadContext};
use novamind_base::formatting::{dollars_and_cents, grouped_number};
use novamind_session::identifiers::Plan;
use novamind_session::{EnterpriseNames, Session};
use novamind_tools::{Rejection, ToolId};

/// The reply that a rule sends to a thread.
#[derive(Debug, Clone, PartialEq)]
pub enum RuleReply {
    /// An offer of plans with their prices.
    Offer(Vec<(Plan, f64)>),
    /// A rejection, which ends the thread.
    Rejection,
}

/// A thread with the matching rule and its reply.
#[derive(Debug, Clone, PartialEq)]
pub struct RuleOutcome {
    /// Fields of the waiting thread that rules compare.
    pub thread: ThreadContext,
    /// Index of the matching rule; `None` if no rule matches.
    pub rule_index: Option<usize>,
    /// The reply, or the reason why no reply is sent.
    pub reply: Result<RuleReply, &'static str>,
}

/// The result of applying rules to all waiting threads.
#[derive(Debug, Clone)]
pub struct RuleBatch {
    /// The applied rules, in order.
    pub rules: Vec<Rule>,
    /// All waiting threads, ordered by deadline.
    pub threads: Vec<RuleOutcome>,
    /// Totals of each rule, followed by the totals of threads without a matching rule.
    pub totals: Vec<OfferTotals>,
}

/// Applies the rules in `text` to all waiting threads and returns the tool calls that send the replies.
///
/// # Errors
/// Returns `rules_not_readable` if the rules have a syntax error, or the error of a failed database query.
pub fn calls_for_waiting_threads(
    text: &str,
    session: &mut Session,
) -> Result<Vec<(ToolId, Value)>, Rejection> {
    let rules = super::parse(text)
        .map_err(|problem| Rejection::for_field("rules", "rules_not_readable", problem.text))?;
    let (threads, market) = ThreadContext::read_all(session)?;
    Ok(RuleBatch::new(rules, threads, &market).tool_calls())
}

impl RuleBatch {
    /// Applies rules to waiting threads.
    pub fn new(rules: Vec<Rule>, threads: Vec<ThreadContext>, market: &PlanEconomics) -> RuleBatch {
        let threads: Vec<RuleOutcome> =
            threads.into_iter().map(|thread| apply_rules(&rules, thread, market)).collect();
        let mut sums = vec![OfferTotals::default(); rules.len() + 1];
        for outcome in &threads {
            add_outcome(&mut sums[outcome.rule_index.unwrap_or(rules.len())], outcome, market);
        }
        RuleBatch { rules, threads, totals: sums }
    }

    /// Returns the tool calls that send the offers and then the rejections. The list is empty if no reply is sent.
    pub fn tool_calls(&self) -> Vec<(ToolId, Value)> {
        let (mut offers, mut rejections) = (Vec::new(), Vec::new());
        for outcome in &self.threads {
            let customer = outcome.thread.waiting.customer;
            match &outcome.reply {
                Ok(RuleReply::Offer(lines)) => {
                    let lines: Vec<Value> =
                        lines.iter().map(|(plan, price)| json!([plan.id(), price])).collect();
                    offers.push(json!([customer, lines]));
                }
                Ok(RuleReply::Rejection) => rejections.push(json!({ "customer_id": customer })),
                Err(_) => {}
            }
        }
        let calls = RULE_TOOLS.into_iter().zip([offers, rejections]);
        let calls = calls.filter(|(_, deals)| !deals.is_empty());
        calls.map(|(tool, deals)| (tool, json!({ "deals": deals }))).collect()
    }

    /// Returns a line for each rule, and a line for threads without a matching rule.
    pub fn summary(&self) -> Vec<String> {
        let rule = |(at, rule): (usize, &Rule)| {
            let sums = self.totals[at].describe(rule.action == Action::Reject);
            format!("{}  {}: {sums}", at + 1, rule.text)
        };
        let mut lines: Vec<String> = self.rules.iter().enumerate().map(rule).collect();
        let others = self.totals[self.rules.len()].skipped;
        if others > 0 {
            lines.push(format!("–  no rule: {} unanswered", grouped_number(f64::from(others), 0)));
        }
        lines
    }

    /// Returns the totals by rule as JSON.
    pub fn totals_to_json(&self) -> Vec<Value> {
        let one = |(rule, sums): (&Rule, &OfferTotals)| {
            json!({
                "rule": rule.text,
                "companies": sums.thread_count,
                "seats": sums.seats,
                "monthly": rounded_json(sums.monthly_revenue, 100.0),
                "margin": sums.margin().map(|margin| rounded_json(margin, 1e4)),
                "above_quota": sums.above_quota,
                "skipped": sums.skipped,
            })
        };
        self.rules.iter().zip(&self.totals).map(one).collect()
    }
}

fn add_outcome(totals: &mut OfferTotals, outcome: &RuleOutcome, market: &PlanEconomics) {
    let waiting = &outcome.thread.waiting;
    match &outcome.reply {
        Ok(RuleReply::Offer(lines)) => {
            let line = |line: &(Plan, f64)| market.offer_line(waiting.group, waiting.seats, *line);
            totals.add_offer(&lines.iter().map(line).collect::<Vec<_>>(), waiting.seats);
        }
        Ok(RuleReply::Rejection) => totals.add_reply(waiting.seats),
        Err(_) => totals.skipped += 1,
    }
}

fn rounded_json(value: f64, steps: f64) -> f64 {
    (value * steps).round() / steps
}

impl RuleOutcome {
    /// Describes the reply, or the reason why no reply is sent.
    pub fn describe_reply(&self) -> String {
        match &self.reply {
            Ok(RuleReply::Offer(lines)) => {
                let line = |(plan, price): &(Plan, f64)| format!("{plan} {}", dollars_and_cents(*price));
                lines.iter().map(line).collect::<Vec<_>>().join(" or ")
            }
            Ok(RuleReply::Rejection) => "end the thread".to_owned(),
            Err(why) => (*why).to_owned(),
        }
    }

    /// Converts the thread, the matching rule and the reply to JSON.
    pub fn to_json(&self, names: &EnterpriseNames) -> Value {
        let mut row = json!({ "rule": self.rule_index.map(|at| at + 1), "sends": self.describe_reply() });
        if let (Value::Object(row), Value::Object(fields)) = (&mut row, self.thread.to_json(names)) {
            row.extend(fields);
        }
        row
    }
}

fn apply_rules(rules: &[Rule], thread: ThreadContext, market: &PlanEconomics) -> RuleOutcome {
    let rule = rules.iter().position(|rule| rule.matches(&thread));
    let reply = match rule.map(|at| &rules[at].action) {
        None => Err("no rule matches"),
        Some(Action::Reject) => Ok(RuleReply::Rejection),
        Some(Action::Accept) => {
            price_offer(&[OfferLine { plan: None, price: Price::Asked(1.0) }], &thread, market)
        }
        Some(Action::Offer(lines)) => price_offer(lines, &thread, market),
    };
    RuleOutcome { thread, rule_index: rule, reply }
}

/// Computes the prices of all lines of an offer. Returns the reason for skipping the thread if a line has no price.
fn price_offer(
    lines: &[OfferLine],
    thread: &ThreadContext,
    market: &PlanEconomics,
) -> Result<RuleReply, &'static str> {
    let line = |line: &OfferLine| {
        let plan = line.plan.or(thread.asked_plan).ok_or("skipped: no plan asked for")?;
        let last = || {
            thread
                .waiting
                .last_offer
                .iter()
                .find(|(offered_plan, _)| *offered_plan == plan)
                .map(|(_, price)| *price)
        };
        let price = match line.price {
            Price::Dollars(price) => price,
            Price::Asked(factor) => factor * thread.waiting.asked.ok_or("skipped: no price asked for")?,
            Price::List(factor) => factor * market.list_prices[plan as usize],
            Price::Last(factor) => {
                factor * last().ok_or("skipped: the last offer did not include that plan")?
            }
        };
        let price = (price * 100.0).round() / 100.0;
        if price > 0.0 && price.is_finite() {
            Ok((plan, price))
        } else {
            Err("skipped: the price would be 0")
        }
    };
    lines.iter().map(line).collect::<Result<_, _>>().map(RuleReply::Offer)
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::super::seat_usage::SeatUsage;
    use super::*;
    use novamind_session::WaitingThread;
    use novamind_session::identifiers::Group;

    fn thread(customer: u32, seats: u32, asked: Option<(Plan, f64)>, last: &[(Plan, f64)]) -> ThreadContext {
        let waiting = WaitingThread {
            thread: customer + 1_000,
            customer,
            group: if customer.is_multiple_of(2) { "E2" } else { "E1" },
            seats,
            kind: "new_lead",
            turn: 2 * last.len() as u32,
            offers_so_far: last.len() as u32,
            last_offer: last.to_vec(),
            asked: asked.map(|(_, price)| price),
            days_left: customer,
        };
        ThreadContext {
            waiting,
            asked_plan: asked.map(|(plan, _)| plan),
            required_quota: Some(10.0 * f64::from(seats)),
        }
    }

    fn market() -> PlanEconomics {
        PlanEconomics {
            list_prices: [14.0, 32.0, 55.0],
            quotas: [1_000.0, 1_000.0, 5_000.0],
            unit_costs: [0.001, 0.01, 0.1],
            usage: SeatUsage::default(),
            estimated_usage: ["E1", "E2"]
                .into_iter()
                .filter_map(Group::parse)
                .map(|group| (group, (1, 10.0)))
                .collect(),
        }
    }

    fn threads() -> Vec<ThreadContext> {
        vec![
            thread(1, 50, None, &[]),
            thread(2, 100, None, &[]),
            thread(3, 200, Some((Plan::B, 20.004)), &[(Plan::B, 30.0)]),
            thread(4, 300, Some((Plan::C, 10.0)), &[(Plan::C, 60.0), (Plan::B, 30.0)]),
        ]
    }

    fn described_outcomes(rules: &str) -> Vec<(Option<usize>, String)> {
        let batch = RuleBatch::new(parse(rules).expect("rules"), threads(), &market());
        batch.threads.iter().map(|outcome| (outcome.rule_index, outcome.describe_reply())).collect()
    }

    #[test]
    fn first_matching_rule_answers_a_thread() {
        let expected_answer = |rule: Option<usize>, words: &str| (rule, words.to_owned());
        assert_eq!(
            described_outcomes(
                "offer where group = E2 and asked is null: B 85; accept asked >= 18; reject rest"
            ),
            [
                expected_answer(Some(2), "end the thread"),
                expected_answer(Some(0), "B $85.00"),
                expected_answer(Some(1), "B $20.00"),
                expected_answer(Some(2), "end the thread"),
            ]
        );
        assert_eq!(
            described_outcomes("offer where asked is not null: asked_plan asked*1.1, A list*0.5"),
            [
                expected_answer(None, "no rule matches"),
                expected_answer(None, "no rule matches"),
                expected_answer(Some(0), "B $22.00 or A $7.00"),
                expected_answer(Some(0), "C $11.00 or A $7.00"),
            ]
        );
        assert_eq!(
            described_outcomes("offer where customer in (3, 1): B last_offer*0.5; accept rest"),
            [
                expected_answer(Some(0), "skipped: the last offer did not include that plan"),
                expected_answer(Some(1), "skipped: no plan asked for"),
                expected_answer(Some(0), "B $15.00"),
                expected_answer(Some(1), "C $10.00"),
            ]
        );
    }

    #[test]
    fn every_field_can_be_compared() {
        for (condition, expected_customers) in [
            ("group != e2", vec![1, 3]),
            ("type in (new_lead, plan_change)", vec![1, 2, 3, 4]),
            ("seats <= 100", vec![1, 2]),
            ("asked < 15", vec![4]),
            ("asked_plan = C", vec![4]),
            ("last_offer = 30", vec![3, 4]),
            ("offers_so_far = 0", vec![1, 2]),
            ("turn > 2", vec![4]),
            ("days_left >= 3 and asked_plan != C", vec![3]),
            ("needed_quota > 1_000", vec![3, 4]),
            ("customer in (2, 4) and asked is null", vec![2]),
        ] {
            let rules = parse(&format!("reject where {condition}")).expect(condition);
            let batch = RuleBatch::new(rules, threads(), &market());
            let outcome = batch.threads.iter().filter(|outcome| outcome.rule_index.is_some());
            let found: Vec<u32> = outcome.map(|outcome| outcome.thread.waiting.customer).collect();
            assert_eq!(found, expected_customers, "{condition}");
        }
    }

    #[test]
    fn totals_count_threads_seats_revenue_and_quotas() {
        let rules = parse("accept asked > 0; offer rest: B 10, A 5").expect("rules");
        let batch = RuleBatch::new(rules, threads(), &market());
        let accepted = batch.totals[0];
        assert_eq!((accepted.thread_count, accepted.seats, accepted.above_quota), (2, 500, 1));
        assert_eq!(accepted.monthly_revenue, 200.0 * 20.0 + 300.0 * 10.0);
        // Plan B has a quota of 1,000 units, plan C a quota of 3,000 units.
        let compute = 1_000.0 * 30.0 * 0.01 + 3_000.0 * 30.0 * 0.1;
        assert_eq!(accepted.margin(), Some(1.0 - compute / accepted.monthly_revenue));
        assert_eq!(batch.totals[1].monthly_revenue, 10.0 * 150.0);
        assert_eq!(batch.totals[2], OfferTotals::default());
        let calls = batch.tool_calls();
        assert_eq!(calls.len(), 1);
        assert_eq!(
            calls[0].1,
            json!({ "deals": [
                [1, [["B", 10.0], ["A", 5.0]]], [2, [["B", 10.0], ["A", 5.0]]], [3, [["B", 20.0]]], [4, [["C", 10.0]]],
            ]})
        );
        let lines = batch.summary();
        assert!(
            lines[0].starts_with("1  accept asked > 0: 2 enterprises, 500 seats, at most $7,000 a month"),
            "{lines:?}"
        );
    }
}
