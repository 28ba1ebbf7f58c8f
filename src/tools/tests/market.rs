//! Tests of the market tools: discovery, studies, overview and insights.

use serde_json::json;

use super::TestCompany;
use novamind_world::events::{Phase, Reading, Trend};
use novamind_world::identifiers::Group;

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

#[test]
fn research_market_discovers_every_group() {
    let mut company = TestCompany::new();
    company.world.finance.cash = 24_999.99;
    company.assert_rejections(
        "research_market",
        &[(json!({}), "insufficient_funds", ""), (json!({"group": "S1"}), "unknown_argument", "group")],
    );
    company.world.finance.cash = 1_000_000.0;
    let mut found = 0;
    for attempt in 1..=30 {
        let data = company.call("research_market", json!({}));
        match data["discovered_group_id"].as_str() {
            Some(id) => {
                found += 1;
                assert_eq!(company.world.market.knowledge[group(id)].level, 1);
                assert_eq!(data.as_object().map(|fields| fields.len()), Some(1));
                company.call("set_targeted_dev_spend", json!({ id: 5 }));
            }
            None => assert_eq!(data, json!({"cost": 25000.0})),
        }
        assert_eq!(company.world.finance.cash, 1_000_000.0 - 25_000.0 * f64::from(attempt));
    }
    assert!(found > 2);
}

#[test]
fn research_market_charges_when_all_groups_are_known() {
    let mut company = TestCompany::new();
    for group in Group::all() {
        company.world.market.knowledge[group].level = 1;
    }
    assert_eq!(company.call("research_market", json!({})), json!({"cost": 25000.0}));
    assert_eq!((company.world.finance.cash, company.world.market.attempts), (975_000.0, 1));
}

#[test]
fn research_group_validates_levels() {
    let mut company = TestCompany::new();
    company.world.market.knowledge[group("E1")].level = 4;
    company.call("research_group", json!({"group_id": "S1", "target_level": 3}));
    company.world.finance.cash = 59_999.99;
    company.assert_rejections(
        "research_group",
        &[
            (json!({}), "argument_missing", "group_id"),
            (json!({"group_id": 5}), "wrong_type", "group_id"),
            (json!({"group_id": "D_S06"}), "group_not_discovered", "group_id"),
            (json!({"group_id": "X"}), "group_not_discovered", "group_id"),
            // Only the integers from 2 to 5 are valid, not 3.0.
            (json!({"group_id": "S2", "target_level": 3.0}), "level_out_of_range", "target_level"),
            (json!({"group_id": "S2", "target_level": "3"}), "level_out_of_range", "target_level"),
            (json!({"group_id": "S2", "target_level": 1}), "level_out_of_range", "target_level"),
            (json!({"group_id": "S2", "target_level": 6}), "level_out_of_range", "target_level"),
            (json!({"group_id": "S2", "target_level": true}), "level_out_of_range", "target_level"),
            (json!({"group_id": "E1", "target_level": 3}), "no_downgrade", "target_level"),
            (json!({"group_id": "S1", "target_level": 5}), "study_in_progress", "group_id"),
            (json!({"group_id": "S2"}), "insufficient_funds", ""),
        ],
    );
    let rejection = company.try_call("research_group", json!({"group_id": "S2"})).expect_err("too expensive");
    assert_eq!(rejection.message, "costs $60,000, cash is $60,000");
}

#[test]
fn studies_are_charged_at_once_and_report_completion_day() {
    let mut company = TestCompany::new();
    company.world.finance.cash = 60_000.0;
    let data = company.call("research_group", json!({"group_id": "S1"}));
    let expected =
        json!({"group_id": "S1", "new_level": 2, "expected_completion_day": 3, "is_refresh": false});
    assert_eq!(data, expected);
    // A purchase may use all cash.
    assert_eq!(company.world.finance.cash, 0.0);
    assert_eq!(company.expect_rejection("research_market", json!({})).0, "insufficient_funds");
    company.world.finance.cash = 1_000_000.0;
    company.world.day = 21;
    let data = company.call("research_group", json!({"group_id": "E2", "target_level": 3}));
    let expected =
        json!({"group_id": "E2", "new_level": 3, "expected_completion_day": 26, "is_refresh": false});
    assert_eq!(data, expected);
    company.world.market.knowledge[group("S3")].level = 3;
    let data = company.call("research_group", json!({"group_id": "S3"}));
    assert_eq!((&data["new_level"], &data["is_refresh"]), (&json!(3), &json!(true)));
    assert_eq!(company.world.finance.cash, 1_000_000.0 - 2.0 * 175_000.0);
}

