//! Alignment: motors that strain the belt are turned until they do not, or the host is told that it failed.

use crate::belt::printer::{Printed, of_each, plant_of, print_as, print_on, seeds};
use corehbot::kinematics::Mechanism;
use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::{Alignment, Settings};
use corehbot::units::Mm;
use corehbot_sim::belt::BeltPlant;
use corehbot_sim::belt::accident::Accidents;
use corehbot_twin::params::Params;

/// Where the tool stands when the machine is switched on.
const START: [f64; 3] = [60.0, 40.0, 10.0];

/// A sixteenth of a full step, in mm.
const SIXTEENTH_MM: f64 = 0.2 / 16.0;

/// A belt of 0.5 to 2 times the nominal stiffness, by the seed.
fn params_of(seed: u64) -> Params {
    let mut params = Params::default();
    let part = (seed * 7 % 16) as f64 / 15.0;
    params.belt_ea_n = params.belt_ea_n.times(0.5 * 4.0_f64.powf(part));
    params
}

fn print(settings: &Settings, seed: u64, lines: &[&str]) -> (Printed, Box<BeltPlant>) {
    let mut plant = plant_of(params_of(seed), START, seed, Accidents::default());
    let printed = print_as(settings, &mut plant, Some(START), lines);
    (printed, plant.unwrap())
}

fn has(printed: &Printed, text: &str) -> bool {
    printed.heard.iter().any(|line| line.contains(text))
}

/// Random phases, belts from half to twice as stiff, loads with noise and with the driver's rounding: aligned within a
/// sixteenth of a full step, or reported as failed. `cargo xtask soak belt` does so with 1,000 seeds.
#[test]
fn aligned_motors_strain_the_belt_by_a_sixteenth_of_a_full_step_at_most() {
    let settings = Settings::prototype();
    let found = of_each(seeds(8), |seed| {
        let before = print(&settings, seed, &["M17", "G4 P500"]).1.figures().residual_mm.unwrap();
        let (printed, mut plant) = print(&settings, seed, &["M915", "M400"]);
        plant.ring_out();
        let figures = plant.figures();
        assert!(figures.skips.is_empty(), "{seed}: {figures}");
        (before, figures.residual_mm.unwrap(), has(&printed, "belt motors aligned"))
    });
    let aligned: Vec<f64> =
        found.iter().filter(|(.., is_aligned)| *is_aligned).map(|(_, after, _)| after.abs()).collect();
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, number) = values.fold((0.0, 0), |(sum, number), v| (sum + v * v, number + 1));
        (sum / f64::from(number)).sqrt()
    };
    let (before, after) = (rms(&mut found.iter().map(|(before, ..)| *before)), rms(&mut aligned.iter().copied()));
    let worst = aligned.iter().copied().fold(0.0, f64::max);
    println!(
        "{} of {} aligned: {before:.4} mm RMS before, {after:.4} after, worst {worst:.4}",
        aligned.len(),
        found.len()
    );
    assert!(worst <= SIXTEENTH_MM, "{found:?}");
    assert!(aligned.len() * 100 >= found.len() * 99, "{found:?}");
    assert!(before > 10.0 * after, "{before} {after}");
}

#[test]
fn a_preload_is_left_in_the_belt() {
    let mut settings = Settings::prototype();
    for preload in [-0.05, 0.05] {
        settings.belt.preload = Mm::from_num(preload);
        let (printed, mut plant) = print(&settings, 3, &["M915", "M400"]);
        assert!(has(&printed, "belt motors aligned"), "{:?}", printed.heard);
        plant.ring_out();
        // Fields give way, so rotors deviate by less.
        let residual = plant.figures().residual_mm.unwrap();
        assert!((residual - preload).abs() < 0.025 && residual * preload > 0.0, "{residual}");
    }
}

