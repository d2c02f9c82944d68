//! Bed Visualizer, a plugin of OctoPrint, draws the mesh from the printer's answers: the form that it demands.
//!
//! Checked once, on 2026-11-26: the plugin's own expressions (commit 0219e5f) ran over all lines that this test hears,
//! and took each mesh from them. The rules here say the same in our words; the plugin is not part of the project. They
//! hold from the plugin's command to the first line with `ok` in it:
//!
//! - A row is a line of nothing but numbers. A whole number is followed by a space. A decimal number may have a sign,
//!   at most a space before it, and any spaces after it. Points, bars, brackets and `nan` may stand between them.
//! - A line that begins with `Bed`, `Llit` or `G33` counts as a row, too, whatever follows.
//! - The row's heights are its decimal numbers. A whole number is its index, and is not counted.
//! - Two places in brackets, `(x, y)`, in a line give the mesh another box, so no line may have them.
//! - `Subdivided with CATMULL`, `Bed Level Correction Matrix` and the like drop all rows so far. `Home XYZ first` ends
//!   the mesh.
//! - The first row of a mesh is the one nearest to the front, and its first height the leftmost.

use crate::common::life::{Life, live_with};
use corehbot::connectors::ConnectorName;
use corehbot::settings::{ProbeKind, Settings};
use corehbot::units::Mm;
use corehbot_rig::bed::BedPlant;
use corehbot_sim::bed_plant;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::Desk;

/// Takes the front of a text that is a number with decimals: a sign, digits, a point, digits.
fn decimal(text: &str) -> Option<(&str, &str)> {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let sign = text.bytes().take_while(|byte| b"+-".contains(byte)).count();
    let point = sign + digits(sign);
    let end = point + 1 + digits((point + 1).min(text.len()));
    let is_one = sign <= 1 && point > sign && text.as_bytes().get(point) == Some(&b'.') && end > point + 1;
    is_one.then(|| text.split_at(end))
}

/// The heights of a row; `None` if a line is none.
fn row(line: &str) -> Option<Vec<f64>> {
    let (mut rest, mut heights) = (line.trim(), Vec::new());
    assert!(!["Bed", "Llit", "G33"].iter().any(|begin| rest.starts_with(begin)), "it would count as a row: {line}");
    if rest.is_empty() {
        return None;
    }
    while !rest.is_empty() {
        if let Some((number, after)) = decimal(rest.strip_prefix(' ').unwrap_or(rest)) {
            heights.push(number.parse().unwrap());
            rest = after.trim_start();
            continue;
        }
        let index = rest.bytes().take_while(u8::is_ascii_digit).count();
        rest = rest[index..].strip_prefix(' ').filter(|_| index > 0)?;
    }
    Some(heights)
}

/// The mesh that the plugin makes of an answer.
fn drawn(answer: &[String]) -> Vec<Vec<f64>> {
    let before_ok = answer.iter().take_while(|line| !line.contains("ok"));
    let mut rows = Vec::new();
    for line in before_ok {
        assert!(!line.contains("CATMULL") && !line.contains("Correction Matrix") && !line.contains("Home XYZ first"));
        let is_place = |part: &str| part.split_once(')').is_some_and(|(inside, _)| inside.contains(','));
        assert!(!line.split('(').skip(1).any(is_place), "it would be a box: {line}");
        rows.extend(row(line));
    }
    assert!(answer.last().is_some_and(|line| line.starts_with("ok")), "{answer:?}");
    rows
}

fn answer(life: &mut Life<'_>, line: &str) -> Vec<String> {
    let before = life.heard.len();
    life.say(line);
    life.heard[before..].to_vec()
}

#[test]
fn p13_g29_and_m420_v_are_drawn_with_reports_of_temperature_and_busy_lines_between() {
    let mut s = Settings::prototype();
    s.probe_plug.connector = ConnectorName::lit("PROBE");
    (s.probe.kind, s.probe.samples) = (ProbeKind::Switch, 1);
    (s.mesh.columns, s.mesh.rows) = (4, 6);
    // Heights of both signs, none like another, and the left front corner the lowest.
    let bed = bed_plant::read("tilt.x=0.0007,tilt.y=0.0011", &s).unwrap();
    let (plant, mut desk) = (BedPlant::new(&s, &bed), Desk::new(1));
    desk.bed = Some(Box::new(plant.clone()));
    let start = [100, 100, 50].map(Mm::from_num);
    live_with(&s, Some(start), (&mut desk, 1), &mut Eeprom::blank(), |life| {
        // While it prints, the plugin begins at this line.
        assert!(answer(life, "M118 E1 BEDLEVELVISUALIZER").contains(&"echo:BEDLEVELVISUALIZER".to_owned()));
        for line in ["M155 S1", "M154 S1", "M113 S1"] {
            life.say(line);
        }
        let told = answer(life, "G29");
        for begin in ["echo:busy", " T:", "X:"] {
            assert!(told.iter().any(|line| line.starts_with(begin)), "no {begin} between: {told:?}");
        }
        let rows = drawn(&told);
        assert_eq!(rows.iter().map(Vec::len).collect::<Vec<_>>(), [4; 6], "{told:?}");
        // As the bed is, from left to right and from front to back.
        let (wide, deep) = (rows[0][3] - rows[0][0], rows[5][0] - rows[0][0]);
        assert!((wide / 0.0007 - 370.0).abs() < 8.0 && (deep / 0.0011 - 397.6).abs() < 8.0, "{wide} {deep}: {rows:?}");
        for line in ["G29 V1", "G29 V4 T", "M420 V", "M420 V1", "M420 V1 T0", "G29 O", "G80", "BED_MESH_OUTPUT"] {
            let again = drawn(&answer(life, line));
            let is_report = line != "G29 O";
            assert_eq!(again.is_empty(), !is_report, "{line}");
            let near = |(a, b): (&f64, &f64)| (a - b).abs() < 0.003;
            assert!(again.iter().flatten().zip(rows.iter().flatten()).all(near), "{line}: {again:?}");
        }
        // A table, too, as Marlin's, which begins at the back: a switch of the plugin turns it round. Its title counts
        // as a row without heights.
        let table = answer(life, "M420 V1 T1");
        let mut table = drawn(table.strip_prefix(&["Bed Topography Report for CSV:".to_owned()]).unwrap());
        table.reverse();
        assert_eq!(table, drawn(&answer(life, "M420 V")));
    });
}
