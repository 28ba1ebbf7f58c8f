//! Builds the page of a run report.

mod charts;

use super::measures::{ENOUGH_LEADS, Measures, PLANNING_WORDS};
use super::page::{Bar, Block, Fact, Page, Table};
use super::ranking::{Whose, published_targeted_shares};
use super::story::{Ruin, Story};
use super::words::{cash_change_in_words, count, money, origin_in_words, whole};
use novamind_base::notation::{capital, grouped, percent, signed_dollars};
use novamind_record::trajectory::record::Ended;
use novamind_session::ModelStamp;

pub fn page_of(story: &Story) -> Page {
    let seen = &story.seen;
    let mut blocks = Vec::new();
    if let Some(ruin) = &story.ruin {
        blocks.extend(ruined(ruin));
    }
    blocks.push(Block::Facts(result(story)));
    blocks.extend(story.books.missing.iter().map(|what| Block::Warning(format!("Not included: {what}"))));
    blocks.push(Block::Heading("Cash"));
    blocks.extend(charts::cash(story));
    blocks.extend(charts::income_and_costs(story));
    if story.shows_published() {
        blocks.extend(rank(story));
    }
    blocks.extend(highlights(story));
    blocks.extend(customers(story));
    blocks.extend(forecasts(story));
    blocks.extend(behaviour(&story.measures, story.shows_published()));
    blocks.extend(decisions(story));
    let mut tags = vec![
        format!("run {}", seen.run),
        format!("{} days", whole(f64::from(seen.last_day))),
        format!("scenario {}", seen.scenario),
        format!("{} mode", seen.mode),
    ];
    tags.extend(seen.seed.map(|seed| format!("seed {seed}")));
    tags.extend(seen.voice.iter().map(ModelStamp::in_words));
    tags.extend(story.origin.iter().map(origin_in_words));
    tags.extend(seen.participant.iter().map(|who| format!("played by {who}")));
    Page {
        title: format!("NovaMind · run {}", seen.run),
        headline: story.headline(),
        tags,
        blocks,
        foot: format!(
            "Recorded by NovaMind console {}. All figures are visible to players; the run can be replayed to the same \
             state from its trajectory.",
            story.version
        ),
    }
}

fn result(story: &Story) -> Vec<Fact> {
    let seen = &story.seen;
    let score = match (seen.ended, seen.score) {
        (_, Some(score)) => Fact::new("Score", money(score), rank_in_words(story)),
        (Some(Ended::Abandoned), None) => Fact::new("Score", "none", "abandoned"),
        (_, None) => Fact::new("Cash", money(seen.cash), cash_change_in_words(seen)),
    };
    let lived = story.measures.survival_days;
    let last_day = whole(f64::from(seen.last_day));
    let most = story.weeks.iter().map(|week| week.individual_subscribers).max().unwrap_or(0);
    let seats = story.weeks.iter().map(|week| week.enterprise_seats).max().unwrap_or(0);
    // The runway from committed settings and recent weeks' income and usage, not from the change since the start.
    let runway = match (seen.ended, seen.weeks_of_cash()) {
        (Some(_), _) => String::new(),
        (None, None) => "at current costs and income, cash lasts to the last day".to_owned(),
        (None, Some(weeks)) => format!("at current costs and income, cash lasts {}", count(weeks, "week")),
    };
    let change = signed_dollars(seen.cash - story.start_cash);
    vec![
        score,
        Fact::new("Days", whole(f64::from(lived)), format!("of {last_day}")),
        Fact::new("Since the start", change, runway),
        Fact::new(
            "Subscribers",
            whole(f64::from(seen.subscribers)),
            format!("peak {}", whole(f64::from(most))),
        ),
        Fact::new(
            "Enterprise seats",
            whole(f64::from(seen.seats)),
            format!("peak {}", whole(f64::from(seats))),
        ),
        Fact::new(
            "Recurring revenue",
            money(seen.last_week.map_or(0.0, |week| week.recurring_revenue)),
            "a month",
        ),
    ]
}

fn rank_in_words(story: &Story) -> String {
    match story.standing.rank {
        Some(rank) => format!("rank {rank} of {}", story.standing.places.len()),
        None => String::new(),
    }
}

fn ruined(ruin: &Ruin) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("How it ended")];
    blocks.push(Block::Text(format!(
        "Cash fell below zero on day {}, which ended the run. {}",
        ruin.day,
        ruin.turned.join(" ")
    )));
    if !ruin.costs.is_empty() {
        let most = ruin.costs.iter().map(|cost| cost.share).fold(0.0, f64::max);
        blocks.push(Block::Text("Costs by category:".to_owned()));
        let bar = |cost: &super::turn::Cost| Bar {
            name: cost.name.to_owned(),
            shown: format!("{} · {}", money(cost.dollars), percent(cost.share, 0)),
            share: cost.share / most,
            own: false,
        };
        blocks.push(Block::Bars(ruin.costs.iter().map(bar).collect()));
    }
    blocks
}

fn rank(story: &Story) -> Vec<Block> {
    let standing = &story.standing;
    let most = standing.places.iter().map(|place| place.cash).fold(1.0, f64::max);
    let bar = |place: &super::ranking::RankedRun| Bar {
        name: place.name.clone(),
        shown: money(place.cash),
        share: (place.cash / most).clamp(0.0, 1.0),
        own: place.whose == Whose::Own,
    };
    let told = match standing.rank {
        Some(_) => {
            format!("{}: final cash, the best of three runs of each agent.", capital(&standing.in_words()))
        }
        None if !standing.obstacles.is_empty() => format!("{}.", capital(&standing.in_words())),
        None => "The run has no score to compare. Published results: final cash, the best of three \
                 runs of each agent."
            .to_owned(),
    };
    let mut blocks = vec![
        Block::Heading("Comparison with published results"),
        Block::Text(told),
        Block::Bars(standing.places.iter().map(bar).collect()),
    ];
    blocks.extend(standing.caveat.clone().map(Block::Note));
    blocks.push(Block::Note(format!("Source: {}.", standing.source)));
    blocks
}

