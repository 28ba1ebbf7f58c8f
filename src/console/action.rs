//! Table of the console's actions, from which the palette, the footer, the help and the key file are derived.

use novamind_tui::canvas::CommandId;
use novamind_tui::widgets::ListAction;

/// A part of the console in which key bindings apply. A focused pane or dialog has several scopes, the innermost first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scope {
    /// All screens and panes of an open run.
    Global,
    /// The start menu.
    Menu,
    /// The results of a collected class.
    Class,
    /// Lists and tables.
    List,
    /// Tool forms.
    Form,
    /// The dialog that arranges the columns of a table.
    Columns,
    /// A single-line text field.
    Field,
    /// A multi-line editor.
    Editor,
    /// The SQL editor.
    Query,
    /// The results of SQL queries.
    Result,
    /// The chart of a query result.
    Chart,
    /// The export menu of a result.
    Export,
    /// Negotiations with enterprises.
    Inbox,
    /// The next-week dialog.
    NextWeek,
    /// Small dialogs, such as confirmations.
    Dialog,
    /// The page at the end of a run.
    FinalPage,
    /// The notes in the journal.
    Notes,
    /// The social feed.
    Social,
    /// Groups and market studies.
    Market,
    /// Playback of a recorded run.
    Playback,
    /// Study pages that a participant answers.
    Study,
    /// The list of decisions in a what-if.
    Decisions,
    /// The figures of the branches in a what-if.
    Branches,
    /// The participation curve of a group.
    Curve,
    /// The lesson page.
    Lesson,
    /// The X-ray screen, which shows hidden state of the run.
    Xray,
    /// The dialog that offers to restore drafts.
    Drafts,
    /// The screen shown while the clock is stopped.
    Paused,
}

impl Scope {
    /// All scopes, in the order of the manual.
    pub const ALL: [Scope; 28] = [
        Scope::Global,
        Scope::List,
        Scope::Columns,
        Scope::Form,
        Scope::Query,
        Scope::Result,
        Scope::Chart,
        Scope::Export,
        Scope::Inbox,
        Scope::NextWeek,
        Scope::Editor,
        Scope::Field,
        Scope::Notes,
        Scope::Social,
        Scope::Market,
        Scope::Curve,
        Scope::Xray,
        Scope::Dialog,
        Scope::Menu,
        Scope::Class,
        Scope::FinalPage,
        Scope::Lesson,
        Scope::Playback,
        Scope::Decisions,
        Scope::Branches,
        Scope::Study,
        Scope::Drafts,
        Scope::Paused,
    ];

    /// Returns the name of the scope in the key file.
    pub fn id(self) -> &'static str {
        match self {
            Scope::Global => "global",
            Scope::Menu => "menu",
            Scope::Class => "class",
            Scope::List => "list",
            Scope::Columns => "columns",
            Scope::Form => "form",
            Scope::Field => "field",
            Scope::Editor => "editor",
            Scope::Query => "query",
            Scope::Result => "result",
            Scope::Chart => "chart",
            Scope::Export => "export",
            Scope::Inbox => "inbox",
            Scope::NextWeek => "filing",
            Scope::Dialog => "dialog",
            Scope::FinalPage => "final",
            Scope::Notes => "memo",
            Scope::Social => "social",
            Scope::Market => "market",
            Scope::Playback => "viewer",
            Scope::Study => "visit",
            Scope::Decisions => "decisions",
            Scope::Branches => "branches",
            Scope::Curve => "curve",
            Scope::Lesson => "lesson",
            Scope::Xray => "xray",
            Scope::Drafts => "unsent",
            Scope::Paused => "cover",
        }
    }

    /// Returns the heading of the scope in the manual.
    pub fn title(self) -> &'static str {
        match self {
            Scope::Global => "Everywhere in a run",
            Scope::Menu => "Start menu",
            Scope::Class => "Class",
            Scope::List => "Lists and tables",
            Scope::Columns => "Columns of a table",
            Scope::Form => "Tool forms",
            Scope::Field => "Value fields",
            Scope::Editor => "Text editors",
            Scope::Query => "SQL editor",
            Scope::Result => "Query results",
            Scope::Chart => "Result chart",
            Scope::Export => "Result export",
            Scope::Inbox => "Inbox",
            Scope::NextWeek => "Next week",
            Scope::Dialog => "Dialogs",
            Scope::FinalPage => "Final page",
            Scope::Notes => "Notes",
            Scope::Social => "Social",
            Scope::Market => "Market",
            Scope::Playback => "Replay",
            Scope::Study => "Study pages",
            Scope::Decisions => "What if: decisions",
            Scope::Branches => "What if: figures",
            Scope::Curve => "Participation curve",
            Scope::Lesson => "Lesson",
            Scope::Xray => "X-ray",
            Scope::Drafts => "Unsent text",
            Scope::Paused => "While the clock is stopped",
        }
    }

    /// Returns whether printable characters are text input in this scope.
    pub fn is_text(self) -> bool {
        matches!(self, Scope::Field | Scope::Editor)
    }
}

