//! Explanations of figures, fields and screens, with source rows and links to related terms.

use std::sync::Arc;

use ratatui::layout::Rect;
use ratatui::text::Line;

use super::{Dialog, Outcome, term_picture};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look, ScreenId};
use crate::effect::Effect;
use novamind_glossary::{Explanation, Subject};
use novamind_tools::Numbers;
use novamind_tui::canvas::{Canvas, Click, centered, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::table::first_row;

#[derive(Debug, Clone, Copy)]
enum Link {
    To(Subject),
    Place(Action),
}

impl Link {
    fn title(self, look: &Look<'_>) -> (String, &'static str) {
        match self {
            Link::To(subject) => (subject.title(), subject.kind()),
            Link::Place(action) => {
                let key = look.keys.label(action).map_or(String::new(), |key| format!(" ({key})"));
                (format!("{}{key}", action.entry().title), "go to")
            }
        }
    }
}

struct OpenPage {
    /// The explained term, as named by the glossary, a tool or a table.
    term: String,
    title: String,
    note: String,
    /// Heading and text of each section.
    parts: Vec<(String, String)>,
    links: Vec<Link>,
    selected: usize,
}

impl OpenPage {
    fn of(subject: Subject, numbers: &Numbers) -> OpenPage {
        let told = Explanation::of(subject, numbers);
        let places = told.places.iter().filter_map(|name| Action::named(Scope::Global, name));
        OpenPage {
            term: subject.name(),
            title: told.title,
            note: told.note,
            parts: told.sections.into_iter().map(|own| (own.name.to_owned(), own.text)).collect(),
            links: told.related.iter().copied().map(Link::To).chain(places.map(Link::Place)).collect(),
            selected: 0,
        }
    }
}

/// The explanation dialog.
pub struct Explain {
    /// The current page, and those before it.
    pages: Vec<OpenPage>,
    rows: bool,
    /// Parameters that the texts mention.
    numbers: Arc<Numbers>,
}

impl Explain {
    /// Explains a subject.
    pub fn subject(subject: Subject, numbers: Arc<Numbers>) -> Explain {
        Explain { pages: vec![OpenPage::of(subject, &numbers)], rows: false, numbers }
    }

    /// Explains the figure that is selected on a screen.
    pub fn figure(figure: &Figure, numbers: Arc<Numbers>) -> Explain {
        let mut page = match novamind_glossary::subject(figure.term) {
            Some(subject) => OpenPage::of(subject, &numbers),
            None => OpenPage {
                term: figure.term.to_owned(),
                title: String::new(),
                note: String::new(),
                parts: Vec::new(),
                links: Vec::new(),
                selected: 0,
            },
        };
        if !page.title.eq_ignore_ascii_case(&figure.title) {
            let note = [page.title.as_str(), page.note.as_str()];
            page.note = note.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" · ");
            page.title.clone_from(&figure.title);
        }
        if let Some(sql) = &figure.sql {
            page.parts.push(("source rows".to_owned(), sql.trim().to_owned()));
        }
        Explain { pages: vec![page], rows: figure.sql.is_some(), numbers }
    }

    /// Explains a screen and lists its terms.
    pub fn screen(screen: ScreenId, numbers: Arc<Numbers>) -> Explain {
        let entry = screen.action().entry();
        let help = "Select a figure or field to explain it, or choose a term of this screen.";
        let page = OpenPage {
            term: entry.name.to_owned(),
            title: entry.title.to_owned(),
            note: "screen".to_owned(),
            parts: vec![(String::new(), entry.doc.to_owned()), (String::new(), help.to_owned())],
            links: novamind_glossary::terms_of(entry.name).map(Subject::Term).map(Link::To).collect(),
            selected: 0,
        };
        Explain { pages: vec![page], rows: false, numbers }
    }

    fn page(&self) -> &OpenPage {
        self.pages.last().expect("there is a first page")
    }

    fn follow(&mut self) -> Outcome {
        let page = self.page();
        match page.links.get(page.selected) {
            Some(Link::To(subject)) => {
                let next = OpenPage::of(*subject, &self.numbers);
                self.pages.push(next);
            }
            Some(Link::Place(action)) => return Outcome::close_with(vec![Effect::Do(*action)]),
            None => return Outcome::close(),
        }
        Outcome::stay()
    }

    fn select(&mut self, to: impl Fn(usize, usize) -> usize) {
        if let Some(page) = self.pages.last_mut() {
            let last = page.links.len().saturating_sub(1);
            page.selected = to(page.selected, last).min(last);
        }
    }

    fn keys(&self, look: &Look<'_>) -> String {
        let mut keys = vec![look.hint(Action::Open)];
        if self.pages.len() > 1 {
            keys.push(look.hint(Action::Back));
        } else if self.rows {
            keys.push(look.hint(Action::Rows));
        }
        keys.push(look.hint(Action::Close));
        keys.join(" · ")
    }
}

