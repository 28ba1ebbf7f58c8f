//! Screens made of panes: the pane trait, and the host that manages focus, borders, filters, clicks and zoom.
//!
//! The screen owns the state because its panes share it. Each pane is a type that defines the behavior and
//! drawing of its part.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Screen, ScreenState};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look, PaneKeys};
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::widgets::{Field, Table};

/// Texts in the border of a pane.
#[derive(Default)]
pub struct Border {
    /// Title, at the left.
    pub title: String,
    /// Status, at the right.
    pub note: String,
    /// Keys that work in the pane, shown in the lower border while it has the focus.
    pub keys: String,
    /// Shows the keys even without the focus: they work from every pane or describe what the pane offers.
    pub keys_always: bool,
}

/// Where and how a pane is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Seat {
    /// Its area, or the area inside its border.
    pub area: Rect,
    /// Whether it has the focus.
    pub focused: bool,
    /// Index on the screen, for clicks on its rows.
    pub number: usize,
}

/// A pane of a screen `S`.
pub trait Pane<S> {
    /// Returns its table, if it has one; the host moves, filters and sorts it.
    fn table<'a>(&self, _: &'a S) -> Option<&'a Table> {
        None
    }

    /// Returns its table for changes.
    fn table_mut<'a>(&self, _: &'a mut S) -> Option<&'a mut Table> {
        None
    }

    /// Returns the scopes while it has the focus, innermost first.
    fn scopes(&self, screen: &S) -> Vec<Scope> {
        match self.table(screen) {
            Some(table) if table.is_typing() => vec![Scope::Field, Scope::List],
            _ => vec![Scope::List],
        }
    }

    /// Returns whether a digit starts a number here instead of switching screens.
    fn takes_numbers(&self, _: &S) -> bool {
        false
    }

    /// Returns the actions for the footer.
    fn hints(&self, _: &S) -> Vec<Action> {
        Vec::new()
    }

    /// Returns the selected figure.
    fn figure(&self, _: &S, _: &Look<'_>) -> Option<Figure> {
        None
    }

    /// Runs an action.
    fn act(&self, screen: &mut S, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if let Some(table) = self.table_mut(screen) {
            table.act(action, look.page);
        }
        Vec::new()
    }

    /// Handles a key typed into a text field.
    fn key(&self, screen: &mut S, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        self.filter(screen, &mut |field| {
            field.key(key);
        });
        Vec::new()
    }

    /// Handles pasted text.
    fn paste(&self, screen: &mut S, text: &str, _: &Look<'_>) -> Vec<Effect> {
        self.filter(screen, &mut |field| field.insert(text));
        Vec::new()
    }

    /// Edits the filter.
    fn filter(&self, screen: &mut S, edit: &mut dyn FnMut(&mut Field)) {
        if let Some(table) = self.table_mut(screen) {
            table.edit_filter(edit);
        }
    }

    /// Handles a click on a row; a second click on the same row opens it.
    fn click(&self, screen: &mut S, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let Some(table) = self.table_mut(screen) else { return Vec::new() };
        let before = table.selected();
        table.select_place(row);
        if before == table.selected() { self.act(screen, Action::Open, look) } else { Vec::new() }
    }

    /// Returns the texts of its border for an area.
    fn border(&self, _: &S, _: Rect, _: &Look<'_>) -> Border {
        Border::default()
    }

    /// Draws the inside of the pane.
    fn draw(&self, screen: &S, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>);

    /// Draws the pane with its border. Panes with more than one box override this.
    fn show(&self, screen: &S, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        draw_framed(self, screen, canvas, seat, look);
    }
}

/// An area wide enough for complete titles.
const USUAL: Rect = Rect { x: 0, y: 0, width: 120, height: 40 };

/// Draws the border and the inside of a pane.
pub fn draw_framed<S>(
    pane: &(impl Pane<S> + ?Sized),
    screen: &S,
    canvas: &mut Canvas<'_>,
    seat: Seat,
    look: &Look<'_>,
) {
    let border = pane.border(screen, seat.area, look);
    let inside = canvas.pane(seat.area, &border.title, &border.note, seat.focused);
    if (seat.focused || border.keys_always) && !border.keys.is_empty() {
        canvas.pane_keys(seat.area, &border.keys);
    }
    pane.draw(screen, canvas, Seat { area: inside, ..seat }, look);
}

