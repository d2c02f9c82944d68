//! Every setting and every shaper is known in all of its places; these tests show where a new one is missing.
//!
//! The places are listed at the head of `src/settings/mod.rs`. That a number has a range is `tests/setting_ranges.rs`'
//! business, and that a record holds every field is serde's.

use crate::common::deaf::Deaf;
use crate::common::lines::Lines;
use crate::common::plain_lines::plain_lines;
use crate::common::setting_lines::LINES;
use corehbot::motors::prototype;
use corehbot::port::NoStorage;
use corehbot::settings::{CornerRule, PLACES, Settings, ShaperKind};
use corehbot::units::Mm;
use corehbot_machine_file as machine_file;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::run_on;
use serde_json::Value;
use std::collections::BTreeMap;
use toml::Table;

const EXAMPLE: &str = include_str!("../../../examples/machines/prototype.toml");

/// The reply of a machine of `settings` to M503 after these lines.
fn settings_as_said(settings: &Settings, lines: &[&str]) -> Vec<String> {
    let lines = lines.iter().chain(&["M503"]).map(|line| (*line).to_owned()).collect();
    let (mut host, drivers) = (Lines::new(lines), Drivers::new());
    let start = Some([Mm::ZERO; 3]);
    run_on(settings, start, NoStorage, &drivers, &mut [&mut host], &mut Deaf).unwrap();
    host.heard.into_iter().filter(|line| line.starts_with("echo:  ") || line.starts_with("echo:;")).collect()
}

/// A rule for corners: its path in the settings, its key in a machine file, and a line that sets it. A new rule does
/// not compile before it has them.
const fn corner(rule: CornerRule) -> [&'static str; 3] {
    match rule {
        CornerRule::JunctionDeviation(_) => ["corner.JunctionDeviation", "junction_deviation", "M205 J.02"],
        CornerRule::SquareCorner(_) => ["corner.SquareCorner", "square_corner", "M205 X8"],
    }
}

/// All settings by their paths, each with a machine file in which it counts: a rule for corners has a file of its own.
fn settings_and_files() -> Vec<(String, Table)> {
    let of_rule = |rule| {
        let file = file(rule);
        let paths = by_path(&load(&file).unwrap()).into_keys();
        paths.map(|path| (path, file.clone())).collect::<Vec<_>>()
    };
    let mut rules = CornerRule::all();
    let mut all = of_rule(rules.next().unwrap());
    all.extend(rules.flat_map(of_rule).filter(|(path, _)| path.starts_with("corner.")));
    all
}

/// A machine file with every key of that rule for corners, and shapers that are on. No two axes share a motor, so each
/// may be changed alone.
fn file(rule: CornerRule) -> Table {
    // Axes of their own, and a belt over all their motors that could run round.
    const ROWS: [(&str, [i64; 4]); 6] = [
        ("m1", [1, 0, 0, 0]),
        ("m4", [-1, 0, 0, 0]),
        ("m8", [0, 1, 0, 0]),
        ("m11", [0, -1, 0, 0]),
        ("z1", [0, 0, 1, 0]),
        ("e0", [0, 0, 0, 1]),
    ];
    let mut file: Table = EXAMPLE.parse().unwrap();
    let [_, key, _] = corner(rule);
    file.insert("corner".to_owned(), toml::Value::Table(Table::from_iter([(key.to_owned(), toml::Value::Float(0.5))])));
    let rows = ROWS.map(|(motor, row)| (motor.to_owned(), row.to_vec().into()));
    file.insert("mechanism".to_owned(), toml::Value::Table(Table::from_iter(rows)));
    // It would need one step for x and y.
    file["belt"]["closed"] = false.into();
    // Where a switch of either end may sit, so that the end can be changed alone.
    for axis in ["x", "y", "z"] {
        let length = &file["axes"][axis]["length"];
        let length = length.as_float().or(length.as_integer().map(|mm| mm as f64)).unwrap();
        file["homing"][axis]["position"] = (length / 2.0).into();
    }
    for axis in ["x", "y"] {
        file["shaper"][axis]["kind"] = "zv".into();
    }
    // A probe, by which z may be homed.
    file["endstops"]["probe"] = "PROBE".into();
    file["probe"]["kind"] = "switch".into();
    // One that follows the shapers would change with them.
    file["advance"]["window"] = 0.03.into();
    // A driver with values of its own for each motor.
    for motor in prototype::NAMES.into_iter().take(prototype::COUNT) {
        let own = [("current_ma", 300), ("hold_percent", 30), ("stall_threshold", 3)]
            .map(|(key, value)| (key.to_owned(), value.into()));
        let drivers = file["drivers"].as_table_mut().unwrap();
        drivers.insert(motor.to_string(), toml::Value::Table(Table::from_iter(own)));
    }
    // No board: it has not every connector that a setting may name.
    file.remove("board");
    file
}

