//! Causes of the change in a weekly figure: the equation, and a bar for each cause.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, DialogContent, DialogResponse, DialogView};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use novamind_insight::{Cause, CauseProgress, ChangeExplanation, WeekQuantity};
use novamind_record::figures::WeekFigure;
use novamind_report::figure_name;
use novamind_report::why::{CauseLine, cause_lines, equation, heading};
use novamind_tools::Rejection;
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects, truncate_to_width};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline::bar;
use novamind_worker::causes::CausesQuestion;
use novamind_worker::question::{OutgoingQuestion, Pending};

const MAX_DIALOG_WIDTH: u16 = 110;
/// Minimum number of visible causes below a long text.
const MIN_LISTED_CAUSES: usize = 4;
/// Maximum number of lines for the details of the selected cause, if they do not fit in the row of a cause.
const MAX_DETAIL_LINES: usize = 2;

/// The dialog that shows the causes of a change.
pub struct CausesDialog {
    /// The figure, with its source rows.
    figure: Figure,
    quantity: WeekQuantity,
    week: u32,
    asked: Pending<CausesQuestion>,
    answer: Option<Result<ChangeExplanation, Rejection>>,
    selected: usize,
}

impl CausesDialog {
    /// Requests the causes of the change in a figure in one week.
    pub fn new(figure: Figure, quantity: WeekQuantity, week: u32) -> (CausesDialog, OutgoingQuestion) {
        let (pending, ask) = Pending::with_question(CausesQuestion { quantity, week });
        (CausesDialog { figure, quantity, week, asked: pending, answer: None, selected: 0 }, ask)
    }

    fn causes(&self) -> Option<&ChangeExplanation> {
        self.answer.as_ref()?.as_ref().ok()
    }

    fn select(&mut self, to: usize) {
        self.selected = to.min(self.causes().map_or(0, |why| why.contributions.len()));
    }

    /// Opens the form of the decision, or the source rows for other causes.
    fn open_source(&self) -> DialogResponse {
        let Some(why) = self.causes() else { return DialogResponse::stay() };
        DialogResponse::confirm_with(match why.contributions.get(self.selected).map(|part| part.cause) {
            // A weekly report may be open below this dialog and would cover the form.
            Some(Cause::Calls(tool)) => vec![Effect::CloseDialogs, Effect::ShowTool(tool)],
            _ => vec![Effect::ShowRows(self.figure.clone())],
        })
    }

    /// Requests the causes for another week, if that week has a previous week.
    fn change_week(&self, week: u32, context: &ScreenContext<'_>) -> DialogResponse {
        let last = context.company.weeks.len() as u32;
        let limit = match week {
            ..2 => Some("week 2 is the first week that can be compared with the week before".to_owned()),
            week if week > last => Some(format!("week {last} is the newest week")),
            _ => None,
        };
        if let Some(limit) = limit {
            return DialogResponse::stay_with(vec![Effect::ShowStatus(limit)]);
        }
        // The source rows cover only the original week of the figure.
        let title = format!("{} in week {week}", figure_name(&self.quantity.name()));
        let figure =
            Figure { title, sql: None, week_quantity: Some((self.quantity, week)), ..self.figure.clone() };
        DialogResponse::confirm_with(vec![Effect::ShowCauses(figure)])
    }

    fn progress_text(&self) -> String {
        match self.asked.progress() {
            None => "reading the record …".to_owned(),
            Some(CauseProgress::Replaying(day, last)) => format!("simulating day {day} of {last} …"),
            Some(CauseProgress::Simulated(done, all)) => {
                format!("simulating the week without each cause: {done} of {all} …")
            }
        }
    }

