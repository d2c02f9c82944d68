//! Commands: what each of them does. The state that they keep is in `state`.
//!
//! ```text
//!   Command ──▶ dispatch ──┬──▶ immediate ──▶ settings::set, drivers, retraction, modal state ...   done at once
//!                          └──▶ blocking  ──▶ moves, homing, waits, settings::stored ...           awaited
//! ```
//!
//! The Console calls `execute` for a line and tells the answer that comes back, then the `ok`. Files that only decide
//! (retraction, shaping, drivers, heater settings, `settings::set`) are plain functions that get what they need as arguments. Files that wait (blocking, moves, homing, waits, `settings::stored`) are parts of
//! the Console, because every wait turns its crank.
//!
//! | looking for | see |
//! |---|---|
//! | G0 to G3, G10, G11 | [`moves`], [`arcs`], [`retraction`] |
//! | G28 | [`homing`] |
//! | G4, M0, M24, M25, M600 | [`waits`] |
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
//! | anything else | its arm in [`immediate`] or [`blocking`] |
//!
//! | word | means |
//! |---|---|
//! | words | the letters with numbers of a line |
//! | clamp, away | see `state` |

pub(in crate::machine) mod arcs;
pub(in crate::machine) mod blocking;
pub(in crate::machine) mod cold_extrusion;
pub(in crate::machine) mod dispatch;
pub(in crate::machine) mod drivers;
pub(in crate::machine) mod fans;
pub(in crate::machine) mod heater_settings;
pub(in crate::machine) mod heating;
pub(in crate::machine) mod homing;
pub(in crate::machine) mod immediate;
pub(in crate::machine) mod machine_record;
pub(in crate::machine) mod moves;
pub(in crate::machine) mod retraction;
pub(in crate::machine) mod self_test;
pub(in crate::machine) mod settings;
pub(in crate::machine) mod shaping;
pub(in crate::machine) mod tuning;
pub(in crate::machine) mod waits;
