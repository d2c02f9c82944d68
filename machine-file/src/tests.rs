//! Tests of machine_file.

use super::*;
use corehbot::kinematics::Mechanism;
use corehbot::motors::prototype;
use corehbot::settings::{CornerRule, ShaperKind, Thermistor, Wiring};
use corehbot::units::{Hertz, Mm, MmPerSec, Seconds, StepsPerMm};

#[test]
fn an_empty_file_is_the_prototype() {
    assert_eq!(load("").unwrap(), Settings::prototype());
}

#[test]
fn the_example_is_the_prototype_with_every_key() {
    let text = include_str!("../../examples/machines/prototype.toml");
    assert_eq!(load(text).unwrap(), Settings::prototype());
    assert_eq!(text.lines().filter(|l| l.contains(" = ") && !l.starts_with('#')).count(), 361);
}

#[test]
fn keys_stand_over_the_defaults() {
    let s = load("soft_endstops = false\n[axes.x]\nmax_speed = 250\n[corner]\nsquare_corner = 8.5").unwrap();
    assert_eq!(s.axes.x.max_speed, MmPerSec::from_num(250));
    assert_eq!(s.axes.x.length, Settings::prototype().axes.x.length);
    assert_eq!(s.corner, CornerRule::SquareCorner(MmPerSec::from_num(8.5)));
    assert!(!s.soft_endstops && !s.require_homing);
    assert!(load("require_homing = true").unwrap().require_homing);
    let s = load("[shaper.x]\nkind = \"2hump_ei\"\nfrequency = 42.5\n[advance]\ntime = 0.05").unwrap();
    assert_eq!((s.shapers.x.kind, s.shapers.x.frequency), (ShaperKind::TwoHumpEi, Hertz::from_num(42.5)));
    let s2 = load("[shaper.y]\nspan = 862.2\nmotor_frequency = 167").unwrap();
    assert_eq!((s2.shapers.y.span, s2.shapers.y.motor_frequency), (Mm::from_num(862.2), Hertz::from_num(167)));
    assert_eq!((s.shapers.y.kind, s.advance.time), (ShaperKind::None, Seconds::from_num(0.05)));
    for (word, window) in [("\"auto\"", None), ("0.03", Some(Seconds::from_num(0.03)))] {
        assert_eq!(load(&format!("[advance]\nwindow = {word}")).unwrap().advance.window, window);
    }
    assert_eq!(s.advance.window, None);
}

#[test]
fn every_sensor_has_a_name() {
    for thermistor in Thermistor::all() {
        let sheet = thermistor.sheet().map(|sheet| format!("{:?}", sheet.name));
        let name = sheet.unwrap_or_else(|| "{ ohms = 100000, beta = 3950 }".to_owned());
        let settings = load(&format!("[heaters.chamber]\nthermistor = {name}")).unwrap();
        assert_eq!(settings.thermal.heaters.chamber.thermistor, thermistor);
    }
}

#[test]
fn a_mechanism_lists_the_motors_that_are_fitted() {
    let xy = "m8 = [1, 0, 0]\nm11 = [0, 1, 0]\n";
    let s =
        load(&format!("[mechanism]\n{xy}z1 = [0, 0, 1]\ne0 = [0, 0, 0, -1]\n[axes.y]\nsteps_per_mm = 100")).unwrap();
    let none = [0; 4];
    assert_eq!(
        s.mechanism,
        Mechanism::of(&[none, none, [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], none, [0, 0, 0, -1]])
    );
    let error = |text: &str| load(&format!("[mechanism]\n{text}")).unwrap_err().to_string();
    let illegal = "is not a row: -1, 0 or 1, all times one whole number up to 16, for x, y, z and, if not 0, for e";
    assert_eq!(error("m1 = [2, 1, 0]"), format!("mechanism.m1 = [2.0, 1.0, 0.0] {illegal}"));
    assert_eq!(error("z2 = [0, 0.5, 0]"), format!("mechanism.z2 = [0.0, 0.5, 0.0] {illegal}"));
    for short in ["e0 = [0, 1]", "e0 = [0, 0, 0, 0, 1]", "e0 = []", "e0 = [nan, 0, 0]"] {
        assert!(error(short).contains(illegal), "{short}");
    }
    assert_eq!(error(xy), "mechanism: no motor moves z");
    assert_eq!(error(&format!("{xy}z1 = [0, 0, 1]")), "mechanism: no motor moves e");
    let rest = "z1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]";
    assert!(error(&format!("m1 = [1, 1, 0]\nm4 = [-1, -1, 0]\n{rest}")).contains("do not hold"));
    assert!(error(&format!("{xy}z1 = [0, 0, 1, 1]")).contains("mechanism.z1: a motor moves the tool or the filament"));
    let many = "m1 = [1, 1, 0]\nm4 = [1, -1, 0]\nm8 = [1, 0, 0]\nm11 = [0, 1, 0]";
    assert!(error(&format!("{many}\n{rest}")).contains("at most 5 motors may differ"));
    assert!(error("m2 = [1, 0, 0]").contains("unknown field `m2`"));
    assert!(error(&format!("m8 = [1, 0, 1]\nm11 = [0, 1, 0]\n{rest}")).contains("x and z share motors"));
}

