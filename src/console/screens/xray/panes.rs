//! Panes of the x-ray screen: views, choices and results.

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use super::input::InputKind;
use super::view::{ViewChoices, XrayView};
use super::{Xray, XrayPane, inspection_text};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::capitalize;
use novamind_insight::LeadFactor;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::theme::Role;
use novamind_tui::widgets::Table;
use novamind_worker::inspection::InspectionQuestion;

pub struct ViewsPane;

/// Pane with the groups, components or breakpoints that the view can show.
pub struct ChoicesPane;

pub struct InspectionPane;

fn list_scopes(table: Option<&Table>) -> Vec<Scope> {
    match table {
        Some(table) if table.is_filter_open() => vec![Scope::Field, Scope::List],
        _ => vec![Scope::Xray, Scope::List],
    }
}

fn view_actions(view: XrayView) -> &'static [Action] {
    match view {
        XrayView::Leads => &[
            Action::Left,
            Action::Right,
            Action::HoldFactor,
            Action::TypeTarget,
            Action::SeekDay,
            Action::TypeCommand,
        ],
        XrayView::Draws => &[Action::TypeTarget, Action::TypeCommand],
        XrayView::Commands => &[Action::TypeCommand],
        XrayView::Breakpoints => &[
            Action::TypeTarget,
            Action::RunDays,
            Action::BreakpointHistory,
            Action::RemoveBreakpoint,
            Action::TypeCommand,
        ],
        _ if view.choices() == ViewChoices::Nothing && view != XrayView::Customer => {
            &[Action::Left, Action::Right, Action::DayWeekBefore, Action::SeekDay, Action::TypeCommand]
        }
        _ => &[Action::Left, Action::Right, Action::TypeTarget, Action::SeekDay, Action::TypeCommand],
    }
}

fn view_figure(xray: &Xray) -> Option<Figure> {
    let view = xray.view();
    xray.can_inspect.then(|| Figure { title: view.title().to_owned(), term: view.term(), sql: None, week_quantity: None })
}

impl Pane<Xray> for ViewsPane {
    fn table<'a>(&self, xray: &'a Xray) -> Option<&'a Table> {
        Some(&xray.views)
    }

    fn scopes(&self, xray: &Xray) -> Vec<Scope> {
        list_scopes(Some(&xray.views))
    }

    fn hints(&self, xray: &Xray) -> Vec<Action> {
        view_actions(xray.view()).to_vec()
    }

    fn figure(&self, xray: &Xray, _: &ScreenContext<'_>) -> Option<Figure> {
        view_figure(xray)
    }

    fn handle_action(&self, xray: &mut Xray, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        match action {
            Action::Open => {
                let is_empty = match xray.view() {
                    XrayView::Customer => xray.customer.is_none(),
                    XrayView::Commands => xray.command_output.is_none(),
                    _ => false,
                };
                match is_empty {
                    true => return xray.start_input(InputKind::for_view(xray.view())),
                    false => xray.focus = XrayPane::Inspection,
                }
            }
            Action::Sort | Action::Filter => {}
            action => {
                let before = xray.view();
                xray.views.handle_action(action, context.page_rows);
                if xray.view() != before {
                    xray.reset_view();
                }
            }
        }
        xray.request_inspection()
    }

    fn handle_click(&self, xray: &mut Xray, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        xray.views.select_visible_row(row);
        xray.reset_view();
        xray.request_inspection()
    }

    fn border(&self, _: &Xray, _: Rect, _: &ScreenContext<'_>) -> PaneBorder {
        PaneBorder { title: "Views".to_owned(), ..PaneBorder::default() }
    }

    fn draw(&self, xray: &Xray, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        xray.views.draw(canvas, placement.area, placement.focused, placement.index);
    }
}

impl Pane<Xray> for ChoicesPane {
    fn table<'a>(&self, xray: &'a Xray) -> Option<&'a Table> {
        xray.choice_table()
    }

    fn table_mut<'a>(&self, xray: &'a mut Xray) -> Option<&'a mut Table> {
        xray.choice_table_mut()
    }

    fn scopes(&self, xray: &Xray) -> Vec<Scope> {
        list_scopes(xray.choice_table())
    }

    fn hints(&self, xray: &Xray) -> Vec<Action> {
        let filter = xray.view().choices() != ViewChoices::Breakpoints;
        view_actions(xray.view()).iter().copied().chain(filter.then_some(Action::Filter)).collect()
    }

    fn figure(&self, xray: &Xray, _: &ScreenContext<'_>) -> Option<Figure> {
        view_figure(xray)
    }

    fn handle_action(&self, xray: &mut Xray, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let is_filtered = xray.choice_table().is_some_and(Table::is_filtered);
        match action {
            Action::Open => xray.focus = XrayPane::Inspection,
            Action::Close if !is_filtered => xray.focus = XrayPane::Views,
            Action::Sort => {}
            action => {
                if let Some(table) = xray.choice_table_mut() {
                    table.handle_action(action, context.page_rows);
                }
            }
        }
        xray.request_inspection()
    }

    fn handle_click(&self, xray: &mut Xray, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        if let Some(table) = xray.choice_table_mut() {
            table.select_visible_row(row);
        }
        xray.request_inspection()
    }

    fn border(&self, xray: &Xray, _: Rect, _: &ScreenContext<'_>) -> PaneBorder {
        PaneBorder { title: xray.view().choices().title().to_owned(), ..PaneBorder::default() }
    }

    fn draw(&self, xray: &Xray, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &ScreenContext<'_>) {
        if let Some(table) = xray.choice_table() {
            table.draw(canvas, placement.area, placement.focused, placement.index);
        }
    }
}

