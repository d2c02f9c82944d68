//! State that outlasts a line: what earlier lines said that still holds, and what is known of the machine.
//!
//! Each struct owns its fields; the Console holds the structs and hands each command the ones that it needs. Pure: nothing
//! here knows the Console.
//!
//! | word | means |
//! |---|---|
//! | commanded position | where the program has sent the tool |
//! | real position | where the machine stands, from the steps that were made |
//! | named position | the commanded position as the program counts it, after G92 |
//! | edge | the end of the reachable space of a homed axis, where soft endstops put a target that lies beyond |
//! | notice | what a host is told once, not with every line |
//! | farthest | 10 m from zero, beyond which no target is computed |

pub(in crate::machine) mod fan_schedule;
pub(in crate::machine) mod heat_orders;
pub(in crate::machine) mod idle_timeout;
pub(in crate::machine) mod modal;
pub(in crate::machine) mod notices;
pub(in crate::machine) mod position;
pub(in crate::machine) mod self_tests;
pub(in crate::machine) mod soft_endstops;
pub(in crate::machine) mod waiting;