    /// Formats a cause, its contribution and a bar. The differing inputs are added if they fit.
    fn cause_line<'a>(
        canvas: &Canvas<'_>,
        cause: &CauseLine,
        most: f64,
        widths: [usize; 3],
        width: u16,
        here: bool,
    ) -> Line<'a> {
        let [name, amount, bars] = widths;
        let role = |usual| if here { Role::Selection } else { usual };
        let share = if most > 0.0 { cause.amount.abs() / most } else { 0.0 };
        let left = detail_width(widths, width as usize);
        let mark = if here { "›" } else { " " };
        Line::from(vec![
            canvas.span(
                format!("{mark} {:<name$} {:>amount$} ", cause.name, cause.amount_text),
                role(Role::Text),
            ),
            canvas.span(bar(share, bars), role(Role::Series(0))),
            canvas.span(format!(" {}", truncate_to_width(&cause.details.join(" · "), left)), role(Role::Dim)),
        ])
    }
}

/// Returns the space for the details of a cause in a row of the given width.
fn detail_width(columns: [usize; 3], row: usize) -> usize {
    row.saturating_sub(columns.iter().sum::<usize>() + 5)
}

impl Dialog for CausesDialog {
    fn record_name(&self) -> String {
        format!("why {}, week {}", self.quantity.name(), self.week)
    }

