//! All reports as one page of HTML: pictures inside, nothing from elsewhere, readable on paper.

use std::{collections::BTreeMap, io};

use base64::{Engine, engine::general_purpose::STANDARD};

use super::{
    Effort, Figure, Remedy, Report, Row,
    remedy::HEAD,
    table::{number, short, verdict},
};
use crate::output::record::Build;

const STYLE: &str = "
body { font: 16px/1.5 system-ui, sans-serif; color: #1c1c1c; background: #fff; max-width: 1080px; margin: 2em auto; padding: 0 1em }
h1 { font-size: 1.7em } h2 { font-size: 1.3em; border-top: 1px solid #bbb; padding-top: 1em; margin-top: 2.4em }
table { border-collapse: collapse; width: 100%; font-size: .88em; font-variant-numeric: tabular-nums }
th, td { text-align: left; vertical-align: top; padding: .25em .6em; border-bottom: 1px solid #e4e4e4 }
th { border-bottom: 1px solid #888 } .n { text-align: right; white-space: nowrap }
.ok { color: #1c6b2c } .FAILED { color: #b00020; font-weight: bold } .reported { color: #666 }
figure { margin: 1.2em 0 } img { max-width: 100%; height: auto; border: 1px solid #ddd } figcaption { color: #444; font-size: .9em }
.small { color: #444; font-size: .88em } sup { line-height: 0 } a { color: #1a4f8b }
@media print { body { max-width: none; margin: 0; font-size: 10pt } tr, figure { break-inside: avoid } h2 { break-after: avoid } thead { display: table-header-group } }
";

/// The page of these reports.
///
/// # Errors
/// Those of drawing a picture.
pub fn page(reports: &[Report], effort: Effort, build: &Build) -> io::Result<String> {
    let sections = reports.iter().map(section).collect::<io::Result<Vec<_>>>()?;
    Ok(format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n<title>rmpm validate</title>\n<style>{STYLE}</style>\n</head>\n<body>\n{}{}{}</body>\n</html>\n",
        head(reports, effort, build),
        contents(reports),
        sections.concat()
    ))
}

fn head(reports: &[Report], effort: Effort, build: &Build) -> String {
    let rows = reports.iter().flat_map(|r| &r.rows);
    let failed: usize = reports.iter().map(Report::failed).sum();
    let judged = rows.clone().filter(|row| row.tolerance.is_some()).count();
    format!(
        "<h1>Validation of rmpm {}</h1>\n<p class=\"small\">commit {}, {}, {}; {}.</p>\n<p>{} rows: {judged} are judged against an exact or published answer, {failed} of them failed; the others are reported.</p>\n",
        escape(&build.version),
        escape(&build.commit),
        escape(&build.rustc),
        escape(&build.fp_path),
        match effort {
            Effort::Short => "short form: coarse grids, few sizes",
            Effort::Full => "full form: fine grids, all sizes",
        },
        rows.count()
    )
}

fn contents(reports: &[Report]) -> String {
    let rows: String = reports
        .iter()
        .map(|r| {
            let failed = r.failed();
            let judgement = if failed == 0 { "ok".to_owned() } else { format!("{failed} failed") };
            let class = if failed == 0 { "ok" } else { "FAILED" };
            let name = escape(&r.name);
            format!(
                "<tr><td><a href=\"#{name}\">{name}</a></td><td>{}</td><td class=\"{class}\">{judgement}</td><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
                escape(&r.about),
                r.cost.schemes().join(", "),
                r.cost.cpu_s.map_or_else(|| "-".to_owned(), |s| format!("{s:.1}")),
                r.particle_steps,
                r.cost.newton_iterations,
            )
        })
        .collect();
    format!(
        "<table>\n<thead><tr><th>problem</th><th>what is shown</th><th>verdict</th><th>schemes</th><th class=\"n\">CPU (s)</th><th class=\"n\">particle-steps</th><th class=\"n\">Newton iterations</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n"
    )
}

fn section(report: &Report) -> io::Result<String> {
    let figures = report.figures.iter().map(figure).collect::<io::Result<String>>()?;
    let remedies = remedies(&report.remedies);
    let (whys, numbers) = whys(&report.rows);
    let rows: String =
        report.rows.iter().map(|r| row(r, numbers.get(&r.why_tolerance).copied().unwrap_or(0))).collect();
    Ok(format!(
        "<section>\n<h2 id=\"{0}\">{0}</h2>\n<p>{1}</p>\n<p class=\"small\">Source: {2}</p>\n{remedies}{figures}<table>\n<thead><tr><th>quantity</th><th class=\"n\">exact</th><th class=\"n\">ours</th><th class=\"n\">error</th><th class=\"n\">tolerance</th><th>verdict</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table>\n<ol class=\"small\">\n{whys}</ol>\n{3}{4}</section>\n",
        escape(&report.name),
        sentence(&report.about),
        sentence(&report.source),
        notes(&report.notes),
        report.fault.iter().map(|f| format!("<p class=\"FAILED\">Stopped: {}</p>\n", escape(f))).collect::<String>()
    ))
}

/// The reasons of the tolerances as a list, and the number of each in it.
fn whys(rows: &[Row]) -> (String, BTreeMap<&String, usize>) {
    let (mut list, mut numbers) = (String::new(), BTreeMap::new());
    for row in rows {
        let next = numbers.len() + 1;
        numbers.entry(&row.why_tolerance).or_insert_with(|| {
            list += &format!("<li>{}</li>\n", sentence(&row.why_tolerance));
            next
        });
    }
    (list, numbers)
}

fn row(row: &Row, why: usize) -> String {
    let verdict = verdict(row);
    format!(
        "<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"{verdict}\">{verdict}<sup>{why}</sup></td></tr>\n",
        escape(&row.quantity),
        number(row.exact),
        number(Some(row.ours)),
        short(row.error),
        short(row.tolerance)
    )
}

fn figure(figure: &Figure) -> io::Result<String> {
    Ok(format!(
        "<figure><img alt=\"{}\" src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
        escape(&figure.title),
        STANDARD.encode(figure.png()?),
        sentence(&figure.caption)
    ))
}

fn notes(notes: &[String]) -> String {
    if notes.is_empty() {
        return String::new();
    }
    let items: String = notes.iter().map(|n| format!("<li>{}</li>\n", escape(n))).collect();
    format!("<p class=\"small\">Notes</p>\n<ul class=\"small\">\n{items}</ul>\n")
}

/// What remedies do, in a table; empty without one.
fn remedies(remedies: &[Remedy]) -> String {
    let class = |k: usize| if k < 4 { "" } else { " class=\"n\"" };
    let head: String = (0..).zip(HEAD).map(|(k, name)| format!("<th{}>{name}</th>", class(k))).collect();
    let line = |r: &Remedy| -> String {
        let cells = (0..).zip(r.cells());
        let cells: String = cells.map(|(k, text)| format!("<td{}>{}</td>", class(k), escape(&text))).collect();
        format!("<tr>{cells}</tr>\n")
    };
    let lines: String = remedies.iter().map(line).collect();
    if lines.is_empty() {
        return lines;
    }
    format!("<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{lines}</tbody>\n</table>\n")
}

/// With a capital and a full stop, escaped.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let capital: String = letters.next().map(|c| c.to_uppercase().collect()).unwrap_or_default();
    let stop = if text.ends_with(['.', '!', '?']) || text.is_empty() { "" } else { "." };
    escape(&format!("{capital}{}{stop}", letters.as_str()))
}

/// Text as it may stand in an element or in an attribute between double quotes.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::validate::{figure::Kind, reference::Reference};

    #[test]
    fn nothing_in_a_text_becomes_markup() {
        assert_eq!(escape("a < b & \"c\" > 'd'"), "a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39;");
        assert_eq!(sentence("h <- 0"), "H &lt;- 0.");
        assert_eq!(sentence(""), "");
    }

    #[test]
    fn the_page_is_whole_and_calls_for_nothing_from_elsewhere() {
        let text = "about = \"<script>a</script>\"\nsource = \"s\"\n[answer.x]\nquantity = \"x <b>\"\nexact = 2.0\nmeasure = \"relative\"\ntolerance = 0.01\nwhy = \"w\"\n";
        let reference = Reference::read(text).unwrap();
        let mut report = Report::new("n", &reference);
        [2.01, 2.5].into_iter().for_each(|ours| report.row(&reference, "x", ours).unwrap());
        report.note("a note & more");
        report.figure(Figure::new("t", "c", "x", "y").with("a", Kind::Line, vec![(0.0, 1.0), (1.0, 2.0)]));
        let page = page(&[report], Effort::Short, &Build::current()).unwrap();
        assert!(!page.contains("<script") && !page.contains("http") && !page.contains("x <b>"));
        assert!(page.contains("src=\"data:image/png;base64,iVBOR") && page.contains("a note &amp; more"));
        // one reason, told once; one of two rows fails
        assert_eq!((page.matches("<li>W.</li>").count(), page.matches(">FAILED<").count()), (1, 1));
        assert!(page.contains("<td class=\"FAILED\">1 failed</td>") && page.contains("2.01000"));
    }
}