#[test]
fn get_market_overview_lists_known_groups_and_economy() {
    let mut company = TestCompany::new();
    let data = company.call("get_market_overview", json!({}));
    let ids: Vec<&str> = data["known_groups"]
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|group| group["group_id"].as_str())
        .collect();
    assert_eq!(ids, ["E1", "E2", "E3", "S1", "S2", "S3"]);
    let s1 = json!({
        "group_id": "S1",
        "group_name": "Price-Sensitive Individuals",
        "segment": "Individual",
        "info_level": 1,
        "noise": "\u{b1}65%",
    });
    assert_eq!(data["known_groups"][3], s1);
    assert_eq!(data["known_groups"][0]["segment"], "Enterprise");
    assert_eq!((&data["undiscovered_count"], &data["macroeconomic"]), (&json!(20), &json!(null)));

    company.world.market.knowledge[group("D_S06")].level = 2;
    company.world.market.economy.published = Some(Reading {
        measured_day: 1,
        value: 48.3,
        change: -0.6,
        trend: Trend::Neutral,
        phase: Phase::Declining,
    });
    let data = company.call("get_market_overview", json!({}));
    assert_eq!(data["known_groups"][0]["group_id"], "D_S06");
    assert_eq!(data["known_groups"][0]["noise"], "\u{b1}40%");
    assert_eq!(data["undiscovered_count"], 19);
    let economy = &data["macroeconomic"];
    assert_eq!((&economy["pmi_value"], &economy["pmi_change"]), (&json!(48.3), &json!(-0.6)));
    assert_eq!((&economy["pmi_trend"], &economy["cycle_phase"]), (&json!("neutral"), &json!("declining")));
    company.assert_rejections("get_market_overview", &[(json!({"day": 3}), "unknown_argument", "day")]);
}

#[test]
fn get_group_insights_returns_known_groups_only() {
    let mut company = TestCompany::new();
    company.assert_rejections(
        "get_group_insights",
        &[
            (json!({}), "argument_missing", "group_id"),
            (json!({"group_id": true}), "wrong_type", "group_id"),
            (json!({"group_id": "D_E01"}), "group_not_discovered", "group_id"),
            (json!({"group_id": "s1"}), "group_not_discovered", "group_id"),
        ],
    );
    let before = company.world.part_hashes();
    let data = company.call("get_group_insights", json!({"group_id": "E1"}));
    assert_eq!(data, company.call("get_group_insights", json!({"group_id": "E1"})));
    assert_eq!(company.world.part_hashes(), before);
    let fields: Vec<&String> = data.as_object().expect("an object").keys().collect();
    let expected = [
        "group_id",
        "group_name",
        "segment",
        "info_level",
        "noise",
        "estimates",
        "network_influence",
        "reputation_influence",
    ];
    assert_eq!(fields, expected);
    let estimates: Vec<&String> = data["estimates"].as_object().expect("an object").keys().collect();
    let expected = [
        "willingness_to_pay",
        "usage_volume",
        "quality_floor_q_min",
        "contract_lockin_aversion",
        "market_cap",
        "annual_market_cap_growth_rate",
        "seat_range",
        "decision_rounds",
        "avg_response_days",
    ];
    assert_eq!(estimates, expected);
    let incoming = data["network_influence"]["incoming"].as_object().expect("a map");
    assert_eq!(incoming.len(), 2);
    let weights: Vec<f64> = data["reputation_influence"]["outgoing"]
        .as_object()
        .expect("a map")
        .values()
        .filter_map(serde_json::Value::as_f64)
        .collect();
    assert!(weights.len() == 5 && weights.is_sorted_by(|left, right| left >= right), "{weights:?}");
    let individual = company.call("get_group_insights", json!({"group_id": "S1"}));
    assert!(individual["estimates"].get("seat_range").is_none());
}
