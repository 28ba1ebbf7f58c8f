//! Draws the study pages of a participant.

use ratatui::layout::Rect;

use super::{StudyPage, StudyPageKind, WITHDRAW};
use crate::action::Action;
use crate::keys::KeyBindings;
use novamind_study::{CLOSE_WINDOW_NOTICE, DECLINED_NOTICE, RETURN_LATER_NOTICE};
use novamind_tui::canvas::{Canvas, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;

const MAX_PAGE_WIDTH: u16 = 84;

impl StudyPage {
    /// Draws the current page below the title of the study.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, keys: &KeyBindings) {
        let head = Rect { x: area.x + 2, width: area.width.saturating_sub(4), height: 1, ..area };
        canvas.draw_text(head, &self.title, Role::Title);
        let body = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        let key = |action: Action| keys.label(action).unwrap_or_default();
        if let StudyPageKind::Consent(text) = &self.kind {
            let agree = format!("{} I agree", key(Action::Agree));
            let decline = format!("{} I do not agree", key(Action::Decline));
            return text.draw(canvas, body, "Consent", &agree, &decline);
        }
        let (title, paragraphs) = self.title_and_text(&key);
        let width = MAX_PAGE_WIDTH.min(body.width);
        let mut lines: Vec<(String, Role)> = Vec::new();
        for (text, role) in paragraphs.into_iter().filter(|(text, _)| !text.is_empty()) {
            if !lines.is_empty() {
                lines.push((String::new(), Role::Text));
            }
            let texts = wrap(&text, width.saturating_sub(4) as usize);
            lines.extend(texts.into_iter().map(|line| (line, role)));
        }
        // In small windows, blank lines are omitted first.
        if lines.len() + 2 > body.height as usize {
            lines.retain(|(line, _)| !line.is_empty());
        }
        let page_area = centered_rect(body, width, (lines.len() as u16 + 6).max(9));
        let inside = canvas.draw_pane_frame(page_area, title, "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let text = Rect { y: inside.y + u16::from(inside.height > 10), ..inside }.intersection(inside);
        for (row, (line, role)) in row_rects(text).zip(&lines) {
            canvas.draw_text(row, line, *role);
        }
        let used = text.y - inside.y + lines.len() as u16 + 1;
        let below = Rect { y: inside.y + used, height: inside.height.saturating_sub(used), ..inside };
        self.draw_field(canvas, below);
        if let Some(problem) = &self.problem {
            let below = Rect { y: below.y + 2, height: below.height.saturating_sub(2), ..below };
            let lines = wrap(&format!("! {problem}"), below.width as usize);
            for (row, line) in row_rects(below).zip(lines) {
                canvas.draw_text(row, &line, Role::Bad);
            }
        }
    }

    fn draw_field(&self, canvas: &mut Canvas<'_>, below: Rect) {
        let row = Rect { width: 32.min(below.width), height: below.height.min(1), ..below };
        match &self.kind {
            StudyPageKind::Label(field, _) | StudyPageKind::Withdraw(Some(field)) => field.draw(canvas, row),
            StudyPageKind::Code(field) => field.masked().draw(canvas, row),
            _ => {}
        }
    }

    fn title_and_text(&self, key: &dyn Fn(Action) -> String) -> (&'static str, Vec<(String, Role)>) {
        let text = |words: &str| (words.to_owned(), Role::Text);
        let strong = |words: String| (words, Role::Strong);
        let go = key(Action::Continue);
        let experimenter = if self.is_hosted { "" } else { "Please tell the experimenter." };
        let next_person = strong(match self.is_hosted {
            true => format!("{CLOSE_WINDOW_NOTICE} {go} ends the session"),
            false => format!("{go} next participant"),
        });
        match &self.kind {
            StudyPageKind::Label(_, false) => (
                "Label",
                vec![
                    strong("Type the label that the experimenter gave you.".to_owned()),
                    text(&format!("To erase what you did in this study, type {WITHDRAW} instead.")),
                ],
            ),
            StudyPageKind::Label(_, true) => (
                "Withdraw",
                vec![strong("Type the label whose runs of this study are to be erased.".to_owned())],
            ),
            StudyPageKind::Code(_) => ("Experimenter", vec![strong("The experimenter's code:".to_owned())]),
            StudyPageKind::Loading | StudyPageKind::Consent(_) => ("", vec![text("Loading …")]),
            StudyPageKind::Practice { resumed, may_pass } => {
                let first = match resumed {
                    false => {
                        "First, run a practice company to learn the controls. The practice does not count."
                    }
                    true => "The practice continues where you left off. The practice does not count.",
                };
                let mut paragraphs = vec![text(first)];
                paragraphs.push(text(
                    "The practice ends automatically after its last day. The session then starts with a new company.",
                ));
                paragraphs.push(strong(format!("{go} starts the practice")));
                if *may_pass {
                    let pass = key(Action::SkipPractice);
                    paragraphs
                        .push(strong(format!("{pass} skips the practice and continues with the session")));
                }
                ("Practice", paragraphs)
            }
            StudyPageKind::Session { resumed } => {
                let first = match resumed {
                    false => "The session starts now.",
                    true => "The session continues where you left off.",
                };
                let kept = match self.is_hosted {
                    true => format!("Everything you confirm is saved. You can leave at any time. {RETURN_LATER_NOTICE}"),
                    false => {
                        "Everything you confirm is saved. You can leave at any time and continue later with your label."
                            .to_owned()
                    }
                };
                let palette = key(Action::Palette);
                let withdraw = format!(
                    "You can withdraw at any time ({palette} {}). Withdrawing erases everything you did in this study.",
                    Action::Withdraw.entry().title
                );
                let pause = format!(
                    "For a break, {} stops the clock: the screen is hidden, and the time does not count.{}",
                    key(Action::StopClock),
                    if self.has_limits { " If you only leave, the time limit continues." } else { "" }
                );
                let goes = strong(format!("{go} {}", if *resumed { "continues" } else { "starts" }));
                ("Session", vec![text(first), text(&kept), text(&pause), text(&withdraw), goes])
            }
            StudyPageKind::Left => (
                "Left",
                vec![
                    text(match self.is_hosted {
                        true => RETURN_LATER_NOTICE,
                        false => {
                            "Everything is saved. To continue later, return to this computer and enter your label again."
                        }
                    }),
                    next_person,
                ],
            ),
            StudyPageKind::Withdraw(None) => {
                let (yes, no) = (key(Action::Confirm), key(Action::Cancel));
                let erased =
                    "Withdrawing permanently erases everything you did in this study and cannot be undone.";
                (
                    "Withdraw",
                    vec![
                        text(erased),
                        strong(format!("{yes} withdraw, after one more question")),
                        strong(format!("{no} continue the study")),
                    ],
                )
            }
            StudyPageKind::Withdraw(Some(_)) => (
                "Withdraw",
                vec![strong(format!("Type {WITHDRAW} to erase everything you did in this study."))],
            ),
            StudyPageKind::Declined => {
                ("Not agreed", vec![text(DECLINED_NOTICE), text(experimenter), next_person])
            }
            StudyPageKind::Withdrawn(kept) => (
                "Withdrawn",
                vec![
                    text("You have withdrawn from this study."),
                    text(kept),
                    text(experimenter),
                    next_person,
                ],
            ),
            StudyPageKind::Thanks => (
                "Thank you",
                vec![
                    text(match self.is_hosted {
                        true => "Thank you for taking part.",
                        false => {
                            "Thank you for taking part. Everything has been saved. Please tell the experimenter that you have finished."
                        }
                    }),
                    next_person,
                ],
            ),
        }
    }
}
