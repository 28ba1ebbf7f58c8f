//! The weekly report: cash and its components, unusual changes, decisions, news, due forecasts, and what needs
//! attention.

use std::cell::Cell;

use ratatui::layout::Rect;
use ratatui::text::Line;
use unicode_width::UnicodeWidthStr;

use super::{Dialog, DialogContent, DialogResponse, DialogView};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::screens::overview::action_items::item_screen;
use crate::screens::overview::figures::{self, METRICS};
use novamind_base::formatting::{dollars, grouped_number, pluralize, short_dollars, signed_dollars};
use novamind_record::figures::WeekFigure;
use novamind_report::action_items::{ActionItem, describe_no_items};
use novamind_report::week::ChangedFigure;
use novamind_report::{WeekReport, figure_label};
use novamind_session::identifiers::Group;
use novamind_session::{IntervalPosition, ScoredForecast};
use novamind_tools::Forecast;
use novamind_tui::canvas::{Canvas, Click, centered_rect};
use novamind_tui::text::{format_change, format_count, join_into_lines, wrap, wrap_sentences};
use novamind_tui::theme::Role;
use novamind_tui::widgets::ScrollState;
use novamind_worker::company::DisplayedCompany;

const MAX_PAGE_WIDTH: u16 = 116;
/// Minimum width for comments next to the figures. In narrower windows, comments are below the figures.
const MIN_WIDTH_FOR_SIDE_TEXT: u16 = 100;
const CHANGES_SECTION: usize = 2;
/// Minimum height at which the optional lines are omitted instead of scrolled.
const MIN_HEIGHT_WITHOUT_SCROLLING: usize = 18;
/// Number of rows for the changes and the next steps if the report is scrolled.
const MAX_SCROLLED_LINES: usize = 200;

/// The dialog that reports the last week.
pub struct WeekReportDialog {
    remark: Option<String>,
    /// Index of the selected line: 0 is cash, followed by the most unusual changes.
    selected: usize,
    /// Whether the complete report is shown, which can be longer than the window.
    is_complete: bool,
    /// Scroll position of the complete report.
    scroll: ScrollState,
    /// First line of the complete report that the short report omits, if it omits a line.
    first_omitted: Cell<Option<usize>>,
}

impl WeekReportDialog {
    /// Opens the report, with a remark on how the week was saved.
    pub fn new(remark: Option<String>) -> WeekReportDialog {
        WeekReportDialog {
            remark,
            selected: 0,
            is_complete: false,
            scroll: ScrollState::default(),
            first_omitted: Cell::default(),
        }
    }

    /// Scrolls the complete report. Scrolling up from its first line shows the short report.
    fn scroll_complete_report(&mut self, action: Action, page: usize) {
        let before = self.scroll.clone();
        self.scroll.handle_action(action, page);
        self.is_complete = action != Action::PageUp || before != self.scroll;
    }

    /// Shows the complete report from the first line that the short report omits.
    fn open_complete_report(&mut self) {
        if let Some(first) = self.first_omitted.get() {
            self.is_complete = true;
            self.scroll.handle_action(Action::First, 1);
            self.scroll.handle_action(Action::PageDown, first);
        }
    }

    fn select(&mut self, to: usize, context: &ScreenContext<'_>) -> DialogResponse {
        self.selected = to.min(usize::from(context.page_rows).saturating_sub(1));
        DialogResponse::stay()
    }

    fn figure(&self, context: &ScreenContext<'_>) -> Option<Figure> {
        let name = match self.selected.checked_sub(1) {
            None => METRICS.first()?.name,
            Some(at) => context.company.last_week.as_ref()?.changed_figures.get(at)?.name,
        };
        let figure = WeekFigure::parse_label(name)?;
        let metric = METRICS.iter().find(|metric| WeekFigure::parse_label(metric.name) == Some(figure))?;
        Some(figures::figure(metric, 0, context.company))
    }
}

type SectionLines<'a> = Vec<Line<'a>>;

