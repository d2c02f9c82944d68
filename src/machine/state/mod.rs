//! State: what earlier lines said that still holds, what is known of the machine, and what the present line asked for
//! beyond its ranges.
//!
//! Each struct owns its fields. What goes on changing while a command waits is held by the main loop, the rest by
//! `commands::states`, of which `immediate` and `blocking` hand each command the ones that it needs. Pure: nothing here
//! knows either.
//!
//! | looking for | see |
//! |---|---|
//! | G90, G91, G20, F, overrides | [`modal`] |
//! | where the program has sent the tool, G92 | [`commanded`] |
//! | G10, G11 | [`retraction`] |
//! | which axes are homed, where the machine stands | [`position`], [`soft_endstops`] |
//! | a belt that runs round, motors of one belt that agree | [`circulation`], [`trimming`] |
//! | a belt that has lost a motor | [`limping`] |
//! | what a command waits for | [`pauses`], [`waiting`] |
//! | whether a print is under way, paused or ended; what a pause keeps of it | [`job`], [`program`] |
//! | orders for heaters and fans on their way | [`heat_orders`], [`fan_schedule`], [`self_tests`] |
//! | a machine on its way over the line | [`machine_pieces`] |
//! | what pressure advance the motion follows, when motors lose their power at rest | [`advance_in_use`], [`idle_timeout`] |
//! | values out of range | [`clamps`] |
//! | what a host was told once | [`notices`] |
//!
//! | word | means |
//! |---|---|
//! | commanded position | where the program has sent the tool |
//! | real position | where the machine stands, from the steps that were made |
//! | named position | the commanded position as the program counts it, after G92 |
//! | edge | the end of the reachable space of a homed axis, where soft endstops put a target that lies beyond |
//! | notice | what a host is told once, not with every line |
//! | away | how far retraction keeps the machine from the commanded position |
//! | clamp | a value out of range: it is refused with its line, or brought to the edge of its range, and told of |
//! | farthest | 10 m from zero, beyond which no target is computed |

pub(in crate::machine) mod advance_in_use;
pub(in crate::machine) mod circulation;
pub(in crate::machine) mod clamps;
pub(in crate::machine) mod commanded;
pub(in crate::machine) mod fan_schedule;
pub(in crate::machine) mod heat_orders;
pub(in crate::machine) mod idle_timeout;
pub(in crate::machine) mod job;
pub(in crate::machine) mod limping;
pub(in crate::machine) mod machine_pieces;
pub(in crate::machine) mod modal;
pub(in crate::machine) mod notices;
pub(in crate::machine) mod pauses;
pub(in crate::machine) mod position;
pub(in crate::machine) mod program;
pub(in crate::machine) mod retraction;
pub(in crate::machine) mod self_tests;
pub(in crate::machine) mod soft_endstops;
pub(in crate::machine) mod trimming;
pub(in crate::machine) mod waiting;
