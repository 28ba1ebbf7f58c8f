//! The columns of a table that the user has hidden, moved or resized. A layout identifies columns by their headings, so
//! it stays valid if columns are added or removed.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use super::table::TableColumn;

/// Maximum width that a user can choose for a column.
pub const MAX_COLUMN_WIDTH: u16 = 80;

/// Order, visibility and widths of the columns of a table. The default shows all columns in their original order.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ColumnLayout {
    /// Headings in display order. A column that is not listed follows the column that precedes it in the original
    /// order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub order: Vec<String>,
    /// Headings of the columns that the user has hidden.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub hidden: BTreeSet<String>,
    /// Widths that the user chose, by heading, in terminal cells. Other columns are as wide as their contents.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub widths: BTreeMap<String, u16>,
}

impl ColumnLayout {
    /// Returns whether the layout is the default layout.
    pub fn is_default(&self) -> bool {
        *self == ColumnLayout::default()
    }

    /// Returns the indexes of all columns in display order, including hidden columns.
    pub fn ordered_columns(&self, columns: &[TableColumn]) -> Vec<usize> {
        let rank = |column: &TableColumn| self.order.iter().position(|title| *title == column.title);
        let mut ordered: Vec<usize> = (0..columns.len()).filter(|at| rank(&columns[*at]).is_some()).collect();
        ordered.sort_by_key(|at| rank(&columns[*at]));
        for at in (0..columns.len()).filter(|at| rank(&columns[*at]).is_none()) {
            let before =
                at.checked_sub(1).and_then(|before| ordered.iter().position(|place| *place == before));
            ordered.insert(before.map_or(0, |place| place + 1), at);
        }
        ordered
    }

    /// Returns the indexes of the visible columns in display order. If the layout hides all columns, returns all
    /// columns.
    pub fn visible_columns(&self, columns: &[TableColumn]) -> Vec<usize> {
        let ordered = self.ordered_columns(columns);
        let visible: Vec<usize> =
            ordered.iter().copied().filter(|at| !self.hidden.contains(&columns[*at].title)).collect();
        if visible.is_empty() { ordered } else { visible }
    }

    /// Returns the fixed width of a column, or `None` if the column is as wide as its contents.
    pub fn fixed_width(&self, title: &str) -> Option<u16> {
        self.widths.get(title).map(|width| (*width).clamp(1, MAX_COLUMN_WIDTH))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(titles: &[&str]) -> Vec<TableColumn> {
        titles.iter().map(|title| TableColumn::text(*title)).collect()
    }

    #[test]
    fn columns_that_a_layout_does_not_name_follow_their_neighbor() {
        let titles = ["group", "kind", "new column", "leads"];
        let order = ["leads", "gone", "group", "kind"].map(str::to_owned).to_vec();
        let layout = ColumnLayout { order, ..ColumnLayout::default() };
        assert_eq!(layout.ordered_columns(&columns(&titles)), [3, 0, 1, 2]);
        assert_eq!(ColumnLayout::default().ordered_columns(&columns(&titles)), [0, 1, 2, 3]);
    }

    #[test]
    fn layout_never_hides_all_columns() {
        let hidden = ["a", "b"].map(str::to_owned).into();
        let layout = ColumnLayout { hidden, ..ColumnLayout::default() };
        assert_eq!(layout.visible_columns(&columns(&["a", "b", "c"])), [2]);
        assert_eq!(layout.visible_columns(&columns(&["a", "b"])), [0, 1]);
    }

    #[test]
    fn unreasonable_widths_are_clamped() {
        let widths = [("a".to_owned(), 0), ("b".to_owned(), 4000)].into();
        let layout = ColumnLayout { widths, ..ColumnLayout::default() };
        assert_eq!(["a", "b", "c"].map(|title| layout.fixed_width(title)), [Some(1), Some(80), None]);
    }
}
