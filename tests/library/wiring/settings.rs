//! Settings: undo, redo, the change review and the tables agree with the calls.

use novamind::database::Interface;
use novamind::record::trajectory::record::Via;
use novamind::session::{Session, Storage};
use novamind::tools::{CATALOGUE, ToolKind};
use serde_json::{Value, json};

use super::create;
use crate::support::company::{advance_week, call_tool, query_numbers};

/// Returns two calls of a tool that differ in every number.
fn two_calls(tool: &str) -> [Value; 2] {
    match tool {
        "set_prices" => [json!({"A": 12, "B": 25, "C": 55}), json!({"A": 13.5, "B": 26.75, "C": 59})],
        "set_model_tiers" => [json!({"A": 2, "B": 3, "C": 4}), json!({"A": 3, "B": 5, "C": 1})],
        "set_usage_quotas" => {
            [json!({"A": 60000, "B": 250000, "C": 1200000}), json!({"A": 50001, "B": 250000.5, "C": 7})]
        }
        "set_daily_spend" => [
            json!({"operations": 200, "development": 300.25}),
            json!({"operations": 250.5, "development": 0}),
        ],
        "set_capacity_tier" => [json!({"tier": 2}), json!({"tier": 5})],
        "set_promotion" => [
            json!({"global_promotion": 1, "by_group": {"S1": 2}, "by_customer": {"17": 3},
                   "by_group_plan": {"S2": {"A": 4, "B": 5}}}),
            json!({"global_promotion": 6.5, "by_group": {"S3": 7, "S1": 8}, "by_customer": {"19": 9},
                   "by_group_plan": {"S2": {"C": 10}}}),
        ],
        "set_lead_promotion" => [
            json!({"global_promotion": 1, "by_group": {"S1": 2}, "by_channel": {"linkedin": 3},
                   "by_channel_group": {"search_ads": {"S1": 4, "E1": 5}}}),
            json!({"global_promotion": 6.5, "by_group": {"S2": 7}, "by_channel": {"social_media": 8},
                   "by_channel_group": {"search_ads": {"S3": 9}, "linkedin": {"E2": 10}}}),
        ],
        "set_ads_strength" => [
            json!({"global_strength": 0.1, "by_group": {"S1": 0.2}, "by_customer": {"17": 0.3}}),
            json!({"global_strength": 0.4, "by_group": {"S3": 0.5}, "by_customer": {"19": 0.6, "17": 0.7}}),
        ],
        "set_targeted_ad_spend" => [
            json!({"targeted_spend": {"linkedin": {"S1": 100, "E1": 50}, "search_ads": {"S2": 25}}}),
            json!({"targeted_spend": {"search_ads": {"S1": 70.5}, "social_media": {"S3": 80}}}),
        ],
        "set_targeted_dev_spend" => [
            json!({"targeted_spend": {"S1": 1000, "E1": 500}}),
            json!({"targeted_spend": {"S2": 700.25, "S1": 900}}),
        ],
        "set_targeted_ops_spend" => [
            json!({"by_group": {"S1": 10}, "by_plan": {"B": 20}, "by_group_plan": {"S2": {"C": 30}},
                   "by_customer": {"17": 40}}),
            json!({"by_group": {"S3": 50.5}, "by_plan": {"A": 60, "C": 70},
                   "by_group_plan": {"S2": {"A": 80}, "E1": {"B": 90}}, "by_customer": {"19": 95}}),
        ],
        other => panic!("{other} is new: add two calls of it here"),
    }
}

fn setting_tools() -> impl Iterator<Item = &'static str> {
    CATALOGUE
        .iter()
        .map(|tool| tool.spec())
        .filter(|spec| spec.kind == ToolKind::Setting)
        .map(|spec| spec.name())
}

fn settings(session: &Session) -> String {
    session.state_hash().1["settings"].clone()
}

#[test]
fn undo_and_redo_restore_and_report_every_setting() {
    for tool in setting_tools() {
        let mut session = create(Storage::Memory, &[]);
        let [first, second] = two_calls(tool);
        let mut states = vec![(settings(&session), session.company().current_arguments(tool))];
        for arguments in [first, second] {
            call_tool(&mut session, tool, arguments);
            states.push((settings(&session), session.company().current_arguments(tool)));
        }
        assert!(states[0].0 != states[1].0 && states[1].0 != states[2].0, "{tool} changes nothing");

        let undone = session.undo(Via::Form).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
        assert_eq!(
            (settings(&session), session.company().current_arguments(tool)),
            states[1],
            "{tool} after undo"
        );
        let redone = session.redo(Via::Form).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
        assert_eq!(
            (settings(&session), session.company().current_arguments(tool)),
            states[2],
            "{tool} after redo"
        );

        // Undo and redo describe the same change.
        assert!(!undone.is_empty(), "{tool}");
        for change in &undone {
            let back = redone.iter().find(|other| other.setting == change.setting);
            let back = back.unwrap_or_else(|| panic!("{tool}: redo does not name {}", change.setting));
            assert_eq!((back.old, back.new), (change.new, change.old), "{}", change.setting);
            assert_eq!(back.setting.tool().name(), tool, "{}", change.setting);
        }
        assert_eq!(undone.len(), redone.len(), "{tool}");
    }
}

