//! Tests of every rejection and result of the tools, with a new company.

mod engine;
mod market;

use novamind_world::command::ResolvedCommand;
use serde_json::{Value, json};

use super::{Arguments, Rejection, ToolContext, find};
use novamind_world::events::Facts;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::Streams;
use novamind_world::state::World;

struct TestCompany {
    params: Params,
    streams: Streams,
    world: World,
}

impl TestCompany {
    fn new() -> TestCompany {
        let params = Params::bundled();
        let world = World::new(500, 1_000_000.0, &params, &mut Facts::default());
        TestCompany { params, streams: Streams::new(42), world }
    }

    fn try_call(&mut self, name: &str, arguments: Value) -> Result<Value, Rejection> {
        let tool = find(name).expect("the tool exists");
        let view = ToolContext::new(&self.world, &self.params);
        let arguments =
            Arguments::parse(tool.spec(), &arguments, || super::ParameterNumbers::bundled().into())?;
        let planned = tool.plan(&view, &arguments)?;
        super::limits::check_arguments(tool.spec(), &arguments)?;
        let resolved = self.world.resolve(planned.command, &self.params, &self.streams);
        let data = planned.reply.into_answer_without_script(&resolved).expect("no statements").to_json();
        if !resolved.is_read_only() {
            self.world.apply(resolved, &self.params, &mut Facts::default());
        }
        Ok(data)
    }

    fn call(&mut self, name: &str, arguments: Value) -> Value {
        self.try_call(name, arguments.clone())
            .unwrap_or_else(|rejection| panic!("{name} {arguments}: {rejection}"))
    }

    /// Returns the code and field of an expected rejection. Checks that the call has changed nothing.
    fn expect_rejection(&mut self, name: &str, arguments: Value) -> (&'static str, Option<String>) {
        let before = self.world.part_hashes();
        let rejection =
            self.try_call(name, arguments.clone()).expect_err(&format!("{name} {arguments} is invalid"));
        assert_eq!(self.world.part_hashes(), before, "{name} {arguments} changed something");
        assert!(!rejection.message.is_empty());
        (rejection.code, rejection.field)
    }

    /// Returns the results of all deals in a call that is expected to be rejected.
    fn rejected_results(&mut self, name: &str, arguments: Value) -> Value {
        let rejection = self.try_call(name, arguments).expect_err("a rejection");
        serde_json::to_value(rejection.results).expect("results are JSON")
    }

    fn assert_rejections(&mut self, name: &str, cases: &[(Value, &str, &str)]) {
        for (arguments, code, field) in cases {
            let (own_code, own_field) = self.expect_rejection(name, arguments.clone());
            assert_eq!((own_code, own_field.as_deref().unwrap_or("")), (*code, *field), "{name} {arguments}");
        }
        let spec = find(name).expect("the tool exists").spec();
        let general = ["wrong_type", "argument_missing", "unknown_argument"];
        for code in spec.rejection_codes {
            assert!(cases.iter().any(|(_, tested, _)| tested == code), "{name}: {code} is not tested");
        }
        for (_, code, _) in cases {
            assert!(
                spec.rejection_codes.contains(code) || general.contains(code),
                "{name}: {code} is not documented"
            );
        }
    }
}

#[test]
fn set_prices_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_prices",
        &[
            (json!({}), "nothing_given", ""),
            (json!({"A": null}), "nothing_given", ""),
            (json!({"D": 5}), "unknown_plan", "D"),
            (json!({"A": 5, "a": 5}), "unknown_plan", "a"),
            (json!({"A": 0}), "price_not_positive", "A"),
            (json!({"A": 1, "B": -3}), "price_not_positive", "B"),
            (json!({"A": "12"}), "wrong_type", "A"),
            (json!({"A": true}), "wrong_type", "A"),
            (json!([1]), "wrong_type", ""),
            (json!({"A": 5, "B": 1e308}), "amount_too_large", "B"),
        ],
    );
    company.call("set_prices", json!({"A": 12, "B": 25, "C": 55}));
    let data = company.call("pricing.set_prices", json!({"A": 14, "C": 60}));
    assert_eq!(data, json!({"updated": {"A": 14, "C": 60}, "current": {"A": 14, "B": 25.0, "C": 60}}));
}

#[test]
fn set_model_tiers_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_model_tiers",
        &[
            (json!({}), "nothing_given", ""),
            (json!({"X": 1}), "unknown_plan", "X"),
            (json!({"A": 0}), "tier_out_of_range", "A"),
            (json!({"A": 6}), "tier_out_of_range", "A"),
            (json!({"A": 2.5}), "tier_out_of_range", "A"),
            (json!({"A": "2"}), "tier_out_of_range", "A"),
        ],
    );
    let data = company.call("set_model_tiers", json!({"B": 3.0, "C": 4}));
    assert_eq!(data, json!({"updated": {"B": 3, "C": 4}, "current": {"A": 1, "B": 3, "C": 4}}));
}

