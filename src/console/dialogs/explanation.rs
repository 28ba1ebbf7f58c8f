//! Explanations of figures, fields and screens, with source rows and links to related terms.

use std::sync::Arc;

use ratatui::layout::Rect;
use ratatui::text::Line;
use unicode_width::UnicodeWidthStr;

use super::{Dialog, DialogResponse, glossary_picture};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use novamind_glossary::{Explanation, Subject};
use novamind_tools::ParameterNumbers;
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

/// Width of the longest description of a figure that is a title. A longer description, such as the text of an action
/// item, is a part of the explanation.
pub(super) const MAX_FIGURE_TITLE: usize = 36;

#[derive(Debug, Clone, Copy)]
enum Link {
    Subject(Subject),
    Screen(Action),
}

impl Link {
    fn title(self, context: &ScreenContext<'_>) -> (String, &'static str) {
        match self {
            Link::Subject(subject) => (subject.title(), subject.kind()),
            Link::Screen(action) => {
                let key = context.keys.label(action).map_or(String::new(), |key| format!(" ({key})"));
                (format!("{}{key}", action.entry().title), "go to")
            }
        }
    }
}

struct ExplanationPage {
    /// The explained term: a glossary entry, a tool argument or a table column.
    term: String,
    title: String,
    note: String,
    /// Heading and text of each section.
    parts: Vec<(String, String)>,
    links: Vec<Link>,
    selected: usize,
}

impl ExplanationPage {
    fn from_subject(subject: Subject, numbers: &ParameterNumbers) -> ExplanationPage {
        let explanation = Explanation::new(subject, numbers);
        let places = explanation.places.iter().filter_map(|name| Action::by_name(Scope::Global, name));
        ExplanationPage {
            term: subject.name(),
            title: explanation.title,
            note: explanation.note,
            parts: explanation
                .sections
                .into_iter()
                .map(|section| (section.name.to_owned(), section.text))
                .collect(),
            links: explanation
                .related
                .iter()
                .copied()
                .map(Link::Subject)
                .chain(places.map(Link::Screen))
                .collect(),
            selected: 0,
        }
    }
}

/// The explanation dialog.
pub struct ExplainDialog {
    /// The pages visited, with the current page last.
    pages: Vec<ExplanationPage>,
    has_source_rows: bool,
    /// Parameters that the texts mention.
    numbers: Arc<ParameterNumbers>,
}

impl ExplainDialog {
    /// Opens the dialog with the explanation of a subject.
    pub fn for_subject(subject: Subject, numbers: Arc<ParameterNumbers>) -> ExplainDialog {
        ExplainDialog {
            pages: vec![ExplanationPage::from_subject(subject, &numbers)],
            has_source_rows: false,
            numbers,
        }
    }