#[test]
fn the_bed_is_what_the_tool_reaches_unless_the_file_says_otherwise() {
    let s = load("[axes.x]\nlength = 300\n[bed]\ndepth = 200\nfront = 12.5").unwrap();
    let bed = [s.bed.width, s.bed.depth, s.bed.left, s.bed.front].map(|mm| mm.to_num::<f64>());
    assert_eq!(bed, [300.0, 200.0, 0.0, 12.5]);
    let error = |text: &str| load(text).unwrap_err().to_string();
    assert_eq!(error("[bed]\nwidth = 0"), "bed.width = 0 is outside 1 to 5000");
    assert_eq!(error("[bed]\nleft = 5001"), "bed.left = 5001 is outside -5000 to 5000");
}

#[test]
fn an_axis_may_begin_anywhere_within_five_metres_and_its_switch_sits_at_its_end() {
    let s =
        load("[axes.x]\nmin = -60\nlength = 290\n[axes.y]\nmin = 10\nlength = 400\n[homing.y]\nend = \"max\"").unwrap();
    let ends = [s.endstops.x, s.endstops.y, s.endstops.z].map(|switch| switch.position.to_num::<f64>());
    assert_eq!(ends, [-60.0, 410.0, 0.0]);
    let bed = [s.bed.width, s.bed.depth, s.bed.left, s.bed.front].map(|mm| mm.to_num::<f64>());
    assert_eq!(bed, [290.0, 400.0, -60.0, 10.0]);
    let error = |text: &str| load(text).unwrap_err().to_string();
    let told = "axes.x.length = 1001 is outside 1 to 1000, as the axis begins at 4000";
    assert_eq!(error("[axes.x]\nmin = 4000\nlength = 1001"), told);
    assert_eq!(error("[axes.z]\nmin = -5001"), "axes.z.min = -5001 is outside -5000 to 5000");
    let text = "[axes.x]\nmin = -60\nlength = 290\n[homing.x]\nposition = -111";
    assert_eq!(error(text), "homing.x.position = -111 is outside -110 to 85");
}

#[test]
fn a_probe_is_plugged_in_by_name() {
    let s = load("board = \"octopus\"\n[endstops]\nprobe = \"!BLTOUCH\"").unwrap();
    assert_eq!((s.probe_plug.connector.to_string(), s.probe_plug.is_normally_open), ("BLTOUCH".to_owned(), true));
    assert!(load("").unwrap().probe_plug.connector.is_none());
    let wrong = load("board = \"nucleo\"\n[endstops]\nprobe = \"PROBE\"").unwrap_err().to_string();
    assert!(wrong.contains("probe: the CNC shield has no connector PROBE; it has X, Y, Z"), "{wrong}");
}

#[test]
fn motors_and_switches_are_plugged_in_by_name() {
    let s = load("[motors]\nm1 = \"!M7\"\nz2 = \"\"\n[endstops]\ny = \"!E0DET\"").unwrap();
    let plug = |motor| (s.wiring.of(motor).connector.to_string(), s.wiring.of(motor).is_reversed);
    assert_eq!(plug(prototype::M1), ("M7".to_owned(), true));
    assert_eq!((plug(prototype::Z2), plug(prototype::E0)), ((String::new(), false), ("M6".to_owned(), false)));
    let y = s.wiring.endstops.y;
    assert_eq!((y.connector.as_str(), y.is_normally_open), ("E0DET", true));
    assert!(!s.wiring.endstops.x.is_normally_open);
    let error = |text: &str| load(text).unwrap_err().to_string();
    let none = "is not a connector: its name on the board, up to 8 characters; perhaps ! before it";
    assert_eq!(error("[motors]\nm1 = \"M 1\""), format!("motors.m1 = \"M 1\" {none}"));
    for text in ["!", "123456789", "!!M1"] {
        assert_eq!(error(&format!("[endstops]\nz = \"{text}\"")), format!("endstops.z = {text:?} {none}"));
    }
    assert_eq!(error("[motors]\nm1 = \"M1\""), "motor m1 and motor m4 have the same connector, M1");
    assert!(error("[motors]\nm3 = \"M1\"").contains("unknown field `m3`"));
}

