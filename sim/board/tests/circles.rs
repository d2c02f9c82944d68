//! Circles from text to step times: the tool runs round them at one speed, however the slicer writes them.

use corehbot::motors::{MotorSet, prototype};
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::host::FileHost;
use corehbot_sim::world::{Sink, run};
use std::f64::consts::TAU;

/// When each of u = x + y and v = x - y passes the middle between two steps, and where that is, in steps.
#[derive(Default)]
struct Crossings {
    at: [i64; 2],
    all: [Vec<(f64, f64)>; 2],
}

impl Sink for Crossings {
    fn event(&mut self, tick: u64, steps: MotorSet, forward: MotorSet) {
        for ((at, all), motor) in self.at.iter_mut().zip(&mut self.all).zip([prototype::M11, prototype::M8]) {
            if steps.has(motor) {
                let before = *at;
                *at += if forward.has(motor) { 1 } else { -1 };
                all.push((tick as f64 / 1e7, (before + *at) as f64 / 2.0));
            }
        }
    }
}

impl Crossings {
    /// Where the tool is at a time, in mm.
    fn position(&self, time: f64) -> [f64; 2] {
        let [u, v] = self.all.each_ref().map(|all| {
            let next = all.partition_point(|(t, _)| *t <= time).clamp(1, all.len() - 1);
            let ((t, a), (u, b)) = (all[next - 1], all[next]);
            a + (b - a) * ((time - t) / (u - t)).clamp(0.0, 1.0)
        });
        [(u + v) / 160.0, (u - v) / 160.0]
    }

    /// The least and the greatest speed between two times, over windows of 0.4 mm.
    fn speeds(&self, from: f64, to: f64, feed: f64) -> (f64, f64) {
        let window = 0.4 / feed;
        let (mut least, mut most) = (f64::MAX, 0f64);
        for i in 0..((to - from) / window * 4.0) as u32 {
            let time = from + f64::from(i) * window / 4.0;
            let ([ax, ay], [bx, by]) = (self.position(time), self.position(time + window));
            let speed = (bx - ax).hypot(by - ay) / window;
            (least, most) = (least.min(speed), most.max(speed));
        }
        (least, most)
    }
}

/// How the circle is written.
#[derive(Clone, Copy, Debug)]
enum Text {
    /// Chords of 0.1 mm with this many decimals.
    Chords(usize),
    /// Four arcs a turn.
    Arcs(usize),
}

/// Three turns round (100, 100), printing.
fn circle(radius: f64, text: Text, feed: f64) -> String {
    let (parts, arc, decimals) = match text {
        Text::Chords(decimals) => ((TAU * radius / 0.1).round() as u32, false, decimals),
        Text::Arcs(decimals) => (4, true, decimals),
    };
    let mut gcode = format!("M83\nG0 X{:.3} Y100 F9000\nM400\nG1 F{:.0}\n", 100.0 + radius, feed * 60.0);
    let point = |i: u32| {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(parts)).sin_cos();
        [100.0 + radius * cos, 100.0 + radius * sin]
    };
    for i in 0..3 * parts {
        let ([fx, fy], [x, y]) = (point(i), point(i + 1));
        let filament = 0.033 * TAU * radius / f64::from(parts);
        gcode += &if arc {
            let (i, j) = (100.0 - fx, 100.0 - fy);
            format!("G3 X{x:.decimals$} Y{y:.decimals$} I{i:.decimals$} J{j:.decimals$} E{filament:.5}\n")
        } else {
            format!("G1 X{x:.decimals$} Y{y:.decimals$} E{filament:.5}\n")
        };
    }
    gcode + "M400\n"
}

/// The ripple of the speed in the second turn, in percent, and the mean of its ends.
fn ripple(radius: f64, text: Text, feed: f64, settings: &Settings) -> (f64, f64) {
    let mut steps = Crossings::default();
    let start = Some([100, 100, 10].map(Mm::from_num));
    let mut host = FileHost::new(&circle(radius, text, feed));
    let outcome = run(settings, start, &mut host, &mut steps).unwrap();
    assert_eq!(outcome.underruns, 0);
    let turn = TAU * radius / feed;
    let end = steps.all.iter().flatten().map(|(time, _)| *time).fold(0.0, f64::max);
    // Before the last turn; in half of that turn it may brake.
    let (least, most) = steps.speeds(end - 2.2 * turn, end - 1.2 * turn, feed);
    (100.0 * (most - least) / feed, (most + least) / 2.0)
}

#[test]
fn the_speed_round_a_circle_ripples_by_less_than_one_percent() {
    let settings = Settings::prototype();
    for (radius, feeds) in [
        (1.0, &[15.0, 30.0, 45.0][..]),
        (2.0, &[30.0, 65.0]),
        (5.0, &[50.0, 110.0]),
        (20.0, &[100.0, 200.0]),
        (50.0, &[200.0]),
    ] {
        for feed in feeds {
            for text in [Text::Chords(3), Text::Chords(5), Text::Arcs(3), Text::Arcs(5)] {
                let (ripple, speed) = ripple(radius, text, *feed, &settings);
                println!("radius {radius} mm, {feed} mm/s, {text:?}: {ripple:.2} %, {speed:.2} mm/s");
                assert!(ripple <= 1.0, "radius {radius}, {feed} mm/s, {text:?}: {ripple} %");
                // A window of 0.4 mm is a chord of its own.
                assert!((speed / feed - 1.0).abs() < 0.01, "radius {radius}, {feed} mm/s, {text:?}: {speed} mm/s");
            }
        }
    }
}
