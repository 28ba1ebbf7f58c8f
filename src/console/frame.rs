//! The frame of the console: header, screen and footer.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use unicode_width::UnicodeWidthStr;

use super::action::Action;
use super::app::{App, BusyState, Layer, Run, Stage};
use super::context::{ScreenContext, ScreenId};
use super::playback::EntryFilter;
use novamind_base::formatting::{compact_number, dollars, grouped_number, short_dollars};
use novamind_record::trajectory::record::RunEndReason;
use novamind_report::cash_before_purchases;
use novamind_session::TimeLeft;
use novamind_tui::ascii;
use novamind_tui::canvas::{Align, Canvas, Click, row_rects};
use novamind_tui::chord::format_sequence;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::text::{format_change, wrap};
use novamind_tui::theme::Role;
use novamind_tui::widgets::sparkline::bar;
use novamind_worker::company::DisplayedCompany;

/// Minimum window size in columns and rows.
pub const MIN_WINDOW: (u16, u16) = (60, 16);

/// Data of a drawn frame that the application needs to handle input.
pub struct DrawnFrame {
    /// Clickable areas of the frame.
    pub clicks: Vec<(Rect, Click)>,
    /// Position of the cursor.
    pub cursor: Option<Position>,
    /// Number of rows that the focused list showed.
    pub page_rows: u16,
    /// Columns and rows of the window.
    pub window: (u16, u16),
}

/// Draws a frame of the console into a buffer.
pub fn draw_frame(app: &App, buffer: &mut Buffer) -> DrawnFrame {
    let area = buffer.area;
    let mut canvas = Canvas::new(buffer, &app.theme);
    canvas.marker = app.glyphs.marker();
    canvas.empty_chart_text = super::context::NO_DATA;
    canvas.clear(area, Role::Text);
    if area.width < MIN_WINDOW.0 || area.height < MIN_WINDOW.1 {
        let text = format!(
            "NovaMind needs {}×{} or more; this is {}×{}",
            MIN_WINDOW.0, MIN_WINDOW.1, area.width, area.height
        );
        for (row, line) in row_rects(area).zip(wrap(&text, usize::from(area.width))) {
            canvas.draw_text(row, &line, Role::Warning);
        }
    } else {
        draw_stage(app, &mut canvas, area);
    }
    let drawn = DrawnFrame {
        clicks: std::mem::take(&mut canvas.clicks),
        cursor: canvas.cursor,
        page_rows: canvas.page_rows,
        window: (area.width, area.height),
    };
    if app.glyphs == Glyphs::Ascii {
        ascii::replace_non_ascii(buffer);
    }
    drawn
}

fn draw_stage(app: &App, canvas: &mut Canvas<'_>, area: Rect) {
    if let Some(cover) = &app.pause_screen {
        return cover.draw(&app.keys, canvas, area);
    }
    let last = Rect { y: area.bottom() - 1, height: 1, ..area };
    match &app.stage {
        Stage::Menu(menu) => menu.draw(canvas, Rect { height: area.height - 1, ..area }),
        Stage::Study(page) => page.draw(canvas, Rect { height: area.height - 1, ..area }, &app.keys),
        Stage::Run(run) => draw_run(app, run, canvas, area),
    }
    draw_footer(app, canvas, last);
    if !app.pending_chords.is_empty() {
        draw_pending_keys(app, canvas, Rect { height: area.height - 1, ..area });
    }
}