#[test]
fn a_file_with_a_board_is_held_to_it() {
    for board in corehbot_boards::all() {
        let machine = parse(&format!("board = \"{}\"", board.key)).unwrap();
        assert_eq!((machine.board, machine.settings.wiring), (Some(board), Wiring::usual(board)));
    }
    let error = |text: &str| {
        let text = format!("board = \"octopus\"\n{text}");
        let error = load(&text).unwrap_err();
        format!("{}: {error}", error.place(&text).unwrap())
    };
    let has = "it has M0, M1, M2, M3, M4, M5, M6, M7";
    assert_eq!(error("[motors]\nm1 = \"M8\""), format!("3:6: motor m1: the BTT Octopus has no connector M8; {has}"));
    assert!(error("[motors]\nm1 = \"\"").starts_with("3:6: motor m1: it has no connector; the BTT Octopus has M0"));
    assert!(error("[endstops]\nz = \"J27\"").starts_with("3:5: endstop of z"));
    let hotend = "[heaters.hotend]\nis_fitted = true\noutput = \"he2\"";
    let said = "4:10: heater hotend: the BTT Octopus has no output he2; it has bed, he0, he1";
    assert_eq!(error(hotend), said);
    assert!(load(hotend).is_ok(), "anything goes without a board");
    assert!(load("board = \"octopuss\"").unwrap_err().to_string().ends_with("did you mean `octopus`?"));
}

#[test]
fn a_turn_of_the_motor_gives_the_resolution() {
    let s = load("[axes.z]\nrotation_distance = 8\n[drivers.z]\nmicrosteps = 64").unwrap();
    assert_eq!(s.axes.z.steps_per_mm, StepsPerMm::from_num(1600));
    let xy = |turn: &str| format!("[axes]\nx = {{ {turn} }}\ny = {{ {turn} }}");
    let s = load(&xy("rotation_distance = 40, full_steps = 400")).unwrap();
    assert_eq!(s.axes.x.steps_per_mm, StepsPerMm::from_num(160));
    let s = load("[axes.e]\nrotation_distance = 7.5\n").unwrap();
    assert_eq!(s.axes.e.steps_per_mm, StepsPerMm::from_num(3200.0 / 7.5));
    let error = |text: &str| load(text).unwrap_err().to_string();
    let both = "axes.e.rotation_distance: steps_per_mm is given as well, and one follows from the other";
    assert_eq!(error("[axes.e]\nsteps_per_mm = 400\nrotation_distance = 8"), both);
    let alone = "axes.e.full_steps: it counts with rotation_distance alone";
    assert_eq!(error("[axes.e]\nfull_steps = 400"), alone);
    assert_eq!(error("[axes.e]\nrotation_distance = 0"), "axes.e.rotation_distance = 0 is outside 0.125 to 3200");
    assert!(error("[axes.e]\nrotation_distance = -8").contains("is outside 0.125 to 3200"));
    assert!(error("[axes.e]\nrotation_distance = nan").contains("is outside 0.125 to 3200"));
    let steps = "axes.e.full_steps = 1000 is outside the whole numbers 20 to 800";
    assert_eq!(error("[axes.e]\nrotation_distance = 8\nfull_steps = 1000"), steps);
    let mixed = "[mechanism]\nm1 = [1, 0, 0]\nm4 = [0, 1, 0]\nm8 = [1, 0, 1]\nz1 = [0, 0, 1]\ne0 = [0, 0, 0, 1]\n\
                 [axes.z]\nrotation_distance = 8\n[drivers.z]\nmicrosteps = 32";
    assert!(error(mixed).contains("its motors have different microsteps"));
}

