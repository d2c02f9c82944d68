//! Trust: random damage and resets, and no motor runs without a configured driver.

use super::script::{Script, Steps, lines};
use corehbot::motors::{Motor, MotorSet, prototype};
use corehbot::port::NoStorage;
use corehbot::settings::Settings;
use corehbot::units::Mm;
use corehbot_sim::drivers::Drivers;
use corehbot_sim::tmc2209::Corruption;
use corehbot_sim::world::{Host, run_on};
use proptest::prelude::*;

pub fn damage() -> impl Strategy<Value = Corruption> {
    prop_oneof![
        (0usize..8, 1u8..=255).prop_map(|(byte, mask)| Corruption::Flip { byte, mask }),
        (0usize..8).prop_map(Corruption::Cut),
        Just(Corruption::Zero),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Whatever replies are damaged, and whenever drivers are reset: no motor gets power after its driver has said that
    /// it lost its configuration. Two seconds later all motors have power and the right microsteps, or no motor has
    /// power and the host knows why.
    #[test]
    fn no_motor_runs_on_trust(
        damages in proptest::collection::vec((0usize..7, 0u32..40, damage()), 0..12),
        resets in proptest::collection::vec((0usize..7, 1u32..75), 0..3),
        silent in proptest::option::weighted(0.1, 0usize..7),
    ) {
        let drivers = Drivers::new();
        for (motor, number, damage) in damages {
            drivers.chip(Motor::ALL[motor]).corrupt_reply(number, damage);
        }
        if let Some(motor) = silent {
            drivers.chip(Motor::ALL[motor]).is_silent = true;
        }
        let mut host = Resets { script: Script {
            drivers: &drivers, acts: lines(&["M17", "G4 S2"]).into(), is_awaiting: false, heard: Vec::new(),
            interjection: None, interjected: 0,
        }, resets };
        let start = Some([Mm::ZERO; 3]);
        let outcome =
            run_on(&Settings::prototype(), start, NoStorage, &drivers, &mut [&mut host], &mut Steps::default()).unwrap();
        let heard = &host.script.heard;
        prop_assert_eq!(drivers.betrayed(), MotorSet::NONE);
        let has_error = heard.iter().any(|line| line.starts_with("Error:"));
        if drivers.enabled().is_empty() {
            prop_assert!(has_error, "{:?}", heard);
        } else {
            prop_assert_eq!((drivers.enabled(), drivers.astray(16)), (prototype::ALL, MotorSet::NONE), "{:?}", heard);
            prop_assert!(!has_error && !outcome.halted);
        }
    }
}

/// A host. Drivers of its machine are reset when all drivers together have sent a number of bytes.
struct Resets<'d> {
    script: Script<'d>,
    resets: Vec<(usize, u32)>,
}

impl Host for Resets<'_> {
    fn send(&mut self, out: &mut Vec<u8>) {
        self.script.send(out);
    }

    fn interject(&mut self, _out: &mut Vec<u8>) {
        let drivers = self.script.drivers;
        let said: u32 = Motor::ALL.iter().map(|motor| drivers.chip(*motor).replies()).sum();
        self.resets.retain(|(motor, at)| {
            if said >= *at {
                drivers.chip(Motor::ALL[*motor]).reset();
            }
            said < *at
        });
    }

    fn hear(&mut self, line: &str) {
        self.script.hear(line);
    }

    fn is_done(&self) -> bool {
        self.script.is_done()
    }
}
