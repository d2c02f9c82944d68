//! Hours of motion across the wraps of all counters, with the position exact to the step. `cargo xtask soak` makes days
//! of it.

use crate::common::deaf::Deaf;
use corehbot::motors::per_motor;
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::{Mm, TICKS_PER_MS, TICKS_PER_SECOND};
use corehbot_sim::drivers::Drivers;
use corehbot_sim::world::{Desk, Host, run_at};

/// Hours of motion, except in a soak.
const HOURS: f64 = 0.2;

/// When counters wrap, in ticks: 32 bits of ticks, of microseconds and of milliseconds, and 16 bits of ms.
const WRAPS: [u64; 4] = [1 << 32, (1 << 32) * 10, (1 << 32) * TICKS_PER_MS as u64, (1 << 16) * TICKS_PER_MS as u64];

/// A host that sends moves of any kind until it is late enough, goes home, and knows where every motor must be.
struct Wanderer {
    until: u64,
    now: u64,
    state: u64,
    /// Hundredths of mm of filament.
    filament: i32,
    owed: usize,
    has_begun: bool,
    is_home: bool,
}

impl Wanderer {
    fn random(&mut self, most: u64) -> u64 {
        self.state = self.state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.state >> 33) % most
    }

    fn line(&mut self) -> String {
        let [x, y] = [380, 400].map(|most| self.random(most * 100) as f64 / 100.0);
        let feed = 600 + self.random(17_000);
        match self.random(20) {
            0 => format!("G1 Z{} F900", self.random(2000) as f64 / 100.0),
            1 => format!("G4 P{}", self.random(3000)),
            2 => format!("G2 X{x} Y{y} R{} F{feed}", 600 + self.random(500)),
            3 => "M400".to_owned(),
            4..=12 => {
                let e = self.random(300) as i32 - 60;
                self.filament += e;
                format!("G1 X{x} Y{y} E{} F{feed}", f64::from(e) / 100.0)
            }
            _ => format!("G1 X{x} Y{y} F{feed}"),
        }
    }
}

impl Host for Wanderer {
    fn send(&mut self, out: &mut Vec<u8>) {
        if self.owed > 0 || self.is_home {
            return;
        }
        let line = if !self.has_begun {
            self.has_begun = true;
            "M83".to_owned()
        } else if self.now >= self.until {
            self.is_home = true;
            "G1 X0 Y0 Z0 F6000\nM400".to_owned()
        } else {
            self.line()
        };
        self.owed = line.lines().count();
        out.extend(line.bytes());
        out.push(b'\n');
    }

    fn clock(&mut self, tick: u64) {
        self.now = tick;
    }

    fn hear(&mut self, line: &str) {
        assert!(!line.starts_with("Error") && !line.contains("Resend"), "{line}");
        if line.starts_with("ok") {
            self.owed = self.owed.saturating_sub(1);
        }
    }

    fn is_done(&self) -> bool {
        self.is_home && self.owed == 0
    }
}

#[test]
fn no_step_is_lost_where_counters_wrap() {
    let hours = std::env::var("COREHBOT_SOAK_HOURS").map_or(HOURS, |hours| hours.parse().unwrap());
    let ticks = (hours / WRAPS.len() as f64 * 3600.0 * f64::from(TICKS_PER_SECOND)) as u64;
    let settings = Settings::prototype();
    for (seed, wrap) in (1..).zip(WRAPS) {
        let begin = wrap - 60 * u64::from(TICKS_PER_SECOND);
        let mut host = Wanderer {
            until: begin + ticks,
            now: begin,
            state: seed,
            filament: 0,
            owed: 0,
            has_begun: false,
            is_home: false,
        };
        let drivers = Drivers::new();
        let start = Some([Mm::ZERO; 3]);
        let mut desk = Desk::at(1, begin);
        let outcome = run_at(&mut desk, &settings, start, NoStorage, &drivers, &mut [&mut host], &mut Deaf).unwrap();
        let steps = host.filament * 4;
        assert_eq!(outcome.counts, per_motor(&[0, 0, 0, 0, 0, 0, steps], 0), "from 60 s before {wrap} ticks");
        println!("{:.1} h from 60 s before tick {wrap}: exact, {} moves", hours / 4.0, outcome.moves);
    }
}
