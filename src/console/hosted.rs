//! Hosted sessions: the console of a participant whose session runs on the experimenter's server.
//!
//! A hosted session starts no programs, writes no files of the user's choice and opens no other runs. Every action is
//! in exactly one of two lists. An action that is in neither list is not available, and a test fails.

use super::action::Action;
use super::keys::KeyBindings;

/// Message for an action that is not available in a hosted session.
pub const NOT_AVAILABLE: &str = "not available in a hosted session";

/// Actions that are available in hosted sessions.
const AVAILABLE: &[Action] = &[
    // Global
    Action::Overview,
    Action::Cash,
    Action::Customers,
    Action::Product,
    Action::Social,
    Action::Inbox,
    Action::Market,
    Action::Tools,
    Action::Sql,
    Action::Journal,
    Action::NextWeek,
    Action::Palette,
    Action::Help,
    Action::Changes,
    Action::Undo,
    Action::Redo,
    Action::FocusNext,
    Action::FocusPrevious,
    Action::Report,
    Action::Dashboard,
    Action::Back,
    Action::Forward,
    Action::Zoom,
    Action::Columns,
    Action::Rows,
    Action::Explain,
    Action::Curves,
    Action::Glossary,
    Action::Tour,
    Action::TourContinue,
    Action::TourBack,
    Action::TourClose,
    Action::NextTheme,
    Action::NextMarker,
    Action::StopClock,
    Action::Mouse,
    Action::Redraw,
    Action::Quit,
    // List
    Action::Up,
    Action::Down,
    Action::Left,
    Action::Right,
    Action::PageUp,
    Action::PageDown,
    Action::First,
    Action::Last,
    Action::Open,
    Action::Close,
    Action::Filter,
    Action::Sort,
    // Columns
    Action::ToggleColumn,
    Action::MoveColumnUp,
    Action::MoveColumnDown,
    Action::WidenColumn,
    Action::NarrowColumn,
    Action::FitColumn,
    Action::ResetColumns,
    // Form
    Action::Apply,
    Action::EditCell,
    Action::CopyDown,
    Action::ClearCell,
    Action::ResetForm,
    Action::CopyCall,
    // Query
    Action::RunQuery,
    Action::Complete,
    Action::History,
    Action::Library,
    Action::EditQuery,
    Action::ClearQuery,
    // Result
    Action::ShowCell,
    Action::CopyCell,
    Action::CopyRow,
    Action::Chart,
    Action::Export,
    Action::CountColumn,
    Action::Pivot,
    Action::PreviousResult,
    Action::NextResult,
    Action::PinResult,
    Action::CloseResult,
    Action::RecallQuery,
    // Chart
    Action::ChartX,
    Action::ChartY,
    Action::MoreSeries,
    Action::FewerSeries,
    Action::ChartKind,
    Action::CloseChart,
    // Export
    Action::CopyTabs,
    Action::CopyMarkdown,
    // Inbox
    Action::SendOffer,
    Action::MatchAskedPrice,
    Action::Mark,
    Action::MarkAll,
    Action::OfferPlan,
    Action::OfferBasis,
    Action::OfferPrice,
    Action::NextThreadView,
    Action::InboxRules,
    Action::InboxOutcomes,
    Action::RejectOffer,
    Action::InboxGroup,
    Action::InboxSql,
    // NextWeek
    Action::NextStep,
    Action::PreviousStep,
    Action::FillNaiveForecasts,
    Action::FillRationale,
    // Editor
    Action::LeaveEditor,
    // Field
    Action::Commit,
    Action::CommitDown,
    Action::CommitNext,
    Action::CommitPrevious,
    Action::Discard,
    // Notes
    Action::EditNotes,
    Action::ShowTree,
    Action::SaveNotes,
    // Social
    Action::Compose,
    Action::Reply,
    Action::SendPost,
    Action::ClearReply,
    Action::NextKind,
    Action::EarlierWeek,
    Action::LaterWeek,
    // Market
    Action::FindGroup,
    Action::StudyGroup,
    Action::LevelUp,
    Action::LevelDown,
    Action::GroupCurve,
    // Curve
    Action::NextPlan,
    Action::NextCurve,
    Action::PreviousCurve,
    Action::ResetCurve,
    // Dialog
    Action::Confirm,
    Action::Cancel,
    Action::ScrollUp,
    Action::ScrollDown,
    Action::OpenInSql,
    Action::CopyQuery,
    // FinalPage
    Action::StayInRun,
    // Study
    Action::Continue,
    Action::PreviousQuestion,
    Action::MarkOption,
    Action::Agree,
    Action::Decline,
    Action::SkipPractice,
    Action::Withdraw,
    // Drafts
    Action::RestoreDrafts,
    Action::DiscardDrafts,
    // Paused
    Action::StartClock,
    Action::QuitWhilePaused,
];

