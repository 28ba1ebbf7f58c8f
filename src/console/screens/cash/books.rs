//! The ledger of a week: every category with its change, mean and share.

use ratatui::layout::Rect;

use super::model::{Amounts, Books, CATEGORIES, Subject, days_of, money, side};
use super::{Cash, Selected, ledger_rows};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{compact, dollars, percent, short_dollars};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::arrow;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Table};
use novamind_worker::company::Company;

pub struct BooksPane;

impl Pane<Cash> for BooksPane {
    fn table<'a>(&self, cash: &'a Cash) -> Option<&'a Table> {
        Some(&cash.table)
    }

    fn table_mut<'a>(&self, cash: &'a mut Cash) -> Option<&'a mut Table> {
        Some(&mut cash.table)
    }

    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Open, Action::Sort, Action::Filter]
    }

    fn figure(&self, cash: &Cash, _: &Look<'_>) -> Option<Figure> {
        cash.figure_of(selected(cash))
    }

    fn act(&self, cash: &mut Cash, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match action {
            Action::Open => return ledger_rows(selected(cash)),
            Action::Close if cash.week.is_some() => {
                cash.walk_weeks(action);
            }
            action => {
                cash.table.act(action, look.page);
            }
        }
        Vec::new()
    }

    fn border(&self, cash: &Cash, _: Rect, look: &Look<'_>) -> Border {
        let open = look.keys.label(Action::Open).unwrap_or_default();
        Border {
            title: format!("Ledger of {}", week_words(cash.week(), look.company)),
            note: match cash.table.note() {
                note if note.is_empty() => format!("{} now", dollars(look.company.seen.cash)),
                note => note,
            },
            keys: format!("{open} ledger rows · {}", look.hint(Action::Sort)),
            ..Border::default()
        }
    }

    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        cash.table.draw(canvas, seat.area, seat.focused, seat.number);
    }
}

/// Returns the subject of the selected row, in the weeks of the selected column.
fn selected(cash: &Cash) -> Option<Selected> {
    let (subject, week) = (cash.subject()?, cash.week());
    let weeks = match cash.table.selected_column() {
        2 | 3 if week < 2 => return None,
        2 => (week - 1, week),
        3 => (week - 1, week - 1),
        4 => (week.saturating_sub(3).max(1.min(week)), week),
        5 => (1, cash.books.open_week()),
        _ => (week, week),
    };
    Some((subject, weeks))
}

fn week_words(week: u32, company: &Company) -> String {
    let (from, to) = days_of(week);
    format!("week {week} · days {from} to {}", to.min(company.seen.day.max(from)))
}

/// Returns the table of a week: columns, subjects of the rows, rows.
pub fn table_of(books: &Books, week: u32) -> (Vec<Column>, Vec<Subject>, Vec<Vec<Cell>>) {
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
    // Sums come before their parts, because small windows cut the end.
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
    // The change of a cost refers to its absolute value.
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
