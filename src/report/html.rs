//! Writes a page as one self-contained HTML file without scripts. Light or dark follows the reader's system.

use super::page::{Bar, Block, Fact, Page, Table};
use super::svg;
use novamind_base::notation::escaped_html;

pub(super) const STYLE: &str = include_str!("../../assets/report.css");

/// Returns the page as HTML.
pub fn write(page: &Page) -> String {
    let tags: String = page.tags.iter().map(|tag| format!("<li>{}</li>", escaped_html(tag))).collect();
    let mut body = String::new();
    let folded = page.blocks.iter().filter(|block| matches!(block, Block::Folded { .. })).count();
    let mut shape = Shape { charts: 0, unfolded: folded <= MOST_UNFOLDED };
    let mut open = false;
    for block in &page.blocks {
        if let Block::Heading(text) = block {
            if open {
                body.push_str("</section>\n");
            }
            open = true;
            body.push_str(&format!("<section>\n<h2>{}</h2>\n", escaped_html(text)));
        } else {
            body.push_str(&written(block, &mut shape));
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
        title = escaped_html(&page.title),
        headline = escaped_html(&page.headline),
        foot = escaped_html(&page.foot),
    )
}

/// Number of sections that start expanded; with more of them, all start collapsed.
const MOST_UNFOLDED: usize = 12;

struct Shape {
    charts: usize,
    unfolded: bool,
}

fn written(block: &Block, shape: &mut Shape) -> String {
    match block {
        Block::Heading(text) => format!("<h2>{}</h2>\n", escaped_html(text)),
        Block::Text(text) => format!("<p>{}</p>\n", escaped_html(text)),
        Block::Note(text) => format!("<p class=\"note\">{}</p>\n", escaped_html(text)),
        Block::Warning(text) => format!("<p class=\"warning\">{}</p>\n", escaped_html(text)),
        Block::Facts(facts) => {
            let class = if facts.len().is_multiple_of(3) { "facts thirds" } else { "facts" };
            format!("<dl class=\"{class}\">\n{}</dl>\n", facts.iter().map(fact).collect::<String>())
        }
        Block::Table(own) => table(own),
        Block::Bars(bars) => {
            format!("<ol class=\"bars\">\n{}</ol>\n", bars.iter().map(bar).collect::<String>())
        }
        Block::Chart(chart) => {
            shape.charts += 1;
            format!(
                "<figure>\n<figcaption>{}</figcaption>\n{}</figure>\n",
                escaped_html(&chart.title),
                svg::draw(chart, shape.charts)
            )
        }
        Block::Folded { title, note, lines, points } => {
            let lines: String = lines.iter().map(|line| format!("<p>{}</p>\n", escaped_html(line))).collect();
            let points = if points.is_empty() { String::new() } else { list(points) };
            let open = if shape.unfolded { " open=\"open\"" } else { "" };
            format!(
                "<details{open}>\n<summary><span>{}</span> <span class=\"amount\">{}</span></summary>\n{lines}{points}</details>\n",
                escaped_html(title),
                escaped_html(note)
            )
        }
    }
}

fn list(lines: &[String]) -> String {
    let items: String = lines.iter().map(|line| format!("<li>{}</li>\n", escaped_html(line))).collect();
    format!("<ul>\n{items}</ul>\n")
}

fn fact(fact: &Fact) -> String {
    let note = match fact.note.is_empty() {
        true => String::new(),
        false => format!("<dd class=\"note\">{}</dd>", escaped_html(&fact.note)),
    };
    format!(
        "<div><dt>{}</dt><dd class=\"value\">{}</dd>{note}</div>\n",
        escaped_html(&fact.name),
        escaped_html(&fact.value)
    )
}

fn table(table: &Table) -> String {
    let class = |number: bool| if number { " class=\"number\"" } else { "" };
    let head: String = table
        .columns
        .iter()
        .map(|(name, number)| format!("<th scope=\"col\"{}>{}</th>", class(*number), escaped_html(name)))
        .collect();
    let row = |row: &Vec<String>| {
        let cells: String = row
            .iter()
            .zip(&table.columns)
            .map(|(cell, (_, number))| format!("<td{}>{}</td>", class(*number), escaped_html(cell)))
            .collect();
        format!("<tr>{cells}</tr>\n")
    };
    format!(
        "<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{}</tbody>\n</table></div>\n",
        table.rows.iter().map(row).collect::<String>()
    )
}

fn bar(bar: &Bar) -> String {
    let class = if bar.own { " class=\"own\"" } else { "" };
    format!(
        "<li{class}><span class=\"name\">{}</span><span class=\"amount\">{}</span>\
         <span class=\"track\"><span style=\"width:{:.1}%\"></span></span></li>\n",
        escaped_html(&bar.name),
        escaped_html(&bar.shown),
        bar.share.clamp(0.0, 1.0) * 100.0
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Story, as_html, as_markdown, test_kit};

    fn check(html: &str) {
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
    fn every_report_is_well_formed_and_stands_alone() {
        for session in [test_kit::played(0), test_kit::played(5), test_kit::finished(), test_kit::ruined()] {
            let html = as_html(&Story::of(&session));
            check(&html);
            for foreign in ["<script", "http://", "https://", "src=", "href=", "url(", "@import"] {
                assert!(!html.contains(foreign), "{foreign}");
            }
            for part in ["prefers-color-scheme: dark", "charset=\"utf-8\"", "<h1>Day "] {
                assert!(html.contains(part), "{part}");
            }
        }
    }

    #[test]
    fn what_people_write_stays_text() {
        let story = Story::of(&test_kit::played(3));
        let html = as_html(&story);
        assert!(
            html.contains("Ada &lt;ada@example.org&gt;") && html.contains("NovaMind &lt;opens&gt; today")
        );
        assert!(html.contains("otherwise we go back | &lt;b&gt;B&lt;/b&gt;") && !html.contains("<b>"));
        let markdown = as_markdown(&story);
        assert!(markdown.contains("otherwise we go back \\| \\<b\\>B\\</b\\>"), "{markdown}");
        assert!(markdown.contains("\\*three\\* plans \\& fair"), "{markdown}");
        assert_eq!(escaped_html("<a b=\"c\">'&\u{7}\n"), "&lt;a b=&quot;c&quot;&gt;&#39;&amp; ");
    }

    #[test]
    fn every_chart_has_a_title_and_a_summary() {
        let html = as_html(&Story::of(&test_kit::finished()));
        let charts = html.matches("<svg ").count();
        assert!(charts >= 4, "{charts}");
        for number in 1..=charts {
            assert!(html.contains(&format!("<title id=\"t{number}\">")), "{number}");
            assert!(html.contains(&format!("<desc id=\"d{number}\">")), "{number}");
        }
    }

    #[test]
    fn the_same_run_gives_the_same_report_but_for_its_name() {
        let told = |session: novamind_session::Session| {
            let id = session.manifest().id.clone();
            let story = Story::of(&session);
            (as_markdown(&story).replace(&id, "RUN"), as_html(&story).replace(&id, "RUN"))
        };
        assert_eq!(told(test_kit::finished()), told(test_kit::finished()));
    }
}