fn load(file: &Table) -> Result<Settings, machine_file::MachineFileError> {
    machine_file::load(&file.to_string())
}

/// The settings by their paths, such as `axes.x.length`.
fn by_path(settings: &Settings) -> BTreeMap<String, Value> {
    fn gather(value: &Value, path: &str, into: &mut BTreeMap<String, Value>) {
        match value {
            Value::Array(items) if path.ends_with(".fans") => {
                items.iter().enumerate().for_each(|(n, value)| gather(value, &format!("{path}.fan{n}"), into));
            }
            Value::Array(items) if path.ends_with(".sensors") => {
                let places = PLACES.iter().zip(items);
                places.for_each(|((place, _), value)| gather(value, &format!("{path}.{place}"), into));
            }
            Value::Array(items) if path.ends_with(".home") || path.ends_with("safe_z_home.place") => {
                let axes = ["x", "y"].into_iter().zip(items);
                axes.for_each(|(axis, value)| gather(value, &format!("{path}.{axis}"), into));
            }
            Value::Array(items) if path.ends_with(".screws") => {
                items.iter().enumerate().for_each(|(n, value)| gather(value, &format!("{path}.{}", n + 1), into));
            }
            Value::Array(items) if path.ends_with(".motors") => {
                let motors = prototype::NAMES.into_iter().zip(items).take(prototype::COUNT);
                motors.for_each(|(motor, value)| gather(value, &format!("{path}.{motor}"), into));
            }
            Value::Array(items) if path.ends_with(".own") => {
                let motors = prototype::NAMES.into_iter().zip(items).take(prototype::COUNT);
                motors.for_each(|(motor, value)| gather(value, &format!("{}.{motor}", path.replace(".own", "")), into));
            }
            // A connector and which way round it is are one text.
            Value::Object(fields)
                if !["bits", "connector", "Sheet", "At"].iter().any(|key| fields.contains_key(*key)) =>
            {
                fields.iter().for_each(|(key, value)| gather(value, &format!("{path}.{key}"), into));
            }
            _ => drop(into.insert(path.trim_start_matches('.').to_owned(), value.clone())),
        }
    }
    let mut all = BTreeMap::new();
    gather(&serde_json::to_value(settings).unwrap(), "", &mut all);
    all
}

/// The key of a setting in a machine file.
fn key_of(path: &str) -> String {
    let path = path.replace("thermal.heaters", "heaters").replace("thermal.fans", "fans");
    let path = path.replace("thermal.sensors", "sensors").replace("supply.is_on_high", "supply.on_high");
    let path = if path.starts_with("endstops.") { path.replace("endstops.", "homing.") } else { path };
    let path = path.strip_prefix("axis_min.").map_or(path.clone(), |axis| format!("axes.{axis}.min"));
    let path = path.replace("homing_order", "homing.order").replace("fan_pulses", "fans.pulses");
    let path = match path.as_str() {
        "probe_plug" => "endstops.probe".to_owned(),
        "filament" => "endstops.filament".to_owned(),
        "probe.homes_z" => "probe.z_home".to_owned(),
        "job.keeps_heat" => "job.keep_heat".to_owned(),
        _ => path,
    };
    let path = path.replace(".place.", ".").replace(".point.x", ".point_x").replace(".point.y", ".point_y");
    let path = path.replace("belt.is_closed", "belt.closed").replace("settling_ms", "settling");
    let path = path.replace("shapers.", "shaper.").replace("wiring.", "");
    CornerRule::all().map(corner).fold(path, |path, [of_rule, key, _]| path.replace(of_rule, &format!("corner.{key}")))
}

/// The place of a setting in a machine file.
fn key<'f>(file: &'f mut Table, path: &str) -> Option<&'f mut toml::Value> {
    let path = key_of(path);
    let (tables, key) = path.rsplit_once('.').unwrap_or(("", &path));
    tables
        .split('.')
        .filter(|table| !table.is_empty())
        .try_fold(file, |file, table| file.get_mut(table)?.as_table_mut())?
        .get_mut(key)
}

