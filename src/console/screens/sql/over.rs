//! Overlays: history, named queries, save dialog, export, pivot.

use crossterm::event::KeyEvent;

use super::Sql;
use super::picker::{ListedQuery, PickedQuery, Picker};
use super::pivot::{PivotChoice, PivotStep};
use super::saving::Saving;
use super::takeout::TakeOut;
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use crate::screens::panes::{Pane, Seat};
use novamind_record::folder::library::NamedQuery;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Field;

pub enum Over {
    Earlier(Picker),
    Library(Picker),
    Saving(Saving),
    TakeOut(TakeOut),
    Pivot(PivotChoice),
}

impl Over {
    pub fn pane(&self) -> &'static dyn Pane<Sql> {
        match self {
            Over::Earlier(_) | Over::Library(_) => &PickerPane,
            Over::Saving(_) => &SavingPane,
            Over::TakeOut(_) => &TakeOutPane,
            Over::Pivot(_) => &PivotPane,
        }
    }
}

/// List of statements with search.
struct PickerPane;

impl Pane<Sql> for PickerPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Field, Scope::Query]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn act(&self, sql: &mut Sql, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match (&mut sql.over, action) {
            // The same key selects the next statement; the other key switches the list.
            (Some(Over::Earlier(picker)), Action::History) => picker.next(),
            (Some(Over::Library(picker)), Action::Library) => picker.next(),
            (Some(Over::Earlier(_)), Action::Library) => sql.find_named(),
            (Some(Over::Library(_)), Action::History) => return sql.find_earlier(look),
            (Some(Over::Earlier(picker) | Over::Library(picker)), action) => {
                let choice = picker.act(action);
                return sql.choose(choice);
            }
            _ => {}
        }
        Vec::new()
    }

    fn key(&self, sql: &mut Sql, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect> {
        if let Some(Over::Earlier(picker) | Over::Library(picker)) = &mut sql.over {
            picker.key(key, look.page);
        }
        Vec::new()
    }

    fn filter(&self, sql: &mut Sql, edit: &mut dyn FnMut(&mut Field)) {
        if let Some(Over::Earlier(picker) | Over::Library(picker)) = &mut sql.over {
            edit(picker.field());
            picker.find();
        }
    }

    fn click(&self, sql: &mut Sql, row: usize, _: &Look<'_>) -> Vec<Effect> {
        match &mut sql.over {
            Some(Over::Earlier(picker) | Over::Library(picker)) => {
                let choice = picker.click(row);
                sql.choose(choice)
            }
            _ => Vec::new(),
        }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        if let Some(Over::Earlier(picker) | Over::Library(picker)) = &sql.over {
            picker.draw(canvas, seat.area, seat.number);
        }
    }
}

struct SavingPane;

impl Pane<Sql> for SavingPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Field]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Commit, Action::Discard]
    }

    fn act(&self, sql: &mut Sql, action: Action, _: &Look<'_>) -> Vec<Effect> {
        let Some(Over::Saving(saving)) = &mut sql.over else { return Vec::new() };
        let effect = match action {
            Action::Commit => saving.commit(&sql.library),
            _ => None,
        };
        if effect.is_some() || action == Action::Discard {
            sql.over = None;
        }
        effect.into_iter().collect()
    }

    fn filter(&self, sql: &mut Sql, edit: &mut dyn FnMut(&mut Field)) {
        if let Some(Over::Saving(saving)) = &mut sql.over {
            edit(&mut saving.field);
        }
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if let Some(Over::Saving(saving)) = &sql.over {
            saving.draw(canvas, seat.area, &sql.library, look);
        }
    }
}

struct TakeOutPane;

impl Pane<Sql> for TakeOutPane {
    fn scopes(&self, _: &Sql) -> Vec<Scope> {
        vec![Scope::Export, Scope::List]
    }

    fn hints(&self, _: &Sql) -> Vec<Action> {
        vec![Action::Open, Action::Close]
    }

