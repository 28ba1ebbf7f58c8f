//! True values on the Customers and Market screens. A key shows and hides them; showing a day is a recorded
//! inspection.

use super::{App, Order, Run, Stage};
use crate::context::ScreenId;
use novamind_insight::HiddenValues;
use novamind_session::REFUSED_LOOK;
use novamind_worker::asking::Pending;
use novamind_worker::company::Company;
use novamind_worker::questions::HiddenValuesQuestion;
use std::sync::Arc;

/// Whether true values are shown, and which were requested.
#[derive(Default)]
pub struct Overlay {
    is_on: bool,
    asked: Pending<HiddenValuesQuestion>,
    seen: Option<Arc<HiddenValues>>,
}

impl Run {
    /// Returns the company with the true values of its day if they are shown.
    fn with_hidden_values(&self, company: Arc<Company>) -> Arc<Company> {
        let seen =
            self.overlay.seen.as_ref().filter(|seen| self.overlay.is_on && seen.day == company.seen.day);
        let hidden = seen.filter(|_| company.may_look_inside).cloned();
        match hidden == company.hidden {
            true => company,
            false => Arc::new(Company { hidden, ..Company::clone(&company) }),
        }
    }

    pub(super) fn take_company(&mut self, company: Arc<Company>) {
        self.company = self.with_hidden_values(company);
    }
}

impl App {
    pub(super) fn toggle_hidden_values(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        if !run.company.may_look_inside {
            return self.complain(REFUSED_LOOK);
        }
        if !matches!(run.here, ScreenId::Customers | ScreenId::Market) {
            return self.complain("true values are available on the Customers and Market screens");
        }
        if run.company.seen.day == 0 {
            return self.complain("no day has run yet");
        }
        run.overlay.is_on = !run.overlay.is_on;
        if run.overlay.is_on {
            return self.ask_hidden_values();
        }
        self.show_hidden_values();
        self.say("true values hidden");
    }

    /// Requests the true values of the current day if they are shown and unknown.
    pub(super) fn ask_hidden_values(&mut self) {
        let is_busy = self.busy.is_some();
        let Stage::Run(run) = &mut self.stage else { return };
        let day = run.company.seen.day;
        let is_here =
            matches!(run.here, ScreenId::Customers | ScreenId::Market) && run.company.may_look_inside;
        let is_known = run.overlay.seen.as_ref().is_some_and(|seen| seen.day == day);
        let is_asked = run.overlay.asked.question().is_some_and(|asked| asked.day == day);
        if !run.overlay.is_on || !is_here || is_busy || is_asked || day == 0 {
            return;
        }
        if is_known {
            return self.show_hidden_values();
        }
        let ask = run.overlay.asked.ask(HiddenValuesQuestion { day });
        self.orders.push(Order::Ask(ask, false));
    }

    pub(super) fn take_hidden_values(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let Some((_, found)) = run.overlay.asked.try_take() else { return };
        match found {
            Ok(seen) => run.overlay.seen = Some(seen),
            Err(refusal) => {
                run.overlay.is_on = false;
                self.complain(refusal.message);
            }
        }
        self.show_hidden_values();
    }

    fn show_hidden_values(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.with_hidden_values(run.company.clone());
        if !Arc::ptr_eq(&company, &run.company) {
            run.company = company;
            self.renew();
        }
    }
}
