//! A group opened: its weeks, plans and sources, and the way to its tools.

use ratatui::layout::{Constraint, Layout, Rect};

use super::model::{Facts, Flow, Market, ad_budgets, development_budget};
use crate::console::canvas::{Align, Canvas, Click, rows_of};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::screens::{Look, ScreenId};
use crate::console::theme::Role;
use crate::console::widgets::spark::bar;
use crate::console::widgets::{Axis, Line, chart};
use crate::notation::{cents, compact, dollars, grouped, percent};
use crate::world::identifiers::{Group, Plan};

/// Tools of a group, and what they do for it.
pub const TOOLS: [(&str, &str); 6] = [
    ("set_targeted_ad_spend", "advertising"),
    ("set_targeted_dev_spend", "development"),
    ("set_targeted_ops_spend", "support"),
    ("set_promotion", "discounts"),
    ("set_lead_promotion", "discounts for leads"),
    ("set_ads_strength", "ads shown"),
];

/// Ways that are no tools: the insight report, and the customers themselves.
const WAYS: [(&str, &str); 2] = [("Market", "its insight report"), ("SQL", "its customers by plan")];

/// Number of things that can be chosen: the tools and the other ways.
pub const CHOICES: usize = TOOLS.len() + WAYS.len();

/// What a choice leads to.
pub fn choose(choice: usize, group: Group) -> Effect {
    match TOOLS.get(choice) {
        Some((tool, _)) => Effect::ShowTool(tool),
        None if choice == TOOLS.len() => Effect::ShowGroup(ScreenId::Market, group),
        None => Effect::EditSql(format!(
            "-- customers of {group}\nSELECT s.plan, s.status, count(*) AS customers, \
             round(avg(s.effective_price), 2) AS price\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n\
             GROUP BY 1, 2\nORDER BY 1, 2"
        )),
    }
}

/// Draws a group into the whole screen; the choice is none for a preview.
pub fn draw(
    canvas: &mut Canvas<'_>,
    area: Rect,
    look: &Look<'_>,
    market: &Market,
    group: Group,
    choice: Option<usize>,
) {
    let facts = market.of(group);
    let right = if choice.is_some() { 42.min(area.width / 2) } else { 46.min(area.width / 2) };
    let [curves, side] = Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
    draw_curves(canvas, curves, look.company, &facts, group);
    match choice {
        Some(choice) => {
            let [about, tools] =
                Layout::vertical([Constraint::Min(0), Constraint::Length(CHOICES as u16 + 2)]).areas(side);
            draw_facts(canvas, about, look.company, market, &facts, group);
            draw_choices(canvas, tools, choice);
        }
        None => draw_facts(canvas, side, look.company, market, &facts, group),
    }
}

fn draw_curves(canvas: &mut Canvas<'_>, area: Rect, company: &Company, facts: &Facts, group: Group) {
    let words = if group.is_enterprise() { "accounts" } else { "subscribers" };
    let now = grouped(facts.sum(|held| held.customers), 0);
    let week = company.seen.week;
    let points =
        |values: Vec<(u32, f64)>| values.iter().map(|(at, value)| (f64::from(*at), *value)).collect();
    let x = Axis { write: &|week| format!("week {week:.0}"), holds: &[] };
    let y = Axis { write: &compact, holds: &[0.0] };
    let [stock, flows] = Layout::vertical([Constraint::Percentage(50), Constraint::Min(0)]).areas(area);
    let inside = canvas.pane(stock, &format!("{group} {words}"), &format!("{now} now"), false);
    chart(canvas, inside, &[Line::through(points(facts.stock(week)), Role::Series(0))], &x, &y);
    let trend = |figure: fn(&Flow) -> f64| points(facts.trend(week, figure));
    let inside = canvas.pane(flows, "Leads, new and cancelled by week", &flow_words(facts, week), false);
    let lines = [
        Line::through(trend(|flow| flow.leads), Role::Series(2)),
        Line::through(trend(|flow| flow.signed), Role::Good),
        Line { scattered: true, ..Line::through(trend(|flow| flow.cancelled), Role::Bad) },
    ];
    chart(canvas, inside, &lines, &x, &y);
}

