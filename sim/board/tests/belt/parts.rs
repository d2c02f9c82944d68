//! Parts that break in a print: pulleys, screws, teeth and cords. What the firmware notices, what it repairs, and what
//! it misses.

use crate::belt::printer::{of_each, print, print_as, seeds};
use crate::belt::trust::told_place;
use corehbot::settings::Settings;
use corehbot_sim::accident::{Family, Row};
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::belt::figures::BeltFigures;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_twin::random::Random;
use std::collections::BTreeMap;

/// A full step, in mm.
const FULL_STEP_MM: f64 = 0.2;

/// Strain that a motor cannot be trimmed out of, in mm, with much to spare.
const STRAINED_MM: f64 = 0.1;

/// Motion time when the first M915 is over and the print is under way, and the length of the print, in s.
const PRINTS_S: [f64; 2] = [58.0, 8.0];

/// These accidents of parts, of these motors and pulleys.
fn parts(accidents: &[&str]) -> Accidents {
    let parts = accidents.iter().map(|accident| accident.parse().unwrap()).collect();
    Accidents { parts, ..Accidents::default() }
}

/// A machine with phases of a seed that prints these lines, and what was heard.
fn life(seed: u64, accidents: &[&str], lines: &[&str]) -> (Vec<String>, Box<BeltPlant>) {
    let setup = BeltSetup { seed: Some(seed), accidents: parts(accidents), ..BeltSetup::default() };
    let mut plant = Some(Box::new(BeltPlant::new(&Settings::prototype(), None, false, setup, 0).unwrap()));
    let printed = print_as(&Settings::prototype(), &mut plant, None, lines);
    let mut plant = plant.unwrap();
    plant.ring_out();
    (printed.heard, plant)
}

/// How far the tool is from where the firmware says, and the belt's strain.
fn errors(heard: &[String], plant: &BeltPlant) -> (f64, f64) {
    let ([x, y], residual) = (plant.tool_mm(), plant.figures().residual_mm.unwrap());
    // Without a place nothing is called right.
    let off = told_place(heard).map_or(f64::INFINITY, |[to_x, to_y]| (x - to_x).abs().max((y - to_y).abs()));
    (off, residual.abs())
}

fn short(accidents: &[&str]) -> BeltFigures {
    short_with(accidents, &["G1 X195 Y208.8 F6000", "G1 X185 Y198.8", "M400", "G4 P500"])
}

fn short_with(accidents: &[&str], lines: &[&str]) -> BeltFigures {
    let (_, mut plant) = print(Some([175.0, 188.8, 10.0]), parts(accidents), lines);
    plant.ring_out();
    plant.figures()
}

/// While the belt's motors rest, accidents once waited for their next step: one that was long over held the motor then.
#[test]
fn a_part_fails_and_mends_in_a_rest_of_the_belt() {
    // The first diagonal takes 0.3 s, the rest 2 s.
    for rest in ["G4 P2000", "G1 Z20 F300"] {
        let lines = ["G1 X195 Y208.8 F6000", rest, "G1 X185 Y198.8 F6000", "M400", "G4 P500"];
        let brief = short_with(&["seized:m4@0.8s+1s"], &lines);
        assert_eq!(brief.accidents[0].began_s, Some(0.8));
        assert!(brief.skips.is_empty() && brief.off_mm.unwrap() < 0.01, "{rest}: {brief}");
        // One that outlasts the rest, or is for good, stalls the motor behind it.
        for lasts in ["+2s", ""] {
            let seized = short_with(&[&format!("seized:m4@0.8s{lasts}")], &lines);
            assert!(seized.skips.iter().all(|skip| skip.time_s > 2.0) && !seized.skips.is_empty(), "{rest}: {seized}");
        }
        let twice = short_with(&["loose:m11:+1N@0.8s+0.5s", "loose:m11:+1N@1.5s+0.5s"], &lines);
        assert_eq!(twice.accidents.iter().map(|part| part.began_s).collect::<Vec<_>>(), [Some(0.8), Some(1.5)]);
        assert!(twice.accidents[0].belt_ahead_mm.unwrap().abs() < 0.001, "{rest}: {twice}");
    }
}