fn highlights(story: &Story) -> Vec<Block> {
    if story.highlights.is_empty() {
        return Vec::new();
    }
    let row = |one: &super::highlights::Highlight| vec![one.day.to_string(), one.text.clone()];
    vec![
        Block::Heading("Highlights"),
        Block::Table(Table {
            columns: vec![("day", true), ("event", false)],
            rows: story.highlights.iter().map(row).collect(),
        }),
    ]
}

fn customers(story: &Story) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Customers")];
    let before = blocks.len();
    blocks.extend(charts::people(story));
    blocks.extend(charts::groups(story));
    if !story.books.groups.is_empty() {
        let row = |book: &super::books::GroupBook| {
            let now = book.active.last().copied().unwrap_or(0.0);
            let most = book.active.iter().copied().fold(0.0, f64::max);
            let seats = match book.group.is_enterprise() {
                true => whole(book.seats.last().copied().unwrap_or(0.0)),
                false => String::new(),
            };
            vec![
                book.group.to_string(),
                whole(book.leads),
                whole(now),
                whole(most),
                seats,
                money(book.revenue),
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
            rows: story.books.groups.iter().map(row).collect(),
        }));
    }
    if blocks.len() == before {
        blocks.push(Block::Text("No customers yet.".to_owned()));
    }
    blocks
}

fn forecasts(story: &Story) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Forecasts")];
    let scored: Vec<_> = story.measures.forecasts.iter().filter(|score| score.scored > 0).collect();
    if scored.is_empty() {
        blocks.push(Block::Text("No forecast has come due yet.".to_owned()));
        return blocks;
    }
    if !story.shows_calibration() {
        let due: u32 = scored.iter().map(|score| score.scored).sum();
        let text = format!("{} came due. Scores are shown when the run has ended.", count(due, "forecast"));
        blocks.push(Block::Text(text));
        return blocks;
    }
    let row = |score: &&novamind_session::ForecastScore| {
        vec![
            count(score.horizon_days / 7, "week"),
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
    let (naive, all) = story.measures.filled_naively;
    if naive > 0 {
        blocks.push(Block::Note(format!(
            "In {naive} of {}, at least one forecast was naive.",
            count(all, "week")
        )));
    }
    blocks.extend(charts::forecasts(story));
    blocks
}

/// Formats leads per thousand dollars; small values keep decimals.
fn per_thousand(leads: f64) -> String {
    grouped(leads, if leads < 1.0 { 3 } else { 1 })
}

fn behaviour(measures: &Measures, published: bool) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("How it was played")];
    let none = || "–".to_owned();
    let (least, most) = published_targeted_shares();
    let planning = &measures.planning;
    blocks.push(Block::Facts(vec![
        Fact::new(
            "Advertising on the best channel",
            measures
                .channels
                .as_ref()
                .and_then(|skill| skill.share)
                .map_or_else(none, |share| percent(share, 0)),
            format!(
                "of spending on groups with two paid channels and at least {ENOUGH_LEADS} leads from the best"
            ),
        ),
        Fact::new(
            "Targeted development",
            measures.targeted_development.map_or_else(none, |share| percent(share, 0)),
            match published {
                true => format!("published agents {} to {}", percent(least, 0), percent(most, 0)),
                false => String::new(),
            },
        ),
        Fact::new(
            "Calls per week",
            format!("{:.2}", measures.tools.per_week),
            format!("{} in total", whole(f64::from(measures.tools.calls))),
        ),
        Fact::new(
            "Planning words",
            format!("{:.1}", planning.planning_each),
            format!("per rationale of {:.0} words", planning.words_each),
        ),
    ]));
    if let Some(skill) = &measures.channels {
        let row = |ads: &super::measures::GroupAds| {
            let best = ads.best.as_ref();
            vec![
                ads.group.clone(),
                money(ads.spend),
                ads.tried.to_string(),
                best.map_or_else(none, |best| best.channel.replace('_', " ")),
                best.map_or_else(none, |best| per_thousand(best.leads_per_thousand)),
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
            "The best channel has the most leads per dollar among the paid channels. None is named if \
                 only one was paid, or if the best brought fewer than {ENOUGH_LEADS} leads."
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

fn decisions(story: &Story) -> Vec<Block> {
    let mut blocks = vec![Block::Heading("Decisions by week")];
    if story.chapters.is_empty() {
        blocks.push(Block::Text("No week has run yet.".to_owned()));
    }
    for chapter in &story.chapters {
        let weeks = match chapter.last_week == chapter.week {
            true => format!("Week {}", chapter.week),
            false => format!("Weeks {} to {}", chapter.week, chapter.last_week),
        };
        let title = format!("{weeks} · day {} to {}", chapter.day, chapter.until);
        let note = format!("{} → {}", signed_dollars(chapter.cash_change), money(chapter.cash));
        let points: Vec<String> = chapter.changes.iter().chain(&chapter.deeds).cloned().collect();
        let mut lines = Vec::new();
        if !chapter.why.is_empty() {
            lines.push(format!("“{}”", chapter.why));
        }
        if points.is_empty() {
            lines.push("No changes.".to_owned());
        }
        blocks.push(Block::Folded { title, note, lines, points });
    }
    blocks
}
