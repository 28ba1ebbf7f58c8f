//! The hidden tables. Their rows equal the simulator state, they exist only on the connection of the x-ray, and every
//! query of them is recorded.

mod access;
mod connection;
mod contents;
mod documentation;

use std::path::Path;

use novamind::database::Cell;
use novamind::insight::Inspect;
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::Via;
use novamind::session::{NewRun, Session, Storage};
use serde_json::json;

use crate::support::company::apply_opening_decisions;

fn run_in(folder: &Path, mode: Mode, days: u32) -> Session {
    let new = NewRun {
        seed: Some(11),
        days: Some(days),
        cash: Some(20_000_000.0),
        mode,
        participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
        storage: Storage::Runs(folder.to_owned()),
        ..NewRun::default()
    };
    Session::create(new, &Configuration::bundled()).expect("the run begins")
}

/// Plays until the company has subscribers in several groups, in-app advertising and negotiations.
fn play_until_several_groups_subscribe(session: &mut Session) {
    apply_opening_decisions(session);
    for (tool, arguments) in [
        (
            "set_targeted_dev_spend",
            json!({"targeted_spend": {"S1": 6000, "S2": 3000, "E1": 9000, "E2": 9000}}),
        ),
        (
            "set_targeted_ad_spend",
            json!({"targeted_spend": {
                "content_marketing": {"S1": 750, "S2": 500}, "linkedin": {"E1": 9000, "E2": 9000}
            }}),
        ),
        ("set_model_tiers", json!({"A": 3, "B": 4, "C": 4})),
        ("set_capacity_tier", json!({"tier": 5})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
}

/// Offers every waiting enterprise its requested price or slightly more.
fn make_offers(session: &mut Session) {
    let waiting = session.company().observe().waiting;
    let deal = |(customer, asked): (u32, f64)| json!([customer, [["C", asked * 1.3], ["B", asked * 1.05]]]);
    let deals: Vec<_> = waiting
        .iter()
        .map(|waiting_thread| deal((waiting_thread.customer, waiting_thread.asked.unwrap_or(40.0))))
        .collect();
    if !deals.is_empty() {
        session.call("send_enterprise_deal", &json!({ "deals": deals }), Via::Script).expect("offers");
    }
}

#[track_caller]
fn query_hidden(session: &mut Session, sql: &str) -> Vec<Vec<Cell>> {
    session.inspect().query_hidden_tables(sql, None).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows
}

fn cell(value: impl Into<Option<f64>>) -> Cell {
    value.into().map_or(Cell::Null, Cell::Real)
}

fn integer(value: impl Into<i64>) -> Cell {
    Cell::Integer(value.into())
}

fn text(text: &str) -> Cell {
    Cell::Text(text.to_owned())
}
