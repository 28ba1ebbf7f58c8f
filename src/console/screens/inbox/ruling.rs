//! Editor for rules, with a preview of their effect on every waiting thread. Sending needs confirmation.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::Value;

use super::estimate::market_of;
use super::{Inbox, InboxPane};
use crate::context::Look;
use crate::effect::Effect;
use crate::screens::panes::{Border, Seat, draw_pane};
use novamind_base::notation::{cents, json_number};
use novamind_rules::{AskingThread, Batch, Problem, RuledThread};
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::Field;
use novamind_worker::company::Company;

/// Returns the initial rules: accept any request for a plan at its list price or more. Plans without a price
/// are left out.
fn first_rules(company: &Company) -> String {
    let rule = |plan: Plan| {
        let list = company.setting(ToolId::SetPrices, plan.id());
        (list > 0.0).then(|| format!("accept asked_plan = {plan} and asked >= {}", json_number(list)))
    };
    Plan::ALL.into_iter().filter_map(rule).collect::<Vec<_>>().join("; ")
}

/// Rules being edited, with their effect.
#[derive(Debug, Clone)]
pub struct Ruling {
    pub field: Field,
    /// Whether keys type into the field.
    pub typing: bool,
    /// Their effect, or the error in the text.
    outcome: Result<Batch, Problem>,
}

impl Ruling {
    /// Starts with the last rules, otherwise with rules from the list prices.
    pub fn new(before: Option<&str>, threads: &[AskingThread], company: &Company, inbox: &Inbox) -> Ruling {
        let mut ruling = Ruling {
            field: Field::of(before.map_or_else(|| first_rules(company), str::to_owned)),
            typing: true,
            outcome: Err(Problem { text: String::new(), column: 1 }),
        };
        ruling.judge(threads, company, inbox);
        ruling
    }

    /// Applies the rules to the waiting threads again.
    pub fn judge(&mut self, threads: &[AskingThread], company: &Company, inbox: &Inbox) {
        self.outcome = novamind_rules::parse(self.field.text())
            .map(|rules| Batch::of(rules, threads.to_vec(), &market_of(company, &inbox.usage)));
    }

    /// Returns the threads that match a rule.
    fn meant(&self) -> impl Iterator<Item = &RuledThread> {
        let all = self.outcome.as_ref().map_or(&[][..], |batch| batch.threads.as_slice());
        all.iter().filter(|ruled| ruled.rule.is_some())
    }
}

/// Draws the layout for small windows: the preview above the rules.
pub fn arrange_small(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let [above, below] = Layout::vertical([Constraint::Percentage(45), Constraint::Min(0)]).areas(area);
    draw_pane(inbox, InboxPane::Thread, canvas, above, look);
    draw_pane(inbox, InboxPane::Offer, canvas, below, look);
}

impl Inbox {
    pub(super) fn start_ruling(&mut self, company: &Company) -> Vec<Effect> {
        let threads = self.asking(company);
        if threads.is_empty() {
            return vec![Effect::Complain("No thread is waiting for an answer".to_owned())];
        }
        self.ruling = Some(Ruling::new(self.last_rules.as_deref(), &threads, company, self));
        self.focus = InboxPane::Offer;
        self.scroll = 0;
        Vec::new()
    }

    pub(super) fn type_rules(&mut self, company: &Company, edit: &mut dyn FnMut(&mut Field)) {
        let Some(mut ruling) = self.ruling.take() else { return };
        edit(&mut ruling.field);
        ruling.judge(&self.asking(company), company, self);
        self.ruling = Some(ruling);
    }

    pub(super) fn rules_key(&mut self, key: &KeyEvent, company: &Company) {
        let ctrl = key.modifiers.contains(KeyModifiers::CONTROL);
        self.type_rules(company, &mut |field| match key.code {
            // Clears the field, as in the SQL editor.
            KeyCode::Char('n') if ctrl => *field = Field::default(),
            _ => {
                field.key(key);
            }
        });
    }

