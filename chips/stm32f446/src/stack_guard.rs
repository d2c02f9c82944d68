//! The stack guard: two regions of the MPU under the stack that nothing may touch.
//!
//! The stack lies at the bottom of RAM and grows down (memory.x), so an overflow overwrites no variable. But the bus
//! decides what happens to accesses below RAM, and no manual promises a fault for each of them. The MPU does:
//!
//! - Region 7, the lowest KiB of RAM, stops a stack that grows by calls and exceptions.
//! - Region 6, the 32 KiB below RAM, stops one frame that reaches past the KiB. All frames are smaller than a KiB,
//!   except for the start-up function that builds the machine. The firmware reads nothing in these 32 KiB (RM0390,
//!   2.2.2: it reads the option bytes by registers).
//!
//! An access there is a MemManage fault. That exception stays disabled, so that every fault in any context is a
//! HardFault, which takes a fresh stack (see [`fault`](crate::fault)). An exception with a frame that no longer fits
//! faults in the same way on entry (ARM DDI 0403E, B1.5.6 and B1.5.11: MSTKERR).
//!
//! HFNMIENA stays 0: HardFault and NMI run without the MPU. An NMI (a crystal that stops) on a stack that is nearly
//! full then has the KiB to run in.
//!
//! Two more regions describe flash and RAM with the attributes of the processor's default map. Region 0 is the flash.
//! Region 1 is the RAM, where execution is forbidden, so a wild jump into data faults at once. An emulator that checks
//! each access of the default map by itself runs in a quarter less time with them. Everywhere else the default map
//! holds (PRIVDEFENA).

use cortex_m::asm;
use cortex_m::peripheral::scb::Exception;
use cortex_m::peripheral::{MPU, SCB};

/// The lowest KiB of the stack, which is the lowest of RAM.
const GUARD: u32 = 1024;

/// Size of the guarded memory below it.
const BELOW: u32 = 32 * 1024;

/// Where flash begins, and its size (RM0390, 3.3; STM32F446xE).
const FLASH: (u32, u32) = (0x0800_0000, 512 * 1024);

/// The size of SRAM1 and SRAM2 together, which begin with the stack (RM0390, 2.2.2).
pub const RAM_SIZE: u32 = 128 * 1024;

/// Regions of the MPU (STM32F446 datasheet, features: memory protection unit; PM0214 rev 10, 4.2).
const REGIONS: u32 = 8;

/// ENABLE and PRIVDEFENA (ARM DDI 0403E, B3.5.6).
const ON: u32 = 1 << 2 | 1;

/// An exception frame with floating point, which is the largest single push. An access to the guard is an overflow if
/// the stack pointer is at most this far above the guard.
const LARGEST_STORE: u32 = 256;

unsafe extern "C" {
    /// The lowest address of the stack (memory.x).
    static _stack_end: u32;
}

/// The RAM that all code may access.
pub fn usable() -> core::ops::Range<u32> {
    bottom() + GUARD..bottom() + RAM_SIZE
}

fn bottom() -> u32 {
    &raw const _stack_end as u32
}

/// A region of `size` bytes, a power of two, without any access and without execution (ARM DDI 0403E, B3.5.9: XN, AP
/// 000).
const fn no_access(size: u32) -> u32 {
    1 << 28 | (size.ilog2() - 1) << 1 | 1
}

/// A region of `size` bytes with every access that the default map grants, and its attributes (ARM DDI 0403E, B3.1 and
/// B3.5.9: AP 011): flash is written through (C), RAM is written back and allocated (TEX 001, C, B) and never executed
/// (XN).
const fn full_access(size: u32, is_ram: bool) -> u32 {
    let attributes = if is_ram { 1 << 28 | 1 << 19 | 1 << 17 | 1 << 16 } else { 1 << 17 };
    attributes | 3 << 24 | (size.ilog2() - 1) << 1 | 1
}

/// Guards the stack from here on, whatever the MPU did before.
pub fn start(mpu: &mut MPU, scb: &mut SCB) {
    for exception in [Exception::MemoryManagement, Exception::BusFault, Exception::UsageFault] {
        scb.disable(exception);
    }
    // SAFETY: the guards hold no used variable. The linker places none in the stack, and the stack gives up its lowest
    // KiB; there is no memory below. All other memory stays accessible as without an MPU, and no code lies in RAM.
    unsafe {
        // Off while it changes: a bootloader may have left any regions.
        mpu.ctrl.write(0);
        for region in 0..REGIONS {
            mpu.rnr.write(region);
            mpu.rasr.write(0);
        }
        // Where regions overlap the highest number counts, so the guard is above the RAM (ARM DDI 0403E, B3.5).
        for (region, base, access) in [
            (REGIONS - 1, bottom(), no_access(GUARD)),
            (REGIONS - 2, bottom() - BELOW, no_access(BELOW)),
            (1, bottom(), full_access(RAM_SIZE, true)),
            (0, FLASH.0, full_access(FLASH.1, false)),
        ] {
            mpu.rnr.write(region);
            mpu.rbar.write(base);
            mpu.rasr.write(access);
        }
        mpu.ctrl.write(ON);
    }
    asm::dsb();
    asm::isb();
}

/// Whether a memory fault with this stack pointer is one of a full stack.
pub fn is_overflow(stack: u32) -> bool {
    (bottom() - BELOW..bottom() + GUARD + LARGEST_STORE).contains(&stack)
}
