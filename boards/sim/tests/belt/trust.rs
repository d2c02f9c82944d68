//! Trust: whatever befalls the motors, how often and when, a place that the firmware says is right is right to a full step, and a belt
//! that it calls aligned is not strained.
//!
//! No driver tells of a skip, so a place is trusted for no longer than its proof: what M915 D or R has just said. M122 tells how
//! long ago the switches were met.

use crate::printer::{of_each, plant_of, print_as, seeds};
use corehbot::settings::Settings;
use corehbot_sim::belt::accident::{Accidents, Brake};
use corehbot_twin::params::Params;
use corehbot_twin::sampling::random::Random;

/// Where the tool stands when the machine is switched on.
const START: [f64; 3] = [60.0, 40.0, 10.0];

/// A full step, in mm.
const FULL_STEP_MM: f64 = 0.2;

/// Motion time of the whole dialogue, in s: accidents come at any moment of it.
const ALL_S: f64 = 140.0;

/// One to three motors that are held for a moment, some time.
fn accidents(random: &mut Random) -> Vec<Brake> {
    let mut accident = || {
        let name = ["m1", "m4", "m8", "m11"][(random.unit() * 4.0) as usize % 4];
        let (force, from, ms) = (100.0 + 100.0 * random.unit(), ALL_S * random.unit(), 5.0 + 25.0 * random.unit());
        format!("{name},{force:.0},{from:.3},{ms:.1}").parse().unwrap()
    };
    let first: Brake = accident();
    let count = (first.force_n as usize) % 3;
    std::iter::once(first).chain((0..count).map(|_| accident())).collect()
}

/// The place that M114 tells, in x and y.
fn told_place(heard: &[String]) -> Option<[f64; 2]> {
    let line = heard.iter().rev().find(|line| line.starts_with("X:"))?;
    let number = |name| line.split_once(name)?.1.split(' ').next()?.parse().ok();
    Some([number("X:")?, number("Y:")?])
}

/// A story, and whether the firmware said in the end that all is well.
struct Story {
    is_trusted: bool,
    skips: usize,
    off_mm: [f64; 2],
    residual_mm: f64,
    heard: Vec<String>,
}

fn story(seed: u64) -> Story {
    let mut random = Random::new(seed, 0x7472_7573);
    let brakes = accidents(&mut random);
    let mut lines: Vec<String> = vec!["M915".into()];
    // A zigzag of 25 s at 100 mm/s, each way another.
    for _ in 0..40 {
        let (x, y) = (40.0 + 300.0 * random.unit(), 40.0 + 300.0 * random.unit());
        lines.push(format!("G1 X{x:.2} Y{y:.2} F12000"));
    }
    let (last, said) =
        if random.unit() < 0.5 { ("M915 D", "no motor has skipped") } else { ("M915 R", "belt repaired") };
    lines.extend([last, "M17", "M400", "M122", "M114"].map(str::to_owned));
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let mut plant = plant_of(Params::default(), START, seed, Accidents { brakes, ..Accidents::default() });
    let printed = print_as(&Settings::prototype(), &mut plant, Some(START), &lines);
    let mut plant = plant.unwrap();
    plant.ring_out();
    let has = |text: &str| printed.heard.iter().any(|line| line.contains(text));
    let is_trusted = (has(said) || has("no motor has skipped")) && has("Belt: motors aligned");
    let [x, y] = plant.tool_mm();
    let [to_x, to_y] = told_place(&printed.heard).unwrap();
    let figures = plant.figures();
    Story {
        is_trusted,
        skips: figures.skips.len(),
        off_mm: [x - to_x, y - to_y],
        residual_mm: figures.residual_mm.unwrap(),
        heard: printed.heard.into_iter().filter(|line| line != "ok").collect(),
    }
}

/// `cargo xtask soak belt` tells 1,000 such stories.
#[test]
fn a_place_that_is_said_to_be_right_is_right_to_a_full_step() {
    let stories = of_each(seeds(4), story);
    for (seed, Story { is_trusted, skips, off_mm: [x, y], residual_mm, heard }) in stories.iter().enumerate() {
        let is_right = x.abs() <= FULL_STEP_MM && y.abs() <= FULL_STEP_MM && residual_mm.abs() < 0.1;
        assert!(
            !is_trusted || is_right,
            "{seed}: off {x:.3} {y:.3}, residual {residual_mm:.3}, {skips} skips, {heard:#?}"
        );
    }
    let number = |what: fn(&Story) -> bool| stories.iter().filter(|story| what(story)).count();
    let (skipped, trusted) = (number(|s| s.skips > 0), number(|s| s.is_trusted));
    println!("{} stories, {skipped} with skips, {trusted} trusted", stories.len());
    assert!(number(|s| s.is_trusted) > 0 && number(|s| s.skips > 0) > 0);
}
