//! `corehbot twin` as a user sees it: questions in, tables and JSON out, and the exit status.
// Clippy sees no test in the helpers here.
#![allow(clippy::unwrap_used)]

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn twin(words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("twin").args(words.split_whitespace()).output().unwrap()
}

/// The JSON that a question is answered with on standard output.
fn json(words: &str) -> Value {
    let output = twin(&format!("{words} --json -"));
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The one line that a question fails with.
fn complaint(words: &str) -> String {
    let output = twin(words);
    assert_eq!(output.status.code(), Some(1), "{words}");
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(text.lines().count(), 1, "{text}");
    text
}

fn file(test: &str, text: &str) -> PathBuf {
    let place = Path::new(env!("CARGO_TARGET_TMPDIR")).join("twin");
    std::fs::create_dir_all(&place).unwrap();
    let path = place.join(test);
    std::fs::write(&path, text).unwrap();
    path
}

fn near(value: &Value, expected: f64, part: f64) -> bool {
    (value.as_f64().unwrap() - expected).abs() <= part * expected.abs().max(1e-3)
}

/// The twin suggests the firmware's shapers and no others.
#[test]
fn the_twin_knows_every_shaper() {
    let kinds = corehbot::settings::ShaperKind::all().filter(|kind| *kind != corehbot::settings::ShaperKind::None);
    assert_eq!(corehbot_twin::shaping::shaper::Kind::ALL.len(), kinds.count(), "twin/src/shaping/shaper.rs");
}

#[test]
fn points_are_answered_with_units_in_the_keys() {
    let k = json("stiffness --at 150,180");
    assert!(near(&k["Kxx_N_per_mm"], 300.010, 1e-3) && near(&k["Kyy_N_per_mm"], 282.963, 1e-3), "{k}");
    assert!(k["Kxy_N_per_mm"].as_f64().unwrap().abs() < 1e-6, "{k}");
    let modes = json("modes --model rotors");
    let frequencies = &modes["frequencies_Hz"];
    assert!(near(&frequencies[0], 57.64, 5e-3) && near(&frequencies[1], 101.38, 5e-3), "{modes}");
    let slip = json("slip --motor 1 --at 235,235");
    assert!(near(&slip["dx_mm"], -0.19949, 5e-3) && near(&slip["residual_mm"], 0.79797, 5e-3), "{slip}");
    assert!(near(&slip["tension_change_N"]["up"], -13.88, 5e-3), "{slip}");
    assert!(near(&slip["motor_torque_mNm"][3], -179.2, 5e-3), "{slip}");
    let half = json("slip --motor 1 --at 235,235 --full-steps 2");
    assert!(near(&half["dx_mm"], -0.09975, 5e-3), "{half}");
    let yin = json("yin --speed 0.079 --model 4dof");
    assert!(near(&yin["x_to_y_mm"], 0.7690, 5e-3) && near(&yin["y_to_x_mm"], 0.1962, 5e-3), "{yin}");
    assert!(complaint("yin --speed 7").contains("speed"));
    assert!(complaint("yin --speed 0.02 --friction -1").contains("the factor of friction, -1, is outside"));
    let push = json("push --force 5,-5 --machine corexy --at 147.5,339.4");
    assert!(push["dx_mm"].as_f64().unwrap() > 0.0 && push["residual_mm"].is_null(), "{push}");
    let geometry = json("geometry");
    assert!(near(&geometry["belt_lengths_mm"][0], 3593.091, 1e-6), "{geometry}");
    assert_eq!(geometry["segments"].as_array().unwrap().len(), 14);
    assert!(near(&geometry["transmission_error_mm"], 0.099_75, 1e-4), "{geometry}");
    assert_eq!(geometry["toothed_pulleys"], serde_json::json!([1, 4, 5, 7, 8, 11, 12, 14]));
    let short = geometry["machines"].as_array().unwrap();
    assert!(short.len() == 4 && near(&short[1]["belt_mm"], 2704.095, 1e-6), "{geometry}");
}

#[test]
fn a_free_motor_and_other_numbers_are_taken() {
    let free = json("stiffness --free-motor 4");
    assert!(near(&free["Kxy_N_per_mm"], -70.721, 1e-4), "{free}");
    let stiff = file("stiff.toml", "belt_EA_N = 60000\n");
    let k = json(&format!("stiffness --at 235,235 --params {}", stiff.display()));
    assert!(near(&k["Kxx_N_per_mm"], 2.0 * 287.563, 1e-3), "{k}");
}

#[test]
fn a_place_of_g_code_is_counted_from_the_corner_of_the_reach() {
    let [paper, gcode] = ["stiffness --at 60,31.2", "stiffness --gcode-frame --at 20,5"].map(json);
    assert!(near(&gcode["x_mm"], 60.0, 1e-9) && near(&gcode["Kxx_N_per_mm"], 348.927, 1e-3), "{gcode}");
    assert!(near(&gcode["Kyy_N_per_mm"], paper["Kyy_N_per_mm"].as_f64().unwrap(), 1e-9), "{gcode}");
}

#[test]
fn a_file_is_played_as_g_code_and_as_the_trace_of_it_alike() {
    let gcode = file("corner.gcode", "G1 X100 Y100 F6000\nG1 X130 F12000\nG1 Y130\nM400\n");
    let trace = gcode.with_file_name("corner.csv");
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    run.arg("run").arg(&gcode).arg("--trace").arg(&trace).args(["--assume-homed", "100,100,0"]);
    assert!(run.output().unwrap().status.success());
    let played = |path: &Path| json(&format!("run {} --model rotors --assume-homed 100,100,0", path.display()));
    let [a, b] = [gcode.as_path(), trace.as_path()].map(played);
    assert_eq!(a["contour"], b["contour"], "{a} {b}");
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
    let hbot = json(&format!("run {} --machine hbot --assume-homed 100,100,0", trace.display()));
    assert_eq!(hbot["motors"].as_array().unwrap().len(), 2);
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
    assert!(!text.contains("http://") && !text.contains("https://") && !text.contains("/*STYLE*/"));
    let data = text.split_once("const D = ").unwrap().1.split_once(";\n").unwrap().0;
    let data: Value = serde_json::from_str(data).unwrap();
    let [lines, errors] = ["x", "error_um"].map(|key| data["path"][key].as_array().unwrap().len());
    assert!(lines == errors && (3..10).contains(&lines), "{data}");
    let [places, aside] = ["x", "off_x_um"].map(|key| data["trail"][key].as_array().unwrap().len());
    assert!(places == aside && places > 1000, "{places} {aside}");
    assert!(text.contains("id=\"times\"") && text.contains("showCorner"));
    assert_eq!(data["spans"].as_array().unwrap().len(), 4);
    assert!(data["error"].as_array().unwrap().iter().any(|mm| mm.as_f64().unwrap() > 0.001));
}

#[test]
fn what_cannot_be_played_is_told_in_one_line() {
    let path = file("far.gcode", "G1 X380 F12000\nM400\n");
    let far = complaint(&format!("run {} --machine hbot --assume-homed 100,100,0", path.display()));
    assert!(far.contains("far.gcode") && far.contains("reaches x 52.7"), "{far}");
    let cut = file(
        "cut.csv",
        "# corehbot-trace v1 tick_hz=10000000 kinematics=corehbot steps_per_mm=80/800/400\n\
        tick,m1,m4,m8,m11,z1,z2,e0\n5,1,0\n",
    );
    assert!(complaint(&format!("run {}", cut.display())).contains("cut.csv: line 3"));
    assert!(complaint("run nothing.gcode").contains("cannot open"));
}

#[test]
fn resonance_is_told_over_the_reach_with_lines_that_set_shapers() {
    let told = json("resonance --grid 3x4");
    assert_eq!(told["x"]["frequencies_Hz"].as_array().unwrap().len(), 4);
    assert_eq!(told["x"]["frequencies_Hz"][0].as_array().unwrap().len(), 3);
    assert!(told["y"]["line"].as_str().unwrap().starts_with("M593 Y F6"), "{told}");
    assert!(told["y"]["suggestion"]["worst_residual"].as_f64().unwrap() < 0.05, "{told}");
    assert_eq!(told["x"]["suggestion"]["type"], "MZV");
    let slowest = told["yaw"]["band_Hz"][1].as_f64().unwrap();
    assert!(slowest < told["y"]["band_Hz"][0].as_f64().unwrap(), "{told}");
    // The firmware takes the lines.
    let lines = ["x", "y"].map(|axis| told[axis]["line"].as_str().unwrap().to_owned()).join("\n");
    let gcode = file("shapers.gcode", &format!("{lines}\nG1 X110 F6000\nM400\n"));
    let run = Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("run").arg(&gcode).output().unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(run.status.success() && !text.contains("ignored"), "{text}");
    assert_eq!(twin("resonance --grid 1x4").status.code(), Some(2));
    let page = gcode.with_file_name("resonance.html");
    assert!(twin(&format!("resonance --grid 3x4 --report {}", page.display())).status.success());
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(told["y"]["line"].as_str().unwrap()) && !page.contains("/*"), "{page}");
}

