//! Skips: a motor with a rotor that lost its place is named, and its error is repaired.

use crate::belt::printer::{of_each, plant_of, print_as, seeds};
use corehbot::motors::MotorName;
use corehbot::settings::Settings;
use corehbot_sim::belt::accident::Accidents;
use corehbot_sim::belt::figures::SkipFigures;
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use corehbot_twin::description::Description;
use corehbot_twin::params::Params;
use corehbot_twin::random::Random;
use std::collections::BTreeMap;

const START: [f64; 3] = [60.0, 40.0, 10.0];

/// Motion time in s at which alignment is over, and moves of the file are under way.
const BEGIN_S: f64 = 57.0;

/// How long accidents may come, in s, and how much longer there are moves.
const WINDOW_S: f64 = 30.0;
const LONGER_S: f64 = 15.0;

/// Moves of x and y of a sliced file at 80 mm/s from a line on that the seed chooses.
fn moves_of(gcode: &str, from: usize) -> Vec<String> {
    let is_move = |line: &&str| line.starts_with("G1 ") && line.contains('X') && line.contains('Y');
    let without_e = |line: &str| {
        let words = line.split(';').next().unwrap_or_default().split_whitespace();
        words.filter(|word| !word.starts_with(['E', 'Z', 'F'])).collect::<Vec<_>>().join(" ") + " F4800"
    };
    let moves: Vec<String> = gcode.lines().filter(is_move).map(without_e).collect();
    let from = from % moves.len();
    let mut way_mm = 0.0;
    let mut at: Option<[f64; 2]> = None;
    let far_enough = |line: &&String| {
        let number = |letter| {
            let words = line.split_whitespace();
            words.filter_map(|word| word.strip_prefix(letter)).find_map(|text| text.parse::<f64>().ok()).unwrap()
        };
        let to = [number('X'), number('Y')];
        way_mm += at.replace(to).map_or(0.0, |[x, y]| (to[0] - x).hypot(to[1] - y));
        way_mm < 80.0 * (WINDOW_S + LONGER_S)
    };
    moves.iter().cycle().skip(from).take_while(far_enough).cloned().collect()
}

/// The effect of a motor that rubs for a while, and the firmware's messages about it.
struct Story {
    /// X and y are homed between the skip and M915 R.
    is_homed: bool,
    /// Shift of each motor by the accident, in electrical turns.
    turns: BTreeMap<MotorName, i32>,
    skips: Vec<SkipFigures>,
    heard: Vec<String>,
    /// The tool's position error in the end, and the strain.
    off_mm: f64,
    residual_mm: f64,
}

fn story(gcode: &str, seed: u64) -> Story {
    let mut random = Random::new(seed, 0x736b_6970);
    let names = ["m1", "m4", "m8", "m11"];
    let name = names[(random.unit() * 4.0) as usize % 4];
    let rub = format!(
        "rub:{name}:{:.0}N@{:.3}s+{:.4}s",
        120.0 + 60.0 * random.unit(),
        BEGIN_S + WINDOW_S * random.unit(),
        0.006 + 0.014 * random.unit()
    );
    let accidents = Accidents { parts: vec![rub.parse().unwrap()], ..Accidents::default() };
    let moves = moves_of(gcode, (random.unit() * 1e4) as usize);
    let lines = ["M915"].into_iter().chain(moves.iter().map(String::as_str));
    // Every fourth story is homed first, which removes the evidence at the switches.
    let is_homed = seed % 4 == 1;
    let homes = if is_homed { &["G28 X Y"][..] } else { &[] };
    let lines = lines.chain(homes.iter().copied());
    let lines: Vec<&str> = lines.chain(["M915 R", "G1 X195 Y208.8 F6000", "M400"]).collect();
    let mut plant = plant_of(Params::default(), START, seed, accidents);
    let printed = print_as(&Settings::prototype(), &mut plant, Some(START), &lines);
    let mut plant = plant.unwrap();
    plant.ring_out();
    let figures = plant.figures();
    let mut turns = BTreeMap::new();
    for skip in &figures.skips {
        *turns.entry(skip.motor).or_insert(0) += skip.turns;
    }
    turns.retain(|_, turns| *turns != 0);
    let [x, y] = plant.tool_mm();
    Story {
        is_homed,
        turns,
        skips: figures.skips.clone(),
        heard: printed.heard.into_iter().filter(|line| line != "ok").collect(),
        off_mm: (x - 195.0).hypot(y - 208.8),
        residual_mm: figures.residual_mm.unwrap(),
    }
}

