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
//! | `commands` | what each command does |
//! | `reports` | how it is worded what there is to say, and the telling of it |
//! | `stream` | moves into the look-ahead and out of it, and the machine to rest |
//! | `power` | power for the motors, and talks with their drivers |
//! | `belt` | a closed belt runs round |
//! | `heat` | orders for heaters and fans, and what is looked at while they are on |
//! | `scrub` | whether settings in RAM are what was put in |
//! | `halted` | after a stop: what hosts are told until M999 |
//! | `answers` | what there is to say, as values |
//! | `hosts` | lines from several hosts, served in turn |
//! | `release` | when moves leave the look-ahead |
//! | `state` | what earlier lines said, where the machine stands, what was noticed |
//! | `ports`, `interrupt`, `numbers` | what is needed of a board; why a command ends early; numbers of lines |
//!
//! Each uses only those of the lines above its own (`tests/layers.rs` finds circles):
//!
//! 1. `ports`, `interrupt`, `release`, `hosts`, `numbers`, and `state`, which uses `numbers`
//! 2. `answers`
//! 3. `console`, which owns all of the above; none of them knows it
//! 4. `halted`, `scrub`, `heat`, `power`, `belt`, `stream`, `commands`, and `reports`, which uses `commands`: they are `impl Console`, parts of the
//!    crank and what waits, for every wait turns the crank
//!
//! | word | means |
//! |---|---|
//! | turn | the Console lets everybody else go on, and turns the crank once |
//! | crank | everything that must go on whatever a command waits for |
//! | interrupt | why a command ends before it is done: M112, M410, no power |
//! | rest | nothing moves |
//! | tell, say | see `reports`, `answers` |
//! | waiting, queued, dry, underrun | see `stream`, `release` |
//! | served, urgent, forgotten | see `hosts` |

mod answers;
mod belt;
mod commands;
mod console;
mod halted;
mod heat;
mod hosts;
mod interrupt;
mod numbers;
mod ports;
mod power;
mod release;
mod reports;
mod scrub;
mod state;
mod stream;

pub use console::{Console, PortSet, Ports};
pub use interrupt::Restart;
