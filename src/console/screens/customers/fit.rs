//! Fit of the open group: estimated requirements next to each plan, leads, and what is missing.

use ratatui::layout::Rect;

use super::Customers;
use super::steps::{moved, show_rows};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{compact, percent, price_to_cents};
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_report::fit::{Beside, Concern, Fit, TruthRange};
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::{number, wrapped};
use novamind_tui::theme::Role;

const NAMES: usize = 8;

pub struct FitPane;

impl Pane<Customers> for FitPane {
    fn hints(&self, _: &Customers) -> Vec<Action> {
        vec![Action::Open, Action::FocusNext, Action::Close]
    }

    fn figure(&self, customers: &Customers, look: &Look<'_>) -> Option<Figure> {
        let group = customers.group(look.company)?;
        let sql = format!(
            "SELECT (c.created_day + 6) / 7 AS week, c.acquisition_source = 'network' AS by_word_of_mouth, count(*) AS \
             leads,\n    total(s.status IN ('subscribed', 'cancelled')) AS signed\nFROM customers c\nLEFT JOIN subscriptions s \
             ON s.customer_id = c.customer_id\nWHERE c.group_id = '{group}'\nGROUP BY 1, 2\nORDER BY 1 DESC, 2"
        );
        let title = format!("fit of {group} and its leads by week");
        // Enterprises sign weeks after they arrive.
        let quantity =
            WeekQuantity::of_group(WeekFigure::Conversion, group).filter(|_| !group.is_enterprise());
        let figure = Figure { title, term: "fit", sql: Some(sql), why: None };
        Some(figure.of_week(quantity, look.company.seen.week))
    }

    fn act(&self, customers: &mut Customers, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return show_rows(self.figure(customers, look));
        }
        customers.opened.fit_line = moved(customers.opened.fit_line, usize::MAX - 1, action);
        Vec::new()
    }

    fn border(&self, customers: &Customers, _: Rect, look: &Look<'_>) -> Border {
        let fit = customers.group(look.company).and_then(|group| look.company.fit(group));
        fit.map_or_else(Border::default, |fit| Border {
            title: format!("Fit of {}", fit.group),
            note: format!("study level {} · {}", fit.level, fit.studied()),
            ..Border::default()
        })
    }

    fn draw(&self, customers: &Customers, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let company = look.company;
        let Some(fit) = customers.group(company).and_then(|group| company.fit(group)) else { return };
        let tier = |plan: Plan| number(company.setting(ToolId::SetModelTiers, plan.id()));
        let lines = lines(fit, seat.area.width as usize, &tier);
        let last = lines.len().saturating_sub(seat.area.height as usize);
        let from = if seat.focused { customers.opened.fit_line.min(last) } else { 0 };
        for (row, line) in rows_of(seat.area).zip(&lines[from..]) {
            canvas.text(row, &line.text, line.role);
        }
    }
}

struct FitLine {
    text: String,
    role: Role,
}

fn line(text: String, role: Role) -> FitLine {
    FitLine { text, role }
}

/// Returns all lines of the pane, at most `width` columns wide.
fn lines(fit: &Fit, width: usize, tier: &dyn Fn(Plan) -> String) -> Vec<FitLine> {
    let company = fit.group.is_enterprise();
    let mut lines = vec![line(format!("quality  required {}", fit.floor.quality()), Role::Header)];
    let qualities = Plan::ALL.map(|plan| fit.plans[plan].quality);
    lines.extend(Plan::ALL.map(|plan| {
        let name = format!("T{}", tier(plan));
        let shown = format!("{:.4}", fit.plans[plan].quality);
        bar_line(fit, (plan, Concern::Quality), (&name, &shown), (fit.floor, &qualities), width)
    }));
    let per = if company { " a seat" } else { "" };
    lines.push(line(format!("price    budget {}{per}", fit.budget.money()), Role::Header));
    let prices = Plan::ALL.map(|plan| fit.plans[plan].price);
    lines.extend(Plan::ALL.map(|plan| {
        let own = &fit.plans[plan];
        let name = if own.price < own.list { "lead" } else { "list" };
        bar_line(
            fit,
            (plan, Concern::Price),
            (name, &price_to_cents(own.price)),
            (fit.budget, &prices),
            width,
        )
    }));
    let smallest = if company { " (smallest)" } else { "" };
    lines.push(line(format!("quota    typical use {} a day{smallest}", fit.usage.units()), Role::Header));
    let quotas = Plan::ALL.map(|plan| format!("{plan} {}", compact(fit.plans[plan].quota)));
    lines.push(line(format!(" {} a day", quotas.join(" · ")), worst(fit, Concern::Quota)));
    let mut told = |name: &str, text: &str, role: Role| {
        for (at, text) in wrapped(text, width.saturating_sub(NAMES + 1)).into_iter().enumerate() {
            let name = if at == 0 { name } else { "" };
            lines.push(line(format!("{name:<NAMES$} {text}"), role));
        }
    };
    match fit.last_week {
        Some(week) => {
            told("leads", &format!("last week: {}", week.in_words()), Role::Text);
            told("", &format!("last 4 weeks: {}", fit.recent.in_words()), Role::Text);
        }
        None => told("leads", "no week has been simulated", Role::Dim),
    }
    for plan in Plan::ALL {
        let name = if plan == Plan::A { "missing" } else { "" };
        let role = match Concern::ALL.iter().any(|concern| fit.missing(plan, *concern).is_some()) {
            true => Role::Bad,
            false => Role::Text,
        };
        told(name, &format!("{plan} {}", fit.lacks(plan)), role);
    }
    told("", "█ reached · ▓ reached, in the range · ▒ rest of the range", Role::Dim);
    told(
        "",
        &format!(
            "Ranges are for the group's means (±{}). Customers require more quality at a higher price.",
            percent(fit.noise, 0)
        ),
        Role::Dim,
    );
    lines
}

