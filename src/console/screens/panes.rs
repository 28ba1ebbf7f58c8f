//! Screens that consist of panes: the trait of panes, and the code that manages focus, borders, filters, clicks and zoom.
//!
//! The screen owns the state, because the panes of the screen share the state. Each pane is a type without state that
//! defines the behavior and the drawing of one area.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Screen, ScreenState};
use crate::action::{Action, Scope};
use crate::context::{Figure, PaneKeys, ScreenContext};
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::widgets::{Table, TextField};

/// Texts in the border of a pane.
#[derive(Default)]
pub struct PaneBorder {
    /// Title of the pane, at the left of the upper border.
    pub title: String,
    /// Short status, at the right of the upper border.
    pub note: String,
    /// Keys that work in the pane, shown in the lower border while it has the focus.
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

    /// Returns the scopes that apply while the pane has the focus, the innermost first.
    fn scopes(&self, screen: &S) -> Vec<Scope> {
        match self.table(screen) {
            Some(table) if table.is_filter_open() => vec![Scope::Field, Scope::List],
            _ => vec![Scope::List],
        }
    }

    /// Returns whether a digit starts a number in the pane instead of switching screens.
    fn accepts_digits(&self, _: &S) -> bool {
        false
    }

    /// Returns the actions to show in the footer.
    fn hints(&self, _: &S) -> Vec<Action> {
        Vec::new()
    }

    /// Returns the figure that is selected in the pane, if any.
    fn figure(&self, _: &S, _: &ScreenContext<'_>) -> Option<Figure> {
        None
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

    /// Moves the focus to a pane.
    fn set_focused_pane(&mut self, name: Self::PaneId);

    /// Returns the overlay that temporarily covers the panes and receives all keys. For clicks on rows of the overlay,
    /// the pane index is the number of panes.
    fn overlay(&self) -> Option<&'static dyn Pane<Self>> {
        None
    }

    /// Handles an action that does not depend on the focused pane. Returns `None` if the focused pane must handle the action.
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
    if area.is_empty() {
        return;
    }
    let number = pane_index(screen, name);
    canvas.register_click(area, Click::Pane(number));
    let placement = PanePlacement { area, focused: screen.focused_pane() == name, index: number };
    S::pane(name).draw_with_border(screen, canvas, placement, context);
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

    fn accepts_digits(&self) -> bool {
        active_pane(self).accepts_digits(self)
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

    fn figure(&self, context: &ScreenContext<'_>) -> Option<Figure> {
        active_pane(self).figure(self, context)
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
            draw_pane(self, self.focused_pane(), canvas, area, context);
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
