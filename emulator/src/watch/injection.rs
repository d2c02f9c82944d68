//! Faults that a run injects: into the bus, the drivers, the supply, the image itself.

use super::{GPIO, PORT_SIZE, Watch};
use crate::board::{Emulated, RAIL};
use crate::trap::TRIGGER;
use crate::wiring::PORTS;
use corehbot::motors::Motor;
use rigless::mcu::Operate;
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;

/// A supply that has fallen, in mV, as long as it lasts after the reset that it brings about: 10 ms.
const LOW_SUPPLY: u32 = 2900;
const LOW_NS: u64 = 10_000_000;

/// Where a supply that falls must have been armed for: PVDO in PWR_CSR, and line 16 in EXTI_IMR and EXTI_RTSR (RM0390 rev 6,
/// sections 5.5.2, 10.3.1 and 10.3.3).
const DETECTOR: [(u64, u64); 3] = [(0x4000_7004, 1 << 2), (0x4001_3C00, 1 << 16), (0x4001_3C08, 1 << 16)];

/// RCC_CR, and PLLON in it (RM0390 rev 6, section 6.3.1).
const RCC_CR: u64 = 0x4002_3800;
const PLLON: u64 = 1 << 24;

/// A fault that the world does to the chip.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Injection {
    /// After so many step events, the next access to a port fails on the bus.
    BusError {
        /// Events before it.
        after: usize,
    },
    /// After so many step events, a driver loses its registers.
    DriverReset {
        /// Events before it.
        after: usize,
        /// Whose driver.
        motor: Motor,
    },
    /// After so many step events, the motor supply goes away.
    SupplyLost {
        /// Events before it.
        after: usize,
    },
    /// Somebody writes to a register.
    Poke {
        /// Virtual time before it, in ns.
        after: u64,
        /// Where.
        address: u64,
        /// What.
        value: u64,
    },
    /// After so many step events, the trap in the image springs (see [`crate::trap`]).
    Trap {
        /// Events before it.
        after: usize,
    },
    /// The same, and the supply of the processor falls at that instant.
    SupplyFalls {
        /// Events before it.
        after: usize,
    },
}

impl Watch {
    /// Lets the fault happen if its time has come.
    pub(super) fn inject(
        &mut self,
        session: &mut Session<Emulated>,
        host: &mut dyn rigless::emulator::Host,
        at: VirtualNanos,
    ) {
        let events = self.recorder.events.len();
        match self.injection {
            Some(Injection::BusError { after }) if events >= after => {
                session.fail_next(GPIO, GPIO + PORTS as u64 * PORT_SIZE);
            }
            Some(Injection::DriverReset { after, motor }) if events >= after => self.drivers.of(motor).chip.reset(),
            Some(Injection::SupplyLost { after }) if events >= after => {
                Motor::ALL.into_iter().for_each(|motor| self.drivers.of(motor).chip.power_off());
            }
            Some(Injection::Trap { after }) if events >= after => self.spring(host),
            Some(Injection::SupplyFalls { after }) if events >= after => {
                let mcu = &mut session.board_mut().mcu;
                mcu.set_supply(LOW_SUPPLY);
                let mut has = |(register, bit)| mcu.peek(at, register, Width::W32).is_ok_and(|value| value & bit != 0);
                let is_armed = DETECTOR.into_iter().all(&mut has);
                self.is_supply_low = true;
                self.spring(host);
                self.is_injectable &= is_armed;
            }
            _ => return,
        }
        self.injection = None;
        self.injected = Some(at.0);
    }

    fn spring(&mut self, host: &mut dyn rigless::emulator::Host) {
        self.is_injectable = host.write(u64::from(TRIGGER), Width::W32, 1).is_ok();
    }

    /// Has the supply come back some time after the reset, and sees whether the firmware has waited for it.
    pub(super) fn restore_supply(&mut self, session: &mut Session<Emulated>, at: u64) {
        let reset_at = session.resets().first().map(|r| r.at.0);
        if !self.is_supply_low || reset_at.is_none_or(|reset| at < reset + LOW_NS) {
            return;
        }
        let mcu = &mut session.board_mut().mcu;
        let control = mcu.peek(VirtualNanos(at), RCC_CR, Width::W32);
        self.has_waited = control.is_ok_and(|control| control & PLLON == 0);
        mcu.set_supply(RAIL);
        self.is_supply_low = false;
    }

    /// Writes to the register if it is time for that.
    pub(super) fn poke(&mut self, session: &mut Session<Emulated>, at: u64) {
        if let Some(Injection::Poke { after, address, value }) = self.injection
            && at >= after
        {
            let written = session.board_mut().mcu.write(VirtualNanos(at), address, Width::W32, value);
            self.is_injectable = written.is_ok();
            self.injection = None;
            self.injected = Some(at);
        }
    }
}