    fn tour_view(&self) -> Option<DialogView> {
        let is_rejected = matches!(self.answer, Some(Err(_)));
        let is_of_cancellations = self.quantity.figure() == WeekFigure::Cancellations;
        let view = DialogView::new(DialogContent::CancellationCauses, self.causes().is_some());
        (is_of_cancellations && !is_rejected).then_some(view)
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List, Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        match self.causes() {
            Some(_) => vec![Action::Open, Action::Left, Action::Right, Action::Close],
            None => vec![Action::Left, Action::Right, Action::Close],
        }
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Left => return self.change_week(self.week.saturating_sub(1), context),
            Action::Right => return self.change_week(self.week + 1, context),
            Action::Close | Action::Cancel => return DialogResponse::close(),
            Action::Open | Action::Confirm => return self.open_source(),
            Action::Down => self.select(self.selected + 1),
            Action::Up => self.select(self.selected.saturating_sub(1)),
            Action::First => self.select(0),
            Action::Last => self.select(usize::MAX),
            _ => {}
        }
        DialogResponse::stay()
    }

    fn take_answers(&mut self) {
        if let Some((_, answer)) = self.asked.try_take() {
            self.answer = Some(answer);
        }
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        let again = self.selected == row;
        self.select(row);
        if again { self.open_source() } else { DialogResponse::stay() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let width = MAX_DIALOG_WIDTH.min(area.width.saturating_sub(2));
        let inner = width.saturating_sub(4) as usize;
        let (title, text, role) = match &self.answer {
            None => (self.record_name(), self.progress_text(), Role::Warning),
            Some(Err(rejection)) => (self.record_name(), rejection.message.clone(), Role::Bad),
            Some(Ok(why)) => (heading(why), equation(why), Role::Strong),
        };
        let text = wrap(&text, inner);
        let causes = self.causes().map(cause_lines).unwrap_or_default();
        let longest = |of: fn(&CauseLine) -> usize| causes.iter().map(of).max().unwrap_or(0);
        let bars = if inner >= 90 { 16 } else { 8 };
        let widths = [
            longest(|cause_line| cause_line.name.len()),
            longest(|cause_line| cause_line.amount_text.len()),
            bars,
        ];
        let detail_lines = |cause: &CauseLine| {
            let detail = cause.details.join(" · ");
            let fits = detail.chars().count() <= detail_width(widths, inner);
            if fits { Vec::new() } else { wrap(&detail, inner) }
        };
        // The same number of lines is reserved for all causes, so the list stays in place when the selection moves.
        let details = causes.iter().map(|cause| detail_lines(cause).len()).max().unwrap_or(0);
        let details = details.min(MAX_DETAIL_LINES);
        let room = area.height.saturating_sub(2) as usize;
        let gap = usize::from(!causes.is_empty() && text.len() + causes.len() + details < room);
        let height = (text.len() + gap + causes.len() + details + 2) as u16;
        let dialog_area = centered_rect(area, width, height);
        canvas.clear(dialog_area, Role::Text);
        let note = match self.causes() {
            Some(why) => format!("simulated {} times", why.simulation_count),
            None => String::new(),
        };
        let inside = canvas.draw_pane_frame(dialog_area, &title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        // The list of causes scrolls, and the text stays in place.
        let listed = causes.len().min(MIN_LISTED_CAUSES);
        let fixed = listed + gap + details;
        let shown = text.len().min((inside.height as usize).saturating_sub(fixed).max(1));
        for (row, line) in row_rects(inside).zip(text.iter().take(shown)) {
            canvas.draw_text(row, line, role);
        }
        let used = ((shown + gap) as u16).min(inside.height);
        let list_height = (inside.height - used).saturating_sub(details as u16);
        let list = Rect { y: inside.y + used, height: list_height, ..inside };
        let below = Rect { y: list.bottom(), height: inside.bottom() - list.bottom(), ..inside };
        if let Some(cause) = causes.get(self.selected) {
            for (row, line) in row_rects(below).zip(detail_lines(cause)) {
                canvas.draw_text(row, &line, Role::Dim);
            }
        }
        let most = causes.iter().map(|cause| cause.amount.abs()).fold(0.0, f64::max);
        let first = self.selected.saturating_sub((list.height as usize).saturating_sub(1));
        for (row, (at, cause)) in row_rects(list).zip(causes.iter().enumerate().skip(first)) {
            let here = at == self.selected;
            if here {
                canvas.clear(row, Role::Selection);
            }
            let line = CausesDialog::cause_line(canvas, cause, most, widths, row.width, here);
            canvas.draw_line(row, &line);
            canvas.register_click(row, Click::Row(0, at));
        }
        let label = |action| context.keys.label(action).unwrap_or_default();
        let weeks = format!("{} {} change week", label(Action::Left), label(Action::Right));
        let keys = match self.causes() {
            Some(_) => format!("{} · {weeks} · {}", context.hint(Action::Open), context.hint(Action::Close)),
            None => format!("{weeks} · {}", context.hint(Action::Close)),
        };
        canvas.draw_pane_keys(dialog_area, &keys);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{dialog_action, dialog_text, new_company};
    use novamind_insight::{CauseContribution, CauseDetail, InputDetail, SuspendedSetting};
    use novamind_tools::ToolId;

    fn cancellations() -> WeekQuantity {
        WeekQuantity::for_company(WeekFigure::Cancellations).expect("a figure of the company")
    }

    fn question_figure() -> Figure {
        Figure { title: "cancellations".to_owned(), term: "churn", sql: None, week_quantity: None }
    }

    fn example_causes() -> ChangeExplanation {
        let part = |cause, amount, details| CauseContribution { cause, amount, details };
        let overload =
            CauseDetail::Input(InputDetail { name: "peak overload", old: 0.0, new: 0.131, is_share: true });
        ChangeExplanation {
            week: 20,
            quantity: cancellations(),
            days: [7, 7],
            before: 195.0,
            after: 1137.0,
            contributions: vec![
                part(Cause::Calls(ToolId::SetPrices), 938.0, Vec::new()),
                part(Cause::Competitors, 4.0, vec![CauseDetail::Occurrences(2, "move")]),
                part(Cause::Service, 0.0, vec![overload]),
            ],
            residual: 0.0,
            simulation_count: 5,
        }
    }

    fn dialog_with_answer(answer: Result<ChangeExplanation, Rejection>) -> CausesDialog {
        let (mut dialog, _) = CausesDialog::new(question_figure(), cancellations(), 20);
        dialog.asked.set_answer(answer);
        dialog.take_answers();
        dialog
    }

    #[test]
    fn causes_link_to_the_form_or_the_rows() {
        let company = new_company();
        let mut dialog = dialog_with_answer(Ok(example_causes()));
        for (width, height) in [(60, 16), (80, 24), (120, 40), (200, 60)] {
            let picture = dialog_text(&dialog, &company, width, height);
            for words in ["195 → 1,137", "price", "+938", "████████", "competitors", "+4", "residual"]
            {
                assert!(picture.contains(words), "{words} in {picture}");
            }
        }
        assert!(dialog_text(&dialog, &company, 120, 40).contains("peak overload: 0.0% → 13.1%"));
        let first = dialog_action(&mut dialog, Action::Open, &company);
        assert!(
            first.closes
                && matches!(first.effects[..], [Effect::CloseDialogs, Effect::ShowTool(ToolId::SetPrices)])
        );
        dialog_action(&mut dialog, Action::Down, &company);
        let second = dialog_action(&mut dialog, Action::Open, &company);
        assert!(matches!(&second.effects[..], [Effect::ShowRows(figure)] if figure.title == "cancellations"));
        dialog_action(&mut dialog, Action::Last, &company);
        assert_eq!(dialog.selected, 3);
    }

    #[test]
    fn details_that_do_not_fit_are_shown_for_the_selected_cause() {
        let company = new_company();
        let part = |cause, amount, detail| CauseContribution { cause, amount, details: vec![detail] };
        let continued = Cause::Continued(SuspendedSetting::Operations);
        let contributions = vec![
            part(continued, -102.0, CauseDetail::Removed { first: 64, last: 77 }),
            part(Cause::RenewalsDue, 94.0, CauseDetail::RenewalsDue { bills: [671, 750] }),
        ];
        let mut dialog = dialog_with_answer(Ok(ChangeExplanation { contributions, ..example_causes() }));
        let words =
            |picture: String| picture.replace('┃', " ").split_whitespace().collect::<Vec<_>>().join(" ");
        for (width, height) in [(60, 16), (80, 24), (120, 40), (200, 60)] {
            let first = words(dialog_text(&dialog, &company, width, height));
            assert!(first.contains("compared with a simulation without it on days 64 to 77"), "{first}");
            dialog_action(&mut dialog, Action::Down, &company);
            let second = words(dialog_text(&dialog, &company, width, height));
            assert!(second.contains("renewals due") && second.contains("671 → 750 due"), "{second}");
            assert!(second.contains("without the other"), "{second}");
            dialog_action(&mut dialog, Action::First, &company);
        }
    }

    #[test]
    fn week_can_be_changed_except_to_the_first_week() {
        let company =
            novamind_worker::company::DisplayedCompany::from_session(&crate::test_kit::played_session(4));
        let (mut dialog, _) = CausesDialog::new(question_figure(), cancellations(), 3);
        assert!(dialog_text(&dialog, &company, 80, 24).contains("change week"));
        for (action, week) in [(Action::Left, 2), (Action::Right, 4)] {
            let outcome = dialog_action(&mut dialog, action, &company);
            assert!(outcome.closes, "a closed dialog takes no answer");
            let effect = outcome.effects.first();
            let Some(Effect::ShowCauses(figure)) = effect else { panic!("nothing is asked") };
            assert_eq!(figure.week_quantity, Some((cancellations(), week)));
            assert!(figure.title.ends_with(&format!("in week {week}")), "{}", figure.title);
        }
        for (week, action) in [(2, Action::Left), (4, Action::Right)] {
            let (mut dialog, _) = CausesDialog::new(question_figure(), cancellations(), week);
            let outcome = dialog_action(&mut dialog, action, &company);
            let [Effect::ShowStatus(reason)] = &outcome.effects[..] else { panic!("{:?}", outcome.effects) };
            assert!(!outcome.closes && reason.starts_with(&format!("week {week} is the ")), "{reason}");
        }
    }

    #[test]
    fn causes_dialog_shows_progress_until_closed() {
        let company = new_company();
        let (mut dialog, _) = CausesDialog::new(question_figure(), cancellations(), 9);
        assert!(dialog_text(&dialog, &company, 60, 16).contains("reading the record"));
        dialog.asked.set_progress(CauseProgress::Simulated(3, 16));
        assert!(dialog_text(&dialog, &company, 60, 16).contains("3 of 16"));
        assert!(dialog_action(&mut dialog, Action::Open, &company).effects.is_empty());
        assert!(dialog_action(&mut dialog, Action::Close, &company).closes);
        let refused =
            dialog_with_answer(Err(Rejection::new("not_in_this_mode", "not in an unfinished baseline run")));
        assert!(dialog_text(&refused, &company, 60, 16).contains("not in an unfinished baseline run"));
    }
}
