//! Causes of the change of a weekly figure: the equation, and a bar for each cause.

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use novamind_insight::{Cause, WeekQuantity, Why, WhyProgress};
use novamind_report::why::{CauseLine, equation, heading, lines};
use novamind_tools::Refusal;
use novamind_tui::canvas::{Canvas, Click, centered, fit, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::spark::bar;
use novamind_worker::asking::{Ask, Pending};
use novamind_worker::causes::WhyQuestion;

const WIDEST: u16 = 110;
/// Minimum number of visible causes below a long text.
const LEAST_LISTED: usize = 4;

/// The dialog.
pub struct WhyBox {
    /// The figure, with its source rows.
    figure: Figure,
    quantity: WeekQuantity,
    week: u32,
    asked: Pending<WhyQuestion>,
    answer: Option<Result<Why, Refusal>>,
    selected: usize,
}

impl WhyBox {
    /// Requests the causes of the change of a figure in a week.
    pub fn new(figure: Figure, quantity: WeekQuantity, week: u32) -> (WhyBox, Ask) {
        let (asked, ask) = Pending::asking(WhyQuestion { quantity, week });
        (WhyBox { figure, quantity, week, asked, answer: None, selected: 0 }, ask)
    }

    fn why(&self) -> Option<&Why> {
        self.answer.as_ref()?.as_ref().ok()
    }

    fn select(&mut self, to: usize) {
        self.selected = to.min(self.why().map_or(0, |why| why.parts.len()));
    }

    /// Opens the form of the decision, or the source rows for other causes.
    fn follow(&self) -> Outcome {
        let Some(why) = self.why() else { return Outcome::stay() };
        Outcome::close_with(match why.parts.get(self.selected).map(|part| part.cause) {
            // Closes a weekly report below.
            Some(Cause::Calls(tool)) => vec![Effect::CloseDialogs, Effect::ShowTool(tool)],
            _ => vec![Effect::ShowRows(self.figure.clone())],
        })
    }

    /// Asks the same question for another week, if that week has a previous one.
    fn turn(&self, week: u32, look: &Look<'_>) -> Outcome {
        let last = look.company.weeks.len() as u32;
        if !(2..=last).contains(&week) {
            return Outcome::stay();
        }
        // The source rows belong to the figure's own week.
        let title = format!("{} in week {week}", self.quantity.name());
        let figure = Figure { title, sql: None, why: Some((self.quantity, week)), ..self.figure.clone() };
        Outcome::close_with(vec![Effect::AskWhy(figure)])
    }

    fn waiting(&self) -> String {
        match self.asked.progress() {
            None => "reading the record …".to_owned(),
            Some(WhyProgress::Reaching(day, last)) => format!("simulating day {day} of {last} …"),
            Some(WhyProgress::Simulated(done, all)) => {
                format!("simulating the week without its causes: {done} of {all} …")
            }
        }
    }

    /// Formats a cause, its contribution and a bar, with differing inputs if they fit.
    fn line<'a>(
        canvas: &Canvas<'_>,
        cause: &CauseLine,
        most: f64,
        widths: [usize; 3],
        width: u16,
        here: bool,
    ) -> Line<'a> {
        let [name, amount, bars] = widths;
        let role = |own| if here { Role::Selection } else { own };
        let share = if most > 0.0 { cause.amount.abs() / most } else { 0.0 };
        let left = (width as usize).saturating_sub(name + amount + bars + 5);
        let mark = if here { "›" } else { " " };
        Line::from(vec![
            canvas
                .span(format!("{mark} {:<name$} {:>amount$} ", cause.name, cause.written), role(Role::Text)),
            canvas.span(bar(share, bars), role(Role::Series(0))),
            canvas.span(format!(" {}", fit(&cause.details.join(" · "), left)), role(Role::Dim)),
        ])
    }
}

