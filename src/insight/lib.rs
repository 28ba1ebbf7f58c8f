//! Explanations of a run by simulation: causes of changes, results of other decisions, participation curves, and
//! hidden state.
//!
//! Every public function first checks permissions. Hidden state is read only through inspections of the session. Each
//! inspection is rejected or recorded.

mod causes;
mod counterfactual;
mod curve;
mod inspection;
#[cfg(test)]
mod model_voice_tests;
mod replayed_world;
mod whatif;

pub use causes::{
    Cause, CauseAnalysis, CauseContribution, CauseDetail, CauseProgress, CauseProgressFn, ChangeExplanation,
    InputDetail, WeekQuantity, WeekQuestion, begin_cause_analysis, cause_analysis_folder,
    record_figure_inspection,
};
pub use counterfactual::analysis_cache::{AnalysisCache, RecordAnalysis};
pub use counterfactual::parallel_map::continue_unless_stopped;
pub use counterfactual::recorded_steps::{RecordedCall, RecordedDecision};
pub use counterfactual::suspended_setting::SuspendedSetting;
pub use curve::access::CurveInspection;
pub use curve::example::example_curve;
pub use curve::explorer::{
    CurveBasis, CurveExplorer, CurveOutcome, CurvePoint, ExpectedRange, LEAD_SAMPLE_SIZE, PlanPoint,
    true_curve,
};
pub use inspection::breakpoint::condition::{
    ComparisonOperator, Condition, ConditionState, Direction, WorldEvent,
};
pub use inspection::breakpoint::condition_history::ConditionHistory;
pub use inspection::breakpoint::grammar::ConditionParseError;
pub use inspection::breakpoint::list::Breakpoint;
pub use inspection::breakpoint::measure::{Measure, MeasureKind, Quantity};
pub use inspection::breakpoint::run_until::{BreakpointHit, BreakpointRun, StillTrueBreakpoint};
pub use inspection::competitor_state::{CompetitorState, NextCompetitorMove};
pub use inspection::customer_view::CustomerView;
pub use inspection::day_replay::open_for_inspection;
pub use inspection::difference::{CustomerDifference, DayDifference, RunDifference};
pub use inspection::drift_state::{DriftState, GroupDriftState};
pub use inspection::enterprise_thread_day::{EnterpriseThreadDay, EvaluatedPlan};
pub use inspection::enterprise_view::EnterpriseView;
pub use inspection::hidden_values::{HiddenValues, TrueGroupValues};
pub use inspection::individual_recorder::{IndividualDay, LeadPlanTerms, SignupDecision, SubscriberOutcome};
pub use inspection::individual_view::IndividualView;
pub use inspection::inspector::{Inspect, Inspector};
pub use inspection::lead_equation::{LeadEquation, LeadFactor};
pub use inspection::next_draws::{Draw, DrawEffect, KeyedDraws, MAX_DRAWS, NextDraws, RandomPart};
pub use inspection::quality_equation::{DeliveredPlanQuality, QualityEquation, SharedQualityGains};
pub use inspection::reputation_equation::{
    CancellationEffect, ChangeThresholds, ReputationEquation, Spillover, SubscriberContribution,
};
pub use inspection::satisfaction_equation::{SatisfactionEquation, SatisfactionTerm};
pub use inspection::weighed_decision::{DecisionTerm, DecisiveTerm, RenewalPlanTerms, WeighedDecision};
pub use inspection::writes::target::WriteTarget;
pub use inspection::writes::{FigureWrite, FigureWrites, WriteSource};
pub use replayed_world::ReplayedWorld;
pub use whatif::{
    AdoptedBranch, BranchComparison, BranchFigure, BranchFigures, BranchOrigin, CallDifference, DecisionEdit,
    DecisionHistory, EDIT_SYNTAX, FirstChange, FutureInterval, Futures, MAX_ALTERNATIVES, MAX_FACTOR,
    ParameterDifference, RejectedDecision, RelatedRun, WhatIf, WhatIfProgressFn, branch_origin,
    create_branch_with_decisions, is_scalable, record_what_if_inspection, related_runs, scale_numbers,
};
