//! The pane with the journal entries. The newest week is first.

use ratatui::layout::Rect;

use super::Journal;
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::Table;

pub struct EntriesPane;

impl Pane<Journal> for EntriesPane {
    fn table<'a>(&self, journal: &'a Journal) -> Option<&'a Table> {
        Some(&journal.table)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("journal.entries")
    }

    fn table_mut<'a>(&self, journal: &'a mut Journal) -> Option<&'a mut Table> {
        Some(&mut journal.table)
    }

    fn scopes(&self, journal: &Journal) -> Vec<Scope> {
        if journal.table.is_filter_open() { vec![Scope::Field] } else { vec![Scope::List, Scope::Notes] }
    }

    fn hints(&self, _: &Journal) -> Vec<Action> {
        vec![Action::Open, Action::Filter, Action::EditNotes]
    }

    fn figure(&self, journal: &Journal, _: &ScreenContext<'_>) -> Option<Figure> {
        journal.table.selected().and_then(|row| journal.figures.get(row)).cloned()
    }

    fn handle_action(&self, journal: &mut Journal, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let action = match action {
            Action::Open => {
                let whole = journal.table.selected().and_then(|row| journal.full_texts.get(row));
                let read = |(title, text): &(String, String)| Effect::ShowText(title.clone(), text.clone());
                return whole.map(read).into_iter().collect();
            }
            // In this pane, tab and shift-tab accept the filter text.
            Action::CommitNext | Action::CommitPrevious => Action::Commit,
            other => other,
        };
        journal.table.handle_action(action, context.page_rows);
        Vec::new()
    }

    fn border(&self, journal: &Journal, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        PaneBorder {
            title: "Journal".to_owned(),
            note: journal.entries_note(context),
            keys: context.hints(&[Action::Open, Action::Filter]),
            ..PaneBorder::default()
        }
    }

    fn draw(&self, journal: &Journal, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        journal.table.draw(canvas, placement.area, placement.focused, placement.index);
    }
}