impl Dialog for WhyBox {
    fn what(&self) -> String {
        format!("why {}, week {}", self.quantity.name(), self.week)
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List, Scope::Dialog]
    }

    fn hints(&self) -> Vec<Action> {
        match self.why() {
            Some(_) => vec![Action::Open, Action::Left, Action::Right, Action::Close],
            None => vec![Action::Left, Action::Right, Action::Close],
        }
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        match action {
            Action::Left => return self.turn(self.week.saturating_sub(1), look),
            Action::Right => return self.turn(self.week + 1, look),
            Action::Close | Action::Cancel => return Outcome::close(),
            Action::Open | Action::Confirm => return self.follow(),
            Action::Down => self.select(self.selected + 1),
            Action::Up => self.select(self.selected.saturating_sub(1)),
            Action::First => self.select(0),
            Action::Last => self.select(usize::MAX),
            _ => {}
        }
        Outcome::stay()
    }

    fn take_answers(&mut self) {
        if let Some((_, answer)) = self.asked.try_take() {
            self.answer = Some(answer);
        }
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        let again = self.selected == row;
        self.select(row);
        if again { self.follow() } else { Outcome::stay() }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let width = WIDEST.min(area.width.saturating_sub(2));
        let inner = width.saturating_sub(4) as usize;
        let (title, text, role) = match &self.answer {
            None => (self.what(), self.waiting(), Role::Warning),
            Some(Err(refusal)) => (self.what(), refusal.message.clone(), Role::Bad),
            Some(Ok(why)) => (heading(why), equation(why), Role::Strong),
        };
        let text = wrapped(&text, inner);
        let causes = self.why().map(lines).unwrap_or_default();
        let room = area.height.saturating_sub(2) as usize;
        let gap = usize::from(!causes.is_empty() && text.len() + causes.len() < room);
        let height = (text.len() + gap + causes.len() + 2) as u16;
        let own = centered(area, width, height);
        canvas.clear(own, Role::Text);
        let note = match self.why() {
            Some(why) => format!("simulated {} times", why.simulations),
            None => String::new(),
        };
        let inside = canvas.pane(own, &title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        // The list scrolls, the text does not.
        let listed = causes.len().min(LEAST_LISTED);
        let shown = text.len().min((inside.height as usize).saturating_sub(listed + gap).max(1));
        for (row, line) in rows_of(inside).zip(text.iter().take(shown)) {
            canvas.text(row, line, role);
        }
        let used = ((shown + gap) as u16).min(inside.height);
        let list = Rect { y: inside.y + used, height: inside.height - used, ..inside };
        let longest = |of: fn(&CauseLine) -> usize| causes.iter().map(of).max().unwrap_or(0);
        let bars = if inner >= 90 { 16 } else { 8 };
        let widths = [longest(|own| own.name.len()), longest(|own| own.written.len()), bars];
        let most = causes.iter().map(|own| own.amount.abs()).fold(0.0, f64::max);
        let first = self.selected.saturating_sub((list.height as usize).saturating_sub(1));
        for (row, (at, cause)) in rows_of(list).zip(causes.iter().enumerate().skip(first)) {
            let here = at == self.selected;
            if here {
                canvas.clear(row, Role::Selection);
            }
            let line = WhyBox::line(canvas, cause, most, widths, row.width, here);
            canvas.line(row, &line);
            canvas.click(row, Click::Row(0, at));
        }
        let label = |action| look.keys.label(action).unwrap_or_default();
        let weeks = format!("{} {} change week", label(Action::Left), label(Action::Right));
        let keys = match self.why() {
            Some(_) => format!("{} · {weeks} · {}", look.hint(Action::Open), look.hint(Action::Close)),
            None => format!("{weeks} · {}", look.hint(Action::Close)),
        };
        canvas.pane_keys(own, &keys);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{company, dialog_picture, in_dialog};
    use novamind_insight::{Detail, InputDetail, WhyPart};
    use novamind_record::figures::WeekFigure;
    use novamind_tools::ToolId;

    fn cancellations() -> WeekQuantity {
        WeekQuantity::of_company(WeekFigure::Cancellations).expect("a figure of the company")
    }

    fn asked() -> Figure {
        Figure { title: "cancellations".to_owned(), term: "churn", sql: None, why: None }
    }

    fn told() -> Why {
        let part = |cause, amount, details| WhyPart { cause, amount, details };
        let overload =
            Detail::Input(InputDetail { name: "peak overload", old: 0.0, new: 0.131, is_share: true });
        Why {
            week: 20,
            quantity: cancellations(),
            days: [7, 7],
            before: 195.0,
            after: 1137.0,
            parts: vec![
                part(Cause::Calls(ToolId::SetPrices), 938.0, Vec::new()),
                part(Cause::Rivals, 4.0, vec![Detail::Happened(2, "move")]),
                part(Cause::Service, 0.0, vec![overload]),
            ],
            rest: 0.0,
            simulations: 5,
        }
    }

    fn answered(answer: Result<Why, Refusal>) -> WhyBox {
        let (mut dialog, _) = WhyBox::new(asked(), cancellations(), 20);
        dialog.asked.put(answer);
        dialog.take_answers();
        dialog
    }

    #[test]
    fn causes_are_told_with_bars_and_lead_to_the_form_or_the_rows() {
        let company = company();
        let mut dialog = answered(Ok(told()));
        for (width, height) in [(60, 16), (80, 24), (120, 40), (200, 60)] {
            let picture = dialog_picture(&dialog, &company, width, height);
            for words in ["195 → 1,137", "price", "+938", "████████", "rivals", "+4", "residual"]
            {
                assert!(picture.contains(words), "{words} in {picture}");
            }
        }
        assert!(dialog_picture(&dialog, &company, 120, 40).contains("peak overload: 0.0% → 13.1%"));
        let first = in_dialog(&mut dialog, Action::Open, &company);
        assert!(
            first.close
                && matches!(first.effects[..], [Effect::CloseDialogs, Effect::ShowTool(ToolId::SetPrices)])
        );
        in_dialog(&mut dialog, Action::Down, &company);
        let second = in_dialog(&mut dialog, Action::Open, &company);
        assert!(matches!(&second.effects[..], [Effect::ShowRows(figure)] if figure.title == "cancellations"));
        in_dialog(&mut dialog, Action::Last, &company);
        assert_eq!(dialog.selected, 3);
    }

    #[test]
    fn another_week_is_asked_about_and_none_without_a_week_before_it() {
        let company = novamind_worker::company::Company::of(&crate::test_kit::played(4));
        let (mut dialog, _) = WhyBox::new(asked(), cancellations(), 3);
        assert!(dialog_picture(&dialog, &company, 80, 24).contains("change week"));
        for (action, week) in [(Action::Left, 2), (Action::Right, 4)] {
            let outcome = in_dialog(&mut dialog, action, &company);
            assert!(outcome.close, "a closed dialog takes no answer");
            let asked = outcome.effects.first();
            let Some(Effect::AskWhy(figure)) = asked else { panic!("nothing is asked") };
            assert_eq!(figure.why, Some((cancellations(), week)));
            assert!(figure.title.ends_with(&format!("in week {week}")), "{}", figure.title);
        }
        for (week, action) in [(2, Action::Left), (4, Action::Right)] {
            let (mut dialog, _) = WhyBox::new(asked(), cancellations(), week);
            assert!(in_dialog(&mut dialog, action, &company).effects.is_empty());
        }
    }

    #[test]
    fn the_work_is_told_and_esc_closes_it() {
        let company = company();
        let (mut dialog, _) = WhyBox::new(asked(), cancellations(), 9);
        assert!(dialog_picture(&dialog, &company, 60, 16).contains("reading the record"));
        dialog.asked.put_progress(WhyProgress::Simulated(3, 16));
        assert!(dialog_picture(&dialog, &company, 60, 16).contains("3 of 16"));
        assert!(in_dialog(&mut dialog, Action::Open, &company).effects.is_empty());
        assert!(in_dialog(&mut dialog, Action::Close, &company).close);
        let refused = answered(Err(Refusal::new("not_in_this_mode", "not in an unfinished baseline run")));
        assert!(dialog_picture(&refused, &company, 60, 16).contains("not in an unfinished baseline run"));
    }
}
