//! Files that the twin plays: the same errors from G-code and trace, corners, a page.

use super::{complaint, file, json, near, twin};
use serde_json::Value;
use std::path::Path;
use std::process::Command;

#[test]
fn a_file_is_played_as_g_code_and_as_the_trace_of_it_alike() {
    let gcode = file("corner.gcode", "G1 X100 Y100 F6000\nG1 X130 F12000\nG1 Y130\nM400\n");
    let trace = gcode.with_file_name("corner.csv");
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    run.arg("run").arg(&gcode).arg("--trace").arg(&trace).args(["--assume-homed", "100,100,0"]);
    assert!(run.output().unwrap().status.success());
    let played = |path: &Path| json(&format!("run {} --model rotors --assume-homed 100,100,0", path.display()));
    let [a, b] = [gcode.as_path(), trace.as_path()].map(played);
    // Both lines have whole steps. A plan is exact, and a line through the steps may be a step off.
    assert_eq!((&a["contour"]["line_share_mm"], &b["contour"]["line_share_mm"]), (&0.0.into(), &0.0125.into()));
    for key in ["max_mm", "rms_mm", "rounding_max_mm", "overshoot_max_mm", "bisector_max_mm", "commanded_max_mm"] {
        assert_eq!(a["contour"][key], b["contour"][key], "{key}: {a} {b}");
    }
    assert_eq!(a["motors"], b["motors"]);
    assert!(a["contour"]["max_mm"].as_f64().unwrap() > 0.005 && a["contour"]["max_mm"].as_f64().unwrap() < 0.2, "{a}");
    // The corner is where G-code's (130, 100) is.
    assert!(near(&a["corners"][0]["x_mm"], 170.0, 1e-3) && near(&a["corners"][0]["y_mm"], 126.2, 1e-3), "{a}");
    assert_eq!(a["corners_total"], 1);
    // Where the tool crosses the bisector it is off by no more than at its worst.
    let [worst, bisector] = ["max_mm", "bisector_max_mm"].map(|key| a["contour"][key].as_f64().unwrap());
    assert!(a["corners"][0]["bisector_mm"].as_f64() == Some(bisector) && bisector.abs() <= worst + 0.001, "{a}");
    assert_eq!(a["motors"].as_array().unwrap().len(), 4);
    assert!(a["motors"].as_array().unwrap().iter().all(|motor| motor["slips"] == 0));
    assert!(a["tension_N"]["lo"][0].as_f64().unwrap() > 30.0, "{a}");
    assert!(a["times_real_time"].as_f64().unwrap() > 0.0);
    let hbot = json(&format!("run {} --routing hbot --assume-homed 100,100,0", trace.display()));
    assert_eq!(hbot["motors"].as_array().unwrap().len(), 2);
}

