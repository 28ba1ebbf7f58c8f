//! Where money comes from and goes to: the books by category and week, the way of the cash, forecasts.

mod bars;
mod falls;
mod forecasts;
mod model;
#[cfg(test)]
mod tests;

use crossterm::event::KeyEvent;
use ratatui::layout::{Constraint, Layout, Rect};

use self::forecasts::Outlook;
use self::model::{Amounts, Books, CATEGORIES, Subject, money, side, statement, waterfall};
use super::{Look, Screen};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, Click};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::readings::Reading;
use crate::console::text::{arrow, short_dollars};
use crate::console::theme::Role;
use crate::console::widgets::{Cell, Column, Table};
use crate::notation::{compact, dollars, percent};
use crate::session::Rows;

/// Panes.
const TABLE: usize = 0;
const WEEKS: usize = 1;
const FORECASTS: usize = 2;

/// The screen.
#[derive(Default)]
pub struct Cash {
    focus: usize,
    books: Option<Books>,
    /// The week that is looked at; none for the last one.
    week: Option<u32>,
    table: Table,
    /// What the rows of the table are about.
    subjects: Vec<Subject>,
    outlook: Outlook,
}

impl Cash {
    fn week(&self) -> u32 {
        let last = self.books.as_ref().map_or(0, Books::last);
        self.week.unwrap_or(last).min(last)
    }

    /// Makes the table of the week that is looked at.
    fn refresh(&mut self) {
        let Some(books) = &self.books else { return };
        let week = self.week();
        let (columns, subjects, rows) = table_of(books, week);
        let first = self.subjects.is_empty();
        self.table.set(columns, rows);
        self.subjects = subjects;
        if first {
            self.table.act(Action::First, 1);
        }
    }

    fn move_week(&mut self, step: i64) {
        let Some(books) = &self.books else { return };
        let last = books.last();
        let week = (i64::from(self.week()) + step).clamp(1.min(i64::from(last)), i64::from(last)) as u32;
        self.week = (week != last).then_some(week);
        self.refresh();
    }

    fn drill(&self) -> Vec<Effect> {
        let subject = self.table.selected().and_then(|row| self.subjects.get(row));
        subject.map(|subject| Effect::EditSql(statement(subject, self.week()))).into_iter().collect()
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
        let now = |at: &usize| CATEGORIES[*at].id != "initial_funding" || week < 2;
        subjects.push(if income { Subject::Income } else { Subject::Costs });
        subjects.extend((0..CATEGORIES.len()).filter(used).filter(now).map(Subject::Category));
    }
    let all = [books.week(week), books.week(before), books.mean_of_four(week), books.total()];
    let rows = subjects.iter().map(|subject| row_of(subject, &all, week)).collect();
    (columns, subjects, rows)
}

