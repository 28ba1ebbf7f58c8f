//! Properties of the action items of generated companies: the amounts and times of an item follow from the numbers in
//! its text, they agree with the figures on other screens, and the tool accepts the proposed call.

use std::collections::BTreeMap;

use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use serde_json::{Value, json};

use super::*;
use crate::fit::fits;
use crate::plan_margins::PlanSales;
use crate::test_kit::advance_weeks;
use novamind_record::folder::configuration::Configuration;
use novamind_record::trajectory::record::Via;
use novamind_session::identifiers::Plan;
use novamind_session::{NewRun, Storage};

const WEEKS: u32 = 12;

/// A generated company: its seed and starting cash, its first decisions, and a second decision in a later week.
#[derive(Debug, Clone)]
struct Company {
    seed: u64,
    cash: f64,
    calls: Vec<(&'static str, Value)>,
    change_week: u32,
    later_calls: Vec<(&'static str, Value)>,
}

fn prices(scale: impl Strategy<Value = f64>) -> impl Strategy<Value = (&'static str, Value)> {
    (scale, 1.2_f64..2.5, 1.2_f64..2.5).prop_map(|(a, b, c)| {
        let cents = |price: f64| (price * 100.0).round() / 100.0;
        ("set_prices", json!({"A": cents(a), "B": cents(a * b), "C": cents(a * b * c)}))
    })
}

fn model_tiers() -> impl Strategy<Value = (&'static str, Value)> {
    (1..=5, 1..=5, 1..=5).prop_map(|(a, b, c)| ("set_model_tiers", json!({"A": a, "B": b, "C": c})))
}

fn quotas() -> impl Strategy<Value = (&'static str, Value)> {
    let quota = || prop::sample::select(vec![0_u32, 40, 400, 4_000, 40_000]);
    (quota(), quota(), quota())
        .prop_map(|(a, b, c)| ("set_usage_quotas", json!({"A": a + 30, "B": b, "C": c + 200})))
}

fn spending() -> impl Strategy<Value = Vec<(&'static str, Value)>> {
    let group = || prop::sample::select(vec!["S1", "S2", "S3", "E1", "E2"]);
    let channel =
        || prop::sample::select(vec!["content_marketing", "social_media", "search_ads", "linkedin"]);
    let ads = prop::collection::vec((channel(), group(), 100_u32..4_000), 1..5);
    (0_u32..1_500, 0_u32..800, ads, group(), 0_u32..6_000, 0_u32..6).prop_map(
        |(operations, development, ads, developed, targeted, capacity)| {
            let mut spend: BTreeMap<&str, BTreeMap<&str, u32>> = BTreeMap::new();
            for (channel, group, dollars) in ads {
                spend.entry(channel).or_default().insert(group, dollars);
            }
            vec![
                ("set_daily_spend", json!({"operations": operations, "development": development})),
                ("set_targeted_ad_spend", json!({ "targeted_spend": spend })),
                ("set_targeted_dev_spend", json!({"targeted_spend": { developed: targeted }})),
                ("set_capacity_tier", json!({ "tier": capacity })),
            ]
        },
    )
}

fn companies() -> impl Strategy<Value = Company> {
    let opening = (prices(5.0_f64..30.0), model_tiers(), quotas(), spending());
    let later = prop_oneof![prices(5.0_f64..90.0), model_tiers(), quotas()];
    (0_u64..10_000, 1e5_f64..8e6, opening, 4_u32..10, later).prop_map(
        |(seed, cash, (prices, tiers, quotas, spending), change_week, later)| Company {
            seed,
            cash: cash.round(),
            calls: [vec![prices, tiers, quotas], spending].concat(),
            change_week,
            later_calls: vec![later],
        },
    )
}

fn call_all(session: &mut Session, calls: &[(&'static str, Value)]) {
    for (tool, arguments) in calls {
        session.call(tool, arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
}

/// Returns the numbers of a text in order, without the digits of identifiers such as `S1`.
fn numbers(text: &str) -> Vec<f64> {
    let mut found = Vec::new();
    let mut before = ' ';
    let mut rest = text;
    while let Some(sign) = rest.chars().next() {
        if sign.is_ascii_digit() && !before.is_alphabetic() {
            let end = rest.find(|sign: char| !(sign.is_ascii_digit() || sign == ',' || sign == '.'));
            let word = &rest[..end.unwrap_or(rest.len())];
            found.extend(word.replace(',', "").trim_end_matches('.').parse::<f64>());
            rest = &rest[word.len()..];
            before = '0';
        } else {
            // All following digits belong to the identifier.
            before = if sign.is_ascii_digit() { 'x' } else { sign };
            rest = &rest[sign.len_utf8()..];
        }
    }
    found
}

#[test]
fn numbers_excludes_identifiers() {
    assert_eq!(numbers("D_S05: $1,234.50 of 7 (12.5%) on A. 3 weeks, 9."), [1234.5, 7.0, 12.5, 3.0, 9.0]);
}

/// Asserts that a displayed number differs from the computed number by at most `tolerance`, the largest rounding error.
#[track_caller]
fn assert_near(shown: f64, computed: f64, tolerance: f64, need: &ActionItem) {
    assert!((shown - computed).abs() <= tolerance + 1e-6, "{shown} {computed}: {need:#?}");
}

fn check_item(need: &ActionItem, session: &mut Session) {
    assert!(need.at_risk.is_finite() && need.at_risk > 0.0, "{need:#?}");
    let text = need.describe();
    assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    if let ActionTarget::Call(tool, arguments) = &need.target
        && !arguments.is_null()
    {
        let preview =
            session.preview_call(tool, arguments).unwrap_or_else(|refusal| panic!("{need:#?}: {refusal}"));
        assert!(!preview.changes.is_empty() || preview.cost_now > 0.0, "the call has no effect: {need:#?}");
    }
    let (stated, proposed) = (numbers(&need.text), numbers(need.proposal.as_deref().unwrap_or_default()));
    match need.problem {
        Problem::Margin => check_margin(need, &stated, &proposed, session),
        Problem::ConversionFall(group) => check_conversion_fall(need, &stated, group, session),
        Problem::Churn(group) => check_churn(need, &stated, group, session),
        Problem::NoSales(group) => check_no_sales(need, &stated, &proposed, group, session),
        Problem::Capacity => check_capacity(need, &stated, &proposed),
        Problem::Overload => check_overload(need, &stated, &proposed),
        Problem::Backlog => check_backlog(need, &stated, &proposed),
        Problem::Outages => {
            let (&[_, spend, share], &[more, reduced]) = (&stated[..], &proposed[..]) else {
                panic!("{need:#?}")
            };
            assert!(more > spend && reduced <= share / 2.0 + 0.1, "{need:#?}");
        }
        Problem::LeadCost(..) => check_lead_cost(need),
        Problem::NoAdResults(group) => check_ads_without_results(need, &stated, &proposed, group, session),
        Problem::Threads => {
            let day = f64::from(session.day());
            let deadline = need.text.split("by day ").skip(1).map(|rest| numbers(rest)[0]);
            let deadlines: Vec<f64> = deadline.collect();
            assert!(deadlines.iter().all(|deadline| (day..=day + 7.0).contains(deadline)), "{need:#?}");
            assert!(deadlines.first() >= deadlines.last(), "{need:#?}");
        }
        Problem::NoQuota => {
            let [quota, usage, most] = proposed[..] else { panic!("{need:#?}") };
            assert!(quota >= most && most >= usage, "{need:#?}");
        }
        Problem::NoLeads => {
            let [spend, total] = proposed[..] else { panic!("{need:#?}") };
            assert_eq!(total, spend * 7.0 * Channel::ALL.len() as f64, "{need:#?}");
        }
        // The runway is checked by other tests, in this crate and in the crate `session`.
        Problem::Runway | Problem::NoPrice | Problem::NoRequests(_) => {}
    }
}

/// Checks that the compute cost exceeds the revenue, and that the margin on the Product screen is also negative.
fn check_margin(need: &ActionItem, stated: &[f64], proposed: &[f64], session: &mut Session) {
    let [_, revenue, compute] = stated[..] else { panic!("{need:#?}") };
    assert!(compute > revenue, "{need:#?}");
    let plan = Plan::ALL.into_iter().find(|plan| need.text.starts_with(&format!("Plan {plan} ")));
    let plan = plan.expect("a plan");
    let tier = session.settings().core.tiers[plan];
    let models = session.company().tool_limits().models;
    let unit_cost = models.iter().find(|model| model.tier == tier).expect("a tier").unit_cost;
    let usage = PlanSales::load(session).expect("sales").usage_of_plan(plan);
    let shown = usage.margin(unit_cost).unwrap_or(-1.0);
    assert!(shown < 0.0, "the Product screen shows a margin of {shown}: {need:#?}");
    match proposed[..] {
        [_, reduced] => assert!(reduced <= revenue, "{need:#?}"),
        [quota, reduced, held] => assert!(quota < held && reduced <= revenue, "{need:#?}"),
        _ => panic!("{need:#?}"),
    }
}

/// Checks that the conversions and their difference follow from the counts, and that the counts equal those of
/// [`fits`].
fn check_conversion_fall(need: &ActionItem, stated: &[f64], group: Group, session: &Session) {
    let [signed, leads, share, _, usual_signed, usual_leads, usual, fewer] = stated[..8] else {
        panic!("{need:#?}")
    };
    assert_near(share, 100.0 * signed / leads, 0.05, need);
    assert_near(usual, 100.0 * usual_signed / usual_leads, 0.05, need);
    assert_near(fewer, usual_signed / usual_leads * leads - signed, 0.5, need);
    assert!(share < usual && fewer >= 1.0, "{need:#?}");
    let all = fits(session);
    let fit = all.iter().find(|fit| fit.group == group).expect("a known group");
    let week = fit.last_week.expect("a week");
    assert_eq!((f64::from(week.leads), f64::from(week.signups)), (leads, signed), "{need:#?}");
}

fn check_churn(need: &ActionItem, stated: &[f64], group: Group, session: &Session) {
    let [gone, weeks, expected] = stated[..3] else { panic!("{need:#?}") };
    assert!(gone >= 2.0 * (expected - 0.5) && (2.0..=4.0).contains(&weeks), "{need:#?}");
    let last = session.company().group_weeks().last().expect("a week");
    assert_eq!(f64::from(last[group].left), gone, "{need:#?}");
}

fn check_no_sales(need: &ActionItem, stated: &[f64], proposed: &[f64], group: Group, session: &Session) {
    let week = &session.company().group_weeks().last().expect("a week")[group];
    assert_eq!(stated[0], f64::from(week.leads), "{need:#?}");
    let share = stated[if week.signed == 0 { 1 } else { 2 }];
    assert_near(share, 100.0 * f64::from(week.signed) / f64::from(week.leads), 0.05, need);
    let proposal = need.proposal.as_deref().unwrap_or_default();
    if proposal.contains("in total") {
        let [spend, _, _, _, days, total] = proposed[..6] else { panic!("{need:#?}") };
        assert_eq!(total, spend * days, "{need:#?}");
    } else if proposal.contains("A week costs") {
        let [spend, _, _, _, days, week] = proposed[..6] else { panic!("{need:#?}") };
        assert!(days < 7.0 && week == 7.0 * spend, "{need:#?}");
    }
    if let Some((_, rest)) = proposal.split_once("The cost exceeds the ") {
        let cost = proposed[5];
        assert!(cost > numbers(rest)[0], "{need:#?}");
    }
}

/// Checks that usage exceeds the tier in the stated week if it grows at the stated rate.
fn check_capacity(need: &ActionItem, stated: &[f64], proposed: &[f64]) {
    let [busiest, share, units, tier, growth] = stated[..] else { panic!("{need:#?}") };
    assert_near(share, 100.0 * busiest / units, 0.5, need);
    let weeks = libm::log(units / busiest) / libm::log(1.0 + growth / 100.0);
    match need.text.contains("of next week exceeds") {
        true => assert!(weeks <= 1.0, "{weeks}: {need:#?}"),
        false => assert!(weeks > 1.0 && weeks <= 2.0, "{weeks}: {need:#?}"),
    }
    assert!(proposed[0] == tier + 1.0 && proposed[1] > units && proposed[2] > proposed[3], "{need:#?}");
}

fn check_overload(need: &ActionItem, stated: &[f64], proposed: &[f64]) {
    let [busiest, excess, units, tier] = stated[..] else { panic!("{need:#?}") };
    assert_near(excess, 100.0 * (busiest / units - 1.0), 0.05, need);
    if let [next, capacity, cost, more] = proposed[..] {
        assert!(next > tier && more > 0.0 && cost >= more, "{need:#?}");
        let is_largest = need.describe().contains("It is the largest tier");
        assert_eq!(capacity < busiest, is_largest, "{need:#?}");
    }
}

/// Checks that the backlog is cleared after the stated number of days.
fn check_backlog(need: &ActionItem, stated: &[f64], proposed: &[f64]) {
    let ([waiting, ..], [_, solved, inflow, days]) = (stated, proposed) else { panic!("{need:#?}") };
    assert!(solved > inflow, "{need:#?}");
    assert_eq!((waiting / (solved - inflow)).ceil(), *days, "{need:#?}");
}

/// Checks that the cost of a lead is at least twice the earlier cost.
fn check_lead_cost(need: &ActionItem) {
    let Some((recent, earlier)) = need.text.split_once(". In weeks ") else { panic!("{need:#?}") };
    let cost = |text: &str| Some(numbers(text.split_once('$')?.1)[0]);
    if !recent.contains("no lead for") {
        assert!(cost(recent) >= cost(earlier).map(|cost| 1.99 * cost), "{need:#?}");
    }
}

/// Checks that the spending and the leads are those of the table of ads, that it exceeds the bills of three customers,
/// and that the form removes the named budget.
fn check_ads_without_results(
    need: &ActionItem,
    stated: &[f64],
    proposed: &[f64],
    group: Group,
    session: &mut Session,
) {
    let (spend, weeks, bills) = (stated[0], stated[1], stated[stated.len() - 1]);
    assert!(weeks >= 4.0 && spend > bills, "{need:#?}");
    let from = f64::from(session.day()) - 7.0 * weeks;
    let sql = format!(
        "SELECT total(spend), total(leads_generated), count(DISTINCT day) FROM ad_channel_leads \
         WHERE group_id = '{group}' AND day > {from}"
    );
    let rows = session.query(&sql).expect("rows").rows;
    let of_column = |column| novamind_database::number_at(&rows[0], column);
    assert_near(spend, of_column(0), 0.5, need);
    let leads = if need.text.contains("brought no lead") { 0.0 } else { stated[2] };
    assert_eq!((of_column(1), of_column(2)), (leads, 7.0 * weeks), "{need:#?}");
    let ads = session.settings().targeted_ads.clone();
    let now: f64 = ads.targeted_spend.values().filter_map(|groups| groups.get(&group)).sum();
    assert_near(proposed[0], now, 0.5, need);
}

/// Plays generated companies and checks every item in every week. Returns the number of reports of each
/// problem.
fn check_companies(count: usize) -> BTreeMap<&'static str, usize> {
    let mut runner = TestRunner::deterministic();
    let mut reported = BTreeMap::new();
    for _ in 0..count {
        let company = companies().new_tree(&mut runner).expect("a company").current();
        let new = NewRun {
            seed: Some(company.seed),
            cash: Some(company.cash),
            storage: Storage::Memory,
            ..NewRun::default()
        };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        call_all(&mut session, &company.calls);
        for week in 0..WEEKS {
            if session.ended().is_some() {
                break;
            }
            if week == company.change_week {
                call_all(&mut session, &company.later_calls);
            }
            let checked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                for need in action_items(&session) {
                    *reported.entry(need.problem.id()).or_default() += 1;
                    check_item(&need, &mut session);
                }
            }));
            assert!(checked.is_ok(), "week {week} of {company:#?}");
            advance_weeks(&mut session, 1);
        }
    }
    reported
}

/// Checks six companies, or the number in the environment variable `PROPTEST_CASES`.
#[test]
fn items_of_generated_companies_agree_with_their_own_numbers() {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|text| text.parse().ok()).unwrap_or(6);
    let reported = check_companies(cases);
    assert!(reported.len() >= 6, "few kinds of problems: {reported:?}");
    if cases >= 100 {
        for problem in [
            "margin",
            "conversion_fall",
            "churn",
            "no_sales",
            "no_ad_results",
            "overload",
            "capacity",
            "backlog",
        ] {
            assert!(reported.contains_key(problem), "{problem}: {reported:?}");
        }
    }
}
