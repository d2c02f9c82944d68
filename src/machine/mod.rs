//! The machine: the effect of each command, from its line to its `ok`.
//!
//! ```text
//!   bytes ──▶ main loop ── line ──▶ table::parse ── Command ──▶ commands ── moves ──▶ main loop ──▶ look-ahead
//!               ▲                                               │  ▲ states                           │
//!               └────────────────────────── Answer ─────────────┘                                     ▼ move queue
//! ```
//!
//! The [`Console`] is one `async` function that is polled whenever something may have changed; it needs no
//! executor and no waker. Every wait in it turns the same main loop: take bytes in, see to emergencies, hand
//! released moves on, send replies out.
//!
//! It owns two things. The `MainLoop` holds the state that every wait needs, as a struct of owners with private fields;
//! a command that waits gets it, and uses the owners by their methods. The `States` are the state of the commands; a
//! command gets the ones that it names. No command gets the Console.
//!
//! | file or folder | for |
//! |---|---|
//! | `console` | the loop: take a line, carry it out, answer it |
//! | `commands` | the list of commands, and their dispatch |
//! | `travel`, `homing`, `bed`, `motors` | commands that move: each a file, and what several share |
//! | `heat`, `print`, `setup`, `messages` | commands about heat, prints, settings; reports and messages |
//! | `states` | the states of commands |
//! | `belt` | circulation of a closed belt, and alignment of its motors |
//! | `probe` | touches of the Z probe |
//! | `resonance` | resonance tests with an accelerometer |
//! | `main_loop` | the work during every wait, and the services for commands: plan, finish, power, reply |
//! | `reports` | lines that several rooms have |
//! | `answers` | results of commands, as values |
//! | `state` | values that earlier lines set, the machine's position, notices |
//! | `hosts` | lines from several hosts, served in turn |
//! | `release` | when moves leave the look-ahead |
//! | `ports`, `interrupt`, `numbers` | the needs from a board; why a command ends early; numbers of lines |
//! | `apart` | futures that are polled by a function of their own |
//!
//! Each uses only those below it (`WITHIN_MACHINE` in `tests/layers.rs` has the arrows, and no command may name the
//! Console).
//!
//! | word | means |
//! |---|---|
//! | turn | the Console lets all other contexts run, and polls the main loop once |
//! | main loop | all work that continues during every wait of a command |
//! | interrupt | why a command ends before it is done: M112, M410, M524, no power |
//! | rest | nothing moves |
//! | reply, send | see `reports`, `answers` |
//! | waiting, queued, dry, underrun | see `main_loop::motion`, `release` |
//! | served, urgent, forgotten | see `hosts` |

mod answers;
mod apart;
mod bed;
mod belt;
mod commands;
mod console;
mod heat;
mod homing;
mod hosts;
mod interrupt;
mod main_loop;
mod messages;
mod motors;
mod numbers;
mod ports;
mod print;
mod probe;
mod release;
mod reports;
mod resonance;
mod setup;
mod state;
mod states;
mod travel;

pub use commands::table::{codes, described, examples, names, parse};
pub use console::{Console, PortSet, Ports};
pub use hosts::host::HostMemory;
pub use interrupt::Restart;
