//! The screens of a run. Each screen keeps its own position and selection, converts actions to effects and
//! draws itself. Drawing never changes state.

pub mod menu;
pub mod panes;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::action::{Action, Scope};
use super::context::{Figure, PaneKeys, ScreenContext, ScreenId};
use super::effect::Effect;
use novamind_database::QueryResult;
use novamind_tui::canvas::Canvas;
use novamind_worker::message::Response;
use novamind_worker::readings::Reading;

/// Declares the module of each screen and the struct that holds all screens.
macro_rules! screens {
    ($($(#[$doc:meta])* $Screen:ident in $room:ident,)*) => {
        $(pub mod $room;)*

        /// The state of all screens of a run.
        #[derive(Default)]
        pub struct Screens { $($(#[$doc])* pub $room: $room::$Screen,)* }

        impl Screens {
            /// Returns a screen.
            pub fn get(&self, id: ScreenId) -> &dyn Screen {
                match id { $(ScreenId::$Screen => &self.$room,)* }
            }

            /// Returns a screen for changes.
            pub fn get_mut(&mut self, id: ScreenId) -> &mut dyn Screen {
                match id { $(ScreenId::$Screen => &mut self.$room,)* }
            }
        }
    };
}

screens! {
    /// Overview of the company.
    Overview in overview,
    /// Income, costs and cash.
    Cash in cash,
    /// Customer groups.
    Customers in customers,
    /// Quality, capacity, issues and R&D.
    Product in product,
    /// The social feed and your posts.
    Social in social,
    /// Negotiations with enterprises.
    Inbox in inbox,
    /// Groups, market studies and the economy.
    Market in market,
    /// Forms of all tools.
    Tools in tools,
    /// SQL queries.
    Sql in sql,
    /// The journal of the run.
    Journal in journal,
    /// Hidden state, if the run permits it.
    Xray in xray,
}

/// State of a screen: receives news and the results of its readings.
pub trait ScreenState {
    /// Returns the readings that the screen needs from the database.
    fn readings(&self) -> &'static [Reading] {
        &[]
    }

    /// Stores the result of a reading.
    fn apply_rows(&mut self, _: Reading, _: &QueryResult, _: &ScreenContext<'_>) {}

    /// Called when the screen becomes visible, or when the company changes while it is. Returns requests to
    /// the run.
    fn request_data(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// Called after the company has changed.
    fn on_company_change(&mut self, _: &ScreenContext<'_>) {}

    /// Handles news that concern the screen and returns the effects that follow.
    fn handle_response(&mut self, _: &Response, _: &ScreenContext<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// Collects answers that have arrived for the screen and returns the effects that follow.
    fn take_answers(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// Called when the screen becomes visible and when the user leaves it.
    fn mark_seen(&mut self) {}

    /// Returns the number of unread items, for the badge.
    fn unseen_count(&self) -> usize {
        0
    }

    /// Returns the name of the detail that is open next to a list or in its place: a group or a tool.
    fn open_item_title(&self, _: &ScreenContext<'_>) -> Option<String> {
        None
    }

    /// Returns whether the open detail has replaced the list that led to it.
    fn covers_list(&self) -> bool {
        false
    }

    /// Returns the number of levels that esc closes on this screen, without those that every pane has.
    fn own_escape_depth(&self) -> usize {
        0
    }

    /// Returns the kind and name of the open object, as the record stores them.
    fn open_object(&self, _: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        None
    }

    /// Returns the name of the text field being edited, as the record stores it, and its contents.
    fn edited_text(&self) -> Option<(String, String)> {
        None
    }

    /// Returns whether unsent text would be lost if the program ended.
    fn has_unsent_text(&self) -> bool {
        false
    }
}

/// A screen's behavior and appearance. Screens made of panes implement it through [`panes::PaneScreen`].
pub trait Screen: ScreenState {
    /// Returns the scopes of the focused pane, innermost first; the caller adds the global scope. If the
    /// first is a text scope, keys type characters.
    fn scopes(&self) -> Vec<Scope>;

    /// Returns whether a digit starts a number at the focus instead of switching screens.
    fn accepts_digits(&self) -> bool;

    /// Returns the actions for the footer.
    fn hints(&self) -> Vec<Action>;

    /// Returns the keys of all panes, those of the focused pane first.
    fn pane_keys(&self, look: &ScreenContext<'_>) -> Vec<PaneKeys>;

    /// Returns the number of panes that can take the focus.
    fn pane_count(&self) -> usize;

    /// Returns the index of the focused pane.
    fn focused_index(&self) -> usize;

    /// Moves the focus to a pane.
    fn set_focus(&mut self, pane: usize);

    /// Returns the number of levels that esc closes on this screen.
    fn escape_depth(&self) -> usize;

    /// Returns the selected figure.
    fn figure(&self, look: &ScreenContext<'_>) -> Option<Figure>;

    /// Runs an action of one of its scopes.
    fn handle_action(&mut self, action: Action, look: &ScreenContext<'_>) -> Vec<Effect>;

    /// Handles a key typed into a text field.
    fn handle_key(&mut self, key: &KeyEvent, look: &ScreenContext<'_>) -> Vec<Effect>;

    /// Handles pasted text.
    fn paste(&mut self, text: &str, look: &ScreenContext<'_>) -> Vec<Effect>;

    /// Handles a click on a row. Clicking the selected row opens it.
    fn handle_click(&mut self, pane: usize, row: usize, look: &ScreenContext<'_>) -> Vec<Effect>;

    /// Draws the screen.
    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &ScreenContext<'_>);
}
