//! Table of all groups with their study levels and next market studies.

use ratatui::layout::Rect;

use super::model::{GroupKnowledge, study_level, group_name, running_study, target_level, undiscovered_count};
use super::{Market, knowledge_figure};
use crate::action::Action;
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{compact_number, percent};
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{TableCell, TableColumn, TextField, Table};
use novamind_worker::company::DisplayedCompany;

pub struct KnownGroupsPane;

impl Pane<Market> for KnownGroupsPane {
    fn table<'a>(&self, market: &'a Market) -> Option<&'a Table> {
        Some(&market.table)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("market.groups")
    }

    fn table_mut<'a>(&self, market: &'a mut Market) -> Option<&'a mut Table> {
        Some(&mut market.table)
    }

    fn scopes(&self, market: &Market) -> Vec<super::Scope> {
        super::table_scopes(&market.table)
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        super::GROUP_HINTS.to_vec()
    }

    fn figure(&self, market: &Market, context: &ScreenContext<'_>) -> Option<Figure> {
        let (term, what) = match market.table.selected_column() {
            2 | 3 => ("group_info_levels.info_level", "study level of"),
            4 => ("research_group.target_level", "the next study of"),
            5 => ("group_info_levels.discovered_day", "discovery day of"),
            6 => ("group_info_levels.last_research_day", "last study of"),
            _ => ("group_info_levels.group_id", "facts about"),
        };
        knowledge_figure(market.group()?, context.company, term, what)
    }

    fn handle_action(&self, market: &mut Market, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            return market.show_customers_effect(context.company);
        }
        let before = market.group();
        super::move_in_table(&mut market.table, action, context);
        market.reset_report_if_changed(before);
        Vec::new()
    }

    fn edit_filter(&self, market: &mut Market, edit: &mut dyn FnMut(&mut TextField)) {
        let before = market.group();
        market.table.edit_filter(edit);
        market.reset_report_if_changed(before);
    }

    fn handle_click(&self, market: &mut Market, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let before = market.group();
        market.table.select_visible_row(row);
        let again = before == market.group();
        market.reset_report_if_changed(before);
        if again { market.show_customers_effect(context.company) } else { Vec::new() }
    }

    fn border(&self, market: &Market, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let known = context.company.observation.known_groups.len();
        let note = match market.table.summary() {
            note if note.is_empty() => format!("{known} known · {} to find", undiscovered_count(context.company)),
            note => note,
        };
        let open = context.keys.label(Action::Open).unwrap_or_default();
        let keys = context.hints(&[Action::FindGroup, Action::StudyGroup, Action::Filter]);
        let mut keys = format!("{open} customers of the group · {keys}");
        if context.company.can_inspect {
            keys = format!("{} · {keys}", context.hint(Action::HiddenValues));
        }
        PaneBorder { title: "Groups".to_owned(), note, keys, ..PaneBorder::default() }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        market.table.draw(canvas, placement.area, placement.focused, placement.index);
    }
}

pub fn columns() -> Vec<TableColumn> {
    let mut columns = vec![TableColumn::text("group"), TableColumn::text("name").with_max_width(28).with_min_width(10)];
    columns.extend(["level", "error"].map(TableColumn::numeric));
    columns.push(TableColumn::text("next study").indivisible());
    columns.extend(["found", "as of"].map(TableColumn::numeric));
    columns
}

pub fn group_row(group: Group, known: GroupKnowledge, company: &DisplayedCompany) -> Vec<TableCell> {
    let level = study_level(company, group);
    let none = || TableCell::from_text("–").with_role(Role::Dim);
    if level == 0 {
        let not_found = TableCell::from_text("not found yet").with_role(Role::Dim);
        let id = TableCell::from_text(group.id()).with_role(Role::Dim);
        return vec![id, not_found, none(), none(), none(), none(), none()];
    }
    let day = |day: Option<u32>| match day {
        Some(day) => TableCell::from_number(f64::from(day), format!("day {day}")),
        None => none(),
    };
    let found = match known.found_day {
        Some(0) if known.studied_day.is_none() => TableCell::from_number(0.0, "start").with_role(Role::Dim),
        found => day(found),
    };
    let figures = match company.fit(group) {
        Some(fit) => TableCell::from_number(f64::from(fit.study_day), format!("day {} · {}d old", fit.study_day, fit.age_days)),
        None => none(),
    };
    let noise = company.tool_limits.study_level(level).map_or(0.0, |level| level.noise);
    let next = match running_study(company, group) {
        Some(study) => {
            TableCell::from_text(format!("→{} due day {}", study.target, study.due_day)).with_role(Role::Warning)
        }
        None => {
            let target = target_level(company, group, None);
            let terms = company.tool_limits.study_level(target).map_or(String::new(), |level| {
                format!(" ${} {}d ±{}", compact_number(level.cost), level.days, percent(level.noise, 0))
            });
            TableCell::from_text(format!("→{target}{terms}")).with_role(Role::Dim)
        }
    };
    vec![
        TableCell::from_text(group.id()).with_role(Role::Strong),
        TableCell::from_text(group_name(company, group)),
        TableCell::from_number(f64::from(level), level.to_string()),
        TableCell::from_number(noise, format!("±{}", percent(noise, 0))),
        next,
        found,
        figures,
    ]
}
