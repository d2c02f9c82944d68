//! Configurations of Klipper, in all forms that its documentation has, as machine files.

mod checked;
mod forms;
mod macros;
mod open;
mod proof;
mod wanted;

use crate::reports::{is_stored, verdict};
use corehbot::settings::{CornerRule, Settings};
use corehbot_machine_file::klipper::{Config, Files, Kind, Translation, matches, translate};
use std::path::{Path, PathBuf};

/// Texts by their names.
struct Texts(Vec<(String, String)>);

impl Files for Texts {
    fn matching(&mut self, from: &str, pattern: &str) -> Vec<String> {
        let folder = from.rsplit_once('/').map_or("", |(folder, _)| folder);
        let pattern = if folder.is_empty() { pattern.to_owned() } else { format!("{folder}/{pattern}") };
        let is_meant = |name: &&String| {
            let (name, pattern): (Vec<_>, Vec<_>) = (name.split('/').collect(), pattern.split('/').collect());
            name.len() == pattern.len() && name.iter().zip(pattern).all(|(name, pattern)| matches(pattern, name))
        };
        self.0.iter().map(|(name, _)| name).filter(is_meant).cloned().collect()
    }

    fn read(&mut self, name: &str) -> Result<String, String> {
        self.0
            .iter()
            .find(|(known, _)| known == name)
            .map(|(_, text)| text.clone())
            .ok_or_else(|| "no such file".into())
    }
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/klipper")
}

/// The texts of the folder of tests.
fn texts() -> Texts {
    let names = ["gantry.cfg", "parts/tool.cfg", "parts/heat/heat.inc", "awd.cfg", "bedslinger.cfg"];
    Texts(names.map(|name| (name.to_owned(), std::fs::read_to_string(folder().join(name)).unwrap())).to_vec())
}

fn translated(name: &str) -> Translation {
    let config = Config::read(name, &mut texts()).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    translate(&config, None).unwrap()
}

/// The translation of one text for the Octopus.
fn of_text(text: &str) -> Translation {
    let config = read(text).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
    translate(&config, Some(&corehbot_boards::octopus::CONNECTORS)).unwrap()
}

fn read(text: &str) -> Result<Config, Vec<String>> {
    let mut texts = Texts(vec![("printer.cfg".to_owned(), text.to_owned())]);
    Config::read("printer.cfg", &mut texts).map_err(|mistakes| mistakes.iter().map(ToString::to_string).collect())
}

#[test]
fn reports_and_machine_files_are_the_stored_ones() {
    for name in ["gantry", "awd", "bedslinger"] {
        let done = translated(&format!("{name}.cfg"));
        let problems: String = done.problems.iter().map(|problem| format!("{name}.toml:{problem}\n")).collect();
        is_stored(&folder().join(format!("{name}.txt")), &format!("{}{problems}", done.report));
        is_stored(&folder().join(format!("{name}.toml")), &done.text);
    }
}

