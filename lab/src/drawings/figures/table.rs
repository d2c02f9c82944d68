//! Table 1: each length by the paper's expression and by the model.

use crate::queries::paper::Paper;
use crate::queries::paper::table::{Row, TOOL};
use corehbot_report::svg::{Anchor, Drawing};

/// Height of a row, in pixels.
const ROW: f64 = 17.0;

/// Where the columns of a half end or begin.
const COLUMNS: [(f64, Anchor); 4] =
    [(0.0, Anchor::Start), (60.0, Anchor::Start), (220.0, Anchor::End), (300.0, Anchor::End)];

pub(super) fn table_1(paper: &Paper) -> String {
    let half = paper.table_1.len().div_ceil(2);
    let height = 92.0 + ROW * half as f64;
    let mut drawing =
        Drawing::new([720.0, height], "Table 1: the length of each segment and wrap of a CoreH-bot's belt");
    let title = format!("Table 1: lengths of the belt with the tool at ({}, {}) mm, e = 2r", TOOL.x, TOOL.y);
    drawing.text([16.0, 24.0], Anchor::Start, &title, "class=\"title\"");
    for (rows, left) in paper.table_1.chunks(half).zip([24.0, 384.0]) {
        line(
            &mut drawing,
            [left, 48.0],
            ["segment", "paper", "mm", "ours, mm"].map(str::to_owned),
            "style=\"font-weight:bold\"",
        );
        drawing.line([left, 53.0], [left + 300.0, 53.0], "class=\"thin\"");
        for (index, row) in rows.iter().enumerate() {
            line(&mut drawing, [left, 69.0 + ROW * index as f64], words(row), "");
        }
    }
    let off = paper.table_1.iter().map(|row| (row.ours_mm - row.printed_mm).abs()).fold(0.0, f64::max);
    let [printed, ours] =
        [|row: &Row| row.printed_mm, |row: &Row| row.ours_mm].map(|of| paper.table_1.iter().map(of).sum::<f64>());
    let note = format!(
        "Sum: {printed:.3} and {ours:.3} mm. The largest difference of a length is {off:.3} mm. A segment i–i is the wrap on pulley i."
    );
    drawing.text([16.0, height - 12.0], Anchor::Start, &note, "class=\"small\"");
    drawing.finish()
}

fn words(row: &Row) -> [String; 4] {
    let [from, to] = row.between;
    let expression = row.expression.replace("pi/2", "π/2").replace("pi", "π").replace('-', "−");
    [format!("{from}–{to}"), expression, format!("{:.3}", row.printed_mm), format!("{:.3}", row.ours_mm)]
}

fn line(drawing: &mut Drawing, [left, y]: [f64; 2], words: [String; 4], style: &str) {
    for (text, (x, anchor)) in words.iter().zip(COLUMNS) {
        drawing.text([left + x, y], anchor, text, style);
    }
}
