//! Keys shared by the panes of an open group: movement, and opening the rows behind a figure.

use crate::action::Action;
use crate::context::Figure;
use crate::effect::Effect;

/// Returns the index in a list after a movement.
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
