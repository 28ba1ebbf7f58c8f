//! Writes a page as one self-contained HTML file without scripts. The page is light or dark, depending on the
//! reader's system settings.

use super::page::{Bar, Block, NamedValue, Page, Table};
use super::svg;
use novamind_base::formatting::escape_html;

pub(super) const STYLE: &str = include_str!("../../assets/report.css");

/// Returns a page as a complete HTML document.
pub fn to_html(page: &Page) -> String {
    let tags: String = page.tags.iter().map(|tag| format!("<li>{}</li>", escape_html(tag))).collect();
    let mut body = String::new();
    let folded = page.blocks.iter().filter(|block| matches!(block, Block::Collapsible { .. })).count();
    let mut context = BlockContext { chart_count: 0, is_unfolded: folded <= MAX_EXPANDED_SECTIONS };
    let mut open = false;
    for block in &page.blocks {
        if let Block::Heading(text) = block {
            if open {
                body.push_str("</section>\n");
            }
            open = true;
            body.push_str(&format!("<section>\n<h2>{}</h2>\n", escape_html(text)));
        } else {
            body.push_str(&block_html(block, &mut context));
        }
    }
    if open {
        body.push_str("</section>\n");
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n\
         <body>\n<main>\n<header>\n<p class=\"brand\">{title}</p>\n<h1>{headline}</h1>\n<ul class=\"tags\">{tags}</ul>\n\
         </header>\n{body}<footer><p>{foot}</p></footer>\n</main>\n</body>\n</html>\n",
        title = escape_html(&page.title),
        headline = escape_html(&page.headline),
        foot = escape_html(&page.footer),
    )
}

/// Maximum number of collapsible sections that are initially expanded. On a page with more sections, all of them are
/// collapsed.
const MAX_EXPANDED_SECTIONS: usize = 12;

struct BlockContext {
    chart_count: usize,
    is_unfolded: bool,
}

fn block_html(block: &Block, context: &mut BlockContext) -> String {
    match block {
        Block::Heading(text) => format!("<h2>{}</h2>\n", escape_html(text)),
        Block::Text(text) => format!("<p>{}</p>\n", escape_html(text)),
        Block::Note(text) => format!("<p class=\"note\">{}</p>\n", escape_html(text)),
        Block::Warning(text) => format!("<p class=\"warning\">{}</p>\n", escape_html(text)),
        Block::Facts(facts) => {
            let class = if facts.len().is_multiple_of(3) { "facts thirds" } else { "facts" };
            format!("<dl class=\"{class}\">\n{}</dl>\n", facts.iter().map(fact_html).collect::<String>())
        }
        Block::Table(table) => table_html(table),
        Block::Bars(bars) => {
            format!("<ol class=\"bars\">\n{}</ol>\n", bars.iter().map(bar_html).collect::<String>())
        }
        Block::Chart(chart) => {
            context.chart_count += 1;
            format!(
                "<figure>\n<figcaption>{}</figcaption>\n{}</figure>\n",
                escape_html(&chart.title),
                svg::draw(chart, context.chart_count)
            )
        }
        Block::Collapsible { title, note, lines, points } => {
            let lines: String = lines.iter().map(|line| format!("<p>{}</p>\n", escape_html(line))).collect();
            let points = if points.is_empty() { String::new() } else { list_html(points) };
            let open = if context.is_unfolded { " open=\"open\"" } else { "" };
            format!(
                "<details{open}>\n<summary><span>{}</span> <span class=\"amount\">{}</span></summary>\n{lines}{points}</details>\n",
                escape_html(title),
                escape_html(note)
            )
        }
    }
}

fn list_html(lines: &[String]) -> String {
    let items: String = lines.iter().map(|line| format!("<li>{}</li>\n", escape_html(line))).collect();
    format!("<ul>\n{items}</ul>\n")
}

fn fact_html(fact: &NamedValue) -> String {
    let note = match fact.note.is_empty() {
        true => String::new(),
        false => format!("<dd class=\"note\">{}</dd>", escape_html(&fact.note)),
    };
    format!(
        "<div><dt>{}</dt><dd class=\"value\">{}</dd>{note}</div>\n",
        escape_html(&fact.name),
        escape_html(&fact.value)
    )
}

