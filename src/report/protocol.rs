//! The protocol of a study as a document for preregistration, computed from the study, its parameters and the columns
//! of the tables.

use crate::tables::table_headings;
use novamind_base::formatting::{dollars, grouped_number};
use novamind_record::error::RunError;
use novamind_record::folder::configuration::Configuration;
use novamind_record::rules::{DraftRecording, FreeTextRecording, LimitAction, ResultsDisclosure, TimeLimits};
use novamind_session::{FAST_WEEK_SECONDS, IDLE_TIMEOUT, SESSION_BREAK_SECONDS};
use novamind_study::{
    ASSIGNMENT_FILE, AnswerFormat, Assignment, FindingKind, Occasion, PracticeOffer, Questionnaire, SeedPlan,
    Study, load_lab_public_key,
};

/// Returns the protocol of a study as Markdown.
///
/// # Errors
/// Returns an error if the scenario of the session or of the practice run cannot be read.
pub fn protocol_markdown(study: &Study, configuration: &Configuration) -> Result<String, RunError> {
    let chapters = [
        heading_section(study),
        scenario_section(study, configuration)?,
        participants_section(study),
        procedure_section(study),
        rules_section(study),
        time_section(),
        questions_section(study),
        measures_section(),
        exclusion_section(),
        checklist_section(study),
        consent_section(study),
    ];
    Ok(chapters.join("\n"))
}

fn heading_section(study: &Study) -> String {
    let key = load_lab_public_key(&study.folder).ok().flatten();
    let signed = key.map_or("There is no lab key: archives are not signed.".to_owned(), |key| {
        format!("Archives are signed by the lab key {}.", key.fingerprint())
    });
    format!(
        "# {}\n\nProtocol of the study {}, digest {}. Version {} of NovaMind console. {signed}\n",
        study.protocol.title,
        study.protocol.name,
        study.digest,
        env!("CARGO_PKG_VERSION")
    )
}

fn scenario_section(study: &Study, configuration: &Configuration) -> Result<String, RunError> {
    let of = |name: &str, days: Option<u32>, cash: Option<f64>| -> Result<String, RunError> {
        let scenario = configuration.load_scenario(name)?;
        let params = configuration.load_parameters(&scenario, &[], false)?;
        let (own_days, own_cash) = configuration.days_and_cash(&scenario, false)?;
        Ok(format!(
            "scenario {name}, {} days, {} on day 0, parameters {}",
            grouped_number(f64::from(params.run.horizon(days.unwrap_or(own_days)).last_day), 0),
            dollars(cash.unwrap_or(own_cash)),
            params.digest()
        ))
    };
    let protocol = &study.protocol;
    let mut text = "## Task\n\nEach participant runs a simulated AI subscription company, week by week, with the information and \
                    the controls that software agents get in CEO-Bench. The score is the cash on the last day; cash below \
                    zero ends the run.\n\n"
        .to_owned();
    text +=
        &format!("- Session: {}.\n", of(&protocol.world.scenario, protocol.world.days, protocol.world.cash)?);
    if protocol.practice.offer != PracticeOffer::None {
        let world = of(&protocol.practice.scenario, protocol.practice.days, None)?;
        let required =
            if protocol.practice.offer == PracticeOffer::Required { "required" } else { "optional" };
        text += &format!("- Practice ({required}): {world}, seed {}.\n", protocol.practice.seed);
    }
    if let Some(model) = &protocol.voice {
        text += &format!(
            "- Language model: {}; a week waits at most {} seconds for the model, then uses the built-in voice.\n",
            model.recorded_settings().describe(),
            model.seconds_a_week
        );
    }
    Ok(text)
}