/// A motor is held for some ms at a random moment of a sliced file. `cargo xtask soak belt` runs 1,000 such cases.
#[test]
fn a_single_skip_names_its_motor_and_every_skip_is_repaired() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/first-print.gcode");
    let gcode = std::fs::read_to_string(path).unwrap();
    let stories = of_each(seeds(6), |seed| story(&gcode, seed));
    let (mut single, mut named, mut skipped) = (0, 0, 0);
    for (seed, story) in stories.iter().enumerate() {
        let Story { is_homed, turns, skips, heard, off_mm, residual_mm } = story;
        let what = || format!("{seed}: {skips:?} {heard:?}, off {off_mm:.3} mm, residual {residual_mm:.4} mm");
        assert!(heard.iter().any(|line| line.contains("belt motors aligned")), "{}", what());
        // Whatever happened, the tool is where the program sent it, within a switch's step and the error by friction.
        assert!(*off_mm < 0.04 && residual_mm.abs() < 0.0125, "{}", what());
        let said = |text: &str| heard.iter().any(|line| line.contains(text));
        // Of motors that skipped alike homing leaves nothing.
        let strain: i32 = turns
            .iter()
            .map(|(motor, turns)| if matches!(motor.as_str(), "m1" | "m8") { *turns } else { -turns })
            .sum();
        let is_well = turns.is_empty() || *is_homed && strain == 0;
        assert_eq!(said("no motor has skipped"), is_well, "{}", what());
        assert_eq!(said("belt repaired"), !is_well, "{}", what());
        skipped += usize::from(!turns.is_empty());
        let mut each = turns.iter();
        if let (Some((motor, turns @ (-1 | 1))), None) = (each.next(), each.next()) {
            single += 1;
            let right = format!("motor {motor} has skipped by {:+} full steps", 4 * turns);
            let is_right = said(&right);
            named += usize::from(is_right);
            if !is_right {
                println!("not named: {}", what());
            }
        } else {
            // Several skips may look like one of another motor; they are repaired all the same.
            println!("{}: {turns:?} {:?}", seed, heard.iter().filter(|line| line.contains("skip")).collect::<Vec<_>>());
        }
    }
    println!("{} stories, {skipped} with skips, {single} with a single one, {named} named", stories.len());
    assert!(single > 0 && named * 100 >= single * 99, "{named} of {single}");
}

/// A motor is held for a moment, x and y are homed, and only then the diagnosis runs: the change by homing is known. A
/// second skip is compared with the state after the repair.
#[test]
fn a_skip_is_found_after_x_and_y_were_homed() {
    let lines =
        ["M915", "G1 X175 Y188.8 F9000", "G1 X195 Y208.8 F6000", "G1 X150 Y150", "G28 X Y", "G28 X Y", "M915 D"];
    let again = ["M915 R", "G28 X Y", "M915 D", "G1 X195 Y208.8 F6000", "M400"];
    let lines: Vec<&str> = lines.into_iter().chain(again).collect();
    let setup = BeltSetup {
        twin: Description::default(),
        seed: Some(7),
        accidents: Accidents { parts: vec!["rub:m11:170N@57.36s+0.014s".parse().unwrap()], ..Accidents::default() },
    };
    let mut plant = Some(Box::new(BeltPlant::new(&Settings::prototype(), None, false, setup, 0).unwrap()));
    let lines: Vec<&str> = ["G28", "G1 Z5 F900"].into_iter().chain(lines).collect();
    let printed = print_as(&Settings::prototype(), &mut plant, None, &lines);
    let figures = plant.unwrap().figures();
    assert_eq!(figures.skips.len(), 1, "{figures}");
    let said = |text: &str| printed.heard.iter().filter(|line| line.contains(text)).count();
    // M915 D leaves everything as it was except its trust: M915 R has nothing to compare with, and M915 is due.
    assert_eq!(said("motor m11 has skipped by +4 full steps"), 1, "{:#?}", printed.heard);
    assert!(said("nothing to compare with") >= 1, "{:#?}", printed.heard);
}