#[test]
fn errors_have_a_place() {
    let place = |text: &str| load(text).unwrap_err().place(text).map(|place| place.to_string());
    for (text, expected) in [
        ("\n[axes.x]\n max_speed = 5000", "3:14"),
        ("[axes.x]\nmax_sped = 50", "2:1"),
        ("[axes.x]\nmax_speed = 'fast'", "2:13"),
        ("[axes.x]\nmax_speed = ", "2:13"),
        ("[axes]\ny = { steps_per_mm = 100 }", "2:22"),
        ("[mechanism]\nm1 = [2, 1, 0]", "2:6"),
        ("[mechanism]\nm8 = [1, 0, 0]", "1:2"),
        ("[drivers.belt]\nmicrosteps = 24", "2:14"),
        ("[shaper.x]\nspan = 99", "2:8"),
        ("[corner]\njunction_deviation = 0.1\nsquare_corner = 1", "3:17"),
        ("[sensors.second]\nis_fitted = true\nguards = \"bed\"", "3:10"),
        ("board = \"octopus\"\n[supply]\nswitch = \"PE3\"", "3:10"),
        ("motor_max_speed = 3000\n[axes.x]\nsteps_per_mm = 20000\n[axes.y]\nsteps_per_mm = 20000", "2:7"),
    ] {
        assert_eq!(place(text).as_deref(), Some(expected), "{text}");
    }
}

#[test]
fn a_misspelt_key_has_a_suggestion() {
    let error = |text: &str| load(text).unwrap_err().to_string();
    assert!(error("[axes.x]\nmax_sped = 1").ends_with("did you mean `max_speed`?"));
    assert!(error("[axis.x]\nmax_speed = 1").ends_with("did you mean `axes`?"));
    assert!(error("[shaper.x]\nkind = 'mvz'").ends_with("did you mean `mzv`?"));
    assert!(!error("[axes.x]\ncolour = 1").contains("did you mean"));
}

#[test]
fn errors_name_the_key_and_what_is_legal() {
    let error = |text: &str| load(text).unwrap_err().to_string();
    assert_eq!(error("[axes.x]\nmax_speed = 5000"), "axes.x.max_speed = 5000 is outside 0.01 to 3000");
    assert_eq!(error("keepalive_s = 61"), "keepalive_s = 61 is outside the whole numbers 0 to 60");
    assert_eq!(error("patience_ms = 60001"), "patience_ms = 60001 is outside 0 and the whole numbers 100 to 60000");
    assert_eq!(error("minimum_cruise_ratio = 1"), "minimum_cruise_ratio = 1 is outside 0 to 0.9");
    assert!(error("patience_ms = 99").contains("patience_ms"));
    assert_eq!(error("lookahead_time = 0.4"), "lookahead_time = 0.4 is outside 0.5 to 60");
    assert!(error("print_acceleration = nan").contains("is outside 1 to 100000"));
    assert!(error("extruder_jerk = -1").contains("extruder_jerk = -1"));
    let legal = "drivers.e.stall_threshold = 256 is outside the whole numbers 0 to 255";
    assert_eq!(error("[drivers.e]\nstall_threshold = 256"), legal);
    assert!(error("[drivers.z]\nhold_percent = -1").contains("0 to 100"));
    assert!(error("[drivers.belt]\nmicrosteps = 16.5").contains("whole"));
    assert!(error("[drivers.belt]\nmicrosteps = 24").contains("1, 2, 4"));
    assert_eq!(error("[shaper.x]\nfrequency = 9"), "shaper.x.frequency = 9 is outside 10 to 500");
    assert_eq!(error("[shaper.x]\nspan = 10001"), "shaper.x.span = 10001 is outside 0 and 100 to 10000");
    assert!(error("[shaper.x]\nspan = 99").contains("shaper.x"));
    assert!(error("[shaper.y]\nkind = \"nonsense\"").contains("`none`, `zv`, `zvd`, `mzv`, `ei`, `2hump_ei`"));
    assert_eq!(error("[advance]\nwindow = 0.3"), "advance.window = 0.3 is outside 0.005 to 0.2");
    assert_eq!(error("[advance]\nwindow = 0"), "advance.window = 0 is outside 0.005 to 0.2");
    assert!(error("[advance]\nwindow = \"long\"").contains("expected \"auto\" or a number of seconds"));
    assert!(error("[axes.x]\nspeed = 1").contains("unknown field `speed`"));
    assert!(error("[supply]\nswitch = \"!PE11\"").contains("without !"));
    assert!(error("[sensors.second]\nis_fitted = true\nguards = \"chamber\"").contains("guards a fitted heater"));
    assert!(error("[axes.y]\nsteps_per_mm = 100").contains("x and y share motors"));
    assert!(error("[corner]\nsquare_corner = 1\njunction_deviation = 0.1").contains("exactly one"));
}

