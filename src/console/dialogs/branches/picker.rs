//! The list of decisions that can be added to a week.

use novamind_insight::DecisionEdit;
use novamind_report::decision_words::decision_name;
use novamind_tools::{ToolId, ToolKind};
use novamind_worker::company::DisplayedCompany;

use super::changes::unscalable_reason;

/// A decision that can be added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum NewDecision {
    /// A call to a tool, with the values of its form.
    Call(ToolId),
    /// Capacity that follows usage.
    CapacityByUsage,
    /// A parameter of a debug run.
    Parameter,
}

/// Returns the decisions that can be added to a run.
pub(super) fn new_decisions(company: &DisplayedCompany) -> Vec<NewDecision> {
    let can_be_added = |tool: &ToolId| {
        let kind = tool.spec().kind;
        kind.changes_company() && kind != ToolKind::Time
    };
    let mut decisions: Vec<NewDecision> = ToolId::all().filter(can_be_added).map(NewDecision::Call).collect();
    decisions.push(NewDecision::CapacityByUsage);
    if company.observation.mode == novamind_record::mode::Mode::Debug {
        decisions.push(NewDecision::Parameter);
    }
    decisions
}

impl NewDecision {
    /// Returns the name and the description of the decision.
    pub(super) fn texts(self) -> (&'static str, &'static str) {
        match self {
            NewDecision::Call(tool) => (decision_name(tool), tool.spec().summary),
            NewDecision::CapacityByUsage => (
                "capacity by usage",
                "Rent the smallest tier that covers the busiest day of the week before, every week",
            ),
            NewDecision::Parameter => ("parameter", "Set a parameter of the simulation"),
        }
    }

    /// Returns the reason why the decision cannot be added.
    pub(super) fn refusal(self, company: &DisplayedCompany) -> Option<String> {
        let tool = match self {
            NewDecision::Call(tool) => tool,
            NewDecision::CapacityByUsage => ToolId::SetCapacityTier,
            NewDecision::Parameter => return None,
        };
        if !company.has_tool(tool) {
            return Some(format!("{} is not available in this lesson yet.", decision_name(tool)));
        }
        matches!(tool, ToolId::SendEnterpriseDeal | ToolId::RejectEnterpriseDeal).then(|| {
            "Answers to enterprises cannot be added. To change an answer that you sent, select it in its week.".to_owned()
        })
    }

    /// Returns the edit that multiplies all values of the tool from the first changed week on.
    pub(super) fn scaled(self, factor: f64) -> Result<DecisionEdit, String> {
        match self {
            NewDecision::Call(tool) => match unscalable_reason(tool) {
                Some(reason) => Err(reason),
                None => Ok(DecisionEdit::Scale { tool, factor }),
            },
            _ => Err("Only the amounts of a decision can be scaled.".to_owned()),
        }
    }

    /// Returns the edit that leaves out all decisions of the tool from the first changed week on.
    pub(super) fn left_out(self) -> Result<DecisionEdit, String> {
        match self {
            NewDecision::Call(tool) => Ok(DecisionEdit::Keep(tool)),
            _ => Err("Only decisions that you make with a tool can be left out.".to_owned()),
        }
    }
}
