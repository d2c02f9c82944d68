//! The state of the program: what a pause saves and restores, and what keeps its new value.

use super::{heated, place, print};
use crate::common::life::{Life, live};
use corehbot::settings::Settings;

#[test]
fn jogging_and_heating_work_in_a_pause_and_the_print_goes_on_where_it_was() {
    live(&heated(), 1, |life| {
        print(life);
        life.say("M25");
        for line in ["G91", "G1 X50 Y20 Z5 F6000", "G90", "G1 Y200", "M83", "G1 E30 F300", "M104 S210"] {
            life.say(line);
        }
        assert_eq!(place(life), [60.0, 200.0, 65.0, 33.0]);
        for line in ["G92 X0", "G20"] {
            life.say(line);
        }
        life.say("M24");
        // Filament that was changed in between does not count as requested by the print.
        assert_eq!(place(life), [150.0, 100.0, 50.0, 35.0]);
        assert_eq!(life.targets(), [210.0, 40.0], "hot enough to print with");
        for line in ["G1 X160 E6 F6000", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [160.0, 100.0, 50.0, 36.0], "absolute, in mm, E5 to E6");
    });
}

#[test]
fn what_a_pause_saves_is_the_whole_state_of_the_program() {
    live(&Settings::prototype(), 1, |life| {
        for line in ["G92 X0 Y0", "M83", "M204 P1234", "G18", "G1 X10 E1 F1200", "M25"] {
            life.say(line);
        }
        for line in ["G90", "M82", "G92 X0 Y0 Z0 E0", "M204 P500", "G17", "G91", "G20", "G1 F9000"] {
            life.say(line);
        }
        life.say("M24");
        assert!(life.ask("M114", "X:").starts_with("X:10.00 Y:0.00 Z:50.00 E:1.00 "), "{:?}", life.heard.last());
        life.say("G1 X20 E1");
        assert!(life.ask("M114", "X:").starts_with("X:20.00 Y:0.00 Z:50.00 E:2.00 "));
        life.say("M503");
        assert_eq!(life.count("echo:  M204 P1234"), 1);
    });
}

/// A user who watches a paused print corrects its settings, and expects them to stay.
#[test]
fn overrides_that_are_set_in_a_pause_stay_and_others_are_what_they_were() {
    live(&Settings::prototype(), 2, |life| {
        for line in ["M220 S80", "M221 S90", "G1 X150 E5 F6000", "M25", "M24"] {
            life.say(line);
        }
        let overrides = |life: &mut Life<'_>| [life.ask("M220", "FR:"), life.ask("M221", "echo:E0")];
        assert_eq!(overrides(life), ["FR:80%", "echo:E0 Flow: 90%"]);
        life.say("M25");
        // From a screen next to the host.
        life.switch_to(1);
        for line in ["M220 S60", "M221 S110"] {
            life.say(line);
        }
        life.switch_to(0);
        life.say("M24");
        assert_eq!(overrides(life), ["FR:60%", "echo:E0 Flow: 110%"]);
        for line in ["G1 X160 E6", "M400"] {
            life.say(line);
        }
        assert_eq!(place(life), [160.0, 100.0, 50.0, 5.0 * 0.9 + 1.1]);
        // A pause that ends by the next printing line ends in the same way.
        for line in ["M25", "M220 S70", "G1 X170 E7", "M400"] {
            life.say(line);
        }
        assert_eq!(overrides(life), ["FR:70%", "echo:E0 Flow: 110%"]);
    });
}

