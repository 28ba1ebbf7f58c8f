//! Panes of the x-ray: views, choices and results.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::typing::Expected;
use super::view::{Choices, View};
use super::{Xray, XrayPane, lines};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::capital;
use novamind_insight::LeadFactor;
use novamind_tui::canvas::{Canvas, rows_of};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;
use novamind_worker::look_inside::LookQuestion;

pub struct ViewsPane;

/// Groups, components or breakpoints of the view.
pub struct ChoicesPane;

pub struct SeenPane;

fn scopes_of_list(table: Option<&Table>) -> Vec<Scope> {
    match table {
        Some(table) if table.is_typing() => vec![Scope::Field, Scope::List],
        _ => vec![Scope::Xray, Scope::List],
    }
}

fn keys_of(view: View) -> &'static [Action] {
    match view {
        View::Leads => &[
            Action::Left,
            Action::Right,
            Action::HoldFactor,
            Action::TypeChoice,
            Action::SeekDay,
            Action::AskWords,
        ],
        View::Streams => &[Action::TypeChoice, Action::AskWords],
        View::Words => &[Action::AskWords],
        View::Breakpoints => &[
            Action::TypeChoice,
            Action::RunDays,
            Action::LookBack,
            Action::RemoveBreakpoint,
            Action::AskWords,
        ],
        _ if view.choices() == Choices::Nothing && view != View::Customer => {
            &[Action::Left, Action::Right, Action::DayWeekBefore, Action::SeekDay, Action::AskWords]
        }
        _ => &[Action::Left, Action::Right, Action::TypeChoice, Action::SeekDay, Action::AskWords],
    }
}

fn figure_of(xray: &Xray) -> Option<Figure> {
    let view = xray.view();
    xray.is_open.then(|| Figure { title: view.title().to_owned(), term: view.term(), sql: None, why: None })
}

impl Pane<Xray> for ViewsPane {
    fn table<'a>(&self, xray: &'a Xray) -> Option<&'a Table> {
        Some(&xray.views)
    }

    fn scopes(&self, xray: &Xray) -> Vec<Scope> {
        scopes_of_list(Some(&xray.views))
    }

    fn hints(&self, xray: &Xray) -> Vec<Action> {
        keys_of(xray.view()).to_vec()
    }

    fn figure(&self, xray: &Xray, _: &Look<'_>) -> Option<Figure> {
        figure_of(xray)
    }

    fn act(&self, xray: &mut Xray, action: Action, look: &Look<'_>) -> Vec<Effect> {
        match action {
            Action::Open => {
                let is_empty = match xray.view() {
                    View::Customer => xray.customer.is_none(),
                    View::Words => xray.said.is_none(),
                    _ => false,
                };
                match is_empty {
                    true => return xray.type_in(Expected::in_view(xray.view())),
                    false => xray.focus = XrayPane::Seen,
                }
            }
            Action::Sort | Action::Filter => {}
            action => {
                let before = xray.view();
                xray.views.act(action, look.page);
                if xray.view() != before {
                    xray.begin_view();
                }
            }
        }
        xray.ask()
    }

    fn click(&self, xray: &mut Xray, row: usize, _: &Look<'_>) -> Vec<Effect> {
        xray.views.select_place(row);
        xray.begin_view();
        xray.ask()
    }

    fn border(&self, _: &Xray, _: Rect, _: &Look<'_>) -> Border {
        Border { title: "Views".to_owned(), ..Border::default() }
    }

    fn draw(&self, xray: &Xray, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        xray.views.draw(canvas, seat.area, seat.focused, seat.number);
    }
}

impl Pane<Xray> for ChoicesPane {
    fn table<'a>(&self, xray: &'a Xray) -> Option<&'a Table> {
        xray.choices()
    }

    fn table_mut<'a>(&self, xray: &'a mut Xray) -> Option<&'a mut Table> {
        xray.choices_mut()
    }

    fn scopes(&self, xray: &Xray) -> Vec<Scope> {
        scopes_of_list(xray.choices())
    }

    fn hints(&self, xray: &Xray) -> Vec<Action> {
        let filter = xray.view().choices() != Choices::Breakpoints;
        keys_of(xray.view()).iter().copied().chain(filter.then_some(Action::Filter)).collect()
    }

    fn figure(&self, xray: &Xray, _: &Look<'_>) -> Option<Figure> {
        figure_of(xray)
    }

    fn act(&self, xray: &mut Xray, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let is_filtered = xray.choices().is_some_and(Table::is_filtered);
        match action {
            Action::Open => xray.focus = XrayPane::Seen,
            Action::Close if !is_filtered => xray.focus = XrayPane::Views,
            Action::Sort => {}
            action => {
                if let Some(table) = xray.choices_mut() {
                    table.act(action, look.page);
                }
            }
        }
        xray.ask()
    }

    fn click(&self, xray: &mut Xray, row: usize, _: &Look<'_>) -> Vec<Effect> {
        if let Some(table) = xray.choices_mut() {
            table.select_place(row);
        }
        xray.ask()
    }

    fn border(&self, xray: &Xray, _: Rect, _: &Look<'_>) -> Border {
        Border { title: xray.view().choices().title().to_owned(), ..Border::default() }
    }

    fn draw(&self, xray: &Xray, canvas: &mut Canvas<'_>, seat: Seat, _: &Look<'_>) {
        if let Some(table) = xray.choices() {
            table.draw(canvas, seat.area, seat.focused, seat.number);
        }
    }
}