    fn act(&self, sql: &mut Sql, action: Action, _: &Look<'_>) -> Vec<Effect> {
        let Some(Over::TakeOut(list)) = &mut sql.over else { return Vec::new() };
        let way = list.act(action);
        if way.is_some() || action == Action::Close {
            sql.over = None;
        }
        way.map_or_else(Vec::new, |way| sql.results.shown().take_out(way))
    }

    fn filter(&self, _: &mut Sql, _: &mut dyn FnMut(&mut Field)) {}

    fn click(&self, sql: &mut Sql, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let Some(Over::TakeOut(list)) = &mut sql.over else { return Vec::new() };
        let way = list.click(row);
        self.act(sql, way, look)
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if let Some(Over::TakeOut(list)) = &sql.over {
            list.draw(canvas, seat.area, seat.number, &sql.results.shown().what_is_taken(), look);
        }
    }
}

struct PivotPane;

impl PivotPane {
    fn step(sql: &mut Sql, step: PivotStep) -> Vec<Effect> {
        match step {
            PivotStep::Choosing => return Vec::new(),
            PivotStep::Left => sql.over = None,
            PivotStep::Run(statement) => return sql.edit_and_run_derived(&statement),
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

    fn act(&self, sql: &mut Sql, action: Action, _: &Look<'_>) -> Vec<Effect> {
        let Some(Over::Pivot(choice)) = &mut sql.over else { return Vec::new() };
        let step = choice.act(action);
        PivotPane::step(sql, step)
    }

    fn filter(&self, _: &mut Sql, _: &mut dyn FnMut(&mut Field)) {}

    fn click(&self, sql: &mut Sql, row: usize, _: &Look<'_>) -> Vec<Effect> {
        let Some(Over::Pivot(choice)) = &mut sql.over else { return Vec::new() };
        let step = choice.click(row);
        PivotPane::step(sql, step)
    }

    fn draw(&self, sql: &Sql, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        if let Some(Over::Pivot(choice)) = &sql.over {
            choice.draw(canvas, seat.area, seat.number, look);
        }
    }
}

impl Sql {
    pub(super) fn find_earlier(&mut self, look: &Look<'_>) -> Vec<Effect> {
        self.editor.hide_completion();
        match self.history.picker(&look.company.asked) {
            Some(picker) => {
                self.over = Some(Over::Earlier(picker));
                Vec::new()
            }
            None => vec![Effect::Say("No queries in this run yet. Run a statement with f5.".to_owned())],
        }
    }

    pub(super) fn find_named(&mut self) {
        self.editor.hide_completion();
        let item = |query: &NamedQuery| ListedQuery {
            tag: if query.own { "own" } else { "" },
            title: query.title.clone(),
            what: query.what.clone(),
            preview: query.body().to_owned(),
            sql: query.sql.clone(),
        };
        let items = self.library.queries().iter().map(item).collect();
        self.over = Some(Over::Library(Picker::new("Library", "run", items)));
    }

    pub(super) fn save(&mut self) -> Vec<Effect> {
        self.editor.hide_completion();
        let Some(statement) = self.editor.statement() else {
            return vec![Effect::Complain("No statement to save. Type one first.".to_owned())];
        };
        self.over = Some(Over::Saving(Saving::of(statement.sql)));
        Vec::new()
    }

    pub(super) fn take_out(&mut self) -> Vec<Effect> {
        if !self.results.shown().has_rows() {
            return vec![Effect::Complain("No result to export. Run a statement first.".to_owned())];
        }
        self.over = Some(Over::TakeOut(TakeOut::default()));
        Vec::new()
    }

    /// Inserts a statement from the history, or inserts and runs a named query.
    fn choose(&mut self, choice: PickedQuery) -> Vec<Effect> {
        let named = matches!(self.over, Some(Over::Library(_)));
        match choice {
            PickedQuery::None => {}
            PickedQuery::Closed => self.over = None,
            PickedQuery::Statement(sql) if named => return self.edit_and_run(&sql),
            PickedQuery::Statement(sql) => self.edit(&sql),
        }
        Vec::new()
    }
}
