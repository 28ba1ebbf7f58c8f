//! The weekly report: cash and its components, unusual changes, decisions, news, due forecasts, and what needs
//! attention.

use ratatui::layout::Rect;
use ratatui::text::Line;
use unicode_width::UnicodeWidthStr;

use super::{Dialog, DialogContent, DialogResponse, DialogView};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext, ScreenId};
use crate::effect::Effect;
use crate::screens::overview::action_items::item_screen;
use crate::screens::overview::figures::{self, METRICS};
use novamind_base::formatting::{dollars, grouped_number, short_dollars, signed_dollars};
use novamind_record::figures::WeekFigure;
use novamind_report::action_items::ActionItem;
use novamind_report::week::MovedFigure;
use novamind_report::{WeekReport, figure_label};
use novamind_session::{IntervalPosition, ScoredForecast};
use novamind_tools::Forecast;
use novamind_tui::canvas::{Canvas, Click, centered_rect, truncate_to_width};
use novamind_tui::text::{format_change, join_into_lines, wrap, wrap_sentences};
use novamind_tui::theme::Role;
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
}

impl WeekReportDialog {
    /// Opens the report, with a remark on how the week was saved.
    pub fn new(remark: Option<String>) -> WeekReportDialog {
        WeekReportDialog { remark, selected: 0 }
    }

    fn select(&mut self, to: usize, context: &ScreenContext<'_>) -> DialogResponse {
        self.selected = to.min(usize::from(context.page_rows).saturating_sub(1));
        DialogResponse::stay()
    }

    fn figure(&self, context: &ScreenContext<'_>) -> Option<Figure> {
        let name = match self.selected.checked_sub(1) {
            None => METRICS.first()?.name,
            Some(at) => context.company.last_week.as_ref()?.moved_figures.get(at)?.name,
        };
        let figure = WeekFigure::parse_label(name)?;
        let metric = METRICS.iter().find(|metric| WeekFigure::parse_label(metric.name) == Some(figure))?;
        Some(figures::figure(metric, 0, context.company))
    }
}

type SectionLines<'a> = Vec<Line<'a>>;

impl Dialog for WeekReportDialog {
    fn record_name(&self) -> String {
        "week report".to_owned()
    }

