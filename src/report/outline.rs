//! Builds the page of a run report.

mod charts;

use super::formatting::{
    describe_cash_change, describe_origin, describe_runway, format_money, format_whole, pluralize,
};
use super::measures::{BehaviorMeasures, MIN_CHANNEL_LEADS, PLANNING_WORDS};
use super::page::{Bar, Block, NamedValue, Page, Table};
use super::ranking::{ResultOrigin, published_results, published_targeted_share_range};
use super::run_report::{Bankruptcy, RunReport};
use novamind_base::formatting::{capitalize, grouped_number, percent, signed_dollars};
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::{HorizonRule, RecordedModelSettings};

pub fn report_page(report: &RunReport) -> Page {
    let seen = &report.observation;
    let mut blocks = Vec::new();
    if let Some(bankruptcy) = &report.bankruptcy {
        blocks.extend(bankruptcy_blocks(bankruptcy));
    }
    blocks.push(Block::Facts(result_facts(report)));
    blocks.extend(report.database.missing.iter().map(|what| Block::Warning(format!("Not included: {what}"))));
    blocks.push(Block::Heading("Cash"));
    blocks.extend(charts::cash_chart(report));
    blocks.extend(charts::income_and_cost_chart(report));
    if report.shows_published_results() {
        blocks.extend(ranking_blocks(report));
    }
    blocks.extend(highlight_blocks(report));
    blocks.extend(customer_blocks(report));
    blocks.extend(forecast_blocks(report));
    let shares = published_targeted_share_range(seen.generation).filter(|_| report.shows_published_results());
    blocks.extend(behavior_blocks(&report.measures, shares));
    blocks.extend(decision_blocks(report));
    let mut tags = vec![
        format!("run {}", seen.run),
        format!("{} days", format_whole(f64::from(seen.last_day))),
        format!("scenario {}", seen.scenario),
        seen.generation.name().to_owned(),
        format!("{} mode", seen.mode),
    ];
    if seen.horizon_rule != HorizonRule::Exact {
        tags.push(format!("horizon rule {}", seen.horizon_rule.name()));
    }
    tags.extend(seen.seed.map(|seed| format!("seed {seed}")));
    tags.extend(seen.voice.iter().map(RecordedModelSettings::describe));
    tags.extend(report.origin.iter().map(describe_origin));
    tags.extend(seen.participant.iter().map(|who| format!("played by {who}")));
    Page {
        title: format!("NovaMind · run {}", seen.run),
        headline: report.headline(),
        tags,
        blocks,
        footer: format!(
            "Recorded by NovaMind console {}. All figures are visible to players; the run can be replayed to the same \
             state from its trajectory.",
            report.version
        ),
    }
}

fn result_facts(report: &RunReport) -> Vec<NamedValue> {
    let seen = &report.observation;
    let score = match (seen.ended, seen.score) {
        (_, Some(score)) => NamedValue::new("Score", format_money(score), describe_rank(report)),
        (Some(RunEndReason::Abandoned), None) => NamedValue::new("Score", "none", "abandoned"),
        (_, None) => NamedValue::new("Cash", format_money(seen.cash), describe_cash_change(seen)),
    };
    let survival_days = report.measures.survival_days;
    let last_day = format_whole(f64::from(seen.last_day));
    let most = report.weeks.iter().map(|week| week.individual_subscribers).max().unwrap_or(0);
    let seats = report.weeks.iter().map(|week| week.enterprise_seats).max().unwrap_or(0);
    // The runway does not follow from the cash change since the start, so it is shown separately.
    let runway = match seen.ended {
        Some(_) => String::new(),
        None => describe_runway(&seen.runway),
    };
    let change = signed_dollars(seen.cash - report.start_cash);
    vec![
        score,
        NamedValue::new("Days", format_whole(f64::from(survival_days)), format!("of {last_day}")),
        NamedValue::new("Since the start", change, runway),
        NamedValue::new(
            "Subscribers",
            format_whole(f64::from(seen.subscribers)),
            format!("peak {}", format_whole(f64::from(most))),
        ),
        NamedValue::new(
            "Enterprise seats",
            format_whole(f64::from(seen.seats)),
            format!("peak {}", format_whole(f64::from(seats))),
        ),
        NamedValue::new(
            "Recurring revenue",
            format_money(seen.last_week.map_or(0.0, |week| week.recurring_revenue)),
            "a month",
        ),
    ]
}

fn describe_rank(report: &RunReport) -> String {
    match report.ranking.rank {
        Some(rank) => format!("rank {rank} of {}", report.ranking.entries.len()),
        None => String::new(),
    }
}

