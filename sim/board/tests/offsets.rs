//! Offsets of z and of the probe: each word changes its own store, and a machine stands where they say, in every life.

use crate::common::life::Life;
use crate::common::on_bed::{over, real_z, with_probe};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::bed_plant;
use corehbot_sim::eeprom::Eeprom;

/// Where the probe really is, seen from the nozzle.
const TRUE_Z: f64 = -1.5;

/// A machine that homes z by its probe, which is where it says.
fn homing() -> Settings {
    let mut s = with_probe(Settings::prototype());
    s.probe.homes_z = true;
    (s.probe.offset.x, s.probe.offset.z) = (Mm::from_num(-40), Mm::from_num(TRUE_Z));
    s
}

/// Its bed is flat, at 0.
fn bed() -> BedSetup {
    let mut bed = BedSetup::of(&homing());
    bed.probe.offset = [-40.0, 0.0, TRUE_Z];
    bed
}

fn say(life: &mut Life<'_>, lines: &[&str]) {
    lines.iter().for_each(|line| life.say(line));
}

/// The gap between nozzle and bed where the program calls z 0.2.
fn gap(life: &mut Life<'_>) -> f64 {
    say(life, &["G90", "G1 X100 Y100 Z5 F9000", "G1 Z0.2 F600", "M400"]);
    real_z(life, &homing())
}

#[track_caller]
fn is_near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 0.004, "{found}, expected {expected}");
}

fn answer(life: &mut Life<'_>, line: &str) -> Vec<String> {
    let before = life.heard.len();
    life.say(line);
    life.heard[before..].to_vec()
}

#[track_caller]
fn tells(life: &mut Life<'_>, line: &str, told: &str) {
    let answer = answer(life, line);
    assert!(answer.iter().any(|line| line == told), "{line}: {answer:?}");
}

/// *Reproducer*: the second print began with the nozzle 1.5 mm above the bed.
#[test]
fn klippers_start_of_a_print_leaves_the_probe_its_offset() {
    over(&homing(), &bed(), &mut Eeprom::blank(), |life| {
        for _ in 0..3 {
            say(life, &["BED_MESH_CLEAR", "SET_GCODE_OFFSET Z=0.0", "G28"]);
            is_near(gap(life), 0.2);
            tells(life, "M851", "  M851 X-40 Y0 Z-1.5");
        }
        // The owner has more in it, for a rough plate.
        for _ in 0..2 {
            say(life, &["SET_GCODE_OFFSET Z=0.0", "G28", "SET_GCODE_OFFSET Z=0.1"]);
            is_near(gap(life), 0.3);
            say(life, &["G28 Z"]);
            is_near(gap(life), 0.3);
        }
        say(life, &["SET_GCODE_OFFSET Z_ADJUST=0.05 MOVE=1", "M400"]);
        is_near(real_z(life, &homing()), 0.35);
        let told = answer(life, "SET_GCODE_OFFSET");
        let offsets: Vec<_> =
            told.iter().filter(|line| line.contains("ffset Z") || line.contains("Z offset")).collect();
        assert_eq!(
            offsets,
            ["echo:Probe Offset Z-1.5", "echo:Z offset 0.15, the sum is -1.35, not saved: M500 keeps it"],
            "{told:?}"
        );
    });
}

#[test]
fn m290_corrects_the_probe_that_homes_z_and_survives_the_start_of_a_print() {
    let mut memory = Eeprom::blank();
    over(&homing(), &bed(), &mut memory, |life| {
        say(life, &["G28", "M290 Z0.05", "SET_GCODE_OFFSET Z=0.02"]);
        is_near(gap(life), 0.27);
        tells(life, "M851", "  M851 X-40 Y0 Z-1.45");
        say(life, &["M290 Z0.3 P0"]);
        is_near(gap(life), 0.57);
        say(life, &["G28"]);
        is_near(gap(life), 0.27);
        say(life, &["M500"]);
        tells(life, "M290", "echo:Z offset 0.02, the sum is -1.43");
        tells(life, "M290", "echo:Probe Offset Z-1.45");
    });
    // Off and on.
    over(&homing(), &bed(), &mut memory, |life| {
        say(life, &["G28"]);
        is_near(gap(life), 0.27);
        say(life, &["SET_GCODE_OFFSET Z=0", "G28"]);
        is_near(gap(life), 0.25);
    });
}