fn participants_section(study: &Study) -> String {
    let seeds = &study.protocol.seeds;
    let listed = |numbers: &[u64]| numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    let plan = match seeds.plan {
        SeedPlan::One => {
            format!("All participants play seed {}.", listed(&seeds.seed.into_iter().collect::<Vec<_>>()))
        }
        SeedPlan::Blocks => {
            format!("Each block of participants plays the seeds {} in random order.", listed(&seeds.block))
        }
        SeedPlan::Secret => format!(
            "Each block of participants plays {} secret seeds in random order. Commitment to the seeds: {}. After the study, \
             assignment.csv with the seeds can be published, and this command computes the same commitment from it.",
            seeds.count.unwrap_or_default(),
            study.seed_commitment().unwrap_or_default()
        ),
        SeedPlan::Assigned => "Seeds are assigned by the experimenter.".to_owned(),
    };
    let conditions = match seeds.conditions.as_slice() {
        [] => String::new(),
        some => format!(
            " Conditions: {}. They label and balance participants. The program is the same under all conditions; \
             the conditions differ only outside the program.",
            some.join(", ")
        ),
    };
    let places = study.assignment.as_ref().map_or("Any label is accepted.".to_owned(), |assignment| {
        format!("{} labels are assigned{}.", assignment.rows.len(), describe_assignment(study, assignment))
    });
    format!("## Participants\n\n{places} {plan}{conditions} Participants do not see seeds.\n")
}

/// Describes the assignment: the number of labels, the random draw if it can be reproduced, and the digest.
fn describe_assignment(study: &Study, assignment: &Assignment) -> String {
    let seeds = &study.protocol.seeds;
    let labels: Vec<String> = assignment.rows.iter().map(|place| place.label.clone()).collect();
    let draw = seeds.draw.unwrap_or(1);
    let is_drawn = Assignment::randomize_in_blocks(&labels, &study.block_seeds(), &seeds.conditions, draw)
        == *assignment;
    let blocks = match (seeds.plan, is_drawn) {
        (SeedPlan::One | SeedPlan::Assigned, _) if seeds.conditions.is_empty() => String::new(),
        (_, true) => format!("in blocks of {}, drawn with seed {draw}, ", seeds.cell_count()),
        (_, false) => format!("not as `novamind study assign` draws them with seed {draw}, "),
    };
    let digest = std::fs::read(study.folder.join(ASSIGNMENT_FILE))
        .map_or_else(|problem| problem.to_string(), |bytes| blake3::hash(&bytes).to_hex().to_string());
    format!(" ({blocks}BLAKE3 hash of assignment.csv {digest})")
}

fn procedure_section(study: &Study) -> String {
    let mut steps = vec!["Label. Labels that are not assigned are rejected and counted."];
    if study.consent.is_some() {
        steps.push("Consent to the text below. If a participant declines, no run is created; the list of visits contains the label and the refusal.");
    }
    match study.protocol.practice.offer {
        PracticeOffer::None => {}
        PracticeOffer::Required => steps.push("Practice run, played to its end."),
        PracticeOffer::Optional => steps.push("Practice run, which can be skipped."),
    }
    steps.push("Session. It can be interrupted and resumed; the record shows when.");
    steps.push("Questions, when they are due.");
    let lines: Vec<String> =
        steps.iter().enumerate().map(|(at, step)| format!("{}. {step}\n", at + 1)).collect();
    format!(
        "## Procedure\n\n{}\nBefore every week the participant files a rationale and four forecasts of cash, with 95 % intervals.\n",
        lines.concat()
    )
}

