//! Figures that were computed independently (two solvers, closed forms), each asked on the command line and within 1 %:
//! stiffness, modes, slips, a given shaper, a lost step.

use super::{complaint, file, json, near, twin};
use std::process::Command;

/// One per cent.
const PART: f64 = 0.01;

#[test]
fn a_slip_next_to_the_middle_moves_the_tool_by_the_shares_of_the_sides() {
    let slip = json("slip --motor 1 --at 60,400");
    assert!(near(&slip["dx_mm"], -0.283_15, PART) && near(&slip["dy_mm"], 0.123_14, PART), "{slip}");
    let modes = json("modes --model full --at 150,180");
    let found = &modes["frequencies_Hz"];
    assert!(near(&found[0], 62.34, PART) && near(&found[1], 111.72, PART), "{modes}");
}

#[test]
fn a_given_shaper_is_rated_at_a_given_vibration() {
    for (kind, known) in [("zv", 0.076_43), ("mzv", 0.048_83), ("ei", 0.044_27)] {
        let told = json(&format!("shaper --kind {kind} --frequency 66 --damping 0.03933 --ring 62.587"));
        assert!(near(&told["rings"][0]["residual"], known, PART), "{told}");
    }
    // The parts at 60 Hz and damping 0.05; two vibrations with another damping.
    let told = json("shaper --kind 2hump-ei --frequency 60 --damping 0.05 --ring 60,80 --ring-damping 0.02");
    assert_eq!(told["type"], "2HUMP_EI");
    assert!(
        near(&told["parts"][3]["amount"], 0.132_17, 1e-4) && near(&told["parts"][3]["time_ms"], 24.9013, 1e-5),
        "{told}"
    );
    assert_eq!(told["rings"].as_array().unwrap().len(), 2);
    assert_eq!(told["rings"][1]["damping"], 0.02);
    assert_eq!(twin("shaper --kind zv --frequency 60").status.code(), Some(2));
    // Frequencies and dampings as M593 takes them, and kinds as it reports them.
    for (wrong, right) in [("--frequency 9.9", "--frequency 10"), ("--frequency 501", "--frequency 500")] {
        let ask = |frequency: &str| twin(&format!("shaper --kind 2HUMP_EI {frequency} --ring 60")).status.code();
        assert_eq!((ask(wrong), ask(right)), (Some(2), Some(0)));
    }
    let humps = |damping: &str| format!("shaper --kind 2hump_ei --frequency 60 --ring 60 --damping {damping}");
    assert!(twin(&humps("0.3")).status.success() && complaint(&humps("0.31")).contains("up to 0.3"));
    assert!(twin("shaper --kind MZV --frequency 60 --ring 60 --damping 0.5").status.success());
}

/// Lists with a number for each part of the machine, and room for the tool.
#[test]
fn numbers_that_do_not_fit_the_machine_are_refused() {
    for (table, answer) in [
        ("belt_EA_N = []", "twin.belt_EA_N"),
        (
            "belt_EA_N = [56000, 30000]",
            "twin.belt_EA_N has 2 numbers, and the CoreH-bot has 1 belts; one number is for all",
        ),
        ("pole_pairs = 49.5", "twin.pole_pairs = 49.5"),
        ("motors_in_series = 0", "the whole numbers 1 to 1000000"),
        ("motor_radius_mm = [6, 5]", "twin.motor_radius_mm has 2 numbers, and the CoreH-bot has 4 motors"),
        ("frame_stiffness_N_per_mm = [1, 2, 3]", "has 3 numbers, and the CoreH-bot has 2 axes"),
        ("outside_mm = [1, 2, 3]", "has 3 numbers, and the CoreH-bot has 4 spans"),
        (
            "width_mm = 50",
            "twin.width_mm = 50, twin.depth_mm = 470: the pulleys of frame, bar and head leave the tool no room",
        ),
    ] {
        let machine = file("unfit.toml", &format!("[twin]\n{table}\n"));
        let found = complaint(&format!("modes --machine {}", machine.display()));
        assert!(found.contains(answer), "{table}: {found}");
    }
    let fits = file("fits.toml", "[twin]\nmotor_radius_mm = []\noutside_mm = [0, 200, 0, 0]\n");
    assert!(twin(&format!("modes --machine {}", fits.display())).status.success());
}

#[test]
fn forces_slips_and_files_that_cannot_be_are_refused() {
    for words in ["slip --motor 1 --full-steps 1e9", "slip --motor 1 --full-steps=-10001"] {
        assert_eq!(twin(words).status.code(), Some(2), "{words}");
    }
    for words in
        ["limits --error -1", "shaper --kind zv --frequency 60 --ring -3", "tension --wanted -3", "ripple --step -1"]
    {
        let error = String::from_utf8(twin(words).stderr).unwrap();
        assert!(error.starts_with("error: invalid value '-") && error.contains(" is not a"), "{error}");
    }
    let samples = file("samples.csv", "#time,accel_x,accel_y,accel_z\n1.0,2,3,4\n");
    let found = complaint(&format!("run {}", samples.display()));
    assert!(
        found.contains("this is a recording of an accelerometer, not G-code: `corehbot resonance FILE`"),
        "{found}"
    );
    let words = file("words.txt", "nothing that moves\n");
    let found = complaint(&format!("run {}", words.display()));
    assert!(found.contains("no motor steps in it; expected G-code that moves, or a step trace"), "{found}");
}

/// A step of motor 1 that is lost near the middle: a quarter of it to each side, as the belt gives way evenly.
#[test]
fn a_lost_step_leaves_the_tool_off_by_a_quarter_of_it() {
    let gcode = file("lost.gcode", "G1 X195 F1200\nM400\n");
    let whole = gcode.with_file_name("lost-whole.csv");
    let run = Command::new(env!("CARGO_BIN_EXE_corehbot"))
        .args(["run", "--assume-homed", "190,208.8,0", "--trace"])
        .arg(&whole)
        .arg(&gcode)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = std::fs::read_to_string(&whole).unwrap();
    // The first step of motor 1, clockwise as the tool goes to the right.
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let lost = lines.iter_mut().find(|line| line.split(',').nth(1) == Some("-1")).unwrap();
    let (tick, rest) = lost.split_once(',').unwrap();
    *lost = format!("{tick},0,{}", rest.split_once(',').unwrap().1);
    let cut = file("lost-cut.csv", &(lines.join("\n") + "\n"));
    let ask = |trace: &std::path::Path| {
        let (trace, whole) = (trace.display(), whole.display());
        json(&format!("run {trace} --against {whole} --assume-homed 190,208.8,0"))
    };
    let (good, bad) = (ask(&whole), ask(&cut));
    let quarter = 12.5 / 4.0;
    assert!(near(&good["end_off_x_um"], 0.0, 1.0) && near(&good["end_off_y_um"], 0.0, 1.0), "{good}");
    assert!(near(&bad["end_off_x_um"], -quarter, PART) && near(&bad["end_off_y_um"], quarter, PART), "{bad}");
    assert!(near(&bad["commanded_residual_mm"], 0.0125, 1e-6), "{bad}");
}
