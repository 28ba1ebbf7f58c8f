//! Steps in the panes of an open group: along their lines, and on to the rows behind a figure.

use crate::action::Action;
use crate::effect::Effect;
use crate::context::Figure;

/// A place in a list after an action.
pub fn moved(at: usize, last: usize, action: Action) -> usize {
    match action {
        Action::Up => at.min(last).saturating_sub(1),
        Action::Down => (at + 1).min(last),
        Action::First => 0,
        Action::Last => last,
        _ => at,
    }
}

/// Leads to the rows behind a figure, to look further.
pub fn show_rows(figure: Option<Figure>) -> Vec<Effect> {
    figure.and_then(|figure| figure.sql).map(Effect::EditSql).into_iter().collect()
}