fn row_of(subject: &Subject, all: &[Amounts; 4], week: u32) -> Vec<Cell> {
    let of = |amounts: &Amounts| match subject {
        Subject::Category(at) => amounts[*at],
        Subject::Income => side(amounts, true),
        Subject::Costs => side(amounts, false),
        Subject::Net => amounts.iter().sum(),
    };
    let [now, before, mean, total] = [of(&all[0]), of(&all[1]), of(&all[2]), of(&all[3])];
    let (name, income, role) = match subject {
        Subject::Category(at) => (CATEGORIES[*at].name, CATEGORIES[*at].income, Role::Text),
        Subject::Income => ("income", true, Role::Strong),
        Subject::Costs => ("costs", false, Role::Strong),
        Subject::Net => ("net", true, Role::Strong),
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
        3
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(FORECASTS);
    }

    fn readings(&self) -> &'static [Reading] {
        &[Reading::LedgerByWeek]
    }

    fn take(&mut self, _: Reading, rows: &Rows, look: &Look<'_>) {
        self.books = Some(Books::of(rows, look.company));
        self.refresh();
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.outlook.renew(look.company);
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match (self.focus, action) {
            (TABLE | WEEKS, Action::Open) => return self.drill(),
            (FORECASTS, Action::Open) => return vec![Effect::Do(Action::Journal)],
            (WEEKS, Action::Left) => self.move_week(-1),
            (WEEKS, Action::Right) => self.move_week(1),
            (WEEKS, Action::First) => self.move_week(-i64::from(u16::MAX)),
            (WEEKS, Action::Last | Action::Close) => self.move_week(i64::from(u16::MAX)),
            (FORECASTS, action) => self.outlook.act(action, look.page),
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

    fn click(&mut self, pane: usize, row: usize, _: &Look<'_>) -> Vec<Effect> {
        match pane {
            TABLE => {
                let before = self.table.selected();
                self.table.select_place(row);
                if before == self.table.selected() {
                    return self.drill();
                }
            }
            WEEKS => self.move_week(row as i64 - i64::from(self.week())),
            _ => self.outlook.select_place(row),
        }
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let rows = self.table.rows().len() as u16 + 3;
        if area.width >= 104 && area.height >= 30 {
            let lower = area.height / 2;
            let [top, below] = Layout::vertical([
                Constraint::Length(rows.clamp(10, area.height - lower)),
                Constraint::Min(0),
            ])
            .areas(area);
            let halves = |area: Rect, left: u16| {
                Layout::horizontal([Constraint::Length(left), Constraint::Min(0)]).areas::<2>(area)
            };
            let left = (area.width / 2).max(82.min(area.width * 2 / 3));
            let [table, falls] = halves(top, left);
            let [weeks, outlook] = halves(below, (area.width * 11 / 20).max(60));
            self.draw_table(canvas, table, look);
            self.draw_falls(canvas, falls, look.company);
            self.draw_weeks(canvas, weeks, look);
            self.outlook.draw(canvas, outlook, look, self.focus == FORECASTS, FORECASTS);
            return;
        }
        let upper = rows.min(area.height.saturating_sub(7)).max(area.height / 3);
        let [table, below] = Layout::vertical([Constraint::Length(upper), Constraint::Min(0)]).areas(area);
        if self.focus == TABLE {
            self.draw_table(canvas, table, look);
            return self.draw_falls(canvas, below, look.company);
        }
        // In a small window the pane with the focus gets the larger part.
        let [table, below] =
            Layout::vertical([Constraint::Length(area.height / 3), Constraint::Min(0)]).areas(area);
        self.draw_table(canvas, table, look);
        match self.focus {
            WEEKS => self.draw_weeks(canvas, below, look),
            _ => self.outlook.draw(canvas, below, look, true, FORECASTS),
        }
    }
}

impl Cash {
    fn draw_table(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let note = match self.table.note() {
            note if note.is_empty() => format!("{} now", dollars(look.company.seen.cash)),
            note => note,
        };
        canvas.click(area, Click::Pane(TABLE));
        let focused = self.focus == TABLE;
        let title = format!("Books of {}", week_words(self.week(), look.company));
        let inside = canvas.pane(area, &title, &note, focused);
        if self.books.is_none() {
            canvas.text(inside, "reading the ledger …", Role::Dim);
            return;
        }
        self.table.draw(canvas, inside, focused, TABLE);
        if focused {
            let open = look.keys.label(Action::Open).unwrap_or_default();
            canvas.pane_keys(area, &format!("{open} ledger rows · {}", look.hint(Action::Sort)));
        }
    }

    fn draw_falls(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        let week = self.week();
        let change = model::cash_around(company, week).map_or(0.0, |(before, after)| after - before);
        let note = arrow(change, &dollars(change.abs()));
        let inside =
            canvas.pane(area, &format!("From week {} to {week}", week.saturating_sub(1)), &note, false);
        let Some(books) = &self.books else { return };
        falls::draw(canvas, inside, &waterfall(books, company, week, inside.height as usize));
    }

    fn draw_weeks(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(WEEKS));
        let focused = self.focus == WEEKS;
        let inside = canvas.pane(area, "Weeks", "income above the line, costs below", focused);
        let Some(books) = &self.books else { return };
        bars::draw(canvas, inside, books, self.week(), WEEKS);
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
