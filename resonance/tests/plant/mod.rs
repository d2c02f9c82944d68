//! A plant with known modes, shaken by a sweep: its recording, exact at every sample.
#![allow(dead_code, reason = "each test uses some of it")]

use corehbot_resonance::recording::{Recording, read};
use corehbot_resonance::sweep::Sweep;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Frequency in Hz, damping, part.
pub type Mode = (f64, f64, f64);

/// Even numbers from a seed, with a normal distribution by the sum of twelve (central limit).
pub struct Noise(pub u64);

impl Noise {
    fn even(&mut self) -> f64 {
        // xorshift64* (S. Vigna, 2016).
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Between two numbers.
    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.even()
    }

    pub fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.even()).sum::<f64>() - 6.0
    }
}

/// The acceleration of a mode with its damper on the frame: `q'' = w^2 (a - q) - 2 z w q'`, as acceleration passes like
/// place does. With the damper on the belt it is `q + 2 z / w q'`.
struct State {
    w: f64,
    z: f64,
    part: f64,
    x: f64,
    v: f64,
}

/// A plant: modes along the swept axis x and across it, along y.
#[derive(Clone, Copy, Default)]
pub struct Plant<'m> {
    pub modes: &'m [Mode],
    pub across: &'m [Mode],
    /// Share of the dampers between motor and tool; the rest is between tool and frame.
    pub belt: f64,
}

/// Acceleration of the tool for this sweep along x, with noise on all three.
pub fn recording(modes: &[Mode], sweep: &Sweep, rate_hz: f64, noise: f64, seed: u64) -> Recording {
    shaken(&Plant { modes, ..Plant::default() }, sweep, rate_hz, noise, seed)
}

/// Acceleration of the tool of a plant.
pub fn shaken(plant: &Plant, sweep: &Sweep, rate_hz: f64, noise: f64, seed: u64) -> Recording {
    let state = |(f, z, part): &Mode| State { w: TAU * f, z: *z, part: *part, x: 0.0, v: 0.0 };
    let mut states = [plant.modes, plant.across].map(|modes| modes.iter().map(state).collect::<Vec<_>>());
    let mut samples = [Vec::new(), Vec::new()];
    let mut now = 0.0;
    for segment in sweep.segments() {
        loop {
            let next = samples[0].len() as f64 / rate_hz;
            let to = next.min(segment.end_s);
            states.iter_mut().flatten().for_each(|state| state.advance(to - now, segment.accel));
            now = to;
            if next > segment.end_s {
                break;
            }
            for (samples, states) in samples.iter_mut().zip(&states) {
                samples.push(states.iter().map(|s| s.part * (s.x + plant.belt * 2.0 * s.z / s.w * s.v)).sum::<f64>());
            }
        }
    }
    let mut source = Noise(seed);
    let mut noisy = |v: f64| v + noise * source.normal();
    let [x, y] = samples.map(|axis| axis.into_iter().map(&mut noisy).collect::<Vec<f64>>());
    let z = x.iter().map(|_| noisy(9806.65)).collect();
    Recording { rate_hz, axes: [x, y, z], remarks: Vec::new() }
}

impl State {
    fn advance(&mut self, t: f64, a: f64) {
        let (decay, turn) = (self.z * self.w, self.w * (1.0 - self.z * self.z).sqrt());
        let (off, v) = (self.x - a, self.v);
        let b = (v + decay * off) / turn;
        let (sin, cos) = (turn * t).sin_cos();
        let left = (-decay * t).exp();
        self.x = a + left * (off * cos + b * sin);
        self.v = left * (v * cos - (decay * b + turn * off) * sin);
    }
}

/// The text of a file.
pub fn text(recording: &Recording) -> String {
    let mut text = String::from("#time,accel_x,accel_y,accel_z\n");
    let [x, y, z] = &recording.axes;
    for (i, ((x, y), z)) in x.iter().zip(y).zip(z).enumerate() {
        writeln!(text, "{:.6},{x:.6},{y:.6},{z:.6}", 100.0 + i as f64 / recording.rate_hz).unwrap();
    }
    text
}

/// The recording through a file's text.
pub fn through_text(recording: &Recording) -> Recording {
    read(text(recording).as_bytes()).unwrap()
}
