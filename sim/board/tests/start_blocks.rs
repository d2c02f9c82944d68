//! Start blocks as slicers write them for four kinds of printers. The first layer follows the bed in the first print
//! and in the next one. It does so after a cancelled measurement, and after a restart with the kept mesh.

use crate::common::heated::heated;
use crate::common::life::Life;
use crate::common::on_bed::{SCREWS, over, real_z, with_probe};
use corehbot::settings::Settings;
use corehbot_rig::bed::{BedPlant, BedSetup};
use corehbot_sim::bed_plant;
use corehbot_sim::eeprom::Eeprom;

/// Measured before each print: Marlin's usual form, as most vendors have it.
const MARLIN: &str = "M201 X3000 Y3000\nM140 S60\nM104 S160\nG90\nM82\nG28 ; home all axes\nG29 ; auto bed levelling\n\
                      M420 S1 ; use it\nM190 S60\nM109 S200\nG92 E0\nG1 Z2.0 F3000\nG1 X10 Y20 Z0.3 F5000\n\
                      G1 X10 Y200 E15 F1500\nG92 E0\nG1 E-1 F1800\n";

/// An area, its own measurement in phases, and the nozzle cleaned before.
const PRUSA: &str = "M17\nM862.3 P \"MK4\"\nM555 X140 Y170 W100 H55\nG90\nM83\nM140 S60\nM104 S170\nG28\n\
                     G29 P9 X140 Y160 W32 H7\nG29 P1\nG29 P1 X140 Y170 W100 H55 C\nG29 P3.2\nG29 P3.13\nG29 A\n\
                     M190 S60\nM109 S200\nG92 E0\nG1 E1 F300\n";

/// An older one: homing without a mesh, then all of it.
const PRUSA_OLD: &str = "M115 U3.13.3\nG90\nM83\nM104 S160\nM140 S60\nG28 W\nG80 ; mesh bed leveling\n\
                         M190 S60\nM109 S200\nG1 Y20 F1000\nG92 E0\nG1 E1 F300\n";

/// Objects, and a mesh around them.
const KLIPPER: &str = "EXCLUDE_OBJECT_DEFINE NAME=cube_id_0_copy_0 CENTER=190,197.5 \
                       POLYGON=[[150,180],[230,180],[230,215],[150,215],[150,180]]\n\
                       M140 S60\nM104 S150\nG28\nBED_MESH_CLEAR\nBED_MESH_CALIBRATE ADAPTIVE=1 ADAPTIVE_MARGIN=10\n\
                       M190 S60\nM109 S200\nG90\nM83\nSET_VELOCITY_LIMIT ACCEL=2000\n\
                       EXCLUDE_OBJECT_START NAME=cube_id_0_copy_0\n";

/// The mesh that was kept once, switched on with a fade height.
const KEPT: &str = "M220 S100\nM221 S100\nM140 S60\nM104 S200\nG28\nM420 S1 Z10\nM190 S60\nM109 S200\nG92 E0\n\
                    G1 Z2.0 F3000\nG1 X10 Y20 Z0.28 F5000\nG1 X10 Y200 E15 F1500\nG92 E0\n";

/// Every block: its name, its lines, and whether it measures.
const BLOCKS: [(&str, &str, bool); 5] = [
    ("Marlin", MARLIN, true),
    ("Prusa", PRUSA, true),
    ("Prusa with G80", PRUSA_OLD, true),
    ("Klipper", KLIPPER, true),
    ("kept", KEPT, false),
];

/// The corners of the object, and its middle.
const LAYER: [[f64; 2]; 5] = [[150.0, 180.0], [230.0, 180.0], [230.0, 215.0], [150.0, 215.0], [190.0, 200.0]];

const END: &str = "G91\nG1 Z5 F600\nG90\nM107\nM104 S0\nM140 S0\nG1 X0 Y300 F3000\nM84 X Y E\n";

