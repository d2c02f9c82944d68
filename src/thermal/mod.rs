//! Heat: sensors, heaters, fans, and the guards that watch them.
//!
//! ```text
//!   Console ── Order ──▶ ThermalControl ── duties ──▶ heaters, fans
//!      ▲                  │  ▲
//!      │                  │  └── samples ── converter
//!      └── status::Heat ◀─┤
//!                         └── guards ──▶ fault::Latch ──▶ all heaters off, power supply off if a switch sticks
//! ```
//!
//! [`ThermalControl`] runs once in a control period of 20 ms, in its own context between the step interrupts and the
//! Console, so no command delays it. Everything is in fixed point, so there is no NaN.
//!
//! | word | means |
//! |---|---|
//! | period | control period, 20 ms |
//! | room | the air around the machine, not a folder of `src` |
//! | element, block, sensor | the three masses of a heater's model |
//! | lag | time constant between two of them |
//! | drift | power that is missing in the model, as the observer has learned |
//! | gain | ratio of the heater's real power to its model's |
//! | excess | excess temperature that the block will have with the heat on its way to it |
//! | doubtful | a reading that is impossible |

mod control;
mod fans;
mod fixed_point;
pub mod guard;
mod heartbeats;
mod heater;
mod heater_guards;
mod lag_watch;
mod observer;
mod order;
mod pid;
mod predictive;
mod refusal;
mod room;
mod second_sensor;
mod self_test;
pub mod sensor;
mod switching;
mod tune;

pub use control::ThermalControl;
pub use fixed_point::PERIOD_MS;
pub use guard::{baseline_subject, hidden, is_alike};
pub use order::{Common, Order, OrderQueue, Orders, OrdersIn};
pub use refusal::refusal;
pub use self_test::subject as test_subject;
