//! The Stepper's context: its exception, and who else reads or sets the words of the step pins.

use corehbot::app::{StepPorts, StepperKit};
use corehbot::motion;
use corehbot_cortex_m4::Handover;
use cortex_m_rt::exception;

use crate::step_pins::{DirRow, Dirs, Row, StepPins, Steps};
use crate::step_timer::StepTimer;
use crate::wake::IrqWake;

type Stepper = motion::Stepper<'static, StepPins, StepTimer, IrqWake>;

/// The Stepper itself, which its interrupt finds so with one load less.
static STEPPER: Handover<Stepper> = Handover::new();

/// Makes the Stepper, which lives with its interrupt.
#[inline(never)]
pub fn give_stepper(kit: StepperKit<'static>, ports: StepPorts<StepPins, StepTimer>) {
    STEPPER.fill(kit.make(ports, IrqWake));
}

// The section of the handler below begins with a line of flash. So the handler takes as few lines as it can wherever
// the linker puts it (`octopus_isr_flash_lines` of `cargo xtask bench`).
core::arch::global_asm!(".pushsection .text.SysTick, \"ax\", %progbits", ".p2align 4", ".popsection");

/// A step is due, or software wants the Stepper to look.
// In a section of its own name. So the tool that moves common parts of functions into shared functions, to save flash,
// leaves this one alone.
#[exception]
#[unsafe(link_section = ".text.SysTick")]
fn SysTick() {
    // SAFETY:
    // - `give_stepper` fills the place before any code runs that could set the alarm or pend this exception: the
    //   Stepper, the Console, the StepGenerator and ThermalControl all begin later;
    // - no other code uses the place, and an exception does not interrupt itself.
    unsafe { STEPPER.with_alone(|stepper| stepper.on_alarm()) };
}

/// A row of the step pins' words, copied while nothing interrupts, which is all that ever holds off the Stepper.
pub fn step_pins_row(number: usize) -> Option<Row> {
    cortex_m::interrupt::free(|_| {
        // SAFETY: `contexts::start` is called after `give_stepper`; no other context runs now, and no caller of this
        // works with the Stepper.
        unsafe { STEPPER.with_alone(|stepper| stepper.port().row(number)) }
    })
}

/// The same of the direction pins.
pub fn step_pins_dir_row(number: usize) -> Option<DirRow> {
    // SAFETY: as for [`step_pins_row`].
    cortex_m::interrupt::free(|_| unsafe { STEPPER.with_alone(|stepper| stepper.port().dir_row(number)) })
}

/// Gives the step pins another coupling, returns the previous one, and sets the direction lines again. At rest: it
/// moves 128 words, some 2 us.
pub fn couple_step_pins(steps: &mut Steps, dirs: &mut &'static mut Dirs) {
    // SAFETY: as for [`step_pins_row`].
    cortex_m::interrupt::free(|_| unsafe {
        STEPPER.with_alone(|stepper| stepper.recouple(|pins| pins.couple(steps, dirs)))
    });
}
