//! Everything a person can do with a key: one table, from which palette, footer, help and the key file are read.

use novamind_tui::canvas::Command;
use novamind_tui::widgets::ListAction;

/// Where a key means something. A focused place has several scopes, the innermost first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scope {
    /// Everywhere in a run.
    Global,
    /// The start menu.
    Menu,
    /// A class that was collected.
    Class,
    /// Lists and tables.
    List,
    /// Forms of tools.
    Form,
    /// A line of text that is being typed.
    Field,
    /// An editor of several lines.
    Editor,
    /// The SQL editor.
    Query,
    /// Results of queries.
    Result,
    /// Charts of results.
    Chart,
    /// Ways to take a result out.
    Export,
    /// Negotiations.
    Inbox,
    /// The dialog before a week.
    Filing,
    /// Small dialogs.
    Dialog,
    /// The page at the end of a run.
    Final,
    /// The notes in the journal.
    Memo,
    /// The public conversation.
    Social,
    /// Groups and their studies.
    Market,
    /// A recorded run that is played again.
    Viewer,
    /// The pages of a participant of a study.
    Visit,
    /// Decisions of a run that are made otherwise.
    Decisions,
    /// Branches side by side.
    Branches,
    /// A participation curve beside the plans.
    Curve,
    /// The page of a lesson.
    Lesson,
    /// Hidden state of the run.
    Xray,
    /// The offer of texts that were typed and not sent.
    Unsent,
    /// The cover while the clock is stopped.
    Cover,
}

impl Scope {
    /// All scopes, in the order of the help.
    pub const ALL: [Scope; 27] = [
        Scope::Global,
        Scope::List,
        Scope::Form,
        Scope::Query,
        Scope::Result,
        Scope::Chart,
        Scope::Export,
        Scope::Inbox,
        Scope::Filing,
        Scope::Editor,
        Scope::Field,
        Scope::Memo,
        Scope::Social,
        Scope::Market,
        Scope::Curve,
        Scope::Xray,
        Scope::Dialog,
        Scope::Menu,
        Scope::Class,
        Scope::Final,
        Scope::Lesson,
        Scope::Viewer,
        Scope::Decisions,
        Scope::Branches,
        Scope::Visit,
        Scope::Unsent,
        Scope::Cover,
    ];

    /// Name in the key file.
    pub fn id(self) -> &'static str {
        match self {
            Scope::Global => "global",
            Scope::Menu => "menu",
            Scope::Class => "class",
            Scope::List => "list",
            Scope::Form => "form",
            Scope::Field => "field",
            Scope::Editor => "editor",
            Scope::Query => "query",
            Scope::Result => "result",
            Scope::Chart => "chart",
            Scope::Export => "export",
            Scope::Inbox => "inbox",
            Scope::Filing => "filing",
            Scope::Dialog => "dialog",
            Scope::Final => "final",
            Scope::Memo => "memo",
            Scope::Social => "social",
            Scope::Market => "market",
            Scope::Viewer => "viewer",
            Scope::Visit => "visit",
            Scope::Decisions => "decisions",
            Scope::Branches => "branches",
            Scope::Curve => "curve",
            Scope::Lesson => "lesson",
            Scope::Xray => "xray",
            Scope::Unsent => "unsent",
            Scope::Cover => "cover",
        }
    }

    /// Heading in the manual.
    pub fn title(self) -> &'static str {
        match self {
            Scope::Global => "Everywhere in a run",
            Scope::Menu => "Start menu",
            Scope::Class => "Class",
            Scope::List => "Lists and tables",
            Scope::Form => "Forms of tools",
            Scope::Field => "While a value is typed",
            Scope::Editor => "Editors of several lines",
            Scope::Query => "SQL editor",
            Scope::Result => "Results of queries",
            Scope::Chart => "Chart of a result",
            Scope::Export => "Export of a result",
            Scope::Inbox => "Inbox",
            Scope::Filing => "Before a week",
            Scope::Dialog => "Dialogs",
            Scope::Final => "Final page",
            Scope::Memo => "Notes",
            Scope::Social => "Social",
            Scope::Market => "Market",
            Scope::Viewer => "Replay of a run",
            Scope::Visit => "Pages of a participant",
            Scope::Decisions => "What if: decisions",
            Scope::Branches => "What if: figures",
            Scope::Curve => "Participation curve",
            Scope::Lesson => "Lesson",
            Scope::Xray => "X-ray",
            Scope::Unsent => "Unsent text",
            Scope::Cover => "While the clock is stopped",
        }
    }

    /// Whether plain characters are typed here.
    pub fn is_text(self) -> bool {
        matches!(self, Scope::Field | Scope::Editor)
    }
}

