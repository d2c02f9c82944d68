//! Commands: what each of them does, and the state that it keeps.

pub(in crate::machine) mod arcs;
pub(in crate::machine) mod clamps;
pub(in crate::machine) mod dispatch;
pub(in crate::machine) mod drivers;
pub(in crate::machine) mod homing;
pub(in crate::machine) mod pauses;
pub(in crate::machine) mod retraction;
pub(in crate::machine) mod settings;
pub(in crate::machine) mod shaping;