fn bankruptcy_blocks(bankruptcy: &Bankruptcy) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Bankruptcy")];
    blocks.push(Block::Text(format!(
        "Cash fell below zero on day {}, which ended the run. {}",
        bankruptcy.day,
        bankruptcy.turning_points.join(" ")
    )));
    if !bankruptcy.costs.is_empty() {
        let most = bankruptcy.costs.iter().map(|cost| cost.share).fold(0.0, f64::max);
        blocks.push(Block::Text("Costs by category:".to_owned()));
        let bar = |cost: &super::bankruptcy::CostShare| Bar {
            name: cost.name.to_owned(),
            value_text: format!("{} · {}", format_money(cost.dollars), percent(cost.share, 0)),
            share: cost.share / most,
            is_highlighted: false,
        };
        blocks.push(Block::Bars(bankruptcy.costs.iter().map(bar).collect()));
    }
    blocks
}

fn ranking_blocks(report: &RunReport) -> Vec<Block> {
    let ranking = &report.ranking;
    let most = ranking.entries.iter().map(|place| place.cash).fold(1.0, f64::max);
    let bar = |place: &super::ranking::RankedResult| Bar {
        name: place.name.clone(),
        value_text: describe_place(place),
        share: (place.cash / most).clamp(0.0, 1.0),
        is_highlighted: place.origin == ResultOrigin::ThisRun,
    };
    let text = match ranking.rank {
        Some(_) => {
            format!("{}: final cash, the best of three runs of each agent.", capitalize(&ranking.describe()))
        }
        None if !ranking.obstacles.is_empty() => format!("{}.", capitalize(&ranking.describe())),
        None => "The run has no score to compare. Published results: final cash, the best of three \
                 runs of each agent."
            .to_owned(),
    };
    let mut blocks = vec![Block::Heading("Comparison with published results"), Block::Text(text)];
    if let Some(source) = &ranking.source {
        blocks.push(Block::Bars(ranking.entries.iter().map(bar).collect()));
        blocks.extend(ranking.caveat.clone().map(Block::Note));
        let (generation, all) = (ranking.generation.name(), published_results());
        blocks.push(Block::Note(format!("All results are of {generation}. Source: {source}.")));
        blocks.push(Block::Note(format!("{}.", all.explain_unranked_agents())));
    }
    blocks
}

/// Describes the cash and the last day of a ranked result: `$12,630,078 · 504 days`.
fn describe_place(place: &super::ranking::RankedResult) -> String {
    let days = place.horizon_days.map_or(String::new(), |days| format!(" · {days} days"));
    format!("{}{days}", format_money(place.cash))
}

fn highlight_blocks(report: &RunReport) -> Vec<Block> {
    if report.highlights.is_empty() {
        return Vec::new();
    }
    let row = |one: &super::highlights::Highlight| vec![one.day.to_string(), one.text.clone()];
    vec![
        Block::Heading("Highlights"),
        Block::Table(Table {
            columns: vec![("day", true), ("event", false)],
            rows: report.highlights.iter().map(row).collect(),
        }),
    ]
}

fn customer_blocks(report: &RunReport) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Customers")];
    let before = blocks.len();
    blocks.extend(charts::subscriber_chart(report));
    blocks.extend(charts::group_chart(report));
    if !report.database.groups.is_empty() {
        let row = |book: &super::database_figures::GroupHistory| {
            let now = book.active.last().copied().unwrap_or(0.0);
            let most = book.active.iter().copied().fold(0.0, f64::max);
            let seats = match book.group.is_enterprise() {
                true => format_whole(book.seats.last().copied().unwrap_or(0.0)),
                false => String::new(),
            };
            vec![
                book.group.to_string(),
                format_whole(book.leads),
                format_whole(now),
                format_whole(most),
                seats,
                format_money(book.revenue),
            ]
        };
        blocks.push(Block::Table(Table {
            columns: vec![
                ("group", false),
                ("leads", true),
                ("customers now", true),
                ("peak", true),
                ("seats billed", true),
                ("billed a month", true),
            ],
            rows: report.database.groups.iter().map(row).collect(),
        }));
    }
    if blocks.len() == before {
        blocks.push(Block::Text("No customers yet.".to_owned()));
    }
    blocks
}