/// Lists the chords that can complete a key sequence, in the lower right corner.
fn draw_pending_keys(app: &App, canvas: &mut Canvas<'_>, area: Rect) {
    let following = app.keys.completions(&app.scopes(), &app.pending_chords);
    if following.is_empty() {
        return;
    }
    let keys = following.iter().map(|(keys, _)| keys.width()).max().unwrap_or(0) as u16;
    let titles = following.iter().map(|(_, action)| action.entry().title.width()).max().unwrap_or(0) as u16;
    let (width, height) = ((keys + titles + 7).max(20), following.len() as u16 + 2);
    let (width, height) = (width.min(area.width), height.min(area.height));
    let pane_area = Rect { x: area.right() - width, y: area.bottom() - height, width, height };
    canvas.clear(pane_area, Role::Text);
    let inside =
        canvas.draw_pane_frame(pane_area, &format!("{} …", format_sequence(&app.pending_chords)), "", true);
    for (row, (chords, action)) in row_rects(inside).zip(following) {
        canvas.draw_text(Rect { x: row.x + 1, width: keys, ..row }, &chords, Role::Key);
        let title = Rect { x: row.x + keys + 3, width: row.width.saturating_sub(keys + 3), ..row };
        canvas.draw_text(title, action.entry().title, Role::Text);
        canvas.register_click(row, Click::Command(action.into()));
    }
    canvas.draw_pane_keys(pane_area, "esc cancel");
}

fn draw_run(app: &App, run: &Run, canvas: &mut Canvas<'_>, area: Rect) {
    if let (true, Some(viewer)) = (app.is_projected, &run.playback) {
        let context = ScreenContext { company: &run.company, keys: &app.keys, page_rows: app.page_rows };
        let body = Rect { height: area.height - 1, ..area };
        super::projector::draw(canvas, body, viewer, &context);
        return draw_layers(app, run, canvas, body, &context);
    }
    draw_header(app, canvas, Rect { height: 1, ..area }, &run.company);
    draw_tabs(app, run, canvas, Rect { y: area.y + 1, height: 1, ..area });
    let banner = u16::from(run.database_error.is_some());
    if run.database_error.is_some() {
        draw_database_warning(canvas, Rect { y: area.y + 2, height: 1, ..area }, run);
    }
    let warned = draw_time_limit(app, canvas, Rect { y: area.y + 2 + banner, height: 2, ..area });
    let banner = banner + warned;
    let body = Rect { y: area.y + 2 + banner, height: area.height - 3 - banner, ..area };
    let tour = run.tour.as_ref().map(|tour| (tour, tour.height(area.width)));
    let strip = u16::from(run.playback.is_some());
    let below = tour.as_ref().map_or(0, |(_, height)| *height) + strip;
    let body = Rect { height: body.height.saturating_sub(below), ..body };
    let screen_context = ScreenContext { company: &run.company, keys: &app.keys, page_rows: app.page_rows };
    canvas.zoomed = run.zoomed;
    let decisions_width =
        run.playback.as_ref().filter(|_| !run.zoomed).map_or(0, |viewer| viewer.columns(body));
    let lesson = run.side_task(area.width);
    let decisions_width = if lesson.is_some() { super::lesson::TASK_WIDTH } else { decisions_width };
    let screen = Rect { width: body.width - decisions_width, ..body };
    canvas.stale = is_stale(run);
    canvas.breadcrumbs = run.breadcrumb_titles(&screen_context);
    run.screens.get(run.screen).draw(canvas, screen, &screen_context);
    canvas.stale = false;
    canvas.breadcrumbs.clear();
    if let Some(page) = lesson {
        super::lesson::draw_side_task(
            canvas,
            Rect { x: screen.right(), width: decisions_width, ..body },
            page,
            &screen_context,
        );
    }
    if let Some(viewer) = &run.playback {
        // A list in the side pane must not change the page size.
        let page = canvas.page_rows;
        if decisions_width > 0 {
            let decisions_area = Rect { x: screen.right(), width: decisions_width, ..body };
            viewer.draw_decisions(canvas, decisions_area, &screen_context, EntryFilter::All);
        }
        canvas.page_rows = page;
        viewer.draw_status_line(canvas, Rect { y: body.bottom(), height: 1, ..area });
    }
    draw_layers(app, run, canvas, body, &screen_context);
    if let Some((tour, height)) = tour {
        tour.draw(canvas, Rect { y: body.bottom(), height, ..area });
    }
}

