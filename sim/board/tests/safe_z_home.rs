//! Z is homed by its switch at a place, and rises before anything is homed (`[safe_z_home]`). The oracle is where the
//! nozzle really is, each few milliseconds.

use crate::common::life::{Life, live, live_at, live_with};
use corehbot::motors::EndstopSet;
use corehbot::port::NoStorage;
use corehbot::settings::{AxisEnd, HomedAxis, ProbeKind, Settings};
use corehbot::units::{Mm, MmPerSec};
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::Desk;

/// Where z is homed.
const PLACE: [f64; 2] = [150.0, 120.0];

/// How far z rises.
const HOP: f64 = 6.0;

/// Half a step of z, and a step of the belt.
const EXACT: f64 = 0.02;

fn machine() -> Settings {
    let mut s = Settings::prototype();
    s.safe_z_home.place = PLACE.map(|at| Some(Mm::from_num(at)));
    s.safe_z_home.z_hop = Mm::from_num(HOP);
    s.safe_z_home.speed = MmPerSec::from_num(150);
    s.check().unwrap();
    s
}

/// Says a line; where the nozzle is, from 5 ms to 5 ms until the answer.
fn path(life: &mut Life<'_>, line: &str) -> Vec<[f64; 3]> {
    life.say("M400");
    let (mut places, before) = (vec![life.nozzle()], life.oks());
    life.put(0, line);
    while life.oks() == before {
        life.rest(5);
        places.push(life.nozzle());
    }
    life.forget_answers();
    assert!(!life.is_halted());
    places
}

fn is_at(place: [f64; 3], wanted: [f64; 3]) -> bool {
    place.iter().zip(wanted).all(|(at, wanted)| (at - wanted).abs() < EXACT)
}

/// Z goes down only at the place, and x and y move only where z is as high as `least`.
fn is_safe(path: &[[f64; 3]], least: f64) {
    for pair in path.windows(2) {
        let [[x0, y0, z0], [x, y, z]] = [pair[0], pair[1]];
        let is_over = (x - PLACE[0]).abs() < EXACT && (y - PLACE[1]).abs() < EXACT;
        assert!(z > z0 - EXACT / 2.0 || is_over, "down at X{x} Y{y} from Z{z0} to Z{z}");
        let moves = (x - x0).abs() + (y - y0).abs() > EXACT;
        assert!(!moves || z > least - EXACT, "X{x0} Y{y0} to X{x} Y{y} at Z{z}");
    }
}

#[test]
fn z_rises_then_x_and_y_are_homed_then_z_at_its_place() {
    // As if homed at Z 50, so M84 first: z rises by the hop then, and to its height later.
    live(&machine(), 1, |life| {
        life.say("M84");
        let first = path(life, "G28");
        is_safe(&first, 50.0 + HOP);
        assert!(first.iter().any(|at| is_at(*at, [0.0, 0.0, 50.0 + HOP])), "x and y were home at that height");
        assert!(first.iter().any(|at| is_at(*at, [PLACE[0], PLACE[1], 0.0])), "the switch was met");
        assert!(is_at(*first.last().unwrap(), [PLACE[0], PLACE[1], HOP]), "{:?}", first.last());
        assert!(life.ask("M114", "X:").starts_with("X:150.00 Y:120.00 Z:6.00"), "{:?}", life.heard);
        // Again, from below the hop, from its height, and from far above.
        for (z, least) in [(1.5, HOP), (HOP, HOP), (40.0, 40.0)] {
            life.say(&format!("G1 X30 Y40 Z{z} F6000"));
            let again = path(life, "G28");
            is_safe(&again, least);
            let top = again.iter().map(|[.., z]| *z).fold(0.0, f64::max);
            assert!((top - least).abs() < EXACT, "from {z} up to {top}");
            assert!(is_at(*again.last().unwrap(), [PLACE[0], PLACE[1], HOP]));
        }
    });
}

