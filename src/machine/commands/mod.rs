//! Commands: the effect of each one.
//!
//! ```text
//!   Command ──▶ dispatch ──┬──▶ immediate ──▶ settings::set, drivers, retraction, modal state ...   done at once
//!                          └──▶ blocking  ──▶ moves, homing, waits, settings::stored ...           awaited
//! ```
//!
//! The Console calls `carry_out` for a line and sends the returned answer, then the `ok`. A command is a function of
//! its inputs. A file that only decides gets the settings that it changes. A command that waits, or uses more of the
//! main loop than settings, gets `&mut MainLoop` with its owners, which keeps running during the wait, and the one to
//! three [`states`] that it names. Where several functions need the same four, they are methods of a struct that borrows them
//! ([`moves::Moves`]).
//!
//! | looking for | see |
//! |---|---|
//! | G0 to G3, G10, G11 | [`moves`], [`arcs`], [`circulate`], [`retraction`] |
//! | G28 | [`homing`], [`switch`] |
//! | M17, M84, M122 | [`motors`] |
//! | M915 | [`belt`], [`proof`] |
//! | G4 | [`waits`] |
//! | M0, M24, M25, M125, M600 | [`pause`] |
//! | M75, M77, M524, the end of a print | [`job`] |
//! | M104, M109, M116, M140, M141, M190, M191, M81 | [`heating`] |
//! | M302 | [`cold_extrusion`] |
//! | M303 | [`tuning`] |
//! | SELF_TEST | [`self_test`] |
//! | MACHINE_GET, MACHINE_PUT, MACHINE_STORE | [`machine_record`] |
//! | M106, M107, M710 | [`fans`] |
//! | M301, M304, M306 | [`heater_settings`] |
//! | M593, M900, M572 | [`shaping`] |
//! | M569, M906, M913, M914 | [`drivers`] |
//! | M92, M201 to M205, M500 to M504 | [`settings`] |
//! | state kept from line to line | [`states`] |
//! | anything else | its arm in [`immediate`] or [`blocking`] |
//!
//! | word | means |
//! |---|---|
//! | words | the letters with numbers of a line |
//! | clamp, away | see `state` |

mod arcs;
mod belt;
mod blocking;
mod circulate;
mod cold_extrusion;
pub(in crate::machine) mod dispatch;
mod drivers;
mod fans;
mod heater_settings;
mod heating;
mod homing;
mod immediate;
pub(in crate::machine) mod job;
mod machine_record;
mod messages;
mod motors;
mod moves;
pub(in crate::machine) mod pause;
mod proof;
mod retraction;
mod self_test;
pub(in crate::machine) mod settings;
mod shaping;
pub(in crate::machine) mod states;
mod switch;
mod tuning;
mod waits;