    /// Opens the dialog with the explanation of the figure that is selected on a screen.
    pub fn for_figure(figure: &Figure, numbers: Arc<ParameterNumbers>) -> ExplainDialog {
        let mut page = match novamind_glossary::subject_by_name(figure.term) {
            Some(subject) => ExplanationPage::from_subject(subject, &numbers),
            None => ExplanationPage {
                term: figure.term.to_owned(),
                title: String::new(),
                note: String::new(),
                parts: Vec::new(),
                links: Vec::new(),
                selected: 0,
            },
        };
        if figure.title.width() > MAX_FIGURE_TITLE && !page.title.is_empty() {
            page.parts.insert(0, ("selected".to_owned(), format!("{}.", figure.title)));
        } else if !page.title.eq_ignore_ascii_case(&figure.title) {
            let note = [page.title.as_str(), page.note.as_str()];
            page.note = note.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" · ");
            page.title.clone_from(&figure.title);
        }
        if let Some(sql) = &figure.sql {
            page.parts.push(("source rows".to_owned(), sql.trim().to_owned()));
        }
        ExplainDialog { pages: vec![page], has_source_rows: figure.sql.is_some(), numbers }
    }

    /// Opens the dialog with the explanation of a screen and a list of its terms.
    pub fn for_screen(screen: ScreenId, numbers: Arc<ParameterNumbers>) -> ExplainDialog {
        let entry = screen.action().entry();
        let help = "Select a figure or field to see its explanation, or choose a term of this screen.";
        let page = ExplanationPage {
            term: entry.name.to_owned(),
            title: entry.title.to_owned(),
            note: "screen".to_owned(),
            parts: vec![(String::new(), entry.doc.to_owned()), (String::new(), help.to_owned())],
            links: novamind_glossary::terms_shown_on(entry.name)
                .map(Subject::Term)
                .map(Link::Subject)
                .collect(),
            selected: 0,
        };
        ExplainDialog { pages: vec![page], has_source_rows: false, numbers }
    }

    fn page(&self) -> &ExplanationPage {
        self.pages.last().expect("there is a first page")
    }

    fn follow_link(&mut self) -> DialogResponse {
        let page = self.page();
        match page.links.get(page.selected) {
            Some(Link::Subject(subject)) => {
                let next = ExplanationPage::from_subject(*subject, &self.numbers);
                self.pages.push(next);
            }
            Some(Link::Screen(action)) => {
                return DialogResponse::confirm_with(vec![Effect::Execute(*action)]);
            }
            None => return DialogResponse::close(),
        }
        DialogResponse::stay()
    }

    fn select(&mut self, to: impl Fn(usize, usize) -> usize) {
        if let Some(page) = self.pages.last_mut() {
            let last = page.links.len().saturating_sub(1);
            page.selected = to(page.selected, last).min(last);
        }
    }

    fn key_hints(&self, context: &ScreenContext<'_>) -> String {
        let mut keys = vec![context.hint(Action::Open)];
        if self.pages.len() > 1 {
            keys.push(context.hint(Action::Back));
        } else if self.has_source_rows {
            keys.push(context.hint(Action::Rows));
        }
        keys.push(context.hint(Action::Close));
        keys.join(" · ")
    }
}

impl Dialog for ExplainDialog {
    fn record_name(&self) -> String {
        "explanation".to_owned()
    }

    fn term(&self) -> Option<String> {
        Some(self.page().term.clone())
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::List, Scope::Dialog, Scope::Global]
    }

    fn hints(&self) -> Vec<Action> {
        let first = if self.pages.len() > 1 { Action::Back } else { Action::Glossary };
        vec![Action::Open, first, Action::Close]
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        let page = context.page_rows.max(1) as usize;
        match action {
            Action::Open => return self.follow_link(),
            Action::Back | Action::Left if self.pages.len() > 1 => {
                self.pages.pop();
            }
            Action::Back | Action::Close | Action::Cancel | Action::Explain => {
                return DialogResponse::close();
            }
            Action::Glossary => return DialogResponse::confirm_with(vec![Effect::Execute(Action::Glossary)]),
            Action::Rows if self.has_source_rows && self.pages.len() == 1 => {
                return DialogResponse::confirm_with(vec![Effect::Execute(Action::Rows)]);
            }
            Action::Up | Action::ScrollUp => self.select(|at, _| at.saturating_sub(1)),
            Action::Down | Action::ScrollDown => self.select(|at, _| at + 1),
            Action::PageUp => self.select(|at, _| at.saturating_sub(page)),
            Action::PageDown => self.select(|at, _| at + page),
            Action::First => self.select(|_, _| 0),
            Action::Last => self.select(|_, last| last),
            _ => {}
        }
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        self.select(|_, _| row);
        self.follow_link()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let page = self.page();
        let width = area.width.saturating_sub(4).min(100);
        let text = page_lines(page, width.saturating_sub(4) as usize);
        // The text takes precedence over the links. At least three links stay visible, and the list of links scrolls.
        let links = (page.links.len() as u16).min(10);
        let min = links.min(3) + u16::from(links > 0);
        let room = area.height.saturating_sub(2);
        let for_text = (text.len() as u16).min(room.saturating_sub(min));
        let for_links = (links + u16::from(links > 0)).min(room - for_text);
        // The chart of the term is drawn in the remaining rows.
        let for_picture = match (room - for_text - for_links).min(glossary_picture::MAX_ROWS) {
            rows if rows >= glossary_picture::MIN_ROWS && glossary_picture::has_picture(&page.term) => rows,
            _ => 0,
        };
        let dialog_area = centered_rect(area, width, for_text + for_picture + for_links + 2);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, &page.title, &page.note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let above = Rect { height: for_text.min(inside.height), ..inside };
        for (row, (heading, words)) in row_rects(above).zip(&text) {
            let line = Line::from(vec![
                canvas.span(heading.as_str(), Role::Dim),
                canvas.span(words.as_str(), Role::Text),
            ]);
            canvas.draw_line(row, &line);
        }
        let picture =
            Rect { y: above.bottom(), height: for_picture.min(inside.height - above.height), ..inside };
        glossary_picture::draw(canvas, picture, &page.term, context.company);
        let below = Rect { y: picture.bottom(), height: inside.bottom() - picture.bottom(), ..inside };
        self.draw_links(canvas, below, context);
        canvas.draw_pane_keys(dialog_area, &self.key_hints(context));
    }
}