/// A print is paused for a repair: M24 resumes it from its place, also after a diagnosis without repair.
#[test]
fn the_tool_is_back_where_it_was_after_a_repair() {
    let begin = ["G28", "G1 Z5 F900", "M915", "G1 X175 Y188.8 F9000", "G1 X195 Y208.8 F6000", "G1 X150 Y120", "M400"];
    let end = ["M25", "M915 R", "M915 D", "M24", "M400", "M114"];
    let lines: Vec<&str> = begin.into_iter().chain(end).collect();
    let setup = BeltSetup {
        twin: Description::default(),
        seed: Some(7),
        accidents: Accidents { parts: vec!["rub:m11:170N@57.36s+0.014s".parse().unwrap()], ..Accidents::default() },
    };
    let mut plant = Some(Box::new(BeltPlant::new(&Settings::prototype(), None, false, setup, 0).unwrap()));
    let printed = print_as(&Settings::prototype(), &mut plant, None, &lines);
    let has = |text: &str| printed.heard.iter().any(|line| line.contains(text));
    assert!(has("belt repaired") && has("no motor has skipped"), "{:#?}", printed.heard);
    assert!(has("X:150.00 Y:120.00 Z:5.00"), "{:#?}", printed.heard);
    let mut plant = plant.unwrap();
    plant.ring_out();
    let [x, y] = plant.tool_mm();
    assert!((x - 150.0).hypot(y - 120.0) < 0.04, "{x} {y}");
}

/// The example prints the documentation's text, word for word.
#[test]
fn the_example_in_the_documentation_is_what_happens() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let read = |path| std::fs::read_to_string(format!("{folder}/{path}")).unwrap();
    let (gcode, docs) = (read("examples/belt/skip-and-repair.gcode"), read("docs/explanation/belt/skips.md"));
    let lines: Vec<&str> = gcode.lines().map(|line| line.split(';').next().unwrap().trim()).collect();
    let lines: Vec<&str> = lines.into_iter().filter(|line| !line.is_empty()).collect();
    for (hit, rub, skips) in [(Some("190,203.8,180,14"), "rub:m11:5N@0s", 2), (None, "rub:m11:170N@57.36s+0.014s", 1)] {
        let arguments = hit.map_or(String::new(), |hit| format!(" --hit {hit}")) + " --break " + rub;
        let command = format!("corehbot run examples/belt/skip-and-repair.gcode --plant belt --seed 7{arguments}\n");
        assert!(docs.contains(&command) && gcode.contains(&command), "{command}");
        let accidents = Accidents {
            hits: hit.into_iter().map(|hit| hit.parse().unwrap()).collect(),
            parts: vec![rub.parse().unwrap()],
        };
        let setup = BeltSetup { twin: Description::default(), seed: Some(7), accidents };
        let mut plant = Some(Box::new(BeltPlant::new(&Settings::prototype(), None, false, setup, 0).unwrap()));
        let printed = print_as(&Settings::prototype(), &mut plant, None, &lines);
        let figures = plant.unwrap().figures();
        assert_eq!(figures.skips.len(), skips, "{figures}");
        let told: Vec<&String> = printed.heard.iter().filter(|line| line.contains("off its position")).collect();
        assert!(!told.is_empty(), "{:?}", printed.heard);
        let of_belt = ["belt motors aligned", "off its position", "skip", "belt repaired"];
        for line in printed.heard.iter().filter(|line| of_belt.iter().any(|text| line.contains(text))) {
            assert!(docs.contains(line.as_str()), "{line}");
        }
    }
}
