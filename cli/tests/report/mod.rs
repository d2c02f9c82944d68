//! The report page: it draws the path where the tool was.

mod belt;
mod heat;
mod mesh;
mod moves;

use corehbot_report::viewer;
use serde_json::Value;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A step of the prototype's x and y, in mm.
const STEP: f64 = 0.0125;

/// Moves end at halves of steps, a quarter away in x and in y. A place that the tool can reach is half a step from its
/// ideal place. A line is a step from its places, and its ends are rounded to um.
const TOLERANCE: f64 = 1.86 * STEP + 0.001;

fn scratch(name: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    std::fs::create_dir_all(&place).unwrap();
    place.join(name)
}

/// A line of the page.
#[derive(Clone, Copy, Debug)]
struct Line {
    from: [f64; 2],
    to: [f64; 2],
    is_printed: bool,
}

/// A page as a browser sees it.
struct Page {
    data: Value,
    /// Lines of each layer.
    layers: Vec<Vec<Line>>,
    text: String,
}

impl Page {
    /// Without the viewer, which is in every page.
    fn bytes(&self) -> usize {
        self.text.len() - viewer::script().len() - viewer::style().len()
    }
}

fn page(name: &str, gcode: &str, args: &[&str]) -> Page {
    let (file, html) = (scratch(&format!("{name}.gcode")), scratch(&format!("{name}.html")));
    std::fs::write(&file, gcode).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    command.arg("run").arg(&file).args(["--assume-homed", "100,100,1"]).arg("--report").arg(&html).args(args);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    let text = std::fs::read_to_string(html).unwrap();
    let json = text.lines().find_map(|line| line.strip_prefix("const D = ")?.strip_suffix(';')).unwrap();
    let data: Value = serde_json::from_str(json).unwrap();
    let chunks = moves::blobs(&text, "path");
    let rows = data["chunks"].as_array().unwrap();
    assert_eq!(chunks.len(), rows.len());
    let mut layers = vec![Vec::new(); data["heights"].as_array().unwrap().len().max(1)];
    let mut end: Option<[i64; 4]> = None;
    for (chunk, row) in chunks.into_iter().zip(rows) {
        let number = |i: usize| row[i].as_u64().unwrap();
        let vertices = unpack(chunk);
        assert_eq!(vertices.len() as u64, number(1));
        let (first, last) = (vertices[0].0, vertices[vertices.len() - 1].0);
        assert!(end.is_none_or(|end| end == first), "a chunk begins where the one before ended");
        assert_eq!([first[3] as u64, last[3] as u64], [number(2), number(3)]);
        end = Some(last);
        let mm = |v: [i64; 4]| [v[0] as f64 / 1000.0, v[1] as f64 / 1000.0];
        let lines = vertices.windows(2).map(|w| Line { from: mm(w[0].0), to: mm(w[1].0), is_printed: w[1].1 });
        layers[number(0) as usize].extend(lines);
    }
    Page { data, layers, text }
}

/// RFC 4648, section 4.
fn base64(text: &str) -> Vec<u8> {
    let digit = |b: u8| match b {
        b'A'..=b'Z' => b - b'A',
        b'a'..=b'z' => b - b'a' + 26,
        b'0'..=b'9' => b - b'0' + 52,
        b'+' => 62,
        _ => 63,
    };
    let mut bits = text.bytes().filter(|b| *b != b'=').flat_map(|b| (0..6).rev().map(move |i| digit(b) >> i & 1));
    std::iter::from_fn(|| (0..8).try_fold(0u8, |byte, _| Some(byte << 1 | bits.next()?))).collect()
}

/// Numbers of seven bits a byte.
fn numbers_of(bytes: impl Iterator<Item = u8>) -> Vec<u64> {
    let mut numbers = Vec::new();
    let (mut value, mut shift) = (0u64, 0);
    for byte in bytes {
        value |= u64::from(byte & 0x7F) << shift;
        shift += 7;
        if byte < 0x80 {
            numbers.push(value);
            (value, shift) = (0, 0);
        }
    }
    numbers
}

