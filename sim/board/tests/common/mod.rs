//! What several tests need.

pub mod deaf;
pub mod heat_talk;
pub mod heated;
pub mod life;
pub mod lines;
pub mod lives;
pub mod on_bed;
pub mod plain_lines;
pub mod setting_lines;
pub mod trace;
pub mod wild_bed;
pub mod wild_gcode;
pub mod wild_machine;
