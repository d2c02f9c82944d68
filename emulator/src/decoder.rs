//! The address decoder in front of the crate's bus: it leads the USB core's addresses to a window of its own.
//!
//! The crate's tables of OTG_FS lack GRXSTSP, two endpoints of each direction and all FIFOs. Their power register block
//! lies over the first FIFO. So all accesses of the processor to OTG_FS go to an address that no other part has. The
//! board has put [`UsbPort`](crate::usb_port::UsbPort) there.

use rigless::emulator::{Access, Checked, CoreBus, InterruptLine, Queued};
use rigless::time::VirtualNanos;
use std::ops::Range;

/// OTG_FS: registers and FIFOs (RM0390 rev 6, sections 2.2.2 and 31.15.1).
pub const OTG_FS: Range<u64> = 0x5000_0000..0x5002_0000;

/// Bank 1 of the external memory controller (RM0390 rev 6, section 2.2.2): no board has memory there.
pub const WINDOW: u64 = 0x6000_0000;

/// A bus behind the decoder.
pub struct Decoder<'a>(pub &'a mut dyn CoreBus);

/// The access as the bus behind sees it.
fn lead(access: Access) -> Access {
    let from = if OTG_FS.contains(&access.address) { WINDOW - OTG_FS.start } else { 0 };
    let led = Access::new(access.kind, access.address + from, access.width, access.value)
        .at(access.instruction_count, access.virtual_time);
    match access.program_counter {
        Some(counter) => led.by_instruction(counter),
        None => led,
    }
}

impl CoreBus for Decoder<'_> {
    fn access(&mut self, access: Access, from_code: bool) -> Option<u64> {
        self.0.access(lead(access), from_code)
    }

    fn time(&self, instructions: u64) -> VirtualNanos {
        self.0.time(instructions)
    }

    fn queued(&mut self) -> Vec<Queued> {
        self.0.queued()
    }

    fn carry_on(&mut self, instructions: u64, event: Option<VirtualNanos>) -> Option<u32> {
        self.0.carry_on(instructions, event)
    }

    fn acknowledge(&mut self, line: InterruptLine, instructions: u64) -> Option<u64> {
        self.0.acknowledge(line, instructions)
    }

    fn read_checked(&mut self, access: Access, report: bool) -> Option<Checked> {
        self.0.read_checked(access, report)
    }

    fn write_checked(&mut self, access: Access) -> Option<bool> {
        self.0.write_checked(access)
    }

    fn stops_before(&mut self, access: &Access) -> bool {
        self.0.stops_before(access)
    }

    fn send_trace(&mut self, bytes: &[u8]) {
        self.0.send_trace(bytes);
    }
}