/// *Reproducer*: -1.7 and 0.1 were told as a sum of -1.5999999999.
#[test]
fn the_sum_of_both_offsets_has_no_more_decimals_than_they_have() {
    over(&homing(), &bed(), &mut Eeprom::blank(), |life| {
        for (probe, program, sum) in [
            ("-1.7", "0.1", "-1.6"),
            ("-1.45", "0.1", "-1.35"),
            ("-1.5", "-0.0125", "-1.5125"),
            ("-0.3", "0.3", "0"),
            ("-1.7", "0.001", "-1.699"),
        ] {
            say(life, &[&format!("M851 Z{probe}"), &format!("SET_GCODE_OFFSET Z={program}")]);
            let told = format!("echo:Z offset {program}, the sum is {sum}, not saved: M500 keeps it");
            tells(life, "M290", &told);
        }
    });
}

/// *Reproducer*: a replay of `M503 S0` set the probe's offset to that of the program.
#[test]
fn a_replay_of_the_settings_leaves_the_nozzle_where_it_is() {
    let mut memory = Eeprom::blank();
    over(&homing(), &bed(), &mut memory, |life| {
        say(life, &["G28", "M290 Z0.05", "SET_GCODE_OFFSET Z=-0.03"]);
        is_near(gap(life), 0.22);
        let settings = answer(life, "M503 S0");
        let lines: Vec<_> = settings.iter().filter_map(|line| line.strip_prefix("  ")).collect();
        assert!(lines.contains(&"M851 X-40 Y0 Z-1.45") && lines.contains(&"SET_GCODE_OFFSET Z=-0.03"), "{lines:?}");
        for with_store in [false, true, true] {
            // Onto other values, too.
            say(life, if with_store { &["M502", "M500"] } else { &[] });
            say(life, &lines);
            is_near(gap(life), 0.22);
            assert_eq!(answer(life, "M503 S0"), settings);
            say(life, &["M500", "G28"]);
            is_near(gap(life), 0.22);
        }
    });
}

/// Nothing moves, the place of z gets the name that it would have if it were homed again.
#[test]
fn offsets_that_are_set_or_loaded_count_at_once() {
    let s = homing();
    over(&s, &bed(), &mut Eeprom::blank(), |life| {
        say(life, &["G28", "M500"]);
        let bed_at = |life: &mut Life<'_>| {
            let told = answer(life, "G30 X100 Y100");
            told.iter().find_map(|line| line.split("Z:").nth(1).filter(|_| line.starts_with("Bed"))).unwrap().to_owned()
        };
        // Each says how far the nozzle stands from where 0.2 should be.
        for (lines, off) in [
            (&["M851 Z-1.3"][..], 0.2),
            (&["M501"], 0.0),
            (&["M290 Z0.1", "M501"], 0.0),
            (&["M290 Z0.1", "M851 Z-1.7"], -0.2),
            (&["SET_GCODE_OFFSET Z=0.3", "M851 Z-1.45"], 0.35),
            (&["M290 Z0.1 P0", "M501"], 0.1),
            (&["G28", "M502"], 0.0),
            (&["M290 Z-0.05", "M502"], 0.0),
            (&["M851 Z-2.5", "G28", "M851 Z-1.5"], 0.0),
        ] {
            let before = real_z(life, &s);
            let is_shifted = lines.iter().any(|line| line.starts_with("M290")) || lines.contains(&"G28");
            say(life, lines);
            life.say("M400");
            assert!(is_shifted || (real_z(life, &s) - before).abs() < 0.001, "{lines:?}: z moves");
            is_near(gap(life), 0.2 + off);
            // What lasts over homing is what counts.
            let is_lasting = !lines.iter().any(|line| line.ends_with("P0"));
            if is_lasting {
                // The probe finds the bed where the program has its 0, less the program's own offset.
                let bed: f64 = bed_at(life).parse().unwrap();
                assert!(bed.abs() < 0.003, "{lines:?}: {bed}");
                life.say("G28 Z");
                is_near(gap(life), 0.2 + off);
            } else {
                life.say("G28");
            }
        }
    });
}