fn rules_section(study: &Study) -> String {
    let rules = study.session_rules();
    let yes = |on: bool| if on { "yes" } else { "no" };
    let results = match rules.results {
        ResultsDisclosure::None => "that the run has ended",
        ResultsDisclosure::Own => "the participant's own result",
        ResultsDisclosure::Published => "the participant's own result and published ones",
    };
    let texts = match rules.free_text {
        FreeTextRecording::Kept => "kept",
        FreeTextRecording::Masked => "only their lengths and digests are kept",
    };
    let drafts = match rules.drafts {
        DraftRecording::None => "not recorded",
        DraftRecording::Lengths => "lengths, pauses, deletions and pasted characters",
        DraftRecording::Text => "as lengths, and the text that was not submitted",
    };
    let mut text = format!(
        "## Rules of the session\n\nThe practice uses the same rules and time limits.\n\n\
         | Rule | |\n|---|---|\n\
         | Alerts recommend amounts | {} |\n\
         | Participants see a summary of past forecasts while they make new ones | {} |\n\
         | The final page shows | {results} |\n\
         | Texts of notes and answers | {texts} |\n\
         | Edits of texts | {drafts} |\n\
         | Unrecorded lines | {} |\n",
        yes(rules.advice),
        match rules.calibration {
            true => "yes",
            false =>
                "no; the week report and the Cash and Journal screens show single forecasts with their outcomes",
        },
        if rules.unrecorded.is_empty() { "none".to_owned() } else { rules.unrecorded.join(", ") },
    );
    if study.protocol.practice.offer != PracticeOffer::None {
        text += &format!(
            "| The practice starts with the tour (console) | {} |\n",
            yes(study.protocol.session.tour)
        );
    }
    text += &format!("| Stopping the clock asks for a reason | {} |\n", yes(rules.pause_reason));
    text + &limit_rows(&rules.limits)
}

fn limit_rows(limits: &TimeLimits) -> String {
    let all = [
        ("Minutes per week of the company", limits.week_minutes),
        ("Minutes per session", limits.session_minutes),
        ("Minutes per run, over all sessions", limits.study_minutes),
    ];
    let minutes =
        |number: Option<u32>, none: &str| number.map_or(none.to_owned(), |number| number.to_string());
    let row = |(what, limit): (&str, Option<u32>)| format!("| {what} | {} |\n", minutes(limit, "no limit"));
    let text: String = all.into_iter().map(row).collect();
    if all.iter().all(|(_, limit)| limit.is_none()) {
        return text;
    }
    let at_limit = match limits.at_limit {
        LimitAction::Remind => "the participant is reminded, once",
        LimitAction::Naive => {
            "week limit: the week is filed with naive forecasts; session or run limit: the clock is stopped until the experimenter \
             starts it"
        }
        LimitAction::Pause => "the clock is stopped until the experimenter starts it",
    };
    let warning = minutes(limits.warning_minutes, "none");
    text + &format!(
        "| Minutes before a limit at which the participant is warned | {warning} |\n| Action at a limit | {at_limit} |\n"
    )
}

fn time_section() -> String {
    format!(
        "## Time\n\n\
         - Active: the run is open and in front, its clock runs, no question of the study is open, and the participant is not idle.\n\
         - Answering: like active time, but while a question of the study is open.\n\
         - Idle: from the last key (plain mode: the last line) if no other follows within {} s.\n\
         - Away: the run is closed, suspended or in the background, or its clock is stopped.\n\
         - Simulation time belongs to none of these classes.\n\
         - A week decided in less than {} active seconds counts as implausibly fast.\n\
         - Limits count all time of a session, also idle time and time away, except while the clock is stopped, a question is \
         open, or days are simulated. An absence of {:.0} minutes or more ends a session; no limit counts it.\n",
        IDLE_TIMEOUT.as_secs(),
        FAST_WEEK_SECONDS,
        SESSION_BREAK_SECONDS / 60.0
    )
}

fn questions_section(study: &Study) -> String {
    if study.questionnaires.is_empty() {
        return "## Questions\n\nNone.\n".to_owned();
    }
    let mut text = "## Questions\n".to_owned();
    for questionnaire in &study.questionnaires {
        text +=
            &format!("\n**{}** ({})\n\n", questionnaire.title, describe_questionnaire_time(questionnaire));
        for question in &questionnaire.questions {
            let required = if question.required { ", required" } else { ", optional" };
            text += &format!(
                "- `{}`: {} ({}{required})\n",
                question.id,
                question.text,
                describe_answer_format(&question.form)
            );
        }
    }
    text
}

