//! `explain` and `glossary`: show the meaning of terms.

use serde_json::{Value, json};

use super::super::response::CommandResponse;
use novamind_glossary::{Explanation, Subject, Term, terms};
use novamind_report::term_picture::term_picture_for_session;
use novamind_session::Session;
use novamind_tools::ParameterNumbers;

/// Executes `explain TERM` and `what TERM`.
pub(super) fn explain(command: &str, words: &str, numbers: &ParameterNumbers) -> CommandResponse {
    let column = command.chars().count() + 2;
    if words.is_empty() {
        return CommandResponse::syntax_error(
            format!("{command} needs a term, for example {command} runway"),
            column,
        );
    }
    match novamind_glossary::find_subject(words) {
        Ok(found) => explain_subject("explain", found, numbers),
        Err(near) if near.is_empty() => CommandResponse::syntax_error(
            format!("unknown term {words}; type glossary to list all terms"),
            column,
        ),
        Err(near) => CommandResponse::syntax_error(
            format!(
                "unknown term {words}; did you mean {}? type glossary to list all terms",
                near.join(" or ")
            ),
            column,
        ),
    }
}

/// Returns the response that explains a term, tool, argument, table or column.
pub(super) fn explain_subject(
    command: &str,
    subject: Subject,
    numbers: &ParameterNumbers,
) -> CommandResponse {
    let explanation = Explanation::new(subject, numbers);
    let sections: Vec<Value> = explanation
        .sections
        .iter()
        .map(|section| json!({ "name": section.name, "text": section.text }))
        .collect();
    let see: Vec<String> = explanation.related.iter().map(Subject::name).collect();
    let data = json!({
        "name": subject.name(),
        "kind": subject.kind(),
        "title": explanation.title,
        "sections": sections,
        "see": see,
    });
    CommandResponse::success(command, explanation.to_text(), data)
}

