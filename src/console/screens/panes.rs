//! Screens that consist of panes: the trait of panes, and the code that manages focus, borders, filters, clicks and
//! zoom.
//!
//! The screen owns the state, because the panes of the screen share the state. Each pane is a type without state that
//! defines the behavior and the drawing of one area.

use std::collections::BTreeMap;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Screen, ScreenState};
use crate::action::{Action, Scope};
use crate::context::{EditorDocument, Figure, PaneKeys, ScreenContext};
use crate::effect::Effect;
use crate::own_commands::ListRows;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::widgets::{ColumnLayout, Table, TextField};

/// Texts in the border of a pane.
#[derive(Default)]
pub struct PaneBorder {
    /// Title of the pane, at the left of the upper border.
    pub title: String,
    /// Short status, at the right of the upper border.
    pub note: String,
    /// Keys that work in the pane, shown in the lower border while the pane has the focus.
    pub keys: String,
    /// Whether the keys are shown even without the focus, for example because they work in every pane.
    pub shows_keys_always: bool,
}

/// Area, focus and index of a pane, for drawing the pane.
#[derive(Debug, Clone, Copy)]
pub struct PanePlacement {
    /// Area of the pane. In [`Pane::draw`], the area inside the border.
    pub area: Rect,
    /// Whether the pane has the focus.
    pub focused: bool,
    /// Index of the pane on the screen, for clicks on its rows.
    pub index: usize,
}

/// A pane of a screen `S`.
pub trait Pane<S> {
    /// Returns the table of the pane, if any. The default methods navigate, filter and sort this table.
    fn table<'a>(&self, _: &'a S) -> Option<&'a Table> {
        None
    }

    /// Returns a mutable reference to the table of the pane, if any.
    fn table_mut<'a>(&self, _: &'a mut S) -> Option<&'a mut Table> {
        None
    }

    /// Returns the name under which the column layout of the table is saved. If the columns depend on a query, the
    /// table has no name.
    fn table_name(&self) -> Option<&'static str> {
        None
    }

    /// Returns the scopes that apply while the pane has the focus, the innermost first.
    fn scopes(&self, screen: &S) -> Vec<Scope> {
        match self.table(screen) {
            Some(table) if table.is_filter_open() => vec![Scope::Field, Scope::List],
            _ => vec![Scope::List],
        }
    }

    /// Returns the actions to show in the footer.
    fn hints(&self, _: &S) -> Vec<Action> {
        Vec::new()
    }

    /// Returns the figure that is selected in the pane, if any.
    fn figure(&self, _: &S, _: &ScreenContext<'_>) -> Option<Figure> {
        None
    }

    /// Returns the selected rows of the pane, or all displayed rows, if the pane has a list.
    fn list_rows(&self, screen: &S, all: bool) -> Option<ListRows> {
        let table = self.table(screen)?;
        let selected = table.selected();
        Some(ListRows::from_table(table, |row| all || selected == Some(row)))
    }

    /// Handles an action of one of the pane's scopes.
    fn handle_action(&self, screen: &mut S, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if let Some(table) = self.table_mut(screen) {
            table.handle_action(action, context.page_rows);
        }
        Vec::new()
    }

    /// Handles a key typed into a text field.
    fn handle_key(&self, screen: &mut S, key: &KeyEvent, _: &ScreenContext<'_>) -> Vec<Effect> {
        self.edit_filter(screen, &mut |field| {
            field.handle_key(key);
        });
        Vec::new()
    }

    /// Handles text that is pasted into the pane.
    fn paste(&self, screen: &mut S, text: &str, _: &ScreenContext<'_>) -> Vec<Effect> {
        self.edit_filter(screen, &mut |field| field.insert(text));
        Vec::new()
    }

    /// Applies an edit to the text of the filter.
    fn edit_filter(&self, screen: &mut S, edit: &mut dyn FnMut(&mut TextField)) {
        if let Some(table) = self.table_mut(screen) {
            table.edit_filter(edit);
        }
    }

    /// Returns the text of the pane that can be edited in another program, if any.
    fn editor_document(&self, _: &S) -> Option<EditorDocument> {
        None
    }

    /// Replaces the text of the pane with the text that another program returned.
    fn replace_document(&self, _: &mut S, _: &str) -> Vec<Effect> {
        Vec::new()
    }

    /// Handles a click on a row. A second click on the same row opens the row.
    fn handle_click(&self, screen: &mut S, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        let Some(table) = self.table_mut(screen) else { return Vec::new() };
        let before = table.selected();
        table.select_visible_row(row);
        if before == table.selected() {
            self.handle_action(screen, Action::Open, context)
        } else {
            Vec::new()
        }
    }

    /// Returns the texts in the border of the pane for an area.
    fn border(&self, _: &S, _: Rect, _: &ScreenContext<'_>) -> PaneBorder {
        PaneBorder::default()
    }

    /// Draws the content of the pane inside its border.
    fn draw(
        &self,
        screen: &S,
        canvas: &mut Canvas<'_>,
        placement: PanePlacement,
        context: &ScreenContext<'_>,
    );

    /// Draws the pane with its border. Panes with more than one box override this method.
    fn draw_with_border(
        &self,
        screen: &S,
        canvas: &mut Canvas<'_>,
        placement: PanePlacement,
        context: &ScreenContext<'_>,
    ) {
        draw_framed(self, screen, canvas, placement, context);
    }
}

