//! Held lines, which cannot be carried out yet, and their later effect.

use super::{heated, place};
use crate::common::life::{Life, live, live_at};
use corehbot::settings::Settings;

#[test]
fn a_line_that_has_lost_its_place_is_held_until_the_axes_are_homed() {
    let mut settings = Settings::prototype();
    settings.require_homing = true;
    live(&settings, 2, |life| {
        for line in ["G28", "G1 Z5 F600", "G1 X50 Y50 E1 F6000"] {
            life.say(line);
        }
        life.switch_to(1);
        life.say("M84 X Y");
        life.switch_to(0);
        // M84 ends the print; a host that prints on has lost its place.
        life.put(0, "G1 X60 E2");
        life.rest(10_000);
        assert_eq!(life.count("//action:pause action:pause"), 1, "{:?}", life.heard);
        assert_eq!(life.count("echo:print held: axes are no longer homed"), 1);
        assert!(life.count("echo:busy: paused for user") >= 4);
        let oks = life.oks();
        life.switch_to(1);
        life.say("M24");
        life.rest(1000);
        life.switch_to(0);
        assert_eq!((life.oks(), life.count("//action:resumed")), (oks, 0), "not without a home");
        life.switch_to(1);
        life.say("G28 X Y");
        life.say("M24");
        life.switch_to(0);
        life.await_ok();
        life.say("M400");
        assert_eq!(place(life), [60.0, 50.0, 5.0, 2.0], "from where it was");
        assert_eq!(life.count("//action:resumed"), 1);
    });
    // Outside of a print it is refused.
    live(&settings, 1, |life| {
        life.say("G1 X60");
        life.say("G1 E2");
        life.say("M84");
        life.say("G1 X70");
        assert_eq!(life.count("echo:move ignored: home its axes first (G28)"), 1, "{:?}", life.heard);
        assert_eq!(life.count("//action:pause"), 0);
    });
}

#[test]
fn a_cold_line_is_held_and_a_host_that_can_do_nothing_else_is_let_go_by_m108() {
    live(&heated(), 1, |life| {
        // A file for a printer that has a macro.
        life.say("START_MACRO BED=60 EXTRUDER=210");
        life.put(0, "G1 X110 E1 F6000");
        life.rest(5000);
        assert_eq!(life.count("//action:pause action:pause"), 1, "{:?}", life.heard);
        assert_eq!(life.extruder_steps(), 0);
        life.put(0, "M108");
        life.await_ok();
        life.await_ok();
        assert_eq!(life.count("echo:line left out, the print is still paused"), 1, "{:?}", life.heard);
        // The host heats, and its stream continues.
        life.say("M109 S200");
        life.say("G1 X120 E2 F6000");
        life.say("M400");
        assert_eq!(place(life), [120.0, 100.0, 50.0, 2.0]);
        assert_eq!(life.count("//action:resumed"), 1);
    });
    // With a second host.
    live(&heated(), 2, |life| {
        life.put(0, "G1 X110 E1 F6000");
        life.rest(3000);
        life.switch_to(1);
        life.say("M104 S200");
        life.say("M24");
        life.switch_to(0);
        life.await_ok();
        life.say("M400");
        assert!(life.celsius() > 195.0, "{}", life.celsius());
        assert_eq!(place(life), [110.0, 100.0, 50.0, 1.0]);
    });
    // This is not a print: it is left out, as ever.
    live(&heated(), 1, |life| {
        life.say("G1 E5 F300");
        assert_eq!(life.count("echo: cold extrusion prevented"), 1);
    });
}

#[test]
fn a_macro_that_is_not_there_homes_nothing() {
    live_unhomed(|life| {
        life.say("_PRINT_START_BASE BED_TEMP=60");
        life.put(0, "G1 X110 E1 F6000");
        life.rest(3000);
        assert_eq!(life.count("echo:print held: axes are no longer homed"), 1, "{:?}", life.heard);
        life.put(0, "M524");
        life.await_ok();
        life.await_ok();
        assert_eq!(life.count("//action:cancel action:cancel"), 1);
        assert_eq!(life.extruder_steps(), 0);
    });
    // Without the macro the host is told, as ever: there are machines without switches.
    live_unhomed(|life| {
        life.say("G1 X10 E1 F6000");
        assert_eq!(life.count("echo:motion before homing"), 1);
    });
}

fn live_unhomed(body: impl FnOnce(&mut Life<'_>)) {
    live_at(&Settings::prototype(), None, 1, body);
}
