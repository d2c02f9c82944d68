//! A translation that is taken over changes nothing.

use super::*;
use crate::board::Emulated;
use crate::eeprom::At24c32;
use crate::flash::FlashSectors;
use crate::wiring::OCTOPUS;
use rigless::emulator::{self, Driver, Host, Start, Stop};
use rigless::image::Image;
use rigless::session::Session;
use std::path::Path;

const FLASH: u64 = 0x0800_0000;
const RAM: u64 = 0x2000_0000;

/// Adds in a loop, with the MPU on.
fn adds(step: u16) -> Vec<u8> {
    let code: [u16; 18] = [
        0x1000,
        0x2000, //        stack
        0x0009,
        0x0800,        //        reset
        0x4804,        //        ldr r0, =MPU_CTRL
        0x2105,        //        movs r1, #5
        0x6001,        //        str r1, [r0]
        0x4804,        //        ldr r0, =RAM
        0x2200,        //        movs r2, #0
        0x3200 | step, // next: adds r2, #step
        0x6002,        //        str r2, [r0]
        0xE7FC,        //        b next
        0xBF00,
        0xBF00,
        0xED94,
        0xE000, //        MPU_CTRL
        0x0000,
        0x2000, //        RAM
    ];
    code.iter().flat_map(|halfword| halfword.to_le_bytes()).collect()
}

/// Stops every 10 us, and resets the chip on the way if asked to. A cold run finds no kept core, not even its own.
struct Watch {
    is_cold: bool,
    resets_at: Option<u64>,
    state: Vec<u8>,
    sum: u64,
}

impl Driver<Emulated> for Watch {
    fn on_stop(&mut self, _: &mut Session<Emulated>, stop: Stop, host: &mut dyn Host) -> Option<VirtualNanos> {
        const LOOK: u64 = 10_000;
        const LONG_ENOUGH: u64 = 100 * LOOK;
        if self.is_cold {
            KEPT.lock().unwrap().clear();
        }
        if self.resets_at.is_some_and(|at| at <= stop.at.0) {
            self.resets_at = None;
            host.request_reset();
        }
        if stop.at.0 < LONG_ENOUGH {
            return Some(VirtualNanos(stop.at.0 + LOOK));
        }
        self.state = host.save_state().unwrap();
        self.sum = host.read(RAM, Width::W32).unwrap();
        None
    }
}

/// The state of the core after a run, and the image's memory.
fn run(step: u16, is_cold: bool, resets_at: Option<u64>) -> (Vec<u8>, u64) {
    let images = [Image::new(Path::new("adds"), adds(step), Some(FLASH)).unwrap()];
    let board = Emulated::new(&OCTOPUS, Vec::new(), At24c32::default(), FlashSectors::default()).unwrap();
    let session = Session::new(Box::new(board), 0, VirtualNanos(1)).unwrap();
    let watch = Watch { is_cold, resets_at, state: Vec::new(), sum: 0 };
    let finished = emulator::run(session, &Start::new(&images), watch).unwrap();
    (finished.driver.state, finished.driver.sum)
}

fn kept() -> usize {
    KEPT.lock().unwrap().len()
}

/// The only test of this program with images that set their MPU.
#[test]
fn a_run_on_a_kept_core_is_the_run_on_a_new_one() {
    assert_eq!(kept(), 0);
    let cold = [1, 3].map(|step| run(step, true, None));
    assert!(cold[0].1 > 10_000 && cold[1].1 == 3 * cold[0].1, "{} {}", cold[0].1, cold[1].1);
    for _ in 0..3 {
        assert_eq!(kept(), 1);
        assert_eq!(run(1, false, None), cold[0]);
    }
    // Code translated from another image does not run.
    assert_eq!(run(3, false, None), cold[1]);
    assert_eq!(run(1, false, None), cold[0]);
    assert_eq!(kept(), 1);
    // After a reset the run continues with the same core as before.
    let reset = [true, false].map(|is_cold| run(1, is_cold, Some(500_000)));
    assert!(reset[0].1 < cold[0].1 * 6 / 10, "{} of {}", reset[0].1, cold[0].1);
    assert_eq!(reset[0], reset[1]);
    assert_eq!(kept(), 1);
}
