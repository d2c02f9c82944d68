//! Values that were wrong without a word: places of the nozzle, several keys on one of ours, and defaults.

use super::{of_text, verdict};
use corehbot_machine_file::klipper::Kind::{Approximated, Decide, NotNeeded, NotYet, Taken};

/// A machine of two screws and a probe, 44 mm left of the nozzle and 6 mm in front of it.
const LEVELLED: &str = "[printer]\nkinematics: cartesian\n\
    [stepper_x]\nposition_max: 235\n[stepper_y]\nposition_max: 235\n\
    [stepper_z]\nendstop_pin: probe:z_virtual_endstop\nposition_max: 250\n\
    [bltouch]\nsensor_pin: ^PB7\ncontrol_pin: PB6\nx_offset: -44\ny_offset: -6\nz_offset: 2.1\n";

/// Klipper's reference says of each key whose place it is.
#[test]
fn places_of_the_nozzle_become_places_of_the_probe() {
    let text = format!(
        "{LEVELLED}[safe_z_home]\nhome_xy_position: 117,117\n\
         [z_tilt]\nz_positions: -10,117\n  245,117\npoints: 60,117\n  190,117\n\
         [bed_mesh]\nmesh_min: 10,10\nmesh_max: 190,220\n"
    );
    let done = of_text(&text);
    for line in [
        "[probe.home]\nx = 73  # ",
        "\ny = 111  # ",
        "[screws.1]\nx = -10  # ",
        "\npoint_x = 16  # ",
        "[screws.2]\nx = 245  # ",
        "\npoint_x = 146  # ",
        "\npoint_y = 111  # ",
    ] {
        assert!(done.text.contains(line), "{line}: {}", done.text);
    }
    let (kind, said) = verdict(&done.report, "safe_z_home", "home_xy_position");
    assert!(kind == Taken && said.contains("-44 from the nozzle's 117"), "{said}");
}

#[test]
fn places_out_of_reach_are_told() {
    for (place, who) in [("300,117", "the nozzle would be at x 300"), ("20,117", "the probe would be at x -24")] {
        let done = of_text(&format!("{LEVELLED}[safe_z_home]\nhome_xy_position: {place}\n"));
        let (kind, said) = verdict(&done.report, "safe_z_home", "home_xy_position");
        assert!(kind == Decide && said.contains(who), "{said}");
    }
}

/// A switch that homes Z has its place and its hop, and the place of the probe stays as it is.
#[test]
fn a_switch_homes_z_at_its_place() {
    let text = "[printer]\nkinematics: cartesian\n[stepper_x]\nposition_max: 300\n[stepper_y]\nposition_max: 360\n\
                [stepper_z]\nendstop_pin: PG10\n[safe_z_home]\nhome_xy_position: 206,350.5\nz_hop: 10\n\
                z_hop_speed: 12\nspeed: 80\nmove_to_previous: True\n";
    let done = of_text(text);
    for line in ["x = 206  # ", "y = 350.5  # ", "z_hop = 10  # ", "z_hop_speed = 12  # ", "speed = 80  # "] {
        assert!(done.text.contains(&format!("\n{line}")), "{line}: {}", done.text);
    }
    assert!(done.text.contains("move_to_previous = true  # "), "{}", done.text);
    for key in ["home_xy_position", "z_hop", "z_hop_speed", "speed", "move_to_previous"] {
        assert_eq!(verdict(&done.report, "safe_z_home", key).0, Taken, "{key}");
    }
    assert!(!done.text.contains("[probe.home]"), "it is the zero of the mesh too: {}", done.text);
    let far = of_text(&text.replace("206,", "306,"));
    let (kind, said) = verdict(&far.report, "safe_z_home", "home_xy_position");
    assert!(kind == Decide && said.contains("the nozzle would be at x 306, and reaches from 0 to 300"), "{said}");
}

/// With a probe the hop and the way back count as well; its speed is another key.
#[test]
fn the_hop_of_a_probe_is_taken() {
    let text =
        format!("{LEVELLED}[safe_z_home]\nhome_xy_position: 117,117\nz_hop: 10\nspeed: 80\nmove_to_previous: False\n");
    let done = of_text(&text);
    for (key, wanted) in
        [("home_xy_position", Taken), ("z_hop", Taken), ("speed", NotNeeded), ("move_to_previous", Taken)]
    {
        assert_eq!(verdict(&done.report, "safe_z_home", key).0, wanted, "{key}");
    }
    assert!(done.text.contains("\nz_hop = 10  # "), "{}", done.text);
}

