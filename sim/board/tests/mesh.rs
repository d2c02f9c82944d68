//! Life on a mesh: z follows it, real places stay true through stops, homing and power, and nothing jumps.

use crate::common::life::{Life, live_on};
use corehbot::settings::{HomedAxis, Settings};
use corehbot::surface::{Heights, Mesh, UNITS_PER_MM};
use corehbot::units::Mm;

/// The motors of the Z screws.
const SCREWS: [usize; 2] = [4, 5];

/// A random number below a bound (Marsaglia, "Xorshift RNGs", 2003).
fn roll(state: &mut u64, below: u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 20) % below
}

/// Five by five points, up to 0.2 mm up and down.
fn mesh(fade: f64) -> Mesh {
    let mut state = 0x1357_9BDF_0246_8ACE;
    let most = UNITS_PER_MM as u64 / 5;
    let filled = Heights::filled(5, 5, |_, _| Some(roll(&mut state, 2 * most) as i16 - most as i16));
    let corners = [[20, 20], [370, 380]].map(|corner| corner.map(Mm::from_num));
    Mesh::new(filled.unwrap(), corners[0], corners[1], Mm::from_num(fade)).unwrap()
}

/// Height of the mesh there, relative to its mean or to 0, in mm.
fn height(mesh: &Mesh, x: f64, y: f64) -> f64 {
    f64::from(mesh.at(Mm::from_num(x), Mm::from_num(y)).z)
}

/// Where z was sent, by M114.
fn z_of(life: &mut Life<'_>, line: &str) -> f64 {
    let answer = life.ask(line, "X:");
    let z = answer.split_whitespace().find_map(|word| word.strip_prefix("Z:")).unwrap();
    z.parse().unwrap()
}

/// Real z in mm since the start, by the screws, which turn together.
fn real_z(life: &Life<'_>, s: &Settings) -> f64 {
    let counts = SCREWS.map(|screw| life.counts()[screw].abs());
    assert_eq!(counts[0], counts[1], "the screws turn together");
    f64::from(life.counts()[SCREWS[0]]) / s.axes.z.steps_per_mm.to_num::<f64>()
}

const START: [i32; 3] = [100, 100, 50];

fn on_mesh(mesh: Mesh, body: impl FnOnce(&mut Life<'_>)) {
    live_on(&Settings::prototype(), Some(START.map(Mm::from_num)), Some(mesh), 1, body);
}

#[test]
fn nothing_moves_when_z_begins_to_follow_and_then_every_place_has_its_height() {
    let (mesh, s) = (mesh(0.0), Settings::prototype());
    on_mesh(mesh, |life| {
        assert_eq!(real_z(life, &s), 0.0);
        let begin = 50.0 - height(&mesh, 100.0, 100.0);
        assert!((z_of(life, "M114") - begin).abs() < 0.006, "{begin}: {:?}", life.heard);
        let step = 1.0 / s.axes.z.steps_per_mm.to_num::<f64>();
        for (x, y, z) in [(100.0, 100.0, 50.0), (30.0, 200.0, 0.2), (222.2, 333.3, 0.2), (380.0, 10.0, 7.0)] {
            life.say(&format!("G1 X{x} Y{y} Z{z} F9000"));
            life.say("M400");
            let real = 50.0 + real_z(life, &s);
            assert!((real - z - height(&mesh, x, y)).abs() < 0.51 * step, "{x} {y} {z}: {real}");
            assert!((z_of(life, "M114") - z).abs() < 0.006 && (z_of(life, "M114 R") - z).abs() < 0.006);
        }
    });
}

#[test]
fn p9_after_stops_and_homes_the_same_place_has_the_same_steps() {
    for fade in [0.0, 10.0] {
        on_mesh(mesh(fade), |life| {
            let mut state = 0xFEED_BEEF_1234_5678;
            let place = |life: &mut Life<'_>| {
                life.say("G0 X123.4 Y234.5 Z0.3 F12000");
                life.say("M400");
                SCREWS.map(|screw| life.counts()[screw])
            };
            let expected = place(life);
            for round in 0..24 {
                for _ in 0..20 {
                    let [x, y, z] = [390, 410, 1200].map(|below| roll(&mut state, below));
                    life.say(&format!("G1 X{x} Y{y} Z{}.{:02} F18000", z / 100, z % 100));
                }
                if round % 3 == 0 {
                    life.say("M410");
                    // The rest of it is dropped, and z is where it really is.
                    let (asked, real) = (z_of(life, "M114"), z_of(life, "M114 R"));
                    assert!((asked - real).abs() < 0.006, "{asked} {real}");
                }
                if round % 12 == 7 {
                    life.say("G28 X");
                }
                if round % 12 == 9 {
                    life.say("G28");
                }
                assert_eq!(place(life), expected, "{fade}, round {round}: {:?}", life.heard.last());
            }
        });
    }
}

#[test]
fn z_is_found_at_its_real_place_and_counts_from_the_mesh_afterwards() {
    let (mesh, s) = (mesh(0.0), Settings::prototype());
    on_mesh(mesh, |life| {
        life.say("G28");
        let before = real_z(life, &s);
        let [x, y] = [Mm::ZERO; 2];
        let z = z_of(life, "M114");
        let stands: f64 = s.endstops.z.position.to_num();
        assert!((z - (stands - f64::from(mesh.at(x, y).z))).abs() < 0.01, "{z}: {:?}", life.heard);
        assert_eq!(real_z(life, &s), before, "nothing jumps");
    });
}

#[test]
fn at_the_top_real_z_stays_within_the_machine() {
    let s = Settings::prototype();
    let most: f64 = s.reach(HomedAxis::Z).most.to_num();
    let (first, last) = ([Mm::from_num(20); 2], [Mm::from_num(370); 2]);
    for fade in [0, 10] {
        let raised = Heights::filled(3, 3, |_, _| Some(UNITS_PER_MM as i16 / 5)).unwrap();
        on_mesh(Mesh::new(raised, first, last, Mm::from_num(fade)).unwrap(), |life| {
            life.say("G1 X200 Y200 Z9999 F1200");
            life.say("M400");
            let real = 50.0 + real_z(life, &s);
            assert!((real - most).abs() < 0.002, "{real}, not {most}");
        });
    }
}
