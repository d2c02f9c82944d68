//! Arcs as slicers write them: rounded to their decimals, after moves with accumulated rounding. The oracle is the
//! circle that was rounded.

extern crate std;

use super::angle::TURN;
use super::arc::{Arc, ArcError, Shape, Way, split};
use crate::gcode::{ArcWords, Command, MoveCommand, parse_with};
use crate::machine::state::modal::Modal;
use crate::units::Mm;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::format;
use std::string::String;

/// How a program writes arcs.
#[derive(Clone, Copy, Debug)]
struct Writer {
    decimals: usize,
    inches: bool,
    /// R, or I and J.
    radius: bool,
    /// Whether trailing zeros, and the zero before the point, are left out (PrusaSlicer, Orca).
    short: bool,
}

/// ArcWelder and Slic3r, PrusaSlicer and Orca, Fusion in mm and inches, each with I and J or with R.
const WRITERS: [Writer; 8] = [
    Writer { decimals: 3, inches: false, radius: false, short: false },
    Writer { decimals: 3, inches: false, radius: false, short: true },
    Writer { decimals: 2, inches: false, radius: false, short: true },
    Writer { decimals: 4, inches: false, radius: false, short: false },
    Writer { decimals: 4, inches: true, radius: false, short: false },
    Writer { decimals: 3, inches: false, radius: true, short: true },
    Writer { decimals: 4, inches: false, radius: true, short: false },
    Writer { decimals: 5, inches: true, radius: true, short: false },
];

impl Writer {
    /// A length in mm as a number.
    fn number(self, mm: f64) -> String {
        let value = if self.inches { mm / 25.4 } else { mm };
        let text = format!("{value:.*}", self.decimals);
        if !self.short || !text.contains('.') {
            return text;
        }
        let text = text.trim_end_matches('0').trim_end_matches('.');
        text.replacen("0.", ".", usize::from(text.starts_with("0.") || text.starts_with("-0.")))
    }

    /// The last decimal in mm.
    fn last(self) -> f64 {
        10f64.powi(-(self.decimals as i32)) * if self.inches { 25.4 } else { 1.0 }
    }

    fn modal(self) -> Modal {
        Modal { inches: self.inches, ..Modal::new() }
    }

    /// The place that a line means.
    fn place(self, at: [f64; 2]) -> [Mm; 2] {
        at.map(|mm| {
            let text = self.number(mm);
            self.modal().length(crate::gcode::Number::read(text.as_bytes()).unwrap().0)
        })
    }

    /// The line of an arc.
    fn line(self, clockwise: bool, from: [f64; 2], to: [f64; 2], centre: [f64; 2], radius: f64) -> String {
        let [x, y, i, j] = [to[0], to[1], centre[0] - from[0], centre[1] - from[1]].map(|mm| self.number(mm));
        let code = if clockwise { "G2" } else { "G3" };
        if self.radius {
            format!("{code} X{x} Y{y} R{}", self.number(radius))
        } else {
            format!("{code} X{x} Y{y} I{i} J{j} E.1234567")
        }
    }

    /// The arc that the machine makes of a line, from a place.
    fn read(self, line: &str, start: [Mm; 2]) -> Result<Arc, ArcError> {
        let Command::Move(MoveCommand::Arc(ArcWords { clockwise, to, shape, turns, decimals, .. })) =
            parse_with(&[], line.as_bytes())
        else {
            panic!("{line}")
        };
        let modal = self.modal();
        let end = [to.x, to.y].map(|word| modal.length(word.unwrap()));
        let shape = Shape::new(shape, modal.plane, |number| modal.length(number))?;
        assert_eq!(split(modal.plane, [0, 1, 2, 3]).0, [0, 1]);
        Arc::new(start, end, shape, Way { clockwise, turns }, Mm::lit("0.005"), modal.rounding(decimals))
    }
}