#[test]
fn what_goes_on_before_and_around_homing_is_to_be_decided() {
    let text = "[stepper_z]\nendstop_pin: PG10\n\
                [homing_override]\naxes: z\nset_position_z: 5\ngcode:\n  G28 X Y\n";
    let done = of_text(text);
    for (section, key, told) in
        [("homing_override", "gcode", "homes z"), ("homing_override", "set_position_z", "takes z for 5")]
    {
        let (kind, said) = verdict(&done.report, section, key);
        assert!(kind == Decide && said.contains(told), "[{section}] {key}: {kind:?} {said}");
    }
}

#[test]
fn several_keys_of_fans_are_each_told() {
    let text = "[heater_fan hotend]\npin: !PE5\nmax_power: 0.5\nfan_speed: 0.8\nheater_temp: 45\n\
                [heater_fan bed]\npin: PD12\nheater: heater_bed\nheater_temp: 60\n\
                [controller_fan a]\npin: PD13\nidle_timeout: 15\n[controller_fan b]\npin: PD14\nidle_timeout: 40\n";
    let done = of_text(text);
    for line in [
        "[fans.fan1]\nrole = \"hotend\"  # printer.cfg:2\nmost = 0.4  # printer.cfg:3\n",
        "[fans.fan2]\nrole = \"commanded\"",
        "hotend_fan_above = 45",
        "fan_run_on_s = 15",
    ] {
        assert!(done.text.contains(line), "{line}: {}", done.text);
    }
    for (section, key, kind, told) in [
        ("heater_fan hotend", "pin", Decide, "blows while it is high"),
        ("heater_fan hotend", "max_power", Taken, "fans.fan1.most = 0.4; times fan_speed"),
        ("heater_fan hotend", "fan_speed", Taken, "fans.fan1.most is max_power times it"),
        ("heater_fan bed", "heater_temp", NotYet, "no fan follows this heater"),
        ("controller_fan b", "idle_timeout", Decide, "fan_run_on_s = 15 from printer.cfg:12 already"),
    ] {
        let (found, said) = verdict(&done.report, section, key);
        assert!(found == kind && said.contains(told), "[{section}] {key}: {found:?} {said}");
    }
}

/// A key that one motor has and another one lacks: the other one has Klipper's default.
#[test]
fn a_motor_without_a_key_has_klippers_default() {
    let stepper = |name: &str, own: &str, driver: &str| {
        format!("[stepper_{name}]\nmicrosteps: 16\n{own}\n[tmc2209 stepper_{name}]\nrun_current: 0.8\n{driver}\n")
    };
    let of = |[x, y]: [&str; 2], [z, z1]: [&str; 2]| {
        let motors = [stepper("x", "", x), stepper("y", "", y), stepper("z", z, ""), stepper("z1", z1, "")];
        of_text(&format!("[printer]\nkinematics: cartesian\n{}", motors.concat()))
    };
    let has_note = |done: &corehbot_machine_file::Translation, words: &str| {
        done.report.notes.iter().any(|note| note.kind == Decide && note.text.contains(words))
    };
    for (drivers, lines) in [
        (
            ["hold_current: 0.4", ""],
            ["[drivers.belt]", "hold_percent = 50", "[drivers.y]\nhold_percent = 100  # Klipper"],
        ),
        (
            ["", "hold_current: 0.4"],
            ["[drivers.belt]", "hold_percent = 100  # Klipper", "[drivers.y]\nhold_percent = 50"],
        ),
        (["", "driver_sgthrs: 80"], ["stall_threshold = 0", "[drivers.y]", "\nstall_threshold = 80"]),
    ] {
        let done = of(drivers, ["", ""]);
        for line in lines {
            assert!(done.text.contains(line), "{drivers:?}, {line}: {}", done.text);
        }
    }
    let done = of(["stealthchop_threshold: 999999", ""], ["", ""]);
    assert!(
        done.text.contains("stealth = true") && has_note(&done, "[tmc2209 stepper_y] has no stealthchop_threshold")
    );
    let done = of(["", "stealthchop_threshold: 999999"], ["", ""]);
    assert!(done.text.contains("stealth = false"), "{}", done.text);
    assert_eq!(verdict(&done.report, "tmc2209 stepper_y", "stealthchop_threshold").0, Decide);
    let done = of(["driver_sgthrs: 80", ""], ["", ""]);
    assert!(has_note(&done, "[tmc2209 stepper_y] has no driver_sgthrs, so 0"), "0 of a motor is its group's");
    let done = of(["", ""], ["full_steps_per_rotation: 400", ""]);
    assert!(has_note(&done, "[stepper_z1] has no full_steps_per_rotation") && done.machine.is_none());
    assert!(done.text.contains("full_steps = 0  # to decide"), "{}", done.text);
    let done = of(["", ""], ["", "full_steps_per_rotation: 400"]);
    assert_eq!(verdict(&done.report, "stepper_z1", "full_steps_per_rotation").0, Decide);
    let done = of(["", ""], ["", ""]);
    assert!(!["stealth", "full_steps", "stall_threshold"].iter().any(|leaf| done.text.contains(leaf)), "{}", done.text);
}