fn forecast_blocks(report: &RunReport) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Forecasts")];
    let scored: Vec<_> = report.measures.forecasts.iter().filter(|score| score.scored > 0).collect();
    if scored.is_empty() {
        blocks.push(Block::Text("No forecast has come due yet.".to_owned()));
        return blocks;
    }
    if !report.shows_forecast_scores() {
        let due: u32 = scored.iter().map(|score| score.scored).sum();
        let text =
            format!("{} came due. Scores are shown when the run has ended.", pluralize(due, "forecast"));
        blocks.push(Block::Text(text));
        return blocks;
    }
    let row = |score: &&novamind_session::ForecastScore| {
        vec![
            pluralize(score.horizon_days / 7, "week"),
            score.scored.to_string(),
            percent(f64::from(score.covered) / f64::from(score.scored), 0),
            percent(score.mean_error, 1),
            percent(score.mean_sharpness, 1),
        ]
    };
    blocks.push(Block::Table(Table {
        columns: vec![
            ("horizon", false),
            ("came due", true),
            ("coverage", true),
            ("typical error", true),
            ("interval width", true),
        ],
        rows: scored.iter().map(row).collect(),
    }));
    blocks.push(Block::Note(
        "Coverage: share of 95 % intervals that contain the outcome; the aim is 95 %. Error and width are relative to the outcome."
            .to_owned(),
    ));
    let (naive, all) = report.measures.filled_naively;
    if naive > 0 {
        blocks.push(Block::Note(format!(
            "In {naive} of {}, at least one forecast was naive.",
            pluralize(all, "week")
        )));
    }
    blocks.extend(charts::forecast_charts(report));
    blocks
}

/// Formats leads per thousand dollars, with three decimals below 1 and one decimal otherwise.
fn format_leads_per_thousand(leads: f64) -> String {
    grouped_number(leads, if leads < 1.0 { 3 } else { 1 })
}

fn behavior_blocks(measures: &BehaviorMeasures, published_shares: Option<(f64, f64)>) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Behavior of the player")];
    let none = || "–".to_owned();
    let planning = &measures.planning;
    blocks.push(Block::Facts(vec![
        NamedValue::new(
            "Advertising on the best channel",
            measures
                .channels
                .as_ref()
                .and_then(|skill| skill.share)
                .map_or_else(none, |share| percent(share, 0)),
            format!(
                "of spending on groups with two paid channels and at least {MIN_CHANNEL_LEADS} leads from the best channel"
            ),
        ),
        NamedValue::new(
            "Targeted development",
            measures.targeted_development.map_or_else(none, |share| percent(share, 0)),
            published_shares.map_or(String::new(), |(least, most)| {
                format!("published agents {} to {}", percent(least, 0), percent(most, 0))
            }),
        ),
        NamedValue::new(
            "Calls per week",
            format!("{:.2}", measures.tools.per_week),
            format!("{} in total", format_whole(f64::from(measures.tools.calls))),
        ),
        NamedValue::new(
            "Planning words",
            format!("{:.1}", planning.planning_each),
            format!("per rationale of {}", pluralize(planning.words_each.round() as u32, "word")),
        ),
    ]));
    if let Some(skill) = &measures.channels {
        let row = |ads: &super::measures::GroupAds| {
            let best = ads.best.as_ref();
            vec![
                ads.group.clone(),
                format_money(ads.spend),
                ads.tried.to_string(),
                best.map_or_else(none, |best| best.channel.replace('_', " ")),
                best.map_or_else(none, |best| format_leads_per_thousand(best.leads_per_thousand)),
                best.map_or_else(none, |best| percent(best.share, 0)),
            ]
        };
        blocks.push(Block::Table(Table {
            columns: vec![
                ("group", false),
                ("ad spend", true),
                ("channels tried", true),
                ("best channel", false),
                ("leads per $1,000", true),
                ("share on best", true),
            ],
            rows: skill.groups.iter().map(row).collect(),
        }));
        blocks.push(Block::Note(format!(
            "The best channel has the most leads per dollar among the paid channels. No channel is named if only one was paid, or if the best one brought fewer than {MIN_CHANNEL_LEADS} leads."
        )));
    }
    if !measures.tools.tools.is_empty() {
        let row = |(tool, calls): &(String, u32)| vec![tool.clone(), calls.to_string()];
        blocks.push(Block::Table(Table {
            columns: vec![("tool", false), ("calls", true)],
            rows: measures.tools.tools.iter().take(10).map(row).collect(),
        }));
    }
    blocks.push(Block::Note(format!("Planning words: {}.", PLANNING_WORDS.join(", "))));
    blocks
}

fn decision_blocks(report: &RunReport) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Decisions by week")];
    if report.decision_periods.is_empty() {
        blocks.push(Block::Text("No week has run yet.".to_owned()));
    }
    for chapter in &report.decision_periods {
        let weeks = match chapter.last_week == chapter.week {
            true => format!("Week {}", chapter.week),
            false => format!("Weeks {} to {}", chapter.week, chapter.last_week),
        };
        let title = format!("{weeks} · day {} to {}", chapter.day, chapter.end_day);
        let note = format!("{} → {}", signed_dollars(chapter.cash_change), format_money(chapter.cash));
        let points: Vec<String> = chapter.changes.iter().chain(&chapter.actions).cloned().collect();
        let mut lines = Vec::new();
        if !chapter.rationale.is_empty() {
            lines.push(format!("“{}”", chapter.rationale));
        }
        if points.is_empty() {
            lines.push("No changes.".to_owned());
        }
        blocks.push(Block::Collapsible { title, note, lines, points });
    }
    blocks
}