fn draw_layers(app: &App, run: &Run, canvas: &mut Canvas<'_>, body: Rect, context: &ScreenContext<'_>) {
    for layer in app.layers.iter() {
        // The screen below a dialog is visible but not clickable.
        canvas.clicks.clear();
        canvas.cursor = None;
        match layer {
            Layer::NextWeek => super::dialogs::Dialog::draw(&run.next_week, canvas, body, context),
            Layer::Dialog(dialog) => dialog.draw(canvas, body, context),
        }
    }
}

/// Returns whether the screen shows data from before the database fell behind.
fn is_stale(run: &Run) -> bool {
    run.database_error.is_some()
        && (run.screen == ScreenId::Sql || !run.screens.get(run.screen).screen_queries().is_empty())
}

fn draw_database_warning(canvas: &mut Canvas<'_>, row: Rect, run: &Run) {
    let here = if is_stale(run) { "Panes marked stale show older figures; the update" } else { "The update" };
    let problem = run.database_error.as_deref().unwrap_or_default();
    let text = format!(" ! The database is behind: {problem}. {here} is retried every few seconds.");
    canvas.clear(row, Role::Bad);
    canvas.draw_text(row, &text, Role::Bad);
}

/// Draws the time limit notice at the top of the window. Returns the number of rows used.
fn draw_time_limit(app: &App, canvas: &mut Canvas<'_>, area: Rect) -> u16 {
    let Some(text) = app.limit_notice() else { return 0 };
    let lines = wrap(&text, usize::from(area.width.saturating_sub(4)));
    let taken = (lines.len() as u16).min(area.height);
    for (at, (row, line)) in row_rects(area).zip(lines).enumerate() {
        let sign = if at == 0 { "!" } else { " " };
        canvas.clear(row, Role::Warning);
        canvas.draw_text(row, &format!(" {sign} {line}"), Role::Warning);
    }
    taken
}

fn draw_header(app: &App, canvas: &mut Canvas<'_>, row: Rect, company: &DisplayedCompany) {
    let seen = &company.observation;
    let change = seen.cash_change;
    let runway = match (seen.ended, seen.runway.describe_weeks()) {
        (Some(_), _) => String::new(),
        (None, Some(weeks)) => format!("   runway {weeks} wk"),
        (None, None) => "   runway to end".to_owned(),
    };
    let poor = seen.runway_weeks.is_some_and(|weeks| weeks < 8.0);
    let wide = row.width >= 110;
    let money = |value: f64| if wide { dollars(value) } else { short_dollars(value) };
    let count = |value: u32| {
        if wide { grouped_number(f64::from(value), 0) } else { compact_number(f64::from(value)) }
    };
    // Purchases on the same day are not part of the change over the last week.
    let moved = match cash_before_purchases(seen) {
        None => format!(" {}", format_change(change, &money(change.abs()))),
        Some(_) if wide && seen.day > 0 => {
            format!(" {} last week", format_change(change, &money(change.abs())))
        }
        Some(_) => String::new(),
    };
    let pieces = [
        (" NovaMind".to_owned(), Role::Title),
        (format!("  day {}/{}", seen.day, seen.last_day), Role::Text),
        (format!(" · wk {}/{}", seen.week, seen.last_day.div_ceil(7)), Role::Text),
        (format!("   cash {}", money(seen.cash)), if poor { Role::Warning } else { Role::Strong }),
        (moved, if change < 0.0 { Role::Bad } else { Role::Good }),
        (runway, if poor { Role::Warning } else { Role::Text }),
        (format!("   subs {}", count(seen.subscribers)), Role::Text),
        (format!("   seats {}", count(seen.seats)), Role::Text),
    ];
    let hides_result = company.rules.hides_result(seen.ended.is_some());
    let state = match seen.ended {
        _ if hides_result => "OVER".to_owned(),
        _ if company.is_playback => "REPLAY".to_owned(),
        None => match &company.study {
            Some(study) => if study.practice { "PRACTICE" } else { "SESSION" }.to_owned(),
            None => seen.mode.id().to_uppercase(),
        },
        Some(RunEndReason::Horizon) => "FINISHED".to_owned(),
        Some(RunEndReason::Bankruptcy) => "BANKRUPT".to_owned(),
        Some(RunEndReason::Abandoned) => "GIVEN UP".to_owned(),
        Some(RunEndReason::Lesson) => "LESSON ENDED".to_owned(),
    };
    let state = format!("{}{state} ", time_left_label(app));
    let width = (state.width() as u16).min(row.width);
    let mut left = Rect { width: row.width - width, ..row };
    // If the result is hidden, the header ends with the day.
    let shown = if hides_result { 3 } else { pieces.len() };
    let dropped = pieces_before_subscribers(&pieces.each_ref().map(|(piece, _)| piece.as_str()), left.width);
    for (at, (piece, role)) in pieces.into_iter().enumerate().take(shown) {
        if !hides_result && dropped.contains(&at) {
            continue;
        }
        // A figure that does not fit is omitted, because a truncated figure would be wrong.
        let taken = piece.width() as u16;
        if taken + 1 > left.width {
            break;
        }
        canvas.draw_text(left, &piece, role);
        left = Rect { x: left.x + taken, width: left.width - taken, ..left };
    }
    canvas.draw_aligned(Rect { x: row.right() - width, width, ..row }, &state, Role::Title, Align::Right);
}

