//! Known facts about a group: plans, acquisition sources and money. Every line with a figure can be selected.

use ratatui::layout::Rect;

use super::Customers;
use super::model::{GroupFacts, CustomerData, total_ad_budget, development_budget};
use super::selection::show_rows_effect;
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::market::model::group_name;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{dollars_and_cents, compact_number, dollars, grouped_number, percent, quality as format_quality};
use novamind_session::identifiers::{Group, Plan};
use novamind_session::Source;
use novamind_tui::canvas::{Align, Canvas, Click, row_rects};
use novamind_tui::text::first_fitting;
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline::bar;
use novamind_worker::company::DisplayedCompany;

pub struct FactsPane;

impl FactsPane {
    fn lines(&self, customers: &Customers, context: &ScreenContext<'_>, bars: usize) -> Vec<FactLine> {
        customers.group(context.company).map_or(Vec::new(), |group| {
            fact_lines(context.company, &customers.data, &customers.data.facts_of_group(group), group, bars)
        })
    }
}

impl Pane<Customers> for FactsPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, context: &ScreenContext<'_>) -> Option<Figure> {
        self.lines(customers, context, 0).into_iter().nth(customers.group_state.fact_line)?.figure
    }

    /// Moves to the next line with a figure.
    fn handle_action(&self, customers: &mut Customers, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return show_rows_effect(self.figure(customers, context));
        }
        let lines = self.lines(customers, context, 0);
        let selectable_lines: Vec<usize> = (0..lines.len()).filter(|at| lines[*at].figure.is_some()).collect();
        let fact = &mut customers.group_state.fact_line;
        let place = selectable_lines.iter().position(|at| *at >= *fact).unwrap_or(0);
        let place = match action {
            Action::Up => place.saturating_sub(1),
            Action::Down if selectable_lines.get(place) == Some(fact) => place + 1,
            Action::PageUp => place.saturating_sub(context.page_rows.into()),
            Action::PageDown => place + usize::from(context.page_rows),
            Action::First => 0,
            Action::Last => selectable_lines.len(),
            _ => place,
        };
        *fact = selectable_lines.get(place.min(selectable_lines.len().saturating_sub(1))).copied().unwrap_or(0);
        Vec::new()
    }

    fn handle_click(&self, customers: &mut Customers, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        customers.group_state.fact_line = row;
        Vec::new()
    }

    fn border(&self, customers: &Customers, area: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        customers.group(context.company).map_or_else(PaneBorder::default, |group| {
            let segment = if group.is_enterprise() { "enterprise" } else { "individual" };
            let name = group_name(context.company, group);
            let wordings = [
                format!("{group} · {name} · {segment}"),
                format!("{group} · {name}"),
                format!("{group} · {segment}"),
            ];
            let title = first_fitting(wordings, usize::from(area.width.saturating_sub(6)));
            PaneBorder { title, ..PaneBorder::default() }
        })
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let selected = placement.focused.then_some(customers.group_state.fact_line);
        let bars = (placement.area.width as usize).saturating_sub(32).min(16);
        let lines = self.lines(customers, context, bars);
        let from = canvas.scroll_to_row(placement.area, selected.unwrap_or(0), lines.len());
        for (row, (at, fact)) in row_rects(placement.area).zip(lines.iter().enumerate().skip(from)) {
            let here = selected == Some(at) && fact.figure.is_some();
            let role = if here { Role::Selection } else { fact.role };
            if here {
                canvas.clear(row, role);
            }
            canvas.draw_text(row, &fact.label, role);
            canvas.draw_aligned(row, &fact.value, role, Align::Right);
            canvas.register_click(row, Click::Row(placement.index, at));
        }
    }
}

struct FactLine {
    label: String,
    value: String,
    role: Role,
    /// The figure on the line, or `None` for a heading.
    figure: Option<Figure>,
}

