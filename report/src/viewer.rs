//! Viewer: the script and the style that show the record of a print, in a report and in any other page.
//!
//! The script is one expression, `corehbotViewer`, in plain JavaScript of small files, without a build tool. It draws
//! lines by WebGL 2 itself. three.js has 700 kB, and makes an object for each draw call of this script. Its lines are
//! instances, which a software renderer draws forty times slower. uPlot (50 kB) draws curves; it is in `viewer/uplot`
//! with its licence and its SHA-256.
//!
//! | call | job |
//! |---|---|
//! | `openRecord(root, data, streams)` | shows a record in an element, and replaces its content |
//! | `openPreview(root, data, blobs)` | shows a first picture of a large record there, before the rest is read |
//! | `streamsOfPage()`, `streamOfPage(name)` | the streams that are in the page's own scripts |
//! | `joinPage()` | waits for the page around it, which may have put the report into a frame |
//! | `recordOfText(text)` | data and streams in the text of a report |

/// The page of a report.
pub(crate) const TEMPLATE: &str = include_str!("viewer/page.html");

/// uPlot 1.6.32, from its npm package `uplot`.
const UPLOT: &str = include_str!("viewer/uplot/uPlot.iife.min.js");

/// The files of the script; each uses only names of those before it, or inside of functions.
const PARTS: [&str; 29] = [
    include_str!("viewer/words.js"),
    include_str!("viewer/colours.js"),
    include_str!("viewer/pieces.js"),
    include_str!("viewer/graph.js"),
    include_str!("viewer/camera.js"),
    include_str!("viewer/streams.js"),
    include_str!("viewer/moves.js"),
    include_str!("viewer/path.js"),
    include_str!("viewer/measures.js"),
    include_str!("viewer/lines.js"),
    include_str!("viewer/player.js"),
    include_str!("viewer/pick.js"),
    include_str!("viewer/stage.js"),
    include_str!("viewer/controls.js"),
    include_str!("viewer/marks.js"),
    include_str!("viewer/gcode.js"),
    include_str!("viewer/find.js"),
    include_str!("viewer/objects.js"),
    include_str!("viewer/view.js"),
    include_str!("viewer/curves.js"),
    include_str!("viewer/charts.js"),
    include_str!("viewer/motion.js"),
    include_str!("viewer/heat.js"),
    include_str!("viewer/document.js"),
    include_str!("viewer/facts.js"),
    include_str!("viewer/mesh.js"),
    include_str!("viewer/compare.js"),
    include_str!("viewer/frame.js"),
    include_str!("viewer/open.js"),
];

/// How many of them any page begins with: words, colours, charts, and a camera.
const SHARED: usize = 5;

/// The script that pages without a print begin with, and in which the names of the viewer are theirs.
pub(crate) fn shared() -> String {
    let parts = PARTS.get(..SHARED).unwrap_or_default().join("\n");
    format!("{UPLOT}\n{parts}\n")
}

/// The script: a declaration of `corehbotViewer`, and nothing else that another script could see.
#[must_use]
pub fn script() -> String {
    let parts = PARTS.join("\n");
    let door = "return { openRecord, openPreview, streamsOfPage, streamOfPage, recordOfText, joinPage };";
    format!("const corehbotViewer = (() => {{\n\"use strict\";\n{UPLOT}\n{parts}\n{door}\n}})();\n")
}

/// The style of the viewer; the look of all pages comes first.
#[must_use]
pub fn style() -> String {
    [
        include_str!("print/page.css"),
        include_str!("viewer/uplot/uPlot.min.css"),
        "\n",
        include_str!("viewer/viewer.css"),
        include_str!("viewer/paper.css"),
    ]
    .concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sha2::{Digest as _, Sha256};

    #[test]
    fn the_bundle_is_the_one_whose_hash_stands_beside_it() {
        let files = [
            ("LICENSE", include_str!("viewer/uplot/LICENSE")),
            ("uPlot.iife.min.js", UPLOT),
            ("uPlot.min.css", include_str!("viewer/uplot/uPlot.min.css")),
        ];
        let told: String = files
            .iter()
            .map(|(name, text)| {
                let hash: String = Sha256::digest(text).iter().map(|byte| format!("{byte:02x}")).collect();
                format!("{hash}  {name}\n")
            })
            .collect();
        assert_eq!(told, include_str!("viewer/uplot/SHA256SUMS"));
    }

    #[test]
    fn script_and_style_stand_in_a_page_and_need_no_network() {
        let script = script();
        assert!(!script.contains("</script") && !script.contains("<!--"), "they would end the script");
        assert!(!style().contains("</style"));
        for text in
            PARTS.into_iter().chain([TEMPLATE, include_str!("viewer/viewer.css"), include_str!("viewer/paper.css")])
        {
            // The name of SVG is no address that is asked.
            let text = text.replace("\"http://www.w3.org/2000/svg\"", "");
            assert!(!["http://", "https://", "@import", "fetch("].iter().any(|word| text.contains(word)), "{text}");
        }
        // One comment of uPlot names its project.
        assert_eq!(UPLOT.matches("://").count(), 1);
        assert!(!UPLOT.contains("fetch(") && !UPLOT.contains("XMLHttpRequest"));
    }

    #[test]
    fn every_file_of_the_script_is_in_it() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/viewer");
        let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
        let scripts: Vec<_> = files.filter(|path| path.extension().is_some_and(|end| end == "js")).collect();
        assert_eq!(scripts.len(), PARTS.len(), "{scripts:?}");
        let texts: Vec<_> = scripts.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
        assert!(texts.iter().all(|text| PARTS.contains(&text.as_str())));
        assert!(texts.iter().all(|text| text.starts_with("// ")), "the first line says what a file is for");
    }
}
