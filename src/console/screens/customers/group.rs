//! A group opened: its weeks, cohorts, plans and sources, what its study says, and the way to its tools.

use ratatui::layout::{Constraint, Layout, Rect};

use super::cohorts::{self, Cohorts};
use super::columns::flow_statement;
use super::facts::{Fact, facts};
use super::model::{Facts, Flow, Market};
use crate::console::action::Action;
use crate::console::canvas::{Align, Canvas, Click, rows_of};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::screens::market::model::{level_of, name_of};
use crate::console::screens::market::report;
use crate::console::screens::{Figure, Look, ScreenId};
use crate::console::text::{arrow, count};
use crate::console::theme::Role;
use crate::console::widgets::chart::{note_room, summary, zero_if_near};
use crate::console::widgets::table::first_row;
use crate::console::widgets::{Axis, Line, Plot, Side, Unit};
use crate::notation::{compact, grouped, percent};
use crate::tools::ToolId;
use crate::world::identifiers::Group;

/// Panes of an open group.
pub const WAYS: usize = 0;
const FACTS: usize = 1;
const WEEKS: usize = 2;
const COHORTS: usize = 3;
const REPORT: usize = 4;
/// Number of panes.
pub const PANES: usize = 5;

/// Tools of a group, and what they do for it.
pub const TOOLS: [(ToolId, &str); 6] = [
    (ToolId::SetTargetedAdSpend, "ads"),
    (ToolId::SetTargetedDevSpend, "development"),
    (ToolId::SetTargetedOpsSpend, "support"),
    (ToolId::SetPromotion, "discounts"),
    (ToolId::SetLeadPromotion, "for leads"),
    (ToolId::SetAdsStrength, "ads shown"),
];

/// Ways that are no tools: the insight report, and the customers themselves.
const OTHERS: [(&str, &str); 2] = [("Market", "order a study"), ("SQL", "its customers")];

/// Number of things that can be chosen: the tools and the other ways.
pub const CHOICES: usize = TOOLS.len() + OTHERS.len();

/// Flows that can be selected: leads, new, cancelled.
const FLOWS: [(&str, &str); 3] =
    [("leads", "lead"), ("new customers", "conversion"), ("cancellations", "churn")];

/// What a choice leads to.
pub fn choose(choice: usize, group: Group) -> Effect {
    match TOOLS.get(choice) {
        Some((tool, _)) => Effect::ShowCell(*tool, group.to_string()),
        None if choice == TOOLS.len() => Effect::ShowGroup(ScreenId::Market, group),
        None => Effect::EditSql(format!(
            "-- customers of {group}\nSELECT s.plan, s.status, count(*) AS customers, \
             round(avg(s.effective_price), 2) AS price\nFROM subscriptions s\n\
             JOIN customers c ON c.customer_id = s.customer_id\nWHERE c.group_id = '{group}'\n\
             GROUP BY 1, 2\nORDER BY 1, 2"
        )),
    }
}

/// What the screen knows of the groups.
#[derive(Clone, Copy)]
pub struct Known<'a> {
    /// The company.
    pub company: &'a Company,
    /// What the readings say.
    pub market: &'a Market,
    /// Who stayed.
    pub cohorts: &'a Cohorts,
}

/// Where the person is in an open group.
#[derive(Debug, Default)]
pub struct Opened {
    /// The pane that has the focus.
    pub focus: usize,
    /// The way that is chosen.
    pub choice: usize,
    fact: usize,
    /// Weeks before the last one, and the flow that is selected.
    back: u32,
    flow: usize,
    place: cohorts::Place,
    /// First line of the report.
    from: usize,
}