#[test]
fn mechanisms_are_compared_on_an_area_and_on_a_file() {
    let plain = json("compare --grid 5x5");
    let machines = plain["machines"].as_array().unwrap();
    let deflections: Vec<f64> = machines.iter().map(|m| m["deflection_um"].as_f64().unwrap()).collect();
    assert!(deflections[0] < deflections[1] && deflections[0] < deflections[2], "{plain}");
    assert!(plain.get("runs").is_none());
    let gcode = file("side.gcode", "G1 X130 F12000\nG1 Y130\nM400\n");
    let page = gcode.with_file_name("compare.html");
    let words = format!("compare {} --grid 3x3 --assume-homed 100,100,0 --report {}", gcode.display(), page.display());
    let played = json(&words);
    let page = std::fs::read_to_string(page).unwrap();
    assert!(
        page.contains("side.gcode") && page.contains("\"racking_y_um_per_m_s2\"") && !page.contains("/*"),
        "{page}"
    );
    let errors: Vec<f64> =
        played["runs"].as_array().unwrap().iter().map(|r| r["contour"]["max_mm"].as_f64().unwrap()).collect();
    assert!(errors.len() == 3 && errors.iter().all(|e| *e > 0.001 && *e < 0.2), "{errors:?}");
    let wide = file("wide.gcode", "G1 X385 F12000\nM400\n");
    assert!(complaint(&format!("compare {}", wide.display())).contains("H-bot: the path takes"));
}