/// Returns the role of a line that all plans share.
fn worst(fit: &Fit, concern: Concern) -> Role {
    match Plan::ALL.iter().any(|plan| fit.missing(*plan, concern).is_some()) {
        true => Role::Bad,
        false => Role::Text,
    }
}

/// Returns a plan next to a range: `A T1 ███▒▒▒▒  0.1200 short 0.0610`.
fn bar_line(
    fit: &Fit,
    (plan, concern): (Plan, Concern),
    (name, shown): (&str, &str),
    (range, figures): (TruthRange, &[f64; 3]),
    width: usize,
) -> FitLine {
    let figure = figures[plan.index()];
    let most = figures.iter().copied().fold(range.most, f64::max);
    let (verdict, role) = verdict(fit, plan, concern);
    let cells = width.saturating_sub(33).clamp(4, 60);
    let bar = if fit.plans[plan].list > 0.0 || concern == Concern::Quality {
        bar_of(figure, range, most, cells)
    } else {
        " ".repeat(cells)
    };
    line(format!(" {plan} {name:<4} {bar} {shown:>9} {verdict}"), role)
}

/// Returns a bar up to a figure, followed by the part of the range above it.
fn bar_of(figure: f64, range: TruthRange, most: f64, cells: usize) -> String {
    let per_cell = if most > 0.0 { most / cells as f64 } else { 1.0 };
    let cell = |at: usize| {
        let value = (at as f64 + 0.5) * per_cell;
        match (value <= figure, range.beside(value)) {
            (true, Beside::Inside) => '▓',
            (true, _) => '█',
            (false, Beside::Inside) => '▒',
            (false, _) => ' ',
        }
    };
    (0..cells).map(cell).collect()
}

/// Compares a plan with a requirement, as text and role.
fn verdict(fit: &Fit, plan: Plan, concern: Concern) -> (String, Role) {
    if fit.plans[plan].list <= 0.0 {
        return ("no price".to_owned(), Role::Dim);
    }
    if let Some(missing) = fit.missing(plan, concern) {
        return match concern {
            Concern::Price => (format!("over {}", price_to_cents(missing)), Role::Bad),
            _ => (format!("short {missing:.4}"), Role::Bad),
        };
    }
    match fit.beside(plan, concern) {
        None => ("negotiated".to_owned(), Role::Dim),
        Some(Beside::Inside) => ("in range".to_owned(), Role::Text),
        Some(_) if concern == Concern::Price => ("below budget".to_owned(), Role::Good),
        Some(_) => ("enough".to_owned(), Role::Good),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_shows_what_of_the_range_is_reached() {
        let range = TruthRange { least: 0.2, most: 0.8 };
        assert_eq!(bar_of(0.1, range, 1.0, 10), "█ ▒▒▒▒▒▒  ");
        assert_eq!(bar_of(0.5, range, 1.0, 10), "██▓▓▓▒▒▒  ");
        assert_eq!(bar_of(1.0, range, 1.0, 10), "██▓▓▓▓▓▓██");
        assert_eq!(bar_of(0.0, TruthRange { least: 0.0, most: 0.0 }, 0.0, 3), "   ");
    }
}
