//! The screens of a run. Each screen stores its position and selection, converts actions to effects, and has a draw
//! method that never changes state.

pub mod menu;
pub mod panes;

use std::collections::BTreeMap;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::action::{Action, Scope};
use super::context::{EditorDocument, Figure, PaneKeys, ScreenContext, ScreenId};
use super::effect::Effect;
use super::own_commands::ListRows;
use novamind_database::QueryResult;
use novamind_session::identifiers::Group;
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::{ColumnLayout, Table};
use novamind_worker::message::Response;
use novamind_worker::screen_queries::Reading;

/// Declares the module of each screen and the struct that holds all screens.
macro_rules! screens {
    ($($(#[$doc:meta])* $Screen:ident in $screen_module:ident,)*) => {
        $(pub mod $screen_module;)*

        /// The state of all screens of a run.
        #[derive(Default)]
        pub struct Screens { $($(#[$doc])* pub $screen_module: $screen_module::$Screen,)* }

        impl Screens {
            /// Returns a screen.
            pub fn get(&self, id: ScreenId) -> &dyn Screen {
                match id { $(ScreenId::$Screen => &self.$screen_module,)* }
            }

            /// Returns a mutable reference to a screen.
            pub fn get_mut(&mut self, id: ScreenId) -> &mut dyn Screen {
                match id { $(ScreenId::$Screen => &mut self.$screen_module,)* }
            }
        }
    };
}

screens! {
    /// Overview of the company.
    Overview in overview,
    /// Income, costs and cash.
    Cash in cash,
    /// The customer groups.
    Customers in customers,
    /// Quality, capacity, issues and R&D.
    Product in product,
    /// The social feed and your posts.
    Social in social,
    /// Negotiations with enterprises.
    Inbox in inbox,
    /// Groups, market studies and the economy.
    Market in market,
    /// Forms for all tools.
    Tools in tools,
    /// SQL queries.
    Sql in sql,
    /// The journal of the run.
    Journal in journal,
    /// Hidden state, if the run permits inspections.
    Xray in xray,
}

/// The state of a screen, which receives worker responses and query results.
pub trait ScreenState {
    /// Returns the queries whose results the screen needs from the database.
    fn screen_queries(&self) -> &'static [Reading] {
        &[]
    }

    /// Stores the result of a screen query.
    fn apply_rows(&mut self, _: Reading, _: &QueryResult, _: &ScreenContext<'_>) {}

    /// Called when the screen becomes visible, and when the company changes while the screen is visible. Returns
    /// requests for missing data.
    fn request_data(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// Called after the company has changed.
    fn on_company_change(&mut self, _: &ScreenContext<'_>) {}

    /// Handles a worker response that concerns the screen. Returns the effects to execute.
    fn handle_response(&mut self, _: &Response, _: &ScreenContext<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// Collects answers that have arrived for the screen. Returns the effects to execute.
    fn take_answers(&mut self, _: &ScreenContext<'_>) -> Vec<Effect> {
        Vec::new()
    }

    /// Marks all items as seen. Called when the screen becomes visible and when the user leaves the screen.
    fn mark_seen(&mut self) {}

    /// Returns the number of unread items, which the tab shows as a badge.
    fn unseen_count(&self) -> usize {
        0
    }

    /// Returns the group of the open or selected item, if any.
    fn selected_group(&self, _: &ScreenContext<'_>) -> Option<Group> {
        None
    }

    /// Returns the title of the open item, such as a group or a tool. The item is shown next to a list or replaces the
    /// list.
    fn open_item_title(&self, _: &ScreenContext<'_>) -> Option<String> {
        None
    }

    /// Returns whether the open item replaces the list from which it was opened.
    fn covers_list(&self) -> bool {
        false
    }

    /// Returns the number of levels that esc closes on this screen, without the levels that every pane has.
    fn screen_escape_depth(&self) -> usize {
        0
    }

    /// Called when the user selects the screen by its key, even if the screen is already shown. Opens the same
    /// view each time.
    fn show_first_view(&mut self) {}

    /// Returns the recorded kind and the recorded name of the open object.
    fn open_object(&self, _: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        None
    }

    /// Returns the recorded name and the contents of the text field that is being edited.
    fn edited_text(&self) -> Option<(String, String)> {
        None
    }

    /// Returns whether unsent text would be lost if the program ended.
    fn has_unsent_text(&self) -> bool {
        false
    }
}

/// The behavior and appearance of a screen. Screens that consist of panes implement this trait through
/// [`panes::PaneScreen`].
pub trait Screen: ScreenState {
    /// Returns the scopes of the focused pane, the innermost first. The caller adds the global scope. If the first
    /// scope is a text scope, keys type characters.
    fn scopes(&self) -> Vec<Scope>;

    /// Returns the actions to show in the footer.
    fn hints(&self) -> Vec<Action>;

    /// Returns the keys of all panes. The keys of the focused pane are first.
    fn pane_keys(&self, screen_context: &ScreenContext<'_>) -> Vec<PaneKeys>;

    /// Returns the number of panes that can take the focus.
    fn pane_count(&self) -> usize;

    /// Returns the index of the focused pane.
    fn focused_index(&self) -> usize;

    /// Moves the focus to a pane.
    fn set_focus(&mut self, pane: usize);

    /// Returns the number of levels that esc closes on this screen.
    fn escape_depth(&self) -> usize;

    /// Returns the number of rows of the focused table that pass the filter, and of all rows, if the focused pane has
    /// a table.
    fn row_counts(&self) -> Option<(usize, usize)>;

    /// Returns the selected figure, if a figure is selected.
    fn figure(&self, screen_context: &ScreenContext<'_>) -> Option<Figure>;

    /// Returns the title of the focused pane and its table, if the pane has a table with several columns.
    fn focused_table(&self, screen_context: &ScreenContext<'_>) -> Option<(String, &Table)>;

    /// Arranges the columns of the focused table. Returns the name under which the layout is saved, or `None` if the
    /// layout applies only until the table is rebuilt.
    fn set_focused_layout(&mut self, layout: ColumnLayout) -> Option<&'static str>;

    /// Arranges the columns of all tables of the screen that have a name.
    fn set_layouts(&mut self, layouts: &BTreeMap<String, ColumnLayout>);

    /// Returns the selected rows of the focused list, or all its displayed rows, if the focused pane has a list.
    fn list_rows(&self, all: bool) -> Option<ListRows>;

    /// Handles an action of one of the screen's scopes.
    fn handle_action(&mut self, action: Action, screen_context: &ScreenContext<'_>) -> Vec<Effect>;

    /// Handles a key typed into a text field.
    fn handle_key(&mut self, key: &KeyEvent, screen_context: &ScreenContext<'_>) -> Vec<Effect>;

    /// Handles text that is pasted into a field.
    fn paste(&mut self, text: &str, screen_context: &ScreenContext<'_>) -> Vec<Effect>;

    /// Returns the text of the focused pane that can be edited in another program, if any.
    fn editor_document(&self) -> Option<EditorDocument>;

    /// Replaces the text of the focused pane with the text that another program returned.
    fn replace_document(&mut self, text: &str, screen_context: &ScreenContext<'_>) -> Vec<Effect>;

    /// Handles a click on a row. Clicking the selected row opens it.
    fn handle_click(&mut self, pane: usize, row: usize, screen_context: &ScreenContext<'_>) -> Vec<Effect>;

    /// Draws the screen into an area.
    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, screen_context: &ScreenContext<'_>);
}