/// Returns the index of the first line of the complete report that differs from the short report. Blank lines are
/// ignored.
fn first_omitted_line(short: &[Line<'_>], complete: &[Line<'_>]) -> Option<usize> {
    let mut shown = short.iter().filter(|line| line.width() > 0);
    let is_omitted = |line: &Line<'_>| line.width() > 0 && shown.next() != Some(line);
    complete.iter().position(is_omitted)
}

impl Dialog for WeekReportDialog {
    fn record_name(&self) -> String {
        "week report".to_owned()
    }

    fn tour_view(&self) -> Option<DialogView> {
        Some(DialogView::new(DialogContent::WeekReport, true))
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog, Scope::List, Scope::Global]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Cancel, Action::NextWeek]
    }

    fn overrides_dialog_keys(&self, action: Action) -> bool {
        action == Action::NextWeek
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Cancel | Action::Close | Action::Report | Action::Open => DialogResponse::close(),
            Action::PageDown if !self.is_complete => {
                self.open_complete_report();
                DialogResponse::stay()
            }
            Action::PageUp | Action::PageDown | Action::First | Action::Last if self.is_complete => {
                self.scroll_complete_report(action, context.page_rows.saturating_sub(1).max(1).into());
                DialogResponse::stay()
            }
            Action::ScrollUp | Action::ScrollDown if self.is_complete => {
                self.scroll_complete_report(action, 1);
                DialogResponse::stay()
            }
            Action::First => self.select(0, context),
            Action::Last => self.select(usize::MAX, context),
            Action::NextWeek => DialogResponse::confirm_with(vec![Effect::Execute(action)]),
            Action::ScrollUp => self.select(self.selected.saturating_sub(1), context),
            Action::ScrollDown => self.select(self.selected + 1, context),
            Action::Why => {
                DialogResponse::stay_with(self.figure(context).map(Effect::ShowCauses).into_iter().collect())
            }
            Action::Rows => {
                DialogResponse::stay_with(self.figure(context).map(Effect::ShowRows).into_iter().collect())
            }
            _ => DialogResponse::stay(),
        }
    }

    fn handle_click(&mut self, row: usize, context: &ScreenContext<'_>) -> DialogResponse {
        self.select(row, context)
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let Some(week_report) = &context.company.last_week else { return };
        let width = MAX_PAGE_WIDTH.min(area.width);
        let height = usize::from(area.height.saturating_sub(2));
        let report_lines =
            |height| self.report_lines(canvas, week_report, context, width.saturating_sub(4), height);
        let complete = report_lines(usize::MAX);
        let rows_above = self.scroll.clamped_first_row(complete.0.len().saturating_sub(height));
        let (lines, mut places) = if self.is_complete {
            complete
        } else {
            let short = report_lines(height);
            self.first_omitted.set(first_omitted_line(&short.0[..short.0.len().min(height)], &complete.0));
            short
        };
        let selectable = places.len();
        // The rows below the last selectable line are reached by selecting them.
        places.extend(places.last().map_or(0, |last| last + 1)..lines.len());
        let rows = if self.is_complete { height } else { places.len() };
        canvas.page_rows = rows.max(1) as u16;
        let dialog_area = centered_rect(area, width, lines.len() as u16 + 2);
        canvas.clear(dialog_area, Role::Text);
        let title = format!("Week {} · day {}", week_report.week.day.div_ceil(7), week_report.week.day);
        let inside = canvas.draw_pane_frame(dialog_area, &title, "", true);
        let selected = places.get(self.selected).copied().unwrap_or(0);
        let from = match self.is_complete {
            true => {
                canvas.draw_scroll_marks(inside, rows_above, lines.len());
                rows_above
            }
            false => canvas.scroll_to_row(inside, selected, lines.len()),
        };
        let text = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.draw_lines(text, &lines[from..]);
        canvas.register_click(dialog_area, Click::Command(Action::Cancel.into()));
        for (at, place) in places.iter().enumerate().take(selectable) {
            let row = place.checked_sub(from).filter(|row| *row < usize::from(inside.height));
            if let Some(row) = row {
                canvas.register_click(
                    Rect { y: inside.y + row as u16, height: 1, ..inside },
                    Click::Row(0, at),
                );
            }
        }
        let mut close = context.hint(Action::Cancel);
        if self.is_complete || self.first_omitted.get().is_some() {
            close = format!("{close} · {}", context.hint(Action::PageDown));
        }
        // The change in the first week has no explanation, because there is no previous week.
        let why = match context.company.can_explain_causes() && context.company.weeks.len() > 1 {
            true => format!(" · {}", context.hint(Action::Why)),
            false => String::new(),
        };
        let again =
            context.keys.label(Action::Report).map_or(String::new(), |key| format!(" · {key} reopens it"));
        canvas.draw_pane_keys(dialog_area, &format!("{close}{why}{again}"));
    }
}