#[test]
fn limits_are_told_for_an_error_and_a_part_of_the_torque() {
    let told = json("limits --model reduced --error 0.05");
    assert!(near(&told["x"]["speed_jump_mm_s"], 2.0 * 17.307, 1e-3), "{told}");
    let half = json("limits --torque 0.25");
    let whole = json("limits --torque 0.5");
    let accelerations = [half, whole].map(|told| told["y"]["torque_acceleration_mm_s2"].as_f64().unwrap());
    assert!((accelerations[1] / accelerations[0] - 2.0).abs() < 1e-9);
    assert_eq!(twin("limits --torque 2").status.code(), Some(2));
}

#[test]
fn limits_of_torque_fall_with_speed_and_are_told_as_settings() {
    let told = json("limits --margin 0.75 --speed 300");
    let told = &told["torque_at_speed"];
    let [x, y, diagonal] = [0, 1, 2].map(|i| told["directions"][i]["acceleration_mm_s2"][3].as_f64().unwrap());
    // At 300 mm/s the head alone is lightest, and a diagonal has two motors at 424 mm/s of belt.
    assert!(x > y && y > diagonal && diagonal > 5000.0, "{told}");
    assert_eq!(told["pull_out_torque_mNm"][0], 400.0);
    let a = told["settings"]["acceleration_mm_s2"].as_f64().unwrap();
    // The firmware takes the settings, and the motors of a move along y at them keep their part of the torque.
    let printed = String::from_utf8(twin("limits --margin 0.75 --speed 300").stdout).unwrap();
    let lines: Vec<&str> = printed.lines().map(str::trim).filter(|l| l.starts_with("M20")).collect();
    assert!(lines.len() == 3 && lines[1] == format!("M201 X{a} Y{a}"), "{printed}");
    let keys: Vec<&str> = printed.lines().map(str::trim).filter(|l| l.starts_with("motor_max")).collect();
    let machine = file("torque.toml", &keys.join("\n"));
    let gcode = file("torque.gcode", &format!("{}\nG1 Y150 F60000\nM400\n", lines.join("\n")));
    let words = format!("run {} --assume-homed 100,100,0 --settings {}", gcode.display(), machine.display());
    let played = json(&format!("{words} --model rotors"));
    let margin = |i: usize| played["motors"][i]["margin_at_speed"].as_f64().unwrap();
    assert!((0..4).all(|i| (0.3..0.8).contains(&margin(i))), "{played}");
    assert!(json(&words)["motors"][0]["margin_at_speed"].is_null());
    let fast = String::from_utf8(twin("limits --speed 2000").stdout).unwrap();
    assert!(fast.contains("no acceleration leaves 50 % in every direction") && !fast.contains("M201"), "{fast}");
    assert!(json("limits --speed 2000")["torque_at_speed"]["settings"].is_null());
    assert_eq!(twin("limits --margin 1").status.code(), Some(2));
    assert_eq!(twin("limits --margin 0.5 --torque 0.5").status.code(), Some(2));
}

