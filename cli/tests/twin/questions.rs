//! Questions about the machine: points, resonance, other mechanisms, limits.

use super::{complaint, file, json, near, twin};
use std::process::Command;

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
    let stiff = file("stiff.toml", "[twin]\nbelt_EA_N = 60000\n");
    let k = json(&format!("stiffness --at 235,235 --machine {}", stiff.display()));
    assert!(near(&k["Kxx_N_per_mm"], 2.0 * 287.563, 1e-3), "{k}");
}

/// The machine's own routing and numbers; another routing is for comparison.
#[test]
fn a_machine_file_says_which_belts_there_are() {
    let machine = |name: &str| format!("../examples/machines/{name}.toml");
    let at = |name: &str| json(&format!("stiffness --at 235,235 --machine {}", machine(name)));
    assert_eq!(at("hbot")["machine"], "hbot");
    assert!(near(&at("hbot")["Kxx_N_per_mm"], 153.4, 1e-3));
    assert_eq!(at("corehbot-two-drivers")["machine"], "corehbot");
    assert_eq!(at("cartesian-xz")["machine"], "moving-bed");
    let other = json(&format!("stiffness --at 235,235 --machine {} --routing corexy", machine("hbot")));
    assert!(near(&other["Kxx_N_per_mm"], 198.1, 1e-3), "{other}");
    // z is in the answer where belts lift the tool.
    let xyz = json(&format!("geometry --machine {}", machine("corexyz")));
    assert_eq!(xyz["motors"][3]["belt_per_mm"].as_array().unwrap().len(), 3, "{xyz}");
    // Two belts of two kinds.
    let unlike = file(
        "unlike.toml",
        "[mechanism]\nm11 = [1, 1, 0]\nm8 = [1, -1, 0]\nz1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n[axes]\nx.length = 300\ny.length = 300\n[twin]\nbelt_EA_N = [20000, 40000]\n",
    );
    let k = json(&format!("stiffness --at 235,235 --machine {}", unlike.display()));
    assert!(near(&k["Kxx_N_per_mm"], 198.1, 1e-3) && near(&k["Kxy_N_per_mm"], -198.1 / 3.0, 1e-3), "{k}");
}

#[test]
fn a_place_of_g_code_is_counted_from_the_corner_of_the_reach() {
    let [paper, gcode] = ["stiffness --at 60,31.2", "stiffness --gcode-frame --at 20,5"].map(json);
    assert!(near(&gcode["x_mm"], 60.0, 1e-9) && near(&gcode["Kxx_N_per_mm"], 348.927, 1e-3), "{gcode}");
    assert!(near(&gcode["Kyy_N_per_mm"], paper["Kyy_N_per_mm"].as_f64().unwrap(), 1e-9), "{gcode}");
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
    // By the error of the tool the shortest is best, because belts lag; the text says so.
    assert_eq!(told["y"]["by_tool"]["suggestion"]["type"], "ZV", "{told}");
    // The firmware takes the lines.
    let line = |axis: &str| ["line", "line_by_tool"].map(|key| told[axis][key].as_str().unwrap().to_owned()).join("\n");
    let lines = ["x", "y"].map(line).join("\n");
    let gcode = file("shapers.gcode", &format!("{lines}\nG1 X110 F6000\nM400\n"));
    let run = Command::new(env!("CARGO_BIN_EXE_corehbot")).arg("run").arg(&gcode).output().unwrap();
    let text = String::from_utf8(run.stdout).unwrap();
    assert!(run.status.success() && !text.contains("ignored"), "{text}");
    assert_eq!(twin("resonance --grid 1x4").status.code(), Some(2));
    let page = gcode.with_file_name("resonance.html");
    assert!(twin(&format!("resonance --grid 3x4 --report {}", page.display())).status.success());
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(told["y"]["line"].as_str().unwrap()) && !page.contains("/*PAGE*/"), "{page}");
}