impl WeekReportDialog {
    /// Returns the lines and the positions of selectable lines. If the height is small, optional lines are omitted. If
    /// it is too small for all sections, fewer lines are omitted, because the user must scroll anyway. The complete
    /// report has the height `usize::MAX`.
    fn report_lines<'a>(
        &self,
        canvas: &Canvas<'_>,
        week_report: &WeekReport,
        context: &ScreenContext<'_>,
        width: u16,
        height: usize,
    ) -> (Vec<Line<'a>>, Vec<usize>) {
        let omits_nothing = height == usize::MAX;
        let limit = |lines: usize| if omits_nothing { usize::MAX } else { lines };
        let scrolls = height < MIN_HEIGHT_WITHOUT_SCROLLING;
        let is_complete = scrolls || height >= 26;
        let head = self.header_section(canvas, week_report, width, limit(if is_complete { 4 } else { 1 }));
        let needs = &context.company.action_items;
        let notices = &context.company.notices;
        let news = news_section(canvas, week_report, width, context);
        let decided = decisions_section(canvas, week_report, width, limit(if is_complete { 6 } else { 2 }));
        // `fixed` includes two headings and, in tall windows, the four blank lines between the five sections.
        let airy = height >= 24;
        let fixed = head.len() + decided.len() + news.len() + 2 + if airy { 4 } else { 0 };
        let room = if scrolls { MAX_SCROLLED_LINES } else { height.saturating_sub(fixed) };
        let shown_needs = needs.len().min((room / 5).max(1)).max(1);
        let rows_per_need = limit(2);
        let coming = next_steps_section(
            canvas,
            &needs[..shown_needs.min(needs.len())],
            (width, rows_per_need),
            is_complete,
            context,
        );
        let taken = coming.len() + usize::from(!notices.is_empty());
        let (moves, starts) = self.changes_section(canvas, week_report, width, room.saturating_sub(taken));
        let left = room.saturating_sub(coming.len() + moves.len());
        let parts: [SectionLines<'a>; 5] = [
            head,
            decided,
            match moves.is_empty() {
                true => Vec::new(),
                false => with_heading(canvas, &changes_heading(week_report, starts.len()), moves),
            },
            news.into_iter()
                .chain(notices_section(canvas, context.company, width, left.min(limit(8))))
                .collect(),
            with_heading(canvas, "Action needed", coming),
        ];
        let (mut lines, mut places) = (Vec::new(), vec![0]);
        for (at, part) in parts.into_iter().enumerate() {
            if at > 0 && airy {
                lines.push(Line::default());
            }
            if at == CHANGES_SECTION {
                // The heading is not selectable.
                places.extend(starts.iter().map(|start| lines.len() + 1 + start));
            }
            lines.extend(part);
        }
        (lines, places)
    }

    fn header_section<'a>(
        &self,
        canvas: &Canvas<'_>,
        week_report: &WeekReport,
        width: u16,
        forecasts: usize,
    ) -> SectionLines<'a> {
        let change = week_report.week.cash_change;
        let role = if change < 0.0 { Role::Bad } else { Role::Good };
        let mut lines = vec![Line::from(vec![
            canvas
                .span(format!("Cash {}  ", dollars(week_report.week.cash)), self.name_role(0, Role::Strong)),
            canvas.span(format_change(change, &dollars(change.abs())), role),
            canvas.span(" this week", Role::Dim),
        ])];
        let parts: Vec<String> = week_report
            .cash_components
            .iter()
            .map(|(name, amount)| format!("{name} {}", signed_dollars(*amount)))
            .collect();
        let parts = join_into_lines(&parts, width as usize).into_iter();
        lines.extend(parts.map(|line| Line::from(canvas.span(line, Role::Text))));
        let remark = self.remark.iter().flat_map(|remark| wrap(remark, width as usize));
        lines.extend(remark.map(|line| Line::from(canvas.span(line, Role::Warning))));
        if week_report.was_filed_at_limit() {
            let text = "The time for this week ran out: the week was submitted with naive forecasts.";
            let note_lines = wrap(text, width as usize).into_iter();
            lines.extend(note_lines.map(|line| Line::from(canvas.span(line, Role::Warning))));
        }
        // A count replaces forecasts that do not fit. The journal lists all forecasts.
        let left_out = week_report.due_forecasts.len().saturating_sub(forecasts);
        let more = if left_out > 0 { format!(" · {left_out} more") } else { String::new() };
        let due_width = width.saturating_sub(more.width() as u16);
        let mut due: Vec<&ScoredForecast> = week_report.due_forecasts.iter().collect();
        if left_out > 0 {
            // Forecasts in range must not hide forecasts that missed.
            due.sort_by_key(|due| due.interval_position() == Some(IntervalPosition::Inside));
        }
        lines.extend(due.into_iter().take(forecasts).flat_map(|due| {
            forecast_lines(canvas, due, week_report.was_forecast_filed_at_limit(due), due_width)
        }));
        if let (Some(last), true) = (lines.last_mut(), left_out > 0) {
            last.spans.push(canvas.span(more, Role::Dim));
        }
        lines
    }
}

