//! Causes of changes: figures of groups equal the figures of breakpoints and tables, and hidden figures stay hidden.

use std::ops::ControlFlow;
use std::path::Path;

use novamind::insight::{
    CauseAnalysis, ChangeExplanation, Condition, Inspect, RecordAnalysis, WeekQuestion, cause_analysis_folder,
};
use novamind::record::mode::Mode;
use novamind::session::Session;
use novamind::tools::Rejection;
use serde_json::json;

use crate::support::company::{
    advance_week, advance_weeks, apply_opening_decisions, begin_run, call_tool, query_number,
};

fn parse_question(text: &str) -> WeekQuestion {
    text.parse().unwrap_or_else(|problem| panic!("{text}: {problem:?}"))
}

fn explain_change(session: &Session, text: &str) -> Result<ChangeExplanation, Rejection> {
    let mut causes = CauseAnalysis::open(&cause_analysis_folder(session)?)?;
    Ok(causes.explain(parse_question(text), &|_| ControlFlow::Continue(()))?.expect("it is not stopped"))
}

/// Plays several weeks, then a week with higher prices.
fn run_in(folder: &Path) -> Session {
    let mut session = begin_run(folder, Mode::Debug, 140);
    apply_opening_decisions(&mut session);
    let spend = json!({"targeted_spend": {"content_marketing": {"S1": 900, "S2": 400, "S3": 400}}});
    call_tool(&mut session, "set_targeted_ad_spend", spend);
    advance_weeks(&mut session, 9);
    call_tool(&mut session, "set_prices", json!({"A": 40, "B": 80, "C": 160}));
    advance_week(&mut session);
    session
}

#[test]
fn causes_of_group_figures_match_breakpoints_and_tables() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path());
    for figure in
        ["churn(S1)", "cancellations(S1)", "leads(S2)", "conversion(S1)", "new_subscribers(S1)", "churn"]
    {
        let condition: Condition = format!("{figure} >= 0 over 7").parse().expect("a condition");
        let value =
            session.inspect().condition_history(condition).expect("a result").today.value.expect("a value");
        let explanation = explain_change(&session, figure).expect("an answer");
        assert!((explanation.after - value).abs() < 1e-12, "{figure}: {} {value}", explanation.after);
        let sum =
            explanation.contributions.iter().map(|part| part.amount).sum::<f64>() + explanation.residual;
        assert!((sum - explanation.total_change()).abs() < 1e-9, "{figure}");
    }
    for figure in ["subscribers(S1)", "satisfaction(S1)", "reputation(S1)", "open_issues(S1)"] {
        let condition: Condition = format!("{figure} >= 0").parse().expect("a condition");
        let value =
            session.inspect().condition_history(condition).expect("a result").today.value.expect("a value");
        assert_eq!(explain_change(&session, figure).expect("an answer").after, value, "{figure}");
    }
    let left = query_number(
        &mut session,
        "SELECT count(*) FROM subscriptions JOIN customers USING (customer_id) WHERE group_id = 'S1' \
         AND status = 'cancelled' AND end_day BETWEEN 64 AND 70",
    );
    let explanation = explain_change(&session, "cancellations(S1)").expect("an answer");
    assert_eq!(explanation.after, left);
    // After the renewals that were due, the largest cause is the decision.
    let largest = explanation.contributions.iter().find(|part| part.cause.name() != "renewals due");
    assert_eq!(largest.expect("causes").cause.name(), "price", "{explanation:#?}");
}
