//! Filament that M600 pulls out and pushes in.

use super::{heated, place, print};
use crate::common::life::{Life, live};
use corehbot::settings::Settings;

/// Changes the filament by that line; gives where the extruder was in the pause and after it.
fn change(life: &mut Life<'_>, line: &str, meanwhile: &[&str]) -> [f64; 2] {
    life.put(0, line);
    life.rest(30_000);
    let out = f64::from(life.extruder_steps()) / 400.0;
    for line in meanwhile {
        life.put(0, line);
        life.rest(30_000);
    }
    life.put(0, "M108");
    life.await_ok();
    life.await_ok();
    for _ in meanwhile {
        life.await_ok();
    }
    life.say("M400");
    assert_eq!(place(life)[..3], [150.0, 100.0, 50.0], "{line}");
    [out, place(life)[3]]
}

#[test]
fn m600_pulls_filament_out_and_pushes_it_in_where_it_is_parked() {
    for (line, expected) in [
        ("M600 U40 L30", [5.0 - 2.0 - 40.0, 5.0 - 40.0 + 30.0]),
        ("M600 U-40", [-37.0, -35.0]),
        ("M600 L30", [3.0, 35.0]),
        // Prusa's word for it.
        ("M600 L-40", [-37.0, -35.0]),
        ("M600 E4 U40 L40", [-39.0, 5.0]),
        ("M600 AUTO", [3.0, 5.0]),
    ] {
        live(&heated(), 1, |life| {
            print(life);
            assert_eq!(change(life, line, &[]), expected, "{line}");
            assert_eq!(life.count("echo:M600"), 0, "{:?}", life.heard);
            // The print's E requests are the same as without the change.
            let before = place(life)[3];
            for line in ["G1 X160 E6 F6000", "M400"] {
                life.say(line);
            }
            assert_eq!(place(life)[3], before + 1.0, "{line}");
        });
    }
}

#[test]
fn filament_that_is_changed_has_limits() {
    // No more than in any one line.
    live(&heated(), 1, |life| {
        print(life);
        let most: f64 = heated().axes.e.length.to_num();
        life.put(0, "M600 U99999");
        life.rest(120_000);
        assert_eq!(f64::from(life.extruder_steps()) / 400.0, 3.0 - most);
        life.put(0, "M108");
        life.await_ok();
        life.await_ok();
        assert_eq!(place(life)[3], 5.0 - most);
    });
    // A cold hotend moves no filament, and the user is told.
    live(&heated(), 1, |life| {
        print(life);
        life.say("M104 S100");
        life.rest(120_000);
        assert_eq!(change(life, "M600 U40", &[]), [5.0, 5.0]);
        assert_eq!(life.count("echo:filament is not moved: the hotend is too cold"), 1, "{:?}", life.heard);
    });
    // A dry run moves no filament.
    live(&Settings::prototype(), 1, |life| {
        for line in ["M111 S8", "G1 X150 F6000", "M75"] {
            life.say(line);
        }
        assert_eq!(change(life, "M600 U40 L40", &[]), [0.0, 0.0]);
    });
}