impl Action {
    /// Returns the action of a command, or `None` if no action has its number.
    pub fn of(command: Command) -> Option<Action> {
        ACTIONS.get(usize::from(command.0)).map(|entry| entry.action)
    }
}

impl From<Action> for Command {
    fn from(action: Action) -> Command {
        Command(action as u16)
    }
}

impl From<Action> for Option<ListAction> {
    fn from(action: Action) -> Option<ListAction> {
        Some(match action {
            Action::Up => ListAction::Up,
            Action::Down => ListAction::Down,
            Action::Left => ListAction::Left,
            Action::Right => ListAction::Right,
            Action::PageUp => ListAction::PageUp,
            Action::PageDown => ListAction::PageDown,
            Action::First => ListAction::First,
            Action::Last => ListAction::Last,
            Action::ScrollUp => ListAction::ScrollUp,
            Action::ScrollDown => ListAction::ScrollDown,
            Action::Sort => ListAction::Sort,
            Action::Filter => ListAction::Filter,
            Action::Commit | Action::CommitDown => ListAction::Commit,
            Action::Discard => ListAction::Discard,
            Action::Close => ListAction::Close,
            _ => return None,
        })
    }
}

/// One row of the table.
#[derive(Debug)]
pub struct ActionEntry {
    /// The action.
    pub action: Action,
    /// Name in the key file.
    pub name: &'static str,
    /// Where it can be done.
    pub scope: Scope,
    /// Few words for footer and palette.
    pub title: &'static str,
    /// What it does.
    pub doc: &'static str,
}

macro_rules! actions {
    ($($scope:ident { $($variant:ident $name:literal $title:literal $doc:literal)* })*) => {
        /// What a key, a click or the palette asks for.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Action { $($(#[doc = $doc] $variant,)*)* }

        /// The table of all actions.
        pub static ACTIONS: &[ActionEntry] = &[$($(ActionEntry {
            action: Action::$variant,
            name: $name,
            scope: Scope::$scope,
            title: $title,
            doc: $doc,
        },)*)*];
    };
}