impl Action {
    /// Returns the action with the number of a command, or `None` if no action has that number.
    pub fn from_command(command: CommandId) -> Option<Action> {
        ACTIONS.get(usize::from(command.0)).map(|entry| entry.action)
    }
}

impl From<Action> for CommandId {
    fn from(action: Action) -> CommandId {
        CommandId(action as u16)
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

/// One row of the action table.
#[derive(Debug)]
pub struct ActionEntry {
    /// The action that this row describes.
    pub action: Action,
    /// Name of the action in the key file.
    pub name: &'static str,
    /// The scope in which the action is available.
    pub scope: Scope,
    /// Label of the action in the footer and the palette.
    pub title: &'static str,
    /// Description of the action in the help, the manual and the palette.
    pub doc: &'static str,
}

macro_rules! actions {
    ($($scope:ident { $($variant:ident $name:literal $title:literal $doc:literal)* })*) => {
        /// A command that a key, a click or the palette triggers.
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
        Overview "overview" "Overview" "Show the company's key figures."
        Cash "cash" "Cash" "Show income and costs."
        Customers "customers" "Customers" "Show the customer groups."
        Product "product" "Product" "Show quality, capacity, issues and R&D."
        Social "social" "Social" "Read the social feed and your own posts. ● counts posts since your last visit."
        Inbox "inbox" "Inbox" "Negotiate with enterprises."
        Market "market" "Market" "Show groups, studies, the economy and competitors."
        Tools "tools" "Tools" "Show a form for every tool."
        Sql "sql" "SQL" "Query the database."
        Journal "journal" "Journal" "Show past actions and forecast scores."
        Xray "xray" "X-ray" "Show the hidden state of the run. For debug runs and finished runs."
        Breakpoints "breakpoints" "breakpoints" "Show the breakpoints on the X-ray screen: set a breakpoint, run to it, or see the history of its condition. For debug runs and finished runs."
        HiddenValues "hidden-values" "true values" "Show or hide true values on the Customers and Market screens; each day shown is recorded as an inspection. For debug runs and finished runs."
        NextWeek "next-week" "next week" "Review the changes, write a rationale, forecast cash, and run the week."
        Palette "palette" "palette" "Find screens, tools, groups, queries, tables and commands by name."
        Help "help" "help" "List the keys that work here, the focused pane first."
        Changes "changes" "changes" "Show the settings that changed this week."
        Undo "undo" "undo" "Undo the last setting of this week; c lists the changes."
        Redo "redo" "redo" "Redo the last undone change."
        FocusNext "focus-next" "next pane" "Move to the next pane."
        FocusPrevious "focus-previous" "previous pane" "Move to the previous pane."
        Report "report" "last week" "Show the report of the last week again."
        Dashboard "dashboard" "dashboard" "Show the weekly dashboard as text."
        Back "back" "back" "Go back to the previous screen."
        Forward "forward" "forward" "Go forward again after going back."
        Zoom "zoom" "zoom" "Show the focused pane full screen; press again for all panes."
        Columns "columns" "columns" "Choose, move and resize the columns of the focused table; the choice is saved."
        Rows "rows" "source rows" "Show the rows that make up the selected figure, and their query."
        Explain "explain" "explain" "Explain the selected figure or field."
        Why "why" "why" "Show how much each cause contributed to the change in the selected figure, by simulating the week without that cause. Not in an unfinished baseline run."
        Branches "branches" "what if" "Simulate the run again with other decisions, from a week you choose. The run itself does not change. Not in an unfinished baseline run."
        Curves "curves" "participation curve" "Show the quality that a group requires at each price. Drag prices and qualities of plans to see how leads respond; the settings do not change."
        Glossary "glossary" "glossary" "Look up any term."
        Lesson "lesson" "lesson" "In a lesson: show or hide the task next to the screen; in a small window, open it as a page."
        LessonPage "lesson-page" "task" "In a lesson: open the whole task as a page, with its question, hints and goals."
        Tour "tour" "tour" "Resume the tour in its run or in a practice run; start it from the start menu."
        TourContinue "tour-skip" "continue" "Continue with the next step of the tour after you have done what the step asks for."
        TourBack "tour-back" "back" "Go back to the previous step of the tour."
        TourClose "tour-close" "close" "Close the tour; it can be resumed at any time."
        NextTheme "next-theme" "next theme" "Switch to the next color theme."
        NextMarker "next-marker" "next marker" "Draw charts with braille dots, blocks or ASCII characters."
        StopClock "stop-clock" "stop the clock" "Stop the clock for a break: the screen is hidden, and the time does not count."
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
        Open "open" "open" "Open the selected item."
        Close "close" "close" "Close the open item, clear the filter, or go back to the previous place."
        Filter "filter" "filter" "Show only the rows that contain the text you type."
        Sort "sort" "sort" "Sort by the selected column; press again to reverse, a third time to stop sorting."
    }
    Columns {
        ToggleColumn "toggle-column" "show or hide" "Show or hide the selected column."
        MoveColumnUp "move-up" "move up" "Move the selected column before its neighbor."
        MoveColumnDown "move-down" "move down" "Move the selected column behind its neighbor."
        WidenColumn "wider" "wider" "Make the selected column wider."
        NarrowColumn "narrower" "narrower" "Make the selected column narrower; numbers are never cut."
        FitColumn "automatic-width" "automatic width" "Make the selected column as wide as its contents."
        ResetColumns "reset-columns" "reset" "Show all columns in their original order and width."
    }
    Form {
        Apply "apply" "submit" "Submit the form."
        EditCell "edit" "edit" "Type a value in the focused cell."
        CopyDown "same-down" "copy down" "Copy the value to the cells below. Right after you accept a value, the key copies the accepted value."
        ClearCell "clear-cell" "0" "Clear the cell."
        ResetForm "reset-form" "reset" "Discard the draft and show the current values; press again to restore the draft."
        CopyCall "copy-call" "copy call" "Copy the tool call that the form would send."
        SaveCalls "save-calls" "calls to file" "Write this week's calls and the drafts to calls.txt in the run folder."
    }
    Query {
        RunQuery "run-query" "run" "Run the statement."
        Complete "complete" "complete" "Accept the suggested completion."
        History "history" "history" "Search earlier statements."
        Library "library" "library" "Search the library of named queries and run one."
        SaveQuery "save-query" "save" "Save the statement as a named query."
        EditQuery "edit-query" "edit" "Type in the editor."
        ClearQuery "clear-query" "clear" "Clear the editor."
    }
    Result {
        ShowCell "whole-cell" "full value" "Show the full value of the cell."
        CopyCell "copy-cell" "copy cell" "Copy the value of the cell."
        CopyRow "copy-row" "copy row" "Copy the row."
        Chart "chart" "chart" "Draw the result as lines or bars."
        Export "export" "export" "Write the result to a file, or copy all of it."
        CountColumn "count-column" "count" "Count how often each value of the focused column occurs, with a query over all rows that match the filter."
        Pivot "pivot" "pivot" "Pivot the result by the focused column, with a query over all rows that match the filter."
        PreviousResult "previous-result" "previous result" "Show the previous result."
        NextResult "next-result" "next result" "Show the next result."
        PinResult "pin-result" "pin" "Pin the result so that it is kept, or unpin it."
        CloseResult "close-result" "close result" "Close the result."
        RecallQuery "recall-query" "edit statement" "Copy the statement of the result to the editor."
    }
    Chart {
        ChartX "chart-x" "x axis" "Use another column for the x axis."
        ChartY "chart-y" "y axis" "Plot another numeric column."
        MoreSeries "more-series" "add series" "Add a series to the chart."
        FewerSeries "fewer-series" "remove series" "Remove a series from the chart."
        ChartKind "chart-kind" "lines or bars" "Switch between lines and bars."
        CloseChart "close-chart" "table" "Return to the table."
    }
    Export {
        ExportCsv "export-csv" "CSV" "Write the result as CSV."
        ExportJson "export-json" "JSON" "Write the result as JSON."
        ExportMarkdown "export-markdown" "Markdown" "Write the result as a Markdown table."
        CopyTabs "copy-tabs" "copy" "Copy the result as tab-separated values, for a spreadsheet."
        CopyMarkdown "copy-markdown" "copy Markdown" "Copy the result as a Markdown table."
    }
    Inbox {
        SendOffer "send-offer" "send" "Send the offer to the marked enterprises, or to the selected one."
        MatchAskedPrice "take-their-price" "match asked price" "Offer the price that the enterprise asks for the plan it named."
        Mark "mark" "mark" "Mark or unmark the thread for a bulk offer."
        MarkAll "mark-all" "mark all" "Mark every thread in the list; press again to unmark them."
        OfferPlan "plan" "plan" "Choose another plan for this line of the offer."
        OfferBasis "basis" "basis" "Enter the price as a percentage of the list price, as a percentage of the asked price, or in dollars."
        OfferPrice "price" "price" "Enter the price of this line of the offer."
        NextThreadView "other-threads" "other threads" "Switch between threads that wait for you, threads that wait for the enterprise, and closed threads."
        InboxRules "rules" "rules" "Answer waiting threads with rules that you type; nothing is sent until you confirm."
        InboxOutcomes "outcomes" "outcomes" "Switch between the threads and their outcomes by first offer and week."
        RejectOffer "reject" "reject" "End the threads without a deal, after confirmation."
        InboxGroup "group" "group" "Show the group of the enterprise."
        InboxSql "thread-sql" "SQL" "Query the thread in SQL."
    }
    NextWeek {
        NextStep "next-step" "next step" "Go to the next step. In the last step, run the week."
        PreviousStep "previous-step" "previous step" "Go back to the previous step."
        FillNaiveForecasts "fill-naively" "fill naively" "Fill in empty forecasts with naive forecasts, which are marked in the record. In the review, fill in everything (not in baseline runs)."
        FillRationale "fill-rationale" "fill in" "Fill in the rationale with the list of changes; not in baseline runs."
    }
    Editor {
        LeaveEditor "leave-editor" "leave" "Stop typing; the text is kept."
        ExternalEditor "external-editor" "your editor" "Open the text in the editor that VISUAL or EDITOR names: notes, posts, SQL and code. Not in an unfinished baseline run."
    }
    Field {
        Commit "commit" "accept" "Accept the typed value; in a form, move down."
        CommitDown "commit-down" "accept, down" "Accept the typed value and move down."
        CommitNext "commit-next" "accept, next" "Accept the typed value and move to the next field."
        CommitPrevious "commit-previous" "accept, previous" "Accept the typed value and move to the previous field."
        Discard "discard" "cancel" "Discard the typed value."
    }
    Notes {
        EditNotes "edit-memo" "edit notes" "Edit the notes of the run."
        ShowTree "tree" "tree" "Show the branches related to the run."
        SaveNotes "save-memo" "save notes" "Save the notes with the run."
    }
    Social {
        Compose "compose" "write" "Write a post as the company."
        Reply "reply" "reply" "Reply to the selected post."
        SendPost "send-post" "publish" "Publish the post, after confirmation."
        ClearReply "unreply" "not a reply" "Turn the reply into a new post."
        NextKind "next-kind" "kind" "Filter by author: customers, press, comments, your posts, then all."
        EarlierWeek "earlier-week" "earlier week" "Show only the posts of one week: first the latest week, then earlier weeks."
        LaterWeek "later-week" "later week" "Show a later week; after the latest week, show all weeks."
    }
    Market {
        FindGroup "find-group" "find a group" "Pay for a market research attempt, after confirmation."
        StudyGroup "study-group" "study" "Order a study of the selected group at the chosen level, after confirmation."
        LevelUp "level-up" "level up" "Choose a higher level for the study."
        LevelDown "level-down" "level down" "Choose a lower level for the study."
        GroupCurve "group-curve" "curve" "Show the participation curve of the selected group with the plans."
    }
    Curve {
        NextPlan "next-plan" "plan" "Select the next plan, or all plans together, to drag. Left and right change the price, up and down the quality."
        NextCurve "next-curve" "next group" "Show the curve of the next known group."
        PreviousCurve "previous-curve" "previous group" "Show the curve of the previous known group."
        ResetCurve "reset-curve" "reset" "Reset the plans to their current values."
    }
    Xray {
        TypeTarget "type" "type" "Type a group or customer number with an optional day, for example S2 84 or 1372 304; or a day, a part, or a breakpoint condition."
        SeekDay "seek-day" "day …" "Go to a day by number."
        DayWeekBefore "week-before" "week earlier" "Show the state one week earlier; left shows the previous day."
        DayWeekAfter "week-after" "week later" "Show the state one week later, at most the last day; right shows the next day."
        HoldFactor "hold" "fix" "Fix the selected factor of the leads at a value and show the expected leads, or release the factor."
        TypeCommand "ask" "command" "Type a plain-mode command: find, who, diff or set. set changes a parameter of a debug run, after confirmation."
        RunDays "run-days" "run" "Type how many days of a debug run to simulate; the simulation stops on the first day on which a breakpoint becomes true."
        BreakpointHistory "look-back" "history" "Show since which day the condition of each breakpoint has been true or false."
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
        EndRun "end-run" "give up" "End the run permanently, after confirmation."
        DeleteRun "delete-run" "delete" "Delete the run and everything in its folder, after confirmation."
    }
    Class {
        ClassDecision "class-decision" "decision" "Plot another decision on the x axis, as the mean over the weeks in which the student decided."
        ClassFigure "class-figure" "figure" "Plot another figure on the y axis, as its value in the last week."
        ClassView "class-view" "lower pane" "In a small window, choose the pane below the curves: the decision against the figure, guesses, or pitfalls."
        ClassQuestion "class-question" "question" "Show the guesses of the next question of the lesson."
        ClassPart "class-part" "part" "Show the next part of the lesson."
        HideNames "hide-names" "names" "Show ranks instead of the names of students, or show the names again."
    }
    FinalPage {
        ToMenu "to-menu" "start menu" "Go to the start menu."
        WriteRunReport "report-of-run" "report" "Write the report into the run folder, as Markdown and HTML."
        WriteRunCard "card-of-run" "card" "Write a shareable summary card to the run folder, as text and as SVG."
        ReplayFromStart "replay-of-run" "replay" "Replay the run from its first day."
        Opponents "opponents" "opponents" "Play the strong policies and the baseline with the scenario and seed of this run, and rank the run among them."
        WhatIf "what-if" "what if" "Simulate the last twelve weeks again with other decisions."
        StayInRun "stay" "view run" "Close this page and view the run."
    }
    Lesson {
        ContinueLesson "lesson-on" "continue" "Answer the open question; after the end of a part, start the next part or open the debrief."
        AnswerQuestion "answer" "guess" "Answer the question of the step."
        NextHint "next-hint" "hint" "Show the next hint of the step; each shown hint is recorded."
        TryAgain "try-again" "try again" "Try the step again from its start, in a new run, after confirmation."
        NextPart "next-part" "next part" "Start the next part of the lesson after this part has ended."
        Debrief "debrief" "debrief" "Compare a finished part with the reference play and the pitfall play."
        LessonWeek "lesson-week" "next week" "Close the page and run the next week."
        HideLessonPage "hide-page" "hide task" "Close the page of the lesson."
        SkipAnswers "week-unanswered" "week only" "Run the week without answering the waiting messages."
    }
    Playback {
        WeekBack "week-back" "previous week" "Go to the end of the previous week."
        WeekForward "week-forward" "next week" "Go to the end of the next week."
        LineBack "line-back" "previous action" "Step back by one action."
        LineForward "line-forward" "next action" "Replay the next action: a tool call, a query or a screen view."
        SeekStart "reel-start" "first" "Go to the first day, before any action."
        SeekEnd "reel-end" "last" "Go to the end of the record."
        SeekWeek "seek-week" "week …" "Go to a week by number."
        PlayPause "play-pause" "play" "Play week after week, or pause."
        Faster "faster" "faster" "Play faster."
        Slower "slower" "slower" "Play slower."
        Decisions "decisions" "decisions" "Show or hide the decisions of the week next to the screen; in a small window, open them as text."
        DecisionsInFull "decisions-whole" "in full" "Show the decisions of the week in full, with arguments, statements and results."
        DecisionsUp "decisions-up" "decisions up" "Scroll the decisions up."
        DecisionsDown "decisions-down" "decisions down" "Scroll the decisions down."
        TakeOver "take-over" "take over" "Continue from this position in your own branch."
        LeavePlayback "leave-viewer" "leave" "Close the replay and open the start menu; the run does not change."
    }
    Decisions {
        CycleDecision "cycle-decision" "change" "Change the selected decision: keep it, leave it out, scale its amounts, or replace its values. On another row, open the row."
        OmitDecision "drop-decision" "leave out" "Leave out the selected decision; restore a changed decision, or remove an added decision."
        ScaleDecision "scale-decision" "scale" "Multiply the amounts of the selected decision by a factor; in the list of new decisions, multiply all values of the tool from the first changed week on."
        ReplaceDecision "replace-decision" "replace" "Replace the values of the selected decision in the form of its tool."
        AddDecision "add-decision" "add decision" "Add a decision to the week, in the form of its tool."
        NextAlternative "next-alternative" "next alternative" "Go to the next alternative, or add one; up to three are compared."
        SimulateBranches "simulate-branches" "simulate" "Simulate the run with your decisions unchanged and with each alternative."
    }
    Branches {
        NextFigure "next-figure" "next figure" "Show the next figure."
        SimulateFutures "draw-futures" "futures" "Simulate every branch with twenty new sets of random draws, the same sets for each branch."
        AdoptBranch "adopt-branch" "adopt" "Create a run from the selected branch, simulate it to the current day, and continue in it."
    }
    Study {
        Continue "go-on" "continue" "Continue to the next question or page; after the last question, send the answers."
        PreviousQuestion "go-back" "previous question" "Go back to the previous question; you can change its answer until you send the page."
        MarkOption "mark-option" "mark" "Mark or unmark the option; you can mark several."
        Agree "agree" "agree" "Agree to the text, after scrolling to its end."
        Decline "decline" "do not agree" "Do not agree to the text."
        SkipPractice "pass-practice" "skip" "Skip the practice."
        Withdraw "withdraw" "withdraw" "Withdraw from the study: erase everything you did in it, after two confirmations."
        Experimenter "experimenter" "experimenter" "Enter the experimenter's code to open the start menu."
    }
    Drafts {
        RestoreDrafts "restore-texts" "restore" "Restore the drafts in the fields where you typed them."
        DiscardDrafts "drop-texts" "discard" "Discard the drafts."
    }
    Paused {
        StartClock "start-clock" "start" "Start the clock again."
        QuitWhilePaused "quit-stopped" "quit" "Save and quit; the clock starts when you open the run again."
    }
}

impl Action {
    /// Returns the row of the action in [`ACTIONS`].
    pub fn entry(self) -> &'static ActionEntry {
        ACTIONS.iter().find(|entry| entry.action == self).expect("the table contains every action")
    }

    /// Returns the action that has a name in a scope.
    pub fn by_name(scope: Scope, name: &str) -> Option<Action> {
        ACTIONS.iter().find(|entry| entry.scope == scope && entry.name == name).map(|entry| entry.action)
    }
}
