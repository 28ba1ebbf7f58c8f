//! Export of tables and graphs as JSON and CSV, with full precision and units.

use serde_json::{Map, Value, json};

use super::{CellValue, Column, ColumnKind, Graph, LabReport, LabTable};
use novamind_base::formatting::json_number;
use novamind_base::statistics::{CONFIDENCE_LEVEL, Interval, RESAMPLE_COUNT};

impl LabReport {
    /// Returns the table with the given name, or `None` if the report has no table with this name.
    pub fn table(&self, name: &str) -> Option<&LabTable> {
        self.tables.iter().find(|table| table.name == name)
    }

    /// Returns the report as a JSON object: tables with columns, units and rows, graphs with points, and notes.
    pub fn to_json(&self) -> Value {
        let tables: Map<String, Value> =
            self.tables.iter().map(|table| (table.name.clone(), table.to_json())).collect();
        let mut object = json!({ "title": self.title, "tables": tables });
        if !self.graphs.is_empty() {
            object["graphs"] = self.graphs.iter().map(graph_json).collect();
        }
        let is_interval = |column: &Column| matches!(column.kind, ColumnKind::Interval(_));
        if self.tables.iter().flat_map(|table| &table.columns).any(is_interval) {
            object["intervals"] =
                json!({ "kind": "bootstrap", "level": CONFIDENCE_LEVEL, "resamples": RESAMPLE_COUNT });
        }
        object["notes"] = json!(self.notes);
        object
    }
}

impl LabTable {
    /// Returns CSV rows, starting with a header. An interval has two columns. The cell of a missing value is empty.
    pub fn to_csv_rows(&self) -> Vec<Vec<String>> {
        let names = |column: &Column| match column.kind {
            ColumnKind::Interval(_) => vec![format!("{}_low", column.name), format!("{}_high", column.name)],
            ColumnKind::Text | ColumnKind::Number(_) | ColumnKind::Sparkline => vec![column.name.clone()],
        };
        let row = |cells: &Vec<CellValue>| {
            self.machine_readable_cells(cells).flat_map(|(column, cell)| csv_cells(column, cell)).collect()
        };
        let head = self
            .columns
            .iter()
            .filter(|column| column.kind != ColumnKind::Sparkline)
            .flat_map(names)
            .collect();
        std::iter::once(head).chain(self.rows.iter().map(row)).collect()
    }

    /// Returns the exported cells of a row, each with its column.
    fn machine_readable_cells<'a>(
        &'a self,
        cells: &'a [CellValue],
    ) -> impl Iterator<Item = (&'a Column, &'a CellValue)> {
        self.columns.iter().zip(cells).filter(|(column, _)| column.kind != ColumnKind::Sparkline)
    }

    fn to_json(&self) -> Value {
        let column = |column: &Column| {
            let unit = column.measure().map(|measure| measure.name());
            json!({ "name": column.name, "heading": column.heading, "unit": unit })
        };
        let row = |cells: &Vec<CellValue>| -> Value {
            let pairs = self.machine_readable_cells(cells);
            Value::Object(pairs.map(|(column, cell)| (column.name.clone(), cell_json(cell))).collect())
        };
        let columns = self.columns.iter().filter(|column| column.kind != ColumnKind::Sparkline);
        let mut object = json!({
            "caption": self.caption,
            "columns": columns.map(column).collect::<Vec<_>>(),
            "rows": self.rows.iter().map(row).collect::<Vec<_>>(),
        });
        if !self.summary.is_empty() {
            object["summary"] = self.summary.iter().map(row).collect();
        }
        object
    }
}

fn cell_json(cell: &CellValue) -> Value {
    match cell {
        CellValue::Text(text) => json!(text),
        CellValue::Number(value) => json_number(*value),
        CellValue::NumberWithMeasure(value, measure) => {
            json!({ "value": json_number(*value), "unit": measure.name() })
        }
        CellValue::Interval(Interval { low, high }) => {
            json!({ "low": json_number(*low), "high": json_number(*high) })
        }
        CellValue::Missing => Value::Null,
    }
}

fn csv_cells(column: &Column, cell: &CellValue) -> Vec<String> {
    let number = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    match cell {
        CellValue::Text(text) => vec![text.clone()],
        CellValue::Number(value) | CellValue::NumberWithMeasure(value, _) => vec![number(*value)],
        CellValue::Interval(Interval { low, high }) => vec![number(*low), number(*high)],
        CellValue::Missing => {
            vec![String::new(); if matches!(column.kind, ColumnKind::Interval(_)) { 2 } else { 1 }]
        }
    }
}

fn graph_json(graph: &Graph) -> Value {
    let point = |(x, y): &(f64, f64)| json!([json_number(*x), json_number(*y)]);
    let series = graph.series.iter().map(|series| {
        json!({ "name": series.name, "points": series.points.iter().map(point).collect::<Vec<_>>() })
    });
    json!({
        "title": graph.title,
        "across": { "label": graph.x_axis.label, "scale": graph.x_axis.scale.name() },
        "up": { "label": graph.y_axis.label, "scale": graph.y_axis.scale.name() },
        "series": series.collect::<Vec<_>>(),
    })
}