/// Of sections that share a key, one without it has Klipper's default, whichever comes first.
#[test]
fn a_section_without_a_shared_key_is_told() {
    let fan = |section: &str, pin: &str, key: &str| format!("[{section}]\npin: {pin}\n{key}\n");
    for (kind, key, usual) in [("heater_fan", "heater_temp: 45", "50"), ("controller_fan", "idle_timeout: 15", "30")] {
        let (with, without) = (fan(&format!("{kind} a"), "PE5", key), fan(&format!("{kind} b"), "PD12", ""));
        for text in [format!("{with}{without}"), format!("{without}{with}")] {
            let done = of_text(&text);
            let told = format!("[{kind} b] has no {}, so {usual}", key.split(':').next().unwrap());
            let is_told =
                |note: &corehbot_machine_file::klipper::Verdict| note.kind == Decide && note.text.contains(&told);
            assert!(done.report.notes.iter().any(is_told), "{text}: {:?}", done.report.notes);
        }
        let alone =
            of_text(&format!("{without}{}", fan("heater_fan bed", "PD13", "heater: heater_bed\nheater_temp: 60")));
        assert!(alone.report.notes.iter().all(|note| !note.text.contains("] has no ")), "{:?}", alone.report.notes);
    }
}

/// A measure beyond its range stays as it is: cut, it would be another machine's.
#[test]
fn measures_are_never_cut() {
    let probe = |key: &str| format!("[probe]\npin: ^PB7\n{key}\n");
    for (text, line, key) in [
        (probe("x_offset: -61"), "x = -61  #", ("probe", "x_offset")),
        (probe("z_offset: 25"), "z = -25  #", ("probe", "z_offset")),
        ("[input_shaper]\nshaper_freq_x: 900\n".to_owned(), "frequency = 900  #", ("input_shaper", "shaper_freq_x")),
        ("[stepper_y]\nposition_max: 90000\n".to_owned(), "length = 90000  #", ("stepper_y", "position_max")),
    ] {
        let done = of_text(&text);
        let (kind, said) = verdict(&done.report, key.0, key.1);
        assert!(kind == Decide && said.contains("its range is"), "{key:?}: {said}");
        assert!(done.text.contains(line) && done.machine.is_none(), "{line}: {}", done.text);
    }
    // The nearest limit is a good one.
    let done = of_text("[printer]\nmax_velocity: 90000\n");
    assert_eq!(verdict(&done.report, "printer", "max_velocity").0, Approximated);
}

/// `off_below` is a part of `max_power` too.
#[test]
fn the_lowest_duty_of_a_fan_is_klippers() {
    let done = |keys: &str| of_text(&format!("[heater_fan a]\npin: PE5\n{keys}\n"));
    for (keys, least) in [
        ("max_power: 0.8\noff_below: 0.1", "least = 0.08  #"),
        ("off_below: 0.1", "least = 0.1  #"),
        ("off_below: 0.9\nmax_power: 0.5", "least = 0.45  #"),
    ] {
        assert!(done(keys).text.contains(least), "{keys}: {}", done(keys).text);
    }
    let done = done("off_below: 0.9\nfan_speed: 0.5");
    assert_eq!(verdict(&done.report, "heater_fan a", "off_below").0, Decide);
    assert!(!done.text.contains("least ="), "{}", done.text);
}

#[test]
fn shapers_have_no_case_and_an_unknown_one_shapes_nothing() {
    let done = of_text("[input_shaper]\nshaper_freq_x: 40\nshaper_type: MZV\n");
    assert!(done.text.contains("kind = \"mzv\""), "{}", done.text);
    assert_eq!(verdict(&done.report, "input_shaper", "shaper_type").0, Taken);
    let done = of_text("[input_shaper]\nshaper_freq_y: 40\nshaper_type_y: smooth_mzv\n");
    assert!(done.text.contains("kind = \"none\"  # to decide"), "{}", done.text);
    assert_eq!(verdict(&done.report, "input_shaper", "shaper_type_y").0, Decide);
}

