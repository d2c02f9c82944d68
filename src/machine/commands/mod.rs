//! Commands: from a line to the file of its command.
//!
//! ```text
//!   line ──▶ table::parse ── Command ──▶ dispatch ──┬──▶ moves
//!                                                   └──▶ table: a file each ──▶ Answer
//! ```
//!
//! The Console calls `carry_out` for a line and sends the returned answer, then the `ok`. A command is a function of
//! its inputs, in a file of the folder that has its kind: `travel`, `heat`, `print`, `bed` and so on. A file that only
//! decides gets the settings that it changes. A command that waits, or uses more of the main loop than settings, gets
//! `&mut MainLoop` with its owners. The main loop keeps running during the wait. The command also gets the one to three
//! states that it names (`machine::states`).
//!
//! | file | for |
//! |---|---|
//! | [`table`] | the list of all commands, and what is made from it |
//! | [`dispatch`] | what is the same for every command: refusals, clamped values, the end of a job |
//! | [`malformed`] | what hosts read of a line that is not in order |
//! | [`silent`], [`conditions`] | rows without an effect |
//!
//! | word | means |
//! |---|---|
//! | words | the letters with numbers of a line |
//! | clamp, away | see `state` |

mod conditions;
pub(in crate::machine) mod dispatch;
mod malformed;
mod silent;
pub(in crate::machine) mod table;
