//! The ledger of a week: the amount, change, mean and share of every category.

use ratatui::layout::Rect;

use super::model::{CategoryAmounts, WeeklyLedger, CATEGORIES, LedgerSubject, days_of_week, format_money, income_or_cost_total};
use super::{Cash, SelectedSubject, ledger_rows};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{dollars, percent, short_dollars};
use novamind_tui::canvas::Canvas;
use novamind_tui::text::format_change;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, Table};
use novamind_worker::company::DisplayedCompany;

pub struct LedgerPane;

impl Pane<Cash> for LedgerPane {
    fn table<'a>(&self, cash: &'a Cash) -> Option<&'a Table> {
        Some(&cash.table)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("cash.ledger")
    }

    fn table_mut<'a>(&self, cash: &'a mut Cash) -> Option<&'a mut Table> {
        Some(&mut cash.table)
    }

    fn hints(&self, _: &Cash) -> Vec<Action> {
        vec![Action::Open, Action::Sort, Action::Filter]
    }

    fn figure(&self, cash: &Cash, _: &ScreenContext<'_>) -> Option<Figure> {
        cash.subject_figure(selected(cash))
    }

    fn handle_action(&self, cash: &mut Cash, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        match action {
            Action::Open => return ledger_rows(selected(cash)),
            Action::Close if cash.selected_week.is_some() => {
                cash.handle_week_action(action);
            }
            action => {
                cash.table.handle_action(action, context.page_rows);
            }
        }
        Vec::new()
    }

    fn border(&self, cash: &Cash, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let open = context.keys.label(Action::Open).unwrap_or_default();
        PaneBorder {
            title: format!("Ledger of {}", week_label(cash.week(), context.company)),
            note: match cash.table.summary() {
                note if note.is_empty() => format!("{} now", dollars(context.company.observation.cash)),
                note => note,
            },
            keys: format!("{open} ledger rows · {}", context.hint(Action::Sort)),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, cash: &Cash, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        cash.table.draw(canvas, placement.area, placement.focused, placement.index);
    }
}

/// Returns the subject of the selected row and the weeks of the selected column.
fn selected(cash: &Cash) -> Option<SelectedSubject> {
    let (subject, week) = (cash.subject()?, cash.week());
    let weeks = match cash.table.selected_column() {
        2 | 3 if week < 2 => return None,
        2 => (week - 1, week),
        3 => (week - 1, week - 1),
        4 => (week.saturating_sub(3).max(1.min(week)), week),
        5 => (1, cash.ledger.open_week()),
        _ => (week, week),
    };
    Some((subject, weeks))
}

fn week_label(week: u32, company: &DisplayedCompany) -> String {
    let (from, to) = days_of_week(week);
    format!("week {week} · days {from} to {}", to.min(company.observation.day.max(from)))
}

/// Returns the ledger table of a week: the columns, the subjects of the rows, and the rows.
pub fn ledger_table(ledger: &WeeklyLedger, week: u32) -> (Vec<TableColumn>, Vec<LedgerSubject>, Vec<Vec<TableCell>>) {
    let before = week.saturating_sub(1);
    let columns = vec![
        TableColumn::text("category").with_max_width(14),
        TableColumn::numeric(format!("week {week}")),
        TableColumn::numeric("change"),
        TableColumn::numeric(format!("week {before}")),
        TableColumn::numeric("4-wk mean"),
        TableColumn::numeric("run total"),
        TableColumn::numeric("share"),
    ];
    // Totals are listed before their components, because small windows cut off the last rows.
    let mut subjects = vec![LedgerSubject::Net];
    for income in [true, false] {
        let used = |at: &usize| CATEGORIES[*at].is_income == income && ledger.is_used(*at);
        subjects.push(if income { LedgerSubject::Income } else { LedgerSubject::Costs });
        subjects.extend((0..CATEGORIES.len()).filter(used).map(LedgerSubject::Category));
    }
    let all = [ledger.week(week), ledger.week(before), ledger.four_week_mean(week), ledger.total()];
    let rows = subjects.iter().map(|subject| ledger_row(subject, &all, week)).collect();
    (columns, subjects, rows)
}

fn ledger_row(subject: &LedgerSubject, all: &[CategoryAmounts; 4], week: u32) -> Vec<TableCell> {
    let [now, before, mean, total] = [0, 1, 2, 3].map(|at| subject.amount(&all[at]));
    let name = subject.name();
    let (is_income, role) = match subject {
        LedgerSubject::Category(at) => (CATEGORIES[*at].is_income, Role::Text),
        LedgerSubject::Costs => (false, Role::Strong),
        LedgerSubject::Income | LedgerSubject::Net => (true, Role::Strong),
    };
    // Costs are shown as negative amounts, so a higher cost is a fall of the shown amount, in every row.
    let change = now - before;
    let change_role = match change {
        0.0 => Role::Dim,
        change if change > 0.0 => Role::Good,
        _ => Role::Bad,
    };
    let whole = income_or_cost_total(&all[0], is_income).abs();
    let share = if *subject == LedgerSubject::Net || whole <= 0.0 { None } else { Some(now.abs() / whole) };
    let amount = |value: f64| TableCell::from_number(value, if value == 0.0 { "–".to_owned() } else { format_money(value) });
    let moved = if week < 2 { "–".to_owned() } else { format_change(change, &short_dollars(change.abs().round())) };
    vec![
        TableCell::from_text(match subject {
            LedgerSubject::Category(_) => format!("  {name}"),
            _ => name.to_owned(),
        })
        .with_role(role),
        amount(now).with_role(role),
        TableCell::from_number(change, moved).with_role(change_role),
        amount(before).with_role(Role::Dim),
        amount(mean).with_role(Role::Dim),
        TableCell::from_number(total, short_dollars(total)),
        share.map_or(TableCell::from_text("–"), |share| TableCell::from_number(share, percent(share, 1))),
    ]
}
