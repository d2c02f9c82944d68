//! Every machine of `examples/machines` is pulled by its belts: it homes, prints without skips and ends where it
//! should.

use crate::belt::printer::print_as;
use corehbot::units::Mm;
use corehbot_machine_file::{self as machine_file, Machine};
use corehbot_sim::belt::{BeltPlant, BeltSetup};
use std::path::Path;

fn machines() -> Vec<(String, Machine)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let machines = files.filter(|path| path.extension().is_some_and(|end| end == "toml"));
    machines.map(|path| (path.display().to_string(), machine_file::read(&path).unwrap())).collect()
}

/// An example by its name.
pub fn read(name: &str) -> Machine {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/machines");
    machine_file::read(&folder.join(name).with_extension("toml")).unwrap()
}

pub fn plant_of(machine: &Machine, start: Option<[f64; 3]>, seed: Option<u64>) -> Option<Box<BeltPlant>> {
    let setup = BeltSetup { twin: machine.twin.clone(), seed, ..BeltSetup::default() };
    let place = start.map(|start| start.map(Mm::from_num));
    Some(Box::new(BeltPlant::new(&machine.settings, place, start.is_some(), setup, 0).unwrap()))
}

#[test]
fn each_machine_makes_the_same_steps_and_ends_where_it_should() {
    let start = Some([30.0, 30.0, 10.0]);
    let lines = ["M204 P1000 T1000", "G1 X60 F3000", "G1 Y60", "G1 X30", "G1 X45 Y45 Z10.5 F1200", "G4 P300", "M400"];
    let machines = machines();
    assert!(machines.len() >= 13);
    for (file, machine) in &machines {
        let rigid = print_as(&machine.settings, &mut None, start, &lines);
        let mut plant = plant_of(machine, start, None);
        let printed = print_as(&machine.settings, &mut plant, start, &lines);
        assert!(printed.events == rigid.events && rigid.events.len() > 1000, "{file}");
        let (plant, figures) = (plant.as_ref().unwrap(), plant.as_ref().unwrap().figures());
        assert!(figures.skips.is_empty() && figures.motors.len() >= 2, "{file}: {figures}");
        assert!(figures.motors.iter().all(|motor| motor.largest_torque_share < 0.6), "{file}: {figures}");
        // Friction over stiffness. An H-bot is the softest.
        assert!(figures.off_mm.unwrap() < 0.02, "{file}: {figures}");
        assert!(figures.largest_off_mm > 1e-3, "{file}: {figures}");
        let off = plant.nozzle().into_iter().zip([45.0, 45.0, 10.5]).map(|(at, to)| (at - to).abs());
        // A motor steps when it is half a step away; steps are up to 25 um.
        assert!(off.fold(0.0, f64::max) < 0.04, "{file}: {:?}", plant.nozzle());
        // A residual exists where motors are more than the axes of their belts.
        let is_strained = machine.settings.mechanism.belt_motors().iter().count() > 2
            && !["corehbot-two", "corexyz-three", "corexz"].iter().any(|name| file.contains(name))
            || file.contains("corehbot-two");
        assert_eq!(figures.residual_mm.is_some(), is_strained, "{file}");
    }
}

#[test]
fn each_machine_homes_on_the_switches_that_its_tool_meets() {
    for (file, machine) in &machines() {
        let mut plant = plant_of(machine, None, Some(3));
        let printed = print_as(&machine.settings, &mut plant, None, &["G28", "G1 X20 Y20 F1800", "G4 P300", "M400"]);
        assert!(!printed.outcome.halted, "{file}: {:?}", printed.heard);
        assert!(!printed.heard.iter().any(|line| line.contains("rror")), "{file}: {:?}", printed.heard);
        let plant = plant.unwrap();
        let [x, y] = plant.tool_mm();
        assert!((x - 20.0).abs() < 0.06 && (y - 20.0).abs() < 0.06, "{file}: {x} {y}");
        assert!(plant.figures().off_mm.unwrap() < 0.06, "{file}: {}", plant.figures());
    }
}

/// A CoreH-bot with pulleys of 20 teeth on motors 1 and 8 and of 16 on motors 4 and 11: 80 and 100 steps/mm, which have
/// the common measure of 20. Four different sizes would be more groups than the firmware has.
const TWO_SIZES: &str = "
[mechanism]
m1 = [-4, 4, 0]
m4 = [-5, -5, 0]
m8 = [4, -4, 0]
m11 = [5, 5, 0]
z1 = [0, 0, 1]
e0 = [0, 0, 0, 1]

[axes.x]
steps_per_mm = 20

[axes.y]
steps_per_mm = 20

[axes.z]
steps_per_mm = 400

[twin]
motor_radius_mm = ";

/// Radii of a belt with 2 mm between teeth.
fn radii(teeth: [f64; 4]) -> String {
    format!("{:?}", teeth.map(|teeth| 2.0 * teeth / std::f64::consts::TAU))
}

/// Equation 8 of the CoreH-bot paper: each motor turns by its own travel over its own radius.
#[test]
fn pulleys_of_two_sizes_pull_a_corehbot_to_its_place() {
    let start = Some([100.0, 100.0, 10.0]);
    let lines = ["M204 P1000 T1000", "G1 X130 F3000", "G1 Y140", "G1 X115 Y108 F1200", "G4 P300", "M400"];
    let printed = |radii: &str| {
        let machine = machine_file::parse(&[TWO_SIZES, radii].concat()).unwrap();
        let mut plant = plant_of(&machine, start, None);
        let printed = print_as(&machine.settings, &mut plant, start, &lines);
        assert!(printed.events.len() > 1000);
        plant.unwrap()
    };
    // Without radii the steps say them, and a table of the right ones agrees with the steps.
    for radii in ["[]", &radii([20.0, 16.0, 20.0, 16.0])] {
        let plant = printed(radii);
        // (-x + y, -x - y, x - y, x + y) for x = 15 and y = 8, in 80 and 100 steps/mm.
        let expected = [-7.0 * 80.0, -23.0 * 100.0, 7.0 * 80.0, 23.0 * 100.0];
        let steps = plant.live().counts();
        assert!(steps.iter().zip(expected).all(|(count, wanted)| (*count as f64 - wanted).abs() <= 1.0), "{steps:?}");
        let [x, y] = plant.tool_mm();
        assert!((x - 115.0).abs() < 0.03 && (y - 108.0).abs() < 0.03, "{x} {y}");
        let figures = plant.figures();
        assert!(figures.skips.is_empty() && figures.residual_mm.is_some_and(|mm| mm < 0.05), "{figures}");
    }
    // 18 teeth on motors 4 and 11, which the firmware takes for 16: x + y is 23 * 18 / 16 mm, so x and y are each
    // 23 / 16 mm too far.
    let plant = printed(&radii([20.0, 18.0, 20.0, 18.0]));
    let [x, y] = plant.tool_mm();
    assert!((x - 115.0 - 23.0 / 16.0).abs() < 0.03 && (y - 108.0 - 23.0 / 16.0).abs() < 0.03, "{x} {y}");
}
