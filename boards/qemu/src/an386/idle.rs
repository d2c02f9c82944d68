//! The idle loop, which decides how fast virtual time passes.
//!
//! QEMU's virtual time counts instructions, 8 ns each, and while nothing happens it runs some 40 times as fast as the
//! host's clock. A host program needs wall time, so it would look extremely slow from here. The motion would run dry
//! between two lines, and the steps would depend on the host's load. So there are two ways to idle:
//!
//! - The Console waits for the host by semihosting calls. Each takes the host a microsecond but only two instructions
//!   here. QEMU needs 45 to 65 us of wall time for a byte, which then takes 4 to 8 us of virtual time with all its
//!   handling. So the line is as fast as one of 2 Mbaud (measured with QEMU 7.2 on two cores: 700 lines a second, and
//!   7000 a virtual second).
//! - Otherwise: nops. WFI and WFE are out of the question, for QEMU then adds the host's delays to
//!   virtual time, or passes it twice (seen in versions 7.2 and 10.0).

use corehbot::status::Status;

use super::serial;

/// Semihosting calls between two polls of the status; few enough that no poll is later than a byte.
const CALLS: u32 = 64;

/// Idles until the host has ended and all motion is done.
pub fn run(status: &Status) {
    loop {
        if !status.is_awaiting_input() {
            pass_time();
        } else if !serial::is_ended() {
            call_host();
        } else {
            return;
        }
    }
}

/// Makes [`CALLS`] semihosting calls that do nothing (SYS_ERRNO), each of two instructions: a loop in Rust takes eight.
// SAFETY: changes only registers that a function may change.
#[unsafe(naked)]
extern "C" fn call_host() {
    core::arch::naked_asm!(
        "movs r1, #0",
        ".rept {calls}",
        "movs r0, #0x13",
        "bkpt #0xab",
        ".endr",
        "bx lr",
        calls = const CALLS,
    )
}

/// Lets 200 instructions pass. QEMU makes one block of them that it runs in no time; with longer blocks it
/// gets slower again, as it cuts them where a timer is due.
// SAFETY: changes no register but the program counter.
#[unsafe(naked)]
extern "C" fn pass_time() {
    core::arch::naked_asm!(".rept 200", "nop", ".endr", "bx lr")
}