#[test]
fn set_usage_quotas_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_usage_quotas",
        &[
            (json!({"C": 5}), "quota_missing", "A"),
            (json!({"A": 5, "B": 5, "C": null}), "quota_missing", "C"),
            (json!({"A": 5, "B": -1, "C": 5}), "quota_negative", "B"),
            (json!({"A": 5, "B": "many", "C": 5}), "wrong_type", "B"),
            (json!({"A": 5, "B": 1e15, "C": 1.1e15}), "amount_too_large", "C"),
            (json!({"A": 5, "B": 1e300, "C": 5}), "amount_too_large", "B"),
            (json!({"A": 5, "B": 5, "C": 5, "D": 5}), "unknown_argument", "D"),
        ],
    );
    let data = company.call("set_usage_quotas", json!({"A": 50000, "B": 200000, "C": 900000}));
    assert_eq!(data, json!({"quotas": {"A": 50000, "B": 200000, "C": 900000}}));
    let data = company.call("set_usage_quotas", json!({"A": 59.5, "B": 200000.0, "C": 0}));
    assert_eq!(data, json!({"quotas": {"A": 59.5, "B": 200000.0, "C": 0}}));
    assert_eq!(
        company.world.settings.core.quotas.0.map(novamind_world::quota::Quota::units),
        [59.5, 2e5, 0.0]
    );
}

#[test]
fn set_promotion_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_promotion",
        &[
            (json!({"global_promotion": -1}), "global_promotion_negative", "global_promotion"),
            (json!({"global_promotion": "5"}), "global_promotion_negative", "global_promotion"),
            (json!({"by_group": 5}), "not_a_map", "by_group"),
            (json!({"by_group": {"D_S01": 5}}), "unknown_group", "by_group.D_S01"),
            (json!({"by_group": {"S1": -5}}), "promotion_negative", "by_group.S1"),
            (json!({"by_group": {"S1": -5, "S9": 5}}), "unknown_group", "by_group.S9"),
            (json!({"by_customer": {"7": -5, "x": 5}}), "promotion_negative", "by_customer.7"),
            (json!({"by_group_plan": {"S1": {"D": 4}, "S9": {}}}), "unknown_group", "by_group_plan.S9"),
            (json!({"by_customer": {"x": 5}}), "customer_not_integer", "by_customer.x"),
            (json!({"by_customer": {"7": null}}), "promotion_negative", "by_customer.7"),
            (json!({"by_group_plan": {"S1": 4}}), "not_a_map", "by_group_plan.S1"),
            (json!({"by_group_plan": {"S1": {"D": 4}}}), "unknown_plan", "by_group_plan.S1.D"),
            (json!({"by_channel": {}}), "unknown_argument", "by_channel"),
            (json!({"global_promotion": 1.1e9}), "amount_too_large", "global_promotion"),
            (json!({"by_group_plan": {"S1": {"A": 1e300}}}), "amount_too_large", "by_group_plan.S1.A"),
        ],
    );
    // An empty map clears only its scope.
    let all = json!({
        "global_promotion": 5,
        "by_group": {"S1": 2},
        "by_customer": {"7": 1.5},
        "by_group_plan": {"S1": {"A": 3}},
    });
    company.call("set_promotion", all);
    let data = company.call("set_promotion", json!({"by_group": {}}));
    let expected = json!({"global": 5.0, "by_group": {}, "by_customer": {"7": 1.5}, "by_group_plan": {"S1": {"A": 3.0}}});
    assert_eq!(data, expected);
}

#[test]
fn set_daily_spend_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_daily_spend",
        &[
            (json!({}), "nothing_given", ""),
            (json!({"sales": 5}), "unknown_category", "sales"),
            (json!({"sales": 5, "advertising": 5}), "advertising_not_here", "advertising"),
            (json!({"operations": -1}), "spend_negative", "operations"),
            (json!({"development": "1"}), "wrong_type", "development"),
            (json!({"operations": 5, "development": 1e308}), "amount_too_large", "development"),
        ],
    );
    company.call("set_daily_spend", json!({"development": 200}));
    let data = company.call("set_daily_spend", json!({"operations": 350}));
    assert_eq!(
        data,
        json!({"updated": {"operations": 350}, "current": {"operations": 350, "development": 200.0}})
    );
}