/// Indexes of the pieces of the header that are less important than the number of subscribers, in the order in which
/// they are dropped: the name of the program and the change in cash.
const DROPPED_PIECES: [usize; 2] = [0, 4];
/// Index of the number of subscribers.
const SUBSCRIBERS_PIECE: usize = 6;

/// Returns the pieces of the header that are omitted, so that the number of subscribers fits.
fn pieces_before_subscribers(pieces: &[&str], width: u16) -> &'static [usize] {
    let fits = |dropped: &&[usize]| {
        let kept = (0..=SUBSCRIBERS_PIECE).filter(|at| !dropped.contains(at));
        kept.map(|at| pieces[at].width()).sum::<usize>() < usize::from(width)
    };
    let choices = [&DROPPED_PIECES[..0], &DROPPED_PIECES[..1], &DROPPED_PIECES[..]];
    choices.into_iter().find(fits).unwrap_or(&DROPPED_PIECES)
}

/// Returns a label with the remaining time until the next time limit.
fn time_left_label(app: &App) -> String {
    let running = app.run().filter(|run| run.company.is_running());
    let left = running.map_or(&[][..], |run| run.time_left.as_slice());
    let minutes = left.iter().map(TimeLeft::whole_minutes).min();
    minutes.map_or(String::new(), |minutes| format!("{} min left · ", minutes.max(0)))
}

/// Formats a tab from the key, title and badge of a screen, and a flag for the current screen.
type TabFormat = fn(&str, &str, &str, bool) -> String;