#[test]
fn a_gantry_on_an_octopus_is_a_machine() {
    let done = translated("gantry.cfg");
    let machine = done.machine.unwrap_or_else(|| panic!("{:?}\n{}", done.problems, done.text));
    assert_eq!(machine.board.map(|board| board.key), Some("octopus"));
    let s: Settings = machine.settings;
    let plug = |name: &str| {
        let (motor, _) = s.motors().find(|(_, known)| known.as_str() == name).unwrap();
        (
            s.wiring.of(motor).connector.as_str().to_owned(),
            s.wiring.of(motor).is_reversed,
            s.mechanism.rows[motor.index()],
        )
    };
    assert_eq!(plug("x"), ("M0".into(), true, [1, 1, 0, 0]));
    assert_eq!(plug("y"), ("M1".into(), true, [1, -1, 0, 0]));
    assert_eq!(plug("z"), ("M2".into(), false, [0, 0, 1, 0]));
    assert_eq!(plug("z3"), ("M5".into(), true, [0, 0, 1, 0]));
    assert_eq!(plug("e0"), ("M6".into(), false, [0, 0, 0, 1]));
    // 400 steps, 32 microsteps, 40 mm; 200 x 32 over 40 / 5; 200 x 16 over 22.6789511 / 5.
    let steps: [f64; 4] = [s.axes.x, s.axes.y, s.axes.z, s.axes.e].map(|axis| axis.steps_per_mm.to_num());
    assert_eq!(steps[..3], [320.0, 320.0, 800.0]);
    assert!((steps[3] - 3200.0 * 5.0 / 22.678_951_1).abs() < 0.01, "{}", steps[3]);
    assert_eq!(s.axes.z.max_speed.to_num::<f64>(), 15.0);
    assert_eq!(s.axes.z.max_acceleration.to_num::<f64>(), 350.0);
    assert_eq!(s.print_acceleration.to_num::<f64>(), 3000.0);
    assert!(matches!(s.corner, CornerRule::SquareCorner(speed) if speed.to_num::<f64>() == 6.0));
    assert_eq!((s.drivers.belt.current_ma, s.drivers.belt.hold_percent, s.drivers.belt.microsteps), (800, 100, 32));
    assert_eq!((s.drivers.e.current_ma, s.drivers.e.hold_percent, s.drivers.e.stealth), (500, 40, true));
    assert_eq!([s.drivers.belt, s.drivers.z].map(|group| group.interpolate), [false, true]);
    let ends = [s.wiring.endstops.x, s.wiring.endstops.y, s.wiring.endstops.z];
    assert_eq!(ends.map(|end| end.is_normally_open), [false, true, false]);
    assert_eq!(s.endstops.x.position.to_num::<f64>(), 350.0);
    // The file says -0.5 itself, so the block of SAVE_CONFIG does not count.
    assert_eq!(s.endstops.z.position.to_num::<f64>(), -0.5);
}

/// Nothing in silence: a line for every key.
#[test]
fn every_key_has_a_verdict() {
    for name in ["gantry.cfg", "awd.cfg", "bedslinger.cfg"] {
        let config = Config::read(name, &mut texts()).unwrap();
        let report = translate(&config, None).unwrap().report;
        assert_eq!(report.sections.iter().map(|section| section.keys.len()).sum::<usize>(), config.entries.len());
        assert_eq!(report.sections.len(), config.sections.len());
    }
}

