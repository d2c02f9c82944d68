//! Hosts: one to a serial line, each with its own lines and answers.
//!
//! ```text
//!   serial line ──▶ receiver ──▶ next_line ──▶ the Console carries one command out at a time
//!   serial line ◀── replies  ◀── the command's answer, and periodic reports
//! ```
//!
//! The main loop calls [`serving::Hosts`] at every turn; the Console makes it request the next line when the last one
//! is answered. Nothing here knows the Console; `main_loop::halted` has the replies after a stop.
//!
//! | word | means |
//! |---|---|
//! | served | the host with the line being carried out; its answer goes there |
//! | gone | the served host's line was opened again, so the answer is discarded |
//! | urgent | commands that must not wait for their turn: M112, M410, M524, M108, M24, M602, M876, M999 |
//! | forgotten | lines that a quick stop or a cancel has overtaken: answered, not carried out |
//! | upload | lines that a host sends for a card (M28 to M29): answered, not carried out (there is no card) |
//! | patience | time that a host may be silent in the middle of its lines before a prompt (`Settings::patience_ms`) |

pub(in crate::machine) mod host;
pub(in crate::machine) mod request;
pub(in crate::machine) mod schedule;
pub(in crate::machine) mod serving;
mod told;
mod upload;
