//! Rooms: the parts of the project for which work is counted, by source file.

use std::fmt;

/// A part of the project. The plugin uses its number, where 0 is no room.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[repr(u8)]
pub enum Room {
    /// Bytes to lines, replies.
    Protocol = 1,
    /// A line to a command.
    Gcode,
    /// The commands, and the Console's loop.
    Machine,
    /// Look-ahead and speeds.
    Planner,
    /// Moves to step events.
    Stepgen,
    /// The step interrupt's work.
    Stepper,
    /// Sensors, heaters, guards.
    Thermal,
    /// Motor drivers, settings, storage, start-up.
    Rest,
    /// The board: interrupts, queues of bytes, clocks.
    Board,
    /// QEMU's stand-in for step pins and endstops: the trace, and a machine of numbers.
    Rig,
}

impl Room {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Protocol,
        Self::Gcode,
        Self::Machine,
        Self::Planner,
        Self::Stepgen,
        Self::Stepper,
        Self::Thermal,
        Self::Rest,
        Self::Board,
        Self::Rig,
    ];

    /// The room with a number.
    pub fn numbered(number: u64) -> Option<Self> {
        Self::ALL.into_iter().find(|room| u64::from(*room as u8) == number)
    }

    /// The room of a source file, by its path below the root. Shared files belong to no room: units, status, motor sets
    /// and kinematics count for their caller, and so do the libraries.
    pub fn of(path: &str) -> Option<Self> {
        let below = |folder: &str| path.strip_prefix(folder);
        if let Some(file) = below("src/motion/") {
            return Some(match file {
                "stepper.rs" => Self::Stepper,
                // Numbers, formulas and comparisons count for their caller.
                "number.rs" | "ramps.rs" | "ticks.rs" => return None,
                // Values that the planner derives from a move, for the generator.
                "trajectory/phase.rs" | "trajectory/shaper.rs" => Self::Planner,
                _ if ["stepgen/", "trajectory/", "queue/"].iter().any(|begin| file.starts_with(begin)) => Self::Stepgen,
                "link.rs" | "step_counts.rs" => Self::Machine,
                _ => Self::Planner,
            });
        }
        if let Some(file) = below("src/") {
            let folder = file.split_once('/').map(|(folder, _)| folder);
            return match folder {
                Some("protocol") => Some(Self::Protocol),
                Some("gcode") => Some(Self::Gcode),
                Some("machine") => Some(Self::Machine),
                Some("thermal") => Some(Self::Thermal),
                Some("driver" | "settings" | "storage" | "app") => Some(Self::Rest),
                _ => None,
            };
        }
        if path.starts_with("sim/rig/") || path.ends_with("an386/trace.rs") {
            return Some(Self::Rig);
        }
        (path.starts_with("boards/") || path.starts_with("chips/")).then_some(Self::Board)
    }
}

impl fmt::Display for Room {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Protocol => "protocol",
            Self::Gcode => "gcode",
            Self::Machine => "machine",
            Self::Planner => "planner",
            Self::Stepgen => "stepgen",
            Self::Stepper => "stepper",
            Self::Thermal => "thermal",
            Self::Rest => "rest",
            Self::Board => "board",
            Self::Rig => "rig",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_in_the_room_of_its_folder() {
        assert_eq!(Room::of("src/motion/stepgen/brake.rs"), Some(Room::Stepgen));
        assert_eq!(Room::of("src/motion/planner/window.rs"), Some(Room::Planner));
        assert_eq!(Room::of("src/gcode/number.rs"), Some(Room::Gcode));
        assert_eq!(Room::of("src/units/mod.rs"), None);
        assert_eq!(Room::of("boards/qemu/src/an386/trace.rs"), Some(Room::Rig));
        assert_eq!(Room::of("boards/qemu/src/an386/time.rs"), Some(Room::Board));
        assert_eq!(Room::of("/rustc/library/core/src/slice/mod.rs"), None);
    }

    #[test]
    fn numbers_lead_back_to_their_rooms() {
        assert!(Room::ALL.into_iter().all(|room| Room::numbered(room as u64) == Some(room)));
        assert_eq!(Room::numbered(0), None);
    }
}
