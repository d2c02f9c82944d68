//! The moves of a page: each has its line, its type, its times and its way.

use super::{numbers_of, page};
use corehbot::settings::Settings;
use flate2::read::DeflateDecoder;
use serde_json::Value;
use std::io::Read as _;

/// A move as a viewer unpacks it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Move {
    pub line: i64,
    /// In s.
    pub begin: f64,
    pub phases: [f64; 3],
    /// In mm/s.
    pub speeds: [f64; 3],
    pub feed: f64,
    /// In mm.
    pub from: [f64; 3],
    pub way: [f64; 4],
    pub kind: usize,
    pub limit: usize,
    pub layer: usize,
}

/// The blobs of a stream, unpacked.
pub fn blobs(text: &str, class: &str) -> Vec<Vec<u8>> {
    let begin = format!("<script type=\"text/plain\" class=\"{class}\">");
    let packed = text.lines().filter_map(|line| line.strip_prefix(&begin)?.strip_suffix("</script>"));
    let unpacked = packed.map(|blob| {
        let mut bytes = Vec::new();
        DeflateDecoder::new(super::base64(blob).as_slice()).read_to_end(&mut bytes).unwrap();
        bytes
    });
    unpacked.collect()
}

/// All moves.
pub fn moves(data: &Value, text: &str) -> Vec<Move> {
    let (rows, blobs) = (data["move_chunks"].as_array().unwrap(), blobs(text, "moves"));
    assert_eq!(rows.len(), blobs.len());
    let (mut all, mut last) = (Vec::<Move>::new(), 0);
    let signed = |v: u64| if v % 2 == 1 { -(v.div_ceil(2) as i64) } else { (v / 2) as i64 };
    for (row, blob) in rows.iter().zip(blobs) {
        let row: Vec<i64> = row.as_array().unwrap().iter().map(|v| v.as_i64().unwrap()).collect();
        let (mut line, mut end, mut speeds, mut feed) = (0, 0, [0; 3], 0);
        let mut at = [row[4], row[5], row[6]];
        let numbers = numbers_of(blob.into_iter());
        let moves = numbers.chunks_exact(14);
        assert!(moves.remainder().is_empty() && moves.len() as i64 == row[0] && row[0] <= 4096);
        for n in moves {
            line += signed(n[0]);
            let begin = end + n[1] as i64;
            end = begin + (n[2] + n[3] + n[4]) as i64;
            speeds = std::array::from_fn(|i| speeds[i] + signed(n[5 + i]));
            feed += signed(n[8]);
            let way: [i64; 4] = std::array::from_fn(|i| signed(n[9 + i]));
            assert!(begin >= last, "moves overlap: {begin} {last}");
            all.push(Move {
                line,
                begin: begin as f64 / 1e5,
                phases: [2, 3, 4].map(|i| n[i] as f64 / 1e5),
                speeds: speeds.map(|v| v as f64 / 100.0),
                feed: feed as f64 / 100.0,
                from: at.map(|um| um as f64 / 1000.0),
                way: way.map(|um| um as f64 / 1000.0),
                kind: (n[13] >> 4) as usize,
                limit: (n[13] & 15) as usize,
                layer: row[3] as usize,
            });
            at = std::array::from_fn(|i| at[i] + way[i]);
            last = end;
        }
        assert_eq!(end, row[2]);
    }
    all
}

fn names(data: &Value, moves: &[Move]) -> Vec<String> {
    moves.iter().map(|made| data["types"][made.kind]["role"].as_str().unwrap().to_owned()).collect()
}

