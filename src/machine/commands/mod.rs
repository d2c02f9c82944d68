//! Commands: what each of them does, and the state that it keeps.

pub(in crate::machine) mod angle;
pub(in crate::machine) mod arc;
pub(in crate::machine) mod clamps;
pub(in crate::machine) mod dispatch;
pub(in crate::machine) mod drivers;
pub(in crate::machine) mod homing;
pub(in crate::machine) mod message;
pub(in crate::machine) mod pause;
pub(in crate::machine) mod retraction;
pub(in crate::machine) mod setting;
pub(in crate::machine) mod settings_storage;
pub(in crate::machine) mod shaping;
pub(in crate::machine) mod tuning;