impl Opened {
    /// Does an action that stays in the group.
    pub fn act(&mut self, action: Action, known: Known<'_>, group: Group) {
        let moved = |at: usize, last: usize| match action {
            Action::Up => at.min(last).saturating_sub(1),
            Action::Down => (at + 1).min(last),
            Action::First => 0,
            Action::Last => last,
            _ => at,
        };
        match self.focus {
            WAYS => self.choice = moved(self.choice, CHOICES - 1),
            FACTS => self.move_fact(action, known, group),
            WEEKS => {
                let most = super::model::WEEKS.min(known.company.seen.week).saturating_sub(1);
                match action {
                    Action::Left => self.back = (self.back + 1).min(most),
                    Action::Right => self.back = self.back.saturating_sub(1),
                    _ => self.flow = moved(self.flow, FLOWS.len() - 1),
                }
            }
            COHORTS => self.place.act(action, known.cohorts, group, known.company.seen.week),
            _ => self.from = moved(self.from, report::lines(known.company, group).len().saturating_sub(1)),
        }
    }

    /// Moves to the next line that holds a figure.
    fn move_fact(&mut self, action: Action, known: Known<'_>, group: Group) {
        let lines = lines(known, group, 0);
        let held: Vec<usize> = (0..lines.len()).filter(|at| lines[*at].figure.is_some()).collect();
        let place = held.iter().position(|at| *at >= self.fact).unwrap_or(0);
        let place = match action {
            Action::Up => place.saturating_sub(1),
            Action::Down if held.get(place) == Some(&self.fact) => place + 1,
            Action::First => 0,
            Action::Last => held.len(),
            _ => place,
        };
        self.fact = held.get(place.min(held.len().saturating_sub(1))).copied().unwrap_or(0);
    }

    /// A row of a pane was clicked.
    pub fn click(&mut self, row: usize) {
        match self.focus {
            WAYS => self.choice = row.min(CHOICES - 1),
            FACTS => self.fact = row,
            COHORTS => self.place = cohorts::Place { cohort: row / 1000, since: row % 1000 },
            _ => {}
        }
    }

    /// The figure that is selected.
    pub fn figure(&self, known: Known<'_>, group: Group) -> Option<Figure> {
        match self.focus {
            FACTS => lines(known, group, 0).into_iter().nth(self.fact)?.figure,
            WEEKS => {
                let week = known.company.seen.week.saturating_sub(self.back);
                let (name, term) = FLOWS[self.flow];
                let sql = Some(flow_statement(self.flow, group, week));
                Some(Figure { title: format!("{name} of {group} in week {week}"), term, sql })
            }
            COHORTS => self.place.figure(known.cohorts, group),
            REPORT => {
                let title = format!("what the study of {group} says");
                Some(Figure { title, term: "info-level", sql: None })
            }
            _ => None,
        }
    }

    /// Draws the group into the whole screen.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, known: Known<'_>, group: Group) {
        let mut draw = |area: Rect, pane: usize| self.draw_pane(canvas, area, look, known, group, pane);
        let split = |area: Rect, first: u16| {
            Layout::vertical([Constraint::Length(first), Constraint::Min(0)]).areas::<2>(area)
        };
        let columns = |constraints: [Constraint; 3]| Layout::horizontal(constraints).areas::<3>(area);
        let ways = CHOICES as u16 + 2;
        if area.width >= 150 && area.height >= 30 {
            let [left, middle, right] =
                columns([Constraint::Percentage(40), Constraint::Min(0), Constraint::Length(44)]);
            let [above, below] = split(middle, (area.height / 2).min(20));
            let [facts, go] = split(right, area.height - ways);
            for (area, pane) in [(left, WEEKS), (above, COHORTS), (below, REPORT), (facts, FACTS), (go, WAYS)]
            {
                draw(area, pane);
            }
        } else if area.width >= 104 && area.height >= 30 {
            let [left, _, right] =
                columns([Constraint::Min(0), Constraint::Length(0), Constraint::Length(44)]);
            let [above, below] = split(left, area.height * 3 / 5);
            let [facts, go] = split(right, area.height - ways);
            draw(above, WEEKS);
            draw(below, if self.focus == REPORT { REPORT } else { COHORTS });
            draw(facts, FACTS);
            draw(go, WAYS);
        } else if self.focus == COHORTS {
            // The triangle needs the width.
            draw(area, COHORTS);
        } else {
            let [left, _, right] =
                columns([Constraint::Min(0), Constraint::Length(0), Constraint::Percentage(50)]);
            let [facts, go] = split(right, area.height.saturating_sub(ways));
            draw(left, if self.focus >= WEEKS { self.focus } else { WEEKS });
            draw(facts, FACTS);
            draw(go, WAYS);
        }
    }

    /// Draws one of its panes.
    pub fn draw_pane(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        look: &Look<'_>,
        known: Known<'_>,
        group: Group,
        pane: usize,
    ) {
        canvas.click(area, Click::Pane(pane));
        let focused = self.focus == pane;
        match pane {
            WAYS => draw_choices(canvas, area, self.choice, focused),
            FACTS => draw_facts(canvas, area, known, group, focused.then_some(self.fact)),
            WEEKS => {
                draw_weeks(canvas, area, known, group, focused.then_some((self.back, self.flow)));
                if focused {
                    let label = |action| look.keys.label(action).unwrap_or_default();
                    let [left, right] = [Action::Left, Action::Right].map(label);
                    let [up, down] = [Action::Up, Action::Down].map(label);
                    let keys = format!("{left} {right} another week · {up} {down} another figure");
                    canvas.pane_keys(area, &keys);
                }
            }
            COHORTS => draw_cohorts(canvas, area, known, group, focused.then_some(self.place)),
            _ => draw_report(canvas, area, known.company, group, self.from, focused),
        }
    }
}