fn flow_words(facts: &Facts, week: u32) -> String {
    let flow = facts.week(week);
    let whole = |value: f64| grouped(value, 0);
    format!("{} leads · +{} · -{}", whole(flow.leads), whole(flow.signed), whole(flow.cancelled))
}

/// A line of the facts: words, bar, figure.
type Fact = (String, String, Role);

fn draw_facts(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &Company,
    market: &Market,
    facts: &Facts,
    group: Group,
) {
    let segment = if group.is_enterprise() { "enterprise" } else { "individual" };
    let inside = canvas.pane(area, &format!("{group} · {segment}"), "", false);
    let bars = (inside.width as usize).saturating_sub(32).min(16);
    let mut lines: Vec<Fact> = Vec::new();
    let head = |words: &str| (words.to_owned(), String::new(), Role::Header);
    // A small window has room for the parts that change most; money comes last.
    lines.push(head("plans now"));
    let customers = facts.sum(|held| held.customers).max(1.0);
    for (plan, held) in Plan::ALL.iter().zip(&facts.plans) {
        let share = held.customers / customers;
        let figures = format!("{:>9} {:>6}", grouped(held.customers, 0), percent(share, 0));
        lines.push((format!("  {plan} {}", bar(share, bars)), figures, Role::Text));
    }
    let heads = format!("{:>8} {:>5} {:>6}", "leads", "share", "conv.");
    lines.push(("sources, 12 weeks".to_owned(), heads, Role::Header));
    let mut sources: Vec<_> = facts.sources.iter().collect();
    sources.sort_by(|left, right| right.1.0.total_cmp(&left.1.0));
    let leads = sources.iter().map(|(_, (leads, _))| leads).sum::<f64>().max(1.0);
    for (source, (own, signed)) in sources {
        let conversion = if *own > 0.0 { percent(signed / own, 0) } else { "–".to_owned() };
        let share = percent(own / leads, 0);
        let figures = format!("{:>8} {share:>5} {conversion:>6}", compact(*own));
        lines.push((format!("  {source}"), figures, Role::Text));
    }
    lines.push(head("money"));
    let or_none = |value: Option<f64>, write: fn(f64) -> String| value.map_or("–".to_owned(), write);
    let quality = company.quality.iter().find(|quality| quality.group == group);
    if let Some(quality) = quality {
        let [a, b, c] = quality.by_plan.0;
        lines.push(("  quality A B C".to_owned(), format!("{a:.2} {b:.2} {c:.2}"), Role::Text));
    }
    for (name, value) in [
        ("  revenue a month", dollars(facts.sum(|held| held.monthly))),
        ("  per seat", or_none(facts.revenue_per_seat(), cents)),
        ("  left in 30 days", or_none(facts.churn(), |share| percent(share, 1))),
        ("  ads a day", dollars(ad_budgets(company, group))),
        ("  ads of 28 days", dollars(market.ad_spend(group))),
        ("  development a day", dollars(development_budget(company, group))),
    ] {
        lines.push((name.to_owned(), value, Role::Text));
    }
    for (row, (words, figures, role)) in rows_of(inside).zip(&lines) {
        canvas.text(row, words, *role);
        canvas.aligned(row, figures, *role, Align::Right);
    }
}

fn draw_choices(canvas: &mut Canvas<'_>, area: Rect, choice: usize) {
    let inside = canvas.pane(area, "Go to", "", true);
    for (at, row) in rows_of(inside).enumerate().take(CHOICES) {
        let role = if at == choice { Role::Selection } else { Role::Text };
        canvas.clear(row, role);
        let (name, purpose) = TOOLS.iter().chain(&WAYS).nth(at).copied().unwrap_or_default();
        canvas.text(row, name, role);
        let purpose_role = if at == choice { role } else { Role::Dim };
        let place = Rect { x: row.x + 23, width: row.width.saturating_sub(23), ..row };
        canvas.aligned(place, purpose, purpose_role, Align::Right);
        canvas.click(row, Click::Row(0, at));
    }
}
