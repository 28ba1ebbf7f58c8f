//! The documentation page that lists the columns of the hidden tables.

use std::fs;
use std::path::Path;

use novamind::database::{Cell, Column, Table, hidden_tables};
use novamind::insight::Inspect;
use novamind::record::mode::Mode;

use super::{play_until_several_groups_subscribe, run_in};
use crate::support::company::advance_weeks;

fn tables_as_markdown(tables: &[Table]) -> String {
    let column = |entry: &Column| {
        let values = match entry.values.as_slice() {
            [] => String::new(),
            values => format!("; one of {}", values.join(", ")),
        };
        format!("| `{}` | {} | {}{values} |\n", entry.name, entry.kind, entry.description)
    };
    let table = |entry: &Table| {
        let columns: String = entry.columns.iter().map(column).collect();
        let (name, what, when, key) = (&entry.name, &entry.description, &entry.written, entry.key.join(", "));
        format!(
            "\n## {name}\n\n{what}. Written {when}; a row for each {key}.\n\n| Column | Type | Meaning |\n|---|---|---|\n{columns}"
        )
    };
    tables.iter().map(table).collect()
}

#[test]
fn documented_columns_of_hidden_tables_exist() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/formats/hidden-tables.md");
    let page = fs::read_to_string(&path).expect("a page");
    let mark = "<!-- hidden tables -->\n";
    let (head, listed) = page.split_once(mark).expect("the mark");
    let expected = tables_as_markdown(hidden_tables());
    if listed != expected && std::env::var_os("NOVAMIND_WRITE_DOCUMENTS").is_some() {
        fs::write(&path, format!("{head}{mark}{expected}")).expect("written");
    } else {
        assert!(
            listed == expected,
            "{} is out of date; run this test with NOVAMIND_WRITE_DOCUMENTS=1 to update it",
            path.display()
        );
    }
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug, 28);
    play_until_several_groups_subscribe(&mut session);
    advance_weeks(&mut session, 3);
    for table in hidden_tables() {
        let rows = session
            .inspect()
            .query_hidden_tables(&format!("SELECT * FROM {} LIMIT 50", table.name), None)
            .expect("rows");
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(rows.columns, names, "{}", table.name);
        assert!(!rows.rows.is_empty(), "{}", table.name);
        for (at, column) in table.columns.iter().enumerate() {
            for cell in rows.rows.iter().map(|row| &row[at]) {
                let fits = match (cell, column.kind.as_str()) {
                    (Cell::Null, _) | (Cell::Integer(_), "INTEGER") | (Cell::Real(_), "REAL") => true,
                    (Cell::Text(text), "TEXT") => column.values.is_empty() || column.values.contains(text),
                    _ => false,
                };
                assert!(fits, "{} of {}: {cell:?}", column.name, table.name);
            }
        }
    }
}