fn table_html(table: &Table) -> String {
    let class = |number: bool| if number { " class=\"number\"" } else { "" };
    let head: String = table
        .columns
        .iter()
        .map(|(name, number)| format!("<th scope=\"col\"{}>{}</th>", class(*number), escape_html(name)))
        .collect();
    let row = |row: &Vec<String>| {
        let cells: String = row
            .iter()
            .zip(&table.columns)
            .map(|(cell, (_, number))| format!("<td{}>{}</td>", class(*number), escape_html(cell)))
            .collect();
        format!("<tr>{cells}</tr>\n")
    };
    format!(
        "<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{}</tbody>\n</table></div>\n",
        table.rows.iter().map(row).collect::<String>()
    )
}

fn bar_html(bar: &Bar) -> String {
    let class = if bar.is_highlighted { " class=\"own\"" } else { "" };
    format!(
        "<li{class}><span class=\"name\">{}</span><span class=\"amount\">{}</span>\
         <span class=\"track\"><span style=\"width:{:.1}%\"></span></span></li>\n",
        escape_html(&bar.name),
        escape_html(&bar.value_text),
        bar.share.clamp(0.0, 1.0) * 100.0
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RunReport, report_to_html, report_to_markdown, test_kit};

    fn assert_well_formed(html: &str) {
        let mut open: Vec<&str> = Vec::new();
        let mut rest = html.strip_prefix("<!DOCTYPE html>").expect("a document type");
        while let Some(at) = rest.find('<') {
            assert!(!rest[..at].contains('>'), "a stray > before {}", &rest[at..rest.len().min(at + 80)]);
            let end = at + rest[at..].find('>').expect("a tag that ends");
            let tag = &rest[at + 1..end];
            let name = |tag| str::split(tag, [' ', '\n']).next().unwrap_or_default();
            match (tag.strip_prefix('/'), tag.strip_suffix('/')) {
                (Some(closed), _) => {
                    assert_eq!(open.pop(), Some(name(closed)), "before {}", &rest[..end + 1])
                }
                (None, Some(_)) => {}
                (None, None) => open.push(name(tag)),
            }
            assert_eq!(tag.matches('"').count() % 2, 0, "quotes in {tag}");
            rest = &rest[end + 1..];
        }
        assert_eq!(open, Vec::<&str>::new(), "all closed");
    }

    #[test]
    fn every_report_is_well_formed_and_self_contained() {
        for session in [
            test_kit::play_weeks(0),
            test_kit::play_weeks(5),
            test_kit::finished_run(),
            test_kit::bankrupt_run(),
        ] {
            let html = report_to_html(&RunReport::from_session(&session));
            assert_well_formed(&html);
            for foreign in ["<script", "http://", "https://", "src=", "href=", "url(", "@import"] {
                assert!(!html.contains(foreign), "{foreign}");
            }
            for part in ["prefers-color-scheme: dark", "charset=\"utf-8\"", "<h1>Day "] {
                assert!(html.contains(part), "{part}");
            }
        }
    }

    #[test]
    fn user_text_is_escaped() {
        let report = RunReport::from_session(&test_kit::play_weeks(3));
        let html = report_to_html(&report);
        assert!(
            html.contains("Ada &lt;ada@example.org&gt;") && html.contains("NovaMind &lt;opens&gt; today")
        );
        assert!(html.contains("otherwise we go back | &lt;b&gt;B&lt;/b&gt;") && !html.contains("<b>"));
        let markdown = report_to_markdown(&report);
        assert!(markdown.contains("otherwise we go back \\| \\<b\\>B\\</b\\>"), "{markdown}");
        assert!(markdown.contains("\\*three\\* plans \\& fair"), "{markdown}");
        assert_eq!(escape_html("<a b=\"c\">'&\u{7}\n"), "&lt;a b=&quot;c&quot;&gt;&#39;&amp; ");
    }

    #[test]
    fn every_chart_has_a_title_and_a_summary() {
        let html = report_to_html(&RunReport::from_session(&test_kit::finished_run()));
        let charts = html.matches("<svg ").count();
        assert!(charts >= 4, "{charts}");
        for number in 1..=charts {
            assert!(html.contains(&format!("<title id=\"t{number}\">")), "{number}");
            assert!(html.contains(&format!("<desc id=\"d{number}\">")), "{number}");
        }
    }

    #[test]
    fn reports_of_equal_runs_differ_only_in_the_run_name() {
        let reports = |session: novamind_session::Session| {
            let id = session.manifest().id.clone();
            let report = RunReport::from_session(&session);
            (report_to_markdown(&report).replace(&id, "RUN"), report_to_html(&report).replace(&id, "RUN"))
        };
        assert_eq!(reports(test_kit::finished_run()), reports(test_kit::finished_run()));
    }
}