fn heading_line(words: &str, figures: String) -> FactLine {
    FactLine { label: words.to_owned(), value: figures, role: Role::Header, figure: None }
}

fn figure_line(words: String, figures: String, title: String, term: &'static str, sql: Option<String>) -> FactLine {
    FactLine { label: words, value: figures, role: Role::Text, figure: Some(Figure { title, term, sql, week_quantity: None }) }
}

/// Returns the lines of facts about a group. Bars are `bars` cells wide.
fn fact_lines(
    company: &DisplayedCompany,
    market: &CustomerData,
    facts: &GroupFacts,
    group: Group,
    bars: usize,
) -> Vec<FactLine> {
    // Money is last, because small windows cut off the last lines and money changes least.
    let mut lines = enterprise_lines(company, group);
    lines.extend(plan_lines(facts, group, bars));
    lines.extend(source_lines(company, facts, group));
    lines.extend(money_lines(company, market, facts, group));
    lines
}

/// Returns the funnel of enterprises from lead to deal.
fn enterprise_lines(company: &DisplayedCompany, group: Group) -> Vec<FactLine> {
    let Some(funnel) = company.funnels.iter().find(|funnel| funnel.group == group) else { return Vec::new() };
    let asked = "SELECT DISTINCT c.customer_id, c.created_day, t.day AS asked_day, t.seat_count\nFROM customers c\n\
                 JOIN enterprise_turns t ON t.customer_id = c.customer_id AND t.turn_number = 0 AND t.thread_type = 'new_lead'";
    let arrivals_sql = format!(
        "SELECT customer_id, created_day, acquisition_source FROM customers\nWHERE group_id = '{group}' AND customer_type = \
         'large'\nORDER BY customer_id DESC"
    );
    let group_filter = format!("\nWHERE c.group_id = '{group}'");
    let mut lines = vec![heading_line("enterprises, whole run", String::new())];
    for (name, count, sql) in [
        ("arrived", funnel.enterprises, arrivals_sql.clone()),
        ("no suitable plan", funnel.lost_before_request(), arrivals_sql),
        ("requested an offer", funnel.requests, format!("{asked}{group_filter}")),
        (
            "signed",
            funnel.deals,
            format!(
                "SELECT c.customer_id, t.day, t.offer_json, t.seat_count\nFROM customers c\nJOIN enterprise_turns t ON \
                 t.customer_id = c.customer_id AND t.thread_type = 'new_lead' AND t.close_reason = 'accepted' AND t.sender = \
                 'customer'{group_filter}"
            ),
        ),
    ] {
        let title = format!("{group}, enterprises: {name}");
        lines.push(figure_line(format!("  {name}"), grouped_number(f64::from(count), 0), title, "lead", Some(sql)));
    }
    lines
}

fn plan_lines(facts: &GroupFacts, group: Group, bars: usize) -> Vec<FactLine> {
    let customers = facts.sum(|plan_subscribers| plan_subscribers.customers).max(1.0);
    let line = |(plan, subscribers): (&Plan, &super::model::PlanSubscribers)| {
        let share = subscribers.customers / customers;
        let figures = format!("{:>9} {:>6}", grouped_number(subscribers.customers, 0), percent(share, 1));
        let sql = format!(
            "SELECT s.customer_id, s.plan, s.seat_count, s.effective_price, s.start_day\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n    \
             AND s.status = 'subscribed' AND s.plan = '{plan}'"
        );
        let title = format!("customers of {group} on plan {plan}");
        figure_line(format!("  {plan} {}", bar(share, bars)), figures, title, "plan", Some(sql))
    };
    let mut lines = vec![heading_line("current plans", String::new())];
    lines.extend(Plan::ALL.iter().zip(&facts.plans).map(line));
    lines
}