fn describe_questionnaire_time(questionnaire: &Questionnaire) -> String {
    match questionnaire.when {
        Occasion::Before => "before the first week".to_owned(),
        Occasion::Weeks => {
            let weeks: Vec<String> = questionnaire.weeks.iter().map(u32::to_string).collect();
            format!("after weeks {}", weeks.join(", "))
        }
        Occasion::Break => {
            "whenever the participant resumes the run or restarts the clock, even after a short break"
                .to_owned()
        }
        Occasion::End => "at the end".to_owned(),
    }
}

fn describe_answer_format(form: &AnswerFormat) -> String {
    match form {
        AnswerFormat::Likert { points, low, high } if low.is_empty() && high.is_empty() => {
            format!("1 to {points}")
        }
        AnswerFormat::Likert { points, low, high } => format!("1 = {low} to {points} = {high}"),
        AnswerFormat::Number { min, max, unit } => {
            let end = |end: &Option<f64>| end.map_or("…".to_owned(), |end| end.to_string());
            format!("a number from {} to {} {unit}", end(min), end(max)).trim_end().to_owned()
        }
        AnswerFormat::Choice { options, several } => {
            format!("{} of: {}", if *several { "any" } else { "one" }, options.join(" / "))
        }
        AnswerFormat::Text { most } => format!("text, at most {most} characters"),
        AnswerFormat::Attention { options, expected } => {
            format!("check: {expected} of {}", options.join(" / "))
        }
    }
}

/// Returns the definition of every column of every table. The definitions come from the code that computes the values.
fn measures_section() -> String {
    let mut text =
        "## Measures\n\nThe program computes all measures and exports `columns.csv` with the tables.\n"
            .to_owned();
    for (table, columns) in table_headings() {
        text += &format!("\n### {table}\n\n| Column | Unit | Definition |\n|---|---|---|\n");
        for column in columns {
            text +=
                &format!("| {} | {} | {} |\n", column.name, column.unit, column.meaning.replace('|', "\\|"));
        }
    }
    text
}

fn exclusion_section() -> String {
    let session_findings = FindingKind::ALL.iter().filter(|kind| **kind != FindingKind::NothingExamined);
    let grave: Vec<&str> = session_findings.map(|kind| kind.title()).collect();
    format!(
        "## Exclusion\n\nRun `novamind study audit` before inspecting any result. The audit reads only the records. It cannot detect a run \
         whose lines were rewritten with correct hashes, or a run that was continued in a copy of its folder. A session is excluded, \
         and reported as excluded, if it has or is named in one of these findings: {}. Before the first session, decide how many \
         failed attention checks, naive weeks, and weeks decided in less than ten active seconds exclude a session.\n",
        grave.join(", ")
    )
}

fn checklist_section(study: &Study) -> String {
    let points = [
        "Run `novamind study check` on every machine.".to_owned(),
        format!("Check that the digest on every machine is {}.", &study.digest[..16]),
        "Hand out each label once.".to_owned(),
        "Run `novamind study watch` during sessions, and record remarks with `--note`.".to_owned(),
        "Run `novamind study collect` and `novamind study audit` at the end of each day.".to_owned(),
    ];
    let lines: Vec<String> = points.iter().map(|point| format!("- [ ] {point}\n")).collect();
    format!("## Checklist\n\n{}", lines.concat())
}

fn consent_section(study: &Study) -> String {
    match &study.consent {
        None => "## Consent\n\nNo text is shown.\n".to_owned(),
        Some(text) => {
            let quoted: String =
                text.trim().lines().map(|line| format!("> {line}").trim_end().to_owned() + "\n").collect();
            format!("## Consent\n\n{quoted}")
        }
    }
}