#[test]
fn set_targeted_ad_spend_validates_and_transposes() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_targeted_ad_spend",
        &[
            (json!({}), "argument_missing", "targeted_spend"),
            (json!({"targeted_spend": 5}), "not_a_map", "targeted_spend"),
            (json!({"targeted_spend": {"foo": {"S1": 5}}}), "unknown_channel", "targeted_spend.foo"),
            (
                json!({"targeted_spend": {"E1": {"linkedin": 200}, "search_ads": {"S1": 10}}}),
                "nesting_inverted",
                "targeted_spend.S1",
            ),
            (json!({"targeted_spend": {"linkedin": 5}}), "not_a_map", "targeted_spend.linkedin"),
            (
                json!({"targeted_spend": {"linkedin": {"D_S01": 5}}}),
                "unknown_group",
                "targeted_spend.linkedin.D_S01",
            ),
            (
                json!({"targeted_spend": {"linkedin": {"E9": 5}}}),
                "unknown_group",
                "targeted_spend.linkedin.E9",
            ),
            (
                json!({"targeted_spend": {"linkedin": {"E1": -5}}}),
                "amount_invalid",
                "targeted_spend.linkedin.E1",
            ),
            (json!({"targeted_spend": {}, "more": 1}), "unknown_argument", "more"),
            (json!({"linkedin": {"E1": 1e308}}), "amount_too_large", "targeted_spend.linkedin.E1"),
        ],
    );
    // A matrix by groups is transposed; a group without channels is dropped.
    let turned =
        json!({"targeted_spend": {"E1": {"linkedin": 200, "search_ads": 50}, "S1": {"linkedin": 20}}});
    let data = company.call("set_targeted_ad_spend", turned);
    let upright = json!({"linkedin": {"E1": 200, "S1": 20}, "search_ads": {"E1": 50}});
    assert_eq!(data, json!({"targeted_spend": upright, "total_per_day": 270}));
    let vanished = company.call("set_targeted_ad_spend", json!({"targeted_spend": {"E1": 5}}));
    assert_eq!(vanished, json!({"targeted_spend": {}, "total_per_day": 0}));
    let whole = company.call("set_targeted_ad_spend", json!({"search_ads": {"S1": 80, "S3": 40}}));
    assert_eq!(whole["total_per_day"], 120);
}

#[test]
fn set_ads_strength_applies_nothing_after_an_error() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_ads_strength",
        &[
            (json!({"global_strength": 1.1}), "global_strength_out_of_range", "global_strength"),
            (json!({"global_strength": "x"}), "global_strength_out_of_range", "global_strength"),
            (json!({"by_group": [1]}), "not_a_map", "by_group"),
            (json!({"by_group": {"Q": 0.1}}), "unknown_group", "by_group.Q"),
            (json!({"by_group": {"S1": 2}}), "strength_out_of_range", "by_group.S1"),
            (json!({"by_customer": {"5.5": 0.1}}), "customer_not_integer", "by_customer.5.5"),
        ],
    );
    // Nothing is applied if a later scope is invalid.
    let wrong = json!({"global_strength": 0.4, "by_group": {"S2": 0.1}, "by_customer": {"5": 3}});
    assert_eq!(company.expect_rejection("set_ads_strength", wrong).0, "strength_out_of_range");
    let data =
        company.call("set_ads_strength", json!({"global_strength": 0.05, "by_customer": {" 42 ": 0.5}}));
    assert_eq!(data, json!({"global": 0.05, "by_group": {}, "by_customer": {"42": 0.5}}));
}

#[test]
fn set_lead_promotion_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_lead_promotion",
        &[
            (json!({"global_promotion": -1}), "global_promotion_negative", "global_promotion"),
            (json!({"by_group": "S1"}), "not_a_map", "by_group"),
            (json!({"by_group": {"D_E01": 1}}), "unknown_group", "by_group.D_E01"),
            (json!({"by_channel": {"tv": 1}}), "unknown_channel", "by_channel.tv"),
            (json!({"by_channel": {"linkedin": -1}}), "promotion_negative", "by_channel.linkedin"),
            (json!({"by_channel_group": {"tv": {"S1": 1}}}), "unknown_channel", "by_channel_group.tv"),
            (json!({"by_channel_group": {"linkedin": 4}}), "not_a_map", "by_channel_group.linkedin"),
            (json!({"by_channel": {"linkedin": 2e9}}), "amount_too_large", "by_channel.linkedin"),
        ],
    );
    let data = company.call("set_lead_promotion", json!({"by_channel": {"social_media": 3}}));
    let expected =
        json!({"global": 0.0, "by_group": {}, "by_channel": {"social_media": 3.0}, "by_channel_group": {}});
    assert_eq!(data, expected);
}

