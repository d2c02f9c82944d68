//! The machine: what each command does, from the line that asked for it to the `ok` that answers it.
//!
//! ```text
//!   bytes ──▶ hosts ── line ──▶ gcode::parse ── Command ──▶ commands ── moves ──▶ stream ──▶ look-ahead ──▶ move queue
//!               ▲                                            │  ▲ state
//!               └────────────── reports ◀── Answer ──────────┘
//! ```
//!
//! The [`Console`] is one `async` function that is polled whenever something may have changed; it needs no
//! executor and no waker. Every wait in it turns the same crank: take bytes in, see to emergencies, hand
//! released moves on, send replies out.
//!
//! | file or folder | for |
//! |---|---|
//! | `console` | the loop and the crank |
//! | `hosts` | lines from several hosts, served in turn; what they are told after a stop |
//! | `commands` | what each command does |
//! | `state` | what earlier lines said, where the machine stands, what was noticed |
//! | `stream` | moves into the look-ahead and out of it, at the right time |
//! | `reports` | what is said, and how it is worded |
//! | `power` | power for the motors, and talks with their drivers |
//! | `heat` | orders for heaters and fans, and what is looked at while they are on |
//! | `scrub` | whether settings in RAM are what was put in |
//!
//! | word | means |
//! |---|---|
//! | turn | the Console lets everybody else go on, and turns the crank once |
//! | crank | everything that must go on whatever a command waits for |
//! | interrupt | why a command ends before it is done: M112, M410, no power |
//! | rest | nothing moves |
//! | tell, say | see `reports` |
//! | waiting, queued, dry, underrun | see `stream` |
//! | served, urgent, forgotten | see `hosts` |

mod commands;
mod console;
mod heat;
mod hosts;
mod interrupt;
mod numbers;
mod ports;
mod power;
mod reports;
mod scrub;
mod state;
mod stream;

pub use console::{Console, PortSet, Ports};
pub use interrupt::Restart;