/// Draws what a group is beside the list of all groups.
pub fn draw_preview(canvas: &mut Canvas<'_>, area: Rect, known: Known<'_>, group: Group) {
    let middle = if area.width >= 150 { area.width * 3 / 10 } else { 0 };
    let right = Constraint::Length(46.min(area.width / 2));
    let [curves, kept, side] =
        Layout::horizontal([Constraint::Min(0), Constraint::Length(middle), right]).areas(area);
    draw_weeks(canvas, curves, known, group, None);
    if middle > 0 {
        draw_cohorts(canvas, kept, known, group, None);
    }
    draw_facts(canvas, side, known, group, None);
}

fn lines(known: Known<'_>, group: Group, bars: usize) -> Vec<Fact> {
    facts(known.company, known.market, &known.market.of(group), group, bars)
}

/// Customers and flows by week; the week and the flow that are selected.
fn draw_weeks(
    canvas: &mut Canvas<'_>,
    area: Rect,
    known: Known<'_>,
    group: Group,
    selected: Option<(u32, usize)>,
) {
    let own = known.market.of(group);
    let week = known.company.seen.week;
    let mark = selected.map(|(back, _)| f64::from(week.saturating_sub(back)));
    let [stock, flows] = Layout::vertical([Constraint::Percentage(50), Constraint::Min(0)]).areas(area);
    let points = |values: Vec<(u32, f64)>| -> Vec<(f64, f64)> {
        values.iter().map(|(at, value)| (f64::from(*at), *value)).collect()
    };
    let held = points(own.stock(week));
    let values: Vec<f64> = held.iter().map(|point| point.1).collect();
    let title = format!("{group} {}", if group.is_enterprise() { "companies" } else { "subscribers" });
    let words = summary(&values, &|value| grouped(value, 0), note_room(stock, &title));
    let inside = canvas.pane(stock, &title, &words, false);
    let x = Axis { write: &|week| format!("wk {week:.0}"), holds: &[] };
    let zero = zero_if_near(values.iter().copied());
    let lines = [Line::through(held, Role::Series(0))];
    Plot { lines: &lines, band: None, mark, x: &x, y: &Side { unit: Unit::Number, holds: zero } }
        .draw(canvas, inside);
    let (back, flow) = selected.unwrap_or((0, usize::MAX));
    let title = "By week";
    let words = flow_words(&own, week.saturating_sub(back), flow, note_room(flows, title));
    let inside = canvas.pane(flows, title, &words, selected.is_some());
    let trend = |figure: fn(&Flow) -> f64| points(own.trend(week, figure));
    let lines = [
        Line::through(trend(|flow| flow.leads), Role::Series(2)).named("leads"),
        Line::through(trend(|flow| flow.signed), Role::Good).named("new"),
        Line { scattered: true, ..Line::through(trend(|flow| flow.cancelled), Role::Bad).named("left") },
    ];
    Plot { lines: &lines, band: None, mark, x: &x, y: &Side { unit: Unit::Number, holds: &[0.0] } }
        .draw(canvas, inside);
}