#[test]
fn set_targeted_ops_spend_keeps_other_scopes() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_targeted_ops_spend",
        &[
            (json!({"by_group": {}, "targeted_spend": {}}), "both_aliases", "targeted_spend"),
            (json!({"by_plan": 4}), "not_a_map", "by_plan"),
            (json!({"by_group": {"E9": 4}}), "unknown_group", "by_group.E9"),
            (json!({"by_plan": {"D": 4}}), "unknown_plan", "by_plan.D"),
            (json!({"by_group_plan": {"S1": {"A": -4}}}), "amount_invalid", "by_group_plan.S1.A"),
            (json!({"by_customer": {"x": 4}}), "customer_not_integer", "by_customer.x"),
            // If a later scope is invalid, the first scope does not change, as the sums below show.
            (json!({"by_group": {"S2": 9}, "by_plan": {"D": 1}}), "unknown_plan", "by_plan.D"),
            (json!({"by_customer": {"7": 1e10}}), "amount_too_large", "by_customer.7"),
            (json!({"targeted_spend": {"S1": 1e10}}), "amount_too_large", "targeted_spend.S1"),
        ],
    );
    // Each scope has a separate budget, which stays in force until a call sets it again.
    company.call("set_targeted_ops_spend", json!({"E1": 30, "S1": 20}));
    company.call("set_targeted_ops_spend", json!({"by_plan": {"A": 10}}));
    company.call("set_targeted_ops_spend", json!({"by_group_plan": {"S1": {"A": 5}}}));
    let data = company.call("set_targeted_ops_spend", json!({"by_customer": {"42": 7}}));
    assert_eq!(data["total_extra_per_day"], 72.0);
    assert_eq!(data["targeted_spend"], json!({"E1": 30.0, "S1": 20.0}));
    assert_eq!(company.call("set_targeted_ops_spend", json!({}))["total_extra_per_day"], 72.0);
}

#[test]
fn set_targeted_dev_spend_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_targeted_dev_spend",
        &[
            (json!({}), "argument_missing", "targeted_spend"),
            (json!({"targeted_spend": 3}), "not_a_map", "targeted_spend"),
            (json!({"targeted_spend": {"D_S02": 3}}), "unknown_group", "targeted_spend.D_S02"),
            (json!({"targeted_spend": {"S1": "3"}}), "amount_invalid", "targeted_spend.S1"),
            (json!({"S1": 1e308}), "amount_too_large", "targeted_spend.S1"),
        ],
    );
    let data = company.call("set_targeted_dev_spend", json!({"S1": 2500, "E3": 400}));
    assert_eq!(data, json!({"targeted_spend": {"S1": 2500, "E3": 400}, "total_extra_per_day": 2900}));
    assert_eq!(
        company.call("set_targeted_dev_spend", json!({"targeted_spend": {}}))["total_extra_per_day"],
        0
    );
}

#[test]
fn start_research_project_charges_the_price_once() {
    let mut company = TestCompany::new();
    company.call("start_research_project", json!({"tier": 1}));
    company.assert_rejections(
        "start_research_project",
        &[
            (json!({}), "argument_missing", "tier"),
            (json!({"tier": 0}), "rd_tier_unknown", "tier"),
            (json!({"tier": 21}), "rd_tier_unknown", "tier"),
            (json!({"tier": "1"}), "rd_tier_unknown", "tier"),
            (json!({"tier": 1}), "rd_in_progress", "tier"),
            (json!({"tier": 20}), "insufficient_funds", ""),
        ],
    );
    // The price was paid immediately, and the rejected calls cost nothing.
    assert_eq!(company.world.finance.cash, 833_333.0);
    let project = company.world.product.research[0];
    assert!(project.due_day >= 30);
    let tiers = company.call("list_research_projects", json!({}));
    assert_eq!(tiers["tiers"].as_array().map(Vec::len), Some(20));
    assert_eq!((&tiers["tiers"][0]["in_progress"], &tiers["tiers"][0]["completed"]), (&json!(1), &json!(0)));
}

#[test]
fn rejections_of_large_amounts_name_the_limit() {
    let mut company = TestCompany::new();
    for (tool, arguments, message) in [
        ("set_prices", json!({"B": 1.1e9}), "B is too large: at most $1,000,000,000/month"),
        (
            "set_daily_spend",
            json!({"operations": 1e10}),
            "operations is too large: at most $1,000,000,000/day",
        ),
        (
            "set_usage_quotas",
            json!({"A": 1e16, "B": 1, "C": 1}),
            "A is too large: at most 1,000,000,000,000,000 units/day",
        ),
    ] {
        let rejection = company.try_call(tool, arguments).expect_err("too large");
        assert_eq!(rejection.message, message);
        let manual = super::describe::format_manual(
            find(tool).expect("a tool").spec(),
            &super::ParameterNumbers::bundled(),
        );
        assert!(manual.contains(", at most 1,000,000,000"));
    }
    company.call("set_prices", json!({"B": 1e9}));
}