    fn tour_view(&self) -> Option<DialogView> {
        Some(DialogView::new(DialogContent::WeekReport, true))
    }

    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Dialog, Scope::Global]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::Cancel, Action::NextWeek]
    }

    fn overrides_dialog_keys(&self, action: Action) -> bool {
        action == Action::NextWeek
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Cancel | Action::Report => DialogResponse::close(),
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
        let (lines, mut places) = self.report_lines(
            canvas,
            week_report,
            context,
            width.saturating_sub(4),
            area.height.saturating_sub(2),
        );
        let selectable = places.len();
        // The rows below the last selectable line are reached by selecting them.
        places.extend(places.last().map_or(0, |last| last + 1)..lines.len());
        canvas.page_rows = places.len().max(1) as u16;
        let dialog_area = centered_rect(area, width, lines.len() as u16 + 2);
        canvas.clear(dialog_area, Role::Text);
        let title = format!("Week {} · day {}", week_report.week.day.div_ceil(7), week_report.week.day);
        let inside = canvas.draw_pane_frame(dialog_area, &title, "", true);
        let selected = places.get(self.selected).copied().unwrap_or(0);
        let from = canvas.scroll_to_row(inside, selected, lines.len());
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
        let close = context.hint(Action::Cancel);
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
    /// it is too small for all sections, no line is omitted, because the user must scroll anyway.
    fn report_lines<'a>(
        &self,
        canvas: &Canvas<'_>,
        week_report: &WeekReport,
        context: &ScreenContext<'_>,
        width: u16,
        height: u16,
    ) -> (Vec<Line<'a>>, Vec<usize>) {
        let height = height as usize;
        let scrolls = height < MIN_HEIGHT_WITHOUT_SCROLLING;
        let is_complete = scrolls || height >= 26;
        let head = self.header_section(canvas, week_report, width, if is_complete { 4 } else { 1 });
        let needs = &context.company.action_items;
        let notices = &context.company.notices;
        let news = news_section(canvas, week_report, width, context);
        let decided = decisions_section(canvas, week_report, width, if is_complete { 6 } else { 2 });
        // `fixed` includes two headings and, in tall windows, the four blank lines between the five sections.
        let airy = height >= 24;
        let fixed = head.len() + decided.len() + news.len() + 2 + if airy { 4 } else { 0 };
        let room = if scrolls { MAX_SCROLLED_LINES } else { height.saturating_sub(fixed) };
        let shown_needs = needs.len().min((room / 5).max(1)).max(1);
        let coming =
            next_steps_section(canvas, &needs[..shown_needs.min(needs.len())], width, is_complete, context);
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
            news.into_iter().chain(notices_section(canvas, context.company, width, left.min(8))).collect(),
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
        let due = week_report.due_forecasts.iter().take(forecasts);
        lines.extend(due.flat_map(|due| {
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
        if week_report.moved_figures.is_empty() {
            return (vec![Line::from(canvas.span("  none", Role::Dim))], Vec::new());
        }
        let (mut lines, mut starts) = (Vec::new(), Vec::new());
        for (at, moved_figure) in week_report.moved_figures.iter().enumerate() {
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
    let all = week_report.moved_figures.len();
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
    moved_figure: &MovedFigure,
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
    let below = truncate_to_width(&summary, (width as usize).saturating_sub(6));
    vec![Line::from(line), Line::from(canvas.span(format!("      {below}"), Role::Dim))]
}

/// Lists the counts of new items, with the keys of the screens that show them.
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
    let found: Vec<_> = kinds.into_iter().filter(|(count, ..)| *count > 0).collect();
    let mut lines = vec![vec![canvas.span("New  ", Role::Header)]];
    let mut used = 5;
    for (at, (count, one, more, screen)) in found.iter().enumerate() {
        let dot = if at > 0 { " · " } else { "" };
        let text =
            format!("{dot}{} {}", grouped_number(f64::from(*count), 0), if *count == 1 { one } else { more });
        // Consecutive items of one screen share the key of that screen.
        let last = found.get(at + 1).is_none_or(|next| next.3 != *screen);
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

/// Lists the latest notifications that fit. Repeated notifications are combined with a count.
fn notices_section<'a>(
    canvas: &Canvas<'_>,
    company: &DisplayedCompany,
    width: u16,
    room: usize,
) -> SectionLines<'a> {
    let mut distinct_notices: Vec<(u32, String, u32)> = Vec::new();
    for (day, text) in company.notices.iter().rev() {
        match distinct_notices.iter().position(|(_, known, _)| known == text) {
            Some(at) => distinct_notices[at].2 += 1,
            None if distinct_notices.len() < room => distinct_notices.push((*day, text.clone(), 1)),
            None => {}
        }
    }
    let line = |(day, text, times): (u32, String, u32)| {
        let times = if times > 1 { format!(" ({times} times)") } else { String::new() };
        let before = format!("  day {day:<4} ");
        let left = usize::from(width).saturating_sub(before.len() + times.len());
        let text = company.company_names.insert_names(&text.split_whitespace().collect::<Vec<_>>().join(" "));
        Line::from(vec![
            canvas.span(before, Role::Dim),
            canvas.span(truncate_to_width(&text, left), Role::Text),
            canvas.span(times, Role::Dim),
        ])
    };
    distinct_notices.into_iter().rev().map(line).collect()
}

/// Lists action items in at most two rows each, and the key for the next step. Suggestions are included if there is
/// space.
fn next_steps_section<'a>(
    canvas: &Canvas<'_>,
    needs: &[ActionItem],
    width: u16,
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
        let text = format!("  nothing needs attention; {key} starts the next week");
        return vec![Line::from(canvas.span(text, Role::Dim))];
    }
    let lines = |need: &ActionItem| {
        let key =
            context.keys.label(item_screen(need).action()).map_or(String::new(), |key| format!(" [{key}]"));
        let (sign, role) = if need.is_urgent { ("!", Role::Warning) } else { ("·", Role::Text) };
        let room = (width as usize).saturating_sub(4 + key.width());
        let text = if roomy { need.describe() } else { need.text.clone() };
        let rows = wrap_sentences(&text, room, 2);
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
    use crate::dialogs::dialog_text;
    use crate::test_kit;
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
