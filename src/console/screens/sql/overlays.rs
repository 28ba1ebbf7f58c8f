//! Overlays of the SQL screen: history, named queries, save dialog, export and pivot.

use crossterm::event::KeyEvent;

use super::Sql;
use super::picker::{PickerItem, PickerResult, Picker};
use super::pivot_form::{PivotForm, PivotResult};
use super::save_query::SaveQueryForm;
use super::export::ExportMenu;
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use crate::screens::panes::{Pane, PanePlacement};
use novamind_record::folder::query_library::NamedQuery;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::TextField;

pub enum SqlOverlay {
    History(Picker),
    Library(Picker),
    SaveQuery(SaveQueryForm),
    Export(ExportMenu),
    Pivot(PivotForm),
}

impl SqlOverlay {
    pub fn pane(&self) -> &'static dyn Pane<Sql> {
        match self {
            SqlOverlay::History(_) | SqlOverlay::Library(_) => &PickerPane,
            SqlOverlay::SaveQuery(_) => &SaveQueryPane,
            SqlOverlay::Export(_) => &ExportPane,
            SqlOverlay::Pivot(_) => &PivotPane,
        }
    }
}

/// Overlay with a searchable list of statements.
struct PickerPane;

impl Pane<Sql> for PickerPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Field, Scope::Query]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn handle_action(&self, sql: &mut Sql, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        match (&mut sql.overlay, action) {
            // The key that opened the list selects the next statement. The key of the other list switches the lists.
            (Some(SqlOverlay::History(picker)), Action::History) => picker.select_next(),
            (Some(SqlOverlay::Library(picker)), Action::Library) => picker.select_next(),
            (Some(SqlOverlay::History(_)), Action::Library) => sql.open_library(),
            (Some(SqlOverlay::Library(_)), Action::History) => return sql.open_history(context),
            (Some(SqlOverlay::History(picker) | SqlOverlay::Library(picker)), action) => {
                let choice = picker.handle_action(action);
                return sql.apply_choice(choice);
            }
            _ => {}
        }
        Vec::new()
    }

    fn handle_key(&self, sql: &mut Sql, key: &KeyEvent, context: &ScreenContext<'_>) -> Vec<Effect> {
        if let Some(SqlOverlay::History(picker) | SqlOverlay::Library(picker)) = &mut sql.overlay {
            picker.handle_key(key, context.page_rows);
        }
        Vec::new()
    }

    fn edit_filter(&self, sql: &mut Sql, edit: &mut dyn FnMut(&mut TextField)) {
        if let Some(SqlOverlay::History(picker) | SqlOverlay::Library(picker)) = &mut sql.overlay {
            edit(picker.field());
            picker.update_matches();
        }
    }

    fn handle_click(&self, sql: &mut Sql, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        match &mut sql.overlay {
            Some(SqlOverlay::History(picker) | SqlOverlay::Library(picker)) => {
                let choice = picker.handle_click(row);
                sql.apply_choice(choice)
            }
            _ => Vec::new(),
        }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        if let Some(SqlOverlay::History(picker) | SqlOverlay::Library(picker)) = &sql.overlay {
            picker.draw(canvas, placement.area, placement.index);
        }
    }
}

struct SaveQueryPane;

impl Pane<Sql> for SaveQueryPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn handle_action(&self, sql: &mut Sql, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(SqlOverlay::SaveQuery(saving)) = &mut sql.overlay else { return Vec::new() };
        let effect = match action {
            Action::Commit => saving.submit(&sql.library),
            _ => None,
        };
        if effect.is_some() || action == Action::Discard {
            sql.overlay = None;
        }
        effect.into_iter().collect()
    }

    fn edit_filter(&self, sql: &mut Sql, edit: &mut dyn FnMut(&mut TextField)) {
        if let Some(SqlOverlay::SaveQuery(saving)) = &mut sql.overlay {
            edit(&mut saving.field);
        }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        if let Some(SqlOverlay::SaveQuery(saving)) = &sql.overlay {
            saving.draw(canvas, placement.area, &sql.library, context);
        }
    }
}

struct ExportPane;