#[test]
fn a_move_has_its_line_and_the_times_of_its_trapezoid() {
    let page = page("trapezoid", "; a comment\nG91\n\nM220 S50\nG1 X50 F12000\nG90\nG1 X100 F3000 ; back\n", &[]);
    let moves = moves(&page.data, &page.text);
    let a: f64 = Settings::prototype().travel_acceleration.to_num();
    for (made, (line, to, feed)) in moves.iter().zip([(5, 50.0, 100.0), (7, -50.0, 25.0)]) {
        assert_eq!((made.line, made.feed), (line, feed));
        assert_eq!(made.way, [to, 0.0, 0.0, 0.0]);
        // Both stop at their ends: the second turns back.
        let ramp = feed / a;
        let expected = [ramp, (50.0 - feed * ramp) / feed, ramp];
        for (found, expected) in made.phases.into_iter().zip(expected) {
            assert!((found - expected).abs() < 2e-5, "{made:?} {expected}");
        }
        assert_eq!(made.speeds, [0.0, feed, 0.0]);
    }
    assert_eq!(moves.len(), 2);
    assert_eq!(moves[0].from, [100.0, 100.0, 1.0]);
}

#[test]
fn types_are_the_slicer_s_and_sums_are_those_of_the_moves() {
    let gcode = "M83\n;TYPE:Custom\nG1 X5 Y5 F6000\nG1 X60 E2 F1200\n;TYPE:Skirt/Brim\nG1 X60 Y60 E3\n\
                 ;TYPE:External perimeter\nG1 E-1 F2400\nG0 X70\nG1 E1\nG1 X90 E1 F1200\nG1 X95 Y65 E1\n\
                 G1 Z1.2\n;TYPE:Internal infill\nG2 X80 Y60 I-10 E4\nM107\n; filament_density = 1.2\n";
    let page = page("types", gcode, &[]);
    let moves = moves(&page.data, &page.text);
    let roles = names(&page.data, &moves);
    let of_line = |line: i64| {
        let mut found = moves.iter().zip(&roles).filter(|(made, _)| made.line == line).map(|(_, role)| role.as_str());
        let first = found.next();
        assert!(found.all(|role| Some(role) == first), "line {line}");
        first
    };
    for (line, role) in [
        (3, "travel"),
        (4, "purge"),
        (6, "skirt"),
        (8, "travel"),
        (9, "travel"),
        (11, "outer wall"),
        (12, "outer wall"),
        (13, "travel"),
        (15, "infill"),
    ] {
        assert_eq!(of_line(line), Some(role), "line {line}");
    }
    let name_of = |line: i64| {
        let made = moves.iter().find(|made| made.line == line).unwrap();
        page.data["types"][made.kind]["name"].as_str().unwrap().to_owned()
    };
    assert_eq!([8, 9, 10].map(name_of), ["Retract", "Travel", "Prime"]);
    assert!(moves.iter().filter(|made| made.line == 15).count() > 5, "an arc is chords");
    let end = moves.last().unwrap();
    let at = [0, 1, 2].map(|i| end.from[i] + end.way[i]);
    assert!(at.iter().zip([80.0, 60.0, 1.2]).all(|(at, to)| (at - to).abs() < 0.01), "{at:?}");
    let sum = |list: &str, key: &str| -> f64 {
        page.data[list].as_array().unwrap().iter().map(|row| row[key].as_f64().unwrap()).sum()
    };
    let seconds: f64 = moves.iter().map(|made| made.phases.iter().sum::<f64>()).sum();
    // The purge line and the way to it are of no layer, and neither is what follows the last line.
    let of = |key: &str, what: &str| page.data[key][what].as_f64().unwrap();
    let outside = |what: &str| of("before_layers", what) + of("after_layers", what);
    for (list, besides) in [("by_type", 0.0), ("by_layer", 1.0)] {
        assert!((sum(list, "seconds") + besides * outside("seconds") - seconds).abs() < 0.01, "{list}");
        assert!((sum(list, "filament_mm") + besides * outside("filament_mm") - 11.0).abs() < 0.02, "{list}");
    }
    let first = moves.iter().filter(|made| made.line < 6).map(|made| made.phases.iter().sum::<f64>());
    assert!((of("before_layers", "seconds") - first.sum::<f64>()).abs() < 0.01, "{}", page.data["before_layers"]);
    assert!((of("before_layers", "filament_mm") - 2.0).abs() < 0.01, "{}", page.data["before_layers"]);
    let filament = &page.data["filament"];
    // 11 mm of 1.75 mm with 1.2 g/cm3.
    assert!((filament["g"].as_f64().unwrap() - 11.0 * 2.405_28e-3 * 1.2).abs() < 1e-3, "{filament}");
    let time = &page.data["time"];
    let parts: f64 = ["motion", "heat", "waits"].iter().map(|part| time[part].as_f64().unwrap()).sum();
    assert!((time["total"].as_f64().unwrap() - parts).abs() < 2e-3, "{time}");
}