/// A place at an angle of a circle.
fn on_circle(centre: [f64; 2], radius: f64, angle: f64) -> [f64; 2] {
    [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
}

fn turns_of(arc: &Arc) -> f64 {
    arc.sweep() as f64 / TURN as f64
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn an_arc_is_the_circle_that_was_rounded(
        writer in proptest::sample::select(&WRITERS[..]),
        clockwise: bool,
        centre in (20f64..180.0, 20f64..180.0),
        radius in 0.3f64..150.0,
        from in 0.0..TAU,
        sweep in prop_oneof![0.01f64..1.0, 0.5f64..3.0, 3.0f64..6.2],
        noise in -100i64..100,
    ) {
        let rounding = writer.modal().rounding(writer.decimals as u8).to_num::<f64>();
        let sweep = if writer.radius { sweep.min(3.0) } else { sweep };
        // Shorter arcs have no direction that their decimals could show.
        prop_assume!(2.0 * radius * (sweep / 2.0).sin().abs() > 8.0 * rounding.max(writer.last()));
        prop_assume!(radius * (TAU - sweep) > 8.0 * rounding.max(writer.last()));
        let centre = [centre.0, centre.1];
        let way = if clockwise { -1.0 } else { 1.0 };
        let (start, end) = (on_circle(centre, radius, from), on_circle(centre, radius, from + way * sweep));
        let line = writer.line(clockwise, start, end, centre, radius);
        // Relative moves have led there.
        let at = writer.place(start).map(|place| place + Mm::from_bits(noise));
        let arc = writer.read(&line, at);
        prop_assert!(arc.is_ok(), "{line}: {arc:?}");
        let arc = arc.unwrap();
        prop_assert_eq!(arc.point(arc.chords()), writer.place(end));
        // Half the chord over R is the sine of half the angle. With `part` for the rounding over R, the angle changes
        // by at most 16 part / (pi - angle). Near a half circle, where the sine is one, the bound is sqrt(20 part).
        let part = rounding.max(writer.last()) / radius;
        let near_half = (16.0 * part / (PI - sweep).max(1e-9)).min((20.0 * part).sqrt());
        let allowed = if writer.radius { near_half } else { 8.0 * part };
        let found = turns_of(&arc) * TAU * way;
        prop_assert!((found - sweep).abs() <= allowed + 1e-6, "{line}: {found} {sweep} {allowed}");
    }

    #[test]
    fn a_full_circle_is_one_wherever_rounding_has_led(
        writer in proptest::sample::select(&WRITERS[..5]),
        clockwise: bool,
        start in (20f64..180.0, 20f64..180.0),
        radius in 0.3f64..150.0,
        from in 0.0..TAU,
        steps in 1i64..200,
    ) {
        let start = writer.place([start.0, start.1]).map(|at| at.to_num::<f64>());
        let centre = on_circle(start, radius, from);
        let line = writer.line(clockwise, start, start, centre, radius);
        // As many relative steps as led there, each rounded to 2^-33 mm.
        let at = writer.place(start).map(|place| place + Mm::from_bits(steps - 100));
        let arc = writer.read(&line, at);
        prop_assert!(arc.is_ok(), "{line}: {arc:?}");
        prop_assert!((turns_of(&arc.unwrap()).abs() - 1.0).abs() < 1e-6, "{line}");
    }
}

/// Reproducer: 83 of 300 were dropped, as the slack was half a micrometre.
#[test]
fn no_half_circle_is_dropped_whatever_its_decimals() {
    let mut seed = 12_345u64;
    let mut dice = |least: f64, most: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        least + (most - least) * (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    for writer in WRITERS.into_iter().filter(|writer| writer.radius).chain([Writer { decimals: 2, ..WRITERS[5] }]) {
        for n in 0..300 {
            let (centre, radius, from) = ([dice(50.0, 150.0), dice(50.0, 150.0)], dice(0.5, 40.0), dice(0.0, TAU));
            let (start, end) = (on_circle(centre, radius, from), on_circle(centre, radius, from + PI));
            let clockwise = n % 2 == 0;
            let line = writer.line(clockwise, start, end, centre, radius);
            let arc = writer.read(&line, writer.place(start)).unwrap_or_else(|error| panic!("{line}: {error:?}"));
            let way = if clockwise { -0.5 } else { 0.5 };
            assert!((turns_of(&arc) - way).abs() < 1e-9, "{line}: {}", turns_of(&arc));
        }
    }
}

/// Reproducer: `G91`, `G1 X0.1` twice, `G90`, `G2 X100.2 Y100 I0 J5` was no circle, and 38 of 88 like it.
#[test]
fn no_full_circle_is_lost_behind_relative_moves() {
    for (step, decimals) in [(0.1, 1), (0.2, 1), (0.3, 1), (0.7, 1), (0.05, 2), (0.125, 3), (0.001, 3), (0.0003, 4)] {
        let text = format!("{step:.decimals$}");
        let (number, _) = crate::gcode::Number::read(text.as_bytes()).unwrap();
        let modal = Modal::new();
        let mut at = Mm::from_num(100);
        for n in 1..=88 {
            at += modal.length(number);
            let target = format!("{:.decimals$}", 100.0 + f64::from(n) * step);
            for code in ["G2", "G3"] {
                let line = format!("{code} X{target} Y100 I0 J5");
                let arc = WRITERS[0].read(&line, [at, Mm::from_num(100)]).unwrap();
                assert!((turns_of(&arc).abs() - 1.0).abs() < 1e-9, "{line}");
            }
        }
    }
}
