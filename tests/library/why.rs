//! Causes of changes: figures of groups equal those of breakpoints and of the tables, and hidden ones stay hidden.

use std::ops::ControlFlow;
use std::path::Path;

use novamind::insight::{Causes, Condition, Inspect, OfRecord, WeekQuestion, Why, folder_of_causes};
use novamind::record::mode::Mode;
use novamind::session::Session;
use novamind::tools::Refusal;
use serde_json::json;

use crate::support::company::{begin_run, call, number, open_shop, week, weeks};

fn asked(text: &str) -> WeekQuestion {
    text.parse().unwrap_or_else(|problem| panic!("{text}: {problem:?}"))
}

fn why(session: &Session, text: &str) -> Result<Why, Refusal> {
    let mut causes = Causes::read(&folder_of_causes(session)?)?;
    Ok(causes.why(asked(text), &|_| ControlFlow::Continue(()))?.expect("it is not stopped"))
}

/// Plays some weeks, then one with higher prices.
fn run_in(folder: &Path) -> Session {
    let mut session = begin_run(folder, Mode::Debug, 140);
    open_shop(&mut session);
    let spend = json!({"targeted_spend": {"content_marketing": {"S1": 900, "S2": 400, "S3": 400}}});
    call(&mut session, "set_targeted_ad_spend", spend);
    weeks(&mut session, 9);
    call(&mut session, "set_prices", json!({"A": 40, "B": 80, "C": 160}));
    week(&mut session);
    session
}

#[test]
fn figures_of_a_group_are_those_of_breakpoints_and_of_the_tables() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path());
    for figure in
        ["churn(S1)", "cancellations(S1)", "leads(S2)", "conversion(S1)", "new_subscribers(S1)", "churn"]
    {
        let condition: Condition = format!("{figure} >= 0 over 7").parse().expect("a condition");
        let value = session.inspect().look_back(condition).expect("a look").today.value.expect("a value");
        let told = why(&session, figure).expect("an answer");
        assert!((told.after - value).abs() < 1e-12, "{figure}: {} {value}", told.after);
        let sum = told.parts.iter().map(|part| part.amount).sum::<f64>() + told.rest;
        assert!((sum - told.change()).abs() < 1e-9, "{figure}");
    }
    for figure in ["subscribers(S1)", "satisfaction(S1)", "reputation(S1)", "open_issues(S1)"] {
        let condition: Condition = format!("{figure} >= 0").parse().expect("a condition");
        let value = session.inspect().look_back(condition).expect("a look").today.value.expect("a value");
        assert_eq!(why(&session, figure).expect("an answer").after, value, "{figure}");
    }
    let left = number(
        &mut session,
        "SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) WHERE group_id = 'S1' \
         AND status = 'cancelled' AND end_day BETWEEN 64 AND 70",
    );
    let told = why(&session, "cancellations(S1)").expect("an answer");
    assert_eq!(told.after, left);
    assert_eq!(told.parts[0].cause.name(), "price", "{told:#?}");
}