/// Later lines act as if there had been no alignment: the same program leads the tool to the same place, and z has not
/// moved.
#[test]
fn the_machine_is_homed_and_as_it_was_after_it() {
    let lines = ["M915", "G1 X100 Y120 F6000", "M400", "M114", "M569", "M122"];
    let (printed, plant) = print(&Settings::prototype(), 5, &lines);
    assert!(has(&printed, "X:100.00 Y:120.00 Z:10.00"), "{:?}", printed.heard);
    assert!(has(&printed, "Belt: motors aligned") && has(&printed, "m1 - m4 + m8 - m11 was "), "{:?}", printed.heard);
    // Drivers measured in stealthChop, and are as the settings say again.
    assert!(has(&printed, "X driver mode: spreadCycle"), "{:?}", printed.heard);
    let [x, y] = plant.tool_mm();
    assert!((x - 100.0).abs() < 0.03 && (y - 120.0).abs() < 0.03, "{x} {y}");
    let [.., z1, z2, _] = printed.outcome.counts;
    assert_eq!((z1, z2), (0, 0));
}

#[test]
fn what_does_not_measure_cannot_align_and_says_so() {
    // A rigid machine's loads do not change.
    let rigid = print_on(&mut None, Some(START), &["M915", "M915 D", "M122", "G1 X50 F6000", "M400"]);
    assert!(has(&rigid, "not aligned: the loads that the drivers measure do not change"), "{:?}", rigid.heard);
    assert!(has(&rigid, "nothing to compare with") && has(&rigid, "Belt: motors not aligned"), "{:?}", rigid.heard);
    assert!(!rigid.outcome.halted);
    // Two motors for two axes have nothing to align.
    let mut settings = Settings::prototype();
    settings.mechanism = Mechanism::of(&[
        [0, 0, 0, 0],
        [0, 0, 0, 0],
        [1, -1, 0, 0],
        [1, 1, 0, 0],
        [0, 0, 1, 0],
        [0, 0, 1, 0],
        [0, 0, 0, 1],
    ]);
    settings.belt.is_closed = false;
    let corexy = print_as(&settings, &mut None, Some(START), &["M915", "M122"]);
    assert!(has(&corexy, "no motors of this machine can pull against each other"), "{:?}", corexy.heard);
    assert!(!has(&corexy, "Belt:"), "{:?}", corexy.heard);
}

/// Two motors of one portal, each with a belt or a screw of its own: strokes go where both of them turn.
#[test]
fn motors_that_turn_for_y_alone_are_measured_along_y() {
    let mut settings = Settings::prototype();
    settings.mechanism =
        Mechanism::of(&[[1, 0, 0, 0], [0; 4], [0, 1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]]);
    settings.belt.is_closed = false;
    let printed = print_as(&settings, &mut None, Some(START), &["M915", "M400"]);
    assert!(has(&printed, "not aligned: the loads that the drivers measure do not change"), "{:?}", printed.heard);
    let number = |motors: MotorSet| printed.events.iter().filter(|(_, steps, _)| *steps == motors.0).count();
    let both = MotorSet::of(prototype::M8).with(MotorSet::of(prototype::M11));
    // Three strains, a stroke of 60 mm there and back for each. Motor 1 is homed twice, from X60.
    assert!(number(both) > 3 * 2 * 60 * 80 && number(MotorSet::of(prototype::M1)) < 2 * 80 * 80, "{}", number(both));
}

#[test]
fn a_driver_that_falls_silent_ends_it_as_it_ends_a_print() {
    let drivers = corehbot_sim::drivers::Drivers::with_lines(prototype::ALL.without(MotorSet::of(prototype::M4)));
    let mut desk = corehbot_sim::world::Desk::new(1);
    let mut host = crate::belt::printer::Lines::new(["M915", "M400"]);
    let start = Some(START.map(Mm::from_num));
    let settings = Settings::prototype();
    let storage = corehbot::port::NoStorage;
    let mut events = crate::belt::printer::Events::default();
    let outcome =
        corehbot_sim::world::run_at(&mut desk, &settings, start, storage, &drivers, &mut [&mut host], &mut events)
            .unwrap();
    assert!(!outcome.halted);
    assert!(
        host.heard.iter().any(|line| line.contains("not aligned: its drivers cannot be asked")),
        "{:?}",
        host.heard
    );
}