/// x, y, z in um and the time in 10 us of each vertex, and whether the line to it is printed.
fn unpack(bytes: Vec<u8>) -> Vec<([i64; 4], bool)> {
    let numbers = numbers_of(bytes.into_iter());
    let signed = |v: u64| if v % 2 == 1 { -(v.div_ceil(2) as i64) } else { (v / 2) as i64 };
    let mut at = [0; 4];
    let vertex = |n: &[u64]| {
        for i in 0..3 {
            at[i] += signed(n[i]);
        }
        at[3] += (n[3] / 2) as i64;
        (at, n[3] % 2 == 1)
    };
    numbers.chunks(4).map(vertex).collect()
}

fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = u[0] * u[0] + u[1] * u[1];
    let share = if square > 0.0 { ((u[0] * v[0] + u[1] * v[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (v[0] - share * u[0]).hypot(v[1] - share * u[1])
}

/// A repeatable die.
struct Die(u64);

impl Die {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 31)
    }
}

/// Corners of a layer: turns of 45 to 135 degrees to either side, moves of 0.4 to 3 mm.
fn corners(die: &mut Die, moves: usize) -> Vec<[f64; 2]> {
    let rounded = |v: f64| (v * 1000.0).round() / 1000.0;
    let mut at = [60.0 + 80.0 * die.next(), 60.0 + 80.0 * die.next()].map(rounded);
    let mut angle = std::f64::consts::TAU * die.next();
    let mut corners = vec![at];
    for _ in 0..moves {
        let to_centre = (100.0 - at[1]).atan2(100.0 - at[0]);
        let side = if (to_centre - angle).sin() > 0.0 { 1.0 } else { -1.0 };
        angle += side * (45.0 + 90.0 * die.next()).to_radians();
        let length = 0.4 + 2.6 * die.next();
        at = [at[0] + length * angle.cos(), at[1] + length * angle.sin()].map(rounded);
        corners.push(at);
    }
    corners
}

#[test]
fn every_move_of_every_layer_is_drawn_where_it_was_made() {
    const LAYERS: usize = 130;
    const MOVES: usize = 160;
    let mut die = Die(7);
    let (mut gcode, mut all) = ("M83\n".to_owned(), Vec::new());
    for layer in 0..LAYERS {
        let corners = corners(&mut die, MOVES);
        let [x, y] = corners[0];
        writeln!(gcode, "G1 E-1 F2400\nG0 X{x} Y{y} F12000\nG0 Z{:.2}\nG1 E1 F2400", 1.2 + 0.2 * layer as f64).unwrap();
        for pair in corners.windows(2) {
            let length = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            writeln!(gcode, "G1 X{} Y{} E{:.5} F4800", pair[1][0], pair[1][1], 0.04 * length).unwrap();
        }
        all.push(corners);
    }
    let page = page("exact", &gcode, &[]);
    assert_eq!(page.layers.len(), LAYERS);
    let top = page.data["printed"]["speed"].as_f64().unwrap();
    assert!((50.0..90.0).contains(&top), "{top}");
    for (layer, (corners, lines)) in all.iter().zip(&page.layers).enumerate() {
        let printed: Vec<_> = lines.iter().filter(|line| line.is_printed && line.from != line.to).collect();
        // Where one commanded move ends, a line of the page ends, and between two such places only the move is drawn.
        let mut next = 0;
        for (index, pair) in corners.windows(2).enumerate() {
            let begin = next;
            let to = |line: &Line| (line.to[0] - pair[1][0]).hypot(line.to[1] - pair[1][1]);
            while next < printed.len() && to(printed[next]) > 6.0 * STEP {
                next += 1;
            }
            while next + 1 < printed.len() && to(printed[next + 1]) <= to(printed[next]) {
                next += 1;
            }
            assert!(next < printed.len(), "layer {layer}: move {index} to {:?} is not drawn", pair[1]);
            next += 1;
            for line in &printed[begin..next] {
                let off = distance(line.to, pair[0], pair[1]).max(distance(line.from, pair[0], pair[1]));
                assert!(off <= 2.0 * TOLERANCE, "layer {layer}: {line:?} is not a part of move {index}: {off} mm off");
                let middle = [0, 1].map(|i| (line.from[i] + line.to[i]) / 2.0);
                let off = distance(middle, pair[0], pair[1]);
                assert!(off <= TOLERANCE, "layer {layer}: {line:?} is {off} mm off move {index}");
            }
            let drawn = printed[begin..(next + 1).min(printed.len())].iter();
            let off = drawn.map(|line| distance(pair[1], line.from, line.to)).fold(f64::INFINITY, f64::min);
            assert!(off <= TOLERANCE, "layer {layer}: move {index} ends {off} mm beside what is drawn");
        }
        assert!(next == printed.len(), "layer {layer}: {:?} is drawn, but was not printed", &printed[next..]);
    }
    // Of some 20 bytes of G-code a move.
    assert!(page.bytes() < 40_000 + 60 * LAYERS * MOVES, "{}", page.bytes());
}

#[test]
fn a_circle_is_drawn_to_a_step() {
    let page = page("circle", "M83\nG0 X120 Y100 F6000\nG2 I-20 E5 F6000\n", &[]);
    let printed: Vec<_> = page.layers.iter().flatten().filter(|line| line.is_printed).collect();
    assert!(printed.len() > 60, "{}", printed.len());
    for line in printed {
        for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
            let at = [0, 1].map(|i| line.from[i] + share * (line.to[i] - line.from[i]));
            let off = (at[0] - 100.0).hypot(at[1] - 100.0) - 20.0;
            assert!(off.abs() <= TOLERANCE + 0.003, "{off} mm at {at:?}: arcs are within 2 um, and then a step");
        }
    }
}

