//! Axes on both sides of 0: homing, edges, names of places, and the same again after a power cycle.

use super::talk::{Steps, Talk};
use corehbot::settings::{AxisEnd, Settings};
use corehbot::units::Mm;
use corehbot_machine_file as machine_file;
use corehbot_sim::eeprom::Eeprom;
use corehbot_sim::world::run_with;

/// The prototype with an X that begins at -60 and a Y that begins at -7.5. The switch of X is at this end.
fn machine(end: AxisEnd) -> Settings {
    let position = match end {
        AxisEnd::Min => -59.8,
        AxisEnd::Max => 231.5,
    };
    let text = format!(
        "[axes.x]\nmin = -60\nlength = 290\n[axes.y]\nmin = -7.5\nlength = 400\n\
         [homing.x]\nend = \"{}\"\nposition = {position}\n[pause]\nx = -55\ny = -20\n",
        end.name()
    );
    machine_file::parse(&text).unwrap().settings
}

/// The replies to these lines, and where the tool is afterwards.
fn say(eeprom: &mut Eeprom, s: &Settings, from: [f64; 3], lines: &[&str]) -> (Vec<String>, [f64; 3]) {
    let (mut host, mut steps) = (Talk::new(lines), Steps::default());
    let outcome = run_with(s, Some(from.map(Mm::from_num)), eeprom, &mut [&mut host], &mut steps).unwrap();
    assert!(!outcome.halted && steps.count > 0, "{:?}", host.heard);
    let counts = outcome.counts.map(i64::from);
    let way = s.mechanism.forward_kinematics().unwrap().fractions(&counts);
    let pitch = s.axes.map(|axis| axis.steps_per_mm.to_num::<f64>()).to_array();
    let place = [0, 1, 2].map(|axis| from[axis] + way[axis].0 as f64 / way[axis].1 as f64 / pitch[axis]);
    (host.heard, place)
}

fn places(heard: &[String]) -> Vec<&str> {
    heard.iter().filter(|line| line.starts_with("X:")).map(|line| line.split(" E:").next().unwrap()).collect()
}

#[test]
fn negative_places_are_reached_at_every_start() {
    for end in [AxisEnd::Min, AxisEnd::Max] {
        let s = machine(end);
        s.check_machine().unwrap();
        let mut eeprom = Eeprom::blank();
        let home = if end == AxisEnd::Min { "X:-59.80 Y:-7.50 Z:0.00" } else { "X:231.50 Y:-7.50 Z:0.00" };
        let edge = "X:-60.00 Y:392.50 Z:0.00";
        let lines = [
            "M113 S7",
            "M500",
            "G28",
            "M114",
            "G1 X-20 Y-5 Z5 F6000",
            "M114",
            "G1 X-99 Y999 Z-3",
            "M114",
            "G1 X-31.25",
            "M400",
        ];
        let (heard, place) = say(&mut eeprom, &s, [12.5, 30.0, 8.0], &lines);
        assert_eq!(places(&heard), [home, "X:-20.00 Y:-5.00 Z:5.00", edge], "{heard:?}");
        assert!(heard.iter().any(|line| line.starts_with("echo:") && line.contains("reach")), "{heard:?}");
        // The switch is met within a step of its place.
        assert!((place[0] + 31.25).abs() < 0.03 && (place[1] - 392.5).abs() < 0.03, "{end:?} {place:?}");
        // Power goes and comes: the tool stands where it stood, and the firmware does not know it before it homes.
        let (heard, place) = say(&mut eeprom, &s, place, &["M113", "G28", "M114", "G1 X-45 Y100 Z2 F6000", "M400"]);
        assert!(heard.contains(&"echo:M113 S7".to_owned()), "{heard:?}");
        assert_eq!(places(&heard), [home], "{heard:?}");
        assert!((place[0] + 45.0).abs() < 0.03 && (place[1] - 100.0).abs() < 0.03, "{end:?} {place:?}");
        // Homed from its switch, and again.
        let (heard, _) = say(&mut eeprom, &s, [-59.9, -7.5, 0.0], &["G28", "M114", "G28", "M114"]);
        assert_eq!(places(&heard), [home; 2], "{heard:?}");
    }
}

#[test]
fn names_pauses_and_reports_know_the_reach() {
    let s = machine(AxisEnd::Min);
    let lines = [
        "G28",
        "G92 X0",
        "G1 X10 F6000",
        "M114",
        "G1 X-5",
        "M114",
        "G28 X",
        "M114",
        "G1 X5 Y30 Z10",
        "M125",
        "M114 R",
        "M24",
        "M211",
        "M503",
    ];
    let (heard, _) = say(&mut Eeprom::blank(), &s, [12.5, 30.0, 8.0], &lines);
    // X0 is the switch at -59.8, so X-5 is cut to the edge, 0.2 mm below it. Parking keeps to the edge of Y.
    let named = ["X:10.00 Y:-7.50 Z:0.00", "X:-0.20 Y:-7.50 Z:0.00", "X:-59.80 Y:-7.50 Z:0.00"];
    assert_eq!(places(&heard), [&named[..], &["X:-55.00 Y:-7.50 Z:20.00"]].concat(), "{heard:?}");
    for line in [
        "Soft endstops: ON  Min:  X-60.00 Y-7.50 Z0.00   Max:  X230.00 Y392.50 Z335.00",
        "echo:; reachable: X-60..230 Y-7.5..392.5 Z335 mm",
        "echo:; homing X: down to -59.8 mm, 40 mm/s, 5 mm back, 5 mm/s",
        "echo:; bed: 290 x 400 mm from X-60 Y-7.5",
    ] {
        assert!(heard.contains(&line.to_owned()), "{line}: {heard:?}");
    }
}