#[test]
fn a_number_is_varied_and_belts_and_motors_are_found_from_frequencies() {
    let swept = json("sweep --vary belt_EA_N=20000:60000:3");
    let rows = swept["rows"].as_array().unwrap();
    assert!(rows.len() == 3 && near(&rows[2]["Kxx_N_per_mm"], 3.0 * rows[0]["Kxx_N_per_mm"].as_f64().unwrap(), 1e-9));
    let gcode = file("swept.gcode", "G1 X120 F9000\nG1 Y120\nM400\n");
    let words = format!("sweep {} --vary head_mass_kg=0.4:0.8:2 --assume-homed 100,100,0", gcode.display());
    let played = json(&words);
    let [light, heavy] = [0, 1].map(|i| played["rows"][i]["contour_max_mm"].as_f64().unwrap());
    assert!(light < heavy, "{played}");
    assert!(complaint("sweep --vary belt_EA=1:2:3").contains("belt_EA_N"));
    assert_eq!(twin("sweep --vary belt_EA_N=1:2").status.code(), Some(2));
    // The model's own numbers must follow from the model's own ringing, given to a hundredth of a hertz.
    let rung = [[235.0, 235.0], [60.0, 50.0]].map(|[x, y]| {
        let modes = json(&format!("modes --model rotors --at {x},{y}"));
        let hz = |i: usize| modes["frequencies_Hz"][i].as_f64().unwrap();
        format!("--measured {x},{y},{:.2},{:.2}", hz(1), hz(0))
    });
    let found = json(&format!("fit {}", rung.join(" ")));
    assert!(near(&found["belt_EA_N"], 30_000.0, 0.01) && near(&found["holding_torque_Nm"], 0.4, 0.02), "{found}");
    assert!(near(&found["x"]["frequency_Hz"], 101.4, 1e-3) && near(&found["y"]["span_mm"], 862.2, 1e-9), "{found}");
    let one = json("fit --measured 235,235,101.4,57.6");
    assert!(one["x"].is_null() && one["belt_EA_N"].as_f64().unwrap() > 0.0, "{one}");
    // Where x and y are swapped, or a harmonic was read, no machine rings like that.
    for words in ["fit --measured 235,235,57.6,101.4", "fit --measured 235,235,101.4,57.6 --measured 60,50,215.6,61.9"]
    {
        let told = complaint(words);
        assert!(told.contains("no belt and motors ring like this") && told.contains("measure it again"), "{told}");
    }
    assert!(complaint("fit --measured 235,235,100,-").contains("two frequencies"));
    assert!(complaint("fit --measured 5,5,100,60").contains("outside"));
}

