//! Reports: lines that several rooms have. All other words stand in the file of their command, or of its room.
//!
//! | file | is for |
//! |---|---|
//! | [`position`], [`heat_report`], [`fan_report`] | M114, M105, M123, and the same unasked; heat in M122 |
//! | [`sensors`] | temperature sensors: M105, M122 |
//! | [`firmware`] | M115, which a stopped machine answers too |
//! | [`mesh_report`] | the mesh of the bed, and whether z follows it |
//! | [`residual_sum`] | motors that can pull against each other |
//! | [`settings_report`] | M503 |
//! | [`setting`], [`setting_line`], [`plain_setting`], [`heat_settings_report`], [`driver_value`] | its lines, alone too |
//!
//! | word | means |
//! |---|---|
//! | part, send | see `answers` |
//! | reply | send all parts of an answer, waiting for room |
//! | tell | send lines at once, into room that is kept for them |
//! | give notice | send a message once, and not with every line that causes it |

pub(in crate::machine) mod driver_value;
pub(in crate::machine) mod fan_report;
pub(in crate::machine) mod firmware;
pub(in crate::machine) mod heat_report;
pub(in crate::machine) mod heat_settings_report;
pub(in crate::machine) mod mesh_report;
mod plain_setting;
pub(in crate::machine) mod position;
pub(in crate::machine) mod residual_sum;
mod sensors;
pub(in crate::machine) mod setting;
pub(in crate::machine) mod setting_line;
pub(in crate::machine) mod settings_report;
