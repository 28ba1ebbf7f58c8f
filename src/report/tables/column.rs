//! Columns of tables. Each column is declared once, and headers, rows and the codebook are derived from this
//! declaration.

use std::borrow::Cow;

use serde::Serialize;

/// Name of a column, with the unit and the meaning of its values.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ColumnHeading {
    /// Name of the column in the header line.
    pub name: Cow<'static, str>,
    /// Unit of the values or, if they have none, their kind.
    pub unit: &'static str,
    /// What the values mean, for the codebook.
    pub meaning: &'static str,
}

pub(crate) struct Column<Row> {
    /// Name, unit and meaning of the column.
    pub heading: ColumnHeading,
    pub cell: Box<dyn Fn(&Row) -> String>,
}

impl<Row> Column<Row> {
    /// Creates a column. `cell` formats the value of a row.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        unit: &'static str,
        meaning: &'static str,
        cell: impl Fn(&Row) -> String + 'static,
    ) -> Column<Row> {
        Column { heading: ColumnHeading { name: name.into(), unit, meaning }, cell: Box::new(cell) }
    }
}

/// Declares the columns of a table: `name, unit, meaning => value;`. The value is an expression that uses the row.
macro_rules! columns {
    ($row:ident: $Row:ty; $($name:expr, $unit:literal, $meaning:expr => $value:expr;)*) => {
        vec![$($crate::tables::column::Column::<$Row>::new($name, $unit, $meaning, move |$row| {
            let _ = $row;
            $crate::tables::column::CellValue::to_cell(&$value)
        })),*]
    };
}

pub(crate) use columns;

/// A value that can be formatted as a cell.
pub(crate) trait CellValue {
    /// Returns the text of the cell. Texts are unchanged, flags become 0 or 1, and a missing value becomes an empty
    /// string. Numbers have the shortest form that parses to the same value.
    fn to_cell(&self) -> String;
}

impl<T: CellValue> CellValue for Option<T> {
    fn to_cell(&self) -> String {
        self.as_ref().map(CellValue::to_cell).unwrap_or_default()
    }
}

impl<T: CellValue + ?Sized> CellValue for &T {
    fn to_cell(&self) -> String {
        (*self).to_cell()
    }
}

macro_rules! values {
    ($($kind:ty: $cell:expr;)*) => {
        $(impl CellValue for $kind {
            fn to_cell(&self) -> String {
                $cell(self)
            }
        })*
    };
}

values! {
    str: str::to_owned;
    String: String::clone;
    bool: |flag: &bool| super::format_flag(*flag);
    f64: |number: &f64| super::format_number(*number);
    u8: u8::to_string;
    u32: u32::to_string;
    u64: u64::to_string;
    usize: usize::to_string;
}