/// The setting decides the effect of printing without alignment.
#[test]
fn printing_moves_are_told_of_refused_or_aligned_for() {
    let with = |alignment| {
        let mut settings = Settings::prototype();
        settings.belt.alignment = alignment;
        settings.thermal.min_extrude = corehbot::units::Celsius::ZERO;
        settings
    };
    let moves = ["G1 X70 F6000", "G1 X80 E1", "G1 X90 E2", "M400", "M114"];
    let (off, _) = print(&with(Alignment::Off), 1, &moves);
    assert!(has(&off, "X:90.00") && !has(&off, "aligned"), "{:?}", off.heard);
    let (warned, _) = print(&with(Alignment::Warning), 1, &moves);
    let told = warned.heard.iter().filter(|line| line.contains("not aligned (M915)")).count();
    assert!(has(&warned, "X:90.00") && told == 1, "{:?}", warned.heard);
    let (refused, _) = print(&with(Alignment::Required), 1, &moves);
    assert!(has(&refused, "X:70.00"), "{:?}", refused.heard);
    assert!(has(&refused, "echo:move ignored: align the belt motors first (M915)"), "{:?}", refused.heard);
    // G28 does it by itself, once; after a loss of power it is needed again.
    let lines = ["G28 X Y", "G28 X Y", "G1 X80 E1 F6000", "M400", "M114", "M84", "M122"];
    let (automatic, _) = print(&with(Alignment::Automatic), 1, &lines);
    let told = automatic.heard.iter().filter(|line| line.contains("belt motors aligned")).count();
    assert!(has(&automatic, "X:80.00") && told == 1, "{:?}", automatic.heard);
    assert!(has(&automatic, "Belt: motors not aligned since motors got power"), "{:?}", automatic.heard);
}

/// A motor is held while others are aligned, homed again or measured again. Then the belt is aligned, or the firmware
/// does not call it aligned. That holds for any known phase, and however often motors are asked to have power.
#[test]
fn a_skip_while_motors_are_aligned_is_noticed() {
    let phase = |printed: &Printed| {
        let said = printed.heard.iter().find_map(|line| line.split_once("aligned at a phase of "))?;
        said.1.split('/').next()?.parse::<u16>().ok()
    };
    let m915 = |settings: &Settings, parts| {
        let mut plant = plant_of(Params::default(), START, 3, Accidents { parts, ..Accidents::default() });
        let lines = ["M915", "M17", "G28 X Y", "G1 X100 Y120 F6000", "M400", "M122", "M503"];
        (print_as(settings, &mut plant, Some(START), &lines), plant.unwrap())
    };
    let mut settings = Settings::prototype();
    let (learned, _) = m915(&settings, vec![]);
    let known = phase(&learned).unwrap();
    settings.belt.phases[0] = known;
    let mut noticed = 0;
    for at_s in [8.0, 20.0, 38.0, 43.0] {
        let (printed, mut plant) = m915(&settings, vec![format!("rub:m11:190N@{at_s}s+0.025s").parse().unwrap()]);
        plant.ring_out();
        let (figures, [x, y]) = (plant.figures(), plant.tool_mm());
        let is_strained = figures.residual_mm.unwrap().abs() > SIXTEENTH_MM;
        let is_noticed = has(&printed, "belt motors not aligned: ");
        assert_eq!(is_noticed, is_strained, "{at_s}: {figures} {:?}", printed.heard);
        assert_eq!(has(&printed, "Belt: motors aligned"), !is_noticed, "{at_s}: {:?}", printed.heard);
        assert_eq!(has(&printed, "is correct now within"), !is_noticed, "{at_s}: {:?}", printed.heard);
        assert!(!is_noticed || phase(&printed) == Some(known), "{at_s}: {:?}", printed.heard);
        assert!((x - 100.0).abs() < 0.06 && (y - 120.0).abs() < 0.06, "{at_s}: {x} {y}");
        noticed += u32::from(is_noticed);
    }
    assert!(noticed >= 3, "{noticed}");
}
