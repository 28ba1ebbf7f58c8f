//! Tests of the judge: worked examples, and properties that every judgement has.

use super::context::{LiveEvent, ReaderGroup};
use super::text::WordPattern;
use super::*;
use novamind_world::identifiers::ByGroup;
use novamind_world::random::{Part, Streams};

const TECHNICAL_POST: &str = "API update: quotas doubled to 200k tokens/day on plan B, batch endpoint p95 at 190 ms. Benchmarks and docs \
                 published today.";
const COMPLAINT_TEXT: &str = "Hit rate limits again, my automation broke. Need higher quotas.";

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

/// Returns the context on which all worked examples are based.
fn default_context() -> JudgeContext {
    let count = |id: &str| match id {
        "S1" => 4000,
        "S2" => 900,
        "S3" => 600,
        "E1" => 12,
        "E2" => 6,
        "E3" => 2,
        _ => 0,
    };
    let readers =
        |group: Group| ReaderGroup { subscribers: count(group.id()), satisfaction: 0.0, progress: 0.012 };
    JudgeContext {
        groups: ByGroup::from_fn(readers),
        subscribers: 5520,
        research_done: false,
        price_cut: false,
        promotion: false,
        quota_up: false,
        outage_days: 0,
        overload: 0.0,
        p95_ms: 190.0,
        issue_rate: 0.03,
        issue_age: 1.5,
        live_events: Vec::new(),
    }
}

fn context_with_outage() -> JudgeContext {
    JudgeContext { outage_days: 1, live_events: vec![(LiveEvent::Outage, 2)], ..default_context() }
}

fn complaint() -> Option<OriginalPost<'static>> {
    Some(OriginalPost { content: COMPLAINT_TEXT, negative: true, group: Some(group("S3")) })
}

fn judge_all(submission: &SubmittedPost<'_>, facts: &JudgeContext) -> Vec<Judgement> {
    judge_post(submission, Group::all(), facts, Lexicon::bundled())
}

fn effect(judgements: &[Judgement], id: &str) -> f64 {
    judgements[group(id).index()].effect
}

fn post(content: &str) -> SubmittedPost<'_> {
    SubmittedPost { content, day: 100, ..SubmittedPost::default() }
}

struct Example {
    name: &'static str,
    submission: SubmittedPost<'static>,
    facts: JudgeContext,
    expected: [f64; 9],
}

const EXAMPLE_GROUPS: [&str; 9] = ["S1", "S2", "S3", "E1", "E2", "E3", "D_S07", "D_S08", "D_E03"];

