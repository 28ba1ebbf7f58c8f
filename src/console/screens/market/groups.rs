//! Table of all groups with study levels and next studies.

use ratatui::layout::Rect;

use super::model::{Known, level_of, name_of, study_of, target_of, undiscovered};
use super::{Market, knowledge_of};
use crate::action::Action;
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{compact, percent};
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Cell, Column, Field, Table};
use novamind_worker::company::Company;

pub struct KnownGroupsPane;

impl Pane<Market> for KnownGroupsPane {
    fn table<'a>(&self, market: &'a Market) -> Option<&'a Table> {
        Some(&market.table)
    }

    fn table_mut<'a>(&self, market: &'a mut Market) -> Option<&'a mut Table> {
        Some(&mut market.table)
    }

    fn scopes(&self, market: &Market) -> Vec<super::Scope> {
        super::scopes(&market.table)
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        super::GROUP_HINTS.to_vec()
    }

    fn figure(&self, market: &Market, look: &Look<'_>) -> Option<Figure> {
        let (term, what) = match market.table.selected_column() {
            2 | 3 => ("group_info_levels.info_level", "study level of"),
            4 => ("research_group.target_level", "the next study of"),
            5 => ("group_info_levels.discovered_day", "day found of"),
            6 => ("group_info_levels.last_research_day", "last study of"),
            _ => ("group_info_levels.group_id", "facts about"),
        };
        knowledge_of(market.group()?, look.company, term, what)
    }

    fn act(&self, market: &mut Market, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return market.show_customers(look.company);
        }
        let before = market.group();
        super::walk(&mut market.table, action, look);
        market.turn_from(before);
        Vec::new()
    }

    fn filter(&self, market: &mut Market, edit: &mut dyn FnMut(&mut Field)) {
        let before = market.group();
        market.table.edit_filter(edit);
        market.turn_from(before);
    }

    fn click(&self, market: &mut Market, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let before = market.group();
        market.table.select_place(row);
        let again = before == market.group();
        market.turn_from(before);
        if again { market.show_customers(look.company) } else { Vec::new() }
    }

    fn border(&self, market: &Market, _: Rect, look: &Look<'_>) -> Border {
        let known = look.company.seen.known_groups.len();
        let note = match market.table.note() {
            note if note.is_empty() => format!("{known} known · {} to find", undiscovered(look.company)),
            note => note,
        };
        let open = look.keys.label(Action::Open).unwrap_or_default();
        let keys = look.hints(&[Action::FindGroup, Action::StudyGroup, Action::Filter]);
        let mut keys = format!("{open} customers of the group · {keys}");
        if look.company.may_look_inside {
            keys = format!("{} · {keys}", look.hint(Action::HiddenValues));
        }
        Border { title: "Groups".to_owned(), note, keys, ..Border::default() }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        market.table.draw(canvas, seat.area, seat.focused, seat.number);
    }
}

pub fn columns() -> Vec<Column> {
    let mut columns = vec![Column::words("group"), Column::words("name").at_most(28).at_least(20)];
    columns.extend(["level", "error"].map(Column::numbers));
    columns.push(Column::words("next study"));
    columns.extend(["found", "as of"].map(Column::numbers));
    columns
}

pub fn row_of(group: Group, known: Known, company: &Company) -> Vec<Cell> {
    let level = level_of(company, group);
    let none = || Cell::words("–").role(Role::Dim);
    if level == 0 {
        let not_found = Cell::words("not found yet").role(Role::Dim);
        let id = Cell::words(group.id()).role(Role::Dim);
        return vec![id, not_found, none(), none(), none(), none(), none()];
    }
    let day = |day: Option<u32>| match day {
        Some(day) => Cell::number(f64::from(day), format!("day {day}")),
        None => none(),
    };
    let found = match known.found {
        Some(0) if known.studied.is_none() => Cell::number(0.0, "start").role(Role::Dim),
        found => day(found),
    };
    let figures = match company.fit(group) {
        Some(fit) => Cell::number(f64::from(fit.as_of), format!("day {} · {}d old", fit.as_of, fit.age)),
        None => none(),
    };
    let noise = company.terms.level(level).map_or(0.0, |level| level.noise);
    let next = match study_of(company, group) {
        Some(study) => {
            Cell::words(format!("→{} due day {}", study.target, study.due_day)).role(Role::Warning)
        }
        None => {
            let target = target_of(company, group, None);
            let terms = company.terms.level(target).map_or(String::new(), |level| {
                format!(" ${} {}d ±{}", compact(level.cost), level.days, percent(level.noise, 0))
            });
            Cell::words(format!("→{target}{terms}")).role(Role::Dim)
        }
    };
    vec![
        Cell::words(group.id()).role(Role::Strong),
        Cell::words(name_of(company, group)),
        Cell::number(f64::from(level), level.to_string()),
        Cell::number(noise, format!("±{}", percent(noise, 0))),
        next,
        found,
        figures,
    ]
}