/// An area wide enough for complete titles.
const TYPICAL_AREA: Rect = Rect { x: 0, y: 0, width: 120, height: 40 };

/// Draws the border and the content of a pane.
pub fn draw_framed<S>(
    pane: &(impl Pane<S> + ?Sized),
    screen: &S,
    canvas: &mut Canvas<'_>,
    placement: PanePlacement,
    context: &ScreenContext<'_>,
) {
    let border = pane.border(screen, placement.area, context);
    let inside = canvas.draw_pane_frame(placement.area, &border.title, &border.note, placement.focused);
    if (placement.focused || border.shows_keys_always) && !border.keys.is_empty() {
        canvas.draw_pane_keys(placement.area, &border.keys);
    }
    pane.draw(screen, canvas, PanePlacement { area: inside, ..placement }, context);
}

/// A screen that consists of panes.
pub trait PaneScreen: ScreenState + Sized + 'static {
    /// Type of the identifiers of the screen's panes.
    type PaneId: Copy + PartialEq + 'static;

    /// Returns the panes that can currently take the focus, in tab order.
    fn panes(&self) -> &'static [Self::PaneId];

    /// Returns the pane with an identifier.
    fn pane(name: Self::PaneId) -> &'static dyn Pane<Self>;

    /// Returns the focused pane.
    fn focused_pane(&self) -> Self::PaneId;

    /// Returns the pane that is enlarged to the whole screen.
    fn enlarged_pane(&self) -> Self::PaneId {
        self.focused_pane()
    }

    /// Moves the focus to a pane, and ends an edit in any pane. The typed text is kept as a draft.
    fn set_focused_pane(&mut self, name: Self::PaneId);

    /// Returns the overlay that temporarily covers the panes and receives all keys. For clicks on rows of the overlay,
    /// the pane index is the number of panes.
    fn overlay(&self) -> Option<&'static dyn Pane<Self>> {
        None
    }

    /// Handles an action that does not depend on the focused pane. Returns `None` if the focused pane must handle the
    /// action.
    fn handle_screen_action(&mut self, _: Action, _: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        None
    }

    /// Lays out the panes and draws each pane with [`draw_pane`].
    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>);
}

/// Draws a pane with its border and registers the pane for clicks.
pub fn draw_pane<S: PaneScreen>(
    screen: &S,
    name: S::PaneId,
    canvas: &mut Canvas<'_>,
    area: Rect,
    context: &ScreenContext<'_>,
) {
    draw_pane_as(screen, name, screen.focused_pane() == name, canvas, area, context);
}

/// Draws a pane with or without the focus.
fn draw_pane_as<S: PaneScreen>(
    screen: &S,
    name: S::PaneId,
    focused: bool,
    canvas: &mut Canvas<'_>,
    area: Rect,
    context: &ScreenContext<'_>,
) {
    if area.is_empty() {
        return;
    }
    let number = pane_index(screen, name);
    canvas.register_click(area, Click::Pane(number));
    let placement = PanePlacement { area, focused, index: number };
    S::pane(name).draw_with_border(screen, canvas, placement, context);
}

/// Draws one of several panes that share an area: the focused pane, or the first pane if none of them has the focus.
/// The area does not depend on the focus, so moving the focus does not move other panes. A mark in the lower border
/// shows the number of panes.
pub fn draw_stack<S: PaneScreen>(
    screen: &S,
    names: &[S::PaneId],
    canvas: &mut Canvas<'_>,
    area: Rect,
    context: &ScreenContext<'_>,
) {
    let available: Vec<S::PaneId> =
        names.iter().copied().filter(|name| screen.panes().contains(name)).collect();
    let front = available.iter().position(|name| *name == screen.focused_pane()).unwrap_or(0);
    let Some(name) = available.get(front) else { return };
    draw_pane(screen, *name, canvas, area, context);
    if available.len() > 1 {
        canvas.draw_stack_mark(area, front, available.len());
    }
}

fn pane_index<S: PaneScreen>(screen: &S, name: S::PaneId) -> usize {
    screen.panes().iter().position(|id| *id == name).unwrap_or(0)
}