#[test]
fn a_part_fails_when_its_time_has_come_and_mends_when_that_is_over() {
    // Motors 4 and 11 drive this diagonal, and each bears a little of the head's inertia and friction.
    let sound = short(&[]);
    assert!(sound.accidents.is_empty() && sound.off_mm.unwrap() < 0.01, "{sound}");
    let later = short(&["jump:m4@100s"]);
    assert_eq!((later.accidents[0].began_s, later.off_mm), (None, sound.off_mm));
    // A seized motor skips against the three others; released in time it catches up.
    let seized = short(&["seized:m4@0.1s"]);
    assert!(seized.skips.iter().any(|skip| skip.motor.as_str() == "m4"), "{seized}");
    let brief = short(&["seized:m4@0.1s+0.002s"]);
    assert!(brief.skips.is_empty() && brief.off_mm.unwrap() < 0.01, "{brief}");
    assert_eq!(brief.accidents[0].began_s, Some(0.1));
    // So does one that friction holds as briefly, in today's words and in earlier ones.
    for text in ["rub:m4:1000N@0.1s+0.002s", "m4,1000,0.1,2"] {
        let rubbed = short(&[text]);
        assert_eq!((rubbed.accidents[0].began_s, rubbed.off_mm), (Some(0.1), brief.off_mm));
    }
    // A pulley that slips forward leaves the belt behind its motor, and only while its screw is loose.
    let loose = short(&["loose:m11:+1N@0s+0.15s"]);
    let behind = loose.accidents[0].belt_ahead_mm.unwrap();
    assert!(behind < -0.001 && loose.skips.is_empty(), "{loose}");
    let [x, y] = loose.off_xy_mm.unwrap();
    // Motor 11 turns for x + y; a quarter of what it lacks each, as the three others hold.
    assert!((x - behind / 4.0).abs() < 0.02 && (y - behind / 4.0).abs() < 0.02, "{loose}");
    // An idler on the bar over which the belt slides; the tool is held back less than a full step.
    let dragged = short(&["seized:7@0s"]);
    let off = dragged.largest_off_mm;
    assert!(dragged.skips.is_empty() && off > sound.largest_off_mm && off < FULL_STEP_MM, "{dragged}");
    // Half of the cords: the tool gives way more to its own inertia.
    let soft = short(&["cord:m8:50@0s"]);
    assert!(soft.largest_off_mm > 1.1 * sound.largest_off_mm && soft.skips.is_empty(), "{soft}");
}

/// The first print loses a tooth; M915 R repairs it, and the second print is where it should be.
#[test]
fn a_jumped_tooth_is_told_and_repaired_before_the_next_print() {
    let begin = ["G28", "G1 Z5 F900", "M915", "G1 X175 Y188.8 F9000", "G1 X195 Y208.8 F6000", "G1 X100 Y150", "M400"];
    let end = ["M915 R", "G1 X220 Y90 F9000", "G1 X150 Y150", "M400", "M114", "M122"];
    let lines: Vec<&str> = begin.into_iter().chain(end).collect();
    let (heard, plant) = life(7, &["jump:m11@57.4s"], &lines);
    let has = |text: &str| heard.iter().any(|line| line.contains(text));
    assert!(has("echo:belt motors aligned") && has("the tool is off its position by X"), "{heard:#?}");
    assert!(has("belt repaired") && has("Belt: motors aligned"), "{heard:#?}");
    let (off, strain) = errors(&heard, &plant);
    assert!(off < 0.04 && strain < 0.0125, "{off} {strain} {heard:#?}");
    assert_eq!(plant.figures().accidents[0].belt_ahead_mm, Some(2.0));
}

/// M915 D tells it, repairs nothing and trusts nothing. A second one has nothing to compare with. M915 makes it good.
#[test]
fn a_jumped_tooth_is_told_by_a_diagnosis_alone() {
    let begin = ["G28", "G1 Z5 F900", "M915", "G1 X175 Y188.8 F9000", "G1 X195 Y208.8 F6000", "G1 X100 Y150", "M400"];
    let told: Vec<&str> = begin.into_iter().chain(["M915 D", "M122", "M915 D"]).collect();
    let (heard, plant) = life(7, &["jump:m11@57.4s"], &told);
    let count = |heard: &[String], text: &str| heard.iter().filter(|line| line.contains(text)).count();
    assert_eq!(count(&heard, "echo:the tool is off its position by X"), 1, "{heard:#?}");
    // A tooth is 10 full steps: more than the belt can be strained by, so other motors skip too.
    assert_eq!(count(&heard, "echo:more than one skip: which motors cannot be told (M915 aligns)"), 1, "{heard:#?}");
    assert_eq!(count(&heard, "Belt: motors not aligned"), 1, "{heard:#?}");
    assert_eq!(count(&heard, "echo:nothing to compare with"), 1, "{heard:#?}");
    assert_eq!(count(&heard, "no motor has skipped") + count(&heard, "belt repaired"), 0, "{heard:#?}");
    assert_eq!(plant.figures().accidents[0].belt_ahead_mm, Some(2.0));
    let again = ["M915", "M915 D", "G1 X220 Y90 F9000", "G1 X150 Y150", "M400", "M114"];
    let lines: Vec<&str> = told.into_iter().chain(again).collect();
    let (heard, plant) = life(7, &["jump:m11@57.4s"], &lines);
    assert_eq!((count(&heard, "belt motors aligned"), count(&heard, "no motor has skipped")), (2, 1), "{heard:#?}");
    let (off, strain) = errors(&heard, &plant);
    assert!(off < 0.04 && strain < 0.0125, "{off} {strain} {heard:#?}");
}

/// How a story of an accident ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum End {
    /// The firmware says that something is wrong, and trusts nothing.
    Noticed,
    /// It repaired something, and all is right.
    Repaired,
    /// It noticed nothing, and nothing is wrong.
    Harmless,
    /// It trusts a place or a belt that is wrong.
    Missed,
}

/// The kinds that the study draws from, with their numbers.
const DRAWN: [&str; 6] = ["jump", "loose", "seized motor", "seized pulley", "cord", "rub"];

