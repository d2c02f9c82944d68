//! Modal state: what earlier lines said that still holds.
//!
//! | word | means |
//! |---|---|
//! | commanded position | where the program has sent the tool |
//! | named position | the commanded position as the program counts it, after G92 |
//! | edge | the end of the reachable space of a homed axis, where soft endstops put a target that lies beyond |
//! | fence | 10 m from zero, beyond which no target is computed |

pub(in crate::machine) mod modal;
pub(in crate::machine) mod soft_endstops;
