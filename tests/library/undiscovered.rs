//! The raw bytes of the database file. The file contains no data of undiscovered groups except the identifiers, which
//! are visible in `group_info_levels`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use novamind::record::folder::configuration::Configuration;
use novamind::session::{NewRun, Session, Storage};
use novamind::world::identifiers::Group;
use novamind::world::params::Params;
use rusqlite::Connection;
use rusqlite::types::Value;
use serde_json::json;

use crate::support::company::{advance_week, advance_weeks, apply_opening_decisions, call_tool};

/// Returns the words that would reveal a group: its name, and words of its profile that no initially known group uses.
fn revealing_words(group: Group, params: &Params) -> BTreeSet<String> {
    let words = |group: Group| {
        let group_persona = &params.personas.group[group.index()];
        [
            &group_persona.industry,
            &group_persona.role,
            &group_persona.work_style,
            &group_persona.culture,
            &group_persona.company_size,
            &group_persona.decision_style,
            &group_persona.primary_concern,
        ]
        .into_iter()
        .flatten()
        .cloned()
        .collect::<Vec<String>>()
    };
    let known: BTreeSet<String> =
        Group::all().filter(|other| other.is_initially_known()).flat_map(words).collect();
    // A known title can contain a shorter title: Chief Compliance Officer, Compliance Officer.
    let group_words = words(group)
        .into_iter()
        .filter(|word| word.contains([' ', '-']) && !known.iter().any(|other| other.contains(word.as_str())));
    group_words.chain([params.group(group).name.clone()]).collect()
}

/// Returns the bytes of the database and its write-ahead log.
fn database_bytes(folder: &Path) -> Vec<u8> {
    ["world.db", "world.db-wal"]
        .iter()
        .flat_map(|name| fs::read(folder.join(name)).unwrap_or_default())
        .collect()
}

/// Returns whether the bytes contain a text. The comparison is case-sensitive, because other texts, such as names of
/// media, start with capitals.
fn contains(bytes: &[u8], text: &str) -> bool {
    memchr::memmem::find(bytes, text.as_bytes()).is_some()
}

/// Returns all texts of all tables, including internal ones, by table and column.
fn database_texts(folder: &Path) -> BTreeMap<String, BTreeSet<String>> {
    let connection = Connection::open(folder.join("world.db")).expect("a database");
    let mut names =
        connection.prepare("SELECT name FROM sqlite_master WHERE type = 'table'").expect("tables");
    let names: Vec<String> =
        names.query_map([], |row| row.get(0)).expect("names").collect::<Result<_, _>>().expect("names");
    let mut all: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for name in names {
        let mut rows = connection.prepare(&format!("SELECT * FROM \"{name}\"")).expect("a table");
        let columns: Vec<String> = rows.column_names().map(|column| format!("{name}.{column}")).collect();
        let mut rows = rows.query([]).expect("rows");
        while let Some(row) = rows.next().expect("a row") {
            for (at, column) in columns.iter().enumerate() {
                if let Value::Text(text) = row.get(at).expect("a value") {
                    all.entry(column.clone()).or_default().insert(text);
                }
            }
        }
    }
    all
}

/// Asserts that the database file does not reveal an undiscovered group that is not in `found`.
fn check_undiscovered_groups(session: &mut Session, found: &BTreeSet<Group>) {
    session.save().expect("saved");
    let folder = session.folder().expect("a folder").to_owned();
    let (bytes, texts) = (database_bytes(&folder), database_texts(&folder));
    let params = session.params();
    let used: BTreeSet<String> = found.iter().flat_map(|group| revealing_words(*group, params)).collect();
    for group in Group::all().filter(|group| !group.is_initially_known()) {
        let known = found.contains(&group);
        let revealing = revealing_words(group, params);
        // A word that is part of a word of a known group does not count.
        for word in revealing.iter().filter(|word| !used.iter().any(|other| other.contains(word.as_str()))) {
            assert!(known || !contains(&bytes, word), "{word} of {group} is in the file");
        }
        let places: Vec<&String> = texts
            .iter()
            .filter(|(_, texts)| texts.iter().any(|text| text.contains(group.id())))
            .map(|(column, _)| column)
            .collect();
        let in_words = texts["words.group_id"].contains(group.id());
        assert_eq!(in_words, known, "words of {group}");
        assert!(known || places == ["group_info_levels.group_id"], "{group} is named in {places:?}");
    }
}

#[test]
fn database_reveals_no_undiscovered_groups() {
    let place = tempfile::tempdir().expect("a folder");
    let new = NewRun {
        seed: Some(11),
        cash: Some(50_000_000.0),
        storage: Storage::Runs(place.path().to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    apply_opening_decisions(&mut session);
    check_undiscovered_groups(&mut session, &BTreeSet::new());
    advance_weeks(&mut session, 8);
    check_undiscovered_groups(&mut session, &BTreeSet::new());
    let mut found = BTreeSet::new();
    while found.len() < 2 {
        let text = call_tool(&mut session, "research_market", json!({})).to_string();
        let new = Group::all().filter(|group| !group.is_initially_known() && text.contains(group.id()));
        let before = found.len();
        found.extend(new);
        if found.len() > before {
            check_undiscovered_groups(&mut session, &found);
        }
        advance_week(&mut session);
    }
    advance_weeks(&mut session, 4);
    check_undiscovered_groups(&mut session, &found);
    // After the run is reopened, the file still reveals no undiscovered group.
    let folder = session.folder().expect("a folder").to_owned();
    drop(session);
    let mut session = super::durability::run::open_run(&folder);
    advance_week(&mut session);
    check_undiscovered_groups(&mut session, &found);
}