impl WeekReportDialog {
    /// Returns the style of a line's name. Lines without an explanation cannot be selected.
    fn name_role(&self, line: usize, role: Role) -> Role {
        if self.selected == line { Role::Selection } else { role }
    }

    /// Returns the lines of the most unusual changes that fit, and the first line of each change.
    fn changes_section<'a>(
        &self,
        canvas: &Canvas<'_>,
        week_report: &WeekReport,
        width: u16,
        room: usize,
    ) -> (SectionLines<'a>, Vec<usize>) {
        if week_report.changed_figures.is_empty() {
            return (vec![Line::from(canvas.span("  none", Role::Dim))], Vec::new());
        }
        let (mut lines, mut starts) = (Vec::new(), Vec::new());
        for (at, moved_figure) in week_report.changed_figures.iter().enumerate() {
            let of_one = change_lines(canvas, moved_figure, width, self.name_role(at + 1, Role::Text));
            if lines.len() + of_one.len() > room {
                break;
            }
            starts.push(lines.len());
            lines.extend(of_one);
        }
        (lines, starts)
    }
}

/// Returns the heading of the changes with the number of changes that are shown, if some are omitted. The heading names
/// the reference period if the two weeks differ in length.
fn changes_heading(week_report: &WeekReport, shown: usize) -> String {
    let all = week_report.changed_figures.len();
    let number = if shown < all { format!(" · {shown} of {all}") } else { String::new() };
    match &week_report.short_week_note {
        Some(short) => format!("Most unusual changes{number} · a week {short}"),
        None => format!("Most unusual changes{number}"),
    }
}

fn with_heading<'a>(canvas: &Canvas<'_>, heading: &str, lines: SectionLines<'a>) -> SectionLines<'a> {
    std::iter::once(Line::from(canvas.span(heading.to_owned(), Role::Header))).chain(lines).collect()
}

