//! R&D projects.

mod list_research_projects;
mod start_research_project;

pub use list_research_projects::{ListResearchProjects, ResearchProjects, ResearchTierFacts};
pub use start_research_project::StartResearchProject;

use super::refusal::Refusal;
use super::view::View;
use novamind_base::notation::dollars;

/// Rejects a purchase that cash does not cover; cash may reach exactly zero.
pub(super) fn affordable(cost: f64, view: &View<'_>) -> Result<(), Refusal> {
    if view.cash() >= cost {
        return Ok(());
    }
    let message = format!("costs {}, cash is {}", dollars(cost), dollars(view.cash()));
    Err(Refusal::new("insufficient_funds", message))
}
