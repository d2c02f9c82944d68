//! Reports and replies: the machine's output, on request and by itself.
//!
//! ```text
//!   command ── Answer ──▶ main loop::tell ── which report ──▶ report, driver_report, sensors, message, ...
//!                                                           └── Speaker: one part after the other ──▶ host
//! ```
//!
//! | file | is for |
//! |---|---|
//! | `answers` | **what** a command has to say, as a value |
//! | [`report`] and the files beside it | **how** it is worded |
//! | `main_loop::tell` | words single lines, chooses the report of several, and waits for room |
//!
//! | word | means |
//! |---|---|
//! | part, say | see `answers` |
//! | tell | say all parts of an answer, waiting for room |
//! | give notice | say something once, and not with every line that it is true of |

pub(in crate::machine) mod belt_report;
pub(in crate::machine) mod driver_report;
pub(in crate::machine) mod heat_report;
pub(in crate::machine) mod heat_settings_report;
pub(in crate::machine) mod machine_report;
pub(in crate::machine) mod message;
pub(in crate::machine) mod report;
pub(in crate::machine) mod sensors;
pub(in crate::machine) mod settings_report;
pub(in crate::machine) mod storage_report;