fn examples() -> Vec<Example> {
    let quota_up = || JudgeContext { quota_up: true, ..default_context() };
    let example =
        |name, content, facts, expected| Example { name, submission: post(content), facts, expected };
    let mut list = vec![
        example(
            "a",
            "NovaMind is live. An AI assistant for documents, email and data. Try it and tell us what you think.",
            default_context(),
            [0.06, 0.09, 0.18, 0.09, 0.13, 0.10, 0.29, 0.06, 0.09],
        ),
        example(
            "b",
            "The BEST AI tool ever!!! Revolutionary, game-changing, 100% perfect. Sign up now! \u{1F680}\u{1F680}",
            default_context(),
            [-0.03, -0.34, -0.47, -0.33, -0.39, -0.33, -0.43, 0.01, -0.39],
        ),
        example(
            "c",
            "Student or freelancer? 30% discount on plan A this month, and month-to-month, cancel anytime. No tricks.",
            JudgeContext { promotion: true, ..default_context() },
            [0.34, 0.07, 0.10, 0.33, 0.04, 0.04, 0.08, 0.14, 0.04],
        ),
        example("d", TECHNICAL_POST, quota_up(), [0.45, 0.34, 0.87, 0.17, 0.24, 0.51, 0.80, 0.40, 0.30]),
        example(
            "e",
            TECHNICAL_POST,
            default_context(),
            [-0.43, -0.45, -0.34, -0.44, -0.42, -0.41, -0.07, -0.18, -0.15],
        ),
        example(
            "f",
            "We were down 3 hours on Tuesday. Root cause: an overloaded queue. Fixed, capacity doubled, credits go out \
             Friday. Sorry.",
            context_with_outage(),
            [0.62, 0.72, 0.75, 0.60, 0.58, 0.60, 0.32, 0.38, 0.23],
        ),
        example(
            "g",
            "New feature launch: brainstorm boards are here. Rock-solid uptime, as always!",
            context_with_outage(),
            [-0.48, -0.46, -0.53, -0.46, -0.46, -0.49, -0.27, -0.18, -0.25],
        ),
        example(
            "h",
            "Budgets are tight. Plan A price cut by 20% from Monday, annual volume discounts for teams, no lock-in.",
            JudgeContext {
                price_cut: true,
                live_events: vec![(LiveEvent::MacroDown, 6)],
                ..default_context()
            },
            [0.71, 0.32, 0.28, 0.63, 0.20, 0.21, 0.26, 0.32, 0.18],
        ),
        example(
            "i",
            "RivalTech just launched garbage. Overpriced and terrible. Everyone is switching to us.",
            JudgeContext { live_events: vec![(LiveEvent::Competitor, 3)], ..default_context() },
            [-0.23, -0.34, -0.34, -0.33, -0.38, -0.35, -0.35, -0.22, -0.36],
        ),
        example(
            "j",
            "Sorry you hit the quota wall. We raised plan B limits by 50% today and credited your account. Does that cover \
             your batch jobs?",
            JudgeContext { live_events: vec![(LiveEvent::Quota, 0)], ..quota_up() },
            [0.57, 0.43, 0.97, 0.36, 0.36, 0.40, 0.46, 0.40, 0.28],
        ),
        example(
            "k",
            "Read the docs. Limits are listed there, works for everyone else.",
            JudgeContext { live_events: vec![(LiveEvent::Quota, 0)], ..default_context() },
            [-0.18, -0.21, -0.33, -0.19, -0.20, -0.19, -0.21, -0.20, -0.19],
        ),
        example(
            "l",
            "API SDK webhooks limits quota latency p95 tokens batch docs benchmarks 200k tokens today shipped",
            default_context(),
            [-0.27, -0.36, 0.12, -0.47, -0.40, -0.23, 0.02, -0.32, -0.31],
        ),
        example("m", TECHNICAL_POST, quota_up(), [0.33, 0.31, 0.77, 0.17, 0.24, 0.39, 0.59, 0.35, 0.25]),
    ];
    for example in &mut list {
        match example.name {
            "j" | "k" => example.submission.original = complaint(),
            "m" => {
                example.submission.earlier = vec![
                    (79, "API news: bigger quotas on plan C from Monday, batch jobs run twice as fast now."),
                    (86, "Higher limits for the API are live, docs are updated."),
                ]
            }
            _ => {}
        }
    }
    list
}

