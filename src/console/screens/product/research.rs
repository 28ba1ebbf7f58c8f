//! The R&D pane: a timeline of projects, available projects, and spending on development and operations.

use ratatui::layout::{Constraint, Layout, Rect};

use super::model::Project;
use super::panel::{ProductPanel, prefill_tier_effect};
use super::{Product, ProductPane};
use crate::context::Figure;
use crate::effect::Effect;
use crate::screens::panes::PanePlacement;
use novamind_base::formatting::{QUALITY_DECIMALS, compact_number, dollars, quality_change, short_dollars};
use novamind_report::research::{format_mean_days, format_mean_gain};
use novamind_tools::ToolId;
use novamind_tui::canvas::{Align, Canvas, Click, truncate_to_width, row_rects};
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline;
use novamind_worker::company::DisplayedCompany;

#[derive(Debug, Clone, Default, PartialEq)]
pub struct QualitySpending {
    pub development: Vec<f64>,
    pub operations: Vec<f64>,
}

fn summary(projects: &[Project], last_day: u32) -> String {
    let running = projects.iter().filter(|project| !project.done);
    let next = running.clone().min_by_key(|project| project.expected_day);
    let done = projects.iter().filter(|project| project.done).count();
    let late = match running.clone().filter(|project| project.expected_day > last_day).count() {
        0 => String::new(),
        late => format!(" · ! {late} after the last day"),
    };
    match next {
        Some(next) => {
            let (count, id, day) = (running.count(), &next.id, next.expected_day);
            format!("{count} running, next {id} on day {day}{late} · {done} done")
        }
        None => format!("none running · {done} done"),
    }
}

/// Pane with running and available R&D projects.
pub struct ResearchPane;

impl ProductPanel for ResearchPane {
    fn id(&self) -> ProductPane {
        ProductPane::Research
    }

    fn row_count(&self, product: &Product, _: &DisplayedCompany) -> usize {
        product.projects.len() + product.offers.len()
    }

    fn summary(&self, product: &Product, company: &DisplayedCompany, _: usize) -> String {
        summary(&product.projects, company.observation.last_day)
    }

    fn note(&self, product: &Product, company: &DisplayedCompany, width: usize) -> String {
        match product.focus == self.id() {
            true => format!("{} cash", dollars(company.observation.cash)),
            false => self.summary(product, company, width),
        }
    }

    fn destination(&self, _: &Product) -> &'static str {
        ToolId::StartResearchProject.name()
    }

    fn open_effect(&self, product: &Product, _: &DisplayedCompany) -> Effect {
        let offer = product.selected_row(self.id()).checked_sub(product.projects.len());
        let offer = offer.and_then(|at| product.offers.get(at));
        prefill_tier_effect(ToolId::StartResearchProject, offer.map(|offer| offer.tier))
    }

    fn selected_figure(&self, product: &Product, _: &DisplayedCompany) -> Option<Figure> {
        let (place, term) = (product.selected_row(self.id()), "research-project");
        if let Some(project) = product.projects.get(place) {
            let sql = format!("SELECT * FROM research_projects WHERE project_id = '{}'", project.id);
            return Some(Figure {
                title: format!("project {}", project.id),
                term,
                sql: Some(sql),
                week_quantity: None,
            });
        }
        let offer = product.offers.get(place - product.projects.len())?;
        let sql = "SELECT * FROM research_projects ORDER BY started_day DESC".to_owned();
        Some(Figure { title: format!("project of tier {}", offer.tier), term, sql: Some(sql), week_quantity: None })
    }

    fn draw_content(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, company: &DisplayedCompany) {
        let line = (product.projects.len() as u16 + 1).clamp(2, (placement.area.height / 3).max(2));
        let [money, line, list] =
            Layout::vertical([Constraint::Length(2), Constraint::Length(line), Constraint::Min(0)])
                .areas(placement.area);
        draw_spending(canvas, money, &product.spending);
        draw_timeline(product, canvas, PanePlacement { area: line, ..placement }, company);
        draw_offers(product, canvas, PanePlacement { area: list, ..placement }, company);
    }
}

fn draw_spending(canvas: &mut Canvas<'_>, area: Rect, spent: &QualitySpending) {
    let rows = [("development", &spent.development), ("operations", &spent.operations)];
    for (row, (name, weeks)) in row_rects(area).zip(rows) {
        let last = weeks.last().map_or("–".to_owned(), |dollars| format!("${}/wk", compact_number(*dollars)));
        let trend = sparkline(weeks, row.width.saturating_sub(28) as usize);
        let name_and_figure = format!("{name:<12}{last:>12}");
        canvas.draw_text(row, &name_and_figure, Role::Text);
        let place = Rect { x: row.x + 26.min(row.width), width: row.width.saturating_sub(26), ..row };
        canvas.draw_text(place, &trend, Role::Series(0));
    }
}