    /// Asks for confirmation to send the answers of the rules.
    pub(super) fn send_by_rules(&mut self, company: &Company) -> Vec<Effect> {
        let Some(ruling) = &self.ruling else { return Vec::new() };
        if !company.is_running() {
            return vec![Effect::Complain("The run is over; offers get no answer".to_owned())];
        }
        let batch = match &ruling.outcome {
            Ok(batch) => batch,
            Err(problem) => {
                return vec![Effect::Complain(format!("{} (column {})", problem.text, problem.column))];
            }
        };
        let calls = batch.calls();
        if calls.is_empty() {
            return vec![Effect::Complain("These rules match no waiting thread".to_owned())];
        }
        let text = batch.summary().join("\n");
        self.last_rules = Some(ruling.field.text().to_owned());
        vec![Effect::ConfirmCalls { calls, text }]
    }

    /// Returns whether rules have been sent in this session.
    pub fn has_sent_rules(&self) -> bool {
        self.last_rules.is_some()
    }

    /// Returns the tool calls of the last rules for the threads that wait now, and a summary; `None` if there
    /// are none.
    pub fn answers_of_before(&self, company: &Company) -> Option<(Vec<(ToolId, Value)>, String)> {
        let rules = novamind_rules::parse(self.last_rules.as_deref()?).ok()?;
        let batch = Batch::of(rules, self.asking(company), &market_of(company, &self.usage));
        let calls = batch.calls();
        (!calls.is_empty()).then(|| (calls, batch.summary().join("\n")))
    }

    pub(super) fn rules_border(&self, look: &Look<'_>) -> Border {
        use crate::action::Action::{Discard, SendOffer};
        let keys = format!("{} · ctrl-n clear the line · {}", look.hint(SendOffer), look.hint(Discard));
        Border {
            title: "Rules".to_owned(),
            note: "first match applies".to_owned(),
            keys,
            ..Border::default()
        }
    }

    /// Draws the field, and a line for each rule or the error.
    pub(super) fn draw_rules(&self, ruling: &Ruling, canvas: &mut Canvas<'_>, seat: Seat) {
        let mut rows = rows_of(seat.area);
        let Some(first) = rows.next() else { return };
        match ruling.typing {
            true => ruling.field.draw(canvas, first),
            false => canvas.text(first, ruling.field.text(), Role::Strong),
        }
        rows.next();
        let width = seat.area.width as usize;
        let (lines, role) = match &ruling.outcome {
            Ok(batch) => (batch.summary(), Role::Text),
            Err(problem) => (vec![format!("column {}: {}", problem.column, problem.text)], Role::Warning),
        };
        for (row, line) in rows.zip(lines.iter().flat_map(|line| wrapped(line, width))) {
            canvas.text(row, &line, role);
        }
    }

    pub(super) fn rules_preview_border(&self, ruling: &Ruling) -> Border {
        let title = format!("Preview for {}", ruling.meant().count());
        Border { title, note: "rule: asked → sent".to_owned(), ..Border::default() }
    }

    pub(super) fn draw_rules_preview(
        &self,
        ruling: &Ruling,
        canvas: &mut Canvas<'_>,
        seat: Seat,
        look: &Look<'_>,
    ) {
        let (inside, count) = (seat.area, ruling.meant().count());
        if seat.focused {
            canvas.page = inside.height.max(1);
        }
        let from = (self.scroll as usize).min(count.saturating_sub(inside.height as usize));
        for (row, ruled) in rows_of(inside).zip(ruling.meant().skip(from)) {
            draw_ruled(canvas, row, ruled, look);
        }
    }
}

fn draw_ruled(canvas: &mut Canvas<'_>, row: Rect, ruled: &RuledThread, look: &Look<'_>) {
    let own = &ruled.thread.waiting;
    let rule = ruled.rule.map_or(0, |at| at + 1);
    let asked = own.asked.map_or("–".to_owned(), cents);
    let words = format!(
        "{rule}  #{} {}  {asked} → {}  {}",
        own.customer,
        own.group,
        ruled.reply_in_words(),
        look.company.names.of(own.customer)
    );
    let role = if ruled.reply.is_ok() { Role::Text } else { Role::Warning };
    canvas.text(row, &words, role);
}