#[test]
fn z_alone_goes_to_its_place_and_back_if_that_is_set() {
    for returns in [false, true] {
        let mut s = machine();
        s.safe_z_home.move_to_previous = returns;
        live(&s, 1, |life| {
            life.say("G28");
            life.say("G1 X30 Y40 Z2 F6000");
            let way = path(life, "G28 Z");
            is_safe(&way, HOP);
            let [x, y] = if returns { [30.0, 40.0] } else { PLACE };
            assert!(is_at(*way.last().unwrap(), [x, y, HOP]), "{:?}", way.last());
            // The program goes on from there.
            life.say("G91");
            life.say("G1 X5 F6000");
            life.say("M400");
            assert!(is_at(life.nozzle(), [x + 5.0, y, HOP]));
        });
    }
}

/// Reproducer: a switch may be beyond the end of its axis, where nothing else goes; X was sent back there.
#[test]
fn x_returns_no_further_than_its_end() {
    for place in [PLACE.map(Some), [None, Some(PLACE[1])]] {
        let mut s = machine();
        s.safe_z_home.place = place.map(|at| at.map(Mm::from_num));
        s.safe_z_home.move_to_previous = true;
        s.endstops.x.end = AxisEnd::Max;
        let most = s.reach(HomedAxis::X).most;
        s.endstops.x.position = most + Mm::from_num(3);
        s.check().unwrap();
        live(&s, 1, |life| {
            life.say("M84");
            let way = path(life, "G28");
            assert!(is_at(*way.last().unwrap(), [most.to_num(), 0.0, HOP]), "{:?}", way.last());
        });
    }
}

#[test]
fn it_is_told_by_m503() {
    let mut s = machine();
    s.safe_z_home.move_to_previous = true;
    live(&s, 1, |life| {
        life.say("M503");
        for told in ["homing Z: at X150", "homing Z: at Y120", "homing: Z rises to 6 mm", "homing Z: X and Y return"] {
            assert_eq!(life.heard.iter().filter(|line| line.contains(told)).count(), 1, "{told}: {:?}", life.heard);
        }
    });
}

/// A part of the place may be left out, and without one z is homed where the tool stands, with its hop.
#[test]
fn what_is_not_set_stays_where_it_is() {
    for (place, wanted) in [([None, None], [0.0, 0.0]), ([Some(150), None], [150.0, 0.0])] {
        let mut s = machine();
        s.safe_z_home.place = place.map(|at| at.map(Mm::from_num));
        live(&s, 1, |life| {
            life.say("G1 X30 Y40 Z2 F6000");
            let way = path(life, "G28");
            assert!(way.iter().any(|at| is_at(*at, [wanted[0], wanted[1], 0.0])));
            assert!(is_at(*way.last().unwrap(), [wanted[0], wanted[1], HOP]), "{:?}", way.last());
        });
    }
}

#[test]
fn one_axis_rises_by_the_hop_too_unless_the_line_says_otherwise() {
    live(&machine(), 1, |life| {
        life.say("G28");
        for (line, z) in [("G28 X", HOP), ("G28 X R0", 1.0), ("G28 X R20", 21.0)] {
            life.say("G1 X30 Y40 Z1 F6000");
            let way = path(life, line);
            assert!(is_at(*way.last().unwrap(), [0.0, 40.0, z]), "{line}: {:?}", way.last());
        }
        // Axes that are home stay where they are.
        assert!(path(life, "G28 O").iter().all(|at| is_at(*at, [0.0, 40.0, 21.0])));
    });
}

#[test]
fn a_switch_that_is_pressed_at_the_start_is_met_at_the_place() {
    for hop in [0.0, HOP] {
        let mut s = machine();
        s.safe_z_home.z_hop = Mm::from_num(hop);
        live_at(&s, Some([100, 100, 0].map(Mm::from_num)), 1, |life| {
            life.say("M84");
            let way = path(life, "G28");
            is_safe(&way, hop);
            assert!(is_at(*way.last().unwrap(), [PLACE[0], PLACE[1], hop]), "{:?}", way.last());
        });
    }
}

