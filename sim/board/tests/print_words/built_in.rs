//! START_PRINT and END_PRINT without a text of the owner.

use super::{MINUTE, heated, is_sound, live, place};
use crate::common::life::{Life, live_at};
use corehbot::settings::Settings;

/// A file as OrcaSlicer writes it for a printer with Klipper, without most of its comments.
const FILE: &str = "; HEADER_BLOCK_START\nEXCLUDE_OBJECT_DEFINE NAME=cube_id_0_copy_0 CENTER=150,150 \
    POLYGON=[[140,140],[160,140],[160,160],[140,160],[140,140]]\nM73 P0 R12\n\
    START_PRINT EXTRUDER_TEMP=200 BED_TEMP=40 TOTAL_LAYER_COUNT=2 MATERIAL=PLA\nG90\nG21\nM83\n\
    SET_PRINT_STATS_INFO TOTAL_LAYER=2\nG1 E-.8 F2100\n_ON_LAYER_CHANGE LAYER=1\nG1 Z.2 F720\n\
    EXCLUDE_OBJECT_START NAME=cube_id_0_copy_0\nSET_VELOCITY_LIMIT ACCEL=2000\nG1 X140 Y140 F12000\nG1 E.8 F2100\n\
    G1 X160 E1 F3000\nG1 Y160 E1\nG1 X140 E1\nG1 Y140 E1\nTIMELAPSE_TAKE_FRAME\n_ON_LAYER_CHANGE LAYER=2\n\
    SET_PRINT_STATS_INFO CURRENT_LAYER=2\nG1 Z.4 F720\nM106 S128\nG1 X160 E1 F3000\nG1 Y160 E1\nG1 X140 E1\n\
    TIMELAPSE_TAKE_FRAME\nEXCLUDE_OBJECT_END NAME=cube_id_0_copy_0\nM107\nG1 E-.8 F2100\nEND_PRINT\nM73 P100 R0\n";

/// Sends a file line by line.
fn send(life: &mut Life<'_>, file: &str) {
    for line in file.lines().filter(|line| !line.starts_with(';')) {
        life.say(line);
    }
}

/// *Reproducer*: START_PRINT was unknown, so nothing was homed or warm, and END_PRINT left 210 and 60 C with the nozzle
/// on the part.
#[test]
fn a_file_for_klipper_prints_twice_on_one_machine() {
    live_at(&heated(), None, 1, |life| {
        let mut prints = Vec::new();
        for _ in 0..2 {
            let filament = life.extruder_steps();
            life.heard.clear();
            let (begin, end) = FILE.split_once("EXCLUDE_OBJECT_START").unwrap();
            send(life, begin);
            assert_eq!(life.targets(), [200.0, 40.0]);
            assert!(life.celsius() > 195.0, "{}", life.celsius());
            send(life, &format!("EXCLUDE_OBJECT_START{end}"));
            life.say("M400");
            assert_eq!(life.targets(), [0.0, 0.0], "all is off");
            assert_eq!(life.part_fan(), 0);
            // 7 mm of lines, two retractions of 0.8 mm and an unretraction, and 2 mm at the end.
            prints.push(life.extruder_steps() - filament);
            let told: Vec<_> =
                life.heard.iter().filter(|line| line.starts_with("echo:") && !line.contains("busy")).collect();
            let expected = [
                "echo:SET_PRINT_STATS_INFO has no effect here, told once a print",
                "echo:Unknown command: \"_ON_LAYER_CHANGE LAYER=1\"",
                "echo:TIMELAPSE_TAKE_FRAME has no effect here, told once a print",
            ];
            assert_eq!(told, expected, "{:#?}", life.heard);
            let place = place(life, "M114");
            assert_eq!(place, [10.0, 10.0, 10.4], "the tool is off the part");
        }
        assert_eq!(prints, [(7.0 - 0.8 - 2.0) as i32 * 400 + 80; 2]);
    });
}

#[test]
fn the_bed_is_held_by_its_screws_when_a_print_is_over() {
    live(&heated(), 1, |life| {
        for line in ["START_PRINT EXTRUDER=200 BED=40", "M83", "G1 X150 Y150 E3 F6000", "PRINT_END"] {
            life.say(line);
        }
        life.say("M400");
        is_sound(life);
        assert_eq!(life.powered(), [4, 5], "the motors of Z alone");
        // X and Y have lost their place, Z has not.
        life.say("G28 X Y");
        assert_eq!(place(life, "M114")[2], 10.0);
    });
}

/// The words may be lower case, in any order, or missing.
#[test]
fn start_print_heats_as_its_words_or_the_lines_before_say() {
    for (lines, targets) in [
        (&["start_print extruder_temp=190 bed_temp=35"][..], [190.0, 35.0]),
        (&["PRINT_START BED=35 HOTEND=190 FOO=\"a b\""], [190.0, 35.0]),
        (&["M140 S35", "M104 S190", "START_PRINT"], [190.0, 35.0]),
        (&["M104 S190", "START_PRINT BED_TEMP=35"], [190.0, 35.0]),
        (&["START_PRINT BED_TEMP=35"], [0.0, 35.0]),
    ] {
        live_at(&heated(), None, 1, |life| {
            for line in lines {
                life.say(line);
            }
            is_sound(life);
            assert_eq!(life.targets(), targets, "{lines:?}");
            assert!(targets[0] == 0.0 || life.celsius() > targets[0] - 5.0, "{lines:?}: {}", life.celsius());
            assert_eq!(place(life, "M114"), [0.0, 0.0, 0.0], "homed: {lines:?}");
        });
    }
}

