//! What is known of a group, line by line: plans, sources, money. Every line with a figure can be selected.

use super::model::{Facts, Market, ad_budgets, development_budget};
use crate::console::company::Company;
use crate::console::screens::Figure;
use crate::console::theme::Role;
use crate::console::widgets::spark::bar;
use crate::notation::{cents, compact, dollars, grouped, percent};
use crate::world::identifiers::{Group, Plan};

/// A line.
pub struct Fact {
    /// Words at the left.
    pub words: String,
    /// Figures at the right.
    pub figures: String,
    /// Meaning.
    pub role: Role,
    /// The figure it shows; none for a head.
    pub figure: Option<Figure>,
}

fn head(words: &str, figures: String) -> Fact {
    Fact { words: words.to_owned(), figures, role: Role::Header, figure: None }
}

fn fact(words: String, figures: String, title: String, term: &'static str, sql: Option<String>) -> Fact {
    Fact { words, figures, role: Role::Text, figure: Some(Figure { title, term, sql }) }
}

/// The lines of a group; bars have so many cells.
pub fn facts(company: &Company, market: &Market, facts: &Facts, group: Group, bars: usize) -> Vec<Fact> {
    // A small window has room for the parts that change most; money comes last.
    let mut lines = companies(company, group);
    lines.extend(plans(facts, group, bars));
    lines.extend(sources(company, facts, group));
    lines.extend(money(company, market, facts, group));
    lines
}

/// The way of companies to a deal.
fn companies(company: &Company, group: Group) -> Vec<Fact> {
    let Some(funnel) = company.funnels.iter().find(|funnel| funnel.group == group) else { return Vec::new() };
    let asked = "SELECT DISTINCT c.customer_id, c.created_day, t.day AS asked_day, t.seat_count\nFROM customers c\n\
                 JOIN enterprise_turns t ON t.customer_id = c.customer_id AND t.turn_number = 0 AND t.thread_type = 'new_lead'";
    let came = format!(
        "SELECT customer_id, created_day, acquisition_source FROM customers\nWHERE group_id = '{group}' AND customer_type = \
         'large'\nORDER BY customer_id DESC"
    );
    let of_group = format!("\nWHERE c.group_id = '{group}'");
    let mut lines = vec![head("companies, whole run", String::new())];
    for (name, count, sql) in [
        ("came", funnel.came, came.clone()),
        ("no plan good enough", funnel.turned_away(), came),
        ("asked for an offer", funnel.asked, format!("{asked}{of_group}")),
        (
            "signed",
            funnel.signed,
            format!(
                "SELECT c.customer_id, t.day, t.offer_json, t.seat_count\nFROM customers c\nJOIN enterprise_turns t ON \
                 t.customer_id = c.customer_id AND t.thread_type = 'new_lead' AND t.close_reason = 'accepted' AND t.sender = \
                 'customer'{of_group}"
            ),
        ),
    ] {
        let title = format!("companies of {group}: {name}");
        lines.push(fact(format!("  {name}"), grouped(f64::from(count), 0), title, "lead", Some(sql)));
    }
    lines
}

fn plans(facts: &Facts, group: Group, bars: usize) -> Vec<Fact> {
    let customers = facts.sum(|held| held.customers).max(1.0);
    let line = |(plan, held): (&Plan, &super::model::Held)| {
        let share = held.customers / customers;
        let figures = format!("{:>9} {:>6}", grouped(held.customers, 0), percent(share, 0));
        let sql = format!(
            "SELECT s.customer_id, s.plan, s.seat_count, s.effective_price, s.start_day\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n    \
             AND s.status = 'subscribed' AND s.plan = '{plan}'"
        );
        let title = format!("customers of {group} on plan {plan}");
        fact(format!("  {plan} {}", bar(share, bars)), figures, title, "plan", Some(sql))
    };
    let mut lines = vec![head("plans now", String::new())];
    lines.extend(Plan::ALL.iter().zip(&facts.plans).map(line));
    lines
}

fn sources(company: &Company, facts: &Facts, group: Group) -> Vec<Fact> {
    let heads = format!("{:>6}{:>6}{:>6}", "leads", "share", "conv.");
    let mut lines = vec![head("sources, 12 weeks", heads)];
    let mut sources: Vec<_> = facts.sources.iter().collect();
    sources.sort_by(|left, right| right.1.0.total_cmp(&left.1.0));
    let leads = sources.iter().map(|(_, (leads, _))| leads).sum::<f64>().max(1.0);
    for (source, (own, signed)) in sources {
        let conversion = if *own > 0.0 { percent(signed / own, 0) } else { "–".to_owned() };
        let share = percent(own / leads, 0);
        let figures = format!("{:>6}{share:>6}{conversion:>6}", compact(*own));
        let sql = format!(
            "SELECT c.customer_id, c.created_day, s.plan, s.status, s.start_day, s.end_day\nFROM customers c\n\
             JOIN subscriptions s ON s.customer_id = c.customer_id\nWHERE c.group_id = '{group}'\n    \
             AND c.acquisition_source = '{source}' AND c.created_day > {}",
            i64::from(company.seen.day) - 84
        );
        let title = format!("leads of {group} from {source} in twelve weeks");
        lines.push(fact(format!("  {source}"), figures, title, "acquisition-source", Some(sql)));
    }
    lines
}

fn money(company: &Company, market: &Market, facts: &Facts, group: Group) -> Vec<Fact> {
    let or_none = |value: Option<f64>, write: fn(f64) -> String| value.map_or("–".to_owned(), write);
    let mut lines = vec![head("money", String::new())];
    if let Some(quality) = company.quality.iter().find(|quality| quality.group == group) {
        let [a, b, c] = quality.by_plan.0;
        let title = format!("delivered quality of {group}");
        let figures = format!("{a:.2} {b:.2} {c:.2}");
        lines.push(fact("  quality A B C".to_owned(), figures, title, "delivered-quality", None));
    }
    let spend = format!(
        "SELECT day, channel_id, leads_generated, spend\nFROM ad_channel_leads\nWHERE group_id = '{group}' AND day > {}\n\
         ORDER BY day DESC",
        i64::from(company.seen.day) - 28
    );
    let revenue = super::columns::figure_named("billed/mo", group, company);
    let churn = super::columns::figure_named("churn 30d", group, company);
    let rows = |figure: &Option<Figure>| figure.as_ref().and_then(|figure| figure.sql.clone());
    for (name, value, term, sql) in [
        ("revenue a month", dollars(facts.sum(|held| held.monthly)), "mrr", rows(&revenue)),
        ("per seat", or_none(facts.revenue_per_seat(), cents), "arpu", rows(&revenue)),
        ("left in 30 days", or_none(facts.churn(), |share| percent(share, 1)), "churn", rows(&churn)),
        ("ads a day", dollars(ad_budgets(company, group)), "set_targeted_ad_spend", None),
        ("ads of 28 days", dollars(market.ad_spend(group)), "ad_channel_leads.spend", Some(spend)),
        ("development a day", dollars(development_budget(company, group)), "set_targeted_dev_spend", None),
    ] {
        lines.push(fact(format!("  {name}"), value, format!("{name} of {group}"), term, sql));
    }
    lines
}
