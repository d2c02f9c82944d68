//! Reports: what the machine says, when a command asks and by itself.

pub(in crate::machine) mod answer;
pub(in crate::machine) mod driver_report;
pub(in crate::machine) mod message;
pub(in crate::machine) mod report;
pub(in crate::machine) mod sensors;