/// A machine with motors of other names, in another order than that of their rows.
const NAMED: &str = "[motors]\nnames = [\"x\", \"yl\", \"yr\", \"z\", \"e\"]\nyr = \"!M7\"\n[mechanism]\nz = [0, 0, 1]\n\
                     x = [1, 0, 0]\nyl = [0, 1, 0]\nyr = [0, 1, 0]\ne = [0, 0, 0, 1]\n";

#[test]
fn motors_have_the_names_of_the_file_in_its_order() {
    let s = load(NAMED).unwrap();
    let motors: Vec<String> = s.motors().map(|(_, name)| name.to_string()).collect();
    assert_eq!(motors, ["x", "yl", "yr", "z", "e"]);
    assert_eq!(s.mechanism.rows[..4], [[1, 0, 0, 0], [0, 1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]);
    assert_eq!((s.wiring.motors[2].connector.as_str(), s.wiring.motors[2].is_reversed), ("M7", true));
    assert_eq!(load(&written(&s).unwrap()).unwrap(), s);
}

#[test]
fn names_that_are_wrong_are_errors() {
    let error = |from: &str, to: &str| load(&NAMED.replace(from, to)).unwrap_err().to_string();
    assert!(error("\"yl\"", "\"left1\"").contains("up to 4 letters and digits"));
    assert!(error("\"yl\"", "\"\"").contains("is no name of a motor"));
    assert_eq!(error("\"z\", \"e\"", "\"z\", \"e\", \"x\""), "motors.names has every motor once");
    assert!(error("x = [1", "m1 = [1").contains("unknown field `m1`"), "{}", error("x = [1", "m1 = [1"));
    assert_eq!(error("z = [0, 0, 1]", "z = [0, 0, 4]").split(':').next(), Some("mechanism"));
    assert_eq!(error("!M7", "M0"), "motor x and motor yr have the same connector, M0");
}

#[test]
fn a_motor_may_have_values_of_its_own() {
    let s = load("[drivers.z]\ncurrent_ma = 900\n[drivers.z1]\ncurrent_ma = 600\nstall_threshold = 40").unwrap();
    let z = [prototype::Z1, prototype::Z2].map(|motor| s.driver_of(motor));
    assert_eq!(z.map(|driver| (driver.current_ma, driver.stall_threshold)), [(600, 40), (900, 0)]);
    let text = written(&s).unwrap();
    let tables: Vec<&str> = text.lines().filter(|line| line.starts_with("[drivers.")).collect();
    assert_eq!(tables, ["[drivers.belt]", "[drivers.e]", "[drivers.z]", "[drivers.z1]"], "none without own values");
    assert_eq!(load(&text).unwrap(), s);
    // Names are the file's own, also where a motor is called like a group.
    let named =
        format!("{NAMED}[drivers.yr]\ncurrent_ma = 500\n[drivers.x]\ncurrent_ma = 450\n[drivers.z]\nstealth = true\n");
    let s = load(&named).unwrap();
    assert_eq!(s.drivers.own.map(|own| own.current_ma)[..5], [450, 0, 500, 0, 0]);
    assert!(s.drivers.z.stealth);
    assert_eq!(load(&written(&s).unwrap()).unwrap(), s);
}

#[test]
fn own_values_that_do_not_do_are_told_with_their_place() {
    let error = |text: &str| {
        let error = load(text).unwrap_err();
        format!("{}: {error}", error.place(text).unwrap())
    };
    let range = "2:14: drivers.z1.current_ma = 0 is outside the whole numbers 100 to 1700";
    assert_eq!(error("[drivers.z1]\ncurrent_ma = 0"), range);
    assert!(error("[drivers.z1]\nstall_threshold = 256").ends_with("is outside the whole numbers 1 to 255"));
    let microsteps = error("[drivers.z1]\nmicrosteps = 16");
    assert!(microsteps.starts_with("2:1: unknown field `microsteps`"), "{microsteps}");
    let unknown = error("[drivers.z9]\ncurrent_ma = 600");
    assert!(
        unknown.starts_with("1:10: unknown field `z9`") && unknown.contains("`names` in [motors] lists"),
        "{unknown}"
    );
    let belt = error("[drivers.m4]\ncurrent_ma = 600");
    assert!(belt.starts_with("2:14: motors m1 and m4 pull one closed belt, but only m4 has its own current"), "{belt}");
    let all: String = ["m1", "m4", "m8", "m11"].map(|m| format!("[drivers.{m}]\ncurrent_ma = 600\n")).concat();
    assert_eq!(load(&all).unwrap().driver_of(prototype::M8).current_ma, 600);
}
