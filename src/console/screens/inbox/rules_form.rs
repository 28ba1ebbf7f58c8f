//! Editor for rules, with a preview of their effect on every waiting thread. The user must confirm before the answers
//! are sent.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::layout::{Constraint, Layout, Rect};
use serde_json::Value;

use super::estimate::plan_economics;
use super::{Inbox, InboxPane};
use crate::context::ScreenContext;
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, PanePlacement, draw_pane};
use novamind_base::formatting::{dollars_and_cents, json_number};
use novamind_rules::{RuleBatch, RuleError, RuleOutcome, ThreadContext};
use novamind_session::identifiers::Plan;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;
use novamind_worker::company::DisplayedCompany;

/// Returns the initial rules: accept any request for a plan at its list price or more. Plans without a price have no
/// rule.
fn default_rules(company: &DisplayedCompany) -> String {
    let rule = |plan: Plan| {
        let list = company.current_setting(ToolId::SetPrices, plan.id());
        (list > 0.0).then(|| format!("accept asked_plan = {plan} and asked >= {}", json_number(list)))
    };
    Plan::ALL.into_iter().filter_map(rule).collect::<Vec<_>>().join("; ")
}

/// Rules that the user edits, with a preview of their effect.
#[derive(Debug, Clone)]
pub struct RulesForm {
    pub field: TextField,
    /// Whether key presses edit the text of the field.
    pub is_typing: bool,
    /// The effect of the rules, or the error in the text.
    batch: Result<RuleBatch, RuleError>,
}

impl RulesForm {
    /// Opens the editor with rules.
    pub fn new(
        rules: &str,
        threads: &[ThreadContext],
        company: &DisplayedCompany,
        inbox: &Inbox,
    ) -> RulesForm {
        let mut ruling = RulesForm {
            field: TextField::with_text(rules),
            is_typing: true,
            batch: Err(RuleError { text: String::new(), column: 1 }),
        };
        ruling.evaluate(threads, company, inbox);
        ruling
    }

    /// Applies the rules to the waiting threads again.
    pub fn evaluate(&mut self, threads: &[ThreadContext], company: &DisplayedCompany, inbox: &Inbox) {
        self.batch = novamind_rules::parse(self.field.text())
            .map(|rules| RuleBatch::new(rules, threads.to_vec(), &plan_economics(company, &inbox.usage)));
    }

    /// Returns the outcomes of threads that match a rule.
    fn matched_threads(&self) -> impl Iterator<Item = &RuleOutcome> {
        let all = self.batch.as_ref().map_or(&[][..], |batch| batch.threads.as_slice());
        all.iter().filter(|ruled| ruled.rule_index.is_some())
    }
}

/// Draws the layout for small windows: the preview above the rules.
pub fn draw_small_layout(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
    let [above, below] = Layout::vertical([Constraint::Percentage(45), Constraint::Min(0)]).areas(area);
    draw_pane(inbox, InboxPane::Thread, canvas, above, context);
    draw_pane(inbox, InboxPane::Offer, canvas, below, context);
}

impl Inbox {
    pub(super) fn open_rules(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        let rules = self.last_rules.clone().unwrap_or_else(|| default_rules(company));
        self.show_rules(&rules, company)
    }

    /// Opens rules with their preview.
    pub fn show_rules(&mut self, rules: &str, company: &DisplayedCompany) -> Vec<Effect> {
        let threads = self.waiting_threads(company);
        if threads.is_empty() {
            return vec![Effect::ShowError("No thread is waiting for an answer".to_owned())];
        }
        self.rules_form = Some(RulesForm::new(rules, &threads, company, self));
        self.focus = InboxPane::Offer;
        self.scroll = 0;
        Vec::new()
    }

    pub(super) fn edit_rules(&mut self, company: &DisplayedCompany, edit: &mut dyn FnMut(&mut TextField)) {
        let Some(mut ruling) = self.rules_form.take() else { return };
        edit(&mut ruling.field);
        ruling.evaluate(&self.waiting_threads(company), company, self);
        self.rules_form = Some(ruling);
    }

    pub(super) fn handle_rules_key(&mut self, key: &KeyEvent, company: &DisplayedCompany) {
        let ctrl = key.modifiers.contains(KeyModifiers::CONTROL);
        self.edit_rules(company, &mut |field| match key.code {
            // Ctrl-N clears the field, as in the SQL editor.
            KeyCode::Char('n') if ctrl => *field = TextField::default(),
            _ => {
                field.handle_key(key);
            }
        });
    }