/// Describes a due forecast and the actual value in one or two lines. `is_from_time_limit` is true if the program submitted
/// the forecast at the time limit.
fn forecast_lines<'a>(
    canvas: &Canvas<'_>,
    due: &ScoredForecast,
    is_from_time_limit: bool,
    width: u16,
) -> SectionLines<'a> {
    let weeks = due.forecast.horizon_days / 7;
    let ago = if weeks == 1 { "a week ago".to_owned() } else { format!("{weeks} weeks ago") };
    let who = match (is_from_time_limit, width) {
        (false, _) => "you",
        (true, 90..) => "the program, at the time limit,",
        (true, _) => "the program",
    };
    let format_forecast = |write: fn(f64) -> String| {
        let Forecast { point, lower, upper, .. } = due.forecast;
        format!("{ago} {who} forecast {}, {} to {}: ", write(point), write(lower), write(upper))
    };
    // The symbol makes the verdict readable without color.
    let (verdict, role) = match due.interval_position() {
        Some(IntervalPosition::Inside) => ("✓ in range", Role::Good),
        Some(IntervalPosition::Above) => ("▲ actual above range", Role::Warning),
        Some(IntervalPosition::Below) => ("▼ actual below range", Role::Warning),
        None => ("open", Role::Dim),
    };
    let error_text =
        due.describe_error().map_or(String::new(), |error_text| format!(", forecast {error_text}"));
    // Rounded bounds could seem to contain the actual value, so exact amounts are used if they fit.
    let exact = format_forecast(dollars);
    let fits = exact.width() + verdict.width() + error_text.width() <= usize::from(width);
    let text = if fits { exact } else { format_forecast(short_dollars) };
    let outcome = [canvas.span(verdict, role), canvas.span(error_text, Role::Dim)];
    let text_width = text.width();
    let text = canvas.span(text, Role::Dim);
    if text_width + outcome.iter().map(|span| span.content.width()).sum::<usize>() <= usize::from(width) {
        return vec![Line::from_iter(std::iter::once(text).chain(outcome))];
    }
    let indent = canvas.span("  ", Role::Dim);
    vec![Line::from(text), Line::from_iter(std::iter::once(indent).chain(outcome))]
}

/// Lists the decisions before the week in at most `most` lines.
fn decisions_section<'a>(
    canvas: &Canvas<'_>,
    week_report: &WeekReport,
    width: u16,
    most: usize,
) -> SectionLines<'a> {
    let lines = |pieces: &[String]| join_into_lines(pieces, (width as usize).saturating_sub(9));
    let mut shown = week_report.decisions.len();
    let mut found = lines(&week_report.decisions);
    while found.len() > most && shown > 0 {
        shown -= 1;
        let more = format!("and {} more", week_report.decisions.len() - shown);
        found = lines(&[&week_report.decisions[..shown], &[more]].concat());
    }
    if found.is_empty() {
        found.push("nothing".to_owned());
    }
    let line = |(at, text): (usize, String)| {
        let heading = if at == 0 { "Decided  " } else { "         " };
        Line::from(vec![canvas.span(heading, Role::Header), canvas.span(text, Role::Text)])
    };
    found.into_iter().enumerate().map(line).collect()
}

