use unicode_width::UnicodeWidthStr;

use super::*;

fn sample_report() -> LabReport {
    let mut table = LabTable::new(
        "policies",
        "Final cash over 3 seeds",
        vec![
            Column::text("policy", "policy"),
            Column::number("cash", "median final cash", Measure::Dollars),
            Column::interval("cash_interval", "95 % interval of the median", Measure::Dollars),
            Column::number("survived", "share that survived", Measure::Share),
            Column::number("gini", "evenness", Measure::Number(2)),
        ],
    );
    table.rows.push(vec![
        CellValue::text("mid book, S1 only, heavy"),
        CellValue::number(15_756_408.25),
        CellValue::interval(Some(Interval { low: 9_000_000.5, high: 21_000_000.0 })),
        CellValue::number(2.0 / 3.0),
        CellValue::number(0.1),
    ]);
    table.rows.push(vec![
        CellValue::text("idle"),
        CellValue::number(957_500.0),
        CellValue::interval(None),
        CellValue::number(1.0),
        CellValue::NumberWithMeasure(12.0, Measure::Days),
    ]);
    LabReport::with_table("Baselines", table).with_note("Seeds 1 to 3; same random draws for every policy.")
}

#[test]
fn table_keeps_its_width_if_it_fits() {
    let text = sample_report().to_text(100);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[0], "Baselines");
    assert!(text.contains("$15,756,408") && text.contains("66.7%"), "{text}");
    assert!(text.contains("$9,000,000 to $21,000,000"), "{text}");
    let dollars = |line: &&&str| line.contains("15,756,408") || line.contains("957,500");
    let ends: Vec<usize> = lines.iter().filter(dollars).map(|line| line.find("00  ").unwrap_or(0)).collect();
    assert_eq!(ends.len(), 2, "{text}");
    assert_eq!(lines.last(), Some(&"Seeds 1 to 3; same random draws for every policy."));
}

#[test]
fn table_fits_the_width_and_keeps_every_cell() {
    for width in 40..=100 {
        let text = sample_report().to_text(width);
        assert!(text.lines().all(|line| line.width() <= width), "{width}:\n{text}");
        for word in ["66.7%", "0.10", "12", "957,500", "idle", "evenness"] {
            let shortened = word == "957,500" && text.contains("$958k");
            assert!(text.contains(word) || shortened, "{word} at {width}:\n{text}");
        }
    }
}

#[test]
fn wrapped_columns_repeat_the_row_names() {
    let columns = ["policy", "scenario", "overrides"].map(|name| Column::text(name, name));
    let figures = ["lower quartile", "median", "upper quartile"];
    let figures = figures.map(|name| Column::number(name, name, Measure::Dollars));
    let mut table = LabTable::new("arms", "", columns.into_iter().chain(figures).collect());
    for (policy, scenario) in [("idle", "default"), ("idle", "competitor-hard"), ("baseline", "default")] {
        let words = [policy, scenario, "as shipped"].map(CellValue::text);
        table.rows.push(words.into_iter().chain([1e6, 2e6, 3e6].map(CellValue::Number)).collect());
    }
    table.summary.push(
        ["all", "", ""].map(CellValue::text).into_iter().chain([4e6; 3].map(CellValue::Number)).collect(),
    );
    let text = LabReport::with_table("Arms", table.clone()).to_text(58);
    assert_eq!(text.matches("competitor-hard").count(), 2, "it is complete in both panels:\n{text}");
    assert_eq!(text.matches("as shipped").count(), 3, "the scenario is sufficient:\n{text}");
    let rules = text.lines().filter(|line| line.starts_with('─')).count();
    assert_eq!(rules, 4, "a head and a summary in each panel:\n{text}");
    // If the three columns of row names do not fit next to a figure, row numbers identify the rows in every panel.
    table.rows[0][2] = CellValue::text("without surges");
    table.rows[1][1] = CellValue::text("default");
    let text = LabReport::with_table("Arms", table).to_text(41);
    for number in ["1", "2", "3"] {
        let named = text.lines().filter(|line| line.split_whitespace().next() == Some(number)).count();
        assert!(named >= 2, "{number}:\n{text}");
    }
}

#[test]
fn csv_has_full_numbers_and_two_columns_per_interval() {
    let rows = sample_report().tables[0].to_csv_rows();
    assert_eq!(rows[0], ["policy", "cash", "cash_interval_low", "cash_interval_high", "survived", "gini"]);
    assert_eq!(rows[1][1..4], ["15756408.25", "9000000.5", "21000000"]);
    assert_eq!(rows[1][4].parse::<f64>(), Ok(2.0 / 3.0));
    assert_eq!(rows[2], ["idle", "957500", "", "", "1", "12"]);
    let json = sample_report().to_json();
    let table = &json["tables"]["policies"];
    assert_eq!(table["columns"][1]["unit"], "dollars");
    assert_eq!(table["columns"][0]["unit"], serde_json::Value::Null);
    assert_eq!(table["rows"][0]["cash_interval"]["low"], 9_000_000.5);
    assert_eq!(table["rows"][1]["cash_interval"], serde_json::Value::Null);
    assert_eq!(table["rows"][1]["gini"], serde_json::json!({ "value": 12, "unit": "days" }));
    assert_eq!(json["intervals"]["level"], 0.95);
}

#[test]
fn graphs_fit_as_text_and_are_self_contained_as_svg() {
    let points = |factor: f64| (1..=50).map(|at| (f64::from(at), factor * f64::from(at))).collect();
    let axis = |label| GraphAxis { label, scale: AxisScale::Logarithmic };
    let graph = Graph {
        title: "Subscribers by day".to_owned(),
        summary: "Both rise.".to_owned(),
        x_axis: axis("day"),
        y_axis: axis("subscribers"),
        series: vec![
            Series { name: "off".to_owned(), points: points(10.0) },
            Series { name: "hard <1>".to_owned(), points: points(1.0) },
        ],
        form: GraphForm::Lines,
    };
    let bars = Graph { form: GraphForm::Bars, ..graph.clone() };
    assert_eq!(sample_report().to_svg(), None);
    let lab_report = LabReport { graphs: vec![graph, bars], ..sample_report() };
    let text = lab_report.to_text(60);
    assert!(text.lines().all(|line| line.width() <= 60), "{text}");
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let legend = "x: day (logarithmic), y: subscribers (logarithmic): * off; + hard <1>";
    assert!(words.contains(legend) && text.contains('█'), "{text}");
    let svg = lab_report.to_svg().expect("graphs");
    assert!(svg.contains("hard &lt;1&gt;") && svg.contains("<rect class=\"part f1\""), "{svg}");
    assert_eq!(lab_report.to_json()["graphs"][0]["series"][1]["points"][0], serde_json::json!([1, 1]));
}