#[test]
fn a_print_without_a_temperature_is_held_and_never_prints_cold() {
    for line in ["START_PRINT", "START_PRINT BED_TEMP=40", "START_PRINT EXTRUDER_TEMP=warm", "START_PRINT 40 200"] {
        live_at(&heated(), None, 1, |life| {
            life.say(line);
            life.say("M83");
            life.put(0, "G1 X150 E5 F6000");
            life.rest(MINUTE);
            assert_eq!(life.count("echo:print held"), 1, "{line}: {:#?}", life.heard);
            assert_eq!(life.extruder_steps(), 0, "{line}");
        });
    }
}

#[test]
fn a_cancel_while_start_print_heats_ends_it_and_the_next_print_is_whole() {
    for cancel in ["CANCEL_PRINT", "M524"] {
        live_at(&heated(), None, 1, |life| {
            life.put(0, "START_PRINT EXTRUDER_TEMP=200 BED_TEMP=60");
            life.rest(20_000);
            assert_eq!(life.targets()[1], 60.0, "{:#?}", life.heard);
            let asked = life.oks();
            life.put(0, cancel);
            life.rest(1000);
            assert_eq!(life.oks(), asked + 2, "{cancel}: both lines are answered: {:#?}", life.heard);
            assert_eq!(life.targets(), [0.0, 0.0], "{cancel}");
            assert_eq!((life.count("echo:print cancelled, heaters are off"), life.count("//action:cancel")), (1, 1));
            life.forget_answers();
            let stopped = life.counts();
            // The rest of the file may still come.
            for line in ["G1 X150 Y150 F6000", "M104 S200", "END_PRINT"] {
                life.say(line);
            }
            life.rest(1000);
            assert_eq!((life.counts(), life.targets()), (stopped, [0.0, 0.0]), "{cancel}");
            life.heard.clear();
            send(life, FILE);
            assert_eq!(life.count("echo:print ended"), 0, "{:#?}", life.heard);
            assert_eq!(place(life, "M114"), [10.0, 10.0, 10.4]);
        });
    }
}

#[test]
fn m108_skips_a_wait_of_start_print_and_m410_ends_it() {
    live_at(&heated(), None, 1, |life| {
        life.put(0, "START_PRINT EXTRUDER_TEMP=200 BED_TEMP=90");
        life.rest(30_000);
        life.put(0, "M108");
        life.await_ok();
        life.await_ok();
        assert_eq!(life.targets(), [200.0, 90.0], "only the wait for the bed is over");
        assert!(life.celsius() > 195.0);
        life.say("END_PRINT");
        life.put(0, "START_PRINT EXTRUDER_TEMP=200 BED_TEMP=90");
        life.rest(1000);
        life.put(0, "M410");
        life.await_ok();
        life.await_ok();
        assert_eq!(life.count("echo:G28 was ended by M410"), 1, "{:#?}", life.heard);
        life.say("G28");
        assert_eq!(life.targets(), [150.0, 90.0], "no line of it came after");
    });
}

/// A home that fails ends the print, and the lines behind it do nothing.
#[test]
fn a_home_that_fails_ends_start_print() {
    live_at(&heated(), None, 1, |life| {
        life.unplug(corehbot::motors::EndstopSet::SWITCHES);
        life.say("START_PRINT EXTRUDER_TEMP=200 BED_TEMP=40");
        assert_eq!(life.count("echo:print ended, heaters are off: homing failed"), 1, "{:#?}", life.heard);
        life.rest(5000);
        assert_eq!(life.targets(), [0.0, 0.0]);
        let stopped = life.counts();
        life.say("G1 X50 F6000");
        life.rest(1000);
        assert_eq!(life.counts(), stopped);
    });
}

#[test]
fn waits_for_a_temperature_end_there_and_not_at_the_target() {
    live(&heated(), 1, |life| {
        life.say("SET_HEATER_TEMPERATURE HEATER=extruder TARGET=200");
        life.say("TEMPERATURE_WAIT SENSOR=extruder MINIMUM=120");
        let at = life.celsius();
        assert!((119.0..150.0).contains(&at), "{at}");
        life.say("TEMPERATURE_WAIT SENSOR=extruder MINIMUM=200 MAXIMUM=205");
        assert!(life.celsius() >= 198.9, "{}", life.celsius());
        life.say("TEMPERATURE_WAIT SENSOR=extruder MINIMUM=220");
        assert_eq!(life.count("echo:TEMPERATURE_WAIT ignored: its heater does not go there"), 1);
        life.say("TURN_OFF_HEATERS");
        assert_eq!(life.targets(), [0.0, 0.0]);
        life.say("TEMPERATURE_WAIT SENSOR=extruder MAXIMUM=100");
        assert!((90.0..=100.0).contains(&life.celsius()), "{}", life.celsius());
        is_sound(life);
    });
}

#[test]
fn without_heaters_a_file_still_moves() {
    live_at(&Settings::prototype(), None, 1, |life| {
        send(life, FILE);
        assert_eq!(place(life, "M114"), [10.0, 10.0, 10.4]);
    });
}