/// A random accident of this kind in the print.
fn drawn(kind: &str, random: &mut Random) -> Accidents {
    let mut between = |[least, most]: [f64; 2]| least + (most - least) * random.unit();
    let at_s = PRINTS_S[0] + between([0.0, PRINTS_S[1]]);
    let motor = ["m1", "m4", "m8", "m11"][between([0.0, 3.999]) as usize];
    // All idlers of a CoreH-bot.
    let idler = [2, 3, 5, 6, 7, 9, 10, 12, 13, 14][between([0.0, 9.999]) as usize];
    let sign = ["", "+", "-"][between([0.0, 2.999]) as usize];
    let part = match kind {
        "jump" => format!("jump:{motor}:{}@{at_s:.3}s", if sign == "-" { -1 } else { 1 }),
        "loose" => format!("loose:{motor}:{sign}{:.1}N@{at_s:.3}s", between([1.0, 30.0])),
        "seized motor" => format!("seized:{motor}@{at_s:.3}s+{:.3}s", between([0.005, 0.5])),
        "seized pulley" => format!("seized:{idler}@{at_s:.3}s"),
        "cord" => format!("cord:{motor}:{:.0}%@{at_s:.3}s", between([20.0, 90.0])),
        _ => {
            let (force_n, ms) = (between([10.0, 150.0]), between([100.0, 5000.0]));
            format!("rub:{motor}:{force_n:.0}N@{at_s:.3}s+{:.3}s", ms / 1000.0)
        }
    };
    parts(&[&part])
}

struct Story {
    kind: &'static str,
    end: End,
    says: String,
}

fn story(seed: u64) -> Story {
    // All kinds in turn.
    let kind = DRAWN[seed as usize % DRAWN.len()];
    let mut random = Random::new(seed, 0x7061_7274); // "part"
    let accidents = drawn(kind, &mut random);
    let says = format!("{:?}", accidents.parts.iter().map(|part| &part.text).collect::<Vec<_>>());
    let mut lines: Vec<String> = ["G28", "G1 Z5 F900", "M915"].map(str::to_owned).to_vec();
    // A zigzag at 100 mm/s.
    for _ in 0..14 {
        let (x, y) = (40.0 + 300.0 * random.unit(), 40.0 + 300.0 * random.unit());
        lines.push(format!("G1 X{x:.2} Y{y:.2} F12000"));
    }
    // The second print.
    lines.extend(["M915 R", "G1 X150 Y150 F3000", "G1 X200 Y200 F9000", "G1 X150 Y150", "M400"].map(str::to_owned));
    lines.extend(["M122", "M114"].map(str::to_owned));
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    let setup = BeltSetup { seed: Some(seed), accidents, ..BeltSetup::default() };
    let mut plant = Some(Box::new(BeltPlant::new(&Settings::prototype(), None, false, setup, 0).unwrap()));
    let heard = print_as(&Settings::prototype(), &mut plant, None, &lines).heard;
    let mut plant = plant.unwrap();
    plant.ring_out();
    let has = |text: &str| heard.iter().any(|line| line.contains(text));
    let is_trusted = (has("no motor has skipped") || has("belt repaired")) && has("Belt: motors aligned");
    let (off, strain) = errors(&heard, &plant);
    let end = match (is_trusted, off <= FULL_STEP_MM && strain < STRAINED_MM) {
        (false, _) => End::Noticed,
        (true, false) => End::Missed,
        (true, true) if has("belt repaired") => End::Repaired,
        (true, true) => End::Harmless,
    };
    let told: Vec<&String> = heard.iter().filter(|line| line.starts_with("echo:") || line.contains("rror")).collect();
    Story { kind, end, says: format!("{seed}: {says} {end:?}, off {off:.3}, strain {strain:.3}, {told:?}") }
}

/// `cargo xtask soak belt` runs 1,000 such cases and prints the table of docs/explanation/belt/checks.md.
#[test]
fn parts_that_break_are_noticed_or_repaired_unless_a_screw_is_loose() {
    let stories = of_each(seeds(3), story);
    let mut ends: BTreeMap<(&str, End), usize> = BTreeMap::new();
    for Story { kind, end, .. } in &stories {
        *ends.entry((*kind, *end)).or_default() += 1;
    }
    for ((kind, end), count) in &ends {
        println!("{kind}: {end:?} {count}");
    }
    for story in stories.iter().filter(|story| story.end == End::Missed) {
        println!("{}", story.says);
    }
    // No accident of belts is left out.
    for row in Row::of(Family::Belts) {
        assert!(DRAWN.iter().any(|kind| kind.split(' ').next() == Some(row.word)), "{} is never drawn", row.word);
    }
    // A pulley that begins to slip again after the proof is told by nothing.
    let missed: Vec<&str> =
        stories.iter().filter(|s| s.end == End::Missed && s.kind != "loose").map(|s| s.kind).collect();
    assert!(missed.is_empty(), "{missed:?}");
    // The same seed has the same accident and the same end.
    assert_eq!(story(0).says, stories[0].says);
}