impl Pane<Sql> for ExportPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Export, Scope::List]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Open, Action::Close]
    }

    fn handle_action(&self, sql: &mut Sql, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(SqlOverlay::Export(list)) = &mut sql.overlay else { return Vec::new() };
        let way = list.select_export(action);
        if way.is_some() || action == Action::Close {
            sql.overlay = None;
        }
        way.map_or_else(Vec::new, |way| sql.results.current().export(way))
    }

    fn edit_filter(&self, _: &mut Sql, _: &mut dyn FnMut(&mut TextField)) {}

    fn handle_click(&self, sql: &mut Sql, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(SqlOverlay::Export(list)) = &mut sql.overlay else { return Vec::new() };
        let way = list.select_row(row);
        self.handle_action(sql, way, context)
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        if let Some(SqlOverlay::Export(list)) = &sql.overlay {
            list.draw(canvas, placement.area, placement.index, &sql.results.current().export_label(), context);
        }
    }
}

struct PivotPane;

impl PivotPane {
    fn apply_step(sql: &mut Sql, step: PivotResult) -> Vec<Effect> {
        match step {
            PivotResult::Pending => return Vec::new(),
            PivotResult::Cancelled => sql.overlay = None,
            PivotResult::Run(statement) => return sql.edit_and_run_derived(&statement),
        }
        Vec::new()
    }
}

impl Pane<Sql> for PivotPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::List]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Open, Action::Close]
    }

    fn handle_action(&self, sql: &mut Sql, action: Action, _: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(SqlOverlay::Pivot(choice)) = &mut sql.overlay else { return Vec::new() };
        let step = choice.handle_action(action);
        PivotPane::apply_step(sql, step)
    }

    fn edit_filter(&self, _: &mut Sql, _: &mut dyn FnMut(&mut TextField)) {}

    fn handle_click(&self, sql: &mut Sql, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(SqlOverlay::Pivot(choice)) = &mut sql.overlay else { return Vec::new() };
        let step = choice.handle_click(row);
        PivotPane::apply_step(sql, step)
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        if let Some(SqlOverlay::Pivot(choice)) = &sql.overlay {
            choice.draw(canvas, placement.area, placement.index, context);
        }
    }
}

impl Sql {
    pub(super) fn open_history(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        self.editor.hide_completion();
        match self.history.picker(&context.company.past_queries) {
            Some(picker) => {
                self.overlay = Some(SqlOverlay::History(picker));
                Vec::new()
            }
            None => vec![Effect::ShowStatus("No queries in this run yet. Run a statement with f5.".to_owned())],
        }
    }

    pub(super) fn open_library(&mut self) {
        self.editor.hide_completion();
        let item = |query: &NamedQuery| PickerItem {
            tag: if query.is_user_query { "own" } else { "" },
            title: query.title.clone(),
            description: query.description.clone(),
            preview: query.body().to_owned(),
            sql: query.sql.clone(),
        };
        let items = self.library.queries().iter().map(item).collect();
        self.overlay = Some(SqlOverlay::Library(Picker::new("Library", "run", items)));
    }

    pub(super) fn open_save_query(&mut self) -> Vec<Effect> {
        self.editor.hide_completion();
        let Some(statement) = self.editor.statement() else {
            return vec![Effect::ShowError("No statement to save. Type one first.".to_owned())];
        };
        self.overlay = Some(SqlOverlay::SaveQuery(SaveQueryForm::new(statement.sql)));
        Vec::new()
    }

    pub(super) fn open_export(&mut self, context: &ScreenContext<'_>) -> Vec<Effect> {
        if !self.results.current().has_rows() {
            return vec![Effect::ShowError("No result to export. Run a statement first.".to_owned())];
        }
        self.overlay = Some(SqlOverlay::Export(ExportMenu::new(context.keys)));
        Vec::new()
    }

    /// Inserts a statement from the history, or inserts and runs a named query.
    fn apply_choice(&mut self, choice: PickerResult) -> Vec<Effect> {
        let named = matches!(self.overlay, Some(SqlOverlay::Library(_)));
        match choice {
            PickerResult::None => {}
            PickerResult::Closed => self.overlay = None,
            PickerResult::Statement(sql) if named => return self.edit_and_run(&sql),
            PickerResult::Statement(sql) => self.set_statement(&sql),
        }
        Vec::new()
    }
}