#[test]
fn rejections_round_dollars_as_displayed() {
    let mut company = TestCompany::new();
    company.world.finance.cash = 166_666.99;
    let rejection =
        company.try_call("start_research_project", json!({"tier": 1})).expect_err("too expensive");
    assert_eq!(rejection.message, "costs $166,667, cash is $166,667");
    company.world.finance.cash = 166_667.0;
    company.call("start_research_project", json!({"tier": 1}));
    assert_eq!(company.world.finance.cash, 0.0);
}

#[test]
fn set_capacity_tier_validates_and_updates() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "set_capacity_tier",
        &[
            (json!({}), "argument_missing", "tier"),
            (json!({"tier": 8}), "capacity_out_of_range", "tier"),
            (json!({"tier": -1}), "capacity_out_of_range", "tier"),
            (json!({"tier": 1.5}), "capacity_out_of_range", "tier"),
        ],
    );
    let data = company.call("set_capacity_tier", json!({"capacity_tier": 2}));
    assert_eq!(data, json!({"tier": 2, "capacity_units": 800000, "cost_per_day": 530}));
    for tier in 0..=7 {
        assert_eq!(company.call("set_capacity_tier", json!({ "tier": tier }))["tier"], tier);
    }
}

/// Returns a company with two leads (customers 2 and 3), a subscriber (4), an individual (5), and a lost lead (6).
fn company_with_enterprises() -> TestCompany {
    use novamind_world::enterprise::EnterpriseStatus;
    use novamind_world::test_kit::plain_enterprise;
    use novamind_world::test_kit::subscriber;
    let mut company = TestCompany::new();
    let (e1, s1) = (Group::parse("E1").expect("a group"), Group::parse("S1").expect("a group"));
    let world = &mut company.world;
    let mut facts = Facts::default();
    world.customers.record_arrival(0, e1, 3);
    world.customers.record_arrival(0, s1, 1);
    world.customers.record_arrival(0, e1, 1);
    let row =
        |customer: u32, n| novamind_world::customers::columns::Subscriber { customer, n, ..subscriber(n) };
    for (customer, n) in [(2, 1), (3, 2)] {
        let lead = plain_enterprise(e1, n, customer, EnterpriseStatus::Lead(row(customer, n)));
        world.enterprise.open_lead_thread(0, lead, &mut facts);
    }
    world.customers.groups[e1].activate(row(4, 3));
    world.enterprise.companies.push(plain_enterprise(e1, 3, 4, EnterpriseStatus::Subscriber));
    company
}

#[test]
fn send_enterprise_deal_rejects_invalid_deals() {
    let mut company = company_with_enterprises();
    let deal = |deals: Value| json!({ "deals": deals });
    company.assert_rejections(
        "send_enterprise_deal",
        &[
            (json!({}), "deals_missing", "deals"),
            (deal(json!([])), "deals_missing", "deals"),
            (deal(json!("")), "deals_missing", "deals"),
            (deal(json!([5])), "deal_malformed", "deals.0"),
            (deal(json!("2: B 30")), "deal_malformed", "deals.0"),
            (deal(json!([[2]])), "deal_malformed", "deals.0"),
            (deal(json!([[null, [["B", 5]]]])), "customer_missing", "deals.0.customer_id"),
            (deal(json!({"offerings": [["B", 5]]})), "customer_missing", "deals.0.customer_id"),
            (deal(json!([[2, []]])), "offerings_missing", "deals.0.offerings"),
            (deal(json!([[2, "B 30"]])), "offerings_missing", "deals.0.offerings"),
            (deal(json!([{"customer_id": 2}])), "offerings_missing", "deals.0.offerings"),
            (deal(json!([[2, [["B", 5], ["B"]]]])), "offering_short", "deals.0.offerings.1"),
            (deal(json!([[2, [{"plan": "B"}]]])), "offering_no_price", "deals.0.offerings.0"),
            (deal(json!([[2, ["B"]]])), "offering_malformed", "deals.0.offerings.0"),
            (deal(json!([[2, [["D", 5]]]])), "offering_malformed", "deals.0.offerings.0"),
            (deal(json!([[2, [["B", -1]]]])), "offering_malformed", "deals.0.offerings.0"),
            (deal(json!([[2, [[4, 5]]]])), "offering_malformed", "deals.0.offerings.0"),
            (deal(json!([[99, [["B", 5]]]])), "customer_not_found", "deals.0.customer_id"),
            (deal(json!([[-3, [["B", 5]]]])), "customer_not_found", "deals.0.customer_id"),
            (deal(json!([[5, [["B", 5]]]])), "not_enterprise", "deals.0.customer_id"),
            (deal(json!([[1, [["B", 5]]]])), "not_enterprise", "deals.0.customer_id"),
            (deal(json!([[6, [["B", 5]]]])), "no_subscription", "deals.0.customer_id"),
            // Invalid numbers reject the whole call.
            (
                deal(json!([[2, [["B", 5]]], [3, [["B", "abc"]]]])),
                "wrong_type",
                "deals.1.offerings.0.price_per_seat",
            ),
            (deal(json!([[2.5, [["B", 5]]]])), "wrong_type", "deals.0.customer_id"),
            (deal(json!([["two", [["B", 5]]]])), "wrong_type", "deals.0.customer_id"),
            (deal(json!([[true, [["B", 5]]]])), "wrong_type", "deals.0.customer_id"),
            (deal(json!([[2, [["B", "inf"]]]])), "wrong_type", "deals.0.offerings.0.price_per_seat"),
            // If all deals fail, the first deal determines the rejection.
            (deal(json!([[99, [["B", 5]]], [2, []]])), "customer_not_found", "deals.0.customer_id"),
            (deal(json!([[4_000_000_000u64, [["B", 5]]]])), "customer_not_found", "deals.0.customer_id"),
            (deal(json!([[2, [["B", 5], ["C", 1e308]]]])), "amount_too_large", "deals.0.1.1.1"),
            (
                deal(json!({"customer_id": 2, "offerings": [{"plan": "B", "price": "1e10"}]})),
                "amount_too_large",
                "deals.offerings.0.price",
            ),
        ],
    );
}