/// Walls are slow and travel is fast, so travel rings more. Both together make the whole, by time.
#[test]
fn each_type_of_line_has_its_error_and_travel_has_its_own() {
    let wall = "G1 X120 E1 F1200\nG1 Y120 E2\nG1 X100 E3\nG1 Y100 E4\n";
    let gcode = format!(
        "M302 P1\nM83\n;TYPE:External perimeter\n{wall};TYPE:Internal infill\nG1 X118 Y118 F4800 E1\n\
         G0 X100 Y100 F18000\nM400\n"
    );
    let file = file("types.gcode", &gcode);
    let a = json(&format!("run {} --assume-homed 100,100,0", file.display()));
    let rows = a["by_type"].as_array().unwrap();
    let names: Vec<_> = rows.iter().map(|row| row["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["External perimeter", "Internal infill", "all printed lines", "Travel"], "{a}");
    let of = |row: usize, key: &str| rows[row][key].as_f64().unwrap();
    assert!(of(0, "rms_um") < of(1, "rms_um") && of(1, "rms_um") < of(3, "rms_um"), "{a}");
    assert!((0..4).all(|row| of(row, "rms_um") < of(row, "mostly_um") && of(row, "mostly_um") <= of(row, "max_um")));
    // 80 mm at 20 mm/s, 25.5 mm at 80 mm/s.
    assert!((of(0, "seconds") - 4.0).abs() < 0.1 && (of(1, "seconds") - 0.35).abs() < 0.1, "{a}");
    let square = |row: usize| of(row, "seconds") * of(row, "rms_um").powi(2);
    let [whole, printed] = [square(2) + square(3), square(0) + square(1)];
    let seconds = of(2, "seconds") + of(3, "seconds");
    let rms_um = 1000.0 * a["contour"]["rms_mm"].as_f64().unwrap();
    assert!(((whole / seconds).sqrt() / rms_um - 1.0).abs() < 1e-6, "{a}");
    assert!((printed / square(2) - 1.0).abs() < 1e-6, "{a}");
    // A trace has no types.
    let trace = file.with_extension("csv");
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    run.arg("run").arg(&file).arg("--trace").arg(&trace).args(["--assume-homed", "100,100,0"]);
    assert!(run.output().unwrap().status.success());
    assert!(json(&format!("run {} --assume-homed 100,100,0", trace.display()))["by_type"].is_null());
}

/// Sides of 2048 steps, on which all four corners were lost. And a zigzag with lines 0.1 mm apart, which was measured
/// against neighbouring lines when it was compared with another file.
#[test]
fn corners_are_found_and_a_line_is_held_against_that_of_its_own_time() {
    let square = "G1 X125.6 Y100 F6000\nG1 Y125.6\nG1 X100\nG1 Y100\nG1 X125.6\nM400\n";
    let square = file("square.gcode", square);
    let a = json(&format!("run {} --assume-homed 100,100,0 --model rotors", square.display()));
    assert_eq!((&a["corners_total"], &a["corners_unmatched"]), (&Value::from(4), &Value::from(0)), "{a}");
    let zigzag = |a: u32| {
        let line = |i: u32| format!("G1 X{} F9000\nG1 Y{:.1}\n", 100 + 2 * (1 - i % 2), 100.0 + 0.1 * f64::from(i + 1));
        let lines: String = (0..20).map(line).collect();
        file(&format!("zigzag-{a}.gcode"), &format!("M201 X9000 Y9000\nM204 P{a} T{a}\n{lines}M400\n"))
    };
    let [slow, fast] = [700, 7000].map(zigzag);
    let rms = |against: &str| {
        let words = format!("run {} {against} --assume-homed 100,100,0 --model rotors", fast.display());
        json(&words)["contour"]["rms_mm"].as_f64().unwrap()
    };
    let own = rms("");
    for against in [&fast, &slow] {
        let found = rms(&format!("--against {}", against.display()));
        assert!((found / own - 1.0).abs() < 0.05, "{own} {found} {}", against.display());
    }
}

#[test]
fn a_page_shows_the_path_with_its_errors_and_needs_no_network() {
    let gcode = file("page.gcode", "G1 X120 F9000\nG1 Y120\nM400\n");
    let page = gcode.with_file_name("page.html");
    let words = format!("run {} --assume-homed 100,100,0 --report {}", gcode.display(), page.display());
    assert!(twin(&words).status.success());
    let text = std::fs::read_to_string(page).unwrap();
    // One comment, of uPlot, names its project; the name of SVG's elements is no address.
    assert_eq!(text.replace("\"http://www.w3.org/2000/svg\"", "").matches("://").count(), 1);
    assert!(!["/*STYLE*/", "/*SHARED*/", "/*DATA*/", "/*PAGE*/"].iter().any(|mark| text.contains(mark)));
    let data = text.split_once("const D = ").unwrap().1.split_once(";\n").unwrap().0;
    let data: Value = serde_json::from_str(data).unwrap();
    let [lines, errors] = ["x", "error_um"].map(|key| data["path"][key].as_array().unwrap().len());
    assert!(lines == errors && (3..10).contains(&lines), "{data}");
    let [places, aside] = ["x", "off_x_um"].map(|key| data["trail"][key].as_array().unwrap().len());
    assert!(places == aside && places > 1000, "{places} {aside}");
    assert!(text.contains("<main class=\"viewer\">") && text.contains("showCorner"));
    assert_eq!(data["spans"].as_array().unwrap().len(), 4);
    assert!(data["error"].as_array().unwrap().iter().any(|mm| mm.as_f64().unwrap() > 0.001));
}

#[test]
fn what_cannot_be_played_is_told_in_one_line() {
    let path = file("far.gcode", "G1 X380 F12000\nM400\n");
    let far = complaint(&format!("run {} --routing hbot --assume-homed 100,100,0", path.display()));
    assert!(far.contains("far.gcode") && far.contains("reaches x 52.7"), "{far}");
    let cut = file(
        "cut.csv",
        "# corehbot-trace v1 tick_hz=10000000 kinematics=corehbot steps_per_mm=80/800/400\n\
        tick,m1,m4,m8,m11,z1,z2,e0\n5,1,0\n",
    );
    assert!(complaint(&format!("run {}", cut.display())).contains("cut.csv: line 3"));
    assert!(complaint("run nothing.gcode").contains("cannot open"));
    let still = file("still.gcode", "; nothing moves\nM115\n");
    let told = complaint(&format!("run {}", still.display()));
    assert!(told.contains("still.gcode: no motor steps in it"), "{told}");
}

/// On slanted lines motors cannot be where the plan is: each is within half a step of it, and so is the tool. The line
/// itself has no share; one through the steps was told 13.5 um off where the steps were within 6.
#[test]
fn the_tool_is_held_against_the_planned_line() {
    let lines = "G1 X100 Y100 F6000\nG1 X131.37 Y111.11 F3000\nG1 X103.21 Y128.73\nG1 X100 Y100\nM400\n";
    let slanted = file("slanted.gcode", lines);
    let run = json(&format!("run {} --assume-homed 100,100,0", slanted.display()));
    let [share, most, rms] =
        ["line_share_mm", "commanded_max_mm", "commanded_rms_mm"].map(|key| run["contour"][key].as_f64().unwrap());
    assert!(share == 0.0 && (0.002..0.0064).contains(&most) && rms < 0.0036, "{run}");
    let corner = &run["corners"].as_array().unwrap().iter().find(|c| near(&c["x_mm"], 171.37, 1e-3)).unwrap();
    assert!(near(&corner["y_mm"], 137.31, 1e-3), "{corner}");
    // Shapers round the corners of the command, and the tool is held against the plan all the same.
    let shaped = file("slanted-shaped.gcode", &format!("M593 X F50 D0.1 T2\nM593 Y F50 D0.1 T2\n{lines}"));
    let shaped = json(&format!("run {} --assume-homed 100,100,0", shaped.display()));
    assert!(shaped["contour"]["commanded_max_mm"].as_f64().unwrap() > 2.0 * most, "{shaped}");
    assert!(shaped["contour"]["commanded_rms_mm"].as_f64().unwrap() < 0.05, "{shaped}");
}

/// The stop at a switch rings by more than a slow square does.
#[test]
fn the_touches_of_homing_are_told_apart_from_the_print() {
    let square = "G1 X40 Y40 F1200\nG1 X50\nG1 Y50\nG1 X40\nG1 Y40\nM400\n";
    let homed = file("homed.gcode", &format!("M204 P500 T500\nG28 X Y\n{square}"));
    let bare = file("bare.gcode", &format!("M204 P500 T500\n{square}"));
    let figure = |run: &Value, key: &str| run["contour"][key].as_f64().unwrap();
    let with = json(&format!("run {} --model rotors", homed.display()));
    let without = json(&format!("run {} --model rotors --assume-homed 0,0,0", bare.display()));
    assert_eq!((figure(&without, "touch_max_mm"), &with["corners_total"]), (0.0, &without["corners_total"]));
    assert!(figure(&with, "touch_max_mm") > 2.0 * figure(&with, "max_mm"), "{with}");
    let (with, without) = (figure(&with, "max_mm"), figure(&without, "max_mm"));
    assert!((with / without - 1.0).abs() < 0.2, "{with} {without}");
    let text = String::from_utf8(twin(&format!("run {} --model rotors", homed.display())).stdout).unwrap();
    assert!(text.contains("in touches      max 0.0"), "{text}");
}

/// The slicer's own names are the second source: without them the same lines are outside or inside.
#[test]
fn a_file_without_names_has_lines_outside_and_inside() {
    let around = |half: f64| {
        let corners = [[-half, half], [-half, -half], [half, -half], [half, half - 0.2]];
        let lines = corners.map(|[x, y]| format!("G1 X{} Y{} E1 F3000\n", 110.0 + x, 110.0 + y));
        format!("G0 X{0} Y{0} F9000\n{1}", 110.0 + half, lines.concat())
    };
    let named = format!(
        "M302 P1\nM83\nG0 Z0.2\n;TYPE:External perimeter\n{};TYPE:Perimeter\n{}M400\n",
        around(4.95),
        around(4.5)
    );
    let plain: String = named.lines().filter(|line| !line.starts_with(';')).map(|line| format!("{line}\n")).collect();
    let of = |name: &str, gcode: &str| {
        let file = file(name, gcode);
        json(&format!("run {} --assume-homed 100,100,0", file.display()))["by_type"].as_array().unwrap().clone()
    };
    let (named, plain) = (of("named.gcode", &named), of("plain.gcode", &plain));
    for (row, [by_slicer, by_place]) in [["External perimeter", "Outside"], ["Perimeter", "Inside"]].iter().enumerate()
    {
        assert_eq!([&named[row]["name"], &plain[row]["name"]], [by_slicer, by_place]);
        for key in ["seconds", "rms_um", "mostly_um", "max_um"] {
            assert_eq!(named[row][key], plain[row][key], "{key}");
        }
    }
}
