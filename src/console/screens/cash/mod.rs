//! Where money comes from and goes to: the books by category and week, the way of the cash, forecasts.

mod bars;
mod curve;
mod forecasts;
mod model;
#[cfg(test)]
mod tests;
mod waterfall;

use crossterm::event::KeyEvent;
use ratatui::layout::{Constraint, Layout, Rect};

use self::forecasts::Outlook;
use self::model::{Amounts, Books, CATEGORIES, Step, Subject, money, side, statement, waterfall};
use super::{Figure, Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::text::{arrow, short_dollars};
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Table};
use crate::notation::{compact, dollars, percent};

/// Panes.
const TABLE: usize = 0;
const WEEKS: usize = 1;
const FORECASTS: usize = 2;
const FALLS: usize = 3;
const CURVE: usize = 4;
/// Narrowest window in which the way of the cash and its curve stand beside the books.
const WIDE: u16 = 176;

/// The screen.
#[derive(Default)]
pub struct Cash {
    focus: usize,
    books: Books,
    /// The week that is looked at; none for the last one.
    week: Option<u32>,
    table: Table,
    /// What the rows of the table are about.
    subjects: Vec<Subject>,
    outlook: Outlook,
    /// Step of the way from week to week that is selected.
    step: usize,
}

impl Cash {
    fn week(&self) -> u32 {
        let last = self.books.last();
        self.week.unwrap_or(last).min(last)
    }

    /// Makes the table of the week that is looked at.
    fn refresh(&mut self) {
        let (columns, subjects, rows) = table_of(&self.books, self.week());
        if self.subjects.is_empty() {
            self.table = Table::new(Vec::new()).by_cell();
            self.table.set(columns, rows);
            self.table.act(Action::Right, 1);
        } else {
            self.table.set(columns, rows);
        }
        self.subjects = subjects;
    }

    fn move_week(&mut self, step: i64) {
        let last = self.books.last();
        let week = (i64::from(self.week()) + step).clamp(1.min(i64::from(last)), i64::from(last)) as u32;
        self.week = (week != last).then_some(week);
        self.refresh();
    }

    /// What is selected in the panes of the books: the subject, its weeks, and words for both.
    fn selected(&self, company: &Company) -> Option<(Subject, (u32, u32))> {
        let week = self.week();
        if self.focus == CURVE {
            return Some((Subject::Net, (week, week)));
        }
        if self.focus == FALLS {
            let steps = self.steps(company);
            let subject = steps.get(self.step.min(steps.len().saturating_sub(1)))?.subject;
            return Some((subject, (week, week)));
        }
        let subject = self.table.selected().and_then(|row| self.subjects.get(row)).copied()?;
        let weeks = match (self.focus, self.table.selected_column()) {
            (TABLE, 2 | 3) if week < 2 => return None,
            (TABLE, 2) => (week - 1, week),
            (TABLE, 3) => (week - 1, week - 1),
            (TABLE, 4) => (week.saturating_sub(3).max(1.min(week)), week),
            (TABLE, 5) => (1, self.books.open_week()),
            _ => (week, week),
        };
        Some((subject, weeks))
    }

    /// The steps from the cash of the week before to that of the week.
    fn steps(&self, company: &Company) -> Vec<Step> {
        waterfall(&self.books, company, self.week(), usize::MAX)
    }

    fn drill(&self, company: &Company) -> Vec<Effect> {
        let selected = self.selected(company);
        selected.map(|(subject, weeks)| Effect::RunSql(statement(&subject, weeks))).into_iter().collect()
    }

    fn move_step(&mut self, action: Action, company: &Company) {
        let last = self.steps(company).len().saturating_sub(1);
        self.step = match action {
            Action::Up => self.step.min(last).saturating_sub(1),
            Action::Down => (self.step + 1).min(last),
            Action::First => 0,
            Action::Last => last,
            _ => self.step,
        };
    }
}

/// The table of a week: columns, what its rows are about, rows.
fn table_of(books: &Books, week: u32) -> (Vec<Column>, Vec<Subject>, Vec<Vec<Cell>>) {
    let before = week.saturating_sub(1);
    let columns = vec![
        Column::words("category").at_most(14),
        Column::numbers(format!("week {week}")),
        Column::numbers("change"),
        Column::numbers(format!("week {before}")),
        Column::numbers("4-wk mean"),
        Column::numbers("run total"),
        Column::numbers("share"),
    ];
    // Sums stand above their parts: what a small window cuts off is detail.
    let mut subjects = vec![Subject::Net];
    for income in [true, false] {
        let used = |at: &usize| CATEGORIES[*at].income == income && books.is_used(*at);
        subjects.push(if income { Subject::Income } else { Subject::Costs });
        subjects.extend((0..CATEGORIES.len()).filter(used).map(Subject::Category));
    }
    let all = [books.week(week), books.week(before), books.mean_of_four(week), books.total()];
    let rows = subjects.iter().map(|subject| row_of(subject, &all, week)).collect();
    (columns, subjects, rows)
}