/// Formats a change in one or two lines.
fn change_lines<'a>(
    canvas: &Canvas<'_>,
    moved_figure: &ChangedFigure,
    width: u16,
    name: Role,
) -> SectionLines<'a> {
    let role = match moved_figure.is_favorable {
        Some(true) => Role::Good,
        Some(false) => Role::Bad,
        None => Role::Text,
    };
    let glyph = if moved_figure.is_increase { "▲" } else { "▼" };
    let share = moved_figure.format_size().unwrap_or_default();
    let mark = if name == Role::Selection { "›" } else { " " };
    let mut line = vec![
        canvas.span(format!("{mark} {:<17}", figure_label(moved_figure.name)), name),
        canvas.span(format!("{:>12} → ", moved_figure.old), Role::Dim),
        canvas.span(format!("{:>12}", moved_figure.new), Role::Strong),
        canvas.span(format!("  {glyph} {share:<7}"), role),
    ];
    let split = moved_figure
        .category_changes
        .iter()
        .map(|(name, dollars)| format!("{name} {}", signed_dollars(*dollars)));
    let parts: Vec<String> = [moved_figure.change.describe_rarity()]
        .into_iter()
        .filter(|text| !text.is_empty())
        .chain(split)
        .collect();
    let summary = parts.join(" · ");
    if summary.is_empty() {
        return vec![Line::from(line)];
    }
    let used: usize = line.iter().map(|span| span.content.width()).sum();
    if width >= MIN_WIDTH_FOR_SIDE_TEXT && used + 2 + summary.width() <= width as usize {
        line.push(canvas.span(format!("  {summary}"), Role::Dim));
        return vec![Line::from(line)];
    }
    let below = join_into_lines(&parts, (width as usize).saturating_sub(6)).into_iter();
    let below = below.map(|text| Line::from(canvas.span(format!("      {text}"), Role::Dim)));
    std::iter::once(Line::from(line)).chain(below).collect()
}

/// Describes the first contracts of enterprises in the week: `2 enterprises signed (E1 1, E2 1): 653 seats`.
fn contracts_text(week_report: &WeekReport, company: &DisplayedCompany) -> Option<String> {
    let groups = company.group_weeks.last()?;
    let signed: Vec<(Group, u32)> = Group::all()
        .filter(|group| group.is_enterprise() && groups[*group].signed > 0)
        .map(|group| (group, groups[group].signed))
        .collect();
    let count: u32 = signed.iter().map(|(_, count)| count).sum();
    let by_group: Vec<String> = signed.iter().map(|(group, count)| format!("{group} {count}")).collect();
    let seats = format_count(week_report.week.new_enterprise_seats.into(), "seat");
    let enterprises = pluralize(count, "enterprise");
    (count > 0).then(|| format!("{enterprises} signed ({}): {seats}", by_group.join(", ")))
}

/// Lists the contracts and the counts of new items, with the keys of the screens that show them.
fn news_section<'a>(
    canvas: &Canvas<'_>,
    week_report: &WeekReport,
    width: u16,
    context: &ScreenContext<'_>,
) -> SectionLines<'a> {
    let kinds: [(u32, &str, &str, Option<ScreenId>); 6] = [
        (week_report.week.threads_opened, "thread", "threads", Some(ScreenId::Inbox)),
        (week_report.week.replies, "reply", "replies", Some(ScreenId::Inbox)),
        (week_report.customer_posts, "post", "posts", Some(ScreenId::Social)),
        (week_report.comments, "comment on your posts", "comments on your posts", Some(ScreenId::Social)),
        (week_report.news_items, "news item", "news items", Some(ScreenId::Social)),
        (
            week_report.week.research_finished,
            "completed project or study",
            "completed projects and studies",
            // Projects and studies are on different screens. The notifications below name each project and each study.
            None,
        ),
    ];
    let of_count = |(count, one, more, screen): (u32, &str, &str, _)| {
        let text = format!("{} {}", grouped_number(f64::from(count), 0), if count == 1 { one } else { more });
        (count > 0).then_some((text, screen))
    };
    let contracts = contracts_text(week_report, context.company).map(|text| (text, Some(ScreenId::Inbox)));
    let found: Vec<_> = contracts.into_iter().chain(kinds.into_iter().filter_map(of_count)).collect();
    let mut lines = vec![vec![canvas.span("New  ", Role::Header)]];
    let mut used = 5;
    for (at, (text, screen)) in found.iter().enumerate() {
        let dot = if at > 0 { " · " } else { "" };
        let text = format!("{dot}{text}");
        // Consecutive items of one screen share the key of that screen.
        let last = found.get(at + 1).is_none_or(|next| next.1 != *screen);
        let key = screen
            .filter(|_| last)
            .and_then(|screen| context.keys.label(screen.action()))
            .map_or(String::new(), |key| format!(" [{key}]"));
        if used + text.width() + key.width() > width as usize {
            lines.push(vec![canvas.span("   ", Role::Text)]);
            used = 3;
        }
        used += text.width() + key.width();
        if let Some(line) = lines.last_mut() {
            line.extend([canvas.span(text, Role::Text), canvas.span(key, Role::Key)]);
        }
    }
    if found.is_empty() {
        lines.push(vec![canvas.span("  nothing", Role::Dim)]);
    }
    lines.into_iter().map(Line::from).collect()
}