impl Pane<Xray> for InspectionPane {
    fn scopes(&self, xray: &Xray) -> Vec<Scope> {
        match (xray.can_inspect, &xray.input) {
            (false, _) => vec![Scope::List],
            (true, Some(_)) => vec![Scope::Field],
            (true, None) => vec![Scope::Xray, Scope::List],
        }
    }

    fn hints(&self, xray: &Xray) -> Vec<Action> {
        match (xray.can_inspect, &xray.input) {
            (false, _) => Vec::new(),
            (true, Some(_)) => vec![Action::Commit, Action::Discard],
            (true, None) => view_actions(xray.view()).to_vec(),
        }
    }

    fn figure(&self, xray: &Xray, _: &ScreenContext<'_>) -> Option<Figure> {
        view_figure(xray)
    }

    fn handle_action(&self, xray: &mut Xray, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        let moves_cursor = xray.view() == XrayView::Leads;
        match action {
            Action::Commit | Action::CommitDown => return xray.submit_input(),
            Action::Discard => (xray.input, xray.problem) = (None, None),
            Action::Open if matches!(xray.view(), XrayView::Customer | XrayView::Breakpoints | XrayView::Commands) => {
                return xray.start_input(InputKind::for_view(xray.view()));
            }
            Action::Close => xray.focus = XrayPane::Views,
            Action::Up if moves_cursor => xray.selected_factor = xray.selected_factor.saturating_sub(1),
            Action::Down if moves_cursor => {
                xray.selected_factor = (xray.selected_factor + 1).min(LeadFactor::ALL.len() - 1);
            }
            action => drop(xray.scroll.handle_action(action, context.page_rows.into())),
        }
        Vec::new()
    }

    fn handle_key(&self, xray: &mut Xray, key: &KeyEvent, _: &ScreenContext<'_>) -> Vec<Effect> {
        xray.problem = None;
        if let Some(typing) = &mut xray.input {
            typing.field.handle_key(key);
        }
        Vec::new()
    }

    fn paste(&self, xray: &mut Xray, text: &str, _: &ScreenContext<'_>) -> Vec<Effect> {
        if let Some(typing) = &mut xray.input {
            typing.field.insert(text.trim());
        }
        Vec::new()
    }

    fn border(&self, xray: &Xray, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        if !xray.can_inspect {
            return PaneBorder { title: "X-ray".to_owned(), ..PaneBorder::default() };
        }
        let view = xray.view();
        let title = match (view, view.choices()) {
            (XrayView::Customer, _) => xray.customer.map_or(String::new(), |customer| format!(" {customer}")),
            (XrayView::Commands, _) => match (xray.pending_command(), xray.command_output.as_ref().map(|inspection_result| &inspection_result.question)) {
                (Some(words), _) => format!(": {words}"),
                (None, Some(InspectionQuestion::Command(words, _))) => format!(": {words}"),
                _ => String::new(),
            },
            (_, ViewChoices::Groups) => xray.group().map_or(String::new(), |group| format!(" of {group}")),
            (_, ViewChoices::Components) => xray.selected_part().map_or(String::new(), |part| format!(" of {}", part.id())),
            _ => String::new(),
        };
        let note = match (xray.pending_question.is_waiting(), view.has_day()) {
            (true, _) => "re-simulating …".to_owned(),
            (false, true) => format!("day {} of {}", xray.shown_day(), xray.last_day),
            (false, false) => format!("after day {}", xray.last_day),
        };
        let label = |action| context.keys.label(action).unwrap_or_default();
        let days = format!(
            "{} {} day · {} {} week",
            label(Action::Left),
            label(Action::Right),
            label(Action::DayWeekBefore),
            label(Action::DayWeekAfter)
        );
        let others: Vec<Action> = view_actions(view)
            .iter()
            .copied()
            .filter(|action| !matches!(action, Action::Left | Action::Right | Action::DayWeekBefore))
            .collect();
        let others = context.hints(&others);
        let keys = match (view.has_day(), others.is_empty()) {
            (true, true) => days,
            (true, false) => format!("{days} · {others}"),
            (false, _) => others,
        };
        PaneBorder { title: format!("{}{title}", capitalize(view.title())), note, keys, shows_keys_always: true }
    }

    fn draw(&self, xray: &Xray, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let below = u16::from(xray.input.is_some()) + u16::from(xray.problem.is_some());
        let below = below.min(placement.area.height);
        let area = Rect { height: placement.area.height - below, ..placement.area };
        inspection_text::draw(xray, canvas, PanePlacement { area, ..placement }, context);
        let mut rows = row_rects(Rect { y: area.bottom(), height: below, ..placement.area });
        if let (Some(problem), Some(row)) = (&xray.problem, rows.next()) {
            canvas.draw_text(row, problem, Role::Bad);
        }
        if let (Some(typing), Some(row)) = (&xray.input, rows.next()) {
            let prompt = typing.kind.prompt();
            let before = (prompt.len() as u16 + 1).min(row.width);
            canvas.draw_text(row, prompt, Role::Key);
            typing.field.draw(canvas, Rect { x: row.x + before, width: row.width - before, ..row });
        }
    }
}
