//! Widgets that several screens share.

pub mod bars;
pub mod chart;
pub mod editor;
pub mod field;
pub mod large;
mod list;
pub mod raster;
pub mod scale;
pub mod scroll;
pub mod spark;
pub mod table;

pub use chart::{Axis, Band, Line, Plot, Side, chart};
pub use editor::Editor;
pub use field::Field;
pub use list::ListAction;
pub use scale::Unit;
pub use scroll::Scroll;
pub use spark::spark;
pub use table::{Cell, Column, Table};