#[test]
fn what_an_owner_measured_becomes_a_file_of_parameters() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/twin/measured.toml");
    let found = json(&format!("fit {}", example.display()));
    for (key, value) in [("belt_EA_N", 30_000.0), ("preload_N", 40.0), ("holding_torque_Nm", 0.4)] {
        assert!(near(&found["params"][key], value, 0.003), "{found}");
    }
    assert_eq!(found["estimates"].as_array().unwrap().len(), 6);
    assert_eq!(found["measurements"].as_array().unwrap().len(), 9);
    // It prints a file of parameters.
    let printed = String::from_utf8(twin(&format!("fit {}", example.display())).stdout).unwrap();
    let params = file("fitted.toml", &printed);
    let modes = json(&format!("modes --model rotors --params {}", params.display()));
    assert!(near(&modes["frequencies_Hz"][0], 57.6, 2e-3) && near(&modes["frequencies_Hz"][1], 101.4, 2e-3), "{modes}");
    // An unweighed belt makes the tension as uncertain as its weight.
    let text = std::fs::read_to_string(&example).unwrap();
    let unweighed = file("unweighed.toml", &text.replace("belt_kg_per_m", "# "));
    let uncertainty = |found: &Value| found["estimates"][1]["uncertainty"].as_f64().unwrap();
    assert_eq!(found["estimates"][1]["parameter"], "preload_N");
    let unweighed = json(&format!("fit {}", unweighed.display()));
    assert!((uncertainty(&found) - 0.0445).abs() < 5e-4 && (uncertainty(&unweighed) - 0.1065).abs() < 5e-4, "{found}");
    assert_eq!(unweighed["not_told"][0]["parameter"], "belt_kg_per_m");
    // Numbers that are not sought go through.
    let other = file("wide.toml", "width_mm = 480\n");
    let kept = twin(&format!("fit {} --params {}", example.display(), other.display()));
    assert!(String::from_utf8(kept.stdout).unwrap().contains("width_mm = 480"));
}

#[test]
fn measurements_that_do_not_do_are_told_in_one_line() {
    let ring = "[[ring]]\nat = [195, 208.8]\nx_Hz = 101\n";
    let weights = "[[weight]]\nof = \"head\"\nmass_kg = 0.6\n[[weight]]\nof = \"bar\"\nmass_kg = 1.2\n";
    let bad = [
        (format!("{ring}{ring}"), "do not determine belt_EA_N and head_mass_kg"),
        ("belt_uncertainty_percent = 5\n".to_owned(), "line 1: belt_uncertainty_percent is one of belt_kg_per_m"),
        (String::new(), "nothing was measured"),
        (ring.replace("101", "0"), "line 3: x_Hz = 0 is outside 1 to 5000"),
        (ring.replace("x_Hz", "xHz"), "line 3: unknown field `xHz`"),
        (ring.replace("195", "1950"), "line 2: at = [1950, 208.8] is outside the reach"),
        ("[[ring]]\nat = [195, 208.8]\n".to_owned(), "line 2: expected x_Hz or y_Hz"),
        ("[[slip]]\nforce_N = 4\n".to_owned(), "line 1: missing field `lever_mm`"),
        ("[[weight]]\nof = \"head\"\nmass_kg = 30\n".to_owned(), "head_mass_kg = 29.9"),
        (
            format!("{ring}{}{weights}", ring.replace("101", "202")),
            "no machine measures like this: of ring x_Hz in line 6",
        ),
    ];
    for (text, word) in bad {
        let path = file("unfit.toml", &text);
        let told = complaint(&format!("fit {}", path.display()));
        assert!(told.contains("unfit.toml") && told.contains(word), "{told}");
    }
    assert_eq!(twin("fit").status.code(), Some(2));
}

