//! Moves so short that the queues hold little time: the look-ahead must not be given up for that.
#![allow(clippy::unwrap_used, reason = "clippy does not see that the helpers here belong to tests")]

use corehbot::motors::{Motor, MotorSet};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Sink, run};

/// The greatest speed along x over 5 ms, in mm/s.
#[derive(Default)]
struct Fastest {
    since: u64,
    count: u32,
    speed: f64,
}

impl Sink for Fastest {
    fn event(&mut self, tick: u64, steps: MotorSet, _forward: MotorSet) {
        self.count += u32::from(steps.has(Motor::M8));
        let ticks = tick - self.since;
        if ticks >= 50_000 {
            self.speed = self.speed.max(f64::from(self.count) / 80.0 / (ticks as f64 / 1e7));
            (self.since, self.count) = (tick, 0);
        }
    }
}

#[test]
fn moves_of_50_um_are_as_fast_as_their_look_ahead_and_no_underrun() {
    let mut gcode = String::from("G1 X20 F18000\n");
    for i in 1..=4000 {
        gcode += &format!("G1 X{:.2}\n", 20.0 + 0.05 * f64::from(i));
    }
    let mut fastest = Fastest::default();
    let outcome =
        run(&Settings::prototype(), Some([20, 100, 10].map(Mm::from_num)), &mut FileHost::new(&gcode), &mut fastest)
            .unwrap();
    println!("{:.1} mm/s, {} underruns", fastest.speed, outcome.underruns);
    assert_eq!(outcome.underruns, 0);
    // The 128 moves that are seen at least are 6.4 mm, from which 5 m/s2 bring 253 mm/s to rest.
    assert!(fastest.speed > 250.0, "{} mm/s", fastest.speed);
}
