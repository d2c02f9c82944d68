//! Filament beyond 32 bits of steps: a long print continues to extrude after a stop.

use crate::common::lines::Lines;
use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::world::{Sink, run};

/// Counts the steps of the extruder.
#[derive(Default)]
struct Extruder(i64);

impl Sink for Extruder {
    fn event(&mut self, _tick: u64, steps: MotorSet, forward: MotorSet) {
        if steps.has(prototype::E0) {
            self.0 += if forward.has(prototype::E0) { 1 } else { -1 };
        }
    }
}

/// Extrudes `metres` of filament at a step a millimetre, then these lines at the finest resolution; returns the
/// messages, and the steps.
fn print(metres: u32, lines: &[&str]) -> (Vec<String>, i64) {
    let mut all: Vec<String> = ["M92 E1", "M203 E1000", "M83"].map(String::from).to_vec();
    all.extend((0..10 * metres).map(|_| "G1 E100 F60000".to_owned()));
    all.extend(["M203 E15", "M92 E25600"].map(String::from));
    all.extend(lines.iter().map(|line| (*line).to_owned()));
    let mut host = Lines::new(all);
    let (start, mut extruder) = (Some([100, 100, 10].map(Mm::from_num)), Extruder::default());
    run(&Settings::prototype(), start, &mut host, &mut extruder).unwrap();
    let before = i64::from(metres) * 1000;
    (host.heard.into_iter().filter(|line| line.starts_with("X:")).collect(), extruder.0 - before)
}

/// Reproducer for more than 2^31 steps, 84 m at this resolution. Homing and M410 read the filament as 168 m less; the
/// next absolute move, which then asked for that much, was made without it.
#[test]
fn a_long_print_goes_on_extruding() {
    for metres in [83, 84] {
        let at = 1000 * metres;
        let (first, second) = (format!("G1 X110 E{}.5 F3000", at), format!("G1 X130 E{} F3000", at + 2));
        for stop in ["G28 X", "M410", "M400"] {
            let lines = [
                "M82",
                first.as_str(),
                "M400",
                stop,
                "M114",
                "M114 R",
                "G1 X120 F3000",
                second.as_str(),
                "M400",
                "M114 R",
            ];
            let (told, steps) = print(metres, &lines);
            assert!(told[0].contains(&format!(" E:{at}.50 ")), "{stop}: {told:?}");
            assert!(told[1].contains(&format!(" E:{at}.50 ")), "{stop}: {told:?}");
            assert!(told[2].contains(&format!(" E:{}.00 ", at + 2)), "{stop}: {told:?}");
            assert_eq!(steps, 2 * 25_600, "{stop} after {metres} m");
        }
    }
}
