//! Hosts: one to a serial line, each with lines of its own and answers of its own.
//!
//! ```text
//!   serial line ──▶ receiver ──▶ next_line ──▶ the Console carries one command out at a time
//!   serial line ◀── replies  ◀── what the command says, and what the host is told unasked
//! ```
//!
//! The main loop calls [`serving::Hosts`] at every turn; the Console has it ask for the next line when the last one is
//! answered. Nothing here knows the Console; what hosts are told after a stop is in `main_loop::halted`.
//!
//! | word | means |
//! |---|---|
//! | served | the host whose line is being carried out; its answer goes there |
//! | gone | the served host's line was opened anew, so nobody waits for the answer |
//! | urgent | what arrived and must not wait for its turn: M112, M410, M108, M24, M602, M876, M999 |
//! | forgotten | lines that a quick stop has overtaken: answered, not carried out |
//! | upload | lines that a host sends for a card (M28 to M29): answered, not carried out, for there is no card |
//! | patience | how long a host may be silent in the middle of its lines before it is prompted (`Settings::patience_ms`) |

pub(in crate::machine) mod asked;
pub(in crate::machine) mod host;
pub(in crate::machine) mod schedule;
pub(in crate::machine) mod serving;
mod upload;