/// Settings with another value in that key of the file.
fn changed(path: &str, file: &Table) -> Option<Settings> {
    let before = load(file).unwrap();
    let legal = |value: toml::Value| {
        let mut file = file.clone();
        *key(&mut file, path)? = value;
        load(&file).ok().filter(|settings| *settings != before)
    };
    let numbers = [0.05, 0.3, 1.0, 9.0, 0.002, 32.0, 200.0, 900.0, 115_200.0].into_iter().map(toml::Value::Float);
    let names = [
        "nozzle",
        "pause",
        "mzv",
        "he2",
        "hotend2",
        "hotend3",
        "pt1000",
        "pid",
        "hotend",
        "controller",
        "max",
        "warning",
        "E3DET",
        "adxl345",
        "-x",
    ]
    .map(toml::Value::from);
    let (order, phases) = (toml::Value::from(["z", "x", "y"].to_vec()), toml::Value::from([517, 3].to_vec()));
    [true.into(), false.into(), order, phases].into_iter().chain(names).chain(numbers).find_map(legal)
}

/// Settings that M503 says as a comment, and only a machine file sets. It says no other without a line that sets it.
const FILE_ONLY: [&str; 37] = [
    "name",
    "axis_min.x",
    "axis_min.y",
    "axis_min.z",
    "back_off",
    "baud",
    "belt.max_acceleration",
    "belt.max_speed",
    "depth",
    "end",
    "fast",
    "front",
    "homing_advance",
    "alignment",
    "preload",
    "limp_lift",
    "pause.heat_off_min",
    "pause.lift",
    "pause.park",
    "pause.retract",
    "pause.retract_speed",
    "pause.travel_speed",
    "pause.unretract_speed",
    "pause.x",
    "pause.y",
    "phases",
    "homing_order",
    "is_closed",
    "left",
    "length",
    "lookahead_time",
    "mesh.is_on",
    "position",
    "require_homing",
    "settling_ms",
    "slow",
    "width",
];

/// Rows belong to motors by their names, so neither of the two changes alone.
const OF_MOTORS: [&str; 2] = ["mechanism.rows", "motor_names"];

fn is_one_of(path: &str, names: &[&str]) -> bool {
    names.iter().any(|name| path == *name || path.ends_with(&format!(".{name}")))
}

/// Whether M503 reports it for every machine, or never. M503 reports settings of heaters and fans only if they are
/// fitted; `sim/board/tests/heat.rs` sends those lines back. It reports circulation only with a closed belt
/// (`sim/board/tests/machines/circulation.rs`). The mechanism and the connectors are not numbers.
fn is_of_all_machines(path: &str) -> bool {
    let is_of_closed_belt = path.starts_with("belt.")
        && !["belt.settling_ms", "belt.alignment", "belt.preload", "belt.phases", "belt.limp_lift"].contains(&path);
    !["probe_plug", "filament"].contains(&path)
        && !OF_MOTORS.contains(&path)
        && !is_of_closed_belt
        && !path.starts_with("thermal.")
        && !path.starts_with("supply.")
        && !path.starts_with("job.")
        && !path.starts_with("probe.")
        && !path.starts_with("accelerometer.")
        && !path.starts_with("safe_z_home.")
        && !path.starts_with("screws.")
        && !path.starts_with("fans.")
        && path != "fan_pulses"
        && !path.starts_with("wiring.")
}

/// The line that sets a setting.
fn line_for(path: &str) -> Option<String> {
    let of_corners = CornerRule::all().map(corner).map(|[path, _, line]| (path, line));
    // The motors of `file` by their places. One of them is not fitted.
    let single = [("m1", "I0 X"), ("m4", "I1 X"), ("m8", "I0 Y"), ("m11", "I1 Y"), ("z1", "I0 Z"), ("e0", "I0 E")];
    let axis = match path.split('.').nth(1).unwrap_or_default() {
        "belt" => "X".to_owned(),
        "z2" => return None,
        part => single.iter().find(|(motor, _)| *motor == part).map_or(part.to_uppercase(), |(_, word)| (*word).into()),
    };
    let own = LINES.into_iter().chain(of_corners).find(|(name, _)| is_one_of(path, &[name]));
    own.map(|(_, line)| line.replace("{}", &axis)).or_else(|| plain_lines().remove(&key_of(path)))
}

