//! Heat and fans: targets, waits for them, models and tuning; fans.
//!
//! | files that commands share | for |
//! |---|---|
//! | [`heating`] | targets, and the waits for them |
//! | [`reached`] | whether a target is reached, and whether a heater still gets warmer |
//! | [`tuning`], [`self_test`] | what lasts for minutes |
//! | [`heater_settings`] | the words that several commands have |

pub(in crate::machine) mod cold_limit;
pub(in crate::machine) mod controller_fan;
pub(in crate::machine) mod fan_speed;
pub(in crate::machine) mod fan_turns;
pub(in crate::machine) mod heat_targets;
pub(in crate::machine) mod heater_model;
pub(in crate::machine) mod heater_self_test;
pub(in crate::machine) mod heater_settings;
pub(in crate::machine) mod heater_tuning;
pub(in crate::machine) mod heaters_by_name;
pub(in crate::machine) mod heaters_reached;
pub(in crate::machine) mod heating;
pub(in crate::machine) mod power_off;
pub(in crate::machine) mod reached;
pub(in crate::machine) mod self_test;
pub(in crate::machine) mod temperature_wait;
pub(in crate::machine) mod temperatures;
pub(in crate::machine) mod tuning;

use crate::gcode::{Entry, TableCommand};
use crate::machine::answers::answer::Answer;
use crate::machine::interrupt::Interrupt;
use crate::machine::main_loop::MainLoop;
use crate::machine::ports::PortSet;
use crate::machine::states::States;
use crate::port::Wake;
