//! The results table as an exhibit.

use super::{ResultsRow, ResultsTable};
use crate::exhibit::{
    AxisScale, Column, Datum, Exhibit, Graph, GraphAxis, GraphForm, Measure, Series, Tabulation,
};

impl ResultsTable {
    /// Returns the table and a bar graph of the best runs.
    pub fn exhibit(&self) -> Exhibit {
        let columns = vec![
            Column::words("name", "who"),
            Column::words("source", "source"),
            Column::numbers("bankrupt", "bankrupt", Measure::Count),
            Column::numbers("runs", "of runs", Measure::Count),
            Column::numbers("best_cash", "best run, cash", Measure::Dollars),
            Column::numbers("max_survival_days", "longest life, days", Measure::Days),
            Column::numbers("mean_survival_days", "mean life, days", Measure::Number(1)),
            Column::numbers("std_survival_days", "± days", Measure::Number(1)),
            Column::numbers("calls_per_week", "calls a week", Measure::Number(2)),
            Column::numbers("beats", "beats", Measure::Count),
            Column::words("best_run", "best run"),
        ];
        let rows = self.rows.iter().map(cells).collect();
        let table = Tabulation { rows, ..Tabulation::new("results", "", columns) };
        let mut exhibit = Exhibit::of("Own runs and published results", table);
        exhibit.graphs.push(self.graph());
        exhibit.notes.clone_from(&self.notes);
        exhibit
    }

    fn graph(&self) -> Graph {
        let point = |(place, row): (usize, &ResultsRow)| ((place + 1) as f64, row.best_cash);
        let axis = |label, scale| GraphAxis { label, scale };
        Graph {
            title: "Cash of the best runs, by rank".to_owned(),
            summary: format!("{} results, highest cash first.", self.rows.len()),
            across: axis("place", AxisScale::Whole),
            up: axis("dollars", AxisScale::Linear),
            series: vec![Series {
                name: "best run".to_owned(),
                points: self.rows.iter().enumerate().map(point).collect(),
            }],
            form: GraphForm::Bars,
        }
    }
}

fn cells(row: &ResultsRow) -> Vec<Datum> {
    vec![
        Datum::words(&*row.name),
        Datum::words(row.player.source()),
        Datum::number(row.bankruptcies.map(f64::from)),
        Datum::Number(f64::from(row.runs)),
        Datum::Number(row.best_cash),
        Datum::number(row.max_survival_days),
        Datum::number(row.mean_survival_days),
        Datum::number(row.std_survival_days),
        Datum::number(row.calls_per_week),
        Datum::Number(row.beats as f64),
        Datum::words(row.best_run.as_deref().unwrap_or_default()),
    ]
}
