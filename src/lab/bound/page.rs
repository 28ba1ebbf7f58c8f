//! Tests that the tables of docs/laboratory/bound.md equal the command's output.

use std::fs;
use std::path::Path;

use super::{BoundAccount, Premises, bound_exhibit, sensitivity};
use crate::exhibit::{Datum, Tabulation};
use novamind_world::params::Params;

/// Returns the rows of a table in Markdown; numbers have one decimal.
fn as_markdown(table: &Tabulation, columns: &[usize]) -> String {
    let cell = |own: &Datum| match own {
        Datum::Words(text) => text.clone(),
        Datum::Number(value) if value.fract() == 0.0 && value.abs() < 1000.0 => format!("{value}"),
        Datum::Number(value) if value.abs() < 1.0 => format!("{value:.3}"),
        Datum::Number(value) => format!("{value:.1}"),
        _ => "–".to_owned(),
    };
    let row = |cells: &Vec<Datum>| {
        let chosen: Vec<String> = columns.iter().map(|at| cell(&cells[*at])).collect();
        format!("| {} |\n", chosen.join(" | "))
    };
    table.rows.iter().map(row).collect()
}

/// Returns the page with the rows below each mark replaced, keeping table heads.
fn filled(page: &str, tables: &[(&str, String)]) -> String {
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
fn tables_in_documents_are_those_of_the_account() {
    let params = Params::shipped();
    let account = BoundAccount::of(Premises::of_the_paper(3.0), &params);
    let exhibit = bound_exhibit(&account, &sensitivity(&[1.0, 2.0, 3.0, 4.0], &params));
    let table = |name: &str, columns: &[usize]| as_markdown(exhibit.table(name).expect("a table"), columns);
    let tables = [
        ("account", table("account", &[0, 1, 2])),
        ("slack", table("slack", &[0, 1, 3, 4, 5])),
        ("assumptions", table("assumptions", &[0, 1])),
    ];
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/laboratory/bound.md");
    let page = fs::read_to_string(&path).expect("a page");
    let expected = filled(&page, &tables);
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