fn row_of(subject: &Subject, all: &[Amounts; 4], week: u32) -> Vec<Cell> {
    let [now, before, mean, total] = [0, 1, 2, 3].map(|at| subject.of(&all[at]));
    let name = subject.name();
    let (income, role) = match subject {
        Subject::Category(at) => (CATEGORIES[*at].income, Role::Text),
        Subject::Costs => (false, Role::Strong),
        Subject::Income | Subject::Net => (true, Role::Strong),
    };
    // More of a cost is more, not less: its change goes by its size.
    let change = if income { now - before } else { before - now };
    let change_role = match change {
        0.0 => Role::Dim,
        change if (change > 0.0) == income => Role::Good,
        _ => Role::Bad,
    };
    let whole = side(&all[0], income).abs();
    let share = if *subject == Subject::Net || whole <= 0.0 { None } else { Some(now.abs() / whole) };
    let amount = |value: f64| Cell::number(value, if value == 0.0 { "–".to_owned() } else { money(value) });
    let moved = if week < 2 { "–".to_owned() } else { arrow(change, &compact(change.abs())) };
    vec![
        Cell::words(match subject {
            Subject::Category(_) => format!("  {name}"),
            _ => name.to_owned(),
        })
        .role(role),
        amount(now).role(role),
        Cell::number(change, moved).role(change_role),
        amount(before).role(Role::Dim),
        amount(mean).role(Role::Dim),
        Cell::number(total, short_dollars(total)),
        share.map_or(Cell::words("–"), |share| Cell::number(share, percent(share, 1))),
    ]
}