/// Actions that are not available in hosted sessions, because they open other runs, write files, start programs, or
/// show hidden state.
#[cfg(test)]
const NOT_AVAILABLE_ACTIONS: &[Action] = &[
    // Global
    Action::Xray,
    Action::Breakpoints,
    Action::HiddenValues,
    Action::Why,
    Action::Branches,
    Action::Lesson,
    Action::LessonPage,
    Action::WriteReport,
    Action::LeaveRun,
    // Form
    Action::SaveCalls,
    // Query
    Action::SaveQuery,
    // Export
    Action::ExportCsv,
    Action::ExportJson,
    Action::ExportMarkdown,
    // Editor
    Action::ExternalEditor,
    // Xray
    Action::TypeTarget,
    Action::SeekDay,
    Action::DayWeekBefore,
    Action::DayWeekAfter,
    Action::HoldFactor,
    Action::TypeCommand,
    Action::RunDays,
    Action::BreakpointHistory,
    Action::RemoveBreakpoint,
    // Menu
    Action::NewRun,
    Action::ContinueRun,
    Action::MarkRun,
    Action::CompareRuns,
    Action::ReplayRun,
    Action::EndRun,
    Action::DeleteRun,
    // Class
    Action::ClassDecision,
    Action::ClassFigure,
    Action::ClassView,
    Action::ClassQuestion,
    Action::ClassPart,
    Action::HideNames,
    // FinalPage
    Action::ToMenu,
    Action::WriteRunReport,
    Action::WriteRunCard,
    Action::ReplayFromStart,
    Action::Opponents,
    Action::WhatIf,
    // Lesson
    Action::ContinueLesson,
    Action::AnswerQuestion,
    Action::NextHint,
    Action::TryAgain,
    Action::NextPart,
    Action::Debrief,
    Action::LessonWeek,
    Action::HideLessonPage,
    Action::SkipAnswers,
    // Playback
    Action::WeekBack,
    Action::WeekForward,
    Action::LineBack,
    Action::LineForward,
    Action::SeekStart,
    Action::SeekEnd,
    Action::SeekWeek,
    Action::PlayPause,
    Action::Faster,
    Action::Slower,
    Action::Decisions,
    Action::DecisionsInFull,
    Action::DecisionsUp,
    Action::DecisionsDown,
    Action::TakeOver,
    Action::LeavePlayback,
    // Decisions
    Action::CycleDecision,
    Action::OmitDecision,
    Action::ScaleDecision,
    Action::ReplaceDecision,
    Action::AddDecision,
    Action::NextAlternative,
    Action::SimulateBranches,
    // Branches
    Action::NextFigure,
    Action::SimulateFutures,
    Action::AdoptBranch,
    // Study
    Action::Experimenter,
];

/// Returns whether an action is available in hosted sessions.
pub fn is_available(action: Action) -> bool {
    AVAILABLE.contains(&action)
}

/// Returns the key bindings of hosted sessions: bindings of actions that are not available are removed.
pub fn hosted_keys(keys: KeyBindings) -> KeyBindings {
    keys.retain_actions(is_available)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::action::ACTIONS;

    #[test]
    fn every_action_is_in_exactly_one_list() {
        for entry in ACTIONS {
            let lists = [AVAILABLE, NOT_AVAILABLE_ACTIONS]
                .map(|list| list.iter().filter(|action| **action == entry.action).count());
            assert_eq!(
                lists.iter().sum::<usize>(),
                1,
                "{:?}: add it to one of the lists: {lists:?}",
                entry.action
            );
        }
    }

    #[test]
    fn hosted_keys_bind_no_unavailable_action() {
        let keys = hosted_keys(KeyBindings::bundled());
        for entry in ACTIONS {
            assert!(is_available(entry.action) || keys.label(entry.action).is_none(), "{}", entry.name);
            assert_eq!(keys.is_available(entry.action), is_available(entry.action), "{}", entry.name);
        }
    }
}