impl ExplainDialog {
    fn draw_links(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let page = self.page();
        if page.links.is_empty() || area.height < 2 {
            return;
        }
        let place = format!("{} of {}", page.selected + 1, page.links.len());
        canvas.draw_text(area, &format!("see also · {place}"), Role::Header);
        let list = Rect { y: area.y + 1, height: area.height - 1, ..area };
        let from = canvas.scroll_to_row(list, page.selected, page.links.len());
        for (row, (at, link)) in row_rects(list).zip(page.links.iter().enumerate().skip(from)) {
            let role = |other| if at == page.selected { Role::Selection } else { other };
            if at == page.selected {
                canvas.clear(row, Role::Selection);
            }
            let (title, kind) = link.title(context);
            canvas.draw_text(Rect { width: 9.min(row.width), ..row }, kind, role(Role::Dim));
            let place = Rect { x: row.x + 10, width: row.width.saturating_sub(10), ..row };
            canvas.draw_text(place, &title, role(Role::Text));
            canvas.register_click(row, Click::Row(0, at));
        }
    }
}

fn page_lines(page: &ExplanationPage, width: usize) -> Vec<(String, String)> {
    let column = page.parts.iter().map(|(heading, _)| heading.chars().count()).max().unwrap_or(0);
    let column = if column > 0 { column + 2 } else { 0 };
    let mut lines = Vec::new();
    for (heading, text) in &page.parts {
        // A section without a heading is the summary, which uses the full width.
        let (left, room) =
            if heading.is_empty() { (0, width) } else { (column, width.saturating_sub(column)) };
        for (at, line) in wrap(text, room).into_iter().enumerate() {
            let word = if at == 0 { heading.as_str() } else { "" };
            lines.push((format!("{word:<left$}"), line));
        }
        if heading.is_empty() {
            lines.push((String::new(), String::new()));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{dialog_action, dialog_text, new_company};

    fn figure(term: &'static str, sql: Option<&str>) -> Figure {
        Figure {
            title: "cancellations of S1".to_owned(),
            term,
            sql: sql.map(str::to_owned),
            week_quantity: None,
        }
    }

    #[test]
    fn glossary_places_name_actions() {
        for term in novamind_glossary::terms() {
            for name in &term.places {
                assert!(Action::by_name(Scope::Global, name).is_some(), "{} is at {name}", term.id);
            }
        }
        for screen in ScreenId::ALL {
            assert!(
                novamind_glossary::terms_shown_on(screen.record_name()).count() >= 2,
                "{screen:?} has no terms"
            );
        }
    }

    #[test]
    fn figure_explanation_links_to_rows_and_related_terms() {
        let company = new_company();
        let mut dialog =
            ExplainDialog::for_figure(&figure("churn", Some("SELECT 1")), ParameterNumbers::bundled().into());
        let shown = dialog_text(&dialog, &company, 80, 21);
        for part in [
            "cancellations of S1",
            "Churn · customers",
            "The share of subscribers that cancel in a period.",
            "SELECT 1",
            "see also · 1 of",
        ] {
            assert!(shown.contains(part), "{part} is missing in\n{shown}");
        }
        assert!(!dialog_action(&mut dialog, Action::Open, &company).closes);
        let second = dialog_text(&dialog, &company, 80, 21);
        assert!(second.contains("Billing day") && !second.contains("SELECT 1"), "{second}");
        assert!(!dialog_action(&mut dialog, Action::Back, &company).closes);
        assert_eq!(dialog_text(&dialog, &company, 80, 21), shown);
        let rows = dialog_action(&mut dialog, Action::Rows, &company);
        assert!(rows.closes && matches!(rows.effects[..], [Effect::Execute(Action::Rows)]));
        assert!(dialog_action(&mut dialog, Action::Back, &company).closes);
    }

    #[test]
    fn long_description_of_a_figure_is_a_part_of_the_explanation() {
        let title =
            "12 enterprises wait for an answer (356 seats, $43,818 a month at requested prices)".to_owned();
        let long = Figure { title, ..figure("thread", None) };
        let dialog = ExplainDialog::for_figure(&long, ParameterNumbers::bundled().into());
        let shown = dialog_text(&dialog, &new_company(), 60, 13);
        assert!(!shown.lines().next().expect("a title").contains('…'), "{shown}");
        let words = shown.replace(['┃', '↓', '\n'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(
            words.contains("wait for an answer (356 seats, $43,818 a month at requested prices)."),
            "{shown}"
        );
    }

    #[test]
    fn last_links_of_a_term_open_its_screens() {
        let company = new_company();
        let mut dialog =
            ExplainDialog::for_figure(&figure("runway", None), ParameterNumbers::bundled().into());
        dialog_action(&mut dialog, Action::Last, &company);
        let outcome = dialog_action(&mut dialog, Action::Open, &company);
        assert!(outcome.closes && matches!(outcome.effects[..], [Effect::Execute(Action::Cash)]));
    }

    #[test]
    fn screen_explanations_list_the_terms_of_the_screen() {
        let company = new_company();
        let shown = dialog_text(
            &ExplainDialog::for_screen(ScreenId::Inbox, ParameterNumbers::bundled().into()),
            &company,
            80,
            21,
        );
        assert!(shown.contains("Negotiate with enterprises.") && shown.contains("Enterprise"), "{shown}");
        let mut odd =
            ExplainDialog::for_figure(&figure("no-such-term", None), ParameterNumbers::bundled().into());
        let shown = dialog_text(&odd, &company, 80, 21);
        assert!(shown.contains("cancellations of S1"), "{shown}");
        assert!(dialog_action(&mut odd, Action::Open, &company).closes);
    }

    #[test]
    fn every_term_is_drawn_at_every_size() {
        let company = new_company();
        for (at, term) in novamind_glossary::terms().iter().enumerate() {
            let sizes =
                if at % 9 == 0 { &[(60, 13), (0, 0), (3, 2), (80, 21), (200, 57)][..] } else { &[(60, 13)] };
            let dialog = ExplainDialog::for_subject(Subject::Term(term), ParameterNumbers::bundled().into());
            for &(width, height) in sizes {
                let shown = dialog_text(&dialog, &company, width, height);
                assert!(width < 60 || shown.contains(&term.title), "{}: {shown}", term.id);
            }
        }
    }
}
