//! Conversations with the whole firmware: a host's lines, and the replies.

mod arcs;
mod below_zero;
mod first_layer;
mod homing;
mod legal_settings;
mod lines;
mod machine_accidents;
mod machine_record;
mod parts;
mod positions;
mod probe;
mod probing;
mod refused_settings;
mod reports;
mod saving;
mod sensors;
mod stops;
mod storage;
mod talk;
mod uploads;

use crate::common::wild_machine;