#[test]
fn a_compensated_trace_keeps_the_tool_nearer_to_its_line() {
    let moves = "G1 X120 Y100 F12000\nG1 Y120\nG1 X100 Y100\nM400\n";
    let gcode = file("bent.gcode", &format!("M201 X9000 Y9000\nM204 P9000 T9000\n{moves}"));
    let [trace, bent] = ["bent.csv", "bent-out.csv"].map(|name| gcode.with_file_name(name));
    let mut run = Command::new(env!("CARGO_BIN_EXE_corehbot"));
    run.arg("run").arg(&gcode).arg("--trace").arg(&trace).args(["--assume-homed", "100,100,0"]);
    assert!(run.output().unwrap().status.success());
    let done = json(&format!("compensate {} -o {} --assume-homed 100,100,0", trace.display(), bent.display()));
    let ahead: Vec<f64> = done["ahead_um"].as_array().unwrap().iter().map(|um| um.as_f64().unwrap()).collect();
    // M a / K is 18 um in x and 55 in y at 7.5 m/s2, within the belt's limit; where corners jump it is more.
    assert!((10.0..120.0).contains(&ahead[0]) && ahead[1] > ahead[0] && ahead[1] < 250.0, "{done}");
    let rms = |of: &Path| {
        let words = format!("run {} --against {} --assume-homed 100,100,0", of.display(), trace.display());
        json(&format!("{words} --model rotors"))["contour"]["rms_mm"].as_f64().unwrap()
    };
    let [before, after] = [&trace, &bent].map(|of| rms(of));
    assert!(after < 0.6 * before, "{before} {after}");
    let head = |path: &Path| std::fs::read_to_string(path).unwrap().lines().take(2).collect::<Vec<_>>().join("\n");
    assert_eq!(head(&trace), head(&bent));
    let beyond = complaint(&format!("compensate {} -o {} --assume-homed 385,380,0", trace.display(), bent.display()));
    assert!(beyond.contains("the path takes") && beyond.contains("the tool reaches"), "{beyond}");
    assert!(complaint("compensate nowhere.gcode -o u.gcode").contains("cannot open"));
    assert_eq!(twin("compensate t.csv -o u.csv --smooth 0").status.code(), Some(2));
}

/// With drivers at 64 microsteps and motors that may accelerate more than the print asks for, a compensated file has a
/// third of its error on the unchanged firmware. With stiffness 20 % off it has half. Without them the steps alone
/// leave less room.
#[test]
fn compensated_g_code_takes_the_error_to_a_third_if_steps_are_fine_and_motors_have_a_reserve() {
    let moves =
        "G1 X120 Y100 E1 F12000\nM106 S80\nG1 Y120 E2\nG1 X100 Y100\nG1 E1.2 F1800\nG1 Z1 F600\nG1 X110 F9000\n";
    let gcode = file("sent-ahead.gcode", &format!("M302 S0\nM83\nM204 P4000 T4000\n{moves}G4 P100\nG1 X90 Y90\nM84\n"));
    let out = gcode.with_file_name("sent-ahead-out.gcode");
    let fine = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/twin/fine-steps.toml");
    let home = "--assume-homed 100,100,0";
    let told = |settings: &str| {
        let words = format!("compensate {} -o {} --measure {home} {settings}", gcode.display(), out.display());
        json(&words)["measured"].clone()
    };
    let divided = |told: &Value, key: &str| told[key].as_f64().unwrap();
    let coarse = told("");
    let fine = format!("--settings {}", fine.display());
    let told = told(&fine);
    assert!(divided(&told, "divided") > 3.0 && divided(&told, "divided_off") > 2.0, "{told}");
    assert!(divided(&coarse, "divided_at_most") < divided(&told, "divided_at_most") / 2.5, "{coarse} {told}");
    // The firmware ends where it would have, to the step, and nothing is wrong with its steps.
    let net = |path: &Path| net_steps(&format!("run {} {home} {fine}", path.display()));
    assert_eq!(net(&gcode), net(&out));
    let text = std::fs::read_to_string(&out).unwrap();
    assert_eq!(text.matches("M106 S80\n").count(), 1);
    assert!(text.matches("G4 P100\nM400\n").count() == 1, "{text}");
    assert!(text.contains("M204 P4000 T4000\nM400\nG4 P100"), "limits of the file hold where it rests: {text}");
}