#[test]
fn fully_rejected_deals_report_each_reason() {
    let mut company = company_with_enterprises();
    let deals = json!({"deals": [[99, [["B", 5]]], [2, []], [5, [["B", 5]]], [6, [["B", 5]]]]});
    let value = json!([
        {"customer_id": 2, "error": "offerings required"},
        {"customer_id": 99, "error": "not found"},
        {"customer_id": 5, "error": "not enterprise"},
        {"customer_id": 6, "error": "no subscription"},
    ]);
    assert_eq!(company.rejected_results("send_enterprise_deal", deals), value);
    let deals = json!({"deals": [77, "x"]});
    let reasons = json!([{"error": "invalid format"}, {"customer_id": 77, "error": "no active thread"}]);
    assert_eq!(company.rejected_results("reject_enterprise_deal", deals), reasons);
    // A rejection of the whole call has no results.
    let none = json!({"deals": []});
    assert_eq!(company.rejected_results("send_enterprise_deal", none), json!([]));
}

/// Returns the offerings of the latest turn of a customer's open thread.
fn latest_offer(company: &TestCompany, customer: u32) -> Vec<(&'static str, f64)> {
    let thread = company.world.enterprise.open_threads().newest(customer).expect("an open thread");
    thread.last_offerings().iter().map(|offering| (offering.plan.id(), offering.price)).collect()
}

#[test]
fn send_enterprise_deal_accepts_all_notations() {
    for deals in [
        json!([[2, [["B", 31.5]]]]),
        json!([["2", [["B", "31.5", 12]]]]),
        json!([{"customer_id": 2.0, "offerings": [{"plan": "B", "price_per_seat": 31.5}]}]),
        json!({"customer_id": 2, "offerings": [{"plan": "B", "price": 31.5, "price_per_seat": 7}]}),
        json!([[2, [{"price": 31.5}], "more"]]),
    ] {
        let mut company = company_with_enterprises();
        let data = company.call("send_enterprise_deal", json!({ "deals": deals }));
        assert_eq!(data, json!({"results": [{"customer_id": 2, "success": true}]}), "{deals}");
        assert_eq!(latest_offer(&company, 2), [("B", 31.5)], "{deals}");
    }
    let mut company = company_with_enterprises();
    let whole = json!({"customer_id": 2, "offerings": [["C", 0]]});
    company.call("enterprise.send_enterprise_deal", whole);
    assert_eq!(latest_offer(&company, 2), [("C", 0.0)]);
}

#[test]
fn invalid_deal_does_not_block_the_others() {
    let mut company = company_with_enterprises();
    let four = json!([[2, [["A", 1], ["B", 2], ["C", 3], ["A", 4]]]]);
    company.call("send_enterprise_deal", json!({ "deals": four }));
    assert_eq!(latest_offer(&company, 2), [("A", 1.0), ("B", 2.0), ("C", 3.0)]);
    let mixed = json!([[999_999, [["B", 5]]], [3, [["B", "7.5"]]], [4, []], 8]);
    let data = company.call("send_enterprise_deal", json!({ "deals": mixed }));
    let expected = json!({"results": [
        {"customer_id": 4, "error": "offerings required"},
        {"error": "invalid format"},
        {"customer_id": 999_999, "error": "not found"},
        {"customer_id": 3, "success": true},
    ]});
    assert_eq!(data, expected);
    assert_eq!(latest_offer(&company, 3), [("B", 7.5)]);
    let data = company.call("send_enterprise_deal", json!({"deals": [[4, [["B", 9]]]]}));
    assert_eq!(data["results"][0]["success"], true);
    let thread = company.world.enterprise.open_threads().newest(4).expect("a renegotiation");
    assert_eq!((thread.kind.id(), thread.last().number), ("renegotiation", 0));
}