#[test]
fn keys_of_z_and_of_a_round_mesh_are_not_lost() {
    for missing in ["", "max_velocity: fast\n"] {
        let done = of_text(&format!("[printer]\n{missing}max_z_velocity: 15\nmax_z_accel: 120\n"));
        assert!(done.text.contains("[axes.z]\nmax_speed = 15  #"), "{}", done.text);
        assert!(done.text.contains("max_acceleration = 120  #"), "{}", done.text);
    }
    let done = of_text("[bed_mesh]\nmesh_radius: 75\nround_probe_count: 7\n");
    assert!(done.text.contains("columns = 7  #") && done.text.contains("rows = 7  #"), "{}", done.text);
    assert_eq!(verdict(&done.report, "bed_mesh", "round_probe_count").0, Approximated);
    let done = of_text("[bed_mesh]\nmesh_radius: 75\n");
    assert!(done.text.contains("columns = 5  # Klipper's default"), "{}", done.text);
    // The touches that home Z are the probe's.
    let text = "[stepper_z]\nendstop_pin: probe:z_virtual_endstop\nhoming_speed: 10\n[probe]\npin: ^PB7\nspeed: 4\n";
    let done = of_text(text);
    let (kind, said) = verdict(&done.report, "stepper_z", "homing_speed");
    assert!(kind == Approximated && said.contains("probe.fast is the speed of the probe's touches"), "{said}");
}

/// Klipper's defaults, read in its code (commit 84104bbb), and the lines of our file that they become.
const DEFAULTS: [(&str, &str, &str); 27] = [
    ("klippy/toolhead.py:211", "minimum_cruise_ratio", "0.5"),
    ("klippy/toolhead.py:213", "corner.square_corner", "5"),
    ("klippy/kinematics/cartesian.py:41", "axes.z.max_speed", "300"),
    ("klippy/kinematics/cartesian.py:43", "axes.z.max_acceleration", "3000"),
    ("klippy/kinematics/cartesian.py, _check_endstops", "require_homing", "true"),
    ("klippy/stepper.py:361", "homing.x.fast", "5"),
    ("klippy/stepper.py:362", "homing.x.slow", "2.5"),
    ("klippy/stepper.py:366", "homing.z.back_off", "5"),
    ("klippy/kinematics/extruder.py:14", "advance.time", "0"),
    ("klippy/kinematics/extruder.py:15", "advance.window", "0.04"),
    // 300 mm/s and 3000 mm/s2, by 4 x 0.4^2 / (pi x 1.75^2 / 4) = 0.266081.
    ("klippy/kinematics/extruder.py:162", "axes.e.max_speed", "79.824324"),
    ("klippy/kinematics/extruder.py:165", "axes.e.max_acceleration", "798.243241"),
    ("klippy/kinematics/extruder.py:168", "axes.e.length", "50"),
    ("klippy/kinematics/extruder.py:170", "extruder_jerk", "1"),
    ("klippy/extras/heaters.py:34", "thermal.min_extrude", "170"),
    ("klippy/extras/heater_fan.py:16", "thermal.hotend_fan_above", "50"),
    ("klippy/extras/controller_fan.py:25", "thermal.fan_run_on_s", "30"),
    ("klippy/extras/idle_timeout.py:25", "thermal.idle_min", "10"),
    ("klippy/extras/probe.py:283", "probe.slow", "5"),
    ("klippy/extras/probe.py:283", "probe.fast", "5"),
    ("klippy/extras/probe.py:286", "probe.samples", "1"),
    ("klippy/extras/probe.py:294", "probe.retries", "0"),
    ("klippy/extras/probe.py:292", "probe.tolerance", "0.1"),
    ("klippy/extras/probe.py:436", "probe.clearance", "5"),
    ("klippy/extras/bed_mesh.py, probe_count", "mesh.columns", "3"),
    ("klippy/extras/bed_mesh.py:98", "mesh.fade", "0"),
    ("klippy/extras/input_shaper.py:20", "shaper.x.damping", "0.1"),
];

#[test]
fn what_a_configuration_leaves_out_is_as_in_klipper() {
    let text = "[printer]\nkinematics: cartesian\nmax_velocity: 300\nmax_accel: 3000\n\
                [stepper_x]\n[stepper_y]\n[stepper_z]\n[extruder]\nnozzle_diameter: 0.4\nfilament_diameter: 1.75\n\
                [heater_fan a]\npin: PE5\n[controller_fan b]\npin: PD12\n[probe]\npin: PB7\n[bed_mesh]\n\
                [input_shaper]\nshaper_freq_x: 40\n";
    let done = of_text(text);
    let file: toml::Table = done.text.parse().unwrap();
    for (source, path, wanted) in DEFAULTS {
        let value = path.split('.').try_fold(&toml::Value::Table(file.clone()), |table, key| table.get(key)).cloned();
        let value = value.unwrap_or_else(|| panic!("{path} of {source} is not there: {}", done.text));
        assert!(value.to_string().starts_with(wanted), "{path} of {source}: {value}");
    }
    assert!(done.text.contains("kind = \"mzv\"  # Klipper's default"));
}