/// Lists the latest notifications that fit into `room` rows. Repeated notifications are combined with a count.
fn notices_section<'a>(
    canvas: &Canvas<'_>,
    company: &DisplayedCompany,
    width: u16,
    room: usize,
) -> SectionLines<'a> {
    let mut distinct_notices: Vec<(u32, &str, u32)> = Vec::new();
    for (day, text) in company.notices.iter().rev() {
        match distinct_notices.iter().position(|(_, known, _)| known == text) {
            Some(at) => distinct_notices[at].2 += 1,
            None => distinct_notices.push((*day, text, 1)),
        }
    }
    let mut shown: Vec<SectionLines<'a>> = Vec::new();
    let mut rows = 0;
    for (day, text, times) in distinct_notices {
        let lines = notice_lines(canvas, company, width, (day, text, times));
        rows += lines.len();
        if rows > room {
            break;
        }
        shown.push(lines);
    }
    shown.into_iter().rev().flatten().collect()
}

fn notice_lines<'a>(
    canvas: &Canvas<'_>,
    company: &DisplayedCompany,
    width: u16,
    (day, text, times): (u32, &str, u32),
) -> SectionLines<'a> {
    let times = if times > 1 { format!(" ({times} times)") } else { String::new() };
    let before = format!("  day {day:<4} ");
    let text = company.enterprise_names.insert_names(&text.split_whitespace().collect::<Vec<_>>().join(" "));
    let lines = wrap(&format!("{text}{times}"), usize::from(width).saturating_sub(before.len()));
    let line = |(at, text): (usize, String)| {
        let before = if at == 0 { before.clone() } else { " ".repeat(before.len()) };
        Line::from(vec![canvas.span(before, Role::Dim), canvas.span(text, Role::Text)])
    };
    lines.into_iter().enumerate().map(line).collect()
}