/// Pitches of a string, and a belt's tension from a pitch; walls' ripple with its picture.
#[test]
fn tensions_and_ripple_are_told_of_any_routing() {
    let told = json("tension --wanted 160 --heard 2=63.62 --at 235,235");
    let part = &told["parts"][1];
    assert!(near(&part["length_mm"], 444.6, 1e-9) && near(&part["pitch_Hz"], 127.23, 1e-3), "{told}");
    assert!(near(&told["heard"][0]["tension_N"], 40.0, 1e-3), "{told}");
    assert_eq!(json("tension --routing corexyz")["parts"].as_array().unwrap().len(), 36);
    assert!(complaint("tension --heard 99=20").contains("1 to 14"));
    assert!(complaint("tension --at 40,100 --heard 12=60").contains("too short"));
    assert_eq!(twin("tension --heard 2").status.code(), Some(2));
    assert!(complaint("tension --heard 2=60 --heard 2=70").contains("part 2 has two pitches"));
    let picture = file("ripple.svg", "");
    let words = format!("ripple --speeds 20-120 --step 5 --angle-step 15 --svg {}", picture.display());
    let told = json(&words);
    assert_eq!(told["across_um"].as_array().unwrap().len(), told["angles_deg"].as_array().unwrap().len());
    assert_eq!(told["across_um"][0].as_array().unwrap().len(), 21, "{told}");
    assert!(told["best"]["across_um"].as_f64().unwrap() > 0.0 && told["currents"].as_array().unwrap().len() == 5);
    let drawn = std::fs::read_to_string(picture).unwrap();
    assert!(drawn.contains("<title>Amplitude of the ripple across the wall"), "{drawn}");
    assert!(drawn.starts_with("<svg") && drawn.trim_end().ends_with("</svg>") && !drawn.contains("NaN"), "{drawn}");
    assert!(complaint("ripple --at 1,1").contains("outside"));
    for wrong in ["ripple --speeds 20", "ripple --speeds 100-20", "ripple --step 0", "ripple --longest nan"] {
        assert_eq!(twin(wrong).status.code(), Some(2), "{wrong}");
    }
}

#[test]
fn limits_are_told_for_an_error_and_a_part_of_the_torque() {
    let told = json("limits --model reduced --error 0.05");
    assert!(near(&told["x"]["speed_jump_mm_s"], 2.0 * 17.307, 1e-3), "{told}");
    // Friction takes the same of each part of the torque.
    let [less, half, more] = [0.25, 0.5, 0.75].map(|part| {
        let told = json(&format!("limits --torque {part}"));
        let standstill = &told["torque_at_speed"]["directions"][1]["acceleration_mm_s2"][0];
        let along_y = told["y"]["torque_acceleration_mm_s2"].as_f64().unwrap();
        assert!(near(standstill, along_y, 1e-9), "{told}");
        along_y
    });
    assert!(((more - half) / (half - less) - 1.0).abs() < 1e-9 && half > 2.0 * less, "{less} {half} {more}");
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
    let words = format!("run {} --assume-homed 100,100,0 --machine {}", gcode.display(), machine.display());
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

/// Each machine file of the examples, with every axis that its belts move.
#[test]
fn limits_and_resonance_are_told_for_every_machine_file() {
    let mut lifted = 0;
    for entry in std::fs::read_dir("../examples/machines").unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|end| end != "toml") {
            continue;
        }
        let limits = json(&format!("limits --model reduced --machine {}", path.display()));
        let resonance = json(&format!("resonance --model reduced --grid 2x2 --machine {}", path.display()));
        assert_eq!(limits["z"].is_null(), resonance["z"].is_null(), "{}", path.display());
        lifted += u32::from(limits["z"].is_object());
        for axis in ["x", "y", "z"].into_iter().filter(|axis| limits[axis].is_object()) {
            assert!(
                limits[axis]["torque_acceleration_mm_s2"].as_f64().unwrap() > 1000.0,
                "{}: {limits}",
                path.display()
            );
            assert!(resonance[axis]["band_Hz"][0].as_f64().unwrap() > 10.0, "{}: {resonance}", path.display());
        }
        let settings = &limits["torque_at_speed"]["settings"];
        assert_eq!(settings["worst_rise_deg"].is_null(), limits["z"].is_null(), "{}: {limits}", path.display());
    }
    // CoreXYZ with four and three motors, and CoreXZ.
    assert_eq!(lifted, 3);
}

#[test]
fn a_soft_frame_is_told() {
    let soft = file("soft.toml", "[twin]\nframe_stiffness_N_per_mm = [400, 900]\n");
    let limits = json(&format!("limits --model reduced --machine {}", soft.display()));
    assert!(near(&limits["frame_um_per_m_s2"][1], 2.0, 1e-9), "{limits}");
    let resonance = json(&format!("resonance --model reduced --grid 3x3 --machine {}", soft.display()));
    assert!(near(&resonance["frame"][0]["band_Hz"][0], 29.25, 2e-3), "{resonance}");
    assert!(near(&resonance["frame"][1]["part"], 0.161, 1e-2), "{resonance}");
}
