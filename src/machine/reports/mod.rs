//! Reports and replies: the machine's output, on request and by itself.
//!
//! ```text
//!   command ── Answer ──▶ main_loop::reply ── a report ──▶ report, driver_report, sensors, ...
//!                                                          └── ReplyWriter: one part after the other ──▶ host
//! ```
//!
//! | file | is for |
//! |---|---|
//! | `answers` | the **content** of an answer, as a value |
//! | [`report`] and the files next to it | its **wording** |
//! | `main_loop::reply` | words single lines, chooses the report of several, and waits for room |
//!
//! | word | means |
//! |---|---|
//! | part, send | see `answers` |
//! | reply | send all parts of an answer, waiting for room |
//! | give notice | send a message once, and not with every line that causes it |

pub(in crate::machine) mod belt_report;
pub(in crate::machine) mod buzz_report;
pub(in crate::machine) mod driver_report;
pub(in crate::machine) mod fan_report;
pub(in crate::machine) mod heat_report;
pub(in crate::machine) mod heat_settings_report;
pub(in crate::machine) mod machine_report;
pub(in crate::machine) mod mesh_report;
mod plain_setting;
pub(in crate::machine) mod probe_report;
pub(in crate::machine) mod report;
pub(in crate::machine) mod resonance_report;
pub(in crate::machine) mod screw_report;
pub(in crate::machine) mod sensors;
pub(in crate::machine) mod settings_report;
pub(in crate::machine) mod storage_report;
