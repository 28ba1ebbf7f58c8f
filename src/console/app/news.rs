//! Responses of the worker.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::lesson::LessonView;
use super::{App, Layer, Order, Run, Stage};
use crate::action::Action;
use crate::context::{Look, ScreenId};
use crate::dialogs::filing::FilingDialog;
use crate::dialogs::final_page::FinalPage;
use crate::dialogs::report::Report;
use crate::effect::Effect;
use crate::screens::Screens;
use crate::tour::Tour;
use crate::viewer::Viewer;
use novamind_base::notation::{dollars, signed_dollars};
use novamind_course::CollectedClass;
use novamind_report::Story;
use novamind_report::class::Shown;
use novamind_session::{Change, Week};
use novamind_tools::Refusal;
use novamind_tui::text::number;
use novamind_worker::asking::Pending;
use novamind_worker::company::Company;
use novamind_worker::message::{DaysRan, Instead, News};
use novamind_worker::request::Request;

impl App {
    pub(super) fn news(&mut self, news: News) {
        match news {
            News::Runs(done, list) => {
                match done {
                    Some(Ok(text)) => self.say(text),
                    Some(Err(problem)) => self.complain(problem),
                    None => {}
                }
                if let Stage::Menu(menu) = &mut self.stage {
                    let effects = menu.take(list);
                    self.follow(effects);
                }
            }
            News::Class(read) => self.class_was_read(*read),
            News::HandedOut(label) => self.again = as_student(&self.again, &label),
            News::Opened(company) => self.opened(company, None),
            News::Replays(company, place) => self.opened(company, Some(Viewer::new(*place))),
            News::Changed(company) => self.changed(company),
            News::SeekResult(arrival) => self.arrived(*arrival, true),
            News::WentOn(arrival) => self.arrived(*arrival, false),
            News::NotOpened(problem, instead) => {
                (self.busy, self.opens_on) = (None, None);
                self.tour_planned = false;
                let asked = matches!(instead, Some(Instead::Agree(..)));
                if let Stage::Menu(menu) = &mut self.stage {
                    menu.refused(problem.clone(), instead);
                }
                if !asked && !self.complain_on_page(problem.clone()) {
                    self.complain(problem);
                }
            }
            News::Day(day, told) => {
                if let Some(days) = self.busy.as_mut().and_then(|busy| busy.days.as_mut()) {
                    (days.now, days.told) = (day, told);
                }
            }
            News::Advanced(week, company) => self.advanced(week, company),
            News::Ran(ran, company) => self.ran(ran, company),
            News::Closed(problem) => self.closed(problem),
            News::Crashed(words) => {
                let saved = self.run().map_or(String::new(), |run| match &run.company.folder {
                    Some(folder) => format!(" All confirmed actions are saved in {}.", folder.display()),
                    None => String::new(),
                });
                let text = format!("internal error: {words}.{saved} Resume with `{}`.", self.again);
                self.orders.push(Order::Exit(1, Some(text)));
            }
            News::RecordLost(words) => self.orders.push(Order::Exit(3, Some(words))),
            News::QuerySaved(Ok((text, library))) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.screens.sql.learn(library.clone());
                }
                self.library = library;
                self.say(text);
            }
            News::TimeLeft(left) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.time_left = left;
                }
            }
            News::Limit(limit) => self.reach_limit(&limit),
            News::Held => self.hold_limit(),
            News::Unsent(texts) => self.offer_texts(*texts),
            News::QuerySaved(Err(problem)) => self.complain(problem),
            News::DatabaseBehind(problem) => {
                if let Stage::Run(run) = &mut self.stage {
                    run.behind = Some(problem);
                }
            }
            News::DatabaseWhole => self.database_whole(),
            News::MemoKept(kept, company) => {
                match kept {
                    Ok(()) => self.say("notes saved"),
                    Err(refusal) => self.complain(refusal.to_string()),
                }
                self.changed(company);
            }
            News::Told(story) => self.told(&story),
            News::Reported(files) => {
                self.write(files.into_iter().map(|(name, text)| (name, text.into_bytes())).collect());
            }
            News::InLesson(refused, company) => self.heard_in_lesson(refused, company),
            News::Debriefed(found) => self.debriefed(found),
            News::Written(Ok(text)) => self.say(text),
            News::Written(Err(problem)) => self.complain(problem),
            News::Visit(news) => self.visited(news),
            other => self.heard(other),
        }
    }

    fn heard(&mut self, news: News) {
        if !matches!(self.stage, Stage::Run(_)) {
            return;
        }
        let screen = match &news {
            News::Called(tool, answer, company) => {
                // The saving label stays if the run was left in the meantime.
                self.busy = self.busy.take().filter(|busy| !busy.is_script());
                self.changed(company.clone());
                match answer {
                    Ok(_) => self.say(format!("{tool}: done")),
                    Err(refusal) => self.complain(format!("{tool}: {refusal}")),
                }
                ScreenId::Tools
            }
            News::Restored(what, changes, company) => {
                self.changed(company.clone());
                match changes {
                    Ok(changes) => self.say(format!("{what}: {}", in_words(changes))),
                    Err(refusal) => self.complain(refusal.message.clone()),
                }
                ScreenId::Tools
            }
            _ => return,
        };
        self.tell_screens(|screens, here, look| {
            let mut effects = screens.get_mut(screen).hear(&news, look);
            if matches!(news, News::Called(..)) && here != screen {
                effects.extend(screens.get_mut(here).hear(&news, look));
            }
            effects
        });
    }

    /// Updates screens and follows the effects that they return.
    fn tell_screens(&mut self, tell: impl FnOnce(&mut Screens, ScreenId, &Look<'_>) -> Vec<Effect>) {
        let Stage::Run(run) = &mut self.stage else { return };
        let company = run.company.clone();
        let look = Look { company: &company, keys: &self.keys, page: self.page };
        let focus = run.screens.get(run.here).focus();
        let effects = tell(&mut run.screens, run.here, &look);
        // A zoomed pane keeps the focus: it shows the answer.
        if run.zoomed && run.screens.get(run.here).focus() != focus {
            run.screens.get_mut(run.here).set_focus(focus);
        }
        self.follow(effects);
    }

    pub(super) fn take_answers(&mut self) {
        if let Stage::Menu(menu) = &mut self.stage {
            menu.take_answers();
        }
        self.tell_screens(|screens, _, look| {
            let take = |id| screens.get_mut(id).take_answers(look);
            ScreenId::ALL.into_iter().flat_map(take).collect()
        });
        for layer in self.layers.iter_mut() {
            if let Layer::Dialog(dialog) = layer {
                dialog.take_answers();
            }
        }
        self.note_step();
        self.take_readings();
        self.take_hidden_values();
    }

    /// Hands query results to the screens. When a screen is complete, playback may request its next week.
    fn take_readings(&mut self) {
        let Stage::Run(run) = &mut self.stage else { return };
        let answers: Vec<_> = run.asked.values_mut().filter_map(Pending::try_take).collect();
        for (reading, answer) in answers {
            match answer {
                Ok(rows) => self.tell_screens(|screens, _, look| {
                    for id in ScreenId::ALL {
                        let screen = screens.get_mut(id);
                        if screen.readings().contains(&reading) {
                            screen.take(reading, &rows, look);
                        }
                    }
                    Vec::new()
                }),
                Err(refusal) => self.complain(refusal.to_string()),
            }
            self.play_on();
        }
    }

    fn opened(&mut self, company: Arc<Company>, viewer: Option<Viewer>) {
        self.busy = None;
        // After taking over a playback, the user stays on the current screen.
        let here = self.run().filter(|run| run.viewer.is_some()).map_or(ScreenId::Overview, |run| run.here);
        let here = self.opens_on.take().filter(|screen| screen.is_shown_in(&company)).unwrap_or(here);
        self.close_layers();
        let over = !company.is_running() && viewer.is_none();
        let tour = std::mem::take(&mut self.tour_planned).then(Tour::default);
        match company.remarks.last() {
            _ if viewer.is_some() => {
                let help = self.keys.label(Action::Help).unwrap_or_default();
                self.say(format!("replay, read-only; {help} shows the keys"));
            }
            Some(remark) => self.say(remark.clone()),
            None if company.lesson.is_some() => {
                let key = |action| self.keys.label(action).unwrap_or_default();
                let (task, week) = (key(Action::LessonPage), key(Action::NextWeek));
                self.say(format!("{task} shows the task, {week} runs a week"));
            }
            None if company.seen.day == 0 => {
                self.say("a new company: 8 shows the forms, n runs a week, ? explains the keys")
            }
            None => self.say(format!("day {}: welcome back", company.seen.day)),
        }
        self.stage = Stage::Run(Box::new(Run {
            company: company.clone(),
            here,
            before: Vec::new(),
            trail: Vec::new(),
            after: Vec::new(),
            zoomed: false,
            shown: Some(self.stopwatch.now()),
            came_from: None,
            selected: None,
            screens: Screens::default(),
            filing: FilingDialog::default(),
            story: None,
            asked: BTreeMap::new(),
            tour,
            viewer,
            lesson: LessonView::default(),
            overlay: Default::default(),
            time_left: Vec::new(),
            behind: None,
        }));
        if let Stage::Run(run) = &mut self.stage {
            run.screens.sql.learn(self.library.clone());
        }
        self.forget_texts();
        self.limit = super::limits::LimitTold::default();
        self.take_up();
        self.renew();
        // In a study, the final questions come first.
        if over && !self.leads_participant() {
            self.show_end();
        }
        self.open_lesson();
    }

    /// Shows the final page. Figures from the ledger follow when it was read.
    pub(super) fn show_end(&mut self) {
        if self.ends_lesson() {
            return;
        }
        let Stage::Run(run) = &self.stage else { return };
        let story = run.story.clone();
        if story.is_none() {
            self.follow(vec![Effect::Request(Request::TellStory)]);
        }
        let page = FinalPage::new(story);
        let page = if self.leads_participant() { page.leading_on() } else { page };
        self.lay(Layer::Dialog(Box::new(page)));
    }

    fn told(&mut self, story: &Arc<Story>) {
        if let Stage::Run(run) = &mut self.stage {
            run.story = Some(story.clone());
        }
        for layer in self.layers.iter_mut() {
            if let Layer::Dialog(dialog) = layer {
                dialog.take_story(story);
            }
        }
    }

    pub(super) fn changed(&mut self, company: Arc<Company>) {
        if let Stage::Run(run) = &mut self.stage {
            run.take_company(company);
            run.asked.clear();
        }
        self.renew();
    }

    fn database_whole(&mut self) {
        if let Stage::Run(run) = &mut self.stage {
            run.behind = None;
            run.asked.clear();
        }
        self.say("the database is up to date again");
        self.load();
    }

    pub(super) fn renew(&mut self) {
        if let Stage::Run(run) = &mut self.stage {
            let company = run.company.clone();
            let look = Look { company: &company, keys: &self.keys, page: self.page };
            for id in ScreenId::ALL {
                run.screens.get_mut(id).renew(&look);
            }
        }
        self.load();
    }

    fn advanced(&mut self, week: Result<Box<Week>, Refusal>, company: Arc<Company>) {
        self.busy = None;
        let now = self.stopwatch.now();
        let before = self.run().and_then(|run| run.company.lesson.clone());
        if let Stage::Run(run) = &mut self.stage {
            run.look_again(now);
        }
        self.changed(company);
        let week = match week {
            Ok(week) => week,
            Err(refusal) => {
                let text = refusal.to_string();
                if let Stage::Run(run) = &mut self.stage {
                    run.filing.refused(text.clone());
                    self.lay(Layer::Filing);
                }
                return self.complain(text);
            }
        };
        let figures = &week.figures;
        let text = format!(
            "day {}: cash {} ({})",
            figures.day,
            dollars(figures.cash),
            signed_dollars(figures.cash_change)
        );
        if let Stage::Run(run) = &mut self.stage {
            run.filing = FilingDialog::default();
        }
        let ended = week.ended;
        let unfiled = self.end_limit_of_week();
        let remark = [unfiled, week.remark].into_iter().flatten().collect::<Vec<_>>().join(" ");
        let hides_result = self.run().is_some_and(|run| run.company.rules.hide_result(ended.is_some()));
        self.say(if hides_result { "the run has ended".to_owned() } else { text });
        match ended {
            Some(_) => self.show_end(),
            None if self.tells_week_of_lesson(before.as_ref()) => {}
            None => {
                let remark = (!remark.is_empty()).then_some(remark);
                self.lay(Layer::Dialog(Box::new(Report::new(remark))));
            }
        }
    }
}

