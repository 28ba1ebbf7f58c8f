//! Exhibits as JSON and CSV, with full precision and units.

use serde_json::{Map, Value, json};

use super::{Column, Datum, Exhibit, Graph, Holds, Tabulation};
use novamind_base::notation::json_number;
use novamind_base::statistics::{Interval, LEVEL, RESAMPLES};

impl Exhibit {
    /// Returns the table with a name, or `None`.
    pub fn table(&self, name: &str) -> Option<&Tabulation> {
        self.tables.iter().find(|table| table.name == name)
    }

    /// Returns one JSON object: tables with their columns, units and rows, graphs with their points, notes.
    pub fn as_json(&self) -> Value {
        let tables: Map<String, Value> =
            self.tables.iter().map(|table| (table.name.clone(), table.as_json())).collect();
        let mut object = json!({ "title": self.title, "tables": tables });
        if !self.graphs.is_empty() {
            object["graphs"] = self.graphs.iter().map(graph).collect();
        }
        let is_interval = |column: &Column| matches!(column.holds, Holds::Intervals(_));
        if self.tables.iter().flat_map(|table| &table.columns).any(is_interval) {
            object["intervals"] = json!({ "kind": "bootstrap", "level": LEVEL, "resamples": RESAMPLES });
        }
        object["notes"] = json!(self.notes);
        object
    }
}

impl Tabulation {
    /// Returns CSV with a header. An interval has two columns, a missing value an empty cell.
    pub fn as_csv(&self) -> Vec<Vec<String>> {
        let names = |column: &Column| match column.holds {
            Holds::Intervals(_) => vec![format!("{}_low", column.name), format!("{}_high", column.name)],
            Holds::Words | Holds::Numbers(_) | Holds::Drawings => vec![column.name.clone()],
        };
        let row = |cells: &Vec<Datum>| {
            self.for_programs(cells).flat_map(|(column, cell)| raw(column, cell)).collect()
        };
        let head =
            self.columns.iter().filter(|column| column.holds != Holds::Drawings).flat_map(names).collect();
        std::iter::once(head).chain(self.rows.iter().map(row)).collect()
    }

    /// Returns the exported cells of a row with their columns.
    fn for_programs<'a>(&'a self, cells: &'a [Datum]) -> impl Iterator<Item = (&'a Column, &'a Datum)> {
        self.columns.iter().zip(cells).filter(|(column, _)| column.holds != Holds::Drawings)
    }

    fn as_json(&self) -> Value {
        let column = |own: &Column| {
            let unit = own.measure().map(|measure| measure.name());
            json!({ "name": own.name, "heading": own.heading, "unit": unit })
        };
        let row = |cells: &Vec<Datum>| -> Value {
            let pairs = self.for_programs(cells);
            Value::Object(pairs.map(|(column, cell)| (column.name.clone(), value(cell))).collect())
        };
        let columns = self.columns.iter().filter(|column| column.holds != Holds::Drawings);
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

fn value(cell: &Datum) -> Value {
    match cell {
        Datum::Words(text) => json!(text),
        Datum::Number(value) => json_number(*value),
        Datum::Measured(value, measure) => json!({ "value": json_number(*value), "unit": measure.name() }),
        Datum::Interval(Interval { low, high }) => {
            json!({ "low": json_number(*low), "high": json_number(*high) })
        }
        Datum::Missing => Value::Null,
    }
}

fn raw(column: &Column, cell: &Datum) -> Vec<String> {
    let number = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    match cell {
        Datum::Words(text) => vec![text.clone()],
        Datum::Number(value) | Datum::Measured(value, _) => vec![number(*value)],
        Datum::Interval(Interval { low, high }) => vec![number(*low), number(*high)],
        Datum::Missing => {
            vec![String::new(); if matches!(column.holds, Holds::Intervals(_)) { 2 } else { 1 }]
        }
    }
}

fn graph(own: &Graph) -> Value {
    let point = |(x, y): &(f64, f64)| json!([json_number(*x), json_number(*y)]);
    let series = own.series.iter().map(|series| {
        json!({ "name": series.name, "points": series.points.iter().map(point).collect::<Vec<_>>() })
    });
    json!({
        "title": own.title,
        "across": { "label": own.across.label, "scale": own.across.scale.name() },
        "up": { "label": own.up.label, "scale": own.up.scale.name() },
        "series": series.collect::<Vec<_>>(),
    })
}