/// Draws projects as bars on a time axis from the first start to the last completion.
fn draw_timeline(product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, company: &DisplayedCompany) {
    let (area, projects) = (placement.area, &product.projects);
    let selected =
        Some(product.selected_row(ProductPane::Research)).filter(|at| placement.focused && *at < projects.len());
    let today = company.observation.day;
    let rows = area.height.saturating_sub(1) as usize;
    let list = Rect { y: area.y + 1, height: rows as u16, ..area };
    let skipped = canvas.scroll_to_row(list, selected.unwrap_or(0), projects.len());
    let shown = &projects[skipped..projects.len().min(skipped + rows)];
    if shown.is_empty() {
        canvas.draw_text(area, "No projects yet. Start one with start_research_project.", Role::Dim);
        return;
    }
    let first = shown.iter().map(|project| project.started_day).min().unwrap_or(0).min(today);
    let last = shown.iter().map(|project| project.expected_day).max().unwrap_or(0).max(today).max(first + 1);
    let names = 30.min(area.width);
    let width = area.width - names;
    let place = |day: u32| {
        let share = f64::from(day - first) / f64::from(last - first);
        (share * f64::from(width.saturating_sub(1))).round() as u16
    };
    let head = format!("{:<7}{:>8}{:>5} {:>4}", "project", "boost", "from", "to");
    canvas.draw_text(area, &head, Role::Header);
    if width >= 24 {
        let x = area.x + names;
        canvas.draw_text(Rect { x, width, ..area }, &format!("day {first}"), Role::Dim);
        let words = format!("day {last}");
        canvas.draw_aligned(Rect { x, width, ..area }, &words, Role::Dim, Align::Right);
        // The mark of the current day is drawn only if it does not overlap the labels at both ends.
        let now = place(today);
        if now > 10 && now + 14 < width {
            canvas.draw_text(Rect { x: x + now, width: 5, ..area }, "▼ now", Role::Key);
        }
    }
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    for (row, (at, project)) in row_rects(below).zip(shown.iter().enumerate()) {
        let here = selected == Some(skipped + at);
        let role = match (here, project.done) {
            (true, _) => Role::Selection,
            (false, true) => Role::Dim,
            (false, false) => Role::Text,
        };
        canvas.register_click(row, Click::Row(placement.index, skipped + at));
        let mark = match project.done {
            true => "✓",
            false if project.expected_day > company.observation.last_day => "!",
            false => "…",
        };
        let text = format!(
            "{:<7}{:>8}{:>5} {:>4} {mark}",
            project.id, quality_change(project.boost), project.started_day, project.expected_day
        );
        canvas.draw_text(Rect { width: names, ..row }, &text, role);
        if width < 4 {
            continue;
        }
        let (from, to) = (place(project.started_day), place(project.expected_day));
        let (now, number) = (place(today), (to - from).max(1));
        let done = if project.done { number } else { now.clamp(from, from + number) - from };
        let bar = "█".repeat(done as usize) + &"░".repeat((number - done) as usize);
        let x = row.x + names + from;
        let role = if project.done { Role::Good } else { Role::Series(1) };
        canvas.draw_text(Rect { x, width: number.min(area.right().saturating_sub(x)), ..row }, &bar, role);
        if now < from || now >= from + number {
            canvas.draw_text(Rect { x: row.x + names + now, width: 1, ..row }, "│", Role::Border);
        }
    }
}

fn draw_offers(product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, company: &DisplayedCompany) {
    let (area, offers, before) = (placement.area, &product.offers, product.projects.len());
    let selected = product.selected_row(ProductPane::Research).checked_sub(before).filter(|_| placement.focused);
    let head = format!(
        "{:>4} {:<17} {:>8} {:>5} {:>7} {:>8}  ",
        "tier", "project", "cost", "days", "quality", "$/0.01"
    );
    canvas.draw_text(area, head.trim_end(), Role::Header);
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
    if selected.is_some() {
        canvas.page_rows = below.height.max(1);
    }
    let from = canvas.scroll_to_row(below, selected.unwrap_or(0), offers.len());
    for (row, (at, offer)) in row_rects(below).zip(offers.iter().enumerate().skip(from)) {
        let affordable = offer.cost <= company.observation.cash;
        let role = match (selected == Some(at), affordable) {
            (true, _) => Role::Selection,
            (false, true) => Role::Text,
            (false, false) => Role::Dim,
        };
        let bound = if offer.means.are_lower_bounds { "≤" } else { "" };
        let each = match offer.means.gain > 0.0 {
            true => format!("{bound}{}", short_dollars(offer.cost / offer.means.gain * 0.01)),
            false => "–".to_owned(),
        };
        let mut remarks = Vec::new();
        if offer.running_and_done.0 > 0 {
            remarks.push(format!("{} running", offer.running_and_done.0));
        }
        if offer.running_and_done.1 > 0 {
            remarks.push(format!("{} done", offer.running_and_done.1));
        }
        if !affordable {
            remarks.push("! exceeds your cash".to_owned());
        }
        // In narrow rows, a sign marks projects that cost more than the available cash.
        let remarks = match row.width < 70 {
            true if !affordable => "!".to_owned(),
            true => String::new(),
            false => remarks.join(", "),
        };
        canvas.clear(row, role);
        let text = format!(
            "{:>4} {:<17} {:>8} {:>5} {:>7} {each:>8} {}",
            offer.tier,
            truncate_to_width(&offer.name, 17),
            short_dollars(offer.cost),
            format_mean_days(&offer.means),
            format_mean_gain(&offer.means, QUALITY_DECIMALS),
            remarks
        );
        canvas.draw_text(row, text.trim_end(), role);
        canvas.register_click(row, Click::Row(placement.index, before + at));
    }
}