impl Pane<Xray> for SeenPane {
    fn scopes(&self, xray: &Xray) -> Vec<Scope> {
        match (xray.is_open, &xray.typing) {
            (false, _) => vec![Scope::List],
            (true, Some(_)) => vec![Scope::Field],
            (true, None) => vec![Scope::Xray, Scope::List],
        }
    }

    fn hints(&self, xray: &Xray) -> Vec<Action> {
        match (xray.is_open, &xray.typing) {
            (false, _) => Vec::new(),
            (true, Some(_)) => vec![Action::Commit, Action::Discard],
            (true, None) => keys_of(xray.view()).to_vec(),
        }
    }

    fn figure(&self, xray: &Xray, _: &Look<'_>) -> Option<Figure> {
        figure_of(xray)
    }

    fn act(&self, xray: &mut Xray, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let moves_cursor = xray.view() == View::Leads;
        match action {
            Action::Commit | Action::CommitDown => return xray.commit(),
            Action::Discard => (xray.typing, xray.problem) = (None, None),
            Action::Open if matches!(xray.view(), View::Customer | View::Breakpoints | View::Words) => {
                return xray.type_in(Expected::in_view(xray.view()));
            }
            Action::Close => xray.focus = XrayPane::Views,
            Action::Up if moves_cursor => xray.factor = xray.factor.saturating_sub(1),
            Action::Down if moves_cursor => {
                xray.factor = (xray.factor + 1).min(LeadFactor::ALL.len() - 1);
            }
            action => drop(xray.scroll.act(action, look.page.into())),
        }
        Vec::new()
    }

    fn key(&self, xray: &mut Xray, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        xray.problem = None;
        if let Some(typing) = &mut xray.typing {
            typing.field.key(key);
        }
        Vec::new()
    }

    fn paste(&self, xray: &mut Xray, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if let Some(typing) = &mut xray.typing {
            typing.field.insert(text.trim());
        }
        Vec::new()
    }

    fn border(&self, xray: &Xray, _: Rect, look: &Look<'_>) -> Border {
        if !xray.is_open {
            return Border { title: "X-ray".to_owned(), ..Border::default() };
        }
        let view = xray.view();
        let title = match (view, view.choices()) {
            (View::Customer, _) => xray.customer.map_or(String::new(), |own| format!(" {own}")),
            (View::Words, _) => match (xray.words_asked(), xray.said.as_ref().map(|said| &said.question)) {
                (Some(words), _) => format!(": {words}"),
                (None, Some(LookQuestion::Words(words, _))) => format!(": {words}"),
                _ => String::new(),
            },
            (_, Choices::Groups) => xray.group().map_or(String::new(), |own| format!(" of {own}")),
            (_, Choices::Parts) => xray.part().map_or(String::new(), |own| format!(" of {}", own.id())),
            _ => String::new(),
        };
        let note = match (xray.asked.is_waiting(), view.has_day()) {
            (true, _) => "re-simulating …".to_owned(),
            (false, true) => format!("day {} of {}", xray.day_seen(), xray.last_day),
            (false, false) => format!("after day {}", xray.last_day),
        };
        let label = |action| look.keys.label(action).unwrap_or_default();
        let days = format!(
            "{} {} day · {} {} week",
            label(Action::Left),
            label(Action::Right),
            label(Action::DayWeekBefore),
            label(Action::DayWeekAfter)
        );
        let others: Vec<Action> = keys_of(view)
            .iter()
            .copied()
            .filter(|action| !matches!(action, Action::Left | Action::Right | Action::DayWeekBefore))
            .collect();
        let others = look.hints(&others);
        let keys = match (view.has_day(), others.is_empty()) {
            (true, true) => days,
            (true, false) => format!("{days} · {others}"),
            (false, _) => others,
        };
        Border { title: format!("{}{title}", capital(view.title())), note, keys, keys_always: true }
    }

    fn draw(&self, xray: &Xray, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let below = u16::from(xray.typing.is_some()) + u16::from(xray.problem.is_some());
        let below = below.min(seat.area.height);
        let area = Rect { height: seat.area.height - below, ..seat.area };
        lines::draw(xray, canvas, Seat { area, ..seat }, look);
        let mut rows = rows_of(Rect { y: area.bottom(), height: below, ..seat.area });
        if let (Some(problem), Some(row)) = (&xray.problem, rows.next()) {
            canvas.text(row, problem, Role::Bad);
        }
        if let (Some(typing), Some(row)) = (&xray.typing, rows.next()) {
            let prompt = typing.expected.prompt();
            let before = (prompt.len() as u16 + 1).min(row.width);
            canvas.text(row, prompt, Role::Key);
            typing.field.draw(canvas, Rect { x: row.x + before, width: row.width - before, ..row });
        }
    }
}