fn source_lines(company: &DisplayedCompany, facts: &GroupFacts, group: Group) -> Vec<FactLine> {
    let heads = format!("{:>6}{:>7}{:>7}", "leads", "share", "conv.");
    let mut lines = vec![heading_line("sources, 12 weeks", heads)];
    let mut sources: Vec<_> = facts.sources.iter().collect();
    sources.sort_by(|left, right| right.1.0.total_cmp(&left.1.0));
    let leads = sources.iter().map(|(_, (leads, _))| leads).sum::<f64>().max(1.0);
    for (source, (value, signed)) in sources {
        let conversion = if *value > 0.0 { percent(signed / value, 1) } else { "–".to_owned() };
        let share = percent(value / leads, 1);
        let figures = format!("{:>6}{share:>7}{conversion:>7}", compact_number(*value));
        let sql = format!(
            "SELECT c.customer_id, c.created_day, s.plan, s.status, s.start_day, s.end_day\nFROM customers c\n\
             LEFT JOIN subscriptions s ON s.customer_id = c.customer_id\nWHERE c.group_id = '{group}'\n    \
             AND c.acquisition_source = '{source}' AND c.created_day > {}",
            i64::from(company.observation.day) - 84
        );
        let named = Source::ALL.into_iter().find(|known| known.id() == source);
        let source = match named {
            Some(known) => known.name(),
            None => source.as_str(),
        };
        let title = format!("leads of {group} from {source} in the last 12 weeks");
        lines.push(figure_line(format!("  {source}"), figures, title, "acquisition-source", Some(sql)));
    }
    lines
}

fn money_lines(company: &DisplayedCompany, market: &CustomerData, facts: &GroupFacts, group: Group) -> Vec<FactLine> {
    let or_none = |value: Option<f64>, write: fn(f64) -> String| value.map_or("–".to_owned(), write);
    let mut lines = vec![heading_line("money", String::new())];
    if let Some(quality) = company.quality.iter().find(|quality| quality.group == group) {
        let [a, b, c] = quality.by_plan.0.map(format_quality);
        let title = format!("delivered quality of {group}");
        let figures = format!("{a} {b} {c}");
        lines.push(figure_line("  quality A B C".to_owned(), figures, title, "delivered-quality", None));
    }
    let spend = format!(
        "SELECT day, channel_id, leads_generated, spend\nFROM ad_channel_leads\nWHERE group_id = '{group}' AND day > {}\n\
         ORDER BY day DESC",
        i64::from(company.observation.day) - 28
    );
    let revenue = super::columns::figure_with_heading("billed/mo", group, company);
    let churn = super::columns::figure_with_heading("churn 30d", group, company);
    let explained = churn.as_ref().and_then(|figure| figure.week_quantity);
    let rows = |figure: &Option<Figure>| figure.as_ref().and_then(|figure| figure.sql.clone());
    for (name, value, term, sql) in [
        ("revenue per month", dollars(facts.sum(|plan_subscribers| plan_subscribers.monthly_revenue)), "mrr", rows(&revenue)),
        (
            if group.is_enterprise() { "revenue per seat" } else { "revenue per subscriber" },
            or_none(facts.revenue_per_seat(), dollars_and_cents),
            "arpu",
            rows(&revenue),
        ),
        ("30-day churn", or_none(facts.churn(), |share| percent(share, 1)), "churn", rows(&churn)),
        ("ad budget per day", dollars(total_ad_budget(company, group)), "set_targeted_ad_spend", None),
        ("ad spend, 28 days", dollars(market.ad_spend(group)), "ad_channel_leads.spend", Some(spend)),
        ("targeted development", format!("{} a day", dollars(development_budget(company, group))), "set_targeted_dev_spend", None),
    ] {
        lines.push(figure_line(format!("  {name}"), value, format!("{group}: {name}"), term, sql));
        // The churn line has the same query as the churn column.
        if let Some(FactLine { figure: Some(figure), .. }) = lines.last_mut().filter(|_| term == "churn") {
            figure.week_quantity = explained;
        }
    }
    lines
}
