//! Lives on routings other than the CoreH-bot's: the same print twice, and again after a power cycle.

use crate::belt::machines::{plant_of, read};
use crate::common::life::{Life, live_with};
use corehbot::motors::MotorSet;
use corehbot::port::NoStorage;
use corehbot::units::{Mm, TICKS_PER_SECOND};
use corehbot_sim::world::Desk;

/// Begins and ends at [`BEGIN`].
const PRINT: [&str; 6] =
    ["G1 X60 F3000", "G1 Y60", "G1 X45 Y45 Z10.5 F1200", "G2 X30 Y30 I-7.5 J-7.5 F3000", "G1 Z10", "M400"];

const BEGIN: [f64; 3] = [30.0, 30.0, 10.0];

/// Step events: ticks from the first one on, motors that step, motors that step forward.
type Steps = Vec<(u64, u32, u32)>;

/// Prints, and waits until the tool is where it should be.
fn printed(life: &mut Life<'_>, name: &str) -> Steps {
    life.mark();
    PRINT.iter().for_each(|line| life.say(line));
    life.rest(300);
    let at = life.nozzle();
    // A motor steps when it is half a step away; steps are up to 25 um. Friction over stiffness, once homed.
    assert!(at.iter().zip(BEGIN).all(|(at, to)| (at - to).abs() < 0.06), "{name}: {at:?}");
    life.events()
}

#[test]
fn other_routings_print_the_same_twice_and_after_a_power_cycle() {
    for name in ["corexy", "hbot", "corexyz"] {
        let machine = read(name);
        let mut rigid = Vec::new();
        let start = Some(BEGIN.map(Mm::from_num));
        live_with(&machine.settings, start, (&mut Desk::new(1), 1), NoStorage, |life| rigid = printed(life, name));
        assert!(rigid.len() > 5000, "{name}: {}", rigid.len());
        let (mut now, mut plant) = (0, plant_of(&machine, None, Some(5)));
        for day in 0..2 {
            let mut desk = Desk::at(1, now);
            desk.belt = plant.take();
            live_with(&machine.settings, None, (&mut desk, 1), NoStorage, |life| {
                ["G28", "G1 X30 Y30 Z10 F3000", "M400"].iter().for_each(|line| life.say(line));
                for time in 0..2 {
                    assert!(printed(life, name) == rigid, "{name}: day {day}, time {time}");
                }
                assert_eq!(life.count("Error"), 0, "{name}: {:?}", life.heard);
                now = life.now();
            });
            plant = desk.belt.take();
            let belt = plant.as_mut().unwrap();
            let figures = belt.figures();
            assert!(figures.skips.is_empty() && figures.off_mm.unwrap() < 0.06, "{name}: day {day}: {figures}");
            // Motors lose power, and a hand moves the tool.
            let before = belt.tool_mm();
            belt.attend(now, (MotorSet::NONE, now));
            belt.push([4.0, 3.0], 150);
            let moved = belt.tool_mm().iter().zip(before).map(|(to, from)| (to - from).abs()).fold(0.0, f64::max);
            assert!(moved > 0.5, "{name}: {moved}");
            now += 5 * u64::from(TICKS_PER_SECOND);
        }
    }
}