#[test]
fn worked_examples_have_expected_scores() {
    let mut wrong = Vec::new();
    for example in examples() {
        let judgements = judge_all(&example.submission, &example.facts);
        for (id, expected) in EXAMPLE_GROUPS.into_iter().zip(example.expected) {
            let judgement = &judgements[group(id).index()];
            if (judgement.effect - expected).abs() > 1e-9 {
                wrong.push(format!(
                    "{} {id}: {} instead of {expected}: {:?}",
                    example.name, judgement.effect, judgement.terms
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn worked_examples_have_expected_terms() {
    let of = |name: &str, id: &str| {
        let example = examples().into_iter().find(|example| example.name == name).expect("an example");
        let judgements = judge_all(&example.submission, &example.facts);
        judgements[group(id).index()].clone()
    };
    for (name, id, expected) in [
        ("d", "S3", &[("topics", 0.40), ("specific", 0.20), ("tone", 0.1064), ("claims_true", 0.10)][..]),
        ("e", "S3", &[("claims_false", -0.55), ("topics", 0.10), ("specific", 0.05), ("tone", 0.0266)]),
        (
            "f",
            "S2",
            &[
                ("topics", 0.248),
                ("timing", 0.14),
                ("accountable", 0.14),
                ("specific", 0.1054),
                ("tone", 0.0392),
            ],
        ),
        ("b", "S3", &[("hype", -0.27), ("tone", -0.1316), ("hard_sell", -0.10)]),
        (
            "h",
            "S1",
            &[
                ("topics", 0.3392),
                ("specific", 0.1442),
                ("claims_true", 0.10),
                ("timing", 0.07),
                ("tone", 0.0056),
            ],
        ),
    ] {
        let judgement = of(name, id);
        for (term, value) in expected {
            let found = judgement
                .terms
                .iter()
                .find(|score_term| score_term.name == *term)
                .map(|score_term| score_term.value);
            assert!(found.is_some_and(|found| (found - value).abs() < 5e-5), "{name} {id} {term}: {found:?}");
        }
    }
    assert_eq!(of("d", "S3").reason(), "topics +0.40 (api, limits, speed), specific +0.20, tone +0.11");
    assert!(of("e", "S3").reason().starts_with("claims_false -0.55 (limits)"));
}

#[test]
fn true_claims_score_higher_than_false_claims() {
    let lexicon = Lexicon::bundled();
    let [truth, lie] = [true, false]
        .map(|quota_up| judge_all(&post(TECHNICAL_POST), &JudgeContext { quota_up, ..default_context() }));
    for group in Group::all().filter(|group| lexicon.profile(*group).weight("limits") > 0.0) {
        assert!(truth[group.index()].effect > lie[group.index()].effect, "{group}");
    }
}

#[test]
fn insults_never_raise_the_score() {
    for example in examples() {
        let before = judge_all(&example.submission, &example.facts);
        for insult in ["You idiots.", "Shut up.", "Losers."] {
            let content = format!("{} {insult}", example.submission.content);
            let after =
                judge_all(&SubmittedPost { content: &content, ..example.submission.clone() }, &example.facts);
            for (before, after) in before.iter().zip(&after) {
                assert!(after.effect <= before.effect, "{} {} {insult}", example.name, before.group);
            }
        }
    }
}

#[test]
fn group_order_does_not_affect_scores() {
    for example in examples() {
        let forwards = judge_all(&example.submission, &example.facts);
        let mut backwards =
            judge_post(&example.submission, Group::all().rev(), &example.facts, Lexicon::bundled());
        backwards.reverse();
        assert_eq!(forwards, backwards);
    }
}

#[test]
fn repeated_posts_lose_effect() {
    let facts = JudgeContext { quota_up: true, ..default_context() };
    let recipe = [
        "API news: quotas doubled to 300k tokens/day on plan C, webhooks p95 at 180 ms. Docs published today.",
        "For developers: we raised batch limits by 40% today, the SDK endpoint answers at 170 ms p95, docs inside.",
        "More API tokens from Monday: 400k on plan B, throttling cut, endpoint latency down to 160 ms. Benchmarks attached.",
    ];
    let first = effect(&judge_all(&post(recipe[2]), &facts), "S3");
    let earlier = vec![(86, recipe[0]), (93, recipe[1])];
    let third = effect(&judge_all(&SubmittedPost { earlier, ..post(recipe[2]) }, &facts), "S3");
    assert!(third <= 0.9 * first, "{third} after {first}");
}

#[test]
fn keyword_stuffing_does_not_help() {
    let lexicon = Lexicon::bundled();
    let mut stream = Streams::new(16).open(Part::Voice, [0]);
    let lists: Vec<&Vec<WordPattern>> = lexicon.topics.values().chain(lexicon.words.all()).collect();
    let facts = JudgeContext { quota_up: true, ..default_context() };
    let (mut viral, mut judged) = (0, 0);
    for _ in 0..800 {
        let words: Vec<&str> = (0..stream.integer(4, 24))
            .map(|_| {
                let list = lists[stream.index(lists.len())];
                list[stream.index(list.len())].text()
            })
            .collect();
        let judgements = judge_all(&post(&words.join(" ")), &facts);
        assert!(judgements.iter().all(|judgement| (-1.0..=1.0).contains(&judgement.effect)));
        viral += judgements.iter().filter(|judgement| judgement.effect >= 0.6).count();
        judged += judgements.len();
    }
    assert!((viral as f64) < 0.001 * judged as f64, "{viral} of {judged}");
}

#[test]
fn judge_post_accepts_any_text() {
    for content in ["", " ", "\u{1F680}", "ok", "\u{0}\u{ffff}", "$", "#", "%%%", "ÄÖÜ ß İ", "a'b-c"] {
        let judgements = judge_all(&post(content), &default_context());
        assert!(judgements.iter().all(|judgement| (-1.0..=1.0).contains(&judgement.effect)), "{content}");
    }
    assert!(
        judge_all(&post("Good morning!"), &default_context()).iter().all(|judgement| judgement.effect == 0.0)
    );
}

#[test]
fn every_group_has_posts_with_positive_and_negative_effect() {
    #[derive(serde::Deserialize)]
    struct ExamplePosts {
        good: String,
        bad: String,
    }
    let text = include_str!("../../../assets/voice/examples.toml");
    let pairs: std::collections::BTreeMap<String, ExamplePosts> =
        toml::from_str(text).expect("the bundled examples");
    assert_eq!(pairs.len(), Group::COUNT);
    let kept = JudgeContext { quota_up: true, price_cut: true, promotion: true, ..default_context() };
    let broken = JudgeContext { quota_up: false, p95_ms: 500.0, ..context_with_outage() };
    for (id, ExamplePosts { good, bad }) in pairs {
        assert!(good.chars().count() <= 280 && bad.chars().count() <= 280, "{id}");
        let (won, lost) =
            (effect(&judge_all(&post(&good), &kept), &id), effect(&judge_all(&post(&bad), &broken), &id));
        assert!(won >= 0.6, "{id}: {won} for {good}");
        assert!(lost < -0.3, "{id}: {lost} for {bad}");
    }
}

#[test]
fn event_weight_halves_after_a_week() {
    let of = |name: &str| examples().into_iter().find(|example| example.name == name).expect("an example");
    let timing = |example: &Example, event: LiveEvent, age: u32| {
        let facts = JudgeContext { live_events: vec![(event, age)], ..example.facts.clone() };
        let judgements = judge_all(&example.submission, &facts);
        let judgement = &judgements[group("S2").index()];
        judgement.terms.iter().find(|term| term.name == "timing").map_or(0.0, |term| term.value)
    };
    let apology = of("f");
    let fresh = timing(&apology, LiveEvent::Outage, 0);
    assert!(fresh > 0.0);
    for age in 0..=14 {
        let expected = if age <= 7 { fresh } else { fresh / 2.0 };
        let found = timing(&apology, LiveEvent::Outage, age);
        assert!((found - expected).abs() < 1e-12, "day {age}: got {found}, expected {expected}");
    }
    // A cheerful post is penalized if it ignores an outage of the last 7 days or a price increase of the last 14 days.
    let cheerful = Example { submission: post("New feature launch: brainstorm boards are here."), ..of("g") };
    for age in 0..=14 {
        assert_eq!(timing(&cheerful, LiveEvent::Outage, age) < 0.0, age <= 7, "outage of day {age}");
        assert!(timing(&cheerful, LiveEvent::PriceUp, age) < 0.0, "price rise of day {age}");
    }
}
