//! Simulated explanations of a run: causes of changes, results of other decisions, participation curves, and hidden state.
//!
//! Every function checks permissions first. Hidden state comes from inspections of the session, which are rejected or recorded.

mod counterfactual;
mod curve;
mod same_world;
#[cfg(test)]
mod voice_tests;
mod whatif;
mod why;
mod xray;

pub use counterfactual::last_read::{LastRead, OfRecord};
pub use counterfactual::one_each::unless_stopped;
pub use counterfactual::script::{PastCall, PastDecision};
pub use curve::access::CurveLook;
pub use curve::example::example_curve;
pub use curve::explorer::{
    CurveBasis, CurveExplorer, CurveOutcome, CurvePoint, Expected, PlanPoint, SAMPLED_LEADS, true_curve_of,
};
pub use same_world::SameWorld;
pub use whatif::{
    Adopted, BranchComparison, BranchFigure, BranchFigures, BranchOrigin, DecisionDifference, DecisionEdit,
    FORMS, FirstChange, FutureBand, Futures, Kin, MOST_ALTERNATIVES, OnWhatIfProgress, ParameterDifference,
    WhatIf, branch_with_decisions, branches_of, look_at_what_if, origin_of, sets_amounts,
};
pub use why::{
    Cause, Causes, Detail, InputDetail, OnProgress, WeekQuantity, WeekQuestion, Why, WhyPart, WhyProgress,
    begin_why, folder_of_causes, look_at_figure,
};
pub use xray::breakpoint::condition::{Condition, Direction, Judged, Relation, WorldEvent};
pub use xray::breakpoint::grammar::ConditionProblem;
pub use xray::breakpoint::list::Breakpoint;
pub use xray::breakpoint::look_back::LookBack;
pub use xray::breakpoint::measure::{Measure, MeasureKind, Quantity};
pub use xray::breakpoint::run::{Hit, RunUntil, TrueBefore};
pub use xray::company_day::{CompanyDay, JudgedPlan};
pub use xray::company_lens::CompanyLens;
pub use xray::customer_diary::{CustomerDay, DayOutcome, FirstDecision, FirstTerms};
pub use xray::customer_lens::CustomerLens;
pub use xray::difference::{CustomerDifference, Difference, RunDifference};
pub use xray::drift_state::{DriftState, GroupDrifted};
pub use xray::hidden_values::{HiddenValues, TrueGroup};
pub use xray::inspector::{Inspect, Inspector};
pub use xray::lead_equation::{LeadEquation, LeadFactor};
pub use xray::lens::Lens;
pub use xray::metrics::open_to_look_inside;
pub use xray::next_draws::{Draw, DrawnPart, Follows, KeyedDraws, MOST_DRAWS, NextDraws};
pub use xray::quality_equation::{PlanDelivered, QualityEquation, SharedGains};
pub use xray::reputation_equation::{Departures, LeastChanges, OwnChange, ReputationEquation, Spillover};
pub use xray::rival_state::{NextRivalMove, RivalState};
pub use xray::satisfaction_equation::{MoodTerm, SatisfactionEquation};
pub use xray::weighed::{PlanTerms, Term, TurningTerm, Weighed};
pub use xray::writes::target::WriteTarget;
pub use xray::writes::{WhoWrites, Write, WrittenBy};
