//! The scrub of the pins' words: what the Stepper makes edges of lies in RAM for as long as the machine runs, and a bit of it that
//! flips by itself would step another motor, or none. It is looked at every second, row by row; a step that is due meanwhile
//! waits for one row at most, some 20 cycles.

use corehbot::fault::{Cause, Fault};
use corehbot::settings::sum;
use corehbot::status::Status;
use embassy_time::{Duration, Timer};

use crate::contexts::{step_pins_dir_row, step_pins_row};
use crate::drivers;

/// Between two looks.
const EVERY: Duration = Duration::from_millis(900);

/// Looks at the words as long as the machine runs; what has changed is a fault.
#[embassy_executor::task]
pub async fn run(status: &'static Status) {
    let (mut coupled, mut whole) = (drivers::couplings(), sum_of_words());
    loop {
        Timer::after(EVERY).await;
        let (now, sum) = (drivers::couplings(), sum_of_words());
        if now != coupled {
            // Other words were written.
            (coupled, whole) = (now, sum);
        } else if sum != whole {
            status.fault().set(Fault::plain(Cause::SettingsDamaged));
        }
    }
}

/// The sum of all words, of which no two rows are read at once.
fn sum_of_words() -> u32 {
    let rows = (0..).map_while(step_pins_row);
    let of_rows = rows.fold(0, |sum_so_far, row| sum(&(sum_so_far, row)));
    (0..).map_while(step_pins_dir_row).fold(of_rows, |sum_so_far, row| sum(&(sum_so_far, row)))
}