impl App {
    fn ran(&mut self, ran: Result<DaysRan, Refusal>, company: Arc<Company>) {
        self.busy = None;
        let now = self.stopwatch.now();
        if let Stage::Run(run) = &mut self.stage {
            run.look_again(now);
            if let Ok(ran) = &ran {
                run.screens.xray.tell(ran);
            }
        }
        self.changed(company);
        match ran {
            Ok(ran) => {
                self.say(ran.lines.first().cloned().unwrap_or_default());
                if ran.is_over {
                    self.show_end();
                }
            }
            Err(refusal) => self.complain(refusal.to_string()),
        }
    }
}

impl App {
    fn class_was_read(&mut self, read: Result<(CollectedClass, Shown), String>) {
        self.busy = None;
        let Stage::Menu(menu) = &mut self.stage else { return };
        match read {
            Ok((class, shown)) => menu.show_class(class, shown),
            Err(problem) => {
                menu.refused(problem.clone(), None);
                self.complain(problem);
            }
        }
    }
}

fn as_student(again: &str, label: &str) -> String {
    let head = again.strip_suffix("--run latest").unwrap_or(again);
    let head = head.rsplit_once("--as ").map_or(head, |(before, _)| before);
    format!("{head}--as {label} --run latest")
}

fn in_words(changes: &[Change]) -> String {
    let one = |change: &Change| format!("{} {} → {}", change.setting, number(change.old), number(change.new));
    match changes {
        [first, second, rest @ ..] if !rest.is_empty() => {
            format!("{}, {} and {} more", one(first), one(second), rest.len())
        }
        _ => changes.iter().map(one).collect::<Vec<_>>().join(", "),
    }
}
