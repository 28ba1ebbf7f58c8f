//! Everything a person can do with a key: one table, from which palette, footer, help and the key file are read.

/// Where a key means something. A focused place has several scopes, the innermost first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scope {
    /// Everywhere in a run.
    Global,
    /// The start menu.
    Menu,
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
}

impl Scope {
    /// All scopes, in the order of the help.
    pub const ALL: [Scope; 18] = [
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
        Scope::Dialog,
        Scope::Menu,
        Scope::Final,
        Scope::Viewer,
    ];

    /// Name in the key file.
    pub fn id(self) -> &'static str {
        match self {
            Scope::Global => "global",
            Scope::Menu => "menu",
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
        }
    }

    /// Heading in the manual.
    pub fn title(self) -> &'static str {
        match self {
            Scope::Global => "Everywhere in a run",
            Scope::Menu => "Start menu",
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
        }
    }

    /// Whether plain characters are typed here.
    pub fn is_text(self) -> bool {
        matches!(self, Scope::Field | Scope::Editor)
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
        Social "social" "Social" "Show what people write and our posts."
        Inbox "inbox" "Inbox" "Negotiate with companies."
        Market "market" "Market" "Show groups, studies, the economy and rivals."
        Tools "tools" "Tools" "Show the forms of all tools."
        Sql "sql" "SQL" "Ask the database."
        Journal "journal" "Journal" "Show what was done and how forecasts turned out."
        NextWeek "next-week" "next week" "Review the changes, say why, forecast, and let the week pass."
        Palette "palette" "palette" "Find screens, tools, groups, queries, tables and commands by typing."
        Help "help" "help" "Show every key that works here."
        Changes "changes" "changes" "Show the settings changed since the last week."
        Undo "undo" "undo" "Take back the last setting of this week, and say what it was and is again; c lists the changes."
        Redo "redo" "redo" "Set again what undo took back."
        FocusNext "focus-next" "next pane" "Move to the next pane."
        FocusPrevious "focus-previous" "previous pane" "Move to the previous pane."
        Report "report" "last week" "Show the report of the last week again."
        Dashboard "dashboard" "dashboard" "Show the weekly dashboard as text."
        Back "back" "back" "Go back to the screen before."
        Forward "forward" "forward" "Go to the screen that was left with back."
        Zoom "zoom" "zoom" "Give the focused pane the whole screen; again to see all panes."
        Rows "rows" "rows behind" "Show the rows that make up the selected figure, and the query for them."
        Explain "explain" "what is this" "Explain the selected figure or field."
        Glossary "glossary" "glossary" "Explain every term of the company."
        Tour "tour" "tour" "Show the first steps in the game, two minutes long."
        TourSkip "tour-skip" "skip" "Go on with the tour without doing this step."
        TourClose "tour-close" "close" "Close the tour; it can be resumed."
        NextTheme "next-theme" "next theme" "Use the next set of colours."
        NextMarker "next-marker" "next marker" "Draw curves with braille dots, blocks or ASCII signs."
        Mouse "mouse" "mouse" "Use the mouse, or leave it to the terminal for selecting text."
        Redraw "redraw" "redraw" "Draw the whole screen again."
        WriteReport "write-report" "write the report" "Write the report of the run as Markdown and as a page for a browser."
        LeaveRun "leave-run" "start menu" "Save and go back to the start menu."
        Quit "quit" "quit" "Save and leave."
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
        Close "close" "close" "Close, or clear the filter."
        Filter "filter" "filter" "Show only rows that hold some text."
        Sort "sort" "sort" "Sort by the selected column; again to reverse, a third time to end."
    }
    Form {
        Apply "apply" "apply" "Send the call."
        EditCell "edit" "edit" "Type a value."
        SameDown "same-down" "same down" "Give the cells below the same value."
        ClearCell "clear-cell" "0" "Set the cell to nothing."
        ResetForm "reset-form" "reset" "Forget the draft and show the present values."
        CopyCall "copy-call" "copy call" "Copy the equivalent call."
        SaveCalls "save-calls" "calls to file" "Write the calls of this week and those of drafts to calls.txt in the folder of the run."
    }
    Query {
        RunQuery "run-query" "run" "Run the statement."
        Complete "complete" "complete" "Take the suggested completion."
        History "history" "history" "Find an earlier statement by typing."
        Library "library" "library" "Find a named query by typing, and run it."
        SaveQuery "save-query" "save" "Save the statement under a name into your own queries."
        EditQuery "edit-query" "edit" "Go to the editor."
        ClearQuery "clear-query" "clear" "Empty the editor."
    }
    Result {
        WholeCell "whole-cell" "whole cell" "Show the whole value of the cell."
        CopyCell "copy-cell" "copy cell" "Copy the value of the cell."
        CopyRow "copy-row" "copy row" "Copy the row."
        Chart "chart" "chart" "Draw the result as lines or bars."
        Export "export" "export" "Write the result to a file, or copy all of it."
    }
    Chart {
        ChartX "chart-x" "along" "Draw along another column."
        ChartY "chart-y" "values" "Draw another column of numbers."
        MoreSeries "more-series" "more" "Draw one more column of numbers."
        FewerSeries "fewer-series" "fewer" "Draw one column less."
        ChartKind "chart-kind" "lines or bars" "Draw bars instead of lines, or lines instead of bars."
        CloseChart "close-chart" "table" "Go back to the rows."
    }
    Export {
        ExportCsv "export-csv" "CSV" "Write the result as CSV."
        ExportJson "export-json" "JSON" "Write the result as JSON."
        ExportMarkdown "export-markdown" "Markdown" "Write the result as a table of Markdown."
        CopyTabs "copy-tabs" "copy" "Copy the result with tabs, for a spreadsheet."
        CopyMarkdown "copy-markdown" "copy Markdown" "Copy the result as a table of Markdown."
    }
    Inbox {
        SendOffer "send-offer" "send" "Send the offer to the marked companies, or to the selected one."
        TakeAsk "take-their-price" "take their price" "Offer what the company asks for the plan it named."
        Mark "mark" "mark" "Mark the thread for one rule, or unmark it."
        MarkAll "mark-all" "mark all" "Mark every thread that is shown; again to unmark them."
        OfferPlan "plan" "plan" "Another plan for this line of the offer."
        OfferBasis "basis" "basis" "Price in percent of the list, in percent of their price, or in dollars."
        OfferPrice "price" "price" "Type the value of this line of the offer."
        OtherThreads "other-threads" "other threads" "Show threads that wait for you, for the company, or ended."
        RejectOffer "reject" "reject" "End the threads without a deal; asks first."
        InboxGroup "group" "group" "Show the group of the company."
        InboxSql "thread-sql" "SQL" "Ask the database for the thread."
    }
    Filing {
        NextStep "next-step" "next step" "Go on to the next step, and from the last one let the week pass."
        PreviousStep "previous-step" "step back" "Go back to the step before."
        FillNaively "fill-naively" "fill naively" "Fill the forecasts with the naive projection; this is recorded."
        FillRationale "fill-rationale" "fill in" "Fill the rationale with the list of changes; not in baseline runs."
    }
    Editor {
        LeaveEditor "leave-editor" "leave" "Leave the editor; the text stays."
    }
    Field {
        Commit "commit" "take" "Take what was typed."
        CommitDown "commit-down" "take, down" "Take what was typed and go down."
        CommitNext "commit-next" "take, next" "Take what was typed and go to the next field."
        CommitPrevious "commit-previous" "take, previous" "Take what was typed and go to the field before."
        Discard "discard" "cancel" "Forget what was typed."
    }
    Memo {
        EditMemo "edit-memo" "edit notes" "Edit the notes of the run."
        SaveMemo "save-memo" "save notes" "Keep the notes with the run."
    }
    Social {
        Compose "compose" "write" "Write a post of the company."
        Reply "reply" "answer" "Write an answer to the selected post."
        SendPost "send-post" "publish" "Publish what is written, after a question."
        Unreply "unreply" "no answer" "Let the draft stand for itself instead of answering a post."
        NextKind "next-kind" "kind" "Show only customers, the press, comments or our posts; then all again."
        EarlierWeek "earlier-week" "week before" "Show the posts of one week only: the last one, then those before."
        LaterWeek "later-week" "week after" "Show the week after; after the last one, all weeks."
    }
    Market {
        FindGroup "find-group" "find a group" "Pay for an attempt at market research, after a question."
        StudyGroup "study-group" "study" "Order a study of the selected group to the chosen level, after a question."
        LevelUp "level-up" "level up" "Choose a higher level for the study."
        LevelDown "level-down" "level down" "Choose a lower level for the study."
    }
    Dialog {
        Confirm "confirm" "yes" "Do it."
        Cancel "cancel" "close" "Leave it."
        ScrollUp "scroll-up" "up" "Scroll up."
        ScrollDown "scroll-down" "down" "Scroll down."
        OpenInSql "open-in-sql" "open in SQL" "Put the query behind the rows into the SQL editor and run it."
        CopyQuery "copy-query" "copy query" "Copy the query behind the rows."
    }
    Menu {
        NewRun "new-run" "new run" "Start a new run."
        ContinueRun "continue-run" "continue" "Continue the latest run."
        MarkRun "mark-run" "mark" "Mark the run for a comparison, or unmark it."
        CompareRuns "compare-runs" "compare" "Show the marked runs side by side."
        ReplayRun "replay-run" "replay" "Play the recorded run again, read-only, week by week."
        EndRun "end-run" "give up" "End the run for good, after a question."
        DeleteRun "delete-run" "delete" "Delete the run with everything in its folder, after a question."
    }
    Final {
        ToMenu "to-menu" "start menu" "Go to the start menu."
        ReportOfRun "report-of-run" "report" "Write the report of the run into its folder, as Markdown and as a page for a browser."
        ReplayOfRun "replay-of-run" "replay" "Play the run again from its first day."
        WhatIf "what-if" "what if" "Go back to the last decision in a replay; from any week in it another run can branch off."
        StayInRun "stay" "look around" "Close this page and look at the run."
    }
    Viewer {
        WeekBack "week-back" "week back" "Go to the end of the week before."
        WeekForward "week-forward" "week on" "Go to the end of the next week."
        LineBack "line-back" "action back" "Take back the last single action."
        LineForward "line-forward" "action on" "Let the next single action happen: a call, a query, a look at a screen."
        ReelStart "reel-start" "first" "Go to the first day, before any action."
        ReelEnd "reel-end" "last" "Go to the end of the record."
        SeekWeek "seek-week" "week …" "Go to a week, by its number."
        PlayPause "play-pause" "play" "Play week after week, or pause."
        Faster "faster" "faster" "Play faster."
        Slower "slower" "slower" "Play slower."
        Decisions "decisions" "decisions" "Show what was decided before the next week beside the screen, or hide it; in a small window as text."
        DecisionsWhole "decisions-whole" "in full" "Show the decisions of the week in full, with arguments, statements and answers."
        DecisionsUp "decisions-up" "decisions up" "Scroll the decisions up."
        DecisionsDown "decisions-down" "decisions down" "Scroll the decisions down."
        TakeOver "take-over" "take over" "Go on from this moment in a run of your own: a branch."
        LeaveViewer "leave-viewer" "leave" "Leave the replay for the start menu; nothing was changed."
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
