//! Commands: the effect of each one.
//!
//! ```text
//!   Command ──▶ dispatch ──┬──▶ table: a file each, at once
//!                          └──▶ its family: one match, an arm each ──▶ moves, homing, heating, settings::set ...
//! ```
//!
//! The Console calls `carry_out` for a line and sends the returned answer, then the `ok`. A command is a function of
//! its inputs. A file that only decides gets the settings that it changes. A command that waits, or uses more of the
//! main loop than settings, gets `&mut MainLoop` with its owners. The main loop keeps running during the wait. The
//! command also gets the one to three [`states`] that it names. Where several functions need the same four, they are
//! methods of a struct that borrows them ([`moves::Moves`]).
//!
//! [`table`] has commands with an effect at once, each with all of it in one file; [`waits`] awaits the next step that
//! some of them return. The others, and the files that commands of the table share:
//!
//! | family (the same in `gcode::commands`) | its arms | its work |
//! |---|---|---|
//! | motion | [`motion`] | [`moves`], [`arcs`], [`circulate`], [`retraction`], [`waits`] |
//! | homing | [`motion`] | [`homing`], [`switch`], [`shift_z`] |
//! | first layer | [`motion`] | [`z_offset`] |
//! | jobs, pauses and waits | [`jobs`] | [`job`], [`pause`], [`parking`], [`detour`] |
//! | heaters | [`table`] | [`heating`], [`reached`], [`cold_extrusion`] |
//! | tuning of heaters | [`table`] | [`heater_settings`], [`tuning`], [`self_test`] |
//! | fans | [`table`] | [`fans`] |
//! | settings | [`settings`] | its own files, [`shaping`] (M593, M900) |
//! | motors and drivers | [`motors`] | [`drivers`], [`belt`], [`proof`] (M915), [`buzz`] |
//! | screws of z | [`motors`] | [`screws`] (G34, G35) |
//! | the Z probe | [`probing`] | `machine::probe` |
//! | the mesh of the bed | [`bed`] | [`measure`] (G29), [`levelling`] (M420), [`mesh_points`] (M421, G42) |
//! | resonances | [`resonance`] | `machine::resonance` |
//! | reports and messages | [`reports`] | [`messages`] |
//! | refused | [`refused`] | |
//! | state kept from line to line | | [`states`] |
//!
//! | word | means |
//! |---|---|
//! | words | the letters with numbers of a line |
//! | clamp, away | see `state` |

mod arcs;
mod bed;
mod belt;
mod buzz;
mod circulate;
mod cold_extrusion;
mod detour;
pub(in crate::machine) mod dispatch;
mod drivers;
mod fans;
mod heater_settings;
mod heating;
mod homing;
pub(in crate::machine) mod job;
mod jobs;
mod levelling;
mod measure;
mod mesh_points;
mod messages;
mod motion;
mod motors;
mod moves;
mod parking;
pub(in crate::machine) mod pause;
mod probing;
mod proof;
mod reached;
mod refused;
mod reports;
mod resonance;
mod retraction;
mod screws;
mod self_test;
pub(in crate::machine) mod settings;
mod shaping;
mod shift_z;
pub(in crate::machine) mod states;
mod switch;
pub(in crate::machine) mod table;
mod tuning;
mod waits;
mod z_offset;
