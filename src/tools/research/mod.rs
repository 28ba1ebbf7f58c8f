//! Tools for R&D projects.

mod list_research_projects;
mod start_research_project;

pub use list_research_projects::{ListResearchProjects, ResearchProjects, ResearchTierFacts};
pub use start_research_project::StartResearchProject;

use super::rejection::Rejection;
use super::tool_context::ToolContext;
use novamind_base::formatting::dollars;

/// Rejects a purchase that costs more than the available cash.
pub(super) fn check_affordable(cost: f64, view: &ToolContext<'_>) -> Result<(), Rejection> {
    if view.cash() >= cost {
        return Ok(());
    }
    let message = format!("costs {}, cash is {}", dollars(cost), dollars(view.cash()));
    Err(Rejection::new("insufficient_funds", message))
}