/// A week in words: the selected flow with its change, or all of them.
fn flow_words(facts: &Facts, week: u32, flow: usize, room: usize) -> String {
    let (now, before) = (facts.week(week), facts.week(week.saturating_sub(1)));
    let of = |own: &Flow| [own.leads, own.signed, own.cancelled];
    let whole = |value: f64| grouped(value, 0);
    if let Some((name, _)) = FLOWS.get(flow) {
        let (now, before) = (of(&now)[flow], of(&before)[flow]);
        return format!(
            "week {week}: {} {name} {}",
            whole(now),
            arrow(now - before, &whole((now - before).abs()))
        );
    }
    let full =
        format!("{} · {} new · {} left", count(now.leads, "lead"), whole(now.signed), whole(now.cancelled));
    if full.len() <= room { full } else { format!("+{} -{}", compact(now.signed), compact(now.cancelled)) }
}

fn draw_cohorts(
    canvas: &mut Canvas<'_>,
    area: Rect,
    known: Known<'_>,
    group: Group,
    place: Option<cohorts::Place>,
) {
    let week = known.company.seen.week;
    let title = "Retention, %";
    let words = known.cohorts.summary(group, week, note_room(area, title));
    let inside = canvas.pane(area, title, &words, place.is_some());
    cohorts::draw(canvas, inside, known.cohorts, (group, week), place, COHORTS);
}

fn draw_report(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &Company,
    group: Group,
    from: usize,
    focused: bool,
) {
    let level = level_of(company, group);
    let noise = company.terms.level(level).map_or(0.0, |level| level.noise);
    let note = format!("level {level} · ±{}", percent(noise, 0));
    let inside = canvas.pane(area, &format!("Study of {group}"), &note, focused);
    report::draw_estimates(canvas, inside, company, group, from);
}

fn draw_facts(canvas: &mut Canvas<'_>, area: Rect, known: Known<'_>, group: Group, selected: Option<usize>) {
    let segment = if group.is_enterprise() { "enterprise" } else { "individual" };
    let title = format!("{group} · {segment}");
    let inside = canvas.pane(area, &title, name_of(known.company, group), selected.is_some());
    let bars = (inside.width as usize).saturating_sub(32).min(16);
    let lines = lines(known, group, bars);
    let from = first_row(selected.unwrap_or(0), inside.height as usize, lines.len());
    for (row, (at, fact)) in rows_of(inside).zip(lines.iter().enumerate().skip(from)) {
        let here = selected == Some(at) && fact.figure.is_some();
        let role = if here { Role::Selection } else { fact.role };
        if here {
            canvas.clear(row, role);
        }
        canvas.text(row, &fact.words, role);
        canvas.aligned(row, &fact.figures, role, Align::Right);
        canvas.click(row, Click::Row(FACTS, at));
    }
}

fn draw_choices(canvas: &mut Canvas<'_>, area: Rect, choice: usize, focused: bool) {
    let inside = canvas.pane(area, "Go to", "", focused);
    let from = first_row(choice, inside.height as usize, CHOICES);
    for (at, row) in (from..CHOICES).zip(rows_of(inside)) {
        let role = match (at == choice, focused) {
            (true, true) => Role::Selection,
            (true, false) => Role::SelectionIdle,
            _ => Role::Text,
        };
        canvas.clear(row, role);
        let tools = TOOLS.iter().map(|(tool, purpose)| (tool.name(), *purpose));
        let (name, purpose) = tools.chain(OTHERS).nth(at).unwrap_or_default();
        canvas.text(row, name, role);
        let purpose_role = if at == choice { role } else { Role::Dim };
        let place = Rect { x: row.x + 23, width: row.width.saturating_sub(23), ..row };
        canvas.aligned(place, purpose, purpose_role, Align::Right);
        canvas.click(row, Click::Row(WAYS, at));
    }
}