fn draw_tabs(app: &App, run: &Run, canvas: &mut Canvas<'_>, row: Rect) {
    // The first format in which every tab fits is used, otherwise the last format. In the narrowest windows, only the
    // tab of the current screen shows a title.
    let tab_formats: [TabFormat; 8] = [
        |key, title, badge, _| format!(" {key} {title}{badge} "),
        |key, title, badge, _| format!(" {key} {title}{badge}"),
        |key, title, badge, _| format!(" {key} {}{badge}", short_title(title)),
        |key, title, badge, _| format!(" {key} {}{}", short_title(title), badge.trim()),
        |key, title, badge, _| format!(" {key} {:.4}{}", short_title(title), badge.trim()),
        |key, title, badge, _| format!(" {key} {:.3}{}", short_title(title), badge.trim()),
        |key, title, badge, _| {
            format!(" {key} {}{}", short_title(title), badge.trim().get(.."●".len()).unwrap_or_default())
        },
        |key, title, badge, here| {
            if here { format!(" {key} {title} ") } else { format!(" {key}{}", badge.trim()) }
        },
    ];
    let is_shown = |screen: &ScreenId| screen.is_available_in(&run.company);
    let all: Vec<ScreenId> = ScreenId::ALL.into_iter().filter(is_shown).collect();
    // If no format fits all tabs, the X-ray tab is omitted, unless the X-ray screen is shown.
    let others = |screen: &ScreenId| *screen != ScreenId::Xray || run.screen == ScreenId::Xray;
    let fewer: Vec<ScreenId> = all.iter().copied().filter(others).collect();
    let texts = |screens: &[ScreenId], tab_format: &TabFormat| {
        let text = |screen: &ScreenId| {
            let key = app.keys.label(screen.action()).unwrap_or_default();
            tab_format(&key, screen.action().entry().title, &tab_badge(run, *screen), *screen == run.screen)
        };
        screens.iter().map(|screen| (*screen, text(screen))).collect::<Vec<(ScreenId, String)>>()
    };
    let fits = |texts: &Vec<(ScreenId, String)>| {
        texts.iter().map(|(_, text)| text.width()).sum::<usize>() <= row.width as usize
    };
    let named = |screens| tab_formats[..7].iter().map(move |tab_format| texts(screens, tab_format));
    let fitting = named(&all).chain(named(&fewer)).find(fits).unwrap_or_else(|| texts(&all, &tab_formats[7]));
    let mut x = row.x;
    for (screen, text) in fitting {
        let width = text.width() as u16;
        if x + width > row.right() {
            break;
        }
        let place = Rect { x, width, ..row };
        canvas.draw_text(place, &text, if screen == run.screen { Role::ActiveTab } else { Role::Tab });
        canvas.register_click(place, Click::Command(screen.action().into()));
        x += width;
    }
    if run.zoomed {
        let key = app.keys.label(Action::Zoom).unwrap_or_default();
        let text = format!("{key} all panes ");
        let left = Rect { x, width: row.right() - x, ..row };
        if text.width() <= left.width as usize {
            canvas.draw_aligned(left, &text, Role::Warning, Align::Right);
        }
    }
}

fn short_title(title: &str) -> &str {
    match title {
        "Overview" => "Over",
        "Customers" => "Cust",
        "Product" => "Prod",
        "Journal" => "Jour",
        other => other,
    }
}

fn tab_badge(run: &Run, screen: ScreenId) -> String {
    let count = match screen {
        ScreenId::Product => run.company.observation.running_research as usize,
        ScreenId::Inbox => run.company.observation.waiting.len(),
        ScreenId::Tools => run.company.observation.changes.len(),
        // Items that arrive on the current screen are not new.
        _ if screen == run.screen => 0,
        _ => run.screens.get(screen).unseen_count(),
    };
    if count > 0 { format!(" ●{count}") } else { String::new() }
}

/// Maximum number of rows of a message.
const MAX_MESSAGE_ROWS: usize = 4;

/// Label of the footer while keys type characters.
const EDIT_MODE: &str = " EDIT ";