/// Executes `glossary [WORD]`. If the word is a term with a picture, appends the picture.
pub(super) fn glossary(word: &str, session: &Session) -> CommandResponse {
    let wanted = word.to_lowercase();
    let holds = |term: &&Term| {
        [&term.id, &term.title, &term.text].iter().any(|text| text.to_lowercase().contains(&wanted))
            || term.aka.iter().any(|other| other.to_lowercase().contains(&wanted))
    };
    let found: Vec<&Term> = terms().iter().filter(holds).collect();
    if found.is_empty() {
        return CommandResponse::syntax_error(
            format!("no term contains {word}; type glossary to list all terms"),
            10,
        );
    }
    let width = found.iter().map(|term| term.id.len()).max().unwrap_or(0);
    let mut text = String::new();
    let mut topic = "";
    for term in &found {
        if term.topic != topic {
            topic = &term.topic;
            text += &format!("{topic}\n");
        }
        text += &format!("  {:<width$}  {}\n", term.id, term.text);
    }
    let count = if found.len() == 1 { "1 term".to_owned() } else { format!("{} terms", found.len()) };
    let picture = match novamind_glossary::find_subject(word) {
        Ok(Subject::Term(term)) => term_picture_for_session(&term.id, session),
        _ => None,
    };
    let mut data = json!({ "terms": found });
    if let Some(picture) = &picture {
        data["picture"] = picture.to_text().into();
    }
    let picture = picture.map_or(String::new(), |picture| format!("\n{}", picture.to_text()));
    CommandResponse::success(
        "glossary",
        format!("{text}({count}; explain TERM for more)\n{picture}").trim_end().to_owned(),
        data,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;
    use novamind_session::identifiers::Group;
    use novamind_session::{NewRun, Session};

    /// Collects the field names in a response, except the keys of maps by group.
    fn collect_field_names(value: &Value, found: &mut Vec<String>) {
        match value {
            Value::Object(map) => map.iter().for_each(|(name, value)| {
                if Group::parse(name).is_none() {
                    found.push(name.clone());
                }
                collect_field_names(value, found);
            }),
            Value::Array(items) => items.iter().for_each(|item| collect_field_names(item, found)),
            _ => {}
        }
    }

    /// Returns the labels of a dashboard: words before a colon, headings and column heads. Omits plans.
    fn dashboard_labels(dashboard: &str) -> Vec<String> {
        let mut found = Vec::new();
        for line in dashboard.lines() {
            if let Some(title) = line.strip_prefix("--- ").and_then(|rest| rest.strip_suffix(" ---")) {
                found.push(title.to_owned());
            } else if line.starts_with("Group ") {
                let columns = line.split("  ").map(str::trim);
                found.extend(
                    columns.filter(|word| !word.is_empty() && !word.contains("(T")).map(str::to_owned),
                );
            } else if !line.starts_with("- ") && !line.starts_with("Day ") {
                found.extend(line.split(" | ").filter_map(|part| Some(part.split_once(": ")?.0.to_owned())));
            }
        }
        found
    }

    #[test]
    fn every_label_has_a_glossary_term() {
        let new = NewRun { seed: Some(3), ..NewRun::default() };
        let mut run = Session::create(new, &Configuration::bundled()).expect("a run");
        run.call("post_social_media", &json!({"content": "We open today."}), Via::Script).expect("a post");
        let mut words = Vec::new();
        for week in 0..10 {
            let forecasts = run.company().naive_forecasts();
            let week = run.advance(&format!("week {week}"), &forecasts, Via::Script, &mut |_| {});
            words.extend(dashboard_labels(&week.expect("a week").dashboard));
        }
        for label in ["Your posts", "Enterprise Lost", "Group bonus", "Settings", "Dev"] {
            assert!(words.iter().any(|word| word == label), "{label}: {words:?}");
        }
        for (tool, arguments) in [
            ("get_group_insights", json!({"group_id": "S1"})),
            ("get_group_insights", json!({"group_id": "E1"})),
            ("get_market_overview", json!({})),
        ] {
            collect_field_names(&run.call(tool, &arguments, Via::Script).expect(tool).to_json(), &mut words);
        }
        assert!(words.iter().any(|word| word == "cycle_phase"), "the economy is published: {words:?}");
        words.push("as_of".to_owned());
        words.sort_unstable();
        words.dedup();
        let unknown = |word: &&String| !explain("explain", word, &ParameterNumbers::bundled()).is_success();
        assert_eq!(words.iter().filter(unknown).collect::<Vec<_>>(), Vec::<&String>::new());
    }

    #[test]
    fn explain_returns_text_and_data() {
        let command_response = explain("what", "Delivered quality", &ParameterNumbers::bundled());
        let text = command_response.to_text();
        assert!(text.starts_with("Delivered quality (product)\n"), "{text}");
        assert!(
            text.contains("\nmore: The sum of base quality") && text.contains("\nsee: base-quality"),
            "{text}"
        );
        let object = command_response.to_json(3, 7);
        assert_eq!((&object["command"], &object["data"]["kind"]), (&json!("explain"), &json!("term")));
        assert!(explain("explain", "set_prices.A", &ParameterNumbers::bundled()).is_success());
        for word in "needs rules margin spread load asked needed_quota days_left patience relationship risk"
            .split(' ')
        {
            assert!(explain("explain", word, &ParameterNumbers::bundled()).is_success(), "{word}");
        }
    }

    #[test]
    fn unknown_terms_get_suggestions() {
        for (words, part, column) in [
            ("", "needs a term", 9),
            ("runwey", "did you mean runway", 9),
            ("qqqqqqqqqqqq", "type glossary to list all terms", 9),
        ] {
            match explain("explain", words, &ParameterNumbers::bundled()) {
                CommandResponse::SyntaxError { problem, column: at, .. } => {
                    assert!(problem.contains(part), "{problem}");
                    assert_eq!(at, column);
                }
                other => panic!("{words}: {other:?}"),
            }
        }
    }

    #[test]
    fn glossary_lists_terms_by_topic_and_by_word() {
        let run = Session::create(NewRun::default(), &Configuration::bundled()).expect("a run");
        let all = glossary("", &run).to_text();
        assert!(all.starts_with("money\n  cash ") && all.contains("\ncustomers\n"), "{all}");
        assert!(all.lines().count() > 110);
        let some = glossary("Churn", &run).to_text();
        assert!(some.contains("retention-thread") && !some.contains("runway"), "{some}");
        assert!(!glossary("no such word", &run).is_success());
    }

    #[test]
    fn glossary_draws_pictures_from_the_run() {
        let run = Session::create(NewRun::default(), &Configuration::bundled()).expect("a run");
        for (word, part) in [
            ("participation curve", "a budget of $50"),
            ("fit", "Shaded: mean required quality"),
            ("spill-over", "reaches a group"),
            ("quality-bank", "base quality      "),
        ] {
            let text = glossary(word, &run).to_text();
            assert!(text.contains(part) && text.contains("explain TERM for more"), "{word}: {text}");
        }
        assert!(!glossary("churn", &run).to_text().contains(" |"));
    }
}
