//! The results table as a report.

use super::{ResultsRow, ResultsTable};
use crate::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
};

impl ResultsTable {
    /// Returns a report with the results table and a bar graph of the best runs.
    pub fn to_lab_report(&self) -> LabReport {
        let columns = vec![
            Column::text("name", "who"),
            Column::text("source", "source"),
            Column::number("bankrupt", "bankrupt", Measure::Count),
            Column::number("runs", "runs", Measure::Count),
            Column::number("best_cash", "best run, cash", Measure::Dollars),
            Column::number("max_survival_days", "longest survival, days", Measure::Days),
            Column::number("mean_survival_days", "mean survival, days", Measure::Number(1)),
            Column::number("std_survival_days", "± days", Measure::Number(1)),
            Column::number("calls_per_week", "calls a week", Measure::Number(2)),
            Column::number("beats", "beats", Measure::Count),
            Column::text("best_run", "best run"),
        ];
        let rows = self.rows.iter().map(row_cells).collect();
        let table = LabTable { rows, ..LabTable::new("results", "", columns) };
        let mut exhibit = LabReport::with_table("Own runs and published results", table);
        exhibit.graphs.push(self.best_run_graph());
        exhibit.notes.clone_from(&self.notes);
        exhibit
    }

    fn best_run_graph(&self) -> Graph {
        let point = |(place, row): (usize, &ResultsRow)| ((place + 1) as f64, row.best_cash);
        let axis = |label, scale| GraphAxis { label, scale };
        Graph {
            title: "Cash of the best runs, by rank".to_owned(),
            summary: format!("{} results, highest cash first.", self.rows.len()),
            x_axis: axis("place", AxisScale::Whole),
            y_axis: axis("dollars", AxisScale::Linear),
            series: vec![Series {
                name: "best run".to_owned(),
                points: self.rows.iter().enumerate().map(point).collect(),
            }],
            form: GraphForm::Bars,
        }
    }
}

fn row_cells(row: &ResultsRow) -> Vec<CellValue> {
    vec![
        CellValue::text(&*row.name),
        CellValue::text(row.source.describe()),
        CellValue::number(row.bankruptcies.map(f64::from)),
        CellValue::Number(f64::from(row.runs)),
        CellValue::Number(row.best_cash),
        CellValue::number(row.max_survival_days),
        CellValue::number(row.mean_survival_days),
        CellValue::number(row.std_survival_days),
        CellValue::number(row.calls_per_week),
        CellValue::Number(row.beaten_count as f64),
        CellValue::text(row.best_run.as_deref().unwrap_or_default()),
    ]
}