#[test]
fn every_setting_has_a_key_in_the_machine_file_that_sets_it_alone() {
    for (path, mut file) in settings_and_files().into_iter().filter(|(path, _)| !OF_MOTORS.contains(&&**path)) {
        let before = by_path(&load(&file).unwrap());
        let after = changed(&path, &file);
        let after =
            after.unwrap_or_else(|| panic!("no value changes {path}: its row in src/settings, or `changed` here"));
        let written = machine_file::written(&after).unwrap();
        assert!(machine_file::load(&written).unwrap() == after, "{path}: machine-file/src/written.rs");
        let after = by_path(&after);
        assert!(key(&mut file, &path).is_some(), "{path} has no key in examples/machines/prototype.toml");
        let other: Vec<_> = before.keys().filter(|name| before[*name] != after[*name]).collect();
        assert_eq!(other, [&path], "the key of {path}");
    }
}

#[test]
fn m503_says_the_settings_that_a_line_sets_and_those_of_the_file_that_it_lists() {
    for (path, file) in settings_and_files().iter().filter(|(path, _)| is_of_all_machines(path)) {
        let before = settings_as_said(&load(file).unwrap(), &[]);
        let is_said = settings_as_said(&changed(path, file).unwrap(), &[]) != before;
        let is_e_length = path == "axes.e.length";
        assert_eq!(
            is_said,
            (line_for(path).is_some() || is_one_of(path, &FILE_ONLY)) && !is_e_length,
            "{path}: src/machine/reports/settings_report.rs, src/machine/reports/setting.rs if it has a line of its own, or \
             FILE_ONLY here if M503 says it as a comment"
        );
    }
}

#[test]
fn a_line_sets_a_setting_and_no_other() {
    for (path, file) in settings_and_files().iter().filter(|(path, _)| is_of_all_machines(path)) {
        let settings = load(file).unwrap();
        let before = settings_as_said(&settings, &[]);
        let Some(line) = line_for(path) else { continue };
        let after = settings_as_said(&settings, &[&line]);
        let different = before.iter().zip(&after).filter(|(before, after)| before != after).count();
        assert_eq!((before.len(), different), (after.len(), 1), "{path} by {line}: {after:?}");
    }
}

/// The shapers by the names that Klipper and M593 P give them: a new one does not compile before it has one.
const fn name(kind: ShaperKind) -> &'static str {
    match kind {
        ShaperKind::None => "none",
        ShaperKind::Zv => "zv",
        ShaperKind::Zvd => "zvd",
        ShaperKind::Mzv => "mzv",
        ShaperKind::Ei => "ei",
        ShaperKind::TwoHumpEi => "2hump_ei",
    }
}

#[test]
fn every_shaper_is_known_to_the_machine_file_to_m593_and_to_its_texts() {
    for kind in ShaperKind::all() {
        let name = name(kind);
        let settings = machine_file::load(&format!("[shaper.x]\nkind = \"{name}\"")).unwrap();
        assert_eq!(settings.shapers.x.kind, kind, "ShaperKind in src/settings/shaping.rs");
        let by_name = settings_as_said(&Settings::prototype(), &[&format!("M593 X P\"{name}\" F50")]);
        if kind == ShaperKind::None {
            continue;
        }
        let by_file = settings_as_said(&settings, &["M593 X F50"]);
        assert_eq!(by_name, by_file, "{name} in NAMES of the file of M593");
        let (mut host, drivers) = (Lines::new(vec!["M593 T99".to_owned()]), Drivers::new());
        run_on(&Settings::prototype(), None, NoStorage, &drivers, &mut [&mut host], &mut Deaf).unwrap();
        let text = format!(" ({})", name.to_uppercase());
        let told = host.heard.iter().find_map(|line| line.split_once(&text)).map(|(before, _)| before);
        let number =
            told.and_then(|before| before.chars().last()).unwrap_or_else(|| panic!("{text}: {:?}", host.heard));
        let by_number = settings_as_said(&Settings::prototype(), &[&format!("M593 X F50 T{number}")]);
        assert_eq!(by_number, by_file, "{name} in SHAPERS of src/machine/numbers.rs");
    }
}

#[test]
fn the_error_of_two_rules_for_corners_has_the_keys_of_all() {
    let keys: Vec<_> = CornerRule::all().map(corner).map(|[_, key, _]| key).collect();
    let lines: String = keys.iter().map(|key| format!("{key} = 0.1\n")).collect();
    let error = machine_file::load(&format!("[corner]\n{lines}")).unwrap_err().to_string();
    for key in keys {
        assert!(error.contains(key), "{key} is missing in machine-file/src/error.rs");
    }
}