actions! {
    Global {
        Overview "overview" "Overview" "Show the company at a glance."
        Cash "cash" "Cash" "Show where money comes from and goes to."
        Customers "customers" "Customers" "Show the customer groups."
        Product "product" "Product" "Show quality, capacity, issues and R&D."
        Social "social" "Social" "Read what people write, and your own posts."
        Inbox "inbox" "Inbox" "Negotiate with companies."
        Market "market" "Market" "Show groups, studies, the economy and rivals."
        Tools "tools" "Tools" "Show the forms of all tools."
        Sql "sql" "SQL" "Query the database."
        Journal "journal" "Journal" "Show what was done and how forecasts turned out."
        Xray "xray" "X-ray" "Show the hidden state of the run: in debug runs and in runs that are over."
        Breakpoints "breakpoints" "breakpoints" "Show the breakpoints on the X-ray screen: set one, run to it, or see since when its condition holds. In debug runs and in runs that are over."
        HiddenValues "hidden-values" "true values" "Show hidden true values on the screens Customers and Market, or hide them again; each day that is shown is a recorded look. In debug runs and in runs that are over."
        NextWeek "next-week" "next week" "Review the changes, write a rationale, forecast, and run the week."
        Palette "palette" "palette" "Find screens, tools, groups, queries, tables and commands by typing."
        Help "help" "help" "Show every key that works here, those of the focused pane first."
        Changes "changes" "changes" "Show the settings changed since the last week."
        Undo "undo" "undo" "Undo the last setting of this week and say its value; c lists the changes."
        Redo "redo" "redo" "Redo what undo reverted."
        FocusNext "focus-next" "next pane" "Move to the next pane."
        FocusPrevious "focus-previous" "previous pane" "Move to the previous pane."
        Report "report" "last week" "Show the report of the last week again."
        Dashboard "dashboard" "dashboard" "Show the weekly dashboard as text."
        Back "back" "back" "Go back to the screen before."
        Forward "forward" "forward" "Go forward to the screen you left with back."
        Zoom "zoom" "zoom" "Show the focused pane full screen; press again for all panes."
        Rows "rows" "source rows" "Show the rows that make up the selected figure, and their query."
        Explain "explain" "what is this" "Explain the selected figure or field."
        Why "why" "why" "Say how much of the change of the selected figure each cause brought: the week is simulated again without it. Not in an unfinished baseline run."
        Branches "branches" "what if" "Simulate the run again from a week on under other decisions, in memory. Not in an unfinished baseline run."
        Curves "curves" "participation curve" "Show the quality that a group requires at a price, drag prices and qualities of the plans, and see what leads would do. Nothing is set."
        Glossary "glossary" "glossary" "Look up any term."
        Lesson "lesson" "lesson" "In a lesson: show or hide the task beside the screen; in a small window, open it as a page."
        LessonPage "lesson-page" "task" "In a lesson: open the whole task as a page, with its question, hints and goals."
        Tour "tour" "tour" "Resume the tour of a practice run; the start menu begins it."
        TourSkip "tour-skip" "skip" "Skip this step of the tour."
        TourClose "tour-close" "close" "Close the tour; it can be resumed at any time."
        NextTheme "next-theme" "next theme" "Switch to the next colour theme."
        NextMarker "next-marker" "next marker" "Draw charts with braille dots, blocks or ASCII characters."
        StopClock "stop-clock" "stop the clock" "Stop the clock for a break: the screen is covered, and the time does not count."
        Mouse "mouse" "mouse" "Turn mouse support on or off; when off, the terminal selects text."
        Redraw "redraw" "redraw" "Redraw the screen."
        WriteReport "write-report" "write the report" "Write the report of the run as Markdown and HTML."
        LeaveRun "leave-run" "start menu" "Save and return to the start menu."
        Quit "quit" "quit" "Save and quit."
    }
    List {
        Up "up" "up" "Move up."
        Down "down" "down" "Move down."
        Left "left" "left" "Move left."
        Right "right" "right" "Move right."
        PageUp "page-up" "page up" "Move up by a page."
        PageDown "page-down" "page down" "Move down by a page."
        First "first" "first" "Move to the first row."
        Last "last" "last" "Move to the last row."
        Open "open" "open" "Open what is selected."
        Close "close" "close" "Close, clear the filter, or go back to where you came from."
        Filter "filter" "filter" "Show only the rows that contain a text."
        Sort "sort" "sort" "Sort by the selected column; again to reverse, a third time to stop sorting."
    }
    Form {
        Apply "apply" "apply" "Send the call."
        EditCell "edit" "edit" "Type a value; in a cell for a number, a digit begins it."
        SameDown "same-down" "same down" "Copy the value to the cells below; right after a value was accepted, that one."
        ClearCell "clear-cell" "0" "Clear the cell."
        ResetForm "reset-form" "reset" "Discard the draft and show the current values; again to bring the draft back."
        CopyCall "copy-call" "copy call" "Copy the equivalent call."
        SaveCalls "save-calls" "calls to file" "Write this week's calls and the drafts to calls.txt in the run's folder."
    }
    Query {
        RunQuery "run-query" "run" "Run the statement."
        Complete "complete" "complete" "Accept the suggested completion."
        History "history" "history" "Search earlier statements."
        Library "library" "library" "Search the library of named queries and run one."
        SaveQuery "save-query" "save" "Save the statement under a name among your own queries."
        EditQuery "edit-query" "edit" "Go to the editor."
        ClearQuery "clear-query" "clear" "Empty the editor."
    }
    Result {
        WholeCell "whole-cell" "whole cell" "Show the whole value of the cell."
        CopyCell "copy-cell" "copy cell" "Copy the value of the cell."
        CopyRow "copy-row" "copy row" "Copy the row."
        Chart "chart" "chart" "Draw the result as lines or bars."
        Export "export" "export" "Write the result to a file, or copy all of it."
        CountColumn "count-column" "count" "Count how often each value of the focused column stands in the result, by a query over all rows that the filter lets through."
        Pivot "pivot" "pivot" "Pivot the result by the focused column, by a query over all rows that the filter lets through."
        PreviousResult "previous-result" "previous result" "Show the result before."
        NextResult "next-result" "next result" "Show the next result."
        PinResult "pin-result" "pin" "Keep the result as it is, or let it go again."
        CloseResult "close-result" "close result" "Close the result."
        RecallQuery "recall-query" "its statement" "Put the statement of the result into the editor."
    }
    Chart {
        ChartX "chart-x" "along" "Use another column for the x axis."
        ChartY "chart-y" "values" "Plot another numeric column."
        MoreSeries "more-series" "more" "Add a series."
        FewerSeries "fewer-series" "fewer" "Remove a series."
        ChartKind "chart-kind" "lines or bars" "Switch between lines and bars."
        CloseChart "close-chart" "table" "Go back to the rows."
    }
    Export {
        ExportCsv "export-csv" "CSV" "Write the result as CSV."
        ExportJson "export-json" "JSON" "Write the result as JSON."
        ExportMarkdown "export-markdown" "Markdown" "Write the result as a Markdown table."
        CopyTabs "copy-tabs" "copy" "Copy the result with tabs, for a spreadsheet."
        CopyMarkdown "copy-markdown" "copy Markdown" "Copy the result as a Markdown table."
    }
    Inbox {
        SendOffer "send-offer" "send" "Send the offer to the marked companies, or to the selected one."
        TakeAsk "take-their-price" "take their price" "Offer the price the company asks for the plan it named."
        Mark "mark" "mark" "Mark or unmark the thread for a bulk offer."
        MarkAll "mark-all" "mark all" "Mark every thread shown; again to unmark them."
        OfferPlan "plan" "plan" "Choose another plan for this line of the offer."
        OfferBasis "basis" "basis" "Price as a percentage of the list price, as a percentage of theirs, or in dollars."
        OfferPrice "price" "price" "Enter the price of this line of the offer."
        OtherThreads "other-threads" "other threads" "Switch between threads waiting for you, waiting for the company, and closed."
        InboxRules "rules" "rules" "Answer waiting threads by rules you type; nothing is sent before you confirm."
        InboxOutcomes "outcomes" "outcomes" "Show what became of leads by your first offer and its week, or the threads again."
        RejectOffer "reject" "reject" "End the threads without a deal, after confirmation."
        InboxGroup "group" "group" "Show the group of the company."
        InboxSql "thread-sql" "SQL" "Query the thread in SQL."
    }
    Filing {
        NextStep "next-step" "next step" "Go to the next step; on the last one, run the week."
        PreviousStep "previous-step" "step back" "Go back to the step before."
        FillNaively "fill-naively" "fill naively" "Fill empty forecasts with the naive projection, which is recorded; on the review, fill in everything (not in baseline runs)."
        FillRationale "fill-rationale" "fill in" "Fill the rationale with the list of changes; not in baseline runs."
    }
    Editor {
        LeaveEditor "leave-editor" "leave" "Leave the editor; the text is kept."
    }
    Field {
        Commit "commit" "accept" "Accept what you typed; in a form, go down."
        CommitDown "commit-down" "take, down" "Accept what you typed and go down."
        CommitNext "commit-next" "take, next" "Accept what you typed and go to the next field."
        CommitPrevious "commit-previous" "take, previous" "Accept what you typed and go to the previous field."
        Discard "discard" "cancel" "Discard what you typed."
    }
    Memo {
        EditMemo "edit-memo" "edit notes" "Edit the notes of the run."
        ShowTree "tree" "tree" "Go to the tree of branches in which the run stands."
        SaveMemo "save-memo" "save notes" "Save the notes with the run."
    }
    Social {
        Compose "compose" "write" "Write a post of the company."
        Reply "reply" "answer" "Reply to the selected post."
        SendPost "send-post" "publish" "Publish the post, after confirmation."
        Unreply "unreply" "no answer" "Turn the reply into a post of its own."
        NextKind "next-kind" "kind" "Filter by author: customers, press, comments, your posts, then all."
        EarlierWeek "earlier-week" "week before" "Show one week only: the latest, then earlier ones."
        LaterWeek "later-week" "week after" "Show a later week; after the latest, all weeks."
    }
    Market {
        FindGroup "find-group" "find a group" "Pay for a market research attempt, after confirmation."
        StudyGroup "study-group" "study" "Order a study of the selected group to the chosen level, after confirmation."
        LevelUp "level-up" "level up" "Choose a higher level for the study."
        LevelDown "level-down" "level down" "Choose a lower level for the study."
        GroupCurve "group-curve" "curve" "Show the participation curve of the selected group beside the plans."
    }
    Curve {
        NextPlan "next-plan" "plan" "Drag the next plan, or all of them together. Left and right drag the price, up and down the quality."
        NextCurve "next-curve" "next group" "Show the curve of the next known group."
        PreviousCurve "previous-curve" "group before" "Show the curve of the known group before."
        ResetCurve "reset-curve" "reset" "Put the plans back where they stand."
    }
    Xray {
        TypeChoice "type" "type" "Type a group or the number of a customer, with a day or none, for instance S2 84 or 1372 304; a day, a part, or the condition of a breakpoint."
        SeekDay "seek-day" "day …" "Go to a day by number."
        DayWeekBefore "week-before" "week before" "Show the day a week earlier; left shows the day before."
        DayWeekAfter "week-after" "week after" "Show the day a week later, at most the last one; right shows the day after."
        HoldFactor "hold" "hold" "Hold the selected factor of the leads at a value and show the expected leads beside, or let it go."
        AskWords "ask" "ask" "Type words as plain mode takes them: find, who, diff, or set, which asks before it sets a parameter of a debug run."
        RunDays "run-days" "run" "Type how many days of a debug run to simulate; it stops on the first day on which a breakpoint becomes true."
        LookBack "look-back" "since when" "Say since when the condition of each breakpoint is true or false."
        RemoveBreakpoint "remove-breakpoint" "remove" "Remove the selected breakpoint."
    }
    Dialog {
        Confirm "confirm" "yes" "Confirm."
        Cancel "cancel" "close" "Cancel."
        ScrollUp "scroll-up" "up" "Scroll up."
        ScrollDown "scroll-down" "scroll" "Scroll down."
        OpenInSql "open-in-sql" "open in SQL" "Open the query in the SQL editor and run it."
        CopyQuery "copy-query" "copy query" "Copy the query."
    }
    Menu {
        NewRun "new-run" "new run" "Start a new run."
        ContinueRun "continue-run" "continue" "Continue the latest run."
        MarkRun "mark-run" "mark" "Mark the run for a comparison, or unmark it."
        CompareRuns "compare-runs" "compare" "Show the marked runs side by side."
        ReplayRun "replay-run" "replay" "Replay the recorded run, read-only, week by week."
        EndRun "end-run" "give up" "End the run for good, after confirmation."
        DeleteRun "delete-run" "delete" "Delete the run and everything in its folder, after confirmation."
    }
    Class {
        ClassDecision "class-decision" "decision" "Plot another decision across: the mean of the weeks in which the student decided."
        ClassFigure "class-figure" "figure" "Plot another figure up: that of the last week."
        ClassView "class-view" "below" "In a small window, show below the curves: the decision against the figure, guesses, or pitfalls."
        ClassQuestion "class-question" "question" "Show the guesses of the next question of the lesson."
        ClassPart "class-part" "part" "Show the next part of the lesson."
        HideNames "hide-names" "names" "Hide the names of students, ranks stand for them, or show them again."
    }
    Final {
        ToMenu "to-menu" "start menu" "Go to the start menu."
        ReportOfRun "report-of-run" "report" "Write the report into the run's folder, as Markdown and HTML."
        CardOfRun "card-of-run" "card" "Write a card to hand on into the run's folder, as text and as a drawing."
        ReplayOfRun "replay-of-run" "replay" "Replay the run from its first day."
        Opponents "opponents" "opponents" "Play the strong policies and the baseline in the world of this run, with its luck, and rank the run among them."
        WhatIf "what-if" "what if" "Simulate the run again from a week on under other decisions; it begins twelve weeks before the end."
        StayInRun "stay" "look around" "Close this page and look at the run."
    }
    Lesson {
        LessonOn "lesson-on" "go on" "Answer the open question; where the part is over, begin the next one or open the debrief."
        AnswerQuestion "answer" "guess" "Answer the question of the step."
        NextHint "next-hint" "hint" "Take the next hint of the step; that it was taken is recorded."
        TryAgain "try-again" "try again" "Try the step again from its beginning, after confirmation, in a run of its own."
        NextPart "next-part" "next part" "Begin the next part of the lesson, once this one is over."
        Debrief "debrief" "debrief" "Show what came of a part that is over, beside the good and the bad play."
        LessonWeek "lesson-week" "next week" "Close the page and let the next week come."
        WeekUnanswered "week-unanswered" "week only" "Where the next week asks whether to answer first: leave waiting letters without an answer."
    }
    Viewer {
        WeekBack "week-back" "week back" "Go to the end of the week before."
        WeekForward "week-forward" "week on" "Go to the end of the next week."
        LineBack "line-back" "action back" "Step back by a single action."
        LineForward "line-forward" "action on" "Replay the next single action: a call, a query, a screen view."
        ReelStart "reel-start" "first" "Go to the first day, before any action."
        ReelEnd "reel-end" "last" "Go to the end of the record."
        SeekWeek "seek-week" "week …" "Go to a week by number."
        PlayPause "play-pause" "play" "Play week after week, or pause."
        Faster "faster" "faster" "Play faster."
        Slower "slower" "slower" "Play slower."
        Decisions "decisions" "decisions" "Show what was decided before the next week beside the screen, or hide it; in a small window as text."
        DecisionsWhole "decisions-whole" "in full" "Show the decisions of the week in full, with arguments, statements and answers."
        DecisionsUp "decisions-up" "decisions up" "Scroll the decisions up."
        DecisionsDown "decisions-down" "decisions down" "Scroll the decisions down."
        TakeOver "take-over" "take over" "Continue from this moment in a branch of your own."
        LeaveViewer "leave-viewer" "leave" "Leave the replay for the start menu; nothing is changed."
    }
    Decisions {
        DropDecision "drop-decision" "leave out" "Leave the selected call out, or make it as it was; take another decision back."
        AddDecision "add-decision" "decide" "Type another decision: a call, a factor, a tool whose settings stay."
        NextAlternative "next-alternative" "next alternative" "Go to the next alternative, or begin one; up to three stand side by side."
        SimulateBranches "simulate-branches" "simulate" "Simulate the run with your decisions unchanged and under each alternative."
    }
    Branches {
        NextFigure "next-figure" "next figure" "Show the next figure."
        DrawFutures "draw-futures" "futures" "Draw the luck anew twenty times, for every branch in the same way."
        AdoptBranch "adopt-branch" "adopt" "Play the selected branch as a run of its own up to the day of this one, and go on in it."
    }
    Visit {
        GoOn "go-on" "go on" "Go on to the next question or page; after the last question, send the answers."
        GoBack "go-back" "question before" "Go back to the question before; its answer can be changed until the page is sent."
        MarkOption "mark-option" "mark" "Mark or unmark the option; several can be marked."
        Agree "agree" "agree" "Agree to the text, once its end was on the screen."
        Decline "decline" "do not agree" "Do not agree to the text."
        PassPractice "pass-practice" "pass over" "Pass over the practice."
        Withdraw "withdraw" "withdraw" "Withdraw from the study: erase everything you did in it, after two confirmations."
        Experimenter "experimenter" "experimenter" "Give the experimenter's code, which opens the start menu."
    }
    Unsent {
        RestoreTexts "restore-texts" "restore" "Put the texts back where you typed them."
        DropTexts "drop-texts" "drop" "Drop the texts."
    }
    Cover {
        StartClock "start-clock" "start" "Start the clock again."
        QuitStopped "quit-stopped" "quit" "Save and quit; the clock is started when the run is opened again."
    }
}

impl Action {
    /// Its row of the table.
    pub fn entry(self) -> &'static ActionEntry {
        ACTIONS.iter().find(|entry| entry.action == self).expect("the table holds every action")
    }

    /// The action of a name in a scope.
    pub fn named(scope: Scope, name: &str) -> Option<Action> {
        ACTIONS.iter().find(|entry| entry.scope == scope && entry.name == name).map(|entry| entry.action)
    }
}
