//! How well each controller does with the prototype's plant.
//! `cargo test --test core_tests thermal -- --nocapture` prints all.

use corehbot_rig::plant::PlantConstants;

use super::peers::{self, Output, calibrate};
use super::runs::{Controller, FlowStep, HeatUp, PRINTING, flow_step, heat_up};

/// The results of a controller.
struct Figures {
    to_215: HeatUp,
    to_250: HeatUp,
    flow_5: FlowStep,
    flow_15: FlowStep,
}

impl Figures {
    /// Of the controller that `make` makes for a target.
    fn of<C: Controller>(name: &str, make: impl Fn(f64) -> C) -> Self {
        let constants = PlantConstants::prototype();
        let to = |target| heat_up(&mut make(target), &constants, constants.ambient_celsius, target);
        let flow = |mm3_s| flow_step(&mut make(PRINTING), &constants, mm3_s);
        let all = Self { to_215: to(PRINTING), to_250: to(250.0), flow_5: flow(5.0), flow_15: flow(15.0) };
        for (to, run) in [(215, all.to_215), (250, all.to_250)] {
            println!("{name} to {to} C, block:  {:.2?}", run.block);
            println!("{name} to {to} C, sensor: {:.2?}", run.sensor);
        }
        println!("{name} at 5 mm^3/s: {:.2?}, at 15 mm^3/s: {:.2?}", all.flow_5, all.flow_15);
        all
    }

    /// Overshoots of the block at 215 and 250 C, and dip and rise at 5 and 15 mm^3/s, K.
    const fn kelvins(&self) -> [f64; 6] {
        let Self { to_215, to_250, flow_5, flow_15 } = self;
        [to_215.block.overshoot, to_250.block.overshoot, flow_5.dip, flow_5.rise, flow_15.dip, flow_15.rise]
    }

    /// When the block has settled at 215 and 250 C, s.
    const fn settled(&self) -> [Option<f64>; 2] {
        [self.to_215.block.settled, self.to_250.block.settled]
    }
}

/// Kelvins within 0.3: they may drift with the plant's figures, not jump.
#[track_caller]
fn assert_kelvins(figures: &Figures, were: [f64; 6]) {
    let are = figures.kelvins();
    assert!(are.iter().zip(were).all(|(is, was)| (is - was).abs() <= 0.3), "{are:.2?} were {were:?}");
}

/// And times within 5 s.
#[track_caller]
fn assert_settled(figures: &Figures, were: [f64; 2]) {
    let are = figures.settled();
    let is_near = |(is, was): (&Option<f64>, f64)| is.is_some_and(|is| (is - was).abs() <= 5.0);
    assert!(are.iter().zip(were).all(is_near), "{are:.1?} were {were:?}");
}

#[test]
fn figures_of_the_peers() {
    let bang_bang = |output| Figures::of(&format!("bang-bang {output:?}"), |target| peers::bang_bang(target, output));
    let pid = |output| {
        let gains = calibrate(&PlantConstants::prototype(), PRINTING, output);
        // In the unit that Klipper's and Marlin's settings have, 1/255 of full power.
        let parts = [gains.proportional, gains.integral, gains.derivative].map(|gain| gain * 255.0);
        println!("PID {output:?}: Kp, Ki, Kd {parts:.2?}");
        Figures::of(&format!("PID {output:?}"), |target| peers::pid(gains, target, output))
    };

    let at_once = bang_bang(Output::AtOnce);
    assert_kelvins(&at_once, [6.0, 5.6, 4.6, 6.0, 5.4, 6.0]);
    assert_eq!(at_once.settled(), [None; 2]);
    let by_host = bang_bang(Output::ByHost);
    assert_kelvins(&by_host, [6.8, 6.2, 5.1, 6.2, 6.1, 6.7]);
    assert_eq!(by_host.settled(), [None; 2]);

    let at_once = pid(Output::AtOnce);
    assert_kelvins(&at_once, [1.0, 0.8, 0.4, 0.4, 1.2, 1.2]);
    assert_settled(&at_once, [80.8, 94.6]);
    let by_host = pid(Output::ByHost);
    assert_kelvins(&by_host, [1.1, 0.8, 0.5, 0.6, 1.4, 1.4]);
    assert_settled(&by_host, [85.5, 98.1]);
}