impl Dialog for Explain {
    fn what(&self) -> String {
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

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        let page = look.page.max(1) as usize;
        match action {
            Action::Open => return self.follow(),
            Action::Back | Action::Left if self.pages.len() > 1 => {
                self.pages.pop();
            }
            Action::Back | Action::Close | Action::Cancel | Action::Explain => return Outcome::close(),
            Action::Glossary => return Outcome::close_with(vec![Effect::Do(Action::Glossary)]),
            Action::Rows if self.rows && self.pages.len() == 1 => {
                return Outcome::close_with(vec![Effect::Do(Action::Rows)]);
            }
            Action::Up | Action::ScrollUp => self.select(|at, _| at.saturating_sub(1)),
            Action::Down | Action::ScrollDown => self.select(|at, _| at + 1),
            Action::PageUp => self.select(|at, _| at.saturating_sub(page)),
            Action::PageDown => self.select(|at, _| at + page),
            Action::First => self.select(|_, _| 0),
            Action::Last => self.select(|_, last| last),
            _ => {}
        }
        Outcome::stay()
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        self.select(|_, _| row);
        self.follow()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let page = self.page();
        let width = area.width.saturating_sub(4).min(100);
        let text = lines_of(page, width.saturating_sub(4) as usize);
        // Text takes precedence over links: at least three links stay visible, the rest scrolls.
        let links = (page.links.len() as u16).min(10);
        let least = links.min(3) + u16::from(links > 0);
        let room = area.height.saturating_sub(2);
        let for_text = (text.len() as u16).min(room.saturating_sub(least));
        let for_links = (links + u16::from(links > 0)).min(room - for_text);
        // A picture takes the remaining rows.
        let for_picture = match (room - for_text - for_links).min(term_picture::MOST_ROWS) {
            rows if rows >= term_picture::LEAST_ROWS && term_picture::has_picture(&page.term) => rows,
            _ => 0,
        };
        let own = centered(area, width, for_text + for_picture + for_links + 2);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, &page.title, &page.note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let above = Rect { height: for_text.min(inside.height), ..inside };
        for (row, (heading, words)) in rows_of(above).zip(&text) {
            let line = Line::from(vec![
                canvas.span(heading.as_str(), Role::Dim),
                canvas.span(words.as_str(), Role::Text),
            ]);
            canvas.line(row, &line);
        }
        let picture =
            Rect { y: above.bottom(), height: for_picture.min(inside.height - above.height), ..inside };
        term_picture::draw(canvas, picture, &page.term, look.company);
        let below = Rect { y: picture.bottom(), height: inside.bottom() - picture.bottom(), ..inside };
        self.draw_links(canvas, below, look);
        canvas.pane_keys(own, &self.keys(look));
    }
}

impl Explain {
    fn draw_links(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let page = self.page();
        if page.links.is_empty() || area.height < 2 {
            return;
        }
        let place = format!("{} of {}", page.selected + 1, page.links.len());
        canvas.text(area, &format!("see also · {place}"), Role::Header);
        let list = Rect { y: area.y + 1, height: area.height - 1, ..area };
        let from = first_row(page.selected, list.height as usize, page.links.len());
        for (row, (at, link)) in rows_of(list).zip(page.links.iter().enumerate().skip(from)) {
            let role = |other| if at == page.selected { Role::Selection } else { other };
            if at == page.selected {
                canvas.clear(row, Role::Selection);
            }
            let (title, kind) = link.title(look);
            canvas.text(Rect { width: 9.min(row.width), ..row }, kind, role(Role::Dim));
            let place = Rect { x: row.x + 10, width: row.width.saturating_sub(10), ..row };
            canvas.text(place, &title, role(Role::Text));
            canvas.click(row, Click::Row(0, at));
        }
    }
}