fn draw_footer(app: &App, canvas: &mut Canvas<'_>, row: Rect) {
    let right = match (&app.busy, &app.status) {
        // The error explains that an action was rejected because a script is running.
        (Some(busy), Some(note)) if busy.is_script() && note.is_error => {
            Some((format!("! {}", note.text), Role::Bad))
        }
        (Some(busy), _) => {
            let stop = app.keys.label(Action::Close).unwrap_or_default();
            Some((progress_text(busy, row.width, &stop), Role::Warning))
        }
        (None, Some(note)) if note.is_error => Some((format!("! {}", note.text), Role::Bad)),
        (None, Some(note)) => Some((note.text.clone(), Role::Good)),
        (None, None) => None,
    };
    if let Some((text, role)) = &right
        && text.width() as u16 + 2 > row.width
    {
        // The tour above the footer names the next keys, so it stays visible.
        let tour = app.run().and_then(|run| run.tour.as_ref()).map_or(0, |tour| tour.height(row.width));
        let last = Rect { y: row.y.saturating_sub(tour), ..row };
        draw_long_message(canvas, last, text, *role);
        if tour == 0 {
            return;
        }
    }
    let right = right.filter(|(text, _)| text.width() as u16 + 2 <= row.width);
    // A message has two spaces before it and one space after it.
    let taken = right.as_ref().map_or(0, |(text, _)| text.width() as u16 + 3).min(row.width);
    let mut x = row.x + 1;
    if app.is_editing_text() {
        canvas.draw_text(
            Rect { x: row.x, width: EDIT_MODE.width() as u16, ..row },
            EDIT_MODE,
            Role::ActiveTab,
        );
        x += EDIT_MODE.width() as u16;
    }
    let mut actions = footer_actions(app).into_iter().peekable();
    while let Some(action) = actions.next() {
        let Some(mut key) = app.keys.label(action) else { continue };
        // One arrow key is labeled with the title of its action. A pair of arrow keys is labeled "choose".
        let mut title = Some(action_title(app, action)).filter(|title| *title != key).unwrap_or_default();
        if action == Action::Left && actions.next_if_eq(&Action::Right).is_some() {
            key = format!("{key} {}", app.keys.label(Action::Right).unwrap_or_default());
            title = "choose";
        }
        let width = (key.width() + usize::from(!title.is_empty()) + title.width()) as u16;
        if x + width + taken > row.right() {
            break;
        }
        canvas.draw_text(Rect { x, width: key.width() as u16, ..row }, &key, Role::Key);
        let after = Rect { x: x + key.width() as u16 + 1, width: title.width() as u16, ..row };
        canvas.draw_text(after, title, Role::Dim);
        canvas.register_click(Rect { x, width, ..row }, Click::Command(action.into()));
        x += width + 3;
    }
    if let Some((text, role)) = right {
        let place = Rect { x: row.right() - taken + 2.min(taken), width: taken.saturating_sub(2), ..row };
        canvas.draw_text(place, &text, role);
    }
}

/// Draws a message that is wider than the window into a row and the rows above it, so that its end, which usually names
/// the next step, is visible.
fn draw_long_message(canvas: &mut Canvas<'_>, last: Rect, text: &str, role: Role) {
    let mut lines = wrap(text, usize::from(last.width.saturating_sub(2)));
    if lines.len() > MAX_MESSAGE_ROWS {
        let rest = lines.split_off(MAX_MESSAGE_ROWS - 1).join(" ");
        lines.push(rest);
    }
    let height = (lines.len() as u16).min(last.bottom());
    let area = Rect { y: last.bottom() - height, height, ..last };
    canvas.clear(area, Role::Text);
    for (row, line) in row_rects(area).zip(&lines) {
        canvas.draw_text(Rect { x: row.x + 1, width: row.width.saturating_sub(2), ..row }, line, role);
    }
}

/// Returns the title of an action in the current state. After the end of a run, the next-week key opens the final
/// page. After the end of a lesson, the key opens the next part or the debrief.
fn action_title(app: &App, action: Action) -> &'static str {
    match app.run() {
        Some(run) if action == Action::NextWeek && !run.company.is_running() => match &run.company.lesson {
            Some(page) if page.next_part.is_some() => "next part",
            Some(_) => "debrief",
            None => "final page",
        },
        // In a form, the enter key also moves to the next row.
        Some(run) if action == Action::Commit && run.screen == ScreenId::Tools && app.layers.is_empty() => {
            match app.hints().contains(&Action::Apply) {
                true => "accept, next row",
                false => action.entry().title,
            }
        }
        _ => action.entry().title,
    }
}

