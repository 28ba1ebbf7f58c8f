//! True values on the Customers and Market screens. A key shows and hides true values. Each displayed day is recorded
//! as an inspection.

use super::{App, Order, Run, Stage};
use crate::context::ScreenId;
use novamind_insight::HiddenValues;
use novamind_session::INSPECTION_REJECTED;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::page_questions::HiddenValuesQuestion;
use novamind_worker::question::Pending;
use std::sync::Arc;

/// Visibility, requested day and received values of the overlay that shows true values.
#[derive(Default)]
pub struct HiddenValuesOverlay {
    is_on: bool,
    requested_day: Pending<HiddenValuesQuestion>,
    values: Option<Arc<HiddenValues>>,
}

impl Run {
    /// Returns the company. If true values are shown, the returned company contains the true values of its day.
    fn with_hidden_values(&self, company: Arc<DisplayedCompany>) -> Arc<DisplayedCompany> {
        let seen = self
            .overlay
            .values
            .as_ref()
            .filter(|seen| self.overlay.is_on && seen.day == company.observation.day);
        let hidden = seen.filter(|_| company.can_inspect).cloned();
        match hidden == company.hidden_values {
            true => company,
            false => {
                Arc::new(DisplayedCompany { hidden_values: hidden, ..DisplayedCompany::clone(&company) })
            }
        }
    }

    pub(super) fn set_company(&mut self, company: Arc<DisplayedCompany>) {
        self.company = self.with_hidden_values(company);
    }
}

impl App {
    pub(super) fn toggle_hidden_values(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        if !run.company.can_inspect {
            return self.show_error(INSPECTION_REJECTED);
        }
        if !matches!(run.screen, ScreenId::Customers | ScreenId::Market) {
            return self.show_error("true values are available on the Customers and Market screens");
        }
        if run.company.observation.day == 0 {
            return self.show_error("no day has been simulated yet");
        }
        run.overlay.is_on = !run.overlay.is_on;
        if run.overlay.is_on {
            return self.request_hidden_values();
        }
        self.apply_hidden_values();
        self.show_status("true values hidden");
    }

    /// Requests the true values of the current day if true values are shown and the values of that day are missing.
    pub(super) fn request_hidden_values(&mut self) {
        let is_busy = self.busy.is_some();
        let Stage::Run(run) = &mut self.stage else { return };
        let day = run.company.observation.day;
        let is_here = matches!(run.screen, ScreenId::Customers | ScreenId::Market) && run.company.can_inspect;
        let is_known = run.overlay.values.as_ref().is_some_and(|seen| seen.day == day);
        let is_asked =
            run.overlay.requested_day.question().is_some_and(|values_question| values_question.day == day);
        if !run.overlay.is_on || !is_here || is_busy || is_asked || day == 0 {
            return;
        }
        if is_known {
            return self.apply_hidden_values();
        }
        let ask = run.overlay.requested_day.ask(HiddenValuesQuestion { day });
        self.orders.push(Order::Ask(ask, false));
    }

    pub(super) fn set_hidden_values(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let Some((_, found)) = run.overlay.requested_day.try_take() else { return };
        match found {
            Ok(seen) => run.overlay.values = Some(seen),
            Err(rejection) => {
                run.overlay.is_on = false;
                self.show_error(rejection.message);
            }
        }
        self.apply_hidden_values();
    }

    fn apply_hidden_values(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.with_hidden_values(run.company.clone());
        if !Arc::ptr_eq(&company, &run.company) {
            run.company = company;
            self.refresh_queries();
        }
    }
}
