//! State: values that earlier lines set, the known state of the machine, and the out-of-range values of the present
//! line.
//!
//! Each struct owns its fields. The main loop holds state that changes while a command waits. `machine::states` holds
//! the rest: each family in `commands` passes a command the structs that it needs. Pure: nothing here knows either.
//!
//! | looking for | see |
//! |---|---|
//! | G90, G91, G20, F, overrides | [`modal`] |
//! | where the program has sent the tool, G92 | [`commanded`] |
//! | G10, G11 | [`retraction`] |
//! | which axes are homed, where the machine stands | [`position`], [`soft_endstops`] |
//! | how far z stands from the place that the program names | [`first_layer`] |
//! | circulation of a belt, alignment of its motors | [`circulation`], [`trimming`] |
//! | a belt that has lost a motor | [`limping`] |
//! | the wait of a command | [`pauses`], [`waiting`] |
//! | whether a print is under way, paused or ended; its state in a pause | [`job`], [`program`], [`paused_stream`] |
//! | the mesh of the bed, the area that a print needs | [`known_bed`] |
//! | whether the screws of z are level | [`level`] |
//! | a line that is held without `ok` | [`held_line`] |
//! | queued orders for heaters and fans | [`heat_orders`], [`fan_schedule`], [`self_tests`], [`baselines`] |
//! | the Z probe | [`probing`] |
//! | a machine record in transfer | [`machine_pieces`] |
//! | the pressure advance that the motion follows | [`advance_in_use`] |
//! | when motors lose their power at rest | [`idle_timeout`] |
//! | values out of range | [`clamps`] |
//! | messages that a host got once | [`notices`] |
//!
//! | word | means |
//! |---|---|
//! | commanded position | where the program has sent the tool |
//! | real position | where the machine stands, from the steps that were made |
//! | named position | the commanded position as the program counts it, after G92 |
//! | edge | the end of the reachable space of a homed axis, where soft endstops put a target that lies beyond |
//! | notice | a message that a host gets once, not with every line |
//! | away | how far retraction keeps the machine from the commanded position |
//! | clamp | a value out of range: it is refused with its line, or set to the edge of its range, and reported |
//! | farthest | 10 m from zero, beyond which no target is computed |

pub(in crate::machine) mod advance_in_use;
pub(in crate::machine) mod baselines;
pub(in crate::machine) mod circulation;
pub(in crate::machine) mod clamps;
pub(in crate::machine) mod cold_extrusion;
pub(in crate::machine) mod commanded;
pub(in crate::machine) mod fan_schedule;
pub(in crate::machine) mod first_layer;
pub(in crate::machine) mod heat_orders;
pub(in crate::machine) mod held_line;
pub(in crate::machine) mod idle_timeout;
pub(in crate::machine) mod job;
pub(in crate::machine) mod known_bed;
pub(in crate::machine) mod level;
pub(in crate::machine) mod limping;
pub(in crate::machine) mod machine_pieces;
pub(in crate::machine) mod modal;
pub(in crate::machine) mod notices;
pub(in crate::machine) mod paused_stream;
pub(in crate::machine) mod pauses;
pub(in crate::machine) mod position;
pub(in crate::machine) mod probing;
pub(in crate::machine) mod program;
pub(in crate::machine) mod pulleys;
pub(in crate::machine) mod retraction;
pub(in crate::machine) mod running_texts;
pub(in crate::machine) mod saved_states;
pub(in crate::machine) mod self_tests;
pub(in crate::machine) mod soft_endstops;
pub(in crate::machine) mod trimming;
pub(in crate::machine) mod waiting;
