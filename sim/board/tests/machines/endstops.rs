//! Endstops at either end and anywhere near it: after homing, the tool really is where the machine says.

use super::print::{machines, print};
use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::{AxisEnd, Endstop, HomedAxis, Settings};
use corehbot::units::Mm;
use corehbot_sim::check::Findings;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Sink, run};

/// Where the tool stands at power-up (`corehbot_rig::AT_POWER_UP`).
const START: [f64; 3] = [31.7, 23.3, 12.4];

fn at(end: AxisEnd, position: f64) -> Endstop {
    Endstop { end, position: Mm::from_num(position) }
}

/// Some machine with switches elsewhere: all at the far ends; one outside, one inside and one between two steps; at
/// axes on both sides of 0.
fn elsewhere(s: &Settings) -> [Settings; 3] {
    let (mut far, mut odd, mut below) = (*s, *s, *s);
    let lengths = s.axes.map(|axis| axis.length.to_num::<f64>());
    far.endstops.x = at(AxisEnd::Max, lengths.x);
    far.endstops.y = at(AxisEnd::Max, lengths.y);
    far.endstops.z = at(AxisEnd::Max, lengths.z);
    far.homing_order = [HomedAxis::Z, HomedAxis::Y, HomedAxis::X];
    odd.endstops.x = at(AxisEnd::Min, -4.5);
    odd.endstops.y = at(AxisEnd::Max, lengths.y + 3.013);
    odd.endstops.z = at(AxisEnd::Min, 0.7);
    odd.homing_order = [HomedAxis::Y, HomedAxis::Z, HomedAxis::X];
    (below.axis_min.x, below.axis_min.y, below.axis_min.z) = (Mm::from_num(-60), Mm::from_num(-7.3), Mm::from_num(-5));
    below.endstops.x = at(AxisEnd::Min, -59.8);
    below.endstops.y = at(AxisEnd::Max, lengths.y - 7.3);
    below.endstops.z = at(AxisEnd::Min, -5.5);
    [far, odd, below]
}

/// Where the tool ends, by the steps of its motors.
fn tool_is_at(to: [f64; 3], s: &Settings, gcode: &str, name: &str) {
    let print = print(s, None, gcode);
    assert_eq!(print.findings, Findings::default(), "{name}: {gcode}");
    let way = s.mechanism.forward_kinematics().unwrap().fractions(&print.counts);
    let pitch = s.axes.map(|axis| axis.steps_per_mm.to_num::<f64>()).to_array();
    for axis in 0..3 {
        let (sum, over) = way[axis];
        let mm = sum as f64 / over as f64 / pitch[axis];
        // A switch closes within a step of its place, which may lie between two.
        let off = mm - (to[axis] - START[axis]);
        assert!(off.abs() <= 1.6 / pitch[axis], "{name}: axis {axis} is {off} mm beside after {gcode}");
    }
}

#[test]
fn the_tool_is_where_the_machine_says_wherever_the_switches_are() {
    for (name, s) in machines() {
        for s in elsewhere(&s) {
            s.check_machine().unwrap();
            tool_is_at([50.0, 60.0, 5.0], &s, "G28\nG1 X50 Y60 Z5 F3000\nM400\nG28 X Y\nG1 X50 Y60\n", &name);
            if s.axis_min.x < Mm::ZERO {
                tool_is_at([-41.0, -7.0, -2.0], &s, "G28\nG1 X-41 Y-7 Z-2 F3000\n", &name);
            }
        }
    }
}

/// A switch inside the axis stays pressed behind it: homing finds it from there as well, at power-up and again from the
/// end of the axis. The tool leaves a switch outside the axis only on command.
#[test]
fn a_switch_is_found_from_behind_and_left_only_on_command() {
    // A belt, four coordinates for three axes, and one motor an axis.
    let kinds = ["prototype", "corexyz", "cartesian"];
    for (name, s) in machines().into_iter().filter(|(name, _)| kinds.contains(&name.as_str())) {
        let mut inside = s;
        let length = s.axes.y.length.to_num::<f64>();
        inside.endstops.x = at(AxisEnd::Min, 42.0);
        inside.endstops.y = at(AxisEnd::Max, length - 12.0);
        inside.homing.x.back_off = Mm::from_num(1);
        inside.check_machine().unwrap();
        let gcode = format!("G28\nG1 X0 Y{length} F6000\nG28\nG1 X50 Y60 Z5 F3000\n");
        tool_is_at([50.0, 60.0, 5.0], &inside, &gcode, &name);
        let mut outside = s;
        outside.endstops.x = at(AxisEnd::Min, -7.0);
        tool_is_at([-7.0, 60.0, 5.0], &outside, "G28\nG1 Y60 F6000\nG1 Z5\n", &name);
        tool_is_at([-5.0, 0.0, 0.0], &outside, "G28\nG91\nG1 X2 F6000\n", &name);
        tool_is_at([0.0, 0.0, 0.0], &outside, "G28\nG1 X3 F6000\nG1 X-4\n", &name);
    }
}

/// The motors of the first step.
#[derive(Default)]
struct First(Option<MotorSet>);

impl Sink for First {
    fn event(&mut self, _: u64, steps: MotorSet, _: MotorSet) {
        self.0.get_or_insert(steps);
    }
}

#[test]
fn axes_are_homed_in_the_order_of_the_settings() {
    for (order, gcode, first) in [
        ([HomedAxis::X, HomedAxis::Y, HomedAxis::Z], "G28\n", prototype::BELT),
        ([HomedAxis::Z, HomedAxis::X, HomedAxis::Y], "G28\n", prototype::Z),
        ([HomedAxis::Z, HomedAxis::X, HomedAxis::Y], "G28 Y X\n", prototype::BELT),
    ] {
        let settings = Settings { homing_order: order, ..Settings::prototype() };
        let mut steps = First::default();
        run(&settings, None, &mut FileHost::new(gcode), &mut steps).unwrap();
        assert!(
            steps.0.is_some_and(|steps| first.with(steps) == first),
            "{order:?} {gcode}: {steps:?}",
            steps = steps.0
        );
    }
}

/// A switch belongs to the half of the axis that its end is in, or a bit outside; every axis is homed once.
#[test]
fn switches_that_could_not_be_met_are_refused() {
    let legal = |endstop| {
        let mut s = Settings::prototype();
        s.endstops.x = endstop;
        s.check_machine().is_ok()
    };
    let at_low_axis = |end, position| {
        let mut s = Settings::prototype();
        (s.axis_min.x, s.axes.x.length, s.endstops.x) = (Mm::from_num(-60), Mm::from_num(290), at(end, position));
        s.check_machine().is_ok()
    };
    assert!(at_low_axis(AxisEnd::Min, -110.0) && !at_low_axis(AxisEnd::Min, -110.1));
    assert!(at_low_axis(AxisEnd::Min, 85.0) && !at_low_axis(AxisEnd::Min, 85.1));
    assert!(at_low_axis(AxisEnd::Max, 280.0) && !at_low_axis(AxisEnd::Max, 280.1));
    assert!(legal(at(AxisEnd::Min, -50.0)) && legal(at(AxisEnd::Min, 195.0)) && legal(at(AxisEnd::Max, 440.0)));
    assert!(!legal(at(AxisEnd::Min, -50.1)) && !legal(at(AxisEnd::Min, 195.1)));
    assert!(!legal(at(AxisEnd::Max, 194.9)) && !legal(at(AxisEnd::Max, 440.1)));
    let twice = [HomedAxis::X, HomedAxis::X, HomedAxis::Z];
    assert!(Settings { homing_order: twice, ..Settings::prototype() }.check().is_err());
}
