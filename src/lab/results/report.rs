//! The results table as a report.

use super::{ResultsRow, ResultsTable};
use crate::lab_report::{
    AxisScale, CellValue, Column, Graph, GraphAxis, GraphForm, LabReport, LabTable, Measure, Series,
};
use novamind_report::ranking::{PublishedGeneration, format_horizon};

impl ResultsTable {
    /// Returns a report with the results table and a bar graph of the best runs.
    pub fn to_lab_report(&self) -> LabReport {
        let columns = vec![
            Column::text("name", "who"),
            Column::text("source", "source"),
            Column::text("generation", "generation"),
            Column::text("horizon_days", "last day"),
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
        let ranked: Vec<&ResultsRow> =
            self.rows.iter().filter(|row| row.generation == PublishedGeneration::Release1).collect();
        let point = |(place, row): (usize, &&ResultsRow)| ((place + 1) as f64, row.best_cash);
        let axis = |label, scale| GraphAxis { label, scale };
        Graph {
            title: "Cash of the best runs of release 1, by rank".to_owned(),
            summary: format!("{} results, highest cash first.", ranked.len()),
            x_axis: axis("place", AxisScale::Whole),
            y_axis: axis("dollars", AxisScale::Linear),
            series: vec![Series {
                name: "best run".to_owned(),
                points: ranked.iter().enumerate().map(point).collect(),
            }],
            form: GraphForm::Bars,
        }
    }
}

/// Describes the last days of runs: `497 or 500`, or `not stated` if they are not published.
fn describe_horizons(days: &[u32]) -> String {
    match days {
        [] => format_horizon(None),
        days => days.iter().map(u32::to_string).collect::<Vec<_>>().join(" or "),
    }
}

fn row_cells(row: &ResultsRow) -> Vec<CellValue> {
    vec![
        CellValue::text(&*row.name),
        CellValue::text(row.source.describe()),
        CellValue::text(row.generation.name()),
        CellValue::text(describe_horizons(&row.horizon_days)),
        CellValue::number(row.bankruptcies.map(f64::from)),
        CellValue::Number(f64::from(row.runs)),
        CellValue::Number(row.best_cash),
        CellValue::number(row.max_survival_days),
        CellValue::number(row.mean_survival_days),
        CellValue::number(row.std_survival_days),
        CellValue::number(row.calls_per_week),
        CellValue::number(row.beaten_count.map(|count| count as f64)),
        CellValue::text(row.best_run.as_deref().unwrap_or_default()),
    ]
}