/// A script at a pause switches the fan off and leaves it so: the print needs it. A speed that is set is the user's.
#[test]
fn the_part_fan_blows_again_after_a_pause_unless_another_speed_was_set() {
    for resumed_by in ["M24", "G1 X151 E5.1"] {
        for (before, meanwhile, after) in [
            ("M106 S128", &[][..], 128),
            ("M106 S128", &["M107"], 128),
            ("M106 S128", &["M106 S0"], 128),
            ("M106 S128", &["M81"], 128),
            ("M106 S128", &["M106 S255", "M107"], 128),
            ("M106 S128", &["M106 S200"], 200),
            ("M107", &["M106 S64"], 64),
            ("M107", &["M106 S64", "M107"], 0),
        ] {
            live(&heated(), 1, |life| {
                print(life);
                life.say(before);
                life.say("M25");
                for line in meanwhile {
                    life.say(line);
                }
                life.say(resumed_by);
                life.say("M400");
                assert_eq!(life.part_fan(), after, "{before}, {meanwhile:?}, {resumed_by}");
            });
        }
    }
    // A print that is cancelled in the pause hands its fan on to no other print.
    live(&heated(), 1, |life| {
        print(life);
        for line in ["M106 S128", "M25", "M107", "M524", "G28", "G1 X50 F6000", "M400"] {
            life.say(line);
        }
        assert_eq!(life.part_fan(), 0);
    });
}

/// A pause is a rest and nothing else: all steps before and after it are the same.
#[test]
fn the_steps_after_a_pause_are_those_of_a_print_without() {
    let lines: Vec<String> =
        (1..60).map(|n| format!("G1 X{}.37 Y{}.11 E{}.013", 100 + n % 7 * 3, 100 + n, n)).collect();
    let steps = |pause: &[&str]| {
        let mut after = Vec::new();
        live(&Settings::prototype(), 1, |life| {
            life.say("G1 F6000");
            for line in &lines[..30] {
                life.say(line);
            }
            life.say("M400");
            for line in pause {
                life.say(line);
            }
            life.mark();
            for line in &lines[30..] {
                life.say(line);
            }
            life.say("M400");
            after = life.events();
        });
        after
    };
    let whole = steps(&[]);
    assert!(whole.len() > 1000);
    for pause in [
        &["M25", "M24"][..],
        &["M25", "G91", "G1 X7.77 Z3", "G90", "M24"],
        &["M25", "M24", "M125 X50 Z2 L5", "M24"],
        // A host's own script, around M25 and after it, with its way back.
        &[
            "G91",
            "G1 E-2 F2400",
            "G1 Z10",
            "G90",
            "G1 X0 Y0",
            "M25",
            "M24",
            "G1 X106.37 Y130.11 F6000",
            "G91",
            "G1 Z-10",
            "G1 E2",
            "G90",
            "G1 F6000",
            "M400",
        ],
    ] {
        assert!(whole == steps(pause), "{pause:?}");
    }
}

/// Storms of pauses and ends in any order leave a machine that prints.
#[test]
fn any_order_of_pauses_and_ends_leaves_a_machine_that_prints_the_same() {
    const WORDS: [&str; 16] = [
        "M25",
        "M24",
        "M602",
        "M125",
        "M108",
        "G10",
        "G11",
        "M84 E",
        "M75",
        "M77",
        "G91",
        "G90",
        "G1 X5 Z1 E1 F6000",
        "M110 N0",
        "G28 X",
        "M524",
    ];
    let mut seed = 7_u32;
    for round in 0..60 {
        live(&Settings::prototype(), 1, |life| {
            let mut said = Vec::new();
            for _ in 0..12 {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                let word = WORDS[(seed >> 16) as usize % WORDS.len()];
                said.push(word);
                life.say(word);
            }
            for line in
                ["M108", "M24", "M84", "N0 M110 N0*125", "G28", "G90", "M82", "G21", "G92 E0", "M220 S100", "M221 S100"]
            {
                life.say(line);
            }
            life.mark();
            for line in ["G1 X50 Y50 Z1 E3 F3000", "G1 X80 E5", "M400"] {
                life.say(line);
            }
            assert_eq!(life.extruder_since_mark(), 5 * 400, "{round}: {said:?}");
            assert_eq!(place(life)[..3], [80.0, 50.0, 1.0], "{round}: {said:?}");
        });
    }
}