    /// Requests confirmation before the answers of the rules are sent.
    pub(super) fn send_rule_answers(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        let Some(ruling) = &self.rules_form else { return Vec::new() };
        if !company.is_running() {
            return vec![Effect::ShowError("The run is over; no offer will be answered".to_owned())];
        }
        let batch = match &ruling.batch {
            Ok(batch) => batch,
            Err(problem) => {
                return vec![Effect::ShowError(format!("{} (column {})", problem.text, problem.column))];
            }
        };
        let calls = batch.tool_calls();
        if calls.is_empty() {
            return vec![Effect::ShowError("These rules match no waiting thread".to_owned())];
        }
        let text = batch.summary().join("\n");
        self.last_rules = Some(ruling.field.text().to_owned());
        vec![Effect::ConfirmCalls { calls, text }]
    }

    /// Returns whether rules have been sent in this session.
    pub fn has_sent_rules(&self) -> bool {
        self.last_rules.is_some()
    }

    /// Returns the tool calls of the last rules for the waiting threads, and a summary. Returns `None` if there are no
    /// calls.
    pub fn last_rule_answers(&self, company: &DisplayedCompany) -> Option<(Vec<(ToolId, Value)>, String)> {
        let rules = novamind_rules::parse(self.last_rules.as_deref()?).ok()?;
        let batch =
            RuleBatch::new(rules, self.waiting_threads(company), &plan_economics(company, &self.usage));
        let calls = batch.tool_calls();
        (!calls.is_empty()).then(|| (calls, batch.summary().join("\n")))
    }

    pub(super) fn rules_border(&self, context: &ScreenContext<'_>) -> PaneBorder {
        use crate::action::Action::{Discard, SendOffer};
        let keys = format!("{} · ctrl-n clear the line · {}", context.hint(SendOffer), context.hint(Discard));
        PaneBorder {
            title: "Rules".to_owned(),
            note: "first match applies".to_owned(),
            keys,
            ..PaneBorder::default()
        }
    }

    /// Draws the rules field. Below, draws one line for each rule, or the error.
    pub(super) fn draw_rules(&self, ruling: &RulesForm, canvas: &mut Canvas<'_>, placement: PanePlacement) {
        let mut rows = row_rects(placement.area);
        let Some(first) = rows.next() else { return };
        match ruling.is_typing {
            true => ruling.field.draw(canvas, first),
            false => canvas.draw_text(first, ruling.field.text(), Role::Strong),
        }
        rows.next();
        let width = placement.area.width as usize;
        let (lines, role) = match &ruling.batch {
            Ok(batch) => (batch.summary(), Role::Text),
            Err(problem) => (vec![format!("column {}: {}", problem.column, problem.text)], Role::Warning),
        };
        for (row, line) in rows.zip(lines.iter().flat_map(|line| wrap(line, width))) {
            canvas.draw_text(row, &line, role);
        }
    }

    pub(super) fn rules_preview_border(&self, ruling: &RulesForm) -> PaneBorder {
        let title = format!("Preview for {}", ruling.matched_threads().count());
        PaneBorder { title, note: "rule: asked → sent".to_owned(), ..PaneBorder::default() }
    }

    pub(super) fn draw_rules_preview(
        &self,
        ruling: &RulesForm,
        canvas: &mut Canvas<'_>,
        placement: PanePlacement,
        context: &ScreenContext<'_>,
    ) {
        let (inside, count) = (placement.area, ruling.matched_threads().count());
        if placement.focused {
            canvas.page_rows = inside.height.max(1);
        }
        let from = (self.scroll as usize).min(count.saturating_sub(inside.height as usize));
        for (row, ruled) in row_rects(inside).zip(ruling.matched_threads().skip(from)) {
            draw_rule_match(canvas, row, ruled, context);
        }
    }
}

fn draw_rule_match(canvas: &mut Canvas<'_>, row: Rect, ruled: &RuleOutcome, context: &ScreenContext<'_>) {
    let waiting_thread = &ruled.thread.waiting;
    let rule = ruled.rule_index.map_or(0, |at| at + 1);
    let asked = waiting_thread.asked.map_or("–".to_owned(), dollars_and_cents);
    let words = format!(
        "{rule}  #{} {}  {asked} → {}  {}",
        waiting_thread.customer,
        waiting_thread.group,
        ruled.describe_reply(),
        context.company.enterprise_names.name(waiting_thread.customer)
    );
    let role = if ruled.reply.is_ok() { Role::Text } else { Role::Warning };
    canvas.draw_text(row, &words, role);
}
