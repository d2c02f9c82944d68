//! The expected value of every key of the machine file, by the laws of Klipper's documentation and of docs/reference.

use super::reader::Read;
use std::collections::BTreeMap;
use toml::Value as Toml;

/// Keys and their values.
struct Keys(BTreeMap<String, Toml>);

impl Keys {
    fn put(&mut self, path: &str, value: impl Into<Toml>) {
        self.0.insert(path.to_owned(), value.into());
    }

    /// A whole number of ours.
    fn whole(&mut self, path: &str, number: f64) {
        self.put(path, number.round() as i64);
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// All keys.
pub(super) fn expected(read: &Read) -> BTreeMap<String, Toml> {
    let mut keys = Keys(BTreeMap::new());
    keys.put("board", "octopus");
    motors(read, &mut keys);
    limits(read, &mut keys);
    for axis in AXES {
        of_axis(read, &mut keys, axis);
    }
    extruder(read, &mut keys);
    heaters(read, &mut keys);
    fans(read, &mut keys);
    probe(read, &mut keys);
    bed(read, &mut keys);
    shapers(read, &mut keys);
    others(read, &mut keys);
    keys.0
}

fn row(row: &[i64]) -> Toml {
    Toml::Array(row.iter().map(|times| (*times).into()).collect())
}

fn motors(read: &Read, keys: &mut Keys) {
    let is_core = read.text("printer", "kinematics") == Some("corexy");
    let names = ["x", "y", "z", "z1", "e0"];
    keys.put("motors.names", Toml::Array(names.map(Toml::from).to_vec()));
    // A CoreXY's motors turn by x + y and x - y.
    keys.put("mechanism.x", row(if is_core { &[1, 1, 0] } else { &[1, 0, 0] }));
    keys.put("mechanism.y", row(if is_core { &[1, -1, 0] } else { &[0, 1, 0] }));
    keys.put("mechanism.z", row(&[0, 0, 1]));
    keys.put("mechanism.z1", row(&[0, 0, 1]));
    keys.put("mechanism.e0", row(&[0, 0, 0, 1]));
    // The Octopus prints M0 to M4 at these step pins.
    let sockets = [("PF13", "M0"), ("PG0", "M1"), ("PF11", "M2"), ("PG4", "M3"), ("PF9", "M4")];
    for (section, name) in ["stepper_x", "stepper_y", "stepper_z", "stepper_z1", "extruder"].into_iter().zip(names) {
        let step = read.text(section, "step_pin").unwrap();
        let socket = sockets.iter().find(|(pin, _)| *pin == step).unwrap().1;
        let sign = if read.text(section, "dir_pin").unwrap().starts_with('!') { "!" } else { "" };
        keys.put(&format!("motors.{name}"), format!("{sign}{socket}"));
    }
    for (section, group) in
        [("stepper_x", "belt"), ("stepper_y", "belt"), ("stepper_z", "z"), ("stepper_z1", "z"), ("extruder", "e")]
    {
        let (driver, key) = (format!("tmc2209 {section}"), |leaf: &str| format!("drivers.{group}.{leaf}"));
        keys.whole(&key("microsteps"), read.number(section, "microsteps").unwrap());
        let run = read.number(&driver, "run_current").unwrap();
        keys.whole(&key("current_ma"), run * 1000.0);
    }
    for (group, sections) in
        [("belt", &["stepper_x", "stepper_y"][..]), ("z", &["stepper_z", "stepper_z1"]), ("e", &["extruder"])]
    {
        let key = |leaf: &str| format!("drivers.{group}.{leaf}");
        let of = |section: &str, key: &str| read.number(&format!("tmc2209 {section}"), key);
        // The first motor has the group's value, and the second one its own.
        let mut whole = |leaf: &str, values: &[f64]| {
            keys.whole(&key(leaf), values[0]);
            if let Some(second) = values.get(1).filter(|second| **second != values[0] && **second > 0.0) {
                let name = sections[1].trim_start_matches("stepper_");
                keys.whole(&format!("drivers.{name}.{leaf}"), *second);
            }
        };
        // Klipper holds with the running current.
        let hold = |section: &&str| {
            let run = of(section, "run_current").unwrap();
            (100.0 * of(section, "hold_current").unwrap_or(run) / run).round()
        };
        whole("hold_percent", &sections.iter().map(hold).collect::<Vec<_>>());
        let stall = |section: &&str| of(section, "driver_SGTHRS").unwrap_or(0.0);
        if sections.iter().any(|section| of(section, "driver_SGTHRS").is_some()) {
            whole("stall_threshold", &sections.iter().map(stall).collect::<Vec<_>>());
        }
        // Of the mode a motor has none of its own, so the first one's counts.
        let thresholds: Vec<_> = sections.iter().map(|section| of(section, "stealthchop_threshold")).collect();
        if let Some(first) = thresholds.iter().flatten().next() {
            keys.put(&key("stealth"), thresholds[0].is_some());
            keys.put(&key("hybrid_threshold"), *first);
        }
    }
    // A group has one value; the first driver says it, and without a word it is on.
    for (section, group) in [("stepper_x", "belt"), ("stepper_z", "z"), ("extruder", "e")] {
        let is_off = read.text(&format!("tmc2209 {section}"), "interpolate") == Some("False");
        keys.put(&format!("drivers.{group}.interpolate"), !is_off);
    }
    for key in ["drivers.z.hybrid_threshold", "drivers.belt.hybrid_threshold", "drivers.e.hybrid_threshold"] {
        if let Some(threshold) = keys.0.get(key).and_then(|value| value.as_float()) {
            keys.put(key, threshold);
        }
    }
}

fn limits(read: &Read, keys: &mut Keys) {
    let of = |key: &str| read.number("printer", key).unwrap();
    let (speed, acceleration) = (of("max_velocity"), of("max_accel"));
    for axis in ["x", "y"] {
        keys.put(&format!("axes.{axis}.max_speed"), speed);
        keys.put(&format!("axes.{axis}.max_acceleration"), acceleration);
    }
    // A belt motor in a diagonal: the root of 2, rounded up.
    keys.put("motor_max_speed", speed * 1.4143);
    keys.put("motor_max_acceleration", acceleration * 1.4143);
    keys.put("print_acceleration", acceleration);
    keys.put("travel_acceleration", acceleration);
    keys.put("axes.z.max_speed", read.or("printer", "max_z_velocity", speed));
    keys.put("axes.z.max_acceleration", read.or("printer", "max_z_accel", acceleration));
    keys.put("corner.square_corner", read.or("printer", "square_corner_velocity", 5.0));
    keys.put("minimum_cruise_ratio", read.or("printer", "minimum_cruise_ratio", 0.5));
    keys.put("require_homing", true);
}

fn of_axis(read: &Read, keys: &mut Keys, axis: &str) {
    let section = format!("stepper_{axis}");
    let of = |key: &str| read.number(&section, key);
    keys.put(&format!("axes.{axis}.rotation_distance"), of("rotation_distance").unwrap());
    let (least, most) = (of("position_min").unwrap_or(0.0), of("position_max").unwrap());
    if of("position_min").is_some() {
        keys.put(&format!("axes.{axis}.min"), least);
    }
    keys.put(&format!("axes.{axis}.length"), most - least);
    if least < 0.0 && axis != "z" {
        let (from, size) = if axis == "x" { ("left", "width") } else { ("front", "depth") };
        keys.put(&format!("bed.{from}"), 0);
        keys.put(&format!("bed.{size}"), most);
    }
    let key = |leaf: &str| format!("homing.{axis}.{leaf}");
    let fast = of("homing_speed").unwrap_or(5.0);
    keys.put(&key("fast"), fast);
    keys.put(&key("slow"), of("second_homing_speed").unwrap_or(fast / 2.0));
    keys.put(&key("back_off"), of("homing_retract_dist").unwrap_or(5.0));
    match of("position_endstop") {
        Some(place) => {
            keys.put(&key("end"), if place > (least + most) / 2.0 { "max" } else { "min" });
            keys.put(&key("position"), place);
        }
        None => keys.put(&key("end"), "min"),
    }
    let pin = read.text(&section, "endstop_pin").unwrap();
    if pin.starts_with("probe:") {
        keys.put(&format!("endstops.{axis}"), "");
        keys.put("probe.z_home", true);
    } else {
        let header = match pin.trim_start_matches(['^', '!']) {
            "PG6" => "X-STOP",
            "PG9" => "Y-STOP",
            _ => "Z-STOP",
        };
        keys.put(&format!("endstops.{axis}"), contact(pin, header));
    }
}

/// A switch to ground under a pull-up reads low while it is closed; Klipper's `!` means that it triggers there.
fn contact(pin: &str, header: &str) -> String {
    format!("{}{header}", if pin.contains('!') { "!" } else { "" })
}

fn extruder(read: &Read, keys: &mut Keys) {
    let of = |key: &str| read.number("extruder", key);
    let gears = match read.text("extruder", "gear_ratio") {
        Some("50:10") => 5.0,
        Some("80:20, 2:1") => 8.0,
        Some("7.5:1") => 7.5,
        _ => 1.0,
    };
    keys.put("axes.e.rotation_distance", of("rotation_distance").unwrap() / gears);
    if let Some(steps) = of("full_steps_per_rotation") {
        keys.whole("axes.e.full_steps", steps);
    }
    // Four squares of the nozzle over the area of the filament.
    let ratio = 4.0 * 0.4 * 0.4 / (std::f64::consts::PI * 0.875 * 0.875);
    let printer = |key: &str| read.number("printer", key).unwrap();
    keys.put("axes.e.max_speed", of("max_extrude_only_velocity").unwrap_or(printer("max_velocity") * ratio));
    let acceleration = of("max_extrude_only_accel").unwrap_or(printer("max_accel") * ratio);
    keys.put("axes.e.max_acceleration", acceleration);
    keys.put("retract_acceleration", acceleration);
    for (key, path, default) in [
        ("min_extrude_temp", "thermal.min_extrude", 170.0),
        ("pressure_advance", "advance.time", 0.0),
        ("pressure_advance_smooth_time", "advance.window", 0.04),
        ("max_extrude_only_distance", "axes.e.length", 50.0),
        ("instantaneous_corner_velocity", "extruder_jerk", 1.0),
    ] {
        keys.put(path, of(key).unwrap_or(default));
    }
}

/// A sensor by Klipper's name: a sheet of ours with the same points, three points, or Ohm and B.
fn thermistor(read: &Read, name: &str) -> Toml {
    let points = |points: [[f64; 2]; 3]| {
        let pair = |[celsius, ohms]: [f64; 2]| {
            let whole = |number: f64| if number.fract() == 0.0 { Toml::Integer(number as i64) } else { number.into() };
            Toml::Array(vec![whole(celsius), whole(ohms)])
        };
        Toml::Table([("points".to_owned(), Toml::Array(points.map(pair).to_vec()))].into_iter().collect())
    };
    let beta = |beta: i64| {
        Toml::Table([("ohms".to_owned(), 100_000.into()), ("beta".to_owned(), beta.into())].into_iter().collect())
    };
    match name {
        "ATC Semitec 104GT-2" => "104gt2".into(),
        "ATC Semitec 104NT-4-R025H42G" => "104nt4".into(),
        "Generic 3950" => "ntc_3950".into(),
        "SliceEngineering 450" => "slice_450".into(),
        "PT1000" => "pt1000".into(),
        "EPCOS 100K B57560G104F" => points([[25.0, 100_000.0], [150.0, 1641.9], [250.0, 226.15]]),
        "Honeywell 100K 135-104LAG-J01" => beta(3974),
        _ if read.number("thermistor own", "beta").is_some() => beta(4036),
        _ => points([[25.0, 100_000.0], [150.0, 1700.0], [250.0, 235.0]]),
    }
}

fn heaters(read: &Read, keys: &mut Keys) {
    for (section, name, output, sensor) in
        [("extruder", "hotend", "he0", "hotend0"), ("heater_bed", "bed", "bed", "bed")]
    {
        let key = |leaf: &str| format!("heaters.{name}.{leaf}");
        keys.put(&key("output"), output);
        keys.put(&key("sensor"), sensor);
        keys.put(&key("thermistor"), thermistor(read, read.text(section, "sensor_type").unwrap()));
        keys.put(&key("is_fitted"), true);
        keys.put(&key("most"), read.number(section, "max_temp").unwrap());
        if let Some(duty) = read.number(section, "max_power") {
            keys.put(&key("max_duty"), duty);
        }
        if read.text(section, "control") == Some("pid") {
            keys.put(&key("control"), "pid");
            for (from, to) in [("pid_Kp", "p"), ("pid_Ki", "i"), ("pid_Kd", "d")] {
                keys.put(&key(&format!("pid.{to}")), read.number(section, from).unwrap());
            }
        }
    }
}

fn fans(read: &Read, keys: &mut Keys) {
    for number in 0..6 {
        keys.put(&format!("fans.fan{number}.role"), "commanded");
    }
    for (section, fan, role) in [
        ("fan", 0, "part"),
        ("heater_fan hotend", 1, "hotend"),
        // Nothing here follows a bed.
        ("heater_fan bed", 2, "commanded"),
        ("controller_fan board", 3, "controller"),
        ("fan_generic lid", 4, "commanded"),
    ] {
        if !read.has(section) {
            continue;
        }
        let key = |leaf: &str| format!("fans.fan{fan}.{leaf}");
        keys.put(&key("role"), role);
        let (power, speed) = (read.number(section, "max_power"), read.number(section, "fan_speed"));
        if power.or(speed).is_some() {
            keys.put(&key("most"), power.unwrap_or(1.0) * speed.unwrap_or(1.0));
        }
        if let Some(seconds) = read.number(section, "kick_start_time") {
            keys.whole(&key("kick_ms"), seconds * 1000.0);
        }
        if let Some(least) = read.number(section, "off_below") {
            // A part of the greatest power.
            keys.put(&key("least"), least * power.unwrap_or(1.0));
        }
    }
    // The bed's fan has a temperature of its own, which counts nowhere.
    if read.has("heater_fan hotend") || read.has("heater_fan bed") {
        keys.put("thermal.hotend_fan_above", read.or("heater_fan hotend", "heater_temp", 50.0));
    }
    if read.has("controller_fan board") {
        keys.whole("thermal.fan_run_on_s", read.or("controller_fan board", "idle_timeout", 30.0));
    }
}

/// The section of the probe.
fn probe_of(read: &Read) -> Option<&'static str> {
    ["bltouch", "probe"].into_iter().find(|section| read.has(section))
}

fn probe(read: &Read, keys: &mut Keys) {
    let Some(section) = probe_of(read) else { return };
    let plug = match read.text(section, if section == "bltouch" { "sensor_pin" } else { "pin" }) {
        Some("^PB7") => "BLTOUCH",
        Some("~!PB7") => "PROBE",
        Some("^PG15") => "E3DET",
        _ => "!E3DET",
    };
    keys.put("endstops.probe", plug);
    keys.put("probe.kind", if section == "bltouch" { "bltouch" } else { "switch" });
    let of = |key: &str| read.number(section, key);
    for axis in ["x", "y"] {
        if let Some(offset) = of(&format!("{axis}_offset")) {
            keys.put(&format!("probe.offset.{axis}"), offset);
        }
    }
    // The nozzle is that high when the probe touches.
    keys.put("probe.offset.z", -of("z_offset").unwrap());
    let speed = of("speed").unwrap_or(5.0);
    keys.put("probe.fast", speed);
    keys.put("probe.slow", speed);
    keys.whole("probe.samples", of("samples").unwrap_or(1.0));
    keys.put("probe.tolerance", of("samples_tolerance").unwrap_or(0.1));
    keys.whole("probe.retries", of("samples_tolerance_retries").unwrap_or(0.0));
    // From place to place it goes at the greatest of Klipper's heights.
    let mut most = of("sample_retract_dist").unwrap_or(2.0);
    for section in ["bed_mesh", "z_tilt"].into_iter().filter(|section| read.has(section)) {
        most = most.max(read.or(section, "horizontal_move_z", 5.0));
    }
    keys.put("probe.clearance", most);
}

fn bed(read: &Read, keys: &mut Keys) {
    let section = probe_of(read);
    let offset = |axis: &str| section.map_or(0.0, |section| read.or(section, &format!("{axis}_offset"), 0.0));
    // The nozzle is at home_xy_position, so the probe is beside it. A switch is met there.
    if let Some([x, y]) = read.pairs("safe_z_home", "home_xy_position").first() {
        let homes = if section.is_some() { "probe.home" } else { "safe_z_home" };
        keys.put(&format!("{homes}.x"), x + offset("x"));
        keys.put(&format!("{homes}.y"), y + offset("y"));
    }
    for key in ["z_hop", "z_hop_speed", "speed"] {
        let number = read.number("safe_z_home", key).filter(|_| key != "speed" || section.is_none());
        number.into_iter().for_each(|number| keys.put(&format!("safe_z_home.{key}"), number));
    }
    if let Some(text) = read.text("safe_z_home", "move_to_previous") {
        keys.put("safe_z_home.move_to_previous", text == "True");
    }
    if read.has("bed_mesh") {
        let (columns, rows) = match read.text("bed_mesh", "probe_count") {
            Some("5, 7") => (5, 7),
            Some("4") => (4, 4),
            Some("9,5") => (9, 5),
            _ => (3, 3),
        };
        keys.put("mesh.columns", columns);
        keys.put("mesh.rows", rows);
        keys.put("mesh.fade", read.or("bed_mesh", "fade_end", 0.0));
    }
    for (key, [x, y], is_nozzles) in [("z_positions", ["x", "y"], false), ("points", ["point_x", "point_y"], true)] {
        for (number, [at_x, at_y]) in (1..).zip(read.pairs("z_tilt", key)) {
            let [more_x, more_y] = if is_nozzles { [offset("x"), offset("y")] } else { [0.0, 0.0] };
            keys.whole(&format!("screws.{number}.{x}"), at_x + more_x);
            keys.whole(&format!("screws.{number}.{y}"), at_y + more_y);
        }
    }
}

fn shapers(read: &Read, keys: &mut Keys) {
    const SECTION: &str = "input_shaper";
    if !read.has(SECTION) {
        return;
    }
    for axis in ["x", "y"] {
        let key = |leaf: &str| format!("shaper.{axis}.{leaf}");
        let of = |key: &str| read.text(SECTION, &format!("{key}_{axis}"));
        keys.put(&key("damping"), 0.1);
        if let Some(frequency) = of("shaper_freq") {
            keys.put(&key("frequency"), frequency.parse::<f64>().unwrap());
            let kind = of("shaper_type").or_else(|| read.text(SECTION, "shaper_type")).unwrap_or("mzv");
            keys.put(&key("kind"), kind);
            if let Some(damping) = of("damping_ratio") {
                keys.put(&key("damping"), damping.parse::<f64>().unwrap());
            }
        }
    }
}

fn others(read: &Read, keys: &mut Keys) {
    keys.whole("thermal.idle_min", read.or("idle_timeout", "timeout", 600.0) / 60.0);
    if let Some(pin) = read.text("filament_switch_sensor spool", "switch_pin") {
        let header = if pin.contains("PG12") { "E0DET" } else { "E1DET" };
        keys.put("endstops.filament", contact(pin, header));
    }
    if read.has("temperature_sensor chamber") {
        keys.put("sensors.chamber.sensor", "hotend2");
        keys.put("sensors.chamber.thermistor", "ntc_3950");
        keys.put("sensors.chamber.is_fitted", true);
    }
}
