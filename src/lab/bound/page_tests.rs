//! Tests that the tables of docs/laboratory/bound.md equal the output of `lab bound`.

use std::fs;
use std::path::Path;

use super::{BoundAccount, BoundAssumptions, bound_report, sensitivity};
use crate::lab_report::{CellValue, LabTable};
use novamind_world::params::Params;

/// Formats the rows of a table as Markdown. Whole numbers below 1,000 have no decimals, numbers below 1 have three
/// decimals, and all others have one.
fn rows_to_markdown(table: &LabTable, columns: &[usize]) -> String {
    let cell = |cell_value: &CellValue| match cell_value {
        CellValue::Text(text) => text.clone(),
        CellValue::Number(value) if value.fract() == 0.0 && value.abs() < 1000.0 => format!("{value}"),
        CellValue::Number(value) if value.abs() < 1.0 => format!("{value:.3}"),
        CellValue::Number(value) => format!("{value:.1}"),
        _ => "–".to_owned(),
    };
    let row = |cells: &Vec<CellValue>| {
        let chosen: Vec<String> = columns.iter().map(|at| cell(&cells[*at])).collect();
        format!("| {} |\n", chosen.join(" | "))
    };
    table.rows.iter().map(row).collect()
}

/// Returns the page with new table rows below each marker. Table headings are kept.
fn fill_tables(page: &str, tables: &[(&str, String)]) -> String {
    let (mut text, mut lines) = (String::new(), page.lines().peekable());
    while let Some(line) = lines.next() {
        text += &format!("{line}\n");
        let Some((_, rows)) = tables.iter().find(|(mark, _)| line == format!("<!-- {mark} -->")) else {
            continue;
        };
        for head in lines.by_ref().take(2) {
            text += &format!("{head}\n");
        }
        while lines.next_if(|line| line.starts_with('|')).is_some() {}
        text += rows;
    }
    text
}

#[test]
fn documented_tables_match_the_account() {
    let params = Params::bundled();
    let account = BoundAccount::new(BoundAssumptions::from_paper(3.0), &params);
    let exhibit = bound_report(&account, &sensitivity(&[1.0, 2.0, 3.0, 4.0], &params));
    let table =
        |name: &str, columns: &[usize]| rows_to_markdown(exhibit.table(name).expect("a table"), columns);
    let tables = [
        ("account", table("account", &[0, 1, 2])),
        ("slack", table("slack", &[0, 1, 3, 4, 5])),
        ("assumptions", table("assumptions", &[0, 1])),
    ];
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/laboratory/bound.md");
    let page = fs::read_to_string(&path).expect("a page");
    let expected = fill_tables(&page, &tables);
    assert!(expected.matches("<!-- ").count() == 3 && tables.iter().all(|(_, rows)| expected.contains(rows)));
    if page != expected && std::env::var_os("NOVAMIND_WRITE_DOCUMENTS").is_some() {
        fs::write(&path, expected).expect("written");
        return;
    }
    assert!(
        page == expected,
        "{} is out of date; run this test with NOVAMIND_WRITE_DOCUMENTS=1 to update it",
        path.display()
    );
}
