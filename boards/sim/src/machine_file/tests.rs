//! Tests of machine_file.

use super::*;
use corehbot::settings::Thermistor;
use corehbot::units::{Hertz, Mm, MmPerSec, Seconds};

#[test]
fn an_empty_file_is_the_prototype() {
    assert_eq!(load("").unwrap(), Settings::prototype());
}

#[test]
fn the_example_is_the_prototype_with_every_key() {
    let text = include_str!("../../../../examples/machines/prototype.toml");
    assert_eq!(load(text).unwrap(), Settings::prototype());
    assert_eq!(text.lines().filter(|l| l.contains(" = ")).count(), 176);
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
}

/// The name of a sensor in a machine file: a new kind does not compile before it has one.
const fn name(thermistor: Thermistor) -> &'static str {
    match thermistor {
        Thermistor::Semitec104Gt2 => "\"104gt2\"",
        Thermistor::Semitec104Nt4 => "\"104nt4\"",
        Thermistor::Generic3950 => "\"ntc_3950\"",
        Thermistor::Slice450 => "\"slice_450\"",
        Thermistor::Pt1000 => "\"pt1000\"",
        Thermistor::Beta { .. } => "{ ohms = 100000, beta = 3950 }",
    }
}

#[test]
fn every_sensor_has_a_name() {
    for thermistor in Thermistor::all() {
        let settings = load(&format!("[heaters.chamber]\nthermistor = {}", name(thermistor))).unwrap();
        assert_eq!(settings.thermal.heaters.chamber.thermistor, thermistor);
    }
}

#[test]
fn a_mechanism_lists_the_motors_that_are_fitted() {
    let xy = "m8 = [1, 0, 0]\nm11 = [0, 1, 0]\n";
    let s =
        load(&format!("[mechanism]\n{xy}z1 = [0, 0, 1]\ne0 = [0, 0, 0, -1]\n[axes.y]\nsteps_per_mm = 100")).unwrap();
    let none = [0; 4];
    assert_eq!(s.mechanism.rows, [none, none, [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], none, [0, 0, 0, -1]]);
    let error = |text: &str| load(&format!("[mechanism]\n{text}")).unwrap_err().to_string();
    let illegal = "is no row: -1, 0 or 1 for x, y, z and, if not 0, for e";
    assert_eq!(error("m1 = [2, 0, 0]"), format!("mechanism.m1 = [2.0, 0.0, 0.0] {illegal}"));
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
fn errors_have_a_place() {
    let place = |text: &str| load(text).unwrap_err().place(text).map(|place| place.to_string());
    for (text, expected) in [
        ("\n[axes.x]\n max_speed = 5000", "3:14"),
        ("[axes.x]\nmax_sped = 50", "2:1"),
        ("[axes.x]\nmax_speed = 'fast'", "2:13"),
        ("[axes.x]\nmax_speed = ", "2:13"),
        ("[axes]\ny = { steps_per_mm = 100 }", "2:22"),
        ("[mechanism]\nm1 = [2, 0, 0]", "2:6"),
        ("[mechanism]\nm8 = [1, 0, 0]", "1:2"),
        ("[drivers.belt]\nmicrosteps = 24", "2:14"),
        ("[shaper.x]\nspan = 99", "1:9"),
        ("[corner]\njunction_deviation = 0.1\nsquare_corner = 1", "3:17"),
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
    assert_eq!(error("keepalive_s = 61"), "keepalive_s = 61 is outside 0 to 60");
    assert_eq!(error("patience_ms = 60001"), "patience_ms = 60001 is outside 0 to 60000");
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
    assert_eq!(error("[shaper.x]\nspan = 10001"), "shaper.x.span = 10001 is outside 0 to 10000");
    assert!(error("[shaper.x]\nspan = 99").contains("shaper.x"));
    assert!(error("[shaper.y]\nkind = \"zvdd\"").contains("`none`, `zv`, `zvd`, `mzv`, `ei`, `2hump_ei`"));
    assert_eq!(error("[advance]\nwindow = 0.3"), "advance.window = 0.3 is outside 0.005 to 0.2");
    assert!(error("[axes.x]\nspeed = 1").contains("unknown field `speed`"));
    assert!(error("[axes.y]\nsteps_per_mm = 100").contains("x and y share motors"));
    assert!(error("[corner]\nsquare_corner = 1\njunction_deviation = 0.1").contains("either"));
}
