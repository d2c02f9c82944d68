//! The image turns the twin's belt. It aligns the motors by the loads that drivers report over their wires, and makes
//! the steps of the simulator.

use crate::common::{Bench, firmware, print_on};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot_emulator::compare::{difference, scheduled_with};
use corehbot_emulator::watch::End;
use corehbot_sim::belt::BeltSetup;

/// A sixteenth of a full step, in mm.
const SIXTEENTH_MM: f64 = 0.2 / 16.0;

#[test]
fn the_image_aligns_the_motors_of_a_belt() {
    let setup = BeltSetup { seed: Some(3), ..BeltSetup::default() };
    let bench = Bench { belt: Some(setup.clone()), ..Bench::default() };
    // Without power the rotors go where the belt takes them; with it they are aligned by the phase that M915 found.
    // M915 homes X and Y itself.
    let gcode = "M915\nM84\nM17\nM122\nG1 X20 F6000\nM400\n";
    let seen = print_on(&firmware(), gcode, &bench);
    assert_eq!((seen.end, seen.line.failure.as_ref()), (End::Done, None), "{:?}", seen.line.said);
    assert!(seen.line.said.iter().any(|line| line.contains("belt motors aligned")), "{:?}", seen.line.said);
    assert!(seen.line.said.iter().any(|line| line.contains("Belt: motors aligned")), "{:?}", seen.line.said);
    let figures = seen.belt.unwrap();
    assert!(figures.skips.is_empty() && figures.residual_mm.unwrap().abs() <= SIXTEENTH_MM, "{figures}");
    let host = scheduled_with(gcode, &Settings::prototype(), NoStorage, Some(&setup)).unwrap();
    let difference = difference(&seen.recorder.events, &host);
    assert!(difference.is_none(), "{}", difference.unwrap());
    assert_eq!((seen.recorder.split_pairs, seen.recorder.unpowered), (0, 0));
}