/// A screen made of panes.
pub trait Paned: ScreenState + Sized + 'static {
    /// Identifiers of its panes.
    type Name: Copy + PartialEq + 'static;

    /// Returns the panes that can take the focus now, in tab order.
    fn panes(&self) -> &'static [Self::Name];

    /// Returns the pane with this identifier.
    fn pane(name: Self::Name) -> &'static dyn Pane<Self>;

    /// Returns the focused pane.
    fn focused(&self) -> Self::Name;

    /// Moves the focus to a pane.
    fn focus_on(&mut self, name: Self::Name);

    /// Returns the overlay that temporarily covers the panes and takes every key. Clicks on its rows use the
    /// number of panes as index.
    fn over(&self) -> Option<&'static dyn Pane<Self>> {
        None
    }

    /// Runs an action that does not depend on the focused pane; returns `None` if it does.
    fn act_anywhere(&mut self, _: Action, _: &Look<'_>) -> Option<Vec<Effect>> {
        None
    }

    /// Lays out the panes and draws each with [`draw_pane`].
    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>);
}

/// Draws a pane and makes it clickable.
pub fn draw_pane<S: Paned>(screen: &S, name: S::Name, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    if area.is_empty() {
        return;
    }
    let number = number_of(screen, name);
    canvas.click(area, Click::Pane(number));
    let seat = Seat { area, focused: screen.focused() == name, number };
    S::pane(name).show(screen, canvas, seat, look);
}

fn number_of<S: Paned>(screen: &S, name: S::Name) -> usize {
    screen.panes().iter().position(|own| *own == name).unwrap_or(0)
}

fn focused<S: Paned>(screen: &S) -> &'static dyn Pane<S> {
    screen.over().unwrap_or_else(|| S::pane(screen.focused()))
}

impl<S: Paned> Screen for S {
    fn scopes(&self) -> Vec<Scope> {
        focused(self).scopes(self)
    }

    fn takes_numbers(&self) -> bool {
        focused(self).takes_numbers(self)
    }

    fn hints(&self) -> Vec<Action> {
        focused(self).hints(self)
    }

    fn pane_keys(&self, look: &Look<'_>) -> Vec<PaneKeys> {
        let keys = |pane: &'static dyn Pane<S>| PaneKeys {
            title: pane.border(self, USUAL, look).title,
            scopes: pane.scopes(self),
            hints: pane.hints(self),
        };
        if let Some(over) = self.over() {
            return vec![keys(over)];
        }
        let own = self.focused();
        let others = Paned::panes(self).iter().filter(|name| **name != own).map(|name| keys(S::pane(*name)));
        std::iter::once(keys(S::pane(own))).chain(others).collect()
    }

    fn panes(&self) -> usize {
        Paned::panes(self).len()
    }

    fn focus(&self) -> usize {
        number_of(self, self.focused())
    }

    fn set_focus(&mut self, pane: usize) {
        if let Some(name) = Paned::panes(self).get(pane) {
            self.focus_on(*name);
        }
    }

    fn depth(&self) -> usize {
        let filtered = focused(self).table(self).is_some_and(Table::is_filtered);
        usize::from(self.over().is_some()) + usize::from(filtered) + self.opened()
    }

    fn figure(&self, look: &Look<'_>) -> Option<Figure> {
        focused(self).figure(self, look)
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if let Some(over) = self.over() {
            return over.act(self, action, look);
        }
        match self.act_anywhere(action, look) {
            Some(effects) => effects,
            None => focused(self).act(self, action, look),
        }
    }

    fn key(&mut self, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect> {
        focused(self).key(self, key, look)
    }

    fn paste(&mut self, text: &str, look: &Look<'_>) -> Vec<Effect> {
        focused(self).paste(self, text, look)
    }

    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect> {
        // Panes below the overlay are visible but not clickable.
        if self.over().is_some() && pane < Screen::panes(self) {
            return Vec::new();
        }
        self.set_focus(pane);
        focused(self).click(self, row, look)
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        if canvas.zoomed {
            draw_pane(self, self.focused(), canvas, area, look);
        } else {
            self.arrange(canvas, area, look);
        }
        if let Some(over) = self.over() {
            over.draw(self, canvas, Seat { area, focused: true, number: Screen::panes(self) }, look);
        }
    }
}