#[test]
fn a_switch_above_is_met_at_the_place_too() {
    let mut s = machine();
    s.endstops.z.end = AxisEnd::Max;
    s.endstops.z.position = s.axes.z.length;
    let top: f64 = s.axes.z.length.to_num();
    live(&s, 1, |life| {
        life.say("M84");
        let way = path(life, "G28");
        assert!(is_at(*way.last().unwrap(), [PLACE[0], PLACE[1], top]), "{:?}", way.last());
    });
}

#[test]
fn it_is_stored_and_counts_after_power_off() {
    let mut eeprom = Eeprom::blank();
    eeprom.save(&machine()).unwrap();
    for _ in 0..2 {
        let mut desk = Desk::new(1);
        let start = Some([100, 100, 50].map(Mm::from_num));
        live_with(&Settings::prototype(), start, (&mut desk, 1), &mut eeprom, |life| {
            life.say("M84");
            let way = path(life, "G28");
            is_safe(&way, 50.0 + HOP);
            assert!(is_at(*way.last().unwrap(), [PLACE[0], PLACE[1], HOP]), "{:?}", way.last());
            life.say("M500");
        });
    }
}

/// What is refused moves nothing, and no axis that failed lets z go down.
#[test]
fn where_the_place_is_not_known_or_out_of_reach_nothing_goes_down() {
    live(&machine(), 1, |life| {
        life.say("M84");
        let way = path(life, "G28 Z");
        assert!(way.iter().all(|at| is_at(*at, [100.0, 100.0, 50.0])));
        let why = "Z is homed at a place in X and Y, and one of them is not homed. Home them too (G28)";
        assert!(life.heard.iter().any(|line| line.contains(why)), "{:?}", life.heard);
        life.unplug(EndstopSet::X);
        let way = path(life, "G28");
        assert!(way.iter().all(|[.., z]| *z > 50.0 - EXACT), "z rises alone");
        assert!(life.heard.iter().any(|line| line.contains("homing failed: X ")), "{:?}", life.heard);
    });
    let mut s = machine();
    s.safe_z_home.place = [Some(Mm::from_num(150)), Some(s.reach(HomedAxis::Y).most + Mm::ONE)];
    live(&s, 1, |life| {
        for line in ["G28", "G28 Z"] {
            assert!(path(life, line).iter().all(|at| is_at(*at, [100.0, 100.0, 50.0])), "{line}");
        }
        let why = "Z is homed at X150 Y418.6, where the nozzle cannot be. Correct safe_z_home";
        assert!(life.heard.iter().any(|line| line.contains(why)), "{:?}", life.heard);
        assert!(is_at(*path(life, "G28 X Y").last().unwrap(), [0.0, 0.0, 50.0]), "x and y are homed without z");
    });
}

/// A probe that homes z has its own place; the hop and the way back count for it as well.
#[test]
fn a_probe_has_its_own_place_and_the_same_hop() {
    let mut s = machine();
    s.probe_plug.connector = corehbot::connectors::ConnectorName::lit("PROBE");
    (s.probe.kind, s.probe.homes_z, s.probe.samples) = (ProbeKind::Switch, true, 1);
    s.probe.home = [Some(Mm::from_num(60)), Some(Mm::from_num(70))];
    (s.safe_z_home.z_hop, s.safe_z_home.move_to_previous) = (Mm::from_num(25), true);
    let mut desk = Desk::new(1);
    desk.bed = Some(Box::new(corehbot_rig::bed::BedPlant::new(&s, &corehbot_rig::bed::BedSetup::of(&s))));
    live_with(&s, Some([100, 100, 50].map(Mm::from_num)), (&mut desk, 1), NoStorage, |life| {
        life.say("M84");
        let way = path(life, "G28");
        assert!(way.iter().any(|at| is_at(*at, [0.0, 0.0, 75.0])), "x and y were home at that height");
        assert!(way.iter().any(|[x, y, z]| is_at([*x, *y, 0.0], [60.0, 70.0, 0.0]) && *z < 1.0));
        assert!(is_at(*way.last().unwrap(), [0.0, 0.0, 25.0]), "{:?}", way.last());
    });
}