/// Where z is homed and the mesh is 0.
const REFERENCE: [f64; 2] = [195.0, 208.8];

fn machine() -> (Settings, BedSetup) {
    let mut s = with_probe(heated());
    // A parabola is exact in the inner cells.
    (s.mesh.columns, s.mesh.rows) = (4, 4);
    let bed = bed_plant::read("tilt.x=0.0004,tilt.y=-0.0003,bowl=0.12", &s).unwrap();
    (s, bed)
}

/// Prints a file: its block, a layer with z at the bed wherever the nozzle stops, and its end.
fn print(life: &mut Life<'_>, s: &Settings, bed: &BedSetup, block: &str) {
    for line in block.lines() {
        life.say(line);
    }
    let plant = BedPlant::new(s, bed);
    life.say("G91\nG90\nM83");
    (0..2).for_each(|_| life.await_ok());
    for [x, y] in LAYER {
        life.say(&format!("G1 X{x} Y{y} Z0.2 E0.5 F9000"));
        life.say("M400");
        let off = real_z(life, s) - 0.2 - (plant.height([x, y]) - plant.height(REFERENCE));
        // What the points of the mesh and its fade leave of this bed, and two steps.
        assert!(off.abs() < 0.0081 + 0.0025, "{x} {y}: {off}\n{block}{:#?}", life.heard);
    }
    for line in END.lines() {
        life.say(line);
    }
    let [left, right] = SCREWS.map(|screw| life.counts()[screw]);
    assert_eq!(left, right, "the screws turn together");
}

/// No word was out of place: the job went on, and hosts stayed connected.
fn is_sound(life: &Life<'_>, name: &str) {
    for begin in ["Error", "!!", "//action:cancel", "//action:pause", "echo:ignored", "echo:print ended"] {
        assert_eq!(life.count(begin), 0, "{name}: {:#?}", life.heard);
    }
}

#[test]
fn every_start_block_prints_on_its_mesh_twice_on_one_printer() {
    let (s, bed) = machine();
    for (name, block, measures) in BLOCKS {
        over(&s, &bed, &mut Eeprom::blank(), |life| {
            if !measures {
                life.say("G29");
            }
            for _ in 0..2 {
                print(life, &s, &bed, block);
            }
            is_sound(life, name);
        });
    }
}

#[test]
fn a_measurement_that_was_cancelled_leaves_a_printer_that_prints() {
    let (s, bed) = machine();
    for (name, block, _) in BLOCKS.iter().filter(|(_, _, measures)| *measures) {
        over(&s, &bed, &mut Eeprom::blank(), |life| {
            for line in block.lines() {
                let measures = ["G29 P1", "G80", "BED_MESH_CALIBRATE"].iter().any(|code| line.starts_with(code));
                if measures || line.starts_with("G29 ;") {
                    // In the middle of it.
                    life.put(0, line);
                    life.rest(30_000);
                    life.put(0, "M524");
                    (0..2).for_each(|_| life.await_ok());
                    break;
                }
                life.say(line);
            }
            assert_eq!(life.targets(), [0.0, 0.0], "{name}");
            let stopped = life.counts();
            life.rest(5000);
            assert_eq!(life.counts(), stopped, "{name}");
            life.heard.clear();
            print(life, &s, &bed, block);
            is_sound(life, name);
        });
    }
}

#[test]
fn every_start_block_prints_on_the_kept_mesh_after_a_restart() {
    let (s, bed) = machine();
    for (name, block, _) in BLOCKS {
        let mut memory = Eeprom::blank();
        over(&s, &bed, &mut memory, |life| {
            life.say("G29");
            life.say("M500");
            assert_eq!(life.count("echo:Mesh stored"), 1, "{name}: {:?}", life.heard);
        });
        over(&s, &bed, &mut memory, |life| {
            print(life, &s, &bed, block);
            is_sound(life, name);
        });
    }
}