/// The rows by Klipper's own formulas: the position of a stepper, for the tool at x, y and z.
#[test]
fn every_kinematics_has_klippers_matrix() {
    let whole = std::fs::read_to_string(folder().join("bedslinger.cfg")).unwrap();
    // Axes that share motors need one resolution, and one speed limit that all motors bear.
    let whole = whole.replace("rotation_distance = 8", "rotation_distance = 40");
    for (name, [x, y, z]) in [
        ("cartesian", [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
        ("corexy", [[1, 1, 0, 0], [1, -1, 0, 0], [0, 0, 1, 0]]),
        ("corexz", [[1, 0, 1, 0], [0, 1, 0, 0], [1, 0, -1, 0]]),
        ("hybrid_corexy", [[1, -1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
        ("hybrid_corexz", [[1, 0, -1, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
    ] {
        let text = whole.replace("kinematics = cartesian", &format!("kinematics = {name}"));
        let done = translate(&read(&text).unwrap(), None).unwrap();
        let machine = done.machine.unwrap_or_else(|| panic!("{name}: {:?}\n{}", done.problems, done.text));
        let rows = machine.settings.mechanism.rows;
        assert_eq!(rows[..4], [x, y, z, [0, 0, 0, 1]], "{name}");
    }
}

/// Klipper's pin is high while there is filament: with `!` the switch closes to ground then.
#[test]
fn a_filament_sensors_input_is_taken() {
    for (pin, plug) in [("PG12", "E0DET"), ("^!PG15", "!E3DET"), ("~PB7", "!PROBE")] {
        let text = of_text(&format!("[filament_switch_sensor spool]\nswitch_pin: {pin}\n")).text;
        assert!(text.contains(&format!("\nfilament = \"{plug}\"  # printer.cfg:2\n")), "{text}");
    }
    for pin in ["EBBCan:PB4", "PF13"] {
        let text = of_text(&format!("[filament_switch_sensor spool]\nswitch_pin: {pin}\n")).text;
        assert!(!text.contains("filament ="), "{text}");
    }
}

/// By its name, else in the first place that is left. Others are told as not there.
#[test]
fn sensors_without_a_heater_have_their_places() {
    let sensor = |name: &str, pin: &str, kind: &str| {
        format!("[temperature_sensor {name}]\nsensor_type: {kind}\nsensor_pin: {pin}\nmin_temp: 0\n")
    };
    let text = [
        sensor("electronics", "PF6", "Generic 3950"),
        sensor("Chamber_top", "PF5", "PT1000"),
        sensor("toolhead", "EBBCan:PA3", "Generic 3950"),
        "[temperature_sensor pi]\nsensor_type: temperature_host\n".to_owned(),
    ];
    let done = of_text(&text.concat());
    for lines in [
        "[sensors.chamber]\nsensor = \"hotend1\"  # printer.cfg:7\nthermistor = \"pt1000\"  # printer.cfg:6\nis_fitted = true",
        "[sensors.board]\nsensor = \"hotend2\"  # printer.cfg:3\nthermistor = \"ntc_3950\"  # printer.cfg:2\nis_fitted = true",
    ] {
        assert!(done.text.contains(lines), "{}", done.text);
    }
    assert!(!done.text.contains("[sensors.probe]"), "{}", done.text);
    let report = done.report.to_string();
    assert!(report.contains("sensor_pin = EBBCan:PA3 -> no thermistor of a known kind"), "{report}");
}

/// The sensor of the main board's processor has the place of its name, else the board's; another processor's is not
/// there.
#[test]
fn the_processors_own_sensor_has_a_place() {
    let mcu = |name: &str, more: &str| format!("[temperature_sensor {name}]\nsensor_type: temperature_mcu\n{more}");
    let other = "[temperature_sensor lid]\nsensor_type: Generic 3950\nsensor_pin: PF5\n";
    for (text, wanted) in [
        (mcu("mcu_temp", ""), "[sensors.board]\nsensor = \"mcu\"  # printer.cfg:2\nis_fitted = true"),
        (mcu("octopus", "sensor_mcu: mcu\n") + other, "[sensors.board]\nsensor = \"mcu\"  # printer.cfg:2"),
        (other.to_owned() + &mcu("octopus", ""), "[sensors.chamber]\nsensor = \"hotend1\"  # printer.cfg:3"),
        (mcu("Chamber", ""), "[sensors.chamber]\nsensor = \"mcu\"  # printer.cfg:2"),
    ] {
        let done = of_text(&text);
        assert!(done.text.contains(wanted), "{}", done.text);
    }
    let done = of_text(&mcu("tool", "sensor_mcu: EBBCan\n"));
    assert!(!done.text.contains("[sensors."), "{}", done.text);
}

#[test]
fn fans_have_frequencies_and_tachometers() {
    let fan = |section: &str, pin: &str, more: &str| format!("[{section}]\npin: {pin}\n{more}");
    let text = [
        fan("fan", "PD12", "cycle_time: 0.00004\nhardware_pwm: true\n"),
        fan("heater_fan hotend", "PE5", "tachometer_pin: ^PG13\ntachometer_ppr: 4\ntachometer_poll_interval: 0.001\n"),
        fan("controller_fan drivers", "PD13", "cycle_time: 0.010\n"),
        fan("fan_generic lid", "PD14", "cycle_time: 0.00004\ntachometer_pin: PA9\n"),
    ];
    let done = of_text(&text.concat());
    for lines in [
        "[fans.fan2]\nrole = \"part\"  # printer.cfg:2\nfrequency = 25000",
        "[fans.fan1]\nrole = \"hotend\"  # printer.cfg:6\ntachometer = \"E1DET\"  # printer.cfg:7\n",
        "[fans]\npulses = 4  # printer.cfg:8\n",
        "[fans.fan3]\nrole = \"controller\"  # printer.cfg:11\n\n",
        "[fans.fan4]\nrole = \"commanded\"  # printer.cfg:14\nfrequency = 25000",
    ] {
        assert!(done.text.contains(lines), "{lines}: {}", done.text);
    }
    let report = done.report.to_string();
    for said in [
        "hardware_pwm = true -> a timer modulates",
        "tachometer_poll_interval = 0.001 -> an input is looked at",
        "cycle_time = 0.010 -> it shares a timer with fan2, and so its 25000 Hz",
        "tachometer_pin = PA9 -> PA9 is no input of the BTT Octopus",
    ] {
        assert!(report.contains(said), "{said}: {report}");
    }
}

#[test]
fn a_probes_input_has_the_name_of_its_header() {
    for (text, plug) in [
        ("[probe]\npin: ~!PB7", "PROBE"),
        ("[probe]\npin: ~PB7", "!PROBE"),
        ("[probe]\npin: !PB7", "PROBE"),
        ("[probe]\npin: ^PB7", "BLTOUCH"),
        ("[bltouch]\nsensor_pin: PB7", "BLTOUCH"),
        ("[bltouch]\nsensor_pin: ^!PB7", "!BLTOUCH"),
        ("[probe]\npin: ^!PG15", "!E3DET"),
    ] {
        let text = of_text(text).text;
        assert!(text.contains(&format!("\nprobe = \"{plug}\"  # printer.cfg:2\n")), "{text}");
    }
    // A pin elsewhere: what is not the pin stays.
    for (pin, plug) in [("PF13", ""), ("!EBBCan:PB6", "!")] {
        let text = of_text(&format!("[probe]\npin: {pin}\nx_offset: -20\n")).text;
        assert!(text.contains(&format!("probe = \"{plug}\"  # to decide\n")), "{text}");
        assert!(text.contains("\nkind = \"switch\"") && text.contains("[probe.offset]\nx = -20"), "{text}");
    }
}

/// Klipper sorts the points, and so does the machine file.
#[test]
fn a_thermistor_of_three_points_stays_one() {
    let points = "temperature1: 25\nresistance1: 100000\ntemperature2: 90\nresistance2: 8700\ntemperature3: 150\nresistance3: 1770";
    let done = of_text(&format!("[thermistor a b]\n{points}\n[heater_bed]\nsensor_type: a b\n"));
    let line = "\nthermistor = { points = [[25, 100000], [90, 8700], [150, 1770]] }";
    assert!(done.text.contains(line), "{}", done.text);
    assert_eq!(verdict(&done.report, "thermistor a b", "resistance3").0, Kind::Taken);
    let done = of_text("[heater_bed]\nsensor_type: EPCOS 100K B57560G104F\n");
    let line = "\nthermistor = { points = [[25, 100000], [150, 1641.9], [250, 226.15]] }";
    assert!(done.text.contains(line), "{}", done.text);
    assert_eq!(verdict(&done.report, "heater_bed", "sensor_type").0, Kind::Taken);
}

#[test]
fn a_switch_without_a_place_sits_at_its_end() {
    let done = of_text("[stepper_x]\nposition_max: 300\nhoming_positive_dir: True\n[stepper_y]\nposition_max: 200\n");
    assert!(done.text.contains("end = \"max\"  # printer.cfg:3\n"), "{}", done.text);
    assert_eq!(verdict(&done.report, "stepper_x", "homing_positive_dir").0, Kind::Taken);
    assert!(done.report.notes.iter().any(|note| note.text.contains("homing.y.position is the min end")));
}
