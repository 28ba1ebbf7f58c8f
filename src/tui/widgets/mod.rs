//! Widgets for terminal applications.

pub mod bars;
pub mod chart;
pub mod column_layout;
pub mod editor;
pub mod field;
pub mod large_text;
mod list;
pub mod raster;
pub mod scale;
pub mod scroll;
pub mod sparkline;
pub mod table;

pub use chart::{Band, Curve, Plot, XAxis, YAxis, draw_chart};
pub use column_layout::ColumnLayout;
pub use editor::TextEditor;
pub use field::TextField;
pub use list::ListAction;
pub use scale::AxisUnit;
pub use scroll::ScrollState;
pub use sparkline::sparkline;
pub use table::{Table, TableCell, TableColumn};