#[test]
fn reject_enterprise_deal_ends_threads() {
    let mut company = company_with_enterprises();
    let deal = |deals: Value| json!({ "deals": deals });
    company.assert_rejections(
        "reject_enterprise_deal",
        &[
            (json!({}), "deals_missing", "deals"),
            (deal(json!([])), "deals_missing", "deals"),
            (deal(json!([[2, 3]])), "deal_malformed", "deals.0"),
            (deal(json!([true])), "deal_malformed", "deals.0"),
            (deal(json!([{"customer": 2}])), "customer_missing", "deals.0.customer_id"),
            (deal(json!([[null]])), "customer_missing", "deals.0.customer_id"),
            (deal(json!([4])), "no_active_thread", "deals.0.customer_id"),
            (deal(json!([77])), "no_active_thread", "deals.0.customer_id"),
            (deal(json!(["x"])), "deal_malformed", "deals.0.customer_id"),
            (deal(json!([{"customer_id": 2.5}, "x"])), "deal_malformed", "deals.0.customer_id"),
        ],
    );
    company.call("send_enterprise_deal", json!({"deals": [[4, [["B", 9]]]]}));
    let some = deal(json!([2, "x", {"customer_id": "4"}, [2], {"customer_id": [1]}, 3, {}]));
    let data = company.call("reject_enterprise_deal", some);
    let expected = json!({"results": [
        {"error": "invalid format"},
        {"error": "invalid format"},
        {"error": "missing customer_id"},
        {"customer_id": 2, "success": true},
        {"customer_id": 4, "success": true},
        {"customer_id": 2, "error": "no active thread"},
        {"customer_id": 3, "success": true},
    ]});
    assert_eq!(data, expected);
    // A rejected lead is lost; a subscriber keeps the subscription.
    let again = company.expect_rejection("send_enterprise_deal", json!({"deals": [[2, [["B", 5]]]]}));
    assert_eq!(again.0, "no_subscription");
    company.call("send_enterprise_deal", json!({"deals": [[4, [["B", 9]]]]}));
    assert_eq!(company.call("reject_enterprise_deal", deal(json!(4)))["results"][0]["success"], true);
}

#[test]
fn read_tools_return_cost_info_and_day() {
    let mut company = TestCompany::new();
    let costs = company.call("get_cost_info", json!({}));
    assert_eq!(costs["model_tiers"]["4"]["cost_per_usage_unit"], 0.012);
    assert_eq!(costs["capacity_tiers"]["1"], json!({"capacity_units": 200000, "cost_per_day": 215}));
    assert_eq!(company.call("get_vars", json!({})), json!({"current_day": 0}));
    assert_eq!(company.expect_rejection("get_vars", json!({"day": 1})).0, "unknown_argument");
}

#[test]
fn current_arguments_can_be_sent_back() {
    let mut company = TestCompany::new();
    company.call("set_prices", json!({"A": 12, "B": 25, "C": 55}));
    company.call("set_promotion", json!({"by_group_plan": {"S1": {"A": 3}}, "by_customer": {"7": 1.5}}));
    company.call("set_targeted_ad_spend", json!({"linkedin": {"E1": 20}}));
    for tool in super::CATALOGUE {
        let current = tool.current_arguments(&company.world.settings);
        if current.is_empty() {
            continue;
        }
        let before = company.world.settings.clone();
        company.call(tool.spec().name(), Value::Object(current));
        assert_eq!(company.world.settings, before, "{}", tool.spec().name());
    }
}

#[test]
fn discovered_groups_are_accepted() {
    let mut company = TestCompany::new();
    let group = Group::parse("D_S06").expect("a group");
    company.world.market.knowledge[group].level = 1;
    company.call("set_targeted_dev_spend", json!({"D_S06": 5}));
}

#[test]
fn post_social_media_allows_one_post_per_day() {
    let mut company = TestCompany::new();
    for (arguments, code, field) in [
        (json!({}), "argument_missing", Some("content")),
        (json!({"content": 5}), "wrong_type", Some("content")),
        (json!({"content": "x".repeat(281)}), "too_long", Some("content")),
        (json!({"content": " \n "}), "blank", Some("content")),
        (json!({"content": "Hi", "reply_to_post_id": 1}), "post_not_found", Some("reply_to_post_id")),
        (json!({"content": "Hi", "reply_to_post_id": -4}), "post_not_found", Some("reply_to_post_id")),
        (json!({"content": "Hi", "reply_to_post_id": "1"}), "wrong_type", Some("reply_to_post_id")),
        (json!({"content": "Hi", "to": 1}), "unknown_argument", Some("to")),
    ] {
        let (own_code, own_field) = company.expect_rejection("post_social_media", arguments);
        assert_eq!((own_code, own_field.as_deref()), (code, field));
    }
    let content = "\u{fc}".repeat(280);
    assert_eq!(
        company.call("post_social_media", json!({"content": content, "reply_to_post_id": null})),
        json!({"agent_post_id": 1, "day": 0, "content": content, "reply_to_post_id": null})
    );
    assert_eq!(
        company.expect_rejection("post_social_media", json!({"content": "More."})),
        ("already_posted", None)
    );
    company.world.day = 7;
    company.world.market.social.next_post = 12;
    assert_eq!(
        company.call("post_social_media", json!({"content": "Thanks.", "reply_to_post_id": 11.0}))["reply_to_post_id"],
        json!(11)
    );
    assert_eq!(company.world.market.social.own.len(), 2);
}

