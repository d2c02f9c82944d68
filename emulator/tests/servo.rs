//! The servo line of a BLTouch: its pulses at rest and while the machine prints fast, and machines that leave it alone.

use crate::common::{Bench, bench_of, firmware, print_on};
use corehbot_emulator::watch::End;
use corehbot_machine_file as machine_file;

/// A BLTouch on the Octopus.
const BLTOUCH: &str = "[endstops]\nprobe = \"BLTOUCH\"\n[probe]\nkind = \"bltouch\"\noffset = { z = -1.5 }\n";

/// How far a pulse may be off, in ns: two orders are 100 us apart.
const TOLERANCE_NS: u64 = 10_000;

/// At least five periods, and then the line is low.
#[test]
fn an_order_is_as_many_pulses_as_a_bltouch_hears() {
    let bench = bench_of(machine_file::load(BLTOUCH).unwrap());
    let seen = print_on(&firmware(), "M280 P0 S647\nG4 S1\nM280 P0 S1472\nG4 S1\n", &bench);
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{:?}", seen.line.said);
    let of = |us: u64| seen.servo.pulses.iter().filter(|pulse| pulse.ns.abs_diff(us * 1000) <= TOLERANCE_NS).count();
    assert_eq!((of(647), of(1472), seen.servo.pulses.len()), (6, 6, 12));
}

/// Orders under load, and the length of their pulses in us.
const ORDERS: [(u32, u64); 3] = [(10, 647), (90, 1472), (160, 2194)];

/// How many.
const COUNT: usize = 100;

/// Chords of a circle of 100 mm at 300 mm/s: 5 mm each, so ten of them take longer than an order.
const RADIUS_MM: f64 = 100.0;
const CHORD_MM: f64 = 5.0;
const CHORDS_AN_ORDER: usize = 10;

/// Chords before the first order: the look-ahead is full, and lines come as fast as moves are made.
const CHORDS_BEFORE: usize = 200;

/// Round and round at full speed, with an order every so often, and with fans of the timer that has the servo's pin.
fn circles() -> String {
    let at = |chord: usize| {
        let angle = chord as f64 * CHORD_MM / RADIUS_MM;
        format!("G1 X{:.3} Y{:.3}\n", 150.0 - RADIUS_MM * angle.cos(), 150.0 + RADIUS_MM * angle.sin())
    };
    let mut gcode = "M106 P3 S128\nM106 P4 S77\nG92 X0 Y0 Z0\nG1 X50 Y150 F18000\n".to_owned();
    gcode.extend((0..CHORDS_BEFORE).map(at));
    for order in 0..COUNT {
        let (angle, _) = ORDERS[order % ORDERS.len()];
        gcode += &format!("M280 P0 S{angle}\n");
        let first = CHORDS_BEFORE + order * CHORDS_AN_ORDER;
        gcode.extend((first..first + CHORDS_AN_ORDER).map(at));
    }
    gcode + "M400\n"
}

/// P1 of a BLTouch: whatever steps and fans do, a pulse is the one that was ordered.
#[test]
fn orders_keep_their_length_while_the_machine_prints_fast() {
    let bench = bench_of(machine_file::load(BLTOUCH).unwrap());
    let seen = print_on(&firmware(), &circles(), &bench);
    assert_eq!((seen.end, &seen.line.failure), (End::Done, &None), "{:?}", seen.line.said);
    let order_of = |ns: u64| ORDERS.iter().position(|(_, us)| ns.abs_diff(us * 1000) <= TOLERANCE_NS);
    let mut orders: Vec<(usize, usize)> = Vec::new();
    let mut farthest = 0;
    for pulse in &seen.servo.pulses {
        let order = order_of(pulse.ns).unwrap_or_else(|| panic!("{pulse:?}"));
        farthest = farthest.max(pulse.ns.abs_diff(ORDERS[order].1 * 1000));
        match orders.last_mut() {
            Some((last, times)) if *last == order => *times += 1,
            _ => orders.push((order, 1)),
        }
    }
    // A BLTouch obeys after three.
    assert_eq!(orders.len(), COUNT, "{orders:?}");
    assert!(orders.iter().all(|(_, times)| (3..=6).contains(times)), "{orders:?}");
    let moving = seen.recorder.events.len() as f64 / (seen.virtual_ns as f64 / 1e9);
    println!(
        "{} pulses, farthest {farthest} ns off; {moving:.0} step events a second; {:.1} s in {:.1} s",
        seen.servo.pulses.len(),
        seen.virtual_ns as f64 / 1e9,
        seen.wall.as_secs_f64(),
    );
    assert!(moving > 20_000.0, "{moving} step events a second");
}

/// The pin is left alone without a BLTouch.
#[test]
fn a_machine_without_a_bltouch_never_drives_the_line() {
    for file in ["", "[endstops]\nprobe = \"BLTOUCH\"\n[probe]\nkind = \"switch\"\n"] {
        let bench: Bench<'_> = bench_of(machine_file::load(file).unwrap());
        let seen = print_on(&firmware(), "M280 P0 S647\nG4 P300\n", &bench);
        assert!(!seen.servo.is_driven && seen.servo.pulses.is_empty());
    }
}