/// Lists action items in at most `rows` rows each, and the key for the next step. Suggestions are included if there is
/// space.
fn next_steps_section<'a>(
    canvas: &Canvas<'_>,
    needs: &[ActionItem],
    (width, rows): (u16, usize),
    roomy: bool,
    context: &ScreenContext<'_>,
) -> SectionLines<'a> {
    if needs.is_empty() && !context.company.is_running() {
        let (page, others) = (
            context.keys.label(Action::NextWeek).unwrap_or_default(),
            [Action::Branches, Action::WriteReport],
        );
        let text = format!("  the run has ended: {page} final page · {}", context.hints(&others));
        return vec![Line::from(canvas.span(text, Role::Dim))];
    }
    if needs.is_empty() {
        let key = context.keys.label(Action::NextWeek).unwrap_or_default();
        let company = context.company;
        let checked = describe_no_items(company.weeks.last(), company.observation.runway_weeks);
        let text = format!("{checked} {key} starts the next week.");
        let lines = wrap(&text, (width as usize).saturating_sub(2)).into_iter();
        return lines.map(|text| Line::from(canvas.span(format!("  {text}"), Role::Dim))).collect();
    }
    let lines = |need: &ActionItem| {
        let key =
            context.keys.label(item_screen(need).action()).map_or(String::new(), |key| format!(" [{key}]"));
        let (sign, role) = if need.is_urgent { ("!", Role::Warning) } else { ("·", Role::Text) };
        let room = (width as usize).saturating_sub(4 + key.width());
        let text = if roomy { need.describe() } else { need.text.clone() };
        let rows = wrap_sentences(&text, room, rows);
        let mut lines = vec![Line::from(vec![
            canvas.span(format!("  {sign} {}", rows.first().map_or("", String::as_str)), role),
            canvas.span(key, Role::Key),
        ])];
        let rest = rows.iter().skip(1);
        lines.extend(rest.map(|text| Line::from(canvas.span(format!("    {text}"), role))));
        lines
    };
    needs.iter().flat_map(lines).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{self, dialog_action, dialog_text};
    use novamind_worker::company::DisplayedCompany;

    #[test]
    fn report_adapts_to_the_window_size() {
        let company = DisplayedCompany::from_session(&test_kit::played_session(8));
        let report = WeekReportDialog::new(None);
        let small = dialog_text(&report, &company, 80, 21);
        let large = dialog_text(&report, &company, 120, 37);
        for (text, name) in [(&small, "80×24"), (&large, "120×40")] {
            for part in [
                "Week 8 · day 56",
                "Cash $",
                "payments +$",
                "a week ago you forecast",
                "Most unusual changes",
                "New  ",
                "Action needed",
            ] {
                assert!(text.contains(part), "{part} is missing at {name}:\n{text}");
            }
        }
        assert!(large.matches(" → ").count() > small.matches(" → ").count(), "{large}");
        assert!(large.contains("4 weeks ago you forecast"), "{large}");
    }

    #[test]
    fn complete_report_is_reached_by_paging() {
        let company = DisplayedCompany::from_session(&test_kit::played_session(8));
        let mut company = company;
        let decisions: Vec<String> = (0..40).map(|at| format!("ads content E1: 0 → {at}00 $/day")).collect();
        if let Some(week_report) = &mut company.last_week {
            week_report.decisions = decisions.clone();
        }
        for (width, height) in [(60, 13), (80, 21), (120, 37)] {
            let mut report = WeekReportDialog::new(None);
            let short = dialog_text(&report, &company, width, height);
            assert!(short.contains("pagedown"), "{short}");
            let mut seen = short.clone();
            for _ in 0..20 {
                dialog_action(&mut report, Action::PageDown, &company);
                seen += &dialog_text(&report, &company, width, height);
            }
            for decision in &decisions {
                assert!(seen.contains(decision), "{decision} is missing at {width}×{height}:\n{seen}");
            }
            for need in &company.action_items {
                let last = need.describe();
                let last = last.split_whitespace().next_back().unwrap_or_default();
                assert!(seen.contains(last), "{last} is missing at {width}×{height}:\n{seen}");
            }
            for _ in 0..60 {
                dialog_action(&mut report, Action::PageUp, &company);
                dialog_text(&report, &company, width, height);
            }
            assert_eq!(dialog_text(&report, &company, width, height), short);
        }
    }

    #[test]
    fn contracts_of_enterprises_are_listed() {
        let mut company = DisplayedCompany::from_session(&test_kit::played_session(8));
        let mut weeks = company.group_weeks.to_vec();
        let group = Group::parse("E1").expect("a group");
        weeks.last_mut().expect("a week")[group].signed = 2;
        company.group_weeks = weeks.into();
        company.last_week.as_mut().expect("a report").week.new_enterprise_seats = 653;
        let text = dialog_text(&WeekReportDialog::new(None), &company, 120, 37);
        assert!(text.contains("2 enterprises signed (E1 2): 653 seats"), "{text}");
    }

    #[test]
    fn report_shows_the_remark_about_saving() {
        let company = DisplayedCompany::from_session(&test_kit::played_session(1));
        let report = WeekReportDialog::new(Some("the disk is full".to_owned()));
        assert!(dialog_text(&report, &company, 80, 21).contains("the disk is full"));
    }

    #[test]
    fn report_is_drawn_at_every_size() {
        let company = DisplayedCompany::from_session(&test_kit::played_session(3));
        for (width, height) in
            (0..90).step_by(21).flat_map(|width| (0..30).step_by(4).map(move |height| (width, height)))
        {
            dialog_text(&WeekReportDialog::new(Some("x ".repeat(99))), &company, width, height);
        }
    }
}
