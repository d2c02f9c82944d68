//! Why a sensor or a test gives no result, as hosts read it.

use super::plan::SweepAxis;
use crate::accelerometer::{SensorFault, SensorKind};
use core::fmt::{self, Display, Formatter};

/// The reason.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum NoResult {
    /// The sweep was made, and no sensor listened.
    Swept(SweepAxis),
    /// The sensor failed.
    Failed(SensorKind, SensorFault),
    /// It is too noisy at rest: mm/s^2 along its x, y, z.
    Noisy(SensorKind, [u32; 3]),
}

impl Display for NoResult {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Swept(axis) => {
                put!(f, "swept {}; no accelerometer configured, nothing was measured", axis.name())
            }
            Self::Failed(kind, fault) => {
                let kind = kind.name();
                match fault {
                    SensorFault::Absent => put!(f, "this board has no connector for an accelerometer"),
                    SensorFault::WrongId(id) => {
                        put!(f, "no {kind}: its identity reads {id:#04x}. Check plug, cable and kind")
                    }
                    SensorFault::Register => put!(f, "{kind}: a register does not keep its value"),
                    SensorFault::Overflow => put!(f, "{kind}: samples were lost"),
                    SensorFault::Silent => put!(f, "{kind} gives no samples. Check its cable"),
                    SensorFault::Stuck => put!(f, "{kind} gives the same sample all the time"),
                }
            }
            Self::Noisy(kind, [x, y, z]) => {
                let kind = kind.name();
                put!(f, "{kind} is too noisy at rest: x {x} y {y} z {z} mm/s2. Check its cable and the fans")
            }
        }
    }
}
