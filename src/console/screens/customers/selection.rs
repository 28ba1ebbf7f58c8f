//! Actions that the panes of an open group share: moving the selection, and opening the source rows of a figure.

use crate::action::Action;
use crate::context::Figure;
use crate::effect::Effect;

/// Returns the selected index of a list after a navigation action.
pub fn move_index(at: usize, last: usize, action: Action) -> usize {
    match action {
        Action::Up => at.min(last).saturating_sub(1),
        Action::Down => (at + 1).min(last),
        Action::First => 0,
        Action::Last => last,
        _ => at,
    }
}

pub fn show_rows_effect(figure: Option<Figure>) -> Vec<Effect> {
    figure.and_then(|figure| figure.sql).map(Effect::EditSql).into_iter().collect()
}
