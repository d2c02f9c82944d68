//! The interrupt table.

use super::fault::give_up;
use super::irq::Irq;
use super::{contexts, serial};

/// An entry of the table.
type Handler = extern "C" fn();

extern "C" fn unexpected() {
    give_up(format_args!("an interrupt that nobody enabled"));
}

const fn table() -> [Handler; 32] {
    let mut table: [Handler; 32] = [unexpected; 32];
    table[Irq::Received as usize] = serial::on_received;
    table[Irq::Transmitted as usize] = serial::on_transmitted;
    table[Irq::StepTimer as usize] = contexts::on_step_timer;
    table[Irq::Overrun as usize] = serial::on_overrun;
    table[Irq::Thermal as usize] = contexts::on_thermal;
    table[Irq::Console as usize] = contexts::on_console;
    table[Irq::Generator as usize] = contexts::on_generator;
    table
}

/// Where the processor finds the handlers; cortex-m-rt's link.x knows the table by this name.
// SAFETY: the section is meant for an array of handler addresses (cortex-m-rt, feature `device`), and no
// other item has this name.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Handler; 32] = table();
