//! The protocol of a study in words, ready to be preregistered: everything in it is computed from the study, the
//! parameters in force and the columns of the tables.

use crate::notation::{dollars, grouped};
use crate::report::tables::headings;
use crate::session::{
    AtLimit, AuditKind, Configuration, DraftsKept, Form, FreeText, Moment, PracticeOffer, Questionnaire,
    ResultsShown, RunError, SeedPlan, SessionRules, Study,
};

/// The protocol as Markdown.
///
/// # Errors
/// The scenario of the session or the practice cannot be read.
pub fn protocol(study: &Study, configuration: &Configuration) -> Result<String, RunError> {
    let chapters = [
        heading(study),
        world(study, configuration)?,
        participants(study),
        procedure(study),
        rules(&study.rules()),
        questions(study),
        measures(),
        exclusion(study),
        checklist(study),
        consent(study),
    ];
    Ok(chapters.join("\n"))
}

fn heading(study: &Study) -> String {
    format!(
        "# {}\n\nProtocol of the study {}, digest {}. Version {} of NovaMind console.\n",
        study.protocol.title,
        study.protocol.name,
        study.digest,
        env!("CARGO_PKG_VERSION")
    )
}

fn world(study: &Study, configuration: &Configuration) -> Result<String, RunError> {
    let of = |name: &str, days: Option<u32>, cash: Option<f64>| -> Result<String, RunError> {
        let scenario = configuration.scenario(name)?;
        let params = configuration.parameters(&scenario, &[], false)?;
        let (own_days, own_cash) = configuration.terms(&scenario, false)?;
        Ok(format!(
            "scenario {name}, {} days, {} on day 0, parameters {}",
            grouped(f64::from(days.unwrap_or(own_days)), 0),
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
    Ok(text)
}

fn participants(study: &Study) -> String {
    let seeds = &study.protocol.seeds;
    let listed = |numbers: &[u64]| numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(", ");
    let plan = match seeds.plan {
        SeedPlan::One => {
            format!("Everybody plays seed {}.", listed(&seeds.seed.into_iter().collect::<Vec<_>>()))
        }
        SeedPlan::Blocks => format!(
            "Each block of participants plays every seed of {}, in random order.",
            listed(&seeds.block)
        ),
        SeedPlan::Assigned => "Seeds are assigned by the experimenter.".to_owned(),
    };
    let conditions = match seeds.conditions.as_slice() {
        [] => String::new(),
        some => format!(" Conditions: {}.", some.join(", ")),
    };
    let places = study.assignment.as_ref().map_or("Any label is taken.".to_owned(), |assignment| {
        format!("{} labels are assigned (assignment.csv).", assignment.places.len())
    });
    format!("## Participants\n\n{places} {plan}{conditions} Participants do not see seeds.\n")
}

fn procedure(study: &Study) -> String {
    let mut steps = vec!["Label. Labels that are not assigned are refused and counted."];
    if study.consent.is_some() {
        steps.push("Consent, to the text below. Who declines leaves no record but the refusal.");
    }
    match study.protocol.practice.offer {
        PracticeOffer::None => {}
        PracticeOffer::Required => steps.push("Practice, to its end."),
        PracticeOffer::Optional => steps.push("Practice, or passing it over."),
    }
    steps.push("Session. It can be left and taken up again; the record tells when.");
    steps.push("Questions, where they are due.");
    let lines: Vec<String> =
        steps.iter().enumerate().map(|(at, step)| format!("{}. {step}\n", at + 1)).collect();
    format!(
        "## Procedure\n\n{}\nBefore every week the participant files a rationale and four forecasts of cash, with 95 % intervals.\n",
        lines.concat()
    )
}

fn rules(rules: &SessionRules) -> String {
    let yes = |on: bool| if on { "yes" } else { "no" };
    let results = match rules.results {
        ResultsShown::None => "that the run is over",
        ResultsShown::Own => "the participant's own result",
        ResultsShown::Published => "the participant's own result beside published ones",
    };
    let texts = match rules.free_text {
        FreeText::Kept => "kept",
        FreeText::Masked => "only their lengths and digests are kept",
    };
    let drafts = match rules.drafts {
        DraftsKept::None => "not recorded",
        DraftsKept::Lengths => "lengths, pauses, deletions and pasted characters",
        DraftsKept::Text => "as lengths, and the text that was left",
    };
    let mut text = format!(
        "## Rules of the session\n\n\
         | Rule | |\n|---|---|\n\
         | Alerts recommend amounts | {} |\n\
         | Participants see how their forecasts have done while they make new ones | {} |\n\
         | The final page shows | {results} |\n\
         | Texts of notes and answers | {texts} |\n\
         | Texts that were edited | {drafts} |\n\
         | Lines that are left out | {} |\n",
        yes(rules.advice),
        yes(rules.calibration),
        if rules.unrecorded.is_empty() { "none".to_owned() } else { rules.unrecorded.join(", ") },
    );
    let limits = &rules.limits;
    let all =
        [("week", limits.week_minutes), ("sitting", limits.session_minutes), ("study", limits.study_minutes)];
    for (what, minutes) in all {
        text += &format!(
            "| Active minutes for a {what} | {} |\n",
            minutes.map_or("no limit".to_owned(), |own| own.to_string())
        );
    }
    let at_limit = match limits.at_limit {
        AtLimit::Remind => "the participant is reminded",
        AtLimit::Naive => "the week is filed with the naive projection",
        AtLimit::Pause => "the clock is stopped until the experimenter starts it",
    };
    text + &format!("| At a limit | {at_limit} |\n")
}

fn questions(study: &Study) -> String {
    if study.questionnaires.is_empty() {
        return "## Questions\n\nNone.\n".to_owned();
    }
    let mut text = "## Questions\n".to_owned();
    for own in &study.questionnaires {
        text += &format!("\n**{}** ({})\n\n", own.title, when(own));
        for question in &own.questions {
            let required = if question.required { "" } else { ", may be passed over" };
            text += &format!("- `{}`: {} ({}{required})\n", question.id, question.text, form(&question.form));
        }
    }
    text
}

fn when(own: &Questionnaire) -> String {
    match own.when {
        Moment::Before => "before the first week".to_owned(),
        Moment::Weeks => {
            let weeks: Vec<String> = own.weeks.iter().map(u32::to_string).collect();
            format!("after weeks {}", weeks.join(", "))
        }
        Moment::Break => "after each break".to_owned(),
        Moment::End => "at the end".to_owned(),
    }
}

fn form(form: &Form) -> String {
    match form {
        Form::Likert { points, low, high } if low.is_empty() && high.is_empty() => format!("1 to {points}"),
        Form::Likert { points, low, high } => format!("1 = {low} to {points} = {high}"),
        Form::Number { min, max, unit } => {
            let end = |end: &Option<f64>| end.map_or("…".to_owned(), |end| end.to_string());
            format!("a number from {} to {} {unit}", end(min), end(max)).trim_end().to_owned()
        }
        Form::Choice { options, several } => {
            format!("{} of: {}", if *several { "some" } else { "one" }, options.join(" / "))
        }
        Form::Text { most } => format!("text, at most {most} characters"),
        Form::Attention { options, expected } => format!("check: {expected} of {}", options.join(" / ")),
    }
}

/// Every column of every table with its definition: the measures are defined once, where they are computed.
fn measures() -> String {
    let mut text =
        "## Measures\n\nComputed by the program; `columns.csv` goes out with the tables.\n".to_owned();
    for (table, columns) in headings() {
        text += &format!("\n### {table}\n\n| Column | Unit | Definition |\n|---|---|---|\n");
        for column in columns {
            text +=
                &format!("| {} | {} | {} |\n", column.name, column.unit, column.meaning.replace('|', "\\|"));
        }
    }
    text
}

fn exclusion(study: &Study) -> String {
    let grave: Vec<&str> = AuditKind::ALL.iter().map(|kind| kind.title()).collect();
    let witness = match study.witness() {
        Some(_) => "A witness is told of every line.",
        None => "There is no witness: lines that are rewritten or cut with fitting hashes stay unnoticed.",
    };
    format!(
        "## Exclusion\n\nBefore any result is looked at, `novamind study audit` is run. {witness} A session with one of \
         these findings is excluded, and reported as excluded: {}. To be decided before the first session: the number of failed \
         attention checks, of naive weeks and of weeks decided in less than ten active seconds from which a session is excluded.\n",
        grave.join(", ")
    )
}

fn checklist(study: &Study) -> String {
    let mut points = vec![
        "`novamind study check` on every machine.".to_owned(),
        format!("The digest on every machine is {}.", &study.digest[..16]),
        "Labels handed out once each.".to_owned(),
        "`novamind study watch` while people play; remarks noted with `--note`.".to_owned(),
    ];
    if study.protocol.integrity.code_words {
        points.push("The four words of each week's report noted on the sheet.".to_owned());
    }
    points.push("`novamind study collect` and `novamind study audit` at the end of each day.".to_owned());
    let lines: Vec<String> = points.iter().map(|point| format!("- [ ] {point}\n")).collect();
    format!("## Checklist\n\n{}", lines.concat())
}

fn consent(study: &Study) -> String {
    match &study.consent {
        None => "## Consent\n\nNo text is shown.\n".to_owned(),
        Some(text) => {
            let quoted: String =
                text.trim().lines().map(|line| format!("> {line}").trim_end().to_owned() + "\n").collect();
            format!("## Consent\n\n{quoted}")
        }
    }
}