fn active_pane<S: PaneScreen>(screen: &S) -> &'static dyn Pane<S> {
    screen.overlay().unwrap_or_else(|| S::pane(screen.focused_pane()))
}

impl<S: PaneScreen> Screen for S {
    fn scopes(&self) -> Vec<Scope> {
        active_pane(self).scopes(self)
    }

    fn hints(&self) -> Vec<Action> {
        active_pane(self).hints(self)
    }

    fn pane_keys(&self, context: &ScreenContext<'_>) -> Vec<PaneKeys> {
        let keys = |pane: &'static dyn Pane<S>| PaneKeys {
            title: pane.border(self, TYPICAL_AREA, context).title,
            scopes: pane.scopes(self),
            hints: pane.hints(self),
        };
        if let Some(over) = self.overlay() {
            return vec![keys(over)];
        }
        let focused = self.focused_pane();
        let others =
            PaneScreen::panes(self).iter().filter(|name| **name != focused).map(|name| keys(S::pane(*name)));
        std::iter::once(keys(S::pane(focused))).chain(others).collect()
    }

    fn pane_count(&self) -> usize {
        PaneScreen::panes(self).len()
    }

    fn focused_index(&self) -> usize {
        pane_index(self, self.focused_pane())
    }

    fn set_focus(&mut self, pane: usize) {
        if let Some(name) = PaneScreen::panes(self).get(pane) {
            self.set_focused_pane(*name);
        }
    }

    fn escape_depth(&self) -> usize {
        let filtered = active_pane(self).table(self).is_some_and(Table::is_filtered);
        usize::from(self.overlay().is_some()) + usize::from(filtered) + self.screen_escape_depth()
    }

    fn row_counts(&self) -> Option<(usize, usize)> {
        active_pane(self).table(self).map(|table| (table.visible_rows().len(), table.rows().len()))
    }

    fn figure(&self, context: &ScreenContext<'_>) -> Option<Figure> {
        active_pane(self).figure(self, context)
    }

    fn focused_table(&self, context: &ScreenContext<'_>) -> Option<(String, &Table)> {
        let pane = active_pane(self);
        let table = pane.table(self).filter(|table| table.columns().len() > 1)?;
        Some((pane.border(self, TYPICAL_AREA, context).title, table))
    }

    fn set_focused_layout(&mut self, layout: ColumnLayout) -> Option<&'static str> {
        let pane = active_pane(self);
        pane.table_mut(self)?.set_layout(layout);
        pane.table_name()
    }

    fn set_layouts(&mut self, layouts: &BTreeMap<String, ColumnLayout>) {
        if layouts.is_empty() {
            return;
        }
        let panes = PaneScreen::panes(self).iter().map(|name| S::pane(*name)).chain(self.overlay());
        for pane in panes.collect::<Vec<_>>() {
            let layout = pane.table_name().and_then(|name| layouts.get(name));
            if let (Some(layout), Some(table)) = (layout, pane.table_mut(self))
                && table.layout() != layout
            {
                table.set_layout(layout.clone());
            }
        }
    }

    fn list_rows(&self, all: bool) -> Option<ListRows> {
        active_pane(self).list_rows(self, all)
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if let Some(over) = self.overlay() {
            return over.handle_action(self, action, context);
        }
        match self.handle_screen_action(action, context) {
            Some(effects) => effects,
            None => active_pane(self).handle_action(self, action, context),
        }
    }

    fn handle_key(&mut self, key: &KeyEvent, context: &ScreenContext<'_>) -> Vec<Effect> {
        active_pane(self).handle_key(self, key, context)
    }

    fn paste(&mut self, text: &str, context: &ScreenContext<'_>) -> Vec<Effect> {
        active_pane(self).paste(self, text, context)
    }

    fn editor_document(&self) -> Option<EditorDocument> {
        active_pane(self).editor_document(self)
    }

    fn replace_document(&mut self, text: &str, _: &ScreenContext<'_>) -> Vec<Effect> {
        active_pane(self).replace_document(self, text)
    }

    fn handle_click(&mut self, pane: usize, row: usize, context: &ScreenContext<'_>) -> Vec<Effect> {
        // Panes below the overlay are visible but not clickable.
        if self.overlay().is_some() && pane < Screen::pane_count(self) {
            return Vec::new();
        }
        self.set_focus(pane);
        active_pane(self).handle_click(self, row, context)
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        if canvas.zoomed {
            draw_pane_as(self, self.enlarged_pane(), true, canvas, area, context);
        } else {
            self.draw_panes(canvas, area, context);
        }
        if let Some(over) = self.overlay() {
            over.draw(
                self,
                canvas,
                PanePlacement { area, focused: true, index: Screen::pane_count(self) },
                context,
            );
        }
    }
}
