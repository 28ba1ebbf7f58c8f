//! Facts about the parameters in force that are computed when they are first needed.

use std::sync::{Arc, OnceLock};

use super::simulation::Simulation;
use novamind_record::folder::manifest::Manifest;
use novamind_tools::Numbers;

/// What follows from the parameters in force; replaced when they change.
#[derive(Default)]
pub(crate) struct DerivedOfParameters {
    numbers: OnceLock<Arc<Numbers>>,
    are_own: OnceLock<bool>,
}

impl DerivedOfParameters {
    /// The numbers that documentation names.
    pub(crate) fn numbers(&self, simulation: &Simulation) -> Arc<Numbers> {
        self.numbers.get_or_init(|| Numbers::of(&simulation.params).into()).clone()
    }

    /// Whether the parameters are, or were, others than those of the shipped scenario.
    pub(crate) fn has_own_parameters(&self, simulation: &Simulation, manifest: &Manifest) -> bool {
        let is_other = || simulation.overrides.is_used() || manifest.has_own_parameters();
        *self.are_own.get_or_init(is_other)
    }
}