fn lines_of(page: &OpenPage, width: usize) -> Vec<(String, String)> {
    let column = page.parts.iter().map(|(heading, _)| heading.chars().count()).max().unwrap_or(0);
    let column = if column > 0 { column + 2 } else { 0 };
    let mut lines = Vec::new();
    for (heading, text) in &page.parts {
        // A section without a heading is the summary and takes the full width.
        let (left, room) =
            if heading.is_empty() { (0, width) } else { (column, width.saturating_sub(column)) };
        for (at, line) in wrapped(text, room).into_iter().enumerate() {
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
    use crate::test_kit::{company, dialog_picture, in_dialog};

    fn figure(term: &'static str, sql: Option<&str>) -> Figure {
        Figure { title: "cancellations of S1".to_owned(), term, sql: sql.map(str::to_owned), why: None }
    }

    #[test]
    fn every_place_of_the_glossary_is_an_action() {
        for term in novamind_glossary::terms() {
            for name in &term.places {
                assert!(Action::named(Scope::Global, name).is_some(), "{} is at {name}", term.id);
            }
        }
        for screen in ScreenId::ALL {
            assert!(novamind_glossary::terms_of(screen.id()).count() >= 2, "{screen:?} has no terms");
        }
    }

    #[test]
    fn a_figure_is_explained_with_its_rows_and_leads_on_and_back() {
        let company = company();
        let mut dialog = Explain::figure(&figure("churn", Some("SELECT 1")), Numbers::shipped().into());
        let shown = dialog_picture(&dialog, &company, 80, 21);
        for part in [
            "cancellations of S1",
            "Churn · customers",
            "The loss of subscribers.",
            "SELECT 1",
            "see also · 1 of",
        ] {
            assert!(shown.contains(part), "{part} is missing in\n{shown}");
        }
        assert!(!in_dialog(&mut dialog, Action::Open, &company).close);
        let second = dialog_picture(&dialog, &company, 80, 21);
        assert!(second.contains("Billing day") && !second.contains("SELECT 1"), "{second}");
        assert!(!in_dialog(&mut dialog, Action::Back, &company).close);
        assert_eq!(dialog_picture(&dialog, &company, 80, 21), shown);
        let rows = in_dialog(&mut dialog, Action::Rows, &company);
        assert!(rows.close && matches!(rows.effects[..], [Effect::Do(Action::Rows)]));
        assert!(in_dialog(&mut dialog, Action::Back, &company).close);
    }

    #[test]
    fn the_last_links_go_to_the_places_of_a_term() {
        let company = company();
        let mut dialog = Explain::figure(&figure("runway", None), Numbers::shipped().into());
        in_dialog(&mut dialog, Action::Last, &company);
        let outcome = in_dialog(&mut dialog, Action::Open, &company);
        assert!(outcome.close && matches!(outcome.effects[..], [Effect::Do(Action::Cash)]));
    }

    #[test]
    fn a_screen_lists_its_terms_and_an_unknown_term_says_what_it_can() {
        let company = company();
        let shown =
            dialog_picture(&Explain::screen(ScreenId::Inbox, Numbers::shipped().into()), &company, 80, 21);
        assert!(shown.contains("Negotiate with enterprises.") && shown.contains("Enterprise"), "{shown}");
        let mut odd = Explain::figure(&figure("no-such-term", None), Numbers::shipped().into());
        let shown = dialog_picture(&odd, &company, 80, 21);
        assert!(shown.contains("cancellations of S1"), "{shown}");
        assert!(in_dialog(&mut odd, Action::Open, &company).close);
    }

    #[test]
    fn every_term_fits_every_window() {
        let company = company();
        for (at, term) in novamind_glossary::terms().iter().enumerate() {
            let sizes =
                if at % 9 == 0 { &[(60, 13), (0, 0), (3, 2), (80, 21), (200, 57)][..] } else { &[(60, 13)] };
            let dialog = Explain::subject(Subject::Term(term), Numbers::shipped().into());
            for &(width, height) in sizes {
                let shown = dialog_picture(&dialog, &company, width, height);
                assert!(width < 60 || shown.contains(&term.title), "{}: {shown}", term.id);
            }
        }
    }
}