#[test]
fn change_review_lists_every_changed_number() {
    for tool in setting_tools() {
        let mut session = create(Storage::Memory, &[]);
        call_tool(&mut session, tool, two_calls(tool)[1].clone());
        let mut expected = Vec::new();
        collect_numbers(&two_calls(tool)[1], &mut expected);
        let mut values: Vec<f64> =
            session.company().setting_changes().iter().map(|change| change.new).collect();
        // Zeros are excluded, because an unchanged zero is not a change.
        expected.retain(|number| *number != 0.0);
        values.retain(|number| *number != 0.0);
        for number in &values {
            assert!(expected.contains(number), "{tool}: {number} was never sent");
        }
        let initially = |number: &f64| tool == "set_model_tiers" && *number == 1.0;
        for number in expected.iter().filter(|number| !initially(number)) {
            assert!(values.contains(number), "{tool}: {number} is not in the review: {values:?}");
        }
    }
}

fn collect_numbers(value: &Value, found: &mut Vec<f64>) {
    match value {
        Value::Object(map) => map.values().for_each(|value| collect_numbers(value, found)),
        Value::Number(number) => found.extend(number.as_f64()),
        _ => {}
    }
}

#[test]
fn core_settings_are_written_to_their_columns() {
    let mut session = create(Storage::Memory, &[]);
    for tool in ["set_prices", "set_model_tiers", "set_usage_quotas", "set_daily_spend", "set_capacity_tier"]
    {
        call_tool(&mut session, tool, two_calls(tool)[0].clone());
    }
    advance_week(&mut session);
    let columns = "price_A, price_B, price_C, tier_A, tier_B, tier_C, quota_A, quota_B, quota_C, \
                   spend_operations, spend_development, capacity_tier";
    let row = query_numbers(
        &mut session,
        &format!("SELECT {columns} FROM config_history ORDER BY day DESC LIMIT 1"),
    );
    assert_eq!(
        row,
        [[12.0, 25.0, 55.0, 2.0, 3.0, 4.0, 60_000.0, 250_000.0, 1_200_000.0, 200.0, 300.25, 2.0]]
    );
}

#[test]
fn non_finite_numbers_are_rejected_by_the_session() {
    let mut session = create(Storage::Memory, &[]);
    for (tool, arguments) in [
        ("set_daily_spend", json!({"operations": 1e308})),
        ("set_prices", json!({"A": 1e308})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"linkedin": {"S1": 1e308}}})),
        ("set_targeted_dev_spend", json!({"targeted_spend": {"S1": 1e308}})),
        ("set_targeted_ops_spend", json!({"by_plan": {"A": 1e308}})),
        ("set_promotion", json!({"by_customer": {"17": 1e308}})),
        ("set_lead_promotion", json!({"by_channel": {"linkedin": 1e308}})),
        ("set_usage_quotas", json!({"A": 1e308, "B": 1, "C": 1})),
    ] {
        let before = session.state_hash();
        let refusal = session.call(tool, &arguments, Via::Script).expect_err(tool);
        assert_eq!((refusal.code, session.state_hash()), ("amount_too_large", before), "{tool}");
        let refusal = session.preview_call(tool, &arguments).expect_err(tool);
        assert_eq!(refusal.code, "amount_too_large", "{tool} is checked as it is called");
    }
    advance_week(&mut session);
    assert!(session.company().observe().cash.is_finite());
}

#[test]
fn fractional_quotas_are_kept() {
    let mut session = create(Storage::Memory, &[]);
    call_tool(&mut session, "set_usage_quotas", json!({"A": 59.75, "B": 250000, "C": 1.5}));
    let row = query_numbers(&mut session, "SELECT quota_A, quota_B, quota_C FROM config_history");
    assert_eq!(row, [[59.75, 250_000.0, 1.5]]);
    assert_eq!(session.company().current_arguments("set_usage_quotas")["A"], 59.75);
}

#[test]
fn table_descriptions_have_types_and_possible_values() {
    let mut session = create(Storage::Memory, &[]);
    let described = call_tool(&mut session, "describe_tables", json!({}));
    for table in novamind::database::tables(Interface::Release1) {
        let columns = &described["tables"][&table.name]["columns"];
        for column in &table.columns {
            let line =
                columns[&column.name].as_str().unwrap_or_else(|| panic!("{}.{}", table.name, column.name));
            assert!(line.starts_with(&column.kind), "{line}");
            assert!(line.contains(&column.description), "{line}");
            let listed: Vec<String> = column.values.iter().map(|value| format!("'{value}'")).collect();
            assert!(line.contains(&listed.join(", ")), "{listed:?} are missing in: {line}");
        }
    }
    let status = described["tables"]["subscriptions"]["columns"]["status"].to_string();
    assert!(status.contains("one of 'lead', 'subscribed', 'cancelled', 'lost'"), "{status}");
}