#[test]
fn get_social_posts_returns_newest_first() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "get_social_posts",
        &[(json!({"limit": "x"}), "wrong_type", "limit"), (json!({"days": 1.5}), "wrong_type", "days")],
    );
    assert_eq!(company.call("get_social_posts", json!({})), json!({"posts": []}));
    company.call("post_social_media", json!({"content": "We are live."}));
    let group = |id| Group::parse(id).expect("a group");
    let post = |post, written_by| super::PublicPost {
        post,
        day: 7,
        content: format!("post {post}"),
        own_post: None,
        source_group: None,
        written_by,
        profile: None,
    };
    let comment = super::PublicPost {
        own_post: Some(1),
        source_group: Some(group("E2")),
        profile: Some("Castell & Byrne".into()),
        ..post(3, Some(group("E2")))
    };
    let posts = [post(1, None), post(2, Some(group("D_S01"))), comment];
    let view = ToolContext::new(&company.world, &company.params).with_posts(&posts);
    let tool = find("get_social_posts").expect("the tool exists");
    let read = |arguments: Value| {
        let arguments =
            Arguments::parse(tool.spec(), &arguments, || super::ParameterNumbers::bundled().into())
                .expect("right arguments");
        let planned = tool.plan(&view, &arguments).expect("it only reads");
        planned.reply.into_answer_without_script(&ResolvedCommand::None).expect("an answer").to_json()
    };
    let all = read(json!({"days": 1}));
    assert_eq!(all["total"], json!(3));
    assert_eq!(
        all["posts"][0],
        json!({
            "post_id": 3, "day": 7, "content": "post 3", "reply_to_agent_post_id": 1, "source_group_id": "E2",
            "group_id": "E2", "customer_type": "large", "custom_name": null, "persona_name": "Castell & Byrne",
            "replying_to_your_post": "We are live.",
        })
    );
    assert_eq!(
        (&all["posts"][1]["group_id"], &all["posts"][1]["customer_type"]),
        (&json!("D_S01"), &json!("small"))
    );
    assert_eq!(
        (&all["posts"][2]["group_id"], &all["posts"][2]["persona_name"]),
        (&json!("S1"), &json!(null))
    );
    assert!(all["posts"][2].get("replying_to_your_post").is_none());
    assert_eq!(read(json!({"limit": 1}))["posts"].as_array().map(Vec::len), Some(1));
    assert_eq!(read(json!({"limit": 0})), json!({"posts": []}));
    assert_eq!(read(json!({"limit": -1}))["total"], json!(3));
    let mut params = company.params.clone();
    params.fidelity.interface = novamind_world::params::Interface::Release2;
    let view = ToolContext::new(&company.world, &params).with_posts(&posts);
    let arguments = Arguments::parse(tool.spec(), &json!({}), || super::ParameterNumbers::bundled().into());
    let planned = tool.plan(&view, &arguments.expect("right arguments")).expect("it only reads");
    let answer = planned.reply.into_answer_without_script(&ResolvedCommand::None).expect("an answer");
    assert_eq!(
        answer.to_json(),
        json!({
            "posts": [
                {
                    "post_id": 3, "day": 7, "content": "post 3", "reply_to_agent_post_id": 1,
                    "replying_to_your_post": "We are live.",
                },
                {"post_id": 2, "day": 7, "content": "post 2", "reply_to_agent_post_id": null},
                {"post_id": 1, "day": 7, "content": "post 1", "reply_to_agent_post_id": null},
            ],
            "total": 3,
        })
    );
}

#[test]
fn running_project_is_rejected_before_missing_funds() {
    let mut company = TestCompany::new();
    company.call("start_research_project", json!({"tier": 2}));
    company.world.finance.cash = 1.0;
    for (tier, code) in [(0, "rd_tier_unknown"), (2, "rd_in_progress"), (1, "insufficient_funds")] {
        assert_eq!(
            company.expect_rejection("start_research_project", json!({"tier": tier})).0,
            code,
            "tier {tier}"
        );
    }
}
