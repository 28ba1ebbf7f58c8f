//! The pane with the list of threads.

use ratatui::layout::Rect;

use super::model::{Thread, ThreadState};
use super::{Inbox, InboxPane, InboxView, sending};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::own_commands::ListRows;
use crate::screens::panes::{Pane, PaneBorder, PanePlacement};
use novamind_base::formatting::{grouped_number, pluralize};
use novamind_report::funnel::Funnel;
use novamind_rules::format_offer_lines;
use novamind_tui::canvas::{Canvas, row_rects};
use novamind_tui::text::{format_count, wrap};
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Table, TableCell, TableColumn};

/// Width of names in a narrow list. The number next to the name identifies the enterprise.
const NAME_WIDTH: u16 = 14;

/// Number of the first columns that stay visible when the columns are scrolled: the mark, the days and the name.
pub(super) const PINNED_COLUMNS: usize = 3;

pub struct ThreadListPane;

impl Pane<Inbox> for ThreadListPane {
    fn table<'a>(&self, inbox: &'a Inbox) -> Option<&'a Table> {
        Some(&inbox.table)
    }

    fn table_name(&self) -> Option<&'static str> {
        Some("inbox.threads")
    }

    fn table_mut<'a>(&self, inbox: &'a mut Inbox) -> Option<&'a mut Table> {
        Some(&mut inbox.table)
    }

    fn scopes(&self, inbox: &Inbox) -> Vec<Scope> {
        match inbox.table.is_filter_open() {
            true => vec![Scope::Field, Scope::List],
            false => vec![Scope::Inbox, Scope::List],
        }
    }

    fn hints(&self, inbox: &Inbox) -> Vec<Action> {
        if inbox.table.is_filter_open() {
            return vec![Action::Commit, Action::Discard];
        }
        vec![
            Action::Open,
            Action::SendOffer,
            Action::MatchAskedPrice,
            Action::Mark,
            Action::MarkAll,
            Action::RejectOffer,
            Action::InboxRules,
            Action::InboxOutcomes,
            Action::NextThreadView,
            Action::Filter,
            Action::Sort,
            Action::InboxGroup,
            Action::InboxSql,
        ]
    }

    fn figure(&self, inbox: &Inbox, _: &ScreenContext<'_>) -> Option<Figure> {
        let thread = inbox.selected_thread()?;
        Some(match inbox.table.selected_column() {
            5 => sending::thread_figure(thread, "seats of", "seats"),
            6 => sending::thread_figure(thread, "price asked by", "offer"),
            _ => sending::thread_figure(thread, "thread with", "thread"),
        })
    }

    fn handle_action(&self, inbox: &mut Inbox, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        if action == Action::Open {
            inbox.focus = InboxPane::Offer;
        } else {
            inbox.scroll = 0;
            inbox.table.handle_action(action, context.page_rows);
        }
        Vec::new()
    }

    fn list_rows(&self, inbox: &Inbox, all: bool) -> Option<ListRows> {
        let selected = inbox.table.selected();
        let is_wanted = |row: usize| match inbox.marked.is_empty() {
            true => selected == Some(row),
            false => inbox.thread_in_row(row).is_some_and(|number| inbox.marked.contains(&number)),
        };
        Some(ListRows::from_table(&inbox.table, |row| all || is_wanted(row)))
    }

    fn handle_click(&self, inbox: &mut Inbox, row: usize, _: &ScreenContext<'_>) -> Vec<Effect> {
        inbox.table.select_visible_row(row);
        inbox.scroll = 0;
        Vec::new()
    }

    fn border(&self, inbox: &Inbox, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let threads = inbox.rows.len();
        let (title, worth) = match inbox.view {
            InboxView::WaitingForPlayer => (format!("{threads} waiting for you"), true),
            InboxView::WaitingForCustomer => (format!("{threads} awaiting reply"), true),
            InboxView::Closed => (format!("{threads} ended"), false),
        };
        let all = inbox.rows.iter().filter_map(|at| inbox.threads.threads.get(*at));
        let seats: f64 = all.map(|thread| thread.seats).sum();
        let mut note = inbox.table.summary();
        if note.is_empty() && worth && threads > 0 {
            note = format_count(seats, "seat");
        }
        if !inbox.marked.is_empty() {
            note = format!("{} marked · {note}", inbox.marked.len());
        }
        let keys = context.hints(&[Action::Mark, Action::MarkAll, Action::Filter, Action::NextThreadView]);
        PaneBorder { title, note, keys, ..PaneBorder::default() }
    }

    fn draw(
        &self,
        inbox: &Inbox,
        canvas: &mut Canvas<'_>,
        placement: PanePlacement,
        context: &ScreenContext<'_>,
    ) {
        if inbox.rows.is_empty() {
            draw_empty_state(inbox, canvas, placement.area, context);
        } else {
            inbox.table.draw(canvas, placement.area, placement.focused, placement.index);
        }
    }
}

