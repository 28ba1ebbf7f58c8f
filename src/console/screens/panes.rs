//! Screens made of panes: what a pane is, and the host that owns the focus, borders, filters, clicks and zoom.
//!
//! A screen keeps the state, because its panes share it; each pane is one type that says how its part looks and acts.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::{Screen, ScreenState};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look, PaneKeys};
use crate::effect::Effect;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::widgets::{Field, Table};

/// What stands in the border of a pane.
#[derive(Default)]
pub struct Border {
    /// What the pane is.
    pub title: String,
    /// What is worth knowing about it, at the right.
    pub note: String,
    /// Keys that work in it, in the lower border while it has the focus.
    pub keys: String,
    /// The keys stand there without the focus, too: they work from every pane, or say what the pane can do.
    pub keys_always: bool,
}

/// Where a pane is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Seat {
    /// Its area, or the inside of its border.
    pub area: Rect,
    /// Whether it has the focus.
    pub focused: bool,
    /// Its number on the screen, for clicks on its rows.
    pub number: usize,
}

/// One pane of a screen `S`.
pub trait Pane<S> {
    /// Its table, if it is made of one: the host moves in it, filters and sorts it.
    fn table<'a>(&self, _: &'a S) -> Option<&'a Table> {
        None
    }

    /// The same, to be changed.
    fn table_mut<'a>(&self, _: &'a mut S) -> Option<&'a mut Table> {
        None
    }

    /// Scopes while it has the focus, the innermost first.
    fn scopes(&self, screen: &S) -> Vec<Scope> {
        match self.table(screen) {
            Some(table) if table.is_typing() => vec![Scope::Field, Scope::List],
            _ => vec![Scope::List],
        }
    }

    /// Whether a digit begins a number here instead of showing a screen.
    fn takes_numbers(&self, _: &S) -> bool {
        false
    }

    /// Actions worth showing in the footer.
    fn hints(&self, _: &S) -> Vec<Action> {
        Vec::new()
    }

    /// The figure that is selected.
    fn figure(&self, _: &S, _: &Look<'_>) -> Option<Figure> {
        None
    }

    /// Does an action.
    fn act(&self, screen: &mut S, action: Action, look: &Look<'_>) -> Vec<Effect> {
        if let Some(table) = self.table_mut(screen) {
            table.act(action, look.page);
        }
        Vec::new()
    }

    /// Takes a key that is typed into a text.
    fn key(&self, screen: &mut S, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        self.filter(screen, &mut |field| {
            field.key(key);
        });
        Vec::new()
    }

    /// Takes pasted text.
    fn paste(&self, screen: &mut S, text: &str, _: &Look<'_>) -> Vec<Effect> {
        self.filter(screen, &mut |field| field.insert(text));
        Vec::new()
    }

    /// Changes the filter while it is typed.
    fn filter(&self, screen: &mut S, edit: &mut dyn FnMut(&mut Field)) {
        if let Some(table) = self.table_mut(screen) {
            table.edit_filter(edit);
        }
    }

    /// A row was clicked; a second click on the same row opens it.
    fn click(&self, screen: &mut S, row: usize, look: &Look<'_>) -> Vec<Effect> {
        let Some(table) = self.table_mut(screen) else { return Vec::new() };
        let before = table.selected();
        table.select_place(row);
        if before == table.selected() { self.act(screen, Action::Open, look) } else { Vec::new() }
    }

    /// What stands in its border when it has an area.
    fn border(&self, _: &S, _: Rect, _: &Look<'_>) -> Border {
        Border::default()
    }

    /// Draws its inside.
    fn draw(&self, screen: &S, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>);

    /// Draws all of it into its area; a pane of more than one box does so itself.
    fn show(&self, screen: &S, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        draw_framed(self, screen, canvas, seat, look);
    }
}

/// An area that has room for a whole title.
const USUAL: Rect = Rect { x: 0, y: 0, width: 120, height: 40 };

/// Draws the border of a pane and its inside into an area.
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
    /// Names of its panes.
    type Name: Copy + PartialEq + 'static;

    /// The panes that can have the focus now, in the order of the tab key.
    fn panes(&self) -> &'static [Self::Name];

    /// What a name stands for.
    fn pane(name: Self::Name) -> &'static dyn Pane<Self>;

    /// The pane with the focus.
    fn focused(&self) -> Self::Name;

    /// Moves the focus to a pane.
    fn focus_on(&mut self, name: Self::Name);

    /// What lies over the panes for a while and takes every key; clicks on its rows have the number of panes.
    fn over(&self) -> Option<&'static dyn Pane<Self>> {
        None
    }

    /// Does what an action means whichever pane has the focus; none where that depends on the pane.
    fn act_anywhere(&mut self, _: Action, _: &Look<'_>) -> Option<Vec<Effect>> {
        None
    }

    /// Lays the panes out, each with [`draw_pane`].
    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>);
}

/// Draws a pane where it can be clicked.
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

/// What takes the keys.
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
        // What lies below can be seen but not clicked.
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