#[test]
fn travels_alone_have_speeds_and_an_area() {
    let page = page("travels", "G0 X150 Y120 F6000\nG0 X150 Y160\n", &[]);
    assert!(page.data["printed"].is_null());
    let travelled = &page.data["travelled"];
    assert!((travelled["speed"].as_f64().unwrap() - 100.0).abs() < 3.0, "{travelled}");
    let area: Vec<_> = travelled["area"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap().round()).collect();
    assert_eq!(area, [100.0, 100.0, 150.0, 160.0]);
    assert!(page.layers.len() == 1 && page.layers[0].iter().all(|line| !line.is_printed));
}

#[test]
fn a_rising_line_is_cut_in_layers() {
    let mut gcode = "M83\n".to_owned();
    for i in 0..400 {
        let angle = f64::from(i) * 0.3;
        let (x, y, z) = (100.0 + 20.0 * angle.cos(), 100.0 + 20.0 * angle.sin(), 1.0 + 0.01 * f64::from(i));
        writeln!(gcode, "G1 X{x:.3} Y{y:.3} Z{z:.3} E0.3 F3000").unwrap();
    }
    let heights = page("rising", &gcode, &[]).data["heights"].as_array().unwrap().len();
    assert!((20..=22).contains(&heights), "{heights} layers of 0.2 mm in 4 mm");
}

#[test]
fn the_motors_are_those_of_the_machine() {
    let machine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/machines/corexy.toml");
    let page = page("motors", "G1 X110 F6000\n", &["--machine", machine.to_str().unwrap()]);
    let motors = page.data["motors"].as_array().unwrap();
    let drives: Vec<_> = motors.iter().map(|motor| motor["drives"].as_str().unwrap()).collect();
    let machine = corehbot_machine_file::read(&machine).unwrap().settings.mechanism;
    let fitted = machine.motors().filter(|(motor, _)| machine.fitted().has(*motor)).count();
    assert_eq!(motors.len(), fitted);
    assert!(drives.contains(&"x + y") && drives.contains(&"z") && drives.contains(&"e"), "{drives:?}");
}