/// Returns the actions for the footer: the actions of the focused pane or dialog, followed by general actions.
fn footer_actions(app: &App) -> Vec<Action> {
    let mut actions = app.hints();
    if app.layers.is_empty() && matches!(app.stage, Stage::Run(_)) {
        let always = [
            Action::NextWeek,
            Action::Palette,
            Action::Help,
            Action::FocusNext,
            Action::Changes,
            Action::Quit,
        ];
        let player_actions = [Action::NextWeek, Action::Changes];
        let replay = app.run().is_some_and(|run| run.playback.is_some());
        let over = app.run().is_some_and(|run| !run.company.is_running());
        let left_out = |action: &Action| match action {
            Action::Changes if over => true,
            action => replay && player_actions.contains(action),
        };
        let end_actions = [Action::Report, Action::Branches].into_iter().filter(|_| over && !replay);
        let always = always.into_iter().filter(|action| !left_out(action)).chain(end_actions);
        if app.external_editor_rejection().is_none() && app.is_editing_text() {
            actions.push(Action::ExternalEditor);
        }
        if !app.is_editing_text() {
            let screen_actions = actions.clone();
            actions.extend(always.filter(|action| !screen_actions.contains(action)));
        }
    }
    actions.retain(|action| app.keys.is_available(*action));
    actions
}

/// Describes running work and its progress, with figures in wide windows. While a script runs, the text names the key
/// that stops the script.
fn progress_text(busy: &BusyState, width: u16, stop: &str) -> String {
    let seconds = busy.started_at.elapsed().as_secs_f64();
    let Some(days) = busy.progress else {
        return match busy.is_script() {
            true => format!("{} {seconds:.0} s · {stop} stops it", busy.label),
            false => format!("{} …", busy.label),
        };
    };
    let (done, all) = (days.current.saturating_sub(days.from), days.to.saturating_sub(days.from).max(1));
    let gauge = bar(f64::from(done) / f64::from(all), 10);
    let figures_text = days.figures.filter(|_| width >= 80).map_or(String::new(), |simulated_day| {
        format!(
            " cash {} · subs {}",
            short_dollars(simulated_day.cash),
            compact_number(f64::from(simulated_day.subscribers))
        )
    });
    format!("{} day {done} of {all} {gauge}{figures_text} {seconds:.1} s", busy.label)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::SimulationProgress;
    use novamind_worker::message::SimulatedDay;

    #[test]
    fn header_drops_the_name_and_the_cash_change_before_the_week() {
        let pieces = [
            " NovaMind",
            "  day 46/500",
            " · wk 7/72",
            "   cash $1.23M",
            " +$12.3k",
            "   runway to end",
            "   subs 1.2k",
        ];
        let dropped = |width| pieces_before_subscribers(&pieces, width);
        assert_eq!(dropped(120), [0; 0]);
        assert_eq!(dropped(80), [0]);
        assert_eq!(dropped(70), [0, 4]);
    }

    #[test]
    fn progress_text_counts_simulated_days() {
        let simulated_day = Some(SimulatedDay { cash: 1_234_567.0, subscribers: 12_345 });
        let days = SimulationProgress { from: 70, to: 77, current: 73, figures: simulated_day };
        let busy = |days| BusyState { progress: Some(days), ..BusyState::new("the week runs") };
        let text = progress_text(&busy(days), 80, "esc");
        assert!(text.starts_with("the week runs day 3 of 7 "), "{text}");
        assert!(text.contains(" cash $1.23M · subs 12.3k "), "{text}");
        assert!(text.width() < 76, "{text}");
        assert!(!progress_text(&busy(days), 60, "esc").contains("cash"));
        // Figures are shown once the first day is simulated.
        let started = progress_text(&busy(SimulationProgress::new(70, 77)), 120, "esc");
        assert!(started.contains("day 0 of 7") && !started.contains("cash"), "{started}");
        // The last week of a run is shorter.
        assert!(
            progress_text(
                &busy(SimulationProgress { current: 500, ..SimulationProgress::new(497, 500) }),
                80,
                "esc"
            )
            .contains("day 3 of 3")
        );
    }
}