fn draw_empty_state(inbox: &Inbox, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
    let inside = Rect { x: area.x + 1, width: area.width.saturating_sub(2), ..area };
    let mut lines = wrap(&empty_text(inbox, context), inside.width as usize);
    if lines.len() > inside.height as usize {
        let zoom = context.keys.label(Action::Zoom).unwrap_or_default();
        lines.truncate((inside.height as usize).saturating_sub(1));
        lines.push(if canvas.zoomed { "…".to_owned() } else { format!("… {zoom} shows more") });
    }
    for (row, line) in row_rects(inside).zip(lines) {
        canvas.draw_text(row, &line, Role::Dim);
    }
}

fn empty_text(inbox: &Inbox, context: &ScreenContext<'_>) -> String {
    let key = |action: Action| context.keys.label(action).unwrap_or_default();
    if !inbox.threads.threads.is_empty() {
        return format!("No threads in this list. {} shows other lists.", key(Action::NextThreadView));
    }
    let funnels: Vec<String> =
        context.company.funnels.iter().map(|funnel| format!("· {}", funnel.describe())).collect();
    let lost: u32 = context.company.funnels.iter().map(Funnel::lost_before_request).sum();
    let reason = match lost {
        0 => format!("Advertise to enterprise groups ({} set_targeted_ad_spend).", key(Action::Tools)),
        lost => format!("{} arrived and found no plan good enough.", pluralize(lost, "enterprise")),
    };
    format!(
        "No enterprise has asked for an offer yet. {reason} A higher model tier, development for their group and a quota \
         for all seats make a plan more attractive.\n\n{}",
        funnels.join("\n")
    )
}

pub(super) fn columns(view: InboxView) -> Vec<TableColumn> {
    let day = if view == InboxView::WaitingForPlayer { "left" } else { "since" };
    vec![
        TableColumn::text("✓"),
        TableColumn::numeric(day),
        TableColumn::text("enterprise").with_min_width(NAME_WIDTH),
        TableColumn::numeric("no."),
        TableColumn::text("group"),
        TableColumn::numeric("seats"),
        TableColumn::numeric("asked"),
        TableColumn::text("kind"),
        TableColumn::text(if view == InboxView::Closed { "end" } else { "your offer" }).with_max_width(34),
        TableColumn::numeric("offers"),
        TableColumn::numeric("needs quota"),
    ]
}

fn number_cell(value: Option<f64>) -> TableCell {
    match value {
        Some(value) => TableCell::from_number(value, grouped_number(value, 0)),
        None => TableCell::from_text("–").with_role(Role::Dim),
    }
}

pub(super) fn thread_row(thread: &Thread, marked: bool) -> Vec<TableCell> {
    let day = match (thread.state, thread.messages.last()) {
        (ThreadState::WaitingForPlayer(left), _) => {
            let (mark, role) = match left {
                0..=2 => ("! ", Role::Bad),
                3..=5 => ("", Role::Warning),
                _ => ("", Role::Text),
            };
            TableCell::from_number(f64::from(left), format!("{mark}{left} d")).with_role(role)
        }
        (_, Some(turn)) => {
            TableCell::from_number(f64::from(turn.day), format!("day {}", turn.day)).with_role(Role::Dim)
        }
        (_, None) => TableCell::from_text("–").with_role(Role::Dim),
    };
    let table_cell = match (thread.asked_price(), thread.asked_plan()) {
        (Some((_, price)), plan) => {
            let plan = plan.map_or(String::new(), |plan| format!("{plan} "));
            TableCell::from_number(price, format!("{plan}${}", grouped_number(price, 2)))
        }
        (None, Some(plan)) => TableCell::from_text(format!("plan {plan}")),
        (None, None) => TableCell::from_text("–").with_role(Role::Dim),
    };
    let end = match thread.state {
        state if !state.is_open() => {
            let role = if state == ThreadState::Accepted { Role::Good } else { Role::Dim };
            TableCell::from_text(state.label()).with_role(role)
        }
        _ if thread.last_offer().is_empty() => TableCell::from_text("–").with_role(Role::Dim),
        _ => TableCell::from_text(format_offer_lines(thread.last_offer())),
    };
    vec![
        TableCell::from_text(if marked { "●" } else { "" }).with_role(Role::Changed),
        day,
        TableCell::from_text(&thread.name),
        TableCell::from_number(f64::from(thread.customer), format!("#{}", thread.customer)),
        TableCell::from_text(&thread.group).with_role(Role::Strong),
        TableCell::from_number(thread.seats, grouped_number(thread.seats, 0)),
        table_cell,
        TableCell::from_text(thread.kind_label()),
        end,
        number_cell(
            thread
                .waiting_thread
                .as_ref()
                .map(|thread_context| f64::from(thread_context.waiting.offers_so_far)),
        ),
        number_cell(thread.waiting_thread.as_ref().and_then(|context| context.required_quota)),
    ]
}
