//! The screens. Each keeps where the person is in it, turns actions into effects, and draws itself from what
//! holds; drawing changes and computes nothing that matters.

pub mod menu;
pub mod panes;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::action::{Action, Scope};
use super::context::{Figure, Look, PaneKeys, ScreenId};
use super::effect::Effect;
use novamind_database::Rows;
use novamind_tui::canvas::Canvas;
use novamind_worker::message::News;
use novamind_worker::readings::Reading;

/// The module of each screen.
macro_rules! screens {
    ($($(#[$doc:meta])* $Screen:ident in $room:ident,)*) => {
        $(pub mod $room;)*

        /// Every screen of a run.
        #[derive(Default)]
        pub struct Screens { $($(#[$doc])* pub $room: $room::$Screen,)* }

        impl Screens {
            /// A screen.
            pub fn get(&self, id: ScreenId) -> &dyn Screen {
                match id { $(ScreenId::$Screen => &self.$room,)* }
            }

            /// A screen, to change it.
            pub fn get_mut(&mut self, id: ScreenId) -> &mut dyn Screen {
                match id { $(ScreenId::$Screen => &mut self.$room,)* }
            }
        }
    };
}

screens! {
    /// The company at a glance.
    Overview in overview,
    /// Where money comes from and goes to.
    Cash in cash,
    /// The customer groups.
    Customers in customers,
    /// Quality, capacity, issues, R&D.
    Product in product,
    /// What people write, and our posts.
    Social in social,
    /// Negotiations with companies.
    Inbox in inbox,
    /// Groups, studies, the economy.
    Market in market,
    /// Forms of all tools.
    Tools in tools,
    /// The database.
    Sql in sql,
    /// What was done.
    Journal in journal,
    /// Hidden state, where it may be shown.
    Xray in xray,
}

/// What a screen keeps: it is told what happened, and what the database answered.
pub trait ScreenState {
    /// What it asks the database for.
    fn readings(&self) -> &'static [Reading] {
        &[]
    }

    /// Takes what the database answered.
    fn take(&mut self, _: Reading, _: &Rows, _: &Look<'_>) {}

    /// The person sees it now, or the company has changed while they do: what it asks the run for.
    fn ask_run(&mut self, _: &Look<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// The company has changed.
    fn renew(&mut self, _: &Look<'_>) {}

    /// Takes news that concern it; effects follow.
    fn hear(&mut self, _: &News, _: &Look<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// Takes the answers that it waits for, if they have arrived; effects follow.
    fn take_answers(&mut self, _: &Look<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// The person sees it now, or saw it until now.
    fn looked_at(&mut self) {}

    /// How much on it was not looked at yet, for the badge.
    fn unseen(&self) -> usize {
        0
    }

    /// What is open here beside a list or instead of it: a group, a tool.
    fn open_here(&self, _: &Look<'_>) -> Option<String> {
        None
    }

    /// What is open has taken the place of the list that led to it.
    fn covers_list(&self) -> bool {
        false
    }

    /// How many things esc closes here, one after the other, without those that every pane has.
    fn opened(&self) -> usize {
        0
    }

    /// The object that is open on it: what kind of object, and which, as the record names them.
    fn open_object(&self, _: &Look<'_>) -> Option<(&'static str, String)> {
        None
    }

    /// The text that is being edited: its place, as the record names it, and what it says.
    fn edited(&self) -> Option<(String, String)> {
        None
    }

    /// Whether text would be lost with the program.
    fn holds_unsent_text(&self) -> bool {
        false
    }
}

/// One screen: how it acts and is drawn. Screens made of panes have it from [`panes::Paned`].
pub trait Screen: ScreenState {
    /// Scopes of the focused place, the innermost first; the global one is added by the caller. A text scope first
    /// means that characters are typed.
    fn scopes(&self) -> Vec<Scope>;

    /// Whether a digit begins a number where the focus is, instead of showing a screen.
    fn takes_numbers(&self) -> bool;

    /// Actions worth showing in the footer.
    fn hints(&self) -> Vec<Action>;

    /// The keys of its panes, those of the focused one first.
    fn pane_keys(&self, look: &Look<'_>) -> Vec<PaneKeys>;

    /// Number of panes that can have the focus.
    fn panes(&self) -> usize;

    /// Number of the pane that has the focus.
    fn focus(&self) -> usize;

    /// Moves the focus to a pane.
    fn set_focus(&mut self, pane: usize);

    /// How many things esc closes here, one after the other.
    fn depth(&self) -> usize;

    /// The figure that is selected.
    fn figure(&self, look: &Look<'_>) -> Option<Figure>;

    /// Does an action of its scopes.
    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect>;

    /// Takes a key that is typed into a text.
    fn key(&mut self, key: &KeyEvent, look: &Look<'_>) -> Vec<Effect>;

    /// Takes pasted text.
    fn paste(&mut self, text: &str, look: &Look<'_>) -> Vec<Effect>;

    /// A row of a pane was clicked; again if it was selected before.
    fn click(&mut self, pane: usize, row: usize, look: &Look<'_>) -> Vec<Effect>;

    /// Draws itself.
    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>);
}
