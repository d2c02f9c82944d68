//! Settings as G-code sees them: set and stored.
//!
//! | file | does | commands |
//! |---|---|---|
//! | [`set`] | takes the values of a line if all are legal | M92, M113, M201, M203 to M205, SET_VELOCITY_LIMIT |
//! | [`stored`] | keeps all settings in memory that survives without power | M500, M501, M502, M504 |
//!
//! `crate::settings` defines a setting and its legal range, `crate::storage` its record. Settings of drivers and
//! shapers are set in the files of these names, one folder up, and stored here. The values of M207 and M208 are not
//! stored (`retraction`). `reports::settings_report` writes each setting as the line that sets it.

pub(in crate::machine) mod set;
pub(in crate::machine) mod stored;