/// Inches, places with other names, relative moves, overrides and pressure advance: motors end where they would have,
/// filament too, and later lines keep their meaning.
#[test]
fn compensated_g_code_means_what_the_file_does() {
    let lines = "M302 S0\nM900 K0.05\nG1 X110 Y100 E1 F6000\nG92 X10 E0\nG1 X20 Y105 E1\nG91\nG1 X-5 Y5 E1\nG20\nG1 X.2 E.02\n\
                 G90\nG92 Y1 E0\nG1 Y1.5 E.03\nSET_PRESSURE_ADVANCE ADVANCE=0.03\nM220 S150\nG1 X1\nM83\nG1 X.5 Y1 E.05\nM400\n\
                 G92 X2\nM400\nG1 X2.5\nG21\nM400\nM114\nM900\n";
    let gcode = file("modes.gcode", lines);
    let out = gcode.with_file_name("modes-out.gcode");
    json(&format!("compensate {} -o {} --assume-homed 100,100,0", gcode.display(), out.display()));
    // The same is said after both.
    let net = |path: &Path| {
        let after = "G90\nM82\nG1 X30 Y7 Z1 E3 F3000\nG91\nG1 X1 E1\nM400\n";
        let path_after = path.with_extension("after.gcode");
        std::fs::write(&path_after, std::fs::read_to_string(path).unwrap() + after).unwrap();
        net_steps(&format!("run {} --assume-homed 100,100,0", path_after.display()))
    };
    assert_eq!(net(&gcode), net(&out));
    let text = std::fs::read_to_string(&out).unwrap();
    let is_advance = |line: &&str| line.starts_with("M900") || line.starts_with("SET_PRESSURE");
    let advances: Vec<&str> = text.lines().filter(is_advance).collect();
    assert_eq!(advances, ["M900 K0", "M900 K0", "M900 K0.05", "SET_PRESSURE_ADVANCE ADVANCE=0.03", "M900"], "{text}");
}

/// Steps of the motors forward less backward, from a run's report.
fn net_steps(words: &str) -> Vec<String> {
    let run = Command::new(env!("CARGO_BIN_EXE_corehbot")).args(words.split_whitespace()).output().unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(run.status.success(), "{text}");
    let rows =
        text.lines().filter(|line| ["m1 ", "m4 ", "m8 ", "m11", "z1 ", "e0 "].iter().any(|m| line.starts_with(m)));
    rows.map(|row| row.split_whitespace().last().unwrap().to_owned()).collect()
}

#[test]
fn the_keys_of_parameter_files_stand_in_the_documentation() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/research/twin.md");
    let docs = std::fs::read_to_string(docs).unwrap();
    let nominal = serde_json::to_value(corehbot_twin::params::Params::default()).unwrap();
    for (key, value) in nominal.as_object().unwrap() {
        let row =
            docs.lines().find(|line| line.starts_with(&format!("| `{key}` |"))).unwrap_or_else(|| panic!("{key}"));
        let told: f64 = row.split('|').nth(2).unwrap().trim().parse().unwrap();
        assert!(near(value, told, 1e-12), "{row}");
    }
}

#[test]
fn people_get_tables() {
    let text = String::from_utf8(twin("slip --motor 8 --at 100,100").stdout).unwrap();
    assert!(text.contains("motor 8 slipped by 4 full steps") && text.contains("residual"), "{text}");
    let both = twin("stiffness --json -");
    assert!(String::from_utf8(both.stderr).unwrap().contains("Kxx"));
}

#[test]
fn what_is_not_there_is_told_in_one_line() {
    assert!(complaint("stiffness --at 10,10").contains("x 40.00 to 430.00"));
    assert!(complaint("stiffness --gcode-frame --at 400,10").contains("x 0.00 to 390.00"));
    assert!(complaint("modes --machine hbot --free-motor 8").contains("no motor 8"));
    assert!(complaint("slip --motor 3").contains("has 1, 4, 8, 11"));
    assert!(complaint("modes --machine hbot --at 45,100").contains("52.70"));
    let bad = [("typo.toml", "belt_EA = 1\n", "line 1"), ("negative.toml", "preload_N = -1\n", "preload_N")];
    for (name, text, word) in bad {
        let path = file(name, text);
        let told = complaint(&format!("stiffness --params {}", path.display()));
        assert!(told.contains(name) && told.contains(word), "{told}");
    }
    assert!(complaint("stiffness --params nowhere.toml").contains("cannot open"));
}
