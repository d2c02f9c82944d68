//! Moves are so short that the queues hold little time. The look-ahead must not be given up for that.

use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Sink, run};

/// The way is 200 mm in chords of 0.05 mm at 300 mm/s, from 3 m/s2 to rest at both ends, with the given number of
/// decimals.
fn in_chords(decimals: usize, toward: [f64; 2]) -> String {
    let point = |i: u32| {
        let [x, y] = toward.map(|v| 100.0 + v * f64::from(i) / 4000.0);
        format!("G1 X{x:.decimals$} Y{y:.decimals$} F18000\n")
    };
    (1..=4000).map(point).collect()
}

fn seconds(settings: &Settings, gcode: &str) -> f64 {
    let mut fastest = Fastest::default();
    let start = Some([100, 100, 10].map(Mm::from_num));
    let outcome = run(settings, start, &mut FileHost::new(gcode), &mut fastest).unwrap();
    assert_eq!(outcome.underruns, 0);
    outcome.ticks as f64 / 1e7
}

/// It was 2.26 s at 1 m/s2 and 1.06 s at 3: as fast as 128 chords let it be.
#[test]
fn a_straight_line_in_fine_chords_is_as_fast_as_in_one() {
    let settings = Settings::prototype();
    let line: String = (1..=5000).map(|i| format!("G1 X{:.5} F18000\n", 100.0 + 0.05 * f64::from(i))).collect();
    for (acceleration, gcode, whole, most) in [
        (1000, line, "X350", 1.135),
        (3000, in_chords(5, [160.0, 120.0]), "X260 Y220", 0.769),
        (3000, in_chords(3, [180.0, 87.18]), "X280 Y187.18", 0.769),
        (3000, in_chords(3, [52.73, 192.925]), "X152.73 Y292.925", 0.769),
    ] {
        let set = format!("M204 P{acceleration} T{acceleration}\n");
        let chords = seconds(&settings, &(set.clone() + &gcode));
        let one = seconds(&settings, &format!("{set}G1 {whole} F18000\n"));
        println!("{chords:.3} s, {one:.3} s in one");
        assert!(chords < most && (one - chords).abs() < 2e-3, "{chords:.4} s, {one:.4} s in one");
    }
}

/// The greatest speed along x over 5 ms, in mm/s.
#[derive(Default)]
struct Fastest {
    since: u64,
    count: u32,
    speed: f64,
}

impl Sink for Fastest {
    fn event(&mut self, tick: u64, steps: MotorSet, _forward: MotorSet) {
        self.count += u32::from(steps.has(prototype::M8));
        let ticks = tick - self.since;
        if ticks >= 50_000 {
            self.speed = self.speed.max(f64::from(self.count) / 80.0 / (ticks as f64 / 1e7));
            (self.since, self.count) = (tick, 0);
        }
    }
}

#[test]
fn moves_of_50_um_that_are_no_line_are_as_fast_as_their_look_ahead_and_no_underrun() {
    let mut gcode = String::from("G1 X20 F18000\n");
    for i in 1..=4000 {
        // Another feed is another line.
        gcode += &format!("G1 X{:.2} F{}\n", 20.0 + 0.05 * f64::from(i), 18_000 - i % 2);
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
