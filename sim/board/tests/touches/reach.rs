//! Places of touches: within the ends of the axes and over the bed, whoever names them.

use crate::common::life::{Life, live_with};
use crate::touches::machine::{begin, machine};
use corehbot::port::NoStorage;
use corehbot::settings::{ProbeKind, Screw, Settings, WholePlace};
use corehbot::units::Mm;
use corehbot_rig::bed::BedPlant;
use corehbot_sim::world::Desk;

fn mm(mm: f64) -> Mm {
    Mm::from_num(mm)
}

/// A machine with its probe 40 mm to the left and 25 mm behind the nozzle: it reaches X0 to X350, Y25 to Y417.6.
fn behind() -> Settings {
    let mut s = machine(ProbeKind::Switch);
    s.probe.offset.y = mm(25.0);
    s
}

const REACH: &str = "but from X0.00 Y25.00 to X350.00 Y417.60";

/// A line is refused with these words, and nothing moves.
fn refuses(life: &mut Life<'_>, line: &str, why: &str) {
    life.say("M140 S50");
    let (steps, told) = (life.counts(), life.heard.len());
    life.say(line);
    assert!(life.heard[told..].iter().any(|heard| heard.contains(why)), "{line}: {:?}", &life.heard[told..]);
    assert_eq!((life.counts(), life.targets()[1]), (steps, 50.0), "{line}");
    assert_eq!(life.count("//action:cancel"), 0);
}

/// Homed by switches, where the machine stands from the start.
fn homed(s: &Settings, body: impl FnOnce(&mut Life<'_>)) {
    let mut s = *s;
    s.probe.homes_z = false;
    let mut desk = Desk::new(1);
    desk.bed = BedPlant::of(&s).map(Box::new);
    live_with(&s, Some([100, 100, 20].map(Mm::from_num)), (&mut desk, 1), NoStorage, body);
}

/// Reproducer: the tool went to Y-20, and to X425 of 390.
#[test]
fn a_place_for_homing_that_the_tool_does_not_reach_is_refused() {
    for (home, told) in [([50.0, 5.0], "X50 Y5"), ([385.0, 100.0], "X385 Y100"), ([-1.0, 100.0], "X-1 Y100")] {
        let mut s = behind();
        s.probe.home = home.map(|at| Some(mm(at)));
        begin(&s, |life| {
            let why = format!("Z is homed by the probe, which cannot touch at {told}. Correct probe.home");
            for line in ["G28", "G28 Z", "G28 X Y Z", "G29 N"] {
                let why = if line == "G28 Z" { "one of them is not homed" } else { why.as_str() };
                let why = if line == "G29 N" { REACH } else { why };
                refuses(life, line, why);
            }
            life.say("G28 X Y");
            refuses(life, "G28 Z", &why);
        });
        // It is where G29 has its zero, too.
        homed(&s, |life| refuses(life, "G29", REACH));
    }
}

#[test]
fn the_edge_of_the_bed_is_a_place_to_home_and_to_level_and_0_is_a_place() {
    let mut s = behind();
    s.probe.home = [Some(mm(0.0)), Some(mm(25.0))];
    let point = |x, y| WholePlace { x, y };
    s.screws[0] = Screw { place: point(-25, 200), point: point(0, 25) };
    s.screws[1] = Screw { place: point(415, 200), point: point(350, 417) };
    begin(&s, |life| {
        life.say("G28");
        let [x, y, _] = life.nozzle();
        assert!((x - 40.0).abs() < 0.01 && y.abs() < 0.01, "{x} {y} {:?}", life.heard);
        life.say("G34");
        assert_eq!(life.count("Did 1 of 5"), 1, "{:?}", life.heard);
        life.say("G30 X0 Y417");
        assert_eq!(life.count("Bed X:0.00 Y:417.00"), 1, "{:?}", life.heard);
        // A measured area keeps away from clips at the edge.
        life.say("G29");
        life.say("M421 I0 J0 Q0");
        life.say("G42 I0 J0 P F9000");
        life.say("M400");
        let [x, y, _] = life.nozzle();
        assert!((x - 50.0).abs() < 0.01 && y.abs() < 0.01, "{x} {y}");
    });
}

/// Reproducer: the tool went to Y-20.
#[test]
fn points_of_screws_that_the_tool_does_not_reach_are_refused() {
    for (screw, x, y) in [(0, 30, 5), (1, 351, 200), (1, 340, 418)] {
        let mut s = behind();
        s.screws[screw].point = WholePlace { x, y };
        homed(&s, |life| refuses(life, "G34", REACH));
    }
}

#[test]
fn places_of_lines_are_held_to_the_same_reach() {
    homed(&behind(), |life| {
        for line in ["G30 X100 Y24", "G30 X351 Y100", "M48 X-1 Y100", "G30 X100 Y418"] {
            refuses(life, line, REACH);
        }
        life.say("G35");
        assert_eq!(life.count("echo:Turn the screws"), 1, "{:?}", life.heard);
    });
    // A bed that the probe reaches nowhere.
    let mut nowhere = behind();
    (nowhere.bed.left, nowhere.bed.width) = (mm(360.0), mm(30.0));
    homed(&nowhere, |life| {
        for line in ["G35", "G29", "G30"] {
            refuses(life, line, "the probe cannot touch at");
        }
    });
}

#[test]
fn screws_that_nothing_has_placed_are_not_levelled() {
    let mut s = behind();
    s.screws = [Screw::UNKNOWN; 4];
    homed(&s, |life| {
        refuses(life, "G34", "echo:G34 ignored: a screw or its point has no place. Set them by M422");
        for line in ["M422 S1 X40 Y200", "M422 W1 X-25 Y200", "M422 S2 X350 Y200"] {
            life.say(line);
            refuses(life, "G34", "has no place");
        }
        life.say("M422 W2 X415 Y200");
        life.say("G34");
        assert_eq!(life.count("Did 1 of 5"), 1, "{:?}", life.heard);
    });
}

/// Reproducer: after a touch, the world held the shift of z to the name that z had before.
#[test]
fn z_is_shifted_right_after_the_touch_that_homed_it() {
    let s = machine(ProbeKind::Switch);
    for after in [&["M290 Z-0.2"][..], &["G1 X100 Z5 F6000", "M290 Z-0.2", "G1 X200"], &["M290 Z-1", "M290 Z0.5"]] {
        begin(&s, |life| {
            life.put(0, "G28");
            after.iter().for_each(|line| life.put(0, line));
            life.say("M400");
            life.say("G1 Z1 F600");
            life.say("M400");
            let [.., z] = life.nozzle();
            println!("{after:?}: {z}");
        });
    }
}
