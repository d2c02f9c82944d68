//! The machine: what each command does, from the line that asked for it to the `ok` that answers it.
//!
//! ```text
//!   bytes ──▶ main loop ── line ──▶ gcode::parse ── Command ──▶ commands ── moves ──▶ main loop ──▶ look-ahead ──▶ move queue
//!               ▲                                            │  ▲ states
//!               └────────────── reports ◀── Answer ──────────┘
//! ```
//!
//! The [`Console`] is one `async` function that is polled whenever something may have changed; it needs no
//! executor and no waker. Every wait in it turns the same main loop: take bytes in, see to emergencies, hand
//! released moves on, send replies out.
//!
//! It owns two things. The `MainLoop` holds what must go on in every wait, with private fields; a command that waits
//! gets it, and may do with it what its door allows. The `States` are what commands keep for themselves; a command gets
//! the ones that it names. Nobody gets the Console.
//!
//! | file or folder | for |
//! |---|---|
//! | `console` | the loop: take a line, carry it out, answer it |
//! | `commands` | what each command does |
//! | `belt` | a closed belt runs round, and its motors are aligned |
//! | `main_loop` | what goes on in every wait, and what a command may have it do: plan, finish, power, tell |
//! | `reports` | how it is worded what there is to say |
//! | `answers` | what there is to say, as values |
//! | `state` | what earlier lines said, where the machine stands, what was noticed |
//! | `hosts` | lines from several hosts, served in turn |
//! | `release` | when moves leave the look-ahead |
//! | `ports`, `interrupt`, `numbers` | what is needed of a board; why a command ends early; numbers of lines |
//!
//! Each uses only those below it (`WITHIN_MACHINE` in `tests/layers.rs` has the arrows, and holds that no command names
//! the Console).
//!
//! | word | means |
//! |---|---|
//! | turn | the Console lets everybody else go on, and turns the main loop once |
//! | main loop | everything that must go on whatever a command waits for |
//! | interrupt | why a command ends before it is done: M112, M410, no power |
//! | rest | nothing moves |
//! | tell, say | see `reports`, `answers` |
//! | waiting, queued, dry, underrun | see `main_loop::stream`, `release` |
//! | served, urgent, forgotten | see `hosts` |

mod answers;
mod belt;
mod commands;
mod console;
mod hosts;
mod interrupt;
mod main_loop;
mod numbers;
mod ports;
mod release;
mod reports;
mod state;

pub use console::{Console, PortSet, Ports};
pub use interrupt::Restart;