impl Screen for Cash {
    fn scopes(&self) -> Vec<Scope> {
        match self.focus == TABLE && self.table.is_typing() {
            true => vec![Scope::Field, Scope::List],
            false => vec![Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match self.focus {
            TABLE => vec![Action::Open, Action::Sort, Action::Filter],
            _ => vec![Action::Left, Action::Right, Action::Open],
        }
    }

    fn panes(&self) -> usize {
        5
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(CURVE);
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        if self.focus == FORECASTS {
            return self.outlook.figure();
        }
        let (subject, (from, to)) = self.selected(look.company)?;
        let weeks = match (from, to) {
            (1, to) if to == self.books.open_week() => "the whole run".to_owned(),
            (from, to) if from == to => format!("week {to}"),
            (from, to) => format!("weeks {from} to {to}"),
        };
        let title = format!("{} of {weeks}", subject.name());
        Some(Figure { title, term: subject.term(), sql: Some(statement(&subject, (from, to))) })
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.books = Books::of(look.company);
        self.refresh();
        self.outlook.renew(look.company);
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match (self.focus, action) {
            (FORECASTS, Action::Open) => return vec![Effect::Do(Action::Journal)],
            (_, Action::Open) => return self.drill(look.company),
            (FORECASTS, action) => self.outlook.act(action, look.page),
            (WEEKS | FALLS | CURVE, Action::Left) => self.move_week(-1),
            (WEEKS | FALLS | CURVE, Action::Right) => self.move_week(1),
            (WEEKS | CURVE, Action::First) => self.move_week(-i64::from(u16::MAX)),
            (WEEKS | CURVE, Action::Last | Action::Close) => self.move_week(i64::from(u16::MAX)),
            (FALLS, Action::Up | Action::Down | Action::First | Action::Last) => {
                self.move_step(action, look.company);
            }
            (CURVE, _) => {}
            (_, Action::Close) if self.week.is_some() => self.move_week(i64::from(u16::MAX)),
            (_, action) => {
                self.table.act(action, look.page);
            }
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        self.table.edit_filter(|field| {
            field.key(key);
        });
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        self.table.edit_filter(|field| field.insert(text));
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        match pane {
            TABLE => {
                let before = self.table.selected();
                self.table.select_place(row);
                if before == self.table.selected() {
                    return self.drill(look.company);
                }
            }
            FALLS => self.step = row,
            CURVE => {}
            WEEKS => self.move_week(row as i64 - i64::from(self.week())),
            _ => self.outlook.select_place(row),
        }
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if canvas.zoomed {
            return self.draw_pane(canvas, area, look, self.focus);
        }
        if area.width >= 104 && area.height >= 30 {
            return self.draw_large(canvas, area, look);
        }
        // In a small window the pane with the focus gets the larger part.
        let rows = self.table.rows().len() as u16 + 3;
        let upper = match self.focus {
            TABLE => rows.min(area.height.saturating_sub(7)).max(area.height / 3),
            _ => area.height / 3,
        };
        let [table, below] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(area);
        self.draw_pane(canvas, table, look, TABLE);
        self.draw_pane(canvas, below, look, if self.focus == TABLE { FALLS } else { self.focus });
    }
}

impl Cash {
    /// Books, way and curve above, weeks and forecasts below.
    fn draw_large(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let rows = self.table.rows().len() as u16 + 3;
        let [top, below] = Layout::vertical([
            Constraint::Length(rows.clamp(10, area.height - area.height / 2)),
            Constraint::Min(0),
        ])
        .areas(area);
        let halves = |area: Rect, left: u16| {
            Layout::horizontal([Constraint::Length(left), Constraint::Min(0)]).areas::<2>(area)
        };
        let [table, beside] = halves(top, 82.min(area.width * 2 / 3));
        let [weeks, outlook] = halves(below, (area.width * 11 / 20).max(60));
        self.draw_pane(canvas, table, look, TABLE);
        if area.width >= WIDE {
            let [falls, curve] = halves(beside, beside.width / 2);
            self.draw_pane(canvas, falls, look, FALLS);
            self.draw_pane(canvas, curve, look, CURVE);
        } else {
            // The curve comes to the front with the focus.
            self.draw_pane(canvas, beside, look, if self.focus == CURVE { CURVE } else { FALLS });
        }
        self.draw_pane(canvas, weeks, look, WEEKS);
        self.draw_pane(canvas, outlook, look, FORECASTS);
    }

    fn draw_pane(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, pane: usize) {
        let focused = self.focus == pane;
        match pane {
            TABLE => self.draw_table(canvas, area, look),
            WEEKS => self.draw_weeks(canvas, area, look),
            FORECASTS => self.outlook.draw(canvas, area, look, focused, FORECASTS),
            FALLS => self.draw_falls(canvas, area, look),
            _ => {
                canvas.click(area, Click::Pane(CURVE));
                curve::draw(canvas, area, look.company, self.week(), focused);
                self.week_keys(canvas, area, look, focused);
            }
        }
    }

    fn draw_table(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let note = match self.table.note() {
            note if note.is_empty() => format!("{} now", dollars(look.company.seen.cash)),
            note => note,
        };
        canvas.click(area, Click::Pane(TABLE));
        let focused = self.focus == TABLE;
        let title = format!("Books of {}", week_words(self.week(), look.company));
        let inside = canvas.pane(area, &title, &note, focused);
        self.table.draw(canvas, inside, focused, TABLE);
        if focused {
            let open = look.keys.label(Action::Open).unwrap_or_default();
            canvas.pane_keys(area, &format!("{open} ledger rows · {}", look.hint(Action::Sort)));
        }
    }

    fn draw_falls(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let (week, company) = (self.week(), look.company);
        canvas.click(area, Click::Pane(FALLS));
        let focused = self.focus == FALLS;
        let change = model::cash_around(company, week).map_or(0.0, |(before, after)| after - before);
        let note = arrow(change, &dollars(change.abs()));
        let title = format!("From week {} to {week}", week.saturating_sub(1));
        let inside = canvas.pane(area, &title, &note, focused);
        // Without the focus all of the way is seen, small steps together; with it every step can be reached.
        let most = if focused { usize::MAX } else { inside.height.saturating_sub(1) as usize };
        let steps = waterfall(&self.books, company, week, most);
        let selected = focused.then(|| self.step.min(steps.len().saturating_sub(1)));
        waterfall::draw(canvas, inside, &steps, selected, FALLS);
        self.week_keys(canvas, area, look, focused);
    }

    fn draw_weeks(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(WEEKS));
        let focused = self.focus == WEEKS;
        let subject = self.table.selected().and_then(|row| self.subjects.get(row));
        let note = subject.map_or(String::new(), |subject| {
            let amount = subject.of(&self.books.week(self.week()));
            format!("week {}: {} {}", self.week(), subject.name(), money(amount))
        });
        let inside = canvas.pane(area, "Income and costs by week", &note, focused);
        bars::draw(canvas, inside, &self.books, self.week(), WEEKS);
        self.week_keys(canvas, area, look, focused);
    }

    fn week_keys(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>, focused: bool) {
        if focused {
            let label = |action| look.keys.label(action).unwrap_or_default();
            let keys = format!("{} {} another week", label(Action::Left), label(Action::Right));
            canvas.pane_keys(area, &format!("{keys} · {} ledger rows", label(Action::Open)));
        }
    }
}

fn week_words(week: u32, company: &Company) -> String {
    let (from, to) = model::days_of(week);
    format!("week {week} · days {from} to {}", to.min(company.seen.day.max(from)))
}
