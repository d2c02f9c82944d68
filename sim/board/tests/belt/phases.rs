//! Phases: motors with drivers in the same relation as when nothing strained the belt are aligned, as soon as they get
//! power.

use crate::belt::printer::{Printed, of_each, plant_of, print_as, seeds};
use corehbot::motors::prototype;
use corehbot::settings::{Belt, Settings};
use corehbot::units::Mm;
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_twin::params::Params;
use std::sync::OnceLock;

/// Where the tool stands when the machine is switched on.
const START: [f64; 3] = [60.0, 40.0, 10.0];

/// A sixteenth of a full step, in mm.
const SIXTEENTH_MM: f64 = 0.2 / 16.0;

fn print_at(settings: &Settings, start: [f64; 3], seed: u64, lines: &[&str]) -> (Printed, Box<BeltPlant>) {
    let mut plant = plant_of(Params::default(), start, seed, Accidents::default());
    let printed = print_as(settings, &mut plant, Some(start), lines);
    let mut plant = plant.unwrap();
    plant.ring_out();
    (printed, plant)
}

fn has(printed: &Printed, text: &str) -> bool {
    printed.heard.iter().any(|line| line.contains(text))
}

/// The phase that M915 has found, as M503 says it.
fn phase_of(printed: &Printed) -> Option<u16> {
    let line = printed.heard.iter().find_map(|line| line.split_once("aligned at a phase of "))?;
    line.1.split('/').next()?.parse().ok()
}

fn with_phase(phase: u16) -> Settings {
    let mut settings = Settings::prototype();
    settings.belt.phases = [phase, Belt::NO_PHASE];
    settings
}

/// One machine (its seed), aligned by load once, is switched on again, with its tool anywhere. It takes no motion and
/// no second.
#[test]
fn a_machine_that_was_aligned_once_is_aligned_whenever_it_is_switched_on() {
    let found = of_each(seeds(2), |seed| {
        let (learned, _) = print_at(&Settings::prototype(), START, seed, &["M915", "M503"]);
        let phase = phase_of(&learned).unwrap_or_else(|| panic!("{seed}: {:?}", learned.heard));
        assert!(has(&learned, "M500 stores it"), "{seed}: {:?}", learned.heard);
        // Somewhere else, where rotors find other places in their turns, but belt and pulleys are the same.
        let place = [60.0 + 13.7 * (seed % 7) as f64, 40.0 + 9.1 * (seed % 5) as f64, 10.0];
        let without = print_at(&Settings::prototype(), place, seed, &["M17", "G4 P500"]);
        let (printed, plant) = print_at(&with_phase(phase), place, seed, &["M17", "G4 P500", "M122"]);
        let figures = plant.figures();
        assert!(
            has(&printed, "Belt: motors aligned") && figures.skips.is_empty(),
            "{seed}: {:?} {figures}",
            printed.heard
        );
        (without.1.figures().residual_mm.unwrap().abs(), figures.residual_mm.unwrap().abs())
    });
    let worst = |part: fn(&(f64, f64)) -> f64| found.iter().map(part).fold(0.0, f64::max);
    println!("residual: {:.4} mm at worst without phases, {:.4} with", worst(|f| f.0), worst(|f| f.1));
    assert!(worst(|f| f.1) <= SIXTEENTH_MM && worst(|f| f.0) > 0.1, "{found:?}");
}

/// The machine of seed 3 as M915 knows it.
fn third_machine() -> Settings {
    static PHASE: OnceLock<u16> = OnceLock::new();
    let learn = || phase_of(&print_at(&Settings::prototype(), START, 3, &["M915", "M503"]).0).unwrap();
    with_phase(*PHASE.get_or_init(learn))
}

/// Power goes and comes, as after M84, and the tool was pushed elsewhere in between.
#[test]
fn motors_that_lost_power_are_aligned_when_they_get_it_again() {
    let settings = third_machine();
    let mut plant = plant_of(Params::default(), START, 3, Accidents::default());
    let lines = [
        "M17",
        "G1 X90.04 F6000",
        "M84",
        "G4 P300",
        "M122",
        "M17",
        "G4 P500",
        "M122",
        "G28 X Y",
        "G1 X100 Y100",
        "M400",
    ];
    let printed = print_as(&settings, &mut plant, Some(START), &lines);
    let mut plant = plant.unwrap();
    plant.ring_out();
    let told: Vec<_> = printed.heard.iter().filter(|line| line.starts_with("Belt: motors")).collect();
    assert!(
        told.len() == 2 && told[0].contains("not aligned") && !told[1].contains("not aligned"),
        "{:?}",
        printed.heard
    );
    assert!(plant.figures().residual_mm.unwrap().abs() <= SIXTEENTH_MM, "{}", plant.figures());
    let [x, y] = plant.tool_mm();
    assert!((x - 100.0).abs() < 0.03 && (y - 100.0).abs() < 0.03, "{x} {y}");
}

#[test]
fn a_motor_that_is_plugged_the_other_way_round_counts_the_other_way_round() {
    let mut reversed = Settings::prototype();
    for motor in [prototype::M4, prototype::M11] {
        reversed.wiring.motors[motor.index()].is_reversed = true;
    }
    let plant_of = |settings: &Settings| {
        let setup = BeltSetup { seed: Some(11), ..BeltSetup::default() };
        Some(Box::new(BeltPlant::new(settings, Some(START.map(Mm::from_num)), true, setup, 0).unwrap()))
    };
    let learned = print_as(&reversed, &mut plant_of(&reversed), Some(START), &["M915", "M503"]);
    let mut settings = reversed;
    settings.belt.phases = [phase_of(&learned).unwrap(), Belt::NO_PHASE];
    let mut plant = plant_of(&settings);
    let printed = print_as(&settings, &mut plant, Some(START), &["M17", "G4 P500", "M122"]);
    let mut plant = plant.unwrap();
    plant.ring_out();
    assert!(has(&printed, "Belt: motors aligned"), "{:?}", printed.heard);
    assert!(plant.figures().residual_mm.unwrap().abs() <= SIXTEENTH_MM, "{}", plant.figures());
}

/// A rigid machine's drivers do not count, so nothing is known, and it is said; the tool is where it was.
#[test]
fn drivers_that_do_not_count_are_told_of_and_nothing_is_moved() {
    let printed = print_as(&with_phase(300), &mut None, Some(START), &["M17", "M122", "G1 X70 F6000", "M400", "M114"]);
    assert!(has(&printed, "echo:belt motors not aligned: their drivers do not count"), "{:?}", printed.heard);
    assert!(
        has(&printed, "Belt: motors not aligned") && has(&printed, "X:70.00 Y:40.00 Z:10.00"),
        "{:?}",
        printed.heard
    );
    // One motor went and came back; all stand as the move says.
    let [m1, m4, m8, m11, ..] = printed.outcome.counts;
    assert_eq!((m1, m4, m8, m11), (-800, -800, 800, 800));
}

/// The preload of the settings is on top of the phase.
#[test]
fn a_preload_is_left_in_the_belt_by_phases_too() {
    for preload in [-0.05, 0.05] {
        let mut settings = third_machine();
        settings.belt.preload = Mm::from_num(preload);
        let (_, plant) = print_at(&settings, START, 3, &["M17", "G4 P500"]);
        let residual = plant.figures().residual_mm.unwrap();
        assert!((residual - preload).abs() < 0.025 && residual * preload > 0.0, "{residual}");
    }
}