#[test]
fn touches_do_not_count_the_offset_of_the_program() {
    for offset in [4.5, -4.5, 0.25] {
        let tilted = BedSetup { probe: bed().probe, ..bed_plant::read("tilt.x=0.001", &homing()).unwrap() };
        over(&homing(), &tilted, &mut Eeprom::blank(), |life| {
            let plant = BedPlant::new(&homing(), &tilted);
            let zero = plant.height([195.0, 208.8]);
            say(life, &["G28", &format!("SET_GCODE_OFFSET Z={offset}")]);
            let told = answer(life, "G30 X100 Y100");
            let height = told.iter().find(|line| line.starts_with("Bed X:")).unwrap_or_else(|| panic!("{told:?}"));
            let height: f64 = height.split("Z:").nth(1).unwrap().parse().unwrap();
            is_near(height, plant.height([100.0, 100.0]) - zero);
            // Z is homed again, under the same offset, and the mesh is that of the bed.
            say(life, &["G28", "G29"]);
            let corner = answer(life, "M420 V").into_iter().find(|line| line.starts_with(" 0 ")).unwrap();
            let corner: f64 = corner.split_whitespace().nth(1).unwrap().parse().unwrap();
            is_near(corner, plant.height([10.0, 10.0]) - zero);
            say(life, &["M420 Z0", "G1 X300 Y100 Z6 F9000", "M400"]);
            is_near(real_z(life, &homing()) - plant.height([300.0, 100.0]), 6.0 + offset);
        });
    }
}

/// The mesh's height at a place, by the nozzle that follows it.
fn height_at(life: &mut Life<'_>, x: f64) -> f64 {
    say(life, &["M420 Z0", &format!("G1 X{x} Y200 Z1 F9000"), "M400"]);
    real_z(life, &homing()) - 1.0
}

/// *Reproducer*: after `M851 X` and M500 the next start dropped the mesh, and M500 had said "Settings Stored" alone.
#[test]
fn a_mesh_moves_with_the_probe_and_is_kept() {
    let (s, mut memory) = (homing(), Eeprom::blank());
    let curved = BedSetup { probe: bed().probe, ..bed_plant::read("bowl=0.4,tilt.x=0.002", &s).unwrap() };
    let mut heights = [0.0; 2];
    over(&s, &curved, &mut memory, |life| {
        say(life, &["G28", "G29"]);
        heights = [100.0, 290.0].map(|x| height_at(life, x));
        say(life, &["M500"]);
        tells(life, "M851 X-38.5", "echo:the mesh moves with the probe: X1.5 Y0. After a rebuild send G29");
        let moved = [101.5, 291.5].map(|x| height_at(life, x));
        moved.iter().zip(heights).for_each(|(moved, height)| is_near(*moved, height));
        tells(life, "M500", "echo:Stored mesh moved with the probe: X1.5 Y0");
    });
    over(&s, &curved, &mut memory, |life| {
        tells(life, "M420", "echo:Bed Leveling ON");
        say(life, &["G28"]);
        let moved = [101.5, 291.5].map(|x| height_at(life, x));
        moved.iter().zip(heights).for_each(|(moved, height)| is_near(*moved, height));
        // The kept mesh moves even if another one, or none, is there.
        say(life, &["BED_MESH_CLEAR", "M851 X-40"]);
        tells(life, "M500", "echo:Stored mesh moved with the probe: X-1.5 Y0");
        assert!(answer(life, "M500").iter().all(|line| !line.contains("mesh")));
    });
    over(&s, &curved, &mut memory, |life| {
        say(life, &["G28", "M420 S1"]);
        let back = [100.0, 290.0].map(|x| height_at(life, x));
        back.iter().zip(heights).for_each(|(back, height)| is_near(*back, height));
    });
}

#[test]
fn a_mesh_that_ends_with_other_steps_is_told_by_m500() {
    let (s, mut memory) = (homing(), Eeprom::blank());
    let ends = "echo:Stored mesh ends with the next start: steps or axes are others. Send G29, M500";
    over(&s, &bed(), &mut memory, |life| {
        say(life, &["G28", "G29", "M500"]);
        // Filament makes no height.
        say(life, &["M92 E415"]);
        assert!(answer(life, "M500").iter().all(|line| line != ends));
    });
    // Another place of the probe makes it no mesh of the new steps.
    for (steps, offset) in [("M92 Z801", "M851 X-40"), ("M92 Z802", "M851 X-38.5")] {
        over(&s, &bed(), &mut memory, |life| {
            tells(life, "M420", "echo:Bed Leveling ON");
            tells(life, steps, "ok");
            say(life, &[offset]);
            tells(life, "M500", ends);
            assert!(answer(life, "M500").iter().all(|line| line != ends), "told once");
        });
        over(&s, &bed(), &mut memory, |life| {
            assert_eq!(life.count("echo:No stored mesh: it is of a machine with"), 1, "{:?}", life.heard);
            say(life, &["G28", "G29", "M500"]);
        });
    }
}