/// Reproducer: the filament that a file pulls back at its end was taken off its length and its mass.
#[test]
fn filament_is_used_once_and_for_good() {
    let gcode = "M83\nG1 X5 E2 F600\nG1 E-1 F2400\nG1 X9 F6000\nG1 E1 F2400\nG1 X12 E2 F600\nG1 E-1.5 F2400\n";
    let page = page("used", gcode, &[]);
    let (used, list) = (&page.data["filament"], page.data["by_type"].as_array().unwrap());
    assert!((used["mm"].as_f64().unwrap() - 4.0).abs() < 0.01, "{used}");
    assert_eq!(page.data["summary"]["filament"]["g"], used["g"]);
    // Rows of types are signed.
    let net: f64 = list.iter().map(|row| row["filament_mm"].as_f64().unwrap()).sum();
    assert!((net - 2.5).abs() < 0.01, "{list:?}");
}

#[test]
fn every_setting_is_in_the_page_by_its_key() {
    let page = page("settings", "G1 X5 F600\n", &[]);
    let settings = &page.data["settings"];
    assert_eq!(*settings, corehbot_machine_file::keyed(&Settings::prototype()));
    assert!(settings["axes"]["x"]["max_acceleration"].is_number() && settings["mechanism"]["m1"].is_array());
}

#[test]
fn the_text_of_the_file_is_in_the_page() {
    let gcode = "; <script>alert(1)</script> \u{e9}\nG1 X110 F6000\n".to_owned() + &"; filler\n".repeat(60_000) + "M84";
    let page = page("text", &gcode, &[]);
    let blobs = blobs(&page.text, "gcode");
    assert_eq!(String::from_utf8(blobs.concat()).unwrap(), gcode);
    let mut next = 1;
    for (row, blob) in page.data["gcode_chunks"].as_array().unwrap().iter().zip(&blobs) {
        assert_eq!(row[0].as_u64().unwrap(), next);
        next += row[1].as_u64().unwrap();
        assert_eq!(String::from_utf8_lossy(blob).lines().count() as u64, row[1].as_u64().unwrap());
    }
    assert!(blobs.len() > 1 && next == 60_004);
}

#[test]
fn homing_ends_where_the_switches_are() {
    let page = page("homed", "G28\nG1 X50 Y50 Z5 F6000\n", &[]);
    let moves = moves(&page.data, &page.text);
    let homed: Vec<_> = moves.iter().filter(|made| made.line == 1).collect();
    assert!(homed.len() >= 6, "{homed:?}");
    // No line commands their speed.
    assert!(homed.iter().all(|made| page.data["limits"][made.limit] != "feed"), "{homed:?}");
    let last = moves.iter().rfind(|made| made.line == 2).unwrap();
    let at = [0, 1, 2].map(|i| last.from[i] + last.way[i]);
    assert!(at.iter().zip([50.0, 50.0, 5.0]).all(|(at, to)| (at - to).abs() < 0.05), "{at:?}");
    // The way to the switches is the one from 100, 100, 1, and not as far as homing may look for them.
    let way = |axis: usize| homed.iter().map(|made| made.way[axis]).sum::<f64>();
    assert!((way(0) + 100.0).abs() < 0.5 && (way(1) + 100.0).abs() < 0.5, "{} {}", way(0), way(1));
}
