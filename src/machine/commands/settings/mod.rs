//! Settings as G-code sees them: set and stored.
//!
//! | file | does | commands |
//! |---|---|---|
//! | [`set`] | takes the values of a line, each brought into its legal range | M92, M113, M201, M203, M204, M205, SET_VELOCITY_LIMIT |
//! | [`stored`] | keeps all settings in memory that survives without power | M500, M501, M502, M504 |
//!
//! What a setting is, and its legal range, stands in `crate::settings`; its record in `crate::storage`. Settings of
//! drivers and shapers are set in the files of these names, one folder up, and stored here. What M207 and M208 set is
//! not stored (`retraction`). How a setting is said, as the line that sets it, stands in `reports::settings_report`.

pub(in crate::machine) mod set;
pub(in crate::machine) mod stored;
