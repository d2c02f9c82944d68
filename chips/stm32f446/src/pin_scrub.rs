//! The pin scrub checks the port words that the Stepper writes, which stay in RAM as long as the machine runs. A bit
//! that flips by itself would step another motor, or none. The scrub checks them every second, row by row. A step that
//! falls due in between waits for one row at most, some 20 cycles.

use corehbot::fault::{Cause, Fault};
use corehbot::settings::sum;
use corehbot::status::Status;

use crate::motor_power;
use crate::step_pins::COUPLED_ROWS;
use crate::stepper::{step_pins_dir_row, step_pins_row};
use crate::time;

/// Between two looks, in ms.
const EVERY: u32 = 900;

/// Checks the words as long as the machine runs; a changed word is a fault.
#[embassy_executor::task]
pub async fn run(status: &'static Status) {
    let (mut couplings, mut coupled, lasting) = (motor_power::couplings(), sum_of_coupled(), sum_of_lasting());
    loop {
        time::pass(EVERY).await;
        let (now, sum) = (motor_power::couplings(), sum_of_coupled());
        if now != couplings {
            // Other words were written.
            (couplings, coupled) = (now, sum);
        }
        if sum != coupled || sum_of_lasting() != lasting {
            status.fault().set(Fault::plain(Cause::SettingsDamaged));
        }
    }
}

/// The sum of the words that are others in another coupling. No two rows are read at once.
fn sum_of_coupled() -> u32 {
    let of_steps = (0..COUPLED_ROWS).map_while(step_pins_row).fold(0, |sum_so_far, row| sum(&(sum_so_far, row)));
    (0..).map_while(step_pins_dir_row).fold(of_steps, |sum_so_far, row| sum(&(sum_so_far, row)))
}

/// The sum of the words that stay: ports, levels at rest, inputs.
fn sum_of_lasting() -> u32 {
    (COUPLED_ROWS..).map_while(step_pins_row).fold(0, |sum_so_far, row| sum(&(sum_so_far, row)))
}
